# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Drawing of the cross-section in rerun: the still parts once, the moving parts frame by frame."""

import math

import numpy as np
import rerun as rr

from bearing_sim.scene import Scene
from bearing_sim.sinks import colours, section
from bearing_sim.sinks.section import MILLIMETRE, picture, polar

ROOT = "/section"
LOAD_ARROW_FACTOR = 2.0  # the radial load's arrow is longer than the contacts' by this, within what the bore has room for
FIRST_POCKET_SCALE = 20.0  # N; grows by itself when exceeded
_TURN = np.linspace(0.0, 2 * math.pi, section.CONTOUR_POINTS)


class SectionDrawing:
    """The cross-section of one bearing.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : whose bearing to draw.
    load_scale : load [N] at the upper end of the colour map and of the arrows; grows by itself when exceeded.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene, load_scale: float):
        self._recording = recording
        self._bearing = scene.bearing
        self._cage_factor = section.cage_magnification(scene)
        self._guide, self._guiding_ring = section.drawn_guide_radius(scene.bearing, self._cage_factor), scene.bearing.cage.guidance
        self._pocket_scale, self._pocket_legend_scale = FIRST_POCKET_SCALE, 0.0
        self.factor = section.magnification(scene.bearing)
        self.load_scale = load_scale
        self._legend_scale = 0.0
        self._outside = section.outer_surface_radius(scene.bearing, self.factor)
        self._arrow = 0.17 * self._outside  # drawn length of the load scale [mm]

    def draw_still_parts(self) -> None:
        """Draw what never changes: outer ring, guide land, axes."""
        bearing, outside = self._bearing, self._outside
        contour = section.drawn_contour(bearing, self.factor, _TURN)
        body = np.stack((polar(contour, _TURN), polar(outside, _TURN)), axis=1)
        half_width = 1.1 * math.pi * outside / len(_TURN)  # a bit more than half the distance: the strips close up
        self._still("outer_ring/body", rr.LineStrips2D(body, radii=half_width, colors=colours.DARK_STEEL, draw_order=-5.0))
        self._still("outer_ring/surface", rr.LineStrips2D([polar(outside, _TURN)], radii=0.1, colors=colours.STEEL, draw_order=-4.0))
        self._still("outer_ring/raceway", rr.LineStrips2D([polar(contour, _TURN)], radii=0.22, colors=colours.VERMILION, draw_order=8.0))
        round_radius = section.ideal_outer_radius(bearing) / MILLIMETRE
        self._still("outer_ring/round_reference", rr.LineStrips2D(_dashes(round_radius, 120), radii=0.06, colors=colours.GREY, draw_order=7.0))
        if self._guide is not None and self._guiding_ring == "outer_ring":
            self._still("outer_ring/guide_land", rr.LineStrips2D(_dashes(self._guide, 240), radii=0.08, colors=colours.GREEN, draw_order=-2.0))
        self._draw_axes()
        self._style_moving_parts()

    def _style_moving_parts(self) -> None:
        """Log once what the moving parts keep: each picture then holds positions and load colours only."""
        bearing = self._bearing
        raceway = bearing.inner_raceway.radius / MILLIMETRE
        width = 0.35 * bearing.roller.diameter / MILLIMETRE
        ring = {"half_sizes": [[raceway - width / 2] * 2, [raceway - 0.1] * 2], "line_radii": [width / 2, 0.2]}
        self._still("inner_ring/body", rr.Ellipses2D.from_fields(**ring, colors=[colours.DARK_STEEL, colours.BLUE], draw_order=0.0))
        self._still("inner_ring/shaft_mark", rr.LineStrips2D.from_fields(radii=0.45, colors=colours.BLUE, draw_order=2.0))
        cage = bearing.cage
        rims = [cage.bore / MILLIMETRE, cage.outside / MILLIMETRE]
        sizes = [[rim, rim] for rim in rims]
        self._still("cage/rims", rr.Ellipses2D.from_fields(half_sizes=sizes, line_radii=0.12, colors=colours.DARK_BRONZE, draw_order=-1.0))
        if self._guiding_ring == "inner_ring":
            self._still("inner_ring/guide_land", rr.LineStrips2D.from_fields(radii=0.08, colors=colours.GREEN, draw_order=1.0))
        bars = np.full((bearing.roller.count, 4), colours.BRONZE, np.uint8)
        bars[0] = colours.ORANGE
        self._still("cage/bars", rr.LineStrips2D.from_fields(radii=section.cage_bar_stroke(bearing), colors=bars, draw_order=3.0))
        self._still("rollers", rr.Points2D.from_fields(radii=bearing.roller.diameter / 2 / MILLIMETRE, draw_order=5.0))
        self._still("spin_marks", rr.LineStrips2D.from_fields(radii=0.22, colors=colours.WHITE, draw_order=6.0))
        self._still("forces/inner", rr.Arrows2D.from_fields(radii=0.22, draw_order=9.0))
        self._still("forces/outer", rr.Arrows2D.from_fields(radii=0.22, colors=colours.VERMILION, draw_order=9.0))
        self._still("forces/pocket", rr.Arrows2D.from_fields(radii=0.22, colors=colours.PURPLE, draw_order=9.5))
        self._still("forces/radial_load", rr.Arrows2D.from_fields(radii=0.5, colors=colours.YELLOW, draw_order=10.0))

    def draw(self, sample: np.void) -> None:
        """Draw the moving parts of one sample at the recording's present time."""
        largest = max(_largest(sample["inner_load"]), _largest(sample["outer_load"]))
        if largest > 1.05 * self.load_scale:
            self.load_scale = section.round_up(largest)
        if self.load_scale != self._legend_scale:
            self._draw_legend()
        self._draw_inner_ring(sample)
        cage = section.cage_displacement(self._cage_factor, sample)
        self._log("cage/rims", rr.Ellipses2D.from_fields(centers=np.tile(picture(*cage), (2, 1))))
        bars = section.cage_bars(self._bearing, sample["cage_angle"], cage)
        self._log("cage/bars", rr.LineStrips2D.from_fields(strips=bars))
        fill = colours.load_colours(sample["inner_load"], self.load_scale)
        centres = section.roller_centres(self._bearing, self.factor, sample)
        self._log("rollers", rr.Points2D.from_fields(positions=centres, colors=fill))
        self._log("spin_marks", rr.LineStrips2D.from_fields(strips=section.spin_marks(self._bearing, centres, sample)))
        self._draw_forces(sample, fill)
        self._draw_pocket_forces(sample, centres)

    def _draw_inner_ring(self, sample) -> None:
        centre = section.ring_displacement(self.factor, sample)
        raceway = self._bearing.inner_raceway.radius / MILLIMETRE
        self._log("inner_ring/body", rr.Ellipses2D.from_fields(centers=np.tile(picture(*centre), (2, 1))))
        mark = polar(raceway * np.array([0.84, 1.0]), sample["shaft_angle"], centre)
        self._log("inner_ring/shaft_mark", rr.LineStrips2D.from_fields(strips=mark[None]))
        if self._guiding_ring == "inner_ring":
            land = _dashes(self._guide, 240, section.land_displacement(self._bearing, self._cage_factor, sample))
            self._log("inner_ring/guide_land", rr.LineStrips2D.from_fields(strips=land))

    def _draw_forces(self, sample, fill: np.ndarray) -> None:
        per_newton = self._arrow / self.load_scale
        origins_i, vectors_i, origins_e, vectors_e = section.load_arrows(self._bearing, self.factor, sample, per_newton)
        self._log("forces/inner", rr.Arrows2D.from_fields(origins=origins_i, vectors=vectors_i, colors=fill))
        self._log("forces/outer", rr.Arrows2D.from_fields(origins=origins_e, vectors=vectors_e))
        load = math.hypot(sample["load_y"], sample["load_z"])
        length = min(max(LOAD_ARROW_FACTOR * load * per_newton, 0.12 * self._bore), 0.42 * self._bore) if load > 0 else 0.0
        vector = polar(length, math.atan2(sample["load_z"], sample["load_y"]))
        self._log("forces/radial_load", rr.Arrows2D.from_fields(origins=np.zeros((1, 2)), vectors=vector[None]))
        beside = picture(0.25 * self._bore, (0.22 if sample["load_z"] <= 0 else -0.09) * self._bore)  # where the arrow is not
        self._text("forces/radial_load_text", [beside], [f"radial load {load:.0f} N"])

    def _draw_pocket_forces(self, sample, centres: np.ndarray) -> None:
        largest = _largest(np.abs(sample["pocket_force"]))
        if largest > 1.05 * self._pocket_scale:
            self._pocket_scale = section.round_up(largest)
        if self._pocket_scale != self._pocket_legend_scale:
            self._draw_pocket_legend()
        vectors = section.pocket_arrows(sample, self._pocket_length / self._pocket_scale)
        self._log("forces/pocket", rr.Arrows2D.from_fields(origins=centres, vectors=vectors))

    def _draw_pocket_legend(self) -> None:
        self._pocket_legend_scale = self._pocket_scale
        level, start = -0.75 * self._bore, -0.5 * self._bore
        arrow = picture(self._pocket_length, 0.0)
        self._log("legend/pocket", rr.Arrows2D(origins=[picture(start, level)], vectors=[arrow], radii=0.22, colors=colours.PURPLE))
        self._text("legend/pocket_text", [picture(0.19 * self._bore, level + 0.05 * self._bore)], [f"{self._pocket_scale:g} N on roller by pocket"])

    @property
    def _pocket_length(self) -> float:
        """Drawn length of the pocket forces' scale [mm]."""
        return 0.9 * self._bearing.roller.diameter / MILLIMETRE

    def _draw_axes(self) -> None:
        unit = self._bore
        origin, vectors = picture(-0.6 * unit, 0.32 * unit), [picture(0.22 * unit, 0.0), picture(0.0, 0.22 * unit)]
        self._still("axes/arrows", rr.Arrows2D(origins=[origin, origin], vectors=vectors, radii=0.2, colors=colours.WHITE))
        places = [picture(-0.27 * unit, 0.38 * unit), picture(-0.6 * unit, 0.7 * unit), picture(-0.46 * unit, 0.27 * unit)]
        self._text("axes/names", places, ["Y", "Z", "X towards you"], still=True)

    @property
    def _bore(self) -> float:
        """Radius [mm] of the free space in the middle, which holds axes and legend."""
        return 0.9 * self._bearing.inner_raceway.radius / MILLIMETRE

    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the horizontal and vertical range [mm] of the picture."""
        edge = 1.03 * (self._outside + self._arrow)
        return (-edge, edge), (-edge, edge)

    def _draw_legend(self) -> None:
        self._legend_scale = self.load_scale
        unit, steps = self._bore, 64
        edges, level = np.linspace(-0.45 * unit, 0.45 * unit, steps + 1), -0.46 * unit
        strips = np.stack((picture(edges[:-1], level), picture(edges[1:], level)), axis=1)
        self._log("legend/map", rr.LineStrips2D(strips, radii=0.03 * unit, colors=colours.load_palette(steps)))
        loads = np.linspace(0.0, self.load_scale, 3)
        names = [f"{load:g}" for load in loads[:-1]] + [f"{loads[-1]:g} N"]
        self._text("legend/ticks", picture(np.linspace(edges[0], edges[-1], len(loads)), level - 0.06 * unit), names)
        self._text("legend/title", [picture(0.0, level + 0.19 * unit)], ["load of roller on inner ring"])

    def _text(self, path: str, places, texts: list[str], still: bool = False) -> None:
        log = self._still if still else self._log
        log(path, labels(places, texts))

    def _log(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}", what)

    def _still(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}", what, static=True)


def _largest(loads: np.ndarray) -> float:
    return float(np.nan_to_num(loads).max())


def labels(places, texts: list[str]) -> rr.Arrows2D:
    """Return texts just below picture points: arrows of no length, because points and boxes of no size leave a dot."""
    return rr.Arrows2D(
        origins=places, vectors=np.zeros((len(texts), 2)), radii=0.0, colors=colours.WHITE, labels=texts, show_labels=True, draw_order=20.0
    )


def _dashes(radius: float, count: int, centre=(0.0, 0.0)) -> np.ndarray:
    """Return a dashed circle about a centre (y, z) as ``count`` short strips, shape (count, 3, 2)."""
    starts = np.arange(count) * 2 * math.pi / count
    return polar(radius, starts[:, None] + np.linspace(0.0, 0.55 * 2 * math.pi / count, 3)[None, :], centre)
