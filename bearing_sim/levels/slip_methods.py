# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``slip`` advanced by methods other than its own; the scene names which."""

from bearing_sim.integrators.bdf import bdf
from bearing_sim.integrators.fixed_step import fixed_step
from bearing_sim.integrators.rk45 import rk45
from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.advance import advance_by
from bearing_sim.levels.slip import error_norm, factor, keep_nothing, observe, rhs, rhs_and_jacobian, rosenbrock2, solve, step_limit


@kernel
def _drive_bdf(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return bdf(
        rhs, rhs_and_jacobian, factor, solve, error_norm, step_limit, keep_nothing,
        t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts,
    )  # fmt: skip


@kernel
def _drive_rk45(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return rk45(rhs, error_norm, step_limit, keep_nothing, t, end, y, h, tolerance, maximum_step, budget, model, work, memory.scratch, counts)


@kernel
def _drive_fixed(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return fixed_step(rhs_and_jacobian, rosenbrock2, keep_nothing, t, end, y, maximum_step, budget, model, work, memory.scratch, counts)


@kernel
def advance_bdf(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by backward differentiation formulas (`bearing_sim.integrators.bdf`)."""
    return advance_by(_drive_bdf, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)


@kernel
def advance_rk45(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by an explicit method (`bearing_sim.integrators.rk45`)."""
    return advance_by(_drive_rk45, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)


@kernel
def advance_fixed(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by the level's own method with one step, ``maximum_step`` [s], and no error control (`bearing_sim.integrators.fixed_step`)."""
    return advance_by(_drive_fixed, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
