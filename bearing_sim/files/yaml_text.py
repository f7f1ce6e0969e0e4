# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""YAML texts as values, within limits: no text makes reading them crash, hang or fill the memory.

PyYAML follows YAML 1.1; numbers are read as in YAML 1.2, and a repeated key is an error, where PyYAML would silently keep the last value.
Tags may name plain values only.  Aliases count as often as they are used, because whoever walks the values meets them as often.
"""

import re
from collections.abc import Hashable

import yaml

from bearing_sim.files.limits import YAML_DEPTH, YAML_NODES, FileError

_INT, _FLOAT = "tag:yaml.org,2002:int", "tag:yaml.org,2002:float"
_REFUSED_TAGS = tuple(f"tag:yaml.org,2002:{name}" for name in ("binary", "omap", "pairs", "set"))
_MOST_DIGITS = 40
_SHOWN = 60  # characters of a value in a message
_LONGEST_REASON = 600  # characters
# What no text of a person holds: control characters, which act on a terminal, and halves of characters, which cannot be written again.
_UNPRINTABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff]")


class YamlError(FileError):
    """A text that is not YAML, or not within the limits; the message says the line."""


def values_of(text: str) -> object:
    """Return what a YAML text holds: mappings, lists, texts, numbers, dates, true, false, and None for an empty text.

    Raises
    ------
    YamlError
        It is not YAML, holds several documents, a repeated key, a tag for anything but plain values, or a value that its tag does not fit.
    LimitError
        It has too many values, or too many levels of them.
    """
    loader = None
    try:
        loader = _Loader(text)
        return loader.get_single_data()
    except yaml.YAMLError as error:
        reason = _reason(error)
        raise YamlError(f"not readable as YAML: {reason if len(reason) <= _LONGEST_REASON else reason[:_LONGEST_REASON] + ' ...'}") from None
    except RecursionError:  # only with a limit that was raised far
        raise YamlError("too many levels of blocks within blocks") from None
    finally:
        if loader is not None:
            loader.dispose()


def _reason(error: yaml.YAMLError) -> str:
    """Return what is wrong and where, without the line itself: whoever sees the message may not be meant to read the file."""
    if isinstance(error, yaml.reader.ReaderError):
        return f"character {error.position}: {error.reason} (U+{error.character:04X})"
    if not isinstance(error, yaml.MarkedYAMLError) or error.problem is None:
        return " ".join(str(error).split())
    mark, context = error.problem_mark, error.context_mark
    where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
    began = f" (in line {context.line + 1})" if context else ""
    return where + (f"{error.context}{began}: " if error.context else "") + error.problem


class _Loader(yaml.SafeLoader):
    """SafeLoader with the limits and rules of this module."""

    def __init__(self, text: str):
        super().__init__(text)
        self._depth = self._values = 0
        self._sizes: dict[int, int] = {}  # of complete nodes, with their aliases written out

    def compose_node(self, parent, index):
        """Return the next node, counted; an alias counts as all that it stands for."""
        mark, is_alias, before = self.peek_event().start_mark, self.check_event(yaml.AliasEvent), self._values
        where = f"line {mark.line + 1}"
        self._depth += 1
        YAML_DEPTH.check(self._depth, where)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if not is_alias:
            self._values += 1
            self._sizes[id(node)] = self._values - before
        elif id(node) in self._sizes:
            self._values += self._sizes[id(node)]
        else:
            raise yaml.composer.ComposerError(None, None, "an alias stands within what it stands for", mark)
        YAML_NODES.check(self._values, where)
        return node

    def construct_object(self, node, deep=False):
        """Return the value of a node; an error of Python's own is one of the text."""
        try:
            return super().construct_object(node, deep)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            tag = node.tag.removeprefix("tag:yaml.org,2002:")
            what = f"{node.value[:_SHOWN]!r} is no {tag}" if isinstance(node.value, str) else f"a list or a mapping is no {tag}"
            reason = f"{what}; write a text in quotation marks"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark) from None

    def construct_scalar(self, node):
        """Return the text of a scalar."""
        text = super().construct_scalar(node)
        if found := _UNPRINTABLE.search(text):
            reason = f"a text has the character {found[0]!r}, which cannot be printed"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
        return text

    def construct_yaml_int(self, node):
        """Return an integer of at most 40 digits; Python takes long for many more."""
        if len(node.value) > _MOST_DIGITS:
            reason = f"an integer of {len(node.value)} digits; expected at most {_MOST_DIGITS}"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
        return super().construct_yaml_int(node)


def _mapping_with_unique_keys(loader: _Loader, node: yaml.MappingNode) -> dict:
    seen = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node)
        if not isinstance(key, Hashable):
            raise yaml.constructor.ConstructorError(None, None, "a key cannot be a list or a mapping", key_node.start_mark)
        if key in seen:
            raise yaml.constructor.ConstructorError(None, None, f"the key {str(key)[:_SHOWN]!r} is written twice", key_node.start_mark)
        seen.add(key)
    return loader.construct_mapping(node, deep=True)


_Loader.yaml_constructors = {tag: function for tag, function in yaml.SafeLoader.yaml_constructors.items() if tag not in _REFUSED_TAGS}
_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping_with_unique_keys)
_Loader.add_constructor(_INT, _Loader.construct_yaml_int)

# PyYAML reads 1:30:00 as 5400, 010 as 8 and 1_000 as 1000, and 1e-5 as a text.
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag not in (_INT, _FLOAT)]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(_INT, re.compile(r"^[-+]?(?:0|[1-9]\d*)$"), list("-+0123456789"))
_Loader.add_implicit_resolver(
    _FLOAT,
    re.compile(r"^(?:[-+]?(?:\.\d+|\d+(?:\.\d*)?)(?:[eE][-+]?\d+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$"),
    list("-+.0123456789"),
)
