# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How numbers and tables are shown to people."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim.cli import reporting
from bearing_sim.cli.reporting import print_rows
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.scene.display import force, heading, hours, larger_unit, number, power, quantity_text, with_sign


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (43230.4, 4, "43,230"),
        (1e5, 4, "100,000"),
        (0.2521, 4, "0.2521"),
        (0.00012345, 3, "0.000123"),
        (16728.8, 4, "16,730"),
        (-0.0, 4, "0"),
        (999.96, 4, "1,000"),
        (2.5, 4, "2.5"),
        (math.nan, 4, "–"),
        (math.inf, 4, "infinite"),
    ],
)
def test_numbers_are_written_as_people_write_them(value, digits, text):
    assert number(value, digits) == text


@given(st.floats(1e-4, 1e11) | st.floats(-1e11, -1e-4), st.integers(2, 7))
def test_a_number_reads_back_to_its_digits_and_has_no_exponent(value, digits):
    text = number(value, digits)
    assert "e" not in text and float(text.replace(",", "")) == pytest.approx(value, rel=0.5 * 10 ** (1 - digits) * 1.0001)


def test_forces_and_powers_take_the_larger_unit_where_they_are_large():
    assert [force(each) for each in (800.0, 999.9, 1000.0, 100_000.0, -5000.0)] == ["800 N", "999.9 N", "1 kN", "100 kN", "-5 kN"]
    assert [power(each) for each in (3779.0, 12_500.0)] == ["3,779 W", "12.5 kW"]
    assert larger_unit("N", [10.0, math.nan, 2000.0]) == ("kN", 1e3) and larger_unit("N", []) == ("N", 1.0) == larger_unit("N", [999.0])


def test_a_life_that_nothing_limits_is_no_figure():
    assert hours(43_230.0) == "43,230 h" and hours(2e81) == "above 1,000,000,000 h"
    assert hours(math.inf) == "infinite" and hours(math.nan) == "unknown"


def test_quantities_have_the_units_that_people_read():
    assert quantity_text("cage_slip", 0.0625) == "6.25 %" and quantity_text("oil_temperature", 333.35) == "60.2 °C"
    assert quantity_text("shaft_speed", 100 * math.pi) == "3,000 rpm" and quantity_text("running_clearance", -2.5e-5) == "-25 µm"
    assert heading("bearing.outer_raceway.low_radius", "mm") == "low-point radius R_low [mm]" and heading("clearance", "um").endswith("[µm]")
    assert with_sign(5.0) == "+5" and with_sign(0.0) == "0" and with_sign(-3.0) == "-3"


def test_every_observable_of_one_number_has_words_without_underscores():
    for each in OBSERVABLES:
        assert "_" not in heading(each.name).split("[")[0].replace("R_low", "").replace("_", " " if each.per_roller else "_") or any(
            symbol in heading(each.name) for symbol in ("L_n", "a_ISO", "P_ref", "e_C", "S_0")
        )


COLUMNS = ["shaft speed [rpm]", "radial load [kN]", *(f"quantity number {k} [N]" for k in range(14)), "why"]


@pytest.mark.parametrize("width", [40, 80, 140])
def test_a_table_keeps_every_digit_at_any_width(width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    rows = [[f"{n},000", f"{n}.5", *(f"{1234567 + 1111 * k * n:,}" for k in range(14)), "a reason in words that may be broken"] for n in (1, 2)]
    print_rows("a wide table", COLUMNS, rows, words=("why",), keys=2)
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= width
    for row in rows:
        assert all(text in printed for text in row[:-1])
    parts = printed.count("a wide table")
    assert printed.count("1,000") >= parts and (parts > 1) == (width < 200)


VALUES = {"life": " ".join(f"{1000 + k:,} h" for k in range(60)), "bearing": "NU 210/C3", "a name as long as that of a file": "x" * 45}


@pytest.mark.parametrize("width", [40, 80, 140])
def test_names_and_values_are_broken_between_words_and_keep_every_one(width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    reporting.print_groups("a sheet", [[("life", VALUES["life"])], [], [("bearing", VALUES["bearing"])]])
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= width
    assert all(word in printed.split() for name in ("life", "bearing") for word in VALUES[name].split())
    assert printed.index("life") < printed.index("├") < printed.index("bearing"), "a line stands between groups"


TITLE = "a table whose title is longer than its columns are wide together, so that it is broken, too"
ROWS = [["1,000", "0.5", "a reason in words, µm [N], that may be broken"], ["20", "-1.25", ""]]


@pytest.mark.parametrize("width", [51, 61, 80, 140])
def test_tables_are_those_that_rich_draws(width, monkeypatch, capsys):
    table = pytest.importorskip("rich.table")
    console = pytest.importorskip("rich.console").Console(width=width, markup=False, emoji=False, highlight=False)
    monkeypatch.setenv("COLUMNS", str(width))

    def drawn():
        return [line.rstrip() for line in capsys.readouterr().out.splitlines()]

    groups = [list(VALUES.items()), [("bearing", "")]]
    reporting.print_groups("a sheet", groups)
    own, theirs = drawn(), table.Table(*(table.Column(overflow="fold") for _ in range(2)), title="a sheet", show_header=False, title_justify="left")
    for group in groups:
        for row in group:
            theirs.add_row(*row)
        theirs.add_section()
    console.print(theirs)
    assert own == drawn()
    print_rows(TITLE, ["n", "longer [kN]", "why"], ROWS, words=("why",))
    own = drawn()
    widths = [len(border) - 2 for border in next(line for line in own if line.startswith("┏"))[1:-1].split("┳")]
    alignments = zip(("n", "longer [kN]", "why"), ("right", "right", "left"), widths)
    columns = [table.Column(name, justify=side, width=wide, overflow="fold") for name, side, wide in alignments]
    theirs = table.Table(*columns, title=TITLE, title_justify="left")
    for row in ROWS:
        theirs.add_row(*row)
    console.print(theirs)
    assert own == drawn()
