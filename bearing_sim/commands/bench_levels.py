# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench levels``: speed and error of every level and method, on one core."""

import click

from bearing_sim.commands.reporting import print_json, print_rows, require_levels, tell_compilation

_WORDS = ("level", "integrator", "solver")  # columns of text
_WIDTH = 170  # of the tables where there is no terminal


@click.command()
@click.option("--level", "levels", multiple=True, metavar="LEVEL", help="Measure this level; may be repeated [default: all].")
@click.option("--cold", is_flag=True, help="Measure the first start of all, which compiles, too.")
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(levels, cold, quick, as_json):
    """Measure how fast each level and integration method is, how large its errors are, and what bounds it.

    Bearing deng2017_table1 at 800 N, 15,000 and 45,000 rpm.  Other solvers get the same compiled right-hand side.  Takes a minute or two for
    each of the smaller levels once they are compiled, and longer for level spatial.
    """
    require_levels(levels)
    tell_compilation()
    from bearing_sim.studies.bench import run_bench

    report = run_bench(quick, cold, lambda text: click.echo(f"{text} ...", err=True), levels)
    if as_json:
        print_json(report)
    else:
        _print(report)


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
    print_rows("speed", columns + costs, map(cost, cases), words=_WORDS, width=_WIDTH)
    print_rows("errors", columns + errors, map(error, [case for case in cases if not case["fault"]]), words=_WORDS, width=_WIDTH)


def _print_others(others) -> None:
    def row(run):
        told = [_number(run[name]) for name in ("tolerance", "core_seconds", "real_time_factor", "right_hand_sides", "trajectory_error")]
        return [run["level"], f"{run['speed_rpm']:.0f}", run["solver"], *told, run["fault"]]

    columns = ("level", "rpm", "solver", "tolerance", "spent [s]", "x real time", "rhs", "2 ms err", "fault")
    print_rows("other solvers on the same compiled right-hand side, from ideal rolling", columns, map(row, others), words=_WORDS, width=_WIDTH)


def _print_references(references) -> None:
    def row(found):
        names = ("slip_percent", "slip_standard_error", "settled_slip_change", "settled_load_change", "orbit_radius_um", "trajectory_own_error")
        return [found["level"], f"{found['speed_rpm']:.0f}", *[_number(found[name], ".4g") for name in names]]

    columns = ("level", "rpm", "slip [%]", "+-", "change of slip [pp]", "of loads", "orbit [um]", "2 ms own err")
    print_rows(
        "references: the level's own method at a tight tolerance, its change from a less tight one; DOP853 against CVODE at 1e-10",
        columns,
        map(row, references),
        words=_WORDS,
        width=_WIDTH,
    )


def _print_bounds(bounds) -> None:
    names = ("right_hand_side", "jacobian", "factorisation", "solve", "error_norm")

    def row(bound):
        times, shares = bound.get("kernel_us", {}), bound.get("share", {})
        told = [f"{_number(times.get(name))} us, {100 * shares.get(name, 0.0):.0f} %" for name in names]
        steps = [_number(bound.get(name)) for name in ("step_simulated_us", "step_simulated_at_tenfold_tolerance_us")]
        return [bound["level"], bound["integrator"], f"{bound['speed_rpm']:.0f}", *told, f"{100 * shares.get('rest', 0.0):.0f} %", *steps]

    columns = ("level", "integrator", "rpm", "rhs", "jacobian", "factor", "solve", "norm", "rest", "mean step [us]", "at 10x tolerance")
    print_rows("what bounds it: a call of each kernel alone, and its share in a step", columns, map(row, bounds), words=_WORDS, width=_WIDTH)


def _print_scaling(scaling) -> None:
    for level in scaling:
        costs = ", ".join(f"{rollers}: {cost:.3g}" for rollers, cost in zip(level["rollers"], level["core_seconds_per_second"]))
        click.echo(f"{level['level']}, time of a simulated second by rollers: {costs}; power of Z from 18 on {_number(level['exponent'])}")
