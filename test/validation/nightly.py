# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is run every night: scenes at the extremes at stock settings, corners, and long runs, in one table.

Scenes and corners run as `bearing_sim.studies.extreme_run` describes: stock settings, at least 50 turns of the cage or until they settle,
then the books of energy.  Corners run with their own settings, too.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.studies.extreme_run import FAILED, FINISHED, OUTCOMES, REFUSED, STEP_LIMITED, Case, StockOutcome, outcome_fields
from bearing_sim.sweep.tasks import Journal, program_hash, run_tasks, task
from validation.extremes import counted, long_outcome
from validation.extremes_cases import at_stock, corner_cases, sampled_cases
from validation.extremes_long import LONG_RUNS, LongRun, long_run_result
from validation.extremes_run import Outcome, case_result

SAMPLES = {"steady": 2000, "slip": 2000, "planar": 500, "spatial": 200}
"""Scenes of the Latin hypercube, by level."""
_PERCENTILE = 95.0


class Books(NamedTuple):
    """How far the books of energy of several runs are off, without sign.

    Attributes
    ----------
    number : of runs that have books: without those that end at rest, and without contours that have no slope, whose books are open by themselves.
    median, high, largest : of what is missing, over the energy put in or lost; ``high`` is the 95th percentile.
    worst : name of the case with the largest.
    """

    number: int
    median: float
    high: float
    largest: float
    worst: str


class Row(NamedTuple):
    """One row of the table: runs of a kind at a level.

    Attributes
    ----------
    level : of fidelity.
    runs : what they are, in words.
    counts : number by outcome.
    books : of energy; None where they are not kept.
    reasons : number of runs by reason, for each outcome but finished.
    failures : name and reason of each failed run.
    core_seconds : of all.
    """

    level: str
    runs: str
    counts: Mapping[str, int]
    books: Books | None
    reasons: Mapping[str, Mapping[str, int]]
    failures: Sequence[tuple[str, str]]
    core_seconds: float


class Report(NamedTuple):
    """What a night gave.

    Attributes
    ----------
    seed : of the hypercube.
    program : hash of the sources that the results depend on.
    rows : of the table.
    cases : fields of every run by name, a row per run.
    """

    seed: int
    program: str
    rows: Sequence[Row]
    cases: Sequence[Mapping[str, object]]

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return sum(row.counts[FAILED] for row in self.rows)


def run_nightly(
    samples: Mapping[str, int] = SAMPLES,
    seed: int = 0,
    corners: bool = True,
    long: bool = True,
    journal: Path | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
    first: int | None = None,
) -> Report:
    """Run everything on all cores.

    Parameters
    ----------
    samples : scenes of the hypercube, by level; other levels are left out.
    seed : of the hypercube; the same seed gives the same scenes.
    corners, long : whether to include corners and long runs.
    journal : file from which an interrupted night resumes with the same program; None: it cannot.
    workers : number of processes; None: one per core.
    progress : called with the number of finished runs and of all that are not in the journal.
    first : how many of the scenes of each level are run, from the first one on; None: all.
    """
    levels = [level for level in LEVELS if level in samples]
    sampled = {level: sampled_cases(level, samples[level], seed)[:first] for level in levels}
    at_corners = {level: corner_cases(level) if corners else [] for level in levels}
    lasting = {level: LONG_RUNS[level] if long else () for level in levels}
    tasks, places = [], {}
    for level in levels:
        stock = [at_stock(case) for case in sampled[level] + at_corners[level]]
        places[level] = len(tasks)
        tasks += [task(level, outcome_fields, case) for case in stock]
        tasks += [task(case.level, case_result, case) for case in at_corners[level]]
        tasks += [task(level, long_run_result, level, *run) for run in lasting[level]]
    with Journal(journal) as kept:
        results = run_tasks(tasks, kept, workers, progress=progress)
    rows, cases = [], []
    for level in levels:
        theirs = iter(results[places[level] :])
        scenes = [StockOutcome(**{"case": case} | next(theirs)) for case in sampled[level]]
        stock_corners = [StockOutcome(**{"case": case} | next(theirs)) for case in at_corners[level]]
        own_corners = [Outcome(**{"case": case} | next(theirs)) for case in at_corners[level]]
        lasted = [long_outcome(level, *run, next(theirs)) for run in lasting[level]]
        for runs, outcomes in (("scenes", scenes), ("corners", stock_corners), ("corners with their own settings", own_corners)):
            if outcomes:
                rows.append(_row(level, runs, outcomes))
                cases += [_fields(runs, seed, outcome) for outcome in outcomes]
        rows += [_long_row(run) for run in lasted]
    return Report(seed, program_hash(), rows, cases)


def _row(level: str, runs: str, outcomes: Sequence[Outcome | StockOutcome]) -> Row:
    counts = {status: sum(outcome.status == status for outcome in outcomes) for status in OUTCOMES}
    reasons = {status: counted(outcomes, status) for status in (STEP_LIMITED, REFUSED, FAILED)}
    failures = [(outcome.case.name, outcome.reason) for outcome in outcomes if outcome.status == FAILED]
    return Row(level, runs, counts, _books(outcomes), reasons, failures, sum(outcome.core_seconds for outcome in outcomes))


def _books(outcomes: Sequence[Outcome | StockOutcome]) -> Books | None:
    """Return how far the books of runs at stock settings are off; None if there are none."""
    closed = [each for each in outcomes if isinstance(each, StockOutcome) and has_closed_books(each.case)]
    kept = {each.case.name: abs(each.books) for each in closed if math.isfinite(each.books)}
    if not kept:
        return None
    off, worst = np.array(list(kept.values())), max(kept, key=kept.__getitem__)
    return Books(len(kept), float(np.median(off)), float(np.percentile(off, _PERCENTILE)), kept[worst], worst)


def has_closed_books(case: Case) -> bool:
    """Return whether the laws of a case keep energy: not Deng's contour without slope, for whose squeeze nothing pays."""
    return "bearing.outer_raceway.contour_slope=false" not in case.overrides


def _long_row(run: LongRun) -> Row:
    name = f"{run.simulated:g} s at {run.speed_rpm:g} rpm"
    status = FAILED if run.failure else FINISHED
    books = None if math.isnan(run.books) else Books(1, *[abs(run.books)] * 3, name)
    failures = [(name, run.failure)] if run.failure else []
    return Row(run.level, name, {each: int(each == status) for each in OUTCOMES}, books, {}, failures, run.core_seconds)


def _fields(runs: str, seed: int, outcome: Outcome | StockOutcome) -> dict[str, object]:
    """Return the fields of one run for a table of all runs."""
    run = {
        "level": outcome.case.level,
        "runs": runs,
        "case": outcome.case.name,
        "course": outcome.case.course,
        "seed": seed,
        "program": program_hash(),
    }
    return run | {name: getattr(outcome, name, "") for name in StockOutcome._fields if name != "case"}
