# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Friction of catalogue bearings against makers' models: moments, thermal reference speeds, parts over film ratios."""

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.model import Work, new_work
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.model.params import pack
from bearing_sim.physics.rating_life import viscosity_ratio
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs
from bearing_sim.studies.friction import Dimensions, dimensions_of, moments_of_makers, series_of, turning_answer
from bearing_sim.sweep.thermal import OperatingState, operating_state

_RPM = math.pi / 30.0
LOADS = (0.02, 0.05, 0.1, 0.2)  # of C_0
SPEEDS = (0.25, 0.5, 1.0)  # of the maker's reference speed, beside 500 rpm
SLOWEST = 500.0  # rpm
TEMPERATURE = 343.15  # K, ISO 15312
REFERENCE_LOAD = 0.05  # of C_0, ISO 15312
# A mineral oil like ISO VG 32 with exactly the 12 mm^2/s at 70 degC of ISO 15312; its other properties follow from its kind of base oil.
_OIL = {"law": "custom", "viscosity_40": 35.0e-6, "viscosity_100": 5.72e-6, "name": "ISO 15312 reference oil"}
FILM_RATIOS = (0.05, 0.1, 0.24, 0.5, 1.0, 2.8, 5.0, 10.0)  # kappa of full inlets, nu/nu_1
FILM_LOADS = (0.02, 0.05, 0.1, 0.2, 0.3)  # of C
_FILM_TEMPERATURE, _FILM_SPEED = 313.15, 0.5  # K; of the maker's reference speed
_THINNEST = 20.0  # mm^2/s; for thinner films the shaft turns more slowly
_INDEX = 95.0  # of viscosity, of a mineral oil
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
    answer = turning_answer(scene, inputs, state, work)
    parts = {name: float(answer[column]) * 1e3 / (speed * _RPM) for name, column in ANSWER._asdict().items() if name.endswith("_power")}
    viscosity = 1e6 * lubrication.kinematic_viscosity
    (viscous, by_load), skf = moments_of_makers(scene, series, speed, load, viscosity, scene.operating.axial_load)
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
        flow, printed = heat_flow(dimensions_of(scene)), scene.bearing.ratings.reference_speed / _RPM
        load = REFERENCE_LOAD * scene.bearing.ratings.static
        viscosity = 1e6 * operating_state(scene).lubrication.kinematic_viscosity
        laws = (
            lambda speed: moments(scene, series, [(speed, load)])[0].model,
            lambda speed: sum(moments_of_makers(scene, series, speed, load, viscosity, 0.0)[0]),
            lambda speed: moments_of_makers(scene, series, speed, load, viscosity, 0.0)[1].whole,
        )

        def excess(log_speed, law):
            speed = math.exp(log_speed)
            return math.log(1e-3 * law(speed) * speed * _RPM / flow)

        speeds = [math.exp(brentq(excess, math.log(0.1 * printed), math.log(4.0 * printed), (law,), xtol=1e-3)) for law in laws]
        found.append(ThermalSpeed(name, *speeds, printed, float(NKE_SPEEDS.get(name, math.nan))))
    return found
