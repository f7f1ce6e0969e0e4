# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lay-out of the view: which panel shows what, with the unit in every title."""

import math
from collections.abc import Collection
from typing import NamedTuple

import rerun as rr
import rerun.blueprint as rrb

from bearing_sim.messages.topics import LIFE_SYMBOLS
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import ranges_of, without_dimensions
from bearing_sim.view import section
from bearing_sim.view.bands import field_plots, field_title
from bearing_sim.view.drawings import CLEARANCES, HEAT_ROOT, ORBIT_EDGE, SAMPLES, bar_bounds, causes_of, had_by, heat_bounds
from bearing_sim.view.load_map import map_bounds
from bearing_sim.view.plots import END, SERIES, TIMELINE, compared_life, features, range_path, table

LIVE_WINDOW = 30.0  # [s] of history that a live view shows
_LINKED_UP_TO = 50.0  # [s]
BACKGROUND = (13, 14, 17)
_TABLE = table("plots")
_PLOTS = {place: [row for row in _TABLE if row["place"] == place] for place in ("slip", "learned", "life", "loads", "courses")}


class Extent(NamedTuple):
    """What a finished run covers, so that every axis can be chosen well.

    Attributes
    ----------
    times : first and last simulated time [s].
    values : lowest and highest plotted value by entity path.
    """

    times: tuple[float, float]
    values: dict[str, tuple[float, float]]


def section_title(scene: Scene) -> str:
    """Return the title of the cross-section, which states what is not to scale."""
    return f"Cross-section: lobes, play and displacements drawn x{section.magnification(scene.bearing)}{_cage_factor(scene)}"


def _cage_factor(scene: Scene) -> str:
    return f", cage x{section.cage_magnification(scene)}" if scene.cage_whirls else ""


def blueprint(scene: Scene, bounds, live: bool, extent: Extent | None = None, measured: Collection[str] = ()) -> rrb.Blueprint:
    """Return the lay-out.

    Parameters
    ----------
    scene : what is shown.
    bounds : horizontal and vertical range of the cross-section [mm] (`SectionDrawing.bounds`).
    live : True follows the newest data and shows the last seconds only.
    extent : what the finished run covers; axes choose themselves where absent.
    measured : which of `bearing_sim.messages.topics.MEASURED_CHANNELS` are measured; the residual slip of a measured cage has a plot.
    """
    axes = _Axes(live, extent)
    columns = (_left(scene, bounds), _middle(scene, axes, measured), _right(axes))
    return page(rrb.Horizontal(*columns, column_shares=[0.41, 0.32, 0.27]))


def log_view() -> rrb.TextLogView:
    """Return the view of events."""
    columns = rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["loglevel", "body"])
    return rrb.TextLogView(origin="/log", name="Log", columns=columns)


def page(contents: rrb.Container) -> rrb.Blueprint:
    """Return the lay-out of these contents alone, with rerun's own panels collapsed."""
    return rrb.Blueprint(
        contents,
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="following"),
        auto_views=False,
        auto_layout=False,
    )


class _Axes:
    """Makes plots whose axes fit together."""

    def __init__(self, live: bool, extent: Extent | None):
        self._extent = extent
        self.time = _time_axis(live, extent)

    def plot(self, title: str, contents: list[str], axis: str = "") -> rrb.TimeSeriesView:
        """Return a plot of some series, with an axis as in ``plots.csv``.  The title is the legend, which hides no line, unless it is asked for."""
        return rrb.TimeSeriesView(
            origin="/",
            contents=[END, *map(range_path, contents), *contents],
            name=title,
            axis_x=self.time,
            axis_y=self._value_axis(contents, axis != "free"),
            plot_legend=rrb.PlotLegend(visible=axis == "legend"),
        )

    def _value_axis(self, contents: list[str], from_zero: bool) -> rrb.ScalarAxis | None:
        known = [self._extent.values[path] for path in contents if path in self._extent.values] if self._extent else []
        if not known:
            return None
        low, high = min(low for low, _ in known), max(high for _, high in known)
        if from_zero:
            low, high = min(low, 0.0), max(high, 0.0)
        margin = 0.1 * (high - low) or 0.05 * abs(high) or 1.0
        decade = 10.0 ** math.ceil(math.log10(high)) if from_zero and high > 0 else math.inf
        if 0.35 * decade < high < decade:  # ticks are labelled at powers of ten first: keep one in sight
            high, margin = decade, 0.14 * decade
        step = 10.0 ** math.floor(math.log10(high - low)) if high > low else math.inf
        if (tick := math.ceil(high / step - 1e-9) * step if math.isfinite(step) else high) < high + 1.4 * margin:
            high, margin = tick, max(margin, 0.12 * (tick - low))  # the last label in full, too
        return rrb.ScalarAxis(range=(low - 0.5 * margin, high + margin))  # with room for the labels at both ends


def _time_axis(live: bool, extent: Extent | None) -> rrb.TimeAxis:
    # Linked axes zoom together, but show a minute around the cursor, whatever range is asked for: right for short runs only.
    if live:
        return _window(rr.TimeRangeBoundary.cursor_relative(seconds=-LIVE_WINDOW), rr.TimeRangeBoundary.cursor_relative())
    if extent is None or extent.times[1] - extent.times[0] <= _LINKED_UP_TO:
        return rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    first, last = extent.times
    return _window(rr.TimeRangeBoundary.absolute(seconds=first), rr.TimeRangeBoundary.absolute(seconds=last + 0.03 * (last - first)))


def _window(start: rr.TimeRangeBoundary, end: rr.TimeRangeBoundary) -> rrb.TimeAxis:
    return rrb.TimeAxis(link=rrb.components.LinkAxis.Independent, view_range=rr.TimeRange(start=start, end=end))


def _left(scene: Scene, bounds) -> rrb.Vertical:
    reach = (0.83 if scene.bodies_tilt else 1.0) * bounds[0][1]  # closer where the solid has less room
    eye = rrb.EyeControls3D(position=(2.0 * reach, 1.1 * reach, 0.8 * reach), look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0))
    titles = {
        "/load_map": "Load map" if scene.cage_whirls else "Load map: load on the inner ring by azimuth and time, colours as above",
        "/load_map_by_roller": "By roller",
    }
    maps = [_flat(root, title, map_bounds(narrow=scene.cage_whirls)) for root, title in titles.items()]
    heat = [_flat(HEAT_ROOT, "Temperatures (housing not to scale)", heat_bounds(scene))] if scene.uses_ring_temperatures else []
    power = _flat("/power_now", f"Power: mean of {SAMPLES} samples", bar_bounds(len(causes_of(scene))))
    clearance = _flat("/clearance_now", "Running clearance", bar_bounds(len(had_by(scene, CLEARANCES)), signed=True))
    across = _flat("/section", section_title(scene), bounds)
    solid = rrb.Spatial3DView(
        origin="/",
        contents="/solid/**",
        name=f"3D, x{section.magnification(scene.bearing)}{_cage_factor(scene)}",
        background=BACKGROUND,
        eye_controls=eye,
        line_grid=False,
    )
    edge = ORBIT_EDGE * scene.bearing.cage.play * 1e6
    orbit = [_flat("/cage_orbit", "Cage orbit", ((-edge, edge), (-edge, edge)))] if scene.cage_whirls else []
    above = across if scene.bodies_tilt else rrb.Tabs(across, solid, active_tab=0)
    chart = rrb.Tabs(*([solid] if scene.bodies_tilt else []), *heat, *maps, power, clearance, *orbit, active_tab=0)
    return rrb.Vertical(above, chart, row_shares=[0.6, 0.4])


def _flat(root: str, title: str, bounds) -> rrb.Spatial2DView:
    """Return the view of a flat drawing within its horizontal and vertical range."""
    across, down = bounds
    return rrb.Spatial2DView(origin=root, name=title, visual_bounds=rrb.VisualBounds2D(x_range=across, y_range=down), background=BACKGROUND)


def _middle(scene: Scene, axes: _Axes, measured: Collection[str]) -> rrb.Vertical:
    present, fields = features(scene, measured), field_plots(scene)
    stacks = {place: [axes.plot(*_filled(row, scene, present)) for row in rows if _applies(row["needs"], present)] for place, rows in _PLOTS.items()}
    stacks["learned"] += [axes.plot(f"{field_title(path)}, 5 to 95 %", [plot.path, plot.line], "free") for path, plot in fields.items()]
    return rrb.Vertical(*(rrb.Tabs(*views, active_tab=0) for views in stacks.values() if views))


def _applies(needs: str, present: set[str]) -> bool:
    return (needs.removeprefix("no ") in present) != needs.startswith("no ")


def _filled(row: dict[str, str], scene: Scene, present: set[str]) -> tuple[str, list[str], str]:
    """Return title, series and kind of axis of a plot in ``plots.csv``."""
    basic, modified = scene.life.symbols
    has_bands = "bands" in present
    title = row["title"].format(
        basic=basic,
        compared=LIFE_SYMBOLS[compared_life(scene)],
        modified=f", purple {modified}" if "modified_life" in present else "",
        shaded=", shaded: 5 to 95 %" if has_bands else "",
        dimensions=without_dimensions(one.field for one in ranges_of(scene)) if has_bands else "",
    )
    return title, [path for path in row["series"].split() if path not in SERIES or SERIES[path].needs in present], row["axis"]


def _right(axes: _Axes) -> rrb.Vertical:
    texts = rrb.Tabs(rrb.TextDocumentView(origin="/now", name="Now"), rrb.TextDocumentView(origin="/about", name="About"), active_tab=0)
    lanes = rrb.StateTimelineView(origin="/", contents=["/regime", "/level"], name="Regime by the slip's thresholds, level", time_view=axes.time)
    return rrb.Vertical(texts, rrb.Tabs(log_view(), lanes, active_tab=0), row_shares=[0.7, 0.3])
