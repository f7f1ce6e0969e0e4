# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the fields of a record are: unit, default, range and meaning of each, from the declarations and the comments beside them.

``bearing-sim fields`` prints them, and the documents' page "Scene fields" is made of them.
"""

import ast
import dataclasses
import inspect
import io
import math
import re
import sys
import tokenize
import types
import typing
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import NamedTuple

from bearing_sim.scene.quantity import Quantity

_MOST_WORDS = 12  # of a choice that are listed


class FieldFacts(NamedTuple):
    """One field of a record; what a file has is between backticks.

    Attributes
    ----------
    path : dotted, from the outermost record; ``[]`` after a list.
    kind : unit of a quantity, or what else may stand there.
    default : ``required``, ``its defaults`` for a block, or the value.
    bounds : ``low to high``, or empty.
    meaning : in one line.
    """

    path: str
    kind: str
    default: str
    bounds: str
    meaning: str


class Block(NamedTuple):
    """One record, at its place.

    Attributes
    ----------
    path : dotted; empty for the outermost record.
    law : that selects this record among those that may stand there, or empty.
    record : its type.
    fields : in the order of the record, without ``law``.
    """

    path: str
    law: str
    record: type
    fields: tuple[FieldFacts, ...]


@cache
def hints_of(record: type) -> Mapping[str, object]:
    """Return the type hints of a record's fields by name, with their annotations; none for what is no record."""
    return typing.get_type_hints(record, include_extras=True) if dataclasses.is_dataclass(record) else {}


def type_parts(hint: object) -> tuple[list, list]:
    """Return the alternatives of a type hint, unions and annotations taken apart, and all metadata on the way."""
    if typing.get_origin(hint) is typing.Annotated:
        inner, *metadata = typing.get_args(hint)
        alternatives, more = type_parts(inner)
        return alternatives, [*metadata, *more]
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        taken = [type_parts(option) for option in typing.get_args(hint)]
        return [option for options, _ in taken for option in options], [item for _, metadata in taken for item in metadata]
    return [hint], []


def records_in(hint: object) -> list[type]:
    """Return the record types in a type hint, also as elements of a tuple."""
    options = [typing.get_args(option)[0] if typing.get_origin(option) is tuple else option for option in type_parts(hint)[0]]
    return [option for option in options if dataclasses.is_dataclass(option)]


def tags_of(record: type) -> tuple[str, ...]:
    """Return the values of the field ``law`` that select a record among those that may stand at its place."""
    return typing.get_args(hints_of(record).get("law"))


def declared_in(path: str, hint: object) -> Iterator[tuple[str, Quantity]]:
    """Yield the declarations of all quantities in a type hint, such as a record, by dotted paths that begin with ``path``."""
    options, metadata = type_parts(hint)
    declared = [note for note in metadata if isinstance(note, Quantity)]
    if declared:
        yield path, declared[0]
        return
    for option in options:
        for name, inner in hints_of(option).items():
            yield from declared_in(f"{path}.{name}", inner)


@cache
def blocks(record: type, path: str = "", law: str = "") -> tuple[Block, ...]:
    """Return a record and all records inside it, in order, each at its place below ``path``.

    Raises
    ------
    LookupError
        A field has no meaning.
    """
    hints, comments, facts, inner = hints_of(record), _comments(record), [], []
    for field in dataclasses.fields(record):
        if field.name == "law":
            continue
        place = f"{path}.{field.name}".lstrip(".")
        fact, records = _facts(field, place, hints[field.name], comments.get(field.name, ""))
        if not fact.meaning and not records:
            raise LookupError(f"{record.__module__}: the field {record.__name__}.{field.name} has no meaning; write it as a comment beside the field")
        facts.append(fact)
        inner += records
    return (Block(path, law, record, tuple(facts)), *(block for option, place, name in inner for block in blocks(option, place, name)))


def _facts(field: dataclasses.Field, place: str, hint, comment: str) -> tuple[FieldFacts, list[tuple[type, str, str]]]:
    """Return one field, and the records inside it, each with its place and its law."""
    alternatives, metadata = type_parts(hint)
    quantity = next((item for item in metadata if isinstance(item, Quantity)), None)
    records = [option for option in alternatives if dataclasses.is_dataclass(option)]
    element = next((typing.get_args(option)[0] for option in alternatives if typing.get_origin(option) is tuple), None)
    choices = [str(choice) for option in alternatives if typing.get_origin(option) is typing.Literal for choice in typing.get_args(option)]
    if element is not None and quantity is None:
        quantity = next((item for item in type_parts(element)[1] if isinstance(item, Quantity)), None)
    held = records or ([element] if dataclasses.is_dataclass(element) else [])
    first_sentence = re.split(r"(?<=[.;:])\s", prose(held[0].__doc__))[0].rstrip(".;:") if len(held) == 1 else ""
    inner = []
    if records:
        laws = [getattr(option, "law", "") if len(records) > 1 else "" for option in records]
        kind = "block, by `law`: " + ", ".join(f"`{law}`" for law in laws) if len(records) > 1 else f"block, see `{place}` below"
        inner = [(option, place, law) for option, law in zip(records, laws, strict=True)]
    elif held:
        kind, inner = "list of blocks", [(element, f"{place}[]", "")]
    elif quantity is not None:
        kind = ("list of " if element is not None else "") + (quantity.shown_in or quantity.unit or "number")
    elif choices:
        kind = ", ".join(f"`{word}`" for word in choices) if len(choices) < _MOST_WORDS else "one of the names below"
    else:
        kind = {bool: "true or false", int: "whole number", str: "text", float: "number"}.get(alternatives[0], "list")
    meaning = quantity.meaning if quantity is not None else comment or first_sentence
    return FieldFacts(place, kind, _default(field, quantity), _bounds(quantity, metadata), re.sub(r"\bNone\b", "null", meaning)), inner


def prose(docstring: str | None) -> str:
    """Return a docstring's text without its numpydoc sections, code between single backticks."""
    text = re.split(r"\n[A-Z]\w+\n-{3,}\n", inspect.cleandoc(docstring or ""))[0]
    return re.sub(r"``([^`]+)``", r"`\1`", text).strip()


def _comments(record: type) -> dict[str, str]:
    """Return the comment beside each field of a record, or the one directly above it, by field name."""
    (tree, found), comments = _parsed(record.__module__), {}
    node = next(item for item in ast.walk(tree) if isinstance(item, ast.ClassDef) and item.name == record.__name__)
    for item in node.body:
        if isinstance(item, ast.AnnAssign):
            beside = [found[line].string for line in range(item.lineno, item.end_lineno + 1) if line in found]
            above, line = [], item.lineno - 1
            while line in found and found[line].line.strip().startswith("#"):
                above.insert(0, found[line].string)
                line -= 1
            comments[item.target.id] = " ".join(text.lstrip("# ") for text in beside or above)
    return comments


@cache
def _parsed(module: str) -> tuple[ast.Module, dict[int, tokenize.TokenInfo]]:
    """Return the syntax tree of a module, and its comments by line."""
    source = inspect.getsource(sys.modules[module])
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return ast.parse(source), {token.start[0]: token for token in tokens if token.type == tokenize.COMMENT}


def _default(field: dataclasses.Field, quantity: Quantity | None) -> str:
    if field.default is not dataclasses.MISSING:
        value = field.default
        if isinstance(value, float):
            return f"`{value if quantity is None else quantity.show(value)}`"
        words = {None: "null", True: "true", False: "false", "": '""', (): "[]"}
        return f"`{words.get(value, value)}`"
    if field.default_factory is dataclasses.MISSING:
        return "required"
    law = getattr(field.default_factory(), "law", "")
    return f"`{law}`" if law else "its defaults"


def _bounds(quantity: Quantity | None, metadata: Iterable[object]) -> str:
    if quantity is not None:
        low, high = quantity.minimum, quantity.maximum
        return "" if math.isinf(low) and math.isinf(high) else f"{_plain(quantity.show(low))} to {_plain(quantity.show(high))}"
    constraints = [item for annotation in metadata for item in getattr(annotation, "metadata", [annotation])]
    low = [item.ge for item in constraints if hasattr(item, "ge")]
    high = [item.le for item in constraints if hasattr(item, "le")]
    return f"{low[0]} to {high[0]}" if low and high else ""


def _plain(text: str) -> str:
    """Return a quantity's text without an exponent, with commas between thousands."""
    number, space, unit = text.partition(" ")
    return f"{float(number):,.12g}{space}{unit}" if abs(float(number)) >= 1e4 else text


def records_at(record: type, path: str) -> Iterator[Block]:
    """Yield the records that may stand at a dotted path, one for each law."""
    return (block for block in blocks(record) if block.path.replace("[]", "") == path)


def laws_with(record: type, path: str) -> list[str]:
    """Return the laws of the block around a dotted path that have the field which is its last part; empty if that block has no laws."""
    place, _, name = path.rpartition(".")
    return [block.law for block in records_at(record, place) if block.law and any(fact.path.endswith(f".{name}") for fact in block.fields)]
