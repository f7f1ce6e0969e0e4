# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim fields`` and ``observables``: the fields of a scene, with unit, range, default and meaning, and what a sample holds."""

import click

from bearing_sim.cli.options import json_option
from bearing_sim.cli.reporting import UsageError, print_rows
from bearing_sim.cli.results import Result, command

_COLUMNS = ("field", "unit or kind", "default", "range", "meaning")


@command("fields")
@click.argument("path", required=False, default="", metavar="[PATH]")
@json_option
def fields(path):
    """Show the fields of a scene below PATH, such as lubricant or bearing.cage; without PATH the blocks of a scene.

    For each: the unit in which messages show it, or what else may stand there; its default; its range; what it means.  A file and --set take any
    unit of the kind.
    """
    from bearing_sim.scene.diameters import diameters
    from bearing_sim.scene.fields import blocks
    from bearing_sim.scene.scene import Scene
    from bearing_sim.scene.uncertainty import nearest

    path = path.strip().strip(".")
    everything = blocks(Scene)
    found = [each for each in everything if _place(each) == path or path and _place(each).startswith(f"{path}.")]
    if not found:  # a single field
        held = [each._replace(fields=tuple(fact for fact in each.fields if _bare(fact.path) == path)) for each in everything]
        found = [each for each in held if each.fields]
    if not found and (half := diameters(Scene).get(path)):
        raise UsageError(f"{path} is {half.quantity.meaning}; see: bearing-sim fields {half.radius}")
    if not found:
        known = dict.fromkeys(_bare(fact.path) for each in everything for fact in each.fields)
        raise UsageError(f"{path}: no field of a scene{nearest(path, known)}; bearing-sim fields lists the blocks")
    plain = [{"law": each.law or None, **_plain(fact._asdict())} for each in found for fact in each.fields]
    more = "bearing-sim fields BLOCK shows the fields of a block and of those within it, such as: bearing-sim fields lubricant.supply"
    return Result({"fields": plain}, lambda: list(map(_print, found if path else found[:1])), remarks=[] if path else [more])


@command("observables")
@click.argument("words", required=False, default="", metavar="[WORDS]")
@json_option
def observables(words):
    """List the observables that a sample holds, those whose name or meaning contains WORDS, or all: unit and meaning."""
    from bearing_sim.model.sample import OBSERVABLES

    found = [each for each in OBSERVABLES if words.casefold() in f"{each.name} {each.meaning}".casefold()]
    if not found:
        raise UsageError(f"no observable has {words!r} in its name or meaning; bearing-sim observables lists all")
    rows = [(each.name, each.unit or "1", f"{each.meaning}{'; of each roller' if each.per_roller else ''}") for each in found]
    columns = ("name", "unit", "meaning")
    return Result({"observables": [each._asdict() for each in found]}, lambda: print_rows("observables", columns, rows, words=columns))


def _bare(path: str) -> str:
    return path.replace("[]", "")


def _place(block) -> str:
    return _bare(block.path)


def _plain(fact: dict) -> dict:
    return {name: text.replace("`", "") for name, text in fact.items()}


def _print(block) -> None:
    """Print the fields of one block; texts of files stand between backticks in the documents, and without them here."""
    title = f"{block.path or 'scene'}" + (f" with law: {block.law}" if block.law else "")
    rows = [tuple(_plain(fact._replace(path=fact.path.rpartition(".")[2])._asdict()).values()) for fact in block.fields]
    if not rows:
        click.echo(f"{title}: no other fields\n")
        return
    print_rows(title, _COLUMNS, rows, words=_COLUMNS, keys=1)
