# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings and bags from strangers: the quick cases of test/benchmarks/hostile_files.py, each a message and an exit code; and what ours tell."""

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from recordings import JOINTS, SECOND, WRENCH, joint_state, wrench

sys.path.insert(0, str(Path(__file__).with_name("benchmarks")))

import hostile_recordings as hostile  # noqa: E402

from bearing_sim.cli.main import main  # noqa: E402
from bearing_sim.files.limits import VARIABLE  # noqa: E402
from bearing_sim.inputs.log import InputLogError, read_input_log  # noqa: E402
from bearing_sim.messages.cdr import message_type  # noqa: E402
from bearing_sim.recording.bag_reader import BagReader, BagTopic  # noqa: E402
from bearing_sim.recording.mcap_reader import McapReader  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402

QUICK = [
    case
    for case in [*hostile.COMPRESSION, *hostile.LENGTHS, *hostile.DEFINITIONS, *hostile.NAMES, *hostile.SQLITE, *hostile.FOLDERS, *hostile.ROS1]
    if not case.accepted and not any(word in case.name for word in ("MB", "GB", "bzip2", "lz4 that unpacks", "000 ", "empty messages", "replay"))
]


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.name)
def test_a_hostile_recording_is_refused_in_a_few_plain_words(case, tmp_path, monkeypatch):
    case.make(tmp_path)
    monkeypatch.chdir(tmp_path)
    result = run(*case.command)
    assert result.exit_code in (1, 2) and isinstance(result.exception, SystemExit), result.output
    assert "Error: " in result.output and len(result.output) < 5000
    assert all(letter.isprintable() or letter in "\n\t" for letter in result.output)


def test_a_chunk_that_unpacks_to_8_gb_is_left_out_before_anything_of_it_is_made(tmp_path, monkeypatch):
    size = 8_200_000_000 // 131_072 * 131_072
    (tmp_path / "log.mcap").write_bytes(hostile.mcap(hostile.sound(3), hostile.chunk(hostile.zeros_by_zstd(size, True), "zstd", size)))
    reader = McapReader(tmp_path / "log.mcap")
    monkeypatch.setattr(reader, "_decompress", lambda *arguments, **options: pytest.fail("it was unpacked"))
    assert len([record for record in reader if type(record).__name__ == "Message"]) == 6
    assert reader.damaged == 1 and "recording_record=NUMBER" in reader.damage[0]


def test_a_limit_on_recordings_is_raised_by_its_name(tmp_path, monkeypatch):
    path = tmp_path / "log.mcap"
    path.write_bytes(hostile.mcap(hostile.sound(30)))
    monkeypatch.setenv(VARIABLE, "log_messages=20")
    with pytest.raises(InputLogError, match="/shaft_speed has more messages than the limit of 20 .* BEARING_SIM_LIMITS=log_messages=NUMBER"):
        read_input_log(path)
    monkeypatch.setenv(VARIABLE, "log_messages=30")
    assert len(read_input_log(path).series["shaft_speed"].stamps) == 30


def test_a_definition_is_parsed_once_for_all_messages_also_if_it_cannot_be_used(tmp_path, monkeypatch):
    from bearing_sim.recording import bag_reader

    calls, decoder = [], bag_reader.decoder
    monkeypatch.setattr(bag_reader, "decoder", lambda *arguments: calls.append(arguments) or decoder(*arguments))
    path = tmp_path / "log.mcap"
    path.write_bytes(hostile.typed("9 9\n", count=50))
    for found in BagReader(path):
        if not isinstance(found, BagTopic):
            with pytest.raises(ValueError, match="cannot parse '9 9'"):
                found[0].decode(found[2])
    assert len(calls) == 1


def test_metadata_of_a_bag_cannot_name_a_file_outside_of_its_folder(tmp_path):
    (tmp_path / "secret.mcap").write_bytes(hostile.mcap(hostile.sound(3)))
    hostile._folder(hostile._listing("../secret.mcap"))(tmp_path)
    result = run("info", tmp_path / "bag")
    assert result.exit_code == 2 and "metadata.yaml names secret.mcap, which is not there" in result.output
    (tmp_path / "bag" / "secret.mcap").write_bytes(hostile.mcap(hostile.sound(3)))
    assert len([found for found in BagReader(tmp_path / "bag") if not isinstance(found, BagTopic)]) == 6


def test_a_ros_1_bag_is_read_without_its_index_and_up_to_where_it_is_cut_short(tmp_path):
    from test_cdr import STORE

    records = []
    for number, topic, kind in ((0, b"/shaft_speed", JOINTS), (1, b"/radial_load", WRENCH)):
        text, _ = STORE.generate_msgdef(kind, ros_version=1)
        fields, data = hostile._connection(text.encode(), topic)
        data = data.replace(
            b"\x15\0\0\0type=std_msgs/Float64", (5 + len(short := kind.replace("/msg", ""))).to_bytes(4, "little") + b"type=" + short.encode()
        )
        records.append(({**fields, "conn": number.to_bytes(4, "little")}, data))
    for k in range(5):
        stamp = hostile.T0 + k * SECOND
        for number, kind, fields in ((0, JOINTS, joint_state(stamp, 100.0 + k)), (1, WRENCH, wrench(stamp, 800.0))):
            message = STORE.deserialize_cdr(message_type(kind).serialize(fields), kind)
            if hasattr(message.header, "seq"):
                message.header.seq = k
            data = bytes(STORE.serialize_ros1(message, kind))
            time = (stamp // SECOND).to_bytes(4, "little") + bytes(4)
            records.append(({"op": b"\2", "conn": number.to_bytes(4, "little"), "time": time}, bytes(4) * text.count("uint32 seq") + data))
    whole = hostile.ros1(*records)
    (tmp_path / "log.bag").write_bytes(whole)
    log = read_input_log(tmp_path / "log.bag")
    assert log.series["shaft_speed"].values == [(100.0 + k,) for k in range(5)] and not log.unfinished
    (tmp_path / "log.bag").write_bytes(whole[:-30])
    log = read_input_log(tmp_path / "log.bag")
    assert len(log.series["radial_load"].values) == 4 and "ends early (it ends within a record)" in log.unfinished


def test_a_recording_carries_the_command_but_no_folder_of_the_machine(tmp_path):
    scene = tmp_path / "motor.yaml"
    assert run("new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm", "--load", "5kN", "-o", scene).exit_code == 0
    out = tmp_path / "run.mcap"
    result = run("run", scene, "--set", "level=steady", "--duration", "0.02", f"--out={out}")
    assert result.exit_code == 0, result.output
    assert Recording(out).command == "bearing-sim run motor.yaml --set level=steady --duration 0.02 --out=run.mcap"
    assert str(tmp_path).encode() not in b"".join(repr(record).encode() for record in McapReader(out))
