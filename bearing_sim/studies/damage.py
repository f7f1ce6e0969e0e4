# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Damage of one measured course at several levels: ``steady`` and ``slip`` over the whole course, ``planar`` in windows."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation

_SETTLING = 0.5  # s that planar runs before a window, from the state of slip, until the cage has found its orbit
_AT_ONCE = 2000  # instants per call of level steady


class Window(NamedTuple):
    """A window of the course, and the damage in it by level."""

    start: float  # [s]
    length: float  # [s]
    shaft_speed: float  # mean [rad/s]
    radial_load: float  # mean [N]
    steady: float
    slip: float
    planar: float


class Damages(NamedTuple):
    """Damage of a course, by level."""

    seconds: float  # simulated: the course without its gaps
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
    name, overrides : of the scene, as `bearing_sim.scene.loader.load_scene` takes them; its level is ignored.
    times, inputs : instants [s], shape (n,), and conditions there, shape (n, 6), columns as `Inputs`; linear in between.
    in_gap : whether the interval that ends at an instant is left out, shape (n,).
    table : of level ``steady``; None: the one on disk, if any.
    windows, length : number of evenly spaced windows of level ``planar``, and the length of each [s].
    progress : called from time to time with the time reached [s].

    Raises
    ------
    SceneError
        The scene is invalid, or cannot be computed at these levels.
    IntegrationError
        A run stopped early.
    """
    scenes = {level: load_scene(name, [*overrides, f"level={level}"]) for level in ("steady", "slip", "planar")}
    steady = _steady_damage(Simulation(scenes["steady"], Inputs(*inputs[0]), table), times, inputs, in_gap)
    starts = list(times[0] + (times[-1] - times[0]) * (np.arange(windows) + 0.5) / windows)
    slip, planar = Simulation(scenes["slip"], Inputs(*inputs[0])), Simulation(scenes["planar"], Inputs(*inputs[0]))
    course, found = np.zeros(len(times)), []
    for k in range(1, len(times)):
        while starts and times[k] > starts[0] - _SETTLING:  # slip is at the instant before
            found.append((starts[0], _window(planar, slip, starts.pop(0), length, times, inputs, k)))
        course[k] = course[k - 1]
        if not in_gap[k]:
            course[k] += float(slip.advance(times[k] - times[k - 1], Inputs(*inputs[k]))["damage"][-1]) - course[k - 1]
        if k % 100 == 0:
            progress(float(times[k]))
    measured = []
    for start, planar_damage in found:
        own = [float(np.interp(start + length, times, of_level) - np.interp(start, times, of_level)) for of_level in (steady, course)]
        mean = inputs[(times >= start) & (times <= start + length)].mean(axis=0)
        measured.append(Window(float(start), length, float(mean[0]), float(np.hypot(mean[1], mean[2])), *own, planar_damage))
    simulated = float(np.diff(times)[~in_gap[1:]].sum())
    return Damages(simulated, float(steady[-1]), float(course[-1]), measured)


def _steady_damage(run, times, inputs, in_gap):
    """Return the damage at each instant."""
    damage = np.zeros(len(times))
    k = 1
    while k < len(times):
        stretch = slice(k, min(k + _AT_ONCE, len(times)))
        reached = 0
        if run.takes_profiles and not in_gap[stretch].any():
            block = run.advance_profile(np.diff(times)[k - 1 : stretch.stop - 1], inputs[stretch])
            reached = len(block)
            damage[k : k + reached] = block["damage"]
        if not reached:
            damage[k] = damage[k - 1]
            if not in_gap[k]:
                damage[k] = run.advance(times[k] - times[k - 1], Inputs(*inputs[k]))["damage"][-1]
            reached = 1
        k += reached
    return damage


def _window(planar, slip, start, length, times, inputs, k):
    """Run planar from the state of slip to the end of a window; return the damage in the window."""
    planar.take_over(slip)
    edges = np.unique([times[k - 1], *times[(times > times[k - 1]) & (times < start + length)], start, start + length])
    before = 0.0
    for begin, end in zip(edges, edges[1:]):
        if begin == start:
            before = float(planar.sample["damage"])
        planar.advance(end - begin, Inputs(*(float(np.interp(end, times, column)) for column in inputs.T)))
    return float(planar.sample["damage"]) - before
