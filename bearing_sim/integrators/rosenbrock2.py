# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Two-stage linearly implicit W-method of order 2 (ROS2).

J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer: A second-order Rosenbrock method applied to photochemical
dispersion problems, SIAM J. Sci. Comput. 20 (1999), eq. 2.2.  L-stable with gamma = 1 - 1/sqrt 2, and of order 2
whatever matrix stands for the Jacobian, so that small couplings may be left out of it.
"""

import math

from bearing_sim.kernels.compilation import template

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)


@template
def rosenbrock2_step(rhs, factor, solve, t, y, rate, h, model, work, stages, next_y, error):
    """Take one step from (t, y); write the result and its error estimate.

    Parameters
    ----------
    rhs, factor, solve : kernels of the level; ``rhs(t, y, model, work, rate)`` and ``factor(shift, work)`` return whether
        they succeeded, ``solve(work, x)`` replaces the right side by the solution.
    rate : dy/dt at (t, y), shape (n,); the Jacobian there is in ``work``.
    h : step [s].
    stages : scratch, shape (2, n).
    next_y, error : results, shape (n,); the error is the difference to the embedded method of order 1.

    Returns
    -------
    evaluated : False where a kernel failed.
    """
    if not factor(GAMMA * h, work):
        return False
    first, second = stages[0], stages[1]
    for i in range(y.shape[0]):
        first[i] = h * rate[i]
    solve(work, first)
    for i in range(y.shape[0]):
        next_y[i] = y[i] + first[i]
    if not rhs(t + h, next_y, model, work, second):
        return False
    for i in range(y.shape[0]):
        second[i] = h * second[i] - 2.0 * first[i]
    solve(work, second)
    for i in range(y.shape[0]):
        error[i] = 0.5 * (first[i] + second[i])
        next_y[i] = y[i] + 1.5 * first[i] + 0.5 * second[i]
    return True
