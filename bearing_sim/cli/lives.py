# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How commands show rating lives and what they follow from."""

import math

_PROFILES = {
    "none": "straight rollers",
    "iso_log": "ISO's logarithmic profile",
    "straight_arc": "the profile given, straight with arcs",
    "table": "the profile given",
}

_TEMPERATURES = {
    "shaft_temperature": "shaft",
    "inner_ring_temperature": "inner ring",
    "roller_temperature": "rollers",
    "outer_ring_temperature": "outer ring",
    "housing_temperature": "housing",
    "oil_outlet_temperature": "oil that leaves",
}
_CELSIUS = 273.15


def temperature_report(sample) -> dict[str, float]:
    """Return the temperatures in a sample that the scene's law of heat knows [degC]."""
    return {f"{name}_c": float(sample[name]) - _CELSIUS for name in _TEMPERATURES if not math.isnan(sample[name])}


def temperature_rows(report) -> list[tuple[str, str]]:
    """Return a row of a table from `temperature_report`; none where no temperature is known."""
    known = [f"{words} {report[f'{name}_c']:.1f}" for name, words in _TEMPERATURES.items() if f"{name}_c" in report]
    return [("temperatures", f"{', '.join(known)} degC")] if known else []


def life_rows(scene, report) -> list[tuple[str, str]]:
    """Return rows of a table from `bearing_sim.studies.rating.report_of`."""
    from bearing_sim.model.films import Films
    from bearing_sim.studies.rating import loads_text

    basic, modified = scene.life.symbols
    profile = _PROFILES[report["profile"]] + ("" if report["profile_given"] else ", assumed because roller.crown is not given")
    rows = [("rating life", f"{hours(report['life_hours'])}, {basic}, by {loads_text(scene)}{_of_catalogue(scene, report)}")]
    if not scene.life.is_basic:
        reliability = f"reliability {100 * scene.life.reliability:g} %{_oil(scene, report)}"
        rows.append(("modified rating life", f"{hours(report['modified_life_hours'])}, {modified}: {reliability}"))
    film = f"film {report['film_um']:.3g} um" if math.isfinite(report["film_um"]) else "no film"
    if report["film_ratio"] is not None:
        film += f", lambda {report['film_ratio']:.3g}"
    if report.get("films") and (text := Films(**report["films"]).text):
        film += f"; {text}"
    return [
        *rows,
        ("by ISO 281", f"L10 {hours(report['l10_hours'])}, L_nm {hours(report['lnm_hours'])}; P {report['equivalent_load']:.4g} N"),
        (
            "by ISO/TS 16281",
            f"L10r {hours(report['l10r_hours'])}, L_nmr {hours(report['lnmr_hours'])}; P_ref {report['reference_load']:.4g} N; "
            f"{report['laminae']} laminae, {profile}",
        ),
        ("load ratings", ", ".join(_rating(scene, report, *each) for each in _RATINGS) + f"; static safety S_0 {report['static_safety']:.3g}"),
        ("lubrication", f"kappa {report['viscosity_ratio']:.3g}, {film}" if report["viscosity_ratio"] else "no film, the shaft is at rest"),
    ]


def _of_catalogue(scene, report) -> str:
    """Return how the life by the loads of rollers relates to that of a catalogue; empty where either is unknown or infinite."""
    ratio = report["life_hours"] / report["l10_hours"] if report["l10_hours"] else math.nan
    if scene.life.method == "iso281" or not 0.0 < ratio < math.inf:
        return ""
    return f"; {float(f'{ratio:.2g}'):g} of the catalogue's L10 of {hours(report['l10_hours'])}, which counts the radial load alone"


_RATINGS = (("C", "dynamic", "dynamic_rating"), ("C_0", "static", "static_rating"), ("C_u", "fatigue_limit", "fatigue_limit"))


def _oil(scene, report) -> str:
    if scene.life.a_iso == "none":
        return ""
    if math.isnan(report["a_iso"]):
        return f", no a_ISO at rest ({scene.life.a_iso})"
    return f", a_ISO {report['a_iso']:.3g} (e_C {report['contamination_factor']:.3g}, {scene.life.a_iso})"


def _rating(scene, report, symbol, name, key) -> str:
    """Return a load rating in words; a maker's with the one by the standards."""
    shown = f"{symbol} {1e-3 * report[key]:.4g} kN"
    if getattr(scene.bearing.ratings, name) is None:
        return shown
    return f"{shown} (maker's; {1e-3 * report['computed_ratings'][name]:.4g} by the standard)"


def hours(life: float) -> str:
    """Return a life in words, to four digits."""
    if not math.isfinite(life):
        return "unknown" if math.isnan(life) else "infinite"
    return f"{float(f'{life:.4g}'):,.0f} h" if 1000.0 <= life < 1e9 else f"{life:.4g} h"
