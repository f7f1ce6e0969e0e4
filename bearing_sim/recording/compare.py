# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compare two recordings message by message: what differs, where, and by how much.

Messages belong together by run time: two runs of one command begin at different moments and are nevertheless the same.
"""

import math
import re
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np
from mcap.records import Metadata

from bearing_sim.messages.cdr import CdrError, CdrLayout, NumberColumns, is_known, layout_of
from bearing_sim.messages.topics import ARRAYS, OUTPUTS
from bearing_sim.recording.bag import mcap_files
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader, Rows
from bearing_sim.recording.writer import METADATA

_BATCH = 4 * 1024 * 1024  # [byte] of a recording compared at once
_EQUAL_EXAMINED = 32  # one in so many equal messages is examined, for the magnitude
_START = re.compile(r"\d{1,19}")
_LATEST_START = 2**62  # [ns], in the year 2116; differences of later ones might not fit into 64 bits
_TEXT = "diagnostic_msgs/msg/DiagnosticArray"  # text, at times of its own


@dataclass
class TopicDifference:
    """How a topic differs between two recordings.  Log times are those of the first one, also where only the second has a message.

    Attributes
    ----------
    topic, ros_type : name and type of the topic.
    tolerance : accepted difference, relative to the largest magnitude of each field over both recordings.
    matched : number of messages that both have; ``only_first``, ``only_second`` number of messages that only one of them has.
    differing : number of matched messages in which any number differs.
    numbers : names of the numbers of a message, such as ``data[3]``.
    largest : the largest difference of each number; infinite where one of the two is NaN and the other is not.
    magnitude : the largest magnitude in the field of each number.
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
        """Index of the number that differs most, relative to its field; None for messages without numbers."""
        return int(np.argmax(self.relative)) if len(self.largest) else None

    @property
    def agrees(self) -> bool:
        """Whether both have the same messages and all numbers agree within the tolerance."""
        return not (self.only_first or self.only_second) and bool((self.relative <= self.tolerance).all())


def compare(
    first: str | Path,
    second: str | Path,
    tolerance: float = 1e-6,
    tolerances: Mapping[str, float] | None = None,
    by_clock: bool = False,
    warn: Callable[[str], None] = lambda text: None,
) -> tuple[list[TopicDifference], list[str]]:
    """Compare two recordings.

    Parameters
    ----------
    first, second : MCAP files or folders of bags, finished or not.
    tolerance : of all topics, relative to the largest magnitude of a field.
    tolerances : of some topics by name (``"/pocket_forces"``).
    by_clock : whether messages belong together by their log times, although the runs began at different moments: two replays of one log, of which
        began later in it.  So do those of recordings that do not say when run time began, in any case.
    warn : called with a text for each file that is unfinished or damaged, of which only what can be read is compared.

    Returns
    -------
    differences : of every topic of either recording, sorted by name.
    skipped : topics that are not compared: those with text, and those that repeat the numbers of others and that one recording, of an earlier
        version, does not have.

    Raises
    ------
    bearing_sim.recording.bag.RecordingError
        A path does not name a recording.
    """
    found: dict[str, _Pairing] = {}
    skipped: set[str] = set()
    first_ns = None
    starts = [None if by_clock else _start_ns(path) for path in (first, second)]
    delay = 0 if None in starts else starts[1] - starts[0]
    for side, topic, ros_type, column in _alternating(_batches(first, 0, warn), _batches(second, delay, warn)):
        earliest = int(column.log_ns.min())
        first_ns = earliest if first_ns is None else min(first_ns, earliest)
        if ros_type == _TEXT:
            skipped.add(topic)
            continue
        if topic not in found:
            own = (tolerances or {}).get(topic, (tolerances or {}).get(topic.lstrip("/"), tolerance))
            found[topic] = _Pairing(TopicDifference(topic, ros_type, own, first_ns=first_ns))
        found[topic].receive(side, column)
    differences = [found[topic].finished() for topic in sorted(found)]
    skipped |= {difference.topic for difference in differences if _is_newer(difference)}
    return [difference for difference in differences if difference.topic not in skipped], sorted(skipped)


def _is_newer(difference: TopicDifference) -> bool:
    """Whether one recording lacks a topic altogether that only repeats the numbers of others."""
    topic = OUTPUTS.get(difference.topic[1:])
    is_alone = not difference.matched and not (difference.only_first and difference.only_second)
    return topic is not None and topic.repeats and is_alone


class _Column(NamedTuple):
    """Messages of one topic and length; log times [ns since the epoch], shape (n,), and bytes, shape (n, length)."""

    log_ns: np.ndarray
    data: np.ndarray

    def part(self, rows: slice) -> "_Column":
        return _Column(self.log_ns[rows], self.data[rows])


def _start_ns(path: str | Path) -> int | None:
    """Return the log time at which run time began [ns since the epoch]; None if a recording does not say."""
    for file in mcap_files(path):
        for record in McapReader(file, stops_at_damage=True):
            if isinstance(record, Metadata) and record.name == METADATA:
                start = record.metadata.get("start_ns", "")
                return int(start) if _START.fullmatch(start) and int(start) < _LATEST_START else None
            if isinstance(record, Message):  # the metadata of a run come first
                break
    return None


def _alternating(*sides: Iterator[list[tuple[str, str, _Column]]]) -> Iterator[tuple[int, str, str, _Column]]:
    """Yield (0 or 1, topic, type, messages) of both recordings in step, so that few messages wait for their partner."""
    heads = [next(side, None) for side in sides]
    while any(head is not None for head in heads):
        side = min((k for k in (0, 1) if heads[k] is not None), key=lambda k: max((column.log_ns[-1] for *_, column in heads[k]), default=0))
        for topic, ros_type, column in heads[side]:
            yield side, topic, ros_type, column
        heads[side] = next(sides[side], None)


def _batches(path: str | Path, delay: int, warn: Callable[[str], None]) -> Iterator[list[tuple[str, str, _Column]]]:
    """Yield parts of a recording, as (topic, type, messages) in the order of each topic; log times less a delay [ns]."""
    for file in mcap_files(path):
        reader = McapReader(file, in_rows=lambda topic: True, own_topics=True)
        columns: dict[int, list[_Column]] = defaultdict(list)  # by channel
        size = 0
        for record in reader:
            if isinstance(record, Rows):
                for k, channel in enumerate(record.channels):
                    columns[channel].append(_Column(record.log_ns(k).astype(np.int64) - delay, record.data(k)))
                size += record.table.size
            elif isinstance(record, Message):
                log_ns = np.array([record.log_time], np.uint64).astype(np.int64) - delay
                columns[record.channel_id].append(_Column(log_ns, np.frombuffer(record.data, np.uint8)[None]))
                size += len(record.data)
            if size > _BATCH:
                yield list(_by_topic(reader, columns))
                columns, size = defaultdict(list), 0
        yield list(_by_topic(reader, columns))
        if reader.ends or reader.damaged:
            warn(f"{file}: {'; '.join(filter(None, [reader.ends, *reader.damage[:3]]))}; what can be read of it is compared")


def _by_topic(reader: McapReader, columns: Mapping[int, list[_Column]]) -> Iterator[tuple[str, str, _Column]]:
    """Yield (topic, type, messages), each topic's in runs of one length, without messages whose channel was lost in a damaged chunk."""
    for channel, parts in columns.items():
        if (topic := reader.topics.get(channel)) is not None:
            for _, run in groupby(parts, key=lambda column: column.data.shape[1]):
                yield topic, reader.types[topic], _joined(list(run))


def _joined(columns: list[_Column]) -> _Column:
    if len(columns) == 1:
        return columns[0]
    times, data = zip(*columns)
    return _Column(np.concatenate(times), np.concatenate(data))


class _Pairing:
    """Finds the messages of one topic with equal log times, and compares many at once.

    Messages at the same times in both recordings are compared as they come; a message that the other recording lacks there is a stray, and
    waits for a partner that comes out of order.
    """

    def __init__(self, difference: TopicDifference):
        self._difference = difference
        self._waiting: tuple[deque[_Column], deque[_Column]] = (deque(), deque())
        self._strays: tuple[dict[int, list[bytes]], dict[int, list[bytes]]] = (defaultdict(list), defaultdict(list))
        self._parts: dict[str, int] | None = None  # how many numbers each field has
        self._columns: dict[int, NumberColumns | None] = {}  # by length of the message

    def receive(self, side: int, column: _Column) -> None:
        self._waiting[side].append(column)
        mine, others = self._waiting
        while mine and others:
            count = min(len(mine[0].log_ns), len(others[0].log_ns))
            same = mine[0].log_ns[:count] == others[0].log_ns[:count]
            together = count if same.all() else int(same.argmin())
            if together:
                self._pair(self._taken(0, together), self._taken(1, together))
            else:
                side = int(mine[0].log_ns[0] > others[0].log_ns[0])
                is_earlier = self._waiting[side][0].log_ns < self._waiting[1 - side][0].log_ns[0]
                self._stray(side, len(is_earlier) if is_earlier.all() else int(is_earlier.argmin()))

    def finished(self) -> TopicDifference:
        for side in (0, 1):
            while self._waiting[side]:
                self._stray(side, len(self._waiting[side][0].log_ns))
        result, alone = self._difference, [sum(map(len, strays.values())) for strays in self._strays]
        result.only_first, result.only_second = result.only_first + alone[0], result.only_second + alone[1]
        return result

    def _taken(self, side: int, count: int) -> _Column:
        """Remove and return the first messages that wait on a side; they all come from its first column."""
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
        result = self._difference
        examined = (result.matched + np.arange(len(first.log_ns))) % _EQUAL_EXAMINED == 0
        if first.data.shape == second.data.shape:
            examined |= (first.data != second.data).any(axis=1)
        else:
            examined[:] = True
        result.matched += int((~examined).sum())
        first, second = (_Column(column.log_ns[examined], column.data[examined]) for column in (first, second))
        if not len(first.log_ns):
            return
        if self._parts is None:
            self._begin(first.data[0].tobytes())
        mine, others = self._numbers(first.data), self._numbers(second.data)
        if mine is not None and others is not None:
            result.matched += len(mine)
            self._compare(first.log_ns, mine, others)
            return
        for log_ns, *both in zip(first.log_ns, first.data, second.data):  # each has a layout of its own
            a, b = self._alike(*(self._by_field(data.tobytes()) for data in both))
            if len(a) == len(b) == len(result.largest):
                result.matched += 1
                self._compare(np.array([log_ns]), a[None], b[None])
            else:
                result.only_first, result.only_second = result.only_first + 1, result.only_second + 1

    def _begin(self, message: bytes) -> None:
        result = self._difference
        fields = {name: part for name, part in self._by_field(message).items() if len(part)}
        self._parts = {name: len(part) for name, part in fields.items()}
        result.numbers = [f"{name}[{k}]" if len(part) > 1 else name for name, part in fields.items() for k in range(len(part))]
        size = len(result.numbers)
        result.largest, result.magnitude, result.where_ns = np.zeros(size), np.zeros(size), np.zeros(size, np.int64)

    def _layout(self, message: bytes) -> CdrLayout | None:
        """Return the layout of a message; None if its type is unknown or it is damaged."""
        try:
            return layout_of(self._difference.ros_type, message) if is_known(self._difference.ros_type) else None
        except CdrError:
            return None

    def _by_field(self, message: bytes) -> dict[str, np.ndarray]:
        """Return the numbers of a message by field; those of arrays of samples by observable."""
        layout = self._layout(message)
        numbers = {} if layout is None else layout.values(message)
        rows = ARRAYS.get(self._difference.topic[1:])
        if rows is not None and list(numbers) == ["data"] and len(numbers["data"]) % len(rows.fields) == 0:
            return dict(zip(rows.fields, numbers["data"].reshape(len(rows.fields), -1)))
        return numbers

    def _alike(self, first: dict[str, np.ndarray], second: dict[str, np.ndarray]) -> list[np.ndarray]:
        """Return the numbers of two messages; an array that one of them lacks, and that is NaN throughout in the other, is no difference."""
        found, empty = [], np.zeros(0)
        for message, other in ((first, second), (second, first)):
            parts = []
            for name in dict.fromkeys([*self._parts, *message]):
                part = message.get(name, empty)
                if name in self._parts and not len(part) and np.isnan(other.get(name, empty)).all():
                    part = np.full(self._parts[name], math.nan)
                if name in self._parts or not np.isnan(part).all():
                    parts.append(part)
            found.append(np.concatenate([*parts, empty]))
        return found

    def _numbers(self, data: np.ndarray) -> np.ndarray | None:
        """Return the numbers of messages, shape (n, numbers); None if they are not laid out alike, or have another count than the first message."""
        length = data.shape[1]
        if length not in self._columns:
            layout = self._layout(data[0].tobytes())
            self._columns[length] = None if layout is None else NumberColumns(data[0], [(0, layout)])
        columns = self._columns[length]
        numbers = None if columns is None else columns.read(data)
        return numbers if numbers is not None and numbers.shape[1] == len(self._difference.largest) else None

    def _compare(self, log_ns: np.ndarray, a: np.ndarray, b: np.ndarray) -> None:
        if not self._parts:
            return
        result = self._difference
        finite = np.maximum(np.where(np.isfinite(a), abs(a), 0.0), np.where(np.isfinite(b), abs(b), 0.0)).max(axis=0)
        counts = list(self._parts.values())
        starts = np.cumsum([0, *counts[:-1]])
        np.maximum(result.magnitude, np.repeat(np.maximum.reduceat(finite, starts), counts), out=result.magnitude)
        with np.errstate(invalid="ignore"):
            gap = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, np.abs(a - b))
        gap = np.where(np.isnan(gap), math.inf, gap)
        result.differing += int(gap.any(axis=1).sum())
        worst = gap.argmax(axis=0)
        largest = gap[worst, np.arange(gap.shape[1])]
        larger = largest > result.largest
        result.largest[larger], result.where_ns[larger] = largest[larger], log_ns[worst][larger]
