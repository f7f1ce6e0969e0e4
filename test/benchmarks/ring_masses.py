# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the masses of a ring that bends would do: forces of inertia by waves beside those of rollers, ``python test/benchmarks/ring_masses.py``.

At level slip the ring has no mass.  From its deflections over a roller pitch follows what it would take to accelerate each wave, m_n a_n'', which is
compared with the force of the rollers in that wave: where that is small, the ring may follow the rollers at once.
"""

import math

import click
import numpy as np

from bearing_sim import load_scene
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import pack, ring_section
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.outer_ring import free_frequencies, modal_mass, ring_compliance
from bearing_sim.physics.ring_balance import POINT

RING = "bearing.outer_ring={width: 10 mm, equivalent_thickness: 3.4 mm, area: 34 mm^2, neutral_radius: 35.8 mm, seat_radius: 37.5 mm}"
POSITIONS, WAVES, DENSITY = 64, np.arange(2, 13), 7850.0  # of the scene's steel [kg/m^3]


@click.command()
@click.option("--play", default=0.0, show_default=True, help="Radial play of the ring [um].")
@click.option("--slip", default=0.08, show_default=True, help="Of the cage.")
def main(play, slip):
    """Print a line for each number of waves, for the paper's bearing in a massive steel housing."""
    scene = load_scene("deng2017_table1", [RING, f"mounting.housing.backing={{law: elastic, massive: true, play: {play} um}}"])
    params, work, ring = pack(scene), new_work(pack(scene)), ring_section(scene.bearing)
    cage = 0.5 * scene.operating.shaft_speed * (1 - params.raceways.diameter_ratio) * (1 - slip)
    pushed, bent, count = [], [], params.rollers.count
    for k in range(-8, POSITIONS):
        angle = 2 * math.pi * k / (count * POSITIONS)
        assert balance_loads(angle, cage, 800.0, 0.0, params, work)
        outer, seat = work.loads[LOAD.outer], work.bending.points[POINT.force, :-2]
        rollers = np.exp(1j * np.outer(WAVES, angle + 2 * math.pi * np.arange(count) / count)) @ outer
        held = np.exp(1j * np.outer(WAVES, angle + 2 * math.pi * np.arange(len(seat)) / len(seat))) @ seat
        if k >= 0:
            pushed.append(rollers)
            bent.append(ring_compliance(WAVES, ring) * (rollers - held))
    period = 2 * math.pi / (count * cage)
    harmonics = np.fft.fftfreq(POSITIONS, 1 / POSITIONS)[:, None] * 2 * math.pi / period
    accelerations = np.fft.ifft(-(harmonics**2) * np.fft.fft(bent, axis=0), axis=0)
    inertia = modal_mass(WAVES, ring, DENSITY) * accelerations
    click.echo("waves, free ring [kHz], deflection [um], force of rollers [N], of inertia [N], ratio [%]")
    for n, own, a, force, mass in zip(
        WAVES, free_frequencies(WAVES, ring, DENSITY) / 2e3 / math.pi, *(map(_size, (np.array(bent).T, np.array(pushed).T, inertia.T)))
    ):
        click.echo(f"{n:5d} {own:10.2f} {1e6 * a:12.3f} {force:12.1f} {mass:12.2f} {100 * mass / force:10.2f}")


def _size(rows):
    """Return the root mean squares of rows."""
    return np.sqrt((np.abs(rows) ** 2).mean(axis=1))


if __name__ == "__main__":
    main()
