# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Small recordings for tests, written message by message."""

import struct

from mcap.reader import make_reader
from mcap.records import Metadata
from mcap.writer import Writer

from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader
from bearing_sim.recording.writer import McapFile

SECOND = 1_000_000_000


def header(stamp_ns):
    return {"stamp": {"sec": stamp_ns // SECOND, "nanosec": stamp_ns % SECOND}, "frame_id": ""}


def joint_state(stamp_ns, velocity, name="shaft"):
    return {"header": header(stamp_ns), "name": ["other", name], "position": [0.0, 0.0], "velocity": [-1.0, velocity], "effort": [0.0, 0.0]}


def wrench(stamp_ns, y, z=0.0):
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {"header": header(stamp_ns), "wrench": {"force": {"x": 0.0, "y": y, "z": z}, "torque": zero}}


def temperature(stamp_ns, celsius):
    return {"header": header(stamp_ns), "temperature": celsius, "variance": 0.0}


JOINTS, WRENCH, TEMPERATURE, FLOAT = (
    "sensor_msgs/msg/JointState",
    "geometry_msgs/msg/WrenchStamped",
    "sensor_msgs/msg/Temperature",
    "std_msgs/msg/Float64",
)


def write_log(path, speeds, loads, temperatures=(), start_ns=1_700_000_000 * SECOND, speed_topic="/shaft_speed", load_topic="/radial_load"):
    """Write a recording of stamped messages.

    speeds, temperatures: (time [s], value) pairs; loads: (time, y, z). Times are header stamps after start; log times go on by 1 ms
    a message, loads and temperatures first, each in the order given.
    """
    rows = [(time, load_topic, WRENCH, lambda ns, y=y, z=z: wrench(ns, y, z)) for time, y, z in loads]
    rows += [(time, "/oil_temperature", TEMPERATURE, lambda ns, c=c: temperature(ns, c)) for time, c in temperatures]
    rows += [(time, speed_topic, JOINTS, lambda ns, v=v: joint_state(ns, v)) for time, v in speeds]
    with McapFile(path) as recording:
        for place, (time, topic, ros_type, message) in enumerate(rows):
            recording.write(topic, ros_type, start_ns + place * SECOND // 1000, message(start_ns + round(time * 1e9)))
    return path


def steady_log(path, duration=2.0, rate=10, speed=4000.0, load=800.0, start_ns=1_700_000_000 * SECOND):
    """Write a recording of constant speed and load at a rate."""
    times = [place / rate for place in range(round(duration * rate) + 1)]
    return write_log(path, [(time, speed) for time in times], [(time, load, 0.0) for time in times], start_ns=start_ns)


def truncated(path, target, size):
    """Copy the first bytes of a file."""
    target.write_bytes(path.read_bytes()[:size])
    return target


def spoiled(path, target, chunk):
    """Copy a file with some bytes in the middle of its chunk of that number overwritten."""
    data = bytearray(path.read_bytes())
    with open(path, "rb") as stream:
        index = make_reader(stream).get_summary().chunk_indexes[chunk]
    middle = index.chunk_start_offset + index.chunk_length // 2
    data[middle : middle + 40] = b"\xff" * 40
    target.write_bytes(data)
    return target


def flipped(path, target, byte, bit=0):
    """Copy a file with one bit flipped."""
    data = bytearray(path.read_bytes())
    data[byte] ^= 1 << bit
    target.write_bytes(data)
    return target


def raw_cdr_float64(value):
    return b"\x00\x01\x00\x00" + struct.pack("<d", value)


def without_checksums(path, target, **options):
    """Write what an earlier version would have written, by the writer of the mcap library."""
    reader = McapReader(path)
    ids = {}
    with open(target, "wb") as stream:
        writer = Writer(stream, **options)
        writer.start("ros2", "bearing_sim")
        for record in reader:
            if isinstance(record, Metadata):
                writer.add_metadata(record.name, record.metadata)
            elif isinstance(record, Message):
                writer.add_message(ids["channel", record.channel_id], record.log_time, record.data, record.publish_time, record.sequence)
            elif hasattr(record, "topic"):
                schema = ids["schema", record.schema_id]
                ids["channel", record.id] = writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
            elif hasattr(record, "encoding"):
                ids["schema", record.id] = writer.register_schema(record.name, record.encoding, record.data)
        writer.finish()
