# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One scene at the extremes, run with its own settings, and the judgement of what came of it.

A case is *finished*; *step-limited*, if it ran well but something other than the equations limited it
(a fixed step that had to be divided, the study's budget of steps where the case's own settings ask for so many: a tolerance or
a step); *refused*, by the scene's checks before it starts; or *failed*: not finite, an exception, a process that
died, a hang, too slow without settings that explain it, or a physically impossible value.
"""

import math
import time
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.time_stepping import STEP_BUDGET
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Integration, Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs, tolerances_of
from bearing_sim.studies.extreme_run import (
    FAILED,
    FINISHED,
    REFUSED,
    STEP_LIMITED,
    Case,
    Segment,
    course_segments,
    impossible,
    rising_life,
    unsteady_slip,
)

STEPS = 20_000  # budget of a run whose settings require small steps
_PATIENT = 5  # times as many for other runs; needing more, one step per 0.2 us of 20 ms, is too slow
_FEWEST_STEPS, _STOCK_SLICES = 2_000, 18 * 20  # of a run with expensive steps, with more rollers times slices than this
_SHORTEST, _LONGEST, _PITCHES = 2e-3, 20e-3, 20.0  # simulated [s], and in roller pitches
_PATIENCE = 300.0  # s of wall time; a longer run counts as a hang
_SAMPLES = 4  # per segment
_SEGMENT_TO_TIME = 2e-5  # s; the cost of shorter segments is ignored
# A run that exhausts its steps is step-limited if its settings are tight, and too slow otherwise.  Tight settings are those of the references of the
# bench: a tenth of the default tolerance or less.
_TIGHT, _TIGHT_STEP = Integration().with_tolerances(0.1), 1e-5
_FIRST_PARTS = (1e-3, 9e-3, 9e-2, 0.9)  # of the first segment, to distinguish stuck from slow runs


class Outcome(NamedTuple):
    """Outcome of one case."""

    case: Case
    status: str  # one of OUTCOMES
    reason: str = ""  # what limited it, or why it was refused or failed
    simulated: float = 0.0  # [s]
    core_seconds: float = 0.0
    steps: int = 0
    rejected_steps: int = 0
    non_finite_steps: int = 0
    right_hand_sides: int = 0
    jacobians: int = 0
    steps_per_ms: float = 0.0  # in the segment with the most
    right_hand_sides_per_ms: float = 0.0  # likewise
    core_ms_per_ms: float = 0.0  # likewise
    step_us: float = 0.0  # core time of a step, in the segment with the slowest steps
    asks_for_small_steps: bool = False  # whether the case's own tolerance or step does


def case_result(case: Case) -> dict:
    """Return the fields of the outcome of one case, without the case."""
    fields = run_case(case)._asdict()
    del fields["case"]
    return fields


def run_case(case: Case) -> Outcome:
    """Run one case; any error becomes an outcome."""
    try:
        scene = load_scene(case.scene, case.overrides)
        scene = load_scene(case.scene, [*case.overrides, f"integration.step_budget={_step_budget(scene)}"])
        segments = first_divided(list(course_segments(case.course, case.seconds or _seconds(scene), scene_inputs(scene))))
        simulation = Simulation(scene, segments[0].inputs)
    except SceneError as error:
        return Outcome(case, REFUSED, "; ".join(str(each) for each in error.errors))
    except Exception as error:
        return Outcome(case, FAILED, f"{type(error).__name__} at the start: {error}")
    try:
        return _run(case, simulation, segments)
    except Exception as error:
        return Outcome(case, FAILED, f"{type(error).__name__}: {error}", simulation.time)


def _step_budget(scene: Scene) -> int:
    slices = scene.bearing.roller.count * ((scene.bearing.roller.slices or 20) if scene.level == "spatial" else 1)
    return max(_FEWEST_STEPS, round(STEPS * min(1.0, _STOCK_SLICES / slices))) * (1 if _asks_for_small_steps(scene) else _PATIENT)


def _seconds(scene: Scene) -> float:
    """Return the time to simulate: some roller pitches, but no more than the step budget allows at the required steps."""
    integration, bearing = scene.integration, scene.bearing
    pitches = 2 * math.pi * _PITCHES / (bearing.roller.count * max(0.5 * abs(scene.operating.shaft_speed) * (1 - bearing.diameter_ratio), 1e-9))
    step = integration.maximum_step if integration.fixed_step is None else integration.fixed_step
    return min(max(_SHORTEST, min(pitches, _LONGEST)), 0.5 * _step_budget(scene) * step)


def first_divided(segments: list[Segment]) -> list[Segment]:
    """Return the segments with the first one of nonzero duration cut into ever longer pieces."""
    start, first, *rest = segments
    pieces, passed = [], 0.0
    for part in _FIRST_PARTS:
        passed += part
        between = Inputs(*(a + passed * (b - a) for a, b in zip(start.inputs, first.inputs)))
        pieces.append(Segment(part * first.duration, between))
    return [start, *pieces, *rest]


def _run(case: Case, simulation: Simulation, segments: list[Segment]) -> Outcome:
    load_machine_code(simulation)
    began, failure = time.perf_counter(), rising_life(simulation, segments[0].inputs)
    worst, spent, blocks, stopped = _Worst(), 0.0, [simulation.sample.copy().reshape(1)], ""
    budget = simulation.scene.integration.step_budget
    for segment in segments[1:]:
        before, started = simulation.counters, time.process_time()
        try:
            blocks.append(simulation.advance(segment.duration, segment.inputs, _SAMPLES))
        except IntegrationError as error:
            if error.status == STEP_BUDGET:
                stopped = f"{budget} steps last for {simulation.time:.3g} s and less than {segment.duration:.3g} s more"
            else:
                failure = failure or str(error)
        core, after = time.process_time() - started, simulation.counters
        spent += core
        worst = worst.with_segment(segment.duration, before, after, core)
        if not stopped and after.steps + after.rejected_steps > budget:
            stopped = f"{budget} steps last for {simulation.time:.3g} s"
        failure = failure or impossible(blocks[-1], simulation.state)
        if time.perf_counter() - began > _PATIENCE:
            failure = failure or f"hang: {simulation.time:.3g} s simulated in {_PATIENCE:g} s"
        if failure or stopped:
            break
    samples = np.concatenate(blocks)
    failure = failure or unsteady_slip(samples, case.course)
    limits = limits_of(simulation)
    if stopped:
        if _asks_for_small_steps(simulation.scene):
            limits.append(f"step budget: {stopped}")
        else:
            failure = failure or f"too slow: {stopped}"
    status = FAILED if failure else (STEP_LIMITED if limits else FINISHED)
    counters = simulation.counters
    return Outcome(
        case, status, failure or ", ".join(limits), simulation.time, spent, counters.steps, counters.rejected_steps, counters.non_finite_steps,
        counters.right_hand_sides, counters.jacobians, *worst, _asks_for_small_steps(simulation.scene),
    )  # fmt: skip


def load_machine_code(simulation: Simulation) -> None:
    """Advance by a billionth of a second, so that loading is not counted in a segment."""
    try:
        simulation.advance(1e-9)
    except IntegrationError:
        pass  # the run reports it


class _Worst(NamedTuple):
    """The most expensive segment so far, by each measure."""

    steps_per_ms: float = 0.0
    right_hand_sides_per_ms: float = 0.0
    core_ms_per_ms: float = 0.0
    step_us: float = 0.0

    def with_segment(self, duration, before, after, core):
        steps = after.steps + after.rejected_steps - before.steps - before.rejected_steps
        evaluated = after.right_hand_sides - before.right_hand_sides
        now = (1e-3 * steps / duration, 1e-3 * evaluated / duration, core / duration, 1e6 * core / max(steps, 1))
        # In a short segment the overhead of the call exceeds the cost of its steps.
        return _Worst(*map(max, self, now)) if duration >= _SEGMENT_TO_TIME else self


def _asks_for_small_steps(scene: Scene) -> bool:
    integration = scene.integration
    step = integration.maximum_step if integration.fixed_step is None else integration.fixed_step
    tolerances, tight = (tolerances_of(settings) for settings in (integration, _TIGHT))
    return any(given < bound for given, bound in zip(tolerances, tight)) or step < _TIGHT_STEP


def limits_of(simulation: Simulation) -> list[str]:
    """Return what limited the run apart from the equations."""
    divided = simulation.scene.integration.fixed_step is not None and simulation.counters.rejected_steps > 0
    limits = ["fixed step divided"] if divided else []
    limits += ["smallest step"] if simulation.counters.smallest_steps else []
    return limits + (["operating point without a steady state"] if simulation.counters.unsettled_points else [])
