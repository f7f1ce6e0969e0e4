# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the view shows of cage and powers: the orbit where there is one, the sample's own numbers everywhere."""

import math

import numpy as np
import pytest
from rerun_files import last_value, views_in, written
from synthetic_run import synthetic_block

from bearing_sim.model.losses import CAUSES as LOSSES
from bearing_sim.scene.loader import load_scene
from bearing_sim.view.blueprint import blueprint
from bearing_sim.view.drawings import CAUSES, TURNS, OrbitPath, causes_of

SLIP, PLANAR = (load_scene("deng2017_table1", [f"level={level}"]) for level in ("slip", "planar"))


pytestmark = pytest.mark.usefixtures("strict_rerun")


def whirling_block(samples=30, turns=10.0):
    block = synthetic_block(PLANAR, 1e-4 * np.arange(1, samples + 1), speeds=(4000.0, 4000.0))
    turn = np.linspace(0.0, 2 * math.pi * turns, samples)
    block["cage_angle"] = turn
    block["cage_y"], block["cage_z"] = 0.1e-3 * np.cos(turn / 2), 0.1e-3 * np.sin(turn / 2)
    block["land_eccentricity"] = 0.1 / 0.15
    for place, cause in enumerate(CAUSES):
        block[f"{cause}_power"] = 100.0 * place + turn
    block["pocket_force"] = np.arange(-9, 9) * 3.0
    return block


def test_orbit_is_shown_where_the_level_has_whirl_and_only_there():
    shown = {
        scene.level: {view.name for view in views_in(blueprint(scene, ((-40, 40), (-40, 40)), live=False).root_container)} for scene in (SLIP, PLANAR)
    }
    assert {"Cage orbit", "e/c [-]"} <= shown["planar"] and not {"Cage orbit", "e/c [-]"} & shown["slip"]
    assert {"Power: mean of 20 samples", "Pocket [N]"} <= shown["planar"] & shown["slip"]


def test_run_without_whirl_writes_no_orbit(tmp_path):
    block = synthetic_block(SLIP, 0.001 * np.arange(1, 50))
    assert not any(chunk.entity_path.startswith("/cage_orbit") for chunk in written(tmp_path / "run.rrd", SLIP, block))


def test_orbit_is_in_micrometres_with_z_upwards(tmp_path):
    block = whirling_block(turns=9.5)
    chunks = written(tmp_path / "run.rrd", PLANAR, block)
    (centre,) = last_value(chunks, "/cage_orbit/centre", "Points2D:positions")
    np.testing.assert_allclose(centre, [1e6 * block["cage_y"][-1], -1e6 * block["cage_z"][-1]], atol=1e-3)
    assert last_value(chunks, "/cage_orbit/text", "Arrows2D:labels") == ["e/c = 0.667, c = 150 µm"]


def test_the_powers_shown_are_that_of_the_shaft_and_all_losses():
    losses = {name for names in LOSSES.values() for name in names}
    assert {f"{cause}_power" for cause in CAUSES} == losses | {"shaft_power"}


def test_series_of_powers_and_eccentricity_are_the_samples(tmp_path):
    block = whirling_block()
    chunks = written(tmp_path / "run.rrd", PLANAR, block)
    for cause in causes_of(PLANAR):
        assert last_value(chunks, f"/power/{cause}", "Scalars:scalars") == pytest.approx([block[f"{cause}_power"][-1]])
    assert last_value(chunks, "/cage/eccentricity", "Scalars:scalars") == pytest.approx([2 / 3])
    assert last_value(chunks, "/loads/pocket_largest", "Scalars:scalars") == [27.0]


def test_bars_are_as_long_as_the_mean_of_their_newest_powers(tmp_path):
    block = whirling_block()
    chunks = written(tmp_path / "run.rrd", PLANAR, block)
    strips = np.array(last_value(chunks, "/power_now/bars", "LineStrips2D:strips"))
    radii = np.array(last_value(chunks, "/power_now/bars", "LineStrips2D:radii"))
    length = strips[:, 1, 0] - strips[:, 0, 0] + 2 * radii
    powers = np.array([block[f"{cause}_power"][-20:].mean() for cause in causes_of(PLANAR)])
    assert last_value(chunks, "/power_now/values", "Arrows2D:labels") == [f"{power:,.0f} W" for power in powers]
    np.testing.assert_allclose(length, powers * length[-1] / powers[-1], rtol=1e-5)


def test_a_scene_shows_the_losses_that_it_can_have():
    absent = {"inner_rolling", "outer_rolling", "seal", "flange", "support"}
    assert CAUSES.keys() - causes_of(PLANAR).keys() == absent
    more = [
        "lubricant.rolling_resistance=hydrodynamic",
        "bearing.seals={law: constant_moment, moment: 0.1 N*m}",
        "bearing.flanges={outer: both}",
        "support={elastic: true, shaft: {mass: 2 kg}}",
    ]
    assert causes_of(load_scene("deng2017_table1", ["level=planar", *more])).keys() == CAUSES.keys()


def test_bars_of_the_running_clearance_and_its_parts_stand_on_either_side_of_zero_and_old_recordings_have_none(tmp_path):
    block = whirling_block()
    parts = {"running": -4.0, "initial": 20.0, "fit": -10.0, "rotation": -6.0, "heat": -8.0, "contour": -0.01}  # um
    for part, micrometres in parts.items():
        block[f"{part}_clearance"] = 1e-6 * micrometres
    chunks = written(tmp_path / "run.rrd", PLANAR, block)
    strips = np.array(last_value(chunks, "/clearance_now/bars", "LineStrips2D:strips"))
    radii = np.array(last_value(chunks, "/clearance_now/bars", "LineStrips2D:radii"))
    ends = np.array(
        [strip[:, 0].min() - radius if value < 0.0 else strip[:, 0].max() + radius for strip, radius, value in zip(strips, radii, parts.values())]
    )
    np.testing.assert_allclose(ends / ends[1], np.array([*parts.values()]) / 20.0, atol=1e-6)
    assert last_value(chunks, "/clearance_now/values", "Arrows2D:labels") == ["-4.0 µm", "20.0 µm", "-10.0 µm", "-6.0 µm", "-8.0 µm", "0.0 µm"]
    assert last_value(chunks, "/clearance/running", "Scalars:scalars") == [pytest.approx(-4.0)]
    for part in parts:
        block[f"{part}_clearance"] = np.nan
    old = written(tmp_path / "old.rrd", PLANAR, block)
    assert set(last_value(old, "/clearance_now/values", "Arrows2D:labels")) == {"unknown"}


def test_path_holds_the_last_turns_of_the_cage():
    path, block = OrbitPath(), whirling_block(samples=500, turns=10.0)
    for part in np.array_split(block, 11):
        path.add(part)
    recent = block["cage_angle"] >= block["cage_angle"][-1] - 2 * math.pi * TURNS
    np.testing.assert_array_equal(path.positions(), np.stack((block["cage_y"], block["cage_z"]), axis=1)[recent])
    assert path.is_dense()


def test_samples_a_good_part_of_a_turn_apart_are_no_line():
    path = OrbitPath()
    assert not path.is_dense() and path.positions().shape == (0, 2)
    path.add(whirling_block(samples=100, turns=30.0))
    assert not path.is_dense()
    assert len(path.positions()) >= 40


def test_recording_that_does_not_know_the_cages_place_is_shown_without(tmp_path):
    block = whirling_block()
    for name in ("cage_y", "cage_z", "land_eccentricity", "pocket_force", "orbital_speed", *(f"{cause}_power" for cause in CAUSES)):
        block[name] = np.nan
    chunks = written(tmp_path / "run.rrd", PLANAR, block)
    assert last_value(chunks, "/cage_orbit/text", "Arrows2D:labels") == ["not recorded"]
    assert set(last_value(chunks, "/power_now/values", "Arrows2D:labels")) == {"unknown"}


def test_line_and_dots_take_turns_as_the_sampling_does(tmp_path):
    fine, coarse = whirling_block(samples=45, turns=1.5), whirling_block(samples=45, turns=30.0)
    coarse["time"] += fine["time"][-1]
    coarse["cage_angle"] += fine["cage_angle"][-1]
    for name, block, line, dots in (("a", fine, True, False), ("b", np.concatenate((fine, coarse)), False, True)):
        chunks = written(tmp_path / f"{name}.rrd", PLANAR, block)
        assert bool(last_value(chunks, "/cage_orbit/path/line", "LineStrips2D:strips")) is line
        assert bool(last_value(chunks, "/cage_orbit/path/dots", "Points2D:positions")) is dots


CAGE_OUTSIDE = "bearing.cage.outer_radius=33.35 mm"


@pytest.mark.parametrize(
    ("guidance", "where"), [("outer_ring", {"/section/outer_ring/guide_land"}), ("inner_ring", {"/section/inner_ring/guide_land"}), ("roller", set())]
)
def test_lands_are_drawn_on_the_ring_that_has_them_and_nowhere_else(tmp_path, guidance, where):
    scene = load_scene("deng2017_table1", ["level=planar", f"bearing.cage.guidance={guidance}", CAGE_OUTSIDE])
    chunks = written(tmp_path / "run.rrd", scene, whirling_block())
    assert {chunk.entity_path for chunk in chunks if "guide_land" in chunk.entity_path} == where


def test_orbit_on_the_inner_rings_lands_is_seen_from_the_ring(tmp_path):
    scene = load_scene("deng2017_table1", ["level=planar", "bearing.cage.guidance=inner_ring", CAGE_OUTSIDE])
    block = whirling_block()
    (centre,) = last_value(written(tmp_path / "run.rrd", scene, block), "/cage_orbit/centre", "Points2D:positions")
    expected = [1e6 * (block["cage_y"][-1] - block["ring_y"][-1]), -1e6 * (block["cage_z"][-1] - block["ring_z"][-1])]
    np.testing.assert_allclose(centre, expected, atol=1e-3)
