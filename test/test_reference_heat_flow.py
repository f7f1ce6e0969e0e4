# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Heat that the default housing and shaft carry away at the reference conditions of ISO 15312, against the heat flow of the standard."""

import numpy as np
import pytest
from validation.catalogue_friction import BEARINGS, heat_flow
from validation.heat_and_friction import reference_heat

from bearing_sim.studies.friction import Dimensions


def test_the_reference_heat_flow_is_that_of_the_standard():
    assert heat_flow(Dimensions(50.0, 90.0, 20.0)) == pytest.approx(140.7, rel=1e-3)
    assert heat_flow(Dimensions(160.0, 290.0, 48.0)) == pytest.approx(67858 * 0.016 * (67858 / 5e4) ** -0.34, rel=1e-3)


def test_heat_carried_away_is_that_of_iso_15312_within_two_but_for_wide_bearings():
    """The standard's surface grows with the width, what a shaft carries away does not: series 23 stays below half of it."""
    ratios = {name: reference_heat(name).ratio for name in BEARINGS}
    beyond = {name for name, ratio in ratios.items() if not 0.5 < ratio < 2.0}
    assert beyond <= {"NU 2310", "NU 2324"} and min(ratios.values()) > 1 / 2.3


if __name__ == "__main__":
    found = [reference_heat(name) for name in BEARINGS]
    for each in found:
        print(f"{each.bearing:8s} {each.network:8.1f} W {each.standard:8.1f} W {each.ratio:6.2f}")
    print(f"median {np.median([each.ratio for each in found]):.3f}")
