# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recover an MCAP file whose writer was killed, and say what is in an MCAP file and how sound it is."""

import math
import os
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.writer import CompressionType, Writer

from bearing_sim.mcap_stream import Salvage
from bearing_sim.sinks.bag_metadata import Part, TopicCount, part_metadata

_CHUNK_SIZE = 64 * 1024  # [byte]
_BAG = "rosbag2"


class RecoveryError(ValueError):
    """A file out of which nothing can be recovered, or a target that exists."""


@dataclass
class Contents:
    """What an MCAP file holds.

    Attributes
    ----------
    path, size : the file and its length [byte].
    profile, library : what its writer said of itself.
    types : message type by topic; ``messages`` their number, ``hashes`` their type hashes, likewise.
    metadata : metadata records by name.
    attachments : number of attachments.
    first_ns, last_ns : lowest and highest log time [ns since the epoch]; zeros without messages.
    out_of_order : messages with a log time before that of an earlier one of their topic.
    damaged : chunks and records that could not be read.
    is_finished : whether the file has its proper end.
    ends : why not, or ``""``.
    """

    path: Path
    size: int
    profile: str = ""
    library: str = ""
    types: dict[str, str] = field(default_factory=dict)
    hashes: dict[str, str] = field(default_factory=dict)
    messages: Counter = field(default_factory=Counter)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: int = 0
    first_ns: int = 0
    last_ns: int = 0
    out_of_order: int = 0
    damaged: int = 0
    is_finished: bool = False
    ends: str = ""

    @property
    def is_sound(self) -> bool:
        """Whether the file is whole."""
        return self.is_finished and not self.damaged

    @property
    def seconds(self) -> float:
        """Time from the first to the last message [s]."""
        return (self.last_ns - self.first_ns) * 1e-9


def contents(path: str | Path, progress: Callable[[float], None] = lambda done: None) -> Contents:
    """Read an MCAP file from end to end, checksums included, and return what it holds.

    Parameters
    ----------
    path : the file, finished or not.
    progress : called now and then with the share that was read.

    Raises
    ------
    RecoveryError
        It is no MCAP file.
    OSError
        It cannot be read.
    """
    return _walk(Path(path), progress, lambda record: None)


def recover(source: str | Path, target: str | Path, progress: Callable[[float], None] = lambda done: None) -> Contents:
    """Write all that can be read of an MCAP file into a sound one; returns what was found.

    Messages keep their bytes, times and order; a damaged chunk is left out and counted.  What a ROS 2 recorder writes at the
    end, the metadata of the bag, is made anew where it is missing.

    Parameters
    ----------
    source : the file, finished or not.
    target : must not exist.
    progress : called now and then with the share that was read.

    Raises
    ------
    RecoveryError
        The source is no MCAP file or holds nothing complete, or the target exists.
    OSError
        A file cannot be read or written.
    """
    source, target = Path(source), Path(target)
    draft = target.with_name(target.name + ".active")
    for taken in (target, draft):
        if taken.exists():
            raise RecoveryError(f"{taken} exists; recover into another file")
    _salvage(source)
    try:
        with open(draft, "xb") as stream:
            copy = _Copy(Writer(stream, chunk_size=_CHUNK_SIZE, compression=CompressionType.ZSTD))
            found = _walk(source, progress, copy.take)
            if not found.messages and not found.metadata:
                raise RecoveryError(f"{source}: nothing complete in its {found.size} bytes")
            if found.profile == "ros2" and _BAG not in found.metadata:
                copy.writer.add_metadata(_BAG, {"serialized_metadata": _bag_metadata(found, target.name)})
            copy.writer.finish()
        os.replace(draft, target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    return found


class _Copy:
    """Writes records into another file, where schemas and channels have other numbers."""

    def __init__(self, writer: Writer):
        self.writer = writer
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self._started = False

    def take(self, record) -> None:
        if isinstance(record, Header):
            self.writer.start(profile=record.profile, library=record.library)
            self._started = True
            return
        if not self._started:  # the header itself was damaged
            self.writer.start(profile="ros2")
            self._started = True
        if isinstance(record, Message):
            self.writer.add_message(self._channels[record.channel_id], record.log_time, record.data, record.publish_time, record.sequence)
        elif isinstance(record, Schema) and record.id not in self._schemas:
            self._schemas[record.id] = self.writer.register_schema(record.name, record.encoding, record.data)
        elif isinstance(record, Channel) and record.id not in self._channels:
            schema = self._schemas.get(record.schema_id, 0)
            self._channels[record.id] = self.writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
        elif isinstance(record, Metadata):
            self.writer.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            self.writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)


def _salvage(path: Path) -> Salvage:
    salvage = Salvage(path)
    if not salvage.is_mcap:
        raise RecoveryError(f"{path}: not an MCAP file ({salvage.size} bytes)")
    return salvage


def _walk(path: Path, progress: Callable[[float], None], take: Callable) -> Contents:
    """Hand every record that can be read, and be understood, to ``take``; return what there is."""
    salvage = _salvage(path)
    found = Contents(path, salvage.size)
    schemas: dict[int, str] = {}
    topics: dict[int, str] = {}
    newest: dict[int, int] = {}
    orphans, first, last = 0, math.inf, 0
    for record in salvage:
        if isinstance(record, Message):
            topic, latest = topics.get(record.channel_id), newest.get(record.channel_id, 0)
            if topic is None:  # its channel was told in a damaged chunk
                orphans += 1
                continue
            found.messages[topic] += 1
            found.out_of_order += record.log_time < latest
            newest[record.channel_id] = max(latest, record.log_time)
            first = min(first, record.log_time)
            last = max(last, record.log_time)
        elif isinstance(record, Header):
            found.profile, found.library = record.profile, record.library
        elif isinstance(record, Schema):
            schemas[record.id] = record.name
        elif isinstance(record, Channel):
            topics[record.id] = record.topic
            found.types[record.topic] = schemas.get(record.schema_id, "")
            found.hashes[record.topic] = record.metadata.get("topic_type_hash", "")
        elif isinstance(record, Metadata):
            found.metadata[record.name] = record.metadata
        elif isinstance(record, Attachment):
            found.attachments += 1
        take(record)
        progress(salvage.read / max(salvage.size, 1))
    found.first_ns, found.last_ns = (int(first), last) if found.messages else (0, 0)
    found.damaged, found.is_finished, found.ends = salvage.damaged + orphans, salvage.is_finished, salvage.ends
    return found


def _bag_metadata(found: Contents, name: str) -> str:
    counts = [TopicCount(topic, kind, found.hashes[topic], found.messages[topic]) for topic, kind in found.types.items()]
    return part_metadata(Part(name, found.first_ns, found.last_ns, found.messages.total()), counts, {"recovered": "true"})
