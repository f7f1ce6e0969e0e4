# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The corners of the study of extremes: one thing at a time driven to its bound, by name."""

from bearing_sim.levels.level import LEVELS
from bearing_sim.studies.extremes_scenes import Case, oil_of
from bearing_sim.studies.stock_bearing import takes

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
    "ring of 0.1 g, no shaft": (["bearing.inner_raceway.ring_mass=0.1 g", "bearing.inner_raceway.supported_mass=0"], "steady"),
    "ring of 0.1 g, no shaft, no load": (
        ["bearing.inner_raceway.ring_mass=0.1 g", "bearing.inner_raceway.supported_mass=0", f"{_LOAD}=0", f"{_LOW}={_TOUCHING + 1e-4!r}"],
        "steady",
    ),
    "shaft of 100 t": (["bearing.inner_raceway.supported_mass=1e5"], "steady"),
    "no damping at all": (["bearing.contact.damping=0", f"{_CAGE}.pocket_film_damping=0", f"{_CAGE}.land_squeeze=false"], "steady"),
    "hundredfold damping": (["bearing.contact.damping=10", f"{_CAGE}.pocket_film_damping=500"], "steady"),
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
    """Return all corners of one level: scenes, and its methods at the tightest and loosest tolerances and at long and short steps."""
    corners = dict(CORNERS)
    if takes(level, "operating.misalignment=1e-3"):
        corners |= _SLICED
    for name, method in LEVELS[level].methods.items():
        chosen = f"integration.method={name}"
        corners |= {f"{name}, tolerance {t:g}": ([chosen, f"integration.relative_tolerance={t!r}"], "steady") for t in (1e-2, 1e-5, 1e-10)}
        corners[f"{name}, reversal at 100,000 rpm"] = [chosen, f"{_SPEED}=100000 rpm"], "reversal"
        corners[f"{name}, steps of 50 kN"] = [chosen, f"{_LOAD}=50 kN"], "load_step"
        if method.advance_fixed:
            for step in (1e-7, 1e-6, 1e-5, 1e-4, 1e-3):
                corners[f"{name}, fixed step {step:g} s"] = [chosen, f"integration.fixed_step={step!r}"], "steady"
        else:
            corners[f"{name}, fixed step"] = [chosen, "integration.fixed_step=1e-5"], "steady"
    return [Case(name, level, (f"level={level}", *overrides), course, {"course": course}) for name, (overrides, course) in corners.items()]
