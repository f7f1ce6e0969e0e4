# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compare the samples of a run with the scene's thresholds: slip, life, remaining life, lambda, pocket force, clearance.

Samples in, events out.  All times are those of the samples.
"""

import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.messages.events import Event, Level, Record
from bearing_sim.model.turning import turns
from bearing_sim.scene.scene import Hold, Scene, Thresholds
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm
from bearing_sim.watchers.monitoring.watchers import Watcher

_HOUR = 3600.0  # [s]
_TOGETHER = 0.01  # [s] over which samples are judged by their worst values
_FILM_EVERY = 0.1  # [s] least time between two films: they cost more than all other checks, and follow the slow oil temperature


class Alarm:
    """One value against one limit, with hysteresis and hold times, so that a flickering value raises one alarm.

    Hysteresis: a value is beyond from the limit on, and back only after it has returned by a fraction of the limit.
    Hold times: the alarm is raised after the value has been beyond for a while, and cleared after it has been back for a while.
    A value that is NaN counts as back.

    Parameters
    ----------
    limit : the value must stay short of it; None for no limit.
    hold : hysteresis and hold times.
    below : whether values below the limit are beyond it, rather than values from the limit upwards.

    Attributes
    ----------
    limit : float or None
    raised : bool
        Whether the alarm is raised.
    """

    def __init__(self, limit: float | None, hold: Hold, below: bool = False):
        self.limit, self._hold, self._below = limit, hold, below
        self.restart()

    def restart(self) -> None:
        """Return to the initial state: not raised, value not beyond."""
        self.raised, self._beyond, self._turned = False, False, 0.0

    @property
    def back_at(self) -> float:
        """The value at which the alarm counts as back."""
        margin = self._hold.hysteresis * abs(self.limit)
        return self.limit + margin if self._below else self.limit - margin

    @property
    def is_pending(self) -> bool:
        """Whether the alarm is raised or the value is beyond the limit."""
        return self.raised or self._beyond

    def reaches(self, value: float) -> bool:
        """Return whether a value is beyond the limit."""
        return self.limit is not None and (value < self.limit if self._below else value >= self.limit)

    def judge(self, now: float, value: float) -> bool:
        """Take the value at an instant, no earlier than the last one.  Return whether the alarm is raised.

        Parameters
        ----------
        now : [s].
        value : in the limit's unit.
        """
        limit = self.limit
        if limit is None:
            return False
        border = self.back_at if self._beyond else limit
        beyond = value < border if self._below else value >= border
        if beyond != self._beyond:
            self._beyond, self._turned = beyond, now
        if beyond and not self.raised and now - self._turned >= self._hold.raise_after:
            self.raised = True
        elif not beyond and self.raised and now - self._turned >= self._hold.clear_after:
            self.raised = False
        return self.raised


class Watch:
    """One quantity against its warning limit and its error limit.

    Parameters
    ----------
    kind, subject : of its events.
    unit, factor : unit shown to people, and the factor from SI to that unit.
    warning, error : limits in SI; None for none.
    hold : hysteresis and hold times of both limits.
    below : whether small values are the bad ones.
    """

    def __init__(
        self, kind: str, subject: str, unit: str, factor: float, warning: float | None, error: float | None, hold: Hold, below: bool = False
    ):
        self.kind, self._subject, self._unit, self._factor, self._below = kind, subject, unit, factor, below
        self._alarms = ((Level.ERROR, Alarm(error, hold, below)), (Level.WARN, Alarm(warning, hold, below)))
        self._raised_at: dict[Level, float] = {}  # the value with which each alarm was raised

    def judge(self, now: float, value: float) -> None:
        """Take the value at an instant [s]."""
        for level, alarm in self._alarms:
            if alarm.limit is not None and not alarm.raised and alarm.judge(now, value):
                self._raised_at[level] = value
            elif alarm.limit is not None:
                alarm.judge(now, value)

    def is_calm(self, values: np.ndarray) -> bool:
        """Return whether no alarm is raised or pending, and none of the values is beyond a limit."""
        worst = float((np.fmin if self._below else np.fmax).reduce(values, axis=None, initial=math.nan))  # NaN entries are ignored
        return not any(alarm.limit is not None and (alarm.is_pending or alarm.reaches(worst)) for _, alarm in self._alarms)

    def event(self, now: float) -> Event | None:
        """Return the event of the more severe alarm that is raised, or None; its text has the value with which that was raised, and stays."""
        for level, alarm in self._alarms:
            if alarm.raised:
                relation = "is below" if self._below else "has reached"
                return Event(now, level, self.kind, self._subject, f"{self._shown(self._raised_at[level])} {relation} {self._shown(alarm.limit)}")
        return None

    def _shown(self, value: float) -> str:
        return f"{self._factor * value:.4g} {self._unit}".rstrip()


class Monitor(Watcher):
    """Compares the samples of a run with thresholds.

    Parameters
    ----------
    scene : provides the thresholds, and the bearing and its oil for the lambda ratio if the bearing has a roughness.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene)
        self._films = ThinnestFilm(scene)
        self._symbol = scene.life.symbols[0 if scene.life.is_basic else 1]
        self.adjust(scene.thresholds)
        self._forget()

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on; hold times start again."""
        super().adjust(thresholds)
        self._thresholds = t = thresholds
        self._watches = {
            "slip": Watch("bearing.slip", "cage slip", "%", 100.0, t.slip_warning, t.slip_error, t.slip_hold),
            "life": Watch(
                "bearing.life",
                f"life at the present condition, {self._symbol}",
                "h",
                1.0,
                t.life_warning,
                t.life_error,
                t.life_hold,
                True,
            ),
            "remaining": Watch(
                "bearing.remaining_life",
                f"remaining life at the present rate of damage, by {self._symbol}",
                "h",
                1.0,
                t.remaining_life_warning,
                t.remaining_life_error,
                t.remaining_life_hold,
                True,
            ),
            "lambda": Watch("bearing.lambda", "film over roughness", "", 1.0, t.lambda_warning, t.lambda_error, t.lambda_hold, True),
            "pocket": Watch("bearing.pocket_force", "pocket force", "N", 1.0, t.pocket_force_warning, t.pocket_force_error, t.pocket_force_hold),
            "clearance": Watch("bearing.clearance", "running clearance", "um", 1e6, t.clearance_warning, t.clearance_error, t.clearance_hold, True),
        }

    def restart(self, why: str = "") -> None:
        """Forget the run so far, after state and damage have returned to the start."""
        self.adjust(self._thresholds)
        self._forget()

    def _forget(self) -> None:
        self._time, self._rate, self._damage = math.nan, math.nan, 0.0
        self._film = self._film_at = math.nan
        self._film_of: np.ndarray | None = None  # the sample whose film has not been computed yet
        self._latest: dict[str, float] = {}
        self._calm: np.ndarray | None = None  # the block that is known to be calm

    def judge(self, block: np.ndarray) -> None:
        """Judge a block of samples by its worst values, at its last instant; the film by its last sample.

        Parameters
        ----------
        block : samples in order, shape (n,), n at least 1; see `bearing_sim.model.sample`.
        """
        now = float(block["time"][-1])
        turning = turns(block["shaft_speed"], self._thresholds.slip_from_speed)
        life = float(block["modified_rating_life"].min())
        self._latest = latest = {
            "slip": float(np.fmax.reduce(np.abs(block["cage_slip"][turning]), initial=math.nan)),
            "life": life,
            "remaining": self._remaining_life(now, life, float(block["damage"][-1])),
            "pocket": float(np.fmax.reduce(np.abs(block["pocket_force"]), axis=None, initial=math.nan)),
            "clearance": float(np.fmin.reduce(block["running_clearance"], initial=math.nan)),
        }
        if not abs(now - self._film_at) < _FILM_EVERY * (1 - 1e-9):
            self._film, self._film_at = math.nan, now
            self._film_of = block[-1:].copy() if turning[-1] else None
        if not math.isnan(self._films.roughness):
            latest["lambda"] = self._least_film() / self._films.roughness
        for name, value in latest.items():
            self._watches[name].judge(now, value)

    def see(self, block: np.ndarray) -> Sequence[Record]:
        """Judge samples: those of each hundredth of a second together, or all in one go if none of them can raise or clear an alarm."""
        if len(block) > 1 and (block is self._calm or self.is_calm(block)):
            self.judge_calm(block[:-1])
            block = block[-1:]
        for part in np.split(block, np.flatnonzero(np.diff(np.floor(block["time"] / _TOGETHER + 1e-6))) + 1) if len(block) > 1 else [block]:
            self.judge(part)
        return ()

    def is_calm(self, block: np.ndarray) -> bool:
        """Return whether no sample of a block can raise or clear an alarm; `judge_calm` then replaces `judge` sample by sample."""
        is_calm = self._has_no_alarm(block)
        self._calm = block if is_calm else None
        return is_calm

    def _has_no_alarm(self, block: np.ndarray) -> bool:
        lives, limits = block["modified_rating_life"], self._thresholds
        fastest = max(1.0 / (_HOUR * float(lives.min())), 0.0 if math.isnan(self._rate) else self._rate)
        damage = float(block["damage"][-1])
        shortest = np.array([(1.0 - damage) / (_HOUR * fastest) if fastest > 0.0 else math.inf])
        turning = turns(block["shaft_speed"], limits.slip_from_speed)
        values = {
            "slip": np.abs(block["cage_slip"][turning]),
            "life": lives,
            "remaining": shortest,
            "pocket": np.abs(block["pocket_force"]),
            "clearance": block["running_clearance"],
        }
        if not math.isnan(self._films.roughness):
            values["lambda"] = self._films.least(block[turning]) / self._films.roughness
        return damage < 1.0 and all(self._watches[name].is_calm(numbers) for name, numbers in values.items())

    def judge_calm(self, block: np.ndarray) -> None:
        """Judge samples for which `is_calm` is true."""
        for time, life, damage in zip(block["time"].tolist(), block["modified_rating_life"].tolist(), block["damage"].tolist()):
            self._remaining_life(time, life, damage)

    def events(self, now: float) -> list[Event]:
        """Return the events that hold, stamped ``now`` [s]."""
        events = [event for watch in self._watches.values() if (event := watch.event(now)) is not None]
        if self._damage >= 1.0:
            events.append(Event(now, Level.ERROR, "bearing.life_used", "damage", "the rating life is used up"))
        return events

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values that only the monitor computes, with the unit in each key; empty before the first sample."""
        names = {"remaining": "remaining life [h]", "lambda": "film over roughness, lambda", "pocket": "largest pocket force [N]"}
        values = {shown: self._latest[name] for name, shown in names.items() if name in self._latest}
        return values | ({"film [m]": self._least_film()} if self._latest else {})

    def _least_film(self) -> float:
        """Return the film of the newest sample that is due [m]; computed when somebody asks, because it takes longer than all other values."""
        if self._film_of is not None:
            self._film, self._film_of = float(self._films.least(self._film_of)[0]), None
        return self._film

    def _remaining_life(self, now: float, life: float, damage: float) -> float:
        """Return (1 - D)/(dD/dt) [h] with dD/dt the fading mean of 1/L: damage accumulates 1/L, not L, where the life L fluctuates."""
        rate, elapsed = 1.0 / (_HOUR * life), now - self._time
        weight = 1.0 - math.exp(-elapsed / self._thresholds.remaining_life_memory) if elapsed >= 0.0 else 1.0
        self._rate = rate if math.isnan(self._rate) else self._rate + weight * (rate - self._rate)
        self._time, self._damage = now, damage
        if damage >= 1.0:
            return 0.0
        return (1.0 - damage) / (_HOUR * self._rate) if self._rate > 0.0 else math.inf
