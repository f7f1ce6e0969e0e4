# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scheduling of processes that run beside the solver, so that it gets the processor first.

Niceness is not enough: since Linux 6.6 a thread that wakes up waits until the time slice of the running thread is over, several
milliseconds, however nice that thread is.  Two policies help:

- *Idle time* (SCHED_IDLE) is for what may be late, such as pictures.  Every thread that wakes up pre-empts it at once, and a core that runs nothing
  else counts as free.  On a busy machine it gets almost no time.
- *Low priority* (SCHED_BATCH and niceness) is for what must get its share in the end, such as files.  It never pre-empts another thread.

Linux compares threads within a session (autogroup) or control group, and sessions as wholes.  A process in idle time therefore belongs in the
solver's session: in a session of its own it would be the only thread, with the share of a whole session.  A process with low priority belongs
in a session of its own if it must not depend on what else runs in the solver's.

Nothing here needs privileges.  Where the system does not know a policy or does not allow it, nothing happens.
"""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

_IDLE_TIME = "idle-time"
_NICEST = 19


def use_idle_time() -> None:
    """Run all present and future threads of this process in idle time only; this cannot be undone without privileges."""
    if not _schedule_threads("SCHED_IDLE"):
        _be_nicer(_NICEST)


def use_low_priority(niceness: int) -> None:
    """Let this process pre-empt nobody and get a smaller share of a busy processor; the same for a session that it leads."""
    _be_nicer(niceness)
    _schedule_threads("SCHED_BATCH")
    if hasattr(os, "getsid") and os.getsid(0) == os.getpid():
        with suppress(OSError):
            Path("/proc/self/autogroup").write_text(str(niceness))


def give_idle_time(pid: int) -> None:
    """Run all present and future threads of another process of this user in idle time only, from now on."""
    _schedule_threads("SCHED_IDLE", pid=pid)


def lower_thread_priority(beginning: str) -> None:
    """Let the threads of this process with names that begin with ``beginning`` pre-empt nobody."""
    _schedule_threads("SCHED_BATCH", beginning)


def in_idle_time(command: Sequence[str | os.PathLike]) -> list[str]:
    """Return the command that runs the same program in idle time, from its start and as the same process."""
    return _started_by_this_file(_IDLE_TIME, command)


def with_low_priority(command: Sequence[str | os.PathLike], niceness: int) -> list[str]:
    """Return the command that runs the same program with low priority, from its start and as the same process."""
    return _started_by_this_file(str(niceness), command)


def _started_by_this_file(policy: str, command: Sequence[str | os.PathLike]) -> list[str]:
    # This file alone, without site and environment: that takes a hundredth of a second and works wherever the package is.
    return [sys.executable, "-I", "-S", __file__, policy, *map(os.fspath, command)]


def _schedule_threads(policy: str, beginning: str = "", pid: int | None = None) -> bool:
    """Set the policy of the threads with names that begin with ``beginning``; threads that they start inherit it.  Return whether it was allowed.

    Without ``pid`` of this process.
    """
    try:
        threads = list(Path(f"/proc/{pid or 'self'}/task").iterdir())
    except OSError:
        threads = [] if beginning or pid is not None else [Path("0")]  # 0 is the running thread
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
    """Set the policy named by the first argument and become the command that follows."""
    policy, *command = sys.argv[1:]
    if policy == _IDLE_TIME:
        use_idle_time()
    else:
        use_low_priority(int(policy))
    try:
        os.execvp(command[0], command)
    except OSError as error:
        sys.exit(f"{command[0]} cannot be started: {error.strerror}")


if __name__ == "__main__":
    main()
