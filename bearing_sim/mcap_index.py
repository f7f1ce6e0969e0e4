# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a finished MCAP file says of itself at its end: topics, metadata, and when the messages of a topic were logged, without reading them."""

import io
import struct
import zlib
from collections import Counter
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, MetadataIndex, Schema, Statistics

from bearing_sim.mcap_stream import BROKEN, MAGIC, WholeReads
from bearing_sim.message_rows import RECORD

_FOOTER = struct.Struct("<QQI")  # start of the summary, start of its offsets, CRC
_INDEX_HEAD = struct.Struct("<HI")  # channel, length of the entries
_CHUNK_MAP = 32  # [byte] of a chunk's index before the places of its message indexes
_PLACES = np.dtype([("channel", "<u2"), ("place", "<u8")])
_PARSED = {
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA_INDEX: MetadataIndex,
}


class FileIndex(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    types : message type by topic.
    present : topics that have messages.
    metadata : metadata records by name.
    log_ns : log times of the messages of the topic that was asked for [ns since the epoch], uint64.
    """

    types: dict[str, str]
    present: set[str]
    metadata: dict[str, dict[str, str]]
    log_ns: np.ndarray


def read_index(path: str | Path, topic: str) -> FileIndex | None:
    """Return what a file says of itself; None where it has not its proper end, or its index has not all messages.

    Parameters
    ----------
    path : the file.
    topic : whose log times are wanted.

    Raises
    ------
    OSError
        It cannot be read.
    """
    with open(path, "rb") as stream:
        try:
            return _read(stream, Path(path).stat().st_size, topic)
        except BROKEN:
            return None


def _read(stream: BinaryIO, size: int, topic: str) -> FileIndex | None:
    summary = _summary(stream, size)
    found: dict[int, list] = {opcode: [] for opcode in _PARSED}
    places: list[np.ndarray] = []
    begin = 0
    while begin < len(summary):
        opcode, length = RECORD.unpack_from(summary, begin)
        begin += RECORD.size
        if opcode in _PARSED:
            found[opcode].append(_PARSED[opcode].read(ReadDataStream(WholeReads(io.BytesIO(summary[begin : begin + length])))))
        elif opcode == Opcode.CHUNK_INDEX:
            (extent,) = struct.unpack_from("<I", summary, begin + _CHUNK_MAP)
            places.append(np.frombuffer(summary, _PLACES, offset=begin + _CHUNK_MAP + 4, count=extent // _PLACES.itemsize))
        begin += length
    schemas = {schema.id: schema.name for schema in found[Opcode.SCHEMA]}
    topics = {channel.id: channel.topic for channel in found[Opcode.CHANNEL]}
    counts = Counter({channel: count for told in found[Opcode.STATISTICS] for channel, count in told.channel_message_counts.items()})
    if counts.total() != sum(told.message_count for told in found[Opcode.STATISTICS]):
        return None
    wanted = [channel for channel, name in topics.items() if name == topic]
    log_ns = _log_times(stream, np.concatenate([*places, np.empty(0, _PLACES)]), wanted)
    if len(log_ns) != sum(counts[channel] for channel in wanted):
        return None
    return FileIndex(
        {channel.topic: schemas.get(channel.schema_id, "") for channel in found[Opcode.CHANNEL]},
        {topics[channel] for channel, count in counts.items() if count and channel in topics},
        {index.name: _metadata(stream, index) for index in found[Opcode.METADATA_INDEX]},
        log_ns,
    )


def _summary(stream: BinaryIO, size: int) -> bytes:
    tail = RECORD.size + _FOOTER.size + len(MAGIC)
    if size < tail + len(MAGIC):
        raise EndOfFile()
    stream.seek(size - tail)
    end = stream.read(tail)
    start, _, crc = _FOOTER.unpack_from(end, RECORD.size)
    if RECORD.unpack_from(end) != (Opcode.FOOTER, _FOOTER.size) or not end.endswith(MAGIC) or not 0 < start < size:
        raise EndOfFile()
    stream.seek(start)
    summary = stream.read(size - tail - start)
    if crc and zlib.crc32(end[: RECORD.size + _FOOTER.size - 4], zlib.crc32(summary)) != crc:
        raise EndOfFile()
    return summary


def _log_times(stream: BinaryIO, places: np.ndarray, channels: list[int]) -> np.ndarray:
    parts = [np.empty(0, np.uint64)]
    reads = WholeReads(stream)
    for place in places["place"][np.isin(places["channel"], channels)].tolist():
        stream.seek(place)
        opcode, length = RECORD.unpack(reads.read(RECORD.size))
        channel, extent = _INDEX_HEAD.unpack(reads.read(_INDEX_HEAD.size))
        if opcode != Opcode.MESSAGE_INDEX or channel not in channels or extent != length - _INDEX_HEAD.size:
            raise EndOfFile()
        parts.append(np.frombuffer(reads.read(extent), "<u8")[::2])
    return np.concatenate(parts)


def _metadata(stream: BinaryIO, index: MetadataIndex) -> dict[str, str]:
    stream.seek(index.offset)
    reads = WholeReads(stream)
    opcode, length = RECORD.unpack(reads.read(RECORD.size))
    if opcode != Opcode.METADATA:
        raise EndOfFile()
    return Metadata.read(ReadDataStream(WholeReads(io.BytesIO(reads.read(length))))).metadata
