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
import socket
import subprocess
import sys
import threading
import time as wall
from itertools import groupby
from pathlib import Path

import numpy as np

from bearing_sim.recording.priority import in_idle_time, with_low_priority
from bearing_sim.scene.scene import Scene
from bearing_sim.view.run_view import ViewOptions
from bearing_sim.view.viewer import free_port
from bearing_sim.view.worker import Dropped, View

_HAND_ON_EVERY = 0.03  # [s]; the solver is interrupted no more often than this
_NICENESS = 5  # of a process that writes a file, which must be complete
_log = logging.getLogger(__name__)


class RerunSink(View):
    """Shows a run in real time: a file, a server, or both in a process of their own, fed through a pipe.

    Parameters
    ----------
    scene : the scene that is simulated.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None.
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    web_port : port on 127.0.0.1 at which a browser finds rerun's web viewer, or None; without ``serve_port`` any port serves its stream.

    Raises
    ------
    ValueError
        Neither ``path`` nor ``serve_port`` nor ``web_port``.
    OSError
        The file cannot be written, or a port is taken.
    """

    def __init__(
        self,
        scene: Scene,
        path: str | Path | None = None,
        serve_port: int | None = None,
        start_ns: int | None = None,
        web_port: int | None = None,
    ):
        if path is None and serve_port is None and web_port is None:
            raise ValueError("a rerun sink needs a path, a serve_port, or a web_port")
        if web_port is not None:
            _require_free(web_port)
            serve_port = free_port() if serve_port is None else serve_port
        if path is not None:
            Path(path).open("wb").close()  # the recorder itself would only log that it cannot write
        if serve_port is not None:
            _require_free(serve_port)
        super().__init__()
        self._path = path
        self._dropped_there = 0
        self.no_browsers: str | None = None
        paths = os.pathsep.join(entry for entry in sys.path if entry)
        # Ctrl-C in a terminal reaches neither a session nor a group of its own; a SIGINT sent to all processes is ignored from the start.
        command = ["sh", "-c", "trap '' INT; exec \"$@\"", "sh", sys.executable, "-m", "bearing_sim.view.worker"]
        apart = {"process_group": 0} if path is None else {"start_new_session": True}
        self._process = subprocess.Popen(
            in_idle_time(command) if path is None else with_low_priority(command, _NICENESS),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=dict(os.environ, PYTHONPATH=paths),
            **apart,
        )
        options = ViewOptions(start_ns, real_time=True, web_port=web_port)
        first = pickle.dumps((scene, None if path is None else str(Path(path).absolute()), serve_port, options))
        self._feeder = threading.Thread(target=self._feed, args=(first,), name="rerun-feeder", daemon=True)
        self._listener = threading.Thread(target=self._listen, name="rerun-listener", daemon=True)
        self._feeder.start()
        self._listener.start()

    @property
    def dropped(self) -> int:
        """Blocks, events and measurements dropped so far, on this side of the pipe and beyond it."""
        return self._dropped + self._dropped_there

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def close(self, timeout: float = 5.0) -> bool:
        """Show the queued items and end the process; return whether everything was shown within ``timeout`` [s].

        A process that needs longer and writes a file completes it by itself, even after the end of this one; another is ended by force.
        A second call does nothing.
        """
        if self._closed:
            return self.failure is None
        self._closed = True
        self._queue.end()
        try:
            finished = self._process.wait(timeout) == 0
        except subprocess.TimeoutExpired:
            if self._path is not None:
                _log.warning("%s is not complete after %g s; the view process (id %d) is still completing it", self._path, timeout, self.pid)
                return False
            _log.warning("the view did not finish within %g s and was ended", timeout)
            self._process.kill()
            self._process.wait()
            finished = False
        self._feeder.join(1.0)
        self._listener.join(1.0)
        return finished and self.failure is None

    def _feed(self, first: bytes) -> None:
        pipe, reported = self._process.stdin, 0
        try:
            pipe.write(first)
            while True:
                items, ended = self._gathered()
                if self._dropped > reported:
                    reported = self._dropped
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
        while gathered[-1] is not None and not self._queue.empty():  # nobody else takes items
            gathered.append(self._queue.get())
        ended = gathered[-1] is None
        items: list = []
        for is_block, run in groupby(gathered[:-1] if ended else gathered, key=lambda item: isinstance(item, np.ndarray)):
            neighbours = list(run)
            items += [np.concatenate(neighbours)] if is_block else neighbours
        return items, ended

    def _listen(self) -> None:
        """Read the reports of the process, one line of JSON each, until it ends."""
        for line in self._process.stdout:
            report = json.loads(line)
            if report["ready"]:
                self._ready.set()
            self._dropped_there = report["dropped"]
            if report["no_browsers"] is not None and self.no_browsers is None:
                self.no_browsers = report["no_browsers"]
                _log.error("the view is not served to browsers: %s", self.no_browsers)
            if report["failure"] is not None and self.failure is None:
                self.failure = report["failure"]
                _log.error("rerun stopped; the run continues without a view: %s", self.failure)
        code = self._process.wait()
        if not self._closed and self.failure is None:
            self.failure = f"the view process exited unexpectedly (code {code})"
            _log.error("%s; the run continues without a view", self.failure)


def _require_free(port: int) -> None:
    """Raise if ``port`` on 127.0.0.1 is taken; the server itself would fail silently on its own thread."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            text = f"port {port} on 127.0.0.1 cannot be used for the view ({error.strerror}); close the program that uses it or choose another port"
            raise OSError(text) from error
