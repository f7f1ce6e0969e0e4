# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study``: studies of the model itself, and the results of Deng 2017."""

import math
from pathlib import Path

import click

from bearing_sim.cli.options import (
    allow_outside_option,
    csv_option,
    executor_options,
    json_option,
    level_type,
    picture_option,
    scene_argument,
    set_option,
    size_option,
)
from bearing_sim.cli.outputs import OutputFolder, OutputJournal, OutputTable, WritingCommand
from bearing_sim.cli.reporting import (
    FailedRun,
    Points,
    UsageError,
    announce_compilation,
    as_failed_run,
    as_file_error,
    as_usage_error,
    column_texts,
    command_line,
    judged,
    print_json,
    print_rows,
    print_table,
    progress_bar,
    quantity_of,
    refuse_idle_temperature,
    seconds_of,
    unknown_report,
    warn_of_scene,
    write_csv,
)
from bearing_sim.files.outputs import Output
from bearing_sim.scene.display import number as number_text


def _write(table, rows, picture, draw) -> None:
    """Write the rows of a study to a table and let ``draw`` draw into a picture, each where it is asked for."""
    with as_file_error():
        if table is not None:
            write_csv(table, rows)
        if picture is not None:
            with picture.draft() as draft:
                draw(draft)


@click.command("deng2017", cls=WritingCommand)
@click.option("-o", "--out", type=OutputFolder(), default="deng2017", show_default=True, metavar="FOLDER", help="Output folder.")
@set_option
@click.option("--quick", is_flag=True, help="Few points and short runs, to check that everything works.")
@executor_options
@json_option
def deng2017(out, overrides, quick, workers, dask, as_json):
    """Reproduce the figures of Deng 2017 at levels slip and planar, with the parameters of the paper, and check its claims.

    Writes tables (Parquet, CSV), figures and claims to FOLDER; `bearing-sim report FOLDER` makes a page of them.  An interrupted study
    resumes where it stopped.  With --set every scene of the study departs from the paper, for example by a support.
    """
    from bearing_sim.scene.loader import SceneError
    from bearing_sim.sweep.tasks import ClusterError, JournalInUse

    announce_compilation()
    from bearing_sim.studies.deng2017.run import require_same_study, run_study

    points = Points("deng2017", 0)
    with as_file_error(), as_usage_error(SceneError, ClusterError, JournalInUse), points:
        require_same_study(out, quick, overrides)
        findings = run_study(out.path, quick, workers, dask, points.update, overrides)
    if as_json:
        print_json({"folder": str(out), "computed": points.computed, "claims": [finding._asdict() for finding in findings]})
        return
    for finding in findings:
        click.echo(f"{finding.claim} at level {finding.level}: {finding.verdict}" if finding.claim else f"contours: {finding.verdict}")
        for name in ("gives", "off", "why"):
            if getattr(finding, name):
                click.echo(f"    {name}: {getattr(finding, name)}")
    click.echo(f"{points.computed} points computed; {out}; make a page of it with bearing-sim report {out}")


@click.command("damage")
@click.argument("log", type=click.Path(path_type=Path), metavar="IN.mcap")
@allow_outside_option
@click.option("--scene", "scene_name", required=True, metavar="SCENE", help="Name of a bundled scene, or a scene file.")
@set_option
@click.option("--windows", default=10, show_default=True, type=click.IntRange(1, 1000), help="Number of windows that level planar computes.")
@click.option("--length", default=1.0, show_default=True, type=click.FloatRange(min=0.01), metavar="S", help="Length of a window.")
@json_option
def damage(log, scene_name, overrides, windows, length, as_json):
    """Run the inputs in IN.mcap at levels steady and slip, and at level planar in windows spread evenly over them."""
    from bearing_sim.inputs.log import InputLogError, read_input_log
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError

    with as_usage_error(SceneError, InputLogError), as_file_error():
        scene = load_scene(scene_name, [*overrides, "level=steady"])
        course = judged(read_input_log(log), scene)
    from bearing_sim.cli.table import build_with_progress
    from bearing_sim.studies.damage import damages

    announce_compilation()
    kelvin = scene.lubricant.temperature
    table = build_with_progress(scene, None if "oil_temperature" in course.stamps else (kelvin, kelvin))[0]
    run = course.segment(None, kelvin)
    with progress_bar(f"running {log.name}", course.end * 1e-9) as show, as_usage_error(SceneError), as_failed_run(IntegrationError):
        found = damages(
            scene_name, overrides, run.instants * 1e-9, run.inputs, run.in_gap, table=table, windows=windows, length=length, progress=show
        )
    if as_json:
        windows = [window._asdict() for window in found.windows]
        print_json({"log": log.name, "scene": scene_name, **found._asdict(), "windows": windows, **unknown_report(course)})
    else:
        _print_damage(log, scene_name, found)


def _print_damage(log, name, found) -> None:
    rows = []
    sums = [sum(getattr(window, level) for window in found.windows) for level in ("steady", "slip", "planar")]
    for window in found.windows:
        numbers = [f"{1e6 * value:.4g}" for value in (window.steady, window.slip, window.planar)]
        where = f"{window.start:.1f}", f"{window.shaft_speed * 30 / math.pi:.0f}", f"{window.radial_load:.0f}"
        rows.append((*where, *numbers, f"{window.planar / window.slip:.3f}" if window.slip > 0.0 else ""))
    rows.append(("windows", "", "", *(f"{1e6 * value:.4g}" for value in sums), f"{sums[2] / sums[1]:.3f}" if sums[1] > 0.0 else ""))
    rows.append(("whole", "", "", f"{1e6 * found.steady:.6g}", f"{1e6 * found.slip:.6g}", "", ""))
    columns = ("from [s]", "speed [rpm]", "load [N]", "steady", "slip", "planar", "planar/slip")
    print_rows(f"{log.name}, {name}: damage in millionths of the life, by level", columns, rows)


@click.command("misalignment", cls=WritingCommand)
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@set_option
@click.option("--largest", default=3.0, show_default=True, type=click.FloatRange(0.0, 20.0), metavar="MRAD", help="Largest misalignment.")
@click.option("--points", default=7, show_default=True, type=click.IntRange(2, 1000), help="Number of misalignments, starting at 0.")
@click.option("--crown", "crowns", multiple=True, metavar="LAW", help="Value of bearing.roller.crown; can be repeated [default: none, iso_log].")
@click.option(
    "--slices",
    default=30,
    show_default=True,
    type=click.IntRange(5, 400),
    help="Laminae per roller for life and pressures (ISO/TS 16281: at least 30).",
)
@csv_option("Write the results to a table.")
@picture_option("Draw the results")
@json_option
def misalignment(scene_name, overrides, largest, points, crowns, slices, table, picture, as_json):
    """Run SCENE at level spatial with its inner ring held at increasing misalignments, with and without a crown."""
    import numpy as np

    from bearing_sim.scene.loader import SceneError
    from bearing_sim.simulation import IntegrationError

    announce_compilation()
    from bearing_sim.studies.misalignment import CROWNS, draw, misalign

    crowns = crowns or CROWNS
    done = iter(range(points * len(crowns) + 1))
    amounts = [round(float(each), 9) for each in 1e-3 * np.linspace(0.0, largest, points)]
    with progress_bar("points", points * len(crowns)) as show, as_usage_error(SceneError, ValueError), as_failed_run(IntegrationError):
        found = misalign(scene_name, overrides, amounts, crowns, slices, progress=lambda name: show(next(done)))
    rows = [_row(one) for one in found]
    title = f"{' '.join([scene_name, *overrides])}: misalignment of the inner ring, {slices} laminae"
    _write(table, rows, picture, lambda draft: draw(draft, title, found))
    if as_json:
        print_json({"scene": scene_name, "slices": slices, "points": rows})
    else:
        _print_misalignment(scene_name, rows)


def _row(one) -> dict:
    return {
        "crown": one.crown,
        "misalignment_mrad": 1e3 * one.misalignment,
        "slip_percent": 100 * one.slip,
        "inner_pressure_mpa": 1e-6 * one.inner_pressure,
        "inner_edge_pressure_mpa": 1e-6 * one.inner_edge_pressure,
        "outer_edge_pressure_mpa": 1e-6 * one.outer_edge_pressure,
        "tilt_mrad": 1e3 * one.tilt,
        "skew_mrad": 1e3 * one.skew,
        "life_hours": one.rating_life,
        "l10r_hours": one.l10r,
        "static_l10r_hours": one.still.lives.l10r,
    }


def _print_misalignment(name, rows) -> None:
    pressures, angles, lives = (
        ("largest [MPa]", "inner edge [MPa]", "outer edge [MPa]"),
        ("tilt [mrad]", "skew [mrad]"),
        ("life [h]", "L10r [h]", "L10r, no slip, h"),
    )
    texts = [(crown, *(number_text(number) for number in numbers)) for crown, *numbers in (row.values() for row in rows)]
    columns = ("crown", "misalignment [mrad]", "slip [%]", *pressures, *angles, *lives)
    print_rows(f"{name}: misalignment of the inner ring, level spatial", columns, texts, words=("crown",))
    click.echo("pressures, tilt and skew: time average of the largest value at each instant; no slip: life by slices in quasi-static equilibrium")


@click.command("support", cls=WritingCommand)
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@set_option
@click.option("--from", "lowest", default=10000.0, show_default=True, type=click.FloatRange(1.0), metavar="RPM", help="Lowest shaft speed.")
@click.option("--to", "highest", default=52000.0, show_default=True, type=click.FloatRange(1.0), metavar="RPM", help="Highest shaft speed.")
@click.option("--points", default=29, show_default=True, type=click.IntRange(2, 1000), help="Number of speeds.")
@click.option("--level", default="planar", show_default=True, type=click.Choice(["planar", "spatial"]), help="Level with vibration.")
@csv_option("Write the results to a table.")
@picture_option("Draw the results")
@json_option
def support(scene_name, overrides, lowest, highest, points, level, table, picture, as_json):
    """Run SCENE over speeds with its support, with a rigid one, and at level slip.

    A scene whose support does not yield gets `support.elastic: true`.
    """
    import numpy as np

    from bearing_sim.scene.loader import SceneError
    from bearing_sim.simulation import IntegrationError

    announce_compilation()
    from bearing_sim.studies.support import draw, relative_damage, respond

    done = iter(range(3 * points + 1))
    speeds = [float(each) for each in np.linspace(lowest, highest, points) * (math.pi / 30)]
    with progress_bar("points", 3 * points) as show, as_usage_error(SceneError), as_failed_run(IntegrationError):
        found = respond(scene_name, overrides, speeds, level, progress=lambda name: show(next(done)))
    relative = relative_damage(found)
    rows = [_response_row(one, relative) for one in found]
    title = f"{' '.join([scene_name, *overrides])}: response over speed, level {level}"
    _write(table, rows, picture, lambda draft: draw(draft, title, found))
    if as_json:
        print_json({"scene": scene_name, "level": level, "points": rows})
    else:
        columns = ("model", "speed [rpm]", "slip [%]", "largest load [N]", "ring moves [µm]", "outer ring [µm]", "damage/slip's", "support [W]")
        texts = [(row["model"], *(number_text(number) for number in list(row.values())[1:])) for row in rows]
        print_rows(f"{scene_name}: response over speed, level {level}", columns, texts, words=("model",))


@click.command("resonances", cls=WritingCommand)
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@set_option
@click.option("--from", "lowest", type=click.FloatRange(1.0), metavar="RPM", help="Lowest shaft speed [default: 0.5 of the scene's].")
@click.option("--to", "highest", type=click.FloatRange(1.0), metavar="RPM", help="Highest shaft speed [default: 1.3 of the scene's].")
@click.option("--points", default=33, show_default=True, type=click.IntRange(2, 1000), help="Number of speeds.")
@click.option("--level", default="planar", show_default=True, type=click.Choice(["planar", "spatial"]), help="Level with vibration.")
@csv_option("Write the results to a table.")
@picture_option("Draw the results")
@json_option
def resonances(scene_name, overrides, lowest, highest, points, level, table, picture, as_json):
    """Show over speed where the passing rollers make the inner ring of SCENE vibrate on its contacts, and in which states it stays."""
    import numpy as np

    from bearing_sim.scene.loader import SceneError, load_scene

    with as_usage_error(SceneError):
        scene = load_scene(scene_name, [*overrides, f"level={level}"])
    announce_compilation(scene)
    from bearing_sim.studies.resonances import draw, resonances

    own = abs(scene.operating.shaft_speed) * 30.0 / math.pi
    if own == 0.0 and None in (lowest, highest):
        raise UsageError("the scene's shaft stands still; give --from and --to")
    speeds = np.linspace(0.5 * own if lowest is None else lowest, 1.3 * own if highest is None else highest, points) * (math.pi / 30.0)
    with progress_bar("speeds", points) as show:
        found = resonances(scene, speeds, show)
    rows = [row for each in found for row in _resonance_rows(each)]
    title = f"{' '.join([scene_name, *overrides])}: the inner ring on its rollers, level {level}"
    _write(table, rows, picture, lambda draft: draw(draft, title, found))
    if as_json:
        print_json({"scene": scene_name, "level": level, "points": rows})
    else:
        columns = ("speed [rpm]", "over passage", "multiplier", "nearby", "slip [%]", "life [h]", "state")
        texts = [tuple(cell if isinstance(cell, str) else number_text(cell) for cell in _resonance_cells(row)) for row in rows]
        print_rows(f"{scene_name}: the inner ring on its rollers over speed, level {level}", columns, texts, words=("over passage", "state"))


def _resonance_rows(speed) -> list[dict]:
    ring = speed.resonance
    low, high = (math.nan, math.nan) if ring is None else ring.ratios
    known = {
        "shaft_speed_rpm": speed.shaft_speed * 30.0 / math.pi,
        "lower_ratio": low,
        "higher_ratio": high,
        "multiplier": math.nan if ring is None else ring.multiplier,
        "multiplier_nearby": math.nan if ring is None else ring.multiplier_nearby,
    }
    states = [(100.0 * state.cage_slip, state.rating_life, state.start) for state in speed.states] or [(math.nan, math.nan, "the run stopped early")]
    return [known | {"slip_percent": slip, "rating_life_h": life, "state": start} for slip, life, start in states]


def _resonance_cells(row) -> tuple:
    ratios = f"{row['lower_ratio']:.2f}, {row['higher_ratio']:.2f}"
    return row["shaft_speed_rpm"], ratios, row["multiplier"], row["multiplier_nearby"], row["slip_percent"], row["rating_life_h"], row["state"]


def _response_row(one, relative) -> dict:
    return {
        "model": one.model,
        "shaft_speed_rpm": one.shaft_speed * 30 / math.pi,
        "slip_percent": 100 * one.slip,
        "largest_inner_load_n": one.largest_load,
        "ring_motion_um": 1e6 * one.ring_swing,
        "outer_ring_motion_um": 1e6 * one.outer_swing,
        "damage_over_slip": relative[one.model, one.shaft_speed],
        "support_power_w": one.support_power,
    }


@click.command("situations", cls=WritingCommand)
@click.option("-o", "--out", type=OutputFolder(), required=True, metavar="FOLDER", help="Folder for NAME.rrd and NAME.png.")
@click.option("--only", "names", multiple=True, metavar="NAME", help="Run only this situation; can be repeated.")
@size_option
@click.option("--pictures/--no-pictures", default=True, show_default=True, help="Pictures need a Vulkan driver; a software driver is sufficient.")
@json_option
def situations(out, names, size, pictures, as_json):
    """Run six situations of bearing deng2017_table1 and draw each at its characteristic instant.

    Start from rest, steady light load, skid in a gust, misaligned rings, heavy load, and a fault detected by a measured cage.
    """
    from bearing_sim.studies.situations import SITUATIONS
    from bearing_sim.view.screenshot import HeadlessViewer, ViewerFailed

    known = {situation.name: situation for situation in SITUATIONS}
    for name in names:
        if name not in known:
            raise click.BadParameter(f"{name}: expected one of {', '.join(known)}", param_hint="--only")
    announce_compilation()
    report = {}
    with as_file_error():
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
    from bearing_sim.studies.situations import play
    from bearing_sim.view.worker import RerunFile

    scene, blocks, residuals, kinds = situation.scene(), [], [], []
    with RerunFile(scene, rrd, duration=situation.duration) as sink:
        with progress_bar(situation.name.replace("_", " "), situation.duration) as progress:
            for item in play(situation, scene):
                sink.write(item)
                if isinstance(item, np.ndarray):
                    blocks.append(item)
                    progress(float(item["time"][-1]))
                elif isinstance(item, Measurement):
                    residuals.append(item)
                else:
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


@click.command("slices")
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@set_option
@click.option("--settle", default=0.15, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated time before measuring.")
@click.option("--duration", default=0.06, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated time measured.")
@json_option
def slices(scene_name, overrides, settle, duration, as_json):
    """Run SCENE at level spatial by quadrature and with 10 to 200 slices, and measure results and the cost of a step."""
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError

    with as_usage_error(SceneError):
        scene = load_scene(scene_name, [*overrides, "level=spatial"])
    announce_compilation()
    from bearing_sim.studies.slices import SLICES, by_slices

    done = iter(range(len(SLICES) + 1))
    with progress_bar("runs", len(SLICES)) as show, as_failed_run(IntegrationError):
        found = by_slices(scene, settle, duration, progress=lambda name: show(next(done)))
    if as_json:
        print_json({"scene": scene_name, "runs": [one._asdict() for one in found]})
    else:
        _print_slices(scene_name, found)


def _print_slices(name, found) -> None:
    columns = (
        "slices",
        "slip [%]",
        "largest load [N]",
        "life [h]",
        "L10r [h]",
        "edge [MPa]",
        "static pressure [MPa]",
        "L10r [h]",
        "time per step [µs]",
        "x real time",
    )
    rows = []
    for one in found:
        lives = [number_text(value) for value in (one.inner_load, one.rating_life, one.l10r, 1e-6 * one.edge_pressure)]
        still = ("-", "-") if one.slices is None else (f"{1e-6 * one.static_pressure:.5g}", f"{one.static_l10r:.4g}")
        rows.append(
            (str(one.slices or "quadrature"), f"{100 * one.slip:.4g}", *lives, *still, f"{1e6 * one.step_seconds:.3g}", f"{one.real_time_factor:.3g}")
        )
    print_rows(f"{name}: results by number of slices", columns, rows)


@click.command("friction", cls=WritingCommand)
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", required=False)
@set_option
@click.option(
    "--series", metavar="SERIES", help="Series of SCENE's bearing: 10, 2, 3, 4, 22, 23, or NCF 22, NCF 29, NCF 30 [default: by its designation]."
)
@csv_option("Write all operating points to a table.")
@json_option
def friction(scene_name, overrides, series, table, as_json):
    """Compare the frictional moment with makers' models, for the bearings of the catalogue or for SCENE at its operating point.

    With heat.law network SCENE is in thermal equilibrium, as in `bearing-sim run`; where there is none, the command fails and says why.
    Catalogue bearings stand in an oil bath under the conditions of ISO 15312, from 0.02 to 0.2 C_0 and from 500 rpm to the reference speed;
    a second table has the speeds at which friction reaches the standard's heat flow, against those that makers print, and a third one rolling and
    sliding against SKF's friction model, from mixed friction to thick films.
    """
    from bearing_sim.scene.display import force, number, power
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError
    from bearing_sim.studies.friction import SERIES, compare, series_of
    from bearing_sim.studies.sheet import temperatures, temperatures_text

    announce_compilation()
    if scene_name is None:
        if series:
            raise UsageError("--series is for a SCENE; give one")
        with as_usage_error(SceneError):
            _friction_of_catalogue(overrides, table, as_json)
        return
    with as_usage_error(SceneError):
        scene = load_scene(scene_name, overrides)
    refuse_idle_temperature(scene, overrides)
    series = " ".join(series.upper().split()) if series else series_of(scene.bearing.designation or scene.bearing.name)
    if series not in SERIES:
        named = scene.bearing.designation or scene.bearing.name
        raise UsageError(f"--series: makers publish constants for series {', '.join(SERIES)}; name that of {named!r}, or the nearest")
    warn_of_scene(scene, before_results=False)
    with as_usage_error(ValueError), as_failed_run(IntegrationError):
        found = compare(scene, series)
    warm = temperatures(found.temperatures)
    if as_json:
        print_json({"scene": scene.name, **found._replace(temperatures=warm)._asdict()})
        return
    rows = (
        ("model", found.model),
        ("model without hydrodynamic rolling resistance", found.without_resistance),
        ("M_0 + M_1 with f_0 and f_1", found.simple),
        ("SKF's friction model", found.skf),
        ("coefficient 0.0011", found.coefficient),
    )
    title = f"{scene.name}: friction at {number(abs(scene.operating.shaft_speed) * 30 / math.pi, 6)} rpm and {force(scene.operating.radial_load)}"
    known = [("temperatures", words)] if (words := temperatures_text(warm)) else []
    warmth = [*known, ("viscosity", f"{number(found.viscosity)} mm²/s in the contacts")]
    print_table(title, [(name, power(watts)) for name, watts in rows] + warmth)


def _friction_of_catalogue(overrides, table, as_json) -> None:
    from bearing_sim.studies.friction import FILM_BEARINGS, film_rows, moment_table, part_ratios, thermal_speeds

    found, speeds = moment_table(overrides=overrides), thermal_speeds(overrides=overrides)
    rows = [{**one._asdict(), "simple": one.simple, "ratio": one.ratio} for one in found]
    if table is not None:
        with as_file_error():
            write_csv(table, rows)
    with progress_bar("film ratios", len(FILM_BEARINGS)) as show:
        ratios = part_ratios(lambda name: show(FILM_BEARINGS.index(name)), overrides, FILM_BEARINGS)
    films, medians = film_rows(ratios), _medians(found, speeds)
    if as_json:
        tables = {"moments": rows, "thermal_speeds": [one._asdict() for one in speeds], "part_ratios": [one._asdict() for one in ratios]}
        spreads = ("whole", "rolling", "sliding", "slip")
        by_films = [{**one._asdict(), **{name: getattr(one, name)._asdict() for name in spreads}} for one in films]
        print_json({**tables, "films": by_films, "medians": medians})
        return
    _print_moments(found)
    _print_thermal_speeds(speeds)
    _print_films(films)
    print_table("medians", [(name, f"{value:.2f}") for name, value in medians.items()])


def _medians(found, speeds) -> dict[str, float]:
    import numpy as np

    return {
        "moment over M_0 + M_1": float(np.median([one.ratio for one in found])),
        "moment over SKF's friction model": float(np.median([one.model / one.skf for one in found])),
        "thermal speed over NKE's": float(np.nanmedian([one.model / one.nke for one in speeds])),
        "thermal speed over SKF's": float(np.median([one.model / one.skf for one in speeds])),
        "thermal speed over that of SKF's friction model": float(np.median([one.model / one.skf_model for one in speeds])),
    }


def _print_moments(found) -> None:
    rows = [
        (
            one.bearing,
            f"{one.load:.2f}",
            *(
                f"{value:.4g}"
                for value in (one.speed, one.model, one.rolling, one.sliding, one.drag, one.pocket, one.flange, one.viscous, one.by_load, one.skf)
            ),
            f"{one.ratio:.2f}",
        )
        for one in found
    ]
    columns = ("bearing", "P/C_0", "rpm", "model, N mm", "rolling", "sliding", "drag", "pockets", "flanges", "M_0", "M_1", "SKF", "ratio")
    print_rows("frictional moment, and its ratio to M_0 + M_1", columns, rows, words=("bearing",))


def _print_thermal_speeds(speeds) -> None:
    def shown(value):
        return "" if math.isnan(value) else f"{value:.4g}"

    rows = [
        (one.bearing, *(shown(value) for value in (one.model, one.simple, one.skf_model, one.nke, one.skf, one.model / one.nke, one.model / one.skf)))
        for one in speeds
    ]
    columns = ("bearing", "model", "M_0 + M_1", "SKF's friction model", "NKE prints", "SKF prints", "model/NKE", "model/SKF")
    print_rows("thermal reference speed, rpm (ISO 15312)", columns, rows, words=("bearing",))


def _print_films(films) -> None:
    def shown(spread, scale=1.0, digits=".2f"):
        return f"{scale * spread.median:{digits}} ({scale * spread.low:{digits}} to {scale * spread.high:{digits}})"

    rows = [(f"{one.kappa:g}", *(shown(each) for each in (one.whole, one.rolling, one.sliding)), shown(one.slip, 100.0, ".2g")) for one in films]
    title = f"friction over SKF's friction model by film ratio: median (5 to 95 %) of {films[0].count} points, loads from 0.02 to 0.3 C"
    print_rows(title, ("kappa", "whole moment", "rolling over M_rr", "sliding over M_sl", "cage slip [%]"), rows)


@click.command("scenes", cls=WritingCommand)
@click.option("--count", default=500, show_default=True, type=click.IntRange(1, 1_000_000), help="Random scenes.")
@click.option("--level", type=level_type, default="slip", show_default=True, help="Level of fidelity.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the scenes.")
@click.option("--at-most", default="100 s", show_default=True, metavar="S", help="Longest simulated time of a scene.")
@click.option("--journal", type=OutputJournal(), metavar="PATH", help="File from which an interrupted study resumes.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
def scenes(count, level, seed, at_most, journal, workers, as_json):
    """Run random scenes of catalogue bearings until they settle: designation, oil, 0.1 to 1.2 of the limiting speed, 0 to 0.5 C.

    Lists those that do not settle, with what they do.
    """
    from bearing_sim.studies.catalogue_scenes import run_scenes

    announce_compilation()
    with Points(f"{count} scenes at level {level}", count) as points:
        report = run_scenes(count, level, seed, seconds_of(at_most, "--at-most"), journal and journal.path, workers, points.update)
    if as_json:
        print_json(
            {"level": level, "settled": report.settled, "counts": report.counts, "others": [[one._asdict(), *why] for one, *why in report.others]}
        )
        return
    print_table(f"{count} random scenes at level {level}", [(status, str(number)) for status, number in sorted(report.counts.items())])
    if report.others:
        columns = ("designation", "oil", "supply", "temperature [°C]", "speed [rpm]", "load [N]", "status", "what it does")
        print_rows("scenes that did not settle", columns, [[*map(str, one), status, why] for one, status, why in report.others], words=columns)


@click.command("findings")
@click.option("--level", type=click.Choice(["slip", "planar"]), default="slip", show_default=True, help="Level of fidelity.")
@json_option
def findings(level, as_json):
    """Say which published findings about slip the model reproduces: an NU 215 on a rig, and an NU 232 in a wind gearbox.

    They have a direction, no digits that a model could be held to.
    """
    announce_compilation()
    from bearing_sim.studies.published_findings import findings as found

    results = found(level)
    if as_json:
        print_json({"level": level, "findings": [one._asdict() for one in results]})
        return
    rows = [(one.claim, one.source, one.figures, "yes" if one.holds else "no") for one in results]
    columns = ("finding", "source", "the model's cage slip", "holds")
    print_rows(f"published findings at level {level}", columns, rows, words=columns)


@click.command("catalog")
@json_option
def catalog_rules(as_json):
    """Fit the rules for the inside of catalogue bearings again, and state their errors on bearings held back from the fit.

    The first table has every fourth section held back, and each section left out in turn; the second has ISO 281's C_r with known rollers
    over the rating that a maker prints.
    """
    from bearing_sim.studies.catalog_rules import report

    found = report()
    if as_json:
        print_json(found)
        return
    for design, words in (("high_capacity", "high-capacity design (E, EC)"), ("standard", "standard design")):
        one = found[design]
        rules, flange = one["rules"], one["diameter_by_flange"]
        line = f"s = {1e3 * rules['gap']:.3f} mm + {rules['gap_ratio']:.4f} D_w, from {rules['sections']} sections of two widths"
        heights = f"{rules['outer_flange']:.3f} (outer), {rules['inner_flange']:.3f} (inner) of D_w"
        rows = [("gap between rollers", line), ("height of flanges", heights), ("length of rollers", f"{rules['length_ratio']:.3f} B, without a C_0")]
        rows.append(("D_w by outer flange", f"exact for {100 * flange['exact']:.0f} % of {flange['number']}; {_errors(flange)}"))
        for name, said in (("held_back", "every fourth held back"), ("left_out", "each left out in turn")):
            errors = one[name]
            count = errors["count"]
            text = f"Z exact for {100 * count['exact']:.0f} %, at most {count['largest']:.0f} off\nD_w {_errors(errors['diameter'])}\n"
            text += f"effective length {_errors(errors['length'])}\nC_r against the maker's {_errors(errors['dynamic_rating'])}"
            rows.append((f"{said}, {errors['bearings']} bearings", text))
        print_table(words, rows)
    rows = [
        (maker, f"{one['median']:.3f} in the median, {one['least']:.3f} to {one['largest']:.3f}, of {one['number']} bearings")
        for maker, one in found["computed_over_printed"].items()
    ]
    print_table("C_r by ISO 281 over the maker's C, with known numbers of rollers", rows)


def _errors(one) -> str:
    if not one["number"]:
        return "not printed"
    one = {name: 0.0 if value < 1e-9 else value for name, value in one.items()}  # round-off
    return f"off by {100 * one['median']:.2g} % in the median, {100 * one['p95']:.2g} % at 95 %, {100 * one['largest']:.2g} % at most"


@click.command("clearance", cls=WritingCommand)
@scene_argument
@set_option
@click.option("--speed", "speeds", metavar="START:STOP:N", help="Shaft speeds [default: 9 from 20 to 120 % of the scene's].")
@click.option("--load", "loads", metavar="START:STOP:N", help="Radial loads, or one [default: 7 from 0.5 to 3.5 times the scene's].")
@click.option("--life-above", default="10 h", show_default=True, metavar="LIFE", help="Life below which it counts as lost.")
@click.option("-o", "--out", type=OutputTable(), metavar="PATH.parquet", help="Also write the table, and PATH.csv.")
@picture_option("Draw the map; lines with one load")
@json_option
def clearance(scene_name, overrides, speeds, loads, life_above, out, picture, as_json):
    """Map the running clearance of SCENE over speed and load, in thermal equilibrium where it has a thermal network.

    Says at which speeds the clearance is gone, the fit of the shaft is lost, the life is too short, and above which heat closes the bearing
    faster than it leaves, so that there is no equilibrium. Every point is one of level steady.

    bearing-sim study clearance deng2017_table1_cold --speed 15000rpm:52000rpm:9 --load 800N:800N:1 --picture clearance.png
    """
    from pydantic_core import ValidationError

    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.sweep.grid import FieldError, read_axis

    with as_usage_error(SceneError):
        scene = load_scene(scene_name, overrides)
    warn_of_scene(scene)
    announce_compilation()
    from bearing_sim.studies.clearance_map import LOAD, SPEED, draw, in_words, map_clearance
    from bearing_sim.sweep.table import require_same_study, study_digest, write_table

    operating = scene.operating
    defaults = (
        (SPEED, speeds or _from_to(operating.shaft_speed, 0.2, 1.2, 9, "rad/s")),
        (LOAD, loads or _from_to(operating.radial_load, 0.5, 3.5, 7, "N")),
    )
    with as_usage_error(FieldError, ValueError):
        grid = [sorted(read_axis(f"{field}={text}", written=True).values) for field, text in defaults]
        least = quantity_of("--life-above", life_above, "h")
    files, study = [], study_digest("clearance", scene, grid, least)
    if out is not None:
        require_same_study(out, study)
    with progress_bar("points", math.prod(map(len, grid))) as show, as_usage_error(ValidationError):
        found = map_clearance(scene, *grid, least, show)
    with as_file_error():
        if out is not None:
            require_same_study(out, study)
            table = found.table._replace(about=found.table.about | {"command": command_line(), "study": study})
            files += write_table(out.path, table)
        if picture is not None:
            with picture.draft() as draft:
                draw(draft, _title(scene, overrides), found)
            files.append(picture.path)
    words = in_words(found)
    if as_json:
        losses = [each._asdict() for each in found.losses]
        print_json({"scene": scene.name, "heat": scene.heat.law, "found": words, "losses": losses, "points": found.table.rows})
        return
    _print_clearances(found.table)
    for line in words:
        click.echo(line)
    if files:
        click.echo(", ".join(map(str, files)))


def _from_to(value: float, low: float, high: float, count: int, unit: str) -> str:
    return f"{low * value!r} {unit}:{high * value!r} {unit}:{count}"


def _title(scene, overrides) -> str:
    warmth = {"none": "all parts as warm as the oil", "given": "at given temperatures", "network": "in thermal equilibrium"}[scene.heat.law]
    return f"{' '.join([scene.name, *overrides])}: {warmth}"


_CLEARANCE_SHOWN = (
    "operating.shaft_speed",
    "operating.radial_load",
    "running_clearance",
    "fit_clearance",
    "rotation_clearance",
    "heat_clearance",
    "shaft_temperature",
    "inner_ring_temperature",
    "roller_temperature",
    "outer_ring_temperature",
    "oil_outlet_temperature",
    "seat_pressure",
    "cage_slip",
    "life",
    "loss",
    "status",
)


def _print_clearances(table) -> None:
    headings, columns = zip(*(column_texts(table.column(name), table.values(name)) for name in _CLEARANCE_SHOWN))
    title = f"{table.about['scene']}: running clearance, heat.law {table.about['heat']}"
    print_rows(title, headings, zip(*columns), words=("status",), keys=2)


_SHOWN = 12  # reasons per table


@click.command("extremes", cls=WritingCommand)
@click.option("--samples", default=500, show_default=True, type=click.IntRange(0, 1_000_000), help="Scenes of the Latin hypercube per level.")
@click.option("--level", "levels", multiple=True, type=level_type, help="Study this level; can be repeated [default: all].")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the Latin hypercube.")
@click.option("--long/--no-long", default=True, show_default=True, help="Also make the long continuous runs.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
@picture_option("Draw the map")
@csv_option("Write all cases, one per line.")
def extremes(samples, levels, seed, long, workers, as_json, picture, table):
    """Run scenes at the extremes of all parameters and report which finish, are step-limited, are refused or fail.

    Speed, load, play, lobes, rollers, pockets, lands, oil, slices, tolerances and steps from a Latin hypercube, and named corner
    cases, on all cores available to this process.  Scenes that their own settings limit run again at stock settings.  Exit code 1 if any case fails.
    """
    from bearing_sim.studies.extremes import draw, run_extremes, table_rows

    with progress_bar("extremes", 1.0) as progress:
        report, outcomes = run_extremes(samples, levels, seed, long, lambda text: click.echo(f"{text} ...", err=True), progress, workers)
    _write(table, table_rows(outcomes), picture, lambda draft: draw(draft, outcomes))
    if as_json:
        print_json(report)
    else:
        for level, results in report["levels"].items():
            _print_extremes(level, results)
    if report["failed_at_stock"]:
        raise FailedRun(f"{report['failed_at_stock']} step-limited cases failed at stock settings")
    if report["failed"]:
        raise FailedRun(f"{report['failed']} of {sum(report[name] for name in ('finished', 'step_limited', 'refused', 'failed'))} cases failed")


def _print_extremes(level, results) -> None:
    rows = [(name.replace("_", "-"), str(results[name])) for name in ("finished", "step_limited", "refused", "failed")]
    rows += [(f"step-limited by {reason}", str(count)) for reason, count in list(results["step_limited_by"].items())[:_SHOWN]]
    rows += [
        (f"step-limited, at stock settings {status.replace('_', '-')}", str(count)) for status, count in results["step_limited_at_stock"].items()
    ]
    rows += [(f"refused for {reason}", str(count)) for reason, count in list(results["refused_by"].items())[:_SHOWN]]
    rows += [(f"failed: {failure['case']}", failure["reason"]) for failure in results["failures"][:_SHOWN]]
    rows += [(f"failed at stock settings: {failure['case']}", failure["reason"]) for failure in results["failures_at_stock"][:_SHOWN]]
    worst = {
        "steps_per_ms": "most steps per simulated ms",
        "right_hand_sides_per_ms": "most right-hand sides per simulated ms",
        "core_ms_per_ms": "most core time per simulated ms [ms]",
        "step_us": "longest step [us of core time]",
    }
    for kind, scope in (("worst_by_the_model", ""), ("worst", ", including settings that request small steps")):
        rows += [
            (text + scope, f"{results[kind][name]['value']:.4g} ({results[kind][name]['case']})")
            for name, text in worst.items()
            if name in results[kind]
        ]
    rows += [
        (
            f"{run['simulated']:g} s at {run['speed_rpm']:g} rpm",
            run["failure"]
            or f"{run['real_time_factor']:.3g} times real time; drift of slip {run['slip_drift']:.1e}, damage rate {run['damage_drift']:.1e}, energy "
            f"{run['energy_drift']:.1e}; books of energy off by {100 * run['books']:.2g} %; "
            f"angle errors {run['shaft_angle_error']:.1e} shaft, {run['cage_angle_error']:.1e} cage",
        )
        for run in results["long_runs"]
    ]
    print_table(f"extremes at level {level}, {results['core_seconds']:.0f} s of core time", rows)


@click.command("nightly", cls=WritingCommand)
@click.option("--level", "levels", multiple=True, type=level_type, help="Run this level; can be repeated [default: all].")
@click.option(
    "--samples",
    type=click.IntRange(0, 1_000_000),
    help="Scenes of the Latin hypercube per level [default: 2000 at steady and slip, 500 at planar, 200 at spatial].",
)
@click.option("--first", type=click.IntRange(0), metavar="N", help="Run only the first N of these scenes [default: all].")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the Latin hypercube.")
@click.option("--corners/--no-corners", default=True, show_default=True, help="Also run the named corner cases.")
@click.option("--long/--no-long", default=True, show_default=True, help="Also make the long runs: 60 s at planar, 10 min at slip, 24 h at steady.")
@click.option("--journal", type=OutputJournal(), metavar="PATH", help="File from which an interrupted night resumes.")
@csv_option("Write all runs, one per line, with seed and hash of the program.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
def nightly(levels, samples, first, seed, corners, long, journal, table, workers, as_json):
    """Run extreme scenes at stock settings, corners and long runs, and report outcomes and books of energy in one table.

    Every scene runs for at least 50 turns of its cage, or until it settles.  Takes hours.  Exit code 1 if any run fails.
    """
    from bearing_sim.studies.nightly import SAMPLES, run_nightly
    from bearing_sim.sweep.tasks import JournalInUse

    announce_compilation()
    wanted = {level: SAMPLES[level] if samples is None else samples for level in levels or SAMPLES}
    with as_file_error(), as_usage_error(JournalInUse), Points("nightly", 0) as points:
        report = run_nightly(wanted, seed, corners, long, journal and journal.path, workers, points.update, first)
        if table is not None:
            write_csv(table, report.cases)
    if as_json:
        rows = [row._asdict() | {"books": row.books and row.books._asdict()} for row in report.rows]
        print_json({"seed": report.seed, "program": report.program, "failed": report.failed, "rows": rows})
    else:
        _print_nightly(report)
    if report.failed:
        raise FailedRun(f"{report.failed} of {sum(sum(row.counts.values()) for row in report.rows)} runs failed")


def _print_nightly(report) -> None:
    rows = []
    for row in report.rows:
        books = ("", "", "", "") if row.books is None else (*(f"{100 * off:.2g}" for off in row.books[1:4]), row.books.worst)
        rows.append((row.level, row.runs, *map(str, row.counts.values()), *books, f"{row.core_seconds:.0f}"))
    counts = ("finished", "step-limited", "refused", "failed")
    books = ("books off by, %: median", "95 %", "largest", "in")
    print_rows(
        f"seed {report.seed}, program {report.program[:12]}",
        ("level", "runs", *counts, *books, "core [s]"),
        rows,
        words=("level", "runs", "in"),
        width=190,
    )
    for row in report.rows:
        for status, reasons in row.reasons.items():
            for reason, count in list(reasons.items())[:_SHOWN]:
                click.echo(f"{row.level}, {row.runs}: {count} {status.replace('_', '-')}: {reason}")
        for name, reason in row.failures[:_SHOWN]:
            click.echo(f"{row.level}, {row.runs}: {name} failed: {reason}")
