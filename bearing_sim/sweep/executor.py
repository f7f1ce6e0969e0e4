# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tasks on all cores, or on a Dask cluster: results go into the journal as they come, the finished are never computed again.

Imports nothing of the model: a worker sets its threads before the first array library is loaded.
"""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from bearing_sim.cores import cores
from bearing_sim.sweep.journal import Journal
from bearing_sim.sweep.tasks import Task

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_AHEAD = 2  # tasks that wait for each worker: few are under way, and so few are lost, when everything is killed
_ATTEMPTS = 2  # at a task whose worker dies
_DASK_TIMEOUT = 20  # s to reach the scheduler


class ClusterError(RuntimeError):
    """A Dask cluster that cannot be used; the message says what to do."""


def run_tasks(
    tasks: Sequence[Task],
    journal: Journal,
    workers: int | None = None,
    dask: str | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> list[dict]:
    """Return the results of tasks, in their order; those in the journal are taken from there, equal tasks are computed once.

    A task whose worker dies is tried again alone; if it takes that one along too, its result is ``{"status": "failed", "reason": ...}``,
    which the journal does not keep.

    Parameters
    ----------
    tasks : what to compute.
    journal : where finished results are, and go.
    workers : processes; as many as there are cores where absent, and none besides this one for 1.
    dask : address of a Dask scheduler that computes instead; its workers need this package.
    tell : takes how many of the tasks not in the journal are done, and how many there are.

    Raises
    ------
    ClusterError
        ``distributed`` is not installed, or the scheduler cannot be reached.
    """
    pending = {task.key: task for task in tasks if task.key not in journal}
    lost: dict[str, dict] = {}
    tell(0, len(pending))
    for done, (task, result, keep) in enumerate(_computed(list(pending.values()), workers or cores(), dask), 1):
        if keep:
            journal.add(task.key, result)
        else:
            lost[task.key] = result
        tell(done, len(pending))
    return [lost[task.key] if task.key in lost else journal[task.key] for task in tasks]


def _computed(tasks, workers, dask) -> Iterator[tuple[Task, dict, bool]]:
    """Yield tasks with their results as they come, and whether these are worth keeping."""
    if dask is not None:
        yield from _on_cluster(tasks, dask)
        return
    if workers == 1 or len(tasks) < 2:
        for task in tasks:
            yield task, task.function(*task.arguments), True
        return
    # One task of each kind is computed here: its machine code then lies on the disk before all workers look for it.
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
                        under_way[pool.submit(task.function, *task.arguments)] = task
                        waiting.pop()
                    finished, _ = wait(under_way, return_when=FIRST_COMPLETED)
                    for future in finished:
                        result = future.result()
                        yield under_way.pop(future), result, True
            except BrokenProcessPool:  # who of those under way did it is not known: each goes alone
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
                yield task, pool.submit(task.function, *task.arguments).result(), True
                return
            except BrokenProcessPool:
                continue
    yield task, {"status": "failed", "reason": f"the worker process died {_ATTEMPTS} times; killed for want of memory?"}, False


def _pool(workers) -> ProcessPoolExecutor:
    # A server that was started clean forks the workers: this process has threads (progress, the compiler's), which do not survive a fork.
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("forkserver"), initializer=_begin_worker)


def _begin_worker() -> None:
    """Make this worker use one thread, leave Ctrl-C to its parent, and end with it even if that is killed."""
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
    except (OSError, TimeoutError, ValueError) as fault:
        raise ClusterError(f"no Dask scheduler answers at {address} ({fault}); start one with 'dask scheduler'") from None
    with client:
        under_way = {}
        for task in tasks:
            future = client.submit(task.function, *task.arguments, key=f"bearing_sim-{task.key}", pure=False)
            under_way[future] = task
        arriving = as_completed(list(under_way), loop=client.loop)
        for future in arriving:
            task = under_way.pop(future)
            fault = future.exception() if future.status == "error" else None
            if isinstance(fault, KilledWorker):
                yield task, {"status": "failed", "reason": f"its workers died: {fault}"}, False
            else:
                yield task, future.result(), True
