# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bearing of a scene: raceways, rollers, cage, material, and the checks that its parts fit together."""

import math
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import ArgsKwargs

from bearing_sim.scene.contour import form_errors, settled_form
from bearing_sim.scene.crown import Crown, IsoLogCrown, crown_errors
from bearing_sim.scene.flanges import Flanges, flange_errors
from bearing_sim.scene.material import Material
from bearing_sim.scene.mounting import CLEARANCE_GROUPS, CLEARANCE_PARTS, OTHER_CLEARANCES, clearance_limits
from bearing_sim.scene.outer_ring import OuterRing
from bearing_sim.scene.quantity import Quantity, QuantityOrName, check, named_law, record
from bearing_sim.scene.ratings import Ratings

_CLEARANCE = QuantityOrName(
    "m",
    "radial internal clearance, diametral: 2 (R_low - R_i - D_w); or its group by ISO 5753-1, or another of `bearing_sim.scene.mounting`",
    -1e-3,
    5e-3,
    "um",
    (*CLEARANCE_GROUPS, *CLEARANCE_PARTS, *OTHER_CLEARANCES),
)
# Assumption where a scene does not name boundary dimensions: diameters within 15 %, widths within 40 % of those of the bearings of the catalogue.
_SECTION = 0.27  # roller diameter over D - d
_WIDTH = 0.6  # effective roller length over B
LAND_FIELDS = ("guide_radius", "guide_clearance", "guide_land_width", "guide_land_distance")
_CLOSE = 1e-8  # m; lengths nearer than this are taken as equal
# Fields that each guidance needs in addition to those of every cage.
_NEEDS = {
    "outer_ring": ("inner_radius", "guide_clearance", "guide_land_width"),
    "inner_ring": ("outer_radius", "guide_clearance", "guide_land_width"),
    "roller": ("inner_radius", "outer_radius"),
    "full_complement": (),
}
# A body that takes no part in the motion, in place of the cage of a full complement.
_NO_BODY = {"mass": 1e-6, "width": 1e-4}  # kg, m
_NO_THICKNESS = 0.005  # of it, over D_w, on both sides of the pitch circle


@record
class ContourPoint:
    """A low or high point of the outer raceway."""

    azimuth: Annotated[float, Quantity("rad", "azimuth of the point before installation", -2 * math.pi, 2 * math.pi, "deg")]
    radius: Annotated[float, Quantity("m", "radius there", 1e-3, 2.0, "mm")]


@record
class OuterRaceway:
    """Outer raceway contour R_e(phi) in one of the forms below, each rotated by the installation angle.

    By ``low_radius``, ``d_value`` and ``lobes``: R_low + D/2 - D/2 cos(n phi) (Deng 2017, eq. 2); D = 0 is a round bearing.
    With ``roundness`` e the low points spread from R_low - e/2 to R_low + e/2, and each high point falls as the low point before it rises.
    By ``low_points`` and ``high_points``, each with its own azimuth and radius, joined by half cosine waves.
    By ``contour_file``, points measured over one turn (see `bearing_sim.scene.contour`); ``contour`` holds the text of the file.
    In the last two forms ``low_radius``, ``d_value`` and ``lobes`` follow from the points.
    """

    low_radius: Annotated[float, Quantity("m", "radius at the low points, R_low", 1e-3, 2.0, "mm")] | None = None
    d_value: Annotated[float, Quantity("m", "high-point radius less low-point radius, D", 0.0, 5e-3, "mm")] | None = None
    lobes: Annotated[int, Field(ge=1, le=12)] | None = None  # number of lobes, n
    roundness: Annotated[float, Quantity("m", "highest less lowest of the low points, e", 0.0, 1e-3, "um")] = 0.0
    low_points: tuple[ContourPoint, ...] = ()
    high_points: tuple[ContourPoint, ...] = ()
    contour_file: str | None = None  # path of a CSV file of a measured turn, from the folder of the scene file
    contour: str | None = None  # text of such a file
    contour_angle_unit: str | None = None  # unit of its angles, if its header has none
    contour_radius_unit: str | None = None  # unit of its radii, if its header has none
    installation_angle: Annotated[float, Quantity("rad", "azimuth of a low point, phi_e", -2 * math.pi, 2 * math.pi, "deg")] = 0.0
    contour_slope: bool = True  # whether normal forces lean with the contour; false is Deng's form
    outside_radius: Annotated[float, Quantity("m", "outside radius of the outer ring", 1e-3, 2.0, "mm")] | None = None

    @model_validator(mode="after")
    def _form_is_complete(self):
        errors, settled = form_errors(self), {}
        if not errors:
            settled, errors = settled_form(self)
        if errors:
            raise ValueError("; ".join(errors))
        for name, value in settled.items():
            object.__setattr__(self, name, value)
        return self


@record
class InnerRaceway:
    """Round inner raceway, turning with the shaft."""

    radius: Annotated[float, Quantity("m", "inner raceway radius, R_i", 1e-3, 2.0, "mm")]
    ring_mass: Annotated[float, Quantity("kg", "mass of the inner ring", 1e-4, 1e3)] = 0.05
    polar_inertia: (
        Annotated[float, Quantity("kg*m^2", "inertia of ring and shaft about the shaft axis; None: a solid cylinder", 1e-12, 1e6)] | None
    ) = None
    transverse_inertia: Annotated[float, Quantity("kg*m^2", "their inertia about a diameter; None: half of the polar one", 1e-12, 1e6)] | None = None
    bore_radius: Annotated[float, Quantity("m", "bore radius of the inner ring", 1e-3, 2.0, "mm")] | None = None


@record
class Roller:
    """The rollers, all equal.

    Level ``spatial`` evaluates each contact at the points of a quadrature on the part of the roller that bears, or on equal slices of the roller.
    """

    count: Annotated[int, Field(ge=3, le=200)]  # number of rollers, Z
    diameter: Annotated[float, Quantity("m", "roller diameter, D_w", 0.5e-3, 0.5, "mm")]
    length: Annotated[float, Quantity("m", "roller effective length, L", 0.5e-3, 0.5, "mm")]
    crown: Crown | None = None  # profile of the rollers, see `bearing_sim.scene.crown`; None: not known, taken as that of ISO/TS 16281
    slices: Annotated[int, Field(ge=1, le=400)] | None = None  # equal ones, at level spatial; None: points of a quadrature

    @property
    def profile(self) -> Crown:
        """The crown; ISO's logarithmic one where none is given."""
        return IsoLogCrown() if self.crown is None else self.crown

    @check
    def _crown_fits(self) -> list[str]:
        return crown_errors(self.profile, self.length)


@record
class Contact:
    """Normal contacts: the spring constant, and damping that never pulls: Q (1 + (a + 10/9 tau/(delta + h)) d(delta)/dt).

    See `bearing_sim.physics.contact.damped_line_contact`.
    """

    spring: Literal["palmgren", "iso"] = "palmgren"  # A_1 of the material, or c_L of ISO/TS 16281, which is for steel
    damping: Annotated[float, Quantity("", "a [s/m]; 0.104 is a viscous ratio of 0.05 for a 7 mm roller at 500 N", 0.0, 100.0)] = 0.104
    damping_time: Annotated[float, Quantity("s", "tau, damping over stiffness; Kraemer: 2.5 to 25 us", 0.0, 1e-3, "us")] = 2.5e-6
    damping_depth: Annotated[float, Quantity("m", "h, penetration at which half of that is left", 1e-9, 1e-4, "um")] = 1e-7


@record
class Roughness:
    """Root-mean-square roughness of the rolling surfaces; used only for the lambda ratio of the monitoring."""

    roller: Annotated[float, Quantity("m", "roughness of the rollers, R_q", 1e-10, 1e-4, "um")]
    raceway: Annotated[float, Quantity("m", "roughness of the raceways, R_q", 1e-10, 1e-4, "um")]

    @property
    def composite(self) -> float:
        """Root of the sum of squares, sigma = sqrt(R_q1^2 + R_q2^2) [m]."""
        return math.hypot(self.roller, self.raceway)


@record
class Cage:
    """The cage, guided by two lands of a ring or by the rollers in its pockets (Harris and Kotzalas 2006, chapter 18).

    ``outer_ring``: lands of radius R_g on the outer ring around the cage, whose outer surface is at R_g - c.
    ``inner_ring``: lands of radius R_g on the inner ring within the cage, whose bore is at R_g + c.
    ``roller``: no lands; pockets that also hold the rollers radially carry the cage.
    ``full_complement``: no cage; neighbouring rollers touch, so that all orbit at one speed, and ``pocket_friction`` is that between them.
    For a cage on lands, give the radius of its running surface or that of the lands, or both if they agree.
    """

    guidance: Literal["outer_ring", "inner_ring", "roller", "full_complement"] = "outer_ring"  # what guides the cage
    mass: Annotated[float, Quantity("kg", "cage mass", 1e-6, 1e3, "g")]
    polar_inertia: Annotated[float, Quantity("kg*m^2", "cage inertia about the shaft axis", 1e-12, 1e3)] | None = None
    transverse_inertia: Annotated[float, Quantity("kg*m^2", "cage inertia about a diameter; None: half of the polar one", 1e-12, 1e3)] | None = None
    inner_radius: Annotated[float, Quantity("m", "radius of the cage's bore", 1e-3, 2.0, "mm")] | None = None
    outer_radius: Annotated[float, Quantity("m", "radius of the cage's outer surface", 1e-3, 2.0, "mm")] | None = None
    width: Annotated[float, Quantity("m", "axial width of the cage", 1e-4, 1.0, "mm")]
    material: Material = field(default_factory=Material)
    guide_radius: Annotated[float, Quantity("m", "radius of the guiding ring's lands, R_g", 1e-3, 2.0, "mm")] | None = None
    guide_clearance: Annotated[float, Quantity("m", "radial clearance between cage and guide lands, c", 1e-6, 5e-3, "mm")] | None = None
    guide_land_width: Annotated[float, Quantity("m", "width of one of the two guide lands", 1e-6, 0.5, "mm")] | None = None
    guide_land_distance: (
        Annotated[float, Quantity("m", "between the middles of both guide lands; None: at the cage's edges", 0.0, 1.0, "mm")] | None
    ) = None
    land_film: Annotated[float, Quantity("m", "film in the guide land below which surfaces touch", 0.0, 1e-4, "um")] = 3e-6
    land_friction: Annotated[float, Quantity("", "boundary friction coefficient of the guide land", 0.0, 1.0)] = 0.08
    land_vortices: bool = True  # vortices and turbulence add to the drag of the guide land; false: laminar, as Deng's form
    land_squeeze: bool = True  # the film includes the motion of the cage centre; false: Deng's form for a centre at rest
    pocket_friction: Annotated[float, Quantity("", "friction coefficient between roller and pocket, mu_c", 0.0, 1.0)] = 0.05
    # Level slip models neither pocket forces nor whirl; these two fields give it their effect on the cage.
    pocket_reaction: bool = False  # at level slip, pocket friction brakes the cage as well as the rollers
    assumed_eccentricity: Annotated[float, Quantity("", "eccentricity of the cage at level slip, a fraction of the guide clearance", 0.0, 0.999)] = (
        0.0
    )
    pocket_clearance: Annotated[float, Quantity("m", "clearance between roller and pocket along the orbit, C_p", 1e-6, 5e-3, "mm")] = 1e-4
    pocket_radial_clearance: (
        Annotated[float, Quantity("m", "radial clearance of pockets that guide the cage; None: as along the orbit", 1e-6, 5e-3, "mm")] | None
    ) = None
    pocket_film_force: Annotated[float, Quantity("N", "force of the pocket's oil film when the clearance is used up", 0.0, 1e4)] = 67.0
    pocket_film_damping: Annotated[float, Quantity("", "damping of the pocket's oil film [N s/m]", 0.0, 1e4)] = 5.0

    @model_validator(mode="before")
    @classmethod
    def _full_complement_has_no_body(cls, given):
        fields = given.kwargs if isinstance(given, ArgsKwargs) else given
        if not isinstance(fields, Mapping) or fields.get("guidance") != "full_complement":
            return given
        return {**_NO_BODY, **fields}

    @property
    def has_lands(self) -> bool:
        """Whether lands guide the cage."""
        return self.guidance in ("outer_ring", "inner_ring")

    @property
    def is_absent(self) -> bool:
        """Whether the bearing has a full complement of rollers, without a cage."""
        return self.guidance == "full_complement"

    @property
    def land_radius(self) -> float:
        """R_g [m]; NaN where there are no lands."""
        if not self.has_lands:
            return float("nan")
        if self.guide_radius is not None:
            return self.guide_radius
        return self.outer_radius + self.guide_clearance if self.guidance == "outer_ring" else self.inner_radius - self.guide_clearance

    @property
    def outside(self) -> float:
        """Radius of the outer surface [m]."""
        return self.land_radius - self.guide_clearance if self.guidance == "outer_ring" else self.outer_radius

    @property
    def bore(self) -> float:
        """Radius of the bore [m]."""
        return self.land_radius + self.guide_clearance if self.guidance == "inner_ring" else self.inner_radius

    @property
    def play(self) -> float:
        """How far the cage's centre can move in its guidance [m]: the land clearance, or the radial pocket clearance."""
        if self.has_lands:
            return self.guide_clearance
        return self.pocket_radial_clearance if self.pocket_radial_clearance is not None else self.pocket_clearance

    @check
    def _guidance_is_complete(self) -> list[str]:
        errors = [f"{name}: missing; a cage with guidance {self.guidance} needs it" for name in _NEEDS[self.guidance] if getattr(self, name) is None]
        return errors + (self._errors_with_lands() if self.has_lands else self._errors_without_lands())

    def _errors_with_lands(self) -> list[str]:
        running, sign = ("outer_radius", 1) if self.guidance == "outer_ring" else ("inner_radius", -1)
        surface, land, clearance = getattr(self, running), self.guide_radius, self.guide_clearance
        errors = []
        if surface is None and land is None:
            errors.append(f"guide_radius: missing; a cage with guidance {self.guidance} needs the radius of its lands, or {running}")
        elif None not in (surface, land, clearance) and abs(surface - (land - sign * clearance)) > _CLOSE:
            errors.append(
                f"{running}: {1e3 * surface:.6g} mm, but lands at guide_radius {1e3 * land:.6g} mm with guide_clearance {1e3 * clearance:.6g} mm "
                f"leave it at {1e3 * (land - sign * clearance):.6g} mm; give one of {running} and guide_radius, and leave the other out (null)"
            )
        if self.pocket_radial_clearance is not None:
            errors.append(f"pocket_radial_clearance: lands guide this cage ({self.guidance}); leave it out, or set guidance: roller")
        return errors

    def _errors_without_lands(self) -> list[str]:
        guidance = self.guidance
        errors = [
            f"{name}: a cage with guidance {guidance} has no lands; leave it out (null)" for name in LAND_FIELDS if getattr(self, name) is not None
        ]
        if self.assumed_eccentricity:
            errors.append(f"assumed_eccentricity: a cage with guidance {guidance} has no lands to be eccentric in; leave it out")
        if self.is_absent:
            errors += [f"{name}: a full complement has no cage; leave it out" for name, none in _NO_BODY.items() if getattr(self, name) != none]
        return errors


@record
class NoSeals:
    """An open bearing."""

    law: Literal["none"] = "none"


@record
class SealMoment:
    """Seals that rub on the shaft with a constant moment."""

    law: Literal["constant_moment"] = "constant_moment"
    moment: Annotated[float, Quantity("N*m", "frictional moment of all seals together", 0.0, 1e4)]


@record
class SkfSeals:
    """Two contact seals by SKF's K_S1 d_s^beta + K_S2 in N mm and mm (SKF, The SKF model for calculating the frictional moment).

    The defaults are its constants for LS seals of cylindrical roller bearings with outside diameters from 42 to 360 mm; one seal has half the moment.
    """

    law: Literal["skf"] = "skf"
    diameter: Annotated[float, Quantity("m", "diameter of the counterface, d_s; None: that of the outer raceway, E", 1e-3, 4.0, "mm")] | None = None
    exponent: Annotated[float, Quantity("", "beta", 0.0, 3.0)] = 2.0
    factor: Annotated[float, Quantity("", "K_S1", 0.0, 10.0)] = 0.032
    offset: Annotated[float, Quantity("", "K_S2 [N mm]", 0.0, 1e4)] = 50.0
    count: Annotated[int, Field(ge=1, le=2)] = 2  # seals


Seals = Annotated[NoSeals | SealMoment | SkfSeals, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``none``, ``skf``)."""


@record
class EstimatedField:
    """A field of the bearing that follows from a rule, and how far it may be off.

    ``low`` and ``high`` bound the middle 90 %: as factors of the value, or as numbers where the field is a count.
    """

    field: str  # path within the bearing, such as roller.length
    by: str  # the rule, with its error
    low: float  # low end of its range
    high: float  # high end

    @check
    def _range_is_ordered(self) -> list[str]:
        if not 0.0 < self.low <= self.high:
            return [f"low: {self.low:g} is not above 0 and at most high, {self.high:g}"]
        return []


@record
class Bearing:
    """One cylindrical roller bearing."""

    name: str  # name of the bearing
    source: str  # where its dimensions come from
    # Whether dimensions are those of the running bearing, or those on the drawing, which fits, rotation and heat change.
    dimensions_at: Literal["cold", "running"] = "cold"
    reference_temperature: Annotated[float, Quantity("K", "temperature at which cold dimensions are valid", 150.0, 800.0, "degC")] = 293.15
    # Instead of outer_raceway.low_radius; the middle of the limits is taken for a group.
    clearance: Annotated[float | str, _CLEARANCE] | None = None
    outer_raceway: OuterRaceway
    outer_ring: OuterRing = field(default_factory=OuterRing)  # where it bends, see `mounting.housing.backing`
    inner_raceway: InnerRaceway
    roller: Roller
    cage: Cage
    material: Material = field(default_factory=Material)
    contact: Contact = field(default_factory=Contact)
    roughness: Roughness | None = None  # None: the lambda ratio is neither computed nor monitored
    ratings: Ratings = field(default_factory=Ratings)  # what the maker rates the bearing for
    width: Annotated[float, Quantity("m", "width of the bearing, B; None: estimated from the rollers' length", 1e-3, 2.0, "mm")] | None = None
    seals: Seals = field(default_factory=NoSeals)
    flanges: Flanges = field(default_factory=Flanges)
    designation: str = ""  # of the catalogue bearing that these dimensions are of, such as NU 210 ECP/C3
    estimated: tuple[EstimatedField, ...] = ()  # fields that no source gives, see `bearing_sim.scene.internal_dimensions`

    @property
    def bore_diameter(self) -> float:
        """Bore diameter d [m]: the inner ring's, or an estimate from the rollers' diameter (assumption)."""
        bore = self.inner_raceway.bore_radius
        return 2 * bore if bore is not None else max(self.pitch_diameter - self.roller.diameter / (2 * _SECTION), 0.2 * self.inner_raceway.radius)

    @property
    def outside_diameter(self) -> float:
        """D [m]: the outer ring's, or an estimate from the rollers' diameter (assumption)."""
        outside = self.outer_raceway.outside_radius
        return 2 * outside if outside is not None else self.pitch_diameter + self.roller.diameter / (2 * _SECTION)

    @property
    def boundary_width(self) -> float:
        """B [m], or an estimate from the rollers' length (assumption)."""
        return self.width if self.width is not None else self.roller.length / _WIDTH

    @property
    def seal_moment(self) -> float:
        """Frictional moment of the seals [N m]."""
        if self.seals.law == "constant_moment":
            return self.seals.moment
        if self.seals.law == "skf":
            diameter = self.seals.diameter if self.seals.diameter is not None else 2 * self.outer_raceway.low_radius
            return 1e-3 * self.seals.count / 2 * (self.seals.factor * (1e3 * diameter) ** self.seals.exponent + self.seals.offset)
        return 0.0

    @model_validator(mode="after")
    def _raceway_has_a_radius(self):
        if error := self._error_of_clearance():
            raise ValueError(error)
        if self.outer_raceway.low_radius is None:
            object.__setattr__(self, "outer_raceway", replace(self.outer_raceway, low_radius=self._low_radius_by_clearance()))
        return self

    @model_validator(mode="after")
    def _absent_cage_is_on_the_pitch_circle(self):
        half = _NO_THICKNESS * self.roller.diameter
        if self.cage.is_absent:
            radii = {"inner_radius": self.pitch_radius - half, "outer_radius": self.pitch_radius + half}
            object.__setattr__(self, "cage", replace(self.cage, **radii))
        return self

    def _low_radius_by_clearance(self) -> float:
        clearance = self.clearance
        if isinstance(clearance, str):
            clearance = clearance_limits(clearance, 2 * self.inner_raceway.bore_radius).mean
        return self.inner_raceway.radius + self.roller.diameter + clearance / 2

    def _error_of_clearance(self) -> str:
        raceway, inner = self.outer_raceway, self.inner_raceway
        if self.clearance is None:
            missing = "outer_raceway.low_radius: missing; give it, or bearing.clearance, or low_points and high_points, or contour_file"
            return missing if raceway.low_radius is None else ""
        if isinstance(self.clearance, str):
            if inner.bore_radius is None:
                return f"inner_raceway.bore_radius: missing; the clearance of group {self.clearance} (ISO 5753-1) follows from the bore"
            try:
                clearance_limits(self.clearance, 2 * inner.bore_radius)
            except ValueError as error:
                return f"clearance: {error}"
        if raceway.low_points or raceway.contour is not None:
            return "clearance: the points of the contour give the raceway's radius; leave clearance out (null)"
        low = self._low_radius_by_clearance()
        if raceway.low_radius is not None and abs(raceway.low_radius - low) > _CLOSE:
            return (
                f"clearance: outer_raceway.low_radius is {1e3 * raceway.low_radius:.6g} mm, but this clearance makes it {1e3 * low:.6g} mm; give one "
                "of the two, and leave the other out (null)"
            )
        return ""

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
        """R_low - R_i - D_w [m]; negative: preload at the low points."""
        return self.outer_raceway.low_radius - self.inner_raceway.radius - self.roller.diameter

    @check
    def _parts_fit_together(self) -> list[str]:
        errors = []
        if self.roller.count * self.roller.diameter > 2 * self.pitch_radius * math.pi:
            errors.append(
                f"roller: {self.roller.count} rollers of {1e3 * self.roller.diameter:.6g} mm do not fit on a pitch circle of "
                f"{2e3 * self.pitch_radius:.6g} mm; use fewer or thinner ones"
            )
        clearance = self.radial_clearance_at_low_points
        if not -0.02 * self.roller.diameter <= clearance <= 0.5 * self.roller.diameter:
            given = (
                f"outer_raceway.low_radius: {1e3 * self.outer_raceway.low_radius:.6g} mm"
                if self.clearance is None
                else f"clearance: {self.clearance}"
            )
            errors.append(
                f"{given} leaves {1e6 * clearance:.6g} um between inner "
                f"raceway, roller and low point; expected {-2e4 * self.roller.diameter:.6g} to {5e5 * self.roller.diameter:.6g} um"
            )
        return errors + ring_errors(self) + cage_errors(self) + play_errors(self) + flange_errors(self) + estimate_errors(self)


def estimate_errors(bearing) -> list[str]:
    """Return error messages for estimates of fields that the bearing does not have."""
    errors = []
    for each in bearing.estimated:
        value = bearing
        for name in each.field.split("."):
            value = getattr(value, name, None)
        if not isinstance(value, (int, float)):
            errors.append(f"estimated: this bearing has no number {each.field}; leave its entry out")
    return errors


def ring_errors(bearing) -> list[str]:
    """Return error messages for rings whose raceway is not between their bore and their outside."""
    inner, outer, errors = bearing.inner_raceway, bearing.outer_raceway, []
    if inner.bore_radius is not None and inner.bore_radius >= inner.radius:
        errors.append(
            f"inner_raceway.bore_radius: {1e3 * inner.bore_radius:.6g} mm is not below the raceway's radius, {1e3 * inner.radius:.6g} mm; "
            "give that of this bearing, or null"
        )
    high = outer.low_radius + outer.d_value
    if outer.outside_radius is not None and outer.outside_radius <= high:
        errors.append(
            f"outer_raceway.outside_radius: {1e3 * outer.outside_radius:.6g} mm is not above the raceway's radius, {1e3 * high:.6g} mm; give that of "
            "this bearing, or null"
        )
    return errors


def cage_errors(bearing) -> list[str]:
    """Return error messages for a cage that does not fit between the rings."""
    cage, inner, low = bearing.cage, bearing.inner_raceway.radius, bearing.outer_raceway.low_radius
    errors = []
    bore_name = "cage.guide_radius" if cage.guidance == "inner_ring" and cage.guide_radius is not None else "cage.inner_radius"
    outside_name = "cage.guide_radius" if cage.guidance == "outer_ring" and cage.guide_radius is not None else "cage.outer_radius"
    if cage.bore >= cage.outside:
        errors.append(
            f"{bore_name}: the cage's bore, at {1e3 * cage.bore:.6g} mm, lies outside its outer surface, at {1e3 * cage.outside:.6g} mm; "
            f"expected a bore between the inner raceway ({1e3 * inner:.6g} mm) and there"
        )
    if cage.bore <= inner:
        errors.append(
            f"{bore_name}: the cage's bore, at {1e3 * cage.bore:.6g} mm, cuts into the inner raceway ({1e3 * inner:.6g} mm); make it larger"
        )
    if cage.outside >= low:
        errors.append(
            f"{outside_name}: the cage's outer surface, at {1e3 * cage.outside:.6g} mm, cuts into the outer raceway ({1e3 * low:.6g} mm at its low "
            "points); make it smaller"
        )
    if cage.is_absent:
        return errors
    errors += _land_errors(bearing) if cage.has_lands else _pocket_errors(bearing)
    if not errors and cage.guidance != "outer_ring" and cage.play >= min(cage.bore - inner, low - cage.outside):
        name, room = "guide_clearance" if cage.has_lands else "pocket_radial_clearance", min(cage.bore - inner, low - cage.outside)
        errors.append(
            f"cage.{name}: {1e3 * cage.play:.6g} mm lets the cage touch a raceway, {1e3 * room:.6g} mm away, before its guidance stops it; "
            "expected less, or a slimmer cage"
        )
    return errors


def _land_errors(bearing) -> list[str]:
    cage, pitch = bearing.cage, bearing.pitch_radius
    errors = []
    outside = cage.land_radius > pitch
    if outside != (cage.guidance == "outer_ring"):
        side, other = ("outside", "inner_ring") if cage.guidance == "outer_ring" else ("inside", "outer_ring")
        errors.append(
            f"cage.guide_radius: lands of the {cage.guidance.replace('_', ' ')} lie {side} the pitch circle ({1e3 * pitch:.6g} mm), found "
            f"{1e3 * cage.land_radius:.6g} mm; give a radius there, or set guidance: {other}"
        )
    if 2 * cage.guide_land_width > cage.width:
        errors.append("cage.guide_land_width: the two lands together are wider than the cage")
    return errors


def _pocket_errors(bearing) -> list[str]:
    """Return an error if the lobes move the rollers by more than the radial clearance of their pockets."""
    cage, lift = bearing.cage, bearing.outer_raceway.d_value / 2
    if cage.play > lift:
        return []
    return [
        f"cage.pocket_radial_clearance: the lobes move the rollers outwards and inwards by {1e6 * lift:.6g} um (half the D value), the pockets "
        f"that guide the cage leave them {1e6 * cage.play:.6g} um; expected more clearance than that"
    ]


def play_errors(bearing) -> list[str]:
    """Return error messages for clearances of the cage that are too small or too large."""
    cage, roller, errors = bearing.cage, bearing.roller, []
    if cage.has_lands and cage.guide_clearance <= cage.land_film:
        errors.append(
            f"cage.guide_clearance: {1e6 * cage.guide_clearance:.6g} um is no more than cage.land_film, the film at which surfaces touch, so that "
            f"the cage would touch its land all round; expected more than {1e6 * cage.land_film:.6g} um, or a smaller land_film"
        )
    if cage.guidance == "outer_ring" and cage.land_radius >= bearing.outer_raceway.low_radius:
        errors.append(
            f"cage.guide_radius: {1e3 * cage.land_radius:.6g} mm puts the guide lands outside the raceway; expected less than "
            f"outer_raceway.low_radius, {1e3 * bearing.outer_raceway.low_radius:.6g} mm"
        )
    bar = 2 * math.pi * bearing.pitch_radius / roller.count - roller.diameter - 2 * cage.pocket_clearance
    if bar <= 0.0 and not cage.is_absent:
        bound = cage.pocket_clearance + bar / 2
        use = f"expected less than {1e3 * bound:.6g} mm" if bound > 0.0 else "use fewer or thinner rollers"
        errors.append(
            f"cage.pocket_clearance: {1e3 * cage.pocket_clearance:.6g} mm leaves no bar between the pockets of {roller.count} rollers of "
            f"{1e3 * roller.diameter:.6g} mm; {use}"
        )
    return errors
