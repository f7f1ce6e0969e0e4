# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rating lives: from the load on the bearing, from roller loads, and modified by oil and reliability (ISO 281:2007, ISO/TS 16281:2008).

What the laminae of rollers contribute is in `bearing_sim.physics.lamina_life`, the load ratings are in `bearing_sim.scene.ratings`.
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.starvation import starvation_exponent, starved_film

ROTATING_EXPONENT = 4.0  # of the mean load of a ring that rotates against the load (ISO/TS 16281)
STATIONARY_EXPONENT = 4.5  # and of one that is stationary
LARGEST_MODIFICATION = 50.0  # a_ISO is never more
LARGEST_VISCOSITY_RATIO = 4.0  # kappa counts no more than that
KAPPA_EXPONENT = 1.3  # kappa = Lambda^1.3 of the ratio of film and roughness (ISO 281:2007, 9.3.3.2)
_LEAST_VISCOSITY_RATIO = 0.1  # below it a_ISO is at its least, 0.1
ISO16281, ISO281, DENG2017 = 0, 1, 2  # methods, see `Lives`
METHODS = {"iso16281": ISO16281, "iso281": ISO281, "deng2017": DENG2017}

# Cleanliness class -> (slope, loss) of e_C = min(slope kappa^0.68 D_pw^0.55, 1) (1 - loss/D_pw^(1/3)), D_pw in mm (ISO 281:2007,
# annex A): circulating oil filtered in line (A.4), oil bath or oil filtered off the line (A.5), by the end of the ISO 4406 code; grease (A.6).
CLEANLINESS = {
    "filtered_13_10": (0.0864, 0.5663),
    "filtered_15_12": (0.0432, 0.9987),
    "filtered_17_14": (0.0288, 1.6329),
    "filtered_19_16": (0.0216, 2.3362),
    "bath_13_10": (0.0864, 0.6796),
    "bath_15_12": (0.0288, 1.141),
    "bath_17_14": (0.0133, 1.667),
    "bath_19_16": (0.00864, 2.5164),
    "bath_21_18": (0.00411, 3.8974),
    "grease_high_cleanliness": (0.0864, 0.6796),
    "grease_normal_cleanliness": (0.0432, 1.141),
    "grease_slight_contamination": (0.0177, 1.887),
    "grease_severe_contamination": (0.0115, 2.662),
    "grease_very_severe_contamination": (0.00617, 4.06),
}
_SLIGHT, _LARGE_LOSS = "grease_slight_contamination", 1.677  # its loss from a pitch diameter of 500 mm on (ISO 281:2007, figure A.12)


def cleanliness(name, pitch_diameter):
    """Return slope and loss of a class of `CLEANLINESS`; zeros for none.

    Parameters
    ----------
    name : of the class.
    pitch_diameter : D_pw [m].
    """
    slope, loss = CLEANLINESS.get(name, (0.0, 0.0))
    return slope, _LARGE_LOSS if name == _SLIGHT and pitch_diameter >= 0.5 else loss


def ring_ratings(rating, rollers, gamma):
    """Return the load ratings (Q_ci, Q_ce) [N] of one roller on the inner and outer ring (ISO/TS 16281, 5.2).

    Parameters
    ----------
    rating : basic dynamic radial load rating, C [N].
    rollers : their number, Z.
    gamma : D_w/d_m.
    """
    g = (1.038 * ((1 - gamma) / (1 + gamma)) ** (143 / 108)) ** 4.5
    inner = rating / (0.83 * 0.378 * rollers) * (1 + g) ** (2 / 9)
    outer = rating / (0.83 * 0.364 * rollers) * (1 + 1 / g) ** (2 / 9)
    return inner, outer


@kernel
def rating_life_revolutions(inner_equivalent, outer_equivalent, life):
    """Return L10 in revolutions (ISO/TS 16281; Deng 2017, eq. 18 with rating and load in the right places).

    Parameters
    ----------
    inner_equivalent, outer_equivalent : dynamic equivalent roller loads Q_ei, Q_ee [N].
    life : `bearing_sim.model.params.Life`.
    """
    inner = (inner_equivalent / life.inner_rating) ** 4.5
    outer = (outer_equivalent / life.outer_rating) ** 4.5
    return 1e6 * (inner + outer) ** (-8.0 / 9.0)


def reliability_factor(reliability):
    """Return a_1, the fraction of L10 that a bearing survives with a probability (ISO 281:2007, table 12).

    The table's values are, to the digits printed, those of a Weibull distribution with slope 1.5 that starts at 0.05 of L10:
    a_1 = 0.05 + 0.95 [ln(1/R)/ln(1/0.9)]^(2/3).

    Parameters
    ----------
    reliability : the probability, 0.9 or more.
    """
    return 1.0 if reliability == 0.9 else 0.05 + 0.95 * (math.log(1.0 / reliability) / math.log(1.0 / 0.9)) ** (1 / 1.5)


@kernel
def viscosity_ratio(kinematic_viscosity, shaft_speed, pitch_diameter):
    """Return kappa = nu/nu_1 (ISO 281, 9.3.3.2); 0 at rest.

    nu_1 = 45000 n^-0.83 D_pw^-0.5 mm^2/s below 1000 rpm, 4500 n^-0.5 D_pw^-0.5 above, D_pw in mm.

    Parameters
    ----------
    kinematic_viscosity : nu [m^2/s].
    shaft_speed : [rad/s].
    pitch_diameter : D_pw [m].
    """
    rpm = abs(shaft_speed) * (30.0 / math.pi)
    # as a ratio, which is finite at rest
    speed = rpm**0.83 / 45000.0 if rpm < 1000.0 else math.sqrt(rpm) / 4500.0
    return 1e6 * kinematic_viscosity * speed * math.sqrt(1e3 * pitch_diameter)


@kernel
def contamination_factor(kappa, slope, loss, pitch_diameter):
    """Return e_C (ISO 281:2007, annex A), 0 to 1.

    Parameters
    ----------
    kappa : viscosity ratio.
    slope, loss : of a class in `CLEANLINESS`.
    pitch_diameter : D_pw [m].
    """
    millimetres = 1e3 * pitch_diameter
    filtered = min(slope * min(kappa, LARGEST_VISCOSITY_RATIO) ** 0.68 * millimetres**0.55, 1.0)
    return filtered * max(1.0 - loss / millimetres ** (1.0 / 3.0), 0.0)


@kernel
def modification_factor(kappa, limit_ratio):
    """Return a_ISO of a radial roller bearing (ISO 281:2007, 9.3.3.3), 0.1 to 50.

    a_ISO = 0.1 [1 - (1.5859 - c/kappa^p) (e_C C_u/P)^0.4]^-9.185.

    Parameters
    ----------
    kappa : viscosity ratio; counts from 0.1, where a_ISO is at its least, to 4.
    limit_ratio : e_C C_u/P, from 0 to infinity.
    """
    kappa = min(kappa, LARGEST_VISCOSITY_RATIO)
    if not kappa > _LEAST_VISCOSITY_RATIO or not limit_ratio > 0.0:
        return 0.1
    if kappa < 0.4:
        film = 1.5859 - 1.3993 / kappa**0.054381
    elif kappa < 1.0:
        film = 1.5859 - 1.2348 / kappa**0.19087
    else:
        film = 1.5859 - 1.2348 / kappa**0.071739
    left = 1.0 - max(film, 0.0) * limit_ratio**0.4
    if not left > 0.0:
        return LARGEST_MODIFICATION
    return min(0.1 * left**-9.185, LARGEST_MODIFICATION)


class OilFactors(NamedTuple):
    """What the oil contributes to a modified life."""

    viscosity_ratio: float  # kappa, of starved films
    contamination_factor: float  # e_C; NaN where the scene names no cleanliness class


@kernel
def oil_factors(shaft_speed, kinematic_viscosity, pitch_diameter, starvation, life):
    """Return the `OilFactors` of a condition.

    kappa stands for the ratio of film and roughness, kappa = Lambda^1.3 (ISO 281:2007, 9.3.3.2), so that a starved film has a lower one.

    Parameters
    ----------
    shaft_speed : [rad/s].
    kinematic_viscosity : of the oil [m^2/s].
    pitch_diameter : [m].
    starvation : `bearing_sim.physics.starvation.Starvation`.
    life : `bearing_sim.model.params.Life`.
    """
    kappa = viscosity_ratio(kinematic_viscosity, shaft_speed, pitch_diameter)
    if starvation.rate > 0.0:
        kappa *= starved_film(starvation_exponent(shaft_speed, kinematic_viscosity, starvation)) ** KAPPA_EXPONENT
    cleanliness = contamination_factor(kappa, life.cleanliness_slope, life.cleanliness_loss, pitch_diameter) if life.modified else math.nan
    return OilFactors(kappa, cleanliness)


class Lives(NamedTuple):
    """Rating lives of one condition in revolutions, and what they follow from.

    ISO 281 rates the bearing by the load on it, ISO/TS 16281 by the loads on the laminae of its rollers (L10r, L_nmr).  Deng et al. 2017
    (eq. 18) take whole rollers with the ratings of ISO/TS 16281, without its stress risers: for their figures only, for that life is two to
    three times that of a catalogue.
    """

    basic: float  # L10 by the method of the scene
    modified: float  # L_nm of it
    l10: float  # (C/P)^(10/3)
    lnm: float  # a_1 a_ISO L10
    l10r: float  # basic reference rating life
    lnmr: float  # modified reference rating life
    equivalent_load: float  # P [N]
    reference_load: float  # P_ref, under which L10 would be L10r [N]
    viscosity_ratio: float  # kappa
    contamination_factor: float  # e_C; NaN where the scene names no cleanliness class
    modification_factor: float  # a_ISO at P; 1 where the scene names no cleanliness class
    reference_modification_factor: float  # a_ISO of all laminae together, L_nmr/(a_1 L10r)
    static_safety: float  # S_0 = C_0/P_0


@kernel
def equivalent_load(load, life):
    """Return the dynamic equivalent load P [N] of a cylindrical roller bearing: F_r up to F_a = e F_r, X F_r + Y F_a above (makers' rule).

    Parameters
    ----------
    load : radial load on the bearing, F_r [N].
    life : `bearing_sim.model.params.Life`.
    """
    if life.axial_load <= life.axial_limit * load:
        return load
    return max(load, life.radial_factor * load + life.axial_factor * life.axial_load)


@kernel
def rate_lives(load, equivalent, oil, life):
    """Return the `Lives` of one condition; infinite without load.

    The static equivalent load is P_0 = F_r: flanges, not raceways, carry the axial load.

    Parameters
    ----------
    load : radial load on the bearing, F_r [N].
    equivalent : `bearing_sim.physics.lamina_life.EquivalentLoads`.
    oil : `OilFactors`.
    life : `bearing_sim.model.params.Life`.
    """
    dynamic = equivalent_load(load, life)
    l10 = 1e6 * (life.dynamic_rating / dynamic) ** (10.0 / 3.0) if dynamic > 0.0 else math.inf
    l10r = rating_life_revolutions(equivalent.inner_lamina, equivalent.outer_lamina, life)
    at_load, of_laminae = modified_by_oil(l10, oil, life), equivalent.reference_modification_factor
    lnm, lnmr = life.reliability_factor * at_load * l10, life.reliability_factor * of_laminae * l10r
    basic, modified = l10r, lnmr
    if life.method == ISO281:
        basic, modified = l10, lnm
    elif life.method == DENG2017:
        basic = rating_life_revolutions(equivalent.inner, equivalent.outer, life)
        modified = life.reliability_factor * modified_by_oil(basic, oil, life) * basic
    return Lives(
        basic,
        modified,
        l10,
        lnm,
        l10r,
        lnmr,
        dynamic,
        life.dynamic_rating * (1e-6 * l10r) ** -0.3,
        oil.viscosity_ratio,
        oil.contamination_factor,
        at_load,
        of_laminae,
        life.static_rating / load if load > 0.0 else math.inf,
    )


@kernel
def modified_by_oil(revolutions, oil, life):
    """Return a_ISO at the load that gives a basic life, P = C L^(-3/10); 1 where no cleanliness class is named.

    Parameters
    ----------
    revolutions : the basic life; may be infinite.
    oil : `OilFactors`.
    life : `bearing_sim.model.params.Life`.
    """
    if not life.modified:
        return 1.0
    cleanliness = oil.contamination_factor
    limit_ratio = cleanliness * life.fatigue_limit / life.dynamic_rating * (revolutions * 1e-6) ** 0.3 if cleanliness > 0.0 else 0.0
    return modification_factor(oil.viscosity_ratio, limit_ratio)
