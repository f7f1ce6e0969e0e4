# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim replay``: run the model on a recorded log of shaft speed and radial load."""

import time
from contextlib import ExitStack, suppress
from pathlib import Path

import click

from bearing_sim.commands.reporting import (
    BadInput,
    FailedRun,
    orderly_end,
    print_json,
    print_table,
    progress_bar,
    tell_cheaper_level,
    tell_compilation,
    tell_replacement,
    told_as_bad_input,
    told_file_faults,
)


@click.command()
@click.argument("logs", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="IN.mcap...")
@click.option("--scene", "scene_name", metavar="SCENE", help="Bundled scene or YAML file.")
@click.option(
    "--from-recording", is_flag=True, help="Compute the run of a recording again, from it alone: its scene, start and inputs, sample by sample."
)
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("-o", "--out", type=click.Path(path_type=Path), metavar="OUT.mcap", help="Recording of inputs and outputs [default: none].")
@click.option("--rrd", type=click.Path(path_type=Path), metavar="RUN.rrd", help="Write a view for rerun, too.")
@click.option("--rate", type=click.FloatRange(min=0, min_open=True), metavar="HZ", help="Outputs per simulated second [default: one at each stamp].")
@click.option(
    "--speed", "--speed-topic", "speed", metavar="TOPIC", help="Shaft speed: /topic, or /topic.field[0] of any type [default: /shaft_speed]."
)
@click.option(
    "--load", "--load-topic", "load", metavar="TOPIC", help="Radial load, likewise; /topic.y,z for both components [default: /radial_load]."
)
@click.option(
    "--temperature",
    "--temperature-topic",
    "temperature",
    metavar="TOPIC",
    help="Oil temperature, likewise [default: /oil_temperature, where there is one].",
)
@click.option("--speed-unit", metavar="UNIT", help="Unit of the shaft speed in the log, such as rpm [default: rad/s].")
@click.option("--load-unit", metavar="UNIT", help="Unit of the load in the log, such as kN [default: N].")
@click.option("--temperature-unit", metavar="UNIT", help="Unit of the oil temperature in the log [default: degC].")
@click.option("--joint", default="shaft", show_default=True, metavar="NAME", help="The shaft's joint in JointState messages.")
@click.option("--stamps", type=click.Choice(["header", "log"]), default="header", show_default=True, help="Go by header stamps, or by log times.")
@click.option(
    "--longest-gap",
    type=click.FloatRange(min=0, min_open=True),
    metavar="S",
    help="Longer times between messages are not simulated [default: ten times their usual spacing, at least input_limits.stale_after of the scene].",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(
    logs,
    scene_name,
    from_recording,
    overrides,
    out,
    rrd,
    rate,
    speed,
    load,
    temperature,
    speed_unit,
    load_unit,
    temperature_unit,
    joint,
    stamps,
    longest_gap,
    as_json,
):
    """Run the model on IN.mcap and write inputs and outputs to OUT.mcap.

    IN.mcap is any rosbag2 recording, MCAP or sqlite3 (a file, also an unfinished one, or a bag's folder; several that belong together)
    with shaft speed (JointState or Float64) and radial load (WrenchStamped, or Float64 along +y), or with such numbers in messages of
    any other type whose definition is in the recording. Needs no ROS. Inputs go linearly from stamp to stamp; bad messages are refused,
    told and counted as in a live run.
    """
    if from_recording == bool(scene_name):
        raise BadInput("give either --scene, or --from-recording for a recording of bearing-sim")
    if from_recording:
        from bearing_sim.commands.from_recording import repeat_recording

        if len(logs) > 1 or overrides or rate or rrd or speed or load or temperature:
            raise BadInput("--from-recording takes one recording, all of it as it was; only -o and --json go with it")
        repeat_recording(logs[0], out, as_json)
        return
    import numpy as np

    from bearing_sim.input_course import judge
    from bearing_sim.input_log import InputLogError, read_input_log
    from bearing_sim.input_source import source
    from bearing_sim.replay import replay
    from bearing_sim.scene_file import SceneError, load_scene
    from bearing_sim.simulation import Inputs, IntegrationError, Simulation
    from bearing_sim.sinks.mcap_sink import McapSink

    with told_as_bad_input(ValueError):
        names = {
            channel: source(channel, text, unit)
            for channel, text, unit in (
                ("shaft_speed", speed, speed_unit),
                ("radial_load", load, load_unit),
                ("oil_temperature", temperature, temperature_unit),
            )
            if text or unit
        }
    with told_as_bad_input(SceneError, InputLogError), told_file_faults(), orderly_end():
        if out is not None and out.exists() and any(log.exists() and out.samefile(log) for log in logs):
            raise BadInput(f"{out} is the log itself; write to another file")
        scene = load_scene(scene_name, overrides)
        tell_cheaper_level(scene)
        recorded = read_input_log(logs, names, joint, stamps)
        held = Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature)
        course = judge(recorded, scene.input_limits, held, longest_gap)
        seconds = course.end * 1e-9
        with ExitStack() as stack:
            recording, names_of = None, [log.name for log in logs]
            if out is not None:
                tell_replacement(out)
                recording = stack.enter_context(
                    McapSink(out, scene, course.start_ns, {"bearing_sim_replay": {"log": " ".join(names_of)}}, replace=True)
                )
            watchers = []
            if rrd is not None:
                from bearing_sim.sinks.rerun_sink import RerunSink

                watchers.append(stack.enter_context(RerunSink(scene, path=rrd, start_ns=course.start_ns, lossless=True, duration=seconds)))
            tell_compilation()
            choice = _choice(scene, course)
            started = time.perf_counter()
            with suppress(IntegrationError):  # the replay itself will tell
                warm = choice.get("model", Simulation)(scene)
                warm.advance(1e-6)  # machine code is compiled or loaded here, and not timed with the run
                if warm.takes_courses:
                    warm.advance_course(np.array([1e-6]), np.array([warm.inputs]))
            start_up = time.perf_counter() - started
            progress = stack.enter_context(progress_bar(f"replaying {', '.join(names_of)}", seconds))
            result = replay(scene, course, recording, watchers, rate, progress, **choice)
    if as_json:
        print_json({**_report(result, course, recorded, scene, out), "start_up_seconds": start_up})
    else:
        _print(result, course, recorded, scene, out)
    if result.given_up:
        raise FailedRun(result.given_up)


def _choice(scene, course) -> dict:
    """Return what replay is told of the model: at level steady its table, for one oil temperature where the log has no other."""
    if scene.level != "steady":
        return {}
    from functools import partial

    from bearing_sim.commands.table import build_with_progress
    from bearing_sim.simulation import Simulation

    kelvin = scene.lubricant.temperature
    return {"model": partial(Simulation, table=build_with_progress(scene, None if "oil_temperature" in course.stamps else (kelvin, kelvin))[0])}


def _report(result, course, recorded, scene, out) -> dict:
    from bearing_sim.input_log import anomalies

    slip = result.slip_figures()
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
        "life_hours": result.life_hours,
        "least_rating_life_hours": result.least_rating_life,
        "damage": result.damage,
        "log_seconds": result.log_seconds,
        "sim_seconds": result.sim_seconds,
        "gaps": len(course.gaps),
        "gap_seconds": result.gap_seconds,
        "wall_seconds": result.wall_seconds,
        "cpu_seconds": result.cpu_seconds,
        "real_time_factor": result.real_time_factor,
        "steps": result.steps,
        "rejected_steps": result.rejected_steps,
        "non_finite_steps": result.non_finite_steps,
        "failed_ticks": result.failed_ticks,
        "samples": result.samples,
        "inputs": course.messages,
        "inputs_refused": course.refused.total(),
        "inputs_refused_by_reason": dict(course.refused),
        "inputs_anomalies": {channel: anomalies(series)._asdict() for channel, series in recorded.series.items()},
        "inputs_stamped_by": {channel: series.stamped_by for channel, series in recorded.series.items()},
        "events": dict(result.events),
        "log_unfinished": recorded.unfinished,
        "given_up": result.given_up,
    }


def _print(result, course, recorded, scene, out) -> None:
    from bearing_sim.input_log import summary_lines

    slip = {name: f"{100 * value:.2f} %" for name, value in result.slip_figures().items()}
    shares = f"mean {slip['mean']}, median {slip['median']}, 95 % below {slip['p95']}, 99 % below {slip['p99']}, most {slip['maximum']}"
    rejected = f"{result.rejected_steps} rejected, {result.non_finite_steps} of them not finite"
    refused = ", ".join(f"{count} x {code}" for code, count in sorted(course.refused.items())) or "none"
    rows = [("log", line) for line in summary_lines(recorded)]
    if recorded.unfinished:
        rows.append(("log ends early", recorded.unfinished))
    rows += [
        ("level", scene.level),
        ("cage slip while turning", shares),
        ("life under this course", f"{result.life_hours:.4g} h (least rating life of an instant {result.least_rating_life:.4g} h)"),
        ("life used", f"{100 * result.damage:.4g} %"),
        ("refused inputs", f"{refused} (of {course.messages})"),
        ("gaps", f"{len(course.gaps)}, {result.gap_seconds:.4g} s not simulated"),
        ("simulated", f"{result.sim_seconds:.6g} s of {result.log_seconds:.6g} s, {result.samples} outputs"),
        ("took", f"{result.wall_seconds:.3g} s ({result.cpu_seconds:.3g} s of processor), {result.real_time_factor:.3g} times real time"),
        ("steps", f"{result.steps}, {rejected}; {result.failed_ticks} stretches left out"),
        ("events", ", ".join(f"{count} x {code}" for code, count in sorted(result.events.items())) or "none"),
        ("recording", str(out or "none")),
    ]
    print_table(f"replay of {recorded.path.name} on {scene.name}", rows)
