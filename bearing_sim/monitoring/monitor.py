# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the bearing itself calls for: slip, life, remaining life, lambda ratio and pocket force against the scene's thresholds.

Pure: samples in, events out; the times are those of the samples.
"""

import math

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.film_ratio import FilmRatio
from bearing_sim.runtime.alarm import Alarm
from bearing_sim.runtime.blocks import joined
from bearing_sim.scene import Scene
from bearing_sim.scene_monitoring import Hold, Thresholds

_HOUR = 3600.0  # [s]
_FILM_EVERY = 0.1  # [s] a film is told no more often: of all that is judged it costs the most, and its temperature is slow


class Watch:
    """One quantity against its limit for a warning and its limit for an error.

    Parameters
    ----------
    code, subject : of its events.
    unit, factor : in which people read it, and what makes its number of that in SI.
    warning, error : limits in SI; None for none.
    hold : hysteresis and hold times of both.
    below : whether it is small values that are beyond the limits.
    """

    def __init__(
        self, code: str, subject: str, unit: str, factor: float, warning: float | None, error: float | None, hold: Hold, below: bool = False
    ):
        self.code, self._subject, self._unit, self._factor, self._below = code, subject, unit, factor, below
        self._alarms = ((Level.ERROR, Alarm(error, hold, below)), (Level.WARN, Alarm(warning, hold, below)))
        self._value = math.nan

    def judge(self, now: float, value: float) -> None:
        """Take in the value of an instant [s]."""
        self._value = value
        for _, alarm in self._alarms:
            alarm.judge(now, value)

    def is_calm(self, values: np.ndarray) -> bool:
        """Return whether nothing holds or is about to, and none of the values is beyond a limit."""
        (_, error), (_, warning) = self._alarms
        if error.is_alerted or warning.is_alerted:
            return False
        worst = float((np.fmin if self._below else np.fmax).reduce(values, axis=None, initial=math.nan))  # of those that are numbers
        return not error.reaches(worst) and not warning.reaches(worst)

    def event(self, now: float) -> Event | None:
        """Return the worse of the troubles that hold, or None."""
        for level, alarm in self._alarms:
            if alarm.raised:
                return Event(now, level, self.code, f"{self._subject}: {self._shown(self._value)} {self._relation(alarm)}")
        return None

    def _relation(self, alarm: Alarm) -> str:
        limit = self._shown(alarm.limit)
        if math.isnan(self._value):
            return f"now, after it was {'below' if self._below else 'at'} {limit} or {'less' if self._below else 'more'}"
        if self._value < alarm.limit if self._below else self._value >= alarm.limit:
            return f"is below {limit}" if self._below else f"has reached {limit}"
        back = self._shown(alarm.back_at)
        return f"is back from {'below' if self._below else 'above'} {limit}, not yet {'above' if self._below else 'below'} {back} for long enough"

    def _shown(self, value: float) -> str:
        return f"{self._factor * value:.4g} {self._unit}".rstrip()


class Monitor:
    """Judges the samples of a run.

    Parameters
    ----------
    scene : its thresholds, and its bearing and oil for the lambda ratio where the bearing has a roughness.
    """

    def __init__(self, scene: Scene):
        self._films = FilmRatio(scene) if scene.bearing.roughness is not None else None
        self.adjust(scene.thresholds)
        self._forget()

    def adjust(self, thresholds: Thresholds) -> None:
        """Judge by other thresholds from now on; hold times begin anew."""
        self._thresholds = limits = thresholds
        self._watches = {
            "slip": Watch("bearing.slip", "cage slip", "%", 100.0, limits.slip_warning, limits.slip_error, limits.slip_hold),
            "life": Watch("bearing.life", "life at the present condition", "h", 1.0, limits.life_warning, limits.life_error, limits.life_hold, True),
            "remaining": Watch(
                "bearing.remaining_life",
                "remaining life at the present rate of damage",
                "h",
                1.0,
                limits.remaining_life_warning,
                limits.remaining_life_error,
                limits.remaining_life_hold,
                True,
            ),
            "lambda": Watch("bearing.lambda", "film over roughness", "", 1.0, limits.lambda_warning, limits.lambda_error, limits.lambda_hold, True),
            "pocket": Watch(
                "bearing.pocket_force", "pocket force", "N", 1.0, limits.pocket_force_warning, limits.pocket_force_error, limits.pocket_force_hold
            ),
        }

    def restart(self) -> None:
        """Forget the run so far: state and damage have returned to the start."""
        self.adjust(self._thresholds)
        self._forget()

    def _forget(self) -> None:
        self._time, self._rate, self._damage = math.nan, math.nan, 0.0
        self._film = self._film_at = math.nan
        self._latest: dict[str, float] = {}

    def take(self, block: np.ndarray) -> None:
        """Judge a block of samples by its worst values, as of its last instant; the film by its last sample.

        Parameters
        ----------
        block : samples in order, shape (n,), n at least 1; see `bearing_sim.sample`.
        """
        now = float(block["time"][-1])
        turning = np.abs(block["shaft_speed"]) >= self._thresholds.slip_from_speed
        life = float(block["modified_rating_life"].min())
        self._latest = latest = {
            "slip": _largest(np.abs(block["cage_slip"][turning])),
            "life": life,
            "remaining": self._remaining_life(now, life, float(block["damage"][-1])),
            "pocket": _largest(np.abs(block["pocket_force"])),
        }
        if self._films is not None:
            if not abs(now - self._film_at) < _FILM_EVERY * (1 - 1e-9):
                self._film = float(self._films.least(block[-1:])[0]) if turning[-1] else math.nan
                self._film_at = now
            latest["lambda"] = self._film
        for name, value in latest.items():
            self._watches[name].judge(now, value)

    def take_all(self, blocks: list[np.ndarray]) -> None:
        """Judge blocks as `take` does one after the other, in one go where none but the last can be news."""
        if len(blocks) > 1:
            whole = joined(blocks)
            if self.is_calm(whole):
                self.take_calm(whole[: -len(blocks[-1])])
                blocks = blocks[-1:]
        for block in blocks:
            self.take(block)

    def is_calm(self, block: np.ndarray) -> bool:
        """Return whether no sample of a block could change what holds; `take_calm` then takes it in faster than `take` would sample by sample."""
        lives, limits = block["modified_rating_life"], self._thresholds
        fastest = max(1.0 / (_HOUR * float(lives.min())), 0.0 if math.isnan(self._rate) else self._rate)
        damage = float(block["damage"][-1])
        shortest = np.array([(1.0 - damage) / (_HOUR * fastest) if fastest > 0.0 else math.inf])
        turning = np.abs(block["shaft_speed"]) >= limits.slip_from_speed
        values = {
            "slip": np.abs(block["cage_slip"][turning]),
            "life": lives,
            "remaining": shortest,
            "pocket": np.abs(block["pocket_force"]),
        }
        if self._films is not None:
            values["lambda"] = self._films.least(block[turning])
        return damage < 1.0 and all(self._watches[name].is_calm(numbers) for name, numbers in values.items())

    def take_calm(self, block: np.ndarray) -> None:
        """Take in samples that are calm."""
        for time, life, damage in zip(block["time"].tolist(), block["modified_rating_life"].tolist(), block["damage"].tolist()):
            self._remaining_life(time, life, damage)

    def events(self, now: float) -> list[Event]:
        """Return what holds, as of ``now`` [s]."""
        events = [event for watch in self._watches.values() if (event := watch.event(now)) is not None]
        if self._damage >= 1.0:
            events.append(Event(now, Level.ERROR, "bearing.life_used", f"damage: {self._damage:.3g} of the rating life is used up"))
        return events

    @property
    def values(self) -> dict[str, float]:
        """The numbers that only the monitor knows, the unit in each key; empty before the first sample."""
        names = {"remaining": "remaining life [h]", "lambda": "film over roughness, lambda", "pocket": "largest pocket force [N]"}
        return {shown: self._latest[name] for name, shown in names.items() if name in self._latest}

    def _remaining_life(self, now: float, life: float, damage: float) -> float:
        """Return (1 - D)/(dD/dt) [h], the rate dD/dt = 1/L a fading mean: of a life that swings the damage counts 1/L."""
        rate, elapsed = 1.0 / (_HOUR * life), now - self._time
        share = 1.0 - math.exp(-elapsed / self._thresholds.remaining_life_memory) if elapsed >= 0.0 else 1.0
        self._rate = rate if math.isnan(self._rate) else self._rate + share * (rate - self._rate)
        self._time, self._damage = now, damage
        if damage >= 1.0:
            return 0.0
        return (1.0 - damage) / (_HOUR * self._rate) if self._rate > 0.0 else math.inf


def _largest(values: np.ndarray) -> float:
    """Return the largest number among values; NaN where there is none."""
    return float(np.fmax.reduce(values, axis=None, initial=math.nan))
