# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Published findings about slip that the model reproduces; those that it does not are named in doc/validation/trends.md."""

import pytest
from validation.published_findings import NO_SLIP, gearbox_slip, rig_slip


@pytest.mark.parametrize("speed", [1000, 5000])
def test_below_the_minimum_load_slip_rises_with_the_quantity_of_oil_and_a_preload_ends_it(speed):
    # Dawoud, Beitler and Schwarze 2022, parts I and III
    little, much = (rig_slip("slip", speed, 0.3, flow) for flow in (0.01, 0.1))
    assert NO_SLIP < little < much
    assert rig_slip("slip", speed, 0.3, 0.03, ("bearing.outer_raceway.diameter=118.49mm",)) < NO_SLIP


def test_below_the_minimum_load_slip_rises_with_speed_and_four_times_that_load_ends_it():
    # Dawoud, Beitler and Schwarze 2022, part I
    slow, fast = (rig_slip("slip", speed, 0.3, 0.03) for speed in (1000, 5000))
    assert NO_SLIP < slow < fast
    assert rig_slip("slip", 5000, 4.0, 0.03) < NO_SLIP < rig_slip("slip", 5000, 1.0, 0.03)


@pytest.mark.parametrize("speed", [1000, 5000])
def test_a_cage_guided_by_the_rollers_slips_less_than_one_guided_by_the_outer_ring(speed):
    # Dawoud, Beitler and Schwarze 2022, part I
    guided = rig_slip("slip", speed, 0.3, 0.03, ("bearing.cage.guidance=roller", "bearing.cage.outer_diameter=115.2mm"))
    assert guided < rig_slip("slip", speed, 0.3, 0.03)


def test_an_idling_bearing_of_a_wind_gearbox_slips_by_tens_of_per_cent_the_less_the_warmer_its_oil_and_a_loaded_one_does_not():
    # Guo and Keller 2020
    assert 0.2 < gearbox_slip("slip", 60, 0.0) < gearbox_slip("slip", 20, 0.0)
    assert gearbox_slip("slip", 20, 1.0) < NO_SLIP
