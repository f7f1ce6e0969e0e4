# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What tolerances are worth near where the inner ring is in resonance with the passing rollers: damage over a stretch against that at finer ones.

python test/benchmarks/resonance.py --speed "22500 rpm" --speed "25000 rpm" --load "100 N"

Each row multiplies the default tolerances of positions, of play and of speeds.
"""

import click

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.options import set_option
from bearing_sim.scene.scene import Integration

FACTORS = ((0.01, 0.01, 0.01), (3.0, 3.0, 3.0), (1.0, 1.0, 1.0), (0.3, 0.3, 0.3), (0.1, 0.1, 0.1))  # the first one is the reference
STRETCH = 0.15  # s


def damage(overrides, factors, settling):
    """Return the damage over the stretch and the steps in a second, with default tolerances times factors of position, play and speed.

    The stretch begins after ``settling`` [s] from the start.
    """
    defaults = Integration()
    position, play, speed = factors
    absolute = defaults.absolute_tolerance
    simulation = Simulation(
        load_scene(
            "deng2017_table1",
            [
                "level=planar",
                *overrides,
                f"integration.absolute_tolerance.position={position * absolute.position:.6g}",
                f"integration.absolute_tolerance.play={play * absolute.play:.6g}",
                f"integration.absolute_tolerance.speed={speed * absolute.speed:.6g}",
                f"integration.relative_tolerance={speed * defaults.relative_tolerance:.6g}",
            ],
        )
    )
    simulation.advance(settling)
    before, steps = float(simulation.sample["damage"]), simulation.counters.steps
    simulation.advance(STRETCH, samples=5)
    return float(simulation.sample["damage"]) - before, (simulation.counters.steps - steps) / STRETCH


@click.command()
@click.option("--speed", "speeds", multiple=True, default=("25000 rpm",), show_default=True, help="Of the shaft; can be repeated.")
@click.option("--load", default="100 N", show_default=True)
@click.option("--settling", default=0.1, show_default=True, help="Before the stretch, in seconds.")
@set_option
def main(speeds, load, settling, overrides):
    """Print the error of the damage at each speed and tolerance."""
    print("factors on tolerances of position, play, speed; damage of the stretch, and its error; steps a second")
    for speed in speeds:
        print(f"{speed}, {load}")
        reference = None
        for factors in FACTORS:
            found, steps = damage([f"operating.shaft_speed={speed}", f"operating.radial_load={load}", *overrides], factors, settling)
            reference = found if reference is None else reference
            error = 100.0 * (found / reference - 1.0)
            print("{:5g} {:5g} {:5g}".format(*factors), f"{found:10.3e}  {error:+7.1f} %  {steps:8.0f}", flush=True)


if __name__ == "__main__":
    main()
