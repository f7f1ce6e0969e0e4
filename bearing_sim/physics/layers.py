# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Concentric rotating rings pressed into each other: displacements, stresses, contact pressures, loss of fit.

Elastic rings in plane stress (G. Lame 1852; S. Timoshenko, J. N. Goodier, Theory of Elasticity, third edition 1970, sections 28 and 32): for a ring
from radius a to b under pressure p_a within and p_b outside, at speed w and warmer by T than where its radii were measured,

    E u(r)/r = (1 - nu) (p_a a^2 - p_b b^2)/(b^2 - a^2) + (1 + nu) (p_a - p_b) a^2 b^2/((b^2 - a^2) r^2)
               + rho w^2 (3 + nu)(1 - nu)/8 [a^2 + b^2 - (1 + nu)/(3 + nu) r^2 + (1 + nu)/(1 - nu) a^2 b^2/r^2] + E alpha T.

A solid shaft is a ring with a = 0.  Range: rings much narrower than wide are plane stress; a long shaft is stiffer by up to nu^2 of itself.  Left
out: ribs, the ends of a seat, and the load that passes through.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class Layer(NamedTuple):
    """One ring."""

    inner_radius: float  # a [m]; 0 where it is solid
    outer_radius: float  # b [m]
    youngs_modulus: float  # E [Pa]
    poisson_ratio: float  # nu
    density: float  # rho [kg/m^3]
    expansion: float  # alpha [1/K]


class State(NamedTuple):
    """What acts on one ring."""

    inner_pressure: float = 0.0  # p_a [Pa]
    outer_pressure: float = 0.0  # p_b [Pa]
    square_speed: float = 0.0  # w^2 [rad^2/s^2]
    warming: float = 0.0  # T [K]


def displacement(layer: Layer, radius: float, state: State) -> float:
    """Return how far a ring moves outwards at a radius [m], the equation above; it is linear in every field of the state."""
    a, b, nu = layer.inner_radius, layer.outer_radius, layer.poisson_ratio
    square, both = radius * radius, a * a * b * b
    pressed = (1 - nu) * (state.inner_pressure * a * a - state.outer_pressure * b * b) / (b * b - a * a)
    pressed += (1 + nu) * (state.inner_pressure - state.outer_pressure) * both / ((b * b - a * a) * square)
    turned = (3 + nu) * (1 - nu) / 8 * (a * a + b * b - (1 + nu) / (3 + nu) * square + (1 + nu) / (1 - nu) * both / square)
    return radius * ((pressed + layer.density * state.square_speed * turned) / layer.youngs_modulus + layer.expansion * state.warming)


def hoop_stress(layer: Layer, radius: float, state: State) -> float:
    """Return the tangential stress in a ring at a radius [Pa], positive where it pulls (Timoshenko and Goodier, sections 28 and 32)."""
    a, b, nu = layer.inner_radius, layer.outer_radius, layer.poisson_ratio
    square, both = radius * radius, a * a * b * b
    pressed = (state.inner_pressure * a * a - state.outer_pressure * b * b) / (b * b - a * a)
    pressed += (state.inner_pressure - state.outer_pressure) * both / ((b * b - a * a) * square)
    turned = (3 + nu) / 8 * (a * a + b * b + both / square - (1 + 3 * nu) / (3 + nu) * square)
    return pressed + layer.density * state.square_speed * turned


def contact_pressures(
    layers: Sequence[Layer], interferences: Sequence[float], square_speeds: Sequence[float], warmings: Sequence[float]
) -> list[float]:
    """Return the pressures between neighbouring rings [Pa], from the innermost seat outwards; 0 where a seat has come loose.

    Parameters
    ----------
    layers : rings from the innermost outwards; at each seat one ring's outer radius is the next one's inner radius.
    interferences : diametral, of each seat [m]; negative is a gap.
    square_speeds, warmings : of each ring [rad^2/s^2, K].
    """
    return _complementary(compliance_matrix(layers), misfits(layers, interferences, square_speeds, warmings))


def compliance_matrix(layers: Sequence[Layer]) -> np.ndarray:
    """Return by how much pressures at the seats part neighbouring rings radially [m/Pa], shape (seats, seats)."""
    count = len(layers) - 1
    compliance = np.zeros((count, count))
    for seat in range(count):
        radius, inside, outside = layers[seat].outer_radius, layers[seat], layers[seat + 1]
        compliance[seat, seat] = displacement(outside, radius, State(inner_pressure=1.0)) - displacement(inside, radius, State(outer_pressure=1.0))
        if seat > 0:
            compliance[seat, seat - 1] = -displacement(inside, radius, State(inner_pressure=1.0))
        if seat + 1 < count:
            compliance[seat, seat + 1] = displacement(outside, radius, State(outer_pressure=1.0))
    return compliance


def misfits(layers: Sequence[Layer], interferences: Sequence[float], square_speeds: Sequence[float], warmings: Sequence[float]) -> np.ndarray:
    """Return by how much neighbouring rings would overlap without pressure, radially [m], shape (seats,); parameters as of `contact_pressures`."""
    overlaps = []
    for seat, interference in enumerate(interferences):
        radius, inside, outside = layers[seat].outer_radius, layers[seat], layers[seat + 1]
        grown = displacement(inside, radius, State(square_speed=square_speeds[seat], warming=warmings[seat]))
        given_way = displacement(outside, radius, State(square_speed=square_speeds[seat + 1], warming=warmings[seat + 1]))
        overlaps.append(interference / 2 + grown - given_way)
    return np.array(overlaps)


def _complementary(compliance: np.ndarray, overlaps: np.ndarray) -> list[float]:
    """Return pressures p >= 0 with compliance p >= overlaps, equal wherever p > 0."""
    count = len(overlaps)
    for held in sorted(range(1 << count), key=lambda seats: -seats.bit_count()):
        seats = [seat for seat in range(count) if held >> seat & 1]
        pressures = np.zeros(count)
        if seats:
            pressures[seats] = np.linalg.solve(compliance[np.ix_(seats, seats)], overlaps[seats])
        loose = [seat for seat in range(count) if seat not in seats]
        if (pressures[seats] >= 0.0).all() and (compliance[loose] @ pressures >= overlaps[loose]).all():
            return pressures.tolist()
    raise AssertionError("a positive definite compliance has one solution")


def spinning_roller_growth(layer: Layer, square_speed: float) -> float:
    """Return how much the radius of a solid cylinder grows that spins about its axis, (1 - nu) rho w^2 b^3/(4 E) [m]."""
    return displacement(layer, layer.outer_radius, State(square_speed=square_speed))
