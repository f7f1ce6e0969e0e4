# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write MCAP: messages one by one, or those of many samples at once.

Message by message in the interpreter, the topics of one bearing at 1 kHz cost a fifth of a core.  The records of all topics of one
sample are therefore laid out once, and NumPy fills them for many samples together (`SampleRows`).  `test/benchmarks/mcap_writers.py` compares
the cost with that of other writers.
"""

import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
import zstandard
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from bearing_sim.messages.sample_messages import message_templates
from bearing_sim.messages.topics import FRAME, Topic
from bearing_sim.model.sample import flat
from bearing_sim.recording.mcap_format import INDEX, MAGIC, MESSAGE, PROFILE, RECORD, Message, checksum_record, packed, packed_message

CHUNK_SIZE = 64 * 1024
"""Length of a chunk before compression [byte].  The writer holds one chunk in memory: small chunks keep each write and each loss short."""

_ENTRY = struct.Struct("<QQ")  # of a message index: log time, offset in the chunk


class Output(Protocol):
    """Where a file goes."""

    def write(self, data: bytes) -> object: ...
    def tell(self) -> int: ...


class SampleRows:
    """The MCAP records of some topics for one sample, one after the other, and how to fill them for many samples.

    Parameters
    ----------
    topics : output topics (see `bearing_sim.messages.sample_messages.message_templates`).
    rollers : number of rollers of the samples.
    frame : the bearing's, for headers.

    Attributes
    ----------
    size : length of the records of one sample [byte].
    starts : first byte of each topic's record, shape (topics,).

    Raises
    ------
    ValueError
        A topic does not carry numbers of the sample.
    """

    def __init__(self, topics: Sequence[Topic], rollers: int, frame: str = FRAME):
        self.topics, self.rollers = tuple(topics), rollers
        row, starts, runs, stamps, computed = b"", [], [], [], []
        for template in message_templates(self.topics, rollers, frame):
            begin = len(row) + RECORD.size + MESSAGE.size
            starts.append(len(row))
            runs += [run._replace(target=begin + run.target) for run in template.runs]
            stamps += [] if template.stamp is None else [begin + template.stamp]
            computed += [] if template.computed is None else [template.computed._replace(target=begin + template.computed.target)]
            row += packed_message(Message(0, 0, 0, 0, template.data))
        self.size, self.starts = len(row), np.array(starts, np.uint64)
        self._runs, self._stamps, self._computed = runs, len(stamps), computed
        self._template = np.frombuffer(row, np.uint8).copy()
        fields = [(f"{part}{k}", start + RECORD.size + at, form) for k, start in enumerate(starts) for part, at, form in _HEAD_FIELDS]
        fields += [(f"stamp{k}", at, "(2,)<u4") for k, at in enumerate(stamps)]
        fields += [(f"run{k}", run.target, f"({run.count},)<f8") for k, run in enumerate(runs)]
        fields += [(f"computed{k}", run.target, (run.dtype, (run.count,))) for k, run in enumerate(computed)]
        names, offsets, formats = zip(*fields)
        self._dtype = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": self.size})

    def filled(self, block: np.ndarray, times_ns: np.ndarray, channels: Sequence[int], sequences: Sequence[np.ndarray]) -> np.ndarray:
        """Return the records of a block.

        Parameters
        ----------
        block : samples, shape (n,).
        times_ns : log, publish and header time of each [ns since the epoch], uint64.
        channels : id of each topic's channel.
        sequences : numbers of each topic's messages, shape (topics, n).

        Returns
        -------
        records : uint8, shape (n, size).
        """
        rows = np.empty((len(block), self.size), np.uint8)
        rows[:] = self._template
        fields = rows.view(self._dtype)[:, 0]
        for k, (channel, sequence) in enumerate(zip(channels, sequences, strict=True)):
            fields[f"channel{k}"], fields[f"sequence{k}"] = channel, sequence
            fields[f"log{k}"] = fields[f"publish{k}"] = times_ns
        if self._stamps:
            both = np.stack(np.divmod(times_ns, np.uint64(1_000_000_000)), axis=1)
            for k in range(self._stamps):
                fields[f"stamp{k}"] = both
        numbers = flat(np.ascontiguousarray(block))
        for k, run in enumerate(self._runs):
            fields[f"run{k}"] = numbers[:, run.source : run.source + run.count]
        for k, run in enumerate(self._computed):
            fields[f"computed{k}"] = run.numbers(block)
        return rows


class _RowGroup(NamedTuple):
    """Rows of a layout that stand one after the other in a chunk.

    Attributes
    ----------
    layout : of the rows.
    times_ns : log time of each row [ns since the epoch], uint64.
    offset : first byte of the rows in the chunk.
    """

    layout: SampleRows
    times_ns: np.ndarray
    offset: int


_HEAD_FIELDS = (("channel", 0, "<u2"), ("sequence", 2, "<u4"), ("log", 6, "<u8"), ("publish", 14, "<u8"))  # see mcap_format.MESSAGE


class McapWriter:
    """Writes one MCAP file: header, chunks with their indexes, metadata, attachments, and at the end the summary.

    Each of these is followed by a checksum record (see `bearing_sim.recording.mcap_format`).

    Parameters
    ----------
    output : takes whole records: a chunk comes in one call together with its indexes and their checksum.
    profile, library : what the header says.
    """

    def __init__(self, output: Output, profile: str = PROFILE, library: str = "bearing_sim"):
        self._output, self._compress = output, zstandard.ZstdCompressor().compress
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._counts: dict[int, int] = {}
        self._metadata: list[MetadataIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._chunks: list[bytes] = []  # packed: there are many
        self._span: tuple[int, int] | None = None
        self._checksum = 0  # CRC-32 of all that is in the file
        self._begin_chunk()
        self._write(MAGIC + packed(Header(profile, library)))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Add a message type and return its id."""
        self._schemas.append(Schema(id=len(self._schemas) + 1, name=name, encoding=encoding, data=data))
        self._append_twice(packed(self._schemas[-1]))
        return self._schemas[-1].id

    def add_channel(self, topic: str, message_encoding: str, schema_id: int, metadata: Mapping[str, str]) -> int:
        """Add a topic and return its id; ``schema_id`` 0 stands for no schema."""
        own = len(self._channels) + 1
        self._channels.append(Channel(id=own, schema_id=schema_id, topic=topic, message_encoding=message_encoding, metadata=dict(metadata)))
        self._append_twice(packed(self._channels[-1]))
        return own

    def add_message(self, message: Message) -> None:
        """Add a message of a channel."""
        channel, _, log_ns, _, _ = message
        self._index.setdefault(channel, []).append(_ENTRY.pack(log_ns, self._size))
        self._counts[channel] = self._counts.get(channel, 0) + 1
        self._append_messages(packed_message(message), log_ns, log_ns)

    def add_rows(self, layout: SampleRows, rows: np.ndarray, times_ns: np.ndarray, channels: Sequence[int]) -> None:
        """Add the records of some samples, filled by `SampleRows.filled` with these times and channels."""
        per_chunk = max(1, CHUNK_SIZE // layout.size)
        for start in range(0, len(rows), per_chunk):
            part, times = rows[start : start + per_chunk], times_ns[start : start + per_chunk]
            self._groups.setdefault(tuple(channels), []).append(_RowGroup(layout, times, self._size))
            self._append_messages(part.data, int(times.min()), int(times.max()))

    def add_metadata(self, name: str, metadata: Mapping[str, str]) -> None:
        """Add named pairs of text."""
        self._metadata.append(MetadataIndex(*self._write(packed(Metadata(name, dict(metadata)))), name))

    def add_attachment(self, attachment: Attachment) -> None:
        """Add a file."""
        at = self._write(packed(attachment))
        index = AttachmentIndex(*at, attachment.log_time, attachment.create_time, len(attachment.data), attachment.name, attachment.media_type)
        self._attachments.append(index)

    def flush(self) -> None:
        """Write the chunk in progress, if it has a message."""
        if not self._index and not self._groups:
            return
        self._index_groups()
        records = b"".join(self._parts)
        compressed = self._compress(records)
        span = {"message_start_time": self._chunk_span[0], "message_end_time": self._chunk_span[1], "compression": "zstd"}
        chunk = packed(Chunk(data=compressed, uncompressed_size=len(records), uncompressed_crc=zlib.crc32(records), **span))
        offset = self._output.tell()
        indexes, places, at = [], {}, offset + len(chunk)
        for channel, entries in self._index.items():
            joined = b"".join(entries)
            indexes.append(RECORD.pack(Opcode.MESSAGE_INDEX, INDEX.size + len(joined)) + INDEX.pack(channel, len(joined)) + joined)
            places[channel] = at
            at += len(indexes[-1])
        self._write(b"".join((chunk, *indexes)))
        index = ChunkIndex(
            chunk_start_offset=offset,
            chunk_length=len(chunk),
            message_index_offsets=places,
            message_index_length=at - offset - len(chunk),
            compressed_size=len(compressed),
            uncompressed_size=len(records),
            **span,
        )
        self._chunks.append(packed(index))
        self._begin_chunk()

    def finish(self) -> None:
        """Write the chunk in progress, the summary and the end of the file; nothing may follow."""
        self.flush()
        first, last = self._span or (0, 0)
        statistics = Statistics(
            message_count=sum(self._counts.values()),
            schema_count=len(self._schemas),
            channel_count=len(self._channels),
            attachment_count=len(self._attachments),
            metadata_count=len(self._metadata),
            chunk_count=len(self._chunks),
            message_start_time=first,
            message_end_time=last,
            channel_message_counts=self._counts,
        )
        self._output.write(packed(DataEnd(self._checksum)))
        begin = at = self._output.tell()
        summary, offsets = b"", b""
        for opcode, records in (
            (Opcode.SCHEMA, map(packed, self._schemas)),
            (Opcode.CHANNEL, map(packed, self._channels)),
            (Opcode.STATISTICS, [packed(statistics)]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, map(packed, self._attachments)),
            (Opcode.METADATA_INDEX, map(packed, self._metadata)),
        ):
            group = b"".join(records)
            if group:
                offsets += packed(SummaryOffset(opcode, at, len(group)))
            summary, at = summary + group, at + len(group)
        unchecked = packed(Footer(begin, at, 0))[:-4]
        self._output.write(b"".join((summary, offsets, packed(Footer(begin, at, zlib.crc32(summary + offsets + unchecked))), MAGIC)))

    def _write(self, data: bytes) -> tuple[int, int]:
        """Write whole records and their checksum; return where the records stand and their length."""
        offset = self._output.tell()
        section = data + checksum_record(offset, zlib.crc32(data))
        self._output.write(section)
        self._checksum = zlib.crc32(section, self._checksum)
        return offset, len(data)

    def _begin_chunk(self) -> None:
        self._parts: list[bytes | memoryview] = []
        self._size = 0
        self._index: dict[int, list[bytes]] = {}
        self._groups: dict[tuple[int, ...], list[_RowGroup]] = {}  # by channels
        self._chunk_span: tuple[int, int] | None = None

    def _index_groups(self) -> None:
        """Enter all rows of the chunk into its index at once: group by group, small ones would cost more than their writing."""
        for channels, groups in self._groups.items():
            times = np.concatenate([group.times_ns for group in groups])
            layout = groups[0].layout
            begins = np.concatenate(
                [np.uint64(group.offset) + np.uint64(layout.size) * np.arange(len(group.times_ns), dtype=np.uint64) for group in groups]
            )
            entries = np.empty((len(channels), len(times), 2), "<u8")
            entries[:, :, 0] = times
            entries[:, :, 1] = np.add.outer(layout.starts, begins)
            for channel, own in zip(channels, entries):
                self._index.setdefault(channel, []).append(own.tobytes())
                self._counts[channel] = self._counts.get(channel, 0) + len(times)

    def _append_messages(self, packed: bytes | memoryview, first: int, last: int) -> None:
        """Put messages with these lowest and highest log times into the chunk in progress, and write it when it is full."""
        self._append(packed)
        self._span, self._chunk_span = widened(self._span, first, last), widened(self._chunk_span, first, last)
        if self._size > CHUNK_SIZE:
            self.flush()

    def _append_twice(self, packed: bytes) -> None:
        """Put what later messages refer to into the file and into the chunk in progress: damage of one of the two makes no message unreadable."""
        self._write(packed)
        self._append(packed)

    def _append(self, packed: bytes | memoryview) -> None:
        self._parts.append(packed)
        self._size += memoryview(packed).nbytes


def widened(span: tuple[int, int] | None, first: int, last: int) -> tuple[int, int]:
    """Return a span of times that also holds ``first`` and ``last``."""
    return (first, last) if span is None else (min(span[0], first), max(span[1], last))
