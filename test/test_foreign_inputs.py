# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Inputs that others recorded: other formats, topics, types, units; and what is odd about them counted."""

import json
import math
import sqlite3
from contextlib import closing

import lz4.frame
import numpy as np
import pytest
import zstandard
from click.testing import CliRunner
from mcap.writer import CompressionType, Writer
from recordings import JOINTS, SECOND, WRENCH, joint_state, steady_log, wrench, write_log
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import Anomalies, InputLogError, anomalies, constant, read_input_log, source, source_values, summary_lines
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapFile

T0 = 1_700_000_000 * SECOND
SERVO = "drive_msgs/msg/ServoState"
DEFINITION = "std_msgs/Header header\nfloat64[] velocity\nfloat32 torque\ndrive_msgs/Cell[2] cells\n"
CELL = "float64 y\nint16 z\n"
SPLIT = "=" * 80 + "\n"
HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
TIME = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"


def typestore():
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(CELL, "drive_msgs/msg/Cell") | get_types_from_msg(DEFINITION, SERVO))
    return store


def servo(store, stamp_ns, rpm, load_y=0.5, load_z=-2):
    types = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](stamp_ns // SECOND, stamp_ns % SECOND), "")
    cells = [types["drive_msgs/msg/Cell"](load_y, load_z), types["drive_msgs/msg/Cell"](0.0, 7)]
    return types[SERVO](header, np.array([rpm, -1.0]), 3.0, cells)


def course(count=21):
    """(stamp, speed in rpm) at 10 Hz."""
    return [(T0 + place * SECOND // 10, 30_000.0 + place) for place in range(count)]


def servo_mcap(path):
    store = typestore()
    with open(path, "wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="another")
        text = DEFINITION + SPLIT + HEADER + SPLIT + TIME + SPLIT + "MSG: drive_msgs/Cell\n" + CELL
        channel = writer.register_channel("/servo/state", "cdr", writer.register_schema(SERVO, "ros2msg", text.encode()))
        for stamp, rpm in course():
            writer.add_message(channel, stamp, bytes(store.serialize_cdr(servo(store, stamp, rpm), SERVO)), stamp)
        writer.finish()
    return path


def servo_sqlite(path):
    store = typestore()
    with BagWriter(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/servo/state", SERVO, typestore=store)
        for stamp, rpm in course():
            writer.write(connection, stamp, store.serialize_cdr(servo(store, stamp, rpm), SERVO))
    return path


@pytest.mark.parametrize("make", [servo_mcap, servo_sqlite], ids=["mcap", "sqlite3"])
def test_a_type_that_the_recording_itself_defines_is_read_by_field_paths_and_units(tmp_path, make):
    path = make(tmp_path / ("log.mcap" if make is servo_mcap else "bag"))
    names = {
        "shaft_speed": source("shaft_speed", "/servo/state.velocity[0]", "rpm"),
        "radial_load": source("radial_load", "/servo/state.cells[0].y,cells[0].z", "kN"),
        "oil_temperature": source("oil_temperature", "/servo/state.torque", "degF"),
    }
    log = read_input_log(path, names)
    assert log.series["shaft_speed"].stamps == [stamp for stamp, _ in course()] and log.series["shaft_speed"].stamped_by == "header"
    assert log.series["shaft_speed"].values == [(pytest.approx(rpm * math.pi / 30, rel=1e-12),) for _, rpm in course()]
    assert log.series["radial_load"].values[5] == (500.0, -2000.0)
    assert log.series["oil_temperature"].values[0] == (pytest.approx((3.0 - 32) / 1.8 + 273.15),)


def test_a_single_sqlite_file_without_its_folder_is_read(tmp_path):
    bag = servo_sqlite(tmp_path / "bag")
    [file] = bag.glob("*.db3")
    names = {"shaft_speed": "/servo/state.velocity[0]", "radial_load": "/servo/state.cells[1].z"}
    assert read_input_log(file, names).series["radial_load"].values == [(7.0,)] * 21


def test_standard_types_of_an_sqlite_bag_are_read_as_those_of_mcap(tmp_path):
    store = get_typestore(Stores.ROS2_JAZZY)
    with McapFile(tmp_path / "log.mcap") as recording, BagWriter(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {
            kind: writer.add_connection(topic, kind, typestore=store) for topic, kind in (("/shaft_speed", JOINTS), ("/radial_load", WRENCH))
        }
        for stamp, speed in course():
            for topic, kind, message in (("/shaft_speed", JOINTS, joint_state(stamp, speed)), ("/radial_load", WRENCH, wrench(stamp, 800.0, 3.0))):
                recording.write(topic, kind, stamp, message)
        recording.flush()
        for topic, series in read_input_log(recording.active_path).series.items():
            assert len(series.values) == 21, topic
        from bearing_sim.recording.mcap_reader import McapReader

        kinds = {}
        for record in McapReader(recording.active_path):
            if type(record).__name__ == "Channel":
                kinds[record.id] = JOINTS if record.topic == "/shaft_speed" else WRENCH
            elif type(record).__name__ == "Message":
                writer.write(connections[kinds[record.channel_id]], record.log_time, record.data)
    ours, theirs = read_input_log(tmp_path / "log.mcap"), read_input_log(tmp_path / "bag")
    for channel in ("shaft_speed", "radial_load"):
        assert ours.series[channel] == theirs.series[channel]


def test_an_absent_field_is_told_with_those_there_are(tmp_path):
    path = servo_mcap(tmp_path / "log.mcap")
    for field, words in (
        ("speed", "no field 'speed'.*it has header, velocity, torque, cells"),
        ("velocity[7]", "has 2 numbers"),
        ("cells", "is not a number"),
        ("velocity", r"is not a number but .* \(did you mean 'velocity\[0\]'\?\)"),
        ("velocty[0]", r"did you mean 'velocity\[0\]'"),
        ("torque.y", r"no field 'y' in the message \(torque.y\); it has none"),
    ):
        with pytest.raises(InputLogError, match=words):
            read_input_log(path, {"shaft_speed": f"/servo/state.{field}", "radial_load": "/servo/state.torque"})
    wanted = r"needs sensor_msgs/msg/JointState or std_msgs/msg/Float64, or name a field of it, such as /servo/state.velocity\[0\]"
    with pytest.raises(InputLogError, match=wanted):
        read_input_log(path, {"shaft_speed": "/servo/state", "radial_load": "/servo/state.torque"})


def test_a_log_without_the_usual_topics_says_how_the_numbers_in_it_are_named(tmp_path):
    with pytest.raises(InputLogError, match=r"no /shaft_speed; no /radial_load; .* by its field, such as /servo/state.velocity\[0\]"):
        read_input_log(servo_mcap(tmp_path / "log.mcap"))


@pytest.mark.parametrize("make", [servo_mcap, servo_sqlite], ids=["mcap", "sqlite3"])
def test_info_counts_what_a_recording_of_others_holds_and_names_the_files_that_are_missing(tmp_path, make):
    path = make(tmp_path / ("log.mcap" if make is servo_mcap else "recorded.bag"))
    done = CliRunner().invoke(main, ["info", str(path), "--json"])
    told = json.loads(done.stdout)
    assert done.exit_code == 0 and told["sound"] and told["files"][0]["topics"] == {"/servo/state": {"type": SERVO, "messages": 21}}
    assert told["files"][0]["seconds"] == pytest.approx(2.0)
    if make is servo_sqlite:
        [file] = path.glob("*.db3")
        file.rename(path / "other.db3")
        for command in ("info", "view", "replay"):
            done = CliRunner().invoke(main, [command, str(path), *(["--scene", "deng2017_table1"] if command == "replay" else [])])
            assert done.exit_code == 2 and "names recorded.bag.db3, which is not there; there is other.db3" in done.output, done.output
        (path / "other.db3").unlink()
        assert "the folder has lost its recording" in CliRunner().invoke(main, ["info", str(path)]).output


@pytest.mark.parametrize("text", ["/a.b[", "/a.b c", "/a.y,z", "/a..[x]"])
def test_a_path_that_cannot_be_read_is_refused(text):
    with pytest.raises(ValueError, match="field"):
        source("shaft_speed", text)


def test_ring_temperatures_are_read_from_named_topics_in_the_unit_that_is_given(tmp_path):
    path = steady_log(tmp_path / "log.mcap", duration=1.0, rate=10)
    rings = tmp_path / "rings.mcap"
    with McapFile(rings) as recording:
        for place in range(11):
            recording.write("/hot_side", "std_msgs/msg/Float64", T0 + place * SECOND // 10, {"data": 400.0})
    command = ["replay", path, rings, "--scene", "deng2017_table1", "--set", "heat.law=given", "--json"]
    command += ["--inner-ring-temperature", "/hot_side.data", "--temperature-unit", "K", "-o", tmp_path / "run.mcap"]
    done = CliRunner().invoke(main, list(map(str, command)))
    assert done.exit_code == 0, done.output
    samples = np.concatenate([item for item in Recording(tmp_path / "run.mcap") if isinstance(item, np.ndarray)])
    np.testing.assert_array_equal(samples["inner_ring_temperature_measured"], 400.0)
    np.testing.assert_array_equal(samples["inner_ring_temperature"], 400.0)
    assert np.isnan(samples["outer_ring_temperature_measured"]).all()


def test_a_unit_of_another_dimension_is_refused():
    with pytest.raises(ValueError, match="such as '45000 rpm'"):
        source("shaft_speed", "/a.b", "kN")


def test_units_hold_for_standard_types_too():
    class Number:
        data = 3000.0

    assert source_values("shaft_speed", source("shaft_speed", "/n", "rpm"), "std_msgs/msg/Float64", Number, "shaft") == (
        pytest.approx(100 * math.pi),
    )


def test_several_recordings_are_read_as_one(tmp_path):
    speeds = write_log(tmp_path / "speed.mcap", [(k / 10, 100.0 + k) for k in range(11)], [])
    loads = write_log(tmp_path / "load.mcap", [], [(k / 10, 800.0, 0.0) for k in range(11)])
    later = steady_log(tmp_path / "later.mcap", duration=1.0, speed=7.0, start_ns=T0 + 2 * SECOND)
    log = read_input_log([later, speeds, loads])
    assert [value for (value,) in log.series["shaft_speed"].values] == [100.0 + k for k in range(11)] + [7.0] * 11
    assert len(log.series["radial_load"].values) == 22


def odd_log(path):
    """Speeds at 10 Hz: one stamped before its predecessor, two repeated, a gap of 3 s, and the last five logged in a burst."""
    stamps = [k / 10 for k in range(20)]
    stamps[7] = stamps[5] + 0.01
    stamps[12] = stamps[13] = stamps[11]
    stamps += [5.0 + k / 10 for k in range(10)]
    with McapFile(path) as recording:
        for place, stamp in enumerate(stamps):
            arrival = T0 + (round(stamp * SECOND) if place < 25 else 6 * SECOND + place)
            stamped = T0 + round(stamp * SECOND)
            recording.write("/shaft_speed", JOINTS, max(arrival, T0 + place * SECOND // 10), joint_state(stamped, 4000.0))
            recording.write("/radial_load", WRENCH, stamped, wrench(stamped, 800.0))
    return path


def test_oddities_are_counted(tmp_path):
    log = read_input_log(odd_log(tmp_path / "log.mcap"))
    assert anomalies(log.series["shaft_speed"]) == Anomalies(out_of_order=1, repeated=2, in_bursts=4, gaps=1)
    clean = read_input_log(write_log(tmp_path / "clean.mcap", [(k / 10, 1.0) for k in range(9)], [(0.0, 1.0, 0.0), (0.8, 1.0, 0.0)]), stamps="log")
    assert anomalies(clean.series["shaft_speed"]) == Anomalies(0, 0, 0, 0)


def test_replay_takes_what_others_recorded_and_sums_up_what_is_odd(tmp_path):
    options = ["--scene", "deng2017_table1", "--json"]

    def replayed(*arguments, code=0):
        done = CliRunner().invoke(main, ["replay", *map(str, arguments), *options])
        assert done.exit_code == code, done.output
        return json.loads(done.stdout)

    speed = ["--speed", "/servo/state.velocity[0]", "--speed-unit", "rpm", "--load", "/servo/state.cells[0].y,cells[0].z", "--load-unit", "kN"]
    told = replayed(servo_sqlite(tmp_path / "bag"), *speed, "-o", tmp_path / "run.mcap")
    assert told["read"]["there"] == told["read"]["used"] == 42 and told["sim_seconds"] == pytest.approx(2.0)
    told = replayed(odd_log(tmp_path / "odd.mcap"), code=3)
    assert told["unknown_seconds"] == 0.0, "later stamps make up for it"
    assert told["inputs_anomalies"]["shaft_speed"] == {"out_of_order": 1, "repeated": 2, "in_bursts": 4, "gaps": 1}
    assert told["read"]["not_used_by_reason"]["input.time_backwards"] >= 1 and told["read"]["not_used_by_reason"]["input.time_repeated"] >= 2


def test_a_constant_stands_at_every_stamp_for_what_was_not_measured_or_is_not_to_be_read(tmp_path):
    path = steady_log(tmp_path / "log.mcap", duration=1.0, rate=10)
    log = read_input_log(path, constants={"radial_load": constant("radial_load", "2 kN"), "oil_temperature": constant("oil_temperature", "60 degC")})
    assert log.series["radial_load"].values == [(2000.0,)] * len(log.series["shaft_speed"].stamps)
    assert log.series["radial_load"].stamps == log.series["shaft_speed"].stamps == log.series["oil_temperature"].stamps
    assert log.series["oil_temperature"].values[0] == (333.15,)
    assert "radial_load: 2000 N throughout, not measured" in list(summary_lines(log))
    with pytest.raises(InputLogError, match="nothing is left of the log"):
        read_input_log(path, constants={"radial_load": 1.0, "shaft_speed": 1.0})


@pytest.mark.parametrize(
    "channel, text, words",
    [
        ("radial_load", "800", "radial_load = 800: a number without a unit; write for example 800N or 800kN"),
        ("shaft_speed", "1500", "write for example 1500rpm"),
        ("radial_load", "800rpm", "wrong dimension"),
        ("radial_load", "800kn", "did you mean 'kN'"),
        ("radial_load", "-1N", "zero or more"),
        ("oil_temperature", "60 K/s", "wrong dimension"),
    ],
)
def test_a_constant_that_cannot_be_meant_is_refused(channel, text, words):
    with pytest.raises(ValueError, match=words):
        constant(channel, text)


def test_replay_takes_constants_for_the_topics_that_a_log_lacks(tmp_path):
    path = steady_log(tmp_path / "log.mcap", duration=0.2, rate=10)
    options = ("--scene", "deng2017_table1", "--load", "800N", "--oil-temperature", "100degC", "-o", tmp_path / "run.mcap", "--json")
    done = CliRunner().invoke(main, ["replay", *map(str, (path, *options))])
    assert done.exit_code == 0, done.output
    (block,) = [item for item in Recording(tmp_path / "run.mcap") if isinstance(item, np.ndarray)]
    assert set(block["load_y"]) == {800.0} and set(block["oil_temperature"]) == {373.15}
    assert json.loads(done.stdout)["events"] == {}


PACK = {"zstd": lambda data: zstandard.ZstdCompressor().compress(data), "lz4": lz4.frame.compress}


def packed_messages(bag, how):
    """Compress the messages of an SQLite bag, as rosbag2 does, and lose its metadata."""
    [file] = bag.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        rows = database.execute("SELECT id, data FROM messages").fetchall()
        database.executemany("UPDATE messages SET data = ? WHERE id = ?", [(PACK[how](data), number) for number, data in rows])
    (bag / "metadata.yaml").unlink()
    return bag


def packed_file(path, how, keep=1.0):
    packed = PACK[how](path.read_bytes())
    target = path.with_name(f"{path.name}.{how}")
    target.write_bytes(packed[: round(keep * len(packed))])
    path.unlink()
    (path.parent / "metadata.yaml").unlink(missing_ok=True)
    return target


@pytest.mark.parametrize("how", PACK)
def test_compressed_messages_and_files_are_read_without_metadata_and_info_says_so(tmp_path, how):
    names = {"shaft_speed": "/servo/state.velocity[0]", "radial_load": "/servo/state.cells[1].z"}
    whole = read_input_log(servo_mcap(tmp_path / "whole.mcap"), names).series
    (tmp_path / "folder").mkdir()
    made = {
        "messages": packed_messages(servo_sqlite(tmp_path / "messages"), how),
        "sqlite": packed_file(next(servo_sqlite(tmp_path / "sqlite").glob("*.db3")), how).parent,
        "file": packed_file(servo_mcap(tmp_path / "log.mcap"), how),
        "folder": packed_file(servo_mcap(tmp_path / "folder" / "log_0.mcap"), how).parent,
    }
    for name, path in made.items():
        log = read_input_log(path, names)
        assert {channel: series.values for channel, series in log.series.items()} == {channel: series.values for channel, series in whole.items()}
        assert any(f"compressed by {how}" in note for note in log.lost.notes), name
        shown = CliRunner().invoke(main, ["info", str(path), "--json"])
        report = json.loads(shown.stdout)["files"][0]
        assert shown.exit_code == 0 and report["messages"] == 21 and report["notes"] == log.lost.notes and not report["undecodable"]


@pytest.mark.parametrize("how", PACK)
def test_a_compressed_file_that_is_cut_short_is_used_up_to_there_and_said(tmp_path, how):
    path = tmp_path / "log.mcap"
    with open(path, "wb") as stream:
        writer, random = Writer(stream, compression=CompressionType.NONE, chunk_size=4096), np.random.default_rng(1)
        writer.start(profile="ros2", library="another")
        channel = writer.register_channel("/noise", "cdr", writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data"))
        for k in range(3000):
            writer.add_message(channel, T0 + k, random.bytes(200), T0 + k)
        writer.finish()
    bag = BagReader(packed_file(path, how, 0.6))
    read = sum(not isinstance(item, BagTopic) for item in bag)
    assert 0 < read < 3000 and not bag.tally.is_whole and "ends early" in bag.tally.text


def test_info_and_replay_agree_on_messages_that_cannot_be_decoded(tmp_path):
    path = tmp_path / "log.mcap"
    with open(path, "wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="another")
        for topic in ("/shaft_speed", "/radial_load"):
            channel = writer.register_channel(topic, "cdr", writer.register_schema("drive_msgs/msg/Unknown", "ros2idl", b"module { none"))
            writer.add_message(channel, T0, b"\0\1\0\0" + bytes(8), T0)
        writer.finish()
    shown = CliRunner().invoke(main, ["info", str(path)])
    assert shown.exit_code == 0 and shown.stdout.count("cannot be decoded") == 2 and "cannot be parsed as IDL" in shown.stdout
    names = {"shaft_speed": "/shaft_speed.data", "radial_load": "/radial_load.data"}
    with pytest.raises(InputLogError, match="cannot be parsed as IDL"):
        read_input_log(path, names)
