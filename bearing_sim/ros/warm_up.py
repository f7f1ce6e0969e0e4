# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compile models beside a node that answers meanwhile: one thread for all, in the order of asking."""

import gc
import threading
from collections import deque
from collections.abc import Callable


class WarmUp:
    """Runs jobs one after the other on one thread, which ends when none is left.

    Machine code cannot be interrupted while it is made; so a job that runs is finished even when nobody wants its result any more, and a node
    that is configured again and again meanwhile waits for that one thread instead of starting more.
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._jobs: deque[Callable[[], None]] = deque()
        self._thread: threading.Thread | None = None
        self._is_frozen = False

    def ask(self, job: Callable[[], None]) -> None:
        """Run a job, which must not raise, when all those asked for before are done."""
        with self._lock:
            self._jobs.append(job)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="warm-up", daemon=True)
                self._thread.start()

    def forget(self) -> None:
        """Leave out the jobs that have not begun."""
        with self._lock:
            self._jobs.clear()

    @property
    def is_working(self) -> bool:
        """Whether a job runs or waits."""
        with self._lock:
            return self._thread is not None

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._jobs:
                    self._thread = None
                    self._freeze_once()
                    return
                job = self._jobs.popleft()
            job()

    def _freeze_once(self) -> None:
        """Take what compiling has left out of the garbage collector's rounds.

        These are some hundred thousand objects that stay; each full round over them holds the whole process up for a tenth of a second.
        """
        if not self._is_frozen:
            gc.freeze()
        self._is_frozen = True
