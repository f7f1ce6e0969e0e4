# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The algebra of a system of one equation, for tests of time-stepping methods: the kernels of a level, as small as possible.

``work`` holds the Jacobian and its factor; models and right-hand sides are the tests' own.  `step_taken`, `no_limit` and `failing` fit
systems of any size.
"""

from bearing_sim.numerics.compilation import kernel


@kernel
def step_taken(t, h, y, model, work):
    pass


@kernel
def factor(shift, work):
    work[1] = 1.0 - shift * work[0]
    return work[1] != 0.0


@kernel
def solve(work, x):
    x[0] /= work[1]


@kernel
def no_limit(t, y, model, work):
    return 1e9


@kernel
def failing(t, y, model, work, rate):
    return False
