# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the text of tables: what data loggers write is read as it is meant, and what may mean two things is refused by line and column."""

import math

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.inputs.csv_import import TableError, mapping_from_yaml, read_table
from bearing_sim.inputs.csv_text import Marks, spelled, unit_in
from bearing_sim.inputs.gate import UNITS
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.quantity import conversion

TIME = "name: rig\ntime: {column: t, unit: s}\n"
MAPPING = TIME + "shaft_speed: {column: n, unit: rpm}\nradial_load: {law: sum, columns: [{column: f, unit: N}]}\n"
START = 1_700_000_000


def read(tmp_path, text, mapping=MAPPING, encoding="utf-8"):
    (tmp_path / "data.csv").write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    return read_table(tmp_path / "data.csv", mapping_from_yaml(mapping))


@pytest.mark.parametrize(
    "text",
    [
        '# rig 7\n// an export\nt,n,f\n0,30,800.5\n# a stop, "of ten\n1,60,700\n',
        "Logger v3\nSite: here, there\n\nt;n;f\n0;30;800,5\n1;60;700\n",
        "t\tn\tf\n0\t30\t800,5\n1\t60\t700\n",
        "t|n|f\n0|30|800.5\n1|60|700\n",
        "t,n,f,\n0,30,800.5,\n1,60,700,\n",
        "t,n,f\n0,30,800.5,\n1,60,700,,\n",
        "t;n;f;\n0;30;800,5\n1;60;700\n",
        "t;n;f\ns;1/min;N\n0;30;800,5\n1;60;700\n",
        "#t;n;f\n0;30;800,5\n1;60;700\n",
        "\ufefft,n,f\r\n0,30,800.5\r\n1,60,700\r\n",
        't,n,f\n0,"30","800,5"\n1,60,700\n',
        "f,,t,,n\n800.5,,0,x,30\n700,,1,,60\n",
    ],
)
def test_tables_of_data_loggers_are_read_as_they_are_meant(tmp_path, text):
    table = read(tmp_path, text)
    assert table.values["shaft_speed"] == pytest.approx([math.pi, 2 * math.pi])
    assert list(table.values["radial_load"]) == [800.5, 700.0]
    assert not table.tally.refused and table.tally.there == 2


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16"])
def test_every_usual_encoding_is_found_by_itself(tmp_path, encoding):
    text = "t;n;f;T_Öl [°C]\n0;30;800;60\n1;30;800;61\n"
    table = read(tmp_path, text, MAPPING + "oil_temperature: {column: 'T_Öl [°C]'}\n", encoding)
    assert table.values["oil_temperature"] == pytest.approx([333.15, 334.15])
    assert any("encoding" in note for note in table.notes) == (encoding not in ("utf-8", "utf-8-sig"))


@pytest.mark.parametrize(
    "heading, name, unit, si, scale",
    [
        ("Speed [rpm]", "Speed", "rpm", "rad/s", math.pi / 30),
        ("Drehzahl (U/min)", "Drehzahl", "rpm", "rad/s", math.pi / 30),
        ("n / min-1", "n", "rpm", "rad/s", math.pi / 30),
        ("Load (kN)", "Load", "kN", "N", 1000.0),
        ("Md [Nm]", "Md", "N*m", "N*m", 1.0),
        ("T_oil/°C", "T_oil", "degC", "K", 1.0),
        ("a [m/s²]", "a", "m/s^2", "m/s^2", 1.0),
        ("Time", "Time", "", "", None),
    ],
)
def test_units_in_headings_are_those_that_users_write(heading, name, unit, si, scale):
    found = unit_in(heading)
    assert (found[0], spelled(found[1])) == (name, unit)
    assert scale is None or conversion(unit, si)[0] == pytest.approx(scale)


def test_a_column_without_a_unit_in_the_mapping_has_the_one_in_its_heading_and_a_contradiction_is_told(tmp_path):
    text = "t,Speed [rpm],Load (kN)\n0,30,1\n1,30,2\n"
    mapping = TIME + "shaft_speed: {column: 'Speed [rpm]'}\nradial_load: {law: sum, columns: [{column: Load (kN)}]}\n"
    table = read(tmp_path, text, mapping)
    assert table.values["shaft_speed"] == pytest.approx([math.pi] * 2) and list(table.values["radial_load"]) == [1000.0, 2000.0] and not table.notes
    table = read(tmp_path, text, mapping.replace("{column: Load (kN)}", "{column: Load (kN), unit: N}"))
    assert list(table.values["radial_load"]) == [1.0, 2.0] and "says kN, the mapping N" in table.notes[0]


@pytest.mark.parametrize(
    "text, words",
    [
        ("t;n;f\n0;1,500;800\n1;1,500;800\n", "line 2: n = '1,500' is 1.5 or, with a separator of thousands, 1500; .*--decimal"),
        ("t;n;f\n0;1500;800,5\n0.5;1500;800\n", "line 3: t = '0.5' is not written as f = '800,5' in line 2; .*--decimal"),
        ("a;b;c\n0;1;2\n", "line 1: the header has a, b, c"),
        ("t n f\n0 1 2\n", "one column only .*comma, semicolon, tab"),
        ("", "the header has nothing"),
        ("t;n;f\n", "no rows"),
        ("t,n,f\n3,1,1\n2,1,1\n1,1,1\n", "line 3: 1 rows rise in time, 2 go back; sort them by time, or choose one machine"),
        ('t,n,f\n0,1,"1\n1,1,1\n', "line 2: a quotation mark is opened and not closed"),
        ("t,n,f\n0,abc,1\n", "1 x shaft_speed.not_a_number .line 2: n = 'abc' is not a number"),
        ("t,n,f\n0,'1,2\n", "time.cells|not_a_number"),
        (b"t,n,f\n\0\0\0", "no text"),
        (b"PK\x03\x04xl", "save the sheet as CSV"),
    ],
)
def test_what_may_mean_two_things_or_nothing_is_refused_with_line_column_and_what_to_do(tmp_path, text, words):
    with pytest.raises(TableError, match=words):
        read(tmp_path, text)


def test_a_decimal_comma_in_one_cell_decides_for_all_of_them(tmp_path):
    assert read(tmp_path, "t;n;f\n0;1,500;800\n0,5;1,500;800\n").values["shaft_speed"] == pytest.approx([1.5 * math.pi / 30] * 2)
    decided = MAPPING + "decimal: ','\n"
    assert read(tmp_path, "t;n;f\n0;1,500;800\n1;1,500;800\n", decided).values["shaft_speed"] == pytest.approx([1.5 * math.pi / 30] * 2)


@pytest.mark.parametrize(
    "time, cells, seconds",
    [
        ("format: iso, zone: Europe/Berlin", ["2026-07-01 02:00:00", "2026-07-01 02:10:00"], [0, 600]),
        ("format: iso, zone: Europe/Berlin", ["2026-07-01 00:00:00Z", "2026-07-01 02:10:00"], [0, 600]),
        ("format: iso, zone: '+02:00'", ["2026-07-01 02:00", "2026-07-01T02:10:00,5"], [0, 600.5]),
        ("format: '%d.%m.%Y %H:%M'", ["01.07.2026 00:00", "01.07.2026 00:10"], [0, 600]),
        ("format: '%m/%d/%Y %I:%M %p'", ["07/01/2026 12:00 AM", "07/01/2026 12:10 AM"], [0, 600]),
        ("unit: ms", ["1782864000000", "1782864600000"], [0, 600]),
        ("unit: s", ["1782864000", "1782864600.25"], [0, 600.25]),
        ("unit: day, epoch: 1899-12-30", ["46204", "46204.25"], [0, 21600]),
    ],
)
def test_times_are_read_as_they_are_written_with_their_zone(tmp_path, time, cells, seconds):
    """The first of all these times is the midnight that begins 1 July 2026, UTC."""
    mapping = MAPPING.replace("{column: t, unit: s}", f"{{column: t, {time}}}")
    table = read(tmp_path, "t;n;f\n" + "".join(f"{cell};1;2\n" for cell in cells), mapping + "decimal: '.'\n")
    assert [(stamp - 1_782_864_000 * 10**9) * 1e-9 for stamp in table.stamps["shaft_speed"]] == pytest.approx(seconds)


def test_the_hour_that_is_told_twice_in_autumn_rises(tmp_path):
    """On 25 October 2026 the clocks of Berlin go from 3:00 back to 2:00."""
    times = [f"25.10.2026 {clock}" for clock in ("01:30", "02:00", "02:30", "02:00", "02:30", "03:00")]
    mapping = MAPPING.replace("{column: t, unit: s}", "{column: t, format: '%d.%m.%Y %H:%M', zone: Europe/Berlin}")
    table = read(tmp_path, "t;n;f\n" + "".join(f"{time};1;2\n" for time in times), mapping)
    assert not table.tally.refused and {b - a for a, b in zip(table.stamps["shaft_speed"], table.stamps["shaft_speed"][1:])} == {1800 * 10**9}


def test_date_and_time_of_day_may_stand_in_two_columns(tmp_path):
    mapping = MAPPING.replace("{column: t, unit: s}", "{column: d, time_of_day: t, format: '%d.%m.%Y %H:%M:%S'}")
    table = read(tmp_path, "d;t;n;f\n01.07.2026;00:00:01;1;2\n01.07.2026;00:00:02;1;2\n", mapping)
    assert list(table.stamps["shaft_speed"]) == [1_782_864_001 * 10**9, 1_782_864_002 * 10**9]


@pytest.mark.parametrize(
    "given, words",
    [
        ("{column: t, format: iso, zone: Berlin}", "zone = 'Berlin': expected a name such as Europe/Berlin"),
        ("{column: t, unit: s, zone: Europe/Berlin}", "go with format only"),
        ("{column: t, unit: furlong}", "furlong"),
    ],
)
def test_a_time_that_cannot_be_meant_is_refused(given, words):
    with pytest.raises(ValueError, match=words):
        mapping_from_yaml(MAPPING.replace("{column: t, unit: s}", given))


def test_inputs_that_were_not_measured_are_constants_and_two_of_them_are_no_log(tmp_path):
    mapping = (
        TIME + "shaft_speed: {constant: 3000 rpm}\nradial_load: {law: sum, columns: [{column: f, unit: N}]}\noil_temperature: {constant: 60 degC}\n"
    )
    table = read(tmp_path, "t,f\n0,1\n1,2\n", mapping)
    assert table.values["shaft_speed"] == pytest.approx([100 * math.pi] * 2) and table.values["oil_temperature"] == pytest.approx([333.15] * 2)
    constant = "radial_load: {law: constant, value: 800 N}\n"
    assert list(read(tmp_path, "t,n\n0,1\n1,2\n", TIME + "shaft_speed: {column: n, unit: rpm}\n" + constant).values["radial_load"]) == [800.0, 800.0]
    for text, words in (
        (TIME + "shaft_speed: {constant: 3000 rpm}\n" + constant, "nothing is left of the table"),
        (MAPPING + "oil_temperature: {constant: 60 degC, unit: K}\n", "unit do not go with a constant"),
        (MAPPING + "oil_temperature: {constant: 60 N}\n", "wrong dimension"),
        (MAPPING + "cage_speed: {constant: 60 rpm}\n", "cage_speed: expected a column; a constant is no measurement"),
        (MAPPING + "running_clearance: {constant: 20 um}\n", "running_clearance: expected a column; a constant is no measurement"),
        (MAPPING.replace("{column: n, unit: rpm}", "{constant: 3000}"), "has no unit"),
    ):
        with pytest.raises(ValueError, match=words):
            mapping_from_yaml(text)


def test_the_force_of_a_gear_follows_from_its_torque_teeth_share_and_weight(tmp_path):
    """By hand: T = 100 N m on 0.2 m gives F_t = 1000 N; tan 20 deg/cos 15 deg = 0.3768; half of it, and 300 N across."""
    law = "{law: gear_force, torque: {column: f, unit: N*m}, pitch_diameter: 200 mm, pressure_angle: 20 deg, helix_angle: 15 deg, share: 50 %, "
    mapping = TIME + "shaft_speed: {column: n, unit: rpm}\nradial_load: " + law + "dead_weight: 300 N}\n"
    assert read(tmp_path, "t,n,f\n0,1,100\n1,1,0\n", mapping).values["radial_load"] == pytest.approx(
        [math.hypot(500 * 1.06863, 300), 300.0], rel=1e-4
    )
    with pytest.raises(ValueError, match="either power, or torque"):
        mapping_from_yaml(mapping.replace("torque: {column: f, unit: N*m}, ", ""))
    with pytest.raises(ValueError, match="efficiency goes with power"):
        mapping_from_yaml(mapping.replace("share: 50 %", "efficiency: 0.9"))


def command(*arguments):
    return CliRunner().invoke(main, ["import-csv", *map(str, arguments)])


def test_options_stand_for_columns_that_a_table_lacks_and_choose_rows_and_fields(tmp_path):
    (tmp_path / "data.csv").write_text("id;t;n\nA;0;1,5\nB;0;2,5\nA;1;1,5\n")
    (tmp_path / "rig.yaml").write_text(TIME + "shaft_speed: {column: n, unit: rpm}\nradial_load: {law: sum, columns: [{column: f, unit: N}]}\n")
    here = tmp_path / "data.csv", tmp_path / "rig.yaml", "-o", tmp_path / "log.mcap"
    assert "no column 'f'" in command(*here).stderr
    done = command(*here, "--load", "800N", "--oil-temperature", "60 degC", "--only", "id=A", "--set", "shaft_speed.unit=Hz")
    assert done.exit_code == 0, done.output
    for note in (
        "delimiter: semicolon",
        "decimal mark: comma",
        "2 of 2 rows used; 1 more do not concern",
        "radial_load messages",
        "oil_temperature messages",
    ):
        assert note in done.stdout
    for options, words in (
        (("--load", "800"), "radial_load = 800: a number without a unit; write for example 800N or 800kN"),
        (("--load", "800rpm"), "wrong dimension"),
        (("--load", "-5N"), "expected zero or more"),
        (("--speed", "3 apples"), "apples"),
        (("--only", "id"), "expected HEADING=VALUE"),
        (("--set", "shaft_speed"), "expected FIELD=VALUE"),
        (("--delimiter", "abc"), "expected one character"),
        (("--column", "time=t"), "go with --guess"),
    ):
        refused = command(*here, "--force", *options)
        assert refused.exit_code == 2 and words in refused.stderr
    assert "bearing-sim import-csv --guess" in command(tmp_path / "data.csv", "--force", "-o", tmp_path / "log.mcap").stderr


def test_every_channel_of_the_gate_has_a_unit_that_a_constant_can_name():
    assert set(UNITS.values()) == {"rad/s", "N", "K", "m"}


NARROW, THIN, CURLED = "\N{NARROW NO-BREAK SPACE}", "\N{THIN SPACE}", "\N{RIGHT SINGLE QUOTATION MARK}"


@pytest.mark.parametrize(
    "delimiter, speeds, loads, marks",
    [
        (";", ("1.480,5", "-1.480,5"), ("5.000,0", "900,0"), Marks(",", ".")),
        (";", ("1.480", "980"), ("5,5", "6,25"), Marks(",", ".")),  # the load has the decimal comma, so the dot of the speed is none
        (",", ('"1,480.5"', '"+980.5"'), ('"5,000"', '"1,005,000"'), Marks(".", ",")),
        (";", ("1,234,567", "1,480"), ("5", "6"), Marks(".", ",")),
        (";", ("1'480.5", f"1{CURLED}480"), ("5000", "6"), Marks(".", "apostrophe")),
        (";", ("1 480,5", f"\N{MINUS SIGN}1{NARROW}480,5"), ("5\N{NO-BREAK SPACE}000", f"6{THIN}000"), Marks(",", "space")),
        ("\t", ("1480.5", "0.125"), ("1.500", "2.500"), Marks()),  # no whole number begins with a zero
        (",", ("1480", "1481"), ("1.500", "2.500"), Marks()),  # nobody separates cells and decimals by the same comma
    ],
)
def test_separators_of_thousands_are_recognised_by_all_cells_together(tmp_path, delimiter, speeds, loads, marks):
    text = "\n".join(delimiter.join(row) for row in (("t", "n", "f"), *zip("01", speeds, loads)))
    table = read(tmp_path, text, MAPPING.replace("unit: N", "scale: 1 N").replace("unit: rpm", "scale: 1 rad/s"))

    def plain(cell):  # independent of the program: by hand for each way of writing
        for separator in {".": ".", ",": ",", "apostrophe": f"'{CURLED}", "space": f" \N{NO-BREAK SPACE}{NARROW}{THIN}"}.get(marks.thousands, ""):
            cell = cell.replace(separator, "")
        return float(cell.strip('"').replace(",", ".").replace("\N{MINUS SIGN}", "-"))

    assert list(table.values["shaft_speed"]) == [plain(cell) for cell in speeds]
    assert list(table.values["radial_load"]) == [plain(cell) for cell in loads] and table.tally.is_whole
    assert sum("thousands" in note for note in table.notes) == bool(marks.thousands)


@pytest.mark.parametrize("cells", [("1,500", "1,600"), ("1.500", "1.600"), ("1480", "1.483"), ("1,480.0", "1.480,0"), ("1,5", "1.5")])
def test_columns_whose_numbers_can_be_read_in_two_ways_or_in_none_are_asked_about(tmp_path, cells):
    with pytest.raises(TableError, match=r"line [23]: n = .*--decimal"):
        read(tmp_path, "".join(["t;n;f\n", *(f"{k};{cell};5\n" for k, cell in enumerate(cells))]))


def test_a_cell_that_is_not_grouped_in_threes_is_refused_and_counted_where_thousands_are_separated(tmp_path):
    text = "t;n;f\n" + "".join(f"{k};{'1.48,0' if k == 3 else '1.480,5'};5\n" for k in range(9))
    table = read(tmp_path, text)
    assert table.tally.refused == {"shaft_speed.not_a_number": 1} and table.tally.used == 8


@pytest.mark.parametrize(
    "heading, unit, speed",
    [
        ("n [%]", "'% of 1500 rpm'", 1474.5),
        ("n [\N{PER MILLE SIGN}]", "'\N{PER MILLE SIGN} of 15000 rpm'", 1474.5),
        ("n", "percent of 25 Hz", 1474.5),
        ("n [% of 1500 rpm]", None, 1474.5),
        ("n [%]", "rpm", "the heading 'n .%.' is a percentage; expected the speed at 100 %, such as '% of 1500 rpm'"),
        ("n_pct", "rpm", "the heading 'n_pct' is a percentage"),
        ("n", "'%'", "of what. Expected the speed at 100 %, such as '% of 1500 rpm'"),
        ("n [% rated]", None, "of what. Expected the speed at 100 %"),
    ],
)
def test_a_percentage_is_that_of_a_speed_that_is_named_and_never_a_speed_itself(tmp_path, heading, unit, speed):
    mapping = MAPPING.replace("{column: n, unit: rpm}", f"{{column: '{heading}'{f', unit: {unit}' if unit else ''}}}")
    text = f"t;{heading};f\n0;98.3;5\n1;98.3;5\n"
    if isinstance(speed, str):
        with pytest.raises(SceneError, match=speed):
            read(tmp_path, text, mapping)
    else:
        assert list(read(tmp_path, text, mapping).values["shaft_speed"]) == pytest.approx([speed * math.pi / 30] * 2)
