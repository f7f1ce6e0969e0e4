# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Replay the logs of 200 turbines, a month at 10 min each, on a Dask cluster of two processes of which one is killed midway.

``python test/benchmarks/fleet_of_logs.py`` makes synthetic logs, replays them on this machine and then on the cluster, and prints whether the
table is complete and the same, what was computed twice, and how many bearing-years an hour of computing are replayed.
"""

import argparse
import collections
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from distributed import LocalCluster
from distributed.diagnostics.plugin import SchedulerPlugin

from bearing_sim.sweep.table import read_table

ROWS, SPACING = 4464, 600  # of a month of 31 days at 10 min [s]
YEAR = 365.25 * 86400.0  # [s]

SCENE = """
name: gearbox
level: steady
bearing: NU 232 ECM
lubricant: {oil: ISO VG 320 PAO, temperature: 55 degC, supply: circulating}
operating: {shaft_speed: 1500 rpm, radial_load: 20 kN}
table: {tolerance: 5 %, maximum_load: 100 kN}
"""
MAPPING = """
name: scada
time: {column: time, format: iso}
shaft_speed: {column: "generator speed [rpm]"}
radial_load: {law: sum, columns: [{column: "load [kN]"}]}
oil_temperature: {column: "oil [degC]"}
"""


def write_log(path: Path, turbine: int) -> None:
    """Write the invented log of a turbine: wind that wanders over days, stops below 3.5 m/s, oil that warms up with the power."""
    random = np.random.default_rng([2017, turbine])
    wander, steps = np.zeros(ROWS), 0.1 * random.standard_normal(ROWS)
    for k in range(1, ROWS):
        wander[k] = 0.995 * wander[k - 1] + steps[k]
    wind = np.clip(8.0 + 3.0 * wander + 0.5 * random.standard_normal(ROWS), 0.5, 25.0)
    runs = wind > 3.5
    power = np.where(runs, np.clip(2.5 * wind**3, 0.0, 1300.0), 0.0)
    speed = np.where(runs, np.clip(900.0 + 60.0 * wind, 1000.0, 1500.0) * (1.0 + 0.003 * random.standard_normal(ROWS)), 0.0)
    oil = 20.0 + np.convolve(np.where(runs, 35.0 + 0.01 * power, 0.0), np.full(12, 1 / 12), "same") + random.standard_normal(ROWS)
    times = np.datetime64("2026-01-01T00:00:00") + np.arange(ROWS) * np.timedelta64(SPACING, "s")
    load = 1.5 + 0.037 * power
    lines = [f"{at},{n:.1f},{force:.3f},{warm:.1f}" for at, n, force, warm in zip(times, speed, load, oil)]
    path.write_text("time,generator speed [rpm],load [kN],oil [degC]\n" + "\n".join(lines) + "\n")


class Computations(SchedulerPlugin):
    """Counts how often each task of the cluster was computed."""

    def __init__(self):
        self.counts = collections.Counter()

    def transition(self, key, start, finish, *args, **kwargs):
        """Count a task that has just been computed."""
        if start == "processing" and finish == "memory":
            self.counts[str(key)] += 1


def replay(folder: Path, name: str, *more: str) -> tuple[subprocess.Popen, float]:
    """Start the command on all logs in a folder; return the process and when it was started."""
    words = [
        "replay-fleet",
        folder / "logs",
        "--mapping",
        folder / "scada.yaml",
        "--scene",
        folder / "scene.yaml",
        "-o",
        folder / name,
        "--json",
        *more,
    ]
    command = [sys.executable, "-m", "bearing_sim.cli", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True), time.perf_counter()


def finished(started: tuple[subprocess.Popen, float]) -> tuple[dict, float]:
    """Return the report of a command and how long it took [s]."""
    process, since = started
    report = json.loads(process.communicate()[0])
    return report, time.perf_counter() - since


def lines_of(path: Path) -> int:
    """Return how many results a journal has."""
    return path.read_bytes().count(b"\n") if path.exists() else 0


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=200)
    count = parser.parse_args().logs
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "logs").mkdir()
        for turbine in range(count):
            write_log(folder / "logs" / f"T{turbine:03d}.csv", turbine)
        (folder / "scene.yaml").write_text(SCENE)
        (folder / "scada.yaml").write_text(MAPPING)
        bearing_years = count * ROWS * SPACING / YEAR
        report, seconds = finished(replay(folder, "alone.parquet"))
        print(
            f"{count} logs, {bearing_years:.1f} bearing-years: {seconds:.0f} s on all cores, with the table of operating points if it was not on disk"
        )
        plugin = Computations()
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as cluster:
            cluster.scheduler.add_plugin(plugin)
            started = replay(folder, "cluster.parquet", "--dask", cluster.scheduler_address)
            journal = folder / "cluster.journal"
            while lines_of(journal) < 1.5 * count:  # the first half are surveys
                time.sleep(0.05)
            victim, kept = next(iter(cluster.workers.values())).pid, lines_of(journal)
            os.kill(victim, signal.SIGKILL)
            report, seconds = finished(started)
            again, _ = finished(replay(folder, "cluster.parquet", "--dask", cluster.scheduler_address))
        alone, table = read_table(folder / "alone.parquet"), read_table(folder / "cluster.parquet")
        keys = [json.loads(line)["key"] for line in (folder / "cluster.journal").read_text().splitlines()]
        before = {f"bearing_sim-{key}" for key in keys[:kept]}
        twice = [key for key, times in plugin.counts.items() if times > 1]
        print(f"on a cluster of two processes, one killed after {kept - count} of {count} replays: {seconds:.0f} s")
        print(
            f"rows {len(table.rows)}, ok {table.values('status').count('ok')}, the same as without a cluster: {repr(table.rows) == repr(alone.rows)}"
        )
        print(f"computed twice: {len(twice)} that the killed worker had under way, {len(before.intersection(twice))} of those that were kept")
        print(f"entries of the journal {len(keys)}, different {len(set(keys))}; the same command again computes {again['computed']}")
        print(f"bearing-years an hour: {3600.0 * bearing_years / seconds:.0f}; processor: {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
