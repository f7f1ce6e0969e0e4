# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a node as a process: start, spin, end in order on SIGINT and SIGTERM, say what is wrong in one message."""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import contextmanager

import rclpy
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from bearing_sim.sinks.priority import let_threads_give_way

_TIMERS = "dds.ev"  # how Fast DDS calls the thread of its timers
_LONG = 3600.0  # [s] without a limit, the events of a rclpy that was built against a glibc before 2.30 wait busily and hear nothing


class CannotRun(Exception):
    """A node that cannot do its work; the process ends with ``exit_code`` and the message."""

    def __init__(self, message: str, exit_code: int = 2):
        super().__init__(message)
        self.exit_code = exit_code


def make_executor() -> Executor:
    """Return the executor of the process: rclpy's own of events where it has one, as it does not list all it waits for at every message.

    Events are for the main thread only: elsewhere none are delivered.
    """
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def spin(executor: Executor, ended: Future) -> None:
    """Let an executor work until its context ends or ``ended`` is done."""
    if isinstance(executor, SingleThreadedExecutor):  # waiting for a future, it would remember every wake until then
        while rclpy.ok() and not ended.done():
            executor.spin_once()
        return
    while rclpy.ok() and not ended.done():
        executor.spin_until_future_complete(ended, _LONG)


@contextmanager
def signals_end(ended: Future):
    """Let SIGINT and SIGTERM make a future done, which ends `spin` at the node's next callback.

    rclpy's own handlers would take the context away in the middle of a message, and of an executor of events everything with it.
    """

    def end(*_) -> None:
        if not ended.done():
            ended.set_result(None)

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def run_node(name: str, make_node: Callable[[Future], Node], args: list[str] | None) -> int:
    """Make a node and spin it until a signal comes or it ends itself; then call its ``close``.

    Parameters
    ----------
    name : first word of error messages.
    make_node : ``make_node(ended)`` makes the node.  A callback that cannot go on gives the future a `CannotRun`, for an executor of events
        would log what a callback raises as a fault of the program.  The node has a timer, and ``close() -> bool``: whether every thread of
        it ended.
    args : command line; ``sys.argv`` where absent.

    Returns
    -------
    The exit code: 0, or that of a `CannotRun`.
    """
    ended = Future()
    with signals_end(ended):
        return _run(name, make_node, args, ended)


def _run(name: str, make_node: Callable[[Future], Node], args: list[str] | None, ended: Future) -> int:
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as fault:  # rclpy's own errors are of this kind
        return _complain(name, f"cannot start ROS: {' '.join(str(fault).split())}", 2)
    node, executor, code, closed = None, None, 0, True
    try:
        node = make_node(ended)
        # Every message published wakes them, to set a timer: where that interrupts who publishes, it is a fifth of the node's processor time.
        let_threads_give_way(_TIMERS)
        executor = make_executor()
        executor.add_node(node)
        spin(executor, ended)
        if ended.done():
            ended.result()
    except ExternalShutdownException:
        pass
    except CannotRun as fault:
        code = _complain(name, str(fault), fault.exit_code)
    finally:
        if node is not None:
            closed = node.close()
            if executor is not None:
                executor.shutdown()
            node.destroy_node()
        rclpy.try_shutdown()
    if not closed:
        # A thread deep in compiled code cannot be ended from here; recordings are complete, so leave without it.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _complain(name: str, text: str, code: int) -> int:
    print(f"{name}: {text}", file=sys.stderr, flush=True)
    return code
