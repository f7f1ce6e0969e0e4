# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The numbers of serialised messages, by field: of one message, or of many that are laid out alike at once."""

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from bearing_sim.topics import ARRAYS

_MULTI_ARRAY = "std_msgs/msg/Float64MultiArray"
_STAMP = slice(4, 12)  # [byte] of a message that begins with a header
_WORD = 8  # [byte] of a number


class NumberPlaces(NamedTuple):
    """Where the numbers stand in messages of one topic and length, or in rows of several messages.

    Attributes
    ----------
    places : first byte of each number.
    fixed : uint8, 255 at the bytes that are the same in all messages laid out alike, else 0.
    alike : what stands there, uint8.
    runs : first byte and count of numbers that lie side by side.
    """

    places: np.ndarray
    fixed: np.ndarray
    alike: np.ndarray
    runs: tuple[tuple[int, int], ...]

    @classmethod
    def of(cls, places: np.ndarray, fixed: np.ndarray, example: np.ndarray) -> "NumberPlaces":
        """Return the places in what is laid out like an example, uint8."""
        runs = np.split(places, np.flatnonzero(np.diff(places) != _WORD) + 1)
        return cls(places, fixed, example.copy(), tuple((int(run[0]), len(run)) for run in runs if len(run)))

    def numbers(self, data: np.ndarray) -> np.ndarray | None:
        """Return the numbers of messages, uint8 of shape (n, length), as shape (n, numbers); None where not all are laid out alike."""
        if ((data ^ self.alike) & self.fixed).any():
            return None
        parts = [np.ascontiguousarray(data[:, place : place + _WORD * count]).view("<f8") for place, count in self.runs]
        return np.concatenate(parts, axis=1) if parts else np.empty((len(data), 0))


def numbers_of(topic: str, ros_type: str, data: bytes) -> dict[str, np.ndarray]:
    """Return the numbers of a message by field; the header is left out, and so is all of a message of an unknown type.

    Parameters
    ----------
    topic : its topic; says what the rows of an array of ours are.
    ros_type : such as ``"std_msgs/msg/Float64"``.
    data : the serialised message.
    """
    message = deserialized(ros_type, data)
    return {} if message is None else _by_field(topic, ros_type, message)


def number_places(topic: str, ros_type: str, data: bytes) -> NumberPlaces | None:
    """Return where the numbers stand in messages laid out like this one; None where they cannot be told, as where not all are float64.

    The message is serialised again with numbers that are each told from the others, and these are looked for.

    Parameters
    ----------
    topic, ros_type, data : see `numbers_of`.
    """
    message = deserialized(ros_type, data)
    if message is None:
        return None
    probe = _with_numbers(message, np.random.default_rng(1))
    cdr = bytes(_typestore().serialize_cdr(probe, ros_type))
    found = [cdr.find(number.tobytes()) for part in _by_field(topic, ros_type, probe).values() for number in part]
    actual = np.concatenate([*_by_field(topic, ros_type, message).values(), np.empty(0)])
    if -1 in found or len(set(found)) < len(found) or len(cdr) > len(data):
        return None
    fixed = np.full(len(data), 255, np.uint8)
    for place in found:
        fixed[place : place + _WORD] = 0
    if hasattr(message, "header"):
        fixed[_STAMP] = 0
    places = NumberPlaces.of(np.array(found, np.intp), fixed, np.frombuffer(data, np.uint8))
    [numbers] = places.numbers(np.frombuffer(data, np.uint8)[None])
    return places if np.array_equal(numbers, actual, equal_nan=True) else None


def deserialized(ros_type: str, data: bytes):
    """Return a message as an object with its fields as attributes; None for one of a type that is not ROS 2 Jazzy's."""
    return _typestore().deserialize_cdr(data, ros_type) if ros_type in _typestore().types else None


@cache
def _typestore():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _by_field(topic: str, ros_type: str, message) -> dict[str, np.ndarray]:
    if ros_type == _MULTI_ARRAY and topic[1:] in ARRAYS:
        fields = ARRAYS[topic[1:]].fields
        return dict(zip(fields, message.data.reshape(len(fields), -1)))
    return dict(_flattened(message, ""))


def _flattened(value, path: str) -> Iterator[tuple[str, np.ndarray]]:
    if isinstance(value, np.ndarray):
        yield path, value.astype(float)
    elif isinstance(value, (bool, int, float)):
        yield path, np.array([float(value)])
    elif isinstance(value, list):
        for k, item in enumerate(value):
            yield from _flattened(item, f"{path}[{k}]")
    elif hasattr(value, "__dataclass_fields__"):
        for name in value.__dataclass_fields__:
            if name not in ("__msgtype__", "header", "layout"):
                yield from _flattened(getattr(value, name), f"{path}.{name}" if path else name)


def _with_numbers(value, lot: np.random.Generator):
    """Return a message with other floating-point numbers, each told from the others."""
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        return lot.uniform(1.0, 2.0, value.shape)
    if isinstance(value, float):
        return float(lot.uniform(1.0, 2.0))
    if isinstance(value, list):
        return [_with_numbers(item, lot) for item in value]
    if hasattr(value, "__dataclass_fields__"):
        names = [name for name in value.__dataclass_fields__ if name != "__msgtype__"]
        return type(value)(**{name: _with_numbers(getattr(value, name), lot) for name in names})
    return value
