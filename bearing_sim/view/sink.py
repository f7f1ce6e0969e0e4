# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rerun sink: shows a live run or writes it to an .rrd file, and never delays the run.

In real time the view is a process of its own (`bearing_sim.view.worker`): drawing costs milliseconds of
interpreter time, which a thread in this process would take from the solver between its ticks, and rerun itself may block
indefinitely behind a viewer that stops reading.  In this process a daemon thread only forwards bytes.  When the pipe is full, its
queue fills, and then blocks are dropped and counted.  A process that only serves viewers runs in idle time and may miss pictures on a
busy machine; one that also writes a file runs at low priority (see `bearing_sim.recording.priority`).
"""

import json
import logging
import os
import pickle
import queue
import socket
import subprocess
import sys
import threading
import time as wall
from pathlib import Path

import numpy as np

from bearing_sim.messages.events import Event, Measurement
from bearing_sim.messages.topics import Origin
from bearing_sim.recording.priority import in_idle_time, with_low_priority
from bearing_sim.scene.scene import Scene
from bearing_sim.view.run_view import ViewOptions
from bearing_sim.view.worker import QUEUED_ROWS, Dropped, RowQueue, ViewThread

_HAND_ON_EVERY = 0.03  # [s]; the solver is interrupted no more often than this
_NICENESS = 5  # of a process that writes a file, which must be complete
_log = logging.getLogger(__name__)


class RerunSink:
    """Shows blocks of samples, events and measurements in rerun.

    Parameters
    ----------
    scene : the scene that is simulated.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None.
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    lossless : True makes the producer wait instead of dropping blocks; for files only, not in real time.
    duration : expected simulated time of the run [s], if known; the pictures of a file are spread over it.
    load_scale : load [N] at the upper end of the colours, where known.

    Attributes
    ----------
    dropped : blocks, events and measurements dropped so far.
    fault : why the view has stopped, or None.

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
        self._lossless, self._closed = lossless, False
        options = ViewOptions(start_ns, duration, load_scale, real_time=not lossless)
        self._view = ViewThread(scene, path, None, options, lossless=True) if lossless else ViewProcess(scene, path, serve_port, options)

    @property
    def dropped(self) -> int:
        """Blocks, events and measurements dropped so far."""
        return self._view.dropped

    @property
    def fault(self) -> str | None:
        """Why the view has stopped, or None."""
        return self._view.fault

    @property
    def pid(self) -> int | None:
        """Number of the view's process; None in lossless mode, which has none."""
        return None if self._lossless else self._view.pid

    def write(self, block: np.ndarray) -> None:
        """Take a block of samples; returns at once, except in lossless mode."""
        if len(block):
            self._offer(block.copy())

    def write_event(self, event: Event) -> None:
        """Take an event; returns at once, except in lossless mode."""
        self._offer(event)

    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: Origin | None = None) -> None:
        """Take a cage speed [rad/s] measured at ``time`` [s] and its residual slip: measured less predicted (a fraction, or NaN).

        ``origin`` is kept by recordings and ignored here.
        """
        self._offer(Measurement(time, cage_speed, residual))

    def wait_until_ready(self, timeout: float = 20.0) -> bool:
        """Wait until the file exists and the server accepts viewers; return whether this happened within ``timeout`` [s]."""
        return self._view.wait_until_ready(timeout)

    def close(self, timeout: float | None = None) -> bool:
        """Show what is queued and finish; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s]; 5 s, or 120 s in lossless mode, where absent.  After that, whatever is blocked by a viewer is abandoned.

        Returns
        -------
        finished : whether everything queued was shown.
        """
        self._closed = True
        return self._view.close(timeout if timeout is not None else (120.0 if self._lossless else 5.0))

    def __enter__(self) -> "RerunSink":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _offer(self, item) -> None:
        if self._closed:
            raise ValueError("the rerun sink is closed")
        self._view.write(item)


class ViewProcess:
    """A file, a server, or both in a process of their own, fed through a pipe.

    Parameters
    ----------
    scene, path, serve_port, options : as those of `bearing_sim.view.worker.ViewThread`.

    Attributes
    ----------
    fault : why the view has stopped, or None.
    """

    def __init__(self, scene: Scene, path: str | Path | None, serve_port: int | None, options: ViewOptions):
        self.fault: str | None = None
        self._dropped_here = self._dropped_there = 0
        self._ready = threading.Event()
        self._queue = RowQueue(QUEUED_ROWS)
        self._closed = False
        paths = os.pathsep.join(entry for entry in sys.path if entry)
        command = [sys.executable, "-m", "bearing_sim.view.worker"]
        # Ctrl-C in a terminal reaches neither a session nor a group of its own.
        apart = {"process_group": 0} if path is None else {"start_new_session": True}
        self._process = subprocess.Popen(
            in_idle_time(command) if path is None else with_low_priority(command, _NICENESS),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=dict(os.environ, PYTHONPATH=paths),
            **apart,
        )
        first = pickle.dumps((scene, None if path is None else str(Path(path).absolute()), serve_port, options))
        self._feeder = threading.Thread(target=self._feed, args=(first,), name="rerun-feeder", daemon=True)
        self._listener = threading.Thread(target=self._listen, name="rerun-listener", daemon=True)
        self._feeder.start()
        self._listener.start()

    @property
    def dropped(self) -> int:
        """Blocks, events and measurements dropped so far, on this side of the pipe and beyond it."""
        return self._dropped_here + self._dropped_there

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def write(self, item: np.ndarray | Event | Measurement) -> None:
        """Take a block of samples, an event or a measurement; returns at once."""
        if self.fault is not None:
            self._dropped_here += 1
            return
        try:
            self._queue.put_nowait(item)
        except queue.Full:
            self._dropped_here += 1

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait until viewers can connect; return whether this happened within ``timeout`` [s]."""
        return self._ready.wait(timeout)

    def close(self, timeout: float) -> bool:
        """Show the queued items and end the process, by force after ``timeout`` [s]; return whether everything was shown."""
        deadline = wall.monotonic() + timeout
        if self._closed:
            return self.fault is None
        self._closed = True
        try:
            self._queue.put(None, timeout=timeout)
            finished = self._process.wait(max(0.0, deadline - wall.monotonic())) == 0
        except (queue.Full, subprocess.TimeoutExpired):
            _log.warning("the view did not finish within %g s and was ended", timeout)
            self._process.kill()
            self._process.wait()
            finished = False
        self._feeder.join(1.0)
        self._listener.join(1.0)
        return finished and self.fault is None

    def _feed(self, first: bytes) -> None:
        pipe, reported = self._process.stdin, 0
        try:
            pipe.write(first)
            while True:
                items, ended = self._gathered()
                if self._dropped_here > reported:
                    reported = self._dropped_here
                    items.append(Dropped(reported))
                for item in items:
                    pickle.dump(item, pipe, protocol=5)
                pipe.flush()
                if ended:
                    break
                wall.sleep(_HAND_ON_EVERY)
            pipe.close()
        except OSError:  # the process has ended; the listener reports why
            pass

    def _gathered(self) -> tuple[list, bool]:
        """Return the queued items, with adjacent blocks joined, and whether the input has ended."""
        gathered = [self._queue.get()]
        while gathered[-1] is not None:
            try:
                gathered.append(self._queue.get_nowait())
            except queue.Empty:
                break
        ended = gathered[-1] is None
        items: list = []
        for item in gathered[:-1] if ended else gathered:
            if isinstance(item, np.ndarray) and items and isinstance(items[-1], list):
                items[-1].append(item)
            else:
                items.append([item] if isinstance(item, np.ndarray) else item)
        return [np.concatenate(item) if isinstance(item, list) else item for item in items], ended

    def _listen(self) -> None:
        """Read the reports of the process, one line of JSON each, until it ends."""
        for line in self._process.stdout:
            report = json.loads(line)
            if report["ready"]:
                self._ready.set()
            self._dropped_there = report["dropped"]
            if report["fault"] is not None and self.fault is None:
                self.fault = report["fault"]
                _log.error("rerun stopped; the run continues without a view: %s", self.fault)
        code = self._process.wait()
        if not self._closed and self.fault is None:
            self.fault = f"the view process exited unexpectedly (code {code})"
            _log.error("%s; the run continues without a view", self.fault)


def _require_free(port: int) -> None:
    """Raise if ``port`` on 127.0.0.1 is taken; the server itself would fail silently on its own thread."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            text = f"port {port} on 127.0.0.1 cannot be used for the view ({error.strerror}); close the program that uses it or choose another port"
            raise OSError(text) from error
