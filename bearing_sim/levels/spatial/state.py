# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the spatial level keeps: the order of its state, and the memory that it writes while it computes.

State: y = (positions of the border, speeds of the border, r of all rollers, phi, tilt, skew, r', phi', tilt', skew', w); the
border is inner ring y and z, its tilts, cage y and z, its tilts, and cage angle.  With a support its
`bearing_sim.levels.common.support.TAIL` states follow behind the rollers'.

Every tilt is the inclination of an axis, so that the middle of a slice at x stands off the body's centre by x times it: tilt and
skew of a roller incline its axis outwards and along the orbit, those of ring and cage incline theirs towards y and z.
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.flanges import ROWS as FLANGE_ROWS
from bearing_sim.levels.common.observation import Tally
from bearing_sim.levels.common.rollers import StateRuns, new_rollers
from bearing_sim.levels.common.support import new_support
from bearing_sim.numerics.block_arrow import Factored, block_arrow, new_factored
from bearing_sim.numerics.simd import new_blocks, new_rows
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.lamina_life import MOMENTS
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import Bending, new_bending

RING, CAGE = 4, 5  # positions of ring and cage
LAYOUT = block_arrow(4, 5, (RING, CAGE))  # of rollers that touch ring and cage: four positions, their speeds, and the spin
BLOCK, BORDER, LOCAL = LAYOUT.block, LAYOUT.border, LAYOUT.local
AT_CAGE = BLOCK + 2 * RING  # where the cage's positions and speeds stand among what a roller depends on
AT_CAGE_SPEEDS = AT_CAGE + CAGE
RING_COLUMNS, CAGE_COLUMNS = BLOCK + 2 * RING, BLOCK + 2 * CAGE
RING_ROWS = 5 * LOCAL  # where the rows of the ring and the cage begin
CAGE_ROWS = RING_ROWS + RING * RING_COLUMNS
# rows of points behind those of a contact: derivatives of the normal force that a point adds, where it is along the roller [m], the fraction of the
# roller's length that it stands for, and the drop of the profile there [m]
D_DEPTH, D_RATE, POSITION, FRACTION, DROP = range(len(CONTACT), len(CONTACT) + 5)
POINT_ROWS = len(CONTACT) + 5
SLICED_ROWS = 44
RING_Y, RING_Z, RING_TILT_Y, RING_TILT_Z, CAGE_Y, CAGE_Z, CAGE_TILT_Y, CAGE_TILT_Z, THETA = range(BORDER)
OMEGA = BORDER + THETA
ROLLERS = 2 * BORDER  # where the rollers' states begin: a run of Z for each of the nine
R, PHI, TILT, SKEW, R_SPEED, PHI_SPEED, TILT_SPEED, SKEW_SPEED, SPIN = range(BLOCK)
RUNS = StateRuns(ROLLERS, R, PHI, R_SPEED, PHI_SPEED, SPIN)
INNER, OUTER = 0, 1  # raceways in the means of laminae
_PLAIN_ROWS = 67  # of a roller without flanges
ROLLER_ROWS = _PLAIN_ROWS + 2 * FLANGE_ROWS


class SlicedRow(NamedTuple):
    """Indices of the rows of a sliced contacts array: all blocks of inner contacts, then all of outer ones.  Moments are sums of forces times x."""

    load: int = 0  # normal force Q [N]
    rolling: int = 1  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 2  # surface-speed difference du in the middle, raceway less roller [m/s]
    force: int = 3  # traction T on the roller, with the sign of du [N]
    tilting: int = 4  # moment of the normal forces [N m]
    skewing: int = 5  # moment of the tractions [N m]
    penetration: int = 6  # in the middle [m]
    rate: int = 7  # its time derivative [m/s]
    lean: int = 8  # slope of the penetration along the axis
    lean_rate: int = 9  # its time derivative [1/s]
    sliding_lean: int = 10  # slope of du along the axis [1/s]
    stiffness: int = 11  # from here on sums over points of derivatives times 1, x and x^2: of q by penetration
    damping: int = 14  # of q by its rate
    of_force: int = 17  # derivatives of the traction by penetration and lean, three rows on by their rates
    of_skewing: int = 22  # derivatives of its moment by the same
    d_sliding: int = 27  # sums of dT/d(du) times 1, x and x^2
    d_rolling: int = 30  # of dT/du times 1 and x
    left: int = 32  # ends of the part that bears, from -1 to 1, where points are those of a quadrature
    right: int = 33
    part: int = 34  # from here on written only where contacts resist rolling: fraction of the length that bears
    gap: int = 35  # beside it [m]
    resistance: int = 36  # F_R [N]
    resistance_d_rolling: int = 37  # dF_R/du [N s/m]
    resistance_d_load: int = 38  # dF_R/dQ
    of_resistance: int = 39  # derivatives by penetration and lean, three rows on by their rates


SLICED = SlicedRow()


class RollerRow(NamedTuple):
    """Indices of the rows of the rollers array, see `bearing_sim.numerics.simd.new_rows`; frame: outwards, along the orbit."""

    radius: int = 0  # r [m]
    angle: int = 1  # phi [rad]
    tilt: int = 2  # inclination of the axis outwards [rad]
    skew: int = 3  # and along the orbit
    radial_speed: int = 4  # r' [m/s]
    orbital_speed: int = 5  # phi' [rad/s]
    tilt_speed: int = 6  # in the frame that turns with the orbit [rad/s]
    skew_speed: int = 7
    spin: int = 8  # w [rad/s]
    radial_acceleration: int = 9  # r'' [m/s^2]
    orbital_acceleration: int = 10  # phi'' [rad/s^2]
    tilt_acceleration: int = 11
    skew_acceleration: int = 12
    spin_acceleration: int = 13  # w' [rad/s^2]
    present: int = 14  # 1 for a roller, 0 for a lane that holds none
    pitch_cosine: int = 15  # of 2 pi j/Z
    pitch_sine: int = 16
    cosine: int = 17  # of the roller's azimuth
    sine: int = 18
    normal_r: int = 19  # direction from the ring's centre to the roller's
    normal_t: int = 20
    inverse_distance: int = 21  # of both centres [1/m]
    speed_normal: int = 22  # of the roller's centre seen from the ring's [m/s]
    speed_tangent: int = 23
    lean_normal: int = 24  # inclination against the ring, along the normal and across [rad]
    lean_tangent: int = 25
    lean_speed_normal: int = 26  # how fast the axes incline against each other, in the same directions [rad/s]
    lean_speed_tangent: int = 27
    slope: int = 28  # dR_e/dphi [m/rad]
    curvature: int = 29  # d2R_e/dphi2 [m/rad^2]
    churning: int = 30  # drag of the mixture against the orbit [N]
    pocket_cosine: int = 31  # of the pocket's azimuth
    pocket_sine: int = 32
    play_cosine: int = 33  # of the angle from the pocket to the roller
    play_sine: int = 34
    pocket_offset: int = 35  # of the roller from the middle of its pocket [m]
    pocket_rate: int = 36  # its time derivative [m/s]
    pocket_skew: int = 37  # inclination of the roller in its pocket, along the pocket's tangent [rad]
    pocket_skew_rate: int = 38  # [rad/s]
    pocket_lean: int = 39  # and outwards [rad]
    pocket_force: int = 40  # of the pocket on the roller along the orbit [N]
    pocket_moment: int = 41  # sum of force times position along the axis [N m]
    pocket_friction: int = 42  # coefficient, with the sign of the spin
    pocket_friction_d_spin: int = 43  # by spin [s/rad]
    pocket_stiffness: int = 44  # sums over slices of the force's derivative by offset, times 1, x, x^2
    pocket_damping: int = 47  # and by the offset's rate
    contour: int = 50  # from here on, steps of a prediction: R_e at the roller's new azimuth [m]
    known_radius: int = 51  # known terms of its stage [m, m/s, rad, rad/s]
    known_speed: int = 52
    known_tilt: int = 53
    known_tilt_speed: int = 54
    guide_offset: int = 55  # from here on pockets that guide: of the roller outwards from the pocket's middle [m]
    guide_rate: int = 56  # its time derivative [m/s]
    guide_lean_rate: int = 57  # that of ``pocket_lean`` [rad/s]
    guide_force: int = 58  # of the pocket on the roller, outwards from the cage [N]
    guide_moment: int = 59  # sum of force times position along the axis [N m]
    guide_stiffness: int = 60  # as ``pocket_stiffness``
    guide_damping: int = 63
    moved: int = 66  # by the last iteration of a prediction [m]; scratch of the outer ring where it bends
    inner_flange: int = _PLAIN_ROWS  # from here on flanges: of the inner ring, rows `bearing_sim.levels.common.flanges.FLANGE`
    outer_flange: int = _PLAIN_ROWS + FLANGE_ROWS  # of the outer ring, likewise


ROLLER = RollerRow()


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    rollers: np.ndarray  # rows `ROLLER`
    contacts: np.ndarray  # rows `bearing_sim.levels.spatial.state.SLICED`, those with the inner raceway first
    points: np.ndarray  # of contacts, see `bearing_sim.levels.spatial.slices.press_points`
    first_points: np.ndarray  # by block of contacts, see there, int64
    jacobian: np.ndarray  # derivatives through each roller, see `bearing_sim.numerics.block_arrow`
    chain: np.ndarray  # scratch for derivatives of one block of rollers, shape (1, 208, LANES)
    global_block: np.ndarray  # derivatives of the border's accelerations by border positions and speeds, shape (9, 18)
    lands: np.ndarray  # scratch of the guide lands, shape (4, 18)
    land_own: np.ndarray  # scratch of the guide lands, shape (2, 5, 10)
    factored: Factored  # of I - gamma h J
    support: np.ndarray  # memory of the support, see `bearing_sim.levels.common.support.new_support`
    evaluated_ring: np.ndarray  # position, velocity and tilts of the ring where forces were evaluated last [m, m/s, rad], shape (6,)
    ring_stiffness: np.ndarray  # as at level ``planar``, shape (3,)
    load_moments: np.ndarray  # as at level ``planar``, shape (2, MOMENTS)
    last_moments: np.ndarray  # likewise
    tally: np.ndarray  # likewise
    lamina_powers: np.ndarray  # by lanes, see `bearing_sim.levels.spatial.slices.average_laminae`, shape (2, laminae, LANES)
    lamina_now: np.ndarray  # powers at one instant, likewise
    lamina_last: np.ndarray  # powers at the last instant that counted, likewise
    lamina_means: np.ndarray  # sums of them over the lanes where a sample was asked for, shape (2, laminae)
    lamina_turn: np.ndarray  # by which the cage has turned since laminae were last averaged [rad], shape (1,)
    bending: Bending | None  # as at level ``planar``, also the following
    ring_loads: np.ndarray
    ring_rates: np.ndarray
    bent_at: np.ndarray


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    rollers = new_rollers(ROLLER, ROLLER_ROWS, count)
    return Work(
        rollers=rollers,
        contacts=new_blocks(2 * rollers.shape[0], SLICED_ROWS),
        points=new_blocks(2 * rollers.shape[0] * params.slices.points, POINT_ROWS),
        first_points=np.full(2 * rollers.shape[0], -1, np.int64),
        jacobian=new_rows(LAYOUT.rows, count),
        chain=new_blocks(1, 208),
        global_block=np.zeros((BORDER, 2 * BORDER)),
        lands=np.zeros((4, 2 * BORDER)),
        land_own=np.zeros((2, 5, 10)),
        factored=new_factored(LAYOUT, count),
        support=new_support(params.support, 2 * BORDER + BLOCK * count),
        evaluated_ring=np.zeros(6),
        ring_stiffness=np.zeros(3),
        load_moments=np.zeros((2, MOMENTS)),
        last_moments=np.zeros((2, MOMENTS)),
        tally=np.zeros(len(Tally._fields)),
        lamina_powers=new_blocks(2, len(params.life.laminae.positions)),
        lamina_now=new_blocks(2, len(params.life.laminae.positions)),
        lamina_last=new_blocks(2, len(params.life.laminae.positions)),
        lamina_turn=np.zeros(1),
        lamina_means=np.zeros((2, len(params.life.laminae.positions))),
        bending=None if params.outer_ring is None else new_bending(params.outer_ring, rollers_move=True),
        ring_loads=np.zeros((len(LOAD), count)),
        ring_rates=np.zeros(count),
        bent_at=np.zeros(1),
    )
