# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's /diagnostics by the rules of diagnostic_aggregator: a healthy start, faults, cures, pause, and the end."""

import itertools
import math
import signal
import time
from pathlib import Path

import pytest
import yaml

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from aggregator import ERROR, OK, STALE, WARN, Aggregator, statuses_of  # noqa: E402
from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState  # noqa: E402
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue  # noqa: E402
from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import GOOD, PATIENCE, Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.ros.parameters import OIL_TEMPERATURE, SCENE_DECLARATIONS  # noqa: E402

pytestmark = [pytest.mark.long, pytest.mark.timeout(300)]
ANALYZERS = Path(__file__).resolve().parents[1] / "launch_scripts" / "diagnostic_analyzers.yaml"
SECOND, OIL_KEY = 1_000_000_000, "oil temperature [degC]"
_STATUSES = 14  # of a bearing that does not run


class Watcher(Client):
    """A client whose aggregator judges what it hears, all the time: nothing may be stale as long as the node lives.

    Parameters
    ----------
    timeout : after which an item is stale [s]: by default longer than that of diagnostic_aggregator, because a busy machine may hold up the node
        and the client; ``python test/benchmarks/diagnostics_silence.py`` measures.
    """

    def __init__(self, domain, namespace="", timeout=PATIENCE):
        parameters = yaml.safe_load(ANALYZERS.read_text())["/**"]["ros__parameters"]
        patient = {name: {**value, "timeout": timeout} if isinstance(value, dict) else value for name, value in parameters.items()}
        self._aggregator = Aggregator(patient)
        super().__init__(domain, namespace)
        self.worst = OK

    def _hear_diagnostics(self, report):
        super()._hear_diagnostics(report)
        self._aggregator.receive(time.monotonic(), statuses_of(report))

    def hear(self):
        super().hear()
        levels = self.levels()
        if len(levels) > 5:  # something has been heard
            assert STALE not in levels.values(), levels
            self.worst = max(self.worst, levels["/Bearings"])

    def levels(self, later=0.0):
        """Return levels by path, now or some seconds later."""
        return {path: level for path, level in self._aggregator.report(time.monotonic() + later).items() if path != "/Bearings" or level < STALE}

    def items(self):
        return [path for path in self.levels() if ": " in path]

    def wrong(self):
        """Return the level of each subject that is not OK; limits of validity hold as long as the condition does, and the machine may be busy."""
        named = {path.rpartition("/")[2]: level for path, level in self.levels().items() if ": " in path and level}
        return {
            name.removeprefix("bearing_node "): level for name, level in named.items() if not name.endswith((": condition", ": validity", ": pace"))
        }


class Fleet:
    """A managed node of two bearings and a watcher, which is a client of the front one."""

    def __init__(self, folder):
        domain = fresh_domain()
        overrides = "overrides:=['input_limits.stale_after=1s', 'lubricant.temperature=100 degC']"
        state = (f"front.state_file:={folder / 'state.json'}", "front.serial:=A-17")
        parameters = ("autostart:=false", "governor:=false", "bearings:=[front, rear]", overrides, *state, "publish_rate:=10.0")
        self.process = NodeProcess(folder, domain, "--ros-args", *(word for pair in parameters for word in ("-p", pair)), limit=280)
        self.client = Watcher(domain, "front")
        types = {name: topics.INPUTS[name].ros_type for name in ("shaft_speed", "radial_load")}
        create = self.client.node.create_publisher
        self._rear = {name: create(message_class(kind), f"/rear/{name}", qos_profile_sensor_data) for name, kind in types.items()}
        self._rival = None

    def change(self, label):
        request = ChangeState.Request(transition=Transition(label=label))
        assert self.client.call(ChangeState, "/bearing_node/change_state", request, self.process).success, label

    def set(self, name, value):
        one = Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value))
        answer = self.client.call(SetParameters, "/bearing_node/set_parameters", SetParameters.Request(parameters=[one]), self.process)
        assert answer.results[0].successful, answer

    def drive_until(self, condition, what, front=("shaft_speed", "radial_load"), rival=None, **values):
        """Drive both bearings, of the front one with only some inputs, until a condition holds."""
        if rival is not None:
            self._rival = self._rival or self.client.node.create_publisher(
                message_class(topics.INPUTS["shaft_speed"].ros_type), "shaft_speed", qos_profile_sensor_data
            )
        elif self._rival is not None:
            self.client.node.destroy_publisher(self._rival)
            self._rival = None
        turns = itertools.count()

        def sent():
            now_ns = time.time_ns()
            for name, publisher in self._rear.items():
                made = topics.INPUTS[name].message(now_ns, GOOD)
                publisher.publish(message(topics.INPUTS[name].ros_type, made))
            if rival is not None and next(turns) % 2:
                made = topics.INPUTS["shaft_speed"].message(time.time_ns(), GOOD._replace(shaft_speed=rival))
                self._rival.publish(message(topics.INPUTS["shaft_speed"].ros_type, made))
            else:
                for name in front:
                    self.client.send(name, **values)
            self.client.spin(0.02)
            return condition()

        self.client.spin_until(sent, what, self.process)

    def drive_until_wrong(self, expected, what, **how):
        self.drive_until(lambda: self.client.wrong() == expected, f"{what}: {expected}", **how)


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    made = Fleet(tmp_path_factory.mktemp("fleet"))
    yield made
    made.client.close()
    made.process.end(signal.SIGKILL)


def test_a_healthy_start_is_never_stale_warns_while_the_models_are_not_there_and_waits_for_inputs_in_silence(fleet):
    client, process = fleet.client, fleet.process
    client.spin_until(lambda: len(client.items()) == 2 * _STATUSES, "both bearings report before they are configured", process, 100.0)
    assert {status.hardware_id for report in client.received["diagnostics"] for status in report.status} <= {"A-17", ""}
    assert client.worst == OK, "nobody has asked for anything yet"
    fleet.change("configure")
    fleet.change("activate")
    client.spin_until(lambda: process.text.count("ready: listening to") == 2, "both have warmed up", process, 100.0)
    assert client.worst == WARN, "a node that warms up does not monitor"
    client.spin_until(lambda: client.wrong() == {}, "both run", process)
    client.worst = OK
    client.spin(1.5)  # longer than the patience with an input that has begun
    assert client.worst == OK and "WARN" not in process.text and "ERROR" not in process.text
    assert "holding" not in str(client.received["diagnostics"])
    for words in ("/front/shaft_speed, /front/radial_load", "/rear/cage_slip", "lifecycle: configure: unconfigured -> inactive"):
        assert words in process.text
    newest = lambda name: [s.message for report in client.received["diagnostics"] for s in report.status if s.name.endswith(name)][-1]  # noqa: E731
    fleet.drive_until(lambda: client.received["cage_slip"] and "its messages are used" in newest("front: shaft_speed"), "the front runs")
    why = {
        pair.key: pair.value
        for report in client.received["diagnostics"]
        for s in report.status
        if s.name.endswith("rear: unused")
        for pair in s.values
    }
    assert why["oil_temperature"] == "no message so far, the scene's value is used, 100 degC"
    assert client.wrong() == {} and client.worst <= WARN
    assert len(client.items()) == 2 * _STATUSES + 3, "the clearance of both, and the state of the front are used from here on"
    last = {status.name: status for report in client.received["diagnostics"][-4:] for status in report.status}
    assert last["bearing_node/front: slip"].hardware_id == "A-17"


def test_each_fault_is_in_its_subject_of_its_bearing_alone_and_its_cure_is_seen(fleet):
    client = fleet.client
    client.worst = OK
    (shared,) = [row.default for row in SCENE_DECLARATIONS if row.name == OIL_TEMPERATURE]
    fleet.set(OIL_TEMPERATURE, shared)  # what it is, and not what the bearings' scenes have
    fleet.drive_until_wrong({"front: shaft_speed": WARN}, "a stale speed", front=("radial_load",))
    fleet.drive_until_wrong({}, "it comes again")
    fleet.drive_until_wrong({"front: shaft_speed": ERROR}, "a speed that is no number", shaft_speed=math.nan)
    fleet.drive_until_wrong({}, "it is one again")
    fleet.drive_until_wrong({"front: radial_load": ERROR, "front: inputs": WARN}, "an absurd load", load_y=1e12)
    fleet.drive_until_wrong({"front: inputs": WARN}, "what was refused counts nowhere")
    assert client.call(Trigger, "/bearing_node/front/reset", Trigger.Request(), fleet.process).success
    fleet.drive_until_wrong({}, "the run starts anew")
    fleet.drive_until_wrong({"front: shaft_speed": ERROR}, "two publishers disagree", rival=1500.0)
    fleet.drive_until_wrong({}, "one is left")
    for name, value in (("slip_warning", 1e-4), ("slip_error", 1e-3), ("slip_hold.clear_after", 0.1)):
        fleet.set(f"front.thresholds.{name}", value)
    fleet.drive_until_wrong({"front: slip": ERROR}, "a threshold of slip is passed")
    for name, value in (("slip_error", 1.0), ("slip_warning", 1.0)):
        fleet.set(f"front.thresholds.{name}", value)
    fleet.drive_until_wrong({}, "it is raised")
    assert client.worst == ERROR
    oil = {pair.value for report in client.received["diagnostics"] for status in report.status for pair in status.values if pair.key == OIL_KEY}
    assert shared == 393.15 and oil == {"100"}, "a parameter that is set to the value that it has changes nothing"


def test_a_pause_and_every_state_of_the_node_are_as_healthy_as_a_run_and_its_end_is_stale(fleet):
    client, process = fleet.client, fleet.process
    assert client.call(SetBool, "/bearing_node/front/pause", SetBool.Request(data=True), process).success
    fleet.drive_until(lambda: any("paused" in text for _, _, text in client.statuses(-2)), "the pause is told")
    client.worst = OK
    for _ in range(20):
        fleet.drive_until_wrong({}, "paused")
    for label in ("deactivate", "activate", "deactivate", "cleanup", "configure", "shutdown"):
        fleet.change(label)
        seen = len(client.received["diagnostics"])
        client.spin_until(lambda seen=seen: len(client.received["diagnostics"]) > seen + 3, "both report", process)
        assert client.wrong() == {} and len(client.items()) == 2 * _STATUSES + 3
    assert client.worst <= WARN, "limits of validity at most"
    assert process.end(signal.SIGINT) == 0
    levels = client.levels(later=PATIENCE + 0.1)
    assert {level for path, level in levels.items() if path != "/Bearings"} == {STALE}


def test_under_sim_time_a_clock_that_is_absent_stands_or_jumps_is_told_and_nothing_is_ever_stale(tmp_path):
    domain = fresh_domain()
    parameters = ("use_sim_time:=true", "clock_jump_back:=error", "publish_rate:=10.0")
    process = NodeProcess(tmp_path, domain, "--ros-args", *(word for pair in parameters for word in ("-p", pair)))
    client = Watcher(domain)
    try:
        client.spin_until(lambda: client.wrong() == {"bearing_node: clock": WARN}, "there is no clock", process, 100.0)
        kind = "rosgraph_msgs/msg/Clock"
        clock = client.node.create_publisher(message_class(kind), "/clock", 10)

        def play(condition, what, begin):
            steps = itertools.count()

            def stepped():
                now_ns = begin + next(steps) * SECOND // 25
                for name in ("shaft_speed", "radial_load"):
                    client.send(name, stamp_ns=now_ns)
                clock.publish(message(kind, {"clock": topics.stamp(now_ns)}))
                client.spin(0.02)
                return condition()

            client.spin_until(stepped, what, process)

        play(lambda: client.received["cage_slip"] and client.wrong() == {}, "it runs", 1000 * SECOND)
        client.spin_until(lambda: any("stands still" in text for _, _, text in client.statuses(-1)), "a clock that stands is told", process)
        assert client.wrong() == {}
        client.worst = OK
        play(lambda: client.wrong() == {"bearing_node: clock": ERROR}, "a jump back is an error here", 990 * SECOND)
        play(lambda: client.wrong() == {}, "the clock has passed its old reading", 1100 * SECOND)
    finally:
        client.close()
        process.end(signal.SIGKILL)
