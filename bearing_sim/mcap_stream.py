# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read MCAP files that may have been cut short or damaged."""

import io
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import zstandard
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, McapRecord, Message
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream

from bearing_sim.message_rows import RECORD, RowFinder, Rows, message_at

BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, struct.error, UnicodeDecodeError, ValueError, RuntimeError)  # lz4 raises RuntimeError
"""What the mcap library raises on bytes that are no MCAP."""

MAGIC = b"\x89MCAP0\r\n"
_CHUNK = struct.Struct("<QQQII")  # first and last log time, size and CRC of the data, length of the compression's name
_BLOCK = 1024 * 1024  # [byte] read at once
_PARSED = {
    Opcode.HEADER: records.Header,
    Opcode.SCHEMA: records.Schema,
    Opcode.CHANNEL: records.Channel,
    Opcode.METADATA: records.Metadata,
    Opcode.ATTACHMENT: records.Attachment,
    Opcode.FOOTER: records.Footer,
}


class WholeReads:
    """A stream that never returns less than asked for: the end of a file cut short shall not pass for data.

    Parameters
    ----------
    stream : a binary file.

    Raises
    ------
    EndOfFile
        By ``read``, where the stream ends before.
    """

    def __init__(self, stream):
        self._stream = stream

    def read(self, length: int) -> bytes:
        """Return exactly ``length`` bytes."""
        data = self._stream.read(length)
        if len(data) < length:
            raise EndOfFile()
        return data


class Salvage:
    """All that can be read of an MCAP file, in its order; a damaged chunk is left out, what comes after it is read.

    Iterate over it for headers, schemas, channels, messages, metadata and attachments; the summary at the end repeats nothing.

    Parameters
    ----------
    path : the file.
    in_rows : whether messages of a topic may come many at once, as `bearing_sim.message_rows.Rows`; none do where absent.

    Attributes
    ----------
    is_mcap : whether it begins as an MCAP file.
    is_finished : whether it has its proper end.
    ends : why reading ended before, or ``""``.
    damaged : chunks and records that could not be read.
    size, read : length of the file and of what was made out [byte].
    """

    def __init__(self, path: str | Path, in_rows: Callable[[str], bool] | None = None):
        self.path, self._in_rows = Path(path), in_rows
        self.size = self.path.stat().st_size
        self.read = self.damaged = 0
        self.is_finished = False
        self.ends = ""
        with open(self.path, "rb") as stream:
            self.is_mcap = stream.read(len(MAGIC)) == MAGIC

    def __iter__(self) -> Iterator[McapRecord | Rows]:
        self._topics: dict[int, str] = {}
        self._finder = None if self._in_rows is None else RowFinder(lambda channel: self._in_rows(self._topics.get(channel, "")))
        self._zstd = zstandard.ZstdDecompressor()
        self.read, self.damaged, self.is_finished, self.ends = 0, 0, False, ""
        if not self.is_mcap:
            self.ends = "it does not begin as an MCAP file"
            return
        with open(self.path, "rb") as stream:
            stream.seek(len(MAGIC))
            self.read, in_data = len(MAGIC), True
            for opcode, content in self._top_level(stream):
                in_data = in_data and opcode != Opcode.DATA_END
                if in_data:
                    yield from self._contained(opcode, content)
                if opcode == Opcode.FOOTER:
                    stream.seek(self.read)
                    self.is_finished = stream.read() == MAGIC
                    self.ends = "" if self.is_finished else "what follows the footer is not the end of an MCAP file"
                    return

    def _top_level(self, stream) -> Iterator[tuple[int, bytes]]:
        """Yield opcode and content of all records but indexes, of which there are many small ones: hence the reading by blocks."""
        block, place = b"", 0

        def has(length: int) -> bool:
            nonlocal block, place
            if len(block) - place < length:
                block, place = block[place:] + stream.read(max(length, _BLOCK)), 0
            return len(block) - place >= length

        while has(RECORD.size):
            opcode, length = RECORD.unpack_from(block, place)
            if opcode == 0:
                self.ends = f"there is no record at byte {self.read}"
                return
            whole = RECORD.size + length
            if self.read + whole > self.size or not has(whole):
                break
            begin, place = place + RECORD.size, place + whole
            self.read += whole
            if opcode != Opcode.MESSAGE_INDEX:
                yield opcode, block[begin:place]
        self.ends = "it was not completed" if self.read == self.size else "it ends within a record"

    def _contained(self, opcode: int, content: bytes) -> list[McapRecord | Rows]:
        try:
            if opcode == Opcode.CHUNK:
                return list(self._records_of(self._chunk_data(content)))
            return [_parsed(opcode, content)] if opcode in _PARSED or opcode == Opcode.MESSAGE else []
        except BROKEN:
            self.damaged += 1
            return []

    def _chunk_data(self, content: bytes) -> bytes:
        *_, size, crc, name_length = _CHUNK.unpack_from(content)
        begin = _CHUNK.size + name_length + 8  # of the records, after their length
        if content[_CHUNK.size : _CHUNK.size + name_length] != b"zstd":
            stream, length = get_chunk_data_stream(Chunk.read(ReadDataStream(WholeReads(io.BytesIO(content)))), validate_crc=True)
            return stream.read(length)
        data = self._zstd.decompress(memoryview(content)[begin:], max_output_size=size)  # the library makes a context for each chunk
        if crc and zlib.crc32(data) != crc:
            raise EndOfFile()
        return data

    def _records_of(self, data: bytes) -> Iterator[McapRecord | Rows]:
        """Yield the records of a chunk's data."""
        place = 0
        while place < len(data):
            if self._finder is not None and (rows := self._finder.rows_at(data, place)) is not None:
                yield rows
                place += rows.table.size
                continue
            opcode, length = RECORD.unpack_from(data, place)
            end = place + RECORD.size + length
            if end > len(data):
                raise EndOfFile()
            if opcode == Opcode.MESSAGE:
                yield message_at(data, place, end)
                if self._finder is not None:
                    self._finder.learn(data, place)
            elif opcode in _PARSED:
                yield (record := _parsed(opcode, data[place + RECORD.size : end]))
                if isinstance(record, records.Channel):
                    self._topics[record.id] = record.topic
            place = end


def _parsed(opcode: int, content: bytes) -> McapRecord:
    stream = ReadDataStream(WholeReads(io.BytesIO(content)))
    return Message.read(stream, len(content)) if opcode == Opcode.MESSAGE else _PARSED[opcode].read(stream)
