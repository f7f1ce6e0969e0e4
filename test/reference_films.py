# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Starved inlets, mixed friction, resistance to rolling and the drag of lands in plain NumPy, for the plain models of all levels.

No code is shared with the package; everything is written from the published equations, which the docstrings name.  Units are SI where a formula
is not in its author's.  Functions of complex numbers are kept analytic where a complex step goes through them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


def larger(x, y):
    """The number with the larger real part."""
    return np.where(np.real(x) >= np.real(y), x, y)


def magnitude(x):
    return np.where(np.real(x) >= 0, x, -x)


def power_of_positive(x, exponent):
    """x^exponent, and 0 where x is not positive."""
    return np.where(np.real(x) > 0, np.where(np.real(x) > 0, x, 1.0) ** exponent, 0.0)


@dataclass
class Oil:
    """MIL-L-7808 at a temperature [K]: a double exponential, a hyperbola and a table."""

    temperature: float = 393.15

    def __post_init__(self):
        self.viscosity = self.viscosity_at(self.temperature)
        self.thinning = np.log(self.viscosity_at(self.temperature - 0.1) / self.viscosity_at(self.temperature + 0.1)) / 0.2
        self.pressure_viscosity = 7.5808e-10 + 1.0742e-6 / (self.temperature - 215.56)
        self.density = np.interp(self.temperature, [311, 367, 422, 478], [954, 914, 870, 826])

    @staticmethod
    def viscosity_at(kelvin):
        return 9.997e-4 * (np.exp(np.exp(22.216 - 3.7048 * np.log(kelvin))) - 0.87)


def load_rating(rollers, roller_radius, length, gamma):
    """C_r [N] of ISO 281:2007 with the f_c of ISO/TR 1281-1."""
    less = (1 - gamma) / (1 + gamma)
    f_c = 207.9 * 0.83 * gamma ** (2 / 9) * (1 - gamma) ** (29 / 27) / (1 + gamma) ** (1 / 4)
    f_c /= (1 + (1.04 * less ** (143 / 108)) ** (9 / 2)) ** (2 / 9)
    return 1.1 * f_c * (1e3 * length) ** (7 / 9) * rollers ** (3 / 4) * (2e3 * roller_radius) ** (29 / 27)


@dataclass
class Films:
    """What is left of the films of a bearing, and what asperities add."""

    shaft_speed: float
    load: float
    oil: Oil
    rollers: int
    roller_radius: float
    length: float
    inner_radius: float
    low_radius: float
    bore: float  # diameters d and D
    outside: float
    pocket_clearance: float
    replenishment: float = 0.0  # K_rs; 0: full inlets
    starved_below: bool = False  # below the minimum load, too
    minimum_load: float | None = None  # None: 0.02 C_r
    law: str = "none"  # film_ratio or skf
    boundary_friction: float = 0.12
    ratio_factor: float = 1.0
    raceways: bool = True
    skewed: float = 0.5  # of the largest skew
    lost: float = 0.01  # of the elastic energy

    def __post_init__(self):
        rpm, mean = abs(self.shaft_speed) * 30 / np.pi, 500 * (self.bore + self.outside)
        nu, pitch = 1e6 * self.oil.viscosity / self.oil.density, 2e3 * (self.inner_radius + self.roller_radius)
        # SKF, The SKF model for calculating the frictional moment: exp(-K_rs nu n (d + D) sqrt(K_Z/(2 (D - d)))), K_Z 5.1
        spread = 1e3 * (self.outside - self.bore)
        self.whole_exponent = self.replenishment * nu * rpm * 2 * mean * np.sqrt(5.1 / (2 * spread))
        least = self.minimum_load
        if least is None:
            least = 0.02 * load_rating(self.rollers, self.roller_radius, self.length, 2e3 * self.roller_radius / pitch)
        self.loaded = np.interp(self.load / least, [1.0, 1.5], [0.0, 1.0])
        self.exponent = min((1.0 if self.starved_below else self.loaded) * self.whole_exponent, np.log(5))
        self.film, self.resistance = starved(self.exponent)

        # ISO 281:2007, 9.3.3: the reference viscosity; kappa is about the film ratio to the power of 1.3
        reference = 45000 * rpm**-0.83 / np.sqrt(pitch) if rpm < 1000 else 4500 / np.sqrt(rpm * pitch)
        self.kappa = nu / reference
        if self.law == "none":
            self.share = 0.0
        elif self.law == "skf":
            self.share = np.exp(-2.6e-8 * (rpm * nu) ** 1.4 * mean)
        else:  # Aihara 1987
            self.share = np.exp(-1.8 * (self.ratio_factor * self.film * self.kappa ** (1 / 1.3)) ** 1.2)
        self.skew = 0.0 if self.law == "none" else self.skewed * self.largest_skew()

    def largest_skew(self):
        """Angle that flanges of the outer ring leave a roller by its end clearance, or its pocket by its play; sizes as the scene's estimates."""
        diameter, centre = 2 * self.roller_radius, self.low_radius - self.roller_radius
        edge, end = self.low_radius - 0.18 * diameter, self.roller_radius - 0.05 * diameter  # of the flange, and of the roller's flat end

        def apart(angle):  # a point on the edge of the roller's end, by its angle from outwards
            return np.hypot(centre + end * np.cos(angle), end * np.sin(angle)) - edge

        lever = end * np.sin(brentq(apart, 1e-9, np.pi - 1e-9, xtol=1e-14))
        return min((15e-6 + 0.003 * self.length) / 2 / lever, 2 * self.pocket_clearance / self.length)

    def mixed(self, coefficient):
        """Coefficient of friction of which asperities have their share."""
        return self.share * self.boundary_friction + (1 - self.share) * coefficient

    def traction(self, load, rolling, sliding, force):
        """Traction of which asperities have their share, which creep like s/sqrt(s^2 + 0.001^2)."""
        if not self.raceways or self.law == "none":
            return force
        ratio, share = sliding / np.sqrt(rolling**2 + 0.05**2), self.loaded * self.share  # asperities drive no cage below the minimum load
        return (1 - share) * force + share * self.boundary_friction * load * ratio / np.sqrt(ratio**2 + 1e-6)

    def losses_of_rolling(self, load, rolling, curvature_radius, modulus):
        """F_R of rollers that run askew and of Johnson's hysteresis, alpha 2 a Q/(3 pi R) of the moment (Contact Mechanics, eq. 9.30 ff.)."""
        if self.law == "none":
            return 0 * load * rolling
        load = larger(load, 0.0)
        askew = self.skew * self.mixed(0.02) * load / 2
        half_width = np.sqrt(8 * curvature_radius / (np.pi * modulus * self.length))  # over sqrt(Q)
        hysteresis = self.lost / (3 * np.pi) * half_width / curvature_radius * power_of_positive(load, 1.5)
        return (askew + hysteresis) * rolling / np.sqrt(rolling**2 + 0.05**2)


def films_of(plain):
    """The films of a plain model of a level, whose options ``films`` are fields of `Films`."""
    return Films(
        shaft_speed=plain.shaft_speed,
        load=np.linalg.norm(plain.load),
        oil=plain.oil,
        rollers=plain.rollers,
        roller_radius=plain.roller_radius,
        length=plain.length,
        inner_radius=plain.inner_radius,
        low_radius=plain.low_radius,
        bore=plain.bore,
        outside=plain.outer_diameter,
        pocket_clearance=plain.pocket_clearance,
        **plain.films,
    )


def starved(exponent):
    """Film and resistance to rolling over those of full inlets.

    The resistance exp(-x) gives the distance S of the meniscus by eq. 44 of Biboulet and Houpert 2010; Grubin's inlet of that length gives the film.
    """
    left = np.exp(-exponent)
    if left > 1 - 1e-15:
        return 1.0, 1.0

    def missed(log_s):
        s = np.exp(log_s)
        return (s**2 + 162.8 * s) / (s**2 + 193.1 * s + 1257) - left

    s = np.exp(brentq(missed, np.log(1e-3), np.log(1e20), xtol=1e-14, rtol=1e-15))
    return 1 / (1 + 1 / (0.75 * s)), left


def hydrodynamic_resistance(load, rolling, curvature_radius, oil, modulus, length, part=1.0, gap=0.0):
    """F_R of full inlets: Goksem and Hargreaves 1978 with the rigid regime of Biboulet and Houpert 2010; fades out below a load of 1 N.

    Beside the ``part`` of the roller that bears, a film as thick as that in the middle and the ``gap`` resists as between rigid bodies; together
    no more than a contact that bears on all of its length.
    """
    stiffness = modulus * curvature_radius
    slow = np.sqrt(rolling**2 + 0.05**2)
    u, g, w = oil.viscosity * slow / stiffness, oil.pressure_viscosity * modulus, larger(load, 1e-3) / (stiffness * length)
    elastic, rigid = 4.318 * (g * u) ** 0.658 * w**0.0126 / g, 1.42 * np.sqrt(2 * u * w)
    heated = 1 + 0.411483 * (oil.viscosity * oil.thinning * slow**2 / 0.0966) ** 0.707071
    law = (elastic**-10 + rigid**-10) ** -0.1
    shorter = part * ((elastic * part**-0.0126) ** -10 + (rigid * part**-0.5) ** -10) ** -0.1
    martin = 4.9 * u / w * curvature_radius
    film = larger(3.06 * u**0.69 * g**0.56 * w**-0.10 * curvature_radius, martin)
    beside = (1 - part) * 1.42 * np.sqrt(9.8) * u * np.sqrt(curvature_radius / (film + gap)) / law
    law = law * (1 - larger(1 - (shorter / law + beside), 0.0))
    return stiffness * length * law / heated * rolling / slow * load / (load + 1.0)


def couette_factor(speed, radius, gap, density, viscosity):
    """Torque between coaxial cylinders over Petroff's: Taylor's vortices and turbulence, whichever is more."""
    reynolds = density * magnitude(speed) * radius * gap / viscosity
    vortices, turbulence = 1.3 * (reynolds * np.sqrt(gap / radius) / 41) ** 0.539, 3.0 * (reynolds / 2500) ** 0.856
    return larger(larger(1.0, vortices), turbulence)
