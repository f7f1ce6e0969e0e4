# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Static transforms between frames, as ``/tf_static`` gives them, and loads that are turned from one frame into another.

A transform gives the pose of a child frame in its parent: ``v_parent = R v_child + t`` (REP 103; geometry_msgs/TransformStamped).  A force is a free
vector, so that only the rotations matter.  No ROS is needed here.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

_NORM_TOLERANCE = 0.01  # of a quaternion's norm; transforms of tf2 must be as good


class Transform(NamedTuple):
    """The pose of a frame in its parent.

    Attributes
    ----------
    parent, child : names of the frames.
    position : of the child's origin [m], (x, y, z).
    orientation : of the child, quaternion (x, y, z, w).
    """

    parent: str
    child: str
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


def quaternion(orientation: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the quaternion (x, y, z, w) of length 1 of an orientation.

    Parameters
    ----------
    orientation : a quaternion (x, y, z, w), or roll, pitch and yaw [rad]: rotations about the fixed axes x, y and z of the parent, in this
        order, as those of static_transform_publisher.

    Raises
    ------
    ValueError
        It is neither, or the quaternion's length is not 1.
    """
    if len(orientation) not in (3, 4) or not all(map(math.isfinite, orientation)):
        raise ValueError(f"{list(orientation)}: expected roll, pitch, yaw [rad], or a quaternion x, y, z, w")
    if len(orientation) == 3:
        (roll_c, roll_s), (pitch_c, pitch_s), (yaw_c, yaw_s) = ((math.cos(0.5 * angle), math.sin(0.5 * angle)) for angle in orientation)
        return (
            roll_s * pitch_c * yaw_c - roll_c * pitch_s * yaw_s,
            roll_c * pitch_s * yaw_c + roll_s * pitch_c * yaw_s,
            roll_c * pitch_c * yaw_s - roll_s * pitch_s * yaw_c,
            roll_c * pitch_c * yaw_c + roll_s * pitch_s * yaw_s,
        )
    norm = math.sqrt(sum(part * part for part in orientation))
    if abs(norm - 1.0) > _NORM_TOLERANCE:
        raise ValueError(f"{list(orientation)}: a quaternion of length {norm:.4g}, expected 1")
    x, y, z, w = (part / norm for part in orientation)
    return x, y, z, w


def rotation_matrix(orientation: Sequence[float]) -> np.ndarray:
    """Return the matrix that turns vectors of the child into the parent's axes, shape (3, 3); orientation and errors as for `quaternion`."""
    x, y, z, w = quaternion(orientation)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


class StaticTransforms:
    """The static transforms that are known, each frame with one parent; the newest one of a child counts.

    Parameters
    ----------
    lacks : why no transforms can be received; empty if they can.
    """

    def __init__(self, lacks: str = ""):
        self._lacks = lacks
        self._parents: dict[str, tuple[str, np.ndarray]] = {}  # by child: parent, and rotation into it
        self._between: dict[tuple[str, str], np.ndarray] = {}

    def receive(self, transforms: Iterable[Transform]) -> list[str]:
        """Receive transforms; return a text for each one that cannot be used and is left out."""
        refused = []
        for transform in transforms:
            parent, child = _plain(transform.parent), _plain(transform.child)
            try:
                if not parent or not child or parent == child:
                    raise ValueError("expected the names of two frames")
                self._parents[child] = parent, rotation_matrix(transform.orientation)
            except ValueError as error:
                refused.append(f"transform from {child!r} to {parent!r}: {error}")
        self._between.clear()
        return refused

    def rotation(self, source: str, target: str) -> np.ndarray:
        """Return the matrix that turns vectors of one frame into the axes of another, shape (3, 3).

        Raises
        ------
        LookupError
            No chain of transforms joins the frames.
        """
        found = self._between.get((source, target))
        if found is None:
            ours, theirs = self._to_ancestors(_plain(target)), self._to_ancestors(_plain(source))
            common = next((frame for frame in theirs if frame in ours), None)
            if common is None:
                raise LookupError(self._reason(source, target))
            found = self._between[source, target] = ours[common].T @ theirs[common]
        return found

    def _to_ancestors(self, frame: str) -> dict[str, np.ndarray]:
        """Return the rotations from a frame into itself and its ancestors, the nearest first; a loop ends where it closes."""
        found = {frame: np.eye(3)}
        while frame in self._parents and self._parents[frame][0] not in found:
            parent, rotation = self._parents[frame]
            found[parent], frame = rotation @ found[frame], parent
        return found

    def _reason(self, source: str, target: str) -> str:
        if self._lacks:
            return self._lacks
        frames = sorted({*self._parents, *(parent for parent, _ in self._parents.values())})
        return f"no static transforms join {source!r} and {target!r}; /tf_static has {', '.join(map(repr, frames)) or 'none'}"


def _plain(frame: str) -> str:
    """Return the name of a frame without the leading slash that senders of ROS 1 write."""
    return frame.removeprefix("/")
