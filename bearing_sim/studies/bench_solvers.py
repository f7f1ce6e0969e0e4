# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench's problem through the solvers that everybody has: scipy's and SUNDIALS'.

All get the same compiled right-hand side and nothing else, one relative tolerance, and an absolute tolerance of each state that
weighs errors as the level's own error norm does (`bearing_sim.studies.bench_problem.state_scales`).
"""

import time
from typing import NamedTuple

import numpy as np

from bearing_sim.studies.bench_problem import Problem, state_scales

OTHERS = ("LSODA", "BDF", "CVODE")
_FIRST_STEP = 1e-8  # s


class SolverRun(NamedTuple):
    """How a solver did."""

    states: np.ndarray | None  # at the times asked for, shape (times, n); None where it did not get there
    spent: float  # time on the core [s]
    right_hand_sides: int
    fault: str  # why there is no result, or ""


class _TooLong(Exception):
    pass


def solve_with(solver: str, problem: Problem, times: np.ndarray, tolerance: float, patience: float = 60.0) -> SolverRun:
    """Integrate a problem from its start at time 0.

    Parameters
    ----------
    solver : a method of `scipy.integrate.solve_ivp`, or "CVODE" (scikit-sundae, BDF of order 1 to 5 with a dense Jacobian).
    problem : what to integrate.
    times : when the state is wanted [s], rising; the last is the end.
    tolerance : relative.
    patience : time on the core after which to give up [s].
    """
    rhs, model, work = problem.kernels.rhs, problem.model, problem.work
    state, out, evaluations, deadline = np.zeros_like(problem.start), np.zeros_like(problem.start), 0, np.inf

    def rate(t, y):
        nonlocal evaluations
        evaluations += 1
        if time.process_time() > deadline:
            raise _TooLong
        state[:] = y  # some solvers hand over read-only or strided memory, which would be compiled for again
        rhs(t, state, model, work, out)
        return out.copy()

    rate(0.0, problem.start)  # compiles
    evaluations, scales = 0, state_scales(problem)
    started = time.process_time()
    deadline = started + patience
    try:
        states, fault = (_sundials if solver == "CVODE" else _scipy)(rate, solver, problem.start, times, tolerance, scales)
    except _TooLong:
        states, fault = None, f"gave up after {patience:g} s"
    except ImportError:
        states, fault = None, "scikit-sundae is not installed"
    return SolverRun(states, time.process_time() - started, evaluations, fault)


def _scipy(rate, solver, start, times, tolerance, scales):
    from scipy.integrate import solve_ivp

    # A first step is given, because the one that scipy guesses lets explicit methods try states that overflow.
    with np.errstate(all="ignore"):
        found = solve_ivp(rate, (0.0, times[-1]), start, solver, t_eval=times, rtol=tolerance, atol=tolerance * scales, first_step=_FIRST_STEP)
    return (found.y.T, "") if found.success else (None, found.message)


def _sundials(rate, solver, start, times, tolerance, scales):
    from sksundae.cvode import CVODE

    def fill(t, y, rates):
        rates[:] = rate(t, y)

    method = CVODE(fill, method="BDF", rtol=tolerance, atol=tolerance * scales, first_step=_FIRST_STEP, max_num_steps=10_000_000)
    found = method.solve(np.concatenate([[0.0], times]), start)
    return (np.asarray(found.y)[1:], "") if found.success else (None, str(found.message))
