# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Mixed friction: what share of a load asperities carry, and the friction that they add; and the state of the films of a bearing at an instant.

**Share.** Asperities carry a share p of a load that falls with the film ratio Lambda, film over roughness:

    film_ratio   p = exp(-1.8 Lambda^1.2)   (S. Aihara, A new running torque formula for tapered roller bearings under axial load, J. Tribol. 109
                 (1987) 471-478, of roller ends on ribs),
    skf          p = exp(-2.6e-8 (n nu)^1.4 d_m), n [rpm], nu [mm^2/s], d_m = (d + D)/2 [mm]   (SKF, The SKF model for calculating the
                 frictional moment).

Nobody knows the roughness of a catalogue bearing; kappa of ISO 281 stands for it, kappa = Lambda^1.3, times a factor whose range is 1/1.5 to 3
(other published laws of the share: 0.8 to 2.2; ribs of tapered bearings have film ratios up to 5 times those of kappa).  A friction coefficient is
p mu_b + (1 - p) mu, mu_b = 0.12 of asperities (SKF; 0.08 to 0.15 with most additives).

**Where.** In pockets and on flanges, mu that of the scene's film there; on raceways, mu the law of traction, with asperities that take
mu_b Q s/sqrt(s^2 + s_0^2) at the slide-to-roll ratio s, s_0 = 1e-3 of elastic creep (*assumption*).  They would hold a cage that has next to no load;
nothing published says that they do, so they count from the minimum load on (`bearing_sim.physics.starvation.loaded_fraction`).

**Losses of rolling.** Two more are proportional to the load or nearly so, and push and brake a roller as its resistance to rolling does
(`bearing_sim.physics.film.resistance_constants`: the power 2 F_R u):

    skew        F_R = q mu Q/2: a roller that runs askew by q slides across its raceways with q u; mu = p mu_b + (1 - p) 0.02 (SKF's
                coefficient of sliding of cylindrical roller bearings).  This is the sliding moment of a purely radial load in makers' formulas.
    hysteresis  F_R = a_h/(3 pi) (a/R) Q, a the half width of the contact (K. L. Johnson, Contact Mechanics, 1985, section 9.4), a_h = 0.01 of the
                elastic energy of hardened steel.

*Assumptions*: rollers skew by the half of what flanges, by their end clearance, and pockets leave them in the mean; it does not depend on load.
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import load, square_root, store
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.rating_life import KAPPA_EXPONENT, viscosity_ratio
from bearing_sim.physics.starvation import loaded_fraction, starvation_exponent, starved_film, starved_resistance

NONE, FILM_RATIO, SKF = range(3)  # what `MixedFriction.law` may be
SKF_FRICTION = 0.02  # mu_EHL of cylindrical roller bearings
_AIHARA, _AIHARA_EXPONENT = 1.8, 1.2
_SKF_SHARE, _SKF_EXPONENT = 2.6e-8, 1.4
_CREEP = 1e-3  # s_0


class MixedFriction(NamedTuple):
    """How asperities share loads, and with which friction."""

    law: int
    boundary_friction: float  # mu_b
    film_ratio_factor: float  # Lambda over kappa^(1/1.3)
    skf_constant: float  # of the share by SKF, for speeds in rad/s and viscosities in m^2/s
    raceways: bool  # whether asperities of the raceways count for traction
    skew: float  # mean angle by which rollers run askew [rad]
    pitch_diameter: float  # D_pw [m]


class FilmState(NamedTuple):
    """State of the films of a bearing at an instant, the same in all contacts."""

    log_film: float  # ln of film thickness over that of full inlets
    resistance: float  # hydrodynamic resistance to rolling over that of full inlets
    asperity_share: float  # p of what is forced to slide, in pockets and on flanges
    pocket_friction: float  # coefficient of friction in pockets
    flange_friction: float  # and of roller ends on flanges
    raceway_share: float  # p of raceways; 0 where asperities do not count there
    raceway_friction: float  # and p mu_b
    skew_resistance: float  # F_R over Q of rollers that run askew


FULL_FILMS = FilmState(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def skf_constant(mean_diameter: float) -> float:
    """Return 2.6e-8 d_m of the share by SKF, for speeds in rad/s and viscosities in m^2/s; d_m = (d + D)/2 [m]."""
    return _SKF_SHARE * (30.0 / math.pi * 1e6) ** _SKF_EXPONENT * 1e3 * mean_diameter


def hysteresis_constant(loss: float, curvature_radius: float, reduced_modulus: float, length: float) -> float:
    """Return F_R over Q^(3/2) of rolling hysteresis [N^-0.5]; a = sqrt(8 Q R/(pi E' L)) of Hertz's line contact.

    Parameters
    ----------
    loss : a_h, the part of the elastic energy that is lost.
    curvature_radius, reduced_modulus, length : R [m], E' [Pa], L [m].
    """
    return loss / (3.0 * math.pi * curvature_radius) * math.sqrt(8.0 * curvature_radius / (math.pi * reduced_modulus * length))


@kernel
def asperity_share(shaft_speed, viscosity, film, mixed):
    """Return p.

    Parameters
    ----------
    shaft_speed : [rad/s].
    viscosity : kinematic, nu in the films [m^2/s].
    film : thickness of the films over that of full inlets.
    mixed : `MixedFriction`.
    """
    if mixed.law == NONE:
        return 0.0
    if mixed.law == SKF:
        return math.exp(-mixed.skf_constant * (abs(shaft_speed) * viscosity) ** _SKF_EXPONENT)
    kappa = viscosity_ratio(viscosity, shaft_speed, mixed.pitch_diameter)
    ratio = mixed.film_ratio_factor * film * kappa ** (1.0 / KAPPA_EXPONENT)
    return math.exp(-_AIHARA * ratio**_AIHARA_EXPONENT)


@kernel
def film_state(shaft_speed, radial_load, viscosity, pocket_friction, flange_friction, minimum_load, starvation, mixed):
    """Return the `FilmState` of an instant.

    Parameters
    ----------
    shaft_speed : [rad/s].
    radial_load : on the bearing [N].
    viscosity : kinematic, nu in the films [m^2/s].
    pocket_friction, flange_friction : coefficients on full films.
    minimum_load, starvation : `bearing_sim.physics.starvation.MinimumLoad` and `bearing_sim.physics.starvation.Starvation`.
    mixed : `MixedFriction`.
    """
    log_film, resistance, film, loaded = 0.0, 1.0, 1.0, loaded_fraction(shaft_speed, radial_load, minimum_load)
    if starvation.rate > 0.0:
        exponent = starvation_exponent(shaft_speed, viscosity, starvation) * (loaded if starvation.flooded else 1.0)
        resistance, film = starved_resistance(exponent), starved_film(exponent)
        log_film = math.log(film)
    if mixed.law == NONE:
        return FilmState(log_film, resistance, 0.0, pocket_friction, flange_friction, 0.0, 0.0, 0.0)
    share = asperity_share(shaft_speed, viscosity, film, mixed)
    boundary, rest = share * mixed.boundary_friction, 1.0 - share
    on_raceways = loaded if mixed.raceways else 0.0
    return FilmState(
        log_film,
        resistance,
        share,
        boundary + rest * pocket_friction,
        boundary + rest * flange_friction,
        on_raceways * share,
        on_raceways * boundary,
        0.5 * mixed.skew * (boundary + rest * SKF_FRICTION),
    )


@kernel
def share_with_asperities(contacts, films):
    """Let asperities take their share of the tangential forces of all contacts, rows `CONTACT`; `FilmState` ``films``."""
    rest, friction = 1.0 - films.raceway_share, films.raceway_friction
    for block in range(contacts.shape[0]):
        normal, rolling, inverse_speed = (
            load(contacts, block, CONTACT.load),
            load(contacts, block, CONTACT.rolling),
            load(contacts, block, CONTACT.inverse_speed),
        )
        ratio = load(contacts, block, CONTACT.sliding) * inverse_speed
        inverse = 1.0 / square_root(ratio * ratio + _CREEP * _CREEP)
        coefficient = friction * ratio * inverse
        bend = (friction * _CREEP * _CREEP) * normal * inverse * inverse * inverse
        store(contacts, block, CONTACT.force, rest * load(contacts, block, CONTACT.force) + normal * coefficient)
        store(contacts, block, CONTACT.d_load, rest * load(contacts, block, CONTACT.d_load) + coefficient)
        store(contacts, block, CONTACT.d_sliding, rest * load(contacts, block, CONTACT.d_sliding) + bend * inverse_speed)
        by_speed = bend * ratio * rolling * inverse_speed * inverse_speed
        store(contacts, block, CONTACT.d_rolling, rest * load(contacts, block, CONTACT.d_rolling) - by_speed)
