# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""An MCAP file of ROS 2 messages, written so that rosbag2, Foxglove and rerun read it and a killed process loses little.

Knows message types by the ROS-free definitions of the rosbags library; needs no ROS.
"""

import os
import threading
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
from mcap.writer import CompressionType, Writer
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

_CHUNK_SIZE = 64 * 1024  # [byte] the writer holds one chunk in memory: small chunks keep each write and each loss short
_ACTIVE = ".active"
_ARRAY = "std_msgs/msg/Float64MultiArray"
_FOREVER = {"sec": 9223372036, "nsec": 854775807}
_QOS = [
    {
        "history": "keep_last",
        "depth": 10,
        "reliability": "reliable",  # offered reliable, a played-back topic suits best-effort subscribers too
        "durability": "volatile",
        "deadline": _FOREVER,
        "lifespan": _FOREVER,
        "liveliness": "automatic",
        "liveliness_lease_duration": _FOREVER,
        "avoid_ros_namespace_conventions": False,
    }
]


class MessageType(NamedTuple):
    """What a recording needs to know of one ROS type."""

    definition: str  # ros2msg text
    hash: str  # RIHS01
    serialize: Callable[[dict], bytes]  # nested dict -> CDR


@cache
def _typestore():
    return get_typestore(Stores.ROS2_JAZZY)


@cache
def message_type(ros_type: str) -> MessageType:
    """Return definition, hash and serialiser of a ROS type such as ``"std_msgs/msg/Float64"``.

    Raises
    ------
    KeyError
        The type is not among ROS 2 Jazzy's standard messages.
    """
    store = _typestore()
    fill = _filler(ros_type)
    definition, _ = store.generate_msgdef(ros_type, ros_version=2)

    def serialize(message: dict) -> bytes:
        return bytes(store.serialize_cdr(fill(message), ros_type))

    return MessageType(definition, store.hash_rihs01(ros_type), _array_serializer(serialize) if ros_type == _ARRAY else serialize)


def _array_serializer(serialize: Callable[[dict], bytes]) -> Callable[[dict], bytes]:
    """Return a serialiser of arrays that keeps the bytes before the numbers: most of a sample are arrays of unchanging lay-out."""
    heads: dict[tuple, bytes] = {}

    def serialize_array(message: dict) -> bytes:
        layout, data = message["layout"], np.asarray(message["data"], "<f8")
        key = (layout["data_offset"], data.size, *[(dim["label"], dim["size"], dim["stride"]) for dim in layout["dim"]])
        if key not in heads:
            whole = serialize(message)
            heads[key] = whole[: len(whole) - data.nbytes]
        return heads[key] + data.tobytes()

    return serialize_array


@cache
def _filler(ros_type: str) -> Callable[[dict], object]:
    store = _typestore()
    message_class = store.types[ros_type]
    fields = [(name, _field_filler(*kind)) for name, kind in store.fielddefs[ros_type][1]]

    def fill(message: dict) -> object:
        return message_class(**{name: convert(message[name]) for name, convert in fields})

    return fill


def _field_filler(node: Nodetype, detail) -> Callable:
    if node == Nodetype.NAME:
        return _filler(detail)
    if node == Nodetype.BASE:
        return (lambda value: value[0]) if detail[0] == "byte" else (lambda value: value)
    (item_node, item_detail), _ = detail
    if item_node == Nodetype.NAME:
        fill = _filler(item_detail)
        return lambda values: [fill(value) for value in values]
    return list if item_detail[0] == "string" else (lambda values: np.asarray(values, item_detail[0]))


class McapFile:
    """An MCAP file being written, profile ``ros2``.

    While it is written it is called ``<path>.active``; `close` completes it and takes the suffix away.  What was written
    more than ``flush_every`` ago is in the hands of the operating system, so that killing the process loses no more (there
    is no fsync: a power cut may lose more).  Methods may be called from several threads.

    Parameters
    ----------
    path : the finished file; its folder is made if absent, a file of that name is replaced at `close`.
    metadata : metadata records by name, each a flat mapping of str to str.
    custom_data : entries of rosbag2's own metadata record, shown by ``ros2 bag info``.
    flush_every : longest time that data stay in this process [s]; at most half a second keeps the promise of the readme.

    Raises
    ------
    OSError
        The file cannot be written there; FileExistsError if ``<path>.active`` exists: a run that writes it now, or the remains of a killed one.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        custom_data: Mapping[str, str] | None = None,
        flush_every: float = 0.5,
    ):
        self.path = Path(path)
        self.active_path = self.path.with_name(self.path.name + _ACTIVE)
        if self.path.is_dir():
            raise IsADirectoryError(f"{self.path} is a folder; expected the name of a file to write")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            self._stream = open(self.active_path, "xb")
        except FileExistsError:
            raise FileExistsError(
                f"{self.active_path} exists: another run is writing it, or a killed run left it; read it, rename it or remove it first"
            ) from None
        self._writer = Writer(self._stream, chunk_size=_CHUNK_SIZE, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="bearing_sim")
        for name, record in (metadata or {}).items():
            self._writer.add_metadata(name, dict(record))
        self._custom_data = dict(custom_data or {})
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, _Channel] = {}
        self._span: tuple[int, int] | None = None
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._fault: OSError | None = None
        self._flush_every = flush_every
        self._writer.flush()
        # A timer, not a check at each write: the last messages before a pause are to be safe too.
        self._flusher = threading.Thread(target=self._flush_on_timer, name="mcap-flush", daemon=True)
        self._flusher.start()

    def write(self, topic: str, ros_type: str, time_ns: int, message: dict) -> None:
        """Write one message.

        Parameters
        ----------
        topic : full topic name, such as ``"/cage_slip"``.
        ros_type : such as ``"std_msgs/msg/Float64"``; the first message of a topic decides.
        time_ns : log and publish time [ns since the epoch].
        message : nested dict as of `bearing_sim.topics`.

        Raises
        ------
        OSError
            The file could not be written, now or by the timer since the last call.
        ValueError
            The file is closed.
        """
        data = message_type(ros_type).serialize(message)
        with self._lock:
            self._raise_fault()
            if self._stream.closed:
                raise ValueError(f"{self.path} is closed")
            channel = self._channels.get(topic) or self._register(topic, ros_type)
            channel.count += 1
            self._span = (time_ns, time_ns) if self._span is None else (min(self._span[0], time_ns), max(self._span[1], time_ns))
            self._writer.add_message(channel.id, time_ns, data, time_ns, sequence=channel.count)

    def __enter__(self) -> "McapFile":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        with self._lock:
            self._raise_fault()
            self._writer.flush()

    def close(self) -> None:
        """Complete the file and give it its name; a second call does nothing."""
        self._closing.set()
        self._flusher.join()
        with self._lock:
            if self._stream.closed:
                return
            try:
                self._writer.add_metadata("rosbag2", {"serialized_metadata": self._rosbag2_metadata()})
                self._writer.finish()
            finally:
                self._stream.close()
            self._raise_fault()
            os.replace(self.active_path, self.path)

    def _register(self, topic: str, ros_type: str) -> "_Channel":
        kind = message_type(ros_type)
        if ros_type not in self._schemas:
            self._schemas[ros_type] = self._writer.register_schema(ros_type, "ros2msg", kind.definition.encode())
        metadata = {"offered_qos_profiles": _yaml(_QOS), "topic_type_hash": kind.hash}
        channel_id = self._writer.register_channel(topic, "cdr", self._schemas[ros_type], metadata)
        self._channels[topic] = _Channel(channel_id, ros_type)
        return self._channels[topic]

    def _flush_on_timer(self) -> None:
        while not self._closing.wait(self._flush_every):
            with self._lock:
                try:
                    self._writer.flush()
                except OSError as fault:  # a full disk must reach the one who writes, who is in another thread
                    self._fault = fault
                    return

    def _raise_fault(self) -> None:
        if self._fault is not None:
            raise OSError(self._fault.errno, f"{self.active_path} could not be written: {self._fault.strerror}") from self._fault

    def _rosbag2_metadata(self) -> str:
        start, end = self._span or (0, 0)
        times = {
            "duration": {"nanoseconds": end - start},
            "starting_time": {"nanoseconds_since_epoch": start},
            "message_count": sum(channel.count for channel in self._channels.values()),
        }
        bag = {
            "version": 9,
            "storage_identifier": "mcap",
            **times,
            "topics_with_message_count": [
                {
                    "topic_metadata": {
                        "name": topic,
                        "type": channel.ros_type,
                        "serialization_format": "cdr",
                        "offered_qos_profiles": _QOS,
                        "type_description_hash": message_type(channel.ros_type).hash,
                    },
                    "message_count": channel.count,
                }
                for topic, channel in self._channels.items()
            ],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [self.path.name],
            "files": [{"path": self.path.name, **times}],
            "custom_data": self._custom_data,
            "ros_distro": "jazzy",
        }
        return _yaml({"rosbag2_bagfile_information": bag})


class _Channel:
    """One channel of the file and how many messages it has."""

    def __init__(self, channel_id: int, ros_type: str):
        self.id = channel_id
        self.ros_type = ros_type
        self.count = 0


class _PlainDumper(yaml.SafeDumper):
    """SafeDumper without anchors, which not every reader of bag metadata follows."""

    def ignore_aliases(self, data):
        return True


def _yaml(tree) -> str:
    return yaml.dump(tree, Dumper=_PlainDumper, sort_keys=False)
