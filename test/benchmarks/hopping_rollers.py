# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How often rollers lift off from the outer raceway at level ``planar``, and for how long they touch it: by samples at equal short steps.

python test/benchmarks/hopping_rollers.py gearbox.yaml
python test/benchmarks/hopping_rollers.py gearbox.yaml --set "bearing.contact.damping_time=0 us"
"""

import click
import numpy as np

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.options import set_option

SETTLING, STRETCH = 0.6, 0.1  # s


def durations(touching, step):
    """Return how long each contact lasts [s] that begins and ends within the samples.

    Parameters
    ----------
    touching : whether there is a load, shape (samples, rollers).
    step : between samples [s].
    """
    found = []
    for column in touching.T.astype(int):
        begins, ends = (np.flatnonzero(np.diff(column) == change) for change in (1, -1))
        ends = ends[ends > begins[0]] if len(begins) else ends[:0]
        found += ((ends - begins[: len(ends)]) * step).tolist()
    return np.array(found)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("scene")
@set_option
@click.option("--step", default=5e-6, show_default=True, help="In seconds.")
def main(scene, overrides, step):
    """Count contacts of the rollers with the outer raceway."""
    run = Simulation(load_scene(scene, ["level=planar", f"integration.fixed_step={step} s", *overrides]))
    run.advance(SETTLING)
    block = run.advance(STRETCH, samples=round(STRETCH / step))
    found = durations(block["outer_load"] > 0.0, step)
    slip, rollers = 100.0 * block["cage_slip"].mean(), block["outer_load"].shape[1]
    print(f"slip {slip:.2f} %; {len(found) / STRETCH / rollers:.0f} contacts a second of each roller with the outer raceway")
    if len(found):
        print(f"they last {1e6 * np.median(found):.0f} us in the median, 90 % less than {1e6 * np.quantile(found, 0.9):.0f} us")


if __name__ == "__main__":
    main()
