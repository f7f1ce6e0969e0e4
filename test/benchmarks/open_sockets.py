# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the programs open to the network: ``python test/benchmarks/open_sockets.py`` lists the sockets of each, as the kernel has them.

Listed are all sockets that receive: listening TCP sockets and every bound datagram socket, of a program and of all processes that it has
started.  The programs run with discovery at LOCALHOST and otherwise as a user starts them: a node with a recording and a view for viewers and
browsers, a node whose bearings have processes of their own, a player, the command that measures a node, ``bearing-sim view`` for a browser,
rerun's own viewer by the command that the programs use, and scheduler, worker and client of a Dask cluster as the how-to has them.  The exit
code is 1 if a socket is open beyond the loopback interface.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from recordings import steady_log  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from sockets import Socket, open_sockets  # noqa: E402

from bearing_sim.cli.reporting import print_rows  # noqa: E402
from bearing_sim.view.viewer import HOST, free_port, viewer_command  # noqa: E402

_PATIENCE = 120.0  # [s] on a busy machine
_REST = 0.5  # [s] for what opens besides what is waited for
_PLAYER = "bearing_sim.ros.player"


class NotOpened(Exception):
    """A program has ended, or has not opened what was expected."""


def when_open(process, is_complete: Callable[[list[Socket]], bool], text: Callable[[], str]) -> list[Socket]:
    """Return the sockets of a program once they are complete.

    Raises
    ------
    NotOpened
        It has ended, or they are not complete in time; with what it printed.
    """
    end = time.monotonic() + _PATIENCE
    while not is_complete(open_sockets(process.pid)):
        if process.poll() is not None or time.monotonic() > end:
            raise NotOpened(f"exit code {process.poll()}, {open_sockets(process.pid)}\n{text()}")
        time.sleep(0.05)
    time.sleep(_REST)
    return open_sockets(process.pid)


@contextmanager
def node_and_player_running(folder: Path) -> Iterator[tuple[NodeProcess, NodeProcess, Client]]:
    """Run a node with a recording and a view, and a player that feeds it; yields them, and a client that hears what the node computes."""
    domain, ports = fresh_domain(), (free_port(), free_port())
    settings = ("overrides:=[level=steady]", f"record:={folder / 'node.mcap'}", f"rerun_port:={ports[0]}", f"rerun_web_port:={ports[1]}")
    log = steady_log(folder / "log.mcap", duration=60.0)
    client = Client(domain)
    node = NodeProcess(folder, domain, "--ros-args", *(word for setting in settings for word in ("-p", setting)))
    player = NodeProcess(folder, domain, str(log), "--loop", module=_PLAYER)
    try:
        client.spin_until(lambda: client.received["bearing_joints"], "the node computes what the player sends", node, _PATIENCE)
        when_open(node.process, lambda found: set(ports) <= {each.port for each in found if each.kind == "tcp"}, lambda: node.text)
        yield node, player, client
    finally:
        client.close()
        player.end()
        node.end()


def node_and_player(folder: Path) -> dict[str, list[Socket]]:
    """Return the sockets of a node with a recording and a view, and of a player that feeds it."""
    with node_and_player_running(folder) as (node, player, _):
        return {"node with a view": open_sockets(node.process.pid), "player": open_sockets(player.process.pid)}


def node_of_many(folder: Path) -> dict[str, list[Socket]]:
    """Return the sockets of a node whose bearings have processes of their own."""
    domain = fresh_domain()
    settings = ("bearings:=[front, rear]", "processes:=2", "front.overrides:=[level=steady]", "rear.overrides:=[level=steady]")
    client = Client(domain, "front")
    node = NodeProcess(folder, domain, "--ros-args", *(word for setting in settings for word in ("-p", setting)))
    try:
        client.drive_until(lambda: client.received["bearing_joints"], "the node computes", node)
        return {"node with two workers": open_sockets(node.process.pid)}
    finally:
        client.close()
        node.end()


@contextmanager
def _program(folder: Path, *command: str) -> Iterator[tuple[subprocess.Popen, Callable[[], str]]]:
    """Run a program; yields it and a function that returns what it has printed."""
    with tempfile.NamedTemporaryFile(dir=folder) as log:
        process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=subprocess.STDOUT)
        try:
            yield process, lambda: Path(log.name).read_text(errors="replace")
        finally:
            process.terminate()
            process.wait(_PATIENCE)


def measuring(folder: Path) -> dict[str, list[Socket]]:
    """Return the sockets of the command that measures how many bearings a node monitors, and of its node."""
    os.environ["ROS_DOMAIN_ID"] = str(fresh_domain())
    with _program(folder, sys.executable, "-m", "measure", "--set", "level=steady", "--bearings", "1") as (process, text):
        return {"measuring a node": when_open(process, lambda found: len(found) > 8, text)}


def views(folder: Path) -> dict[str, list[Socket]]:
    """Return the sockets of a recording's view in a browser and in rerun's own viewer."""
    bearing_sim, port = [sys.executable, "-m", "bearing_sim.cli"], free_port()
    subprocess.run(
        [*bearing_sim, "run", "deng2017_table1", "--set", "level=steady", "--duration", "0.2", "--out", "run.mcap"],
        cwd=folder,
        check=True,
        stdout=subprocess.DEVNULL,
    )
    found = {}
    with _program(folder, *bearing_sim, "view", "run.mcap", "--web", "--web-port", str(port), "--no-open") as (process, text):
        found["bearing-sim view --web"] = when_open(process, bool, text)
    with _program(folder, *viewer_command("run.rrd"), "--headless") as (process, text):
        found["rerun's viewer"] = when_open(process, bool, text)
    return found


def cluster(folder: Path) -> dict[str, list[Socket]]:
    """Return the sockets of scheduler, worker and client of a Dask cluster."""
    dask, port = [sys.executable, "-m", "dask"], str(free_port())
    with (
        _program(folder, *dask, "scheduler", "--host", HOST, "--port", port, "--dashboard-address", f"{HOST}:0") as (scheduler, scheduler_text),
        _program(folder, *dask, "worker", f"tcp://{HOST}:{port}", "--host", HOST, "--dashboard-address", f"{HOST}:0") as (worker, worker_text),
    ):
        sweep = (sys.executable, "-m", "bearing_sim.cli", "sweep", "deng2017_table1", "--level", "steady", "--dask", f"tcp://{HOST}:{port}")
        found = {"dask scheduler": when_open(scheduler, bool, scheduler_text)}
        found["dask worker"] = when_open(worker, lambda _: "Registered to" in worker_text(), worker_text)
        with _program(folder, *sweep, "--vary", "operating.shaft_speed=20000rpm:45000rpm:6") as (client, text):
            while client.poll() is None:
                time.sleep(0.05)
                found.setdefault("sweep on the cluster", [])
                found["sweep on the cluster"] += [each for each in open_sockets(client.pid) if each not in found["sweep on the cluster"]]
            if client.returncode:
                raise NotOpened(text())
    return found


@click.command()
def main():
    """List the sockets of all programs."""
    rows, is_open = [], False
    for programs in (node_and_player, node_of_many, measuring, views, cluster):
        with tempfile.TemporaryDirectory() as folder:
            try:
                found = programs(Path(folder))
            except NotOpened as error:
                found = {programs.__name__: []}
                click.echo(f"{programs.__name__}: {error}", err=True)
        for program, sockets in found.items():
            beyond = [each for each in sockets if not each.is_on_loopback]
            is_open |= bool(beyond)
            kinds = ", ".join(f"{kind} {sum(each.kind == kind for each in sockets)}" for kind in sorted({each.kind for each in sockets}))
            rows.append((program, kinds or "none", ", ".join(sorted({each.address for each in sockets})), str(len(beyond))))
    print_rows("Sockets that receive", ("program", "sockets", "addresses", "beyond loopback"), rows)
    sys.exit(is_open)


if __name__ == "__main__":
    main()
