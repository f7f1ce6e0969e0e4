# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``planar`` advanced by methods other than its own; the scene names which."""

from bearing_sim.integrators.bdf import bdf
from bearing_sim.integrators.fixed_step import fixed_step
from bearing_sim.integrators.rk45 import rk45
from bearing_sim.integrators.status import COUNT
from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.advance import advance_by
from bearing_sim.levels.planar import (
    average_loads,
    count_iterations,
    error_norm,
    factor,
    nothing,
    observe,
    rhs,
    rhs_and_jacobian,
    sdirk2,
    solve,
    step_limit,
)

STRICTER = 30.0  # sdirk2's estimate is that of order 1, far above its error; these estimate what they err


@kernel
def strict_error_norm(t, y, change, tolerance, model):
    """Return `bearing_sim.levels.planar.error_norm` so scaled that one tolerance means about one accuracy in every method."""
    return STRICTER * error_norm(t, y, change, tolerance, model)


@kernel
def _drive_bdf(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return bdf(
        rhs, rhs_and_jacobian, factor, solve, strict_error_norm, step_limit, average_loads,
        t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts,
    )  # fmt: skip


@kernel
def _drive_rk45(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return rk45(rhs, strict_error_norm, step_limit, average_loads, t, end, y, h, tolerance, maximum_step, budget, model, work, memory.scratch, counts)


@kernel
def _drive_fixed(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    evaluated, derived, factored = counts[COUNT.right_hand_sides], counts[COUNT.jacobians], counts[COUNT.factorisations]
    status, h = fixed_step(nothing, sdirk2, average_loads, t, end, y, maximum_step, budget, model, work, memory.scratch, counts)
    count_iterations(evaluated, derived, factored, work, counts)
    return status, h


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
