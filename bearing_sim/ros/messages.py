# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""ROS messages from plain dicts (see `bearing_sim.messages.topics`), and the inputs in serialised messages.

Making rclpy build an object for every input message costs several times what is then done with it.  Messages of one sender differ only in
stamp and numbers, though: the first one is read through its object, which shows where these are, and later ones are read at these
positions as long as every other byte is the same.  Any message that differs is read through an object again; nothing is guessed.
"""

import array
import importlib
import math
import struct
from collections.abc import Callable
from functools import cache
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from rclpy.serialization import deserialize_message

from bearing_sim.inputs.static_transforms import StaticTransforms
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import STAMP_FIELDS, CdrLayout

_MOST_LAYOUTS = 16  # learned per channel: where a sender changes from message to message, learning costs more than objects do
_WORD = 8  # [byte] of a number
_ARRAY_CODES = {"u": "B"}  # of arrays of numbers, by the kind of their NumPy type; unlisted: float64
_CDR_LE = b"\x00\x01"  # little-endian CDR version 1, which nearly all senders use


@cache
def message_class(ros_type: str):
    """Return the class of ``"package/msg/Type"`` (also accepted: ``"package/Type"``).

    Raises
    ------
    ModuleNotFoundError
        The message package is not installed.
    """
    package, _, name = ros_type.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), name.rpartition("/")[2])


def message(ros_type: str, fields: dict):
    """Return a message of a type with the given fields."""
    filled = message_class(ros_type)()
    fill(filled, fields)
    return filled


def fill(target, fields: dict) -> None:
    """Set the fields of a message object, including nested ones.

    Raises
    ------
    AttributeError
        The message has no such field.
    """
    kinds = target.get_fields_and_field_types()
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(target, name), value)
        elif isinstance(value, np.ndarray):
            setattr(target, name, array.array(_ARRAY_CODES.get(value.dtype.kind, "d"), value.tolist()))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            item_type = kinds[name].removeprefix("sequence<").partition(">")[0]
            setattr(target, name, [message(item_type, item) for item in value])
        else:
            setattr(target, name, value)


class Refused(ValueError):
    """A message that cannot be used, with the kind of the event that reports it."""

    def __init__(self, kind: str, reason: str):
        super().__init__(reason)
        self.kind = kind


Contents = tuple[tuple[float, ...], int | None, str]
"""Contents of an input message: values in SI (see `bearing_sim.messages.topics.input_values`), stamp [ns since the epoch] or None, frame."""


class InputReader:
    """Reads the messages of one input channel.

    Parameters
    ----------
    channel, ros_type : see `bearing_sim.messages.topics.input_values`.
    joint : name of the joint in a JointState.
    frame_id : the bearing's frame, in which the model wants a load; empty: a load in any frame is accepted as it is.
    transforms : turn loads that are given in another frame.
    """

    def __init__(self, channel: str, ros_type: str, joint: str, frame_id: str, transforms: StaticTransforms | None = None):
        self._channel, self._ros_type, self._joint, self._frame_id = channel, ros_type, joint, frame_id
        self._transforms = StaticTransforms() if transforms is None else transforms
        self._class = message_class(ros_type)
        self._layouts: dict[int, _Layout] = {}  # by the length of the message
        self._learned = 0

    def read(self, cdr: bytes) -> Contents:
        """Return the contents of a serialised message.

        Raises
        ------
        Refused
            The message is not of the type, lacks the joint's number, or names another frame from which no transform is known.
        """
        layout = self._layouts.get(len(cdr))
        if layout is not None:
            pieces = layout.split.unpack(cdr)
            if layout.constants(pieces) == layout.expected:
                stamp = layout.stamp
                stamp_ns = None if stamp is None else pieces[stamp] * 1_000_000_000 + pieces[stamp + 1] or None
                values = layout.values(pieces)
                return (self._turned(values, layout.frame_id), stamp_ns, self._frame_id) if layout.is_turned else (values, stamp_ns, layout.frame_id)
        try:
            message = deserialize_message(cdr, self._class)
        except Exception as error:  # its type depends on the middleware
            raise Refused("input.malformed", f"{len(cdr)} bytes are not a {self._ros_type}: {' '.join(str(error).split())}") from error
        contents = self._read_object(message)
        if self._learned < _MOST_LAYOUTS and all(map(math.isfinite, contents[0])):
            self._learned += 1
            self._learn(cdr, message, contents)
        return contents

    def _read_object(self, message) -> Contents:
        frame_id = topics.frame_of(message)
        if self._must_be_turned(frame_id):
            force = message.wrench.force
            return self._turned((force.x, force.y, force.z), frame_id), topics.header_stamp_ns(message), self._frame_id
        try:
            values = topics.input_values(self._channel, self._ros_type, message, self._joint)
        except ValueError as error:
            raise Refused("input.malformed", str(error)) from error
        return values, topics.header_stamp_ns(message), frame_id

    def _must_be_turned(self, frame_id: str) -> bool:
        """Whether a message is a load in another frame than the bearing's; other inputs have no direction."""
        return self._channel == "radial_load" and bool(self._frame_id) and frame_id not in ("", self._frame_id)

    def _turned(self, force: tuple[float, ...], frame_id: str) -> tuple[float, float]:
        """Return the components y and z [N] in the bearing's frame of a force (x, y, z) in another one."""
        try:
            rotation = self._transforms.rotation(frame_id, self._frame_id)
        except LookupError as error:
            reason = (
                f"frame {frame_id!r}, expected {self._frame_id!r} (parameter frame_id); the direction of the force would be wrong: {error.args[0]}"
            )
            raise Refused("input.frame", reason) from error
        _, y, z = rotation @ force
        return float(y), float(z)

    def _learn(self, cdr: bytes, message, contents: Contents) -> None:
        """Learn the positions of stamp and numbers in such messages, if the numbers there are those of the object."""
        if cdr[: len(_CDR_LE)] != _CDR_LE:
            return
        fields, frame_id = CdrLayout(self._ros_type, cdr), topics.frame_of(message)
        is_turned = self._must_be_turned(frame_id)
        if self._ros_type.endswith("JointState"):
            names, begin = list(message.name), fields.by_path[topics.joint_numbers(self._channel)].begin
            joints = (self._joint, topics.standard_error_joint(self._joint))[: len(contents[0])]
            if names.index(joints[0]) != min(map(names.index, joints)):  # values come in the order of the message
                return
            numbers = tuple(begin + _WORD * names.index(joint) for joint in joints)
        elif self._ros_type.endswith("WrenchStamped"):
            numbers = tuple(fields.by_path[f"wrench.force.{axis}"].begin for axis in ("xyz" if is_turned else "yz"))
        elif "data" in fields.by_path:
            numbers = (fields.by_path["data"].begin,)
        else:  # a temperature is sent in degC and must be converted
            return
        layout = _layout(cdr, fields, numbers, frame_id, is_turned)
        values = layout.values(layout.split.unpack(cdr))
        if (self._turned(values, frame_id) if is_turned else values) == contents[0]:
            self._layouts[len(cdr)] = layout


class _Layout(NamedTuple):
    """The positions of stamp and numbers in messages that agree in everything else.

    Attributes
    ----------
    split : splits such a message into its constant parts, the stamp's seconds and nanoseconds, and the wanted numbers, in their order.
    constants, values : select the constant parts, and the numbers, from these pieces.
    expected : the constant parts.
    stamp : index of the seconds among the pieces; None if there is no stamp.
    frame_id : that the message names.
    is_turned : whether the numbers are a force in another frame than the bearing's.
    """

    split: struct.Struct
    constants: Callable[[tuple], object]
    values: Callable[[tuple], tuple[float, ...]]
    expected: object
    stamp: int | None
    frame_id: str
    is_turned: bool


def _layout(cdr: bytes, fields: CdrLayout, numbers: tuple[int, ...], frame_id: str, is_turned: bool) -> _Layout:
    """Return the layout of messages like this one, with the numbers that begin at the given bytes."""
    pieces = [(0, len(_CDR_LE), "constant")] + [(begin, begin + _WORD, "value") for begin in numbers]
    pieces += [
        (field.begin, field.end, {STAMP_FIELDS[0]: "seconds", STAMP_FIELDS[1]: "nanoseconds"}.get(field.path, "constant"))
        for field in fields.fields
        if not field.is_payload
    ]
    pieces.sort()
    codes, at = "<", 0
    for begin, end, kind in pieces:
        codes += f"{begin - at}x" + {"constant": f"{end - begin}s", "value": "d", "seconds": "i", "nanoseconds": "I"}[kind]
        at = end
    split = struct.Struct(f"{codes}{len(cdr) - at}x")
    kinds = [kind for *_, kind in pieces]
    constants, values = ([k for k, kind in enumerate(kinds) if kind == wanted] for wanted in ("constant", "value"))
    take_values = itemgetter(*values) if len(values) > 1 else itemgetter(slice(values[0], values[0] + 1))
    take_constants = itemgetter(*constants)
    stamp = kinds.index("seconds") if "seconds" in kinds else None
    return _Layout(split, take_constants, take_values, take_constants(split.unpack(cdr)), stamp, frame_id, is_turned)
