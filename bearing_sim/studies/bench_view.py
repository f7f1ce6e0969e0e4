# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a live view costs the solver, whatever viewers do, and how an hour at 1 kHz opens.

The solver runs as fast as it can and hands every block to the view, a thousand samples for each second of wall time.  The time
between two ticks is split, by the kernel's own books, into the thread's own work, its wait for a processor core, which is other
programs' doing, and the rest: waits for the interpreter's lock, a queue, or the disk, which would be the view's doing.
"""

import os
import signal
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.screenshot import HeadlessViewer
from bearing_sim.simulation import Simulation
from bearing_sim.sinks.rerun_sink import RerunSink

_SCENE = ("deng2017_table1", ("level=slip", "operating.shaft_speed=15000 rpm"))
_TICK, _SAMPLES = 0.005, 5  # [s] of wall time that a tick about takes, and samples in it
_HOUR, _RATE = 3600.0, 1000.0  # [s], [Hz]


class Stretch(NamedTuple):
    """How the solver fared for a while.

    Attributes
    ----------
    name : what the viewer did.
    wall_rate : simulated seconds for each second of wall time.
    rate : the same for each second in which a core was to be had.
    work : processor time of the solver's thread for each simulated second [s].
    worst_tick : longest wall time of a tick [s].
    worst_wait, late_wait : longest time, and 99.9 % of them, in which a tick neither worked nor waited for a core [s].
    dropped : blocks that the view missed.
    """

    name: str
    wall_rate: float
    rate: float
    work: float
    worst_tick: float
    worst_wait: float
    late_wait: float
    dropped: int


def run_view_bench(seconds: float, frozen: float, progress: Callable[[str], None] = lambda text: None) -> dict:
    """Measure the solver without a view, with one, and with viewers that come, freeze, die.

    Parameters
    ----------
    seconds : wall time of each stretch [s].
    frozen : wall time for which the viewer is frozen [s].
    progress : told what comes next.

    Returns
    -------
    stretches : list of `Stretch` as dicts; each with a view has beside it, as ``rate_ratio`` and ``work_ratio``, what it is of the mean of the
        stretches without before and after it.
    """
    simulation = Simulation(load_scene(*_SCENE))
    simulation.advance(0.2)
    began = time.thread_time()
    simulation.advance(0.5)
    tick = _TICK * 0.5 / max(time.thread_time() - began, 1e-6)
    with _solver_on_a_core_of_its_own() as others:
        found = list(_stretches(simulation, tick, seconds, frozen, others, progress))
    bare = [place for place, stretch in enumerate(found) if stretch.name == "no view"]
    report = []
    for place, stretch in enumerate(found):
        beside = [found[max(k for k in bare if k <= place)], found[min(k for k in bare if k >= place)]]
        ratios = {f"{name}_ratio": getattr(stretch, name) / np.mean([getattr(one, name) for one in beside]) for name in ("rate", "work")}
        report.append(stretch._asdict() | {name: float(ratio) for name, ratio in ratios.items()})
    return {"cores": os.cpu_count(), "load_average": os.getloadavg()[0], "tick": tick, "stretches": report}


def _stretches(simulation, tick, seconds, frozen, others, progress) -> Iterator[Stretch]:
    def measure(name, length=seconds, sink=None):
        progress(name)
        return _measure(simulation, tick, length, name, sink)

    yield measure("no view")
    port = _free_port()
    with RerunSink(simulation.scene, serve_port=port) as sink:
        sink.wait_until_ready()
        yield measure("view, no viewer", sink=sink)
        yield measure("no view")
        viewer = HeadlessViewer(f"rerun+http://127.0.0.1:{port}/proxy", size=(800, 600))
        with suppress(ProcessLookupError), viewer:
            _keep_to(viewer.pid, others)
            yield measure("viewer attached", sink=sink)
            yield measure("no view")
            os.kill(viewer.pid, signal.SIGSTOP)
            yield measure(f"viewer frozen for {frozen:g} s", frozen, sink)
            os.kill(viewer.pid, signal.SIGCONT)
            yield measure("no view")
            os.kill(viewer.pid, signal.SIGKILL)
            yield measure("viewer killed", sink=sink)
        yield measure("no view")
        os.kill(sink.pid, signal.SIGSTOP)
        yield measure(f"view itself frozen for {frozen:g} s", frozen, sink)
        os.kill(sink.pid, signal.SIGCONT)
        yield measure("no view")


def _measure(simulation: Simulation, tick: float, seconds: float, name: str, sink: RerunSink | None) -> Stretch:
    """Run the solver on this thread for a while; every block goes to the sink, if there is one."""
    rows, dropped = [], sink.dropped if sink is not None else 0
    began, work, delay = time.perf_counter(), time.thread_time(), _delay()
    first, before = began, (began, work, delay)
    while before[0] - first < seconds:
        block = simulation.advance(tick, samples=_SAMPLES)
        if sink is not None:
            sink.write(block)
        now = time.perf_counter(), time.thread_time(), _delay()
        rows.append([after - earlier for after, earlier in zip(now, before)])
        before = now
    wall, work, delay = np.array(rows).T
    waits = np.maximum(wall - work - delay, 0.0)
    simulated = tick * len(rows)
    return Stretch(
        name,
        simulated / wall.sum(),
        simulated / (wall.sum() - delay.sum()),
        work.sum() / simulated,
        float(wall.max()),
        float(waits.max()),
        float(np.quantile(waits, 0.999)),
        sink.dropped - dropped if sink is not None else 0,
    )


def _delay() -> float:
    """Return the time [s] for which this thread has waited for a core so far; 0 where the kernel keeps no books."""
    try:
        with open("/proc/thread-self/schedstat", "rb") as books:
            return 1e-9 * int(books.read().split()[1])
    except (OSError, IndexError):
        return 0.0


@contextmanager
def _solver_on_a_core_of_its_own() -> Iterator[set[int]]:
    """Keep this thread on the last core; yield the others, all of them where there is but one."""
    if not hasattr(os, "sched_setaffinity"):
        yield set()
        return
    before = os.sched_getaffinity(0)
    others = before - {max(before)} or before
    os.sched_setaffinity(0, {max(before)})
    try:
        yield others
    finally:
        os.sched_setaffinity(0, before)


def _keep_to(pid: int, cores: set[int]) -> None:
    """Keep a process with all its threads to some cores: a viewer that draws without a graphics card would take all of them."""
    for thread in Path(f"/proc/{pid}/task").iterdir() if cores else ():
        os.sched_setaffinity(int(thread.name), cores)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


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
