# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim info``: what is in a recording, where it comes from, and whether it is whole."""

import sys
from datetime import UTC, datetime
from pathlib import Path

import click

from bearing_sim.commands.reporting import print_json, print_table, progress_bar, told_as_bad_input, told_file_faults

_OWN = "bearing_sim"


@click.command()
@click.argument("recording", type=click.Path(path_type=Path), metavar="RUN.mcap")
@click.option("--scene", "prints_scene", is_flag=True, help="Print the recorded scene as YAML, and nothing else.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(recording, prints_scene, as_json):
    """Say what RUN.mcap holds: topics, counts, span, scene, versions, and the file's health.

    RUN.mcap is any MCAP file, finished or not, or a bag's folder; all of it is read and its checksums are verified. Exit code 1 where a file
    is not whole.
    """
    from bearing_sim.bag_files import BagError, mcap_files
    from bearing_sim.recovery import RecoveryError, contents

    with told_as_bad_input(BagError, RecoveryError), told_file_faults():
        files = []
        for file in mcap_files(recording):
            with progress_bar(f"reading {file.name}", 1.0) as progress:
                files.append(contents(file, progress))
    own = files[0].metadata.get(_OWN, {})
    if prints_scene:
        from bearing_sim.commands.reporting import BadInput

        if "scene" not in own:
            raise BadInput(f"{recording}: no scene in its metadata, so it is no recording of a run of bearing-sim")
        click.echo(own["scene"], nl=False)
        return
    if as_json:
        print_json(
            {"recording": str(recording), "sound": all(file.is_sound for file in files), "files": [_told(file) for file in files], **_origin(own)}
        )
    else:
        _print(recording, files, own)
    sys.exit(0 if all(file.is_sound for file in files) else 1)


def _origin(own) -> dict:
    return {name: own.get(name) for name in ("level", "start_ns", "package_version", "git_hash", "seed")} | {
        "scene": own.get("scene"),
        "versions": {name.removeprefix("version_"): version for name, version in own.items() if name.startswith("version_")},
    }


def _told(file) -> dict:
    return {
        "file": str(file.path),
        "size": file.size,
        "profile": file.profile,
        "library": file.library,
        "finished": file.is_finished,
        "ends": file.ends,
        "damaged": file.damaged,
        "first_ns": file.first_ns,
        "last_ns": file.last_ns,
        "seconds": file.seconds,
        "messages": file.messages.total(),
        "out_of_order": file.out_of_order,
        "attachments": file.attachments,
        "metadata": list(file.metadata),
        "topics": {topic: {"type": kind, "messages": file.messages[topic]} for topic, kind in sorted(file.types.items())},
    }


def _print(recording, files, own) -> None:
    rows = []
    for file in files:
        health = "whole, all checksums good" if file.is_sound else f"NOT WHOLE: {_trouble(file)}"
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
        told = [
            f"bearing_sim {origin['package_version'] or 'not installed'}",
            origin["git_hash"] or "",
            *(f"{n} {v}" for n, v in origin["versions"].items()),
        ]
        rows.append(("made with", ", ".join(filter(None, told))))
        if origin["seed"] is not None:
            rows.append(("seed", origin["seed"]))
    else:
        rows.append(("made with", f"{files[0].library or 'unknown'}; no recording of a run of bearing-sim"))
    topics = sorted({topic for file in files for topic in file.types})
    for topic in topics:
        kind = next(file.types[topic] for file in files if topic in file.types)
        rows.append((topic, f"{sum(file.messages[topic] for file in files)} x {kind}"))
    print_table(str(recording), rows)


def _trouble(file) -> str:
    told = [file.ends] if file.ends else []
    told += [f"{file.damaged} damaged chunks or records"] if file.damaged else []
    return "; ".join(told) + f" (bearing-sim recover {file.path} -o GOOD.mcap)"
