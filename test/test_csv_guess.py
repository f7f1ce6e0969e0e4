# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about guessed mappings: a guess is what was meant and says why; what may mean two things is asked for with the option that decides."""

import json

import pytest
from click.testing import CliRunner
from support import measured_file

from bearing_sim.cli.main import main
from bearing_sim.inputs.csv_guess import guess
from bearing_sim.inputs.csv_import import TableError, mapping_from_yaml, read_table

GERMAN = (
    "# Prüfstand 7\n# Ausfuhr\nZeit;Drehzahl [U/min];Last (kN);T_Öl/°C;\n01.02.2026 00:00:00;1500;1,5;60,2;\n01.02.2026 00:00:01;1501;1,6;60,3;\n"
)
ENGLISH = (
    "\ufeffTimestamp,Wind speed,Speed [rpm],Load (kN),Oil temp (°C),Status,\n"
    "2026-02-01T00:00:00Z,8,1500,1.5,60,ok,\n2026-02-01T00:10:00Z,9,1501,1.6,61,ok,\n"
)
SECOND_LINE = (
    "Rig\nSite: here\n\nDate\tTime\tn\tF\tIR temp\n\t\trpm\tN\t°C\n2026/02/01\t10:00:00\t1500\t800\t70\n2026/02/01\t10:00:01\t1500\t800\t70\n"
)
CAMEL = "epoch_ms,shaft_speed_rpm,radial_load_N,cageSpeedRpm\n1700000000000,1500,800,600\n1700000000100,1500,800,600\n"


def guessed(tmp_path, text, encoding="utf-8", **decided):
    (tmp_path / "data.csv").write_bytes(text.encode(encoding))
    return guess(tmp_path / "data.csv", **decided)


@pytest.mark.parametrize(
    "text, encoding, columns",
    [
        (GERMAN, "latin-1", {"time": "Zeit", "shaft_speed": "Drehzahl [U/min]", "radial_load": "Last (kN)", "oil_temperature": "T_Öl/°C"}),
        (ENGLISH, "utf-8", {"time": "Timestamp", "shaft_speed": "Speed [rpm]", "radial_load": "Load (kN)", "oil_temperature": "Oil temp (°C)"}),
        (
            "Datum;Uhrzeit;Drehzahl;Kraft\ntt.mm.jjjj;hh:mm:ss;1/min;kN\n01.03.2026;08:00:00;1500,4;1,25\n01.03.2026;08:00:01;1500,7;1,35\n",
            "latin-1",
            {"time": "Datum", "shaft_speed": "Drehzahl", "radial_load": "Kraft"},
        ),
        (SECOND_LINE, "utf-8", {"time": "Date", "shaft_speed": "n", "radial_load": "F", "inner_ring_temperature": "IR temp"}),
        (CAMEL, "utf-8", {"time": "epoch_ms", "shaft_speed": "shaft_speed_rpm", "radial_load": "radial_load_N", "cage_speed": "cageSpeedRpm"}),
        (
            "t [s];n [rpm];F [kN];radial clearance [um]\n0;1500;1,5;21,5\n1;1500;1,6;20,5\n",
            "utf-8",
            {"time": "t [s]", "shaft_speed": "n [rpm]", "radial_load": "F [kN]", "running_clearance": "radial clearance [um]"},
        ),
    ],
)
def test_a_guess_names_the_columns_says_why_and_imports_as_it_is(tmp_path, text, encoding, columns):
    found = guessed(tmp_path, text, encoding)
    assert not found.questions
    named = {name: tree for name, tree in found.tree.items() if isinstance(tree, dict)}
    assert {name: (tree.get("columns") or [tree])[0]["column"] for name, tree in named.items()} == columns
    assert set(columns) <= set(found.reasons) and all(found.reasons.values())
    table = read_table(tmp_path / "data.csv", mapping_from_yaml(found.text))
    assert table.tally.there == 2 and not table.tally.refused and {name.removesuffix("_measured") for name in table.stamps} == set(columns) - {"time"}


def test_a_guess_names_the_separator_of_thousands_and_takes_a_speed_before_its_percentage(tmp_path):
    found = guessed(tmp_path, "t [s];n [rpm];n [%];F [N];Serial\n0;1.480,0;98,3;5.000,5;123.45.6\n1;1.482,5;98,4;5.010,0;1.2.3\n")
    assert not found.questions and (found.tree["decimal"], found.tree["thousands"], found.tree["shaft_speed"]["column"]) == (",", ".", "n [rpm]")
    table = read_table(tmp_path / "data.csv", mapping_from_yaml(found.text))
    assert list(table.values["radial_load"]) == [5000.5, 5010.0] and table.tally.is_whole


def test_columns_that_are_not_used_are_told(tmp_path):
    found = guessed(tmp_path, ENGLISH)
    assert found.left == ["Wind speed", "Status"] and "columns that are not used: Wind speed, Status" in found.text


@pytest.mark.parametrize(
    "text, field, words, decided",
    [
        ("time,speed [rpm],F [N]\n0,1,2\n1,1,2\n", "time", "'time' has numbers without a unit.*--unit time=s", {"units": {"time": "s"}}),
        (
            "Date;n [rpm];F [N]\n03/04/2026 10:00:00;1;2\n03/05/2026 10:00:00;1;2\n",
            "time",
            "the day or the month first.*--time-format '%d/%m/%Y %H:%M:%S' or --time-format '%m/%d/%Y %H:%M:%S'",
            {"time_format": "%d/%m/%Y %H:%M:%S"},
        ),
        ("time [s],speed,F [N]\n0,1,2\n1,1,2\n", "shaft_speed", "'speed' has no unit.*--unit shaft_speed=rpm", {"units": {"shaft_speed": "rpm"}}),
        (
            "t [s],rotor speed [rpm],generator speed [rpm],F [N]\n0,1,2,3\n1,1,2,3\n",
            "shaft_speed",
            "2 headings fit; choose: --column shaft_speed='rotor speed .rpm.' or --column shaft_speed='generator",
            {"columns": {"shaft_speed": "generator speed [rpm]"}},
        ),
        (
            "t [s],n [rpm]\n0,1\n1,1\n",
            "radial_load",
            "--column radial_load=HEADING, or give --load 800N",
            {"constants": {"radial_load": {"law": "constant", "value": "800 N"}}},
        ),
        (
            "t [s];n [%];F [N]\n0;98.3;2\n1;98.4;2\n",
            "shaft_speed",
            "the speed at 100 %: --unit shaft_speed='% of 1500 rpm'$",
            {"units": {"shaft_speed": "% of 3000rpm"}},
        ),
        (
            "t [s];n [rpm];Last_pct\n0;98;2\n1;98;2\n",
            "radial_load",
            "the force at 100 %: --unit radial_load='% of 5 kN'$",
            {"units": {"radial_load": "% of 2 kN"}},
        ),
        ("t [s];n [rpm];F [N]\n0;1,500;2\n1;1,500;2\n", "decimal", "line 2: n .rpm. = '1,500'.*--decimal", {"decimal": ","}),
        (
            "id,t [s],n [rpm],F [N]\nA,0,1,2\nA,1,1,2\nB,0,1,2\nB,1,1,2\n",
            "only",
            "times go back in line 4.*--only id=A or --only id=B",
            {"only": {"id": "A"}},
        ),
        ("t [s],n [rpm],n [rpm],F [N]\n0,1,2,3\n1,1,2,3\n", "shaft_speed", "2 columns are called 'n .rpm.'; rename", None),
        ("t;n [rpm];F [N]\n46204.1;1;2\n46204.2;1;2\n", "time", "days of a spreadsheet.*--unit time=day", {"units": {"time": "day"}}),
    ],
)
def test_what_may_mean_two_things_is_asked_for_and_the_option_that_is_named_decides(tmp_path, text, field, words, decided):
    found = guessed(tmp_path, text)
    assert list(found.questions) == [field]
    import re

    assert re.search(words, found.questions[field]), found.questions[field]
    assert f"# {field}: TO DECIDE" in found.text
    if decided is None:
        return
    decision = guessed(tmp_path, text, **decided)
    assert not decision.questions
    assert read_table(tmp_path / "data.csv", mapping_from_yaml(decision.text)).tally.there == 2


def test_a_temperature_that_is_a_percentage_is_asked_for(tmp_path):
    found = guessed(tmp_path, "t [s];n [rpm];F [N];Oil [%]\n0;1;2;3\n1;1;2;3\n", columns={"oil_temperature": "Oil [%]"})
    assert found.questions == {
        "oil_temperature": "'Oil [%]' is a percentage, which no temperature is; name another column: --column oil_temperature=HEADING"
    }


@pytest.mark.parametrize(
    "date, format_",
    [
        ("13/04/2026 10:00:00", "%d/%m/%Y %H:%M:%S"),
        ("04/13/2026 10:00", "%m/%d/%Y %H:%M"),
        ("13.04.2026 10:00:00,5", "%d.%m.%Y %H:%M:%S,%f"),
        ("13.4.26 9:00:00", "%d.%m.%y %H:%M:%S"),
        ("2026/04/13 10:00:00", "%Y/%m/%d %H:%M:%S"),
        ("2026-04-13 10:00:00.250", "iso"),
        ("20260413T100000Z", "iso"),
        ("04/13/2026 10:00:00 PM", "%m/%d/%Y %I:%M:%S %p"),
    ],
)
def test_dates_that_can_be_read_one_way_only_are_understood(tmp_path, date, format_):
    found = guessed(tmp_path, f"Date;n [rpm];F [N]\n{date};1;2\n", delimiter=";", decimal=".")
    assert found.tree["time"]["format"] == format_


@pytest.mark.parametrize("text, words", [("1;2;3\n4;5;6\n", "no header"), ("just words\nand more\n", "no table"), ("", "no table")])
def test_a_file_without_a_table_or_a_header_is_refused(tmp_path, text, words):
    with pytest.raises(TableError, match=words):
        guessed(tmp_path, text)


def test_the_command_prints_and_writes_the_guess_and_fails_where_something_is_to_decide(tmp_path):
    def command(*arguments):
        return CliRunner().invoke(main, ["import-csv", "--guess", *map(str, arguments)])

    data, out = tmp_path / "data.csv", tmp_path / "rig.yaml"
    data.write_text(ENGLISH, encoding="utf-8")
    done = command(data, "-o", out)
    assert done.exit_code == 0 and out.read_text(encoding="utf-8") == done.stdout and "import-csv" in done.stderr
    assert json.loads(command(data, "--json").stdout)["mapping"]["shaft_speed"] == {"column": "Speed [rpm]", "unit": "rpm"}
    data.write_text(ENGLISH.replace("Load (kN)", "Torque"), encoding="utf-8")
    done = command(data, "-o", out, "--force")
    assert done.exit_code == 1 and "radial_load" in done.stderr and "TO DECIDE" in out.read_text(encoding="utf-8")
    for options, words in (
        (("-o", tmp_path / "rig.mcap"), "ends in .yaml"),
        (("--column", "speed=x"), "no field 'speed' (did you mean 'cage_speed'?); expected one of time, shaft_speed"),
        (("--column", "shaft_speed=Sped [rpm]"), "no such heading (did you mean 'Speed [rpm]'?)"),
        (("citation_flight",), "give none"),
    ):
        refused = command(data, *options)
        assert refused.exit_code == 2 and words in refused.stderr


def test_of_two_turbines_in_one_table_one_has_to_be_chosen():
    path = measured_file("wind_scada_HMR_july2023.csv")
    found = guess(path)
    assert found.tree["shaft_speed"] == {"column": "GenRpmMean", "unit": "rpm"} and found.tree["time"]["format"] == "iso"
    assert "--only TurbineName=HMR_T01" in found.questions["only"] and "gear_force" in found.questions["radial_load"]
