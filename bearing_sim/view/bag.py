# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings that other programs wrote: what can be read of them without knowing the bearing, and how it is shown.

Any recording that `bearing_sim.recording.bag_reader` reads, a file or a folder.  Times are those of recording (log times), because not all
types have a stamp.
"""

import math
from array import array
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bearing_sim.files.limits import VIEW_EVENTS, VIEW_LINES, VIEW_NUMBERS, LimitError, printable
from bearing_sim.files.tally import Tally
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import POINT_CLOUD
from bearing_sim.messages.diagnostics import WHOLE, events_of
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.point_cloud import points_of
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.recording.message_fields import numbers, suggestion
from bearing_sim.scene.display import RPM, Shown, shown
from bearing_sim.scene.errors import did_you_mean
from bearing_sim.view import colours
from bearing_sim.view.blueprint import BACKGROUND, log_view, page
from bearing_sim.view.plots import (
    LINES,
    TIMELINE,
    Lines,
    Overview,
    bucket_for,
    describe_range,
    log_event,
    plottable,
    range_path,
    send_columns,
    send_thinned,
)
from bearing_sim.view.run_view import APPLICATION
from bearing_sim.view.viewer import incomplete, is_complete

_NUMBERS = {
    f"std_msgs/msg/{kind}" for kind in ("Float64", "Float32", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64", "Bool")
}
_ARRAYS = {f"std_msgs/msg/{kind}MultiArray" for kind in ("Float64", "Float32", "Int16", "Int32", "Int64")}
_WRENCHES = {"geometry_msgs/msg/Wrench", "geometry_msgs/msg/WrenchStamped"}
_LOGS = {"diagnostic_msgs/msg/DiagnosticArray", "rcl_interfaces/msg/Log"}
_PICTURES = {f"sensor_msgs/msg/{kind}" for kind in ("Image", "CompressedImage", "CameraInfo", "PointCloud", "LaserScan")}
_PICTURES |= {"nav_msgs/msg/OccupancyGrid", "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray", "tf2_msgs/msg/TFMessage"}


class _Role(NamedTuple):
    """A quantity that has a place in views of our own runs too: its usual topic, how it is shown, its entity path and the title of its plot."""

    topic: str
    shown: Shown
    entity: str
    title: str


_SPEEDS = "Speeds [rpm] (blue: shaft, white: cage, measured)"
_ROLES = {
    "speed": _Role("/shaft_speed", shown("shaft_speed"), "/speed/shaft", _SPEEDS),
    "cage_speed": _Role(f"/{topics.MEASURED}", shown("cage_speed"), "/speed/cage_measured", _SPEEDS),
    "load": _Role("/radial_load", shown("radial_load"), "/load/radial", "Radial load [N]"),
    "temperature": _Role("/oil_temperature", shown("oil_temperature"), "/oil/temperature", "Oil [°C]"),
    "clearance": _Role(f"/{topics.MEASURED_CLEARANCE}", shown("running_clearance"), "/clearance/measured", "Running clearance [µm], measured"),
}
_JOINTS = {topics.SHAFT_JOINT: "speed", topics.CAGE_JOINT: "cage_speed", topics.CLEARANCE_JOINT: "clearance"}
_PLACES = ("x", "y", "z")
_MOST_CLOUDS = 2000  # of a topic; of more, every second one is kept, then every fourth ...
_SIZE = -6.0  # radius of a point; negative: in pixels, because a cloud does not say how large its points are
_MOST_LINES = 64  # of one array
_MOST_REASONS = 5  # in an error
_LONGEST_TEXT = 1000  # characters of an event


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
    clouds : in the order in which they were added.
    """

    def __init__(self):
        self.coloured_by = ""
        self.clouds: list[Cloud] = []
        self._seen, self._every = 0, 1

    def add(self, message, log_ns: int) -> int:
        """Add a deserialised sensor_msgs/PointCloud2 with its log time [ns since the epoch]; return how many numbers of it are kept.

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


class BagSeries(NamedTuple):
    """What a recording holds that can be shown.

    Attributes
    ----------
    series : by (role or ``""``, name of the line, unit): times [s since the first message] and values, each of shape (n,).
    events : diagnostics that are warnings or errors, and log messages, in order of time.
    left_out : lines of text that name the topics that are not shown, with the reason.
    start_ns : time 0 [ns since the epoch].
    duration : of the recording [s].
    tally : the messages that were there, those that could not be read and why, and where a file ended early.
    clouds : point clouds by topic.
    """

    series: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]]
    events: list[Event]
    left_out: list[str]
    start_ns: int
    duration: float
    tally: Tally
    clouds: Mapping[str, CloudCourse] = MappingProxyType({})


class Line(NamedTuple):
    """Where a recording holds a quantity that has a role.

    Attributes
    ----------
    topic : with its slash.
    fields : path of the number, or of both components of a load; none for a type that is known.
    scale, offset : value in SI = ``scale`` times the number + ``offset``.
    """

    topic: str
    fields: tuple[str, ...] = ()
    scale: float = 1.0
    offset: float = 0.0


def read_bag_series(path: str | Path, named: Mapping[str, Line] | None = None, constants: Mapping[str, float] = MappingProxyType({})) -> BagSeries:
    """Read what can be shown of a recording.

    Parameters
    ----------
    path : a file, or the folder of a bag.
    named : by role (speed, load, cage_speed, temperature, clearance), where it is, if not at the topic of the usual name.
    constants : by role, values in SI that nobody recorded, shown all the time.

    Raises
    ------
    RecordingError
        The file cannot be opened as a recording, lacks a named topic or field, or holds nothing that can be shown.
    """
    path, named = Path(path), named or {}
    by_field = [role for role, line in named.items() if line.fields]
    roles = {named[role].topic if role in named else usual.topic: role for role, usual in _ROLES.items() if role not in (*by_field, *constants)}
    missing: dict[str, str] = {}
    taken = _Taken(path)
    unread, present, clouds = {}, set(), {}
    bag = BagReader(path)
    for found in bag:
        if isinstance(found, BagTopic):
            present.add(found.name)
            continue
        (topic, ros_type, decode, _), log_ns, data = found
        taken.note_time(log_ns)
        if ros_type in _PICTURES:
            unread[topic] = f"{topic}: nothing to plot in {ros_type}"
            continue
        try:
            message = decode(data)
            taken.add_events(_events_in(ros_type, message, log_ns))
            if ros_type == POINT_CLOUD:
                taken.count(clouds.setdefault(topic, CloudCourse()).add(message, log_ns))
            found_here = [*_numbers_in(ros_type, topic, roles.get(topic, ""), message)]
            for role, line in named.items():
                if line.topic == topic and line.fields:
                    found_here += _role_of_fields(role, line, message, missing)
                elif line.topic == topic and all(key[0] != role for key in found_here):
                    missing[role] = f"no {role.replace('_', ' ')} in {topic}, a {ros_type}; name a field of it{suggestion(message)}"
            if not found_here and ros_type not in _LOGS and ros_type != POINT_CLOUD:
                unread[topic] = f"{topic}: nothing to plot in {ros_type}"
            for *key, value in found_here:
                taken.add(tuple(key), log_ns, float(value))
        except LimitError as error:
            raise RecordingError(f"{path}: {error}") from None
        except Exception as error:  # decoders raise many kinds of exceptions
            unread[topic] = f"{topic}: {ros_type} cannot be read ({printable(str(error))})"
    rows, times = taken.rows, (taken.first, taken.last)
    _require_named(path, present, named, missing, {role for role, _, _ in rows})
    if not bag.tally.is_whole:
        unread[""] = bag.tally.text
    unread |= taken.left_out
    clouds = {topic: course for topic, course in clouds.items() if course.clouds}
    if not rows and not clouds:
        reasons = [*islice(unread.values(), _MOST_REASONS), *(["..."] if len(unread) > _MOST_REASONS else [])]
        raise RecordingError(f"{path}: nothing in it can be shown: {'; '.join(reasons) or 'it has no messages'}")
    absent = [f"no {role.replace('_', ' ')} ({topic})" for topic, role in roles.items() if not any(key[0] == role for key in rows)]
    start_ns, duration = min(times), max(max(times) - min(times), 1) * 1e-9
    for role, value in constants.items():
        quantity = _ROLES[role].shown
        level = quantity.scale * value + quantity.offset
        rows[role, f"{role.replace('_', ' ')} throughout, not measured", quantity.unit] = array("q", times), array("d", [level] * 2)
    origin = sorted((event._replace(time=(event.time - start_ns) * 1e-9) for event in taken.events), key=lambda event: event.time)
    model = ["slip, loads, life, powers and pictures of the bearing: they need a model (`bearing-sim replay`)"]
    series = {key: _sorted(values, start_ns) for key, values in rows.items()}
    return BagSeries(series, origin, [*unread.values(), *absent, *model], start_ns, duration, bag.tally, clouds)


class _Taken:
    """What was found in the messages so far, within the limits.

    Parameters
    ----------
    path : of the recording, for messages.

    Attributes
    ----------
    rows : by role, line and unit: times [ns since the epoch] and values.
    events : in the order of the messages; their times are [ns since the epoch].
    first, last : lowest and highest time [ns since the epoch].
    left_out : what exceeds the limits on lines and events, as texts.
    """

    def __init__(self, path: Path):
        self._path = path
        self.rows: dict[tuple[str, str, str], tuple[array, array]] = {}
        self.events: list[Event] = []
        self.first, self.last = 2**63, 0
        self.left_out: dict[str, str] = {}
        self._left = VIEW_NUMBERS.value
        self._most_lines, self._most_events = VIEW_LINES.value, VIEW_EVENTS.value

    def note_time(self, log_ns: int) -> None:
        """Note the time of a message."""
        self.first, self.last = min(self.first, log_ns), max(self.last, log_ns)

    def count(self, numbers: int) -> None:
        """Count numbers; raise `LimitError` if there are too many."""
        self._left -= numbers
        if self._left < 0:
            raise LimitError(f"it has {VIEW_NUMBERS.refusal()}")

    def add(self, key: tuple[str, str, str], log_ns: int, value: float) -> None:
        """Add a number to a line; a line too many is left out."""
        row = self.rows.get(key)
        if row is None:
            if len(self.rows) >= self._most_lines:
                self.left_out["lines"] = f"further lines: {VIEW_LINES.refusal()}"
                return
            row = self.rows[key] = array("q"), array("d")
        self.count(1)
        row[0].append(log_ns)
        row[1].append(value)

    def add_events(self, events: Iterator[Event]) -> None:
        """Add events; those too many are left out."""
        for event in events:
            if len(self.events) >= self._most_events:
                self.left_out["events"] = f"further events: {VIEW_EVENTS.refusal()}"
                return
            texts = {name: printable(str(getattr(event, name)), _LONGEST_TEXT) for name in ("kind", "subject", "reason", "action")}
            self.events.append(event._replace(**texts))


def _role_of_fields(role: str, line: Line, message, missing: dict[str, str]) -> Iterator[tuple[str, str, str, float]]:
    """Yield what `_numbers_in` does of the fields that have a role; enter into ``missing`` why there is none."""
    there = dict(numbers(message))
    absent = [field for field in line.fields if field not in there]
    if absent:
        missing[role] = f"no number {absent[0]!r} in {line.topic}{suggestion(message, absent[0])}"
        return
    values, quantity = [line.scale * there[field] + line.offset for field in line.fields], _ROLES[role].shown
    value = math.hypot(*values) if role == "load" else values[0]
    yield role, f"{line.topic}.{','.join(line.fields)}", quantity.unit, quantity.scale * value + quantity.offset


def _require_named(path: Path, present: set[str], named: Mapping[str, Line], missing: Mapping[str, str], found: set[str]) -> None:
    for role, line in named.items():
        if line.topic not in present:
            there = f"{did_you_mean(line.topic, present)}; it has {', '.join(sorted(present)) or 'none'}"
            raise RecordingError(f"{path}: no topic {line.topic} for the {role.replace('_', ' ')}{there}")
        if role in missing and role not in found:
            raise RecordingError(f"{path}: {missing[role]}")


def _sorted(row: tuple[array, array], start_ns: int) -> tuple[np.ndarray, np.ndarray]:
    times, values = np.frombuffer(row[0], np.int64), np.frombuffer(row[1], float)
    order = np.argsort(times, kind="stable")
    return (times[order] - start_ns) * 1e-9, values[order]


def _numbers_in(ros_type: str, topic: str, role: str, message) -> Iterator[tuple[str, str, str, float]]:
    """Yield role, name of the line, unit and value of each number of a message that is shown."""
    if ros_type == "sensor_msgs/msg/JointState":
        for name, velocity in zip(message.name, message.velocity):
            own = role or _JOINTS.get(name, "")
            yield own, f"{topic} {printable(name)}", "rpm", RPM * velocity
        if not len(message.velocity):  # then positions are what the message is about, with or without a unit behind the name
            for text, position in zip(message.name, message.position):
                name, _, unit = printable(text).removesuffix("]").partition(" [")
                if _JOINTS.get(name) == "clearance" or (role == "clearance" and name != topics.standard_error_joint(topics.CLEARANCE_JOINT)):
                    yield "clearance", f"{topic} {name}", "µm", 1e6 * position
                else:
                    yield "", f"{topic} {name}", unit or "-", position
    elif ros_type in _WRENCHES:
        force = getattr(message, "wrench", message).force
        yield role, f"{topic} radial force", "N", math.hypot(force.y, force.z)
    elif ros_type == "sensor_msgs/msg/Temperature":
        yield role, topic, "°C", message.temperature
    elif ros_type in _NUMBERS:
        quantity = _ROLES[role].shown if role else Shown(topic, "-")
        yield role, topic, quantity.unit, quantity.scale * float(message.data)
    elif ros_type in _ARRAYS:
        for index, value in enumerate(message.data[:_MOST_LINES]):
            yield role, f"{topic} {index}", "-", value
    elif ros_type not in _LOGS and ros_type != POINT_CLOUD:
        for path, value in islice(numbers(message), _MOST_LINES):
            yield "", f"{topic} {path}", "-", value


def _events_in(ros_type: str, message, time: int) -> Iterator[Event]:
    """Yield the events of a message: diagnostics that are warnings or errors, and log messages."""
    if ros_type == "diagnostic_msgs/msg/DiagnosticArray":
        for status in message.status:
            keys = {pair.key for pair in status.values}
            is_whole = status.name.endswith(f": {WHOLE}") and "events" in keys  # it repeats the statuses of the subjects
            if "kind" in keys:
                yield from (event for event in events_of(time, status) if event.level)
            elif 0 < int(status.level) <= 2 and not is_whole:
                yield Event(time, Level(int(status.level)), status.name, "", status.message)
    elif ros_type == "rcl_interfaces/msg/Log":
        level = Level.ERROR if message.level >= 40 else Level.WARN if message.level >= 30 else Level.OK
        yield Event(time, level, message.name, "", message.msg)


_AROUND = (colours.BLUE, colours.ORANGE, colours.GREEN, colours.YELLOW, colours.VERMILION, colours.PURPLE, colours.WHITE, colours.GREY)
_MOST_PLOTS = 9


def write_bag_view(path: str | Path, name: str, found: BagSeries) -> None:
    """Write an .rrd file with what was found in a recording of this name; raise OSError if it cannot be written completely."""
    recording = rr.RecordingStream(APPLICATION)
    recording.set_log_time_enabled(False)
    recording.set_sinks(rr.FileSink(str(path)))
    recording.send_recording_name(name)
    recording.send_recording_start_time_nanos(found.start_ns)
    plots: dict[str, list[str]] = {}
    for (role, line, unit), (times, values) in found.series.items():
        entity, title = _ROLES[role][2:] if role else (_entity(line), f"{line.split(' ')[0]} [{unit}]")
        paths = plots.setdefault(title, [])
        if entity in paths:  # a second topic of the same role
            entity = _entity(line)
        style = (LINES[entity].name, LINES[entity].colour) if entity in LINES else (line, _AROUND[len(paths) % len(_AROUND)])
        _write_line(recording, entity, style, times, plottable(values))
        paths.append(entity)
    for event in found.events:
        log_event(recording, event)
    scenes = []
    for topic, course in found.clouds.items():
        _write_clouds(recording, _entity(topic), course, found.start_ns)
        scenes.append(_cloud_view(topic, _entity(topic), course))
    text = "\n".join([f"## {name}", "", "Not written by bearing_sim. Not shown:", "", *(f"- {line}" for line in found.left_out)])
    recording.log("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
    recording.send_blueprint(_blueprint(plots, scenes))
    try:
        recording.flush(timeout_sec=30.0)
    except (RuntimeError, ValueError) as error:  # what rerun raises once its writer has stopped
        raise incomplete(str(error)) from None
    recording.disconnect()
    if not is_complete(path):
        raise incomplete(None)


def _write_clouds(recording: rr.RecordingStream, entity: str, course: CloudCourse, start_ns: int) -> None:
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


def _cloud_view(topic: str, entity: str, course: CloudCourse) -> rrb.Spatial3DView:
    """Return the view of a topic's clouds, seen from aside along x."""
    reach = max((float(np.abs(cloud.places).max(initial=0.0)) for cloud in course.clouds), default=0.0) or 1.0
    eye = rrb.EyeControls3D(position=(2.6 * reach, 1.3 * reach, 0.9 * reach), look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0))
    title = f"{topic}, coloured by {course.coloured_by}" if course.coloured_by else topic
    return rrb.Spatial3DView(origin="/", contents=[entity], name=title, background=BACKGROUND, eye_controls=eye, line_grid=False)


def _entity(line: str) -> str:
    return "/bag/" + "/".join(rr.escape_entity_path_part(part) for part in line.replace(" ", "/").split("/") if part)


def _write_line(recording: rr.RecordingStream, entity: str, style, times: np.ndarray, values: np.ndarray) -> None:
    name, colour = style
    recording.log(entity, rr.SeriesLines(names=[name], colors=[colour], widths=[2.0]), static=True)
    lines = Lines(times, {entity: values})
    interval = (times[-1] - times[0]) / max(len(times) - 1, 1)
    bucket = bucket_for(interval, float(times[-1] - times[0])) if interval > 0.0 else None
    if bucket is None:
        send_columns(recording, lines)
        return
    describe_range(recording, entity, name, colour)
    overview = Overview(bucket)
    for thinned in filter(None, (overview.add(lines), overview.finish())):
        send_thinned(recording, thinned)


def _blueprint(plots: dict[str, list[str]], scenes: list[rrb.Spatial3DView]) -> rrb.Blueprint:
    axis = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    known = [role.title for role in _ROLES.values() if role.title in plots]
    titles = list(dict.fromkeys([*known, *plots]))
    views = [rrb.TimeSeriesView(origin="/", contents=[*map(range_path, plots[title]), *plots[title]], name=title, axis_x=axis) for title in titles]
    shown, hidden = views[:_MOST_PLOTS], views[_MOST_PLOTS:]
    columns = 1 if len(shown) <= 4 else 2
    rows = math.ceil(len(shown) / columns)
    grid = rrb.Horizontal(*(rrb.Vertical(*shown[k * rows : (k + 1) * rows]) for k in range(columns) if shown))
    about = rrb.TextDocumentView(origin="/about", name="What is not shown")
    beside = rrb.Vertical(*([rrb.Tabs(*scenes)] if scenes else []), about, *([rrb.Tabs(*hidden)] if hidden else []), log_view())
    return page(rrb.Horizontal(grid, beside, column_shares=[0.68, 0.32]))
