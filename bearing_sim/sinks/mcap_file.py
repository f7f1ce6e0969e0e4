# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""An MCAP file of ROS 2 messages, written so that rosbag2, Foxglove and rerun read it and a killed process loses little."""

import os
import threading
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bearing_sim.events import Level
from bearing_sim.sinks.bag_metadata import QOS_TEXT, Part, TopicCount, part_metadata
from bearing_sim.sinks.growing_file import GrowingFile
from bearing_sim.sinks.mcap_rows import RowLayout, RowWriter
from bearing_sim.sinks.ros_types import message_type

_CHUNK_SIZE = 64 * 1024  # [byte] the writer holds one chunk in memory: small chunks keep each write and each loss short
_HASTE = 4 * 1024 * 1024  # [byte] waiting for the disk, beyond which the timer is not waited for
ACTIVE = ".active"
"""What the name of an unfinished file ends in."""


class McapFile:
    """An MCAP file being written, profile ``ros2``.

    While it is written it is called ``<path>.active``; `close` completes it and takes the suffix away.  Writing never waits for
    the disk, which a thread of its own serves.  What was written more than ``flush_every`` ago is in the hands of the operating
    system, so that killing the process loses no more (there is no fsync: a power cut may lose more).  Methods may be called
    from several threads.

    Parameters
    ----------
    path : the finished file; its folder is made if absent.
    metadata : metadata records by name, each a flat mapping of str to str.
    custom_data : entries of rosbag2's own metadata record, shown by ``ros2 bag info``.
    flush_every : longest time that data stay in this process [s]; at most half a second keeps the promise of the readme.
    replace : whether a finished file of that name is replaced at `close`.
    keep_free : free space that the disk shall keep [byte]; below it writing stops with an OSError.

    Raises
    ------
    OSError
        The file cannot be written there; FileExistsError where it exists and is not to be replaced, or if ``<path>.active`` exists: a
        run that writes it now, or the remains of a killed one.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        custom_data: Mapping[str, str] | None = None,
        flush_every: float = 0.5,
        replace: bool = False,
        keep_free: float = 0.0,
    ):
        self.path, self._replace = Path(path), replace
        if self.path.is_dir():
            raise IsADirectoryError(f"{self.path} is a folder; expected the name of a file to write")
        if self.path.exists() and not replace:
            raise FileExistsError(f"{self.path} exists; a recording does not replace another one")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            self._disk = GrowingFile(self.path.with_name(self.path.name + ACTIVE), keep_free)
        except FileExistsError:
            raise FileExistsError(
                f"{self.active_path_of(self.path)} exists: another run is writing it, or a killed run left it; "
                "bearing-sim recover completes it, or rename or remove it first"
            ) from None
        self._writer = RowWriter(self._disk, _CHUNK_SIZE)
        self._writer.start(profile="ros2", library="bearing_sim")
        for name, record in (metadata or {}).items():
            self._writer.add_metadata(name, dict(record))
        self._custom_data = dict(custom_data or {})
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, _Channel] = {}
        self._span: tuple[int, int] | None = None
        self._lock = threading.RLock()
        self._closing = threading.Event()
        self._closed = False
        self._flush_every = flush_every
        self._writer.flush()
        self._disk.drain()
        self._disk.watch()
        if self._disk.fault is not None:
            self._disk.close()
            self.active_path.unlink(missing_ok=True)
            raise self._fault()
        # A timer, not a check at each write: the last messages before a pause are to be safe too.
        self._wake = threading.Event()
        self._flusher = threading.Thread(target=self._serve_disk, name="mcap-disk", daemon=True)
        self._flusher.start()

    @staticmethod
    def active_path_of(path: Path) -> Path:
        """Return what a file is called while it is written."""
        return path.with_name(path.name + ACTIVE)

    @property
    def active_path(self) -> Path:
        """What the file is called while it is written."""
        return self._disk.path

    @property
    def length(self) -> int:
        """Length up to now [byte], without the chunk in progress."""
        return self._disk.tell()

    @property
    def span(self) -> tuple[int, int]:
        """First and last log time [ns since the epoch]; zeros before the first message."""
        return self._span or (0, 0)

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
            The file could not be written, by the thread that serves the disk, since the last call.
        ValueError
            The file is closed, or the time lies before the epoch.
        """
        self.write_cdr(topic, ros_type, time_ns, message_type(ros_type).serialize(message))

    def write_cdr(self, topic: str, ros_type: str, time_ns: int, data: bytes, publish_ns: int | None = None) -> None:
        """Write one message that is serialised already; ``publish_ns`` where its publish time differs from its log time."""
        if time_ns < 0:
            raise ValueError(f"{topic}: a message {-time_ns * 1e-9:.6g} s before 1970 cannot be recorded")
        with self._lock:
            self._require_open()
            channel = self._channels.get(topic) or self._register(topic, ros_type)
            channel.count += 1
            self._extend_span(time_ns, time_ns)
            self._writer.add_message(channel.id, time_ns, data, time_ns if publish_ns is None else publish_ns, sequence=channel.count)
        self._hurry()

    def write_rows(self, layout: RowLayout, block: np.ndarray, times_ns: np.ndarray) -> None:
        """Write the messages of all topics of a lay-out for a block of samples; faults as of `write`.

        Parameters
        ----------
        layout : of the topics; they are written in no other way.
        block : samples, shape (n,).
        times_ns : log, publish and header time of each [ns since the epoch], uint64.
        """
        if not len(block):
            return
        with self._lock:
            self._require_open()
            channels = [self._channels.get(f"/{topic.name}") or self._register(f"/{topic.name}", topic.ros_type) for topic in layout.topics]
            ids = [channel.id for channel in channels]
            rows = layout.rows(block, times_ns, ids, channels[0].count + 1)
            self._writer.add_rows(layout, rows, times_ns, ids)
            for channel in channels:
                channel.count += len(block)
            self._extend_span(int(times_ns.min()), int(times_ns.max()))
        self._hurry()

    def __enter__(self) -> "McapFile":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        with self._lock:
            self._require_open()
            self._writer.flush()
            self._disk.drain()
            self._raise_fault()

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, code, text) of what a person should be told of the file since the last call."""
        return [self._disk.news.popleft() for _ in range(len(self._disk.news))]

    def close(self) -> None:
        """Complete the file and give it its name; a second call does nothing.

        Raises
        ------
        OSError
            It could not be completed; what could be written is in ``<path>.active``.
        """
        self._closing.set()
        self._wake.set()
        self._flusher.join()
        with self._lock:
            if self._closed:
                return
            self._closed = True
            written = self._disk.tell() == self._disk.saved + self._disk.backlog  # nothing was given up
            try:
                self._writer.add_metadata("rosbag2", {"serialized_metadata": part_metadata(self.part(), self.topic_counts(), self._custom_data)})
                self._writer.finish()
                self._disk.drain(despite_fault=True)
                complete = written and not self._disk.backlog
            finally:
                self._disk.close()
            if not complete:
                raise self._fault() or OSError(f"{self.active_path} could not be completed")
            _rename(self.active_path, self.path, self._replace)

    def part(self) -> Part:
        """Return what metadata say of this file."""
        start, end = self.span
        return Part(self.path.name, start, end, sum(channel.count for channel in self._channels.values()))

    def topic_counts(self) -> list[TopicCount]:
        """Return what metadata say of its topics."""
        return [TopicCount(topic, channel.ros_type, message_type(channel.ros_type).hash, channel.count) for topic, channel in self._channels.items()]

    def _register(self, topic: str, ros_type: str) -> "_Channel":
        kind = message_type(ros_type)
        if ros_type not in self._schemas:
            self._schemas[ros_type] = self._writer.register_schema(ros_type, "ros2msg", kind.definition.encode())
        metadata = {"offered_qos_profiles": QOS_TEXT, "topic_type_hash": kind.hash}
        channel_id = self._writer.register_channel(topic, "cdr", self._schemas[ros_type], metadata)
        self._channels[topic] = _Channel(channel_id, ros_type)
        return self._channels[topic]

    def _extend_span(self, first: int, last: int) -> None:
        self._span = (first, last) if self._span is None else (min(self._span[0], first), max(self._span[1], last))

    def _hurry(self) -> None:
        if self._disk.backlog > _HASTE:
            self._wake.set()

    def _serve_disk(self) -> None:
        while not self._closing.is_set():
            hurried = self._wake.wait(self._flush_every)
            self._wake.clear()
            if not hurried:
                with self._lock:
                    self._writer.flush()
            self._disk.drain()
            self._disk.watch()

    def _require_open(self) -> None:
        if self._closed:
            raise ValueError(f"{self.path} is closed")
        self._raise_fault()

    def _raise_fault(self) -> None:
        if self._disk.fault is not None:
            raise self._fault()

    def _fault(self) -> OSError | None:
        fault = self._disk.fault
        return OSError(fault.errno, fault.strerror) if fault is not None else None


def _rename(active: Path, path: Path, replace: bool) -> None:
    """Give a complete file its name, which may have been taken meanwhile."""
    try:
        if replace:
            os.replace(active, path)
            return
        try:
            os.link(active, path)  # unlike a renaming, this replaces nothing
        except FileExistsError:
            raise FileExistsError(f"{path} was made by another program meanwhile; the complete recording is {active}") from None
        except OSError:
            os.rename(active, path)  # a file system without links
        else:
            os.unlink(active)
    except PermissionError as fault:
        raise PermissionError(fault.errno, f"{active} is complete, but cannot be renamed to {path.name}: {fault.strerror}") from None


class _Channel:
    """One channel of the file and how many messages it has."""

    def __init__(self, channel_id: int, ros_type: str):
        self.id = channel_id
        self.ros_type = ros_type
        self.count = 0
