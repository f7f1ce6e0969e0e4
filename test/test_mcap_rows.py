# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Blocks written as rows: the same file as message by message."""

import struct

import numpy as np
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex
from mcap.stream_reader import StreamReader

from bearing_sim.messages.cdr import message_type
from bearing_sim.messages.sample_messages import FilledMessages
from bearing_sim.messages.topics import INPUTS, MEASUREMENTS, RECORDED, RESIDUAL, outputs, recorded
from bearing_sim.model.sample import OBSERVABLES, new_block
from bearing_sim.recording.mcap_reader import McapReader, Rows
from bearing_sim.recording.mcap_writer import SampleRows
from bearing_sim.recording.writer import McapFile
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

START = 1_700_000_000_000_000_000
LEVELS = ("slip", "spatial")


def random_block(samples, rollers):
    block = new_block(samples, rollers)
    noise = np.random.default_rng(7)
    for name in block.dtype.names:
        block[name] = noise.normal(size=block[name].shape)
    block["cage_slip"][:2], block["rating_life"][1:3] = np.nan, np.inf
    return block


def contents(path):
    """Every message by the file's own index, so that chunk and message indexes are put to use; and the statistics."""
    with open(path, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        found = {}
        for schema, channel, message in reader.iter_messages(log_time_order=True):
            told = (message.log_time, message.publish_time, message.sequence, message.data)
            found.setdefault((channel.topic, schema.name), []).append(told)
        return found, reader.get_summary().statistics


@pytest.mark.parametrize("level", LEVELS)
def test_rows_make_the_same_messages_as_one_by_one(tmp_path, level):
    scene = load_scene("deng2017_table1", [f"level={level}"])
    topics = tuple(recorded(scene).values())
    block = random_block(333, scene.bearing.roller.count)
    times = np.uint64(START) + np.arange(len(block), dtype=np.uint64) * np.uint64(1_000_003)
    with McapFile(tmp_path / "one_by_one.mcap") as single:
        for sample, time_ns in zip(block, times.tolist()):
            for topic in topics:
                single.write(f"/{topic.name}", topic.ros_type, time_ns, topic.message(time_ns, sample))
    with McapFile(tmp_path / "rows.mcap") as rows:
        layout = SampleRows(topics, scene.bearing.roller.count)
        for part in np.split(np.arange(len(block)), [1, 2, 40, 300]):
            rows.write_rows(layout, block[part], times[part])
    expected, wanted = contents(tmp_path / "one_by_one.mcap")
    found, statistics = contents(tmp_path / "rows.mcap")
    assert found == expected and len(found) == len(topics)
    assert statistics.chunk_count > 5
    for figure in ("message_count", "channel_message_counts", "message_start_time", "message_end_time", "schema_count", "channel_count"):
        assert getattr(statistics, figure) == getattr(wanted, figure), figure


BENDING = "mounting.housing.backing={law: rigid_bore, play: 0 um}"


def test_a_recording_holds_every_observable_of_a_sample():
    """Change one observable at a time: some message must change with it (time is in the stamps, the guide's shaft speed in the joints)."""
    scene = load_scene("deng2017_table1", ["level=spatial", "bearing.dimensions_at=cold", "heat.law=network"])
    topics = (recorded(scene) | recorded(load_scene("deng2017_table1", [BENDING]))).values()
    plain = random_block(1, scene.bearing.roller.count)
    before = [repr(topic.message(START, plain[0])) for topic in topics]
    for observable in OBSERVABLES[1:]:
        changed = plain.copy()
        changed[observable.name] += 1.0
        changed[observable.name] = np.nan_to_num(changed[observable.name], nan=0.5)
        assert [repr(topic.message(START, changed[0])) for topic in topics] != before, observable.name


def test_what_is_only_recorded_is_not_published():
    scene = load_scene("deng2017_table1")
    warm = load_scene("deng2017_table1", ["bearing.dimensions_at=cold", "heat.law=network", BENDING])
    assert set(recorded(warm)) - set(outputs(warm)) == set(RECORDED) and set(recorded(scene)) - set(outputs(scene)) < set(RECORDED)
    assert not set(RECORDED) & {*outputs(scene), *INPUTS}


def test_rows_and_single_messages_mix_in_one_file(tmp_path):
    scene = load_scene("deng2017_table1")
    layout = SampleRows(tuple(recorded(scene).values()), scene.bearing.roller.count)
    block, times = random_block(3, scene.bearing.roller.count), np.uint64(START) + np.arange(3, dtype=np.uint64)
    with McapFile(tmp_path / "run.mcap") as recording:
        for k in range(3):
            recording.write("/other", "std_msgs/msg/Float64", START + k, {"data": float(k)})
            recording.write_rows(layout, block[k : k + 1], times[k : k + 1])
    found, statistics = contents(tmp_path / "run.mcap")
    assert [len(messages) for messages in found.values()] == [3] * (len(layout.topics) + 1)
    assert statistics.message_count == 3 * (len(layout.topics) + 1)


def test_samples_with_further_topics_have_them_before_their_others_and_all_count_their_messages(tmp_path):
    """At ten samples a second each one has the topics that a thousand a second repeat now and then only; then all are read back in rows."""
    scene = load_scene("deng2017_table1")
    further, common = (tuple(topic for topic in recorded(scene).values() if topic.repeats == repeats) for repeats in (True, False))
    layout, seldom = (SampleRows(topics, scene.bearing.roller.count) for topics in (common, further))
    block, times = random_block(60, scene.bearing.roller.count), np.uint64(START) + np.arange(60, dtype=np.uint64)
    chosen = np.array([0, 1, 5, *range(20, 60)])
    with McapFile(tmp_path / "rows.mcap") as rows, McapFile(tmp_path / "single.mcap") as single:
        for part in np.split(np.arange(60), [1, 7, 30]):
            rows.write_rows(layout, block[part], times[part], seldom, np.flatnonzero(np.isin(part, chosen)))
        for k, (sample, time_ns) in enumerate(zip(block, times.tolist())):
            for topic in (*further, *common) if k in chosen else common:
                single.write(f"/{topic.name}", topic.ros_type, time_ns, topic.message(time_ns, sample))
    assert further and contents(tmp_path / "rows.mcap")[0] == contents(tmp_path / "single.mcap")[0]
    reader = McapReader(tmp_path / "rows.mcap", in_rows=lambda topic: True)
    found = [record for record in reader if isinstance(record, Rows)]
    assert sum(len(each.table) for each in found if len(each.channels) == len(further) + len(common)) >= 30


@pytest.mark.parametrize("name", [*INPUTS, *MEASUREMENTS])
def test_messages_of_inputs_filled_from_a_template_are_those_of_the_topic(name):
    topic, messages, random = (INPUTS | MEASUREMENTS)[name], FilledMessages(), np.random.default_rng(3)
    for k in range(6):
        if name in INPUTS:
            source = Inputs(*(1e3 * random.random(6)).tolist())
        else:
            source = float(random.random()) if name == RESIDUAL else (0.1, (float("nan"), 1.0, 0.02)[k % 3]) if k % 2 else (0.3,)
        frame, stamp_ns = (None, "", "rig")[k % 3], START + k * 1_234_567_891
        message = topic.message(stamp_ns, source)
        if frame is not None and "header" in message:
            message["header"]["frame_id"] = frame
        assert messages.serialized(topic, stamp_ns, source, frame) == message_type(topic.ros_type).serialize(message)


def test_the_index_of_a_chunk_says_where_its_messages_stand(tmp_path):
    """Readers that seek go by it; those that read chunk by chunk would not notice."""
    scene = load_scene("deng2017_table1")
    layout = SampleRows(tuple(recorded(scene).values()), scene.bearing.roller.count)
    block, times = random_block(40, scene.bearing.roller.count), np.uint64(START) + np.arange(40, dtype=np.uint64)
    with McapFile(tmp_path / "run.mcap") as recording:
        for part in np.split(np.arange(40), [1, 3, 20]):
            recording.write_rows(layout, block[part], times[part])
            recording.write("/other", "std_msgs/msg/Float64", START + int(part[-1]), {"data": 0.0})
    content, entries = b"", 0
    with open(tmp_path / "run.mcap", "rb") as stream:
        for record in StreamReader(stream, emit_chunks=True).records:
            if isinstance(record, Chunk):
                content = zstandard.decompress(record.data, max_output_size=record.uncompressed_size)
            elif isinstance(record, MessageIndex):
                for log_time, offset in record.records:
                    opcode, _, channel, _, logged = struct.unpack_from("<BQHIQ", content, offset)
                    assert (opcode, channel, logged) == (Opcode.MESSAGE, record.channel_id, log_time)
                    entries += 1
    assert entries == 40 * len(layout.topics) + 4
