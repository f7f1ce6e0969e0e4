# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Damage of a recording is seen, wherever it is, and what is not damaged is recovered."""

import random
import struct
import zlib
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import Header
from mcap.stream_reader import CRCValidationError
from recordings import flipped, truncated, without_checksums
from rosbags.highlevel import AnyReader
from synthetic_run import synthetic_block

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import InputLogError, read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.messages.events import ReceivedInputs
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.mcap_format import CHECKSUM, CHECKSUM_RECORD, MAGIC, Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import METADATA, McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1")
RUN = synthetic_block(SCENE, 0.001 * np.arange(1, 101))
START = 1_700_000_000_000_000_000


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("recorded") / "run.mcap"
    with McapSink(path, SCENE, START) as sink:
        for start in range(0, len(RUN), 10):
            sink.write(ReceivedInputs(float(RUN["time"][start]), Inputs(4000.0, 800.0, -50.0, 393.15)))
            sink.write(RUN[start : start + 10])
    return path


@pytest.fixture(scope="module")
def records(recording):
    """(opcode, first byte, byte after it) of each record of the file, by the specification alone."""
    data, at, found = recording.read_bytes(), len(MAGIC), []
    while at < len(data) - len(MAGIC):
        opcode, length = struct.unpack_from("<BQ", data, at)
        found.append((opcode, at, at + 9 + length))
        at = found[-1][2]
    return found


NO_HEADER = repr(Header("ros2", ""))


def everything(path):
    """Return all messages of a file, and all its other records, which may stand in other places between them."""
    records = list(McapReader(path))
    return [record for record in records if isinstance(record, Message)], sorted(
        repr(record) for record in records if not isinstance(record, Message)
    )


def samples(path):
    return np.concatenate([item for item in Recording(path) if isinstance(item, np.ndarray)])


def test_checksum_records_cover_the_data_section_without_a_gap(recording, records):
    data, end_of_data = recording.read_bytes(), next(begin for opcode, begin, _ in records if opcode == 0x0F)
    checks = [(begin, end) for opcode, begin, end in records if opcode == CHECKSUM]
    assert [end for _, end in checks][-1] == end_of_data and len(checks) > 5
    for (_, first), (at, _) in pairwise([(0, 0), *checks]):
        assert data[at:].startswith(struct.pack("<BQQI", CHECKSUM, 12, first, zlib.crc32(data[first:at])))
    assert struct.unpack_from("<BQI", data, end_of_data) == (0x0F, 4, zlib.crc32(data[:end_of_data]))


def test_other_readers_read_it_with_all_checksums_on(recording):
    count = contents(recording).messages.total()
    with open(recording, "rb") as stream:
        assert sum(1 for _ in NonSeekingReader(stream, validate_crcs=True).iter_messages()) == count
    with open(recording, "rb") as stream:
        assert sum(1 for _ in make_reader(stream, validate_crcs=True).iter_messages()) == count
    with AnyReader([recording]) as bag:
        assert sum(1 for _ in bag.messages()) == count


def test_the_mcap_library_sees_a_flipped_bit_of_the_metadata_too(recording, tmp_path):
    flipped(recording, tmp_path / "flipped.mcap", recording.read_bytes().index(b"load"))
    with open(tmp_path / "flipped.mcap", "rb") as stream, pytest.raises(CRCValidationError, match="DataEnd"):
        list(NonSeekingReader(stream, validate_crcs=True).iter_messages())


def test_any_flipped_bit_is_reported_in_every_kind_of_record_and_what_is_recovered_is_as_it_was(recording, records, tmp_path):
    """In the head and the middle of a record of each kind, in the magic number at the end, and in random places."""
    whole, chance, found = everything(recording), random.Random(3), set()
    one_of_each = {opcode: (begin, end) for opcode, begin, end in records}
    places = [byte for begin, end in one_of_each.values() for byte in (begin, begin + 1, (begin + end) // 2)]
    places += [recording.stat().st_size - 1, *(chance.randrange(8, recording.stat().st_size) for _ in range(5))]
    for byte in places:
        broken = flipped(recording, tmp_path / "flipped.mcap", byte, chance.randrange(8))
        report = contents(broken)
        assert not report.is_sound and (report.damage or report.ends), byte
        (tmp_path / "good.mcap").unlink(missing_ok=True)
        recover(broken, tmp_path / "good.mcap")
        messages, others = everything(tmp_path / "good.mcap")
        remaining = iter(whole[0])
        assert contents(tmp_path / "good.mcap").is_sound and all(message in remaining for message in messages), byte
        assert len(messages) >= 0.5 * len(whole[0]) and {other for other in others if "rosbag2" not in other} <= set(whole[1]) | {NO_HEADER}, byte
        found.add(next((opcode for opcode, begin, end in records if begin <= byte < end), None))
    assert {0x01, 0x06, 0x07, 0x0C, 0x0F, 0x02, CHECKSUM, None} <= found


def test_a_load_changed_in_the_scene_is_not_loaded(recording, tmp_path):
    scene = Recording(recording).metadata["scene"].encode()
    byte = recording.read_bytes().index(scene) + scene.index(b"radial_load: 800") + len(b"radial_load: ")
    broken = flipped(recording, tmp_path / "flipped.mcap", byte)  # 8 becomes 9
    assert scene.replace(b"radial_load: 8", b"radial_load: 9", 1) in broken.read_bytes()
    with pytest.raises(RecordingError, match=r"a metadata record, bytes .*bearing-sim recover"):
        Recording(broken)
    shown = CliRunner().invoke(main, ["info", str(broken)])
    assert shown.exit_code == 1 and "DAMAGED" in shown.output and "a metadata record, bytes" in " ".join(shown.output.replace("│", " ").split())
    recover(broken, tmp_path / "good.mcap")
    with pytest.raises(RecordingError, match="no metadata record 'bearing_sim'"):
        Recording(tmp_path / "good.mcap")


def test_a_bit_flipped_in_an_unfinished_file_is_found(recording, records, tmp_path):
    """Which has no checksum of the data section."""
    end = next(begin for opcode, begin, _ in records if opcode == 0x0F)
    begin, after = next((begin, end) for opcode, begin, end in records if opcode == 0x0C)
    cut = truncated(recording, tmp_path / "cut.mcap", end)
    assert contents(cut).damaged == 0 and not contents(cut).is_finished
    report = contents(flipped(cut, tmp_path / "flipped.mcap", (begin + after) // 2))
    assert report.damaged == 1 and METADATA not in report.metadata and "a metadata record" in report.damage[0]


def test_what_follows_a_record_of_wrong_length_is_found_again(recording, records, tmp_path):
    chunks = [begin for opcode, begin, _ in records if opcode == 0x06]
    data = bytearray(recording.read_bytes())
    data[chunks[2] + 1 : chunks[2] + 9] = struct.pack("<Q", 2**63)
    data[chunks[2] + 20 : chunks[2] + 24] = b"\xff" * 4  # more than a flipped bit
    (tmp_path / "broken.mcap").write_bytes(data)
    found = recover(tmp_path / "broken.mcap", tmp_path / "good.mcap")
    assert found.damaged == 1 and f"bytes {chunks[2]} to" in found.damage[0]
    read, whole = samples(tmp_path / "good.mcap"), samples(recording)
    assert len(RUN) - 30 < len(read) < len(RUN)
    assert read.tobytes() == whole[np.isin(whole["time"], read["time"])].tobytes()


def test_the_bag_metadata_of_a_recovered_file_count_what_is_in_it(recording, records, tmp_path):
    begin, end = next((begin, end) for opcode, begin, end in records if opcode == 0x06)
    data = bytearray(recording.read_bytes())
    data[begin + 60 : end - 10] = bytes(end - begin - 70)
    (tmp_path / "broken.mcap").write_bytes(data)
    recover(tmp_path / "broken.mcap", tmp_path / "good.mcap")
    good = contents(tmp_path / "good.mcap")
    assert f"message_count: {good.messages.total()}\n" in good.metadata["rosbag2"]["serialized_metadata"]


def test_a_recording_of_an_earlier_version_is_read_and_what_nothing_covers_is_said(recording, records, tmp_path):
    """Without checksum records, and without that of the data section."""
    old = tmp_path / "old.mcap"
    without_checksums(recording, old)
    assert everything(old) == everything(recording) and samples(old).tobytes() == samples(recording).tobytes()
    assert contents(old).is_sound and not contents(old).covers_all
    shown = CliRunner().invoke(main, ["info", str(old)])
    words = " ".join(shown.output.replace("│", " ").split())
    assert shown.exit_code == 0 and "no checksum of the scene and other metadata, written by an earlier version" in words
    summary = old.stat().st_size - 60
    assert "the summary" in contents(flipped(old, tmp_path / "flipped.mcap", summary)).damage[0]


def test_a_file_of_another_program_is_verified_as_far_as_its_writer_made_checksums(recording, tmp_path):
    without_checksums(recording, tmp_path / "foreign.mcap", enable_data_crcs=True)
    assert contents(tmp_path / "foreign.mcap").is_sound and contents(tmp_path / "foreign.mcap").covers_all
    byte = (tmp_path / "foreign.mcap").read_bytes().index(b"radial_load: 800")
    report = contents(flipped(tmp_path / "foreign.mcap", tmp_path / "flipped.mcap", byte))
    assert report.damage == ["the checksum of the data section"]


def test_checksum_record_is_far_from_every_other_record():
    assert all((CHECKSUM ^ opcode).bit_count() > 2 for opcode in range(1, 16)) and CHECKSUM >= 0x80, "opcodes for applications"
    assert CHECKSUM_RECORD.size == 9 + 12


def test_a_damaged_log_is_used_up_to_the_damage_which_is_said(recording, records, tmp_path):
    chunks = [(begin, end) for opcode, begin, end in records if opcode == 0x06]
    log = read_input_log(flipped(recording, tmp_path / "flipped.mcap", sum(chunks[-1]) // 2))
    used = judge(log, SCENE.accepted_inputs, Inputs(0.0, 0.0, 0.0, 350.0)).tally
    assert not used.is_whole and "flipped.mcap: ends early" in used.text and "a chunk, bytes" in used.text and "bearing-sim recover" in used.text
    with pytest.raises(InputLogError, match="no usable message on /shaft_speed, .* ends early .*a chunk, bytes"):
        read_input_log(flipped(recording, tmp_path / "flipped.mcap", sum(chunks[0]) // 2))
