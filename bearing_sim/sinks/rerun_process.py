# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The process of a live view: takes pickled blocks and events from its standard input until that ends, and shows them.

File and server have a thread and a queue each: a server that is stuck behind a viewer keeps nothing from the file.  Ctrl-C is
left to the process that feeds this one; its end, of whatever kind, ends the input, and the file is finished then.  How much of
the processor it gets is settled by who starts it.
"""

import json
import os
import pickle
import signal
import sys
import threading
import time

from bearing_sim.sinks.rerun_thread import Dropped, ViewThread

_REPORT_EVERY = 0.1  # [s], where there is news
_FINISH_WITHIN = {True: 4.0, False: 1.5}  # [s]: a file, which must be complete; a server, which may be stuck behind a viewer


def main() -> None:
    """Show what comes on the standard input, and report drops and faults on the standard output."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTTOU):  # the last: a terminal may stop who writes from behind
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
    os._exit(0 if all(finished) else 1)  # rerun's own end may wait for a viewer that stopped reading


def _items(stream):
    """Yield what comes until the stream ends, in the middle of something where the feeding process was killed."""
    while True:
        try:
            yield pickle.load(stream)
        except (EOFError, pickle.UnpicklingError):
            return


def _state(views) -> dict:
    fault = next((view.fault for view in views if view.fault), None)
    return {"ready": all(view.ready for view in views), "dropped": sum(view.dropped for view in views), "fault": fault}


def _report_on(views) -> None:
    told = None
    while True:
        state = _state(views)
        if state != told:
            told = state
            _report(state)
        time.sleep(_REPORT_EVERY)


def _report(state: dict) -> None:
    try:
        os.write(1, json.dumps(state).encode() + b"\n")
    except OSError:
        pass  # nobody listens any more: the feeding process was killed


if __name__ == "__main__":
    main()
