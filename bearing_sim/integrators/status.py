# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How an advance ended: values, because compiled code raises nothing."""

from typing import NamedTuple

import numpy as np

OK = 0
STEP_BUDGET = 1
STEP_TOO_SMALL = 2
NON_FINITE = 3
NOT_EVALUATED = 4
NOT_CONVERGED = 5

REASONS = {
    STEP_BUDGET: "the step budget was used up before the end of the interval",
    STEP_TOO_SMALL: "no step converged, down to the smallest",
    NON_FINITE: "the state stopped being finite",
    NOT_EVALUATED: "the right-hand side could not be evaluated",
    NOT_CONVERGED: "the iteration of a step did not converge, nor that of its thousandth part",
}


class Count(NamedTuple):
    """Where each kind of work is counted in an int64 array of shape (len(Count),)."""

    steps: int = 0
    rejected_steps: int = 1
    non_finite_steps: int = 2
    right_hand_sides: int = 3
    jacobians: int = 4
    factorisations: int = 5
    smallest_steps: int = 6  # taken although their error was too large, because no step is smaller
    unsettled_points: int = 7  # operating points of level steady that were taken as far as marching came


COUNT = Count()
SMALLEST_STEP = 1e-12  # s; a step this small is taken whatever its error, which is then that of a jump, or round-off


def new_counts() -> np.ndarray:
    """Return zeroed counts."""
    return np.zeros(len(COUNT), np.int64)
