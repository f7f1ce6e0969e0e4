# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's recording when something ends it: the node killed, the disk full."""

import shutil
import signal
import time

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.rosbag2 import Reader  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

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


def slips_in(path):
    """Return how many messages of cage_slip a recording has so far; none where it is not there, or has no beginning yet."""
    try:
        return contents(path).messages["/cage_slip"]
    except (OSError, RecordingError):
        return 0


def given_up(client, since=0):
    return [text for level, name, text in client.statuses(since) if level == 2 and "sink.failed" in name and text.startswith("record: ")]


@pytest.mark.long
def test_what_a_killed_node_had_flushed_is_recovered_and_says_how_to_repeat_the_run(launch, tmp_path):
    process, client = launch(f"record:={tmp_path / 'run.mcap'}")
    client.drive(2.0)
    client.drive_until(lambda: slips_in(tmp_path / "run.mcap.active") > 30, "the recording goes on", process)
    killed_ns = time.time_ns()
    process.end(signal.SIGKILL)
    second = tmp_path / "good.mcap"
    found = recover(tmp_path / "run.mcap.active", second)
    assert found.damaged == 0 and killed_ns - found.last_ns < SECOND
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
