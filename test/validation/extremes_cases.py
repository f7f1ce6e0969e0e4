# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scenes at the extremes: a Latin hypercube over the fields of a scene, and named corners.

All are overrides of the scene ``deng2017_table1``, so that ``bearing-sim run deng2017_table1 --set ...`` repeats any of them.
"""

import math
from collections.abc import Callable, Mapping

from scipy.stats import qmc

from bearing_sim.levels.level import LEVELS
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.studies.extreme_run import COURSES, Case
from bearing_sim.studies.extremes import choice, linear, logarithmic, or_zero, takes

_TRACTIONS = ("oil_4109", "constant", "kragelskii", "eyring")
_CROWNS = ("none", "iso_log", "{law: straight_arc, straight_length: 4 mm, crown_radius: 1 m}")
_DIAMETER, _INNER_RADIUS, _CAGE_BORE, _GUIDE_RADIUS = 7e-3, 27.875e-3, 29.6e-3, 33.5e-3  # of the bearing [m]
_LARGEST_PLAY = 1.3  # times the clearance that leaves no bar between pockets
_WIDEST_POCKET = 5e-3  # m of pocket clearance, the most that a scene takes; a corner asks for it
_ROLLERS_THAT_FIT = 24  # with bars of the cage between them; for more rollers the bearing grows


def at_stock(case: Case) -> Case:
    """Return a case without its settings of the integration."""
    return case._replace(overrides=tuple(each for each in case.overrides if not each.startswith("integration.")))


def _speed(u):
    """Return a shaft speed [rpm] in either direction, 0 for one sample in twenty."""
    signed = 2.0 * u - 1.0
    return 0.0 if abs(signed) < 0.05 else 1e5 * signed


def _clearance(u):
    """Return a clearance at the low points [m], from 50 um of preload to 1 mm, mostly small."""
    return -50e-6 * (1.0 - 2.0 * u) if u < 0.5 else 1e-3 * (2.0 * u - 1.0) ** 3


DIMENSIONS: Mapping[str, Callable] = {
    "shaft_speed_rpm": _speed,
    "radial_load": or_zero(0.05, lambda u: 5e4 * u**3),
    "load_angle": linear(0.0, 2.0 * math.pi),
    "course": choice(*COURSES),
    "clearance": _clearance,
    "d_value": or_zero(0.15, lambda u: 0.5e-3 * u * u),
    "rollers": lambda u: 3 + min(int(58 * u), 57),
    "pocket_clearance": lambda u: u,  # scaled below, because its range depends on the number of rollers
    "guide_clearance": logarithmic(2.5e-6, 5e-3),
    "cage_mass": logarithmic(2e-3, 2.0),
    "supported_mass": or_zero(0.1, logarithmic(1e-2, 100.0)),
    "viscosity": logarithmic(1e-4, 1.0),
    "temperature": linear(233.15, 523.15),
    "mixture_fraction": or_zero(0.1, lambda u: u * u),
    "traction": choice(*_TRACTIONS),
    "rolling_resistance": choice("none", "none", "hydrodynamic"),
    "dimensions_at": choice("running", "running", "cold"),
    "contour_slope": choice("true", "true", "false"),
    "land_squeeze": choice("true", "true", "false"),
    "pocket_friction": or_zero(0.2, linear(0.0, 0.3)),
    "fixed": choice(False, False, False, True),
    "tolerances": logarithmic(1e-8, 1.0),  # times the default ones
    "step": logarithmic(1e-7, 1e-3),
    "slices": lambda u: 0 if u < 0.5 else 1 + min(int(200 * (2 * u - 1) ** 2), 199),  # 0: the quadrature
    "crown": choice(*_CROWNS),
    "misalignment": or_zero(0.4, lambda u: 5e-3 * u * u),
    "gyroscopic": choice("true", "true", "false"),
}
# Fields that some levels refuse, according to the checks of the scene.
_BY_LEVEL = {
    "rolling_resistance": ("lubricant.rolling_resistance={}", "hydrodynamic"),
    "crown": ("bearing.roller.crown={}", "iso_log"),
    "misalignment": ("operating.misalignment={!r}", 1e-3),
}


def sampled_cases(level: str, samples: int, seed: int) -> list[Case]:
    """Return a Latin hypercube of scenes of one level.

    Parameters
    ----------
    samples : number of scenes.
    seed : the same seed gives the same scenes.
    """
    ignored = frozenset(name for name, (field, value) in _BY_LEVEL.items() if not takes(BEARING, [f"level={level}", field.format(value)]))
    cases = []
    for number, row in enumerate(qmc.LatinHypercube(len(DIMENSIONS), seed=seed).random(samples)):
        point = {name: law(float(u)) for (name, law), u in zip(DIMENSIONS.items(), row)}
        for name in ignored:
            del point[name]
        point["pocket_clearance"] = logarithmic(1e-6, min(_LARGEST_PLAY * _room(point["rollers"]), _WIDEST_POCKET))(point["pocket_clearance"])
        point["fixed"] = point["fixed"] and LEVELS[level].takes_steps
        cases.append(Case(f"sample {number}", level, tuple(overrides_of(level, point)), point["course"], point))
    return cases


def _room(rollers: int) -> float:
    """Return the pocket clearance at which no bar is left between the pockets [m]."""
    return 0.5 * (2.0 * math.pi * _pitch_radius(rollers) / rollers - _DIAMETER)


def _pitch_radius(rollers: int) -> float:
    return (_INNER_RADIUS + _DIAMETER / 2) * max(rollers / _ROLLERS_THAT_FIT, 1.0)


def overrides_of(level: str, point: Mapping) -> list[str]:
    """Return the overrides for a point of the map.

    Parameters
    ----------
    level : of the scene.
    point : values by dimension, see `DIMENSIONS`.
    """
    outward = _pitch_radius(point["rollers"]) - _pitch_radius(1)
    inner = _INNER_RADIUS + outward
    overrides = [
        f"level={level}",
        f"bearing.dimensions_at={point['dimensions_at']}",
        f"bearing.roller.count={point['rollers']}",
        f"bearing.inner_raceway.radius={inner!r}",
        f"bearing.inner_raceway.bore_radius={inner - 2.8615e-3!r}",
        f"support.shaft.mass={point['supported_mass']!r}",
        f"bearing.outer_raceway.low_radius={inner + _DIAMETER + point['clearance']!r}",
        f"bearing.outer_raceway.d_value={point['d_value']!r}",
        f"bearing.outer_raceway.outside_radius={inner + _DIAMETER + point['clearance'] + point['d_value'] + 1.74e-3!r}",
        f"bearing.outer_raceway.contour_slope={point['contour_slope']}",
        f"bearing.cage.inner_radius={_CAGE_BORE + outward!r}",
        f"bearing.cage.guide_radius={_GUIDE_RADIUS + outward!r}",
        f"bearing.cage.pocket_clearance={point['pocket_clearance']!r}",
        f"bearing.cage.guide_clearance={point['guide_clearance']!r}",
        f"bearing.cage.mass={point['cage_mass']!r}",
        f"bearing.cage.land_squeeze={point['land_squeeze']}",
        f"bearing.cage.pocket_friction={point['pocket_friction']!r}",
        f"bearing.roller.slices={point['slices'] or 'null'}",
        oil_of(point["viscosity"], point["temperature"]),
        f"lubricant.temperature={point['temperature']!r}",
        f"lubricant.mixture_fraction={point['mixture_fraction']!r}",
        f"lubricant.traction={{law: {point['traction']}}}",
        f"dynamics.gyroscopic={point['gyroscopic']}",
        f"operating.shaft_speed={point['shaft_speed_rpm'] * math.pi / 30!r} rad/s",
        f"operating.radial_load={point['radial_load']!r}",
        f"operating.load_angle={point['load_angle']!r}",
        *tolerance_overrides(point["tolerances"]),
        f"integration.{'fixed' if point['fixed'] else 'maximum'}_step={point['step']!r}",
    ]
    return overrides + [field.format(point[name]) for name, (field, _) in _BY_LEVEL.items() if name in point]


def oil_of(viscosity: float, temperature: float) -> str:
    """Return the override for an oil of a given viscosity [Pa s] at a temperature [K], otherwise like MIL-L-23699."""
    law = f"{{law: reference, temperature: {temperature!r}, viscosity: {viscosity!r}, linear: 3609.6, quadratic: 7.7657e5}}"
    pressure = "{law: power, exponent: 1.15607, constant: 17.496}"
    return (
        f"lubricant.oil={{name: extreme, source: study of extremes, viscosity: {law}, pressure_viscosity: {pressure}, "
        "density_temperatures: [233, 422], densities: [1016, 884]}"
    )


_WARM = 393.15  # K
_SPEED, _LOAD, _LOW, _CAGE = "operating.shaft_speed", "operating.radial_load", "bearing.outer_raceway.low_radius", "bearing.cage"
_TOUCHING = 34.875e-3  # m, low radius without play

# name: overrides, course of the inputs
CORNERS = {
    "stock": ([], "steady"),
    "at rest": ([f"{_SPEED}=0"], "steady"),
    "at rest, no load": ([f"{_SPEED}=0", f"{_LOAD}=0"], "steady"),
    "1 rpm": ([f"{_SPEED}=1 rpm"], "steady"),
    "100,000 rpm": ([f"{_SPEED}=100000 rpm"], "steady"),
    "-100,000 rpm": ([f"{_SPEED}=-100000 rpm"], "steady"),
    "100,000 rpm, no load": ([f"{_SPEED}=100000 rpm", f"{_LOAD}=0"], "steady"),
    "100,000 rpm, 50 kN": ([f"{_SPEED}=100000 rpm", f"{_LOAD}=50 kN"], "steady"),
    "reversal at 45,000 rpm": ([], "reversal"),
    "reversal at 100,000 rpm": ([f"{_SPEED}=100000 rpm"], "reversal"),
    "stop from 45,000 rpm": ([], "stop"),
    "stop from -100,000 rpm": ([f"{_SPEED}=-100000 rpm"], "stop"),
    "start to 45,000 rpm": ([], "start"),
    "start to 100,000 rpm": ([f"{_SPEED}=100000 rpm"], "start"),
    "start to 100,000 rpm, no load": ([f"{_SPEED}=100000 rpm", f"{_LOAD}=0"], "start"),
    "no load": ([f"{_LOAD}=0"], "steady"),
    "50 kN": ([f"{_LOAD}=50 kN"], "steady"),
    "50 kN at rest": ([f"{_LOAD}=50 kN", f"{_SPEED}=0"], "steady"),
    "steps of 50 kN": ([f"{_LOAD}=50 kN"], "load_step"),
    "steps of 50 kN at rest": ([f"{_LOAD}=50 kN", f"{_SPEED}=0"], "load_step"),
    "ripple on 800 N": ([], "ripple"),
    "ripple on 50 kN": ([f"{_LOAD}=50 kN"], "ripple"),
    "1 mm loose": ([f"{_LOW}={_TOUCHING + 1e-3!r}"], "steady"),
    "1 mm loose, no load": ([f"{_LOW}={_TOUCHING + 1e-3!r}", f"{_LOAD}=0"], "steady"),
    "1 mm loose, steps of 50 kN": ([f"{_LOW}={_TOUCHING + 1e-3!r}", f"{_LOAD}=50 kN"], "load_step"),
    "3.5 mm loose": ([f"{_LOW}={_TOUCHING + 3.5e-3!r}"], "steady"),
    "4 mm loose": ([f"{_LOW}={_TOUCHING + 4e-3!r}"], "steady"),
    "50 um of preload": ([f"{_LOW}={_TOUCHING - 50e-6!r}"], "steady"),
    "50 um of preload, 100,000 rpm": ([f"{_LOW}={_TOUCHING - 50e-6!r}", f"{_SPEED}=100000 rpm"], "steady"),
    "140 um of preload": ([f"{_LOW}={_TOUCHING - 140e-6!r}"], "steady"),
    "round": (["bearing.outer_raceway.d_value=0"], "steady"),
    "round, 50 um of preload": (["bearing.outer_raceway.d_value=0", f"{_LOW}={_TOUCHING - 50e-6!r}"], "steady"),
    "round, no load, 1 mm loose": (["bearing.outer_raceway.d_value=0", f"{_LOAD}=0", f"{_LOW}={_TOUCHING + 1e-3!r}"], "steady"),
    "D 5 mm": (["bearing.outer_raceway.d_value=5 mm"], "steady"),
    "12 lobes of 0.5 mm": (["bearing.outer_raceway.d_value=0.5 mm", "bearing.outer_raceway.lobes=12"], "steady"),
    "3 rollers": (["bearing.roller.count=3"], "steady"),
    "3 rollers, 50 kN": (["bearing.roller.count=3", f"{_LOAD}=50 kN"], "steady"),
    "2 rollers": (["bearing.roller.count=2"], "steady"),
    "27 rollers": (["bearing.roller.count=27"], "steady"),
    "60 rollers of 3 mm": (
        [
            "bearing.roller={count: 60, diameter: 3 mm, length: 3 mm}",
            f"{_LOW}=30.87 mm",
            f"{_CAGE}.guide_radius=30.2 mm",
            f"{_CAGE}.inner_radius=28.5 mm",
        ],
        "steady",
    ),
    "C_p 1 um": ([f"{_CAGE}.pocket_clearance=1 um"], "steady"),
    "C_p 1 nm": ([f"{_CAGE}.pocket_clearance=1 nm"], "steady"),
    "C_p 1.9 mm": ([f"{_CAGE}.pocket_clearance=1.9 mm"], "steady"),
    "C_p 5 mm": ([f"{_CAGE}.pocket_clearance=5 mm"], "steady"),
    "C_p 5 mm, 3 rollers": ([f"{_CAGE}.pocket_clearance=5 mm", "bearing.roller.count=3"], "steady"),
    "guide clearance 1 um": ([f"{_CAGE}.guide_clearance=1 um"], "steady"),
    "guide clearance 1 um, 100,000 rpm": ([f"{_CAGE}.guide_clearance=1 um", f"{_SPEED}=100000 rpm"], "steady"),
    "guide clearance 3.8 mm": ([f"{_CAGE}.guide_clearance=3.8 mm"], "steady"),
    "guide clearance 5 mm": ([f"{_CAGE}.guide_clearance=5 mm"], "steady"),
    "guide lands outside the raceway": ([f"{_CAGE}.guide_radius=36 mm"], "steady"),
    "viscosity 1e-4 Pa s": ([oil_of(1e-4, _WARM)], "steady"),
    "viscosity 1 Pa s": ([oil_of(1.0, _WARM)], "steady"),
    "viscosity 1 Pa s, all oil, 100,000 rpm": ([oil_of(1.0, _WARM), "lubricant.mixture_fraction=1", f"{_SPEED}=100000 rpm"], "steady"),
    "no oil in the air": (["lubricant.mixture_fraction=0"], "steady"),
    "all oil": (["lubricant.mixture_fraction=1"], "steady"),
    "all oil, 100,000 rpm": (["lubricant.mixture_fraction=1", f"{_SPEED}=100000 rpm"], "steady"),
    "no traction": (["lubricant.traction_scale=0"], "steady"),
    "hundredfold traction": (["lubricant.traction_scale=100"], "steady"),
    "cage of 1 mg": ([f"{_CAGE}.mass=1 mg"], "steady"),
    "cage of 1000 kg": ([f"{_CAGE}.mass=1000 kg"], "steady"),
    "ring of 0.1 g, no shaft": (["bearing.inner_raceway.ring_mass=0.1 g", "support.shaft.mass=0"], "steady"),
    "ring of 0.1 g, no shaft, no load": (
        ["bearing.inner_raceway.ring_mass=0.1 g", "support.shaft.mass=0", f"{_LOAD}=0", f"{_LOW}={_TOUCHING + 1e-4!r}"],
        "steady",
    ),
    "shaft of 100 t": (["support.shaft.mass=1e5"], "steady"),
    "no damping at all": (
        ["bearing.contact.damping=0", "bearing.contact.damping_time=0 us", f"{_CAGE}.pocket_film_damping=0", f"{_CAGE}.land_squeeze=false"],
        "steady",
    ),
    "hundredfold damping": (["bearing.contact.damping=10", "bearing.contact.damping_time=250 us", f"{_CAGE}.pocket_film_damping=500"], "steady"),
    "rubber": (["bearing.material.youngs_modulus=1 GPa"], "steady"),
    "rigid": (["bearing.material.youngs_modulus=1000 GPa"], "steady"),
    "not a number of load": ([f"{_LOAD}=.nan"], "steady"),
    "pocket film of no force": ([f"{_CAGE}.pocket_film_force=0"], "steady"),
    "no pocket friction": ([f"{_CAGE}.pocket_friction=0"], "steady"),
    "pocket friction 1": ([f"{_CAGE}.pocket_friction=1"], "steady"),
    "steps of 1e-7 s": (["integration.maximum_step=1e-7"], "steady"),
    "steps of 1e-3 s": (["integration.maximum_step=1e-3", "integration.first_step=1e-3"], "steady"),
}
_SLICED = {
    "1 slice": (["bearing.roller.slices=1"], "steady"),
    "2 slices, 3 mrad": (["bearing.roller.slices=2", "operating.misalignment=3 mrad"], "steady"),
    "200 slices": (["bearing.roller.slices=200", "bearing.roller.crown=iso_log"], "steady"),
    "20 mrad": (["operating.misalignment=20 mrad"], "steady"),
    "20 mrad, 100,000 rpm": (["operating.misalignment=20 mrad", f"{_SPEED}=100000 rpm"], "steady"),
    "a moment of 100 N m": (["operating.moment=100 N*m"], "steady"),
    "a moment of 100 kN m": (["operating.moment=1e5"], "steady"),
    "a moment of 10 N m, loose": (["operating.moment=10 N*m", f"{_LOW}={_TOUCHING + 1e-4!r}", f"{_LOAD}=0"], "steady"),
    "no gyroscopic moments": (["dynamics.gyroscopic=false", "operating.misalignment=1 mrad"], "steady"),
}


def corner_cases(level: str) -> list[Case]:
    """Return all corners of one level: scenes, the tightest and loosest tolerances, and long and short steps."""
    corners = dict(CORNERS)
    if takes(BEARING, [f"level={level}", "operating.misalignment=1e-3"]):
        corners |= _SLICED
    corners |= {f"tolerances x {t:g}": (tolerance_overrides(t), "steady") for t in (1.0, 1e-3, 1e-8)}
    corners["reversal at 100,000 rpm"] = [f"{_SPEED}=100000 rpm"], "reversal"
    corners["steps of 50 kN"] = [f"{_LOAD}=50 kN"], "load_step"
    steps = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)  # a level without steps refuses them
    corners |= {f"fixed step {step:g} s": ([f"integration.fixed_step={step!r}"], "steady") for step in steps}
    return [Case(name, level, (f"level={level}", *overrides), course, {"course": course}) for name, (overrides, course) in corners.items()]


BEARING = "deng2017_table1"
"""Name of its scene."""
