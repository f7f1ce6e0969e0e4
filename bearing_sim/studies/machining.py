# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pre-deformation machining of a lobed raceway (Deng 2017, eq. 1, Fig. 1 to 3): press the blank, grind it round, release it.

Where the pressed arcs were the raceway springs back outwards and makes high points.  Deng computes the deformation by finite
elements; here it is that of a thin elastic ring, term by term of the pressure's Fourier series: the harmonic q_n of the pressure
bends the ring inwards by w_n = q_n b R^4/(E I (n^2 - 1)^2), the mean pressure shrinks it by q_0 R^2/(E t).  The ring's ribs are in
its equivalent thickness.
"""

import math
from typing import NamedTuple

import numpy as np

HARMONICS = 120  # w_n falls with the fifth power of n
POINTS = 720
_FINE = 10 * POINTS
_TURN = 2.0 * math.pi


class RingSection(NamedTuple):
    """A ring blank."""

    mean_radius: float  # R [m]
    width: float  # b [m]
    thickness: float  # equivalent thickness t of the ribbed section [m]
    modulus: float  # Young's modulus E [Pa]

    @property
    def second_moment(self) -> float:
        """I of the section for bending in the ring's plane [m^4]."""
        return self.width * self.thickness**3 / 12


class Pressing(NamedTuple):
    """How the blank is pressed from outside while it is ground."""

    pressure: float  # mean over the arcs, p [Pa]
    arc_turn: float = 0.0  # how far the last arc is turned from its even place, phi_f [rad]
    arc_width: float = math.pi / 3  # [rad]
    arcs: int = 3
    width: float | None = None  # pressed width [m]; the ring's where absent

    @property
    def centres(self) -> np.ndarray:
        """Azimuths of the arcs' middles [rad], between the low points, one of which is at 0."""
        centres = (np.arange(self.arcs) + 0.5) * _TURN / self.arcs
        centres[-1] += self.arc_turn
        return centres

    @property
    def pressures(self) -> np.ndarray:
        """Pressures of the arcs [Pa], nearest to equal ones among those whose resultant vanishes, with the given mean."""
        directions = np.stack([np.cos(self.centres), np.sin(self.centres)])
        balanced = 1.0 - directions.T @ np.linalg.lstsq(directions.T, np.ones(self.arcs), rcond=None)[0]
        return self.pressure * balanced / balanced.mean()


class Machined(NamedTuple):
    """The raceway after release."""

    azimuths: np.ndarray  # [rad], shape (POINTS,)
    radii: np.ndarray  # R_e there [m], shape (POINTS,)
    ground_radius: float  # R_egm, of the raceway while it is pressed [m]
    lows: np.ndarray  # azimuth [rad] and radius [m] of the low points, shape (n, 2)
    highs: np.ndarray  # of the high points, shape (n, 2)

    @property
    def d_value(self) -> float:
        """Mean radius of the high points less that of the low points, D [m]."""
        return float(self.highs[:, 1].mean() - self.lows[:, 1].mean())

    @property
    def roundness(self) -> float:
        """Highest less lowest of the low points, e [m]."""
        return float(np.ptp(self.lows[:, 1]))


def pressure_harmonics(pressing: Pressing, highest: int = HARMONICS) -> np.ndarray:
    """Return the complex q_n, n = 0 ... ``highest`` [Pa]: the pressure at azimuth phi is the sum of the real parts of q_n exp(i n phi)."""
    n = np.arange(1, highest + 1)[:, None]
    turns = np.exp(-1j * n * pressing.centres) * pressing.pressures
    harmonics = 2.0 / (math.pi * n[:, 0]) * np.sin(n[:, 0] * pressing.arc_width / 2) * turns.sum(axis=1)
    return np.concatenate([[pressing.pressures.sum() * pressing.arc_width / _TURN], harmonics])


def deflection(azimuths, section: RingSection, harmonics: np.ndarray, pressed_width: float | None = None) -> np.ndarray:
    """Return how far the pressed ring is bent inwards at azimuths [rad], in [m].

    Parameters
    ----------
    azimuths : where [rad].
    section : the ring.
    harmonics : of the pressure, see `pressure_harmonics`; the first moves the ring as a whole and is left out.
    pressed_width : [m]; the ring's where absent.
    """
    width = section.width if pressed_width is None else pressed_width
    n = np.arange(2, len(harmonics))
    bent = harmonics[2:] * width * section.mean_radius**4 / (section.modulus * section.second_moment * (n**2 - 1.0) ** 2)
    shrunk = harmonics[0].real * width * section.mean_radius**2 / (section.modulus * section.width * section.thickness)
    return shrunk + (np.exp(1j * np.multiply.outer(azimuths, n)) @ bent).real


def machine(section: RingSection, pressing: Pressing, *, ground_radius: float | None = None, low_radius: float | None = None) -> Machined:
    """Return the raceway that pressing, grinding round and releasing make.

    Parameters
    ----------
    section, pressing : the blank and its load.
    ground_radius : R_egm [m]; or
    low_radius : lowest radius that the released raceway shall have [m].
    """
    fine = _TURN * np.arange(_FINE) / _FINE
    sprung = deflection(fine, section, pressure_harmonics(pressing), pressing.width)
    ground = low_radius - sprung.min() if ground_radius is None else ground_radius
    radii = ground + sprung
    before, after = np.roll(radii, 1), np.roll(radii, -1)
    lows, highs = (np.flatnonzero(best) for best in ((radii < before) & (radii <= after), (radii > before) & (radii >= after)))
    every = _FINE // POINTS
    return Machined(
        fine[::every], radii[::every], float(ground), np.stack([fine[lows], radii[lows]], axis=1), np.stack([fine[highs], radii[highs]], axis=1)
    )


def contour_text(machined: Machined, about: str) -> str:
    """Return a contour file for ``contour_file`` of a scene, with ``about`` in comments at its top."""
    lines = [f"# {line}" for line in about.splitlines()]
    points = zip(np.degrees(machined.azimuths), 1e3 * machined.radii)
    return "\n".join([*lines, "angle [deg], radius [mm]", *(f"{angle:.6g}, {radius:.8f}" for angle, radius in points), ""])
