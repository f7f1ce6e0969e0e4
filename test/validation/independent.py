# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks of levels against calculations that others made of the same bearing, and against each other."""

import numpy as np

from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Simulation, scene_inputs
from validation.check import Check, Comparison, compared, judged
from validation.steady_and_slip import compare

GROUP = "Independent calculations, and levels among each other"
_BEARING = "deng2017_table1"
_RADII = (34.8600, 34.8625, 34.8650, 34.8675)  # mm, R_low
# Settings of the independent calculation at planar; its pockets had no friction.
INDEPENDENT = (
    "integration.fixed_step=10 us",  # loose rollers hit hard and ring at 70 kHz: longer steps are 10 % off where slip is largest
    "bearing.contact.damping=0.3",
    "bearing.contact.damping_time=0 us",
    "support.shaft.mass=0.25",
    "bearing.outer_raceway.contour_slope=false",
    "bearing.cage.land_film=4.5 um",
    "bearing.cage.land_squeeze=false",
    "bearing.cage.land_friction=0",
    "bearing.cage.pocket_friction=0",
)


def _settled(duration: float, *overrides: str) -> np.ndarray:
    """Return the last fifth of a run of the paper's bearing; ``duration`` in s."""
    return Simulation(load_scene(_BEARING, overrides)).advance(duration, samples=500)[400:]


def _slip_and_life() -> list[Comparison]:
    runs = [_settled(0.5, f"bearing.outer_raceway.low_radius={radius} mm") for radius in _RADII]
    source, at = "independent calculation, which made its own choices about drag", "at four radii, 45,000 rpm, 800 N"
    slips, lives = ([float(run[name].mean()) for run in runs] for name in ("cage_slip", "rating_life"))
    return [
        compared(f"cage slip of level slip {at}", source, (4.3, 5.95, 10.9, 26.2), 100 * np.array(slips), unit="%", relative=0.1),
        compared(f"life of level slip {at}", source, (182, 389, 906, 2351), lives, unit="h", relative=0.02),
    ]


def _planar_slip() -> list[Comparison]:
    runs = [_settled(0.4, "level=planar", f"bearing.outer_raceway.low_radius={radius} mm", *INDEPENDENT) for radius in _RADII]
    found = [100 * float(run["cage_slip"].mean()) for run in runs]
    quantity = "cage slip of level planar at the same radii, with the settings of the calculation"
    return [compared(quantity, "independent planar calculation", (5.2, 7.05, 11.0, 24.8), found, unit="%", relative=0.1)]


def _steady_and_slip() -> list[Comparison]:
    points = list(compare(load_scene(_BEARING, ["level=steady"]), 25, 2017))
    slips = np.array([100 * abs(point.solved_slip - point.marched_slip) for point in points])
    lives = np.array([100 * abs(point.solved_life / point.marched_life - 1.0) for point in points])
    return [
        judged(
            f"cage slip and life of level steady at {len(points)} random operating points",
            "level slip, marched until it settles",
            "the same",
            f"{sum(point.agrees for point in points)} of {len(points)} agree",
            all(point.agrees for point in points),
            f"{slips.max():.2g} points of slip, {lives.max():.2g} % of life",
            "2 % or 0.05 points of slip, 2 % of life",
        )
    ]


def _spatial_and_planar() -> list[Comparison]:
    fixed = "integration.fixed_step=20 us"
    flat, full = (Simulation(load_scene(_BEARING, [f"level={level}", fixed])) for level in ("planar", "spatial"))
    flat.advance(1e-3)
    full.advance(1e-3)
    names = ("cage_speed", "shaft_power", "inner_sliding_power", "outer_sliding_power", "pocket_power", "land_power")
    expected, found = ([float(run.sample[name]) for name in names] for run in (flat, full))
    quantity = "cage speed and five powers of level spatial without crown and tilt, after 1 ms"
    return [compared(quantity, "level planar", expected, found, relative=1e-6)]


def _heat_of_an_equilibrium() -> list[Comparison]:
    scene = load_scene(_BEARING, ["level=steady", "heat.law=network"])
    found = thermal_equilibrium(scene, scene_inputs(scene))
    given, taken = found.heat_to_oil + found.heat_to_ambient, found.powers["shaft_power"]
    return [compared("heat that leaves in thermal equilibrium, at 45,000 rpm", "power at the shaft", taken, given, unit="W", relative=1e-6, digits=7)]


CHECKS = (
    Check("slip_and_life", GROUP, _slip_and_life),
    Check("planar_slip", GROUP, _planar_slip),
    Check("steady_and_slip", GROUP, _steady_and_slip, "python test/validation against-slip deng2017_table1"),
    Check("spatial_and_planar", GROUP, _spatial_and_planar),
    Check("heat_of_an_equilibrium", GROUP, _heat_of_an_equilibrium),
)
