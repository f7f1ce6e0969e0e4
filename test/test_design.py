# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The design: its borders are where single runs begin to break a limit, tolerances shrink its region, and what bounds it is reported."""

import io
import json

import matplotlib.text
import numpy as np
import pytest
from click.testing import CliRunner
from deng2017.design import radii_within

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.studies import design as studied
from bearing_sim.studies.design import D_VALUE, END_OF_MAP, LOW, NOMINAL, WORST, Border, Limits, default_axes, design, read_design
from bearing_sim.sweep.conditions import Conditions
from bearing_sim.sweep.grid import read_axis
from bearing_sim.sweep.pictures import new_figure
from bearing_sim.sweep.table import read_table
from bearing_sim.sweep.tasks import Execution, Journal

LIMITS = Limits(10.0, 300.0, Conditions(0.02, 0.1))


def found(radii="34.86mm:34.8675mm:6", d_values="0.095mm,0.105mm", limits=LIMITS, overrides=("level=steady",)):
    axes = read_axis(f"{LOW}={radii}"), read_axis(f"{D_VALUE}={d_values}")
    with Journal() as journal:
        return design("deng2017_table1", overrides, limits, *axes, 0.5, Execution(journal, 1))


@pytest.fixture(scope="module")
def designed():
    return found()


def single_run(low, d_value, level, speed=1.0, load=1.0):
    """Return slip [%] and life [h] of a run at a share of speed and load, computed here."""
    words = [f"level={level}", f"{LOW}={low!r}mm", f"{D_VALUE}={d_value}mm"]
    words += [f"operating.shaft_speed={45000 * speed!r}rpm", f"operating.radial_load={800 * load!r}"]
    run = Simulation(load_scene("deng2017_table1", words))
    run.advance(0.5)
    block = run.advance(0.1, samples=100)
    return 100 * block["cage_slip"].mean(), block["rating_life"].mean()


def border_of(designed, kind, d_value):
    (border,) = [each for each in designed.borders if (each.kind, each.d_value) == (kind, d_value)]
    return border


@pytest.mark.long
@pytest.mark.parametrize("d_value", [0.095, 0.105])
def test_single_runs_at_level_slip_break_the_limits_just_outside_the_border_and_keep_them_inside(designed, d_value):
    border = border_of(designed, NOMINAL, d_value)
    assert (border.below_by, border.above_by) == ("life", "slip")
    apart = 8e-5  # mm, some 0.2 points of slip: levels steady and slip may differ by half of that
    assert single_run(border.low_from - apart, d_value, "slip")[1] < 300 < single_run(border.low_from + apart, d_value, "slip")[1]
    assert single_run(border.low_to - apart, d_value, "slip")[0] < 10 < single_run(border.low_to + apart, d_value, "slip")[0]


def test_at_the_border_with_tolerances_the_worst_of_the_corners_is_at_the_limit(designed):
    border = border_of(designed, WORST, 0.105)
    corners = [(1 + a * 0.02, 1 + b * 0.1) for a in (-1, 0, 1) for b in (-1, 0, 1)]
    lives = [single_run(border.low_from, 0.105, "steady", *corner)[1] for corner in corners]
    slips = [single_run(border.low_to, 0.105, "steady", *corner)[0] for corner in corners]
    assert min(lives) == pytest.approx(300, rel=5e-3) and max(slips) == pytest.approx(10, rel=5e-3)
    assert np.argmin(lives) == 8 and np.argmax(slips) == 6  # fast and heavy for the life, fast and light for the slip


def test_tolerances_shrink_the_region_and_none_leave_it_as_it_is(designed):
    for d_value in (0.095, 0.105):
        whole, kept = (border_of(designed, kind, d_value) for kind in (NOMINAL, WORST))
        assert whole.low_from < kept.low_from < kept.low_to < whole.low_to
    exact = found(limits=Limits(10.0, 300.0))
    for d_value in (0.095, 0.105):
        nominal, worst = (border_of(exact, kind, d_value) for kind in (NOMINAL, WORST))
        assert nominal[2:] == worst[2:]
        assert (
            nominal[2:] == pytest.approx(border_of(designed, NOMINAL, d_value)[2:], abs=1e-6)
            or nominal[2:] == border_of(designed, NOMINAL, d_value)[2:]
        )


def test_the_map_says_of_every_raceway_whether_it_meets_the_limits(designed):
    assert len(designed.grid.rows) == 12
    for row in designed.grid.rows:
        assert row["meets_nominal"] == (row["nominal_slip"] < 10 and row["nominal_life"] > 300)
        assert row["worst_slip"] >= row["nominal_slip"] and row["worst_life"] <= row["nominal_life"]
        border = border_of(designed, NOMINAL, row[D_VALUE])
        assert row["meets_nominal"] == (border.low_from <= row[LOW] <= border.low_to)


@pytest.mark.long
def test_borders_do_not_hang_on_the_grid_they_were_found_from(designed):
    coarse = found(radii="34.859mm:34.868mm:4", d_values="0.105mm")
    for kind in (NOMINAL, WORST):
        assert border_of(coarse, kind, 0.105)[2:4] == pytest.approx(border_of(designed, kind, 0.105)[2:4], abs=5e-5)


@pytest.mark.long
def test_a_region_thinner_than_the_steps_of_the_grid_is_found():
    coarse = found(radii="34.86mm:34.868mm:2", d_values="0.105mm")
    fine = found(radii="34.861mm:34.865mm:9", d_values="0.105mm")
    assert not any(row["meets_nominal"] for row in coarse.grid.rows)
    for kind in (NOMINAL, WORST):
        assert border_of(coarse, kind, 0.105)[2:4] == pytest.approx(border_of(fine, kind, 0.105)[2:4], abs=5e-5)


def test_a_region_that_goes_on_beyond_the_range_says_so_and_raceways_that_cannot_be_end_it():
    inside = found(radii="34.863mm:34.864mm:2", d_values="0.1mm")
    assert {(each.below_by, each.above_by) for each in inside.borders} == {(END_OF_MAP, END_OF_MAP)}
    assert "R_low = 34.86300 and 34.86400 mm, where raceways meet both limits: the region continues beyond it" in inside.open_ends(NOMINAL)
    refused = found(radii="34.7mm,34.863mm", d_values="0.1mm")
    assert [row["status"] for row in refused.grid.rows] == ["refused", "ok"]
    assert border_of(refused, NOMINAL, 0.1).below_by in ("life", "no result")


def test_limits_that_nothing_meets_leave_no_border():
    assert found(radii="34.862mm:34.864mm:2", d_values="0.1mm", limits=Limits(1.0, 1e6)).borders == []


def test_the_default_range_is_about_the_scene():
    radii, d_values = default_axes(load_scene("deng2017_table1"))
    assert radii.shown[0] == 34.86 and radii.shown[-1] == 34.8675 and 34.8625 in radii.shown
    assert d_values.shown[0] == pytest.approx(0.0784) and d_values.shown[-1] == pytest.approx(0.1176)


WORDS = ["design", "deng2017_table1", "--slip-below", "10%", "--life-above", "300h", "--low-radius", "34.86mm:34.866mm:4", "--workers", "1"]


@pytest.mark.long
def test_command_writes_tables_and_picture_and_computes_nothing_twice(tmp_path):
    words = [
        *WORDS,
        "--d-value",
        "0.095mm:0.105mm:2",
        "-o",
        str(tmp_path / "d.parquet"),
        "--picture",
        str(tmp_path / "d.png"),
        "--verify-level",
        "slip",
    ]
    reported = CliRunner().invoke(main, words, catch_exceptions=False)
    assert reported.exit_code == 0 and "life, slip" in reported.output
    entries = (tmp_path / "d.journal").read_text().count("\n")
    report = json.loads(CliRunner().invoke(main, [*words, "--json", "--force"]).stdout)  # for the picture, which is drawn again
    assert (tmp_path / "d.journal").read_text().count("\n") == entries
    within = within_the_papers_d_values(tmp_path / "d.parquet")
    assert report["verify_level"] == "slip" and "pocket play" in reported.stderr
    assert 34.861 < within.low_from < 34.8625 < within.low_to < 34.8655
    assert len(read_table(tmp_path / "d.parquet").rows) == 8
    borders = read_table(tmp_path / "d_borders.parquet")
    assert borders.column("low_radius_from").unit == "mm" and len(borders.rows) == 4
    assert (tmp_path / "d.png").stat().st_size > 20_000


def within_the_papers_d_values(path):
    designed = read_design(path)
    return radii_within([border for border in designed.borders if border.kind == NOMINAL], designed.grid.values(D_VALUE))


EXACT = ["--speed-tolerance", "0", "--load-tolerance", "0", "--verify-level", "none"]


@pytest.mark.long
def test_what_stands_beside_the_paper_spans_its_d_values_whatever_the_grid(tmp_path):
    def within(d_values):
        words = [*WORDS, "--d-value", d_values, "-o", str(tmp_path / "w.parquet"), *EXACT, "--json", "--force"]
        assert CliRunner().invoke(main, words, catch_exceptions=False).exit_code == 0
        return within_the_papers_d_values(tmp_path / "w.parquet")

    ours, other = within("0.095mm:0.105mm:2"), within("0.09mm:0.11mm:2")
    assert other[:2] == pytest.approx(ours[:2], abs=1e-4)
    short = within("0.098mm:0.102mm:2")
    assert short.low_from is None and "the map ends at D = 0.0980 and 0.1020 mm: the limit may lie beyond it" in short.text


def interval(d_value, low, high, below_by="life", above_by="slip"):
    return Border(WORST, d_value, low, high, below_by, above_by)


def test_radii_for_all_d_values_say_why_there_are_none_and_where_the_map_ends_before_the_limit():
    def within(*borders):
        return radii_within(borders, [0.095, 0.1, 0.105])

    whole = within(interval(0.095, 1.0, 4.0), interval(0.1, 2.0, 4.0), interval(0.105, 1.0, 3.0))
    assert (whole.low_from, whole.low_to) == (2.0, 3.0) and "beyond" not in whole.text
    gap = within(interval(0.095, 1.0, 4.0), interval(0.105, 1.0, 4.0))
    assert gap.low_from is None and "no raceway meets both limits at D = 0.1000 mm" in gap.text
    ended = within(interval(0.095, 3.0, 4.0), interval(0.1, 2.0, 4.0), interval(0.105, 1.0, 2.5, above_by=END_OF_MAP))
    assert ended.low_from is None and "none in the map; the map ends at R_low = 2.50000 mm" in ended.text and "the limit lies beyond it" in ended.text
    other_end = within(interval(0.095, 1.0, 2.0), interval(0.1, 1.0, 3.0), interval(0.105, 1.0, 4.0, above_by=END_OF_MAP))
    assert other_end.low_to == 2.0 and "beyond" not in other_end.text


def words_in(monkeypatch, designed):
    """Return all texts of the picture of a design."""
    figures = []
    monkeypatch.setattr(studied, "new_figure", lambda *size: figures.append(new_figure(*size)) or figures[-1])
    studied.plot_design(io.BytesIO(), designed)
    texts = [text.get_text().replace("\n", " ") for text in figures[0].findobj(matplotlib.text.Text)]
    return " | ".join(text for text in texts if text)


def test_the_picture_names_the_region_of_the_worst_case_or_says_that_there_is_none_and_from_which_start_its_states_are(designed, monkeypatch):
    shown = words_in(monkeypatch, designed)
    assert "in the worst case of speed ±2 %, load ±10 %: meets both limits at steady" in shown
    assert "at nominal speed and load: meets both limits at steady" in shown and "no raceway" not in shown
    assert "from ideal rolling" in shown
    nominal_only = designed._replace(bands=[band for band in designed.bands if band.found.kind == NOMINAL])
    shown = words_in(monkeypatch, nominal_only)
    assert "in the worst case of speed ±2 %, load ±10 %: no raceway of the map meets both limits at steady" in shown
    assert "in the worst case of speed ±2 %, load ±10 %: meets both" not in shown


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--set", "bearing.outer_raceway.d_value=0"], "is round"),
        (["--set", "operating.shaft_speed=0"], "there is no slip at rest"),
        (["--speed-tolerance", "80%"], "--speed-tolerance 80%"),
        (["--slip-below", "10 N"], "wrong dimension"),
        (["--d-value", "0.1"], "d_value"),
    ],
)
def test_command_refuses_what_it_cannot_mean(tmp_path, words, reported):
    result = CliRunner().invoke(main, [*WORDS, *words, "-o", str(tmp_path / "d.parquet")])
    assert result.exit_code == 2 and reported in result.output
