# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read our own recordings back: MCAP messages to blocks of samples and events, as the sinks take them.

Of a recording from before all observables were recorded, what it does not hold follows from the scene and from what it does:
rollers stand at equal steps behind the cage's angle (their play in the pockets is left out), an outer load says how deep a
roller sits in the outer raceway, rotations follow from spins, the inner loads together say where the inner ring is, rollers
are taken to roll on the outer ring, and what cannot be known is NaN.
"""

import math
import struct
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Footer, Message, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader

from bearing_sim.bag_files import BagError, mcap_files
from bearing_sim.contour import outer_contour
from bearing_sim.effects import NUMBERS
from bearing_sim.events import Event, Level, Measurement
from bearing_sim.mcap_stream import WholeReads
from bearing_sim.params import contact_stiffness
from bearing_sim.sample import new_block
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, scene_from_yaml
from bearing_sim.topics import (
    ARRAYS,
    CAGE_JOINT,
    DIAGNOSTICS,
    INPUTS,
    MEASURED,
    MEASUREMENTS,
    OUTPUTS,
    RECORDED,
    RESIDUAL,
    ZERO_CELSIUS,
    input_values,
)

ROWS_PER_BLOCK = 1000
METADATA = "bearing_sim"
_REPEATS_WITHIN = 2.5  # [s] a lasting trouble is reported every second, and told once
_TYPES = {f"/{topic.name}": topic.ros_type for topic in (*INPUTS.values(), *RECORDED.values(), *OUTPUTS.values())} | {
    f"/{DIAGNOSTICS[0]}": DIAGNOSTICS[1]
}
_OUTPUT_TOPICS = frozenset(f"/{name}" for name in (*RECORDED, *OUTPUTS))
_RECEIVED = {f"/{name}" for name in (*INPUTS, *MEASUREMENTS)}
_OF_TILTING_LEVELS = tuple(field for name, topic in OUTPUTS.items() if topic.of_tilting_levels for field in ARRAYS[name].fields)
_BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, struct.error, UnicodeDecodeError)


class RecordingError(ValueError):
    """A file that is no recording of ours; the message says what is missing."""


class Received(NamedTuple):
    """A message of an input or a measurement as it was recorded; times are [ns since the epoch]."""

    topic: str
    ros_type: str
    log_ns: int
    publish_ns: int
    data: bytes


class Recording:
    """A recording of one run.

    Parameters
    ----------
    path : what `bearing_sim.sinks.mcap_sink.McapSink` wrote, finished or not: an MCAP file or the folder of a bag.

    Attributes
    ----------
    files : the files of the recording, in order.
    metadata : what its writer said of it, by name (see `bearing_sim.sinks.mcap_sink.METADATA`).
    scene : what was simulated.
    start_ns : wall time of sample time 0 [ns since the epoch].
    samples : number of samples.
    first_time, last_time : simulated times of the first and the last sample [s].
    largest_load : largest roller load [N].
    unfinished : why reading ends before the file's proper end, or ``""``.

    Raises
    ------
    RecordingError
        No such file, no MCAP, no scene in its metadata, or no samples.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.unfinished = ""
        try:
            self.files = mcap_files(self.path)
        except BagError as fault:
            raise RecordingError(str(fault)) from None
        metadata, times, self.largest_load, present = self._scan()
        self.metadata: dict[str, str] = metadata or {}
        listing = ", ".join(sorted(present)) or "no topics"
        if metadata is None:
            raise RecordingError(f"{self.path}: no metadata record {METADATA!r}, so this is no recording of bearing_sim; it has {listing}")
        try:
            self.scene: Scene = scene_from_yaml(metadata["scene"], origin=f"{self.path}: scene in the metadata")
            self.start_ns = int(metadata["start_ns"])
        except (KeyError, ValueError, SceneError, yaml.YAMLError) as fault:
            raise RecordingError(f"{self.path}: the metadata cannot be used: {fault}") from None
        if not times:
            raise RecordingError(f"{self.path}: no samples on {', '.join(sorted(_OUTPUT_TOPICS))}; it has {listing}")
        self.samples = len(times)
        self.first_time, self.last_time = ((edge(times) - self.start_ns) * 1e-9 for edge in (min, max))

    @property
    def duration(self) -> float:
        """Simulated time from the first to the last sample [s]."""
        return self.last_time - self.first_time

    def _scan(self) -> tuple[dict | None, set[int], float, set[str]]:
        """Return our metadata, the log times of samples, the largest load and the topics."""
        metadata, times, largest, present = None, set(), 0.0, set()
        loads_topic = "/roller_loads"
        for topic, message in self._messages():
            if isinstance(message, Metadata):
                metadata = message.metadata if message.name == METADATA else metadata
                continue
            present.add(topic)
            if topic == loads_topic:
                times.add(message.log_time)
                values = trailing_doubles(message.data)
                largest = max(largest, float(values.max(initial=0.0))) if np.isfinite(values).all() else largest
        return metadata, times, largest, present

    def _messages(self) -> Iterator[tuple[str, Message | Metadata]]:
        """Yield (topic, message) in file order, and metadata records with topic ``""``; end quietly where a file was cut short."""
        for file in self.files:
            yield from self._messages_of(file)

    def _messages_of(self, file: Path) -> Iterator[tuple[str, Message | Metadata]]:
        topics: dict[int, str] = {}
        schemas: dict[int, str] = {}
        started = finished = False
        with open(file, "rb") as stream:
            records = StreamReader(WholeReads(stream), validate_crcs=True, record_size_limit=max(file.stat().st_size, 1)).records
            try:
                for record in records:
                    started = True
                    if isinstance(record, Message):
                        yield topics[record.channel_id], record
                    elif isinstance(record, Schema):
                        schemas[record.id] = record.name
                    elif isinstance(record, Channel):
                        self._require_type(record.topic, schemas.get(record.schema_id, ""))
                        topics[record.id] = record.topic
                    elif isinstance(record, Metadata):
                        yield "", record
                    finished = finished or isinstance(record, Footer)
            except _BROKEN as fault:
                if not started:
                    raise RecordingError(f"{file}: not an MCAP file ({fault or type(fault).__name__})") from None
                if not finished:
                    name = "the file" if len(self.files) == 1 else file.name
                    self.unfinished = f"{name} ends early ({str(fault) or type(fault).__name__}); what was complete before that is shown"

    def _require_type(self, topic: str, ros_type: str) -> None:
        expected = _TYPES.get(topic)
        if expected is not None and ros_type != expected:
            raise RecordingError(f"{self.path}: {topic} is of type {ros_type or 'unknown'}; a recording of bearing_sim has {expected}")

    def __iter__(self) -> Iterator[np.ndarray | Event]:
        """Yield blocks of at most `ROWS_PER_BLOCK` samples, and events, in the order of the file."""
        return self._items()

    def with_received(self) -> Iterator["np.ndarray | Event | Received"]:
        """Yield what iterating yields, and the messages of inputs and measurements as they were recorded."""
        return self._items(with_received=True)

    def with_measurements(self) -> Iterator["np.ndarray | Event | Measurement"]:
        """Yield what iterating yields and, before a block, the measurements up to its end that were read by then, in order of time."""
        waiting: dict[int, dict[str, float]] = {}
        for item in self.with_received():
            if isinstance(item, Received):
                name = item.topic[1:]
                if name in MEASUREMENTS:
                    waiting.setdefault(item.log_ns, {})[name] = _measured_number(name, _decoder()(item.data, item.ros_type))
                continue
            if isinstance(item, np.ndarray):
                end_ns = self.start_ns + round(float(item["time"][-1]) * 1e9)
                for log_ns in sorted(stamp for stamp in waiting if stamp <= end_ns):
                    numbers = waiting.pop(log_ns)
                    if MEASURED in numbers:
                        yield Measurement((log_ns - self.start_ns) * 1e-9, numbers[MEASURED], numbers.get(RESIDUAL, math.nan))
            yield item

    def _items(self, with_received: bool = False) -> Iterator["np.ndarray | Event | Received"]:
        rows = _Rows(self.scene, self.start_ns)
        told: dict[tuple[str, Level], float] = {}
        decode = _decoder()
        for topic, message in self._messages():
            if with_received and topic in _RECEIVED:
                ros_type = _TYPES.get(topic) or MEASUREMENTS[topic[1:]].ros_type
                yield Received(topic, ros_type, message.log_time, message.publish_time, message.data)
            if topic not in _TYPES:
                continue
            decoded = trailing_doubles(message.data) if topic[1:] in ARRAYS else decode(message.data, _TYPES[topic])
            if topic == f"/{DIAGNOSTICS[0]}":
                yield from _news(decoded, (message.log_time - self.start_ns) * 1e-9, told)
                continue
            if topic in _OUTPUT_TOPICS and rows.begins_sample(message.log_time) and rows.count == ROWS_PER_BLOCK:
                yield rows.take()
            rows.enter(topic, message.log_time, decoded)
        last = rows.take()
        if len(last):
            yield last


def trailing_doubles(data: bytes) -> np.ndarray:
    """Return the numbers of a Float64MultiArray, the last thing in its CDR: their count, padding to eight bytes, the numbers."""
    words = np.frombuffer(data, "<u4", offset=4, count=(len(data) - 4) // 4)
    for start in range(2, len(words) + 1, 2):
        if len(words) - start in (2 * words[start - 1], 2 * words[start - 2]):
            return np.frombuffer(data, "<f8", offset=4 + 4 * start)
    return np.empty(0)


def _measured_number(name: str, message) -> float:
    if MEASUREMENTS[name].ros_type == "std_msgs/msg/Float64":
        return float(message.data)
    joint = CAGE_JOINT if CAGE_JOINT in message.name else message.name[0]  # a cage of another name is recorded under its own
    return input_values(name, MEASUREMENTS[name].ros_type, message, joint)[0]


@cache
def _decoder():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY).deserialize_cdr


def _news(message, time: float, told: dict[tuple[str, Level], float]) -> Iterator[Event]:
    """Yield the events of a diagnostics message that were not told a moment ago; the first status is the whole's."""
    for status in message.status[1:]:
        code, level = status.name.partition(": ")[2], Level(int(status.level))
        for other in set(Level) - {level}:  # a change of level is news, and so is the way back
            told.pop((code, other), None)
        if time - told.get((code, level), -math.inf) > _REPEATS_WITHIN:
            yield Event(time, level, code, status.message)
        told[code, level] = time


class _Rows:
    """Samples being put together from messages that share a log time; inputs hold until the next ones."""

    def __init__(self, scene: Scene, start_ns: int):
        self._scene, self._start_ns = scene, start_ns
        self._block = new_block(ROWS_PER_BLOCK, scene.bearing.roller.count)
        self._log_time: int | None = None
        self._last: np.void | None = None
        operating = scene.operating
        self._load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
        self._temperature = scene.lubricant.temperature
        self.count = 0

    def begins_sample(self, log_time: int) -> bool:
        """Return whether an output message at this time starts a new sample."""
        return log_time != self._log_time

    def enter(self, topic: str, log_time: int, message) -> None:
        """Enter one decoded message."""
        if topic == "/radial_load":
            self._load = (message.wrench.force.y, message.wrench.force.z)
        elif topic == "/oil_temperature":
            self._temperature = message.temperature + ZERO_CELSIUS
        elif topic in _OUTPUT_TOPICS:
            if self.begins_sample(log_time):
                self._begin(log_time)
            self._enter_output(topic, message)

    def _begin(self, log_time: int) -> None:
        self._log_time = log_time
        row = self._block[self.count]
        for name in row.dtype.names:
            row[name] = np.nan
        row["time"] = (log_time - self._start_ns) * 1e-9
        row["load_y"], row["load_z"] = self._load
        row["oil_temperature"] = self._temperature
        self.count += 1

    def _enter_output(self, topic: str, message) -> None:
        row = self._block[self.count - 1]
        if topic == "/bearing_joints":
            places = {name: place for place, name in enumerate(message.name)}
            for joint, field in (("shaft", "shaft"), ("cage", "cage"), ("cage_ideal", "ideal_cage")):
                row[f"{field}_angle"], row[f"{field}_speed"] = message.position[places[joint]], message.velocity[places[joint]]
        elif topic[1:] in ARRAYS:
            fields = ARRAYS[topic[1:]].fields
            for field, values in zip(fields, np.reshape(message, (len(fields), -1))):
                row[field] = values if row[field].ndim else values[0]
        else:
            row[topic[1:]] = message.data

    def take(self) -> np.ndarray:
        """Return the samples so far, completed, and start anew."""
        block, self.count = self._block[: self.count], 0
        block = block[~np.isnan(block["inner_load"]).all(axis=1)]  # of a sample cut short by a kill the loads, written last, are missing
        complete(self._scene, block, self._last)
        if len(block):
            self._last = block[-1].copy()
        return block


def complete(scene: Scene, block: np.ndarray, before: np.void | None = None) -> None:
    """Fill in what a recording does not hold from what it does (see the module's description).

    Equivalent loads that were not recorded are the power means of the instant, not averaged over a roller pitch.

    Parameters
    ----------
    scene : what was simulated.
    block : samples with time, speeds, angles and loads, NaN where nothing was recorded; changed in place.
    before : the completed sample before the block.
    """
    bearing = scene.bearing
    count, radius = bearing.roller.count, bearing.roller.diameter / 2
    stiffness = contact_stiffness(bearing)
    azimuth = block["cage_angle"][:, None] + 2 * math.pi / count * np.arange(count)
    approach = {ring: np.maximum(block[f"{ring}_load"] / stiffness, 0.0) ** 0.9 for ring in ("inner", "outer")}
    _fill(block, "roller_angle", azimuth)
    if np.isnan(block["roller_radius"]).any():
        _fill(block, "roller_radius", outer_contour(bearing.outer_raceway, azimuth)[0] - radius + approach["outer"])
    rolling = bearing.pitch_radius / radius
    _fill(block, "roller_spin", (block["cage_speed"] * rolling)[:, None])
    _fill(block, "orbital_speed", block["cage_speed"][:, None])
    start = block["cage_angle"][:1, None] * rolling
    if np.isnan(block["roller_rotation"]).any():
        _fill(block, "roller_rotation", _rotation(block, before if before is not None else block[0], start))
    _fill(block, "inner_equivalent_load", np.mean(block["inner_load"] ** 4, axis=1) ** (1 / 4))
    _fill(block, "outer_equivalent_load", np.mean(block["outer_load"] ** 4.5, axis=1) ** (1 / 4.5))
    if not scene.bodies_tilt:
        for field in _OF_TILTING_LEVELS:
            _fill(block, field, 0.0)
    _fill(block, "level", NUMBERS[scene.level])
    for life in ("lamina_life", "modified_rating_life"):
        _fill(block, life, block["rating_life"])
    # A loaded roller touches the ring: e cos(phi - phi_e) = delta_i - (R_i + R_w - r); all of them together give e.
    if np.isnan(block["ring_y"]).any():
        wanted = approach["inner"] - (bearing.inner_raceway.radius + radius - block["roller_radius"])
        for field, places in zip(("ring_y", "ring_z"), _ring_centre(azimuth, wanted, block["inner_load"] > 0)):
            _fill(block, field, places)
    guide_y, guide_z = (block["ring_y"], block["ring_z"]) if scene.cage_whirls and bearing.cage.guidance == "inner_ring" else (0.0, 0.0)
    eccentricity = np.hypot(block["cage_y"] - guide_y, block["cage_z"] - guide_z) / bearing.cage.play
    _fill(block, "land_eccentricity", eccentricity)


def _fill(block: np.ndarray, field: str, values: np.ndarray | float) -> None:
    """Enter values where none were recorded."""
    block[field] = np.where(np.isnan(block[field]), values, block[field])


def _rotation(block: np.ndarray, before: np.void, start: np.ndarray) -> np.ndarray:
    """Return the rollers' rotation [rad] by trapezoids over their spins, from ``before`` or, where it knows none, from ``start``."""
    times = np.concatenate(([before["time"]], block["time"]))
    spins = np.concatenate((before["roller_spin"][None], block["roller_spin"]))
    steps = 0.5 * (spins[1:] + spins[:-1]) * np.diff(times)[:, None]
    known = np.isfinite(before["roller_rotation"])
    return np.where(known, before["roller_rotation"], start) + np.cumsum(steps, axis=0)


def _ring_centre(azimuth: np.ndarray, wanted: np.ndarray, touching: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ring centre [m] that fits ``wanted`` [m] best over the touching rollers, by least squares, shape (n,) each.

    A slight pull to the centre gives a ring that too few rollers hold a place.
    """
    cosine, sine = np.where(touching, np.cos(azimuth), 0.0), np.where(touching, np.sin(azimuth), 0.0)
    wanted = np.where(touching, np.nan_to_num(wanted), 0.0)
    a, b, d = (cosine**2).sum(axis=1) + 1e-9, (cosine * sine).sum(axis=1), (sine**2).sum(axis=1) + 1e-9
    p, q = (cosine * wanted).sum(axis=1), (sine * wanted).sum(axis=1)
    determinant = a * d - b * b
    return (d * p - b * q) / determinant, (a * q - b * p) / determinant
