# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Random scenes of bearings by designation: does each level settle, and what do the others do?

A scene is drawn evenly from the tables of designations (those of `_LARGEST_BORE` at most), clearances, oils and supplies; its speed from a tenth of
the limiting speed to a fifth above it, its load from nothing to half of C, its oil as warm as `_TEMPERATURES`.  Levels that have no full complement
of rollers draw bearings with cages alone.
"""

import math
import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bearing_sim.scene.designation import designations
from bearing_sim.scene.loader import SceneError, load_bearing, scene_from_mapping
from bearing_sim.scene.mounting import CLEARANCE_GROUPS
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError
from bearing_sim.sweep.point import FAILED, OK, REFUSED, UNSETTLED, run_until_settled
from bearing_sim.sweep.tasks import Journal, run_tasks, task

_LARGEST_BORE = 0.5  # m, to which ISO 286 has fits here
_CLASSES, _BASES = (10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460), ("", " PAO", " ester", " PAG")
_SUPPLIES = ("oil_jet", "circulating", "oil_bath", "oil_air")
_TEMPERATURES = (0.0, 120.0)  # degC
_SPEEDS, _LOADS = (0.1, 1.2), (0.0, 0.5)  # of the limiting speed, and of C
_SPEED_FACTOR = 0.5  # n d_m where no maker prints a limiting speed [m/min x 1000, that is 1e6 mm/min]; assumption


class Drawn(NamedTuple):
    """A random scene, as texts and numbers that say it whole."""

    designation: str
    oil: str
    supply: str
    temperature: float  # degC
    speed: float  # rpm
    load: float  # N


class Report(NamedTuple):
    """What a level did with the scenes.

    Attributes
    ----------
    level : of fidelity.
    counts : number of scenes by status.
    others : the scenes that did not settle, and why.
    """

    level: str
    counts: dict[str, int]
    others: list[tuple[Drawn, str, str]]

    @property
    def settled(self) -> float:
        """Fraction of the scenes that settled."""
        return self.counts.get(OK, 0) / max(sum(self.counts.values()), 1)


def draw_scenes(count: int, level: str, seed: int) -> list[Drawn]:
    """Return random scenes of a level; the same for the same seed and tables."""
    has_full_complement = level in ("steady", "slip")
    known = [
        each for each in designations() if each.boundary.bore <= _LARGEST_BORE and (has_full_complement or not each.designation.is_full_complement)
    ]
    generator = random.Random(seed)
    return [_draw(generator, generator.choice(known)) for _ in range(count)]


def _draw(generator: random.Random, each) -> Drawn:
    group = generator.choice(CLEARANCE_GROUPS)
    text = each.designation.text if group == "CN" else f"{each.designation.text}/{group}"
    bearing = load_bearing(text)
    limit = each.ratings.limiting_speed or _SPEED_FACTOR * 1e3 / bearing.pitch_diameter * math.pi / 30
    return Drawn(
        text,
        f"ISO VG {generator.choice(_CLASSES)}{generator.choice(_BASES)}",
        generator.choice(_SUPPLIES),
        round(generator.uniform(*_TEMPERATURES), 1),
        round(generator.uniform(*_SPEEDS) * limit * 30 / math.pi, 1),
        round(generator.uniform(*_LOADS) * rate(bearing).dynamic, 1),
    )


def scene_of(drawn: Drawn, level: str) -> Scene:
    """Return the scene of a drawn one at a level of fidelity."""
    return scene_from_mapping(
        {
            "name": drawn.designation,
            "level": level,
            "bearing": drawn.designation,
            "lubricant": {"oil": drawn.oil, "supply": drawn.supply, "temperature": f"{drawn.temperature} degC"},
            "operating": {"shaft_speed": f"{drawn.speed} rpm", "radial_load": f"{drawn.load} N"},
        },
        drawn.designation,
    )


def run_scene(drawn: Drawn, level: str, at_most: float) -> dict:
    """Run a scene until it settles; return status, reason and slip.

    Parameters
    ----------
    drawn : the scene.
    level : of fidelity.
    at_most : longest simulated time [s].
    """
    try:
        scene = scene_of(drawn, level)
    except SceneError as error:
        return {"status": REFUSED, "reason": "; ".join(map(str, error.errors)), "slip": math.nan}
    try:
        outcome = run_until_settled(scene, longest=at_most)
    except IntegrationError as error:
        return {"status": FAILED, "reason": str(error), "slip": math.nan}
    if not (math.isfinite(outcome.slip) and -1.0 < outcome.slip < 1.001):
        return {"status": FAILED, "reason": f"slip of {outcome.slip}", "slip": outcome.slip}
    return {"status": OK if outcome.settled else UNSETTLED, "reason": outcome.reason, "slip": outcome.slip}


def run_scenes(
    count: int,
    level: str,
    seed: int,
    at_most: float,
    journal: Path | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Report:
    """Run random scenes at a level of fidelity on all cores.

    Parameters
    ----------
    count, seed : see `draw_scenes`.
    level, at_most : see `run_scene`.
    journal : file from which an interrupted study resumes; None: it cannot.
    workers : number of processes; None: one per core.
    progress : called with the number of finished scenes and of all.
    """
    scenes = draw_scenes(count, level, seed)
    with Journal(journal) as kept:
        results = run_tasks([task(level, run_scene, drawn, level, at_most) for drawn in scenes], kept, workers, progress=progress)
    others = [(drawn, result["status"], result["reason"]) for drawn, result in zip(scenes, results) if result["status"] != OK]
    return Report(level, dict(Counter(result["status"] for result in results)), others)
