# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cross-section's geometry: one factor for every radial departure, sizes to scale, axes as stated."""

import math

import numpy as np
import pytest
from synthetic_run import synthetic_block

from bearing_sim.scene.contour import outer_contour
from bearing_sim.scene.loader import load_scene
from bearing_sim.view import section
from bearing_sim.view.blueprint import section_title
from bearing_sim.view.colours import UNLOADED, load_colours, load_palette

SCENE = load_scene("deng2017_table1")
BEARING = SCENE.bearing


def sample():
    return synthetic_block(SCENE, 0.01 * np.arange(1, 30))[-1]


def distance(points):
    return np.hypot(points[..., 0], points[..., 1])


def test_picture_has_y_to_the_right_and_z_upwards_where_the_screen_counts_down():
    assert section.picture(1.0, 0.0).tolist() == [1.0, 0.0]
    assert section.picture(0.0, 1.0).tolist() == [0.0, -1.0]
    np.testing.assert_allclose(section.polar(2.0, math.pi / 2), [0.0, -2.0], atol=1e-12)


def test_drawn_contour_is_the_raceway_with_its_departure_from_round_times_the_factor():
    azimuth = np.linspace(0, 2 * math.pi, 50)
    true = 34.8625 + 0.049 - 0.049 * np.cos(3 * azimuth)  # mm, Deng 2017, eq. 2 with Table 1
    ideal = 27.875 + 7.0
    for factor in (1, 30):
        np.testing.assert_allclose(section.drawn_contour(BEARING, factor, azimuth), ideal + factor * (true - ideal), atol=1e-9)


def test_installation_angle_turns_the_drawn_contour():
    turned = load_scene("deng2017_table1", ["bearing.outer_raceway.installation_angle=40deg"]).bearing
    azimuth = np.linspace(0, 2 * math.pi, 50)
    np.testing.assert_allclose(section.drawn_contour(turned, 30, azimuth + math.radians(40)), section.drawn_contour(BEARING, 30, azimuth), atol=1e-9)


@pytest.mark.parametrize(
    "d_value, low_radius", [("0.098mm", "34.8625mm"), ("0mm", "34.885mm"), ("0.3mm", "34.8625mm"), ("0mm", "34.875mm"), ("5mm", "34.9mm")]
)
def test_factor_draws_the_largest_departure_below_half_a_roller_and_the_title_states_it(d_value, low_radius):
    raceway = f"bearing.outer_raceway.d_value={d_value}", f"bearing.outer_raceway.low_radius={low_radius}"
    scene = load_scene("deng2017_table1", [*raceway, "bearing.outer_raceway.outside_radius=null"])
    factor = section.magnification(scene.bearing)
    assert f"x{factor}" in section_title(scene)
    contour = section.drawn_contour(scene.bearing, factor, np.linspace(0, 2 * math.pi, 721))
    departure = np.abs(contour - 34.875).max()
    assert factor == 1 or departure <= 3.5
    assert departure >= 1.2 or factor == 300, "visible, unless the bearing is round and without play"


def test_roller_pressed_to_the_outer_raceway_touches_the_drawn_contour_and_overlaps_by_its_approach():
    one, factor = sample(), section.magnification(BEARING)
    reach = distance(section.roller_centres(BEARING, factor, one)) + 3.5
    contour = section.drawn_contour(BEARING, factor, one["roller_angle"])
    true_overlap = one["roller_radius"] + 0.0035 - outer_contour(BEARING.outer_raceway, one["roller_angle"])[0]
    np.testing.assert_allclose(reach - contour, factor * true_overlap * 1e3, atol=1e-9)
    assert (true_overlap >= 0).all()


def test_loaded_rollers_overlap_the_drawn_inner_raceway_and_unloaded_ones_do_not():
    one, factor = sample(), section.magnification(BEARING)
    middle = section.polar(0.0, 0.0, section.ring_displacement(factor, one))
    gap = distance(section.roller_centres(BEARING, factor, one) - middle) - 3.5 - 27.875
    loaded = one["inner_load"] > 50
    assert loaded.any() and (~loaded).any()
    assert (gap[loaded] < 0).all()
    assert (gap[one["inner_load"] == 0] > -0.02).all()


@pytest.mark.parametrize("rollers", [8, 14, 18])
def test_rollers_stand_between_cage_bars_and_touch_none(rollers):
    scene = load_scene("deng2017_table1", [f"bearing.roller.count={rollers}"])
    one = synthetic_block(scene, [0.5])[0]
    centres = section.roller_centres(scene.bearing, 1, one)
    bars = section.cage_bars(scene.bearing, one["cage_angle"])
    along = np.linspace(0, 1, 41)[:, None, None]
    points = (bars[:, 0] + along * (bars[:, 1] - bars[:, 0])).reshape(-1, 2)
    nearest = distance(centres[:, None] - points[None]).min(axis=1)
    np.testing.assert_allclose(nearest, nearest[0], rtol=1e-2)
    gap = nearest[0] - 3.5 - section.cage_bar_stroke(scene.bearing)
    assert -0.1 < gap < 1.0


def test_spin_mark_turns_against_the_orbit_when_the_roller_rolls_on_the_outer_ring():
    before, after = synthetic_block(SCENE, [1.0, 1.0001], speeds=(1000.0, 1000.0))
    angles = []
    for one in (before, after):
        mark = section.spin_marks(BEARING, section.roller_centres(BEARING, 1, one), one)
        tip = mark[0, 1] - mark[0, 0]
        angles.append((math.atan2(-tip[1], tip[0]), one["roller_angle"][0]))
    assert angles[1][0] < angles[0][0] and angles[1][1] > angles[0][1]


def test_forces_are_drawn_outside_the_rollers_with_lengths_in_proportion():
    one, factor = sample(), section.magnification(BEARING)
    origins_i, vectors_i, origins_e, vectors_e = section.load_arrows(BEARING, factor, one, 0.01)
    np.testing.assert_allclose(distance(vectors_i), 0.01 * one["inner_load"], atol=1e-9)
    np.testing.assert_allclose(distance(vectors_e), 0.01 * one["outer_load"], atol=1e-9)
    assert (distance(origins_e + vectors_e) > distance(origins_e)).all()
    pressed = one["inner_load"] > 0
    assert (distance(origins_i + vectors_i) < distance(origins_i))[pressed].all()


@pytest.mark.parametrize(
    "slip, word", [(math.nan, "at rest"), (0.0, "rolling"), (0.0499, "rolling"), (0.05, "slipping"), (0.1, "skidding"), (-0.2, "overrunning")]
)
def test_regime_follows_the_thresholds(slip, word):
    assert section.regime(slip, 0.05, 0.10) == word


def test_regime_does_not_flicker_at_a_threshold():
    word, words = "", []
    for slip in (0.04, 0.051, 0.0495, 0.051, 0.047, 0.101, 0.099, 0.0949, -0.051, -0.049, -0.04):
        word = section.regime(slip, 0.05, 0.10, word)
        words.append(word)
    expected = ["rolling", "slipping", "slipping", "slipping", "rolling", "skidding", "skidding", "slipping", "overrunning", "overrunning", "rolling"]
    assert words == expected


@pytest.mark.parametrize("number, expected", [(0.99, 1.0), (1.0, 1.0), (1.01, 1.5), (222.0, 300.0), (3104.0, 4000.0), (8.1e-4, 1e-3)])
def test_scales_are_round_and_not_exceeded(number, expected):
    assert section.round_up(number) == pytest.approx(expected)


@pytest.mark.parametrize("low, high", [(0.0, 1.2), (0.1, 4694.9), (17.3, 47.3)])
def test_ticks_are_few_round_and_inside(low, high):
    ticks = section.round_ticks(low, high)
    assert 3 <= len(ticks) <= 7
    assert ticks[0] >= low - 0.03 * (high - low) and ticks[-1] <= high + 0.03 * (high - low)
    np.testing.assert_allclose(np.diff(ticks), ticks[1] - ticks[0])


def test_more_load_is_never_darker_and_none_is_grey():
    brightness = load_palette() @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(brightness) > -1.5).all() and brightness[-1] > 3 * brightness[0]
    colours = load_colours(np.array([0.0, np.nan, 500.0, 5000.0]), 1000.0)
    assert colours[0].tolist() == colours[1].tolist() == list(UNLOADED)
    assert colours[3, :3].tolist() == load_palette()[-1].tolist()


PLANAR = load_scene("deng2017_table1", ["level=planar"])


def test_cage_on_its_land_is_drawn_on_the_drawn_land_whose_place_is_inside_the_raceway():
    factor, one = section.cage_magnification(PLANAR), sample()
    one["cage_y"], one["cage_z"] = 0.15e-3 * math.cos(1.0), 0.15e-3 * math.sin(1.0)
    outer_radius = 33.5 - 0.15
    reach = outer_radius + math.hypot(*section.cage_displacement(factor, one))
    assert reach == pytest.approx(section.drawn_guide_radius(BEARING, factor))
    assert factor > 1 and reach < 34.875
    assert f"cage x{factor}" in section_title(PLANAR)


INNER = load_scene("deng2017_table1", ["level=planar", "bearing.cage.guidance=inner_ring", "bearing.cage.outer_radius=33.35 mm"])
ROLLER_GUIDED = load_scene("deng2017_table1", ["level=planar", "bearing.cage.guidance=roller", "bearing.cage.outer_radius=33.35 mm"])


def test_cage_on_the_inner_rings_land_is_drawn_on_the_drawn_land_which_goes_with_the_ring():
    factor, one = section.cage_magnification(INNER), sample()
    one["ring_y"], one["ring_z"] = 4e-6, -7e-6
    one["cage_y"], one["cage_z"] = one["ring_y"] + 0.15e-3 * math.cos(1.0), one["ring_z"] + 0.15e-3 * math.sin(1.0)
    land, cage = section.land_displacement(INNER.bearing, factor, one), section.cage_displacement(factor, one)
    apart = math.hypot(cage[0] - land[0], cage[1] - land[1])
    assert 29.6 - apart == pytest.approx(section.drawn_guide_radius(INNER.bearing, factor))  # the bore meets the land
    assert factor > 1 and section.drawn_guide_radius(INNER.bearing, factor) > 27.875


def test_a_cage_guided_by_its_rollers_is_drawn_without_land_and_clear_of_both_raceways():
    factor, one = section.cage_magnification(ROLLER_GUIDED), sample()
    assert section.drawn_guide_radius(ROLLER_GUIDED.bearing, factor) is None
    one["cage_y"], one["cage_z"] = 0.1e-3, 0.0
    away = math.hypot(*section.cage_displacement(factor, one))
    assert factor > 1 and 33.35 + away < 34.875 and 29.6 - away > 27.875


def test_level_without_whirl_draws_the_land_where_it_is():
    assert section.cage_magnification(SCENE) == 1
    assert section.drawn_guide_radius(BEARING, 1) == pytest.approx(33.5)
    assert "cage" not in section_title(SCENE)


def test_bars_go_where_the_cages_centre_goes():
    moved = section.cage_bars(BEARING, 0.3, (1.0, 2.0)) - section.cage_bars(BEARING, 0.3)
    np.testing.assert_allclose(moved, np.broadcast_to([1.0, -2.0], moved.shape), atol=1e-12)  # the picture's second axis points down


def test_pocket_that_drives_a_roller_pushes_it_along_the_orbit():
    one = sample()
    one["pocket_force"] = 10.0
    later = one.copy()
    later["roller_angle"] += 1e-6
    motion = section.roller_centres(BEARING, 1, later) - section.roller_centres(BEARING, 1, one)
    arrows = section.pocket_arrows(one, 0.1)
    np.testing.assert_allclose(distance(arrows), 1.0)
    np.testing.assert_allclose(arrows, motion / distance(motion)[:, None], atol=1e-4)
    one["pocket_force"] = np.nan
    assert (section.pocket_arrows(one, 0.1) == 0.0).all()


def test_a_raceway_that_has_bent_is_drawn_through_the_deflections_at_the_rollers():
    bearing = load_scene("deng2017_table1").bearing
    angles = 0.3 + 2 * math.pi * np.arange(bearing.roller.count) / bearing.roller.count
    sample = {"roller_angle": angles, "raceway_deflection": 1e-6 * (3 + np.cos(2 * angles) + 0.5 * np.sin(3 * angles))}
    turn = np.linspace(0, 2 * math.pi, 100)
    bent = section.bent_contour(bearing, 200.0, turn, sample) - section.drawn_contour(bearing, 200.0, turn)
    np.testing.assert_allclose(bent, 200.0 * 1e-3 * (3 + np.cos(2 * turn) + 0.5 * np.sin(3 * turn)), atol=1e-9)
