# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Idling with cold oil: slip over load and temperature, from ideal rolling and from a skid, by supply of oil and by time of run-up.

A cage that slips by more than `SKID` skids: the film shears as a whole.  What slips less creeps: a thinner oil lets it creep more, and that is
judged apart.  Y. Guo and J. Keller (Tribology International 148, 2020) measured slip to 60 % in a wind gearbox at low wind and cold oil, falling as
oil warms and load grows.
"""

import dataclasses
import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from bearing_sim.model.plausibility import minimum_load
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation, scene_inputs
from bearing_sim.sweep.pictures import new_figure, plain_numbers, save
from bearing_sim.sweep.settling import advance_until_settled, longest_run, shortest_run
from bearing_sim.sweep.states import states

SUPPLIES = ("oil_bath", "circulating", "oil_jet")
TEMPERATURES = (0.0, 10.0, 20.0, 40.0, 60.0, 80.0)  # degC
SHARES = (0.08, 0.15, 0.3, 0.45, 0.6, 0.8, 1.2, 1.8, 3.0)  # of the makers' minimum load
RUN_UPS = (0.3, 3.0, 30.0)  # s from rest to the operating speed
SKID = 0.1  # slip of a cage that skids
_SLOWEST = 1e-3  # of the operating speed, at which a run-up begins


class Point(NamedTuple):
    """Slip under one load at one temperature."""

    supply: str
    load: float  # [N]
    celsius: float
    rolling: float  # slip in the state that ideal rolling comes to
    skid: float  # and in the one that a skid comes to


class SkidLoad(NamedTuple):
    """The load below which a skid lasts."""

    supply: str
    celsius: float
    load: float  # [N]; 0 where none lasts


class RunUp(NamedTuple):
    """Slip after a run-up from rest with a standing cage."""

    supply: str
    load: float  # [N]
    celsius: float
    seconds: float  # of the run-up
    slip: float


class SkidMap(NamedTuple):
    """Slip of a bearing over load and temperature."""

    minimum_load: float  # of the makers, at the operating speed [N]
    points: tuple[Point, ...]
    skid_loads: tuple[SkidLoad, ...]


def _at(scene: Scene, supply: str, load: float, celsius: float) -> Scene:
    """Return a scene with another supply, load and oil temperature; at level steady, parts as warm as the oil."""
    overrides = [f"lubricant.supply={{law: {supply}}}", "lubricant.mixture_fraction=null", f"lubricant.temperature={celsius} degC", "heat.law=none"]
    changed = load_scene(scene, [*overrides, f"operating.radial_load={load}"])
    return changed.at_level("steady")


def skid_map(scene: Scene, supplies: Sequence[str] = SUPPLIES, temperatures: Sequence[float] = TEMPERATURES, loads: Sequence[float] = ()) -> SkidMap:
    """Return slip over load and temperature at the scene's shaft speed, by level steady.

    Parameters
    ----------
    scene : its bearing, oil and shaft speed count.
    supplies : laws of `bearing_sim.scene.lubricant.Supply`.
    temperatures : of the oil and of all parts [degC].
    loads : radial [N]; `SHARES` of the minimum load where there are none.
    """
    least = float(minimum_load(scene)[0])
    loads = loads or [share * least for share in SHARES]
    points, skid_loads = [], []
    for supply, celsius in itertools.product(supplies, temperatures):
        for index, load in enumerate(loads):
            found = states(_at(scene, supply, load, celsius), skid_load=index == 0)
            slips = [state.cage_slip for state in found.found] or [math.nan]
            points.append(Point(supply, load, celsius, slips[0], max(slips)))
            if index == 0:
                skid_loads.append(SkidLoad(supply, celsius, found.skid_load))
    return SkidMap(least, tuple(points), tuple(skid_loads))


def run_up(scene: Scene, supply: str, load: float, celsius: float, seconds: float) -> RunUp:
    """Return the slip to which a bearing settles after a run-up from rest under load, at level slip.

    Parameters
    ----------
    scene, supply, load, celsius : see `skid_map`.
    seconds : in which the shaft reaches the scene's speed.
    """
    at = _at(scene, supply, load, celsius).at_level("slip")
    speed = at.operating.shaft_speed
    simulation = Simulation(dataclasses.replace(at, operating=dataclasses.replace(at.operating, shaft_speed=_SLOWEST * speed)))
    simulation.advance(seconds, scene_inputs(at))
    outcome = advance_until_settled(simulation, shortest_run(at, 1.0), longest_run(at))
    return RunUp(supply, load, celsius, seconds, outcome.slip)


def run_ups(scene: Scene, found: SkidMap) -> list[RunUp]:
    """Return what run-ups lead to at the points of a map where the way in decides: those with two states, at most one for each supply."""
    first = {point.supply: point for point in found.points if point.skid - point.rolling > SKID}
    return [run_up(scene, *point[:3], each) for point in first.values() for each in RUN_UPS]


def plot_skid_map(found: SkidMap, path: Path, title: str) -> None:
    """Draw slip over load by temperature, a column for each supply, and the skid load over temperature below.

    Parameters
    ----------
    found : the map.
    path : of the picture.
    title : above it.
    """
    supplies = list(dict.fromkeys(point.supply for point in found.points))
    figure = new_figure(4.3 * len(supplies), 7.0)
    axes = figure.subplots(2, len(supplies), squeeze=False, sharey="row")
    shades = _shades(found)
    for supply, (above, below) in zip(supplies, axes.T):
        for celsius, shade in shades.items():
            points = [point for point in found.points if (point.supply, point.celsius) == (supply, celsius)]
            loads, look = [point.load / 1e3 for point in points], {"color": shade, "lw": 1.8}
            label = f"{celsius:g} °C" if supply == supplies[0] else None
            above.plot(loads, [100 * point.skid for point in points], marker=".", label=label, **look)
            above.plot(loads, [100 * point.rolling for point in points], ls=":", **look)
        line = sorted((each.celsius, each.load / 1e3) for each in found.skid_loads if each.supply == supply)
        below.plot(*zip(*line), "k.-", lw=1.8)
        for axis, along in ((above, above.axvline), (below, below.axhline)):
            along(found.minimum_load / 1e3, color="0.6", ls="--", lw=1.0)
            axis.grid(alpha=0.3)
        above.set(xscale="log", yscale="log", xlabel="radial load [kN]", title=supply.replace("_", " "))
        below.set(xlabel="oil temperature [°C]")
        plain_numbers(above.xaxis, above.yaxis)
    axes[0, 0].set_ylabel("cage slip [%]")
    axes[1, 0].set_ylabel("skid load [kN]")
    figure.legend(loc="outside lower center", ncols=len(shades), frameon=False)
    save(figure, path, f"{title}\nfrom a skid (line) and from rolling (dotted); minimum load (dashed)", 11)


def _shades(found: SkidMap) -> dict[float, str]:
    from matplotlib import colormaps, colors

    celsius = sorted(dict.fromkeys(point.celsius for point in found.points))
    return {each: colors.to_hex(colormaps["coolwarm"](k / max(len(celsius) - 1, 1))) for k, each in enumerate(celsius)}
