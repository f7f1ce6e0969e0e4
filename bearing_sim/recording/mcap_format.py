# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Records of the MCAP format, packed and parsed.

By the specification of MCAP version 0 (https://mcap.dev/spec): a file is a magic number, records, and the magic number again.  A record is
an opcode (1 byte), the length of its content (8 bytes) and the content.  Numbers are little-endian, a string is its length in bytes (4
bytes) and UTF-8 text, a map or array its length in bytes and its entries.  Messages of the file stand in compressed chunks, each followed by an
index for each channel; a summary at the end repeats schemas and channels, counts the messages and says where chunks and metadata stand.
"""

import struct
import zlib
from enum import IntEnum
from typing import NamedTuple

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")
"""Head of a record: opcode, and length of its content."""
MESSAGE = struct.Struct("<HIQQ")
"""Head of the content of a message: channel, sequence, log time and publish time [ns since the epoch]."""
INDEX = struct.Struct("<HI")
"""Head of the content of a message index: channel, and length of the entries (log time, offset in the chunk's records; 8 bytes each)."""
PROFILE = "ros2"


class Opcode(IntEnum):
    """Kind of a record."""

    HEADER = 0x01
    FOOTER = 0x02
    SCHEMA = 0x03
    CHANNEL = 0x04
    MESSAGE = 0x05
    CHUNK = 0x06
    MESSAGE_INDEX = 0x07
    CHUNK_INDEX = 0x08
    ATTACHMENT = 0x09
    ATTACHMENT_INDEX = 0x0A
    STATISTICS = 0x0B
    METADATA = 0x0C
    METADATA_INDEX = 0x0D
    SUMMARY_OFFSET = 0x0E
    DATA_END = 0x0F


class DamagedRecord(ValueError):
    """Bytes that are not the record that they should be."""


class Header(NamedTuple):
    """Profile of the file, and the library that wrote it."""

    profile: str
    library: str


class Footer(NamedTuple):
    """Where the summary and its offset records begin, and the CRC of the summary."""

    summary_start: int
    summary_offset_start: int
    summary_crc: int


class Schema(NamedTuple):
    """Definition of a message type."""

    id: int
    name: str
    encoding: str
    data: bytes


class Channel(NamedTuple):
    """A topic of messages of one schema; schema 0 stands for none."""

    id: int
    schema_id: int
    topic: str
    message_encoding: str
    metadata: dict[str, str]


class Message(NamedTuple):
    """One message; times are [ns since the epoch]."""

    channel_id: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


class Chunk(NamedTuple):
    """Compressed records, with the first and last log time of their messages, and their length and CRC before compression."""

    message_start_time: int
    message_end_time: int
    uncompressed_size: int
    uncompressed_crc: int
    compression: str
    records: bytes


class ChunkIndex(NamedTuple):
    """Where a chunk and its message indexes stand in the file; ``message_index_offsets`` by channel."""

    message_start_time: int
    message_end_time: int
    chunk_start_offset: int
    chunk_length: int
    message_index_offsets: dict[int, int]
    message_index_length: int
    compression: str
    compressed_size: int
    uncompressed_size: int


class Attachment(NamedTuple):
    """A file within the file; the CRC is that of the content before it, or 0."""

    log_time: int
    create_time: int
    name: str
    media_type: str
    data: bytes
    crc: int


class AttachmentIndex(NamedTuple):
    """Where an attachment stands in the file."""

    offset: int
    length: int
    log_time: int
    create_time: int
    data_size: int
    name: str
    media_type: str


class Statistics(NamedTuple):
    """Counts of what is in the file; times are the lowest and highest log time [ns since the epoch]."""

    message_count: int
    schema_count: int
    channel_count: int
    attachment_count: int
    metadata_count: int
    chunk_count: int
    message_start_time: int
    message_end_time: int
    channel_message_counts: dict[int, int]


class Metadata(NamedTuple):
    """Named pairs of text."""

    name: str
    metadata: dict[str, str]


class MetadataIndex(NamedTuple):
    """Where a metadata record stands in the file."""

    offset: int
    length: int
    name: str


class SummaryOffset(NamedTuple):
    """Where the records of one kind stand in the summary."""

    group_opcode: int
    group_start: int
    group_length: int


class DataEnd(NamedTuple):
    """End of the data; a CRC of 0 stands for none."""

    data_section_crc: int


# Type of each field: B, H, I, Q numbers of 1, 2, 4, 8 bytes; t text; b bytes and d bytes with a length of 4 and 8 bytes; r the rest;
# m text by text; n 8-byte numbers by 2-byte numbers.
_FIELDS = {
    Header: (Opcode.HEADER, "tt"),
    Footer: (Opcode.FOOTER, "QQI"),
    Schema: (Opcode.SCHEMA, "Httb"),
    Channel: (Opcode.CHANNEL, "HHttm"),
    Message: (Opcode.MESSAGE, "HIQQr"),
    Chunk: (Opcode.CHUNK, "QQQItd"),
    ChunkIndex: (Opcode.CHUNK_INDEX, "QQQQnQtQQ"),
    Attachment: (Opcode.ATTACHMENT, "QQttdI"),
    AttachmentIndex: (Opcode.ATTACHMENT_INDEX, "QQQQQtt"),
    Statistics: (Opcode.STATISTICS, "QHIIIIQQn"),
    Metadata: (Opcode.METADATA, "tm"),
    MetadataIndex: (Opcode.METADATA_INDEX, "QQt"),
    SummaryOffset: (Opcode.SUMMARY_OFFSET, "BQQ"),
    DataEnd: (Opcode.DATA_END, "I"),
}
_KINDS = {opcode: (kind, fields) for kind, (opcode, fields) in _FIELDS.items()}


def packed(record: NamedTuple) -> bytes:
    """Return a record of one of the classes of this module as bytes, with its head."""
    opcode, fields = _FIELDS[type(record)]
    content = b"".join(_packed_field(code, value) for code, value in zip(fields, record))
    return RECORD.pack(opcode, len(content)) + content


def _packed_field(code: str, value) -> bytes:
    if code in "BHIQ":
        return struct.pack(f"<{code}", value)
    if code == "r":
        return value
    if code == "t":
        value = value.encode()
    elif code == "m":
        value = b"".join(_packed_field("t", each) for pair in value.items() for each in pair)
    elif code == "n":
        value = b"".join(struct.pack("<HQ", *pair) for pair in value.items())
    return struct.pack("<Q" if code == "d" else "<I", len(value)) + value


def parsed(opcode: int, content: bytes):
    """Return the record of a kind and content; None for a kind without a class here.

    Raises
    ------
    DamagedRecord
        The content is not that of such a record.
    """
    if opcode not in _KINDS:
        return None
    kind, fields = _KINDS[opcode]
    values, at = [], 0
    try:
        for code in fields:
            value, at = _parsed_field(code, content, at)
            values.append(value)
    except (struct.error, UnicodeDecodeError) as error:
        raise DamagedRecord(str(error)) from None
    if kind is Attachment and values[-1] and values[-1] != zlib.crc32(content[:-4]):
        raise DamagedRecord("the checksum of an attachment is wrong")
    return kind(*values)


def _parsed_field(code: str, content: bytes, at: int) -> tuple[object, int]:
    """Return the value of a field that begins at a byte, and the byte after it."""
    if code in "BHIQ":
        return struct.unpack_from(f"<{code}", content, at)[0], at + struct.calcsize(f"<{code}")
    if code == "r":
        return content[at:], len(content)
    length, begin = _parsed_field("Q" if code == "d" else "I", content, at)
    end = begin + length
    if end > len(content):
        raise DamagedRecord("a record ends within a field")
    value = content[begin:end]
    if code in "bd":
        return value, end
    if code == "t":
        return value.decode(), end
    if code == "n":
        return dict(struct.iter_unpack("<HQ", value)), end
    pairs, at = {}, 0
    while at < len(value):
        key, at = _parsed_field("t", value, at)
        pairs[key], at = _parsed_field("t", value, at)
    return pairs, end


def packed_message(message: Message) -> bytes:
    """Return the record of a message; faster than `packed`."""
    return RECORD.pack(Opcode.MESSAGE, MESSAGE.size + len(message.data)) + MESSAGE.pack(*message[:-1]) + message.data


def message_at(data: bytes, begin: int, end: int) -> Message:
    """Return the message whose record stands in ``data`` from ``begin`` to ``end``."""
    content = begin + RECORD.size
    return Message(*MESSAGE.unpack_from(data, content), data[content + MESSAGE.size : end])
