# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The view of a run on a thread, and the process in which that thread runs in real time.

Logging to rerun may block without end once a viewer stops reading.  The producer therefore only puts blocks into a bounded queue, and one
daemon thread alone calls rerun.  When the queue is full, a block is dropped and counted, and the view shows the count.  In lossless mode,
for files only, the producer waits instead.

As a process (``python -m bearing_sim.view.worker``) the module reads pickled blocks and events from its standard input until that ends.  File and
server have a thread and a queue each, so that a server that is stuck behind a viewer keeps nothing from the file.  Ctrl-C is left to the
process that feeds this one; whichever way that process ends, the input ends, and the file is finished.  The starting process sets the priority.
"""

import json
import logging
import os
import pickle
import queue
import signal
import sys
import threading
import time
import time as wall
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Event, Measurement
from bearing_sim.scene.scene import Scene
from bearing_sim.view.run_view import NOTHING_KNOWN, RunView, ViewOptions

QUEUED_ROWS = 20_000  # about 20 MB with 18 rollers
_FLUSH_EVERY = 0.25  # [s] of wall time between columns of a live view
_log = logging.getLogger(__name__)


class Dropped(NamedTuple):
    """The total of blocks dropped before this queue."""

    count: int


class RowQueue(queue.Queue):
    """A queue bounded by rows of samples instead of blocks, because a block may hold one row or a thousand."""

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
    scene : the scene that is simulated.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None; one of both.
    options : what else the view knows.
    lossless : True makes the producer wait instead of dropping blocks; for files only, not in real time.

    Attributes
    ----------
    dropped : blocks, events and measurements dropped so far.
    fault : why the view has stopped, or None.
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
        """Whether the file exists, or the server accepts viewers."""
        return self._ready.is_set()

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait until `ready`; return whether this happened within ``timeout`` [s]."""
        return self._ready.wait(timeout)

    def note_dropped(self, count: int) -> None:
        """Make the view show that ``count`` blocks in total were dropped before they reached this queue."""
        self._dropped_before = count

    def close(self, timeout: float) -> bool:
        """Show what is queued and finish; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s].  A worker that is blocked in rerun is abandoned: it is a daemon thread and ends with the process.

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
            _log.warning("rerun did not finish within %g s and was abandoned", timeout)
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
        except Exception as error:  # whatever rerun raises, the run continues; the reason is kept and reported
            self.fault = f"{type(error).__name__}: {error}"
            _log.error("rerun stopped; the run continues without a view: %s", self.fault)

    def _show_all(self, view: RunView) -> None:
        flushed, reported = wall.monotonic(), 0
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
                if self.dropped + self._dropped_before > reported:
                    reported = self.dropped + self._dropped_before
                    view.write_dropped(reported)
        view.close()

    def _next_item(self):
        if self._lossless:
            return self._queue.get()
        try:
            return self._queue.get(timeout=_FLUSH_EVERY)
        except queue.Empty:
            return np.empty(0)  # nothing new: flush what is pending


_REPORT_EVERY = 0.1  # [s], where there is news
_FINISH_WITHIN = {True: 60.0, False: 1.5}  # [s]: a file, which must be complete even on a busy machine; a server, which a viewer may block


def main() -> None:
    """Show what arrives on standard input and report dropped blocks and errors on standard output."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTTOU):  # the last: a terminal may stop a background writer
        signal.signal(number, signal.SIG_IGN)
    items = sys.stdin.buffer
    scene, path, port, options = pickle.load(items)
    views = {True: ViewThread(scene, path, None, options)} if path is not None else {}
    if port is not None:
        views[False] = ViewThread(scene, None, port, options)
    threading.Thread(target=_report_on, args=(list(views.values()),), daemon=True).start()
    for item in _items(items):
        for view in views.values():
            if isinstance(item, Dropped):
                view.note_dropped(item.count)
            else:
                view.write(item)
    finished = [view.close(_FINISH_WITHIN[is_file]) for is_file, view in views.items()]
    _report(_state(views.values()))
    os._exit(0 if all(finished) else 1)  # rerun's own shutdown may wait for a viewer that stopped reading


def _items(stream):
    """Yield items until the stream ends, possibly in the middle of an item if the feeding process was killed."""
    while True:
        try:
            yield pickle.load(stream)
        except (EOFError, pickle.UnpicklingError):
            return


def _state(views) -> dict:
    error = next((view.fault for view in views if view.fault), None)
    return {"ready": all(view.ready for view in views), "dropped": sum(view.dropped for view in views), "fault": error}


def _report_on(views) -> None:
    reported = None
    while True:
        state = _state(views)
        if state != reported:
            reported = state
            _report(state)
        time.sleep(_REPORT_EVERY)


def _report(state: dict) -> None:
    try:
        os.write(1, json.dumps(state).encode() + b"\n")
    except OSError:
        pass  # the feeding process was killed


if __name__ == "__main__":
    from bearing_sim.view import worker  # by its own name: what the parent pickles are this module's classes, not those of __main__

    worker.main()
