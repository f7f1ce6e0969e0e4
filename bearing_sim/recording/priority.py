# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Processes beside a solver let it have the processor first.

Two ways, because niceness is not enough: since Linux 6.6 a thread that wakes up waits for the one that runs until its slice is over, several
milliseconds, however nice that is.

- *Idle time* (the policy SCHED_IDLE) is for what may be late, pictures: whoever wakes up pre-empts it at once, a core that has nothing else to
  run counts as free, and where there is no time to spare it gets next to none.
- *Giving way* (SCHED_BATCH, and niceness) is for what must get its share in the end, files: it interrupts nobody when it wakes up.

Linux compares threads within a session (its autogroups) or a control group, and those as wholes among each other.  So what runs in idle time
belongs into the solver's session: in one of its own it would be its only thread, with the right of a whole session.  What gives way belongs
into a session of its own where it must not depend on what else runs in the solver's.

Everything here needs no privileges, and does nothing where the system does not know it or does not allow it.
"""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

_IDLE_TIME = "idle-time"
_NICEST = 19


def use_idle_time() -> None:
    """Let this process run in idle time only, with all the threads that it has and will have; there is no way back without privileges."""
    if not _schedule_threads("SCHED_IDLE"):
        _be_nicer(_NICEST)


def give_way(niceness: int) -> None:
    """Let this process interrupt nobody, and have a lower share of the processor where it is short; so, too, a session that it leads."""
    _be_nicer(niceness)
    _schedule_threads("SCHED_BATCH")
    if hasattr(os, "getsid") and os.getsid(0) == os.getpid():
        with suppress(OSError):
            Path("/proc/self/autogroup").write_text(str(niceness))


def let_threads_give_way(beginning: str) -> None:
    """Let those threads of this process that the system knows by a name with this beginning interrupt nobody."""
    _schedule_threads("SCHED_BATCH", beginning)


def in_idle_time(command: Sequence[str | os.PathLike]) -> list[str]:
    """Return the command that does the same in idle time, as the same process, from its first moment on."""
    return _behind(_IDLE_TIME, command)


def giving_way(command: Sequence[str | os.PathLike], niceness: int) -> list[str]:
    """Return the command that does the same and gives way, as the same process, from its first moment on."""
    return _behind(str(niceness), command)


def _behind(manner: str, command: Sequence[str | os.PathLike]) -> list[str]:
    # This file alone, without site and environment: it takes a hundredth of a second, and finds itself wherever the package is.
    return [sys.executable, "-I", "-S", __file__, manner, *map(os.fspath, command)]


def _schedule_threads(policy: str, beginning: str = "") -> bool:
    """Give the threads of this process whose names begin so a policy, which those that they start inherit; return whether the system let it."""
    try:
        threads = list(Path("/proc/self/task").iterdir())
    except OSError:
        threads = [] if beginning else [Path("0")]  # 0 is the running thread
    try:
        for thread in threads:
            with suppress(FileNotFoundError, ProcessLookupError):  # it may end meanwhile
                if not beginning or (thread / "comm").read_text().startswith(beginning):
                    os.sched_setscheduler(int(thread.name), getattr(os, policy), os.sched_param(0))
    except (AttributeError, OSError):
        return False
    return True


def _be_nicer(niceness: int) -> None:
    with suppress(AttributeError, OSError):
        os.nice(niceness)


def main() -> None:
    """Become the command that follows, in the manner that is named before it."""
    manner, *command = sys.argv[1:]
    if manner == _IDLE_TIME:
        use_idle_time()
    else:
        give_way(int(manner))
    try:
        os.execvp(command[0], command)
    except OSError as fault:
        sys.exit(f"{command[0]} cannot be started: {fault.strerror}")


if __name__ == "__main__":
    main()
