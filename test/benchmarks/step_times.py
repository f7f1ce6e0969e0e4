# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The longest of a million fixed steps beside the median, with everything recorded: ``python test/benchmarks/step_times.py``.

Each step is a call of its own, whose time by the clock includes Python's and that of its sample; every hundredth of a second of simulated
time the samples of that time go to a recording of all observables, which another process writes.  The load alternates between half and
all of the scene's every tenth of a second, so that contacts open and close.  Other columns have the same times by the thread's processor
clock, without waits for a core that other programs use, and the times by the clock of a loop that counts for as long as the median step and
does nothing else: its longest is what the machine itself withholds.  ``attempts`` above the steps are steps that had to be divided.
"""

import gc
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import click
import numpy as np
from level_speed import bench_scene, one_core

from bearing_sim.cli.options import json_option, level_type, set_option
from bearing_sim.cli.reporting import print_json, print_rows
from bearing_sim.model.sample import flat, new_block
from bearing_sim.recording.recorder import Recorder
from bearing_sim.simulation import Simulation

_SETTLING = 0.1  # [s]
_RECORD_EVERY = 0.01  # [s]
_LOAD_EVERY = 0.1  # [s]
_QUANTILES = {"median": 0.5, "99 %": 0.99, "99.99 %": 0.9999, "longest": 1.0}


def step_times(level: str, speed: float, step: float, steps: int, overrides: tuple[str, ...] = ()) -> dict:
    """Take fixed steps one by one and return quantiles of their times [us], by the clock and by the processor, and the work done.

    Parameters
    ----------
    level : that takes steps.
    speed : of the shaft [rpm].
    step : length of a step [s].
    steps : how many.
    overrides : of fields of the scene.
    """
    scene = bench_scene(level, speed, [f"integration.fixed_step={step} s", *overrides])
    simulation, taken = Simulation(scene), np.zeros((2, steps), np.int64)
    simulation.advance(_SETTLING)
    before, start = simulation.counters, simulation.inputs
    per_record, per_load = max(round(_RECORD_EVERY / step), 1), max(round(_LOAD_EVERY / step), 1)
    block = new_block(per_record, scene.bearing.roller.count)
    with ExitStack() as opened:
        folder, recorder = opened.enter_context(tempfile.TemporaryDirectory()), opened.enter_context(Recorder())
        recording = recorder.open(Path(folder) / "run.mcap", scene, time.time_ns())
        opened.enter_context(one_core())  # the recorder's process has the other cores
        gc.collect()
        gc.disable()
        try:
            for k in range(steps):
                half = 0.5 if k // per_load % 2 else 1.0
                inputs = start._replace(load_y=half * start.load_y, load_z=half * start.load_z) if k % per_load == 0 else None
                spent, began = time.thread_time_ns(), time.perf_counter_ns()
                flat(block)[k % per_record] = flat(simulation.advance(step, inputs))[0]
                if (k + 1) % per_record == 0:
                    recording.write(block.copy())
                taken[0, k], taken[1, k] = time.perf_counter_ns() - began, time.thread_time_ns() - spent
        finally:
            gc.enable()
        recording.close(60.0)
        dropped = recording.dropped
    after, idle = simulation.counters, _counting_times(steps, float(np.median(taken[0])))
    attempts = after.steps + after.rejected_steps - before.steps - before.rejected_steps
    quantiles = {name: 1e-3 * np.quantile(np.vstack([taken, idle]), q, axis=1) for name, q in _QUANTILES.items()}
    return {
        "level": level,
        "speed_rpm": speed,
        "steps": steps,
        "attempts": attempts,
        "dropped": dropped,
        "clock_us": {name: float(value[0]) for name, value in quantiles.items()},
        "processor_us": {name: float(value[1]) for name, value in quantiles.items()},
        "counting_us": {name: float(value[2]) for name, value in quantiles.items()},
        "later_than_a_step": int(np.count_nonzero(taken[0] > 1e9 * step)),
    }


def _counting_times(steps: int, nanoseconds: float) -> np.ndarray:
    taken = np.zeros(steps, np.int64)
    rounds, began = 0, time.perf_counter_ns()
    while time.perf_counter_ns() - began < 1e9:
        rounds += 1
    rounds = max(int(rounds * nanoseconds * 1e-9), 1)
    for k in range(steps):
        began = time.perf_counter_ns()
        for _ in range(rounds):
            time.perf_counter_ns()
        taken[k] = time.perf_counter_ns() - began
    return taken


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--level", type=level_type, default="planar", show_default=True)
@click.option("--speed", type=float, default=45000.0, show_default=True, help="Of the shaft, in rpm.")
@click.option("--step", type=float, default=40e-6, show_default=True, help="In seconds.")
@click.option("--steps", type=int, default=1_000_000, show_default=True)
@set_option
@json_option
def main(level: str, speed: float, step: float, steps: int, overrides: tuple[str, ...], as_json: bool) -> None:
    """Time fixed steps one by one, with everything recorded."""
    report = step_times(level, speed, step, steps, overrides)
    if as_json:
        print_json(report)
        return
    rows = [[name, *(f"{report[column][name]:.1f}" for column in ("clock_us", "processor_us", "counting_us"))] for name in _QUANTILES]
    title = f"{report['steps']} steps of {1e6 * step:g} us, {level} at {speed:g} rpm"
    print_rows(title, ["", "clock [us]", "processor [us]", "counting [us]"], rows)
    late, dropped = report["later_than_a_step"], report["dropped"]
    print(f"{report['attempts']} attempts; {late} steps took longer than they simulate; {dropped} blocks not recorded")


if __name__ == "__main__":
    main()
