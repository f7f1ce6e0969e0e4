# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim state``: the stored states of bearings in service: show, export, fill by recordings, and adopt after a correction of the scene."""

from pathlib import Path

import click

from bearing_sim.cli.options import PATH, allow_outside_option, json_option, option, set_option
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import UsageError, as_usage_error, note, print_table, tell_use
from bearing_sim.cli.results import Result, command
from bearing_sim.files.outputs import remember_input
from bearing_sim.scene.display import number
from bearing_sim.watchers.stored_state.state_file import StateFile, checked_serial, default_path, known_serials, previous_path, read_state

_TABLES = (".csv", ".parquet")
_state_argument = click.argument("name", metavar="STATE")


def _path_of(name: str) -> Path:
    """Return the state file that a path or a serial number names; raise `UsageError` if there is none."""
    path = Path(name).expanduser()
    if path.exists() or previous_path(path).exists():
        return path
    own = default_path(checked_serial(name))
    if own.exists() or previous_path(own).exists():
        return own
    known = ", ".join(known_serials()) or "none"
    raise UsageError(f"{name}: neither a state file nor a serial number with a state in {own.parent}; there are {known}")


def _read(path: Path):
    """Return the state in a file; what had to be done about it is printed on stderr."""
    state, news = read_state(path)
    for each in news:
        note(f"warning: {each.text}")
    return state


def _days(path: Path, state) -> list[dict]:
    """Return the totals of all days, those in the history and those that are not there yet."""
    from bearing_sim.watchers.stored_state.history import all_days

    with as_usage_error(ValueError):
        return all_days(path, state)


@command("show")
@_state_argument
@json_option
def show(name):
    """Show the stored state of a bearing: life used, hours, starts, hours by regime, extremes, and what else is remembered.

    STATE is a state file, or a serial number whose state is in the user's folder for state. A node may use it meanwhile.
    """
    path = _path_of(name)
    state = _read(path)
    title = f"stored state of {state.serial or 'a bearing without a serial number'}"
    return Result({**state.as_mapping(), "file": str(path)}, lambda: print_table(title, _rows(path, state)))


def _rows(path: Path, state) -> list[tuple[str, str]]:
    from bearing_sim.messages.topics import ZERO_CELSIUS
    from bearing_sim.watchers.stored_state.state import time_text

    totals = state.totals
    rows = [
        ("file", f"{path}, write {state.writes}" + (f" of {time_text(state.written_ns)}" if state.written_ns else "")),
        ("bearing", f"{state.identity.get('bearing.name', 'not known yet')} in the scene {state.identity.get('name', 'not known yet')}"),
        ("life used", f"{number(100.0 * totals.damage, 6)} %; by the basic rating life {number(100.0 * totals.basic_damage, 6)} %"),
        ("running", f"{number(totals.running_seconds / 3600.0, 6)} h of {number(totals.monitored_seconds / 3600.0, 6)} h monitored"),
        ("revolutions", number(totals.revolutions, 6)),
        ("starts", str(totals.starts)),
        *_regimes(totals),
    ]
    if totals.largest_slip is not None:
        rows.append(("largest slip", f"{number(100.0 * totals.largest_slip.value)} % on {time_text(totals.largest_slip.time_ns)}"))
    if totals.lowest_clearance is not None:
        rows.append(("lowest clearance", f"{number(1e6 * totals.lowest_clearance.value)} µm on {time_text(totals.lowest_clearance.time_ns)}"))
    stretches = state.covered.stretches
    if stretches:
        rows.append(("counted", f"{time_text(stretches[0][0])} to {time_text(stretches[-1][1])}, with {len(stretches) - 1} gaps"))
    rows.append(("calibration", ", ".join(f"{name} {value:g}" for name, value in state.calibration.items()) or "none"))
    if state.estimates:
        time_ns, fields = state.estimates[-1]
        rows.append(("estimates", f"of {time_text(time_ns)}, 5 to 95 % in parentheses: {', '.join(_estimate(*each) for each in fields.items())}"))
    learned = [name.replace("_", " ") for name, each in state.learned.items() if each and name != "estimation"]
    rows.append(("learned residuals", ", ".join(learned) or "none"))
    if state.thermal is not None:
        rows.append(
            (
                "temperatures",
                f"of {time_text(state.thermal.time_ns)}: " + ", ".join(f"{kelvin - ZERO_CELSIUS:.1f} °C" for kelvin in state.thermal.nodes),
            )
        )
    if state.retired_ns is not None:
        rows.append(("taken out", time_text(state.retired_ns)))
    return rows


def _estimate(path: str, numbers) -> str:
    """Return a calibrated field with its band, in the unit in which it is shown."""
    from bearing_sim.scene.scene import Scene
    from bearing_sim.scene.uncertainty import quantities, shown

    value, low, high = (shown(quantities(Scene), path, number) for number in numbers)
    return f"{path} {value} ({low} to {high})"


def _regimes(totals) -> list[tuple[str, str]]:
    from bearing_sim.watchers.stored_state.totals import KAPPA_BOUNDS, LOAD_BOUNDS, SLIP_BOUNDS

    def hours(seconds, bounds, factor=1.0, unit=""):
        edges = [f"{factor * bound:g}{unit}" for bound in bounds]
        names = [f"below {edges[0]}", *(f"{low} to {high}" for low, high in zip(edges, edges[1:])), f"from {edges[-1]}", "unknown"]
        return ", ".join(f"{name} {number(each / 3600.0)} h" for name, each in zip(names, seconds) if each) or "none"

    return [
        ("running at slip", hours(totals.slip_seconds, SLIP_BOUNDS, 100.0, " %")),
        ("at kappa", hours(totals.lubrication_seconds, KAPPA_BOUNDS)),
        ("at P/C", hours(totals.load_seconds, LOAD_BOUNDS)),
    ]


@command("export")
@_state_argument
@option("-o", "--out", "JSON of the whole state, or the days as CSV or Parquet.", OutputFile(".json", *_TABLES), required=True, metavar="OUT")
def export(name, out):
    """Write a stored state to OUT.json, or its totals by UTC day to OUT.csv or OUT.parquet."""
    path = _path_of(name)
    remember_input(path)
    state, suffix = _read(path), out.path.suffix.lower()
    days = _days(path, state)
    if suffix == ".json":
        import json

        out.write_text(json.dumps({**state.as_mapping(), "history": days}, indent=1) + "\n")
    else:
        from bearing_sim.watchers.stored_state.history import export_days

        with out.draft() as draft:
            export_days(draft, days, as_parquet=suffix == ".parquet")
    return Result({}, remarks=[f"{out}: {len(days)} day{'s' * (len(days) != 1)}"])


@command("merge")
@_state_argument
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RUN.mcap...")
@json_option
def merge(name, recordings):
    """Fill gaps of a stored state by recordings of bearing-sim: each instant counts once, however often it is merged.

    The node must not use the state meanwhile. Logs of other programs are counted by `bearing-sim replay --state-file`.
    """
    from bearing_sim.recording.reader import Recording
    from bearing_sim.watchers.stored_state.merging import merge as fill

    path, filled = _path_of(name), {}
    for each in recordings:
        recording = Recording(each, allow_partial=True)
        filled[str(each)] = fill(path, recording)
        tell_use(recording.tally, each)
    state = _read(path)
    report = {"state": str(path), "damage": state.totals.damage, "merged": {run: each._asdict() for run, each in filled.items()}}
    rows = [
        (run, f"{number(each.recorded, 6)} s recorded, {number(each.added, 6)} s of them were missing: {number(100.0 * each.damage, 6)} % of life")
        for run, each in filled.items()
    ]
    rows.append(("life used", f"{number(100.0 * state.totals.damage, 6)} %"))
    return Result(report, lambda: print_table(f"merged into {path}", rows))


@command("adopt")
@_state_argument
@allow_outside_option
@option("--scene", "scene_name", "Bundled scene or YAML file that the state is to belong to.", required=True, metavar="SCENE")
@set_option
@option("--serial", "Serial number that the bearing is to have [default: its own].", default="", metavar="NUMBER")
def adopt(name, scene_name, overrides, serial):
    """Let a stored state belong to another scene, after a correction of the scene, or get another serial number.

    The totals stay: what was counted by the earlier scene is not computed again.
    """
    from bearing_sim.scene.loader import load_scene

    path = _path_of(name)
    scene, serial = load_scene(scene_name, overrides), checked_serial(serial)
    file = StateFile(path)
    try:
        state, _ = file.read()
        changes = state.differences(scene, serial)
        state.adopt(scene, serial)
        state.writes += 1
        file.write(state)
    finally:
        file.close()
    return Result({}, remarks=[f"{path}: {', '.join(changes) or 'nothing has changed'}"])
