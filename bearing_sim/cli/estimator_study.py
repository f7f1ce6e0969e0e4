# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study estimator``: how good the calibration of a running model is."""

import math

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
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0), help="Seed of the machines and of the noise.")
@executor_options
@json_option
def estimator(scene_name, overrides, runs, steps, hours, seed, workers, dask, as_json):
    """Let the estimator calibrate SCENE to machines whose hidden fields are known, and count how often it is right.

    Level steady plays the machines: fields drawn from the ranges of the scene that wander, on a course of twelve plateaus of a minute, with a
    cage sensor that has noise (0.2 points at 10 Hz), drift, 1 % wild readings and silences.  Without estimation.calibrated all uncertain fields
    are calibrated; without a wander time in --set they wander by one standard deviation in two hours.
    """
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.scene.uncertainty import ranges_of
    from bearing_sim.studies.uncertainty import UncertaintyError
    from bearing_sim.sweep.tasks import ClusterError, JournalInUse

    with as_usage_error(SceneError):
        scene = load_scene(scene_name, ["level=steady", *overrides])
        fields = [one.field for one in ranges_of(scene) if one.field != _OIL and not one.field.startswith("operating.")]
        more = [] if scene.estimation.calibrated else [f"estimation.calibrated=[{', '.join(fields)}]"]
        more += [] if any("wander_time" in each for each in overrides) else ["estimation.drift.wander_time=2 h"]
        scene = load_scene(scene_name, ["level=steady", *overrides, *more])
    announce_compilation()
    from bearing_sim.studies import estimator as study
    from bearing_sim.studies.response import obtain_response

    known = (_OIL,)
    with as_usage_error(UncertaintyError, ClusterError, JournalInUse), progress_bar("estimator", 1.0) as show:

        def in_part(first: float, last: float):
            return lambda done, total: show(first + (last - first) * done / max(total, 1))

        response = obtain_response(scene, workers, dask, in_part(0.0, 0.3))
        machines = study.machines(scene, response, runs, seed, known=known, workers=workers, dask=dask, progress=in_part(0.3, 0.5))
        if not machines:
            raise UsageError("no machine of this scene settles at all of its operating points; give narrower ranges")
        judged = []
        for number, machine in enumerate(machines):
            judged.append(study.judge(scene, response, machine, seed + number, known))
            in_part(0.5, 0.8)(number + 1, len(machines))
        found = study.findings(response, judged, scene.estimation.calibrated)
        detected = []
        if steps and _QUANTITY in response.names:
            detected = study.detections(scene, response, _QUANTITY, _STEP, steps, seed, known=known, workers=workers)
        show(0.9)
        kinds = study.RESIDUALS if hours else {}
        alarms = {name: study.false_alarms(scene, hours, *kind, seed) for name, kind in kinds.items()}
    if as_json:
        steps_found = [each._asdict() for each in detected]
        print_json({"scene": scene.name, **found._asdict(), "steps": steps_found, "hours_of_residuals": hours, "false_alarms": alarms})
    else:
        _print(scene, found, detected, hours, alarms)


def _print(scene, found, detected, hours, alarms) -> None:
    early, late = (f"{100 * value:.1f} %" for value in found.slip_coverage)
    rows = [
        ("machines", f"{found.runs}, {found.hours:.3g} h in all"),
        ("hidden fields within their 90 % intervals", f"{100 * found.field_coverage:.1f} %"),
        ("slip within its 90 % interval, new at an operating point", early),
        ("slip within its 90 % interval, a minute later", late),
        *((f"error of slip, {when}: calibrated, stated, open loop", _points(found, k)) for k, when in enumerate(("new", "a minute later"))),
        ("machines worse than open loop by more than is stated", f"{found.worse_runs} of {found.runs}"),
        ("single predictions worse than open loop by more than is stated", f"{100 * found.worse_instants:.2f} %"),
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
