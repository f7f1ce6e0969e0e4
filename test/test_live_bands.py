# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about bands on their way: from the samples of a run into messages, recordings, results, diagnostics and views; none where none is asked."""

import dataclasses
import json
import math

import numpy as np
import pytest
from fake_simulation import FakeSimulation
from made_up_response import ASKING, FACTOR, FIELD, asking_scene, made_up_response
from recordings import steady_log
from rerun_files import column, views_in
from sim_time_bench import course, write
from support import ListSink
from synthetic_run import synthetic_block
from test_live import Bench

from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.messages import topics
from bearing_sim.messages.bands import BANDS, ESTIMATES, Bands, bands_of_message
from bearing_sim.messages.cdr import typestore
from bearing_sim.messages.diagnostics import report
from bearing_sim.messages.events import Level, MeasuredClearance, Received
from bearing_sim.messages.sample_messages import FilledMessages
from bearing_sim.messages.topics import MEASURED_CHANNELS
from bearing_sim.model.sample import RING_TEMPERATURES
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.replay import replay
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Counters, Inputs
from bearing_sim.view.blueprint import blueprint
from bearing_sim.view.worker import RerunFile
from bearing_sim.watchers.estimation import bands
from bearing_sim.watchers.estimation.bands import BandEstimator
from bearing_sim.watchers.estimation.estimator import Estimator
from bearing_sim.watchers.estimation.live import LiveEstimation
from bearing_sim.watchers.estimation.response import conditions_at
from bearing_sim.watchers.stored_state.keeper import StateKeeper
from bearing_sim.watchers.stored_state.state import Damaged, StoredState, migrated, new_state

START = 1_700_000_000_000_000_000
SCENE = asking_scene()
NAMES = ("cage_slip", "rating_life", "running_clearance", "remaining_life")
UNITS = ("", "h", "m", "h")


@pytest.fixture(scope="module")
def response():
    return made_up_response(SCENE)


def some_bands(count=3):
    numbers = np.arange(count * 12.0).reshape(count, 4, 3)
    return Bands(BANDS, NAMES, UNITS, 0.02 * np.arange(1, count + 1), numbers)


def test_a_message_names_every_quantity_with_its_unit_and_both_edges():
    message = topics.ESTIMATED[BANDS].message(START, some_bands())
    assert message["name"] == [
        *("cage_slip", "cage_slip 5 %", "cage_slip 95 %"),
        *("rating_life [h]", "rating_life 5 % [h]", "rating_life 95 % [h]"),
        *("running_clearance [m]", "running_clearance 5 % [m]", "running_clearance 95 % [m]"),
        *("remaining_life [h]", "remaining_life 5 % [h]", "remaining_life 95 % [h]"),
    ]
    assert message["position"].tolist() == list(range(12))


def test_messages_filled_from_a_template_are_those_of_the_topic():
    bands, topic = some_bands(), topics.ESTIMATED[BANDS]
    for k, data in enumerate(FilledMessages().of_bands(bands, [START + k for k in range(3)], "m1")):
        found = typestore().deserialize_cdr(data, topic.ros_type)
        assert (found.header.frame_id, found.header.stamp.nanosec) == ("m1", k)
        assert tuple(found.name) == bands.message_names and found.position.tolist() == bands.numbers[k].ravel().tolist()


def test_a_recording_returns_bands_as_they_were_written(tmp_path):
    path, bands = tmp_path / "run.mcap", some_bands()
    estimates = Bands(ESTIMATES, (FIELD, "lubricant.temperature"), ("", "K"), np.array([0.06]), np.arange(6.0).reshape(1, 2, 3))
    with McapSink(path, SCENE, START) as sink:
        sink.write(synthetic_block(SCENE, 0.02 * np.arange(5)))
        sink.write(bands)
        sink.write(estimates)
    found = list(Recording(path).bands())
    assert [one.topic for one in found] == [BANDS] * 3 + [ESTIMATES]
    assert np.allclose([one.times[0] for one in found[:3]], bands.times) and np.array_equal(
        np.concatenate([one.numbers for one in found[:3]]), bands.numbers
    )
    assert (found[3].names, found[3].units) == (estimates.names, estimates.units) and np.array_equal(found[3].numbers, estimates.numbers)


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["cage_slip", "cage_slip 5 %"], [1.0, 2.0]),
        (["cage_slip", "cage_slip 5 %", "cage_slip 95 %"], [1.0, 2.0]),
        (["cage_slip", "cage_slip 5 %", "rating_life 95 %"], [1.0, 2.0, 3.0]),
        (["", " 5 %", " 95 %"], [1.0, 2.0, 3.0]),
        (["a [", "a 5 % [", "a 95 % ["], [1.0, 2.0, 3.0]),
    ],
)
def test_names_that_are_not_those_of_bands_are_refused(names, numbers):
    with pytest.raises(ValueError, match="expected each quantity with its 5 % and 95 % quantiles"):
        bands_of_message(BANDS, 0.0, names, np.array(numbers))


def test_a_recording_with_another_message_on_the_topic_says_so(tmp_path):
    path = tmp_path / "run.mcap"
    with McapSink(path, SCENE, START) as sink:
        sink.write(synthetic_block(SCENE, 0.02 * np.arange(5)))
        cut = FilledMessages().of_bands(some_bands(), [0, 0, 0], "bearing")[0][:-100]
        sink.write(Received("/bands", "sensor_msgs/msg/JointState", START, START, cut))
    with pytest.raises(RecordingError, match="a message on /bands cannot be read"):
        list(Recording(path).bands())
    assert sum(len(item) for item in Recording(path)) == 5, "samples can be read all the same"


def anywhere(response, count):
    """Return samples at operating points all over the response, in order of time."""
    places = np.random.default_rng(3).random((count, 4))
    speeds, loads, temperatures, angles = conditions_at(places, response.domain).T
    block = synthetic_block(SCENE, 0.02 * np.arange(1, count + 1))
    block["shaft_speed"], block["load_y"], block["load_z"] = speeds, loads * np.cos(angles), loads * np.sin(angles)
    block["oil_temperature"] = temperatures
    return block


def test_edges_of_rounded_operating_points_are_off_by_little_of_their_width(response, monkeypatch):
    block, columns = anywhere(response, 200), response.centres.shape[1]
    weights = response.weights.copy()
    # widths change by a factor of e^2 over each range of the operating points
    weights[-columns:, :, 1] += np.linalg.inv(response.metrics).sum(axis=2).T
    varied = response._replace(weights=weights)
    rounded = BandEstimator(SCENE, varied).estimate(block)[:, 0]
    monkeypatch.setattr(bands, "cells", lambda conditions, domain: conditions)
    exact = BandEstimator(SCENE, varied).estimate(block)[:, 0]
    widths = np.ptp(exact, axis=1, keepdims=True)
    off = np.abs(rounded - exact) / widths
    assert widths.max() > 10.0 * widths.min() and 0.0 < off.max() < 0.03


def test_bands_of_a_sample_do_not_depend_on_those_that_come_with_it(response, monkeypatch):
    block = anywhere(response, 60)
    monkeypatch.setattr(bands, "_CELLS_KEPT", 50)
    together, singly = (BandEstimator(SCENE, response) for _ in range(2))
    each = np.concatenate([singly.estimate(block[k : k + 1]) for k in range(60)])
    np.testing.assert_allclose(together.estimate(block), each, rtol=1e-10)
    np.testing.assert_allclose(together.estimate(block)[:, :3], each[:, :3], rtol=1e-10)


def test_rounded_operating_points_stay_in_the_domain_of_the_response(response):
    domain = response.domain
    ends = np.array([[speed, load, kelvin, 0.0] for speed in domain.speeds for load in domain.loads for kelvin in domain.temperatures])
    assert not response.outside(bands.cells(ends, domain)).any()
    beyond = ends[-1:] * [1.001, 1.0, 1.0, 1.0]
    assert response.outside(beyond).all() and response.outside(bands.cells(beyond, domain)).all()


def test_another_memory_of_the_damage_rate_acts_on_the_remaining_life_from_then_on(response):
    block = synthetic_block(SCENE, 10.0 * np.arange(1, 5))
    block["modified_rating_life"], block["damage"] = [400.0, 400.0, 40.0, 40.0], 0.0
    kept, adjusted = (LiveEstimation(SCENE, response) for _ in range(2))
    for live in (kept, adjusted):
        live.see(block[:2])
    adjusted.adjust(dataclasses.replace(SCENE.thresholds, remaining_life_memory=1e-3))
    slow, quick = (live.see(block[2:])[0].numbers[-1, NAMES.index("remaining_life")] for live in (kept, adjusted))
    assert quick[0] == pytest.approx(40.0) and slow[0] > 1.5 * quick[0] and (slow[1:] > 1.5 * quick[1:]).all()


def test_bands_come_at_most_at_the_rate_of_the_scene(response):
    block = synthetic_block(SCENE, 0.005 * np.arange(200))
    for rate, expected in (("50 Hz", 50), ("10 Hz", 10), ("1000 Hz", 200)):
        live = LiveEstimation(asking_scene(f"estimation.rate={rate}"), response)
        times = np.concatenate([bands.times for part in np.array_split(block, 7) for bands in live.see(part)])
        assert len(times) == expected and (np.diff(times) > 0.0).all()


def test_a_band_lies_about_the_value_of_the_sample_as_the_field_moves_it(response):
    live, block = LiveEstimation(SCENE, response), synthetic_block(SCENE, 0.1 * np.arange(20), slips=(0.02, 0.02))
    (bands,) = live.see(block)
    slip, life = bands.numbers[:, 0], bands.numbers[:, 1]
    assert np.array_equal(slip[:, 0], block["cage_slip"]) and np.array_equal(life[:, 0], block["rating_life"])
    # The middle nine tenths of a uniform range, 0.02 to 0.06, about the scene's own 0.03, at a quarter of it.
    for values, factor in ((slip, FACTOR), (life, FACTOR**-0.2)):
        edges = sorted((factor ** (0.05 - 0.25), factor ** (0.95 - 0.25)))
        assert np.allclose(values[:, 1:] / values[:, :1], edges, rtol=0.02)


def test_the_life_that_remains_is_what_damage_has_left_of_the_modified_life(response):
    bands, block = BandEstimator(SCENE, response), synthetic_block(SCENE, [0.1], slips=(0.02, 0.02))
    block["damage"] = 0.25
    bands.estimate(block)
    assert np.allclose(bands.remaining_life, 0.75 * block["modified_rating_life"])


def test_diagnostics_show_both_edges_with_their_subject(response):
    live = LiveEstimation(SCENE, response)
    assert live.values(0.0) == {}
    live.see(synthetic_block(SCENE, 0.1 * np.arange(20)))
    status = {each["name"].partition(": ")[2]: {pair["key"] for pair in each["values"]} for each in report(START, (), live.values(2.0))["status"]}
    assert {"cage slip 5 % [fraction]", "cage slip 95 % [fraction]"} <= status["slip"]
    assert {"rating life 5 % [h]", "remaining life 95 % [h]"} <= status["life"]
    assert {"running clearance 5 % [m]", "running clearance 95 % [m]"} <= status["clearance"]


def model(scene, inputs):
    """Return a simulation that solves nothing."""
    simulation = FakeSimulation(inputs)
    simulation.counters = Counters(7, 2, 1, 0, 0, 0)
    return simulation


def replayed(scene, tmp_path, measured=None, **options):
    path = tmp_path / "log.mcap"
    if not path.exists():
        steady_log(path, duration=2.0 if measured is None else 4.0, rate=50)
    profile = judge(read_input_log(path), scene.accepted_inputs, Inputs(0.0, 0.0, 0.0, 393.15))
    if measured is not None:
        profile.stamps[topics.MEASURED] = 100_000_000 * np.arange(1, 40)
        profile.values[topics.MEASURED] = np.tile([0.4 * 4000.0 * (1.0 - measured), math.nan], (39, 1))
    sink = ListSink()
    return replay(scene, profile, sink, model=model, **options), sink


def test_a_replay_writes_bands_and_sums_them_up(response, tmp_path):
    result, sink = replayed(SCENE, tmp_path, given={"estimation": response})
    assert sum(len(bands.times) for bands in sink.bands) == result.samples
    low, high = result.band_statistics()["cage_slip"]
    assert low == pytest.approx(0.01 * FACTOR**-0.2, rel=0.05) and high == pytest.approx(0.01 * FACTOR**0.7, rel=0.05)


def test_a_scene_that_does_not_ask_has_no_bands_and_no_topic_of_them(response, tmp_path):
    scene = load_scene("deng2017_table1")
    result, sink = replayed(scene, tmp_path, given={"estimation": response})
    assert sink.bands == [] and result.band_statistics() == {} and topics.estimated(scene) == {}


def test_a_live_model_records_and_hands_on_bands(response):
    bench, sink = Bench(scene=["estimation.bands=true"], given={"estimation": response}), ListSink()
    bench.live.open("list", lambda start_ns: sink)
    try:
        bench.run(0.6)
        published = bench.live.bands()
        assert published and bench.live.bands() == []
        assert [bands.times.tolist() for bands in sink.bands] == [bands.times.tolist() for bands in published]
        assert "cage slip 95 % [fraction]" in bench.live.condition(bench.now_ns).values
    finally:
        bench.live.close()


def test_a_live_model_without_a_response_says_what_builds_one():
    bench = Bench(scene=["estimation.bands=true"])
    try:
        bench.run(0.1)
        (event,) = (event for event in bench.live.condition(bench.now_ns).events if event.kind == "estimate.absent")
        assert event.level is Level.WARN and "bearing-sim table SCENE --bands" in event.action
    finally:
        bench.live.close()


def test_a_live_model_estimates_by_a_response_that_comes_later(response, monkeypatch):
    bench = Bench(scene=["estimation.bands=true"])
    try:
        bench.run(0.3)
        assert bench.live.bands() == []
        kept = [None, response]
        monkeypatch.setattr("bearing_sim.watchers.estimation.live.kept_response", lambda scene: kept.pop(0))
        assert bench.live.watchers.complete() == {}
        assert [*bench.live.watchers.complete()] == ["estimation"]
        bench.run(0.3)
        assert bench.live.bands()[0].times[0] > 0.25, "none of what was before"
        condition = bench.live.condition(bench.now_ns)
        assert "cage slip 95 % [fraction]" in condition.values and not [event for event in condition.events if event.kind == "estimate.absent"]
    finally:
        bench.live.close()


def test_a_view_shades_from_one_edge_to_the_other(tmp_path):
    path, block = tmp_path / "run.rrd", synthetic_block(SCENE, 0.02 * np.arange(50))
    numbers = np.broadcast_to(np.array([[0.05, 0.03, 0.11], [300.0, 100.0, 1000.0], [1e-5, 0.0, 3e-5], [1e3, 1e2, 1e12]]), (50, 4, 3))
    with RerunFile(SCENE, path) as sink:
        sink.write(block)
        sink.write(Bands(BANDS, NAMES, UNITS, block["time"], numbers))
    expected = {"/slip/band": (3.0, 11.0), "/life/band": (2.0, 3.0), "/clearance/band": (0.0, 30.0), "/remaining_life/band": (2.0, 7.0)}
    for entity, edges in expected.items():
        (_, middle), (_, variance) = (column(path, entity, f"Measurements:{part}") for part in ("values", "variances"))
        assert np.allclose([middle - np.sqrt(variance), middle + np.sqrt(variance)], np.array(edges)[:, None], atol=1e-5), entity


def test_bands_and_calibrated_fields_have_plots_only_where_a_scene_asks_for_them():
    def contents(scene):
        views = views_in(blueprint(scene, ((0.0, 1.0), (0.0, 1.0)), live=False, measured=MEASURED_CHANNELS).root_container)
        return {path for view in views for path in (view.contents if isinstance(view.contents, list) else [])}

    asked = contents(asking_scene(f"estimation.calibrated=[{FIELD}]")) - contents(load_scene("deng2017_table1"))
    assert {"/slip/band", "/life/band", "/clearance/band", "/remaining_life/band", "/estimate/lubricant_mixture_fraction/band"} <= asked


def test_a_band_without_numbers_leaves_a_gap(response):
    block = synthetic_block(SCENE, 0.1 * np.arange(4))
    block["oil_temperature"][1] = 800.0  # outside of what the response was fitted to
    (bands,) = LiveEstimation(SCENE, response).see(block)
    assert np.isnan(bands.numbers[1, 0, 1:]).all() and not math.isnan(bands.numbers[1, 0, 0]) and np.isfinite(bands.numbers[2, 0]).all()


CALIBRATED = asking_scene(f"estimation.calibrated={FIELD}")


def measured_run(live, seconds, true_slip, start=0.0):
    """Let a cage with that slip be measured beside samples of 2 %; return the bands and estimates."""
    random, found = np.random.default_rng(1), []
    for second in range(round(seconds)):
        block = synthetic_block(CALIBRATED, start + second + 0.1 * np.arange(1, 11), speeds=(4700.0, 4700.0), slips=(0.02, 0.02))
        for name in RING_TEMPERATURES:
            block[f"{name}_measured"] = math.nan
        for sample in block:
            live.measure(float(sample["time"]), float(sample["ideal_cage_speed"]) * (1.0 - true_slip - 0.001 * random.normal()))
        found += live.see(block)
    return found


@pytest.fixture(scope="module")
def calibrated(response):
    live = LiveEstimation(CALIBRATED, response)
    return live, measured_run(live, 60, 0.025)


def test_a_measured_cage_moves_the_prediction_to_it_and_narrows_the_bands(calibrated):
    live, found = calibrated
    bands = [each for each in found if each.topic == BANDS]
    slip = np.concatenate([each.numbers for each in bands])[:, 0]
    assert slip[0, 0] == pytest.approx(0.02) and slip[-1, 0] == pytest.approx(0.025, abs=1e-3)
    assert np.ptp(slip[-1, 1:]) < 0.2 * np.ptp(slip[0, 1:]) and slip[-1, 1] < 0.025 < slip[-1, 2]
    life = np.concatenate([each.numbers for each in bands])[:, 1]
    assert np.ptp(np.log(life[-1, 1:])) < 0.5 * np.ptp(np.log(life[0, 1:])), "what shares its cause with slip is known better, too"
    assert live.is_calibrated and live.remark.startswith("calibrated by measurements")
    assert not live.accept_change(), "there was no change"


def test_estimates_come_every_interval_and_close_in_on_the_field_that_was_hidden(calibrated):
    estimates = [each for each in calibrated[1] if each.topic == ESTIMATES]
    assert len(estimates) == 60 and {each.names for each in estimates} == {(FIELD,)}
    hidden = 0.02 + 0.04 * (0.25 + math.log(0.025 / 0.02) / math.log(FACTOR))
    value, low, high = estimates[-1].numbers[0, 0]
    assert low < hidden < high and high - low < 0.5 * np.ptp(estimates[0].numbers[0, 0, 1:]) and low < value < high


@pytest.fixture
def clearances(monkeypatch):
    """Return what reaches the estimator as measured clearances."""
    found = []
    monkeypatch.setattr(Estimator, "measure_clearance", lambda self, *reading: found.append(reading))
    return found


def test_measured_clearances_of_a_log_calibrate_are_recorded_and_can_be_read_again(response, tmp_path, clearances):
    def replayed_clearances(path, recording):
        log = read_input_log(path)
        profile = judge(log, CALIBRATED.accepted_inputs, Inputs(0.0, 0.0, 0.0, 393.15))
        with McapSink(recording, CALIBRATED, profile.start_ns) as sink:
            replay(CALIBRATED, profile, sink, model=model, given={"estimation": response})
        return [(profile.start_ns + round(1e9 * time), *reading) for time, *reading in profile.measured_clearance]

    log = write(tmp_path / "log.mcap", course(2.0, cage=True))
    sent = [message for message in course(2.0, cage=True) if message.channel == topics.MEASURED_CLEARANCE]
    found = replayed_clearances(log, tmp_path / "run.mcap")
    assert found == [(message.stamp_ns, *message.values) for message in sent]
    assert [reading[1:] for reading in clearances] == [message.values for message in sent]
    assert replayed_clearances(tmp_path / "run.mcap", tmp_path / "again.mcap") == found


def test_a_measured_clearance_calibrates_a_live_model_and_is_recorded(response, clearances):
    bench, sink = Bench(scene=[*ASKING, f"estimation.calibrated={FIELD}"], given={"estimation": response}), ListSink()
    bench.live.open("list", lambda start_ns: sink)
    try:
        bench.run(0.3)
        assert bench.live.offer(topics.MEASURED_CLEARANCE, (3e-5, 1e-6), None, bench.now_ns, "probe") is None
        ((time, *reading),) = clearances
        assert reading == [3e-5, 1e-6] and sink.of(MeasuredClearance) == [MeasuredClearance(time, 3e-5, 1e-6, topics.Origin(None, "probe"))]
        refused = bench.live.offer(topics.MEASURED_CLEARANCE, (30.0,), None, bench.now_ns)
        assert refused.kind == "input.too_large" and len(clearances) == 1
    finally:
        bench.live.close()


def test_what_was_learned_survives_and_says_less_the_longer_ago_it_was(calibrated, response):
    def width(seconds):
        again = LiveEstimation(CALIBRATED, response)
        again.recall(json.loads(json.dumps(calibrated[0].learned, allow_nan=False)), seconds)
        (value, low, high) = again.estimates[FIELD]
        assert value == pytest.approx(calibrated[0].estimates[FIELD][0], rel=0.05)
        return high - low

    assert width(0.0) == pytest.approx(np.ptp(calibrated[0].estimates[FIELD][1:]), rel=0.3)
    assert width(30 * 86400.0) > 1.2 * width(0.0)


def test_a_measured_oil_temperature_keeps_what_was_learned_of_other_fields(response):
    live = LiveEstimation(CALIBRATED, response)
    measured_run(live, 20, 0.025)
    before = live.estimates[FIELD]
    live.know(["shaft_speed", "oil_temperature"])
    assert live.estimates[FIELD] == pytest.approx(before, rel=0.1)


def test_learned_by_something_else_is_refused_and_nothing_is_kept_of_it(response):
    live = LiveEstimation(CALIBRATED, response)
    with pytest.raises((KeyError, TypeError, ValueError)):
        live.recall({"ranges": [[one.field, one.low, one.high, one.distribution, one.mode] for one in response.fields.ranges]})
    assert not live.is_calibrated and live.estimates == {}


def test_a_replay_of_a_measured_cage_stores_what_it_has_learned_with_the_bearing(response, tmp_path):
    state = tmp_path / "state.json"

    def run():
        keeper = StateKeeper(state, CALIBRATED, "A-17", once=True)
        result, sink = replayed(CALIBRATED, tmp_path, given={"estimation": response, "state": keeper}, measured=0.025)
        keeper.leave()
        return keeper.state, sink

    first, sink = run()
    assert {bands.topic for bands in sink.bands} == {BANDS, ESTIMATES}
    assert first.learned["estimation"]["updates"] > 0 and list(first.estimates[0].fields) == [FIELD]
    second, _ = run()
    assert second.learned["estimation"]["updates"] == first.learned["estimation"]["updates"], "a log that was counted teaches nothing again"
    assert second.estimates == first.estimates, "an hour has one entry"


def test_a_state_of_the_version_before_has_no_estimates_and_everything_else(tmp_path):
    state = new_state(CALIBRATED, "A-17", START)
    state.note_estimates(START, {FIELD: (0.03, 0.02, 0.04)})
    old = {name: value for name, value in state.as_mapping().items() if name != "estimates"}
    again = StoredState.from_mapping(migrated(1, json.loads(json.dumps(old))))
    assert again.estimates == [] and again.serial == "A-17" and again.identity == state.identity
    assert StoredState.from_mapping(json.loads(json.dumps(state.as_mapping()))).estimates == state.estimates


@pytest.mark.parametrize("fields", [{FIELD: [0.03, 0.02]}, {FIELD: [0.03, 0.02, "nan"]}, {FIELD: "abc"}, [FIELD]])
def test_a_history_of_estimates_that_is_none_is_damage(fields):
    mapping = json.loads(json.dumps(new_state(CALIBRATED, "A-17", START).as_mapping()))
    with pytest.raises(Damaged):
        StoredState.from_mapping({**mapping, "estimates": [[START, fields]]})


def test_a_history_of_estimates_stays_short_over_years_and_reaches_back_to_the_first():
    state, hour = new_state(CALIBRATED, "A-17", START), 3_600_000_000_000
    for k in range(5000):
        state.note_estimates(START + k * hour // 2, {FIELD: (0.03, 0.02, 0.04)})
    times = np.array([past.time_ns for past in state.estimates])
    assert 200 <= len(times) <= 400 and times[0] == START and times[-1] > START + 2400 * hour and np.diff(times).min() >= hour
