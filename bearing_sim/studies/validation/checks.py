# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All checks, in the order of the page."""

from bearing_sim.studies.validation import catalogues, closed_forms, heat_and_friction, independent, published_digits, trends
from bearing_sim.studies.validation.check import Check

CHECKS: tuple[Check, ...] = (
    *closed_forms.CHECKS,
    *published_digits.CHECKS,
    *catalogues.CHECKS,
    *independent.CHECKS,
    *heat_and_friction.CHECKS,
    *trends.CHECKS,
)
"""Each has a name of its own."""
