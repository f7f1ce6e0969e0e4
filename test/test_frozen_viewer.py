# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Real viewers that come late, leave, freeze or die, and what feeds them being killed: the run waits for none of them."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
from rerun.chunk import RrdReader
from synthetic_run import synthetic_block

from bearing_sim.scene.loader import load_scene
from bearing_sim.view import worker
from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN, HeadlessViewer, ViewerFailed
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import free_port

SCENE = load_scene("deng2017_table1")
BLOCK = synthetic_block(SCENE, 1e-3 * np.arange(1, 201))


def feed(sink, blocks, start=0.0, pause=0.0):
    """Write blocks of 0.2 s one after the other; return the longest that a call took [s of this thread's processor] and the end."""
    longest = 0.0
    for k in range(blocks):
        block = BLOCK.copy()
        block["time"] += start + 0.2 * k
        began = time.thread_time()
        sink.write(block)
        longest = max(longest, time.thread_time() - began)
        time.sleep(pause)
    return longest, start + 0.2 * blocks


def viewer_of(port):
    return HeadlessViewer(f"rerun+http://127.0.0.1:{port}/proxy", size=(800, 600))


def shown_rows(path):
    return sum(
        chunk.to_record_batch().num_rows for chunk in RrdReader(str(path)).stream() if chunk.entity_path == "/slip/cage" and not chunk.is_static
    )


@pytest.mark.long
def test_a_frozen_viewer_holds_up_neither_run_nor_file_nor_close(tmp_path):
    port = free_port()
    sink = RerunSink(SCENE, path=tmp_path / "run.rrd", serve_port=port)
    assert sink.wait_until_ready()
    feed(sink, 5, pause=0.01)
    try:
        with viewer_of(port) as viewer:
            os.kill(viewer.pid, signal.SIGSTOP)
            try:
                feed(sink, 60, start=1.0, pause=0.02)
                began = time.monotonic()
                finished = sink.close()
                took = time.monotonic() - began
            finally:
                os.kill(viewer.pid, signal.SIGCONT)
    except ViewerFailed as fault:
        sink.close()
        if HOW_TO_GET_VULKAN not in str(fault):
            raise
        pytest.skip(f"needs a Vulkan driver: {fault}")
    assert took < 15.0, "five seconds are allowed; a busy machine may take longer"
    assert sink.failure is None and sink.dropped == 0
    assert shown_rows(tmp_path / "run.rrd") == 65 * 200, f"the file is complete (finished: {finished})"


@pytest.mark.long
def test_a_viewer_that_dies_is_nobody_elses_trouble_and_the_next_one_finds_everything():
    port = free_port()
    with RerunSink(SCENE, serve_port=port) as sink:
        assert sink.wait_until_ready()
        feed(sink, 5)
        try:
            with viewer_of(port) as viewer:
                os.kill(viewer.pid, signal.SIGKILL)
            feed(sink, 5, start=1.0)
            with viewer_of(port) as viewer:
                end = time.monotonic() + 30
                while viewer.span() != pytest.approx((1e-3, 2.0)) and time.monotonic() < end:
                    time.sleep(0.1)
                assert viewer.span() == pytest.approx((1e-3, 2.0))
        except ViewerFailed as fault:
            if HOW_TO_GET_VULKAN not in str(fault):
                raise
            pytest.skip(f"needs a Vulkan driver: {fault}")
        assert sink.failure is None and sink.dropped == 0


@pytest.mark.long
def test_a_frozen_process_of_the_view_never_blocks_the_run_and_what_is_dropped_is_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(worker, "QUEUED_ROWS", 2000)
    sink = RerunSink(SCENE, path=tmp_path / "run.rrd")
    assert sink.wait_until_ready()
    feed(sink, 2)
    os.kill(sink.pid, signal.SIGSTOP)
    try:
        longest, end = feed(sink, 200, start=0.4)  # were this to block, nothing would ever release it
        assert sink.dropped > 100 and longest < 0.5
    finally:
        os.kill(sink.pid, signal.SIGCONT)
    time.sleep(1.0)
    dropped = sink.dropped
    feed(sink, 1, start=end)
    assert sink.close(timeout=60)
    assert sink.dropped == dropped
    assert shown_rows(tmp_path / "run.rrd") == (203 - dropped) * 200
    logged = [
        chunk.to_record_batch().column("TextLog:text").to_pylist()
        for chunk in RrdReader(str(tmp_path / "run.rrd")).stream()
        if chunk.entity_path == "/log"
    ]
    assert any(f"dropped {dropped} blocks" in text for texts in logged for (text,) in texts), "the view says so"


def test_close_ends_a_frozen_process_that_only_serves_a_view():
    """One that writes a file is left to complete it, see `test_rerun_sink`."""
    sink = RerunSink(SCENE, serve_port=free_port())
    os.kill(sink.pid, signal.SIGSTOP)  # serving or not yet: on a busy machine idle time may be long in coming
    feed(sink, 2)
    assert sink.close(timeout=0.5) is False
    assert not os.path.exists(f"/proc/{sink.pid}")


@pytest.mark.long
def test_a_killed_process_of_the_view_is_told_and_the_run_goes_on(tmp_path):
    sink = RerunSink(SCENE, path=tmp_path / "run.rrd")
    assert sink.wait_until_ready()
    os.kill(sink.pid, signal.SIGKILL)
    end = time.monotonic() + 30
    while sink.failure is None and time.monotonic() < end:
        feed(sink, 1)
        time.sleep(0.02)
    assert "exited unexpectedly (code -9)" in sink.failure
    feed(sink, 3)
    assert sink.dropped >= 3 and sink.close() is False


@pytest.mark.long
def test_the_file_of_a_run_that_is_killed_is_finished_all_the_same(tmp_path):
    path = tmp_path / "run.rrd"
    script = f"""
        import os, signal, sys, time
        sys.path.insert(0, {str(os.path.dirname(__file__))!r})
        from test_frozen_viewer import RerunSink, SCENE, feed
        sink = RerunSink(SCENE, path={str(path)!r})
        sink.wait_until_ready()
        feed(sink, 5, pause=0.1)
        while sink._queue.qsize():  # what is still queued here dies with this process
            time.sleep(0.05)
        time.sleep(1.0)  # on its way into the pipe
        print(sink.pid, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=120)
    view = int(run.stdout)
    end = time.monotonic() + 30
    while os.path.exists(f"/proc/{view}") and time.monotonic() < end:
        time.sleep(0.1)
    assert run.returncode == -signal.SIGKILL and not os.path.exists(f"/proc/{view}"), "nothing is left behind"
    assert shown_rows(path) == 1000
    rerun = [sys.executable, "-m", "rerun", "rrd", "verify", str(path)]
    assert subprocess.run(rerun, capture_output=True, timeout=120).returncode == 0, "with its footer"
