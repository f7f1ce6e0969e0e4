# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read measured cage speeds and residual slips back from our own recordings, finished or not."""

import math
import struct
from collections.abc import Iterable
from pathlib import Path

import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Message
from mcap.stream_reader import CRCValidationError, StreamReader

from bearing_sim.mcap_stream import WholeReads
from bearing_sim.topics import CAGE_JOINT, MEASUREMENTS, input_values

_BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, struct.error, UnicodeDecodeError)


def measurements(files: Iterable[str | Path], start_ns: int) -> list[tuple[float, float, float]]:
    """Return time [s], measured cage speed [rad/s] and residual slip (a fraction, or NaN) of each measurement, in order of time.

    Parameters
    ----------
    files : MCAP files of one recording; of one cut short what was complete is read.
    start_ns : wall time of sample time 0 [ns since the epoch].
    """
    found: dict[str, dict[int, float]] = {f"/{name}": {} for name in MEASUREMENTS}
    decode = _decoder()
    for file in files:
        topics: dict[int, str] = {}
        with open(file, "rb") as stream:
            try:
                for record in StreamReader(WholeReads(stream), record_size_limit=max(Path(file).stat().st_size, 1)).records:
                    if isinstance(record, Channel) and record.topic in found:
                        topics[record.id] = record.topic
                    elif isinstance(record, Message) and record.channel_id in topics:
                        topic = topics[record.channel_id]
                        found[topic][record.log_time] = _number(topic[1:], decode(record.data, MEASUREMENTS[topic[1:]].ros_type))
            except _BROKEN:
                pass  # the file ends early; whoever reads its samples says so
    speeds, residuals = found.values()
    return [((log_ns - start_ns) * 1e-9, speed, residuals.get(log_ns, math.nan)) for log_ns, speed in sorted(speeds.items())]


def _number(name: str, message) -> float:
    if MEASUREMENTS[name].ros_type == "std_msgs/msg/Float64":
        return float(message.data)
    joint = CAGE_JOINT if CAGE_JOINT in message.name else message.name[0]  # a cage of another name is recorded under its own
    return input_values(name, MEASUREMENTS[name].ros_type, message, joint)[0]


def _decoder():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY).deserialize_cdr
