# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cross-section as numbers: the points of a picture of the bearing, independent of any drawing library.

One rule draws bodies to scale and still shows the play: bodies keep their size, while every radial departure from the
ideal bearing (round outer raceway of radius R_i + D_w, no clearance, centred ring) is drawn `magnification` times.  So a
contour lobe, a gap, an elastic approach (seen as an overlap) and the inner ring's displacement share one factor.

Lengths here are millimetres; the picture looks against the x axis, y to the right, z up.
"""

import math

import numpy as np

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.contour import outer_contour
from bearing_sim.scene.scene import Scene

MILLIMETRE = 1e-3  # [m]
CONTOUR_POINTS = 361
_FACTORS = (300, 200, 150, 100, 80, 50, 40, 30, 20, 15, 10, 8, 5, 4, 3, 2)


def places(across, down) -> np.ndarray:
    """Return points of the picture, whose vertical axis points down, shape (..., 2)."""
    return np.stack(np.broadcast_arrays(across, down), axis=-1)


def picture(y, z) -> np.ndarray:
    """Return points (y, z) as picture coordinates, whose vertical axis points down, shape (..., 2).

    The only function that flips the vertical axis.
    """
    return places(np.asarray(y, float), -np.asarray(z, float))


def polar(radius, azimuth, centre=(0.0, 0.0)) -> np.ndarray:
    """Return picture points at a radius [mm] and azimuth [rad] about ``centre`` (y, z) [mm]."""
    return picture(centre[0] + radius * np.cos(azimuth), centre[1] + radius * np.sin(azimuth))


def ideal_outer_radius(bearing: Bearing) -> float:
    """Return R_i + D_w [m]: the outer raceway that leaves the rollers neither play nor preload."""
    return bearing.inner_raceway.radius + bearing.roller.diameter


def round_up(number: float) -> float:
    """Return the smallest of ... 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 15, 20 ... that is not below a positive number."""
    decade = 10.0 ** math.floor(math.log10(number))
    return next(step * decade for step in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0) if step * decade >= number * (1 - 1e-9))


def round_ticks(low: float, high: float, most: int = 6) -> np.ndarray:
    """Return at most ``most`` round numbers from ``low`` to ``high``, evenly spaced."""
    step = round_up((high - low) / (most - 1))
    first = math.ceil(low / step - 0.02)
    return np.round(step * np.arange(first, math.floor(high / step + 0.02) + 1), 9)


def magnification(bearing: Bearing) -> int:
    """Return the factor for radial departures: the largest of the contour is drawn as a good third of a roller."""
    ideal, raceway = ideal_outer_radius(bearing), bearing.outer_raceway
    departure = max(abs(raceway.low_radius - ideal), abs(raceway.low_radius + raceway.d_value - ideal), 1e-3 * bearing.roller.diameter)
    wanted = 0.4 * bearing.roller.diameter / departure
    return next((factor for factor in _FACTORS if factor <= wanted), 1)


def cage_magnification(scene: Scene) -> int:
    """Return the factor for the cage's displacement and its play in what guides it: nothing then leaves the space between the raceways.

    The cage has a factor of its own, because its play is several times that of the rollers; 1 without whirl.
    """
    if not scene.cage_whirls:
        return 1
    cage, inner, outer = scene.bearing.cage, scene.bearing.inner_raceway.radius, ideal_outer_radius(scene.bearing)
    beside = {
        "outer_ring": lambda: outer - cage.land_radius,
        "inner_ring": lambda: cage.land_radius - inner,
        "roller": lambda: min(outer - cage.outside, cage.bore - inner),
    }
    room = 0.8 * beside[cage.guidance]() / cage.play + 1.0
    return next((factor for factor in (100, 50, 30, 20, 15, 10, 8, 5, 4, 3, 2) if factor <= room), 1)


def tilt_magnification(scene: Scene) -> int:
    """Return the factor for tilts of rollers and inner ring: that of other radial departures, less where it would turn the ring too far."""
    most = min(magnification(scene.bearing), 0.3 / max(scene.operating.misalignment, 1e-9))
    return next((factor for factor in _FACTORS if factor <= most), 1)


def skew_magnification(bearing: Bearing) -> int:
    """Return the factor for skews of rollers: an axis that lies as skewed in its pocket as it can is drawn at 0.6 rad."""
    most = 0.6 / (2 * bearing.cage.pocket_clearance / bearing.roller.length)
    return next((factor for factor in _FACTORS if factor <= most), 1)


def leaning(towards_y, towards_z) -> np.ndarray:
    """Return the turns that incline axes by these slopes towards y and z, quaternions (y, z, x, w), shape (..., 4); unknown ones stay upright."""
    towards_y, towards_z = np.nan_to_num(towards_y), np.nan_to_num(towards_z)
    half = 0.5 * np.arctan(np.hypot(towards_y, towards_z))
    scale = np.sin(half) / np.maximum(np.hypot(towards_y, towards_z), 1e-12)
    return np.stack((-towards_z * scale, towards_y * scale, np.zeros(half.shape), np.cos(half)), axis=-1)


def drawn_guide_radius(bearing: Bearing, cage_factor: float) -> float | None:
    """Return the drawn radius [mm] of the guide land, None without lands: the clearance is drawn ``cage_factor`` times."""
    cage = bearing.cage
    if not cage.has_lands:
        return None
    outwards = 1 if cage.guidance == "outer_ring" else -1
    return (cage.land_radius + outwards * (cage_factor - 1) * cage.guide_clearance) / MILLIMETRE


def land_displacement(bearing: Bearing, cage_factor: float, sample) -> tuple[float, float]:
    """Return the drawn displacement (y, z) [mm] of the guide land's centre: the inner ring's goes with the ring, by the cage's factor."""
    return ring_displacement(cage_factor, sample) if bearing.cage.guidance == "inner_ring" else (0.0, 0.0)


def cage_displacement(cage_factor: float, sample) -> tuple[float, float]:
    """Return the drawn displacement (y, z) [mm] of the cage's centre; none where it is not known."""
    return tuple(cage_factor * float(np.nan_to_num(sample[field])) / MILLIMETRE for field in ("cage_y", "cage_z"))


def drawn_contour(bearing: Bearing, factor: float, azimuth) -> np.ndarray:
    """Return the drawn radius [mm] of the outer raceway at an azimuth [rad]."""
    ideal = ideal_outer_radius(bearing)
    return (ideal + factor * (outer_contour(bearing.outer_raceway, azimuth)[0] - ideal)) / MILLIMETRE


def bent_contour(bearing: Bearing, factor: float, azimuth, sample) -> np.ndarray:
    """Return the drawn radius [mm] of an outer raceway that has bent, at azimuths [rad]: between rollers by as many waves as they resolve."""
    waves = np.arange((bearing.roller.count + 1) // 2)

    def basis(angles):
        return np.concatenate((np.cos(np.outer(angles, waves)), np.sin(np.outer(angles, waves[1:]))), axis=1)

    amplitudes = np.linalg.lstsq(basis(sample["roller_angle"]), sample["raceway_deflection"], rcond=None)[0]
    return drawn_contour(bearing, factor, azimuth) + factor * (basis(azimuth) @ amplitudes) / MILLIMETRE


def outer_surface_radius(bearing: Bearing, factor: float) -> float:
    """Return the drawn outside radius [mm] of the outer ring; the scene does not give the true one."""
    highest = drawn_contour(bearing, factor, np.linspace(0.0, 2 * math.pi, CONTOUR_POINTS)).max()
    return float(highest + 0.25 * bearing.roller.diameter / MILLIMETRE)


def heat_radii(bearing: Bearing) -> dict[str, tuple[float, float]]:
    """Return the inside and outside radius [mm] of each body that has a temperature, rollers as their centres' circle and radius.

    Rings without a bore or an outside radius in the scene are 0.4 roller diameters thick; the housing is drawn as thick as that.
    """
    roller, inner, outer = bearing.roller, bearing.inner_raceway, bearing.outer_raceway
    thickness = 0.4 * roller.diameter
    bore = inner.bore_radius if inner.bore_radius is not None else inner.radius - thickness
    raceway = inner.radius + roller.diameter
    outside = outer.outside_radius if outer.outside_radius is not None else raceway + thickness
    bodies = {
        "shaft": (0.0, bore),
        "inner_ring": (bore, inner.radius),
        "rollers": (bearing.pitch_radius, roller.diameter / 2),
        "outer_ring": (raceway, outside),
        "housing": (outside, outside + thickness),
    }
    return {name: (inside / MILLIMETRE, beyond / MILLIMETRE) for name, (inside, beyond) in bodies.items()}


def roller_centres(bearing: Bearing, factor: float, sample) -> np.ndarray:
    """Return the drawn roller centres (picture points, mm), shape (Z, 2)."""
    pitch = bearing.pitch_radius
    radius = (pitch + factor * (sample["roller_radius"] - pitch)) / MILLIMETRE
    return polar(radius, sample["roller_angle"])


def spin_marks(bearing: Bearing, centres: np.ndarray, sample) -> np.ndarray:
    """Return a mark on each roller from its centre to its rim that turns with it, shape (Z, 2, 2).

    A roller that rolls on the outer ring has positive spin and turns against the orbit, hence the sign.
    """
    rim = polar(0.8 * bearing.roller.diameter / 2 / MILLIMETRE, -sample["roller_rotation"])
    return np.stack((centres, centres + rim), axis=1)


def cage_bars(bearing: Bearing, cage_angle: float, centre=(0.0, 0.0)) -> np.ndarray:
    """Return the middle lines of the bars between the pockets, shape (Z, 2, 2); bar 0 lies behind pocket 0.

    The cage's centre is drawn at ``centre`` (y, z) [mm].

    Drawn as thick as `cage_bar_stroke` says, a line's ends being round: along the radius where the pockets leave little,
    along the circumference where they leave much.
    """
    count = bearing.roller.count
    azimuth = cage_angle + (np.arange(count) - 0.5) * 2 * math.pi / count
    middle, depth, width = _cage_bar(bearing)
    if width <= depth:
        return np.stack((polar(middle - (depth - width), azimuth, centre), polar(middle + (depth - width), azimuth, centre)), axis=1)
    lean = (width - depth) / middle
    return np.stack((polar(middle, azimuth - lean, centre), polar(middle, azimuth + lean, centre)), axis=1)


def cage_bar_stroke(bearing: Bearing) -> float:
    """Return the half thickness [mm] of the lines of `cage_bars`."""
    return min(_cage_bar(bearing)[1:])


def _cage_bar(bearing: Bearing) -> tuple[float, float, float]:
    """Return middle radius, half depth and half width [mm] of a bar: what cage and pockets leave on the pitch circle."""
    inner, outer = bearing.cage.bore / MILLIMETRE, bearing.cage.outside / MILLIMETRE
    room = math.pi * bearing.pitch_radius / bearing.roller.count - 1.03 * bearing.roller.diameter / 2
    return (inner + outer) / 2, (outer - inner) / 2, max(room, 0.02 * bearing.roller.diameter) / MILLIMETRE


def ring_displacement(factor: float, sample) -> tuple[float, float]:
    """Return the drawn displacement (y, z) [mm] of the inner ring's centre."""
    return factor * float(sample["ring_y"]) / MILLIMETRE, factor * float(sample["ring_z"]) / MILLIMETRE


def load_arrows(bearing: Bearing, factor: float, sample, length_per_newton: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return origins and vectors of the forces on both rings: what the rollers press on, drawn outside them.

    Parameters
    ----------
    length_per_newton : drawn length of a force [mm/N].

    Returns
    -------
    inner_origins, inner_vectors, outer_origins, outer_vectors : picture points, each of shape (Z, 2).
    """
    azimuth = sample["roller_angle"]
    inner_radius = bearing.inner_raceway.radius / MILLIMETRE
    inner_origins = polar(inner_radius, azimuth, ring_displacement(factor, sample))
    outer_origins = polar(drawn_contour(bearing, factor, azimuth), azimuth)
    inner_vectors = polar(-length_per_newton * sample["inner_load"], azimuth)
    outer_vectors = polar(length_per_newton * sample["outer_load"], azimuth)
    return inner_origins, inner_vectors, outer_origins, outer_vectors


def pocket_arrows(sample, length_per_newton: float) -> np.ndarray:
    """Return vectors of the pockets' forces on the rollers, along the orbit, shape (Z, 2); none where they are not known.

    Parameters
    ----------
    length_per_newton : drawn length of a force [mm/N].
    """
    return polar(length_per_newton * np.nan_to_num(sample["pocket_force"]), sample["roller_angle"] + math.pi / 2)


def regime(slip: float, warning: float, error: float, before: str = "") -> str:
    """Return the word for a cage slip (fractions): rolling, slipping, skidding, overrunning, or at rest for NaN.

    A regime, once entered (``before``), holds until the slip is a twentieth below its threshold: no flicker at the line.
    """
    if math.isnan(slip):
        return "at rest"
    if slip >= (0.95 * error if before == "skidding" else error):
        return "skidding"
    if slip >= (0.95 * warning if before in ("slipping", "skidding") else warning):
        return "slipping"
    return "overrunning" if slip <= -(0.95 * warning if before == "overrunning" else warning) else "rolling"
