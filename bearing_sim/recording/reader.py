# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read our own recordings back: MCAP messages to blocks of samples and events, as the sinks take them."""

import math
from collections.abc import Iterator
from functools import cache, cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
from mcap.records import Channel, Message, Metadata, Schema

from bearing_sim.bag_files import BagError, mcap_files
from bearing_sim.events import Event, Level, Measurement
from bearing_sim.mcap_index import FileIndex, read_index
from bearing_sim.mcap_stream import Salvage
from bearing_sim.message_rows import Rows
from bearing_sim.recording_samples import ROWS_PER_BLOCK, Samples
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, scene_from_yaml
from bearing_sim.topics import ARRAYS, CAGE_JOINT, DIAGNOSTICS, INPUTS, MEASURED, MEASUREMENTS, OUTPUTS, RECORDED, RESIDUAL, input_values

METADATA = "bearing_sim"
_REPEATS_WITHIN = 2.5  # [s] a lasting trouble is reported every second, and told once
_TYPES = {f"/{topic.name}": topic.ros_type for topic in (*INPUTS.values(), *RECORDED.values(), *OUTPUTS.values())} | {
    f"/{DIAGNOSTICS[0]}": DIAGNOSTICS[1]
}
_OUTPUT_TOPICS = frozenset(f"/{name}" for name in (*RECORDED, *OUTPUTS))
_RECEIVED = {f"/{name}" for name in (*INPUTS, *MEASUREMENTS)}
_LAST_OF_SAMPLE = "/roller_loads"


class RecordingError(ValueError):
    """A file that is no recording of ours; the message says what is missing."""


class Received(NamedTuple):
    """A message of an input or a measurement as it was recorded; times are [ns since the epoch]."""

    topic: str
    ros_type: str
    log_ns: int
    publish_ns: int
    data: bytes


class Recording:
    """A recording of one run; opening it reads no more of a finished one than its index.

    Parameters
    ----------
    path : what `bearing_sim.sinks.mcap_sink.McapSink` wrote, finished or not: an MCAP file or the folder of a bag.

    Attributes
    ----------
    files : the files of the recording, in order.
    metadata : what its writer said of it, by name (see `bearing_sim.sinks.mcap_sink.METADATA`).
    scene : what was simulated.
    start_ns : wall time of sample time 0 [ns since the epoch].
    samples : number of samples.
    first_time, last_time : simulated times of the first and the last sample [s].
    unfinished : why reading ends before the file's proper end, or ``""``; of a file that has its end, but is damaged, reading it tells.

    Raises
    ------
    RecordingError
        No such file, no MCAP, no scene in its metadata, or no samples.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.unfinished = ""
        try:
            self.files = mcap_files(self.path)
        except BagError as fault:
            raise RecordingError(str(fault)) from None
        parts = [self._told_by(file) for file in self.files]
        metadata = next((part.metadata[METADATA] for part in reversed(parts) if METADATA in part.metadata), None)
        self.metadata: dict[str, str] = metadata or {}
        listing = ", ".join(sorted(set().union(*(part.present for part in parts)))) or "no topics"
        if metadata is None:
            raise RecordingError(f"{self.path}: no metadata record {METADATA!r}, so this is no recording of bearing_sim; it has {listing}")
        try:
            self.scene: Scene = scene_from_yaml(metadata["scene"], origin=f"{self.path}: scene in the metadata")
            self.start_ns = int(metadata["start_ns"])
        except (KeyError, ValueError, SceneError, yaml.YAMLError) as fault:
            raise RecordingError(f"{self.path}: the metadata cannot be used: {fault}") from None
        times = np.unique(np.concatenate([part.log_ns for part in parts])).astype(np.int64)
        if not len(times):
            raise RecordingError(f"{self.path}: no samples on {', '.join(sorted(_OUTPUT_TOPICS))}; it has {listing}")
        self.samples = len(times)
        self.first_time, self.last_time = ((int(edge) - self.start_ns) * 1e-9 for edge in times[[0, -1]])

    @property
    def duration(self) -> float:
        """Simulated time from the first to the last sample [s]."""
        return self.last_time - self.first_time

    @cached_property
    def largest_load(self) -> float:
        """Largest roller load [N]; the recording is read for it."""
        largest = 0.0
        for topics, record in self._records():
            if _LAST_OF_SAMPLE not in topics:
                continue
            data = record.data(topics.index(_LAST_OF_SAMPLE)) if isinstance(record, Rows) else np.frombuffer(record.data, np.uint8)[None]
            count = trailing_doubles(data[0].tobytes()).size
            loads = np.ascontiguousarray(data[:, data.shape[1] - 8 * count :]).view("<f8")
            finite = loads[np.isfinite(loads).all(axis=1)]
            largest = max(largest, float(finite.max(initial=0.0)))
        return largest

    def _told_by(self, file: Path) -> FileIndex:
        """Return what a file says of itself or, where it was cut short, what reading it finds."""
        told = read_index(file, _LAST_OF_SAMPLE)
        if told is not None:
            for topic, ros_type in told.types.items():
                self._require_type(topic, ros_type)
            return told
        present: set[str] = set()
        metadata: dict[str, dict[str, str]] = {}
        log_ns = [np.empty(0, np.uint64)]
        for topics, record in self._records_of(file):
            present |= set(topics)
            if isinstance(record, Metadata):
                metadata[record.name] = record.metadata
            elif isinstance(record, Rows):
                log_ns += [record.log_ns(k) for k, topic in enumerate(topics) if topic == _LAST_OF_SAMPLE]
            elif topics == (_LAST_OF_SAMPLE,):
                log_ns.append(np.array([record.log_time], np.uint64))
        return FileIndex({}, present, metadata, np.concatenate(log_ns))

    def _records(self) -> Iterator[tuple[tuple[str, ...], Message | Rows | Metadata]]:
        """Yield (topics, messages) in file order, and metadata records without a topic; end quietly where a file was cut short."""
        for file in self.files:
            yield from self._records_of(file)

    def _records_of(self, file: Path) -> Iterator[tuple[tuple[str, ...], Message | Rows | Metadata]]:
        topics: dict[int, str] = {}
        schemas: dict[int, str] = {}
        salvage = Salvage(file, in_rows=_OUTPUT_TOPICS.__contains__)
        if not salvage.is_mcap:
            raise RecordingError(f"{file}: not an MCAP file ({salvage.size} bytes)")
        for record in salvage:
            if salvage.damaged:
                break
            if isinstance(record, Rows):
                yield tuple(topics[channel] for channel in record.channels), record
            elif isinstance(record, Message):
                yield (topics[record.channel_id],), record
            elif isinstance(record, Schema):
                schemas[record.id] = record.name
            elif isinstance(record, Channel):
                self._require_type(record.topic, schemas.get(record.schema_id, ""))
                topics[record.id] = record.topic
            elif isinstance(record, Metadata):
                yield (), record
        if salvage.damaged or not salvage.is_finished:
            name = "the file" if len(self.files) == 1 else file.name
            why = "what follows is damaged" if salvage.damaged else salvage.ends
            self.unfinished = f"{name} ends early ({why}); what was complete before that is shown"

    def _require_type(self, topic: str, ros_type: str) -> None:
        expected = _TYPES.get(topic)
        if expected is not None and ros_type != expected:
            raise RecordingError(f"{self.path}: {topic} is of type {ros_type or 'unknown'}; a recording of bearing_sim has {expected}")

    def __iter__(self) -> Iterator[np.ndarray | Event]:
        """Yield blocks of at most `ROWS_PER_BLOCK` samples, and events, in the order of the file."""
        return self._items()

    def with_received(self) -> Iterator["np.ndarray | Event | Received"]:
        """Yield what iterating yields, and the messages of inputs and measurements as they were recorded."""
        return self._items(with_received=True)

    def with_measurements(self) -> Iterator["np.ndarray | Event | Measurement"]:
        """Yield what iterating yields and, before a block, the measurements up to its end that were read by then, in order of time."""
        waiting: dict[int, dict[str, float]] = {}
        for item in self.with_received():
            if isinstance(item, Received):
                name = item.topic[1:]
                if name in MEASUREMENTS:
                    waiting.setdefault(item.log_ns, {})[name] = _measured_number(name, _decoder()(item.data, item.ros_type))
                continue
            if isinstance(item, np.ndarray):
                end_ns = self.start_ns + round(float(item["time"][-1]) * 1e9)
                for log_ns in sorted(stamp for stamp in waiting if stamp <= end_ns):
                    numbers = waiting.pop(log_ns)
                    if MEASURED in numbers:
                        yield Measurement((log_ns - self.start_ns) * 1e-9, numbers[MEASURED], numbers.get(RESIDUAL, math.nan))
            yield item

    def _items(self, with_received: bool = False) -> Iterator["np.ndarray | Event | Received"]:
        samples = Samples(self.scene, self.start_ns)
        told: dict[tuple[str, Level], float] = {}
        for topics, record in self._records():
            if isinstance(record, Rows):
                yield from _from_rows(samples, topics, record)
            elif isinstance(record, Message):
                if with_received and topics[0] in _RECEIVED:
                    ros_type = _TYPES.get(topics[0]) or MEASUREMENTS[topics[0][1:]].ros_type
                    yield Received(topics[0], ros_type, record.log_time, record.publish_time, record.data)
                if topics[0] == f"/{DIAGNOSTICS[0]}":
                    yield from _news(_decoder()(record.data, DIAGNOSTICS[1]), (record.log_time - self.start_ns) * 1e-9, told)
                else:
                    yield from _from_message(samples, topics[0], record)
        last = samples.take()
        if len(last):
            yield last


def _from_rows(samples: Samples, topics: tuple[str, ...], rows: Rows) -> Iterator[np.ndarray]:
    """Enter rows, all at once where they can be; yield the blocks that get full."""
    found = samples.numbers_of(rows, [topic[1:] if topic in _TYPES else "" for topic in topics])
    if found is None:
        for k, message in enumerate(rows.messages()):
            yield from _from_message(samples, topics[k % len(topics)], message)
        return
    log_ns, (columns, numbers) = rows.log_ns(0), found
    while len(log_ns):
        if samples.count == ROWS_PER_BLOCK:
            yield samples.take()
        room = ROWS_PER_BLOCK - samples.count
        samples.enter_rows(log_ns[:room], columns, numbers[:room])
        log_ns, numbers = log_ns[room:], numbers[room:]


def _from_message(samples: Samples, topic: str, message: Message) -> Iterator[np.ndarray]:
    """Enter an input or an output; yield the block that gets full."""
    if topic not in _TYPES:
        return
    name = topic[1:]
    decoded = trailing_doubles(message.data) if name in ARRAYS else _decoder()(message.data, _TYPES[topic])
    if topic not in _OUTPUT_TOPICS:
        samples.enter_input(name, decoded)
        return
    if samples.begins_sample(message.log_time) and samples.count == ROWS_PER_BLOCK:
        yield samples.take()
    samples.enter(name, message.log_time, decoded)


def trailing_doubles(data: bytes) -> np.ndarray:
    """Return the numbers of a Float64MultiArray, the last thing in its CDR: their count, padding to eight bytes, the numbers."""
    words = np.frombuffer(data, "<u4", offset=4, count=(len(data) - 4) // 4)
    for start in range(2, len(words) + 1, 2):
        if len(words) - start in (2 * words[start - 1], 2 * words[start - 2]):
            return np.frombuffer(data, "<f8", offset=4 + 4 * start)
    return np.empty(0)


def _measured_number(name: str, message) -> float:
    if MEASUREMENTS[name].ros_type == "std_msgs/msg/Float64":
        return float(message.data)
    joint = CAGE_JOINT if CAGE_JOINT in message.name else message.name[0]  # a cage of another name is recorded under its own
    return input_values(name, MEASUREMENTS[name].ros_type, message, joint)[0]


@cache
def _decoder():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY).deserialize_cdr


def _news(message, time: float, told: dict[tuple[str, Level], float]) -> Iterator[Event]:
    """Yield the events of a diagnostics message that were not told a moment ago; the first status is the whole's."""
    for status in message.status[1:]:
        code, level = status.name.partition(": ")[2], Level(int(status.level))
        for other in set(Level) - {level}:  # a change of level is news, and so is the way back
            told.pop((code, other), None)
        if time - told.get((code, level), -math.inf) > _REPEATS_WITHIN:
            yield Event(time, level, code, status.message)
        told[code, level] = time
