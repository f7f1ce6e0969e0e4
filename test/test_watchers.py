# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Optional watchers of a run: named by the scene, imported only then, the same in every kind of run, and unable to end it."""

import subprocess
import sys
import time

import numpy as np
import pytest
from sim_time_bench import course, write
from sim_time_bench import replayed as replay_of
from test_live import Bench
from test_replay import run, steady_log
from test_sim_time import FakeReset, Run

from bearing_sim import SceneError, load_scene
from bearing_sim.messages.diagnostics import report, subject_of
from bearing_sim.messages.events import Event, Level, Measurement, Report
from bearing_sim.messages.topics import MEASURED_CHANNELS
from bearing_sim.model.sample import new_block
from bearing_sim.scene import watchers as registry
from bearing_sim.simulation import Inputs
from bearing_sim.watchers.monitoring.loaded_rollers import LoadedRollers
from bearing_sim.watchers.monitoring.monitor import Monitor
from bearing_sim.watchers.monitoring.watchers import Watcher, Watchers


class Seen(Watcher):
    """Keeps what it is told; fails at a time."""

    fails_at = np.inf

    def __init__(self, scene):
        super().__init__(scene)
        self.times, self.heard, self.ended, self.acts = [], [], False, []
        Seen.newest = self

    def hear(self, channel, time, value, standard_error):
        self.heard.append((channel, time))

    def see(self, block):
        if block["time"][-1] >= self.fails_at:
            raise ZeroDivisionError("on purpose")
        self.times += block["time"].tolist()
        self.acts += block["time"].tolist()
        return [Event(float(block["time"][-1]), Level.OK, "watcher.seen.kept", "", "kept")] if len(self.times) == 1 else ()

    def events(self, now):
        return [Event(now, Level.WARN, "anything", "", "more than two seconds")] if now > 2.0 else ()

    def values(self, now):
        return {"samples": len(self.times)}

    def restart(self, why):
        self.acts.append("restart")

    def close(self):
        self.ended = True


@pytest.fixture
def seen(monkeypatch):
    monkeypatch.setitem(registry.WATCHERS, "seen", f"{__name__}:Seen")
    return load_scene("deng2017_table1", ["watchers=[seen]"])


def replayed(scene, path):
    result, sink, _ = run(path, scene=scene)
    return result, sink


def test_a_watcher_sees_every_sample_of_a_replay_once_in_order_and_what_it_says_is_recorded(seen, tmp_path):
    result, sink = replayed(seen, steady_log(tmp_path / "log.mcap", duration=4.0))
    watcher = Seen.newest
    assert watcher.times == [float(sample["time"]) for block in sink.blocks for sample in block] and watcher.ended
    kinds = [event.kind for event in sink.of(Event)]
    assert kinds.count("watcher.seen") == 1 and "watcher.seen.kept" in kinds
    assert sink.of(Report)[-1].values["watcher seen: samples"] > 0
    assert [time for _, time in watcher.heard] == [one.time for one in sink.of(Measurement)]


class Profiling(FakeReset):
    """Advances over many instants at once, as level steady with a table."""

    takes_profiles = True

    def advance_profile(self, stretches, inputs):
        return np.concatenate([self.advance(stretch, Inputs(*row)) for stretch, row in zip(stretches, inputs)])


def test_a_watcher_sees_single_samples_also_where_a_replay_computes_and_judges_many_at_once(tmp_path, monkeypatch):
    monkeypatch.setitem(registry.WATCHERS, "seen", f"{__name__}:Seen")
    quiet = [f"thresholds.{name}=0" for name in ("life_warning", "remaining_life_warning", "lambda_warning")]
    judged_at_once = []
    monkeypatch.setattr(Monitor, "judge_calm", lambda self, block: judged_at_once.append(len(block)))
    for watched in (False, True):
        scene = load_scene("deng2017_table1", [*quiet, *(["watchers=[seen]"] if watched else [])])
        sink = replay_of(write(tmp_path / f"{watched}.mcap", course(3.0)), scene, rate=500.0, model=Profiling)
        assert watched or max(judged_at_once) > 20
    assert len(Seen.newest.times) > 1000 and len(sink.samples) - 1 == len(Seen.newest.times) == len(set(Seen.newest.times))
    begun = [event.time for event in sink.events if event.kind == "watcher.seen"]
    assert begun == [min(time for time in Seen.newest.times if time > 2.0)]


def test_a_watcher_that_fails_is_named_and_the_run_continues(seen, tmp_path, monkeypatch):
    monkeypatch.setattr(Seen, "fails_at", 1.0)
    result, sink = replayed(seen, steady_log(tmp_path / "log.mcap", duration=4.0))
    failed = [event for event in sink.of(Event) if event.kind == "watcher.seen" and event.level == Level.ERROR]
    assert len(failed) == 1 and "ZeroDivisionError: on purpose" in failed[0].reason and result.samples == sum(map(len, sink.blocks))
    assert max(Seen.newest.times) < 1.0


class Broken(Watcher):
    """Cannot be made."""

    def __init__(self, scene):
        raise LookupError("on purpose")


def test_a_watcher_that_cannot_be_made_is_named_and_the_others_watch(monkeypatch):
    monkeypatch.setitem(registry.WATCHERS, "broken", f"{__name__}:Broken")
    monkeypatch.setitem(registry.WATCHERS, "absent", "bearing_sim.no_such_module:Absent")
    scene = load_scene("deng2017_table1", ["watchers=[broken, absent, loaded_rollers]"])
    watchers = Watchers(scene)
    assert [(event.kind, event.level) for event in watchers.events(0.0)] == [("watcher.broken", Level.ERROR), ("watcher.absent", Level.ERROR)]
    watchers.see(new_block(1, scene.bearing.roller.count))
    assert watchers.values(0.0)["watcher loaded_rollers: rollers loaded"] == 0


class Gathering(Watcher):
    """Sees many samples together, and fails when it hears or is asked for a service."""

    together = 10

    def hear(self, channel, time, value, standard_error):
        raise ZeroDivisionError("on purpose")

    def serve(self, service):
        raise ZeroDivisionError("on purpose")


@pytest.mark.parametrize(
    "act", [lambda watchers: watchers.hear("cage_speed_measured", 0.0, 1.0), lambda watchers: watchers.serve("accept_change")[0]]
)
def test_a_watcher_that_fails_while_samples_wait_for_it_is_named_once(act, monkeypatch):
    monkeypatch.setitem(registry.WATCHERS, "gathering", f"{__name__}:Gathering")
    scene = load_scene("deng2017_table1", ["watchers=[gathering]"])
    watchers = Watchers(scene)
    watchers.see(new_block(1, scene.bearing.roller.count))
    assert not act(watchers)
    assert watchers.flush() == []
    assert [event.kind for event in watchers.events(0.0)] == ["watcher.gathering"]


class Mute(Watcher):
    """Answers nothing at all, as acts do that end without a return."""

    def see(self, block):
        pass

    events = values = news = see


def test_a_watcher_whose_acts_return_nothing_says_nothing(monkeypatch):
    monkeypatch.setitem(registry.WATCHERS, "mute", f"{__name__}:Mute")
    scene = load_scene("deng2017_table1", ["watchers=[mute]"])
    watchers = Watchers(scene)
    assert watchers.see(new_block(1, scene.bearing.roller.count)) == watchers.events(0.0) == watchers.news(0.0) == []
    assert watchers.values(0.0) == {} and watchers.close() is None


def test_a_live_run_shows_a_watcher_what_is_before_a_reset_before_it_lets_it_forget(seen):
    bench = Bench(scene=["watchers=[seen]"])
    try:
        bench.run(0.3)
        before = max(Seen.newest.times)
        time.sleep(0.1)  # what is computed now is seen together with what follows the reset
        assert bench.live.reset()
        time.sleep(0.1)
        bench.run(0.1)
        acts = Seen.newest.acts
        place = acts.index("restart")
        assert before < max(acts[:place]) < min(acts[place + 1 :]) and sorted(Seen.newest.times) == Seen.newest.times
        assert "watcher.seen" not in bench.codes()
        assert bench.live.condition(bench.now_ns).values["watcher seen: samples"] == len(Seen.newest.times)
        bench.live.offer("cage_speed_measured", (38.0,), None, bench.now_ns)
        assert [channel for channel, _ in Seen.newest.heard] == ["cage_speed_measured"]
    finally:
        assert bench.live.close()
    assert Seen.newest.ended


def test_simulated_time_shows_a_watcher_the_samples_and_measurements_of_the_replay_of_the_same_course(seen, tmp_path):
    messages = course(1.0, cage=True)
    replay_of(write(tmp_path / "course.mcap", messages), seen, model=FakeReset)
    offline = Seen.newest
    one = Run(scene=seen)
    one.player.play(messages, [0.02 * k for k in range(60)])
    one.finish()
    assert one.model.close()
    online = Seen.newest
    count = min(len(offline.times), len(online.times))
    assert count > 30 and offline.times[:count] == online.times[:count] and offline.ended and online.ended
    assert {channel for channel, _ in online.heard} == {channel for channel, _ in offline.heard} == set(MEASURED_CHANNELS)


def test_without_watchers_named_nothing_is_imported_for_them():
    code = "import sys; from bearing_sim.runtime import live, replay; print('bearing_sim.watchers.monitoring.loaded_rollers' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split() == ["False"]


@pytest.mark.parametrize(
    ("named", "expected"),
    [
        ("[loaded_roller]", "did you mean 'loaded_rollers'"),
        ("[loaded_rollers, loaded_rollers]", "named twice"),
        ("[os:system]", "there is no watcher"),
    ],
)
def test_a_watcher_that_is_not_there_is_refused(named, expected):
    with pytest.raises(SceneError, match=expected):
        load_scene("deng2017_table1", [f"watchers={named}"])


def test_loaded_rollers_warns_while_the_shaft_turns_and_no_roller_is_loaded():
    scene = load_scene("deng2017_table1")
    watcher, block = LoadedRollers(scene), new_block(3, scene.bearing.roller.count)
    block["shaft_speed"], block["inner_load"][:2, :5] = 1000.0, 7.0
    watcher.see(block[:2])
    assert not watcher.events(0.0) and watcher.values(0.0) == {"rollers loaded": 5, "fewest rollers loaded": 5}
    watcher.see(block[2:])
    assert len(watcher.events(0.0)) == 1 and watcher.values(0.0)["fewest rollers loaded"] == 0
    block["shaft_speed"] = 0.0
    watcher.see(block[2:])
    assert not watcher.events(0.0)


def test_events_and_values_of_a_watcher_belong_to_the_status_of_watchers():
    event = Event(0.0, Level.WARN, "watcher.loaded_rollers", "", "x")
    assert subject_of(event) == "watchers"
    statuses = report(0, [event], {"watcher loaded_rollers: rollers loaded": 3})["status"]
    (status,) = [each for each in statuses if each["name"].endswith(": watchers")]
    assert {"key": "watcher loaded_rollers: rollers loaded", "value": "3"} in status["values"]


def test_all_watchers_of_a_scene_are_asked():
    scene = load_scene("deng2017_table1", ["watchers=[loaded_rollers]"])
    watchers, block = Watchers(scene), new_block(1, scene.bearing.roller.count)
    watchers.see(block)
    assert watchers.values(0.0) == {"watcher loaded_rollers: rollers loaded": 0, "watcher loaded_rollers: fewest rollers loaded": 0}
    watchers.restart("reset")
    assert watchers.values(0.0) == {}
