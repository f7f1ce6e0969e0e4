# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rerun sink: what it writes, and that it never holds up the run."""

import math
import os
import signal
import socket
import threading

import numpy as np
import psutil
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from support import wait_for
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level
from bearing_sim.scene.loader import load_scene
from bearing_sim.view.plots import RunSeries, log10_hours, series
from bearing_sim.view.run_view import FileFrames, LiveFrames
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import is_complete
from bearing_sim.view.worker import RerunFile

SCENE = load_scene("deng2017_table1")
TIMES = 0.001 * np.arange(1, 101)
LONG = 0.001 * np.arange(1, 401)


pytestmark = pytest.mark.usefixtures("strict_rerun")


def written(path, block, events=(), **options):
    with RerunFile(SCENE, path, **options) as sink:
        for event in events:
            sink.write(event)
        for part in np.array_split(block, 9):
            sink.write(part)
    assert sink.failure is None
    return sink


def column(path, entity, component):
    """Return times [s] and values of one component, in the order of time."""
    times, values = [], []
    for chunk in RrdReader(str(path)).stream():
        if chunk.entity_path != entity or chunk.is_static:
            continue
        table = chunk.to_record_batch()
        if component in table.schema.names:
            times += [time.total_seconds() for time in table.column("sim_time").to_pylist()]
            values += table.column(component).to_pylist()
    order = np.argsort(times, kind="stable")
    return np.array(times)[order], [values[place] for place in order]


def test_series_in_the_file_are_the_samples_in_readers_units(tmp_path):
    block = synthetic_block(SCENE, TIMES)
    written(tmp_path / "run.rrd", block)
    expected = {
        "/speed/shaft": block["shaft_speed"] * 60 / (2 * math.pi),
        "/speed/cage": block["cage_speed"] * 60 / (2 * math.pi),
        "/speed/ideal_cage": block["ideal_cage_speed"] * 60 / (2 * math.pi),
        "/slip/cage": block["cage_slip"] * 100,
        "/life/hours": block["rating_life"],
        "/life/log10_hours": np.log10(block["rating_life"]),
        "/damage/ppm": block["damage"] * 1e6,
        "/load/radial": np.full(len(block), 800.0),
        "/oil/temperature": block["oil_temperature"] - 273.15,
    }
    for path, values in expected.items():
        times, read = column(tmp_path / "run.rrd", path, "Scalars:scalars")
        np.testing.assert_allclose(times, block["time"], atol=1e-6, err_msg=path)
        np.testing.assert_allclose(np.concatenate(read), values, rtol=1e-6, err_msg=path)
    for ring in ("inner", "outer"):
        _, read = column(tmp_path / "run.rrd", f"/loads/each/{ring}", "Scalars:scalars")
        np.testing.assert_allclose(np.array(read), block[f"{ring}_load"], rtol=1e-6)


def test_everything_that_moves_lies_on_the_simulated_time_alone(tmp_path):
    written(tmp_path / "run.rrd", synthetic_block(SCENE, TIMES), [Event(0.1, Level.WARN, "a", "", "text")])
    lines = {name for chunk in RrdReader(str(tmp_path / "run.rrd")).stream() if not chunk.is_static for name in chunk.timeline_names}
    assert lines == {"sim_time"}


def test_slip_at_rest_and_endless_life_are_gaps_not_numbers(tmp_path):
    block = synthetic_block(SCENE, TIMES)
    block["cage_slip"][:20] = np.nan
    block["rating_life"][:20] = np.inf
    written(tmp_path / "run.rrd", block)
    for path in ("/slip/cage", "/life/hours", "/life/log10_hours"):
        values = np.concatenate(column(tmp_path / "run.rrd", path, "Scalars:scalars")[1])
        assert np.isnan(values[:20]).all() and np.isfinite(values[20:]).all(), path
    assert np.isnan(log10_hours(np.array([0.0, np.inf, np.nan, 1e30]))).all()


def test_slip_of_a_shaft_that_hardly_turns_does_not_choose_the_axis():
    series = RunSeries(rr.RecordingStream("test"), SCENE)
    block = synthetic_block(SCENE, TIMES, speeds=(1.0, 4000.0), slips=(0.0, 0.06))
    block["cage_slip"][:5] = -30.0
    series.write(block)
    assert series.ranges()["/slip/cage"] == pytest.approx((0.0, 6.0), abs=0.2)
    assert series.ranges()["/load/radial"] == (800.0, 800.0)


def test_near_rest_there_is_no_slip_and_the_largest_load_is_that_since_the_sample_before():
    block = synthetic_block(SCENE, TIMES, speeds=(10.0, 4000.0))
    block["inner_load_maximum"], block["outer_load_maximum"] = 5000.0, np.nan  # an earlier version recorded none
    block["cage_slip"][0] = -1e9
    found = series(load_scene("deng2017_table1", ["thresholds.slip_from_speed=20 rad/s"]), block)
    assert math.isnan(found["/slip/cage"][0]) and np.isfinite(found["/slip/cage"][block["shaft_speed"] >= 20.0]).all()
    np.testing.assert_allclose(found["/loads/inner_largest"], 5000.0)
    np.testing.assert_allclose(found["/loads/outer_largest"], block["outer_load"].max(axis=1))


def test_threshold_lines_stand_at_the_scenes_thresholds(tmp_path):
    written(tmp_path / "run.rrd", synthetic_block(SCENE, TIMES))
    for path, value in (("/slip/warning", 5.0), ("/slip/error", 10.0), ("/life/warning", math.log10(300))):
        values = np.concatenate(column(tmp_path / "run.rrd", path, "Scalars:scalars")[1])
        np.testing.assert_allclose(values, value, rtol=1e-6)


def test_regime_lane_changes_where_slip_crosses_the_thresholds(tmp_path):
    block = synthetic_block(SCENE, TIMES, slips=(0.0, 0.2))
    written(tmp_path / "run.rrd", block)
    times, states = column(tmp_path / "run.rrd", "/regime", "StateChange:state")
    assert [state for (state,) in states] == ["rolling", "slipping", "skidding"]
    crossings = [block["time"][0], *(block["time"][np.argmax(block["cage_slip"] >= limit)] for limit in (0.05, 0.10))]
    np.testing.assert_allclose(times, crossings, atol=1e-6)


def test_events_reach_the_log_with_time_level_and_text(tmp_path):
    events = [Event(0.05, Level.WARN, "input.stale", "shaft_speed", "none for 1 s"), Event(0.08, Level.ERROR, "bearing.slip", "cage slip", "12 %")]
    written(tmp_path / "run.rrd", synthetic_block(SCENE, TIMES), events)
    times, texts = column(tmp_path / "run.rrd", "/log", "TextLog:text")
    levels = column(tmp_path / "run.rrd", "/log", "TextLog:level")[1]
    logged = {text: (round(time, 6), level) for time, (text,), (level,) in zip(times, texts, levels)}
    assert logged["shaft_speed: none for 1 s  [input.stale]"] == (0.05, "WARN")
    assert logged["cage slip: 12 %  [bearing.slip]"] == (0.08, "ERROR")


def test_dropped_blocks_show_in_the_view(tmp_path):
    from bearing_sim.view.run_view import RunView

    view = RunView(SCENE, path=tmp_path / "run.rrd")
    view.write(synthetic_block(SCENE, TIMES))
    view.write_dropped(7)
    view.close()
    texts = [text for (text,) in column(tmp_path / "run.rrd", "/log", "TextLog:text")[1]]
    assert any("dropped 7 blocks" in text for text in texts)
    assert column(tmp_path / "run.rrd", "/sink/dropped", "Scalars:scalars")[1] == [[7.0]]
    assert "7 blocks dropped" in column(tmp_path / "run.rrd", "/now", "TextDocument:text")[1][-1][0]


def test_taken_port_is_told_at_once():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(OSError, match=f"port {port} on 127.0.0.1"):
            RerunSink(SCENE, serve_port=port)


def test_server_listens_on_the_loopback_only():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with RerunSink(SCENE, serve_port=port) as sink:
        sink.write(synthetic_block(SCENE, TIMES))
        assert sink.wait_until_ready()
        assert _listening_address(port) == {"127.0.0.1"}


def _listening_address(port):
    for _ in range(200):
        processes = [psutil.Process(), *psutil.Process().children()]
        found = {c.laddr.ip for process in processes for c in process.net_connections() if c.status == psutil.CONN_LISTEN and c.laddr.port == port}
        if found:
            return found
        threading.Event().wait(0.05)
    return set()


def test_a_file_whose_process_is_too_slow_for_the_end_of_the_run_is_left_to_it_and_completed(tmp_path):
    path, block = tmp_path / "run.rrd", synthetic_block(SCENE, TIMES)
    sink = RerunSink(SCENE, path)
    assert sink.wait_until_ready()
    os.kill(sink.pid, signal.SIGSTOP)  # a machine that is too busy for it
    try:
        sink.write(block)
        assert not sink.close(timeout=0.2)
    finally:
        os.kill(sink.pid, signal.SIGCONT)
    wait_for(lambda: is_complete(path))
    np.testing.assert_allclose(column(path, "/slip/cage", "Scalars:scalars")[0], block["time"], atol=1e-6)


def test_a_sink_without_file_and_port_is_refused():
    with pytest.raises(ValueError):
        RerunSink(SCENE)


def test_file_that_cannot_be_written_is_told_at_once(tmp_path):
    for kind in (RerunSink, RerunFile):
        with pytest.raises(OSError):
            kind(SCENE, tmp_path / "absent" / "run.rrd")


def test_pictures_of_a_long_file_stay_few_and_even():
    times = 0.1 * np.arange(46_800)
    frames = FileFrames(duration=4680.0)
    picked = np.array(frames.pick(times))
    assert 1000 < len(picked) <= 1600
    assert np.ptp(np.diff(times[picked])) < 0.11


def test_pictures_of_a_file_of_unknown_length_thin_out():
    frames = FileFrames(duration=None)
    drawn = sum(len(frames.pick(part)) for part in np.array_split(1e-3 * np.arange(1_000_000), 1000))
    assert 1500 < drawn < 750 * 14


def test_pictures_of_a_file_written_in_real_time_are_no_closer_than_told():
    frames = FileFrames(duration=None, shortest=1 / 15)
    drawn = [len(frames.pick(part)) for part in np.array_split(1e-3 * np.arange(20_000), 20)]
    assert max(drawn) <= 16


def test_live_pictures_are_bounded_by_wall_time_and_show_the_newest():
    now = [0.0]
    frames = LiveFrames(rate=30.0, clock=lambda: now[0])
    drawn = []
    for step in range(1000):
        now[0] = step * 1e-3
        drawn += frames.pick(np.array([step, step + 0.5]))
    assert set(drawn) == {1}
    assert 28 <= len(drawn) <= 31
