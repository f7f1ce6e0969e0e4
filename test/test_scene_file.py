# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scenes: units at the door, every fault at once, messages that help."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim import SceneError, load_scene
from bearing_sim.inputs.csv_import import SpeedColumn
from bearing_sim.inputs.log import source
from bearing_sim.scene.loader import scene_from_yaml, scene_names, scene_to_yaml
from bearing_sim.scene.quantity import _USUAL, Quantity, in_digits, to_si, unit_registry
from bearing_sim.sweep.grid import read_axis


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("7.0 mm", "m", 7e-3),
        ("34.865mm", "m", 34.865e-3),
        ("45000 rpm", "rad/s", 45000 * math.pi / 30),
        ("120 degC", "K", 393.15),
        ("60 deg", "rad", math.pi / 3),
        ("3 %", "", 0.03),
        ("5 kN", "N", 5000.0),
        ("206 GPa", "Pa", 2.06e11),
        ("1e-3", "m", 1e-3),
        ("2.5 mil", "m", 63.5e-6),
        ("1 mils", "m", 25.4e-6),
        (7, "m", 7.0),
    ],
)
def test_quantities_come_in_with_units_and_bare_numbers_are_si(text, unit, expected):
    assert to_si(text, unit) == pytest.approx(expected, rel=1e-12)


TURNS_A_MINUTE = ("rpm", "RPM", "1/min", "min^-1", "min-1", "r/min", "rev/min", "U/min", "/min", "turns/min")
TURNS_A_SECOND = ("Hz", "hz", "1/s", "s^-1", "rps", "r/s", "rev/s", "U/s", "turn/s")
SPEEDS = {
    **dict.fromkeys(TURNS_A_MINUTE, 60.0),
    **dict.fromkeys(TURNS_A_SECOND, 1.0),
    "krpm": 0.06,
    "kHz": 1e-3,
    "rad/s": 2 * math.pi,
    "deg/s": 360.0,
    "krad/s": 2e-3 * math.pi,
}  # of one turn a second


def by_scene(text):
    return load_scene("deng2017_table1", [f"operating.shaft_speed={text}"]).operating.shaft_speed


def by_file(text):
    return scene_from_yaml(yaml_of_a_scene(f"operating: {{shaft_speed: {text}, radial_load: 800 N}}")).operating.shaft_speed


def yaml_of_a_scene(operating):
    return f"name: x\nbearing: deng2017_table1\nlubricant: {{oil: mil_l_7808}}\n{operating}\n"


def by_range(text):
    scene = load_scene("deng2017_table1", [f"uncertainty.operating.shaft_speed=[{text}, 100000 rpm]"])
    return next(one.low for one in scene.uncertainty if one.field == "operating.shaft_speed")


def by_sweep(text):
    return read_axis(f"operating.shaft_speed={text},100000rpm").values[0]


def by_table(text):
    number, _, unit = text.partition(" ")
    return float(number) * SpeedColumn(column="n", unit=unit).line()[0]


def by_option(text):
    number, _, unit = text.partition(" ")
    return float(number) * source("shaft_speed", "/servo.speed", unit).scale


DOORS = (lambda text: to_si(text, "rad/s"), by_scene, by_file, by_range, by_sweep, by_table, by_option)


@pytest.mark.parametrize("door", DOORS)
@given(turns=st.floats(0.5, 1500.0), unit=st.sampled_from(sorted(SPEEDS)))
def test_a_rotational_speed_is_the_same_in_every_unit_through_every_door(door, turns, unit):
    assert door(f"{turns * SPEEDS[unit]!r} {unit}") == pytest.approx(2 * math.pi * turns, rel=1e-9)


@pytest.mark.parametrize("door", [by_scene, by_file, by_range, by_sweep])
@pytest.mark.parametrize("text", ["3000", "3000.0", "3e3", "50"])
def test_a_rotational_speed_without_a_unit_is_refused_with_what_to_write(door, text):
    with pytest.raises(ValueError, match="has no unit; write .* rpm .turns per minute., .* Hz .turns per second. or .* rad/s"):
        door(text)


@pytest.mark.parametrize("unit", _USUAL)
def test_the_usual_units_are_those_of_pint_to_the_last_digit_and_are_shown_in_the_same_digits(unit):
    registry, si = unit_registry(), unit or "dimensionless"
    for usual in _USUAL[unit]:
        for number in (1.0, 45000.0, 0.1, 7.3, 34.865, 1e-3):
            written = registry.Quantity(number, registry.Unit("percent" if usual == "%" else usual))
            assert to_si(f"{number!r} {usual}", unit) == written.to(registry.Unit(si)).magnitude
            shown = registry.Quantity(number, registry.Unit(si)).to("percent" if usual == "%" else usual).magnitude
            assert Quantity(unit, "", shown_in=usual).show(number) == f"{shown:.6g} {usual}"


def test_degrees_celsius_are_those_of_pint():
    for number in (-40.0, 0.0, 20.0, 80.3):
        assert to_si(f"{number!r} °C", "K") == to_si(f"{number!r} degC", "K") == unit_registry().Quantity(number, "degC").to("K").magnitude
    assert Quantity("K", "", shown_in="degC").show(393.15) == "120 degC"


def test_at_rest_needs_no_unit():
    assert by_scene("0") == by_file("0.0") == 0.0


MISUSES = [
    *(("rad/s", text) for text in ("50 m/s", "3000 1/h", "50 Bq", "50 %", "3000 rmp", "3000 min", "50 rad", "50 N", "1:30:00", "3000 rpm/s")),
    *(("N", text) for text in ("5 kn", "5 KN", "5 kg", "500 kgf*m", "5 MPa", "5 kN/m", "5 N*m", "5e3 n")),
    *(("N*m", text) for text in ("5 J", "5 kJ", "1 Wh", "5 N", "5 N/m", "5 W")),
    *(("K", text) for text in ("5 delta_degC", "9 delta_degF", "70 C", "70 DEGC", "70 degc", "70 deg")),
    *(("delta_degC", text) for text in ("5 degC", "40 degF", "5 deg")),
    *(("Hz", text) for text in ("50 rad/s", "3000 rpm", "50 deg/s")),
    *(("rad", text) for text in ("3 %", "0.1 m/m", "60 degC")),
    *(("", text) for text in ("3 deg", "1 rad", "1 turn")),
    *(("m", text) for text in ("7 MM", "7 mm^2", "7 S", '7 "')),
    *(("Pa", text) for text in ("206 gpa", "206 N/mm", "5 Pa*s")),
    *(("Pa*s", text) for text in ("5 mPa", "27 mm^2/s", "27 cSt")),
    *(("s", text) for text in ("0:30", "5 Hz", "5 S")),
]


@pytest.mark.parametrize(("unit", "text"), MISUSES)
def test_a_quantity_of_another_kind_or_spelling_is_refused_with_what_to_write(unit, text):
    with pytest.raises(ValueError, match="; expected .* such as|; expected a pure number") as error:
        to_si(text, unit)
    assert repr(text) in str(error.value)


@pytest.mark.parametrize(("text", "meant"), [("5 kn", "kN"), ("5 KN", "kN"), ("206 gpa", "GPa"), ("7 MM", "mm"), ("70 DEGC", "degC")])
def test_a_unit_in_other_capitals_is_named_in_the_right_ones(text, meant):
    with pytest.raises(ValueError, match=f"did you mean '{meant}'"):
        to_si(text, {"kN": "N", "GPa": "Pa", "mm": "m", "degC": "K"}[meant])


@pytest.mark.parametrize("text", ["1:30:00", "1_000", "0x10"])
def test_numbers_that_yaml_1_1_reads_in_its_own_way_are_refused(text):
    with pytest.raises(SceneError, match="operating.radial_load"):
        scene_from_yaml(yaml_of_a_scene(f"operating: {{shaft_speed: 3000 rpm, radial_load: {text}}}"))


def test_a_leading_zero_and_an_exponent_without_a_point_are_decimal_numbers():
    read = [scene_from_yaml(yaml_of_a_scene(f"operating: {{shaft_speed: 3000 rpm, radial_load: {text}}}")) for text in ("010", "1e3")]
    assert [scene.operating.radial_load for scene in read] == [10.0, 1000.0]


def test_a_range_of_a_speed_survives_a_round_trip_through_yaml():
    scene = load_scene("deng2017_table1", ["uncertainty.operating.shaft_speed={low: 40000 rpm, high: 45000 rpm}", "table.maximum_speed=50 krpm"])
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("7 s", "wrong dimension"),
        ("7 furlgons", "unknown unit"),
        ("seven", "expected a length"),
        ("", "expected a length"),
        (True, "expected a length"),
        ("7 mm mm", "wrong dimension"),
        ("3 )(", "expected a length"),
    ],
)
def test_what_is_no_length_is_refused_with_an_example(text, reason):
    with pytest.raises(ValueError, match=reason) as error:
        to_si(text, "m")
    assert "7.0 mm" in str(error.value)


@given(st.floats(1e-9, 1e9))
def test_a_bound_itself_is_within_bounds(value):
    Quantity("m", "", value, 2 * value).read(value)


@pytest.mark.parametrize("name", scene_names())
def test_bundled_scenes_survive_a_round_trip_through_yaml(name):
    scene = load_scene(name)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


def test_all_errors_are_reported_at_once_each_with_path_value_and_bound():
    wrong = [
        "bearing.outer_raceway.low_radus=34.865mm",
        "bearing.roller.diameter=7 s",
        "bearing.roller.count=2.5",
        "bearing.cage.mass=-1 g",
        "operating.shaft_speed=nan rpm",
        "level=planr",
        "lubricant.traction.law=constant",
        "lubricant.traction.q=1",
    ]
    with pytest.raises(SceneError) as error:
        load_scene("deng2017_table1", wrong)
    errors = {each.path: str(each) for each in error.value.errors}
    assert set(errors) == {
        "bearing.outer_raceway.low_radus", "bearing.roller.diameter", "bearing.roller.count", "bearing.cage.mass",
        "operating.shaft_speed", "level", "lubricant.traction.q",
    }  # fmt: skip
    assert "did you mean 'low_radius'?" in errors["bearing.outer_raceway.low_radus"]
    assert "-1 g is outside 0.001 g to 1e+06 g" in errors["bearing.cage.mass"]
    assert "'7 s'" in errors["bearing.roller.diameter"]


def test_parts_that_do_not_fit_together_are_told_together():
    with pytest.raises(SceneError) as error:
        load_scene("deng2017_table1", ["bearing.roller.count=40", "bearing.cage.width=1 mm", "bearing.outer_raceway.low_radius=50 mm"])
    text = str(error.value)
    assert "40 rollers of 7 mm do not fit" in text and "wider than the cage" in text and "low_radius: 50 mm leaves" in text


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("bearing.outer_raceway.low_radius", "expected FIELD=VALUE"),
        ("=3", "expected FIELD=VALUE"),
        ("operating.shaft_speed.x=3", "is a value, not a block"),
        ("lubricant.oil=mil_l_7807", "did you mean 'mil_l_7808'?"),
        ("bearing.preset=deng2017_table3", "did you mean 'deng2017_table"),
        ("operating.misalignment=1 mrad", "misalignment"),
    ],
)
def test_overrides_that_cannot_be_applied_say_why(override, expected):
    with pytest.raises(SceneError) as error:
        load_scene("deng2017_table1", [override])
    assert expected in str(error.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "name: x\nname: y", "{", "7", "a: *b", "bearing: 7\nlubricant: []\noperating: x\nname: 3", "name: a\nbearing: {preset: [1]}"]
)
def test_files_that_are_no_scene_end_in_a_message(text):
    with pytest.raises(SceneError):
        scene_from_yaml(text)


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=5),
        lambda x: (
            st.lists(x, max_size=3)
            | st.dictionaries(
                st.sampled_from(["name", "bearing", "preset", "lubricant", "oil", "operating", "roller", "traction", "law"]), x, max_size=4
            )
        ),
        max_leaves=12,
    )
)
def test_no_yaml_tree_crashes_the_reader(tree):
    import yaml

    with pytest.raises(SceneError):
        scene_from_yaml(yaml.safe_dump(tree))


def test_an_unknown_scene_lists_what_is_bundled():
    with pytest.raises(SceneError, match="deng2017_table1"):
        load_scene("no_such_scene")


def test_both_bearings_have_the_published_geometry():
    first, second = load_scene("deng2017_table1").bearing, load_scene("deng2017_table2").bearing
    assert (2 * first.inner_raceway.radius, 2 * first.outer_raceway.low_radius, first.outer_raceway.d_value) == pytest.approx(
        (55.75e-3, 69.725e-3, 98e-6)
    )
    assert (2 * second.inner_raceway.radius, 2 * second.outer_raceway.low_radius, second.outer_raceway.d_value) == pytest.approx(
        (55.7e-3, 69.648e-3, 60e-6)
    )


def test_a_tolerance_without_a_kind_is_refused_with_the_fields_that_have_one():
    with pytest.raises(SceneError, match="integration.tolerance = 0.001: unknown field.*absolute_tolerance, relative_tolerance"):
        load_scene("deng2017_table1", ["integration.tolerance=1e-3"])
    with pytest.raises(SceneError, match=r"integration.absolute_tolerance = .*"):
        load_scene("deng2017_table1", ["integration.absolute_tolerance=1 um"])


def test_tolerances_are_read_with_their_units():
    absolute = "integration.absolute_tolerance={position: 1 um, play: 0.002 mm, speed: 3 mm/s}"
    integration = load_scene("deng2017_table1", [absolute, "integration.relative_tolerance=2 %"]).integration
    assert integration.absolute_tolerance.position == pytest.approx(1e-6) and integration.absolute_tolerance.play == pytest.approx(2e-6)
    assert integration.absolute_tolerance.speed == pytest.approx(3e-3) and integration.relative_tolerance == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(1258.3, 3, "1260"), (99.92, 2, "100"), (210.4, 2, "210"), (0.0472, 2, "0.047"), (-3.456, 2, "-3.5"), (math.nan, 2, "nan")],
)
def test_a_number_in_digits_has_no_exponent_where_it_is_large(value, digits, text):
    assert in_digits(value, digits) == text
