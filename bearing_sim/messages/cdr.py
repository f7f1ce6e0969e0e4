# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Serialised ROS 2 messages without a ROS installation: types, serialisers, and where the fields of a message stand by the definition of its type.

ROS 2 serialises messages as CDR version 1 (OMG DDSI-RTPS 2.5, section 10; OMG CORBA 3.3 part 2, section 9.3): four bytes that name the
representation, then the fields in the order of the definition, each number aligned to its own size, counted from the end of those four bytes.
A string is its length in bytes, the text and a zero; a sequence is its count and its items.  Definitions alone therefore fix a layout but
for the lengths of strings and sequences, and those are read from the message itself.

The definitions are those of ROS 2 Jazzy in the rosbags library.  Serialising samples, reading numbers back from recordings and decoding
input messages all use this one layout.
"""

import struct
from collections.abc import Callable, Iterable, Sequence
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from bearing_sim.files.limits import MESSAGE_ITEMS
from bearing_sim.messages import topics
from bearing_sim.messages.point_cloud import NUMPY_TYPES

ENCAPSULATION = 4  # [byte] before the fields: two that name the representation, two of options
STAMP_FIELDS = ("header.stamp.sec", "header.stamp.nanosec")
ORDERS = {b"\0\0": ">", b"\0\1": "<"}  # by the name of the representation: CDR version 1, big-endian and little-endian
NUMBERS = {"bool": "?", "byte": "u1", "char": "u1", "float32": "f4", "float64": "f8"} | {
    f"{sign}int{8 * size}": f"{sign or 'i'}{size}" for size in (1, 2, 4, 8) for sign in ("", "u")
}
"""NumPy type of each kind of number of message definitions."""
POINT_CLOUD = "sensor_msgs/msg/PointCloud2"
_NOT_PAYLOAD = {"header", "layout"}  # fields whose numbers describe the message


class CdrError(ValueError):
    """Bytes that are not a message of the given type."""


class Field(NamedTuple):
    """A field of a message, or the count before the items of a sequence.

    Attributes
    ----------
    path : where the message has it, such as ``wrench.force.y``, ``velocity`` (all its numbers) or ``status[0].name``.
    dtype : NumPy type of its numbers; None for a string.
    begin : first byte in the message; of a string that of its length.
    count : how many numbers there are; 1 unless it is an array.
    end : byte after the last one.
    is_count : whether this is the number of items of the sequence at ``path``.
    """

    path: str
    dtype: np.dtype | None
    begin: int
    count: int
    end: int
    is_count: bool = False

    @property
    def is_payload(self) -> bool:
        """Whether it holds numbers that the message is about: neither a count nor text, nor a part of a header or of an array's layout."""
        return self.dtype is not None and not self.is_count and _NOT_PAYLOAD.isdisjoint(name.partition("[")[0] for name in self.path.split("."))


class Cursor:
    """The place in a message that is being decoded.

    Attributes
    ----------
    data, at : the bytes, and the next one to be read.
    order : ``"<"`` or ``">"``.
    base : byte from which alignment is counted; -1 without alignment.
    items : how many texts, arrays and messages may still be made.

    Raises
    ------
    CdrError
        Its methods: the message ends before what is read, or contains more than the limit.
    """

    __slots__ = ("data", "at", "order", "base", "items")

    def __init__(self, data: bytes, at: int, order: str, base: int, items: int):
        self.data, self.at, self.order, self.base, self.items = data, at, order, base, items

    def consume(self, size: int, count: int = 1) -> int:
        """Return where numbers of a size [byte] begin, and go behind them."""
        begin = self.at
        if self.base >= 0:
            begin += -(begin - self.base) % size
        self.at = begin + size * count
        if self.at > len(self.data):
            raise CdrError(f"{len(self.data)} bytes end within the message")
        return begin

    def make_item(self) -> None:
        """Count a text, array or message."""
        self.items -= 1
        if self.items < 0:
            raise CdrError(f"it contains {MESSAGE_ITEMS.refusal()}")

    def length(self) -> int:
        """Return the length of a text or a sequence, which comes before it."""
        (length,) = struct.unpack_from(self.order + "I", self.data, self.consume(4))
        return length


def cursor_of(data: bytes, items: int) -> Cursor:
    """Return the place at which the fields of a serialised message begin; raise `CdrError` if it is no message in CDR version 1."""
    order = ORDERS.get(bytes(data[:2]))
    if order is None or len(data) < ENCAPSULATION:
        raise CdrError(f"expected a message in CDR version 1; its first bytes are {bytes(data[:ENCAPSULATION]).hex() or 'none'}")
    return Cursor(data, ENCAPSULATION, order, ENCAPSULATION, items)


class CdrLayout:
    """The fields of one message, and of every message that is laid out alike.

    Parameters
    ----------
    ros_type : such as ``"sensor_msgs/msg/JointState"``.
    data : the serialised message.

    Attributes
    ----------
    fields : in the order of the message.

    Raises
    ------
    CdrError
        The bytes are not a message of this type.
    KeyError
        The type is unknown (see `is_known`).
    """

    def __init__(self, ros_type: str, data: bytes):
        self.fields: list[Field] = []
        try:
            self._cursor = cursor_of(data, MESSAGE_ITEMS.value)
            self._walk("", ros_type)
        except CdrError as error:
            raise CdrError(f"a message of {ros_type}: {error}") from None

    @cached_property
    def by_path(self) -> dict[str, Field]:
        """The fields by path, without the counts of sequences."""
        return {field.path: field for field in self.fields if not field.is_count}

    @property
    def numbers(self) -> list[Field]:
        """The fields that hold the numbers of the message (see `Field.is_payload`)."""
        return [field for field in self.fields if field.is_payload]

    def values(self, data: bytes) -> dict[str, np.ndarray]:
        """Return the numbers of a message with this layout as float64, by path."""
        return {field.path: np.frombuffer(data, field.dtype, field.count, field.begin).astype(float) for field in self.numbers}

    def _walk(self, path: str, ros_type: str) -> None:
        for name, (node, detail) in _definition(ros_type):
            self._enter(f"{path}.{name}" if path else name, node, detail)

    def _enter(self, path: str, node: Nodetype, detail) -> None:
        if node == Nodetype.NAME:
            self._walk(path, detail)
        elif node == Nodetype.BASE:
            self._base(path, detail[0], 1)
        else:
            (item, item_detail), count = detail
            if node == Nodetype.SEQUENCE:
                self._cursor.make_item()
                count = self._cursor.length()
                self.fields.append(Field(path, _dtype(f"{self._cursor.order}u4"), self._cursor.at - 4, 1, self._cursor.at, True))
            if item == Nodetype.BASE and item_detail[0] in NUMBERS:
                self._base(path, item_detail[0], count)
                return
            if count > len(self._cursor.data) - self._cursor.at:
                raise CdrError(f"{len(self._cursor.data)} bytes end within an array of {count} items, of which none takes less than a byte")
            for k in range(count):
                self._enter(f"{path}[{k}]", item, item_detail)

    def _base(self, path: str, kind: str, count: int) -> None:
        cursor = self._cursor
        cursor.make_item()
        if kind in NUMBERS:
            dtype = _dtype(cursor.order + NUMBERS[kind])
            begin = cursor.consume(dtype.itemsize, count) if count else cursor.at
        else:
            dtype, length = None, cursor.length()
            begin = cursor.at - 4
            cursor.consume(1, length)
        self.fields.append(Field(path, dtype, begin, count, cursor.at))


class PointCloudLayout(CdrLayout):
    """The layout of a serialised point cloud, whose numbers are those of its points by the names of their fields.

    Fields of a point whose type is unknown, or that lie outside of the point, are left out, and so is ``is_dense``, which follows from the numbers.
    """

    def __init__(self, data: bytes):
        super().__init__(POINT_CLOUD, data)
        described = {field.path: field for field in self.fields if not field.is_count}
        whole = described.pop("data")
        order = ">" if self._number(described["is_bigendian"]) else "<"
        step, rows, row_step, width = (self._number(described[name]) for name in ("point_step", "height", "row_step", "width"))
        rows, width = (min(count, whole.count // step) if step else 0 for count in (rows, width))
        points = []
        for name in [field for path, field in described.items() if path.startswith("fields[") and path.endswith(".name")]:
            offset, kind, count = (self._number(described[name.path.replace(".name", f".{part}")]) for part in ("offset", "datatype", "count"))
            dtype = np.dtype(order + NUMPY_TYPES.get(kind, "u1"))
            if kind not in NUMPY_TYPES or offset + count * dtype.itemsize > step:
                continue
            text = data[name.begin + 4 : name.end - 1].decode(errors="replace")
            if len(points) + rows * width > MESSAGE_ITEMS.value:
                raise CdrError(f"it contains {MESSAGE_ITEMS.refusal()}")
            begins = (whole.begin + row * row_step + point * step + offset for row in range(rows) for point in range(width))
            points += [Field(text, dtype, begin, count, begin + count * dtype.itemsize) for begin in begins]
        self._points = [field for field in points if field.end <= whole.end]
        # The description is compared byte by byte, like counts.
        description = [field._replace(is_count=field.dtype is not None) for field in self.fields if field.path not in ("data", "is_dense")]
        self.fields = description + self._points

    def _number(self, field: Field) -> int:
        return int(np.frombuffer(self._cursor.data, field.dtype, 1, field.begin)[0])

    @property
    def numbers(self) -> list[Field]:
        """The numbers of the points, field by field."""
        return self._points

    def values(self, data: bytes) -> dict[str, np.ndarray]:
        """Return the numbers of a cloud with this layout as float64, by the name of their field, in the order of the points."""
        found: dict[str, list[np.ndarray]] = {}
        for field in self._points:
            found.setdefault(field.path, []).append(np.frombuffer(data, field.dtype, field.count, field.begin).astype(float))
        return {name: np.concatenate(parts) for name, parts in found.items()}


def layout_of(ros_type: str, data: bytes) -> CdrLayout:
    """Return the layout of a serialised message, of a point cloud that of its points; raises as `CdrLayout`."""
    return PointCloudLayout(data) if ros_type == POINT_CLOUD else CdrLayout(ros_type, data)


class NumberColumns:
    """Reads the numbers of many messages at once, or of many rows of several messages, as long as all are laid out alike.

    Every byte but numbers, the stamp of a header, and padding must be the same as in the example: names, frames, counts.

    Parameters
    ----------
    example : a message or row, uint8, shape (length,).
    layouts : (first byte in the row, layout) of the messages that are read.
    """

    def __init__(self, example: np.ndarray, layouts: Iterable[tuple[int, CdrLayout]]):
        compared = np.zeros(len(example), np.uint8)
        runs: list[tuple[int, int, np.dtype]] = []
        for begin, layout in layouts:
            compared[begin : begin + ENCAPSULATION] = 255
            for field in layout.fields:
                if field.is_payload:
                    _extend(runs, begin + field.begin, field.count, field.dtype)
                elif field.path not in STAMP_FIELDS:
                    compared[begin + field.begin : begin + field.end] = 255
        self._compared, self._example, self._runs = compared, example.copy(), runs
        self.count = sum(count for _, count, _ in runs)

    def read(self, rows: np.ndarray) -> np.ndarray | None:
        """Return the numbers of messages or rows, uint8 of shape (n, length), as float64 of shape (n, count); None where not all are alike."""
        if ((rows ^ self._example) & self._compared).any():
            return None
        parts = [np.ascontiguousarray(rows[:, at : at + count * dtype.itemsize]).view(dtype) for at, count, dtype in self._runs if count]
        return np.concatenate(parts, axis=1, dtype=float) if parts else np.empty((len(rows), 0))


def is_known(ros_type: str) -> bool:
    """Return whether the definition of a type is known: whether it is one of ROS 2 Jazzy's standard messages."""
    return ros_type in typestore().types


@cache
def typestore():
    """Return the message definitions of ROS 2 Jazzy, a store of the rosbags library."""
    return get_typestore(Stores.ROS2_JAZZY)


@cache
def _definition(ros_type: str) -> Sequence[tuple[str, tuple]]:
    return typestore().fielddefs[ros_type][1]


@cache
def _dtype(text: str) -> np.dtype:
    return np.dtype(text)


def _extend(runs: list[tuple[int, int, np.dtype]], at: int, count: int, dtype: np.dtype) -> None:
    """Add numbers to runs of neighbours of one type."""
    if runs and runs[-1][2] == dtype and runs[-1][0] + runs[-1][1] * dtype.itemsize == at:
        at, count = runs[-1][0], runs.pop()[1] + count
    runs.append((at, count, dtype))


class MessageType(NamedTuple):
    """Definition, hash and serialiser of one ROS type."""

    definition: str  # ros2msg text
    hash: str  # RIHS01
    serialize: Callable[[dict], bytes]  # nested dict -> CDR


@cache
def message_type(ros_type: str) -> MessageType:
    """Return definition, hash and serialiser of a ROS type such as ``"std_msgs/msg/Float64"``.

    Raises
    ------
    KeyError
        The type is not among ROS 2 Jazzy's standard messages.
    """
    store, fill = typestore(), _filler(ros_type)
    definition, _ = store.generate_msgdef(ros_type, ros_version=2)
    return MessageType(definition, store.hash_rihs01(ros_type), lambda message: bytes(store.serialize_cdr(fill(message), ros_type)))


def load_message_types() -> None:
    """Load the types of all topics of a recording, so that the first message does not wait a fraction of a second for them."""
    for topic in (*topics.INPUTS.values(), *topics.MEASUREMENTS.values(), *topics.RECORDED.values(), *topics.OUTPUTS.values()):
        message_type(topic.ros_type)
    message_type(topics.DIAGNOSTICS[1])


@cache
def _filler(ros_type: str) -> Callable[[dict], object]:
    store = typestore()
    message_class = store.types[ros_type]
    fields = [(name, _field_filler(*kind)) for name, kind in store.fielddefs[ros_type][1]]

    def fill(message: dict) -> object:
        return message_class(**{name: convert(message[name]) for name, convert in fields})

    return fill


def _field_filler(node: Nodetype, detail) -> Callable:
    if node == Nodetype.NAME:
        return _filler(detail)
    if node == Nodetype.BASE:
        return (lambda value: value[0]) if detail[0] == "byte" else (lambda value: value)
    (item_node, item_detail), _ = detail
    if item_node == Nodetype.NAME:
        fill = _filler(item_detail)
        return lambda values: [fill(value) for value in values]
    return list if item_detail[0] == "string" else (lambda values: np.asarray(values, item_detail[0]))
