# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read MCAP files, also those that are unfinished, cut short or damaged, of any writer.

`McapReader` reads a file from end to end, message by message or, where messages repeat, as `Rows`: a recording has the same topics with messages
of the same lengths, sample after sample.  One by one, the messages of an hour at 1 kHz cost minutes in the interpreter; as rows of a table
of bytes, NumPy reads a column of them as fast as memory allows.  `read_index` returns what a finished file says at its end, without reading the rest.
"""

import struct
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

import lz4.frame
import numpy as np
import zstandard
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Header, Metadata, MetadataIndex, Schema, Statistics

from bearing_sim.files.limits import RECORDING_EXPANSION, RECORDING_RECORD, RECORDING_TEXTS, FileError
from bearing_sim.files.reading import open_regular
from bearing_sim.recording.bag import FREE_EXPANSION, RecordingError
from bearing_sim.recording.mcap_format import (
    CHECKSUM_HEAD,
    CHECKSUM_RECORD,
    INDEX,
    MAGIC,
    MESSAGE,
    RECORD,
    DamagedRecord,
    Message,
    RefusedRecord,
    checksum_record,
    chunk_index_places,
    message_at,
    own_topic,
    packed,
    parsed,
)
from bearing_sim.recording.mcap_sections import Section, SectionReader, footer_of, records_in

_HEAD = RECORD.size + 2  # [byte] of a message record that identify its kind: opcode, length, channel
_LOG = RECORD.size + 6  # [byte] of a record before its log time
_DATA = RECORD.size + MESSAGE.size
_REMEMBERED = 64  # messages; longer rows are not found
_MOST_SHAPES = 256
_MOST_REPORTED = 20
_CONTENT = (Header, Schema, Channel, Message, Metadata, Attachment)
_IN_CHUNKS = {Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE}


class Rows(NamedTuple):
    """Messages of some channels that repeat in the same order and lengths.

    Attributes
    ----------
    channels : id of the channel of each message of a row.
    starts : first byte of each record in the row, and the row's length at the end.
    table : the records, uint8, shape (rows, length).
    """

    channels: tuple[int, ...]
    starts: tuple[int, ...]
    table: np.ndarray

    def log_ns(self, k: int) -> np.ndarray:
        """Return the log times of the k-th message of every row [ns since the epoch], uint64."""
        begin = self.starts[k] + _LOG
        return np.ascontiguousarray(self.table[:, begin : begin + 8]).view("<u8")[:, 0]

    def all_log_ns(self) -> np.ndarray:
        """Return the log times of all messages [ns since the epoch], uint64, shape (rows, channels)."""
        places = np.add.outer(np.array(self.starts[:-1]) + _LOG, np.arange(8))
        return np.ascontiguousarray(self.table[:, places]).view("<u8")[:, :, 0]

    def begin(self, k: int) -> int:
        """Return the first byte of the k-th serialised message of a row."""
        return self.starts[k] + _DATA

    def data(self, k: int) -> np.ndarray:
        """Return the k-th serialised message of every row, uint8, shape (rows, length)."""
        return self.table[:, self.begin(k) : self.starts[k + 1]]

    def messages(self) -> Iterator[Message]:
        """Yield the messages one by one, in their order."""
        for row in self.table:
            whole = row.tobytes()
            for start, end in zip(self.starts, self.starts[1:]):
                yield message_at(whole, start, end)


class McapReader:
    """Everything that can be read of an MCAP file, in file order; what is damaged is left out, and what follows it is read.

    Iterate over it for headers, schemas, channels, messages, metadata and attachments (see `bearing_sim.recording.mcap_format`).

    Parameters
    ----------
    path : the file.
    in_rows : whether messages of a topic may come many at once, as `Rows`; none do if absent.
    stops_at_damage : whether to read nothing after the first damaged chunk or record.
    own_topics : whether topics are named as here, whatever a node that recorded them called them (see `mcap_format.own_topic`).

    Attributes
    ----------
    is_finished : whether the file has its proper end.
    ends : why reading ended before that, or ``""``.
    damaged : chunks, records and other parts of the file that are damaged or exceed a limit.
    damage : what the first of them are and where.
    has_checksums : after reading: whether checksums cover all of the file, not only its chunks.
    size, read : length of the file, and how far it was read [byte].
    topics : topic by channel.
    types : message type by topic, as far as read.

    Raises
    ------
    RecordingError
        It is no regular file or does not begin as an MCAP file; while reading, it unpacks to more than the limits allow.
    OSError
        It cannot be read.
    """

    def __init__(
        self,
        path: str | Path,
        in_rows: Callable[[str], bool] | None = None,
        stops_at_damage: bool = False,
        own_topics: bool = False,
    ):
        self.path, self._in_rows, self._stops, self._own_topics = Path(path), in_rows, stops_at_damage, own_topics
        self._decompress = zstandard.ZstdDecompressor().decompress
        with _opened(self.path) as stream:
            self.size = self.path.stat().st_size
            self._restart()
            if stream.read(len(MAGIC)) != MAGIC:
                raise RecordingError(f"{self.path}: not an MCAP file ({self.size} bytes); expected a recording, finished or not")

    def _restart(self) -> None:
        self.read, self.damaged, self.is_finished, self.ends, self.has_checksums = len(MAGIC), 0, False, "", False
        self.damage: list[str] = []
        self.topics: dict[int, str] = {}
        self.types: dict[str, str] = {}
        self._schemas: dict[int, str] = {}
        self._texts, self._unpacked, self._refusal = 0, 0, ""
        self._most_texts = RECORDING_TEXTS.value
        self._finder = None if self._in_rows is None else _RowFinder(lambda channel: self._in_rows(self.topics.get(channel, "")))

    def __iter__(self) -> Iterator[Header | Schema | Channel | Message | Metadata | Attachment | Rows]:
        self._restart()
        with _opened(self.path) as stream:
            unneeded = {Opcode.MESSAGE_INDEX, *({Opcode.ATTACHMENT} if self._stops else ())}
            sections = SectionReader(stream, self.size, self._report, unneeded)
            for section in sections:
                self.read = sections.read
                if not (self.damaged and self._stops):
                    yield from self._contained(section)
                if self.damaged and self._stops:
                    self.ends = self._refusal or f"what follows is damaged: {self.damage[0]}"
                    return
            self.read, self.is_finished, self.ends = sections.read, sections.is_finished, sections.ends
            self.has_checksums = sections.has_checksums

    def _report(self, text: str, is_refused: bool = False) -> None:
        """Count something damaged or, if it is refused, something that exceeds a limit; note the first ones."""
        self.damaged += 1
        if is_refused and not self._refusal:
            self._refusal = text
        if len(self.damage) < _MOST_REPORTED:
            self.damage.append(text)

    def _contained(self, section: Section) -> Iterator:
        """Yield the records of a section that can be used: if it is not sound, only those of chunks with a right checksum."""
        for opcode, content in records_in(section.data):
            if not section.is_sound and opcode != Opcode.CHUNK:
                continue
            try:
                record = parsed(opcode, content)
                if isinstance(record, Chunk):
                    yield from self._records_of(self._decompressed(record, needs_checksum=not section.is_sound))
                else:
                    yield from self._noted(record, len(content))
            except DamagedRecord as error:
                if section.is_sound:  # otherwise it has been reported
                    self._report(str(error), isinstance(error, RefusedRecord))

    def _noted(self, record, length: int) -> list:
        """Return a record of a length [byte] as a list, empty if it is of no use here; remember what later ones refer to."""
        if isinstance(record, Schema) and record.id in self._schemas or isinstance(record, Channel) and record.id in self.topics:
            return []  # a repetition
        self._texts += length if isinstance(record, (Metadata, Schema, Channel)) else 0
        if self._texts > self._most_texts:
            raise RecordingError(f"{self.path}: it has {RECORDING_TEXTS.refusal()}")
        if isinstance(record, Schema):
            self._schemas[record.id] = record.name
        elif isinstance(record, Channel):
            topic = self.topics[record.id] = own_topic(record) if self._own_topics else record.topic
            self.types[topic] = self._schemas.get(record.schema_id, "")
        return [record] if isinstance(record, _CONTENT) else []

    def _decompressed(self, chunk: Chunk, needs_checksum: bool) -> bytes:
        """Return the records of a chunk, checked; ``needs_checksum`` if one that states no checksum cannot be trusted."""
        if chunk.compression not in ("zstd", "lz4", ""):
            raise RefusedRecord(f"a chunk is compressed by {chunk.compression[:40]!r}; expected zstd, lz4 or no compression")
        if chunk.uncompressed_size > RECORDING_RECORD.value:
            raise RefusedRecord(f"a chunk unpacks to {RECORDING_RECORD.refusal(chunk.uncompressed_size)}")
        data = self._unpack(chunk)
        accepted = {zlib.crc32(data)} if needs_checksum else {0, zlib.crc32(data)}
        if len(data) != chunk.uncompressed_size or chunk.uncompressed_crc not in accepted:
            raise DamagedRecord("the checksum of a chunk is wrong")
        if not chunk.uncompressed_crc:  # then only its structure tells damage
            _check_records(data)
        return data

    def _unpack(self, chunk: Chunk) -> bytes:
        """Return the content of a chunk, whose size is within the limit; nothing longer is ever unpacked, whatever the compressed data say."""
        if not chunk.compression:
            return chunk.data
        try:
            is_zstd = chunk.compression == "zstd"
            if is_zstd and zstandard.frame_content_size(chunk.data) not in (-1, chunk.uncompressed_size):  # -1: the frame does not say
                raise DamagedRecord("a chunk is not as long as it says")
            self._unpacked += chunk.uncompressed_size
            if self._unpacked > FREE_EXPANSION + RECORDING_EXPANSION.value * self.size:
                raise RecordingError(f"{self.path}: its chunks unpack to {RECORDING_EXPANSION.refusal()}")
            if not is_zstd:
                return lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, chunk.uncompressed_size + 1)
            return self._decompress(chunk.data, max_output_size=chunk.uncompressed_size)
        except (zstandard.ZstdError, RuntimeError, EOFError) as error:  # lz4 raises RuntimeError
            raise DamagedRecord(str(error)) from None

    def _records_of(self, data: bytes) -> Iterator:
        at = 0
        while at < len(data):
            if self._finder is not None and (rows := self._finder.rows_at(data, at)) is not None:
                yield rows
                at += rows.table.size
                continue
            end = _end_of_record(data, at)
            if data[at] not in _IN_CHUNKS:
                raise DamagedRecord("a chunk contains a record of another kind")
            if data[at] == Opcode.MESSAGE:
                yield message_at(data, at, end)
                if self._finder is not None:
                    self._finder.learn(data, at)
            else:
                yield from self._noted(parsed(data[at], data[at + RECORD.size : end]), end - at)
            at = end


def _opened(path: Path) -> BinaryIO:
    try:
        return open_regular(path)
    except FileError as error:
        raise RecordingError(f"{error}; expected an MCAP file") from None


def _check_records(data: bytes) -> None:
    """Raise `DamagedRecord` unless records that a chunk may have follow each other from its beginning to its end."""
    at = 0
    while at < len(data):
        if data[at] not in _IN_CHUNKS:
            raise DamagedRecord("a chunk contains a record of another kind")
        at = _end_of_record(data, at)


def _end_of_record(data: bytes, at: int) -> int:
    """Return the byte after the record that begins at a byte."""
    end = len(data) + 1
    if at + RECORD.size <= len(data):
        opcode, length = RECORD.unpack_from(data, at)
        end = at + RECORD.size + length
        if opcode == Opcode.MESSAGE and length < MESSAGE.size:
            end = len(data) + 1
    if end > len(data):
        raise DamagedRecord("a chunk ends within a record")
    return end


class _RowFinder:
    """Finds rows in the records of chunks, by the order and the lengths of the messages before.

    Parameters
    ----------
    wanted : whether messages of a channel may come in rows.
    """

    def __init__(self, wanted: Callable[[int], bool]):
        self._wanted = wanted
        self._shapes: dict[bytes, _Shape] = {}
        self._recent: list[bytes] = []

    def rows_at(self, data: bytes, at: int) -> Rows | None:
        """Return the rows that begin at a byte, as many as follow each other; None if there are none of a known shape."""
        shape = self._shapes.get(data[at : at + _HEAD])
        rows = None if shape is None else shape.rows_at(data, at)
        if rows is not None:
            self._recent.clear()
        return rows

    def learn(self, data: bytes, at: int) -> None:
        """Note a message that came alone."""
        head = data[at : at + _HEAD]
        if not self._wanted(int.from_bytes(head[RECORD.size :], "little")):
            return
        if head in self._recent:
            if len(self._shapes) == _MOST_SHAPES:
                self._shapes.clear()
            self._shapes[head] = _Shape(self._recent[self._recent.index(head) :])
            self._recent.clear()
        self._recent = [*self._recent[1 - _REMEMBERED :], head]


class _Shape:
    """Order and lengths of the messages of a row."""

    def __init__(self, heads: Sequence[bytes]):
        lengths = [RECORD.size + RECORD.unpack_from(head)[1] for head in heads]
        self._channels = tuple(int.from_bytes(head[RECORD.size :], "little") for head in heads)
        self._starts = (0, *np.cumsum(lengths).tolist())
        self._places = np.concatenate([start + np.arange(_HEAD) for start in self._starts[:-1]])
        self._heads = np.frombuffer(b"".join(heads), np.uint8)

    def rows_at(self, data: bytes, at: int) -> Rows | None:
        size = self._starts[-1]
        table = np.frombuffer(data, np.uint8, offset=at)
        table = table[: len(table) // size * size].reshape(-1, size)
        fits = (table[:, self._places] == self._heads).all(axis=1)
        count = len(fits) if fits.all() else int(fits.argmin())
        return Rows(self._channels, self._starts, table[:count]) if count else None


class FileIndex(NamedTuple):
    """What a file contains.

    Attributes
    ----------
    types : message type by topic, named as here (see `mcap_format.own_topic`).
    present : topics that have messages.
    metadata : metadata records by name.
    log_ns : log times of the messages of the topic asked for [ns since the epoch], uint64.
    """

    types: dict[str, str]
    present: set[str]
    metadata: dict[str, dict[str, str]]
    log_ns: np.ndarray


def read_index(path: str | Path, topic: str) -> FileIndex | None:
    """Return what a finished file says at its end; None if the file is unfinished, or its index does not cover all messages.

    Parameters
    ----------
    path : the file.
    topic : whose log times are wanted.

    Raises
    ------
    OSError
        It cannot be read.
    """
    with _opened(Path(path)) as stream:
        try:
            return _index(stream, Path(path).stat().st_size, topic)
        except (ValueError, struct.error, OverflowError):  # numbers that make no sense in a file like this
            return None


def _index(stream: BinaryIO, size: int, topic: str) -> FileIndex | None:
    found: dict[type, list] = {kind: [] for kind in (Schema, Channel, Statistics, MetadataIndex)}
    chunks: list[dict[int, int]] = []
    summary, at = _summary(stream, size), 0
    while at < len(summary):
        end = _end_of_record(summary, at)
        content = summary[at + RECORD.size : end]
        if summary[at] == Opcode.CHUNK_INDEX:
            chunks.append(chunk_index_places(content))
        elif type(record := parsed(summary[at], content)) in found:
            found[type(record)].append(record)
        at = end
    schemas = {schema.id: schema.name for schema in found[Schema]}
    topics = {channel.id: own_topic(channel) for channel in found[Channel]}
    counts = Counter({channel: count for each in found[Statistics] for channel, count in each.channel_message_counts.items()})
    if counts.total() != sum(each.message_count for each in found[Statistics]):
        return None
    wanted = {channel for channel, name in topics.items() if name == topic}
    places = [place for chunk in chunks for channel, place in chunk.items() if channel in wanted]
    log_ns = _log_times(stream, size, places, wanted)
    if len(log_ns) != sum(counts[channel] for channel in wanted):
        return None
    return FileIndex(
        {topics[channel.id]: schemas.get(channel.schema_id, "") for channel in found[Channel]},
        {topics[channel] for channel, count in counts.items() if count and channel in topics},
        _metadata(stream, size, found[MetadataIndex]),
        log_ns,
    )


def _metadata(stream: BinaryIO, size: int, indexes: Iterable[MetadataIndex]) -> dict[str, dict[str, str]]:
    """Return the metadata records that a summary lists, by name."""
    found, length = {}, 0
    for index in indexes:
        content = _content_at(stream, size, index.offset, Opcode.METADATA)
        length += len(content)
        if length > min(size, RECORDING_TEXTS.value):
            raise DamagedRecord("the summary lists more metadata than the file has")
        if RECORD.size + len(content) != index.length:
            raise DamagedRecord("a metadata record has another length than the summary says")
        _verify_section(stream, index.offset, content)
        found[index.name] = parsed(Opcode.METADATA, content).metadata
    return found


def _summary(stream: BinaryIO, size: int) -> bytes:
    """Return the records of the summary, checked."""

    def read(begin: int, end: int) -> bytes:
        stream.seek(begin)
        return stream.read(end - begin)

    footer = footer_of(read, size)
    if footer is None or footer.summary_start == 0:
        raise DamagedRecord("it has no summary")
    if size - footer.summary_start > RECORDING_RECORD.value:
        raise DamagedRecord("its summary exceeds the limit")
    checked = read(footer.summary_start, size - len(MAGIC) - 4)  # up to the checksum in the footer
    if footer.summary_crc not in (0, zlib.crc32(checked)):
        raise DamagedRecord("the checksum of the summary is wrong")
    return checked[: 4 - len(packed(footer))]


def _log_times(stream: BinaryIO, size: int, places: Iterable[int], channels: set[int]) -> np.ndarray:
    """Return the log times that the message indexes of some channels list; these stand at ``places``."""
    parts, length = [np.empty(0, np.uint64)], 0
    for place in places:
        content = _content_at(stream, size, place, Opcode.MESSAGE_INDEX)
        length += len(content)
        if length > size:
            raise DamagedRecord("the summary lists more indexes than the file has")
        channel, extent = INDEX.unpack_from(content)
        if channel not in channels or extent != len(content) - INDEX.size:
            raise DamagedRecord("an index is not where the summary says")
        parts.append(np.frombuffer(content, "<u8", offset=INDEX.size)[::2])
    return np.concatenate(parts)


def _verify_section(stream: BinaryIO, begin: int, content: bytes) -> None:
    """Verify a metadata record that the stream has just read, if it has a section of its own, which begins at that byte of the file."""
    record = stream.read(CHECKSUM_RECORD.size)
    if record.startswith(CHECKSUM_HEAD):
        checksum = zlib.crc32(content, zlib.crc32(RECORD.pack(Opcode.METADATA, len(content))))
        if record != checksum_record(begin, checksum):
            raise DamagedRecord("the checksum of a metadata record is wrong")


def _content_at(stream: BinaryIO, size: int, offset: int, expected: Opcode) -> bytes:
    """Return the content of a record of the file, which has that size [byte]."""
    stream.seek(offset)
    head = stream.read(RECORD.size)
    opcode, length = RECORD.unpack(head)
    content = stream.read(length) if opcode == expected and length < size else b""
    if opcode != expected or len(content) < length:
        raise DamagedRecord("a record is not where the summary says")
    return content
