# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A cage tachometer made of an accelerometer: blocks of samples in, measured cage speeds with standard errors out, while time passes.

Blocks are joined to windows without gaps.  A window is analysed in a process of its own, one at a time and at most one waiting, so that the model
is never held up; what is lost, late, refused or left out is counted and said.
"""

import math
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping

import numpy as np

from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import MEASURED
from bearing_sim.recording.priority import with_low_priority
from bearing_sim.scene.scene import Scene
from bearing_sim.watchers.monitoring.watchers import Watcher
from bearing_sim.watchers.vibration.analysis import Geometry
from bearing_sim.watchers.vibration.reading import Block, block_of
from bearing_sim.watchers.vibration.worker import Outcome, Window

TOPIC = "vibration"
_NICENESS = 10
_LARGEST_WINDOW = 20_000_000  # samples: 160 MB, and as much again for each of its spectra
_LONGEST_BLOCK = 10_000_000  # samples
_LATE = 0.5  # [s] by which blocks may be later than their samples last, beside twice the length of a block
_UNEVEN = 0.1  # by which the time in which a window arrives may differ from what its rate says
_SEQUENCES = 2**32  # after as many blocks their numbers begin again
_ENDS_WITHIN = 2.0  # [s]
_MOST_SLIP = 0.95  # that is looked for, whatever the model says


class CageSpeedMeter(Watcher):
    """Finds the cage speed in blocks of vibration.

    All methods belong to one thread; windows are analysed elsewhere.

    Parameters
    ----------
    scene : its block ``vibration`` says how; its bearing has the geometry.
    analysed : ``analysed(window)`` returns the outcome, on a thread of the meter; by default in a process of low priority.

    Attributes
    ----------
    last : what the last window showed.
    """

    remark = "its blocks are analysed"

    def __init__(self, scene: Scene, analysed: Callable[[Window], Outcome] | None = None):
        super().__init__(scene)
        self._news: list[Event] = []
        self._settings, roller = scene.vibration, scene.bearing.roller
        size, slip = roller.diameter / scene.bearing.pitch_diameter, scene.vibration.largest_slip
        self._geometry = Geometry(roller.count, size, name=scene.bearing.name, largest_slip=slip)
        self._process = None if analysed is not None else _Process()
        self._analysed = self._process.analysed if self._process is not None else analysed
        self._waiting: queue.Queue[Window | None] = queue.Queue(1)
        self._outcomes: queue.Queue[Outcome | str] = queue.Queue()
        self._counts = {"blocks": 0, "blocks refused": 0, "blocks lost": 0, "windows": 0, "windows left out": 0, "windows without a claim": 0}
        self.last = "no window is complete yet"
        self._sequence: int | None = None
        self._thread: threading.Thread | None = None
        self._begin()

    def _begin(self) -> None:
        self._samples: list[np.ndarray] = []
        self._speeds: list[float] = []
        self._count, self._rate, self._slip = 0, math.nan, 0.0
        self._first = self._newest = math.nan  # arrivals of the first and the newest block [s]

    def hear(self, channel: str, time: float, value, standard_error: float) -> None:
        """Take a message with a block, or why it cannot be read as one."""
        if channel != TOPIC:
            return
        try:
            if isinstance(value, str):
                raise ValueError(value)
            block = block_of(value)
        except Exception as error:  # its type depends on the middleware
            self._news.append(self.refuse(f"the message is no block of samples: {' '.join(str(error).split())}", time))
            return
        run = self.run
        slips = [float(run.newest_bands.numbers[-1, run.newest_bands.names.index("cage_slip"), 2])] if run.newest_bands is not None else []
        slips += [float(run.newest["cage_slip"])] if run.newest is not None else []
        self._news += self.receive(block, time, run.shaft_speed, max(filter(math.isfinite, slips), default=0.0))

    def news(self, now: float) -> list[Event]:
        """Return what was wrong with blocks since the last call."""
        news, self._news = self._news, []
        return news

    def measured(self) -> list[tuple[str, tuple[float, float]]]:
        """Return the cage speeds found since the last call, with their standard errors."""
        return [(MEASURED, reading) for reading in self.readings(self.run.shaft_speed)]

    def receive(self, block: Block, now: float, shaft_speed: float, slip: float = 0.0) -> list[Event]:
        """Receive a block at run time ``now`` [s]; return what is wrong with it or with those before.

        Parameters
        ----------
        shaft_speed : measured now [rad/s]; NaN before the first measurement.
        slip : of the cage that the model holds possible now, the upper end of its band; lines are looked for up to this and the scene's.
        """
        rate = block.rate if math.isfinite(block.rate) else self._settings.rate
        reason = self._reason_to_refuse(block, rate, shaft_speed)
        if reason:
            return [self.refuse(reason, now)]
        self._counts["blocks"] += 1
        events = []
        if self._count and rate != self._rate:
            events.append(self._dropped(now, f"the rate changed from {self._rate:g} to {rate:g} Hz", 0))
        events += self._gap(block, now, rate)
        if not self._count:
            self._first, self._rate = now, rate
        self._samples.append(block.samples)
        self._speeds.append(shaft_speed)
        self._slip = max(self._slip, slip)
        self._count, self._newest = self._count + len(block.samples), now
        if self._count >= self._settings.window * rate:
            events += self._complete(now)
        return events

    def refuse(self, reason: str, now: float) -> Event:
        """Count a block that cannot be used, and return its event."""
        self._counts["blocks refused"] += 1
        self._begin()
        return Event(now, Level.WARN, "vibration.refused", TOPIC, reason, "block refused; the window begins again with the next one")

    def _reason_to_refuse(self, block: Block, rate: float, shaft_speed: float) -> str:
        if not 0.0 < rate < math.inf:
            return (
                "the block does not say its sampling rate: expected a dimension with the label 'rate' and the rate in Hz as size, or the scene's rate"
            )
        if not len(block.samples):
            return "the block is empty; expected samples in data"
        if len(block.samples) > _LONGEST_BLOCK or self._settings.window * rate > _LARGEST_WINDOW:
            return (
                f"{len(block.samples)} samples at {rate:g} Hz; expected at most {_LONGEST_BLOCK} in a block and {_LARGEST_WINDOW} in a window of"
                f" {self._settings.window:g} s: shorten the window of the scene's block vibration"
            )
        unusable = np.flatnonzero(~np.isfinite(block.samples))
        if unusable.size:
            return f"sample {unusable[0]} of the block is {block.samples[unusable[0]]}; expected finite numbers: check the sensor"
        if not math.isfinite(shaft_speed):
            return "no shaft speed has been measured yet; expected one before the vibration"
        return ""

    def _gap(self, block: Block, now: float, rate: float) -> list[Event]:
        """Return what is missing before a block; the window begins again behind it."""
        before, self._sequence = self._sequence, block.sequence
        if block.sequence is not None and before is not None:
            lost = (block.sequence - before - 1) % _SEQUENCES
            if lost:
                return [self._dropped(now, f"block {block.sequence} follows block {before}", lost if lost < _SEQUENCES // 2 else 0)]
        if self._count:
            late = now - self._first - self._count / rate
            if late > _LATE + 2.0 * len(block.samples) / rate:
                lost = round(late * rate / len(block.samples))
                return [self._dropped(now, f"a block arrives {late:.3g} s later than the samples before it last", lost)]
        return []

    def _dropped(self, now: float, reason: str, lost: int) -> Event:
        self._counts["blocks lost"] += lost
        self._begin()
        return Event(now, Level.WARN, "vibration.gap", TOPIC, reason, "the window begins again, because one with a gap has no phase")

    def _complete(self, now: float) -> list[Event]:
        """Hand over a complete window."""
        lengths = np.array([len(each) for each in self._samples])
        lasted, arrived = (self._count - lengths[0]) / self._rate, self._newest - self._first
        samples = np.concatenate(self._samples)
        speeds = np.interp(np.arange(self._count), np.cumsum(lengths) - lengths / 2.0, self._speeds)
        geometry = self._geometry._replace(largest_slip=min(max(self._geometry.largest_slip, self._slip), _MOST_SLIP))
        window = Window(samples, self._rate, speeds, self._settings.tolerance, geometry)
        rate = self._rate
        self._begin()
        if abs(arrived - lasted) > _LATE + _UNEVEN * lasted:
            reason = f"{lasted:.3g} s of samples at {rate:g} Hz arrived in {arrived:.3g} s"
            return [Event(now, Level.WARN, "vibration.rate", TOPIC, reason, "window left out: check the sampling rate that the blocks say")]
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="vibration", daemon=True)
            self._thread.start()
        try:
            self._waiting.put_nowait(window)
        except queue.Full:
            self._counts["windows left out"] += 1
            reason = "a window is complete before the one before the last is analysed"
            return [Event(now, Level.WARN, "vibration.behind", TOPIC, reason, "window left out: this machine is too slow for all of them")]
        return []

    def _work(self) -> None:
        while (window := self._waiting.get()) is not None:
            try:
                self._outcomes.put(self._analysed(window))
            except Exception as error:  # whatever it is, the run goes on without this window
                self._outcomes.put(f"a window could not be analysed: {error!r}")

    def readings(self, shaft_speed: float) -> list[tuple[float, float]]:
        """Return (cage speed, standard error) [rad/s] found since the last call, at the shaft speed of now [rad/s] by the ratio that was found."""
        found = []
        while True:
            try:
                outcome = self._outcomes.get_nowait()
            except queue.Empty:
                return found
            self._counts["windows"] += 1
            if isinstance(outcome, str):
                self.last = outcome
            elif not outcome.is_claim:
                self._counts["windows without a claim"] += 1
                self.last = outcome.reason
            else:
                self.last = f"{outcome.shows.replace('_', ' ')} shows: cage over shaft {outcome.ratio:.6f} +- {outcome.ratio_error:.6f}"
                scale = shaft_speed / outcome.shaft_speed
                speed = math.copysign(outcome.cage_speed, outcome.shaft_speed) * scale
                found.append((speed, outcome.cage_speed_error * abs(scale)))

    def values(self, now: float) -> Mapping[str, object]:
        """Return values of diagnostics."""
        return {f"vibration: {name}": count for name, count in self._counts.items()} | {"vibration: last window": self.last}

    def close(self) -> None:
        """End the analysis; a window at work is given up."""
        if self._process is not None:
            self._process.end()
        if self._thread is not None:
            while not self._waiting.empty():  # a waiting window is given up
                self._waiting.get_nowait()
            self._waiting.put(None)
            self._thread.join(_ENDS_WITHIN)


class _Process:
    """The process of `bearing_sim.watchers.vibration.worker`, started with the first window, and again after it has ended."""

    def __init__(self):
        self._process: subprocess.Popen | None = None
        self._has_ended = False

    def analysed(self, window: Window) -> Outcome:
        """Return what a window shows; on the meter's thread."""
        if self._has_ended:
            raise EOFError("the run has ended")
        if self._process is None or self._process.poll() is not None:
            command = with_low_priority([sys.executable, "-m", "bearing_sim.watchers.vibration.worker"], _NICENESS)
            environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
        pickle.dump(tuple(window), self._process.stdin)
        self._process.stdin.flush()
        return Outcome(*pickle.load(self._process.stdout))

    def end(self) -> None:
        """End it."""
        self._has_ended = True
        if self._process is not None:
            self._process.kill()
            self._process.wait()
