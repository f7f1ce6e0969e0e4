# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench``: speed and error of every level and method, on one core."""

import click

from bearing_sim.commands import bench_fleet
from bearing_sim.commands.reporting import BadInput, print_json, tell_compilation


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--level", "levels", multiple=True, metavar="LEVEL", help="Measure this level; may be repeated [default: all].")
@click.option("--cold", is_flag=True, help="Measure the first start of all, which compiles, too.")
@click.option("--recording", is_flag=True, help="Measure instead what recording and a live view cost a run (levels slip and planar).")
@click.option("--seconds", type=click.FloatRange(min=0.5), default=3.0, show_default=True, metavar="S", help="With --recording: of a stretch.")
@click.option("--rate", type=click.FloatRange(min=1), default=1000.0, show_default=True, metavar="HZ", help="With --recording: samples a second.")
@click.option("--repetitions", type=click.IntRange(min=1), default=12, show_default=True, metavar="N", help="With --recording: pairs.")
@click.option("--fleet", is_flag=True, help="Measure instead how many bearings one core holds in real time, by running them.")
@click.option("--view", is_flag=True, help="Measure instead what a live view costs the solver whatever viewers do, and how an hour opens.")
@click.option("--frozen", default=60.0, show_default=True, metavar="S", help="With --view: how long the viewer is frozen.")
def command(as_json, quick, levels, cold, recording, seconds, rate, repetitions, fleet, view, frozen):
    """Measure how fast each level and integration method is, how large its errors are, and what bounds it.

    Bearing deng2017_table1 at 800 N, 15,000 and 45,000 rpm.  Other solvers get the same compiled right-hand side.  Takes a minute or two for
    each of the smaller levels once they are compiled, and longer for level spatial.
    """
    if view:
        from bearing_sim.commands.bench_view import measure_view

        measure_view(as_json, quick, frozen)
        return
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.studies.bench import run_bench

    for level in levels:
        if level not in LEVELS:
            raise BadInput(f"--level {level}: expected one of {', '.join(LEVELS)}")

    tell_compilation()
    if recording:
        _recording(levels or ("slip", "planar"), 0.5 if quick else seconds, rate, 1 if quick else repetitions, as_json)
        return
    if fleet:
        bench_fleet.run(as_json, quick, levels)
        return
    report = run_bench(quick, cold, lambda text: click.echo(f"{text} ...", err=True), levels)
    if as_json:
        print_json(report)
    else:
        _print(report)


def _recording(levels, seconds, rate, pairs, as_json) -> None:
    from bearing_sim.scene_file import load_scene
    from bearing_sim.studies.bench_recording import at_level, recording_cost

    def told(level):
        return lambda text: click.echo(f"{level}: {text} ...", err=True)

    scene = load_scene("deng2017_table1")
    reports = [recording_cost(at_level(scene, level), seconds, rate, pairs, progress=told(level)) for level in levels]
    if as_json:
        print_json({"recording": reports})
        return
    for report in reports:
        _print_recording(report)


_RECORDING = {
    "rate": "rate by wall time, of that without",
    "core_rate": "rate while a core was to be had",
    "processor_rate": "rate by its thread's processor time",
    "worst_stall_ms": "worst stall [ms], beyond that without",
    "late_stall_ms": "99.9 % of ticks stall less [ms], beyond",
    "worst_held_ms": "worst stall but for waits for a core [ms], beyond",
    "late_held_ms": "99.9 % of these [ms], beyond",
}


def _print_recording(report) -> None:
    def spread(found):
        return f"{found['median']:.3f} ({found['low']:.3f} to {found['high']:.3f})"

    rows = [
        (meaning, spread(report["with"][name]), spread(report["control"][name]), _number(report["without"][name]))
        for name, meaning in _RECORDING.items()
    ]
    title = (
        f"{report['level']}: recording at {report['sample_rate']:g} Hz and a live view (viewer: {report['viewer']}), {report['pairs']} pairs of "
        f"stretches of {report['seconds']:g} s"
    )
    _table(title, ("recording", "with", "control, without", "without"), rows)
    click.echo(
        f"median, and where it lies with 95 % confidence; {report['recording_mb_per_second']:.3g} MB/s written, {report['dropped']} blocks missed; "
        f"load average {report['load_average']:.2f}, {100 * report['stolen_share']:.1f} % of the processors' time stolen by the host"
    )


def _print(report) -> None:
    machine = report["machine"]
    click.echo(f"core {machine['core']} of {machine['cores']} ({machine['processor']}), load average {machine['load_average']:.2f} at the start")
    click.echo(f"times on the core, which the bench had for {100 * machine['share_of_core']:.0f} % of the time")
    _print_cases(report["cases"])
    _print_others(report["others"])
    _print_references(report["references"])
    _print_bounds(report["bound"])
    _print_scaling(report["scaling"])
    for start in report.get("start_up", []):
        how = "with an empty cache" if start["cold"] else "warm"
        click.echo(
            f"start of {start['level']}, {how}: import {start['import_seconds']:.2f} s, scene {start['scene_seconds']:.2f} s, "
            f"first advance {start['first_advance_seconds']:.2f} s"
        )


def _table(title, columns, rows) -> None:
    import sys

    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for name in columns:
        table.add_column(name, justify="left" if name in {"level", "integrator", "solver", "recording"} else "right")
    for row in rows:
        table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else 170).print(table)


def _number(value, form=".3g") -> str:
    return "-" if value is None else format(value, form)


def _print_cases(cases) -> None:
    def named(case):
        return [case["level"], case["integrator"], f"{case['speed_rpm']:.0f}", str(case["rollers"])]

    def cost(case):
        if case["fault"]:
            return [*named(case), case["fault"]]
        steps = case["steps"]
        counted = ("rejected_steps", "right_hand_sides", "jacobians", "factorisations")
        per_step = [None if case[name] is None or not steps else case[name] / steps for name in counted]
        told = [case["real_time_factor"], case["step_us"], steps / case["simulated_seconds"], *per_step]
        return [*named(case), *map(_number, told), _number(case["lsoda_ratio"], ".0f"), _number(case["lsoda_ratio_at_our_error"], ".0f")]

    def error(case):
        shares = [case[name] and 100 * case[name] for name in ("load_error", "orbit_error", "pocket_error")]
        slip = [_number(case[name], ".3f") for name in ("slip_error", "slip_standard_error")]
        return [*named(case), *slip, *map(_number, shares), _number(case["trajectory_error"])]

    columns = ("level", "integrator", "rpm", "Z")
    costs = ("x real time", "us/step", "steps/s", "rejected/step", "rhs/step", "jac/step", "fact/step", "x LSODA", "at our error")
    errors = ("slip [pp]", "standard error", "loads [%]", "orbit [%]", "pocket [%]", "first 2 ms")
    _table("speed", columns + costs, map(cost, cases))
    _table("errors", columns + errors, map(error, [case for case in cases if not case["fault"]]))


def _print_others(others) -> None:
    def row(run):
        told = [_number(run[name]) for name in ("tolerance", "core_seconds", "real_time_factor", "right_hand_sides", "trajectory_error")]
        return [run["level"], f"{run['speed_rpm']:.0f}", run["solver"], *told, run["fault"]]

    columns = ("level", "rpm", "solver", "tolerance", "spent [s]", "x real time", "rhs", "2 ms err", "fault")
    _table("other solvers on the same compiled right-hand side, from ideal rolling", columns, map(row, others))


def _print_references(references) -> None:
    def row(found):
        names = ("slip_percent", "slip_standard_error", "settled_slip_change", "settled_load_change", "orbit_radius_um", "trajectory_own_error")
        return [found["level"], f"{found['speed_rpm']:.0f}", *[_number(found[name], ".4g") for name in names]]

    columns = ("level", "rpm", "slip [%]", "+-", "change of slip [pp]", "of loads", "orbit [um]", "2 ms own err")
    _table(
        "references: the level's own method at a tight tolerance, its change from a less tight one; DOP853 against CVODE at 1e-10",
        columns,
        map(row, references),
    )


def _print_bounds(bounds) -> None:
    names = ("right_hand_side", "jacobian", "factorisation", "solve", "error_norm")

    def row(bound):
        times, shares = bound.get("kernel_us", {}), bound.get("share", {})
        told = [f"{_number(times.get(name))} us, {100 * shares.get(name, 0.0):.0f} %" for name in names]
        steps = [_number(bound.get(name)) for name in ("step_simulated_us", "step_simulated_at_tenfold_tolerance_us")]
        return [bound["level"], bound["integrator"], f"{bound['speed_rpm']:.0f}", *told, f"{100 * shares.get('rest', 0.0):.0f} %", *steps]

    columns = ("level", "integrator", "rpm", "rhs", "jacobian", "factor", "solve", "norm", "rest", "mean step [us]", "at 10x tolerance")
    _table("what bounds it: a call of each kernel alone, and its share in a step", columns, map(row, bounds))


def _print_scaling(scaling) -> None:
    for level in scaling:
        costs = ", ".join(f"{rollers}: {cost:.3g}" for rollers, cost in zip(level["rollers"], level["core_seconds_per_second"]))
        click.echo(f"{level['level']}, time of a simulated second by rollers: {costs}; power of Z from 18 on {_number(level['exponent'])}")
