# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far the laws of the film and of resistance to rolling are from other laws, inside the range of their originals and beyond it.

Prints Moes' film of all regimes over Dowson and Toyoda's, the elastic resistance of Biboulet and Houpert over that of Goksem and Hargreaves, both by
their formulas, and the rolling power of 60 catalogue bearings at level ``steady`` over that of SKF's model.  Run it with
``python test/benchmarks/laws_beside.py``.
"""

import math
import random

import numpy as np

from bearing_sim.model.validity import Conditions, film_of_all_regimes
from bearing_sim.physics.film import DOWSON_TOYODA
from bearing_sim.scene.designation import designations
from bearing_sim.scene.loader import load_bearing, scene_from_mapping
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.friction import dimensions_of, series_of, skf_moment
from bearing_sim.studies.settle import settle

_BEARINGS, _LARGEST_BORE, _CLASSES = 60, 0.15, (32, 46, 68, 100, 150, 220, 320, 460)
_SERIES = ("10", "2", "3", "22", "23")
_ENDS = (0.0, 1.6e-10, 1e-9, math.inf)  # of 2 U: of the originals, of the range, and beyond


def skf_rolling_power(scene, viscosity: float) -> float:
    """Return the rolling power by SKF's model [W], K_rs = 3e-8; the viscosity is kinematic [mm^2/s]."""
    size, speed, load = dimensions_of(scene), scene.operating.shaft_speed * 30.0 / math.pi, scene.operating.radial_load
    level = 500.0 * scene.bearing.roller.diameter
    moment = skf_moment(series_of(scene.bearing.designation), size, speed, load, viscosity, level).rolling
    return 1e-3 * moment * scene.operating.shaft_speed


def rolling(generator: random.Random, known: list) -> tuple[float, float]:
    """Return the speed parameter 2 U of a random bearing and its rolling power over SKF's."""
    series = limit = None
    while series not in _SERIES or not limit:
        text = generator.choice(known).designation.text
        bearing, series = load_bearing(text), series_of(text)
        limit = bearing.ratings.limiting_speed
    lubricant = {"oil": f"ISO VG {generator.choice(_CLASSES)}", "supply": "circulating", "temperature": f"{generator.uniform(40, 90)} degC"}
    operating = {
        "shaft_speed": f"{generator.uniform(0.2, 0.8) * limit} rad/s",
        "radial_load": f"{generator.uniform(0.02, 0.2) * rate(bearing).dynamic} N",
    }
    scene = scene_from_mapping({"name": text, "level": "steady", "bearing": text, "lubricant": lubricant, "operating": operating}, text)
    found = settle(scene)
    at = Conditions(scene, found.window[-1:])
    viscosity = 1e6 * at.film_viscosity[0] / at.film_density[0]
    return 2.0 * at.film_speed[0], (found.inner_rolling_power + found.outer_rolling_power) / skf_rolling_power(scene, viscosity)


def main() -> None:
    """Measure and print."""
    law, speeds = DOWSON_TOYODA, np.array([1e-12, 1e-11, 1e-10, 1e-9, 4e-9])
    print("U", *(f"{speed:.0e}" for speed in speeds))
    for load in (1e-5, 1e-4, 1e-3):
        elastic = law.factor * speeds**law.speed * 4e3**law.material * load**law.load
        print(f"film, W {load:.0e}, G 4000: Moes over Dowson and Toyoda", *(film_of_all_regimes(speeds, 4e3, load) / elastic).round(2))
    for material in (2.5e3, 4e3, 5e3):
        in_use, other = 4.318 * (material * 0.5 * speeds) ** 0.658 * 1e-4**0.0126 / material, 1.47 * speeds**0.75
        print(f"resistance at 2 U of these, G {material:g}: Biboulet and Houpert over Goksem and Hargreaves", *(other / in_use).round(2))
    known = [each for each in designations() if each.boundary.bore <= _LARGEST_BORE and not each.designation.is_full_complement]
    generator = random.Random(2017)
    found = np.array([rolling(generator, known) for _ in range(_BEARINGS)])
    for low, high in zip(_ENDS, _ENDS[1:]):
        ratios = found[(found[:, 0] > low) & (found[:, 0] <= high), 1]
        print(f"rolling power over SKF's at 2 U from {low:g} to {high:g}: {len(ratios)} bearings, least, median, largest",
              *np.quantile(ratios, [0, 0.5, 1]).round(2))  # fmt: skip


if __name__ == "__main__":
    main()
