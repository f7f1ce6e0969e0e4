# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The stability map: what becomes of scenes at the extremes of everything, on all cores.

A case is *finished*; *clamped*, where it came to a good end or was going well but something other than the equations set a bound
(a fixed step that had to be divided, the study's budget of steps where the case's own settings ask for so many: a tolerance, a
step or an explicit method); *refused*, by the scene's checks before it starts; or *failed*: not finite, an exception, a process that
died, a hang, too slow with settings that do not ask for it, or a value that no bearing can have.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from bearing_sim.cores import cores
from bearing_sim.levels.level import LEVELS
from bearing_sim.studies.extremes_corners import corner_cases
from bearing_sim.studies.extremes_long import LongRun, long_run, long_runs
from bearing_sim.studies.extremes_run import FAILED, FINISHED, OUTCOMES, Outcome, run_case
from bearing_sim.studies.extremes_scenes import Case, sampled_cases

# A field that a fault names: where a fault begins, or behind the record that found it.
_NAMED = re.compile(r"(?:(?<=^)|(?<=; )|(?<=bearing: )|(?<=scene: ))([a-z_]+(?:\.[a-z_0-9]+)*)(?: = [^:;]*)?(?=: )")
_COSTS = ("steps_per_ms", "right_hand_sides_per_ms", "core_ms_per_ms", "step_us")


def run_extremes(
    samples: int,
    levels: Sequence[str] = (),
    seed: int = 0,
    long: bool = True,
    tell: Callable[[str], None] = lambda text: None,
    progress: Callable[[float], None] = lambda share: None,
) -> tuple[dict, list[Outcome]]:
    """Run the study.

    Parameters
    ----------
    samples : scenes of the Latin hypercube for each level; the corners come besides.
    levels : which; all where none is named.
    seed : of the hypercube.
    long : whether to make the long runs, too.
    tell : takes a word on what is being done.
    progress : takes the share that is done.

    Returns
    -------
    report : plain numbers, strings, lists and dicts.
    outcomes : of all cases.
    """
    levels = tuple(levels) or tuple(LEVELS)
    cases = [case for level in levels for case in corner_cases(level) + sampled_cases(level, samples, seed)]
    runs = [run for level in levels for run in long_runs(level)] if long else []
    for level in levels:
        tell(f"compiling level {level} by all its methods, once for this version")
        _compile(level)
    if runs:
        tell(f"{len(runs)} long runs")
    with _pool() as pool:
        long_outcomes = list(pool.map(long_run, runs))
    tell(f"{len(cases)} scenes")
    outcomes = []
    for outcome in _outcomes(cases):
        outcomes.append(outcome)
        progress(len(outcomes) / len(cases))
    order = {(case.level, case.name): place for place, case in enumerate(cases)}
    outcomes.sort(key=lambda outcome: order[outcome.case.level, outcome.case.name])
    return _report(levels, samples, seed, outcomes, long_outcomes), outcomes


def _pool(workers: int | None = None) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers or cores(), mp_context=get_context("spawn"))


def _compile(level: str) -> None:
    """Fill the cache of machine code before several processes would do it at the same time."""
    for case in corner_cases(level):
        if "tolerance 0.01" in case.name or "fixed step 1e-05" in case.name:
            run_case(case._replace(seconds=2e-5))


def _outcomes(cases: Sequence[Case]) -> Iterator[Outcome]:
    """Yield the outcomes as they come; of cases whose process died the guilty ones are found by halving."""
    undone = []
    with _pool() as pool:
        futures = {pool.submit(run_case, case): case for case in cases}
        for future in as_completed(futures):
            try:
                yield future.result()
            except BrokenProcessPool:
                undone.append(futures[future])
    if len(undone) == 1 and len(cases) == 1:
        yield Outcome(undone[0], FAILED, "the process died")
    elif undone:
        middle = (len(undone) + 1) // 2
        yield from _outcomes(undone[:middle])
        yield from _outcomes(undone[middle:])


def _report(levels, samples, seed, outcomes, long_outcomes) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "samples": samples,
        "seed": seed,
        "cores": cores(),
        "levels": {
            level: _level_report([o for o in outcomes if o.case.level == level], [run for run in long_outcomes if run.level == level])
            for level in levels
        },
    }


def _totals(outcomes, long_outcomes) -> dict[str, int]:
    counts = {status: sum(outcome.status == status for outcome in outcomes) for status in OUTCOMES}
    for run in long_outcomes:
        counts[FAILED if run.fault else FINISHED] += 1
    return counts


def _level_report(outcomes: Sequence[Outcome], long_outcomes: Sequence[LongRun]) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "clamped_by": _counted(outcomes, "clamped"),
        "refused_by": _counted(outcomes, "refused"),
        "failures": [{"case": o.case.name, "reason": o.reason, "overrides": list(o.case.overrides)} for o in outcomes if o.status == FAILED],
        "worst": _worst(outcomes),
        "worst_by_the_model": _worst([outcome for outcome in outcomes if not outcome.asks_for_small_steps]),
        "core_seconds": sum(outcome.core_seconds for outcome in outcomes),
        "non_finite_steps": sum(outcome.non_finite_steps for outcome in outcomes),
        "long_runs": [run._asdict() for run in long_outcomes],
        "corners": [
            {"name": o.case.name, "outcome": o.status, "reason": o.reason, **{name: getattr(o, name) for name in ("simulated", "steps", *_COSTS)}}
            for o in outcomes
            if not o.case.name.startswith("sample ")
        ],
    }


def _worst(outcomes: Sequence[Outcome]) -> dict[str, dict]:
    """Return the dearest case by each measure of cost."""
    dearest = {name: max(outcomes, key=lambda outcome: getattr(outcome, name), default=None) for name in _COSTS}
    return {name: {"case": found.case.name, "value": getattr(found, name)} for name, found in dearest.items() if found is not None}


def _counted(outcomes: Sequence[Outcome], status: str) -> dict[str, int]:
    """Count the reasons of one outcome, numbers left out of them, most frequent first."""
    counts: dict[str, int] = {}
    for outcome in outcomes:
        if outcome.status == status:
            for reason in kinds_of_reason(outcome.reason):
                counts[reason] = counts.get(reason, 0) + 1
    return dict(sorted(counts.items(), key=lambda item: -item[1]))


def kinds_of_reason(reason: str) -> list[str]:
    """Return the fields that a refusal names, or the bounds that clamped a run, without their numbers."""
    named = [name for name in _NAMED.findall(reason) if name not in ("bearing", "scene")]
    return list(dict.fromkeys(named or [part.split(":")[0] for part in reason.split(", ")]))
