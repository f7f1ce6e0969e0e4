# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What carries a bearing: the shaft in the inner ring, the springs and dampers behind the outer ring, and the shaft's unbalance."""

import math
from dataclasses import field, replace
from typing import Annotated, Any

from bearing_sim.scene.quantity import Quantity, check, record
from bearing_sim.scene.ratings import rate

# What stands for a part of which a scene gives no number (assumption; plausible ranges in doc/theory/support.md).
_DEFLECTION_AT_STATIC_RATING = 1e-3  # m, of the shaft and of the outer ring's spring, each
_SHAFT_DAMPING_RATIO = 0.05  # of the shaft's mass on its spring
_OUTER_DAMPING_RATIO = 0.5  # of all moving masses on the outer ring's spring: a squeeze film damper
_OUTER_MASS = 2.0  # times the inner ring's: the outer ring and the sleeve around it
_LARGEST_ECCENTRICITY = 0.9  # of a squeeze film under the static load


@record
class ShaftSupport:
    """The shaft.  Without a stiffness its mass moves with the inner ring; with one it is a body behind that spring, on which the load acts."""

    mass: Annotated[float, Quantity("kg", "mass of the shaft that the bearing carries", 0.0, 1e5)] = 0.5
    stiffness: (
        Annotated[float, Quantity("N/m", "stiffness between inner ring and shaft mass, along y; None: rigid, or by `support.elastic`", 1e3, 1e13)]
        | None
    ) = None
    stiffness_z: Annotated[float, Quantity("N/m", "the same along z; None: as along y", 1e3, 1e13)] | None = None
    damping: Annotated[float, Quantity("N*s/m", "damping beside it, along y; None: a damping ratio of 0.05 of the shaft's mass", 0.0, 1e9)] | None = (
        None
    )
    damping_z: Annotated[float, Quantity("N*s/m", "the same along z; None: as along y", 0.0, 1e9)] | None = None

    @check
    def _spring_is_complete(self) -> list[str]:
        beside = [name for name in ("stiffness_z", "damping", "damping_z") if getattr(self, name) is not None]
        if self.stiffness is None and beside:
            return [f"{', '.join(beside)}: of a shaft without stiffness; give stiffness, too, or leave {'them' if len(beside) > 1 else 'it'} out"]
        if self.stiffness is not None and self.mass == 0.0:
            return ["mass: 0 kg behind a stiffness; expected the mass of the shaft, or no stiffness"]
        return []


@record
class SqueezeFilmDamper:
    """Oil film between the outer ring and its housing (see `bearing_sim.physics.squeeze_film`); with the viscosity of the lubricant."""

    radius: Annotated[float, Quantity("m", "radius of the film, R", 1e-3, 2.0, "mm")]
    length: Annotated[float, Quantity("m", "length of the film along the axis, L", 1e-4, 1.0, "mm")]
    clearance: Annotated[float, Quantity("m", "radial clearance of the ring in it, c", 1e-6, 5e-3, "um")]
    cavitates: bool = False  # whether the film pushes on half of its circumference only, as without supply pressure


@record
class OuterRingSupport:
    """Spring and damper that carry the outer ring in the housing.  The spring transmits the static load in full."""

    mass: Annotated[float, Quantity("kg", "mass of outer ring and sleeve; None: twice the inner ring's", 1e-4, 1e5)] | None = None
    stiffness: (
        Annotated[float, Quantity("N/m", "stiffness towards the housing along y; None: the static load rating deflects it by 1 mm", 1e3, 1e13)] | None
    ) = None
    stiffness_z: Annotated[float, Quantity("N/m", "the same along z; None: as along y", 1e3, 1e13)] | None = None
    damping: (
        Annotated[float, Quantity("N*s/m", "damping beside it, along y; None: a damping ratio of 0.5 of all moving masses, 0 with a film", 0.0, 1e9)]
        | None
    ) = None
    damping_z: Annotated[float, Quantity("N*s/m", "the same along z; None: as along y", 0.0, 1e9)] | None = None
    squeeze_film: SqueezeFilmDamper | None = None  # a film that damps; None: no film


@record
class Unbalance:
    """Unbalance of the shaft: a force m e omega^2 that turns with it."""

    amount: Annotated[float, Quantity("kg*m", "mass times eccentricity, m e", 0.0, 1e3, "g*mm")] = 0.0
    angle: Annotated[float, Quantity("rad", "azimuth of the eccentricity when the shaft's angle is 0", -2 * math.pi, 2 * math.pi, "deg")] = 0.0


@record
class Support:
    """What carries the bearing, for levels `planar` and `spatial`.

    By default the outer ring is rigid in space and the shaft's mass rigid on the inner ring.  ``elastic`` lets both move, with what is
    given and plausible values for the rest.  Levels `steady` and `slip` balance the inner ring's forces at every instant; a support
    transmits them in full and changes nothing there.
    """

    elastic: bool = False  # whether shaft and outer ring yield although neither is described
    shaft: ShaftSupport = field(default_factory=ShaftSupport)
    outer_ring: OuterRingSupport | None = None  # None: rigid in space, or by `elastic`
    unbalance: Unbalance = field(default_factory=Unbalance)

    @check
    def _elastic_shaft_has_mass(self) -> list[str]:
        if self.elastic and self.shaft.mass == 0.0:
            return ["shaft.mass: 0 kg on an elastic shaft; expected its mass, or outer_ring instead of elastic"]
        return []

    @property
    def shaft_bends(self) -> bool:
        """Whether the shaft's mass is a body of its own."""
        return self.elastic or self.shaft.stiffness is not None

    @property
    def outer_ring_moves(self) -> bool:
        """Whether the outer ring is carried by springs."""
        return self.elastic or self.outer_ring is not None

    @property
    def is_active(self) -> bool:
        """Whether there is more than a rigid shaft in a rigid housing."""
        return self.shaft_bends or self.outer_ring_moves or self.unbalance.amount > 0.0


def settled_support(support: Support, bearing: Any) -> Support:
    """Return a support with a number for everything that moves; what is rigid stays None."""
    stiffness = rate(bearing).static / _DEFLECTION_AT_STATIC_RATING
    shaft, outer, inner_mass = support.shaft, support.outer_ring, bearing.inner_raceway.ring_mass
    if support.shaft_bends:
        shaft = _settled(shaft, shaft.stiffness or stiffness, lambda spring: 2.0 * _SHAFT_DAMPING_RATIO * math.sqrt(spring * shaft.mass))
    if support.outer_ring_moves:
        outer = outer if outer is not None else OuterRingSupport()
        outer = replace(outer, mass=_OUTER_MASS * inner_mass if outer.mass is None else outer.mass)
        ratio = _OUTER_DAMPING_RATIO if outer.squeeze_film is None else 0.0
        moving = outer.mass + inner_mass + shaft.mass
        outer = _settled(outer, outer.stiffness or stiffness, lambda spring: 2.0 * ratio * math.sqrt(spring * moving))
    return replace(support, shaft=shaft, outer_ring=outer)


def _settled(body, stiffness, damping_of):
    damping = damping_of(stiffness) if body.damping is None else body.damping
    return replace(
        body,
        stiffness=stiffness,
        stiffness_z=stiffness if body.stiffness_z is None else body.stiffness_z,
        damping=damping,
        damping_z=damping if body.damping_z is None else body.damping_z,
    )


def support_errors(scene: Any) -> list[str]:
    """Return error messages for a squeeze film whose spring lets the static load press it out."""
    outer = settled_support(scene.support, scene.bearing).outer_ring
    if outer is None or outer.squeeze_film is None:
        return []
    film, operating = outer.squeeze_film, scene.operating
    y, z = operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle)
    deflection = math.hypot(y / outer.stiffness, z / outer.stiffness_z)
    if deflection <= _LARGEST_ECCENTRICITY * film.clearance:
        return []
    return [
        f"support.outer_ring.stiffness: {operating.radial_load:.6g} N deflect a spring of {outer.stiffness:.6g} N/m by {1e6 * deflection:.6g} um, "
        f"more than {_LARGEST_ECCENTRICITY:g} of the squeeze film's clearance of {1e6 * film.clearance:.6g} um, and a film carries no static "
        "load; expected a stiffer spring or a larger clearance"
    ]
