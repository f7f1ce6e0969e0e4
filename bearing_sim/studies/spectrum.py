# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The life of a bearing under a load spectrum: operating points with their shares of time, from a table or from the classes of a long log.

Damage adds up by Palmgren and Miner: with the share of time q_i and the life L_i in hours at each point, 1/L = sum of q_i/L_i.  Beside it stand the
mean values that catalogues use (SKF, NSK; ISO 281's exponent p = 10/3 of roller bearings):

    n_m = sum q_i n_i,    P_m = (sum q_i n_i P_i^p / n_m)^(1/p)

P_m at n_m has the L10 that the sum of the points gives.  Modified lives have no such mean: oil and speed change a_ISO from point to point.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.inputs.profile import InputProfile
from bearing_sim.model.turning import REST
from bearing_sim.scene.display import RPM, ZERO_CELSIUS, force, hours, number
from bearing_sim.scene.loader import scene_to_yaml
from bearing_sim.scene.scene import Scene
from bearing_sim.studies.columns import columns_of
from bearing_sim.studies.design import life_name
from bearing_sim.sweep.conditions import OperatingPoint, PointError, Spectrum, combined_life, scene_at_point, shares
from bearing_sim.sweep.pictures import COLOURS, new_figure, save
from bearing_sim.sweep.point import DURATION, LIVES, OK, OTHER_STATE, REFUSED, RESULTS, TEXTS, UNSETTLED, empty_row, point_row
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.tasks import IN_MEMORY, Execution, task

EXPONENT = 10.0 / 3.0
"""p of the life equation of roller bearings (ISO 281)."""

HEADLINE = "modified_rating_life"
"""The life that the scene chooses, by which damage is counted."""

COLUMNS = (*columns_of("spectrum"), *RESULTS, *OTHER_STATE, *TEXTS)


class Evaluated(NamedTuple):
    """The result of a load spectrum.

    Attributes
    ----------
    table : one row per point, see `COLUMNS`.
    lives : by name (`bearing_sim.sweep.point.LIVES`), of the whole spectrum [h]; NaN where a point has no result.
    mean_speed, mean_load : n_m [rad/s] and P_m [N] by ISO 281; NaN likewise.
    static_safety : the least S_0.
    resting : share of the time at rest.
    skid : share of the time in which the settled slip is above ``thresholds.slip_warning``.
    hours : of the whole spectrum; None where it has shares only.
    missing : share of the time at points without a result.
    """

    table: Table
    lives: dict[str, float]
    mean_speed: float
    mean_load: float
    static_safety: float
    resting: float
    skid: float
    hours: float | None
    missing: float

    @property
    def life(self) -> float:
        """The life that the scene chooses [h]."""
        return self.lives[HEADLINE]


def mean_speed_and_load(speeds: Sequence[float], loads: Sequence[float], weights: Sequence[float], exponent: float = EXPONENT) -> tuple[float, float]:
    """Return mean speed and equivalent load, n_m = sum q n and P_m = (sum q n P^p/n_m)^(1/p), of shares of time q.

    Parameters
    ----------
    speeds, loads : in any units, shape (n,); of speeds the magnitude counts.
    weights : of time, shape (n,).
    exponent : p of the life equation, 10/3 for roller bearings and 3 for ball bearings.
    """
    speeds, loads, weights = (np.abs(np.asarray(values, float)) for values in (speeds, loads, weights))
    turns = weights * speeds
    mean = float(turns.sum() / weights.sum())
    if not mean > 0.0:
        return mean, math.nan
    return mean, float(((turns * loads**exponent).sum() / turns.sum()) ** (1.0 / exponent))


def spectrum_of_log(profile: InputProfile, oil_temperature: float, classes: tuple[int, int, int]) -> Spectrum:
    """Return the load spectrum of a log: the time in each class of speed, load and oil temperature that it has.

    Classes are evenly wide up to the largest speed and load, and between the lowest and the highest temperature.  Each has the mean speed of its
    time, the load whose 10/3 power is that of its revolutions, and its mean temperature, so that classes lose little of the damage.  Time in gaps
    of the log is not counted; the sense of rotation and the direction of the load are not kept.

    Parameters
    ----------
    profile : of the log (`bearing_sim.inputs.profile.judge`).
    oil_temperature : [K] where the log has none.
    classes : numbers of classes of speed, load and temperature.
    """
    instants = profile.instants
    inputs = profile.at(instants, oil_temperature)
    seconds = np.diff(instants) * 1e-9
    for begin, end in profile.gaps:
        seconds[(instants[1:] > begin) & (instants[1:] <= end)] = 0.0
    speed, temperature = (0.5 * (each[1:] + each[:-1]) for each in (np.abs(inputs[:, 0]), inputs[:, 3]))
    load = np.hypot(*(0.5 * (inputs[1:, column] + inputs[:-1, column]) for column in (1, 2)))
    turning = (speed >= REST) & (seconds > 0.0)
    resting = float(seconds[speed < REST].sum())
    if not turning.any():
        raise PointError("the shaft stands throughout the log: there is no slip at rest, and no life is used")
    speed, load, temperature, seconds = speed[turning], load[turning], temperature[turning], seconds[turning]
    places = [_classes(values, low, count) for values, low, count in zip((speed, load, temperature), (0.0, 0.0, temperature.min()), classes)]
    _, place = np.unique(np.ravel_multi_index(places, classes), return_inverse=True)
    hours, turns = np.bincount(place, seconds) / 3600.0, np.bincount(place, seconds * speed)
    speeds = turns / (3600.0 * hours)
    loads = (np.bincount(place, seconds * speed * load**EXPONENT) / turns) ** (1.0 / EXPONENT)
    temperatures = np.bincount(place, seconds * temperature) / (3600.0 * hours)
    points = tuple(OperatingPoint(*each) for each in zip(speeds.tolist(), loads.tolist(), hours.tolist(), temperatures.tolist()))
    return Spectrum(points, float(hours.sum() + resting / 3600.0), resting / 3600.0)


def _classes(values: np.ndarray, low: float, count: int) -> np.ndarray:
    """Return in which of evenly wide classes from ``low`` to the largest value each value is, shape (n,)."""
    width = (values.max() - low) / count
    return np.minimum((values - low) // width, count - 1).astype(int) if width > 0.0 else np.zeros(len(values), int)


def evaluate(
    scene: Scene,
    spectrum: Spectrum,
    duration: float = DURATION,
    execution: Execution = IN_MEMORY,
) -> Evaluated:
    """Run a scene at each point of a load spectrum until it has settled, and add up the damage.

    Parameters
    ----------
    scene : what a point does not say is the scene's.
    spectrum : see `bearing_sim.sweep.conditions.Spectrum`.
    duration : see `bearing_sim.sweep.grid.run_sweep`.
    execution : see `bearing_sim.sweep.tasks.Execution`.
    """
    points = spectrum.points
    scenes = [_at(scene, point) for point in points]
    found = iter(execution.run([task(each.level, point_row, each, duration) for each in scenes if isinstance(each, Scene)]))
    results = [next(found) if isinstance(each, Scene) else empty_row(REFUSED, str(each)) for each in scenes]
    results = [row if "l10" in row else empty_row(row["status"], row["reason"]) for row in results]  # of a lost worker
    turning = 1.0 - spectrum.resting / (spectrum.resting + math.fsum(point.weight for point in points))
    parts = [turning * share for share in shares(points)]
    lives = {name: combined_life([row[name] for row in results], points) / turning for name in LIVES}
    mean_speed, mean_load = mean_speed_and_load(
        [*(point.shaft_speed for point in points), 0.0], [*(row["equivalent_load"] for row in results), 0.0], [*parts, 1.0 - turning]
    )
    has_result = [row["status"] in (OK, UNSETTLED) for row in results]
    skids = (row["cage_slip"] > 100.0 * scene.thresholds.slip_warning and point.radial_load > 0.0 for row, point in zip(results, points))
    rows = [
        _conditions(scene, point, share, spectrum.hours) | {"damage_share": 100.0 * share * lives[HEADLINE] / row[HEADLINE]} | row
        for point, share, row in zip(points, parts, results)
    ]
    static_safety = min(row["static_safety"] for row in results)
    about = {
        "kind": "spectrum",
        "scene": scene.name,
        "level": scene.level,
        "life": life_name(scene),
        "duration": duration,
        "version": package_version(),
        "commit": git_hash(),
        "scene_yaml": scene_to_yaml(scene),
        "summary": {
            f"life ({life_name(scene)})": "not given: some points have no result" if math.isnan(lives[HEADLINE]) else hours(lives[HEADLINE]),
            "L10, L_nm, L10r, L_nmr": ", ".join(hours(lives[name]) for name in ("l10", "lnm", "l10r", "lnmr")),
            "mean load at mean speed (ISO 281)": f"{force(mean_load)} at {number(RPM * mean_speed, 5)} rpm",
            "least static safety S_0": number(static_safety, 3),
        },
    }
    return Evaluated(
        Table(COLUMNS, [{column.name: row[column.name] for column in COLUMNS} for row in rows], about),
        lives,
        mean_speed,
        mean_load,
        static_safety,
        1.0 - turning,
        math.fsum(share for share, is_skid in zip(parts, skids) if is_skid),
        spectrum.hours,
        math.fsum(share for share, known in zip(parts, has_result) if not known),
    )


def _at(scene: Scene, point: OperatingPoint) -> Scene | PointError:
    try:
        return scene_at_point(scene, point)
    except PointError as error:
        return error


def _conditions(scene: Scene, point: OperatingPoint, share: float, hours: float | None) -> dict[str, float]:
    oil = scene.lubricant.temperature if point.oil_temperature is None else point.oil_temperature
    return {
        "share": 100.0 * share,
        "hours": math.nan if hours is None else share * hours,
        "shaft_speed": RPM * point.shaft_speed,
        "radial_load": point.radial_load,
        "axial_load": scene.operating.axial_load if point.axial_load is None else point.axial_load,
        "oil_temperature": oil - ZERO_CELSIUS,
    }


def plot_spectrum(path: Path | BinaryIO, table: Table, most: int = 20) -> None:
    """Draw share of time, load and share of damage of each point as bars, the most harmful first.

    Parameters
    ----------
    path : its suffix gives the format: .png, .svg or .pdf; or a stream, for .png.
    table : of `evaluate`.
    most : points that are drawn.
    """
    rows = by_damage(table)
    shown, count = rows[:most], len(rows)
    figure = new_figure(9, 1.6 + 0.3 * len(shown))
    panels = figure.subplots(1, 3, sharey=True)
    names = [f"{number(row['shaft_speed'], 4)} rpm, {number(row['oil_temperature'], 3)} °C" for row in shown]
    drawn = (("share", "share of the time [%]", 1.0), ("radial_load", "radial load [kN]", 1e-3), ("damage_share", "share of the damage [%]", 1.0))
    for axes, (quantity, heading, scale), colour in zip(panels, drawn, COLOURS):
        values = [scale * row[quantity] for row in shown]
        axes.barh(range(len(shown)), np.nan_to_num(values), color=colour)
        axes.set(xlabel=heading, yticks=range(len(shown)), yticklabels=names)
        axes.grid(axis="x", alpha=0.3)
        axes.set_axisbelow(True)
    panels[0].set_ylim(len(shown) - 0.4, -0.6)
    rest = f"; the {most} most harmful of {count} points" if count > most else ""
    save(figure, path, f"{table.about['scene']} at level {table.about['level']}: life by point{rest}", 10)


def by_damage(table: Table) -> list[dict]:
    """Return the rows of a table, the most harmful first; those without a result come before all others."""
    return sorted(table.rows, key=lambda row: (not math.isnan(row[HEADLINE]), row[HEADLINE] / row["share"]))
