# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Frictional moment of the model against what makers and standards calculate, and the speeds at which it reaches ISO 15312's heat flow.

Nothing of the model is fitted to these comparisons: all bearings have the same laws with the constants of their sources.  Bearings stand in an
oil bath to the middle of the lowest roller, with films that obey thermal Eyring traction, at 70 degC in a mineral oil of 12 mm^2/s (ISO 15312); over
film ratios at 40 degC in mineral oils from 20 mm^2/s on.  Moments are those of level ``steady``.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.model import Work, new_work
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.physics.drag import bath_moment
from bearing_sim.scene.designation import readable_designation
from bearing_sim.scene.lubricant import NoRollingResistance
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, scene_inputs
from bearing_sim.sweep.thermal import OperatingState, operating_state, solved_answer

_RPM = math.pi / 30.0


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
    simple, skf = moments_of_makers(scene, series, abs(speed) / _RPM, load, 1e6 * viscosity, axial_load)
    return MakersMoment(series, 1e-3 * skf.whole, 1e-3 * sum(simple), "")


def moments_of_makers(
    scene: Scene, series: str, speed: float, load: float, viscosity: float, axial_load: float
) -> tuple[tuple[float, float], SkfMoment]:
    """Return the moments of `simple_moment` and `skf_moment` for the bearing and the supply of a scene."""
    dimensions, supply = dimensions_of(scene), scene.lubricant.supply
    level = getattr(supply, "level", None)
    height = 1e3 * (0.5 * scene.bearing.roller.diameter if level is None else level)
    skf = skf_moment(series, dimensions, speed, load, viscosity, height, axial_load, supply.law)
    return simple_moment(series, dimensions, speed, load, viscosity, supply.law), skf


def turning_answer(scene: Scene, inputs: Inputs, state: OperatingState, work: Work) -> np.ndarray:
    """Return the answer of level steady under conditions, see `bearing_sim.levels.steady.operating_point.ANSWER`; errors as of `compare`."""
    if inputs.shaft_speed == 0.0:
        raise ValueError(f"{scene.name}: operating.shaft_speed: 0; friction is compared with makers' models while the shaft turns: give a speed")
    answer, speed = solved_answer(state, inputs, work), abs(inputs.shaft_speed) / _RPM
    if not math.isfinite(answer[ANSWER.cage_slip]):
        raise ValueError(f"{scene.name}: no operating point at {speed:g} rpm and {math.hypot(inputs.load_y, inputs.load_z):g} N")
    return answer


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
    bare = float(turning_answer(plain, inputs, operating_state(plain, inputs, state.temperatures), work)[ANSWER.shaft_power])
    full = float(turning_answer(scene, inputs, state, work)[ANSWER.shaft_power])
    speed, load, viscosity = abs(inputs.shaft_speed), math.hypot(inputs.load_y, inputs.load_z), 1e6 * state.lubrication.kinematic_viscosity
    simple, skf = moments_of_makers(scene, series, speed / _RPM, load, viscosity, scene.operating.axial_load)
    watts = 1e-3 * speed
    return Comparison(
        series,
        bare,
        full,
        watts * sum(simple),
        watts * skf.whole,
        0.0011 * scene.operating.radial_load * 0.5 * dimensions_of(scene).bore * watts,
        viscosity,
        dict(zip(NODE_OBSERVABLES, state.temperatures.tolist())),
    )
