# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Frictional moment of the model against what makers and standards calculate, and the speeds at which it reaches ISO 15312's heat flow.

Nothing of the model is fitted to these comparisons: all bearings have the same laws with the constants of their sources.  Bearings stand in an
oil bath to the middle of the lowest roller, with films that obey thermal Eyring traction, at 70 degC in a mineral oil of 12 mm^2/s (ISO 15312); over
film ratios at 40 degC in mineral oils from 20 mm^2/s on.  Moments are those of level ``steady``.
"""

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.model import Work, new_work
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.model.params import pack
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.physics.drag import bath_moment
from bearing_sim.physics.rating_life import viscosity_ratio
from bearing_sim.scene.designation import readable_designation
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.lubricant import NoRollingResistance
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, scene_inputs
from bearing_sim.sweep.thermal import OperatingState, operating_state, solved_answer

LOADS = (0.02, 0.05, 0.1, 0.2)  # of C_0
SPEEDS = (0.25, 0.5, 1.0)  # of the maker's reference speed, beside 500 rpm
SLOWEST = 500.0  # rpm
TEMPERATURE = 343.15  # K, ISO 15312
REFERENCE_LOAD = 0.05  # of C_0, ISO 15312
_RPM = math.pi / 30.0
# A mineral oil like ISO VG 32 with exactly the 12 mm^2/s at 70 degC of ISO 15312; its other properties follow from its kind of base oil.
_OIL = {"law": "custom", "viscosity_40": 35.0e-6, "viscosity_100": 5.72e-6, "name": "ISO 15312 reference oil"}
FILM_RATIOS = (0.05, 0.1, 0.24, 0.5, 1.0, 2.8, 5.0, 10.0)  # kappa of full inlets, nu/nu_1
FILM_LOADS = (0.02, 0.05, 0.1, 0.2, 0.3)  # of C
_FILM_TEMPERATURE, _FILM_SPEED = 313.15, 0.5  # K; of the maker's reference speed
_THINNEST = 20.0  # mm^2/s; for thinner films the shaft turns more slowly
_INDEX = 95.0  # of viscosity, of a mineral oil


class Constants(NamedTuple):
    """Constants of makers' models of friction for one series."""

    f_0: float  # of the simple model, oil in a bath or circulating
    f_0_grease: float  # of grease, oil mist or oil-air
    f_1: float
    r_1: float  # R_1 of SKF's rolling moment


# f_0 and f_1: Schaeffler, Technical principles of rolling bearings (bearing factors of cylindrical roller bearings, with a cage; SL1822, SL1829 and
# SL1830, full complement).  With the f_0 for oil ISO 15312's balance gives the thermal speed ratings that NKE prints (`test/test_friction_study.py`
# computes them back).  R_1: SKF, Rolling bearings, table of geometric constants of cylindrical roller bearings.
SERIES = {
    "10": Constants(2.0, 1.3, 0.0002, 1.12e-6),
    "2": Constants(2.0, 1.3, 0.0003, 1.09e-6),
    "3": Constants(2.0, 1.3, 0.00035, 1.09e-6),
    "4": Constants(2.0, 1.3, 0.0004, 1.00e-6),
    "22": Constants(3.0, 2.0, 0.0004, 1.40e-6),
    "23": Constants(4.0, 2.7, 0.0004, 1.48e-6),
    "NCF 22": Constants(8.0, 5.0, 0.00055, 2.13e-6),
    "NCF 29": Constants(6.0, 4.0, 0.00055, 2.13e-6),
    "NCF 30": Constants(7.0, 5.0, 0.00055, 2.13e-6),
}
_S_1, _S_1_10, _S_2 = 0.16, 0.17, 0.0015  # of SKF's sliding moment, S_1 also of series 10, same table
_K_Z, _K_L = (5.1, 6.2), (0.65, 0.7)  # SKF's constants of geometry with a cage, and of a full complement (same source)
_STARVED, _DRAGGING = 3e-8, 1.0  # K_rs, and drag over that of a bath, of oil up to a level
_SUPPLIES = {"oil_jet": (3e-8, 2.0), "oil_air": (6e-8, 0.0), "grease": (6e-8, 0.0)}  # the same of other supplies
# Of five series, from small to large.
BEARINGS = ("NU 1010", "NU 1020", "NU 205", "NU 210", "NU 232", "NU 310", "NU 2210", "NU 2220", "NU 2310", "NU 2324")
# Of all series and types with known R_1, from small to large.
FILM_BEARINGS = (
    *("NU 1010", "NU 1020", "NU 1032", "NU 1080", "NU 205", "NU 210", "NU 215", "NU 220", "NU 232", "NJ 210", "NUP 210", "N 210", "N 220"),
    *("NU 305", "NU 310", "NU 318", "NU 326", "NJ 310", "NUP 313", "N 310", "NU 2205", "NU 2210", "NU 2220", "NUP 2210", "NJ 2232"),
    *("NU 2305", "NU 2308", "NU 2310", "NU 2324", "NJ 2316"),
)
# Thermal speed ratings by ISO 15312 that NKE prints for the same sizes [rpm] (NKE, general catalogue, cylindrical roller bearings, E design).
NKE_SPEEDS = {"NU 1010": 7100, "NU 205": 11800, "NU 210": 6700, "NU 232": 2200, "NU 310": 6100, "NU 2210": 5300, "NU 2310": 5000, "NU 2324": 2000}


class Dimensions(NamedTuple):
    """Boundary dimensions as makers' formulas take them [mm]."""

    bore: float
    outside: float
    width: float

    @property
    def mean(self) -> float:
        """d_m = (d + D)/2 [mm]."""
        return 0.5 * (self.bore + self.outside)


def dimensions_of(scene: Scene) -> Dimensions:
    """Return the boundary dimensions of a scene's bearing."""
    bearing = scene.bearing
    return Dimensions(1e3 * bearing.bore_diameter, 1e3 * bearing.outside_diameter, 1e3 * bearing.boundary_width)


def series_of(name: str) -> str | None:
    """Return the series of `SERIES` by the designation of a bearing, such as 22 of NU 2210; None where there is none."""
    found = readable_designation(name)
    if found is None:
        return None
    series = f"{found.type} {found.series}" if found.is_full_complement else found.series
    return series if series in SERIES else None


def simple_moment(series: str, dimensions: Dimensions, speed: float, load: float, viscosity: float, supply: str = "oil_bath") -> tuple[float, float]:
    """Return M_0 and M_1 [N mm] of makers' simple model (A. Palmgren 1959; ISO 15312:2003, 5).

    M_0 = f_0 (nu n)^(2/3) d_m^3 1e-7, with 160 for (nu n)^(2/3) below nu n = 2000, and M_1 = f_1 P d_m.

    Parameters
    ----------
    series : of `SERIES`.
    dimensions : of the bearing.
    speed : n [rpm].
    load : P [N].
    viscosity : nu [mm^2/s].
    supply : law of ``lubricant.supply``; grease and oil-air have their own f_0, an oil jet that of circulating oil.
    """
    factors, product = SERIES[series], viscosity * speed
    power = product ** (2.0 / 3.0) if product > 2000.0 else 160.0
    f_0 = factors.f_0_grease if supply in ("grease", "oil_air") else factors.f_0
    return f_0 * power * dimensions.mean**3 * 1e-7, factors.f_1 * load * dimensions.mean


class SkfMoment(NamedTuple):
    """Frictional moment by SKF's friction model [N mm]."""

    rolling: float  # M_rr
    sliding: float  # M_sl
    drag: float  # M_drag, of rollers and cage in the oil

    @property
    def whole(self) -> float:
        """M_rr + M_sl + M_drag."""
        return sum(self)


def skf_moment(
    series: str, dimensions: Dimensions, speed: float, load: float, viscosity: float, level: float, axial_load: float = 0.0, supply: str = "oil_bath"
) -> SkfMoment:
    """Return the moment by SKF's friction model, no seals (SKF, The SKF model for calculating the frictional moment).

    M_rr = phi_ish phi_rs G_rr (nu n)^0.6 and M_sl = G_sl mu_sl with G_rr = R_1 d_m^2.41 F_r^0.31, G_sl = S_1 d_m^0.9 F_a + S_2 d_m F_r,
    mu_sl = phi_bl 0.12 + (1 - phi_bl) 0.02, phi_bl = exp(-2.6e-8 (n nu)^1.4 d_m), K_rs = 3e-8, of grease and oil-air 6e-8.  The drag of a jet is
    twice that of a bath to the level; grease and oil-air have none.

    Parameters
    ----------
    series, dimensions, speed, load, viscosity, supply : as of `simple_moment`.
    level : of the oil above the lowest point of the outer raceway [mm]; of a jet the radius of the rollers.
    axial_load : F_a [N].
    """
    d, outside, mean = dimensions.bore, dimensions.outside, dimensions.mean
    starving, dragging = _SUPPLIES.get(supply, (_STARVED, _DRAGGING))
    full = series.startswith("NCF")
    heated = 1.0 / (1.0 + 1.84e-9 * (speed * mean) ** 1.28 * viscosity**0.64)
    starved = math.exp(-starving * viscosity * speed * (d + outside) * math.sqrt(_K_Z[full] / (2.0 * (outside - d))))
    rolling = heated * starved * SERIES[series].r_1 * mean**2.41 * load**0.31 * (viscosity * speed) ** 0.6
    boundary = math.exp(-2.6e-8 * (speed * viscosity) ** 1.4 * mean)
    s_1 = _S_1_10 if series == "10" else _S_1
    sliding = (s_1 * mean**0.9 * abs(axial_load) + _S_2 * mean * load) * (0.12 * boundary + 0.02 * (1.0 - boundary))
    # the drag is linear in K_Z and depends on K_L by K_L B alone; `bath_moment` has those of bearings with a cage
    width = 1e-3 * dimensions.width * _K_L[full] / _K_L[0]
    bath = sum(bath_moment(1e-3 * level, speed * _RPM, 1e-6 * viscosity, 1e-3 * d, 1e-3 * outside, width)) if dragging else 0.0
    return SkfMoment(rolling, sliding, 1e3 * dragging * _K_Z[full] / _K_Z[0] * bath)


class MakersMoment(NamedTuple):
    """Frictional moment of a bearing by makers' models [N m]; None where they have no constants, and why."""

    series: str | None  # of `SERIES`
    skf: float | None  # SKF's friction model, the whole moment without seals
    simple: float | None  # M_0 + M_1
    reason: str  # why there is none; "" where there is one


def makers_moment(scene: Scene, speed: float, load: float, viscosity: float, axial_load: float = 0.0, series: str | None = None) -> MakersMoment:
    """Return the frictional moment of a scene's bearing by SKF's friction model and by makers' simple model.

    Parameters
    ----------
    scene : its bearing and the supply of its lubricant count.
    speed : of the shaft [rad/s], of any sign.
    load : radial load [N].
    viscosity : kinematic viscosity of the oil, or of the grease's base oil, at the temperature of the contacts [m^2/s].
    axial_load : F_a [N], which SKF's model counts; the simple model's M_2 for it has no published constants by series and is left out.
    series : of `SERIES`; None: that of the bearing's designation.
    """
    bearing = scene.bearing
    series = series or series_of(bearing.designation or bearing.name)
    if series not in SERIES:
        known = ", ".join(SERIES)
        return MakersMoment(None, None, None, f"makers publish constants by series ({known}), and {bearing.name!r} is not a designation of one")
    if speed == 0.0:
        return MakersMoment(series, None, None, "makers' models are for a shaft that turns")
    simple, skf = _moments_of_makers(scene, series, abs(speed) / _RPM, load, 1e6 * viscosity, axial_load)
    return MakersMoment(series, 1e-3 * skf.whole, 1e-3 * sum(simple), "")


def _moments_of_makers(
    scene: Scene, series: str, speed: float, load: float, viscosity: float, axial_load: float
) -> tuple[tuple[float, float], SkfMoment]:
    """Return the moments of `simple_moment` and `skf_moment` for the bearing and the supply of a scene."""
    dimensions, supply = dimensions_of(scene), scene.lubricant.supply
    level = getattr(supply, "level", None)
    height = 1e3 * (0.5 * scene.bearing.roller.diameter if level is None else level)
    skf = skf_moment(series, dimensions, speed, load, viscosity, height, axial_load, supply.law)
    return simple_moment(series, dimensions, speed, load, viscosity, supply.law), skf


def bath_scene(name: str, overrides: Sequence[str] = (), oil: Mapping = _OIL, temperature: float = TEMPERATURE) -> Scene:
    """Return a catalogue bearing in a bath, by default under the reference conditions of ISO 15312 but for speed and load.

    Parameters
    ----------
    name : designation of the bearing.
    overrides : as of `load_scene`.
    oil : as in a scene.
    temperature : of the oil and all parts [K].
    """
    lubricant = {"oil": oil, "temperature": temperature, "supply": "oil_bath", "traction": {"law": "eyring"}}
    operating = {"shaft_speed": f"{SLOWEST} rpm", "radial_load": "1 kN"}
    return load_scene({"name": name, "level": "steady", "bearing": name, "lubricant": lubricant, "operating": operating}, overrides)


def bearings() -> list[str]:
    """Return the bearings that are compared, by series and size."""
    return list(BEARINGS)


class Moment(NamedTuple):
    """Frictional moments of one bearing at one speed and load [N mm]."""

    bearing: str
    series: str
    speed: float  # [rpm]
    load: float  # of C_0
    model: float  # the whole moment
    rolling: float  # its parts
    sliding: float
    drag: float  # of rollers and cage
    pocket: float
    seal: float
    flange: float  # of roller ends
    viscous: float  # M_0 of the simple model
    by_load: float  # M_1 of it
    skf: float
    skf_rolling: float  # parts of it
    skf_sliding: float
    slip: float  # of the cage

    @property
    def simple(self) -> float:
        """M_0 + M_1."""
        return self.viscous + self.by_load

    @property
    def ratio(self) -> float:
        """The model's moment over that of the simple model."""
        return self.model / self.simple


def moments(scene: Scene, series: str, conditions: Sequence[tuple[float, float]]) -> list[Moment]:
    """Return the moments of a scene's bearing at level ``steady`` and by makers' models.

    Parameters
    ----------
    scene : its oil, its temperatures and its supply count, and the direction of its load.
    series : of `SERIES`.
    conditions : speed [rpm] and load [N] of each.

    Raises
    ------
    ValueError
        No operating point was found.
    IntegrationError
        There is no thermal equilibrium.
    """
    angle, kelvin = scene.operating.load_angle, scene.lubricant.temperature
    asked = [Inputs(speed * _RPM, load * math.cos(angle), load * math.sin(angle), kelvin) for speed, load in conditions]
    work = new_work(pack(scene))
    return [_moment(scene, series, inputs, operating_state(scene, inputs), work) for inputs in asked]


def _moment(scene: Scene, series: str, inputs: Inputs, state: OperatingState, work: Work) -> Moment:
    """Return the moments at one condition, see `moments`."""
    params, lubrication, _ = state
    speed, load = abs(inputs.shaft_speed) / _RPM, math.hypot(inputs.load_y, inputs.load_z)
    if speed == 0.0:
        raise ValueError(f"{scene.name}: operating.shaft_speed: 0; friction is compared with makers' models while the shaft turns: give a speed")
    answer = solved_answer(state, inputs, work)
    if not math.isfinite(answer[ANSWER.cage_slip]):
        raise ValueError(f"{scene.name}: no operating point at {speed:g} rpm and {load:g} N")
    parts = {name: float(answer[column]) * 1e3 / (speed * _RPM) for name, column in ANSWER._asdict().items() if name.endswith("_power")}
    viscosity = 1e6 * lubrication.kinematic_viscosity
    (viscous, by_load), skf = _moments_of_makers(scene, series, speed, load, viscosity, scene.operating.axial_load)
    return Moment(
        scene.bearing.name,
        series,
        speed,
        load / params.life.static_rating,
        parts["shaft_power"],
        parts["inner_rolling_power"] + parts["outer_rolling_power"],
        parts["inner_sliding_power"] + parts["outer_sliding_power"],
        parts["churning_power"] + parts["windage_power"] + parts["land_power"],
        parts["pocket_power"],
        parts["seal_power"],
        parts["flange_power"],
        viscous,
        by_load,
        skf.whole,
        skf.rolling,
        skf.sliding,
        float(answer[ANSWER.cage_slip]),
    )


def moment_table(progress: Callable[[str], None] = lambda name: None, overrides: Sequence[str] = ()) -> list[Moment]:
    """Return the moments of all catalogue bearings from 0.02 to 0.2 C_0 and from 500 rpm to the reference speed.

    Parameters
    ----------
    progress : called with the name of each bearing.
    overrides : of every scene, see `load_scene`.
    """
    found = []
    for name in bearings():
        progress(name)
        scene = bath_scene(name, overrides)
        reference, static = scene.bearing.ratings.reference_speed / _RPM, scene.bearing.ratings.static
        speeds = [SLOWEST, *(fraction * reference for fraction in SPEEDS)]
        found += moments(scene, series_of(name), [(speed, load * static) for speed in speeds for load in LOADS])
    return found


class PartRatios(NamedTuple):
    """Friction of one bearing at one film ratio and load, over that of SKF's friction model."""

    bearing: str
    series: str
    kappa: float  # of full inlets
    load: float  # of C
    speed: float  # [rpm]
    viscosity: float  # [mm^2/s]
    whole: float  # moment
    rolling: float  # hydrodynamic resistance to rolling over M_rr
    sliding: float  # sliding on raceways, in pockets and on flanges, skew and hysteresis over M_sl
    slip: float  # of the cage


def film_condition(kappa: float, pitch_diameter: float, reference_speed: float) -> tuple[float, float]:
    """Return speed [rpm] and viscosity [mm^2/s] at which a bearing has a film ratio.

    Half of the reference speed in the oil that gives it; where that is thinner than 20 mm^2/s, an oil of 20 mm^2/s and a slower shaft.

    Parameters
    ----------
    kappa : film ratio, see `bearing_sim.physics.rating_life.viscosity_ratio`.
    pitch_diameter : D_pw [m].
    reference_speed : of the maker [rpm].
    """
    from scipy.optimize import brentq

    speed = _FILM_SPEED * reference_speed
    viscosity = kappa / viscosity_ratio(1e-6, speed * _RPM, pitch_diameter)
    if viscosity >= _THINNEST:
        return speed, viscosity
    slower = brentq(lambda log: math.log(viscosity_ratio(1e-6 * _THINNEST, math.exp(log) * _RPM, pitch_diameter) / kappa), -7.0, math.log(speed))
    return math.exp(slower), _THINNEST


def part_ratios(
    progress: Callable[[str], None] = lambda name: None,
    overrides: Sequence[str] = (),
    names: Sequence[str] = FILM_BEARINGS,
    kappas: Sequence[float] = FILM_RATIOS,
) -> list[PartRatios]:
    """Return the parts of friction over those of SKF's friction model, for all bearings, film ratios and loads.

    Parameters
    ----------
    progress, overrides : as of `moment_table`.
    names, kappas : bearings and film ratios.
    """
    found = []
    for name in names:
        progress(name)
        bearing, series = bath_scene(name, overrides).bearing, series_of(name)
        rating = rate(bearing).dynamic
        for kappa in kappas:
            speed, viscosity = film_condition(kappa, bearing.pitch_diameter, bearing.ratings.reference_speed / _RPM)
            oil = {"law": "custom", "viscosity_40": 1e-6 * viscosity, "viscosity_index": _INDEX}
            scene = bath_scene(name, overrides, oil, _FILM_TEMPERATURE)
            conditions = [(speed, load * rating) for load in FILM_LOADS]
            both = moments(scene, series, conditions), moments(_without_skew_and_hysteresis(scene), series, conditions)
            for load, full, hydrodynamic in zip(FILM_LOADS, *both):
                sliding = full.sliding + full.pocket + full.flange + full.rolling - hydrodynamic.rolling
                ratios = full.model / full.skf, hydrodynamic.rolling / full.skf_rolling, sliding / full.skf_sliding
                found.append(PartRatios(name, series, kappa, load, speed, viscosity, *ratios, full.slip))
    return found


def _without_skew_and_hysteresis(scene: Scene) -> Scene:
    """Return a scene whose resistance to rolling is hydrodynamic only."""
    mixed = scene.lubricant.mixed_friction
    if mixed.law == "none":
        return scene
    return dataclasses.replace(
        scene, lubricant=dataclasses.replace(scene.lubricant, mixed_friction=dataclasses.replace(mixed, skew=0.0, hysteresis=0.0))
    )


class Spread(NamedTuple):
    """Where values lie."""

    median: float
    low: float  # 5 % are below
    high: float  # 5 % are above


class FilmRow(NamedTuple):
    """`PartRatios` of all bearings and loads at one film ratio."""

    kappa: float
    count: int
    whole: Spread
    rolling: Spread
    sliding: Spread
    slip: Spread


def film_rows(ratios: Sequence[PartRatios]) -> list[FilmRow]:
    """Return the spread of ratios at each film ratio."""
    rows = []
    for kappa in dict.fromkeys(one.kappa for one in ratios):
        points = np.array([one[6:] for one in ratios if one.kappa == kappa])
        rows.append(FilmRow(kappa, len(points), *(Spread(*each) for each in np.percentile(points, (50, 5, 95), axis=0).T.tolist())))
    return rows


def heat_flow(dimensions: Dimensions) -> float:
    """Return the heat q_r A_r that a radial bearing gives away under the reference conditions of ISO 15312 [W].

    A_r = pi B (D + d); q_r = 0.016 W/mm^2 up to 50,000 mm^2 and 0.016 (A_r/50000)^-0.34 above.
    """
    area = math.pi * dimensions.width * (dimensions.outside + dimensions.bore)
    return 0.016 * min(1.0, (area / 50_000.0) ** -0.34) * area


class ThermalSpeed(NamedTuple):
    """Thermal reference speeds of one bearing [rpm]: where friction equals q_r A_r under the reference conditions of ISO 15312."""

    bearing: str
    model: float
    simple: float  # by M_0 + M_1
    skf_model: float  # by SKF's friction model
    skf: float  # as SKF prints
    nke: float  # as NKE prints, NaN where it prints none


def thermal_speeds(progress: Callable[[str], None] = lambda name: None, overrides: Sequence[str] = ()) -> list[ThermalSpeed]:
    """Return the thermal reference speeds of all catalogue bearings; parameters as of `moment_table`."""
    from scipy.optimize import brentq

    found = []
    for name in bearings():
        progress(name)
        scene, series = bath_scene(name, overrides), series_of(name)
        dimensions, printed = dimensions_of(scene), scene.bearing.ratings.reference_speed / _RPM
        load = REFERENCE_LOAD * scene.bearing.ratings.static
        level = 500.0 * scene.bearing.roller.diameter
        viscosity = 1e6 * operating_state(scene).lubrication.kinematic_viscosity
        laws = (
            lambda speed: moments(scene, series, [(speed, load)])[0].model,
            lambda speed: sum(simple_moment(series, dimensions, speed, load, viscosity)),
            lambda speed: skf_moment(series, dimensions, speed, load, viscosity, level).whole,
        )

        def excess(log_speed, law):
            speed = math.exp(log_speed)
            return math.log(1e-3 * law(speed) * speed * _RPM / heat_flow(dimensions))

        speeds = [math.exp(brentq(excess, math.log(0.1 * printed), math.log(4.0 * printed), (law,), xtol=1e-3)) for law in laws]
        found.append(ThermalSpeed(name, *speeds, printed, float(NKE_SPEEDS.get(name, math.nan))))
    return found


class Comparison(NamedTuple):
    """Friction of one bearing at one condition [W]."""

    series: str
    without_resistance: float  # at the same temperatures
    model: float
    simple: float
    skf: float
    coefficient: float  # by 0.0011 P d/2, the simplest of makers' rules
    viscosity: float  # of the oil in the contacts, as all models take it [mm^2/s]
    temperatures: dict[str, float]  # of the parts, by the names of the observables [K]; NaN where the scene's law of heat says nothing


def compare(scene: Scene, series: str) -> Comparison:
    """Return the friction of a scene's bearing at its operating point, with and without rolling resistance, and by makers' models.

    Parameters
    ----------
    scene : its operating conditions count; with a thermal network it is in equilibrium.
    series : of `SERIES`.

    Raises
    ------
    ValueError
        The shaft is at rest, or no operating point was found.
    IntegrationError
        There is no thermal equilibrium.
    """
    inputs, state = scene_inputs(scene), operating_state(scene)
    plain = dataclasses.replace(scene, lubricant=dataclasses.replace(scene.lubricant, rolling_resistance=NoRollingResistance()))
    work = new_work(state.params)
    bare = _moment(plain, series, inputs, operating_state(plain, inputs, state.temperatures), work)
    full = _moment(scene, series, inputs, state, work)
    watts, load = 1e-3 * abs(inputs.shaft_speed), scene.operating.radial_load
    return Comparison(
        series,
        *(watts * moment for moment in (bare.model, full.model, full.simple, full.skf)),
        0.0011 * load * 0.5 * dimensions_of(scene).bore * watts,
        1e6 * state.lubrication.kinematic_viscosity,
        dict(zip(NODE_OBSERVABLES, state.temperatures.tolist())),
    )
