# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How commands show rating lives and what they follow from."""

import math

_PROFILES = {
    "none": "straight rollers",
    "iso_log": "ISO's logarithmic profile",
    "straight_arc": "the profile given, straight with arcs",
    "table": "the profile given",
}


def life_rows(scene, report) -> list[tuple[str, str]]:
    """Return rows of a table from `bearing_sim.studies.rating.report_of`."""
    basic, modified = scene.life.symbols
    profile = _PROFILES[report["profile"]] + ("" if report["profile_given"] else ", assumed because roller.crown is not given")
    rows = [("rating life", f"{hours(report['life_hours'])}, {basic}, by {scene.life.loads}")]
    if not scene.life.is_basic:
        reliability = f"reliability {100 * scene.life.reliability:g} %{_oil(scene, report)}"
        rows.append(("modified rating life", f"{hours(report['modified_life_hours'])}, {modified}: {reliability}"))
    film = f"film {report['film_um']:.3g} um" if math.isfinite(report["film_um"]) else "no film"
    if report["film_ratio"] is not None:
        film += f", lambda {report['film_ratio']:.3g}"
    return [
        *rows,
        ("by ISO 281", f"L10 {hours(report['l10_hours'])}, L_nm {hours(report['lnm_hours'])}; P {report['equivalent_load']:.4g} N"),
        (
            "by ISO/TS 16281",
            f"L10r {hours(report['l10r_hours'])}, L_nmr {hours(report['lnmr_hours'])}; P_ref {report['reference_load']:.4g} N; "
            f"{report['laminae']} laminae, {profile}",
        ),
        ("load ratings", ", ".join(_rating(scene, report, *each) for each in _RATINGS) + f"; static safety S_0 {report['static_safety']:.3g}"),
        ("lubrication", f"kappa {report['viscosity_ratio']:.3g}, {film}"),
    ]


_RATINGS = (("C", "dynamic", "dynamic_rating"), ("C_0", "static", "static_rating"), ("C_u", "fatigue_limit", "fatigue_limit"))


def _oil(scene, report) -> str:
    if scene.life.a_iso == "none":
        return ""
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
