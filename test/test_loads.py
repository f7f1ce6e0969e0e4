# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the statics of a scene and the command that shows them."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.scene.loader import scene_to_yaml
from bearing_sim.studies.friction import compare
from bearing_sim.studies.statics import statics
from bearing_sim.sweep.point import run_until_settled

SPATIAL = ("level=spatial", "bearing.roller.crown=iso_log")


def found(*overrides, slices=40):
    return statics(load_scene("deng2017_table1", overrides), slices)


def loads(*arguments):
    return CliRunner().invoke(main, ["loads", *arguments])


def test_straight_rollers_in_line_have_the_basic_life_of_level_slip():
    sample = Simulation(load_scene("deng2017_table1", ["lubricant.traction_scale=5"])).advance(0.05)[-1]
    assert found().lives.basic == pytest.approx(float(sample["rating_life"]), rel=0.03)  # which slips a little there


def test_life_in_hours_falls_with_speed_and_is_endless_at_rest():
    assert math.isinf(found("operating.shaft_speed=0 rpm").lives.l10r)
    assert found("operating.shaft_speed=100 rpm").lives.basic > 100 * found().lives.basic
    nothing = found("operating.shaft_speed=0 rpm", "operating.radial_load=0 N", "bearing.outer_raceway.low_radius=34.9 mm")
    assert not nothing.inner.any() and math.isinf(nothing.lives.modified) and not any(np.isnan(nothing.ring))


MOTOR = {  # warms up by 20 K, at which its oil has half the viscosity
    "name": "motor",
    "level": "steady",
    "bearing": "NU 210/C3",
    "mounting": {"shaft": {"fit": "j6"}, "housing": {"fit": "H7"}},
    "lubricant": {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "40 degC"},
    "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
    "heat": {"law": "network", "ambient_temperature": "20 degC"},
    "life": {"a_iso": "bath_17_14"},
}


@pytest.mark.parametrize(
    "overrides",
    [
        pytest.param((), id="network"),
        pytest.param(("bearing.outer_raceway={lobes: 5, d_value: 60 um}",), id="lobed"),
        pytest.param(("heat={law: given, inner_ring: 70 degC, outer_ring: 60 degC}", "operating.load_angle=40 deg"), id="given"),
    ],
)
def test_loads_and_friction_are_those_of_a_run_at_the_same_temperatures(overrides):
    scene = load_scene(MOTOR, overrides)
    last, still, friction = run_until_settled(scene).window[-1], statics(scene, 40), compare(scene, "2")
    for name in NODE_OBSERVABLES:
        for value in (float(still.sample[0][name]), friction.temperatures[name]):
            assert value == pytest.approx(float(last[name]), abs=0.05, nan_ok=True)
    assert still.lives.viscosity_ratio == pytest.approx(float(last["viscosity_ratio"]), rel=2e-3)
    assert still.lives.lnmr == pytest.approx(float(last["lnmr"]), rel=0.01)  # it does not slip
    assert float(still.sample["running_clearance"][0]) == pytest.approx(float(last["running_clearance"]), abs=0.05e-6)
    assert friction.model == pytest.approx(float(last["shaft_power"]), rel=2e-3)


def test_where_there_is_no_equilibrium_the_commands_say_why(tmp_path):
    path = tmp_path / "hot.yaml"
    path.write_text(scene_to_yaml(load_scene(MOTOR, ["heat.limit=50 degC"])))
    for command in (["run"], ["loads"], ["study", "friction", "--series", "2"]):
        failed = CliRunner().invoke(main, [*command, str(path)])
        assert failed.exit_code == 1 and "no thermal equilibrium below the limit of 50 degC" in failed.stderr, command


@pytest.mark.parametrize(("bearing", "lobes", "d_value", "load"), [("N 1016/C4", 9, 60, 1600), ("NU 219", 7, 40, 800), ("NU 317", 7, 120, 5000)])
def test_lives_are_means_over_a_whole_pitch(bearing, lobes, d_value, load, monkeypatch):
    raceway = f"bearing.outer_raceway={{lobes: {lobes}, d_value: {d_value} um}}"
    scene = load_scene(MOTOR | {"bearing": bearing, "heat": {"law": "none"}}, [raceway, f"operating.radial_load={load} N"])
    by_error = statics(scene, 40).lives
    monkeypatch.setattr("bearing_sim.studies.statics._PITCH_POSITIONS", 640)
    by_many = statics(scene, 40).lives
    assert (by_error.l10r, by_error.lnmr) == pytest.approx((by_many.l10r, by_many.lnmr), rel=4e-3)


def test_misalignment_moves_pressure_up_and_life_down():
    cases = [found(*SPATIAL, f"operating.misalignment={tilt} mrad") for tilt in (0.0, 1.0, 2.0, 3.0)]
    for before, after in zip(cases, cases[1:]):
        assert after.inner_pressure > before.inner_pressure and after.lives.l10r < before.lives.l10r
        assert after.moment[0] > before.moment[0]


@pytest.mark.parametrize("azimuth", [0.0, 120.0])
def test_a_ring_held_at_the_tilt_that_a_moment_gives_bears_that_moment(azimuth):
    free = found(*SPATIAL, "operating.moment=0.6 N*m", f"operating.moment_angle={azimuth} deg")
    angle = math.degrees(free.tilt[1])
    held = found(*SPATIAL, f"operating.misalignment={free.tilt[0]}", f"operating.misalignment_angle={angle} deg")
    assert free.moment == pytest.approx((0.6, math.radians(azimuth)), rel=1e-6)
    assert held.moment == pytest.approx(free.moment, rel=1e-4, abs=1e-4)


def test_a_roller_on_the_side_to_which_the_end_leans_is_pressed_there():
    case = found(*SPATIAL, "operating.misalignment=1 mrad", "operating.misalignment_angle=0 deg")
    assert case.inner_slices[0, 20:].sum() > 1.3 * case.inner_slices[0, :20].sum() and 0.0 < case.tilts[0] < 1e-3


def test_the_scene_chooses_the_life_that_counts():
    whole, sliced = (found(*SPATIAL, f"life.method={method}").lives for method in ("deng2017", "iso16281"))
    assert whole.modified == whole.basic > sliced.basic and sliced.modified == sliced.basic == sliced.l10r
    dirty = found(*SPATIAL, "life.method=iso16281", "life.a_iso=bath_19_16", "life.reliability=99 %").lives
    assert dirty.modified == dirty.lnmr < 0.25 * sliced.l10r


def test_the_command_reports_what_statics_finds(tmp_path):
    picture = tmp_path / "loads.png"
    shown = loads("deng2017_table1", "--json", "--slices", "30", "--picture", str(picture))
    assert shown.exit_code == 0
    report, case = json.loads(shown.stdout), found(slices=30)
    assert report["inner_loads"] == pytest.approx(case.inner.tolist()) and report["l10r_hours"] == pytest.approx(case.lives.l10r)
    assert np.shape(report["outer_slice_loads"]) == (18, 30)
    assert picture.read_bytes().startswith(b"\x89PNG")
    text = loads("deng2017_table1", *(part for override in SPATIAL for part in ("--set", override))).stdout
    assert "3 of 18" in text and "L10r" in text and "nan" not in text.lower()


def test_the_command_tells_what_it_cannot_use():
    assert loads("nowhere").exit_code == 2
    refused = loads("deng2017_table1", "--set", "operating.moment=1 N*m")
    assert refused.exit_code == 2 and "needs level spatial" in refused.stderr
    assert loads("deng2017_table1", "--picture", "loads.gif").exit_code == 2
