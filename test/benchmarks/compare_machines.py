# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether two machines compute the same: each level over 1 ms of simulated time, from the same sample, on either of them.

python test/benchmarks/compare_machines.py run -o here.npz                       # on one machine
python test/benchmarks/compare_machines.py run -o there.npz --start here.npz     # on the other, with that file copied
python test/benchmarks/compare_machines.py compare here.npz there.npz

The file holds the sample from which each level starts, all samples of the run and the last state.  `compare` prints for each level the
largest difference of any observable, relative to the largest magnitude of that observable in the run, and fails if one exceeds the tolerance.
"""

import json
import math
import platform
from pathlib import Path

import click
import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.level import LEVELS
from bearing_sim.numerics.simd import LANES

SETTLING = 5e-3  # s from ideal rolling to the sample from which a level starts
DURATION, SAMPLES = 1e-3, 20
ZERO = 1e-13  # in SI; what stays below is rounding where the answer is 0, such as the tilt of rollers in an aligned bearing [rad]


def run_level(scene, start):
    """Return the sample from which a level starts, its samples over 1 ms, its last state, and how many steps it took.

    Parameters
    ----------
    scene : of the level.
    start : sample to start from; None: the one that is reached from ideal rolling.
    """
    simulation = Simulation(scene)
    if start is None:
        start = simulation.advance(SETTLING)[-1]
    simulation.resume(start)
    before = simulation.counters.steps
    block = simulation.advance(DURATION, samples=SAMPLES)
    return start, block, simulation.state, simulation.counters.steps - before


def differences(first, second):
    """Return the largest difference of each observable, relative to its largest magnitude in either run, by name.

    It is infinite where one run has a NaN and the other has none, and 0 where both stay below `ZERO`.
    """
    found = {}
    for name in first.dtype.names:
        one, other = np.asarray(first[name], float), np.asarray(second[name], float)
        if (np.isnan(one) != np.isnan(other)).any():
            found[name] = math.inf
            continue
        magnitude = np.nanmax(np.maximum(abs(one), abs(other)), initial=0.0)
        found[name] = float(np.nanmax(abs(one - other), initial=0.0) / magnitude) if magnitude > ZERO else 0.0
    return found


@click.group()
def main():
    """Compare what two machines compute."""


@main.command()
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="File to write (.npz).")
@click.option("--start", type=click.Path(exists=True, path_type=Path), help="File of the other machine, from whose samples to start.")
@click.option("--scene", default="deng2017_table1", show_default=True, help="Bundled scene or scene file.")
@click.option("--level", "levels", multiple=True, type=click.Choice(list(LEVELS)), help="Can be repeated [default: all].")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Change a field of the scene; can be repeated.")
def run(output, start, scene, levels, overrides):
    """Run each level and write its samples to a file."""
    started = np.load(start) if start else {}
    arrays, steps = {}, {}
    for level in levels or LEVELS:
        first = started[f"{level}_start"][0] if start else None
        begun, block, state, steps[level] = run_level(load_scene(scene, [*overrides, f"level={level}"]), first)
        arrays |= {f"{level}_start": np.array([begun]), f"{level}_samples": block, f"{level}_state": state}
        click.echo(f"{level}: {steps[level]} steps")
    machine = {"machine": platform.machine(), "processor": get_host_cpu_name(), "lanes": LANES, "numba": numba.__version__, "numpy": np.__version__}
    np.savez_compressed(output, about=json.dumps(machine | {"scene": scene, "overrides": overrides, "steps": steps}), **arrays)


@main.command()
@click.argument("first", type=click.Path(exists=True))
@click.argument("second", type=click.Path(exists=True))
@click.option("--tolerance", default=1e-9, show_default=True, help="Largest relative difference that passes.")
@click.option("--most", default=3, show_default=True, help="Observables to name, those with the largest differences.")
def compare(first, second, tolerance, most):
    """Print how far two runs differ, level by level; exit with 1 if any differs by more than the tolerance."""
    files = [np.load(first), np.load(second)]
    about = [json.loads(str(file["about"])) for file in files]
    for path, told in zip((first, second), about):
        click.echo(f"{path}: {told['machine']} ({told['processor']}), {told['lanes']} lanes, numba {told['numba']}, NumPy {told['numpy']}")
    exceeded = False
    for level in (name for name in about[0]["steps"] if name in about[1]["steps"]):
        if files[0][f"{level}_start"].tobytes() != files[1][f"{level}_start"].tobytes():
            raise click.ClickException(f"{level}: the runs start from different samples; give --start to one of them")
        one, other = (file[f"{level}_state"] for file in files)
        found = differences(files[0][f"{level}_samples"], files[1][f"{level}_samples"])
        magnitude = np.maximum(abs(one), abs(other))
        found["last state, each number by its own magnitude"] = float((abs(one - other) / np.maximum(magnitude, ZERO))[magnitude > ZERO].max())
        worst = sorted(found, key=found.get, reverse=True)[:most]
        exceeded = exceeded or found[worst[0]] > tolerance
        named = ", ".join(f"{name} {found[name]:.1e}" for name in worst)
        click.echo(f"{level}: {about[0]['steps'][level]} and {about[1]['steps'][level]} steps; {named}")
    raise SystemExit(int(exceeded))


if __name__ == "__main__":
    main()
