# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A made-up run of plausible physics for tests of what comes after the solver: no dynamics, only quasi-static shapes."""

import math

import numpy as np

from bearing_sim.model.sample import new_block


def synthetic_block(scene, times, speeds=(520.0, 4700.0), slips=(0.01, 0.16)):
    """Return a block: the shaft runs up over ``times``, slip grows with it, rollers obey Q_e = Q_i + F_c."""
    bearing, count = scene.bearing, scene.bearing.roller.count
    times = np.asarray(times, float)
    block = new_block(len(times), count)
    share = (times - times[0]) / max(times[-1] - times[0], 1e-9) if len(times) > 1 else np.ones(1)
    block["time"] = times
    block["shaft_speed"] = speeds[0] + (speeds[1] - speeds[0]) * share
    ideal = (1 - bearing.diameter_ratio) / 2
    block["ideal_cage_speed"] = ideal * block["shaft_speed"]
    block["cage_slip"] = slips[0] + (slips[1] - slips[0]) * share**2
    block["cage_speed"] = block["ideal_cage_speed"] * (1 - block["cage_slip"])
    step = np.diff(times, prepend=times[0])
    for angle, speed in (("shaft_angle", "shaft_speed"), ("cage_angle", "cage_speed"), ("ideal_cage_angle", "ideal_cage_speed")):
        block[angle] = np.cumsum(block[speed] * step)
    block["load_y"] = scene.operating.radial_load
    block["oil_temperature"] = scene.lubricant.temperature + 5 * share
    block["ring_y"] = 6e-6
    block["ring_z"] = -1e-6
    block["roller_angle"] = block["cage_angle"][:, None] + np.arange(count) * 2 * math.pi / count
    spin = block["cage_speed"] * bearing.pitch_radius / (bearing.roller.diameter / 2)
    block["roller_spin"] = spin[:, None]
    block["roller_rotation"] = np.cumsum(spin * step)[:, None]
    _balance_rollers(bearing, block)
    largest = block["outer_load"].max(axis=1)
    block["inner_equivalent_load"] = 0.7 * block["inner_load"].max(axis=1)
    block["outer_equivalent_load"] = 0.7 * largest
    block["rating_life"] = 1e9 / block["shaft_speed"] * (500.0 / largest) ** 4
    block["modified_rating_life"] = block["l10"] = block["l10r"] = block["rating_life"]
    block["damage"] = np.cumsum(step / 3600 / block["rating_life"])
    return block


def _balance_rollers(bearing, block):
    stiffness = 4.535e5 * 1e3 ** (10 / 9)
    azimuth, raceway = block["roller_angle"], bearing.outer_raceway
    outer = raceway.low_radius + raceway.d_value / 2 * (1 - np.cos(raceway.lobes * (azimuth - raceway.installation_angle)))
    radius = bearing.roller.diameter / 2
    inner_gap = bearing.inner_raceway.radius + radius + block["ring_y"][:, None] * np.cos(azimuth) + block["ring_z"][:, None] * np.sin(azimuth)
    mass = math.pi * radius**2 * bearing.roller.length * bearing.material.density
    centrifugal = (mass * bearing.pitch_radius * block["cage_speed"] ** 2)[:, None]
    low, high = outer - radius - 1e-4, outer - radius + 1e-4
    for _ in range(50):
        middle = (low + high) / 2
        pressed = stiffness * np.maximum(middle + radius - outer, 0) ** (10 / 9)
        pushed = stiffness * np.maximum(inner_gap - middle, 0) ** (10 / 9)
        outward = pressed < pushed + centrifugal
        low, high = np.where(outward, middle, low), np.where(outward, high, middle)
    block["roller_radius"], block["inner_load"] = middle, pushed
    block["outer_load"] = pushed + centrifugal
