# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compiling beside the node: one thread for all jobs, none when there is nothing to do."""

import os
import subprocess
import sys
import threading
import time

from bearing_sim.ros.warm_up import WarmUp, levels_to_compile
from bearing_sim.runtime.live import governor_of
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Simulation


def ended(warm_up):
    """Return whether the work ends in a generous time."""
    end = time.monotonic() + 30.0
    while warm_up.is_working and time.monotonic() < end:
        time.sleep(0.01)
    return not warm_up.is_working


def test_jobs_run_one_after_the_other_on_one_thread_that_then_ends():
    warm_up, began, threads = WarmUp(), [], set()
    for number in range(50):
        warm_up.request(lambda number=number: (began.append(number), threads.add(threading.get_ident())))
    assert ended(warm_up) and began == list(range(50))
    assert not [thread for thread in threading.enumerate() if thread.name == "warm-up"]


def test_jobs_asked_for_while_one_runs_wait_and_can_be_forgotten():
    warm_up, gate, done = WarmUp(), threading.Event(), []
    warm_up.request(lambda: gate.wait(30.0))
    for number in range(100):
        warm_up.request(lambda number=number: done.append(number))
    assert len([thread for thread in threading.enumerate() if thread.name == "warm-up"]) == 1
    warm_up.cancel()
    gate.set()
    assert ended(warm_up) and done == []
    warm_up.request(lambda: done.append("later"))
    assert ended(warm_up) and done == ["later"]


def test_a_process_compiles_what_the_cache_lacks_and_ends_with_the_node(monkeypatch):
    started = []

    def start(scene):
        started.append(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]))
        return started[-1]

    monkeypatch.setattr("bearing_sim.ros.warm_up.start_compiling", start)
    monkeypatch.setattr("bearing_sim.ros.warm_up.is_compiled_for", lambda scene: scene == "compiled")
    warm_up = WarmUp()
    warm_up.compile("compiled")
    assert not started
    warm_up.request(lambda: warm_up.compile("new"))
    while not started:
        time.sleep(0.01)
    warm_up.close()
    assert ended(warm_up) and started[0].poll() is not None, "the process is ended, and the thread does not wait for it"
    warm_up.compile("new")
    assert len(started) == 1, "none is started once the node has ended"


def test_levels_that_an_earlier_process_has_compiled_are_not_compiled_again():
    scene = load_scene("deng2017_table1", ["level=planar"])
    governor_of(Simulation(scene))
    assert levels_to_compile(scene) == []


def test_levels_are_compiled_where_the_cache_is_empty(tmp_path):
    program = (
        "from bearing_sim.ros.warm_up import levels_to_compile; from bearing_sim.scene.loader import load_scene; "
        "print(levels_to_compile(load_scene('deng2017_table1', ['level=planar'])))"
    )
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    assert (
        subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True).stdout == "['slip', 'steady']\n"
    )
