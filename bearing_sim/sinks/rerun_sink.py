# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rerun sink: shows a run while it goes on, or writes it to an .rrd file, without ever holding up the run.

Logging to rerun may block without end once a viewer stops reading.  So the producer only puts blocks into a bounded
queue, and one daemon thread alone calls rerun.  When the queue is full a block is dropped and counted, and the view
says so; in lossless mode, for files only, the producer waits instead.
"""

import logging
import queue
import socket
import threading
import time as wall
from pathlib import Path

import numpy as np

from bearing_sim.events import Event
from bearing_sim.scene import Scene
from bearing_sim.sinks.rerun_view import RunView

_QUEUED_ROWS = 20_000  # about 20 MB with 18 rollers
_FLUSH_EVERY = 0.25  # [s] of wall time between columns of a live view
_log = logging.getLogger(__name__)


class _RowQueue(queue.Queue):
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


class RerunSink:
    """Shows blocks of samples and events in rerun.

    Parameters
    ----------
    scene : what runs.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None.
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    lossless : True makes the producer wait where blocks would be dropped; for files only, and not for real time.
    duration : simulated time that will come [s], where known; spreads the pictures of a file over it.
    load_scale : load [N] at the upper end of the colours, where known.

    Attributes
    ----------
    dropped : blocks and events dropped so far.
    fault : why nothing is shown any more, or None.

    Raises
    ------
    ValueError
        Neither ``path`` nor ``serve_port``, or ``lossless`` together with ``serve_port``.
    OSError
        The file cannot be written, or the port is taken.
    """

    def __init__(
        self,
        scene: Scene,
        path: str | Path | None = None,
        serve_port: int | None = None,
        start_ns: int | None = None,
        lossless: bool = False,
        duration: float | None = None,
        load_scale: float | None = None,
    ):
        if path is None and serve_port is None:
            raise ValueError("a rerun sink needs a path, a serve_port, or both")
        if lossless and serve_port is not None:
            raise ValueError("lossless is for files: a viewer that stops reading would hold up the run")
        if path is not None:
            Path(path).open("wb").close()  # the recorder itself would only log that it cannot write
        if serve_port is not None:
            _require_free(serve_port)
        self.dropped = 0
        self.fault: str | None = None
        self._lossless = lossless
        self._queue = _RowQueue(_QUEUED_ROWS)
        self._closed = False
        options = {"start_ns": start_ns, "duration": duration, "load_scale": load_scale, "real_time": not lossless}
        self._worker = threading.Thread(target=self._work, args=(scene, path, serve_port, options), name="rerun", daemon=True)
        self._worker.start()

    def write(self, block: np.ndarray) -> None:
        """Take a block of samples; returns at once, except in lossless mode."""
        if len(block):
            self._offer(block.copy())

    def write_event(self, event: Event) -> None:
        """Take an event; returns at once, except in lossless mode."""
        self._offer(event)

    def close(self, timeout: float | None = None) -> bool:
        """Show what is queued and finish; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s]; 5 s, or 120 s in lossless mode, where absent.  A worker that is stuck in rerun is left
            behind: it is a daemon and ends with the process.

        Returns
        -------
        finished : whether everything queued was shown.
        """
        limit = timeout if timeout is not None else (120.0 if self._lossless else 5.0)
        deadline = wall.monotonic() + limit
        if not self._closed:
            self._closed = True
            try:
                self._queue.put(None, timeout=limit)
            except queue.Full:
                _log.warning("rerun did not take the last blocks within %g s; they are not shown", limit)
        self._worker.join(max(0.0, deadline - wall.monotonic()))
        if self._worker.is_alive():
            _log.warning("rerun did not finish within %g s; left behind", limit)
        return not self._worker.is_alive() and self.fault is None

    def __enter__(self) -> "RerunSink":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _offer(self, item) -> None:
        if self._closed:
            raise ValueError("the rerun sink is closed")
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

    def _wait_to_put(self, item) -> None:
        while self.fault is None:
            try:
                self._queue.put(item, timeout=0.2)
                return
            except queue.Full:
                continue
        raise OSError(f"rerun stopped: {self.fault}")

    def _work(self, scene: Scene, path, serve_port, options: dict) -> None:
        try:
            self._show_all(RunView(scene, path, serve_port, **options))
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
            elif len(item):
                view.write(item)
            if not self._lossless and wall.monotonic() - flushed > _FLUSH_EVERY:
                flushed = wall.monotonic()
                view.flush()
                if self.dropped > told:
                    told = self.dropped
                    view.write_dropped(told)
        view.close()

    def _next_item(self):
        if self._lossless:
            return self._queue.get()
        try:
            return self._queue.get(timeout=_FLUSH_EVERY)
        except queue.Empty:
            return np.empty(0)  # nothing new: time to flush what waits


def _require_free(port: int) -> None:
    """Raise where ``port`` on 127.0.0.1 cannot be had: the server itself would fail silently, on a thread of its own."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as fault:
            text = f"port {port} on 127.0.0.1 cannot be used for the view ({fault.strerror}); close what uses it or choose another port"
            raise OSError(text) from fault
