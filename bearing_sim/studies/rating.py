# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rating lives of a scene with everything that they follow from, side by side with the standards' symbols."""

import math
from collections.abc import Mapping

import numpy as np

from bearing_sim.messages.topics import ARRAYS, LIFE_SYMBOLS
from bearing_sim.model.films import films_of
from bearing_sim.model.running_clearance import clearance_at_speed
from bearing_sim.model.turning import turns
from bearing_sim.monitoring.film_ratio import ThinnestFilm
from bearing_sim.physics.rating_life import reliability_factor
from bearing_sim.scene.axial_load import axial_limits, equivalent_load_law, other_axial_limits, results_without_rule
from bearing_sim.scene.display import LONGEST_LIFE
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.sweep.point import LIVES
from bearing_sim.sweep.settling import mean_life

FACTORS = ARRAYS["life_factors"].fields


def loads_text(scene: Scene) -> str:
    """Return by which loads the life of a scene is rated, in words: those of rollers contain the preload of its raceways, if it has any."""
    bearing, loads = scene.bearing, scene.life.loads
    if scene.life.method == "iso281" and scene.operating.axial_load and bearing.ratings.axial_load != "none":
        return "the radial and the axial load on the bearing"
    if scene.life.method == "iso281" or clearance_at_speed(bearing, scene.mounting, scene.operating.shaft_speed) >= 0.0:
        return loads
    outer = bearing.outer_raceway
    lobed = outer.d_value > 0.0 or outer.contour is not None or bool(outer.low_points)
    return f"{loads} with the {'preload of the lobes' if lobed else 'preload'}"


def life_report(scene: Scene, samples: np.ndarray) -> dict:
    """Return lives, load ratings and life factors, means over samples: of the lives' rates, because damage adds up, of everything else itself.

    Parameters
    ----------
    scene : that was run.
    samples : of a settled bearing, shape (n,), see `bearing_sim.model.sample`.
    """
    lives, films = {name: mean_life(samples[name]) for name in LIVES}, ThinnestFilm(scene)
    film = np.where(turns(samples["shaft_speed"], 0.0), films.least(samples), np.nan)  # none at rest
    speed, load = float(np.abs(samples["shaft_speed"]).mean()), float(np.hypot(samples["load_y"], samples["load_z"]).mean())
    report = report_of(scene, lives | {name: float(np.mean(samples[name])) for name in FACTORS}, float(np.mean(film)), speed, load)
    return report | {"films": films_of(scene, samples[-1])._asdict() if math.isfinite(report["film_um"]) else None}


def report_of(scene: Scene, values: Mapping[str, float], film: float, speed: float | None = None, load: float | None = None) -> dict:
    """Return the report of given lives and factors.

    An axial load beyond the range of the makers' rule (`bearing_sim.scene.axial_load`) leaves no equivalent load and no life by it: they are NaN.

    Parameters
    ----------
    scene : whose ratings and choice of life stand in the report.
    values : by the names of `LIVES` [h] and `FACTORS` [SI].
    film : least film thickness [m], NaN without a film.
    speed, load : of the shaft [rad/s], and radial load [N]; None: those of the scene.
    """
    rated, roughness, operating = rate(scene.bearing), scene.bearing.roughness, scene.operating
    speed, load = abs(operating.shaft_speed) if speed is None else speed, operating.radial_load if load is None else load
    axial = _axial_report(scene, speed, load, values["viscosity_ratio"])
    values = {**values, **dict.fromkeys(results_without_rule(scene, load), math.nan)}
    return {
        "life_method": scene.life.method,
        "life_hours": _planned(values["rating_life"]),
        "modified_life_hours": _planned(values["modified_rating_life"]),
        **{f"{name}_hours": _planned(values[name]) for name in LIFE_SYMBOLS},
        **{name: values[name] for name in FACTORS},
        "a_iso": values["modified_rating_life"] / values["rating_life"] / reliability_factor(scene.life.reliability),
        "dynamic_rating": rated.dynamic,
        "static_rating": rated.static,
        "fatigue_limit": rated.fatigue_limit,
        **axial,
        "computed_ratings": {name: getattr(rated.computed, name) for name in ("dynamic", "static", "fatigue_limit")},
        "laminae": scene.life.laminae,
        "profile": scene.bearing.roller.profile.law,
        "profile_given": scene.bearing.roller.crown is not None,
        "film_um": 1e6 * film,
        "film_ratio": film / roughness.composite if roughness is not None else None,
    }


def _planned(life: float) -> float:
    """Return a life [h]; infinite above `LONGEST_LIFE`: hardly anything but the rollers' own weight loads the bearing then."""
    return math.inf if life > LONGEST_LIFE else life


def _axial_report(scene: Scene, speed: float, load: float, kappa: float) -> dict:
    """Return what the makers' rules say about the axial load, for JSON: forces in N, None where a rule gives none; empty without an axial load."""
    axial = abs(scene.operating.axial_load)
    if not axial:
        return {}

    def told(limits):
        return {each.kind: {"force": each.force, "reason": each.reason or None} for each in limits}

    limits = axial_limits(scene, speed, load, kappa)
    return {
        "axial_load_rule": equivalent_load_law(scene.bearing).rule,
        "axial_load_within_rule": not results_without_rule(scene, load),
        "axial_load_permitted": not any(each.force < axial for each in limits[:2]),
        "axial_load_limits": told(limits),
        "other_axial_load_limits": told(other_axial_limits(scene, speed, kappa)),
    }
