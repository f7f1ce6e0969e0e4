# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What happens to the files of a recording: limits, bags, and everything that can go wrong with a disk."""

import os
import shutil
import subprocess
import time
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level, ReceivedInputs
from bearing_sim.recording import bag
from bearing_sim.recording.bag import Limits, mcap_files
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents
from bearing_sim.recording.writer import METADATA, McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE = load_scene("deng2017_table1")
START = 1_700_000_000_000_000_000
INPUTS = Inputs(4000.0, 800.0, -50.0, 393.15)
RUN = synthetic_block(SCENE, 0.001 * np.arange(1, 4001))
NOISE = np.random.default_rng(3)
RUN["inner_load"] *= 1 + 1e-3 * NOISE.normal(size=RUN["inner_load"].shape)  # does not compress away


def write(sink, first=0, last=4000, step=50):
    for start in range(first, last, step):
        sink.write(ReceivedInputs(float(RUN["time"][start]), INPUTS))
        sink.write(RUN[start : start + step])


def samples(path):
    return np.concatenate([item for item in Recording(path) if isinstance(item, np.ndarray)])


def wait_for(condition, seconds=30.0):
    limit = time.monotonic() + seconds
    while not condition() and time.monotonic() < limit:
        time.sleep(0.01)
    assert condition()


def test_a_bag_is_a_folder_that_rosbags_opens_and_whose_parts_can_be_read_alone(tmp_path):
    with McapSink(tmp_path / "run", SCENE, START, limits=Limits(part_size=400e3)) as sink:
        write(sink)
    names = sorted(file.name for file in (tmp_path / "run").iterdir())
    parts = [name for name in names if name != "metadata.yaml"]
    assert len(parts) > 2 and parts == [f"run_{k}.mcap" for k in range(len(parts))] and "metadata.yaml" in names
    store = get_typestore(Stores.ROS2_JAZZY)
    loads = []
    with Reader(tmp_path / "run") as bag:
        for connection, _, data in bag.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            loads += [message.data[:18]] if connection.topic == "/roller_loads" else []
    np.testing.assert_array_equal(loads, RUN["inner_load"])
    np.testing.assert_array_equal(samples(tmp_path / "run")["roller_angle"], RUN["roller_angle"])
    alone = [samples(tmp_path / "run" / name) for name in parts]
    np.testing.assert_array_equal(np.concatenate(alone)["outer_load"], RUN["outer_load"])
    assert [contents(tmp_path / "run" / name).metadata[METADATA]["part"] for name in parts] == [str(k) for k in range(len(parts))]
    assert max((tmp_path / "run" / name).stat().st_size for name in parts) < 600e3


def test_metadata_of_a_bag_is_version_9_and_counts_what_is_there(tmp_path):
    with McapSink(tmp_path / "run", SCENE, START, limits=Limits(part_duration=1.0)) as sink:
        write(sink)
    bag = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    files = [contents(tmp_path / "run" / name) for name in bag["relative_file_paths"]]
    assert bag["version"] == 9 and bag["storage_identifier"] == "mcap" and len(files) == 4
    assert bag["message_count"] == sum(file.messages.total() for file in files)
    assert [entry["message_count"] for entry in bag["files"]] == [file.messages.total() for file in files]
    together = {entry["topic_metadata"]["name"]: entry["message_count"] for entry in bag["topics_with_message_count"]}
    assert together["/roller_loads"] == len(RUN) and together["/shaft_speed"] == len(RUN) // 50
    assert bag["duration"]["nanoseconds"] == files[-1].last_ns - files[0].first_ns


def test_a_name_with_mcap_and_limits_makes_numbered_files_beside_each_other(tmp_path):
    with McapSink(tmp_path / "run.mcap", SCENE, START, limits=Limits(part_duration=2.0)) as sink:
        write(sink)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["run_0.mcap", "run_1.mcap"]
    assert sum(len(samples(file)) for file in tmp_path.iterdir()) == len(RUN)


@pytest.mark.parametrize("name", ["run_{}.mcap", "{}_run_2026_11_28-21_10_00.mcap"], ids=["up to Kilted", "since Lyrical"])
def test_parts_of_a_bag_without_metadata_are_in_the_order_of_their_numbers_however_rosbag2_names_them(name, tmp_path):
    for number in (10, 2, 0, 1):
        (tmp_path / name.format(number)).touch()
    assert [path.name for path in mcap_files(tmp_path)] == [name.format(number) for number in (0, 1, 2, 10)]


def test_a_bag_of_a_killed_run_is_read_up_to_its_unfinished_part(tmp_path):
    sink = McapSink(tmp_path / "run", SCENE, START, limits=Limits(part_duration=1.0))
    write(sink)
    sink.flush()
    wait_for(lambda: all((tmp_path / "run" / name).exists() for name in ("metadata.yaml", "run_3.mcap.active")))
    recording = Recording(tmp_path / "run")
    assert recording.samples == len(RUN) and "run_3.mcap.active ends early" in recording.unfinished
    sink.close()
    assert Recording(tmp_path / "run").unfinished == ""


def test_a_bag_is_listed_although_its_recorder_completes_a_part_meanwhile(tmp_path, monkeypatch):
    with McapSink(tmp_path / "run", SCENE, START, limits=Limits(part_duration=1.0)) as sink:
        write(sink)
    whole, listings = mcap_files(tmp_path / "run"), []

    def listed(path):
        listings.append(path)
        return [*whole[:-1], whole[-1].with_name(f"{whole[-1].name}.active")] if len(listings) == 1 else whole

    monkeypatch.setattr(bag, "_files_in", listed)
    assert mcap_files(tmp_path / "run") == whole and len(listings) == 2


def test_a_finished_recording_is_not_replaced(tmp_path):
    for name in ("run.mcap", "run"):
        with McapSink(tmp_path / name, SCENE, START) as sink:
            sink.write(RUN[:1])
        with pytest.raises(FileExistsError, match="does not replace"):
            McapSink(tmp_path / name, SCENE, START)
    sink = McapSink(tmp_path / "late.mcap", SCENE, START)
    sink.write(RUN[:1])
    (tmp_path / "late.mcap").write_text("made meanwhile")
    with pytest.raises(FileExistsError, match="made by another program"):
        sink.close()
    assert (tmp_path / "late.mcap").read_text() == "made meanwhile" and len(samples(tmp_path / "late.mcap.active")) == 1


def test_node_recordings_take_a_fresh_name(tmp_path):
    from bearing_sim.ros.recordings import fresh_path

    assert fresh_path(tmp_path / "run.mcap") == tmp_path / "run.mcap"
    for taken in ("run.mcap", "run_2.mcap.active", "run_3_0.mcap"):
        (tmp_path / taken).touch()
    assert fresh_path(tmp_path / "run.mcap") == tmp_path / "run_4.mcap"
    (tmp_path / "bag").mkdir()
    assert fresh_path(tmp_path / "bag") == tmp_path / "bag_2"


def test_a_disk_nearly_full_stops_the_recording_says_so_and_leaves_a_whole_file(tmp_path, monkeypatch):
    sink = McapSink(tmp_path / "run.mcap", SCENE, START, flush_every=0.02, limits=Limits(keep_free=50e6))
    write(sink, last=1000)
    sink.flush()
    monkeypatch.setattr("shutil.disk_usage", lambda path: SimpleNamespace(free=49e6))
    with pytest.raises(OSError, match="49 MB are free .* less than the 50 MB to be kept"):
        for _ in range(3000):
            time.sleep(0.01)
            sink.write(RUN[1000:1050])
    sink.close()
    file = contents(tmp_path / "run.mcap")
    assert file.is_sound and file.messages["/roller_loads"] >= 1000


def test_a_recording_does_not_begin_on_a_disk_nearly_full(tmp_path):
    with pytest.raises(OSError, match="are free on the disk"):
        McapSink(tmp_path / "run.mcap", SCENE, START, limits=Limits(keep_free=1e18))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_and_nothing_written_is_lost(small_disk):
    sink = McapSink(small_disk / "run.mcap", SCENE, START, flush_every=0.02, limits=Limits(keep_free=0.0))
    with pytest.raises(OSError, match="No space left on device"):
        for _ in range(3000):
            write(sink, last=200)
            time.sleep(0.01)
    sink.close()
    found = contents(small_disk / "run.mcap")
    assert (small_disk / "run.mcap").stat().st_size > 600e3 and found.is_sound and found.messages["/roller_loads"] > 500
    assert len(samples(small_disk / "run.mcap")) == found.messages["/roller_loads"] and len(list(small_disk.iterdir())) == 1


def test_on_a_full_disk_a_recording_is_completed_however_large_the_block_was_that_did_not_fit(small_disk):
    sink = McapSink(small_disk / "run.mcap", SCENE, START, flush_every=60.0, limits=Limits(keep_free=0.0))
    with pytest.raises(OSError, match="No space left on device"):
        for _ in range(10):
            sink.write(RUN[:2000])
    sink.close()
    found = contents(small_disk / "run.mcap")
    assert found.is_sound and found.messages["/roller_loads"] > 300


def test_a_disk_that_has_room_again_at_the_end_gets_the_whole_file(small_disk):
    (small_disk / "ballast").write_bytes(bytes(600_000))
    sink = McapSink(small_disk / "run.mcap", SCENE, START, flush_every=0.02, limits=Limits(keep_free=0.0))
    written = 0
    with pytest.raises(OSError, match="No space left"):
        for _ in range(3000):
            sink.write(RUN[written : written + 1])
            written += 1
            time.sleep(0.001)
    (small_disk / "ballast").unlink()
    sink.close()
    file = contents(small_disk / "run.mcap")
    assert file.is_sound and file.messages["/roller_loads"] == written


def test_a_folder_that_cannot_be_written_is_told_at_the_start(small_disk):
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    with pytest.raises(OSError, match="Read-only file system"):
        McapSink(small_disk / "run.mcap", SCENE, START, limits=Limits(keep_free=0.0))


def test_a_file_deleted_under_the_writer_is_written_anew(tmp_path):
    sink = McapSink(tmp_path / "deep" / "run.mcap", SCENE, START, flush_every=0.02)
    write(sink, last=2000)
    sink.flush()
    (tmp_path / "deep").rename(tmp_path / "gone")  # in one step: the writer restores its file within 20 ms
    shutil.rmtree(tmp_path / "gone")
    wait_for(lambda: (tmp_path / "deep" / "run.mcap.active").exists())
    write(sink, first=2000)
    sink.close()
    [(level, code, text)] = sink.news()
    assert level is Level.WARN and code == "recording.restored" and "was deleted" in text
    np.testing.assert_array_equal(samples(tmp_path / "deep" / "run.mcap")["inner_load"], RUN["inner_load"])
    assert contents(tmp_path / "deep" / "run.mcap").is_sound


def test_a_file_replaced_under_the_writer_leaves_both(tmp_path):
    sink = McapSink(tmp_path / "run.mcap", SCENE, START, flush_every=0.02)
    write(sink, last=500)
    sink.flush()
    (tmp_path / "other").write_text("another's")
    os.replace(tmp_path / "other", tmp_path / "run.mcap.active")
    news = []
    wait_for(lambda: news.extend(sink.news()) or news)
    write(sink, first=500, last=600)
    sink.close()
    assert "replaced by another file" in news[0][2]
    assert len(samples(tmp_path / "run.mcap")) == 600 and (tmp_path / "run.mcap.active").read_text() == "another's"


def test_metadata_say_what_a_result_depends_on(tmp_path):
    with McapSink(tmp_path / "run.mcap", SCENE, START, seed=42) as sink:
        sink.write(RUN[:1])
        sink.write(Event(0.1, Level.WARN, "slip.high", "", "text"))
    told = contents(tmp_path / "run.mcap").metadata[METADATA]
    assert told["seed"] == "42" and told["version_numpy"] == np.__version__
    assert {"scene", "level", "start_ns", "package_version", "git_hash", "version_python", "version_numba"} <= set(told)
