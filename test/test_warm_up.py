# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compiling beside the node: one thread for all jobs, none when there is nothing to do."""

import threading
import time

from bearing_sim.ros.warm_up import WarmUp


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
