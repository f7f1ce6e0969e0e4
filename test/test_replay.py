# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the replay: it visits every stamp, writes inputs and outputs, survives what cannot be integrated."""

import json
import math
import re
import signal
import subprocess
import sys
import time
from collections import defaultdict
from itertools import islice

import numpy as np
import pytest
from click.testing import CliRunner
from fake_simulation import FakeSimulation
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from recordings import steady_log, write_log
from support import ListSink, measured_file

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.messages.events import Event, Level, Start
from bearing_sim.recording.append_file import AppendFile
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime import replay as replaying
from bearing_sim.runtime.replay import Replay, replay
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Thresholds
from bearing_sim.simulation import Counters, Inputs, Simulation
from bearing_sim.watchers.monitoring.monitor import Monitor

SCENE = load_scene("deng2017_table1")
HELD = Inputs(0.0, 0.0, 0.0, 393.15)


def samples(sink):
    return [sample for block in sink.blocks for sample in block]


def run(path, fails_at=None, views=(), scene=SCENE, **options):
    """Replay a log on the stand-in; returns result, sink and stand-in."""
    made = []

    def model(scene, inputs):
        simulation = FakeSimulation(inputs)
        simulation.fails_at = fails_at or simulation.fails_at
        simulation.counters = Counters(7, 2, 1, 0, 0, 0)
        made.append(simulation)
        return simulation

    sink = ListSink()
    course = judge(read_input_log(path), scene.accepted_inputs, HELD)
    result = replay(scene, course, sink, views, model=model, **options)
    assert [start.block["time"] for start in sink.of(Start)] == [0.0], "a recording begins with the state at the start"
    return result, sink, made[0]


def times(sink):
    return [float(sample["time"]) for sample in samples(sink)]


def test_one_output_at_each_stamp_with_the_inputs_of_that_stamp(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, 100.0), (0.2, 300.0), (0.5, 300.0)], [(0.0, 0.0, 0.0), (0.4, 400.0, 40.0), (0.5, 400.0, 40.0)])
    result, sink, _ = run(path)
    assert times(sink) == pytest.approx([0.2, 0.4, 0.5])
    assert [sample["shaft_speed"] for sample in samples(sink)] == pytest.approx([300.0, 300.0, 300.0])
    assert [sample["load_y"] for sample in samples(sink)] == pytest.approx([200.0, 400.0, 400.0])
    assert (result.samples, result.sim_seconds) == (3, pytest.approx(0.5))
    assert (result.steps, result.rejected_steps, result.non_finite_steps) == (7, 2, 1)


def test_inputs_are_written_at_their_own_stamps(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, 100.0), (0.2, 300.0)], [(0.0, 0.0, 0.0), (0.1, 100.0, 0.0), (0.2, 0.0, 0.0)], [(0.1, 50.0)])
    _, sink, _ = run(path)
    assert [(round(time, 9), channels) for time, _, channels in sink.inputs] == [
        (0.0, ("shaft_speed", "radial_load")),
        (0.1, ("radial_load", "oil_temperature")),
        (0.2, ("shaft_speed", "radial_load")),
    ]


def test_output_rate_changes_the_outputs_and_not_the_path_of_the_inputs(tmp_path):
    speeds = [(0.0, 0.0), (0.05, 500.0), (1.0, 500.0)]  # the corner at 0.05 s lies between outputs
    path = write_log(tmp_path / "log.mcap", speeds, [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])
    result, sink, simulation = run(path, rate=4.0)
    assert times(sink) == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert simulation.angle == pytest.approx(0.5 * 0.05 * 500 + 0.95 * 500)
    assert result.samples == 4


def test_output_rate_may_exceed_the_stamps(tmp_path):
    _, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=1.0, rate=10), rate=100.0)
    assert times(sink) == pytest.approx(np.arange(1, 101) / 100)


def test_gap_is_not_simulated_and_time_goes_on_after_it(tmp_path):
    stamps = [t / 10 for t in range(11)] + [t / 10 for t in range(100, 111)]
    path = write_log(tmp_path / "log.mcap", [(t, 100.0) for t in stamps], [(t, 1.0, 0.0) for t in stamps])
    result, sink, simulation = run(path)
    assert result.gap_seconds == pytest.approx(9.0) and result.sim_seconds == pytest.approx(2.0)
    assert simulation.time == pytest.approx(2.0)
    assert times(sink)[9:11] == pytest.approx([1.0, 10.1])
    assert "input.gap" in result.events


def test_stretch_that_cannot_be_integrated_is_told_counted_and_left_out(tmp_path):
    result, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=1.0), fails_at=failing_calls(3, 4))
    assert result.failed_ticks == 2 and result.samples == 8
    told = [event for event in sink.events if event.kind.startswith("solver")]
    assert [event.kind for event in told] == ["solver.failed", "solver.recovered"]
    assert "step size" in told[0].text and "held" in told[0].text
    assert result.given_up == "" and times(sink)[-1] == pytest.approx(1.0)


def failing_calls(*which):
    calls = iter(range(10**9))
    return lambda time, inputs: next(calls) in which


def test_run_that_fails_ten_times_in_a_row_is_given_up(tmp_path):
    result, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=5.0), fails_at=lambda time, inputs: time > 0.95)
    assert "10 stretches in a row" in result.given_up
    assert result.samples == 10 and sink.events[-1].kind == "run.given_up"


def test_condition_is_told_when_it_changes_and_reported_every_second(tmp_path, monkeypatch):
    """A judgement that finds the life too short from 2 s to 3.5 s."""

    def judged(monitor, time):
        return [Event(time, Level.WARN, "bearing.life", "", "short")] if 1.99 < time < 3.51 else []

    monkeypatch.setattr(Monitor, "events", judged)
    _, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=5.0))
    assert [(round(event.time, 6), event.level, event.kind) for event in sink.events if event.kind.startswith("bearing.")] == [
        (2.0, Level.WARN, "bearing.life"),
        (3.6, Level.OK, "bearing.life"),
    ]
    assert [round(time, 6) for time, _, _ in sink.diagnostics] == [0.1, 1.0, 2.0, 3.0, 4.0, 5.0]
    judged = [[event for event in events if event.kind.startswith("bearing.")] for _, events, _ in sink.diagnostics]
    assert [bool(events) for events in judged] == [False, False, True, True, False, False]
    assert all(float(values["shaft speed [rad/s]"]) == pytest.approx(4000.0) for _, _, values in sink.diagnostics)


def test_slip_above_its_limit_is_told_by_the_scenes_thresholds(tmp_path):
    scene = load_scene("deng2017_table1", ["thresholds.slip_warning=0.1%", "thresholds.slip_error=0.5%"])
    _, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=1.0), scene=scene)
    judged = [(event.kind, event.level) for event in sink.events if event.kind.startswith("bearing.")]
    assert judged == [("bearing.slip", Level.ERROR)]


def test_watchers_get_every_sample_and_event(tmp_path):
    watcher = ListSink()
    _, sink, _ = run(steady_log(tmp_path / "log.mcap", duration=25.0), views=[watcher])
    assert times(watcher) == times(sink) and len(times(sink)) == 250
    assert watcher.events == sink.events


class TakesCourses(FakeSimulation):
    """A stand-in of a level that advances over many instants at once."""

    takes_profiles = True

    def advance_profile(self, stretches, inputs):
        return np.concatenate([self.advance(float(stretch), Inputs(*row.tolist())) for stretch, row in zip(stretches, inputs)])


@pytest.mark.parametrize("make", [TakesCourses, FakeSimulation])
def test_outputs_of_a_level_that_takes_courses_are_written_many_at_once_and_say_the_same(tmp_path, monkeypatch, make):
    """Slip goes up and down across its limit from 4 s on, so that parts of the run are judged output by output; those of other levels come singly."""
    log = steady_log(tmp_path / "log.mcap", duration=25.0)
    scene = load_scene("deng2017_table1", ["thresholds.slip_warning=1.5%", "thresholds.slip_hold.clear_after=0.5 s"])

    def replayed():
        class Waving(make):
            def _observe(self, now, inputs):
                sample = super()._observe(now, inputs)
                sample["cage_slip"] = 0.01 if now < 4.0 else 0.01 + 0.01 * (int(now) % 4 > 1)
                return sample

        sink = ListSink()

        def model(scene, inputs):
            simulation = Waving(inputs)
            simulation.counters = Counters(7, 2, 1, 0, 0, 0)
            return simulation

        result = replay(scene, judge(read_input_log(log), scene.accepted_inputs, HELD), sink, model=model)
        return [len(block) for block in sink.blocks], sink, result

    lengths, sink, result = replayed()
    monkeypatch.setattr(replaying, "_TOGETHER", 1)
    singly, expected, same = replayed()
    assert singly == [1] * 250 and (lengths == singly) == (make is FakeSimulation) and sum(lengths) == 250
    assert len(lengths) <= 3 or make is FakeSimulation
    assert np.array(samples(sink)).tobytes() == np.array(samples(expected)).tobytes()
    for name in ("inputs", "events", "diagnostics"):
        assert repr(getattr(sink, name)) == repr(getattr(expected, name)), name
    assert len(sink.events) > 4 and (result.samples, result.weight, result.slip) == (same.samples, same.weight, same.slip)


def test_progress_never_goes_back_and_ends_at_the_end(tmp_path):
    reached = []
    run(steady_log(tmp_path / "log.mcap", duration=20.0), progress=reached.append)
    assert reached == sorted(reached) and reached[-1] == pytest.approx(20.0)


def test_slip_statistics_weigh_by_time_and_leave_out_the_standing_shaft():
    result = Replay(1.0, slip=[0.1, 0.4, math.nan, 5.0], speed=[100.0, 100.0, 0.0, 19.0], weight=[3.0, 1.0, 9.0, 9.0], life=[1.0])
    figures = result.slip_statistics()
    assert figures["mean"] == pytest.approx((3 * 0.1 + 0.4) / 4)
    assert (figures["median"], figures["maximum"]) == (0.1, 0.4)
    assert math.isnan(Replay(1.0, slip=[math.nan], speed=[0.0], weight=[1.0]).slip_statistics()["mean"])


def test_the_scene_says_from_which_speed_on_slip_counts():
    samples = {"slip": [0.1, 0.4], "speed": [100.0, -30.0], "load": [5.0, 5.0], "weight": [1.0, 1.0]}
    assert Replay(1.0, **samples).slip_statistics()["maximum"] == 0.4 and Replay(1.0, **samples).seconds_above(0.2) == 1.0
    slower = Replay(1.0, **samples, slip_from_speed=50.0)
    assert slower.slip_statistics()["maximum"] == 0.1 and slower.seconds_above(0.2) == 0.0


def risen(interval, over):
    """Return outputs of a slip that rises from 0 to 6 % over a time [s] in the middle of ten seconds."""
    times = np.arange(interval, 10.0, interval)
    slips = 0.06 * np.clip((times - 5.0) / over, 0.0, 1.0)
    return Replay(10.0, time=times.tolist(), slip=slips.tolist(), speed=[1000.0] * len(times), weight=[interval] * len(times))


def test_outputs_that_are_coarser_than_the_motion_are_told_from_those_of_a_slow_one():
    jump = risen(0.3, 0.04).jump()
    assert (jump.slip, jump.interval) == pytest.approx((0.06, 0.3)) and 5.0 < jump.time < 5.4
    assert risen(0.005, 0.04).jump() is None and risen(0.3, 4.0).jump() is None
    gap = Replay(10.0, time=[1.0, 2.0, 8.0, 9.0], slip=[0.0, 0.0, 0.1, 0.1], speed=[1000.0] * 4, weight=[1.0] * 4)
    assert gap.jump() is None, "in a gap nothing was simulated"


def test_life_is_simulated_time_over_damage():
    thresholds = Thresholds()
    assert Replay(1.0, sim_seconds=7200.0, damage=0.01).use(thresholds).life_hours == pytest.approx(200.0)
    assert Replay(1.0, sim_seconds=7200.0).use(thresholds).life_hours == math.inf


def command(*arguments):
    return CliRunner().invoke(main, ["replay", *map(str, arguments)])


@pytest.mark.timeout(120)
def test_replay_and_report_tell_the_same_slip_of_a_log_that_ends_at_rest(tmp_path):
    log, out, page = tmp_path / "m.mcap", tmp_path / "r.mcap", tmp_path / "r.html"
    assert CliRunner().invoke(main, ["mission", "-o", str(log), "--duration", "3"]).exit_code == 0
    ran = command(log, "--scene", "deng2017_table1", "-o", out, "--json")
    report = json.loads(ran.stdout)
    assert 0.0 < report["cage_slip"] < report["cage_slip_maximum"] < 0.2
    assert report["outputs_coarse_at"]["interval"] == pytest.approx(0.02) and "coarser than the motion" in ran.stderr
    assert CliRunner().invoke(main, ["report", str(out), "-o", str(page)]).exit_code == 0
    text = re.sub(r"<[^>]*>", " ", page.read_text())
    shown = f"mean {100 * report['cage_slip']:.2f} %, largest {100 * report['cage_slip_maximum']:.2f} %"
    assert re.search(rf"cage slip while turning\s+{re.escape(shown)}", text)
    assert re.search(r"characteristic frequencies at the end\s+none: the shaft is slower than 191 rpm", text)


@pytest.mark.timeout(120)
def test_command_writes_inputs_and_outputs_and_one_json_object(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=2.0, speed=1500 * math.pi)
    out = tmp_path / "out.mcap"
    ran = command(log, "--scene", "deng2017_table1", "--set", "bearing.outer_raceway.d_value=0.098mm", "-o", out, "--json")
    assert ran.exit_code == 0, ran.output
    report = json.loads(ran.stdout)
    assert report["samples"] == 20 and report["read"]["not_used_by_reason"] == {} and report["non_finite_steps"] == 0
    assert 0.0 < report["cage_slip"] < 1.0 and report["life_hours"] > 0 and report["sim_seconds"] == pytest.approx(2.0)
    counts, ends = defaultdict(int), {}
    with open(out, "rb") as stream:
        for _, channel, _message, decoded in make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            counts[channel.topic] += 1
            ends[channel.topic] = decoded
    assert counts["/shaft_speed"] == counts["/radial_load"] == 21
    assert counts["/cage_slip"] == counts["/roller_loads"] == counts["/bearing_joints"] == 1 + 20  # the state at the start is the first
    assert ends["/damage"].data == pytest.approx(report["damage"])
    assert "oil_temperature" not in "".join(counts)


OVERLOADED = {"log": lambda k: 40e3 if 20 <= k < 39 else 800.0, "ramp": lambda k: 800.0 + 10.0 * k}


def overloaded(folder, name):
    """A log of 6 s at 10 Hz with an overload."""
    loads = [(0.1 * k, OVERLOADED[name](k), 0.0) for k in range(61)]
    return write_log(folder / f"{name}.mcap", [(time_, 4000.0) for time_, _, _ in loads], loads)


@pytest.mark.parametrize("name", ["log", "ramp"])
def test_an_overload_counts_by_default(tmp_path, name):
    result = command(overloaded(tmp_path, name), "--scene", "deng2017_table1", "--json")
    report = json.loads(result.stdout)
    assert result.exit_code == 0 and report["read"]["not_used_by_reason"] == {} and report["unknown_seconds"] == 0.0
    assert report["sim_seconds"] == pytest.approx(6.0) and report["life_and_damage_are"] == "as given"


@pytest.mark.parametrize(("name", "unknown"), [("log", 2.0), ("ramp", 5.0)])
def test_where_an_overload_was_refused_life_is_at_most_and_the_exit_code_is_3(tmp_path, name, unknown):
    log = overloaded(tmp_path, name)
    whole = json.loads(command(log, "--scene", "deng2017_table1", "--json").stdout)
    bounded = "--set", "input_limits.maximum_load=900 N"
    result = command(log, "--scene", "deng2017_table1", *bounded, "-o", tmp_path / "run.mcap", "--json")
    report = json.loads(result.stdout)
    assert result.exit_code == 3 and "input_limits.maximum_load" in result.stderr
    assert report["unknown_seconds"] == pytest.approx(unknown) and report["log_seconds"] == pytest.approx(6.0)
    assert report["life_and_damage_are"] == "at most, at least" and report["life_hours"] > whole["life_hours"] and report["damage"] < whole["damage"]
    assert report["events"]["input.unknown"] == 1
    told = command(log, "--scene", "deng2017_table1", *bounded)
    assert told.exit_code == 3 and "at most" in told.stdout and "at least" in told.stdout


@pytest.mark.timeout(120)
def test_view_for_rerun_gets_the_whole_run(tmp_path):
    chunk = pytest.importorskip("rerun.chunk", reason="rerun-sdk is not installed")
    log = steady_log(tmp_path / "log.mcap", duration=1.0)
    ran = command(log, "--scene", "deng2017_table1", "-o", tmp_path / "out.mcap", "--rrd", tmp_path / "run.rrd", "--json")
    assert ran.exit_code == 0, ran.output
    times = set()
    for part in chunk.RrdReader(str(tmp_path / "run.rrd")).stream():
        if not part.is_static and "sim_time" in part.timeline_names:
            times |= {moment.total_seconds() for moment in part.to_record_batch().column("sim_time").to_pylist()}
    assert {round(moment, 6) for moment in times} >= {place / 10 for place in range(1, 11)}


@pytest.mark.timeout(120)
def test_what_a_replay_writes_can_be_replayed(tmp_path):
    first = steady_log(tmp_path / "log.mcap", duration=0.5)
    assert command(first, "--scene", "deng2017_table1", "-o", tmp_path / "a.mcap").exit_code == 0
    again = command(tmp_path / "a.mcap", "--scene", "deng2017_table1", "-o", tmp_path / "b.mcap", "--json")
    assert again.exit_code == 0 and json.loads(again.stdout)["samples"] == 5


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["absent.mcap", "--scene", "deng2017_table1"], "no such file"),
        (["log.mcap", "--scene", "no_such_scene"], "no such file or bundled scene"),
        (["log.mcap", "--scene", "deng2017_table1", "--set", "bearing.roler.count=3"], "did you mean"),
        (["log.mcap", "--scene", "deng2017_table1", "--speed-topic", "/shaft_sped"], "no /shaft_sped"),
        (["log.mcap", "--scene", "deng2017_table1", "--rate", "0"], "rate"),
    ],
)
def test_bad_input_is_one_message_and_exit_code_2(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    steady_log(tmp_path / "log.mcap", duration=0.3)
    ran = command(*arguments, "-o", "out.mcap", "--json")
    assert ran.exit_code == 2 and words in ran.stderr and ran.stdout == ""
    assert not list(tmp_path.glob("out*"))


@pytest.mark.long
@pytest.mark.timeout(120)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_run_that_is_told_to_stop_leaves_a_finished_file(tmp_path, number):
    log = steady_log(tmp_path / "log.mcap", duration=2000.0)
    arguments = [sys.executable, "-m", "bearing_sim.cli", "replay", log, "--scene", "deng2017_table1", "-o", tmp_path / "out.mcap", "--json"]
    child = subprocess.Popen(
        [str(argument) for argument in arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        # a shell starts background jobs with SIGINT ignored, and children inherit that
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    active, deadline = tmp_path / "out.mcap.active", time.monotonic() + 60
    while not (active.exists() and active.stat().st_size > 60_000) and time.monotonic() < deadline:
        time.sleep(0.05)
    child.send_signal(number)
    stdout, stderr = child.communicate(timeout=30)
    assert child.returncode != 0 and b"Traceback" not in stderr and not active.exists()
    with open(tmp_path / "out.mcap", "rb") as stream:
        assert make_reader(stream).get_summary().statistics.message_count > 100


def test_log_is_never_overwritten_by_its_own_replay(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=0.3)
    before = log.read_bytes()
    ran = command(log, "--scene", "deng2017_table1", "-o", log)
    assert ran.exit_code == 2 and "another file" in ran.stderr and log.read_bytes() == before


def test_output_that_cannot_be_written_is_one_message_and_exit_code_2(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=0.3)
    (tmp_path / "folder").mkdir()
    busy = AppendFile(tmp_path / "busy.mcap.active")
    for out, words in (("folder", "is a folder"), ("log.mcap/out.mcap", "log.mcap"), ("busy.mcap", "another run is writing it")):
        ran = command(log, "--scene", "deng2017_table1", "-o", tmp_path / out)
        assert ran.exit_code == 2 and words in ran.stderr and "Traceback" not in ran.stderr
    busy.close()


def test_disk_that_fills_up_during_the_run_is_a_failed_run(tmp_path, monkeypatch):
    def full_disk(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(McapSink, "write", full_disk)
    ran = command(steady_log(tmp_path / "log.mcap", duration=0.3), "--scene", "deng2017_table1", "-o", tmp_path / "out.mcap")
    assert ran.exit_code == 1 and "No space left" in ran.stderr


def test_given_up_run_exits_1_with_a_finished_file(tmp_path, monkeypatch):
    def model(scene, inputs):
        simulation = FakeSimulation(inputs)
        simulation.fails_at = lambda time, inputs: time > 0.35
        simulation.counters = Counters(7, 2, 1, 0, 0, 0)
        return simulation

    monkeypatch.setattr(replay, "__defaults__", tuple(model if default is Simulation else default for default in replay.__defaults__))
    log = steady_log(tmp_path / "log.mcap", duration=5.0)
    ran = command(log, "--scene", "deng2017_table1", "-o", tmp_path / "out.mcap", "--json")
    assert ran.exit_code == 1 and "10 stretches" in ran.stderr
    assert json.loads(ran.stdout)["given_up"]
    with open(tmp_path / "out.mcap", "rb") as stream:
        assert make_reader(stream).get_summary().statistics.message_count > 0


@pytest.mark.timeout(300)
def test_a_minute_of_the_measured_flight_replays_whole(tmp_path):
    """Through import and replay; speed and load at the end against the table's own numbers."""
    source = measured_file("citation_flight_20190312_n1_n2_acc.csv")
    with open(source) as stream:
        lines = list(islice(stream, 601))
    (tmp_path / "minute.csv").write_text("".join(lines))
    imported = CliRunner().invoke(main, ["import-csv", str(tmp_path / "minute.csv"), "citation_flight", "-o", str(tmp_path / "minute.mcap")])
    assert imported.exit_code == 0, imported.output
    ran = command(tmp_path / "minute.mcap", "--scene", "deng2017_table1", "-o", tmp_path / "out.mcap", "--json")
    assert ran.exit_code == 0, ran.output
    report = json.loads(ran.stdout)
    assert (report["samples"], report["non_finite_steps"], report["failed_ticks"], report["read"]["not_used_by_reason"]) == (599, 0, 0, {})
    assert report["sim_seconds"] == pytest.approx(float(lines[-1].split(",")[0]) - float(lines[1].split(",")[0]))
    last = dict(zip(lines[0].split(","), map(float, lines[-1].split(","))))
    with open(tmp_path / "out.mcap", "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        *_, joints = (decoded for *_, decoded in reader.iter_decoded_messages(topics=["/bearing_joints"]))
    assert joints.velocity[0] == pytest.approx(last["N2_lh_pct"] / 100 * 32760 * math.pi / 30)
    assert 0.0 < joints.velocity[1] < joints.velocity[0] / 2


@pytest.mark.parametrize(
    "speed, celsius, expected",
    [
        (3000.0, (), (None, 120.0, 120.0)),
        (3000.0, (80.0, 80.0), (None, 80.0, 80.0)),
        (3000.0, (61.0, 68.0), (None, 56.85, 71.85)),  # 330 and 345 K
        (6000.0, (), (6120.0, 120.0, 120.0)),
    ],
)
def test_the_table_of_a_replay_spans_the_speeds_and_the_oil_temperatures_of_the_log(tmp_path, monkeypatch, speed, celsius, expected):
    """The operating speed of 4712 rad/s alone gives a table up to 5655 rad/s."""
    from bearing_sim.cli import replay as command

    asked = []
    monkeypatch.setattr("bearing_sim.cli.table.build_with_progress", lambda scene, ends: [asked.append((scene, ends))])
    scene = load_scene("deng2017_table1", ["level=steady"])
    path = write_log(tmp_path / "log.mcap", [(0.0, speed), (1.0, 100.0)], [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)], list(zip((0.0, 1.0), celsius)))
    command._choice(scene, judge(read_input_log(path), scene.accepted_inputs, HELD))
    ((built, ends),) = asked
    assert (built.table.maximum_speed, *(end - 273.15 for end in ends)) == pytest.approx(expected)


def test_a_skid_is_slip_above_the_warning_under_load_while_the_shaft_turns():
    result = Replay(10.0)
    result.slip, result.speed, result.load = [0.2, 0.2, 0.2, 0.01, math.nan], [100.0, 100.0, 5.0, 100.0, 0.0], [9.0, 0.0, 9.0, 9.0, 9.0]
    result.weight = [1.0, 2.0, 4.0, 8.0, 16.0]
    use = result.use(Thresholds())
    assert (use.skid_seconds, use.turning_seconds) == (1.0, 11.0), "neither without load, nor just above rest, nor below 5 %"
    assert "1 s with slip above 5 % under load, 9.09 % of the 11 s" in use.skid_text(Thresholds())


def test_the_time_below_a_minimum_load_counts_while_the_shaft_turns_and_grows_with_the_speed():
    result = Replay(10.0)
    result.speed, result.load, result.weight = [0.0, 0.5, 100.0, -100.0, 50.0], [0.0, 0.0, 900.0, 1100.0, 600.0], [1.0, 2.0, 4.0, 8.0, 16.0]
    assert result.seconds_below(lambda speeds: 10.0 * np.abs(speeds)) == (4.0, 28.0), "at rest and below 20 rad/s nothing counts"
    assert Replay(1.0).seconds_below(lambda speeds: speeds) == (0.0, 0.0)
