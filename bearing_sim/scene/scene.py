# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The scene: everything a run needs, as frozen records in SI.

One record per block of the YAML file.  Each quantity is declared once, with unit, bounds and meaning;
`bearing_sim.scene_file` reads files against these declarations.
"""

import math
from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bearing_sim import effects
from bearing_sim.crown import Crown, NoCrown, crown_faults
from bearing_sim.methods import FIXED_STEP, METHODS
from bearing_sim.quantity import quantity
from bearing_sim.scene_bounds import moment_faults, play_faults, step_faults
from bearing_sim.scene_cage import Cage, cage_faults
from bearing_sim.scene_lubricant import CustomOil, Oil, Oil4109Traction, Traction
from bearing_sim.scene_monitoring import Thresholds
from bearing_sim.scene_raceway import InnerRaceway, OuterRaceway, RingGrowth, growth_faults
from bearing_sim.scene_record import record as _strict
from bearing_sim.scene_uncertainty import Range, range_faults


@_strict
class Roller:
    """The rollers, all equal.

    Level ``spatial`` cuts them into slices; so many neighbours at a time share a traction coefficient, that of their mean load.
    """

    count: Annotated[int, Field(ge=3, le=200)]
    diameter: quantity("m", "roller diameter, D_w", 0.5e-3, 0.5, "mm")
    length: quantity("m", "roller effective length, L", 0.5e-3, 0.5, "mm")
    crown: Crown = field(default_factory=NoCrown)  # see `bearing_sim.crown`
    slices: Annotated[int, Field(ge=1, le=400)] = 20  # of a roller where the level slices it; ISO/TS 16281 asks for 30 for a life
    slices_per_traction: Annotated[int, Field(ge=1, le=400)] = 4  # that share one coefficient of traction

    @model_validator(mode="after")
    def _crown_fits(self):
        faults = crown_faults(self.crown, self.length)
        if faults:
            raise ValueError("; ".join(faults))
        return self


@_strict
class Contact:
    """Normal contacts: the spring constant, and dissipation after Hunt and Crossley: Q (1 + a d(delta)/dt), never pulling."""

    spring: Literal["palmgren", "iso"] = "palmgren"  # A_1 of the material, or c_L of ISO/TS 16281, which is for steel
    damping: quantity("", "a [s/m]; 0.104 is a viscous ratio of 0.05 for a 7 mm roller at 500 N", 0.0, 100.0) = 0.104


@_strict
class Material:
    """Elastic constants and density of rings and rollers."""

    youngs_modulus: quantity("Pa", "Young's modulus, E", 1e9, 1e12, "GPa") = 2.06e11
    poisson_ratio: quantity("", "Poisson's ratio, nu", 0.0, 0.49) = 0.3
    density: quantity("kg/m^3", "density", 500.0, 25e3) = 7850.0


@_strict
class Roughness:
    """Root-mean-square roughness of the surfaces that roll on each other; only the lambda ratio of the monitoring knows it."""

    roller: quantity("m", "roughness of the rollers, R_q", 1e-10, 1e-4, "um")
    raceway: quantity("m", "roughness of the raceways, R_q", 1e-10, 1e-4, "um")

    @property
    def composite(self) -> float:
        """Root of the sum of squares, sigma = sqrt(R_q1^2 + R_q2^2) [m]."""
        return math.hypot(self.roller, self.raceway)


@_strict
class Bearing:
    """One cylindrical roller bearing."""

    name: str
    source: str
    outer_raceway: OuterRaceway
    inner_raceway: InnerRaceway
    roller: Roller
    cage: Cage
    material: Material = field(default_factory=Material)
    contact: Contact = field(default_factory=Contact)
    ring_growth: RingGrowth = field(default_factory=RingGrowth)
    roughness: Roughness | None = None  # None: no lambda ratio is told or judged

    @property
    def pitch_radius(self) -> float:
        """r_m = R_i + R_w [m]."""
        return self.inner_raceway.radius + self.roller.diameter / 2

    @property
    def pitch_diameter(self) -> float:
        """d_m = 2 r_m [m]."""
        return 2 * self.pitch_radius

    @property
    def diameter_ratio(self) -> float:
        """The ratio gamma = D_w / d_m."""
        return self.roller.diameter / self.pitch_diameter

    @property
    def radial_clearance_at_low_points(self) -> float:
        """R_low - R_i - D_w [m]; negative where the low points squeeze the rollers."""
        return self.outer_raceway.low_radius - self.inner_raceway.radius - self.roller.diameter

    @model_validator(mode="after")
    def _parts_fit_together(self):
        # Several faults may hold at once: an author fixes a file faster when told all of them.
        faults = []
        if self.roller.count * self.roller.diameter > 2 * self.pitch_radius * math.pi:
            faults.append(
                f"roller: {self.roller.count} rollers of {1e3 * self.roller.diameter:.6g} mm do not fit on a pitch circle of "
                f"{2e3 * self.pitch_radius:.6g} mm; use fewer or thinner ones"
            )
        clearance = self.radial_clearance_at_low_points
        if not -0.02 * self.roller.diameter <= clearance <= 0.5 * self.roller.diameter:
            faults.append(
                f"outer_raceway.low_radius: {1e3 * self.outer_raceway.low_radius:.6g} mm leaves {1e6 * clearance:.6g} um between inner "
                f"raceway, roller and low point; expected {-2e4 * self.roller.diameter:.6g} to {5e5 * self.roller.diameter:.6g} um"
            )
        faults += cage_faults(self) + play_faults(self) + growth_faults(self)
        if faults:
            raise ValueError("; ".join(faults))
        return self


@_strict
class Lubricant:
    """The oil, how much of it is in the air inside the bearing, and how it transmits tangential force."""

    oil: Annotated[Oil | CustomOil, Field(discriminator="law")]
    temperature: quantity("K", "oil temperature", 220.0, 600.0, "degC") = 393.15
    mixture_fraction: quantity("", "volume fraction of oil in the oil-air mixture", 0.0, 1.0) = 0.03
    traction_scale: quantity("", "factor on every traction coefficient", 0.0, 100.0) = 1.0
    traction: Traction = field(default_factory=Oil4109Traction)
    pumping: bool = False  # resistance of the oil that the inlets of the contacts pump back


@_strict
class Operating:
    """Constant conditions of `bearing-sim run`; a live run takes them for an input that has not come yet."""

    shaft_speed: quantity("rad/s", "shaft speed, omega_i", -12000.0, 12000.0, "rpm")
    radial_load: quantity("N", "radial load on the inner ring, F_r", 0.0, 1e6) = 0.0
    load_angle: quantity("rad", "azimuth of the radial load, from +y", -2 * math.pi, 2 * math.pi, "deg") = 0.0
    moment: quantity("N*m", "moment on the inner ring, which then tilts freely; None: its tilt is held", 0.0, 1e5) | None = None
    moment_angle: quantity("rad", "azimuth to which the moment leans the ring's +x end, from +y", -2 * math.pi, 2 * math.pi, "deg") = 0.0
    misalignment: quantity("rad", "tilt at which the inner ring is held", 0.0, 0.02, "mrad") = 0.0
    misalignment_angle: quantity("rad", "azimuth to which the ring's +x end leans, from +y", -2 * math.pi, 2 * math.pi, "deg") = 0.0

    @model_validator(mode="after")
    def _ring_is_held_or_free(self):
        if self.moment is not None and self.misalignment != 0.0:
            raise ValueError("misalignment: a ring under a moment tilts freely; give the moment or the misalignment")
        return self


@_strict
class Dynamics:
    """What the equations of motion take into account."""

    gyroscopic: bool = True


@_strict
class Integration:
    """How time is advanced.

    The error that the tolerance bounds is that of the embedded first-order method, a pessimist: at 1e-2 the second-order
    result has settled, and a little under half a roller pitch of cage rotation is what limits the step.
    With a fixed step nothing is estimated: first and longest step go unused.
    """

    method: str | None = None  # see `bearing_sim.methods`; None is the level's own
    relative_tolerance: quantity(
        "", "error allowed in a step, relative to the state; with a fixed step, what ends an iteration, 1e-7 or more", 1e-10, 0.1
    ) = 1e-2
    maximum_step: quantity("s", "longest step", 1e-9, 1.0, "us") = 1e-2
    first_step: quantity("s", "first step", 1e-12, 1.0, "us") = 1e-5
    fixed_step: quantity("s", "step without error control, for hard real time", 1e-9, 1e-2, "us") | None = None
    step_budget: Annotated[int, Field(ge=10, le=1_000_000_000)] = 2_000_000


@_strict
class InputLimits:
    """What an input message may be; anything else is refused, said, and the last good value held."""

    maximum_speed: quantity("rad/s", "largest shaft speed accepted", 0.0, 12000.0, "rpm") = 100_000 * math.pi / 30
    maximum_load: quantity("N", "largest radial load accepted", 0.0, 1e6) = 50_000.0
    minimum_temperature: quantity("K", "lowest oil temperature accepted", 150.0, 800.0, "degC") = 233.15
    maximum_temperature: quantity("K", "highest oil temperature accepted", 150.0, 800.0, "degC") = 523.15
    reverse_rotation: bool = False
    stale_after: quantity("s", "age at which an input counts as stale", 1e-3, 3600.0) = 1.0
    minimum_rate: quantity("Hz", "lowest message rate expected", 0.0, 1e5) = 1.0
    maximum_rate: quantity("Hz", "highest message rate expected", 0.0, 1e5) = 2000.0


CLEANLINESS = Literal[
    "none",
    "filtered_13_10",
    "filtered_15_12",
    "filtered_17_14",
    "filtered_19_16",
    "bath_13_10",
    "bath_15_12",
    "bath_17_14",
    "bath_19_16",
    "bath_21_18",
]


@_strict
class LifeRating:
    """Which life the damage counts: L_nm = a_1 a_ISO L_10 (ISO 281); all defaults leave the basic life L_10 (Deng 2017).

    a_iso names the oil's cleanliness by the class that its ISO 4406 code ends in: `filtered`, circulating through a filter in line,
    or `bath`, without one or through one off the line; none takes a_ISO = 1.
    """

    reliability: quantity("", "probability of reaching the life", 0.9, 0.9995, "%") = 0.9
    a_iso: CLEANLINESS = "none"
    lamina: bool = False  # by slices, with stress risers (ISO/TS 16281)

    @property
    def is_basic(self) -> bool:
        """Whether the life that counts is the basic one, L_10."""
        return self.reliability == 0.9 and self.a_iso == "none" and not self.lamina


@_strict
class SteadyTable:
    """The table of operating points of level ``steady``: all load directions, and what it spans besides."""

    tolerance: quantity("", "error allowed in slip, over 0.025 points of it, and in life, relative", 1e-4, 0.5, "%") = 0.02
    maximum_speed: quantity("rad/s", "highest shaft speed; None: a fifth above the operating speed", 1.0, 12000.0, "rpm") | None = None
    maximum_load: quantity("N", "largest radial load; None: half the bearing's dynamic load rating", 1.0, 1e6) | None = None
    minimum_temperature: quantity("K", "lowest oil temperature", 220.0, 600.0, "degC") = 313.15
    maximum_temperature: quantity("K", "highest oil temperature", 220.0, 600.0, "degC") = 453.15

    @model_validator(mode="after")
    def _spans_something(self):
        if self.maximum_temperature < self.minimum_temperature:
            raise ValueError(f"minimum_temperature: {self.minimum_temperature:g} K is above the maximum_temperature, {self.maximum_temperature:g} K")
        return self


@_strict
class Scene:
    """One bearing, its oil, its operating conditions, and how it is computed."""

    name: str
    description: str = ""
    level: Literal["steady", "slip", "planar", "spatial"] = "slip"
    # `level: auto` in a file: the cheapest that has these, and all else that the scene says; why, is then entered here.
    wants: tuple[Literal[tuple(effects.WANTS)], ...] = ()
    level_reason: str = ""
    bearing: Bearing
    lubricant: Lubricant
    operating: Operating
    dynamics: Dynamics = field(default_factory=Dynamics)
    integration: Integration = field(default_factory=Integration)
    input_limits: InputLimits = field(default_factory=InputLimits)
    thresholds: Thresholds = field(default_factory=Thresholds)
    life: LifeRating = field(default_factory=LifeRating)
    table: SteadyTable = field(default_factory=SteadyTable)
    uncertainty: tuple[Range, ...] = ()  # in a file a mapping of field to range, see `bearing_sim.scene_uncertainty`

    @property
    def cage_whirls(self) -> bool:
        """Whether the level moves the cage's centre."""
        return self.level not in ("steady", "slip")

    @property
    def bodies_tilt(self) -> bool:
        """Whether the level tilts rollers, ring and cage, and so tells what along a roller differs."""
        return self.level == "spatial"

    @model_validator(mode="after")
    def _level_sees_what_the_scene_says(self):
        faults = effects.refusals(self)
        if faults:
            raise ValueError("; ".join(faults))
        return self

    @model_validator(mode="after")
    def _method_is_one_of_the_level(self):
        names = METHODS.get(self.level)
        if names is None:  # known to statics only
            return self
        method = self.integration.method or names[0]
        if method not in names:
            offered = " or ".join(filter(None, (", ".join(names[:-1]), names[-1])))
            raise ValueError(f"integration.method: level {self.level} is integrated by {offered}, not by {method}")
        if self.integration.fixed_step is not None and method not in FIXED_STEP:
            raise ValueError(f"integration.fixed_step: {method} chooses its steps; {' and '.join(FIXED_STEP)} can keep to one")
        return self

    @model_validator(mode="after")
    def _operation_is_within_bounds(self):
        faults = step_faults(self) + moment_faults(self) + range_faults(self)
        if faults:
            raise ValueError("; ".join(faults))
        return self
