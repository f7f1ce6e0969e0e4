# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim table``: the table of operating points of level ``steady``."""

import math
from pathlib import Path

from click import IntRange

from bearing_sim.cli.options import PATH, flag, json_option, option, removed_option, scene_options
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    as_usage_error,
    attributes,
    note,
    print_table,
    progress_bar,
    scene_of,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.display import SHOWN, force, number, quantity_text, shown

_AGAINST_SLIP = "bearing-sim trade SCENE --level steady --against slip, or, from a checkout, python test/validation against-slip SCENE"


@command("table")
@scene_options
@flag("--rebuild", "Build the table even if it exists.")
@option("--workers", "Number of threads [default: all cores].", IntRange(1, 256), metavar="N")
@option("--at", "points", "Show this operating point, interpolated and solved; can be repeated.", multiple=True, metavar="RPM,N[,DEGC[,DEG]]")
@option("-o", "--out", "Also write the table to this file, for another machine.", OutputFile(), metavar="FILE.npz")
@option("--from", "shared", "Build nothing: keep the table that another machine has written for this scene with -o.", PATH, metavar="FILE.npz")
@removed_option("--against-slip", _AGAINST_SLIP)
@removed_option("--seed", _AGAINST_SLIP)
@flag("--bands", "Instead build the response to the uncertain fields, from which bands and calibration follow, or show it.")
@option("--dask", "Compute that response on this Dask cluster, such as tcp://10.0.0.1:8786.", metavar="ADDRESS")
@json_option
def table(scene_name, overrides, rebuild, workers, points, out, shared, bands, dask):
    """Build the table of operating points of SCENE at level steady, or show the existing one.

    Its range is given in the scene's block `table` (maximum_speed, maximum_load, minimum_temperature, maximum_temperature, tolerance);
    it covers all directions of the load. A point of --at is as warm as a run there: with heat.law network in thermal equilibrium.
    """
    scene = scene_of(scene_name, overrides, "steady")
    if bands and (out is not None or shared is not None):
        raise UsageError("-o and --from are for the table itself; leave --bands out")
    if shared is not None and rebuild:
        raise UsageError("--from takes a table that has been built; leave --rebuild out")
    if bands:
        if points:
            raise UsageError("--bands goes with --rebuild, --workers and --dask only; leave --at out")
        return _response(scene, rebuild, workers, dask)
    if dask is not None:
        raise UsageError("--dask goes with --bands only: the table itself is built by the threads of this machine; leave --dask out, or add --bands")
    asked = [_condition(text, scene) for text in points]
    if shared is not None:
        from bearing_sim.levels.steady.shared_table import take_table

        table, quality = take_table(shared, scene)
    else:
        announce_compilation(scene)
        table, quality = build_with_progress(scene, None, workers, rebuild)
    if out is not None:
        from bearing_sim.levels.steady.shared_table import shared_table

        out.write_bytes(shared_table(scene, table, quality))
    report = _report(scene, table, quality, [_answers(scene, table, condition) for condition in asked])
    return Result(report, lambda: _print(report))


def _response(scene, rebuild, workers, dask) -> Result:
    """Build the response of a scene to its uncertain fields, or take the one that is kept, and show what it is good for."""
    from bearing_sim.cli.estimation import response_with_progress
    from bearing_sim.watchers.estimation.response import bundled_path, response_path

    announce_compilation(scene)
    found = response_with_progress(scene, rebuild, workers, dask)
    places = response_path(scene), bundled_path(scene)
    domain, path = found.domain, str(next(filter(Path.exists, places), places[0]))
    report = {"scene": scene.name, "file": path, "fields": list(found.names), "domain": domain._asdict(), **attributes(found, "points", "seconds")}
    rpm, celsius = [speed * 30 / math.pi for speed in domain.speeds], [kelvin - 273.15 for kelvin in domain.temperatures]
    rows = [
        ("uncertain fields", ", ".join(found.names)),
        ("shaft speed", f"up to {number(rpm[1], 6)} rpm"),
        ("radial load", f"up to {force(domain.loads[1])}"),
        ("oil temperature", f"{number(celsius[0])} to {number(celsius[1])} °C"),
        ("built", f"from {found.points} settled points in {found.seconds:.3g} s; {path}"),
    ]
    return Result(report, lambda: print_table(f"response of {scene.name} to its uncertain fields", rows))


def build_with_progress(scene, temperatures=None, workers=None, rebuild=False):
    """Return a scene's table and its quality, from disk or newly built; reports building on stderr.

    Parameters
    ----------
    scene : the scene.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    workers : number of threads; None: all cores.
    rebuild : whether to build it even if it exists.
    """
    from bearing_sim.levels.steady.table_builder import cached_table, obtain_table
    from bearing_sim.studies.correction_points import obtain_correction

    kept = None if rebuild else cached_table(scene, temperatures)
    if kept is not None:
        return kept
    note(f"building the table of operating points of {scene.name}, once for this bearing and oil ...")
    correction = None
    if (level := scene.table.correction) != "none":
        with as_usage_error(ValueError), progress_bar(f"operating points at level {level}", 1.0) as show:
            correction = obtain_correction(scene, temperatures, workers, lambda done, most: show(done / most), rebuild)
    with progress_bar("operating points", 1.0) as show:
        return obtain_table(scene, temperatures, workers, lambda done, most: show(done / most), rebuild, correction and (lambda: correction))


def _condition(text, scene) -> tuple[float, float, float, float]:
    """Return shaft speed, load, oil temperature and direction of the load in SI from ``RPM,N[,DEGC[,DEG]]``."""
    try:
        numbers = [float(part) for part in text.split(",")]
        if not 2 <= len(numbers) <= 4 or not all(map(math.isfinite, numbers)):
            raise ValueError
    except ValueError:
        raise UsageError(f"--at {text}: expected speed [rpm], load [N], optionally oil temperature [degC], load direction [deg]") from None
    kelvin = numbers[2] + 273.15 if len(numbers) > 2 else scene.lubricant.temperature
    angle = math.radians(numbers[3]) if len(numbers) > 3 else scene.operating.load_angle
    return numbers[0] * math.pi / 30, numbers[1], kelvin, angle


def _answers(scene, table, condition) -> dict:
    """Return the solved and the interpolated answer at a condition, as warm as a run is there."""
    from bearing_sim.levels.steady.operating_point import ANSWER
    from bearing_sim.levels.steady.table_builder import holds, look_up
    from bearing_sim.model.sample import NODE_OBSERVABLES
    from bearing_sim.simulation import Inputs
    from bearing_sim.studies.sheet import temperatures
    from bearing_sim.sweep.thermal import operating_state, solved_answer, table_condition

    speed, load, kelvin, angle = condition
    inputs = Inputs(speed, load * math.cos(angle), load * math.sin(angle), kelvin)
    state = operating_state(scene, inputs)
    place = table_condition(state, inputs)
    solved, interpolated = solved_answer(state, inputs), look_up(table, [place])[0]
    named = {name: [float(interpolated[column]), float(solved[column])] for name, column in ANSWER._asdict().items()}
    where = _place(*condition)
    where |= temperatures(dict(zip(NODE_OBSERVABLES, state.temperatures.tolist())))
    return {**where, "held": holds(table, *place[:3], growth=place[4]), "table_and_solution": named}


def _report(scene, table, quality, answers) -> dict:
    from bearing_sim.levels.steady.table_builder import table_path
    from bearing_sim.model.table_span import span_of

    return {
        "scene": scene.name,
        "file": str(table_path(scene, span_of(scene))),
        "megabytes": table.nodes.nbytes / 1e6,
        "speeds_rpm": [speed * 30 / math.pi for speed in table.speeds.tolist()],
        "loads": table.loads.tolist(),
        "oil_temperatures_c": [kelvin - 273.15 for kelvin in table.temperatures.tolist()],
        "load_angles_deg": [math.degrees(angle) for angle in table.angles.tolist()],
        "period_deg": math.degrees(table.period),
        "both_senses": not math.isnan(table.mirror) or table.nodes.shape[0] == 2,
        **quality._asdict(),
        "correction": _correction_of(scene),
        "points": answers,
    }


def _correction_of(scene) -> dict | None:
    """Return what the correction of a scene's table was measured from and how sure it is, or None where there is none."""
    from bearing_sim.watchers.estimation.correction import correction_domain, correction_path, read_correction

    found = read_correction(correction_path(scene, correction_domain(scene))) if scene.table.correction != "none" else None
    if found is None:
        return None
    return attributes(found, "failed", "seconds", "slip_error", "life_error") | {
        "level": scene.table.correction,
        "points": len(found.conditions),
        "two_states": [
            _place(speed, load, kelvin, angle) | {"slip": own, "slip_from_more": other}
            for speed, load, kelvin, angle, own, other in found.two_states.tolist()
        ],
    }


def _place(speed, load, kelvin, angle) -> dict:
    """Return an operating point for JSON, in the units of its names."""
    return {"speed_rpm": speed * 30 / math.pi, "load": load, "oil_temperature_c": kelvin - 273.15, "load_angle_deg": math.degrees(angle)}


def _row_of(name, of_table, solved) -> tuple[str, str]:
    """Return the row of a quantity that the table and the solver answer."""
    return shown(name).name, f"{quantity_text(name, of_table)} (solved: {quantity_text(name, solved)})"


def _print(report) -> None:
    from bearing_sim.studies.sheet import temperatures_text

    def spanned(values, unit):
        ends = f"{number(values[0], 6)} to {number(values[-1], 6)} {unit}, {len(values)} knots"
        return ends if len(values) > 1 else f"{number(values[0], 6)} {unit} only"

    print_table(
        f"operating points of {report['scene']}",
        [
            ("shaft speed", spanned(report["speeds_rpm"], "rpm") + (", both directions" if report["both_senses"] else ", forward only")),
            ("radial load", spanned(report["loads"], "N")),
            ("oil temperature", spanned(report["oil_temperatures_c"], "°C")),
            ("load direction", f"all; {len(report['load_angles_deg'])} knots on {number(report['period_deg'], 6)}°"),
            ("nodes", f"{report['nodes']}, {report['missing']} without a solution; {report['megabytes']:.3g} MB; {report['file']}"),
            ("built", f"from {report['solved']} operating points in {report['seconds']:.3g} s"),
            ("requested tolerance", f"{100 * report['tolerance']:.3g} % of life, and of slip plus 0.025 points"),
            ("met", f"at {100 * report['within']:.4g} % of random points in the table"),
            ("error of slip", f"{100 * report['slip_error']:.3f} points at most, 95 % below {100 * report['slip_error_95']:.3f}"),
            ("error of life", f"{100 * report['life_error']:.2f} % at most, 95 % below {100 * report['life_error_95']:.2f}"),
        ],
    )
    if report["correction"] is not None:
        _print_correction(report["correction"])
    for point in report["points"]:
        rows = [_row_of(name, *both) for name, both in point["table_and_solution"].items() if name in SHOWN]
        rows += [("temperatures", warmth)] if (warmth := temperatures_text(point)) else []
        where = f"{number(point['speed_rpm'], 6)} rpm, {force(point['load'])}, {number(point['oil_temperature_c'], 4)} °C, "
        where += f"load towards {number(point['load_angle_deg'], 4)}°"
        print_table(where + ("" if point["held"] else ": outside the table"), rows)


def _print_correction(report) -> None:
    """Print how sure a correction is, and where level planar has two states."""
    rows = [
        ("measured", f"at {report['points']} operating points in {report['seconds']:.3g} s; {report['failed']} more have no answer"),
        ("error of slip", f"{100 * report['slip_error']:.3f} points, root mean square at points left out"),
        ("error of life", f"{100 * report['life_error']:.2f} %, likewise"),
    ]
    if states := report["two_states"]:
        speeds, loads = ([state[name] for state in states] for name in ("speed_rpm", "load"))
        example = states[len(states) // 2]
        spans = f"{number(min(speeds), 5)} to {number(max(speeds), 5)} rpm and {force(min(loads), 3)} to {force(max(loads), 3)}"
        rows += [
            (
                "two states",
                f"at {len(states)} points, {spans}",
            ),
            (
                "",
                f"such as {100 * example['slip']:.1f} % from ideal rolling, which the table has, and {100 * example['slip_from_more']:.1f} % from "
                f"more slip at {number(example['speed_rpm'], 5)} rpm and {force(example['load'], 3)}",
            ),
        ]
    print_table(f"correction by level {report['level']}", rows)
