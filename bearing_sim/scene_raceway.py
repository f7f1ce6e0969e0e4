# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The raceways of a scene: contour of the outer one, the inner one, and what makes rings grow."""

import math
from typing import Annotated

from pydantic import Field, model_validator

from bearing_sim.contour import form_faults, settled_form
from bearing_sim.quantity import quantity
from bearing_sim.scene_record import record

FORM_FIELDS = ("low_radius", "d_value", "lobes", "roundness", "low_points", "high_points", "contour", "contour_file")
UNIT_FIELDS = ("contour_angle_unit", "contour_radius_unit")


@record
class ContourPoint:
    """A low or high point of the outer raceway."""

    azimuth: quantity("rad", "azimuth of the point before installation", -2 * math.pi, 2 * math.pi, "deg")
    radius: quantity("m", "radius there", 1e-3, 2.0, "mm")


@record
class OuterRaceway:
    """Outer raceway contour R_e(phi), in one of the forms below; all are turned by the installation angle.

    By ``low_radius``, ``d_value`` and ``lobes``: R_low + D/2 - D/2 cos(n phi) (Deng 2017, eq. 2); D = 0 is a round bearing.
    With ``roundness`` e the lows spread from R_low - e/2 to R_low + e/2 and each high falls as the low before it rises.
    By ``low_points`` and ``high_points``, each with its own azimuth and radius, half a cosine wave from one to the next.
    By ``contour_file``, points measured over one turn (see `bearing_sim.contour_file`), whose text is kept in ``contour``.
    In the last two ``low_radius``, ``d_value`` and ``lobes`` follow from the points.
    """

    low_radius: quantity("m", "radius at the low points, R_low", 1e-3, 2.0, "mm") | None = None
    d_value: quantity("m", "high-point radius less low-point radius, D", 0.0, 5e-3, "mm") | None = None
    lobes: Annotated[int, Field(ge=1, le=12)] | None = None
    roundness: quantity("m", "highest less lowest of the low points, e", 0.0, 1e-3, "um") = 0.0
    low_points: tuple[ContourPoint, ...] = ()
    high_points: tuple[ContourPoint, ...] = ()
    contour_file: str | None = None
    contour: str | None = None
    contour_angle_unit: str | None = None
    contour_radius_unit: str | None = None
    installation_angle: quantity("rad", "azimuth of a low point, phi_e", -2 * math.pi, 2 * math.pi, "deg") = 0.0
    contour_slope: bool = True
    outside_radius: quantity("m", "outside radius of the outer ring", 1e-3, 2.0, "mm") | None = None

    @model_validator(mode="after")
    def _form_is_complete(self):
        faults, settled = form_faults(self), {}
        if not faults:
            settled, faults = settled_form(self)
        if faults:
            raise ValueError("; ".join(faults))
        for name, value in settled.items():
            object.__setattr__(self, name, value)
        return self


@record
class InnerRaceway:
    """Round inner raceway, turning with the shaft."""

    radius: quantity("m", "inner raceway radius, R_i", 1e-3, 2.0, "mm")
    ring_mass: quantity("kg", "mass of the inner ring", 1e-4, 1e3) = 0.05
    supported_mass: quantity("kg", "mass of the shaft that moves with the inner ring", 0.0, 1e5) = 0.5
    polar_inertia: quantity("kg*m^2", "inertia of ring and shaft about the shaft axis; None: a solid cylinder", 1e-12, 1e6) | None = None
    transverse_inertia: quantity("kg*m^2", "their inertia about a diameter; None: half of the polar one", 1e-12, 1e6) | None = None
    bore_radius: quantity("m", "bore radius of the inner ring", 1e-3, 2.0, "mm") | None = None


@record
class RingGrowth:
    """What changes the play of a bearing besides its drawing: rotation, fits, heat.  All off by default."""

    centrifugal: bool = False
    shaft_interference: quantity("m", "diametral interference of shaft and inner ring", 0.0, 1e-3, "um") = 0.0
    shaft_bore_radius: quantity("m", "bore radius of the shaft; 0 is a solid one", 0.0, 2.0, "mm") = 0.0
    housing_interference: quantity("m", "diametral interference of housing and outer ring", 0.0, 1e-3, "um") = 0.0
    housing_radius: quantity("m", "outside radius of the housing", 1e-3, 10.0, "mm") | None = None
    thermal: bool = False
    expansion: quantity("1/K", "linear thermal expansion of rings and rollers", 0.0, 1e-3) = 1.2e-5
    reference_temperature: quantity("K", "temperature at which the drawing holds", 150.0, 800.0, "degC") = 293.15
    inner_excess: quantity("K", "inner ring's temperature less the oil's", -200.0, 200.0) = 0.0
    roller_excess: quantity("K", "rollers' temperature less the oil's", -200.0, 200.0) = 0.0
    outer_excess: quantity("K", "outer ring's temperature less the oil's", -200.0, 200.0) = 0.0


def growth_faults(bearing) -> list[str]:
    """Return what the options of ring growth lack or contradict in a bearing, in words."""
    growth, inner, outer, faults = bearing.ring_growth, bearing.inner_raceway, bearing.outer_raceway, []
    if growth.centrifugal or growth.shaft_interference:
        if inner.bore_radius is None:
            faults.append("inner_raceway.bore_radius: missing; ring_growth needs it")
        elif not growth.shaft_bore_radius < inner.bore_radius < inner.radius:
            faults.append("inner_raceway.bore_radius: expected between the shaft's bore and the raceway")
    if growth.housing_interference:
        faults += [
            f"{name}: missing; ring_growth.housing_interference needs it"
            for name, value in (("outer_raceway.outside_radius", outer.outside_radius), ("ring_growth.housing_radius", growth.housing_radius))
            if value is None
        ]
        if not faults and not outer.low_radius + outer.d_value < outer.outside_radius < growth.housing_radius:
            faults.append("outer_raceway.outside_radius: expected between the raceway and the housing's outside")
    return faults
