# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compare two recordings message by message: what differs, where, and by how much."""

import math
from collections import defaultdict, deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np
from mcap.records import Channel, Message, Schema

from bearing_sim.bag_files import mcap_files
from bearing_sim.mcap_stream import Salvage
from bearing_sim.message_numbers import NumberPlaces, number_places, numbers_of
from bearing_sim.message_rows import Rows

_TOGETHER = 4 * 1024 * 1024  # [byte] of a recording that are compared at once
_LOOKED_AHEAD = 64  # messages, where two recordings are out of step
_EQUAL_LOOKED_INTO = 32  # of so many equal messages one, for the magnitude
_TEXT = "diagnostic_msgs/msg/DiagnosticArray"  # says things in words and at moments of its own


@dataclass
class TopicDifference:
    """How a topic differs between two recordings; messages belong together by their log times.

    Attributes
    ----------
    topic, ros_type : which.
    tolerance : what is accepted, relative to the largest magnitude of each field over the recordings.
    matched : messages that both have, with as many numbers; ``only_first``, ``only_second`` what one of them has alone.
    differing : matched messages of which some number differs at all.
    numbers : names of the numbers of a message, such as ``data[3]``.
    largest : the largest difference of each number; infinite where one of them is not a number and the other is.
    magnitude : the largest magnitude of the field to which each number belongs.
    where_ns : log time of each number's largest difference [ns since the epoch].
    first_ns : log time of the first message of all [ns since the epoch].
    """

    topic: str
    ros_type: str
    tolerance: float
    matched: int = 0
    only_first: int = 0
    only_second: int = 0
    differing: int = 0
    numbers: list[str] = field(default_factory=list)
    largest: np.ndarray = field(default_factory=lambda: np.zeros(0))
    magnitude: np.ndarray = field(default_factory=lambda: np.zeros(0))
    where_ns: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    first_ns: int = 0

    @property
    def relative(self) -> np.ndarray:
        """The largest difference of each number over the magnitude of its field."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.largest == 0.0, 0.0, self.largest / np.where(self.magnitude > 0.0, self.magnitude, 1.0))

    @property
    def worst(self) -> int | None:
        """Which number differs most, relative to its field; None where there are none."""
        return int(np.argmax(self.relative)) if len(self.largest) else None

    @property
    def agrees(self) -> bool:
        """Whether both have the same messages and all numbers agree within the tolerance."""
        return not (self.only_first or self.only_second) and bool((self.relative <= self.tolerance).all())


def compare(
    first: str | Path, second: str | Path, tolerance: float = 1e-6, tolerances: Mapping[str, float] | None = None
) -> tuple[list[TopicDifference], list[str]]:
    """Compare two recordings.

    Parameters
    ----------
    first, second : MCAP files or folders of bags, finished or not.
    tolerance : of all topics, relative to the largest magnitude of a field.
    tolerances : of some topics by name (``"/pocket_forces"``).

    Returns
    -------
    differences : of every topic that either has, by name.
    skipped : topics of text, which are not compared.

    Raises
    ------
    bearing_sim.bag_files.BagError
        A path names no recording.
    """
    found: dict[str, _Pairing] = {}
    skipped: set[str] = set()
    first_ns = None
    for side, topic, ros_type, column in _alternating(first, second):
        earliest = int(column.log_ns.min())
        first_ns = earliest if first_ns is None else min(first_ns, earliest)
        if ros_type == _TEXT:
            skipped.add(topic)
            continue
        if topic not in found:
            own = (tolerances or {}).get(topic, (tolerances or {}).get(topic.lstrip("/"), tolerance))
            found[topic] = _Pairing(TopicDifference(topic, ros_type, own, first_ns=first_ns))
        found[topic].take(side, column)
    return [found[topic].finished() for topic in sorted(found)], sorted(skipped)


class _Column(NamedTuple):
    """Messages of one topic and length; log times [ns since the epoch], shape (n,), and bytes, shape (n, length)."""

    log_ns: np.ndarray
    data: np.ndarray

    def part(self, rows: slice) -> "_Column":
        return _Column(self.log_ns[rows], self.data[rows])


def _alternating(first: str | Path, second: str | Path) -> Iterator[tuple[int, str, str, _Column]]:
    """Yield (0 or 1, topic, type, messages) of both recordings in step, so that few messages wait for their partner."""
    sides = [_batches(first), _batches(second)]
    heads = [next(side, None) for side in sides]
    while any(head is not None for head in heads):
        side = min((k for k in (0, 1) if heads[k] is not None), key=lambda k: max((column.log_ns[-1] for *_, column in heads[k]), default=0))
        for topic, ros_type, column in heads[side]:
            yield side, topic, ros_type, column
        heads[side] = next(sides[side], None)


def _batches(path: str | Path) -> Iterator[list[tuple[str, str, _Column]]]:
    """Yield parts of a recording, as (topic, type, messages) in the order of each topic."""
    for file in mcap_files(path):
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        batch = _Batch()
        for record in Salvage(file, in_rows=lambda topic: True):
            if isinstance(record, Rows):
                batch.take_rows(record)
            elif isinstance(record, Message):
                batch.take(record)
            elif isinstance(record, Schema):
                schemas[record.id] = record.name
            elif isinstance(record, Channel):
                channels[record.id] = (record.topic, schemas.get(record.schema_id, ""))
            if batch.size > _TOGETHER:
                yield batch.columns(channels)
                batch = _Batch()
        yield batch.columns(channels)


class _Batch:
    """Messages of a part of a recording, each topic's in order.

    Attributes
    ----------
    size : of the messages [byte].
    """

    def __init__(self):
        self.size = 0
        self._columns: dict[int, list[_Column]] = defaultdict(list)  # by channel
        self._open: dict[tuple, list[Rows]] = {}  # rows of one shape, whatever came between them
        self._shapes: dict[int, tuple] = {}  # of the open rows with a channel

    def take(self, message: Message) -> None:
        if message.channel_id in self._shapes:
            self._close(self._shapes[message.channel_id])
        column = _Column(np.array([message.log_time], np.uint64), np.frombuffer(message.data, np.uint8)[None])
        self._columns[message.channel_id].append(column)
        self.size += len(message.data)

    def take_rows(self, rows: Rows) -> None:
        shape = (rows.channels, rows.starts)
        if shape not in self._open:
            for other in {self._shapes[channel] for channel in rows.channels if channel in self._shapes}:
                self._close(other)
            self._open[shape] = []
            self._shapes |= dict.fromkeys(rows.channels, shape)
        self._open[shape].append(rows)
        self.size += rows.table.size

    def _close(self, shape: tuple) -> None:
        parts = self._open.pop(shape)
        rows = parts[0]._replace(table=np.concatenate([part.table for part in parts]))
        for k, channel in enumerate(rows.channels):
            self._columns[channel].append(_Column(rows.log_ns(k), rows.data(k)))
            self._shapes.pop(channel, None)

    def columns(self, channels: Mapping[int, tuple[str, str]]) -> list[tuple[str, str, _Column]]:
        """Return (topic, type, messages), a topic's in as few columns as it has runs of one length; a message without a channel has no topic."""
        for shape in list(self._open):
            self._close(shape)
        told = []
        for channel, columns in self._columns.items():
            if channel in channels:
                for _, run in groupby(columns, key=lambda column: column.data.shape[1]):
                    told.append((*channels[channel], _joined(list(run))))
        return told


def _joined(columns: list[_Column]) -> _Column:
    if len(columns) == 1:
        return columns[0]
    times, data = zip(*columns)
    return _Column(np.concatenate(times), np.concatenate(data))


def _alone(mine: np.ndarray, others: np.ndarray) -> tuple[int, int]:
    """Return how many log times at the beginning of each of two courses the other one has not, as far as they can be seen."""
    same = mine[:, None] == others
    if same.any():
        first = int(same.any(axis=1).argmax())
        return first, int(same[first].argmax())
    later = [times > min(mine.max(), others.max()) for times in (mine, others)]  # than what the other has shown: it may have them yet
    return tuple(int(part.argmax()) if part.any() else len(part) for part in later)


class _Pairing:
    """Finds the messages of one topic that belong together, and compares many at once.

    Messages that stand at the same times in both recordings are taken as they come; one that the other recording does not have at its
    place is a stray, which waits for a partner that comes out of order.
    """

    def __init__(self, difference: TopicDifference):
        self._difference = difference
        self._waiting: tuple[deque[_Column], deque[_Column]] = (deque(), deque())
        self._strays: tuple[dict[int, list[bytes]], dict[int, list[bytes]]] = (defaultdict(list), defaultdict(list))
        self._parts: list[int] | None = None  # how many numbers each field has
        self._places: dict[int, NumberPlaces | None] = {}  # by length of the message

    def take(self, side: int, column: _Column) -> None:
        self._waiting[side].append(column)
        mine, others = self._waiting
        while mine and others:
            count = min(len(mine[0].log_ns), len(others[0].log_ns))
            same = mine[0].log_ns[:count] == others[0].log_ns[:count]
            together = count if same.all() else int(same.argmin())
            if together:
                self._pair(self._taken(0, together), self._taken(1, together))
            else:
                for side, count in enumerate(_alone(mine[0].log_ns[:_LOOKED_AHEAD], others[0].log_ns[:_LOOKED_AHEAD])):
                    if count:
                        self._stray(side, count)

    def finished(self) -> TopicDifference:
        for side in (0, 1):
            while self._waiting[side]:
                self._stray(side, len(self._waiting[side][0].log_ns))
        told, alone = self._difference, [sum(map(len, strays.values())) for strays in self._strays]
        told.only_first, told.only_second = told.only_first + alone[0], told.only_second + alone[1]
        return told

    def _taken(self, side: int, count: int) -> _Column:
        """Return the first messages that wait at a side, as many of its first column, and let them wait no longer."""
        column = self._waiting[side].popleft()
        if count < len(column.log_ns):
            self._waiting[side].appendleft(column.part(slice(count, None)))
        return column.part(slice(count))

    def _stray(self, side: int, count: int) -> None:
        column, others = self._taken(side, count), self._strays[1 - side]
        for k, log_ns in enumerate(column.log_ns.tolist()):
            partners = others.get(log_ns)
            if not partners:
                self._strays[side][log_ns].append(column.data[k].tobytes())
                continue
            partner = np.frombuffer(partners.pop(0), np.uint8)[None]
            if not partners:
                del others[log_ns]
            one = column.part(slice(k, k + 1))
            pair = (one, _Column(one.log_ns, partner))
            self._pair(*(pair if side == 0 else pair[::-1]))

    def _pair(self, first: _Column, second: _Column) -> None:
        """Compare messages with the same log times."""
        told = self._difference
        looked_into = (told.matched + np.arange(len(first.log_ns))) % _EQUAL_LOOKED_INTO == 0
        if first.data.shape == second.data.shape:
            looked_into |= (first.data != second.data).any(axis=1)
        else:
            looked_into[:] = True
        told.matched += int((~looked_into).sum())
        first, second = (_Column(column.log_ns[looked_into], column.data[looked_into]) for column in (first, second))
        if not len(first.log_ns):
            return
        if self._parts is None:
            self._begin(first.data[0].tobytes())
        mine, others = self._numbers(first.data), self._numbers(second.data)
        if mine is not None and others is not None:
            told.matched += len(mine)
            self._compare(first.log_ns, mine, others)
            return
        for log_ns, *both in zip(first.log_ns, first.data, second.data):  # laid out each in its own way
            a, b = (np.concatenate([*self._by_field(data.tobytes()).values(), np.zeros(0)]) for data in both)
            if len(a) == len(b) == len(told.largest):
                told.matched += 1
                self._compare(np.array([log_ns]), a[None], b[None])
            else:
                told.only_first, told.only_second = told.only_first + 1, told.only_second + 1

    def _begin(self, message: bytes) -> None:
        told = self._difference
        fields = {name: part for name, part in self._by_field(message).items() if len(part)}
        self._parts = [len(part) for part in fields.values()]
        told.numbers = [f"{name}[{k}]" if len(part) > 1 else name for name, part in fields.items() for k in range(len(part))]
        size = len(told.numbers)
        told.largest, told.magnitude, told.where_ns = np.zeros(size), np.zeros(size), np.zeros(size, np.int64)

    def _by_field(self, message: bytes) -> dict[str, np.ndarray]:
        return numbers_of(self._difference.topic, self._difference.ros_type, message)

    def _numbers(self, data: np.ndarray) -> np.ndarray | None:
        """Return the numbers of messages, shape (n, numbers); None where they are not laid out alike or have not as many as the first had."""
        length = data.shape[1]
        if length not in self._places:
            self._places[length] = number_places(self._difference.topic, self._difference.ros_type, data[0].tobytes())
        places = self._places[length]
        numbers = None if places is None else places.numbers(data)
        return numbers if numbers is not None and numbers.shape[1] == len(self._difference.largest) else None

    def _compare(self, log_ns: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
        if not self._parts:
            return
        told = self._difference
        finite = np.maximum(np.where(np.isfinite(a), abs(a), 0.0), np.where(np.isfinite(b), abs(b), 0.0)).max(axis=0)
        starts = np.cumsum([0, *self._parts[:-1]])
        np.maximum(told.magnitude, np.repeat(np.maximum.reduceat(finite, starts), self._parts), out=told.magnitude)
        with np.errstate(invalid="ignore"):
            gap = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, np.abs(a - b))
        gap = np.where(np.isnan(gap), math.inf, gap)
        told.differing += int(gap.any(axis=1).sum())
        worst = gap.argmax(axis=0)
        largest = gap[worst, np.arange(gap.shape[1])]
        larger = largest > told.largest
        told.largest[larger], told.where_ns[larger] = largest[larger], log_ns[worst][larger]
