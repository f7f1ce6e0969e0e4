# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One scene at the extremes: what comes of it, and whether its books of energy close.

The case runs for at least 50 turns of its cage, or until it has settled.  Its inputs change once over what are 50 turns of an ideal cage;
under the last ones it continues until it settles or its cage has turned often enough, however long a cage that hardly turns takes for it.  Only the
core time is bounded; a run that has used it up is step-limited.  Then follow the books of energy: over ten more turns, under constant
inputs, what the shaft and the load put in, less what is lost and what is stored.
"""

import math
import time
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from bearing_sim.model.sample import NODE_OBSERVABLES, RING_TEMPERATURES, joined
from bearing_sim.scene.fidelity import level_of
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import STEP_BUDGET, Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.sweep.point import LIVES
from bearing_sim.sweep.settling import SHORTEST_TURNS, advance_until_settled, cage_turn, sampled

TURNS = 50.0  # of the cage in a run that does not settle
BOOK_TURNS = 10.0  # of an ideal cage over which the books of energy are kept
_BOOK_SAMPLES, _BATCHES = {"steady": 100, "slip": 1000, "planar": 4000, "spatial": 1000}, 10
_SHORTEST = 20e-3  # s of any run
_LONGEST_RIPPLE = 0.2  # s; the load stays after that
_SAMPLES, _SAMPLES_OF_A_TURN = 24, 60  # of a segment in which inputs change; of a turn under constant ones
_LONGEST_SOLVED_RIPPLE, _SOLVED_SAMPLES = 5e-3, 2  # the same at level steady, which solves for an operating point at every sample
_SAMPLES_OF_A_PIECE, _KEPT = 900, 2000  # between two looks at the turns; about the most of a stretch that are kept
_MEAN_SPEED = {"steady": 1.0, "load_step": 1.0, "ripple": 1.0, "reversal": 0.75, "start": 0.5, "stop": 0.375}  # over a course, of the full one
PATIENCE = 1800.0  # s of core time of a run
FINISHED, STEP_LIMITED, REFUSED, FAILED = OUTCOMES = ("finished", "step_limited", "refused", "failed")
COURSES = ("steady", "steady", "reversal", "stop", "start", "load_step", "ripple")  # of the inputs; steady ones twice as often

_SEGMENTS = 12  # of a run, at least; inputs are linear within each
_STEP_SEGMENT = 1e-6  # s, duration of a step of the load
_RIPPLE, _RIPPLE_SEGMENTS = 1e3, 8  # Hz; segments per period
_LEAST_SLIP, _RISE_OF_LIFE = -0.05, 1.01
_LONG_AFTER = 1e6  # s, after which the cage of level steady has reached its slip
_RUNNING = 10.0  # rad/s of the shaft, below which slip and losses are not judged
_NOT_COMPUTED = {"steady": ("roller_spin", "roller_rotation", "pocket_force")}  # NaN at these levels
_NOT_IN_EVERY_SCENE = (
    "contamination_factor",  # NaN without a cleanliness class
    "seat_arc",  # NaN of a rigid outer ring
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


class Case(NamedTuple):
    """One scene to run."""

    name: str
    level: str
    overrides: tuple[str, ...]
    course: str
    point: Mapping[str, float | str]  # of the map, by dimension
    seconds: float | None = None  # simulated; None: chosen by the study
    scene: str = "deng2017_table1"  # that the overrides change


class Segment(NamedTuple):
    """A segment of time over which the inputs change linearly to these values."""

    duration: float  # [s]
    inputs: Inputs


class StockOutcome(NamedTuple):
    """Outcome of one case."""

    case: Case
    status: str  # one of `OUTCOMES`
    reason: str = ""  # what limited it, or why it was refused or failed
    settled: bool = False  # whether slip and life rest under the last inputs
    turns: float = 0.0  # of the cage, in either direction
    simulated: float = 0.0  # [s]
    core_seconds: float = 0.0
    steps: int = 0
    rejected_steps: int = 0
    books: float = math.nan  # energy put in less energy lost and stored, over the larger of what is put in and lost; NaN at rest
    books_error: float = math.nan  # of that, because powers are known at samples only


class _Ended(Exception):
    """Ends a run with a status and a reason."""

    def __init__(self, status: str, reason: str):
        super().__init__(reason)
        self.status, self.reason = status, reason


class _TurnedEnough(Exception):
    """The cage has turned often enough, so that the run need not settle."""


def outcome_fields(case: Case) -> dict:
    """Return the fields of the outcome of one case, without the case."""
    fields = run_case(case)._asdict()
    del fields["case"]
    return fields


def run_case(case: Case) -> StockOutcome:
    """Run one case; any error becomes an outcome."""
    try:
        scene = load_scene(case.scene, case.overrides)
        inputs = scene_inputs(scene)
        segments = [] if case.course == "steady" else list(course_segments(case.course, _seconds(scene, case.course), inputs))
        simulation = Simulation(scene, segments[0].inputs if segments else inputs)
    except SceneError as error:
        return StockOutcome(case, REFUSED, "; ".join(str(each) for each in error.errors))
    except Exception as error:
        return StockOutcome(case, FAILED, f"{type(error).__name__} at the start: {error}")
    run = _Run(case, simulation)
    try:
        run.start()
        run.follow(segments[1:])
        run.go_on()
        books, error = run.books()
        return run.outcome(FINISHED, "", books, error)
    except _Ended as end:
        return run.outcome(end.status, end.reason)
    except Exception as error:
        return run.outcome(FAILED, f"{type(error).__name__}: {error}")


def _seconds(scene: Scene, course: str) -> float:
    """Return the time over which inputs change [s]: 50 turns of an ideal cage, less for a ripple."""
    turn = cage_turn(scene)
    seconds = max(TURNS * turn / _MEAN_SPEED[course], _SHORTEST) if math.isfinite(turn) else _SHORTEST
    return min(seconds, _LONGEST_SOLVED_RIPPLE if scene.level == "steady" else _LONGEST_RIPPLE) if course == "ripple" else seconds


class _Run:
    """A run of a case, and what has been seen of it."""

    def __init__(self, case: Case, simulation: Simulation):
        self._case, self._simulation = case, simulation
        self._began, self._turns, self._settled, self._blocks = time.process_time(), 0.0, False, []

    def start(self) -> None:
        """Judge the start."""
        failure = rising_life(self._simulation, self._simulation.inputs)
        if failure:
            raise _Ended(FAILED, failure)
        self._take(self._simulation.sample.copy().reshape(1))

    def follow(self, segments) -> None:
        """Follow the segments in which inputs change."""
        samples = 1 if self._case.course == "ripple" else _SOLVED_SAMPLES if self._case.level == "steady" else _SAMPLES
        for segment in segments:
            self._take(self._advance(segment.duration, segment.inputs, samples))

    def go_on(self) -> None:
        """Go on under constant inputs until the run settles or the cage has turned often enough."""
        turn = cage_turn(self._simulation.scene)
        stands = self._simulation.inputs.shaft_speed == 0.0
        shortest = _SHORTEST if stands else max(_SHORTEST, SHORTEST_TURNS * turn)
        spacing = min(turn / _SAMPLES_OF_A_TURN, shortest / 100)
        try:
            found = advance_until_settled(self._simulation, shortest, math.inf, lambda seconds: self._sampled(seconds, spacing))
            self._settled = stands or found.settled  # at rest the latter wants turns
        except _TurnedEnough:
            pass
        except IntegrationError as error:
            raise _ended(error) from None
        if self._case.course == "steady":
            failure = unsteady_slip(joined(self._blocks), self._case.course)
            if failure:
                raise _Ended(FAILED, failure)

    def books(self) -> tuple[float, float]:
        """Return what the books of energy miss over some more turns, and the error of that; see `StockOutcome`."""
        simulation = self._simulation
        if simulation.inputs.shaft_speed == 0.0:
            return math.nan, math.nan
        before = simulation.sample.copy().reshape(1)
        block = self._advance(BOOK_TURNS * cage_turn(simulation.scene), None, _BOOK_SAMPLES[self._case.level])
        self._take(block)
        return energy_gap(joined([before, block]), simulation)

    def outcome(self, status: str, reason: str, books: float = math.nan, books_error: float = math.nan) -> StockOutcome:
        """Return the outcome of the run as far as it came."""
        simulation, core = self._simulation, time.process_time() - self._began
        counters = simulation.counters
        if status == FINISHED and counters.unsettled_points:
            status, reason = STEP_LIMITED, "operating point without a steady state"
        elif status == FINISHED and counters.smallest_steps:
            status, reason = STEP_LIMITED, "smallest step"
        return StockOutcome(
            self._case, status, reason, self._settled, self._turns, simulation.time, core, counters.steps, counters.rejected_steps, books, books_error
        )

    def _advance(self, seconds: float, inputs: Inputs | None, samples: int) -> np.ndarray:
        try:
            return self._simulation.advance(seconds, inputs, samples)
        except IntegrationError as error:
            raise _ended(error) from None

    def _sampled(self, seconds: float, spacing: float) -> np.ndarray:
        """Advance piece by piece, so that a long stretch ends as soon as the cage has turned often enough, and return some of the samples."""
        pieces = math.ceil(seconds / (_SAMPLES_OF_A_PIECE * spacing))
        kept = []
        for _ in range(pieces):
            if self._turns >= TURNS:
                raise _TurnedEnough
            block = sampled(self._simulation, seconds / pieces, spacing)
            self._take(block)
            stride = math.ceil(pieces * len(block) / _KEPT)
            kept.append(block[(len(block) - 1) % stride :: stride].copy())
        return joined(kept)

    def _take(self, block: np.ndarray) -> None:
        """Take samples that follow, and end the run if they are impossible or its core time is used up."""
        angles = np.concatenate([self._blocks[-1]["cage_angle"][-1:], block["cage_angle"]] if self._blocks else [block["cage_angle"]])
        self._turns += float(np.abs(np.diff(angles)).sum()) / (2.0 * math.pi)
        self._blocks = [*self._blocks[-1:], block]
        failure = impossible(block, self._simulation.state)
        if failure:
            raise _Ended(FAILED, failure)
        if time.process_time() - self._began > PATIENCE:
            done = f"{self._simulation.time:.3g} s and {self._turns:.3g} turns of the cage, {self._simulation.counters.steps} steps"
            raise _Ended(STEP_LIMITED, f"core time: {PATIENCE:g} s last for {done}")


def _ended(error: IntegrationError) -> _Ended:
    return _Ended(STEP_LIMITED if error.status == STEP_BUDGET else FAILED, str(error))


def energy_gap(samples: np.ndarray, simulation: Simulation) -> tuple[float, float]:
    """Return the energy that the books of some samples miss, over the larger of what is put in and what is lost, and the error of that.

    The error is what every second sample would change, or the standard error of ten batches if that is larger.  At level steady, which stores
    nothing, only powers count.  Elsewhere the shaft and the load put in, the losses take, and the rest is stored as kinetic energy of cage and
    rollers along the orbit and as elastic energy of the contacts; of what else is stored, such as by the motion of the ring, little changes.

    Parameters
    ----------
    samples : evenly spaced, the first one at the start; shape (n,).
    simulation : that has made them.
    """
    missing, scale = _missing(samples, simulation)
    if scale == 0.0:
        return math.nan, math.nan
    coarse, coarse_scale = _missing(samples[(len(samples) - 1) % 2 :: 2], simulation)
    batches = np.array([part.sum() for part in np.array_split(missing, _BATCHES)])
    scatter = float(batches.std(ddof=1)) * math.sqrt(_BATCHES) / scale
    off = float(missing.sum()) / scale
    return off, max(scatter, abs(off - float(coarse.sum()) / coarse_scale))


def _missing(samples: np.ndarray, simulation: Simulation) -> tuple[np.ndarray, float]:
    """Return what the books miss between samples [J], shape (n - 1,), and the larger of what is put in and what is lost [J]."""
    seconds = np.diff(samples["time"])
    losses = sum(samples[name] for name in samples.dtype.names if name.endswith("_power") and name != "shaft_power")
    given, lost = (seconds * 0.5 * (power[1:] + power[:-1]) for power in (samples["shaft_power"], losses))
    missing = given - lost
    if simulation.scene.level != "steady":
        for axis in ("y", "z"):
            load = samples[f"load_{axis}"]
            missing += 0.5 * (load[1:] + load[:-1]) * np.diff(samples[f"ring_{axis}"])
        missing -= np.diff(_stored(samples, simulation))
    return missing, max(abs(float(given.sum())), abs(float(lost.sum())))


def _stored(samples: np.ndarray, simulation: Simulation) -> np.ndarray:
    """Return the kinetic energy of cage and rollers along the orbit and the elastic energy of the contacts [J], shape (n,)."""
    params = simulation._params
    rollers, stiffness = params.rollers, params.raceways.stiffness
    moving = 0.5 * rollers.mass * (samples["roller_radius"] * samples["orbital_speed"]) ** 2 + 0.5 * rollers.inertia * samples["roller_spin"] ** 2
    # 9/19 K d^(19/9) with Q = K d^(10/9)
    elastic = 9.0 / 19.0 * stiffness**-0.9 * (np.maximum(samples["inner_load"], 0.0) ** 1.9 + np.maximum(samples["outer_load"], 0.0) ** 1.9)
    return 0.5 * params.cage.inertia * samples["cage_speed"] ** 2 + (moving + elastic).sum(axis=1)


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


def rising_life(simulation: Simulation, inputs: Inputs) -> str:
    """Return an error message if the life at the start rises with load while the slip does not; the simulation is reset afterwards.

    A cage that more load brakes, by the friction in its pockets, slips more, and slower rollers press less on the outer raceway.
    """
    found = []
    for factor in (0.5, 1.0, 2.0):
        simulation.reset(inputs._replace(load_y=factor * inputs.load_y, load_z=factor * inputs.load_z))
        if simulation.scene.level == "steady":  # the cage goes to the slip that the life belongs to
            simulation.advance(_LONG_AFTER)
        found.append((float(simulation.sample["rating_life"]), float(simulation.sample["cage_slip"])))
    simulation.reset(inputs)
    if any(life > _RISE_OF_LIFE * before and not slip > slip_before for (before, slip_before), (life, slip) in zip(found, found[1:])):
        return f"life rises with load: {', '.join(f'{life:.6g}' for life, _ in found)} h at 0.5, 1 and 2 times the load"
    return ""


def impossible(block: np.ndarray, state: np.ndarray) -> str:
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


def unsteady_slip(samples: np.ndarray, course: str) -> str:
    """Return an error message if, at steady speed, the cage overtakes the shaft or turns backwards in the second half of the run."""
    later = samples[len(samples) // 2 :]
    if course != "steady" or abs(later["shaft_speed"][0]) < _RUNNING:
        return ""
    slip = float(later["cage_slip"].mean())
    return "" if _LEAST_SLIP <= slip <= 1.0 - _LEAST_SLIP else f"cage slip {100 * slip:.4g} % in steady drive"
