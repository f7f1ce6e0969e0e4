# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The stored state of a bearing: what is counted, that nothing is counted twice or lost, and whose it is."""

import dataclasses
import errno
import hashlib
import json
import math
import shutil
import time

import numpy as np
import pytest
from click.testing import CliRunner
from fake_simulation import START, FakeSimulation
from sim_time_bench import RATE, FalseWall, Player, course
from sim_time_bench import SCENE as SIM_SCENE

from bearing_sim.cli.main import main
from bearing_sim.messages.events import Level
from bearing_sim.model.sample import new_block
from bearing_sim.recording.compare import compare
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.live import LiveModel
from bearing_sim.runtime.pacing import tick_schedule
from bearing_sim.runtime.sim_time import SimTimeModel
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation, start_sample
from bearing_sim.watchers.monitoring.residual import ResidualMonitor
from bearing_sim.watchers.stored_state import history
from bearing_sim.watchers.stored_state.counting import LifeCounter
from bearing_sim.watchers.stored_state.covered import MOST, Covered
from bearing_sim.watchers.stored_state.keeper import RECORD, StateKeeper
from bearing_sim.watchers.stored_state.merging import merge
from bearing_sim.watchers.stored_state.state import Damaged, StoredState, migrated, new_state
from bearing_sim.watchers.stored_state.state_file import StateError, StateFile, checked_serial, default_path, parsed, previous_path, read_state
from bearing_sim.watchers.stored_state.totals import Criteria, Totals

SECOND = 1_000_000_000
MIDNIGHT = 20_000 * 86_400 * SECOND  # 2024-10-04
SCENE = load_scene("deng2017_table1", ["level=steady"])


def samples(times, damage, speed=1000.0, slip=0.02, kappa=0.6, load=800.0, clearance=20e-6):
    block = new_block(len(times), 6)
    for name, value in (
        ("time", times),
        ("damage", damage),
        ("shaft_speed", speed),
        ("cage_slip", slip),
        ("viscosity_ratio", kappa),
        ("load_y", load),
        ("running_clearance", clearance),
        ("rating_life", 1000.0),
    ):
        block[name] = value
    return block


def stored(path, **options):
    keeper = StateKeeper(path, SCENE, "A1", **options)
    keeper.leave()
    return keeper.state


# -- times


def test_stretches_are_the_union_of_what_was_added_in_any_order():
    chance = np.random.default_rng(5)
    covered, seen = Covered(), np.zeros(400, bool)
    for begin, length in zip(chance.integers(0, 380, 60).tolist(), chance.integers(1, 20, 60).tolist()):
        covered.cover(begin * SECOND, (begin + length) * SECOND)
        seen[begin : begin + length] = True
        assert covered.seconds == pytest.approx(seen.sum()) and covered == Covered(covered.stretches)
        edges = np.arange(0, 401, 7)
        found = covered.fractions(edges[:-1] * SECOND, edges[1:] * SECOND)
        np.testing.assert_allclose(found, [seen[a:b].mean() for a, b in zip(edges, edges[1:])], atol=1e-12)


def test_the_number_of_stretches_is_bounded_and_the_shortest_gap_goes_first():
    covered = Covered()
    for number in range(MOST + 1):
        gap = 2 if number == 100 else 5
        begin = number * 100 - (5 - gap)
        covered.cover(begin * SECOND, (number * 100 + 95) * SECOND)
    assert len(covered) == MOST
    assert not any(begin == (100 * 100 - 3) * SECOND for begin, _ in covered.stretches), "the gap of two seconds is closed"


def test_the_life_used_does_not_depend_on_how_samples_are_divided_and_no_time_counts_twice():
    times = np.arange(1, 201) * 0.01
    damage, seconds = np.cumsum(np.random.default_rng(1).random(200)) * 1e-9, np.full(200, 0.01)
    times_ns = MIDNIGHT + np.rint(times * 1e9).astype(np.int64)
    covered = Covered([[MIDNIGHT + 500_000_000, MIDNIGHT + 1_000_000_000]])

    def counted(parts):
        counter, found = LifeCounter(0.25, covered), []
        for part in np.array_split(np.arange(200), parts):
            block = samples(times[part], damage[part])
            counter.count(block, times_ns[part], seconds[part])
            found += block["damage"].tolist()
        return np.array(found)

    whole = counted(1)
    assert np.array_equal(whole, counted(7)) and np.array_equal(whole, counted(200))
    assert whole[99] == whole[49], "what is covered adds nothing"
    assert whole[-1] == pytest.approx(0.25 + damage[-1] - (damage[99] - damage[49]), abs=1e-16)
    assert np.array_equal(whole[:50], 0.25 + damage[:50])


# -- totals


def test_totals_agree_with_a_plain_count_sample_by_sample():
    chance, n = np.random.default_rng(3), 3000
    speed = np.where((np.arange(n) // 500) % 2 == 0, 900.0, 0.0)  # three starts
    slip, kappa = chance.random(n) * 0.2, chance.random(n) * 6.0
    slip[::50], kappa[::70] = math.nan, math.nan
    block = samples(np.arange(1, n + 1) * 0.1, np.arange(1, n + 1) * 1e-8, speed, slip, kappa, chance.random(n) * 20e3, chance.random(n) * 1e-5)
    state = StoredState("A1", {})
    times_ns = MIDNIGHT - 100 * SECOND + np.rint(block["time"] * 1e9).astype(np.int64)
    by = Criteria(1000.0, 20.0, 20e3)
    for part in np.array_split(np.arange(n), 11):
        state.accumulate(block[part], times_ns[part], np.full(len(part), 0.1), by)
    found, turns = state.totals, speed > 0.0
    assert found.damage == block["damage"][-1] and found.starts == 3
    assert found.revolutions == pytest.approx(sum(each * 0.1 / (2 * math.pi) for each in speed))
    assert (found.monitored_seconds, found.running_seconds) == pytest.approx((300.0, 0.1 * turns.sum()))
    assert found.basic_damage == pytest.approx(300.0 / 3600.0 / 1000.0)

    def plain(values, edges):
        return [0.1 * sum(1 for value, on in zip(values, turns) if on and low <= value < high) for low, high in zip(edges, edges[1:])]

    load = block["load_y"] / 20e3
    assert found.slip_seconds == pytest.approx([*plain(slip, [0, 0.05, 0.1, 9]), 0.1 * (np.isnan(slip) & turns).sum()])
    assert found.lubrication_seconds == pytest.approx([*plain(kappa, [0, 0.1, 0.4, 1, 4, 99]), 0.1 * (np.isnan(kappa) & turns).sum()])
    assert found.load_seconds == pytest.approx(plain(load, [0, 0.02, 0.1, 0.5, 99]))
    place = int(np.nanargmax(np.where(turns, slip, np.nan)))
    assert found.largest_slip == (slip[place], times_ns[place])
    assert found.lowest_clearance.value == block["running_clearance"].min()
    assert list(state.days) == ["2024-10-03", "2024-10-04"]
    days = [state.days[day] for day in state.days]
    assert sum(day.damage for day in days) == pytest.approx(found.damage) and sum(day.starts for day in days) == 3
    assert days[0].monitored_seconds == pytest.approx(99.9, abs=0.11)


def test_a_machine_that_is_made_to_turn_slower_than_slip_counts_runs_without_a_slip():
    n = 100
    block = samples(np.arange(1, n + 1) * 1.0, np.zeros(n), np.full(n, 1.0), np.full(n, 0.2), np.ones(n), np.ones(n), np.ones(n))
    state, times_ns = StoredState("A1", {}), np.arange(1, n + 1) * SECOND
    state.accumulate(block, times_ns, np.ones(n), Criteria(1.2, 20.0, 20e3))
    assert state.totals.running_seconds == 100.0 and state.totals.slip_seconds == [0.0, 0.0, 0.0, 100.0] and state.totals.largest_slip is None


# -- files


def written(path, damages=(0.1, 0.2)):
    file, state = StateFile(path), new_state(SCENE, "A1", MIDNIGHT)
    for number, damage in enumerate(damages):
        state.totals.damage, state.writes, state.written_ns = damage, number + 1, MIDNIGHT + number * SECOND
        file.write(state)
    file.close()
    return path


def test_a_state_comes_back_to_the_last_digit(tmp_path):
    path = tmp_path / "a.json"
    keeper = StateKeeper(path, SCENE, "A1")
    keeper.count_live(samples([0.1, 0.2, 0.3], [1e-9, 2e-9, 3e-9]), (MIDNIGHT,), 0.1)
    keeper.leave()
    state, news = read_state(path)
    assert state == keeper.state and news == []
    assert path.stat().st_size < 5000


def test_a_state_that_is_cut_short_anywhere_gives_the_older_one_and_says_so(tmp_path):
    path = written(tmp_path / "a.json")
    data = path.read_bytes()
    for length in [*range(0, len(data) - 1, 97), len(data) - 2]:
        path.write_bytes(data[:length])
        state, (news,) = read_state(path)
        assert state.totals.damage == 0.1 and news.level is Level.WARN and news.kind == "state.restored"
        assert str(path) in news.text and "10 % of life used" in news.text


def test_a_state_with_another_byte_gives_the_older_one_and_is_kept_for_a_look(tmp_path):
    path = written(tmp_path / "a.json")
    data = path.read_bytes()
    for place in range(0, len(data) - 1, 53):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1 << place % 7]) + data[place + 1 :])
        assert read_state(path)[0].totals.damage == 0.1, place
    file = StateFile(path)
    state, (news,) = file.read()
    file.close()
    assert state.totals.damage == 0.1 and "damaged" in news.text
    assert path.with_name("a.json.damaged").exists()


@pytest.mark.parametrize("fault", ["missing", "older than the one before", "an older copy of both"])
def test_a_stale_or_missing_state_is_said(tmp_path, fault):
    path = written(tmp_path / "a.json", (0.1, 0.2, 0.3))
    if fault == "missing":
        path.unlink()
    elif fault == "older than the one before":
        written(tmp_path / "b.json", (0.05,))
        shutil.copy(tmp_path / "b.json", path)
    else:
        shutil.copy(previous_path(path), path)
    state, (news,) = read_state(path)
    assert state.totals.damage == 0.2 and news.kind == "state.restored" and news.level is Level.WARN


def test_two_damaged_files_are_refused_with_what_to_do_and_no_file_is_a_new_bearing(tmp_path):
    path = written(tmp_path / "a.json")
    path.write_bytes(b"{")
    previous_path(path).write_bytes(b"")
    with pytest.raises(StateError, match="no good state is left.*it is empty; put a copy"):
        StateKeeper(path, SCENE, "A1")
    keeper = StateKeeper(tmp_path / "new.json", SCENE, "A1")
    (begun,) = keeper.news(0.0)
    keeper.leave()
    assert begun.kind == "state.begun" and begun.level is Level.OK


def test_the_books_of_a_plant_and_no_newer_version_are_read(tmp_path):
    path = tmp_path / "a.json"
    path.write_text(
        json.dumps({"format": "bearing_sim state", "version": 0, "state": {"serial": "A1", "damage": 0.3, "running_hours": 4000.0, "starts": 12}})
    )
    totals = stored(path).totals
    assert (totals.damage, totals.running_seconds, totals.starts) == (0.3, 4000.0 * 3600.0, 12)
    assert totals.slip_seconds[-1] == 4000.0 * 3600.0, "by slip that nobody knows"
    path.write_text(json.dumps({"format": "bearing_sim state", "version": 0, "state": {"damages": 0.3}}))
    previous_path(path).unlink()
    with pytest.raises(StateError, match="version 0 has no damages"):
        stored(path)
    contents = '{"serial": "A1"}'
    checksum = hashlib.sha256(f"99 {contents}".encode()).hexdigest()
    path.write_text(json.dumps({"format": "bearing_sim state", "version": 99, "checksum": checksum})[:-1] + f', "state": {contents}}}\n')
    with pytest.raises(StateError, match="newer bearing_sim.*update it"):
        stored(path)


@pytest.mark.parametrize(
    ("scene", "serial", "names"),
    [
        (load_scene("deng2017_table2", ["level=steady"]), "A1", "bearing.name 'deng2017_table2' instead of 'deng2017_table1'"),
        (load_scene("deng2017_table1", ["bearing.roller.count=17"]), "A1", "bearing.roller.count 17 instead of 18"),
        (load_scene("deng2017_table1", ["life.method=iso281"]), "A1", "life.method 'iso281' instead of 'deng2017'"),
        (load_scene("deng2017_table1", ["name=other"]), "A1", "scene name 'other'"),
        (SCENE, "B2", "serial number 'B2' instead of 'A1'"),
    ],
)
def test_a_state_of_another_bearing_scene_or_number_is_refused_by_name(tmp_path, scene, serial, names):
    stored(tmp_path / "a.json")
    with pytest.raises(StateError) as refused:
        StateKeeper(tmp_path / "a.json", scene, serial)
    assert names in str(refused.value) and "~/replace_bearing" in str(refused.value) and "state adopt" in str(refused.value)


def test_another_level_oil_threshold_or_calibration_is_the_same_bearing(tmp_path):
    path = tmp_path / "a.json"
    keeper = StateKeeper(path, SCENE, "A1")
    keeper.state.learned = {"cage_slip": {"mean": 0.01}}
    keeper.leave()
    same = load_scene("deng2017_table1", ["level=slip", "thresholds.slip_error=0.2", "lubricant.temperature=350K"])
    keeper = StateKeeper(path, same, "")
    keeper.leave()
    assert keeper.state.learned and keeper.state.serial == "A1"
    keeper = StateKeeper(path, load_scene("deng2017_table1", ["lubricant.mixture_fraction=0.05"]), "A1")
    continued, recalibrated = keeper.news(0.0)
    assert (continued.kind, recalibrated.kind) == ("state.continued", "state.recalibrated") and keeper.state.learned == {}
    assert "calibrated since: lubricant.mixture_fraction 0.05; what" in recalibrated.reason, "only what has changed is named"
    keeper.leave()


def test_a_second_user_of_a_file_is_refused_even_after_it_was_renamed(tmp_path):
    keeper = StateKeeper(tmp_path / "a.json", SCENE, "A1")
    keeper.save()
    with pytest.raises(StateError, match=r"in use by process \d+"):
        StateKeeper(tmp_path / "a.json", SCENE, "A1")
    keeper.leave()
    StateKeeper(tmp_path / "a.json", SCENE, "A1").leave()


@pytest.mark.parametrize("serial", ["a/b", "..", ".", "x y", "Ä-7", "%2F", "a" * 100])
def test_every_serial_number_has_a_file_of_its_own_in_one_folder(serial, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    path = default_path(checked_serial(serial))
    assert path.parent == default_path("A1").parent and path != default_path("A1")
    stored(path)
    assert read_state(path)[0].serial == "A1"


def test_serial_numbers_that_cannot_be_are_refused():
    for serial in ("a\nb", "a" * 101, "\x00"):
        with pytest.raises(StateError, match="printable"):
            checked_serial(serial)
    assert checked_serial("  A1 ") == "A1"


def test_a_full_disk_is_an_error_while_counting_goes_on_and_is_over_when_it_can_be_written_again(tmp_path, monkeypatch):
    keeper = StateKeeper(tmp_path / "a.json", SCENE, "A1")
    full, write = [True], StateFile.write

    def fails(file, state):
        if full:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(file, state)

    monkeypatch.setattr(StateFile, "write", fails)
    keeper.count_live(samples([0.1, 0.2], [1e-9, 2e-9]), (MIDNIGHT,), 0.1)
    assert not keeper.save()
    (event,) = keeper.events(1.0)
    assert (event.level, event.kind) == (Level.ERROR, "state.not_written") and "No space left" in event.text
    full.clear()
    assert keeper.save() and keeper.events(1.0) == []
    keeper.leave()
    assert read_state(tmp_path / "a.json")[0].totals.damage == 2e-9


@pytest.mark.parametrize(
    ("published", "waited", "expected"),
    [(0.1, 0.0, 1e-9), (0.2, 0.0, 2e-9), (0.1, 1.1, 2e-9)],
    ids=["its samples are not published", "they are", "nobody publishes"],
)
def test_a_state_is_written_only_once_its_samples_are_published_or_nobody_publishes(tmp_path, published, waited, expected):
    now = [0.0]
    keeper = StateKeeper(tmp_path / "a.json", SCENE, "A1", clock=lambda: now[0])
    keeper.count_live(samples([0.1], [1e-9]), (MIDNIGHT,), 0.1)
    assert keeper.save()
    keeper.count_live(samples([0.2], [2e-9]), (MIDNIGHT,), 0.1)
    keeper.hold(0.2)
    now[0] += waited
    keeper.release(published)
    keeper.abandon()  # as a kill: what was handed over is written, what is held is not
    assert read_state(tmp_path / "a.json")[0].totals.damage == expected


# -- days


def test_days_that_are_over_go_to_the_history_once_even_if_the_move_is_interrupted(tmp_path):
    path = tmp_path / "a.json"
    first = {"2024-10-03": Totals(damage=0.1, starts=2), "2024-10-04": Totals(damage=0.2)}
    rows = [{"day": day, **history.row_of(totals)} for day, totals in first.items()]
    assert history.write_history(path, rows, 1)
    later = [*rows, {"day": "2024-10-05", **history.row_of(Totals(damage=0.4))}]
    history.write_history(path, later, 1)  # the state with move 1 was lost by a kill
    found, last = history.read_history(path)
    assert [(row["day"], row["damage"]) for row in found] == [("2024-10-03", 0.1), ("2024-10-04", 0.2), ("2024-10-05", 0.4)] and last.number == 1
    history.write_history(path, rows[:1], 2)  # a recording was merged later
    assert [row["damage"] for row in history.read_history(path)[0]] == [0.2, 0.2, 0.4]


def test_without_pyarrow_the_history_is_csv_and_joins_the_parquet_table_later(tmp_path, monkeypatch):
    path, row = tmp_path / "a.json", {"day": "2024-10-03", **history.row_of(Totals(damage=0.1, starts=2))}
    with monkeypatch.context() as without:
        without.setattr(history.importlib.util, "find_spec", lambda name: None)
        assert not history.write_history(path, [row], 1)
    assert history.read_history(path)[0] == [row]
    assert history.write_history(path, [{**row, "day": "2024-10-04"}], 2)
    assert [each["day"] for each in history.read_history(path)[0]] == ["2024-10-03", "2024-10-04"]
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.days.parquet"]


def test_a_keeper_moves_yesterday_to_the_history_and_keeps_today(tmp_path, monkeypatch):
    from bearing_sim.watchers.stored_state import keeper as module

    def moved(path, days, number):
        return history.write_history(path, [{"day": day, **history.row_of(totals)} for day, totals in days.items()], number)

    monkeypatch.setattr(module, "move_days", moved)  # in this process, which has loaded pyarrow
    keeper = StateKeeper(tmp_path / "a.json", SCENE, "A1")
    keeper.count_live(samples(np.arange(1, 5) * 0.5, np.arange(1, 5) * 1e-9), (MIDNIGHT - SECOND - 1,), 0.5)
    keeper.save()
    end = time.monotonic() + 20.0
    while keeper._moved is None and time.monotonic() < end:
        time.sleep(0.01)
    keeper.leave()
    assert list(keeper.state.days) == ["2024-10-04"] and keeper.state.folds == 1
    rows = history.all_days(tmp_path / "a.json", keeper.state)
    assert [row["day"] for row in rows] == ["2024-10-03", "2024-10-04"]
    assert sum(row["damage"] for row in rows) == pytest.approx(4e-9)


# -- runs


class Run:
    """A live model with a stored state, fed until some damage is counted."""

    def __init__(self, path, seconds=0.3, reset=False, **options):
        self.keeper = StateKeeper(path, SCENE, "A1")
        self.begun_with = self.keeper.used
        self.live = LiveModel(SCENE, FakeSimulation(), time.time_ns(), given={"state": self.keeper}, **options)
        self.damages = []
        self.feed(seconds)
        if reset:
            assert self.live.reset()
            self.feed(seconds)

    def feed(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end or not self.damages:
            now = time.time_ns()
            self.live.offer("shaft_speed", (START.shaft_speed,), now, now)
            self.live.collect(now)
            self.damages += [float(each.sample["damage"]) for each in self.live.published()]
            time.sleep(0.02)

    def close(self):
        self.live.close()
        self.keeper.leave()


def test_damage_continues_over_restarts_and_resets_and_only_grows(tmp_path):
    path, before = tmp_path / "a.json", 0.0
    for reset in (False, True, False):
        run = Run(path, reset=reset)
        run.close()
        assert run.begun_with == before and min(run.damages) >= before
        assert sorted(run.damages) == run.damages
        state = read_state(path)[0]
        before = state.totals.damage
        assert before >= run.damages[-1] and state.totals.starts == 1
    assert state.totals.revolutions == pytest.approx(state.totals.monitored_seconds * START.shaft_speed / (2 * math.pi))
    assert 1e-9 * START.shaft_speed * state.totals.monitored_seconds == pytest.approx(state.totals.damage, rel=0.1)


def test_without_a_state_every_run_begins_at_zero(tmp_path):
    live = LiveModel(SCENE, FakeSimulation(), time.time_ns())
    assert live.watchers.memory.life_used is None and "revolutions" not in live.condition(time.time_ns()).values
    live.close()


def test_another_bearing_begins_anew_and_the_state_of_the_first_is_kept(tmp_path):
    run = Run(tmp_path / "a.json")
    kept = []

    def change():
        kept.append(run.keeper.retire(into_archive=True))
        return StateKeeper(tmp_path / "a.json", SCENE, "B2")

    run.live.replace_bearing(change)
    first, run.damages = run.damages, []
    run.feed(0.2)
    run.live.close()
    run.live.watchers.get("state").leave()
    archived, now = read_state(kept[0])[0], read_state(tmp_path / "a.json")[0]
    assert archived.serial == "A1" and archived.retired_ns and archived.totals.damage >= first[-1]
    assert now.serial == "B2" and 0.0 < now.totals.damage < archived.totals.damage and max(run.damages) <= now.totals.damage
    assert "A1" in kept[0].name


def recorded(path, scene, keeper, seconds=0.2, start_ns=MIDNIGHT, first=0.0):
    """Record a run that goes on from a state, as a live model makes it, and return its last sample."""
    schedule, simulation = tick_schedule(1000.0, 100.0), Simulation(scene, Inputs(3000.0, 700.0, 0.0, 393.15))
    metadata = {RECORD: keeper.record} if keeper is not None else None
    used = 0.0 if keeper is None else keeper.used
    with McapSink(path, scene, start_ns, metadata, advance=(schedule.tick, schedule.samples)) as sink:
        block = start_sample(simulation)
        for tick in range(round(seconds / schedule.tick) + 1):
            if tick:
                inputs = Inputs(3000.0 + 20.0 * tick, 700.0, 3.0 * tick, 393.15)
                block = simulation.advance(schedule.tick, inputs, schedule.samples)
            block["time"] += first
            block["damage"] += used
            sink.write(block)
            if keeper is not None:
                keeper.count_live(block, (start_ns,), 1.0 / 1000.0)
    return block[-1]


def test_a_recording_with_a_state_repeats_to_the_last_bit(tmp_path):
    scene, run = load_scene("deng2017_table1", ["level=slip"]), tmp_path / "run.mcap"
    keeper = StateKeeper(tmp_path / "a.json", scene, "A1")
    keeper.state.totals.damage = 0.123456789
    keeper.restart()
    last = recorded(run, scene, keeper)
    keeper.leave()
    assert last["damage"] > 0.123456789
    done = CliRunner().invoke(main, ["replay", "--from-recording", str(run), "-o", str(tmp_path / "again.mcap")])
    assert done.exit_code == 0, done.output
    again = Recording(tmp_path / "again.mcap")
    assert again.records[RECORD] == Recording(run).records[RECORD], "it holds the state, too"
    differences, _ = compare(run, tmp_path / "again.mcap")
    assert max(float(each.relative.max()) for each in differences) == 0.0


def test_a_recording_fills_a_gap_once_and_only_once(tmp_path):
    path, run = tmp_path / "a.json", tmp_path / "run.mcap"
    keeper = StateKeeper(path, SCENE, "A1")
    last = recorded(run, SCENE, keeper, seconds=1.0)
    keeper.leave()
    whole = read_state(path)[0]
    assert whole.totals.damage == last["damage"]
    lost = whole.copy()  # what a kill leaves that had written 0.4 s before
    keeper = StateKeeper(tmp_path / "short.json", SCENE, "A1")
    recorded(tmp_path / "first.mcap", SCENE, keeper, seconds=0.6)
    keeper.leave()
    lost = read_state(tmp_path / "short.json")[0]
    assert lost.totals.damage < whole.totals.damage
    for added in (0.4, 0.0):
        filled = merge(tmp_path / "short.json", Recording(run))
        assert filled.recorded == pytest.approx(1.0) and filled.added == pytest.approx(added, abs=1e-9)
    state = read_state(tmp_path / "short.json")[0]
    assert state.totals.damage == pytest.approx(whole.totals.damage, rel=1e-12) and state.covered == whole.covered
    assert state.totals.starts == 1 and state.totals.running_seconds == pytest.approx(whole.totals.running_seconds)


def test_a_recording_of_another_bearing_is_not_merged(tmp_path):
    stored(tmp_path / "a.json")
    keeper = StateKeeper(tmp_path / "b.json", SCENE, "B2")
    recorded(tmp_path / "run.mcap", SCENE, keeper)
    keeper.leave()
    done = CliRunner().invoke(main, ["state", "merge", str(tmp_path / "a.json"), str(tmp_path / "run.mcap")])
    assert done.exit_code == 2 and "serial number 'B2' instead of 'A1'" in done.output
    assert read_state(tmp_path / "a.json")[0].totals.damage == 0.0


def test_a_log_that_is_replayed_for_a_state_counts_once_and_without_one_touches_none(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home"))
    from recordings import steady_log

    log, state = steady_log(tmp_path / "log.mcap"), tmp_path / "a.json"
    command = ["replay", str(log), "--scene", "deng2017_table1", "--set", "level=slip"]
    assert CliRunner().invoke(main, command).exit_code == 0
    assert not (tmp_path / "home").exists()
    found = []
    for _ in range(2):
        done = CliRunner().invoke(main, [*command, "--state-file", str(state), "--serial", "A1", "--json"])
        assert done.exit_code == 0, done.output
        found.append(json.loads(done.stdout))
    once, twice = found
    assert once["damage"] == twice["damage"] > 0.0, "of the run alone"
    assert once["state"]["totals"]["damage"] == pytest.approx(once["damage"])
    assert twice["state"]["totals"] == once["state"]["totals"]


def test_a_log_that_is_played_twice_under_sim_time_counts_once_and_shows_the_life_used(tmp_path):
    messages, wall = course(2.0, oil=False), FalseWall()
    ticks = np.arange(0.0, 2.2, 0.05).tolist()
    keeper = StateKeeper(tmp_path / "a.json", SIM_SCENE, "A1", once=True, clock=wall)
    keeper.state.totals.damage = 0.5
    keeper.restart()
    model = SimTimeModel(SIM_SCENE, FakeSimulation(), RATE, RATE, wall=wall, given={"state": keeper})
    player, used, shown = Player(model, wall), [], []
    for _ in range(2):
        player.play(messages, ticks)
        player.stand(1.0)
        player.until_idle()
        used.append(keeper.used)
        shown.append([float(each.sample["damage"]) for each in model.published()])
    model.close()
    keeper.leave()
    assert used[0] > 0.5 and used[1] == pytest.approx(used[0], abs=1e-12)
    assert sorted(shown[0]) == shown[0] and shown[0][-1] == used[0] and shown[1][0] == pytest.approx(used[0], abs=1e-12)
    assert read_state(keeper.path)[0].totals.monitored_seconds == pytest.approx(2.0, abs=0.1)


# -- commands and what is learned


def test_the_commands_show_export_and_adopt(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    path = default_path("A1")
    keeper = StateKeeper(path, SCENE, "A1")
    keeper.count_live(samples(np.arange(1, 11) * 0.1, np.arange(1, 11) * 1e-3), (MIDNIGHT,), 0.1)
    keeper.leave()

    def run(*words, code=0):
        done = CliRunner().invoke(main, ["state", *map(str, words)])
        assert done.exit_code == code, done.output
        return done.output

    assert "1 %" in run("show", "A1") and json.loads(run("show", path, "--json"))["totals"]["damage"] == 0.01
    assert "there are A1" in run("show", "a1x", code=2)
    run("export", "A1", "-o", tmp_path / "days.csv")
    header, row = (tmp_path / "days.csv").read_text().splitlines()
    assert header.startswith("day,damage") and row.startswith("2024-10-04,0.01")
    run("export", "A1", "-o", tmp_path / "days.parquet")
    run("export", "A1", "-o", tmp_path / "all.json")
    assert json.loads((tmp_path / "all.json").read_text())["history"][0]["day"] == "2024-10-04"
    assert ".json, .csv, .parquet" in run("export", "A1", "-o", tmp_path / "x.txt", code=2)
    assert "17 instead of 18" in run("adopt", "A1", "--scene", "deng2017_table1", "--set", "bearing.roller.count=17")
    with pytest.raises(StateError, match="18 instead of 17"):
        StateKeeper(path, SCENE, "A1")


def test_what_a_residual_monitor_has_learned_goes_on_as_if_there_had_been_no_restart():
    detection = SCENE.thresholds.residual
    chance = np.random.default_rng(2)
    whole, first = ResidualMonitor(detection, 20.0), ResidualMonitor(detection, 20.0)
    times = np.arange(0.0, detection.learning + 40 * detection.batch, detection.batch / 5)
    readings = 0.02 + 0.001 * chance.normal(size=len(times))
    for time_, reading in zip(times.tolist(), readings.tolist()):
        for monitor in (whole, first):
            monitor.compare(time_, 1000.0, reading, 0.01)
    second = ResidualMonitor(detection, 20.0)
    second.restore(json.loads(json.dumps(first.learned)))
    whole.interrupt(float(times[-1]))
    for time_, reading in zip(times.tolist(), readings[::-1].tolist()):
        whole.compare(times[-1] + 1.0 + time_, 1000.0, reading + 0.02, 0.01)
        second.compare(time_, 1000.0, reading + 0.02, 0.01)
    assert second.learned["changes"] == pytest.approx(whole.learned["changes"]) and second.learned["changes"]["side"] == 1
    assert second.learned["batches"] == pytest.approx(whole.learned["batches"])
    other = ResidualMonitor(dataclasses.replace(detection, batch=2.0 * detection.batch), 20.0)
    other.restore(first.learned)
    assert math.isnan(other.mean), "learned from other batches"


@pytest.mark.parametrize(
    ("name", "value"),
    [("starts", 2.5), ("starts", True), ("damage", -1), ("running_hours", "3"), ("running_hours", True), ("running_hours", -1), ("serial", "\a")],
)
def test_what_people_write_wrongly_is_refused_with_its_name_and_nothing_is_rounded(name, value):
    state = {"serial": 4711, "starts": 5.0}
    assert parsed(_by_hand(state)).serial == "4711" and parsed(_by_hand(state)).totals.starts == 5
    with pytest.raises(Damaged, match=name):
        parsed(_by_hand({name: value}))


@pytest.mark.parametrize(
    ("place", "value"),
    [
        *[("totals.damage", value) for value in ("0.5", True, -1e-9, math.nan, math.inf)],
        *[("totals.starts", value) for value in ("5", True, -1, 2**63, 2.5)],
        ("totals.slip_seconds", [0.0]),
        ("totals.slip_seconds", [0.0, 0.0, 0.0, -1.0]),
        ("totals.largest_slip", [math.nan, 0]),
        ("totals.largest_slip", [0.1, -1]),
        ("days.2024-10-04.revolutions", math.inf),
        ("covered", [[-1, 5]]),
        ("covered", [[0, 2**63]]),
        ("estimates", [[0, {"mounting.clearance": [0.0, math.nan, 1.0]}]]),
        ("thermal", {"time_ns": 0, "nodes": [math.nan], "rings": [300.0, 300.0]}),
        ("calibration", {"mounting.clearance": math.inf}),
        ("writes", -1),
        ("retired_ns", 2**63),
        ("serial", "\a"),
    ],
)
def test_contents_that_no_state_has_are_refused_with_their_place(place, value):
    contents = json.loads(json.dumps(new_state(SCENE, "A1", MIDNIGHT).as_mapping() | {"days": {"2024-10-04": {}}}))
    StoredState.from_mapping(contents)
    *blocks, name = place.split(".")
    block = contents
    for each in blocks:
        block = block[each]
    block[name] = value
    with pytest.raises(Damaged, match=f"it is not a bearing's state: {place}"):
        StoredState.from_mapping(contents)


@pytest.mark.parametrize("version", [-1, 3, "2", None])
def test_an_unknown_version_and_contents_without_totals_are_refused(version):
    with pytest.raises(Damaged, match="version .* is unknown"):
        migrated(version, {})
    with pytest.raises(Damaged, match="it has no totals"):
        StoredState.from_mapping({"serial": "A1", "identity": {}})
    with pytest.raises(Damaged, match="version 0 has no hours; expected some of damage"):
        migrated(0, {"hours": 3.0})


def _by_hand(state):
    return json.dumps({"format": "bearing_sim state", "version": 0, "state": state}).encode()
