# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How long stages that take seconds to minutes will take on this machine: as long as the last time, or as its speed lets expect."""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from bearing_sim.files.kept import checked_contents, read_kept, with_checksum, write_kept
from bearing_sim.files.limits import JSON_FILE
from bearing_sim.numerics.compilation import CACHE_FOLDER

_COUNT_SECONDS = 0.0072  # of `_count` on the reference machine, a core of an Intel Xeon with Python 3.11


def file() -> Path:
    """Return where the durations of this user's machine are kept."""
    return CACHE_FOLDER.parents[1] / "durations.json"


def _count() -> float:
    """Return the time that plain Python takes to count [s]."""
    began, total = time.perf_counter(), 0
    for number in range(100_000):
        total += number * number % 7
    return time.perf_counter() - began


def _kept() -> dict[str, float]:
    """Return the seconds that stages took the last time; none where the file cannot be read or is none of these."""
    found = read_kept(file(), JSON_FILE, lambda data: checked_contents(data, "durations")[1]) or {}
    return {stage: seconds for stage, seconds in found.items() if isinstance(seconds, float) and 0.0 <= seconds < math.inf}


def expected(stage: str, seconds: float) -> str:
    """Return how long a stage will take, in words.

    Parameters
    ----------
    stage : name under which `keep` has kept it.
    seconds : that it takes on the reference machine.
    """
    if (last := _kept().get(stage)) is not None:
        return f"{last:.0f} s the last time here"
    guess = seconds * min(_count() for _ in range(3)) / _COUNT_SECONDS
    return f"about {float(f'{guess:.1g}' if guess < 10.0 else f'{guess:.2g}'):.0f} s"


def keep(stage: str, seconds: float) -> None:
    """Keep how long a stage took; nothing is kept where the folder cannot be written."""
    with suppress(OSError):
        write_kept(file(), with_checksum("durations", 1, _kept() | {stage: round(seconds, 1)}))


@contextmanager
def timed(stage: str) -> Iterator[None]:
    """Keep how long the block takes, if it ends without an exception."""
    began = time.monotonic()
    yield
    keep(stage, time.monotonic() - began)
