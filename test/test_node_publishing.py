# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""When and how often a running node publishes, with rclpy's executor of events and without it."""

import ctypes
import os
import signal
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.utilities import get_rmw_implementation_identifier  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import SetBool  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros.interface import DeferredCall  # noqa: E402

pytestmark = pytest.mark.timeout(300)

# A module that runs the node of a rclpy that has no executor of events, and says which it is spun by.
_WITHOUT_EVENTS = """
import sys
import rclpy.experimental
del rclpy.experimental.EventsExecutor
sys.modules.pop("rclpy.experimental.events_executor")
from bearing_sim.ros import node, process
make_executor = process.make_executor
def told():
    executor = make_executor()
    print(f"spun by {type(executor).__name__}", flush=True)
    return executor
process.make_executor = told
sys.exit(node.main())
"""

# A module that runs a node whose timer stands still once the model runs, as where the system's clock is set back an hour.
_WITHOUT_TIMER = """
import sys
from bearing_sim.ros import node
create_steady_timer = node._create_steady_timer
def standing_still(of, period, callback):
    def called():
        if not (of.bearings and of.bearings[0].live and of.bearings[0].live.solver.newest is not None):
            callback()
    return create_steady_timer(of, period, called)
node._create_steady_timer = standing_still
sys.exit(node.main())
"""


@pytest.fixture
def launch(tmp_path):
    """Return a function that starts a node with parameters; ``module`` may be another one that runs it."""
    started = []

    def start(*parameters, module="bearing_sim.ros.node"):
        domain = fresh_domain()
        pairs = [word for parameter in ("governor:=false", *parameters) for word in ("-p", parameter)]
        process = NodeProcess(tmp_path, domain, "--ros-args", *pairs, module=module, limit=280)
        started.append((process, Client(domain)))
        return started[-1]

    yield start
    for process, client in started:
        client.close()
        process.end(signal.SIGKILL)


class Later:
    """A node and its executor, which does what it is asked for when told to."""

    def __init__(self):
        self.executor, self.asked = self, []

    def create_task(self, action):
        self.asked.append(action)

    def work(self):
        asked, self.asked = self.asked, []
        for action in asked:
            action()


def test_what_is_asked_for_again_before_it_is_done_is_done_once_and_what_comes_in_the_middle_of_it_is_not_missed():
    node, done = Later(), []
    soon = DeferredCall(node, lambda: (done.append(1), soon() if len(done) == 1 else None))
    for _ in range(5):
        soon()
    assert len(node.asked) == 1, "a slow executor does not queue it up"
    node.work()
    assert len(done) == 1 and len(node.asked) == 1
    node.work()
    assert len(done) == 2 and not node.asked
    node.executor = None
    soon()
    node.executor = node
    soon()
    assert len(node.asked) == 1, "what was asked for without an executor does not stand in the way"


def stamps(client):
    """Return the stamps of bearing_joints so far [s]."""
    return np.array([joints.header.stamp.sec + 1e-9 * joints.header.stamp.nanosec for joints in client.received["bearing_joints"]])


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """Return one node that runs, and its client."""
    domain = fresh_domain()
    words = ("--ros-args", "-p", "governor:=false", "-p", "publish_rate:=50")
    process, client = NodeProcess(tmp_path_factory.mktemp("publishing"), domain, *words, limit=280), Client(domain)
    at_work(process, client)
    yield process, client
    client.close()
    process.end(signal.SIGKILL)


def at_work(process, client):
    client.wait_until_matched(process)
    client.drive_until(lambda: len(client.received["bearing_joints"]) > 20, "outputs come", process)


@pytest.mark.long
@pytest.mark.parametrize("rate", [40.0, 30.0])
def test_outputs_are_stamped_at_the_publish_rate_also_where_it_does_not_divide_that_of_the_ticks(launch, rate):
    process, client = launch(f"publish_rate:={rate}")
    at_work(process, client)
    seen = len(stamps(client))
    client.drive(2.0)
    found = stamps(client)[seen:]
    # A machine that is busy is late and skips, from where the grid of periods begins anew; the mean over hours is in test_decimator.py.
    gaps = np.diff(found)
    assert len(found) > 20 and np.median(gaps) == pytest.approx(1.0 / rate, abs=0.0051) and gaps.min() > 0.0
    assert len(found) <= (found[-1] - found[0]) * rate * 1.1 + 2, "never more often than asked for"


def test_while_paused_nothing_is_published_and_afterwards_it_goes_on(running):
    process, client = running
    assert client.call(SetBool, "pause", SetBool.Request(data=True), process).success
    client.drive(0.5)
    before = len(stamps(client))
    client.drive(1.0)
    assert len(stamps(client)) == before
    assert client.call(SetBool, "pause", SetBool.Request(data=False), process).success
    client.drive_until(lambda: len(stamps(client)) > before + 20, "outputs come again", process)
    assert np.diff(stamps(client)).min() > 0.0


def test_a_listener_that_comes_later_is_served_and_one_that_is_not_there_costs_no_message(running):
    process, client = running
    late, again = [], []
    client.listen("std_msgs/msg/Float64MultiArray", "power", late.append)
    client.drive_until(lambda: len(late) > 10, "the late listener hears", process)
    client.listen("std_msgs/msg/Float64", "damage", again.append)
    client.drive_until(lambda: len(again) > 10, "another listener hears", process)
    assert late[-1].layout.dim[0].size == len(late[-1].data) == len(topics.ARRAYS["power"].fields) and 0.0 < again[-1].data < 1e-3


@pytest.mark.skipif(not hasattr(os, "SCHED_BATCH") or not Path("/proc/self/task").is_dir(), reason="needs Linux' policies and its /proc")
@pytest.mark.skipif("fastrtps" not in get_rmw_implementation_identifier(), reason="knows the timers of Fast DDS alone")
def test_the_timers_of_the_middleware_do_not_interrupt_who_publishes_and_all_other_threads_are_as_usual(running):
    process, _ = running
    limiter = process.process.pid  # whose one child the node is
    (pid,) = Path(f"/proc/{limiter}/task/{limiter}/children").read_text().split()
    kernel = ctypes.CDLL(None)  # its own view of policies, where Python's is what is tested
    found = {(thread / "comm").read_text().strip(): kernel.sched_getscheduler(int(thread.name)) for thread in Path(f"/proc/{pid}/task").iterdir()}
    timers = {name: policy for name, policy in found.items() if name.startswith("dds.ev")}
    assert "bearing-solver" in found and timers and set(timers.values()) == {os.SCHED_BATCH}
    assert {policy for name, policy in found.items() if name not in timers} == {os.SCHED_OTHER}


def test_the_node_runs_the_same_on_an_rclpy_that_has_no_executor_of_events(launch, tmp_path):
    (tmp_path / "without_events.py").write_text(_WITHOUT_EVENTS)
    recording = tmp_path / "run.mcap"
    process, client = launch(f"record:={recording}", "publish_rate:=50", module="without_events")
    at_work(process, client)
    seen = len(stamps(client))
    client.drive_until(lambda: len(stamps(client)) > seen + 50, "outputs keep coming", process)
    assert np.median(np.diff(stamps(client)[seen:])) == pytest.approx(0.02, abs=1e-6)
    assert client.call(SetBool, "pause", SetBool.Request(data=True), process).success
    assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text, process.text
    assert "spun by SingleThreadedExecutor" in process.text
    assert Recording(recording).samples > 50


def test_health_is_told_and_new_listeners_are_served_though_the_timer_stands_still(launch, tmp_path):
    (tmp_path / "without_timer.py").write_text(_WITHOUT_TIMER)
    process, client = launch("publish_rate:=50", module="without_timer")
    client.wait_until_matched(process)
    reports = client.received["diagnostics"]
    client.drive_until(lambda: len(client.received["bearing_joints"]) > 30 and "running" in client.values().get("phase", ""), "outputs come", process)
    seen, late = len(reports), []
    client.listen("std_msgs/msg/Float64MultiArray", "power", late.append)
    client.drive_until(lambda: len(reports) > seen + 1 and late, "diagnostics keep coming", process)
    assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text, process.text
