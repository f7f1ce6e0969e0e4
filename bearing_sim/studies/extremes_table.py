# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All cases of the study of extremes as a table."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path

from bearing_sim.studies.extremes_run import Outcome

_COUNTED = tuple(name for name in Outcome._fields if name != "case")


def write_table(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Write one line for each case: where it is in the map, what became of it, what it cost, and how to run it again."""
    places = list(dict.fromkeys(name for outcome in outcomes for name in outcome.case.place))
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["level", "case", *_COUNTED, *places, "overrides"])
        for outcome in outcomes:
            case = outcome.case
            told = [_text(getattr(outcome, name)) for name in _COUNTED]
            where = [_text(case.place.get(name, "")) for name in places]
            writer.writerow([case.level, case.name, *told, *where, " ".join(f"--set '{override}'" for override in case.overrides)])


def _text(value) -> str:
    return f"{value:.6g}" if isinstance(value, float) and math.isfinite(value) else str(value)
