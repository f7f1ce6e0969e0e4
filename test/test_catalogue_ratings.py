# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Ratings and lives of catalogue bearings against what their makers publish.

Raceway diameters F and E and the ratings are those of Koyo's catalogue (JTEKT, ball and roller bearings; NSK's rows are the same).  The roller
diameter is (E - F)/2.  Numbers of rollers are published for NU 206, NU 210 and NU 215 and deduced for the others; the effective length is
that which gives the catalogue's C_0 by ISO 76, so that C_r is a check of C against C_0: two rollers more or less move it by half a percent.
"""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.physics.lamina_life import stress_risers
from bearing_sim.scene.loader import scene_from_yaml
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.statics import statics

# bore, raceway diameters F, E [mm], rollers, effective length [mm], C, C_0 [kN]
BEARINGS = {
    "NU 205": (25, 31.5, 46.5, 13, 7.99, 29.3, 27.7),
    "NU 2205": (25, 31.5, 46.5, 13, 9.99, 34.9, 34.6),
    "NJ 305": (25, 34, 54, 11, 10.00, 41.6, 37.4),
    "N 206": (30, 37.5, 55.5, 13, 9.01, 39.1, 37.4),
    "NU 2206": (30, 37.5, 55.5, 13, 12.00, 48.9, 49.8),
    "N 306": (30, 40.5, 62.5, 12, 10.99, 53.1, 50.2),
    "NU 207": (35, 44, 64, 14, 10.00, 50.2, 50.2),
    "NJ 308": (40, 52, 80, 12, 13.99, 83.1, 81.5),
    "NU 2308": (40, 52, 80, 12, 20.95, 114, 122),
    "NU 210": (50, 59.5, 81.5, 16, 11.00, 66.1, 71.9),
    "NU 2210": (50, 59.5, 81.5, 16, 14.00, 79.7, 91.5),
    "NJ 2310": (50, 65, 97, 13, 25.46, 163, 187),
    "N 212": (60, 72, 100, 16, 12.97, 97.7, 107),
    "NU 215": (75, 88.5, 118.5, 18, 15.36, 130, 156),
    "NU 315": (75, 95, 143, 13, 24.00, 240, 263),
    "NU 2324": (120, 154, 230, 13, 59.08, 793, 1030),
    "NU 232": (160, 195, 259, 18, 30.59, 498, 666),
}
# Series 10: ratings of the same catalogue; nobody publishes rollers, so these are estimates that the load on the bearing does not ask for.
LIGHT = {"NU 1010": (50, 57.5, 72.5, 21, 6.0, 33.6, 36.8), "NU 1014": (70, 80, 100, 21, 8.6, 57.9, 70.4)}
SPEED = 1000.0  # rpm
# middle of the normal group of diametral clearance [mm] by bore (ISO 5753-1)
NORMAL_CLEARANCE = {25: 0.0325, 30: 0.0325, 35: 0.0375, 40: 0.0375, 50: 0.045, 60: 0.055, 75: 0.0575, 120: 0.07, 160: 0.0975}


def yaml_of(name, clearance=0.0, ratings=True):
    """Return a scene of a bearing under a tenth of its maker's C; ``clearance`` is the diametral one [mm]."""
    _, inner, outer, rollers, length, dynamic, static = (BEARINGS | LIGHT)[name]
    diameter, pitch = (outer - inner) / 2, (outer + inner) / 2
    cage = f"{{mass: {1e-6 * pitch**3:.3g} kg, inner_radius: {pitch / 2 - 0.2 * diameter} mm, guide_radius: {pitch / 2 + 0.3 * diameter} mm"
    maker = f"ratings: {{dynamic: {dynamic} kN, static: {static} kN}}" if ratings else ""
    return f"""
name: catalogue
bearing:
  name: {name}
  source: Koyo catalogue
  dimensions_at: running
  outer_raceway: {{low_radius: {inner / 2 + diameter + clearance / 2} mm, d_value: 0 mm, lobes: 3}}
  inner_raceway: {{radius: {inner / 2} mm}}
  roller: {{count: {rollers}, diameter: {diameter} mm, length: {length} mm}}
  cage: {cage}, guide_clearance: 0.3 mm, guide_land_width: 2 mm, width: {length + 6} mm}}
  {maker}
lubricant: {{oil: mil_l_23699, temperature: 80 degC, mixture_fraction: 0.03}}
operating: {{shaft_speed: {SPEED} rpm, radial_load: {100 * dynamic} N}}
"""


@pytest.mark.parametrize("name", BEARINGS)
def test_ratings_by_the_standards_are_those_of_the_catalogue(name):
    *_, dynamic, static = BEARINGS[name]
    computed = rate(scene_from_yaml(yaml_of(name)).bearing).computed
    assert 1e-3 * computed.dynamic == pytest.approx(dynamic, rel=0.005)
    assert 1e-3 * computed.static == pytest.approx(static, rel=0.003)  # by which the length was found; Koyo prints three digits


@pytest.mark.parametrize("name", BEARINGS)
def test_straight_rollers_without_clearance_have_the_reference_life_of_the_load_integrals(name):
    """Half of the circumference is loaded: mean loads by the integrals for line contact of Harris, Rolling Bearing Analysis, table 7.1 and 18.2."""
    _, inner, outer, rollers, _, dynamic, _ = BEARINGS[name]
    of_radial, rotating, stationary = 0.2453, 0.6495, 0.6744
    heaviest = 0.1 * dynamic / (rollers * of_radial)
    gamma = (outer - inner) / (outer + inner)
    g = (1.038 * ((1 - gamma) / (1 + gamma)) ** (143 / 108)) ** 4.5
    inner_rating, outer_rating = dynamic / (0.83 * 0.378 * rollers) * (1 + g) ** (2 / 9), dynamic / (0.83 * 0.364 * rollers) * (1 + 1 / g) ** (2 / 9)
    whole = ((rotating * heaviest / inner_rating) ** 4.5 + (stationary * heaviest / outer_rating) ** 4.5) ** (-8 / 9)
    edges = np.mean(stress_risers(40) ** 4.5) ** (-8 / 9)
    straight = yaml_of(name).replace(" mm}\n  cage", " mm, crown: none}\n  cage")
    lives = statics(scene_from_yaml(straight), 40).lives
    assert lives.l10r / lives.l10 == pytest.approx(edges * whole / 10 ** (10 / 3), rel=0.03)


@pytest.mark.parametrize("name", BEARINGS)
def test_the_default_life_is_one_to_two_and_a_quarter_times_the_catalogues_under_a_tenth_of_c_with_normal_clearance(name):
    """L10 falls with the power 10/3 of the load, L10r with the power 4: they part by (C/P)^(2/3), 4.6 times under a tenth of C."""
    lives = statics(scene_from_yaml(yaml_of(name, NORMAL_CLEARANCE[BEARINGS[name][0]])), 40).lives
    assert lives.basic == lives.l10r and 1.0 < lives.l10r / lives.l10 < 2.25


@pytest.mark.parametrize("name", BEARINGS | LIGHT)
def test_the_life_of_iso_281_is_that_of_the_makers_c(name, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(yaml_of(name, 0.04))
    shown = json.loads(CliRunner().invoke(main, ["loads", str(path), "--set", "life.method=iso281", "--json"]).stdout)
    assert shown["life_hours"] == shown["l10_hours"] == pytest.approx(1e6 * 10 ** (10 / 3) / (60 * SPEED), rel=1e-9)
    assert shown["dynamic_rating"] == 1e3 * (BEARINGS | LIGHT)[name][5] and shown["life_method"] == "iso281"


def test_more_clearance_shortens_the_life_by_laminae_and_leaves_that_of_iso_281():
    tight, loose = (statics(scene_from_yaml(yaml_of("NU 210", clearance)), 40).lives for clearance in (0.0, 0.1))
    assert loose.l10r < 0.8 * tight.l10r and loose.l10 == tight.l10


def test_without_a_makers_rating_lives_take_the_one_of_the_standard():
    given, computed = (scene_from_yaml(yaml_of("NU 210", ratings=ratings)) for ratings in (True, False))
    assert rate(computed.bearing).dynamic == rate(given.bearing).computed.dynamic
    by_hand = (rate(computed.bearing).dynamic / 6610) ** (10 / 3) * 1e6 / (60 * SPEED)
    assert statics(computed, 40).lives.l10 == pytest.approx(by_hand, rel=1e-9)
