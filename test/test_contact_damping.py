# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the damping of normal contacts."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim import Simulation, load_scene
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES, load, new_rows, store
from bearing_sim.physics.contact import ContactDamping, damped_line_contact, elastic_line_contact, line_contact_stiffness

STIFFNESS = line_contact_stiffness(7e-3, 2.06e11, 0.3)
DAMPING = ContactDamping(0.104, 2.5e-6, 1e-7)
PRESSED = st.floats(1e-8, 2e-5)


@kernel
def _press(rows, stiffness, damping):
    force, d_penetration, d_rate = damped_line_contact(load(rows, 0, 0), load(rows, 0, 1), stiffness, damping)
    store(rows, 0, 2, force)
    store(rows, 0, 3, d_penetration)
    store(rows, 0, 4, d_rate)
    store(rows, 0, 5, elastic_line_contact(load(rows, 0, 0), stiffness))


def press(penetration, rate, damping=DAMPING):
    """Force, its derivatives by penetration and rate, and its elastic part."""
    rows = new_rows(6, LANES)
    rows[0, 0], rows[0, 1] = penetration, rate
    _press(rows, STIFFNESS, damping)
    return rows[0, 2:, 0].copy()


def plain(penetration, rate, damping=DAMPING):
    """The same force, written once more."""
    depth = max(penetration, 0.0)
    by_stiffness = damping.time * (10 / 9 * STIFFNESS * depth ** (1 / 9)) * depth / (depth + damping.depth)
    return max(STIFFNESS * depth ** (10 / 9) * (1 + damping.hysteresis * rate) + by_stiffness * rate, 0.0)


@given(st.floats(-1e-6, 2e-5), st.floats(-1.0, 1.0))
def test_the_force_is_elastic_plus_damping_by_load_and_by_stiffness_and_never_pulls(penetration, rate):
    assert press(penetration, rate)[0] == pytest.approx(plain(penetration, rate), rel=1e-9, abs=1e-9)


@given(PRESSED, st.floats(-1.0, 1.0))
def test_the_derivatives_are_central_differences_of_the_force(penetration, rate):
    force, d_penetration, d_rate, elastic = press(penetration, rate)
    if abs(plain(penetration, rate)) < 1e-3 * elastic:
        return  # at the bend where a contact lets go there is none
    step = 1e-5 * penetration
    found = (plain(penetration + step, rate) - plain(penetration - step, rate)) / (2 * step)
    assert d_penetration == pytest.approx(found, rel=1e-5, abs=1e-5 * elastic / penetration) and d_penetration >= 0.0
    assert d_rate == pytest.approx((plain(penetration, rate + 1e-6) - plain(penetration, rate - 1e-6)) / 2e-6, rel=1e-5)
    assert force >= 0.0


def test_deep_contacts_are_damped_in_proportion_to_their_stiffness():
    _, stiffness, damper, _ = press(2e-5, 0.0, ContactDamping(0.0, 2.5e-6, 1e-9))
    assert damper == pytest.approx(2.5e-6 * stiffness, rel=1e-4)
    _, _, half, _ = press(1e-7, 0.0, ContactDamping(0.0, 2.5e-6, 1e-7))
    assert half == pytest.approx(0.5 * press(1e-7, 0.0, ContactDamping(0.0, 2.5e-6, 1e-12))[2], rel=1e-4)


def test_without_damping_time_the_law_is_that_of_hunt_and_crossley():
    for penetration, rate in ((1e-9, 0.3), (4e-6, -0.5), (4e-6, -20.0)):
        force, _, damper, elastic = press(penetration, rate, ContactDamping(0.104, 0.0, 1e-7))
        assert force == pytest.approx(elastic * max(1 + 0.104 * rate, 0.0), rel=1e-12)
        assert damper == pytest.approx(0.104 * elastic if force else 0.0, rel=1e-12)


def test_force_and_derivative_by_rate_have_no_jump_where_contact_begins():
    for rate in (-0.5, 0.0, 0.5):
        force, _, damper, _ = press(1e-13, rate)
        assert force < 1e-4 and damper < 1e-2 and press(-1e-13, rate)[:3] == pytest.approx(0.0)


def test_oscillations_of_the_ring_decay_as_damping_by_stiffness_says():
    # a viscous ratio of omega tau/2 for any mass on contacts whose damping is tau times their stiffness: the shaft stands, rollers do not centrifuge
    scene = ["level=planar", "operating.shaft_speed=0 rpm", "operating.radial_load=3 kN", "bearing.inner_raceway.radius=27.88 mm"]
    time = 10e-6
    damping = [f"bearing.contact.damping_time={1e6 * time} us", "bearing.contact.damping=0", "bearing.contact.damping_depth=1e-9"]
    run = Simulation(load_scene("deng2017_table1", [*scene, *damping, "support.shaft.mass=20 kg", "integration.fixed_step=2 us"]))
    run.advance(0.2)
    at_rest = run.advance(0.02, samples=10)["ring_y"][-1]
    run._state[0] += 2e-8
    course = run.advance(0.02, samples=10_000)["ring_y"] - at_rest
    peaks = np.flatnonzero((course[1:-1] > course[:-2]) & (course[1:-1] > course[2:])) + 1
    peaks = peaks[course[peaks] > 1e-9]
    assert len(peaks) > 3
    decrement = math.log(course[peaks[0]] / course[peaks[3]]) / 3
    frequency = 3 / (2e-6 * (peaks[3] - peaks[0]))
    ratio = decrement / math.hypot(2 * math.pi, decrement)
    assert ratio == pytest.approx(math.pi * frequency * time, rel=0.05)
