# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compare two recordings message by message: what differs, where, and by how much."""

import math
import struct
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from mcap.records import Channel, Message, Schema

from bearing_sim.bag_files import mcap_files
from bearing_sim.mcap_stream import Salvage
from bearing_sim.recording_reader import trailing_doubles
from bearing_sim.topics import ARRAYS

_MULTI_ARRAY, _FLOAT = "std_msgs/msg/Float64MultiArray", "std_msgs/msg/Float64"
_TOGETHER = 256  # messages
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
    for side, topic, ros_type, message in _alternating(first, second):
        first_ns = message.log_time if first_ns is None else min(first_ns, message.log_time)
        if ros_type == _TEXT:
            skipped.add(topic)
            continue
        if topic not in found:
            own = (tolerances or {}).get(topic, (tolerances or {}).get(topic.lstrip("/"), tolerance))
            found[topic] = _Pairing(TopicDifference(topic, ros_type, own, first_ns=first_ns))
        found[topic].take(side, message)
    return [found[topic].finished() for topic in sorted(found)], sorted(skipped)


def _alternating(first: str | Path, second: str | Path) -> Iterator[tuple[int, str, str, Message]]:
    """Yield (0 or 1, topic, type, message) of both recordings in step, so that few messages wait for their partner."""
    sides = [_messages(first), _messages(second)]
    heads = [next(side, None) for side in sides]
    while any(head is not None for head in heads):
        side = min((k for k in (0, 1) if heads[k] is not None), key=lambda k: heads[k][2].log_time)
        yield side, *heads[side]
        heads[side] = next(sides[side], None)


def _messages(path: str | Path) -> Iterator[tuple[str, str, Message]]:
    for file in mcap_files(path):
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        for record in Salvage(file):
            if isinstance(record, Message):
                if record.channel_id in channels:
                    yield *channels[record.channel_id], record
            elif isinstance(record, Schema):
                schemas[record.id] = record.name
            elif isinstance(record, Channel):
                channels[record.id] = (record.topic, schemas.get(record.schema_id, ""))


class _Pairing:
    """Finds the messages of one topic that belong together, and compares many at once."""

    def __init__(self, difference: TopicDifference):
        self._difference = difference
        self._waiting: tuple[dict, dict] = (defaultdict(list), defaultdict(list))
        self._numbers = _numbers_of(difference.topic, difference.ros_type)
        self._parts: list[int] = []  # how many numbers each field has
        self._pairs: list[tuple[int, np.ndarray, np.ndarray]] = []

    def take(self, side: int, message: Message) -> None:
        others = self._waiting[1 - side]
        partners = others.get(message.log_time)
        if not partners:
            self._waiting[side][message.log_time].append(message.data)
            return
        partner = partners.pop(0)
        if not partners:
            del others[message.log_time]
        self._pair(message.log_time, *((message.data, partner) if side == 0 else (partner, message.data)))

    def finished(self) -> TopicDifference:
        self._compare()
        told, alone = self._difference, [sum(map(len, waiting.values())) for waiting in self._waiting]
        told.only_first, told.only_second = told.only_first + alone[0], told.only_second + alone[1]
        return told

    def _pair(self, log_ns: int, first: bytes, second: bytes) -> None:
        told = self._difference
        if told.matched and first == second and told.matched % _EQUAL_LOOKED_INTO:
            told.matched += 1
            return
        mine, other = self._numbers(first), self._numbers(second)
        if not told.matched:
            mine = {name: part for name, part in mine.items() if len(part)}
            self._parts = [len(part) for part in mine.values()]
            told.numbers = [f"{name}[{k}]" if len(part) > 1 else name for name, part in mine.items() for k in range(len(part))]
            size = len(told.numbers)
            told.largest, told.magnitude, told.where_ns = np.zeros(size), np.zeros(size), np.zeros(size, np.int64)
        a, b = (np.concatenate([*numbers.values(), np.zeros(0)]) for numbers in (mine, other))
        if not len(a) == len(b) == len(told.largest):
            told.only_first, told.only_second = told.only_first + 1, told.only_second + 1
            return
        told.matched += 1
        self._pairs.append((log_ns, a, b))
        if len(self._pairs) == _TOGETHER:
            self._compare()

    def _compare(self) -> None:
        if not self._pairs or not self._parts:
            return
        told = self._difference
        times, a, b = (np.array(column) for column in zip(*self._pairs))
        self._pairs = []
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
        told.largest[larger], told.where_ns[larger] = largest[larger], times[worst][larger]


def _numbers_of(topic: str, ros_type: str) -> Callable[[bytes], dict[str, np.ndarray]]:
    """Return what finds the numbers of a message by field; header stamps are left out, log times stand for them."""
    if ros_type == _MULTI_ARRAY and topic[1:] in ARRAYS:
        fields = ARRAYS[topic[1:]].fields
        return lambda data: dict(zip(fields, trailing_doubles(data).reshape(len(fields), -1)))
    if ros_type == _FLOAT:
        return lambda data: {"data": np.array(struct.unpack_from("<d", data, 4))}
    return lambda data: dict(_flattened(_deserialized(ros_type, data), ""))


@cache
def _typestore():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _deserialized(ros_type: str, data: bytes):
    return _typestore().deserialize_cdr(data, ros_type) if ros_type in _typestore().types else None


def _flattened(value, path: str) -> Iterator[tuple[str, np.ndarray]]:
    if isinstance(value, np.ndarray):
        rows = value.astype(float)
        yield path, rows
    elif isinstance(value, (bool, int, float)):
        yield path, np.array([float(value)])
    elif isinstance(value, list):
        for k, item in enumerate(value):
            yield from _flattened(item, f"{path}[{k}]")
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            if name not in ("__msgtype__", "header", "layout"):
                yield from _flattened(getattr(value, name), f"{path}.{name}" if path else name)
