# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A check compares what this code computes with something independent of it, and says by how much they differ."""

import math
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from bearing_sim.simulation import IntegrationError

HOLDS, IN_PART, FAILS, NOT_RUN = "holds", "holds in part", "does not hold", "not run"
_MOST_SHOWN = 6  # numbers in a cell; of more, their range
_ROUND_OFF = 1e-12  # relative


class Comparison(NamedTuple):
    """One line of a check.

    Attributes
    ----------
    quantity : what is compared.
    source : of what it is compared with.
    expected : that, in words and numbers.
    found : what this code gives.
    deviation : the largest difference between both, in words; empty for a finding that has a direction only.
    tolerance : within which it counts as the same.
    verdict : `HOLDS`, `IN_PART`, `FAILS` or `NOT_RUN`.
    """

    quantity: str
    source: str
    expected: str
    found: str
    deviation: str
    tolerance: str
    verdict: str


class Check(NamedTuple):
    """Comparisons that are computed together.

    Attributes
    ----------
    name : by which it is chosen.
    group : heading under which it stands.
    compute : returns its comparisons.
    command : that computes the same figures beside `python test/validation report --only NAME`; empty if there is none.
    is_long : whether it takes more than a few seconds.
    """

    name: str
    group: str
    compute: Callable[[], list[Comparison]]
    command: str = ""
    is_long: bool = False

    @property
    def shown_command(self) -> str:
        """The command that computes its figures."""
        return self.command or f"python test/validation report --only {self.name}"


class Result(NamedTuple):
    """One line of the page: a comparison, where it belongs, the command that computes it, and the day on which it was computed (UTC)."""

    group: str
    check: str
    quantity: str
    source: str
    expected: str
    found: str
    deviation: str
    tolerance: str
    verdict: str
    command: str
    date: str


def run(checks: Iterable[Check], quick: bool = False, progress: Callable[[int], None] = lambda done: None) -> list[Result]:
    """Return the results of checks; one that fails to compute says so in its line and does not keep the others from their result.

    Parameters
    ----------
    checks : in order.
    quick : leave out those that are long; their line says that they were not run.
    progress : called with the number of checks that are done.
    """
    results = []
    for done, check in enumerate(checks, 1):
        today = datetime.now(UTC).date().isoformat()
        if quick and check.is_long:
            comparisons, today = [_without(check, NOT_RUN, "left out of a quick report")], ""
        else:
            try:
                comparisons = check.compute()
            except (IntegrationError, ArithmeticError) as error:
                comparisons = [_without(check, FAILS, f"not computed: {error}")]
        results += [Result(check.group, check.name, *each, check.shown_command, today) for each in comparisons]
        progress(done)
    return results


def _without(check: Check, verdict: str, reason: str) -> Comparison:
    return Comparison(check.name.replace("_", " "), "", "", reason, "", "", verdict)


def compared(
    quantity: str,
    source: str,
    expected: float | Sequence[float],
    found: float | Sequence[float],
    *,
    unit: str = "",
    relative: float | None = None,
    absolute: float | None = None,
    factor: float | None = None,
    digits: int = 4,
) -> Comparison:
    """Return the comparison of numbers, which holds if all of them are within the tolerance.

    Parameters
    ----------
    quantity, source : see `Comparison`.
    expected, found : numbers in ``unit``, as many of each.
    unit : of both.
    relative, absolute, factor : the tolerance: of the largest |found/expected - 1|, of the largest |found - expected| in ``unit``, or of the
        largest ratio either way.  Exactly one is given.
    digits : that are shown of each number.
    """
    one, other = np.atleast_1d(np.asarray(expected, float)), np.atleast_1d(np.asarray(found, float))
    if one.shape != other.shape:
        raise ValueError(f"{quantity}: {len(one)} numbers expected and {len(other)} found")
    with np.errstate(divide="ignore", invalid="ignore"):
        if relative is not None:
            off, limit = np.max(np.abs(other / one - 1.0)), relative
            deviation, tolerance = _percent(off), _percent(relative)
        elif absolute is not None:
            off, limit = np.max(np.abs(other - one)), absolute
            shown = 0.0 if off < _ROUND_OFF * np.max(np.abs(one)) else off
            deviation, tolerance = (f"{number:.2g} {unit}".strip() for number in (shown, absolute))
        else:
            off, limit = np.exp(np.max(np.abs(np.log(other / one)))), factor
            deviation, tolerance = f"a factor of {off:.3g}", f"a factor of {factor:g}"
    verdict = HOLDS if off <= limit else FAILS  # NaN does not hold
    return Comparison(quantity, source, _numbers(one, unit, digits), _numbers(other, unit, digits), deviation, tolerance, verdict)


def judged(quantity: str, source: str, expected: str, found: str, verdict: str | bool, deviation: str = "", tolerance: str = "") -> Comparison:
    """Return a comparison whose verdict follows from more than numbers side by side; parameters as the attributes of `Comparison`.

    Parameters
    ----------
    verdict : one of the verdicts, or whether it holds.
    """
    if isinstance(verdict, (bool, np.bool_)):
        verdict = HOLDS if verdict else FAILS
    return Comparison(quantity, source, expected, found, deviation, tolerance, verdict)


def within(ratios: Sequence[float], factor: float) -> int:
    """Return how many ratios lie within a factor of 1."""
    return int(np.count_nonzero(np.abs(np.log(ratios)) <= math.log(factor)))


def _numbers(numbers: np.ndarray, unit: str, digits: int) -> str:
    if np.ptp(numbers) <= 1e-12 * np.abs(numbers).max():
        shown = f"{numbers[0]:.{digits}g}"
    elif len(numbers) > _MOST_SHOWN:
        shown = f"{len(numbers)} numbers from {numbers.min():.{digits}g} to {numbers.max():.{digits}g}"
    else:
        shown = ", ".join(f"{number:.{digits}g}" for number in numbers)
    return f"{shown} {unit}".strip()


def _percent(fraction: float) -> str:
    """Return a fraction in per cent, or as a power of ten where it is small, or as none where it is round-off."""
    if fraction < _ROUND_OFF:
        return "0"
    return f"{100.0 * fraction:.2g} %" if not fraction < 1e-5 else f"{fraction:.1e}"
