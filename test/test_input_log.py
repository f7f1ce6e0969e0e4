# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about reading logs: any rosbag2 MCAP, whole or cut short; clocks and faults are said, nothing is guessed."""

import random

import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from recordings import FLOAT, JOINTS, SECOND, TEMPERATURE, WRENCH, joint_state, raw_cdr_float64, steady_log, temperature, truncated, wrench, write_log

from bearing_sim.inputs.log import InputLogError, read_input_log, summary_lines
from bearing_sim.recording.writer import McapFile, message_type

T0 = 1_700_000_000 * SECOND


def test_values_and_header_stamps_come_back_exactly(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, 100.0), (0.1, 200.5)], [(0.05, 800.0, -3.0)], [(0.0, 120.0)])
    log = read_input_log(path)
    assert log.series["shaft_speed"].stamps == [T0, T0 + SECOND // 10]
    assert log.series["shaft_speed"].values == [(100.0,), (200.5,)]
    assert log.series["radial_load"].values == [(800.0, -3.0)]
    assert log.series["oil_temperature"].values == [(pytest.approx(393.15),)]
    assert {series.stamped_by for series in log.series.values()} == {"header"}
    assert log.unfinished == ""


def test_messages_without_header_go_by_log_time_and_it_is_said(tmp_path):
    with McapFile(tmp_path / "log.mcap") as recording:
        for place in range(3):
            recording.write("/n", FLOAT, T0 + place, {"data": 10.0 * place})
            recording.write("/f", FLOAT, T0 + place, {"data": 800.0})
    log = read_input_log(tmp_path / "log.mcap", {"shaft_speed": "/n", "radial_load": "f"})
    assert log.series["shaft_speed"].stamps == [T0, T0 + 1, T0 + 2]
    assert log.series["radial_load"].values == [(800.0,)] * 3
    assert all("by log time" in line for line in summary_lines(log))


def test_log_times_can_be_asked_for(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(5.0, 1.0), (6.0, 1.0)], [(5.0, 1.0, 0.0)])
    assert read_input_log(path, stamps="log").series["shaft_speed"].stamps == [T0 + SECOND // 1000, T0 + 2 * SECOND // 1000]


def test_unset_stamps_mean_log_time(tmp_path):
    with McapFile(tmp_path / "log.mcap") as recording:
        recording.write("/shaft_speed", JOINTS, T0, joint_state(0, 4.0))
        recording.write("/radial_load", WRENCH, T0, wrench(T0, 4.0))
    log = read_input_log(tmp_path / "log.mcap")
    assert (log.series["shaft_speed"].stamped_by, log.series["shaft_speed"].stamps) == ("log time", [T0])
    assert log.series["radial_load"].stamped_by == "header"


def test_a_stamp_missing_among_others_is_a_fault_not_a_log_time(tmp_path):
    with McapFile(tmp_path / "log.mcap") as recording:
        for place, stamp in enumerate((T0, 0, T0 + 5)):
            recording.write("/shaft_speed", JOINTS, T0 + place, joint_state(stamp, 4.0))
        recording.write("/radial_load", WRENCH, T0, wrench(T0, 4.0))
    series = read_input_log(tmp_path / "log.mcap").series["shaft_speed"]
    assert series.stamps == [T0, T0 + 5]
    assert [(error.kind, error.log_ns) for error in series.errors] == [("input.not_stamped", T0 + 1)]


def test_another_joint_can_be_named_and_an_absent_one_is_told(tmp_path):
    with McapFile(tmp_path / "log.mcap") as recording:
        recording.write("/shaft_speed", JOINTS, T0, joint_state(T0, 4.0, name="spool"))
        recording.write("/radial_load", WRENCH, T0, wrench(T0, 4.0))
    assert read_input_log(tmp_path / "log.mcap", joint="spool").series["shaft_speed"].values == [(4.0,)]
    with pytest.raises(InputLogError, match="no usable message on /shaft_speed .*no joint 'shaft'.*'spool'"):
        read_input_log(tmp_path / "log.mcap")


def test_absent_topic_is_told_with_what_there_is(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, 1.0)], [(0.0, 1.0, 0.0)], speed_topic="/engine/shaft_speed")
    with pytest.raises(InputLogError, match=r"no /shaft_speed \(did you mean '/engine/shaft_speed'\?\).*/radial_load \(geometry_msgs"):
        read_input_log(path)


def test_topic_of_a_wrong_type_is_told(tmp_path):
    with McapFile(tmp_path / "log.mcap") as recording:
        recording.write("/shaft_speed", TEMPERATURE, T0, temperature(T0, 20.0))
    with pytest.raises(InputLogError, match="sensor_msgs/msg/Temperature; shaft_speed needs sensor_msgs/msg/JointState or std_msgs/msg/Float64"):
        read_input_log(tmp_path / "log.mcap")


def foreign_file(path, compression, messages, schema=None, encoding="ros2msg", **options):
    """A file as another recorder writes it: /n and /f as Float64, no metadata, its own compression and chunking."""
    with open(path, "wb") as stream:
        writer = Writer(stream, compression=compression, **options)
        writer.start(profile="ros2", library="another")
        definition = message_type(FLOAT).definition if schema is None else schema
        kind = writer.register_schema(FLOAT, encoding, definition.encode())
        speed, load = (writer.register_channel(topic, "cdr", kind) for topic in ("/n", "/f"))
        for log_time, value in messages:
            writer.add_message(speed, log_time, raw_cdr_float64(value), log_time)
            writer.add_message(load, log_time, raw_cdr_float64(800.0), log_time)
        writer.finish()
    return path


NAMES = {"shaft_speed": "/n", "radial_load": "/f"}


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("use_chunking", [True, False])
def test_files_of_other_recorders_are_read(tmp_path, compression, use_chunking):
    path = foreign_file(tmp_path / "log.mcap", compression, [(T0 + place, float(place)) for place in range(9)], use_chunking=use_chunking)
    assert read_input_log(path, NAMES).series["shaft_speed"].values == [(float(place),) for place in range(9)]


def test_definitions_in_idl_are_read_by_type_name(tmp_path):
    idl = "module std_msgs { module msg { struct Float64 { double data; }; }; };"
    path = foreign_file(tmp_path / "log.mcap", CompressionType.NONE, [(T0, 7.0), (T0 + 1, 8.0)], schema=idl, encoding="ros2idl")
    assert read_input_log(path, NAMES).series["shaft_speed"].values == [(7.0,), (8.0,)]


def test_messages_come_in_the_order_of_recording_however_they_lie_in_the_file(tmp_path):
    path = foreign_file(tmp_path / "log.mcap", CompressionType.NONE, [(T0 + 2, 2.0), (T0, 0.0), (T0 + 1, 1.0)])
    assert read_input_log(path, NAMES).series["shaft_speed"].values == [(0.0,), (1.0,), (2.0,)]


def test_undecodable_message_is_counted_and_the_others_are_read(tmp_path):
    path = tmp_path / "log.mcap"
    with open(path, "wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2")
        kind = writer.register_schema(FLOAT, "ros2msg", message_type(FLOAT).definition.encode())
        for topic in ("/n", "/f"):
            channel = writer.register_channel(topic, "cdr", kind)
            for place, data in enumerate((raw_cdr_float64(1.0), b"\x00\x01\x00\x00\x05", raw_cdr_float64(2.0))):
                writer.add_message(channel, T0 + place, data, T0 + place)
        writer.finish()
    series = read_input_log(path, NAMES).series["shaft_speed"]
    assert series.values == [(1.0,), (2.0,)]
    assert [error.kind for error in series.errors] == ["input.unreadable"]


def noisy_log(path, messages=4000):
    """A recording of several chunks whose content does not compress away."""
    noise = random.Random(1)
    return write_log(path, [(place / 10, 5000 * noise.random()) for place in range(messages)], [(0.0, 800.0, 0.0)])


def test_a_recording_cut_anywhere_gives_its_beginning_and_a_warning(tmp_path):
    """Cut at many sizes: what is read is always a beginning of what was written, and only the whole file passes for finished."""
    whole = noisy_log(tmp_path / "log.mcap")
    size = whole.stat().st_size
    full = read_input_log(whole).series["shaft_speed"].stamps
    read = []
    for cut in [*range(size // 9, size - 1, size // 9), size - 1, size - 9]:
        try:
            log = read_input_log(truncated(whole, tmp_path / "log.mcap.active", cut))
        except InputLogError:
            continue  # nothing complete of one of the channels yet
        stamps = log.series["shaft_speed"].stamps
        assert stamps == full[: len(stamps)]
        assert "ends early" in log.unfinished or stamps == full
        read.append(len(stamps))
    assert read and max(read) == len(full) and len(set(read)) > 2


@pytest.mark.parametrize("compression", list(CompressionType))
def test_a_cut_never_makes_up_a_value(tmp_path, compression):
    """Uncompressed chunks without checksums are the hard case: half a message must not pass for one."""
    whole = foreign_file(tmp_path / "log.mcap", compression, [(T0 + place, 1.5) for place in range(40)], chunk_size=300, enable_crcs=False)
    for cut in range(300, whole.stat().st_size, 37):
        try:
            log = read_input_log(truncated(whole, tmp_path / "cut.mcap", cut), NAMES)
        except InputLogError:
            continue
        assert set(log.series["shaft_speed"].values) == {(1.5,)} and set(log.series["radial_load"].values) == {(800.0,)}
        assert not log.series["shaft_speed"].errors


def test_damage_in_the_middle_is_told_and_the_part_before_it_used(tmp_path):
    whole = noisy_log(tmp_path / "log.mcap")
    data = bytearray(whole.read_bytes())
    with open(whole, "rb") as stream:
        chunk = make_reader(stream).get_summary().chunk_indexes[2]
    middle = chunk.chunk_start_offset + chunk.chunk_length // 2
    data[middle : middle + 64] = b"\xff" * 64
    (tmp_path / "damaged.mcap").write_bytes(data)
    log = read_input_log(tmp_path / "damaged.mcap")
    assert "ends early" in log.unfinished
    assert 0 < len(log.series["shaft_speed"].stamps) < 4000


def test_a_bag_of_several_files_is_read_as_one(tmp_path):
    steady_log(tmp_path / "bag_0.mcap", duration=1.0, speed=1.0)
    steady_log(tmp_path / "bag_1.mcap", duration=1.0, speed=2.0, start_ns=T0 + 2 * SECOND)
    paths = ["bag_0.mcap", "bag_1.mcap"]
    (tmp_path / "metadata.yaml").write_text(yaml.safe_dump({"rosbag2_bagfile_information": {"relative_file_paths": paths}}))
    assert read_input_log(tmp_path).series["shaft_speed"].values == [(1.0,)] * 11 + [(2.0,)] * 11


@pytest.mark.parametrize(
    "content, words",
    [(None, "no such file"), (b"", "not an MCAP"), (b"time,speed\n0,1\n", "not an MCAP"), (b"\x89MCAP0\r\n", "not an MCAP|no topics")],
)
def test_what_is_no_recording_is_refused_in_words(tmp_path, content, words):
    path = tmp_path / "log.mcap"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputLogError, match=words):
        read_input_log(path)


def test_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(InputLogError, match="found none"):
        read_input_log(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: {relative_file_paths: [bag_0.mcap.zstd]}")
    (tmp_path / "bag_0.mcap.zstd").write_bytes(b"")
    with pytest.raises(InputLogError, match="not an MCAP file .0 bytes"):
        read_input_log(tmp_path)
