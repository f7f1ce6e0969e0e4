# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about load spectra: mean values as printed, damage by Miner, tables in any layout, classes of a log, and points without a result."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import write_log

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.scene.display import hours
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs
from bearing_sim.studies import spectrum as studied
from bearing_sim.studies.spectrum import EXPONENT, evaluate, mean_speed_and_load, spectrum_of_log
from bearing_sim.sweep.conditions import OperatingPoint, PointError, Spectrum, read_points, read_spectrum
from bearing_sim.sweep.point import empty_row
from bearing_sim.sweep.tasks import Execution

RPM = math.pi / 30
CATALOGUE = {
    "name": "catalogue",
    "level": "steady",
    "bearing": "NU 210",
    "lubricant": {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "70 degC"},
    "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
}


def test_the_mean_load_is_that_of_a_printed_example():
    """R. L. Mott, Machine Elements in Mechanical Design, 4th ed., example problem 14-6: a ball bearing at constant speed, 597 lb."""
    speed, load = mean_speed_and_load([600.0] * 3, [650.0, 750.0, 250.0], [30.0, 10.0, 20.0], exponent=3.0)
    assert (speed, round(load)) == (600.0, 597)


def test_of_speeds_the_mean_is_that_over_time_and_of_loads_that_over_revolutions():
    speed, load = mean_speed_and_load([3000.0, -1000.0, 0.0], [2.0, 5.0, 1e9], [0.5, 0.25, 0.25])
    assert speed == pytest.approx(1750.0), "time at rest counts for the speed"
    assert load == pytest.approx(((1500.0 * 2.0**EXPONENT + 250.0 * 5.0**EXPONENT) / 1750.0) ** 0.3), "and not for the load"
    assert math.isnan(mean_speed_and_load([0.0], [1.0], [1.0])[1])


@pytest.mark.timeout(300)
@pytest.mark.parametrize("changes", [{}, {"bearing": "NU 232", "operating": {"shaft_speed": "1500 rpm", "radial_load": "60 kN"}}])
def test_the_l10_of_the_mean_load_at_the_mean_speed_is_that_of_all_points(changes):
    """The sum over the points and the mean values are two ways to the same life: (C/P_m)^p revolutions at n_m."""
    scene = load_scene(CATALOGUE | changes)
    load = scene.operating.radial_load
    points = (OperatingPoint(100.0, load, 3.0), OperatingPoint(-200.0, 0.6 * load, 5.0), OperatingPoint(50.0, 2.0 * load, 1.0))
    found = evaluate(scene, Spectrum(points, resting=1.0), 0.05, Execution(workers=1))
    rating = scene.bearing.ratings.dynamic
    by_mean = 1e6 * (rating / found.mean_load) ** EXPONENT / (found.mean_speed / (2.0 * math.pi) * 3600.0)
    assert found.lives["l10"] == pytest.approx(by_mean, rel=1e-6)
    rows = found.table.rows
    assert found.life == pytest.approx(1.0 / sum(0.01 * row["share"] / row["modified_rating_life"] for row in rows))
    assert sum(row["damage_share"] for row in rows) == pytest.approx(100.0) and found.resting == pytest.approx(0.1)
    assert sum(row["share"] for row in rows) == pytest.approx(90.0), "the rest is time at rest"
    assert found.static_safety == pytest.approx(min(row["static_safety"] for row in rows)) and rows[2]["static_safety"] == found.static_safety


def test_a_point_without_a_result_leaves_no_life_and_says_so(monkeypatch):
    monkeypatch.setattr(studied, "point_row", lambda scene, duration: failing(scene))

    def failing(scene):
        if scene.operating.radial_load > 1000.0:
            return empty_row("failed", "no balance")
        return empty_row("ok", "") | {"l10": 1.0, "modified_rating_life": 2.0, "equivalent_load": 5.0, "static_safety": 9.0, "cage_slip": 1.0}

    points = (OperatingPoint(100.0, 500.0, 3.0), OperatingPoint(100.0, 2000.0, 1.0))
    found = evaluate(load_scene(CATALOGUE), Spectrum(points), execution=Execution(workers=1))
    assert math.isnan(found.life) and found.missing == pytest.approx(0.25)
    assert [row["status"] for row in found.table.rows] == ["ok", "failed"]
    assert studied.by_damage(found.table)[0]["reason"] == "no balance", "what has no result is shown first"


GERMAN = "Zeitanteil [%];Drehzahl [1/min];Radiallast [kN];Axiallast [kN];Öltemperatur [°C]\n40;1.500;60,5;2,5;64\n50;1.200;35;0;60\n10;0;1;0;20\n"
PLAIN = "oil_temperature,hours,speed [rpm],load [N],axial_load [N]\n337.15,40 h,1500,60500,2500\n333.15,50 h,1200,35000,0\n293.15,10 h,0,1000,0\n"


def test_tables_are_read_by_their_headings_in_any_language_and_number_format(tmp_path):
    (tmp_path / "german.csv").write_bytes(GERMAN.encode("cp1252"))
    (tmp_path / "plain.csv").write_text(PLAIN.replace("337.15", "64 degC").replace("333.15", "60 degC").replace("293.15", "20 degC"))
    german, plain = read_spectrum(tmp_path / "german.csv"), read_spectrum(tmp_path / "plain.csv")
    expected = ((1500 * RPM, 60500.0, 0.4, 337.15, 2500.0), (1200 * RPM, 35000.0, 0.5, 333.15, 0.0))
    for point, numbers in zip(german.points, expected, strict=True):
        assert point[:5] == pytest.approx(numbers)
    assert german.resting == pytest.approx(0.1) and german.hours is None
    assert [point[:2] + point[3:5] for point in plain.points] == [pytest.approx(point[:2] + point[3:5]) for point in german.points]
    assert [point.weight for point in plain.points] == [40.0, 50.0]
    with pytest.raises(PointError, match="leave the point out"):
        read_points(tmp_path / "german.csv")


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("Zeit;Drehzahl [1/min];Radiallast [kN]\n05.03.2026 00:00:00;1500;60\n05.03.2026 00:00:01;1500;61\n", "import-csv --guess"),
        ("weight,speed [rpm],load [kN]\n1,1500,-60\n2,1500,60\n", "line 2: radial_load"),
        ("weight,speed [rpm],load [kN]\n1,0,60\n2,0,60\n", "the shaft stands at every point"),
        ("weight,speed,load [kN]\n1,1500,60\n2,1500,60\n", "write 1500 rpm"),
    ],
)
def test_what_is_no_spectrum_is_refused_with_what_to_do(tmp_path, text, reported):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(PointError, match=reported):
        read_spectrum(tmp_path / "p.csv")


def test_shares_that_do_not_add_up_are_said(tmp_path):
    (tmp_path / "p.csv").write_text("share [%],speed [rpm],load [kN]\n50,1500,60\n45,1500,40\n")
    assert "add up to 95 %" in read_spectrum(tmp_path / "p.csv").notes[0]


def profile_of(path, speeds, loads, temperatures=()):
    scene = load_scene("deng2017_table1")
    return judge(read_input_log(write_log(path, speeds, loads, temperatures)), scene.accepted_inputs, Inputs(0.0, 0.0, 0.0, 300.0))


def test_the_classes_of_a_log_keep_its_time_its_revolutions_and_the_damage_of_its_loads(tmp_path):
    generator = np.random.default_rng(4)
    times = 0.1 * np.arange(2000)
    speeds, loads = 2000.0 + 1500.0 * np.sin(0.05 * times), 400.0 + 300.0 * generator.random(len(times))
    profile = profile_of(tmp_path / "log.mcap", list(zip(times, speeds)), [(time, load, 0.0) for time, load in zip(times, loads)])
    found = spectrum_of_log(profile, 350.0, (8, 8, 1))
    weights, speed, load = (np.array([point[k] for point in found.points]) for k in (2, 0, 1))
    middle_speed, middle_load = 0.5 * (speeds[1:] + speeds[:-1]), 0.5 * (loads[1:] + loads[:-1])
    assert len(found.points) <= 64 and found.hours == pytest.approx(times[-1] / 3600.0) and found.resting == 0.0
    assert weights @ speed == pytest.approx(np.mean(middle_speed) * found.hours)
    assert weights @ (speed * load**EXPONENT) == pytest.approx(np.mean(middle_speed * middle_load**EXPONENT) * found.hours)
    one = spectrum_of_log(profile, 350.0, (1, 1, 1)).points[0]
    assert one.radial_load == pytest.approx(mean_speed_and_load(middle_speed, middle_load, np.ones(1999))[1])


def test_time_at_rest_is_apart_and_time_in_gaps_is_not_counted(tmp_path):
    times = [0.1 * k for k in range(101)] + [110.0 + 0.1 * k for k in range(101)]
    speeds = [(time, 0.0 if time < 5.0 else 3000.0) for time in times]
    found = spectrum_of_log(profile_of(tmp_path / "log.mcap", speeds, [(time, 500.0, 0.0) for time in times]), 350.0, (4, 4, 1))
    assert found.resting == pytest.approx(4.9 / 3600.0, rel=1e-6)
    assert found.hours == pytest.approx(20.0 / 3600.0), "the 100 s of the gap are unknown"
    assert all(point.oil_temperature == pytest.approx(350.0) for point in found.points)


@pytest.mark.timeout(300)
def test_the_command_answers_for_a_table_and_for_a_log_and_agrees_with_a_replay(tmp_path):
    times = [0.05 * k for k in range(161)]
    log = write_log(
        tmp_path / "log.mcap",
        [(time, 3000.0 if time < 4.0 else 3500.0) for time in times],
        [(time, 800.0 if time < 4.0 else 1200.0, 0.0) for time in times],
    )
    overrides = "--set", "level=steady"
    out = "-o", tmp_path / "classes.parquet", "--picture", tmp_path / "classes.png", "--workers", "1"
    ran = CliRunner().invoke(main, list(map(str, ("spectrum", "deng2017_table1", log, *overrides, "--json", *out))))
    assert ran.exit_code == 0, ran.output
    report = json.loads(ran.stdout)
    replayed = json.loads(CliRunner().invoke(main, ["replay", str(log), "--scene", "deng2017_table1", *overrides, "--json"]).stdout)
    assert report["life_hours"] == pytest.approx(replayed["life_hours"], rel=0.02)
    assert report["damage"] == pytest.approx(replayed["damage"], rel=0.02) and (tmp_path / "classes.png").stat().st_size > 10_000
    page = CliRunner().invoke(main, ["report", str(tmp_path / "classes.parquet"), "-o", str(tmp_path / "page.html")])
    assert page.exit_code == 0 and hours(report["life_hours"]) in (tmp_path / "page.html").read_text(), page.output
    table = tmp_path / "table.csv"
    table.write_text("share,speed [rad/s],load [N]\n0.5,3000,800\n0.5,3500,1200\n")
    ran = CliRunner().invoke(main, ["spectrum", "deng2017_table1", str(table), *overrides, "-o", str(tmp_path / "t.parquet"), "--workers", "1"])
    assert ran.exit_code == 0 and "Palmgren and Miner" in ran.stdout and "P_m" in ran.stdout, ran.output
