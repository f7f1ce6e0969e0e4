# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bags that others wrote: what can be shown is, what cannot is said; and measured cages in recordings of ours."""

import inspect
import math

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import FLOAT, JOINTS, SECOND, WRENCH, joint_state, steady_log, temperature, wrench, write_log
from rerun.chunk import RrdReader
from rerun_files import column
from synthetic_run import synthetic_block

from bearing_sim.cli import view
from bearing_sim.files.tally import Tally
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import message_type, typestore
from bearing_sim.messages.diagnostics import report
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement
from bearing_sim.messages.topics import outputs
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapFile, McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.view.bag import BagSeries, CloudCourse, Line, read_bag_series, write_bag_view
from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN
from bearing_sim.view.worker import RerunFile

START = 1_700_000_000 * SECOND
SCENE = load_scene("deng2017_table1")


def run(*arguments):
    return CliRunner().invoke(view.view, [*(str(argument) for argument in arguments), "--force"])


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "servo.mcap"
    with McapFile(path) as recording:
        for k in range(50):
            now = START + k * SECOND // 10
            recording.write("/servo/state", JOINTS, now, joint_state(now, 100.0 + k))
            recording.write("/cell", WRENCH, now, wrench(now, 300.0, 400.0))
            recording.write("/oil_temperature", "sensor_msgs/msg/Temperature", now, temperature(now, 80.0))
            recording.write("/valve", FLOAT, now, {"data": 0.1 * k})
            recording.write(
                "/where",
                "std_msgs/msg/String",
                now,
                {"data": "here"},
            )
    return path


def test_speed_load_and_plain_numbers_are_shown_and_the_rest_is_named(bag, tmp_path):
    result = run(bag, "-o", tmp_path / "run.rrd", "--no-open", "--load-topic", "/cell")
    assert result.exit_code == 0, result.output
    assert "/where: nothing to plot in std_msgs/msg/String" in result.output and "need a model" in result.output
    times, speeds = column(tmp_path / "run.rrd", "/speed/shaft")
    np.testing.assert_allclose(times, 0.1 * np.arange(50), atol=1e-6)
    np.testing.assert_allclose(speeds, (100.0 + np.arange(50)) * 60 / (2 * math.pi), rtol=1e-6)
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/load/radial")[1], 500.0)
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/oil/temperature")[1], 80.0)
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/bag/valve")[1], 0.1 * np.arange(50), rtol=1e-6)
    (about,) = [chunk for chunk in RrdReader(str(tmp_path / "run.rrd")).stream() if chunk.entity_path == "/about"]
    assert "/where" in str(about.to_record_batch().to_pydict())


def test_the_folder_of_a_bag_in_sqlite_is_shown_too(bag, tmp_path):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store, folder = get_typestore(Stores.ROS2_JAZZY), tmp_path / "bag"
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/rpm", FLOAT, typestore=store)
        for k in range(10):
            message = store.types[FLOAT](data=50.0 + k)
            writer.write(connection, START + k * SECOND, store.serialize_cdr(message, FLOAT))
    result = run(folder, "-o", tmp_path / "run.rrd", "--no-open", "--speed-topic", "rpm")
    assert result.exit_code == 0, result.output
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/speed/shaft")[1], (50.0 + np.arange(10)) * 30 / math.pi, rtol=1e-6)


def encoder_bag(folder, plugin):
    """Write a bag of 20 messages of a type that only the bag defines, with ``int32[] data`` and a nested number."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store, kind = get_typestore(Stores.ROS2_JAZZY), "servo_msgs/msg/Encoder"
    store.register(get_types_from_msg("int32[] data\ngeometry_msgs/Point place\nuint8[] picture\n", kind))
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/servo/encoder", kind, typestore=store)
        for k in range(20):
            place = store.types["geometry_msgs/msg/Point"](0.5, -1.0 * k, 0.0)
            message = store.types[kind](np.array([100 + k, 7], np.int32), place, np.arange(3, dtype=np.uint8))
            writer.write(connection, START + k * SECOND, store.serialize_cdr(message, kind))
    return folder


@pytest.mark.parametrize("plugin", ["MCAP", "SQLITE3"])
def test_numbers_in_any_type_are_shown_by_their_fields_also_of_a_folder_called_bag(tmp_path, plugin):
    from rosbags.rosbag2 import StoragePlugin

    folder = encoder_bag(tmp_path / "servo.bag", StoragePlugin[plugin])
    series = read_bag_series(folder).series
    assert {line for _, line, _ in series} == {f"/servo/encoder {field}" for field in ("data[0]", "data[1]", "place.x", "place.y", "place.z")}
    np.testing.assert_array_equal(series["", "/servo/encoder data[0]", "-"][1], 100.0 + np.arange(20))
    np.testing.assert_array_equal(series["", "/servo/encoder place.y", "-"][1], -np.arange(20.0))
    options = ["--speed", "/servo/encoder.data[0]", "--speed-unit", "rpm", "--load", "2 kN", "--no-open", "-o", tmp_path / "run.rrd"]
    result = run(folder, *options)
    assert result.exit_code == 0, result.output
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/speed/shaft")[1], 100.0 + np.arange(20), rtol=1e-6)
    np.testing.assert_array_equal(column(tmp_path / "run.rrd", "/load/radial")[1], 2000.0)
    for speed, words in (("/servo/encoder.data", "did you mean 'data[0]'"), ("/servo/encoder", "its numbers are data[0], data[1], place.x")):
        result = run(folder, "--speed", speed, "--no-open", "-o", tmp_path / "run.rrd")
        assert result.exit_code == 2 and words in result.output, result.output


def test_messages_out_of_order_are_put_in_order(tmp_path):
    found = read_bag_series(steady_log(tmp_path / "log.mcap"))
    times, values = found.series["speed", "/shaft_speed shaft", "rpm"]
    assert (np.diff(times) > 0).all() and len(times) == 21 and values == pytest.approx(4000.0 * 30 / math.pi)
    assert any("no cage speed (/cage_speed_measured)" in line for line in found.left_out)


def test_a_long_bag_is_thinned_out(tmp_path):
    times = 1e-3 * np.arange(300_000)
    values = np.sin(times)
    values[123_456] = 99.0
    write_bag_view(tmp_path / "run.rrd", "long", BagSeries({("", "/a", "-"): (times, values)}, [], [], START, 300.0, Tally()))
    assert len(column(tmp_path / "run.rrd", "/bag/a")[0]) < 10_000
    ranges = [
        chunk.to_record_batch().column("Scalars:scalars").to_pylist()
        for chunk in RrdReader(str(tmp_path / "run.rrd")).stream()
        if chunk.entity_path == "/bag/a/range" and not chunk.is_static
    ]
    assert max(high for rows in ranges for _, high in rows) == 99.0


def test_diagnostics_of_others_reach_the_log(tmp_path):
    path = tmp_path / "run.mcap"
    with McapFile(path) as recording:
        status = [
            {"level": bytes([k]), "name": f"pump {k}", "message": "hot", "hardware_id": "x", "values": [{"key": "a", "value": "b"}]} for k in range(3)
        ]
        recording.write(
            "/diagnostics",
            "diagnostic_msgs/msg/DiagnosticArray",
            START,
            {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "x"}, "status": status},
        )
        recording.write("/valve", FLOAT, START + SECOND, {"data": 1.0})
    assert [(event.level, event.kind) for event in read_bag_series(path).events] == [(Level.WARN, "pump 1"), (Level.ERROR, "pump 2")]


def test_of_our_own_diagnostics_in_a_bag_each_event_is_shown_by_its_kind_and_the_summary_is_not_shown_again(tmp_path):
    stale, shift = Event(1.0, Level.WARN, "input.stale", "shaft_speed", "late"), Event(1.0, Level.ERROR, "bearing.slip", "cage slip", "high")
    with McapFile(tmp_path / "run.mcap") as recording:
        recording.write("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", START, report(START, [stale, shift], {}, "bearing_node"))
        recording.write("/valve", FLOAT, START + SECOND, {"data": 1.0})
    found = read_bag_series(tmp_path / "run.mcap").events
    assert {(event.level, event.kind, event.text) for event in found} == {(event.level, event.kind, event.text) for event in (stale, shift)}
    assert len(found) == 2


def test_what_cannot_be_shown_at_all_is_told_with_exit_code_2(tmp_path):
    (tmp_path / "noise.mcap").write_bytes(b"no recording")
    for path, reason in ((tmp_path / "noise.mcap", "not an MCAP file"), (tmp_path / "absent.mcap", "no such file")):
        result = run(path, "-o", tmp_path / "run.rrd")
        assert result.exit_code == 2 and reason in result.output and "Traceback" not in result.output
    write_log(tmp_path / "log.mcap", [(0.0, 1.0), (1.0, 1.0)], [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])
    with pytest.raises(RecordingError, match="no topic /torque for the load; it has /radial_load, /shaft_speed"):
        read_bag_series(tmp_path / "log.mcap", {"load": Line("/torque")})


def test_a_measured_cage_in_a_recording_of_ours_shows_its_residual(tmp_path):
    block = synthetic_block(SCENE, 0.005 * np.arange(1, 61))
    with McapSink(tmp_path / "run.mcap", SCENE, START) as sink:
        for k in range(60):
            sink.write(block[k : k + 1])
            if k % 2:
                sink.write(Measurement(float(block["time"][k]), float(block["ideal_cage_speed"][k] * 0.9), 0.1 - float(block["cage_slip"][k])))
    assert run(tmp_path / "run.mcap", "-o", tmp_path / "run.rrd", "--no-open").exit_code == 0
    times, residuals = column(tmp_path / "run.rrd", "/slip/residual")
    np.testing.assert_allclose(times, block["time"][1::2], atol=1e-6)
    np.testing.assert_allclose(residuals, 10.0 - 100 * block["cage_slip"][1::2], atol=1e-4)
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/slip/measured")[1], 10.0, rtol=1e-5)
    np.testing.assert_allclose(
        column(tmp_path / "run.rrd", "/speed/cage_measured")[1], 0.9 * block["ideal_cage_speed"][1::2] * 30 / math.pi, rtol=1e-6
    )


def test_a_measured_clearance_in_a_recording_of_ours_is_shown_in_micrometres_at_its_own_times(tmp_path):
    block = synthetic_block(SCENE, 0.005 * np.arange(1, 61))
    with McapSink(tmp_path / "run.mcap", SCENE, START) as sink:
        for k in range(60):
            sink.write(block[k : k + 1])
            if k % 10 == 3:
                sink.write(MeasuredClearance(float(block["time"][k]) - 0.001, 1e-6 * (20 - k), 1e-6 if k % 20 == 3 else math.nan))
    found = [item for item in Recording(tmp_path / "run.mcap").with_measurements() if isinstance(item, MeasuredClearance)]
    assert [each.clearance for each in found] == pytest.approx([1e-6 * (20 - k) for k in range(3, 60, 10)])
    assert [math.isnan(each.standard_error) for each in found] == [False, True] * 3
    assert run(tmp_path / "run.mcap", "-o", tmp_path / "run.rrd", "--no-open").exit_code == 0
    times, clearances = column(tmp_path / "run.rrd", "/clearance/measured")
    np.testing.assert_allclose(times, block["time"][3::10] - 0.001, atol=1e-6)
    np.testing.assert_allclose(clearances, 20.0 - np.arange(3, 60, 10), rtol=1e-5)


def test_a_measured_clearance_of_another_source_is_known_by_its_joint_or_its_field(tmp_path):
    probe = topics.MEASUREMENTS[topics.MEASURED_CLEARANCE]
    with McapFile(tmp_path / "probe.mcap") as log, McapFile(tmp_path / "log.mcap") as other:
        for k in range(3):
            log.write("/probe", probe.ros_type, START + k * SECOND, probe.message(START, (2e-5 + 1e-6 * k, 1e-6)))
            other.write("/lift", "std_msgs/msg/Float64", START + k * SECOND, {"data": 30.0 - k})
    by_joint = {key: values.tolist() for key, (_, values) in read_bag_series(tmp_path / "probe.mcap").series.items()}
    assert by_joint["clearance", "/probe running_clearance", "µm"] == pytest.approx([20.0, 21.0, 22.0])
    given = dict.fromkeys(inspect.signature(view._lines).parameters) | {"clearance": "/lift.data", "clearance_unit": "um"}
    named, constants = view._lines(**given)
    series = read_bag_series(tmp_path / "log.mcap", named, constants).series
    assert series["clearance", "/lift.data", "µm"][1].tolist() == pytest.approx([30.0, 29.0, 28.0])
    assert run(tmp_path / "log.mcap", "-o", tmp_path / "a.rrd", "--no-open", "--clearance", "/lift.data", "--clearance-unit", "um").exit_code == 0
    assert column(tmp_path / "a.rrd", "/clearance/measured")[1].tolist() == pytest.approx([30.0, 29.0, 28.0])


@pytest.mark.long
def test_a_cage_measured_while_the_shaft_speeds_up_is_compared_with_the_ideal_speed_of_its_own_moment(tmp_path):
    """A live run writes a measurement after the block of samples that it is compared with; readers and views have blocks of their own."""
    block = synthetic_block(SCENE, 0.002 * np.arange(1, 2501))
    with McapSink(tmp_path / "run.mcap", SCENE, START) as sink:
        for k in range(0, 2500, 150):
            sink.write(block[k : k + 150])
            sink.write(Measurement(float(block["time"][k + 50]), float(0.9 * block["ideal_cage_speed"][k + 50]), math.nan))
    assert run(tmp_path / "run.mcap", "-o", tmp_path / "run.rrd", "--no-open").exit_code == 0
    times, slips = column(tmp_path / "run.rrd", "/slip/measured")
    np.testing.assert_allclose(times, block["time"][50::150], atol=1e-6)
    np.testing.assert_allclose(slips, 10.0, atol=1e-3)


def test_measurements_that_a_live_view_gets_after_their_block_are_compared_with_it_all_the_same(tmp_path):
    block = synthetic_block(SCENE, 0.002 * np.arange(1, 401))
    with RerunFile(SCENE, tmp_path / "run.rrd") as sink:
        for k in range(0, 400, 100):
            sink.write(block[k : k + 100])
            sink.write(Measurement(float(block["time"][k + 50]), float(0.9 * block["ideal_cage_speed"][k + 50]), 0.0))
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/slip/measured")[1], 10.0, atol=1e-3)


def test_a_picture_of_a_bag_needs_no_bearing(bag, tmp_path):
    result = run(bag, "-o", tmp_path / "run.rrd", "--screenshot", tmp_path / "a.png", "--size", "1000x700")
    if HOW_TO_GET_VULKAN in result.output:
        pytest.skip(f"needs a Vulkan driver: {HOW_TO_GET_VULKAN}")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.fixture
def of_the_node(tmp_path):
    """A bag of some topics of a node, as ros2 bag records it: without our metadata.  Loads rise from roller to roller."""
    block = synthetic_block(SCENE, 0.02 * np.arange(30))
    block["inner_load"] = 100.0 * np.arange(18)
    block["roller_angle"] = np.radians(20.0) * np.arange(18)
    table = outputs(SCENE)
    with McapFile(tmp_path / "node.mcap") as bag:
        for sample in block:
            now = START + round(float(sample["time"]) * SECOND)
            for name in ("rollers", "bearing_state", "characteristic_frequencies"):
                bag.write(f"/{name}", table[name].ros_type, now, table[name].message(now, sample))
    return tmp_path / "node.mcap", block


def test_a_cloud_of_rollers_is_drawn_in_space_with_a_colour_for_its_load_and_named_numbers_have_their_unit(of_the_node, tmp_path):
    path, block = of_the_node
    found = read_bag_series(path)
    assert found.clouds["/rollers"].coloured_by == "inner_load" and len(found.clouds["/rollers"].clouds) == 30
    units = {line: unit for _, line, unit in found.series}
    assert (
        units["/bearing_state rating_life"] == "h" and units["/bearing_state cage_slip"] == "-" and units["/characteristic_frequencies cage"] == "Hz"
    )
    np.testing.assert_allclose(found.series["", "/bearing_state damage", "-"][1], block["damage"])
    result = run(path, "-o", tmp_path / "run.rrd", "--no-open")
    assert result.exit_code == 0 and "/rollers: nothing" not in result.output, result.output
    chunks = [chunk.to_record_batch() for chunk in RrdReader(str(tmp_path / "run.rrd")).stream() if chunk.entity_path == "/bag/rollers"]
    drawn = next(chunk for chunk in chunks if "Points3D:positions" in chunk.schema.names)
    positions = np.array(drawn.column("Points3D:positions")[4].as_py())
    expected = block["roller_radius"][4, :, None] * np.stack(
        (np.zeros(18), np.cos(block["roller_angle"][4]), np.sin(block["roller_angle"][4])), axis=1
    )
    np.testing.assert_allclose(positions, expected, atol=1e-7)
    coloured = drawn.column("Points3D:colors")[4].as_py()
    assert len(coloured) == 18 and len(set(coloured)) == 18


def test_many_clouds_are_thinned_out_evenly_and_one_that_is_none_is_named(of_the_node, tmp_path):
    course, table = CloudCourse(), outputs(SCENE)
    store = typestore()
    cloud = store.deserialize_cdr(
        message_type(table["rollers"].ros_type).serialize(table["rollers"].message(0, of_the_node[1][0])), table["rollers"].ros_type
    )
    for k in range(5000):
        course.add(cloud, k)
    kept = np.array([one.log_ns for one in course.clouds])
    assert len(kept) < 2000 and set(np.diff(kept)) == {4}
    cloud.fields = cloud.fields[3:]
    with pytest.raises(ValueError, match="without the fields x, y and z; it has inner_load"):
        CloudCourse().add(cloud, 0)
    cloud.data = cloud.data[:40]
    with pytest.raises(ValueError, match="with 40 bytes of data"):
        CloudCourse().add(cloud, 0)
