# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keeps the state of a bearing while its model runs: counts samples, and writes the state every few seconds on a thread of its own.

A slow disk stalls nothing but that thread.  A state is written only once its samples have been published, so that nobody has seen less than
what a restart continues from.
"""

import json
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from bearing_sim.messages.events import Event, Level
from bearing_sim.model.sample import NODE_OBSERVABLES, RING_TEMPERATURES, joined
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.watchers.monitoring.watchers import BUILT_IN, MEMORY, Memory, Watcher
from bearing_sim.watchers.stored_state.counting import LifeCounter
from bearing_sim.watchers.stored_state.covered import Covered
from bearing_sim.watchers.stored_state.history import history_paths, move_days
from bearing_sim.watchers.stored_state.state import StoredState, Thermal, calibration_of, day_of, new_state, time_text
from bearing_sim.watchers.stored_state.state_file import News, StateError, StateFile, checked_serial, default_path, parsed, serialised
from bearing_sim.watchers.stored_state.totals import criteria

RECORD = BUILT_IN[MEMORY].record
"""Name of a recording's metadata record with the state that it began with: state, as in a state file, and counts."""

WRITE_EVERY = 2.0
"""[s of wall time] from one write to the next: 10 s are promised, and a busy machine or a slow disk may take most of them."""

_LATE = 10.0  # [s] that are not written after which it is reported that a kill would lose more than was promised
_UNPUBLISHED = 1.0  # [s] that a state waits for its samples to be published, at most
_WARM_FOR = 600.0  # [s] *assumption*: a bearing that was seen warm ten minutes ago still is
_TOGETHER = 256  # blocks of a log that are counted at once
_CLOSE_WITHIN = 5.0  # [s] for the last write
_MOVE_AGAIN = 3600.0  # [s] after a move of days to the history that failed


class _StateMemory(Memory):
    """What remembers a bearing by its state."""

    state: StoredState

    def remind(self, name: str, watcher: Watcher) -> None:
        """Let a watcher continue from what it has learned; from nothing if another version of it had learned it.

        How long that is ago is known where the run knows its clock.
        """
        try:
            watcher.recall(self.state.learned.get(name, {}), max(self.run.start_ns - self.state.until_ns, 0) * 1e-9)
        except (KeyError, TypeError, ValueError):
            watcher.recall({}, 0.0)


class RecordedState(_StateMemory):
    """The state with which the bearing of a recorded run began: adds the life used before where the run is computed again.

    Parameters
    ----------
    scene : of the run.
    state : at its start.
    once : whether the run did not count times that the state contains.
    """

    def __init__(self, scene: Scene, state: StoredState, once: bool):
        super().__init__(scene)
        self.state, self._covered = state, state.covered if once else None
        self._counter = LifeCounter(state.totals.damage, self._covered)

    @property
    def life_used(self) -> float:
        """At the start of the run."""
        return self.state.totals.damage

    def correct(self, block: np.ndarray, seconds: np.ndarray) -> None:
        """Write the life used into samples."""
        self._counter.count(block, _times_ns(block, self.run.start_ns), seconds)

    def continue_from(self, life_used: float) -> None:
        """Count from what the recorded run had used where it was reset."""
        self._counter.restart(life_used)

    def contained(self, time_ns: int) -> bool:
        """Return whether the state contained an instant [ns since the epoch]."""
        return self._covered is not None and time_ns in self._covered


class StateKeeper(_StateMemory):
    """The state of one bearing in use.

    All methods belong to one thread; the files are written by another.

    Parameters
    ----------
    path : of the state file.
    scene : of the bearing.
    serial : its number; ``""`` where none is given.
    once : whether times that the state contains are not counted again, as for logs; a bearing that runs now counts whatever the clock says.
    fills : whether only gaps in the past are filled: calibration, and what was learned, stay as they are.
    clock : wall clock [s], monotonic.
    now_ns : wall clock [ns since the epoch].

    Attributes
    ----------
    path : of its file.

    Raises
    ------
    StateError
        The state is another bearing's, in use, or not good.
    """

    goes_by_wall = True
    checked = staticmethod(checked_serial)

    def __init__(
        self,
        path: str | Path,
        scene: Scene,
        serial: str,
        once: bool = False,
        fills: bool = False,
        clock: Callable[[], float] = time.monotonic,
        now_ns: Callable[[], int] = time.time_ns,
    ):
        super().__init__(scene)
        self._file, self._once, self._clock, self._now_ns = StateFile(path), once, clock, now_ns
        self.path = self._file.path
        try:
            state, news = self._file.read()
            self._state = new_state(scene, serial, now_ns()) if state is None else state
            self._pending: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]] = []  # arguments of `StoredState.accumulate`
            self._require_same(scene, serial)
        except Exception:
            self._file.close()
            raise
        self._news: list[News] = news
        if not fills:
            self._begin(scene, serial, is_new=state is None)
        self._by = criteria(scene)
        self._counter = LifeCounter(self.state.totals.damage)
        self._last_time: float | None = None
        self._changed = threading.Condition()
        self._waiting: tuple[StoredState, float] | None = None  # to be written, and when it was like that
        self._unsaved_since: float | None = None
        self._has_changed = state is None
        self._held: tuple[float, float, StoredState] | None = None  # until it is published
        self._error, self._history_error, self._is_writing = "", "", False
        self._moved: tuple[dict, int] | None = None
        self._stopping, self._thread = False, None
        self._written_at = self._due_from = clock()
        self._move_from = -np.inf
        self._said_csv = False
        self._newest: np.void | None = None  # that is counted
        self.restart()

    @classmethod
    def of_bearing(cls, scene: Scene, serial: str, path: str, is_simulated: bool) -> "StateKeeper | None":
        """Return the state of a bearing that is to be remembered; None where nothing is: without a serial number or file, in simulated time a file.

        Raises
        ------
        OSError
            It cannot be used.
        """
        serial = checked_serial(serial)
        if not path and (is_simulated or not serial):
            return None
        return cls(path or default_path(serial), scene, serial, once=is_simulated)

    def _require_same(self, scene: Scene, serial: str) -> None:
        if found := self.state.differences(scene, serial):
            whose = f"of serial number {self.state.serial!r}" if self.state.serial else "without a serial number"
            raise StateError(
                f"the state file {self.path} {whose} belongs to another bearing or scene: {', '.join(found)}; give its own scene and serial number, "
                "or another state file; for a new bearing in the machine set serial and call ~/replace_bearing while the node runs with the old one; "
                "after a correction of the scene run bearing-sim state adopt"
            )

    def _begin(self, scene: Scene, serial: str, is_new: bool) -> None:
        """Say what the state continues from, and take what has changed since."""
        state, calibration = self.state, calibration_of(scene)
        named = f"serial number {serial or state.serial}" if serial or state.serial else "a bearing without a serial number"
        if is_new:
            self._note(Level.OK, "state.begun", f"{named}: a new state begins in {self.path}")
        else:
            hours = state.totals.running_seconds / 3600.0
            since = f", of {time_text(state.written_ns)}" if state.written_ns else ""
            text = (
                f"{named}: continues at {100.0 * state.totals.damage:.6g} % of life used, {hours:.6g} h running, {state.totals.starts} starts{since}"
            )
            self._note(Level.OK, "state.continued", text)
        if state.calibration and state.calibration != calibration:
            changed = ", ".join(f"{name} {value:g}" for name, value in calibration.items() if state.calibration.get(name) != value) or "fewer fields"
            self._note(Level.OK, "state.recalibrated", f"the scene was calibrated since: {changed}; what was learned about residuals is forgotten")
            state.learned = {}
        if state.retired_ns is not None:
            self._note(Level.WARN, "state.returned", f"{named} was taken out on {time_text(state.retired_ns)} and is in service again")
        if not self._file.has_lock:
            self._note(Level.WARN, "state.unlocked", f"the file system of {self.path} has no locks: no other node may use this state")
        state.calibration, state.retired_ns = calibration, None
        state.adopt(scene, serial)

    def _note(self, level: Level, kind: str, text: str) -> None:
        self._news.append(News(level, kind, text))

    @property
    def state(self) -> StoredState:
        """The state as counted so far."""
        self._count_pending()
        return self._state

    @property
    def serial(self) -> str:
        """Serial number of the bearing."""
        return self.state.serial

    @property
    def remark(self) -> str:
        """The path of its file."""
        return str(self.path)

    def begin(self) -> None:
        """Begin a run, and let the other watchers continue from what they have learned about the bearing."""
        self.restart()
        self._newest = None
        super().begin()

    @classmethod
    def recorded(cls, scene: Scene, record: Mapping[str, str]) -> "RecordedState":
        """Return the state with which the bearing of a recorded run began."""
        try:
            return RecordedState(scene, parsed(record["state"].encode()), record.get("counts") == "once")
        except (KeyError, ValueError, OSError) as error:
            raise ValueError(f"the stored state in the recording cannot be used: {error}; replay its inputs with --scene instead") from None

    def serve(self, service: str) -> tuple[bool, str] | None:
        """Answer with the state as JSON: totals, calibration, temperatures."""
        return (True, json.dumps(self.summary())) if service == "get_stored_state" else None

    @property
    def life_used(self) -> float:
        """See `used`."""
        return self.used

    @property
    def used(self) -> float:
        """Fraction of the life used so far."""
        return self.state.totals.damage

    @property
    def record(self) -> dict[str, str]:
        """The metadata record of a recording that begins now."""
        return {"state": serialised(self.state).decode(), "counts": "once" if self._once else "always"}

    @property
    def records(self) -> dict[str, dict[str, str]]:
        """The record by its name."""
        return {RECORD: self.record}

    def temperatures(self, now_ns: int) -> tuple[list[float], list[float]] | None:
        """Return those that the bearing is remembered with."""
        thermal = self.thermal(now_ns)
        return None if thermal is None else (thermal.nodes, thermal.rings)

    def thermal(self, now_ns: int) -> Thermal | None:
        """Return the temperatures to begin with at an instant [ns since the epoch]; None where there are none of the last ten minutes."""
        thermal = self.state.thermal
        if thermal is None or not 0 <= now_ns - thermal.time_ns <= 1e9 * _WARM_FOR:
            return None
        return thermal

    def restart(self, why: str = "") -> None:
        """Begin another run, or continue after a reset: its damage begins at 0 again."""
        self._before = self.state.covered.copy() if self._once else Covered()
        self._counter = LifeCounter(self.used, self._before if self._once else None)
        self._last_time = None

    def contained(self, time_ns: int) -> bool:
        """Return whether the state contained an instant [ns since the epoch] before this run, so that nothing of it counts again."""
        return time_ns in self._before

    def correct(self, block: np.ndarray, seconds: np.ndarray) -> None:
        """Count samples, and write the life used into those of which the run itself does not know it."""
        if self.run.acts_on_arrival:
            self.count_live(block, self.run.starts_ns, self.run.interval)
        else:
            self.count(block, self.run.start_ns, seconds)
        if seconds.any():
            self._newest = block[-1]
        if not self.run.is_reviewed:
            self._write_if_due()

    def count(self, block: np.ndarray, start_ns: int, seconds: np.ndarray) -> None:
        """Count samples of a log: write the life used into them, without times that the state contains already.

        Parameters
        ----------
        block : samples in order, shape (n,); their damage is that of the run.
        start_ns : time 0 of the samples [ns since the epoch].
        seconds : simulated time that each stands for [s], shape (n,); 0 at the start of a run.
        """
        times_ns = _times_ns(block, start_ns)
        self._note_change()
        counted = self._counter.count(block, times_ns, seconds)
        self._pending.append((block, times_ns, seconds, counted))
        if len(self._pending) >= _TOGETHER:
            self._count_pending()

    def _count_pending(self) -> None:
        """Count samples together: many cost little more than one."""
        pending, self._pending = self._pending, []
        if pending:
            blocks, times_ns, seconds, counted = zip(*pending)
            all_count = all(each is None for each in counted)
            fractions = None if all_count else np.concatenate([np.ones(len(b)) if each is None else each for b, each in zip(blocks, counted)])
            self._state.accumulate(joined(blocks), np.concatenate(times_ns), np.concatenate(seconds), self._by, fractions)

    def count_live(self, block: np.ndarray, starts_ns: tuple[int, ...], interval: float) -> None:
        """Count samples of a bearing that runs now.

        Parameters
        ----------
        block : samples in order, shape (n,); their damage is the life used.
        starts_ns : time 0 of the samples by the clock [ns since the epoch], and by the clock before it was set, which recordings go by.
        interval : between two samples if no time was skipped [s].
        """
        self._note_change()
        steps = np.diff(block["time"], prepend=block["time"][0] if self._last_time is None else self._last_time)
        self._last_time = float(block["time"][-1])
        seconds = np.where(steps > 1.5 * interval, interval, np.maximum(steps, 0.0))
        times_ns = _times_ns(block, starts_ns[0])
        self.state.accumulate(block, times_ns, seconds, self._by)
        for other in starts_ns[1:]:
            for begin, end in zip((times_ns - np.rint(1e9 * seconds).astype(np.int64)).tolist(), times_ns.tolist()):
                self.state.covered.cover(begin - starts_ns[0] + other, end - starts_ns[0] + other)

    def _note_change(self) -> None:
        self._has_changed = True
        if self._unsaved_since is None:
            self._unsaved_since = self._clock()

    def adjust(self, thresholds: Thresholds) -> None:
        """Class samples by other thresholds from now on."""
        super().adjust(thresholds)
        self._count_pending()
        self._by = criteria(self.scene)

    def _write_if_due(self) -> None:
        """Have the state written from time to time."""
        self.release(self.run.published_until)
        if self.is_due and self._newest is not None:
            self.note_condition()
            self.hold(float(self._newest["time"]))

    def note_condition(self) -> None:
        """Take the temperatures of the newest sample, and what the other watchers of the run have learned."""
        if self._newest is None:
            return
        time_ns, watchers = self.run.stamp(float(self._newest["time"])), self.run.watchers
        self.note_thermal(self._newest, time_ns)
        known = {name: watcher.learned for name in BUILT_IN if (watcher := watchers.get(name)) is not None and watcher.learned is not None}
        self.state.learned = self.state.learned | known  # a run without one of them keeps what another run has learned
        self.state.note_estimates(time_ns, {field: bounds for watcher in watchers for field, bounds in watcher.estimates.items()})

    def note_thermal(self, sample: np.void, time_ns: int) -> None:
        """Take the temperatures of a sample, if it has those of a thermal network."""
        nodes = [float(sample[name]) for name in NODE_OBSERVABLES]
        rings = [float(sample[f"{name}_uncorrected"]) for name in RING_TEMPERATURES]
        if np.isfinite([*nodes, *rings]).all():
            self.state.thermal = Thermal(time_ns, nodes, rings)

    @property
    def is_due(self) -> bool:
        """Whether the state is to be written, see `hold`."""
        return self._has_changed and self._held is None and self._clock() >= self._due_from

    def hold(self, newest: float) -> None:
        """Have the state written as it is now, once its samples up to the ``newest`` [s] are published."""
        self._due_from = self._clock() + WRITE_EVERY
        self._forget_moved()
        self._held = newest, self._clock(), self._snapshot()

    def release(self, published: float) -> None:
        """Write the state that is held if samples have been published up to this time [s], or nobody publishes them as often."""
        if self._held is not None and (published >= self._held[0] or self._clock() - self._held[1] > _UNPUBLISHED):
            self._hand_over(self._held[2], self._held[1])
            self._held = None

    def events(self, now: float) -> list[Event]:
        """Return what is wrong with the state at ``now`` [s], for as long as it is wrong."""
        events, unsaved = [], 0.0 if self._unsaved_since is None else self._clock() - self._unsaved_since
        if self._error:
            reason = f"{self.path} cannot be written: {self._error}"
            events.append(Event(now, Level.ERROR, "state.not_written", "", reason, "the model continues, and writing is tried again"))
        elif unsaved > _LATE:
            reason = f"{self.path} was not written for more than {_LATE:g} s, which a kill would lose: the disk or the machine is too slow"
            events.append(Event(now, Level.WARN, "state.late", "", reason))
        if self._history_error:
            events.append(Event(now, Level.WARN, "state.history", "", self._history_error, "days stay in the state until they can be moved"))
        return events

    def news(self, now: float) -> list[Event]:
        """Return what has happened to the state since the last call, stamped ``now`` [s]."""
        if self.run.is_reviewed:
            self._write_if_due()
        news, self._news = self._news, []
        return [Event(now, each.level, each.kind, "", each.text) for each in news]

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values, the unit in each key."""
        totals = self.state.totals
        return {
            "serial number": self.state.serial or "none",
            "running [h]": totals.running_seconds / 3600.0,
            "revolutions": totals.revolutions,
            "starts": totals.starts,
            "state written [s ago]": self._clock() - self._written_at,
        }

    def summary(self) -> dict[str, object]:
        """Return the state for people and programs, without the times that it contains and what was learned."""
        contents = self.state.as_mapping()
        for name in ("covered", "learned", "folds", "estimates"):
            del contents[name]
        return contents | {"file": str(self.path)}

    def save(self, timeout: float = _CLOSE_WITHIN) -> bool:
        """Write the state now and wait for it; return whether it was written within ``timeout`` [s]."""
        self._held = None
        self._forget_moved()
        self._hand_over(self._snapshot(), self._clock())
        with self._changed:
            done = self._changed.wait_for(lambda: self._waiting is None and not self._is_writing, timeout)
        self._due_from = self._clock() + WRITE_EVERY
        return done and not self._error

    def retire(self, into_archive: bool) -> Path:
        """Write the last state of a bearing that is taken out, let others use its file, and return where it is.

        Parameters
        ----------
        into_archive : whether the file is moved to a name with serial number and time, so that another state can begin at its name.

        Raises
        ------
        OSError
            The file cannot be written or moved.
        """
        self.state.retired_ns = self._now_ns()
        if not self.save():
            self.state.retired_ns = None
            raise OSError(f"the state {self.path} cannot be written: {self._error or 'the disk does not answer'}; nothing was changed")
        self._stop()
        path = self._file.archive(self.state.serial, self.state.retired_ns) if into_archive else self.path
        self._file.close()
        return path

    def abandon(self) -> None:
        """Let others use the file, which stays as it was written last."""
        self._stop()
        self._file.close()

    def close(self) -> None:
        """End with a run; the state stays in use until `leave`."""
        self.note_condition()
        if self.run.is_reviewed:
            self.save()

    def leave(self) -> bool:
        """Write the state and let others use its file; return whether it was written."""
        written = self.save()
        if self._stop():
            self._file.close()
        return written

    def _snapshot(self) -> StoredState:
        self._has_changed = False
        self.state.writes += 1
        self.state.written_ns = self._now_ns()
        return self.state.copy()

    def _hand_over(self, snapshot: StoredState, taken: float) -> None:
        with self._changed:
            self._waiting = snapshot, taken
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="bearing-state", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def _stop(self) -> bool:
        with self._changed:
            self._stopping = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join(_CLOSE_WITHIN)
            return not self._thread.is_alive()
        return True

    def _forget_moved(self) -> None:
        """Forget the days that are in the history now."""
        moved, self._moved = self._moved, None
        if moved is not None:
            days, self.state.folds = moved
            for day, totals in days.items():
                if self.state.days[day] == totals:
                    del self.state.days[day]
                else:  # a clock that was set back has added to it since
                    self.state.days[day].subtract(totals)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting is not None or self._stopping)
                if self._waiting is None:
                    return
                (snapshot, taken), self._waiting, self._is_writing = self._waiting, None, True
            try:
                self._file.write(snapshot)
                self._error, self._written_at, self._unsaved_since = "", self._clock(), taken if self._has_changed else None
            except (OSError, ValueError) as error:
                self._error, self._has_changed = str(error), True
            with self._changed:
                self._is_writing = False
                self._changed.notify_all()
            if not self._error and not self._stopping:
                self._move_days(snapshot)

    def _move_days(self, written: StoredState) -> None:
        """Move the days that are over to the history."""
        today = day_of(written.until_ns)
        over = {day: totals for day, totals in written.days.items() if day != today}
        if not over or self._moved is not None or self._clock() < self._move_from:
            return
        try:
            is_parquet = move_days(self.path, over, written.folds + 1)
        except OSError as error:
            self._history_error, self._move_from = str(error), self._clock() + _MOVE_AGAIN
            return
        self._history_error = ""
        self._moved = over, written.folds + 1
        if not is_parquet and not self._said_csv:
            self._said_csv = True
            self._note(Level.OK, "state.history", f"pyarrow is not installed: the history of days is {history_paths(self.path)[1]}")


def _times_ns(block: np.ndarray, start_ns: int) -> np.ndarray:
    return start_ns + np.rint(block["time"] * 1e9).astype(np.int64)
