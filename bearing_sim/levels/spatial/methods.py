# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``spatial`` advanced with error control, or in fixed steps.

Parameters and results are those of `bearing_sim.levels.common.advance.advance_by`.
"""

import math

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.spatial.model import (
    correction_norm,
    error_norm,
    factor,
    observe,
    restrain,
    rhs,
    rhs_and_jacobian,
    solve,
    step_limit,
    sum_up,
)
from bearing_sim.levels.spatial.predictor import predict
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.tr_bdf2 import ERROR_ORDER, tr_bdf2_attempt


@kernel
def _attempt(t, y, h, model, work, memory, counts):
    return tr_bdf2_attempt(rhs, rhs_and_jacobian, predict, factor, solve, error_norm, correction_norm, restrain, t, y, h, model, work, memory, counts)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control, or ``fixed`` in steps of ``maximum_step`` [s] without it."""
    memory.derivative_time[0] = math.nan  # inputs may have changed
    return advance_by(
        _attempt, ERROR_ORDER, error_norm, step_limit, sum_up, observe, fixed,
        t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows,
    )  # fmt: skip
