# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's recording when something ends it: the node killed, the process that records killed, the disk full."""

import os
import shutil
import signal
import time
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.rosbag2 import Reader  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from waiting import wait_for  # noqa: E402

from bearing_sim.inputs.log import read_input_log  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.recording.recovery import RecordingError, contents, recover  # noqa: E402

pytestmark = pytest.mark.timeout(180)
SECOND = 1_000_000_000


@pytest.fixture
def launch(tmp_path):
    """Return a function that starts a node and a client of it; both are gone at the end."""
    started = []

    def start(*parameters):
        domain = fresh_domain()
        process = NodeProcess(tmp_path, domain, "--ros-args", *(word for parameter in parameters for word in ("-p", parameter)))
        started.append((process, Client(domain)))
        process_and_client = started[-1]
        process_and_client[1].wait_until_matched(process)
        process_and_client[1].drive_until(lambda: process_and_client[1].received["cage_slip"], "the node runs", process)
        return process_and_client

    yield start
    for process, client in started:
        client.close()
        process.end(signal.SIGKILL)


def recorders_of(process):
    """Return the numbers of the processes that record for a node."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            command = (place / "cmdline").read_bytes().split(b"\0")
            parent = Path(f"/proc/{(place / 'stat').read_text().rpartition(')')[2].split()[1]}")
            grandparent = int((parent / "stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, IndexError, ValueError):
            continue
        if b"bearing_sim.recording.recorder_server" in command and grandparent == process.process.pid:  # the node is the child of its watchdog
            found.append(int(place.name))
    return found


def slips_in(path):
    """Return how many messages of cage_slip a recording has so far; none where it is not there, or has no beginning yet."""
    try:
        return contents(path).messages["/cage_slip"]
    except (OSError, RecordingError):
        return 0


def given_up(client, since=0):
    return [text for level, name, text in client.statuses(since) if level == 2 and "sink.failed" in name and text.startswith("record: ")]


def restarts(client, since=0):
    return [text for level, name, text in client.statuses(since) if level == 1 and "recording.restarted" in name]


@pytest.mark.long
def test_a_recording_whose_process_is_killed_goes_on_in_another_file_but_not_for_ever_and_a_killed_node_leaves_a_complete_one(launch, tmp_path):
    process, client = launch(f"record:={tmp_path / 'run.mcap'}")
    client.drive(2.0)
    [pid] = recorders_of(process)
    client.hear()
    last_heard = client.received["bearing_joints"][-1].header.stamp.sec
    os.kill(pid, signal.SIGKILL)
    client.drive_until(lambda: restarts(client), "the lost recording is told as a WARN", process)
    assert "SIGKILL" in restarts(client)[-1] and "continues in" in restarts(client)[-1] and not given_up(client)
    heard = len(client.received["cage_slip"])
    client.drive_until(lambda: len(client.received["cage_slip"]) > heard + 20, "the node goes on", process)
    found = recover(tmp_path / "run.mcap.active", tmp_path / "good.mcap")
    assert found.damaged == 0 and found.messages["/cage_slip"] > 30
    assert last_heard - found.last_ns / SECOND < 1.0

    second = tmp_path / "run_2.mcap.active"
    client.drive_until(lambda: slips_in(second) > 30, "the recording goes on", process)

    def kill_and_look():
        for number in recorders_of(process):
            os.kill(number, signal.SIGKILL)
        return given_up(client)

    client.drive_until(kill_and_look, "a process that is killed again and again is told as an ERROR", process)
    assert "no other is started" in given_up(client)[-1] and not recorders_of(process)

    again = client.call(Trigger, "start_recording", Trigger.Request(), process)
    assert again.success, again.message
    client.drive(2.0)
    [pid] = recorders_of(process)
    killed_ns = time.time_ns()
    process.end(signal.SIGKILL)
    second = Path(again.message)
    wait_for(lambda: second.exists() and not Path(f"/proc/{pid}").exists())
    assert contents(second).is_sound and not Recording(second).unfinished
    assert {name: Recording(second).metadata[name] for name in ("advance_seconds", "advance_samples")} == {
        "advance_seconds": "0.01",
        "advance_samples": "1",
    }, "tick by tick, as the node has computed it"
    times = read_input_log(second).series["shaft_speed"].log_times
    assert len(times) > 30 and killed_ns - times[-1] < SECOND


@pytest.mark.long
def test_a_full_disk_under_the_node_is_told_the_node_goes_on_and_what_was_written_is_complete(launch, small_disk):
    process, client = launch(f"record:={small_disk / 'run'}", "record_keep_free:=0.0", "sample_rate:=1000.0", "governor:=false")
    client.drive_until(lambda: given_up(client), "the full disk is told as an ERROR", process)
    assert "No space left on device" in given_up(client)[-1]
    heard = len(client.received["cage_slip"])
    client.drive_until(lambda: len(client.received["cage_slip"]) > heard + 20, "the node goes on", process)
    client.drive_until((small_disk / "run" / "metadata.yaml").exists, "what was written is completed", process)
    (small_disk / "rest").write_bytes(bytes(shutil.disk_usage(small_disk).free))
    refused = client.call(Trigger, "start_recording", Trigger.Request(), process)
    assert not refused.success and "No space left on device" in refused.message
    seen = len(client.received["diagnostics"])
    client.drive_until(lambda: len(client.received["diagnostics"]) > seen + 2, "the node reports", process)
    assert "cannot be begun" in given_up(client, seen + 2)[-1], "a recording that could not be begun remains an ERROR"
    refused = client.call(Trigger, "stop_recording", Trigger.Request(), process)
    assert not refused.success and "no recording" in refused.message
    assert process.end(signal.SIGINT) == 0
    with Reader(small_disk / "run") as bag:
        assert bag.topics["/roller_loads"].msgcount > 100
    assert [file.name for file in small_disk.rglob("*.mcap*")] == ["run_0.mcap"]
