# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pictures of runs: what drives the bearing and what results over time, or slip and life over the load with the line of the minimum load.

Long runs are thinned out so that the least and the largest value of every stretch remain.  Values that are not finite leave gaps in lines.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from bearing_sim.messages.bands import BANDS, ESTIMATES, Bands
from bearing_sim.model.loads import largest_loads
from bearing_sim.model.losses import CAUSES
from bearing_sim.model.plausibility import minimum_load
from bearing_sim.model.sample import RING_TEMPERATURES
from bearing_sim.model.turning import stands_text, turns
from bearing_sim.recording.reader import Recording
from bearing_sim.scene.display import RPM, ZERO_CELSIUS, force, larger_unit, number
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import ranges_of, without_dimensions
from bearing_sim.simulation import Inputs
from bearing_sim.sweep.pictures import COLOURS, NotDrawable, look_of, new_figure, plain_numbers, save, set_limits, with_gaps

_LIFE = "modified_rating_life"
_MOST_POINTS = 4000  # of a line; each stretch of a longer one keeps its least and its largest value
_FEW_POINTS = 3  # of a line that is drawn with marks, too
_BREAK = 10.0  # usual spacings of samples above which a line is interrupted
_LEGEND_WIDTH, _HANDLE_WIDTH = 150, 8  # of a legend below a picture and of the mark before a name, in characters
_LONGEST_TITLE = 110
_DATED = 3600.0  # [s] runs from this long on have the date of their start beside the axis
_STYLES = ("-", "--", "-.", ":", (0, (8, 2)), (0, (1, 3)), (0, (6, 2, 1, 2, 1, 2)))  # of the lines of a panel where colours tell runs apart
_CELLS = (240, 160)  # of a picture of slip over load, of each of which one sample is drawn
_MOST_SLIP = 200.0  # [%] beyond which these cells do not tell slips apart
_INSTANTS = 200  # of a run, at which the range of the slip may be computed
_CONDITIONS = tuple(f"{name}_measured" if name in RING_TEMPERATURES else name for name in Inputs._fields)
_TIMES = ((180.0, 1.0, "s"), (180.0 * 60.0, 60.0, "min"), (72.0 * 3600.0, 3600.0, "h"), (math.inf, 86400.0, "d"))


class Line(NamedTuple):
    """A line of a panel: its name where the panel has several, and its values from a block of samples in the unit of the panel."""

    name: str
    values: Callable[[np.ndarray], np.ndarray]


class Panel(NamedTuple):
    """A panel of a picture.

    Attributes
    ----------
    label : name of what it shows, without the unit.
    unit : of its lines; the axis has a larger one where the values are large (`bearing_sim.scene.display.larger_unit`).
    lines : of one quantity.
    is_logarithmic : whether its axis is.
    has_start : whether the first sample of a run is shown: it is the state from which the solver starts, no result.
    """

    label: str
    unit: str
    lines: tuple[Line, ...]
    is_logarithmic: bool = False
    has_start: bool = True


def _line(name: str, scale: float = 1.0, offset: float = 0.0, shown: str = "") -> Line:
    """Return the line of an observable in another unit."""
    return Line(shown, lambda block: scale * block[name] + offset)


_TEMPERATURES = {
    "oil": "oil_temperature",
    "inner ring": "inner_ring_temperature",
    "outer ring": "outer_ring_temperature",
    "rollers": "roller_temperature",
    "housing": "housing_temperature",
    "inner ring, measured": "inner_ring_temperature_measured",
    "outer ring, measured": "outer_ring_temperature_measured",
}


def _load(block: np.ndarray) -> np.ndarray:
    return np.hypot(block["load_y"], block["load_z"])


def _losses(block: np.ndarray) -> np.ndarray:
    return sum(block[name] for names in CAUSES.values() for name in names)


PANELS = {
    "speed": Panel("shaft speed", "rpm", (_line("shaft_speed", RPM),)),
    "load": Panel("radial load", "N", (Line("", _load),)),
    "slip": Panel("cage slip", "%", (_line("cage_slip", 100.0),)),
    "life": Panel("rating life", "h", (_line(_LIFE),), is_logarithmic=True),
    "temperature": Panel("temperature", "°C", tuple(_line(name, 1.0, -ZERO_CELSIUS, shown) for shown, name in _TEMPERATURES.items())),
    "clearance": Panel("running clearance", "µm", (_line("running_clearance", 1e6),)),
    "damage": Panel("life used", "%", (_line("damage", 100.0),)),
    "roller_load": Panel(
        "largest roller load",
        "N",
        (Line("inner raceway", lambda block: largest_loads(block, "inner")), Line("outer raceway", lambda block: largest_loads(block, "outer"))),
    ),
    "power": Panel("power loss", "W", (Line("", _losses),), has_start=False),
}
"""Panels by name, in the order in which they are drawn."""

DEFAULT_PANELS = ("speed", "load", "slip", "life", "temperature", "clearance")


class SlipBand(NamedTuple):
    """Range of the settled slip where fields of the scene are uncertain: instants [s], shape (m,), and the ends [1], 5 and 95 %, shape (m,)."""

    times: np.ndarray
    low: np.ndarray
    high: np.ndarray


_BANDED = {"slip": ("cage_slip", 100.0), "life": ("rating_life", 1.0), "clearance": ("running_clearance", 1e6)}
"""Quantity with recorded bands of a panel, and by what its unit is smaller than that of the panel."""


class RecordedBand(NamedTuple):
    """A band that a run published, in the unit of its panel: instants [s] and numbers there, each of shape (m,).

    Attributes
    ----------
    times : [s].
    value, low, high : what the run said, its 5 and its 95 % quantile; thinned out to the extremes of each stretch.
    is_calibrated : whether measurements calibrated fields in the run, so that the value is not the one that the level computed.
    own_value : symbol of the value where the line of the panel is another quantity: the life without the factor a_ISO; else ``""``.
    """

    times: np.ndarray
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    is_calibrated: bool
    own_value: str = ""


@dataclass
class Course:
    """What a picture shows of one run.

    Attributes
    ----------
    name : of the run.
    scene : what was simulated.
    panels : names of the panels.
    lines : by panel and number of the line, the times [s] and the values, thinned out.
    loaded : speed [rpm], load [N], slip [%] and life [h] of each sample that shows in a picture over the load, shape (n, 4).
    conditions : time [s] and inputs (`bearing_sim.simulation.Inputs`) at some instants, evenly spaced in samples, shape (m, 7).
    samples : number of samples of the run.
    first, last : simulated times of its ends [s].
    band : range of the slip, if somebody computed one.
    recorded : bands that the run published, by panel.
    start_ns : wall time of sample time 0 [ns since the epoch]; 0 if it is not known.
    """

    name: str
    scene: Scene
    panels: Sequence[str]
    lines: dict[tuple[str, int], tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    loaded: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    conditions: np.ndarray = field(default_factory=lambda: np.zeros((0, 1 + len(Inputs._fields))))
    samples: int = 0
    first: float = math.nan
    last: float = math.nan
    band: SlipBand | None = None
    recorded: dict[str, RecordedBand] = field(default_factory=dict)
    start_ns: int = 0


def read_course(
    recording: Recording, name: str, panels: Sequence[str] = DEFAULT_PANELS, progress: Callable[[float], None] = lambda time: None
) -> Course:
    """Return what a picture shows of a recording, which is read block by block and may be longer than memory.

    Parameters
    ----------
    recording : of a run.
    name : by which a comparison names it.
    panels : names of `PANELS`.
    progress : called repeatedly with the time reached [s].
    """
    bands: list[Bands] = []

    def blocks():
        for item in recording.with_bands():
            if isinstance(item, np.ndarray):
                yield item
            elif isinstance(item, Bands):
                bands.append(item)

    course = course_of(blocks(), recording.scene, name, recording.samples, panels, progress)
    course.start_ns = recording.start_ns
    course.recorded = recorded_bands(bands, course.lines, recording.scene)
    return course


def recorded_bands(bands: Sequence[Bands], lines: Mapping[tuple[str, int], tuple[np.ndarray, np.ndarray]], scene: Scene) -> dict[str, RecordedBand]:
    """Return bands that a run published, in order of time, by the name of the panel that shows them; none where its line has a gap, as at rest.

    Parameters
    ----------
    bands : of the run.
    lines : those of `Course`.
    scene : of the run, whose method of life says what the bands of the life are about.
    """
    is_calibrated = any(each.topic == ESTIMATES for each in bands)
    published = [each for each in bands if each.topic == BANDS]
    if not published:
        return {}
    times, numbers = np.concatenate([each.times for each in published]), np.concatenate([each.numbers for each in published])
    starts = np.arange(0, len(times), max(1, 2 * len(times) // _MOST_POINTS))
    found = {}
    for panel, (quantity, scale) in _BANDED.items():
        if quantity in published[0].names and (panel, 0) in lines:
            value, low, high = scale * numbers[:, published[0].names.index(quantity)].T
            value, low, high = np.where(np.isnan(np.interp(times, *lines[panel, 0])), np.nan, (value, low, high))
            ends = np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)
            own_value = scene.life.symbols[0] if panel == "life" and not scene.life.is_basic else ""
            found[panel] = RecordedBand(times[starts], value[starts], *ends, is_calibrated, own_value)
    return found


def course_of(
    blocks, scene: Scene, name: str, samples: int, panels: Sequence[str] = DEFAULT_PANELS, progress: Callable[[float], None] = lambda time: None
) -> Course:
    """Return what a picture shows of blocks of samples (see `read_course`); ``samples`` is their number in all, which decides the thinning."""
    course = Course(name, scene, panels)
    window, every = max(1, 2 * samples // _MOST_POINTS), max(1, samples // _INSTANTS)
    parts: dict[tuple[str, int], list[np.ndarray]] = {}
    loaded, instants, before, usual = [], [], math.nan, 0.0
    for block in blocks:
        times = block["time"]
        if not len(times):
            continue
        block = _without_slip_at_rest(block, scene)
        begins = not course.samples and samples > 1  # with the state of rolling without slip, which is no result
        spacings = np.diff(times, prepend=before if math.isfinite(before) else times[0])
        usual = usual or float(np.median(spacings[spacings > 0])) if (spacings > 0).any() else usual
        breaks = np.flatnonzero(spacings > max(_BREAK * usual, _BREAK * np.quantile(spacings, 0.9))) if len(times) > 2 else np.zeros(0, int)
        for panel in panels:
            for k, line in enumerate(PANELS[panel].lines):
                values = line.values(block)
                if begins and not PANELS[panel].has_start:
                    values = np.append(np.nan, values[1:])
                parts.setdefault((panel, k), []).append(thinned(times, values, window, breaks))
        results = block[1:] if begins else block
        loaded.append(_one_per_cell(np.stack([results["shaft_speed"] * RPM, _load(results), 100 * results["cage_slip"], results[_LIFE]], -1)))
        chosen = block[-course.samples % every :: every]
        instants.append(np.stack([chosen["time"], *(chosen[name] for name in _CONDITIONS)], -1))
        course.samples += len(times)
        course.first, course.last = (float(times[0]) if math.isnan(course.first) else course.first), float(times[-1])
        before = course.last
        progress(course.last)
    course.loaded, course.conditions = np.concatenate([course.loaded, *loaded]), np.concatenate([course.conditions, *instants])
    course.lines |= {key: tuple(np.concatenate(pieces, axis=1)) for key, pieces in parts.items()}
    return course


def _without_slip_at_rest(block: np.ndarray, scene: Scene) -> np.ndarray:
    """Return samples whose slip is NaN where the shaft does not turn."""
    turning = turns(block["shaft_speed"], scene.thresholds.slip_from_speed)
    if turning.all():
        return block
    block = block.copy()
    block["cage_slip"][~turning] = np.nan
    return block


def _turning(course: Course) -> np.ndarray:
    return turns(course.loaded[:, 0] / RPM, course.scene.thresholds.slip_from_speed)


def thinned(times: np.ndarray, values: np.ndarray, window: int, breaks: Sequence[int] = ()) -> tuple[np.ndarray, np.ndarray]:
    """Return a line with the least and the largest value of each window of samples, in order of time.

    Parameters
    ----------
    times, values : of the samples, shape (n,).
    window : number of samples of which two remain; all remain where it is 2 or less.
    breaks : samples before which the line is interrupted, by a value that is NaN.

    Returns
    -------
    Times and values of the line; values that are not finite become NaN.
    """
    values = with_gaps(values)
    index = np.arange(len(values))
    if window > 2 and len(values):
        kept = []
        for begin in range(0, len(values), window):
            piece = values[begin : begin + window]
            ends = {0} if np.isnan(piece).all() else {int(np.nanargmin(piece)), int(np.nanargmax(piece))}
            kept += sorted(begin + end for end in ends)
        index = np.array(kept)
    breaks = np.asarray(breaks, int)
    places, between = np.searchsorted(index, breaks), times[np.maximum(breaks - 1, 0)]
    return np.insert(times[index], places, between), np.insert(values[index], places, np.nan)


def _one_per_cell(rows: np.ndarray) -> np.ndarray:
    """Return those of many samples that differ in a picture: the first in each cell of load and slip, and the extremes of each column."""
    if len(rows) <= 200:
        return rows
    load, slip = rows[:, 1], np.clip(np.nan_to_num(with_gaps(rows[:, 2])), -_MOST_SLIP, _MOST_SLIP)
    cells = [np.floor(count * (each - each.min()) / (np.ptp(each) or 1.0)) for each, count in zip((load, slip), _CELLS)]
    _, first = np.unique(np.stack(cells), axis=1, return_index=True)
    extremes = [k for column in with_gaps(rows).T if not np.isnan(column).all() for k in (np.nanargmin(column), np.nanargmax(column))]
    return rows[np.unique([*first, *extremes])]


def plot_over_time(path: Path | BinaryIO, courses: Sequence[Course], title: str = "") -> "object":
    """Draw runs over time into a file, one panel below the other, and return the figure.

    A life has a logarithmic axis; what exceeds the shortest by more than six decades is cut off.

    Parameters
    ----------
    path : its suffix gives the format; or a stream, for PNG.
    courses : at least one; several are compared, each from its own start.
    title : of the picture.
    """
    panels = [PANELS[name] for name in courses[0].panels]
    figure = new_figure(10, 0.9 + 1.75 * len(panels))
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    span = max(course.last - course.first for course in courses)
    divisor, unit = next((divisor, unit) for longest, divisor, unit in _TIMES if span <= longest)
    starts = [course.first for course in courses] if len(courses) > 1 else [0.0]
    for each, name, panel in zip(axes, courses[0].panels, panels):
        _draw_panel(each, name, panel, courses, starts, divisor)
    begin, end = (min(course.first - start for course, start in zip(courses, starts)), max(c.last - s for c, s in zip(courses, starts)))
    ends = (begin / divisor, end / divisor) if span > 0.0 else (begin / divisor - 1.0, begin / divisor + 1.0)
    axes[-1].set(xlabel=_time_label(courses, span, unit), xlim=ends)
    plain_numbers(axes[-1].xaxis)
    _name_courses(figure, courses)
    figure.align_ylabels(axes)
    return _saved(figure, path, title)


def _time_label(courses: Sequence[Course], span: float, unit: str) -> str:
    """Return the label of a time axis; of a long run with the date of its start."""
    if len(courses) > 1:
        return f"simulated time from the start of each run [{unit}]"
    if span < _DATED or not courses[0].start_ns:
        return f"simulated time [{unit}]"
    return f"time since {datetime.fromtimestamp(courses[0].start_ns * 1e-9, UTC):%Y-%m-%d %H:%M} UTC [{unit}]"


def _draw_panel(axes, name: str, panel: Panel, courses: Sequence[Course], starts: Sequence[float], divisor: float) -> None:
    shown = [k for k in range(len(panel.lines)) if any(np.isfinite(course.lines[name, k][1]).any() for course in courses)]
    unit, factor = larger_unit(panel.unit, np.concatenate([course.lines[name, k][1] for course in courses for k in shown] or [np.zeros(0)]))
    several = len(courses) > 1  # then the colour tells the runs apart, and the line what it is of
    every = []
    for place, course in enumerate(courses):
        for k in shown:
            times, values = course.lines[name, k]
            marks = {"marker": "o", "ms": 4} if 0 < np.isfinite(values).sum() <= _FEW_POINTS else {}
            style = {"color": COLOURS[(place if several else k) % len(COLOURS)], "ls": _STYLES[k % len(_STYLES)] if several else "-"}
            axes.plot((times - starts[place]) / divisor, values / factor, lw=1.1, **style, **marks)
            every.append(values[np.isfinite(values)] / factor)
        bands = [course.recorded[name]] if name in course.recorded else []
        if name == "slip" and course.band is not None:
            times, low, high = _joined(course.band)
            bands.append(RecordedBand(times, low, 100 * low, 100 * high, is_calibrated=False))
        for band in bands:
            every += _draw_band(axes, band, starts[place], divisor, COLOURS[place % len(COLOURS)])
    only = panel.lines[shown[0]].name if len(shown) == 1 else ""
    label = life_label([course.scene for course in courses]) if name == "life" else panel.label
    axes.set_ylabel(f"{only} {label} [{unit}]".strip(), fontsize=9)
    axes.grid(alpha=0.3)
    axes.tick_params(labelsize=8)
    values = np.concatenate(every) if every else np.zeros(0)
    set_limits(axes, values, panel.is_logarithmic)
    if len(shown) > 1:
        from matplotlib.lines import Line2D

        looks = [{"color": "0.25", "ls": _STYLES[k % len(_STYLES)]} if several else {"color": COLOURS[k % len(COLOURS)]} for k in shown]
        handles = [Line2D([], [], lw=1.1, label=panel.lines[k].name, **look) for k, look in zip(shown, looks)]
        axes.legend(handles=handles, frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=3.2)
    if not len(values[values > 0]) and panel.is_logarithmic or not len(values):
        slowest = max(course.scene.thresholds.slip_from_speed for course in courses)
        why = stands_text(slowest) if name == "slip" else "no values that are finite"
        axes.text(0.5, 0.5, why, ha="center", va="center", transform=axes.transAxes, fontsize=9, color="0.4")


def life_label(scenes: Sequence[Scene]) -> str:
    """Return the name of the life that scenes count as damage, with its symbol by their method; ``life`` if they differ in it."""
    named = ("rating life", "modified rating life")
    names = {f"{named[not each.life.is_basic]} {each.life.symbols[not each.life.is_basic]}" for each in scenes}
    return names.pop() if len(names) == 1 else "life"


def _course_names(courses: Sequence[Course], shows_life: bool) -> list[str]:
    """Return the names of runs in a legend, with that of their life where it is shown and they differ in it."""
    names = [_shortened(course.name, 40) for course in courses]
    if not shows_life or life_label([course.scene for course in courses]) != "life":
        return names
    return [f"{name}: {life_label([course.scene])}" for name, course in zip(names, courses)]


def _joined(band: SlipBand) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times and ends of a band without seams, with a gap where the shaft stood between two instants."""
    steps = np.diff(band.times)
    gaps = np.flatnonzero(steps > 2.5 * np.median(steps)) + 1 if len(steps) else []
    return tuple(np.insert(each, gaps, np.nan) for each in band)


def _draw_band(axes, band: RecordedBand, start: float, divisor: float, colour: str) -> list[np.ndarray]:
    """Shade a band, with its value where that is not the line of the panel; return the numbers that must be seen."""
    times = (band.times - start) / divisor
    axes.fill_between(times, band.low, band.high, color=colour, alpha=0.22, lw=0.0)
    if band.is_calibrated or band.own_value:
        axes.plot(times, band.value, color=colour, lw=1.1, ls="--")
    return [each[np.isfinite(each)] for each in (band.low, band.high)]


def _name_courses(figure, courses: Sequence[Course]) -> None:
    """Add one legend of runs and bands below the picture, if there is anything to name."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = []
    if len(courses) > 1:
        names = _course_names(courses, "life" in courses[0].panels)
        handles += [Line2D([], [], color=COLOURS[k % len(COLOURS)], label=name) for k, name in enumerate(names)]
    if any(course.recorded for course in courses):
        calibrated = any(each.is_calibrated for course in courses for each in course.recorded.values())
        text = "5 to 95 % as the run published it" + (", dashed: as measurements calibrated it" if calibrated else "")
        symbols = dict.fromkeys(each.own_value for course in courses for each in course.recorded.values() if each.own_value)
        text += "".join(f"; life: about {symbol}, dashed" for symbol in symbols)
        notes = dict.fromkeys(without_dimensions(one.field for one in ranges_of(each.scene)) for each in courses if "life" in each.recorded)
        handles.append(Patch(color=COLOURS[0], alpha=0.22, label=text + "".join(notes)))
    if any(course.band is not None for course in courses):
        handles.append(Patch(color=COLOURS[0], alpha=0.22, label="settled slip, 5 to 95 % by the scene's uncertainty"))
    if handles:
        _add_legend(figure, handles)


def _add_legend(figure, handles: Sequence) -> None:
    """Add a legend below a picture, in as many columns as its longest name allows."""
    longest = max(len(handle.get_label()) for handle in handles) + _HANDLE_WIDTH
    columns = int(np.clip(_LEGEND_WIDTH // longest, 1, len(handles)))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False, fontsize=8)


def _saved(figure, path: Path | BinaryIO, title: str) -> "object":
    save(figure, path, _shortened(title, _LONGEST_TITLE), 10)
    return figure


def _shortened(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 2]} …"


def minimum_loads(scene: Scene, speeds: np.ndarray) -> np.ndarray:
    """Return the minimum load of makers [N] at shaft speeds [rpm] (see `bearing_sim.model.plausibility.minimum_load`)."""
    return np.broadcast_to(minimum_load(scene, np.asarray(speeds, float) / RPM)[0], np.shape(speeds))


def plot_over_load(path: Path | BinaryIO, courses: Sequence[Course], title: str = "") -> "object":
    """Draw slip and life of the samples of runs over the radial load, with the minimum load, and return the figure.

    The minimum load rises with the speed; between its values at the speeds of a run that turns it is a strip.

    Parameters
    ----------
    path, courses, title : see `plot_over_time`.
    """
    series = [course.loaded[:, 1:].T for course in courses]
    runs = [(course.scene, course.loaded[_turning(course), 0], course.name) for course in courses]
    style = {"ms": 3, "ls": "", "alpha": 0.6, "mew": 0}
    figure = _draw_slip_and_life(series, style, runs, _course_names(courses, True), life_label([course.scene for course in courses]) + " [h]", 4.6)
    return _saved(figure, path, title)


def _draw_slip_and_life(series, style: Mapping, runs, names: Sequence[str], life_heading: str, height: float):
    """Return a figure of slip and life over the load.

    Parameters
    ----------
    series : loads [N], slips [%] and lives [h] of each line.
    style : of all lines, besides colour and mark.
    runs : whose minimum loads are drawn, see `_draw_minimum_loads`.
    names : of the lines, which stand in the legend where there are several.
    life_heading : label of the axis of the life.
    height : of the figure [inch].
    """
    from matplotlib.lines import Line2D

    figure = new_figure(10, height)
    axes = figure.subplots(1, 2)
    unit, newtons = larger_unit("N", np.concatenate([loads for loads, *_ in series]))
    for k, (loads, *results) in enumerate(series):
        for each, values in zip(axes, results):
            each.plot(loads / newtons, with_gaps(values), **look_of(k, **style))
    handles = _draw_minimum_loads(axes, runs, newtons)
    loads, *columns = map(np.concatenate, zip(*series))
    for each, values, label, is_logarithmic in zip(axes, columns, ("cage slip [%]", life_heading), (False, True)):
        each.set(xlabel=f"radial load [{unit}]", ylabel=label)
        each.grid(alpha=0.3)
        reached = [float(mark.get_xdata()[0]) for mark in each.lines if len(mark.get_xdata()) == 2 and mark.get_xdata()[0] == mark.get_xdata()[1]]
        set_limits(each, np.append(loads[np.isfinite(loads)] / newtons, reached), False, "x")
        set_limits(each, values[np.isfinite(values)], is_logarithmic)
    if len(names) > 1:
        handles = [*(Line2D([], [], label=name, **look_of(k, ls=style.get("ls", "-"))) for k, name in enumerate(names)), *handles]
    if handles:
        _add_legend(figure, handles)
    return figure


def _draw_minimum_loads(axes, runs: Sequence[tuple[Scene, np.ndarray, str]], newtons: float) -> list:
    """Draw the minimum load of each run, as a line or, where it depends on a speed that changes, as a strip; return the legend's entries.

    The unit of the axes has so many ``newtons``.
    """
    found: dict[tuple[str, str], tuple[float, float, int, list[str]]] = {}
    for k, (scene, speeds, name) in enumerate(runs):
        turning = np.abs(speeds[np.abs(speeds) > 0.0])
        if not len(turning):
            continue
        least, most = minimum_loads(scene, np.array([turning.min(), turning.max()])).tolist()
        rule = minimum_load(scene)[1].partition(";")[0].replace("^2", "²")
        speeds = f"{number(turning.min())} to {number(turning.max())} rpm"
        at = force(least, 3) if most < 1.02 * least else f"{force(least, 3)} to {force(most, 3)} at {speeds}"
        found.setdefault((at, rule), (least, most, k, []))[-1].append(name)
    handles = []
    for (at, rule), (least, most, k, names) in found.items():
        of = f" of {', '.join(_shortened(name, 40) for name in names)}" if len(found) > 1 else ""
        colour = COLOURS[-1] if len(found) == 1 else COLOURS[k % len(COLOURS)]
        for each in axes:
            line = each.axvline(most / newtons, color=colour, ls="--", lw=1.2, label=f"minimum load{of}: {at} ({rule})")
            if most >= 1.02 * least:
                each.axvspan(least / newtons, most / newtons, color=colour, alpha=0.10, lw=0)
        handles.append(line)
    return handles


def plot_table_over_load(path: Path, points: Sequence[Mapping], scene: Scene | None, title: str, life_heading: str) -> "object":
    """Draw slip and life of the points of a table over the radial load, a line for each speed, with the minimum load; return the figure.

    Parameters
    ----------
    path, title : see `plot_over_time`.
    points : each with ``load`` [N], ``slip`` [%], ``life`` [h], ``speed`` [rpm] and ``family``, what else was varied, in words.
    scene : whose minimum load is drawn; None if it is not known.
    life_heading : label of the axis of the life.
    """
    if not points:
        raise NotDrawable("no point of the table has a load and a slip")
    families: dict[str, list[Mapping]] = {}
    for point in sorted(points, key=lambda point: point["load"]):
        families.setdefault(point["family"], []).append(point)
    names = list(dict.fromkeys(point["family"] for point in points))
    series = [np.array([[float(point[name]) for point in families[family]] for name in ("load", "slip", "life")]) for family in names]
    speeds = np.array(sorted({float(point["speed"]) for point in points if math.isfinite(point["speed"])}))
    runs = [(scene, speeds, "")] if scene is not None and len(speeds) else []
    figure = _draw_slip_and_life(series, {"ms": 4, "lw": 1.2}, runs, [_shortened(name, 60) for name in names], life_heading, 4.8)
    return _saved(figure, path, title)
