# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A recorded run is computed again from its recording alone; killed recordings come back without gaps; a clock that is set does no harm."""

import json
import math
import time
from unittest.mock import Mock

import numpy as np
import pytest
from click.testing import CliRunner
from fake_simulation import FakeSimulation
from made_up_response import FIELD, asking_scene, made_up_response
from recording_kills import kill_recordings
from recordings import steady_log

from bearing_sim.cli.main import main
from bearing_sim.messages import topics
from bearing_sim.messages.bands import BANDS
from bearing_sim.messages.events import Measurement, ReceivedInputs
from bearing_sim.model.sample import joined
from bearing_sim.recording.compare import compare
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.live import LiveModel
from bearing_sim.runtime.pacing import tick_schedule
from bearing_sim.runtime.reproduction import reproduce
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation, start_sample
from bearing_sim.watchers.estimation.live import LiveEstimation

START = 1_700_000_000_000_000_000


def invoke(*arguments, code=0):
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == code, done.output + repr(done.exception)
    return done.stdout


def live_run(
    scene,
    path,
    rate=1000.0,
    publish_rate=100.0,
    from_start=True,
    steady=False,
    reset_at=(),
    skip_at=(),
    ticks=120,
    measured=lambda tick: (),
    estimation=None,
    cage_slip=None,
):
    """Record a run as a live one makes it: tick by tick to inputs that step, in the blocks of a tick schedule, with time that is skipped.

    ``measured(tick)`` are the temperatures of the rings [K]; ``estimation`` a `LiveEstimation`, ``cage_slip`` that of a cage measured in each tick.
    """

    def estimate(block):
        estimation.know([*topics.ALWAYS_KNOWN])
        if tick in reset_at:
            estimation.restart("")
        if cage_slip is not None:
            speed, now = (1.0 - cage_slip) * float(block["ideal_cage_speed"][-1]), float(block["time"][-1])
            estimation.measure(now, speed)
            sink.write(Measurement(now, speed, cage_slip - float(block["cage_slip"][-1])))
        return estimation.see(block)

    simulation, beat, shift = Simulation(scene, Inputs(3000.0, 700.0, 0.0, 393.15)), tick_schedule(rate, publish_rate), 0.5
    with McapSink(path, scene, START, advance=(beat.tick, beat.samples)) as sink:
        if from_start:
            block = start_sample(simulation)
            block["time"] += shift
            sink.write(block)
        for tick in range(ticks):
            inputs = (
                Inputs(3000.0, 700.0, 0.0, 393.15, *measured(tick))
                if steady
                else Inputs(3000.0 + 40.0 * (tick // 7), 700.0 - 3.0 * tick, 2.0 * tick, 393.15 + 0.1 * (tick // 40))
            )
            if tick in skip_at:
                shift += 0.3
            if tick in reset_at:
                shift += simulation.time
                simulation.reset(inputs)
            block = simulation.advance(beat.tick, inputs, beat.samples)
            block["time"] += shift
            if from_start or tick >= ticks // 2:
                sink.write(block)
                sink.write(ReceivedInputs(float(block["time"][-1]), inputs))
                for bands in estimate(block) if estimation is not None else ():
                    sink.write(bands)
    return path


def sink_of_nothing():
    return Mock(spec=["write"])


def bands_in(path):
    return sum(bands.topic == BANDS for bands in Recording(path).bands())


def worst(differences, *topics):
    return max(float(difference.relative.max()) for difference in differences if not topics or difference.topic[1:] in topics)


def repeated(path, folder):
    told = json.loads(invoke("replay", path, "--from-recording", "-o", folder / "again.mcap", "--json"))
    return told, compare(path, folder / "again.mcap", 1e-6)[0]


@pytest.mark.parametrize(("rate", "publish_rate"), [(100.0, 50.0), (1000.0, 100.0)])
@pytest.mark.parametrize(("level", "steady", "tolerance"), [("slip", False, 1e-9), ("slip", True, 0.0), ("planar", True, 0.0)])
def test_a_run_from_its_start_is_repeated_to_round_off_and_to_the_bit_under_constant_inputs(tmp_path, level, steady, tolerance, rate, publish_rate):
    scene = load_scene("deng2017_table1", [f"level={level}"])
    told, differences = repeated(live_run(scene, tmp_path / "run.mcap", rate, publish_rate, steady=steady, ticks=60), tmp_path)
    assert told["starts"] == ["ideal rolling"] and told["failed"] == 0 and told["skipped_seconds"] == pytest.approx(0.0, abs=1e-9)
    assert all(not (difference.only_first or difference.only_second) for difference in differences)
    assert worst(differences) <= tolerance and {d.topic for d in differences} > {"/shaft_speed", "/roller_loads", "/roller_places"}


@pytest.mark.parametrize("heat", ["{law: given}", "{law: network, interval: 50 ms}"])
def test_a_run_with_measured_temperatures_that_come_and_go_is_repeated_to_the_bit(tmp_path, heat):
    scene = load_scene("deng2017_table1", [f"heat={heat}"])

    def measured(tick):
        return (math.nan, math.nan) if not 20 < tick < 40 else (395.0 + 0.1 * tick, math.nan if tick < 30 else 394.0)

    path = live_run(scene, tmp_path / "run.mcap", 100.0, 50.0, steady=True, ticks=60, measured=measured)
    told, differences = repeated(path, tmp_path)
    assert told["failed"] == 0 and worst(differences) == 0.0
    assert {"/measured_temperatures", "/predicted_temperatures"} <= {difference.topic for difference in differences}
    samples = joined([item for item in Recording(path) if isinstance(item, np.ndarray)])
    assert 0 < np.isnan(samples["inner_ring_temperature_measured"]).sum() < np.isnan(samples["outer_ring_temperature_measured"]).sum() < len(samples)


def test_time_that_a_live_run_gave_up_and_its_resets_are_repeated(tmp_path):
    scene = load_scene("deng2017_table1")
    told, differences = repeated(live_run(scene, tmp_path / "run.mcap", reset_at=(60,), skip_at=(20, 90)), tmp_path)
    assert told["starts"] == ["ideal rolling", "ideal rolling"] and told["skipped_seconds"] == pytest.approx(0.6, rel=1e-6)
    assert worst(differences) < 1e-3  # the tick of the reset began at inputs that no sample has


def test_a_recording_that_begins_in_the_middle_of_a_run_is_gone_on_from(tmp_path):
    scene = load_scene("deng2017_table1")
    told, differences = repeated(live_run(scene, tmp_path / "run.mcap", from_start=False), tmp_path)
    assert told["starts"] == ["sample"] and told["samples"] == 300
    assert worst(differences, "bearing_joints", "roller_places") < 1e-4
    # lives follow from running means of powers of the loads, of which a sample has two of eight: they differ by a per cent until a turn is over
    assert worst(differences, "damage") < 5e-4
    assert worst(differences, "cage_slip", "roller_loads") < 1e-2  # goes on from observables, not from the whole state


def test_a_run_of_the_command_line_needs_no_other_file_to_be_repeated(tmp_path):
    invoke("run", "deng2017_table1", "--set", "operating.shaft_speed=20000 rpm", "--duration", "0.05", "--out", tmp_path / "run.mcap")
    invoke("replay", tmp_path / "run.mcap", "--from-recording", "-o", tmp_path / "again.mcap")
    assert "the recordings agree" in invoke("compare", tmp_path / "run.mcap", tmp_path / "again.mcap", "--tolerance", "1e-9")
    assert Recording(tmp_path / "again.mcap").scene.operating.shaft_speed == pytest.approx(20000 * np.pi / 30)


def test_a_replayed_log_is_repeated_with_its_messages(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=0.3, rate=50, speed=2000.0)
    invoke("replay", log, "--scene", "deng2017_table1", "--rate", "200", "-o", tmp_path / "run.mcap")
    told, differences = repeated(tmp_path / "run.mcap", tmp_path)
    assert told["received"] == 32 and all(difference.agrees for difference in differences)


def test_bands_are_computed_again_and_compared_with_those_of_the_run(tmp_path, monkeypatch):
    scene = asking_scene("level=slip")
    response = made_up_response(scene)
    path = live_run(scene, tmp_path / "run.mcap", 100.0, 50.0, ticks=60, reset_at=(30,), estimation=LiveEstimation(scene, response))
    with McapSink(tmp_path / "again.mcap", scene, START) as sink:
        found = reproduce(Recording(path), sink, given={"estimation": response}).bands
    assert {"cage_slip", "rating_life", "running_clearance", "remaining_life"} <= set(found)
    count = bands_in(path)
    assert count > 10 and all((each.compared, each.missing, each.further) == (count, 0, 0) for each in found.values())
    assert all(each.largest < 1e-2 and each.near == count for each in found.values()), "the tick of the reset began at inputs that no sample has"
    (bands,) = [each for each in compare(path, tmp_path / "again.mcap", 1e-3)[0] if each.topic == "/bands"]
    assert bands.matched == count and not (bands.only_first or bands.only_second)
    monkeypatch.setattr("made_up_response.FACTOR", 6.0)
    told = reproduce(Recording(path), sink_of_nothing(), given={"estimation": made_up_response(scene)}).bands
    assert told["cage_slip"].largest > 0.3 and told["cage_slip"].near < count, "another response shows"
    monkeypatch.setattr("bearing_sim.cli.replay.response_with_progress", lambda asked: response)
    assert "band of cage_slip" in invoke("replay", path, "--from-recording")
    assert json.loads(invoke("replay", path, "--from-recording", "--json"))["bands"]["cage_slip"]["compared"] == count


def test_what_measurements_taught_is_learned_again(tmp_path):
    scene = asking_scene("level=slip", f"estimation.calibrated=[{FIELD}]")
    response = made_up_response(scene)
    estimation = LiveEstimation(scene, response)
    path = live_run(scene, tmp_path / "run.mcap", 100.0, 50.0, steady=True, ticks=400, estimation=estimation, cage_slip=0.03)
    assert estimation.is_calibrated
    found = reproduce(Recording(path), sink_of_nothing(), given={"estimation": response}).bands
    assert FIELD in found and found[FIELD].compared > 3 and found["cage_slip"].compared == bands_in(path)
    assert all((each.missing, each.further) == (0, 0) and each.largest < 1e-6 for each in found.values())


def test_a_repetition_of_another_model_differs(tmp_path, monkeypatch):
    """What compare is for: a change of the model shows."""
    scene = load_scene("deng2017_table1")
    path = live_run(scene, tmp_path / "run.mcap", ticks=30)
    heavier = load_scene("deng2017_table1", ["bearing.roller.length=8mm"])
    monkeypatch.setattr("bearing_sim.runtime.reproduction.Recording.scene", heavier, raising=False)
    real = Simulation.__init__
    monkeypatch.setattr(Simulation, "__init__", lambda self, scene, *rest, **more: real(self, heavier, *rest, **more))
    invoke("replay", path, "--from-recording", "-o", tmp_path / "again.mcap")
    assert "DIFFERS" in invoke("compare", path, tmp_path / "again.mcap", code=1)


def test_from_recording_refuses_what_does_not_go_with_it(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=0.3)
    for arguments, code in (
        (["--from-recording", "--scene", "deng2017_table1"], 2),
        ([], 2),
        (["--from-recording"], 2),
        (["--from-recording", "--rate", 5], 2),
    ):
        invoke("replay", log, *arguments, code=code)


@pytest.mark.long
def test_killed_recordings_come_back_without_gaps(tmp_path):
    """`python test/benchmarks/recording_kills.py` kills many more, and measures how much of the end is lost, which depends on the machine."""
    for kill in kill_recordings(tmp_path, 2, seed=11):
        assert kill.gaps == 0 and kill.recovered <= kill.recorded, kill


def test_a_clock_that_is_set_is_told_and_the_recording_goes_on_evenly(tmp_path):
    scene = load_scene("deng2017_table1", ["input_limits.minimum_rate=0Hz"])
    simulation, ahead_ns = FakeSimulation(), 0
    began = time.monotonic()
    live = LiveModel(scene, simulation, START, 200.0)
    sink = McapSink(tmp_path / "run.mcap", load_scene("deng2017_table1", ["bearing.roller.count=6"]), START)
    live.sinks.attach("record", sink)
    news = []
    for step in range(60):
        if step == 20:
            ahead_ns = 3600 * 10**9
        if step == 40:
            ahead_ns = -7200 * 10**9
        now_ns = START + ahead_ns + round((time.monotonic() - began) * 1e9)
        live.offer("shaft_speed", (100.0,), now_ns, now_ns, "shaft")
        live.offer("radial_load", (800.0, 0.0), None, now_ns)
        news += live.collect(now_ns)
        time.sleep(0.02)
    elapsed = time.monotonic() - began
    live.close()
    jumps = [event.text for event in news if event.kind == "clock.jumped"]
    assert len(jumps) >= 1 and "+3600" in jumps[0]
    found = contents(tmp_path / "run.mcap")
    assert found.is_sound and 0 <= found.first_ns - START and found.last_ns - START < (elapsed + 1.0) * 1e9
    assert found.messages["/shaft_speed"] == 60 and found.messages["/roller_loads"] > 50
    times = np.concatenate([item["time"] for item in Recording(tmp_path / "run.mcap") if isinstance(item, np.ndarray)])
    assert (np.diff(times) > 0).all() and np.diff(times).max() < 1.0
