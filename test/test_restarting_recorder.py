# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A live recording outlives the process that writes it: it goes on in a fresh file, and not for ever."""

import os
import signal
import time

import numpy as np
import pytest
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Level
from bearing_sim.recording.bag import UNLIMITED
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recorder import MOST_RESTARTS, WITHIN, Recorder, RestartingRecorder
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.ros.recordings import open_recording
from bearing_sim.runtime.pacing import tick_schedule
from bearing_sim.runtime.sink_registry import SinkRegistry
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1")
START = 1_700_000_000_000_000_000
CADENCE = tick_schedule(1000.0, 50.0)
RUN = synthetic_block(SCENE, 0.001 * np.arange(1, 2001))


def samples(path):
    return np.concatenate([item for item in Recording(path) if isinstance(item, np.ndarray)])


def flushed(path):
    """Return how many samples an unfinished file has, once it has any."""
    limit = time.monotonic() + 60.0
    while not (found := contents(path).messages["/roller_loads"]) and time.monotonic() < limit:
        time.sleep(0.01)
    assert found
    return found


def killed(recorder, recording):
    """Kill the process that writes and wait until its end is known here."""
    os.kill(recorder.pid, signal.SIGKILL)
    limit = time.monotonic() + 60.0
    while not recording._current.is_orphaned and time.monotonic() < limit:
        time.sleep(0.01)
    assert recording._current.is_orphaned


@pytest.mark.long
def test_a_recording_whose_process_is_killed_goes_on_in_a_fresh_file_and_tells_what_is_lost(tmp_path):
    (tmp_path / "run_2.mcap").write_text("precious")
    with Recorder() as recorder:
        recording = open_recording(tmp_path / "run.mcap", SCENE, START, UNLIMITED, CADENCE, recorder)
        for start in range(0, 1000, 10):
            recording.write(RUN[start : start + 10])
        safe = flushed(tmp_path / "run.mcap.active")
        assert recording.news() == []
        killed(recorder, recording)
        recording.write_inputs(1.0, Inputs(4000.0, 800.0, -50.0, 393.15))
        recording.write(RUN[1000:])
        [(level, code, text)] = recording.news()
        assert recording.news() == []
        recording.close(timeout=60.0)
    assert recording.path == tmp_path / "run_3.mcap"
    assert level is Level.WARN and code == "recording.restarted"
    for part in ("run.mcap ends early", "SIGKILL", "is lost", "bearing-sim recover", "continues in", "run_3.mcap"):
        assert part in text
    assert (tmp_path / "run_2.mcap").read_text() == "precious"
    recover(tmp_path / "run.mcap.active", tmp_path / "good.mcap")
    before = samples(tmp_path / "good.mcap")
    np.testing.assert_array_equal(before["inner_load"], RUN["inner_load"][: len(before)])
    assert safe <= len(before) <= 1000
    after = Recording(tmp_path / "run_3.mcap")
    np.testing.assert_array_equal(samples(tmp_path / "run_3.mcap")["inner_load"], RUN["inner_load"][1000:])
    assert after.metadata["scene"] == Recording(tmp_path / "good.mcap").metadata["scene"] and not after.unfinished


class _Doomed:
    """A recording whose process ends, or whose disk fails, at each write."""

    start_ns, dropped = START, 2

    def __init__(self, path, is_orphaned):
        self.path, self.is_orphaned = path, is_orphaned

    def offer(self, name, arguments, size):
        raise OSError("SIGKILL" if self.is_orphaned else "No space left on device")

    def news(self):
        return []

    def close(self, timeout=0.0):
        pass


class _Dying:
    """The first write goes well, its process ends after it."""

    def __init__(self, doomed):
        self._doomed, self._writes = doomed, 0

    def __getattr__(self, name):
        return getattr(self._doomed, name)

    def offer(self, name, arguments, size):
        self._writes += 1
        if self._writes > 1:
            self._doomed.offer(name, arguments, size)


def test_a_process_that_is_killed_again_and_again_is_not_started_for_ever(tmp_path):
    begun = []

    def begin(wait):
        begun.append(wait)
        return _Dying(_Doomed(tmp_path / f"run_{len(begun)}.mcap", is_orphaned=True))

    recording = RestartingRecorder(begin)
    sinks = SinkRegistry()
    sinks.attach("record", recording)
    for _ in range(20):
        sinks.write(1.0, RUN[:1])
    assert begun == [True] + MOST_RESTARTS * [False], "only the first is waited for"
    assert "record" not in sinks
    [trouble] = sinks.events(2.0)
    assert trouble.level is Level.ERROR and "SIGKILL" in trouble.text and "no other is started" in trouble.text


def test_ends_that_lie_far_apart_are_not_counted_together(tmp_path):
    now = [0.0]
    recording = RestartingRecorder(lambda wait: _Dying(_Doomed(tmp_path / "run.mcap", is_orphaned=True)), clock=lambda: now[0])
    for _ in range(5 * MOST_RESTARTS):
        now[0] += 1.01 * WITHIN / MOST_RESTARTS
        recording.write(RUN[:1])
    assert len(recording.news()) == 5 * MOST_RESTARTS - 1
    assert recording.dropped == 2 * 5 * MOST_RESTARTS


def test_a_full_disk_is_no_reason_for_another_file(tmp_path):
    begun = []
    recording = RestartingRecorder(lambda wait: (begun.append(wait), _Doomed(tmp_path / "run.mcap", is_orphaned=False))[1])
    with pytest.raises(OSError, match="No space left"):
        recording.write(RUN[:1])
    assert len(begun) == 1


def test_a_recording_that_cannot_be_begun_is_told_at_the_start(tmp_path):
    (tmp_path / "a_file").touch()
    with Recorder() as recorder, pytest.raises(OSError, match="a_file"):
        open_recording(tmp_path / "a_file" / "run.mcap", SCENE, START, UNLIMITED, CADENCE, recorder)
