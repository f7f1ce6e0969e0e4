# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A governor falls along the measured settings of its bearing and says at which errors it runs; its recording is computed again likewise."""

import math

import numpy as np
import pytest
from test_governor import TICK, FakeLevel
from test_live import Bench

from bearing_sim import Simulation, load_scene
from bearing_sim.messages.diagnostics import report
from bearing_sim.messages.events import Event, Level
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.governor import RECORD, Governor, governor_record, recorded_settings, settings_to_fall
from bearing_sim.runtime.live import governor_of
from bearing_sim.runtime.reproduction import reproduce
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, Tradeoffs, complete_overrides
from bearing_sim.simulation import Inputs, start_sample

START = 1_700_000_000_000_000_000
NAMES = ("slip", "largest_slip", "load", "largest_load", "life", "window_life", "edge", "largest_edge")
EVERYWHERE = {"shaft_speed": (0.0, 1e4), "radial_load": (0.0, 1e5), "oil_temperature": (250.0, 500.0)}


def scene(*overrides):
    return load_scene("deng2017_table1", ["level=planar", *overrides])


def setting(level, detail, factor, slip, life=0.01, overrides=()):
    errors = dict.fromkeys(NAMES, math.nan) | {"slip": slip, "life": life}
    return Setting(level, detail, complete_overrides(scene(f"level={level}", *overrides)), factor, errors)


STEADY, SLIP = setting("steady", "table", 1860.0, 1.9, 0.12), setting("slip", "tolerances x 1", 15.0, 1.95, 0.12)
COARSE = setting("planar", "tolerances x 3", 6.9, 0.06, 0.012, ["integration.relative_tolerance=0.03"])
PLANAR = setting("planar", "tolerances x 1", 5.2, 0.047, 0.008)
FINE = setting("planar", "tolerances x 0.1", 1.2, 0.003, 0.001, ["integration.relative_tolerance=0.001"])
STEP = setting("planar", "step 40 us", 7.5, 0.05, 0.01, ["integration.fixed_step=40 us"])
SPATIAL = setting("spatial", "tolerances x 1", 1.0, 0.047, 0.008)


def front(*settings, extent=EVERYWHERE):
    return Tradeoffs(None, (MeasuredCourse("manoeuvre", "planar", dict.fromkeys(NAMES, 0.0), extent, settings),))


ALL = front(STEADY, SLIP, COARSE, PLANAR, FINE, STEP, SPATIAL)


def names(settings):
    return [one.name for one in settings]


def test_it_falls_from_the_setting_of_the_scene_along_the_front_to_the_fastest():
    assert names(settings_to_fall(scene(), ALL)) == names([PLANAR, COARSE, STEADY])  # level slip is slower and no more accurate than steady
    assert names(settings_to_fall(scene(*FINE.overrides), ALL)) == names([FINE, PLANAR, COARSE, STEADY])
    assert names(settings_to_fall(scene("level=slip"), ALL)) == names([SLIP, STEADY])


def test_a_corrected_table_that_is_not_on_disk_is_not_fallen_to(monkeypatch):
    corrected = STEADY._replace(detail="corrected", overrides=("table.correction=planar",), errors=STEADY.errors | {"slip": 0.1})
    kept = front(STEADY, corrected, PLANAR)
    monkeypatch.setattr("bearing_sim.runtime.governor.cached_table", lambda scene: None)
    assert names(settings_to_fall(scene(), kept)) == names([PLANAR, STEADY])
    monkeypatch.setattr("bearing_sim.runtime.governor.cached_table", lambda scene: scene.table.correction)
    assert names(settings_to_fall(scene(), kept)) == names([PLANAR, corrected])


def test_a_setting_that_cannot_run_at_the_conditions_of_the_scene_is_left_out():
    impossible = COARSE._replace(detail="impossible", overrides=("integration.fixed_step=9 ms",))
    made = governor_of(Simulation(scene()), [PLANAR, impossible, COARSE])
    assert [one.scene.integration.relative_tolerance for one in made._ladder] == [0.01, 0.03]
    assert made._settings == [PLANAR, COARSE]


def test_a_setting_that_is_hardly_faster_is_not_worth_a_change():
    near = setting("planar", "near", 6.0, 0.05, overrides=["integration.relative_tolerance=0.02"])
    assert "planar, near" not in names(settings_to_fall(scene(), front(PLANAR, near, COARSE)))


def test_levels_that_were_not_measured_follow_with_unknown_errors():
    fallen = settings_to_fall(scene(), front(PLANAR, COARSE))
    assert names(fallen) == ["planar, tolerances x 1", "planar, tolerances x 3", "slip, not measured", "steady, not measured"]
    assert math.isnan(fallen[2].errors["slip"])


def test_a_scene_whose_own_setting_was_not_measured_falls_to_coarser_settings_of_its_level_before_lower_levels():
    own = scene("integration.relative_tolerance=0.005")
    fallen = settings_to_fall(own, ALL)
    assert fallen[0].name == "planar, as in the scene" and math.isnan(fallen[0].errors["slip"])
    assert fallen[0].overrides == complete_overrides(own) and names(fallen[1:]) == names([PLANAR, COARSE, STEADY])
    between = settings_to_fall(scene("integration.relative_tolerance=0.02"), ALL)
    assert names(between[1:]) == names([COARSE, STEADY])


@pytest.mark.parametrize("finer", [(), ("integration.absolute_tolerance.speed=1e-6 m/s",)], ids=["coarser than all", "finer in speed alone"])
def test_settings_that_may_be_slower_than_one_that_was_not_measured_are_left_out(finer):
    fallen = settings_to_fall(scene("integration.relative_tolerance=0.2", *finer), ALL)
    assert names(fallen[1:]) == names([STEADY])


def test_a_fixed_step_that_was_not_measured_falls_to_settings_that_are_faster_than_a_longer_step():
    fast = setting("planar", "tolerances x 10", 9.0, 0.1, overrides=["integration.relative_tolerance=0.1"])
    kept = front(STEADY, COARSE, PLANAR, STEP, fast)
    assert names(settings_to_fall(scene("integration.fixed_step=20 us"), kept)[1:]) == names([fast, STEADY])
    assert names(settings_to_fall(scene("integration.fixed_step=80 us"), kept)[1:]) == names([STEADY])


def test_fewer_slices_count_as_faster_than_those_of_a_scene_that_were_not_measured():
    few = setting("spatial", "5 slices", 2.0, 0.045, overrides=["bearing.roller.slices=5"])
    many = setting("spatial", "21 slices", 0.5, 0.04, overrides=["bearing.roller.slices=21"])
    fallen = settings_to_fall(scene("level=spatial", "bearing.roller.slices=11"), front(few, many, PLANAR))
    assert names(fallen[1:]) == [few.name, *names([PLANAR]), "slip, not measured", "steady, not measured"]


def test_only_levels_that_have_what_the_scene_asks_for_are_used():
    assert names(settings_to_fall(scene("wants=[cage_orbit]"), ALL)) == names([PLANAR, COARSE])


@pytest.mark.parametrize("kept", [None, front(PLANAR, COARSE, extent=EVERYWHERE | {"radial_load": (1e4, 2e4)})])
def test_without_a_front_where_the_scene_operates_there_are_no_settings(kept):
    assert settings_to_fall(scene(), kept) == []


class Rung(FakeLevel):
    """A stand-in at a setting, with a cost."""

    def __init__(self, level, cost):
        super().__init__(level)
        self.cost = cost


def governor(costs, settings):
    return Governor([Rung(one.level, cost) for one, cost in zip(settings, costs)], 2.0, settings)


def run(chosen, seconds):
    changes, now, current = [], 0.0, chosen._ladder[0]
    while now < seconds:
        spent = TICK * current.cost
        now += max(TICK, spent)
        change = chosen.consider(TICK, spent)
        if change is not None:
            changes.append(change)
            current = change.simulation
    return changes


def test_it_stops_at_the_first_setting_that_keeps_real_time_and_says_its_errors():
    chosen = governor((1.5, 0.8, 0.1), [PLANAR, COARSE, STEADY])
    assert (chosen.slip_error, chosen.life_error, chosen.is_at_wanted) == (pytest.approx(0.00047), 0.008, True)
    (change,) = run(chosen, 3.0)
    assert change.down and change.setting == chosen.setting == "planar, tolerances x 3" and not chosen.is_at_wanted
    assert change.text.startswith("level planar, tolerances x 1 reaches 0.6")
    assert "planar, tolerances x 3 (errors: slip 0.06 points, life 1.2 %) continues" in change.text
    assert (chosen.slip_error, chosen.life_error) == (pytest.approx(0.0006), 0.012)


def test_it_comes_back_along_the_same_settings():
    settings = [PLANAR, COARSE, STEADY]
    chosen = governor((1.5, 1.2, 0.01), settings)
    assert [change.setting for change in run(chosen, 3.0)] == names(settings[1:])
    for rung, cost in zip(chosen._ladder, (0.5, 0.3, 0.003)):
        rung.cost = cost
    changes = []
    for _ in range(4):
        now, current = 0.0, chosen._ladder[chosen._rung]
        while now < 3.0:
            now += TICK
            change = chosen.consider(TICK, TICK * current.cost)
            if change is not None:
                changes.append(change.setting)
                current = change.simulation
    assert changes == ["planar, tolerances x 3", "planar, tolerances x 1"]
    assert chosen.is_at_wanted


def test_a_governor_without_measured_settings_knows_no_errors():
    chosen = Governor([FakeLevel("planar"), FakeLevel("slip")])
    assert chosen.setting == chosen.wanted_setting == "" and math.isnan(chosen.slip_error) and math.isnan(chosen.life_error)


def test_the_live_model_publishes_the_setting_and_its_errors():
    wanted, faster = FakeLevel("planar"), FakeLevel("planar")
    wanted.seconds_per_tick = 3 * TICK
    bench = Bench(simulation=wanted, governor=Governor([wanted, faster], settings=[PLANAR, COARSE]))
    bench.live.scene = wanted.scene
    assert bench.live.condition(bench.now_ns).values["measured slip error [fraction]"] == pytest.approx(0.00047)
    bench.run(1.0)
    condition = bench.live.condition(bench.now_ns)
    bench.live.close()
    assert condition.values["setting"] == "planar, tolerances x 3"
    assert condition.values["measured slip error [fraction]"] == pytest.approx(0.0006)
    assert condition.values["measured life error [fraction]"] == pytest.approx(0.012)
    (lasting,) = [event for event in condition.events if event.kind == "governor.level"]
    assert lasting.level is Level.WARN and "planar, tolerances x 3 instead of planar, tolerances x 1" in lasting.text
    (change,) = [event for event in bench.news if event.kind == "governor.change"]
    assert change.subject == "planar, tolerances x 3"
    status = next(one for one in report(0, condition.events, condition.values)["status"] if one["name"].endswith(": governor"))
    keys = {pair["key"]: pair["value"] for pair in status["values"]}
    assert keys["setting"] == "planar, tolerances x 3" and float(keys["measured slip error [fraction]"]) == pytest.approx(0.0006)


@pytest.mark.parametrize(("loads", "is_known"), [((400.0, 1000.0), True), ((2000.0, 5000.0), False)])
def test_errors_are_published_only_where_they_were_measured(loads, is_known):
    (measured,) = front(PLANAR, COARSE, extent=EVERYWHERE | {"radial_load": loads}).courses
    planar = FakeLevel("planar")
    bench = Bench(simulation=planar, governor=Governor([planar, FakeLevel("planar")], settings=[PLANAR, COARSE], courses=[measured]))
    bench.run(0.5)  # at 800 N
    error = bench.live.condition(bench.now_ns).values["measured slip error [fraction]"]
    bench.live.close()
    assert math.isnan(error) != is_known


def test_without_a_governor_the_errors_are_not_known():
    bench = Bench()
    values = bench.live.condition(bench.now_ns).values
    bench.live.close()
    assert math.isnan(values["measured slip error [fraction]"]) and values["setting"] == "not measured"


def test_a_governor_of_measured_settings_has_their_tolerances():
    simulation = Simulation(scene())
    made = governor_of(simulation, [PLANAR, COARSE])
    assert made._ladder[0] is simulation
    assert [one.scene.integration.relative_tolerance for one in made._ladder] == [0.01, 0.03]


def test_the_settings_of_a_record_are_read_again():
    known, running = recorded_settings(governor_record([PLANAR, COARSE], COARSE.name))
    assert list(known) == names([PLANAR, COARSE]) and running == COARSE.name
    assert known[COARSE.name].overrides == COARSE.overrides
    with pytest.raises(ValueError, match="cannot be read"):
        recorded_settings({"settings": "[{}]", "running": ""})


@pytest.mark.parametrize("running", [0, 1], ids=["from the wanted setting", "from a faster one"])
def test_a_run_that_changed_its_setting_is_computed_again_to_the_bit(tmp_path, running):
    rungs = [Simulation(scene(*one.overrides), Inputs(3000.0, 700.0, 0.0, 393.15)) for one in (PLANAR, COARSE)]
    tick, settings, path = 0.005, [PLANAR, COARSE], tmp_path / "run.mcap"
    records = {RECORD: governor_record(settings, settings[running].name)}
    current = running
    with McapSink(path, scene(), START, records, advance=(tick, 1)) as sink:
        sink.write(start_sample(rungs[current]))
        for number in range(24):
            block = rungs[current].advance(tick)
            sink.write(block)
            if number in (7, 15):
                other = 1 - current
                rungs[other].take_over(rungs[current])
                current = other
                sink.write(Event(float(block["time"][-1]), Level.WARN, "governor.change", settings[current].name, "changed"))
    recording, again = Recording(path), tmp_path / "again.mcap"
    with McapSink(again, scene(), START) as sink:
        result = reproduce(recording, sink)
    assert result.level_changes == 2 + running
    first, second = (np.concatenate([item for item in Recording(file) if isinstance(item, np.ndarray)]) for file in (path, again))
    for name in ("cage_speed", "inner_load"):
        np.testing.assert_array_equal(second[name], first[name], err_msg=name)
    np.testing.assert_allclose(second["damage"], first["damage"], rtol=1e-14)
    plain = Simulation(scene(), Inputs(3000.0, 700.0, 0.0, 393.15)).advance(24 * tick, samples=24)
    assert np.abs(plain["cage_speed"][-1] / first["cage_speed"][-1] - 1.0) > 1e-12  # the setting did matter
