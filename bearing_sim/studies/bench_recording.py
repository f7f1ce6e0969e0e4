# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What recording costs a live run: the solver's rate, and the worst that its thread is held up, with and without sinks.

Both kinds of run follow each other several times, because a machine's own noise comes and goes.
"""

import dataclasses
import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.runtime.live import LiveModel, cadence, warmed_up
from bearing_sim.scene import Scene
from bearing_sim.sinks.mcap_sink import McapSink

_INPUTS_EVERY = 0.02  # [s] between messages of speed and load
_REVIEW_EVERY = 0.05  # [s] as the node looks after its sinks
_ALL = 1e3  # [s]
_SETTLING = 1.0  # [s] left out at the start of each run


class Ticks(NamedTuple):
    """The ticks of one run.

    Attributes
    ----------
    spent, computed : wall time in the solver and processor time of its thread there [s], shape (ticks,).
    late : how long after it was due each tick was done [s], from the most punctual one on.
    cpu : processor time of the whole process over wall time.
    written : length of the recording [byte]; 0 without one.
    """

    spent: np.ndarray
    computed: np.ndarray
    late: np.ndarray
    cpu: float
    written: int


def recording_cost(scene: Scene, seconds: float, sample_rate: float, repetitions: int, progress: Callable[[str], None] = lambda text: None) -> dict:
    """Measure runs in real time without and with a recording of all observables.

    Parameters
    ----------
    scene : what is simulated.
    seconds : length of each run.
    sample_rate : samples recorded for each second [Hz].
    repetitions : runs of each kind.
    progress : told what is being done.

    Returns
    -------
    report : ``rate_ratio``, the solver's rate with the recording over that without; ``processor_rate_ratio``, likewise by the processor time
        of its thread, which other programs do not disturb but which leaves out waiting; ``worst_stall_ms``, the largest lateness of a tick
        beyond that of the runs without; all from medians of the runs.  Percentiles of both kinds, and what was written.
    """
    runs: dict[bool, list[Ticks]] = {False: [], True: []}
    with tempfile.TemporaryDirectory() as folder:
        for repetition in range(repetitions):
            for recorded in (False, True):
                progress(f"run {repetition + 1} of {repetitions} {'with' if recorded else 'without'} recording, {seconds:g} s")
                path = Path(folder) / f"run_{repetition}.mcap" if recorded else None
                runs[recorded].append(_run(scene, seconds, sample_rate, path))
    alone, recorded = (_summary(runs[kind], cadence(sample_rate).tick) for kind in (False, True))
    return {
        "scene": scene.name,
        "level": scene.level,
        "sample_rate": sample_rate,
        "seconds": seconds,
        "repetitions": repetitions,
        "rate_ratio": recorded["solver_rate"] / alone["solver_rate"],
        "processor_rate_ratio": recorded["solver_processor_rate"] / alone["solver_processor_rate"],
        "worst_stall_ms": recorded["late_worst_ms"] - alone["late_worst_ms"],
        "p999_stall_ms": recorded["late_p999_ms"] - alone["late_p999_ms"],
        "recording_mb_per_second": float(np.median([run.written for run in runs[True]])) / 1e6 / seconds,
        "without": alone,
        "with": recorded,
    }


def _summary(runs: list[Ticks], tick: float) -> dict:
    def median(figure: Callable[[Ticks], float]) -> float:
        return float(np.median([figure(run) for run in runs]))

    return {
        "ticks": int(median(lambda run: len(run.spent))),
        "solver_rate": median(lambda run: tick / run.spent.mean()),
        "solver_processor_rate": median(lambda run: tick / run.computed.mean()),
        "spent_median_ms": median(lambda run: 1e3 * np.median(run.spent)),
        "spent_worst_ms": median(lambda run: 1e3 * run.spent.max()),
        "late_p50_ms": median(lambda run: 1e3 * np.percentile(run.late, 50)),
        "late_p99_ms": median(lambda run: 1e3 * np.percentile(run.late, 99)),
        "late_p999_ms": median(lambda run: 1e3 * np.percentile(run.late, 99.9)),
        "late_worst_ms": median(lambda run: 1e3 * run.late.max()),
        "processor_share": median(lambda run: run.cpu),
    }


class _Watched:
    """A simulation that notes when each tick began and ended."""

    def __init__(self, simulation):
        self._simulation = simulation
        self.begun: list[float] = []
        self.ended: list[float] = []
        self.computed: list[float] = []

    def __getattr__(self, name: str):
        return getattr(self._simulation, name)

    def advance(self, *arguments):
        self.begun.append(time.perf_counter())
        before = time.thread_time()
        block = self._simulation.advance(*arguments)
        self.computed.append(time.thread_time() - before)
        self.ended.append(time.perf_counter())
        return block


def _run(scene: Scene, seconds: float, sample_rate: float, path: Path | None) -> Ticks:
    watched = _Watched(warmed_up(scene, sample_rate))
    start_ns = time.time_ns()
    live = LiveModel(scene, watched, start_ns, sample_rate, maximum_lag=_ALL)  # no time is given up, so that ticks stay countable
    if path is not None:
        live.attach("record", McapSink(path, scene, start_ns, replace=True))
    operating = scene.operating
    load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
    began, began_cpu, reviewed = time.perf_counter(), time.process_time(), 0.0
    while (now := time.perf_counter() - began) < seconds + _SETTLING:
        speed = operating.shaft_speed * (1.0 + 0.01 * math.sin(now))
        live.offer("shaft_speed", (speed,), time.time_ns(), time.time_ns())
        live.offer("radial_load", load, time.time_ns(), time.time_ns())
        if now - reviewed >= _REVIEW_EVERY:
            reviewed = now
            live.collect(time.time_ns())
        time.sleep(_INPUTS_EVERY)
    cpu = (time.process_time() - began_cpu) / (time.perf_counter() - began)
    live.close()
    begun, ended, computed = (np.array(noted) for noted in (watched.begun, watched.ended, watched.computed))
    kept = begun > begun[0] + _SETTLING
    tick = cadence(sample_rate).tick
    late = ended[kept] - tick * np.arange(kept.sum())
    return Ticks((ended - begun)[kept], computed[kept], late - late.min(), cpu, path.stat().st_size if path is not None else 0)


def at_level(scene: Scene, level: str | None) -> Scene:
    """Return the scene at another level."""
    return scene if level is None else dataclasses.replace(scene, level=level)
