# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""When a run has settled: one criterion for ``bearing-sim run`` and for every point of a sweep, and the run that continues until it is met.

A bearing needs anything from milliseconds to minutes to settle, and nothing in its scene tells which.  What can be judged is whether the
last fifth of a run differs from the fifths before it by more than a tolerance, and whether these differences shrink.  A run is therefore
judged again and again, each time when it is half as long again: a drift that is slow beside one length of the run shows in a longer one.
The shortest run is bounded in seconds, because inertia has no other measure, and in cage turns, because everything that passes or whirls
repeats itself with them.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.model.sample import joined
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Counters, Simulation, start_sample

SHORTEST_TURNS = 15.0  # of an ideal cage in the shortest run: three in each window
LONGEST = 1000.0  # s of the longest run
LONGEST_TURNS = 2000.0  # of an ideal cage in the longest run, where these take longer
WINDOW = 0.2  # of a run; results are means over the last window, and two more before it show whether they still change
_GROWTH = 1.5  # length of a run over its length when it was judged before
_SLOWEST = 0.98  # largest ratio of successive changes that is taken as converging
_BATCHES = 8  # in a window
_SIGNIFICANT = 3.0  # standard errors of a change that is not chance
_INTERVALS = 256  # even intervals over which a wandering observable is described
_REPEATS = 0.6  # least autocorrelation of what is called an oscillation
_GROWS = 1.2  # ratio of successive means of the square of a motion from which on it grows
_SAMPLES = 1000  # of the shortest run: 200 in the last window
_KEPT = 1000  # at least, of longer stretches
_TOGETHER = 25  # samples of a call of the model
_MAXIMA = ("inner_load_maximum", "outer_load_maximum")  # observables of all that happened since the sample before
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # fraction of a pitch between samples that stays farthest from all small ratios
SETTLED, DRIFTING, LIMIT_CYCLE, WANDERING = "settled", "drifting", "limit cycle", "wandering"
TOO_SHORT, NO_STEADY_STATE = "too short", "no steady state"


class Tolerance(NamedTuple):
    """How much of a change still to come counts as none: ``absolute`` + ``relative`` x the value."""

    absolute: float
    relative: float


class Observed(NamedTuple):
    """What has to rest before a run counts as settled.

    Attributes
    ----------
    name : key of a result.
    label : name in a message.
    shown : value in SI -> the number that a message shows.
    unit : of that number.
    change_unit : of its changes, such as points.
    tolerance : see `Tolerance`.
    """

    name: str
    label: str
    shown: Callable[[float], float]
    unit: str
    change_unit: str
    tolerance: Tolerance


OBSERVED = (
    Observed("cage_slip", "cage slip", lambda slip: 100.0 * slip, "%", "points", Tolerance(5e-4, 0.0)),
    # An input at present, which does not change in a run under constant conditions; no level has a heat balance.
    Observed("oil_temperature", "oil temperature", lambda kelvin: kelvin - 273.15, "degC", "K", Tolerance(0.1, 0.0)),
    # Damage adds up, so life is averaged by its inverse, which is 0 and rests without load or rotation.
    Observed("rating_life", "rating life", lambda rate: 1.0 / rate if rate else math.inf, "h", "h", Tolerance(0.0, 0.02)),
)
TOLERANCES = tuple(each.tolerance for each in OBSERVED)
GROWING = ("the tilt of the cage", "the whirl of the cage", "the largest roller load")
"""Motions whose squares stand behind the columns of `OBSERVED` in the course of a run: what grows changes everything else later."""


class Trend(NamedTuple):
    """What one observable does at the end of a run, in SI.

    Attributes
    ----------
    mean : over the last window.
    uncertainty : two standard errors of it.
    remaining : estimate of the change still to come; 0 where the changes so far are not larger than chance makes them.
    allowed : largest uncertainty and largest remaining change that count as rest.
    """

    mean: float
    uncertainty: float
    remaining: float
    allowed: float

    @property
    def rests(self) -> bool:
        """Whether the mean is known and no change is to come; true where there is nothing to observe, such as slip at rest."""
        return not (abs(self.remaining) > self.allowed or self.uncertainty > self.allowed)


class Course:
    """Observables over time as integrals from the start, whose differences are exact means over any span.

    Attributes
    ----------
    times : instants [s], shape (n,), increasing, the first that of the start.
    turns : of the cage since the start, shape (n,).
    integrals : over time from the start, shape (n, m).
    """

    def __init__(self, times, turns, integrals):
        self.times, self.turns, self.integrals = np.asarray(times, float), np.asarray(turns, float), np.asarray(integrals, float)

    def until(self, end: float) -> "Course":
        """Return the part up to an instant [s]."""
        count = int(np.searchsorted(self.times, end, side="right"))
        return Course(self.times[:count], self.turns[:count], self.integrals[:count])

    def edges(self) -> np.ndarray:
        """Return the instants [s] between which the last three windows lie, shape (4,).

        Each window is a fifth of the course, cut to whole cage turns where it holds any.
        """
        start, end = self.times[0], self.times[-1]
        edges, length = [end], WINDOW * (end - start)
        whole = math.floor(abs(self.turns[-1] - np.interp(end - length, self.times, self.turns)) + 1e-9)
        sense = 1.0 if self.turns[-1] >= 0.0 else -1.0
        rising = np.maximum.accumulate(sense * (self.turns - self.turns[0]))  # a cage may shake back and forth
        for _ in range(3):
            at = np.interp(edges[-1], self.times, rising) - whole
            edges.append(float(np.interp(at, rising, self.times)) if whole and at > 0.0 else edges[-1] - length)
        return np.array(edges[::-1])

    def means(self, edges) -> np.ndarray:
        """Return the means between successive instants [s], shape (len(edges) - 1, m)."""
        there = np.array([np.interp(edges, self.times, column) for column in self.integrals.T]).T
        return np.diff(there, axis=0) / np.diff(edges)[:, None]


def trends(course: Course, tolerances: Sequence[Tolerance]) -> list[Trend]:
    """Return what each observable does at the end of a course.

    The means of three successive windows give the remaining change of an exponential approach, change x ratio/(1 - ratio); the ratio of
    changes that hardly shrink counts as 0.98, so that a steady drift counts for 49 windows, and no remaining change counts for less than
    the last one.  Where bodies rattle, means scatter: a change of less than three standard errors is none, and instead of it the mean has
    to be known well enough.  The standard error is that of batch means, eight in each window, about a parabola (so that a smooth drift is not
    taken for scatter), enlarged for the correlation of neighbours.

    Parameters
    ----------
    course : of at least some ten instants in each window.
    tolerances : of its observables, shape (m,).
    """
    edges = course.edges()
    means = course.means(edges)
    parts = np.concatenate([np.linspace(begin, end, _BATCHES, endpoint=False) for begin, end in zip(edges[:-1], edges[1:])] + [edges[-1:]])
    batches, found = course.means(parts), []
    for (first, second, third), batch, tolerance in zip(means.T.tolist(), batches.T, tolerances):
        error = _standard_error(batch, 0.5 * (parts[1:] + parts[:-1]))
        before, change = second - first, third - second
        ratio = min(abs(change / before), _SLOWEST) if before else (_SLOWEST if change else 0.0)
        remaining = change * max(ratio / (1.0 - ratio), 1.0)
        if abs(change) <= _SIGNIFICANT * math.sqrt(2.0) * error:
            remaining = 0.0
        found.append(Trend(third, 2.0 * error, remaining, tolerance.absolute + tolerance.relative * abs(third)))
    return found


def _standard_error(batches: np.ndarray, times: np.ndarray) -> float:
    """Return the standard error of the mean of a window from the means of all batches, shape (3 x batches,); NaN where these are."""
    if not np.isfinite(batches).all():
        return math.nan
    centred = (times - times.mean()) / (times[-1] - times[0])
    scatter = batches - np.polynomial.Polynomial.fit(centred, batches, 2)(centred)
    total = float(np.sum(scatter**2))
    if total == 0.0:
        return 0.0
    correlation = min(max(float(np.sum(scatter[1:] * scatter[:-1])) / total, 0.0), 0.9)
    return math.sqrt(total / (len(batches) - 3) / _BATCHES * (1.0 + correlation) / (1.0 - correlation))


def has_settled(course: Course, tolerances: Sequence[Tolerance]) -> bool:
    """Return whether all observables rest at the end of a course and did so when it was two thirds as long, and no motion grows.

    Parameters
    ----------
    course, tolerances : see `trends`; further columns are squares of motions, see `growing`.
    """
    before = course.until(course.times[0] + (course.times[-1] - course.times[0]) / _GROWTH)
    return all(trend.rests for part in (before, course) for trend in trends(part, tolerances)) and not growing(course, len(tolerances)).any()


def growing(course: Course, first: int) -> np.ndarray:
    """Return which motions grow at the end of a course, however small they are: an instability begins from nothing.

    Parameters
    ----------
    course : whose columns from ``first`` on are squares of motions.
    """
    one, two, three = course.means(course.edges())[:, first:]
    return (two > _GROWS * one) & (three > _GROWS * two) & (one > 0.0)


def describe(course: Course, trend: Trend, index: int, observed: Observed) -> tuple[str, str]:
    """Return what an observable that does not rest was doing: the verdict `DRIFTING`, `LIMIT_CYCLE` or `WANDERING`, and the same in words.

    Parameters
    ----------
    course : see `trends`.
    trend : of the observable.
    index : of its column in the course.
    observed : its name and units.
    """
    edges = np.linspace(course.times[0] + 0.5 * (course.times[-1] - course.times[0]), course.times[-1], _INTERVALS + 1)
    means = course.means(edges)[:, index]
    low, high = sorted((observed.shown(float(means.min())), observed.shown(float(means.max()))))
    spread = means - means.mean()
    fitted = np.polynomial.Polynomial.fit(np.arange(_INTERVALS), means, 1)(np.arange(_INTERVALS))
    if np.sum((means - fitted) ** 2) <= 0.5 * np.sum(spread**2):  # most of it is one way
        windows = course.edges()
        before, last = (observed.shown(mean) for mean in course.means(windows)[1:, index].tolist())
        change = (last - before) / (0.5 * (windows[3] - windows[1]))
        now = f"{observed.shown(trend.mean):.4g} {observed.unit}"
        way = "rises" if change > 0.0 else "falls"
        return DRIFTING, f"{observed.label} still {way} by {abs(change):.2g} {observed.change_unit} per s, now {now}"
    period = _period(spread) * (edges[1] - edges[0])
    between = f"between {low:.4g} and {high:.4g} {observed.unit}"
    if math.isfinite(period):
        return LIMIT_CYCLE, f"{observed.label} oscillates {between} with a period of {period:.3g} s"
    return WANDERING, f"{observed.label} wanders {between}"


def _period(spread: np.ndarray) -> float:
    """Return the lag of the first peak of the autocorrelation, in samples; NaN where there is no clear one."""
    total = float(np.sum(spread**2))
    lags = np.arange(1, len(spread) // 2)
    found = np.array([np.sum(spread[lag:] * spread[:-lag]) / (total * (1.0 - lag / len(spread))) for lag in lags]) if total else np.zeros(len(lags))
    below = np.flatnonzero(found < 0.0)
    if not len(below):
        return math.nan
    peak = int(below[0]) + int(np.argmax(found[below[0] :]))
    return float(lags[peak]) if found[peak] >= _REPEATS else math.nan


class Outcome(NamedTuple):
    """How a run ended.

    Attributes
    ----------
    verdict : `SETTLED` where everything rests, otherwise what kept it from that: `DRIFTING`, `LIMIT_CYCLE`, `WANDERING`, `TOO_SHORT` to tell,
        or `NO_STEADY_STATE` at level steady.
    simulated : simulated time [s].
    settling_time : since when slip has been as at the end, to 0.1 points or 2 % of it [s]; NaN where it has not settled.
    reason : why it has not settled, and what it was doing; empty if it has.
    slip : mean cage slip over the last window, cut to whole cage turns; NaN at rest.
    window : samples of the last fifth, see `bearing_sim.model.sample`.
    counters : work done until the end of the run.
    """

    verdict: str
    simulated: float
    settling_time: float
    reason: str
    slip: float
    window: np.ndarray
    counters: Counters

    @property
    def settled(self) -> bool:
        """Whether everything rests."""
        return self.verdict == SETTLED


class _Record:
    """What is kept of a run: its course, and the samples of its last third."""

    def __init__(self, start: np.ndarray):
        self._blocks = [start]
        self._times, self._turns, self._integrals = [start["time"]], [np.zeros(1)], [np.zeros((1, len(OBSERVED) + len(GROWING)))]

    def append(self, block: np.ndarray) -> None:
        """Append the samples that follow."""
        before, last = self._blocks[-1][-1], self._integrals[-1][-1]
        steps = np.diff(block["time"], prepend=before["time"])
        ideal = block["ideal_cage_speed"]
        with np.errstate(divide="ignore", invalid="ignore"):
            # From angles, so that it does not matter at which instants samples were taken; NaN at rest, where slip is not defined.
            slip = steps - np.diff(block["cage_angle"], prepend=before["cage_angle"]) / ideal
            rate = 1.0 / block["rating_life"]
        slip[ideal == 0.0] = math.nan
        tilt, whirl = (block[f"{name}_y"] ** 2 + block[f"{name}_z"] ** 2 for name in ("cage_tilt", "cage"))
        squares = (np.nan_to_num(tilt), np.nan_to_num(whirl), block["inner_load_maximum"] ** 2)
        integrals = np.stack([slip, steps * block["oil_temperature"], steps * rate, *(steps * square for square in squares)], axis=1)
        self._times.append(block["time"].copy())
        self._turns.append((block["cage_angle"] - self._blocks[0]["cage_angle"][0]) / (2.0 * math.pi))
        self._integrals.append(last + np.cumsum(integrals, axis=0))
        self._blocks = [self._blocks[0], *self._blocks[1:][-1:], block]

    @property
    def course(self) -> Course:
        return Course(np.concatenate(self._times), np.concatenate(self._turns), np.concatenate(self._integrals))

    @property
    def window(self) -> np.ndarray:
        samples, begin = joined(self._blocks), self._blocks[0]["time"][0]
        end = samples["time"][-1]
        return samples[samples["time"] > end - WINDOW * (end - begin)]


def mean_life(lives: np.ndarray) -> float:
    """Return the life under conditions that have these lives for equally long: damage adds up, so it is the rates that are averaged."""
    with np.errstate(divide="ignore"):
        return float(1.0 / np.mean(1.0 / lives))


def cage_turn(scene: Scene) -> float:
    """Return the time of a turn of an ideal cage [s]; infinite at rest."""
    speed = 0.5 * abs(scene.operating.shaft_speed) * (1.0 - scene.bearing.diameter_ratio)
    return 2.0 * math.pi / speed if speed else math.inf


def shortest_run(scene: Scene, seconds: float) -> float:
    """Return the simulated time of the shortest run [s]: ``seconds``, or 15 turns of an ideal cage if these take longer."""
    turn = cage_turn(scene)
    return max(seconds, SHORTEST_TURNS * turn) if math.isfinite(turn) else seconds


def longest_run(scene: Scene, seconds: float = LONGEST) -> float:
    """Return the simulated time of the longest run [s]: ``seconds``, or 2000 turns of an ideal cage if these take longer."""
    turn = cage_turn(scene)
    return max(seconds, LONGEST_TURNS * turn) if math.isfinite(turn) else seconds


def advance_until_settled(simulation: Simulation, shortest: float, longest: float, advance: Callable[[float], np.ndarray] | None = None) -> Outcome:
    """Advance a simulation under its constant conditions until slip, temperature and life rest.

    Parameters
    ----------
    simulation : at its start.
    shortest, longest : simulated time of the shortest and the longest run [s]; a run of a given length has both equal.
    advance : advances by at least a time [s] and returns some hundreds of samples of it, evenly spread, the one at its end among them; by
        default samples that no roller pitch repeats.

    Returns
    -------
    how the run ended.

    Raises
    ------
    IntegrationError
        The run stopped early.
    """
    advance = advance or (lambda seconds: sampled(simulation, seconds, shortest / _SAMPLES))
    record, begin, length = _Record(start_sample(simulation)), simulation.time, min(shortest, longest)
    while True:
        record.append(advance(begin + length - simulation.time))
        length = simulation.time - begin
        settled = has_settled(record.course, TOLERANCES)
        if settled or length >= (1.0 - 1e-9) * longest:
            return _outcome(simulation, record, settled)
        length = min(_GROWTH * length, longest)


def _outcome(simulation: Simulation, record: _Record, settled: bool) -> Outcome:
    course, counters = record.course, simulation.counters
    length, turns = simulation.time - course.times[0], (simulation.time - course.times[0]) / cage_turn(simulation.scene)
    found, reason = trends(course, TOLERANCES), ""
    restless = [describe(course, trend, index, each) for index, (trend, each) in enumerate(zip(found, OBSERVED)) if not trend.rests]
    verdict, doing = SETTLED, "; ".join(words for _, words in restless)
    if 0.0 < turns < SHORTEST_TURNS * (1.0 - 1e-9):
        verdict, reason = TOO_SHORT, f"{turns:.3g} turns of an ideal cage are too short to tell, {SHORTEST_TURNS:g} can be judged"
        reason += f"; {doing}" if doing else ""
    elif counters.unsettled_points:
        verdict, reason = NO_STEADY_STATE, "no steady state was found at this operating point"
    elif not settled:
        grows = [f"{name} still grows" for name, each in zip(GROWING, growing(course, len(OBSERVED))) if each]
        restless, doing = restless or [(DRIFTING, each) for each in grows], "; ".join(filter(None, (doing, *grows)))
        verdict = restless[0][0] if restless else TOO_SHORT
        reason = f"after {length:.4g} s {doing or 'slip and life rest, but did not before'}"
    slip, window = found[0].mean, record.window
    settling = _settling_time(course, slip) if verdict == SETTLED else math.nan
    return Outcome(verdict, length, settling, reason, slip, window, counters)


def _settling_time(course: Course, slip: float) -> float:
    """Return the instant from which the mean slip of every cage turn is that of the end [s]; 0 at rest."""
    turns = abs(course.turns[-1] - course.turns[0])
    edges = np.linspace(course.times[0], course.times[-1], int(np.clip(turns, 1, 4 * _INTERVALS)) + 1)
    outside = np.flatnonzero(np.abs(course.means(edges)[:, 0] - slip) > max(1e-3, 0.02 * abs(slip)))
    return float(edges[outside[-1] + 1] - edges[0]) if len(outside) else 0.0


def sampled(simulation: Simulation, seconds: float, interval: float) -> np.ndarray:
    """Advance by a time [s] and return samples whose spacing is no multiple of the time in which a roller takes the place of the next.

    Samples in step with the rollers would all show the same instant of a pitch.

    Parameters
    ----------
    simulation : to advance.
    seconds : simulated time.
    interval : longest time between samples [s].
    """
    least = math.ceil(seconds / interval * (1.0 - 1e-9))
    counts = np.arange(least, least + least // 2 + 2)
    pitches = seconds / counts * simulation.scene.bearing.roller.count * abs(float(simulation.sample["cage_speed"])) / (2.0 * math.pi)
    count = int(counts[np.argmin(np.abs(pitches % 1.0 - _GOLDEN))])
    return advance_in_calls(simulation, seconds / count, count, _TOGETHER)


def advance_in_calls(
    simulation: Simulation, interval: float, count: int, together: int, receive: Callable[[np.ndarray], None] = lambda block: None
) -> np.ndarray:
    """Advance sample by sample and return some of the samples, evenly spread, the last one among them.

    Steps end at samples: their spacing stays the same throughout a run, so that a change of its results is not one of its steps.

    Parameters
    ----------
    simulation : to advance.
    interval : between samples [s].
    count : of samples.
    together : samples of a call of the model, whose budget of steps is that of a call.
    receive : called with every block of samples.
    """
    stride, kept, largest = max(count // _KEPT, 1), [], {name: [] for name in _MAXIMA}
    for done in range(0, count, together):
        size = min(together, count - done)
        block = simulation.advance(size * interval, samples=size)
        receive(block)
        for name, values in largest.items():
            values.append(block[name].copy())
        kept.append(block[(count - done - 1) % stride :: stride].copy())
    found = joined([part for part in kept if len(part)])
    begins = np.concatenate([[0], np.arange((count - 1) % stride + 1, count, stride)])
    for name, values in largest.items():  # also those of the samples that are left out
        found[name] = np.maximum.reduceat(np.concatenate(values), begins)
    return found
