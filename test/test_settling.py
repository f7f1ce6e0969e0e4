# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Settled means settled: the criterion against courses whose ends are known, runs of slow bearings, and what the command says of them."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from random_bearings import agrees, examine, scenes

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.recording.reader import Recording
from bearing_sim.sweep.point import point_row, run_until_settled
from bearing_sim.sweep.settling import (
    DRIFTING,
    LIMIT_CYCLE,
    LONGEST,
    SHORTEST_TURNS,
    WANDERING,
    Course,
    Observed,
    Tolerance,
    advance_in_calls,
    advance_until_settled,
    cage_turn,
    describe,
    has_settled,
    longest_run,
    sampled,
    shortest_run,
    trends,
)

SPEED, LOAD = "operating.shaft_speed", "operating.radial_load"
ALLOWED = Tolerance(5e-4, 0.0)  # as of slip
SLIP = Observed("cage_slip", "cage slip", lambda slip: 100.0 * slip, "%", "points", ALLOWED)
SLOW = """
name: nu232
level: slip
bearing:
  name: NU 232
  source: dimensions of a catalogue bearing, cage in proportion
  roller: {count: 17, diameter: 38 mm, length: 38 mm}
  inner_raceway: {radius: 97.5 mm, ring_mass: 6 kg, bore_radius: 80 mm}
  outer_raceway: {low_radius: 135.55 mm, d_value: 0 mm}
  cage: {guidance: outer_ring, mass: 4 kg, width: 46 mm, inner_radius: 106 mm, guide_radius: 128 mm, guide_clearance: 0.6 mm,
    guide_land_width: 8 mm, pocket_clearance: 0.3 mm}
lubricant: {oil: {law: custom, viscosity_40: 320 mm^2/s, viscosity_100: 24 mm^2/s, density: 890 kg/m^3, expansion: 6.5e-4,
    pressure_viscosity: 22 1/GPa, thermal_conductivity: 0.14},
  temperature: 60 degC, mixture_fraction: 0.2, rolling_resistance: none, traction: {law: oil_4109}}
operating: {shaft_speed: 1650 rpm, radial_load: 500 N}
"""


@pytest.fixture
def slow(tmp_path):
    path = tmp_path / "nu232.yaml"
    path.write_text(SLOW)
    return path


def course(value, length, turn=0.01, samples=1000):
    """A course of one observable from its integral over time, with a cage that turns evenly."""
    times = np.linspace(0.0, length, samples + 1)
    return Course(times, times / turn, value(times)[:, None])


def approach(limit, constant):
    """Integral of an exponential approach from 0."""
    return lambda t: limit * (t + constant * np.expm1(-t / constant))


def oscillation(mean, amplitude, period, phase=0.7):
    """Integral of a sine about a mean."""
    return lambda t: mean * t - amplitude * period / math.tau * (np.cos(math.tau * t / period + phase) - math.cos(phase))


@pytest.mark.parametrize("limit", [0.0005, 0.02, 0.2, 0.9])
@pytest.mark.parametrize("constant", [0.01, 1.0, 100.0])
def test_an_exponential_approach_is_recognised_as_unsettled_until_its_error_is_below_the_tolerance(limit, constant):
    length, settled = 0.5, False
    while not settled and length < 1e5:
        settled = has_settled(course(approach(limit, constant), length), [ALLOWED])
        if settled:
            (trend,) = trends(course(approach(limit, constant), length), [ALLOWED])
            assert abs(trend.mean - limit) <= 1.05 * ALLOWED.absolute
            assert length <= max(0.5, 30.0 * constant), "and recognised in the end"
        length *= 1.5
    assert settled


@pytest.mark.parametrize("constant", [30.0, 1000.0])
def test_a_drift_that_is_slow_beside_the_run_is_no_rest_although_its_last_windows_are_nearly_equal(constant):
    one = course(approach(0.17, constant), 0.5)
    first, second, third = one.means(one.edges())[:, 0]
    assert abs(third - second) < 6e-4 and abs(second - first) < 6e-4, "less than 0.1 points, which is what a look at the curve sees"
    assert not has_settled(one, [ALLOWED])


@pytest.mark.parametrize("periods", [0.3, 0.7, 1.3, 2.6])
def test_an_oscillation_that_is_slow_beside_the_run_is_no_rest(periods):
    assert not has_settled(course(oscillation(0.05, 0.01, 10.0 / periods), 10.0), [ALLOWED])


def test_an_oscillation_with_hundreds_of_periods_has_the_mean_about_which_it_swings():
    swinging = course(oscillation(0.05, 0.01, 0.0371), 10.0, samples=4000)
    assert has_settled(swinging, [ALLOWED])
    assert trends(swinging, [ALLOWED])[0].mean == pytest.approx(0.05, abs=1e-4)


def test_a_mean_is_known_to_twice_its_standard_error_and_rests_when_that_is_small_enough():
    random, outside, settled = np.random.default_rng(3), 0, []
    for scatter in (1e-4, 2e-2):
        for _ in range(100):
            integral = np.concatenate([[0.0], np.cumsum(0.05 + scatter * random.standard_normal(1000)) * 0.01])
            noisy = Course(np.linspace(0.0, 10.0, 1001), np.linspace(0.0, 1000.0, 1001), integral[:, None])
            (trend,) = trends(noisy, [ALLOWED])
            outside += abs(trend.mean - 0.05) > trend.uncertainty
            settled.append(has_settled(noisy, [ALLOWED]))
    assert outside <= 30, "5 % of 200 for normal numbers, more for few batches"
    assert sum(settled[:100]) >= 90 and sum(settled[100:]) == 0, "0.02/sqrt(200) is more than the tolerance"


def test_slip_that_has_stopped_at_rest_of_the_shaft_is_nothing_to_wait_for():
    assert has_settled(course(lambda t: np.where(t == 0.0, 0.0, math.nan), 1.0), [ALLOWED])


def test_windows_are_whole_cage_turns_where_they_hold_any():
    swinging = course(oscillation(0.05, 0.02, 0.1), 1.73, turn=0.1, samples=20_000)
    edges = swinging.edges()
    assert np.diff(edges) == pytest.approx(0.3, abs=1e-9), "0.346 s hold three turns"
    assert swinging.means(edges)[:, 0] == pytest.approx(0.05, abs=1e-6), "whole periods, whatever the amplitude"
    backwards = Course(swinging.times, -swinging.turns, swinging.integrals)
    assert backwards.edges() == pytest.approx(edges)
    standing = Course(swinging.times, np.zeros_like(swinging.turns), swinging.integrals)
    assert np.diff(standing.edges()) == pytest.approx(0.2 * 1.73)


@pytest.mark.parametrize(
    ("value", "verdict", "words"),
    [
        (approach(0.17, 8.0), DRIFTING, "cage slip still rises by 0.79 points per s, now 11.47 %"),  # about 17/8 exp(-8/8), mean of 8 to 10 s
        (oscillation(0.06, 0.02, 1.25), LIMIT_CYCLE, "cage slip oscillates between 4.0"),
        (lambda t: 0.06 * t + 1e-3 * np.cumsum(np.random.default_rng(1).standard_normal(len(t))) * 0.3, WANDERING, "cage slip wanders between"),
    ],
)
def test_what_an_unsettled_observable_was_doing_is_said(value, verdict, words):
    one = course(value, 10.0)
    (trend,) = trends(one, [ALLOWED])
    found, said = describe(one, trend, 0, SLIP)
    assert found == verdict and said.startswith(words)
    if "oscillates" in words:
        assert "and 8.0" in said or "and 7.9" in said
        assert float(said.split("period of ")[1].removesuffix(" s")) == pytest.approx(1.25, rel=0.05)


def test_lengths_of_runs_scale_with_cage_turns_and_with_seconds():
    fast, slow = load_scene("deng2017_table1"), load_scene("deng2017_table1", [f"{SPEED}=-1 rpm"])
    turn = 60.0 / (0.5 * (1 - 7.0 / 62.75))
    assert cage_turn(slow) == pytest.approx(turn)
    assert shortest_run(fast, 0.5) == 0.5 and shortest_run(slow, 0.5) == pytest.approx(SHORTEST_TURNS * turn)
    assert longest_run(fast) == LONGEST and longest_run(slow) == pytest.approx(2000 * turn)
    at_rest = load_scene("deng2017_table1", [f"{SPEED}=0"])
    assert math.isinf(cage_turn(at_rest)) and shortest_run(at_rest, 0.5) == 0.5


def test_samples_do_not_keep_step_with_the_rollers():
    scene = load_scene("deng2017_table1")
    simulation = Simulation(scene)
    simulation.advance(0.2)
    speed = float(simulation.sample["cage_speed"])
    pitch = 2 * math.pi / (18 * speed)
    block = sampled(simulation, 1000 * pitch, 2.0 * pitch)  # asked to look once every second roller
    phases = np.mod(block["cage_angle"] * 18 / (2 * math.pi), 1.0)
    counts, _ = np.histogram(phases, 12, (0.0, 1.0))
    assert counts.min() > 0.5 * counts.max(), "all instants of a pitch are seen alike"


@pytest.mark.parametrize("level", ["steady", "slip", "planar"])
def test_a_slow_bearing_is_waited_for_and_ends_where_a_run_of_three_times_the_length_does(slow, level):
    scene = load_scene(slow, [f"level={level}"])
    at_half_a_second = Simulation(scene)
    at_half_a_second.advance(0.5)
    simulation = Simulation(scene)
    outcome = advance_until_settled(simulation, shortest_run(scene, 0.5), 1000.0)
    assert outcome.settled and outcome.slip > float(at_half_a_second.sample["cage_slip"]) + 0.2
    assert 1.0 < outcome.settling_time < outcome.simulated
    begin = simulation.sample.copy()
    sampled(simulation, 2.0 * outcome.simulated, shortest_run(scene, 0.5) / 1000)
    after = simulation.sample
    later = 1.0 - float(after["cage_angle"] - begin["cage_angle"]) / float(after["ideal_cage_angle"] - begin["ideal_cage_angle"])
    assert later == pytest.approx(outcome.slip, abs=1e-3)


def test_the_time_of_a_run_counts_from_where_its_simulation_stood():
    simulation = Simulation(load_scene("deng2017_table1", ["level=slip"]))
    simulation.advance(1.0)
    length = shortest_run(simulation.scene, 0.05)
    assert advance_until_settled(simulation, length, length).simulated == pytest.approx(length)


@pytest.mark.parametrize("level", ["steady", "slip", "planar"])
@pytest.mark.parametrize("speed", [-600.0, -1.0, 0.001, 1.0, 10.0])
def test_slip_is_defined_for_every_turning_shaft(level, speed):
    simulation = Simulation(load_scene("deng2017_table1", [f"level={level}", f"{SPEED}={speed} rpm", f"{LOAD}=2000"]))
    block = simulation.advance(0.5, samples=50)
    assert np.isfinite(block["cage_slip"]).all()
    by_hand = 1.0 - block["cage_speed"] / (0.5 * block["shaft_speed"] * (1.0 - 7.0 / 62.75))
    assert block["cage_slip"] == pytest.approx(by_hand, rel=1e-9, abs=1e-12)


def test_a_shaft_at_rest_has_no_slip():
    simulation = Simulation(load_scene("deng2017_table1", [f"{SPEED}=0"]))
    assert np.isnan(simulation.advance(0.1, samples=3)["cage_slip"]).all()


def test_levels_steady_and_slip_agree_below_a_radian_per_second_too(slow):
    steady, slip = (point_row(load_scene(slow, [f"level={level}", f"{SPEED}=2 rpm", f"{LOAD}=5 kN"])) for level in ("steady", "slip"))
    assert steady["status"] == slip["status"] == "ok"
    assert steady["cage_slip"] == pytest.approx(slip["cage_slip"], abs=0.01)


@pytest.mark.parametrize("level", ["steady", "slip", "planar"])
def test_the_largest_load_is_that_of_the_roller_under_the_load_at_every_level(slow, level):
    """With clearance and 500 N one roller at a time carries nearly everything when it stands under the load; few instants show less."""
    straight = "bearing.roller.crown=none"  # softer contacts of rollers with a profile pass 3 % on to their neighbours
    scene = load_scene(slow, [f"level={level}", f"{SPEED}=100 rpm", f"{LOAD}=500 N", straight])
    row = point_row(scene)
    # Between two rollers 2 x Q cos(pitch/2) = F; under the load Q = F. Rattling bodies of level planar add their impacts.
    assert 0.985 * 500.0 <= row["inner_load_maximum"] <= (1.001 if level != "planar" else 1.3) * 500.0
    window = advance_until_settled(Simulation(scene), shortest_run(scene, 0.5), 100.0).window
    assert (window["inner_load_maximum"] >= window["inner_load"].max(axis=1)).all()
    assert row["inner_load_maximum"] == pytest.approx(window["inner_load_maximum"].max(), rel=1e-12)


@pytest.mark.parametrize("count", [2502, 2503])
def test_samples_that_are_left_out_of_a_long_stretch_still_count_in_its_largest_loads(count):
    blocks = []
    samples = advance_in_calls(Simulation(load_scene("deng2017_table1")), 1e-5, count, 25, lambda block: blocks.append(block.copy()))
    every, kept = np.concatenate(blocks), np.arange(count - 1, -1, -2)[::-1]
    assert len(every) == count
    np.testing.assert_array_equal(samples["time"], every["time"][kept])
    for name in ("inner_load_maximum", "outer_load_maximum"):
        expected = [every[name][max(k - 1, 0) : k + 1].max() for k in kept]
        np.testing.assert_array_equal(samples[name], expected)
        assert (samples[name] > every[name][kept]).any(), "a sample that is left out has a larger load"


def invoke(*words, code=0):
    done = CliRunner().invoke(main, ["run", *map(str, words)])
    assert done.exit_code == code, done.output + repr(done.exception)
    return done


def test_run_goes_on_until_the_bearing_has_settled_and_tells_how_long_that_took(slow):
    straight = "bearing.roller.crown=none"
    report = json.loads(invoke(slow, "--set", straight, "--json").stdout)
    assert report["settled"] is True and report["unsettled_reason"] == ""
    assert 1.0 < report["settling_seconds"] < report["sim_seconds"]
    assert report["cage_slip"] == pytest.approx(0.01 * point_row(load_scene(slow, [straight]))["cage_slip"], abs=1e-3), "as a point of a sweep"
    assert report["inner_load_maximum"] == pytest.approx(500.0, rel=0.01), "one roller carries the load when it stands under it"
    assert "yes, after 2." in invoke(slow, "--set", straight).stdout


def test_run_that_has_not_settled_says_what_it_was_doing_and_ends_with_code_4(slow):
    done = invoke(slow, "--at-most", "2 s", "--json", code=4)
    report = json.loads(done.stdout)
    assert report["settled"] is False and report["settling_seconds"] is None and report["sim_seconds"] == pytest.approx(2.0, abs=0.02)
    assert "cage slip still rises by" in report["unsettled_reason"]
    assert "not settled: after 2 s cage slip still rises by" in done.stderr and "--at-most" in done.stderr


def test_run_of_a_given_duration_takes_exactly_that_and_says_whether_it_has_settled(slow):
    report = json.loads(invoke(slow, "--duration", "2 s", "--json").stdout)
    assert report["sim_seconds"] == pytest.approx(2.0, abs=1e-9) and report["settled"] is False
    report = json.loads(invoke(slow, "--duration", "15 s", "--json").stdout)
    assert report["sim_seconds"] == pytest.approx(15.0, abs=1e-9) and report["settled"] is True
    report = json.loads(invoke(slow, "--duration", "0.3 s", "--json").stdout)
    assert report["settled"] is False and "too short to tell" in report["unsettled_reason"]


def test_run_of_a_shaft_at_rest_has_no_slip_and_has_settled():
    done = invoke("deng2017_table1", "--set", f"{SPEED}=0")
    assert "none, the shaft is at rest" in done.stdout and "nan" not in done.stdout


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--duration", "1", "--at-most", "2"], "give one of them"),
        (["--at-most", "1 ms"], "the shortest run of this bearing"),
        (["--at-most", "5 N"], "--at-most"),
        (["--rate", "10"], "too few samples"),
    ],
)
def test_run_refuses_times_that_do_not_go_together(words, reported):
    assert reported in invoke("deng2017_table1", *words, code=2).stderr


def test_a_recording_of_unknown_length_holds_the_whole_run_and_can_be_repeated(slow, tmp_path):
    path = tmp_path / "run.mcap"
    report = json.loads(invoke(slow, "--out", path, "--json").stdout)
    recording = Recording(path)
    assert recording.duration == pytest.approx(report["sim_seconds"], rel=1e-6)
    again = CliRunner().invoke(main, ["replay", str(path), "--from-recording", "-o", str(tmp_path / "again.mcap")])
    assert again.exit_code == 0, again.output
    compared = CliRunner().invoke(main, ["compare", str(path), str(tmp_path / "again.mcap"), "--tolerance", "1e-12"])
    assert compared.exit_code == 0 and "the recordings agree" in compared.output


@pytest.mark.long
def test_random_bearings_settle_and_stay_there():
    """The whole draw: `python test/benchmarks/random_bearings.py`."""
    rows = [examine(scene) for scene in scenes(60, 1)[:8]]
    assert all(agrees(row) for row in rows)
    assert sum(row["undefined_samples"] for row in rows) == 0


def test_a_run_that_begins_where_the_cages_tilt_can_still_grow_goes_on_until_it_has():
    """From level planar the cage begins with a trace of tilt, at a slip that hardly changes for 15 of its turns."""
    scene = load_scene("deng2017_table1", ["level=planar"])
    start = run_until_settled(scene).window[-1]
    tilting = scene.at_level("spatial")
    rolled, taken = run_until_settled(tilting), run_until_settled(tilting, 0.0, start=start)
    assert taken.settled and taken.slip == pytest.approx(rolled.slip, abs=5e-4)
    assert taken.slip < start["cage_slip"] - 0.001
