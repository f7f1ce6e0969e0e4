# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the planar level keeps: the order of its state, and the memory that it writes while it computes.

State: y = (positions of the border, speeds of the border, r of all rollers, phi, r', phi', w); the border is inner ring y and
z, cage y, z and angle.  With a support its `bearing_sim.levels.common.support.TAIL` states follow behind the rollers'.

A roller sees 15 variables: its own five, the border's five positions and five speeds (`bearing_sim.numerics.block_arrow`).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.flanges import PLANE_ROWS
from bearing_sim.levels.common.observation import Tally
from bearing_sim.levels.common.rollers import StateRuns, new_rollers
from bearing_sim.levels.common.support import new_support
from bearing_sim.numerics.block_arrow import Factored, block_arrow, new_factored
from bearing_sim.numerics.simd import new_blocks, new_rows
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.lamina_life import MOMENTS
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import Bending, new_bending

RING, CAGE = 2, 3  # positions of ring and cage
LAYOUT = block_arrow(2, 3, (RING, CAGE))  # of rollers that touch them
BLOCK, BORDER, LOCAL = LAYOUT.block, LAYOUT.border, LAYOUT.local
AT_RING, AT_CAGE = BLOCK, BLOCK + 2 * RING  # where positions of ring and cage, and their speeds, stand among what a roller depends on
RING_COLUMNS, CAGE_COLUMNS = BLOCK + 2 * RING, BLOCK + 2 * CAGE
RING_ROWS = 3 * LOCAL  # where the rows of the ring and the cage begin
CAGE_ROWS = RING_ROWS + RING * RING_COLUMNS
RING_Y, RING_Z, CAGE_Y, CAGE_Z, THETA = 0, 1, 2, 3, 4
OMEGA = BORDER + THETA
ROLLERS = 2 * BORDER  # where the rollers' states begin: a run of Z for each of the five
R, PHI, R_SPEED, PHI_SPEED, SPIN = 0, 1, 2, 3, 4
RUNS = StateRuns(ROLLERS, R, PHI, R_SPEED, PHI_SPEED, SPIN)


class RollerRow(NamedTuple):
    """Indices of the rows of the rollers array, see `bearing_sim.numerics.simd.new_rows`."""

    radius: int = 0  # r [m]
    angle: int = 1  # phi [rad]
    radial_speed: int = 2  # r' [m/s]
    orbital_speed: int = 3  # phi' [rad/s]
    spin: int = 4  # w [rad/s]
    radial_acceleration: int = 5  # r'' [m/s^2]
    orbital_acceleration: int = 6  # phi'' [rad/s^2]
    spin_acceleration: int = 7  # w' [rad/s^2]
    present: int = 8  # 1 for a roller, 0 for a lane that holds none
    pitch_cosine: int = 9  # of 2 pi j/Z
    pitch_sine: int = 10
    cosine: int = 11  # of the roller's azimuth
    sine: int = 12
    normal_r: int = 13  # direction from the ring's centre to the roller's, in the roller's frame
    normal_t: int = 14
    inverse_distance: int = 15  # of both centres [1/m]
    speed_normal: int = 16  # of the roller's centre seen from the ring's [m/s]
    speed_tangent: int = 17
    slope: int = 18  # dR_e/dphi [m/rad]
    curvature: int = 19  # d2R_e/dphi2 [m/rad^2]
    churning: int = 20  # drag of the mixture against the orbit [N]
    pocket_cosine: int = 21  # of the pocket's azimuth
    pocket_sine: int = 22
    play_cosine: int = 23  # of the angle from the pocket to the roller
    play_sine: int = 24
    pocket_offset: int = 25  # of the roller from the middle of its pocket [m]
    pocket_rate: int = 26  # its time derivative [m/s]
    pocket_force: int = 27  # of the pocket on the roller along the orbit [N]
    pocket_stiffness: int = 28  # derivatives of the force against the offset, by it and by its rate [N/m, N s/m]
    pocket_damping: int = 29
    pocket_friction: int = 30  # coefficient, with the sign of the spin
    pocket_friction_d_spin: int = 31  # by spin [s/rad]
    contour: int = 32  # from here on, steps of a prediction: R_e at the roller's new azimuth [m]
    known_radius: int = 33  # known terms of its stage [m, m/s]
    known_speed: int = 34
    guide_offset: int = 35  # from here on pockets that guide: of the roller outwards from the pocket's middle [m]
    guide_rate: int = 36  # its time derivative [m/s]
    guide_force: int = 37  # of the pocket on the roller, outwards from the cage [N]
    guide_stiffness: int = 38  # derivatives of the force against the offset, by it and by its rate [N/m, N s/m]
    guide_damping: int = 39
    moved: int = 40  # by the last iteration of a prediction [m]
    inner_flange: int = 41  # from here on flanges: of the inner ring, rows `bearing_sim.levels.common.flanges.FLANGE` without skew
    outer_flange: int = 46  # of the outer ring, likewise


ROLLER = RollerRow()
ROLLER_ROWS = ROLLER.outer_flange + PLANE_ROWS


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    rollers: np.ndarray  # rows `ROLLER`
    contacts: np.ndarray  # rows `bearing_sim.physics.contact.CONTACT`, those with the inner raceway first
    jacobian: np.ndarray  # derivatives through each roller, see `bearing_sim.numerics.block_arrow`
    global_block: np.ndarray  # derivatives of the border's accelerations by border positions and speeds, shape (5, 10)
    factored: Factored  # of I - gamma h J
    support: np.ndarray  # memory of the support, see `bearing_sim.levels.common.support.new_support`
    evaluated_ring: np.ndarray  # position and velocity of the ring where forces were evaluated last [m, m/s], shape (4,)
    ring_stiffness: np.ndarray  # running means over a cage turn, see `bearing_sim.levels.common.rollers.average_stiffness`, shape (3,)
    # of roller loads, running means over a cage turn, see `bearing_sim.physics.lamina_life.add_load_moments`, shape (2, MOMENTS)
    load_moments: np.ndarray
    last_moments: np.ndarray  # those powers at the end of the last step, shape (2, MOMENTS)
    tally: np.ndarray  # sums over time, see `bearing_sim.levels.common.observation.Tally`
    bending: Bending | None  # of the outer ring; None: it is rigid
    ring_loads: np.ndarray  # of its balance, rows `bearing_sim.physics.load_balance.LOAD`
    ring_rates: np.ndarray  # rates of the penetrations of a rigid ring [m/s], shape (Z,)
    bent_at: np.ndarray  # cage angle at which it was found last [rad], shape (1,)


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    rollers = new_rollers(ROLLER, ROLLER_ROWS, count)
    return Work(
        rollers,
        new_blocks(2 * rollers.shape[0], len(CONTACT)),
        new_rows(LAYOUT.rows, count),
        np.zeros((BORDER, 2 * BORDER)),
        new_factored(LAYOUT, count),
        new_support(params.support, 2 * BORDER + BLOCK * count),
        np.zeros(4),
        np.zeros(3),
        np.zeros((2, MOMENTS)),
        np.zeros((2, MOMENTS)),
        np.zeros(len(Tally._fields)),
        None if params.outer_ring is None else new_bending(params.outer_ring, rollers_move=True),
        np.zeros((len(LOAD), count)),
        np.zeros(count),
        np.zeros(1),
    )
