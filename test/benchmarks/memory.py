# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How the memory of long-lived processes grows: ``python test/benchmarks/memory.py cycles`` and ``python test/benchmarks/memory.py view``.

``cycles`` configures and cleans up a node again and again, as a lifecycle manager may, and reads the resident memory of its process.  With
``--empty-cache`` no earlier process has compiled the model, as after an installation.

``view`` shows samples at 100 Hz to a live view and reads the resident memory of its process.  The view's clock follows the samples instead of
wall time: it draws the same 20 pictures for each second of the run, and the run passes as fast as pictures are drawn.  What the process
keeps, it keeps by picture and sample, not by time.
"""

import multiprocessing
import os
import random
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import click
import numpy as np

from bearing_sim.cli.reporting import print_rows

_DOMAINS = range(60, 100)  # above the usual choices of users, below where ports collide with ephemeral ports
_PATIENCE = 60.0  # [s] for an answer of the node
_SAMPLE_RATE, _BLOCK = 100, 5  # [Hz], samples
_FLUSH_EVERY = 5  # blocks: four times a second, as `bearing_sim.view.worker` does


def resident_memory(pid: int | str) -> float:
    """Return the resident memory of a process [MB] (Linux)."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return 1e-6 * pages * os.sysconf("SC_PAGE_SIZE")


@click.group()
def main():
    """Measure the growth of memory."""


@main.command("cycles")
@click.option("--count", default=103, show_default=True, help="Cycles of configure and cleanup.")
@click.option("--stay", default=1.0, show_default=True, help="Time in state inactive [s]; a shorter one than the model takes to load ends it early.")
@click.option("--activate", is_flag=True, help="Activate and deactivate in each cycle.")
@click.option("--empty-cache", is_flag=True, help="Compile the model, as the first start after an installation does.")
@click.option("--parameter", "parameters", multiple=True, metavar="NAME:=VALUE", help="Parameter of the node; may be repeated.")
def cycles(count: int, stay: float, activate: bool, empty_cache: bool, parameters: tuple[str, ...]):
    """Configure and clean up a node again and again."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.SystemRandom().choice(_DOMAINS)))
    labels = ("configure", "activate", "deactivate", "cleanup") if activate else ("configure", "cleanup")
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | ({"XDG_CACHE_HOME": folder} if empty_cache else {})
        settings = [word for text in ("autostart:=false", *parameters) for word in ("-p", text)]
        command = [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", "--log-level", "error", *settings]
        node = subprocess.Popen(command, env=environment, cwd=folder)
        try:
            rows = list(_cycled(node.pid, count, labels, stay))
        finally:
            node.terminate()
            node.wait(_PATIENCE)
    print_rows(f"{' and '.join(labels)}, {stay:g} s in between", ("cycle", "memory [MB]", "threads", "open files"), rows)


def _cycled(pid: int, count: int, labels: tuple[str, ...], stay: float):
    """Yield a row of the table before the first cycle and after some of them."""
    import rclpy
    from lifecycle_msgs.msg import Transition
    from lifecycle_msgs.srv import ChangeState

    rclpy.init(args=[])
    try:
        caller = rclpy.create_node("memory_benchmark")
        service = caller.create_client(ChangeState, "bearing_node/change_state")
        if not service.wait_for_service(_PATIENCE):
            raise click.ClickException("the node did not start; see its messages above")
        yield _row(pid, 0)
        for cycle in range(1, count + 1):
            for label in labels:
                answer = service.call_async(ChangeState.Request(transition=Transition(label=label)))
                rclpy.spin_until_future_complete(caller, answer, timeout_sec=_PATIENCE)
                if not (answer.done() and answer.result().success):
                    raise click.ClickException(f"{label} of cycle {cycle} failed; see the node's messages above")
                if label in ("configure", "activate"):
                    time.sleep(stay)
            if cycle in (1, 3, 10, count) or cycle % 20 == 0:
                yield _row(pid, cycle)
    finally:
        rclpy.try_shutdown()


def _row(pid: int, cycle: int) -> tuple[str, ...]:
    counts = (len(os.listdir(f"/proc/{pid}/{kind}")) for kind in ("task", "fd"))
    return (str(cycle), f"{resident_memory(pid):.0f}", *map(str, counts))


@main.command("view")
@click.option("--minutes", default=22.0, show_default=True, help="Duration of the run.")
@click.option("--level", default="slip", show_default=True, help="Level of fidelity.")
@click.option("--port", default=9899, show_default=True, help="Port of the view on 127.0.0.1.")
def view(minutes: float, level: str, port: int):
    """Show a run to a live view."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:  # so that this process holds no compiled code
        scene, samples = pool.submit(_one_second, level).result()
    from bearing_sim.view import run_view

    passed = 0.0  # [s] of the run
    run_view.LiveFrames = partial(run_view.LiveFrames, clock=lambda: passed)
    shown = run_view.RunView(scene, None, port, run_view.ViewOptions(time.time_ns(), real_time=True))
    rows, next_row = [], 0.0
    for number in range(round(60 * minutes * _SAMPLE_RATE / _BLOCK)):
        first = number * _BLOCK
        block = samples[first % _SAMPLE_RATE : first % _SAMPLE_RATE + _BLOCK].copy()
        block["time"] = (first + np.arange(_BLOCK)) / _SAMPLE_RATE
        shown.write(block)
        passed = float(block["time"][-1])
        if number % _FLUSH_EVERY == 0:
            shown.flush()
        if passed >= next_row:
            rows.append((f"{passed / 60:.1f}", f"{resident_memory('self'):.0f}"))
            next_row += 30.0 if passed < 300.0 else 120.0
    rows.append((f"{passed / 60:.1f}", f"{resident_memory('self'):.0f}"))
    print_rows(f"live view of level {level}, no viewer connected", ("minute", "memory [MB]"), rows)
    sys.stdout.flush()
    os._exit(0)  # the server would wait for viewers


def _one_second(level: str):
    """Return a scene and a second of its samples."""
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.simulation import Simulation

    scene = load_scene("deng2017_table1", [f"level={level}"])
    return scene, Simulation(scene).advance(1.0, samples=_SAMPLE_RATE)


if __name__ == "__main__":
    main()
