# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tasks whose results are kept: each under a hash of all that its result depends on."""

import hashlib
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

_PACKAGE = Path(__file__).resolve().parents[1]
# What a result may depend on besides compiled code, which `sources_hash` knows: how a scene becomes parameters, and how a run is driven.
_SOURCES = ("*.py", "tables/*.py", "sweep/point.py")


class Task(NamedTuple):
    """One thing to compute.

    Attributes
    ----------
    key : hash of all that the result depends on.
    kind : tasks of one kind run the same compiled code.
    function : of a module, picklable; returns a mapping of names to numbers, texts and lists, or raises where the program is at fault.
    arguments : picklable.
    """

    key: str
    kind: str
    function: Callable[..., dict]
    arguments: tuple


@cache
def program_hash() -> str:
    """Return a hash of this program as far as results depend on it, compiler included."""
    from bearing_sim.kernels.compilation import sources_hash

    digest = hashlib.sha256(sources_hash().encode())
    for pattern in _SOURCES:
        for path in sorted(set(_PACKAGE.glob(pattern)) - {_PACKAGE / "cli.py"}):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


@cache
def _source(module: str) -> bytes:
    return Path(sys.modules[module].__file__).read_bytes()


def task(kind: str, function: Callable[..., dict], *arguments: Any) -> Task:
    """Return a task under the hash of its function and its module, its arguments and this program.

    Parameters
    ----------
    kind, function : see `Task`.
    arguments : whose `repr` shows every digit, as that of scenes, numbers, texts and tuples of them does.
    """
    digest = hashlib.sha256(_source(function.__module__))
    digest.update("\n".join([program_hash(), function.__qualname__, *map(repr, arguments)]).encode())
    return Task(digest.hexdigest()[:32], kind, function, arguments)
