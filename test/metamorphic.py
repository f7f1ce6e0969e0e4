# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Metamorphic relations: changes of a scene or of how it is run that change no answer, and by how much answers then differ."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bearing_sim.model.losses import power_loss
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.sweep.point import run_until_settled
from bearing_sim.sweep.states import ROLLING, SKID, skid_start, state_of, states

SLIP, LIFE, POWER = 1e-3, 0.04, 0.04  # largest differences: absolute, and relative; settling allows half of each
LOSSES = [each.name for each in OBSERVABLES if each.name.endswith("_power") and each.name != "shaft_power"]
_TURN = 0.7368  # rad, by which a round bearing is turned: no multiple of a pitch
_LONGEST = 5.0  # s of a run; cages that rattle never settle
_PIECES, _SAMPLES, _MORE_SAMPLES = 5, 100, 370


class Answer(NamedTuple):
    """What is compared."""

    cage_slip: float
    rating_life: float  # [h]
    shaft_power: float  # [W]
    settled: bool = True


class Violation(NamedTuple):
    """A relation that does not hold."""

    scene: str
    relation: str
    start: str
    before: Answer
    after: Answer


def equal_scenes(scene: Scene) -> Iterator[tuple[str, Scene]]:
    """Yield names of changes of a scene that change no answer, and the scenes."""
    operating, lobes = scene.operating, getattr(scene.bearing.outer_raceway, "lobes", 0)
    speed, angle = operating.shaft_speed, operating.load_angle
    if lobes:
        for turns in {1, lobes // 2 + 1}:
            yield f"turned by {turns} of {lobes} lobes", scene.at(load_angle=_wrapped(angle + 2.0 * math.pi * turns / lobes))
    else:
        pitch = 2.0 * math.pi / scene.bearing.roller.count
        yield "turned by half a pitch", scene.at(load_angle=_wrapped(angle + 0.5 * pitch))
        yield "turned", scene.at(load_angle=_wrapped(angle + _TURN))
        yield "reversed", scene.at(shaft_speed=-speed)
    yield "mirrored", scene.at(shaft_speed=-speed, load_angle=-angle)
    yield (
        "in other units",
        scene.at(
            shaft_speed=f"{speed / (2.0 * math.pi)!r} Hz",
            load_angle=f"{math.degrees(angle)!r} deg",
            radial_load=f"{1e-3 * operating.radial_load!r} kN",
        ),
    )


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)


def settled_answer(scene: Scene, start: str = ROLLING) -> Answer:
    """Return what a scene settles to from ideal rolling or a skid."""
    outcome = run_until_settled(scene, longest=_LONGEST, start=skid_start(scene) if start == SKID else None)
    state = state_of(outcome, start)
    return Answer(state.cage_slip, state.rating_life, state.shaft_power, outcome.settled)


def solved_answers(scene: Scene) -> list[Answer]:
    """Return the states of level steady, by slip."""
    return sorted(Answer(state.cage_slip, state.rating_life, state.shaft_power) for state in states(scene, skid_load=False).found)


def differs(before: Answer, after: Answer, slip: float = SLIP, life: float = LIFE, power: float = POWER) -> bool:
    """Return whether two answers are further apart than allowed."""
    slips = before.cage_slip, after.cage_slip
    apart = not (abs(slips[0] - slips[1]) <= slip or slips[0] != slips[0] and slips[1] != slips[1])
    return apart or _apart(before.rating_life, after.rating_life) > life or _apart(before.shaft_power, after.shaft_power) > power


def _apart(one: float, two: float) -> float:
    return 0.0 if one == two else abs(one - two) / max(min(abs(one), abs(two)), 1e-300)


def violations_of_symmetry(scene: Scene, start: str = ROLLING) -> list[Violation]:
    """Return which changes of a scene at a level that takes steps change what it settles to; scenes that do not settle are compared, too."""
    found, first = [], settled_answer(scene, start)
    for relation, other in equal_scenes(scene):
        answer = settled_answer(other, start)
        if first.settled and answer.settled and differs(first, answer):
            found.append(Violation(scene.name, relation, start, first, answer))
    return found


def violations_of_solved_symmetry(scene: Scene) -> list[Violation]:
    """Return which changes of a scene change the states of level steady."""
    found, first = [], solved_answers(scene)
    for relation, other in equal_scenes(scene):
        answers = solved_answers(other)
        nothing = Answer(math.nan, math.nan, math.nan)
        if len(first) != len(answers):
            found.append(Violation(scene.name, relation, "any", first[-1] if first else nothing, answers[-1] if answers else nothing))
        else:
            found += [Violation(scene.name, relation, "any", *pair) for pair in zip(first, answers) if differs(*pair)]
    return found


def violations_of_cutting(scene: Scene, duration: float) -> list[Violation]:
    """Return whether pieces, samples, or the definition of the shaft's power change what a run of some duration [s] does to a bearing."""
    whole, found = _run(scene, duration, 1, _SAMPLES), []
    others = {"in pieces": _run(scene, duration, _PIECES, _SAMPLES // _PIECES), "more samples": _run(scene, duration, 1, _MORE_SAMPLES)}
    for relation, other in others.items():
        if differs(whole, other):
            found.append(Violation(scene.name, relation, ROLLING, whole, other))
    return found


def _run(scene: Scene, duration: float, pieces: int, samples: int) -> Answer:
    """Return mean slip by the cage's angle, the life that the damage stands for, and the mean shaft power."""
    run = Simulation(scene)
    begin = float(run.sample["cage_angle"])
    blocks = [run.advance(duration / pieces, samples=samples) for _ in range(pieces)]
    last, ideal = blocks[-1][-1], float(run.sample["ideal_cage_speed"])
    slip = 1.0 - (float(last["cage_angle"]) - begin) / (ideal * duration)
    life = duration / 3600.0 / float(last["damage"]) if last["damage"] > 0.0 else math.inf
    return Answer(slip, life, float(np.concatenate([block["shaft_power"] for block in blocks]).mean()))


def missing_power(scene: Scene) -> float:
    """Return by which part of it the shaft's power of a settled bearing misses the sum of its losses."""
    window = run_until_settled(scene, longest=_LONGEST).window
    total = sum(float(window[name].mean()) for name in LOSSES)
    return _apart(power_loss(window), total)


def steady_against_slip(scene: Scene) -> tuple[Answer, Answer] | None:
    """Return what level steady and level slip settle to from ideal rolling; None where level slip does not settle or a level fails."""
    try:
        steady, slip = solved_answers(scene), settled_answer(scene.at_level("slip"))
    except IntegrationError:
        return None
    if not (steady and slip.settled):
        return None
    return min(steady, key=lambda answer: abs(answer.cage_slip - slip.cage_slip)), slip
