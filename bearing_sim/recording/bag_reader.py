# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of recordings of any origin: MCAP files, SQLite databases of rosbag2 and bags of ROS 1, also unfinished or damaged ones."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO, NamedTuple

import lz4.frame
import zstandard
from mcap.records import Channel, Schema

from bearing_sim.files.limits import RECORDING_EXPANSION, RECORDING_RECORD, FileError, printable
from bearing_sim.files.reading import open_regular
from bearing_sim.files.tally import Tally
from bearing_sim.messages.definitions import DefinitionError, decoder
from bearing_sim.recording.bag import FREE_EXPANSION, LATEST, RecordingError, by_number, folder_metadata, listed_files, mcap_files, require_listed
from bearing_sim.recording.mcap_format import Message, own_topic
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.ros1_bag import Connection, Ros1Bag
from bearing_sim.recording.sqlite_bag import SqliteBag

_PIECE = 1 << 20  # [byte] that is unpacked at once
_PACKED = {b"\x28\xb5\x2f\xfd": "zstd", b"\x04\x22\x4d\x18": "lz4"}
"""By its first bytes, how a file or a message is compressed; a message in CDR begins with a zero, an MCAP file and a database with others."""
_SUFFIXES = (".zstd", ".zst", ".lz4")  # of files that are compressed as a whole


class BagTopic(NamedTuple):
    """A topic of a recording.

    Attributes
    ----------
    name, ros_type : full topic name, and message type; ``""`` if the recording does not say.  Characters that cannot be printed are escaped.
    decode : ``decode(data)`` returns an object with the fields of the message as attributes; it may raise any exception for damaged data.
    own_name : what the topic is called here, where a node has recorded it under another name (see `mcap_format.own_topic`).
    """

    name: str
    ros_type: str
    decode: Callable[[bytes], object]
    own_name: str = ""


class BagReader:
    """The topics and messages of a recording.

    Iterating yields the messages (topic, log time [ns since the epoch], data) in file order, and each `BagTopic` before its messages, once for
    each file.  Files and messages that are compressed, as rosbag2 can do with either, are unpacked: their first bytes say so, not the metadata.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), an SQLite file (``*.db3``), a ROS 1 bag (``*.bag``), or a bag's folder.

    Attributes
    ----------
    is_foreign : whether it is no MCAP, or compressed as a whole.
    tally : after reading: the messages that were there, those that were left out and why, and where a file ended early.

    Raises
    ------
    RecordingError
        There is no such recording, or it cannot be read.
    """

    def __init__(self, path: str | Path):
        self._path, self.tally = Path(path), Tally()
        self._files = self._foreign_files()
        self.is_foreign = bool(self._files)
        if not self.is_foreign:
            self._files = mcap_files(self._path)

    def __iter__(self) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        self.tally = Tally()
        for file in self._files:
            kind = _plain_name(file)
            read = self._sqlite if kind.endswith(".db3") else self._ros1 if kind.endswith(".bag") else self._mcap
            unpack, used, late = _Unpacking(file, self.tally.notes), 0, 0
            with self._unpacked(file) as plain:
                for item in read(file, plain):
                    if isinstance(item, BagTopic):
                        yield item
                    elif 0 <= item[1] < LATEST:
                        if item[2][:4] in _PACKED and not kind.endswith(".bag"):
                            item = *item[:2], unpack(item[2])
                        used += 1
                        yield item
                    else:
                        late += 1
            self.tally.use(used)
            if late:
                self.tally.refuse("time before 1970 or after 2116", late)

    def _foreign_files(self) -> list[Path]:
        """Return the files of a recording that is no MCAP, or compressed; none of one that is plain MCAP or that does not exist."""
        if self._path.is_file():
            return [self._path] if self._path.suffix in (".db3", ".bag", *_SUFFIXES) else []
        if not self._path.is_dir():
            return []
        files = listed_files(self._path)
        if files is None:
            files = sorted((file for file in self._path.iterdir() if _plain_name(file).endswith((".db3", ".mcap")) and file.is_file()), key=by_number)
            files = [file for file in files if file.suffix == ".db3"] or [file for file in files if ".db3" in file.name] or files
        is_sqlite = any(".db3" in file.name for file in files)
        if not is_sqlite and not any(file.suffix in _SUFFIXES for file in files):
            return []
        require_listed(self._path, files)
        if other := [file.name for file in files if is_sqlite and ".db3" not in file.name]:
            raise RecordingError(f"{self._path}: it has both SQLite and other files ({', '.join(other[:3])}); expected one kind")
        metadata = folder_metadata(self._path) or {}
        if metadata.get("compression_format") not in (None, "", *_PACKED.values()):
            raise RecordingError(f"{self._path}: compressed in a way that is not known; expected zstd or lz4, by file or by message")
        return files

    def _note_end(self, file: Path, why: str) -> None:
        self.tally.unread.append(f"{file.name}: ends early ({why}); the messages before that are used")

    def _mcap(self, file: Path, plain: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        schemas: dict[int, _Type] = {}
        kinds: dict[tuple[str, str, bytes], _Type] = {}  # thousands of schemas may be the same: each is parsed once
        found: dict[int, BagTopic] = {}
        nothing = _Type("", "", b"", self.tally.notes)
        reader = McapReader(plain, stops_at_damage=True)
        for record in reader:
            if isinstance(record, Message):
                if record.channel_id in found:
                    yield found[record.channel_id], record.log_time, record.data
                else:
                    self.tally.refuse("no such channel in the file")
            elif isinstance(record, Schema):
                kind = record.name, record.encoding, bytes(record.data)
                schemas[record.id] = kinds.setdefault(kind, _Type(*kind, self.tally.notes))
            elif isinstance(record, Channel) and record.id not in found:
                found[record.id] = schemas.get(record.schema_id, nothing).topic(record.topic, record.message_encoding)
                if (own := own_topic(record)) != record.topic:
                    found[record.id] = found[record.id]._replace(own_name=printable(own))
                yield found[record.id]
        if not reader.is_finished:
            self._note_end(file, reader.ends)
            if plain == file:
                what = "saves what follows the damage" if reader.damaged else "completes the file"
                self.tally.remedies.append(f"bearing-sim recover {printable(file)} -o GOOD.mcap {what}")

    def _sqlite(self, file: Path, plain: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        bag, types = SqliteBag(plain), {}
        found: dict[int, BagTopic] = {}
        for topic in bag.topics:
            kind = types.setdefault(topic.ros_type, _Type(topic.ros_type, topic.encoding or "ros2msg", topic.definition, self.tally.notes))
            found[topic.number] = kind.topic(topic.name, topic.serialization)
            yield found[topic.number]
        for number, time, data in bag:
            yield found[number], time, data
        if bag.left_out:
            self.tally.refuse("row that is no message", bag.left_out)
        if bag.ends:
            self._note_end(file, bag.ends)

    def _ros1(self, file: Path, plain: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        bag = Ros1Bag(plain)
        found: dict[int, BagTopic] = {}
        for item in bag:
            if isinstance(item, Connection):
                found[item.number] = _Type(item.ros_type, "ros1msg", item.definition, self.tally.notes).topic(item.topic, "cdr")
                yield found[item.number]
            elif item[0] in found:
                yield found[item[0]], *item[1:]
            else:
                self.tally.refuse("no such connection in the file")
        if bag.ends:
            self._note_end(file, bag.ends)

    @contextmanager
    def _unpacked(self, file: Path) -> Iterator[Path]:
        """Yield the path of a file's content: the file itself, or what it unpacks to."""
        try:
            with open_regular(file) as packed:
                how = _PACKED.get(packed.read(4), "")
        except FileError as error:
            raise RecordingError(str(error)) from None
        if not how:
            yield file
            return
        self.tally.notes.append(f"{file.name}: compressed by {how}")
        with TemporaryDirectory(prefix="bearing_sim-") as folder:
            target, left = Path(folder) / (_plain_name(file) or "bag"), FREE_EXPANSION + RECORDING_EXPANSION.value * file.stat().st_size
            size, end = 0, ""
            with open_regular(file) as packed, open(target, "wb") as stream:
                try:
                    for piece in _pieces(packed, how):
                        size += stream.write(piece)
                        if size > left:
                            raise RecordingError(f"{file}: it unpacks to {RECORDING_EXPANSION.refusal()}")
                except (zstandard.ZstdError, RuntimeError, EOFError) as error:  # lz4 raises RuntimeError
                    end = f"it cannot be unpacked to its end: {error}"
            if not size:
                raise RecordingError(f"{file}: nothing of it can be unpacked, so it is cut short or damaged")
            try:
                yield target
            except RecordingError as error:
                raise RecordingError(str(error).replace(str(target), str(file))) from None
            if end:
                self._note_end(file, end)


def _plain_name(file: Path) -> str:
    """Return the name that a file has when it is not compressed."""
    return file.stem if file.suffix in _SUFFIXES else file.name


def _pieces(packed: BinaryIO, how: str) -> Iterator[bytes]:
    """Yield what a stream unpacks to, piece by piece."""
    if how == "zstd":
        yield from zstandard.ZstdDecompressor(max_window_size=RECORDING_RECORD.value).read_to_iter(packed, write_size=_PIECE)
        return
    frame = lz4.frame.LZ4FrameDecompressor()
    while not frame.eof:
        data = packed.read(_PIECE) if frame.needs_input else b""
        if frame.needs_input and not data:
            raise EOFError("it is cut short")
        yield frame.decompress(data, _PIECE)


class _Unpacking:
    """Unpacks the messages of a file that are compressed; data that cannot be unpacked become an empty message.

    Parameters
    ----------
    file : that they are in.
    notes : gets a text that says how they are compressed.
    """

    def __init__(self, file: Path, notes: list[str]):
        self._file, self._left, self._notes = file, FREE_EXPANSION + RECORDING_EXPANSION.value * file.stat().st_size, notes
        self._is_noted = False
        self._decompress = zstandard.ZstdDecompressor().decompress

    def __call__(self, data: bytes) -> bytes:
        """Return an unpacked message."""
        if not self._is_noted:
            self._notes.append(f"{printable(self._file.name)}: its messages are compressed by {_PACKED[data[:4]]}")
            self._is_noted = True
        most = min(self._left, RECORDING_RECORD.value)
        try:
            if _PACKED[data[:4]] == "lz4":
                unpacked = lz4.frame.LZ4FrameDecompressor().decompress(data, most + 1)
                length = len(unpacked)
            else:
                length = zstandard.frame_content_size(data)
                unpacked = self._decompress(data, max_output_size=most if length < 0 else length) if length <= most else b""
        except (zstandard.ZstdError, RuntimeError, EOFError):
            return b""
        if length > most:
            raise RecordingError(f"{self._file}: its messages unpack to {RECORDING_EXPANSION.refusal()}")
        self._left -= len(unpacked)
        return unpacked


class _Type:
    """A message type of a recording, whose definition is parsed once, when the first message is decoded.

    Parameters
    ----------
    name, encoding, definition : see `bearing_sim.messages.definitions.decoder`.
    notes : gets a text if another definition is used.
    """

    def __init__(self, name: str, encoding: str, definition: bytes, notes: list[str]):
        self.name, self._encoding, self._definition, self._notes = name, encoding, definition, notes
        self._decode: Callable[[bytes], object] | None = None
        self._error = ""

    def topic(self, name: str, serialization: str) -> BagTopic:
        """Return a topic of this type."""
        if serialization == "cdr":
            return BagTopic(printable(name), printable(self.name), self.decode)
        return BagTopic(printable(name), printable(self.name), _refusal(printable(name), serialization))

    def _note(self, text: str) -> None:
        if printable(text) not in self._notes:
            self._notes.append(printable(text))

    def decode(self, data: bytes) -> object:
        """Return a decoded message; raise the same error for every message if the definition cannot be used."""
        if self._error:
            raise DefinitionError(self._error)
        if self._decode is None:
            try:
                self._decode = decoder(self.name, self._encoding, self._definition, self._note)
            except DefinitionError as error:
                self._error = str(error)
                raise
        return self._decode(data)


def _refusal(topic: str, serialization: str) -> Callable[[bytes], object]:
    def refuse(data: bytes) -> object:
        raise RecordingError(f"{topic} is encoded as {serialization[:40]!r}; expected cdr")

    return refuse
