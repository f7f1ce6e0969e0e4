# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Blocks of samples as MCAP messages, built for a whole block at once.

Message by message, the topics of one bearing at 1 kHz cost a third of a core, all of it while holding the interpreter's
lock, which the solver needs between ticks.  Messages of one topic differ in nothing but sequence, times and numbers, so
the bytes of all topics of one sample are laid out once and filled by numpy for many samples together.
"""

import struct
from collections.abc import Sequence

import numpy as np
from mcap._chunk_builder import ChunkBuilder
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from bearing_sim.sample import flat
from bearing_sim.sinks.message_layout import message_layouts
from bearing_sim.topics import Topic

_RECORD_HEAD = 9 + 22  # [byte]: opcode and length, then channel, sequence, log time, publish time


class RowLayout:
    """Where the numbers of a sample stand in the messages of some topics, one record after the other.

    Parameters
    ----------
    topics : output topics whose messages hold numbers of the sample as they are.
    rollers : number of rollers, as many as the samples have.

    Attributes
    ----------
    size : length of the records of one sample [byte].
    starts : where each topic's record begins [byte].

    Raises
    ------
    ValueError
        A topic changes the numbers, so that its messages cannot be filled in this way.
    """

    def __init__(self, topics: Sequence[Topic], rollers: int):
        self.topics, self.rollers = tuple(topics), rollers
        row, starts, runs, stamps = b"", [], [], []
        for cdr, numbers, stamped in message_layouts(self.topics, rollers):
            begin = len(row) + _RECORD_HEAD
            starts.append(len(row))
            runs += [run._replace(target=begin + run.target) for run in numbers]
            stamps += [begin + place for place in stamped]
            row += struct.pack("<BQ", Opcode.MESSAGE, 22 + len(cdr)) + bytes(22) + cdr
        self.size, self.starts = len(row), tuple(starts)
        self._runs = runs
        self._template = np.frombuffer(row, np.uint8).copy()
        self._dtype = np.dtype(
            {
                "names": [*(f"{part}{k}" for k in range(len(starts)) for part in ("channel", "sequence", "log", "publish"))]
                + [f"stamp{k}" for k in range(len(stamps))]
                + [f"run{k}" for k in range(len(runs))],
                "formats": ["<u2", "<u4", "<u8", "<u8"] * len(starts) + ["(2,)<u4"] * len(stamps) + [f"({run.count},)<f8" for run in runs],
                "offsets": [start + offset for start in starts for offset in (9, 11, 15, 23)] + stamps + [run.target for run in runs],
                "itemsize": self.size,
            }
        )
        self._stamps = len(stamps)

    def rows(self, block: np.ndarray, times_ns: np.ndarray, channels: Sequence[int], first_sequence: int) -> np.ndarray:
        """Return the records of a block.

        Parameters
        ----------
        block : samples, shape (n,).
        times_ns : log, publish and header time of each [ns since the epoch], uint64.
        channels : id of each topic's channel.
        first_sequence : of the first sample's messages.

        Returns
        -------
        records : uint8, shape (n, size).
        """
        filled = np.empty((len(block), self.size), np.uint8)
        filled[:] = self._template
        fields = filled.view(self._dtype)[:, 0]
        sequence = first_sequence + np.arange(len(block))
        for k, channel in enumerate(channels):
            fields[f"channel{k}"], fields[f"sequence{k}"] = channel, sequence
            fields[f"log{k}"] = fields[f"publish{k}"] = times_ns
        if self._stamps:
            seconds, nanoseconds = np.divmod(times_ns, np.uint64(1_000_000_000))
            both = np.stack((seconds, nanoseconds), axis=1)
            for k in range(self._stamps):
                fields[f"stamp{k}"] = both
        numbers = flat(np.ascontiguousarray(block))
        for k, run in enumerate(self._runs):
            fields[f"run{k}"] = numbers[:, run.source : run.source + run.count]
        return filled


class _RowIndex:
    """The message index of one channel in one chunk, kept as arrays: stands in for `mcap.records.MessageIndex`."""

    def __init__(self, channel_id: int):
        self.channel_id = channel_id
        self.records = self  # the builder appends single messages to ``records``
        self._parts: list[np.ndarray] = []

    def append(self, entry: tuple[int, int]) -> None:
        """Enter one message by (log time, offset in the chunk)."""
        self._parts.append(np.array([entry], "<u8"))

    def extend(self, entries: np.ndarray) -> None:
        """Enter messages, shape (n, 2), columns log time and offset in the chunk."""
        self._parts.append(entries)

    def write(self, stream: RecordBuilder) -> None:
        """Write the record."""
        entries = np.concatenate(self._parts)
        stream.start_record(Opcode.MESSAGE_INDEX)
        stream.write2(self.channel_id)
        stream.write4(entries.nbytes)
        stream.write(entries.tobytes())
        stream.finish_record()


class RowChunkBuilder(ChunkBuilder):
    """Builds chunks of messages that come one by one or as rows of `RowLayout`."""

    def add_rows(self, rows: np.ndarray, starts: Sequence[int], times_ns: np.ndarray, channels: Sequence[int]) -> None:
        """Add the records of some samples (see `RowLayout.rows`)."""
        first, last = int(times_ns.min()), int(times_ns.max())
        self.message_start_time = first if self.num_messages == 0 else min(self.message_start_time, first)
        self.message_end_time = max(self.message_end_time, last)
        offsets = self.record_writer.count + rows.shape[1] * np.arange(len(rows), dtype=np.uint64)
        for channel, start in zip(channels, starts):
            index = self.message_indices.get(channel)
            if index is None:
                index = self.message_indices[channel] = _RowIndex(channel)
            index.extend(np.stack((times_ns, offsets + np.uint64(start)), axis=1).astype("<u8", copy=False))
        self.num_messages += len(rows) * len(channels)
        self.record_writer.write(rows.tobytes())


class RowWriter(Writer):
    """`mcap.writer.Writer` that also takes rows.

    The library has no way in for many messages at once, so this reaches for its chunk builder and statistics by name;
    `test/test_mcap_rows.py` holds what comes out against message by message.
    """

    def __init__(self, output, chunk_size: int):
        super().__init__(output, chunk_size=chunk_size, compression=CompressionType.ZSTD)
        self._chunk_size = chunk_size
        self._Writer__chunk_builder = RowChunkBuilder()

    def add_rows(self, layout: RowLayout, rows: np.ndarray, times_ns: np.ndarray, channels: Sequence[int]) -> None:
        """Add the records of some samples (see `RowLayout.rows`); a chunk is finished where it is full."""
        per_chunk = max(1, self._chunk_size // layout.size)
        for start in range(0, len(rows), per_chunk):
            part = slice(start, start + per_chunk)
            self._Writer__chunk_builder.add_rows(rows[part], layout.starts, times_ns[part], channels)
            self._count(times_ns[part], channels)
            self._Writer__maybe_finalize_chunk()

    def _count(self, times_ns: np.ndarray, channels: Sequence[int]) -> None:
        told = self._Writer__statistics
        first, last = int(times_ns.min()), int(times_ns.max())
        told.message_start_time = first if told.message_count == 0 else min(told.message_start_time, first)
        told.message_end_time = max(told.message_end_time, last)
        for channel in channels:
            told.channel_message_counts[channel] += len(times_ns)
        told.message_count += len(times_ns) * len(channels)
