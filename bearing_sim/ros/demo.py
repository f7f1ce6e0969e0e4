# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The demonstration: the node on the bundled mission, with a player publishing the inputs on real topics.

Run by ``launch_scripts/demo.sh`` or ``python -m bearing_sim.ros.demo``.  Everything stays on this machine's loopback
interface, in a ROS domain of its own.
"""

import ctypes
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from bearing_sim.ros.summary import Summary, summarize
from bearing_sim.scene_file import SceneError, load_scene

_DOMAINS = range(60, 100)  # above what people pick by hand, below where ports collide with those the system hands out
_NODE_ENDS_WITHIN = 30.0  # [s]
_PR_SET_PDEATHSIG = 1  # of Linux' prctl


class DemoFailed(Exception):
    """The demonstration did not come to its end; the message says what happened."""


class Demo:
    """One run of the demonstration.

    Parameters
    ----------
    folder : where mission, recording, view and log go; made if absent.
    scene : bundled scene or scene file.
    overrides : scene fields to change, each ``FIELD=VALUE``.
    """

    def __init__(self, folder: Path, scene: str, overrides: tuple[str, ...] = ()):
        self.folder = folder
        self.recording, self.view, self.log = folder / "run.mcap", folder / "run.rrd", folder / "node.log"
        self._scene, self._overrides = scene, overrides
        domain = os.environ.get("BEARING_SIM_DEMO_DOMAIN_ID") or str(random.SystemRandom().choice(_DOMAINS))
        self._environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": domain}

    def run(self, mission: Path) -> Summary:
        """Play a mission to a node and return what came of it.

        Raises
        ------
        DemoFailed
            Node or player ended otherwise than they should.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with self._node() as node:
            click.echo(f"bearing_node runs (log: {self.log}); on first use its code is compiled, which takes up to two minutes", err=True)
            self._play(mission, node)
            self._end(node)
        click.echo("writing the view", err=True)
        self._check("bearing_sim.cli", "view", str(self.recording), "-o", str(self.view), "--no-open")
        return summarize(self.recording)

    def write_mission(self, duration: float) -> Path:
        """Write the synthetic mission and return its path."""
        path = self.folder / "mission.mcap"
        self.folder.mkdir(parents=True, exist_ok=True)
        self._check("bearing_sim.cli", "mission", "-o", str(path), "--duration", str(duration))
        return path

    @contextmanager
    def _node(self) -> Iterator[subprocess.Popen]:
        # One level throughout, so that every demonstration shows the same; nor is a second level compiled beside a first start.
        parameters = {"scene": self._scene, "record": str(self.recording), "governor": "false"}
        if self._overrides:
            parameters["overrides"] = "[" + ", ".join(f"'{text}'" for text in self._overrides) + "]"
        words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
        with open(self.log, "wb") as log:
            node = self._start("bearing_sim.ros.node", "--ros-args", *words, stdout=log, stderr=subprocess.STDOUT)
            try:
                yield node
            finally:
                _stop(node)

    def _play(self, mission: Path, node: subprocess.Popen) -> None:
        player = self._start("bearing_sim.ros.player", str(mission), "--wait-limit", "600")
        try:
            while player.poll() is None:
                if node.poll() is not None:
                    raise DemoFailed(f"bearing_node ended early with code {node.returncode}:\n{_tail(self.log)}")
                time.sleep(0.1)
        finally:
            _stop(player)
        if player.returncode != 0:
            raise DemoFailed(f"bearing_player ended with code {player.returncode}")

    def _end(self, node: subprocess.Popen) -> None:
        _stop(node)
        if node.returncode != 0:
            raise DemoFailed(f"bearing_node ended with code {node.returncode}:\n{_tail(self.log)}")
        if not self.recording.is_file():
            raise DemoFailed(f"bearing_node left no {self.recording}:\n{_tail(self.log)}")

    def _start(self, module: str, *arguments: str, **streams) -> subprocess.Popen:
        # A session of their own: Ctrl-C reaches this process alone, which then ends the others in order, each by one signal.
        return subprocess.Popen(
            [sys.executable, "-m", module, *arguments], env=self._environment, start_new_session=True, preexec_fn=_end_with_parent, **streams
        )

    def _check(self, module: str, *arguments: str) -> None:
        done = self._start(module, *arguments, stdout=subprocess.DEVNULL)
        try:
            done.wait()
        finally:
            _stop(done)
        if done.returncode != 0:
            raise DemoFailed(f"{' '.join(arguments[:1])} ended with code {done.returncode}")


def _end_with_parent() -> None:
    """Let the kernel end this process in order when the demonstration is killed by force: a node left behind would record for ever."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


def _stop(process: subprocess.Popen) -> None:
    """End a process in order, by force only if it does not."""
    if process.poll() is None:
        process.terminate()
    try:
        process.wait(_NODE_ENDS_WITHIN)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _tail(log: Path, lines: int = 15) -> str:
    return "\n".join(log.read_text(errors="replace").splitlines()[-lines:])


def _has_display() -> bool:
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _show(view: Path, opens: bool) -> None:
    """Open the view, or say how to."""
    rerun = Path(sys.executable).with_name("rerun")
    command = [str(rerun) if rerun.exists() else "rerun", str(view)]
    if opens:
        subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        click.echo("the recording opens in rerun; to open it again:")
    else:
        click.echo("open the recording with:")
    click.echo(f"  {_shell(command)}")


def _shell(command: list[str]) -> str:
    import shlex

    return shlex.join(command)


def _interrupt(*_) -> None:
    raise KeyboardInterrupt


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--out", type=click.Path(path_type=Path), default=Path("runs"), show_default=True, help="Folder of runs; each gets one of its own.")
@click.option("--scene", default="deng2017_table1", show_default=True, help="Bundled scene or scene file.")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Change a field of the scene; may be repeated.")
@click.option("--mission", type=click.Path(path_type=Path, exists=True), help="Input log to play instead of the bundled mission.")
@click.option("--duration", type=click.FloatRange(1.0, 3600.0), default=60.0, show_default=True, help="Length of the bundled mission [s].")
@click.option("--open/--no-open", "opens", default=None, help="Open the recording in rerun [default: when there is a display].")
def command(out, scene, overrides, mission, duration, opens):
    """Run the node on the bundled synthetic mission, record it, and show what came of it."""
    try:
        load_scene(scene, overrides)
    except SceneError as fault:
        click.echo(f"demo: {fault}", err=True)
        sys.exit(2)
    demo = Demo(_run_folder(out), scene, overrides)
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        summary = demo.run(mission or demo.write_mission(duration))
    except DemoFailed as fault:
        click.echo(f"demo: {fault}", err=True)
        sys.exit(1)
    except KeyboardInterrupt:
        click.echo(f"demo: interrupted; what was recorded is in {demo.folder}", err=True)
        sys.exit(130)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    click.echo(summary.table())
    click.echo(f"recording: {demo.recording}")
    _show(demo.view, _has_display() if opens is None else opens)


def _run_folder(out: Path) -> Path:
    name = time.strftime("%Y-%m-%d_%H-%M-%S")
    folder, number = out / name, 1
    while folder.exists():
        number += 1
        folder = out / f"{name}_{number}"
    return folder


if __name__ == "__main__":
    command(prog_name="demo")
