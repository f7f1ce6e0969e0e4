# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All checks, in the order of the page."""

from pathlib import Path

from validation import catalogues, closed_forms, heat_and_friction, independent, published_digits, thin_films, trends
from validation.check import Check
from validation.recorded_lines import recorded_checks

CHECKS: tuple[Check, ...] = (
    *closed_forms.CHECKS,
    *published_digits.CHECKS,
    *catalogues.CHECKS,
    *independent.CHECKS,
    *heat_and_friction.CHECKS,
    *thin_films.CHECKS,
    *trends.CHECKS,
)
"""Those that need no file.  Each has a name of its own."""


def all_checks(recordings: Path | None = None) -> tuple[Check, ...]:
    """Return all checks, also those of recordings; parameter and errors as of `recorded_checks`."""
    return (*CHECKS, *recorded_checks(recordings))
