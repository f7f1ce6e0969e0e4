# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A node with a serial number remembers its bearing: over kills, for another bearing, and against a second node."""

import json

import pytest

pytest.importorskip("rclpy")

from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from state_kills import kill_nodes  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from bearing_sim.watchers.stored_state.state_file import read_state  # noqa: E402

SCENE = ("-p", "scene:=deng2017_table1", "-p", "overrides:=['level=steady']", "-p", "governor:=false")


def test_killed_nodes_continue_from_what_they_had_published_ten_seconds_before_or_later(tmp_path):
    kills = kill_nodes(tmp_path, kills=4, at_once=2, seed=3, longest=1.5)
    assert all(kill.is_good and kill.is_said for kill in kills), kills
    restored = sum(read_state(path)[0].totals.damage for path in tmp_path.glob("bearing_*.json"))
    assert 0.0 < restored <= sum(kill.last - kill.begun_with for kill in kills)


@pytest.mark.long
def test_a_node_keeps_one_state_for_each_bearing_and_no_second_node_may_use_it(tmp_path):
    state, domain = tmp_path / "a.json", fresh_domain()
    arguments = ("--ros-args", *SCENE, "-p", f"state_file:={state}")
    node, client = NodeProcess(tmp_path, domain, *arguments, "-p", "serial:=A1"), Client(domain)
    try:
        client.wait_until_matched(node)
        client.drive_until(lambda: client.received["damage"], "damage is published", node)
        second = NodeProcess(tmp_path, domain, *arguments, "-p", "serial:=A1", "-r", "__node:=second")
        assert second.wait() == 2 and "in use by process" in second.text

        def call(service):
            answer = client.call(Trigger, service, Trigger.Request(), node)
            return answer.success, answer.message

        done, message = call("get_stored_state")
        assert done and json.loads(message)["serial"] == "A1" and json.loads(message)["totals"]["damage"] > 0.0
        done, message = call("replace_bearing")
        assert not done and "set serial to the number of the new bearing first" in message
        changed = SetParameters.Request(parameters=[Parameter("serial", value="B2").to_parameter_msg()])
        assert client.call(SetParameters, "set_parameters", changed, node).results[0].successful
        before = client.received["damage"][-1].data
        done, message = call("replace_bearing")
        assert done and message.startswith("serial number B2: 0 % of life used")
        client.received["damage"].clear()
        client.drive_until(lambda: client.received["damage"], "damage is published again", node)
        assert client.received["damage"][0].data < before
        assert node.end() == 0
    finally:
        node.end(9)
        client.close()
    (archived,) = tmp_path.glob("a.A1.*.json")
    assert read_state(archived)[0].serial == "A1" and read_state(archived)[0].totals.damage >= before
    assert read_state(state)[0].serial == "B2"
    other = NodeProcess(tmp_path, domain, *arguments, "-p", "serial:=A1")
    assert other.wait() == 2 and "serial number 'A1' instead of 'B2'" in other.text
