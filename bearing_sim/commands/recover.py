# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim recover``: complete the recording of a killed writer."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import print_json, print_table, progress_bar, told_as_bad_input, told_file_faults


@click.command()
@click.argument("broken", type=click.Path(path_type=Path, dir_okay=False), metavar="BROKEN.mcap")
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), metavar="GOOD.mcap", help="The sound file; must not exist.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(broken, out, as_json):
    """Write all that can be read of BROKEN.mcap into GOOD.mcap: of a killed writer (RUN.mcap.active), cut short or damaged.

    Works with any MCAP file. Messages keep their bytes, times and order; BROKEN.mcap stays as it is.
    """
    from bearing_sim.recovery import RecoveryError, recover

    with told_as_bad_input(RecoveryError), told_file_faults(), progress_bar(f"recovering {broken.name}", 1.0) as progress:
        found = recover(broken, out, progress)
    lost = "nothing is known to be missing" if found.is_sound else found.ends or "some of it was damaged"
    if as_json:
        report = {"broken": str(broken), "out": str(out), "broken_size": found.size, "size": out.stat().st_size, "seconds": found.seconds}
        report |= {"messages": found.messages.total(), "messages_by_topic": dict(found.messages), "metadata": list(found.metadata)}
        print_json({**report, "damaged": found.damaged, "was_finished": found.is_finished, "ends": found.ends})
        return
    rows = [
        ("the file", f"{found.size / 1e6:.4g} MB; {lost}"),
        ("damaged chunks left out", str(found.damaged)),
        ("saved", f"{found.messages.total()} messages over {found.seconds:.6g} s, {len(found.metadata)} metadata records"),
        *((topic, f"{count} messages") for topic, count in sorted(found.messages.items())),
    ]
    print_table(f"{broken} recovered into {out}", rows)
