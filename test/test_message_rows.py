# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings read and compared many messages at once, against message by message."""

from collections import defaultdict

import numpy as np
import pytest
from recordings import spoiled, write_log
from rosbags.typesys import Stores, get_typestore
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level, Measurement, ReceivedInputs
from bearing_sim.recording import reader as recording_reader
from bearing_sim.recording.compare import compare
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader, Rows, _RowFinder
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapFile, McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1", ["level=spatial"])
START = 1_700_000_000_000_000_000
FLOAT = "std_msgs/msg/Float64"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Return a run of 2500 samples with inputs, reports and a measured cage at moments of their own."""
    path, lot = tmp_path_factory.mktemp("rows") / "run.mcap", np.random.default_rng(7)
    block = synthetic_block(SCENE, 0.001 * np.arange(1, 2501))
    for name in block.dtype.names[1:]:
        block[name] += 1e-3 * lot.normal(size=block[name].shape)
    block["cage_slip"][5], block["rating_life"][700] = np.nan, np.inf
    with McapSink(path, SCENE, START) as sink:
        begin = 0
        for size in lot.integers(1, 60, 200):
            part = block[begin : begin + size]
            begin += size
            if not len(part):
                break
            time = float(part["time"][0])
            sink.write(ReceivedInputs(time, Inputs(4000.0 + time, 800.0, -50.0, 393.15), ("shaft_speed", "radial_load")[: 1 + size % 2]))
            sink.write(part)
            if size % 7 == 0:
                sink.write(Event(time, Level.WARN, f"slip.{size}", "", "slip is high"))
                sink.write(Measurement(time, 1800.0 + time, 0.01, 0.5))
    return path


def one_by_one(records):
    for record in records:
        if isinstance(record, Rows):
            yield from record.messages()
        elif isinstance(record, Message):
            yield record


def test_rows_are_the_messages_in_their_order(recording):
    found = list(McapReader(recording, in_rows=lambda topic: True))
    rows = sum(len(record.table) * len(record.channels) for record in found if isinstance(record, Rows))
    plain = [record for record in McapReader(recording) if isinstance(record, Message)]
    assert list(one_by_one(found)) == plain
    assert rows > 0.8 * len(plain)


def test_only_topics_that_are_wanted_come_in_rows(recording):
    seen = defaultdict(set)
    channels = {}
    for record in McapReader(recording, in_rows=lambda topic: topic == "/cage_slip" or topic == "/power"):
        if isinstance(record, Rows):
            seen["rows"] |= {channels[channel] for channel in record.channels}
        elif hasattr(record, "topic"):
            channels[record.id] = record.topic
    assert not seen["rows"]  # these two are no neighbours
    assert len(channels) > 15


def listed(path):
    return list(Recording(path).with_measurements())


def test_a_recording_read_in_rows_is_the_same_as_message_by_message(recording, monkeypatch):
    taken = []
    begin = recording_reader._Samples._begin
    monkeypatch.setattr(recording_reader._Samples, "_begin", lambda self, log_ns: (taken.append(len(log_ns)), begin(self, log_ns))[1])
    together = listed(recording)
    assert len(taken) < 1000 and sum(taken) == 2500
    monkeypatch.setattr(_RowFinder, "rows_at", lambda *_: None)
    taken.clear()
    single = listed(recording)
    assert taken == 2500 * [1]
    assert [type(item) for item in together] == [type(item) for item in single] and {Event, Measurement, np.ndarray} == set(map(type, single))
    for one, other in zip(together, single):
        if isinstance(one, np.ndarray):
            for name in one.dtype.names:
                np.testing.assert_array_equal(one[name], other[name], err_msg=name)
        else:
            assert one == other


def test_what_the_index_says_is_what_reading_finds(recording, monkeypatch):
    by_index = Recording(recording)
    monkeypatch.setattr(recording_reader, "read_index", lambda *_: None)
    by_reading = Recording(recording)
    for name in ("samples", "first_time", "last_time", "largest_load", "metadata", "scene", "unfinished"):
        assert getattr(by_index, name) == getattr(by_reading, name), name
    assert by_index.samples == 2500 and by_index.largest_load > 0.0


def test_opening_a_finished_recording_reads_none_of_its_chunks(recording, monkeypatch):
    def refuse(*_):
        raise AssertionError("a chunk was read")

    monkeypatch.setattr(McapReader, "__iter__", refuse)
    assert Recording(recording).samples == 2500


def test_reading_stops_at_a_damaged_chunk_and_says_so(recording, tmp_path):
    broken = Recording(spoiled(recording, tmp_path / "broken.mcap", chunk=40), allow_partial=True)
    read = np.concatenate([item for item in broken if isinstance(item, np.ndarray)])
    whole = np.concatenate([item for item in Recording(recording) if isinstance(item, np.ndarray)])
    assert 500 < len(read) < 2000 and "damaged" in broken.unfinished
    np.testing.assert_array_equal(read["inner_load"], whole["inner_load"][: len(read)])


def by_hand(first, second):
    """Return (matched, only first, only second, differing, largest difference) by topic, from whole messages and a dictionary."""
    store, found = get_typestore(Stores.ROS2_JAZZY), []
    for path in (first, second):
        messages, topics = defaultdict(list), {}
        for record in McapReader(path):
            if hasattr(record, "topic"):
                topics[record.id] = record.topic
            elif isinstance(record, Message):
                messages[topics[record.channel_id], record.log_time].append(store.deserialize_cdr(record.data, FLOAT).data)
        found.append(messages)
    told = defaultdict(lambda: [0, 0, 0, 0, 0.0])
    for key in found[0].keys() | found[1].keys():
        a, b = found[0].get(key, []), found[1].get(key, [])
        common = min(len(a), len(b))
        row = told[key[0]]
        gaps = [abs(x - y) for x, y in zip(a, b)]
        row[0] += common
        row[1] += len(a) - common
        row[2] += len(b) - common
        row[3] += sum(gap > 0 for gap in gaps)
        row[4] = max([row[4], *gaps])
    return dict(told)


@pytest.mark.parametrize("seed", range(6))
def test_comparing_many_at_once_finds_what_a_dictionary_of_messages_finds(tmp_path, seed):
    """Some messages are missing in one of two files, come late, or twice at one time."""
    lot = np.random.default_rng(seed)
    course = [(f"/{topic}", START + 1000 * k, float(lot.normal())) for k in range(3000) for topic in "abc"[: 1 + lot.integers(3)]]
    for name in ("first.mcap", "second.mcap"):
        kept = [row for row in course if lot.uniform() > (0.01 if seed % 2 else 0.4)]
        for place in lot.integers(0, len(kept) - 40, 30):
            kept.insert(place + lot.integers(40), kept.pop(place))
        for place in lot.integers(0, len(kept), 20):
            kept.insert(place, kept[place])
        with McapFile(tmp_path / name) as file:
            for topic, log_ns, value in kept:
                file.write(topic, FLOAT, log_ns, {"data": value + (1e-3 * lot.normal() if lot.uniform() < 0.05 else 0.0)})
    differences, _ = compare(tmp_path / "first.mcap", tmp_path / "second.mcap")
    told = {d.topic: [d.matched, d.only_first, d.only_second, d.differing, float(d.largest.max())] for d in differences}
    assert told == by_hand(tmp_path / "first.mcap", tmp_path / "second.mcap")


def test_messages_of_other_lengths_with_the_same_numbers_agree(tmp_path):
    """A joint's name may be longer, a frame have a name: the numbers are what is compared."""
    speeds = [(0.1 * k, 4000.0 + k) for k in range(50)]
    write_log(tmp_path / "one.mcap", speeds, [(time, 800.0, 0.0) for time, _ in speeds])
    topics, store, wrench = {}, get_typestore(Stores.ROS2_JAZZY), "geometry_msgs/msg/WrenchStamped"
    with McapFile(tmp_path / "other.mcap") as file:
        for record in McapReader(tmp_path / "one.mcap"):
            if hasattr(record, "topic"):
                topics[record.id] = record.topic
            elif isinstance(record, Message) and topics[record.channel_id] == "/radial_load":
                message = store.deserialize_cdr(record.data, wrench)
                message.header.frame_id = "a_bearing"
                file.write_cdr("/radial_load", wrench, record.log_time, bytes(store.serialize_cdr(message, wrench)))
    differences, _ = compare(tmp_path / "one.mcap", tmp_path / "other.mcap")
    [loads] = [difference for difference in differences if difference.topic == "/radial_load"]
    assert loads.agrees and loads.matched == 50 and loads.differing == 0


def test_recordings_of_other_times_have_nothing_in_common(tmp_path):
    for name, shift in (("first.mcap", 0), ("second.mcap", 300), ("later.mcap", 10**9)):
        with McapFile(tmp_path / name) as file:
            for k in range(500):
                file.write("/a", FLOAT, START + shift + 1000 * k, {"data": float(k)})
    for other in ("second.mcap", "later.mcap"):
        [difference], _ = compare(tmp_path / "first.mcap", tmp_path / other)
        assert (difference.matched, difference.only_first, difference.only_second) == (0, 500, 500) and not difference.agrees
