# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Steps and iterations that levels ``planar`` and ``spatial`` take on several bearings, from creeping to fast and from light to heavy loads.

python test/benchmarks/work_of_steps.py --csv before.csv
python test/benchmarks/work_of_steps.py --against before.csv

Counts of work do not depend on what else the machine does.  What saves work on one bearing may cost a hundred times as much on another: look here
before and after a change of method, first guess or iteration.
"""

import csv
from pathlib import Path

import click

from bearing_sim import IntegrationError, Simulation, load_scene
from bearing_sim.scene.loader import scene_from_yaml
from bearing_sim.scene.quantity import in_digits

CATALOGUE = """
name: work_of_steps
level: planar
bearing: {{preset: {0}}}
lubricant: {{oil: {1}, supply: oil_bath, temperature: 40 degC}}
operating: {{shaft_speed: 1000 rpm, radial_load: 1 kN}}
"""
BEARINGS = {"NU 210/C3": "ISO VG 68", "NU 232": "ISO VG 220"}
POINTS = (
    ("NU 210/C3", 90, "5 kN"), ("NU 210/C3", 90, "20 kN"), ("NU 210/C3", 1000, "5 kN"), ("NU 210/C3", 3000, "1 kN"), ("NU 210/C3", 3000, "20 kN"),
    ("NU 210/C3", 6000, "5 kN"), ("NU 232", 60, "50 kN"), ("NU 232", 600, "50 kN"), ("NU 232", 1500, "2 kN"), ("NU 232", 1500, "20 kN"),
    ("deng2017_table1", 100, "3 kN"), ("deng2017_table1", 2000, "50 kN"), ("deng2017_table1", 5000, "800 N"), ("deng2017_table1", 15000, "800 N"),
    ("deng2017_table1", 25000, "100 N"), ("deng2017_table1", 45000, "800 N"), ("deng2017_table1", 45000, "20 kN"),
)  # fmt: skip
COLUMNS = ("level", "bearing", "speed_rpm", "load", "steps_per_second", "iterations_per_step", "rejected_per_second")


def scene_of(bearing, level, speed, load):
    """Return a scene of a bearing of the catalogue or of a built-in one at a speed [rpm] and a load with its unit."""
    overrides = [f"level={level}", f"operating.shaft_speed={speed} rpm", f"operating.radial_load={load}"]
    if bearing not in BEARINGS:
        return load_scene(bearing, overrides)
    return scene_from_yaml(CATALOGUE.format(bearing, BEARINGS[bearing]), overrides)


def work_of(scene, stretches=12):
    """Return steps a second, iterations a step and rejected steps a second.

    Parameters
    ----------
    scene : what to run.
    stretches : of 32 turns of the shaft, 0.05 to 0.3 s, to count over, after another one to settle.
    """
    run = Simulation(scene)
    span = min(0.3, max(0.05, 200.0 / run.inputs.shaft_speed))
    run.advance(span)
    before = run.counters
    span *= stretches
    run.advance(span)
    steps = run.counters.steps - before.steps
    rejected = run.counters.rejected_steps - before.rejected_steps
    return steps / span, (run.counters.jacobians - before.jacobians) / steps, rejected / span


def row_of(level, point, stretches):
    """Return a row of the table as texts; where the run failed, the work is empty."""
    work = ("", "", "")
    try:
        work = [in_digits(figure, 4) for figure in work_of(scene_of(point[0], level, *point[1:]), stretches)]
    except IntegrationError as error:
        print(f"{level} {' '.join(map(str, point))}: {error}")
    return dict(zip(COLUMNS, (level, *map(str, point), *work), strict=True))


def compared(row, old):
    """Return a row as text, with the ratio of its iterations to those of an earlier row, if there is one and neither failed."""
    words = [row[name] for name in COLUMNS[:4]]
    if not row["steps_per_second"]:
        return "{} {} {} rpm {}: failed".format(*words)
    text = "{:8s} {:16s} {:>6s} rpm {:>6s}: ".format(*words)
    text += "{steps_per_second:>6s} steps a second, {iterations_per_step:>5s} iterations each, {rejected_per_second} rejected a second".format(**row)
    if old is None or not old["steps_per_second"]:
        return text
    now, before = (float(each["steps_per_second"]) * float(each["iterations_per_step"]) for each in (row, old))
    return f"{text}; {now / before:.2f} times the iterations of before"


@click.command()
@click.option("--level", "levels", multiple=True, type=click.Choice(["planar", "spatial"]), default=["planar"], show_default=True)
@click.option("--stretches", default=12, show_default=True, type=click.IntRange(1), help="Of 0.05 to 0.3 s to count over; creeping bearings scatter.")
@click.option("--csv", "path", type=click.Path(dir_okay=False), help="Write the counts to a new table.")
@click.option("--against", type=click.Path(exists=True, dir_okay=False), help="A table of an earlier run to compare with.")
def main(levels, stretches, path, against):
    if path and Path(path).exists():
        raise click.UsageError(f"{path} exists; name a new file")
    earlier = {}
    if against:
        with open(against, newline="") as file:
            earlier = {tuple(row[name] for name in COLUMNS[:4]): row for row in csv.DictReader(file)}
    rows = []
    for level in levels:
        for point in POINTS:
            rows.append(row_of(level, point, stretches))
            print(compared(rows[-1], earlier.get(tuple(rows[-1][name] for name in COLUMNS[:4]))), flush=True)
    if path:
        with open(path, "x", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
