# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The outer ring that bends, at levels whose rollers move, and what every level observes of it.

Masses of ring and housing are left out: the ring follows the rollers at once (`bearing_sim.physics.ring_balance.deflect_elastic_ring`), under the
elastic part of their loads.  So a roller is pressed by R_e + w + x.e, which leans as that does; the position of the ring in its housing, x, is
among what follows.  What damps a contact acts on its rate of penetration, to which the moving ring adds.  The damping part of a load does not
bend the ring: what it does to a ring that moves is lost in ring and housing, whose damping it stands for.

Rollers press the ring as if they stood in the middles of their pockets; a roller that does not meets the slope that the ring has there.  The guide
lands of the outer ring stay where they are.
"""

import math

from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import POINT, ROLLER

_TURNS = 1.0  # rad/s; a slower cage does not tell how long ago something was


@kernel
def _ahead(j, count, turned):
    """Return the angle from the middle of its pocket to a roller [rad]; ``turned`` is that from the pocket of roller 0."""
    ahead = turned - 2.0 * math.pi * j / count
    return ahead - 2.0 * math.pi * math.floor(ahead / (2.0 * math.pi) + 0.5)


@kernel
def place_at_ring(row, contact, cage_angle, cage_speed, highest, rows, contacts, ring_loads, rates, bending):
    """Write how far rollers are squeezed by a rigid outer ring, as if they stood in the middles of their pockets, and how fast that grows.

    Parameters
    ----------
    row, contact : rows of ``rows`` and ``contacts``, see `bearing_sim.levels.common.rollers`.
    cage_angle, cage_speed : [rad, rad/s].
    highest : least drop of the profile along a roller, from which a penetration counts [m].
    ring_loads, rates, bending : memory, see `bearing_sim.physics.ring_balance.deflect_elastic_ring`; takes squeezes and ``rates``, shape (Z,).
    """
    blocks = rows.shape[0]
    for j in range(ring_loads.shape[1]):
        block, lane = blocks + j // LANES, j % LANES
        ahead, slope = _ahead(j, ring_loads.shape[1], rows[j // LANES, row.angle, lane] - cage_angle), bending.rollers[ROLLER.slope, j]
        ring_loads[LOAD.squeeze, j] = contacts[block, contact.penetration, lane] - highest - slope * ahead
        rates[j] = contacts[block, contact.rate, lane] - slope * (rows[j // LANES, row.orbital_speed, lane] - cage_speed)


@kernel
def give_way(row, contact, highest, rows, contacts, ring_loads, rates, bending):
    """Let penetrations, their rates and slopes be those of the ring that has bent; parameters as of `place_at_ring`."""
    blocks = rows.shape[0]
    for j in range(ring_loads.shape[1]):
        block, lane = j // LANES, j % LANES
        contacts[blocks + block, contact.penetration, lane] = ring_loads[LOAD.approach, j] + highest
        contacts[blocks + block, contact.rate, lane] = rates[j] - bending.rollers[ROLLER.rate, j]
        rows[block, row.slope, lane] += bending.rollers[ROLLER.slope, j]


@kernel
def soften_contacts(contact, blocks, contacts, bending):
    """Let the derivatives of the outer contacts be those of a ring that gives way; ``bending`` is None of a rigid ring.

    What a roller does to its neighbours through the ring is left to the iteration.
    """
    if bending is None:
        return
    for j in range(bending.rollers.shape[1]):
        block, lane = blocks + j // LANES, j % LANES
        contacts[block, contact.stiffness, lane] *= bending.rollers[ROLLER.share, j]
        contacts[block, contact.damping, lane] *= bending.rollers[ROLLER.share, j]


@kernel
def predict_bending(row, cage_angle, cage_speed, bent_at, rows, bending):
    """Add to the contour at the rollers how far the ring will have bent.

    Parameters
    ----------
    row : see `place_at_ring`.
    cage_angle, cage_speed : then [rad, rad/s].
    bent_at : cage angle at which the bending was known last [rad].
    rows, bending : as of `place_at_ring`; None of a rigid ring.
    """
    if bending is None:
        return
    count, time = bending.rollers.shape[1], (cage_angle - bent_at) / cage_speed if abs(cage_speed) > _TURNS else 0.0
    for j in range(count):
        ahead = _ahead(j, count, rows[j // LANES, row.angle, j % LANES] - cage_angle)
        bent = bending.rollers[ROLLER.moved, j] + time * bending.rollers[ROLLER.rate, j] + ahead * bending.rollers[ROLLER.slope, j]
        rows[j // LANES, row.contour, j % LANES] += bent


@kernel
def ring_rate(bending, j, cage_speed):
    """Return how fast the outer ring moves outwards where a roller is [m/s], at speed of the cage [rad/s]; 0 of a rigid ring, ``bending`` None."""
    if bending is None:
        return 0.0
    return bending.rollers[ROLLER.rate, j] - bending.rollers[ROLLER.slope, j] * cage_speed


@kernel
def observe_bending(bending, count, row):
    """Write how the outer ring bends and sits in its seat into a flat sample that has the loads and the clearance of a rigid ring.

    Parameters
    ----------
    bending : of the level; None of a rigid ring.
    count : of rollers.
    row : see `bearing_sim.model.sample.flat`.
    """
    if bending is None:
        return
    points, touching, carried, bent = bending.points.shape[1] - 2, 0, 0.0, 0.0
    for i in range(points):
        touching += 1 if bending.points[POINT.force, i] > 0.0 else 0
    row[COLUMN.seat_arc] = 2.0 * math.pi * touching / points if points > 0 else math.nan
    row[COLUMN.outer_ring_y], row[COLUMN.outer_ring_z] = bending.points[POINT.force, points], bending.points[POINT.force, points + 1]
    for j in range(count):
        deflection, load = bending.rollers[ROLLER.deflection, j], row[SCALARS + j + COLUMN.inner_load * count]
        row[SCALARS + j + COLUMN.raceway_deflection * count] = deflection
        carried += load
        bent += 2.0 * load * deflection
    if carried > 0.0:
        row[COLUMN.bending_clearance] = bent / carried
        row[COLUMN.running_clearance] += row[COLUMN.bending_clearance]


@kernel
def observe_ring(bending, count, row):
    """Write `observe_bending` into a sample whose places are from the housing's centre, with the support's motion; let them be from the ring's."""
    if bending is None:
        return
    support_y, support_z = row[COLUMN.outer_ring_y], row[COLUMN.outer_ring_z]
    observe_bending(bending, count, row)
    y, z = row[COLUMN.outer_ring_y], row[COLUMN.outer_ring_z]
    row[COLUMN.outer_ring_y] += support_y
    row[COLUMN.outer_ring_z] += support_z
    row[COLUMN.ring_y] -= y
    row[COLUMN.ring_z] -= z
    for j in range(count):
        angle = row[SCALARS + j + COLUMN.roller_angle * count]
        row[SCALARS + j + COLUMN.roller_radius * count] -= y * math.cos(angle) + z * math.sin(angle)
