# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Records of the MCAP format as bytes: those of the mcap library (`mcap.records`), and messages, of which there are millions, as tuples.

By the specification of MCAP version 0 (https://mcap.dev/spec): a file is a magic number, records, and the magic number again.  A record is
an opcode (1 byte), the length of its content (8 bytes) and the content.  Numbers are little-endian, a string is its length in bytes (4
bytes) and UTF-8 text, a map or array its length in bytes and its entries.  Messages of the file stand in compressed chunks, each followed by an
index for each channel; a summary at the end repeats schemas and channels, counts the messages and says where chunks and metadata stand.

The format has checksums for the messages of a chunk, for the whole data section of a completed file and for its summary, but none for metadata,
indexes and whatever else is outside the chunks of an unfinished file.  `McapWriter` therefore follows whatever it writes by a checksum record of
its own, with an opcode that the specification leaves to applications and that other readers pass over: the bytes between two of them are a section.
"""

import struct
import zlib
from io import BytesIO
from typing import NamedTuple

from mcap import records
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")
"""Head of a record: opcode, and length of its content."""
MESSAGE = struct.Struct("<HIQQ")
"""Head of the content of a message: channel, sequence, log time and publish time [ns since the epoch]."""
INDEX = struct.Struct("<HI")
"""Head of the content of a message index: channel, and length of the entries (log time, offset in the chunk's records; 8 bytes each)."""
CHECKSUM = 0xB5
"""Opcode of a checksum record; more than one bit away from every opcode of the format, so that no flipped bit makes one of another record."""
CHECKSUM_RECORD = struct.Struct("<BQQI")
"""A checksum record: opcode, length of its content, first byte of its section in the file, and CRC-32 of the bytes from there to this record."""
CHECKSUM_HEAD = RECORD.pack(CHECKSUM, CHECKSUM_RECORD.size - RECORD.size)
"""How each checksum record begins."""
PROFILE = "ros2"
OWN_TOPIC = "bearing_sim_topic"
"""Key in the metadata of a channel: what its topic is called here, where a node publishes it under another name."""
_KINDS = {
    Opcode.HEADER: records.Header,
    Opcode.FOOTER: records.Footer,
    Opcode.SCHEMA: records.Schema,
    Opcode.CHANNEL: records.Channel,
    Opcode.CHUNK: records.Chunk,
    Opcode.ATTACHMENT: records.Attachment,
    Opcode.STATISTICS: records.Statistics,
    Opcode.METADATA: records.Metadata,
    Opcode.METADATA_INDEX: records.MetadataIndex,
}


def own_topic(channel: records.Channel) -> str:
    """Return what the topic of a channel is called here, such as ``/cage_slip``; its full name unless a node has recorded it under another."""
    own = channel.metadata.get(OWN_TOPIC, "")
    return f"/{own}" if own else channel.topic


class DamagedRecord(ValueError):
    """Bytes that are not the record that they should be."""


class RefusedRecord(DamagedRecord):
    """A record that is not read although it may be sound, because it exceeds a limit or is in a form that nothing here can read."""


class Message(NamedTuple):
    """One message; times are [ns since the epoch]."""

    channel_id: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


class _Content(ReadDataStream):
    """The content of a record; a field that goes beyond its end is an error."""

    def __init__(self, content: bytes):
        super().__init__(BytesIO(content))
        self._size = len(content)

    def read(self, length: int) -> bytes:
        if length > self._size - self.count:  # before anything of a length such as 2^63 is asked for
            raise EndOfFile
        return super().read(length)


def packed(record: records.McapRecord) -> bytes:
    """Return a record as bytes, with its head."""
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


def checksum_record(begin: int, checksum: int) -> bytes:
    """Return the record that ends the section with this first byte and this CRC-32."""
    return CHECKSUM_RECORD.pack(CHECKSUM, CHECKSUM_RECORD.size - RECORD.size, begin, checksum)


def parsed(opcode: int, content: bytes):
    """Return the record of a kind and content; None for a kind that readers do not use.

    Raises
    ------
    DamagedRecord
        The content is not that of such a record.
    """
    try:
        if opcode == Opcode.MESSAGE:
            return Message(*MESSAGE.unpack_from(content), content[MESSAGE.size :])
        record = _KINDS[opcode].read(_Content(content)) if opcode in _KINDS else None
    except (EndOfFile, struct.error, UnicodeDecodeError) as error:
        raise DamagedRecord(f"a record is not what its kind says: {error!r}") from None
    if opcode == Opcode.ATTACHMENT and int.from_bytes(content[-4:], "little") not in (0, zlib.crc32(content[:-4])):
        raise DamagedRecord("the checksum of an attachment is wrong")
    return record


def chunk_index_places(content: bytes) -> dict[int, int]:
    """Return where the message indexes of a chunk stand in the file, by channel, from the content of its chunk index.

    The index of an hour at 1 kHz has a hundred thousand of them, of which nothing else is needed.
    """
    (length,) = struct.unpack_from("<I", content, 32)
    return dict(struct.iter_unpack("<HQ", content[36 : 36 + length]))


def packed_message(message: Message) -> bytes:
    """Return the record of a message; faster than `packed`."""
    return RECORD.pack(Opcode.MESSAGE, MESSAGE.size + len(message.data)) + MESSAGE.pack(*message[:-1]) + message.data


def message_at(data: bytes, begin: int, end: int) -> Message:
    """Return the message whose record stands in ``data`` from ``begin`` to ``end``."""
    content = begin + RECORD.size
    return Message(*MESSAGE.unpack_from(data, content), data[content + MESSAGE.size : end])
