# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``slip`` advanced with error control, or in fixed steps.

Parameters and results of every function are those of `bearing_sim.levels.common.advance.advance_by`.
"""

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.slip.model import error_norm, factor, keep_nothing, observe, rhs, rhs_and_step_jacobian, solve, step_limit
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.rosenbrock2 import rosenbrock2, rosenbrock2_fixed
from bearing_sim.numerics.time_stepping import start_from_known


@kernel
def advance(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control."""
    return advance_by(
        rosenbrock2, rhs, rhs_and_step_jacobian, start_from_known, factor, solve, error_norm, step_limit, keep_nothing, observe,
        t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows,
    )  # fmt: skip


@kernel
def advance_fixed(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance in steps of ``maximum_step`` [s] without error control."""
    return advance_by(
        rosenbrock2_fixed, rhs, rhs_and_step_jacobian, start_from_known, factor, solve, error_norm, step_limit, keep_nothing, observe,
        t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows,
    )  # fmt: skip
