# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks of what has been published with a direction and few digits: the claims of Deng 2017, slip on a rig and in a wind gearbox."""

import tempfile
from pathlib import Path

from deng2017.run import run_study

from validation.check import Check, Comparison, judged
from validation.published_findings import findings

GROUP_OF_CLAIMS, GROUP_OF_FINDINGS = "Claims of Deng et al. (2017)", "Published trends"


def _claims() -> list[Comparison]:
    with tempfile.TemporaryDirectory() as folder:
        found = run_study(Path(folder))
    return [
        judged(
            f"claim {each.claim} at level {each.level}" if each.claim else "machined contours",
            f"Deng 2017, figure{'s' if ',' in each.figures else ''} {each.figures}",
            each.says,
            each.gives,
            each.verdict,
            each.off,
            "the claim at every step, changes of 1 % do not count",
        )
        for each in found
    ]


def _findings() -> list[Comparison]:
    return [judged("cage slip of level slip", each.source, each.claim, each.figures, each.holds, "", "the direction") for each in findings()]


CHECKS = (
    Check("claims_of_deng2017", GROUP_OF_CLAIMS, _claims, "python examples/deng2017 -o deng2017", True),
    Check("published_findings", GROUP_OF_FINDINGS, _findings, "python test/validation findings", True),
)
