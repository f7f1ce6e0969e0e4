# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One scene at the extremes: run it, and judge what came out."""

import math
import time
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bearing_sim.effects import level_of
from bearing_sim.integrators.status import STEP_BUDGET
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, load_scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.studies.extremes_scenes import Case
from bearing_sim.studies.stock_bearing import BEARING

FINISHED, CLAMPED, REFUSED, FAILED = OUTCOMES = ("finished", "clamped", "refused", "failed")
STEPS = 20_000  # allowed to one run whose settings ask for small steps
_PATIENT = 5  # times as many to one whose settings do not: what needs more, a step each 0.2 us of 20 ms, is too slow
_FEWEST_STEPS, _STOCK_SLICES = 2_000, 18 * 20  # of a run whose steps are dear, because it has more rollers times slices than this
_SHORTEST, _LONGEST, _PITCHES = 2e-3, 20e-3, 20.0  # simulated [s], and in roller pitches
_PATIENCE = 300.0  # s on the wall; what takes longer hangs
_LEGS = 12  # at least, of a run: inputs go straight within each
_SAMPLES = 4  # of a leg
_LEG_TO_TIME = 2e-5  # s; shorter legs are not asked what they cost
_STEP_LEG = 1e-6  # s, that a step of the load takes
_RIPPLE, _RIPPLE_LEGS = 1e3, 8  # Hz; legs of a period
# A run that uses up its steps is too slow by its own settings where these are tight, and by the model's fault where they are not.  Tight is what the
# bench takes for its references, a tenth of the usual tolerance or less.
_TIGHT_TOLERANCE, _TIGHT_STEP, _EXPLICIT = 1e-3, 1e-5, ("rk45",)
_LEAST_SLIP, _RISE_OF_LIFE = -0.05, 1.01
_RUNNING = 10.0  # rad/s of the shaft; slower, slip and losses are not judged
_NOT_TOLD = {"steady": ("roller_spin", "roller_rotation", "pocket_force")}  # by a level, which says NaN
_MAY_BE_INFINITE = ("rating_life", "lamina_life", "modified_rating_life")  # without load or at rest
# Those that cannot be gains at any instant, by the laws as they are: friction in the pockets goes by spin alone (Deng 2017, eq. 13), and
# the published torque of the guide land's film leaves out what its eccentric force turns.
_LOSSES = ("inner_sliding_power", "outer_sliding_power", "churning_power", "damping_power")
_FIRST_SHARES = (1e-3, 9e-3, 9e-2, 0.9)  # of the first leg: what is stuck is told from what is slow


class Outcome(NamedTuple):
    """What became of one case."""

    case: Case
    status: str  # one of OUTCOMES
    reason: str = ""  # what clamped it, why it was refused or failed
    simulated: float = 0.0  # [s]
    core_seconds: float = 0.0
    steps: int = 0
    rejected_steps: int = 0
    non_finite_steps: int = 0
    right_hand_sides: int = 0
    jacobians: int = 0
    steps_per_ms: float = 0.0  # in the leg that took most for its time
    right_hand_sides_per_ms: float = 0.0  # likewise
    core_ms_per_ms: float = 0.0  # likewise
    step_us: float = 0.0  # core time of a step, in the leg where steps took longest
    asks_for_small_steps: bool = False  # whether the case's own tolerance, step or method does


class Leg(NamedTuple):
    """A stretch of time at whose end the inputs have reached these values along straight lines."""

    duration: float  # [s]
    inputs: Inputs


def run_case(case: Case) -> Outcome:
    """Run one case; returns whatever happens."""
    try:
        scene = load_scene(BEARING, case.overrides)
        scene = load_scene(BEARING, [*case.overrides, f"integration.step_budget={_step_budget(scene)}"])
        legs = first_divided(list(course_legs(case.course, case.seconds or _seconds(scene), scene_inputs(scene))))
        simulation = Simulation(scene, legs[0].inputs)
    except SceneError as error:
        return Outcome(case, REFUSED, "; ".join(str(fault) for fault in error.faults))
    except Exception as error:
        return Outcome(case, FAILED, f"{type(error).__name__} at the start: {error}")
    try:
        return _run(case, simulation, legs)
    except Exception as error:
        return Outcome(case, FAILED, f"{type(error).__name__}: {error}", simulation.time)


def _step_budget(scene: Scene) -> int:
    slices = scene.bearing.roller.count * (scene.bearing.roller.slices if scene.level == "spatial" else 1)
    return max(_FEWEST_STEPS, round(STEPS * min(1.0, _STOCK_SLICES / slices))) * (1 if _asks_for_small_steps(scene) else _PATIENT)


def _seconds(scene: Scene) -> float:
    """Return how long to simulate: some roller pitches, and no longer than the budget lasts at the steps asked for."""
    integration, bearing = scene.integration, scene.bearing
    pitches = 2 * math.pi * _PITCHES / (bearing.roller.count * max(0.5 * abs(scene.operating.shaft_speed) * (1 - bearing.diameter_ratio), 1e-9))
    step = integration.maximum_step if integration.fixed_step is None else integration.fixed_step
    return min(max(_SHORTEST, min(pitches, _LONGEST)), 0.5 * _step_budget(scene) * step)


def course_legs(course: str, seconds: float, inputs: Inputs) -> Iterator[Leg]:
    """Yield the legs of a course; the first one, of no duration, says where it starts.

    Parameters
    ----------
    course : ``steady``; ``reversal`` of speed; ``stop`` and ``start`` with a rest; ``load_step`` there and back; ``ripple`` on the load.
    seconds : of the whole course.
    inputs : what it goes from or to.
    """

    def at(speed, load):
        return inputs._replace(shaft_speed=speed * inputs.shaft_speed, load_y=load * inputs.load_y, load_z=load * inputs.load_z)

    if course == "ripple":
        yield Leg(0.0, at(1.0, 1.0))
        duration = min(1.0 / (_RIPPLE * _RIPPLE_LEGS), seconds / _LEGS)
        for leg in range(1, round(seconds / duration) + 1):
            yield Leg(duration, at(1.0, 1.0 + 0.9 * math.sin(2 * math.pi * _RIPPLE * leg * duration)))
        return
    step = min(_STEP_LEG, 0.01 * seconds)
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
    yield Leg(0.0, at(*points[0][1:]))
    for (start, speed, load), (end, next_speed, next_load) in zip(points, points[1:]):
        pieces = max(1, math.ceil((end - start) * _LEGS - 1e-9))
        for piece in range(1, pieces + 1):
            share = piece / pieces
            yield Leg((end - start) * seconds / pieces, at(speed + share * (next_speed - speed), load + share * (next_load - load)))


def first_divided(legs: list[Leg]) -> list[Leg]:
    """Return the legs with the first stretch of time cut into ever longer pieces."""
    start, first, *rest = legs
    pieces, passed = [], 0.0
    for share in _FIRST_SHARES:
        passed += share
        between = Inputs(*(a + passed * (b - a) for a, b in zip(start.inputs, first.inputs)))
        pieces.append(Leg(share * first.duration, between))
    return [start, *pieces, *rest]


def _run(case: Case, simulation: Simulation, legs: list[Leg]) -> Outcome:
    _load_machine_code(simulation)
    began, fault = time.perf_counter(), _rising_life(simulation, legs[0].inputs)
    worst, spent, blocks, stopped = _Worst(), 0.0, [simulation.sample.copy().reshape(1)], ""
    budget = simulation.scene.integration.step_budget
    for leg in legs[1:]:
        before, started = simulation.counters, time.process_time()
        try:
            blocks.append(simulation.advance(leg.duration, leg.inputs, _SAMPLES))
        except IntegrationError as error:
            if error.status == STEP_BUDGET:
                stopped = f"{budget} steps last for {simulation.time:.3g} s and less than {leg.duration:.3g} s more"
            else:
                fault = fault or str(error)
        core, after = time.process_time() - started, simulation.counters
        spent += core
        worst = worst.with_leg(leg.duration, before, after, core)
        if not stopped and after.steps + after.rejected_steps > budget:
            stopped = f"{budget} steps last for {simulation.time:.3g} s"
        fault = fault or _impossible(blocks[-1], simulation.state)
        if time.perf_counter() - began > _PATIENCE:
            fault = fault or f"hang: {simulation.time:.3g} s simulated in {_PATIENCE:g} s"
        if fault or stopped:
            break
    samples = np.concatenate(blocks)
    fault = fault or _unsteady_slip(samples, case.course)
    clamps = _clamps(simulation)
    if stopped:
        if _asks_for_small_steps(simulation.scene):
            clamps.append(f"step budget: {stopped}")
        else:
            fault = fault or f"too slow: {stopped}"
    status = FAILED if fault else (CLAMPED if clamps else FINISHED)
    counters = simulation.counters
    return Outcome(
        case, status, fault or ", ".join(clamps), simulation.time, spent, counters.steps, counters.rejected_steps, counters.non_finite_steps,
        counters.right_hand_sides, counters.jacobians, *worst, _asks_for_small_steps(simulation.scene),
    )  # fmt: skip


def _load_machine_code(simulation: Simulation) -> None:
    """Go a billionth of a second, so that no leg is charged with it."""
    try:
        simulation.advance(1e-9)
    except IntegrationError:
        pass  # the run will say so, too


class _Worst(NamedTuple):
    """The dearest leg so far, by each measure."""

    steps_per_ms: float = 0.0
    right_hand_sides_per_ms: float = 0.0
    core_ms_per_ms: float = 0.0
    step_us: float = 0.0

    def with_leg(self, duration, before, after, core):
        steps = after.steps + after.rejected_steps - before.steps - before.rejected_steps
        evaluated = after.right_hand_sides - before.right_hand_sides
        now = (1e-3 * steps / duration, 1e-3 * evaluated / duration, core / duration, 1e6 * core / max(steps, 1))
        # What a call costs besides its steps counts in a short leg more than they do.
        return _Worst(*map(max, self, now)) if duration >= _LEG_TO_TIME else self


def _asks_for_small_steps(scene: Scene) -> bool:
    integration = scene.integration
    step = integration.maximum_step if integration.fixed_step is None else integration.fixed_step
    return integration.relative_tolerance < _TIGHT_TOLERANCE or step < _TIGHT_STEP or integration.method in _EXPLICIT


def _rising_life(simulation: Simulation, inputs: Inputs) -> str:
    """Return a fault where the life at the start rises with load; the simulation is at its start again after that."""
    lives = []
    for factor in (0.5, 1.0, 2.0):
        simulation.reset(inputs._replace(load_y=factor * inputs.load_y, load_z=factor * inputs.load_z))
        lives.append(float(simulation.sample["rating_life"]))
    simulation.reset(inputs)
    if any(later > _RISE_OF_LIFE * life for life, later in zip(lives, lives[1:])):
        return f"life rises with load: {', '.join(f'{life:.6g}' for life in lives)} h at 0.5, 1 and 2 times the load"
    return ""


def _impossible(block: np.ndarray, state: np.ndarray) -> str:
    """Return what no bearing can do in some samples, in words."""
    if not np.isfinite(state).all():
        return "the state is not finite"
    turning = np.abs(block["shaft_speed"]) >= _RUNNING
    for name in block.dtype.names:
        values = block[name]
        if name in _NOT_TOLD.get(level_of(block[0]), ()):
            continue
        if name == "cage_slip":
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
    """Return a fault where a steady shaft is overtaken by its cage, or turns it backwards, in the mean of the second half."""
    later = samples[len(samples) // 2 :]
    if course != "steady" or abs(later["shaft_speed"][0]) < _RUNNING:
        return ""
    slip = float(later["cage_slip"].mean())
    return "" if _LEAST_SLIP <= slip <= 1.0 - _LEAST_SLIP else f"cage slip {100 * slip:.4g} % in steady drive"


def _clamps(simulation: Simulation) -> list[str]:
    """Return what kept the run within bounds that the equations do not have."""
    divided = simulation.scene.integration.fixed_step is not None and simulation.counters.rejected_steps > 0
    clamps = ["fixed step divided"] if divided else []
    clamps += ["smallest step"] if simulation.counters.smallest_steps else []
    return clamps + (["operating point without a steady state"] if simulation.counters.unsettled_points else [])
