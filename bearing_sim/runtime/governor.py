# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keep real time by reducing fidelity: change to a faster setting when the solver is too slow, and back when it is fast enough.

Settings are levels, or those that `bearing-sim trade` has measured on the bearing, from accurate to fast: by the front that the scene names, else
by what this machine has kept (`bearing_sim.scene.loader.measured_of`); then the errors of the one that runs are known.  The criterion is the recent
cost of ticks, simulated over wall seconds.  The ratio of costs between a setting and the one above was measured when the upper one last ran, so the
cost of the present one predicts whether the upper one would keep real time.

Bearings that share threads can be too slow together although each alone is fast enough.  What counts then is the time from the instant at which a
tick could have begun, of the bearing that waits longest; the governors change one after the other, so that no more of them fall than must.
"""

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.table_builder import cached_table
from bearing_sim.runtime.solver_threads import CommonPace
from bearing_sim.scene.fidelity import NUMBERS, lower_levels
from bearing_sim.scene.loader import with_setting
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, Tradeoffs, complete_overrides, is_coarser
from bearing_sim.scene.quantity import in_digits
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation

_TOO_SLOW = 1.05  # times real time: below this the lag grows, or soon will
_FAST_ENOUGH = 1.4  # predicted for the level above before it is used: well over _TOO_SLOW, so that it is not left again at once
_MEMORY = 0.25  # [s] over which the factor is a mean: short, so that a change comes before the lag that can be caught up is used up
_LONGEST_WAIT = 300.0  # [s]
_NO_FASTER = 0.8  # times as fast as the setting above, beyond what a busy machine makes of one that is as fast
_WORTH_A_CHANGE = 1.25  # times as fast as the setting above
RECORD = "bearing_sim_governor"
"""Name of a recording's metadata record of the settings that a governor can choose."""


class Change(NamedTuple):
    """A change of setting."""

    simulation: Simulation  # that continues the run
    down: bool
    text: str
    setting: str = ""  # name of the setting that continues; empty where only levels are known


class Governor:
    """Chooses the level, or the measured setting, that a running model computes at.

    If a setting has to be left sooner than the wait before it, the next wait is twice as long.

    Parameters
    ----------
    ladder : simulations of one bearing at its settings, compiled, the wanted one first, each faster than the one before.
    patience : time for which the setting above must be predicted to be fast enough before it is tried again [s].
    settings : those of the ladder as measured (see `settings_to_fall`); empty where nothing is known but the levels.
    courses : that they were measured on.
    """

    def __init__(self, ladder: Sequence[Simulation], patience: float = 5.0, settings: Sequence[Setting] = (), courses: Sequence[MeasuredCourse] = ()):
        self._ladder, self._patience, self._settings, self._courses = list(ladder), patience, list(settings), tuple(courses)
        self._cost_ratios = [math.nan] * len(self._ladder)  # cost of a level over that of the one below
        self._begin(0)
        self._wait, self._came_up = patience, False

    @property
    def level(self) -> str:
        """The level that runs."""
        return self.scene.level

    @property
    def scene(self) -> Scene:
        """The scene at the setting that runs."""
        return self._ladder[self._rung].scene

    @property
    def wanted(self) -> str:
        """The level that runs if the machine is fast enough."""
        return self._ladder[0].scene.level

    @property
    def is_at_wanted(self) -> bool:
        """Whether the setting runs that is wanted."""
        return self._rung == 0

    @property
    def setting(self) -> str:
        """Name of the setting that runs; empty where only levels are known."""
        return self._name(self._rung)

    @property
    def wanted_setting(self) -> str:
        """Name of the setting that runs if the machine is fast enough, likewise."""
        return self._name(0)

    @property
    def slip_error(self) -> float:
        """Measured error of slip of the setting that runs, root mean square over its courses, 0.01 for a point; NaN where it was not measured."""
        return 0.01 * self._settings[self._rung].errors.get("slip", math.nan) if self._settings else math.nan

    @property
    def life_error(self) -> float:
        """Measured error of the life of the setting that runs, relative; NaN where it was not measured."""
        return self._settings[self._rung].errors.get("life", math.nan) if self._settings else math.nan

    def is_measured_at(self, sample: np.void) -> bool:
        """Return whether errors were measured where a sample operates, or nearly so; true where it is not known on what they were."""
        load = math.hypot(sample["load_y"], sample["load_z"])
        point = float(sample["shaft_speed"]), load, float(sample["oil_temperature"])
        return not self._courses or any(course.covers_point(*point) for course in self._courses)

    def _name(self, rung: int) -> str:
        return self._settings[rung].name if self._settings else ""

    @property
    def factor(self) -> float:
        """Simulated over wall seconds, recently; NaN before the first tick of this level."""
        return self._simulated / self._spent if self._spent > 0.0 else math.nan

    def restart(self) -> Simulation:
        """Return to the wanted level for a run that starts again; the caller resets the simulation."""
        self._begin(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def leave(self) -> Simulation:
        """Return to the wanted level, from the same cage angle and speed, for a run that continues without a governor."""
        if self._rung:
            self._change(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def consider(self, simulated: float, spent: float, waited: float = 0.0, common: CommonPace | None = None, now: float = 0.0) -> Change | None:
        """Take one tick and return the change that it calls for, or None.

        Parameters
        ----------
        simulated : length of the tick [s].
        spent : wall time that computing it took [s].
        waited : wall time from when the tick could have begun until it did, because others had the thread [s].
        common : pace of the bearings that share threads with this one; None if there are none.
        now : when the tick ended [s], monotonic.
        """
        elapsed = max(simulated, spent)
        kept = math.exp(-elapsed / _MEMORY)
        self._simulated, self._spent, self._waited = self._simulated * kept + simulated, self._spent * kept + spent, self._waited * kept + waited
        self._stayed += elapsed
        if self._stayed < _MEMORY:  # the first ticks of a level are not typical
            return None
        if common is not None:
            common.note(self, (self._spent + self._waited) / self._simulated, now)
        change = self._change_at(elapsed, common, now)
        if change is not None and common is not None:
            common.forget(self)
        return change

    def _change_at(self, elapsed: float, common: CommonPace | None, now: float) -> Change | None:
        """Return the change that the recent ticks call for after one more, which took so long [s], or None."""
        if not math.isnan(self._left_at):
            ratio, self._left_at = self.factor / self._left_at, math.nan
            self._cost_ratios[self._rung - 1] = max(ratio, 1.0)
            if ratio < _NO_FASTER:
                return self._drop()
        factor, share = self.factor, 0.0 if common is None else common.slowest(now)
        if self._rung + 1 < len(self._ladder):
            if factor < _TOO_SLOW:
                return self._go_down(f"level {self.setting or self.level} reaches {in_digits(factor, 3)} of real time on this machine")
            if share * _TOO_SLOW > 1.0 and common.takes_turn(now):
                return self._go_down(f"the bearings that share a process reach {in_digits(1.0 / share, 3)} of real time on this machine")
        if self._rung == 0:
            return None
        promised = factor / self._cost_ratios[self._rung - 1]
        if share:
            promised = min(promised, 1.0 / (share + 1.0 / promised - 1.0 / factor))
        self._promising = self._promising + elapsed if promised > _FAST_ENOUGH else 0.0
        return self._go_up(promised) if self._promising >= self._wait and (common is None or common.takes_turn(now)) else None

    def _go_down(self, reason: str) -> Change:
        if self._came_up:
            self._wait = min(2.0 * self._wait, _LONGEST_WAIT) if self._stayed < self._wait else self._patience
        factor = self.factor
        simulation = self._change(self._rung + 1)
        text = f"{reason}: {self._told()} continues from the same cage angle and speed"
        self._left_at, self._came_up = factor, False
        return Change(simulation, True, text, self.setting)

    def _go_up(self, promised: float) -> Change:
        simulation = self._change(self._rung - 1)
        text = f"level {self._told()}, expected to reach {in_digits(promised, 3)} of real time, continues from the same cage angle and speed"
        self._came_up = True
        return Change(simulation, False, text, self.setting)

    def _drop(self) -> Change:
        """Go back from a setting that is no faster than the one above, as level ``steady`` may be without a table, and do without it."""
        dropped, name = self._rung, self.setting or self.level
        simulation = self._change(dropped - 1)
        del self._ladder[dropped], self._cost_ratios[dropped]
        if self._settings:
            del self._settings[dropped]
        self._cost_ratios[dropped - 1] = math.nan
        advice = " (bearing-sim table builds the table that makes it faster)" if name == "steady" else ""
        return Change(simulation, False, f"level {name} is no faster here and is not used again{advice}: {self._told()} continues", self.setting)

    def _told(self) -> str:
        """Return the setting that runs, with its measured errors where it has any."""
        if not self.setting:
            return self.level
        numbers = (f"slip {100.0 * self.slip_error:.2g} points", self.slip_error), (f"life {100.0 * self.life_error:.2g} %", self.life_error)
        errors = ", ".join(text for text, error in numbers if not math.isnan(error)) or "not measured"
        return f"{self.setting} (errors: {errors})"

    def _change(self, rung: int) -> Simulation:
        before, after = self._ladder[self._rung], self._ladder[rung]
        after.take_over(before)
        self._begin(rung)
        return after

    def _begin(self, rung: int) -> None:
        self._rung = rung
        self._simulated = self._spent = self._waited = self._stayed = self._promising = 0.0
        self._left_at = math.nan


def settings_to_fall(scene: Scene, front: Tradeoffs | None) -> list[Setting]:
    """Return the settings from that of a scene to the fastest on the front of its bearing; empty where the front does not fit it where it operates.

    Each is faster than the one before by a quarter at least, and on the front of the settings that the governor can use: at the scene's own level
    or a lower one that has everything the scene asks for; without a fixed step; and with a corrected table only where it is on
    disk.  Where the scene's own setting was not measured, those of its level are used that are surely faster: at least as fast as the
    slowest that is coarser (`bearing_sim.scene.measured_tradeoffs.is_coarser`).  Levels below all measured ones follow at the end, with errors that
    are not known.

    Parameters
    ----------
    scene : that runs.
    front : what was measured of its bearing (see `bearing_sim.scene.loader.measured_of`), or None.
    """
    if front is None or not front.fits(scene) or not (front := front.at(scene)).courses:
        return []
    unknown = dict.fromkeys(front.courses[0].own_errors, math.nan)
    overrides, usable = complete_overrides(scene), (scene.level, *lower_levels(scene))
    measured = [one for one in front.settings() if one.level in usable and _is_adaptive(one) and not math.isnan(one.errors["slip"])]
    measured = [one for one in measured if not one.is_corrected or cached_table(with_setting(scene, one)) is not None]
    own = next((one for one in front.settings() if (one.level, one.overrides) == (scene.level, overrides)), None)
    settings = [own or Setting(scene.level, "as in the scene", overrides, math.nan, unknown)]
    if own is not None:
        slowest = own.real_time_factor
    else:
        faster = _surely_faster(settings[0], front)
        slowest = max((one.real_time_factor for one in measured if one.level == scene.level and one.real_time_factor < faster), default=0.0)
        measured = [one for one in measured if one.level != scene.level or one.real_time_factor >= faster]
    for one in sorted(measured, key=lambda one: (one.errors["slip"], -one.real_time_factor)):
        if one.real_time_factor >= _WORTH_A_CHANGE * slowest:
            settings.append(one)
            slowest = one.real_time_factor
    lowest = min(NUMBERS[one.level] for one in (settings[0], *measured))
    adaptive = dataclasses.replace(scene.integration, fixed_step=None)
    for level in usable:
        if NUMBERS[level] < lowest:
            lower = dataclasses.replace(scene, level=level, integration=adaptive)
            settings.append(Setting(level, "not measured", complete_overrides(lower), math.nan, unknown))
    return settings if len(settings) > 1 else []


def _surely_faster(own: Setting, front: Tradeoffs) -> float:
    """Return the real-time factor from which on settings are faster than one that was not measured: that of the slowest of its level that is coarser.

    It is infinite where none is coarser.
    """
    coarser = [one for one in front.settings() if one.level == own.level and is_coarser(one.overrides, own.overrides)]
    return min((one.real_time_factor for one in coarser), default=math.inf)


def _is_adaptive(setting: Setting) -> bool:
    return all(not each.startswith("integration.fixed_step=") or each.endswith("=null") for each in setting.overrides)


def governor_record(settings: Sequence[Setting], running: str) -> dict[str, str]:
    """Return the metadata record `RECORD` of a recording: the settings that its events name, with overrides and errors, and which one runs first."""
    stored = [
        {"name": one.name, "level": one.level, "overrides": one.overrides, "slip_error": one.errors["slip"], "life_error": one.errors["life"]}
        for one in settings
    ]
    return {"settings": json.dumps(stored), "running": running or settings[0].name}


def recorded_settings(record: Mapping[str, str]) -> tuple[dict[str, Setting], str]:
    """Return the settings of a record of `governor_record` by name, the wanted one first, and the name of the one that ran first.

    Raises
    ------
    ValueError
        The record is none of `governor_record`.
    """
    try:
        found = {str(each["name"]): Setting(each["level"], "", tuple(each["overrides"]), math.nan, {}) for each in json.loads(record["settings"])}
        return found, str(record["running"])
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"the settings of the governor in the recording cannot be read: {error!r}") from None
