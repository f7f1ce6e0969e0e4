# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The command that measures a node from another process: its figures are there, hang together, and mean what they say."""

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from measure import Cost, _share, cost_of  # noqa: E402
from node_overhead import _wait_until_running  # noqa: E402
from ros_bench import fresh_domain  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.runtime.solver_threads import THREAD_NAME, name_this_thread  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402

pytestmark = pytest.mark.timeout(240)
ROOT = Path(__file__).resolve().parents[1]
NODE_OVERHEAD = str(ROOT / "test/benchmarks/node_overhead.py")


def test_the_cost_of_a_thread_is_found_under_its_name():
    busy = threading.Event()

    def work():
        name_this_thread("a-busy-thread-with-a-long-name")
        end = time.thread_time() + 0.3
        while time.thread_time() < end:
            pass
        busy.set()
        time.sleep(1.0)

    thread = threading.Thread(target=work)
    thread.start()
    assert busy.wait(60.0)
    cost = cost_of(os.getpid())
    assert cost.by_thread["a-busy-thread-w"] == pytest.approx(0.3, abs=0.05)
    assert cost.memory > 1e7
    thread.join()


@pytest.mark.long
def test_a_node_is_measured_over_dds_and_the_figures_hang_together():
    words = [sys.executable, NODE_OVERHEAD, "--level", "slip", "--duration", "2", "--rate", "50", "--record", "--json"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(fresh_domain()), "PYTHONPATH": str(ROOT)}
    found = subprocess.run(words, capture_output=True, text=True, timeout=200, check=True, env=environment)
    (case,) = json.loads(found.stdout)
    assert (case["level"], case["rate_hz"], case["exit_code"]) == ("slip", 50.0, 0)
    assert case["topics_subscribed"] == len(topics.outputs(load_scene("deng2017_table1", ["level=slip"])))
    assert 0.0 < case["ending_s"] < 10.0 and case["recorded_mb"] > 0.02, "the node has completed its recording"
    assert case["input_rate_hz"] == pytest.approx(48.5), "detuned, so that no one phase between inputs and outputs decides the latency"
    assert case["period_ms"] > 19.0, "no faster than asked for, however busy the machine"
    assert case["period_error_percent"] == pytest.approx(100 * (case["period_ms"] / 20.0 - 1.0))
    assert 0.0 < case["latency_p50_ms"] <= case["latency_p99_ms"]
    # What the shaft's angle says of the simulated time and what the node says to have lost are told apart by nothing else.
    assert case["real_time_factor"] + case["time_lost_s"] / case["seconds"] > 0.9 and case["real_time_factor"] < 1.05
    assert case["cpu_solver_percent"] > 0.0 and case["cpu_without_solver_percent"] > 0.0
    assert sum(case["cpu_by_thread_percent"].values()) == pytest.approx(case["cpu_solver_percent"] + case["cpu_without_solver_percent"], abs=0.1)
    assert 50.0 < case["memory_at_10_s_mb"] < 1000.0


def test_a_topic_that_there_is_not_is_named_with_those_that_there_are():
    words = [sys.executable, NODE_OVERHEAD, "--listen", "cage_slip,cage_skid", "--duration", "4"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(fresh_domain()), "PYTHONPATH": str(ROOT)}
    found = subprocess.run(words, capture_output=True, text=True, timeout=200, env=environment)
    assert found.returncode == 1 and "unknown output topic 'cage_skid'; the topics are cage_slip, rating_life," in found.stderr
    assert "Traceback" not in found.stderr


def test_a_node_that_does_not_begin_is_told_in_its_own_words(tmp_path):
    silent = SimpleNamespace(is_matched=False, received=[], receive=lambda: None)
    with open(tmp_path / "log", "w+b") as log:
        node = subprocess.Popen([sys.executable, "-c", "raise SystemExit('bearing_node: no such scene')"], stdout=log, stderr=subprocess.STDOUT)
        with pytest.raises(RuntimeError, match="did not start; its log:\nbearing_node: no such scene"):
            _wait_until_running(silent, node, log)


def test_shares_of_a_core_are_the_cost_over_the_time_and_new_threads_count_from_nothing():
    before = Cost({THREAD_NAME: 4.0, "idle": 1.0}, 1e8)
    after = Cost({THREAD_NAME: 5.0, "idle": 1.0, "new": 0.5}, 2e8)
    assert _share(before, after, 4.0) == {
        "cpu_percent": 37.5,
        "cpu_solver_percent": 25.0,
        "cpu_without_solver_percent": 12.5,
        "memory_mb": 200.0,
        "cpu_by_thread_percent": {THREAD_NAME: 25.0, "new": 12.5},
    }
