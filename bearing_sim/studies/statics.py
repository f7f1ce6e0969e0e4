# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Statics of a scene: the load distribution over rollers and slices at constant conditions, and the resulting lives."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.bending import observe_bending
from bearing_sim.levels.common.model import write_growth
from bearing_sim.levels.common.observation import write_clearance
from bearing_sim.levels.common.slice_balance import about_yz, balance, leaning, roller_loads, roller_tilts
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import Life, Params
from bearing_sim.model.sample import NODE_OBSERVABLES, flat
from bearing_sim.model.validity import still_sample
from bearing_sim.physics.growth import clearance_at
from bearing_sim.physics.lamina_life import EquivalentLoads, add_lamina_powers, equivalent_lamina_loads
from bearing_sim.physics.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT, Lives, OilFactors, oil_factors, rate_lives
from bearing_sim.physics.ring_balance import ROLLER
from bearing_sim.scene.display import hours, larger_unit
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import scene_inputs
from bearing_sim.sweep.pictures import new_figure, save
from bearing_sim.sweep.thermal import operating_state
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm

_PITCH_POSITIONS, _MOST_PITCH_POSITIONS = 20, 320  # cage angles over one roller pitch for the lives, at first and at most
_LIFE_CHANGE = 2e-3  # of both lives by laminae, by which twice as many may change them


class Statics(NamedTuple):
    """Quasi-static balance of a scene with roller 0 on the load line; positions along a roller are measured from its middle."""

    azimuths: np.ndarray  # of the rollers [rad], shape (Z,)
    inner: np.ndarray  # loads on the inner raceway [N], shape (Z,)
    outer: np.ndarray
    tilts: np.ndarray  # of the rollers, positive with the +x end outwards [rad], shape (Z,)
    slice_middles: np.ndarray  # along the roller [m], shape (N,)
    inner_slices: np.ndarray  # loads of the slices [N], shape (Z, N)
    outer_slices: np.ndarray
    inner_pressure: float  # largest Hertzian pressure on the inner raceway [Pa]
    outer_pressure: float
    ring: tuple[float, float]  # displacement y, z of the inner ring [m]
    tilt: tuple[float, float]  # of the inner ring: magnitude, and azimuth of its +x end [rad]
    moment: tuple[float, float]  # on the inner ring: magnitude [N m], and azimuth towards which it tilts the +x end [rad]
    equivalent_loads: EquivalentLoads  # over one roller pitch; those by laminae are of the slices
    lives: Lives  # with the lives in hours; infinite at rest
    film: float  # least film thickness [m]; NaN at rest and without load
    sample: np.ndarray  # block of one sample with all this in it, for laws and reports; its cage does not slip


def statics(scene: Scene, slices: int) -> Statics:
    """Return the statics of a scene at its constant conditions and without cage slip, in thermal equilibrium where it has a thermal network.

    Parameters
    ----------
    scene : of any level.
    slices : per roller, instead of the scene's number.

    Raises
    ------
    ArithmeticError
        No balance was found.
    IntegrationError
        There is no thermal equilibrium: it says why.
    """
    bearing = dataclasses.replace(scene.bearing, roller=dataclasses.replace(scene.bearing.roller, slices=slices))
    scene = dataclasses.replace(scene, bearing=bearing, life=dataclasses.replace(scene.life, laminae=slices))  # the slices are the laminae
    (params, lubrication, temperatures), operating = operating_state(scene), scene.operating
    count, raceways, speed = params.rollers.count, params.raceways, abs(operating.shaft_speed)
    cage_speed = 0.5 * operating.shaft_speed * (1.0 - raceways.diameter_ratio)
    load = scene_inputs(scene)[1:3]
    moment = about_yz(operating.moment or 0.0, operating.moment_angle)
    tilts = about_yz(operating.misalignment, operating.misalignment_angle) if operating.moment is None else None
    aligned = new_work(params)
    write_growth(operating.shaft_speed, lubrication.growth, aligned.growth)

    def balance_at(turned, start=None):
        angle = operating.load_angle + turned
        deflections = _deflections(angle, cage_speed, load, params, aligned)
        return balance(params, angle, cage_speed, load, moment, tilts, start, aligned.growth[0], deflections)

    oil = oil_factors(speed, lubrication.kinematic_viscosity, 2 * raceways.pitch_radius, params.starvation, params.life)
    equivalent, lives = _over_pitch(balance_at, oil, params.life, operating.radial_load, 2 * math.pi / count)
    at = balance_at(0.0)
    inner, outer = roller_loads(at)
    hours, width = 2 * math.pi / (3600 * speed) if speed > 0.0 else math.inf, params.rollers.length / slices
    lives = lives._replace(**{name: hours * getattr(lives, name) for name in ("basic", "modified", "l10", "lnm", "l10r", "lnmr")})
    pressures = [
        _pressure(loads.max() / width, radius, raceways.reduced_modulus)
        for loads, radius in ((at.inner, raceways.inner_curvature_radius), (at.outer, raceways.outer_curvature_radius))
    ]

    sample = still_sample(scene)
    sample["inner_load"], sample["outer_load"] = inner, outer
    sample["reference_load"], sample["viscosity_ratio"] = lives.reference_load, lives.viscosity_ratio
    sample["inner_pressure"], sample["outer_pressure"] = pressures
    write_clearance(clearance_at(operating.shaft_speed, lubrication.growth, params), flat(sample)[0])
    observe_bending(aligned.bending, count, flat(sample)[0])
    for name, temperature in zip(NODE_OBSERVABLES, temperatures):
        sample[name] = temperature
    return Statics(
        azimuths=operating.load_angle + 2 * math.pi * np.arange(count) / count,
        inner=inner,
        outer=outer,
        tilts=roller_tilts(at),
        slice_middles=at.position * at.half_length,
        inner_slices=at.inner.copy(),
        outer_slices=at.outer.copy(),
        inner_pressure=pressures[0],
        outer_pressure=pressures[1],
        ring=tuple(at.ring[:2].tolist()),
        tilt=leaning(*at.ring[2:].tolist()),
        moment=leaning(*at.reaction[2:].tolist()),
        equivalent_loads=equivalent,
        lives=lives,
        film=float(ThinnestFilm(scene).least(sample)[0]) if speed > 0.0 else math.nan,
        sample=sample,
    )


def _deflections(angle: float, cage_speed: float, load: Sequence[float], params: Params, work) -> np.ndarray | None:
    """Return how far an outer ring that bends gives way to rollers that stay aligned [m], shape (Z,); None of a rigid ring.

    Raises
    ------
    ArithmeticError
        No balance was found.
    """
    if work.bending is None:
        return None
    if not balance_loads(angle, cage_speed, load[0], load[1], params, work):
        raise ArithmeticError(f"the balance of rollers and an outer ring that bends did not converge at load {load} N, cage {cage_speed:.6g} rad/s")
    return work.bending.rollers[ROLLER.deflection]


def _over_pitch(balance_at: Callable, oil: OilFactors, life: Life, radial_load: float, pitch: float) -> tuple[EquivalentLoads, Lives]:
    """Return equivalent loads, and lives in revolutions, by means over the cage angles of a pitch.

    Angles are doubled until that changes neither L10r nor L_nmr by more than `_LIFE_CHANGE`, or there are `_MOST_PITCH_POSITIONS`.

    Parameters
    ----------
    balance_at : returns the bearing in balance with the cage turned by an angle [rad] from the load line, from a balance nearby.
    oil, life, radial_load : as of `rate_lives`.
    pitch : [rad].
    """
    risers = life.laminae.risers
    inner_means, outer_means, whole_means = np.zeros(len(risers)), np.zeros(len(risers)), np.zeros(2)
    places, at, done, before = np.arange(_PITCH_POSITIONS) / _PITCH_POSITIONS, None, 0, None
    while True:
        for place in places:
            at, done = balance_at(pitch * place, at), done + 1
            inner, outer = roller_loads(at)
            whole_means += (np.array([np.mean(inner**ROTATING_EXPONENT), np.mean(outer**STATIONARY_EXPONENT)]) - whole_means) / done
            add_lamina_powers(at.inner, at.outer, risers, 1.0 / done, inner_means, outer_means)
        whole = (float(mean ** (1 / exponent)) for mean, exponent in zip(whole_means, (ROTATING_EXPONENT, STATIONARY_EXPONENT)))
        equivalent = equivalent_lamina_loads(*whole, inner_means, outer_means, oil, life)
        lives = rate_lives(radial_load, equivalent, oil, life)
        rates = np.array([1.0 / lives.l10r, 1.0 / lives.lnmr])
        if done >= _MOST_PITCH_POSITIONS or (before is not None and (np.abs(rates - before) <= _LIFE_CHANGE * before).all()):
            return equivalent, lives
        before, places = rates, (np.arange(done) + 0.5) / done  # in the middles of those that are done


def _pressure(line_load, curvature_radius, reduced_modulus) -> float:
    """Return the maximum Hertzian pressure of a line contact [Pa], sqrt(q E'/(2 pi R)) with the load per length q [N/m]."""
    return float(math.sqrt(line_load * reduced_modulus / (2 * math.pi * curvature_radius)))


_INNER, _OUTER = "#b2451f", "#3c5f8a"


def plot_statics(path: Path, title: str, found: Statics) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(13, 7.4)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.25))
    _draw_around(figure.add_subplot(grid[:, 0], projection="polar"), found)
    for row, (name, slices) in enumerate((("inner", found.inner_slices), ("outer", found.outer_slices))):
        _draw_along(figure, figure.add_subplot(grid[row, 1]), name, slices, found)
    tilt = f"tilt {1e3 * found.tilt[0]:.3g} mrad, " if found.tilt[0] > 1e-9 else ""
    save(figure, path, f"{title}\n{tilt}L10 {hours(found.lives.l10)} by the load on the bearing, L10r {hours(found.lives.l10r)} by slices")


def _draw_around(axes, found):
    """Draw the loads as bars over the azimuth, y to the right and z up."""
    width = 2 * np.pi / len(found.azimuths)
    unit, newtons = larger_unit("N", found.outer)
    axes.bar(found.azimuths, found.outer / newtons, width=0.8 * width, color=_OUTER, alpha=0.45, label="on the outer raceway")
    axes.bar(found.azimuths, found.inner / newtons, width=0.5 * width, color=_INNER, label="on the inner raceway")
    axes.set_ylim(0, 1.08 * max(found.outer.max(), 1.0) / newtons)
    axes.set_title(f"roller loads [{unit}] by azimuth", fontsize=10)
    axes.tick_params(labelsize=8)
    axes.set_rlabel_position(100)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=9, ncols=2)


def _draw_along(figure, axes, name, slices, found):
    """Draw load per length over the position along the roller, one row per roller."""
    width = found.slice_middles[1] - found.slice_middles[0]
    edges = 1e3 * np.append(found.slice_middles - width / 2, found.slice_middles[-1] + width / 2)
    count = len(found.azimuths)
    # order the rollers by azimuth with the load line in the middle
    order = np.roll(np.arange(count), count // 2)
    shown = axes.pcolormesh(edges, np.arange(count + 1) - count // 2, 1e-3 * slices[order] / width, cmap="viridis", vmin=0.0)
    ticks = np.arange(-(count // 2), count - count // 2, max(count // 6, 1))
    axes.set_yticks(ticks + 0.5, [f"{tick * 360 / count:.0f}°" for tick in ticks])
    axes.set(ylabel="roller, from the load line", title=f"load per length on the {name} raceway")
    if name == "outer":
        axes.set_xlabel("along the roller, x [mm]")
    figure.colorbar(shown, ax=axes, label="N/mm")
