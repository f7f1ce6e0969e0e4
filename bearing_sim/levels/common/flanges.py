# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What levels ``planar`` and ``spatial`` compute of roller ends on flanges in the same way; ``LANES`` rollers at a time (a block).

The inner ring's flanges act along the tangent p about the displaced ring, as tractions on its raceway do, with u = p.a' - omega_i r_m; the outer
ring's along the orbit, with u = r phi'.  The law is `bearing_sim.physics.flange`.
"""

from typing import NamedTuple

from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import add, highest, larger, load, spread, square_root, store, total, where_positive
from bearing_sim.physics.flange import axial_share, rub, shear, stop_skew


class FlangeRow(NamedTuple):
    """Rows of one ring's flanges, counted from where they begin among the rows of the rollers."""

    force: int = 0  # F on the roller along the tangent or the orbit [N]
    moment: int = 1  # M on its spin [N m]
    uu: int = 2  # -dF/du [N s/m]
    us: int = 3  # -dF/ds = -dM/du [N s]
    ss: int = 4  # -dM/ds [N m s]
    load: int = 5  # from here on at level ``spatial``: force at each of the two corners that stop the skew [N]
    skewing: int = 6  # moment on the skew [N m]
    skew_rate: int = 7  # q' [rad/s]
    force_by_load: int = 8  # derivatives of F and M by the force at the corners
    moment_by_load: int = 9
    load_by_skew: int = 10  # derivatives of that force by skew and its rate
    load_by_rate: int = 11
    damped: int = 12  # its part that the contacts' damping makes [N]
    lever: int = 13  # of both corners together about the skew's axis, with the sign of the skew [m]


@kernel
def total_load(row, load_row, rows, contacts):
    """Return the load of all rollers on the inner raceway [N]; ``load_row`` is the contacts' row of the normal force."""
    carried = spread(0.0)
    for block in range(rows.shape[0]):
        carried += load(rows, block, row.present) * load(contacts, block, load_row)
    return total(carried)


FLANGE = FlangeRow()
PLANE_ROWS, ROWS = FLANGE.load, len(FLANGE)


@kernel
def rub_on_face(block, first, face, viscosity, presses, pressed, u, s, rows):
    """Write force and torque of one ring's flanges on a block of rollers, and their derivatives.

    Parameters
    ----------
    first : row where the ring's `FLANGE` begins.
    face : `bearing_sim.physics.flange.Face`.
    viscosity : [Pa s].
    presses : whether anything presses ends on flanges.
    pressed : friction coefficient times axial force [N] (lanes).
    u, s : speeds of the end over the flange, see `bearing_sim.physics.flange` (lanes).
    """
    force, moment, uu, us, ss = shear(viscosity * face.area, viscosity * face.first, viscosity * face.second, u, s)
    store(rows, block, first + FLANGE.force, force)
    store(rows, block, first + FLANGE.moment, moment)
    store(rows, block, first + FLANGE.uu, uu)
    store(rows, block, first + FLANGE.us, us)
    store(rows, block, first + FLANGE.ss, ss)
    if presses and face.area > 0.0:
        rubbed, braked, rub_uu, rub_us, rub_ss, _, _ = rub(square_root, pressed, face.offset, 0.0, u, s)
        _add_rubbing(block, first, rubbed, braked, rub_uu, rub_us, rub_ss, rows)


@kernel
def _add_rubbing(block, first, force, moment, uu, us, ss, rows):
    """Add friction and its derivatives to what one ring's flanges do to a block of rollers."""
    add(rows, block, first + FLANGE.force, force)
    add(rows, block, first + FLANGE.moment, moment)
    add(rows, block, first + FLANGE.uu, uu)
    add(rows, block, first + FLANGE.us, us)
    add(rows, block, first + FLANGE.ss, ss)


@kernel
def rub_on_flanges(row, block, shaft_speed, pressed, flanges, viscosity, rows):
    """Write what the flanges of both rings do to a block of rollers that stay straight; the rollers have been placed.

    Parameters
    ----------
    row : of the rollers, with ``inner_flange`` and ``outer_flange``.
    shaft_speed : [rad/s].
    pressed : friction coefficient times axial force on each roller [N] (lanes).
    flanges : `bearing_sim.physics.flange.Flanges`.
    viscosity : of the oil [Pa s].
    """
    spin, presses = load(rows, block, row.spin), flanges.load + flanges.guiding > 0.0
    inner_u, inner_s = load(rows, block, row.speed_tangent) - shaft_speed * flanges.pitch_radius, spin + shaft_speed
    rub_on_face(block, row.inner_flange, flanges.inner, viscosity, presses, pressed, inner_u, inner_s, rows)
    outer_u = load(rows, block, row.radius) * load(rows, block, row.orbital_speed)
    rub_on_face(block, row.outer_flange, flanges.outer, viscosity, presses, pressed, outer_u, spin, rows)


@kernel
def stop_skew_on_face(block, first, face, flanges, friction, viscosity, skew, rate, u, s, rows):
    """Write what stops the skew of a block of rollers between one ring's flanges, and add the friction of their corners.

    Parameters
    ----------
    first, face, viscosity, u, s : as of `rub_on_face`, which has been called.
    flanges : `bearing_sim.physics.flange.Flanges`.
    friction : coefficient.
    skew, rate : q [rad] and q' [rad/s] of the roller against the flanges (lanes).
    """
    force, d_skew, d_rate, elastic = stop_skew(skew, rate, face, flanges)
    lever = where_positive(skew, 2.0 * face.corner, -2.0 * face.corner)
    rubbed, braked, uu, us, ss, by_u, by_s = rub(square_root, (2.0 * friction) * force, face.corner_offset, face.corner, u, s)
    _add_rubbing(block, first, rubbed, braked, uu, us, ss, rows)
    store(rows, block, first + FLANGE.load, force)
    store(rows, block, first + FLANGE.skewing, -(force * lever) - viscosity * face.squeeze * rate)
    store(rows, block, first + FLANGE.skew_rate, rate)
    store(rows, block, first + FLANGE.force_by_load, (-2.0 * friction) * by_u)
    store(rows, block, first + FLANGE.moment_by_load, (-2.0 * friction) * by_s)
    store(rows, block, first + FLANGE.load_by_skew, d_skew)
    store(rows, block, first + FLANGE.load_by_rate, d_rate)
    store(rows, block, first + FLANGE.damped, force - elastic)
    store(rows, block, first + FLANGE.lever, lever)


@kernel
def flange_powers(row, shaft_speed, flanges, rows):
    """Return what the shaft puts in through its flanges and what shear and friction lose on those of both rings [W]."""
    driven, lost = spread(0.0), spread(0.0)
    for block in range(rows.shape[0]):
        present, spin = load(rows, block, row.present), load(rows, block, row.spin)
        force, moment = load(rows, block, row.inner_flange + FLANGE.force), load(rows, block, row.inner_flange + FLANGE.moment)
        shaft = present * ((force * flanges.pitch_radius - moment) * shaft_speed)
        given = force * load(rows, block, row.speed_tangent) + moment * spin
        force, moment = load(rows, block, row.outer_flange + FLANGE.force), load(rows, block, row.outer_flange + FLANGE.moment)
        given += force * (load(rows, block, row.radius) * load(rows, block, row.orbital_speed)) + moment * spin
        driven += shaft
        lost += shaft - present * given
    return total(driven), total(lost)


@kernel
def observe_flanges(row, load_row, count, flanges, rows, contacts, sample):
    """Write the forces of the flanges into a flat sample, but for those of corners that stop the skew; parameters as of `total_load`."""
    inner, outer, largest = spread(0.0), spread(0.0), spread(0.0)
    carried = total_load(row, load_row, rows, contacts)
    for block in range(rows.shape[0]):
        present = load(rows, block, row.present)
        inner += present * load(rows, block, row.inner_flange + FLANGE.force)
        outer += present * load(rows, block, row.outer_flange + FLANGE.force)
        largest = larger(largest, present * axial_share(load(contacts, block, load_row), carried, count, flanges))
    sample[COLUMN.inner_flange_force] = total(inner) / count
    sample[COLUMN.outer_flange_force] = total(outer) / count
    sample[COLUMN.flange_load] = highest(largest)


@kernel
def largest_corner(row, rows):
    """Return the largest force of a corner that stops the skew of a roller [N]."""
    largest = spread(0.0)
    for block in range(rows.shape[0]):
        for ring in range(2):
            first = row.inner_flange if ring == 0 else row.outer_flange
            largest = larger(largest, load(rows, block, first + FLANGE.load))
    return highest(largest)
