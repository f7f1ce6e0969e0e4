# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pictures of a sweep's table: lines over one variable, maps over two."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bearing_sim.sweep.point import OK, UNSETTLED, Column
from bearing_sim.sweep.table import Table

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")  # Okabe and Ito: told apart by the colour-blind
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
QUANTITIES = ("cage_slip", "rating_life", "inner_load_maximum", "outer_load_maximum")
_FEWEST_OF_A_MAP = 4  # values of each variable; with fewer of one, a line for each of them
_LABELS = {
    "cage_slip": "cage slip",
    "rating_life": "rating life",
    "inner_load_maximum": "largest inner load",
    "outer_load_maximum": "largest outer load",
    "low_radius": "low-point radius R_low",
    "d_value": "D value",
}


class NotDrawable(ValueError):
    """A table that these pictures cannot show; the message says why."""


def label(column: Column) -> str:
    """Return what an axis of a plot calls a column, with its unit."""
    last = column.name.rpartition(".")[2]
    name = _LABELS.get(last, last.replace("_", " "))
    return f"{name} [{column.unit}]" if column.unit else name


def new_figure(width: float, height: float):
    """Return an empty figure that no window system knows, of a size in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw(path: Path, table: Table, quantities: Sequence[str] = QUANTITIES) -> None:
    """Write a picture of a sweep; the ending of ``path`` says its format.

    Parameters
    ----------
    path : .png, .svg or .pdf.
    table : of one or two variables.
    quantities : columns that are drawn, each on axes of its own.

    Raises
    ------
    NotDrawable
        The table has more variables, or a quantity that it has not or that is no number.
    """
    varied = [table.column(axis["field"]) for axis in table.about["axes"] if len(axis["values"]) > 1]
    if not 1 <= len(varied) <= 2:
        raise NotDrawable(f"a picture shows one or two variables, and this table has {len(varied)}: fix the others with --set")
    names = [column.name for column in table.columns]
    for name in quantities:
        if name not in names or not isinstance(table.rows[0][name], (int, float)):
            raise NotDrawable(f"{name}: no quantity of this table; it has {', '.join(names)}")
    columns = -(-len(quantities) // 2) if len(quantities) > 3 else len(quantities)
    rows = -(-len(quantities) // columns)
    figure = new_figure(5.2 * columns, 0.5 + 3.9 * rows)
    axes = figure.subplots(rows, columns, squeeze=False).flat
    mapped = len(varied) == 2 and all(_is_dense(table, column) for column in varied)
    for each, name in zip(axes, quantities):
        (_draw_map if mapped else _draw_lines)(each, table, varied, table.column(name))
    for empty in list(axes):
        empty.axis("off")
    if not mapped and len(varied) == 2:
        handles, told = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, told, loc="outside lower center", ncols=min(len(told), 5), frameon=False)
    figure.suptitle(_title(table), fontsize=11)
    figure.savefig(path, dpi=130)


def _title(table) -> str:
    left_out = sum(row["status"] not in (OK, UNSETTLED) for row in table.rows)
    missing = f"; {left_out} of {len(table.rows)} points have no result" if left_out else ""
    about = table.about
    return f"{about['scene']} {' '.join(each for each in about['overrides'] if not each.startswith('level='))} at level {about['level']}{missing}"


def _is_dense(table, column) -> bool:
    values = set(table.values(column.name))
    return len(values) >= _FEWEST_OF_A_MAP and not any(isinstance(value, (str, bool)) for value in values)


def _draw_lines(axes, table, varied, quantity) -> None:
    over, *families = sorted(varied, key=lambda column: not _is_dense(table, column))
    family = families[0] if families else None
    members = list(dict.fromkeys(table.values(family.name))) if family is not None else [None]
    for k, member in enumerate(members):
        rows = [row for row in table.rows if family is None or row[family.name] == member]
        if not isinstance(rows[0][over.name], str):
            rows.sort(key=lambda row: row[over.name])
        told = f"{label(family)} {member:.6g}" if isinstance(member, float) else str(member)
        look = {"color": COLOURS[k % len(COLOURS)], "marker": MARKERS[k % len(MARKERS)], "ms": 4, "lw": 1.4, "label": told}
        axes.plot([row[over.name] for row in rows], [row[quantity.name] for row in rows], **look)
        drifting = [row for row in rows if row["status"] == UNSETTLED]
        axes.plot([row[over.name] for row in drifting], [row[quantity.name] for row in drifting], "x", color="black", ms=8)
    axes.set(xlabel=label(over), ylabel=label(quantity))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.ticklabel_format(axis="x", useOffset=False) if not isinstance(table.rows[0][over.name], str) else None
    axes.grid(alpha=0.3)


def _draw_map(axes, table, varied, quantity) -> None:
    x, y = varied
    across, up, field = on_grid(table, x.name, y.name, quantity.name)
    finite = field[np.isfinite(field)]
    mesh = axes.pcolormesh(across, up, field, cmap="viridis", shading="nearest")
    if finite.size and np.ptp(finite) > 0:
        lines = axes.contour(across, up, field, 5, colors="white", linewidths=0.8)
        axes.clabel(lines, fontsize=8, fmt="%g")
    axes.set(xlabel=label(x), ylabel=label(y), facecolor="#dddddd")
    axes.ticklabel_format(useOffset=False)
    axes.figure.colorbar(mesh, ax=axes, label=label(quantity))


def on_grid(table: Table, x: str, y: str, quantity: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the values of two variables, rising, and a quantity over them, shape (values of y, values of x); NaN where there is none."""
    across, up = (np.unique(table.values(name)) for name in (x, y))
    field = np.full((len(up), len(across)), np.nan)
    for row in table.rows:
        field[np.searchsorted(up, row[y]), np.searchsorted(across, row[x])] = row[quantity]
    return across, up, np.where(np.isfinite(field), field, np.nan)
