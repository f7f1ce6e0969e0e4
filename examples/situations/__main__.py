# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pictures of six situations, from start to fault, in rerun: ``python examples/situations --out FOLDER``, from a checkout."""

import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "examples")]

import click  # noqa: E402

from bearing_sim.cli.options import json_option, size_option  # noqa: E402
from bearing_sim.cli.outputs import OutputFolder  # noqa: E402
from bearing_sim.cli.reporting import FailedRun, announce_compilation, as_ending, print_json, print_rows, progress_bar  # noqa: E402
from bearing_sim.cli.results import Command  # noqa: E402
from bearing_sim.files.outputs import Output  # noqa: E402


@click.command("situations", cls=Command)
@click.option("-o", "--out", type=OutputFolder(), required=True, metavar="FOLDER", help="Folder for NAME.rrd and NAME.png.")
@click.option("--only", "names", multiple=True, metavar="NAME", help="Run only this situation; can be repeated.")
@size_option
@click.option("--pictures/--no-pictures", default=True, show_default=True, help="Pictures need a Vulkan driver; a software driver is sufficient.")
@json_option
def situations(out, names, size, pictures, as_json):
    """Run six situations of bearing deng2017_table1 and draw each at its characteristic instant.

    Start from rest, steady light load, skid in a gust, misaligned rings, heavy load, and a fault detected by a measured cage.
    """
    from bearing_sim.view.screenshot import HeadlessViewer, ViewerFailed
    from situations.situations import SITUATIONS

    known = {situation.name: situation for situation in SITUATIONS}
    for name in names:
        if name not in known:
            raise click.BadParameter(f"{name}: expected one of {', '.join(known)}", param_hint="--only")
    announce_compilation()
    report = {}
    with as_ending():
        views = {name: Output(out.path / f"{name}.rrd", out.force) for name in names or known}
        drawn = {name: Output(out.path / f"{name}.png", out.force) for name in names or known}
        out.path.mkdir(exist_ok=True)
        for each in (*views.values(), *drawn.values()):
            each.check()
        for name, view in views.items():
            situation, rrd = known[name], view.path
            with view.draft() as draft:
                report[name] = _run(situation, draft)
            if pictures:
                try:
                    with HeadlessViewer(rrd, size) as viewer:
                        viewer.seek(situation.picture_at)
                        drawn[name].write_bytes(viewer.png())
                        problems = viewer.problems()
                except ViewerFailed as error:
                    raise FailedRun(f"{rrd} is written, but no picture could be made: {error}") from None
                if problems:
                    raise FailedRun(f"{rrd}: the viewer reports: {'; '.join(problems)}")
    if as_json:
        print_json(report)
    else:
        _print_situations(report, out)


def _run(situation, rrd: Path) -> dict:
    """Write the recording of a situation and return its key figures."""
    import numpy as np

    from bearing_sim.messages.events import Measurement
    from bearing_sim.view.worker import RerunFile
    from situations.situations import play

    scene, blocks, residuals, kinds = situation.scene(), [], [], []
    with RerunFile(scene, rrd, duration=situation.duration) as sink:
        with progress_bar(situation.name.replace("_", " "), situation.duration) as progress:
            for item in play(situation, scene):
                if isinstance(item, np.ndarray):
                    sink.write(item)
                    blocks.append(item)
                    progress(float(item["time"][-1]))
                elif isinstance(item, Measurement):
                    sink.write(item)
                    residuals.append(item)
                else:
                    sink.write(item)
                    kinds.append(item.kind)
    return _figures(situation, np.concatenate(blocks), residuals, kinds)


def _figures(situation, block, residuals, kinds) -> dict:
    import numpy as np

    def around(time):
        return block[np.abs(block["time"] - time) <= 0.02 * situation.duration]

    then, first = around(situation.picture_at), around(0.35 * situation.duration)
    late = [each.residual for each in residuals if each.time > situation.duration - 0.3]
    return {
        "level": situation.scene().level,
        "shaft_speed_rpm": float(then["shaft_speed"][-1]) * 30 / math.pi,
        "radial_load": float(np.hypot(then["load_y"][-1], then["load_z"][-1])),
        "slip_at_first": float(np.nanmean(first["cage_slip"])),
        "slip": float(np.nanmean(then["cage_slip"])),
        "slip_at_last": float(np.nanmean(block["cage_slip"][-len(then) :])),
        "rating_life": float(np.median(then["rating_life"])),
        "largest_load": float(then["inner_load"].max()),
        "largest_tilt": float(np.abs(then["roller_tilt"]).max()),
        "largest_skew": float(np.abs(then["roller_skew"]).max()),
        "residual": float(np.mean(late)) if late else None,
        "events": kinds,
    }


def _print_situations(report, out) -> None:
    columns = ("name", "level", "rpm", "N", "slip at start, picture, end [%]", "life [h]", "load [N]", "tilt, skew [mrad]", "residual [points]")
    rows = []
    for name, found in report.items():
        slips = ", ".join(f"{100 * found[key]:.2f}" for key in ("slip_at_first", "slip", "slip_at_last"))
        leans = f"{1e3 * found['largest_tilt']:.2f}, {1e3 * found['largest_skew']:.2f}"
        residual = "-" if found["residual"] is None else f"{100 * found['residual']:+.2f}"
        numbers = (f"{found[key]:.4g}" for key in ("shaft_speed_rpm", "radial_load"))
        others = (f"{found[key]:.4g}" for key in ("rating_life", "largest_load"))
        rows.append((name, found["level"], *numbers, slips, *others, leans, residual))
    print_rows(f"situations in {out}", columns, rows, words=("name", "level"), width=170)


if __name__ == "__main__":
    situations()
