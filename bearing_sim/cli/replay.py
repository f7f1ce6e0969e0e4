# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim replay``: run the model on a recorded log, or compute a recorded run again."""

import math
import time
from contextlib import ExitStack, suppress
from pathlib import Path

import click
from click import FloatRange

from bearing_sim.cli.estimation import band_numbers, band_rows, response_with_progress
from bearing_sim.cli.options import PATH, allow_outside_option, flag, json_option, log_options, option, set_option, verbose_option
from bearing_sim.cli.outputs import OutputFile, OutputRecording, recording_into
from bearing_sim.cli.reporting import (
    FailedRun,
    UsageError,
    announce_compilation,
    as_usage_error,
    attributes,
    command_line,
    judged,
    note,
    print_table,
    progress_bar,
    scene_of,
    suggest_level,
    tell_use,
    unknown_report,
    warn_of_limits,
    warn_of_scene,
    warnings_report,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.display import hours


@command("replay")
@click.argument("logs", type=PATH, nargs=-1, required=True, metavar="IN.mcap...")
@allow_outside_option
@option("--scene", "scene_name", "Bundled scene or YAML file.", metavar="SCENE")
@flag("--from-recording", "Compute a recorded run again from its recording alone: scene, start and inputs, sample by sample.")
@set_option
@option("-o", "--out", "Record inputs and outputs [default: no recording].", OutputRecording(), metavar="OUT.mcap")
@option("--rrd", "Also write a view for rerun.", OutputFile(), metavar="RUN.rrd")
@option("--rate", "Outputs per simulated second [default: one per stamp].", FloatRange(min=0, min_open=True), metavar="HZ")
@option(
    "--state-file",
    "Count the log for the bearing whose state is stored there, but no instant twice; without it no state is touched.",
    PATH,
    metavar="STATE.json",
)
@option("--serial", "Serial number of that bearing; a state of another one is refused.", default="", metavar="NUMBER")
@log_options
@verbose_option
@json_option
def replay(logs, scene_name, from_recording, overrides, out, rrd, rate, state_file, serial, reading, verbose):
    """Run the model on IN.mcap and write inputs and outputs to OUT.mcap.

    IN.mcap is any rosbag2 recording, MCAP or sqlite3: a file, finished or not, a bag's folder, or several that belong together. It holds
    shaft speed (JointState or Float64) and radial load (WrenchStamped, or Float64 along +y), or such numbers in messages of any other
    type whose definition is in the recording. ROS is not needed. What was not measured may be a constant, as with --load 800N. Speed
    and load are linear between their stamps; temperatures of oil and rings are held from one stamp to the next, as in a live run, which
    cannot know the next one. Bad messages are refused, reported and counted as in a live run, but silence and rate are judged by the
    log's own rate. If only a part of the messages was used, the result says what that means for life and damage, the last message what
    may help, and the exit code is 3.
    """
    if from_recording == bool(scene_name):
        raise UsageError("give either --scene, or --from-recording for a recording made by bearing-sim")
    if serial and state_file is None:
        raise UsageError("--serial names the bearing of a state: give --state-file as well")
    if from_recording:
        if len(logs) > 1 or overrides or rate or rrd or state_file or reading.is_given:
            raise UsageError("--from-recording takes exactly one recording and reproduces it as it was; it can be combined with -o and --json only")
        return _reproduction(logs[0], out)
    import numpy as np

    from bearing_sim.recording.writer import COMMAND, McapSink
    from bearing_sim.runtime.replay import replay
    from bearing_sim.simulation import IntegrationError, Simulation
    from bearing_sim.sweep.grading import graded
    from bearing_sim.watchers.stored_state.keeper import RECORD, StateKeeper
    from bearing_sim.watchers.stored_state.state_file import checked_serial

    for log in logs:
        _require_one_log(log, scene_name)
    scene = scene_of(scene_name, overrides)
    suggest_level(scene)
    warn_of_scene(scene)
    recorded = reading.read(*logs)
    course = judged(recorded, scene, reading.longest_gap)
    seconds = course.end * 1e-9
    with ExitStack() as stack:
        recording, names_of = None, [log.name for log in logs]
        keeper = None if state_file is None else StateKeeper(state_file, scene, checked_serial(serial), once=True)
        if keeper is not None:
            stack.callback(keeper.leave)
        if out is not None:
            out.check()  # again, now that scene and logs have been read
            metadata = {"bearing_sim_replay": {"log": " ".join(names_of)}, COMMAND: {"command": command_line()}}
            metadata |= {RECORD: keeper.record} if keeper is not None else {}
            recording = stack.enter_context(recording_into(out, McapSink(out.path, scene, course.start_ns, metadata, replace=out.force)))
        watchers = []
        if rrd is not None:
            from bearing_sim.view.worker import RerunFile

            watchers.append(stack.enter_context(RerunFile(scene, stack.enter_context(rrd.draft()), course.start_ns, seconds)))
        announce_compilation(scene)
        choice = _choice(scene, course)
        given = choice.pop("given", {}) | ({} if keeper is None else {"state": keeper})
        if scene.estimation.is_asked:
            given["estimation"] = response_with_progress(scene)
        started = time.perf_counter()
        with suppress(IntegrationError):  # the replay itself will report it
            warm = choice.get("model", Simulation)(scene)
            warm.advance(1e-6)  # compile or load machine code, so that it is not timed with the run
            if warm.takes_profiles:
                warm.advance_profile(np.array([1e-6]), np.array([warm.inputs]))
        start_up = time.perf_counter() - started
        progress = stack.enter_context(progress_bar(f"replaying {', '.join(names_of)}", seconds))
        result = replay(scene, course, recording, watchers, rate, progress, given=given, **choice)
    warnings = graded(scene, result.warnings, result.worst_samples, ("slip", "life"))
    for event in keeper.news(0.0) + keeper.events(0.0) if keeper is not None else []:
        note(f"{event.level.name.lower().replace('ok', 'note')}: {event.text}")
    jump = result.jump() if scene.level != "steady" else None  # which has no motion of its own: its slip follows the inputs
    if jump is not None:
        finer = float(f"{10.0 / jump.interval:.1g}")
        note(
            f"note: outputs are coarser than the motion: cage slip changes by {100 * jump.slip:.3g} points in the {jump.interval:.3g} s "
            f"before {jump.time:.6g} s, drawn as a straight line; use a finer rate, such as --rate {finer:g}"
        )
    report = {
        **_report(result, course, recorded, scene, out),
        "outputs_coarse_at": jump and jump._asdict(),
        **({} if keeper is None else {"state": keeper.summary()}),
        **warnings_report(scene, warnings),
        "start_up_seconds": start_up,
    }
    return Result(
        report,
        lambda: _print(result, course, recorded, scene, out, keeper),
        after=lambda: warn_of_limits(scene, warnings, verbose),
        ending=FailedRun(result.given_up) if result.given_up else None,
    )


def _require_one_log(log: Path, scene_name: str) -> None:
    """Raise `UsageError` if a path is a table, or a folder of many logs; the message names the command for it."""
    from bearing_sim.studies.fleet_logs import NoLogs, find_logs, is_text

    if log.is_file() and is_text(log):
        raise UsageError(f"{log} is a table; convert it with: bearing-sim import-csv {log} MAPPING -o {log.with_suffix('.mcap')}")
    if not log.is_dir() or (log / "metadata.yaml").is_file() or any(log.glob("*.mcap*")) or any(log.glob("*.db3")):
        return
    with suppress(NoLogs):
        count = len(find_logs([log]))
        raise UsageError(f"{log} is no bag but holds {count} logs; one bearing each: bearing-sim replay-fleet {log} --scene {scene_name}")


def _choice(scene, course) -> dict:
    """Return the model to replay with, at level steady with its table for the log's speeds and oil temperatures, and the laws of that table."""
    if scene.level != "steady":
        return {}
    from functools import partial

    import numpy as np

    from bearing_sim.cli.table import build_with_progress
    from bearing_sim.model.table_span import rounded_temperatures, spanning
    from bearing_sim.simulation import Simulation
    from bearing_sim.watchers.estimation.two_states import laws_of_table

    scene = spanning(scene, float(np.abs(course.values["shaft_speed"]).max()))  # else each faster operating point is solved by itself
    kelvin = np.append(course.values.get("oil_temperature", ()), [] if "oil_temperature" in course.stamps else scene.lubricant.temperature)
    ends = rounded_temperatures(float(kelvin.min()), float(kelvin.max()))
    table = build_with_progress(scene, ends)[0]
    return {"model": partial(Simulation, table=table), "given": {"validity": laws_of_table(scene, ends)}}


_KEPT = (
    "damage",
    "sim_seconds",
    "gap_seconds",
    "wall_seconds",
    "cpu_seconds",
    "real_time_factor",
    "steps",
    "rejected_steps",
    "non_finite_steps",
    "failed_ticks",
    "samples",
    "given_up",
)


def _report(result, course, recorded, scene, out) -> dict:
    from bearing_sim.inputs.log import anomalies
    from bearing_sim.model.plausibility import minimum_load

    slip, use = result.slip_statistics(), result.use(scene.thresholds)
    below, _ = result.seconds_below(lambda speeds: minimum_load(scene, speeds)[0])
    return {
        "scene": scene.name,
        "level": scene.level,
        "log": str(recorded.path),
        "out": out and str(out),
        "cage_slip": slip["mean"],
        "cage_slip_median": slip["median"],
        "cage_slip_p95": slip["p95"],
        "cage_slip_p99": slip["p99"],
        "cage_slip_maximum": slip["maximum"],
        "life_method": scene.life.method,
        "life_hours": use.life_hours,
        "least_rating_life_hours": result.least_rating_life,
        **band_numbers(result.band_statistics()),
        "turning_seconds": use.turning_seconds,
        "skid_seconds": use.skid_seconds,
        "skid_above_slip": scene.thresholds.slip_warning,
        "seconds_below_minimum_load": below,
        **unknown_report(course),
        "life_and_damage_are": "at most, at least" if course.verdict else "as given",
        "gaps": len(course.gaps),
        "inputs_anomalies": {channel: anomalies(series)._asdict() for channel, series in recorded.series.items()},
        "inputs_stamped_by": {channel: series.stamped_by for channel, series in recorded.series.items()},
        "events": dict(result.events),
        **attributes(result, *_KEPT),
    }


def _print(result, course, recorded, scene, out, keeper) -> None:
    from bearing_sim.inputs.log import summary_lines
    from bearing_sim.model.plausibility import minimum_load
    from bearing_sim.model.turning import stands_text

    use = result.use(scene.thresholds)
    slip = {name: f"{100 * value:.2f} %" for name, value in result.slip_statistics().items()}
    spread = f"mean {slip['mean']}, median {slip['median']}, 95 % below {slip['p95']}, 99 % below {slip['p99']}, largest {slip['maximum']}"
    rejected = f"{result.rejected_steps} rejected, {result.non_finite_steps} of them not finite"
    symbol = scene.life.symbols[0 if scene.life.is_basic else 1]
    rows = [("log", line) for line in summary_lines(recorded)]
    rows += [
        ("used", course.tally.counts),
        *(("not read", text) for text in course.tally.unread),
        *(("note", text) for text in course.tally.notes),
        ("level", scene.level),
        (
            "cage slip while turning",
            f"none: {stands_text(scene.thresholds.slip_from_speed)}" if math.isnan(result.slip_statistics()["mean"]) else spread,
        ),
        ("skid", use.skid_text(scene.thresholds)),
        (
            "life under these inputs",
            f"{'at most ' * bool(course.verdict)}{hours(use.life_hours)} by {symbol}; "
            f"least rating life at an instant {hours(result.least_rating_life)}",
        ),
        *band_rows(result.band_statistics(), scene),
        ("life used", f"{'at least ' * bool(course.verdict or course.dropped_seconds)}{100 * result.damage:.4g} %"),
        (
            "below the minimum load",
            _below(*result.seconds_below(lambda speeds: minimum_load(scene, speeds)[0]), minimum_load(scene)[1], scene.thresholds.slip_from_speed),
        ),
        ("inputs unknown", course.unknown_event.text if course.unknown_seconds else "0 s"),
        ("gaps", f"{len(course.gaps)}, {result.gap_seconds:.4g} s not simulated"),
        ("simulated", f"{result.sim_seconds:.6g} s of {result.log_seconds:.6g} s, {result.samples} outputs"),
        ("computed in", f"{result.wall_seconds:.3g} s ({result.cpu_seconds:.3g} s of processor time), {result.real_time_factor:.3g} times real time"),
        ("steps", f"{result.steps}, {rejected}; {result.failed_ticks} intervals skipped"),
        ("events", ", ".join(f"{count} x {code}" for code, count in sorted(result.events.items())) or "none"),
        ("recording", str(out or "none")),
    ]
    if keeper is not None:
        rows.append(
            ("stored state", f"{100.0 * keeper.used:.6g} % of life used, {keeper.state.totals.running_seconds / 3600.0:.6g} h: {keeper.path}")
        )
    print_table(f"replay of {recorded.path.name} on {scene.name}", rows)


def _below(below: float, turning: float, rule: str, slip_from_speed: float) -> str:
    """Return in words for how long [s] the load was below the makers' minimum while the shaft turned."""
    from bearing_sim.model.turning import span_text, stands_text

    if not turning:
        return stands_text(slip_from_speed)
    return f"{span_text(below)} of {span_text(turning)} that the shaft turns, {100 * below / turning:.3g} % ({rule})"


def _reproduction(path: Path, out) -> Result:
    """Compute a recorded run again, and record it if there is an output for it."""
    from bearing_sim.files.provenance import git_hash, package_version
    from bearing_sim.recording.reader import Recording
    from bearing_sim.recording.writer import McapSink
    from bearing_sim.runtime import reproduction
    from bearing_sim.watchers.stored_state.keeper import RECORD

    with as_usage_error(ValueError), ExitStack() as stack:
        recording = Recording(path, allow_partial=True)
        sink = _Nowhere()
        if out is not None:
            out.check()  # again, now that the recording has been read
            origin = {"bearing_sim_replay": {"log": path.name, "from_recording": "true"}}
            origin |= {name: record for name, record in recording.records.items() if name == RECORD}
            sink = stack.enter_context(recording_into(out, McapSink(out.path, recording.scene, recording.start_ns, origin, replace=out.force)))
        announce_compilation(recording.scene)
        has_bands = reproduction.first_bands(recording) is not None
        given = {"estimation": response_with_progress(recording.scene)} if has_bands else {}
        progress = stack.enter_context(progress_bar(f"reproducing {path.name}", recording.duration))
        result = reproduction.reproduce(recording, sink, progress, given)
    tell_use(recording.tally, path)
    was = {name: recording.metadata.get(name, "") for name in ("package_version", "git_hash")}
    now = {"package_version": package_version(), "git_hash": git_hash()}
    report = {"recording": str(path), "out": out and str(out), "scene": recording.scene.name, "level": recording.scene.level}
    bands = {name: vars(each) for name, each in result.bands.items()}
    report |= {**vars(result), "bands": bands, "recorded_with": was, "repeated_with": now, "read": recording.tally.report()}
    rows = [
        ("used", recording.tally.counts),
        *(("not read", text) for text in recording.tally.unread),
        ("level", recording.scene.level),
        ("recorded with", _version(was)),
        ("reproduced with", _version(now)),
        ("start", ", then ".join(result.starts)),
        ("samples", f"{result.samples}, {result.failed} of which could not be computed"),
        ("input messages copied", str(result.received)),
        (
            "simulated",
            f"{result.sim_seconds:.6g} s in {result.wall_seconds:.3g} s; {result.skipped_seconds:.4g} s were not simulated originally either",
        ),
        ("changes of level", str(result.level_changes)),
        *((f"band of {name}", _differing(each)) for name, each in result.bands.items()),
        ("recording", f"{out}; bearing-sim compare {path} {out} shows the differences" if out else "none"),
    ]
    return Result(report, lambda: print_table(f"{path.name} reproduced on {recording.scene.name}", rows))


def _differing(band) -> str:
    """Return in words how a band differs from the recorded one (`bearing_sim.runtime.reproduced_bands.BandDifference`)."""
    alone = "".join(f"; {count} instants {which} only" for count, which in ((band.missing, "recorded"), (band.further, "reproduced")) if count)
    largest = f", the farthest off by {band.largest:.3g} of it, at {band.at:.6g} s" if band.largest else ""
    return f"{band.near} of {band.compared} instants within a tenth of its width{largest}{alone}"


def _version(origin: dict[str, str]) -> str:
    return ", ".join(filter(None, (origin["package_version"], origin["git_hash"]))) or "an unknown version"


class _Nowhere:
    """A recording that drops everything."""

    def write(self, record) -> None:
        """Drop a record."""
