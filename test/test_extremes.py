# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The study of extremes: its scenes, its judgement, and the causes of failure that it found, each kept repaired."""

import csv
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from validation.__main__ import main as validation
from validation.extremes import counted, kinds_of_reason
from validation.extremes_cases import BEARING, DIMENSIONS, at_stock, oil_of, sampled_cases
from validation.extremes_long import long_run
from validation.extremes_run import run_case

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.planar.state import ROLLER, ROLLERS
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.traction import traction
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.simulation import scene_inputs
from bearing_sim.studies import extreme_run
from bearing_sim.studies.extreme_run import FAILED, FINISHED, REFUSED, STEP_LIMITED, TURNS, Case, course_segments, energy_gap
from bearing_sim.studies.extremes import variants
from bearing_sim.sweep.settling import cage_turn


def case(*overrides, level="slip", course="steady", seconds=1e-3):
    return Case("a case", level, (f"level={level}", *overrides), course, {}, seconds)


def refusal(*overrides):
    with pytest.raises(SceneError) as reported:
        load_scene(BEARING, overrides)
    return str(reported.value)


def test_the_hypercube_fills_every_dimension_evenly_and_again_the_same():
    cases = sampled_cases("slip", 40, 3)
    assert cases == sampled_cases("slip", 40, 3)
    rollers = sorted(case.point["rollers"] for case in cases)
    assert all(DIMENSIONS["rollers"](k / 40) <= count <= DIMENSIONS["rollers"]((k + 1) / 40) for k, count in enumerate(rollers))
    speeds = np.sort([case.point["shaft_speed_rpm"] for case in cases])
    assert (np.abs(speeds - np.linspace(-97_500, 97_500, 40)) <= 5_001).all()
    assert {case.course for case in cases} >= {"steady", "reversal", "stop", "start", "load_step", "ripple"}
    assert "misalignment" not in cases[0].point and "misalignment" in sampled_cases("spatial", 1, 0)[0].point


@pytest.mark.parametrize("course", ["steady", "reversal", "stop", "start", "load_step", "ripple"])
def test_courses_last_as_long_as_asked_and_go_where_their_names_say(course):
    inputs = scene_inputs(load_scene(BEARING))
    segments = list(course_segments(course, 10e-3, inputs))
    assert math.fsum(segment.duration for segment in segments) == pytest.approx(10e-3) and len(segments) > 12
    speeds, loads = ([getattr(segment.inputs, name) for segment in segments] for name in ("shaft_speed", "load_y"))
    full, load = inputs.shaft_speed, inputs.load_y
    expected = {
        "steady": (full, full, load, load),
        "reversal": (full, -full, load, load),
        "stop": (full, 0.0, load, load),
        "start": (0.0, full, load, load),
        "load_step": (full, full, 0.0, 0.0),
        "ripple": (full, full, load, load),
    }[course]
    assert (speeds[0], speeds[-1], loads[0]) == pytest.approx(expected[:3]) and loads[-1] == pytest.approx(expected[3])
    if course == "ripple":
        assert max(loads) == pytest.approx(1.9 * load) and min(loads) == pytest.approx(0.1 * load) and len(segments) == 81
    if course == "load_step":
        assert max(loads) == load and min(segment.duration for segment in segments[1:]) == pytest.approx(1e-6)


def test_a_stock_case_finishes_and_counts_its_work():
    outcome = run_case(case())
    assert outcome.status == FINISHED and outcome.reason == "" and outcome.simulated == pytest.approx(1e-3)
    assert outcome.steps > 10 and outcome.right_hand_sides >= 2 * outcome.steps and outcome.steps_per_ms >= outcome.steps and outcome.step_us > 0


def test_a_scene_that_cannot_be_is_refused_with_the_bound_it_broke():
    outcome = run_case(case("operating.radial_load=-1 N", "bearing.roller.count=2"))
    assert outcome.status == REFUSED and outcome.steps == 0
    assert "operating.radial_load" in outcome.reason and "outside 0 N to 1e+08 N" in outcome.reason
    found = "bearing: cage.guide_radius: 35 mm puts it outside; expected less than low_radius, 34 mm; cage.pocket_clearance: 2 mm leaves no bar"
    assert kinds_of_reason(found) == ["cage.guide_radius", "cage.pocket_clearance"]
    assert kinds_of_reason("fixed step divided, step budget: 20 steps last for 3 s") == ["fixed step divided", "step budget"]
    assert kinds_of_reason(outcome.reason) == ["bearing.roller.count", "operating.radial_load"]


def test_a_tight_tolerance_exhausts_its_steps_and_is_step_limited_and_a_loose_one_is_too_slow(monkeypatch):
    monkeypatch.setattr("validation.extremes_run._step_budget", lambda scene: 20)
    assert run_case(case(*tolerance_overrides(1e-6))).status == STEP_LIMITED
    outcome = run_case(case(*tolerance_overrides(0.2)))
    assert outcome.status == FAILED and outcome.reason.startswith("too slow: 20 steps last for ")


@pytest.mark.parametrize(
    ("column", "value", "reported"),
    [
        ("inner_load", -1.0, "inner_load = -1 N pulls"),
        ("ring_y", math.nan, "ring_y = nan"),
        ("rating_life", math.nan, "rating_life = nan"),
        ("churning_power", -5.0, "churning_power = -5 W is a gain"),
        ("cage_slip", -0.06, "cage slip -6 % in steady drive"),
    ],
)
def test_what_no_bearing_can_do_is_a_failure(monkeypatch, column, value, reported):
    advance = Simulation.advance

    def spoiled(self, *arguments):
        block = advance(self, *arguments)
        block[column] = value
        return block

    monkeypatch.setattr(Simulation, "advance", spoiled)
    outcome = run_case(case())
    assert outcome.status == FAILED and outcome.reason == reported


def test_a_life_that_rises_with_load_is_a_failure(monkeypatch):
    reset = Simulation.reset

    def spoiled(self, *arguments, **named):
        reset(self, *arguments, **named)
        self.sample["rating_life"] = math.hypot(self.inputs.load_y, self.inputs.load_z)

    monkeypatch.setattr(Simulation, "reset", spoiled)
    assert run_case(case()).reason.startswith("life rises with load: ")


def test_an_exception_is_a_failure_that_tells_what_it_was(monkeypatch):
    monkeypatch.setattr(Simulation, "advance", lambda *arguments: 1 / 0)
    assert run_case(case()).reason == "ZeroDivisionError: division by zero"


def test_the_command_writes_totals_a_table_and_a_picture(tmp_path, monkeypatch):
    corners = [case(), case("bearing.roller.count=2")._replace(name="another")]
    monkeypatch.setattr("validation.extremes.corner_cases", lambda level: corners)
    table, picture = tmp_path / "map.csv", tmp_path / "map.png"
    result = CliRunner().invoke(
        validation,
        ["extremes", "--samples", "3", "--seed", "2", "--level", "slip", "--no-long", "--workers", "1", "--json"]
        + ["--out", str(table), "--picture", str(picture)],
    )
    report = json.loads(result.stdout)
    assert result.exit_code == (1 if report["failed"] else 0)
    assert sum(report[name] for name in ("finished", "step_limited", "refused", "failed")) == 5 and report["failed"] == 0
    assert report["step_limited"] == 1 and report["levels"]["slip"]["step_limited_at_stock"] == {"finished": 1}
    assert report["levels"]["slip"]["refused_by"]["bearing.roller.count"] == 1
    rows = list(csv.DictReader(table.open()))
    assert len(rows) == 5 and rows[0]["status"] == "finished" and "--set 'bearing.roller.count=2'" in rows[1]["overrides"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_command_takes_any_scene_and_every_run_can_be_repeated(tmp_path):
    table, picture = tmp_path / "map.csv", tmp_path / "map.png"
    arguments = ["study", "extremes", "nu215_rig", "--samples", "3", "--workers", "1", "--json", "--out", str(table), "--picture", str(picture)]
    result = CliRunner().invoke(main, arguments)
    report = json.loads(result.stdout)
    assert result.exit_code == (1 if report["failed"] else 0)
    assert sum(report[name] for name in ("finished", "step_limited", "refused", "failed")) == 3 == len(list(csv.DictReader(table.open())))
    assert picture.read_bytes().startswith(b"\x89PNG")
    for case in variants("nu215_rig", [], 5, 1):
        scene = load_scene("nu215_rig", case.overrides)
        assert scene.operating.shaft_speed == case.point["operating.shaft_speed"]
    speeds = [case.point["operating.shaft_speed"] for case in variants("nu215_rig", [], 200, 1)]
    assert min(speeds) < 0.0 < max(speeds) and 0.0 in speeds


def run_at_stock(tried):
    return extreme_run.run_case(at_stock(tried))


def test_at_stock_settings_a_scene_turns_its_cage_50_times_or_settles_and_keeps_its_books():
    tight = case(*tolerance_overrides(1e-8), "integration.maximum_step=1e-7", "operating.radial_load=50 kN", level="planar")
    assert not any("integration" in override for override in at_stock(tight).overrides)
    outcome = run_at_stock(tight)
    assert outcome.status == FINISHED and (outcome.settled or outcome.turns >= TURNS) and outcome.turns > 15.0
    assert abs(outcome.books) < 0.003 + 3 * outcome.books_error


def test_settings_of_the_integration_count_unless_a_case_is_run_at_stock():
    tight = case("integration.step_budget=20")
    assert extreme_run.run_case(tight).status == STEP_LIMITED and run_at_stock(tight).status == FINISHED
    assert "case" not in extreme_run.outcome_fields(tight)
    assert [each for each in variants("nu215_rig", ["integration.step_budget=20"], 1, 0)[0].overrides if each.startswith("integration.")]


@pytest.mark.parametrize("course", ["start", "stop", "reversal", "load_step"])
def test_a_course_at_stock_settings_lasts_for_50_turns_of_an_ideal_cage(course):
    outcome = run_at_stock(case(level="slip", course=course))
    assert outcome.status == FINISHED and outcome.turns > 0.7 * TURNS and (outcome.settled or outcome.turns >= TURNS)
    assert math.isnan(outcome.books) == (course == "stop")


def test_a_cage_that_hardly_turns_and_wanders_is_waited_for_until_it_has_turned_50_times(monkeypatch):
    monkeypatch.setattr("bearing_sim.sweep.settling.has_settled", lambda *arguments: False)
    braked = case("operating.radial_load=10 N", "bearing.outer_raceway.d_value=0 mm", "bearing.outer_raceway.low_radius=34.9 mm")
    outcome = run_at_stock(braked)
    turns_of_an_ideal_cage = outcome.simulated / cage_turn(load_scene(BEARING, braked.overrides))
    assert outcome.status == FINISHED and not outcome.settled and outcome.turns >= TURNS and turns_of_an_ideal_cage > 2.0 * TURNS


def test_a_run_at_stock_settings_says_what_limited_refused_or_broke_it(monkeypatch):
    assert run_at_stock(case("bearing.roller.count=2")).reason.startswith("bearing.roller.count = 2: ")
    with monkeypatch.context() as impatient:
        impatient.setattr("bearing_sim.studies.extreme_run.PATIENCE", 0.0)
        limited = run_at_stock(case())
    assert limited.status == STEP_LIMITED and limited.reason.startswith("core time: 0 s last for ")
    monkeypatch.setattr(Simulation, "advance", lambda *arguments, **named: 1 / 0)
    assert run_at_stock(case()).reason == "ZeroDivisionError: division by zero"


def test_the_books_of_energy_miss_what_is_taken_from_a_loss():
    run = Simulation(load_scene(BEARING, ["level=slip"]))
    run.advance(0.1)
    block = run.advance(0.02, samples=400)
    off, error = energy_gap(block, run)
    assert abs(off) < 0.002 and error < 0.01
    block["churning_power"] -= 0.05 * block["shaft_power"].mean()
    assert energy_gap(block, run)[0] == pytest.approx(off + 0.05, abs=1e-3)


def test_the_night_gives_one_table_and_resumes(tmp_path, monkeypatch):
    monkeypatch.setattr("validation.nightly.corner_cases", lambda level: [case(), case("bearing.roller.count=2")])
    monkeypatch.setattr("validation.nightly.LONG_RUNS", {"slip": ((15_000.0, 2.0),)})
    options = "--level slip --samples 9 --first 2 --workers 1".split()
    arguments = ["nightly", *options, "--journal", str(tmp_path / "night.journal")]
    result = CliRunner().invoke(validation, [*arguments, "--json", "--out", str(tmp_path / "night.csv")])
    report = json.loads(result.stdout)
    assert [(row["runs"], sum(row["counts"].values())) for row in report["rows"]] == [
        ("scenes", 2),
        ("corners", 2),
        ("corners with their own settings", 2),
        ("2 s at 15000 rpm", 1),
    ]
    assert result.exit_code == 0 and report["rows"][1]["counts"] == {"finished": 1, "step_limited": 0, "refused": 1, "failed": 0}
    assert report["rows"][1]["books"]["number"] == 1 and report["rows"][3]["books"]["largest"] < 0.005
    rows = list(csv.DictReader((tmp_path / "night.csv").open()))
    assert len(rows) == 6 and {row["program"] for row in rows} == {report["program"]} and {row["seed"] for row in rows} == {"0"}
    monkeypatch.setattr("bearing_sim.studies.extreme_run.run_case", lambda case: 1 / 0)  # nothing runs again
    again = CliRunner().invoke(validation, arguments)
    assert again.exit_code == 0 and "slip, corners: 1 refused: bearing.roller.count" in again.output


# What the study found, and its repairs


@pytest.mark.parametrize(
    ("override", "reported"),
    [
        (
            "bearing.cage.pocket_clearance=2 mm",
            "cage.pocket_clearance: 2 mm leaves no bar between the pockets of 18 rollers of 7 mm; expected less than 1.97",
        ),
        ("bearing.cage.guide_clearance=3 um", "cage.guide_clearance: 3 um is no more than cage.land_film"),
        ("bearing.cage.guide_radius=35 mm", "cage.guide_radius: 35 mm puts the guide lands outside the raceway; expected less than"),
        (
            "integration.fixed_step=1 ms",
            "integration.fixed_step: 1000 us is 6 roller pitches of the cage at 45000 rpm; expected at most half a pitch",
        ),
    ],
)
def test_scenes_without_sense_are_refused_before_they_start(override, reported):
    assert reported in refusal(override, "level=spatial")


def test_a_fixed_step_may_be_long_where_the_shaft_is_slow():
    load_scene(BEARING, ["integration.fixed_step=1 ms", "operating.shaft_speed=1000 rpm"])


def test_a_ring_finds_its_place_across_a_wide_play():
    # 44 rollers, 0.9 mm loose, under next to no load, and the search begins 2 mm away: it rolls from roller to roller
    scene = load_scene(
        BEARING, ["bearing.roller={count: 27, diameter: 7 mm, length: 7 mm}", "bearing.outer_raceway={low_radius: 35.775 mm, d_value: 0.27 mm}"]
    )
    params = pack(scene)
    for number, place in enumerate(np.random.default_rng(0).normal(scale=1.5e-3, size=(300, 2))):
        work = slip_state.new_work(params)
        work.ring[:] = place
        load = 0.9 * np.array([math.cos(number), math.sin(number)])
        assert balance_loads(0.1 * number, 500.0, *load, params, work), place
        carried = [(work.loads[LOAD.inner] * work.loads[row]).sum() for row in (LOAD.cosine, LOAD.sine)]
        np.testing.assert_allclose(carried, load - 1e3 * work.ring, atol=1e-3)


@pytest.mark.parametrize("viscosity", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("load", [10.0, 2e4])
def test_an_eyring_film_is_never_stiffer_than_the_surfaces_creep(viscosity, load):
    # Carter 1926: mu = (pi/8) E'/p of the slide-to-roll ratio while little slips, p the mean pressure
    scene = load_scene(BEARING, ["lubricant.traction.law=eyring", oil_of(viscosity, 393.15)])
    params = pack(scene)
    lubrication = lubricate(scene.lubricant, params, scene.lubricant.temperature)
    raceways, length, rolling = params.raceways, params.rollers.length, 20.0
    pressure = math.sqrt(math.pi * raceways.reduced_modulus * load / (32 * raceways.inner_curvature_radius * length))
    stiffest = load * math.pi * raceways.reduced_modulus / (8 * pressure * rolling)
    contacts = np.zeros((2, len(CONTACT), LANES))
    slides = np.geomspace(1e-12, 10.0, LANES)
    contacts[:, CONTACT.load], contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding] = load, rolling, slides
    traction(contacts, lubrication.inner, lubrication.outer, FULL_FILMS)
    assert (contacts[0, CONTACT.d_sliding] <= 1.001 * stiffest).all()
    assert (contacts[0, CONTACT.force] <= 1.001 * stiffest * slides).all()
    if viscosity == 1.0 and load == 2e4:  # solid: all of the sliding is creep
        assert contacts[0, CONTACT.d_sliding, 0] == pytest.approx(stiffest, rel=0.01)


def test_a_fixed_step_gets_over_rollers_that_go_from_sliding_one_way_to_the_other():
    # A thick Eyring film lets go of all sliding at a thousandth of the rolling speed: plain Newton corrections go to and fro for ever.
    overrides = [
        "integration.fixed_step=50 us",
        "operating.shaft_speed=-12000 rpm",
        "operating.radial_load=16 kN",
        "lubricant.rolling_resistance=hydrodynamic",
    ]
    overrides += ["bearing.outer_raceway={low_radius: 34.853 mm, d_value: 0}", "lubricant.traction.law=eyring", oil_of(0.5, 335.0)]
    outcome = run_case(case(*overrides, "lubricant.temperature=335 K", "bearing.cage.pocket_clearance=15 um", level="planar", course="ripple"))
    assert outcome.status in (FINISHED, STEP_LIMITED), outcome.reason


def test_the_mixture_never_drives_a_roller():
    # Its drag is linear in what a roller is slower than the cage, and a line goes through zero at about half the speed.
    run = Simulation(load_scene(BEARING, ["level=planar"]))
    state, count = run.state, run.scene.bearing.roller.count
    orbital_speeds = state[ROLLERS + 3 * count : ROLLERS + 4 * count]
    orbital_speeds[:] = np.linspace(-2000.0, 2000.0, count)
    planar.rhs(0.0, state, run._model(run.inputs, 1.0), run._work, np.zeros_like(state))
    drags = run._work.rollers[:, ROLLER.churning, :].ravel()[:count]
    slow = (orbital_speeds > 0.0) & (orbital_speeds < 800.0)
    assert (drags * orbital_speeds >= 0.0).all() and (drags[slow] == 0.0).all() and slow.sum() == 3 and drags[0] < 0.0 < drags[-1]


def test_a_long_run_drifts_in_nothing():
    found = long_run("slip", 15_000.0, 1.0)
    assert found.failure == "" and found.simulated == pytest.approx(1.0)
    assert abs(found.shaft_angle_error) < 1e-12 and abs(found.slip_drift) < 1e-4 and abs(found.damage_drift) < 1e-3 and found.cage_slip > 0.0


@pytest.mark.parametrize(("column", "unit", "drift"), [("churning_power", "shaft_power", "energy_drift"), ("cage_slip", None, "slip_drift")])
def test_what_changes_by_5_percent_in_the_second_half_of_a_long_run_is_reported_as_that_drift(monkeypatch, column, unit, drift):
    advance = Simulation.advance

    def changed(self, *arguments, **options):
        block = advance(self, *arguments, **options)
        if self.time > 0.5:  # loses less than its shaft puts in, or slips more
            block[column] += 0.05 if unit is None else -0.05 * block[unit]
        return block

    monkeypatch.setattr(Simulation, "advance", changed)
    found = long_run("slip", 15_000.0, 1.0)
    assert getattr(found, drift) == pytest.approx(0.05, rel=0.03), "settling takes the rest"
    assert found.failure.startswith(f"drift: {drift} {getattr(found, drift):.3g}")


def test_a_failure_is_counted_once_without_its_numbers():
    class Failed:
        status = FAILED
        reason = "the equations could not be solved, not even for the smallest step between 0 and 0.01 s (shaft 67 rad/s, load 19 N); kept"

    assert counted([Failed, Failed], FAILED) == {"the equations could not be solved, not even for the smallest step between 0 and 0.01 s": 2}
