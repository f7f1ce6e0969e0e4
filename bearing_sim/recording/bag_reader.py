# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of recordings of any origin: MCAP files, SQLite databases of rosbag2 and bags of ROS 1, also unfinished or damaged ones."""

import io
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
from bearing_sim.messages.definitions import DefinitionError, decoder, ros2_name
from bearing_sim.recording.bag import (
    FREE_EXPANSION,
    LATEST,
    PACKED_SUFFIXES,
    RecordingError,
    folder_metadata,
    mcap_files,
    plain_name,
    recording_files,
)
from bearing_sim.recording.foreign_formats import EndsEarly, ForeignTopic, Item, ros1_items, sqlite_items
from bearing_sim.recording.mcap_format import Message, own_topic
from bearing_sim.recording.mcap_reader import McapReader

_PIECE = 1 << 17  # [byte] that is unpacked at once; zstandard takes several times as long for a small message where more is made ready
_PACKED = {b"\x28\xb5\x2f\xfd": "zstd", b"\x04\x22\x4d\x18": "lz4"}
"""By its first bytes, how a file or a message is compressed; a message in CDR begins with a zero, an MCAP file and a database with others."""
_UNPACKED_BY = {b"\x1f\x8b": "gunzip -k", b"BZh": "bunzip2 -k", b"\xfd7zXZ": "unxz -k", b"PK\x03\x04": "unzip", b"7z\xbc\xaf": "7z x"}
"""Commands that unpack what is not unpacked here, by first bytes."""
_UNKNOWN = {".db3": "row that is no message", ".bag": "no such connection in the file", "": "no such channel in the file"}


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
        path, self.tally = Path(path), Tally()
        self._files = recording_files(path)
        self.is_foreign = any(file.suffix in (".db3", ".bag", *PACKED_SUFFIXES) for file in self._files) or path.is_file() and _is_packed(path)
        if not self.is_foreign:
            self._files = mcap_files(path)
        elif path.is_dir() and (folder_metadata(path) or {}).get("compression_format") not in (None, "", *_PACKED.values()):
            raise RecordingError(f"{path}: compressed in a way that is not known; expected zstd or lz4, by file or by message")

    def __iter__(self) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        self.tally = Tally()
        for file in self._files:
            suffix = Path(plain_name(file)).suffix
            used, late, unknown, left = 0, 0, 0, _most_unpacked(file)
            kinds: dict[tuple[str, str, bytes], _Type] = {}  # thousands of types may be the same: each is parsed once
            found: dict[int, BagTopic] = {}
            with self._unpacked(file) as plain:
                items = sqlite_items(plain) if suffix == ".db3" else ros1_items(plain) if suffix == ".bag" else self._mcap_items(file, plain)
                try:
                    for item in items:
                        if isinstance(item, ForeignTopic):
                            kind = item.ros_type, item.encoding, item.definition
                            kinds.setdefault(kind, _Type(*kind, self.tally.notes))
                            found[item.number] = kinds[kind].topic(item)
                            yield found[item.number]
                        elif item[0] not in found:
                            unknown += 1
                        elif not 0 <= item[1] < LATEST:
                            late += 1
                        else:
                            number, time, data = item
                            if suffix != ".bag" and (how := _PACKED.get(data[:4])):
                                data = _unpacked_message(file, data, how, left)
                                left -= len(data)
                                self._note(f"{printable(file.name)}: its messages are compressed by {how}")
                            used += 1
                            yield found[number], time, data
                except EndsEarly as error:
                    self._note_end(file, str(error))
            self.tally.use(used)
            for count, reason in ((unknown, _UNKNOWN.get(suffix, _UNKNOWN[""])), (late, "time before 1970 or after 2116")):
                if count:
                    self.tally.refuse(reason, count)

    def _note(self, text: str) -> None:
        if text not in self.tally.notes:
            self.tally.notes.append(text)

    def _note_end(self, file: Path, why: str) -> None:
        self.tally.unread.append(f"{file.name}: ends early ({why}); the messages before that are used")

    def _mcap_items(self, file: Path, plain: Path) -> Iterator[Item]:
        schemas: dict[int, Schema] = {}
        known = set()
        reader = McapReader(plain, stops_at_damage=True)
        for record in reader:
            if isinstance(record, Message):
                yield record.channel_id, record.log_time, record.data
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in known:
                known.add(record.id)
                kind = schemas.get(record.schema_id, Schema(data=b"", encoding="ros2msg", id=0, name=""))
                own = own_topic(record)
                own = "" if own == record.topic else printable(own)
                yield ForeignTopic(record.id, record.topic, kind.name, record.message_encoding, kind.encoding, bytes(kind.data), own)
        if not reader.is_finished:
            self._note_end(file, reader.ends)
            if plain == file:
                what = "saves what follows the damage" if reader.damaged else "completes the file"
                self.tally.remedies.append(f"bearing-sim recover {printable(file)} -o GOOD.mcap {what}")

    @contextmanager
    def _unpacked(self, file: Path) -> Iterator[Path]:
        """Yield the path of a file's content: the file itself, or what it unpacks to."""
        how = _PACKED.get(_first_bytes(file)[:4], "")
        if not how:
            yield file
            return
        self.tally.notes.append(f"{file.name}: compressed by {how}")
        with TemporaryDirectory(prefix="bearing_sim-") as folder:
            target = Path(folder) / (plain_name(file) or "bag")
            with open_regular(file) as packed, open(target, "wb") as stream:
                end = _unpack(packed, how, stream, _most_unpacked(file), f"{file}: it unpacks")
                if not stream.tell():
                    raise RecordingError(f"{file}: nothing of it can be unpacked, so it is cut short or damaged")
            try:
                yield target
            except RecordingError as error:
                raise RecordingError(str(error).replace(str(target), str(file))) from None
            if end:
                self._note_end(file, end)


def _unpack(packed: BinaryIO, how: str, target: BinaryIO, most: int, what: str) -> str:
    """Unpack a stream into another; return why it cannot be unpacked to its end, or ``""``.

    Raises
    ------
    RecordingError
        ``what`` unpacks to more than so many bytes.
    """
    try:
        for piece in _pieces(packed, how):
            target.write(piece)
            if target.tell() > most:
                raise RecordingError(f"{what} to {RECORDING_EXPANSION.refusal()}")
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:  # lz4 raises RuntimeError
        return f"it cannot be unpacked to its end: {error}"
    return ""


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


def _first_bytes(file: Path) -> bytes:
    try:
        with open_regular(file) as stream:
            return stream.read(8)
    except FileError as error:
        raise RecordingError(str(error)) from None


def _is_packed(file: Path) -> bool:
    """Return whether a file is compressed in a way that is unpacked here; refuse others with the command that unpacks them."""
    begin = _first_bytes(file)
    for magic, command in _UNPACKED_BY.items():
        if begin.startswith(magic):
            raise RecordingError(f"{file}: compressed in a way that is not read here; unpack it first, for example by: {command} {printable(file)}")
    return begin[:4] in _PACKED


def _most_unpacked(file: Path) -> int:
    return FREE_EXPANSION + RECORDING_EXPANSION.value * file.stat().st_size


def _unpacked_message(file: Path, data: bytes, how: str, left: int) -> bytes:
    """Return a compressed message of at most ``left`` bytes; an empty one if it cannot be unpacked."""
    target = io.BytesIO()
    end = _unpack(io.BytesIO(data), how, target, min(left, RECORDING_RECORD.value), f"{file}: its messages unpack")
    return b"" if end else target.getvalue()


class _Type:
    """A message type of a recording, whose definition is parsed once, when the first message is decoded.

    Parameters
    ----------
    name, encoding, definition : see `bearing_sim.messages.definitions.decoder`.
    notes : gets a text if another definition is used.
    """

    def __init__(self, name: str, encoding: str, definition: bytes, notes: list[str]):
        self._given, self._notes = (ros2_name(name), encoding, definition), notes
        self._decode: Callable[[bytes], object] | None = None

    def topic(self, item: ForeignTopic) -> BagTopic:
        """Return a topic of this type."""
        name, serialization = printable(item.name), item.serialization
        is_read = serialization == "cdr" or (serialization, item.encoding) == ("ros1", "ros1msg")
        refusal = _raiser(RecordingError(f"{name} is encoded as {serialization[:40]!r}; expected cdr"))
        return BagTopic(name, printable(self._given[0]), self.decode if is_read else refusal, item.own_name)

    def _note(self, text: str) -> None:
        if printable(text) not in self._notes:
            self._notes.append(printable(text))

    def decode(self, data: bytes) -> object:
        """Return a decoded message; raise the same error for every message if the definition cannot be used."""
        if self._decode is None:
            try:
                self._decode = decoder(*self._given, self._note)
            except DefinitionError as error:
                self._decode = _raiser(error)
        return self._decode(data)


def _raiser(error: Exception) -> Callable[[bytes], object]:
    """Return a function of messages that raises an error."""

    def refuse(data: bytes) -> object:
        raise error.with_traceback(None)

    return refuse
