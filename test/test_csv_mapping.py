# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about mappings: units at the door, every fault at once with its place, the bundled ones sound."""

import pytest

from bearing_sim.inputs.csv_import import load_mapping, mapping_from_yaml
from bearing_sim.scene.loader import SceneError, catalog_names

GOOD = """
name: test rig
time: {column: t, unit: ms, epoch: 2020-01-01}
shaft_speed: {column: n, unit: rpm}
radial_load: {law: sum, columns: [{column: f, unit: kN}]}
oil_temperature: {column: T, unit: degC}
"""


def faults_of(text):
    with pytest.raises(SceneError) as raised:
        mapping_from_yaml(text)
    return {fault.path: fault for fault in raised.value.errors}


def test_units_become_scale_and_offset_in_si():
    mapping = mapping_from_yaml(GOOD)
    assert mapping.shaft_speed.line() == pytest.approx((0.10471975511965977, 0.0))
    assert mapping.radial_load.columns[0].line() == pytest.approx((1000.0, 0.0))
    assert mapping.oil_temperature.line() == pytest.approx((1.0, 273.15))
    assert mapping.time.nanoseconds_per_unit() == pytest.approx(1e6)
    assert mapping.time.epoch_ns() == 1_577_836_800_000_000_000


def test_scale_and_offset_take_units_too():
    mapping = mapping_from_yaml(GOOD.replace("{column: n, unit: rpm}", "{column: n, scale: 327.6 rpm, offset: 1 rad/s}"))
    assert mapping.shaft_speed.line() == pytest.approx((34.306191777, 1.0))


def test_all_faults_are_told_at_once_with_their_places():
    faults = faults_of("""
name: bad
delimeter: ";"
time: {column: t, unit: parsecs}
shaft_speed: {colum: n, unit: rpm}
radial_load: {law: mass_times_acceleration, mass: -3 kg, accelerations: [{column: a, unit: m/s}, {column: b, unit: m/s^2, scal: 1}]}
oil_temperature: {column: T}
""")
    assert "did you mean 'delimiter'" in faults["delimeter"].reason
    assert "parsecs" in faults["time"].reason
    assert "did you mean 'column'" in faults["shaft_speed.colum"].reason
    assert "outside" in faults["radial_load.mass"].reason
    assert "wrong dimension" in faults["radial_load.accelerations.0"].reason
    assert "did you mean 'scale'" in faults["radial_load.accelerations.1.scal"].reason
    assert "either unit, or scale" in faults["oil_temperature"].reason


@pytest.mark.parametrize(
    "old, new, words",
    [
        ("law: sum", "law: summ", "radial_load.law = 'summ': expected one of 'sum', 'norm', .*did you mean 'sum'"),
        ("law: sum, ", "", "radial_load.law: missing"),
        ("name: test rig", "name: test rig\n[1, 2]: 3", "a key cannot be a list"),
        ("unit: kN", "unit: kN, scale: 3 N", "either unit, or scale"),
        ("unit: kN", "unit: kN, offset: 3 N", "offset does not go with unit"),
        ("unit: kN", "scale: .nan", "outside|finite"),
        ("[{column: f, unit: kN}]", "[]", "needs at least one column"),
        ("unit: ms", "unit: ms, format: iso", "either unit .numbers., or format"),
        ("unit: ms, epoch: 2020-01-01", "format: iso, epoch: 2020-01-01", "epoch does not go with format"),
        ("epoch: 2020-01-01", "epoch: yesterday", "expected a date"),
        ("column: n", "column: n, formula: 2*n", "unknown field"),
        ("name: test rig", "name: test rig\nname: again", "written twice"),
        (GOOD, "- a list", "expected a mapping with time"),
        (GOOD, "{", "not readable as YAML"),
    ],
)
def test_a_mapping_that_cannot_be_meant_is_refused(old, new, words):
    with pytest.raises(SceneError, match=words):
        mapping_from_yaml(GOOD.replace(old, new))


def test_bundled_mappings_load_and_name_their_assumptions():
    assert catalog_names("mappings") == ["citation_flight", "wind_turbine_high_speed_shaft", "wind_turbine_scada"]
    for name in catalog_names("mappings"):
        mapping, text = load_mapping(name)
        assert mapping.name == name and mapping.source and "ASSUMPTION" in text


def test_flight_mapping_is_full_speed_32760_rpm_and_one_g_of_12_kg_at_rest():
    mapping, _ = load_mapping("citation_flight")
    scale, offset = mapping.shaft_speed.line()
    assert (100 * scale + offset) * 30 / 3.141592653589793 == pytest.approx(32760.0)
    assert mapping.radial_load.mass == 12.0
    assert [record.line() for record in mapping.radial_load.columns] == [pytest.approx((9.80665, 9.80665)), pytest.approx((9.80665, 0.0))]


def test_unknown_mapping_is_told_with_those_there_are(tmp_path):
    with pytest.raises(SceneError, match="did you mean 'citation_flight'.*wind_turbine_scada"):
        load_mapping("citation_fligth")
    (tmp_path / "latin.yaml").write_bytes("name: Prüfstand".encode("latin-1"))
    with pytest.raises(SceneError, match="UTF-8"):
        load_mapping(tmp_path / "latin.yaml")
