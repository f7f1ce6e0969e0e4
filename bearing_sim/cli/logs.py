# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Commands that write input logs: ``import-csv`` from a measured table, and ``mission`` from the bundled mission."""

from datetime import UTC
from pathlib import Path

import click

from bearing_sim.cli.options import json_option
from bearing_sim.cli.reporting import UsageError, announce_replacement, as_file_error, as_usage_error, print_json, print_table, progress_bar


@click.command("import-csv")
@click.argument("data", type=click.Path(path_type=Path), metavar="DATA.csv")
@click.argument("mapping_name", metavar="MAPPING")
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), metavar="OUT.mcap", help="Log of shaft speed and radial load.")
@json_option
def import_csv(data, mapping_name, out, as_json):
    """Convert DATA.csv to an MCAP log for `bearing-sim replay`.

    MAPPING is a YAML file, or the name of a bundled one, that says which columns hold time, speed and load, in which units.
    Gaps, repeated or decreasing times, empty cells and cells that are not numbers are counted and reported by line number; the rows or
    messages concerned are left out, and nothing is filled in.
    """
    from bearing_sim.inputs.csv_import import TableError, load_mapping, read_table, write_log
    from bearing_sim.scene.loader import SceneError

    with as_usage_error(SceneError, TableError), as_file_error():
        if out.exists() and data.exists() and out.samefile(data):
            raise UsageError(f"{out} is the input table; choose another file")
        announce_replacement(out)
        mapping, text = load_mapping(mapping_name)
        table = read_table(data, mapping)
        with progress_bar(f"importing {data.name}", sum(map(len, table.stamps.values()))) as progress:
            write_log(table, text, data, out, progress)
    if as_json:
        print_json(_report(table, mapping, out))
    else:
        _print(table, mapping, data, out)


def _span(table) -> tuple[int, int]:
    return min(stamps[0] for stamps in table.stamps.values()), max(stamps[-1] for stamps in table.stamps.values())


def _report(table, mapping, out) -> dict:
    start, end = _span(table)
    return {
        "mapping": mapping.name,
        "out": str(out),
        "rows": table.rows,
        "rows_left_out": table.left_out,
        "messages": {channel: len(stamps) for channel, stamps in table.stamps.items()},
        "refused": table.refused.total(),
        "refused_by_reason": dict(table.refused),
        "refused_lines": {kind: [line for line, _ in examples] for kind, examples in table.examples.items()},
        "gaps": len(table.gaps),
        "gap_lines": [line for _, line, _ in table.gaps[:5]],
        "longest_gap_seconds": max((seconds for _, _, seconds in table.gaps), default=0.0),
        "gap_above_seconds": table.longest_step,
        "start_ns": start,
        "duration_seconds": (end - start) * 1e-9,
    }


def _print(table, mapping, data, out) -> None:
    start, end = _span(table)
    rows = [("rows", f"{table.rows}" + (f", and {table.left_out} that do not concern this mapping" if mapping.only else ""))]
    rows += [(f"{channel} messages", str(len(stamps))) for channel, stamps in table.stamps.items()]
    for kind, examples in table.examples.items():
        count = table.refused[kind]
        more = f"; and {count - len(examples)} more" if count > len(examples) else ""
        rows.append((f"refused: {kind}", f"{count}: " + "; ".join(f"line {line}: {text}" for line, text in examples) + more))
    if not table.examples:
        rows.append(("refused", "none"))
    gaps = [f"{channel}, line {line}: {seconds:.6g} s" for channel, line, seconds in table.gaps[:5]]
    more = [f"and {len(table.gaps) - 5} more"] if len(table.gaps) > 5 else []
    rows.append((f"gaps above {table.longest_step:.6g} s", f"{len(table.gaps)}" + (": " + "; ".join(gaps + more) if gaps else "")))
    rows += [("duration", f"{(end - start) * 1e-9:.6g} s"), ("log", str(out))]
    print_table(f"{data.name} by {mapping.name}", rows)


@click.command("mission")
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), metavar="OUT.mcap", help="Log of the inputs.")
@click.option("--duration", default=60.0, show_default=True, type=click.FloatRange(1, 3600), metavar="S", help="Duration; all phases scale with it.")
@click.option("--rate", default=50.0, show_default=True, type=click.FloatRange(1, 2000), metavar="HZ", help="Rate of the speed and load messages.")
@click.option("--start", type=click.DateTime(), help="Start time in UTC [default: now].")
@json_option
def mission(out, duration, rate, start, as_json):
    """Write the synthetic mission: start, idle, take-off at 45,000 rpm, cruise, light-load descent with a gust, stop.

    It is invented, not measured, and meant for demonstrations only.
    """
    import time

    from bearing_sim.inputs.mission import write_mission

    start_ns = time.time_ns() if start is None else int(start.replace(tzinfo=UTC).timestamp()) * 1_000_000_000
    announce_replacement(out)
    with as_file_error(), progress_bar("writing the mission", duration) as progress:
        messages = write_mission(out, start_ns, duration, rate, progress)
    if as_json:
        print_json({"out": str(out), "synthetic": True, "duration_seconds": duration, "rate": rate, "messages": messages, "start_ns": start_ns})
    else:
        click.echo(f"{out}: synthetic mission of {duration:g} s, {messages} messages of shaft speed, radial load and oil temperature")
