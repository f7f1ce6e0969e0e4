# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What level ``slip`` keeps: the order of its state, and the memory that it writes while it computes.

State: y = (theta_c, omega_c, w_1, ..., w_Z) in rad and rad/s.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.observation import Tally
from bearing_sim.numerics.linear_algebra import Arrow, new_arrow
from bearing_sim.numerics.simd import blocks_of, new_blocks
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.lamina_life import MOMENTS
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import Bending, new_bending

THETA, OMEGA, SPIN = 0, 1, 2


class PocketRow(NamedTuple):
    """Rows of ``Work.pockets``, see `bearing_sim.levels.slip.forces.press_pockets`."""

    force: int = 0  # that each takes from its roller along the orbit [N]
    felt: int = 1  # part that it feels of the force without play
    felt_change: int = 2  # and of a change of that force
    d_cage: int = 3  # derivative of the other forces on the roller by the cage's speed [N s/rad]
    brake: int = 4  # friction against the roller's spin [N]


POCKET = PocketRow()


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    loads: np.ndarray  # rows `bearing_sim.physics.load_balance.LOAD`, shape (10, Z)
    ring: np.ndarray  # ring centre (y, z) [m], shape (2,); start of the next search
    contacts: np.ndarray  # rows `bearing_sim.physics.contact.CONTACT`, those with the inner raceway first
    tangential: np.ndarray  # all forces along the orbit on each roller but the pocket's [N], shape (Z,)
    pockets: np.ndarray  # rows `POCKET`, shape (len(PocketRow), Z)
    flanges: np.ndarray  # on each roller: force along the orbit [N] and torque on its spin [N m] of the inner ring's, then of the outer's, (4, Z)
    growth: np.ndarray  # of the inner raceway at present [m], and pressure of the outer ring's seat [Pa], see `write_growth`, shape (2,)
    pitch: np.ndarray  # rows cosine and sine of 2 pi j/Z, and the angle in intervals of the contour table, shape (3, Z)
    # of roller loads, running means over a cage turn, see `bearing_sim.physics.lamina_life.add_load_moments`, shape (2, MOMENTS)
    load_moments: np.ndarray
    last_moments: np.ndarray  # those powers at the end of the last step, likewise
    present_moments: np.ndarray  # and of the present one
    tally: np.ndarray  # sums over time, see `bearing_sim.levels.common.observation.Tally`
    bending: Bending | None  # of the outer ring; None: it is rigid
    jacobian: Arrow
    factored: Arrow  # of I - gamma h J


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    angles = 2 * math.pi * np.arange(count) / count
    return Work(
        loads=np.zeros((len(LOAD), count)),
        ring=np.zeros(2),
        contacts=new_blocks(2 * blocks_of(count), len(CONTACT)),
        tangential=np.zeros(count),
        pockets=np.zeros((len(POCKET), count)),
        flanges=np.zeros((4, count)),
        growth=np.zeros(2),
        pitch=np.array([np.cos(angles), np.sin(angles), params.raceways.contour.shape[0] * np.arange(count) / count]),
        load_moments=np.zeros((2, MOMENTS)),
        last_moments=np.zeros((2, MOMENTS)),
        present_moments=np.zeros((2, MOMENTS)),
        tally=np.zeros(len(Tally._fields)),
        bending=None if params.outer_ring is None else new_bending(params.outer_ring),
        jacobian=new_arrow(count),
        factored=new_arrow(count),
    )
