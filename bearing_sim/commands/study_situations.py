# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study situations``: pictures of six situations in rerun."""

import math
from pathlib import Path

import click

from bearing_sim.commands.reporting import FailedRun, print_json, print_rows, progress_bar, tell_compilation, told_file_faults


@click.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, metavar="FOLDER", help="Where NAME.rrd and NAME.png go.")
@click.option("--only", "names", multiple=True, metavar="NAME", help="Only this situation; may be repeated.")
@click.option("--size", type=(int, int), default=(1600, 1000), show_default=True, metavar="W H", help="Of the pictures [px].")
@click.option("--pictures/--no-pictures", default=True, show_default=True, help="Pictures need a Vulkan driver, a software one will do.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(out, names, size, pictures, as_json):
    """Run six situations of the bearing deng2017_table1 and draw each at the instant that shows it.

    Start from rest, steady light load, skid in a gust, misaligned rings, heavy load, and a fault that a measured cage tells.
    """
    from bearing_sim.screenshot import HeadlessViewer, ViewerFailed
    from bearing_sim.studies.situations import SITUATIONS

    known = {situation.name: situation for situation in SITUATIONS}
    for name in names:
        if name not in known:
            raise click.BadParameter(f"{name}: expected one of {', '.join(known)}", param_hint="--only")
    tell_compilation()
    report = {}
    with told_file_faults():
        out.mkdir(parents=True, exist_ok=True)
        for name in names or known:
            situation, rrd = known[name], out / f"{name}.rrd"
            report[name] = _run(situation, rrd)
            if pictures:
                try:
                    with HeadlessViewer(rrd, size) as viewer:
                        viewer.seek(situation.picture_at)
                        (out / f"{name}.png").write_bytes(viewer.png())
                        problems = viewer.problems()
                except ViewerFailed as fault:
                    raise FailedRun(f"{rrd} is written, but there is no picture of it: {fault}") from None
                if problems:
                    raise FailedRun(f"{rrd}: the viewer complains: {'; '.join(problems)}")
    if as_json:
        print_json(report)
    else:
        _print(report, out)


def _run(situation, rrd: Path) -> dict:
    """Write a situation's recording; return what it is told by."""
    import numpy as np

    from bearing_sim.events import Measurement
    from bearing_sim.sinks.rerun_sink import RerunSink
    from bearing_sim.studies.situations import play

    scene, blocks, residuals, codes = situation.scene(), [], [], []
    with RerunSink(scene, path=rrd, lossless=True, duration=situation.duration) as sink:
        with progress_bar(situation.name.replace("_", " "), situation.duration) as progress:
            for item in play(situation, scene):
                if isinstance(item, np.ndarray):
                    sink.write(item)
                    blocks.append(item)
                    progress(float(item["time"][-1]))
                elif isinstance(item, Measurement):
                    sink.write_measurement(*item)
                    residuals.append(item)
                else:
                    sink.write_event(item)
                    codes.append(item.code)
    if sink.fault:
        raise FailedRun(f"{rrd}: {sink.fault}")
    return _figures(situation, np.concatenate(blocks), residuals, codes)


def _figures(situation, block, residuals, codes) -> dict:
    import numpy as np

    def around(time):
        return block[np.abs(block["time"] - time) <= 0.02 * situation.duration]

    then, first = around(situation.picture_at), around(0.35 * situation.duration)
    late = [residual for time, _, residual in residuals if time > situation.duration - 0.3]
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
        "events": codes,
    }


def _print(report, out) -> None:
    columns = ("name", "level", "rpm", "N", "slip at first, then, at last [%]", "life [h]", "load [N]", "tilt, skew [mrad]", "residual [points]")
    rows = []
    for name, found in report.items():
        slips = ", ".join(f"{100 * found[key]:.2f}" for key in ("slip_at_first", "slip", "slip_at_last"))
        leans = f"{1e3 * found['largest_tilt']:.2f}, {1e3 * found['largest_skew']:.2f}"
        residual = "-" if found["residual"] is None else f"{100 * found['residual']:+.2f}"
        numbers = (f"{found[key]:.4g}" for key in ("shaft_speed_rpm", "radial_load"))
        others = (f"{found[key]:.4g}" for key in ("rating_life", "largest_load"))
        rows.append((name, found["level"], *numbers, slips, *others, leans, residual))
    print_rows(f"situations in {out}", columns, rows, words=("name", "level"), width=170)
