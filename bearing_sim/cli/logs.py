# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim import-csv``: turn a measured table into an MCAP log."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import BadInput, print_json, print_table, progress_bar, tell_replacement, told_as_bad_input, told_file_faults


@click.command("import-csv")
@click.argument("data", type=click.Path(path_type=Path), metavar="DATA.csv")
@click.argument("mapping_name", metavar="MAPPING")
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), metavar="OUT.mcap", help="Log of shaft speed and radial load.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(data, mapping_name, out, as_json):
    """Turn DATA.csv into an MCAP log that `bearing-sim replay` reads.

    MAPPING is a YAML file, or the name of a bundled one, that says which columns are time, speed and load, in which units.
    Gaps, repeated or backward times, empty cells and cells that are no numbers are told by line number and counted; such
    rows or messages are left out, nothing is filled in.
    """
    from bearing_sim.csv_import import TableError, read_table, write_log
    from bearing_sim.csv_mapping import MappingError, load_mapping

    with told_as_bad_input(MappingError, TableError), told_file_faults():
        if out.exists() and data.exists() and out.samefile(data):
            raise BadInput(f"{out} is the table itself; write to another file")
        tell_replacement(out)
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
        "refused_lines": {code: [line for line, _ in told] for code, told in table.told.items()},
        "gaps": len(table.gaps),
        "gap_lines": [line for _, line, _ in table.gaps[:5]],
        "longest_gap_seconds": max((seconds for _, _, seconds in table.gaps), default=0.0),
        "gap_above_seconds": table.longest_step,
        "start_ns": start,
        "duration_seconds": (end - start) * 1e-9,
    }


def _print(table, mapping, data, out) -> None:
    start, end = _span(table)
    rows = [("rows", f"{table.rows}" + (f", and {table.left_out} of no concern to this mapping" if mapping.only else ""))]
    rows += [(f"{channel} messages", str(len(stamps))) for channel, stamps in table.stamps.items()]
    for code, told in table.told.items():
        count = table.refused[code]
        more = f"; and {count - len(told)} more" if count > len(told) else ""
        rows.append((f"refused: {code}", f"{count}: " + "; ".join(f"line {line}: {text}" for line, text in told) + more))
    if not table.told:
        rows.append(("refused", "none"))
    gaps = [f"{channel}, line {line}: {seconds:.6g} s" for channel, line, seconds in table.gaps[:5]]
    more = [f"and {len(table.gaps) - 5} more"] if len(table.gaps) > 5 else []
    rows.append((f"gaps above {table.longest_step:.6g} s", f"{len(table.gaps)}" + (": " + "; ".join(gaps + more) if gaps else "")))
    rows += [("duration", f"{(end - start) * 1e-9:.6g} s"), ("log", str(out))]
    print_table(f"{data.name} by {mapping.name}", rows)
