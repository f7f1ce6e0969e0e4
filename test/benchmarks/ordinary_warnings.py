# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How many warnings of validity ordinary scenes get, and how many of them move a printed number.

Scenes are those that ``bearing-sim new`` writes for bearings of the catalogue (up to 150 mm bore, CN or C3) in mineral oils of ISO VG 32 to 460, at
0.02 to 0.2 C and 0.2 to 0.8 of the limiting speed, with a thermal network; each is settled at level ``steady``.  Counted are all limits that are
passed, by the ranges of the films and of resistance to rolling before they were widened, and those that are printed.  Run it with
``python test/benchmarks/ordinary_warnings.py``.
"""

import argparse
import random
from collections import Counter

from bearing_sim.model.validity import BY_NAME, Grade, outside
from bearing_sim.scene.designation import designations
from bearing_sim.scene.loader import load_bearing
from bearing_sim.scene.new_scene import Wish, new_scene
from bearing_sim.scene.ratings import rate
from bearing_sim.simulation import IntegrationError
from bearing_sim.studies.settle import settle
from bearing_sim.sweep.grading import graded

_LARGEST_BORE, _CLASSES = 0.15, (32, 46, 68, 100, 150, 220, 320, 460)
_SPEEDS, _LOADS = (0.2, 0.8), (0.02, 0.2)  # of the limiting speed, and of C
_NARROW = tuple(BY_NAME[name]._replace(high=high) for name, high in (("film_speed", 1e-10), ("rolling_speed", 1.6e-10)))


def draw(generator: random.Random, known: list):
    """Return a random ordinary scene."""
    text, limit = "", None
    while not limit:
        text = generator.choice(known).designation.text + generator.choice(("", "/C3"))
        bearing = load_bearing(text)
        limit = bearing.ratings.limiting_speed
    oil, speed = f"ISO VG {generator.choice(_CLASSES)}", generator.uniform(*_SPEEDS) * limit
    load = generator.uniform(*_LOADS) * rate(bearing).dynamic
    return new_scene(Wish(text, {"oil": oil}, f"{speed:.6g} rad/s", f"{load:.6g} N", level="steady"), text, "")[1]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=2017)
    options = parser.parse_args()
    known = [each for each in designations() if each.boundary.bore <= _LARGEST_BORE and not each.designation.is_full_complement]
    generator, before, grades, printed, warned, moving, settled = random.Random(options.seed), Counter(), Counter(), Counter(), 0, 0, 0
    while settled < options.count:
        scene = draw(generator, known)
        try:
            outcome = settle(scene).outcome
        except IntegrationError as error:
            print(f"{scene.name}: {error}")
            continue
        settled += 1
        before.update(each.law.name for each in outside(scene, outcome.window, laws=_NARROW))
        found = graded(scene, outside(scene, outcome.window), outcome.window[-1])
        told = [each for each in found if each.grade == Grade.WARNING]
        grades.update(str(each.grade) for each in found)
        printed.update(each.law.name for each in told)
        moving += sum(each.effect is not None for each in told)
        warned += bool(told)
        for each in told:
            print(f"{scene.name}: {each.note}")
    print(f"{settled} scenes; before: {before.total()} warnings: {dict(before)}")
    print(f"after, by grade: {dict(grades)}; printed {printed.total()} in {warned} scenes, of which {moving} move a number: {dict(printed)}")


if __name__ == "__main__":
    main()
