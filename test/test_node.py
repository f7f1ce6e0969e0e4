# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node as a process of its own, spoken to over DDS: outputs, recordings, bad input, services, signals."""

import math
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from mcap.reader import make_reader  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402
from support import wait_for  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.messages.events import Event  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.runtime.live import governor_of  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402
from bearing_sim.simulation import Simulation  # noqa: E402
from bearing_sim.view.viewer import is_complete  # noqa: E402

pytestmark = pytest.mark.timeout(180)
SECOND = 1_000_000_000
FAST = 45_000 * math.pi / 30  # [rad/s]; the other tests turn slower, so that a busy machine keeps up


@pytest.fixture
def launch(tmp_path):
    """Return a function that starts a node and a client of it; both are gone at the end."""
    started = []

    def start(*parameters, namespace="", scalar=False, arguments=(), **options):
        domain = fresh_domain()
        pairs = [word for parameter in parameters for word in ("-p", parameter)]
        process = NodeProcess(tmp_path, domain, "--ros-args", *pairs, *arguments, **options)
        client = Client(domain, namespace, scalar)
        started.append((process, client))
        return process, client

    yield start
    for process, client in started:
        client.close()
        process.end(signal.SIGKILL)


def ended_well(process, number):
    """Return whether a signal ended the node with exit code 0, no traceback, within a few seconds."""
    began = time.monotonic()
    code = process.end(number)
    assert code == 0, process.text
    assert "Traceback" not in process.text and "terminate called" not in process.text, process.text
    return time.monotonic() - began < 10.0


def test_speed_and_load_from_another_process_come_back_as_slip_and_life_and_as_a_recording_that_readers_accept(launch, tmp_path):
    recording, view = tmp_path / "out" / "run.mcap", tmp_path / "out" / "run.rrd"
    process, client = launch(f"record:={recording}", f"rrd:={view}", "publish_rate:=50", from_scratch=True)
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"], "the first slip arrives", process, shaft_speed=FAST)
    seen = {name: len(messages) for name, messages in client.received.items()}
    client.drive(3.0, shaft_speed=FAST)
    for name in topics.outputs(load_scene("deng2017_table1")):
        assert len(client.received[name]) - seen[name] > 3 * 50 * 0.4, f"{name} comes at about 50 Hz even on a busy machine"
    assert 2 <= len(client.received["diagnostics"]) - seen["diagnostics"] <= 20, "diagnostics come at 1 Hz and at changes"
    _check_last_outputs(client)
    values = client.values()
    # A busy machine may hold less than real time, but never more, and what is not held must be told as lost.
    held, lost = float(values["real-time factor held"]), float(values["time lost [s]"])
    assert 0.05 < held < 1.2 and (held > 0.8 or lost > 0.0)
    assert float(values["real-time factor possible"]) > 0.05
    assert values["phase"] == "running" and values["messages refused"] == "0"
    assert ended_well(process, signal.SIGTERM)
    _check_recording(recording)
    wait_for(lambda: is_complete(view))  # its process may outlive the node on a busy machine
    assert subprocess.run([_rerun(), "rrd", "verify", str(view)], capture_output=True, timeout=60).returncode == 0


def _check_last_outputs(client):
    scene, last = load_scene("deng2017_table1"), {name: messages[-1] for name, messages in client.received.items() if messages}
    # An independent calculation gives 5.95 % and 389 h for this scene after 0.5 s (Deng 2017 conditions).
    assert last["cage_slip"].data == pytest.approx(0.0595, rel=0.1)
    assert last["rating_life"].data == pytest.approx(389.0, rel=0.02)
    assert 0.0 < last["damage"].data < 1e-3
    joints = last["bearing_joints"]
    assert list(joints.name) == ["shaft", "cage", "cage_ideal"]
    ideal = FAST * (1 - scene.bearing.diameter_ratio) / 2
    assert joints.velocity[0] == pytest.approx(FAST) and joints.velocity[2] == pytest.approx(ideal)
    assert joints.velocity[1] == pytest.approx(ideal * (1 - last["cage_slip"].data), rel=0.01)
    stamps = [message.header.stamp.sec * SECOND + message.header.stamp.nanosec for message in client.received["bearing_joints"]]
    assert stamps == sorted(stamps) and abs(stamps[-1] - time.time_ns()) < 5 * SECOND
    loads = last["roller_loads"]
    assert [(d.label, d.size) for d in loads.layout.dim] == [("ring", 2), ("roller", scene.bearing.roller.count)]
    assert len(loads.data) == 2 * scene.bearing.roller.count and max(loads.data) > 800.0 / scene.bearing.roller.count


def _rerun():
    return str(Path(sys.executable).with_name("rerun"))


def _check_recording(path):
    """Every message deserialises with a strict reader, rerun accepts the file, and times and counts make sense."""
    check = subprocess.run([_rerun(), "mcap", "check", str(path)], capture_output=True, text=True, timeout=60)
    assert check.returncode == 0, check.stdout + check.stderr
    counts, times = {}, {}
    with AnyReader([path]) as reader:
        for connection, time_ns, raw in reader.messages():
            reader.deserialize(raw, connection.msgtype)
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
            times.setdefault(connection.topic, []).append(time_ns)
    for name in [*topics.outputs(load_scene("deng2017_table1")), "shaft_speed", "radial_load", "diagnostics"]:
        assert counts.get(f"/{name}", 0) >= 2, f"{name} is in the recording: {counts}"
    slips = times["/cage_slip"]
    assert slips == sorted(slips) and counts["/cage_slip"] > 200
    assert sorted(b - a for a, b in zip(slips, slips[1:]))[len(slips) // 2] == pytest.approx(SECOND / 100, rel=0.01), "100 samples a second"


@pytest.fixture(scope="module")
def gated(tmp_path_factory):
    """Return one running node with tight input limits and its client, for all bad inputs in turn."""
    domain = fresh_domain()
    limits = ["maximum_speed=50000rpm", "maximum_load=5000N", "stale_after=0.5s", "minimum_rate=5Hz", "maximum_rate=120Hz", "reverse_rotation=false"]
    overrides = ", ".join(f"'input_limits.{limit}'" for limit in limits)
    process = NodeProcess(tmp_path_factory.mktemp("gated"), domain, "--ros-args", "-p", f"overrides:=[{overrides}]", limit=240)
    client = Client(domain)
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"], "the node runs", process)
    yield process, client
    assert ended_well(process, signal.SIGINT)
    client.close()


def _send_nan(client):
    client.send("shaft_speed", shaft_speed=math.nan)


def _send_infinite_load(client):
    client.send("radial_load", load_z=math.inf)


def _send_negative(client):
    client.send("shaft_speed", shaft_speed=-4000.0)


def _send_absurd_speed(client):
    client.send("shaft_speed", shaft_speed=1e7)


def _send_absurd_load(client):
    client.send("radial_load", load_y=1e9)


def _send_from_the_past(client):
    client.send("shaft_speed", stamp_ns=time.time_ns() - 100 * SECOND, shaft_speed=1.0)


def _send_other_joint(client):
    state = topics.INPUTS["shaft_speed"].message(time.time_ns(), GOOD._replace(shaft_speed=1.0)) | {"name": ["propeller"]}
    from bearing_sim.ros.messages import message

    client.publishers["shaft_speed"].publish(message(topics.INPUTS["shaft_speed"].ros_type, state))


@pytest.mark.parametrize(
    "send, code, reason, level",
    [
        (_send_nan, "input.not_finite", "shaft_speed: nan rad/s is not finite", 2),
        (_send_infinite_load, "input.not_finite", "radial_load: (800, inf) N is not finite", 2),
        (_send_negative, "input.negative", "-4000 rad/s is negative", 2),
        (_send_absurd_speed, "input.too_large", "1e+07 rad/s is above", 2),
        (_send_absurd_load, "input.too_large", "1e+09 N is above", 2),
        (_send_from_the_past, "input.time_backwards", "before the last one", 2),
        (_send_other_joint, "input.malformed", "no joint 'shaft'", 2),
    ],
    ids=lambda value: value.__name__.removeprefix("_send_") if callable(value) else "",
)
def test_a_bad_message_is_refused_with_its_reason_in_diagnostics_and_the_last_good_input_is_held(gated, send, code, reason, level):
    process, client = gated
    client.drive(0.3)
    report, joint = len(client.received["diagnostics"]), len(client.received["bearing_joints"])
    send(client)
    told = lambda: [s for s in client.statuses(report) if code in s[1] and reason in s[2]]  # noqa: E731
    client.drive_until(told, f"{code} is reported", process)
    assert told()[0][0] == level and "holding" in told()[0][2]
    reports = [told for told in client.received["diagnostics"][report:] if code in str(told.status)]
    assert reports[0].status[0].level[0] == level, "the whole has the level of its worst part"
    speeds = {round(message.velocity[0], 3) for message in client.received["bearing_joints"][joint:]}
    assert speeds == {round(GOOD.shaft_speed, 3)}, "the model never saw the bad value"


def test_an_input_that_stays_away_is_told_as_stale_while_the_model_goes_on_with_the_last_one(gated):
    process, client = gated
    client.drive(0.5)
    report, joint = len(client.received["diagnostics"]), len(client.received["bearing_joints"])
    stale = lambda: {s[2].partition(":")[0] for s in client.statuses(report) if "input.stale" in s[1] and s[0] == 1}  # noqa: E731
    client.spin_until(lambda: stale() >= {"shaft_speed", "radial_load"}, "both inputs are told as stale", process)
    client.spin(0.3)
    later = client.received["bearing_joints"][joint:]
    assert len(later) > 10 and {round(message.velocity[0], 3) for message in later} == {round(GOOD.shaft_speed, 3)}


@pytest.mark.parametrize("rate", [2.5, 400.0])
def test_a_wrong_message_rate_is_told_with_the_rate(gated, rate):
    process, client = gated
    client.drive(0.3)
    report = len(client.received["diagnostics"])
    said = f"messages arrive at {'less than 5 Hz' if rate < 5.0 else 'more than 120 Hz'}"
    # the first report may still be that of a rate before
    wrong = lambda: [s for s in client.statuses(report) if "input.rate" in s[1] and said in s[2]]  # noqa: E731
    client.drive_until(wrong, f"the node says {said}", process, rate=rate)
    assert wrong()[0][0] == 1


def test_bad_input_leaves_no_lasting_harm_but_the_word_that_a_refused_overload_counts_nowhere(gated):
    process, client = gated
    names = lambda: [name for _, name, _ in client.statuses(-1) if "input." in name]  # noqa: E731
    client.drive_until(lambda: names() == ["bearing_node: input.unknown"], "no other trouble with inputs is left", process)
    assert process.process.poll() is None and "Traceback" not in process.text


def test_services_reset_pause_and_record(launch, tmp_path):
    process, client = launch()
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["damage"], "the node runs", process)
    client.drive(1.0)

    first = client.call(Trigger, "start_recording", Trigger.Request(), process)
    assert first.success and first.message.endswith("run.mcap")
    assert not client.call(Trigger, "start_recording", Trigger.Request(), process).success, "one recording at a time"
    client.drive(0.5)
    before = [message.data for message in client.received["damage"]]
    assert client.call(Trigger, "reset", Trigger.Request(), process).success
    client.drive(0.3)
    # without a reset damage never falls; how long the call takes does not matter
    assert min(message.data for message in client.received["damage"][len(before) :]) < before[-1]

    assert client.call(SetBool, "pause", SetBool.Request(data=True), process).success
    client.drive(0.3)
    held = len(client.received["cage_slip"])
    client.drive(0.5)
    assert len(client.received["cage_slip"]) == held
    client.drive_until(lambda: any("run.paused" in status[1] for status in client.statuses()), "the pause is told", process)
    assert client.call(SetBool, "pause", SetBool.Request(data=False), process).success
    client.drive_until(lambda: len(client.received["cage_slip"]) > held + 5, "the model goes on", process)

    done = client.call(Trigger, "stop_recording", Trigger.Request(), process)
    assert done.success and Path(first.message).is_file()
    assert not client.call(Trigger, "stop_recording", Trigger.Request(), process).success
    with AnyReader([Path(first.message)]) as reader:
        times = [t for c, t, _ in reader.messages() if c.topic == "/cage_slip"]
    assert len(times) > 30 and times == sorted(times), "time in a recording never goes back, not even at a reset"
    second = client.call(Trigger, "start_recording", Trigger.Request(), process)
    assert second.success and second.message.endswith("run_2.mcap")
    assert ended_well(process, signal.SIGTERM)
    assert Path(second.message).is_file(), "the signal completed the second recording"


def test_scalar_inputs_in_a_namespace(launch):
    process, client = launch("input_type:=scalar", "publish_rate:=20", namespace="/m1", scalar=True, arguments=["-r", "__ns:=/m1"])
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["bearing_joints"], "outputs come in the namespace", process)
    client.drive(0.3, load_y=600.0, shaft_speed=4000.0)
    assert client.received["bearing_joints"][-1].velocity[0] == pytest.approx(4000.0)
    report = len(client.received["diagnostics"])
    client.send("radial_load", load_y=-5.0)
    client.drive_until(lambda: [s for s in client.statuses(report) if "-5 N is negative" in s[2]], "a negative load is told", process)


@pytest.mark.long
def test_sigint_while_the_model_is_being_compiled_ends_at_once_and_in_order(launch, tmp_path):
    process, client = launch(f"record:={tmp_path / 'run.mcap'}", XDG_CACHE_HOME=str(tmp_path / "empty_cache"))
    client.spin_until(lambda: any("warming up" in status[2] for status in client.statuses()), "the node says that it is warming up", process)
    assert ended_well(process, signal.SIGINT)
    assert not list(tmp_path.glob("run.mcap*"))


def test_sigint_completes_the_recording(launch, tmp_path):
    recording = tmp_path / "run.mcap"
    process, client = launch(f"record:={recording}", "sample_rate:=200")
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"], "the node runs", process)
    client.drive(0.5)
    assert ended_well(process, signal.SIGINT)
    with open(recording, "rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None and summary.statistics.message_count > 100


@pytest.mark.long
def test_wrong_parameters_and_scenes_end_with_one_clear_message_and_code_2(tmp_path):
    blocked = tmp_path / "a_file"
    blocked.write_text("")
    cases = [
        (["publish_rate:=fast", "input_type:=scaler"], ["2 parameter errors", "publish_rate = 'fast'", "did you mean 'scalar'"]),
        (["scene:=deng2017_tabel1"], ["no such file or bundled scene", "deng2017_table1"]),
        (["overrides:=['lubricant.temprature=300']"], ["lubricant.temprature", "did you mean 'temperature'"]),
        ([f"record:={blocked}/run.mcap"], ["a_file"]),
        (["thresholds.slip_warning:='20 %'"], ["slip_warning: 20 % is above slip_error, 10 %"]),
    ]
    processes = []
    for parameters, _ in cases:
        words = [word for parameter in parameters for word in ("-p", parameter)]
        processes.append(NodeProcess(tmp_path, fresh_domain(), "--ros-args", *words))
    for (_, expected), process in zip(cases, processes):
        assert process.wait() == 2, process.text
        assert "Traceback" not in process.text
        assert all(words in process.text for words in expected), process.text


@pytest.mark.long
@pytest.mark.timeout(900)
def test_a_level_that_the_machine_is_too_slow_for_gives_way_and_everybody_is_told(launch, tmp_path):
    recording, slow = tmp_path / "run.mcap", ["level=spatial", "bearing.roller.slices=400"]
    governor_of(Simulation(load_scene("deng2017_table1", slow)))  # compiles what may not have been yet
    process, client = launch(f"overrides:={slow}", f"record:={recording}")
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["level"] and client.received["level"][-1].data < 3, "a cheaper level runs", process, shaft_speed=FAST)
    seen = len(client.received["diagnostics"])
    client.drive_until(
        lambda: any(number == 1 and name.endswith("governor.level") and "instead of spatial" in text for number, name, text in client.statuses(seen)),
        "the diagnostics warn of it",
        process,
        shaft_speed=FAST,
    )
    # A busy machine changes levels again at any time, and the diagnostics come once a second: the two agree between changes.
    client.drive_until(
        lambda: client.values().get("level") == {0: "steady", 1: "slip", 2: "planar"}.get(client.received["level"][-1].data),
        "the diagnostics name the level that is published",
        process,
        shaft_speed=FAST,
    )
    assert "governor.change: level spatial reaches" in process.text
    assert 0.04 < client.received["cage_slip"][-1].data < 0.11  # slip 6.2 %, planar 8.4 %
    assert ended_well(process, signal.SIGTERM)
    items = list(Recording(recording))
    told = [item.text for item in items if isinstance(item, Event) and item.kind == "governor.level"]
    assert told and "instead of spatial" in told[0]
    levels = np.concatenate([item["level"] for item in items if not isinstance(item, Event)])
    heard = {int(message.data) for message in client.received["level"]}
    assert min(heard) < 3 and heard <= set(levels) <= {0, 1, 2, 3}
