# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Statics of a scene: the load distribution over rollers and slices at constant conditions, and the resulting lives."""

import dataclasses
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.slice_balance import about_yz, balance, leaning, roller_loads, roller_tilts
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import lubricate_scene
from bearing_sim.physics.film import DOWSON_HIGGINSON, films
from bearing_sim.physics.growth import Clearance, clearance_at, total_growth
from bearing_sim.physics.lamina_life import EquivalentLoads, add_lamina_powers, equivalent_lamina_loads, stress_risers
from bearing_sim.physics.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT, Lives, oil_factors, rate_lives
from bearing_sim.scene.scene import Scene
from bearing_sim.sweep.table import new_figure

_PITCH_POSITIONS = 10  # cage angles over one roller pitch for the lives


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
    clearance: Clearance  # of the running bearing, with its parts
    film: float  # least film thickness of the most heavily loaded contact [m]; NaN at rest and without load


def with_slices(scene: Scene, slices: int) -> Scene:
    """Return a scene with another number of slices per roller."""
    roller = dataclasses.replace(scene.bearing.roller, slices=slices)
    return dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, roller=roller))


def statics(scene: Scene, slices: int) -> Statics:
    """Return the statics of a scene at its constant conditions and without cage slip.

    Parameters
    ----------
    scene : of any level.
    slices : per roller, instead of the scene's number.

    Raises
    ------
    ArithmeticError
        No balance was found.
    """
    scene = with_slices(scene, slices)
    scene = dataclasses.replace(scene, life=dataclasses.replace(scene.life, laminae=slices))  # the slices are the laminae
    params, operating = pack(scene), scene.operating
    count, raceways = params.rollers.count, params.raceways
    cage_speed = 0.5 * operating.shaft_speed * (1.0 - raceways.diameter_ratio)
    load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
    moment = about_yz(operating.moment or 0.0, operating.moment_angle)
    tilts = about_yz(operating.misalignment, operating.misalignment_angle) if operating.moment is None else None

    lubrication = lubricate_scene(scene, params, scene.lubricant.temperature)
    growth = total_growth(operating.shaft_speed, lubrication.growth)

    inner_means, outer_means, risers = np.zeros(slices), np.zeros(slices), stress_risers(slices)
    rotating, stationary, at = 0.0, 0.0, None
    for position in reversed(range(_PITCH_POSITIONS)):  # the last one has roller 0 on the load line
        angle = operating.load_angle + 2 * math.pi * position / (_PITCH_POSITIONS * count)
        at = balance(params, angle, cage_speed, load, moment, tilts, at, growth)
        inner, outer = roller_loads(at)
        rotating += np.mean(inner**ROTATING_EXPONENT) / _PITCH_POSITIONS
        stationary += np.mean(outer**STATIONARY_EXPONENT) / _PITCH_POSITIONS
        add_lamina_powers(at.inner, at.outer, risers, 1.0 / (_PITCH_POSITIONS - position), inner_means, outer_means)

    whole = float(rotating ** (1 / ROTATING_EXPONENT)), float(stationary ** (1 / STATIONARY_EXPONENT))
    speed = abs(operating.shaft_speed)
    oil = oil_factors(speed, lubrication.kinematic_viscosity, 2 * raceways.pitch_radius, params.life)
    equivalent = equivalent_lamina_loads(*whole, inner_means, outer_means, oil, params.life)
    lives = rate_lives(operating.radial_load, equivalent, oil, params.life)
    hours = 2 * math.pi / (3600 * speed) if speed > 0.0 else math.inf
    width = params.rollers.length / slices
    return Statics(
        azimuths=operating.load_angle + 2 * math.pi * np.arange(count) / count,
        inner=inner,
        outer=outer,
        tilts=roller_tilts(at),
        slice_middles=at.position * at.half_length,
        inner_slices=at.inner.copy(),
        outer_slices=at.outer.copy(),
        inner_pressure=_pressure(at.inner.max() / width, raceways.inner_curvature_radius, raceways.reduced_modulus),
        outer_pressure=_pressure(at.outer.max() / width, raceways.outer_curvature_radius, raceways.reduced_modulus),
        ring=(float(at.ring[0]), float(at.ring[1])),
        tilt=leaning(float(at.ring[2]), float(at.ring[3])),
        moment=leaning(float(at.reaction[2]), float(at.reaction[3])),
        equivalent_loads=equivalent,
        lives=lives._replace(**{name: hours * getattr(lives, name) for name in ("basic", "modified", "l10", "lnm", "l10r", "lnmr")}),
        clearance=clearance_at(operating.shaft_speed, lubrication.growth, params),
        film=_least_film(scene, params, speed, float(inner.max())),
    )


def _least_film(scene, params, shaft_speed, load) -> float:
    """Return the least film thickness of the inner contact under a load [N] in ideal rolling, the thinnest of all [m]."""
    if not shaft_speed > 0.0 or not load > 0.0:
        return math.nan
    raceways = params.raceways
    rolling = 0.5 * shaft_speed * raceways.inner_radius * (1.0 + raceways.diameter_ratio)  # both surfaces, seen from the contact
    oil = oil_at(scene.lubricant.oil, scene.lubricant.temperature)
    contact = raceways.inner_curvature_radius, raceways.reduced_modulus, params.rollers.length
    return float(films(DOWSON_HIGGINSON, oil, *contact, np.array(load), np.array(rolling), np.array(0.0)))


def _pressure(line_load, curvature_radius, reduced_modulus) -> float:
    """Return the maximum Hertzian pressure of a line contact [Pa], sqrt(q E'/(2 pi R)) with the load per length q [N/m]."""
    return float(math.sqrt(line_load * reduced_modulus / (2 * math.pi * curvature_radius)))


_INNER, _OUTER = "#b2451f", "#3c5f8a"


def draw(path: Path, title: str, found: Statics) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(13, 7.4)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.25))
    _draw_around(figure.add_subplot(grid[:, 0], projection="polar"), found)
    for row, (name, slices) in enumerate((("inner", found.inner_slices), ("outer", found.outer_slices))):
        _draw_along(figure, figure.add_subplot(grid[row, 1]), name, slices, found)
    tilt = f"tilt {1e3 * found.tilt[0]:.3g} mrad, " if found.tilt[0] > 1e-9 else ""
    figure.suptitle(f"{title}\n{tilt}L10 {_hours(found.lives.l10)} by the load on the bearing, L10r {_hours(found.lives.l10r)} by slices")
    figure.savefig(path, dpi=130)


def _hours(life):
    return f"{life:.4g} h" if np.isfinite(life) else "infinite"


def _draw_around(axes, found):
    """Draw the loads as bars over the azimuth, y to the right and z up."""
    width = 2 * np.pi / len(found.azimuths)
    axes.bar(found.azimuths, found.outer, width=0.8 * width, color=_OUTER, alpha=0.45, label="on the outer raceway")
    axes.bar(found.azimuths, found.inner, width=0.5 * width, color=_INNER, label="on the inner raceway")
    axes.set_ylim(0, 1.08 * max(found.outer.max(), 1.0))
    axes.set_title("roller loads [N] by azimuth", fontsize=10)
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
