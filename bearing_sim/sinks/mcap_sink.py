# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The MCAP sink: inputs, samples and events of a run as ROS 2 messages in one file that says where it comes from."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event
from bearing_sim.provenance import git_hash, package_version
from bearing_sim.scene import Scene
from bearing_sim.scene_file import scene_to_yaml
from bearing_sim.sinks.mcap_file import McapFile

METADATA = "bearing_sim"
"""Name of the metadata record: scene (YAML), level, start_ns, package_version, git_hash."""


class McapSink:
    """Records a run (see `bearing_sim.sinks.mcap_file.McapFile` for the file's life and its faults).

    Parameters
    ----------
    path : the finished file.
    scene : what is simulated; its YAML goes into the file.
    start_ns : time 0 of the samples [ns since the epoch].
    metadata : further metadata records by name.
    flush_every : longest time that data stay in this process [s].
    """

    def __init__(
        self, path: str | Path, scene: Scene, start_ns: int, metadata: Mapping[str, Mapping[str, str]] | None = None, flush_every: float = 0.5
    ):
        self.start_ns = int(start_ns)
        self._bearing = scene.bearing.name
        self._outputs = tuple(topics.outputs(scene).values())
        origin = {"package_version": package_version(), "git_hash": git_hash()}
        record = {"scene": scene_to_yaml(scene), "level": scene.level, "start_ns": str(self.start_ns), **origin}
        self._file = McapFile(path, {METADATA: record, **(metadata or {})}, {"generator": "bearing_sim", **origin}, flush_every)

    @property
    def path(self) -> Path:
        """Return the finished file's path."""
        return self._file.path

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = tuple(topics.INPUTS)) -> None:
        """Write the inputs that arrived at ``time`` [s].

        Parameters
        ----------
        time : stamp of the messages [s since the start].
        inputs : the `bearing_sim.simulation.Inputs` of that instant.
        channels : which of them arrived; each channel may have stamps of its own.
        """
        for channel in channels:
            self._write(topics.INPUTS[channel], time, inputs)

    def write_measurement(self, time: float, cage_speed: float, residual: float) -> None:
        """Write a measured cage speed [rad/s] that came at ``time`` [s], and by how much its slip is more than the predicted one."""
        for topic, number in zip(topics.MEASUREMENTS.values(), (cage_speed, residual)):
            self._write(topic, time, number)

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples (see `bearing_sim.sample`)."""
        for sample in block:
            for topic in self._outputs:
                self._write(topic, float(sample["time"]), sample)

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self.write_diagnostics(event.time, [event])

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message (see `bearing_sim.topics.diagnostics`)."""
        name, ros_type = topics.DIAGNOSTICS
        time_ns = self._time_ns(time)
        self._file.write(f"/{name}", ros_type, time_ns, topics.diagnostics(time_ns, events, values, hardware_id=self._bearing))

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._file.flush()

    def close(self) -> None:
        """Complete the file and give it its name; a second call does nothing."""
        self._file.close()

    def __enter__(self) -> "McapSink":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _time_ns(self, time: float) -> int:
        return self.start_ns + round(time * 1e9)

    def _write(self, topic: topics.Topic, time: float, source) -> None:
        time_ns = self._time_ns(time)
        self._file.write(f"/{topic.name}", topic.ros_type, time_ns, topic.message(time_ns, source))
