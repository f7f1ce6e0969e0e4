# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The claims of Deng 2017, sections 4 and 5, tested on the tables of this code: verdict, deviation and reason.

A reason is given only if the numbers show it.  Means over the end of a run are accurate to about 1 %; smaller changes do not count.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.studies.machining import Blank, Machined, Pressing, machine
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table
from deng2017.study import ANGLE, D_VALUE, LOAD, LOW, LOW_RADII, MASS, MIXTURE, ROUNDNESS, SPEED

HOLDS, IN_PART, FAILS = "holds", "holds in part", "does not hold"
NOISE = 0.01  # relative; smaller changes between points do not count
VIBRATES = 1.15  # ratio of the equivalent inner load to that of level slip, which has no vibration
DENG_TEN_PERCENT = 0.105  # mm; D value above which Deng's slip exceeds 10 % at R_low = 34.8650 mm
DENG_LIFE = 300.0  # h
DENG_SHORT_LIFE_D, DENG_SHORT_LIFE_ROUNDNESS = 0.095, 6.0  # mm, um: Deng's life is below `DENG_LIFE` under this D, and above this roundness
_SAME = 1e-6  # relative; values nearer to a limit are at it
# An independent calculation at level slip with the same parameters: D value [mm] and slip [%] at R_low = 34.8650 mm.
INDEPENDENT_SLIP = {0.085: 9.2, 0.095: 10.5, 0.098: 10.9, 0.105: 11.8, 0.12: 14.1}
VIBRATION = f"the inner ring vibrates there: its equivalent load exceeds {VIBRATES} times that of level slip, which has no vibration"
FREE_RING = "a free ring shifts until the three different low points carry alike"
AT_RADII = f"at R_low = {', '.join(f'{low:.4f}' for low in LOW_RADII)} mm"
Tables = Mapping[tuple[str, str], Table]


class Finding(NamedTuple):
    """One claim at one level."""

    claim: int
    figures: str
    says: str  # by Deng
    level: str
    verdict: str
    gives: str  # this code
    off: str  # deviation from the claim; empty if it holds
    why: str  # reason for the deviation


class Judged(NamedTuple):
    """Result of the test of a claim."""

    verdict: str
    gives: str
    off: str = ""
    why: str = ""


class Course(NamedTuple):
    """A quantity over a variable, and where the inner ring vibrates."""

    x: np.ndarray
    y: np.ndarray
    vibrating: np.ndarray

    def backward(self, rising: bool = True) -> list[int]:
        """Return the steps in the wrong direction by more than noise."""
        steps = np.diff(self.y) * (1 if rising else -1)
        return np.flatnonzero(~(steps > -NOISE * np.abs(self.y[:-1]))).tolist()


def course(tables: Tables, name: str, level: str, x: str, y: str, **fixed: float) -> Course:
    """Return a quantity of a sweep over one of its variables, in increasing order.

    Parameters
    ----------
    tables : by the name of the sweep and the level.
    name, level : of the sweep.
    x, y : columns.
    fixed : values of the other variables, by the last part of their names.
    """
    still = select_fixed(tables[name, "slip"], fixed)
    rows = select_fixed(tables[name, level], fixed)
    pairs = sorted(zip(rows, still), key=lambda pair: pair[0][x])
    ratios = np.array([row["inner_equivalent_load"] / other["inner_equivalent_load"] for row, other in pairs])
    return Course(*(np.array([row[column] for row, _ in pairs], float) for column in (x, y)), ratios > VIBRATES)


def select_fixed(table: Table, fixed: Mapping[str, float]) -> list[dict]:
    """Return the rows of a table with the given values to 9 digits, by the last part of their columns' names."""
    names = {column.name.rpartition(".")[2]: column.name for column in table.columns}
    return [row for row in table.rows if all(math.isclose(row[names[name]], value, rel_tol=1e-9) for name, value in fixed.items())]


def _deviation(steps: Sequence[tuple[Course, int]], unit: str) -> tuple[str, str]:
    """Return a description of the steps in the wrong direction, and whether a vibrating ring explains them; empty without such steps."""
    if not steps:
        return "", ""
    worst, at = max(steps, key=lambda step: abs(_change(*step)))
    between = f"between {worst.x[at]:.7g} and {worst.x[at + 1]:.7g} {unit}"
    counted = f"{len(steps)} steps between points go" if len(steps) > 1 else "1 step between points goes"
    off = f"{counted} in the wrong direction, the largest {100 * _change(worst, at):+.0f} % {between}"
    shaken = sum(bool(each.vibrating[k] or each.vibrating[k + 1]) for each, k in steps)
    if shaken == len(steps):
        return off, VIBRATION
    return off, f"the inner ring vibrates at {shaken} of them; the others are not explained" if shaken else "not explained"


def _change(course, k):
    return (course.y[k + 1] - course.y[k]) / course.y[k]


def _ends(course: Course, form: str = "") -> str:
    return " to ".join(f"{value:{form or ('.3g' if abs(value) < 1000 else '.0f')}}" for value in course.y[[0, -1]])


def _verdict(broken: int, steps: int) -> str:
    return HOLDS if broken == 0 else IN_PART if broken <= 0.5 * steps else FAILS


def _rise_together(tables, level, name, x, unit) -> Judged:
    """Judge whether slip and life both rise over a variable."""
    slip, life = (course(tables, name, level, x, quantity) for quantity in ("cage_slip", "rating_life"))
    wrong = [(each, k) for each in (slip, life) for k in each.backward()]
    gives = f"slip {_ends(slip)} %, life {_ends(life)} h from {slip.x[0]:.7g} to {slip.x[-1]:.7g} {unit}"
    return Judged(_verdict(len(wrong), 2 * len(slip.x) - 2), gives, *_deviation(wrong, unit))


def low_radius(tables: Tables, level: str) -> Judged:
    """Judge claim 1."""
    judged = _rise_together(tables, level, "low_radius", LOW, "mm")
    if judged.why == VIBRATION:
        judged = judged._replace(why=f"{judged.why}; {_by_mass(tables, level)}")
    slip = course(tables, "low_radius", level, LOW, "cage_slip")
    slopes = np.diff(slip.y) / np.diff(slip.x)
    slower = [k for k in range(len(slopes) - 1) if slopes[k + 1] < slopes[k] * (1 - NOISE)]
    gives = f"{judged.gives}; slope of slip {1e-3 * slopes[0]:.2g} to {1e-3 * slopes.max():.2g} points/um"
    if judged.verdict != HOLDS or not slower:
        return judged._replace(gives=gives)
    drags = [row["churning_power"] for row in tables["low_radius", level].rows]
    off = f"the slope rises only up to {slip.x[slower[0] + 1]:.7g} mm; at the end it is {1e-3 * slopes[-1]:.3g} points/um"
    churning = f"churning takes {drags[0]:.0f} W at the first radius and {drags[-1]:.0f} W at the last"
    why = f"the drag that causes the slip decreases with the square of the cage's speed: {churning}"
    return Judged(IN_PART, gives, off, why)


def _by_mass(tables, level) -> str:
    """Return a description of slip and life with other shaft masses, and of multiple steady states."""
    rows = tables["supported_mass", level].rows
    results = ", ".join(f"{row[MASS]:g} kg {row['cage_slip']:.1f} % and {row['rating_life']:.0f} h" for row in rows)
    text = f"it depends on the shaft's mass, at 34.8675 mm {results}"
    near = tables["neighbours", level].rows
    slips = np.sort([row["cage_slip"] for row in near])
    widest = int(np.argmax(np.diff(slips)))
    if slips[widest + 1] - slips[widest] > 2.0:
        states = f"{slips[: widest + 1].mean():.1f} % slip at {widest + 1} of {len(slips)} speeds, {slips[widest + 1 :].mean():.1f} % at the others"
        text += f"; two states are possible: from {near[0][SPEED]:.0f} to {near[-1][SPEED]:.0f} rpm {states}"
    return text


def d_value(tables: Tables, level: str) -> Judged:
    """Judge claim 2."""
    judged = _rise_together(tables, level, "d_value", D_VALUE, "mm")
    slip = course(tables, "map", level, D_VALUE, "cage_slip", low_radius=34.8650)
    at = _crossing(slip, 10.0)
    crossed = (
        f"slip reaches 10 % at D = {at:.4f} mm"
        if np.isfinite(at)
        else f"slip exceeds 10 % from D = {slip.x[0]:g} mm"
        if slip.y[0] > 10
        else "slip stays below 10 %"
    )
    shared = [d for d in INDEPENDENT_SLIP if np.isclose(slip.x, d).any()]
    beside = ", ".join(f"{np.interp(d, slip.x, slip.y):.1f}" for d in shared)
    independent = f"an independent calculation at level slip gives {', '.join(str(INDEPENDENT_SLIP[d]) for d in shared)} %"
    gives = f"{judged.gives}; at R_low = 34.8650 mm {crossed}: {beside} % at D = {', '.join(f'{d:g}' for d in shared)} mm; {independent}"
    there, needed = float(np.interp(DENG_TEN_PERCENT, slip.x, slip.y)), _crossing(course(tables, "mixture", level, MIXTURE, "cage_slip"), 10.0)
    off = f"at 34.8650 mm and D = {DENG_TEN_PERCENT} mm slip is {there:.1f} %, not 10 %"
    why = "Deng does not give the mixture fraction, which determines the drag; 3 % is the default of this package"
    if np.isfinite(needed):
        why += f", {100 * needed:.1f} % would give 10 %"
    wrong = [(slip, k) for k in slip.backward()]
    deviation, reason = _deviation(wrong, "mm")
    verdict = IN_PART if judged.verdict == HOLDS and (wrong or abs(there - 10.0) > 1.0) else judged.verdict
    return Judged(verdict, gives, _joined(judged.off, off, deviation), _joined(judged.why, why, reason))


def _joined(*texts: str) -> str:
    return "; ".join(filter(None, texts))


def _crossing(course: Course, value: float) -> float:
    """Return where a quantity first reaches a value, interpolated linearly; NaN if it starts above or never reaches it."""
    above = np.flatnonzero(course.y >= value)
    if not len(above) or above[0] == 0:
        return np.nan
    k = above[0]
    return float(np.interp(value, course.y[k - 1 : k + 1], course.x[k - 1 : k + 1]))


def speed(tables: Tables, level: str) -> Judged:
    """Judge claim 3."""
    slips = [course(tables, "speed", level, SPEED, "cage_slip", low_radius=low) for low in LOW_RADII]
    wrong = [(each, k) for each in slips for k in each.backward()]
    rises = [each.y[-1] - each.y[0] for each in slips]
    ordered = all(b > a for a, b in zip(rises, rises[1:]))
    listed = ", ".join(f"{rise:.1f}" for rise in rises)
    gives = f"from {slips[0].x[0]:.6g} to {slips[0].x[-1]:.6g} rpm slip rises by {listed} points {AT_RADII}"
    verdict = _verdict(len(wrong), sum(len(each.x) - 1 for each in slips))
    if verdict == HOLDS and not ordered:
        verdict = IN_PART
    off, why = _deviation(wrong, "rpm")
    if not ordered:
        off = _joined(off, "the rise does not increase with the radius")
        shaken = [f"{low:.4f}" for low, each in zip(LOW_RADII, slips) if each.vibrating[-1]]
        if shaken:
            why = _joined(why, f"at the highest speed the ring vibrates at {', '.join(shaken)} mm")
    return Judged(verdict, gives, off, why)


def load(tables: Tables, level: str) -> Judged:
    """Judge claim 4."""
    slips = [course(tables, "load", level, LOAD, "cage_slip", low_radius=low) for low in LOW_RADII]
    tight, *middle, loose = slips
    parts, off = [], []
    changes = [100 * (each.y[-1] / each.y[0] - 1) for each in slips]
    parts.append(100 * np.ptp(tight.y) / tight.y[0] < 10.0)
    if not parts[-1]:
        off.append(f"at {LOW_RADII[0]:.4f} mm slip changes by {100 * np.ptp(tight.y) / tight.y[0]:.0f} % of its value")
    for low, each in zip(LOW_RADII[1:], middle):
        slopes = np.diff(each.y) / np.diff(each.x)
        parts.append(abs(slopes[0] * 500 / each.y[0]) < 0.05 and each.y[-1] < 0.97 * each.y[0] and abs(slopes[-1]) > 2 * abs(slopes[0]))
        if not parts[-1]:
            off.append(f"at {low:.4f} mm slip falls by {-1e3 * slopes[0]:.2g} points/kN at first and by {-1e3 * slopes[-1]:.2g} at the end")
    parts.append(loose.y[-1] < 0.9 * loose.y[0] and not loose.backward(rising=False))
    wrong = [(each, k) for each in slips for k in each.backward(rising=False)]
    deviation, why = _deviation(wrong, "N")
    why = why or ("not explained" if off else "")
    thresholds = [f"{each.x[np.argmax(each.y < 0.95 * each.y[0])]:.0f}" if (each.y < 0.95 * each.y[0]).any() else "none" for each in slips]
    listed = ", ".join(f"{change:+.0f}" for change in changes)
    gives = f"slip changes by {listed} % of its value over {tight.x[0]:g} to {tight.x[-1]:g} N {AT_RADII}"
    gives += f"; first load with 5 % less slip: {', '.join(thresholds)} N; the fall begins gradually"
    return Judged(HOLDS if all(parts) else IN_PART if any(parts) else FAILS, gives, _joined(*off, deviation), why)


def angle(tables: Tables, level: str) -> Judged:
    """Judge claim 5."""
    slip, life = (course(tables, "angle", level, ANGLE, quantity) for quantity in ("cage_slip", "rating_life"))
    gives = f"slip {slip.y.min():.3f} to {slip.y.max():.3f} %, life {_ends(life)} h ({100 * (life.y[-1] / life.y[0] - 1):+.1f} %)"
    unchanged, rises = np.ptp(slip.y) < 0.02 * slip.y[0], not life.backward() and 0 < life.y[-1] / life.y[0] - 1 < 0.15
    off = "; ".join(text for text, holds in (("slip changes", unchanged), ("life does not rise slightly", rises)) if not holds)
    return Judged(HOLDS if unchanged and rises else IN_PART if unchanged or rises else FAILS, gives, off, "not explained" if off else "")


def roundness(tables: Tables, level: str) -> Judged:
    """Judge claim 6."""
    slip, life = (course(tables, "roundness", level, ROUNDNESS, quantity) for quantity in ("cage_slip", "rating_life"))
    fall, highest = 100 * (life.y[-1] / life.y[0] - 1), slip.y.max() - slip.y[0]
    gives = f"life {_ends(life)} h ({fall:+.1f} %), slip {_ends(slip, '.3f')} %, highest {slip.y.max():.3f} % over 0 to {slip.x[-1]:g} um"
    falls, rises = bool(np.all(np.diff(life.y) < 0)), highest > NOISE * slip.y[0]
    off = [] if falls else ["life does not fall at every step"]
    if not rises:
        off.append(f"slip rises by {highest:.3f} points at most, within the accuracy of the means")
    if fall > -5:
        off.append(f"life falls by {-fall:.1f} %, by 12 % in an independent calculation whose ring moves only along the load")
    why = f"{FREE_RING}; "
    why += "held on the load line it loses as much as in the independent calculation (test_roundness.py)"
    return Judged(HOLDS if falls and rises else IN_PART if falls or rises else FAILS, gives, "; ".join(off), why if off else "")


def preload(tables: Tables, level: str) -> Judged:
    """Judge claim 7."""
    life, rollers, inner = (
        course(tables, "low_radius", level, LOW, quantity) for quantity in ("rating_life", "loaded_rollers", "inner_load_maximum")
    )
    lives = [float(np.interp(low, life.x, life.y)) for low in (34.86, 34.8625, 34.865)]
    answered = lives[0] < 300 <= min(lives[1:])
    wrong = [(each, k) for each in (rollers, inner) for k in each.backward(rising=False)]
    gives = f"life {', '.join(f'{hours:.0f}' for hours in lives)} h at R_low = 34.8600, 34.8625, 34.8650 mm"
    gives += f"; from 34.8600 to 34.8675 mm loaded rollers {_ends(rollers)}, largest roller load {_ends(inner, '.0f')} N"
    off, why = _deviation(wrong, "mm")
    if not answered:
        off = _joined("the radii that meet 300 h differ from Deng's", off)
        why = why or "not explained"
    verdict = _verdict(len(wrong), 2 * len(life.x) - 2)
    return Judged(verdict if answered else FAILS if verdict == FAILS else IN_PART, gives, off, why)


def loads_over_speed(tables: Tables, level: str) -> Judged:
    """Judge claim 8."""
    inner, outer = (
        [course(tables, "speed", level, SPEED, f"{ring}_load_maximum", low_radius=low) for low in LOW_RADII] for ring in ("inner", "outer")
    )
    wrong = [(each, k) for each in inner for k in each.backward(rising=False)] + [(each, k) for each in outer for k in each.backward()]
    gives = "largest loads from the lowest to the highest speed: inner " + ", ".join(_ends(each, ".0f") for each in inner)
    gives += " N, outer " + ", ".join(_ends(each, ".0f") for each in outer) + " N at the four radii"
    if not wrong:
        return Judged(HOLDS, gives)
    off, why = _deviation(wrong, "rpm")
    still = [course(tables, "speed", "slip", SPEED, "inner_load_maximum", low_radius=low) for low in LOW_RADII]
    changes = np.concatenate([(each.y / other.y - 1)[~each.vibrating] for each, other in zip(inner, still)])
    scatter = f"{100 * changes.min():+.0f} to {100 * changes.max():+.0f} %"
    weaker = f"elsewhere weaker vibration changes the largest load at an instant by {scatter}, more than rotation does"
    why = why.replace("the others are not explained", weaker)
    return Judged(_verdict(len(wrong), 8 * (len(inner[0].x) - 1)), gives, off, why)


def table2(tables: Tables, level: str) -> Judged:
    """Judge claim 9."""
    slip = course(tables, "table2", level, SPEED, "cage_slip")
    wrong = [(slip, k) for k in slip.backward()]
    gives = f"slip {_ends(slip)} % from {slip.x[0]:.6g} to {slip.x[-1]:.6g} rpm"
    return Judged(_verdict(len(wrong), len(slip.x) - 1), gives, *_deviation(wrong, "rpm"))


def short_life_of_low_lobes(tables: Tables, level: str) -> Judged:
    """Judge claim 10."""
    life = course(tables, "d_value", level, D_VALUE, "rating_life")
    judged = _short_life(life, life.x < DENG_SHORT_LIFE_D * (1 - _SAME), "D", "mm")
    if not judged.off:
        return judged
    shared = [d for d in sorted(set(tables["map", level].values(D_VALUE))) if d < DENG_SHORT_LIFE_D]
    reached = _crossing(course(tables, "map", level, LOW, "rating_life", d_value=shared[0]), DENG_LIFE) if shared else np.nan
    if not np.isfinite(reached):
        return judged._replace(why="not explained")
    why = f"R_low decides life more than D does: at D = {shared[0]:g} mm it falls to {DENG_LIFE:g} h at R_low = {reached:.4f} mm, by interpolation"
    return judged._replace(why=why)


def short_life_of_uneven_lobes(tables: Tables, level: str) -> Judged:
    """Judge claim 11."""
    life = course(tables, "roundness", level, ROUNDNESS, "rating_life")
    judged = _short_life(life, life.x > DENG_SHORT_LIFE_ROUNDNESS * (1 + _SAME), "roundness", "um")
    if not judged.off:
        return judged
    why = f"{FREE_RING}; held on the load line it keeps 343 h at 10 um in an independent calculation, which is not below {DENG_LIFE:g} h either"
    return judged._replace(why=why)


def _short_life(life: Course, is_short: np.ndarray, name: str, unit: str) -> Judged:
    """Judge whether life is below Deng's limit at some points, and at these alone.

    Parameters
    ----------
    life : over a variable.
    is_short : where Deng says that it is below, shape of the course.
    name, unit : of the variable.
    """
    below, gives = life.y < DENG_LIFE, f"life {_ends(life)} h from {name} = {life.x[0]:g} to {life.x[-1]:g} {unit}"
    off = []
    if (~below)[is_short].any():
        least = np.flatnonzero(is_short)[np.argmin(life.y[is_short])]
        off.append(f"where Deng has less than {DENG_LIFE:g} h, life is {life.y[least]:.0f} h at least, at {name} = {life.x[least]:g} {unit}")
    if below[~is_short].any():
        off.append(f"life is below {DENG_LIFE:g} h at {', '.join(f'{x:g}' for x in life.x[below & ~is_short])} {unit}, too")
    shown = below[is_short].any()  # a life that is long everywhere does not show the limit anywhere
    return Judged(HOLDS if not off else IN_PART if shown else FAILS, gives, _joined(*off))


CLAIMS: tuple[tuple[int, str, str, Callable[[Tables, str], Judged]], ...] = (
    (1, "11", "Slip and life both rise with R_low, slip ever faster (34.8600 to 34.8675 mm, D = 0.098 mm)", low_radius),
    (2, "13, 21", "Slip and life rise with D; about 10 % slip at R_low = 34.8650 mm, over 10 % once D > 0.105 mm", d_value),
    (3, "15", "Slip rises with speed (15,000 to 52,000 rpm), the faster the larger R_low", speed),
    (4, "17", "R_low = 34.8600 mm: slip does not change with load; 34.8625, 34.8650: flat, then falls beyond a threshold; 34.8675: falls", load),
    (5, "19, 20", "Installation angle 0 to 60 deg: slip unchanged, life rises a little", angle),
    (6, "22", "Roundness up: life down, slip up a little", roundness),
    (7, "12", "Life of 300 h is met at R_low = 34.8625 to 34.8650 mm, not at 34.8600; fewer rollers loaded and lower loads as R_low grows", preload),
    (8, "16", "The inner contact force falls and the outer rises with speed (centrifugal force)", loads_over_speed),
    (9, "23", "Bearing of Table 2: slip rises steadily from 15,000 to 52,000 rpm", table2),
    (10, "14", "Life is below 300 h where D is below 0.095 mm (R_low = 34.8625 mm)", short_life_of_low_lobes),
    (11, "22", "Life is below 300 h where roundness of the low points exceeds 6 um (R_low = 34.8625 mm, D = 0.095 mm)", short_life_of_uneven_lobes),
)


def judge(tables: Tables, levels: Sequence[str]) -> list[Finding]:
    """Return the findings for every claim at every level.

    Parameters
    ----------
    tables : of the sweeps in `deng2017.study`, by name and level.
    levels : to judge, in this order.
    """
    return [Finding(number, figures, says, level, *test(tables, level)) for number, figures, says, test in CLAIMS for level in levels]


ARC_TURNS = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)  # deg, rotation of one pressed arc in figures 3 and 10
_SECTION = Blank(35.8e-3, 12e-3, 3.4e-3, 206e9)  # defaults of `bearing-sim machine`
_PRESSURE, _LOW_RADIUS = 2.0e6, 34.8625e-3


def machined_rings() -> dict[float, Machined]:
    """Return the released raceways by the rotation of one arc [deg], all ground to the radius that fits the low points at 0 deg."""
    ground = machine(_SECTION, Pressing(_PRESSURE), low_radius=_LOW_RADIUS).ground_radius
    return {turn: machine(_SECTION, Pressing(_PRESSURE, math.radians(turn)), ground_radius=ground) for turn in ARC_TURNS}


def machining_table(rings: Mapping[float, Machined]) -> Table:
    """Return low and high points, D value and roundness by the rotation of one arc."""
    rows = [
        {
            "arc_turn": turn,
            "low_radius": 1e3 * float(ring.lows[:, 1].min()),
            "high_radius": 1e3 * float(ring.highs[:, 1].max()),
            "d_value": 1e6 * ring.d_value,
            "roundness": 1e6 * ring.roundness,
        }
        for turn, ring in rings.items()
    ]
    columns = (
        Column("arc_turn", "deg", "rotation of one of the three pressed arcs"),
        Column("low_radius", "mm", "lowest low point"),
        Column("high_radius", "mm", "highest high point"),
        Column("d_value", "um", "mean of the high points minus mean of the low points, D"),
        Column("roundness", "um", "highest minus lowest of the low points"),
    )
    return Table(columns, rows, {"kind": "machining"})


def contour_finding(rings: Mapping[float, Machined]) -> Finding:
    """Return the finding for the claim of figure 3."""
    rows = machining_table(rings).rows
    courses = {name: np.diff([row[name] for row in rows]) for name in ("high_radius", "low_radius", "d_value", "roundness")}
    courses["low_radius"] *= -1
    wrong = [name.replace("_", " ") for name, steps in courses.items() if not (steps > 0).all()]
    first, last = rows[0], rows[-1]
    gives = (
        f"from 0 to {last['arc_turn']:g} deg the highest high point rises by {1e3 * (last['high_radius'] - first['high_radius']):.1f} um, "
        f"the lowest low falls by {1e3 * (first['low_radius'] - last['low_radius']):.1f} um, "
        f"D {first['d_value']:.1f} to {last['d_value']:.1f} um, roundness {first['roundness']:.1f} to {last['roundness']:.1f} um"
    )
    verdict = HOLDS if not wrong else IN_PART if len(wrong) < len(courses) else FAILS
    return Finding(
        0,
        "3, 10",
        "Machining with one arc rotated: high points rise, low points fall, D and roundness grow",
        "elastic ring",
        verdict,
        gives,
        f"not at every step: {', '.join(wrong)}" if wrong else "",
        "not explained" if wrong else "",
    )
