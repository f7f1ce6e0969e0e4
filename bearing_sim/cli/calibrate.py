# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim calibrate``: fit fields of a scene to the measured cage speed of a recording."""

import click
from click import FloatRange

from bearing_sim.cli.options import PATH, allow_outside_option, json_option, log_options, option, picture_option, set_option
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    as_usage_error,
    judged,
    print_table,
    progress_bar,
    unknown_report,
    warn_of_scene,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.loader import load_scene, scene_from_yaml, scene_to_yaml
from bearing_sim.scene.uncertainty import quantities

_EXPECTED = 30  # evaluations of a typical search, for the progress bar
_UNLIKELY = 0.01


@command("calibrate")
@click.argument("log", type=PATH, metavar="RUN.mcap")
@allow_outside_option
@option("--scene", "scene_name", "Bundled scene or YAML file [default: the scene in the recording].", metavar="SCENE")
@set_option
@option("--fit", "fields", "Fit this field; can be repeated [default: lubricant.mixture_fraction].", multiple=True, metavar="FIELD")
@option("--batch", "Length of the averaged blocks [default: 1 s, less for short runs].", FloatRange(min=0.01), metavar="S")
@option("--confidence", "Level of the confidence intervals.", FloatRange(0.5, 0.999), default=0.95, metavar="FRACTION")
@option("-o", "--out", "Write the scene with the fitted values and their intervals.", OutputFile(".yaml", ".yml"), metavar="SCENE.yaml")
@picture_option("Draw measured and predicted slip")
@log_options
@option(
    "--cage",
    "--cage-topic",
    "cage",
    "Measured cage speed: /topic, or /topic.field[0] of any type, in the unit of --speed-unit [default: /cage_speed_measured].",
    metavar="TOPIC",
)
@option("--cage-joint", "Name of the cage's joint in JointState messages.", default="cage", metavar="NAME")
@json_option
def calibrate(log, scene_name, overrides, fields, batch, confidence, out, cage, cage_joint, reading):
    """Fit fields of a scene to the cage speed measured in RUN.mcap, within their ranges in the scene's block `uncertainty`.

    RUN.mcap is any rosbag2 recording in MCAP with shaft speed, radial load and measured cage speed: from bearing-sim, from any bag, or
    from a table by `bearing-sim import-csv`. Only settled operation is used. Fields that the data cannot determine are refused.
    """
    scene = _scene(log, scene_name, overrides)
    warn_of_scene(scene, before_results=False)
    measured, lines, unknown = _measured(log, scene, reading, cage, cage_joint)
    announce_compilation(scene)
    from bearing_sim.studies.calibration import block_length, calibrate, cut, plot_calibration

    length = batch or block_length(measured.times[-1] - measured.times[0])
    blocks = cut(measured, scene.bearing.diameter_ratio, scene.thresholds.slip_from_speed, length)
    asked = fields or ("lubricant.mixture_fraction",)
    with progress_bar(f"calibrating {scene.name}", _EXPECTED) as show:
        found = calibrate(scene, asked, blocks, confidence=confidence, progress=show)
    if out is not None:
        _write(out, log, found)
    title = f"{scene.name} calibrated by {log.name}"
    return Result(
        {**_report(log, scene, found), **unknown},
        lambda: _print(title, scene, found, lines, out),
        lambda draft: plot_calibration(draft, title, found),
    )


def _scene(log, scene_name, overrides):
    """Return the scene to calibrate: the named one, or that of the recording, with overrides."""
    from bearing_sim.recording.bag import RecordingError
    from bearing_sim.recording.reader import Recording

    if scene_name is not None:
        return load_scene(scene_name, overrides)
    try:
        recorded = Recording(log).scene
    except RecordingError as error:
        raise UsageError(f"{error}; give the scene to calibrate with --scene") from None
    return scene_from_yaml(scene_to_yaml(recorded), overrides, origin=f"{log}: scene in the metadata")


def _measured(log, scene, reading, cage, cage_joint):
    """Return the measured data, table rows that say where they come from, and for how long inputs are unknown."""
    import math

    from bearing_sim.inputs.log import REQUIRED, source, summary_lines
    from bearing_sim.messages.topics import MEASURED
    from bearing_sim.studies.calibration import Measured

    with as_usage_error(ValueError):
        if cage is not None:
            reading.sources[MEASURED] = source(MEASURED, cage, reading.speed_unit)
        recorded = reading.read(log, cage_joint=cage_joint, required=(*REQUIRED, MEASURED))
        course = judged(recorded, scene, reading.longest_gap)
    inputs = course.at(course.instants, math.nan)  # NaN: the scene's own temperature, which may be a fitted field
    gaps = [(begin * 1e-9, end * 1e-9) for begin, end in course.gaps]
    lines = [*(("log", line) for line in summary_lines(recorded)), ("used", course.tally.counts)]
    speeds = course.values[MEASURED].reshape(-1, 2)[:, 0]
    return Measured(course.instants * 1e-9, inputs, gaps, course.stamps[MEASURED] * 1e-9, speeds), lines, unknown_report(course)


def _override(found) -> list[str]:
    return [f"{one.range.field}={one.value:.9g}" for one in found.fitted]


def _write(out, log, found) -> None:
    from bearing_sim.files.provenance import package_version

    fields = ", ".join(one.range.field for one in found.fitted)
    head = f"# Calibrated by bearing_sim {package_version()}: {fields} fitted to the cage speed in {log.name}, {len(found.blocks.slip)} blocks.\n"
    out.write_text(head + scene_to_yaml(found.scene))


def _root_mean_square(values) -> float:
    return float((values**2).mean() ** 0.5)


def _report(log, scene, found) -> dict:
    fields = [one.range.field for one in found.fitted]
    blocks = found.blocks
    return {
        "log": log.name,
        "scene": scene.name,
        "level": "steady",
        "confidence": found.confidence,
        "fitted": {
            one.range.field: {"value": one.value, "interval": [one.low, one.high], "before": one.before, "range": [one.range.low, one.range.high]}
            for one in found.fitted
        },
        "overrides": _override(found),
        "correlation": found.correlation.tolist(),
        "depends_on": {other: {"low": dict(zip(fields, row[0])), "high": dict(zip(fields, row[1]))} for other, row in found.depends.items()},
        "blocks": len(blocks.slip),
        "block_seconds": blocks.length,
        "blocks_left_out": dict(blocks.left_out),
        "independent_blocks": found.effective,
        "operating_points": len(found.points.conditions),
        "slip_measured": float(blocks.slip.mean()),
        "slip_before": float(found.before.mean()),
        "slip_after": float(found.after.mean()),
        "residual_before": _root_mean_square(blocks.slip - found.before),
        "residual_after": _root_mean_square(blocks.slip - found.after),
        "misfit": found.misfit,
        "misfit_chance": found.misfit_chance,
    }


def _print(title, scene, found, lines, out) -> None:
    known, blocks = quantities(type(scene)), found.blocks
    percent = f"{100 * found.confidence:g} %"
    rows = [*lines]
    for one in found.fitted:
        show = known[one.range.field].show
        fitted = f"{show(one.value)}, {percent} interval {show(one.low)} to {show(one.high)}"
        rows.append((one.range.field, f"{fitted}\n(scene: {show(one.before)}, searched from {show(one.range.low)} to {show(one.range.high)})"))
    if len(found.fitted) > 1:
        pairs = [(a, b) for a in range(len(found.fitted)) for b in range(a)]
        names = [one.range.field.rpartition(".")[2] for one in found.fitted]
        rows.append(("correlation", "\n".join(f"{names[b]} and {names[a]}: {found.correlation[a, b]:+.2f}" for a, b in pairs)))
    rows += _dependence(scene, found)
    left_out = ", ".join(f"{count} {why}" for why, count in blocks.left_out.items()) or "none"
    after, before = (100 * _root_mean_square(blocks.slip - predicted) for predicted in (found.after, found.before))
    rows += [
        (
            "measured slip",
            f"{100 * blocks.slip.mean():.3f} % on average; model {100 * found.after.mean():.3f} %, uncalibrated {100 * found.before.mean():.3f} %",
        ),
        ("residuals, root mean square", f"{after:.3f} points, uncalibrated {before:.3f}"),
        ("data", f"{len(blocks.slip)} blocks of {blocks.length:.3g} s at {_points(found)}; left out: {left_out}"),
        ("information", f"{found.effective:.0f} independent blocks: residuals are correlated over {found.correlation_time * blocks.length:.2g} s"),
        ("model", _misfit(found)),
        ("to use the result", " ".join(f'--set "{item}"' for item in _override(found)) + (f", or the scene {out}" if out else "")),
    ]
    if scene.level not in ("steady", "slip"):
        rows.append(("level", f"fitted at level steady; the slip of the scene's level {scene.level} differs by what `bearing-sim trade` shows"))
    print_table(title, rows)


def _points(found) -> str:
    count = len(found.points.conditions)
    return "one operating point" if count == 1 else f"{count} operating points"


def _dependence(scene, found) -> list[tuple[str, str]]:
    known, effects = quantities(type(scene)), []
    for other, ends in found.depends.items():
        one = next(each for each in scene.uncertainty if each.field == other)
        for place, fitted in enumerate(found.fitted):
            name, show = fitted.range.field.rpartition(".")[2], known[fitted.range.field].show
            low, high = (known[other].show(end) for end in (one.low, one.high))
            effects.append(f"{name} about {show(ends[0, place])} with {other} {low}, {show(ends[1, place])} with {high}")
    return [("effect of the other uncertain fields", "\n".join(effects))] if effects else []


def _misfit(found) -> str:
    import math

    if not math.isfinite(found.misfit):
        return "no more operating points than fields: the model cannot be checked"
    share = f"means at operating points deviate by {math.sqrt(found.misfit):.2g} times what scatter explains"
    if found.misfit_chance < _UNLIKELY:
        return f"{share}: the model has an error that the intervals do not include"
    return f"{share}: no sign of a model error"
