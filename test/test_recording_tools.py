# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings by the tools of others and by ours: doctor, info, recover, compare, tables."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest
from click.testing import CliRunner
from mcap.reader import make_reader
from recordings import flipped, spoiled, steady_log, truncated, without_checksums
from rosbags.typesys import Stores, get_typestore
from synthetic_run import synthetic_block

from bearing_sim.cli.main import main
from bearing_sim.messages.events import Event, Level, ReceivedInputs
from bearing_sim.messages.topics import outputs, recorded
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import METADATA, McapFile, McapSink
from bearing_sim.scene.loader import load_scene, scene_from_yaml
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1", ["level=spatial"])
START = 1_700_000_000_000_000_000
RUN = synthetic_block(SCENE, 0.01 * np.arange(1, 601))
RUN["level"] = 3
NOISE = np.random.default_rng(3)
for _name in ("inner_load", "outer_load", "pocket_force", "ring_tilt_y", "shaft_power"):
    RUN[_name] += 1e-3 * NOISE.normal(size=RUN[_name].shape)


def record(path, block=RUN):
    with McapSink(path, SCENE, START) as sink:
        for start in range(0, len(block), 20):
            sink.write(ReceivedInputs(float(block["time"][start]), Inputs(4000.0, 800.0, -50.0, 393.15)))
            sink.write(block[start : start + 20])
        sink.write(Event(0.2, Level.WARN, "slip.high", "slip", "is 6 %"))
    return path


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return record(tmp_path_factory.mktemp("recorded") / "run.mcap")


def invoke(*arguments, code=0):
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == code, done.output + repr(done.exception)
    return done.output


def blocks(path):
    return np.concatenate([item for item in Recording(path) if isinstance(item, np.ndarray)])


def test_every_observable_comes_back_as_it_was(recording):
    read, kept = blocks(recording), {name for topic in recorded(SCENE).values() for names in topic.observables.values() for name in names}
    for observable in OBSERVABLES:
        if observable.name == "raceway_deflection":  # of a rigid ring: no topic, and known
            assert (read[observable.name] == 0.0).all() and (RUN[observable.name] == 0.0).all()
            continue
        if observable.name not in (*kept, "time"):
            assert np.isnan(read[observable.name]).all() and "temperature" in observable.name or "heat_to" in observable.name
            continue
        np.testing.assert_allclose(read[observable.name], RUN[observable.name], rtol=1e-15, atol=1e-9 if observable.name == "time" else 0.0)


@pytest.mark.long
def test_the_doctor_finds_no_fault(recording, tmp_path):
    """Neither in a recording nor in one that was recovered."""
    doctor = shutil.which("pymcap-cli", path=f"{Path(sys.executable).parent}{os.pathsep}{sysconfig.get_path('scripts')}")
    if doctor is None:
        pytest.skip("pymcap-cli is not installed")
    recover(truncated(recording, tmp_path / "run.mcap.active", recording.stat().st_size // 2), tmp_path / "recovered.mcap")
    plain = dict(os.environ, NO_COLOR="1", TERM="dumb", COLUMNS="400")
    for path in (recording, tmp_path / "recovered.mcap"):
        done = subprocess.run([doctor, "doctor", str(path)], capture_output=True, text=True, timeout=120, env=plain, check=False)
        assert done.returncode == 0 and "passed MCAP doctor checks" in done.stdout + done.stderr, done.stdout + done.stderr


def test_a_recovered_file_holds_the_same_messages(recording, tmp_path):
    broken = truncated(recording, tmp_path / "run.mcap.active", recording.stat().st_size * 2 // 3)
    found = recover(broken, tmp_path / "good.mcap")
    assert not found.is_finished and found.ends and found.damaged == 0
    good = contents(tmp_path / "good.mcap")
    assert good.is_sound and good.messages == found.messages and {"bearing_sim", "rosbag2"} <= set(good.metadata)
    read = blocks(tmp_path / "good.mcap")
    assert 200 < len(read) < len(RUN)
    np.testing.assert_array_equal(read["inner_load"], RUN["inner_load"][: len(read)])
    with open(tmp_path / "good.mcap", "rb") as stream:
        assert make_reader(stream, validate_crcs=True).get_summary().statistics.message_count == found.messages.total()


def test_what_comes_after_a_damaged_chunk_is_recovered_too(recording, tmp_path):
    spoiled(recording, tmp_path / "broken.mcap", chunk=3)
    found = recover(tmp_path / "broken.mcap", tmp_path / "good.mcap")
    whole = contents(recording)
    lost = whole.messages.total() - found.messages.total()
    with open(recording, "rb") as stream:
        chunks = len(make_reader(stream).get_summary().chunk_indexes)
    assert found.damaged == 1 and found.is_finished and not found.is_sound
    assert 0 < lost <= 1.2 * whole.messages.total() / chunks
    assert blocks(tmp_path / "good.mcap")["time"][-1] == pytest.approx(RUN["time"][-1])


def test_messages_whose_channel_was_told_in_a_damaged_chunk_are_counted_as_lost(recording, tmp_path):
    """In files of other programs; a recording has them outside of chunks, too."""
    without_checksums(recording, tmp_path / "foreign.mcap", chunk_size=64 * 1024)
    spoiled(tmp_path / "foreign.mcap", tmp_path / "broken.mcap", chunk=0)
    whole, found = contents(recording), contents(tmp_path / "broken.mcap")
    readable = sum(isinstance(record, Message) for record in McapReader(tmp_path / "broken.mcap"))
    orphans = found.damaged - 1
    assert orphans > 0 and readable == found.messages.total() + orphans < whole.messages.total()


@pytest.mark.parametrize("share", [0.0, 0.02, 0.3, 0.77, 0.999])
def test_a_file_cut_anywhere_recovers_to_a_beginning_or_says_that_nothing_is_in_it(recording, tmp_path, share):
    broken = truncated(recording, tmp_path / "broken.mcap", int(share * recording.stat().st_size))
    try:
        recover(broken, tmp_path / "good.mcap")
    except RecordingError as fault:
        assert share < 0.1 and str(broken) in str(fault)
        assert not (tmp_path / "good.mcap").exists() and not (tmp_path / "good.mcap.active").exists()
        return
    original = [(r.log_time, r.data) for r in McapReader(recording) if hasattr(r, "log_time")]
    kept = [(r.log_time, r.data) for r in McapReader(tmp_path / "good.mcap") if hasattr(r, "log_time")]
    assert kept == original[: len(kept)]


def test_recover_replaces_nothing(recording, tmp_path):
    (tmp_path / "good.mcap").write_text("precious")
    assert "exists" in invoke("recover", recording, "-o", tmp_path / "good.mcap", code=2)
    assert (tmp_path / "good.mcap").read_text() == "precious"
    assert "not an MCAP file" in invoke("recover", tmp_path / "good.mcap", "-o", tmp_path / "other.mcap", code=2)


def test_recover_counts_what_was_saved(recording, tmp_path):
    broken = truncated(recording, tmp_path / "run.mcap.active", recording.stat().st_size // 2)
    told = json.loads(invoke("recover", broken, "-o", tmp_path / "good.mcap", "--json"))
    assert told["messages"] == sum(told["messages_by_topic"].values()) == contents(tmp_path / "good.mcap").messages.total()
    assert not told["was_finished"] and told["ends"]


def test_info_says_what_is_in_a_recording_and_that_it_is_whole(recording):
    told = json.loads(invoke("info", recording, "--json"))
    [file] = told["files"]
    assert told["sound"] and file["messages"] == (len(recorded(SCENE)) - 3) * len(RUN) + 3 * 301 + 3 * 30 + 1, "three topics at 50 Hz"
    assert file["topics"]["/cage_slip"] == {"type": "std_msgs/msg/Float64", "messages": len(RUN)}
    assert file["seconds"] == pytest.approx(RUN["time"][-1] - RUN["time"][0])
    assert told["level"] == "spatial" and told["versions"]["numpy"] == np.__version__
    assert scene_from_yaml(invoke("info", recording, "--scene")) == SCENE
    text = invoke("info", recording)
    assert "complete, all checksums correct" in text and "deng2017_table1" in text and "/roller_places" in text


def test_messages_out_of_order_are_counted_each_by_its_own_topic(tmp_path):
    with McapFile(tmp_path / "log.mcap") as file:
        for topic, times in (("/a", (11, 13, 12, 14)), ("/b", (10, 15, 15))):
            for time_ns in times:
                file.write(topic, "std_msgs/msg/Float64", time_ns, {"data": 0.0})
    assert contents(tmp_path / "log.mcap").out_of_order == 1


def test_info_says_what_is_wrong_with_a_file(recording, tmp_path):
    broken = truncated(recording, tmp_path / "run.mcap.active", recording.stat().st_size // 2)
    assert "INCOMPLETE" in invoke("info", broken, code=1)
    assert "not a recording of a bearing-sim run" in invoke("info", steady_log(tmp_path / "log.mcap"))
    (tmp_path / "spoilt.mcap").write_bytes(recording.read_bytes()[:-8] + b"nonsense")
    assert not contents(tmp_path / "spoilt.mcap").is_finished and "not the end" in invoke("info", tmp_path / "spoilt.mcap", code=1)
    (tmp_path / "text.mcap").write_text("hello")
    assert "not an MCAP file" in invoke("info", tmp_path / "text.mcap", code=2)


def test_a_recording_agrees_with_itself(recording):
    told = json.loads(invoke("compare", recording, recording, "--json"))
    assert told["agree"] and {topic["differing"] for topic in told["topics"]} == {0}
    assert told["not_compared"] == ["/diagnostics"] and len(told["topics"]) == len(recorded(SCENE)) + 3


def test_compare_finds_the_topic_the_number_the_size_and_the_moment(recording, tmp_path):
    other = RUN.copy()
    roller = int(other["inner_load"][249].argmax())
    other["inner_load"][249, roller] += 0.125  # of a sample that is recorded as a cloud, too
    record(tmp_path / "other.mcap", other)
    told = json.loads(invoke("compare", recording, tmp_path / "other.mcap", "--json", code=1))
    differing = [topic for topic in told["topics"] if topic["differing"]]
    assert [topic["topic"] for topic in differing] == ["/roller_loads", "/rollers"]
    loads, cloud = differing
    assert cloud["largest"] == pytest.approx(0.125, abs=1e-4) and cloud["largest_in"] == f"inner_load[{roller}]" and cloud["differing"] == 1
    assert loads["largest"] == pytest.approx(0.125) and loads["largest_in"] == f"inner_load[{roller}]" and loads["differing"] == 1
    assert loads["largest_at_ns"] == START + 2_500_000_000
    assert loads["largest_relative"] == pytest.approx(0.125 / np.abs(other["inner_load"]).max(), rel=1e-6)
    assert "DIFFERS" in invoke("compare", recording, tmp_path / "other.mcap", code=1)
    assert "agree" in invoke("compare", recording, tmp_path / "other.mcap", "--tolerance", "roller_loads=0.1", "--tolerance", "rollers=0.1")


def test_compare_does_not_overlook_missing_messages_nor_not_a_number(recording, tmp_path):
    record(tmp_path / "shorter.mcap", RUN[:-1])
    told = json.loads(invoke("compare", recording, tmp_path / "shorter.mcap", "--json", "--tolerance", "1e9", code=1))
    every = {name for name, topic in outputs(SCENE).items() if not topic.repeats}
    assert {topic["only_in_first"] for topic in told["topics"] if topic["topic"][1:] in every} == {1}
    other = RUN.copy()
    other["cage_slip"][99] = np.nan
    record(tmp_path / "nan.mcap", other)
    told = json.loads(invoke("compare", recording, tmp_path / "nan.mcap", "--json", "--tolerance", "1e9", code=1))
    assert [topic["topic"] for topic in told["topics"] if not topic["agrees"]] == ["/bearing_state", "/cage_slip"]


def test_a_recording_of_an_earlier_version_agrees_although_it_lacks_what_repeats_and_has_torques_that_are_not_known(recording, tmp_path):
    old = as_of_earlier_version(recording, tmp_path / "old.mcap")
    for pair in ((recording, old), (old, recording)):
        told = json.loads(invoke("compare", *pair, "--json"))
        assert told["agree"] and told["not_compared"] == ["/bearing_state", "/characteristic_frequencies", "/diagnostics", "/rollers"]
        assert "/bearing_joints" in [topic["topic"] for topic in told["topics"]]
    assert blocks(old).tobytes() == blocks(recording).tobytes()


def as_of_earlier_version(source, path):
    """Copy a recording without what this version adds: topics, frames, and arrays of joint states that are empty."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with open(source, "rb") as stream, McapFile(path, {METADATA: Recording(source).metadata}) as copy:
        for schema, channel, message in make_reader(stream).iter_messages():
            data = message.data
            if schema.name == "sensor_msgs/msg/JointState":
                joints = store.deserialize_cdr(data, schema.name)
                unknown = np.full(len(joints.name), np.nan)
                joints.header.frame_id, joints.effort = "", unknown
                joints.position = joints.position if len(joints.position) else unknown
                data = bytes(store.serialize_cdr(joints, schema.name))
            if channel.topic not in ("/bearing_state", "/characteristic_frequencies", "/rollers"):
                copy.write_cdr(channel.topic, schema.name, message.log_time, data)
    return path


def test_compare_refuses_what_it_cannot_use(recording, tmp_path):
    assert "no such" in invoke("compare", recording, tmp_path / "absent.mcap", code=2)
    assert "expected a number" in invoke("compare", recording, recording, "--tolerance", "little", code=2)
    assert "unknown topic" in invoke("compare", recording, recording, "--tolerance", "nothing=1", code=2)


def test_a_parquet_table_has_a_row_a_sample_and_units_in_its_schema(recording, tmp_path):
    invoke("to-parquet", recording, "-o", tmp_path / "run.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "run.parquet")
    assert table.num_rows == len(RUN)
    np.testing.assert_array_equal(table["inner_load_07"].to_numpy(), RUN["inner_load"][:, 7])
    np.testing.assert_array_equal(table["cage_slip"].to_numpy(), RUN["cage_slip"])
    per_roller = sum(observable.per_roller for observable in OBSERVABLES)
    assert table.num_columns == len(OBSERVABLES) - per_roller + 18 * per_roller + 1 + 4, "and a stamp and four characteristic frequencies"
    np.testing.assert_allclose(table["ball_pass_outer_frequency"], 18 * np.abs(RUN["cage_speed"]) / (2 * np.pi), rtol=1e-12)
    field = table.schema.field("shaft_speed")
    assert field.metadata[b"unit"] == b"rad/s" and field.metadata[b"meaning"] == b"shaft speed"
    assert scene_from_yaml(table.schema.metadata[b"scene"].decode()) == SCENE
    assert table["stamp"][0].value == START + 10_000_000


def test_a_csv_table_has_units_in_its_header_and_exact_numbers(recording, tmp_path):
    told = json.loads(invoke("to-csv", recording, "-o", tmp_path / "run.csv", "--no-rollers", "--every", 10, "--json"))
    table = pyarrow.csv.read_csv(tmp_path / "run.csv")
    assert table.num_rows == told["rows"] == len(RUN) // 10
    assert table.column_names[:3] == ["time [s]", "stamp", "shaft_angle [rad]"] and "cage_slip" in table.column_names
    np.testing.assert_array_equal(table["shaft_speed [rad/s]"].to_numpy(), RUN["shaft_speed"][::10])
    invoke("to-csv", recording, "-o", tmp_path / "few.csv", "--column", "cage_slip", "--column", "pocket_force", "--from", 1.0, "--to", 2.0)
    few = pyarrow.csv.read_csv(tmp_path / "few.csv")
    assert few.column_names == ["time [s]", "stamp", "cage_slip", *(f"pocket_force_{k:02} [N]" for k in range(18))] and few.num_rows == 101


def test_tables_refuse_what_is_not_there(recording, tmp_path):
    assert "did you mean 'cage_slip'" in invoke("to-csv", recording, "-o", tmp_path / "a.csv", "--column", "cage_slp", code=2)
    assert "no sample between" in invoke("to-csv", recording, "-o", tmp_path / "a.csv", "--from", 100, code=2)
    assert "no metadata record" in invoke("to-parquet", steady_log(tmp_path / "log.mcap"), "-o", tmp_path / "a.parquet", code=2)


def test_two_runs_that_began_at_different_moments_are_compared_by_run_time(recording, tmp_path):
    with McapSink(tmp_path / "later.mcap", SCENE, START + 12_345_678_901) as sink:
        for start in range(0, len(RUN), 20):
            sink.write(ReceivedInputs(float(RUN["time"][start]), Inputs(4000.0, 800.0, -50.0, 393.15)))
            sink.write(RUN[start : start + 20])
    for pair in ((recording, tmp_path / "later.mcap"), (tmp_path / "later.mcap", recording)):
        told = json.loads(invoke("compare", *pair, "--json"))
        assert told["agree"] and {topic["only_in_first"] + topic["only_in_second"] for topic in told["topics"]} == {0}
    told = json.loads(invoke("compare", recording, tmp_path / "later.mcap", "--clock", "--json", code=1))
    assert {topic["messages"] for topic in told["topics"]} == {0}, "no sample is at the same moment"


def test_compare_says_which_file_is_not_whole(recording, tmp_path):
    flipped(recording, tmp_path / "flipped.mcap", recording.stat().st_size // 2)
    assert "; what can be read of it is compared" in invoke("compare", recording, tmp_path / "flipped.mcap", code=1)
