# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Commands on recordings: ``info``, ``compare``, ``recover``, ``to-csv`` and ``to-parquet``."""

import math
from datetime import UTC, datetime
from pathlib import Path

import click
from click import IntRange

from bearing_sim.cli.options import PATH, flag, json_option, option
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import UsageError, attributes, note, print_rows, print_table, progress_bar, tell_use
from bearing_sim.cli.results import Result, command

_OWN = "bearing_sim"


@command("info")
@click.argument("recording", type=PATH, metavar="RUN.mcap")
@flag("--scene", "prints_scene", "Print only the recorded scene, as YAML.")
@json_option
def info(recording, prints_scene):
    """Show what RUN.mcap holds: topics, counts, time span, scene, versions, and whether the file is complete.

    RUN.mcap is any MCAP file, finished or not, or a bag's folder; or a bag in SQLite or of ROS 1, which has no checksums. The whole file is read
    and its checksums are verified: those of a recording of this version cover every byte, the scene too; what other files leave uncovered is
    said. Exit code 1 if a file is incomplete or damaged.
    """
    from bearing_sim.recording.bag import mcap_files
    from bearing_sim.recording.recovery import contents, foreign_contents

    foreign = foreign_contents(recording)
    files = [] if foreign is None else [foreign]
    for file in mcap_files(recording) if foreign is None else ():
        with progress_bar(f"reading {file.name}", 1.0) as progress:
            files.append(contents(file, progress))
    own = files[0].metadata.get(_OWN, {})
    if prints_scene:
        if "scene" not in own:
            raise UsageError(f"{recording}: no scene in its metadata; it is not a recording of a bearing-sim run")
        click.echo(own["scene"], nl=False)
        return None
    is_sound = all(file.is_sound for file in files)
    report = {"recording": str(recording), "sound": is_sound, "files": [_file_report(file) for file in files], **_origin(own)}
    return Result(report, lambda: _print_info(recording, files, own), code=int(not is_sound))


def _origin(own) -> dict:
    return {name: own.get(name) for name in ("level", "start_ns", "package_version", "git_hash", "seed")} | {
        "scene": own.get("scene"),
        "versions": {name.removeprefix("version_"): version for name, version in own.items() if name.startswith("version_")},
    }


_FILE = "size profile library ends damaged damage first_ns last_ns seconds out_of_order attachments notes undecodable".split()


def _file_report(file) -> dict:
    return attributes(file, *_FILE) | {
        "file": str(file.path),
        "finished": file.is_finished,
        "checksums": _coverage(file),
        "messages": file.messages.total(),
        "metadata": list(file.metadata),
        "topics": {topic: {"type": kind, "messages": file.messages[topic]} for topic, kind in sorted(file.types.items())},
    }


def _print_info(recording, files, own) -> None:
    rows = []
    for file in files:
        health = f"complete, {_checked(file)}" if file.is_sound else f"{'DAMAGED' if file.is_finished else 'INCOMPLETE'}: {_trouble(file)}"
        rows.append((file.path.name, f"{file.size / 1e6:.4g} MB, {health}"))
    started = [file.first_ns for file in files if file.messages]
    if started:
        first, last = min(started), max(file.last_ns for file in files)
        span = f"{datetime.fromtimestamp(first * 1e-9, UTC):%Y-%m-%d %H:%M:%S.%f} UTC, {(last - first) * 1e-9:.6g} s"
        rows.append(("span", span))
    rows.append(("messages", f"{sum(file.messages.total() for file in files)}, {sum(file.out_of_order for file in files)} out of order"))
    if own:
        scene = next((line.partition(":")[2].strip() for line in own.get("scene", "").splitlines() if line.startswith("name:")), "unnamed")
        rows.append(("scene", f"{scene}, level {own.get('level', 'unknown')} (info --scene prints it)"))
        origin = _origin(own)
        versions = [
            f"bearing_sim {origin['package_version'] or 'not installed'}",
            origin["git_hash"] or "",
            *(f"{n} {v}" for n, v in origin["versions"].items()),
        ]
        rows.append(("made with", ", ".join(filter(None, versions))))
        if origin["seed"] is not None:
            rows.append(("seed", origin["seed"]))
    else:
        rows.append(("made with", f"{files[0].library or 'unknown'}; not a recording of a bearing-sim run"))
    topics = sorted({topic for file in files for topic in file.types})
    for topic in topics:
        kind = next(file.types[topic] for file in files if topic in file.types)
        why = next((f"; cannot be decoded: {file.undecodable[topic]}" for file in files if topic in file.undecodable), "")
        rows.append((topic, f"{sum(file.messages[topic] for file in files)} x {kind}{why}"))
    rows += [("note", note) for file in files for note in file.notes]
    print_table(str(recording), rows)


def _coverage(file) -> str:
    """Return what the verified checksums of a file cover: ``all`` of it, its ``chunks`` and perhaps its summary, or nothing: ``none``."""
    return "none" if not file.has_checksums else "all" if file.covers_all else "chunks"


def _checked(file) -> str:
    """Return what was verified of a file in which nothing is wrong."""
    if file.covers_all:
        return "all checksums correct"
    if not file.has_checksums:
        return "all messages can be read; the format has no checksums"
    writer = "by an earlier version" if file.library == _OWN else "by a program that makes none"
    return f"the checksums of its chunks correct; no checksum of the scene and other metadata, written {writer}"


def _trouble(file) -> str:
    troubles = [file.ends] if file.ends else []
    if file.damaged:
        parts = "1 damaged part" if file.damaged == 1 else f"{file.damaged} damaged parts"
        troubles.append(f"{parts}: {'; '.join(file.damage[:3])}{'; ...' if file.damaged > 3 else ''}")
    if not file.has_checksums:
        return "; ".join(troubles)
    return "; ".join(troubles) + f" (bearing-sim recover {file.path} -o GOOD.mcap)"


@command("compare")
@click.argument("first", type=PATH, metavar="RUN.mcap")
@click.argument("second", type=PATH, metavar="AGAIN.mcap")
@option(
    "--tolerance",
    "tolerances",
    "Accepted difference relative to the largest magnitude of a quantity, for all topics or for one [default: 1e-6].",
    multiple=True,
    metavar="NUMBER | TOPIC=NUMBER",
)
@flag("--clock", "by_clock", "Match messages by the clock, for runs that began at different moments of one log.")
@json_option
def compare(first, second, tolerances, by_clock):
    """Compare two recordings topic by topic; messages are matched by run time.

    Two runs of one command are therefore compared from their beginnings on, whenever they were made. Recordings that do not say when their run
    began, such as those of other programs, are matched by the clock.

    A topic agrees if both recordings have the same messages and all their numbers agree within the tolerance. Exit code 0 if all topics
    agree, 1 otherwise. Diagnostics are text and are not compared.
    """
    from bearing_sim.recording.compare import compare

    general, own = _tolerances(tolerances)
    differences, skipped = compare(first, second, general, own, by_clock, lambda text: note(text))
    if not differences:
        raise UsageError(f"{first} and {second} have no messages to compare")
    unknown = [topic for topic in own if f"/{topic.lstrip('/')}" not in {difference.topic for difference in differences}]
    if unknown:
        raise UsageError(f"--tolerance {unknown[0]}=...: unknown topic; the topics are {', '.join(difference.topic for difference in differences)}")
    agree = all(difference.agrees for difference in differences)
    report = {"agree": agree, "not_compared": skipped, "topics": [_difference_report(difference) for difference in differences]}
    remarks = [*([f"not compared: {', '.join(skipped)}"] if skipped else []), f"the recordings {'agree' if agree else 'differ'}"]
    return Result(report, lambda: _print_comparison(first, second, differences), remarks=remarks, code=int(not agree))


def _tolerances(given) -> tuple[float, dict[str, float]]:
    general, own = 1e-6, {}
    for text in given:
        topic, is_own, number = text.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            value = -1.0
        if not value >= 0.0:
            raise UsageError(f"--tolerance {text}: expected a number of 0 or more, or TOPIC=NUMBER")
        if is_own:
            own[topic] = value
        else:
            general = value
    return general, own


def _difference_report(difference) -> dict:
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


def _print_comparison(first, second, differences) -> None:
    rows, start = [], min(difference.first_ns for difference in differences)
    for difference in differences:
        found = _difference_report(difference)
        alone = f"{difference.only_first} / {difference.only_second}"
        numbers = ["-"] * 2 if found["largest"] is None else [f"{found['largest']:.3g}", f"{found['largest_relative']:.2e}"]
        where = ["", ""] if found["largest_in"] is None else [found["largest_in"], f"{(found['largest_at_ns'] - start) * 1e-9:.6g}"]
        verdict = "agrees" if difference.agrees else "DIFFERS"
        counts = str(difference.matched), alone, str(difference.differing)
        rows.append((difference.topic, *counts, *numbers, f"{difference.tolerance:g}", *where, verdict))
    columns = ("topic", "messages", "alone", "differing", "largest", "over magnitude", "tolerance", "in", "after [s]", "")
    print_rows(f"{first} against {second}", columns, rows, words=("topic", "in", ""), width=170)


@command("recover")
@click.argument("broken", type=click.Path(path_type=Path, dir_okay=False), metavar="BROKEN.mcap")
@option("-o", "--out", "Recovered file.", OutputFile(), required=True, metavar="GOOD.mcap")
@json_option
def recover(broken, out):
    """Recover everything readable from BROKEN.mcap into GOOD.mcap: a file of a killed writer (RUN.mcap.active), truncated or damaged.

    Works with any MCAP file. Messages keep their bytes, times and order; BROKEN.mcap is not changed.
    """
    from bearing_sim.recording.recovery import recover

    with progress_bar(f"recovering {broken.name}", 1.0) as progress:
        found = recover(broken, out, progress)
        size = out.path.stat().st_size
    lost = "nothing known to be missing" if found.is_sound else found.ends or "parts of it were damaged"
    report = {"broken": str(broken), "out": str(out), "broken_size": found.size, "size": size, "was_finished": found.is_finished}
    report |= {"messages": found.messages.total(), "messages_by_topic": dict(found.messages), "metadata": list(found.metadata)}
    report |= attributes(found, "seconds", "damaged", "damage", "ends")
    rows = [
        ("the file", f"{found.size / 1e6:.4g} MB; {lost}"),
        ("damaged parts", "; ".join([str(found.damaged), *found.damage[:3], *(["..."] if found.damaged > 3 else [])])),
        ("saved", f"{found.messages.total()} messages over {found.seconds:.6g} s, {len(found.metadata)} metadata records"),
        *((topic, f"{count} messages") for topic, count in sorted(found.messages.items())),
    ]
    return Result(report, lambda: print_table(f"{broken} recovered into {out}", rows))


def _exporting(kind: str, detail: str) -> click.Command:
    """Return the command that exports a recording as a table of a kind, ``csv`` or ``parquet``."""
    name = {"csv": "a CSV", "parquet": "a Parquet"}[kind]

    @command(f"to-{kind}", help=_EXPORT.format(name=name, detail=detail))
    @click.argument("recording", type=PATH, metavar="RUN.mcap")
    @option("--column", "columns", "Export this observable; can be repeated [default: all].", multiple=True, metavar="NAME")
    @flag("--no-rollers", "Omit the observables of single rollers.")
    @option("--every", "Export one of N samples.", IntRange(min=1), default=1, metavar="N")
    @option("--from", "first", "First simulated time [default: the beginning].", float, metavar="S")
    @option("--to", "last", "Last simulated time [default: the end].", float, metavar="S")
    @json_option
    @option("-o", "--out", "The table.", OutputFile(), required=True, metavar=f"RUN.{kind}")
    def export(recording, out, columns, no_rollers, every, first, last):
        from bearing_sim.recording import table
        from bearing_sim.recording.reader import Recording

        ends = -math.inf if first is None else first, math.inf if last is None else last
        excerpt = table.Excerpt(tuple(columns), not no_rollers, every, *ends)
        source = Recording(recording, allow_partial=True)
        with progress_bar(f"writing {out.path.name}", source.duration) as progress, out.draft() as draft:
            rows = table.write_table(source, draft, excerpt, progress, kind)
        size = out.path.stat().st_size
        tell_use(source.tally, recording)
        report = {"recording": str(recording), "out": str(out), "rows": rows, "size": size, "read": source.tally.report()}
        return Result(report, lambda: click.echo(f"{out}: {rows} samples, {size / 1e6:.4g} MB"))

    return export


_EXPORT = """Export the samples of RUN.mcap, a recording of bearing-sim or the node, as {name} table.

One row per sample, one column per observable and characteristic frequency, or per roller for observables of rollers (inner_load_07).
{detail} numbers are in SI.
"""
to_csv = _exporting("csv", "Units are in the header,")
to_parquet = _exporting("parquet", "Units and meanings are in the metadata of the columns, the scene in that of the file;")
