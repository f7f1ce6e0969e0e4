# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One view on a thread of its own: a bounded queue before it, so that whoever writes never waits for rerun.

Logging to rerun may block without end once a viewer stops reading.  So the producer only puts things into a bounded
queue, and one daemon thread alone calls rerun.  When the queue is full a block is dropped and counted, and the view
says so; in lossless mode, for files only, the producer waits instead.
"""

import logging
import queue
import threading
import time as wall
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.events import Event, Measurement
from bearing_sim.scene import Scene
from bearing_sim.sinks.rerun_view import NOTHING_KNOWN, RunView, ViewOptions

QUEUED_ROWS = 20_000  # about 20 MB with 18 rollers
_FLUSH_EVERY = 0.25  # [s] of wall time between columns of a live view
_log = logging.getLogger(__name__)


class Dropped(NamedTuple):
    """Blocks dropped in all before they came here."""

    count: int


class RowQueue(queue.Queue):
    """A queue bounded by rows of samples, not by blocks: one block may be a row or a thousand."""

    def _init(self, maxsize):
        super()._init(maxsize)
        self._rows = 0

    def _qsize(self):
        return self._rows

    def _put(self, item):
        self._rows += _rows(item)
        super()._put(item)

    def _get(self):
        item = super()._get()
        self._rows -= _rows(item)
        return item


def _rows(item) -> int:
    return len(item) if isinstance(item, np.ndarray) else 1


class ViewThread:
    """Shows blocks of samples, events and measurements in one rerun file, or at one port.

    Parameters
    ----------
    scene : what runs.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None; one of both.
    options : what else the view knows.
    lossless : True makes the producer wait where blocks would be dropped; for files only, and not for real time.

    Attributes
    ----------
    dropped : blocks, events and measurements dropped so far.
    fault : why nothing is shown any more, or None.
    """

    def __init__(self, scene: Scene, path: str | Path | None, serve_port: int | None, options: ViewOptions = NOTHING_KNOWN, lossless: bool = False):
        self.dropped = 0
        self.fault: str | None = None
        self._ready = threading.Event()
        self._lossless = lossless
        self._queue = RowQueue(QUEUED_ROWS)
        self._closed = False
        self._dropped_before = 0
        self._worker = threading.Thread(target=self._work, args=(scene, path, serve_port, options), name="rerun", daemon=True)
        self._worker.start()

    def write(self, item: np.ndarray | Event | Measurement) -> None:
        """Take a block of samples, which must not be changed any more, an event or a measurement; returns at once, except in lossless mode."""
        if self._closed:
            raise ValueError("the rerun view is closed")
        if self._lossless:
            self._wait_to_put(item)
            return
        if self.fault is not None:
            self.dropped += 1
            return
        try:
            self._queue.put_nowait(item)
        except queue.Full:
            self.dropped += 1

    @property
    def ready(self) -> bool:
        """Whether the file is there, or viewers find the server."""
        return self._ready.is_set()

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait until that is so; return whether it was within ``timeout`` [s]."""
        return self._ready.wait(timeout)

    def note_dropped(self, count: int) -> None:
        """Let the view say that ``count`` blocks in all were dropped before they came here."""
        self._dropped_before = count

    def close(self, timeout: float) -> bool:
        """Show what is queued and finish; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s].  A worker that is stuck in rerun is left behind: it is a daemon and ends with the process.

        Returns
        -------
        finished : whether everything queued was shown.
        """
        deadline = wall.monotonic() + timeout
        if not self._closed:
            self._closed = True
            try:
                self._queue.put(None, timeout=timeout)
            except queue.Full:
                _log.warning("rerun did not take the last blocks within %g s; they are not shown", timeout)
        self._worker.join(max(0.0, deadline - wall.monotonic()))
        if self._worker.is_alive():
            _log.warning("rerun did not finish within %g s; left behind", timeout)
        return not self._worker.is_alive() and self.fault is None

    def _wait_to_put(self, item) -> None:
        while self.fault is None:
            try:
                self._queue.put(item, timeout=0.2)
                return
            except queue.Full:
                continue
        raise OSError(f"rerun stopped: {self.fault}")

    def _work(self, scene: Scene, path, serve_port, options: ViewOptions) -> None:
        try:
            view = RunView(scene, path, serve_port, options)
            self._ready.set()
            self._show_all(view)
        except Exception as fault:  # whatever rerun raises, the run goes on; the reason is kept and told
            self.fault = f"{type(fault).__name__}: {fault}"
            _log.error("rerun stopped, the run goes on without it: %s", self.fault)

    def _show_all(self, view: RunView) -> None:
        flushed, told = wall.monotonic(), 0
        while True:
            item = self._next_item()
            if item is None:
                break
            if isinstance(item, Event):
                view.write_event(item)
            elif isinstance(item, Measurement):
                view.write_measurement(*item)
            elif len(item):
                view.write(item)
            if not self._lossless and wall.monotonic() - flushed > _FLUSH_EVERY:
                flushed = wall.monotonic()
                view.flush()
                if self.dropped + self._dropped_before > told:
                    told = self.dropped + self._dropped_before
                    view.write_dropped(told)
        view.close()

    def _next_item(self):
        if self._lossless:
            return self._queue.get()
        try:
            return self._queue.get(timeout=_FLUSH_EVERY)
        except queue.Empty:
            return np.empty(0)  # nothing new: time to flush what waits
