# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The oil film of a squeeze film damper: a ring that cannot turn moves in the oil of a narrow cylindrical gap.

Symbols: e eccentricity of the ring in the gap [m], c radial clearance [m], eps = e/c, R radius of the film [m], L its length along the axis
[m], eta_0 viscosity of the oil [Pa s].
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel

_THINNEST = 0.95  # eccentricity ratio beyond which the film stiffens no more; assumption: it keeps the equations finite, validity ends far below


class SqueezeFilm(NamedTuple):
    """A squeeze film damper."""

    geometry: float  # pi R L^3/c^3, half of it where the film cavitates; 0 without a film [m]
    clearance: float  # c [m]


def new_squeeze_film(radius: float, length: float, clearance: float, cavitates: bool) -> SqueezeFilm:
    """Return a `SqueezeFilm` of radius R, length L and clearance c [m]."""
    return SqueezeFilm((0.5 if cavitates else 1.0) * math.pi * radius * length**3 / clearance**3, clearance)


@kernel
def squeeze_force(y, z, y_speed, z_speed, viscosity, film):
    """Return what the film takes against the motion of a ring, then its derivatives.

    Short bearing with open ends and without rotation: Reynolds' equation with a pressure that only depends on the flow along the axis,
    integrated around the full circumference (D. Childs, Turbomachinery Rotordynamics, 1993, section on squeeze film dampers; Comsol, Rotordynamics
    Module, theory of the squeeze film damper; ROSS, `SqueezeFilmDamper`), for a centre that moves outwards by e' and around by psi':

        outwards  pi eta_0 R L^3/c^3 (1 + 2 eps^2)/(1 - eps^2)^2.5 e',
        around    pi eta_0 R L^3/c^3 / (1 - eps^2)^1.5 e psi'.

    The full film holds as long as the supply pressure keeps the pressure positive everywhere.  A film that cavitates pushes on one half of its
    circumference only: half of that force, exact for small eccentricities; the radial stiffness of a cavitated film, of first order in
    eps, is left out.

    Range: L below R, eps up to about 0.4, laminar flow without inertia.  There is no static stiffness: a spring must carry the load.

    Parameters
    ----------
    y, z : of the ring's centre in the gap [m].
    y_speed, z_speed : [m/s].
    viscosity : eta_0 [Pa s].
    film : `SqueezeFilm`.

    Returns
    -------
    Force y, z [N], then four derivatives of the one along y by y, z, y' and z', then four of the one along z.
    """
    scale, clearance = viscosity * film.geometry, film.clearance
    square = (y * y + z * z) / (clearance * clearance)
    changing = 1.0 / (clearance * clearance)
    if square > _THINNEST * _THINNEST:
        square, changing = _THINNEST * _THINNEST, 0.0
    rest = 1.0 - square
    root = math.sqrt(rest)
    # f = a v + b (x.v) x with b such that along x it is (1 + 2 eps^2)/(1 - eps^2)^2.5 = 1/(1 - eps^2)^1.5 + 3 eps^2/(1 - eps^2)^2.5
    across = scale / (rest * root)
    d_across = 3.0 * scale / (rest * rest * root) * changing  # per half of d(e^2)
    more = 3.0 * scale / (clearance * clearance * rest * rest * root)
    d_more = 15.0 * scale / (clearance * clearance * rest * rest * rest * root) * changing
    along = y * y_speed + z * z_speed
    force_y, force_z = across * y_speed + more * along * y, across * z_speed + more * along * z
    turn_y, turn_z = d_across * y_speed + d_more * along * y, d_across * z_speed + d_more * along * z
    return (
        force_y, force_z,
        turn_y * y + more * (along + y * y_speed), turn_y * z + more * y * z_speed, across + more * y * y, more * y * z,
        turn_z * y + more * z * y_speed, turn_z * z + more * (along + z * z_speed), more * y * z, across + more * z * z,
    )  # fmt: skip
