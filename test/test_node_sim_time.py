# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node under sim time, as a process of its own that a player plays a log to over DDS: the same as an offline replay of the log."""

import signal
import time

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402
from sim_time_bench import RATE, SCENE, course, write  # noqa: E402
from std_srvs.srv import SetBool  # noqa: E402

from bearing_sim.inputs.log import read_input_log  # noqa: E402
from bearing_sim.inputs.profile import judge  # noqa: E402
from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.recording.writer import McapSink  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.runtime.replay import replay  # noqa: E402
from bearing_sim.runtime.sim_time import CAUGHT_UP  # noqa: E402
from bearing_sim.simulation import Inputs  # noqa: E402

pytestmark = pytest.mark.timeout(240)
SECOND = 1_000_000_000
SECONDS = 1.2


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """A log, and the recording of its offline replay."""
    folder = tmp_path_factory.mktemp("log")
    path = write(folder / "log.mcap", course(SECONDS, cage=True))
    judged = judge(read_input_log(path), SCENE.accepted_inputs, Inputs(0.0, 0.0, 0.0, SCENE.lubricant.temperature))
    with McapSink(folder / "offline.mcap", SCENE, judged.start_ns) as recording:
        replay(SCENE, judged, recording, rate=RATE)
    return path, folder / "offline.mcap"


@pytest.fixture
def bench(tmp_path):
    """Return a node under sim time, a client of it, and a function that starts players; all are gone at the end."""
    domain, started = fresh_domain(), []
    client = Client(domain)

    def node(*parameters):
        words = [word for parameter in parameters for word in ("-p", parameter)]
        rates = ("-p", f"sample_rate:={RATE}", "-p", f"publish_rate:={RATE}")
        started.append(NodeProcess(tmp_path, domain, "--ros-args", "-p", "use_sim_time:=true", *rates, *words))
        return started[-1]

    def player(*arguments):
        started.append(NodeProcess(tmp_path, domain, *map(str, arguments), module="bearing_sim.ros.player"))
        return started[-1]

    yield node, client, player
    client.close()
    for process in started:
        process.end(signal.SIGKILL)


def played(client, node, process):
    """Let a player come to its end."""
    client.spin_until(lambda: process.process.poll() is not None, "the log is played and used", node, 60.0)
    assert process.process.returncode == 0, process.text
    assert "no follower of /clock reported" not in process.text


def messages(path):
    """Return of each topic but the diagnostics the log times and bytes of its messages."""
    found = {}
    with AnyReader([path]) as reader:
        for connection, log_time, data in reader.messages():
            found.setdefault(connection.topic, []).append((log_time, bytes(data)))
    found.pop("/diagnostics")
    return found


def joints(path):
    """Return positions and velocities of shaft, cage and ideal cage by stamp."""
    with AnyReader([path]) as reader:
        chosen = [connection for connection in reader.connections if connection.topic == "/bearing_joints"]
        return dict(_numbers(reader.deserialize(data, connection.msgtype)) for connection, _, data in reader.messages(chosen))


def _numbers(message):
    stamp = message.header.stamp
    return stamp.sec * SECOND + (stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nsec), [*message.position, *message.velocity]


def assert_published_as_offline(received, expected):
    """Assert that what came over DDS has the values of the offline replay at its stamps."""
    assert len(received) > 0.8 * len(expected), "nearly all come, even to a busy client"
    for joint_state in received:
        stamp, numbers = _numbers(joint_state)
        np.testing.assert_allclose(numbers, expected[stamp], rtol=1e-9, atol=1e-9)


def events(client, code):
    """Return (level, text) of every status of a code."""
    return {(level, text) for level, name, text in client.statuses() if name.endswith(f": {code}")}


@pytest.mark.long
def test_a_log_played_at_any_rate_with_a_pause_and_again_is_what_its_replay_is(bench, log, tmp_path):
    """First at rate 0.25 with a pause, then, after the clock's jump back, at rate 10: topics to 1e-9, recordings to the byte."""
    start, client, player = bench
    path, offline = log
    node = start(f"record:={tmp_path / 'run.mcap'}")
    client.spin_until(lambda: events(client, "clock.absent"), "the node says that there is no clock", node, 100.0)
    expected, joints_of = joints(offline), client.received["bearing_joints"]

    # Five seconds long, so that the request for a pause comes in time on a busy machine too.
    slow = player(path, "--clock", 10, "--rate", 0.25, "--wait-until-used", 60)
    client.spin_until(lambda: len(joints_of) > 20, "the first outputs come", node, 60.0)
    _pause(client, slow, True)
    client.spin_until(lambda: events(client, "clock.stands_still"), "the pause is told", node)
    told = len(client.received["diagnostics"]) + 1
    client.spin_until(
        lambda: len(client.received["diagnostics"]) > told and client.values()[CAUGHT_UP] == "True", "the node has caught up", node, 60.0
    )
    client.spin(0.5)  # what is on its way
    held = len(joints_of)
    client.spin(0.5)
    assert len(joints_of) == held < len(expected) and slow.process.poll() is None and not events(client, "input.stale")
    _pause(client, slow, False)
    played(client, node, slow)
    assert_published_as_offline(joints_of, expected)
    joints_of.clear()

    played(client, node, player(path, "--clock", 37, "--rate", 10, "--wait-until-used", 60))
    ((level, told),) = events(client, "clock.jumped_back")
    assert level == 1 and "start again there" in told
    assert_published_as_offline(joints_of, expected)
    assert client.values()["late inputs"] == "0" and client.values()["messages refused"] == "0"
    assert node.end(signal.SIGTERM) == 0, node.text
    whole = messages(offline)
    assert set(whole) >= {f"/{name}" for name in (*topics.outputs(SCENE), *topics.inputs(SCENE), topics.MEASURED, topics.RESIDUAL)}
    for name in ("run.mcap", "run_2.mcap"):
        assert messages(tmp_path / name) == whole, name


def _pause(client, process, paused):
    service = client.node.create_client(SetBool, "bearing_player/pause")
    client.spin_until(service.service_is_ready, "the player's service is there", process)
    future = service.call_async(SetBool.Request(data=paused))
    client.spin_until(future.done, "the player answers", process)
    assert future.result().success


@pytest.mark.long
def test_clock_that_jumps_back_is_an_error_where_that_is_asked_for(bench, log, tmp_path):
    start, client, player = bench
    path, offline = log
    node = start(f"record:={tmp_path / 'run.mcap'}", "clock_jump_back:=error")
    client.spin_until(lambda: events(client, "clock.absent"), "the node says that there is no clock", node, 100.0)
    played(client, node, player(path, "--clock", 20, "--rate", 10, "--wait-until-used", 60))
    client.spin(1.0)  # what is on its way
    count = len(client.received["bearing_joints"])
    again = player(path, "--clock", 20, "--rate", 1)
    client.spin_until(lambda: events(client, "clock.jumped_back"), "the jump is told", node)
    client.spin_until(lambda: events(client, "input.time_backwards"), "messages from before are refused", node)
    ((level, told),) = {(level, text.partition(" and ")[0]) for level, text in events(client, "clock.jumped_back")}
    assert level == 2 and told == "the clock jumped back"
    assert len(client.received["bearing_joints"]) == count, "the last good state is held"
    client.spin_until(lambda: again.process.poll() is not None, "the second play ends", node)
    assert node.end(signal.SIGINT) == 0, node.text
    assert messages(tmp_path / "run.mcap") == messages(offline) and not (tmp_path / "run_2.mcap").exists()


def test_node_without_a_clock_waits_says_so_and_ends_in_order(bench):
    start, client, _ = bench
    node = start()
    client.wait_until_matched(node)
    client.drive(1.5)
    (told,) = events(client, "clock.absent")
    assert told[0] == 1 and told[1].startswith("no /clock: use_sim_time is set")
    assert not client.received["bearing_joints"] and client.values()["phase"] == "waiting for the first input"
    assert node.end(signal.SIGINT) == 0 and "Traceback" not in node.text, node.text


def test_a_run_waits_for_a_first_oil_temperature_whose_publisher_appears_with_the_clock(bench):
    start, client, _ = bench
    node = start()
    client.wait_until_matched(node)
    # The client's inputs are best effort, which is a warning of its own, so that the clock's arrival changes no level and causes no report.
    client.spin_until(lambda: events(client, "input.lost"), "the best-effort publishers are noticed", node)
    reports = len(client.received["diagnostics"])
    client.spin_until(lambda: len(client.received["diagnostics"]) > reports, "a report comes, the next in a second", node)
    oil = client.node.create_publisher(message_class(topics.INPUTS["oil_temperature"].ros_type), "oil_temperature", 10)
    clock = client.node.create_publisher(message_class("rosgraph_msgs/msg/Clock"), "/clock", 10)
    first, begun, joints_of = 1_700_000_000 * SECOND, time.monotonic(), client.received["bearing_joints"]
    sent = False
    while not joints_of:
        passed = time.monotonic() - begun
        assert passed < 60.0, node.text
        stamp = first + round(passed * 1e9)
        clock.publish(message("rosgraph_msgs/msg/Clock", {"clock": topics.stamp(stamp)}))
        client.send("shaft_speed", stamp)
        client.send("radial_load", stamp)
        if passed > 0.8 and not sent:
            fields = topics.INPUTS["oil_temperature"].message(stamp, GOOD._replace(oil_temperature=350.0))
            oil.publish(message(topics.INPUTS["oil_temperature"].ros_type, fields))
            sent = True
        client.spin(0.05)
    assert sent, "nothing was computed before"
