# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What recording and showing cost a live run: the solver's rate, and the worst that its thread is held up, with and without sinks.

One live model runs on; its sinks, a recording of all observables and a live view with a viewer, get what it computes in every other stretch
only, and the viewer sleeps in between (see `bearing_sim.studies.paired`).  A viewer that draws does so without a graphics card, on any core, in
idle time, as ``live.launch.py`` starts it (`bearing_sim.sinks.priority`): it takes every core that is left.  One that only takes stands for a
viewer with a graphics card, or on another machine.  The time of a tick is split by the kernel's books into the thread's own work, its wait for
a core, which other programs cause as well, and the rest: waits for the interpreter's lock.
"""

import dataclasses
import math
import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.scene import Scene
from bearing_sim.screenshot import HeadlessViewer, ViewerFailed, free_port, viewer_program
from bearing_sim.sinks.priority import in_idle_time
from bearing_sim.sinks.recorder import Recorder
from bearing_sim.sinks.rerun_sink import RerunSink
from bearing_sim.studies.paired import CONTROL, WITH, ThreadBooks, differences, order, ratios, stolen_share

_INPUTS_EVERY = 0.02  # [s] between messages of speed and load
_REVIEW_EVERY = 0.2  # [s] as the node looks after its sinks
_ALL = 1e3  # [s]
_SETTLING = 0.4  # [s] left out at the start of each stretch
_TAKING_WITHIN = 60.0  # [s]
DRAWING, TAKING, NOBODY, NO_VIEW = VIEWERS = ("drawing", "taking", "nobody", "no-view")
"""Who looks at the live view: a viewer that draws on this processor, one that takes all that is to be drawn elsewhere, nobody; or no view."""


class Figures(NamedTuple):
    """How the solver's thread fared in one stretch.

    Attributes
    ----------
    rate : simulated time over wall time in the solver.
    core_rate : likewise over the time in which a core was to be had.
    processor_rate : likewise over the processor time of its thread.
    worst_stall, late_stall : the longest that a tick was due, or running, and not computed, and what 99.9 % of ticks stay below [s].
    worst_held, late_held : the same without the wait for a core [s].
    """

    rate: float
    core_rate: float
    processor_rate: float
    worst_stall: float
    late_stall: float
    worst_held: float
    late_held: float


RATES = ("rate", "core_rate", "processor_rate")
STALLS = ("worst_stall", "late_stall", "worst_held", "late_held")


def recording_cost(
    scene: Scene,
    seconds: float,
    sample_rate: float,
    pairs: int,
    viewer: str = DRAWING,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Measure a run in real time without and with a recording of all observables and a live view.

    Parameters
    ----------
    scene : what is simulated.
    seconds : length of each stretch, of which there are four for each pair.
    sample_rate : samples recorded for each second [Hz].
    pairs : pairs with, and as many controls.
    viewer : which viewer the live view has: one of `VIEWERS`.
    progress : told what is being done.

    Returns
    -------
    report : ``with`` and ``control``: for each of `RATES` the ratio, for each of `STALLS` the difference [ms] to the stretches without, as
        `bearing_sim.studies.paired.Spread`; ``without``: medians of the figures themselves; ``dropped``: blocks that sinks missed; ``viewer``:
        which, or why there is none; what was written, and how busy the machine was.
    """
    kinds = order(pairs)
    stolen = stolen_share()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as opened:
        path = Path(folder) / "run.mcap"
        watched = _Watched(warmed_up(scene))
        sinks = _Sinks(opened, scene, path, viewer)
        live = LiveModel(scene, watched, sinks.start_ns, sample_rate, maximum_lag=_ALL)  # no time is given up, so that ticks stay countable
        for name, sink in sinks.by_name.items():
            live.attach(name, sink)
        with sinks.fed(True):
            _drive(live, scene, _SETTLING)
        sinks.attach_viewer(opened)
        begins, shares = [], []
        for place, kind in enumerate(kinds):
            progress(f"stretch {place + 1} of {len(kinds)}, {kind}, {seconds:g} s")
            with sinks.fed(kind == WITH):
                _drive(live, scene, _SETTLING)
                began = time.perf_counter()
                begins.append(began)
                busy = time.process_time()
                _drive(live, scene, seconds)
                shares.append((time.process_time() - busy) / (time.perf_counter() - began))
        live.close()
        written = path.stat().st_size
    tick = live.cadence.tick
    found = watched.stretches(begins, seconds, tick)
    given, all_of_it = (after - before for after, before in zip(stolen_share(), stolen))
    return {
        "scene": scene.name,
        "level": scene.level,
        "sample_rate": sample_rate,
        "seconds": seconds,
        "pairs": pairs,
        "ticks": round(seconds / tick),
        "with": _compared(kinds, found, WITH),
        "control": _compared(kinds, found, CONTROL),
        "without": _medians([one for kind, one in zip(kinds, found) if kind != WITH]),
        "recorded": _medians([one for kind, one in zip(kinds, found) if kind == WITH]),
        "processor_share": {
            name: float(np.median([share for kind, share in zip(kinds, shares) if (kind == WITH) == fed]))
            for name, fed in (("without", False), ("with", True))
        },
        "recording_mb_per_second": written / 1e6 / (pairs * (seconds + _SETTLING)),
        "dropped": sinks.dropped,
        "viewer": sinks.viewer_told,
        "load_average": os.getloadavg()[0],
        "stolen_share": given / all_of_it if all_of_it else 0.0,
    }


def _compared(kinds: list[str], found: list[Figures], kind: str) -> dict:
    told = {name: ratios(kinds, [getattr(one, name) for one in found], kind)._asdict() for name in RATES}
    return told | {f"{name}_ms": differences(kinds, [1e3 * getattr(one, name) for one in found], kind)._asdict() for name in STALLS}


def _medians(found: list[Figures]) -> dict:
    told = {name: float(np.median([getattr(one, name) for one in found])) for name in RATES}
    return told | {f"{name}_ms": float(1e3 * np.median([getattr(one, name) for one in found])) for name in STALLS}


class _Watched:
    """A simulation that notes of each tick when it began and ended, and what the kernel booked for its thread until then."""

    def __init__(self, simulation):
        self._simulation = simulation
        self._books: ThreadBooks | None = None
        self._noted: list[tuple[float, float, float, float, float, float]] = []

    def __getattr__(self, name: str):
        return getattr(self._simulation, name)

    def advance(self, *arguments):
        if self._books is None:
            self._books = ThreadBooks()
        before = time.perf_counter(), time.thread_time(), self._books.waited()
        block = self._simulation.advance(*arguments)
        waited, work = self._books.waited(), time.thread_time()  # within the wall time of the tick, as those before it
        self._noted.append((*before, time.perf_counter(), work, waited))
        return block

    def stretches(self, begins: list[float], seconds: float, tick: float) -> list[Figures]:
        """Return the figures of the stretches that began at some moments of `time.perf_counter`."""
        noted = np.array(self._noted)
        due = tick * np.arange(len(noted))
        found = []
        for begin in begins:
            first, last = np.searchsorted(noted[:, 0], (begin, begin + seconds))
            found.append(_figures(noted[first - 1 : last], due[first - 1 : last], tick))
        return found


def _figures(noted: np.ndarray, due: np.ndarray, tick: float) -> Figures:
    """Return the figures of a stretch; the first tick only tells where the second begins."""
    begun, _, waited_before, ended, _, _ = noted[1:].T
    spent, work, waited = (noted[1:, k + 3] - noted[1:, k] for k in range(3))
    due = due[1:] + np.min(begun - due[1:])  # by the most punctual tick
    could_begin = np.maximum(due, noted[:-1, 3])
    stall = ended - could_begin - work
    waiting = noted[1:, 5] - noted[:-1, 5]  # for a core, since the tick before
    held = np.maximum(stall - waiting, 0.0)
    total = tick * len(spent)
    return Figures(
        total / spent.sum(),
        total / np.maximum(spent - waited, work).sum(),
        total / work.sum(),
        float(stall.max()),
        float(np.quantile(stall, 0.999)),
        float(held.max()),
        float(np.quantile(held, 0.999)),
    )


def _drive(live: LiveModel, scene: Scene, seconds: float) -> None:
    """Do what a node does, for a while: hand on messages of speed and load, look after the sinks."""
    operating = scene.operating
    load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
    began, reviewed = time.perf_counter(), -math.inf
    while (now := time.perf_counter() - began) < seconds:
        live.offer("shaft_speed", (operating.shaft_speed * (1.0 + 0.01 * math.sin(now)),), time.time_ns(), time.time_ns())
        live.offer("radial_load", load, time.time_ns(), time.time_ns())
        if now - reviewed >= _REVIEW_EVERY:
            reviewed = now
            live.collect(time.time_ns())
        time.sleep(_INPUTS_EVERY)


@contextmanager
def _taking(url: str) -> Iterator[subprocess.Popen]:
    """Let a process take all that a viewer would, and draw nothing."""
    with tempfile.TemporaryDirectory() as folder:
        taken = Path(folder) / "taken.rrd"
        command = [str(viewer_program()), url, "--save", str(taken), "--bind", "127.0.0.1", "--port", str(free_port())]
        process = subprocess.Popen(in_idle_time(command), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            limit = time.monotonic() + _TAKING_WITHIN
            while not (taken.exists() and taken.stat().st_size):
                if process.poll() is not None or time.monotonic() > limit:
                    raise ViewerFailed(f"rerun took nothing from {url} within {_TAKING_WITHIN:g} s")
                time.sleep(0.05)
            yield process
        finally:
            process.kill()
            process.wait()


class _Tap:
    """A sink that passes on, or not."""

    def __init__(self, sink):
        self._sink, self.is_open = sink, False

    def __getattr__(self, name: str):
        method = getattr(self._sink, name)
        return method if self.is_open or name in {"close", "dropped"} else lambda *_, **__: ()


class _Sinks:
    """A recording, and a view with a viewer where there can be one."""

    def __init__(self, opened: ExitStack, scene: Scene, path: Path, viewer: str):
        self.start_ns, self.viewer_told, self._viewer, self._wanted = time.time_ns(), viewer, None, viewer
        recorder = opened.enter_context(Recorder())
        self._recording, self._view = recorder.open(path, scene, self.start_ns), None
        self.by_name = {"record": _Tap(self._recording)}
        if viewer == NO_VIEW:
            return
        self._port = free_port()
        self._view = opened.enter_context(RerunSink(scene, serve_port=self._port))
        self._view.wait_until_ready()
        self.by_name["view"] = _Tap(self._view)

    def attach_viewer(self, opened: ExitStack) -> None:
        """Let the viewer have the view; it needs something to show."""
        if self._wanted not in (DRAWING, TAKING):
            return
        url = f"rerun+http://127.0.0.1:{self._port}/proxy"
        viewer = HeadlessViewer(url, size=(800, 600), in_idle_time=True) if self._wanted == DRAWING else _taking(url)
        try:
            self._viewer = opened.enter_context(viewer)
        except ViewerFailed as fault:
            self.viewer_told = f"none could be started: {fault}"
            return
        opened.callback(os.kill, self._viewer.pid, signal.SIGCONT)

    @property
    def dropped(self) -> int:
        return self._recording.dropped + (self._view.dropped if self._view is not None else 0)

    @contextmanager
    def fed(self, wanted: bool) -> Iterator[None]:
        """Feed the sinks and let the viewer draw for a while, or neither."""
        for tap in self.by_name.values():
            tap.is_open = wanted
        if self._viewer is not None:
            os.kill(self._viewer.pid, signal.SIGCONT if wanted else signal.SIGSTOP)
        yield


def at_level(scene: Scene, level: str | None) -> Scene:
    """Return the scene at another level."""
    return scene if level is None else dataclasses.replace(scene, level=level)
