# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How every level goes through an interval: a method's drive loop from sample to sample."""

from bearing_sim.integrators.status import COUNT, OK
from bearing_sim.kernels.compilation import template


@template
def advance_by(drive_to, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance ``y`` in place by ``duration`` [s] and write evenly spaced samples into ``rows``, the last at the end.

    Parameters
    ----------
    drive_to : kernel, a method's drive loop; takes ``stop`` after ``end``, which it may pass, but not ``stop``.
    observe : kernel of the level, writes a sample.
    t : time [s].
    h, maximum_step, counts : as in `bearing_sim.integrators.drive.drive`.
    budget : steps for the whole call.
    memory : of the method.
    previous, rows : flat samples; see `bearing_sim.levels.slip.observe`.

    Returns
    -------
    status, next step to try [s]
    """
    samples = rows.shape[0]
    interval = duration / samples
    before = previous
    taken, stop = counts[COUNT.steps] + counts[COUNT.rejected_steps], t + samples * interval
    for k in range(samples):
        start, end = t + k * interval, t + (k + 1) * interval
        left = budget - (counts[COUNT.steps] + counts[COUNT.rejected_steps] - taken)
        status, h = drive_to(start, end, stop, y, h, model.tolerance, maximum_step, left, model, work, memory, counts)
        if status != OK:
            return status, h
        observe(end, y, model, work, interval, before, rows[k], memory.scratch[0])
        before = rows[k]
    return OK, h
