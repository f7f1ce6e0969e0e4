# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Two-stage linearly implicit W-method of order 2 (ROS2).

J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer: A second-order Rosenbrock method applied to photochemical
dispersion problems, SIAM J. Sci. Comput. 20 (1999), eq. 2.2:

    (I - gamma h J) k_1 = f(y),    (I - gamma h J) k_2 = f(y + h k_1) - 2 k_1,    y_new = y + 3/2 h k_1 + 1/2 h k_2.

L-stable with gamma = 1 - 1/sqrt 2, and of order 2 whatever matrix stands for the Jacobian J, so that small couplings may be left
out of it.  The embedded method of order 1 is y + h k_1.
"""

import math

from bearing_sim.numerics.compilation import template
from bearing_sim.numerics.time_stepping import COUNT, NOT_CONVERGED, NOT_EVALUATED, OK

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
ERROR_ORDER = 2.0  # the error estimate goes with this power of the step


@template
def rosenbrock2_attempt(rhs, rhs_and_jacobian, factor, solve, t, y, h, model, work, memory, counts):
    """Compute one step of ``h`` [s] from (t, y); see `bearing_sim.numerics.time_stepping`.

    A step that follows a rejected one keeps rate and Jacobian, unless ``memory.derivative_time`` has been set to NaN.  Result and error
    estimate, the difference to the embedded method, go to rows 1 and 2 of ``memory.scratch``.
    """
    rate, result, error, first, second = memory.scratch[0], memory.scratch[1], memory.scratch[2], memory.scratch[3], memory.scratch[4]
    if memory.derivative_time[0] != t:
        memory.derivative_time[0] = math.nan
        counts[COUNT.right_hand_sides] += 1
        counts[COUNT.jacobians] += 1
        if not rhs_and_jacobian(t, y, model, work, rate):
            return NOT_EVALUATED
        memory.derivative_time[0] = t
    counts[COUNT.factorisations] += 1
    if not factor(GAMMA * h, work):
        return NOT_CONVERGED
    for i in range(y.shape[0]):
        first[i] = h * rate[i]
    solve(work, first)
    for i in range(y.shape[0]):
        result[i] = y[i] + first[i]
    counts[COUNT.right_hand_sides] += 1
    if not rhs(t + h, result, model, work, second):
        return NOT_EVALUATED
    for i in range(y.shape[0]):
        second[i] = h * second[i] - 2.0 * first[i]
    solve(work, second)
    for i in range(y.shape[0]):
        error[i] = 0.5 * (first[i] + second[i])
        result[i] = y[i] + 1.5 * first[i] + 0.5 * second[i]
    return OK
