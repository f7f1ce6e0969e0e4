# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about workbooks: a sheet is read as the CSV table that it stands for, one of several is asked for, and a damaged workbook is refused."""

import json
import zipfile
from datetime import datetime, time, timedelta

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.inputs import workbook
from bearing_sim.inputs.csv_guess import guess
from bearing_sim.inputs.csv_import import TableError, mapping_from_yaml, read_table

openpyxl = pytest.importorskip("openpyxl")


def write_workbook(path, **sheets):
    """Write rows by the name of their sheet."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


NOON = datetime(2026, 3, 19, 12)
ROWS = [["Zeit", "Drehzahl [U/min]", "Last [kN]", "Bemerkung"]] + [[NOON + timedelta(seconds=k), 1480.5 + k, 5.25, "ein, zwei"] for k in range(5)]


def test_a_sheet_with_dates_is_guessed_and_imported_with_its_rows_as_lines(tmp_path):
    path = write_workbook(tmp_path / "rig.xlsx", Messung=ROWS[:3] + [[None, "n/a", 5.0]] + ROWS[3:])
    found = guess(path)
    assert not found.questions and found.tree["time"]["format"] == "iso" and "encoding" not in found.tree
    table = read_table(path, mapping_from_yaml(found.text))
    assert table.examples["time.empty_cell"][0][0] == 4 and table.tally.used == 5
    assert list(table.values["radial_load"]) == [5250.0] * 5
    assert table.stamps["shaft_speed"][0] == 1773921600_000_000_000


def test_a_date_and_a_time_of_day_in_two_columns_are_one_time(tmp_path):
    rows = [["Datum", "Uhrzeit", "n [rpm]", "F [N]"]] + [[NOON.date(), time(12, 0, k, 500_000 * (k % 2)), 1480, 5] for k in range(4)]
    path = write_workbook(tmp_path / "rig.xlsx", s=rows)
    found = guess(path)
    assert not found.questions and found.tree["time"] == {"column": "Datum", "time_of_day": "Uhrzeit", "format": "iso"}
    stamps = read_table(path, mapping_from_yaml(found.text)).stamps["shaft_speed"]
    assert [stamp - 1773921600_000_000_000 for stamp in stamps] == [0, 1_500_000_000, 2_000_000_000, 3_500_000_000]


def test_times_that_begin_at_midnight_durations_and_headings_of_two_lines_are_understood(tmp_path):
    midnight = datetime(2026, 3, 19)
    rows = [["Zeit", "t\n[s]", "n [rpm]", "F\n[N]"]] + [[midnight + timedelta(hours=k), timedelta(minutes=k), 1480, 5] for k in range(3)]
    path = write_workbook(tmp_path / "rig.xlsx", s=rows)
    found = guess(path, columns={"time": "Zeit"})
    assert list(read_table(path, mapping_from_yaml(found.text)).stamps["shaft_speed"]) == [(1773878400 + 3600 * k) * 10**9 for k in range(3)]
    found = guess(path, columns={"time": "t [s]"})
    assert list(read_table(path, mapping_from_yaml(found.text)).stamps["shaft_speed"]) == [60 * k * 10**9 for k in range(3)]


def test_serial_days_that_are_not_shown_as_dates_are_days_of_a_spreadsheet(tmp_path):
    path = write_workbook(tmp_path / "rig.xlsx", s=[["t", "n [rpm]", "F [N]"]] + [[46100.5 + k / 86400, 1480.5, 5.0] for k in range(4)])
    found = guess(path)
    assert found.tree["time"] == {"column": "t", "unit": "day", "epoch": "1899-12-30"}
    assert read_table(path, mapping_from_yaml(found.text)).stamps["shaft_speed"][0] == 1773921600_000_000_000  # day 46100.5 is that noon


def test_separators_of_thousands_in_cells_of_text_are_understood(tmp_path):
    path = write_workbook(tmp_path / "rig.xlsx", s=[["t [s]", "n [rpm]", "F [N]"]] + [["0,1", "1.480,5", "5.000,0"], ["0,2", "1.481,5", "5.010,0"]])
    found = guess(path)
    assert (found.tree["decimal"], found.tree["thousands"]) == (",", ".")
    assert list(read_table(path, mapping_from_yaml(found.text)).values["radial_load"]) == [5000.0, 5010.0]


def test_of_several_sheets_one_has_to_be_named_and_an_unknown_one_is_refused(tmp_path):
    path = write_workbook(tmp_path / "rig.xlsx", Info=[["made by", "x"]], Messung=ROWS)
    with pytest.raises(TableError, match="it has the sheets Info, Messung; say which: sheet: NAME in the mapping, or --sheet"):
        guess(path)
    with pytest.raises(TableError, match="no sheet 'Mesung' .did you mean 'Messung'.*; it has Info, Messung"):
        guess(path, sheet="Mesung")
    done = CliRunner().invoke(main, ["import-csv", "--guess", str(path), "--sheet", "Messung", "-o", str(tmp_path / "m.yaml")])
    assert done.exit_code == 0, done.output
    assert "sheet: Messung" in (tmp_path / "m.yaml").read_text()
    done = CliRunner().invoke(main, ["import-csv", str(path), str(tmp_path / "m.yaml"), "-o", str(tmp_path / "m.mcap"), "--json"])
    assert done.exit_code == 0 and json.loads(done.output)["messages"]["shaft_speed"] == 5


def test_a_sheet_is_only_of_a_workbook(tmp_path):
    (tmp_path / "a.csv").write_text("t [s],n [rpm],F [N]\n0,1,2\n1,1,2\n")
    with pytest.raises(TableError, match="sheet 'x': it is no workbook"):
        guess(tmp_path / "a.csv", sheet="x")


@pytest.mark.parametrize("place", [30, 0.2, 0.5, 0.8, -60])
def test_a_damaged_or_cut_workbook_is_refused_or_read_as_before(tmp_path, place):
    data = bytearray(write_workbook(tmp_path / "rig.xlsx", s=ROWS).read_bytes())
    good = guess(tmp_path / "rig.xlsx").text
    at = int(place * len(data)) if isinstance(place, float) else place
    data[at] ^= 0x55
    (tmp_path / "rig.xlsx").write_bytes(data)
    try:
        assert guess(tmp_path / "rig.xlsx").text == good
    except TableError as error:
        assert str(tmp_path / "rig.xlsx") in str(error)
    (tmp_path / "rig.xlsx").write_bytes(bytes(data[: len(data) // 2]))
    with pytest.raises(TableError, match="cannot be read as a workbook .BadZipFile"):
        guess(tmp_path / "rig.xlsx")


def rewritten(path, old, new, checksum=True):
    """Replace a text in the first sheet of a workbook, with the checksum of what was there unless that is to be right."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    sheet = parts["xl/worksheets/sheet1.xml"]
    assert old in sheet
    with zipfile.ZipFile(path, "w") as archive:  # not compressed
        for name, data in parts.items():
            archive.writestr(name, data.replace(old, new) if data is sheet and checksum else data)
    if not checksum:
        path.write_bytes(path.read_bytes().replace(old, new))


def test_a_number_that_does_not_fit_the_checksum_is_not_read(tmp_path):
    path = write_workbook(tmp_path / "rig.xlsx", s=ROWS)
    rewritten(path, b"<v>1482.5</v>", b"<v>9482.5</v>", checksum=False)
    with pytest.raises(TableError, match="damaged: the checksum of its part 'xl/worksheets/sheet1.xml' is wrong"):
        guess(path)


def test_a_sheet_may_state_another_size_than_it_has_but_no_row_that_sheets_cannot_have(tmp_path, monkeypatch):
    path = write_workbook(tmp_path / "rig.xlsx", s=ROWS)
    good = guess(path).text
    rewritten(path, b'<dimension ref="A1:D6"', b'<dimension ref="A1:B2"')
    assert guess(path).text == good
    monkeypatch.setattr(workbook, "_MOST_ROWS", 1000)
    rewritten(path, b'<row r="6"', b'<row r="9999999"')
    with pytest.raises(TableError, match="row 1001: no sheet has more than 1,000 rows"):
        guess(path)


def test_a_workbook_with_a_password_and_another_archive_are_refused_with_what_to_do(tmp_path):
    (tmp_path / "secret.xlsx").write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(1000))
    with pytest.raises(TableError, match="one with a password; save the sheet as CSV"):
        guess(tmp_path / "secret.xlsx")
    with zipfile.ZipFile(tmp_path / "other.xlsx", "w") as archive:
        archive.writestr("a.txt", "no sheet")
    with pytest.raises(TableError, match="cannot be read as a workbook .*save the sheet as CSV"):
        guess(tmp_path / "other.xlsx")


def test_a_workbook_that_unpacks_to_more_than_the_limit_or_has_a_row_too_wide_is_refused(tmp_path, monkeypatch):
    path = write_workbook(tmp_path / "rig.xlsx", s=ROWS)
    monkeypatch.setenv("BEARING_SIM_LIMITS", "workbook_bytes=1000")
    with pytest.raises(TableError, match="more than the limit of 1,000 for a workbook, unpacked.*workbook_bytes=NUMBER"):
        guess(path)
    monkeypatch.setenv("BEARING_SIM_LIMITS", "table_columns=3")
    with pytest.raises(TableError, match="row 1: 4 columns"):
        guess(path)
