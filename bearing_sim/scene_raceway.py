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
    bore_radius: quantity("m", "bore radius of the inner ring", 1e-3, 2.0, "mm") | None = None
