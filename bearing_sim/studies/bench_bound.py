# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What bounds a level's speed: each kernel measured alone, in a compiled loop, and its share in a step."""

import functools
import time

import numba
import numpy as np

from bearing_sim.studies.bench_problem import Problem

_REPEATS = 5
_SHIFT = 2e-6  # s; the time of a solution does not hang on it


def kernel_times(problem: Problem, state: np.ndarray, calls: int) -> dict[str, float]:
    """Return the time of one call of each kernel [us] at a state, the least of five loops over ``calls`` of them.

    ``jacobian`` is what `rhs_and_jacobian` takes beyond the right-hand side.
    """
    kernels, model, work = problem.kernels, problem.model, problem.work
    rate, x = np.zeros_like(state), np.zeros_like(state)
    times = {"right_hand_side": _least(_evaluations(kernels.rhs), calls, 0.0, state, model, work, rate)}
    if None not in kernels:
        both = _least(_evaluations(kernels.rhs_and_jacobian), calls, 0.0, state, model, work, rate)
        times["jacobian"] = both - times["right_hand_side"]
        times["factorisation"] = _least(_factorisations(kernels.factor), calls, _SHIFT, work)
        times["solve"] = _least(_solutions(kernels.solve), calls, work, rate, x)
        times["error_norm"] = _least(_norms(kernels.error_norm), calls, 0.0, state, rate, model)
    return times


def shares(times: dict[str, float], counters: dict, step_us: float) -> dict[str, float]:
    """Return the part of a step's time that goes into each kernel, by what is counted in a step.

    An implicit method is taken to solve and to measure once for each right-hand side, and to factor at least once for each
    Jacobian; an explicit one to measure once a step.  What is left is the method's own arithmetic and the loop around it.
    """
    steps, evaluations = counters["steps"], counters["right_hand_sides"]
    factorisations = max(counters.get("factorisations", 0), counters["jacobians"])
    implicit = factorisations > 0
    calls = {
        "right_hand_side": evaluations,
        "jacobian": counters["jacobians"],
        "factorisation": factorisations,
        "solve": evaluations if implicit else 0,
        "error_norm": evaluations if implicit else steps + counters["rejected_steps"],
    }
    parts = {name: calls[name] / steps * spent / step_us for name, spent in times.items()}
    return {**parts, "rest": 1.0 - sum(parts.values())}


def _least(loop, calls, *arguments):
    loop(1, *arguments)  # compiles
    best = np.inf
    for _ in range(_REPEATS):
        started = time.process_time()
        loop(calls, *arguments)
        best = min(best, time.process_time() - started)
    return 1e6 * best / calls


# Loops around kernels are specialised in each process: they are small, and no cache on disk could keep them.
@functools.cache
def _evaluations(evaluate):
    @numba.njit(error_model="numpy")
    def loop(calls, t, y, model, work, rate):
        for _ in range(calls):
            evaluate(t, y, model, work, rate)

    return loop


@functools.cache
def _factorisations(factor):
    @numba.njit(error_model="numpy")
    def loop(calls, shift, work):
        for _ in range(calls):
            factor(shift, work)

    return loop


@functools.cache
def _solutions(solve):
    @numba.njit(error_model="numpy")
    def loop(calls, work, right, x):
        for _ in range(calls):
            for i in range(x.shape[0]):  # a side solved for again and again would fade into slow, tiny numbers
                x[i] = right[i]
            solve(work, x)

    return loop


@functools.cache
def _norms(error_norm):
    @numba.njit(error_model="numpy")
    def loop(calls, t, y, change, model):
        largest = 0.0
        for _ in range(calls):
            largest += error_norm(t, y, change, 1.0, model)
            change[0] += 1e-300  # or the compiler would do it once
        return largest

    return loop
