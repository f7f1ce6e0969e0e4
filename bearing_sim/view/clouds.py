# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Point clouds of recordings in a view: where the points are over time, coloured by one of their numbers."""

from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bearing_sim.messages.point_cloud import points_of
from bearing_sim.view import colours
from bearing_sim.view.blueprint import BACKGROUND
from bearing_sim.view.plots import TIMELINE

_PLACES = ("x", "y", "z")
_MOST_CLOUDS = 2000  # of a topic; of more, every second one is kept, then every fourth ...
_SIZE = -6.0  # radius of a point; negative: in pixels, because a cloud does not say how large its points are


class Cloud(NamedTuple):
    """The points of one message: places [m], shape (n, 3), and the number that colours each, shape (n,), or None."""

    log_ns: int
    places: np.ndarray
    numbers: np.ndarray | None


class CloudCourse:
    """The clouds of one topic, thinned out evenly where there are many.

    Attributes
    ----------
    coloured_by : the field that colours the points, the first one after the places; empty if there is none.
    clouds : in the order in which they were taken.
    """

    def __init__(self):
        self.coloured_by = ""
        self.clouds: list[Cloud] = []
        self._seen, self._every = 0, 1

    def take(self, message, log_ns: int) -> int:
        """Take a deserialised sensor_msgs/PointCloud2 with its log time [ns since the epoch]; return how many numbers of it are kept.

        Raises
        ------
        ValueError
            It has no fields ``x``, ``y`` and ``z``, or its data are not as long as it says.
        """
        self._seen += 1
        if (self._seen - 1) % self._every:
            return 0
        points = points_of(message)
        names = points.dtype.names or ()
        if not set(_PLACES) <= set(names):
            raise ValueError(f"a point cloud without the fields x, y and z; it has {', '.join(names) or 'none'}")
        further = [name for name in names if name not in _PLACES]
        self.coloured_by = further[0] if further else ""
        places = np.stack([points[name].astype(float).reshape(len(points), -1)[:, 0] for name in _PLACES], axis=1)
        numbers = points[self.coloured_by].astype(float).reshape(len(points), -1)[:, 0] if further else None
        finite = np.isfinite(places).all(axis=1)
        self.clouds.append(Cloud(log_ns, places[finite], None if numbers is None else numbers[finite]))
        if len(self.clouds) >= _MOST_CLOUDS:
            self.clouds, self._every = self.clouds[::2], 2 * self._every
        return 4 * len(places)


def write_clouds(recording: rr.RecordingStream, entity: str, course: CloudCourse, start_ns: int) -> None:
    """Write the clouds of a topic under an entity path; the colours reach from 0 to the largest number of the recording."""
    clouds = sorted(course.clouds, key=lambda cloud: cloud.log_ns)
    times = [(cloud.log_ns - start_ns) * 1e-9 for cloud in clouds]
    columns = {"positions": np.concatenate([cloud.places for cloud in clouds]).astype(np.float32)}
    if course.coloured_by:
        numbers = np.concatenate([cloud.numbers for cloud in clouds])
        largest = float(np.abs(numbers[np.isfinite(numbers)]).max(initial=0.0))
        columns["colors"] = colours.load_colours(np.abs(numbers), largest or 1.0)
    recording.log(entity, rr.Points3D.from_fields(radii=[_SIZE]), static=True)
    parts = rr.Points3D.columns(**columns).partition([len(cloud.places) for cloud in clouds])
    recording.send_columns(entity, indexes=[rr.TimeColumn(TIMELINE, duration=times)], columns=parts)


def cloud_view(topic: str, entity: str, course: CloudCourse) -> rrb.Spatial3DView:
    """Return the view of a topic's clouds, seen from aside along x."""
    reach = max((float(np.abs(cloud.places).max(initial=0.0)) for cloud in course.clouds), default=0.0) or 1.0
    eye = rrb.EyeControls3D(position=(2.6 * reach, 1.3 * reach, 0.9 * reach), look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0))
    title = f"{topic}, coloured by {course.coloured_by}" if course.coloured_by else topic
    return rrb.Spatial3DView(origin="/", contents=[entity], name=title, background=BACKGROUND, eye_controls=eye, line_grid=False)
