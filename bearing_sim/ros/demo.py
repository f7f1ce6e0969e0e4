# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The demonstration: the node on the bundled mission, with a player that publishes the inputs, a recording, a view and a summary.

Run it with ``launch_scripts/demo.sh`` or ``python -m bearing_sim.ros.demo``.  Everything stays on this machine's loopback interface, in
a ROS domain of its own.
"""

import ctypes
import math
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

import click
import numpy as np

from bearing_sim.files.outside import OPTION
from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.messages import topics
from bearing_sim.messages.bands import ESTIMATES
from bearing_sim.messages.diagnostics import WHOLE
from bearing_sim.messages.events import Event, Level
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.recording.reader import Recording
from bearing_sim.ros.recordings import fresh_path
from bearing_sim.runtime.durations import expected, timed
from bearing_sim.runtime.precompilation import compile_for
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import number_at, quantities, ranges_of, shown
from bearing_sim.watchers.monitoring.watchers import are_missing

_DOMAINS = range(60, 100)  # above the usual choices of users, below where ports collide with ephemeral ports
_NODE_ENDS_WITHIN = 30.0  # [s]
_CALIBRATED = ("lubricant.mixture_fraction",)  # what a measured cage teaches most about
_HIDDEN = 0.5  # of the way from the scene's value to the end of its range lies the synthetic machine's
_MISSION, _VIEW = (1.5, 0.05), (2.0, 0.05)  # seconds of a core of the reference machine (`durations`): to start, and for a second of the mission
_PR_SET_PDEATHSIG = 1  # Linux: prctl


class DemoFailed(Exception):
    """The demonstration failed; the message says what happened."""


class Demo:
    """One run of the demonstration.

    Parameters
    ----------
    folder : for mission, recording, view and log; created if absent.
    scene : bundled scene or scene file.
    overrides : scene fields to change, each ``FIELD=VALUE``.
    allow_outside : whether the scene file may name files outside of its own folder.
    hidden : fields in which the synthetic machine with the measured cage differs from the scene, each ``FIELD=VALUE``; None: no cage is measured.
    """

    def __init__(self, folder: Path, scene: str, overrides: tuple[str, ...] = (), allow_outside: bool = False, hidden: tuple[str, ...] | None = None):
        self.folder = folder
        self.recording, self.view, self.log = folder / "run.mcap", folder / "run.rrd", folder / "node.log"
        self._scene, self._overrides, self._allow_outside, self._hidden = scene, overrides, allow_outside, hidden
        domain = os.environ.get("BEARING_SIM_DEMO_DOMAIN_ID") or str(random.SystemRandom().choice(_DOMAINS))
        self._environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": domain}

    def run(self, mission: Path | None, duration: float, response: bool) -> None:
        """Play a mission to a node and record it; what it needs beside inputs is made while the node starts or runs.

        Parameters
        ----------
        mission : input log; None: the synthetic mission is written.
        duration : of the synthetic mission [s].
        response : whether to build the response of the bearing to its uncertain fields, which the node uses as soon as it is there.

        Raises
        ------
        DemoFailed
            The node, the player or the mission failed.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with self._node() as node:
            click.echo(f"bearing_node is starting (log: {self.log})", err=True)
            with self._building_response() if response else nullcontext():
                self._play(mission or self._write_mission(duration), node)
            self._end(node)

    def show(self, opens: bool | None) -> None:
        """Write the view, and open it or print the command that does; None: open it if there is a display."""
        seconds = Recording(self.recording).duration
        stage = f"view of {seconds:.0f} s"
        click.echo(f"writing the view ({expected(stage, _VIEW[0] + _VIEW[1] * seconds)})", err=True)
        chosen = {None: (), True: ("--open",), False: ("--no-open",)}[opens]
        with timed(stage):
            self._run_to_end("view", str(self.recording), "-o", str(self.view), *chosen)

    def _write_mission(self, duration: float) -> Path:
        """Write the synthetic mission and return its path."""
        path, machine = self.folder / "mission.mcap", []
        stage = f"mission of {duration:g} s"
        if self._hidden is not None:
            changes = [word for override in (*self._overrides, *self._hidden) for word in ("--set", override)]
            machine = ["--cage", self._scene, *changes, *([OPTION] if self._allow_outside else [])]
            seconds = expected(stage, _MISSION[0] + _MISSION[1] * duration)
            click.echo(f"simulating the measured cage: the model with {', '.join(self._hidden)}, and noise ({seconds})", err=True)
        with timed(stage):
            self._run_to_end("mission", "-o", str(path), "--duration", str(duration), *machine, stdout=subprocess.DEVNULL)
        return path

    @contextmanager
    def _building_response(self) -> Iterator[None]:
        """Build the response of the bearing to its uncertain fields during the block, with the time that node and player leave."""
        changes = [word for override in self._overrides for word in ("--set", override)]
        words = ["table", self._scene, "--bands", "--workers", "1", *changes, *([OPTION] if self._allow_outside else [])]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        building = self._start("bearing_sim.cli", *words, preexec_fn=lambda: (_end_with_parent(), os.nice(19)), **quiet)
        try:
            yield
        finally:
            if building.poll() is None:
                click.echo("the bands were not ready in time: the next demonstration goes on with them", err=True)
            _stop(building)

    @contextmanager
    def _node(self) -> Iterator[subprocess.Popen]:
        # Without governor: every demonstration shows the same level, and a first start does not compile another one.
        parameters = {"scene": self._scene, "record": str(self.recording), "governor": "false", "allow_outside": str(self._allow_outside).lower()}
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
        # In its own session: Ctrl-C reaches this process alone, which then ends the others in order, each by one signal.
        options = {"env": self._environment, "start_new_session": True, "preexec_fn": _end_with_parent, **streams}
        return subprocess.Popen([sys.executable, "-m", module, *arguments], **options)

    def _run_to_end(self, *arguments: str, **streams) -> None:
        process = self._start("bearing_sim.cli", *arguments, **streams)
        try:
            process.wait()
        finally:
            _stop(process)
        if process.returncode != 0:
            raise DemoFailed(f"{arguments[0]} ended with code {process.returncode}")


def _end_with_parent() -> None:
    """Have the kernel end this process when the demonstration is killed: an orphaned node would record for ever."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


def _stop(process: subprocess.Popen) -> None:
    """End a process, by force if it does not end by itself."""
    if process.poll() is None:
        process.terminate()
    try:
        process.wait(_NODE_ENDS_WITHIN)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _await(installing: tuple[int, Path] | None, all_of_it: bool = False) -> None:
    """Wait until ROS 2, or all, is installed by a process that ``demo.sh`` has started; None: nothing is.

    Raises
    ------
    DemoFailed
        The installation failed.
    """
    if installing is None:
        return
    process, has_ros = installing
    while all_of_it or not has_ros.exists():
        try:
            ended, status = os.waitpid(process, os.WNOHANG)
        except ChildProcessError:  # ended, and asked for before
            return
        if ended:
            if status:
                raise DemoFailed("the installation failed; see the message above")
            return
        time.sleep(0.1)


def _tail(log: Path, lines: int = 15) -> str:
    return "\n".join(log.read_text(errors="replace").splitlines()[-lines:])


def summary(path: Path) -> str:
    """Return the key figures of a recorded run as a table of text.

    Raises
    ------
    RecordingError
        The file is not a recording of a run.
    """
    recording, blocks, warnings = Recording(path), [], Counter()
    for item in recording:
        if not isinstance(item, Event):
            blocks.append(item)
        elif item.level > Level.OK:
            warnings[item.kind] += 1

    def column(name: str) -> np.ndarray:
        return np.concatenate([block[name] for block in blocks])

    slip, speed = 100.0 * column("cage_slip"), np.abs(column("shaft_speed"))
    slip = slip[np.isfinite(slip) & topics.turns(speed, recording.scene.thresholds.slip_from_speed)]
    mean, quantile, largest = (slip.mean(), np.quantile(slip, 0.95), slip.max()) if slip.size else (math.nan,) * 3
    reports = _diagnostics(path)
    factors = [factor for report in reports if math.isfinite(factor := float(report.get("real-time factor possible", "nan")))] or [math.nan]
    lost = float(reports[-1].get("time lost [s]", "nan")) if reports else math.nan
    rows = [
        ("recorded", f"{recording.duration:.1f} s, {recording.samples} samples"),
        ("largest shaft speed", f"{speed.max() * 30 / math.pi:.0f} rpm"),
        ("cage slip while turning", f"mean {mean:.2f} %, 95 % quantile {quantile:.2f} %, largest {largest:.2f} %"),
        ("life at the worst condition", f"{column('modified_rating_life').min():.4g} h"),
        ("life used", f"{100 * column('damage').max():.3g} %"),
        ("real time", f"{lost:.2f} s skipped; speed of the solver alone: median {np.median(factors):.1f}, minimum {min(factors):.1f} x real time"),
        *_estimate_rows(recording, column("time"), speed),
        ("warnings and errors", ", ".join(f"{kind} ({count} times)" for kind, count in warnings.items()) or "none"),
    ]
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _estimate_rows(recording: Recording, times: np.ndarray, speeds: np.ndarray) -> list[tuple[str, str]]:
    """Return the rows of the slip's band where it reaches highest while the shaft turns, and of the calibrated fields before and after."""
    newest, first, slip, known = {}, {}, np.zeros(3), quantities(Scene)
    for bands in recording.bands():
        numbers = dict(zip(bands.names, bands.numbers[0]))
        if bands.topic == ESTIMATES:
            first, newest = first or numbers, numbers
        elif numbers["cage_slip"][2] > slip[2] and topics.turns(np.interp(bands.times[0], times, speeds), recording.scene.thresholds.slip_from_speed):
            slip = numbers["cage_slip"]
    rows = [("band of cage slip at its highest", f"{100 * slip[1]:.2f} to {100 * slip[2]:.2f} %")] if slip[2] > 0.0 else []
    for path, after in newest.items():
        texts = [f"{shown(known, path, low)} to {shown(known, path, high)}" for _, low, high in (first[path], after)]
        rows.append((path, f"{texts[0]} before, {texts[1]} after the measured cage (synthetic)"))
    return rows


def _estimates(scene: Scene) -> tuple[tuple[str, ...], tuple[str, ...] | None]:
    """Return the overrides by which a scene asks for bands and a calibration, and those of a machine that is not quite as the scene says.

    Both are empty for a scene whose fields have no ranges; without a field that a measured cage teaches much about, there is no such machine.
    """
    ranges = {one.field: one for one in ranges_of(scene)}
    calibrated = [path for path in _CALIBRATED if path in ranges]
    if not ranges:
        return (), None
    asked = () if scene.estimation.bands else ("estimation.bands=true",)
    if not calibrated:
        return asked, None
    own = [number_at(scene, path) for path in calibrated]
    hidden = [value + _HIDDEN * (ranges[path].high - value) for path, value in zip(calibrated, own)]
    asked += () if scene.estimation.calibrated else (f"estimation.calibrated=[{', '.join(calibrated)}]",)
    return asked, tuple(f"{path}={value:.4g}" for path, value in zip(calibrated, hidden))


def _diagnostics(path: Path) -> list[dict[str, str]]:
    """Return the values of all diagnostics reports in a finished recording."""
    reports = []
    for found in BagReader(path):
        if not isinstance(found, BagTopic) and found[0].name == f"/{topics.DIAGNOSTICS[0]}":
            whole = found[0].decode(found[2]).status[0]
            if whole.name.endswith(f": {WHOLE}") and whole.values:  # not the report of an event alone
                reports.append({pair.key: pair.value for pair in whole.values})
    return reports


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--out", type=click.Path(path_type=Path), default=Path("runs"), show_default=True, help="Folder for runs, each in its own subfolder.")
@click.option("--scene", default="deng2017_table1", show_default=True, help="Bundled scene or scene file.")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Change a field of the scene; can be repeated.")
@click.option(OPTION, "allow_outside", is_flag=True, help="Read files that the scene names although they lie outside of its folder.")
@click.option("--mission", type=click.Path(path_type=Path, exists=True), help="Input log to play instead of the bundled mission.")
@click.option("--duration", type=click.FloatRange(1.0, 3600.0), default=60.0, show_default=True, help="Length of the bundled mission [s].")
@click.option("--estimates/--no-estimates", default=True, show_default=True, help="Show bands, and a calibration by a synthetic measured cage.")
@click.option("--open/--no-open", "opens", default=None, help="Open the view in rerun [default: if there is a display].")
@click.option("--installing", type=(int, click.Path(path_type=Path)), hidden=True, help="Process that installs, and the file that says it has ROS 2.")
def command(out, scene, overrides, allow_outside, mission, duration, estimates, opens, installing):
    """Run the node on the bundled synthetic mission, record it, and show the results.

    With --estimates results have 5 to 95 % bands by the ranges of the scene, once the response of the bearing to them is built, which the bundled
    scene brings along. The cage of a synthetic machine is measured: a model whose oil quantity differs from the scene's, which the calibration
    finds while the node runs.
    """
    try:
        loaded = load_scene(scene, overrides, allow_outside)
        asked, hidden = _estimates(loaded) if estimates else ((), None)
        loaded = load_scene(scene, (*overrides, *asked), allow_outside)
    except SceneError as error:
        click.echo(f"demo: {error}", err=True)
        sys.exit(2)
    folder = fresh_path(out / time.strftime("%Y-%m-%d_%H-%M-%S"))
    demo = Demo(folder, scene, (*overrides, *asked), allow_outside, hidden)
    before = {number: signal.signal(number, signal.default_int_handler) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        compile_for(loaded, lambda line: click.echo(line, err=True))
        _await(installing)
        demo.run(mission, duration, are_missing(loaded))
        click.echo(summary(demo.recording))
        click.echo(f"recording: {demo.recording}")
        _await(installing, all_of_it=True)
        demo.show(opens)
    except DemoFailed as error:
        click.echo(f"demo: {error}", err=True)
        sys.exit(1)
    except KeyboardInterrupt:
        click.echo(f"demo: interrupted; recorded data is in {demo.folder}", err=True)
        sys.exit(130)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        with suppress(DemoFailed):  # an installation that is cut off leaves half a package
            _await(installing, all_of_it=True)


if __name__ == "__main__":
    with standard_streams():
        command(prog_name="demo")
