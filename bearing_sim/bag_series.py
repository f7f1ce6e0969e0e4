# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Numbers over time out of recordings that others wrote: what can be shown of them without knowing the bearing.

Any rosbag2 recording that `rosbags` opens: MCAP or SQLite, a file or a folder.  Times are those of recording (log times),
because not all types have a stamp.
"""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.recording_reader import RecordingError

ROLES = ("speed", "load", "cage_speed", "temperature")
_NUMBERS = {
    f"std_msgs/msg/{kind}" for kind in ("Float64", "Float32", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64", "Bool")
}
_ARRAYS = {f"std_msgs/msg/{kind}MultiArray" for kind in ("Float64", "Float32", "Int16", "Int32", "Int64")}
_USUAL = {"speed": "/shaft_speed", "load": "/radial_load", "cage_speed": f"/{topics.MEASURED}", "temperature": "/oil_temperature"}
_RPM = 30 / math.pi
_MOST_LINES = 64  # of one array


class BagSeries(NamedTuple):
    """What a recording holds that can be shown.

    Attributes
    ----------
    series : by (role or ``""``, name of the line, unit): times [s since the first message] and values, each of shape (n,).
    events : diagnostics that are warnings or errors, and log messages, in order of time.
    left_out : lines of text that say which topics are not shown, and why.
    start_ns : time 0 [ns since the epoch].
    duration : of the recording [s].
    """

    series: dict[tuple[str, str, str], tuple[np.ndarray, np.ndarray]]
    events: list[Event]
    left_out: list[str]
    start_ns: int
    duration: float


def read_bag_series(path: str | Path, named: Mapping[str, str] | None = None) -> BagSeries:
    """Read what can be shown of a recording.

    Parameters
    ----------
    path : a file, or the folder of a bag.
    named : topic by role (`ROLES`) where it has not its usual name.

    Raises
    ------
    RecordingError
        The file is no recording that can be opened, has not a topic that was named, or has nothing that can be shown.
    """
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    path = Path(path)
    roles = {(named or {}).get(role) or usual: role for role, usual in _USUAL.items()}
    roles = {topic if topic.startswith("/") else f"/{topic}": role for topic, role in roles.items()}
    rows: dict[tuple[str, str, str], list[tuple[int, float]]] = {}
    events, unread, counts = [], {}, {}
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as bag:
            _require_named(path, bag.topics, named or {})
            start_ns, duration = bag.start_time, max(bag.duration, 1) * 1e-9
            for connection, log_ns, data in bag.messages():
                counts[connection.topic] = counts.get(connection.topic, 0) + 1
                show = _shower(connection.msgtype)
                if show is None:
                    unread[connection.topic] = f"{connection.topic}: nothing to plot in {connection.msgtype}"
                    continue
                try:
                    message = bag.deserialize(data, connection.msgtype)
                    show(connection.topic, roles.get(connection.topic, ""), message, log_ns, rows, events)
                except Exception as fault:  # decoders raise whatever their tables do
                    unread[connection.topic] = f"{connection.topic}: {connection.msgtype} cannot be read ({type(fault).__name__}: {fault})"
    except RecordingError:
        raise
    except (AnyReaderError, OSError, ValueError, KeyError, IndexError, AssertionError) as fault:
        raise RecordingError(f"{path}: neither a recording of bearing_sim nor a rosbag2 recording that can be opened ({fault})") from None
    if not rows:
        raise RecordingError(f"{path}: nothing in it can be shown: {'; '.join(unread.values()) or 'it has no messages'}")
    absent = [f"no {role.replace('_', ' ')} ({topic})" for topic, role in roles.items() if not any(key[0] == role for key in rows)]
    origin = [Event((time - start_ns) * 1e-9, level, code, text) for time, level, code, text in events]
    missing = ["neither slip nor loads, life, powers or pictures of the bearing: they need a model (`bearing-sim replay`)"]
    return BagSeries(
        {key: _sorted(values, start_ns) for key, values in rows.items()}, origin, [*unread.values(), *absent, *missing], start_ns, duration
    )


def _require_named(path: Path, present: Mapping[str, object], named: Mapping[str, str]) -> None:
    for role, topic in named.items():
        if topic and (topic if topic.startswith("/") else f"/{topic}") not in present:
            raise RecordingError(f"{path}: no topic {topic} for the {role.replace('_', ' ')}; it has {', '.join(sorted(present)) or 'none'}")


def _sorted(rows: list[tuple[int, float]], start_ns: int) -> tuple[np.ndarray, np.ndarray]:
    times = np.array([time for time, _ in rows], np.int64)
    order = np.argsort(times, kind="stable")
    return (times[order] - start_ns) * 1e-9, np.array([value for _, value in rows], float)[order]


def _shower(msgtype: str) -> Callable | None:
    """Return what enters a message of a type into rows or events, or None."""
    shown = {
        "sensor_msgs/msg/JointState": _joints,
        "geometry_msgs/msg/WrenchStamped": lambda topic, role, message, *rest: _wrench(topic, role, message.wrench, *rest),
        "geometry_msgs/msg/Wrench": _wrench,
        "sensor_msgs/msg/Temperature": _temperature,
        "diagnostic_msgs/msg/DiagnosticArray": _diagnostics,
        "rcl_interfaces/msg/Log": _log,
    }
    if msgtype in _NUMBERS:
        return _number
    return _array if msgtype in _ARRAYS else shown.get(msgtype)


def _enter(rows, role: str, name: str, unit: str, time: int, value: float) -> None:
    rows.setdefault((role, name, unit), []).append((time, float(value)))


def _joints(topic, role, message, time, rows, events) -> None:
    for place, name in enumerate(message.name):
        own = role or {topics.SHAFT_JOINT: "speed", topics.CAGE_JOINT: "cage_speed"}.get(name, "")
        if place < len(message.velocity):
            _enter(rows, own, f"{topic} {name}", "rpm", time, _RPM * message.velocity[place])


def _wrench(topic, role, wrench, time, rows, events) -> None:
    _enter(rows, role, f"{topic} radial force", "N", time, math.hypot(wrench.force.y, wrench.force.z))


def _temperature(topic, role, message, time, rows, events) -> None:
    _enter(rows, role, f"{topic}", "°C", time, message.temperature)


def _number(topic, role, message, time, rows, events) -> None:
    factor, unit = {"speed": (_RPM, "rpm"), "cage_speed": (_RPM, "rpm"), "load": (1.0, "N"), "temperature": (1.0, "°C")}.get(role, (1.0, "-"))
    _enter(rows, role, topic, unit, time, factor * float(message.data))


def _array(topic, role, message, time, rows, events) -> None:
    for place, value in enumerate(message.data[:_MOST_LINES]):
        _enter(rows, role, f"{topic} {place}", "-", time, value)


def _diagnostics(topic, role, message, time, rows, events) -> None:
    for status in message.status:
        if 0 < int(status.level) <= 2:
            events.append((time, Level(int(status.level)), status.name, status.message))


def _log(topic, role, message, time, rows, events) -> None:
    level = Level.ERROR if message.level >= 40 else Level.WARN if message.level >= 30 else Level.OK
    events.append((time, level, message.name, message.msg))
