# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings by a thread of their own: what is in them, and what is lost when the process is killed, or the disk does not answer or is full."""

import errno
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, ReceivedInputs, Report, Start
from bearing_sim.messages.topics import Origin
from bearing_sim.recording import append_file
from bearing_sim.recording import recorder as recorder_module
from bearing_sim.recording.bag import Limits
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recorder import LiveRecording, Recorder
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import METADATA, McapSink
from bearing_sim.runtime.sink_registry import SinkRegistry
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1")
START = 1_700_000_000_000_000_000
RUN = synthetic_block(SCENE, 0.001 * np.arange(1, 2001))
RUN["inner_load"] *= 1 + 1e-3 * np.random.default_rng(3).normal(size=RUN["inner_load"].shape)  # does not compress away
INPUTS = Inputs(4000.0, 800.0, -50.0, 393.15)


@pytest.fixture(scope="module")
def recorder():
    with Recorder() as recorder:
        yield recorder


def write(sink, first=0, last=2000, step=50, pause=0.0):
    for start in range(first, last, step):
        sink.write(ReceivedInputs(float(RUN["time"][start]), INPUTS))
        sink.write(RUN[start : start + step])
        time.sleep(pause)


def samples(path):
    return np.concatenate([item for item in Recording(path) if isinstance(item, np.ndarray)])


def messages(path):
    """Every message of a file: topic, times and bytes, in the order of writing within its topic."""
    with open(path, "rb") as stream:
        found = [(channel.topic, m.sequence, m.log_time, m.publish_time, m.data) for _, channel, m in make_reader(stream).iter_messages()]
    return sorted(found)


def wait_for(condition, seconds=60.0):
    limit = time.monotonic() + seconds
    while not (found := condition()) and time.monotonic() < limit:
        time.sleep(0.01)
    assert found
    return found


def flushed(path):
    """Return how many samples an unfinished file has."""
    return contents(path).messages["/roller_loads"]


def test_what_the_thread_writes_is_what_a_sink_writes(recorder, tmp_path):
    for sink in (recorder.open(tmp_path / "there.mcap", SCENE, START, advance=(0.005, 5)), McapSink(tmp_path / "here.mcap", SCENE, START)):
        sink.write(Start(RUN[:1]))
        sink.write(ReceivedInputs(0.0, INPUTS, ["radial_load"], Origin(START + 5, "dyno")))
        write(sink, first=1, last=1001)
        sink.write(Measurement(0.5, 1800.0, 0.01, 0.5, Origin(START + 7, "laser")))
        sink.write(MeasuredClearance(0.5, 3e-5, 1e-6, Origin(START + 8, "probe")))
        sink.write(Event(0.6, Level.WARN, "slip.high", "", "text"))
        sink.write(Report(0.7, [Event(0.7, Level.OK, "run.running", "", "text")], {"level": "slip", "real-time factor": np.float64(1.5)}))
        sink.close()
    assert messages(tmp_path / "there.mcap") == messages(tmp_path / "here.mcap")
    there, here = (contents(tmp_path / name).metadata[METADATA] for name in ("there.mcap", "here.mcap"))
    assert there == {**here, "advance_seconds": "0.005", "advance_samples": "5"}


def test_a_slice_of_every_other_sample_is_written_as_it_is(recorder, tmp_path):
    """It does not lie in one piece of memory."""
    with recorder.open(tmp_path / "run.mcap", SCENE, START) as sink:
        sink.write(RUN[:10:2])
    np.testing.assert_array_equal(samples(tmp_path / "run.mcap")["inner_load"], RUN["inner_load"][:10:2])


def test_parts_and_a_bag_are_made_by_the_same_limits(recorder, tmp_path):
    with recorder.open(tmp_path / "run", SCENE, START, limits=Limits(part_duration=0.5)) as sink:
        write(sink)
    assert sorted(file.name for file in (tmp_path / "run").iterdir()) == ["metadata.yaml", *(f"run_{k}.mcap" for k in range(4))]
    np.testing.assert_array_equal(samples(tmp_path / "run")["outer_load"], RUN["outer_load"])


def test_a_file_that_cannot_be_made_is_told_at_the_start_and_other_recordings_go_on(recorder, tmp_path):
    (tmp_path / "a_file").touch()
    with recorder.open(tmp_path / "good.mcap", SCENE, START) as good:
        write(good, last=500)
        with pytest.raises(OSError, match="a_file"):
            recorder.open(tmp_path / "a_file" / "run.mcap", SCENE, START)
        with pytest.raises(OSError, match="are free on the disk"):
            recorder.open(tmp_path / "run.mcap", SCENE, START, limits=Limits(keep_free=1e18))
        write(good, first=500, last=1000)
    assert len(samples(tmp_path / "good.mcap")) == 1000


def test_writing_after_close_is_refused_and_closing_twice_is_not(recorder, tmp_path):
    sink = recorder.open(tmp_path / "run.mcap", SCENE, START)
    sink.close()
    sink.close()
    with pytest.raises(ValueError, match="closed"):
        sink.write(RUN[:1])


def test_a_file_deleted_under_the_recorder_is_told_and_written_anew(recorder, tmp_path):
    sink = recorder.open(tmp_path / "run.mcap", SCENE, START)
    write(sink, last=1000)
    wait_for(lambda: (tmp_path / "run.mcap.active").stat().st_size > 100e3)
    (tmp_path / "run.mcap.active").unlink()
    wait_for(lambda: (tmp_path / "run.mcap.active").exists())
    news = []

    def told():
        sink.write(Report(1.0))
        news.extend(sink.news())
        return news

    wait_for(told)
    write(sink, first=1000, last=2000)
    sink.close()
    [(level, code, text)] = news
    assert level is Level.WARN and code == "recording.restored" and "was deleted" in text
    np.testing.assert_array_equal(samples(tmp_path / "run.mcap")["inner_load"], RUN["inner_load"][:2000])


@pytest.fixture
def disk(monkeypatch):
    """A disk that answers, or not."""
    answers, write = threading.Event(), append_file._write_all
    answers.set()
    monkeypatch.setattr(append_file, "_write_all", lambda *arguments: (answers.wait(60), write(*arguments)))
    yield answers
    answers.set()


def test_a_disk_that_does_not_answer_holds_nobody_up_what_it_misses_is_counted_and_the_recording_goes_on(tmp_path, disk):
    with Recorder(capacity=1_000_000) as recorder:
        sink = recorder.open(tmp_path / "run.mcap", SCENE, START)
        write(sink, last=500, pause=0.03)
        wait_for(lambda: flushed(tmp_path / "run.mcap.active"))
        disk.clear()
        for start in range(500, 2000, 50):  # were one of them to wait, nothing would ever let the disk answer
            sink.write(RUN[start : start + 50])
        missed = sink.dropped
        [(level, code, text)] = sink.news()
        disk.set()
        sink.close(timeout=60.0)
    assert 0 < missed < 30 and level is Level.WARN and code == "recording.dropped" and str(missed) in text
    assert sink.dropped == missed and len(samples(tmp_path / "run.mcap")) == 2000 - 50 * missed


def test_closing_does_not_wait_for_ever_and_the_file_is_completed_when_the_disk_answers(tmp_path, disk):
    recorder = Recorder()
    sink = recorder.open(tmp_path / "run.mcap", SCENE, START)
    disk.clear()
    write(sink, last=1000)
    with pytest.raises(OSError, match="is not complete after.*bearing-sim recover"):
        sink.close(timeout=0.3)
    assert not recorder.close(timeout=0.3)
    disk.set()
    wait_for((tmp_path / "run.mcap").exists)
    assert recorder.close(timeout=60.0) and len(samples(tmp_path / "run.mcap")) == 1000


def test_a_record_that_cannot_be_written_ends_this_recording_as_an_error_and_leaves_a_whole_file(recorder, tmp_path):
    sinks = SinkRegistry()
    sinks.attach("record", recorder.open(tmp_path / "run.mcap", SCENE, START))
    sinks.write(0.0, RUN[:100])
    sinks.write(0.0, Event(-2.0 * START / 1e9, Level.OK, "kind", "", "before 1970"))

    def given_up():
        sinks.write(3.0, RUN[100:110])
        return "record" not in sinks

    wait_for(given_up)
    [event] = sinks.events(3.0)
    assert event.level is Level.ERROR and event.key == ("sink.failed", "record") and "before 1970" in event.text
    assert contents(tmp_path / "run.mcap").is_sound and len(samples(tmp_path / "run.mcap")) == 100


FEEDER = """
import sys, time
sys.path.insert(0, sys.argv[2])
import numpy as np
from synthetic_run import synthetic_block
from bearing_sim.scene.loader import load_scene
from bearing_sim.recording.recorder import Recorder
scene = load_scene("deng2017_table1")
run = synthetic_block(scene, 0.001 * np.arange(1, 20001))
recorder = Recorder()
sink = recorder.open(sys.argv[1], scene, 0)
for done in range(0, len(run), 10):
    sink.write(run[done : done + 10])
    print(done + 10, flush=True)
    time.sleep(0.01)
"""


@pytest.mark.long
def test_what_a_killed_process_had_flushed_is_recovered_and_no_process_is_left(tmp_path):
    command = [sys.executable, "-c", FEEDER, str(tmp_path / "run.mcap"), str(Path(__file__).parent)]
    feeder = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)
    while int(feeder.stdout.readline()) < 2000:
        pass
    safe = flushed(tmp_path / "run.mcap.active")
    assert not Path(f"/proc/{feeder.pid}/task/{feeder.pid}/children").read_text(), "one process records"
    feeder.kill()
    feeder.wait(30)
    recover(tmp_path / "run.mcap.active", tmp_path / "good.mcap")
    assert contents(tmp_path / "good.mcap").is_sound
    kept = samples(tmp_path / "good.mcap")
    np.testing.assert_allclose(kept["time"], 0.001 * np.arange(1, len(kept) + 1), atol=1e-9)
    assert 0 < safe <= len(kept)


@pytest.mark.parametrize("name", ["run.mcap", "bag"])
def test_a_full_disk_comes_back_as_an_error_and_the_recording_is_completed_in_reserved_space(recorder, small_disk, name):
    sink = recorder.open(small_disk / name, SCENE, START, limits=Limits(keep_free=0.0))

    def fill():
        for _ in range(3000):
            write(sink, last=200)
            time.sleep(0.02)

    with pytest.raises(OSError, match="No space left on device"):
        fill()
    sink.close()
    assert len(samples(small_disk / name)) > 300 and not Recording(small_disk / name).unfinished and not list(small_disk.rglob("*.active"))
    if name == "bag":
        with Reader(small_disk / name) as bag:
            assert bag.message_count > 10_000
    another = small_disk / "another"
    (small_disk / "rest").write_bytes(bytes(shutil.disk_usage(small_disk).free - 100_000))
    with pytest.raises(OSError, match="cannot be begun: No space left on device"):
        recorder.open(another, SCENE, START, limits=Limits(keep_free=0.0))
    assert not another.exists()


def test_what_could_not_be_completed_on_a_full_disk_is_completed_by_another_call(tmp_path, small_disk, monkeypatch):
    monkeypatch.delattr(os, "posix_fallocate")  # so that no space is reserved
    sink, rest = McapSink(small_disk / "bag", SCENE, START, limits=Limits(keep_free=0.0), flush_every=60.0), small_disk / "rest"
    sink.write(RUN[:100])
    rest.write_bytes(bytes(shutil.disk_usage(small_disk).free))
    with pytest.raises(OSError, match="No space left on device"):
        sink.close()
    assert not (small_disk / "bag" / "metadata.yaml").exists()
    rest.unlink()
    sink.close()
    with Reader(small_disk / "bag") as bag:
        assert bag.message_count and len(samples(small_disk / "bag")) == 100


@pytest.mark.parametrize("is_ending", [False, True])
def test_what_lacked_space_is_completed_when_there_is_some_and_for_the_last_time_at_the_end(monkeypatch, is_ending):
    monkeypatch.setattr(recorder_module, "_RETRY_EVERY", 60.0 if is_ending else 0.01)
    tries, ending = [], threading.Event()

    class Sink:
        path, start_ns = Path("run.mcap"), START

        def close(self):
            tries.append(True)
            if len(tries) < (2 if is_ending else 3):
                raise OSError(errno.ENOSPC, "No space left on device")

    recording = LiveRecording(Sink(), 1_000_000, ending)
    with pytest.raises(OSError, match="No space left"):
        recording.close()
    if is_ending:
        ending.set()
    recording.join(60.0)
    assert len(tries) == (2 if is_ending else 3) and not recording.is_working


def test_one_recorder_makes_many_recordings_and_keeps_neither_files_nor_threads(tmp_path):
    def belongings():
        return len(os.listdir("/proc/self/fd")), threading.active_count()

    with Recorder() as recorder:
        before = belongings()
        for number in range(10):
            with recorder.open(tmp_path / f"run_{number}.mcap", SCENE, START) as sink:
                write(sink, last=100)
        wait_for(lambda: all(now <= then for now, then in zip(belongings(), before)))
    assert all(len(samples(tmp_path / f"run_{number}.mcap")) == 100 for number in (0, 9))


def test_a_block_is_queued_without_a_copy():
    written = []
    sink = SimpleNamespace(path=Path("run.mcap"), start_ns=START, write=written.append, close=lambda: None)
    with LiveRecording(sink, 1_000_000, threading.Event()) as recording:
        recording.write(RUN[:10])
        assert np.shares_memory(recording._queue[0], RUN)
    np.testing.assert_array_equal(written[0], RUN[:10])
