# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a recording does not hold of its samples, from what it does.

Of a recording from before all observables were recorded, the rest follows from the scene and from what it has: rollers stand at equal
steps behind the cage's angle (their play in the pockets is left out), an outer load says how deep a roller sits in the outer raceway,
rotations follow from spins, the inner loads together say where the inner ring is, rollers are taken to roll on the outer ring, and what
cannot be known is NaN.
"""

import math

import numpy as np

from bearing_sim.contour import outer_contour
from bearing_sim.effects import NUMBERS
from bearing_sim.params import contact_stiffness
from bearing_sim.scene import Scene
from bearing_sim.topics import ARRAYS, OUTPUTS

_OF_TILTING_LEVELS = tuple(field for name, topic in OUTPUTS.items() if topic.of_tilting_levels for field in ARRAYS[name].fields)


def complete(scene: Scene, block: np.ndarray, before: np.void | None = None) -> None:
    """Fill in what a recording does not hold from what it does (see the module's description).

    Equivalent loads that were not recorded are the power means of the instant, not averaged over a roller pitch.

    Parameters
    ----------
    scene : what was simulated.
    block : samples with time, speeds, angles and loads, NaN where nothing was recorded; changed in place.
    before : the completed sample before the block.
    """
    bearing = scene.bearing
    count, radius = bearing.roller.count, bearing.roller.diameter / 2
    stiffness = contact_stiffness(bearing)
    azimuth = block["cage_angle"][:, None] + 2 * math.pi / count * np.arange(count)
    approach = {ring: np.maximum(block[f"{ring}_load"] / stiffness, 0.0) ** 0.9 for ring in ("inner", "outer")}
    _fill(block, "roller_angle", azimuth)
    if np.isnan(block["roller_radius"]).any():
        _fill(block, "roller_radius", outer_contour(bearing.outer_raceway, azimuth)[0] - radius + approach["outer"])
    rolling = bearing.pitch_radius / radius
    _fill(block, "roller_spin", (block["cage_speed"] * rolling)[:, None])
    _fill(block, "orbital_speed", block["cage_speed"][:, None])
    start = block["cage_angle"][:1, None] * rolling
    if np.isnan(block["roller_rotation"]).any():
        _fill(block, "roller_rotation", _rotation(block, before if before is not None else block[0], start))
    _fill(block, "inner_equivalent_load", np.mean(block["inner_load"] ** 4, axis=1) ** (1 / 4))
    _fill(block, "outer_equivalent_load", np.mean(block["outer_load"] ** 4.5, axis=1) ** (1 / 4.5))
    if not scene.bodies_tilt:
        for field in _OF_TILTING_LEVELS:
            _fill(block, field, 0.0)
    _fill(block, "level", NUMBERS[scene.level])
    for life in ("lamina_life", "modified_rating_life"):
        _fill(block, life, block["rating_life"])
    # A loaded roller touches the ring: e cos(phi - phi_e) = delta_i - (R_i + R_w - r); all of them together give e.
    if np.isnan(block["ring_y"]).any():
        wanted = approach["inner"] - (bearing.inner_raceway.radius + radius - block["roller_radius"])
        for field, places in zip(("ring_y", "ring_z"), _ring_centre(azimuth, wanted, block["inner_load"] > 0)):
            _fill(block, field, places)
    guide_y, guide_z = (block["ring_y"], block["ring_z"]) if scene.cage_whirls and bearing.cage.guidance == "inner_ring" else (0.0, 0.0)
    eccentricity = np.hypot(block["cage_y"] - guide_y, block["cage_z"] - guide_z) / bearing.cage.play
    _fill(block, "land_eccentricity", eccentricity)


def _fill(block: np.ndarray, field: str, values: np.ndarray | float) -> None:
    """Enter values where none were recorded."""
    block[field] = np.where(np.isnan(block[field]), values, block[field])


def _rotation(block: np.ndarray, before: np.void, start: np.ndarray) -> np.ndarray:
    """Return the rollers' rotation [rad] by trapezoids over their spins, from ``before`` or, where it knows none, from ``start``."""
    times = np.concatenate(([before["time"]], block["time"]))
    spins = np.concatenate((before["roller_spin"][None], block["roller_spin"]))
    steps = 0.5 * (spins[1:] + spins[:-1]) * np.diff(times)[:, None]
    known = np.isfinite(before["roller_rotation"])
    return np.where(known, before["roller_rotation"], start) + np.cumsum(steps, axis=0)


def _ring_centre(azimuth: np.ndarray, wanted: np.ndarray, touching: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ring centre [m] that fits ``wanted`` [m] best over the touching rollers, by least squares, shape (n,) each.

    A slight pull to the centre gives a ring that too few rollers hold a place.
    """
    cosine, sine = np.where(touching, np.cos(azimuth), 0.0), np.where(touching, np.sin(azimuth), 0.0)
    wanted = np.where(touching, np.nan_to_num(wanted), 0.0)
    a, b, d = (cosine**2).sum(axis=1) + 1e-9, (cosine * sine).sum(axis=1), (sine**2).sum(axis=1) + 1e-9
    p, q = (cosine * wanted).sum(axis=1), (sine * wanted).sum(axis=1)
    determinant = a * d - b * b
    return (d * p - b * q) / determinant, (a * q - b * p) / determinant
