# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the programs open to the network: nothing beyond the loopback interface, unless the user has chosen so; and the policy of SROS 2."""

import os
import re
import socket
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from open_sockets import node_and_player_running, when_open  # noqa: E402
from rclpy.impl.implementation_singleton import rclpy_implementation  # noqa: E402
from rclpy.utilities import get_rmw_implementation_identifier  # noqa: E402
from sockets import open_sockets  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.model.sample import RING_TEMPERATURES  # noqa: E402
from bearing_sim.ros import network, process  # noqa: E402
from bearing_sim.ros.network import FOLDER, LOOPBACK_PROFILE, close_other_interfaces, loopback_variables  # noqa: E402
from bearing_sim.ros.policy import policy  # noqa: E402
from bearing_sim.view.viewer import free_port  # noqa: E402

pytestmark = pytest.mark.timeout(180)
HOW_TO = Path(__file__).resolve().parent.parent / "doc" / "how-to"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILES = dict.fromkeys(("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"), str(LOOPBACK_PROFILE))
NAMESPACE = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
# What policy.xsd of the package sros2 (ROS 2 Jazzy) allows: of each element its attributes, those that it must have, and its children.
SCHEMA = {
    "policy": ({"version"}, {"version"}, {"enclaves"}),
    "enclaves": (set(), set(), {"enclave"}),
    "enclave": ({"path"}, {"path"}, {"profiles"}),
    "profiles": ({"type"}, set(), {"profile", "metadata"}),
    "profile": ({"ns", "node"}, {"ns", "node"}, {"topics", "services", "actions"}),
    "topics": ({"publish", "subscribe"}, set(), {"topic"}),
    "services": ({"reply", "request"}, set(), {"service"}),
    "topic": (set(), set(), set()),
    "service": (set(), set(), set()),
}


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """Yield a node with a view and a recording, a player that feeds it, and a client without any profile that hears the node."""
    with node_and_player_running(tmp_path_factory.mktemp("network")) as programs:
        yield programs


@pytest.mark.long
@pytest.mark.skipif("fastrtps" not in get_rmw_implementation_identifier(), reason="the profile is one of Fast DDS")
def test_the_sockets_of_node_view_and_player_are_on_the_loopback_interface_and_programs_without_the_profile_hear_the_node(running):
    node, player, client = running
    for program in (node, player):
        found = open_sockets(program.process.pid)
        assert any(each.kind == "udp" for each in found), "the sockets of the middleware are found"
        assert [each for each in found if not each.is_on_loopback] == []
    assert sum(each.kind == "tcp" for each in open_sockets(node.process.pid)) == 2, "the view has a port for viewers and one for browsers"
    assert client.received["bearing_joints"]


RINGS = {f"/{name}" for name in RING_TEMPERATURES}
OF_OTHER_SETTINGS = {
    "bearing_node": {
        "/clock",
        "/tf_static",
        *RINGS,
        *(f"/{topic.name}" for topic in topics.OUTPUTS.values() if topic.of_tilting_levels or topic.of_heat),
        *(f"/{name}" for name in (*topics.ESTIMATED, topics.VIBRATION.name)),
    },
    "bearing_player": {"/clock", "/diagnostics", "/oil_temperature", *(f"/{name}" for name in topics.MEASURED_CHANNELS), *RINGS},
}


def known(ask, name):
    """Return the names of what a node in the root namespace has, by a method of another node; none before it is discovered."""
    try:
        return {each for each, _ in ask(name, "/")}
    except rclpy_implementation.NodeNameNonExistentError:
        return set()


def test_the_policy_allows_what_node_and_player_do_and_no_more(running):
    node, _, client = running
    graph = client.node
    for profile in ElementTree.fromstring(policy()).iter("profile"):
        name = profile.get("node")
        for rule, ask in (
            ("publish", graph.get_publisher_names_and_types_by_node),
            ("subscribe", graph.get_subscriber_names_and_types_by_node),
            ("reply", graph.get_service_names_and_types_by_node),
        ):
            allowed = names_in(profile, rule)
            needed = allowed - OF_OTHER_SETTINGS[name] - {f"/{name}/get_type_description"}  # which not every ROS 2 has
            client.spin_until(lambda: needed <= known(ask, name), f"{name} does to {rule} all that it is allowed", node)  # noqa: B023
            assert known(ask, name) <= allowed, f"{name} would be denied to {rule}"


def names_in(profile, rule):
    """Return the full names that a profile allows for a rule; for namespaces and nodes as sros2 expands them."""
    namespace = profile.get("ns").rstrip("/")
    found = set()
    for listed in profile:
        if listed.get(rule) == "ALLOW":
            for entry in listed:
                text = re.sub("^~", f"{namespace}/{profile.get('node')}", entry.text)
                found.add(text if text.startswith("/") else f"{namespace}/{text}")
    return found


@pytest.mark.parametrize("text", [policy(), policy("/plant", "mill", ["front", "rear"], 2)], ids=["one bearing", "two bearings"])
def test_the_policy_has_the_elements_and_attributes_of_its_published_schema(text):
    root = ElementTree.fromstring(text)
    assert root.tag == "policy" and root.get("version") == "0.2.0"
    for element in root.iter():
        attributes, required, children = SCHEMA[element.tag]
        assert required <= set(element.attrib) <= attributes, element.tag
        assert {child.tag for child in element} <= children and bool(children) == bool(len(element)), element.tag
        assert (element.text or "").strip() if not children else not (element.text or "").strip()
        for rule in attributes & {"publish", "subscribe", "reply", "request"} & set(element.attrib):
            assert element.get(rule) in ("ALLOW", "DENY")


def test_the_policy_of_several_bearings_has_their_names_and_their_processes():
    (node, player) = ElementTree.fromstring(policy("/plant", "mill", ["front", "rear"], 2)).iter("profile")
    assert {"/plant/front/cage_slip", "/plant/rear/cage_slip", "/plant/_mill_2/transition_event"} <= names_in(node, "publish")
    assert {"/plant/mill/front/reset", "/plant/mill/change_state", "/plant/_mill_1/get_type_description"} <= names_in(node, "reply")
    assert "/plant/mill/reset" not in names_in(node, "reply")
    assert {"/plant/front/shaft_speed", "/plant/rear/shaft_speed"} <= names_in(player, "publish") & names_in(node, "subscribe")


def test_the_policy_that_is_installed_is_that_of_one_bearing():
    assert (FOLDER / "policy.xml").read_text() == policy(), "python -m bearing_sim.ros.policy > bearing_sim/ros/dds/policy.xml"


def allowed_interfaces(name):
    """Return the interfaces that a profile of Fast DDS allows, and what its only participant, the default one, uses."""
    profiles = ElementTree.parse(FOLDER / name).getroot().find(f"{NAMESPACE}profiles")
    (transport,), (participant,) = (profiles.findall(f".//{NAMESPACE}{tag}") for tag in ("transport_descriptor", "participant"))
    used = [each.text for each in participant.iter(f"{NAMESPACE}transport_id")]
    assert participant.get("is_default_profile") == "true" and used == [transport.find(f"{NAMESPACE}transport_id").text]
    assert participant.find(f".//{NAMESPACE}useBuiltinTransports").text == "false"
    return [each.get("name") for each in transport.iter(f"{NAMESPACE}interface")]


def test_the_profiles_open_the_loopback_interface_and_the_one_that_the_user_names():
    assert allowed_interfaces("fastdds_loopback.xml") == ["127.0.0.1"]
    assert allowed_interfaces("fastdds_network.xml") == ["127.0.0.1", "192.0.2.1"], "an address that no machine has, until the user edits it"


@pytest.mark.parametrize("environment", [{RANGE: "LOCALHOST"}, {"ROS_LOCALHOST_ONLY": "1"}, {RANGE: "LOCALHOST", **PROFILES}], ids=str)
def test_discovery_on_this_machine_gets_the_profile(environment, tmp_path):
    assert loopback_variables(environment, tmp_path) == PROFILES


def test_without_a_choice_topics_stay_on_this_machine(tmp_path):
    assert loopback_variables({"ROS_DOMAIN_ID": "3", RANGE: ""}, tmp_path) == {RANGE: "LOCALHOST", **PROFILES}


@pytest.mark.parametrize(
    "environment",
    [
        {RANGE: "SUBNET"},
        {RANGE: "SYSTEM_DEFAULT"},
        {RANGE: "OFF"},
        {"ROS_LOCALHOST_ONLY": "0"},
        {RANGE: "LOCALHOST", "ROS_STATIC_PEERS": "192.0.2.7"},
        {"ROS_DISCOVERY_SERVER": "192.0.2.7:11811"},
        {RANGE: "LOCALHOST", "FASTRTPS_DEFAULT_PROFILES_FILE": "/etc/plant.xml"},
        {RANGE: "LOCALHOST", "FASTDDS_DEFAULT_PROFILES_FILE": "/etc/plant.xml"},
    ],
    ids=str,
)
def test_a_user_who_has_chosen_the_network_is_left_alone(environment, tmp_path):
    assert loopback_variables(environment, tmp_path) == {}


@pytest.mark.parametrize("name", ["DEFAULT_FASTRTPS_PROFILES.xml", "DEFAULT_FASTDDS_PROFILES.xml"])
def test_a_profile_in_the_working_directory_is_left_alone(name, tmp_path):
    (tmp_path / name).write_text("<dds/>")
    assert loopback_variables({RANGE: "LOCALHOST"}, tmp_path) == {}


class Listener:
    """A node of which only the log matters; keeps its warnings."""

    def __init__(self):
        self.warnings = []

    def get_logger(self):
        return self

    def warning(self, text):
        self.warnings.append(text)


@pytest.fixture
def sockets_of_a_middleware(monkeypatch):
    """Yield two sockets, that of a receiver and that of a sender on all interfaces, and what takes the place of all sockets of this process."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind(("", 0))
        sender.settimeout(10.0)
        monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(LOOPBACK_PROFILE))
        monkeypatch.setattr(network, "get_rmw_implementation_identifier", lambda: "rmw_fastrtps_cpp")
        monkeypatch.setattr(os, "listdir", lambda _: [str(receiver.fileno()), str(sender.fileno())])
        yield receiver, sender


def test_a_socket_for_sending_moves_to_the_loopback_interface_and_still_sends(sockets_of_a_middleware):
    receiver, sender = sockets_of_a_middleware
    receiver.bind(("127.0.0.1", 0))
    receiver.settimeout(10.0)
    node = Listener()
    close_other_interfaces(node)
    assert sender.getsockname()[0] == "127.0.0.1" and node.warnings == []
    sender.sendto(b"found", receiver.getsockname())
    assert receiver.recvfrom(16) == (b"found", sender.getsockname())


def test_sockets_that_may_receive_stay_as_they_are_and_are_reported_where_the_profile_has_no_effect(sockets_of_a_middleware):
    receiver, sender = sockets_of_a_middleware
    receiver.bind(("", 0))
    before, node = receiver.getsockname(), Listener()
    close_other_interfaces(node)
    assert (receiver.getsockname(), sender.getsockname()[0]) == (before, "0.0.0.0")
    (warning,) = node.warnings
    assert f"0.0.0.0:{before[1]}" in warning and "has no effect" in warning


def test_a_middleware_that_cannot_start_is_one_message(capfd, monkeypatch):
    monkeypatch.setattr(process, "use_loopback", str)  # which would set variables of this process

    def make_node(ended):
        raise rclpy_implementation.RCLError("error creating node: This Fast DDS version doesn't have\nthe security libraries")

    assert process.run_node("bearing_node", make_node, []) == 2
    printed = capfd.readouterr().err
    assert printed == "bearing_node: cannot start ROS: error creating node: This Fast DDS version doesn't have the security libraries\n"


@pytest.mark.long
def test_the_dask_scheduler_of_the_how_to_listens_on_the_loopback_interface(tmp_path):
    pytest.importorskip("distributed", reason="pip install 'bearing_sim[dask]'")
    (words,) = re.findall(r"^dask scheduler (.*)$", (HOW_TO / "replay_a_fleet.md").read_text(), re.MULTILINE)
    words = [word.replace(":8787", ":0") for word in words.split()]
    with open(tmp_path / "log", "w+") as log:
        command = [sys.executable, "-m", "dask", "scheduler", *words, "--port", str(free_port())]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=log, stderr=subprocess.STDOUT)
        try:
            found = when_open(process, lambda found: len(found) > 1, (tmp_path / "log").read_text)
        finally:
            process.terminate()
            process.wait(60)
    assert [each for each in found if not each.is_on_loopback] == []
