# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Processes that share the bearings of one node, so that a fleet uses more than one core.

Python runs one thread of a process at a time, so the threads of one process end near one core however many the machine has.  A node with many
bearings therefore starts worker processes (parameter ``processes``), each with a share of the bearings, and does nothing itself but answer for
them: it has the lifecycle, the parameters and their checks.  A worker is a `bearing_sim.ros.node.BearingNode` with a hidden name, without
lifecycle and parameter services of its own; it subscribes, publishes, records and reports for its bearings under the names that they have in
one process.  Node and worker exchange short messages over a pipe.

A worker that ends is reported for each of its bearings and started again, at first after a second, later after up to a minute; the others run on.
A worker ends by itself when its pipe closes, so that none is left when the node is killed.
"""

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from multiprocessing.connection import Connection, Pipe
from typing import NamedTuple

_ENDS_WITHIN = 8.0  # [s] with recordings completed
_ANSWERS_WITHIN = 2.0  # [s]
_FIRST_WAIT, _LONGEST_WAIT = 1.0, 60.0  # [s] before a worker is started again
_HAS_PROVEN = 60.0  # [s] after which a worker that ends is started again after the first wait
BEARINGS_EACH = 10
"""Bearings of a node for which it has a process, unless ``processes`` says otherwise; no more processes than cores."""


class Order(NamedTuple):
    """What a worker process is started with."""

    name: str  # of its ROS node
    namespace: str
    component: str  # first half of the names of its statuses, without the bearing
    arguments: list[str]  # remappings and log settings, as on the command line after --ros-args
    parameters: dict[str, object]
    restarts: int  # how often it was started before
    reported: dict[str, set[str]]  # subjects of statuses that have been reported, by component; the node's own


class Ended(NamedTuple):
    """What a worker says before it ends because it cannot run."""

    text: str
    exit_code: int


def process_count(wanted: int, bearings: int, cores: int) -> int:
    """Return the number of processes for the bearings of a node.

    Parameters
    ----------
    wanted : by the user; 0 to decide by the numbers of bearings and cores.
    """
    return min(wanted, bearings) if wanted else min(-(-bearings // BEARINGS_EACH), cores)


def shares(names: Sequence[str], processes: int) -> list[list[str]]:
    """Return the bearings of each process: neighbours apart, numbers as equal as they can be."""
    return [list(names[k::processes]) for k in range(processes)]


def passed_arguments(arguments: Sequence[str], node_name: str) -> list[str]:
    """Return those ROS arguments of a command line that workers need: remappings, log settings and the enclave, but no parameters and no names.

    Parameters
    ----------
    arguments : the whole command line.
    node_name : of the node; remappings for this node alone are meant for its workers.
    """
    passed, is_ros = [], False
    words = iter(arguments)
    for word in words:
        if word in ("--ros-args", "--"):
            is_ros = word == "--ros-args"
        elif is_ros and word in ("-r", "--remap"):
            rule = next(words, "").removeprefix(f"{node_name}:")
            if not rule.startswith(("__node:=", "__name:=", "__ns:=")):
                passed += [word, rule]
        elif is_ros and word in ("-p", "--param", "--params-file"):
            next(words, "")
        elif is_ros and word in ("-e", "--enclave", "--log-level", "--log-config-file", "--log-file-name"):
            passed += [word, next(words, "")]
        elif is_ros:
            passed.append(word)
    return passed


class Worker:
    """A worker process, seen from the node.

    Parameters
    ----------
    bearings : names of its bearings.
    order : what to start it with.
    clock : monotonic [s].

    Attributes
    ----------
    is_configured : bool
        Whether its topics are there and it reports for its bearings.
    is_warm : bool
        Whether a model of its bearings has been compiled.
    wanted_active : bool
        Whether it is to be active.
    loss : str
        How it ended, as long as it has not been configured again.
    errors : list[str]
        Why its models cannot be computed, if none of them can.
    """

    def __init__(self, bearings: Sequence[str], order: Order, clock: Callable[[], float] = time.monotonic):
        self.bearings, self._order, self._clock = list(bearings), order, clock
        self.wanted_active = self.is_configured = self.is_warm = False
        self.loss, self.errors = "", []
        self._wait, self._started_at, self._start_at = _FIRST_WAIT, clock(), 0.0
        self._ended: Ended | None = None
        self._questions = 0
        self._answers: dict[int, str] = {}
        self._process: subprocess.Popen | None = None
        self._connection: Connection | None = None
        self._start()

    @property
    def pid(self) -> int | None:
        """Its process; None while it waits to be started again."""
        return self._process.pid if self._process is not None else None

    def adjust(self, parameters: Mapping[str, object]) -> None:
        """Let it take over parameters, now and whenever it is started again."""
        self._order.parameters.update(parameters)
        self._send("set", dict(parameters))

    def activate(self, wanted: bool) -> None:
        """Activate or deactivate it."""
        self.wanted_active = wanted
        if self.is_configured:
            self._send("activate" if wanted else "deactivate")

    def show_error(self, text: str) -> None:
        """Let it report why the node's last transition failed; empty if it did not."""
        self._send("error", text)

    def reason_to_refuse(self, changes: Mapping[str, object]) -> str:
        """Return why it refuses parameter changes; empty if it accepts them or does not run."""
        if not self.is_configured:
            return ""
        self._questions += 1
        self._send("check", self._questions, dict(changes))
        end = self._clock() + _ANSWERS_WITHIN
        while self._questions not in self._answers:
            if self._connection is None:
                return ""
            if not self._has_news(max(end - self._clock(), 0.0)):
                return f"the process of {self.named} does not answer; try again"
            self._receive()
        return self._answers.pop(self._questions)

    def review(self) -> Ended | None:
        """Take what it has said; start it again if it has ended and it is time.  Returns why it cannot run, if it has said so now."""
        if self._process is None and self._clock() >= self._start_at:
            self._start()
        while self._has_news(0.0):
            self._receive()
        ended, self._ended = self._ended, None
        return ended

    @property
    def named(self) -> str:
        """Its bearings, for people."""
        return ", ".join(self.bearings)

    def end(self) -> None:
        """Ask it to end; see `wait`."""
        self._send("end")

    def wait(self, until: float) -> bool:
        """Wait until an instant [s, monotonic] for its end; kill it then.  Returns whether it ended by itself."""
        if self._process is None:
            return True
        try:
            self._process.wait(max(until - self._clock(), 0.0))
            return True
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            return False
        finally:
            self._forget()

    def _start(self) -> None:
        self._connection, theirs = Pipe()
        self._started_at = self._clock()
        command = [sys.executable, "-m", "bearing_sim.ros.node", _WORKER_OPTION, str(theirs.fileno())]
        self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()])
        theirs.close()
        self._send(self._order)

    def _send(self, *message) -> None:
        if self._connection is not None:
            try:
                self._connection.send(message)
            except OSError:  # it has ended, which `review` finds
                pass

    def _has_news(self, wait: float) -> bool:
        return self._connection is not None and self._connection.poll(wait)

    def _receive(self) -> None:
        try:
            kind, *rest = self._connection.recv()
        except (EOFError, OSError):
            self._lose()
            return
        if kind == "configured":
            self.is_configured, self.loss = True, ""
            if self.wanted_active:
                self._send("activate")
        elif kind == "warm":
            self.is_warm = True
        elif kind == "reported":
            self._order.reported.setdefault(rest[0], set()).update(rest[1])
        elif kind == "failed":
            self._ended = Ended(*rest)
        elif kind == "errors":
            self.errors = rest[0]
        elif kind == "answer":
            self._answers[rest[0]] = rest[1]

    def _lose(self) -> None:
        """Note how it has ended, and when to start it again."""
        code = self._process.wait()
        how = f"was killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
        if self._clock() - self._started_at > _HAS_PROVEN:
            self._wait = _FIRST_WAIT
        self.loss = f"the process of {self.named} {how}; it is started again after {self._wait:g} s"
        self._start_at = self._clock() + self._wait
        self._wait = min(2.0 * self._wait, _LONGEST_WAIT)
        self._order = self._order._replace(restarts=self._order.restarts + 1)
        self._forget()

    def _forget(self) -> None:
        self._connection.close()
        self._process = self._connection = None
        self.is_configured = False


class Workers:
    """All worker processes of a node; empty for a node whose bearings are in its own process."""

    def __init__(self, workers: Iterable[Worker] = ()):
        self._workers = list(workers)

    def __bool__(self) -> bool:
        return bool(self._workers)

    def __iter__(self):
        return iter(self._workers)

    def activate(self, wanted: bool) -> None:
        """Activate or deactivate all of them."""
        for worker in self._workers:
            worker.activate(wanted)

    def end(self) -> bool:
        """End all of them.  Returns whether all ended by themselves."""
        for worker in self._workers:
            worker.end()
        until = time.monotonic() + _ENDS_WITHIN
        ended = [worker.wait(until) for worker in self._workers]
        self._workers = []
        return all(ended)


_WORKER_OPTION = "--worker"


def worker_connection(arguments: Sequence[str]) -> Connection | None:
    """Return the pipe to the node if these are the arguments of a worker process, otherwise None."""
    if len(arguments) != 2 or arguments[0] != _WORKER_OPTION:
        return None
    return Connection(int(arguments[1]))


class NodeLink:
    """The worker's end of the pipe.

    Parameters
    ----------
    connection : to the node.
    """

    def __init__(self, connection: Connection):
        self._connection = connection
        (self.order,) = connection.recv()

    def send(self, *message) -> None:
        """Say something to the node."""
        try:
            self._connection.send(message)
        except OSError:  # it has ended, which `listen` finds
            pass

    def listen(self, receive: Callable[[tuple], None], ended: Callable[[], None]) -> None:
        """Pass every message to ``receive`` and the end of the node to ``ended``, on a thread of its own."""

        def work() -> None:
            while True:
                try:
                    receive(self._connection.recv())
                except (EOFError, OSError):
                    ended()
                    return

        threading.Thread(target=work, name="node-link", daemon=True).start()
