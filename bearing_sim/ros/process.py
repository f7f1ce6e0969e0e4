# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a node as a process: start, spin, end cleanly on SIGINT and SIGTERM, report an error in one message."""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import contextmanager

import rclpy
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.recording.priority import lower_thread_priority
from bearing_sim.ros.network import use_loopback
from bearing_sim.ros.rclpy_internals import RclError, make_executor
from bearing_sim.ros.shared_memory import remove_unfinished_ports

_TIMERS = "dds.ev"  # name of the timer thread of Fast DDS
_LONG = 3600.0  # [s] without a limit, the EventsExecutor of an rclpy built against glibc before 2.30 waits busily and receives nothing


class CannotRun(Exception):
    """The node cannot run; the process ends with ``exit_code`` and the message."""

    def __init__(self, message: str, exit_code: int = 2):
        super().__init__(message)
        self.exit_code = exit_code


def spin(executor: Executor, ended: Future) -> None:
    """Spin until the context ends or ``ended`` is done."""
    if isinstance(executor, SingleThreadedExecutor):  # waiting for a future would accumulate a callback per wake-up
        while rclpy.ok() and not ended.done():
            executor.spin_once()
        return
    while rclpy.ok() and not ended.done():
        executor.spin_until_future_complete(ended, _LONG)


@contextmanager
def signals_end(ended: Future):
    """Complete a future on SIGINT and SIGTERM, which ends `spin` at the node's next callback, and a player before its next message.

    rclpy's own handlers would shut down the context in the middle of a message, and crash an EventsExecutor.
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


@standard_streams()
def run_node(name: str, make_node: Callable[[Future], Node], args: list[str] | None) -> int:
    """Make a node and spin it until a signal arrives or it ends itself; then call its ``close``.

    Parameters
    ----------
    name : first word of error messages.
    make_node : ``make_node(ended)`` makes the node.  A callback that cannot continue sets a `CannotRun` on the future; an EventsExecutor
        would log a raised exception as a programming error.  The node has a timer, and ``close() -> bool``: whether all its threads ended.
    args : command line; None: ``sys.argv``.

    Returns
    -------
    The exit code: 0, or that of `CannotRun`.
    """
    ended = Future()
    with signals_end(ended):
        return _run(name, make_node, args, ended)


def _run(name: str, make_node: Callable[[Future], Node], args: list[str] | None, ended: Future) -> int:
    note = use_loopback()
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:  # the base of rclpy's own errors
        return _complain(name, _cannot_start(error), 2)
    node, executor, code, closed = None, None, 0, True
    try:
        if note:
            get_logger(name).info(note)
        for warning in remove_unfinished_ports():
            get_logger(name).warning(warning)
        try:
            node = make_node(ended)
        except RclError as error:  # such as a middleware that cannot do what the environment asks for
            raise CannotRun(_cannot_start(error)) from error
        # Every published message wakes the timer thread; if it preempts the publisher, that costs a fifth of the node's processor time.
        lower_thread_priority(_TIMERS)
        executor = make_executor()
        executor.add_node(node)
        spin(executor, ended)
        if ended.done():
            ended.result()
    except ExternalShutdownException:
        pass
    except CannotRun as error:
        code = _complain(name, str(error), error.exit_code)
    finally:
        if node is not None:
            closed = node.close()
            if executor is not None:
                executor.shutdown()
            node.destroy_node()
        rclpy.try_shutdown()
    if not closed:
        # A thread inside compiled code cannot be ended from here; recordings are complete, so exit without it.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _cannot_start(error: RuntimeError) -> str:
    return f"cannot start ROS: {' '.join(str(error).split())}"


def _complain(name: str, text: str, code: int) -> int:
    print(f"{name}: {text}", file=sys.stderr, flush=True)
    return code
