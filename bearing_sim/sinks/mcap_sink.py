# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The MCAP sink: inputs, samples and events of a run as ROS 2 messages in a recording that says where it comes from."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.provenance import git_hash, package_version, versions
from bearing_sim.scene import Scene
from bearing_sim.scene_file import scene_to_yaml
from bearing_sim.sinks.limits import UNPARTED, Limits
from bearing_sim.sinks.mcap_rows import RowLayout
from bearing_sim.sinks.parts import Parts

METADATA = "bearing_sim"
"""Name of the metadata record: scene (YAML), level, start_ns, package_version, git_hash, part, and versions of packages by name."""


class McapSink:
    """Records a run: inputs as they came, every observable of every sample, events and diagnostics.

    See `bearing_sim.sinks.mcap_file.McapFile` for a file's life and its faults.

    Parameters
    ----------
    path : the finished file, or the folder of a bag (see `bearing_sim.sinks.parts.Parts`).
    scene : what is simulated; its YAML goes into every file.
    start_ns : time 0 of the samples [ns since the epoch].
    metadata : further metadata records by name.
    flush_every : longest time that data stay in this process [s].
    replace : whether a finished file of that name is replaced.
    limits : where a file ends and the next one begins, and the free space that the disk shall keep.
    seed : of the random numbers in the run, if there are any; goes into the metadata.
    advance : duration [s] and number of samples of each of the run's calls of the model, where they are always the same; goes into the metadata,
        so that the run can be repeated by the very same calls.
    """

    def __init__(
        self,
        path: str | Path,
        scene: Scene,
        start_ns: int,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        flush_every: float = 0.5,
        replace: bool = False,
        limits: Limits = UNPARTED,
        seed: int | None = None,
        advance: tuple[float, int] | None = None,
    ):
        self.start_ns = int(start_ns)
        self._bearing = scene.bearing.name
        self._topics, self._layout = tuple(topics.recorded(scene).values()), None
        self._lay_out(scene.bearing.roller.count)
        origin = {"package_version": package_version(), "git_hash": git_hash()}
        packages = {f"version_{name}": version for name, version in versions().items()}
        record = {"scene": scene_to_yaml(scene), "level": scene.level, "start_ns": str(self.start_ns), **origin, **packages}
        if seed is not None:
            record["seed"] = str(seed)
        if advance is not None:
            record |= {"advance_seconds": repr(float(advance[0])), "advance_samples": str(advance[1])}
        self._parts = Parts(path, {METADATA: record, **(metadata or {})}, {"generator": "bearing_sim", **origin}, flush_every, replace, limits)

    @property
    def path(self) -> Path:
        """Return the finished file's path, or the bag's."""
        return self._parts.path

    @property
    def current_path(self) -> Path:
        """Return the path of the file that is being written, as it is called once it is finished."""
        return self._parts.current.path

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = tuple(topics.INPUTS), origin: topics.Origin | None = None) -> None:
        """Write the inputs that arrived at ``time`` [s].

        Parameters
        ----------
        time : when they were received [s since the start].
        inputs : the `bearing_sim.simulation.Inputs` of that instant.
        channels : which of them arrived; each channel may have stamps of its own.
        origin : the sender's stamp and frame; stamped with ``time`` where absent.
        """
        for channel in channels:
            self._write_received(topics.INPUTS[channel], time, inputs, origin)

    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: topics.Origin | None = None) -> None:
        """Write a measured cage speed [rad/s] that came at ``time`` [s], and by how much its slip is more than the predicted one."""
        for topic, number in zip(topics.MEASUREMENTS.values(), (cage_speed, residual)):
            self._write_received(topic, time, number, origin)

    def _write_received(self, topic: topics.Topic, time: float, source, origin: topics.Origin | None) -> None:
        received_ns = self._time_ns(time)
        sent_ns = received_ns if origin is None or origin.stamp_ns is None else origin.stamp_ns
        message = topic.message(sent_ns, source)
        if origin is not None and "header" in message:
            message["header"]["frame_id"] = origin.frame_id
        self._parts.write(f"/{topic.name}", topic.ros_type, received_ns, message)

    def write_received(self, topic: str, ros_type: str, time_ns: int, data: bytes, publish_ns: int | None = None) -> None:
        """Write a serialised message of another recording as it is; times are [ns since the epoch]."""
        self._parts.write_cdr(topic, ros_type, time_ns, data, publish_ns)

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples (see `bearing_sim.sample`)."""
        self._lay_out(block["roller_angle"].shape[1])
        self._parts.write_rows(self._layout, block, np.uint64(self.start_ns) + np.rint(block["time"] * 1e9).astype(np.int64).astype(np.uint64))

    def write_start(self, block: np.ndarray) -> None:
        """Write the state from which the run starts, a block of one sample, so that the run can be repeated; it is no output of the run."""
        self.write(block)

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self.write_diagnostics(event.time, [event])

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message (see `bearing_sim.topics.diagnostics`)."""
        name, ros_type = topics.DIAGNOSTICS
        time_ns = self._time_ns(time)
        self._parts.write(f"/{name}", ros_type, time_ns, topics.diagnostics(time_ns, events, values, hardware_id=self._bearing))

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, code, text) of what happened to the files since the last call: deleted and written anew, not completed."""
        return self._parts.news()

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._parts.flush()

    def close(self) -> None:
        """Complete the recording and give it its name; a second call does nothing."""
        self._parts.close()

    def __enter__(self) -> "McapSink":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _lay_out(self, rollers: int) -> None:
        if self._layout is None or self._layout.rollers != rollers:
            self._layout = RowLayout(self._topics, rollers)

    def _time_ns(self, time: float) -> int:
        return self.start_ns + round(time * 1e9)
