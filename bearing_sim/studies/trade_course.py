# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a trade measures on: built-in courses of speed and load, and windows of a log.

A course is measured in windows, in each of which speed and load are linear between instants.  A built-in course is one window; its data are
fractions of a scene's speed and load over cage turns, so that slow and fast bearings see the same course.  A log is too long to be run whole at
fine tolerances: windows of the same number of cage turns are spread evenly over the time during which the shaft turns.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, scene_inputs

BIN = 1.5  # cage turns over which slip and loads are averaged: trajectories with impacts diverge in phase, their means do not
WINDOWS, WINDOW_TURNS = 12, 60.0
_SETTLING = 1.0 / 3.0  # of a window of a log, ignored
_FEWEST_TURNS = 6.0  # of a window of a log
_AT_REST = 1e-3  # of the highest speed of a log, below which the shaft counts as at rest
_QUICK_TURNS = 24.0  # after settling, of a built-in course that is only tried


class Outline(NamedTuple):
    """A built-in course.

    Attributes
    ----------
    meaning : in a few words.
    settling : cage turns ignored at the start.
    points : cage turn at the scene's speed, and fractions of the scene's speed and load there; linear in between.
    """

    meaning: str
    settling: float
    points: tuple[tuple[float, float, float], ...]


OUTLINES = {
    "manoeuvre": Outline(
        "the load is halved and restored, and the shaft slowed by a fifth",
        48.0,
        (
            (0.0, 1.0, 1.0),
            (72.0, 1.0, 1.0),
            (78.0, 1.0, 0.5),
            (102.0, 1.0, 0.5),
            (108.0, 1.0, 1.0),
            (120.0, 1.0, 1.0),
            (132.0, 0.8, 1.0),
            (160.0, 0.8, 1.0),
        ),
    ),
    "run_down": Outline(
        "the shaft slows to a tenth of its speed under constant load",
        48.0,
        ((0.0, 1.0, 1.0), (60.0, 1.0, 1.0), (260.0, 0.1, 1.0), (300.0, 0.1, 1.0)),
    ),
    "start": Outline(
        "a motor starts: from a creeping 3 % to full speed within 21 turns of the cage at full speed, then steady",
        3.0,
        ((0.0, 0.03, 1.0), (6.0, 0.03, 1.0), (27.0, 1.0, 1.0), (67.0, 1.0, 1.0)),
    ),
    "idle": Outline(
        "a gearbox idles: its light load is halved and restored, and the speed rises by a fifth",
        24.0,
        (
            (0.0, 1.0, 1.0),
            (36.0, 1.0, 1.0),
            (40.0, 1.0, 0.5),
            (60.0, 1.0, 0.5),
            (64.0, 1.0, 1.0),
            (76.0, 1.0, 1.0),
            (82.0, 1.2, 1.0),
            (100.0, 1.2, 1.0),
        ),
    ),
}
"""The built-in courses by name."""


class Window(NamedTuple):
    """A part of a course that is measured in one run.

    Attributes
    ----------
    begin : of the window in its log [s]; 0 for a built-in course.
    times : from the beginning of the window [s], rising, the first 0.
    inputs : at these instants, in the order of `bearing_sim.simulation.Inputs`; speed and load are linear in between.
    settling : time ignored at the start [s].
    """

    begin: float
    times: tuple[float, ...]
    inputs: tuple[tuple[float, ...], ...]
    settling: float

    @property
    def seconds(self) -> float:
        """Length of the window [s]."""
        return self.times[-1]

    def at(self, time: float) -> Inputs:
        """Return the inputs at an instant of the window [s]; temperatures are held between instants."""
        return Inputs(*_between(np.array(self.times), np.array(self.inputs), time))


class Course(NamedTuple):
    """What a trade measures on.

    Attributes
    ----------
    name : of the built-in course, or of the log's file.
    windows : in order of time.
    turning : for how long the shaft turns in the whole course [s].
    log_seconds : length of the log [s]; NaN for a built-in course.
    """

    name: str
    windows: tuple[Window, ...]
    turning: float
    log_seconds: float = math.nan

    @property
    def measured(self) -> float:
        """How much of the course is in windows [s]."""
        return sum(window.seconds for window in self.windows)

    @property
    def is_log(self) -> bool:
        """Whether the course comes from a log."""
        return not math.isnan(self.log_seconds)

    def extent(self) -> dict[str, tuple[float, float]]:
        """Return the least and the largest shaft speed [rad/s, without sign], radial load [N] and oil temperature [K] in the windows."""
        rows = np.array([row for window in self.windows for row in window.inputs])
        columns = {"shaft_speed": np.abs(rows[:, 0]), "radial_load": np.hypot(rows[:, 1], rows[:, 2]), "oil_temperature": rows[:, 3]}
        return {name: (float(column.min()), float(column.max())) for name, column in columns.items()}


def built_in(name: str, scene: Scene, quick: bool = False) -> Course:
    """Return a built-in course at the conditions of a scene.

    Parameters
    ----------
    name : one of `OUTLINES`.
    scene : whose operating conditions are 1 in the outline; its shaft turns.
    quick : only the beginning, to try whether everything works.
    """
    outline, whole = OUTLINES[name], scene_inputs(scene)
    points = np.array(outline.points)
    if quick:
        end = min(outline.settling + _QUICK_TURNS, points[-1, 0])
        inner = points[points[:, 0] < end]
        points = np.vstack([inner, [end, *(np.interp(end, points[:, 0], points[:, column]) for column in (1, 2))]])
    turn = 1.0 / abs(cage_rate(scene, whole.shaft_speed))
    rows = [(whole.shaft_speed * speed, whole.load_y * load, whole.load_z * load, *whole[3:]) for speed, load in points[:, 1:].tolist()]
    times = tuple((points[:, 0] * turn).tolist())
    return Course(name, (Window(0.0, times, tuple(rows), outline.settling * turn),), times[-1])


def windows_of(
    name: str, scene: Scene, times: np.ndarray, inputs: np.ndarray, in_gap: np.ndarray, count: int = WINDOWS, turns: float = WINDOW_TURNS
) -> Course:
    """Return windows of a log, spread evenly over the time during which the shaft turns.

    Parameters
    ----------
    name : of the log.
    scene : of the bearing, whose cage turns count.
    times : instants [s], rising, shape (n,).
    inputs : at the instants, columns as `bearing_sim.simulation.Inputs`, shape (n, 6).
    in_gap : whether inputs are unknown in the time before each instant, shape (n,).
    count : of windows; a shorter log has fewer.
    turns : of an ideal cage in a window; fewer if the shaft never turns for so long.

    Raises
    ------
    ValueError
        The shaft never turns for a few cage turns.
    """
    spans = [_Span(scene, times[begin:end], inputs[begin:end]) for begin, end in _turning(times, inputs[:, 0], in_gap)]
    longest = max((span.turns for span in spans), default=0.0)
    if longest < _FEWEST_TURNS:
        raise ValueError(
            f"{name}: the shaft turns for at most {longest:.3g} turns of the cage without a stop or a gap; expected {_FEWEST_TURNS:g} or more in one "
            f"window: give a longer log, or a built-in course ({', '.join(OUTLINES)})"
        )
    turning = float(sum(span.times[-1] - span.times[0] for span in spans))
    turns = min(turns, longest)
    spans = [span for span in spans if span.turns >= turns * (1.0 - 1e-9)]
    count = max(min(count, math.floor(sum(span.turns for span in spans) / turns * (1.0 + 1e-9))), 1)
    free = np.array([span.latest(turns) - span.times[0] for span in spans])  # in which a window may begin
    reached = np.concatenate([[0.0], np.cumsum(free)])
    windows = []
    for middle in (np.arange(count) + 0.5) / count * reached[-1]:
        index = min(int(np.searchsorted(reached, middle, "right")) - 1, len(spans) - 1)
        windows.append(spans[index].window(spans[index].times[0] + min(middle - reached[index], free[index]), turns))
    return Course(name, tuple(windows), turning, float(times[-1] - times[0]))


def _turning(times: np.ndarray, speeds: np.ndarray, in_gap: np.ndarray) -> list[tuple[int, int]]:
    """Return from which to which instant, exclusive, the shaft turns one way without a gap."""
    threshold = _AT_REST * np.abs(speeds).max(initial=0.0)
    sense = np.where(np.abs(speeds) > threshold, np.sign(speeds), 0.0)
    breaks = np.flatnonzero((np.diff(sense) != 0.0) | in_gap[1:]) + 1
    edges = [0, *breaks.tolist(), len(times)]
    return [(begin, end) for begin, end in zip(edges, edges[1:]) if end - begin > 1 and sense[begin] != 0.0]


def cage_rate(scene: Scene, speed: float) -> float:
    """Return the turns of a cage without slip [1/s] at a shaft speed [rad/s]."""
    return 0.5 * speed * (1.0 - scene.bearing.diameter_ratio) / (2.0 * math.pi)


def turned(scene: Scene, times: np.ndarray, speeds: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the turns of a cage without slip from the first instant to others, without sign, shape as of ``at``.

    Parameters
    ----------
    times, speeds : instants [s] and shaft speeds [rad/s] there, which are linear in between, shape (n,).
    at : instants within these [s].
    """
    rates = np.abs(cage_rate(scene, np.asarray(speeds, float)))
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * np.diff(times))])
    k = np.clip(np.searchsorted(times, at, "right") - 1, 0, len(times) - 2)
    return whole[k] + 0.5 * (rates[k] + np.interp(at, times, rates)) * (at - np.asarray(times)[k])


def time_of_turns(scene: Scene, times: np.ndarray, speeds: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Return the instants [s] at which a cage without slip has made so many turns; the inverse of `turned`, where the shaft turns throughout."""
    times = np.asarray(times, float)
    rates = np.abs(cage_rate(scene, np.asarray(speeds, float)))
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * np.diff(times))])
    k = np.clip(np.searchsorted(whole, turns, "right") - 1, 0, len(times) - 2)
    rest, growth = turns - whole[k], (rates[k + 1] - rates[k]) / (times[k + 1] - times[k])
    root = np.sqrt(np.maximum(rates[k] ** 2 + 2.0 * growth * rest, 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        return times[k] + np.where(rest > 0.0, 2.0 * rest / (rates[k] + root), 0.0)


def bin_edges(scene: Scene, window: Window) -> np.ndarray:
    """Return the instants [s] between which slip and load are averaged, the first of them where settling ends.

    All bins have as many turns of a cage without slip, about `BIN`.
    """
    times, speeds = np.array(window.times), np.array([row[0] for row in window.inputs])
    first, last = turned(scene, times, speeds, np.array([window.settling, window.seconds])).tolist()
    count = max(round((last - first) / BIN), 1)
    edges = time_of_turns(scene, times, speeds, np.linspace(first, last, count + 1))
    edges[0], edges[-1] = window.settling, window.seconds
    return edges


def _between(times: np.ndarray, inputs: np.ndarray, at: float) -> list[float]:
    """Return the inputs at an instant: speed and load linear between instants, temperatures held."""
    k = int(np.clip(np.searchsorted(times, at, "right") - 1, 0, len(times) - 1))
    return [*(float(np.interp(at, times, inputs[:, column])) for column in range(3)), *inputs[k, 3:].tolist()]


class _Span:
    """A part of a log in which the shaft turns one way: instants [s], inputs, and the turns of the cage in all."""

    def __init__(self, scene: Scene, times: Sequence[float], inputs: np.ndarray):
        self._scene, self.times, self._inputs = scene, np.asarray(times, float), inputs
        self.turns = float(self._turned(self.times[-1:])[0])

    def _turned(self, at: np.ndarray) -> np.ndarray:
        return turned(self._scene, self.times, self._inputs[:, 0], at)

    def _time(self, turns: float) -> float:
        found = time_of_turns(self._scene, self.times, self._inputs[:, 0], np.array([turns]))
        return float(min(found[0], self.times[-1]))

    def latest(self, turns: float) -> float:
        """Return the last instant [s] after which so many turns are left."""
        return self._time(max(self.turns - turns, 0.0))

    def window(self, begin: float, turns: float) -> Window:
        """Return the window that begins at an instant [s]."""
        first = float(self._turned(np.array([begin]))[0])
        end = self._time(min(first + turns, self.turns))
        inner = (self.times > begin) & (self.times < end)
        rows = [_between(self.times, self._inputs, begin), *self._inputs[inner].tolist(), _between(self.times, self._inputs, end)]
        times = np.concatenate([[begin], self.times[inner], [end]]) - begin
        settling = self._time(first + _SETTLING * turns) - begin
        return Window(begin, tuple(times.tolist()), tuple(tuple(row) for row in rows), settling)
