# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Ranges in scenes, and the bands and shares that come of them: against closed forms, and against the level that is sampled."""

import csv
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import steady_log, write_log
from scipy import stats

from bearing_sim import settle
from bearing_sim.cli.estimation import band_rows, live_band_rows
from bearing_sim.cli.main import main
from bearing_sim.model.plausibility import left_out
from bearing_sim.scene.loader import SceneError, load_scene, scene_from_yaml, scene_names, scene_to_yaml
from bearing_sim.scene.uncertainty import Range, number_at, quantities, value_at, with_values, without_dimensions
from bearing_sim.studies.uncertainty_propagation import (
    UncertaintyError,
    band,
    design,
    distribution,
    filled_in,
    indices,
    lowest_level,
    settled,
    stretches,
    study,
    varied_ranges,
)
from bearing_sim.sweep.tasks import Execution, Journal

NONE = [
    f"uncertainty.{field}=null"
    for field in (
        *(f"lubricant.{name}" for name in ("mixture_fraction", "temperature", "traction_scale")),
        *(f"bearing.cage.{name}" for name in ("guide_clearance", "pocket_friction", "land_friction")),
    )
]
FRACTION = "uncertainty.lubricant.mixture_fraction"


def ranges(*overrides):
    return {one.field: one for one in load_scene("deng2017_table1", overrides).uncertainty}


def test_ranges_are_read_in_units_by_path_or_nested_and_written_back():
    flat = scene_to_yaml(load_scene("deng2017_table1", NONE))
    block = """
  lubricant:
    temperature: [100 degC, 140 degC]
    mixture_fraction: {low: 1 %, high: 5 %, distribution: log_uniform, source: ours}
  bearing.cage.guide_clearance: {low: 100 um, high: 0.2 mm, distribution: triangular, mode: 0.12 mm}
"""
    scene = scene_from_yaml(flat.replace("uncertainty: {}", f"uncertainty:{block}"))
    found = {one.field: one for one in scene.uncertainty}
    assert (found["lubricant.temperature"].low, found["lubricant.temperature"].high) == pytest.approx((373.15, 413.15))
    assert found["lubricant.mixture_fraction"] == Range(
        field="lubricant.mixture_fraction", low=0.01, high=0.05, distribution="log_uniform", source="ours"
    )
    assert found["bearing.cage.guide_clearance"].mode == pytest.approx(0.12e-3)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


@pytest.mark.parametrize(
    ("override", "reported"),
    [
        ("uncertainty.lubricant.mixture_fractoin=[0.01, 0.05]", "unknown field (did you mean 'lubricant.mixture_fraction'?)"),
        ("uncertainty.temperature=[380, 390]", "did you mean 'lubricant.temperature'?"),
        ("uncertainty.integration.first_step=[1 us, 2 us]", "expected a quantity of bearing, lubricant, operating, mounting, heat or support"),
        ("uncertainty.lubricant.temperature=[1 mm, 400]", "has the wrong dimension; expected a temperature"),
        ("uncertainty.lubricant.temperature=[120 degC, 900 degC]", "900 degC is outside"),
        ("uncertainty.lubricant.temperature=[120 degC, 110 degC]", "is not below high"),
        ("uncertainty.lubricant.temperature=[1, 2, 3]", "expected [low, high]"),
        ("uncertainty.lubricant.temperature=120 degC", "expected [low, high], or a block"),
        ("uncertainty.lubricant.temperature={low: 380}", "uncertainty.lubricant.temperature.high: missing"),
        ("uncertainty.lubricant.temperature={low: 380, hihg: 390, high: 400}", "unknown field (did you mean 'high'?)"),
        ("uncertainty.lubricant.temperature={low: 380, high: 390, distribution: gauss}", "'log_uniform' or 'triangular'"),
        ("uncertainty.lubricant.temperature={low: 380, high: 390, mode: 385}", "only a triangular distribution has one"),
        ("uncertainty.operating.load_angle={low: -10 deg, high: 10 deg, distribution: log_uniform}", "lies above 0"),
        ("uncertainty.lubricant.oil.density=[900, 950]", "this scene has no lubricant.oil.density"),
        ("uncertainty=3", "expected a mapping of field to range"),
    ],
)
def test_a_range_that_cannot_be_is_refused_by_name(override, reported):
    with pytest.raises(SceneError) as refused:
        load_scene("deng2017_table1", [override])
    assert reported in str(refused.value)


def test_an_override_replaces_a_range_or_one_end_of_it_or_removes_it():
    changed = ranges("uncertainty.lubricant.temperature=[90 degC, 130 degC]", f"{FRACTION}.low=0.01", "uncertainty.lubricant.traction_scale=null")
    assert changed["lubricant.temperature"].low == pytest.approx(363.15) and changed["lubricant.temperature"].distribution == "uniform"
    assert (changed["lubricant.mixture_fraction"].low, changed["lubricant.mixture_fraction"].high) == (0.01, 0.05)
    assert changed["lubricant.mixture_fraction"].distribution == "log_uniform", "the rest of the range stays"
    assert "lubricant.traction_scale" not in changed
    assert "bearing.cage.guide_clearance" not in ranges("bearing.cage.guidance=roller", "bearing.cage.outer_radius=33 mm"), "it has no lands"


@pytest.mark.parametrize("name", [name for name in scene_names() if name.startswith("deng2017")])
def test_the_papers_scenes_have_ranges_with_sources_around_their_own_values(name):
    scene = load_scene(name)
    ranged = {one.field for one in scene.uncertainty}
    assert {"lubricant.mixture_fraction", "lubricant.temperature", "lubricant.traction_scale", "bearing.cage.guide_clearance"} <= ranged
    assert {"bearing.cage.pocket_friction", "bearing.cage.land_friction"} <= ranged
    of_a_cold_bearing = {"bearing.clearance", "mounting.shaft.interference", "heat.oil_flow", "heat.conductances.housing_ambient"}
    assert of_a_cold_bearing <= ranged if scene.bearing.dimensions_at == "cold" else not of_a_cold_bearing & ranged
    for one in scene.uncertainty:
        assert one.low <= value_at(scene, one.field) < one.high and one.source


def test_a_bearing_with_a_clearance_keeps_it_or_takes_the_radius_as_an_override_of_its_scene_does():
    scene = load_scene("deng2017_table1_cold")
    for values, overrides in (
        ({"bearing.clearance": 30e-6}, ["bearing.clearance=30 um"]),
        ({"bearing.roller.diameter": 7.002e-3}, ["bearing.roller.diameter=7.002 mm"]),
        ({"bearing.outer_raceway.low_radius": 34.89e-3}, ["bearing.outer_raceway.low_radius=34.89 mm"]),
    ):
        changed, loaded = with_values(scene, values).bearing, load_scene("deng2017_table1_cold", overrides).bearing
        assert changed.outer_raceway.low_radius == pytest.approx(loaded.outer_raceway.low_radius, abs=1e-15)


def test_another_law_of_heat_takes_the_fields_and_ranges_of_the_law_before_away():
    scene = load_scene("deng2017_table1_cold", ["heat.law=none"])
    assert scene.heat.law == "none" and not any(one.field.startswith("heat.") for one in scene.uncertainty)


def test_a_radius_takes_the_range_of_the_clearance_away():
    scene = load_scene("deng2017_table1_cold", ["bearing.outer_raceway.low_radius=34.89 mm"])
    assert scene.bearing.clearance is None and "bearing.clearance" not in {one.field for one in scene.uncertainty}


def test_the_clearance_of_a_scene_with_a_range_may_be_a_group():
    scene = load_scene("deng2017_table1_cold", ["bearing.clearance=C3"])
    own = number_at(scene, "bearing.clearance")
    assert own == pytest.approx(2.0 * scene.bearing.radial_clearance_at_low_points) and own > 0.0
    assert "bearing.clearance" in {one.field for one in scene.uncertainty}


def test_values_are_changed_by_path_and_checked_again():
    scene = load_scene("deng2017_table1")
    changed = with_values(scene, {"lubricant.temperature": 400.0, "bearing.cage.guide_clearance": 2e-4, "bearing.cage.mass": 0.06})
    assert (changed.lubricant.temperature, changed.bearing.cage.guide_clearance, changed.bearing.cage.mass) == (400.0, 2e-4, 0.06)
    assert changed.bearing.roller == scene.bearing.roller and scene.lubricant.temperature == pytest.approx(393.15)
    with pytest.raises(ValueError, match="cuts into the outer raceway|smaller"):
        with_values(scene, {"bearing.cage.guide_radius": 0.036})
    assert len(quantities(type(scene))) > 50


def test_sobol_indices_of_the_ishigami_function_are_the_known_ones():
    """Ishigami and Homma 1990, a = 7, b = 0.1: shares by the variances in closed form."""
    a, b = 7.0, 0.1
    lot = design([stats.uniform(-math.pi, 2 * math.pi)] * 3, 2048, seed=1)
    x = lot.points.T
    found = indices(np.sin(x[0]) + a * np.sin(x[1]) ** 2 + b * x[2] ** 4 * np.sin(x[0]), 2048, seed=1)
    first = np.array([0.5 * (1 + b * math.pi**4 / 5) ** 2, a**2 / 8, 0.0])
    third = 8 * b**2 * math.pi**8 / 225
    variance = first.sum() + third
    assert found.first == pytest.approx(first / variance, abs=0.03)
    assert found.total == pytest.approx((first + [third, 0.0, third]) / variance, abs=0.03)
    for errors, known in ((found.first_error, first), (found.total_error, first + [third, 0.0, third])):
        assert (errors[:, 0] - 0.02 < known / variance).all() and (known / variance < errors[:, 1] + 0.02).all()


def test_bands_of_a_linear_function_are_those_of_its_closed_form():
    """Sum of two even ones on 0 to 1: F(s) = s^2/2 below 1; each brings half of the variance."""
    lot = design([stats.uniform(0, 1)] * 2, 1024, seed=3)
    values = lot.points.sum(axis=1)
    found = band(values[:2048])
    assert (found.low, found.middle, found.high) == pytest.approx((math.sqrt(0.1), 1.0, 2 - math.sqrt(0.1)), abs=0.015)
    assert found.low_error[0] <= math.sqrt(0.1) <= found.low_error[1] and found.high_error[0] <= 2 - math.sqrt(0.1) <= found.high_error[1]
    assert indices(values, 1024, seed=3).first == pytest.approx([0.5, 0.5], abs=0.03)
    assert np.isnan(indices(np.ones(4 * 1024), 1024, seed=3).total).all(), "nothing varies, nothing has a share"
    with pytest.raises(ValueError, match="not finite"):
        indices(np.full(16, math.inf), 4, seed=1)


def test_distributions_have_the_quantiles_of_their_closed_forms():
    even = distribution(Range(field="f", low=2.0, high=6.0), own=3.0)
    factor = distribution(Range(field="f", low=2.0, high=8.0, distribution="log_uniform"), own=3.0)
    peaked = distribution(Range(field="f", low=0.0, high=4.0, distribution="triangular"), own=1.0)
    assert even.ppf(0.25) == pytest.approx(3.0) and factor.ppf(0.5) == pytest.approx(4.0)
    assert peaked.cdf(1.0) == pytest.approx(0.25), "the peak is the scene's own value"
    assert distribution(Range(field="f", low=0.0, high=4.0, distribution="triangular"), own=9.0).cdf(2.0) == pytest.approx(0.5)


def test_sampling_errors_of_bands_hold_the_truth_as_often_as_they_say():
    lot = np.random.default_rng(5)
    held = sum(found.low_error[0] <= 0.05 <= found.low_error[1] for found in (band(lot.random(200)) for _ in range(400)))
    assert 0.93 <= held / 400 <= 0.99


def test_the_same_seed_gives_the_same_points_and_another_count_than_a_power_of_two_is_refused():
    even = [stats.uniform(0, 1)] * 3
    assert np.array_equal(design(even, 16, seed=1).points, design(even, 16, seed=1).points)
    assert not np.array_equal(design(even, 16, seed=1).points, design(even, 16, seed=2).points)
    with pytest.raises(ValueError, match="power of two"):
        design(even, 12, seed=1)


def test_the_band_of_one_field_is_slip_at_the_ends_of_its_own_band():
    """Slip rises with the mixture fraction, so quantiles go over into quantiles."""
    scene = load_scene("deng2017_table1", NONE[1:])
    found = study(scene, 64, seed=1, execution=Execution(workers=1))
    assert found.level == "steady" and found.absent == 0
    bounds = stats.loguniform(0.015, 0.05).ppf([0.05, 0.5, 0.95])
    steady = lowest_level(scene)[0]
    slips = [settled(with_values(steady, {"lubricant.mixture_fraction": bound}))[0, 0] for bound in bounds]
    bands = found.bands["cage_slip"]
    assert [bands.low, bands.middle, bands.high] == pytest.approx(slips, rel=0.03)
    assert bands == band(found.answers["cage_slip"][:128]), "both samples of the design count"
    assert found.indices["cage_slip"].total == pytest.approx([1.0])
    assert found.own["cage_slip"] == pytest.approx(settled(steady)[0, 0])


def test_what_is_sampled_at_level_steady_is_where_level_slip_settles():
    scene = load_scene("deng2017_table1", ["lubricant.mixture_fraction=0.045"])
    (slip,), (life,) = settled(scene)
    (steady_slip,), (steady_life,) = settled(lowest_level(scene)[0])
    assert scene.level == "slip" and slip == pytest.approx(steady_slip, abs=1e-3) and life == pytest.approx(steady_life, rel=0.01)


def test_a_ring_that_may_vibrate_keeps_its_level_and_its_mass_and_damping_vary():
    scene, reason = lowest_level(load_scene("deng2017_table1", ["level=planar"]))
    assert scene.level == "planar" and "may vibrate" in reason
    added = {one.field for one in varied_ranges(scene)} - {one.field for one in varied_ranges(scene.at_level("steady"))}
    assert added == {"support.shaft.mass", "bearing.contact.damping_time"}
    given = load_scene("deng2017_table1", ["level=planar", "support.shaft.mass=2 kg"])
    assert "support.shaft.mass" not in {one.field for one in varied_ranges(given)}, "the scene gives it"


def test_the_level_is_the_lowest_that_has_what_the_scene_asks_for():
    still = "bearing.inner_raceway.ring_mass=2 kg"  # far from a resonance with the passing rollers
    assert lowest_level(load_scene("deng2017_table1", ["level=planar", still, "integration.fixed_step=5 us"]))[0].level == "steady"
    assert lowest_level(load_scene("deng2017_table1", ["level=spatial", "wants=[cage_orbit]"]))[0].level == "planar"
    assert lowest_level(load_scene("deng2017_table1"), "slip") == (load_scene("deng2017_table1"), "as requested")
    with pytest.raises(UncertaintyError, match="needs level spatial"):
        lowest_level(load_scene("deng2017_table1", ["level=spatial", "operating.misalignment=1 mrad"]), "slip")


@pytest.mark.parametrize(
    ("overrides", "reported"),
    [
        (NONE, "has no uncertain fields"),
        (["lubricant.mixture_fraction=0.06"], r"0.015 to 0.05 excludes the scene's own value, 0.06; .*=\[0.015, 0.06\]"),
        ([*NONE, "uncertainty.bearing.cage.inner_radius=[29 mm, 36 mm]"], "contradict each other .*lies outside its outer surface.*narrow"),
    ],
)
def test_what_cannot_be_sampled_is_refused(overrides, reported):
    with pytest.raises(UncertaintyError, match=reported):
        study(load_scene("deng2017_table1", overrides), 4, seed=1, execution=Execution(workers=1))


def test_over_a_course_slip_is_the_mean_over_time_and_life_follows_miner():
    scene = load_scene("deng2017_table1", NONE[1:])
    conditions, seconds = np.array([[4000.0, 800.0, 0.0, math.nan], [5000.0, 0.0, 2000.0, 400.0]]), np.array([30.0, 10.0])
    found = study(scene, 2, seed=1, course=(conditions, seconds), execution=Execution(workers=1))
    steady = lowest_level(scene)[0]
    slips, lives = zip(*(settled(steady, conditions[[k]])[:, 0] for k in range(2)))
    assert found.own["cage_slip"] == pytest.approx(0.75 * slips[0] + 0.25 * slips[1])
    assert found.own["life_hours"] == pytest.approx(1 / (0.75 / lives[0] + 0.25 / lives[1]))
    assert len(found.slip_bands()) == 2
    with pytest.raises(UncertaintyError, match="speed and load come from the log"):
        at_a_load = load_scene("deng2017_table1", ["uncertainty.operating.radial_load=[700 N, 900 N]"])
        study(at_a_load, 2, seed=1, course=(conditions, seconds), execution=Execution(workers=1))


def test_workers_and_a_journal_change_no_digit_and_what_is_in_the_journal_is_not_computed_again(tmp_path):
    scene, reported = load_scene("deng2017_table1"), []
    conditions = (np.array([[4000.0, 800.0, 0.0, math.nan], [5000.0, 0.0, 2000.0, 400.0]]), np.array([30.0, 10.0]))
    with Journal(tmp_path / "points.journal") as journal:
        found = study(scene, 16, seed=1, course=conditions, execution=Execution(journal, 2, None, lambda *counts: reported.append(counts)))
        assert reported[0] == (0, 128) and reported[-1] == (128, 128)
    fields, steady = [one.field for one in found.ranges], lowest_level(scene)[0]
    for k in (0, 63, 64, 95):
        alone = settled(with_values(steady, dict(zip(fields, found.design.points[k].tolist()))), conditions[0])
        assert (found.slips[k] == alone[0]).all()
    with Journal(tmp_path / "points.journal") as journal:
        again = study(scene, 16, seed=1, course=conditions, execution=Execution(journal, 1, None, lambda *counts: reported.append(counts)))
    assert (
        reported[-1] == (0, 0) and (again.slips == found.slips).all() and again.answers["life_hours"].tolist() == found.answers["life_hours"].tolist()
    )


def test_stretches_keep_the_means_of_a_course_and_leave_gaps_out():
    times = np.array([0.0, 1.0, 2.0, 7.0, 10.0])
    inputs = np.stack([100.0 + 10.0 * times, times, 0.0 * times, 0.0 * times + math.nan], axis=-1)
    whole = stretches(times, inputs, np.zeros(5, bool), 4)
    assert whole.seconds.sum() == pytest.approx(10.0) and whole.seconds @ whole.conditions[:, 0] == pytest.approx(1500.0)
    assert np.isnan(whole.conditions[:, 3]).all()
    cut = stretches(times, inputs, np.array([False, False, False, True, False]), 10)
    assert cut.seconds.sum() == pytest.approx(5.0) and not ((cut.middles > 2.0) & (cut.middles < 7.0)).any()


def bands(*arguments):
    found = CliRunner().invoke(main, ["uncertainty", "deng2017_table1", "--workers", "1", *map(str, arguments)])
    return found


def test_the_command_tells_bands_shares_errors_and_sources(tmp_path):
    found = bands("--samples", 12, "--json", "--out", tmp_path / "points.csv", "--picture", tmp_path / "bands.png")
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    assert (report["samples"], report["evaluations"], report["level"], report["seed"]) == (16, 16 * 8, "steady", 2017)
    slip = report["cage_slip"]
    assert slip["p05"] < slip["p50"] < slip["p95"] and slip["p05_interval"][0] <= slip["p05"] <= slip["p05_interval"][1]
    assert max(slip["shares"], key=lambda field: slip["shares"][field]["total"]) == "lubricant.mixture_fraction"
    assert report["ranges"]["lubricant.temperature"]["source"].startswith("judgement")
    rows = list(csv.reader(open(tmp_path / "points.csv")))
    assert rows[0][1] == "lubricant.temperature [K]" and len(rows) == 1 + 16 * 8
    assert (tmp_path / "bands.png").stat().st_size > 20_000
    again = json.loads(bands("--samples", 16, "--json").stdout)
    assert again["cage_slip"] == slip and again["kept_from_before"] == 0, "the seed decides"
    resumed = json.loads(bands("--samples", 16, "--json", "--out", tmp_path / "points.csv").stdout)
    assert resumed["cage_slip"] == slip and resumed["kept_from_before"] == 16 * 8, "the study may replace its own file"
    before = (tmp_path / "points.csv").read_bytes()
    other = bands("--samples", 16, "--seed", 1, "--out", tmp_path / "points.csv")
    assert other.exit_code == 2 and "points.csv exists and was not written by this study; use --force to replace it" in other.output
    assert (tmp_path / "points.csv").read_bytes() == before
    (tmp_path / "points.csv").write_text("notes of the user")
    edited = bands("--samples", 16, "--out", tmp_path / "points.csv")
    assert edited.exit_code == 2 and (tmp_path / "points.csv").read_text() == "notes of the user"


def test_the_command_prints_a_table_and_refuses_in_one_line():
    shown = bands("--samples", 4)
    assert shown.exit_code == 0 and "cage slip: 5, 50, 95 % quantile" in shown.output and "lubricant.mixture_fraction" in shown.output
    text = " ".join(shown.output.replace("│", " ").split())
    assert "h (no dimension is uncertain); scene's own values" in text and "left out lubricant.rolling_resistance is none" in text
    refused = bands("--samples", 4, "--set", "lubricant.temperature=60 degC")
    assert refused.exit_code == 2 and "excludes the scene's own value, 60 degC" in refused.output
    assert bands("--level", "cheap").exit_code == 2 and bands("--picture", "bands.gif").exit_code == 2


def test_the_command_tells_bands_over_a_log(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=4.0)
    found = bands("--samples", 2, "--log", log, "--stretches", 3, "--json", "--picture", tmp_path / "course.png")
    assert found.exit_code == 0, found.output
    course = json.loads(found.stdout)["course"]
    assert len(course) == 3 and course[0]["p50"] == pytest.approx(course[2]["p50"]) and course[0]["p05"] < course[0]["p95"]
    assert (tmp_path / "course.png").exists()


def test_bands_over_a_log_say_for_how_long_its_inputs_are_unknown(tmp_path):
    loads = [(0.1 * k, 40e3 if 20 <= k < 39 else 800.0, 0.0) for k in range(61)]
    log = write_log(tmp_path / "log.mcap", [(time, 4000.0) for time, _, _ in loads], loads)
    found = bands("--samples", 2, "--log", log, "--stretches", 3, "--json", "--set", "input_limits.maximum_load=1 kN")
    assert found.exit_code == 3
    report = json.loads(found.stdout)
    assert report["unknown_seconds"] == pytest.approx(2.0) and report["log_seconds"] == pytest.approx(6.0)
    assert "life is at most" in report["verdict"] and "input_limits.maximum_load" in report["verdict"] and "103 of 122 messages used" in found.stderr


def test_a_band_says_that_it_contains_no_dimension_unless_one_decides_the_clearance():
    note = " (no dimension is uncertain)"
    assert without_dimensions(ranges()) == note == without_dimensions(["bearing.roller.count", "bearing.inner_raceway.ring_mass"])
    for field in ("outer_raceway.low_radius", "outer_raceway.d_value", "inner_raceway.radius", "roller.diameter", "clearance"):
        assert without_dimensions([*ranges(), f"bearing.{field}"]) == ""
    assert without_dimensions(one.field for one in load_scene("deng2017_table1_cold").uncertainty) == ""
    rows = dict(live_band_rows({"rating_life": (383.0, 390.0), "cage_slip": (0.05, 0.09)}, load_scene("deng2017_table1")))
    assert rows["rating life, 5 to 95 %"] == f"383 h to 390 h{note}" and note not in rows["cage slip, 5 to 95 %"]
    cold = load_scene("deng2017_table1_cold")
    assert all(note not in text for _, text in band_rows({"remaining_life": (194.0, 816.0)}, cold)) and left_out(cold) == []


def test_a_run_prints_bands_on_request():
    arguments = ["run", "deng2017_table1", "--duration", "0.02", "--uncertainty", "4"]
    found = CliRunner().invoke(main, [*arguments, "--json"])
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    assert report["level"] == "slip" and report["uncertainty"]["level"] == "steady" and report["uncertainty"]["cage_slip"]["p95"] > 0.05
    shown = CliRunner().invoke(main, arguments)
    assert "cage slip depends on" in shown.output and "32 runs of level steady" in shown.output


def test_clearance_group_oil_temperature_and_films_of_a_catalogue_bearing_are_uncertain_by_themselves():
    lubricant = {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "65 degC"}
    motor = {"name": "motor", "bearing": "NU 210/C3", "lubricant": lubricant, "operating": {"shaft_speed": "1480 rpm", "radial_load": "5 kN"}}
    scene = load_scene(motor)
    found = {one.field: (one.low, one.high) for one in varied_ranges(scene)}
    assert found["bearing.clearance"] == pytest.approx((50e-6, 80e-6))  # ISO 5753-1, C3 of bores over 40 to 50 mm
    assert found["lubricant.temperature"] == pytest.approx((328.15, 348.15))
    assert found["lubricant.starvation.constant"] == pytest.approx((1.5e-8, 6e-8))
    assert {f"lubricant.mixed_friction.{name}" for name in ("boundary_friction", "film_ratio_factor", "skew")} < found.keys()
    # what somebody has declared or chosen stays
    chosen = load_scene(scene, ["uncertainty.lubricant.temperature=[60 degC, 66 degC]", "lubricant.mixed_friction.boundary_friction=0.2"])
    other = {one.field: (one.low, one.high) for one in varied_ranges(chosen)}
    assert other["lubricant.temperature"] == pytest.approx((333.15, 339.15)) and "lubricant.mixed_friction.boundary_friction" not in other
    # a scene whose names have become numbers is the same bearing
    assert settle(filled_in(scene), "steady").cage_slip == pytest.approx(settle(scene, "steady").cage_slip, rel=1e-9)
    # in a bath that covers the lowest rollers no contact is starved
    deep = load_scene(scene, ["lubricant.supply={law: oil_bath, level: 20 mm}"])
    assert "lubricant.starvation.constant" not in {one.field for one in varied_ranges(deep)}
