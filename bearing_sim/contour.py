# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Forms of the outer raceway contour R_e(phi): lobes, lobes whose points differ, and measured ones.

Each form gives radius and slope at any azimuth; `bearing_sim.kernels.raceway.tabulated` brings them all into the one table that
kernels know.
"""

import math

import numpy as np

from bearing_sim.contour_file import measured_spline

UNREAD = "contour_file: its contents are missing; load_scene reads them"
_TURN = 2.0 * math.pi


def outer_contour(raceway, azimuth) -> tuple[np.ndarray, np.ndarray]:
    """Return R_e [m] and dR_e/dphi [m/rad] at azimuths [rad].

    Parameters
    ----------
    raceway : `bearing_sim.scene_raceway.OuterRaceway`.
    azimuth : array or number.
    """
    phi = np.asarray(azimuth, float) - raceway.installation_angle
    if raceway.contour is not None:
        spline = measured_spline(raceway.contour, raceway.contour_angle_unit, raceway.contour_radius_unit)
        return spline(phi), spline(phi, 1)
    if raceway.low_points:
        return half_cosines(phi, *_alternating(raceway.low_points, raceway.high_points))
    if raceway.roundness:
        return half_cosines(phi, *_uneven_lobes(raceway.low_radius, raceway.d_value, raceway.lobes, raceway.roundness))
    half, phase = raceway.d_value / 2, raceway.lobes * phi
    return raceway.low_radius + half * (1.0 - np.cos(phase)), raceway.lobes * half * np.sin(phase)


def half_cosines(phi, azimuths, radii) -> tuple[np.ndarray, np.ndarray]:
    """Return radius and slope of a contour that goes from each turning point to the next by half a cosine wave.

    Deng 2017 builds the non-ideal contour of six of them; slopes are continuous, and zero at the turning points.

    Parameters
    ----------
    phi : where [rad].
    azimuths : of the turning points, rising, within one turn [rad], shape (n,).
    radii : there [m], shape (n,).
    """
    knots, values = np.append(azimuths, azimuths[0] + _TURN), np.append(radii, radii[0])
    place = knots[0] + np.mod(phi - knots[0], _TURN)
    k = np.clip(np.searchsorted(knots, place, side="right") - 1, 0, len(azimuths) - 1)
    width, rise = np.diff(knots)[k], np.diff(values)[k]
    phase = math.pi * (place - knots[k]) / width
    return values[k] + rise / 2 * (1.0 - np.cos(phase)), math.pi / width * rise / 2 * np.sin(phase)


def _alternating(low_points, high_points) -> tuple[np.ndarray, np.ndarray]:
    points = sorted((point.azimuth % _TURN, point.radius) for point in (*low_points, *high_points))
    return np.array([azimuth for azimuth, _ in points]), np.array([radius for _, radius in points])


def _uneven_lobes(low_radius, d_value, lobes, roundness) -> tuple[np.ndarray, np.ndarray]:
    """Turning points whose lows spread evenly over ``roundness`` about ``low_radius``; where a low rises, the next high falls."""
    spread = roundness * (np.arange(lobes) / (lobes - 1) - 0.5)
    return math.pi / lobes * np.arange(2 * lobes), np.stack([low_radius + spread, low_radius + d_value - spread], axis=1).ravel()


def measured_extent(raceway) -> tuple[float, float, int]:
    """Return the lowest radius [m], the highest less the lowest [m], and the number of lobes of a measured contour.

    Lobes are counted by the strongest of the harmonics 2 to 12 (the first is an offset of the whole).
    """
    radii = outer_contour(raceway, np.linspace(0.0, _TURN, 14_400, endpoint=False))[0]
    harmonics = np.abs(np.fft.rfft(radii))[2:13]
    return float(radii.min()), float(np.ptp(radii)), 2 + int(harmonics.argmax())


def form_faults(raceway) -> list[str]:
    """Return what is wrong with how a raceway's form is given, in words."""
    forms = {
        "contour": raceway.contour is not None or raceway.contour_file is not None,
        "low_points and high_points": bool(raceway.low_points or raceway.high_points),
        "roundness": raceway.roundness > 0.0,
    }
    given = [name for name, present in forms.items() if present]
    if len(given) > 1:
        return [f"{' and '.join(given)} exclude each other; give one"]
    if forms["contour"]:
        return _measured_faults(raceway)
    faults = [f"{name}: is for a contour from a file" for name in ("contour_angle_unit", "contour_radius_unit") if getattr(raceway, name) is not None]
    if given == ["low_points and high_points"]:
        return faults + _point_faults(raceway)
    if raceway.low_radius is None:
        faults.append("low_radius: missing; or give the contour by low_points and high_points or by contour_file")
    if raceway.roundness and (raceway.lobes or 3) < 2:
        faults.append("roundness: one lobe has one low point, which cannot differ from the others; use lobes of at least 2")
    if raceway.roundness and raceway.roundness >= (raceway.d_value or 0.0):
        faults.append("roundness: expected less than d_value: some low point would be no lower than its neighbours")
    return faults


def _measured_faults(raceway) -> list[str]:
    if raceway.contour is None:
        return [UNREAD]
    try:
        outer_contour(raceway, 0.0)
    except ValueError as fault:
        name = f"contour ({raceway.contour_file})" if raceway.contour_file else "contour"
        return [f"{name}: {reason}" for reason in getattr(fault, "reasons", [str(fault)])]
    return []


def _point_faults(raceway) -> list[str]:
    lows, highs = raceway.low_points, raceway.high_points
    if not 1 <= len(lows) == len(highs) <= 12:
        return [f"low_points: {len(lows)} for {len(highs)} high_points; expected as many, 1 to 12"]
    points = sorted([(p.azimuth % _TURN, "low", p.radius) for p in lows] + [(p.azimuth % _TURN, "high", p.radius) for p in highs])
    faults = []
    for a, b in zip(points, points[1:] + [(points[0][0] + _TURN, *points[0][1:])]):
        where = f"{math.degrees(a[0]):.6g} and {math.degrees(b[0] % _TURN):.6g} deg"
        if b[0] - a[0] < math.radians(2.0):
            faults.append(f"low_points, high_points: those at {where} are nearer than 2 deg")
        elif a[1] == b[1]:
            faults.append(f"{a[1]}_points: no {'high' if a[1] == 'low' else 'low'} point between {where}")
        elif (a[2] < b[2]) != (a[1] == "low"):
            faults.append(f"low_points, high_points: of those at {where} the low one is not lower")
    return faults


def settled_form(raceway) -> tuple[dict, list[str]]:
    """Return low radius, D and lobes as the form has them, and what contradicts them in words; `form_faults` are none.

    Where a contour is given by points these follow from it: they need not be given, and what is given must agree.
    """
    if raceway.contour is not None:
        low, d, lobes = measured_extent(raceway)
    elif raceway.low_points:
        low = min(point.radius for point in raceway.low_points)
        d, lobes = max(point.radius for point in raceway.high_points) - low, len(raceway.low_points)
    else:
        return {"d_value": raceway.d_value or 0.0, "lobes": raceway.lobes or 3}, []
    settled, faults = {"low_radius": low, "d_value": d, "lobes": lobes}, []
    for name, value in settled.items():
        given = getattr(raceway, name)
        if given is not None and not math.isclose(given, value, rel_tol=1e-9, abs_tol=1e-12):
            shown = f"{value}" if name == "lobes" else f"{1e3 * value:.6g} mm"
            faults.append(f"{name}: follows from the contour's points ({shown}); leave it away")
    return settled, faults
