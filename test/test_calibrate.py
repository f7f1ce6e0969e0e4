# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Calibration: known values come back from noisy synthetic runs as often as the intervals say, and what a run cannot tell is refused."""

import json
import math
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.signal import lfilter

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import read_input_log
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.levels.steady.table_builder import solve_points
from bearing_sim.messages.events import Measurement, ReceivedInputs
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation
from bearing_sim.studies.calibration import CalibrationError, Measured, _Model, _spread, calibrate, correlation_time, cut, shared_points

RPM, KELVIN = math.pi / 30, 393.15
RATE, READING = 10.0, 0.003  # Hz, and standard deviation of a slip from a cage speed sensor
ONE_POINT = ((45000, 800),)
FIVE_POINTS = ((15000, 800), (30000, 400), (45000, 800), (45000, 3000), (50000, 200))
LOW_RADIUS = "uncertainty.bearing.outer_raceway.low_radius=[34.860 mm, 34.866 mm]"
TRUTH = 0.036
MIXTURE = "lubricant.mixture_fraction"


@cache
def true_slips(points, *overrides):
    scene = load_scene("deng2017_table1", [f"{MIXTURE}={TRUTH}", *overrides])
    return solve_points(scene, np.array([[rpm * RPM, load, KELVIN, 0.0] for rpm, load in points]))[:, ANSWER.cage_slip]


def measured(seed, points=ONE_POINT, seconds=60.0, noise=READING, correlation=0.0, overrides=()):
    """Return a course that stays at each point for a while, its cage as the model has it with the true scene, and a noisy sensor."""
    each = round(seconds * RATE)
    times, place = np.arange(each * len(points)) / RATE, np.repeat(np.arange(len(points)), each)
    inputs = np.array([Inputs(rpm * RPM, load, 0.0, KELVIN) for rpm, load in points])[place]
    draws = np.random.default_rng(seed).normal(size=len(times) + 500)
    wobble = noise * lfilter([math.sqrt(1 - correlation**2)], [1, -correlation], draws)[500:]
    ideal = 0.5 * inputs[:, 0] * (1 - load_scene("deng2017_table1").bearing.diameter_ratio)
    return Measured(times, inputs, [], times, ideal * (1 - true_slips(points, *overrides)[place] - wobble))


def fit(course, *fields, overrides=(), length=1.0, **options):
    scene = load_scene("deng2017_table1", overrides)
    return calibrate(scene, fields or (MIXTURE,), cut(course, scene.bearing.diameter_ratio, 20.0, length), **options)


@pytest.mark.parametrize(("correlation", "seconds"), [(0.0, 60.0), (0.9, 120.0)])
def test_intervals_hold_the_true_mixture_fraction_about_as_often_as_they_say(correlation, seconds):
    """19 of 20 in the mean; fewer than 16 come in one of 3000 such tests.  Noise of 0.9 resembles itself over 2 s, two blocks."""
    found = [fit(measured(seed, seconds=seconds, correlation=correlation)).fitted[0] for seed in range(20)]
    assert sum(one.low <= TRUTH <= one.high for one in found) >= 16
    assert np.mean([one.value for one in found]) == pytest.approx(TRUTH, rel=0.01)
    misses = [(one.value - TRUTH) / (one.high - one.low) for one in found]
    assert 0.1 < np.std(misses) < 0.32, "a standard deviation is about a quarter of a 95 % interval: not wider than it must be, either"
    assert all(one.before == 0.03 and one.high - one.low < 0.1 * TRUTH for one in found)


def test_two_fields_come_back_together_from_several_operating_points():
    held = 0
    for seed in range(3):
        found = fit(measured(seed, FIVE_POINTS, 25.0), MIXTURE, "low_radius", overrides=[LOW_RADIUS, "bearing.outer_raceway.low_radius=34.8635 mm"])
        mixture, radius = found.fitted
        assert mixture.value == pytest.approx(TRUTH, rel=0.05) and radius.value == pytest.approx(34.8625e-3, abs=0.3e-6)
        held += (mixture.low <= TRUTH <= mixture.high) + (radius.low <= 34.8625e-3 <= radius.high)
        assert abs(found.correlation[0, 1]) > 0.5 and found.correlation[0, 0] == 1.0
    assert held >= 4


def test_the_cages_lag_behind_a_rising_speed_is_not_taken_for_slip():
    truth = load_scene("deng2017_table1", ["level=steady", f"{MIXTURE}={TRUTH}"])
    times = np.arange(200) / RATE
    inputs = np.array([Inputs((40000 + 500 * time) * RPM, 100.0, 0.0, KELVIN) for time in times])
    simulation = Simulation(truth, Inputs(*inputs[0]), empty_table())
    simulation.advance(5.0)
    cage = [simulation.sample["cage_speed"], *(simulation.advance(1 / RATE, Inputs(*row))["cage_speed"][0] for row in inputs[1:])]
    blocks = cut(Measured(times, inputs, [], times, np.array(cage, float)), truth.bearing.diameter_ratio, 20.0, 1.0)
    known, ignored = (
        each.slip - _Model(truth, [], each, shared_points(each.conditions), lambda evaluated: None).slip({})
        for each in (blocks, blocks._replace(lead=0.0 * blocks.lead))
    )
    assert ignored.mean() > 5 * abs(known.mean()) and ignored.mean() > 5e-5, "a cage that lags behind a shaft seems to slip more"


def test_the_autocorrelation_time_is_that_of_the_closed_form():
    """(1 + a)/(1 - a) of a first-order process."""
    draws = np.random.default_rng(1).normal(size=40_000)
    assert correlation_time(draws)[0] == pytest.approx(1.0, abs=0.05)
    assert correlation_time(lfilter([1], [1, -0.8], draws))[0] == pytest.approx(9.0, rel=0.1)


def test_deviations_of_a_linear_model_are_those_of_ordinary_least_squares():
    lot = np.random.default_rng(2)
    x = lot.random(50)
    slopes = np.stack([np.ones(50), x], axis=-1)
    y = 1.0 + 2.0 * x + 0.1 * lot.normal(size=50)
    coefficients, covariance = np.polyfit(x, y, 1, cov=True)
    deviations, correlation = _spread(slopes, y - np.polyval(coefficients, x), tau=1.0)
    assert deviations == pytest.approx(np.sqrt(np.diag(covariance))[::-1])
    assert correlation[0, 1] == pytest.approx(covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]))


def test_what_was_not_fitted_shifts_the_result_as_another_fit_with_it_changed_says():
    course, high = measured(3), 1.1
    found = fit(course, overrides=["uncertainty.lubricant.traction_scale=[0.9, 1.1]"])
    again = fit(course, overrides=[f"lubricant.traction_scale={high}", "uncertainty.lubricant.traction_scale=[0.9, 1.2]"])
    reported = found.depends["lubricant.traction_scale"]
    assert reported.shape == (2, 1) and reported[0, 0] < found.fitted[0].value < reported[1, 0]
    assert reported[1, 0] - found.fitted[0].value == pytest.approx(again.fitted[0].value - found.fitted[0].value, rel=0.15)
    assert "lubricant.temperature" not in found.depends, "the recording says it"


def test_the_search_starts_from_the_scene_s_own_value_where_that_fits_best():
    evaluations = {}
    for own in (TRUTH, 0.03):
        counts = []
        found = fit(measured(3, noise=1e-5), overrides=[f"{MIXTURE}={own}"], progress=counts.append)
        assert found.fitted[0].value == pytest.approx(TRUTH, rel=1e-4)
        evaluations[own] = counts[-1]
    assert evaluations[TRUTH] < 0.7 * evaluations[0.03], "there is next to nothing left to search"


def test_an_error_of_the_model_shows_where_there_are_more_points_than_fields_and_none_shows_where_there_is_none():
    right = fit(measured(4, FIVE_POINTS, 20.0))
    wrong = fit(measured(4, FIVE_POINTS, 20.0, overrides=("bearing.outer_raceway.low_radius=34.8628 mm",)))
    assert right.misfit_chance > 0.01 and wrong.misfit_chance < 0.01 and wrong.misfit > 10 * right.misfit
    assert math.isnan(fit(measured(4)).misfit)


def test_an_interval_of_less_confidence_is_narrower():
    half, usual = (fit(measured(9), confidence=share).fitted[0] for share in (0.5, 0.95))
    assert half.value == usual.value and 0.3 < (half.high - half.low) / (usual.high - usual.low) < 0.36  # 0.674 / 1.96 of a normal distribution


def test_noise_that_resembles_itself_is_not_taken_for_an_error_of_the_model():
    assert min(fit(measured(seed, FIVE_POINTS, correlation=0.9)).misfit_chance for seed in (1, 2, 3)) > 0.01


def refused(course, *fields, **options):
    with pytest.raises(CalibrationError) as error:
        fit(course, *fields, **options)
    return str(error.value)


@pytest.mark.parametrize("points", [ONE_POINT, FIVE_POINTS])
def test_fields_that_change_slip_alike_are_refused_by_name(points):
    """Drag over traction is what slip goes by: at any speed and load more oil is as good as less traction."""
    reported = refused(measured(1, points, 30.0), MIXTURE, "lubricant.traction_scale")
    assert "lubricant.mixture_fraction and lubricant.traction_scale cannot be distinguished" in reported
    assert (
        f"{'one operating point' if len(points) == 1 else '5 operating points'} of this run" in reported
        and "condition of the scaled Jacobian" in reported
    )


def test_a_field_without_influence_is_refused():
    reported = refused(measured(1), "pocket_clearance", overrides=["uncertainty.bearing.cage.pocket_clearance=[0.05 mm, 0.2 mm]"])
    assert "bearing.cage.pocket_clearance cannot be identified" in reported and "changes slip by no more than" in reported


def test_a_best_value_at_a_bound_is_refused():
    reported = refused(measured(1), overrides=["uncertainty.lubricant.mixture_fraction=[0.02, 0.034]"])
    assert "lies at the bound of its range, 0.034" in reported and "the measured cage by 8.4" in reported and "check other fields" in reported


def test_too_little_data_is_refused_by_what_was_left_out():
    reported = refused(measured(1, seconds=8.0))
    assert "too little data: 7 settled blocks of 1 s" in reported and "1 at the start or after a gap" in reported
    course = measured(1, seconds=40.0)
    ramped = course.inputs.copy()
    ramped[:, 0] *= 1.0 + 0.05 * np.sin(course.times)
    assert "at a changing speed" in refused(course._replace(inputs=ramped))
    resting = course.inputs * [0.0, *np.ones(5)]
    assert "at rest" in refused(course._replace(inputs=resting))


def test_noise_that_resembles_itself_for_most_of_the_run_is_too_little_data():
    assert "independent ones, expected 6 or more; record longer" in refused(measured(2, seconds=30.0, correlation=0.995), length=0.3)


def test_an_interval_as_wide_as_the_range_is_refused():
    assert "interval covers" in refused(measured(5, noise=0.2, seconds=30.0), overrides=[f"uncertainty.{MIXTURE}=[0.03, 0.04]"])


@pytest.mark.parametrize(
    ("fields", "overrides", "reported"),
    [
        (["mixture_fractoin"], [], "unknown field (did you mean 'lubricant.mixture_fraction'?)"),
        (["bearing.cage.mass"], [], 'the scene gives no range to search; add --set "uncertainty.bearing.cage.mass=[LOW, HIGH]"'),
        (["temperature"], [], "the recording itself gives it"),
        (["operating.radial_load"], ["uncertainty.operating.radial_load=[700 N, 900 N]"], "the recording itself gives it"),
        ([MIXTURE, "mixture_fraction"], [], "given twice"),
    ],
)
def test_a_question_that_cannot_be_asked_is_refused(fields, overrides, reported):
    assert reported in refused(measured(1), *fields, overrides=overrides)


def test_the_oil_temperature_can_be_fitted_where_no_recording_says_it():
    course = measured(6, FIVE_POINTS, 25.0, noise=1e-4)
    course.inputs[:, 3] = math.nan
    found = fit(course, "lubricant.temperature", overrides=[f"{MIXTURE}={TRUTH}", "lubricant.temperature=110 degC"])
    assert found.fitted[0].low <= KELVIN <= found.fitted[0].high and found.fitted[0].value == pytest.approx(KELVIN, abs=3.0)


def test_gaps_and_what_settles_after_them_are_left_out():
    course = measured(1, seconds=30.0)
    gamma = load_scene("deng2017_table1").bearing.diameter_ratio
    whole, cut_out = cut(course, gamma, 20.0, 1.0), cut(course._replace(gaps=[(10.2, 12.3)]), gamma, 20.0, 1.0)
    missing = set(np.floor(whole.times)) - set(np.floor(cut_out.times))
    assert missing == {10.0, 11.0, 12.0} or missing == {11.0, 12.0}
    assert np.allclose(whole.conditions[:, 0], 45000 * RPM) and whole.slip.mean() == pytest.approx(true_slips(ONE_POINT)[0], abs=5e-4)


def test_blocks_that_are_near_each_other_share_an_operating_point_of_their_means():
    conditions = np.array([[1000.0, 500.0, 0.0, 390.0], [1001.0, 502.0, 0.0, 390.1], [2000.0, 500.0, 0.0, 390.0]])
    points = shared_points(conditions)
    assert len(points.conditions) == 2 and points.conditions[points.index[0]] == pytest.approx(conditions[:2].mean(axis=0))
    assert len(shared_points(np.random.default_rng(1).random((2000, 4)) * [5000, 3000, 3000, 60] + [0, 0, 0, 350]).conditions) <= 400


def record(path, course, scene_overrides=()):
    """Write a course as a live run does: inputs, outputs and the measured cage, with the scene in the metadata."""
    scene = load_scene("deng2017_table1", [*scene_overrides, "bearing.roller.count=18"])
    sample = Simulation(scene).advance(1e-4)
    with McapSink(path, scene, 1_700_000_000_000_000_000) as sink:
        for time, row, speed in zip(course.times.tolist(), course.inputs, course.cage_speeds.tolist()):
            sink.write(ReceivedInputs(time, Inputs(*row)))
            sink.write(Measurement(time, speed, 0.0))
        sample["time"] = course.times[-1]
        sink.write(sample)
    return path


def invoke(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_the_command_calibrates_our_own_recording_and_writes_a_scene_that_predicts_it(tmp_path):
    run, out = record(tmp_path / "run.mcap", measured(7, seconds=30.0)), tmp_path / "calibrated.yaml"
    found = invoke("calibrate", run, "-o", out, "--picture", tmp_path / "fit.png", "--json")
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    fitted = report["fitted"][MIXTURE]
    assert fitted["value"] == pytest.approx(TRUTH, rel=0.02) and fitted["interval"][0] < fitted["value"] < fitted["interval"][1]
    assert report["operating_points"] == 1 and report["residual_after"] < report["residual_before"]
    scene = load_scene(out)
    assert scene.lubricant.mixture_fraction == pytest.approx(fitted["value"])
    (narrowed,) = [one for one in scene.uncertainty if one.field == MIXTURE]
    assert [narrowed.low, narrowed.high] == pytest.approx(fitted["interval"]) and "calibrated" in narrowed.source
    assert load_scene("deng2017_table1", report["overrides"]).lubricant.mixture_fraction == pytest.approx(fitted["value"], rel=1e-8)
    assert (tmp_path / "fit.png").stat().st_size > 20_000 and out.read_text().startswith("# Calibrated by bearing_sim")
    after = solve_points(scene, np.array([[45000 * RPM, 800.0, KELVIN, 0.0]]))[0, ANSWER.cage_slip]
    assert after == pytest.approx(true_slips(ONE_POINT)[0], abs=5e-4)
    shown = invoke("calibrate", run, "--set", "lubricant.mixture_fraction=0.02")
    assert shown.exit_code == 0 and "95 % interval" in shown.output and "scene: 0.02" in shown.output and "to use the result" in shown.output


def test_the_command_calibrates_a_table_that_was_imported(tmp_path):
    course = measured(8, seconds=30.0)
    rows = [
        f"{time:.1f},{row[0] / RPM:.6f},{row[1]:.3f},{speed / RPM:.6f}" for time, row, speed in zip(course.times, course.inputs, course.cage_speeds)
    ]
    (tmp_path / "rig.csv").write_text("\n".join(["t,n,F,n_cage", *rows]))
    (tmp_path / "rig.yaml").write_text(
        "name: rig\ntime: {column: t, unit: s}\nshaft_speed: {column: n, unit: rpm}\n"
        "radial_load: {law: sum, columns: [{column: F, unit: N}]}\ncage_speed: {column: n_cage, unit: rpm}\n"
    )
    log = tmp_path / "rig.mcap"
    imported = invoke("import-csv", tmp_path / "rig.csv", tmp_path / "rig.yaml", "-o", log)
    assert imported.exit_code == 0 and "cage_speed_measured messages" in imported.output
    assert "give the scene to calibrate with --scene" in invoke("calibrate", log).output
    found = invoke("calibrate", log, "--scene", "deng2017_table1", "--json")
    assert json.loads(found.stdout)["fitted"][MIXTURE]["value"] == pytest.approx(TRUTH, rel=0.02)
    assert set(read_input_log(log).series) == {"shaft_speed", "radial_load", "cage_speed_measured"}, "a replay compares what was measured"


def test_the_command_says_what_is_missing_in_one_line(tmp_path):
    from recordings import steady_log

    log = steady_log(tmp_path / "log.mcap")
    found = invoke("calibrate", log, "--scene", "deng2017_table1")
    assert found.exit_code == 2 and "no /cage_speed_measured" in found.output and "/shaft_speed (sensor_msgs/msg/JointState)" in found.output
    run = record(tmp_path / "run.mcap", measured(1, seconds=5.0))
    assert "too little data" in invoke("calibrate", run, "--batch", "1").output
    assert "no joint" in invoke("calibrate", run, "--cage-joint", "retainer").output
    assert invoke("calibrate", run, "-o", tmp_path / "scene.txt").exit_code == 2
