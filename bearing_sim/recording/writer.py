# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings as ROS 2 messages in MCAP, which rosbag2, Foxglove and rerun read, and of which a killed process loses little.

`McapFile` is one file, `SplitFiles` one or several files of one recording, and `McapSink` records a run in them.
"""

import math
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bearing_sim.files.outputs import rename_without_replacing, synchronise
from bearing_sim.files.provenance import git_hash, package_version, versions
from bearing_sim.messages import diagnostics, topics
from bearing_sim.messages.bands import Bands
from bearing_sim.messages.cdr import message_type
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, Received, ReceivedInputs, Record, Report, Start
from bearing_sim.messages.sample_messages import FilledMessages
from bearing_sim.recording.append_file import AppendFile, set_aside
from bearing_sim.recording.bag import ACTIVE, QOS_TEXT, UNLIMITED, Limits, Part, TopicCount, bag_metadata, write_bag_metadata
from bearing_sim.recording.mcap_format import OWN_TOPIC, Message
from bearing_sim.recording.mcap_writer import CHUNK_SIZE, McapWriter, SampleRows, widened
from bearing_sim.scene.loader import scene_to_yaml
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene

METADATA = "bearing_sim"
"""Name of the metadata record: scene (YAML), level, start_ns, package_version, git_hash, part, versions of packages by name, and the load
ratings C, C_0 and C_u [N] that the lives are computed with."""
COMMAND = "bearing_sim_command"
"""Name of the metadata record of a run from the command line: command, as it was written."""


class _Channel(NamedTuple):
    """A topic of a file; its message count is kept beside it, by topic."""

    id: int
    ros_type: str


class McapFile(AbstractContextManager):
    """An MCAP file being written, profile ``ros2``.

    While it is written it is called ``<path>.active``; `close` completes it and removes the suffix.  A chunk goes to the operating system as
    soon as it is full, and the chunk in progress every ``flush_every`` seconds.  A killed process therefore loses what was written after the
    last flush and no more.  There is no fsync, so a power cut may lose more; only a file that replaces another one is on the
    disk before that.  Methods may be called from several threads.

    Parameters
    ----------
    path : the finished file; its folder is made if absent.
    metadata : metadata records by name, each a flat mapping of str to str.
    custom_data : entries of rosbag2's own metadata record, shown by ``ros2 bag info``.
    flush_every : time between flushes [s].
    replace : whether a finished file of the same name is replaced at `close`.
    keep_free : free space to leave on the disk [byte]; below it writing stops with an OSError.
    names : full names of topics by their own, under which they are written where they differ.

    Attributes
    ----------
    is_complete : whether `close` has completed it.

    Raises
    ------
    OSError
        The file cannot be written there; FileExistsError if it exists and must not be replaced, or if another run is writing ``<path>.active``.
        What a killed run has left there is set aside under another name.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        custom_data: Mapping[str, str] | None = None,
        flush_every: float = 0.5,
        replace: bool = False,
        keep_free: float = 0.0,
        names: Mapping[str, str] = MappingProxyType({}),
    ):
        self.path, self._replace, self._names = Path(path), replace, names
        if self.path.is_dir():
            raise IsADirectoryError(f"{self.path} is a folder; expected the name of a file to write")
        if self.path.exists() and not replace:
            raise FileExistsError(f"{self.path} exists; a recording does not replace another one")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        active = self.path.with_name(self.path.name + ACTIVE)
        left = set_aside(active) if active.is_file() else None
        try:
            self._file = AppendFile(active, keep_free)
        except FileExistsError:
            raise FileExistsError(f"{active} exists, and another run is writing it; wait for its end, or name another file") from None
        if left is not None:
            text = f"{active} was left by a killed run and is now {left}; bearing-sim recover completes it"
            self._file.news.append((Level.WARN, "recording.set_aside", text))
        self._writer = McapWriter(self._file)
        for name, record in (metadata or {}).items():
            self._writer.add_metadata(name, record)
        self._custom_data = dict(custom_data or {})
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, _Channel] = {}
        self._counts: dict[str, int] = {}
        self._span: tuple[int, int] | None = None
        self._lock = threading.RLock()
        self._closing = threading.Event()
        self._closed = self.is_complete = False
        self._file.check()
        if self._file.error is not None:
            self._file.close()
            self.active_path.unlink(missing_ok=True)
            raise self._error()
        # A timer, not a check at each write, so that the last messages before a pause are flushed too.
        self._flusher = threading.Thread(target=self._flush_regularly, args=(flush_every,), name="mcap-flush", daemon=True)
        self._flusher.start()

    @property
    def active_path(self) -> Path:
        """Name of the file while it is written."""
        return self._file.path

    @property
    def length(self) -> int:
        """Length so far [byte], without the chunk in progress."""
        return self._file.tell()

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
        message : nested dict (see `bearing_sim.messages.topics`).

        Raises
        ------
        OSError
            The file cannot be written any more.
        ValueError
            The file is closed, or the time is before 1970.
        """
        self.write_cdr(topic, ros_type, time_ns, message_type(ros_type).serialize(message))

    def write_cdr(self, topic: str, ros_type: str, time_ns: int, data: bytes, publish_ns: int | None = None) -> None:
        """Write one serialised message; ``publish_ns`` if its publish time is not its log time.  Raises as `write`."""
        if time_ns < 0:
            raise ValueError(f"{topic}: a message {-time_ns * 1e-9:.6g} s before 1970 cannot be recorded")
        with self._lock:
            self._require_open()
            channel = self._channels.get(topic) or self._register(topic, ros_type)
            self._counts[topic] += 1
            self._span = widened(self._span, time_ns, time_ns)
            self._writer.add_message(Message(channel.id, self._counts[topic], time_ns, time_ns if publish_ns is None else publish_ns, data))

    def write_rows(
        self, layout: SampleRows, block: np.ndarray, times_ns: np.ndarray, further: SampleRows | None = None, chosen: Sequence[int] = ()
    ) -> None:
        """Write the messages of all topics of a layout for a block of samples.  Raises as `write`.

        Parameters
        ----------
        layout : of the topics, which are written in no other way.
        block : samples, shape (n,).
        times_ns : log, publish and header time of each [ns since the epoch], uint64.
        further : of further topics, which only some of the samples have; their messages come before the others of the sample.
        chosen : the indices of these samples, in order.
        """
        if not len(block):
            return
        with self._lock:
            self._require_open()
            rows, ids = self._filled(layout, block, times_ns)
            seldom, seldom_ids = self._filled(further, block[chosen], times_ns[chosen]) if len(chosen) else ((), ())
            start = 0
            for k, place in enumerate(chosen):
                self._writer.add_rows(layout, rows[start:place], times_ns[start:place], ids)
                self._writer.add_rows(further, seldom[k : k + 1], times_ns[place : place + 1], seldom_ids)
                start = place
            self._writer.add_rows(layout, rows[start:], times_ns[start:], ids)
            self._span = widened(self._span, int(times_ns.min()), int(times_ns.max()))

    def _filled(self, layout: SampleRows, block: np.ndarray, times_ns: np.ndarray) -> tuple[np.ndarray, list[int]]:
        """Return the records of a block and the ids of their channels, and count them."""
        names = [f"/{topic.name}" for topic in layout.topics]
        ids = [(self._channels.get(name) or self._register(name, topic.ros_type)).id for name, topic in zip(names, layout.topics)]
        sequences = [self._counts[name] + 1 + np.arange(len(block)) for name in names]
        for name in names:
            self._counts[name] += len(block)
        return layout.filled(block, times_ns, ids, sequences), ids

    def __exit__(self, kind, *_) -> None:
        """Complete the file, or remove it if an exception ends the block or it cannot be completed."""
        try:
            self.close(named=kind is None)
        except FileExistsError:
            raise
        except OSError:
            self._file.close()
            self.active_path.unlink(missing_ok=True)
            raise
        if kind is not None:
            self.active_path.unlink(missing_ok=True)

    def flush(self) -> None:
        """Hand everything written so far to the operating system.  Raises as `write`."""
        with self._lock:
            self._require_open()
            self._writer.flush()
            self._require_open()

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the file since the last call."""
        return [self._file.news.pop(0) for _ in range(len(self._file.news))]

    def close(self, named: bool = True) -> None:
        """Complete the file and give it its name; a second call does nothing.

        Parameters
        ----------
        named : whether it gets its name; otherwise it stays ``<path>.active``.

        Raises
        ------
        OSError
            It could not be completed; what could be written is in ``<path>.active``, and another call tries again to write the rest.
        """
        self._closing.set()
        self._flusher.join()
        with self._lock:
            if self.is_complete:
                return
            if not self._closed:
                self._closed = True
                metadata = bag_metadata([self.part()], [self.topic_counts()], self._custom_data)
                self._writer.add_metadata("rosbag2", {"serialized_metadata": metadata})
                self._writer.finish()
            if not self._file.complete():
                raise self._error()
            self.is_complete = True
            self._file.close()
            if named:
                _rename(self.active_path, self.path, self._replace)

    def part(self) -> Part:
        """Return the entry of this file in the metadata of its bag."""
        return Part(self.path.name, *self.span, sum(self._counts.values()))

    def topic_counts(self) -> list[TopicCount]:
        """Return the entries of its topics in the metadata of its bag."""
        return [
            TopicCount(self._full_name(topic), channel.ros_type, message_type(channel.ros_type).hash, self._counts[topic])
            for topic, channel in self._channels.items()
        ]

    def _register(self, topic: str, ros_type: str) -> _Channel:
        kind = message_type(ros_type)
        if ros_type not in self._schemas:
            self._schemas[ros_type] = self._writer.add_schema(ros_type, "ros2msg", kind.definition.encode())
        metadata = {"offered_qos_profiles": QOS_TEXT, "topic_type_hash": kind.hash}
        if (name := self._full_name(topic)) != topic:
            metadata[OWN_TOPIC] = topic.removeprefix("/")
        self._channels[topic] = _Channel(self._writer.add_channel(name, "cdr", self._schemas[ros_type], metadata), ros_type)
        self._counts[topic] = 0
        return self._channels[topic]

    def _full_name(self, topic: str) -> str:
        return self._names.get(topic.removeprefix("/"), topic)

    def _flush_regularly(self, interval: float) -> None:
        while not self._closing.wait(interval):
            with self._lock:
                self._writer.flush()
                self._file.check()

    def _require_open(self) -> None:
        if self._closed:
            raise ValueError(f"{self.path} is closed")
        if self._file.error is not None:
            raise self._error()

    def _error(self) -> OSError:
        return OSError(self._file.error.errno, self._file.error.strerror)


def _rename(active: Path, path: Path, replace: bool) -> None:
    """Give a complete file its name, unless another program has taken it meanwhile."""
    try:
        if replace:
            if path.exists():
                synchronise(active)  # so that a power cut leaves one of the two whole
            os.replace(active, path)
        else:
            rename_without_replacing(active, path)
    except FileExistsError:
        raise FileExistsError(f"{path} was made by another program meanwhile; the complete recording is {active}") from None
    except PermissionError as error:
        raise PermissionError(error.errno, f"{active} is complete, but cannot be renamed to {path.name}: {error.strerror}") from None


class SplitFiles:
    """The files of one recording, one after the other; each can be read alone.

    Parameters
    ----------
    path : ``run.mcap`` is one file, or ``run_0.mcap``, ``run_1.mcap`` ... if ``limits`` split it.  A name without ``.mcap`` is a bag: a
        folder of such files with a ``metadata.yaml``, as rosbag2 makes it.
    metadata, custom_data, flush_every, replace, names : see `McapFile`; a bag is never replaced.
    limits : when the next file begins.

    Raises
    ------
    OSError
        The first file cannot be made; FileExistsError if it exists.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: Mapping[str, Mapping[str, str]],
        custom_data: Mapping[str, str],
        flush_every: float = 0.5,
        replace: bool = False,
        limits: Limits = UNLIMITED,
        names: Mapping[str, str] = MappingProxyType({}),
    ):
        self.path, self._limits, self._names = Path(path), limits, names
        self._is_bag = self.path.suffix != ".mcap"
        self._is_split = math.isfinite(limits.part_size) or math.isfinite(limits.part_duration)
        if self._is_bag and self.path.exists():
            what = "is a folder" if self.path.is_dir() else "exists"
            raise FileExistsError(f"{self.path} {what}; a recording does not replace another one (a name that ends in .mcap makes a single file)")
        self._metadata, self._custom_data, self._flush_every, self._replace = metadata, custom_data, flush_every, replace
        self._done: list[McapFile] = []  # the files before the current one
        self._news: list[tuple[Level, str, str]] = []
        self._completing: threading.Thread | None = None
        try:
            self._current = self._open(0)
        except OSError:
            if self._is_bag:
                with suppress(OSError):  # it was not made, or somebody has put something into it
                    self.path.rmdir()
            raise

    @property
    def current(self) -> McapFile:
        """The file to write to, a new one if the last one has reached its limits."""
        start, end = self._current.span
        if self._current.length >= self._limits.part_size or end - start >= 1e9 * self._limits.part_duration:
            self._begin_next()
        return self._current

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._current.flush()

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the files since the last call."""
        news, self._news = self._news, []
        return news + self._current.news()

    def close(self, interrupted: bool = False) -> None:
        """Complete the last file and the bag; a second call does nothing but what could not be done before.

        Parameters
        ----------
        interrupted : whether the recording ends before its time; then it does not replace an older one, but stays ``<path>.active``.

        Raises
        ------
        OSError
            A file could not be completed; the metadata of the bag name the others.
        """
        if self._completing is not None:
            self._completing.join()
        errors: list[OSError] = []
        for file in (*self._done, self._current):
            try:
                file.close(named=not (interrupted and file.path.exists()))
            except OSError as error:
                errors.append(error)
        if self._is_bag:
            try:
                self._write_metadata([*self._done, self._current])
            except OSError as error:
                errors.append(error)
        if errors:
            raise errors[0]

    def _path_of(self, number: int) -> Path:
        if self._is_bag:
            return self.path / f"{self.path.name}_{number}.mcap"
        return self.path.with_stem(f"{self.path.stem}_{number}") if self._is_split else self.path

    def _open(self, number: int) -> McapFile:
        metadata = {name: {**record, "part": str(number)} if name == METADATA else record for name, record in self._metadata.items()}
        limits = self._limits
        return McapFile(self._path_of(number), metadata, self._custom_data, self._flush_every, self._replace, limits.keep_free, self._names)

    def _begin_next(self) -> None:
        full = self._current
        if self._completing is not None:
            self._completing.join()
        self._current = self._open(len(self._done) + 1)
        self._done.append(full)
        # On a thread of its own, because completing waits for the disk.
        self._completing = threading.Thread(target=self._complete, args=(full,), name="mcap-complete", daemon=True)
        self._completing.start()

    def _complete(self, full: McapFile) -> None:
        try:
            full.close()
            if self._is_bag:
                self._write_metadata(self._done)
        except OSError as error:
            self._news.append((Level.ERROR, "recording.part", f"{full.path} could not be completed: {error}"))
        self._news += full.news()

    def _write_metadata(self, files: Sequence[McapFile]) -> None:
        """Write the metadata of the bag, which name those of its files that are complete."""
        if complete := [file for file in files if file.is_complete]:
            metadata = bag_metadata([file.part() for file in complete], [file.topic_counts() for file in complete], self._custom_data)
            write_bag_metadata(self.path, metadata)


class McapSink(AbstractContextManager):
    """Records a run: inputs as they arrived, every observable of every sample, events and diagnostics.  See `write`.

    Parameters
    ----------
    path : the finished file, or the folder of a bag (see `SplitFiles`).
    scene : what is simulated; every file contains its YAML.
    start_ns : time 0 of the samples [ns since the epoch].
    metadata : further metadata records by name.
    flush_every : time between flushes [s] (see `McapFile`).
    replace : whether a finished file of the same name is replaced.
    limits : when the next file begins, and the free space to leave on the disk.
    seed : of the random numbers in the run, if there are any; goes into the metadata.
    advance : duration [s] and number of samples of each of the run's calls of the model, if they are always the same; goes into the metadata,
        so that the run can be reproduced by the same calls.
    frame : the bearing's, in the headers of what is recorded of samples.
    names : under which topics and statuses are recorded.

    Raises
    ------
    OSError
        The file cannot be made.
    """

    keeps_all = True

    def __init__(
        self,
        path: str | Path,
        scene: Scene,
        start_ns: int,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        flush_every: float = 0.5,
        replace: bool = False,
        limits: Limits = UNLIMITED,
        seed: int | None = None,
        advance: tuple[float, int] | None = None,
        frame: str = topics.FRAME,
        names: topics.Names = topics.OWN_NAMES,
    ):
        self.start_ns, self._frame = int(start_ns), frame
        self._status_names = {"component": names.component, "hardware_id": names.hardware_id or scene.bearing.name}
        recorded = topics.recorded(scene).values()
        self._topics = [[topic for topic in recorded if topic.repeats == repeats] for repeats in (False, True)]
        self._lay_out(scene.bearing.roller.count)
        self._messages = FilledMessages()
        self._last_period = -1  # of `REPEATING_RATE`, in which a sample was written with its repeating topics
        origin = {"package_version": package_version(), "git_hash": git_hash()}
        packages = {f"version_{name}": version for name, version in versions().items()}
        record = {"scene": scene_to_yaml(scene), "level": scene.level, "start_ns": str(self.start_ns), **origin, **packages}
        rated = rate(scene.bearing)
        record |= {"dynamic_rating": repr(rated.dynamic), "static_rating": repr(rated.static), "fatigue_limit": repr(rated.fatigue_limit)}
        if seed is not None:
            record["seed"] = str(seed)
        if advance is not None:
            record |= {"advance_seconds": repr(float(advance[0])), "advance_samples": str(advance[1])}
        records, custom_data = {METADATA: record, **(metadata or {})}, {"generator": "bearing_sim", **origin}
        self._files = SplitFiles(path, records, custom_data, flush_every, replace, limits, names.topics)

    @property
    def path(self) -> Path:
        """The finished file's path, or the bag's."""
        return self._files.path

    def write(self, record: Record) -> None:
        """Write a record (see `bearing_sim.messages.events.Record`); raises as `McapFile.write`."""
        match record:
            case np.ndarray():
                self._write_samples(record)
            case Start(block):
                self._write_samples(block)
            case Event(time):
                self._write_diagnostics(diagnostics.event_report, time, record)
            case Report(time, events, values):
                self._write_diagnostics(diagnostics.report, time, events, values)
            case ReceivedInputs(time, inputs, channels, origin):
                for channel in channels:
                    self._write_input(topics.INPUTS[channel], time, inputs, origin)
            case Measurement(time, cage_speed, residual, standard_error, origin):
                self._write_input(topics.MEASUREMENTS[topics.MEASURED], time, (cage_speed, standard_error), origin)
                self._write_input(topics.MEASUREMENTS[topics.RESIDUAL], time, residual, origin)
            case MeasuredClearance(time, clearance, standard_error, origin):
                self._write_input(topics.MEASUREMENTS[topics.MEASURED_CLEARANCE], time, (clearance, standard_error), origin)
            case Bands():
                times_ns = [self._time_ns(time) for time in record.times.tolist()]
                for time_ns, message in zip(times_ns, self._messages.of_bands(record, times_ns, self._frame)):
                    self._write_message(topics.ESTIMATED[record.topic], time_ns, message)
            case Received(topic, ros_type, log_ns, publish_ns, data):
                self._files.current.write_cdr(topic, ros_type, log_ns, data, publish_ns)

    def _write_samples(self, block: np.ndarray) -> None:
        rollers = block["roller_angle"].shape[1]
        if rollers != self._rows[0].rollers:
            self._lay_out(rollers)
        # In parts of about a chunk: when the disk is full, no more is left to be written than the space that is reserved for the end of the file.
        per_part = max(1, CHUNK_SIZE // sum(rows.size for rows in self._rows))
        for part in (block[start : start + per_part] for start in range(0, len(block), per_part)):
            times_ns = np.uint64(self.start_ns) + np.rint(part["time"] * 1e9).astype(np.int64).astype(np.uint64)
            self._files.current.write_rows(self._rows[0], part, times_ns, self._rows[1], self._with_repeating(part["time"]))

    def _lay_out(self, rollers: int) -> None:
        self._rows = [SampleRows(topics, rollers, self._frame) for topics in self._topics]

    def _with_repeating(self, times: np.ndarray) -> np.ndarray:
        """Return the indices of the samples that are written with their repeating topics: the first one of each period of `REPEATING_RATE`."""
        periods = np.floor(times * topics.REPEATING_RATE + 1e-6).astype(np.int64)  # times are multiples of a period but for rounding
        found = np.flatnonzero(np.diff(periods, prepend=self._last_period))
        if len(periods):
            self._last_period = int(periods[-1])
        return found

    def _write_input(self, topic: topics.Topic, time: float, source, origin: topics.Origin | None) -> None:
        received_ns = self._time_ns(time)
        sent_ns = received_ns if origin is None or origin.stamp_ns is None else origin.stamp_ns
        self._write_message(topic, received_ns, self._messages.serialized(topic, sent_ns, source, None if origin is None else origin.frame_id))

    def _write_diagnostics(self, message: Callable[..., dict], time: float, *contents) -> None:
        (name, ros_type), time_ns = topics.DIAGNOSTICS, self._time_ns(time)
        self._files.current.write(f"/{name}", ros_type, time_ns, message(time_ns, *contents, **self._status_names))

    def _write_message(self, topic: topics.Topic, time_ns: int, message: bytes) -> None:
        self._files.current.write_cdr(f"/{topic.name}", topic.ros_type, time_ns, message)

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the files since the last call: deleted and restored, not completed."""
        return self._files.news()

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._files.flush()

    def close(self) -> None:
        """Complete the recording and give it its name; a second call does nothing."""
        self._files.close()

    def __exit__(self, kind, *_) -> None:
        self._files.close(interrupted=kind is not None)

    def _time_ns(self, time: float) -> int:
        return self.start_ns + round(time * 1e9)
