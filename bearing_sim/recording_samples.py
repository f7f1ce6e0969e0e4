# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Samples put together from recorded messages, one by one or many at once."""

import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.message_numbers import NumberPlaces, deserialized, number_places
from bearing_sim.message_rows import Rows
from bearing_sim.recording_completion import complete
from bearing_sim.sample import flat, new_block
from bearing_sim.scene import Scene
from bearing_sim.topics import ARRAYS, OUTPUTS, RECORDED, ZERO_CELSIUS

ROWS_PER_BLOCK = 1000
_WORD = 8  # [byte] of a number
_JOINTS = {"shaft": "shaft", "cage": "cage", "cage_ideal": "ideal_cage"}
"""What the observables of a joint begin with, by its name."""

_OUTPUTS = {**RECORDED, **OUTPUTS}

_RowShape = tuple[np.ndarray, np.ndarray, NumberPlaces]
"""Columns of a sample laid out flat, which of a row's numbers belong there, and where all of these stand in the row."""


class Samples:
    """Samples being put together from messages that share a log time; inputs hold until the next ones.

    Parameters
    ----------
    scene : what was simulated.
    start_ns : wall time of sample time 0 [ns since the epoch].

    Attributes
    ----------
    count : samples begun since the last `take`, at most `ROWS_PER_BLOCK`.
    """

    def __init__(self, scene: Scene, start_ns: int):
        self._scene, self._start_ns = scene, start_ns
        self._block = new_block(ROWS_PER_BLOCK, scene.bearing.roller.count)
        self._log_ns: int | None = None
        self._last: np.void | None = None
        operating = scene.operating
        self._load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
        self._temperature = scene.lubricant.temperature
        self._shapes: dict[tuple, _RowShape | None] = {}  # by the shape of rows
        self.count = 0

    def begins_sample(self, log_ns: int) -> bool:
        """Return whether an output message at this time starts a new sample."""
        return log_ns != self._log_ns

    def enter_input(self, name: str, message) -> None:
        """Enter an input, which the samples from now on have."""
        if name == "radial_load":
            self._load = (message.wrench.force.y, message.wrench.force.z)
        elif name == "oil_temperature":
            self._temperature = message.temperature + ZERO_CELSIUS

    def enter(self, name: str, log_ns: int, message) -> None:
        """Enter one message of an output topic, decoded, or the numbers of an array."""
        if self.begins_sample(log_ns):
            self._begin(np.array([log_ns], np.uint64))
        row = self._block[self.count - 1]
        if name == "bearing_joints":
            places = {name: place for place, name in enumerate(message.name)}
            for joint, field in _JOINTS.items():
                row[f"{field}_angle"], row[f"{field}_speed"] = message.position[places[joint]], message.velocity[places[joint]]
        elif name in ARRAYS:
            fields = ARRAYS[name].fields
            for field, values in zip(fields, np.reshape(message, (len(fields), -1))):
                row[field] = values if row[field].ndim else values[0]
        else:
            row[name] = message.data

    def numbers_of(self, rows: Rows, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray] | None:
        """Return columns of a sample laid out flat and the numbers there, shape (rows, columns), of rows that are a sample each.

        None where they are no samples, or not all laid out alike.

        Parameters
        ----------
        rows : messages of output topics.
        names : topics of the messages of a row, without the slash; ``""`` for one that is not wanted.
        """
        log_ns = rows.all_log_ns()
        first = log_ns[:, 0]
        if not self.begins_sample(int(first[0])) or (first[1:] == first[:-1]).any() or (log_ns != first[:, None]).any():
            return None
        shape = (rows.channels, rows.starts)
        if shape not in self._shapes:
            self._shapes[shape] = self._shape_of(rows, names)
        if self._shapes[shape] is None:
            return None
        columns, known, places = self._shapes[shape]
        numbers = places.numbers(rows.table)
        return None if numbers is None else (columns, numbers[:, known])

    def enter_rows(self, log_ns: np.ndarray, columns: np.ndarray, numbers: np.ndarray) -> None:
        """Enter samples by their log times and what `numbers_of` tells of them; `count` must leave room for them."""
        self._begin(log_ns)[:, columns] = numbers

    def _shape_of(self, rows: Rows, names: Sequence[str]) -> _RowShape | None:
        """Return where the numbers of rows stand and belong; None where it is not known."""
        fixed = np.zeros(rows.table.shape[1], np.uint8)
        columns, places = [np.empty(0, np.intp)], [np.empty(0, np.intp)]
        for k, name in enumerate(names):
            if not name:
                continue
            begin, data = rows.begin(k), rows.data(k)[0].tobytes()
            found = number_places(f"/{name}", _OUTPUTS[name].ros_type, data)
            if found is None:
                return None
            fixed[begin : begin + len(data)] = found.fixed
            places.append(begin + found.places)
            columns.append(self._columns_of(name, data, len(found.places)))
        belong = np.concatenate(columns)
        known = np.flatnonzero(belong >= 0)
        return belong[known], known, NumberPlaces.of(np.concatenate(places), fixed, rows.table[0])

    def _columns_of(self, name: str, data: bytes, count: int) -> np.ndarray:
        """Return the columns of a message's numbers in a sample laid out flat; -1 for what it does not have, as torques of joints."""
        fields: Sequence[str] = ARRAYS[name].fields if name in ARRAYS else (name,)
        if name == "bearing_joints":
            joints = [_JOINTS[joint] for joint in deserialized(_OUTPUTS[name].ros_type, data).name]
            fields = [f"{joint}_{what}" for what in ("angle", "speed") for joint in joints]
        dtype = self._block.dtype
        columns = np.concatenate([np.arange(dtype[field].itemsize // _WORD) + dtype.fields[field][1] // _WORD for field in fields])
        return np.append(columns, np.full(count - len(columns), -1))

    def _begin(self, log_ns: np.ndarray) -> np.ndarray:
        """Begin samples, of which nothing but time and inputs is known, and return their numbers."""
        block = self._block[self.count : self.count + len(log_ns)]
        flat(block)[:] = np.nan
        block["time"] = (log_ns.astype(np.int64) - self._start_ns) * 1e-9
        block["load_y"], block["load_z"] = self._load
        block["oil_temperature"] = self._temperature
        self._log_ns = int(log_ns[-1])
        self.count += len(log_ns)
        return flat(block)

    def take(self) -> np.ndarray:
        """Return the samples so far, completed, and start anew."""
        block, self.count = self._block[: self.count], 0
        block = block[~np.isnan(block["inner_load"]).all(axis=1)]  # of a sample cut short by a kill the loads, written last, are missing
        complete(self._scene, block, self._last)
        if len(block):
            self._last = block[-1].copy()
        return block
