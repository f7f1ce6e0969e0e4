# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bearing as a solid in rerun: the same picture as the cross-section, to be turned and looked into."""

import math

import numpy as np
import rerun as rr

from bearing_sim.scene import Scene
from bearing_sim.sinks import colours, section
from bearing_sim.sinks.section import MILLIMETRE

ROOT = "/solid"
_TURN = np.linspace(0.0, 2 * math.pi, 181)
# Cylinders stand along their third axis: here that is the shaft's, so the drawing's (y, z, x) become (x, y, z) by this turn.
_TO_BEARING_FRAME = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


class SolidDrawing:
    """The bearing of a scene in three dimensions.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : whose bearing to draw.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        self._recording = recording
        self._bearing = scene.bearing
        self._cage_factor = section.cage_magnification(scene)
        self._factor = section.magnification(scene.bearing)
        self._tilts, self._tilt_factor = scene.bodies_tilt, section.tilt_magnification(scene)
        self._skew_factor = section.skew_magnification(scene.bearing)
        self._half_length = scene.bearing.roller.length / 2 / MILLIMETRE

    def draw_still_parts(self) -> None:
        """Draw the outer raceway, and what the moving parts keep."""
        bearing, half = self._bearing, self._half_length
        self._still("", rr.Transform3D(mat3x3=_TO_BEARING_FRAME))
        contour = section.drawn_contour(bearing, self._factor, _TURN)
        ends = [_ring(contour, _TURN, end) for end in (-1.2 * half, 1.2 * half)]
        self._still("outer_ring/raceway", rr.LineStrips3D(ends, radii=0.25, colors=colours.VERMILION))
        generators = np.stack((ends[0][::5], ends[1][::5]), axis=1)
        self._still("outer_ring/generators", rr.LineStrips3D(generators, radii=0.06, colors=colours.STEEL))
        roller, count = bearing.roller, bearing.roller.count
        rollers = rr.Cylinders3D(
            lengths=np.full(count, 2 * half), radii=np.full(count, roller.diameter / 2 / MILLIMETRE), fill_mode=rr.components.FillMode.Solid
        )
        self._still("rollers", rollers)
        ring = bearing.inner_raceway.radius / MILLIMETRE
        self._still("inner_ring/body", _band(0.6 * ring, ring, 1.2 * half))
        self._still("inner_ring/shaft_mark", rr.LineStrips3D.from_fields(radii=0.5, colors=colours.BLUE))
        if self._tilts:
            self._write_factors()
        self._still("cage/bars", rr.LineStrips3D.from_fields(radii=0.6 * section.cage_bar_stroke(bearing), colors=self._bar_colours()))

    def _write_factors(self) -> None:
        """Write under the bearing by what tilts and skews are drawn; the tab's title has no room for it."""
        text = f"tilt of ring and rollers x{self._tilt_factor}, skew x{self._skew_factor}, tilt of cage x{self._cage_factor}"
        below = [[0.0, -1.35 * self._bearing.outer_raceway.low_radius / MILLIMETRE, 0.0]]
        # an arrow of no length: a point of no size would leave a dot
        self._still(
            "factors", rr.Arrows3D(origins=below, vectors=[[0.0, 0.0, 0.0]], radii=0.0, colors=colours.WHITE, labels=[text], show_labels=True)
        )

    def draw(self, sample: np.void, load_scale: float) -> None:
        """Draw the moving parts of one sample, loads coloured up to ``load_scale`` [N]."""
        bearing, half = self._bearing, self._half_length
        radius = (bearing.pitch_radius + self._factor * (sample["roller_radius"] - bearing.pitch_radius)) / MILLIMETRE
        self._log("rollers", rr.InstancePoses3D(translations=_ring(radius, sample["roller_angle"], 0.0), quaternions=self._roller_turns(sample)))
        self._log("rollers", rr.Cylinders3D.from_fields(colors=colours.load_colours(sample["inner_load"], load_scale)))
        y, z = section.ring_displacement(self._factor, sample)
        ring_tilt, cage_tilt = self._tilt_factor * _lean(sample, "ring"), self._cage_factor * _lean(sample, "cage")
        turns = section.leaning(*ring_tilt)[None] if self._tilts else None
        self._log("inner_ring/body", rr.InstancePoses3D(translations=[[y, z, 0.0]], quaternions=turns))
        mark = _ring(bearing.inner_raceway.radius / MILLIMETRE * np.array([0.6, 1.0]), sample["shaft_angle"], 1.22 * half)
        mark[:, 2] -= mark[:, :2] @ ring_tilt
        mark += [y + 1.22 * half * ring_tilt[0], z + 1.22 * half * ring_tilt[1], 0.0]
        self._log("inner_ring/shaft_mark", rr.LineStrips3D.from_fields(strips=mark[None]))
        middle = (bearing.cage.bore + bearing.cage.outside) / 2 / MILLIMETRE
        azimuth = sample["cage_angle"] + (np.arange(bearing.roller.count) - 0.5) * 2 * math.pi / bearing.roller.count
        cage = [*section.cage_displacement(self._cage_factor, sample), 0.0]
        leant = np.array([*cage_tilt, 0.0])
        bars = np.stack([_ring(middle, azimuth, end) + cage + end * leant for end in (-1.1 * half, 1.1 * half)], axis=1)
        bars[..., 2] -= bars @ leant
        self._log("cage/bars", rr.LineStrips3D.from_fields(strips=bars))

    def _roller_turns(self, sample) -> np.ndarray | None:
        if not self._tilts:
            return None
        cosine, sine = np.cos(sample["roller_angle"]), np.sin(sample["roller_angle"])
        tilt, skew = self._tilt_factor * sample["roller_tilt"], self._skew_factor * sample["roller_skew"]
        return section.leaning(tilt * cosine - skew * sine, tilt * sine + skew * cosine)

    def _bar_colours(self) -> np.ndarray:
        bars = np.full((self._bearing.roller.count, 4), colours.BRONZE, np.uint8)
        bars[0] = colours.ORANGE
        return bars

    def _log(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}", what)

    def _still(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}".rstrip("/"), what, static=True)


def _lean(sample, body: str) -> np.ndarray:
    """Return the inclination of ring or cage towards y and z [rad]; none where it is not known."""
    return np.nan_to_num([float(sample[f"{body}_tilt_{axis}"]) for axis in "yz"])


def _band(inner: float, outer: float, half_length: float) -> rr.Mesh3D:
    """Return a ring of rectangular section about the shaft's axis."""
    corners = [(inner, -half_length), (outer, -half_length), (outer, half_length), (inner, half_length)]
    count, faces = len(_TURN), []
    vertices = [_ring(radius, _TURN, height) for first, second in zip(corners, corners[1:] + corners[:1]) for radius, height in (first, second)]
    for side in range(len(corners)):  # each side has vertices of its own, so that edges stay sharp
        a = 2 * side * count + np.arange(count - 1)
        b = a + count
        faces += [np.stack((a, a + 1, b), axis=1), np.stack((b, a + 1, b + 1), axis=1)]
    normals = [_side_normals(first, second) for first, second in zip(corners, corners[1:] + corners[:1]) for _ in range(2)]
    return rr.Mesh3D(
        vertex_positions=np.concatenate(vertices),
        vertex_normals=np.concatenate(normals),
        triangle_indices=np.concatenate(faces),
        albedo_factor=colours.STEEL,
    )


def _side_normals(first: tuple[float, float], second: tuple[float, float]) -> np.ndarray:
    radial, axial = second[1] - first[1], first[0] - second[0]
    size = math.hypot(radial, axial)
    return _ring(radial / size, _TURN, axial / size)


def _ring(radius, azimuth, height: float) -> np.ndarray:
    """Return points (y, z, x) [mm] at a radius, azimuth and place along the shaft, shape (n, 3)."""
    y, z = np.broadcast_arrays(radius * np.cos(azimuth), radius * np.sin(azimuth))
    return np.stack((y, z, np.full(y.shape, height)), axis=-1)
