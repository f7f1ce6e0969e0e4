# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The flanges (ribs) of the rings: which ring has them, their geometry, and what roller ends rub on.

The types of cylindrical roller bearings by ISO 15 and the makers' catalogues: NU has two flanges on the outer ring and none on the inner
one, N the other way round; NJ has one on the inner ring besides, NUP two; NF is an N with one flange on the outer ring.  Where a ring has
one flange, it stands where it takes the axial load of that type: on the inner ring at the end of negative x, on the outer ring at that of
positive x, so that a positive `operating.axial_load` (along +x, on the inner ring) presses the rollers between both.

What a scene leaves out is estimated: flanges as high as ``HEIGHT`` times the roller's diameter, an end clearance of ``CLEARANCE``, a
corner radius of ``CORNER`` times the roller's diameter (*assumptions*; `uncertainty` takes their ranges where a scene names them).
"""

import math
from typing import Annotated, Literal, NamedTuple

from bearing_sim.scene.quantity import Quantity, record

HEIGHT = 0.18  # of the roller diameter; assumption, 0.15 to 0.25 in makers' drawings (d_1, D_1 against F, E)
CLEARANCE = (15e-6, 0.003)  # m, and of the roller's length; assumption, half to twice as much
CORNER = 0.05  # of the roller diameter; assumption, 0.03 to 0.08
_CLOSE = 1e-9  # m

Sides = Literal["none", "one", "both"]


@record
class Flanges:
    """Flanges of both rings, the ends of the rollers, and the friction between them.

    Without flanges (``none`` on both rings) nothing touches the rollers' ends.  Skew and misalignment press rollers on their flanges even without
    an axial load; ``guiding_load`` is that force for levels that do not compute it.  *Assumption*: 0.  The part 0.0015 d_m F_r of SKF's sliding
    moment would need about 0.03 if all of it arose there.
    """

    inner: Sides = "none"  # flanges of the inner ring
    outer: Sides = "none"  # flanges of the outer ring
    inner_radius: (
        Annotated[float, Quantity("m", "radius up to which the inner ring's flanges reach, d_1/2; None: estimated", 1e-3, 2.0, "mm")] | None
    ) = None
    outer_radius: (
        Annotated[float, Quantity("m", "radius down to which the outer ring's flanges reach, D_1/2; None: estimated", 1e-3, 2.0, "mm")] | None
    ) = None
    end_clearance: Annotated[float, Quantity("m", "total axial play of a roller between two flanges; None: estimated", 1e-6, 2e-3, "um")] | None = (
        None
    )
    opening_angle: Annotated[float, Quantity("rad", "layback of a flange, by which its face opens away from the raceway", 1e-4, 0.1, "deg")] = (
        math.radians(0.5)
    )
    corner_radius: Annotated[float, Quantity("m", "radius between a roller's end face and its surface; None: estimated", 1e-6, 0.1, "mm")] | None = (
        None
    )
    end_radius: Annotated[float, Quantity("m", "radius of a roller end ground as a sphere; None: a flat end", 1e-3, 100.0, "mm")] | None = None
    film_friction: Annotated[float, Quantity("", "friction coefficient of roller end and flange on a full film; SKF: 0.02", 0.0, 1.0)] = 0.02
    guiding_load: Annotated[
        float, Quantity("", "axial force of a roller's end on its flange without an axial load, over its load on the inner raceway", 0.0, 0.1)
    ] = 0.0
    film: Annotated[float, Quantity("m", "oil film where an axial load presses a roller's end on a flange", 1e-8, 1e-4, "um")] = 1e-6

    @property
    def present(self) -> bool:
        """Whether any ring has a flange."""
        return self.inner != "none" or self.outer != "none"

    @property
    def carry_axial_load(self) -> bool:
        """Whether flanges of both rings hold the rollers between them, so that they carry an axial load."""
        return self.inner != "none" and self.outer != "none"


class FlangeGeometry(NamedTuple):
    """Dimensions of flanges and roller ends [m], given or estimated."""

    inner_radius: float  # up to which the inner ring's flanges reach
    outer_radius: float  # down to which the outer ring's reach
    end_clearance: float  # total play
    corner_radius: float


def estimated_clearance(roller_length: float) -> float:
    """Return the end clearance of a roller [m] where none is known, by ``CLEARANCE``."""
    return CLEARANCE[0] + CLEARANCE[1] * roller_length


def flange_geometry(bearing) -> FlangeGeometry:
    """Return the dimensions of a bearing's flanges and roller ends, with estimates for what the scene leaves out."""
    flanges, roller = bearing.flanges, bearing.roller
    inner, outer = flanges.inner_radius, flanges.outer_radius
    return FlangeGeometry(
        bearing.inner_raceway.radius + HEIGHT * roller.diameter if inner is None else inner,
        bearing.outer_raceway.low_radius - HEIGHT * roller.diameter if outer is None else outer,
        estimated_clearance(roller.length) if flanges.end_clearance is None else flanges.end_clearance,
        CORNER * roller.diameter if flanges.corner_radius is None else flanges.corner_radius,
    )


def flange_errors(bearing) -> list[str]:
    """Return error messages for flanges that do not fit rings and rollers."""
    flanges, errors = bearing.flanges, []
    if not flanges.present:
        of_flanges = "inner_radius", "outer_radius", "end_clearance", "corner_radius", "end_radius"
        given = [name for name in of_flanges if getattr(flanges, name) is not None]
        return [f"flanges.{name}: neither ring has flanges; say which has them (inner, outer: one or both), or leave it out (null)" for name in given]
    size, roller = flange_geometry(bearing), bearing.roller
    if size.corner_radius >= 0.5 * roller.diameter:
        errors.append(
            f"flanges.corner_radius: {1e3 * size.corner_radius:.6g} mm leaves no end face on a roller of {1e3 * roller.diameter:.6g} mm; expected "
            f"less than {0.5e3 * roller.diameter:.6g} mm"
        )
    sides = (
        ("inner", size.inner_radius - bearing.inner_raceway.radius, "above the inner raceway", bearing.inner_raceway.radius, 1),
        ("outer", bearing.outer_raceway.low_radius - size.outer_radius, "below the outer raceway", bearing.outer_raceway.low_radius, -1),
    )
    for ring, height, where, raceway, sign in sides:
        radius, present = getattr(size, f"{ring}_radius"), getattr(flanges, ring) != "none"
        if getattr(flanges, f"{ring}_radius") is not None and not present:
            errors.append(f"flanges.{ring}_radius: the {ring} ring has no flanges; set {ring}: one or both, or leave it out (null)")
        elif present and not size.corner_radius < height < 0.5 * roller.diameter - _CLOSE:
            low, high = sorted((1e3 * (raceway + sign * size.corner_radius), 1e3 * (raceway + sign * 0.5 * roller.diameter)))
            errors.append(
                f"flanges.{ring}_radius: {1e3 * radius:.6g} mm puts the flange's edge {1e3 * height:.6g} mm {where}; expected between "
                f"{low:.6g} and {high:.6g} mm, beyond the rollers' corners and short of their axes"
            )
        elif present and flanges.end_radius is not None:
            slope = math.sin(flanges.opening_angle)
            low, high, touching = 0.5 * roller.diameter - height, 0.5 * roller.diameter - size.corner_radius, flanges.end_radius * slope
            if not low < touching < high:
                errors.append(
                    f"flanges.end_radius: {1e3 * flanges.end_radius:.6g} mm touches a flange with this opening_angle {1e3 * touching:.6g} mm off "
                    f"the roller's axis, where the {ring} flange and the roller's end do not meet; expected {1e3 * low / slope:.6g} to "
                    f"{1e3 * high / slope:.6g} mm"
                )
    return errors


def axial_errors(scene) -> list[str]:
    """Return error messages for an axial load that the bearing's flanges cannot carry."""
    load, flanges = scene.operating.axial_load, scene.bearing.flanges
    if load == 0.0:
        return []
    if not flanges.carry_axial_load:
        missing = [f"the {ring} ring" for ring in ("inner", "outer") if getattr(flanges, ring) == "none"]
        return [
            f"operating.axial_load: {load:.6g} N cannot be carried, because {' and '.join(missing)} has no flanges (bearing.flanges.inner: "
            f"{flanges.inner}, outer: {flanges.outer}), as types N and NU; use a type with flanges on both rings (NJ, NUP, NF), or leave it out"
        ]
    if load < 0.0 and "one" in (flanges.inner, flanges.outer):
        ring = "inner" if flanges.inner == "one" else "outer"
        return [
            f"operating.axial_load: {load:.6g} N pulls the rings apart, because the {ring} ring has one flange, on the side that carries a positive "
            f"load; give {-load:.6g} N, or flanges on both sides of both rings (NUP)"
        ]
    return []
