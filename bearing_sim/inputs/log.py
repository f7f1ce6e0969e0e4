# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Input logs: shaft speed, radial load, oil temperature and measured cage speed out of recordings, also those that others wrote or a kill cut short.

MCAP files are read record by record, which works without their end; all other bags through the rosbags library.

Reading takes what is there; judging (`judge`) passes every message through the same gate as a live run
(`bearing_sim.runtime.input_gate`), so nothing is repaired or guessed: a bad message is refused, named and counted.
"""

import sqlite3
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Footer, McapRecord, Message, Schema
from mcap.stream_reader import CRCValidationError, StreamReader
from mcap_ros2.decoder import DecoderFactory

from bearing_sim import topics
from bearing_sim.bag_files import BagError, mcap_files
from bearing_sim.input_source import Source, source, source_values
from bearing_sim.mcap_stream import WholeReads
from bearing_sim.runtime.leg import REQUIRED
from bearing_sim.scene_file import did_you_mean

_CHANNELS = (*topics.INPUTS, topics.MEASURED)
_BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, struct.error, UnicodeDecodeError, RuntimeError)  # lz4 raises RuntimeError


class InputLogError(ValueError):
    """A recording that cannot serve as input log; the message says what is in it instead."""


class Fault(NamedTuple):
    """A message that could not be read."""

    log_ns: int
    code: str
    reason: str


@dataclass
class Series:
    """The messages of one channel in the order of their log times.

    Attributes
    ----------
    topic, ros_type : where they were found.
    stamped_by : ``"header"`` or ``"log time"``: which clock ``stamps`` are of.
    stamps, log_times : [ns since the epoch], one for each message read.
    values : SI numbers of each message (see `bearing_sim.topics.input_values`).
    faults : the messages that could not be read.
    """

    topic: str
    ros_type: str
    stamped_by: str = "log time"
    stamps: list[int] = field(default_factory=list)
    log_times: list[int] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


@dataclass(frozen=True)
class InputLog:
    """What a recording says of the inputs.

    Attributes
    ----------
    path : the recording; of several, all of them.
    series : by channel (``shaft_speed``, ``radial_load`` and, where recorded, ``oil_temperature`` and ``cage_speed_measured``).
    unfinished : why reading ended before the file's proper end, or ``""``.
    """

    path: Path
    series: Mapping[str, Series]
    unfinished: str


def read_input_log(
    path: str | Path | Sequence[str | Path],
    names: Mapping[str, str | Source | None] | None = None,
    joint: str = topics.SHAFT_JOINT,
    stamps: str = "header",
    cage_joint: str = topics.CAGE_JOINT,
    required: Iterable[str] = REQUIRED,
) -> InputLog:
    """Read the inputs of a recording, or of several that belong together.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), an sqlite3 file or a bag's folder; or a sequence of them.
    names : by channel, topic or topic and field (see `bearing_sim.input_source.source`), where it is not ``/shaft_speed``,
        ``/radial_load``, ``/oil_temperature``, ``/cage_speed_measured``.
    joint, cage_joint : names of the joints of shaft and cage in JointState messages.
    stamps : ``"header"`` takes header stamps where the type has them and they are set, else log times; ``"log"`` log times only.
    required : channels that must be there.

    Raises
    ------
    InputLogError
        No such recording, or not the topics that are needed; the message lists those there are.
    """
    paths = [Path(path)] if isinstance(path, (str, Path)) else [Path(each) for each in path]
    wanted = _Wanted(_sources(names), dict.fromkeys(_CHANNELS, joint) | {topics.MEASURED: cage_joint}, stamps, {}, {})
    unfinished = []
    for each in paths:
        if _is_foreign(each):
            _read_bag(each, wanted)
            continue
        try:
            files = mcap_files(each)
        except BagError as fault:
            raise InputLogError(str(fault)) from None
        for file in files:
            why = _read_file(file, wanted)
            if why:
                unfinished.append(f"{file.name}: {why}")
    together = paths[0] if len(paths) == 1 else Path(" + ".join(map(str, paths)))
    _check_found(together, wanted, tuple(required), names or {})
    for series in wanted.found.values():
        _sort_by_log_time(series)
    return InputLog(together, wanted.found, "; ".join(unfinished))


class _Wanted(NamedTuple):
    """What is looked for and what was found."""

    sources: dict[str, Source]  # by channel
    joints: dict[str, str]  # by channel
    stamps: str
    found: dict[str, Series]
    present: dict[str, str]  # type by topic

    def reader(self, topic: str, ros_type: str, decode: Callable[[bytes], object]) -> Callable[[int, bytes], None] | None:
        """Return what takes a topic's messages (log time, data) into the series that want them; None where nobody does."""
        self.present[topic] = ros_type or "?"
        readers = [_message_reader(channel, where, ros_type, decode, self) for channel, where in self.sources.items() if where.topic == topic]
        if len(readers) < 2:
            return readers[0] if readers else None
        return lambda log_time, data: [read(log_time, data) for read in readers]


def _sources(names: Mapping[str, str | Source | None] | None) -> dict[str, Source]:
    given = {channel: (names or {}).get(channel) for channel in _CHANNELS}
    try:
        return {channel: named if isinstance(named, Source) else source(channel, named) for channel, named in given.items()}
    except ValueError as fault:
        raise InputLogError(str(fault)) from None


def _is_foreign(path: Path) -> bool:
    if path.is_file():
        return path.suffix in (".db3", ".bag")
    return any(path.glob("*.db3"))


def _read_bag(path: Path, wanted: _Wanted) -> None:
    """Add the messages of a bag in another format than MCAP."""
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as bag:
            readers = {}
            for connection in bag.connections:
                decode = partial(_deserialize, bag, connection.msgtype)
                readers[connection.id] = wanted.reader(connection.topic, connection.msgtype, decode)
            kept = [connection for connection in bag.connections if readers[connection.id] is not None]
            for connection, log_time, data in bag.messages(connections=kept) if kept else ():
                readers[connection.id](log_time, data)
    except (AnyReaderError, OSError, sqlite3.Error) as fault:
        raise InputLogError(f"{path}: cannot be read as a bag: {fault}") from None


def _deserialize(bag, ros_type: str, data: bytes) -> object:
    return bag.deserialize(data, ros_type)


def _records(file: Path) -> Iterator[McapRecord]:
    with open(file, "rb") as stream:
        size = file.stat().st_size
        yield from StreamReader(WholeReads(stream), validate_crcs=True, record_size_limit=size).records


def _read_file(file: Path, wanted: _Wanted) -> str:
    """Add a file's messages; return why it ended early, or ``""``."""
    schemas: dict[int, Schema] = {}
    readers: dict[int, Callable[[int, bytes], None] | None] = {}
    finished = started = False
    try:
        for record in _records(file):
            started = True
            if isinstance(record, Message):
                reader = readers.get(record.channel_id)
                if reader is not None:
                    reader(record.log_time, record.data)
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in readers:
                schema = schemas.get(record.schema_id)
                readers[record.id] = wanted.reader(record.topic, schema.name if schema else "", partial(_decoded, record, schema))
            finished = finished or isinstance(record, Footer)
    except _BROKEN as fault:
        if not started:
            raise InputLogError(f"{file}: not an MCAP file ({_words(fault)})") from None
        # Once the footer has been read all messages have been read.
        return "" if finished else f"ends early ({_words(fault)}); what was complete before that is used"
    return ""


def _words(fault: Exception) -> str:
    return str(fault) or type(fault).__name__


def _message_reader(channel: str, where: Source, ros_type: str, decode: Callable, wanted: _Wanted) -> Callable[[int, bytes], None]:
    """Return what takes a topic's messages into a channel's series."""
    if not where.fields and ros_type not in topics.input_types(channel):
        expected = " or ".join(topics.input_types(channel))
        raise InputLogError(
            f"{where.topic} is of type {ros_type or 'unknown'}; {channel} needs {expected}, or the field to take ({where.topic}.some.field)"
        )
    series = wanted.found.setdefault(channel, Series(where.topic, ros_type))
    if series.ros_type != ros_type:
        raise InputLogError(f"{where.topic} carries both {series.ros_type} and {ros_type}; expected one type")

    def read(log_time: int, data: bytes) -> None:
        try:
            decoded = decode(data)
        except InputLogError:
            raise
        except Exception as fault:  # decoders raise whatever their tables do; the message is counted and said
            series.faults.append(Fault(log_time, "input.unreadable", f"cannot be decoded ({type(fault).__name__}: {fault})"))
            return
        try:
            values = source_values(channel, where, ros_type, decoded, wanted.joints[channel])
        except ValueError as fault:
            series.faults.append(Fault(log_time, "input.malformed", str(fault)))
            return
        stamp = topics.header_stamp_ns(decoded) if wanted.stamps == "header" else None
        if not series.stamps and stamp is not None:
            series.stamped_by = "header"
        if series.stamped_by == "header" and stamp is None:
            series.faults.append(Fault(log_time, "input.not_stamped", "the header's stamp is not set, as it is in other messages"))
            return
        series.stamps.append(stamp if series.stamped_by == "header" else log_time)
        series.log_times.append(log_time)
        series.values.append(values)

    return read


def _decoded(channel: Channel, schema: Schema | None, data: bytes) -> object:
    return _decoder(
        channel.topic, channel.message_encoding, schema.name if schema else "", schema.encoding if schema else "", schema.data if schema else b""
    )(data)


@lru_cache(maxsize=256)
def _decoder(topic: str, message_encoding: str, name: str, encoding: str, definition: bytes) -> Callable[[bytes], object]:
    if message_encoding != "cdr":
        raise InputLogError(f"{topic} is encoded as {message_encoding!r}; expected cdr")
    decoder = DecoderFactory().decoder_for(message_encoding, Schema(1, definition, encoding, name))
    if decoder is not None:
        return decoder
    from rosbags.typesys import Stores, get_types_from_idl, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    if name not in store.types:  # of the standard types the definition is known
        store.register({kind: fields for kind, fields in get_types_from_idl(definition.decode()).items() if kind not in store.types})
    return lambda data: store.deserialize_cdr(data, name)


def _check_found(path: Path, wanted: _Wanted, required: tuple[str, ...], named: Mapping[str, str | Source | None]) -> None:
    found, present = wanted.found, wanted.present
    listing = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(present.items())) or "no topics"
    absent = [where.topic for channel, where in wanted.sources.items() if channel not in found and (channel in required or named.get(channel))]
    if absent:
        hints = "; ".join(f"no {topic}{did_you_mean(topic, present)}" for topic in absent)
        raise InputLogError(f"{path}: {hints}; the file has {listing}")
    empty = [series.topic for channel, series in found.items() if channel in required and not series.stamps]
    if empty:
        first = [fault.reason for series in found.values() for fault in series.faults[:1]]
        raise InputLogError(f"{path}: no usable message on {', '.join(empty)}{' (' + first[0] + ')' if first else ''}")


def _sort_by_log_time(series: Series) -> None:
    """Bring messages into the order in which they were recorded: chunks may overlap."""
    order = sorted(range(len(series.stamps)), key=series.log_times.__getitem__)
    if order != list(range(len(order))):
        series.stamps = [series.stamps[place] for place in order]
        series.log_times = [series.log_times[place] for place in order]
        series.values = [series.values[place] for place in order]


def summary_lines(log: InputLog) -> Iterable[str]:
    """Yield one line of text for each channel: topic, type, clock, messages, and what is odd about them."""
    for channel, series in log.series.items():
        odd = [f"{len(series.faults)} not readable"] if series.faults else []
        odd += [f"{count} {name.replace('_', ' ')}" for name, count in anomalies(series)._asdict().items() if count]
        told = f"{channel}: {series.topic} ({series.ros_type}), {len(series.stamps)} messages by {series.stamped_by}"
        yield ", ".join([told, *odd])


class Anomalies(NamedTuple):
    """What is odd about the times of a channel's messages, counted in the order of recording.

    Attributes
    ----------
    out_of_order : messages stamped before an earlier one.
    repeated : messages with the stamp of the one before.
    in_bursts : messages logged within a tenth of the usual spacing of stamps after the one before.
    gaps : spacings of stamps above ten times the usual one.
    """

    out_of_order: int
    repeated: int
    in_bursts: int
    gaps: int


def anomalies(series: Series) -> Anomalies:
    """Count what is odd about the times of a channel's messages; the usual spacing is the median."""
    stamps, logged = np.array(series.stamps, np.int64), np.array(series.log_times, np.int64)
    if len(stamps) < 2:
        return Anomalies(0, 0, 0, 0)
    latest = np.maximum.accumulate(stamps)
    steps, risen = np.diff(stamps), np.diff(latest)
    usual = float(np.median(risen[risen > 0])) if (risen > 0).any() else 0.0
    return Anomalies(
        int((stamps[1:] < latest[:-1]).sum()),
        int((steps == 0).sum()),
        int((np.diff(logged) < 0.1 * usual).sum()) if series.stamped_by == "header" else int(((steps > 0) & (steps < 0.1 * usual)).sum()),
        int((risen > 10 * usual).sum()) if usual else 0,
    )
