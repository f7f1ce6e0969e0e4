# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pictures of tables, and what all pictures share: figures, axes, maps.  Names, units, digits and scales are those of `bearing_sim.scene.display`."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from bearing_sim.scene.display import heading, larger_unit, number, shown, unit_sign
from bearing_sim.sweep.point import OK, UNSETTLED, Column
from bearing_sim.sweep.table import Table, life_column

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # Okabe and Ito: safe for colour-blind readers
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
DPI = 130  # of pictures
NO_RESULT = "0.72"  # grey of the cells of a map that have none
_MOST_DECADES = 6  # of a logarithmic axis and of colours: near rest, or without load, a life grows beyond any scale
_APART = 0.12  # of the width of axes and of their height, by which the labels of contours are apart
_FEWEST_OF_A_MAP = 4  # values of each variable; with fewer, draw lines
_WIDE = 30.0  # largest over least value from which lines of what is logarithmic have a logarithmic axis


class NotDrawable(ValueError):
    """A table that cannot be drawn; the message says why."""


class Values(NamedTuple):
    """Values of a quantity as an axis or a colour bar shows them: its name, the label with the unit, and the values in that unit."""

    name: str
    label: str
    values: np.ndarray

    @property
    def is_logarithmic(self) -> bool:
        """Whether pictures have the quantity on a logarithmic scale."""
        return shown(self.name).is_logarithmic


def as_shown(name: str, unit: str, values) -> Values:
    """Return values of a quantity in the unit in which they are shown, that which suits the largest of them.

    Parameters
    ----------
    name : of `bearing_sim.scene.display.SHOWN`, or the path of a scene field.
    unit : of the values, in the spelling of files; angles from rad.
    values : numbers of any shape.
    """
    larger, factor = larger_unit(unit, np.ravel(values))
    return Values(name, heading(name, larger), np.asarray(values, float) / factor)


def value_text(name: str, unit: str, value) -> str:
    """Return a value of a varied field with name and unit, such as ``shaft speed 20,000 rpm``; a word after the name of its field."""
    named = shown(name).name
    if isinstance(value, (str, bool)):
        return f"{named} {value}"
    larger, factor = larger_unit(unit, [value])
    return f"{named} {number(value / factor, 6)} {unit_sign(larger)}".rstrip()


def new_figure(width: float, height: float):
    """Return an empty figure without a window, of a size in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def save(figure, path: Path | BinaryIO, title: str = "", size: float | str = "large", **more) -> None:
    """Write a figure with its title into a file; ``more`` goes to `matplotlib.figure.Figure.savefig`.

    Parameters
    ----------
    figure : of `new_figure`.
    path : its suffix gives the format: .png, .svg or .pdf; or a stream, for .png.
    title, size : nothing stands above the picture without a title; size of its letters in points or by its name in matplotlib.
    """
    if title:
        figure.suptitle(title, fontsize=size)
    figure.savefig(path, **{"dpi": DPI} | more)


def look_of(k: int, **more) -> dict:
    """Return colour and mark of the k-th of several lines, and what else is given of its look."""
    return {"color": COLOURS[k % len(COLOURS)], "marker": MARKERS[k % len(MARKERS)], **more}


def with_gaps(values) -> np.ndarray:
    """Return values with NaN, which leaves a gap in a line, instead of what is not finite."""
    return np.where(np.isfinite(values), values, np.nan)


def legend_below(figure, axes, **more) -> None:
    """Name what axes show in one legend below a figure, all in one row where ``more`` does not say how many (``ncols``)."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", frameon=False, **{"ncols": len(labels)} | more)


def ticks(low: float, high: float, is_logarithmic: bool, most: int = 6) -> list[float]:
    """Return numbers between two others as people write them: 1, 2, 5 of each decade, whole decades, or evenly spaced ones.

    Parameters
    ----------
    low, high : ends, included.
    is_logarithmic : whether the scale is; one of less than about a decade has evenly spaced numbers, too.
    most : about how many.
    """
    from matplotlib.ticker import MaxNLocator

    near = 1e-9 * max(abs(low), abs(high))
    if is_logarithmic and low > 0.0 and high > 8.0 * low:
        first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
        for steps, every in (((1, 2, 5), 1), ((1, 3), 1), *(((1,), every) for every in range(1, last - first + 2))):
            found = [step * 10.0**k for k in range(first, last + 1) if k % every == 0 for step in steps]
            found = [each for each in found if low - near <= each <= high + near]
            if len(found) <= most:
                return found
    return [float(each) for each in MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high) if low - near <= each <= high + near]


def plain_numbers(*axes) -> None:
    """Write the numbers of axes of matplotlib as people write them: 20,000 instead of 2e4, none beside an offset, all with as many decimals."""
    from matplotlib.ticker import Formatter, NullFormatter

    class Plain(Formatter):
        def __call__(self, value, place=None) -> str:
            return number(value, 8)

        def format_ticks(self, values) -> list[str]:
            texts = [self(value) for value in values]
            if self.axis.get_scale() != "linear":
                return texts
            decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
            return [f"{value:,.{decimals}f}" if abs(value) > 1e-9 else "0" for value in values]

    for axis in axes:
        axis.set_major_formatter(Plain())
        axis.set_minor_formatter(NullFormatter())


def set_limits(axes, values: np.ndarray, is_logarithmic: bool, direction: str = "y") -> None:
    """Set the limits and ticks of an axis so that its labels are short and apart, also where values hardly differ.

    Parameters
    ----------
    axes : of matplotlib.
    values : that are shown, all finite.
    is_logarithmic : whether the axis is, if any value is positive: whole decades, at most six above the least.
    direction : ``x`` or ``y``.
    """
    from matplotlib.ticker import MaxNLocator

    axis, limit = getattr(axes, f"{direction}axis"), getattr(axes, f"set_{direction}lim")
    positive = values[values > 0]
    if is_logarithmic and len(positive):
        getattr(axes, f"set_{direction}scale")("log")
        low = math.floor(math.log10(positive.min()) + 1e-9)
        high = min(math.ceil(math.log10(positive.max()) - 1e-9), low + _MOST_DECADES)
        ends = 10.0**low, 10.0 ** max(high, low + 1)
        limit(*ends)
        axis.set_ticks(ticks(*ends, True, 5))
        plain_numbers(axis)
        return
    if not len(values):
        limit(0.0, 1.0)
        axis.set_ticks([])
        return
    low, high = float(values.min()), float(values.max())
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    half = max(1.06 * half, 2e-3 * abs(middle), 1e-9)
    limit(middle - half, middle + half)
    axis.set_major_locator(MaxNLocator(5 if direction == "y" else 7, steps=[1, 2, 2.5, 5, 10]))
    plain_numbers(axis)


def _set_ends(axes, direction: str, low: float, high: float, is_logarithmic: bool) -> None:
    """Let an axis go from one number to another, with ticks at numbers as people write them."""
    axis = getattr(axes, f"{direction}axis")
    axes.set(**{f"{direction}scale": "log" if is_logarithmic else "linear", f"{direction}lim": (low, high)})
    axis.set_ticks(ticks(low, high, is_logarithmic))
    axis.set_ticks([], minor=True)
    plain_numbers(axis)


def is_spaced_logarithmically(values: Sequence[float]) -> bool:
    """Return whether increasing values are spaced more evenly on a logarithmic scale than on a linear one, over a decade or more."""
    values = np.asarray(values, float)
    if len(values) < 3 or values[0] <= 0.0 or values[-1] < 10.0 * values[0]:
        return False
    linear, logarithmic = np.diff(values), np.diff(np.log(values))
    return bool(logarithmic.max() / logarithmic.min() < linear.max() / linear.min())


def _edges(values: np.ndarray, is_logarithmic: bool) -> np.ndarray:
    """Return the edges of cells around increasing values; none reaches beyond the values, so that those at the ends are half as wide."""
    middles = np.sqrt(values[1:] * values[:-1]) if is_logarithmic else 0.5 * (values[1:] + values[:-1])
    return np.concatenate([values[:1], middles, values[-1:]])


def draw_map(axes, x: Values, y: Values, quantity: Values, colours: str = "viridis", centre: float | None = None, is_smooth: bool = False) -> None:
    """Draw a quantity over two variables as colours with contours, and its colour bar.  What has no result is grey.

    Parameters
    ----------
    axes : of matplotlib.
    x, y : increasing values of the variables, at least two of each.
    quantity : values of shape (values of y, values of x); NaN without a result, infinite for a life without load.
    colours : colour map of matplotlib.
    centre : value in the middle of the colours, if there are values on both sides of it.
    is_smooth : whether to interpolate between the values, which leaves out cells beside one without a result.
    """
    from matplotlib.colors import LogNorm, Normalize, TwoSlopeNorm
    from matplotlib.patheffects import withStroke

    field = quantity.values
    finite = field[np.isfinite(field)]
    scales = {name: is_spaced_logarithmically(each.values) for name, each in (("x", x), ("y", y))}
    axes.set(xlabel=x.label, ylabel=y.label, facecolor=NO_RESULT)
    if not finite.size:
        axes.text(0.5, 0.5, f"no {shown(quantity.name).name}", ha="center", va="center", transform=axes.transAxes)
        axes.set(xticks=[], yticks=[])
        return
    is_wide = any(scales.values()) and 0.0 < 10.0 * finite.min() < finite.max()  # over an axis that is logarithmic, such as a load over loads
    is_logarithmic = quantity.is_logarithmic and bool((finite > 0.0).any()) or is_wide
    low, high = (float(end(finite[finite > 0.0] if is_logarithmic else finite)) for end in (np.min, np.max))
    if is_logarithmic and high > low * 10.0**_MOST_DECADES:  # a life without load is as uninteresting as the last millionth of slip
        low, high = (low, low * 10.0**_MOST_DECADES) if shown(quantity.name).unit == "h" else (high / 10.0**_MOST_DECADES, high)
    beyond = {(True, True): "both", (True, False): "min", (False, True): "max"}.get((finite.min() < low, np.nanmax(field) > high), "neither")
    drawn = np.clip(field, low, high)
    if low == high:
        norm = Normalize(low - 0.5 * abs(low) - 1e-9, high + 0.5 * abs(high) + 1e-9)
    elif centre is not None and low < centre < high:
        norm = TwoSlopeNorm(centre, low, high)
    else:
        norm = (LogNorm if is_logarithmic else Normalize)(low, high)
    if is_smooth:
        mesh = axes.pcolormesh(x.values, y.values, drawn, cmap=colours, norm=norm, shading="gouraud")
    else:
        edges = (_edges(each.values, scales[name]) for name, each in (("x", x), ("y", y)))
        mesh = axes.pcolormesh(*edges, drawn, cmap=colours, norm=norm, shading="flat")
    marked = ticks(low, high, is_logarithmic) if low < high else [low]
    bar = axes.figure.colorbar(mesh, ax=axes, label=quantity.label, extend=beyond)
    bar.set_ticks(marked, labels=[number(each) for each in marked])
    bar.minorticks_off()
    for name, each in (("x", x), ("y", y)):
        _set_ends(axes, name, float(each.values[0]), float(each.values[-1]), scales[name])
    if inside := [each for each in marked if low < each < high]:
        halo, kept = [withStroke(linewidth=2.2, foreground="white")], []
        lines = axes.contour(x.values, y.values, drawn, inside, colors="black", linewidths=0.8, linestyles="solid")
        lines.set(path_effects=halo)
        for text in axes.clabel(lines, fontsize=8, fmt=number, inline=False):
            text.set_path_effects(halo)
            place = axes.transAxes.inverted().transform(axes.transData.transform(text.get_position()))
            if abs(place - 0.5).max() < 0.5 - _APART / 4.0 and all(np.abs(place - other).max() > _APART for other in kept):
                kept.append(place)
            else:
                text.set_visible(False)


def no_result_patch():
    """Return the entry of a legend for the cells of a map that have no result."""
    from matplotlib.patches import Patch

    return Patch(facecolor=NO_RESULT, label="no result")


def on_grid(table: Table, x: str, y: str, quantity: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the increasing values of two variables and a quantity over them, shape (values of y, values of x); NaN without a result."""
    across, up = (np.unique(table.values(name)) for name in (x, y))
    field = np.full((len(up), len(across)), np.nan)
    for row in table.rows:
        field[np.searchsorted(up, row[y]), np.searchsorted(across, row[x])] = row[quantity]
    return across, up, field


def map_of(axes, table: Table, x: str, y: str, quantity: str, **look) -> None:
    """Draw a column of a table over two others (see `draw_map`)."""
    columns = (table.column(name) for name in (x, y, quantity))
    draw_map(axes, *(as_shown(column.name, column.unit, values) for column, values in zip(columns, on_grid(table, x, y, quantity))), **look)


def default_quantities(table: Table) -> tuple[str, ...]:
    """Return the columns of a sweep that are drawn if nobody chooses others."""
    return "cage_slip", life_column(table), "inner_load_maximum", "outer_load_maximum"


def require_drawable(axes: Sequence[Sequence]) -> None:
    """Raise `NotDrawable` unless one or two of the fields of a sweep, each with its values, have several."""
    varied = sum(len(values) > 1 for values in axes)
    if not 1 <= varied <= 2:
        raise NotDrawable(f"a picture shows one or two varied fields, this sweep has {varied}; fix the others with --set")


def plot_table(path: Path | BinaryIO, table: Table, quantities: Sequence[str] = ()) -> None:
    """Draw a sweep into a file: lines over one variable, maps over two.

    Parameters
    ----------
    path : its suffix gives the format: .png, .svg or .pdf; or a stream, for .png.
    table : with one or two variables.
    quantities : columns to draw, each on its own axes; those of `default_quantities` if there are none.

    Raises
    ------
    NotDrawable
        The table has more variables, or a quantity is missing or not a number.
    """
    require_drawable([axis["values"] for axis in table.about["axes"]])
    varied = [table.column(axis["field"]) for axis in table.about["axes"] if len(axis["values"]) > 1]
    quantities = quantities or default_quantities(table)
    names = [column.name for column in table.columns]
    for name in quantities:
        if name not in names or not isinstance(table.rows[0][name], (int, float)):
            raise NotDrawable(f"{name}: not a quantity of this table; it has {', '.join(names)}")
    columns = -(-len(quantities) // 2) if len(quantities) > 3 else len(quantities)
    rows = -(-len(quantities) // columns)
    figure = new_figure(5.2 * columns, 0.7 + 3.9 * rows)
    axes = figure.subplots(rows, columns, squeeze=False).flat
    mapped = len(varied) == 2 and all(_is_dense(table, column) for column in varied)
    for each, name in zip(axes, quantities):
        if mapped:
            map_of(each, table, varied[0].name, varied[1].name, name)
        else:
            _draw_lines(each, table, varied, table.column(name))
    for empty in list(axes):
        empty.axis("off")
    if mapped:
        empty = any(math.isnan(row[name]) for row in table.rows for name in quantities)
        if empty:
            figure.legend(handles=[no_result_patch()], loc="outside lower center", frameon=False)
    else:
        legend_below(figure, figure.axes[0], ncols=min(len(figure.axes[0].get_legend_handles_labels()[1]), 4))
    without = sum(row["status"] not in (OK, UNSETTLED) for row in table.rows)
    missing = f"; {without} of {len(table.rows)} points have no result" if without else ""
    figure.suptitle(f"{condition_title(table.about)}{missing}", fontsize=11, wrap=True)
    save(figure, path)


def condition_title(about: Mapping) -> str:
    """Return scene, level and overrides of a table, by what it says about itself, as a title."""
    changed = [each for each in about.get("overrides", ()) if not each.startswith("level=")]
    return f"{about['scene']} at level {about['level']}{' with ' if changed else ''}{', '.join(changed)}"


def _is_dense(table, column) -> bool:
    values = set(table.values(column.name))
    return len(values) >= _FEWEST_OF_A_MAP and not any(isinstance(value, (str, bool)) for value in values)


def _draw_lines(axes, table: Table, varied: Sequence[Column], quantity: Column) -> None:
    over, *families = sorted(varied, key=lambda column: not _is_dense(table, column))
    family = families[0] if families else None
    members = list(dict.fromkeys(table.values(family.name))) if family is not None else [None]
    along = table.values(over.name)
    in_words = any(isinstance(value, (str, bool)) for value in along)
    across = Values(over.name, shown(over.name).name, np.array(along)) if in_words else as_shown(over.name, over.unit, along)
    up = as_shown(quantity.name, quantity.unit, table.values(quantity.name))
    for k, member in enumerate(members):
        places = np.array([place for place, row in enumerate(table.rows) if family is None or row[family.name] == member])
        if not in_words:
            places = places[np.argsort(across.values[places], kind="stable")]
        name = value_text(family.name, family.unit, member) if family is not None else None
        axes.plot(across.values[places], with_gaps(up.values[places]), **look_of(k, ms=4, lw=1.4, label=name))
    drifting = np.array([row["status"] == UNSETTLED for row in table.rows])
    if drifting.any():
        axes.plot(across.values[drifting], up.values[drifting], "x", color="black", ms=8, label="not yet at rest at the end of its run")
    axes.set(xlabel=across.label, ylabel=up.label)
    finite = up.values[np.isfinite(up.values)]
    is_life, positive = quantity.unit == "h", finite[finite > 0.0]
    if len(positive) and up.is_logarithmic and (is_life or len(positive) == len(finite) and positive.max() > _WIDE * positive.min()):
        set_limits(axes, finite, is_logarithmic=True)
    else:
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        plain_numbers(axes.yaxis)
    if not in_words:
        own = np.unique(across.values)
        is_logarithmic, pad = is_spaced_logarithmically(own), 0.03
        if is_logarithmic:
            ends = own[0] * (own[0] / own[-1]) ** pad, own[-1] * (own[-1] / own[0]) ** pad
        else:
            ends = own[0] - pad * np.ptp(own), own[-1] + pad * np.ptp(own)
        _set_ends(axes, "x", *map(float, ends), is_logarithmic)
    axes.grid(alpha=0.3)
