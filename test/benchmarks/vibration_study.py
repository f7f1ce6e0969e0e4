# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How well the cage speed is found in synthetic vibration, whose truth is known, and how often a line is seen where there is none.

    python test/benchmarks/vibration_study.py --runs 3 --seed 11 --healthy 1000

What shows, shaft speed, its change over the record and the noise vary; rollers have play, two machines stand nearby, and slip is up to 10 %.  A
steady speed is known to 1 %, a changing one to 0.3 %.  ``vibration_claims.py`` has trains of impacts of other machines beside the bearing's.
"""

import argparse
import dataclasses
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from synthetic_vibration import Machine, Synthetic, record  # noqa: E402

from bearing_sim.cli.reporting import print_rows  # noqa: E402
from bearing_sim.watchers.vibration.analysis import Analysis, Geometry, analyse  # noqa: E402

SPEEDS = (600.0, 3000.0, 10_000.0, 30_000.0)  # [rpm]
NOISES = (0.0, -10.0, -20.0)  # [dB] impacts over noise
RAMPS = (0.0, 0.2)
KINDS = ("outer_ring", "inner_ring", "roller")
HEALTHY = ("noise", "healthy")
_ROLLERS, _SIZE, _LARGEST_SLIP = 13, 0.19, 0.1
_NAMEPLATE, _TACHOMETER = 0.01, 0.003  # largest error of the speed that is given, steady and recorded


class Condition(NamedTuple):
    """What one row of the table is about: what shows, shaft speed [rpm], its change over the record, impacts over noise [dB]."""

    shows: str
    speed: float
    ramp: float
    signal_to_noise: float


class Row(NamedTuple):
    """How well the cage speed is found in one condition.

    Attributes
    ----------
    condition : what was simulated.
    runs, found : number of records, and of those in which a line was found.
    right : of those, in how many the part that shows is the right one.
    bias : mean error of the ratio of cage to shaft over the true one, where the part is right.
    error : root mean square of these errors.
    stated : root mean square of the standard errors that were stated.
    within : fraction of the errors within two stated standard errors.
    """

    condition: Condition
    runs: int
    found: int
    right: int
    bias: float
    error: float
    stated: float
    within: float


def conditions() -> list[Condition]:
    """Return the conditions of the table."""
    return [Condition(shows, speed, ramp, noise) for shows in KINDS for speed in SPEEDS for ramp in RAMPS for noise in NOISES]


def errors_in(condition: Condition, runs: int, seed: int) -> Row:
    """Return how well the cage speed is found in one condition.

    Parameters
    ----------
    condition : what is simulated.
    runs : number of records; each has its own slip, noise and neighbours.
    seed : of everything random.
    """
    found = []
    for number in range(runs):
        words = (seed, number, KINDS.index(condition.shows), int(condition.speed), int(100 * condition.ramp), int(-condition.signal_to_noise))
        synthetic, result = _run(condition, np.random.default_rng(words))
        found.append((result.found, result.shows == condition.shows, result.ratio / synthetic.ratio - 1.0, result.ratio_error / synthetic.ratio))
    right = np.array([(error, stated) for is_found, is_right, error, stated in found if is_found and is_right]).reshape(-1, 2)
    error, stated = right.T
    nan = math.nan
    summary = (
        (float(error.mean()), float(np.sqrt(np.mean(error**2))), float(np.sqrt(np.mean(stated**2))), float(np.mean(np.abs(error) <= 2.0 * stated)))
        if len(right)
        else (nan, nan, nan, nan)
    )
    return Row(condition, runs, sum(each[0] for each in found), len(right), *summary)


def _run(condition: Condition, rng: np.random.Generator) -> tuple[Synthetic, Analysis]:
    """Return a synthetic record and what is found in it: at a steady speed with that of the nameplate, in a ramp with a tachometer's."""
    speed = condition.speed * math.pi / 30.0
    rate, duration = _sampling(condition.speed)
    slip = rng.uniform(0.0, _LARGEST_SLIP)
    machine = Machine(condition.shows, _ROLLERS, _SIZE, slip, speed, condition.ramp, signal_to_noise=condition.signal_to_noise)
    synthetic = record(machine, rate, duration, rng)
    vibration, geometry = synthetic.vibration, Geometry(_ROLLERS, _SIZE)
    if not condition.ramp:
        return synthetic, analyse(vibration, geometry, speed * (1.0 + rng.uniform(-_NAMEPLATE, _NAMEPLATE)), 2.0 * _NAMEPLATE)
    course = speed * (1.0 + condition.ramp * (np.arange(len(vibration.samples)) / len(vibration.samples) - 0.5))
    recorded = course * (1.0 + rng.uniform(-_TACHOMETER, _TACHOMETER))
    return synthetic, analyse(dataclasses.replace(vibration, shaft_speed=recorded), geometry, tolerance=1.5 * _TACHOMETER)


def _sampling(speed: float) -> tuple[float, float]:
    """Return rate [Hz] and duration [s] of a record at a shaft speed [rpm]."""
    return (51_200.0 if speed <= 6000.0 else 102_400.0), (10.0 if speed <= 1000.0 else 5.0)


def false_lines(kind: str, records: int, seed: int) -> Iterator[tuple[int, Analysis]]:
    """Yield (number, result) of the records without a damaged bearing in which a line was found nevertheless.

    Parameters
    ----------
    kind : ``noise`` alone, or a ``healthy`` machine with lines of its shaft beside two others.
    records : number of them, of random speeds, numbers of rollers and known or unknown diameters.
    seed : of everything random.
    """
    for number in range(records):
        result = _without_damage(kind, np.random.default_rng((seed, number, HEALTHY.index(kind))))
        if result.found:
            yield number, result


def _without_damage(kind: str, rng: np.random.Generator) -> Analysis:
    """Return what is found in a record without a damaged bearing."""
    speed = math.exp(rng.uniform(math.log(SPEEDS[0]), math.log(SPEEDS[-1])))
    rate, _ = _sampling(speed)
    rollers, size = int(rng.integers(10, 21)), _SIZE if rng.random() < 0.5 else math.nan
    neighbours, lines = (0, 0.0) if kind == "noise" else (2, 0.3)
    machine = Machine("", rollers, _SIZE, 0.0, speed * math.pi / 30.0, interfering=neighbours, shaft_lines=lines)
    synthetic = record(machine, rate, max(1.0, 40.0 * 60.0 / speed), rng)
    return analyse(synthetic.vibration, Geometry(rollers, size), machine.shaft_speed * (1.0 + rng.uniform(-_NAMEPLATE, _NAMEPLATE)))


def main() -> None:
    """Print the table of errors, the counts by speed and noise, and the false lines."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=10, help="records with a damaged bearing in each condition")
    parser.add_argument("--healthy", type=int, default=1000, help="records without one, of noise and of machines each")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    rows = [errors_in(each, arguments.runs, arguments.seed) for each in conditions()]
    columns = ("shows", "rpm", "ramp, %", "dB", "found", "right", "bias, 1e-4", "error, 1e-4", "stated, 1e-4", "within 2, %")
    texts = [
        (
            *(row.condition.shows, f"{row.condition.speed:.0f}", f"{100 * row.condition.ramp:.0f}", f"{row.condition.signal_to_noise:.0f}"),
            *(f"{row.found}/{row.runs}", str(row.right)),
            *(f"{1e4 * value:.3g}" if row.right else "" for value in (row.bias, row.error, row.stated)),
            f"{100 * row.within:.0f}" if row.right else "",
        )
        for row in rows
    ]
    print_rows("cage over shaft speed out of synthetic vibration, relative errors", columns, texts, words=("shows",))
    for speed in SPEEDS:
        counts = [sum(row.found for row in rows if row.condition.speed == speed and row.condition.signal_to_noise == noise) for noise in NOISES]
        print(f"{speed:.0f} rpm: found {', '.join(f'{count} at {noise:g} dB' for count, noise in zip(counts, NOISES))}")
    right = [row for row in rows if row.right]
    within = sum(round(row.within * row.right) for row in right)
    print(f"found {sum(row.found for row in rows)}, right part {sum(row.right for row in rows)}, of these ratios within two stated errors {within}")
    for kind in HEALTHY:
        print(f"false lines, {kind}: {len(list(false_lines(kind, arguments.healthy, arguments.seed)))} in {arguments.healthy} records")


if __name__ == "__main__":
    main()
