# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Plausibility of a scene: what is allowed and yet looks like a slip of the pen, or like a bearing that nobody would build or run so.

Nothing here refuses a scene.  Each finding has the value, what was expected, and what to do.
"""

import math

import numpy as np

from bearing_sim.model.running_clearance import clearance_at_speed
from bearing_sim.model.validity import outside, still_sample
from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.display import number
from bearing_sim.scene.mounting import LARGEST_BORE, clearance_limits
from bearing_sim.scene.ratings import minimum_load_law, rate
from bearing_sim.scene.scene import Scene

# Assumption: a mass within a factor of 2 of its volume's is taken as meant, because pockets and ribs are known roughly only.
_MASS_FACTOR = 2.0
_LIGHTEST_CAGE, _HEAVIEST_CAGE = 1100.0, 8600.0  # [kg/m^3] polyamide and brass
_THINNEST_RING, _WIDEST_RING = 0.05, 2.0  # assumption: thickness over radius of an inner ring at least, width over roller length at most
_LARGEST_LOBES = 0.005  # assumption: D over pitch diameter; Deng 2017 has 0.0010 to 0.0016
_HEAVIEST_PRELOAD = {True: 0.001, False: 0.0003}  # assumption: diametral preload over pitch diameter, of lobed and of round raceways
_BORE_OF_RACEWAY = 0.85  # assumption: bore over inner raceway diameter, where the bore is not given; 0.84 to 0.90 of usual bearings
_LEAST_FILL, _LARGEST_FILL = 0.4, 0.97  # assumption: rollers' widths over the pitch circle; cages of series leave 0.6 to 0.95
# A maker's rating over that by the standards (assumption: catalogues give 0.85 to 1.17 times C, fatigue limits differ more).
_RATING_RATIO = {"dynamic": (0.65, 1.5), "static": (0.65, 1.5), "fatigue_limit": (0.4, 2.5)}
_RPM = 30.0 / math.pi


def plausibility(scene: Scene) -> list[str]:
    """Return what is implausible about a scene, one sentence each; empty if there is nothing."""
    bearing = scene.bearing
    return [
        *_rollers(bearing),
        *_clearance(bearing),
        *_lobes(scene),
        *_cage_radii(bearing),
        *_cage_mass(bearing),
        *_ring_mass(bearing),
        *_ratings(bearing),
        *_load(scene),
        *_slip_from_speed(scene),
        *(each.text for each in outside(scene, still_sample(scene), ("oil_temperature", "speed_factor", "limiting_speed"))),
    ]


def left_out(scene: Scene) -> list[str]:
    """Return what a scene leaves out by its own choice although it moves slip, one sentence each; empty if there is nothing."""
    if scene.lubricant.rolling_resistance.law != "none":
        return []
    return [
        "lubricant.rolling_resistance is none: contacts roll without resistance, as in Deng 2017; with resistance the cage slips more "
        "(lubricant.rolling_resistance=hydrodynamic computes it)"
    ]


def minimum_load(scene: Scene, speed: np.ndarray | float | None = None) -> tuple[np.ndarray | float, str]:
    """Return the load below which makers expect slip [N], and where it comes from.

    Parameters
    ----------
    scene : with the bearing, see `bearing_sim.scene.ratings.minimum_load_law`.
    speed : of the shaft [rad/s], one or several; None for the operating speed of the scene.
    """
    law = minimum_load_law(scene.bearing)
    return law.at_rest + law.by_speed * np.abs(scene.operating.shaft_speed if speed is None else speed), law.rule


def _rollers(bearing: Bearing) -> list[str]:
    fill = bearing.roller.count * bearing.roller.diameter / (math.pi * bearing.pitch_diameter)
    largest = 1.0 if bearing.cage.is_absent else _LARGEST_FILL
    if _LEAST_FILL <= fill <= largest:
        return []
    return [
        f"bearing.roller: {bearing.roller.count} rollers of {number(1e3 * bearing.roller.diameter, 6)} mm fill {number(100 * fill, 3)} % of "
        "the pitch circle of "
        f"{number(1e3 * bearing.pitch_diameter, 6)} mm; expected {100 * _LEAST_FILL:g} to {100 * largest:g} %; check count and diameter"
    ]


def _ratings(bearing: Bearing) -> list[str]:
    given, computed = bearing.ratings, rate(bearing).computed
    found = []
    for name, (low, high) in _RATING_RATIO.items():
        rating, standard = getattr(given, name), getattr(computed, name)
        if rating is not None and not low * standard <= rating <= high * standard:
            found.append(
                f"bearing.ratings.{name}: {number(rating)} N is {number(rating / standard, 3)} times the {number(standard)} N by the "
                "standard from the dimensions; "
                f"expected {low:g} to {high:g} times; check its unit, and count, diameter and length of the rollers"
            )
    return found


def _bore(bearing: Bearing) -> tuple[float, str]:
    """Return the bore diameter [m], and a word on where it comes from."""
    radius = bearing.inner_raceway.bore_radius
    if radius is not None:
        return 2 * radius, ""
    return 2 * _BORE_OF_RACEWAY * bearing.inner_raceway.radius, ", estimated from the inner raceway"


def _clearance(bearing: Bearing) -> list[str]:
    """Judge the diametral clearance by ISO 5753-1 and preload by the pitch diameter."""
    clearance = 2e6 * bearing.radial_clearance_at_low_points
    bore, estimated = _bore(bearing)
    largest = 1e6 * clearance_limits("C5", bore).largest if bore <= LARGEST_BORE else None
    given = "inner_raceway.radius, roller.diameter and outer_raceway.low_radius" if bearing.clearance is None else "bearing.clearance"
    dimensions = f"check {given}"
    if largest is not None and clearance > largest:
        return [
            f"bearing: the diametral clearance is {number(clearance)} um; expected at most {number(largest)} um, class C5 of ISO 5753-1 for "
            "a bore of "
            f"{number(1e3 * bore)} mm{estimated}; {dimensions}"
        ]
    lobed = bearing.outer_raceway.d_value > 0.0
    preload = 1e6 * _HEAVIEST_PRELOAD[lobed] * bearing.pitch_diameter
    if -clearance > preload:
        return [
            f"bearing: the diametral preload is {number(-clearance)} um; expected at most {number(preload, 3)} um, "
            f"{100 * _HEAVIEST_PRELOAD[lobed]:g} % of the "
            f"pitch diameter of a {'lobed' if lobed else 'round'} raceway; {dimensions}"
        ]
    return []


def _gives_clearance(bearing: Bearing) -> str:
    """Return the field by which a bearing gives the clearance at its low points."""
    return "bearing.outer_raceway.low_radius" if bearing.clearance is None else "bearing.clearance"


def _lobes(scene: Scene) -> list[str]:
    """Judge the D value by the pitch diameter and by the running preload at the low points, at the reference temperature."""
    bearing = scene.bearing
    d_value, low = bearing.outer_raceway.d_value, 0.5 * clearance_at_speed(bearing, scene.mounting, scene.operating.shaft_speed)
    if not d_value:
        return []
    shown, name = f"{number(1e6 * d_value)} um", "bearing.outer_raceway.d_value"
    if d_value > _LARGEST_LOBES * bearing.pitch_diameter:
        return [
            f"{name}: {shown}; expected at most {number(1e6 * _LARGEST_LOBES * bearing.pitch_diameter)} um, {100 * _LARGEST_LOBES:g} % of the pitch "
            "diameter; it is a difference of radii, not of diameters: check its unit"
        ]
    if low >= 0.0:
        return [
            f"{name}: {shown} with a radial clearance of {number(1e6 * low)} um at the low points, where lobes do not press rollers; "
            "expected preload "
            f"there; lower {_gives_clearance(bearing)}, or set d_value to 0 for a round raceway"
        ]
    if -low >= d_value:
        return [
            f"{name}: {shown} is no more than the radial preload at the low points, {number(-1e6 * low)} um: no roller is free between lobes; "
            f"expected more; raise d_value or {_gives_clearance(bearing)}"
        ]
    return []


def _cage_radii(bearing: Bearing) -> list[str]:
    cage, pitch = bearing.cage, bearing.pitch_radius
    if cage.bore < pitch < cage.outside:
        return []
    return [
        f"bearing.cage: it reaches from {number(1e3 * cage.bore, 6)} to {number(1e3 * cage.outside, 6)} mm and leaves out the pitch radius, "
        f"{number(1e3 * pitch, 6)} mm, where rollers touch their pockets; expected the pitch radius between; check inner_radius and outer_radius"
    ]


def _cage_mass(bearing: Bearing) -> list[str]:
    """Judge the mass by that of a ring with pockets, from polyamide to brass."""
    cage, roller = bearing.cage, bearing.roller
    if cage.is_absent:
        return []
    body = math.pi * (cage.outside**2 - cage.bore**2) * cage.width
    pocket = (roller.diameter + 2 * cage.pocket_clearance) * min(roller.length, cage.width) * min(cage.outside - cage.bore, roller.diameter)
    volume = max(body - roller.count * pocket, 0.1 * body)
    low, high = _LIGHTEST_CAGE * volume / _MASS_FACTOR, _HEAVIEST_CAGE * volume * _MASS_FACTOR
    if low <= cage.mass <= high:
        return []
    return [
        f"bearing.cage.mass: {number(1e3 * cage.mass)} g for about {number(1e6 * volume, 3)} cm^3 is {number(1e-3 * cage.mass / volume, 3)} "
        "g/cm^3; expected "
        f"{number(1e3 * low)} to {number(1e3 * high)} g (polyamide to brass, within a factor of {_MASS_FACTOR:g}); check mass, width and "
        "radii of the cage"
    ]


def _ring_mass(bearing: Bearing) -> list[str]:
    """Judge the inner ring's mass by its volume, as far as that is known."""
    ring, length, density = bearing.inner_raceway, bearing.roller.length, bearing.material.density
    least_bore = (1 - _THINNEST_RING) * ring.radius
    inside_low, inside_high = (least_bore, 0.0) if ring.bore_radius is None else (ring.bore_radius, ring.bore_radius)
    low = density * math.pi * (ring.radius**2 - inside_low**2) * length / _MASS_FACTOR
    high = density * math.pi * (ring.radius**2 - inside_high**2) * length * _WIDEST_RING * _MASS_FACTOR
    if low <= ring.ring_mass <= high:
        return []
    return [
        f"bearing.inner_raceway.ring_mass: {number(1e3 * ring.ring_mass)} g; expected {number(1e3 * low)} to {number(1e3 * high)} g by "
        "raceway, bore and roller "
        f"length (within a factor of {_MASS_FACTOR:g}); give the mass of the ring; that of the shaft belongs into support.shaft.mass"
    ]


def _slip_from_speed(scene: Scene) -> list[str]:
    speed, least = abs(scene.operating.shaft_speed), scene.thresholds.slip_from_speed
    if not 0.0 < speed < least:
        return []
    return [
        f"thresholds.slip_from_speed: slip enters means, maxima and thresholds from {number(least * _RPM)} rpm on, and operating.shaft_speed is "
        f"{number(speed * _RPM)} rpm; expected a threshold that the shaft exceeds; if the machine is made to turn so slowly, set it to "
        f"{0.5 * speed * _RPM:.2g} rpm or so"
    ]


def _load(scene: Scene) -> list[str]:
    """Judge the load by the makers' minimum; a bearing with preload has its own."""
    operating = scene.operating
    least, rule = minimum_load(scene)
    if not operating.shaft_speed or operating.radial_load >= least or scene.bearing.radial_clearance_at_low_points < 0.0:
        return []
    return [
        f"operating.radial_load: {number(operating.radial_load)} N; expected at least the makers' minimum, {number(least)} N ({rule}); "
        "below it expect slip: "
        "raise the load, take a smaller bearing or one with less clearance, or study the slip"
    ]
