# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The view of a run on a thread, and the process in which that thread runs in real time.

Logging to rerun may block without end once a viewer stops reading.  The producer therefore only puts blocks into a bounded queue, and one
daemon thread alone calls rerun.  When the queue is full, a block is dropped and counted, and the view shows the count.  For a file of a run that
is not in real time (`RerunFile`) the producer waits instead.

As a process (``python -m bearing_sim.view.worker``) the module reads pickled blocks and events from its standard input until that ends.  File and
server have a thread and a queue each, so that a server that is stuck behind a viewer keeps nothing from the file.  Ctrl-C is left to the
process that feeds this one; whichever way that process ends, the input ends, and the file is finished.  The starting process sets the priority.
"""

import atexit
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
from contextlib import AbstractContextManager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Record
from bearing_sim.scene.scene import Scene
from bearing_sim.view.run_view import NOTHING_KNOWN, RunView, ViewOptions
from bearing_sim.view.viewer import incomplete, is_complete
from bearing_sim.view.web import WebViewer

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

    def end(self) -> None:
        """Put None behind all that is queued, however full the queue is."""
        with self.mutex:
            self._put(None)
            self.not_empty.notify()


def _rows(item) -> int:
    return len(item) if isinstance(item, np.ndarray) else 1


class View(AbstractContextManager):
    """What takes records for a view, and drops and counts what does not fit into its queue.

    Attributes
    ----------
    failure : why the view has stopped, or None.
    """

    def __init__(self):
        self._dropped = 0
        self.failure: str | None = None
        self._ready = threading.Event()
        self._queue = RowQueue(QUEUED_ROWS)
        self._closed = False

    @property
    def dropped(self) -> int:
        """Blocks, events and measurements dropped so far."""
        return self._dropped

    def write(self, record: Record) -> None:
        """Queue a record, which must not be changed any more; returns at once, except if nothing is dropped."""
        if self._closed:
            raise ValueError("the rerun view is closed")
        self._enqueue(record.copy() if isinstance(record, np.ndarray) else record)

    def _enqueue(self, item) -> None:
        try:
            if self.failure is None:
                self._queue.put_nowait(item)
                return
        except queue.Full:
            pass
        self._dropped += 1

    def wait_until_ready(self, timeout: float = 20.0) -> bool:
        """Wait until the file exists and the server accepts viewers; return whether this happened within ``timeout`` [s]."""
        return self._ready.wait(timeout)

    def __exit__(self, *_) -> None:
        self.close()


class ViewThread(View):
    """Shows blocks of samples, events and measurements in one rerun file, or at one port.

    Parameters
    ----------
    scene : the scene that is simulated.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 at which viewers may connect, or None; one of both.
    options : what else the view knows.
    """

    _real_time = True

    def __init__(self, scene: Scene, path: str | Path | None, serve_port: int | None, options: ViewOptions = NOTHING_KNOWN):
        super().__init__()
        self._dropped_before = 0
        self._is_abandoned = False  # nobody wants what is queued any more
        self._worker = threading.Thread(target=self._work, args=(scene, path, serve_port, options), name="rerun", daemon=True)
        self._worker.start()

    @property
    def ready(self) -> bool:
        """Whether the file exists, or the server accepts viewers."""
        return self._ready.is_set()

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
        if not self._closed:
            self._closed = True
            self._queue.end()
        self._worker.join(timeout)
        if self._worker.is_alive():
            _log.warning("rerun did not finish within %g s and was abandoned", timeout)
        return not self._worker.is_alive() and self.failure is None

    def _work(self, scene: Scene, path, serve_port, options: ViewOptions) -> None:
        try:
            view = RunView(scene, path, serve_port, options)
            self._ready.set()
            self._show_all(view)
        except Exception as error:  # whatever rerun raises, the run continues; the reason is kept and reported
            self.failure = f"{type(error).__name__}: {error}"
            _log.error("rerun stopped; the run continues without a view: %s", self.failure)

    def _show_all(self, view: RunView) -> None:
        flushed, reported = wall.monotonic(), 0
        while True:
            item = self._next_item()
            if item is None or self._is_abandoned:
                break
            view.write(item)
            if self._real_time and wall.monotonic() - flushed > _FLUSH_EVERY:
                flushed = wall.monotonic()
                view.flush()
                if self.dropped + self._dropped_before > reported:
                    reported = self.dropped + self._dropped_before
                    view.write_dropped(reported)
        view.close()

    def _next_item(self):
        try:
            return self._queue.get(timeout=_FLUSH_EVERY if self._real_time else None)
        except queue.Empty:
            return np.empty(0)  # nothing new: flush what is pending


class RerunFile(ViewThread):
    """Shows a run that is not in real time in a file, and makes the producer wait instead of dropping anything.

    Parameters
    ----------
    scene : the scene that is simulated.
    path : .rrd file to write.
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    duration : expected simulated time of the run [s], if known; the pictures are spread over it.
    load_scale : load [N] at the upper end of the colours, where known.

    Raises
    ------
    OSError
        The file cannot be written; at the end of a ``with`` block, too, if it is not complete.
    """

    _real_time = False

    def __init__(self, scene: Scene, path: str | Path, start_ns: int | None = None, duration: float | None = None, load_scale: float | None = None):
        self._path, self._exit_code = Path(path), 1
        self._path.open("wb").close()  # rerun itself would only log that it cannot write
        super().__init__(scene, path, None, ViewOptions(start_ns, duration, load_scale))

    def _enqueue(self, item) -> None:
        while self.failure is None:
            try:
                self._queue.put(item, timeout=0.2)
                return
            except queue.Full:
                continue
        raise incomplete(self.failure)

    def __exit__(self, kind, error, _) -> None:
        if kind is not None:
            self._abandon(error)
        finished = self.close()
        if kind is None and not (finished and is_complete(self._path)):
            raise incomplete(self.failure)

    def close(self, timeout: float = 120.0) -> bool:
        """Show what is queued and finish within ``timeout`` [s] (see `ViewThread.close`); a signal meanwhile leaves the file incomplete."""
        atexit.unregister(self._end_process)
        atexit.register(self._end_process)  # runs before what rerun has registered when it was imported
        try:
            return super().close(timeout)
        except BaseException as error:
            self._abandon(error)
            self._worker.join(_ABANDON_WITHIN)
            raise

    def _abandon(self, error: BaseException) -> None:
        """Have the thread finish at once: nobody wants the file any more."""
        self._is_abandoned = True
        if isinstance(error, SystemExit) and isinstance(error.code, int):
            self._exit_code = error.code
        self._queue.end()

    def _end_process(self) -> None:
        """End the process if the thread is still in rerun.

        At the end of the interpreter rerun waits for what is not written, and holds the lock of the interpreter meanwhile, which the threads that
        write need in order to release arrays: a file that was not finished, as on a full disk, would block the process for ever.
        """
        if self._worker.is_alive():
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(self._exit_code)


_ABANDON_WITHIN = 10.0  # [s] that rerun has for its last chunks after a signal
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
    browsers = Browsers(options.web_port, port) if options.web_port is not None else None
    threading.Thread(target=_report_on, args=(list(views.values()), browsers), daemon=True).start()
    for item in _items(items):
        for view in views.values():
            if isinstance(item, Dropped):
                view.note_dropped(item.count)
            else:
                view.write(item)
    finished = [view.close(_FINISH_WITHIN[is_file]) for is_file, view in views.items()]
    _report(_state(views.values(), browsers))
    os._exit(0 if all(finished) else 1)  # rerun's own shutdown may wait for a viewer that stopped reading


def _items(stream):
    """Yield items until the stream ends, possibly in the middle of an item if the feeding process was killed."""
    while True:
        try:
            yield pickle.load(stream)
        except (EOFError, pickle.UnpicklingError):
            return


class Browsers:
    """The web viewer of a stream, served from a thread that may first have to unpack it.

    Attributes
    ----------
    failure : why it is not served, or None; the view itself does without.
    served : whether browsers may come, or never will.
    """

    def __init__(self, port: int, stream: int):
        self.failure: str | None = None
        self.served = False
        threading.Thread(target=self._serve, args=(port, stream), name="browsers", daemon=True).start()

    def _serve(self, port: int, stream: int) -> None:
        try:
            self._viewer = WebViewer(port, stream)
        except Exception as error:  # whatever it is, the view is more important
            self.failure = f"{error}"
        self.served = True


def _state(views, browsers: Browsers | None) -> dict:
    return {
        "ready": all(view.ready for view in views) and (browsers is None or browsers.served),
        "dropped": sum(view.dropped for view in views),
        "failure": next((view.failure for view in views if view.failure), None),
        "no_browsers": None if browsers is None else browsers.failure,
    }


def _report_on(views, browsers: Browsers | None) -> None:
    reported = None
    while True:
        state = _state(views, browsers)
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
