# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim compare``: what differs between two recordings."""

import sys
from pathlib import Path

import click

from bearing_sim.commands.reporting import BadInput, print_json, print_rows, told_as_bad_input, told_file_faults


@click.command()
@click.argument("first", type=click.Path(path_type=Path), metavar="RUN.mcap")
@click.argument("second", type=click.Path(path_type=Path), metavar="AGAIN.mcap")
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="NUMBER | TOPIC=NUMBER",
    help="Difference accepted, over the largest magnitude of a quantity; of all topics or of one [default: 1e-6].",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(first, second, tolerances, as_json):
    """Compare two recordings topic by topic; messages belong together by their times.

    A topic agrees when both have the same messages and every number of them is the same within the tolerance. Exit code 0 where all
    topics agree, 1 where one does not. Diagnostics are text and not compared.
    """
    from bearing_sim.bag_files import BagError
    from bearing_sim.comparison import compare

    general, own = _tolerances(tolerances)
    with told_as_bad_input(BagError), told_file_faults():
        differences, skipped = compare(first, second, general, own)
    if not differences:
        raise BadInput(f"{first} and {second} have no message to compare")
    unknown = [topic for topic in own if f"/{topic.lstrip('/')}" not in {difference.topic for difference in differences}]
    if unknown:
        raise BadInput(f"--tolerance {unknown[0]}=...: no such topic; there are {', '.join(difference.topic for difference in differences)}")
    agree = all(difference.agrees for difference in differences)
    if as_json:
        print_json({"agree": agree, "not_compared": skipped, "topics": [_told(difference) for difference in differences]})
    else:
        _print(first, second, differences, skipped, agree)
    sys.exit(0 if agree else 1)


def _tolerances(given) -> tuple[float, dict[str, float]]:
    general, own = 1e-6, {}
    for text in given:
        topic, is_own, number = text.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            value = -1.0
        if not value >= 0.0:
            raise BadInput(f"--tolerance {text}: expected a number of 0 or more, or TOPIC=NUMBER")
        if is_own:
            own[topic] = value
        else:
            general = value
    return general, own


def _told(difference) -> dict:
    worst = difference.worst
    return {
        "topic": difference.topic,
        "type": difference.ros_type,
        "agrees": difference.agrees,
        "messages": difference.matched,
        "only_in_first": difference.only_first,
        "only_in_second": difference.only_second,
        "differing": difference.differing,
        "tolerance": difference.tolerance,
        "largest_relative": None if worst is None else float(difference.relative[worst]),
        "largest": None if worst is None else float(difference.largest[worst]),
        "largest_in": None if worst is None or not difference.differing else difference.numbers[worst],
        "largest_at_ns": None if worst is None or not difference.differing else int(difference.where_ns[worst]),
    }


def _print(first, second, differences, skipped, agree) -> None:
    rows, start = [], min(difference.first_ns for difference in differences)
    for difference in differences:
        told = _told(difference)
        alone = f"{difference.only_first} / {difference.only_second}"
        numbers = ["-"] * 2 if told["largest"] is None else [f"{told['largest']:.3g}", f"{told['largest_relative']:.2e}"]
        where = ["", ""] if told["largest_in"] is None else [told["largest_in"], f"{(told['largest_at_ns'] - start) * 1e-9:.6g}"]
        verdict = "agrees" if difference.agrees else "DIFFERS"
        counts = str(difference.matched), alone, str(difference.differing)
        rows.append((difference.topic, *counts, *numbers, f"{difference.tolerance:g}", *where, verdict))
    columns = ("topic", "messages", "alone", "differing", "largest", "over magnitude", "tolerance", "in", "after [s]", "")
    print_rows(f"{first} against {second}", columns, rows, words=("topic", "in", ""), width=170, whole=("topic",))
    if skipped:
        click.echo(f"not compared: {', '.join(skipped)}")
    click.echo("the recordings agree" if agree else "the recordings differ")
