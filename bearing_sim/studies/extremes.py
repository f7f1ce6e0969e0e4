# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The stability map: scenes at the extremes of all inputs, run on all cores.

A case is *finished*; *step-limited*, if it ran well but something other than the equations limited it
(a fixed step that had to be divided, the study's budget of steps where the case's own settings ask for so many: a tolerance or
a step); *refused*, by the scene's checks before it starts; or *failed*: not finite, an exception, a process that
died, a hang, too slow without settings that explain it, or a physically impossible value.
"""

import math
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.model.sample import NODE_OBSERVABLES, RING_TEMPERATURES
from bearing_sim.numerics.cores import cores
from bearing_sim.numerics.time_stepping import STEP_BUDGET
from bearing_sim.scene.fidelity import level_of
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Integration, Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs, tolerances_of
from bearing_sim.studies.extremes_cases import BEARING, Case, corner_cases, sampled_cases
from bearing_sim.sweep.point import LIVES
from bearing_sim.sweep.table import new_figure
from bearing_sim.sweep.tasks import Journal, run_tasks, task

FINISHED, STEP_LIMITED, REFUSED, FAILED = OUTCOMES = ("finished", "step_limited", "refused", "failed")
STEPS = 20_000  # budget of a run whose settings require small steps
_PATIENT = 5  # times as many for other runs; needing more, one step per 0.2 us of 20 ms, is too slow
_FEWEST_STEPS, _STOCK_SLICES = 2_000, 18 * 20  # of a run with expensive steps, with more rollers times slices than this
_SHORTEST, _LONGEST, _PITCHES = 2e-3, 20e-3, 20.0  # simulated [s], and in roller pitches
_PATIENCE = 300.0  # s of wall time; a longer run counts as a hang
_SEGMENTS = 12  # of a run, at least; inputs are linear within each
_SAMPLES = 4  # per segment
_SEGMENT_TO_TIME = 2e-5  # s; the cost of shorter segments is ignored
_STEP_SEGMENT = 1e-6  # s, duration of a step of the load
_RIPPLE, _RIPPLE_SEGMENTS = 1e3, 8  # Hz; segments per period
# A run that exhausts its steps is step-limited if its settings are tight, and too slow otherwise.  Tight settings are those of the references of the
# bench: a tenth of the default tolerance or less.
_TIGHT, _TIGHT_STEP = Integration().with_tolerances(0.1), 1e-5
_LEAST_SLIP, _RISE_OF_LIFE = -0.05, 1.01
_RUNNING = 10.0  # rad/s of the shaft, below which slip and losses are not judged
_NOT_COMPUTED = {"steady": ("roller_spin", "roller_rotation", "pocket_force")}  # NaN at these levels
_NOT_IN_EVERY_SCENE = (
    "contamination_factor",  # NaN without a cleanliness class
    *(f"{name}_{kind}" for name in RING_TEMPERATURES for kind in ("measured", "uncorrected")),
    *(*NODE_OBSERVABLES, "heat_to_oil", "heat_to_ambient"),  # NaN without a law of heat
)
_MAY_BE_INFINITE = (*LIVES, "static_safety")  # without load or at rest
# Losses that cannot be negative at any instant by their laws.  Pocket friction follows spin alone (Deng 2017, eq. 13), and the published
# torque of the guide land's film omits the power of its eccentric force; both may be negative.
_LOSSES = (
    "inner_sliding_power",
    "outer_sliding_power",
    "inner_rolling_power",
    "outer_rolling_power",
    "churning_power",
    "damping_power",
    "seal_power",
)
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


class Segment(NamedTuple):
    """A segment of time over which the inputs change linearly to these values."""

    duration: float  # [s]
    inputs: Inputs


def case_result(case: Case) -> dict:
    """Return the fields of the outcome of one case, without the case."""
    fields = run_case(case)._asdict()
    del fields["case"]
    return fields


def run_case(case: Case) -> Outcome:
    """Run one case; any error becomes an outcome."""
    try:
        scene = load_scene(BEARING, case.overrides)
        scene = load_scene(BEARING, [*case.overrides, f"integration.step_budget={_step_budget(scene)}"])
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
    slices = scene.bearing.roller.count * (scene.bearing.roller.slices if scene.level == "spatial" else 1)
    return max(_FEWEST_STEPS, round(STEPS * min(1.0, _STOCK_SLICES / slices))) * (1 if _asks_for_small_steps(scene) else _PATIENT)


def _seconds(scene: Scene) -> float:
    """Return the time to simulate: some roller pitches, but no more than the step budget allows at the required steps."""
    integration, bearing = scene.integration, scene.bearing
    pitches = 2 * math.pi * _PITCHES / (bearing.roller.count * max(0.5 * abs(scene.operating.shaft_speed) * (1 - bearing.diameter_ratio), 1e-9))
    step = integration.maximum_step if integration.fixed_step is None else integration.fixed_step
    return min(max(_SHORTEST, min(pitches, _LONGEST)), 0.5 * _step_budget(scene) * step)


def course_segments(course: str, seconds: float, inputs: Inputs) -> Iterator[Segment]:
    """Yield the segments of a course; the first one, of zero duration, gives the start.

    Parameters
    ----------
    course : ``steady``; ``reversal`` of speed; ``stop`` and ``start`` with a rest; ``load_step`` there and back; ``ripple`` on the load.
    seconds : duration of the course.
    inputs : from which or to which it leads.
    """

    def at(speed, load):
        return inputs._replace(shaft_speed=speed * inputs.shaft_speed, load_y=load * inputs.load_y, load_z=load * inputs.load_z)

    if course == "ripple":
        yield Segment(0.0, at(1.0, 1.0))
        duration = min(1.0 / (_RIPPLE * _RIPPLE_SEGMENTS), seconds / _SEGMENTS)
        for number in range(1, round(seconds / duration) + 1):
            yield Segment(duration, at(1.0, 1.0 + 0.9 * math.sin(2 * math.pi * _RIPPLE * number * duration)))
        return
    step = min(_STEP_SEGMENT, 0.01 * seconds)
    points = {
        "steady": [(0.0, 1.0, 1.0), (1.0, 1.0, 1.0)],
        "reversal": [(0.0, 1.0, 1.0), (0.25, 1.0, 1.0), (0.75, -1.0, 1.0), (1.0, -1.0, 1.0)],
        "stop": [(0.0, 1.0, 1.0), (0.25, 1.0, 1.0), (0.5, 0.0, 1.0), (1.0, 0.0, 1.0)],
        "start": [(0.0, 0.0, 1.0), (0.25, 0.0, 1.0), (0.75, 1.0, 1.0), (1.0, 1.0, 1.0)],
        "load_step": [
            (0.0, 1.0, 0.0),
            (0.3, 1.0, 0.0),
            (0.3 + step / seconds, 1.0, 1.0),
            (0.7, 1.0, 1.0),
            (0.7 + step / seconds, 1.0, 0.0),
            (1.0, 1.0, 0.0),
        ],
    }[course]
    yield Segment(0.0, at(*points[0][1:]))
    for (start, speed, load), (end, next_speed, next_load) in zip(points, points[1:]):
        pieces = max(1, math.ceil((end - start) * _SEGMENTS - 1e-9))
        for piece in range(1, pieces + 1):
            done = piece / pieces
            yield Segment((end - start) * seconds / pieces, at(speed + done * (next_speed - speed), load + done * (next_load - load)))


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
    _load_machine_code(simulation)
    began, failure = time.perf_counter(), _rising_life(simulation, segments[0].inputs)
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
        failure = failure or _impossible(blocks[-1], simulation.state)
        if time.perf_counter() - began > _PATIENCE:
            failure = failure or f"hang: {simulation.time:.3g} s simulated in {_PATIENCE:g} s"
        if failure or stopped:
            break
    samples = np.concatenate(blocks)
    failure = failure or _unsteady_slip(samples, case.course)
    limits = _limits(simulation)
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


def _load_machine_code(simulation: Simulation) -> None:
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


def _rising_life(simulation: Simulation, inputs: Inputs) -> str:
    """Return an error message if the life at the start rises with load; the simulation is reset afterwards."""
    lives = []
    for factor in (0.5, 1.0, 2.0):
        simulation.reset(inputs._replace(load_y=factor * inputs.load_y, load_z=factor * inputs.load_z))
        lives.append(float(simulation.sample["rating_life"]))
    simulation.reset(inputs)
    if any(later > _RISE_OF_LIFE * life for life, later in zip(lives, lives[1:])):
        return f"life rises with load: {', '.join(f'{life:.6g}' for life in lives)} h at 0.5, 1 and 2 times the load"
    return ""


def _impossible(block: np.ndarray, state: np.ndarray) -> str:
    """Return an error message for physically impossible samples."""
    if not np.isfinite(state).all():
        return "the state is not finite"
    turning = np.abs(block["shaft_speed"]) >= _RUNNING
    for name in block.dtype.names:
        values = block[name]
        if name in (*_NOT_COMPUTED.get(level_of(block[0]), ()), *_NOT_IN_EVERY_SCENE):
            continue
        if name in ("cage_slip", "friction_moment"):  # NaN at rest
            values = values[turning]
        good = ~np.isnan(values) & (values > 0.0) if name in _MAY_BE_INFINITE else np.isfinite(values)
        if not good.all():
            return f"{name} = {values[~good].flat[0]}"
    for name in ("inner_load", "outer_load"):
        if (block[name] < 0.0).any():
            return f"{name} = {block[name].min():.6g} N pulls"
    scale = 1.0 + np.abs(block["shaft_power"])
    for name in _LOSSES:
        if (turning & (block[name] < -1e-6 * scale)).any():
            return f"{name} = {block[name].min():.6g} W is a gain"
    return ""


def _unsteady_slip(samples: np.ndarray, course: str) -> str:
    """Return an error message if, at steady speed, the cage overtakes the shaft or turns backwards in the second half of the run."""
    later = samples[len(samples) // 2 :]
    if course != "steady" or abs(later["shaft_speed"][0]) < _RUNNING:
        return ""
    slip = float(later["cage_slip"].mean())
    return "" if _LEAST_SLIP <= slip <= 1.0 - _LEAST_SLIP else f"cage slip {100 * slip:.4g} % in steady drive"


def _limits(simulation: Simulation) -> list[str]:
    """Return what limited the run apart from the equations."""
    divided = simulation.scene.integration.fixed_step is not None and simulation.counters.rejected_steps > 0
    limits = ["fixed step divided"] if divided else []
    limits += ["smallest step"] if simulation.counters.smallest_steps else []
    return limits + (["operating point without a steady state"] if simulation.counters.unsettled_points else [])


# Simulated seconds at 15,000 rpm.
_SECONDS = {"steady": 1000.0, "slip": 1000.0, "planar": 100.0, "spatial": 10.0}
_SPEED = 15_000.0  # rpm
_SAMPLES_PER_SECOND, _BLOCK = 200, 100
_WINDOWS = 10  # of the run that are compared
_LARGEST_DRIFT = {"shaft_angle_error": 1e-9, "slip_drift": 1e-3, "damage_drift": 0.01, "energy_drift": 0.01, "cage_angle_error": 1e-3}


class LongRun(NamedTuple):
    """Results of a long run at constant conditions.

    Each drift compares the last tenth of the run with the second one, after settling: slip in absolute numbers, damage rate and
    power balance relative.  Angles: of the shaft against speed times time, of the cage against its mean sampled speed.
    """

    level: str
    speed_rpm: float
    simulated: float = 0.0
    core_seconds: float = 0.0
    real_time_factor: float = math.nan
    steps: int = 0
    rejected_steps: int = 0
    cage_slip: float = math.nan
    slip_drift: float = math.nan
    damage_drift: float = math.nan
    energy_drift: float = math.nan
    shaft_angle_error: float = math.nan
    cage_angle_error: float = math.nan
    failure: str = ""  # empty if the run was good


def long_run_result(level: str, seconds: float) -> dict:
    """Return the fields of `long_run`."""
    return long_run(level, seconds)._asdict()


def long_run(level: str, seconds: float) -> LongRun:
    """Make one long run of ``seconds`` of simulated time."""
    simulation = Simulation(load_scene(BEARING, [f"level={level}", f"operating.shaft_speed={_SPEED} rpm"]))
    windows, failure = [], ""
    began = time.process_time()
    for _ in range(_WINDOWS):
        try:
            windows.append(_window(simulation, seconds / _WINDOWS))
        except IntegrationError as error:
            failure = str(error)
            break
    core, counters = time.process_time() - began, simulation.counters
    if failure:
        done = (core, simulation.time / core, counters.steps, counters.rejected_steps)
        return LongRun(level, _SPEED, simulation.time, *done, failure=failure)
    means = np.array(windows)
    early, late, last = means[1], means[-1], simulation.sample
    slip, damage, surplus = (late - early)[:3] / (1.0, early[1], early[3])
    turned = float(means[:, 4].sum())
    drifts = {
        "slip_drift": float(slip),
        "damage_drift": float(damage),
        "energy_drift": float(surplus),
        "shaft_angle_error": float(last["shaft_angle"] / (_SPEED * math.pi / 30 * seconds) - 1.0),
        "cage_angle_error": float(last["cage_angle"] / turned - 1.0),
    }
    beyond = [f"{name} {value:.3g}" for name, value in drifts.items() if not abs(value) <= _LARGEST_DRIFT[name]]
    return LongRun(
        level, _SPEED, simulation.time, core, seconds / core, counters.steps, counters.rejected_steps, float(late[0]), **drifts,
        failure=f"drift: {', '.join(beyond)}" if beyond else "",
    )  # fmt: skip


def _window(simulation: Simulation, seconds: float) -> tuple[float, ...]:
    """Advance; return mean slip, damage rate [1/s], input minus losses [W], input [W], and the cage's rotation from its sampled speed [rad]."""
    samples = round(seconds * _SAMPLES_PER_SECOND)
    damage, slip, surplus, shaft, turn = float(simulation.sample["damage"]), 0.0, 0.0, 0.0, 0.0
    for first in range(0, samples, _BLOCK):
        count = min(_BLOCK, samples - first)
        block = simulation.advance(count / _SAMPLES_PER_SECOND, samples=count)
        losses = sum(block[name] for name in block.dtype.names if name.endswith("_power") and name != "shaft_power")
        slip += float(block["cage_slip"].sum()) / samples
        shaft += float(block["shaft_power"].sum()) / samples
        surplus += float((block["shaft_power"] - losses).sum()) / samples
        turn += float(block["cage_speed"].sum()) / _SAMPLES_PER_SECOND
    return slip, (float(simulation.sample["damage"]) - damage) / seconds, surplus, shaft, turn


# The field in an error message: at its start, or after the name of the record.
_NAMED = re.compile(r"(?:(?<=^)|(?<=; )|(?<=bearing: )|(?<=scene: ))([a-z_]+(?:\.[a-z_0-9]+)*)(?: = [^:;]*)?(?=: )")
_COSTS = ("steps_per_ms", "right_hand_sides_per_ms", "core_ms_per_ms", "step_us")


def run_extremes(
    samples: int,
    levels: Sequence[str] = (),
    seed: int = 0,
    long: bool = True,
    announce: Callable[[str], None] = lambda text: None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> tuple[dict, list[Outcome]]:
    """Run the study.

    Parameters
    ----------
    samples : scenes of the Latin hypercube for each level, in addition to the corners.
    levels : to study; empty: all.
    seed : of the hypercube.
    long : whether to include the long runs.
    announce : called with a line of text before the start.
    progress : called with the finished fraction of the cases.

    Returns
    -------
    report : plain numbers, strings, lists and dicts.
    outcomes : of all cases.
    """
    levels = tuple(levels) or tuple(LEVELS)
    cases = [case for level in levels for case in corner_cases(level) + sampled_cases(level, samples, seed)]
    long_levels = levels if long else ()
    tasks = [task(_compiled_for(case), case_result, case) for case in cases]
    tasks += [task(level, long_run_result, level, _SECONDS[level]) for level in long_levels]
    announce(f"{len(cases)} scenes, {len(long_levels)} long runs")
    results = run_tasks(tasks, Journal(), progress=lambda done, total: progress(done / total))
    outcomes = [Outcome(**{"case": case} | result) for case, result in zip(cases, results)]
    long_outcomes = [_long_outcome(level, result) for level, result in zip(long_levels, results[len(cases) :])]
    return _report(levels, samples, seed, outcomes, long_outcomes), outcomes


def _compiled_for(case: Case) -> str:
    """Return which machine code a case needs: that of its level, with error control or with a fixed step."""
    fixed = any(override.startswith("integration.fixed_step=") for override in case.overrides)
    return f"{case.level}, fixed step" if fixed else case.level


def _long_outcome(level: str, result: dict) -> LongRun:
    """Return a long run from its result; that of a lost worker has only a reason."""
    return LongRun(**result) if "failure" in result else LongRun(level, _SPEED, failure=result["reason"])


def _report(levels, samples, seed, outcomes, long_outcomes) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "samples": samples,
        "seed": seed,
        "cores": cores(),
        "levels": {
            level: _level_report([o for o in outcomes if o.case.level == level], [run for run in long_outcomes if run.level == level])
            for level in levels
        },
    }


def _totals(outcomes, long_outcomes) -> dict[str, int]:
    counts = {status: sum(outcome.status == status for outcome in outcomes) for status in OUTCOMES}
    for run in long_outcomes:
        counts[FAILED if run.failure else FINISHED] += 1
    return counts


def _level_report(outcomes: Sequence[Outcome], long_outcomes: Sequence[LongRun]) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "step_limited_by": _counted(outcomes, STEP_LIMITED),
        "refused_by": _counted(outcomes, REFUSED),
        "failures": [{"case": o.case.name, "reason": o.reason, "overrides": list(o.case.overrides)} for o in outcomes if o.status == FAILED],
        "worst": _worst(outcomes),
        "worst_by_the_model": _worst([outcome for outcome in outcomes if not outcome.asks_for_small_steps]),
        "core_seconds": sum(outcome.core_seconds for outcome in outcomes),
        "non_finite_steps": sum(outcome.non_finite_steps for outcome in outcomes),
        "long_runs": [run._asdict() for run in long_outcomes],
        "corners": [
            {"name": o.case.name, "outcome": o.status, "reason": o.reason, **{name: getattr(o, name) for name in ("simulated", "steps", *_COSTS)}}
            for o in outcomes
            if not o.case.name.startswith("sample ")
        ],
    }


def _worst(outcomes: Sequence[Outcome]) -> dict[str, dict]:
    """Return the most expensive case by each measure of cost."""
    costliest = {name: max(outcomes, key=lambda outcome: getattr(outcome, name), default=None) for name in _COSTS}
    return {name: {"case": found.case.name, "value": getattr(found, name)} for name, found in costliest.items() if found is not None}


def _counted(outcomes: Sequence[Outcome], status: str) -> dict[str, int]:
    """Count the reasons of one outcome without their numbers, most frequent first."""
    counts = Counter(reason for outcome in outcomes if outcome.status == status for reason in kinds_of_reason(outcome.reason))
    return dict(counts.most_common())


def kinds_of_reason(reason: str) -> list[str]:
    """Return the fields named in a refusal, or the limits of a step-limited run, without numbers."""
    named = [name for name in _NAMED.findall(reason) if name not in ("bearing", "scene")]
    return list(dict.fromkeys(named or [part.split(":")[0] for part in reason.split(", ")]))


# Okabe and Ito's colours, safe for colour-blind readers; markers repeat the information.
_LOOKS = {
    FINISHED: {"color": "#0072B2", "marker": "o", "s": 9, "alpha": 0.6, "linewidths": 0},
    STEP_LIMITED: {"color": "#E69F00", "marker": "s", "s": 14, "alpha": 0.85, "linewidths": 0},
    REFUSED: {"color": "#7a7a7a", "marker": "x", "s": 16, "alpha": 0.9, "linewidths": 0.9},
    FAILED: {"color": "#D55E00", "marker": "*", "s": 130, "edgecolors": "black", "linewidths": 0.6, "zorder": 5},
}
# x, factor, label, scale; y, factor, label, scale
_VIEWS = (
    (("shaft_speed_rpm", 1e-3, "shaft speed [1000 rpm]", "linear"), ("radial_load", 1e-3, "radial load [kN]", "symlog")),
    (("clearance", 1e6, "clearance at low points [µm]", "symlog"), ("rollers", 1.0, "rollers", "linear")),
    (("pocket_clearance", 1e6, "pocket clearance [µm]", "log"), ("guide_clearance", 1e6, "guide clearance [µm]", "log")),
    (("tolerances", 1.0, "tolerances over the default ones", "log"), ("step", 1e6, "longest or fixed step [µs]", "log")),
)
_LINEAR_TO = {"radial_load": 0.1, "clearance": 10.0}  # of a symlog axis, in its unit


def draw(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    levels = list(dict.fromkeys(outcome.case.level for outcome in outcomes))
    figure = new_figure(15, 0.9 + 3.5 * len(levels))
    grid = figure.subplots(len(levels), len(_VIEWS), squeeze=False)
    for row, level in zip(grid, levels):
        ours = [outcome for outcome in outcomes if outcome.case.level == level]
        sampled = [outcome for outcome in ours if "shaft_speed_rpm" in outcome.case.point]
        for axes, (x, y) in zip(row, _VIEWS):
            _draw_view(axes, sampled, x, y)
        row[0].set_title(f"level {level}: {_counts(sampled)}\ncorners: {_counts([o for o in ours if o not in sampled])}", loc="left", fontsize=10)
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), frameon=False, markerscale=1.3)
    figure.suptitle("Stability map: scenes at the extremes by Latin hypercube", x=0.01, ha="left")
    figure.savefig(path, dpi=110)


def _counts(outcomes: Sequence[Outcome]) -> str:
    return ", ".join(f"{sum(outcome.status == status for outcome in outcomes)} {_shown(status)}" for status in _LOOKS)


def _shown(status: str) -> str:
    return status.replace("_", "-")


def _draw_view(axes, outcomes, x, y) -> None:
    for status, look in _LOOKS.items():
        points = [outcome.case.point for outcome in outcomes if outcome.status == status]
        axes.scatter([x[1] * point[x[0]] for point in points], [y[1] * point[y[0]] for point in points], label=_shown(status), **look)
    for name, (field, _, label, scale) in (("x", x), ("y", y)):
        options = {"linthresh": _LINEAR_TO[field]} if scale == "symlog" else {}
        axes.set(**{f"{name}label": label})
        getattr(axes, f"set_{name}scale")(scale, **options)
    axes.tick_params(labelsize=9)
    axes.grid(color="#e6e6e6", lw=0.6)
    axes.set_axisbelow(True)


_COUNTED = tuple(name for name in Outcome._fields if name != "case")


def table_rows(outcomes: Sequence[Outcome]) -> list[dict[str, str]]:
    """Return a row per case: its parameters, outcome, cost, and the overrides that reproduce it."""
    dimensions = list(dict.fromkeys(name for outcome in outcomes for name in outcome.case.point))
    return [
        {"level": outcome.case.level, "case": outcome.case.name}
        | {name: _text(getattr(outcome, name)) for name in _COUNTED}
        | {name: _text(outcome.case.point.get(name, "")) for name in dimensions}
        | {"overrides": " ".join(f"--set '{override}'" for override in outcome.case.overrides)}
        for outcome in outcomes
    ]


def _text(value) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
