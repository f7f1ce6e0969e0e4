# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Random scenes of catalogue bearings, round or lobed, in all oils: the same for the same seed."""

import math
import random

from bearing_sim.scene.designation import designations
from bearing_sim.scene.loader import SceneError, load_bearing, scene_from_mapping
from bearing_sim.scene.mounting import CLEARANCE_GROUPS, clearance_limits
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene

_LARGEST_BORE = 0.5  # m, to which ISO 286 has fits here
_CLASSES, _BASES = (2, 5, 10, 22, 32, 46, 68, 100, 150, 220, 320, 460, 1500), ("", " PAO", " ester", " PAG")
_SUPPLIES = ("oil_jet", "circulating", "oil_bath", "oil_air")
_SPEED_FACTOR = 8.3e3  # n d_m where no maker prints a limiting speed [mm/s]
_LOBES = (0, 2, 3, 4, 5, 6, 7, 8, 9)


def random_scenes(seed: int, count: int, level: str, cold: bool = False) -> list[Scene]:
    """Return random scenes with 0 to 9 lobes; scenes that are refused are drawn anew.

    Parameters
    ----------
    cold : whether the oil is cold and thick, and the load below the minimum load, 2 % of C.
    """
    generator, found = random.Random(seed), []
    known = [
        each
        for each in designations()
        if each.boundary.bore <= _LARGEST_BORE and (level in ("steady", "slip") or not each.designation.is_full_complement)
    ]
    while len(found) < count:
        mapping = _draw(generator, generator.choice(known), level, cold)
        try:
            found.append(scene_from_mapping(mapping, mapping["name"]))
        except SceneError:
            continue
    return found


def cold_start(temperature: float = 0.0, load: float = 3000.0, speed: float = 1500.0, level: str = "slip"):
    """Return a gearbox bearing in thick oil, lightly loaded; temperature in degC, load in N, speed in rpm."""
    return scene_from_mapping(
        {
            "name": "cold start",
            "level": level,
            "bearing": "NU 232",
            "lubricant": {"oil": "ISO VG 320", "temperature": f"{temperature} degC", "supply": "oil_bath"},
            "operating": {"shaft_speed": f"{speed} rpm", "radial_load": f"{load} N"},
        },
        "cold start",
    )


def _draw(generator: random.Random, each, level: str, cold: bool) -> dict:
    group = generator.choice(CLEARANCE_GROUPS)
    text = each.designation.text if group == "CN" else f"{each.designation.text}/{group}"
    bearing = load_bearing(text)
    limit = (each.ratings.limiting_speed or _SPEED_FACTOR / (1e3 * bearing.pitch_diameter)) * 30.0 / math.pi
    lobes = generator.choice(_LOBES)
    clearance = 0.5e6 * sum(clearance_limits(group, each.boundary.bore))
    raceway = {"lobes": lobes, "d_value": f"{generator.uniform(0.2, 1.5) * clearance:.3f} um"} if lobes else {}
    temperature, load = generator.uniform(0.0, 120.0), 10.0 ** generator.uniform(-3.0, math.log10(0.3))
    if cold:
        temperature, load = generator.uniform(-10.0, 30.0), 10.0 ** generator.uniform(-3.5, math.log10(0.02))
    oil = f"ISO VG {generator.choice(_CLASSES[5:] if cold else _CLASSES)}{generator.choice(_BASES)}"
    return {
        "name": f"{text}, {lobes} lobes",
        "level": level,
        "bearing": {"preset": text, "outer_raceway": raceway} if lobes else text,
        "lubricant": {"oil": oil, "supply": generator.choice(_SUPPLIES), "temperature": f"{temperature:.1f} degC"},
        "operating": {
            "shaft_speed": f"{generator.choice((-1, 1, 1, 1)) * generator.uniform(0.1, 1.0) * limit:.1f} rpm",
            "radial_load": f"{load * rate(bearing).dynamic:.1f} N",
            "load_angle": f"{generator.uniform(-180.0, 180.0):.1f} deg",
        },
    }
