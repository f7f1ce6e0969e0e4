# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The algebra of a system of one equation, for tests of integrators: what a level brings to them, as small as it gets.

``work`` holds the Jacobian and its factor; models and right-hand sides are the tests' own.  What stands at the end, and `kept`, fits
systems of any size.
"""

from bearing_sim.kernels.compilation import kernel


@kernel
def kept(h, y, model, work):
    pass


@kernel
def nothing(t, y, model, work, rate):
    return True


@kernel
def factor(shift, work):
    work[1] = 1.0 - shift * work[0]
    return work[1] != 0.0


@kernel
def solve(work, x):
    x[0] /= work[1]


@kernel
def norm(t, y, change, tolerance, model):
    return abs(change[0]) / tolerance


@kernel
def stay(known, shift, slope, model, work, guess):
    guess[0] = known[0]


@kernel
def no_limit(t, y, model):
    return 1e9


@kernel
def failing(t, y, model, work, rate):
    return False
