# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lives of catalogue bearings against what their makers publish; `test_validation` has their ratings."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from validation.catalogues import KOYO, SPEED, koyo_scene

from bearing_sim.cli.main import main
from bearing_sim.physics.lamina_life import stress_risers
from bearing_sim.scene.loader import scene_from_yaml
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.statics import statics

# Series 10: ratings of the same catalogue; nobody publishes rollers, so these are estimates that the load on the bearing does not ask for.
LIGHT = {"NU 1010": (50, 57.5, 72.5, 21, 6.0, 33.6, 36.8), "NU 1014": (70, 80, 100, 21, 8.6, 57.9, 70.4)}


@pytest.mark.parametrize("name", KOYO)
def test_straight_rollers_without_clearance_have_the_reference_life_of_the_load_integrals(name):
    """Half of the circumference is loaded: mean loads by the integrals for line contact of Harris, Rolling Bearing Analysis, table 7.1 and 18.2."""
    _, inner, outer, rollers, _, dynamic, _ = KOYO[name]
    of_radial, rotating, stationary = 0.2453, 0.6495, 0.6744
    heaviest = 0.1 * dynamic / (rollers * of_radial)
    gamma = (outer - inner) / (outer + inner)
    g = (1.038 * ((1 - gamma) / (1 + gamma)) ** (143 / 108)) ** 4.5
    inner_rating, outer_rating = dynamic / (0.83 * 0.378 * rollers) * (1 + g) ** (2 / 9), dynamic / (0.83 * 0.364 * rollers) * (1 + 1 / g) ** (2 / 9)
    whole = ((rotating * heaviest / inner_rating) ** 4.5 + (stationary * heaviest / outer_rating) ** 4.5) ** (-8 / 9)
    edges = np.mean(stress_risers(40) ** 4.5) ** (-8 / 9)
    straight = koyo_scene(name).replace(" mm}\n  cage", " mm, crown: none}\n  cage")
    lives = statics(scene_from_yaml(straight), 40).lives
    assert lives.l10r / lives.l10 == pytest.approx(edges * whole / 10 ** (10 / 3), rel=0.03)


@pytest.mark.parametrize("name", KOYO | LIGHT)
def test_the_life_of_iso_281_is_that_of_the_makers_c(name, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(koyo_scene(name, 0.04, (KOYO | LIGHT)[name]))
    shown = json.loads(CliRunner().invoke(main, ["loads", str(path), "--set", "life.method=iso281", "--json"]).stdout)
    assert shown["life_hours"] == shown["l10_hours"] == pytest.approx(1e6 * 10 ** (10 / 3) / (60 * SPEED), rel=1e-9)
    assert shown["dynamic_rating"] == 1e3 * (KOYO | LIGHT)[name][5] and shown["life_method"] == "iso281"


def test_more_clearance_shortens_the_life_by_laminae_and_leaves_that_of_iso_281():
    tight, loose = (statics(scene_from_yaml(koyo_scene("NU 210", clearance)), 40).lives for clearance in (0.0, 0.1))
    assert loose.l10r < 0.8 * tight.l10r and loose.l10 == tight.l10


def test_without_a_makers_rating_lives_take_the_one_of_the_standard():
    given, computed = (scene_from_yaml(koyo_scene("NU 210", ratings=ratings)) for ratings in (True, False))
    assert rate(computed.bearing).dynamic == rate(given.bearing).computed.dynamic
    by_hand = (rate(computed.bearing).dynamic / 6610) ** (10 / 3) * 1e6 / (60 * SPEED)
    assert statics(computed, 40).lives.l10 == pytest.approx(by_hand, rel=1e-9)


def test_the_default_life_is_that_of_iso_16281():
    lives = statics(scene_from_yaml(koyo_scene("NU 210", 0.045)), 40).lives
    assert lives.basic == lives.l10r
