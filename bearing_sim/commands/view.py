# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim view``: a recording in rerun."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import BadInput, FailedRun, progress_bar, told_as_bad_input


@click.command()
@click.argument("recording", type=click.Path(path_type=Path), metavar="RUN.mcap")
@click.option("-o", "--out", type=click.Path(path_type=Path), metavar="RUN.rrd", help="File for rerun [default: beside the recording].")
@click.option("--screenshot", type=click.Path(path_type=Path), metavar="PICTURE.png", help="Write a picture of the view instead of opening it.")
@click.option("--at", "seconds", type=float, metavar="SECONDS", help="Simulated time of the picture [default: the end].")
@click.option("--size", default="1600x1000", show_default=True, metavar="WxH", help="Size of the picture [px].")
@click.option("--open/--no-open", "opens", default=None, help="Open rerun [default: where there is a display].")
def command(recording, out, screenshot, seconds, size, opens):
    """Show RUN.mcap, a recording of bearing-sim or of the node, in rerun.

    Writes RUN.rrd and opens it, or prints the command that does. A picture needs no display, only a Vulkan driver, which may be
    a software one.
    """
    from bearing_sim.recording_reader import Recording, RecordingError

    picture_size = _size(size)
    with told_as_bad_input(RecordingError, PermissionError):
        source = Recording(recording)
        if seconds is not None and not source.first_time <= seconds <= source.last_time:
            raise BadInput(f"--at {seconds:g}: the recording goes from {source.first_time:g} to {source.last_time:g} s")
        out = out or recording.with_suffix("").with_suffix(".rrd") if recording.suffix == ".active" else out or recording.with_suffix(".rrd")
        _convert(source, out)
    if source.unfinished:
        click.echo(f"{recording}: {source.unfinished}", err=True)
    if screenshot is not None:
        _take_picture(out, screenshot, source.last_time if seconds is None else seconds, picture_size)
        click.echo(f"{screenshot}")
        return
    _open(out, opens)


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and 200 <= int(width) <= 8000 and 200 <= int(height) <= 8000):
        raise BadInput(f"--size {text}: expected WIDTHxHEIGHT, each 200 to 8000, such as 1600x1000")
    return int(width), int(height)


def _convert(source, out: Path) -> None:
    from bearing_sim.sinks.rerun_sink import RerunSink

    with progress_bar(f"reading {source.path.name}", source.duration) as progress:
        with RerunSink(
            source.scene, path=out, start_ns=source.start_ns, lossless=True, duration=source.duration, load_scale=source.largest_load or None
        ) as sink:
            for item in source:
                if isinstance(item, tuple):
                    sink.write_event(item)
                else:
                    sink.write(item)
                    progress(float(item["time"][-1]) - source.first_time)
    if sink.fault:
        raise FailedRun(f"{out}: {sink.fault}")


def _take_picture(rrd: Path, picture: Path, seconds: float, size: tuple[int, int]) -> None:
    from bearing_sim.screenshot import HeadlessViewer, ViewerFailed

    try:
        with HeadlessViewer(rrd, size) as viewer:
            viewer.seek(seconds)
            picture.write_bytes(viewer.png())
            problems = viewer.problems()
    except ViewerFailed as fault:
        raise FailedRun(f"no picture: {fault}") from None
    if problems:
        raise FailedRun(f"{picture} was written, but the viewer complains: {'; '.join(problems)}")


def _open(rrd: Path, opens: bool | None) -> None:
    import os
    import subprocess
    import sys

    has_display = sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    if opens is False or (opens is None and not has_display):
        click.echo(f"open it with: rerun {rrd}")
        return
    subprocess.Popen([sys.executable, "-m", "rerun", str(rrd)], start_new_session=True)
    click.echo(f"{rrd} opens in rerun")
