# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scenes with starved inlets, asperities and vortices in the lands, and the fields of the plain models that stand for them."""

import math
from typing import NamedTuple

from bearing_sim import load_scene
from bearing_sim.scene.scene import Scene

RPM = math.pi / 30
FULL = ["lubricant.rolling_resistance=hydrodynamic", "bearing.cage.land_vortices=true"]
STARVED, BY_FILM_RATIO = "lubricant.starvation=skf", "lubricant.mixed_friction=film_ratio"


class Cold(NamedTuple):
    """A scene and the plain models' fields for it."""

    celsius: float
    rpm: float
    load: float  # [N]
    overrides: list[str]
    films: dict  # fields of `reference_films.Films`
    rolling_resistance: bool = True
    land_vortices: bool = True
    bearing: dict | None = None  # block of the scene; None: Deng 2017, Table 1

    def scene(self, level: str, *overrides: str) -> Scene:
        """Return the scene at a level of fidelity."""
        operating = {"shaft_speed": f"{self.rpm} rpm", "radial_load": f"{self.load} N"}
        oil = {"oil": "mil_l_7808", "temperature": f"{self.celsius} degC", "mixture_fraction": 0.03}
        off = {name: "none" for name in ("rolling_resistance", "starvation", "mixed_friction")}
        bearing = self.bearing or "deng2017_table1"
        tree = {"name": "cold", "level": level, "bearing": bearing, "lubricant": oil | off, "operating": operating}
        return load_scene(tree, [*self.overrides, *overrides])

    def fields(self, changes: dict) -> dict:
        """Return the fields that the plain models of levels slip and planar have in common, but for the load; some of them, or of films, changed."""
        found = {
            "temperature": self.celsius + 273.15,
            "shaft_speed": self.rpm * RPM,
            "films": dict(self.films),
            "rolling_resistance": self.rolling_resistance,
            "land_vortices": self.land_vortices,
            "rubbing_in_pockets": None,
        }
        for name, value in changes.items():
            (found if name in found else found["films"])[name] = value
        return found if self.bearing is None else found | _dimensions(self.scene("slip").bearing)


def _dimensions(bearing) -> dict:
    cage, outer, roller = bearing.cage, bearing.outer_raceway, bearing.roller
    return {
        "low_radius": outer.low_radius,
        "d_value": outer.d_value,
        "rollers": roller.count,
        "roller_radius": roller.diameter / 2,
        "length": roller.length,
        "inner_radius": bearing.inner_raceway.radius,
        "bore": bearing.bore_diameter,
        "outer_diameter": bearing.outside_diameter,
        "pocket_clearance": cage.pocket_clearance,
        "cage_mass": cage.mass,
        "cage_width": cage.width,
        "cage_inside": cage.inner_radius,
        "cage_outside": cage.outer_radius,
        "land_width": cage.guide_land_width,
        "land_radius": cage.guide_radius,
        "guide_clearance": cage.guide_clearance,
    }


# 16 rollers on three lobes; SKF's minimum load is 0.15 kN (6 + 4 n/8500 rpm)(70.5/100)^2
NU_210 = {
    "preset": "NU 210",
    "dimensions_at": "running",
    "flanges": {"inner": "none", "outer": "none"},
    "roller": {"crown": "none"},
    "outer_raceway": {"lobes": 3, "d_value": "30 um"},
    "cage": {
        "guidance": "outer_ring",
        "mass": "60 g",
        "width": "14 mm",
        "inner_radius": "33.5 mm",
        "outer_radius": "37.7 mm",
        "guide_radius": "38 mm",
        "guide_clearance": "0.3 mm",
        "guide_land_width": "3 mm",
    },
}
SKF = {"replenishment": 3e-8}
RATIO = {"law": "film_ratio"}
# The minimum load of Deng's bearing, 2 % of C_r, is 604 N.
SCENES = {
    "starved to the most": Cold(0.0, 45000, 2000.0, [*FULL, STARVED, BY_FILM_RATIO], SKF | RATIO),
    "between the minimum load and 1.5 times it": Cold(0.0, 10000, 800.0, [*FULL, STARVED, BY_FILM_RATIO], SKF | RATIO),
    "below the minimum load": Cold(0.0, 10000, 300.0, [*FULL, STARVED, BY_FILM_RATIO], SKF | RATIO),
    "below the minimum load, starved all the same": Cold(
        0.0,
        10000,
        300.0,
        [*FULL, "lubricant.starvation={law: skf, under_minimum_load: starved}", BY_FILM_RATIO],
        SKF | RATIO | {"starved_below": True},
    ),
    "asperities of a slow shaft": Cold(0.0, 60, 800.0, [*FULL, STARVED, BY_FILM_RATIO], SKF | RATIO),
    "asperities by SKF": Cold(
        120.0,
        2000,
        2000.0,
        [*FULL, STARVED, "lubricant.mixed_friction={law: skf, boundary_friction: 0.08}"],
        SKF | {"law": "skf", "boundary_friction": 0.08},
    ),
    "starved, rough and fast": Cold(
        120.0,
        45000,
        2000.0,
        [*FULL, "lubricant.starvation={law: skf, constant: 1.2e-7}", "lubricant.mixed_friction={film_ratio_factor: 0.6}"],
        RATIO | {"replenishment": 1.2e-7, "ratio_factor": 0.6},
    ),
    "asperities in pockets alone, and nothing pumped": Cold(
        120.0,
        15000,
        800.0,
        ["bearing.cage.land_vortices=true", "lubricant.mixed_friction={raceways: false, skew: 0.9, hysteresis: 0.03}"],
        RATIO | {"raceways": False, "skewed": 0.9, "lost": 0.03},
        rolling_resistance=False,
    ),
    "NU 210 with 16 rollers on three lobes": Cold(
        20.0,
        3000,
        700.0,
        [*FULL, STARVED, "lubricant.mixed_friction={film_ratio_factor: 0.3}"],
        SKF | RATIO | {"ratio_factor": 0.3, "minimum_load": 150.0 * (6 + 4 * 3000 / 8500) * 0.705**2},
        bearing=NU_210,
    ),
}
# What changes when a part of a plain model is left as it was with full films; the comparisons must tell each.
OTHERWISE = {
    "full inlets": ("starved to the most", {"replenishment": 0.0}),
    "starved below the minimum load": ("below the minimum load", {"starved_below": True}),
    "whole above the minimum load": ("between the minimum load and 1.5 times it", {"starved_below": True}),
    "no asperities": ("asperities of a slow shaft", {"law": "none"}),
    "asperities of full inlets": ("starved, rough and fast", {"replenishment": 0.0}),
    "none on raceways": ("asperities by SKF", {"raceways": False}),
    "another friction": ("asperities by SKF", {"boundary_friction": 0.0801}),
    "no skew": ("asperities in pockets alone, and nothing pumped", {"skewed": 0.0}),
    "full films in pockets": ("asperities in pockets alone, and nothing pumped", {"rubbing_in_pockets": 0.05}),
    "laminar lands": ("asperities in pockets alone, and nothing pumped", {"land_vortices": False}),
    "nothing pumped": ("below the minimum load", {"rolling_resistance": False}),
    "no hysteresis": ("asperities in pockets alone, and nothing pumped", {"lost": 0.0}),
}
