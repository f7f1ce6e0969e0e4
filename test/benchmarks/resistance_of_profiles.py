# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Resistance to rolling of a roller with ISO's profile, over that of a straight one with the same load: three calculations.

Strips: the resistance of every slice by its own load, or by that of the rigid film beside the part that bears.  Reynolds: the equation in two
dimensions between rigid surfaces of one viscosity, where a rigid film carries more than the elastic contact could.  Formula: that of the package.

Usage: python test/benchmarks/resistance_of_profiles.py [bearing [oil [temperature]]], for example "NU 210" "ISO VG 68" "70 degC"
"""

import sys

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from bearing_sim import load_scene
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.film import DOWSON_TOYODA, films, resist_rolling
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.profile import concentrate, profile_depth
from bearing_sim.scene.crown import crown_drops

SLICES = 4000


def rolls(name, oil, temperature, speed="1500 rpm"):
    """Return bearing parameters, what the oil does, its state, the drops of the slices and the rolling speed of the inner contact [m/s]."""
    operating = {"shaft_speed": speed, "radial_load": "1 kN"}
    scene = load_scene({"name": "rolls", "bearing": {"preset": name}, "lubricant": {"oil": oil, "temperature": temperature}, "operating": operating})
    params = pack(scene)
    raceways, roller = params.raceways, scene.bearing.roller
    turns = float(speed.split()[0]) * np.pi / 30
    u = 0.5 * turns * raceways.pitch_radius * (1 - raceways.diameter_ratio**2)
    kelvin = scene.lubricant.temperature
    drops = crown_drops(roller.profile, roller.diameter, roller.length, SLICES)
    return params, lubricate(scene.lubricant, params, kelvin), oil_at(scene.lubricant.oil, kelvin), drops, u


def resistance(params, lubrication, load, u, crowned):
    """Return F_R of the inner contact by the package [N]: that of the oil, without heat and of full inlets."""
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.load], contacts[:, CONTACT.rolling] = load, u
    stiffness, profile = params.raceways.stiffness, params.raceways.profile
    contacts[:, CONTACT.penetration] = profile_depth(load, stiffness, profile)
    if crowned:
        concentrate(stiffness, profile, contacts)
        contacts[:, CONTACT.load] = load
    inner = lubrication.rolling_resistance.inner._replace(heating=-np.inf, hysteresis=0.0)
    resist_rolling(contacts, lubrication.rolling_resistance._replace(inner=inner), FULL_FILMS, crowned)
    return contacts[0, CONTACT.resistance, 0], contacts[0, CONTACT.part, 0]


def by_strips(params, lubrication, oil, drops, load, u):
    """Return the resistance of the part that bears and of all strips [N]."""
    raceways, length = params.raceways, params.rollers.length
    stiffness, radius, modulus = raceways.stiffness, raceways.inner_curvature_radius, raceways.reduced_modulus
    depth = brentq(lambda d: stiffness * np.mean(np.maximum(d - drops, 0.0) ** (10 / 9)) - load, 0.0, 1e-2, xtol=1e-15)
    bearing = stiffness * np.maximum(depth - drops, 0.0) ** (10 / 9)  # of a whole contact with the strip's load per length
    martin = 4.9 * oil.viscosity * u * radius * length
    film = max(float(films(DOWSON_TOYODA, oil, radius, modulus, length, load, u, 0.0)), martin / load)
    floating = martin / (film + np.maximum(drops - depth, 0.0))
    both = (bearing[::20], np.maximum(bearing, floating)[::20])
    alone, together = (np.mean([resistance(params, lubrication, q, u, False)[0] for q in loads]) for loads in both)
    return alone, together


def by_reynolds(params, oil, drops, film, u):
    """Return load and resistance of rigid surfaces [N], least film ``film`` [m], by finite volumes; pressures are not negative."""
    radius, length = params.raceways.inner_curvature_radius, params.rollers.length
    y = (np.arange(SLICES) + 0.5) / SLICES - 0.5
    across = np.linspace(0.0, 0.5, 41)[:-1] + 0.5 / 80  # half of the roller, middles of cells
    drop = np.interp(across, y, drops)
    reach = 12 * np.sqrt(2 * radius * (film + np.median(drops)))
    edges = reach * np.sinh(np.linspace(-1, 1, 321) * 5) / np.sinh(5)
    x, dx, dy = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges), length / 80
    h = film + x[:, None] ** 2 / (2 * radius) + drop[None, :]
    h_x = film + edges[1:-1, None] ** 2 / (2 * radius) + drop[None, :]
    rows, columns = h.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    along = h_x**3 / (12 * oil.viscosity) / (x[1:] - x[:-1])[:, None] * dy
    sideways = (0.5 * (h[:, 1:] + h[:, :-1])) ** 3 / (12 * oil.viscosity) / dy * dx[:, None]
    pairs = [(number[:-1], number[1:], along), (number[:, :-1], number[:, 1:], sideways)]
    i = np.concatenate([a.ravel() for a, _, _ in pairs])
    j = np.concatenate([b.ravel() for _, b, _ in pairs])
    k = np.concatenate([c.ravel() for _, _, c in pairs])
    outside = np.zeros(h.shape)
    outside[:, -1] = h[:, -1] ** 3 / (12 * oil.viscosity) / (0.5 * dy) * dx  # ambient pressure at the roller's end
    outside[0] += h[0] ** 3 / (12 * oil.viscosity) / (0.5 * dx[0]) * dy
    outside[-1] += h[-1] ** 3 / (12 * oil.viscosity) / (0.5 * dx[-1]) * dy
    size = h.size
    matrix = coo_matrix((np.concatenate([-k, -k]), (np.concatenate([i, j]), np.concatenate([j, i]))), (size, size)).tocsr()
    matrix.setdiag(-np.asarray(matrix.sum(axis=1)).ravel() + outside.ravel())
    faces = np.vstack([h[:1], h_x, h[-1:]])
    source = -(u * dy * np.diff(faces, axis=0)).ravel()
    full, p = np.ones(size, bool), np.zeros(size)
    for _ in range(60):  # a primal-dual active set
        p[:] = 0.0
        p[full] = spsolve(matrix[full][:, full].tocsc(), source[full])
        now = np.where(full, p > 0.0, source - matrix @ p > 0.0)
        if (now == full).all():
            break
        full = now
    power = 2.0 * (p @ (matrix @ p))  # of both halves: 2 F_R u
    load = float((p.reshape(h.shape) * dx[:, None] * dy).sum())
    return 2.0 * load, power / (2.0 * u)


def main():
    """Print both comparisons."""
    name, oil_name, temperature = [*sys.argv[1:], *("NU 232", "ISO VG 220", "70 degC")[len(sys.argv) - 1 :]]
    params, lubrication, oil, drops, u = rolls(name, oil_name, temperature)
    print(f"{name}, {oil_name}, {temperature}, u = {u:.3g} m/s; resistance over that of a straight roller with the same load")
    print("| Q, N | a | strips, part that bears | strips, all | formula |")
    print("|---|---|---|---|---|")
    for load in (30.0, 100.0, 300.0, 1e3, 3e3, 1e4):
        straight, _ = resistance(params, lubrication, load, u, False)
        crowned, part = resistance(params, lubrication, load, u, True)
        inside, everywhere = by_strips(params, lubrication, oil, drops, load, u)
        print(f"| {load:g} | {part:.2f} | {inside / straight:.2f} | {everywhere / straight:.2f} | {crowned / straight:.2f} |")
    print("| least film, um | Q, N | Reynolds | formula |")
    print("|---|---|---|---|")
    for film in (100e-6, 30e-6, 10e-6, 3e-6):
        load, found = by_reynolds(params, oil, drops, film, u)
        crowned, _ = resistance(params, lubrication, load, u, True)
        stiffness = params.raceways.reduced_modulus * params.raceways.inner_curvature_radius
        rigid = 1.42 * np.sqrt(2 * oil.viscosity * u / stiffness * load / (stiffness * params.rollers.length)) * stiffness * params.rollers.length
        print(f"| {1e6 * film:g} | {load:.3g} | {found / rigid:.2f} | {crowned / resistance(params, lubrication, load, u, False)[0]:.2f} |")


if __name__ == "__main__":
    main()
