# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim replay --from-recording``: a recorded run, computed again from its recording alone."""

from contextlib import ExitStack
from pathlib import Path

from bearing_sim.commands.reporting import (
    BadInput,
    orderly_end,
    print_json,
    print_table,
    progress_bar,
    tell_compilation,
    tell_replacement,
    told_as_bad_input,
    told_file_faults,
)


def repeat_recording(path: Path, out: Path | None, as_json: bool) -> None:
    """Compute the run of a recording again, record it if asked to, and print what came of it.

    Parameters
    ----------
    path : a recording of ours, finished or not.
    out : the new recording, or None.
    as_json : whether to print JSON.
    """
    from bearing_sim.provenance import git_hash, package_version
    from bearing_sim.recording_reader import Recording, RecordingError
    from bearing_sim.repetition import repeat
    from bearing_sim.sinks.mcap_sink import McapSink

    with told_as_bad_input(RecordingError, ValueError), told_file_faults(), orderly_end(), ExitStack() as stack:
        recording = Recording(path)
        sink = _Nowhere()
        if out is not None:
            if out.exists() and path.exists() and out.samefile(path):
                raise BadInput(f"{out} is the recording itself; write to another file")
            tell_replacement(out)
            origin = {"bearing_sim_replay": {"log": path.name, "from_recording": "true"}}
            sink = stack.enter_context(McapSink(out, recording.scene, recording.start_ns, origin, replace=True))
        tell_compilation()
        progress = stack.enter_context(progress_bar(f"repeating {path.name}", recording.duration))
        result = repeat(recording, sink, progress)
    was = {name: recording.metadata.get(name, "") for name in ("package_version", "git_hash")}
    now = {"package_version": package_version(), "git_hash": git_hash()}
    if as_json:
        report = {"recording": str(path), "out": out and str(out), "scene": recording.scene.name, "level": recording.scene.level}
        print_json({**report, **vars(result), "recorded_with": was, "repeated_with": now, "recording_unfinished": recording.unfinished})
        return
    rows = [
        ("level", recording.scene.level),
        ("recorded with", _version(was)),
        ("repeated with", _version(now)),
        ("start", ", then ".join(result.starts)),
        ("samples", f"{result.samples}, {result.failed} of them could not be computed"),
        ("messages of inputs copied", str(result.received)),
        ("simulated", f"{result.sim_seconds:.6g} s in {result.wall_seconds:.3g} s; {result.skipped_seconds:.4g} s were not simulated then either"),
        ("changes of level", str(result.level_changes)),
        ("recording", f"{out}; bearing-sim compare {path} {out} says what differs" if out else "none"),
    ]
    if recording.unfinished:
        rows.insert(0, ("recording ends early", recording.unfinished))
    print_table(f"{path.name} repeated on {recording.scene.name}", rows)


def _version(origin: dict[str, str]) -> str:
    return ", ".join(filter(None, (origin["package_version"], origin["git_hash"]))) or "an unknown version"


class _Nowhere:
    """A recording that is none."""

    def write(self, block) -> None:
        """Drop samples."""

    def write_received(self, topic, ros_type, log_ns, data, publish_ns) -> None:
        """Drop a message."""

    def write_event(self, event) -> None:
        """Drop an event."""
