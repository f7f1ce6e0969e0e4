# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench``, ``trade`` and ``compile``: how fast the model is, what accuracy costs, and compiling ahead of a run."""

import time

import click

from bearing_sim.cli.options import csv_option, json_option, level_type, picture_option, quick_option, scene_argument, set_option
from bearing_sim.cli.outputs import WritingCommand
from bearing_sim.cli.reporting import (
    FailedRun,
    announce_compilation,
    as_file_error,
    as_usage_error,
    print_json,
    print_rows,
    progress_bar,
    write_csv,
)

_WORDS = ("level", "integrator")  # columns of text


@click.command("levels")
@click.option("--level", "levels", multiple=True, type=level_type, help="Measure this level; can be repeated [default: all].")
@click.option("--cold", is_flag=True, help="Also measure the very first start, which compiles.")
@quick_option
@json_option
def levels(levels, cold, quick, as_json):
    """Measure how fast each level is with error control and with a fixed step, what work it does, and how large its errors are.

    Bearing deng2017_table1 at 800 N, 15,000 and 45,000 rpm.  Takes less than a minute per level once compiled, and longer for level spatial.
    """
    announce_compilation()
    from bearing_sim.studies.bench import run_bench

    report = run_bench(quick, cold, lambda text: click.echo(f"{text} ...", err=True), levels)
    if as_json:
        print_json(report)
    else:
        _print_levels(report)


def _print_levels(report) -> None:
    machine = report["machine"]
    click.echo(f"core {machine['core']} of {machine['cores']} ({machine['processor']}), load average {machine['load_average']:.2f} at the start")
    click.echo(f"times are on the core, which the benchmark had for {100 * machine['core_fraction']:.0f} % of the time")
    _print_cases(report["cases"])
    _print_references(report["references"])
    for start in report.get("start_up", []):
        how = "with an empty cache" if start["cold"] else "warm"
        click.echo(
            f"start of {start['level']}, {how}: import {start['import_seconds']:.2f} s, scene {start['scene_seconds']:.2f} s, "
            f"first advance {start['first_advance_seconds']:.2f} s"
        )


def _number(value, form=".3g") -> str:
    return "-" if value is None else format(value, form)


def _print_cases(cases) -> None:
    def named(case):
        return [case["level"], case["integrator"], f"{case['speed_rpm']:.0f}"]

    def cost(case):
        if case["failure"]:
            return [*named(case), case["failure"]]
        steps = case["steps"]
        counted = ("rejected_steps", "right_hand_sides", "jacobians", "factorisations")
        per_step = [None if case[name] is None or not steps else case[name] / steps for name in counted]
        numbers = [case["real_time_factor"], case["step_us"], steps / case["simulated_seconds"], *per_step]
        return [*named(case), *map(_number, numbers)]

    def error(case):
        shares = [case[name] and 100 * case[name] for name in ("load_error", "orbit_error", "pocket_error")]
        slip = [_number(case[name], ".3f") for name in ("slip_error", "slip_standard_error")]
        return [*named(case), *slip, *map(_number, shares)]

    columns = ("level", "integrator", "rpm")
    costs = ("x real time", "us/step", "steps/s", "rejected/step", "rhs/step", "jac/step", "fact/step")
    errors = ("slip [pp]", "standard error", "loads [%]", "orbit [%]", "pocket [%]")
    print_rows("speed", columns + costs, map(cost, cases), words=_WORDS)
    print_rows("errors", columns + errors, map(error, [case for case in cases if not case["failure"]]), words=_WORDS)


def _print_references(references) -> None:
    def row(found):
        names = ("slip_percent", "slip_standard_error", "settled_slip_change", "settled_load_change", "orbit_radius_um")
        return [found["level"], f"{found['speed_rpm']:.0f}", *[_number(found[name], ".4g") for name in names]]

    columns = ("level", "rpm", "slip [%]", "+-", "change of slip [pp]", "of loads", "orbit [um]")
    title = "references: the level's own method at a tight tolerance, and its change from a less tight one"
    print_rows(title, columns, map(row, references), words=_WORDS)


_SPEEDS = (1500.0, 15_000.0, 45_000.0)  # rpm
_SECONDS, _QUICK_SECONDS = 5.0, 0.5  # per run


@click.command("fleet")
@click.option(
    "--level", "levels", multiple=True, default=("steady", "slip", "planar"), show_default=True, type=level_type, help="Level; can be repeated."
)
@quick_option
@json_option
def fleet(levels, quick, as_json):
    """Run more and more bearings deng2017_table1 on one core, at 1500, 15,000 and 45,000 rpm, until it no longer holds real time."""
    announce_compilation()
    report = _measure(levels, quick)
    if as_json:
        print_json(report)
    else:
        _print_fleet(report)


def _measure(levels, quick) -> dict:
    import os

    from bearing_sim.runtime.fleet import most_bearings
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.studies.bench import one_core

    cases = []
    with one_core() as core:
        for level in levels:
            for speed in _SPEEDS[:1] if quick else _SPEEDS:
                click.echo(f"{level} at {speed:g} rpm ...", err=True)
                scene = load_scene("deng2017_table1", [f"level={level}", f"operating.shaft_speed={speed} rpm"])
                cases.append(_case(level, speed, most_bearings(scene, _QUICK_SECONDS if quick else _SECONDS)))
    return {"bearing": "deng2017_table1", "core": core, "load_average": os.getloadavg()[0], "quick": quick, "cases": cases}


def _case(level, speed, runs) -> dict:
    one, most = next(run for run in runs if run.bearings == 1), runs[-1]
    return {
        "level": level,
        "speed_rpm": speed,
        "core_share_of_one": one.core_seconds,
        "expected_from_one": 1.0 / one.core_seconds,
        "bearings": most.bearings if most.holds else 0,
        "core_share_of_each": most.core_seconds,
        "runs": [{**run._asdict(), "holds": run.holds} for run in runs],
    }


def _print_fleet(report) -> None:
    rows = []
    for case in report["cases"]:
        shares = [f"{100 * case[name]:.2f}" for name in ("core_share_of_one", "core_share_of_each")]
        rows.append((case["level"], f"{case['speed_rpm']:.0f}", shares[0], f"{case['expected_from_one']:.0f}", str(case["bearings"]), shares[1]))
    columns = ("level", "rpm", "core for one [%]", "expected", "held", "core for each [%]")
    print_rows("bearings that one core holds in real time, measured by running them, without ROS", columns, rows, words=("level",), width=120)
    click.echo(f"core {report['core']}, load average {report['load_average']:.2f}; 0 held: the machine was busy")


_MEASURED = ("real_time_factor", "slip_error_points", "largest_slip_error_points", "load_error", "life_error")
_COLUMNS = ("level", "setting", *_MEASURED, "on_front", "failure")
_FACTORS, _ERRORS = (1.0, 3.0, 10.0, 100.0, 1000.0), (0.01, 0.1, 1.0)


@click.command("trade", cls=WritingCommand)
@scene_argument
@set_option
@click.option("--level", "levels", multiple=True, type=level_type, help="Measure this level; can be repeated [default: all].")
@click.option("--against", type=level_type, help="Level of the reference [default: planar, or the highest that can compute the scene].")
@click.option("--factor", type=click.FloatRange(min=0.0, min_open=True), help="Recommend the most accurate setting at this multiple of real time.")
@click.option(
    "--error",
    type=click.FloatRange(min=0.0, min_open=True),
    help="Recommend the fastest setting with at most this error of slip [percentage points].",
)
@csv_option("Write all settings to a table.")
@picture_option("Draw error against speed")
@json_option
@quick_option
def trade(scene_name, overrides, levels, against, factor, error, table, picture, as_json, quick):
    """Measure real-time factor and errors in slip, largest roller load and life of every level and tolerance or step on SCENE.

    All settings run the same manoeuvre from the scene's conditions (the load is halved and restored, the shaft slowed by a fifth) and are
    compared with a reference at tight tolerances.  Times are processor time of one core; other programs still slow down shared memory.
    """
    from bearing_sim.scene.fidelity import LEVELS
    from bearing_sim.scene.loader import SceneError
    from bearing_sim.simulation import IntegrationError

    announce_compilation()
    from bearing_sim.studies.trade import recommend, settings_of, trade

    total = 1 + sum(len(settings_of(level, quick)) for level in levels or LEVELS)
    with progress_bar("settings", total) as show, as_usage_error(SceneError, ValueError):
        done = iter(range(total + 1))
        try:
            found = trade(scene_name, overrides, levels, quick, lambda name: show(next(done)), against)
        except IntegrationError as error:
            raise FailedRun(f"the reference failed: {error}") from None
    with as_file_error():
        if table is not None:
            write_csv(table, _rows(found))
        if picture is not None:
            from bearing_sim.studies.trade import draw

            with picture.draft() as draft:
                draw(draft, scene_name, found)
    best = recommend(found, factor, error) if factor is not None or error is not None else None
    if as_json:
        print_json(_report(found) | {"recommended": best and best.setting.name})
    else:
        _print_trade(scene_name, found)
        _print_advice(found, factor, error, best)


def _rows(found) -> list[dict]:
    return [
        dict(zip(_COLUMNS, (one.setting.level, one.setting.detail, *one[1:6], k in found.front, one.failure))) for k, one in enumerate(found.measured)
    ]


def _report(found) -> dict:
    return {
        "reference": found.reference,
        "reference_error": dict(zip(_MEASURED[1:], found.own_error)),
        "simulated_seconds": found.simulated,
        "left_out": found.left_out,
        "settings": _rows(found),
    }


def _print_trade(name, found) -> None:
    rows = []
    for row in sorted(_rows(found), key=lambda row: -row["real_time_factor"]):
        points = f"{row['slip_error_points']:.3f}", f"{row['largest_slip_error_points']:.3f}"
        values = f"{row['real_time_factor']:.3g}", *points, f"{100 * row['load_error']:.2g}", f"{100 * row['life_error']:.2g}"
        rows.append(("*" if row["on_front"] else "", row["level"], row["setting"], *values, row["failure"]))
    words, numbers = ("", "level", "setting"), ("x real time", "slip, points", "largest, points", "load, %", "life, %")
    print_rows(f"{name}: against {found.reference}, over {found.simulated:.3g} s", (*words, *numbers, ""), rows, words)
    slip, _, load, life = found.own_error
    click.echo(
        f"* no setting is both faster and more accurate in slip; error of the reference {slip:.2g} points, {100 * load:.2g} %, {100 * life:.2g} %"
    )
    for level, reason in found.left_out.items():
        click.echo(f"not measured: {level} ({reason})")


def _print_advice(found, factor, error, best) -> None:
    from bearing_sim.studies.trade import recommend

    if factor is not None or error is not None:
        click.echo(f"recommended: {_recommendation(best)}" if best else "no setting is that fast and that accurate")
        return
    for factor in _FACTORS:
        click.echo(f"for {factor:g} x real time: {_recommendation(recommend(found, factor=factor))}")
    for error in _ERRORS:
        click.echo(f"for {error:g} points of slip: {_recommendation(recommend(found, error=error))}")


def _recommendation(one) -> str:
    if one is None:
        return "none"
    options = " ".join(f'--set "{item}"' for item in (f"level={one.setting.level}", *one.setting.overrides))
    return f"{one.setting.name} ({one.real_time_factor:.3g} x real time, {one.slip_error:.2g} points): {options}"


@click.command("compile")
@click.option("--level", "levels", multiple=True, type=level_type, help="Compile this level; can be repeated [default: all].")
@click.option("--fixed-step", is_flag=True, help="Also compile what a scene with integration.fixed_step needs.")
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Number of processes [default: one per core].")
@click.option("--prune", is_flag=True, help="Afterwards remove the compiled code of other versions of bearing_sim.")
def compile_levels(levels, fixed_step, workers, prune):
    """Compile levels now instead of at their first run, in parallel on all cores.

    Compiled code is cached on disk, per user and version of the model; code that is already in the cache is not compiled again.
    """
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.runtime.precompilation import builds, compile_all, remove_other_versions

    wanted, began = builds(levels or tuple(LEVELS), fixed_step), time.monotonic()
    with progress_bar("compiling", len(wanted)) as show:
        for done, build in enumerate(compile_all(wanted, workers), 1):
            click.echo(f"{build}: compiled ({time.monotonic() - began:.0f} s)", err=True)
            show(done)
    if prune:
        click.echo(f"{remove_other_versions() / 1e6:.0f} MB of other versions removed", err=True)
