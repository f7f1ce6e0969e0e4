# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim mission``: write the bundled synthetic mission as an MCAP log."""

from datetime import UTC
from pathlib import Path

import click

from bearing_sim.commands.reporting import print_json, progress_bar, tell_replacement, told_file_faults


@click.command()
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), metavar="OUT.mcap", help="Log of the inputs.")
@click.option("--duration", default=60.0, show_default=True, type=click.FloatRange(1, 3600), metavar="S", help="Length; all phases scale with it.")
@click.option("--rate", default=50.0, show_default=True, type=click.FloatRange(1, 2000), metavar="HZ", help="Messages a second of speed and load.")
@click.option("--start", type=click.DateTime(), help="UTC time of its beginning [default: now].")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(out, duration, rate, start, as_json):
    """Write the synthetic mission: start, idle, take-off at 45,000 rpm, cruise, light-load descent with a gust, stop.

    It is made up, measured nowhere, and good for demonstrations only.
    """
    import time

    from bearing_sim.mission import write_mission

    start_ns = time.time_ns() if start is None else int(start.replace(tzinfo=UTC).timestamp()) * 1_000_000_000
    tell_replacement(out)
    with told_file_faults(), progress_bar("writing the mission", duration) as progress:
        messages = write_mission(out, start_ns, duration, rate, progress)
    if as_json:
        print_json({"out": str(out), "synthetic": True, "duration_seconds": duration, "rate": rate, "messages": messages, "start_ns": start_ns})
    else:
        click.echo(f"{out}: synthetic mission of {duration:g} s, {messages} messages of shaft speed, radial load and oil temperature")
