# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study misalignment``: edges, tilts, skews and life over the misalignment of the inner ring."""

import csv
from pathlib import Path

import click

from bearing_sim.commands.reporting import (
    FailedRun,
    picture_option,
    print_json,
    print_rows,
    progress_bar,
    tell_compilation,
    told_as_bad_input,
    told_file_faults,
)


@click.command()
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--largest", default=3.0, show_default=True, type=click.FloatRange(0.0, 20.0), metavar="MRAD", help="Largest misalignment.")
@click.option("--points", default=7, show_default=True, type=click.IntRange(2, 1000), help="How many misalignments, from 0 on.")
@click.option("--crown", "crowns", multiple=True, metavar="LAW", help="As bearing.roller.crown; may be repeated [default: none, iso_log].")
@click.option("--slices", default=30, show_default=True, type=click.IntRange(5, 400), help="Slices of a roller (ISO/TS 16281: 30 or more).")
@click.option("--csv", "table", type=click.Path(path_type=Path), metavar="PATH.csv", help="Write the results as a table.")
@picture_option("Draw them")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, overrides, largest, points, crowns, slices, table, picture, as_json):
    """Run SCENE at level spatial with its inner ring held at misalignments from 0 on, with and without a crown."""
    import numpy as np

    from bearing_sim.scene_file import SceneError
    from bearing_sim.simulation import IntegrationError

    tell_compilation()
    from bearing_sim.studies.misalignment import CROWNS, misalign

    crowns = crowns or CROWNS
    done = iter(range(points * len(crowns) + 1))
    with progress_bar("points", points * len(crowns)) as show, told_as_bad_input(SceneError, ValueError):
        try:
            amounts = [round(float(each), 9) for each in 1e-3 * np.linspace(0.0, largest, points)]
            found = misalign(scene_name, overrides, amounts, crowns, slices, tell=lambda name: show(next(done)))
        except IntegrationError as fault:
            raise FailedRun(str(fault)) from None
    rows = [_row(one) for one in found]
    with told_file_faults():
        if table is not None:
            with open(table, "w", newline="") as file:
                writer = csv.DictWriter(file, rows[0])
                writer.writeheader()
                writer.writerows(rows)
        if picture is not None:
            from bearing_sim.studies.misalignment_picture import draw

            draw(picture, f"{scene_name} {' '.join(overrides)}: misalignment of the inner ring, {slices} slices", found)
    if as_json:
        print_json({"scene": scene_name, "slices": slices, "points": rows})
    else:
        _print(scene_name, rows)


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
        "lamina_life_hours": one.lamina_life,
        "static_lamina_life_hours": one.still.lamina_life,
    }


def _print(name, rows) -> None:
    pressures, angles, lives = (
        ("largest, MPa", "inner edge, MPa", "outer edge, MPa"),
        ("tilt, mrad", "skew, mrad"),
        ("life, h", "by slices, h", "no slip, h"),
    )
    texts = [(crown, *(format(number, ".4g") for number in numbers)) for crown, *numbers in (row.values() for row in rows)]
    columns = ("crown", "mrad", "slip, %", *pressures, *angles, *lives)
    print_rows(f"{name}: misalignment of the inner ring, level spatial", columns, texts, words=("crown",))
    click.echo("pressures, tilt and skew: the largest at an instant, in the mean over time; no slip: life by slices in quasi-static balance")
