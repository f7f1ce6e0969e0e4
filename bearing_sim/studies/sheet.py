# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The answer sheet of a bearing under one condition, in the order in which an engineer looks: for `run`, for reports, and as numbers for JSON."""

import math
from collections.abc import Mapping

import numpy as np

from bearing_sim.messages.topics import ARRAYS, LIFE_SYMBOLS
from bearing_sim.model.characteristic_frequencies import frequencies_text, mean_frequencies
from bearing_sim.model.films import Films, films_of
from bearing_sim.model.losses import loss_report, loss_text, power_loss
from bearing_sim.model.oil import kinematic_viscosities, oil_at, specific_heat
from bearing_sim.model.params import pack
from bearing_sim.model.plausibility import minimum_load
from bearing_sim.model.running_clearance import clearance_at_speed
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.model.temperatures import film_temperatures
from bearing_sim.model.thermal_network import oil_flow
from bearing_sim.model.turning import turns
from bearing_sim.physics.contact import EXPONENT
from bearing_sim.physics.lamina_life import penetration_of
from bearing_sim.physics.rating_life import reliability_factor, viscosity_ratio
from bearing_sim.scene.axial_load import axial_limits, equivalent_load_law, other_axial_limits, results_without_rule
from bearing_sim.scene.display import LONGEST_LIFE, RPM, ZERO_CELSIUS, force, hours, number, power, quantity_text, with_sign
from bearing_sim.scene.grease_life import relubrication_interval
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.studies.friction import makers_moment
from bearing_sim.sweep.point import LIVES
from bearing_sim.sweep.settling import mean_life
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm

CLEARANCES = ARRAYS["running_clearance"].fields
"""The running clearance, then its parts (see `bearing_sim.model.sample`)."""

FACTORS = ARRAYS["life_factors"].fields

Row = tuple[str, str]

_PARTS = dict(zip(NODE_OBSERVABLES, ("shaft", "inner ring", "rollers", "outer ring", "housing", "oil that leaves")))
_PROFILES = {
    "none": "straight rollers",
    "iso_log": "ISO's logarithmic profile",
    "straight_arc": "the profile given, straight with arcs",
    "table": "the profile given",
}
_RATINGS = (("C", "dynamic", "dynamic_rating"), ("C_0", "static", "static_rating"), ("C_u", "fatigue_limit", "fatigue_limit"))
_SUPPLIES = {"oil_jet": "oil jet", "circulating": "circulating oil", "oil_bath": "oil bath", "oil_air": "oil-air", "grease": "grease"}


def results(scene: Scene, window: np.ndarray) -> dict:
    """Return the numbers of the sheet by name, for JSON: means over settled samples, of lives by their damage, and the largest loads and pressures.

    Parameters
    ----------
    scene : that was run.
    window : settled samples, shape (n,), see `bearing_sim.model.sample`.
    """
    last, slip = window[-1], window["cage_slip"]
    radial_load, viscosities = float(np.hypot(window["load_y"], window["load_z"]).mean()), _viscosities(scene, last)
    return {
        "scene": scene.name,
        "level": scene.level,
        "estimated": [each.field for each in scene.bearing.estimated],
        "shaft_speed_rpm": RPM * float(window["shaft_speed"].mean()),
        "radial_load": radial_load,
        "axial_load": scene.operating.axial_load,
        "oil_temperature_c": float(window["oil_temperature"].mean()) - ZERO_CELSIUS,
        "cage_slip": float(slip.mean()),
        "cage_slip_minimum": float(slip.min()),
        "cage_slip_maximum": float(slip.max()),
        **clearance_report(scene, window),
        **temperatures(last),
        **_heat(scene, window),
        **life_report(scene, window),
        **viscosities,
        "damage": float(last["damage"]),
        "cage_speed_rpm": RPM * float(window["cage_speed"].mean()),
        "characteristic_frequencies_hz": mean_frequencies(window),
        **loss_report(window),
        "inner_load_maximum": float(window["inner_load_maximum"].max()),
        "outer_load_maximum": float(window["outer_load_maximum"].max()),
        **_pressures(scene, window),
        **_limits(scene, window, radial_load, 1e-6 * viscosities["viscosity_mm2_s"]),
    }


def temperatures(sample: np.void) -> dict[str, float]:
    """Return the temperatures in a sample that the scene's law of heat knows [degC]."""
    return {f"{name}_c": float(sample[name]) - ZERO_CELSIUS for name in _PARTS if not math.isnan(sample[name])}


def _heat(scene: Scene, window: np.ndarray) -> dict[str, float]:
    """Return where the heat of a thermal network goes [W]; before its first step, in equilibrium, the losses tell."""
    last = window[-1]
    if scene.heat.law != "network":
        return {}
    if not math.isnan(last["heat_to_oil"]):
        return {"heat_to_oil_w": float(last["heat_to_oil"]), "heat_to_ambient_w": float(last["heat_to_ambient"])}
    inlet, leaves = float(last["oil_temperature"]), float(last["oil_outlet_temperature"])
    conductance = scene.heat.conductances.oil_flow
    if conductance is None:
        oil = scene.lubricant.oil
        conductance = oil_flow(scene) * oil_at(oil, inlet).density * specific_heat(oil, 0.5 * (inlet + leaves))
    to_oil = conductance * (leaves - inlet)
    return {"heat_to_oil_w": to_oil, "heat_to_ambient_w": power_loss(window) - to_oil}


def _viscosities(scene: Scene, sample: np.void) -> dict[str, float]:
    """Return nu in the films and nu_1 of ISO 281 [mm^2/s]; NaN at rest."""
    viscosity = float(kinematic_viscosities(scene.lubricant.oil, np.atleast_1d(0.5 * sum(film_temperatures(sample))))[0])
    of_unit = viscosity_ratio(1e-6, float(sample["shaft_speed"]), scene.bearing.pitch_diameter)
    return {"viscosity_mm2_s": 1e6 * viscosity, "rated_viscosity_mm2_s": 1.0 / of_unit if of_unit > 0.0 else math.nan}


def _pressures(scene: Scene, window: np.ndarray) -> dict[str, float]:
    """Return the largest Hertz pressure and that at the ends of rollers [MPa] on both raceways: of tilted rollers where the level has them."""
    found, params = {}, None if scene.bodies_tilt else pack(scene)
    for ring in ("inner", "outer"):
        pressures = [float(window[f"{ring}_{kind}"].max()) for kind in ("pressure", "edge_pressure")]
        if params is not None:
            pressures = aligned_pressures(float(window[f"{ring}_load_maximum"].max()), ring, params)
        found |= {f"{ring}_{kind}_maximum_mpa": 1e-6 * value for kind, value in zip(("pressure", "edge_pressure"), pressures)}
    return found


def aligned_pressures(load: float, ring: str, params) -> tuple[float, float]:
    """Return the largest Hertz pressure of any lamina of an aligned roller, and that of its end laminae [Pa].

    Each lamina carries K/N (delta - C_k)^(10/9) (ISO/TS 16281) and presses as a line contact, p = (q E'/(2 pi R))^(1/2).

    Parameters
    ----------
    load : of the roller [N].
    ring : ``inner`` or ``outer``.
    params : `bearing_sim.model.params.Params`.
    """
    laminae, raceways = params.life.laminae, params.raceways
    radius = raceways.inner_curvature_radius if ring == "inner" else raceways.outer_curvature_radius
    uncompiled = getattr(penetration_of, "py_func", penetration_of)
    depth, carried = uncompiled(load, laminae)
    loads = laminae.stiffness * np.maximum(depth - laminae.crown, 0.0) ** EXPONENT * (load / carried if load > 0.0 else 0.0)
    per_length = loads * len(loads) / params.rollers.length
    pressures = np.sqrt(per_length * raceways.reduced_modulus / (2.0 * math.pi * radius))
    return float(pressures.max()), float(max(pressures[0], pressures[-1]))


def _limits(scene: Scene, window: np.ndarray, load: float, viscosity: float) -> dict:
    """Return the minimum load [N] and the makers' moments [N m], None where there is none; with grease the relubrication interval [h].

    Parameters
    ----------
    scene, window : as of `results`.
    load : radial [N].
    viscosity : kinematic, in the films [m^2/s].
    """
    speed, sample = float(np.abs(window["shaft_speed"]).mean()), window[-1]
    least, rule = minimum_load(scene, speed)
    makers = makers_moment(scene, speed, load, viscosity, scene.operating.axial_load)
    found = {"minimum_load": float(least), "minimum_load_rule": rule}
    found |= {"makers_moment": makers.skf, "simple_makers_moment": makers.simple, "no_makers_moment": makers.reason}
    if scene.lubricant.grease is not None:
        known = sample["outer_ring_temperature"]
        ring = float(sample["oil_temperature"] if math.isnan(known) else known)
        found["relubrication_interval_hours"] = relubrication_interval(scene, speed, ring).hours
    return found


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

    def described(limits):
        return {each.kind: {"force": each.force, "reason": each.reason or None} for each in limits}

    limits = axial_limits(scene, speed, load, kappa)
    return {
        "axial_load_rule": equivalent_load_law(scene.bearing).rule,
        "axial_load_within_rule": not results_without_rule(scene, load),
        "axial_load_permitted": not any(each.force < axial for each in limits[:2]),
        "axial_load_limits": described(limits),
        "other_axial_load_limits": described(other_axial_limits(scene, speed, kappa)),
    }


def clearance_report(scene: Scene, samples: np.ndarray) -> dict:
    """Return the running clearance and its parts [um], means over samples of shape (n,), and what the dimensions are."""
    return {"dimensions_at": scene.bearing.dimensions_at, **{f"{name}_um": 1e6 * float(np.mean(samples[name])) for name in CLEARANCES}}


def clearance_text(scene: Scene, report: Mapping) -> str:
    """Return the running clearance with its parts in words, from `clearance_report`."""
    shown = {name.removesuffix("_clearance"): report[f"{name}_um"] for name in CLEARANCES}
    running, text = shown.pop("running"), ""
    for part in ("contour", "bending"):
        if not shown[part]:
            del shown[part]
    if scene.bearing.dimensions_at == "running":
        del shown["fit"], shown["rotation"], shown["heat"]
        text = "; the dimensions are those of the running bearing: fits, rotation and heat change nothing"
    parts = ", ".join(f"{name} {_signed(value)}" for name, value in shown.items())
    side = "preload" if running < 0.0 else "play"
    return f"{_signed(running)} µm ({side}): {parts}{text or _unsaid(scene)}"


def _signed(micrometres: float) -> str:
    return with_sign(round(micrometres, 2))


def _unsaid(scene: Scene) -> str:
    """Return what a cold bearing's scene leaves open."""
    missing = [name for name in ("shaft", "housing") if (seat := getattr(scene.mounting, name)).fit is None and seat.interference is None]
    unsaid = f"; no fit of the {' and the '.join(missing)} is given" if missing else ""
    return unsaid + ("; all temperatures are taken as the oil's" if scene.heat.law == "none" else "")


# Rows


def sheet(scene: Scene, found: Mapping, states: list[Row] = ()) -> list[list[Row]]:
    """Return the rows of the sheet in groups, from `results`.

    Parameters
    ----------
    scene : that was run.
    found : see `results`.
    states : rows about other states of the cage, see `bearing_sim.sweep.states.state_rows`.
    """
    return [
        _bearing_rows(scene, found),
        _condition_rows(scene, found),
        [*life_rows(scene, found), *axial_rows(scene, found)],
        _strength_rows(scene, found),
        _lubrication_rows(scene, found),
        _limit_rows(scene, found),
        _friction_rows(scene, found),
        _clearance_rows(scene, found),
        _slip_rows(scene, found, states),
    ]


def _bearing_rows(scene: Scene, found: Mapping) -> list[Row]:
    bearing, roller = scene.bearing, scene.bearing.roller
    guessed = {each.field for each in bearing.estimated} | {
        name
        for name, given in (
            ("bore", bearing.inner_raceway.bore_radius),
            ("outside", bearing.outer_raceway.outside_radius),
            ("width", bearing.width),
        )
        if given is None
    }

    def mm(length, field):
        return f"{number(1e3 * length, 3 if field in guessed else 5)}{' (estimated)' if field in guessed else ''}"

    sizes = f"d {mm(bearing.bore_diameter, 'bore')}, D {mm(bearing.outside_diameter, 'outside')}, B {mm(bearing.boundary_width, 'width')} mm"
    count = f"{roller.count}{' (estimated)' if 'roller.count' in guessed else ''}"
    rollers = f"{count} rollers of {mm(roller.diameter, 'roller.diameter')} x {mm(roller.length, 'roller.length')} mm"
    return [
        ("bearing", f"{bearing.designation or bearing.name}: {sizes}; {rollers}"),
        ("load ratings", ", ".join(_rating(scene, found, *each) for each in _RATINGS)),
    ]


def _rating(scene: Scene, found: Mapping, symbol: str, name: str, key: str) -> str:
    """Return a load rating in words; a maker's with the one by the standards."""
    shown = f"{symbol} {force(found[key])}"
    if getattr(scene.bearing.ratings, name) is None:
        return shown
    return f"{shown} (maker's; {force(found['computed_ratings'][name])} by the standard)"


def _condition_rows(scene: Scene, found: Mapping) -> list[Row]:
    lubricant, load = scene.lubricant, found["radial_load"]
    loads = f"{force(load)} radial" + (f", C/P {number(found['dynamic_rating'] / found['equivalent_load'], 3)}" if found["equivalent_load"] else "")
    if found["axial_load"]:
        loads += f"; {force(abs(found['axial_load']))} axial"
    supply = "" if lubricant.supply.law == "grease" else f", {_SUPPLIES[lubricant.supply.law]}"
    oil = f"{lubricant.oil.name}{' in grease' if lubricant.grease is not None else ''}{supply}"
    rows = [("speed and load", f"{number(abs(found['shaft_speed_rpm']), 6)} rpm; {loads}"), ("lubricant", oil), _temperature_row(scene, found)]
    if "heat_to_oil_w" in found:
        away = f"{power(found['heat_to_oil_w'])} to the oil that flows through, {power(found['heat_to_ambient_w'])} through housing and shaft"
        rows.append(("heat", away))
    return rows


def _temperature_row(scene: Scene, found: Mapping) -> Row:
    """Return the row of the temperatures, and where they come from."""
    known = temperatures_text(found)
    if not known:
        return "temperatures", f"{number(round(found['oil_temperature_c'], 2), 3)} °C, given for the oil and taken for all parts"
    return "temperatures", f"{known}, {'computed from the losses' if scene.heat.law == 'network' else 'given'}"


def temperatures_text(found: Mapping) -> str:
    """Return the temperatures that `temperatures` knows, in words; empty where it knows none."""
    known = ", ".join(f"{words} {found[f'{name}_c']:.1f}" for name, words in _PARTS.items() if f"{name}_c" in found)
    return f"{known} °C" if known else ""


def life_rows(scene: Scene, found: Mapping) -> list[Row]:
    """Return the lives: the one that counts with its reason first, then those by both standards."""
    basic, modified = scene.life.symbols
    profile = _PROFILES[found["profile"]] + ("" if found["profile_given"] else ", assumed because roller.crown is not given")
    if scene.life.is_basic:
        headline, reason = found["life_hours"], f"{basic}, by {loads_text(scene)}"
    else:
        headline = found["modified_life_hours"]
        reason = f"{modified}, by {loads_text(scene)}; reliability {100 * scene.life.reliability:g} %{_oil(scene, found)}"
    return [
        ("life", f"{hours(headline)}: {reason}{_of_catalogue(scene, found, headline)}"),
        ("by ISO 281", f"L10 {hours(found['l10_hours'])}, L_nm {hours(found['lnm_hours'])}; P {force(found['equivalent_load'])}"),
        (
            "by ISO/TS 16281",
            f"L10r {hours(found['l10r_hours'])}, L_nmr {hours(found['lnmr_hours'])}; P_ref {force(found['reference_load'])}; "
            f"{found['laminae']} laminae, {profile}",
        ),
    ]


def _of_catalogue(scene: Scene, found: Mapping, headline: float) -> str:
    """Return how the headline relates to the life of a catalogue; empty where either is unknown or infinite."""
    other, symbol = (found["l10_hours"], "L10") if scene.life.is_basic else (found["lnm_hours"], "L_nm")
    ratio = headline / other if other else math.nan
    if scene.life.method == "iso281" or not 0.0 < ratio < math.inf:
        return ""
    return f"; {number(ratio, 2)} of the catalogue's {symbol}, {hours(other)}, which counts the load on the bearing alone"


def _oil(scene: Scene, found: Mapping) -> str:
    if scene.life.a_iso == "none":
        return ""
    if math.isnan(found["a_iso"]):
        return f", no a_ISO {'without P' if found['viscosity_ratio'] else 'at rest'} ({scene.life.a_iso})"
    return f", a_ISO {number(found['a_iso'], 3)} (e_C {number(found['contamination_factor'], 3)}, {scene.life.a_iso})"


def axial_rows(scene: Scene, found: Mapping) -> list[Row]:
    """Return what the makers' rules say about the axial load; nothing without one."""
    axial, radial = abs(found["axial_load"]), found["radial_load"]
    if not axial:
        return []
    law = equivalent_load_law(scene.bearing)
    if not found["axial_load_within_rule"]:
        counted = f"no P: F_a/F_r {number(axial / radial if radial else math.inf, 2)} is beyond the makers' rule, which goes to {law.largest_ratio:g}"
    elif axial <= law.limit * radial:
        counted = f"does not count in P: F_a/F_r {number(axial / radial, 2)} is not above {number(law.limit, 2)}" if law.axial_factor else law.rule
    else:
        counted = f"P {force(found['equivalent_load'])} by {law.rule}"
    of_laminae = (
        "L10r counts the moment of the axial load on the rollers"
        if scene.bodies_tilt
        else "L10r counts the radial load alone; level spatial counts the moment of the axial load"
    )

    def said(kind, limit):
        return f"{kind} {force(limit['force'], 3) if math.isfinite(limit['force']) else limit['reason']}"

    permitted = "; ".join(said(*each) for each in found["axial_load_limits"].items())
    others = ", ".join(
        f"{said(kind, limit)}{' (exceeded)' if limit['force'] < axial else ''}" for kind, limit in found["other_axial_load_limits"].items()
    )
    return [
        ("axial load", f"{force(axial)}: {counted}; {of_laminae}"),
        ("flanges may carry", f"{permitted} (SKF): {'met' if found['axial_load_permitted'] else 'EXCEEDED'}; all the time by {others}"),
    ]


def _strength_rows(scene: Scene, found: Mapping) -> list[Row]:
    def of(ring):
        whole, edge = found[f"{ring}_pressure_maximum_mpa"], found[f"{ring}_edge_pressure_maximum_mpa"]
        return f"{ring} raceway {number(whole)} MPa, at the ends of the rollers {number(edge) if edge else 'none'}"

    tilt = "" if scene.bodies_tilt else "; rollers aligned: level spatial counts their tilt"
    return [
        ("static safety", f"S_0 {number(found['static_safety'], 3)}"),
        ("largest pressure", f"{of('inner')}; {of('outer')}{tilt}"),
        ("largest roller load", f"inner raceway {force(found['inner_load_maximum'])}, outer raceway {force(found['outer_load_maximum'])}"),
    ]


def _lubrication_rows(scene: Scene, found: Mapping) -> list[Row]:
    if not found["viscosity_ratio"]:
        return [("lubrication", "no film, the shaft is at rest")]
    film = quantity_text("film", 1e-6 * found["film_um"]) if math.isfinite(found["film_um"]) else "none"
    text = f"kappa {number(found['viscosity_ratio'], 3)}: nu {number(found['viscosity_mm2_s'], 3)} mm²/s"
    text += f" in the films, nu_1 {number(found['rated_viscosity_mm2_s'], 3)}; least film {film}"
    if found["film_ratio"] is not None:
        text += f", lambda {number(found['film_ratio'], 3)}"
    if found.get("films") and (more := Films(**found["films"]).text):
        text += f"; {more}"
    rows = [("lubrication", text)]
    if "relubrication_interval_hours" in found:
        interval = found["relubrication_interval_hours"]
        known = f"relubricate after {hours(interval, 2)}" if interval > 0.0 else "no interval: too fast for grease"
        rows.append(("grease", f"{known} (5 (14e6/(n √d) - 4 d) h, halved by 15 K above 70 °C); within a factor of 2"))
    return rows


def _limit_rows(scene: Scene, found: Mapping) -> list[Row]:
    ratings, speed = scene.bearing.ratings, abs(found["shaft_speed_rpm"])
    limits = [
        f"{number(100.0 * speed / (RPM * value), 3)} % of the {word} speed, {number(RPM * value, 5)} rpm"
        for word, value in (("reference", ratings.reference_speed), ("limiting", ratings.limiting_speed))
        if value is not None
    ]
    load, least = found["radial_load"], found["minimum_load"]
    met = "met" if load >= least else "NOT met"
    return [
        ("speed limits", ", ".join(limits) or "no maker's speeds are known (bearing.ratings)"),
        ("minimum load", f"{met}: {force(load)}, minimum {force(least, 3)} by {found['minimum_load_rule']}"),
    ]


def _friction_rows(scene: Scene, found: Mapping) -> list[Row]:
    rows = [("friction", loss_text(found))]
    own = found["friction_moment"] - found["seals_loss"] / max(abs(found["shaft_speed_rpm"]) / RPM, 1e-300)
    if found["makers_moment"] is None or math.isnan(own):
        return rows
    known = [f"{number(found['makers_moment'])} N m by SKF's model, {number(own / found['makers_moment'], 2)} of it here"]
    if found["simple_makers_moment"] is not None:
        known.append(f"{number(found['simple_makers_moment'])} N m by M_0 + M_1")
    return [*rows, ("makers' moment", f"{'; '.join(known)}; without seals")]


def _clearance_rows(scene: Scene, found: Mapping) -> list[Row]:
    rows = [("running clearance", clearance_text(scene, found))]
    if note := ring_difference(scene, found):
        rows.append(("rings", note))
    return rows


def ring_difference(scene: Scene, found: Mapping) -> str:
    """Return how much warmer the inner ring is than the outer, and what is unsafe about it; empty where the scene does not compute it."""
    if scene.heat.law != "network" or scene.bearing.dimensions_at == "running":
        return ""
    warmer = found["inner_ring_temperature_c"] - found["outer_ring_temperature_c"]
    said = f"inner ring {number(abs(warmer), 2)} K {'warmer' if warmer >= 0.0 else 'colder'} than the outer"
    shaft = scene.heat.shaft
    if warmer >= 0.0 or shaft.front_temperature is not None or shaft.back_temperature is not None:
        return said
    per_kelvin = 1e6 * scene.bearing.material.expansion * 2.0 * scene.bearing.outer_raceway.low_radius
    return (
        f"{said}, because the shaft only cools it here. A heated shaft reverses this: each kelvin takes {number(per_kelvin, 2)} µm off the "
        "clearance. Specify what the shaft is connected to (new --shaft motor, heat.shaft.back_temperature)"
    )


def _slip_rows(scene: Scene, found: Mapping, states: list[Row]) -> list[Row]:
    if math.isnan(found["cage_slip"]):
        return [("cage slip", "none, the shaft is at rest"), *states]
    return [
        ("cage slip", _slip(found) + _margin(scene, found)),
        *states,
        ("cage speed", f"{number(abs(found['cage_speed_rpm']), 6)} rpm"),
        ("characteristic frequencies", frequencies_text(found["characteristic_frequencies_hz"])),
    ]


def _slip(found: Mapping) -> str:
    mean, low, high = (f"{100 * found[name]:.2f}" for name in ("cage_slip", "cage_slip_minimum", "cage_slip_maximum"))
    return f"{mean} %" if low == high else f"{mean} % ({low} to {high} %)"


def _margin(scene: Scene, found: Mapping) -> str:
    """Return how far slip is from the threshold above which the scene warns of it, and the load from the load below which a skid lasts."""
    load, limit = found["radial_load"], found.get("skid_load")
    said = f"; warning from {number(100.0 * scene.thresholds.slip_warning, 3)} %"
    if limit is not None and limit > 0.0:
        return f"{said}; the load is {number(load / limit, 2)} times the skid load, {force(limit, 3)}"
    return f"{said}; no skid lasts at any load" if limit == 0.0 else said
