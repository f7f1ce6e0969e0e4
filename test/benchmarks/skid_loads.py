# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The makers' minimum load of 30 catalogue bearings beside the loads from which the model's cage neither skids nor stays in a skid.

    python test/benchmarks/skid_loads.py [--celsius 20 --celsius 70 --oil "ISO VG 100" --supply circulating --speed 0.5]

The load is the larger one of the load below which a skid lasts and of that from which the slip from ideal rolling is at most a tenth.
"""

import click
import numpy as np

from bearing_sim.model.plausibility import minimum_load
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.cold_oil import SKID, skid_map

BEARINGS = (
    "NU 205", "NU 210", "NU 215", "NU 220", "NU 232", "NJ 206", "NJ 212", "NUP 210", "N 210", "N 220",
    "NU 305", "NU 310", "NU 318", "NU 326", "NJ 308", "NUP 313", "N 310", "NU 1010", "NU 1020", "NU 1032",
    "NU 2205", "NU 2210", "NU 2220", "NJ 2216", "NU 2305", "NU 2308", "NU 2310", "NU 2324", "NJ 2316", "NUP 2210",
)  # fmt: skip
_SHARES = np.geomspace(0.02, 3.0, 26)  # of the minimum load


@click.command()
@click.option("--celsius", multiple=True, type=float, default=(0.0, 20.0, 40.0, 70.0), show_default=True)
@click.option("--oil", default="ISO VG 100", show_default=True)
@click.option("--supply", default="circulating", show_default=True)
@click.option("--speed", default=0.5, show_default=True, help="Over the maker's reference speed.")
def main(celsius, oil, supply, speed):
    """Print the loads, and their ratios to the minimum load."""
    ratios = []
    print("bearing", "minimum load [N]", *(f"{each:g} degC" for each in celsius), "(over the minimum load)")
    for name in BEARINGS:
        operating = {"shaft_speed": "1000 rpm", "radial_load": "1 kN"}
        scene = load_scene({"name": name, "bearing": name, "lubricant": {"oil": oil}, "operating": operating})
        fast = load_scene(scene, [f"operating.shaft_speed={speed * scene.bearing.ratings.reference_speed} rad/s"])
        least = float(minimum_load(fast)[0])
        row = []
        for each in celsius:
            found = skid_map(fast, (supply,), (each,), (least * _SHARES).tolist())
            slipping = [point.load for point in found.points if point.rolling > SKID]
            row.append(max(found.skid_loads[0].load, max(slipping, default=0.0)) / least)
        ratios.append(row)
        print(f"{name:9} {least:9.0f}", *(f"{ratio:6.2f}" for ratio in row), flush=True)
    for words, numbers in (("median", np.median(ratios, axis=0)), ("least", np.min(ratios, axis=0)), ("largest", np.max(ratios, axis=0))):
        print(f"{words:19}", *(f"{ratio:6.2f}" for ratio in numbers))


if __name__ == "__main__":
    main()
