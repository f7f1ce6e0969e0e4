# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Drag of the oil-air mixture on the cage body, the same at every level."""

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.drag import cylinder_torque, end_face_torque


@kernel
def bore_torque(cage_speed, shaft_speed, params, lubrication):
    """Return the torque of the mixture in the cage's bore, which the inner ring drives [N m], and minus its slope by cage speed [N m s].

    Parameters as of `mixture_torque`.
    """
    radius = params.cage.inner_radius
    gap = radius - params.raceways.inner_radius
    return cylinder_torque(shaft_speed - cage_speed, radius, gap, params.cage.inner_width, lubrication.mixture_density, lubrication.viscosity)


@kernel
def mixture_torque(cage_speed, shaft_speed, params, lubrication):
    """Return the torque of the mixture on the cage [N m] and its slope by cage speed [N m s].

    On the outer cylindrical face and on the bore, which the inner ring drives, both as far as they run on no lands, and on both end faces
    (Deng 2017, section 3.1.4).

    Parameters
    ----------
    cage_speed, shaft_speed : [rad/s].
    params, lubrication : of the bearing, see `bearing_sim.params`.
    """
    cage, density, viscosity = params.cage, lubrication.mixture_density, lubrication.viscosity
    outer_gap = params.raceways.low_radius - cage.outer_radius
    outside, outside_slope = cylinder_torque(-cage_speed, cage.outer_radius, outer_gap, cage.outer_width, density, viscosity)
    inside, inside_slope = bore_torque(cage_speed, shaft_speed, params, lubrication)
    faces, faces_slope = end_face_torque(cage_speed, cage.outer_radius, cage.inner_radius, density, viscosity)
    return outside + inside - faces, -outside_slope - inside_slope - faces_slope
