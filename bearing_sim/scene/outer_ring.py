# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The outer ring as an elastic ring: its section, and what backs it in the housing.

Without a backing that yields the ring is rigid, as in Deng et al. 2017.  With one it bends (`bearing_sim.physics.outer_ring`), and these records say
how stiff it is, where it sits and how much play it has there.
"""

import math
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BeforeValidator, Field

from bearing_sim.scene.flanges import flange_geometry
from bearing_sim.scene.quantity import Quantity, check, named_law, record

_CLOSE = 1e-9  # m
_SPREAD_MOMENT = 0.0435  # over F R, see `_stress_errors`
_LARGEST_SHARE = 5.0  # of the mean load of all rollers, that the most heavily loaded one carries (R. Stribeck 1901)


@record
class OuterRing:
    """Section of the outer ring where it bends: a wall from the raceway to the seat, and ribs where the ring has flanges.

    What is given replaces what follows from that.  The equivalent thickness replaces the bending stiffness alone, E width thickness^3/12: the one
    that `bearing-sim machine` takes, so that the ring that was bent is the ring that bends.
    """

    width: Annotated[float, Quantity("m", "width of ring and seat; None: that of the bearing", 1e-3, 2.0, "mm")] | None = None
    equivalent_thickness: (
        Annotated[float, Quantity("m", "thickness of a flat section as stiff in bending; None: by wall and ribs", 1e-4, 0.5, "mm")] | None
    ) = None
    area: Annotated[float, Quantity("m^2", "area of the section; None: of wall and ribs", 1e-8, 1.0, "mm^2")] | None = None
    neutral_radius: Annotated[float, Quantity("m", "radius of the neutral line; None: of wall and ribs", 1e-3, 2.0, "mm")] | None = None
    seat_radius: Annotated[float, Quantity("m", "radius of the seat; None: outer_raceway.outside_radius", 1e-3, 2.0, "mm")] | None = None
    shear: bool = True  # whether shear makes the ring softer, which counts from n t/R of about 0.3 on
    points: Annotated[int, Field(ge=2, le=16)] = 4  # of the seat to a roller pitch; the ring bends in up to Z points/2 waves


class RingGeometry(NamedTuple):
    """Section of an outer ring."""

    radius: float  # of the neutral line [m]
    second_moment: float  # [m^4]
    area: float  # [m^2]
    seat_radius: float  # [m]
    width: float  # of ring and seat [m]
    inner_edge: float  # innermost radius of the section [m]

    @property
    def equivalent_thickness(self) -> float:
        """Thickness of a flat section as stiff in bending [m]."""
        return (12.0 * self.second_moment / self.width) ** (1.0 / 3.0)

    @property
    def farthest(self) -> float:
        """Distance from the neutral line to the farther edge of the section [m]."""
        return max(self.seat_radius - self.radius, self.radius - self.inner_edge)

    def bending_stress(self, moment):
        """Return the largest stress by a bending moment [N m], in Pa."""
        return abs(moment) * self.farthest / self.second_moment


def ring_geometry(bearing: Any) -> RingGeometry:
    """Return the section of the outer ring of a bearing: what its record gives, and wall and ribs for the rest."""
    given, raceway, flanges = bearing.outer_ring, bearing.outer_raceway, bearing.flanges
    seat = 0.5 * bearing.outside_diameter if given.seat_radius is None else given.seat_radius
    width = bearing.boundary_width if given.width is None else given.width
    parts = [(raceway.low_radius + 0.5 * raceway.d_value, seat, width)]  # rectangles: inside, outside, width
    size = flange_geometry(bearing)
    rib = max(width - bearing.roller.length - size.end_clearance, 0.0)  # both ribs together, or the only one
    if flanges.outer != "none":
        parts.append((size.outer_radius, parts[0][0], rib))
    areas = [(outside - inside) * wide for inside, outside, wide in parts]
    area = sum(areas)
    radius = sum(0.5 * (inside + outside) * each for (inside, outside, _), each in zip(parts, areas)) / area
    second = sum(
        each * ((outside - inside) ** 2 / 12.0 + (0.5 * (inside + outside) - radius) ** 2) for (inside, outside, _), each in zip(parts, areas)
    )
    return RingGeometry(
        radius if given.neutral_radius is None else given.neutral_radius,
        second if given.equivalent_thickness is None else width * given.equivalent_thickness**3 / 12.0,
        area if given.area is None else given.area,
        seat,
        width,
        min(inside for inside, _, _ in parts),
    )


@record
class BoreWave:
    """Waves of a bore that is out of round."""

    waves: Annotated[int, Field(ge=2, le=12)]  # around the circumference
    amplitude: Annotated[float, Quantity("m", "of the bore's radius over its mean: half of highest less lowest", 0.0, 1e-3, "um")]
    azimuth: Annotated[float, Quantity("rad", "where the bore is widest", -2 * math.pi, 2 * math.pi, "deg")] = 0.0


_PLAY = Annotated[
    float, Quantity("m", "radial play of the running ring, negative: an interference; None: by the fit of the housing", -1e-3, 1e-3, "um")
]


_RADIAL = Annotated[float, Quantity("N/m", "radial load by the way that it moves the bore as a whole; None: it stays where it is", 1e5, 1e13)]


@record
class RigidBacking:
    """The ring is rigid, whatever is around it."""

    law: Literal["rigid"] = "rigid"


@record
class FreeBacking:
    """Nothing is around the ring: a pressure like the cosine of the angle from the load holds it."""

    law: Literal["free"] = "free"


@record
class RigidBore:
    """The ring bends in a bore that does not yield."""

    law: Literal["rigid_bore"] = "rigid_bore"
    radial_stiffness: _RADIAL | None = None
    play: _PLAY | None = None
    bore_waves: tuple[BoreWave, ...] = ()


@record
class ElasticBacking:
    """The ring bends in an elastic housing of `mounting.housing.material`: a massive one, or one up to `mounting.housing.outside_radius`."""

    law: Literal["elastic"] = "elastic"
    massive: bool = False  # whether the housing is much larger than its bore
    radial_stiffness: _RADIAL | None = None
    play: _PLAY | None = None
    bore_waves: tuple[BoreWave, ...] = ()


@record
class BedBacking:
    """The ring bends on a local bed, each point of which yields by its own pressure alone; to check other programs and formulas."""

    law: Literal["bed"] = "bed"
    stiffness: Annotated[float, Quantity("", "pressure by deflection [N/m^3]; 1e13 is 1e4 N/mm^3", 0.0, 1e18)]
    play: _PLAY | None = None
    bore_waves: tuple[BoreWave, ...] = ()

    @check
    def _carries_something(self) -> list[str]:
        if self.stiffness > 0.0:
            return []
        return ["stiffness: 0 N/m^3 carries no load; expected a stiffness, such as 1e13, or backing: free"]


Backing = Annotated[RigidBacking | FreeBacking | RigidBore | ElasticBacking | BedBacking, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``rigid``, ``free``)."""


def backing_errors(scene: Any) -> list[str]:
    """Return error messages for a ring that bends although its section, its housing or its play are not known, or do not carry its load."""
    bearing, housing = scene.bearing, scene.mounting.housing
    backing = housing.backing
    if not scene.outer_ring_bends:
        return []
    section, raceway = ring_geometry(bearing), bearing.outer_raceway
    inside = raceway.low_radius + raceway.d_value
    if not inside < section.seat_radius:
        where = "outer_raceway.outside_radius" if bearing.outer_ring.seat_radius is None else "outer_ring.seat_radius"
        return [f"bearing.{where}: {1e3 * section.seat_radius:.6g} mm; expected more than the outer raceway's {1e3 * inside:.6g} mm"]
    errors = []
    if not section.inner_edge < section.radius < section.seat_radius:
        errors.append(
            f"bearing.outer_ring.neutral_radius: {1e3 * section.radius:.6g} mm; expected between {1e3 * section.inner_edge:.6g} mm and the seat's "
            f"{1e3 * section.seat_radius:.6g} mm"
        )
    if backing.law == "elastic":
        errors += _housing_errors(housing, section)
    if backing.law != "free":
        errors += _play_errors(bearing, housing)
    return errors + _stress_errors(scene, section)


def _housing_errors(housing, section: RingGeometry) -> list[str]:
    around, path = housing.outside_radius, "mounting.housing.outside_radius"
    if housing.backing.massive and around is not None:
        return [f"{path}: a massive housing has none that counts; leave it out (null), or set backing.massive: false"]
    if not housing.backing.massive and around is None:
        return [f"{path}: missing; how far a housing yields depends on it; give it, or set mounting.housing.backing.massive: true"]
    if around is not None and around <= section.seat_radius + _CLOSE:
        return [f"{path}: {1e3 * around:.6g} mm; expected more than the seat's {1e3 * section.seat_radius:.6g} mm"]
    return []


def _play_errors(bearing, housing) -> list[str]:
    fitted, path = housing.fit is not None or housing.interference is not None, "mounting.housing.backing.play"
    if housing.backing.play is None and not fitted:
        others = "" if bearing.dimensions_at == "running" else ", or mounting.housing.fit, from which it follows"
        return [f"{path}: missing; a ring that bends needs its play in the housing; give it (0 um is line to line){others}"]
    if housing.backing.play is not None and fitted:
        given = "fit" if housing.fit is not None else "interference"
        return [f"{path}: follows from mounting.housing.{given}; give one of the two, and leave the other out (null)"]
    return []


def _stress_errors(scene, section: RingGeometry) -> list[str]:
    """Return an error message for a ring that the scene's load breaks however it is shared among rollers.

    A free ring bends least where the load is spread like a cosine over half of it: by 0.0435 F R below the load, the sum of F_n R/(pi (n^2 - 1)) over
    even n.  One on a bed of stiffness k per length bends by Q/4 (4 E I/k)^(1/4) below a roller (M. Hetenyi, Beams on Elastic Foundation, 1946), but
    not by more than a free one.
    """
    bearing, backing, load = scene.bearing, scene.mounting.housing.backing, scene.operating.radial_load
    modulus, strength = bearing.material.youngs_modulus, bearing.material.strength
    moment = _SPREAD_MOMENT * load * section.radius
    if backing.law != "free":
        around = scene.mounting.housing.material if backing.law == "elastic" else bearing.material
        pressure = backing.stiffness if backing.law == "bed" else around.youngs_modulus / section.seat_radius  # by deflection [N/m^3]
        roller = _LARGEST_SHARE * load / bearing.roller.count
        moment = min(moment, 0.25 * roller * (4.0 * modulus * section.second_moment / (pressure * section.width)) ** 0.25)
    stress = section.bending_stress(moment)
    if stress <= strength:
        return []
    return [
        f"bearing.outer_ring: {load:.6g} N bend a ring {1e3 * section.equivalent_thickness:.3g} mm thick by {1e-6 * stress:.4g} MPa, more than the "
        f"strength of its material, {1e-6 * strength:.4g} MPa; expected a thicker ring, or backing: rigid"
    ]
