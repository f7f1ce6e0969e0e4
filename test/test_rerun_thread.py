# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One view on its thread: it never holds up whoever writes, and says what it missed."""

import threading

import numpy as np
import pytest
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level
from bearing_sim.scene.loader import load_scene
from bearing_sim.view import worker as rerun_thread
from bearing_sim.view.worker import RerunFile, ViewThread

SCENE = load_scene("deng2017_table1")
TIMES = 0.001 * np.arange(1, 101)
LONG = 0.001 * np.arange(1, 401)


class StuckView:
    """A view whose viewer has stopped reading."""

    def __init__(self, *_, **__):
        self.blocked, self.release = threading.Event(), threading.Event()
        self.rows, self.events, self.dropped, self.closed = 0, 0, [], False
        StuckView.newest = self

    def write(self, record):
        self.blocked.set()
        assert self.release.wait(60)
        self.events += isinstance(record, Event)
        self.rows += len(record) * isinstance(record, np.ndarray)

    def write_dropped(self, dropped):
        self.dropped.append(dropped)

    def flush(self):
        pass

    def close(self):
        self.closed = True


@pytest.fixture
def stuck(monkeypatch, tmp_path):
    monkeypatch.setattr(rerun_thread, "RunView", StuckView)
    monkeypatch.setattr(rerun_thread, "_FLUSH_EVERY", 0.0)
    return tmp_path / "run.rrd"


def test_stuck_viewer_never_blocks_the_producer_and_what_is_dropped_is_counted(stuck):
    sink = ViewThread(SCENE, stuck, None)
    blocks = [synthetic_block(SCENE, LONG)] * 200
    sink.write(blocks[0])
    assert StuckView.newest.blocked.wait(60)
    for block in blocks[1:]:  # were this to block, nothing would ever release the view
        sink.write(block)
    sink.write(Event(0.0, Level.OK, "a", "", "b"))
    assert 0 < sink.dropped < 200
    queued_rows = sum(map(len, blocks)) - 400 * sink.dropped
    assert queued_rows <= 20_000 + 2 * 400, "the queue is bounded by rows"
    StuckView.newest.release.set()
    assert sink.close(timeout=60)
    taken = StuckView.newest.rows // 400 + StuckView.newest.events
    assert taken + sink.dropped == 201
    assert StuckView.newest.dropped[-1] == sink.dropped, "the view was told"


def test_close_gives_up_on_a_stuck_viewer(stuck):
    sink = ViewThread(SCENE, stuck, None)
    sink.write(synthetic_block(SCENE, LONG))
    assert StuckView.newest.blocked.wait(60)
    assert sink.close(timeout=0.05) is False
    StuckView.newest.release.set()


def test_lossless_sink_makes_the_producer_wait_and_drops_nothing(stuck):
    sink = RerunFile(SCENE, stuck)
    block = synthetic_block(SCENE, LONG)
    producer = threading.Thread(target=lambda: [sink.write(block) for _ in range(200)])
    producer.start()
    assert StuckView.newest.blocked.wait(60)
    producer.join(0.3)
    assert producer.is_alive(), "200 blocks do not fit into the queue"
    StuckView.newest.release.set()
    producer.join(60)
    assert sink.close(timeout=60)
    assert (StuckView.newest.rows, sink.dropped) == (200 * 400, 0)


class BrokenView(StuckView):
    def write(self, block):
        raise RuntimeError("disk full")


def test_failing_viewer_is_told_and_the_run_goes_on(monkeypatch, tmp_path):
    monkeypatch.setattr(rerun_thread, "RunView", BrokenView)
    sink = ViewThread(SCENE, tmp_path / "run.rrd", None)
    sink.write(synthetic_block(SCENE, TIMES))
    sink.close(timeout=60)
    assert "disk full" in sink.failure
    lossless = RerunFile(SCENE, tmp_path / "run.rrd")
    with pytest.raises(OSError, match="disk full"):
        for _ in range(1000):
            lossless.write(synthetic_block(SCENE, TIMES[:2]))
    lossless.close(timeout=60)
