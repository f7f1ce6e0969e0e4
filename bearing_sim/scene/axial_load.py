# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Axial load on cylindrical roller bearings by the rules of makers: the equivalent load, and what flanges may carry.

SKF, General catalogue (2006), pp. 518-520 and 562-563, and Rolling bearings (2018), pp. 509-511; KRW, delivery programme, p. 177; Schaeffler, Rolling
bearings (HR 1, 2006), pp. 48-49; NSK, Rolling bearings (E1102), section 5.6; NTN, Ball and roller bearings, sections 3.11 and 4.6.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.designation import readable_designation
from bearing_sim.scene.ratings import rate

_SKF, _KRW = (0.2, 0.6), (0.11, 0.69)  # e and Y of the first group below
_FACTORS = {  # maker -> X, e and Y by dimension series, those of other series, and up to which F_a/F_r; NKE, URB and ZVL print SKF's
    "skf": (0.92, dict.fromkeys(("10", "2", "3", "4"), _SKF), (0.3, 0.4), 0.5),
    "krw": (0.93, dict.fromkeys(("10", "2", "3", "4"), _KRW) | {"30": (0.23, 0.33)}, (0.17, 0.45), 0.4),
}
_UNKNOWN_SERIES = "2"  # of a bearing without a designation: assumption, the factors that give the larger load
_UNCOUNTED_RATIO = 0.4  # F_a over F_r up to which NTN and Schaeffler let flanges be loaded
_LEAST_VISCOSITY_RATIO = 2.0  # kappa from which the thermal limit is stated
_LARGEST_MISALIGNMENT = math.radians(1.0 / 60.0)  # up to which it is
_LARGE_SURFACE = 0.05  # pi B (d + D) [m^2] above which C_0 counts as 7.5 C_0^(2/3) [kN]
_LUBRICATION = {  # k_1 and k_2 by full complement and grease
    (False, False): (1.5, 0.15),
    (False, True): (1.0, 0.1),
    (True, False): (1.0, 0.3),
    (True, True): (0.5, 0.15),
}
_BRIEF, _SHOCK = 2.0, 3.0  # times the constant limits: for 1000 revolutions, and for a peak

# Schaeffler: k_S by the supply, the least of each range, and 7.5 for kappa up to 0.5; k_B by full complement (SL18) and dimension series (design E).
_SUPPLY_FACTOR = {"oil_air": 7.5, "oil_bath": 10.0, "oil_jet": 12.0, "circulating": 12.0}
_THIN_OIL_FACTOR = 7.5
_SERIES_FACTOR = {
    False: {"2": 18.0, "22": 18.0, "3": 23.0, "23": 23.0},
    True: {"29": 11.0, "30": 17.0, "22": 20.0},
}
_NSK_SIZE = {"2": 0.75, "22": 0.75, "3": 1.0, "23": 1.0, "4": 1.2}  # k by dimension series


class EquivalentLoadLaw(NamedTuple):
    """P = F_r up to F_a = e F_r, X F_r + Y F_a above; `bearing_sim.model.params.Life` holds it for compiled code, which computes P, L10 and L_nm."""

    limit: float  # e; infinite where the axial load does not count
    radial_factor: float  # X
    axial_factor: float  # Y
    rule: str
    largest_ratio: float  # F_a over F_r up to which the rule is stated


def equivalent_load_law(bearing) -> EquivalentLoadLaw:
    """Return the law of the equivalent load of a `bearing_sim.scene.bearing.Bearing` under axial load, by ``bearing.ratings.axial_load``.

    ``skf`` and ``krw`` have factors by the dimension series.  ``none`` is the rule of NTN, who prints P = F_r whatever the flanges carry; Schaeffler
    prints no rule and computes that case by a program.
    """
    maker = bearing.ratings.axial_load
    if maker == "none":
        return EquivalentLoadLaw(math.inf, 1.0, 0.0, "P = F_r, the axial load left out (bearing.ratings.axial_load none)", _UNCOUNTED_RATIO)
    radial, by_series, others, largest = _FACTORS[maker]
    series = _series(bearing)
    limit, axial = by_series.get(series or _UNKNOWN_SERIES, others)
    assumed = "" if series else ", as of series 2, for want of a designation"
    return EquivalentLoadLaw(limit, radial, axial, f"{maker.upper()}: {radial:g} F_r + {axial:g} F_a above F_a/F_r = {limit:g}{assumed}", largest)


def results_without_rule(scene, radial_load: float) -> tuple[str, ...]:
    """Return the names of the results that have no value because the axial load is beyond the range of the law of the equivalent load.

    Parameters
    ----------
    scene : of the results.
    radial_load : F_r [N].
    """
    axial = abs(scene.operating.axial_load)
    if axial <= equivalent_load_law(scene.bearing).largest_ratio * radial_load * (1.0 + 1e-9):
        return ()
    by_method = ("rating_life", "modified_rating_life") if scene.life.method == "iso281" else ()
    return ("l10", "lnm", "equivalent_load", *by_method)


def _series(bearing) -> str | None:
    found = readable_designation(bearing.designation)
    return None if found is None else found.series


class AxialLimit(NamedTuple):
    """One limit of the axial load on flanges."""

    kind: str  # what limits it, or whose limit it is
    force: float  # [N]; NaN where the rule gives none
    reason: str  # why not


def axial_limits(scene, speed: float, radial_load: float, viscosity_ratio: float) -> tuple[AxialLimit, ...]:
    """Return what the flanges of a scene's bearing may carry, by SKF.

    By heat: F_ap = k_1 C_0 10^4/(n (d + D)) - k_2 F_r [kN, rpm, mm], with 7.5 C_0^(2/3) for C_0 where pi B (d + D) is above 50,000 mm^2; for kappa of
    2 or more, rings misaligned by 1' at most, and bearings some 60 K warmer than their surroundings.  What oil takes along when it flows through is
    left out.  By strength, all the time: 0.0045 D^1.5 in series 2, 0.0023 D^1.7 in the others [kN, mm]; three times the smaller of both for a shock,
    twice for 1000 revolutions.

    Parameters
    ----------
    scene : with flanges on both rings.
    speed : of the shaft [rad/s].
    radial_load : F_r [N].
    viscosity_ratio : kappa.
    """
    strength, heat = strength_limit(scene.bearing), float(heat_limits(scene, speed, radial_load, viscosity_ratio))
    constant = min(strength, heat) if math.isfinite(heat) else strength
    return (
        AxialLimit("by heat", heat, _why_not(scene, speed, viscosity_ratio) if math.isnan(heat) else ""),
        AxialLimit("by strength, all the time", strength, ""),
        AxialLimit("for 1,000 revolutions", _BRIEF * constant, ""),
        AxialLimit("as a shock", _SHOCK * constant, ""),
    )


def other_axial_limits(scene, speed: float, viscosity_ratio: float) -> tuple[AxialLimit, AxialLimit]:
    """Return what flanges may carry all the time by Schaeffler and by NSK, for comparison; neither takes the radial load.

    Schaeffler: F_a per = k_S k_B d_M^1.5 n^-0.6, at most 0.075 k_B d_M^2.1 [N, rpm, mm], with the least k_S of the kind of lubrication.
    NSK: 9.8 [490 (k d)^2/(n + 1000) - 0.000135 (k d)^3.4] with oil, 9.8 [900 (k d)^2/(n + 1500) - 0.023 (k d)^2.5] with grease [N, rpm, mm].

    Parameters
    ----------
    scene, speed, viscosity_ratio : as of `axial_limits`.
    """
    bearing, lubricant, series = scene.bearing, scene.lubricant, _series(scene.bearing)
    full, greased = bearing.cage.is_absent, lubricant.grease is not None
    mean, rpm = 500.0 * (bearing.bore_diameter + bearing.outside_diameter), abs(speed) * 30.0 / math.pi
    of_series, size = _SERIES_FACTOR[full].get(series), None if full else _NSK_SIZE.get(series)
    bore = math.nan if size is None else size * 1e3 * bearing.bore_diameter
    if greased:
        nsk = 9.8 * (900.0 * bore**2 / (rpm + 1500.0) - 0.023 * bore**2.5)
    else:
        nsk = 9.8 * (490.0 * bore**2 / (rpm + 1000.0) - 0.000135 * bore**3.4)
    unknown = "not stated for this series" if series else "not stated without a designation"
    if of_series is None or greased:
        schaeffler = AxialLimit("Schaeffler", math.nan, unknown if of_series is None else "not stated for grease")
    else:
        largest = 0.075 * of_series * mean**2.1
        supply = _THIN_OIL_FACTOR if viscosity_ratio <= 0.5 else _SUPPLY_FACTOR[lubricant.supply.law]
        schaeffler = AxialLimit("Schaeffler", min(largest, supply * of_series * mean**1.5 * rpm**-0.6) if rpm > 0.0 else largest, "")
    return schaeffler, AxialLimit("NSK", max(nsk, 0.0) if size else math.nan, "" if size else unknown)


def strength_limit(bearing) -> float:
    """Return the axial load that flanges may carry all the time by their strength [N]."""
    millimetres = 1e3 * bearing.outside_diameter
    return 4.5 * millimetres**1.5 if _series(bearing) == "2" else 2.3 * millimetres**1.7


def heat_limits(scene, speeds, radial_loads, viscosity_ratios) -> np.ndarray:
    """Return the axial loads that flanges may carry by their heat [N], NaN where SKF states none; parameters as of `axial_limits`, or arrays."""
    bearing = scene.bearing
    diameters = 1e3 * (bearing.bore_diameter + bearing.outside_diameter)
    rpm = np.abs(np.asarray(speeds, float)) * 30.0 / math.pi
    first, second = _LUBRICATION[bearing.cage.is_absent, scene.lubricant.grease is not None]
    static = rate(bearing).static
    if math.pi * bearing.boundary_width * (bearing.bore_diameter + bearing.outside_diameter) > _LARGE_SURFACE:
        static = 7.5e3 * (1e-3 * static) ** (2.0 / 3.0)
    with np.errstate(divide="ignore"):
        limits = np.maximum(first * static * 1e4 / (rpm * diameters) - second * np.asarray(radial_loads), 0.0)
    stated = (rpm > 0.0) & (np.asarray(viscosity_ratios) >= _LEAST_VISCOSITY_RATIO) & (abs(scene.operating.misalignment) <= _LARGEST_MISALIGNMENT)
    return np.where(stated, limits, math.nan)


def _why_not(scene, speed: float, viscosity_ratio: float) -> str:
    """Return why SKF states no limit by heat."""
    if speed == 0.0:
        return "none at rest"
    if not viscosity_ratio >= _LEAST_VISCOSITY_RATIO:
        return f"not stated for kappa {viscosity_ratio:.2g}, below {_LEAST_VISCOSITY_RATIO:g}"
    return f"not stated for a misalignment of {1e3 * abs(scene.operating.misalignment):.2g} mrad, above {1e3 * _LARGEST_MISALIGNMENT:.2g}"
