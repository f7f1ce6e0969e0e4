# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The sweep: its points are single runs, its tables say their units, it goes on after a kill, and refuses what it cannot mean."""

import csv
import json
import math
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pyarrow.parquet
import pytest
from click.testing import CliRunner

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.model.sample import OBSERVABLES, new_block
from bearing_sim.simulation import Counters
from bearing_sim.sweep import point
from bearing_sim.sweep.grid import FieldError, axis, read_axis, run_sweep
from bearing_sim.sweep.pictures import NotDrawable, new_figure, plot_table, set_limits
from bearing_sim.sweep.point import RESULTS, point_row
from bearing_sim.sweep.settling import Outcome
from bearing_sim.sweep.table import read_table, write_table
from bearing_sim.sweep.tasks import Journal

LOW = "bearing.outer_raceway.low_radius"
SPEED = "operating.shaft_speed"


def swept(*axes, overrides=(), duration=0.05, scene="deng2017_table1"):
    with Journal() as journal:
        return run_sweep(scene, [read_axis(text) for text in axes], overrides, journal=journal, duration=duration, workers=1)


@pytest.mark.parametrize(
    ("text", "values", "unit"),
    [
        (f"{LOW}=34.86mm:34.8675mm:4", (0.03486, 0.0348625, 0.034865, 0.0348675), "mm"),
        (f"{SPEED} = 15000 rpm : 45000 rpm : 2", (15000 * math.pi / 30, 45000 * math.pi / 30), "rpm"),
        ("operating.load_angle=0:60deg:3", (0.0, math.pi / 6, math.pi / 3), "deg"),
        ("lubricant.temperature=80degC,120degC", (353.15, 393.15), "degC"),
        ("operating.radial_load=100,800 N", (100.0, 800.0), "N"),
        ("lubricant.mixture_fraction=1.5%:5%:2", (0.015, 0.05), ""),
        ("bearing.roller.count=12:18:3", (12, 15, 18), ""),
        ("bearing.roller.crown=none,iso_log", ("none", "iso_log"), ""),
        ("level=steady,slip", ("steady", "slip"), ""),
        ("bearing.cage.land_squeeze=true,false", ("true", "false"), ""),
    ],
)
def test_a_text_says_which_values_a_field_takes(text, values, unit):
    read = read_axis(text)
    assert read.values == pytest.approx(values, rel=1e-11) if isinstance(values[0], float) else read.values == values
    assert read.field.unit == unit


def test_a_logarithmic_axis_begins_and_ends_at_the_decades_about_its_values():
    for values, ends in (([100.0, 1000.0], (100.0, 1000.0)), ([99.0, 1001.0], (10.0, 10_000.0)), ([100.0, 100.0], (100.0, 1000.0))):
        axes = new_figure(4.0, 3.0).add_subplot()
        set_limits(axes, np.array(values), True)
        assert axes.get_ylim() == pytest.approx(ends)


def test_even_steps_are_what_a_person_would_write():
    assert read_axis(f"{LOW}=34.86mm:34.8675mm:7").values[2] == 0.0348625
    assert read_axis(f"{LOW}=34.86mm:34.8675mm:7").shown[2] == 34.8625


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("bearing.outer_raceway.low_radus=1mm:2mm:3", "did you mean 'low_radius'"),
        ("bearing.outer_raceway=1:2:3", "a block"),
        ("operating.shaft_speed.rpm=1:2:3", "is a value, not a block"),
        (f"{LOW}=34.86mm:34.87mm", "START:STOP:N"),
        (f"{LOW}=34.86:34.87mm:3", "only one end has a unit"),
        (f"{LOW}=34.86N:34.87N:3", "wrong dimension"),
        (f"{LOW}=34.86mm:34.87mm:0", "from 1 to"),
        ("bearing.roller.count=12:18:4.5", "START:STOP:N"),
        ("bearing.roller.count=12:17:3", "whole numbers"),
        ("bearing.roller.crown=1:2:3", "a range needs numbers"),
        (LOW, "FIELD="),
    ],
)
def test_what_cannot_be_varied_is_refused_with_the_reason(text, reported):
    with pytest.raises(FieldError, match=reported):
        read_axis(text)


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_a_point_is_what_a_single_run_says(level):
    table = swept(f"{LOW}=34.86mm,34.865mm", f"{SPEED}=30000rpm,45000rpm", overrides=[f"level={level}"], duration=0.3)
    assert len(table.rows) == 4
    for row in table.rows:
        scene = load_scene("deng2017_table1", [f"level={level}", f"{LOW}={row[LOW]!r}mm", f"{SPEED}={row[SPEED]!r}rpm"])
        run = Simulation(scene)
        run.advance(0.24)
        block = run.advance(0.06, samples=333)
        assert row["cage_slip"] == pytest.approx(100 * block["cage_slip"].mean(), rel=2e-3)
        # lives of level slip are running means over a turn of the cage, of some forty steps: they scatter by 3 %, and 20 turns are in a window
        assert row["rating_life"] == pytest.approx(1.0 / (1.0 / block["rating_life"]).mean(), rel=2e-3 if level == "steady" else 1e-2)
        for name in ("inner_load", "outer_load"):
            largest = block[name].max()
            assert largest <= block[f"{name}_maximum"].max() and row[f"{name}_maximum"] == pytest.approx(largest, rel=5e-3)
        assert row["shaft_power"] == pytest.approx(block["shaft_power"].mean(), rel=5e-3)
        assert row["status"] == "ok" and row["simulated"] >= 0.3


def test_levels_slip_and_steady_agree_at_the_points_of_a_sweep():
    table = swept(f"{LOW}=34.86mm,34.865mm", "level=steady,slip", duration=0.5)
    for steady, slip in zip(table.rows[::2], table.rows[1::2]):
        assert (steady["level"], slip["level"]) == ("steady", "slip")
        assert steady["cage_slip"] == pytest.approx(slip["cage_slip"], abs=0.06)
        assert steady["rating_life"] == pytest.approx(slip["rating_life"], rel=0.01)


def test_a_run_that_has_not_settled_goes_on_until_it_has():
    scene = load_scene("deng2017_table1", ["level=steady", f"{LOW}=34.8675mm"])  # its cage needs tenths of a second
    short, long = point_row(scene, 0.05), point_row(scene, 5.0)
    assert 0.1 < short["simulated"] < 2.0 and short["status"] == "ok"
    assert short["cage_slip"] == pytest.approx(long["cage_slip"], abs=0.05)  # as is promised
    assert long["simulated"] == pytest.approx(5.0) and long["status"] == "ok"


def test_a_point_that_does_not_settle_says_what_it_was_doing(monkeypatch):
    monkeypatch.setattr(point, "longest_run", lambda scene: 0.06)
    hasty = point_row(load_scene("deng2017_table1", ["level=steady", f"{LOW}=34.8675mm"]), 0.05)
    assert hasty["status"] == "unsettled" and hasty["reason"].startswith("after 0.06 s cage slip still rises by")


def test_points_that_cannot_be_or_fail_are_rows_with_the_reason():
    table = swept(f"{LOW}=34.8625mm,34.0mm", "integration.step_budget=20,2000000")
    reasons = {(round(row[LOW], 4), row["integration.step_budget"]): (row["status"], row["reason"]) for row in table.rows}
    assert reasons[34.8625, 2000000] == ("ok", "")
    assert reasons[34.8625, 20][0] == "failed" and "step" in reasons[34.8625, 20][1]
    assert reasons[34.0, 20][0] == "refused" and "low_radius" in reasons[34.0, 20][1]
    assert all(math.isnan(row[column.name]) for row in table.rows if row["status"] in ("failed", "refused") for column in RESULTS)
    with pytest.raises(SceneError, match="low_radius"):
        swept(f"{LOW}=34.0mm,34.1mm")


def test_the_table_says_unit_and_meaning_of_every_column_and_reads_back_equal(tmp_path):
    table = swept(f"{LOW}=34.86mm:34.865mm:3", overrides=["level=steady"])
    parquet, text = write_table(tmp_path / "t.parquet", table)
    schema = pyarrow.parquet.read_schema(parquet)
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert units[LOW] == "mm" and units["cage_slip"] == "%" and units["rating_life"] == "h" and units["shaft_power"] == "W"
    assert all(field.metadata[b"meaning"] for field in schema)
    observed = {each.name: each.unit for each in OBSERVABLES}
    converted = {"cage_slip": "%"} | {name: "um" for name in observed if name.endswith("_clearance")}
    assert all(units[name] == converted.get(name, observed[name]) for name in units if name in observed)
    about = json.loads(schema.metadata[b"bearing_sim"])
    assert about["axes"] == [{"field": LOW, "unit": "mm", "values": [34.86, 34.8625, 34.865]}]
    assert str(read_table(parquet).rows) == str(table.rows), "as text, in which NaN equals NaN"
    with open(text) as file:
        header, *rows = csv.reader(file)
    assert header[:2] == [f"{LOW} [mm]", "cage_slip [%]"] and [float(row[0]) for row in rows] == [34.86, 34.8625, 34.865]
    assert [float(row[1]) for row in rows] == table.values("cage_slip")


def test_slip_in_the_table_is_a_share_in_percent_and_loads_hold_the_ring():
    (row,) = swept("level=slip").rows
    assert row["cage_slip_minimum"] <= row["cage_slip"] <= row["cage_slip_maximum"] and 4.0 < row["cage_slip"] < 8.0
    losses = sum(row[name] for name in row if name.endswith("_power") and name != "shaft_power")
    assert losses == pytest.approx(row["shaft_power"], rel=0.02)
    assert 3 <= row["loaded_rollers"] <= 18


def test_a_row_says_means_extremes_and_lives_as_damage_adds_up(monkeypatch):
    window = new_block(2, 4)
    for name in window.dtype.names:
        window[name] = 1.0
    window["cage_slip"], window["rating_life"] = [0.1, 0.3], [100.0, 300.0]
    window["inner_load"], window["outer_load"] = [[0.0, 0.0, 0.0, 5.0], [0.0, 2.0, 3.0, 7.0]], [[9.0] * 4, [9.0, 9.0, 9.0, 11.0]]
    window["inner_load_maximum"], window["outer_load_maximum"] = [8.0, 7.5], [9.5, 12.0]  # some of them between the samples
    window["oil_temperature"] = 300.0
    window["shaft_power"] = 100.0  # with what is accelerated; a row has the sum of the twelve losses, 1 W each
    work = Counters(*[0] * 6)
    monkeypatch.setattr(point, "run_until_settled", lambda scene, duration, longest: Outcome("settled", 0.5, 0.1, "", 0.2, window, work))
    row = point_row(load_scene("deng2017_table1"))
    assert (row["cage_slip_minimum"], row["cage_slip"], row["cage_slip_maximum"]) == pytest.approx((10.0, 20.0, 30.0))
    assert row["rating_life"] == pytest.approx(150.0), "half of the time at 100 h and half at 300 h uses as much up as 150 h do"
    assert row["loaded_rollers"] == 2.0 and (row["inner_load_maximum"], row["outer_load_maximum"]) == (8.0, 12.0)
    assert row["shaft_power"] == 12.0 and row["seal_power"] == 1.0


def test_an_axis_of_numbers_in_si_is_the_axis_of_the_text():
    assert axis(LOW, [0.03486, 0.034865]) == read_axis(f"{LOW}=34.86mm,34.865mm")


@pytest.mark.long
def test_pictures_are_lines_over_one_variable_maps_over_two_and_refused_over_three(tmp_path):
    one = swept(f"{LOW}=34.86mm:34.865mm:4", overrides=["level=steady"])
    two = swept(f"{LOW}=34.86mm:34.865mm:4", f"{SPEED}=20000rpm:50000rpm:4", overrides=["level=steady"])
    family = swept(f"{LOW}=34.86mm:34.865mm:4", "level=steady,slip")
    for name, table in (("one", one), ("two", two), ("family", family)):
        plot_table(tmp_path / f"{name}.svg", table)
    assert [(tmp_path / f"{name}.svg").read_text().count("QuadMesh") > 0 for name in ("one", "two", "family")] == [False, True, False]
    three = swept(f"{LOW}=34.86mm,34.865mm", f"{SPEED}=20000rpm,50000rpm", "operating.radial_load=100N,200N", overrides=["level=steady"])
    with pytest.raises(NotDrawable, match="this sweep has 3"):
        plot_table(tmp_path / "three.png", three)
    with pytest.raises(NotDrawable, match="reason: not a quantity"):
        plot_table(tmp_path / "one.png", one, ["reason"])


COMMAND = ["sweep", "deng2017_table1", "--vary", f"{LOW}=34.86mm:34.8675mm:31", "--level", "slip"]


@pytest.mark.long
def test_command_killed_in_mid_run_goes_on_with_nothing_computed_twice(tmp_path):
    out, journal = tmp_path / "s.parquet", tmp_path / "s.journal"
    words = [*COMMAND, "-o", str(out), "--workers", "2"]
    run = subprocess.Popen(
        [sys.executable, "-m", "bearing_sim.cli", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ}
    )
    deadline = time.monotonic() + 240
    while not (journal.exists() and journal.read_bytes().count(b"\n") >= 5):
        assert time.monotonic() < deadline and run.poll() is None, "nothing was computed"
        time.sleep(0.01)
    run.send_signal(signal.SIGKILL)
    run.wait()
    kept = journal.read_bytes().count(b"\n")
    assert 5 <= kept < 31 and not out.exists()
    again = CliRunner().invoke(main, [*words, "--json", "--picture", str(tmp_path / "s.png")])
    assert again.exit_code == 0, again.output
    report = json.loads(again.stdout)
    assert (report["kept_from_before"], report["computed"], report["ok_points"]) == (kept, 31 - kept, 31)
    assert journal.read_bytes().count(b"\n") == 31
    third = json.loads(CliRunner().invoke(main, [*words, "--json"]).stdout)
    assert (third["kept_from_before"], third["computed"]) == (31, 0) and third["points"] == report["points"]
    slips = [row["cage_slip"] for row in report["points"]]
    assert slips == sorted(slips) and (tmp_path / "s.png").stat().st_size > 10_000
    drawn = CliRunner().invoke(main, ["plot", str(out), "--picture", str(tmp_path / "p.png"), "--quantity", "shaft_power"])
    assert drawn.exit_code == 0 and (tmp_path / "p.png").stat().st_size > 5_000


def test_a_finer_sweep_computes_only_what_is_new(tmp_path):
    def run(count):
        words = ["sweep", "deng2017_table1", "--level", "steady", "--vary", f"{LOW}=34.86mm:34.865mm:{count}", "-o", str(tmp_path / "f"), "--force"]
        return json.loads(CliRunner().invoke(main, [*words, "--json", "--workers", "1"]).stdout)

    assert run(3)["computed"] == 3
    assert (run(5)["computed"], run(5)["computed"]) == (2, 0)


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["--vary", f"{LOW}=34.86mm:34.87mm:3", "--vary", f"{LOW}=1mm"], "given 2 times"),
        (["--vary", "level=slip,planar", "--level", "slip"], "contradict"),
        (["--vary", f"{LOW}=34.86mm:34.87mm:3", "--picture", "a.doc"], "expected a name that ends"),
        (["--vary", f"{LOW}=34.86mm:34.87mm:3", "--duration", "-1"], "-1 s is outside 1e-12 s to 1e+06 s"),
        (["--vary", "nothing=1"], "unknown field"),
        (["--vary", f"{LOW}=1mm:34.87mm:1000", "--vary", f"{SPEED}=1rpm:2rpm:2000"], "points; a sweep has at most"),
    ],
)
def test_command_refuses_what_it_cannot_mean(words, reported):
    result = CliRunner().invoke(main, ["sweep", "deng2017_table1", *words])
    assert result.exit_code == 2 and reported in result.output


def test_plot_refuses_files_that_are_no_tables(tmp_path):
    (tmp_path / "a.parquet").write_text("no")
    result = CliRunner().invoke(main, ["plot", str(tmp_path / "a.parquet")])
    assert result.exit_code == 2 and "not readable as Parquet" in result.output
    assert CliRunner().invoke(main, ["plot", str(tmp_path / "b.parquet")]).exit_code == 2
