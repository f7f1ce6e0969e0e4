# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Speed against error of a ring that bends, over the points of its seat and the tolerances of steps: ``python test/benchmarks/bending_front.py``.

The paper's bearing at 45,000 rpm and 800 N in a massive steel housing, line to line; errors are against sixteen points a pitch and a tenth of the
tolerances; times are of a core, beside those of the rigid ring in the same run.
"""

import time

import click

from bearing_sim import Simulation, load_scene
from bearing_sim.scene.scene import tolerance_overrides

RING = "bearing.outer_ring={{width: 10 mm, equivalent_thickness: 3.4 mm, area: 34 mm^2, neutral_radius: 35.8 mm, seat_radius: 37.5 mm, shear: {}}}"
STEEL = "mounting.housing.backing={law: elastic, massive: true, play: 0 um}"


@click.command()
@click.option("--level", default="planar", show_default=True)
@click.option("--seconds", default=0.3, show_default=True, help="Simulated time that is measured.")
@click.option("--shear/--no-shear", default=True, show_default=True)
def main(level, seconds, shear):
    """Print a line for each case."""
    ring = RING.format(str(shear).lower())
    cases = [("rigid", (), 1.0), *((f"{points} points", (ring, STEEL, f"bearing.outer_ring.points={points}"), 1.0) for points in (2, 3, 4, 6, 8, 12))]
    cases += [(f"4 points, tolerances * {factor:.2g}", (ring, STEEL), factor) for factor in (1 / 3, 0.1)]
    _, slip, life, *_ = measured(level, (ring, STEEL, "bearing.outer_ring.points=16"), 0.1, seconds)
    click.echo(f"{'':28} times real time, us a step, right-hand sides a step, slip error [points], life error [%]")
    for name, overrides, tolerance in cases:
        speed, own_slip, own_life, step, sides = measured(level, overrides, tolerance, seconds)
        errors = f"{100 * (own_slip - slip):9.4f} {100 * (own_life / life - 1):9.3f}" if overrides else ""
        click.echo(f"{name:28} {speed:8.2f} {1e6 * step:8.1f} {sides:6.2f} {errors}")


def measured(level, overrides, tolerance, seconds):
    """Return times real time, slip, life [h], and time [s] and right-hand sides of a step, over the simulated time after 0.15 s."""
    simulation = Simulation(load_scene("deng2017_table1", [f"level={level}", *overrides, *tolerance_overrides(tolerance)]))
    first, before, began = simulation.advance(0.15, samples=1)[-1], simulation.counters, time.process_time()
    last = simulation.advance(seconds, samples=1)[-1]
    spent, steps = time.process_time() - began, simulation.counters.steps - before.steps
    gone = [float(last[name] - first[name]) for name in ("cage_angle", "ideal_cage_angle", "damage", "time")]
    sides = (simulation.counters.right_hand_sides - before.right_hand_sides) / steps
    return seconds / spent, 1.0 - gone[0] / gone[1], gone[3] / gone[2] / 3600.0, spent / steps, sides


if __name__ == "__main__":
    main()
