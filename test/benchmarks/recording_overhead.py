# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What recording and the live view cost a run in real time: ``python test/benchmarks/recording_overhead.py``.

One live model runs without a break.  Its sinks, a recording of all observables and a live view with a viewer, receive its blocks in every other
stretch only; in between the viewer is stopped (see `paired`).  The time of a tick is split by the kernel's scheduler statistics into the
thread's own work, its wait for a core, which other programs cause as well, and the rest: waits for the interpreter's lock.

How to read it: each row compares stretches with sinks to their neighbours without.  The column "control" applies the same arithmetic to
stretches without sinks; an effect is real where its interval excludes the control's.  A viewer that draws on this machine has no graphics card,
and takes every core that is left in idle time, as ``live.launch.py`` starts it (`bearing_sim.recording.priority`).  ``--viewer taking`` receives
everything and draws nothing: it stands for a viewer with a graphics card, or on another machine.
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

import click
import numpy as np
from paired import CONTROL, WITH, ThreadStatistics, differences, order, ratios, stolen_share

from bearing_sim.cli.options import json_option, level_type, quick_option
from bearing_sim.cli.reporting import announce_compilation, print_json, print_rows
from bearing_sim.recording.priority import in_idle_time
from bearing_sim.recording.recorder import Recorder
from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.view.screenshot import HeadlessViewer, ViewerFailed, viewer_program
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import free_port

_INPUT_PERIOD = 0.02  # [s] between messages of speed and load
_REVIEW_PERIOD = 0.2  # [s] between reviews of the sinks, as in the node
_ALL = 1e3  # [s]
_SETTLING = 0.4  # [s] ignored at the start of each stretch
_TAKING_WITHIN = 60.0  # [s]
DRAWING, TAKING, NOBODY, NO_VIEW = VIEWERS = ("drawing", "taking", "nobody", "no-view")
"""Viewer of the live view: one that draws on this processor, one that receives everything but draws nothing, none; or no view at all."""


class Figures(NamedTuple):
    """Performance of the solver's thread in one stretch.

    Attributes
    ----------
    rate : simulated time over wall time in the solver.
    core_rate : the same, over the time in which a core was available.
    processor_rate : the same, over the processor time of its thread.
    worst_stall, late_stall : longest time, and 99.9 % quantile, for which a tick was due or running and not computed [s].
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
    seconds : length of each stretch; there are four per pair.
    sample_rate : samples recorded per second [Hz].
    pairs : number of pairs, and of controls.
    viewer : viewer of the live view: one of `VIEWERS`.
    progress : called with a text on each stretch.

    Returns
    -------
    report : ``with`` and ``control``: for each of `RATES` the ratio, for each of `STALLS` the difference [ms] to the stretches without, as
        `paired.Spread`; ``without``: medians of the figures themselves; ``dropped``: blocks that sinks missed; ``viewer``:
        its kind, or why there is none; amount of data written, and load of the machine.
    """
    kinds = order(pairs)
    stolen = stolen_share()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as opened:
        path = Path(folder) / "run.mcap"
        watched = _Watched(warmed_up(scene))
        sinks = _Sinks(opened, scene, path, viewer)
        live = LiveModel(scene, watched, sinks.start_ns, sample_rate, maximum_lag=_ALL)  # no time is skipped, so that ticks can be counted
        for name, sink in sinks.by_name.items():
            live.sinks.attach(name, sink)
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
    tick = live.schedule.tick
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
        "viewer": sinks.viewer_state,
        "load_average": os.getloadavg()[0],
        "stolen_share": given / all_of_it if all_of_it else 0.0,
    }


def _compared(kinds: list[str], found: list[Figures], kind: str) -> dict:
    figures = {name: ratios(kinds, [getattr(one, name) for one in found], kind)._asdict() for name in RATES}
    return figures | {f"{name}_ms": differences(kinds, [1e3 * getattr(one, name) for one in found], kind)._asdict() for name in STALLS}


def _medians(found: list[Figures]) -> dict:
    figures = {name: float(np.median([getattr(one, name) for one in found])) for name in RATES}
    return figures | {f"{name}_ms": float(1e3 * np.median([getattr(one, name) for one in found])) for name in STALLS}


class _Watched:
    """A simulation that records start and end of each tick, and the scheduler statistics of its thread."""

    def __init__(self, simulation):
        self._simulation = simulation
        self._statistics: ThreadStatistics | None = None
        self._noted: list[tuple[float, float, float, float, float, float]] = []

    def __getattr__(self, name: str):
        return getattr(self._simulation, name)

    def advance(self, *arguments):
        if self._statistics is None:
            self._statistics = ThreadStatistics()
        before = time.perf_counter(), time.thread_time(), self._statistics.waited()
        block = self._simulation.advance(*arguments)
        waited, work = self._statistics.waited(), time.thread_time()  # within the wall time of the tick, as those before it
        self._noted.append((*before, time.perf_counter(), work, waited))
        return block

    def stretches(self, begins: list[float], seconds: float, tick: float) -> list[Figures]:
        """Return the figures of the stretches that began at the given values of `time.perf_counter`."""
        noted = np.array(self._noted)
        due = tick * np.arange(len(noted))
        found = []
        for begin in begins:
            first, last = np.searchsorted(noted[:, 0], (begin, begin + seconds))
            found.append(_figures(noted[first - 1 : last], due[first - 1 : last], tick))
        return found


def _figures(noted: np.ndarray, due: np.ndarray, tick: float) -> Figures:
    """Return the figures of a stretch; the first tick only provides the start of the second."""
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
    """Do what a node does, for a while: pass on messages of speed and load, review the sinks."""
    operating = scene.operating
    load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
    began, reviewed = time.perf_counter(), -math.inf
    while (now := time.perf_counter() - began) < seconds:
        live.offer("shaft_speed", (operating.shaft_speed * (1.0 + 0.01 * math.sin(now)),), time.time_ns(), time.time_ns())
        live.offer("radial_load", load, time.time_ns(), time.time_ns())
        if now - reviewed >= _REVIEW_PERIOD:
            reviewed = now
            live.collect(time.time_ns())
        time.sleep(_INPUT_PERIOD)


@contextmanager
def _taking(url: str) -> Iterator[subprocess.Popen]:
    """Run a process that receives everything a viewer would, and draws nothing."""
    with tempfile.TemporaryDirectory() as folder:
        taken = Path(folder) / "taken.rrd"
        command = [str(viewer_program()), url, "--save", str(taken), "--bind", "127.0.0.1", "--port", str(free_port())]
        process = subprocess.Popen(in_idle_time(command), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            limit = time.monotonic() + _TAKING_WITHIN
            while not (taken.exists() and taken.stat().st_size):
                if process.poll() is not None or time.monotonic() > limit:
                    raise ViewerFailed(f"rerun received nothing from {url} within {_TAKING_WITHIN:g} s")
                time.sleep(0.05)
            yield process
        finally:
            process.kill()
            process.wait()


class _Tap:
    """A sink that can be switched off."""

    def __init__(self, sink):
        self._sink, self.is_open = sink, False

    def __getattr__(self, name: str):
        method = getattr(self._sink, name)
        return method if self.is_open or name in {"close", "dropped"} else lambda *_, **__: ()


class _Sinks:
    """A recording, and a view with a viewer if possible."""

    def __init__(self, opened: ExitStack, scene: Scene, path: Path, viewer: str):
        self.start_ns, self.viewer_state, self._viewer, self._wanted = time.time_ns(), viewer, None, viewer
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
        """Attach the viewer to the view, which must have something to show."""
        if self._wanted not in (DRAWING, TAKING):
            return
        url = f"rerun+http://127.0.0.1:{self._port}/proxy"
        viewer = HeadlessViewer(url, size=(800, 600), in_idle_time=True) if self._wanted == DRAWING else _taking(url)
        try:
            self._viewer = opened.enter_context(viewer)
        except ViewerFailed as error:
            self.viewer_state = f"none could be started: {error}"
            return
        opened.callback(os.kill, self._viewer.pid, signal.SIGCONT)

    @property
    def dropped(self) -> int:
        return self._recording.dropped + (self._view.dropped if self._view is not None else 0)

    @contextmanager
    def fed(self, wanted: bool) -> Iterator[None]:
        """Feed the sinks and let the viewer draw for a while, or stop both."""
        for tap in self.by_name.values():
            tap.is_open = wanted
        if self._viewer is not None:
            os.kill(self._viewer.pid, signal.SIGCONT if wanted else signal.SIGSTOP)
        yield


def at_level(scene: Scene, level: str | None) -> Scene:
    """Return the scene at another level."""
    return scene if level is None else dataclasses.replace(scene, level=level)


_MEANINGS = {
    "rate": "rate by wall time, relative to without",
    "core_rate": "rate while a core was available",
    "processor_rate": "rate by processor time of its thread",
    "worst_stall_ms": "worst stall [ms], minus that without",
    "late_stall_ms": "99.9 % quantile of stalls [ms], minus",
    "worst_held_ms": "worst stall without waits for a core [ms], minus",
    "late_held_ms": "99.9 % quantile of these [ms], minus",
}


@click.command()
@click.option("--level", "levels", multiple=True, default=("slip", "planar"), show_default=True, type=level_type, help="Level; can be repeated.")
@click.option("--seconds", type=click.FloatRange(min=0.5), default=1.0, show_default=True, metavar="S", help="Length of a stretch.")
@click.option("--pairs", type=click.IntRange(min=1), default=24, show_default=True, metavar="N", help="Pairs of stretches, with and without.")
@click.option("--rate", type=click.FloatRange(min=1), default=1000.0, show_default=True, metavar="HZ", help="Samples per second.")
@click.option(
    "--viewer",
    type=click.Choice(VIEWERS),
    default=DRAWING,
    show_default=True,
    help="Viewer of the live view: drawing on this processor, receiving without drawing, none; or no view at all.",
)
@quick_option
@json_option
def command(levels, seconds, pairs, rate, viewer, quick, as_json):
    """Run bearing deng2017_table1 in real time alternately with and without sinks, and measure the solver's rate and stalls.

    Every other stretch has no sinks; half of the others have none either and serve as controls.
    """
    announce_compilation()
    if quick:
        seconds, pairs = 0.5, 1

    def progress(level):
        return lambda text: click.echo(f"{level}: {text} ...", err=True)

    scene = load_scene("deng2017_table1")
    reports = [recording_cost(at_level(scene, level), seconds, rate, pairs, viewer, progress=progress(level)) for level in levels]
    if as_json:
        print_json({"recording": reports})
        return
    for report in reports:
        _print(report)


def _print(report) -> None:
    def spread(found):
        return f"{found['median']:.3f} ({found['low']:.3f} to {found['high']:.3f})"

    rows = [
        (meaning, spread(report["with"][name]), spread(report["control"][name]), format(report["without"][name], ".3g"))
        for name, meaning in _MEANINGS.items()
    ]
    title = (
        f"{report['level']}: recording at {report['sample_rate']:g} Hz and a live view (viewer: {report['viewer']}), {report['pairs']} pairs of "
        f"stretches of {report['seconds']:g} s"
    )
    print_rows(title, ("recording", "with", "control, without", "without"), rows, words=("recording",), width=170)
    click.echo(
        f"median, and its 95 % confidence interval; {report['recording_mb_per_second']:.3g} MB/s written, {report['dropped']} blocks missed; "
        f"load average {report['load_average']:.2f}, {100 * report['stolen_share']:.1f} % of the processors' time stolen by the host"
    )


if __name__ == "__main__":
    command()
