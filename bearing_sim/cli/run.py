# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim run``: a scene under its constant conditions."""

import math
import shlex
import time
from contextlib import ExitStack
from typing import NamedTuple

from click import Choice, FloatRange, IntRange

from bearing_sim.cli.estimation import estimation_with_progress, live_band_numbers, live_band_rows
from bearing_sim.cli.options import SECONDS, json_option, option, scene_options, verbose_option
from bearing_sim.cli.outputs import OutputFile, OutputRecording, recording_into
from bearing_sim.cli.reporting import (
    Unsettled,
    UsageError,
    announce_compilation,
    command_line,
    print_groups,
    progress_bar,
    scene_of_point,
    suggest_level,
    warn_of_limits,
    warnings_report,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.display import number

_BLOCK = 10  # samples
_SAMPLES = 10_000  # of a long run, by default
_RATE = 1000.0  # [Hz] of a short run
_LEAST_SAMPLES = 100  # of the shortest run that can be judged


@command("run")
@scene_options
@option("--duration", "Simulated time, such as 0.5 or '300 ms' [default: until slip and life rest, at least 0.5 s].", SECONDS)
@option("--at-most", "End a run without --duration here [default: 1000 s, or 2000 cage turns if these take longer].", SECONDS)
@option("--level", "Level of fidelity, instead of the scene's.", metavar="LEVEL")
@option("--start", "How the cage begins.", Choice(["rolling", "skid"]), default="rolling")
@option(
    "--rate",
    "Samples per simulated second [default: 1000, fewer if the run takes more than 10 s at least].",
    FloatRange(min=0, min_open=True),
    metavar="HZ",
)
@option("-o", "--out", "Record the run.", OutputRecording(), metavar="RUN.mcap")
@option("--rrd", "Also write a view for rerun.", OutputFile(), metavar="RUN.rrd")
@option("--uncertainty", "Also compute ranges of slip and life from N samples of uncertain fields.", IntRange(2, 65536), metavar="N")
@verbose_option
@json_option
def run(scene_name, overrides, duration, at_most, level, start, rate, out, rrd, uncertainty, verbose):
    """Run SCENE (a bundled scene or a YAML file) under its constant conditions, from ideal rolling or a skid, until it has settled.

    A run has settled when cage slip is known to 0.05 points and life to 2 %, and neither is going to change by more. One that has not
    settled in the longest time says what it was doing, and the exit code is 4. With --duration it ends after exactly that time, settled or
    not, and says which. With heat.law network it begins in thermal equilibrium; where there is none, the run fails and says why.

    Where the bearing may stay in other states under the same conditions, these are shown, too, and the load below which a skid lasts.

    Slip, cage speed, powers and lives are means over the last fifth of the run; largest loads and pressures are those of that fifth.
    --uncertainty uses the settled bearing at the fastest level that supports the scene; `bearing-sim
    uncertainty` shows more.
    """
    from bearing_sim.messages.events import validity_event
    from bearing_sim.model.validity import outside
    from bearing_sim.simulation import Simulation, start_sample
    from bearing_sim.sweep.grading import graded
    from bearing_sim.sweep.states import SKID, other_states, skid_start, state_rows
    from bearing_sim.sweep.thermal import begin_in_equilibrium
    from bearing_sim.watchers.estimation.two_states import laws_of_table

    if duration is not None and at_most is not None:
        raise UsageError("--at-most is for a run without --duration; give one of them")
    scene = scene_of_point(scene_name, overrides, level)
    suggest_level(scene)
    plan = _plan(scene, duration, at_most, rate)
    estimation, corrected = estimation_with_progress(scene), _corrected_table(scene)
    with ExitStack() as stack:
        sinks = _sinks(stack, scene, duration, plan.interval, out, rrd)
        until = "" if duration else f" until it has settled, at most {plan.longest:.4g} s"
        progress = stack.enter_context(progress_bar(f"running {scene.name}{until}", plan.longest))
        started = time.perf_counter()
        announce_compilation(scene, with_states=True)
        begin = skid_start(scene) if start == SKID else None
        simulation = Simulation(scene, table=corrected, start=begin)
        simulation.advance(1e-6)  # compile or load machine code, so that it is not timed with the run
        simulation.reset(start=begin)
        begin_in_equilibrium(simulation, plan.shortest, plan.longest, begin)
        for sink in sinks[: out is not None]:
            sink.write(start_sample(simulation))
        first = time.perf_counter()
        outcome = _advance(simulation, plan, sinks, progress, estimation)
        wall = time.perf_counter() - first
        others = other_states(scene, outcome, start)
        exceedances = outside(scene, outcome.window, laws=laws_of_table(scene, _table_temperatures(scene)))
        warnings = graded(scene, exceedances, outcome.window[-1])
        for sink in sinks:
            for each in warnings:
                sink.write(validity_event(outcome.simulated, each))
    report = {**_report(simulation, outcome, wall, first - started), **warnings_report(scene, warnings), **_states_report(others, start)}
    report |= live_band_numbers(estimation.newest) if estimation is not None else {}
    if uncertainty:
        from bearing_sim.cli.uncertainty import bands_of

        report["uncertainty"] = bands_of(scene, uncertainty)[1]
    unsettled = duration is None and not outcome.settled
    return Result(
        report,
        lambda: _print(report, scene, estimation, state_rows(others, start) if math.isfinite(outcome.slip) else [], verbose),
        after=lambda: warn_of_limits(scene, warnings, verbose),
        ending=Unsettled(f"not settled: {outcome.reason}; give more time with --at-most") if unsettled else None,
    )


class _Plan(NamedTuple):
    """How long a run is and how it is sampled; a run of given length has both lengths equal."""

    shortest: float  # s
    longest: float  # s
    interval: float  # between samples [s]
    samples: int | None  # of a run of given length


def _corrected_table(scene):
    """Return the table that a scene at level steady wants corrected, from disk or built; None for all others, whose points are solved for."""
    if scene.level != "steady" or scene.table.correction == "none":
        return None
    from bearing_sim.cli.table import build_with_progress

    return build_with_progress(scene, _table_temperatures(scene))[0]


def _table_temperatures(scene) -> tuple[float, float] | None:
    kelvin = scene.lubricant.temperature
    return (kelvin, kelvin) if scene.heat.law == "none" else None


def _plan(scene, seconds, most, rate) -> _Plan:
    from bearing_sim.sweep.point import DURATION
    from bearing_sim.sweep.settling import LONGEST, longest_run, shortest_run

    if seconds is not None:
        samples = max(round(seconds * (rate or min(_RATE, _SAMPLES / seconds))), 5)
        return _Plan(seconds, seconds, seconds / samples, samples)
    shortest = shortest_run(scene, DURATION)
    longest = most if most is not None else longest_run(scene, LONGEST)
    if longest < shortest:
        raise UsageError(f"--at-most {longest:g} s: the shortest run of this bearing that can be judged takes {shortest:.4g} s")
    if rate is not None and rate * shortest < _LEAST_SAMPLES:
        raise UsageError(f"--rate {rate:g}: too few samples to see whether the run has settled; give {_LEAST_SAMPLES / shortest:.3g} or more")
    return _Plan(shortest, longest, 1.0 / (rate or min(_RATE, _SAMPLES / shortest)), None)


def _sinks(stack, scene, seconds, interval, out, rrd) -> list:
    start_ns, sinks = time.time_ns(), []
    if out is not None:
        from bearing_sim.recording.writer import COMMAND, McapSink

        out.check()  # again, now that the scene has been read
        metadata = {COMMAND: {"command": command_line()}}
        sink = McapSink(out.path, scene, start_ns, metadata, replace=out.force, advance=(_BLOCK * interval, _BLOCK))
        sinks.append(stack.enter_context(recording_into(out, sink)))
    if rrd is not None:
        from bearing_sim.view.worker import RerunFile

        sinks.append(stack.enter_context(RerunFile(scene, stack.enter_context(rrd.draft()), start_ns, seconds)))
    return sinks


def _advance(simulation, plan, sinks, progress, estimation):
    """Advance to the end block by block; return how the run ended."""
    from bearing_sim.sweep.settling import advance_in_calls, advance_until_settled

    def write(block):
        for sink in sinks:
            sink.write(block)
        for bands in estimation.see(block) if estimation is not None else ():
            for sink in sinks:
                sink.write(bands)
        progress(float(block["time"][-1]))

    def advance(seconds):
        count = plan.samples or _BLOCK * math.ceil(seconds / (_BLOCK * plan.interval) * (1.0 - 1e-9))  # whole calls, so that they can be repeated
        return advance_in_calls(simulation, plan.interval, count, _BLOCK, write)

    return advance_until_settled(simulation, plan.shortest, plan.longest, advance)


def _report(simulation, outcome, wall, start_up) -> dict:
    """Return the numbers of the sheet, and how the run went."""
    from bearing_sim.studies.sheet import results

    return {
        **results(simulation.scene, outcome.window),
        "cage_slip": outcome.slip,
        "settled": outcome.settled,
        "settling_seconds": outcome.settling_time,
        "unsettled_reason": outcome.reason,
        "sim_seconds": outcome.simulated,
        "wall_seconds": wall,
        "start_up_seconds": start_up,
        "real_time_factor": outcome.simulated / wall,
        **outcome.counters._asdict(),
    }


def _states_report(others, start) -> dict:
    """Return the start of the run, the other states, the skid load [N] and how the passing rollers excite the inner ring."""
    resonance = others.resonance
    ring = {} if resonance is None else {**resonance._asdict(), "ratios": resonance.ratios, "order": resonance.order}
    states = [{name: value for name, value in state._asdict().items() if name != "basin"} for state in others.states]
    return {"start": start, "other_states": states, "skid_load": others.skid_load, "ring_resonance": ring or None}


def _print(report, scene, estimation, states, verbose) -> None:
    from bearing_sim.studies.sheet import sheet

    ranges = list(live_band_rows(estimation.newest, scene)) if estimation is not None else []
    if bands := report.get("uncertainty"):
        from bearing_sim.cli.uncertainty import band_rows

        ranges += band_rows(bands)
        source = f"{bands['evaluations']} runs of level {bands['level']}, seed {bands['seed']}; in parentheses the sampling error"
        ranges.append(("uncertainty", source))
    print_groups(f"{report['scene']} at level {report['level']}", [*sheet(scene, report, states), ranges, _run_rows(report, scene, verbose)])


def _run_rows(report, scene, verbose) -> list[tuple[str, str]]:
    """Return rows on how the run went; the work of the solver for those who ask."""
    rows = [("settled", _settled(report)), *_estimates(scene)]
    if not verbose:
        return rows
    rejected = f"{report['rejected_steps']} rejected, {report['non_finite_steps']} of which not finite"
    seconds = f"{number(report['sim_seconds'])} s in {number(report['wall_seconds'], 3)} s"
    return [
        *rows,
        ("simulated", f"{seconds}, {number(report['real_time_factor'], 3)} times real time"),
        ("steps", f"{number(report['steps'], 9)}, {rejected}"),
        ("work", f"{report['right_hand_sides']} right-hand sides, {report['jacobians']} Jacobians, {report['factorisations']} factorisations"),
    ]


def _estimates(scene) -> list[tuple[str, str]]:
    """Return a row of the dimensions that no source gives; none where all are given."""
    bearing = scene.bearing
    if not bearing.estimated:
        return []
    rules = f"; their rules: bearing-sim catalog {shlex.quote(bearing.designation)}" if bearing.designation else ""
    return [("estimated", f"{', '.join(each.field for each in bearing.estimated)}{rules}")]


def _settled(report) -> str:
    if not report["settled"]:
        return f"no: {report['unsettled_reason']}"
    seconds = report["settling_seconds"]
    return f"yes, after {number(seconds, 3)} s" if seconds > 0.0 else "yes, from the start"
