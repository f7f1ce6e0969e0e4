# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Variants of a scene at its extremes: which of them finish, are limited by steps, are refused or fail, and whether their books of energy close.

Each variant is a list of overrides of the scene, so that ``bearing-sim run SCENE --set ...`` repeats any of them.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from scipy.stats import qmc

from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.studies.extreme_run import COURSES, FAILED, FINISHED, OUTCOMES, REFUSED, STEP_LIMITED, Case, StockOutcome, outcome_fields
from bearing_sim.sweep.pictures import new_figure
from bearing_sim.sweep.tasks import IN_MEMORY, Execution, task

# How far the variants go; assumptions, chosen wider than what a machine sees.
_FASTEST, _HEAVIEST = 2.0, 5.0  # times the scene's speed and load
_AT_REST, _WITHOUT_LOAD = 0.05, 0.05  # fractions of the variants
_COLDEST, _WARMEST = 233.15, 423.15  # K of the oil
_TIGHTER, _LOOSER = -50e-6, 500e-6  # m of radius of the outer raceway, most of them near zero
_MASSES, _PLAYS = (0.1, 10.0), (0.1, 10.0)  # times those of the cage, of its pockets and lands
_MISALIGNMENT = 5e-3  # rad
_UNITS = {"operating.shaft_speed": " rad/s"}  # which a scene wants in words


def linear(low: float, high: float) -> Callable[[float], float]:
    """Return the law that spreads values evenly; as all laws, of a number from 0 to 1."""
    return lambda u: low + (high - low) * u


def logarithmic(low: float, high: float) -> Callable[[float], float]:
    """Return the law that spreads the logarithms of values evenly."""
    return lambda u: low * (high / low) ** u


def choice(*options) -> Callable:
    """Return the law that takes each of some options equally often."""
    return lambda u: options[min(int(u * len(options)), len(options) - 1)]


def or_zero(fraction: float, law: Callable[[float], float]) -> Callable[[float], float]:
    """Return a law that is exactly 0 for a fraction of all samples."""
    return lambda u: 0.0 if u < fraction else law((u - fraction) / (1.0 - fraction))


def _dimensions(scene: Scene) -> Mapping[str, Callable[[float], float | str]]:
    """Return the laws from a number between 0 and 1 to a value [SI], by field; ``course`` is that of the inputs."""
    bearing, operating = scene.bearing, scene.operating
    cage = bearing.cage
    laws = {
        "course": choice(*COURSES),
        "operating.shaft_speed": lambda u: 0.0 if abs(2.0 * u - 1.0) < _AT_REST else _FASTEST * (2.0 * u - 1.0) * abs(operating.shaft_speed),
        "operating.radial_load": or_zero(_WITHOUT_LOAD, lambda u: _HEAVIEST * u**3 * operating.radial_load),
        "operating.load_angle": linear(0.0, 2.0 * math.pi),
        "lubricant.temperature": linear(_COLDEST, _WARMEST),
        "bearing.outer_raceway.low_radius": lambda u: (
            bearing.outer_raceway.low_radius + (_TIGHTER * (1.0 - 2.0 * u) if u < 0.5 else _LOOSER * (2.0 * u - 1.0) ** 3)
        ),
        "operating.misalignment": lambda u: _MISALIGNMENT * u * u,
    }
    for name in ("mass", "pocket_clearance", "guide_clearance"):
        value = getattr(cage, name, None)
        if value:
            low, high = _MASSES if name == "mass" else _PLAYS
            laws[f"bearing.cage.{name}"] = logarithmic(low * value, high * value)
    return laws


def variants(name: str, overrides: Sequence[str], samples: int, seed: int) -> list[Case]:
    """Return a Latin hypercube of variants of a scene, over the fields that the scene takes.

    Parameters
    ----------
    name : of the scene, see `load_scene`.
    overrides : of all variants.
    samples : number of variants.
    seed : the same seed gives the same variants.

    Raises
    ------
    SceneError
        The scene itself is invalid.
    """
    scene = load_scene(name, overrides)
    laws = {field: law for field, law in _dimensions(scene).items() if field == "course" or takes(name, [*overrides, _override(field, law(0.5))])}
    cases = []
    for number, row in enumerate(qmc.LatinHypercube(len(laws), seed=seed).random(samples)):
        point = {field: law(float(u)) for (field, law), u in zip(laws.items(), row)}
        changed = [_override(field, value) for field, value in point.items() if field != "course"]
        cases.append(Case(f"sample {number}", scene.level, (*overrides, *changed), point["course"], point, scene=name))
    return cases


def _override(field: str, value: float) -> str:
    return f"{field}={value!r}{_UNITS.get(field, '')}"


def takes(name: str, overrides: Sequence[str]) -> bool:
    """Return whether a scene accepts overrides."""
    try:
        load_scene(name, overrides)
    except SceneError:
        return False
    return True


def run_extremes(cases: Sequence[Case], execution: Execution = IN_MEMORY) -> list[StockOutcome]:
    """Run variants of a scene and return their outcomes.

    Parameters
    ----------
    cases : see `variants`.
    execution : see `bearing_sim.sweep.tasks.Execution`.
    """
    results = execution.run([task(case.level, outcome_fields, case) for case in cases])
    return [StockOutcome(**{"case": case} | result) for case, result in zip(cases, results)]


def counts(outcomes: Sequence[StockOutcome]) -> dict[str, int]:
    """Return how many runs had each outcome."""
    found = Counter(outcome.status for outcome in outcomes)
    return {status: found[status] for status in OUTCOMES}


def table_rows(outcomes: Sequence[StockOutcome]) -> list[dict]:
    """Return a row per run: what was varied, the outcome, its cost, and the overrides that repeat it."""
    named = [each for each in StockOutcome._fields if each != "case"]
    return [
        {"case": outcome.case.name}
        | dict(outcome.case.point)
        | {each: getattr(outcome, each) for each in named}
        | {"overrides": " ".join(f"--set '{override}'" for override in outcome.case.overrides)}
        for outcome in outcomes
    ]


# Okabe and Ito's colours, safe for colour-blind readers; markers repeat the information.
LOOKS = {
    FINISHED: {"color": "#0072B2", "marker": "o", "s": 9, "alpha": 0.6, "linewidths": 0},
    STEP_LIMITED: {"color": "#E69F00", "marker": "s", "s": 14, "alpha": 0.85, "linewidths": 0},
    REFUSED: {"color": "#7a7a7a", "marker": "x", "s": 16, "alpha": 0.9, "linewidths": 0.9},
    FAILED: {"color": "#D55E00", "marker": "*", "s": 130, "edgecolors": "black", "linewidths": 0.6, "zorder": 5},
}
"""Look of the points of each outcome."""
_VIEWS = (  # field, factor, label
    (("operating.shaft_speed", 30.0 / math.pi, "shaft speed [rpm]"), ("operating.radial_load", 1e-3, "radial load [kN]")),
    (("lubricant.temperature", 1.0, "oil temperature [K]"), ("bearing.outer_raceway.low_radius", 1e3, "radius of the outer raceway [mm]")),
)


def plot_extremes(path: Path, title: str, outcomes: Sequence[StockOutcome]) -> None:
    """Draw the outcomes over speed and load, and over oil temperature and play; the suffix of ``path`` gives the format."""
    figure = new_figure(11, 4.6)
    for axes, (x, y) in zip(figure.subplots(1, len(_VIEWS)), _VIEWS):
        for status, look in LOOKS.items():
            points = [each.case.point for each in outcomes if each.status == status and x[0] in each.case.point and y[0] in each.case.point]
            axes.scatter(
                [x[1] * p[x[0]] for p in points], [y[1] * p[y[0]] for p in points], label=f"{len(points)} {status.replace('_', '-')}", **look
            )
        axes.set(xlabel=x[2], ylabel=y[2])
        axes.grid(color="#e6e6e6", lw=0.6)
        axes.set_axisbelow(True)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    figure.suptitle(title, x=0.01, ha="left")
    figure.savefig(path, dpi=110)
