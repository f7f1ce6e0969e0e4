# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far the first guess of a stage is from its solution, and how well the iteration of the whole system contracts.

python test/benchmarks/newton_corrections.py --level planar --speed "5000 rpm"

Starts from a settled state and takes steps in plain Python, because it looks into the iteration: a stage takes some 20 ms.  With ``--second`` every
stage takes a second iteration, which shows how much the first one has left.
"""

import os
from itertools import pairwise

import click
import numpy as np

SETTLING_TURNS = 30.0  # of the cage, from ideal rolling


def settled(level, overrides, speed):
    """Return a settled sample, computed by a process that compiles."""
    import concurrent.futures
    import multiprocessing

    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_settle, level, overrides, speed).result()


def _settle(level, overrides, speed):
    run = _simulation(level, overrides, speed)
    return run.advance(SETTLING_TURNS * 2.0 * np.pi / (0.45 * run.inputs.shaft_speed), samples=2)[-1]


def _simulation(level, overrides, speed):
    from bearing_sim import Simulation, load_scene

    return Simulation(load_scene("deng2017_table1", [f"level={level}", f"operating.shaft_speed={speed}", *overrides]))


def corrections(run, steps, second):
    """Advance by about so many steps; return the sizes of the corrections of every stage, in tolerances.

    Parameters
    ----------
    run : simulation, not compiled.
    second : whether every stage takes a second iteration.
    """
    from bearing_sim.levels.common.model import FIFTH_PITCH, pitch_step
    from bearing_sim.numerics import newton, sdirk2

    if second:
        newton._CONTRACTION = 1e3
    solve, stages = sdirk2.solve_implicit, []

    def recording(rhs_and_jacobian, factor, solve_linear, error_norm, *rest):
        sizes = []

        def norm(*arguments):
            sizes.append(error_norm(*arguments))
            return sizes[-1]

        outcome = solve(rhs_and_jacobian, factor, solve_linear, norm, *rest)
        stages.append(sizes)
        return outcome

    sdirk2.solve_implicit = recording
    longest = pitch_step(run.sample["cage_speed"], run._params.rollers.count, FIFTH_PITCH)
    while len(stages) < 2 * steps:
        run.advance(4.0 * longest)
    sdirk2.solve_implicit = solve
    return stages[4:]  # the slope to extrapolate by is known from the second step on


@click.command()
@click.option("--level", type=click.Choice(["planar", "spatial"]), default="planar", show_default=True)
@click.option("--speed", default="5000 rpm", show_default=True, help="Of the shaft.")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; can be repeated.")
@click.option("--steps", default=80, show_default=True, type=click.IntRange(4))
@click.option("--second", is_flag=True, help="Force a second iteration in every stage.")
def main(level, speed, overrides, steps, second):
    start = settled(level, list(overrides), speed)
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    run = _simulation(level, list(overrides), speed)
    run.resume(start)
    stages = corrections(run, steps, second)
    first = np.array([sizes[0] for sizes in stages])
    print(f"{level}, {speed}: {len(stages)} stages, {np.mean([len(sizes) for sizes in stages]):.2f} iterations each")
    print("first correction, tolerances: median {:.3f}, 90 % {:.3f}, largest {:.3f}".format(*np.quantile(first, [0.5, 0.9, 1.0])))
    for low, high in pairwise([0.0, 0.05, 0.1, 0.2, 0.4, np.inf]):
        chosen = [sizes for sizes in stages if low <= sizes[0] < high and len(sizes) > 1]
        if chosen:
            one, two = np.array([sizes[0] for sizes in chosen]), np.array([sizes[1] for sizes in chosen])
            print(
                f"  {low:4.2f} to {high:4.2f}: {len(chosen):4d} stages, second over first: median {np.median(two / one):.4f}, "
                f"90 % {np.quantile(two / one, 0.9):.4f}; largest second {two.max():.4f}"
            )


if __name__ == "__main__":
    main()
