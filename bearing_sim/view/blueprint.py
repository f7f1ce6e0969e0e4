# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lay-out of the view: which panel shows what, with the unit in every title."""

import math
from collections.abc import Collection
from typing import NamedTuple

import rerun as rr
import rerun.blueprint as rrb

from bearing_sim.messages.topics import FREQUENCIES, LIFE_SYMBOLS, MEASURED, MEASURED_CLEARANCE, RING_TEMPERATURES
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import ranges_of, without_dimensions
from bearing_sim.view import section
from bearing_sim.view.bands import REMAINING_LIFE, field_plots, field_title
from bearing_sim.view.drawings import BODIES, CLEARANCES, HEAT_ROOT, ORBIT_EDGE, SAMPLES, bar_bounds, causes_of, heat_bounds
from bearing_sim.view.load_map import map_bounds
from bearing_sim.view.plots import END, TIMELINE, compared_life, range_path

LIVE_WINDOW = 30.0  # [s] of history that a live view shows
_LINKED_UP_TO = 50.0  # [s]
BACKGROUND = (13, 14, 17)


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

    def plot(self, title: str, contents: list[str], from_zero: bool = True, legend: bool = False) -> rrb.TimeSeriesView:
        """Return a plot of some series; ``from_zero`` keeps zero on the axis.  The title is the legend, which hides no line, unless ``legend``."""
        return rrb.TimeSeriesView(
            origin="/",
            contents=[END, *map(range_path, contents), *contents],
            name=title,
            axis_x=self.time,
            axis_y=self._value_axis(contents, from_zero),
            plot_legend=rrb.PlotLegend(visible=legend),
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
    clearance = _flat("/clearance_now", "Running clearance", bar_bounds(len(CLEARANCES), signed=True))
    across = _flat("/section", section_title(scene), bounds)
    solid = rrb.Spatial3DView(
        origin="/",
        contents="/solid/**",
        name=f"3D, x{section.magnification(scene.bearing)}{_cage_factor(scene)}",
        background=BACKGROUND,
        eye_controls=eye,
        line_grid=False,
    )
    orbit = [_orbit(scene)] if scene.cage_whirls else []
    above = across if scene.bodies_tilt else rrb.Tabs(across, solid, active_tab=0)
    chart = rrb.Tabs(*([solid] if scene.bodies_tilt else []), *heat, *maps, power, clearance, *orbit, active_tab=0)
    return rrb.Vertical(above, chart, row_shares=[0.6, 0.4])


def _flat(root: str, title: str, bounds) -> rrb.Spatial2DView:
    """Return the view of a flat drawing within its horizontal and vertical range."""
    across, down = bounds
    return rrb.Spatial2DView(origin=root, name=title, visual_bounds=rrb.VisualBounds2D(x_range=across, y_range=down), background=BACKGROUND)


def _orbit(scene: Scene) -> rrb.Spatial2DView:
    edge = ORBIT_EDGE * scene.bearing.cage.play * 1e6
    return _flat("/cage_orbit", "Cage orbit", ((-edge, edge), (-edge, edge)))


def _middle(scene: Scene, axes: _Axes, measured: Collection[str]) -> rrb.Vertical:
    has_cage = MEASURED in measured
    rows = [_slips(scene, axes, has_cage), _lives(scene, axes), _loads(scene, axes), _courses(scene, axes, measured)]
    title = "Residual slip [points]: measured less predicted (grey: none)"
    residual = [axes.plot(title, ["/slip/no_residual", "/slip/residual"])] if has_cage else []
    fields = field_plots(scene)
    learned = [axes.plot(f"{field_title(path)}, 5 to 95 %", [plot.path, plot.line], from_zero=False) for path, plot in fields.items()]
    if beside := [*residual, *learned]:
        rows.insert(1, rrb.Tabs(*beside, active_tab=0))
    return rrb.Vertical(*rows)


def _courses(scene: Scene, axes: _Axes, measured: Collection[str]) -> rrb.Tabs:
    """Return the plots of what acts on the bearing, and of what follows besides slip, life and loads."""
    warmth = _temperatures(axes) if scene.uses_ring_temperatures else axes.plot("Oil [°C]", ["/oil/temperature"])
    return rrb.Tabs(
        _speeds(axes, MEASURED in measured),
        axes.plot("Radial load [N]", ["/load/radial"]),
        warmth,
        _clearance(scene, axes, MEASURED_CLEARANCE in measured),
        axes.plot("Plot [W]", [f"/power/{cause}" for cause in causes_of(scene)]),
        axes.plot("Frequencies [Hz]", [f"/frequency/{each.name}" for each in FREQUENCIES], legend=True),
        *([axes.plot("Oil [°C]", ["/oil/temperature"])] if scene.uses_ring_temperatures else []),
        *(_tilts(axes) if scene.bodies_tilt else []),
        active_tab=0,
    )


def _speeds(axes: _Axes, has_cage: bool) -> rrb.TimeSeriesView:
    paths = ["/speed/shaft", "/speed/ideal_cage", "/speed/cage"]
    title = "Speeds [rpm] (blue: shaft, orange: cage, grey: cage without slip)"
    if has_cage:
        title, paths = "Speeds [rpm] (blue: shaft, orange: cage, white: measured)", [*paths, "/speed/cage_measured"]
    return axes.plot(title, paths)


def _slips(scene: Scene, axes: _Axes, has_cage: bool) -> rrb.Tabs:
    whirl = [axes.plot("e/c [-]", ["/cage/eccentricity"])] if scene.cage_whirls else []
    title, paths = "Cage slip [%] (yellow: warning, red: error)", ["/slip/warning", "/slip/error", "/slip/cage"]
    if has_cage:
        title, paths = (
            "Cage slip [%] (blue: predicted, white: measured)",
            ["/slip/warning", "/slip/error", "/slip/measured", "/slip/cage"],
        )
    if scene.estimation.bands:
        title, paths = f"{title[:-1]}, shaded: 5 to 95 %)", ["/slip/band", *paths]
    pocket = axes.plot("Pocket [N]", ["/loads/pocket_warning", "/loads/pocket_error", "/loads/pocket_largest"])
    return rrb.Tabs(axes.plot(title, paths), pocket, *whirl, active_tab=0)


def _rollers(scene: Scene, axes: _Axes) -> list[rrb.TimeSeriesView]:
    """Return the plots with a line for each roller's slip and spin, coloured around the bearing; level ``steady`` computes neither."""
    if scene.level == "steady":
        return []
    return [
        axes.plot("Slip of each roller on inner ring [m/s]", ["/rollers/inner_sliding"]),
        axes.plot("Outer [m/s]", ["/rollers/outer_sliding"]),
        axes.plot("Spin [rpm]", ["/rollers/spin"]),
    ]


def _loads(scene: Scene, axes: _Axes) -> rrb.Tabs:
    places = ("inner", "outer", "inner_edge", "outer_edge")
    pressure = [axes.plot("Pressure [MPa]", [f"/pressure/{place}" for place in places])] if scene.bodies_tilt else []
    return rrb.Tabs(
        axes.plot("Largest roller load [N]: blue inner, red outer", ["/loads/inner_largest", "/loads/outer_largest"]),
        *_rollers(scene, axes),
        axes.plot("Inner [N]", ["/loads/each/inner"]),
        axes.plot("Outer [N]", ["/loads/each/outer"]),
        axes.plot("Pockets [N]", ["/loads/each/pocket"]),
        *pressure,
        active_tab=0,
    )


def _lives(scene: Scene, axes: _Axes) -> rrb.Tabs:
    """Return the plot of the life by the scene's method, that of another standard, and the modified one where the scene wants it.

    Where there are bands, the remaining life has a plot, too.
    """
    basic, modified = scene.life.symbols
    other = compared_life(scene)
    shown = [f"green {basic}", f"white {LIFE_SYMBOLS[other]}"]
    paths = ["/life/warning", "/life/error", f"/life/{other}_log10_hours", "/life/log10_hours"]
    if not scene.life.is_basic:
        paths, shown = [*paths, "/life/modified_log10_hours"], [*shown, f"purple {modified}"]
    used = axes.plot("Life used [ppm]", ["/damage/ppm"])
    if not scene.estimation.bands:
        return rrb.Tabs(axes.plot(f"Lives, log10 of hours ({', '.join(shown)})", paths, from_zero=False), used, active_tab=0)
    shaded = f"shaded: 5 to 95 %){without_dimensions(one.field for one in ranges_of(scene))}"
    lives = axes.plot(f"Lives, log10 of hours ({', '.join(shown)}, {shaded}", ["/life/band", *paths], from_zero=False)
    remaining = axes.plot(f"Remaining life, log10 of hours ({shaded}", [REMAINING_LIFE.path, REMAINING_LIFE.line], from_zero=False)
    return rrb.Tabs(lives, remaining, used, active_tab=0)


def _tilts(axes: _Axes) -> list[rrb.TimeSeriesView]:
    return [
        axes.plot("Roller tilt [mrad]", ["/tilt/each/tilt"]),
        axes.plot("Roller skew [mrad]", ["/tilt/each/skew"]),
        axes.plot("Ring [mrad]: blue y, orange z", ["/tilt/ring_y", "/tilt/ring_z"]),
        axes.plot("Cage [mrad]", ["/tilt/cage_y", "/tilt/cage_z"]),
    ]


def _right(axes: _Axes) -> rrb.Vertical:
    texts = rrb.Tabs(rrb.TextDocumentView(origin="/now", name="Now"), rrb.TextDocumentView(origin="/about", name="About"), active_tab=0)
    lanes = rrb.StateTimelineView(origin="/", contents=["/regime", "/level"], name="Regime by the slip's thresholds, level", time_view=axes.time)
    return rrb.Vertical(texts, rrb.Tabs(log_view(), lanes, active_tab=0), row_shares=[0.7, 0.3])


def _clearance(scene: Scene, axes: _Axes, is_measured: bool) -> rrb.TimeSeriesView:
    paths = ["/clearance/band"] if scene.estimation.bands else []
    paths += ["/clearance/warning", "/clearance/error", *(f"/clearance/{part}" for part in reversed(CLEARANCES))]
    shown = "white running, grey initial, orange fits, blue rotation, purple heat, green contour"
    if is_measured:
        paths, shown = [*paths, "/clearance/measured"], f"lime measured, {shown}"
    return axes.plot(f"Clearance [µm]: {shown}", paths)


def _temperatures(axes: _Axes) -> rrb.TimeSeriesView:
    paths = [f"/temperature/{body}" for body in BODIES] + [f"/temperature/{ring}_measured" for ring in RING_TEMPERATURES]
    return axes.plot("Temperatures [°C]: blue inner, red outer ring, yellow rollers, white measured", paths, from_zero=False)
