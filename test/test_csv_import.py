# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about imported tables: each row becomes what the mapping says, or is refused by line number; nothing is filled in."""

import csv
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from mcap.reader import make_reader
from support import measured_file

from bearing_sim.cli.main import main
from bearing_sim.files.tally import PartlyUsedWarning
from bearing_sim.inputs.csv_import import METADATA, TableError, input_log, load_mapping, mapping_from_yaml, read_table, write_log
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

MAPPING = """
name: rig
time: {column: t, unit: s, epoch: 2020-01-01}
shaft_speed: {column: n, unit: rpm}
radial_load: {law: sum, columns: [{column: f, unit: N}]}
"""
EPOCH = 1_577_836_800_000_000_000


def table_of(tmp_path, text, mapping=MAPPING):
    (tmp_path / "data.csv").write_text(text)
    return read_table(tmp_path / "data.csv", mapping_from_yaml(mapping))


def test_rows_become_messages_in_si_at_their_times(tmp_path):
    table = table_of(tmp_path, "t,n,f\n0.000000001,30,800\n0.1,60,5\n")
    stamps = {channel: list(each) for channel, each in table.stamps.items()}
    assert stamps == {"shaft_speed": [EPOCH + 1, EPOCH + 100_000_000], "radial_load": [EPOCH + 1, EPOCH + 100_000_000]}
    assert table.values["shaft_speed"] == pytest.approx([math.pi, 2 * math.pi])
    assert list(table.values["radial_load"]) == [800.0, 5.0]
    assert not table.tally.refused and not table.gaps


@pytest.mark.parametrize(
    "load, expected",
    [
        ("{law: sum, columns: [{column: f, unit: N}, {column: g, unit: kN}]}", 3 + 4000.0),
        ("{law: norm, columns: [{column: f, unit: N}, {column: g, unit: N}]}", 5.0),
        (
            "{law: mass_times_acceleration, mass: 12 kg, accelerations: [{column: f, scale: 1 g_0, offset: 1 g_0}, {column: g, scale: 1 g_0}]}",
            12 * 9.80665 * math.hypot(1 + 3, 4),
        ),
        ("{law: gear_force, power: {column: g, unit: kW}, efficiency: 0.8, pitch_diameter: 500 mm}", 2 * 4000 / (0.8 * math.pi * 0.5)),
    ],
)
def test_each_law_of_load_is_what_it_says(tmp_path, load, expected):
    mapping = MAPPING.replace("{law: sum, columns: [{column: f, unit: N}]}", load)
    assert table_of(tmp_path, "t,n,f,g\n0,30,3,4\n1,30,3,4\n", mapping).values["radial_load"] == pytest.approx([expected] * 2)


@pytest.mark.parametrize(
    ("negative", "loads"), [("", [800.0, 3.0]), ("refuse", [800.0, 3.0]), ("magnitude", [800, 5, 3]), ("direction", [800, -5, 3])]
)
def test_a_negative_load_is_refused_with_its_line_unless_the_mapping_says_what_it_is(tmp_path, negative, loads):
    mapping = MAPPING.replace("law: sum", f"law: sum, negative: {negative}" if negative else "law: sum")
    table = table_of(tmp_path, "t,n,f\n0,30,800\n0.1,30,-5\n0.2,30,3\n", mapping)
    assert list(table.values["radial_load"]) == loads
    if len(loads) == 2:
        assert table.tally.refused == {"radial_load.negative": 1}
        line, text = table.examples["radial_load.negative"][0]
        assert line == 3 and "-5 N is negative" in text and "radial_load.negative=magnitude" in text


def test_what_a_replay_refuses_for_every_bearing_and_codes_of_errors_are_no_values(tmp_path):
    mapping = MAPPING + "oil_temperature: {column: T, unit: degC}\n"
    rows = [(30, 800, 60), (-9999, 800, 60), (30, -9999.9, 60), (30, 800, -999), (30, 800, 612), (30, 9999, -32768), (-998, 99, -39)]
    table = table_of(tmp_path, "t,n,f,T\n" + "".join(f"{k},{n},{f},{T}\n" for k, (n, f, T) in enumerate(rows)), mapping)
    assert table.tally.refused == {
        "shaft_speed.error_code": 1,
        "radial_load.error_code": 1,
        "oil_temperature.error_code": 2,
        "oil_temperature.too_large": 1,
    }
    assert "input_limits.maximum_temperature" in table.examples["oil_temperature.too_large"][0][1]
    with pytest.warns(PartlyUsedWarning):
        replayed = judge(input_log(table, tmp_path / "data.csv"), InputLimits(), Inputs(0.0, 0.0, 0.0, 300.0))
    assert replayed.tally.refused == table.tally.refused, "the replay takes all that is left"


def test_a_sensor_that_sticks_is_told_and_a_machine_at_rest_is_not(tmp_path):
    generator = np.random.default_rng(2)
    temperatures = np.round(60.0 + generator.normal(0.0, 1.0, 600), 2)
    temperatures[200:400] = 61.4
    rows = "".join(f"{k},{0 if k < 300 else 30 + k % 7},800,{T}\n" for k, T in enumerate(temperatures))
    table = table_of(tmp_path, "t,n,f,T\n" + rows, MAPPING + "oil_temperature: {column: T, unit: degC}\n")
    told = "oil_temperature is 61.4 degC from line 202 on for 199 s: constant conditions, or a sensor that sticks; its values are used"
    assert [note for note in table.notes if "sticks" in note] == [told]
    assert len(table.values["oil_temperature"]) == 600, "nothing is left out"


def test_power_without_speed_gives_no_force(tmp_path):
    law = "{law: gear_force, power: {column: f, unit: kW}, efficiency: 0.8, pitch_diameter: 500 mm}"
    table = table_of(tmp_path, "t,n,f\n0,0,4\n1,30,4\n2,,4\n", MAPPING.replace("{law: sum, columns: [{column: f, unit: N}]}", law))
    assert table.tally.refused == {"radial_load.no_speed": 2, "shaft_speed.empty_cell": 1}
    assert table.examples["radial_load.no_speed"][1][0] == 4


FAULTY = """t,n,f
0.0,30,800
0.1,,800
0.2,abc,800
0.3,30,nan
0.3,30,800
0.25,30,800
,30,800
noon,30,800
0.4,30
0.5,30,800,7

inf,30,800
0.6,1_000,800
0.7,30,800
"""


def test_every_fault_is_counted_with_its_line_and_only_its_message_is_lost(tmp_path):
    table = table_of(tmp_path, FAULTY)
    lines = {code: [line for line, _ in told] for code, told in table.examples.items()}
    assert lines == {
        "shaft_speed.empty_cell": [3],
        "shaft_speed.not_a_number": [4, 14],
        "radial_load.not_finite": [5],
        "time.repeated": [6],
        "time.backwards": [7],
        "time.empty_cell": [8],
        "time.unreadable": [9, 13],
        "time.cells": [10, 11],
    }
    assert table.tally.refused == {code: len(found) for code, found in lines.items()}
    assert table.tally.there == 13 and table.tally.used == 3, "an empty line is no row, and an empty cell no fault of what is there"
    assert [stamp - EPOCH for stamp in table.stamps["shaft_speed"]] == [0, 300_000_000, 700_000_000]
    assert [stamp - EPOCH for stamp in table.stamps["radial_load"]] == [0, 100_000_000, 200_000_000, 600_000_000, 700_000_000]


def test_of_many_faults_the_first_lines_are_told_and_all_counted(tmp_path):
    table = table_of(tmp_path, "t,n,f\n" + "".join(f"{row},{row if row % 2 else ''},1\n" for row in range(100)))
    assert table.tally.refused["shaft_speed.empty_cell"] == 50
    assert [line for line, _ in table.examples["shaft_speed.empty_cell"]] == [2, 4, 6, 8, 10]


def test_gaps_are_told_per_channel_by_the_line_that_ends_them(tmp_path):
    """Rows of 15 to 17 s are missing; the speed of 20 to 29 s is empty. The header is line 1, so row k is line k + 2."""
    times = [*range(15), *range(18, 50)]
    table = table_of(tmp_path, "t,n,f\n" + "".join(f"{time},{'' if 20 <= time < 30 else 1},1\n" for time in times))
    assert table.longest_step == pytest.approx(3.0)  # three median spacings
    assert table.gaps == [("shaft_speed", 17, 4.0), ("shaft_speed", times.index(30) + 2, 11.0), ("radial_load", 17, 4.0)]


def test_longest_step_of_the_mapping_decides_what_a_gap_is(tmp_path):
    mapping = MAPPING.replace("epoch: 2020-01-01", "longest_step: 10 s")
    text = "t,n,f\n0,1,1\n1,1,1\n11,1,1\n21.5,1,1\n"
    assert [(line, seconds) for channel, line, seconds in table_of(tmp_path, text, mapping).gaps if channel == "shaft_speed"] == [(5, 10.5)]


def test_quoted_cells_over_several_lines_keep_line_numbers_right(tmp_path):
    table = table_of(tmp_path, 't,n,f,note\n0,30,1,"two\nlines"\n1,,1,x\n')
    assert table.examples["shaft_speed.empty_cell"][0][0] == 4


def test_columns_of_measured_rings_become_their_topics_each_with_its_own_unit_and_empty_cells_are_not_filled(tmp_path):
    rings = "inner_ring_temperature: {column: i, unit: degC}\nouter_ring_temperature: {column: e, unit: K}\n"
    table = table_of(tmp_path, "t,n,f,i,e\n0,30,800,80,350\n1,30,800,,351\n2,30,800,82,352\n", MAPPING + rings)
    assert table.values["inner_ring_temperature"] == pytest.approx([353.15, 355.15]) and table.tally.refused == {
        "inner_ring_temperature.empty_cell": 1
    }
    write_log(table, MAPPING + rings, tmp_path / "data.csv", tmp_path / "log.mcap")
    log = read_input_log(tmp_path / "log.mcap")
    found = {channel: [value for (value,) in log.series[channel].values] for channel in ("inner_ring_temperature", "outer_ring_temperature")}
    assert found == {"inner_ring_temperature": pytest.approx([353.15, 355.15]), "outer_ring_temperature": pytest.approx([350.0, 351.0, 352.0])}
    assert log.series["inner_ring_temperature"].ros_type == "sensor_msgs/msg/Temperature"


def test_semicolons_decimal_commas_and_a_byte_order_mark(tmp_path):
    mapping = MAPPING.replace("name: rig", "name: rig\ndelimiter: ';'\ndecimal: ','")
    (tmp_path / "data.csv").write_bytes("\ufefft;n;f\n0,5;30;1,5\n1,0;30;1.00\n".encode())
    table = read_table(tmp_path / "data.csv", mapping_from_yaml(mapping))
    assert table.stamps["shaft_speed"][0] == EPOCH + 500_000_000
    assert list(table.values["radial_load"]) == [1.5] and table.tally.refused == {"radial_load.not_a_number": 1}


@pytest.mark.parametrize(
    "how, cells",
    [
        ("format: iso", ["2020-01-01 00:00:00+00:00", "2020-01-01T02:00:01+02:00"]),
        ("format: '%d.%m.%Y %H:%M:%S'", ["01.01.2020 00:00:00", "01.01.2020 00:00:01"]),
    ],
)
def test_timestamps_are_read_with_their_zone_or_as_utc(tmp_path, how, cells):
    mapping = MAPPING.replace("unit: s, epoch: 2020-01-01", how)
    table = table_of(tmp_path, "t,n,f\n" + "".join(f"{cell},1,1\n" for cell in cells), mapping)
    assert list(table.stamps["shaft_speed"]) == [EPOCH, EPOCH + 1_000_000_000]


def test_missing_columns_are_all_named_with_a_guess(tmp_path):
    mapping = MAPPING.replace("column: n", "column: speed").replace("column: f", "column: force")
    words = r"(?s)the header has t, sped, mass.*shaft_speed.column: no column 'speed' \(did you mean 'sped'\?\).*no column 'force'"
    with pytest.raises(TableError, match=words):
        table_of(tmp_path, "t,sped,mass\n0,1,1\n", mapping)


@pytest.mark.parametrize(
    "content, words",
    [
        (None, "no such file"),
        (b"", "header has nothing"),
        (b"t,n,f\n", "has no rows"),
        (b"t,n,f\n0,,\n1,,\n", "2 x shaft_speed.empty_cell"),
        (b"t,n,f,f\n0,1,1,1\n", "2 columns are called 'f'"),
        (b"t,n,f\n0,\xff,1\n", "1 x shaft_speed.not_a_number .line 2: n = 'ÿ'"),
        (b"PK\x03\x04rest", "workbook"),
        (b"t,n,f\n0,\0,1\n", "no text"),
        (b't,n,f\n0,"1"x,1\n', "line 2"),
    ],
)
def test_table_that_cannot_become_a_log_is_refused_in_words(tmp_path, content, words):
    if content is not None:
        (tmp_path / "data.csv").write_bytes(content)
    with pytest.raises(TableError, match=words):
        read_table(tmp_path / "data.csv", mapping_from_yaml(MAPPING))


def test_log_holds_the_table_its_mapping_and_its_checksum(tmp_path):
    table = table_of(tmp_path, "t,n,f\n0,30,800\n1,60,700\n")
    write_log(table, MAPPING, tmp_path / "data.csv", tmp_path / "log.mcap")
    log = read_input_log(tmp_path / "log.mcap")
    assert log.series["radial_load"].values == [(800.0, 0.0), (700.0, 0.0)]
    assert log.series["shaft_speed"].stamps == list(table.stamps["shaft_speed"])
    with open(tmp_path / "log.mcap", "rb") as stream:
        record = next(record.metadata for record in make_reader(stream).iter_metadata() if record.name == METADATA)
    assert record["mapping"] == MAPPING and record["file"] == "data.csv" and len(record["sha256"]) == 64


def command(*arguments):
    return CliRunner().invoke(main, ["import-csv", *map(str, arguments)])


def test_command_prints_one_json_object(tmp_path):
    (tmp_path / "data.csv").write_text(FAULTY)
    (tmp_path / "rig.yaml").write_text(MAPPING)
    ran = command(tmp_path / "data.csv", tmp_path / "rig.yaml", "-o", tmp_path / "log.mcap", "--json")
    assert ran.exit_code == 3 and "3 of 13 rows used (1 x radial_load.not_finite" in ran.stderr, ran.output
    report = json.loads(ran.stdout)
    assert report["messages"] == {"shaft_speed": 3, "radial_load": 5} and sum(report["read"]["not_used_by_reason"].values()) == 11
    assert report["refused_lines"]["time.cells"] == [10, 11]
    assert "line 10: 2 cells, expected 3" in command(tmp_path / "data.csv", tmp_path / "rig.yaml", "-o", tmp_path / "b.mcap").stdout


def test_command_leaves_nothing_behind_on_bad_input(tmp_path):
    (tmp_path / "data.csv").write_text(FAULTY)
    (tmp_path / "rig.yaml").write_text(MAPPING.replace("column: n", "column: speed"))
    ran = command(tmp_path / "data.csv", tmp_path / "rig.yaml", "-o", tmp_path / "log.mcap", "--json")
    assert ran.exit_code == 2 and "no column 'speed'" in ran.stderr and ran.stdout == ""
    assert command(tmp_path / "absent.csv", "citation_flight", "-o", tmp_path / "log.mcap").exit_code == 2
    assert command(tmp_path / "data.csv", "no_mapping", "-o", tmp_path / "log.mcap").exit_code == 2
    assert not list(tmp_path.glob("log*"))
    before = (tmp_path / "data.csv").read_bytes()
    assert command(tmp_path / "data.csv", "citation_flight", "-o", tmp_path / "data.csv").exit_code == 2
    assert (tmp_path / "data.csv").read_bytes() == before


def measured(name):
    path = measured_file(name)
    with open(path, newline="") as stream:
        return path, list(csv.DictReader(stream))


def test_measured_flight_is_imported_row_by_row():
    """Against arithmetic done here: distinct rising times, N2 in per cent of 32,760 rpm, 12 kg times hypot(1 + normal, lateral) g."""
    path, rows = measured("citation_flight_20190312_n1_n2_acc.csv")
    table = read_table(path, load_mapping("citation_flight")[0])
    kept, last = [], -math.inf
    for row in rows:
        if float(row["utc_s"]) > last:
            last = float(row["utc_s"])
            kept.append(row)
    assert table.tally.there == len(rows) == 46951
    assert table.tally.refused == {"time.repeated": len(rows) - len(kept)} and len(rows) - len(kept) == 9
    day = 1_552_348_800_000_000_000  # 2019-03-12 UTC
    assert [stamp - day for stamp in table.stamps["shaft_speed"]] == [round(float(row["utc_s"]) * 1000) * 1_000_000 for row in kept]
    speeds = [float(row["N2_lh_pct"]) / 100 * 32760 * 2 * math.pi / 60 for row in kept]
    loads = [12 * 9.80665 * math.sqrt((1 + float(row["body_norm_acc_g"])) ** 2 + float(row["body_lat_acc_g"]) ** 2) for row in kept]
    assert table.values["shaft_speed"] == pytest.approx(speeds, rel=1e-12)
    assert table.values["radial_load"] == pytest.approx(loads, rel=1e-12)


def test_measured_wind_turbine_loses_exactly_its_empty_cells():
    path, rows = measured("wind_scada_HMR_july2023.csv")
    table = read_table(path, load_mapping("wind_turbine_scada")[0])
    mine = [row for row in rows if row["TurbineName"] == "HMR_T01"]
    full = [row for row in mine if row["GenRpmMean"] and row["ActivePowerMean"]]
    assert (table.tally.there, table.left_out) == (len(mine), len(rows) - len(mine))
    assert table.tally.refused["shaft_speed.empty_cell"] == sum(not row["GenRpmMean"] for row in mine)
    assert len(table.values["radial_load"]) == len(full)
    row = full[-1]
    force = 2 * float(row["ActivePowerMean"]) * 1000 / (0.95 * float(row["GenRpmMean"]) * math.pi / 30 * 0.4)
    assert table.values["radial_load"][-1] == pytest.approx(force)
    assert table.gaps
