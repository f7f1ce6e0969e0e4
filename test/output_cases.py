# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Every output of every command: options found in the tree of commands, and arguments with which each of them is tried."""

from typing import NamedTuple

import click

from bearing_sim.cli.main import main
from bearing_sim.cli.outputs import OutputFile

SCENE = "{scene}"  # names of inputs in arguments, see `Case`
LOG, RECORDING, BROKEN, MEASURED = "{log}", "{recording}", "{broken}", "{measured}"
DATA, MAPPING, TABLE, STATE = "{data}", "{mapping}", "{table}", "{state}"
_DESIGN = ("design", "deng2017_table1", "--low-radius", "34.86mm:34.865mm:2", "--d-value", "0.1mm:0.11mm:2")
_SHORT = ("--level", "steady", "--no-long", "--workers", "1")
_RANGE = "uncertainty.lubricant.mixture_fraction=[0.01, 0.9]"
_STEADY = ("--set", "level=steady")


class Case(NamedTuple):
    """How one command is tried.

    Attributes
    ----------
    arguments : with ``{...}`` for inputs; the output option is added to them.
    seconds : about how long it computes; the walk over failing writes does without those that take long.
    """

    arguments: tuple[str, ...]
    seconds: float = 1.0


CASES = {
    "run": Case(("run", SCENE, "--duration", "0.05"), 2),
    "replay": Case(("replay", LOG, "--scene", SCENE, "--set", "level=slip"), 5),
    "replay-fleet": Case(("replay-fleet", LOG, "--scene", SCENE, "--set", "level=slip", "--workers", "1"), 5),
    "spectrum": Case(("spectrum", SCENE, LOG, *_STEADY, "--classes", "1x1", "--workers", "1"), 2),
    "import-csv": Case(("import-csv", DATA, MAPPING)),
    "loads": Case(("loads", SCENE)),
    "table": Case(("table", SCENE), 20),
    "catalog": Case(("catalog", "NU 210")),
    "new": Case(("new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm", "--load", "5kN")),
    "machine": Case(("machine",)),
    "uncertainty": Case(("uncertainty", SCENE, "--samples", "2", "--workers", "1"), 5),
    "calibrate": Case(("calibrate", MEASURED, "--scene", SCENE, "--set", "level=slip", "--set", _RANGE), 5),
    "vibration": Case(("vibration", "{accelerations}", "--rollers", "13", "--speed", "3000rpm"), 2),
    "sweep": Case(("sweep", SCENE, *_STEADY, "--vary", "operating.radial_load=500N:800N:2", "--workers", "1"), 2),
    "plot": Case(("plot", TABLE)),
    "design": Case((*_DESIGN, "--slip-below", "10%", "--life-above", "300h", "--verify-level", "none", "--workers", "1"), 5),
    "report": Case(("report", TABLE)),
    "trade": Case(("trade", "deng2017_table1", "--quick", "--level", "slip", "--against", "slip"), 5),
    "recover": Case(("recover", BROKEN)),
    "to-csv": Case(("to-csv", RECORDING)),
    "to-parquet": Case(("to-parquet", RECORDING)),
    "view": Case(("view", RECORDING, "--no-open"), 3),
    "mission": Case(("mission", "--duration", "5", "--cage", SCENE), 2),
    "state export": Case(("state", "export", STATE)),
    "study cold-oil": Case(("study", "cold-oil", "nu215_rig", "--supply", "oil_bath", "--temperature", "20 degC", "--load", "1 kN"), 20),
    "study cold-start": Case(("study", "cold-start", "nu215_rig", "--idling", "30 s"), 20),
    "study clearance": Case(("study", "clearance", SCENE, "--speed", "1000rpm:3000rpm:2", "--load", "5kN:5kN:1"), 3),
    "study housing": Case(("study", "housing", SCENE, "--play", "0um:5um:2", "--housing", "steel"), 3),
    "study extremes": Case(("study", "extremes", SCENE, "--samples", "1"), 20),
}


def commands(group: click.Group = main, words: tuple[str, ...] = ()):
    """Yield every command that is not a group, with its name as it is called."""
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if isinstance(command, click.Group):
            yield from commands(command, (*words, name))
        else:
            yield " ".join((*words, name)), command


def outputs() -> list[tuple[str, click.Option]]:
    """Return the output options of all commands with the names of their commands."""
    return [(name, option) for name, command in commands() for option in command.params if isinstance(option.type, OutputFile)]


def file_name(option: click.Option) -> str:
    """Return a name that an option accepts."""
    if option.type.suffixes:
        return f"result{option.type.suffixes[0]}"
    return f"result.{option.metavar.rpartition('.')[2].lower()}" if "." in option.metavar else "result"
