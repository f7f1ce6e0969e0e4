# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim view``: a recording in rerun."""

from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import click
from click import IntRange

from bearing_sim.cli.options import PATH, flag, gathered, option, size_option
from bearing_sim.cli.outputs import OutputFile, default_output
from bearing_sim.cli.reporting import FailedRun, UsageError, as_usage_error, note, progress_bar, tell_use
from bearing_sim.cli.results import command
from bearing_sim.files.outputs import Output


def _lines(speed, load, cage, clearance, temperature, speed_unit, load_unit, clearance_unit):
    """Return by role where its quantity is recorded, and the values [SI] of those that are constant, from texts of options with their units."""
    from bearing_sim.inputs.log import constant, is_constant, source
    from bearing_sim.view.bag import Line

    lines, constants = {}, {}
    with as_usage_error(ValueError):
        for role, channel, text, unit in (
            ("speed", "shaft_speed", speed, speed_unit),
            ("load", "radial_load", load, load_unit),
            ("cage_speed", "cage_speed_measured", cage, speed_unit),
            ("temperature", "oil_temperature", temperature, None),
            ("clearance", "running_clearance_measured", clearance, clearance_unit),
        ):
            if is_constant(text):
                constants[role] = constant(channel, text, unit)
            elif text:
                lines[role] = Line(*source(channel, text, unit))
    return lines, constants


_line_options = gathered(
    "lines",
    _lines,
    option(
        "--speed",
        "--speed-topic",
        "speed",
        "In a bag from another source: shaft speed, /topic or /topic.field[0] or a constant such as 1500rpm [default: /shaft_speed].",
        metavar="TOPIC",
    ),
    option("--load", "--load-topic", "load", "Likewise for the radial load, or 800N [default: /radial_load].", metavar="TOPIC"),
    option("--cage", "--cage-topic", "cage", "Likewise for a measured cage speed [default: /cage_speed_measured].", metavar="TOPIC"),
    option(
        "--clearance",
        "--clearance-topic",
        "clearance",
        "Likewise for a measured running clearance [default: /running_clearance_measured].",
        metavar="TOPIC",
    ),
    option(
        "--oil-temperature",
        "--temperature",
        "--temperature-topic",
        "temperature",
        "Likewise for the oil temperature [default: /oil_temperature].",
        metavar="TOPIC",
    ),
    option("--speed-unit", "Unit of the speeds that are fields, such as rpm [default: rad/s].", metavar="UNIT"),
    option("--load-unit", "Unit of a load that is a field, such as kN [default: N].", metavar="UNIT"),
    option("--clearance-unit", "Unit of a clearance that is a field, such as um [default: m].", metavar="UNIT"),
)


@command("view")
@click.argument("recording", type=PATH, metavar="RUN.mcap")
@option("-o", "--out", "File for rerun [default: next to the recording].", OutputFile(), metavar="RUN.rrd")
@option("--screenshot", "Write a picture of the view instead of opening it.", OutputFile(), metavar="PICTURE.png")
@option("--at", "seconds", "Simulated time of the picture [default: the end].", float, metavar="SECONDS")
@size_option
@_line_options
@flag("--web", "is_web", "Show it in a browser: serve rerun's web viewer on 127.0.0.1 until Ctrl-C.")
@option("--web-port", "Port on 127.0.0.1 for --web; 0 for any that is free [default: 9090].", IntRange(0, 65535), metavar="PORT")
@option("--open/--no-open", "opens", "Open rerun [default: if there is a display].", default=None)
def view(
    recording,
    out,
    screenshot,
    seconds,
    size,
    lines,
    is_web,
    web_port,
    opens,
):
    """Show RUN.mcap in rerun: a recording of bearing-sim or the node, or any rosbag2 recording.

    Writes RUN.rrd and opens it, or prints the command that does. A picture needs no display, only a Vulkan driver; a software driver
    is sufficient. Of bags from other sources (MCAP or SQLite, file or folder), speeds, load, temperature and plain numbers are shown over
    time; topics that cannot be shown are listed. --web needs neither a display nor the internet, and nobody can connect from another
    machine, except by a tunnel (ssh -L 9090:127.0.0.1:9090).
    """
    if web_port is not None and not is_web:
        raise UsageError("--web-port goes with --web")
    if is_web and screenshot is not None:
        raise UsageError("--web and --screenshot contradict each other; give one of them")
    with ExitStack() as stack:
        if out is None and screenshot is not None:  # nobody has asked for the file itself
            out = Output(Path(stack.enter_context(TemporaryDirectory())) / "view.rrd")
        out = out or default_output((recording.with_suffix("") if recording.suffix == ".active" else recording).with_suffix(".rrd"))
        with out.draft() as draft:
            span = _write(recording, draft, seconds, *lines)
        if screenshot is not None:
            _take_picture(out.path, screenshot, span[1] if seconds is None else seconds, size)
            click.echo(f"{screenshot}")
            return
    if is_web:
        _serve(out.path, 9090 if web_port is None else web_port, opens)
        return
    _open(out.path, opens)


_MOST_LEFT_OUT = 30  # lines


def _write(recording: Path, out: Path, seconds: float | None, lines: dict, constants: dict[str, float]) -> tuple[float, float]:
    """Write the file for rerun; return the first and last time in it [s]."""
    from bearing_sim.recording.bag import RecordingError
    from bearing_sim.recording.reader import Recording

    if lines or constants:
        return _write_bag(recording, out, seconds, lines, constants, "topics are given")
    try:
        source = Recording(recording, allow_partial=True)
    except RecordingError as error:
        if not recording.exists():
            raise
        return _write_bag(recording, out, seconds, {}, {}, str(error))
    _require_within(seconds, source.first_time, source.last_time)
    _convert(source, out)
    tell_use(source.tally, recording)
    return source.first_time, source.last_time


def _write_bag(recording: Path, out: Path, seconds: float | None, lines: dict, constants: dict[str, float], why: str) -> tuple[float, float]:
    from bearing_sim.view.bag import read_bag_series, write_bag_view

    found = read_bag_series(recording, lines, constants)
    tell_use(found.tally, recording)
    _require_within(seconds, 0.0, found.duration)
    note(f"shown as a bag from another source ({why}); not shown:")
    for line in found.left_out[:_MOST_LEFT_OUT]:
        note(f"  {line}")
    if (more := len(found.left_out) - _MOST_LEFT_OUT) > 0:
        note(f"  and {more} more, which the view lists")
    write_bag_view(out, recording.name, found)
    return 0.0, found.duration


def _require_within(seconds: float | None, first: float, last: float) -> None:
    if seconds is not None and not first <= seconds <= last:
        raise UsageError(f"--at {seconds:g}: the recording covers {first:g} to {last:g} s")


def _convert(source, out: Path) -> None:
    import numpy as np

    from bearing_sim.view.worker import RerunFile

    with progress_bar(f"reading {source.path.name}", source.duration) as progress:
        with RerunFile(source.scene, out, source.start_ns, source.duration, source.largest_load or None) as sink:
            for item in source.with_measurements():
                sink.write(item)
                if isinstance(item, np.ndarray):
                    progress(float(item["time"][-1]) - source.first_time)


def _take_picture(rrd: Path, picture: Output, seconds: float, size: tuple[int, int]) -> None:
    from bearing_sim.view.screenshot import HeadlessViewer

    with HeadlessViewer(rrd, size) as viewer:
        viewer.seek(seconds)
        content, problems = viewer.png(), viewer.problems()
    picture.write_bytes(content)
    if problems:
        raise FailedRun(f"{picture} was written, but the viewer reports: {'; '.join(problems)}")


def _serve(rrd: Path, port: int, opens: bool | None) -> None:
    """Serve the web viewer with a recording until Ctrl-C."""
    import time
    import webbrowser

    from bearing_sim.view.web import WebViewer

    with suppress(KeyboardInterrupt), WebViewer(port, recording=rrd) as viewer:
        click.echo(f"{rrd} is shown at {viewer.url} for browsers on this machine; end with Ctrl-C")
        if opens or (opens is None and _has_display()):
            webbrowser.open(viewer.url)
        while True:
            time.sleep(3600.0)


def _has_display() -> bool:
    import os
    import sys

    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(rrd: Path, opens: bool | None) -> None:
    import shlex
    import subprocess
    import sys

    from bearing_sim.view.viewer import viewer_command

    command = viewer_command(str(rrd)) or [sys.executable, "-m", "rerun", str(rrd)]
    if opens is False or (opens is None and not _has_display()):
        click.echo(f"open it with: {shlex.join(command)}")
        return
    subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    click.echo(f"{rrd} opens in rerun")
