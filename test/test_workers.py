# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Worker processes of a node: how bearings are shared out, and that the node stays one node whatever happens to them."""

import os
import re
import signal
import time

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState  # noqa: E402
from rcl_interfaces.srv import GetParameters, SetParameters  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from ros_bench import PATIENCE, Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros.workers import passed_arguments, process_count, shares  # noqa: E402

pytestmark = pytest.mark.long

NAMES = ("front", "middle", "rear")


@pytest.mark.parametrize(
    ("wanted", "bearings", "cores", "expected"),
    [(0, 1, 8, 1), (0, 10, 8, 1), (0, 11, 8, 2), (0, 40, 2, 2), (0, 40, 8, 4), (0, 100, 8, 8), (3, 40, 2, 3), (8, 3, 2, 3), (1, 100, 8, 1)],
)
def test_there_is_a_process_for_ten_bearings_but_no_more_than_cores_unless_a_number_is_given(wanted, bearings, cores, expected):
    assert process_count(wanted, bearings, cores) == expected


def test_bearings_are_shared_out_evenly_and_each_goes_to_one_process():
    names = [f"b{k}" for k in range(23)]
    found = shares(names, 4)
    assert sorted(name for share in found for name in share) == sorted(names)
    assert {len(share) for share in found} == {5, 6}


def test_workers_get_remappings_log_settings_and_the_enclave_but_no_parameters_and_no_names():
    given = (
        "node --ros-args -r __node:=a -r __ns:=/b -p x:=1 --params-file f.yaml -r front/cage_slip:=slip --log-level debug "
        "--enclave /e -r a:y:=z -- --own"
    ).split()
    assert passed_arguments(given, "a") == "-r front/cage_slip:=slip --log-level debug --enclave /e -r y:=z".split()


class Fleet:
    """A managed node with three bearings in two processes, and a client."""

    def __init__(self, folder):
        domain = fresh_domain()
        parameters = ("bearings:=[front,middle,rear]", "processes:=2", "autostart:=false", "governor:=false", "overrides:=[level=slip]")
        pairs = [word for parameter in parameters for word in ("-p", parameter)]
        self.process = NodeProcess(folder, domain, "--ros-args", *pairs, "-r", "rear/cage_slip:=hind_slip", limit=280)
        self.clients = {name: Client(domain, namespace=name) for name in NAMES}
        self.client = Client(domain)
        self.hind = []
        self.client.listen("std_msgs/msg/Float64", "hind_slip", self.hind.append)

    def change(self, label):
        request = ChangeState.Request(transition=Transition(label=label))
        return self.client.call(ChangeState, "change_state", request, self.process).success

    def drive_until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"waited in vain: {what}\n{self.process.text}"
            for one in self.clients.values():
                one.send("shaft_speed")
                one.send("radial_load")
                one.hear()
            self.client.spin(0.02)

    def slips(self, name):
        return self.hind if name == "rear" else self.clients[name].received["cage_slip"]

    def all_come(self):
        counts = {name: len(self.slips(name)) for name in NAMES}
        self.drive_until(lambda: all(len(self.slips(name)) > counts[name] + 3 for name in NAMES), "slip of every bearing")

    def workers(self):
        """Return the newest process of each worker, by the names of its bearings."""
        return {names: int(pid) for pid, names in re.findall(r"process (\d+) for (.+)", self.process.text)}

    def whole(self, name):
        """Return the newest status of a bearing as a whole; None before the first."""
        wholes = [report.status[0] for report in self.client.received["diagnostics"]]
        return next((status for status in reversed(wholes) if status.name == f"bearing_node/{name}: condition"), None)

    def told(self, name):
        """Return what the newest diagnostics say of a bearing as a whole."""
        status = self.whole(name)
        return status.message if status is not None else ""

    def close(self):
        for one in (self.client, *self.clients.values()):
            one.close()
        self.process.end(signal.SIGKILL)


def is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    one = Fleet(tmp_path_factory.mktemp("fleet"))
    yield one
    one.close()


@pytest.mark.timeout(280)
def test_a_node_with_workers_is_one_node_with_the_topics_services_and_statuses_that_it_has_without(fleet):
    assert fleet.change("configure") and fleet.change("activate")
    fleet.all_come()
    assert [name for name in fleet.client.node.get_node_names() if "bearing_node" in name and not name.startswith("_")] == ["bearing_node"]
    fleet.drive_until(lambda: all(fleet.told(name) for name in NAMES), "diagnostics of every bearing")
    statuses = {status.name for report in fleet.client.received["diagnostics"] for status in report.status}
    assert {name.partition(":")[0] for name in statuses} == {f"bearing_node/{name}" for name in NAMES}
    answer = fleet.clients["rear"].call(Trigger, "/bearing_node/rear/reset", Trigger.Request(), fleet.process)
    assert answer.success and answer.message == "state and damage are reset"


@pytest.mark.timeout(280)
def test_parameters_of_the_node_reach_the_worker_of_their_bearing_and_are_refused_by_its_checks(fleet):
    def put(name, value):
        request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        return fleet.client.call(SetParameters, "set_parameters", request, fleet.process).results[0]

    assert put("rear.lubricant.temperature", 350.0).successful
    shown = fleet.client.call(GetParameters, "get_parameters", GetParameters.Request(names=["rear.lubricant.temperature"]), fleet.process)
    assert shown.values[0].double_value == 350.0
    refused = put("rear.thresholds.slip_warning", 0.9)
    assert not refused.successful and "slip_error" in refused.reason

    def told():
        return {pair.key: pair.value for pair in fleet.whole("rear").values}.get("oil temperature [degC]")

    fleet.drive_until(lambda: told() == "76.85", "the model of the worker has the temperature")


@pytest.mark.timeout(280)
def test_a_worker_that_is_killed_is_told_and_started_again_and_the_others_go_on(fleet):
    before = fleet.workers()
    os.kill(before["front, rear"], signal.SIGKILL)
    fleet.drive_until(lambda: "SIGKILL" in fleet.told("front") and "SIGKILL" in fleet.told("rear"), "the loss is told for its bearings")
    count = len(fleet.slips("middle"))
    fleet.all_come()
    assert len(fleet.slips("middle")) > count and is_alive(before["middle"])
    fleet.drive_until(lambda: "SIGKILL" not in fleet.told("front"), "it is told no longer")


@pytest.mark.timeout(280)
def test_cleaning_up_ends_the_workers_and_configuring_again_starts_others_which_end_with_the_node_and_complete_recordings(fleet):
    before = fleet.workers()
    assert fleet.change("deactivate") and fleet.change("cleanup")
    assert not is_alive(before["middle"])
    assert fleet.change("configure") and fleet.change("activate")
    fleet.all_come()
    answer = fleet.clients["middle"].call(Trigger, "/bearing_node/middle/start_recording", Trigger.Request(), fleet.process)
    assert answer.success
    fleet.all_come()
    assert fleet.process.end() == 0
    assert not any(is_alive(pid) for pid in fleet.workers().values())
    assert Recording(answer.message).samples > 0
