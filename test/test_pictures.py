# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about maps and lines of tables: what they show lies within the data, scales suit it, and numbers are written as people write them."""

import itertools
import math

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.colors import LogNorm, to_rgb

from bearing_sim.cli.main import main
from bearing_sim.scene.loader import load_bearing
from bearing_sim.studies.bearing_facts import plot_bearing
from bearing_sim.studies.uncertainty_propagation import Indices
from bearing_sim.sweep import pictures
from bearing_sim.sweep.pictures import as_shown, draw_map, is_spaced_logarithmically, new_figure, plot_table, ticks, value_text
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, life_column

LOAD, SPEED = "operating.radial_load", "operating.shaft_speed"
LOADS = {"even": np.linspace(100.0, 20_000.0, 8), "logarithmic": np.geomspace(100.0, 20_000.0, 8)}
SPEEDS = np.linspace(100.0, 9000.0, 6)


def mapped(name, unit, field, loads=LOADS["even"], **look):
    """Return the axes, the cells and the colour bar of a map over load and speed."""
    axes = new_figure(6.0, 5.0).add_subplot()
    draw_map(axes, as_shown(LOAD, "N", loads), as_shown(SPEED, "rpm", SPEEDS), as_shown(name, unit, field), **look)
    axes.figure.draw_without_rendering()
    return axes, axes.collections[0], axes.collections[0].colorbar


def life(loads):
    """L10 = 1e6/(60 n) (C/P)^(10/3) of a bearing with C = 65 kN, at each speed and load [h]."""
    return 1e6 / 60.0 / SPEEDS[:, None] * (65_000.0 / loads) ** (10.0 / 3.0)


@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS)
def test_no_cell_of_a_map_reaches_beyond_its_data_and_each_value_lies_in_its_own_cell(loads):
    axes, mesh, _ = mapped("rating_life", "h", life(loads), loads)
    across, up = mesh.get_coordinates()[0, :, 0], mesh.get_coordinates()[:, 0, 1]
    assert (across[0], across[-1]) == (0.1, 20.0) and (up[0], up[-1]) == (100.0, 9000.0) and across.min() > 0.0
    assert np.all((across[:-1] <= loads / 1e3) & (loads / 1e3 <= across[1:])) and np.all((up[:-1] <= SPEEDS) & (SPEEDS <= up[1:]))
    assert axes.get_xlim() == (0.1, 20.0) and axes.get_ylim() == (100.0, 9000.0)
    np.testing.assert_allclose(mesh.get_array(), np.clip(life(loads), life(loads).min(), 1e6 * life(loads).min()))


def test_an_axis_is_logarithmic_where_the_values_were_chosen_so():
    assert mapped("rating_life", "h", life(LOADS["even"]))[0].get_xscale() == "linear"
    assert mapped("rating_life", "h", life(LOADS["logarithmic"]), LOADS["logarithmic"])[0].get_xscale() == "log"
    assert is_spaced_logarithmically([1, 2, 5, 10, 20, 50]) and is_spaced_logarithmically([1e-3, 1.0, 1e3])
    for values in ([1, 4, 7, 10], np.linspace(1, 1000, 5), [0, 1, 10, 100], [-10, 1, 10], [1, 2, 4], [1, 100]):
        assert not is_spaced_logarithmically(values)


@pytest.mark.parametrize("name, unit", [("rating_life", "h"), ("modified_rating_life", "h"), ("cage_slip", "%")])
def test_colours_of_lives_and_slip_are_logarithmic_over_six_decades_at_most(name, unit):
    rows = np.geomspace(1e-4, 90.0, 48).reshape(6, 8) if unit == "%" else np.geomspace(30.0, 1e11, 48).reshape(6, 8)
    _, mesh, bar = mapped(name, unit, rows)
    assert isinstance(mesh.norm, LogNorm) and mesh.norm.vmax / mesh.norm.vmin <= 1.0001e6
    assert mesh.norm.vmax == 90.0 if unit == "%" else mesh.norm.vmin == 30.0, "the least life and the largest slip are of interest"
    labels = [text.get_text() for text in bar.ax.get_yticklabels()]
    assert all(digit not in label for label in labels for digit in "e^$") and len(labels) >= 3
    assert {"1", "10"} <= set(labels) if unit == "%" else {"1,000", "10,000"} <= set(labels)
    assert not isinstance(mapped("inner_load_maximum", "N", rows)[1].norm, LogNorm)


def luminance(colour):
    """Return the relative luminance of WCAG 2.1."""
    return np.dot([0.2126, 0.7152, 0.0722], [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)])


@pytest.mark.parametrize("name, unit", [("rating_life", "h"), ("cage_slip", "%"), ("inner_load_maximum", "N")])
def test_contours_are_seen_on_every_colour(name, unit):
    """Line or halo has a contrast of 3 or more, as WCAG 2.1 asks of graphics; a white line alone has 1.2 on yellow."""
    axes, mesh, _ = mapped(name, unit, life(LOADS["even"]) if unit != "N" else 0.3 * LOADS["even"] + 0.0 * SPEEDS[:, None])
    contours = axes.collections[1]
    halo = contours.get_path_effects()[0]._gc["foreground"]
    inks = [luminance(each) for each in (contours.get_edgecolor()[0][:3], halo)]
    for colour in mesh.cmap(np.linspace(0.0, 1.0, 50))[:, :3]:
        contrasts = [(max(ink, luminance(colour)) + 0.05) / (min(ink, luminance(colour)) + 0.05) for ink in inks]
        assert max(contrasts) >= 3.0
    texts = [text.get_text() for text in axes.texts if text.get_visible()]
    assert texts and all("e" not in text for text in texts)


def test_cells_without_a_result_are_grey_and_named_and_a_life_without_load_is_a_result(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(pictures, "new_figure", lambda *size: figures.append(new_figure(*size)) or figures[-1])
    complete, holed = swept(), swept()
    holed.rows[5] |= {"status": "failed", "reason": "no", "rating_life": math.nan, "modified_rating_life": math.nan, "cage_slip": math.nan}
    complete.rows[7] |= {"rating_life": math.inf, "modified_rating_life": math.inf}
    for table in (complete, holed):
        plot_table(tmp_path / "a.png", table)
    assert not figures[0].legends and [text.get_text() for text in figures[1].legends[0].get_texts()] == ["no result"]
    assert "1 of 48 points have no result" in figures[1].get_suptitle()
    life_of = [figure.axes[1].collections[0].get_array() for figure in figures]
    assert np.ma.count_masked(np.ma.masked_invalid(life_of[0])) == 0 and np.ma.count_masked(np.ma.masked_invalid(life_of[1])) == 1
    assert figures[1].axes[1].get_facecolor()[:3] == pytest.approx((0.72, 0.72, 0.72))


def swept(factor=0.5, **axes):
    """Return a table as `sweep` writes it, of a bearing whose lives are in a ratio."""
    axes = axes or {"radial_load": LOADS["even"], "shaft_speed": SPEEDS}
    units = {"radial_load": "N", "shaft_speed": "rpm", "oil_temperature": "degC"}
    results = (("cage_slip", "%"), ("rating_life", "h"), ("modified_rating_life", "h"), ("inner_load_maximum", "N"), ("outer_load_maximum", "N"))
    columns = [*(Column(f"operating.{name}", units[name], "") for name in axes), *(Column(*each, "") for each in results)]
    rows = []
    for point in itertools.product(*axes.values()):
        at = dict(zip(axes, map(float, point)))
        load, speed = at.get("radial_load", 1000.0), at.get("shaft_speed", 3000.0)
        hours = 1e6 / 60.0 / speed * (65_000.0 / load) ** (10.0 / 3.0)
        numbers = 1e4 / load, hours, factor * hours, 0.3 * load, 0.31 * load
        rows.append(
            {f"operating.{name}": value for name, value in at.items()}
            | {name: number for (name, _), number in zip(results, numbers)}
            | {"status": "ok", "reason": ""}
        )
    about = {"kind": "sweep", "scene": "motor", "overrides": [], "level": "steady"}
    about["axes"] = [{"field": f"operating.{name}", "unit": units[name], "values": list(map(float, values))} for name, values in axes.items()]
    return Table((*columns, Column("status", "", ""), Column("reason", "", "")), rows, about)


def test_a_sweep_shows_the_modified_life_where_oil_or_reliability_have_a_factor_and_says_so(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(pictures, "new_figure", lambda *size: figures.append(new_figure(*size)) or figures[-1])
    for factor, name in ((0.5, "modified_rating_life"), (1.0, "rating_life")):
        table = swept(factor)
        assert life_column(table) == name
        plot_table(tmp_path / "a.png", table)
        assert f"{name.replace('_', ' ')} [h]" in [axes.get_ylabel() for axes in figures[-1].axes]
    table = swept(0.5)
    table.rows[:] = [row | {"rating_life": math.nan, "modified_rating_life": math.nan} for row in table.rows]
    assert life_column(table) == "rating_life", "without results no factor is known"


def test_titles_and_legends_write_numbers_as_people_do(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(pictures, "new_figure", lambda *size: figures.append(new_figure(*size)) or figures[-1])
    plot_table(tmp_path / "a.png", swept(radial_load=LOADS["even"], shaft_speed=[20_000.0, 45_000.0]))
    assert [text.get_text() for text in figures[0].legends[0].get_texts()] == ["shaft speed 20,000 rpm", "shaft speed 45,000 rpm"]
    assert figures[0].get_suptitle() == "motor at level steady"
    figures[0].draw_without_rendering()
    written = [text.get_text() for axes in figures[0].axes for axis in (axes.xaxis, axes.yaxis) for text in (*axis.get_ticklabels(), axis.offsetText)]
    assert any("," in text for text in written) and not any(sign in text for text in written for sign in "e$^×")
    assert value_text(LOAD, "N", 100_000.0) == "radial load 100 kN" and value_text("level", "", "slip") == "level slip"
    assert value_text("bearing.roller.length", "mm", 12.5) == "roller length 12.5 mm"


@pytest.mark.parametrize(
    "ends, is_logarithmic, expected",
    [
        ((100.0, 1e6), True, [1e2, 1e3, 1e4, 1e5, 1e6]),
        ((0.1, 90.0), True, [0.1, 0.3, 1.0, 3.0, 10.0, 30.0]),
        ((100.0, 1000.0), True, [100.0, 200.0, 500.0, 1000.0]),
        ((6.0, 9.0), True, [6.0, 7.0, 8.0, 9.0]),
        ((0.1, 20.0), False, [5.0, 10.0, 15.0, 20.0]),
    ],
)
def test_ticks_are_those_that_a_person_would_choose(ends, is_logarithmic, expected):
    found = ticks(*ends, is_logarithmic)
    assert set(np.round(expected, 9)) <= set(np.round(found, 9)) and len(found) <= 8


def test_a_sweep_that_cannot_be_drawn_is_refused_before_it_is_computed(tmp_path, monkeypatch):
    monkeypatch.setattr("bearing_sim.sweep.tasks.run_tasks", lambda *arguments: pytest.fail("points were computed"))
    three = itertools.chain(*(("--vary", text) for text in (f"{LOAD}=100N,200N", f"{SPEED}=2000rpm,3000rpm", "lubricant.temperature=50degC,60degC")))
    arguments = ["sweep", "deng2017_table1", *three, "--out", str(tmp_path / "a.parquet"), "--picture", str(tmp_path / "a.png")]
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 2 and "this sweep has 3" in done.stderr and "--set" in done.stderr
    assert not list(tmp_path.iterdir())


def test_shares_of_the_variance_are_possible_ones_or_not_known():
    """A share lies between 0 and 1, and that of a field alone is at most its total one (Saltelli et al. 2010)."""
    first, total = np.array([-0.01, 0.97, 0.30, 0.27]), np.array([0.02, 0.62, 0.25, 1.04])
    near = 0.05 * np.array([-1.0, 1.0])
    first_error, total_error = first[:, None] + near, total[:, None] + near
    first_error[3], total_error[3] = (-0.2, 0.7), (0.5, 1.6)
    shown = Indices(first, total, first_error, total_error).bounded()
    assert shown.first[0] == 0.0 and shown.total[0] == pytest.approx(0.02)
    assert np.isnan([shown.first[1], shown.total[1]]).all(), "97 % alone of 62 % in all, each within 5: no share at all"
    assert shown.first[2] == shown.total[2] == 0.25, "within the error of each they are the same"
    assert np.isnan([shown.first[3], shown.total[3]]).all(), "an interval of 90 points says nothing"
    for each in (shown.first_error, shown.total_error):
        assert np.all((0.0 <= each) & (each <= 1.0))


@pytest.mark.parametrize("designation", ["NU 232", "NU 210"])
def test_every_estimate_of_a_drawn_bearing_is_marked(tmp_path, monkeypatch, designation):
    figures = []
    monkeypatch.setattr("bearing_sim.sweep.pictures.new_figure", lambda *size: figures.append(new_figure(*size)) or figures[-1])
    bearing = load_bearing(designation)
    plot_bearing(tmp_path / "a.png", bearing)
    texts = [text.get_text() for axes in figures[0].axes for text in (*axes.texts, axes.title)]
    estimated = {each.field for each in bearing.estimated}
    for field, words in (("roller.count", " rollers\n"), ("roller.length", "L "), ("cage.mass", "cage: ")):
        text = next(text for text in texts if words in text)
        assert ("~" in text.partition("\n")[0]) == (field in estimated), (field, text)
