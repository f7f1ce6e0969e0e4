# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is drawn in rerun of one bearing: cross-section, bodies in space, orbit of the cage, temperatures, and bars of powers and clearances.

Each drawing logs its still parts once and its moving parts frame by frame; `bearing_sim.view.section` computes the points.
"""

import math
from collections.abc import Sequence

import numpy as np
import rerun as rr

from bearing_sim.scene.display import force, quantity_text, shown
from bearing_sim.scene.scene import Scene
from bearing_sim.view import colours, section
from bearing_sim.view.plots import LINES, Series, below, features, table
from bearing_sim.view.section import MILLIMETRE, picture, places, polar

_STEPS = 64  # of the colours in a legend
SECTION_ROOT = "/section"
LOAD_ARROW_FACTOR = 2.0  # the radial load's arrow is longer than the contacts' by this, within what the bore has room for
FIRST_POCKET_SCALE = 20.0  # N; grows by itself when exceeded
_CONTOUR_TURN = np.linspace(0.0, 2 * math.pi, section.CONTOUR_POINTS)


def _style(row: dict[str, str]) -> dict[str, object]:
    given = {"colors": getattr(colours, row["colour"], None)} | {
        name: float(row[column]) if row[column] else None for name, column in (("radii", "radius"), ("draw_order", "order"))
    }
    return {name: value for name, value in given.items() if value is not None}


_PARTS = {(row["drawing"], row["part"]): (getattr(rr, row["archetype"]), _style(row)) for row in table("drawings")}


class _Drawing:
    """What is drawn below one entity path, of the parts that ``drawings.csv`` has for ``_name``.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    root : the entity path.
    """

    _name: str

    def __init__(self, recording: rr.RecordingStream, root: str):
        self._recording, self._root = recording, root
        self._styled: set[str] = set()  # the parts whose style is logged

    def _log(self, part: str, static: bool = False, **fields) -> None:
        """Log fields of a part; the first time its style, too, which it keeps."""
        path, (kind, style) = f"{self._root}/{part}".rstrip("/"), _PARTS[self._name, part]
        if part not in self._styled:
            self._styled.add(part)
            if static:
                fields = style | fields
            elif style:
                self._recording.log(path, kind.from_fields(**style), static=True)
        self._recording.log(path, kind.from_fields(**fields), static=static)

    def _still(self, part: str, **fields) -> None:
        self._log(part, static=True, **fields)

    def _place(self, part: str, centres, turns: np.ndarray | None) -> None:
        """Log where the instances of a solid part are, and how they are turned."""
        self._recording.log(f"{self._root}/{part}", rr.InstancePoses3D(translations=centres, quaternions=turns))

    def _draw_scale(self, ends: tuple[float, float], level: float, radius: float, palette: np.ndarray) -> None:
        """Draw a strip of colours across the picture between two places, at a level that counts downwards."""
        edges = np.linspace(*ends, len(palette) + 1)
        strips = np.stack((places(edges[:-1], level), places(edges[1:], level)), axis=1)
        self._log("legend/map", strips=strips, radii=radius, colors=palette)

    def _write(self, path: str, positions, texts: Sequence[str], static: bool = False) -> None:
        """Write texts just below picture points."""
        self._recording.log(f"{self._root}/{path}", labels(positions, texts), static=static)


class SectionDrawing(_Drawing):
    """The cross-section of one bearing.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : the scene that holds the bearing.
    load_scale : load [N] at the upper end of the colour map and of the arrows; grows by itself when exceeded.
    """

    _name = "section"

    def __init__(self, recording: rr.RecordingStream, scene: Scene, load_scale: float):
        super().__init__(recording, SECTION_ROOT)
        self._bearing, self._bends = scene.bearing, scene.outer_ring_bends
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
        contour = section.drawn_contour(bearing, self.factor, _CONTOUR_TURN)
        body = np.stack((polar(contour, _CONTOUR_TURN), polar(outside, _CONTOUR_TURN)), axis=1)
        half_width = 1.1 * math.pi * outside / len(_CONTOUR_TURN)  # a bit more than half the distance: the strips close up
        self._still("outer_ring/body", strips=body, radii=half_width)
        self._still("outer_ring/surface", strips=[polar(outside, _CONTOUR_TURN)])
        self._still("outer_ring/raceway", strips=[polar(contour, _CONTOUR_TURN)])
        round_radius = section.ideal_outer_radius(bearing) / MILLIMETRE
        self._still("outer_ring/round_reference", strips=_dashes(round_radius, 120))
        if self._guide is not None and self._guiding_ring == "outer_ring":
            self._still("outer_ring/guide_land", strips=_dashes(self._guide, 240))
        self._draw_axes()
        self._style_moving_parts()

    def _style_moving_parts(self) -> None:
        """Log once what the moving parts keep: each picture then holds positions and load colours only."""
        bearing = self._bearing
        raceway = bearing.inner_raceway.radius / MILLIMETRE
        width = 0.35 * bearing.roller.diameter / MILLIMETRE
        ring = {"half_sizes": [[raceway - width / 2] * 2, [raceway - 0.1] * 2], "line_radii": [width / 2, 0.2]}
        self._still("inner_ring/body", **ring, colors=[colours.DARK_STEEL, colours.BLUE])
        rims = np.array([bearing.cage.bore, bearing.cage.outside]) / MILLIMETRE
        self._still("cage/rims", half_sizes=places(rims, rims), line_radii=0.12)
        bars = _bar_colours(bearing.roller.count)
        self._still("cage/bars", radii=section.cage_bar_stroke(bearing), colors=bars)
        self._still("rollers", radii=bearing.roller.diameter / 2 / MILLIMETRE)

    def draw(self, sample: np.void) -> None:
        """Draw the moving parts of one sample at the recording's current time."""
        largest = max(_largest(sample["inner_load"]), _largest(sample["outer_load"]))
        self.load_scale = _grown(self.load_scale, largest)
        if self.load_scale != self._legend_scale:
            self._draw_legend()
        self._draw_inner_ring(sample)
        if self._bends:
            bent = section.bent_contour(self._bearing, self.factor, _CONTOUR_TURN, sample)
            self._log("outer_ring/bent_raceway", strips=[polar(bent, _CONTOUR_TURN)])
        cage = section.cage_displacement(self._cage_factor, sample)
        self._log("cage/rims", centers=np.tile(picture(*cage), (2, 1)))
        bars = section.cage_bars(self._bearing, sample["cage_angle"], cage)
        self._log("cage/bars", strips=bars)
        fill = colours.load_colours(sample["inner_load"], self.load_scale)
        centres = section.roller_centres(self._bearing, self.factor, sample)
        self._log("rollers", positions=centres, colors=fill)
        self._log("spin_marks", strips=section.spin_marks(self._bearing, centres, sample))
        self._draw_forces(sample, fill)
        self._draw_pocket_forces(sample, centres)

    def _draw_inner_ring(self, sample) -> None:
        centre = section.ring_displacement(self.factor, sample)
        raceway = self._bearing.inner_raceway.radius / MILLIMETRE
        self._log("inner_ring/body", centers=np.tile(picture(*centre), (2, 1)))
        mark = polar(raceway * np.array([0.84, 1.0]), sample["shaft_angle"], centre)
        self._log("inner_ring/shaft_mark", strips=mark[None])
        if self._guiding_ring == "inner_ring":
            land = _dashes(self._guide, 240, section.land_displacement(self._bearing, self._cage_factor, sample))
            self._log("inner_ring/guide_land", strips=land)

    def _draw_forces(self, sample, fill: np.ndarray) -> None:
        per_newton = self._arrow / self.load_scale
        origins_i, vectors_i, origins_e, vectors_e = section.load_arrows(self._bearing, self.factor, sample, per_newton)
        self._log("forces/inner", origins=origins_i, vectors=vectors_i, colors=fill)
        self._log("forces/outer", origins=origins_e, vectors=vectors_e)
        load = math.hypot(sample["load_y"], sample["load_z"])
        length = min(max(LOAD_ARROW_FACTOR * load * per_newton, 0.12 * self._bore), 0.42 * self._bore) if load > 0 else 0.0
        vector = polar(length, math.atan2(sample["load_z"], sample["load_y"]))
        self._log("forces/radial_load", origins=np.zeros((1, 2)), vectors=vector[None])
        beside = picture(0.25 * self._bore, (0.25 if sample["load_z"] <= 0 else -0.05) * self._bore)  # where the arrow is not
        self._write("forces/radial_load_text", [beside], [f"radial load {quantity_text('radial_load', load)}"])

    def _draw_pocket_forces(self, sample, centres: np.ndarray) -> None:
        largest = _largest(np.abs(sample["pocket_force"]))
        self._pocket_scale = _grown(self._pocket_scale, largest)
        if self._pocket_scale != self._pocket_legend_scale:
            self._draw_pocket_legend()
        vectors = section.pocket_arrows(sample, self._pocket_length / self._pocket_scale)
        self._log("forces/pocket", origins=centres, vectors=vectors)

    def _draw_pocket_legend(self) -> None:
        self._pocket_legend_scale = self._pocket_scale
        level, start = -0.77 * self._bore, -0.55 * self._bore
        arrow = picture(self._pocket_length, 0.0)
        self._log("legend/pocket", origins=[picture(start, level)], vectors=[arrow])
        self._write("legend/pocket_text", [picture(0.15 * self._bore, level + 0.11 * self._bore)], [f"pocket force {force(self._pocket_scale)}"])

    @property
    def _pocket_length(self) -> float:
        """Drawn length of the pocket forces' scale [mm]."""
        return 0.9 * self._bearing.roller.diameter / MILLIMETRE

    def _draw_axes(self) -> None:
        unit = self._bore
        origin, vectors = picture(-0.6 * unit, 0.42 * unit), [picture(0.2 * unit, 0.0), picture(0.0, 0.2 * unit)]
        self._still("axes/arrows", origins=[origin, origin], vectors=vectors)
        self._write("axes/names", [picture(-0.28 * unit, 0.52 * unit), picture(-0.6 * unit, 0.84 * unit)], ["Y", "Z"], static=True)

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
        unit, level = self._bore, -0.36 * self._bore
        self._draw_scale((-0.45 * unit, 0.45 * unit), -level, 0.03 * unit, colours.load_palette(_STEPS))
        self._write("legend/title", [picture(0.0, level - 0.05 * unit)], [f"roller load 0 to {force(self.load_scale)}"])


def _bar_colours(count: int) -> np.ndarray:
    """Return the colours of the cage's bars, uint8, shape (count, 4); the first one stands out, so that rotation is seen."""
    bars = np.full((count, 4), colours.BRONZE, np.uint8)
    bars[0] = colours.ORANGE
    return bars


def _grown(scale: float, largest: float) -> float:
    """Return the full scale of a load, larger where the largest one exceeds it."""
    return section.round_up(largest) if largest > 1.05 * scale else scale


def _largest(loads: np.ndarray) -> float:
    return float(np.nan_to_num(loads).max())


def labels(positions, texts: Sequence[str]) -> rr.Arrows2D:
    """Return texts just below picture points: arrows of no length, because points and boxes of no size leave a dot."""
    return rr.Arrows2D(
        origins=positions, vectors=np.zeros((len(texts), 2)), radii=0.0, colors=colours.WHITE, labels=texts, show_labels=True, draw_order=20.0
    )


def _dashes(radius: float, count: int, centre=(0.0, 0.0)) -> np.ndarray:
    """Return a dashed circle about a centre (y, z) as ``count`` short strips, shape (count, 3, 2)."""
    starts = np.arange(count) * 2 * math.pi / count
    return polar(radius, starts[:, None] + np.linspace(0.0, 0.55 * 2 * math.pi / count, 3)[None, :], centre)


SOLID_ROOT = "/solid"
_TURN = np.linspace(0.0, 2 * math.pi, 181)
# Cylinders stand along their third axis: here that is the shaft's, so the drawing's (y, z, x) become (x, y, z) by this turn.
_TO_BEARING_FRAME = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


class SolidDrawing(_Drawing):
    """The bearing of a scene in three dimensions.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : the scene that holds the bearing.
    """

    _name = "solid"

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        super().__init__(recording, SOLID_ROOT)
        self._bearing = scene.bearing
        self._cage_factor = section.cage_magnification(scene)
        self._factor = section.magnification(scene.bearing)
        self._tilts, self._tilt_factor = scene.bodies_tilt, section.tilt_magnification(scene)
        self._skew_factor = section.skew_magnification(scene.bearing)
        self._half_length = scene.bearing.roller.length / 2 / MILLIMETRE

    def draw_still_parts(self) -> None:
        """Draw the outer raceway, and what the moving parts keep."""
        bearing, half = self._bearing, self._half_length
        self._still("", mat3x3=_TO_BEARING_FRAME)
        contour = section.drawn_contour(bearing, self._factor, _TURN)
        ends = [_ring(contour, _TURN, end) for end in (-1.2 * half, 1.2 * half)]
        self._still("outer_ring/raceway", strips=ends)
        generators = np.stack((ends[0][::5], ends[1][::5]), axis=1)
        self._still("outer_ring/generators", strips=generators)
        roller, count = bearing.roller, bearing.roller.count
        self._still(
            "rollers",
            lengths=np.full(count, 2 * half),
            radii=np.full(count, roller.diameter / 2 / MILLIMETRE),
            fill_mode=rr.components.FillMode.Solid,
        )
        ring = bearing.inner_raceway.radius / MILLIMETRE
        self._still("inner_ring/body", **_band(0.6 * ring, ring, 1.2 * half), albedo_factor=colours.STEEL)
        if self._tilts:
            self._write_factors()
        self._still("cage/bars", radii=0.6 * section.cage_bar_stroke(bearing), colors=_bar_colours(count))

    def _write_factors(self) -> None:
        """Write under the bearing by what tilts and skews are drawn; the tab's title has no room for it."""
        text = f"tilt of ring and rollers x{self._tilt_factor}, skew x{self._skew_factor}, tilt of cage x{self._cage_factor}"
        below = [[0.0, -1.35 * self._bearing.outer_raceway.low_radius / MILLIMETRE, 0.0]]
        # an arrow of no length: a point of no size would leave a dot
        self._still("factors", origins=below, vectors=[[0.0, 0.0, 0.0]], labels=[text], show_labels=True)

    def draw(self, sample: np.void, load_scale: float) -> None:
        """Draw the moving parts of one sample, loads coloured up to ``load_scale`` [N]."""
        bearing, half = self._bearing, self._half_length
        radius = (bearing.pitch_radius + self._factor * (sample["roller_radius"] - bearing.pitch_radius)) / MILLIMETRE
        self._place("rollers", _ring(radius, sample["roller_angle"], 0.0), self._roller_turns(sample))
        self._log("rollers", colors=colours.load_colours(sample["inner_load"], load_scale))
        y, z = section.ring_displacement(self._factor, sample)
        ring_tilt, cage_tilt = self._tilt_factor * _lean(sample, "ring"), self._cage_factor * _lean(sample, "cage")
        turns = section.leaning(*ring_tilt)[None] if self._tilts else None
        self._place("inner_ring/body", [[y, z, 0.0]], turns)
        mark = _ring(bearing.inner_raceway.radius / MILLIMETRE * np.array([0.6, 1.0]), sample["shaft_angle"], 1.22 * half)
        mark[:, 2] -= mark[:, :2] @ ring_tilt
        mark += [y + 1.22 * half * ring_tilt[0], z + 1.22 * half * ring_tilt[1], 0.0]
        self._log("inner_ring/shaft_mark", strips=mark[None])
        middle = (bearing.cage.bore + bearing.cage.outside) / 2 / MILLIMETRE
        azimuth = sample["cage_angle"] + (np.arange(bearing.roller.count) - 0.5) * 2 * math.pi / bearing.roller.count
        cage = [*section.cage_displacement(self._cage_factor, sample), 0.0]
        leant = np.array([*cage_tilt, 0.0])
        bars = np.stack([_ring(middle, azimuth, end) + cage + end * leant for end in (-1.1 * half, 1.1 * half)], axis=1)
        bars[..., 2] -= bars @ leant
        self._log("cage/bars", strips=bars)

    def _roller_turns(self, sample) -> np.ndarray | None:
        if not self._tilts:
            return None
        cosine, sine = np.cos(sample["roller_angle"]), np.sin(sample["roller_angle"])
        tilt, skew = self._tilt_factor * sample["roller_tilt"], self._skew_factor * sample["roller_skew"]
        return section.leaning(tilt * cosine - skew * sine, tilt * sine + skew * cosine)


def _lean(sample, body: str) -> np.ndarray:
    """Return the inclination of ring or cage towards y and z [rad]; none where it is not known."""
    return np.nan_to_num([float(sample[f"{body}_tilt_{axis}"]) for axis in "yz"])


def _band(inner: float, outer: float, half_length: float) -> dict[str, np.ndarray]:
    """Return the mesh of a ring of rectangular section about the shaft's axis, by the names of `rerun.Mesh3D`."""
    corners = [(inner, -half_length), (outer, -half_length), (outer, half_length), (inner, half_length)]
    count, faces = len(_TURN), []
    vertices = [_ring(radius, _TURN, height) for first, second in zip(corners, corners[1:] + corners[:1]) for radius, height in (first, second)]
    for side in range(len(corners)):  # each side has vertices of its own, so that edges stay sharp
        a = 2 * side * count + np.arange(count - 1)
        b = a + count
        faces += [np.stack((a, a + 1, b), axis=1), np.stack((b, a + 1, b + 1), axis=1)]
    normals = [_side_normals(first, second) for first, second in zip(corners, corners[1:] + corners[:1]) for _ in range(2)]
    arrays = {"vertex_positions": vertices, "vertex_normals": normals, "triangle_indices": faces}
    return {name: np.concatenate(parts) for name, parts in arrays.items()}


def _side_normals(first: tuple[float, float], second: tuple[float, float]) -> np.ndarray:
    radial, axial = second[1] - first[1], first[0] - second[0]
    size = math.hypot(radial, axial)
    return _ring(radial / size, _TURN, axial / size)


def _ring(radius, azimuth, height: float) -> np.ndarray:
    """Return points (y, z, x) [mm] at a radius, azimuth and position along the shaft, shape (n, 3)."""
    y, z = np.broadcast_arrays(radius * np.cos(azimuth), radius * np.sin(azimuth))
    return np.stack((y, z, np.full(y.shape, height)), axis=-1)


ORBIT_ROOT = "/cage_orbit"
TURNS = 5.0  # of the cage that the path covers
ORBIT_EDGE = 1.42  # half the picture's width, in plays of the cage
_MICROMETRE = 1e-6  # [m]
_POINTS = (40, 600)  # fewest and most of the path
_LINE_FROM = 24  # samples a cage turn: fewer are dots, since a line between them would be no path


class OrbitPath:
    """The latest positions of the cage's centre: the last `TURNS` turns of the cage, but no fewer and no more points than a picture can show."""

    def __init__(self, guidance: str = "outer_ring"):
        self._guidance = guidance
        self._rows = np.empty((0, 3))  # cage angle [rad], y, z [m]

    def add(self, block: np.ndarray) -> None:
        """Add the samples of a block, which must not be older than the previous ones."""
        rows = np.stack((block["cage_angle"], *eccentricity(self._guidance, block)), axis=1)[-_POINTS[1] :]
        self._rows = np.concatenate((self._rows, rows[np.isfinite(rows).all(axis=1)]))[-_POINTS[1] :]

    def positions(self) -> np.ndarray:
        """Return y, z [m] of the path, oldest first, shape (n, 2)."""
        if not len(self._rows):
            return self._rows[:, 1:]
        recent = int(np.count_nonzero(np.abs(self._rows[:, 0] - self._rows[-1, 0]) <= 2 * math.pi * TURNS))
        return self._rows[-max(recent, _POINTS[0]) :, 1:]

    def is_dense(self) -> bool:
        """Return whether the samples follow each other closely enough for a line."""
        steps = np.abs(np.diff(self._rows[-_POINTS[0] :, 0]))
        return bool(len(steps)) and float(steps.mean()) <= 2 * math.pi / _LINE_FROM


def eccentricity(guidance: str, samples) -> tuple[np.ndarray, np.ndarray]:
    """Return y, z [m] of the cage's centre relative to the centre of the body that guides it."""
    if guidance != "inner_ring":
        return samples["cage_y"], samples["cage_z"]
    return samples["cage_y"] - samples["ring_y"], samples["cage_z"] - samples["ring_z"]


class CageDrawing(_Drawing):
    """The orbit of one bearing's cage, in micrometres.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : the scene that holds the cage.
    """

    _name = "orbit"

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        super().__init__(recording, ORBIT_ROOT)
        self._guidance = scene.bearing.cage.guidance
        self._clearance = scene.bearing.cage.play / _MICROMETRE
        self._path = OrbitPath(self._guidance)
        self._line_drawn = False

    def draw_still_parts(self) -> None:
        """Draw the clearance, the axes, and what the moving parts keep."""
        reach = self._clearance
        self._still("clearance", strips=[polar(reach, _TURN)], radii=0.008 * reach)
        cross = [picture(np.array([-reach, reach]), 0.0), picture(0.0, np.array([-reach, reach]))]
        self._still("axes", strips=cross, radii=0.004 * reach)
        self._write("names", [picture(1.16 * reach, 0.09 * reach), picture(0.0, 1.26 * reach)], ["Y", "Z"], static=True)
        self._still("path/dots", radii=0.026 * reach)
        self._still("path/line", radii=0.008 * reach)
        self._still("centre", radii=0.05 * reach)

    def add(self, block: np.ndarray) -> None:
        """Add samples to the path, whether they are drawn or not."""
        self._path.add(block)

    def draw(self, sample: np.void) -> None:
        """Draw the path and the current position at the recording's current time."""
        positions = self._path.positions() / _MICROMETRE
        points = picture(positions[:, 0], positions[:, 1])
        fade = _faded(len(points))
        dense = self._path.is_dense()
        if dense or self._line_drawn:
            strips = np.stack((points[:-1], points[1:]), axis=1) if dense else np.empty((0, 2, 2))
            self._log("path/line", strips=strips, colors=fade[1:] if dense else fade[:0])
        if not dense or not self._line_drawn:
            self._log("path/dots", positions=points[:0] if dense else points, colors=fade[:0] if dense else fade)
        self._line_drawn = dense
        y, z = (float(position) / _MICROMETRE for position in eccentricity(self._guidance, sample))
        known = math.isfinite(y) and math.isfinite(z)
        self._log("centre", positions=[picture(y, z)] if known else np.empty((0, 2)))
        text = f"e/c = {sample['land_eccentricity']:.3f}, c = {self._clearance:g} µm" if known else "not recorded"
        self._write("text", [picture(0.0, -1.1 * self._clearance)], [text])


def _faded(count: int) -> np.ndarray:
    """Return colours from old to new, uint8, shape (count, 4)."""
    brightness = np.linspace(0.25, 1.0, count)[:, None] if count else np.empty((0, 1))
    return np.concatenate((brightness * np.array(colours.BLUE[:3]), np.full((count, 1), 255.0)), axis=1).astype(np.uint8)


POWER_ROOT = "/power_now"
SAMPLES = 20  # that the bars are means of
CAUSES = below("/power/", "_power")
"""Causes with their names and colours, in the order of the bars; a scene has those of `causes_of`."""

CLEARANCE_ROOT = "/clearance_now"
CLEARANCES = {part: row for part, row in below("/clearance/", "_clearance").items() if not row.threshold}
"""The running clearance and its parts with their names and colours, in the order of the bars; a scene has some, see `had_by`."""

_WIDTH, _PITCH = 100.0, 12.0  # drawn length of the scale, and distance of two bars


class BarDrawing(_Drawing):
    """Bars of one run, each on a line of its own with its name and its value; all on one scale, which fits the longest.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    root : the entity path.
    bars : the series whose newest mean each bar shows, all of one unit.
    digits : after the point.
    signed : whether values are as often negative as positive: there is room for bars to the left, too.
    """

    _name = "bars"

    def __init__(self, recording: rr.RecordingStream, root: str, bars: Sequence[Series], digits: int = 0, signed: bool = False):
        super().__init__(recording, root)
        self._bars, self._digits, self._signed = bars, digits, signed
        self._scale = 1.0  # in the unit shown
        self._newest = np.empty((0, len(bars)))
        self._levels = _PITCH * np.arange(len(bars))

    def draw_still_parts(self) -> None:
        """Write the names, and what the bars keep."""
        left = -0.28 * _WIDTH - (_WIDTH if self._signed else 0.0)
        self._write("names", places(left, self._levels - 0.42 * _PITCH), [bar.name for bar in self._bars], static=True)
        self._still("bars", colors=[bar.colour for bar in self._bars])
        if self._signed:
            zero = [[0.0, -0.7 * _PITCH], [0.0, (len(self._bars) - 0.3) * _PITCH]]
            self._still("zero", strips=[zero])

    def add(self, block: np.ndarray) -> None:
        """Add the samples of a block, whether they are drawn or not."""
        rows = np.stack([block[bar.observable][-SAMPLES:] for bar in self._bars], axis=1)
        self._newest = np.concatenate((self._newest, rows))[-SAMPLES:]

    def draw(self) -> None:
        """Draw the bars at the recording's current time: means of the newest `SAMPLES`."""
        values = np.array([bar.values(mean) for bar, mean in zip(self._bars, self._newest.mean(axis=0))])
        known = np.nan_to_num(values)
        largest = float(np.abs(known).max())
        if largest > 0.0 and not 0.25 * self._scale < largest <= self._scale:
            self._scale = section.round_up(largest)
        ends = _WIDTH * known / self._scale
        radii = np.minimum(0.3 * _PITCH, 0.45 * np.abs(ends))  # the ends of lines are round and stand out by this
        left, right = np.minimum(ends, 0.0) + radii, np.maximum(ends, 0.0) - radii
        bars = np.stack((places(left, self._levels), places(right, self._levels)), axis=1)
        self._log("bars", strips=bars, radii=radii)
        rounded = np.round(values, self._digits) + 0.0  # no minus before a zero
        units = [shown(bar.observable).unit for bar in self._bars]
        texts = [f"{value:,.{self._digits}f} {unit}" if np.isfinite(value) else "unknown" for value, unit in zip(rounded, units)]
        self._write("values", places(1.28 * _WIDTH, self._levels - 0.42 * _PITCH), texts)


def bar_bounds(count: int, signed: bool = False) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the horizontal and vertical range of so many bars with their texts."""
    return (-(1.56 if signed else 0.56) * _WIDTH, (1.62 if signed else 1.46) * _WIDTH), (-0.8 * _PITCH, (count - 0.1) * _PITCH)


def had_by(scene: Scene, rows: dict[str, Series]) -> dict[str, Series]:
    """Return those of some series, such as `CLEARANCES`, that a scene can have."""
    present = features(scene)
    return {part: row for part, row in rows.items() if row.needs in present}


def causes_of(scene: Scene) -> dict[str, Series]:
    """Return the causes of losses that a scene can have."""
    return had_by(scene, CAUSES)


def power_drawing(recording: rr.RecordingStream, scene: Scene) -> BarDrawing:
    """Return the bars of the powers: means, for at an instant the shaft's power is in part stored, in motion and elastic contacts, or given back."""
    return BarDrawing(recording, POWER_ROOT, [*causes_of(scene).values()])


def clearance_drawing(recording: rr.RecordingStream, scene: Scene) -> BarDrawing:
    """Return the bars of the running clearance and its parts, which add up to it."""
    return BarDrawing(recording, CLEARANCE_ROOT, [*had_by(scene, CLEARANCES).values()], digits=1, signed=True)


HEAT_ROOT = "/temperatures"
BODIES = below("/temperature/", "_temperature")
"""What has a temperature: name, observable and colour of its line, from the outside to the inside."""
_NARROWEST = 10.0  # [K] least span of the colours, so that equal temperatures look alike


class HeatDrawing(_Drawing):
    """The cross-section of one bearing with shaft and housing, coloured by temperature.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : the scene that holds the bearing.
    """

    _name = "temperatures"

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        super().__init__(recording, HEAT_ROOT)
        self._bearing, self._radii = scene.bearing, section.heat_radii(scene.bearing)
        self._round = ("housing", "outer_ring", "inner_ring", "shaft")
        self._scale = (math.inf, -math.inf)  # [degC]
        self._edge = self._radii["housing"][1]

    def draw_still_parts(self) -> None:
        """Draw what the moving parts keep: bodies to scale, except for the housing."""
        spans = np.array([self._radii[name] for name in self._round])
        middle, half = spans.mean(axis=1), 0.5 * np.diff(spans, axis=1)[:, 0]
        self._still("bodies", half_sizes=places(middle, middle), line_radii=half)
        edges = spans[:, 1]
        self._still("edges", half_sizes=places(edges, edges), line_radii=0.004 * self._edge)
        circle, radius = self._radii["rollers"]
        azimuth = 2 * math.pi * np.arange(self._bearing.roller.count) / self._bearing.roller.count
        self._still("rollers", positions=polar(circle, azimuth), radii=radius)

    def draw(self, sample: np.void) -> None:
        """Draw the temperatures of one sample at the recording's current time."""
        celsius = {name: float(row.values(sample[row.observable])) for name, row in BODIES.items()}
        self._widen([value for value in celsius.values() if math.isfinite(value)])
        colour = {name: colours.heat_colours(np.array([value]), self._drawn_scale)[0] for name, value in celsius.items()}
        self._log("bodies", colors=np.array([colour[name] for name in self._round]))
        self._log("rollers", colors=colour["rollers"][None])
        rows = -0.78 * self._edge + 0.24 * self._edge * np.arange(len(BODIES))
        self._log("keys", positions=places(1.35 * self._edge, rows), radii=0.08 * self._edge, colors=[*colour.values()])
        texts = [f"{row.name} {_celsius(celsius[name])}{self._measured(sample, row)}" for name, row in BODIES.items()]
        self._write("texts", places(2.25 * self._edge, rows - 0.09 * self._edge), texts)

    @staticmethod
    def _measured(sample: np.void, body: Series) -> str:
        row = LINES.get(f"/temperature/{body.observable}_measured")
        known = row is not None and math.isfinite(sample[row.observable])
        return f", measured {_celsius(float(row.values(sample[row.observable])))}" if known else ""

    @property
    def _drawn_scale(self) -> tuple[float, float]:
        return self._scale if self._scale[0] < self._scale[1] else (0.0, _NARROWEST)

    def _widen(self, celsius: list[float]) -> None:
        """Widen the scale of the colours so that it holds these temperatures, and draw it again."""
        if not celsius or (self._scale[0] <= min(celsius) and max(celsius) <= self._scale[1]):
            return
        low, high = min(celsius + [self._scale[0]]), max(celsius + [self._scale[1]])
        low = 5.0 * math.floor(low / 5.0)
        high = max(5.0 * math.ceil(high / 5.0), low + _NARROWEST)
        self._scale = (low, high)
        level, ends = 0.78 * self._edge, (1.3 * self._edge, 2.9 * self._edge)
        self._draw_scale(ends, level, 0.05 * self._edge, colours.heat_palette(_STEPS))
        ticks = np.linspace(low, high, 3)
        self._write("legend/ticks", places(np.linspace(*ends, len(ticks)), level + 0.06 * self._edge), [_celsius(tick, 0) for tick in ticks])


def heat_bounds(scene: Scene) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the horizontal and vertical range of the temperatures' picture with its numbers [mm]."""
    edge = section.heat_radii(scene.bearing)["housing"][1]
    return (-1.05 * edge, 3.35 * edge), (-1.05 * edge, 1.05 * edge)


def _celsius(value: float, digits: int = 1) -> str:
    return f"{value:.{digits}f} °C" if math.isfinite(value) else "unknown"
