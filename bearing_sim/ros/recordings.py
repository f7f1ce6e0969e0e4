# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Open the node's recordings and views; the view is imported only when it is used."""

import importlib
import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_sim.messages.cdr import load_message_types
from bearing_sim.messages.topics import FRAME, OWN_NAMES, Names
from bearing_sim.recording.bag import Limits
from bearing_sim.recording.recorder import Recorder
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.pacing import TickSchedule
from bearing_sim.scene.scene import Scene

if TYPE_CHECKING:
    from bearing_sim.ros.parameters import NodeSettings


def prepare(view: bool) -> None:
    """Import what recordings, and a ``view``, need: half a second that would otherwise delay the first message."""
    if view:
        with suppress(ModuleNotFoundError):  # reported when the view is opened
            importlib.import_module("bearing_sim.view.sink")
    load_message_types()


def open_recording(
    path: Path,
    scene: Scene,
    start_ns: int,
    limits: Limits,
    schedule: TickSchedule | None,
    recorder: Recorder,
    frame: str = FRAME,
    records: Callable[[], Mapping[str, Mapping[str, str]]] = dict,
    names: Names = OWN_NAMES,
):
    """Return a recording under a fresh name if ``path`` exists.

    Parameters
    ----------
    path : requested path, a file or a bag's folder.
    scene, start_ns : what is simulated, and time 0 of the samples [ns since the epoch].
    limits : of the size and duration of files.
    schedule : of the live model; None for a run by sim time, which waits for its recording so that nothing is dropped.
    recorder : what records in real time.
    frame : the bearing's.
    records : returns further metadata records of a recording that begins now, by name.
    names : under which topics and statuses are recorded.

    Raises
    ------
    OSError
        The file cannot be created.
    """
    advance = (schedule.tick, schedule.samples) if schedule is not None and schedule.every == 1 else None
    begin = McapSink if schedule is None else recorder.open
    return begin(fresh_path(path), scene, start_ns, metadata=records(), limits=limits, advance=advance, frame=frame, names=names)


def limits_of(settings: "NodeSettings") -> Limits:
    """Return the limits of recordings set by the node's parameters, where 0 means none."""
    size, duration = settings.record_part_size or math.inf, settings.record_part_duration or math.inf
    return Limits(1e6 * size, duration, 1e6 * settings.record_keep_free)


def fresh_path(path: Path) -> Path:
    """Return ``path``, or the first of ``path_2``, ``path_3`` ... not used by any file, finished or not, whole or in parts."""
    number, candidate = 1, path
    while any(_is_taken(candidate.with_stem(f"{candidate.stem}{part}")) for part in ("", "_0")):
        number += 1
        candidate = path.with_stem(f"{path.stem}_{number}")
    return candidate


def _is_taken(path: Path) -> bool:
    return path.exists() or path.with_name(path.name + ".active").exists()


def open_view(scene: Scene, start_ns: int, path: str, port: int, web_port: int = 0):
    """Return a rerun sink (see `bearing_sim.view.sink.RerunSink`) that writes a file, serves viewers or browsers, or all of these.

    The file has a fresh name, as recordings have.

    Raises
    ------
    OSError
        The file cannot be created, or the port cannot be used.
    ModuleNotFoundError
        rerun is not installed.
    """
    from bearing_sim.view.sink import RerunSink

    if path:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    return RerunSink(scene, path=fresh_path(Path(path)) if path else None, serve_port=port or None, start_ns=start_ns, web_port=web_port or None)
