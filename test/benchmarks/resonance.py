# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What tolerances are worth where the inner ring is in resonance with the passing rollers: damage over a stretch against that at finer tolerances.

python test/benchmarks/resonance.py --speed "25000 rpm" --load "100 N"

Each row multiplies the default tolerances of positions, of play and of speeds.
"""

import click

from bearing_sim import Simulation, load_scene
from bearing_sim.scene.scene import Integration

FACTORS = ((0.03, 0.03, 0.03), (1.0, 1.0, 1.0), (0.4, 1.0, 1.0), (0.3, 1.0, 1.0), (0.2, 1.0, 1.0), (0.3, 0.3, 0.3))  # the first one is the reference
SETTLING, STRETCH = 0.1, 0.15  # s


def damage(overrides, factors):
    """Return the damage over the stretch and the steps in a second, with default tolerances times factors of position, play and speed."""
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
    simulation.advance(SETTLING)
    before, steps = float(simulation.sample["damage"]), simulation.counters.steps
    simulation.advance(STRETCH, samples=5)
    return float(simulation.sample["damage"]) - before, (simulation.counters.steps - steps) / STRETCH


@click.command()
@click.option("--speed", default="25000 rpm", show_default=True)
@click.option("--load", default="100 N", show_default=True)
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; can be repeated.")
def main(speed, load, overrides):
    reference = None
    print(f"{speed}, {load}: factors on tolerances of position, play, speed; error of the damage; steps a second")
    for factors in FACTORS:
        found, steps = damage([f"operating.shaft_speed={speed}", f"operating.radial_load={load}", *overrides], factors)
        reference = found if reference is None else reference
        print("{:5g} {:5g} {:5g}".format(*factors), f"{100.0 * (found / reference - 1.0):+7.1f} %  {steps:8.0f}", flush=True)


if __name__ == "__main__":
    main()
