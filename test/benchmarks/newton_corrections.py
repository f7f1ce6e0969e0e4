# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far the first guess of a stage is from its solution, and how well the iteration of the whole system contracts.

python test/benchmarks/newton_corrections.py --level planar --speed "5000 rpm"
python test/benchmarks/newton_corrections.py my_bearing.yaml --second

Starts from a settled state and takes steps in plain Python, because it looks into the iteration: a stage takes some 20 ms.  With ``--second`` every
stage takes a second iteration, which shows how much the first one has left, of each kind of state in its own tolerance.
"""

import importlib
import math
import os

import click
import numpy as np

SETTLING_TURNS = 30.0  # of the cage, from ideal rolling


def settled(*arguments):
    """Return a settled sample of `_simulation`, computed by a process that compiles."""
    import concurrent.futures
    import multiprocessing

    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_settle, *arguments).result()


def _settle(*arguments):
    run = _simulation(*arguments)
    return run.advance(SETTLING_TURNS * 2.0 * np.pi / (0.45 * run.inputs.shaft_speed), samples=2)[-1]


def _simulation(scene, level, overrides):
    from bearing_sim import Simulation, load_scene

    return Simulation(load_scene(scene, [f"level={level}", *overrides]))


def kinds(error_norm):
    """Return functions that give the size of a correction in all tolerances, and in those of positions, play and speeds alone."""

    def alone(**others):
        def size(t, y, change, model):
            return error_norm(t, y, change, model._replace(tolerances=model.tolerances._replace(**others)))

        return size

    never = math.inf
    return {
        "all": error_norm,
        "position": alone(play=never, speed=never),
        "play": alone(position=never, speed=never),
        "speed": alone(position=never, play=never),
    }


def corrections(run, steps, second, sizes_of):
    """Advance by about so many steps; return the sizes of the corrections of every stage, in tolerances, by kind.

    Parameters
    ----------
    run : simulation, not compiled.
    steps : how many, at least.
    sizes_of : see `kinds`.
    second : whether every stage takes a second iteration.
    """
    from bearing_sim.levels.common.model import FIFTH_PITCH, pitch_step
    from bearing_sim.numerics import newton, tr_bdf2

    if second:
        newton._CONTRACTION = 1e3
    solve, stages = tr_bdf2.solve_implicit, []

    def recording(kernels, *rest):
        sizes = []

        def norm(*arguments):
            sizes.append({kind: size(*arguments) for kind, size in sizes_of.items()})
            return kernels.correction_norm(*arguments)

        outcome = solve(kernels._replace(correction_norm=norm), *rest)
        stages.append(sizes)
        return outcome

    tr_bdf2.solve_implicit = recording
    longest = pitch_step(run.sample["cage_speed"], run._params.rollers.count, FIFTH_PITCH)
    while len(stages) < 2 * steps:
        run.advance(4.0 * longest)
    tr_bdf2.solve_implicit = solve
    return stages[4:]  # the slope to extrapolate by is known from the second step on


@click.command()
@click.argument("scene", default="deng2017_table1")
@click.option("--level", type=click.Choice(["planar", "spatial"]), default="planar", show_default=True)
@click.option("--speed", help="Of the shaft [default: the scene's].")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; can be repeated.")
@click.option("--steps", default=80, show_default=True, type=click.IntRange(4))
@click.option("--second", is_flag=True, help="Force a second iteration in every stage.")
def main(scene, level, speed, overrides, steps, second):
    overrides = [*overrides, *([f"operating.shaft_speed={speed}"] if speed else [])]
    start = settled(scene, level, overrides)
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    run = _simulation(scene, level, overrides)
    run.resume(start)
    sizes_of = kinds(importlib.import_module(f"bearing_sim.levels.{level}.model").KERNELS.error_norm)
    stages = corrections(run, steps, second, sizes_of)
    print(f"{scene}, {level}: {len(stages)} stages, {np.mean([len(sizes) for sizes in stages]):.2f} iterations each; corrections in tolerances")
    for kind in sizes_of:
        first = np.array([sizes[0][kind] for sizes in stages])
        text = "{:8s}: first correction: median {:.3f}, 90 % {:.3f}, largest {:.3f}".format(kind, *np.quantile(first, [0.5, 0.9, 1.0]))
        pairs = np.array([(sizes[0][kind], sizes[1][kind]) for sizes in stages if len(sizes) > 1 and sizes[0][kind] > 0.0])
        if len(pairs):
            ratios = np.quantile(pairs[:, 1] / pairs[:, 0], [0.5, 0.9])
            text += "; second over first in {} stages: median {:.4f}, 90 % {:.4f}; largest second {:.4f}".format(
                len(pairs), *ratios, pairs[:, 1].max()
            )
        print(text)


if __name__ == "__main__":
    main()
