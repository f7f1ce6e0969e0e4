# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The damage that levels give one measured course: ``steady`` and ``slip`` over the whole of it, ``planar`` in windows."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import Inputs, Simulation

_SETTLING = 0.5  # s that planar runs before a window, from where slip is: the cage finds its orbit
_AT_ONCE = 2000  # instants that level steady takes in one go


class Window(NamedTuple):
    """A stretch of the course, and the damage in it by level."""

    start: float  # [s]
    length: float  # [s]
    shaft_speed: float  # mean [rad/s]
    radial_load: float  # mean [N]
    steady: float
    slip: float
    planar: float


class Damages(NamedTuple):
    """What a course does to a bearing, by level."""

    seconds: float  # simulated: the course less its gaps
    steady: float
    slip: float
    windows: list[Window]


def damages(
    name: str, overrides: Sequence[str], times: np.ndarray, inputs: np.ndarray, in_gap: np.ndarray, *,
    table=None, windows: int = 10, length: float = 1.0, progress: Callable[[float], None] = lambda seconds: None,
) -> Damages:  # fmt: skip
    """Run a course at three levels.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene_file.load_scene` takes them; its level does not count.
    times, inputs : instants [s], shape (n,), and conditions there, shape (n, 4), columns as `Inputs`; linear in between.
    in_gap : whether the stretch that ends at an instant is left out, shape (n,).
    table : of level ``steady``; the one on disk, or none, where absent.
    windows, length : how many windows of level ``planar``, evenly spread, and how long each [s].
    progress : called now and then with the time that has been reached [s].

    Raises
    ------
    SceneError
        The scene is faulty, or cannot be at these levels.
    IntegrationError
        A level did not come to the end.
    """
    scenes = {level: load_scene(name, [*overrides, f"level={level}"]) for level in ("steady", "slip", "planar")}
    steady = _steady_damage(Simulation(scenes["steady"], Inputs(*inputs[0]), table), times, inputs, in_gap)
    starts = list(times[0] + (times[-1] - times[0]) * (np.arange(windows) + 0.5) / windows)
    slip, planar = Simulation(scenes["slip"], Inputs(*inputs[0])), Simulation(scenes["planar"], Inputs(*inputs[0]))
    course, found = np.zeros(len(times)), []
    for place in range(1, len(times)):
        while starts and times[place] > starts[0] - _SETTLING:  # slip stands at the instant before
            found.append((starts[0], *_window(planar, slip, starts.pop(0), length, times, inputs, place)))
        course[place] = course[place - 1]
        if not in_gap[place]:
            course[place] += float(slip.advance(times[place] - times[place - 1], Inputs(*inputs[place]))["damage"][-1]) - course[place - 1]
        if place % 100 == 0:
            progress(float(times[place]))
    measured = []
    for start, *planar_damage in found:
        own = [float(np.interp(start + length, times, of_level) - np.interp(start, times, of_level)) for of_level in (steady, course)]
        mean = inputs[(times >= start) & (times <= start + length)].mean(axis=0)
        measured.append(Window(float(start), length, float(mean[0]), float(np.hypot(mean[1], mean[2])), *own, *planar_damage))
    simulated = float(np.diff(times)[~in_gap[1:]].sum())
    return Damages(simulated, float(steady[-1]), float(course[-1]), measured)


def _steady_damage(run, times, inputs, in_gap):
    """Return the damage at each instant."""
    damage = np.zeros(len(times))
    place = 1
    while place < len(times):
        stretch = slice(place, min(place + _AT_ONCE, len(times)))
        reached = 0
        if run.takes_courses and not in_gap[stretch].any():
            block = run.advance_course(np.diff(times)[place - 1 : stretch.stop - 1], inputs[stretch])
            reached = len(block)
            damage[place : place + reached] = block["damage"]
        if not reached:
            damage[place] = damage[place - 1]
            if not in_gap[place]:
                damage[place] = run.advance(times[place] - times[place - 1], Inputs(*inputs[place]))["damage"][-1]
            reached = 1
        place += reached
    return damage


def _window(planar, slip, start, length, times, inputs, place):
    """Run planar from where slip is to the end of a window; return the damage in the window."""
    planar.take_over(slip)
    edges = [times[place - 1], *times[(times > times[place - 1]) & (times < start + length)], start, start + length]
    edges = np.unique(edges)
    before = 0.0
    for begin, end in zip(edges, edges[1:]):
        if begin == start:
            before = float(planar.sample["damage"])
        planar.advance(end - begin, Inputs(*(float(np.interp(end, times, column)) for column in inputs.T)))
    return (float(planar.sample["damage"]) - before,)
