# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a live view costs the solver, whatever viewers do, and how an hour at 1 kHz opens.

The solver runs as fast as it can, a thousand samples for each second of wall time, and in every other stretch it hands its blocks to the view
(see `bearing_sim.studies.paired`).  The time between two ticks is split, by the kernel's own books, into the thread's own work, its wait for
a processor core, which is other programs' doing, and the rest: waits for the interpreter's lock, a queue, or the disk, which would be the
view's doing.  Viewers draw without a graphics card, on any core, in idle time, as ``live.launch.py`` starts them
(`bearing_sim.sinks.priority`): what is found is what a user gets.

Cores of one machine are not independent: they share caches, memory, and the heat they may make.  So a last situation has, in the place of the
view, a program that only counts: what that costs the solver on a core of its own, any program does.
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.screenshot import HeadlessViewer, free_port
from bearing_sim.simulation import Simulation
from bearing_sim.sinks.priority import in_idle_time
from bearing_sim.sinks.rerun_sink import RerunSink
from bearing_sim.studies.paired import CONTROL, WITH, ThreadBooks, each_ratio, order, spread, stolen_share

_SCENE = ("deng2017_table1", ("level=slip", "operating.shaft_speed=15000 rpm"))
_TICK, _SAMPLES = 0.005, 5  # [s] of wall time that a tick about takes, and samples in it
_STRETCH, _SETTLING = 0.25, 0.25  # [s] of wall time of a stretch, and what is left out before it: a view is that much behind
_PROGRAM = "n = 0\nwhile True: n += 1"
_HOUR, _RATE = 3600.0, 1000.0  # [s], [Hz]


class Stretch(NamedTuple):
    """How the solver fared for a while.

    Attributes
    ----------
    wall_rate : simulated seconds for each second of wall time.
    rate : the same for each second in which a core was to be had.
    share : of the wall time, in which the thread had a core and computed.  Where the host makes a core slower for a moment, as shared machines
        do, rates change by more than a view costs, but this does not.
    processor_rate : the same for each second of the thread's processor time, by the quartile of ticks: the others share caches and memory with
        whatever runs on other cores.
    worst_tick : longest wall time of a tick [s].
    worst_wait, late_wait : longest time, and 99.9 % of them, in which a tick neither worked nor waited for a core [s].
    """

    wall_rate: float
    rate: float
    share: float
    processor_rate: float
    worst_tick: float
    worst_wait: float
    late_wait: float


RATES = ("wall_rate", "rate", "share", "processor_rate")
COUNTING = "no view, but a program that counts"


def run_view_bench(seconds: float, frozen: float, progress: Callable[[str], None] = lambda text: None) -> dict:
    """Measure the solver without a view and with one, while viewers are absent, come, freeze, die.

    Parameters
    ----------
    seconds : wall time of each situation [s].
    frozen : wall time for which viewer, and then view, are frozen [s].
    progress : told what comes next.

    Returns
    -------
    situations : list of dicts: ``name``; ``with`` and ``control``: for each of `RATES` what the stretches with the view, and those that only
        pretend, are of the stretches without one beside them, as `bearing_sim.studies.paired.Spread`; the worst times of the stretches with and
        without; ``dropped``: blocks that the view missed.  In the last, `COUNTING`, a program that counts runs where the view would.
    together : ``with`` and ``control`` of all situations with a view taken together.
    """
    simulation = Simulation(load_scene(*_SCENE))
    simulation.advance(0.2)
    began = time.thread_time()
    simulation.advance(0.5)
    tick = _TICK * 0.5 / max(time.thread_time() - began, 1e-6)
    stolen = stolen_share()
    found, together = list(_situations(simulation, tick, seconds, frozen, progress)), defaultdict(list)
    for situation in found:
        for (kind, rate), values in situation.pop("ratios").items():
            situation.setdefault(kind, {})[rate] = spread(values)._asdict()
            if situation["name"] != COUNTING:
                together[kind, rate] += values
    given, all_of_it = (after - before for after, before in zip(stolen_share(), stolen))
    machine = {"cores": os.cpu_count(), "load_average": os.getloadavg()[0], "stolen_share": given / all_of_it if all_of_it else 0.0}
    pooled = {kind: {rate: spread(together[kind, rate])._asdict() for rate in RATES} for kind in (WITH, CONTROL)}
    return {**machine, "tick": tick, "stretch": _STRETCH, "situations": found, "together": pooled}


def _situations(simulation, tick, seconds, frozen, progress) -> Iterator[dict]:
    def measure(name, length=seconds):
        progress(f"{name}, {length:g} s")
        before = sink.dropped
        with _solver_on_a_core_of_its_own():
            found = _measure(simulation, tick, length, sink.write)
        return {"name": name, **found, "dropped": sink.dropped - before}

    port = free_port()
    with RerunSink(simulation.scene, serve_port=port) as sink:
        sink.wait_until_ready()
        yield measure("no viewer")
        viewer = HeadlessViewer(f"rerun+http://127.0.0.1:{port}/proxy", size=(800, 600), in_idle_time=True)
        with suppress(ProcessLookupError), viewer:
            yield measure("viewer attached")
            os.kill(viewer.pid, signal.SIGSTOP)
            yield measure("viewer frozen", frozen)
            os.kill(viewer.pid, signal.SIGCONT)
            os.kill(viewer.pid, signal.SIGKILL)
            yield measure("viewer killed")
        os.kill(sink.pid, signal.SIGSTOP)
        yield measure("view itself frozen", frozen)
        os.kill(sink.pid, signal.SIGCONT)
    progress(f"{COUNTING}, {seconds:g} s")
    with _counting() as switch, _solver_on_a_core_of_its_own():
        yield {"name": COUNTING, **_measure(simulation, tick, seconds, lambda _: None, switch), "dropped": 0}


@contextmanager
def _counting() -> Iterator[Callable[[bool], None]]:
    """Have a program beside this one that only counts; yield what lets it go on (True) or stand still."""
    program = subprocess.Popen(in_idle_time([sys.executable, "-I", "-S", "-c", _PROGRAM]))
    try:
        yield lambda goes_on: os.kill(program.pid, signal.SIGCONT if goes_on else signal.SIGSTOP)
    finally:
        program.kill()
        program.wait()


def _measure(
    simulation: Simulation, tick: float, seconds: float, write: Callable[[np.ndarray], None], switch: Callable[[bool], None] = lambda on: None
) -> dict:
    """Run the solver on this thread for a while; in a stretch with what is measured, that is switched on and gets every block."""
    length = min(_STRETCH, seconds / 5)
    kinds = order(max(1, int(seconds / (4 * (length + _SETTLING)))))
    books = ThreadBooks()
    found = []
    for kind in kinds:
        switch(kind == WITH)
        fed = write if kind == WITH else None
        _run(simulation, tick, min(_SETTLING, length), fed, books)
        found.append(_stretch(_run(simulation, tick, length, fed, books), tick))
    books.close()
    told = {(kind, rate): each_ratio(kinds, [getattr(one, rate) for one in found], kind) for kind in (WITH, CONTROL) for rate in RATES}
    worst = {
        f"{figure}_{label}": spread(getattr(one, figure) for kind, one in zip(kinds, found) if (kind == WITH) == fed).median
        for figure in ("wall_rate", "worst_tick", "worst_wait", "late_wait")
        for label, fed in (("with", True), ("without", False))
    }
    return {"seconds": seconds, "ratios": told, **worst}


def _run(simulation: Simulation, tick: float, seconds: float, write: Callable[[np.ndarray], None] | None, books: ThreadBooks) -> np.ndarray:
    """Return what each tick took: wall time, processor time of this thread, its wait for a core [s], shape (ticks, 3)."""
    noted = [(time.perf_counter(), time.thread_time(), books.waited())]
    while noted[-1][0] - noted[0][0] < seconds:
        block = simulation.advance(tick, samples=_SAMPLES)
        if write is not None:
            write(block)
        noted.append((time.perf_counter(), time.thread_time(), books.waited()))
    return np.diff(np.array(noted), axis=0)


def _stretch(ticks: np.ndarray, tick: float) -> Stretch:
    wall, work, delay = ticks.T
    waits = np.maximum(wall - work - delay, 0.0)
    simulated = tick * len(ticks)
    return Stretch(
        simulated / wall.sum(),
        simulated / (wall.sum() - delay.sum()),
        work.sum() / wall.sum(),
        tick / float(np.quantile(work, 0.25)),
        float(wall.max()),
        float(waits.max()),
        float(np.quantile(waits, 0.999)),
    )


@contextmanager
def _solver_on_a_core_of_its_own() -> Iterator[None]:
    """Keep this thread, but none that it has started before, on the last core; everything else runs where it likes."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def run_hour(seconds: float = _HOUR, progress: Callable[[str], None] = lambda text: None) -> dict:
    """Write ``seconds`` [s] at 1 kHz, of level slip at a low speed with a load that comes and goes, and open them.

    Returns
    -------
    samples, bytes : of the run, and of its file.
    writing_seconds, opening_seconds : to simulate and write, and until the viewer shows the whole run.
    viewer_bytes : of memory, at most, that the viewer took.
    """
    scene = load_scene("deng2017_table1", ["level=slip", "operating.shaft_speed=1500 rpm"])
    with tempfile.TemporaryDirectory(prefix="bearing_sim_hour_") as folder:
        path = Path(folder) / "hour.rrd"
        progress(f"writing {seconds:g} s at {_RATE:g} Hz")
        began = time.perf_counter()
        samples = _write_hour(scene, path, seconds)
        written = time.perf_counter()
        progress("opening them")
        with HeadlessViewer(path) as viewer:
            viewer.seek(seconds)
            opened = time.perf_counter()
            found = {"first_second": viewer.span()[0], "last_second": viewer.span()[1], "problems": viewer.problems()}
            memory = _peak_memory(viewer.pid)
        size = path.stat().st_size
    times = {"writing_seconds": written - began, "opening_seconds": opened - written}
    return {"simulated_seconds": seconds, "samples": samples, "bytes": size, **times, "viewer_bytes": memory, **found}


def _write_hour(scene, path: Path, seconds: float) -> int:
    simulation = Simulation(scene)
    count, written = 500, 0
    given = simulation.inputs
    with RerunSink(scene, path=path, lossless=True, duration=seconds) as sink:
        while written < round(seconds * _RATE):
            share = 1.0 + 0.5 * np.sin(2 * np.pi * written / _RATE / 300.0)
            sink.write(simulation.advance(count / _RATE, given._replace(load_y=given.load_y * share), count))
            written += count
    return written


def _peak_memory(pid: int) -> int:
    """Return the most memory [bytes] that a process has had in use."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return 1024 * int(line.split()[1])
    return 0
