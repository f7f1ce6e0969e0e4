# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage's orbit in its play: where its centre is, and where it has been in the last turns.

Seen from the centre of what guides it: that of the inner ring where the ring's lands do.
"""

import math

import numpy as np
import rerun as rr

from bearing_sim.scene import Scene
from bearing_sim.sinks import colours
from bearing_sim.sinks.rerun_scene import labels
from bearing_sim.sinks.section import picture, polar

ROOT = "/cage_orbit"
TURNS = 5.0  # of the cage that the path covers
ORBIT_EDGE = 1.42  # half the picture's width, in plays of the cage
_MICROMETRE = 1e-6  # [m]
_POINTS = (40, 600)  # fewest and most of the path
_LINE_FROM = 24  # samples a cage turn: fewer are dots, since a line between them would be no path
_TURN = np.linspace(0.0, 2 * math.pi, 181)


class OrbitPath:
    """The newest places of the cage's centre: those of the last `TURNS` of the cage, but no fewer and no more than can be drawn well."""

    def __init__(self, guidance: str = "outer_ring"):
        self._guidance = guidance
        self._rows = np.empty((0, 3))  # cage angle [rad], y, z [m]

    def add(self, block: np.ndarray) -> None:
        """Enter the samples of a block, which must not be older than those before."""
        rows = np.stack((block["cage_angle"], *eccentricity(self._guidance, block)), axis=1)[-_POINTS[1] :]
        self._rows = np.concatenate((self._rows, rows[np.isfinite(rows).all(axis=1)]))[-_POINTS[1] :]

    def places(self) -> np.ndarray:
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
    """Return y, z [m] of the cage's centre seen from that of what guides it."""
    if guidance != "inner_ring":
        return samples["cage_y"], samples["cage_z"]
    return samples["cage_y"] - samples["ring_y"], samples["cage_z"] - samples["ring_z"]


class CageDrawing:
    """The orbit of one bearing's cage, in micrometres.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    scene : whose cage to draw.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        self._recording = recording
        self._guidance = scene.bearing.cage.guidance
        self._clearance = scene.bearing.cage.play / _MICROMETRE
        self._path = OrbitPath(self._guidance)
        self._line_drawn = False

    def draw_still_parts(self) -> None:
        """Draw the clearance, the axes, and what the moving parts keep."""
        reach = self._clearance
        self._still("clearance", rr.LineStrips2D([polar(reach, _TURN)], radii=0.008 * reach, colors=colours.GREEN, draw_order=-1.0))
        cross = [picture(np.array([-reach, reach]), 0.0), picture(0.0, np.array([-reach, reach]))]
        self._still("axes", rr.LineStrips2D(cross, radii=0.004 * reach, colors=colours.STEEL, draw_order=-5.0))
        self._still("names", labels([picture(1.16 * reach, 0.09 * reach), picture(0.0, 1.26 * reach)], ["Y", "Z"]))
        self._still("path/dots", rr.Points2D.from_fields(radii=0.026 * reach, draw_order=2.0))
        self._still("path/line", rr.LineStrips2D.from_fields(radii=0.008 * reach, draw_order=1.0))
        self._still("centre", rr.Points2D.from_fields(radii=0.05 * reach, colors=colours.ORANGE, draw_order=5.0))

    def add(self, block: np.ndarray) -> None:
        """Enter samples into the path, drawn or not."""
        self._path.add(block)

    def draw(self, sample: np.void) -> None:
        """Draw path and present place at the recording's present time."""
        places = self._path.places() / _MICROMETRE
        points = picture(places[:, 0], places[:, 1])
        fade = _faded(len(points))
        dense = self._path.is_dense()
        if dense or self._line_drawn:
            strips = np.stack((points[:-1], points[1:]), axis=1) if dense else np.empty((0, 2, 2))
            self._log("path/line", rr.LineStrips2D.from_fields(strips=strips, colors=fade[1:] if dense else fade[:0]))
        if not dense or not self._line_drawn:
            self._log("path/dots", rr.Points2D.from_fields(positions=points[:0] if dense else points, colors=fade[:0] if dense else fade))
        self._line_drawn = dense
        y, z = (float(place) / _MICROMETRE for place in eccentricity(self._guidance, sample))
        known = math.isfinite(y) and math.isfinite(z)
        self._log("centre", rr.Points2D.from_fields(positions=[picture(y, z)] if known else np.empty((0, 2))))
        text = f"e/c = {sample['land_eccentricity']:.3f}, c = {self._clearance:g} µm" if known else "not recorded"
        self._log("text", labels([picture(0.0, -1.1 * self._clearance)], [text]))

    def _log(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}", what)

    def _still(self, path: str, what) -> None:
        self._recording.log(f"{ROOT}/{path}", what, static=True)


def _faded(count: int) -> np.ndarray:
    """Return colours from old to new, uint8, shape (count, 4)."""
    share = np.linspace(0.25, 1.0, count)[:, None] if count else np.empty((0, 1))
    return np.concatenate((share * np.array(colours.BLUE[:3]), np.full((count, 1), 255.0)), axis=1).astype(np.uint8)
