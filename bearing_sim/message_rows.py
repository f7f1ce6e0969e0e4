# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of an MCAP chunk, many at once: a recording repeats the same topics with messages of the same lengths, sample after sample.

Taken one by one, the messages of an hour at 1 kHz cost minutes in the interpreter.  Where they repeat, they are rows of a table of bytes,
and numpy reads a column of it as fast as memory gives it.  What does not repeat is read one by one.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from mcap.records import Message

RECORD = struct.Struct("<BQ")
"""Head of a record: opcode, and length of what follows."""

_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
_HEAD = RECORD.size + 2  # [byte] what tells one kind of message from another: opcode, length, channel
_LOG = RECORD.size + 6  # [byte] of a record before its log time
_DATA = RECORD.size + _MESSAGE.size
_REMEMBERED = 64  # messages; a longer row is not found
_MOST_SHAPES = 256


class Rows(NamedTuple):
    """Messages of some channels that repeat in the same order and lengths.

    Attributes
    ----------
    channels : id of the channel of each message of a row.
    starts : where each record begins in the row [byte], and the row's length at the end.
    table : the records, uint8, shape (rows, length).
    """

    channels: tuple[int, ...]
    starts: tuple[int, ...]
    table: np.ndarray

    def log_ns(self, k: int) -> np.ndarray:
        """Return the log times of the k-th message of every row [ns since the epoch], uint64."""
        return _words(self.table[:, self.starts[k] + _LOG :][:, :8])

    def all_log_ns(self) -> np.ndarray:
        """Return the log times of all messages [ns since the epoch], uint64, shape (rows, channels)."""
        places = np.add.outer(np.array(self.starts[:-1]) + _LOG, np.arange(8))
        return np.ascontiguousarray(self.table[:, places]).view("<u8")[:, :, 0]

    def begin(self, k: int) -> int:
        """Return where the k-th message of a row begins [byte]."""
        return self.starts[k] + _DATA

    def data(self, k: int) -> np.ndarray:
        """Return the serialised k-th message of every row, uint8, shape (rows, length)."""
        return self.table[:, self.begin(k) : self.starts[k + 1]]

    def messages(self) -> Iterator[Message]:
        """Yield the messages one by one, in their order."""
        for row in self.table:
            whole = row.tobytes()
            for start, end in zip(self.starts, self.starts[1:]):
                yield message_at(whole, start, end)


class RowFinder:
    """Finds rows in the data of chunks, by the order and the lengths of the messages that came before.

    Parameters
    ----------
    wanted : whether messages of a channel may come in rows.
    """

    def __init__(self, wanted: Callable[[int], bool]):
        self._wanted = wanted
        self._shapes: dict[bytes, _Shape] = {}
        self._recent: list[bytes] = []

    def rows_at(self, data: bytes, place: int) -> Rows | None:
        """Return the rows that begin at a place, as many as follow each other; None where none is known to."""
        shape = self._shapes.get(data[place : place + _HEAD])
        rows = None if shape is None else shape.rows_at(data, place)
        if rows is not None:
            self._recent.clear()
        return rows

    def learn(self, data: bytes, place: int) -> None:
        """Take notice of a message that came alone."""
        head = data[place : place + _HEAD]
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

    def rows_at(self, data: bytes, place: int) -> Rows | None:
        size = self._starts[-1]
        table = np.frombuffer(data, np.uint8, offset=place)
        table = table[: len(table) // size * size].reshape(-1, size)
        fits = (table[:, self._places] == self._heads).all(axis=1)
        count = len(fits) if fits.all() else int(fits.argmin())
        return Rows(self._channels, self._starts, table[:count]) if count else None


def message_at(data: bytes, place: int, end: int) -> Message:
    """Return the message whose record goes from ``place`` to ``end``."""
    channel, sequence, log_ns, publish_ns = _MESSAGE.unpack_from(data, place + RECORD.size)
    return Message(channel, log_ns, data[place + _DATA : end], publish_ns, sequence)


def _words(columns: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(columns).view("<u8")[:, 0]
