"""Which level a scene needs, and which would do: one table for refusals and hints."""

import pytest
from click.testing import CliRunner

from bearing_sim import SceneError, load_scene
from bearing_sim.commands import run
from bearing_sim.effects import EFFECTS, LEVELS, asked_for, hint, levels_with
from bearing_sim.levels.level import LEVELS as BUILT

ASKING = {
    "bearing.roller.crown": "iso_log",
    "operating.moment": "1",
    "operating.misalignment": "1 mrad",
    "life.lamina": "true",
    "lubricant.pumping": "true",
    "bearing.ring_growth.centrifugal": "true",
    "bearing.ring_growth.thermal": "true",
}


def scene(level, *overrides):
    return load_scene("deng2017_table1", [f"level={level}", *overrides])


def test_the_table_knows_every_level_and_its_fields_are_those_of_a_scene():
    assert set(LEVELS) == set(BUILT) == {level for effect in EFFECTS for level in effect.levels}
    assert [effect.field for effect in EFFECTS] == list(ASKING)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.field)
@pytest.mark.parametrize("level", LEVELS)
def test_a_level_takes_an_effect_that_it_has_and_refuses_any_other_by_name(effect, level):
    override = f"{effect.field}={ASKING[effect.field]}"
    if level in effect.levels:
        assert asked_for(scene(level, override)) == [effect]
    else:
        with pytest.raises(SceneError, match=f"{effect.field}: .*needs level spatial, .*; level {level} would ignore it"):
            scene(level, override)


def test_stock_scene_asks_for_nothing():
    assert asked_for(scene("slip")) == [] and levels_with([]) == list(LEVELS)
    assert levels_with([effect for effect in EFFECTS if effect.field == "life.lamina"]) == ["spatial"]


@pytest.mark.parametrize("override", [None, "lubricant.pumping=true", "bearing.ring_growth.thermal=true", "life.reliability=99 %"])
def test_a_spatial_scene_without_anything_spatial_is_told_of_level_planar(override):
    line = hint(scene("spatial", *([override] if override else [])))
    assert "nothing that needs it" in line and "level planar computes the same" in line and "\n" not in line
    assert "misalignment" in line and "pumping" not in line


@pytest.mark.parametrize("field", ["bearing.roller.crown", "operating.moment", "operating.misalignment", "life.lamina"])
def test_a_scene_that_needs_its_level_hears_nothing(field):
    assert hint(scene("spatial", f"{field}={ASKING[field]}")) is None
    assert hint(scene("slip")) is None and hint(scene("planar")) is None


def test_a_run_says_the_hint_on_stderr_and_keeps_stdout_for_its_report():
    ran = CliRunner().invoke(run.command, ["deng2017_table1", "--level", "spatial", "--duration", "0.2 ms", "--json"])
    assert ran.exit_code == 0 and ran.stdout.startswith("{") and "level planar computes the same" in ran.stderr
