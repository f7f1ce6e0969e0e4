# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pre-deformation machining of a lobed raceway (Deng 2017, eq. 1, Fig. 1 to 3): press the blank, grind it round, release it.

At the pressed arcs the raceway springs back outwards and forms high points.  Deng computes the deformation by finite elements;
this module uses a thin elastic ring (`bearing_sim.physics.outer_ring`, without shear) and the Fourier series of the pressure: the harmonic q_n bends
the ring inwards by w_n = q_n b R^4/(E I (n^2 - 1)^2), the mean pressure shrinks it by q_0 R^2/(E t).  An equivalent thickness accounts for the ribs.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.physics.outer_ring import RingSection, ring_compliance
from bearing_sim.scene.display import number
from bearing_sim.sweep.pictures import new_figure, plain_numbers, save

HARMONICS = 120  # w_n falls with the fifth power of n
POINTS = 720
_FINE = 10 * POINTS
_TURN = 2.0 * math.pi


class Blank(NamedTuple):
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
    arc_turn: float = 0.0  # rotation of the last arc from even spacing, phi_f [rad]
    arc_width: float = math.pi / 3  # [rad]
    arcs: int = 3
    width: float | None = None  # pressed width [m]; None: the ring's width

    @property
    def centres(self) -> np.ndarray:
        """Azimuths of the middles of the arcs [rad], between the low points; one low point is at 0."""
        centres = (np.arange(self.arcs) + 0.5) * _TURN / self.arcs
        centres[-1] += self.arc_turn
        return centres

    @property
    def pressures(self) -> np.ndarray:
        """Pressures of the arcs [Pa] with the given mean: the least-squares nearest to equal ones with zero resultant."""
        directions = np.stack([np.cos(self.centres), np.sin(self.centres)])
        balanced = 1.0 - directions.T @ np.linalg.lstsq(directions.T, np.ones(self.arcs), rcond=None)[0]
        return self.pressure * balanced / balanced.mean()


class Machined(NamedTuple):
    """The raceway after release."""

    azimuths: np.ndarray  # [rad], shape (POINTS,)
    radii: np.ndarray  # R_e there [m], shape (POINTS,)
    ground_radius: float  # R_egm, of the pressed raceway [m]
    lows: np.ndarray  # azimuth [rad] and radius [m] of the low points, shape (n, 2)
    highs: np.ndarray  # of the high points, shape (n, 2)

    @property
    def d_value(self) -> float:
        """Mean radius of the high points minus that of the low points, D [m]."""
        return float(self.highs[:, 1].mean() - self.lows[:, 1].mean())

    @property
    def roundness(self) -> float:
        """Highest minus lowest of the low points, e [m]."""
        return float(np.ptp(self.lows[:, 1]))


def pressure_harmonics(pressing: Pressing, highest: int = HARMONICS) -> np.ndarray:
    """Return the complex q_n, n = 0 ... ``highest`` [Pa]: the pressure at azimuth phi is the sum of the real parts of q_n exp(i n phi)."""
    n = np.arange(1, highest + 1)[:, None]
    turns = np.exp(-1j * n * pressing.centres) * pressing.pressures
    harmonics = 2.0 / (math.pi * n[:, 0]) * np.sin(n[:, 0] * pressing.arc_width / 2) * turns.sum(axis=1)
    return np.concatenate([[pressing.pressures.sum() * pressing.arc_width / _TURN], harmonics])


def deflection(azimuths, blank: Blank, harmonics: np.ndarray, pressed_width: float | None = None) -> np.ndarray:
    """Return the inward deflection of the pressed ring at azimuths [m].

    Parameters
    ----------
    azimuths : [rad].
    blank : the ring.
    harmonics : of the pressure, see `pressure_harmonics`; the first is ignored: it moves the ring as a whole.
    pressed_width : [m]; None: the ring's width.
    """
    force = math.pi * blank.mean_radius * (blank.width if pressed_width is None else pressed_width)  # by a wave of pressure
    ring = RingSection(blank.mean_radius, blank.second_moment, blank.width * blank.thickness, blank.modulus, math.inf)
    n = np.arange(2, len(harmonics))
    bent = force * harmonics[2:] * ring_compliance(n, ring)
    shrunk = 2.0 * force * harmonics[0].real * float(ring_compliance(0, ring))
    return shrunk + (np.exp(1j * np.multiply.outer(azimuths, n)) @ bent).real


def machine(blank: Blank, pressing: Pressing, *, ground_radius: float | None = None, low_radius: float | None = None) -> Machined:
    """Return the raceway after pressing, grinding round and releasing.

    Parameters
    ----------
    blank, pressing : the blank and its load.
    ground_radius : R_egm [m]; or
    low_radius : lowest radius of the released raceway [m].
    """
    fine = _TURN * np.arange(_FINE) / _FINE
    sprung = deflection(fine, blank, pressure_harmonics(pressing), pressing.width)
    ground = low_radius - sprung.min() if ground_radius is None else ground_radius
    radii = ground + sprung
    before, after = np.roll(radii, 1), np.roll(radii, -1)
    lows, highs = (np.stack([fine[best], radii[best]], axis=1) for best in ((radii < before) & (radii <= after), (radii > before) & (radii >= after)))
    every = _FINE // POINTS
    return Machined(fine[::every], radii[::every], float(ground), lows, highs)


def contour_text(machined: Machined, about: str) -> str:
    """Return the text of a ``contour_file`` for scenes, with ``about`` as comments at its top."""
    lines = [f"# {line}" for line in about.splitlines()]
    points = zip(np.degrees(machined.azimuths), 1e3 * machined.radii)
    return "\n".join([*lines, "angle [deg], radius [mm]", *(f"{angle:.6g}, {radius:.8f}" for angle, radius in points), ""])


_CONTOUR, _PRESSED, _ROUND = "#b2451f", "#c9d8ea", "#7a7a7a"
_DRAWN = 0.22  # of the radius, as which D is drawn


def plot_machined(path: Path, blank: Blank, pressing: Pressing, machined: Machined) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(11, 5.2)
    shape, radius = figure.subplots(1, 2, width_ratios=(1, 1.35))
    _draw_shape(shape, pressing, machined)
    _draw_radius(radius, pressing, machined)
    pressed = f"{pressing.arcs} arcs of {math.degrees(pressing.arc_width):g}° pressed with {1e-6 * pressing.pressure:g} MPa"
    ring = f"ring of mean radius {1e3 * blank.mean_radius:g} mm and thickness {1e3 * blank.thickness:g} mm"
    made = f"D value {number(1e6 * machined.d_value)} µm, roundness of the low points {number(round(1e6 * machined.roundness, 3))} µm"
    turn = f", one of them turned by {math.degrees(pressing.arc_turn):g}°" if pressing.arc_turn else ""
    save(figure, path, f"{pressed}{turn}, {ring}\n{made}", 11)


def _edges(pressing):
    return [(centre - pressing.arc_width / 2, centre + pressing.arc_width / 2) for centre in pressing.centres]


def _draw_shape(axes, pressing, machined):
    """Draw the raceway as seen along the shaft, y to the right and z up."""
    span = float(np.ptp(machined.radii))
    factor = _DRAWN * machined.ground_radius / span if span > 0.0 else 1.0
    azimuths = np.append(machined.azimuths, 2 * math.pi)
    drawn = 1.0 + factor * (np.append(machined.radii, machined.radii[0]) / machined.ground_radius - 1.0)
    outside = 1.32
    for (start, end), pressure in zip(_edges(pressing), pressing.pressures):
        arc = np.linspace(start, end, 40)
        axes.plot(outside * np.cos(arc), outside * np.sin(arc), color="#6f93bd", lw=7, solid_capstyle="butt")
        inward = {"arrowstyle": "-|>", "color": "#3c5f8a", "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
        for at in np.linspace(start, end, 5)[1:-1]:
            direction = np.array([math.cos(at), math.sin(at)])
            axes.annotate("", xy=(outside - 0.19) * direction, xytext=(outside - 0.03) * direction, arrowprops=inward)
        middle = 0.5 * (start + end)
        axes.text(
            1.53 * math.cos(middle), 1.53 * math.sin(middle), f"{1e-6 * pressure:.2f}\nMPa", ha="center", va="center", fontsize=9, color="#3c5f8a"
        )
    axes.plot(np.cos(azimuths), np.sin(azimuths), "--", color=_ROUND, lw=1, label="ground, under load")
    axes.plot(drawn * np.cos(azimuths), drawn * np.sin(azimuths), color=_CONTOUR, lw=2, label=f"released, deviations ×{factor:.0f}")
    axes.set(aspect="equal", xlim=(-1.75, 1.75), ylim=(-1.75, 1.75))
    axes.axis("off")
    axes.legend(loc="center", frameon=False, fontsize=9)


def _draw_radius(axes, pressing, machined):
    for edges in _edges(pressing):
        for shift in (-360.0, 0.0, 360.0):
            axes.axvspan(*(math.degrees(edge) + shift for edge in edges), color=_PRESSED, lw=0)
    azimuths, radii = np.append(np.degrees(machined.azimuths), 360.0), 1e3 * np.append(machined.radii, machined.radii[0])
    axes.axhline(1e3 * machined.ground_radius, color=_ROUND, ls="--", lw=1)
    axes.plot(azimuths, radii, color=_CONTOUR, lw=2)
    span = max(float(np.ptp(radii)), 1e-6)
    for points, side, place in ((machined.lows, -1, "top"), (machined.highs, 1, "bottom")):
        for angle, radius in points * [math.degrees(1.0), 1e3]:
            axes.plot(angle, radius, "o", color=_CONTOUR, ms=4)
            look = {"ha": "left" if angle < 5.7 else "center", "va": place, "fontsize": 9}
            axes.annotate(f"{radius:.4f}", (angle, radius), xytext=(0, 7 * side), textcoords="offset points", **look)
    axes.set(xlim=(0, 360), ylim=(radii.min() - 0.14 * span, radii.max() + 0.14 * span), xlabel="azimuth [°]", ylabel="raceway radius [mm]")
    axes.set_xticks(range(0, 361, 60))
    plain_numbers(axes.yaxis)
    axes.set_title("pressed arcs shaded", fontsize=10, color=_ROUND)
