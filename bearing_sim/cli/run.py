# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim run``: a scene under its constant conditions."""

import math
import time
from contextlib import ExitStack
from pathlib import Path

import click
import numpy as np

from bearing_sim.cli.lives import life_rows
from bearing_sim.cli.options import json_option, scene_argument, set_option
from bearing_sim.cli.reporting import (
    announce_compilation,
    announce_replacement,
    as_failed_run,
    as_file_error,
    as_usage_error,
    command_line,
    print_json,
    print_table,
    progress_bar,
    seconds_of,
    suggest_level,
    warn_of_limits,
    warn_of_scene,
    warnings_report,
)

_BLOCK = 10  # samples
_SAMPLES = 10_000  # of a long run, by default
_RATE = 1000.0  # [Hz] of a short run


@click.command("run")
@scene_argument
@set_option
@click.option("--duration", default="0.5 s", show_default=True, metavar="S", help="Simulated time, such as 0.5 or '300 ms' (Deng 2017: 0.5 s).")
@click.option("--level", metavar="LEVEL", help="Level of fidelity, instead of the scene's.")
@click.option(
    "--rate", type=click.FloatRange(min=0, min_open=True), metavar="HZ", help="Samples per simulated second [default: 1000, fewer beyond 10 s]."
)
@click.option("--out", type=click.Path(path_type=Path), metavar="RUN.mcap", help="Record the run.")
@click.option("--rrd", type=click.Path(path_type=Path), metavar="RUN.rrd", help="Also write a view for rerun.")
@click.option(
    "--uncertainty", type=click.IntRange(2, 65536), metavar="N", help="Also compute ranges of slip and life from N samples of uncertain fields."
)
@json_option
def run(scene_name, overrides, duration, level, rate, out, rrd, uncertainty, as_json):
    """Run SCENE (a bundled scene or a YAML file) under its constant conditions, starting from ideal rolling.

    Cage slip is the mean over the last fifth of the run, after it has settled. --uncertainty uses the settled bearing at the fastest
    level that supports the scene; `bearing-sim uncertainty` shows more.
    """
    from bearing_sim.cli.uncertainty import bands_of
    from bearing_sim.messages.events import validity_event
    from bearing_sim.model.validity import outside
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError, Simulation, start_sample

    seconds = seconds_of(duration)
    with as_usage_error(SceneError):
        scene = load_scene(scene_name, [*overrides, *([f"level={level}"] if level else [])])
    suggest_level(scene)
    warn_of_scene(scene)
    samples = max(round(seconds * (rate or min(_RATE, _SAMPLES / seconds))), 5)
    with as_file_error(), as_failed_run(IntegrationError), ExitStack() as stack:
        sinks = _sinks(stack, scene, seconds, samples, out, rrd)
        progress = stack.enter_context(progress_bar(f"running {scene.name}", seconds))
        started = time.perf_counter()
        announce_compilation()
        simulation = Simulation(scene)
        simulation.advance(1e-6)  # compile or load machine code, so that it is not timed with the run
        simulation.reset()
        for sink in sinks[: out is not None]:
            sink.write(start_sample(simulation))
        first = time.perf_counter()
        settled = _advance(simulation, seconds, samples, sinks, progress)
        wall = time.perf_counter() - first
        warnings = outside(scene, simulation.sample.reshape(1))
        for sink in sinks:
            for each in warnings:
                sink.write_event(validity_event(simulation.time, each))
    report = {**_report(simulation, settled, seconds, wall, first - started), **warnings_report(scene, warnings)}
    bands = bands_of(scene, uncertainty)[1] if uncertainty else None
    if as_json:
        print_json({**report, "uncertainty": bands} if bands else report)
    else:
        _print(report, scene, bands)
    warn_of_limits(scene, warnings)


def _sinks(stack, scene, seconds, samples, out, rrd) -> list:
    start_ns, sinks = time.time_ns(), []
    if out is not None:
        from bearing_sim.recording.writer import COMMAND, McapSink

        announce_replacement(out)
        metadata, advance = {COMMAND: {"command": command_line()}}, (_BLOCK * (seconds / samples), _BLOCK)
        sinks.append(stack.enter_context(McapSink(out, scene, start_ns, metadata, replace=True, advance=advance)))
    if rrd is not None:
        from bearing_sim.view.worker import RerunFile

        sinks.append(stack.enter_context(RerunFile(scene, rrd, start_ns, seconds)))
    return sinks


def _advance(simulation, seconds, samples, sinks, progress) -> list:
    """Advance to the end block by block; return the slips of the settled last fifth as a list of numbers."""
    interval, settled = seconds / samples, []
    for done in range(0, samples, _BLOCK):
        count = min(_BLOCK, samples - done)
        block = simulation.advance(count * interval, samples=count)
        for sink in sinks:
            sink.write(block)
        settled += [slip for offset, slip in enumerate(block["cage_slip"].tolist()) if done + offset >= 0.8 * samples]
        progress((done + count) * interval)
    return settled


def _report(simulation, settled, seconds, wall, start_up) -> dict:
    from bearing_sim.studies.rating import life_report

    last, counters = simulation.sample, simulation.counters
    return {
        "scene": simulation.scene.name,
        "level": simulation.scene.level,
        "cage_slip": math.fsum(settled) / len(settled),
        "cage_slip_minimum": min(settled),
        "cage_slip_maximum": max(settled),
        **life_report(simulation.scene, np.array([last])),
        "damage": float(last["damage"]),
        "cage_speed_rpm": float(last["cage_speed"]) * 30 / math.pi,
        "inner_load_maximum": float(last["inner_load"].max()),
        "outer_load_maximum": float(last["outer_load"].max()),
        "inner_pressure_maximum_mpa": 1e-6 * float(last["inner_pressure"]) if simulation.scene.bodies_tilt else None,
        "outer_pressure_maximum_mpa": 1e-6 * float(last["outer_pressure"]) if simulation.scene.bodies_tilt else None,
        "inner_edge_pressure_maximum_mpa": 1e-6 * float(last["inner_edge_pressure"]) if simulation.scene.bodies_tilt else None,
        "outer_edge_pressure_maximum_mpa": 1e-6 * float(last["outer_edge_pressure"]) if simulation.scene.bodies_tilt else None,
        "sim_seconds": seconds,
        "wall_seconds": wall,
        "start_up_seconds": start_up,
        "real_time_factor": seconds / wall,
        **counters._asdict(),
    }


def _print(report, scene, bands) -> None:
    from bearing_sim.cli.uncertainty import band_rows

    rejected = f"{report['rejected_steps']} rejected, {report['non_finite_steps']} of which not finite"
    print_table(
        f"{report['scene']} at level {report['level']}",
        [
            (
                "cage slip",
                f"{100 * report['cage_slip']:.2f} % ({100 * report['cage_slip_minimum']:.2f} to {100 * report['cage_slip_maximum']:.2f} %)",
            ),
            ("cage speed", f"{report['cage_speed_rpm']:.6g} rpm"),
            *life_rows(scene, report),
            *_pressures(report, scene),
            ("largest roller load", f"inner {report['inner_load_maximum']:.4g} N, outer {report['outer_load_maximum']:.4g} N"),
            ("simulated", f"{report['sim_seconds']:.4g} s in {report['wall_seconds']:.3g} s, {report['real_time_factor']:.3g} times real time"),
            ("steps", f"{report['steps']}, {rejected}"),
            ("work", f"{report['right_hand_sides']} right-hand sides, {report['jacobians']} Jacobians, {report['factorisations']} factorisations"),
            *(band_rows(bands) if bands else []),
            *(
                [("uncertainty", f"{bands['evaluations']} runs of level {bands['level']}, seed {bands['seed']}; in parentheses the sampling error")]
                if bands
                else []
            ),
        ],
    )


def _pressures(report, scene) -> list[tuple[str, str]]:
    """Return the rows of pressures by slices, where the level has them."""
    rows = []
    if scene.bodies_tilt:
        for ring in ("inner", "outer"):
            whole, edge = report[f"{ring}_pressure_maximum_mpa"], report[f"{ring}_edge_pressure_maximum_mpa"]
            rows.append((f"largest pressure, {ring} raceway", f"{whole:.4g} MPa, end slices {edge:.4g} MPa"))
    return rows
