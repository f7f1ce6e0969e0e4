# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read recordings of runs: MCAP messages to blocks of samples, events and measurements, as sinks take them."""

import math
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import yaml
from mcap.records import Channel, Metadata
from rosbags.serde import SerdeError

from bearing_sim.files.limits import printable
from bearing_sim.files.tally import Tally
from bearing_sim.messages.bands import Bands, bands_of_message
from bearing_sim.messages.cdr import CdrError, CdrLayout, NumberColumns, typestore
from bearing_sim.messages.diagnostics import events_of
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, Received
from bearing_sim.messages.sample_messages import sample_columns
from bearing_sim.messages.topics import (
    ARRAYS,
    CAGE_JOINT,
    CLEARANCE_JOINT,
    DIAGNOSTICS,
    ESTIMATED,
    INPUTS,
    MEASURED,
    MEASURED_CLEARANCE,
    MEASUREMENTS,
    OUTPUTS,
    RECORDED,
    RESIDUAL,
    input_values,
)
from bearing_sim.model.sample import flat, new_block
from bearing_sim.recording.bag import LATEST, PartialRecording, RecordingError, mcap_files
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import FileIndex, McapReader, Rows, read_index
from bearing_sim.recording.writer import COMMAND, METADATA
from bearing_sim.scene.loader import SceneError, scene_from_yaml
from bearing_sim.scene.scene import Scene

if TYPE_CHECKING:
    from bearing_sim.model.names import Block

ROWS_PER_BLOCK = 1000
_REPEATS_WITHIN = 2.5  # [s] a lasting trouble is reported every second, and is one event
_SAMPLE_TOPICS = {f"/{name}": topic for name, topic in {**RECORDED, **OUTPUTS}.items()}
_TYPES = {topic: kind.ros_type for topic, kind in _SAMPLE_TOPICS.items()} | {
    f"/{topic.name}": topic.ros_type for topic in (*INPUTS.values(), *MEASUREMENTS.values(), *ESTIMATED.values())
}
_TYPES[f"/{DIAGNOSTICS[0]}"] = DIAGNOSTICS[1]
_RECEIVED = {f"/{name}" for name in (*INPUTS, *MEASUREMENTS)}
_ESTIMATED = {f"/{name}": name for name in ESTIMATED}
_LAST_OF_SAMPLE = "/roller_loads"
_LABEL = 12  # first byte of the first label in a serialised Float64MultiArray
_OF_TILTING_LEVELS = tuple(field for name, topic in OUTPUTS.items() if topic.of_tilting_levels for field in ARRAYS[name].fields)
_OF_BENDING = tuple(field for name, topic in RECORDED.items() if topic.of_bending for field in ARRAYS[name].fields)


class Recording:
    """A recording of one run; opening a finished one reads only its index.

    Iterating over an unfinished or damaged recording, by whichever method, yields what can be read of it and then raises `PartialRecording`,
    unless ``allow_partial`` is set.

    Parameters
    ----------
    path : what `bearing_sim.recording.writer.McapSink` wrote, finished or not: an MCAP file or the folder of a bag.
    allow_partial : whether the end of what can be read is no error; ``tally`` then says what is missing.

    Attributes
    ----------
    files : the files of the recording, in order.
    metadata : what its writer said about the run (see `bearing_sim.recording.writer.METADATA`).
    records : all its metadata records by name, of the first file that has them.
    command : that made the recording; empty if it was not made on the command line.
    scene : what was simulated.
    start_ns : wall time of sample time 0 [ns since the epoch].
    samples : number of samples.
    first_time, last_time : simulated times of the first and the last sample [s].
    tally : how many of the samples were used, and why not all; where files end early, of a finished but damaged one only once it has been read.

    Raises
    ------
    RecordingError
        The file does not exist or is not MCAP, or it has no scene in its metadata or no samples.
    """

    def __init__(self, path: str | Path, allow_partial: bool = False):
        self.path, self._allow_partial = Path(path), allow_partial
        self.tally = Tally("samples")
        self.files = mcap_files(self.path)
        parts = [self._index_of(file) for file in self.files]
        metadata = next((part.metadata[METADATA] for part in reversed(parts) if METADATA in part.metadata), None)
        self.metadata: dict[str, str] = metadata or {}
        self.records: dict[str, dict[str, str]] = {name: record for part in reversed(parts) for name, record in part.metadata.items()}
        self.command = next((part.metadata[COMMAND].get("command", "") for part in parts if COMMAND in part.metadata), "")
        listing = ", ".join(sorted(set().union(*(part.present for part in parts)))) or "no topics"
        if metadata is None and self.unfinished:
            raise RecordingError(f"{self.path}: no scene can be read: {'; '.join([*self.tally.unread, *self.tally.remedies])}")
        if metadata is None:
            raise RecordingError(f"{self.path}: no metadata record {METADATA!r}, so this is no recording of bearing_sim; it has {listing}")
        try:
            self.scene: Scene = scene_from_yaml(metadata["scene"], origin=f"{self.path}: scene in the metadata")
            self.start_ns = int(metadata["start_ns"])
            if not 0 <= self.start_ns < LATEST:
                raise ValueError("start_ns is before 1970 or after 2116")
        except (KeyError, ValueError, SceneError, yaml.YAMLError) as error:
            raise RecordingError(f"{self.path}: the metadata cannot be used: {error}") from None
        times = np.unique(np.concatenate([part.log_ns for part in parts])).astype(np.int64)
        if not len(times):
            raise RecordingError(f"{self.path}: no samples on {', '.join(sorted(_SAMPLE_TOPICS))}; it has {listing}")
        self.samples = self.tally.there = len(times)
        self.first_time, self.last_time = ((int(edge) - self.start_ns) * 1e-9 for edge in times[[0, -1]])

    @property
    def unfinished(self) -> str:
        """Where and why reading stops before the end of the recording, or ``""``."""
        return self.tally.unfinished

    @property
    def duration(self) -> float:
        """Simulated time from the first to the last sample [s]."""
        return self.last_time - self.first_time

    @cached_property
    def largest_load(self) -> float:
        """Largest roller load [N]; the whole recording is read to find it."""
        largest = 0.0
        for topics, record in self._records():
            if _LAST_OF_SAMPLE not in topics:
                continue
            data = record.data(topics.index(_LAST_OF_SAMPLE)) if isinstance(record, Rows) else np.frombuffer(record.data, np.uint8)[None]
            field = _layout(_LAST_OF_SAMPLE, data[0].tobytes()).by_path["data"]
            loads = np.ascontiguousarray(data[:, field.begin : field.end]).view(field.dtype)
            largest = max(largest, float(loads[np.isfinite(loads).all(axis=1)].max(initial=0.0)))
        return largest

    def _index_of(self, file: Path) -> FileIndex:
        """Return what a file says at its end or, if it has no end, what reading it finds."""
        index = read_index(file, _LAST_OF_SAMPLE)
        if index is not None:
            for topic, ros_type in index.types.items():
                self._require_type(topic, ros_type)
            return index
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
        """Yield (topics, messages) in file order, and metadata records without a topic; end quietly where a file is cut short or damaged."""
        for file in self.files:
            yield from self._records_of(file)

    def _records_of(self, file: Path) -> Iterator[tuple[tuple[str, ...], Message | Rows | Metadata]]:
        reader = McapReader(file, in_rows=_SAMPLE_TOPICS.__contains__, stops_at_damage=True, own_topics=True)
        for record in reader:
            if isinstance(record, Channel):
                topic = reader.topics[record.id]
                self._require_type(topic, reader.types[topic])
            elif isinstance(record, Rows):
                yield tuple(reader.topics[channel] for channel in record.channels), record
            elif isinstance(record, Message):
                if record.channel_id in reader.topics:
                    yield (reader.topics[record.channel_id],), record
            elif isinstance(record, Metadata):
                yield (), record
        if not reader.is_finished:
            name = "the file" if len(self.files) == 1 else printable(file.name)
            found = Tally(unread=[f"{name} ends early ({reader.ends}); what was complete before that is used"])
            what = "saves what follows the damage" if reader.damaged else "completes the file"
            found.remedies.append(f"bearing-sim recover {printable(file)} -o GOOD.mcap {what}")
            self.tally.add([found])

    def _require_type(self, topic: str, ros_type: str) -> None:
        expected = _TYPES.get(topic)
        if expected is not None and ros_type != expected:
            raise RecordingError(f"{self.path}: {topic} is of type {ros_type or 'unknown'}; a recording of bearing_sim has {expected}")

    def __iter__(self) -> Iterator["Block | Event"]:
        """Yield blocks of at most `ROWS_PER_BLOCK` samples, and events, in the order of the file."""
        return self._items()

    def with_received(self) -> Iterator["np.ndarray | Event | Received | Bands"]:
        """Yield what iterating yields, and the messages of inputs and measurements as they were recorded; bands, too."""
        return self._items(with_received=True, with_bands=True)

    def with_measurements(self) -> Iterator["np.ndarray | Event | Measurement | MeasuredClearance | Bands"]:
        """Yield what iterating yields and, before a block, the measurements up to its end that were read by then, in order of time; bands, too."""
        waiting: dict[int, dict[str, tuple[float, ...]]] = {}
        for item in self._items(with_received=True, with_bands=True):
            if isinstance(item, Received):
                name = item.topic[1:]
                if name in MEASUREMENTS:
                    waiting.setdefault(item.log_ns, {})[name] = measured_numbers(item)
                continue
            if isinstance(item, np.ndarray):
                end_ns = self.start_ns + round(float(item["time"][-1]) * 1e9)
                for log_ns in sorted(stamp for stamp in waiting if stamp <= end_ns):
                    found = waiting.pop(log_ns)
                    if MEASURED in found:
                        speed, *error = found[MEASURED]
                        (residual,) = found.get(RESIDUAL, (math.nan,))
                        yield Measurement((log_ns - self.start_ns) * 1e-9, speed, residual, *error)
                    if MEASURED_CLEARANCE in found:
                        yield MeasuredClearance((log_ns - self.start_ns) * 1e-9, *found[MEASURED_CLEARANCE])
            yield item

    def with_bands(self) -> Iterator["np.ndarray | Event | Bands"]:
        """Yield what iterating yields, and the bands of the recording, each of one instant, in the order of the file."""
        return self._items(with_bands=True)

    def bands(self) -> Iterator[Bands]:
        """Yield the bands of the recording, each of one instant, in the order of the file."""
        return (item for item in self.with_bands() if isinstance(item, Bands))

    def _items(self, with_received: bool = False, with_bands: bool = False) -> Iterator["np.ndarray | Event | Received | Bands"]:
        samples = _Samples(self.scene, self.start_ns)
        reported: dict[tuple[tuple[str, str], Level], float] = {}
        for topics, record in self._records():
            if isinstance(record, Rows):
                yield from samples.blocks_with_rows(topics, record)
            elif not isinstance(record, Message):
                continue
            elif topics[0] in _SAMPLE_TOPICS:
                yield from samples.blocks_with(topics[0], record)
            elif topics[0] in _RECEIVED and with_received:
                yield Received(topics[0], _TYPES[topics[0]], record.log_time, record.publish_time, record.data)
            elif topics[0] in _ESTIMATED:
                if with_bands:
                    with _as_unreadable(topics[0]):
                        found, time = _decoded(record.data, topics[0]), (record.log_time - self.start_ns) * 1e-9
                        bands = bands_of_message(_ESTIMATED[topics[0]], time, found.name, found.position)
                    yield bands
            elif topics[0] == f"/{DIAGNOSTICS[0]}":
                with _as_unreadable(topics[0]):
                    events = list(_events(_decoded(record.data, topics[0]), (record.log_time - self.start_ns) * 1e-9, reported))
                yield from events
        last = samples.pop_block()
        if len(last):
            yield last
        self._count(samples.complete, samples.incomplete)

    def _count(self, complete: int, incomplete: int) -> None:
        """Count the samples that were read; raise `PartialRecording` if these are not all."""
        unread = max(self.samples - complete, 0)
        self.tally.there, self.tally.used = complete + incomplete + unread, complete
        self.tally.refused = Counter({reason: count for reason, count in (("incomplete", incomplete), ("not readable", unread)) if count})
        if not self.tally.is_whole and not self._allow_partial:
            raise PartialRecording(printable(self.path), self.tally)


class _Samples:
    """Samples being put together from messages that share a log time, one by one or many at once.

    Parameters
    ----------
    scene : what was simulated.
    start_ns : wall time of sample time 0 [ns since the epoch].

    Attributes
    ----------
    complete, incomplete : samples that `pop_block` has returned, and left out.
    """

    def __init__(self, scene: Scene, start_ns: int):
        self._scene, self._start_ns = scene, start_ns
        self.complete = self.incomplete = 0
        self._block = new_block(ROWS_PER_BLOCK, scene.bearing.roller.count)
        self._count = 0  # samples begun since the last `pop_block`
        self._log_ns: int | None = None
        self._shapes: dict[tuple, tuple[np.ndarray, np.ndarray, NumberColumns]] = {}  # see `_shape_of`

    def blocks_with(self, topic: str, message: Message) -> Iterator[np.ndarray]:
        """Enter one message; yield the block that it finds full."""
        if _SAMPLE_TOPICS[topic].repeats:
            return
        columns, numbers = self._numbers_of((topic,), (0,), np.frombuffer(message.data, np.uint8)[None])
        if message.log_time != self._log_ns:
            if self._count == ROWS_PER_BLOCK:
                yield self.pop_block()
            self._begin(np.array([message.log_time], np.uint64))
        flat(self._block)[self._count - 1, columns] = numbers[0]

    def blocks_with_rows(self, topics: tuple[str, ...], rows: Rows) -> Iterator[np.ndarray]:
        """Enter rows, all at once if each is a sample; yield the blocks that get full."""
        if all(_SAMPLE_TOPICS[topic].repeats for topic in topics):
            return
        log_ns = rows.all_log_ns()
        first = log_ns[:, 0]
        are_samples = first[0] != self._log_ns and (first[1:] != first[:-1]).all() and (log_ns == first[:, None]).all()
        found = self._numbers_of(topics, tuple(map(rows.begin, range(len(topics)))), rows.table) if are_samples else None
        if found is None:
            for k, message in enumerate(rows.messages()):
                yield from self.blocks_with(topics[k % len(topics)], message)
            return
        columns, numbers = found
        while len(first):
            if self._count == ROWS_PER_BLOCK:
                yield self.pop_block()
            room = ROWS_PER_BLOCK - self._count
            self._begin(first[:room])[:, columns] = numbers[:room]
            first, numbers = first[room:], numbers[room:]

    def _numbers_of(self, topics: tuple[str, ...], begins: tuple[int, ...], table: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Return columns of a sample laid out flat and the numbers there, shape (rows, columns); None if the rows are not all laid out alike.

        Parameters
        ----------
        topics, begins : topic and first byte of each serialised message in a row.
        table : rows of bytes, uint8, shape (rows, length).
        """
        key = (topics, begins, table.shape[1])
        for is_known in (key in self._shapes, False):
            if not is_known:
                self._shapes[key] = self._shape_of(topics, begins, table[0])
            columns, known, reader = self._shapes[key]
            if (numbers := reader.read(table)) is not None:
                return columns, numbers[:, known]
        return None

    def _shape_of(self, topics: tuple[str, ...], begins: tuple[int, ...], row: np.ndarray) -> tuple[np.ndarray, np.ndarray, NumberColumns]:
        """Return columns of a sample laid out flat, which numbers of a row belong there, and what reads the numbers."""
        layouts, columns = [], []
        for topic, begin in zip(topics, begins):
            if _SAMPLE_TOPICS[topic].repeats:
                continue
            layout = _layout(topic, row[begin:].tobytes())
            own = sample_columns(_SAMPLE_TOPICS[topic], self._scene.bearing.roller.count)
            for field in layout.numbers:
                belong = own.get(field.path, np.full(field.count, -1))  # no sample has torques of joints
                if field.count != len(belong) and not self._is_of_earlier_version(topic, row[begin:].tobytes(), field.count):
                    raise RecordingError(f"a message on {topic} has {field.count} numbers; expected {len(belong)} by the scene")
                columns.append(belong[: field.count])
            layouts.append((begin, layout))
        belong = np.concatenate(columns)
        known = np.flatnonzero(belong >= 0)
        return belong[known], known, NumberColumns(row, layouts)

    def _is_of_earlier_version(self, topic: str, data: bytes, count: int) -> bool:
        """Whether an array has the first rows of today's and no others: versions append rows, and what a recording lacks is not known (NaN)."""
        name = topic.removeprefix("/")
        if name not in ARRAYS:
            return False
        dtype = self._block.dtype
        widths = np.cumsum([dtype[field].itemsize // dtype["time"].itemsize for field in ARRAYS[name].fields])
        dimensions, length = np.frombuffer(data, "<u4", 2, _LABEL - 8)  # a sequence of dimensions begins with the text of the first one's label
        label = data[_LABEL : _LABEL + int(length) - 1].decode(errors="replace")
        return bool(dimensions) and count in widths and ARRAYS[name].label.startswith(label)

    def _begin(self, log_ns: np.ndarray) -> np.ndarray:
        """Begin samples, of which only the time is known, and return their numbers."""
        block = self._block[self._count : self._count + len(log_ns)]
        numbers = flat(block)
        numbers[:] = np.nan
        block["time"] = (log_ns.astype(np.int64) - self._start_ns) * 1e-9
        self._log_ns = int(log_ns[-1])
        self._count += len(log_ns)
        return numbers

    def pop_block(self) -> np.ndarray:
        """Return the samples so far, without one that a kill cut short: its loads, written last, are missing."""
        block, self._count = self._block[: self._count], 0
        is_complete = ~np.isnan(block["inner_load"]).all(axis=1)
        block = block[is_complete]
        self.complete, self.incomplete = self.complete + len(block), self.incomplete + int((~is_complete).sum())
        if not self._scene.bodies_tilt:
            for field in _OF_TILTING_LEVELS:
                block[field] = 0.0
        if not self._scene.outer_ring_bends:
            for field in (*_OF_BENDING, "bending_clearance"):  # the second is younger than some recordings
                block[field] = 0.0
        return block


def _layout(topic: str, data: bytes) -> CdrLayout:
    try:
        return CdrLayout(_TYPES[topic], data)
    except CdrError as error:
        raise RecordingError(f"a message on {topic} cannot be read: {error}") from None


@contextmanager
def _as_unreadable(topic: str) -> Iterator[None]:
    """Convert what a damaged message raises, which can be of many kinds, to a `RecordingError`."""
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, SerdeError, TypeError, ValueError) as error:
        raise RecordingError(f"a message on {topic} cannot be read: {error}") from None


def _decoded(data: bytes, topic: str):
    return typestore().deserialize_cdr(data, _TYPES[topic])


def measured_numbers(received: Received) -> tuple[float, ...]:
    """Return the numbers of a message of one of `bearing_sim.messages.topics.MEASUREMENTS`: value and, where it is known, standard error.

    Raises
    ------
    RecordingError
        It cannot be read.
    """
    with _as_unreadable(received.topic):
        return _measured_numbers(received.topic[1:], _decoded(received.data, received.topic))


def _measured_numbers(name: str, message) -> tuple[float, ...]:
    if MEASUREMENTS[name].ros_type == "std_msgs/msg/Float64":
        return (float(message.data),)
    usual = CAGE_JOINT if name == MEASURED else CLEARANCE_JOINT
    joint = usual if usual in message.name else message.name[0]  # a cage of another name is recorded under its own
    return input_values(name, MEASUREMENTS[name].ros_type, message, joint)


def _events(message, time: float, reported: dict[tuple[tuple[str, str], Level], float]) -> Iterator[Event]:
    """Yield the events of a diagnostics message that were not reported a moment ago."""
    for event in (event for status in message.status for event in events_of(time, status)):
        key, level = event.key, event.level
        for other in set(Level) - {level}:  # a change of level is news, and so is the way back
            reported.pop((key, other), None)
        if time - reported.get((key, level), -math.inf) > _REPEATS_WITHIN:
            yield event
        reported[key, level] = time
