# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a live view costs the solver in every state of its viewers, and how an hour at 1 kHz opens: ``python test/benchmarks/view_overhead.py``.

The solver runs as fast as it can, with a thousand samples for each second of wall time.  In every other stretch it hands its blocks to the view
(see `paired`).  The time between two ticks is split, by the kernel's scheduler statistics, into the thread's own work, its wait for a core, which
other programs cause, and the rest: waits for the interpreter's lock, a queue or the disk, which the view would cause.  Viewers draw without a
graphics card, on any core, in idle time, as ``live.launch.py`` starts them (`bearing_sim.recording.priority`).

How to read it: compare each rate with its control, and with the last situation.  Cores of one machine share caches, memory and thermal budget.
The last situation therefore replaces the view by a program that only counts: what that costs the solver, any program on another core costs.
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

import click
import numpy as np
from paired import CONTROL, WITH, ThreadStatistics, each_ratio, order, spread, stolen_share

from bearing_sim.cli.options import json_option, quick_option
from bearing_sim.cli.reporting import FailedRun, announce_compilation, print_json, print_rows
from bearing_sim.recording.priority import in_idle_time
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Simulation
from bearing_sim.view.screenshot import HeadlessViewer, ViewerFailed
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import free_port
from bearing_sim.view.worker import RerunFile

_SCENE = ("deng2017_table1", ("level=slip", "operating.shaft_speed=15000 rpm"))
_TICK, _SAMPLES = 0.005, 5  # [s] approximate wall time of a tick, and samples in it
_STRETCH, _SETTLING = 0.25, 0.25  # [s] of wall time of a stretch, and of the lag of the view, ignored before it
_PROGRAM = "n = 0\nwhile True: n += 1"
_HOUR, _RATE = 3600.0, 1000.0  # [s], [Hz]


class Stretch(NamedTuple):
    """Performance of the solver in one stretch.

    Attributes
    ----------
    wall_rate : simulated seconds for each second of wall time.
    rate : the same for each second in which a core was available.
    share : fraction of the wall time in which the thread had a core and computed.  When the host slows a core for a moment, as shared
        machines do, rates change by more than a view costs, but this share does not.
    processor_rate : simulated seconds for each second of the thread's processor time, from the fastest quartile of ticks: the others share
        caches and memory with whatever runs on other cores.
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
    """Measure the solver without a view and with one, while viewers are absent, attached, frozen and killed.

    Parameters
    ----------
    seconds : wall time of each situation [s].
    frozen : wall time for which viewer, and then view, are frozen [s].
    progress : called with a text on each situation.

    Returns
    -------
    situations : list of dicts: ``name``; ``with`` and ``control``: for each of `RATES` the ratio of the stretches with the view, and of the
        controls, to the neighbouring stretches without, as `paired.Spread`; the worst times of the stretches with and
        without; ``dropped``: blocks that the view missed.  In the last, `COUNTING`, a program that counts runs in place of the view.
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
    """Run a program that only counts; yield the function that continues (True) or stops it (False)."""
    program = subprocess.Popen(in_idle_time([sys.executable, "-I", "-S", "-c", _PROGRAM]))
    try:
        yield lambda runs: os.kill(program.pid, signal.SIGCONT if runs else signal.SIGSTOP)
    finally:
        program.kill()
        program.wait()


def _measure(
    simulation: Simulation, tick: float, seconds: float, write: Callable[[np.ndarray], None], switch: Callable[[bool], None] = lambda on: None
) -> dict:
    """Run the solver on this thread for a while; the load under test is switched on, and receives every block, in its stretches only."""
    length = min(_STRETCH, seconds / 5)
    kinds = order(max(1, int(seconds / (4 * (length + _SETTLING)))))
    books = ThreadStatistics()
    found = []
    for kind in kinds:
        switch(kind == WITH)
        fed = write if kind == WITH else None
        _run(simulation, tick, min(_SETTLING, length), fed, books)
        found.append(_stretch(_run(simulation, tick, length, fed, books), tick))
    books.close()
    found_ratios = {(kind, rate): each_ratio(kinds, [getattr(one, rate) for one in found], kind) for kind in (WITH, CONTROL) for rate in RATES}
    worst = {
        f"{figure}_{label}": spread(getattr(one, figure) for kind, one in zip(kinds, found) if (kind == WITH) == fed).median
        for figure in ("wall_rate", "worst_tick", "worst_wait", "late_wait")
        for label, fed in (("with", True), ("without", False))
    }
    return {"seconds": seconds, "ratios": found_ratios, **worst}


def _run(simulation: Simulation, tick: float, seconds: float, write: Callable[[np.ndarray], None] | None, books: ThreadStatistics) -> np.ndarray:
    """Return wall time, processor time of this thread and its wait for a core [s] of each tick, shape (ticks, 3)."""
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
    """Keep this thread, but none that it has started, on the last core; everything else runs anywhere."""
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
    """Write ``seconds`` [s] at 1 kHz, of level slip at low speed with a varying load, and open them.

    Returns
    -------
    samples, bytes : of the run, and of its file.
    writing_seconds, opening_seconds : time to simulate and write, and until the viewer shows the whole run.
    viewer_bytes : peak memory of the viewer.
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
    with RerunFile(scene, path, duration=seconds) as sink:
        while written < round(seconds * _RATE):
            share = 1.0 + 0.5 * np.sin(2 * np.pi * written / _RATE / 300.0)
            sink.write(simulation.advance(count / _RATE, given._replace(load_y=given.load_y * share), count))
            written += count
    return written


def _peak_memory(pid: int) -> int:
    """Return the peak memory [bytes] of a process."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return 1024 * int(line.split()[1])
    return 0


@click.command()
@click.option("--seconds", type=click.FloatRange(min=0.1), default=60.0, show_default=True, metavar="S", help="Duration of each situation.")
@click.option(
    "--frozen", type=click.FloatRange(min=0.1), default=60.0, show_default=True, metavar="S", help="Duration for which the viewer is frozen."
)
@quick_option
@json_option
def command(seconds, frozen, quick, as_json):
    """Measure what a live view costs the solver while viewers are absent, attached, frozen and killed, and how an hour's recording opens.

    Needs a Vulkan driver; a software driver is sufficient.
    """

    def progress(text):
        click.echo(f"{text} ...", err=True)

    announce_compilation()
    try:
        report = run_view_bench(min(seconds, 1.0) if quick else seconds, min(frozen, 1.0) if quick else frozen, progress)
        report["hour"] = run_hour(*([120.0] if quick else []), progress=progress)
    except ViewerFailed as error:
        raise FailedRun(f"no viewer to measure with: {error}") from None
    if as_json:
        print_json(report)
    else:
        _print(report)


def _print(report) -> None:
    def spread(found):
        return f"{found['median']:.4f} ({found['low']:.4f} to {found['high']:.4f})"

    columns = ("while", "pairs", "rate, by wall", "control", "share of time computing", "control", "by processor time", "worst wait [ms]", "missed")
    shown = (("with", "wall_rate"), ("control", "wall_rate"), ("with", "share"), ("control", "share"), ("with", "processor_rate"))
    rows = []
    for row in (*report["situations"], {"name": "all with a view, together", **report["together"]}):
        spreads = [spread(row[kind][name]) for kind, name in shown]
        waits = f"{1e3 * row['worst_wait_with']:.2f}, without {1e3 * row['worst_wait_without']:.2f}" if "worst_wait_with" in row else ""
        rows.append((row["name"], str(row["with"]["rate"]["pairs"]), *spreads, waits, str(row.get("dropped", ""))))
    title = f"the solver with a live view, 1000 samples per second, relative to stretches of {report['stretch']:g} s without; "
    print_rows(f"{title}load average {report['load_average']:.2f}", columns, rows, words=("while",), width=220)
    click.echo("median, and its 95 % confidence interval; a wait is the time in which a tick neither worked nor waited for a core")
    hour = report["hour"]
    click.echo(
        f"{hour['simulated_seconds']:g} s at 1 kHz: {hour['samples']} samples, {hour['bytes'] / 1e6:.1f} MB, made "
        f"in {hour['writing_seconds']:.0f} s, opened in {hour['opening_seconds']:.1f} s with {hour['viewer_bytes'] / 1e6:.0f} MB in the viewer"
    )


if __name__ == "__main__":
    command()
