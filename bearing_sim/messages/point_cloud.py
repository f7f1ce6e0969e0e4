# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rollers as a sensor_msgs/PointCloud2, one point each.

All numbers of a cloud are 32-bit floats: the viewers of point clouds take the position of a point from fields ``x``, ``y``, ``z`` of this type.
The double-precision numbers stand in the array topics.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

NUMPY_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""NumPy types by the numbers of sensor_msgs/PointField."""
_FLOAT32 = 7  # of sensor_msgs/PointField


class RollerField(NamedTuple):
    """A field of the cloud of rollers.

    Attributes
    ----------
    name, unit, meaning : for documents; a point cloud has no room for units.
    numbers : an observable of the rollers, or a function that returns numbers of samples of shape (n,), shape (n, Z) or (n, 1).
    of_tilting_levels : whether levels without tilts omit it.
    """

    name: str
    unit: str
    meaning: str
    numbers: str | Callable[[np.ndarray], np.ndarray]
    of_tilting_levels: bool = False


def _orbital_slip(samples: np.ndarray) -> np.ndarray:
    ideal = samples["ideal_cage_speed"][:, None]
    return 1.0 - samples["orbital_speed"] / np.where(ideal == 0.0, np.nan, ideal)


ROLLER_FIELDS = (
    RollerField(
        "x", "m", "place of the roller's centre along the shaft; rollers do not move along it: 0", lambda samples: np.zeros((len(samples), 1))
    ),
    RollerField("y", "m", "place of the roller's centre", lambda samples: samples["roller_radius"] * np.cos(samples["roller_angle"])),
    RollerField("z", "m", "place of the roller's centre", lambda samples: samples["roller_radius"] * np.sin(samples["roller_angle"])),
    RollerField("inner_load", "N", "normal force between roller and inner raceway", "inner_load"),
    RollerField("outer_load", "N", "normal force between roller and outer raceway", "outer_load"),
    RollerField("pocket_force", "N", "force of the cage's pocket on the roller, positive where it drives the roller", "pocket_force"),
    RollerField("orbital_speed", "rad/s", "angular speed of the roller's centre about the bearing's", "orbital_speed"),
    RollerField("spin", "rad/s", "rotation about its own axis, positive where it rolls on the outer ring", "roller_spin"),
    RollerField("orbital_slip", "", "1 - orbital speed / cage speed without slip; NaN at rest", _orbital_slip),
    RollerField("tilt", "rad", "inclination of the axis outwards", "roller_tilt", True),
    RollerField("skew", "rad", "inclination of the axis along the orbit", "roller_skew", True),
)
"""The fields of a point of topic ``rollers``, in order.

A level without tilts has no fields ``tilt`` and ``skew``.  NaN there would make readers that drop points with NaN, such as ``read_points`` of
sensor_msgs_py, drop every roller.
"""


def roller_fields(tilting: bool) -> tuple[RollerField, ...]:
    """Return the fields of the rollers at a level, with tilts or without."""
    return tuple(field for field in ROLLER_FIELDS if tilting or not field.of_tilting_levels)


def roller_points(fields: tuple[RollerField, ...], samples: np.ndarray) -> np.ndarray:
    """Return what follows the count of the data in clouds of rollers: the points of each sample, and whether all their numbers are finite.

    Parameters
    ----------
    fields : see `roller_fields`.
    samples : shape (n,).

    Returns
    -------
    numbers : uint8, shape (n, 4 Z fields + 1): 32-bit floats, roller by roller, then ``is_dense``.
    """
    rollers = samples["roller_angle"].shape[1]
    points = np.empty((len(samples), rollers, len(fields)), "<f4")
    for k, field in enumerate(fields):
        points[:, :, k] = samples[field.numbers] if isinstance(field.numbers, str) else field.numbers(samples)
    flat = points.reshape(len(samples), -1)
    found = np.empty((len(samples), 4 * flat.shape[1] + 1), np.uint8)
    found[:, :-1] = flat.view(np.uint8)
    found[:, -1] = np.isfinite(flat).all(axis=1)
    return found


def point_cloud(header: dict, fields: tuple[RollerField, ...], samples: np.ndarray) -> dict:
    """Return sensor_msgs/PointCloud2 of the rollers of one sample (shape (1,)): unordered points, so that its height is 1."""
    (found,) = roller_points(fields, samples)
    rollers, step = samples["roller_angle"].shape[1], 4 * len(fields)
    return {
        "header": header,
        "height": 1,
        "width": rollers,
        "fields": [{"name": field.name, "offset": 4 * k, "datatype": _FLOAT32, "count": 1} for k, field in enumerate(fields)],
        "is_bigendian": False,
        "point_step": step,
        "row_step": step * rollers,
        "data": found[:-1],
        "is_dense": bool(found[-1]),
    }


def points_of(message) -> np.ndarray:
    """Return the points of any sensor_msgs/PointCloud2, deserialised, as records with the names of its fields, shape (points,).

    Raises
    ------
    ValueError
        The data are shorter than the cloud says, or a field lies outside of the points.
    """
    order = ">" if message.is_bigendian else "<"
    known = [field for field in message.fields if field.datatype in NUMPY_TYPES and field.name]
    layout = {
        "names": [field.name for field in known],
        "offsets": [field.offset for field in known],
        "formats": [(order + NUMPY_TYPES[field.datatype], (field.count,) if field.count != 1 else ()) for field in known],
        "itemsize": message.point_step,
    }
    data = np.frombuffer(bytes(message.data), np.uint8)  # decoders have arrays, lists or bytes
    if len(data) < message.height * message.row_step or message.row_step < message.width * message.point_step:
        raise ValueError(f"a point cloud of {message.height} x {message.width} points of {message.point_step} bytes with {len(data)} bytes of data")
    rows = data[: message.height * message.row_step].reshape(message.height, -1)[:, : message.width * message.point_step]
    return np.ascontiguousarray(rows).view(np.dtype(layout)).reshape(-1)
