# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recover an MCAP file whose writer was killed, and report what an MCAP file contains and whether it is whole."""

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from mcap.records import Attachment, Channel, Header, Metadata, Schema

from bearing_sim.files.limits import printable
from bearing_sim.files.outputs import Output
from bearing_sim.recording.bag import Part, RecordingError, TopicCount, bag_metadata
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.recording.mcap_format import PROFILE, Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.mcap_writer import McapWriter

_BAG = "rosbag2"
_MESSAGE_COUNT = re.compile(r"^\s*message_count: (\d{1,20})$", re.MULTILINE)  # the first one is that of the whole bag


@dataclass
class Contents:
    """What an MCAP file contains, or a bag in another format.

    Attributes
    ----------
    path, size : the file and its length [byte].
    profile, library : what its header says about its writer.
    types : message type by topic; ``messages`` their number, ``hashes`` their type hashes, likewise.
    metadata : metadata records by name.
    attachments : number of attachments.
    first_ns, last_ns : lowest and highest log time [ns since the epoch]; zeros without messages.
    out_of_order : messages with a log time before that of an earlier one of their topic.
    damaged : chunks, records and other parts that are damaged, whether they could be read or not.
    damage : what the first of them are and where.
    is_finished : whether the file has its proper end.
    ends : why not, or ``""``.
    has_checksums : whether the format has some, which were verified.
    covers_all : whether these cover all of the file; otherwise only chunks and, where the writer made one, the summary.
    undecodable : by topic, why its first message cannot be decoded, although it can be read.
    notes : how messages are read in another way than the file says, such as unpacked.
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
    damage: list[str] = field(default_factory=list)
    is_finished: bool = False
    ends: str = ""
    has_checksums: bool = True
    covers_all: bool = False
    undecodable: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    _newest: dict[str, int] = field(default_factory=dict, repr=False)  # by topic, its highest log time so far

    def count(self, topic: str, log_ns: int) -> None:
        """Count a message of a topic."""
        newest = self._newest.get(topic, log_ns)
        self.out_of_order += log_ns < newest
        self._newest[topic] = max(log_ns, newest)
        self.first_ns, self.last_ns = min(self.first_ns, log_ns) if self.messages else log_ns, max(self.last_ns, log_ns)
        self.messages[topic] += 1

    @property
    def is_sound(self) -> bool:
        """Whether the file is whole."""
        return self.is_finished and not self.damaged

    @property
    def seconds(self) -> float:
        """Time from the first to the last message [s]."""
        return (self.last_ns - self.first_ns) * 1e-9


def contents(path: str | Path, progress: Callable[[float], None] = lambda done: None) -> Contents:
    """Read an MCAP file from end to end, verify its checksums, and return what it contains.

    Parameters
    ----------
    path : the file, finished or not.
    progress : called repeatedly with the fraction that was read.

    Raises
    ------
    RecordingError
        It is not an MCAP file.
    OSError
        It cannot be read.
    """
    found = _walk(McapReader(path), progress, lambda record: None)
    untried, bag = {topic for topic, count in found.messages.items() if count}, BagReader(path)
    for item in bag:
        if not isinstance(item, BagTopic):
            _try(found, untried, *item)
            if not untried:
                break
    found.notes = bag.tally.notes
    return found


def _try(found: Contents, untried: set[str], topic: BagTopic, log_ns: int, data: bytes) -> None:
    """Enter into contents whether a message can be decoded, if it is the first of its topic."""
    if topic.name in untried:
        untried.remove(topic.name)
        try:
            topic.decode(data)
        except Exception as error:  # decoders raise exceptions of any kind on damaged data
            found.undecodable[topic.name] = printable(str(error))


def foreign_contents(path: str | Path) -> Contents | None:
    """Return what a bag in SQLite or of ROS 1 contains, a file or a folder; None if it is MCAP.

    Raises
    ------
    RecordingError
        There is no such recording, files of it are missing, or nothing of it can be read.
    """
    bag, path = BagReader(path), Path(path)
    if not bag.is_foreign:
        return None
    files = [path] if path.is_file() else [file for file in path.iterdir() if file.is_file()]
    found = Contents(path, sum(file.stat().st_size for file in files), has_checksums=False, library="another program (SQLite or ROS 1)")
    untried = set()
    try:
        for item in bag:
            if isinstance(item, BagTopic):
                found.types[item.name] = item.ros_type
                untried.add(item.name)
                continue
            _try(found, untried, *item)
            found.count(item[0].name, item[1])
        found.is_finished, found.ends = bag.tally.is_whole, bag.tally.text if not bag.tally.is_whole else ""
        found.notes = bag.tally.notes
    except RecordingError as error:
        if not found.types:
            raise
        found.ends = str(error)
    return found


def recover(source: str | Path, target: str | Path | Output, progress: Callable[[float], None] = lambda done: None) -> Contents:
    """Write all that can be read of an MCAP file into a sound one; return what was found.

    Messages keep their bytes, times and order.  What is damaged is left out and counted.  The metadata of the bag, which a ROS 2 recorder writes at
    the end, is rebuilt if it is missing or does not count what was found.

    Parameters
    ----------
    source : the file, finished or not.
    target : must not exist, except if it is an `Output` with force.
    progress : called repeatedly with the fraction that was read.

    Raises
    ------
    RecordingError
        The source is not an MCAP file or contains nothing complete.
    RefusedOutput
        The target must not be written, such as one that exists.
    OSError
        A file cannot be read or written.
    """
    source = Path(source)
    output = target if isinstance(target, Output) else Output(target, inputs=[source])
    reader = McapReader(source)  # before a draft is made
    with output.draft() as draft, open(draft, "wb") as stream:
        copy = _Copy(stream)
        found = _walk(reader, progress, copy.write)
        if not found.messages and not found.metadata:
            raise RecordingError(f"{source}: nothing complete in its {found.size} bytes, so there is nothing to recover")
        if bag := _bag_record(found, output.path.name):
            copy.writer.add_metadata(_BAG, bag)
        copy.writer.finish()
    return found


class _Copy:
    """Writes records into another file, where schemas and channels have other numbers."""

    def __init__(self, stream: BinaryIO):
        self._stream = stream
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self._writer: McapWriter | None = None

    @property
    def writer(self) -> McapWriter:
        """What writes the other file; with a header of its own if that of the source was damaged."""
        if self._writer is None:
            self._writer = McapWriter(self._stream, library="")
        return self._writer

    def write(self, record) -> None:
        if isinstance(record, Header):
            self._writer = self._writer or McapWriter(self._stream, record.profile, record.library)
        elif isinstance(record, Message):
            self.writer.add_message(record._replace(channel_id=self._channels[record.channel_id]))
        elif isinstance(record, Schema) and record.id not in self._schemas:
            self._schemas[record.id] = self.writer.add_schema(record.name, record.encoding, record.data)
        elif isinstance(record, Channel) and record.id not in self._channels:
            schema = self._schemas.get(record.schema_id, 0)
            self._channels[record.id] = self.writer.add_channel(record.topic, record.message_encoding, schema, record.metadata)
        elif isinstance(record, Metadata):
            if record.name != _BAG:  # which is the last one
                self.writer.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            self.writer.add_attachment(record)


def _walk(reader: McapReader, progress: Callable[[float], None], receive: Callable) -> Contents:
    """Hand every record that can be read and understood to ``receive``; return what there is."""
    found = Contents(reader.path, reader.size)
    orphans = 0
    for record in reader:
        if isinstance(record, Message):
            topic = reader.topics.get(record.channel_id)
            if topic is None:  # its channel was described in a damaged chunk
                orphans += 1
                continue
            found.count(topic, record.log_time)
        elif isinstance(record, Header):
            found.profile, found.library = record.profile, record.library
        elif isinstance(record, Channel):
            found.types[record.topic] = reader.types[record.topic]
            found.hashes[record.topic] = record.metadata.get("topic_type_hash", "")
        elif isinstance(record, Metadata):
            found.metadata[record.name] = record.metadata
        elif isinstance(record, Attachment):
            found.attachments += 1
        receive(record)
        progress(reader.read / max(reader.size, 1))
    found.damaged, found.damage = reader.damaged + orphans, list(reader.damage)
    if orphans:
        found.damage.append(f"{orphans} messages whose channels were described in what is damaged")
    found.is_finished, found.ends, found.covers_all = reader.is_finished, reader.ends, reader.has_checksums
    return found


def _bag_record(found: Contents, name: str) -> dict[str, str]:
    """Return the bag's metadata record of a recovered file with this name: the one that was found if it counts its messages, else a new one.

    It is empty for a file that is no bag of ROS 2 and had none.
    """
    record = found.metadata.get(_BAG, {})
    if found.profile != PROFILE:
        return record
    counted = _MESSAGE_COUNT.search(record.get("serialized_metadata", ""))
    if counted is not None and int(counted[1]) == found.messages.total():
        return record
    counts = [TopicCount(topic, kind, found.hashes[topic], found.messages[topic]) for topic, kind in found.types.items()]
    part = Part(name, found.first_ns, found.last_ns, found.messages.total())
    return {"serialized_metadata": bag_metadata([part], [counts], {"recovered": "true"})}
