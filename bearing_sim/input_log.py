# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Input logs: shaft speed, radial load, oil temperature and measured cage speed out of a rosbag2 MCAP recording, also one cut short by a kill.

Reading takes what is there; judging (`judge`) passes every message through the same gate as a live run
(`bearing_sim.runtime.input_gate`), so nothing is repaired or guessed: a bad message is refused, named and counted.
"""

import struct
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import yaml
import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Footer, McapRecord, Message, Schema
from mcap.stream_reader import CRCValidationError, StreamReader
from mcap_ros2.decoder import DecoderFactory

from bearing_sim import topics
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
    path : the recording.
    series : by channel (``shaft_speed``, ``radial_load`` and, where recorded, ``oil_temperature`` and ``cage_speed_measured``).
    unfinished : why reading ended before the file's proper end, or ``""``.
    """

    path: Path
    series: Mapping[str, Series]
    unfinished: str


def read_input_log(
    path: str | Path,
    names: Mapping[str, str] | None = None,
    joint: str = topics.SHAFT_JOINT,
    stamps: str = "header",
    cage_joint: str = topics.CAGE_JOINT,
    required: Iterable[str] = REQUIRED,
) -> InputLog:
    """Read the inputs of a recording.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), or the folder of a bag of MCAP files.
    names : topic by channel where it is not ``/shaft_speed``, ``/radial_load``, ``/oil_temperature``, ``/cage_speed_measured``.
    joint, cage_joint : names of the joints of shaft and cage in JointState messages.
    stamps : ``"header"`` takes header stamps where the type has them and they are set, else log times; ``"log"`` log times only.
    required : channels that must be there.

    Raises
    ------
    InputLogError
        No such recording, no MCAP, or not the topics that are needed; the message lists those there are.
    """
    path = Path(path)
    wanted = {topic if topic.startswith("/") else f"/{topic}": channel for channel, topic in _topic_names(names).items()}
    joints = dict.fromkeys(_CHANNELS, joint) | {topics.MEASURED: cage_joint}
    found: dict[str, Series] = {}
    present: dict[str, str] = {}
    unfinished = []
    for file in _files(path):
        why = _read_file(file, wanted, joints, stamps, found, present)
        if why:
            unfinished.append(f"{file.name}: {why}")
    _check_found(path, wanted, tuple(required), found, present, names or {})
    for series in found.values():
        _sort_by_log_time(series)
    return InputLog(path, found, "; ".join(unfinished))


def _topic_names(names: Mapping[str, str] | None) -> dict[str, str]:
    return {channel: (names or {}).get(channel) or channel for channel in _CHANNELS}


def _files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise InputLogError(f"{path}: no such file or folder")
    index = path / "metadata.yaml"
    if index.is_file():
        try:
            listed = yaml.safe_load(index.read_text())["rosbag2_bagfile_information"]["relative_file_paths"]
            files = [path / str(name) for name in listed]
        except (yaml.YAMLError, KeyError, TypeError, UnicodeDecodeError):
            raise InputLogError(f"{index}: not the metadata of a bag") from None
    else:
        files = sorted([*path.glob("*.mcap"), *path.glob("*.mcap.active")])
    unusable = [file.name for file in files if not file.is_file() or ".mcap" not in file.name or file.suffix == ".zstd"]
    if unusable or not files:
        raise InputLogError(f"{path}: expected uncompressed .mcap files, {'cannot use ' + ', '.join(unusable) if unusable else 'found none'}")
    return files


def _records(file: Path) -> Iterator[McapRecord]:
    with open(file, "rb") as stream:
        size = file.stat().st_size
        yield from StreamReader(WholeReads(stream), validate_crcs=True, record_size_limit=size).records


def _read_file(
    file: Path, wanted: Mapping[str, str], joints: Mapping[str, str], stamps: str, found: dict[str, Series], present: dict[str, str]
) -> str:
    """Add a file's messages to ``found`` and its topics to ``present``; return why it ended early, or ``""``."""
    schemas: dict[int, Schema] = {}
    readers: dict[int, Callable[[Message], None] | None] = {}
    finished = started = False
    try:
        for record in _records(file):
            started = True
            if isinstance(record, Message):
                reader = readers.get(record.channel_id)
                if reader is not None:
                    reader(record)
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in readers:
                schema = schemas.get(record.schema_id)
                present[record.topic] = schema.name if schema else "?"
                readers[record.id] = _message_reader(record, schema, wanted, joints, stamps, found)
            finished = finished or isinstance(record, Footer)
    except _BROKEN as fault:
        if not started:
            raise InputLogError(f"{file}: not an MCAP file ({_words(fault)})") from None
        # Once the footer has been read all messages have been read.
        return "" if finished else f"ends early ({_words(fault)}); what was complete before that is used"
    return ""


def _words(fault: Exception) -> str:
    return str(fault) or type(fault).__name__


def _message_reader(
    channel: Channel, schema: Schema | None, wanted: Mapping[str, str], joints: Mapping[str, str], stamps: str, found: dict[str, Series]
) -> Callable[[Message], None] | None:
    """Return what takes a channel's messages into its series, or None for a channel that nobody wants."""
    name = wanted.get(channel.topic)
    if name is None:
        return None
    ros_type = schema.name if schema else ""
    if ros_type not in topics.input_types(name):
        raise InputLogError(f"{channel.topic} is of type {ros_type or 'unknown'}; {name} needs {' or '.join(topics.input_types(name))}")
    series = found.setdefault(name, Series(channel.topic, ros_type))
    if series.ros_type != ros_type:
        raise InputLogError(f"{channel.topic} carries both {series.ros_type} and {ros_type}; expected one type")
    decode = _decoder(channel, schema)

    def read(message: Message) -> None:
        try:
            decoded = decode(message.data)
        except Exception as fault:  # decoders raise whatever their tables do; the message is counted and said
            series.faults.append(Fault(message.log_time, "input.unreadable", f"cannot be decoded ({type(fault).__name__}: {fault})"))
            return
        try:
            values = topics.input_values(name, ros_type, decoded, joints[name])
        except ValueError as fault:
            series.faults.append(Fault(message.log_time, "input.malformed", str(fault)))
            return
        stamp = topics.header_stamp_ns(decoded) if stamps == "header" else None
        if not series.stamps and stamp is not None:
            series.stamped_by = "header"
        if series.stamped_by == "header" and stamp is None:
            series.faults.append(Fault(message.log_time, "input.not_stamped", "the header's stamp is not set, as it is in other messages"))
            return
        series.stamps.append(stamp if series.stamped_by == "header" else message.log_time)
        series.log_times.append(message.log_time)
        series.values.append(values)

    return read


def _decoder(channel: Channel, schema: Schema) -> Callable[[bytes], object]:
    decoder = DecoderFactory().decoder_for(channel.message_encoding, schema)
    if decoder is not None:
        return decoder
    if channel.message_encoding != "cdr":
        raise InputLogError(f"{channel.topic} is encoded as {channel.message_encoding!r}; expected cdr")
    # Definitions in IDL: the standard types are known by name.
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    return lambda data: store.deserialize_cdr(data, schema.name)


def _check_found(
    path: Path, wanted: Mapping[str, str], required: Iterable[str], found: Mapping[str, Series], present: Mapping[str, str], named: Mapping[str, str]
) -> None:
    listing = ", ".join(f"{topic} ({kind})" for topic, kind in sorted(present.items())) or "no topics"
    absent = [topic for topic, channel in wanted.items() if channel not in found and (channel in required or named.get(channel))]
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
    """Yield one line of text for each channel: topic, type, clock, messages."""
    for channel, series in log.series.items():
        unread = f", {len(series.faults)} not readable" if series.faults else ""
        yield f"{channel}: {series.topic} ({series.ros_type}), {len(series.stamps)} messages by {series.stamped_by}{unread}"
