# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Open the node's recordings; what a view needs is imported only when one is wanted."""

import importlib
import math
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_sim.runtime.cadence import Cadence
from bearing_sim.scene import Scene
from bearing_sim.sinks.lasting_recording import LastingRecording
from bearing_sim.sinks.limits import Limits

if TYPE_CHECKING:
    from bearing_sim.ros.parameters import NodeSettings
    from bearing_sim.sinks.recorder import Recorder


def prepare(view: bool, recorder: "Recorder | None") -> None:
    """Start or load what recordings need, which takes half a second that the running node shall not pay at its first message.

    Parameters
    ----------
    view : whether a view is wanted.
    recorder : the process that will record; None where this process does it.
    """
    if view:
        importlib.import_module("bearing_sim.sinks.rerun_sink")
    if recorder is not None:
        recorder.start()
        return
    from bearing_sim.sinks.ros_types import load_message_types

    importlib.import_module("bearing_sim.sinks.mcap_sink")
    load_message_types()


def open_recording(path: Path, scene: Scene, start_ns: int, limits: Limits, cadence: Cadence, recorder: "Recorder"):
    """Return a recording in real time; its ``path`` is a fresh one where ``path`` is taken.

    Where the process that records is killed, it goes on in another fresh one (see `bearing_sim.sinks.lasting_recording`).

    Parameters
    ----------
    path : what is asked for, a file or the folder of a bag.
    scene, start_ns : what is simulated, and time 0 of the samples [ns since the epoch].
    limits : where files end.
    cadence : of the live model.
    recorder : the process that records.

    Raises
    ------
    OSError
        The file cannot be made.
    """
    advance = (cadence.tick, cadence.samples) if cadence.every == 1 else None
    return LastingRecording(lambda wait: recorder.open(fresh_path(path), scene, start_ns, limits, advance, wait=wait))


def open_lossless_recording(path: Path, scene: Scene, start_ns: int, limits: Limits):
    """Return a recording that the model may have to wait for, as a run by sim time does; written in this process.  Else as `open_recording`."""
    from bearing_sim.sinks.mcap_sink import McapSink

    return McapSink(fresh_path(path), scene, start_ns, limits=limits)


def limits_of(settings: "NodeSettings") -> Limits:
    """Return the limits of recordings that the node's parameters set; 0 stands for none."""
    size, duration = settings.record_part_size or math.inf, settings.record_part_duration or math.inf
    return Limits(1e6 * size, duration, 1e6 * settings.record_keep_free)


def fresh_path(path: Path) -> Path:
    """Return ``path``, or the first of ``path_2``, ``path_3`` ... that no recording has, finished or not, whole or in parts."""
    number, candidate = 1, path
    while any(_is_taken(candidate.with_stem(f"{candidate.stem}{part}")) for part in ("", "_0")):
        number += 1
        candidate = path.with_stem(f"{path.stem}_{number}")
    return candidate


def _is_taken(path: Path) -> bool:
    return path.exists() or path.with_name(path.name + ".active").exists()


def open_view(scene: Scene, start_ns: int, path: str, port: int):
    """Return a rerun sink (see `bearing_sim.sinks.rerun_sink.RerunSink`) that writes a file, serves viewers, or both.

    Raises
    ------
    OSError
        The file cannot be made or the port cannot be served.
    """
    from bearing_sim.sinks.rerun_sink import RerunSink

    if path:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    return RerunSink(scene, path=path or None, serve_port=port or None, start_ns=start_ns)
