# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scenes at the extremes: a Latin hypercube over everything a scene may be, and corners with names.

All are the bearing ``deng2017_table1`` with fields overridden, so that a row of the study can be run again by
``bearing-sim run deng2017_table1 --set ...``.
"""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from scipy.stats import qmc

from bearing_sim.levels.level import LEVELS
from bearing_sim.studies.stock_bearing import takes

COURSES = ("steady", "steady", "reversal", "stop", "start", "load_step", "ripple")  # of the inputs; steady ones twice as often
_TRACTIONS = ("oil_4109", "constant", "kragelskii", "eyring")
_CROWNS = ("none", "iso_log", "{law: straight_arc, straight_length: 4 mm, crown_radius: 1 m}")
_DIAMETER, _INNER_RADIUS, _CAGE_BORE, _GUIDE_RADIUS = 7e-3, 27.875e-3, 29.6e-3, 33.5e-3  # of the bearing [m]
_LARGEST_PLAY = 1.3  # times what leaves no bar between pockets
_ROLLERS_THAT_FIT = 24  # with bars of the cage between them; for more of them the bearing grows


class Case(NamedTuple):
    """One scene to run."""

    name: str
    level: str
    overrides: tuple[str, ...]
    course: str
    place: Mapping[str, float | str]  # in the map, by dimension
    seconds: float | None = None  # simulated; None leaves it to the study


def _linear(low, high):
    return lambda u: low + (high - low) * u


def _logarithmic(low, high):
    return lambda u: low * (high / low) ** u


def _choice(*options):
    return lambda u: options[min(int(u * len(options)), len(options) - 1)]


def _or_nothing(share, law):
    """Return the law, but exactly 0 for a share of all samples."""
    return lambda u: 0.0 if u < share else law((u - share) / (1.0 - share))


def _speed(u):
    """Return a shaft speed [rpm] of either sense, 0 for one in twenty."""
    signed = 2.0 * u - 1.0
    return 0.0 if abs(signed) < 0.05 else 1e5 * signed


def _clearance(u):
    """Return a clearance at the low points [m], from 50 um of preload to 1 mm, mostly small."""
    return -50e-6 * (1.0 - 2.0 * u) if u < 0.5 else 1e-3 * (2.0 * u - 1.0) ** 3


DIMENSIONS: Mapping[str, Callable] = {
    "shaft_speed_rpm": _speed,
    "radial_load": _or_nothing(0.05, lambda u: 5e4 * u**3),
    "load_angle": _linear(0.0, 2.0 * math.pi),
    "course": _choice(*COURSES),
    "clearance": _clearance,
    "d_value": _or_nothing(0.15, lambda u: 0.5e-3 * u * u),
    "rollers": lambda u: 3 + min(int(58 * u), 57),
    "pocket_clearance": lambda u: u,  # a share, because what is large hangs on the number of rollers
    "guide_clearance": _logarithmic(2.5e-6, 5e-3),
    "cage_mass": _logarithmic(2e-3, 2.0),
    "supported_mass": _or_nothing(0.1, _logarithmic(1e-2, 100.0)),
    "viscosity": _logarithmic(1e-4, 1.0),
    "temperature": _linear(233.15, 523.15),
    "mixture_fraction": _or_nothing(0.1, lambda u: u * u),
    "traction": _choice(*_TRACTIONS),
    "pumping": _choice("false", "false", "true"),
    "centrifugal": _choice("false", "false", "true"),
    "contour_slope": _choice("true", "true", "false"),
    "land_squeeze": _choice("true", "true", "false"),
    "pocket_friction": _or_nothing(0.2, _linear(0.0, 0.3)),
    "method": lambda u: u,  # a share, because each level has methods of its own
    "tolerance": _logarithmic(1e-10, 1e-2),
    "step": _logarithmic(1e-7, 1e-3),
    "slices": lambda u: 1 + min(int(200 * u * u), 199),
    "crown": _choice(*_CROWNS),
    "misalignment": _or_nothing(0.4, lambda u: 5e-3 * u * u),
    "gyroscopic": _choice("true", "true", "false"),
}
# Fields that some levels have no use for; asked of the scene's own checks, level by level.
_BY_LEVEL = {
    "pumping": ("lubricant.pumping={}", "true"),
    "centrifugal": ("bearing.ring_growth.centrifugal={}", "true"),
    "crown": ("bearing.roller.crown={}", "iso_log"),
    "misalignment": ("operating.misalignment={!r}", 1e-3),
}


def sampled_cases(level: str, samples: int, seed: int) -> list[Case]:
    """Return a Latin hypercube of scenes of one level.

    Parameters
    ----------
    samples : how many.
    seed : the same one gives the same scenes.
    """
    ignored = frozenset(name for name, (field, value) in _BY_LEVEL.items() if not takes(level, field.format(value)))
    cases = []
    for number, point in enumerate(qmc.LatinHypercube(len(DIMENSIONS), seed=seed).random(samples)):
        place = {name: law(float(u)) for (name, law), u in zip(DIMENSIONS.items(), point)}
        for name in ignored:
            del place[name]
        place["pocket_clearance"] = _logarithmic(1e-6, _LARGEST_PLAY * _room(place["rollers"]))(place["pocket_clearance"])
        method, fixed = _method(level, place.pop("method"))
        place |= {"method": method, "fixed": fixed}
        cases.append(Case(f"sample {number}", level, tuple(overrides_of(level, place)), place["course"], place))
    return cases


def _room(rollers: int) -> float:
    """Return the pocket clearance at which no bar is left between the pockets [m]."""
    return 0.5 * (2.0 * math.pi * _pitch_radius(rollers) / rollers - _DIAMETER)


def _pitch_radius(rollers: int) -> float:
    return (_INNER_RADIUS + _DIAMETER / 2) * max(rollers / _ROLLERS_THAT_FIT, 1.0)


def _method(level: str, share: float) -> tuple[str, bool]:
    """Return an integrator and whether it keeps to one step: half of all by the level's own, the rest by every other way."""
    methods = LEVELS[level].methods
    own = next(iter(methods))
    others = [(name, False) for name in methods if name != own] + [(name, True) for name, method in methods.items() if method.advance_fixed]
    if share < 0.5 or not others:
        return own, False
    return others[min(int((share - 0.5) * 2.0 * len(others)), len(others) - 1)]


def overrides_of(level: str, place: Mapping) -> list[str]:
    """Return the overrides of the bearing that put a scene at a place of the map.

    Parameters
    ----------
    level : level of the scene.
    place : values by dimension, see `DIMENSIONS`, with ``method`` by name and ``fixed``.
    """
    outward = _pitch_radius(place["rollers"]) - _pitch_radius(1)
    inner = _INNER_RADIUS + outward
    overrides = [
        f"level={level}",
        f"bearing.roller.count={place['rollers']}",
        f"bearing.inner_raceway.radius={inner!r}",
        f"bearing.inner_raceway.bore_radius={inner - 2.8615e-3!r}",
        f"bearing.inner_raceway.supported_mass={place['supported_mass']!r}",
        f"bearing.outer_raceway.low_radius={inner + _DIAMETER + place['clearance']!r}",
        f"bearing.outer_raceway.d_value={place['d_value']!r}",
        f"bearing.outer_raceway.contour_slope={place['contour_slope']}",
        f"bearing.cage.inner_radius={_CAGE_BORE + outward!r}",
        f"bearing.cage.guide_radius={_GUIDE_RADIUS + outward!r}",
        f"bearing.cage.pocket_clearance={place['pocket_clearance']!r}",
        f"bearing.cage.guide_clearance={place['guide_clearance']!r}",
        f"bearing.cage.mass={place['cage_mass']!r}",
        f"bearing.cage.land_squeeze={place['land_squeeze']}",
        f"bearing.cage.pocket_friction={place['pocket_friction']!r}",
        f"bearing.roller.slices={place['slices']}",
        oil_of(place["viscosity"], place["temperature"]),
        f"lubricant.temperature={place['temperature']!r}",
        f"lubricant.mixture_fraction={place['mixture_fraction']!r}",
        f"lubricant.traction={{law: {place['traction']}}}",
        f"dynamics.gyroscopic={place['gyroscopic']}",
        f"operating.shaft_speed={place['shaft_speed_rpm'] * math.pi / 30!r}",
        f"operating.radial_load={place['radial_load']!r}",
        f"operating.load_angle={place['load_angle']!r}",
        f"integration.method={place['method']}",
        f"integration.relative_tolerance={place['tolerance']!r}",
        f"integration.{'fixed' if place['fixed'] else 'maximum'}_step={place['step']!r}",
    ]
    return overrides + [field.format(place[name]) for name, (field, _) in _BY_LEVEL.items() if name in place]


def oil_of(viscosity: float, temperature: float) -> str:
    """Return the override that gives the oil a viscosity [Pa s] at a temperature [K]; else it is like MIL-L-23699."""
    law = f"{{law: reference, temperature: {temperature!r}, viscosity: {viscosity!r}, linear: 3609.6, quadratic: 7.7657e5}}"
    pressure = "{law: power, exponent: 1.15607, constant: 17.496}"
    return (
        f"lubricant.oil={{name: extreme, source: study of extremes, viscosity: {law}, pressure_viscosity: {pressure}, "
        "density_temperatures: [233, 422], densities: [1016, 884]}"
    )
