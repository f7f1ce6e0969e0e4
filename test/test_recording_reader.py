# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Reading our recordings back: what was recorded, and what follows from it."""

import numpy as np
import pytest
from recordings import steady_log, truncated
from synthetic_run import synthetic_block

from bearing_sim.messages.cdr import typestore
from bearing_sim.messages.events import Event, Level, ReceivedInputs, Report
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.reader import ROWS_PER_BLOCK, Recording, _Samples
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1")
START_NS = 1_700_000_000_000_000_000
TIMES = 0.01 * np.arange(1, 1301)


@pytest.fixture(scope="module")
def block():
    block = synthetic_block(SCENE, TIMES)
    block["load_y"], block["load_z"] = 800.0 * np.cos(TIMES), 800.0 * np.sin(TIMES)
    block["rating_life"][:3], block["cage_slip"][:3] = np.inf, np.nan
    return block


@pytest.fixture(scope="module")
def path(block, tmp_path_factory):
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    with McapSink(path, SCENE, START_NS) as sink:
        for sample in block:
            inputs = Inputs(sample["shaft_speed"], sample["load_y"], sample["load_z"], sample["oil_temperature"])
            sink.write(ReceivedInputs(float(sample["time"]), inputs))
            sink.write(sample.reshape(1))
    return path


def blocks(recording):
    return [item for item in recording if isinstance(item, np.ndarray)]


def test_recorded_observables_come_back_as_they_were(path, block):
    recording = Recording(path)
    read = np.concatenate(blocks(recording))
    assert recording.scene == SCENE and recording.start_ns == START_NS and recording.unfinished == ""
    assert recording.samples == len(block) == len(read)
    assert (recording.first_time, recording.last_time) == pytest.approx((0.01, 13.0))
    assert recording.largest_load == max(block["inner_load"].max(), block["outer_load"].max())
    np.testing.assert_allclose(read["time"], block["time"], atol=1e-6)
    names = ["shaft_angle", "shaft_speed", "cage_angle", "cage_speed", "ideal_cage_angle", "ideal_cage_speed", "cage_slip", "rating_life", "damage"]
    for name in [*names, "load_y", "load_z", "oil_temperature", "inner_load", "outer_load"]:
        np.testing.assert_allclose(read[name], block[name], rtol=1e-12, atol=1e-12, err_msg=name)


def test_blocks_are_no_longer_than_promised(path, block):
    assert [len(part) for part in blocks(Recording(path))] == [ROWS_PER_BLOCK, len(block) - ROWS_PER_BLOCK]


@pytest.mark.parametrize("level", ["slip", "planar", "spatial"])
def test_what_a_level_observes_comes_back_from_its_recording(level, tmp_path):
    from bearing_sim.simulation import Simulation

    simulation = Simulation(load_scene("deng2017_table1", [f"level={level}"]))
    block = simulation.advance(0.006, samples=ROWS_PER_BLOCK + 200)
    with McapSink(tmp_path / "run.mcap", simulation.scene, START_NS) as sink:
        sink.write(ReceivedInputs(0.0, simulation.inputs))
        sink.write(block)
    read = np.concatenate(blocks(Recording(tmp_path / "run.mcap")))
    for name in block.dtype.names:
        np.testing.assert_allclose(
            read[name], block[name], rtol=0.0, atol=1e-9 if name == "time" else 0.0, err_msg=name
        )  # stamps are whole nanoseconds


def test_recording_cut_short_is_shown_up_to_the_cut_and_says_so(path, tmp_path):
    recording = Recording(truncated(path, tmp_path / "run.mcap.active", path.stat().st_size // 2), allow_partial=True)
    read = np.concatenate(blocks(recording))
    assert "ends early" in recording.unfinished
    assert 300 < recording.samples < 1000 and len(read) == recording.samples
    assert np.isfinite(read["shaft_speed"][:-1]).all()


def test_lasting_trouble_is_told_once_and_again_only_after_it_was_gone(tmp_path):
    slip, stale = Event(0.0, Level.ERROR, "bearing.slip", "cage slip", "12 %"), Event(0.0, Level.WARN, "input.stale", "radial_load", "none for 1 s")
    with McapSink(tmp_path / "run.mcap", SCENE, START_NS) as sink:
        sink.write(synthetic_block(SCENE, TIMES[:1]))
        for second in range(20):
            lasting = [slip] if second < 5 or second > 10 else []
            sink.write(Report(float(second), lasting, {"cage slip [%]": 12.0}))
            if second == 3:
                sink.write(stale._replace(time=3.5))
    read = [event for event in Recording(tmp_path / "run.mcap") if isinstance(event, Event)]
    assert read[1] == stale._replace(time=3.5), "every field comes back"
    assert [(event.time, event.level, event.kind, event.text) for event in read] == [
        (0.0, Level.ERROR, "bearing.slip", "cage slip: 12 %"),
        (3.5, Level.WARN, "input.stale", "radial_load: none for 1 s"),
        (11.0, Level.ERROR, "bearing.slip", "cage slip: 12 %"),
    ]


def test_trouble_that_comes_back_after_its_end_was_told_is_news(tmp_path):
    course = [(0.0, Level.WARN), (0.1, Level.OK), (0.2, Level.WARN), (0.3, Level.WARN), (0.4, Level.ERROR)]
    with McapSink(tmp_path / "run.mcap", SCENE, START_NS) as sink:
        sink.write(synthetic_block(SCENE, TIMES[:1]))
        for time, level in course:
            sink.write(Event(time, level, "bearing.slip", "", "text"))
    told = [event.level for event in Recording(tmp_path / "run.mcap") if isinstance(event, Event)]
    assert told == [Level.WARN, Level.OK, Level.WARN, Level.ERROR]


def test_log_of_inputs_is_no_recording_of_a_run(tmp_path):
    with pytest.raises(RecordingError, match="no metadata record 'bearing_sim'.*/shaft_speed"):
        Recording(steady_log(tmp_path / "log.mcap"))


def test_recording_without_samples_is_refused(tmp_path):
    with McapSink(tmp_path / "run.mcap", SCENE, START_NS) as sink:
        sink.write(ReceivedInputs(0.0, Inputs(1.0, 2.0, 3.0, 300.0)))
    with pytest.raises(RecordingError, match="no samples"):
        Recording(tmp_path / "run.mcap")


@pytest.mark.parametrize("content", [b"", b"not an MCAP file at all", b"\x89MCAP0\r\n"])
def test_other_files_are_refused(tmp_path, content):
    (tmp_path / "run.mcap").write_bytes(content)
    with pytest.raises(RecordingError):
        Recording(tmp_path / "run.mcap")
    with pytest.raises(RecordingError, match="no such file"):
        Recording(tmp_path / "absent.mcap")


def _array_message(label, numbers):
    store = typestore()
    dimension = store.types["std_msgs/msg/MultiArrayDimension"](label=label, size=len(numbers), stride=len(numbers))
    layout = store.types["std_msgs/msg/MultiArrayLayout"](dim=[dimension], data_offset=0)
    array = store.types["std_msgs/msg/Float64MultiArray"](layout=layout, data=np.array(numbers, float))
    return bytes(store.serialize_cdr(array, "std_msgs/msg/Float64MultiArray"))


def test_arrays_of_earlier_versions_lack_their_last_rows_and_others_are_refused():
    def read(label, numbers):
        samples = _Samples(load_scene("deng2017_table1"), 0)
        for topic, data in (("/operating_point", _array_message(label, numbers)), ("/roller_loads", _array_message("ring", np.ones(36)))):
            assert not list(samples.blocks_with(topic, Message(1, 0, 10, 10, data)))
        return samples.pop_block()[0]

    found = read("load y, z, oil temperature, land eccentricity", [1.0, 2.0, 300.0, 0.5])
    assert [found[name] for name in ("load_y", "load_z", "oil_temperature", "land_eccentricity")] == [1.0, 2.0, 300.0, 0.5]
    assert np.isnan(found["flange_load"]) and np.isnan(found["inner_flange_force"])
    assert np.isnan(found["inner_load_maximum"]) and np.isnan(found["outer_load_maximum"])
    before_maxima = "load y, z, oil temperature, land eccentricity, inner and outer flange force, flange load"
    found = read(before_maxima, np.arange(7.0))
    assert found["flange_load"] == 6.0 and np.isnan(found["inner_load_maximum"]) and np.isnan(found["outer_load_maximum"])
    for label, numbers in (("temperature, load", [1.0, 2.0, 300.0, 0.5]), ("load y", np.ones(11))):
        with pytest.raises(RecordingError, match="/operating_point has"):
            read(label, numbers)
