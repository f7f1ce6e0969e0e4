# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Which level a scene needs, and which would do: one table for refusals and hints."""

import pytest
from click.testing import CliRunner

from bearing_sim import SceneError, load_scene
from bearing_sim.cli import run
from bearing_sim.levels.level import LEVELS as BUILT
from bearing_sim.scene.fidelity import EFFECTS, LEVELS, WANTS, Effect, asked_for, choose, hint, levels_with
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

ASKING = {
    "operating.moment": "1",
    "operating.misalignment": "1 mrad",
    "integration.fixed_step": "10 us",
    "lubricant.rolling_resistance": "hydrodynamic",
    "lubricant.supply": "oil_bath",
    "bearing.seals": "{law: constant_moment, moment: 0.1}",
    "bearing.cage.guidance": "full_complement",
    "bearing.flanges": "{outer: both}",
    "mounting.housing.backing": "{law: rigid_bore, play: 0 um}",
    "mounting.housing.backing.law": "free",
    "bearing.dimensions_at": "cold",
    "support.unbalance": "{amount: 1 g*mm}",
}
OVERRIDES = {field: f"{field}={value}" for field, value in ASKING.items()} | {f"wants.{name}": f"wants=[{name}]" for name in WANTS}
OVERRIDES["mounting.housing.backing.law"] = "mounting.housing.backing=free"


def scene(level, *overrides):
    return load_scene("deng2017_table1", [f"level={level}", *overrides])


def test_the_table_knows_every_level_and_its_fields_are_those_of_a_scene():
    assert set(LEVELS) == set(BUILT) == {level for effect in EFFECTS for level in effect.levels}
    assert [effect.field for effect in EFFECTS] == list(OVERRIDES)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.field)
@pytest.mark.parametrize("level", LEVELS)
def test_a_level_takes_an_effect_that_it_has_and_refuses_any_other_by_name(effect, level):
    override = OVERRIDES[effect.field]
    if level in effect.levels:
        assert asked_for(scene(level, override)) == [effect]
    else:
        with pytest.raises(SceneError, match=f"{effect.field}: .*needs level .*, .*; level {level} would ignore it"):
            scene(level, override)


def test_stock_scene_asks_for_nothing():
    assert asked_for(scene("slip")) == [] and levels_with([]) == list(LEVELS)
    assert levels_with([effect for effect in EFFECTS if effect.field == "operating.moment"]) == ["spatial"]


@pytest.mark.parametrize("override", [None, "lubricant.rolling_resistance=hydrodynamic", "bearing.dimensions_at=cold", "life.reliability=99 %"])
def test_a_spatial_scene_without_spatial_effects_gets_a_hint_to_level_planar(override):
    line = hint(scene("spatial", *([override] if override else [])))
    assert "nothing in the scene needs it" in line and "level planar computes the same" in line and "\n" not in line
    assert "misalignment" in line and "rolling" not in line


@pytest.mark.parametrize("field", ["operating.moment", "operating.misalignment"])
def test_a_scene_that_needs_its_level_hears_nothing(field):
    assert hint(scene("spatial", f"{field}={ASKING[field]}")) is None
    assert hint(scene("slip")) is None and hint(scene("planar")) is None


def test_a_run_says_the_hint_on_stderr_and_keeps_stdout_for_its_report():
    ran = CliRunner().invoke(run.run, ["deng2017_table1", "--level", "spatial", "--duration", "0.2 ms", "--json"])
    assert ran.exit_code == 0 and ran.stdout.startswith("{") and "level planar computes the same" in ran.stderr


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.field)
def test_auto_takes_the_lowest_level_with_everything_the_scene_asks_for_and_says_why(effect):
    chosen = scene("auto", OVERRIDES[effect.field])
    assert chosen.level == effect.levels[0]
    line = hint(chosen)
    assert line.startswith(f"level {chosen.level} chosen")
    assert "\n" not in line
    assert (effect.field in line) == (effect.levels != LEVELS)


def test_auto_with_several_wants_takes_the_level_that_has_them_all():
    assert scene("auto", "wants=[slip, cage_orbit, life]").level == "planar"
    assert scene("auto", "wants=[cage_orbit]", "operating.moment=1").level == "spatial"


def test_auto_reports_all_errors_of_a_scene_as_any_level_does():
    with pytest.raises(SceneError) as caught:
        scene("auto", "wants=[ring_bending]", "operating.shaft_speed=fast")
    assert {each.path for each in caught.value.errors} == {"wants.0", "operating.shaft_speed"}
    assert "expected 'slip', 'life'" in str(caught.value)


def test_what_no_single_level_has_is_an_error_that_names_who_has_what(monkeypatch):
    stock = scene("slip")
    rival = (Effect("wants.a", ("slip",), "", lambda scene: True), Effect("wants.b", ("planar", "spatial"), "", lambda scene: True))
    with monkeypatch.context() as patched:
        patched.setattr("bearing_sim.scene.fidelity.EFFECTS", rival)
        found = choose(stock)
    assert found == (None, "no level has all of wants.a (slip); wants.b (planar, spatial)")
    monkeypatch.setattr("bearing_sim.scene.loader.choose", lambda scene: found)
    with pytest.raises(SceneError, match=r"level = 'auto': no level has all of wants.a \(slip\); wants.b"):
        scene("auto")


def test_the_choice_is_kept_in_a_recorded_scene_and_dropped_with_the_level():
    chosen = scene("auto", "wants=[cage_orbit]")
    assert scene_from_yaml(scene_to_yaml(chosen)) == chosen
    assert "chosen" not in hint(scene_from_yaml(scene_to_yaml(chosen), ["level=spatial"]))


def test_run_says_in_one_line_what_it_chose():
    ran = CliRunner().invoke(run.run, ["deng2017_table1", "--level", "auto", "--set", "wants=[cage_orbit]", "--duration", "0.2 ms", "--json"])
    assert ran.exit_code == 0
    assert "level planar chosen, the lowest with everything that the scene asks for (wants.cage_orbit: whose cage whirls)" in ran.stderr
