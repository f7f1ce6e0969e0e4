# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compliances of ring and housing against closed forms of the literature and against finite elements of the plane ring."""

import math

import numpy as np
import pytest

from bearing_sim.physics.outer_ring import RingSection, bed_compliance, bore_compliance, free_frequencies, ring_compliance

MODULUS, NU = 206e9, 0.3
RADIUS, THICKNESS, WIDTH = 35.8e-3, 3.4e-3, 10e-3


def section(thickness=THICKNESS, width=WIDTH, shear=True):
    return RingSection(RADIUS, width * thickness**3 / 12, width * thickness, MODULUS, 0.5 * MODULUS / (1 + NU) if shear else math.inf)


def finite_elements(n, inside, outside, plane, pressed):
    """Return the stiffness of a plane ring in n waves: displacements U(r) cos n phi, V(r) sin n phi in quadratic elements over r, unit width.

    ``pressed`` is where a radial force in n waves acts: "bore", or "spread" over the thickness; returned are U at the bore and in the middle by it.
    """
    elements = 60
    r = np.linspace(inside, outside, 2 * elements + 1)
    count, whole = len(r), math.pi * (2 if n == 0 else 1)
    matrix, force = np.zeros((2 * count, 2 * count)), np.zeros(2 * count)
    if plane == "stress":
        law = MODULUS / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
    else:
        law = MODULUS / ((1 + NU) * (1 - 2 * NU)) * np.array([[1 - NU, NU, 0], [NU, 1 - NU, 0], [0, 0, (1 - 2 * NU) / 2]])
    for first in range(0, count - 1, 2):
        nodes = np.arange(first, first + 3)
        length = r[first + 2] - r[first]
        for place, weight in zip(*np.polynomial.legendre.leggauss(3)):
            shape = np.array([place * (place - 1) / 2, 1 - place * place, place * (place + 1) / 2])
            slope = np.array([place - 0.5, -2 * place, place + 0.5]) * 2 / length
            at = shape @ r[nodes]
            strain = np.zeros((3, 6))
            strain[0, :3], strain[1, :3], strain[1, 3:] = slope, shape / at, n * shape / at
            strain[2, :3], strain[2, 3:] = -n * shape / at, slope - shape / at
            both = np.concatenate([nodes, nodes + count])
            matrix[np.ix_(both, both)] += strain.T @ law @ strain * at * weight * length / 2 * whole
        force[nodes] += np.array([1, 4, 1]) / 6 / elements
    if pressed == "bore":
        force[:] = 0.0
        force[0] = 1.0
    free = np.arange(count) if n == 0 else np.arange(2 * count)
    moved = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    return moved[0], moved[elements]


@pytest.mark.parametrize("forces", [2, 3, 5])
def test_equal_forces_deflect_a_ring_as_in_the_literature(forces):
    # S. P. Timoshenko, J. M. Gere (1961), section 7.1: N equal forces pi/N apart from the middle of each part, outwards under a force
    ring, force, half = section(shear=False), 770.0, math.pi / forces
    bending = MODULUS * ring.second_moment
    under = force * RADIUS**3 / (2 * bending) * ((half / 2 + math.sin(2 * half) / 4) / math.sin(half) ** 2 - 1 / half)
    n = np.arange(2, 4000)
    carried = np.where(n % forces == 0, forces * force, 0.0)  # the sum of F cos n phi
    assert float(ring_compliance(n, ring) @ carried) / under == pytest.approx(1.0, rel=1e-6)


def test_a_pressure_wave_and_a_uniform_pressure_deflect_a_ring_as_in_the_literature():
    ring, pressure = section(shear=False), 2e6
    wave = pressure * WIDTH * RADIUS**4 / (MODULUS * ring.second_moment * (9 - 1) ** 2)  # q b R^4/(E I (n^2 - 1)^2)
    assert ring_compliance(3, ring) * (math.pi * RADIUS * WIDTH * pressure) / wave == pytest.approx(1.0, rel=1e-12)
    uniform = pressure * RADIUS**2 / (MODULUS * THICKNESS)  # q R^2/(E t)
    assert ring_compliance(0, ring) * (2 * math.pi * RADIUS * WIDTH * pressure) / uniform == pytest.approx(1.0, rel=1e-12)
    assert ring_compliance(1, ring) == 0.0


def test_frequencies_of_a_free_ring_are_those_of_hoppe():
    ring, n = section(shear=False), np.arange(2, 7)
    hoppe = n * (n**2 - 1) / np.sqrt(n**2 + 1) * math.sqrt(MODULUS * ring.second_moment / (7850 * ring.area * RADIUS**4))
    assert np.allclose(free_frequencies(n, ring, 7850.0), hoppe, rtol=1e-12)
    assert free_frequencies(2, ring, 7850.0) / (2 * math.pi) == pytest.approx(1.7e3, rel=0.05)  # with the section of the paper's ring
    assert free_frequencies(3, ring, 7850.0) / (2 * math.pi) == pytest.approx(4.8e3, rel=0.05)


@pytest.mark.parametrize("n", [2, 3, 6, 10])
def test_shear_brings_a_thick_ring_to_finite_elements(n):
    _, exact = finite_elements(n, RADIUS - THICKNESS / 2, RADIUS + THICKNESS / 2, "stress", "spread")
    slender, whole = ring_compliance(n, section(width=1.0, shear=False)), ring_compliance(n, section(width=1.0))
    assert whole / exact == pytest.approx(1.0, rel=0.025)
    if n * THICKNESS / RADIUS <= 0.29:
        assert slender / exact == pytest.approx(1.0, rel=0.021)
    else:
        assert exact / slender > 1.07  # what shear is worth


@pytest.mark.parametrize("outside", [40e-3, 56.25e-3, 150e-3])
@pytest.mark.parametrize("n", [0, 2, 3, 9])
def test_the_bore_of_a_housing_gives_way_as_finite_elements_do(n, outside):
    bore, whole = 37.5e-3, 2 * math.pi if n == 0 else math.pi
    exact, _ = finite_elements(n, bore, outside, "strain", "bore")
    assert bore_compliance(n, bore, MODULUS, NU, outside)[0] / (exact * whole * bore) == pytest.approx(1.0, rel=2e-4)


def test_limits_of_the_housing_are_a_massive_one_and_a_thin_ring():
    n = np.array([0, 2, 3, 7])
    massive = bore_compliance(n, 37.5e-3, MODULUS, NU)
    assert np.allclose(bore_compliance(n, 37.5e-3, MODULUS, NU, 1e3) / massive, 1.0, rtol=1e-6)
    assert np.allclose(1e-9 / massive[:3], [4.2e3, 4.0e3, 7.4e3], rtol=0.01)  # N/mm^3
    many = bore_compliance(500, 37.5e-3, MODULUS, NU)[0]
    assert 1 / many == pytest.approx(MODULUS * 500 / (2 * (1 - NU**2) * 37.5e-3), rel=2e-3)
    thickness, bore = 1e-4, 37.5e-3
    middle, stiff = bore + thickness / 2, MODULUS / (1 - NU**2)  # plane strain
    thin = RingSection(middle, thickness**3 / 12, thickness, stiff, math.inf)
    for waves in (2, 5):
        force = math.pi * bore
        found = bore_compliance(waves, bore, MODULUS, NU, bore + thickness)[0]
        assert found / (ring_compliance(waves, thin) * force) == pytest.approx(1.0, rel=5e-3)


def test_one_wave_is_no_deflection():
    assert bore_compliance([1], 0.04, MODULUS, NU)[0] == 0.0 == bore_compliance([1], 0.04, MODULUS, NU, 0.06)[0]
    assert np.array_equal(bed_compliance(np.arange(3), 1e13), [1e-13, 0.0, 1e-13])
