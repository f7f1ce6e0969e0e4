# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The study of running clearance: the speeds at which something is lost, against closed forms; heat against none."""

import json
import math

import pytest
from click.testing import CliRunner
from test_running_clearance import lift_off_speed

from bearing_sim.cli.main import main
from bearing_sim.model.running_clearance import mounted, uniform
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.physics.growth import growth_at
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.clearance_map import LOAD, SPEED, at_level_steady, in_words, map_clearance, row_at

COLD, RPM = "deng2017_table1_cold", math.pi / 30.0
DENG_FASTEST = 52_000 * RPM


def scene(*overrides):
    return at_level_steady(load_scene(COLD, overrides))


def mapped(bearing, speeds, life=10.0):
    return map_clearance(bearing, [speed * RPM for speed in speeds], [800.0], life)


def test_the_fit_is_lost_at_the_speed_of_lift_off_in_closed_form():
    loose = scene("heat.law=none", "mounting.shaft.interference=15 um")
    (lost,) = [each for each in mapped(loose, (15_000, 35_000, 55_000)).losses if each.kind == "fit"]
    warm = growth_at(mounted(loose.bearing, loose.mounting), uniform(loose.lubricant.temperature))
    assert lost.shaft_speed == pytest.approx(lift_off_speed(warm), rel=1e-4) and not lost.regained


def test_clearance_that_rotation_takes_is_gone_where_its_square_law_says():
    bearing = scene("heat.law=none")
    found = mapped(bearing, (15_000, 30_000, 45_000))
    (lost,) = [each for each in found.losses if each.kind == "clearance"]
    slow, middle, fast = ((row[SPEED] * RPM) ** 2 for row in found.table.rows)
    low, half, high = (row["running_clearance"] for row in found.table.rows)
    assert (half - low) / (middle - slow) == pytest.approx((high - low) / (fast - slow), rel=1e-9)
    assert lost.shaft_speed == pytest.approx(math.sqrt(slow + low * (fast - slow) / (low - high)), rel=2e-4)
    assert in_words(found)[0].startswith("at 800 N: clearance is gone at 29,6")


def test_equilibrium_ends_where_the_hottest_part_passes_the_limit_of_the_scene():
    found = mapped(scene("heat.limit=150 degC"), (20_000, 45_000))
    (lost,) = [each for each in found.losses if each.kind in ("limit", "runaway")]
    assert lost.kind == "limit" and max(lost.values[name] for name in NODE_OBSERVABLES) == pytest.approx(150.0, abs=0.5)
    assert math.isnan(found.table.rows[-1]["life"]) and found.table.rows[-1]["status"] == "no_equilibrium"
    assert "no thermal equilibrium below the limit of 150 degC" in in_words(found)[0]


def test_the_bundled_cold_bearing_has_the_papers_preload_at_its_own_condition():
    bearing = scene()
    row = row_at(bearing, bearing.operating.shaft_speed, bearing.operating.radial_load)
    assert row["running_clearance"] == pytest.approx(-25.0, abs=0.5)


def test_heat_that_closes_the_clearance_makes_slip_at_high_speed_smaller():
    """Deng et al. 2017 name it as the reason why their model slips more than their experiment at high speed."""
    warm, cool = row_at(scene(), DENG_FASTEST, 800.0), row_at(scene("heat.law=none"), DENG_FASTEST, 800.0)
    assert warm["heat_clearance"] < -10.0 and warm["cage_slip"] < 0.5 * cool["cage_slip"]
    assert warm["life"] < cool["life"]


def test_running_dimensions_keep_their_clearance_at_every_speed():
    found = map_clearance(at_level_steady(load_scene("deng2017_table1")), [3000 * RPM, DENG_FASTEST], [500.0, 800.0], 10.0)
    assert {round(row["running_clearance"], 9) for row in found.table.rows} == {-25.0}
    assert [row[LOAD] for row in found.table.rows] == [500.0, 500.0, 800.0, 800.0]


def test_the_command_writes_table_and_picture_and_says_what_it_finds(tmp_path):
    words = ["study", "clearance", COLD, "--set", "heat.law=none", "--speed", "15000rpm:45000rpm:2", "--load", "400N:800N:2", "--json"]
    found = CliRunner().invoke(main, [*words, "-o", str(tmp_path / "map.parquet"), "--picture", str(tmp_path / "map.png")])
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    assert len(report["points"]) == 4 and [each["kind"] for each in report["losses"]] == ["clearance", "clearance"]
    assert (tmp_path / "map.csv").read_text().startswith("operating.shaft_speed [rpm],operating.radial_load [N],running_clearance [um]")
    assert (tmp_path / "map.png").stat().st_size > 10_000
