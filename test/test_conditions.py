# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Operating points and tolerances: read with their units, combined as Palmgren and Miner say, refused with what to write."""

import math

import pytest

from bearing_sim import load_scene
from bearing_sim.sweep.conditions import (
    Conditions,
    OperatingPoint,
    PointError,
    Tolerance,
    combined_life,
    read_point,
    read_points,
    read_tolerance,
    scene_at_point,
    shares,
)

SCENE = load_scene("deng2017_table1")
RPM = math.pi / 30


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("45000 rpm, 800 N, 0.7", (45000 * RPM, 800.0, 0.7, None)),
        ("750 Hz,0.8 kN,70%", (45000 * RPM, 800.0, 0.7, None)),
        ("-45000 1/min, 800, 2, 120 degC", (-45000 * RPM, 800.0, 2.0, 393.15)),
    ],
)
def test_a_point_is_speed_load_weight_and_perhaps_oil_temperature_with_units(text, expected):
    assert read_point(text) == pytest.approx(OperatingPoint(*expected))


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("45000 rpm, 800 N", "2 parts; expected speed, load, weight"),
        ("45000, 800 N, 1", r"45000 rpm \(turns per minute\)"),
        ("800 N, 45000 rpm, 1", "shaft_speed"),
        ("45000 rpm, 800 mm, 1", "radial_load: .* wrong dimension"),
        ("45000 rpm, 800 N, 0", "more than 0"),
        ("45000 rpm, 800 N, -10%", "more than 0"),
        ("45000 rpm, 800 N, nan", "more than 0"),
        ("0 rpm, 800 N, 1", "leave the point out"),
        ("45000 rpm, 800 N, 1, 120", "oil_temperature"),
        ("45000 rpm, 800 N, 1, 120 degC, x", "5 parts"),
    ],
)
def test_a_point_that_cannot_be_read_is_refused_with_what_to_write(text, reported):
    with pytest.raises(PointError, match=reported):
        read_point(text)


def test_a_file_of_points_has_its_units_in_the_heading_or_with_each_value_in_any_order(tmp_path):
    (tmp_path / "a.csv").write_text(
        "\ufeffshaft_speed [rpm], radial_load [N],weight,oil_temperature [degC]\n45000,800,70%,120\n\n39000, 500,30%,115\n"
    )
    (tmp_path / "b.csv").write_text("weight,radial_load,shaft_speed,oil_temperature\n0.7,800 N,750 Hz,120 degC\n0.3,0.5 kN,39000 1/min,388.15 K\n")
    first, second = read_points(tmp_path / "a.csv"), read_points(tmp_path / "b.csv")
    assert [tuple(point) for point in first] == [pytest.approx(tuple(point)) for point in second]
    assert first[0] == pytest.approx(OperatingPoint(45000 * RPM, 800.0, 0.7, 393.15)) and len(first) == 2


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("", "no operating points"),
        ("shaft_speed [rpm],radial_load [N],weight\n", "no operating points"),
        ("shaft_speed [rpm],radial_load [N]\n1,2\n", "no column weight"),
        ("torque [Nm],radial_load [N],weight\n1,2,3\n", "'torque .Nm.' is unknown; expected shaft_speed"),
        ("weight,shaft_speed [rpm],radial_load [N],weight\n1,2,3,4\n", "2 columns are called 'weight'"),
        ("shaft_speed [rpm],radial_load [N],weight\n45000,800\n", "line 2: 2 values for 3 columns"),
        ("shaft_speed,radial_load [N],weight\n\n45000,800,1\n", "line 3: shaft_speed: .* write 45000 rpm"),
        ("shaft_speed [mm],radial_load [N],weight\n45000,800,1\n", "wrong dimension"),
    ],
)
def test_a_file_that_cannot_be_read_is_refused_with_its_line_and_what_is_expected(tmp_path, text, reported):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(PointError, match=reported):
        read_points(tmp_path / "p.csv")


def test_weights_are_shares_of_time_and_lives_combine_by_their_damage():
    points = [OperatingPoint(100.0, 1.0, 3.0), OperatingPoint(100.0, 2.0, 1.0)]
    assert shares(points) == [0.75, 0.25]
    # 750 h and 250 h of 1000 h use 750/3000 + 250/500 of the life, 0.75: it ends after 1000/0.75 h.
    assert combined_life([3000.0, 500.0], points) == pytest.approx(1000 / 0.75)
    assert combined_life([math.inf, math.inf], points) == math.inf
    assert combined_life([math.inf, 500.0], points) == pytest.approx(2000.0)
    assert math.isnan(combined_life([math.nan, 500.0], points))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("bearing.roller.diameter=1um", Tolerance("bearing.roller.diameter", 1e-6)),
        ("bearing.outer_raceway.d_value = 2%", Tolerance("bearing.outer_raceway.d_value", 0.02, True)),
        ("lubricant.temperature=5 K", Tolerance("lubricant.temperature", 5.0)),
        ("lubricant.mixture_fraction=0.5%", Tolerance("lubricant.mixture_fraction", 0.005)),
    ],
)
def test_a_tolerance_is_a_difference_of_its_field_or_a_fraction_of_its_value(text, expected):
    assert read_tolerance(text, SCENE) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("bearing.roller.diameter", "FIELD=AMOUNT"),
        ("bearing.roller.diametre=1um", "did you mean 'diameter'"),
        ("bearing.roller.count=1", "needs a quantity"),
        ("operating.shaft_speed=1%", "--speed-tolerance"),
        ("operating.radial_load=1%", "--load-tolerance"),
        ("bearing.cage.outer_radius=1um", "gives no bearing.cage.outer_radius"),
        ("bearing.roller.diameter=1 N", "wrong dimension"),
        ("bearing.roller.diameter=-1um", "above 0"),
        ("bearing.roller.diameter=0", "above 0"),
        ("lubricant.temperature=120 degC", "a difference of lubricant.temperature"),
        ("integration.maximum_step=1us", "needs a quantity of bearing, lubricant, operating"),
    ],
)
def test_a_tolerance_that_cannot_be_meant_is_refused_with_what_to_write(text, reported):
    with pytest.raises(PointError, match=reported):
        read_tolerance(text, SCENE)


def test_a_scene_at_a_point_is_off_by_what_its_signs_say():
    tolerances = (
        Tolerance("bearing.roller.diameter", 1e-6),
        Tolerance("lubricant.temperature", 5.0),
        Tolerance("bearing.outer_raceway.d_value", 0.02, True),
    )
    off = scene_at_point(SCENE, OperatingPoint(4000.0, 500.0, 1.0, 380.0), 0.02, -0.1, tolerances, (1, -1, 0))
    assert (off.operating.shaft_speed, off.operating.radial_load) == pytest.approx((4080.0, 450.0))
    assert off.bearing.roller.diameter == pytest.approx(7.001e-3) and off.lubricant.temperature == 375.0
    assert off.bearing.outer_raceway.d_value == SCENE.bearing.outer_raceway.d_value
    less = scene_at_point(SCENE, OperatingPoint(4000.0, 500.0), 0.0, 0.0, tolerances, (0, 0, -1))
    assert less.bearing.outer_raceway.d_value == pytest.approx(0.98 * SCENE.bearing.outer_raceway.d_value)
    assert less.lubricant.temperature == SCENE.lubricant.temperature


def test_a_deviation_that_no_scene_can_have_is_an_error_that_says_so():
    with pytest.raises(PointError, match="off by its tolerances"):
        scene_at_point(SCENE, OperatingPoint(4000.0, 500.0), 0.0, 0.0, (Tolerance("bearing.roller.diameter", 5e-3),), (1,))


def test_conditions_tell_points_and_tolerances_in_units_of_people():
    conditions = Conditions(
        0.02, 0.1, (Tolerance("bearing.roller.diameter", 1e-6),), (read_point("45000 rpm, 800 N, 3"), read_point("750 Hz, 1 kN, 1"))
    )
    told = conditions.as_json()
    assert told["spread"] == "speed ±2 %, load ±10 %, bearing.roller.diameter ±0.001 mm"
    assert [(point["share"], point["radial_load"]) for point in told["points"]] == [(0.75, 800.0), (0.25, 1000.0)]
    assert told["points"][1]["shaft_speed_rpm"] == pytest.approx(45000)
    assert conditions.nominal == Conditions(points=conditions.points)
