# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the view shows of tilts, of slices' pressures and of lives besides the basic one, and where."""

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun_files import last_value, views_in, written
from scipy.spatial.transform import Rotation
from synthetic_run import synthetic_block

from bearing_sim.messages.diagnostics import further_condition
from bearing_sim.scene.loader import load_scene
from bearing_sim.view import section
from bearing_sim.view.blueprint import blueprint

CHOICE = ["life.reliability=99 %", "life.method=iso16281"]
SPATIAL, CHOOSING, PLANAR = (load_scene("deng2017_table1", o) for o in (["level=spatial"], ["level=spatial", *CHOICE], ["level=planar"]))


pytestmark = pytest.mark.usefixtures("strict_rerun")


def tilted_block(samples=40):
    block = synthetic_block(SPATIAL, 1e-3 * np.arange(1, samples + 1))
    block["roller_tilt"], block["roller_skew"] = 1e-3 * np.linspace(-0.5, 0.5, 18), 1e-3 * np.linspace(2.0, -3.0, 18)
    block["ring_tilt_y"], block["ring_tilt_z"], block["cage_tilt_y"], block["cage_tilt_z"] = 1e-3, -0.5e-3, 0.2e-3, 0.1e-3
    block["l10"], block["modified_rating_life"] = 0.8 * block["rating_life"], 0.2 * block["rating_life"]
    for place, name in enumerate(("inner_pressure", "outer_pressure", "inner_edge_pressure", "outer_edge_pressure")):
        block[name] = (1400 + 100 * place) * 1e6
    return block


def shown(scene):
    return {view.name for view in views_in(blueprint(scene, ((-40, 40), (-40, 40)), live=False).root_container)}


def test_tilts_are_shown_where_the_level_has_them_and_only_there():
    tilts = {"Roller tilt [mrad]", "Roller skew [mrad]", "Ring [mrad]: blue y, orange z", "Cage [mrad]", "Pressure [MPa]"}
    assert tilts <= shown(SPATIAL) and not tilts & shown(PLANAR)


def test_the_solid_picture_says_by_what_it_draws_tilts(tmp_path):
    (text,) = [chunk for chunk in written(tmp_path / "run.rrd", SPATIAL, tilted_block()) if chunk.entity_path == "/solid/factors"]
    assert text.to_record_batch().column("Arrows3D:labels").to_pylist() == [["tilt of ring and rollers x30, skew x20, tilt of cage x8"]]
    held = load_scene("deng2017_table1", ["level=spatial", "operating.misalignment=20 mrad"])
    assert section.tilt_magnification(held) == 15


def test_the_life_by_the_method_of_the_scene_is_drawn_with_that_of_the_other_standard_and_the_modified_one_where_it_is_wanted():
    titles = [next(name for name in shown(scene) if name.startswith("Lives")) for scene in (PLANAR, CHOOSING)]
    assert titles == [
        "Lives, log10 of hours (green L (Deng 2017), white L10r)",
        "Lives, log10 of hours (green L10r, white L10, purple L_nmr)",
    ]


def test_series_of_tilts_lives_and_pressures_are_the_samples(tmp_path):
    block = tilted_block()
    chunks = written(tmp_path / "run.rrd", CHOOSING, block)

    def last(path):
        return np.array(last_value(chunks, path, "Scalars:scalars"))

    for name in ("tilt", "skew"):
        np.testing.assert_allclose(last(f"/tilt/each/{name}"), 1e3 * block[f"roller_{name}"][-1], rtol=1e-6)
    assert [last(f"/tilt/{axis}")[0] for axis in ("ring_y", "ring_z", "cage_y", "cage_z")] == pytest.approx([1.0, -0.5, 0.2, 0.1])
    assert [last(f"/pressure/{place}")[0] for place in ("inner", "outer_edge")] == pytest.approx([1400.0, 1700.0])
    life = np.log10(block["rating_life"][-1])
    lives = [last(f"/life/{kind}log10_hours")[0] for kind in ("", "l10_", "modified_")]
    assert lives == pytest.approx([life, life + np.log10(0.8), life + np.log10(0.2)], rel=1e-6)
    text = last_value(chunks, "/now", "TextDocument:text")[0]
    assert (
        "| life, L_nmr |" in text
        and "| L10 |" in text
        and "| without oil, L10r |" in text
        and "1500 MPa, ends 1700 MPa" in text
        and "0.50, 3.00 mrad" in text
    )


def test_a_planar_run_writes_no_series_of_tilts(tmp_path):
    paths = {chunk.entity_path for chunk in written(tmp_path / "run.rrd", PLANAR, tilted_block()) if not chunk.is_static}
    assert not [path for path in paths if path.startswith(("/tilt", "/pressure", "/life/modified"))]


def test_rollers_lean_outwards_by_tilt_and_along_the_orbit_by_skew(tmp_path):
    block, factor, skewing = tilted_block(), section.tilt_magnification(SPATIAL), section.skew_magnification(SPATIAL.bearing)
    chunks = written(tmp_path / "run.rrd", SPATIAL, block)
    turns = np.array(last_value(chunks, "/solid/rollers", "InstancePoses3D:quaternions"))
    azimuth = block["roller_angle"][-1]
    axes = Rotation.from_quat(turns).apply([0.0, 0.0, 1.0])  # in the drawing's (y, z, x)
    axes = axes / axes[:, 2:]
    outwards, along = axes[:, 0] * np.cos(azimuth) + axes[:, 1] * np.sin(azimuth), axes[:, 1] * np.cos(azimuth) - axes[:, 0] * np.sin(azimuth)
    np.testing.assert_allclose(outwards, factor * block["roller_tilt"][-1], atol=1e-6)
    np.testing.assert_allclose(along, skewing * block["roller_skew"][-1], atol=1e-6)
    ring = Rotation.from_quat(last_value(chunks, "/solid/inner_ring/body", "InstancePoses3D:quaternions")[0]).apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(ring[:2] / ring[2], [factor * 1e-3, -factor * 0.5e-3], atol=1e-6)


def test_a_recording_that_knows_no_tilts_is_drawn_upright(tmp_path):
    block = tilted_block()
    for name in ("roller_tilt", "roller_skew", "ring_tilt_y", "ring_tilt_z", "cage_tilt_y", "cage_tilt_z", "inner_pressure", "outer_edge_pressure"):
        block[name] = np.nan
    chunks = written(tmp_path / "run.rrd", SPATIAL, block)
    np.testing.assert_array_equal(last_value(chunks, "/solid/rollers", "InstancePoses3D:quaternions"), np.tile([0.0, 0.0, 0.0, 1.0], (18, 1)))
    text = last_value(chunks, "/now", "TextDocument:text")[0]
    assert "| pressure | unknown |" in text and "| most tilt, skew | unknown |" in text


def test_diagnostics_tell_further_lives_and_edges_where_the_scene_has_them():
    sample = tilted_block()[-1]
    found = further_condition(PLANAR, sample)
    assert found["life method"] == "deng2017" and set(found) == {"life method", "L10 [h]", "L_nm [h]", "L10r [h]", "L_nmr [h]"}
    found = further_condition(CHOOSING, sample)
    assert found["life method"] == "iso16281" and found["L10 [h]"] == sample["l10"]
    assert found["modified rating life [h]"] == sample["modified_rating_life"]
    assert found["largest edge pressure [Pa]"] == 1.7e9 and found["largest roller skew [rad]"] == pytest.approx(0.003)
    assert "modified rating life [h]" not in further_condition(SPATIAL, sample)


def test_views_of_both_scenes_can_be_laid_out():
    assert isinstance(blueprint(CHOOSING, ((-40, 40), (-40, 40)), live=True), rrb.Blueprint)
