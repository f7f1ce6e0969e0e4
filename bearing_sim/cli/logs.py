# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Commands that write input logs: ``import-csv`` from a measured table, and ``mission`` from the bundled mission."""

from datetime import UTC

import click
from click import Choice, DateTime, FloatRange

from bearing_sim.cli.options import PATH, allow_outside_option, flag, json_option, option, set_option
from bearing_sim.cli.outputs import OutputRecording
from bearing_sim.cli.reporting import (
    FailedRun,
    UsageError,
    as_usage_error,
    attributes,
    note,
    print_table,
    progress_bar,
    tell_use,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.loader import did_you_mean, load_scene


@command("import-csv")
@click.argument("data", type=PATH, metavar="DATA.csv")
@click.argument("mapping_name", metavar="[MAPPING]", required=False)
@option("-o", "--out", "Log of shaft speed and radial load; with --guess the mapping, OUT.yaml.", OutputRecording(), metavar="OUT.mcap")
@flag("--guess", "guesses", "Instead of importing, guess a mapping from the headings, and say why and what is not clear.")
@option("--load", "Radial load throughout, such as 800N, where none was measured.", metavar="FORCE")
@option("--speed", "Shaft speed throughout, such as 1500rpm, likewise.", metavar="SPEED")
@option("--oil-temperature", "Oil temperature throughout, such as 60degC, likewise.", metavar="TEMPERATURE")
@option("--delimiter", "Between cells, or tab; instead of the mapping's, or the one that is found.", metavar="CHARACTER")
@option("--decimal", "Decimal mark of numbers, likewise.", Choice([".", ","]))
@option("--only", "Only rows with this text in a column, such as Turbine=T01; can be repeated.", multiple=True, metavar="HEADING=TEXT")
@option("--set", "overrides", "Override a field of the mapping; can be repeated.", multiple=True, metavar="FIELD=VALUE")
@option("--column", "columns", "With --guess: the column of time, shaft_speed, radial_load ...", multiple=True, metavar="FIELD=HEADING")
@option("--unit", "units", "With --guess: the unit of a column, such as shaft_speed=rpm, time=ms.", multiple=True, metavar="FIELD=UNIT")
@option("--sheet", "Of a workbook (.xlsx) with several.", metavar="NAME")
@option("--time-format", "With --guess: how times are written, such as '%d/%m/%Y %H:%M:%S', or iso.", metavar="FORMAT")
@json_option
def import_csv(
    data, mapping_name, out, guesses, load, speed, oil_temperature, delimiter, decimal, only, overrides, columns, units, sheet, time_format
):
    """Convert DATA.csv to an MCAP log for `bearing-sim replay`.

    MAPPING is a YAML file, or the name of a bundled one, that says which columns hold time, speed and load, in which units.
    Comment lines, delimiter, decimal mark and encoding are found in the file where MAPPING does not give them, and printed.
    Gaps, repeated or decreasing times, empty cells and cells that are not numbers are counted and reported by line number; the rows or
    messages concerned are left out, nothing is filled in, and the exit code is 3. With --guess a mapping is proposed, printed, and written
    to -o; nothing is imported, and what may mean two things is asked for (exit code 1).
    """
    from bearing_sim.inputs.csv_import import load_mapping, read_table, write_log

    given = {"shaft_speed": speed, "radial_load": load, "oil_temperature": oil_temperature}
    if delimiter is not None and delimiter != "tab" and len(delimiter) != 1:
        raise UsageError(f"--delimiter {delimiter!r}: expected one character, such as ';', or tab")
    if guesses:
        if mapping_name or overrides:
            raise UsageError("--guess makes a mapping; give none, and no --set")
        chosen = _pairs("--column", columns, _FIELDS), _pairs("--unit", units, _FIELDS)
        return _guess(data, out, *chosen, _constants(given), delimiter, decimal, time_format, _pairs("--only", only), sheet or "")
    if columns or units or time_format:
        raise UsageError("--column, --unit and --time-format go with --guess; a mapping is changed with --set, such as --set shaft_speed.unit=rpm")
    if not mapping_name:
        raise UsageError(f"no MAPPING: it says which columns are what; propose one with: bearing-sim import-csv --guess {data} -o mapping.yaml")
    if out is None:
        raise UsageError("no output file; give -o OUT.mcap")
    overrides = [*overrides, *(f"{name}={_flow(tree)}" for name, tree in _constants(given).items())]
    if only:
        overrides.append(f"only={_flow(_pairs('--only', only))}")
    overrides += [f"{name}={_flow(text)}" for name, text in (("delimiter", delimiter), ("decimal", decimal), ("sheet", sheet)) if text is not None]
    mapping, text = load_mapping(mapping_name, overrides)
    table = read_table(data, mapping)
    out.check()  # again, now that mapping and table have been read
    with progress_bar(f"importing {data.name}", sum(map(len, table.stamps.values()))) as progress:
        write_log(table, text, data, out.path, progress, replace=out.force)
    tell_use(table.tally, data)
    return Result(_report(table, mapping, out), lambda: _print(table, mapping, data, out))


def _constants(given) -> dict[str, dict]:
    """Return what stands in a mapping for inputs that are constant, by field, from the texts of options; None for an option not given."""
    from bearing_sim.inputs.log import constant

    with as_usage_error(ValueError):
        for name, text in given.items():
            if text is not None:
                constant(name, text)
    trees = {name: {"law": "constant", "value": text} if name == "radial_load" else {"constant": text} for name, text in given.items()}
    return {name: trees[name] for name, text in given.items() if text is not None}


def _flow(value) -> str:
    """Return a value as YAML on one line."""
    import json

    return json.dumps(value, ensure_ascii=False)  # JSON is YAML


_FIELDS = (
    "time",
    "shaft_speed",
    "radial_load",
    "oil_temperature",
    "inner_ring_temperature",
    "outer_ring_temperature",
    "cage_speed",
    "running_clearance",
)


def _pairs(option, texts, known=()) -> dict[str, str]:
    """Return the pairs of an option that is repeated, ``NAME=VALUE``; ``known`` names, if they are not free."""
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not name or not equals or not value:
            raise UsageError(f"{option} {text}: expected {'FIELD' if known else 'HEADING'}=VALUE")
        if known and name not in known:
            raise UsageError(f"{option} {text}: no field {name!r}{did_you_mean(name, known)}; expected one of {', '.join(known)}")
        found[name] = value
    return found


def _guess(data, out, *decided) -> Result:
    """Return a proposal for a mapping, and write it if there is a file for it; the command ends with `FailedRun` if something has to be decided.

    Parameters
    ----------
    data, out : the table, and the file of the mapping or None.
    decided : the further arguments of `bearing_sim.inputs.csv_guess.guess`.
    """
    from bearing_sim.inputs.csv_guess import guess

    if out is not None and out.path.suffix.lower() not in (".yaml", ".yml"):
        raise UsageError(f"-o {out}: a mapping is a YAML file; expected a name that ends in .yaml")
    found = guess(data, *decided)
    if out is not None:
        out.write_text(found.text)
    asked = "\n".join(f"  {name}: {question}" for name, question in found.questions.items())

    def show():
        click.echo(found.text, nl=False)
        if out is not None:
            note(f"{out}: check it, then: bearing-sim import-csv {data} {out} -o {data.with_suffix('.mcap').name}")

    return Result(
        attributes(found, "reasons", "questions") | {"mapping": found.tree, "not_used": found.left, "out": out and str(out)},
        show,
        ending=FailedRun(f"the mapping is not complete; decide:\n{asked}") if asked else None,
    )


def _span(table) -> tuple[int, int]:
    return min(stamps[0] for stamps in table.stamps.values()), max(stamps[-1] for stamps in table.stamps.values())


def _report(table, mapping, out) -> dict:
    start, end = _span(table)
    return {
        "mapping": mapping.name,
        "out": str(out),
        "read": table.tally.report(),
        "rows_left_out": table.left_out,
        "messages": {channel: len(stamps) for channel, stamps in table.stamps.items()},
        "refused_lines": {kind: [line for line, _ in examples] for kind, examples in table.examples.items()},
        "gaps": len(table.gaps),
        "gap_lines": [line for _, line, _ in table.gaps[:5]],
        "longest_gap_seconds": max((seconds for _, _, seconds in table.gaps), default=0.0),
        "gap_above_seconds": table.longest_step,
        "spacing_seconds": table.spacing,
        "found_in_file": table.notes,
        "start_ns": start,
        "duration_seconds": (end - start) * 1e-9,
    }


def _print(table, mapping, data, out) -> None:
    from bearing_sim.scene.display import number

    start, end = _span(table)
    rows = [("used", table.tally.counts + (f"; {table.left_out} more do not concern this mapping" if mapping.only else ""))]
    rows += [("found in the file", note) for note in table.notes]
    rows += [(f"{channel} messages", number(len(stamps), 9)) for channel, stamps in table.stamps.items()]
    for kind, examples in table.examples.items():
        (line, text), *others = examples
        more = f"; so lines {', '.join(str(other) for other, _ in others)}" if others else ""
        more += f" and {number(table.tally.refused[kind] - len(examples), 9)} more" if table.tally.refused[kind] > len(examples) else ""
        rows.append((f"refused: {kind}", f"{number(table.tally.refused[kind], 9)}: line {line}: {text}{more}"))
    gaps = [f"{channel}, line {line}: {seconds:.6g} s" for channel, line, seconds in table.gaps[:5]]
    more = [f"and {len(table.gaps) - 5} more"] if len(table.gaps) > 5 else []
    rows.append((f"gaps above {table.longest_step:.6g} s", f"{len(table.gaps)}" + (": " + "; ".join(gaps + more) if gaps else "")))
    rows += [("duration", f"{number((end - start) * 1e-9, 6)} s, a row every {table.spacing:.4g} s"), ("log", str(out))]
    print_table(f"{data.name} by {mapping.name}", rows)
    note(f"next: bearing-sim replay {out} --scene SCENE.yaml -o run.mcap; of a long log: bearing-sim spectrum SCENE.yaml {out}")


@command("mission")
@option("-o", "--out", "Log of the inputs.", OutputRecording(), required=True, metavar="OUT.mcap")
@option("--duration", "Duration; all phases scale with it.", FloatRange(1, 3600), default=60.0, metavar="S")
@option("--rate", "Rate of the speed and load messages.", FloatRange(1, 2000), default=50.0, metavar="HZ")
@option("--start", "Start time in UTC, such as 2027-01-31 or 2027-01-31T08:00:00 [default: now].", DateTime(), metavar="TIME")
@option("--cage", "machine", "Also write a measured cage speed: that of this scene's model, with noise.", metavar="SCENE")
@set_option
@allow_outside_option
@json_option
def mission(out, duration, rate, start, machine, overrides):
    """Write the synthetic mission: start, idle, take-off at 45,000 rpm, cruise, light-load descent with a gust, stop.

    It is invented, not measured, and meant for demonstrations only; so is the cage speed that --cage adds at 10 Hz: a model plays the machine, with
    noise of 0.2 points of slip. With other values than those of the scene that is calibrated (--set), the calibration has something to find.
    """
    import time

    from bearing_sim.inputs.mission import write_mission

    if overrides and machine is None:
        raise UsageError("--set changes the scene of --cage; give that, too")
    scene = load_scene(machine, overrides) if machine is not None else None
    start_ns = time.time_ns() if start is None else int(start.replace(tzinfo=UTC).timestamp()) * 1_000_000_000
    out.check()  # again, now that the scene has been read
    with progress_bar("writing the mission", duration) as progress:
        messages = write_mission(out.path, start_ns, duration, rate, progress, replace=out.force, machine=scene)
    report = {"out": str(out), "synthetic": True, "duration_seconds": duration, "rate": rate, "messages": messages, "start_ns": start_ns}
    cage = f", and a synthetic measured cage: the model of {scene.name} with noise" if scene is not None else ""
    text = f"{out}: synthetic mission of {duration:g} s, {messages} messages of shaft speed, radial load and oil temperature{cage}"
    return Result({**report, "cage": scene and scene.name}, lambda: click.echo(text))
