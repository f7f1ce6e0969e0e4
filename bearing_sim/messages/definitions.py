# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of any type, decoded by the definition that their recording carries, within limits on what a definition or a message may cost.

A definition is text (https://design.ros2.org/articles/legacy_interface_definition.html): a line for each field, constants, and the definitions
of the types that it contains.  From it `decoder` makes a function that decodes messages.  A stranger may have written both: a
definition may have a hundred thousand fields, or contain itself; a message may say that an array has four thousand million items.  So
nothing is generated or executed, no item is made before its bytes are known to be there, and what a message may contain is counted.

Serialised ROS 2 messages are CDR (see `bearing_sim.messages.cdr`).  Those of ROS 1 have the same fields without alignment, always
little-endian, and their texts do not end in a zero (http://wiki.ros.org/msg).
"""

import re
import struct
from collections.abc import Callable, Container, Mapping
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype

from bearing_sim.files.limits import DEFINITION, DEFINITION_DEPTH, DEFINITION_FIELDS, MESSAGE_ITEMS
from bearing_sim.messages.cdr import NUMBERS, CdrError, Cursor, cursor_of, typestore

_SEPARATOR = re.compile(r"^={3,}[ \t\r]*$", re.MULTILINE)
_NAMED = re.compile(r"\s*MSG:[ \t]+(\S+)[ \t\r]*(?:\n|$)")
_NAMED_IDL = re.compile(r"\A\s*IDL:[ \t]*(\S*)[^\n]*(?:\n|$)")
_PREPROCESSOR = re.compile(r"^[ \t]*#(?:[^\n\\]|\\\n|\\.)*", re.MULTILINE)  # an include names a part that stands in the same text
_ENUM = re.compile(r"\benum\s+(\w+)\s*\{[^{}]*\}")  # CDR writes one as a number of 32 bits
_TYPE = re.compile(r"([A-Za-z][\w/]{0,255})(?:<=\d{1,10})?(?:\[(<=)?(\d{0,10})\])?")
_FIELD = re.compile(r"([A-Za-z]\w{0,255})(\s*=)?")
_TEXTS = ("string", "wstring")
_CODES = {"?": "?", "f4": "f", "f8": "d"} | dict(zip(("i1", "i2", "i4", "i8"), "bhiq")) | dict(zip(("u1", "u2", "u4", "u8"), "BHIQ"))
"""Code of the struct module by NumPy type."""
_ROS1 = {"time": (("sec", "uint32"), ("nanosec", "uint32")), "duration": (("sec", "int32"), ("nanosec", "int32"))}
"""Types of ROS 1 that are messages of the package builtin_interfaces in ROS 2."""


class DefinitionError(ValueError):
    """A definition that cannot be used; the message says which type and why."""


class FieldType(NamedTuple):
    """Type of a field: the name of a number, of a text or of a message (``pkg/Type``); and how many there are.

    ``count`` is None for a single one, -1 for a sequence, otherwise the length of the array.
    """

    name: str
    count: int | None = None


_Read = Callable[[Cursor], object]


def decoder(name: str, encoding: str, definition: bytes, note: Callable[[str], None] = lambda text: None) -> Callable[[bytes], object]:
    """Return a function that decodes messages of a type into objects with the fields as attributes.

    Arrays of numbers are NumPy arrays, others are lists; a stamp is a message of ``sec`` and ``nanosec``.  The function raises
    `CdrError` for bytes that are no such message.

    Parameters
    ----------
    name : of the type, such as ``sensor_msgs/msg/JointState``.
    encoding : of the definition: ``ros2msg``, ``ros2idl``, or ``ros1msg``, which also says that messages are those of ROS 1.
    definition : its text; where it is empty, does not define a type that it contains, or cannot be parsed, that of ROS 2 Jazzy is taken.
    note : called with a text for each type that is taken from ROS 2 because its definition cannot be parsed.

    Raises
    ------
    DefinitionError
        The definition cannot be parsed and the type is none of ROS 2 Jazzy, or it contains an unknown type or itself, or exceeds a limit.
    """
    is_ros1, items = encoding == "ros1msg", MESSAGE_ITEMS.value
    try:
        read = _Readers(*_parsed(name, encoding, definition), is_ros1, note).message(_short(name))
    except DefinitionError as error:
        if is_ros1 or _standard(_short(name)) is None:  # the types of ROS 1 differ from those of ROS 2, such as the header
            raise
        why = str(error).removeprefix(f"the definition of {name[:80]}").lstrip(": ")
        note(f"the definition of {name[:80]} cannot be used ({why}); that of ROS 2 Jazzy is used")
        read = _Readers({}, {}, False, note).message(_short(name))

    def decode(data: bytes) -> object:
        data = bytes(data)
        if is_ros1:
            return read(Cursor(data, 0, "<", -1, items))
        return read(cursor_of(data, items))

    return decode


def ros2_name(name: str) -> str:
    """Return the name of a type as ROS 2 writes it: of ``std_msgs::msg::dds_::Bool_`` (DDS) and ``std_msgs/Bool`` it is ``std_msgs/msg/Bool``."""
    if found := re.fullmatch(r"(\w+)::(\w+)::(?:dds_::)?(\w+?)_?", name):
        return "/".join(found.groups())
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", name)


def _standard(name: str):
    """Return the fields of a standard message of ROS 2 Jazzy, as the rosbags library describes them; None for another type."""
    package, _, short = name.partition("/")
    found = typestore().fielddefs.get(f"{package}/msg/{short}")
    return None if found is None else found[1]


def _parsed(name: str, encoding: str, definition: bytes) -> tuple[dict[str, list[tuple[str, FieldType]]], dict[str, str]]:
    """Return the fields of all types that a definition has, and why that of a type cannot be parsed, by the names of types."""
    if len(definition) > DEFINITION.value:
        raise DefinitionError(f"the definition of {name[:80]} has {DEFINITION.refusal(len(definition))}")
    try:
        text = definition.decode()
    except UnicodeDecodeError:
        raise DefinitionError(f"the definition of {name[:80]} is no UTF-8 text") from None
    if encoding == "ros2idl":
        return _from_idl(name, text)
    if encoding in ("ros2msg", "ros1msg") or not text:
        return _from_msg(name, text), {}
    raise DefinitionError(f"the definition of {name[:80]} is written in {encoding[:40]!r}; expected ros2msg, ros2idl or ros1msg")


def _short(name: str) -> str:
    """Return the name of a type without the part that says that it is a message: ``pkg/Type``."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}" if rest else name


def _from_msg(name: str, text: str) -> dict[str, list[tuple[str, FieldType]]]:
    """Return the fields of all types that a text in the syntax of ``.msg`` files defines, by the names of types."""
    types: dict[str, list[tuple[str, FieldType]]] = {}
    count = 0
    for number, part in enumerate(_SEPARATOR.split(text) if text.strip() else ()):
        own = name
        if named := _NAMED.match(part):
            own, part = named[1], part[named.end() :]
        elif number:
            raise DefinitionError(f"the definition of {name[:80]}: a part without a line such as MSG: pkg/Type")
        fields = types.setdefault(_short(own), [])
        fields.clear()
        for line in part.splitlines():
            if (field := _field_of(line, _short(own))) is not None:
                fields.append(field)
                count += 1
        if count > DEFINITION_FIELDS.value:
            raise DefinitionError(f"the definition of {name[:80]} has {DEFINITION_FIELDS.refusal()}")
    return types


def _field_of(line: str, owner: str) -> tuple[str, FieldType] | None:
    """Return name and type of the field that a line defines; None for a constant, a comment or an empty line."""
    words = line.partition("#")[0].strip().split(None, 1)
    if not words:
        return None
    kind, field = _TYPE.fullmatch(words[0]), _FIELD.match(words[1]) if len(words) > 1 else None
    if kind is None or field is None:
        raise DefinitionError(f"the definition of {owner[:80]}: cannot parse {line.strip()[:80]!r}; expected a type and a name")
    if field[2]:
        return None
    name = kind[1]
    if name not in NUMBERS and name not in _TEXTS and name not in _ROS1:
        name = "std_msgs/Header" if name == "Header" else _short(name) if "/" in name else f"{owner.partition('/')[0]}/{name}"
    if kind[3] is None:
        return field[1], FieldType(name)
    return field[1], FieldType(name, -1 if kind[2] or not kind[3] else int(kind[3]))


def _from_idl(name: str, text: str) -> tuple[dict[str, list[tuple[str, FieldType]]], dict[str, str]]:
    """Return the fields of all types that a text in OMG IDL defines, and why a part cannot be parsed, by the names of types."""
    from rosbags.typesys import get_types_from_idl

    found, faults = {}, {}
    for part in _SEPARATOR.split(text):
        own, named = name, _NAMED_IDL.match(part)
        if named:
            own, part = named[1] or name, part[named.end() :]
        part = _ENUM.sub(r"typedef uint32 \1", _PREPROCESSOR.sub("", part))
        if not part.strip():
            continue
        try:
            found |= get_types_from_idl(part)
        except Exception as error:  # the parser raises exceptions of many kinds; the third line is where it could not go on
            at = [*str(error).splitlines(), "", "", ""][2]
            rest = f" at {part[int(at) :].split(chr(10))[0][:40]!r}" if at.isdigit() else ""
            faults[_short(own)] = f"the definition of {own[:80]} cannot be parsed as IDL{rest}"
    if sum(len(fields) for _, fields in found.values()) > DEFINITION_FIELDS.value:
        raise DefinitionError(f"the definition has {DEFINITION_FIELDS.refusal()}")
    return {_short(each): _converted(fields, each, found) for each, (_, fields) in found.items()}, faults


def _converted(fields, owner: str = "", known: Container[str] = ()) -> list[tuple[str, FieldType]]:
    """Return fields as the rosbags library describes them as ours; names of types relative to that of ``owner`` are looked up in ``known``."""
    scopes = owner.split("/")[:-1]

    def named(node, detail) -> str:
        if node == Nodetype.BASE:
            return detail[0].replace("octet", "byte")
        candidates = ("/".join([*scopes[:k], detail]) for k in range(len(scopes), 0, -1))
        return _short(detail if detail in known else next((each for each in candidates if each in known), detail))

    found = []
    for name, (node, detail) in fields:
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            item, count = detail
            found.append((name, FieldType(named(*item), count if node == Nodetype.ARRAY else -1)))
        else:
            found.append((name, FieldType(named(node, detail))))
    return [field for field in found if field[0] != "structure_needs_at_least_one_member"]


class _Readers:
    """Makes the functions that read messages and fields, one for each type of message.

    Parameters
    ----------
    types : fields by the name of the type; types that are not there are those of ROS 2 Jazzy.
    faults : why the definition of a type cannot be parsed, by the name of the type.
    is_ros1 : whether messages are serialised as in ROS 1.
    note : called with a text where that of ROS 2 is used instead.
    """

    def __init__(self, types: Mapping[str, list[tuple[str, FieldType]]], faults: Mapping[str, str], is_ros1: bool, note: Callable[[str], None]):
        self._types, self._is_ros1, self._faults, self._note = types, is_ros1, faults, note
        self._made: dict[str, _Read] = {}
        self._levels: dict[str, int] = {}  # of messages within messages, by type
        self._open: list[str] = []

    def message(self, name: str) -> _Read:
        """Return a function that reads a message of a type."""
        if name in self._made:
            return self._made[name]
        if name in self._open:
            raise DefinitionError(f"{name[:80]} contains itself")
        self._open.append(name)
        self._require_depth(name, len(self._open))
        fields = self._fields(name)
        parts = [(field, self._field(kind)) for field, kind in fields]
        self._open.pop()
        self._levels[name] = 1 + max((self._levels.get(kind.name, 0) for _, kind in fields), default=0)
        self._require_depth(name, self._levels[name])
        if len({field for field, _ in parts}) < len(parts):
            raise DefinitionError(f"the definition of {name[:80]} has two fields of one name")
        pads = not parts and not self._is_ros1  # CDR has no empty messages: one byte stands for it

        def read(cursor: Cursor) -> SimpleNamespace:
            cursor.make_item()
            if pads:
                cursor.consume(1)
            return SimpleNamespace(**{field: part(cursor) for field, part in parts})

        self._made[name] = read
        return read

    @staticmethod
    def _require_depth(name: str, levels: int) -> None:
        if levels > DEFINITION_DEPTH.value:
            raise DefinitionError(f"the definition of {name[:80]} has {DEFINITION_DEPTH.refusal(levels)}")

    def _fields(self, name: str) -> list[tuple[str, FieldType]]:
        if name in self._types:
            return self._types[name]
        if name in _ROS1:
            return [(field, FieldType(number)) for field, number in _ROS1[name]]
        standard, fault = _standard(name), self._faults.get(name)
        if standard is None:
            raise DefinitionError(fault or f"{name[:80] or 'the type'} is not defined in the recording, nor a standard message of ROS 2")
        if fault:
            self._note(f"{fault}; that of ROS 2 Jazzy is used")
        return _converted(standard)

    def _field(self, kind: FieldType) -> _Read:
        if kind.name in NUMBERS:
            return self._numbers(kind)
        if kind.name == "wstring":
            raise DefinitionError("texts of type wstring are not supported")
        item = self._text if kind.name == "string" else self.message(kind.name)
        if kind.count is None:
            return item
        fixed = kind.count

        def read(cursor: Cursor) -> list:
            count = cursor.length() if fixed < 0 else fixed
            cursor.make_item()
            if count > cursor.items:
                raise CdrError(f"it contains {MESSAGE_ITEMS.refusal()}")
            if count > len(cursor.data) - cursor.at and not self._is_ros1:  # in CDR, no item takes less than a byte
                raise CdrError(f"{len(cursor.data)} bytes end within an array of {count} items")
            return [item(cursor) for _ in range(count)]

        return read

    def _numbers(self, kind: FieldType) -> _Read:
        form = NUMBERS[kind.name]
        dtypes = {order: np.dtype(order + form) for order in "<>"}
        size, fixed = dtypes["<"].itemsize, kind.count
        if fixed is None:
            unpack = {order: struct.Struct(order + _CODES[form]).unpack_from for order in "<>"}
            return lambda cursor: unpack[cursor.order](cursor.data, cursor.consume(size))[0]

        def read(cursor: Cursor) -> np.ndarray:
            cursor.make_item()
            count = cursor.length() if fixed < 0 else fixed
            begin = cursor.consume(size, count) if count else cursor.at
            return np.frombuffer(cursor.data, dtypes[cursor.order], count, begin)

        return read

    def _text(self, cursor: Cursor) -> str:
        cursor.make_item()
        length = cursor.length()
        begin = cursor.consume(1, length)
        end = cursor.at if self._is_ros1 else max(cursor.at - 1, begin)
        try:
            return cursor.data[begin:end].decode()
        except UnicodeDecodeError:
            raise CdrError(f"the text at byte {begin} is not UTF-8") from None
