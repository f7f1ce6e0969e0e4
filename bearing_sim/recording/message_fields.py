# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The numbers in a message of any type, by the paths of their fields."""

from collections.abc import Iterator
from itertools import islice

import numpy as np

from bearing_sim.scene.errors import did_you_mean

_MOST_OF_A_SEQUENCE = 64
_SHOWN = 6  # paths in an error


def numbers(message) -> Iterator[tuple[str, float]]:
    """Yield (path, value) of the numbers in a decoded message, such as ``velocity[0]``, in order.

    Stamps are left out, of a sequence the numbers beyond the first 64, and sequences of bytes, which hold pictures and other packed data.
    """
    for name in getattr(message, "__slots__", None) or getattr(message, "__dict__", ()):
        if not name.startswith("_"):
            yield from _numbers_at(name, getattr(message, name))


def _numbers_at(path: str, value) -> Iterator[tuple[str, float]]:
    if isinstance(value, (bool, int, float, np.number, np.bool_)):
        yield path, float(value)
    elif isinstance(value, (str, bytes, bytearray)) or (isinstance(value, np.ndarray) and value.dtype.itemsize == 1):
        return
    elif isinstance(value, (list, tuple, np.ndarray)):
        for index, item in enumerate(value[:_MOST_OF_A_SEQUENCE]):
            yield from _numbers_at(f"{path}[{index}]", item)
    elif path.rpartition(".")[2] not in ("header", "stamp"):
        for inner, number in numbers(value):
            yield f"{path}.{inner}", number


def suggestion(message, path: str = "") -> str:
    """Return in words which path was perhaps meant, or which there are; for the end of an error.

    Parameters
    ----------
    message : decoded.
    path : that does not lead to a number; empty if there was none.
    """
    paths = [found for found, _ in islice(numbers(message), _MOST_OF_A_SEQUENCE)]
    if path and f"{path}[0]" in paths:
        return f" (did you mean {f'{path}[0]'!r}?)"
    if path and (meant := did_you_mean(path, paths)):
        return meant
    shown = ", ".join(paths[:_SHOWN]) + ", ..." * (len(paths) > _SHOWN)
    return f"; its numbers are {shown}" if paths else "; it has no numbers"
