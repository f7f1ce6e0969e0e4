# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Processes that run a module, forked from a server that has imported what they share: the imports take an interpreter two seconds.

Each is a process of its own, with its own group, environment, folder and files, and its interpreter ends in order.  Run as a program, this
module is the server, or, with ``--run``, a client that hands its own files to the server and ends with the exit code of what runs there.
"""

import importlib
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

_MESSAGE = 1 << 17  # bytes at most of a request


class PreloadingServer:
    """Starts processes that need not import ``modules`` again; it ends with the process that made it.

    Parameters
    ----------
    modules : to be imported ahead.
    path : folders where they are, before those of the environment.
    """

    def __init__(self, modules: list[str], path: list[Path]):
        self._folder = tempfile.TemporaryDirectory(prefix="preloaded_")
        self.address = str(Path(self._folder.name) / "server")
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
            listener.bind(self.address)
            listener.listen(64)
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*map(str, path), *filter(None, [os.environ.get("PYTHONPATH")])])}
            command = [sys.executable, __file__, str(listener.fileno()), *modules]
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, env=environment, pass_fds=[listener.fileno()]
            )  # fmt: skip

    def start(self, module: str, *arguments: str, output, folder: Path, environment: dict[str, str], limit: int) -> "PreloadedProcess":
        """Run ``python -m MODULE ARGUMENTS`` in a folder, everything it prints in the open file ``output``; killed after ``limit`` seconds."""
        with open(os.devnull) as nothing:
            files = [nothing.fileno(), output.fileno(), output.fileno()]
            return PreloadedProcess(self.address, [module, *arguments], files, str(folder), environment, limit)


class PreloadedProcess:
    """A process of a `PreloadingServer`, under a watchdog; has what tests use of `subprocess.Popen`.

    Attributes
    ----------
    pid : number of the watchdog, which leads the group and passes on signals; the one child of it runs the module.
    returncode : exit code of the module, None while it runs.
    """

    def __init__(self, address: str, words: list[str], files: list[int], folder: str, environment: dict[str, str], limit: int):
        self._connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._connection.connect(address)
        request = {"words": words, "folder": folder, "environment": environment, "limit": limit}
        socket.send_fds(self._connection, [json.dumps(request).encode()], files)
        answer = self._connection.recv(64)
        if not answer:
            raise RuntimeError(f"the server that imports ahead did not start {words[0]}")
        self.pid, self.returncode = int(answer), None

    def poll(self) -> int | None:
        """Return the exit code, None while it runs."""
        if self.returncode is None and select.select([self._connection], [], [], 0.0)[0]:
            self.wait()
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Return the exit code when the process has ended; raise `subprocess.TimeoutExpired` if it does not within ``timeout`` seconds."""
        if self.returncode is None:
            if not select.select([self._connection], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(str(self.pid), timeout)
            self.returncode = int(self._connection.recv(64) or -signal.SIGKILL)  # silent: the watchdog was killed, with its group
            self._connection.close()
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal to the process."""
        os.kill(self.pid, number)


def _serve(listener: socket.socket) -> list[str]:
    """Start processes until standard input ends; return only in such a process, with its module and arguments."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the watchdogs
    while True:
        if sys.stdin in select.select([listener, sys.stdin], [], [])[0]:
            os._exit(0)
        connection, _ = listener.accept()
        with connection:
            text, files, _, _ = socket.recv_fds(connection, _MESSAGE, 3)
            if text and os.fork() == 0:
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                os.setpgid(0, 0)
                request, child = json.loads(text), os.fork()
                if child != 0:
                    _watch(child, request["limit"], connection)
                listener.close()
                connection.close()
                return _take_over(request, files)
        for file in files:
            os.close(file)


def _watch(child: int, limit: int, connection: socket.socket) -> None:
    """Pass on signals, kill the group after ``limit`` seconds, report the exit code, and end."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: os.kill(child, number))
    signal.signal(signal.SIGALRM, lambda *_: os.killpg(0, signal.SIGKILL))
    signal.alarm(limit)
    connection.send(str(os.getpid()).encode())
    _, status = os.waitpid(child, 0)
    try:
        connection.send(str(os.waitstatus_to_exitcode(status)).encode())
    except BrokenPipeError:
        pass  # whoever asked for it has gone
    os._exit(0)


def _take_over(request: dict, files: list[int]) -> list[str]:
    """Take files, folder and environment of a request; return its module and arguments."""
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    os.environ.clear()
    os.environ.update(request["environment"])
    os.chdir(request["folder"])
    sys.path[0] = request["folder"]  # as `python -m` has it
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a server that began in the background of a shell ignores it
    return request["words"]


def _run_as_client(address: str, words: list[str]) -> int:
    """Run a module on a server with the files, the folder and the environment of this process; return its exit code."""
    return PreloadedProcess(address, words, [0, 1, 2], os.getcwd(), dict(os.environ), 900).wait()


if __name__ == "__main__":
    if sys.argv[1] == "--run":
        sys.exit(_run_as_client(sys.argv[2], sys.argv[3:]))
    for name in sys.argv[2:]:
        importlib.import_module(name)
    sys.argv = _serve(socket.socket(fileno=int(sys.argv[1])))
    sys.modules.pop(sys.argv[0], None)  # it is executed again, under the name __main__
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
