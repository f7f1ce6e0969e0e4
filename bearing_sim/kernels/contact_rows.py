# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What laws of contacts share: the rows of a contacts array, and the constants of a traction law."""

from typing import NamedTuple

import numpy as np

# Below these the powers of the fits run away; both are far below anything that carries torque.
LOAD_FLOOR = 1e-3  # N
ROLLING_SPEED_FLOOR = 0.05  # m/s

FITTED, KRAGELSKII, EYRING = 0, 1, 2  # what `TractionConstants.law` may be
SPECIAL = 14  # constants of a law that is more than the fitted form


class TractionConstants(NamedTuple):
    """ln D, ln B, ln C of one contact as affine functions of ln Q and ln u (SI), and what a law has besides."""

    scale: float
    d_constant: float
    d_load: float
    d_speed: float
    b_constant: float
    b_load: float
    b_speed: float
    c_constant: float
    c_load: float
    c_speed: float
    law: int
    special: np.ndarray  # shape (SPECIAL,); zeros of a law that is of the fitted form alone


class ContactRow(NamedTuple):
    """Rows of a contacts array (see `bearing_sim.kernels.lanes.new_rows`): all blocks of inner contacts, then all of outer ones."""

    load: int = 0  # normal force Q [N]
    rolling: int = 1  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 2  # surface-speed difference du, raceway less roller [m/s]
    force: int = 3  # T on the roller, with the sign of du [N]
    by_sliding: int = 4  # dT/d(du) [N s/m]
    by_rolling: int = 5  # dT/du [N s/m]
    by_load: int = 6  # dT/dQ
    log_load: int = 7  # from here on, steps of the computation
    log_speed: int = 8
    inverse_speed: int = 9
    d: int = 10
    b: int = 11
    c: int = 12
    decay: int = 13
    penetration: int = 14  # [m]; these five belong to the normal force
    rate: int = 15  # its time derivative [m/s]
    stiffness: int = 16  # dQ by penetration [N/m]
    damping: int = 17  # dQ by its rate [N s/m]
    log_penetration: int = 18
    pumping: int = 19  # F_R, against the motion of each surface through the contact [N]
    pumping_by_rolling: int = 20  # its slopes [N s/m]
    pumping_by_load: int = 21


CONTACT = ContactRow()
