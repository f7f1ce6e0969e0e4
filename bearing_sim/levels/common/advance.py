# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How every level advances over an interval: a time-stepping method from sample to sample."""

import math

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.time_stepping import COUNT, OK, advance_in_steps
from bearing_sim.numerics.tr_bdf2 import ERROR_ORDER, tr_bdf2_attempt


@kernel
def advance_by(kernels, fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance ``y`` in place by ``duration`` [s] and write evenly spaced samples into ``rows``, the last at the end.

    Parameters
    ----------
    kernels : of the level, see `bearing_sim.numerics.time_stepping.Kernels`.
    fixed : whether steps are of ``maximum_step`` and nothing controls their error.
    t : time [s].
    h : step to try first [s].
    maximum_step : longest step, or the fixed one [s].
    budget : steps for the whole call, rejected ones included.
    memory : of the method.
    counts : work done, see `bearing_sim.numerics.time_stepping.Count`; added to.
    previous, rows : flat samples; see `observe`.

    Returns
    -------
    status : OK, or a key of `bearing_sim.numerics.time_stepping.REASONS`.
    h : step to try next [s].
    """
    samples = rows.shape[0]
    interval = duration / samples
    before = previous
    memory.derivative_time[0] = math.nan  # inputs may have changed
    taken = counts[COUNT.steps] + counts[COUNT.rejected_steps]
    for k in range(samples):
        start, end = t + k * interval, t + (k + 1) * interval
        left = budget - (counts[COUNT.steps] + counts[COUNT.rejected_steps] - taken)
        status, h = advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, kernels, fixed, start, end, y, h, maximum_step, left, model, work, memory, counts)
        if status != OK:
            return status, h
        kernels.observe(end, y, model, work, interval, before, rows[k], memory)
        before = rows[k]
    return OK, h
