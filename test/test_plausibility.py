# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the plausibility of scenes: what looks like a slip of the pen is named with its value, what was expected and what to do."""

import dataclasses
import json
import math

import pytest
from click.testing import CliRunner
from test_validity import GEARBOX, MOTOR

from bearing_sim.cli.main import main
from bearing_sim.messages.events import Level
from bearing_sim.model.plausibility import minimum_load, plausibility
from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.scene.loader import load_scene, scene_from_yaml
from bearing_sim.scene.ratings import rate

PAPER = "deng2017_table1"


def motor(*overrides):
    return scene_from_yaml(MOTOR, list(overrides), origin="motor")


@pytest.mark.parametrize("scene", [load_scene(PAPER), load_scene("deng2017_table2"), motor(), scene_from_yaml(GEARBOX, [], origin="gearbox")])
def test_bearings_as_they_are_built_are_plausible(scene):
    assert plausibility(scene) == []


@pytest.mark.parametrize(
    "overrides, field, value, expected",
    [
        (["bearing.cage.mass=2 kg"], "bearing.cage.mass", "2,000 g", "polyamide to brass"),
        (["bearing.cage.mass=0.5 g"], "bearing.cage.mass", "0.5 g", "polyamide to brass"),
        (["bearing.inner_raceway.ring_mass=20 kg"], "bearing.inner_raceway.ring_mass", "20,000 g", "by raceway, bore and roller length"),
        (["bearing.inner_raceway.ring_mass=5 g"], "bearing.inner_raceway.ring_mass", "5 g", "by raceway, bore and roller length"),
        (
            ["bearing.dimensions_at=running", "bearing.inner_raceway.bore_radius=null", "bearing.inner_raceway.ring_mass=1 g"],
            "bearing.inner_raceway.ring_mass",
            "1 g",
            "expected",
        ),
        (["bearing.roller.count=5"], "bearing.roller", "24.8 %", "40 to 97 %"),
        (["bearing.outer_raceway.low_radius=40.9 mm"], "bearing", "300 um", "at most 125 um, class C5"),
        (["bearing.outer_raceway.low_radius=40.72 mm"], "bearing", "60 um", "of a round raceway"),
        (["bearing.outer_raceway.d_value=1 mm", "bearing.outer_raceway.lobes=3"], "bearing.outer_raceway.d_value", "1,000 um", "0.5 % of the pitch"),
        (["bearing.outer_raceway.d_value=50 um", "bearing.outer_raceway.lobes=3"], "bearing.outer_raceway.d_value", "50 um", "do not press rollers"),
        (["bearing.cage.guide_radius=40 mm", "bearing.cage.inner_radius=36 mm"], "bearing.cage", "36 to 39.7 mm", "the pitch radius between"),
        (["bearing.ratings.dynamic=150 kN"], "bearing.ratings.dynamic", "150,000 N", "0.65 to 1.5 times"),
        (["bearing.ratings.static=73.5"], "bearing.ratings.static", "73.5 N", "check its unit"),
        (["bearing.ratings.fatigue_limit=70 N"], "bearing.ratings.fatigue_limit", "70 N", "0.4 to 2.5 times"),
        (["bearing.ratings.limiting_speed=2000 rpm"], "limiting_speed", "3,000 rpm", "at most 2,000 rpm"),
        (["operating.radial_load=1 kN"], "operating.radial_load", "1,000 N", "expect slip"),
        (["operating.shaft_speed=50000 rpm"], "speed_factor", "3,525,000 rpm mm", "at most 3,000,000 rpm mm"),
        (["lubricant.temperature=210 degC"], "oil_temperature", "210 °C", "37.85 to 204.9 °C"),
    ],
)
def test_a_slip_of_the_pen_is_named(overrides, field, value, expected):
    found = plausibility(motor(*overrides))
    assert len(found) == 1, found
    assert found[0].startswith(f"{field}: ") and value in found[0] and expected in found[0] and "; expected " in found[0]


def test_lobes_within_their_preload_leave_no_roller_free():
    overrides = ["bearing.outer_raceway.low_radius=40.735 mm", "bearing.outer_raceway.d_value=10 um", "bearing.outer_raceway.lobes=3"]
    (found,) = plausibility(motor(*overrides))
    assert "no roller is free between lobes" in found and "15.08 um" in found, "of which 0.08 um by rotation"


def test_the_minimum_load_is_that_of_the_makers():
    """k_r 150 N (LYC for series 2), n_r 9000 rpm, d_m 70.5 mm: 0.15 (6 + 4/3) 0.705^2 kN."""
    given = motor("bearing.ratings.minimum_load_factor=150 N", "bearing.ratings.reference_speed=9000 rpm")
    assert minimum_load(given)[0] == pytest.approx(150.0 * (6 + 4 * 3000 / 9000) * (0.705**2), rel=1e-4) == pytest.approx(546.7, abs=0.1)
    unknown = motor()
    assert minimum_load(unknown)[0] == pytest.approx(0.02 * rate(unknown.bearing).dynamic) == pytest.approx(1412, abs=2)


def test_a_preloaded_bearing_and_one_at_rest_need_no_minimum_load():
    light = ["operating.radial_load=100 N"]
    assert any("expect slip" in each for each in plausibility(motor(*light)))
    assert plausibility(motor(*light, "operating.shaft_speed=0 rpm")) == []
    assert plausibility(motor(*light, "bearing.outer_raceway.low_radius=40.748 mm")) == []


def test_a_bore_that_is_not_given_is_estimated_and_said():
    scene = motor("bearing.dimensions_at=running", "bearing.inner_raceway.bore_radius=null", "bearing.outer_raceway.low_radius=40.9 mm")
    (found,) = plausibility(scene)
    assert "estimated from the inner raceway" in found


def test_a_makers_limiting_speed_changes_nothing_else_of_a_scene():
    with_limits = motor("bearing.ratings.limiting_speed=9000 rpm")
    plain = dataclasses.replace(with_limits, bearing=dataclasses.replace(with_limits.bearing, ratings=motor().bearing.ratings))
    assert plain == motor()


def test_the_node_tells_once_what_is_implausible():
    scene, start = load_scene(PAPER, ["bearing.cage.mass=5 kg"]), 1_700_000_000_000_000_000
    live = LiveModel(scene, warmed_up(scene), start)
    news = [event for after in (0, 1, 2) for event in live.collect(start + after * 10**9)]
    live.close()
    (told,) = [event for event in news if event.kind == "scene.implausible"]
    assert told.level is Level.WARN and told.subject == "bearing.cage.mass" and told.reason.startswith("5,000 g for about ")


@pytest.mark.long
@pytest.mark.parametrize("command", [["run", "--duration", "0.01"], ["loads"], ["uncertainty", "--samples", "2", "--level", "slip"]])
def test_commands_print_what_is_implausible_and_go_on(command, tmp_path):
    name, *options = command
    overrides = ["--set", "bearing.cage.mass=5 kg"]
    result = CliRunner().invoke(main, [name, PAPER, *options, *overrides, "--json"])
    assert result.exit_code == 0, result.output
    assert "warning: bearing.cage.mass: 5,000 g for about " in result.stderr
    if name != "uncertainty":
        (found,) = json.loads(result.stdout)["implausible"]
        assert found.startswith("bearing.cage.mass: ")


def test_the_mass_of_a_cage_is_judged_by_a_ring_less_its_pockets():
    found = plausibility(motor("bearing.cage.mass=2 kg"))
    # 33.5 to 37.7 mm by 14 mm, less 16 pockets of 11 mm and twice the pockets' clearance by 12 mm by the thickness of the ring
    cage = motor().bearing.cage
    inside, outside, pocket = 33.5e-3, 37.7e-3, 11e-3 + 2 * cage.pocket_clearance
    volume = math.pi * (outside**2 - inside**2) * 14e-3 - 16 * pocket * 12e-3 * (outside - inside)
    assert f"for about {1e6 * volume:.3g} cm^3" in found[0], found


def test_a_machine_slower_than_the_speed_from_which_slip_counts_is_told_so():
    (finding,) = [each for each in plausibility(motor("operating.shaft_speed=11 rpm")) if "slip_from_speed" in each]
    assert "191 rpm" in finding and "11 rpm" in finding
    assert not [each for each in plausibility(motor("operating.shaft_speed=11 rpm", "thresholds.slip_from_speed=5 rpm")) if "slip_from" in each]
