# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Studies of level spatial: misalignment against what the literature says, and what slices change and cost."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from misalignment import misaligned_rings
from misalignment.__main__ import misalignment
from misalignment.misaligned_rings import misalign
from validation.slices import by_slices

from bearing_sim import load_scene
from bearing_sim.sweep.pictures import new_figure

SLOW = ["operating.shaft_speed=5000 rpm", "operating.radial_load=2 kN"]


@pytest.fixture(scope="module")
def found():
    points = misalign("deng2017_table1", SLOW, [0.0, 1e-3, 3e-3], turns=(6.0, 4.0))
    return {(one.crown, round(1e3 * one.misalignment)): one for one in points}


@pytest.mark.parametrize("crown", ["none", "iso_log"])
def test_edges_bear_more_and_the_life_falls_as_the_ring_is_misaligned(found, crown):
    at = [found[crown, amount] for amount in (0, 1, 3)]
    assert np.all(np.diff([one.inner_edge_pressure for one in at]) > 0)
    assert np.all(np.diff([one.outer_edge_pressure for one in at]) > 0)
    assert np.all(np.diff([one.l10r for one in at]) < 0)


def test_a_crown_softens_the_edges_and_keeps_more_of_the_life(found):
    for amount in (1, 3):
        flat, crowned = found["none", amount], found["iso_log", amount]
        assert crowned.inner_edge_pressure < 0.8 * flat.inner_edge_pressure
        assert crowned.l10r / found["iso_log", 0].l10r > flat.l10r / found["none", 0].l10r


def test_heaviest_rollers_stand_halfway_between_both_raceways(found):
    for one in found.values():
        assert one.tilt == pytest.approx(one.misalignment / 2, rel=0.1, abs=1e-6)
        assert one.tilt == pytest.approx(np.abs(one.still.tilts).max(), rel=0.1, abs=1e-6)


def test_skew_grows_with_misalignment_at_moderate_speed(found):
    for crown in ("none", "iso_log"):
        assert found[crown, 0].skew < 0.1 * found[crown, 1].skew < 0.05 * found[crown, 3].skew


def test_life_by_slices_in_motion_is_near_that_of_quasi_static_balance(found):
    for one in found.values():
        assert one.l10r == pytest.approx(one.still.lives.l10r, rel=0.15)


def test_results_settle_as_a_crowned_roller_is_cut_finer():
    scene = load_scene("deng2017_table1", [*SLOW, "level=spatial", "bearing.roller.crown=iso_log", "operating.misalignment=1 mrad"])
    few, some, many = by_slices(scene, 0.1, 0.06, (10, 30, 100))
    for name, gain in (("l10r", 2), ("static_l10r", 5)):  # in motion the life always takes 40 laminae
        rough, fine, finest = (getattr(one, name) for one in (few, some, many))
        assert abs(fine / finest - 1) < 0.08  # 30 slices, as many as the standard asks for
        assert abs(rough / finest - 1) > gain * abs(fine / finest - 1)


def test_the_picture_says_what_each_curve_is_drawn_over(found, tmp_path, monkeypatch):
    figure = new_figure(14, 8)
    monkeypatch.setattr(misaligned_rings, "new_figure", lambda width, height: figure)
    misaligned_rings.plot_misalignment(tmp_path / "m.svg", "misalignment", list(found.values()))
    *over, along = figure.axes
    assert {axes.get_xlabel() for axes in over} == {"misalignment of the inner ring [mrad]"}
    assert along.get_xlabel() == "along the roller, x [mm]"
    for axes in over:
        assert [line.get_xdata().tolist() for line in axes.lines] == [[0.0, 1.0, 3.0]] * len(axes.lines)
    roller = load_scene("deng2017_table1").bearing.roller
    assert all(np.abs(line.get_xdata()).max() < 0.5e3 * roller.length for line in along.lines), "in millimetres, within the roller"


def test_command_prints_and_draws(tmp_path):
    picture, table = tmp_path / "m.png", tmp_path / "m.csv"
    words = [*(word for item in SLOW for word in ("--set", item)), "--points", "2", "--slices", "10", "--json"]
    result = CliRunner().invoke(misalignment, [*words, "--picture", str(picture), "--out", str(table)])
    assert result.exit_code == 0, result.output
    assert [point["crown"] for point in json.loads(result.stdout)["points"]] == ["none", "none", "iso_log", "iso_log"]
    assert picture.stat().st_size > 10_000
    assert len(table.read_text().splitlines()) == 5


def test_a_scene_at_rest_is_refused_with_what_to_do():
    result = CliRunner().invoke(misalignment, ["--set", "operating.shaft_speed=0 rpm"])
    assert result.exit_code == 2
    assert "bearing-sim loads" in result.output
