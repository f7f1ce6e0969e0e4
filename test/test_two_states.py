# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run, replays and live model warn where a corrected table has one of two states that level planar has, and beyond its ends."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import write_log
from support import ListSink
from test_governor import TICK, FakeLevel
from test_live import Bench

from bearing_sim.cli import table as table_command
from bearing_sim.cli.main import main
from bearing_sim.levels.steady import table_builder
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.messages.events import Event, Level
from bearing_sim.model.validity import outside, still_sample
from bearing_sim.recording.reader import Recording
from bearing_sim.runtime.governor import Governor
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies import fleet as fleet_replay
from bearing_sim.watchers.estimation import correction as corrections
from bearing_sim.watchers.estimation.correction import Correction, correction_domain, correction_path, write_correction
from bearing_sim.watchers.estimation.response import coordinates
from bearing_sim.watchers.estimation.two_states import TwoStates, laws_of_table

PAPER = "deng2017_table1"
CORRECTED = ("level=steady", "table.correction=planar")
SLOW, FAST = 20_000.0 * math.pi / 30.0, 45_000.0 * math.pi / 30.0
LOAD = 800.0


def made_up(scene, temperatures=None, two_states_at_speed=FAST):
    """Return a correction by nothing, of 12 points, whose states slip by 8 and 20 % at one of two speeds."""
    domain, kelvin = correction_domain(scene, temperatures), scene.lubricant.temperature
    conditions = np.array([(speed, LOAD, kelvin, angle) for speed in (SLOW, FAST) for angle in np.arange(6) * domain.period / 6.0])
    columns, count = coordinates(conditions, domain).shape[1], len(conditions)
    there = conditions[conditions[:, 0] == two_states_at_speed]
    states = np.column_stack([there, np.full(len(there), 0.08), np.full(len(there), 0.2)])
    nothing = np.zeros((count + columns + 1, len(ANSWER))), np.zeros((count, len(ANSWER))), np.zeros((count, 2))
    return Correction(domain, conditions, np.array([np.eye(columns)] * 2), *nothing, states, 0, 1.0)


@pytest.fixture
def keep(tmp_path, monkeypatch):
    """Return a function that keeps a made-up correction of a scene on disk; tables are empty, so that operating points are solved for."""
    monkeypatch.setattr(corrections, "FOLDER", tmp_path)
    monkeypatch.setattr(table_command, "build_with_progress", lambda *given: (empty_table(), None))
    monkeypatch.setattr(table_builder, "FOLDER", tmp_path)
    monkeypatch.setattr(fleet_replay, "obtain_table", lambda *given: (empty_table(), None))
    monkeypatch.setattr(fleet_replay, "_tables", {})

    def made(scene, temperatures=None, **options):
        found = made_up(scene, temperatures, **options)
        write_correction(correction_path(scene, found.domain), found)

    return made


def corrected(*overrides):
    return load_scene(PAPER, [*CORRECTED, *overrides])


def constant(scene):
    """Return the temperatures of a table for the scene's oil temperature alone."""
    return scene.lubricant.temperature, scene.lubricant.temperature


def command(name, *arguments):
    result = CliRunner().invoke(main, [name, *map(str, arguments), *(word for each in CORRECTED for word in ("--set", each)), "--json"])
    assert result.exit_code == 0, result.output
    warnings = {each["name"]: each for each in json.loads(result.stdout)["warnings"]}
    return warnings, result.stderr


def at_speed(scene, *speeds):
    samples = np.repeat(still_sample(scene), len(speeds))
    samples["shaft_speed"] = speeds
    return samples


def two_states_at(scene, samples):
    return outside(scene, samples, ("table_states",), laws_of_table(scene))


def test_operating_points_next_to_one_of_two_states_have_both_slips_and_others_have_none():
    found = TwoStates(correction := made_up(corrected()))
    fast, slow = correction.conditions[-2], correction.conditions[0]
    there, elsewhere = found.slips_near(np.array([fast * [1.001, 1.001, 1.0, 1.0], slow]))
    assert there.tolist() == [0.08, 0.2] and np.isnan(elsewhere).all()


def test_a_table_states_warning_gives_the_difference_and_where_it_was_found(keep):
    scene = corrected()
    keep(scene)
    (found,) = two_states_at(scene, at_speed(scene, SLOW, FAST, SLOW))
    assert found.law.name == "table_states" and found.value == pytest.approx(12.0)
    assert "at 6 points measured, 45000 to 45000 rpm and 800 to 800 N" in found.text and found.text.endswith("use level planar")


def test_there_is_no_warning_of_one_state_at_rest_of_a_plain_table_and_at_other_levels(keep):
    scene = corrected()
    keep(scene)
    assert two_states_at(scene, at_speed(scene, SLOW)) == two_states_at(scene, at_speed(scene, 0.0)) == []
    for others in (["table.correction=none"], ["level=slip"]):
        assert laws_of_table(load_scene(scene, others)) == ()
    keep(scene, two_states_at_speed=None)
    assert two_states_at(scene, at_speed(scene, FAST)) == []


def test_a_correction_that_is_not_on_disk_is_not_judged_by(keep):
    assert two_states_at(corrected(), at_speed(corrected(), FAST)) == []


def test_the_ends_of_a_table_are_those_of_the_temperatures_that_it_was_built_for():
    scene = corrected()
    samples = at_speed(scene, SLOW)
    for kelvin, ends, beyond in ((300.0, None, True), (300.0, (295.0, 305.0), False), (scene.lubricant.temperature, (295.0, 305.0), True)):
        samples["oil_temperature"] = kelvin
        found = outside(scene, samples, ("table_correction",), laws_of_table(scene, ends))
        assert [each.law.name for each in found] == ["table_correction"] * beyond


def test_run_warns_of_two_states_and_reports_them(keep):
    scene = corrected()
    keep(scene, constant(scene))
    found, printed = command("run", PAPER, "--duration", "0.05")
    assert found["table_states"]["value"] == pytest.approx(12.0) and "warning: table_states: " in printed
    found, printed = command("run", PAPER, "--duration", "0.05", "--set", f"operating.shaft_speed={SLOW} rad/s")
    assert "table_states" not in found and "table_states" not in printed


def test_replay_judges_by_the_table_that_it_builds_for_the_speeds_and_temperatures_of_the_log(keep, tmp_path):
    log, times = tmp_path / "log.mcap", np.arange(11) * 0.2
    write_log(log, [(time, 1.3 * FAST) for time in times.tolist()], [(time, LOAD, 0.0) for time in times.tolist()])
    found, printed = command("replay", log, "--scene", PAPER, "--oil-temperature", "30 degC")
    assert "table_correction" not in found and "table_correction" not in printed
    found, _ = command("replay", log, "--scene", PAPER, "--set", f"table.maximum_speed={FAST} rad/s")
    assert found["table_correction"]["value"] == pytest.approx(1.3)


def replayed(folder, fast_from, fast_until):
    """Replay 12 s of a log that is fast between two times; return the warnings and the times of the events, with their levels."""
    log, out, times = folder / "log.mcap", folder / "out.mcap", np.arange(61) * 0.2
    speeds = [(time, FAST if fast_from <= time <= fast_until else SLOW) for time in times.tolist()]
    write_log(log, speeds, [(time, LOAD, 0.0) for time, _ in speeds])
    found, printed = command("replay", log, "--scene", PAPER, "-o", out)
    events = [(each.time, each.level) for each in Recording(out) if isinstance(each, Event) and each.subject == "table_states"]
    return found, printed, events


def test_replay_warns_of_two_states_reports_them_and_records_when(keep, tmp_path):
    scene = corrected()
    keep(scene, constant(scene))
    found, printed, events = replayed(tmp_path, 3.0, 5.0)
    assert found["table_states"]["value"] == pytest.approx(12.0) and found["table_states"]["unit"] == "points"
    assert printed.count("warning: table_states: ") == 1
    (begin, warned), (end, over) = events
    assert (warned, over) == (Level.WARN, Level.OK)
    assert begin == pytest.approx(3.0, abs=0.21) and end == pytest.approx(10.0, abs=0.41), "5 s after the last fast one"


def test_replay_away_from_two_states_is_silent(keep, tmp_path):
    scene = corrected()
    keep(scene, constant(scene))
    found, printed, events = replayed(tmp_path, 99.0, 99.0)
    assert "table_states" not in found and "table_states" not in printed and not events


def test_a_fleet_counts_bearings_at_two_states_and_beyond_the_corrected_table_in_its_table_and_on_stderr(keep, tmp_path):
    scene, times = corrected(), (np.arange(6) * 0.2).tolist()
    keep(scene, constant(scene))
    (tmp_path / "logs").mkdir()
    for name, speed in (("slow", SLOW), ("fast", FAST)):
        write_log(tmp_path / "logs" / f"{name}.mcap", [(time, speed) for time in times], [(time, LOAD, 0.0) for time in times])

    def replay_fleet(*words):
        settings = [word for each in CORRECTED for word in ("--set", each)]
        common = ["--scene", PAPER, "--workers", "1", "-o", tmp_path / "fleet.parquet", "--force", *settings]
        result = CliRunner().invoke(main, ["replay-fleet", str(tmp_path / "logs"), *map(str, common), *words], catch_exceptions=False)
        assert result.exit_code == 0, result.output
        return result

    def reported(*words):
        report = json.loads(replay_fleet("--json", *words).stdout)
        return {row["bearing"]: row["warnings"] for row in report["bearings"]}, report["warnings"]

    cells, (told,) = reported()
    assert cells == {"slow": "", "fast": "table_states 12 points"}
    assert told.startswith("1 x table_states: ") and told.endswith("use level planar")
    assert f"warning: {told}" in replay_fleet().stderr.splitlines()
    cells, (told,) = reported("--set", "table.maximum_load=400 N")
    assert cells == {"slow": "table_correction 2", "fast": "table_correction 2"} and told.startswith("2 x table_correction: ")


@pytest.mark.parametrize(("speed", "is_told"), [(SLOW, True), (FAST, False)])
def test_the_live_model_reports_two_states_once_in_news_recording_and_diagnostics(keep, speed, is_told):
    keep(corrected(), two_states_at_speed=speed)
    bench, sink = Bench(scene=CORRECTED), ListSink()  # whose shaft turns slowly
    bench.live.open("record", lambda start_ns: sink)
    bench.run(0.6)
    condition = bench.live.condition(bench.now_ns)
    bench.live.close()
    for events in (condition.events, bench.news, sink.events):
        told = [event for event in events if event.subject == "table_states"]
        assert len(told) == is_told
        assert all(event.kind == "validity.level" and event.level is Level.WARN and event.action == "use level planar" for event in told)


def test_a_governor_at_a_corrected_table_has_its_limits_until_it_returns(keep):
    wanted, faster, told = FakeLevel("planar"), FakeLevel("steady"), {"table_states", "table_correction"}
    faster.scene = corrected("table.maximum_load=400 N")
    keep(faster.scene, two_states_at_speed=SLOW)
    bench = Bench(scene=["level=planar"], simulation=wanted, governor=Governor([wanted, faster], patience=0.3))

    def warned():
        return told & {event.subject for event in bench.live.condition(bench.now_ns).events}

    bench.run(0.2)
    assert warned() == set()
    wanted.seconds_per_tick, faster.seconds_per_tick = 3.0 * TICK, 0.5 * TICK
    bench.run(1.5)
    assert bench.live.condition(bench.now_ns).values["level"] == "steady" and warned() == told
    wanted.seconds_per_tick = faster.seconds_per_tick = 0.0
    bench.run(1.5)
    condition = bench.live.condition(bench.now_ns)
    bench.live.close()
    assert condition.values["level"] == "planar" and not told & {event.subject for event in condition.events}
    for subject in told:
        (event,) = [event for event in bench.news if event.subject == subject]
        assert event.level is Level.WARN and event.kind == "validity.level"
