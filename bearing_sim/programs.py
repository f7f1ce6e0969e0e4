# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The installed programs.  Each imports its module, which takes a second or two, so that Ctrl-C in the meantime ends it without a traceback."""

import importlib
import os
import signal
import sys
from collections.abc import Callable
from types import FrameType

from bearing_sim.extras import what_is_missing

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
    """Import a module and call its ``main``; exit with ``interrupted`` at a SIGINT during the import.

    Parameters
    ----------
    handler : of SIGINT while ``main`` runs; None: as Python has it.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is signal.SIG_IGN:  # as in the background of a shell without job control
        handler = None
    else:
        signal.signal(signal.SIGINT, lambda *_: os._exit(interrupted))
    try:
        main = importlib.import_module(module).main
    except ModuleNotFoundError as error:
        print(f"{os.path.basename(sys.argv[0])}: {what_is_missing(error)}", file=sys.stderr)
        return 2
    finally:
        signal.signal(signal.SIGINT, handler or before)
    return main()
