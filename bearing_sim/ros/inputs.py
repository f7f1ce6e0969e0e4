# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read input messages cheaply from their bytes, as subscriptions with ``raw=True`` bring them.

Having rclpy make an object of every message costs several times what is then done with it.  The messages of a sender differ in nothing
but stamp and numbers, though: the first is read through its object, which tells where these stand, and the next ones are read there, as
long as every other byte is the same.  What is different in any way is read through an object again, so that nothing is ever guessed.
"""

import math
import struct
from collections.abc import Callable, Iterator
from operator import itemgetter
from typing import NamedTuple

from rclpy.serialization import deserialize_message

from bearing_sim import topics
from bearing_sim.ros.messages import message_class

_MOST_LAYOUTS = 16  # learned of one channel: where senders differ from message to message, learning is dearer than reading objects
_ENCAPSULATION = 4  # [byte] before a message's fields: two that name the representation, two of options (OMG DDSI-RTPS 2.5, 10.2)
_CDR_LE = b"\x00\x01"  # little-endian CDR version 1, the representation whose alignment is known here
_SIZES = {"double": 8, "int32": 4, "uint32": 4}  # [byte] of plain fields; none of the messages that carry inputs has others


class Refused(ValueError):
    """A message that cannot be used, with the code of the event that tells it."""

    def __init__(self, code: str, reason: str):
        super().__init__(reason)
        self.code = code


class Reading(NamedTuple):
    """What a message says."""

    values: tuple[float, ...]  # in SI, see `bearing_sim.topics.input_values`
    stamp_ns: int | None  # [ns since the epoch]; None where it has none
    frame_id: str


class InputReader:
    """Reads the messages of one input channel.

    Parameters
    ----------
    channel, ros_type : see `bearing_sim.topics.input_values`.
    joint : name of the joint in a JointState.
    frame_id : the frame in which a load counts; empty where any does.
    """

    def __init__(self, channel: str, ros_type: str, joint: str, frame_id: str):
        self._channel, self._ros_type, self._joint, self._frame_id = channel, ros_type, joint, frame_id
        self._class = message_class(ros_type)
        self._layouts: dict[int, _Layout] = {}  # by the length of the message
        self._learned = 0

    def read(self, cdr: bytes) -> Reading:
        """Return what a serialised message says.

        Raises
        ------
        Refused
            It is none of the type, lacks the joint's velocity, or names another frame.
        """
        layout = self._layouts.get(len(cdr))
        if layout is not None and (reading := layout.read(cdr)) is not None:
            return reading
        try:
            message = deserialize_message(cdr, self._class)
        except Exception as fault:  # its kind depends on the middleware
            raise Refused("input.malformed", f"{len(cdr)} bytes that are no {self._ros_type}: {' '.join(str(fault).split())}") from fault
        reading = self._read_object(message)
        if self._learned < _MOST_LAYOUTS and all(map(math.isfinite, reading.values)):
            self._learned += 1
            self._learn(cdr, message, reading)
        return reading

    def _read_object(self, message) -> Reading:
        frame_id = topics.frame_of(message)
        if self._channel == "radial_load" and self._frame_id and frame_id not in ("", self._frame_id):  # other inputs have no direction
            reason = f"frame {frame_id!r}, expected {self._frame_id!r} (parameter frame_id), for the force's direction would be another"
            raise Refused("input.frame", reason)
        try:
            values = topics.input_values(self._channel, self._ros_type, message, self._joint)
        except ValueError as fault:
            raise Refused("input.malformed", str(fault)) from fault
        return Reading(values, topics.header_stamp_ns(message), frame_id)

    def _learn(self, cdr: bytes, message, reading: Reading) -> None:
        """Take notice of where such messages have stamp and numbers, where the numbers there are those that the object has given."""
        parts = {part.name: part for part in _parts(message)}
        if self._ros_type.endswith("JointState"):
            numbers = (f"velocity[{message.name.index(self._joint)}]",)
        else:
            numbers = ("wrench.force.y", "wrench.force.z") if self._ros_type.endswith("WrenchStamped") else ("data",)
        if cdr[: len(_CDR_LE)] != _CDR_LE or not all(name in parts for name in numbers):  # a temperature is sent in other units
            return
        layout = _layout(cdr, parts, numbers, reading.frame_id)
        if layout.read(cdr) == reading:
            self._layouts[len(cdr)] = layout


class _Part(NamedTuple):
    """A field of a message, or the count before one, among its bytes."""

    name: str
    begin: int
    end: int
    varies: bool  # a number or a part of the stamp


class _Layout(NamedTuple):
    """Where stamp and numbers stand in messages that agree in all else.

    Attributes
    ----------
    pieces : takes such a message to pieces, in their order: what all of them have, the stamp's seconds and nanoseconds, the numbers wanted.
    same, values : return of the pieces what all of them have, and the numbers.
    expected : what all of them have.
    stamp : place of the seconds among the pieces; None where there is no stamp.
    """

    pieces: struct.Struct
    same: Callable[[tuple], object]
    values: Callable[[tuple], tuple[float, ...]]
    expected: object
    stamp: int | None
    frame_id: str

    def read(self, cdr: bytes) -> Reading | None:
        """Return what a message of the right length says; None where it has not this layout."""
        found = self.pieces.unpack(cdr)
        if self.same(found) != self.expected:
            return None
        stamp = self.stamp
        stamp_ns = None if stamp is None else found[stamp] * 1_000_000_000 + found[stamp + 1] or None
        return Reading(self.values(found), stamp_ns, self.frame_id)


def _layout(cdr: bytes, parts: dict[str, _Part], numbers: tuple[str, ...], frame_id: str) -> _Layout:
    shape, end, kinds = f"<{len(_CDR_LE)}s", len(_CDR_LE), ["same"]
    for part in parts.values():
        kind, code = ("same", f"{part.end - part.begin}s") if not part.varies else ("value", "d") if part.name in numbers else ("", "")
        if ".stamp." in part.name:
            kind, code = "stamp", "iI"[part.name.endswith("nanosec")]
        if kind:
            shape, end = f"{shape}{part.begin - end}x{code}", part.end
            kinds.append(kind)
    pieces = struct.Struct(f"{shape}{len(cdr) - end}x")
    same, values = ([k for k, kind in enumerate(kinds) if kind == wanted] for wanted in ("same", "value"))
    take_values = itemgetter(*values) if len(values) > 1 else itemgetter(slice(values[0], values[0] + 1))
    take_same = itemgetter(*same)
    stamp = kinds.index("stamp") if "stamp" in kinds else None
    return _Layout(pieces, take_same, take_values, take_same(pieces.unpack(cdr)), stamp, frame_id)


def _parts(message) -> Iterator[_Part]:
    """Yield where the fields of a message stand in its bytes (OMG CDR version 1: each aligned to its own size)."""
    at = _ENCAPSULATION
    for name, kind, value in _fields("", message):
        if kind == "string":
            size, unit = 4 + len(value.encode()) + 1, 4  # its length, itself and a zero
        else:
            size = unit = _SIZES[kind]
        at += -(at - _ENCAPSULATION) % unit
        yield _Part(name, at, at + size, kind == "double" or ".stamp." in name)
        at += size


def _fields(path: str, message) -> Iterator[tuple[str, str, object]]:
    """Yield name, plain type and value of all fields of a message in their order, those of nested messages and counts of sequences too."""
    for field, kind in message.get_fields_and_field_types().items():
        name, value = f"{path}.{field}".lstrip("."), getattr(message, field)
        if kind.startswith("sequence<"):
            yield f"{name} count", "uint32", len(value)
            for k, item in enumerate(value):
                yield f"{name}[{k}]", kind.removeprefix("sequence<").removesuffix(">"), item
        elif "/" in kind:
            yield from _fields(name, value)
        else:
            yield name, kind, value
