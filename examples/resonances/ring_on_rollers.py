# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The inner ring on its rollers over speed: where the passing rollers excite it, and what becomes of slip and life."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.display import RPM
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError
from bearing_sim.sweep.pictures import COLOURS, new_figure, plain_numbers, save, set_limits
from bearing_sim.sweep.point import run_until_settled
from bearing_sim.sweep.ring_resonance import Resonance, ring_resonance
from bearing_sim.sweep.states import State, other_states, state_of

_SHORTEST = 0.1  # s of a run


class Speed(NamedTuple):
    """A bearing at one speed."""

    shaft_speed: float  # [rad/s]
    resonance: Resonance | None  # None where no balance was found
    states: tuple[State, ...]  # the one from ideal rolling first; none where the run stopped early


def resonances(scene: Scene, shaft_speeds: Sequence[float], progress: Callable[[int], None] = lambda done: None) -> list[Speed]:
    """Return how the passing rollers excite the inner ring over speed, and the states in which it stays.

    Parameters
    ----------
    scene : at level planar or spatial.
    shaft_speeds : [rad/s], not 0.
    progress : called with the number of finished speeds.
    """
    found = []
    for done, speed in enumerate(shaft_speeds, 1):
        there, known = scene.at(shaft_speed=float(speed)), ()
        resonance = ring_resonance(there)
        try:
            outcome = run_until_settled(there, _SHORTEST)
            others = other_states(there, outcome, skid_load=False)
            known = (state_of(outcome, "from ideal rolling"), *others.states)
            resonance = others.resonance
        except IntegrationError:
            pass
        found.append(Speed(float(speed), resonance, known))
        progress(done)
    return found


def plot_resonances(path: Path, title: str, found: Sequence[Speed]) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(9, 10.5)
    ratios, growth, slips, lives = figure.subplots(4, 1, sharex=True)
    known = [each for each in found if each.resonance is not None]
    rpm = np.array([RPM * each.shaft_speed for each in known])
    for k, name in enumerate(("lower natural frequency", "higher natural frequency")):
        ratios.plot(rpm, [each.resonance.ratios[k] for each in known], color=COLOURS[k], marker="o", ms=3, label=name)
    highest = max((each.resonance.ratios[1] for each in known), default=1.0)
    for n in range(1, min(math.ceil(2.0 * highest), 12) + 1):
        ratios.axhline(0.5 * n, color="0.6", lw=0.8, ls=":")
    ratios.set(ylabel="over passing rollers", ylim=(0.0, 1.1 * highest))
    growth.plot(rpm, [each.resonance.multiplier for each in known], color=COLOURS[0], marker="o", ms=3, label="at these frequencies")
    growth.plot(rpm, [each.resonance.multiplier_nearby for each in known], color="0.5", lw=1, label="at the worst of 0.8 to 1.05 times these")
    growth.axhline(1.0, color="0.3", lw=0.8)
    growth.set(ylabel="multiplier per roller")
    for axes, name, factor in ((slips, "cage_slip", 100.0), (lives, "rating_life", 1.0)):
        states = [(k, RPM * each.shaft_speed, factor * getattr(state, name)) for each in found for k, state in enumerate(each.states)]
        first, rest = (np.array([each for each in states if bool(each[0]) is is_other]).reshape(-1, 3).T[1:] for is_other in (False, True))
        axes.plot(*first, color=COLOURS[0], marker="o", ms=3, label="from ideal rolling")
        if rest.size:
            axes.plot(*rest, color=COLOURS[1], marker="s", ms=5, ls="none", label="another state under the same conditions")
    slips.set(ylabel="cage slip [%]")
    lives.set(ylabel="rating life [h]", xlabel="shaft speed [rpm]")
    shown = np.array([state.rating_life for each in found for state in each.states])
    set_limits(lives, shown[np.isfinite(shown)], True)
    plain_numbers(lives.xaxis)
    excited = [each.resonance.excited for each in known]
    for axes in (ratios, growth, slips, lives):
        axes.legend(frameon=False, fontsize=8)
        axes.grid(alpha=0.3)
        if any(excited):
            axes.fill_between(rpm, 0, 1, where=excited, step="mid", transform=axes.get_xaxis_transform(), color="#b2451f", alpha=0.12, lw=0)
    save(figure, path, f"{title}\nshaded: the passing rollers make the inner ring vibrate", 10)
