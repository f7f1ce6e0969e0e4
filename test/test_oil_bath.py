# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil baths and seals: moments by hand, and what the cage and the shaft feel of them."""

import math

import pytest

from bearing_sim import SceneError, load_scene
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table_builder import solve_scene
from bearing_sim.model.params import lubricate, pack
from bearing_sim.physics.drag import bath_moment, roller_drag
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

RPM = math.pi / 30
NU_210 = dict(bore_diameter=50e-3, outside_diameter=90e-3, width=20e-3)


def scene(*overrides):
    return load_scene("deng2017_table1", overrides)


def answer(*overrides):
    return dict(zip(ANSWER._fields, solve_scene(scene(*overrides), 15000 * RPM, 800.0, 393.15, 0.0)))


def test_moments_of_the_bath_are_skfs():
    # by hand, NU 210 at 9000 rpm and 12 mm2/s with oil to the middle of the lowest roller: H/d_m 5.5/70, V_M 7.97e-5, K_roll 1.160e-11,
    # l_D 0.9286, C_w 0.6618, t 1.0356, f_t 0.4948, f_A 0.8925, R_s 276.2 mm2, Reynolds number 1.8187e6
    displacing, rubbing = bath_moment(5.5e-3, 9000 * RPM, 12e-6, **NU_210)
    assert displacing == pytest.approx(4 * 7.97e-5 * 1.160e-11 * 0.6618 * 20 * 70**4 * 9000**2 * 1e-3, rel=2e-3)
    assert rubbing == pytest.approx(1.093e-7 * 9000**2 * 70**3 * 1.8187e6**-1.379 * 276.2 * 1e-3, rel=2e-3)


def test_a_higher_bath_drags_more_and_an_empty_one_not_at_all():
    moments = [sum(bath_moment(level, 9000 * RPM, 12e-6, **NU_210)) for level in (0.0, 2e-3, 5.5e-3, 20e-3, 70e-3, 84e-3)]
    assert moments == sorted(moments) and moments[0] == 0.0
    assert sum(bath_moment(0.2, 9000 * RPM, 12e-6, **NU_210)) == moments[-1]  # flooded to 1.2 times the mean diameter


@pytest.mark.parametrize("cage_speed", [-2000.0, 30.0, 2000.0])
def test_drag_on_the_rollers_takes_the_power_of_the_moment_and_its_slope_is_a_derivative(cage_speed):
    of = scene("lubricant.supply=oil_bath", "lubricant.mixture_fraction=0")
    params = pack(of)
    lubrication, ratio = lubricate(of.lubricant, params, 393.15), params.raceways.diameter_ratio
    shaft_speed = 2 * abs(cage_speed) / (1 - ratio)
    moment = sum(bath_moment(3.5e-3, shaft_speed, lubrication.kinematic_viscosity, *params.envelope[:3]))
    force, slope = roller_drag(cage_speed, shaft_speed, params, lubrication)
    assert force * 18 * params.raceways.pitch_radius * cage_speed == pytest.approx(moment * shaft_speed, rel=1e-3)
    near = [roller_drag(cage_speed + side, shaft_speed, params, lubrication)[0] for side in (-1e-3, 1e-3)]
    assert slope == pytest.approx((near[1] - near[0]) / 2e-3, rel=1e-6)


def test_a_bath_replaces_the_mixture_unless_a_scene_has_both():
    assert scene("lubricant={oil: mil_l_7808, supply: oil_bath}").lubricant.mixture_fraction == 0.0
    assert scene("lubricant={oil: mil_l_7808}").lubricant.mixture_fraction == 0.03
    assert scene("lubricant.supply=oil_bath").lubricant.mixture_fraction == 0.03  # which the bundled scene gives
    of = scene("lubricant={oil: mil_l_7808, supply: {law: oil_bath, level: 5 mm}}", "bearing.seals=skf")
    assert scene_from_yaml(scene_to_yaml(of)) == of


def test_a_higher_bath_makes_the_cage_slip_more_and_its_loss_stands_in_the_books():
    bath = ["lubricant.mixture_fraction=0", "lubricant.supply.law=oil_bath"]
    low, high = (answer(*bath, f"lubricant.supply.level={level} mm") for level in (1, 30))
    assert high["cage_slip"] > low["cage_slip"] and high["churning_power"] > 10 * low["churning_power"]
    for found in (low, high):
        assert found["shaft_power"] == pytest.approx(
            sum(value for name, value in found.items() if name.endswith("power")) - found["shaft_power"], rel=5e-3
        )


def test_seals_load_the_shaft_and_nothing_else():
    open_bearing, sealed = answer(), answer("bearing.seals={law: constant_moment, moment: 0.2}")
    assert sealed["seal_power"] == pytest.approx(0.2 * 15000 * RPM)
    assert sealed["shaft_power"] - open_bearing["shaft_power"] == pytest.approx(sealed["seal_power"])
    assert sealed["cage_slip"] == open_bearing["cage_slip"]


def test_moment_of_contact_seals_is_skfs():
    # two LS seals on E = 69.725 mm: 0.032 x 69.725^2 + 50 N mm
    assert scene("bearing.seals=skf").bearing.seal_moment == pytest.approx(1e-3 * (0.032 * 69.725**2 + 50))
    assert scene("bearing.seals={law: skf, count: 1, diameter: 60 mm}").bearing.seal_moment == pytest.approx(0.5e-3 * (0.032 * 3600 + 50))
    with pytest.raises(SceneError, match="bearing.seals.moment: missing"):
        scene("bearing.seals=constant_moment")


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("bearing.outer_raceway.outside_radius=34 mm", "outside_radius: 34 mm is not above the raceway's radius, 34.9605 mm"),
        ("bearing.inner_raceway.bore_radius=28 mm", "bore_radius: 28 mm is not below the raceway's radius, 27.875 mm"),
    ],
)
def test_a_ring_that_does_not_enclose_its_raceway_is_refused(override, words):
    with pytest.raises(SceneError, match=words):
        scene(override)
