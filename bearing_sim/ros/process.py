# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a node as a process: start, spin, end in order on SIGINT and SIGTERM, say what is wrong in one message."""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import contextmanager

import rclpy
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.task import Future

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
def signals_left_to_ros():
    """Keep Python from raising KeyboardInterrupt: rclpy turns SIGINT and SIGTERM into an orderly shutdown of its context.

    An exception on top of that could break into the closing of a recording.
    """
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def run_node(name: str, make_node: Callable[[], Node], args: list[str] | None) -> int:
    """Make a node and spin it until a signal comes or it ends itself; then call its ``close``.

    Parameters
    ----------
    name : first word of error messages.
    make_node : makes the node; it has ``ended``, a future that a callback may give a `CannotRun`, for an executor of events would log what
        a callback raises as a fault of the program; and ``close() -> bool``, whether every thread of it ended.
    args : command line; ``sys.argv`` where absent.

    Returns
    -------
    The exit code: 0, or that of a `CannotRun`.
    """
    with signals_left_to_ros():
        return _run(name, make_node, args)


def _run(name: str, make_node: Callable[[], Node], args: list[str] | None) -> int:
    try:
        rclpy.init(args=args)
    except RuntimeError as fault:  # rclpy's own errors are of this kind
        return _complain(name, f"cannot start ROS: {' '.join(str(fault).split())}", 2)
    node, code, ended = None, 0, True
    try:
        node = make_node()
        executor = make_executor()
        executor.add_node(node)
        spin(executor, node.ended)
        if node.ended.done():
            node.ended.result()
    except ExternalShutdownException:
        pass
    except CannotRun as fault:
        code = _complain(name, str(fault), fault.exit_code)
    except rclpy_implementation.RCLError:
        if rclpy.ok():  # otherwise a signal took the context away while a message was on its way out
            raise
    finally:
        if node is not None:
            ended = node.close()
            node.destroy_node()
        rclpy.try_shutdown()
    if not ended:
        # A thread deep in compiled code cannot be ended from here; recordings are complete, so leave without it.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _complain(name: str, text: str, code: int) -> int:
    print(f"{name}: {text}", file=sys.stderr, flush=True)
    return code
