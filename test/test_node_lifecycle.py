# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's life over its lifecycle services: every state answers, tells its reasons, ends in order, and leaks nothing."""

import os
import signal
import time
from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

import rclpy  # noqa: E402
from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState, GetState  # noqa: E402
from rclpy.lifecycle import TransitionCallbackReturn  # noqa: E402
from rclpy.task import Future  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402

from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros import interface  # noqa: E402
from bearing_sim.ros.node import BearingNode  # noqa: E402

pytestmark = pytest.mark.timeout(300)
STATES = ("unconfigured", "inactive", "active", "finalized")


class Managed:
    """A node that somebody manages, and a client that does."""

    def __init__(self, folder, *parameters, environment=None):
        domain = fresh_domain()
        pairs = [word for parameter in ("autostart:=false", "governor:=false", *parameters) for word in ("-p", parameter)]
        self.process = NodeProcess(folder, domain, "--ros-args", *pairs, limit=280, **(environment or {}))
        self.client = Client(domain)

    def change(self, label):
        """Ask for a transition; return whether it was made and the state then."""
        made = self.client.call(ChangeState, "change_state", ChangeState.Request(transition=Transition(label=label)), self.process)
        return made.success, self.state()

    def state(self):
        return self.client.call(GetState, "get_state", GetState.Request(), self.process).current_state.label

    def told(self, words, since=0):
        """Wait until diagnostics say some words; return the status."""
        found = lambda: [status for status in self.client.statuses(since) if words in status[2]]  # noqa: E731
        self.client.spin_until(found, f"diagnostics say {words!r}", self.process)
        return found()[-1]

    def run(self):
        """Configure, activate and drive until slip comes."""
        assert self.change("configure") == (True, "inactive") and self.change("activate") == (True, "active")
        self.client.wait_until_matched(self.process)
        seen = len(self.client.received["cage_slip"])
        self.client.drive_until(lambda: len(self.client.received["cage_slip"]) > seen, "slip comes", self.process)

    def close(self):
        self.client.close()
        self.process.end(signal.SIGKILL)


@pytest.fixture
def managed(tmp_path):
    """Return a function that starts a managed node."""
    started = []

    def start(*parameters, **environment):
        started.append(Managed(tmp_path, *parameters, environment=environment))
        return started[-1]

    yield start
    for node in started:
        node.close()


def test_each_state_is_reached_by_its_transition_and_told_in_diagnostics_and_slip_comes_in_active_alone(managed):
    node = managed()
    assert node.told("waiting to be configured")[:2] == (0, "bearing_node: run.unconfigured")
    assert node.change("configure") == (True, "inactive")
    assert node.told("ready to be activated")[:2] == (0, "bearing_node: run.inactive")
    assert not node.client.received["cage_slip"]
    assert node.change("activate") == (True, "active")
    node.client.wait_until_matched(node.process)
    node.client.drive_until(lambda: node.client.received["cage_slip"], "slip comes", node.process)
    node.client.drive_until(lambda: node.client.values().get("state") == "active", "the state is told", node.process)
    assert node.change("deactivate") == (True, "inactive")
    node.client.spin(0.3)
    held = len(node.client.received["cage_slip"])
    node.client.drive(0.5)
    assert len(node.client.received["cage_slip"]) == held
    assert node.change("activate") == (True, "active")
    node.client.drive_until(lambda: len(node.client.received["cage_slip"]) > held, "slip comes again", node.process)
    assert node.change("deactivate") == (True, "inactive") and node.change("cleanup") == (True, "unconfigured")
    assert node.change("unconfigured_shutdown")[0] or node.change("shutdown")[0]
    assert node.told("shut down")[:2] == (0, "bearing_node: run.finalized")
    assert node.process.end(signal.SIGTERM) == 0 and "Traceback" not in node.process.text


def test_a_transition_that_the_state_does_not_have_is_answered_by_no_and_harms_nothing(managed):
    node = managed()
    for label in ("activate", "deactivate", "cleanup", "nonsense"):
        assert node.change(label) == (False, "unconfigured"), label
    for number in (3, 99):
        answer = node.client.call(ChangeState, "change_state", ChangeState.Request(transition=Transition(id=number)), node.process)
        assert not answer.success
    node.run()
    assert node.change("configure") == (False, "active")
    assert node.process.process.poll() is None and "Traceback" not in node.process.text


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("state", STATES)
def test_a_signal_ends_the_node_in_every_state_with_code_0_and_its_recording_complete(managed, tmp_path, state, number):
    node = managed(f"record:={tmp_path / 'run.mcap'}")
    if state == "finalized":
        assert node.change("shutdown")[1] == "finalized"
    elif state == "inactive":
        assert node.change("configure") == (True, "inactive")
    elif state == "active":
        node.run()
    else:
        node.told("waiting to be configured")
    began = time.monotonic()
    assert node.process.end(number) == 0, node.process.text
    assert time.monotonic() - began < 10.0  # two seconds on a machine of its own
    assert "Traceback" not in node.process.text and "terminate called" not in node.process.text
    assert [path.name for path in tmp_path.glob("run*")] == (["run.mcap"] if state == "active" else [])
    if state == "active":
        assert Recording(tmp_path / "run.mcap").samples > 0


@pytest.mark.long
def test_the_node_answers_while_it_compiles_and_begins_by_itself_when_that_is_done(managed, tmp_path):
    node = managed("overrides:=['level=slip']", XDG_CACHE_HOME=str(tmp_path / "empty_cache"))
    assert node.change("configure") == (True, "inactive")
    assert node.told("warming up, not monitored yet")[:2] == (1, "bearing_node: run.warming_up")
    assert node.change("activate") == (True, "active"), "activation does not wait for the compiler"
    assert node.change("deactivate") == (True, "inactive") and node.change("cleanup") == (True, "unconfigured")
    assert node.process.end(signal.SIGTERM) == 0 and "Traceback" not in node.process.text


def test_a_scene_file_broken_under_a_running_node_harms_at_the_next_configure_alone_and_says_why(managed, tmp_path):
    good = "name: mine\nlevel: slip\nbearing: deng2017_table1\nlubricant: {oil: mil_l_7808}\noperating: {shaft_speed: 9000 rpm, radial_load: 800 N}\n"
    scene = tmp_path / "mine.yaml"
    scene.write_text(good)
    node = managed(f"scene:={scene}")
    node.run()
    scene.write_text(good.replace("800 N", "800 parsec"))
    seen = len(node.client.received["cage_slip"])
    node.client.drive_until(lambda: len(node.client.received["cage_slip"]) > seen + 5, "the model goes on", node.process)
    assert node.change("deactivate") == (True, "inactive") and node.change("activate") == (True, "active"), "the last good scene is kept"
    assert node.change("deactivate") == (True, "inactive") and node.change("cleanup") == (True, "unconfigured")
    seen = len(node.client.received["diagnostics"])
    assert node.change("configure") == (False, "unconfigured")
    level, name, text = node.told("parsec", seen)
    assert (level, name) == (2, "bearing_node: run.failed")
    assert text.startswith(f"configure failed: {scene}: 1 error") and "operating.radial_load" in text and "800 N" in text
    scene.write_text(good)
    node.run()
    node.client.drive_until(lambda: node.client.values().get("state") == "active", "the fault is over", node.process)


def test_a_recording_that_cannot_be_made_refuses_the_activation_and_names_the_file(managed, tmp_path):
    (tmp_path / "a_file").write_text("")
    node = managed(f"record:={tmp_path / 'a_file' / 'run.mcap'}")
    assert node.change("configure") == (True, "inactive")
    node.told("ready to be activated")
    assert node.change("activate") == (False, "inactive")
    level, _, text = node.told("a_file")
    assert level == 2 and text.startswith("activate failed")
    assert node.change("cleanup") == (True, "unconfigured")


def test_a_transition_that_fails_again_is_told_at_the_next_review_though_no_regular_report_is_due(tmp_path, monkeypatch):
    (tmp_path / "a_file").write_text("")
    monkeypatch.setattr(interface, "time", SimpleNamespace(monotonic_ns=lambda: 1, time_ns=time.time_ns))  # steady time stands still
    rclpy.init(args=["--ros-args", "-p", "autostart:=false", "-p", f"record:={tmp_path / 'a_file' / 'run.mcap'}"], domain_id=fresh_domain())
    node = BearingNode(Future())
    reports = []
    monkeypatch.setattr(node, "publish_diagnostics", lambda now_ns, condition, *names: reports.append(condition.events[0].text))
    try:
        assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
        end = time.monotonic() + 200.0
        while not node.bearings[0].is_warm:
            assert time.monotonic() < end, "the model warms up"
            time.sleep(0.05)
        node._review()
        assert reports[-1] == "inactive: ready to be activated"
        for _ in range(3):
            assert node.trigger_activate() == TransitionCallbackReturn.FAILURE
            reports.clear()
            node._review()
            assert len(reports) == 1 and reports[0].startswith("activate failed") and "a_file" in reports[0]
            node._review()
            assert len(reports) == 1, "told once, until the next regular report"
    finally:
        node.close()
        node.destroy_node()
        rclpy.shutdown()


@pytest.mark.long
def test_forty_reconfigures_in_mid_run_leak_no_thread_no_file_no_memory_and_every_recording_is_complete(managed, tmp_path):
    node = managed(f"record:={tmp_path / 'run.mcap'}")
    client, process = node.client, node.process

    def reconfigure():
        for label in ("configure", "activate"):
            done = client.call(ChangeState, "change_state", ChangeState.Request(transition=Transition(label=label)), process).success
            assert done, f"{label}: {client.statuses()[-3:]}\n{process.text[-2000:]}"
        seen = len(client.received["bearing_joints"])
        client.drive_until(lambda: len(client.received["bearing_joints"]) > seen, "the model runs", process)
        for label in ("deactivate", "cleanup"):
            assert client.call(ChangeState, "change_state", ChangeState.Request(transition=Transition(label=label)), process).success

    for _ in range(10):
        reconfigure()
    before = _belongings(process)
    for _ in range(30):
        reconfigure()
    after = _belongings(process)
    assert after["threads"] <= before["threads"] and after["files"] <= before["files"] + 2, (before, after)
    assert after["memory"] - before["memory"] < 7e6, (before, after)
    assert "Traceback" not in process.text
    recordings = sorted(tmp_path.glob("run*"))
    assert len(recordings) == 40 and all(path.suffix == ".mcap" for path in recordings), "none is unfinished"
    assert Recording(recordings[0]).samples > 0


def _belongings(process):
    """Return what the node's process has: threads, open files, resident memory [bytes]."""
    (child,) = open(f"/proc/{process.process.pid}/task/{process.process.pid}/children").read().split()
    pages = int(open(f"/proc/{child}/statm").read().split()[1])
    counts = {"threads": len(os.listdir(f"/proc/{child}/task")), "files": len(os.listdir(f"/proc/{child}/fd"))}
    return counts | {"memory": pages * os.sysconf("SC_PAGE_SIZE")}
