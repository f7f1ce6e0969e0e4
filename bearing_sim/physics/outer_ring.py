# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The outer ring as an elastic ring, and what backs it: compliances by waves around the circumference.

**Ring.** The neutral line of a ring of radius R moves outwards by

    w(phi) = a_0 + sum over n >= 2 of (a_n cos n phi + b_n sin n phi);

n = 1 is a motion of the whole ring.  Forces that push with F_n = sum of F cos n phi deflect it by a_n = c_n F_n, sines likewise, with

    c_0 = R/(2 pi E A),    c_n = R^3/(pi (n^2 - 1)^2) [1/(E I) + n^2/(R^2 k G A)],

E I the bending stiffness of the section, A its area, k = 5/6 the factor of a rectangle for shear (S. P. Timoshenko, On the correction for shear,
Philosophical Magazine 41, 1921).  The first part is the ring that bends without stretching (S. P. Timoshenko, J. M. Gere, Theory of Elastic
Stability, second edition 1961, section 7.1), the second what shear adds: it matters from n t/R of about 0.3 on.  Such a ring moves along its
circumference too, by -a_n/n sin n phi, so that a wave has the mass pi rho A R (1 + 1/n^2) and a free ring the frequencies of R. Hoppe (Journal fuer
die reine und angewandte Mathematik 73, 1871), w_n^2 = E I n^2 (n^2 - 1)^2/(rho A R^4 (n^2 + 1)).

**Housing.** A pressure p_n cos n phi on its bore of radius R_s moves that outwards by u_n = h_n p_n, without friction and in plane strain.  Around a
massive housing (N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, 1953, section 56: stress functions r^-n, r^(2-n))

    h_n = R_s (1 + nu)/E [2 (1 - nu) n + 1 - 2 nu]/(n^2 - 1),    h_0 = R_s (1 + nu)/E;

a housing that ends at a free outside takes r^n and r^(n+2) besides.  h_1 is the motion of the ring in its housing and not of this law: in a massive
body of two dimensions it has no bound.

What rollers and raceway press into each other is in the law of their contact.  Here forces act on the neutral line: no part of the deflection under
a roller counts twice, because the neutral line does not know how the section is squeezed below a contact.

Range: a section that is thin against the ring's radius; with shear within 2.5 % of an elastic annulus up to n t/R = 1.
"""

import math
from typing import NamedTuple

import numpy as np

SHEAR_FACTOR = 5.0 / 6.0  # k of a rectangle


class RingSection(NamedTuple):
    """Section of a ring and its material."""

    radius: float  # of the neutral line, R [m]
    second_moment: float  # I for bending in the plane of the ring [m^4]
    area: float  # A [m^2]
    modulus: float  # E [Pa]
    shear_modulus: float  # G [Pa]; infinite: no shear


def ring_compliance(n, section: RingSection):
    """Return c_n [m/N], the deflection in n waves by the force in n waves; 0 for n = 1, the motion of the whole ring.

    Parameters
    ----------
    n : numbers of waves, an array of whole numbers.
    section : of the ring.
    """
    n = np.asarray(n, float)
    radius, modulus = section.radius, section.modulus
    with np.errstate(divide="ignore"):
        bent = radius**3 / (math.pi * (n * n - 1.0) ** 2)
        bent = bent * (1.0 / (modulus * section.second_moment) + n * n / (radius * radius * SHEAR_FACTOR * section.shear_modulus * section.area))
    return np.where(n == 0.0, radius / (2.0 * math.pi * modulus * section.area), np.where(n == 1.0, 0.0, bent))


def modal_mass(n, section: RingSection, density: float):
    """Return the mass that n >= 2 waves of a ring of a density [kg/m^3] move [kg], of a coefficient a_n or b_n."""
    n = np.asarray(n, float)
    return math.pi * density * section.area * section.radius * (1.0 + 1.0 / (n * n))


def free_frequencies(n, section: RingSection, density: float):
    """Return the angular frequencies of the free ring in n >= 2 waves [rad/s]; ``density`` as of `modal_mass`."""
    return 1.0 / np.sqrt(modal_mass(n, section, density) * ring_compliance(n, section))


def bore_compliance(n, radius: float, modulus: float, poisson_ratio: float, outside: float = math.inf):
    """Return h_n [m/Pa], how far the bore of a housing gives way in n waves; 0 for n = 1, see the docstring of the module.

    Parameters
    ----------
    n : numbers of waves, an array of whole numbers.
    radius : of the bore, R_s [m].
    modulus, poisson_ratio : E [Pa] and nu of the housing.
    outside : radius of its free outside [m]; infinite: massive.
    """
    return np.array([_one_bore_compliance(int(k), radius, modulus, poisson_ratio, radius / outside) for k in np.atleast_1d(n)])


def bed_compliance(n, stiffness: float):
    """Return h_n of a local bed: the same for all waves, 1 over its stiffness [N/m^3]; 0 for n = 1."""
    n = np.asarray(n)
    return np.where(n == 1, 0.0, 1.0 / stiffness)


def _one_bore_compliance(n, radius, modulus, nu, ratio):
    scale = radius * (1.0 + nu) / modulus
    if n == 1:
        return 0.0
    if n == 0:
        square = ratio * ratio
        return scale * (1.0 + (1.0 - 2.0 * nu) * square) / (1.0 - square)
    if ratio == 0.0:
        return scale * (2.0 * (1.0 - nu) * n + 1.0 - 2.0 * nu) / (n * n - 1.0)
    # Stress function sum A_k r^k cos n phi, k = -n, 2 - n, n, n + 2, with r over the bore's radius; those that grow are scaled by the outside's
    # radius, so that no power overflows.  Stresses (J. H. Michell 1899): radial -(n^2 - k) r^(k-2), shear n (k - 1) r^(k-2).
    powers = np.array([-n, 2 - n, n, n + 2], float)
    at_bore = np.array([1.0, 1.0, ratio ** (n - 2.0), ratio**n])
    at_outside = np.array([ratio ** (n + 2.0), ratio**n, 1.0, 1.0])
    equations = np.array([(powers - n * n) * at_bore, (powers - 1.0) * at_bore, (powers - n * n) * at_outside, (powers - 1.0) * at_outside])
    found = np.linalg.solve(equations, [-1.0, 0.0, 0.0, 0.0])
    # Radial displacement times E/(1 + nu): -k r^(k-1), and 4 (1 - nu) r^(k-1) where r^k belongs to n by k = n + 2 or 2 - n.
    moved = np.array([n, -(2.0 - n) + 4.0 * (1.0 - nu), -n, -(n + 2.0) + 4.0 * (1.0 - nu)]) * at_bore
    return scale * float(moved @ found)
