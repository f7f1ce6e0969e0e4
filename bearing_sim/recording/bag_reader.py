# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of recordings of any origin: MCAP files, SQLite databases of rosbag2 and bags of ROS 1, also unfinished or damaged ones."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import zstandard
from mcap.records import Channel, Schema

from bearing_sim.files.limits import RECORDING_EXPANSION, RECORDING_RECORD, FileError, printable
from bearing_sim.files.reading import open_regular
from bearing_sim.messages.definitions import DefinitionError, decoder
from bearing_sim.recording.bag import FREE_EXPANSION, LATEST, RecordingError, folder_metadata, listed_files, mcap_files, require_listed
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.ros1_bag import Connection, Ros1Bag
from bearing_sim.recording.sqlite_bag import SqliteBag

_PIECE = 1 << 20  # [byte] that is unpacked at once


class BagTopic(NamedTuple):
    """A topic of a recording.

    Attributes
    ----------
    name, ros_type : full topic name, and message type; ``""`` if the recording does not say.  Characters that cannot be printed are escaped.
    decode : ``decode(data)`` returns an object with the fields of the message as attributes; it may raise any exception for damaged data.
    """

    name: str
    ros_type: str
    decode: Callable[[bytes], object]


class BagReader:
    """The topics and messages of a recording.

    Iterating yields the messages (topic, log time [ns since the epoch], data) in file order, and each `BagTopic` before its messages, once for
    each file.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), an SQLite file (``*.db3``), a ROS 1 bag (``*.bag``), or a bag's folder.

    Attributes
    ----------
    is_foreign : whether it is no MCAP.
    unfinished : after reading: why a file ended early or what of it was left out, or ``""``.

    Raises
    ------
    RecordingError
        There is no such recording, or it cannot be read.
    """

    def __init__(self, path: str | Path):
        self._path, self.unfinished = Path(path), ""
        self._compression = ""
        self._files = self._foreign_files()
        self.is_foreign = bool(self._files)
        if not self.is_foreign:
            self._files = mcap_files(self._path)

    def __iter__(self) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        self.unfinished = ""
        for file in self._files:
            read = self._mcap if not self.is_foreign else self._ros1 if file.suffix == ".bag" else self._sqlite
            late = 0
            for item in read(file):
                if isinstance(item, BagTopic) or 0 <= item[1] < LATEST:
                    yield item
                else:
                    late += 1
            if late:
                self._note(file, f"{late} messages with times before 1970 or after 2116 are left out")

    def _foreign_files(self) -> list[Path]:
        """Return the files of a recording that is no MCAP; none of one that is or that does not exist."""
        if self._path.is_file():
            return [self._path] if self._path.suffix in (".db3", ".bag") else []
        if not self._path.is_dir():
            return []
        listed = listed_files(self._path)
        files = listed if listed is not None else sorted(self._path.glob("*.db3"))
        if not any(".db3" in file.name for file in files):
            return []
        require_listed(self._path, files)
        if other := [file.name for file in files if ".db3" not in file.name]:
            raise RecordingError(f"{self._path}: it has both SQLite and other files ({', '.join(other[:3])}); expected one kind")
        metadata = folder_metadata(self._path) or {}
        self._compression = str(metadata.get("compression_mode") or "").lower() if metadata.get("compression_format") else ""
        if self._compression not in ("", "none", "file", "message") or metadata.get("compression_format") not in (None, "", "zstd"):
            raise RecordingError(f"{self._path}: compressed in a way that is not known; expected zstd by file or by message")
        return files

    def _note(self, file: Path, text: str) -> None:
        self.unfinished = "; ".join(filter(None, (self.unfinished, f"{file.name}: {text}")))

    def _note_end(self, file: Path, why: str) -> None:
        self._note(file, f"ends early ({why}); the messages before that are used")

    def _mcap(self, file: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        schemas: dict[int, _Type] = {}
        kinds: dict[tuple[str, str, bytes], _Type] = {}  # thousands of schemas may be the same: each is parsed once
        found: dict[int, BagTopic] = {}
        nothing = _Type("", "", b"")
        reader = McapReader(file, stops_at_damage=True)
        for record in reader:
            if isinstance(record, Message):
                if record.channel_id in found:
                    yield found[record.channel_id], record.log_time, record.data
            elif isinstance(record, Schema):
                kind = record.name, record.encoding, bytes(record.data)
                schemas[record.id] = kinds.setdefault(kind, _Type(*kind))
            elif isinstance(record, Channel) and record.id not in found:
                found[record.id] = schemas.get(record.schema_id, nothing).topic(record.topic, record.message_encoding)
                yield found[record.id]
        if not reader.is_finished:
            self._note_end(file, reader.ends)

    def _sqlite(self, file: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        with self._unpacked(file) as database:
            bag, types = SqliteBag(database), {}
            found: dict[int, BagTopic] = {}
            for topic in bag.topics:
                kind = types.setdefault(topic.ros_type, _Type(topic.ros_type, topic.encoding or "ros2msg", topic.definition))
                found[topic.number] = kind.topic(topic.name, topic.serialization)
                yield found[topic.number]
            unpack = self._unpacking(database.stat().st_size) if self._compression == "message" else None
            for number, time, data in bag:
                yield found[number], time, data if unpack is None else unpack(data)
        if bag.left_out:
            self._note(file, f"{bag.left_out} rows that are no messages are left out")
        if bag.ends:
            self._note_end(file, bag.ends)

    def _ros1(self, file: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        bag = Ros1Bag(file)
        found: dict[int, BagTopic] = {}
        for item in bag:
            if isinstance(item, Connection):
                found[item.number] = _Type(item.ros_type, "ros1msg", item.definition).topic(item.topic, "cdr")
                yield found[item.number]
            elif item[0] in found:
                yield found[item[0]], *item[1:]
        if bag.ends:
            self._note_end(file, bag.ends)

    @contextmanager
    def _unpacked(self, file: Path) -> Iterator[Path]:
        """Yield the path of a database: the file itself, or what it unpacks to."""
        if self._compression != "file":
            yield file
            return
        with TemporaryDirectory(prefix="bearing_sim-") as folder:
            target, left = Path(folder) / "bag.db3", FREE_EXPANSION + RECORDING_EXPANSION.value * file.stat().st_size
            try:
                with open_regular(file) as packed, open(target, "wb") as stream:
                    for piece in zstandard.ZstdDecompressor(max_window_size=RECORDING_RECORD.value).read_to_iter(packed, write_size=_PIECE):
                        left -= len(piece)
                        if left < 0:
                            raise RecordingError(f"{file}: it unpacks to {RECORDING_EXPANSION.refusal()}")
                        stream.write(piece)
            except zstandard.ZstdError as error:
                raise RecordingError(f"{file}: cannot be unpacked: {error}") from None
            except FileError as error:
                raise RecordingError(str(error)) from None
            yield target

    def _unpacking(self, size: int) -> Callable[[bytes], bytes]:
        """Return a function that unpacks messages of a file of a size [byte]; data that cannot be unpacked become an empty message."""
        decompress, left = zstandard.ZstdDecompressor().decompress, FREE_EXPANSION + RECORDING_EXPANSION.value * size

        def unpack(data: bytes) -> bytes:
            nonlocal left
            try:
                length = zstandard.frame_content_size(data)
                if length > min(left, RECORDING_RECORD.value):
                    raise RecordingError(f"{self._path}: its messages unpack to {RECORDING_EXPANSION.refusal()}")
                unpacked = decompress(data, max_output_size=min(left, RECORDING_RECORD.value) if length < 0 else length)
            except zstandard.ZstdError:
                return b""
            left -= len(unpacked)
            return unpacked

        return unpack


class _Type:
    """A message type of a recording, whose definition is parsed once, when the first message is decoded.

    Parameters
    ----------
    name, encoding, definition : see `bearing_sim.messages.definitions.decoder`.
    """

    def __init__(self, name: str, encoding: str, definition: bytes):
        self.name, self._encoding, self._definition = name, encoding, definition
        self._decode: Callable[[bytes], object] | None = None
        self._error = ""

    def topic(self, name: str, serialization: str) -> BagTopic:
        """Return a topic of this type."""
        if serialization == "cdr":
            return BagTopic(printable(name), printable(self.name), self.decode)
        return BagTopic(printable(name), printable(self.name), _refusal(printable(name), serialization))

    def decode(self, data: bytes) -> object:
        """Return a decoded message; raise the same error for every message if the definition cannot be used."""
        if self._error:
            raise DefinitionError(self._error)
        if self._decode is None:
            try:
                self._decode = decoder(self.name, self._encoding, self._definition)
            except DefinitionError as error:
                self._error = str(error)
                raise
        return self._decode(data)


def _refusal(topic: str, serialization: str) -> Callable[[bytes], object]:
    def refuse(data: bytes) -> object:
        raise RecordingError(f"{topic} is encoded as {serialization[:40]!r}; expected cdr")

    return refuse
