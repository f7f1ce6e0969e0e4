# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Published findings about slip that have a direction but no digits that a model could be held to: does the model find the same?

The rig: an NU 215 under radial loads about the maker's minimum (Dawoud, Beitler and Schwarze 2022, Slip characteristics in cylindrical roller
bearings, parts I and III, Journal of Tribology 145): slip-free only above the minimum load; below it slip rises with speed and with the oil's
flow; a roller-guided cage slips least, a full complement more; a tight clearance under tight fits preloads all rollers and ends slip.
The gearbox: cylindrical roller bearings of a wind turbine (Guo and Keller 2020, Tribology International 148): slip to 60 % at low wind and cold
oil, falling as oil warms and load grows.  Loads of gearbox and rig, oil and cage masses are assumptions of the bundled scenes.
"""

import itertools
import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from bearing_sim.model.plausibility import minimum_load
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.studies.cold_oil import SKID
from bearing_sim.sweep.point import run_until_settled

RIG, GEARBOX = "nu215_rig", "nu232_wind_gearbox"
NO_SLIP = 0.02  # cage slip that counts as none
_NEAR = 1e-3  # cage slips that count as equal
_SPEEDS = (1000, 3000, 5000)  # rpm
_SHARES = (0.1, 0.3, 1.0, 2.0, 4.0)  # of the minimum load
_FLOWS, _USUAL_FLOW = (0.01, 0.03, 0.1), 0.03  # mixture fraction
_ROLLER_GUIDED = ("bearing.cage.guidance=roller", "bearing.cage.outer_diameter=115.2mm")
_PRELOAD = "bearing.outer_raceway.diameter=118.49mm"  # 10 um less than rollers and inner raceway
_TEMPERATURES = (0, 20, 40, 60, 80)  # degC
_WINDS = (0.0, 0.02, 0.1, 0.5, 1.0)  # of the gearbox's nominal load
_NOMINAL, _IDLING = 60e3, 300.0  # N, assumptions
_LIGHT = (300.0, 1000.0, 2000.0)  # N, loads of an idling gearbox; its maker's minimum is 6570 N at 1,500 rpm


class Finding(NamedTuple):
    """A published finding and what the model says of it.

    Attributes
    ----------
    claim : the finding, in words.
    source : who published it.
    figures : what the model finds, in words.
    holds : whether it finds the same.
    """

    claim: str
    source: str
    figures: str
    holds: bool


class Point(NamedTuple):
    """Slip of the rig at a speed, a share of the minimum load and a mixture fraction."""

    speed: float  # rpm
    share: float  # of the minimum load
    flow: float  # mixture fraction
    slip: float


def findings(level: str = "slip") -> list[Finding]:
    """Return all findings at a level of fidelity, ``slip`` or ``planar``."""
    return [*rig_findings(level), *gearbox_findings(level)]


def rig_findings(level: str = "slip") -> list[Finding]:
    """Return the findings of the NU 215 rig; see `findings`."""
    points = [Point(*at, rig_slip(level, *at)) for at in itertools.product(_SPEEDS, _SHARES, _FLOWS) if at[1] < 1.0 or at[2] == _USUAL_FLOW]
    below = [point for point in points if point.share < 1.0]
    usual = {(point.speed, point.share): point.slip for point in points if point.flow == _USUAL_FLOW}
    light = [key for key in usual if key[1] < 1.0]
    guided = {key: rig_slip(level, *key, _USUAL_FLOW, _ROLLER_GUIDED) for key in light}
    tight = {key: rig_slip(level, *key, _USUAL_FLOW, (_PRELOAD,)) for key in light}
    above = [point for point in points if point.share >= 1.0]
    return [
        Finding(
            f"free of slip (at most {100 * NO_SLIP:g} %) only above the maker's minimum load",
            "Dawoud 2022, part I",
            "; ".join(f"{speed} rpm: {_by(above, speed)} times it" for speed in _SPEEDS),
            all(point.slip <= NO_SLIP for point in above if point.share == _SHARES[-1]) and all(point.slip > NO_SLIP for point in below),
        ),
        Finding(
            "free of slip from the minimum load on",
            "the maker's rule",
            f"at the minimum load {_percents(usual[speed, 1.0] for speed in _SPEEDS)}, "
            f"at twice it {_percents(usual[speed, 2.0] for speed in _SPEEDS)}",
            all(point.slip <= NO_SLIP for point in above),
        ),
        Finding(
            "below the minimum load slip rises with speed",
            "Dawoud 2022, part I",
            "; ".join(f"{share:g} of the minimum load: {_percents(usual[speed, share] for speed in _SPEEDS)}" for share in _SHARES if share < 1.0),
            _rises(below, lambda point: point.speed, lambda point: (point.share, point.flow)),
        ),
        Finding(
            "below the minimum load slip rises with the quantity of oil",
            "Dawoud 2022, part I",
            "; ".join(f"{speed} rpm: {_percents(point.slip for point in below if point.speed == speed and point.share == 0.3)}" for speed in _SPEEDS),
            _rises(below, lambda point: point.flow, lambda point: (point.speed, point.share)),
        ),
        Finding(
            "a cage guided by the rollers slips less than one guided by the outer ring",
            "Dawoud 2022, part I",
            "; ".join(
                f"{speed:g} rpm, {share:g} of the minimum load: {_percents((guided[speed, share], usual[speed, share]))}"
                for speed, share in usual
                if share == 0.3
            ),
            all(guided[key] < usual[key] for key in light),
        ),
        Finding(
            "a tight clearance that preloads all rollers ends slip",
            "Dawoud 2022, part III",
            "; ".join(
                f"{speed:g} rpm, {share:g} of the minimum load: {_percents((usual[speed, share], tight[speed, share]))}"
                for speed, share in usual
                if share == 0.1
            ),
            all(slip <= NO_SLIP for slip in tight.values()),
        ),
    ]


def gearbox_findings(level: str = "slip") -> list[Finding]:
    """Return the findings of the wind gearbox; see `findings`."""
    idling = {load: [gearbox_slip(level, degrees, load / _NOMINAL) for degrees in _TEMPERATURES] for load in _LIGHT}
    figures = "; ".join(f"{load:g} N: {_percents(slips)}" for load, slips in idling.items())
    cold = [gearbox_slip(level, 20, wind) for wind in _WINDS]
    return [
        Finding(
            "idling with cold oil, slip reaches tens of per cent",
            "Guo and Keller 2020",
            f"{', '.join(map(str, _TEMPERATURES))} degC, {figures}",
            all(max(slips) >= 0.2 for slips in idling.values()),
        ),
        Finding(
            "idling, a skid falls as the oil warms",
            "Guo and Keller 2020",
            f"{figures}; over loads and supplies: bearing-sim study cold-oil {GEARBOX}",
            all(warm < cold for slips in idling.values() for cold, warm in itertools.pairwise(slips) if cold > SKID),
        ),
        Finding(
            "with cold oil, slip falls as the load grows",
            "Guo and Keller 2020",
            f"20 degC, {', '.join(f'{100 * wind:g}' for wind in _WINDS)} % of {1e-3 * _NOMINAL:g} kN: {_percents(cold)}",
            all(b <= a + _NEAR for a, b in itertools.pairwise(cold)) and cold[-1] <= NO_SLIP,
        ),
    ]


def rig_slip(level: str, speed: float, share: float, flow: float, overrides: Iterable[str] = ()) -> float:
    """Return the cage slip of the rig.

    Parameters
    ----------
    level : of fidelity.
    speed : of the shaft [rpm].
    share : radial load over the maker's minimum load at that speed.
    flow : mixture fraction.
    overrides : further fields of the scene.
    """
    at = [f"level={level}", f"operating.shaft_speed={speed}rpm", f"lubricant.mixture_fraction={flow}", *overrides]
    least, _ = minimum_load(load_scene(RIG, at))
    return _slip(load_scene(RIG, [*at, f"operating.radial_load={share * least}"]))


def gearbox_slip(level: str, degrees: float, wind: float) -> float:
    """Return the cage slip of the gearbox's bearing at a temperature of the oil [degC] and a share of its nominal load."""
    load = max(_IDLING, wind * _NOMINAL)
    return _slip(load_scene(GEARBOX, [f"level={level}", f"lubricant.temperature={degrees} degC", f"operating.radial_load={load}"]))


def _slip(scene: Scene) -> float:
    return run_until_settled(scene).slip


def _rises(points: Iterable[Point], over: Callable, group: Callable) -> bool:
    """Whether slip rises over a variable within every group of points."""
    groups: dict = {}
    for point in sorted(points, key=over):
        groups.setdefault(group(point), []).append(point.slip)
    return all(a < b for slips in groups.values() for a, b in itertools.pairwise(slips))


def _by(points: Iterable[Point], speed: float) -> str:
    return ", ".join(f"{100 * point.slip:.1f} % at {point.share:g}" for point in points if point.speed == speed)


def _percents(slips: Iterable[float]) -> str:
    return ", ".join("none" if math.isnan(slip) else f"{100 * slip:.1f}" for slip in slips) + " %"
