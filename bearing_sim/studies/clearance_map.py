# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Running clearance over speed and load, at the temperatures that belong to each point, and the speeds at which something is lost.

Preload that heat closes brings more heat, and closes further.  At each point of a grid the bearing is in thermal equilibrium where its scene has
a thermal network, at given temperatures or as warm as its oil otherwise.  Where the clearance, the fit of the shaft, the life or the equilibrium
is lost between two speeds of the grid, bisection finds the speed.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.model.running_clearance import mounted, seat_pressure
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.model.thermal_network import POWERS
from bearing_sim.scene.display import RPM, ZERO_CELSIUS, force, hours
from bearing_sim.scene.fidelity import ENDLESS
from bearing_sim.scene.scene import Integration, Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation
from bearing_sim.studies.columns import columns_of
from bearing_sim.studies.sheet import CLEARANCES
from bearing_sim.sweep.pictures import as_shown, draw_map, new_figure, no_result_patch, on_grid, plain_numbers, save, set_limits, with_gaps
from bearing_sim.sweep.point import FAILED, OK
from bearing_sim.sweep.table import Table

NO_EQUILIBRIUM = "no_equilibrium"
SPEED, LOAD = "operating.shaft_speed", "operating.radial_load"
_NEAR = 1e-4  # of a speed, to which bisection finds it
_LEAP = 10.0  # K; a bearing that is farther from the limit of its scene where equilibrium ends does not pass the limit but runs away
COLUMNS = columns_of("clearance")


class Loss(NamedTuple):
    """Something that a bearing loses between two speeds.

    Attributes
    ----------
    radial_load : at which [N].
    kind : ``clearance``, ``fit``, ``life``; ``runaway``: thermal equilibrium, where there is none at any temperature; ``limit``: where its
        hottest part passes the limit of the scene.
    shaft_speed : at which it is lost, or found again [rad/s].
    regained : whether it is there above that speed, and not below.
    values : the row there (see `COLUMNS`); at the end of equilibrium that of the last speed that has one.
    reason : why there is no equilibrium; empty where there is one.
    """

    radial_load: float
    kind: str
    shaft_speed: float
    regained: bool
    values: dict
    reason: str


class ClearanceMap(NamedTuple):
    """Results: a row for each speed and load, what is lost where, and the least life that counts as one [h]."""

    table: Table
    losses: tuple[Loss, ...]
    least_life: float


def at_level_steady(scene: Scene) -> Scene:
    """Return a scene at level steady, with its default integration.

    Raises
    ------
    pydantic.ValidationError
        The scene asks for what that level leaves out.
    """
    return scene if scene.level == "steady" else replace(scene, level="steady", level_reason="", integration=Integration())


def row_at(scene: Scene, shaft_speed: float, radial_load: float) -> dict:
    """Return the results of a scene at a speed and a load, by the names of `COLUMNS` and in their units; NaN where there is none.

    Parameters
    ----------
    scene : at level steady.
    shaft_speed : [rad/s].
    radial_load : in the direction of the scene's load [N].
    """
    angle, oil = scene.operating.load_angle, scene.lubricant.temperature
    inputs = Inputs(shaft_speed, radial_load * math.cos(angle), radial_load * math.sin(angle), oil)
    row = {column.name: math.nan for column in COLUMNS} | {SPEED: shaft_speed * RPM, LOAD: radial_load, "status": OK, "reason": ""}
    nodes = None
    if scene.heat.law == "network":
        found = thermal_equilibrium(scene, inputs)
        nodes = found.temperatures
        row |= {"heat_to_oil": found.heat_to_oil, "heat_to_ambient": found.heat_to_ambient}
        if not found.converged:
            status = NO_EQUILIBRIUM if found.temperatures.max() >= scene.heat.limit else FAILED
            return row | {"running_clearance": 1e6 * found.clearance, "status": status, "reason": found.reason}
    try:
        simulation = Simulation(scene, inputs, empty_table())
        if nodes is not None:
            simulation.set_temperatures(nodes)
        samples = simulation.advance(ENDLESS, samples=2)
    except IntegrationError as error:
        return row | {"status": FAILED, "reason": str(error)}
    sample, parts = samples[-1], mounted(scene.bearing, scene.mounting)
    row |= {name: 1e6 * float(sample[name]) for name in CLEARANCES}
    row |= {name: float(sample[name]) - ZERO_CELSIUS for name in NODE_OBSERVABLES}
    losses = sum(float(sample[name]) for name in POWERS)
    row |= {"cage_slip": 100.0 * float(sample["cage_slip"]), "life": float(sample["modified_rating_life"]), "loss": losses}
    return row | {"seat_pressure": 1e-6 * float(seat_pressure(parts, sample)) if parts.shaft.fitted else math.nan}


def map_clearance(
    scene: Scene, speeds: Sequence[float], loads: Sequence[float], least_life: float, progress: Callable[[int], None] = lambda done: None
) -> ClearanceMap:
    """Return the running clearance over speed and load, and the speeds at which something is lost.

    Parameters
    ----------
    scene : see `at_level_steady`.
    speeds : [rad/s], ascending.
    loads : [N].
    least_life : below which the life counts as lost [h].
    progress : called with the number of finished points of the grid.
    """
    scene, rows, losses = at_level_steady(scene), [], []
    for load in loads:
        line = []
        for speed in speeds:
            line.append(row_at(scene, speed, load))
            progress(len(rows) + len(line))
        losses += _lost(scene, line, speeds, load, least_life)
        rows += line
    return ClearanceMap(Table(COLUMNS, rows, _about(scene, speeds, loads)), tuple(losses), least_life)


def _margins(row: dict, least_life: float) -> dict[str, float]:
    """Return for each kind of loss a number that is positive as long as nothing is lost; NaN where that is not known."""
    too_hot, failed = row["status"] == NO_EQUILIBRIUM, row["status"] == FAILED
    return {
        "equilibrium": math.nan if failed else -1.0 if too_hot else 1.0,
        "clearance": math.nan if too_hot or failed else row["running_clearance"],
        "fit": row["seat_pressure"],
        "life": row["life"] - least_life,
    }


def _lost(scene: Scene, line: list[dict], speeds: Sequence[float], load: float, least_life: float) -> list[Loss]:
    found = []
    for kind in _margins(line[0], least_life):
        signs = [_margins(row, least_life)[kind] for row in line]
        for k in range(len(line) - 1):
            if (signs[k] > 0.0) != (signs[k + 1] > 0.0) and not math.isnan(signs[k] + signs[k + 1]):
                found.append(_bisect(scene, kind, (speeds[k], line[k]), (speeds[k + 1], line[k + 1]), load, least_life))
    return sorted(found, key=lambda each: each.shaft_speed)


def _bisect(scene: Scene, kind: str, below: tuple[float, dict], above: tuple[float, dict], load: float, least_life: float) -> Loss:
    """Return where between two speeds, each with its row, a margin changes its sign."""
    held_below = _margins(below[1], least_life)[kind] > 0.0
    while above[0] - below[0] > _NEAR * above[0]:
        middle = 0.5 * (below[0] + above[0])
        row = row_at(scene, middle, load)
        margin = _margins(row, least_life)[kind]
        held = margin > 0.0 or math.isnan(margin) and row["status"] == OK
        below, above = ((middle, row), above) if held == held_below else (below, (middle, row))
    row = below[1] if held_below else above[1]
    reason = (above if held_below else below)[1]["reason"]
    if kind == "equilibrium":
        hottest = max(row[name] for name in NODE_OBSERVABLES)
        kind = "runaway" if scene.heat.limit - ZERO_CELSIUS - hottest > _LEAP else "limit"
    return Loss(load, kind, 0.5 * (below[0] + above[0]), not held_below, row, reason)


def in_words(found: ClearanceMap) -> list[str]:
    """Return what was found, a sentence for each loss and one for the highest speed of each load, by load."""
    lines = []
    for load in dict.fromkeys(found.table.values(LOAD)):
        said = [_said(each, found.least_life) for each in found.losses if each.radial_load == load]
        row = [each for each in found.table.rows if each[LOAD] == load][-1]
        if row["status"] == OK:
            said.append(f"at {row[SPEED]:,.0f} rpm {_state(row)}")
        elif not said:
            said.append(f"at {row[SPEED]:,.0f} rpm {row['reason']}")
        lines.append(f"at {force(load)}: {'; '.join(said)}")
    return lines


def _said(loss: Loss, least_life: float) -> str:
    speed, row = f"{loss.shaft_speed * RPM:,.0f} rpm", loss.values
    if loss.kind in ("runaway", "limit"):
        side = "below" if loss.regained else "above"
        text = f"thermal runaway {side} {speed}" if loss.kind == "runaway" else f"too hot {side} {speed}"
        warmth = f"inner ring {row['inner_ring_temperature']:.0f} °C, outer ring {row['outer_ring_temperature']:.0f} °C"
        return f"{text}: {loss.reason.partition(';')[0]}; next to it {_state(row)}, {warmth}"
    if loss.kind == "clearance":
        return f"clearance is {'back above' if loss.regained else 'gone at'} {speed}"
    if loss.kind == "fit":
        return f"the fit of the shaft {'holds above' if loss.regained else 'is lost at'} {speed}"
    return f"life {'is above' if loss.regained else 'falls below'} {hours(least_life)} at {speed}{_left(row)}"


def _left(row: dict) -> str:
    clearance = row["running_clearance"]
    return f" with {clearance:.1f} µm left" if clearance > 0.0 else f" with a preload of {-clearance:.1f} µm"


def _state(row: dict) -> str:
    return f"life is {hours(row['life'], 3)} and slip {row['cage_slip']:.2f} %{_left(row)}"


def _about(scene: Scene, speeds: Sequence[float], loads: Sequence[float]) -> dict:
    return {
        "kind": "clearance",
        "scene": scene.name,
        "level": scene.level,
        "heat": scene.heat.law,
        "axes": [
            {"field": SPEED, "unit": "rpm", "values": [speed * RPM for speed in speeds]},
            {"field": LOAD, "unit": "N", "values": list(loads)},
        ],
        "version": package_version(),
        "commit": git_hash(),
    }


_DRAWN = (("running_clearance", "RdBu"), ("inner_ring_temperature", "inferno"), ("cage_slip", "viridis"), ("life", "viridis"))
_LINES = {
    "clearance": ("clearance gone", "-"),
    "fit": ("fit of the shaft lost", ":"),
    "life": ("life too short", "--"),
    "runaway": ("thermal runaway", "-."),
    "limit": ("too hot", "-."),
}
_NEAR_LEAST = 100.0  # times the least life, below which a life is shown beside it
_STACKED = (("initial_clearance", "#7a7a7a"), ("fit_clearance", "#0072b2"), ("rotation_clearance", "#e69f00"), ("heat_clearance", "#d55e00"))
_NODE_COLOURS = ("#000000", "#d55e00", "#e69f00", "#009e73", "#0072b2", "#cc79a7")


def plot_clearance_map(path: Path, title: str, found: ClearanceMap) -> None:
    """Draw maps over speed and load, or lines over speed where there is one load; the suffix of ``path`` gives the format."""
    figure = new_figure(11.5, 8.4)
    axes = figure.subplots(2, 2)
    if len(set(found.table.values(LOAD))) > 1:
        for each, (name, colours) in zip(axes.flat, _DRAWN):
            _draw_map(each, found, name, colours)
        handles = axes.flat[0].get_legend_handles_labels()[0]
        if any(row["status"] != OK for row in found.table.rows):
            handles.append(no_result_patch())
        if handles:
            figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    else:
        _draw_lines(list(axes.flat), found)
    save(figure, path, title, 11)


def _draw_map(axes, found, name, colours) -> None:
    from matplotlib.patheffects import withStroke

    table = found.table
    across, up, field = on_grid(table, SPEED, LOAD, name)
    if name == "running_clearance":
        field = np.where(np.isnan(on_grid(table, SPEED, LOAD, "life")[2]), np.nan, field)  # without equilibrium it is that of the last trial
        colours = colours if (field < 0.0).any() and (field > 0.0).any() else "Reds_r" if (field < 0.0).any() else "Blues"
    x, y, quantity = (as_shown(each, table.column(each).unit, values) for each, values in ((SPEED, across), (LOAD, up), (name, field)))
    draw_map(axes, x, y, quantity, colours, centre=0.0 if name == "running_clearance" else None)
    for kind, (label, style) in _LINES.items():
        at = [(each.shaft_speed * RPM, each.radial_load * y.values[-1] / up[-1]) for each in found.losses if each.kind == kind]
        if at:
            line, *_ = axes.plot(*zip(*at), style, marker="o", ms=3, color="#7b1fa2", lw=1.8, label=label)
            line.set_path_effects([withStroke(linewidth=3.6, foreground="white")])


def _draw_lines(axes, found) -> None:
    table, rows = found.table, [row for row in found.table.rows if row["status"] == OK]
    clearance, warmth, slip, life = axes

    def plot(axes, name, style="-", **look):
        axes.plot([row[SPEED] for row in rows], with_gaps([row[name] for row in rows]), style, **look)

    plot(clearance, "running_clearance", "k-o", ms=4, lw=2, label="running clearance")
    for name, colour in _STACKED:
        plot(clearance, name, color=colour, lw=1.2, label=name.removesuffix("_clearance"))
    clearance.axhline(0.0, color="0.5", lw=0.8)
    clearance.set_ylabel("clearance and its parts [µm]")
    for name, colour in zip(NODE_OBSERVABLES, _NODE_COLOURS):
        plot(warmth, name, color=colour, lw=1.4, label=name.removesuffix("_temperature").replace("_", " "))
    warmth.set_ylabel("temperature [°C]")
    plot(slip, "cage_slip", "-o", ms=4, color="#0072b2")
    slip.set(ylabel="cage slip [%]", ylim=(0.0, None))
    plot(life, "life", "-o", ms=4, color="#009e73")
    life.set_ylabel("life [h]")
    lives = np.array([row["life"] for row in rows])
    finite = lives[np.isfinite(lives)]
    set_limits(life, np.append(finite, found.least_life) if (finite < _NEAR_LEAST * found.least_life).any() else finite, True)
    life.axhline(found.least_life, color="0.5", lw=0.8)
    for each in axes:
        each.set(xlabel="shaft speed [rpm]", xlim=(min(table.values(SPEED)), max(table.values(SPEED))))
        plain_numbers(each.xaxis)
        each.grid(alpha=0.3)
        for loss in found.losses:
            label, style = _LINES[loss.kind]
            each.axvline(loss.shaft_speed * RPM, color="#7b1fa2", ls=style, lw=1.0, label=label if each is clearance else None)
    clearance.legend(fontsize=8)
    warmth.legend(fontsize=8)
