# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``python test/validation estimator``: how good the calibration of a running model is."""

import math
import statistics

import click

from bearing_sim.cli.options import executor_options, json_option, scene_argument, set_option
from bearing_sim.cli.reporting import UsageError, announce_compilation, as_usage_error, print_json, print_rows, print_table, progress_bar

_QUANTITY = "lubricant.mixture_fraction"
_STEP = (0.03, 0.04)
_OIL = "lubricant.temperature"  # an input of every machine


@click.command("estimator")
@scene_argument
@set_option
@click.option("--runs", default=60, show_default=True, type=click.IntRange(1, 10_000), help="Number of machines with hidden fields.")
@click.option("--steps", default=20, show_default=True, type=click.IntRange(0, 10_000), help="Number of machines whose mixture fraction steps.")
@click.option("--hours", default=10_000.0, show_default=True, type=click.FloatRange(min=0.0), help="Hours of each kind of unchanged residual.")
@click.option("--faults", default=5, show_default=True, type=click.IntRange(0, 1000), help="Machines with each hidden fault, up and down.")
@click.option("--level", default="steady", show_default=True, type=click.Choice(["steady", "slip"]), help="Level of the scene and of the machines.")
@click.option(
    "--measure",
    "measured",
    multiple=True,
    type=click.Choice(["temperatures", "clearance"]),
    help="What sensors measure besides the cage speed; can be repeated.",
)
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0), help="Seed of the machines and of the noise.")
@executor_options
@json_option
def estimator(scene_name, overrides, runs, steps, hours, faults, level, measured, seed, workers, dask, as_json):
    """Let the estimator calibrate SCENE to machines whose hidden fields are known, and count how often it is right.

    The level itself plays the machines: fields drawn from the ranges of the scene that wander, on a course of twelve plateaus of a minute, with a
    cage sensor that has noise (0.2 points at 10 Hz), drift, 1 % wild readings and silences.  The level is solved for at each second; at level slip
    or with a thermal network every ten seconds, between which fields go straight.  Where ring temperatures are measured, half an hour passes in
    the middle of each plateau.  Hidden faults then show which cause is named for which.  Without estimation.calibrated all uncertain
    fields are calibrated; without a wander time in --set they wander by one standard deviation in the time of 120 plateaus.
    """
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.scene.uncertainty import ranges_of
    from bearing_sim.studies.uncertainty_propagation import UncertaintyError
    from bearing_sim.sweep.tasks import ClusterError, Execution, JournalInUse

    warm = "temperatures" in measured
    with as_usage_error(SceneError):
        overrides = [*overrides, f"level={level}"]
        scene = load_scene(scene_name, overrides)
        fields = [one.field for one in ranges_of(scene) if one.field != _OIL and not one.field.startswith("operating.")]
        more = [] if scene.estimation.calibrated else [f"estimation.calibrated=[{', '.join(fields)}]"]
        more += [] if any("wander_time" in each for each in overrides) else [f"estimation.drift.wander_time={62 if warm else 2} h"]
        scene = load_scene(scene_name, [*overrides, *more])
        _require_sensors(scene, measured)
    announce_compilation(scene)
    from bearing_sim.studies.response_points import obtain_response
    from validation import estimator_study as study

    known = (_OIL,)
    with as_usage_error(UncertaintyError, ClusterError, JournalInUse), progress_bar("estimator", 1.0) as show:

        def in_part(first: float, last: float):
            return lambda done, total: show(first + (last - first) * done / max(total, 1))

        response = obtain_response(scene, Execution(None, workers, dask, in_part(0.0, 0.3)))
        _require_varied(scene, response, measured)
        slow, pause = level != "steady" or scene.heat.law == "network", study.PAUSE if warm else 0.0
        every = study.WANDERING_OF_SLOW_POINTS if slow else study.WANDERING
        machines = study.machines(
            scene, response, runs, seed, known=known, pause=pause, every=every, workers=workers, dask=dask, progress=in_part(0.3, 0.5)
        )
        if not machines:
            raise UsageError("no machine of this scene settles at all of its operating points; give narrower ranges")
        judged = []
        for number, machine in enumerate(machines):
            judged.append(study.judge(scene, response, machine, seed + number, known, measured))
            in_part(0.5, 0.7)(number + 1, len(machines))
        found = study.findings(response, judged, scene.estimation.calibrated)
        detected = []
        if steps and _QUANTITY in response.names:
            detected = study.detections(scene, response, _QUANTITY, _STEP, steps, seed, known=known, workers=workers)
        verdicts = []
        if faults:
            verdicts = study.verdicts(scene, response, faults, seed, known=known, workers=workers, dask=dask, progress=in_part(0.7, 0.9))
        kinds = study.RESIDUALS if hours else {}
        alarms = {name: study.false_alarms(scene, hours, *kind, seed) for name, kind in kinds.items()}
    if as_json:
        steps_found = [each._asdict() for each in detected]
        verdicts_json = [{**each._asdict(), "fault": each.fault._asdict()} for each in verdicts]
        numbers = {"scene": scene.name, **found._asdict(), "steps": steps_found, "faults": verdicts_json}
        print_json({**numbers, "hours_of_residuals": hours, "false_alarms": alarms})
    else:
        _print(scene, found, detected, hours, alarms)
        _print_faults(study.confusion(verdicts), verdicts)


def _require_sensors(scene, measured) -> None:
    """Raise `UsageError` where the scene computes nothing that a sensor could be compared with."""
    if "temperatures" in measured and scene.heat.law != "network":
        raise UsageError(f"--measure temperatures: {scene.name} computes no ring temperatures; give it heat.law: network, or leave the option away")


def _require_varied(scene, response, measured) -> None:
    """Raise `UsageError` where a measured clearance says nothing, because no uncertain field changes it."""
    from bearing_sim.watchers.estimation.response import ANSWERS

    if "clearance" in measured and ANSWERS.index("running_clearance") not in response.varied_answers():
        raise UsageError(
            f"--measure clearance: no uncertain field of {scene.name} changes its running clearance, so that measuring it says nothing; give a "
            "dimension or a fit a range, such as --set uncertainty.bearing.clearance='[37 um, 47 um]', or leave the option away"
        )


def _print_faults(table, verdicts) -> None:
    """Print which cause was named for which fault."""
    names = list(dict.fromkeys([*table, *(name for counts in table.values() for name in counts)]))
    rows = []
    for group, counts in table.items():
        mine = [one for one in verdicts if one.fault.group == group]
        named = ", ".join(f"{name} {counts[name]}" for name in sorted(names, key=lambda name: -counts[name]) if counts[name])
        evidences = [one.evidence for one in mine if not math.isnan(one.evidence)]
        evidence = f"{statistics.median(evidences):.0f}" if evidences else "-"
        size, clear = 100 * statistics.median(one.size for one in mine), sum(one.told_apart for one in mine)
        rows.append((f"{group} ({mine[0].fault.what})", f"{size:.2f} points", f"{counts[group]} of {len(mine)}", str(clear), evidence, named))
    if rows:
        columns = ("hidden fault", "changes slip by", "named first", "told apart", "evidence [ln]", "what was named")
        print_rows("causes that were named for hidden faults", columns, rows)


def _print(scene, found, detected, hours, alarms) -> None:
    early, late = (f"{100 * value:.1f} %" for value in found.slip_coverage)
    rows = [
        ("machines", f"{found.runs}, {found.hours:.3g} h in all"),
        ("hidden fields within their 90 % intervals", f"{100 * found.field_coverage:.1f} %"),
        ("slip within its 90 % interval, new at an operating point", early),
        ("slip within its 90 % interval, a minute later", late),
        *((f"error of slip, {when}: calibrated, stated, open loop", _points(found, k)) for k, when in enumerate(("new", "a minute later"))),
        ("machines worse than open loop by more than is stated", f"{found.worse_runs} of {found.runs}"),
        ("single predictions worse than open loop by more than is stated", f"{found.worse_instants} of {found.instants}"),
        ("the same, if predictions were exactly as sure as they say", f"{found.worse_expected:.1f}"),
        ("processor time at 10 Hz", f"{100 * found.core:.2f} % of a core"),
        ("alarms though nothing stepped", str(found.alarms)),
    ]
    if detected:
        times = [each.seconds for each in detected]
        missed = sum(math.isnan(each) for each in times)
        slowest = max((each for each in times if not math.isnan(each)), default=math.nan)
        rows += [
            (f"steps of the mixture fraction, {_STEP[0]:g} to {_STEP[1]:g}, found", f"{len(times) - missed} of {len(times)}"),
            ("slowest of them", f"{slowest:.3g} s"),
            ("oil quantity named first, or not told apart from what is", f"{sum(each.rank == 1 or not each.told_apart for each in detected)}"),
        ]
    rows += [(f"false alarms in {hours:g} h of {name}", str(count)) for name, count in alarms.items()]
    print_table(f"{scene.name}: calibration of machines with hidden fields", rows)
    fields = [(name, f"{100 * coverage:.0f} %", f"{100 * width:.0f} %") for name, (coverage, width) in found.by_field.items()]
    print_rows("fields", ("field", "within its 90 % interval", "its width, of that of the range"), fields)


def _points(found, k: int) -> str:
    return ", ".join(f"{100 * values[k]:.3f}" for values in (found.error, found.stated, found.open_loop)) + " points"
