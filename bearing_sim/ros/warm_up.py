# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compile models while the node keeps answering: one thread for all bearings, and processes for what no earlier process has compiled.

A compiler does not release its memory: a node that compiles level ``slip`` by itself keeps some 250 MB for as long as it runs.  So a process
of its own compiles, and the node loads the code from the cache.
"""

import gc
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable

from bearing_sim.recording.priority import with_low_priority
from bearing_sim.runtime.precompilation import is_compiled, is_compiled_for
from bearing_sim.scene.fidelity import lower_levels
from bearing_sim.scene.loader import scene_to_yaml
from bearing_sim.scene.scene import Scene

_PROGRAM = """
import sys
from bearing_sim.runtime.live import governor_of, warmed_up
from bearing_sim.scene.loader import scene_from_yaml
from bearing_sim.simulation import Simulation
scene = scene_from_yaml(sys.stdin.read())
if sys.argv[1] == "lower levels":
    governor_of(Simulation(scene))
else:
    warmed_up(scene)
"""
_NICENESS = 10  # below the running model, but not idle priority: the levels are needed most when the solver takes all the time there is


class WarmUp:
    """Runs jobs one after the other on one thread, which ends when no job is left.

    A running job is finished even if its result is no longer wanted.  A node that is configured repeatedly in the meantime waits for
    that one thread instead of starting more.
    """

    def __init__(self):
        self._lock = threading.Lock()
        self._jobs: deque[Callable[[], None]] = deque()
        self._thread: threading.Thread | None = None
        self._is_frozen = self._is_closed = False
        self._compiler: subprocess.Popen | None = None
        self._lower: subprocess.Popen | None = None  # belongs to the bearing for which it was started

    def request(self, job: Callable[[], None]) -> None:
        """Run a job, which must not raise, after all jobs requested before."""
        with self._lock:
            self._jobs.append(job)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="warm-up", daemon=True)
                self._thread.start()

    def cancel(self) -> None:
        """Drop the jobs that have not started."""
        with self._lock:
            self._jobs.clear()

    def close(self) -> None:
        """Drop the jobs that have not started, and end the process that compiles; no other one is started."""
        self.cancel()
        with self._lock:
            self._is_closed = True
            if self._compiler is not None:
                self._compiler.kill()

    def compile(self, scene: Scene) -> None:
        """Compile what a run of a scene starts with, in a process of its own, unless the cache has it; a job.

        If that process fails, the node compiles by itself, and reports what goes wrong.
        """
        if is_compiled_for(scene):
            return
        with self._lock:
            if self._is_closed:
                return
            self._compiler = start_compiling(scene)
        self._compiler.wait()
        self._compiler = None

    def compile_lower(self, scene: Scene) -> subprocess.Popen | None:
        """Start a process that compiles the levels below a scene's own; None while one does so for another bearing, which often needs the same."""
        if self._lower is not None and self._lower.poll() is None:
            return None
        self._lower = start_compiling(scene, lower=True)
        return self._lower

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
        """Exclude what compiling has left from garbage collection.

        Compiling leaves some hundred thousand permanent objects; each full collection over them would stop the process for a tenth of a second.
        """
        if not self._is_frozen:
            gc.freeze()
        self._is_frozen = True


def levels_to_compile(scene: Scene) -> list[str]:
    """Return the levels of lower fidelity than a scene's own whose code is not in this version's cache."""
    return [level for level in lower_levels(scene) if not is_compiled(level)]


def start_compiling(scene: Scene, lower: bool = False) -> subprocess.Popen:
    """Start a process that compiles a scene's own level, or those of lower fidelity, at low priority so that the running model is not disturbed."""
    command = [sys.executable, "-c", _PROGRAM, "lower levels" if lower else "own level"]
    process = subprocess.Popen(
        with_low_priority(command, _NICENESS) if lower else command,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    process.stdin.write(scene_to_yaml(scene))
    process.stdin.close()
    return process
