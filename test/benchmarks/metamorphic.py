# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Metamorphic relations on many random scenes of catalogue bearings, level by level.

    python test/benchmarks/metamorphic.py --level slip --count 1000
    python test/benchmarks/metamorphic.py --level steady --count 1000 --against-slip
    python test/benchmarks/metamorphic.py --level slip --count 500 --tolerances

Every second scene is cold and below the minimum load.  The exit code is 1 where a relation does not hold.
"""

import argparse
import math
import os
import statistics
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from metamorphic import (  # noqa: E402
    Answer,
    Violation,
    differs,
    missing_power,
    settled_answer,
    solved_answers,
    steady_against_slip,
    violations_of_cutting,
    violations_of_solved_symmetry,
    violations_of_symmetry,
)
from random_scenes import random_scenes  # noqa: E402

from bearing_sim.scene.scene import Scene  # noqa: E402
from bearing_sim.simulation import IntegrationError  # noqa: E402
from bearing_sim.sweep.settling import cage_turn  # noqa: E402
from bearing_sim.sweep.states import ROLLING, SKID  # noqa: E402

_TURNS = 20.0  # of the cage, of a run that is cut into pieces
_BOOKS = 0.01  # of the shaft's power, by which the losses may miss it
_ALONE = 0.05 / 100  # points of slip by which levels steady and slip may differ
_OF_TOLERANCES = (2e-4, 0.02, 0.02)  # by which a tenth of the tolerances may change slip (absolute, or the second relative), and losses


def _symmetries(scene: Scene, start: str) -> list[Violation]:
    if scene.level == "steady":
        return violations_of_solved_symmetry(scene)
    found = violations_of_symmetry(scene, start)
    if start == ROLLING:
        found += violations_of_cutting(scene, _TURNS * cage_turn(scene))
        missing = missing_power(scene)
        if missing > _BOOKS:
            nothing = Answer(math.nan, math.nan, math.nan)
            found.append(Violation(scene.name, f"losses miss the shaft power by {100 * missing:.2g} %", start, nothing, nothing))
    return found


def _against_slip(scene: Scene, _start: str) -> list[Violation]:
    pair = steady_against_slip(scene)
    if pair is None or not differs(*pair, slip=_ALONE):
        return []
    return [Violation(scene.name, "steady against slip", ROLLING, *pair)]


def _tolerances(scene: Scene, _start: str) -> list[Violation]:
    integration, tolerance = scene.integration, scene.integration.absolute_tolerance
    absolute = replace(tolerance, **{each.name: 0.1 * getattr(tolerance, each.name) for each in fields(tolerance)})
    finer = replace(scene, integration=replace(integration, relative_tolerance=0.1 * integration.relative_tolerance, absolute_tolerance=absolute))
    answer = (lambda each: solved_answers(each)[0]) if scene.level == "steady" else settled_answer
    before, after = answer(scene), answer(finer)
    slip, relative, power = _OF_TOLERANCES
    if not (before.settled and after.settled) or not differs(before, after, max(slip, relative * abs(after.cage_slip)), math.inf, power):
        return []
    return [Violation(scene.name, "a tenth of the tolerances", ROLLING, before, after)]


def _judge(task) -> tuple[list[Violation], str, float]:
    check, scene, start = task
    began = time.perf_counter()
    try:
        return check(scene, start), "", time.perf_counter() - began
    except (IntegrationError, IndexError) as error:
        return [], f"{scene.name}: {error!r}", time.perf_counter() - began


def _shown(answer: Answer) -> str:
    return f"{100 * answer.cage_slip:.4f} % {answer.rating_life:.5g} h {answer.shaft_power:.5g} W"


def main() -> int:
    """Check and print; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", default="slip", choices=("steady", "slip", "planar", "spatial"))
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--against-slip", action="store_true", help="level steady against level slip")
    kinds.add_argument("--tolerances", action="store_true", help="default tolerances against a tenth of them")
    given = parser.parse_args()
    check = _against_slip if given.against_slip else _tolerances if given.tolerances else _symmetries
    usual, cold = (random_scenes(given.seed, (given.count + 1) // 2, given.level, each) for each in (False, True))
    scenes = [scene for pair in zip(usual, cold) for scene in pair][: given.count]
    starts = (ROLLING, SKID) if check is _symmetries and given.level == "slip" else (ROLLING,)
    tasks, found, failed, seconds = [(check, scene, start) for scene in scenes for start in starts], [], [], []
    with ProcessPoolExecutor(given.workers) as pool:
        for violations, failure, took in pool.map(_judge, tasks):
            found += violations
            failed += [failure] * bool(failure)
            seconds.append(took)
    for each in found:
        slips = " ".join(
            f"{100 * answer.cage_slip:.4f} % {answer.rating_life:.5g} h {answer.shaft_power:.5g} W" for answer in (each.before, each.after)
        )
        print(f"{each.scene}, from {each.start}: {each.relation}: {slips}")
    for each in failed:
        print(f"failed: {each}")
    scenes_apart = len({(each.scene, each.start) for each in found})
    print(f"level {given.level}, {len(tasks)} scenes and starts, seed {given.seed}: {scenes_apart} do not hold, {len(failed)} failed; ", end="")
    print(f"{statistics.median(seconds):.2f} s each (median)")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
