# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read MCAP files that may have been cut short or damaged."""

import io
import struct
from collections.abc import Iterator
from pathlib import Path

import zstandard
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, McapRecord, Message
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream

BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, struct.error, UnicodeDecodeError, ValueError, RuntimeError)  # lz4 raises RuntimeError
"""What the mcap library raises on bytes that are no MCAP."""

_MAGIC = b"\x89MCAP0\r\n"
_RECORD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
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

    Attributes
    ----------
    is_mcap : whether it begins as an MCAP file.
    is_finished : whether it has its proper end.
    ends : why reading ended before, or ``""``.
    damaged : chunks and records that could not be read.
    size, read : length of the file and of what was made out [byte].
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.size = self.path.stat().st_size
        self.read = self.damaged = 0
        self.is_finished = False
        self.ends = ""
        with open(self.path, "rb") as stream:
            self.is_mcap = stream.read(len(_MAGIC)) == _MAGIC

    def __iter__(self) -> Iterator[McapRecord]:
        self.read, self.damaged, self.is_finished, self.ends = 0, 0, False, ""
        if not self.is_mcap:
            self.ends = "it does not begin as an MCAP file"
            return
        with open(self.path, "rb") as stream:
            stream.seek(len(_MAGIC))
            self.read, in_data = len(_MAGIC), True
            for opcode, content in self._top_level(stream):
                self.read += _RECORD.size + len(content)
                in_data = in_data and opcode != Opcode.DATA_END
                if in_data:
                    yield from self._contained(opcode, content)
                if opcode == Opcode.FOOTER:
                    self.is_finished = stream.read() == _MAGIC
                    self.ends = "" if self.is_finished else "what follows the footer is not the end of an MCAP file"
                    return

    def _top_level(self, stream) -> Iterator[tuple[int, bytes]]:
        while True:
            head = stream.read(_RECORD.size)
            if len(head) < _RECORD.size:
                self.ends = "it was not completed" if not head else "it ends within a record"
                return
            opcode, length = _RECORD.unpack(head)
            if length > self.size - stream.tell():
                self.ends = "it ends within a record"
                return
            if opcode == 0:
                self.ends = f"there is no record at byte {stream.tell() - _RECORD.size}"
                return
            yield opcode, stream.read(length)

    def _contained(self, opcode: int, content: bytes) -> list[McapRecord]:
        try:
            if opcode == Opcode.CHUNK:
                stream, length = get_chunk_data_stream(Chunk.read(ReadDataStream(io.BytesIO(content))), validate_crc=True)
                return list(_records_of(stream.read(length)))
            return [_parsed(opcode, content)] if opcode in _PARSED or opcode == Opcode.MESSAGE else []
        except BROKEN:
            self.damaged += 1
            return []


def _records_of(data: bytes) -> Iterator[McapRecord]:
    """Yield the records of a chunk's data."""
    place = 0
    while place < len(data):
        opcode, length = _RECORD.unpack_from(data, place)
        place += _RECORD.size
        if length > len(data) - place:
            raise EndOfFile()
        if opcode == Opcode.MESSAGE:
            channel, sequence, log_time, publish_time = _MESSAGE.unpack_from(data, place)
            yield Message(channel, log_time, data[place + _MESSAGE.size : place + length], publish_time, sequence)
        elif opcode in _PARSED:
            yield _parsed(opcode, data[place : place + length])
        place += length


def _parsed(opcode: int, content: bytes) -> McapRecord:
    stream = ReadDataStream(WholeReads(io.BytesIO(content)))
    return Message.read(stream, len(content)) if opcode == Opcode.MESSAGE else _PARSED[opcode].read(stream)
