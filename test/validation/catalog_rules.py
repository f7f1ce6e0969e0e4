# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rules for what makers do not print: fitted to the bearings whose rollers are known, and judged on bearings held back from the fit.

Known are the rollers of sections of which two widths share their raceways (``catalog/designations/rollers.csv``): their diameter is (E - F)/2,
their number the one for which the printed static ratings of both widths give round lengths.  Three of these numbers are also published.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.designation import MakersRow, RollerCount, boundaries, makers_rows, roller_counts
from bearing_sim.scene.internal_dimensions import (
    DesignRules,
    count_by_gap,
    diameter_by_flange,
    is_high_capacity,
    length_by_static_rating,
    printed_outer_raceway,
)
from bearing_sim.scene.ratings import load_rating

HELD_BACK = 4  # every fourth section is held back from the fit
_RATED_BY = "Koyo"  # whose ratings are those of ISO 281 and ISO 76, without a factor of the maker's


class Fit(NamedTuple):
    """Coefficients of the rules for one design, see `bearing_sim.scene.internal_dimensions.DesignRules`."""

    gap: float
    gap_ratio: float
    outer_flange: float
    inner_flange: float
    length_ratio: float
    sections: int  # to which the gap was fitted


class Estimate(NamedTuple):
    """One bearing that was held back: what the rules give for it against what is known.

    Attributes
    ----------
    name : series and bore, such as ``2/50``.
    count, count_error : Z, and rule less known.
    diameter_error, length_error : of D_w and effective length, relative; NaN for D_w where the flange is not printed.
    rating_error : of C_r by ISO 281 with the estimated rollers against the maker's C, relative.
    known_rating_error : of C_r with the known rollers against the maker's C, relative.
    """

    name: str
    count: int
    count_error: int
    diameter_error: float
    length_error: float
    rating_error: float
    known_rating_error: float


def fitted(high_capacity: bool, sections: Sequence[RollerCount]) -> Fit:
    """Return the rules of one design, fitted to sections of known rollers.

    The gap between neighbours, relative to D_w, is a straight line of 1/D_w; heights of flanges and lengths are medians, flanges over all
    bearings of the design but those of its other sections.
    """
    diameters = np.array([_diameter(each) for each in sections])
    gaps = np.array([_pitch(each) * math.sin(math.pi / each.count) for each in sections]) - diameters
    (gap, ratio), *_ = np.linalg.lstsq(np.stack([1.0 / diameters, np.ones_like(diameters)], axis=-1), gaps / diameters, rcond=None)
    names = {f"{series}/{round(1e3 * each.bore)}" for each in sections_of(high_capacity) if each not in sections for series in each.series}
    flanged = [each for each in flanged_rows(high_capacity) if each.name not in names]
    outer, inner = (float(np.nanmedian(heights)) for heights in zip(*((each.outer_height, each.inner_height) for each in flanged)))
    ratios = [length / boundaries()[series, round(1e3 * each.bore)].width for each in sections for series, length in zip(each.series, each.lengths)]
    return Fit(float(gap), float(ratio), outer, inner, float(np.median(ratios)), len(sections))


def _diameter(section: RollerCount) -> float:
    return 0.5 * (section.outer_raceway - section.inner_raceway)


def _pitch(section: RollerCount) -> float:
    return 0.5 * (section.outer_raceway + section.inner_raceway)


class FlangedRow(NamedTuple):
    """A bearing of which raceways and outer flange are printed: D_w = (E - F)/2, and heights of the flanges over D_w (NaN if not printed)."""

    name: str
    row: MakersRow
    diameter: float
    outer_height: float
    inner_height: float


def flanged_rows(high_capacity: bool) -> list[FlangedRow]:
    """Return the bearings of one design of which raceways and flanges are printed, one for each maker, series and bore."""
    found = []
    for (series, bore, full), rows in makers_rows().items():
        for row in rows:
            raceway = None if full or row.outer_flange is None else printed_outer_raceway(series, bore, row)
            if raceway is None or is_high_capacity(row) != high_capacity:
                continue
            diameter = 0.5 * (raceway - row.inner_raceway)
            inner = math.nan if row.inner_flange is None else 0.5 * (row.inner_flange - row.inner_raceway) / diameter
            found.append(FlangedRow(f"{series}/{bore}", row, diameter, 0.5 * (raceway - row.outer_flange) / diameter, inner))
    return found


def diameter_errors(high_capacity: bool) -> list[float]:
    """Return the relative errors of D_w by the outer flange, with the flanges' height from all bearings of other sections."""
    flanged = flanged_rows(high_capacity)
    errors = []
    for each in flanged:
        height = float(np.median([other.outer_height for other in flanged if other.name != each.name]))
        guessed = diameter_by_flange(DesignRules(0.0, 0.0, height, 0.0, 0, 0.0), each.row)
        errors.append(guessed / each.diameter - 1.0)
    return errors


def sections_of(high_capacity: bool) -> tuple[RollerCount, ...]:
    """Return the sections of one design whose rollers are known without the rules."""
    return tuple(each for each in roller_counts() if each.unique and each.high_capacity == high_capacity)


def held_back(high_capacity: bool) -> list[Estimate]:
    """Return the errors of the rules on every fourth section, which the fit then does not see."""
    sections = sections_of(high_capacity)
    kept = [each for place, each in enumerate(sections) if place % HELD_BACK]
    rules = _rules(fitted(high_capacity, kept))
    return [found for each in sections[::HELD_BACK] for found in estimates(each, rules)]


def left_out(high_capacity: bool) -> list[Estimate]:
    """Return the errors of the rules on each section, with rules that were fitted to all others."""
    sections = sections_of(high_capacity)
    found = []
    for each in sections:
        found += estimates(each, _rules(fitted(high_capacity, [other for other in sections if other is not each])))
    return found


def _rules(fit: Fit) -> DesignRules:
    return DesignRules(fit.gap, fit.gap_ratio, fit.outer_flange, fit.inner_flange, 0, fit.length_ratio)


def estimates(section: RollerCount, rules: DesignRules) -> list[Estimate]:
    """Return the errors for both widths of a section, from F, the flange of the outer ring, and the static rating.

    The diameter is that of the rule for flanges where a flange is printed, otherwise the known one.
    """
    bore, found = round(1e3 * section.bore), []
    for series, length in zip(section.series, section.lengths):
        rows = makers_rows().get((series, bore, False), ())
        rated = next((row for row in rows if row.maker == _RATED_BY and is_high_capacity(row) == section.high_capacity), None)
        flanged = next((row for row in rows if row.outer_flange and _is_of(row, section)), None)
        known, pitch = _diameter(section), _pitch(section)
        guessed = known if flanged is None else diameter_by_flange(rules, flanged)
        around = section.inner_raceway + guessed
        count = count_by_gap(rules, guessed, around)
        static = rated.ratings.static if rated is not None else _static(section, length)
        own = length_by_static_rating(static, count, guessed, around)
        dynamic = rated.ratings.dynamic if rated is not None else math.nan
        found.append(
            Estimate(
                f"{series}/{bore}",
                section.count,
                count - section.count,
                math.nan if flanged is None else guessed / known - 1.0,
                own / length - 1.0,
                load_rating(count, guessed, own, guessed / around) / dynamic - 1.0,
                load_rating(section.count, known, length, known / pitch) / dynamic - 1.0,
            )
        )
    return found


def _is_of(row: MakersRow, section: RollerCount) -> bool:
    same = row.inner_raceway is not None and abs(row.inner_raceway - section.inner_raceway) < 1e-6
    return same and is_high_capacity(row) == section.high_capacity


def _static(section: RollerCount, length: float) -> float:
    diameter = _diameter(section)
    return 44e6 * (1.0 - diameter / _pitch(section)) * section.count * length * diameter


class Summary(NamedTuple):
    """Errors of one quantity: median of their sizes, the 95 % quantile, the largest, and how many there are."""

    median: float
    p95: float
    largest: float
    number: int


def summary(errors: Iterable[float]) -> Summary:
    """Return the sizes of errors; NaN is left out."""
    sizes = np.abs(np.array(list(errors), float))
    sizes = sizes[np.isfinite(sizes)]
    if not len(sizes):
        return Summary(math.nan, math.nan, math.nan, 0)
    return Summary(float(np.median(sizes)), float(np.quantile(sizes, 0.95)), float(sizes.max()), len(sizes))


def printed_rating_ratios(maker: str) -> dict[str, float]:
    """Return C_r by ISO 281 over the C that a maker prints, by series and bore, of bearings whose number of rollers is known.

    The effective length follows from the same maker's C_0 by ISO 76.
    """
    found = {}
    for section in roller_counts():
        for series in section.series:
            bore, diameter, pitch = round(1e3 * section.bore), _diameter(section), _pitch(section)
            for row in makers_rows().get((series, bore, False), ()):
                if row.maker != maker or not _is_of(row, section):
                    continue
                length = length_by_static_rating(row.ratings.static, section.count, diameter, pitch)
                found[f"{series}/{bore}"] = load_rating(section.count, diameter, length, diameter / pitch) / row.ratings.dynamic
    return found


def report() -> dict:
    """Return rules, their errors on bearings held back, and C_r against what makers print, as plain numbers."""
    found = {}
    for name, high_capacity in (("high_capacity", True), ("standard", False)):
        fit, apart, each = fitted(high_capacity, sections_of(high_capacity)), held_back(high_capacity), left_out(high_capacity)
        found[name] = {
            "rules": fit._asdict(),
            "held_back": _errors_report(apart),
            "left_out": _errors_report(each),
            "diameter_by_flange": {**summary(errors := diameter_errors(high_capacity))._asdict(), "exact": _exact(errors)},
        }
    ratings = {}
    for maker in ("Koyo", "SKF", "NKE"):
        ratios = np.array(list(printed_rating_ratios(maker).values()))
        ratings[maker] = {
            "number": len(ratios),
            **{word: float(value) for word, value in zip(("least", "median", "largest"), np.quantile(ratios, (0.0, 0.5, 1.0)))},
        }
    return {**found, "computed_over_printed": ratings}


def _errors_report(found: Sequence[Estimate]) -> dict:
    return {
        "bearings": len(found),
        "count": {**summary(each.count_error for each in found)._asdict(), "exact": _exact(each.count_error for each in found)},
        "diameter": summary(each.diameter_error for each in found)._asdict(),
        "length": summary(each.length_error for each in found)._asdict(),
        "dynamic_rating": summary(each.rating_error for each in found)._asdict(),
    }


def _exact(errors: Iterable[float]) -> float:
    """Return the fraction of errors that are nothing but round-off."""
    return float(np.mean(np.abs(np.array(list(errors), float)) < 1e-9))
