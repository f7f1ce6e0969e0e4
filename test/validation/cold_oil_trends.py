# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Published trends of cages in cold oil (Y. Guo, J. Keller, Tribology International 148 (2020)) on a map of `bearing_sim.studies.cold_oil`."""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

from bearing_sim.studies.cold_oil import SKID, Point, SkidMap

_NEAR, _SAME_SLIP = 0.01, 1e-3  # skid loads, relative, and slips that count as equal


class Trend(NamedTuple):
    """A published trend, and whether the map has it."""

    claim: str
    figures: str
    holds: bool | None  # None where the map has no case


def _cooling(found: SkidMap, supply: str) -> Iterator[tuple[float, list[Point]]]:
    """Yield loads with their points from warm to cold."""
    for load in dict.fromkeys(point.load for point in found.points):
        of_load = [point for point in found.points if point.supply == supply and point.load == load]
        yield load, sorted(of_load, key=lambda point: -point.celsius)


def trends(found: SkidMap) -> list[Trend]:
    """Return the published trends on a map, supply by supply."""
    told = []
    for supply in dict.fromkeys(point.supply for point in found.points):
        loads = sorted((each for each in found.skid_loads if each.supply == supply), key=lambda each: -each.celsius)
        figures = ", ".join(f"{each.celsius:g} degC {each.load:.4g} N" for each in loads)
        steps = [cold.load >= (1.0 - _NEAR) * warm.load for warm, cold in itertools.pairwise(loads) if warm.load > 0.0 or cold.load > 0.0]
        told.append(Trend(f"{supply}: the skid load never falls as the oil cools", figures, all(steps) if steps else None))
        fallen, judged = [], 0
        for load, points in _cooling(found, supply):
            for warm, cold in itertools.pairwise(points):
                if warm.skid > SKID:  # it skids already
                    judged += 1
                    if cold.skid < warm.skid - _SAME_SLIP:
                        fallen.append(f"{load:.3g} N: {100 * warm.skid:.1f} % at {warm.celsius:g}, {100 * cold.skid:.1f} % at {cold.celsius:g} degC")
        words = f"{judged - len(fallen)} of {judged} steps of temperature" + (f"; not {'; '.join(fallen)}" if fallen else "")
        told.append(Trend(f"{supply}: a skid never falls as the oil cools", words, not fallen if judged else None))
        rises = [
            heavy.skid > light.skid + _SAME_SLIP
            for celsius in dict.fromkeys(point.celsius for point in found.points)
            for light, heavy in itertools.pairwise([p for p in found.points if p.supply == supply and p.celsius == celsius])
        ]
        figures = f"rises in {sum(rises)} of {len(rises)} steps of load"
        told.append(Trend(f"{supply}: slip falls as the load grows", figures, not any(rises) if rises else None))
    return told
