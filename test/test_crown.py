# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about crowns: drops of slices, and what a scene may say."""

import math

import numpy as np
import pytest

from bearing_sim.model.params import contact_stiffness, pack
from bearing_sim.scene.crown import IsoLogCrown, NoCrown, StraightArcCrown, TableCrown, crown_drops, slice_middles
from bearing_sim.scene.loader import SceneError, load_scene, scene_from_yaml, scene_to_yaml

DIAMETER, LENGTH = 7e-3, 7e-3


def scene(*overrides, level="spatial"):
    return load_scene("deng2017_table1", [f"level={level}", *overrides])


def test_slice_middles_tile_the_roller_evenly():
    x = slice_middles(LENGTH, 20)
    assert x[0] == pytest.approx(-LENGTH / 2 + LENGTH / 40) and np.ptp(np.diff(x)) < 1e-15
    np.testing.assert_allclose(x, -x[::-1], atol=1e-18)


def test_a_straight_roller_drops_nowhere():
    assert not crown_drops(NoCrown(), DIAMETER, LENGTH, 20).any()


def test_the_iso_profile_by_hand():
    # half way to the end: 0.00035 * 7 mm * ln(4/3) = 0.70482 um
    x = slice_middles(LENGTH, 2)
    assert x[1] == pytest.approx(LENGTH / 4)
    assert crown_drops(IsoLogCrown(), DIAMETER, LENGTH, 2) == pytest.approx(2 * [0.00035 * 7e-3 * math.log(4 / 3)], rel=1e-14)
    drops = crown_drops(IsoLogCrown(), DIAMETER, LENGTH, 200)
    assert np.isfinite(drops).all() and (np.diff(drops[100:]) > 0).all()


def test_a_straight_arc_is_flat_and_then_a_circle():
    crown = StraightArcCrown(straight_length=3e-3, crown_radius=2.0)
    x, drops = slice_middles(LENGTH, 70), crown_drops(crown, DIAMETER, LENGTH, 70)
    assert not drops[np.abs(x) <= 1.5e-3].any()
    on_arc = np.abs(x) > 1.5e-3
    np.testing.assert_allclose(drops[on_arc], (np.abs(x[on_arc]) - 1.5e-3) ** 2 / 4.0, rtol=1e-6)


def test_a_table_goes_through_its_points_in_straight_lines():
    crown = TableCrown(positions=(-3.5e-3, 0.0, 3.5e-3), drops=(4e-6, 0.0, 8e-6))
    assert crown_drops(crown, DIAMETER, LENGTH, 2) == pytest.approx([2e-6, 4e-6], rel=1e-12)


def test_drops_reach_the_parameters_by_the_number_of_slices():
    slices = pack(scene("bearing.roller.crown=iso_log", "bearing.roller.slices=30")).slices
    assert slices.crown.shape == (30,) and slices.crown.dtype == np.float64 and slices.crown.flags.c_contiguous


def test_a_crown_from_a_file_is_kept_inside_the_scene(tmp_path):
    path = tmp_path / "crown.csv"
    path.write_text("# measured\ndrop[um],position[mm]\n4,-3.5\n0,0\n8,3.5\n")
    read = scene(f"bearing.roller.crown={{law: table, file: {path}}}")
    assert read.bearing.roller.crown == TableCrown(positions=(-3.5e-3, 0.0, 3.5e-3), drops=(4e-6, 0.0, 8e-6))
    path.unlink()
    assert scene_from_yaml(scene_to_yaml(read)) == read


def test_a_scene_files_crown_lies_beside_it(tmp_path):
    (tmp_path / "crown.csv").write_text("position[mm],drop[um]\n-3.5,4\n3.5,4\n")
    path = tmp_path / "scene.yaml"
    text = scene_to_yaml(scene()).replace("    crown:\n      law: none\n", "    crown: {law: table, file: crown.csv}\n")
    assert "crown.csv" in text
    path.write_text(text)
    assert load_scene(path).bearing.roller.crown.drops == (4e-6, 4e-6)


@pytest.mark.parametrize(
    "text, reported",
    [
        ("position,drop\n1,2\n", "header"),
        ("position[mm],drop[um]\n1\n", "row 1"),
        ("position[mm],drop[um]\n-3.5,1\n3.5,x\n", "crown.drops.1"),
        ("position[mm],drop[kg]\n-3.5,1\n3.5,1\n", "dimension"),
        ("position[mm],drop[um]\n-3.5,1\n-3.5,1\n", "increasing positions"),
        ("position[mm],drop[um]\n-3.5,1\n0,1\n", "do not cover the roller"),
        ("", "header"),
    ],
)
def test_a_bad_table_is_reported(tmp_path, text, reported):
    path = tmp_path / "crown.csv"
    path.write_text(text)
    with pytest.raises(SceneError, match=reported):
        scene(f"bearing.roller.crown={{law: table, file: {path}}}")


@pytest.mark.parametrize("level", ["steady", "slip", "planar"])
def test_a_level_without_slices_takes_a_crown_for_the_life(level):
    straight, crowned = (scene(f"bearing.roller.crown={crown}", level=level) for crown in ("none", "iso_log"))
    assert pack(straight).life.laminae.crown.max() == 0.0 < pack(crowned).life.laminae.crown.max()


def test_a_level_without_slices_names_everything_that_it_would_ignore():
    with pytest.raises(SceneError, match="moment.*tilts"):
        scene("bearing.roller.crown=iso_log", "operating.moment=1 N*m", level="planar")
    with pytest.raises(SceneError, match="misalignment: needs level spatial"):
        scene("operating.misalignment=1 mrad", level="slip")


@pytest.mark.parametrize(
    "crown, reported",
    [
        ("isolog", "did you mean 'iso_log'"),
        ("{law: straight_arc, straight_length: 9 mm, crown_radius: 2 m}", "longer than the roller"),
        ("{law: straight_arc, straight_length: 1 mm, crown_radius: 2 mm}", "end before the end of the roller"),
        ("{law: straight_arc, straight_length: 1 mm}", "crown_radius: missing"),
        ("{law: table, file: nowhere.csv}", "cannot be read"),
        ("{law: table, file: nowhere.csv, drops: [1 um]}", "give either file, or positions and drops"),
        ("{law: table, positions: [-4mm, 4mm], drops: [1 um]}", "expected the same number"),
    ],
)
def test_an_impossible_crown_is_reported(crown, reported):
    with pytest.raises(SceneError, match=reported):
        scene(f"bearing.roller.crown={crown}")


def test_isos_spring_is_that_of_two_contacts_in_a_row():
    iso = contact_stiffness(scene("bearing.contact.spring=iso").bearing)
    # N and mm: both contacts of c_L = 35948 * 7^(8/9) share 10 um evenly
    assert iso * 5e-6 ** (10 / 9) == pytest.approx(35948 * 7 ** (8 / 9) * 0.010 ** (10 / 9), rel=1e-12)
    assert iso / contact_stiffness(scene().bearing) == pytest.approx(0.9655, abs=1e-3)
