# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim trade``: what speed costs in accuracy on one scene."""

import csv
from pathlib import Path

import click

from bearing_sim.commands.reporting import (
    FailedRun,
    picture_option,
    print_json,
    print_rows,
    progress_bar,
    require_levels,
    tell_compilation,
    told_as_bad_input,
    told_file_faults,
)

_MEASURED = ("real_time_factor", "slip_error_points", "largest_slip_error_points", "load_error", "life_error")
_COLUMNS = ("level", "method", "setting", *_MEASURED, "on_front", "fault")
_FACTORS, _ERRORS = (1.0, 3.0, 10.0, 100.0, 1000.0), (0.01, 0.1, 1.0)


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--level", "levels", multiple=True, metavar="LEVEL", help="Measure this level; may be repeated [default: all].")
@click.option("--factor", type=click.FloatRange(min=0.0, min_open=True), help="Recommend the most accurate setting at this many times real time.")
@click.option(
    "--error", type=click.FloatRange(min=0.0, min_open=True), help="Recommend the fastest setting within this error of slip [percentage points]."
)
@click.option("--csv", "table", type=click.Path(path_type=Path), metavar="PATH.csv", help="Write all settings as a table.")
@picture_option("Draw errors over speed")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
def command(scene_name, overrides, levels, factor, error, table, picture, as_json, quick):
    """Measure every level, integrator and tolerance or step on SCENE: real-time factor against errors in slip, largest roller load and life.

    All run the same manoeuvre from the scene's conditions (the load is halved and restored, the shaft slowed by a fifth) and are compared with a
    tight reference.  Processor time of one core: other programs beside it do not count, but they slow the memory down.
    """
    from bearing_sim.effects import LEVELS
    from bearing_sim.scene_file import SceneError
    from bearing_sim.simulation import IntegrationError

    require_levels(levels)
    tell_compilation()
    from bearing_sim.studies.trade import recommend, settings_of, trade

    total = 1 + sum(len(settings_of(level, quick)) for level in levels or LEVELS)
    with progress_bar("settings", total) as show, told_as_bad_input(SceneError, ValueError):
        done = iter(range(total + 1))
        try:
            found = trade(scene_name, overrides, levels, quick, lambda name: show(next(done)))
        except IntegrationError as fault:
            raise FailedRun(f"the reference: {fault}") from None
    with told_file_faults():
        if table is not None:
            _write(table, found)
        if picture is not None:
            from bearing_sim.studies.trade_picture import draw

            draw(picture, scene_name, found)
    best = recommend(found, factor, error) if factor is not None or error is not None else None
    if as_json:
        print_json(_report(found) | {"recommended": best and best.setting.name})
    else:
        _print(scene_name, found)
        _print_advice(found, factor, error, best)


def _row(found, k):
    one = found.measured[k]
    setting = one.setting
    return dict(zip(_COLUMNS, (setting.level, setting.method, setting.detail, *one[1:6], k in found.front, one.fault)))


def _write(path, found) -> None:
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, _COLUMNS)
        writer.writeheader()
        writer.writerows(_row(found, k) for k in range(len(found.measured)))


def _report(found) -> dict:
    return {
        "reference": found.reference,
        "reference_error": dict(zip(_MEASURED[1:], found.own_error)),
        "simulated_seconds": found.simulated,
        "left_out": found.left_out,
        "settings": [_row(found, k) for k in range(len(found.measured))],
    }


def _print(name, found) -> None:
    rows = []
    for k in sorted(range(len(found.measured)), key=lambda k: -found.measured[k].real_time_factor):
        row = _row(found, k)
        points = f"{row['slip_error_points']:.3f}", f"{row['largest_slip_error_points']:.3f}"
        told = f"{row['real_time_factor']:.3g}", *points, f"{100 * row['load_error']:.2g}", f"{100 * row['life_error']:.2g}"
        rows.append(("*" if row["on_front"] else "", row["level"], row["method"], row["setting"], *told, row["fault"]))
    words, numbers = ("", "level", "method", "setting"), ("x real time", "slip, points", "largest, points", "load, %", "life, %")
    print_rows(f"{name}: against {found.reference}, over {found.simulated:.3g} s", (*words, *numbers, ""), rows, words)
    slip, _, load, life = found.own_error
    click.echo(
        f"* nothing is both faster and closer in slip; the reference itself is good to {slip:.2g} points, {100 * load:.2g} %, {100 * life:.2g} %"
    )
    for level, reason in found.left_out.items():
        click.echo(f"left out: {level} ({reason})")


def _print_advice(found, factor, error, best) -> None:
    from bearing_sim.studies.trade import recommend

    if factor is not None or error is not None:
        click.echo(f"recommended: {_told(best)}" if best else "no setting is that fast and that accurate at once")
        return
    for factor in _FACTORS:
        click.echo(f"for {factor:g} x real time: {_told(recommend(found, factor=factor))}")
    for error in _ERRORS:
        click.echo(f"for {error:g} points of slip: {_told(recommend(found, error=error))}")


def _told(one) -> str:
    if one is None:
        return "nothing"
    options = " ".join(f'--set "{item}"' for item in (f"level={one.setting.level}", *one.setting.overrides))
    return f"{one.setting.name} ({one.real_time_factor:.3g} x real time, {one.slip_error:.2g} points): {options}"
