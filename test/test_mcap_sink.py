# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about recordings: strict readers decode every message, the file says where it comes from, a killed run loses little."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.exceptions import EndOfFile, RecordLengthLimitExceeded
from mcap.reader import make_reader
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from bearing_sim.files import provenance
from bearing_sim.messages.cdr import load_message_types
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, ReceivedInputs
from bearing_sim.messages.topics import ALWAYS_KNOWN, Origin, outputs, recorded
from bearing_sim.model.sample import new_block
from bearing_sim.recording.writer import METADATA, McapFile, McapSink, message_type
from bearing_sim.scene.loader import load_scene, scene_from_yaml
from bearing_sim.simulation import Inputs

START = 1_700_000_000_000_000_000
ROLLERS = 18


def numbered_block(samples):
    """Samples at 10 Hz whose every number is told apart."""
    block = new_block(samples, ROLLERS)
    for place, name in enumerate(block.dtype.names):
        block[name] = 1000.0 * place + np.arange(block[name].size).reshape(block[name].shape)
    block["time"] = np.arange(samples) / 10
    return block


@pytest.fixture
def scene():
    return load_scene("deng2017_table1")


@pytest.fixture
def recording(tmp_path, scene):
    """A finished recording of three ticks, an event and a diagnostics message; returns path and samples."""
    block = numbered_block(3)
    with McapSink(tmp_path / "run.mcap", scene, START) as sink:
        for sample in range(3):
            sink.write(ReceivedInputs(sample / 10, Inputs(4000.0 + sample, 800.0, -50.0, 393.15)))
            sink.write(block[sample : sample + 1])
        sink.write(Event(0.2, Level.WARN, "slip.high", "", "slip is 6 %, expected below 5 %"))
    return sink.path, block


def messages(path):
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [(channel.topic, message.log_time, decoded) for _, channel, message, decoded in reader.iter_decoded_messages()]


def test_rosbags_deserialises_every_message(recording, scene):
    path, block = recording
    store = get_typestore(Stores.ROS2_JAZZY)
    seen = {}
    with Reader(path) as reader:
        for connection, stamp, raw in reader.messages():
            seen.setdefault(connection.topic, []).append((stamp, store.deserialize_cdr(raw, connection.msgtype)))
    assert {topic.lstrip("/"): len(got) for topic, got in seen.items()} == {**dict.fromkeys([*ALWAYS_KNOWN, *recorded(scene)], 3), "diagnostics": 1}
    assert [message.data for _, message in seen["/cage_slip"]] == list(block["cage_slip"])
    np.testing.assert_array_equal(seen["/roller_loads"][1][1].data, [*block["inner_load"][1], *block["outer_load"][1]])
    joints = seen["/bearing_joints"][2][1]
    assert dict(zip(joints.name, joints.velocity)) == {
        "shaft": block["shaft_speed"][2],
        "cage": block["cage_speed"][2],
        "cage_ideal": block["ideal_cage_speed"][2],
    }
    assert seen["/diagnostics"][0][1].status[0].level == 1


@pytest.mark.parametrize("rate, together", [(1000.0, 37), (100.0, 10), (60.0, 1), (20.0, 4)])
def test_what_repeats_others_is_recorded_fifty_times_a_second_at_most_in_order_and_with_the_sample_it_belongs_to(rate, together, tmp_path, scene):
    count = int(rate)
    block = numbered_block(count)
    block["time"] = np.arange(count) / rate
    with McapSink(tmp_path / "run.mcap", scene, START) as sink:
        for first in range(0, count, together):
            sink.write(block[first : first + together])
    with Reader(sink.path) as reader:
        found = [(connection.topic, stamp, raw) for connection, stamp, raw in reader.messages()]
    with open(sink.path, "rb") as stream:
        written = [message.log_time for _, _, message in make_reader(stream).iter_messages(log_time_order=False)]
    assert written == sorted(written) and {topic: sum(one == topic for one, *_ in found) for topic in ("/damage", "/rollers")} == {
        "/damage": count,
        "/rollers": min(count, 50),
    }
    times = np.array([stamp - START for topic, stamp, _ in found if topic == "/rollers"]) * 1e-9
    assert times[0] == 0.0 and np.diff(times).min() > 0.02 - 1.0 / rate
    store = get_typestore(Stores.ROS2_JAZZY)
    states = {stamp: store.deserialize_cdr(raw, "sensor_msgs/msg/JointState") for topic, stamp, raw in found if topic == "/bearing_state"}
    damage = {stamp: store.deserialize_cdr(raw, "std_msgs/msg/Float64").data for topic, stamp, raw in found if topic == "/damage"}
    assert all(state.position[list(state.name).index("damage")] == damage[stamp] for stamp, state in states.items())


def test_tilts_and_slices_are_recorded_where_the_level_has_them_and_only_there(tmp_path):
    block = numbered_block(2)
    for level in ("slip", "planar", "spatial"):
        scene = load_scene("deng2017_table1", [f"level={level}", "heat.law=network"])
        with McapSink(tmp_path / f"{level}.mcap", scene, START) as sink:
            sink.write(block)
        found = {topic: message for topic, _, message in messages(sink.path)}
        tilting = {"axis_tilts", "roller_tilts", "slice_pressures"}
        assert {topic[1:] for topic in found} == recorded(scene).keys() and (tilting <= outputs(scene).keys()) == (level == "spatial")
        assert {"predicted_temperatures", "heat_flows"} <= outputs(scene).keys()
    np.testing.assert_array_equal(found["/roller_tilts"].data, [*block["roller_tilt"][1], *block["roller_skew"][1]])


def test_mcap_ros2_decodes_every_message_at_its_sample_time(recording):
    path, block = recording
    decoded = messages(path)
    assert [(log_time, message.data) for topic, log_time, message in decoded if topic == "/damage"] == [
        (START + 100_000_000 * sample, block["damage"][sample]) for sample in range(3)
    ]
    loads = [message.wrench.force for topic, _, message in decoded if topic == "/radial_load"]
    assert [(force.y, force.z) for force in loads] == [(800.0, -50.0)] * 3


def test_header_stamps_agree_with_log_times(recording):
    for _, log_time, message in messages(recording[0]):
        if hasattr(message, "header"):
            assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == log_time


def test_rosbag2_metadata_counts_what_is_in_the_file(recording, scene):
    with open(recording[0], "rb") as stream:
        reader = make_reader(stream)
        records = {record.name: record.metadata for record in reader.iter_metadata()}
        summary = reader.get_summary()
    bag = yaml.safe_load(records["rosbag2"]["serialized_metadata"])["rosbag2_bagfile_information"]
    assert bag["version"] == 9 and bag["message_count"] == summary.statistics.message_count == 3 * (len(ALWAYS_KNOWN) + len(recorded(scene))) + 1
    assert bag["duration"]["nanoseconds"] == 200_000_000
    hashes = {entry["topic_metadata"]["name"]: entry["topic_metadata"]["type_description_hash"] for entry in bag["topics_with_message_count"]}
    assert hashes == {channel.topic: channel.metadata["topic_type_hash"] for channel in summary.channels.values()}
    assert all("reliable" in channel.metadata["offered_qos_profiles"] for channel in summary.channels.values())
    with open(recording[0], "rb") as stream:
        assert make_reader(stream).get_header().profile == "ros2"


def test_type_hashes_are_those_of_the_ros_distribution(recording):
    """std_msgs/msg/Float64 of Jazzy, as `ros2 topic info --verbose` prints it."""
    with open(recording[0], "rb") as stream:
        channels = make_reader(stream).get_summary().channels.values()
    slip = next(channel for channel in channels if channel.topic == "/cage_slip")
    assert slip.metadata["topic_type_hash"] == "RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"


def test_file_holds_its_scene_and_its_origin(recording, scene):
    with open(recording[0], "rb") as stream:
        origin = next(record.metadata for record in make_reader(stream).iter_metadata() if record.name == METADATA)
    assert scene_from_yaml(origin["scene"]) == scene
    assert int(origin["start_ns"]) == START and origin["level"] == scene.level
    assert origin["package_version"] == provenance.package_version()
    assert origin["git_hash"] == provenance.git_hash()


def test_rerun_accepts_the_file(recording, tmp_path):
    rerun_cli = pytest.importorskip("rerun_cli", reason="rerun-sdk is not installed")
    executable = Path(rerun_cli.__file__).with_name("rerun")
    environment = dict(os.environ, HOME=str(tmp_path), XDG_CONFIG_HOME=str(tmp_path), RUST_LOG="error")
    subprocess.run([executable, "analytics", "disable"], env=environment, capture_output=True, timeout=30)
    check = subprocess.run([executable, "mcap", "check", str(recording[0])], env=environment, capture_output=True, text=True, timeout=60)
    assert check.returncode == 0, check.stdout + check.stderr
    assert "/cage_slip" in check.stdout


def test_unfinished_file_keeps_a_name_that_says_so(tmp_path, scene):
    sink = McapSink(tmp_path / "run.mcap", scene, START)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.mcap.active"]
    sink.close()
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.mcap"]


def test_remains_of_a_killed_run_are_not_overwritten(tmp_path, scene):
    (tmp_path / "run.mcap.active").write_bytes(b"precious")
    with McapSink(tmp_path / "run.mcap", scene, START) as sink:
        assert [kind for _, kind, _ in sink.news()] == ["recording.set_aside"]
        with pytest.raises(FileExistsError, match="another run is writing it"):
            McapSink(tmp_path / "run.mcap", scene, START)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["run.mcap", "run_killed_1.mcap.active"]
    assert (tmp_path / "run_killed_1.mcap.active").read_bytes() == b"precious"


def test_writing_after_close_is_refused_and_closing_twice_is_not(tmp_path, scene):
    sink = McapSink(tmp_path / "run.mcap", scene, START)
    sink.close()
    sink.close()
    with pytest.raises(ValueError, match="closed"):
        sink.write(numbered_block(1))


def test_message_written_before_a_pause_reaches_the_file_without_a_further_write(tmp_path):
    recording = McapFile(tmp_path / "run.mcap", flush_every=0.05)
    recording.write("/cage_slip", "std_msgs/msg/Float64", 5, {"data": 0.25})
    deadline = time.monotonic() + 20
    while not (found := list(streamed(recording.active_path))) and time.monotonic() < deadline:
        time.sleep(0.02)
    recording.close()
    assert [(topic, message.log_time) for topic, message in found] == [("/cage_slip", 5)]


def test_a_fault_of_the_disk_reaches_the_writer(tmp_path):
    recording = McapFile(tmp_path / "run.mcap", flush_every=0.01)
    recording.write("/cage_slip", "std_msgs/msg/Float64", 5, {"data": 0.25})

    recording._file.error = OSError(28, "No space left on device")
    with pytest.raises(OSError, match="No space left"):
        recording.write("/cage_slip", "std_msgs/msg/Float64", 6, {"data": 0.25})


def test_inputs_keep_the_stamps_and_frames_of_their_senders(tmp_path, scene):
    with McapSink(tmp_path / "run.mcap", scene, START) as sink:
        inputs = Inputs(4000.0, 800.0, -50.0, 393.15)
        sink.write(ReceivedInputs(1.0, inputs, ["radial_load"], Origin(START + 990_000_000, "dyno")))
        sink.write(ReceivedInputs(1.0, inputs, ["shaft_speed"], Origin(None, "")))
        sink.write(Measurement(1.5, 1800.0, 0.01, 0.5, Origin(START + 1_490_000_000, "laser")))
        sink.write(MeasuredClearance(1.75, 3e-5, 1e-6, Origin(START + 1_740_000_000, "probe")))
    decoded = {topic: (log_time, message) for topic, log_time, message in messages(sink.path)}
    for topic, log_time, stamp_ns, frame in (
        ("/radial_load", 1_000_000_000, 990_000_000, "dyno"),
        ("/shaft_speed", 1_000_000_000, 1_000_000_000, ""),
        ("/cage_speed_measured", 1_500_000_000, 1_490_000_000, "laser"),
        ("/running_clearance_measured", 1_750_000_000, 1_740_000_000, "probe"),
    ):
        logged, message = decoded[topic]
        stamp = message.header.stamp
        assert (logged - START, stamp.sec * 10**9 + stamp.nanosec - START, message.header.frame_id) == (log_time, stamp_ns, frame)


def streamed(path):
    """Every (topic, message) of a file that may end anywhere."""
    channels = {}
    with open(path, "rb") as stream:
        try:
            for record in StreamReader(stream).records:
                if isinstance(record, Channel):
                    channels[record.id] = record.topic
                elif isinstance(record, Message):
                    yield channels[record.channel_id], record
        except (EndOfFile, RecordLengthLimitExceeded):
            return


WRITER = """
import sys, time
from bearing_sim.model.sample import new_block
from bearing_sim.scene.loader import load_scene
from bearing_sim.recording.writer import McapSink
sink = McapSink(sys.argv[1], load_scene("deng2017_table1"), 0, flush_every=1e9)
block = new_block(1, 18)
for sample in range(140):
    block["time"] = 0.01 * sample
    sink.write(block)
    if sample == 99:
        sink.flush()
print("written", flush=True)
time.sleep(600)
"""


@pytest.mark.timeout(60)
def test_a_killed_writer_leaves_all_that_it_had_flushed(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path / "run.mcap")], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "written\n"
    os.kill(child.pid, signal.SIGKILL)
    child.wait(10)
    recovered = [message.log_time for topic, message in streamed(tmp_path / "run.mcap.active") if topic == "/cage_slip"]
    assert not (tmp_path / "run.mcap").exists()
    assert recovered[:100] == [10_000_000 * sample for sample in range(100)] and len(recovered) < 140


def test_once_types_are_loaded_no_message_of_a_recording_waits_for_one(tmp_path):
    load_message_types()
    loaded = message_type.cache_info().misses
    with McapSink(tmp_path / "run.mcap", load_scene("deng2017_table1", ["level=spatial"]), START) as sink:
        sink.write(ReceivedInputs(0.0, Inputs(4000.0, 800.0, -50.0, 393.15)))
        sink.write(Measurement(0.0, 1800.0, 0.01))
        sink.write(numbered_block(1))
        sink.write(Event(0.2, Level.WARN, "slip.high", "", "slip is 6 %"))
    assert message_type.cache_info().misses == loaded
