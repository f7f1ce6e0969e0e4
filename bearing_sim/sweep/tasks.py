# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tasks on all cores or on a Dask cluster, and the journal that keeps their results.

A result is stored under a hash of everything it depends on, so finished tasks are never computed again.  This module imports
nothing of the model: a worker sets its thread counts before the first array library is loaded.
"""

import fcntl
import hashlib
import json
import multiprocessing
import os
import signal
import sys
import threading
import time
import types
import zlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import nullcontext
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from bearing_sim.files.cores import cores
from bearing_sim.files.kept import kept_if_possible, tell_once
from bearing_sim.files.limits import printable

_PACKAGE = Path(__file__).resolve().parents[1]
# Sources that a result depends on besides compiled code, which `sources_hash` covers: from scene to parameters, and the runs.
_SOURCES = (
    "simulation.py",
    "scene/*.py",
    "model/*.py",
    "levels/steady/*.py",
    "sweep/point.py",
    "sweep/settling.py",
    "sweep/conditions.py",
    "sweep/ring_resonance.py",
    "sweep/states.py",
    "sweep/thermal.py",
)


Progress = Callable[[int, int], None]
"""Called with the number of finished tasks or points, and of all that are not in the journal."""


def in_silence(done: int, total: int) -> None:
    """Tell nobody about progress."""


class Task(NamedTuple):
    """One computation.

    Attributes
    ----------
    key : hash of everything the result depends on.
    kind : tasks of the same kind run the same compiled code.
    function : picklable function of a module; returns a mapping of names to numbers, texts and lists, and raises only for bugs.
    arguments : picklable.
    """

    key: str
    kind: str
    function: Callable[..., dict]
    arguments: tuple


@cache
def program_hash(*more: str) -> str:
    """Return a hash of the sources that results depend on, including the compiler's version.

    Parameters
    ----------
    more : patterns of further sources, below the package, such as ``inputs/*.py``.
    """
    from bearing_sim.numerics.compilation import sources_hash

    digest = hashlib.sha256(sources_hash().encode())
    for pattern in (*_SOURCES, *more):
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


@cache
def _source(module: str) -> bytes:
    return Path(sys.modules[module].__file__).read_bytes()


def task(kind: str, function: Callable[..., dict], *arguments: Any) -> Task:
    """Return a task with the hash of its function, the function's module, the arguments and the program.

    Parameters
    ----------
    kind, function : see `Task`.
    arguments : values with an exact `repr`: scenes, numbers, texts and tuples of these.
    """
    digest = hashlib.sha256(_source(function.__module__))
    digest.update("\n".join([program_hash(), function.__qualname__, *map(repr, arguments)]).encode())
    return Task(digest.hexdigest()[:32], kind, function, arguments)


_BEGIN = b'{"key": "'
_CHECKSUM = b', "crc32": '  # of what stands before it in its line
_SYNC = 1.0  # s between syncs to disk, the most that a power cut loses; a killed process loses nothing


class JournalInUse(RuntimeError):
    """Another process is writing this journal, or it is no journal."""


class Journal:
    """Append-only store of results by task key, in a file of one JSON line per task; a context manager.

    Finished tasks survive a kill at any instant.  A line that a kill cut short is removed before the next one is written; tasks of lines that are
    damaged are computed again, and it is said how many.

    Parameters
    ----------
    path : of the journal, created if absent; None keeps results in memory only.
    is_own : whether it is the program's own, in its cache: where it cannot be written, which is said, results are kept in memory, too.

    Raises
    ------
    JournalInUse
        Another process is writing it.
    """

    def __init__(self, path: Path | None = None, is_own: bool = False):
        self.path, self._file, self._synced = path, None, 0.0
        self._results: dict[str, dict] = {}
        self._writing = kept_if_possible if is_own else nullcontext
        if path is not None:
            with self._writing(path):
                self._open(path, is_own)

    def _open(self, path, is_own):
        path.parent.mkdir(parents=True, exist_ok=True)
        file = open(path, "a+b")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.close()
            raise JournalInUse(f"{path}: another process is writing it; wait until it has finished, or give another output") from None
        file.seek(0)
        if (begin := file.read(len(_BEGIN))) and not _BEGIN.startswith(begin) and not is_own:
            file.close()
            raise JournalInUse(f"{path} is no journal of bearing-sim, to which results could be added; move it, or give another output")
        file.seek(0)
        whole = damaged = 0
        for line in file:
            if not line.endswith(b"\n"):
                break
            whole += len(line)
            try:
                entry = json.loads(line) if line == _line(line.rpartition(_CHECKSUM)[0]) else {}
                self._results[entry["key"]] = entry["result"]
            except (ValueError, KeyError, TypeError):
                damaged += 1
        if damaged:
            tell_once(f"{printable(path)} is damaged: {damaged} of its lines; their tasks are computed again", path)
        file.truncate(whole)
        self._file = file

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __contains__(self, key: str) -> bool:
        return key in self._results

    def __getitem__(self, key: str) -> dict:
        return self._results[key]

    def __len__(self) -> int:
        return len(self._results)

    def add(self, key: str, result: dict) -> None:
        """Store the result of a task; it survives a kill of the process once this returns."""
        self._results[key] = result
        if self._file is None:
            return
        with self._writing(self.path):
            self._file.write(_line(json.dumps({"key": key, "result": result}).encode()[:-1]))
            self._file.flush()
            if time.monotonic() - self._synced > _SYNC:
                os.fsync(self._file.fileno())
                self._synced = time.monotonic()

    def close(self) -> None:
        """Force all results to disk and release the file."""
        file, self._file = self._file, None
        if file is not None:
            with self._writing(self.path), file:
                file.flush()
                os.fsync(file.fileno())


def _line(data: bytes) -> bytes:
    """Return the line of a journal from its JSON without the last brace."""
    return data + _CHECKSUM + b"%d}\n" % zlib.crc32(data)


_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_AHEAD = 2  # tasks queued for each worker; few, so that a kill of everything loses few
_ATTEMPTS = 2  # at a task after its worker died
_DASK_TIMEOUT = 20  # s to reach the scheduler


UNAVAILABLE = "unavailable"
"""Status of a result that may be another one the next time, such as that of a file that could not be opened."""


class ClusterError(RuntimeError):
    """A Dask cluster that cannot be used; the message says what to do."""


def run_tasks(
    tasks: Sequence[Task],
    journal: Journal,
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress = in_silence,
) -> list[dict]:
    """Return the results of tasks in their order, from the journal where available; equal tasks are computed once.

    A task whose worker dies is repeated alone.  If that worker dies, too, the result is ``{"status": "failed", "reason": ...}``,
    which is not stored in the journal.  Nor is a result whose ``status`` is `UNAVAILABLE`.

    Parameters
    ----------
    tasks : to compute.
    journal : with finished results; new ones are added.
    workers : number of processes; None: one per core; 1: this process only.
    dask : address of a Dask scheduler to use instead; its workers need this package.
    progress : called with the number of finished tasks and of all tasks that are not in the journal.

    Raises
    ------
    ClusterError
        ``distributed`` is not installed, or the scheduler cannot be reached.
    """
    pending = {task.key: task for task in tasks if task.key not in journal}
    lost: dict[str, dict] = {}
    progress(0, len(pending))
    for done, (task, result, keep) in enumerate(_computed(list(pending.values()), workers or cores(), dask), 1):
        if keep and result.get("status") != UNAVAILABLE:
            journal.add(task.key, result)
        else:
            lost[task.key] = result
        progress(done, len(pending))
    return [lost[task.key] if task.key in lost else journal[task.key] for task in tasks]


class Execution(NamedTuple):
    """How the tasks of a study are computed.

    Attributes
    ----------
    journal : with finished results, which are not computed again; None keeps results in memory.
    workers, dask : see `run_tasks`.
    progress : called with the number of finished points and of all that are not in the journal.
    """

    journal: Journal | None = None
    workers: int | None = None
    dask: str | None = None
    progress: Progress = in_silence

    def run(self, tasks: Sequence[Task]) -> list[dict]:
        """Return the results of tasks, see `run_tasks`."""
        return run_tasks(tasks, Journal() if self.journal is None else self.journal, self.workers, self.dask, self.progress)


IN_MEMORY = Execution()
"""Tasks on all cores of this machine, results in memory."""


def _computed(tasks, workers, dask) -> Iterator[tuple[Task, dict, bool]]:
    """Yield tasks with their results as they arrive, and whether to store them."""
    if dask is not None:
        yield from _on_cluster(tasks, dask)
        return
    if workers == 1 or len(tasks) < 2:
        for task in tasks:
            yield task, task.function(*task.arguments), True
        return
    # Compute one task of each kind here, so that its machine code is on disk before all workers need it.
    kinds = {task.kind: task for task in reversed(tasks)}
    for task in kinds.values():
        yield task, task.function(*task.arguments), True
    yield from _in_processes([task for task in tasks if kinds[task.kind] is not task], workers)


def _in_processes(tasks, workers) -> Iterator[tuple[Task, dict, bool]]:
    waiting, suspects = list(reversed(tasks)), []
    while waiting:
        under_way: dict = {}
        with _pool(min(workers, len(waiting))) as pool:
            try:
                while waiting or under_way:
                    while waiting and len(under_way) < _AHEAD * workers:
                        task = waiting[-1]
                        under_way[_submitted(pool, task)] = task
                        waiting.pop()
                    finished, _ = wait(under_way, return_when=FIRST_COMPLETED)
                    for future in finished:
                        result = future.result()
                        yield under_way.pop(future), result, True
            except BrokenProcessPool:  # it is unknown which task did it: repeat each one alone
                suspects += under_way.values()
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
    for task in suspects:
        yield from _alone(task)


def _alone(task) -> Iterator[tuple[Task, dict, bool]]:
    for _ in range(_ATTEMPTS - 1):
        with _pool(1) as pool:
            try:
                yield task, _submitted(pool, task).result(), True
                return
            except BrokenProcessPool:
                continue
    yield task, {"status": "failed", "reason": f"the worker process died {_ATTEMPTS} times; out of memory?"}, False


def _submitted(pool: ProcessPoolExecutor, task: Task) -> Future:
    """Submit a task; a worker that this starts imports the main module only if the task's function stands there.

    Otherwise it would run a user's script again that has no ``if __name__ == "__main__"``.
    """
    main = sys.modules["__main__"]
    if task.function.__module__ != "__main__":
        sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        return pool.submit(task.function, *task.arguments)
    finally:
        sys.modules["__main__"] = main


def _pool(workers) -> ProcessPoolExecutor:
    # Fork the workers from a clean server: the threads of this process (progress bar, compiler) would not survive a fork.
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("forkserver"), initializer=_begin_worker)


def _begin_worker() -> None:
    """Use one thread, leave Ctrl-C to the parent, and exit with the parent even if that is killed."""
    for name in _THREADS:
        os.environ[name] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow():
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


def _on_cluster(tasks, address) -> Iterator[tuple[Task, dict, bool]]:
    try:
        from distributed import Client, KilledWorker, as_completed
    except ImportError:
        raise ClusterError("--dask needs the package distributed: pip install 'bearing_sim[dask]'") from None
    try:
        client = Client(address, timeout=_DASK_TIMEOUT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterError(f"no Dask scheduler answers at {address} ({error}); start one with 'dask scheduler --host 127.0.0.1'") from None
    with client:
        under_way = {}
        for task in tasks:
            future = client.submit(task.function, *task.arguments, key=f"bearing_sim-{task.key}", pure=False)
            under_way[future] = task
        arriving = as_completed(list(under_way), loop=client.loop)
        for future in arriving:
            task = under_way.pop(future)
            error = future.exception() if future.status == "error" else None
            if isinstance(error, KilledWorker):
                yield task, {"status": "failed", "reason": f"its workers died: {error}"}, False
            else:
                yield task, future.result(), True
