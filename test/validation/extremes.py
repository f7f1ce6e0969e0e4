# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The stability map: scenes at the extremes of all inputs, run on all cores; see `validation.extremes_run` for what can come of a case."""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from bearing_sim.files.cores import cores
from bearing_sim.levels.level import LEVELS
from bearing_sim.studies.extreme_run import FAILED, FINISHED, OUTCOMES, REFUSED, STEP_LIMITED, StockOutcome, outcome_fields
from bearing_sim.studies.extremes import LOOKS
from bearing_sim.sweep.pictures import new_figure
from bearing_sim.sweep.tasks import Journal, run_tasks, task
from validation.extremes_cases import at_stock, corner_cases, sampled_cases
from validation.extremes_long import LONG_RUNS, LongRun, long_run_result
from validation.extremes_run import Outcome, case_result

# The field in an error message: at its start, or after the name of the record.
_NAMED = re.compile(r"(?:(?<=^)|(?<=; )|(?<=bearing: )|(?<=scene: ))([a-z_]+(?:\.[a-z_0-9]+)*)(?: = [^:;]*)?(?=: )")
_COSTS = ("steps_per_ms", "right_hand_sides_per_ms", "core_ms_per_ms", "step_us")


def run_extremes(
    samples: int,
    levels: Sequence[str] = (),
    seed: int = 0,
    long: bool = True,
    announce: Callable[[str], None] = lambda text: None,
    progress: Callable[[float], None] = lambda fraction: None,
    workers: int | None = None,
) -> tuple[dict, list[Outcome]]:
    """Run the study.

    Parameters
    ----------
    samples : scenes of the Latin hypercube for each level, in addition to the corners.
    levels : to study; empty: all.
    seed : of the hypercube.
    long : whether to include the long runs.
    announce : called with a line of text before the start.
    progress : called with the finished fraction of the cases.
    workers : number of processes; None: one per core.

    Returns
    -------
    report : plain numbers, strings, lists and dicts.
    outcomes : of all cases.
    """
    levels = tuple(levels) or tuple(LEVELS)
    cases = [case for level in levels for case in corner_cases(level) + sampled_cases(level, samples, seed)]
    long_runs = [(level, *run) for level in levels for run in LONG_RUNS[level]] if long else []
    tasks = [task(case.level, case_result, case) for case in cases]
    tasks += [task(run[0], long_run_result, *run) for run in long_runs]
    announce(f"{len(cases)} scenes, {len(long_runs)} long runs")
    results = run_tasks(tasks, Journal(), workers, progress=lambda done, total: progress(done / total))
    outcomes = [Outcome(**{"case": case} | result) for case, result in zip(cases, results)]
    long_outcomes = [long_outcome(*run, result) for run, result in zip(long_runs, results[len(cases) :])]
    limited = [at_stock(outcome.case) for outcome in outcomes if outcome.status == STEP_LIMITED]
    announce(f"{len(limited)} step-limited scenes again, at stock settings")
    again = run_tasks([task(case.level, outcome_fields, case) for case in limited], Journal(), workers)
    stock_outcomes = [StockOutcome(**{"case": case} | result) for case, result in zip(limited, again)]
    return _report(levels, samples, seed, outcomes, stock_outcomes, long_outcomes), outcomes


def long_outcome(level: str, speed: float, seconds: float, result: dict) -> LongRun:
    """Return a long run from its result; that of a lost worker has only a reason."""
    return LongRun(**result) if "failure" in result else LongRun(level, speed, seconds, failure=result["reason"])


def _report(levels, samples, seed, outcomes, stock_outcomes, long_outcomes) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "failed_at_stock": sum(outcome.status == FAILED for outcome in stock_outcomes),
        "samples": samples,
        "seed": seed,
        "cores": cores(),
        "levels": {
            level: _level_report(_of_level(level, outcomes), _of_level(level, stock_outcomes), [run for run in long_outcomes if run.level == level])
            for level in levels
        },
    }


def _of_level(level: str, outcomes: Sequence) -> list:
    return [outcome for outcome in outcomes if outcome.case.level == level]


def _totals(outcomes, long_outcomes) -> dict[str, int]:
    counts = {status: sum(outcome.status == status for outcome in outcomes) for status in OUTCOMES}
    for run in long_outcomes:
        counts[FAILED if run.failure else FINISHED] += 1
    return counts


def _level_report(outcomes: Sequence[Outcome], stock_outcomes: Sequence[StockOutcome], long_outcomes: Sequence[LongRun]) -> dict:
    return {
        **_totals(outcomes, long_outcomes),
        "step_limited_by": counted(outcomes, STEP_LIMITED),
        "step_limited_at_stock": dict(Counter(outcome.status for outcome in stock_outcomes)),
        "failures": _failures(outcomes),
        "failures_at_stock": _failures(stock_outcomes),
        "refused_by": counted(outcomes, REFUSED),
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


def _failures(outcomes: Sequence[Outcome | StockOutcome]) -> list[dict]:
    """Return name, reason and overrides of each failed case."""
    failed = [outcome for outcome in outcomes if outcome.status == FAILED]
    return [{"case": each.case.name, "reason": each.reason, "overrides": list(each.case.overrides)} for each in failed]


def _worst(outcomes: Sequence[Outcome]) -> dict[str, dict]:
    """Return the most expensive case by each measure of cost."""
    costliest = {name: max(outcomes, key=lambda outcome: getattr(outcome, name), default=None) for name in _COSTS}
    return {name: {"case": found.case.name, "value": getattr(found, name)} for name, found in costliest.items() if found is not None}


def counted(outcomes: Sequence[Outcome | StockOutcome], status: str) -> dict[str, int]:
    """Count the reasons of one outcome without their numbers, most frequent first."""
    kinds = (lambda reason: [reason.split(" (")[0]]) if status == "failed" else kinds_of_reason
    counts = Counter(reason for outcome in outcomes if outcome.status == status for reason in kinds(outcome.reason))
    return dict(counts.most_common())


def kinds_of_reason(reason: str) -> list[str]:
    """Return the fields named in a refusal, or the limits of a step-limited run, without numbers."""
    named = [name for name in _NAMED.findall(reason) if name not in ("bearing", "scene")]
    return list(dict.fromkeys(named or [part.split(":")[0] for part in reason.split(", ")]))


# x, factor, label, scale; y, factor, label, scale
_VIEWS = (
    (("shaft_speed_rpm", 1e-3, "shaft speed [1000 rpm]", "linear"), ("radial_load", 1e-3, "radial load [kN]", "symlog")),
    (("clearance", 1e6, "clearance at low points [µm]", "symlog"), ("rollers", 1.0, "rollers", "linear")),
    (("pocket_clearance", 1e6, "pocket clearance [µm]", "log"), ("guide_clearance", 1e6, "guide clearance [µm]", "log")),
    (("tolerances", 1.0, "tolerances over the default ones", "log"), ("step", 1e6, "longest or fixed step [µs]", "log")),
)
_LINEAR_TO = {"radial_load": 0.1, "clearance": 10.0}  # of a symlog axis, in its unit


def plot_extremes(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    levels = list(dict.fromkeys(outcome.case.level for outcome in outcomes))
    figure = new_figure(15, 0.9 + 3.5 * len(levels))
    grid = figure.subplots(len(levels), len(_VIEWS), squeeze=False)
    for row, level in zip(grid, levels):
        ours = [outcome for outcome in outcomes if outcome.case.level == level]
        sampled = [outcome for outcome in ours if "shaft_speed_rpm" in outcome.case.point]
        for axes, (x, y) in zip(row, _VIEWS):
            _draw_view(axes, sampled, x, y)
        row[0].set_title(f"level {level}: {_counts(sampled)}\ncorners: {_counts([o for o in ours if o not in sampled])}", loc="left", fontsize=10)
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), frameon=False, markerscale=1.3)
    figure.suptitle("Stability map: scenes at the extremes by Latin hypercube", x=0.01, ha="left")
    figure.savefig(path, dpi=110)


def _counts(outcomes: Sequence[Outcome]) -> str:
    return ", ".join(f"{sum(outcome.status == status for outcome in outcomes)} {_shown(status)}" for status in LOOKS)


def _shown(status: str) -> str:
    return status.replace("_", "-")


def _draw_view(axes, outcomes, x, y) -> None:
    for status, look in LOOKS.items():
        points = [outcome.case.point for outcome in outcomes if outcome.status == status]
        axes.scatter([x[1] * point[x[0]] for point in points], [y[1] * point[y[0]] for point in points], label=_shown(status), **look)
    for name, (field, _, label, scale) in (("x", x), ("y", y)):
        options = {"linthresh": _LINEAR_TO[field]} if scale == "symlog" else {}
        axes.set(**{f"{name}label": label})
        getattr(axes, f"set_{name}scale")(scale, **options)
    axes.tick_params(labelsize=9)
    axes.grid(color="#e6e6e6", lw=0.6)
    axes.set_axisbelow(True)


_COUNTED = tuple(name for name in Outcome._fields if name != "case")


def table_rows(outcomes: Sequence[Outcome]) -> list[dict[str, str]]:
    """Return a row per case: its parameters, outcome, cost, and the overrides that reproduce it."""
    dimensions = list(dict.fromkeys(name for outcome in outcomes for name in outcome.case.point))
    return [
        {"level": outcome.case.level, "case": outcome.case.name}
        | {name: _text(getattr(outcome, name)) for name in _COUNTED}
        | {name: _text(outcome.case.point.get(name, "")) for name in dimensions}
        | {"overrides": " ".join(f"--set '{override}'" for override in outcome.case.overrides)}
        for outcome in outcomes
    ]


def _text(value) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
