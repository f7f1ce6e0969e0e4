# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The installed programs.  Each imports its module, which takes a second or two, so that a signal in the meantime ends it without a traceback."""

import importlib
import os
import signal
import sys
from collections.abc import Callable
from types import FrameType

from bearing_sim.files.extras import what_is_missing

_INTERRUPTED = 128 + signal.SIGINT


def bearing_sim() -> int:
    """Run the command line, whose commands import what they need when they are called."""
    return _run("bearing_sim.cli.main", _INTERRUPTED, _interrupt)


def bearing_node() -> int:
    """Run the node (see `bearing_sim.ros.node.main`)."""
    return _run("bearing_sim.ros.node", 0)


def bearing_player() -> int:
    """Run the player (see `bearing_sim.ros.player.main`)."""
    return _run("bearing_sim.ros.player", _INTERRUPTED)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, but end the program where an import is interrupted: Python may print and drop what is raised there."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            os._exit(_INTERRUPTED)
        frame = frame.f_back
    raise KeyboardInterrupt


def _run(module: str, interrupted: int, handler: Callable | None = None) -> int:
    """Import a module and call its ``main``; exit with ``interrupted`` at a signal during the import.

    Parameters
    ----------
    handler : of SIGINT while ``main`` runs.  Without one SIGTERM counts too, and ``main`` has handlers of its own, until which these stay.
    """
    watched = [signal.SIGINT] if handler is not None else [signal.SIGINT, signal.SIGTERM]
    before = {number: signal.getsignal(number) for number in watched}
    watched = [number for number in watched if before[number] is not signal.SIG_IGN]  # as in the background of a shell without job control
    for number in watched:
        signal.signal(number, lambda *_: os._exit(interrupted))
    try:
        main = importlib.import_module(module).main
    except BaseException as error:
        for number in watched:
            signal.signal(number, before[number])
        if not isinstance(error, ModuleNotFoundError):
            raise
        print(f"{os.path.basename(sys.argv[0])}: {what_is_missing(error)}", file=sys.stderr)
        return 2
    if handler is not None and watched:
        signal.signal(signal.SIGINT, handler)
    return main()
