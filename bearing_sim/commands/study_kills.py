# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study kills``: how much a killed recording loses."""

import tempfile
from pathlib import Path

import click

from bearing_sim.commands.reporting import FailedRun, print_json, print_table

_PROMISE = 1.0  # [s]


@click.command()
@click.option("--kills", type=click.IntRange(min=1), default=60, show_default=True, metavar="N", help="How many recordings to kill.")
@click.option("--seed", type=int, default=1, show_default=True, help="Of the moments.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(kills, seed, as_json):
    """Kill recordings of all observables at 1 kHz at random moments (SIGKILL), recover every file, and say what was lost.

    In turn: the process that feeds, whose file the other one completes; the one that writes; both at once.

    Exit code 1 where a file lost more than 1 s or has a hole.
    """
    import numpy as np

    from bearing_sim.recovery import RecoveryError
    from bearing_sim.studies.kills import VICTIMS, kill_recordings

    with tempfile.TemporaryDirectory() as folder:
        try:
            told = kill_recordings(Path(folder), kills, seed, lambda text: click.echo(text, err=True))
        except RecoveryError as fault:
            raise FailedRun(str(fault)) from None
    lost = np.array([kill.lost for kill in told])
    holes = sum(kill.gaps for kill in told)
    report = {
        "kills": kills,
        "seed": seed,
        "recovered": len(told),
        "lost_median": float(np.median(lost)),
        "lost_most": float(lost.max()),
        "holes": holes,
    }
    if as_json:
        print_json({**report, "each": [kill._asdict() for kill in told]})
    else:
        by_victim = {victim: np.array([kill.lost for kill in told if kill.victim == victim]) for victim in VICTIMS}
        rows = [
            ("recovered", f"{len(told)} of {kills} files"),
            *(
                (f"lost, {victim} killed", f"median {np.median(some):.3f} s, most {some.max():.3f} s")
                for victim, some in by_victim.items()
                if len(some)
            ),
            ("samples missing before the last", str(holes)),
        ]
        print_table(f"recordings of all observables at 1 kHz, killed (seed {seed})", rows)
    if lost.max() > _PROMISE or holes:
        raise FailedRun(f"a killed recording lost {lost.max():.3f} s, {holes} samples are missing in between")
