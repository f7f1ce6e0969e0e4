# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Sphinx extension that writes the reference from the code, so that it cannot disagree with it.

A page asks for a generated part by a comment line of its own, ``% generated: scene_fields``; before Sphinx parses the page
the line is replaced by the Markdown that the function of this name in `PARTS` returns.  To read a part without a build:
``python doc/_extensions/generated_reference.py scene_fields``.
"""

import ast
import math
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "bearing_sim"

# ---------------------------------------------------------------------------------------------------------------- Markdown


def cell(text: object) -> str:
    """Return text as one cell of a Markdown table: one line, with nothing in it that Markdown takes for markup, except code."""
    pieces = re.split(r"(`+[^`]*`+)", " ".join(str(text).split()))
    return "".join(piece if piece.startswith("`") else re.sub(r"([\\<*$])", r"\\\1", piece) for piece in pieces).replace("|", r"\|")


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a Markdown table; an empty one is left out."""
    rows = [[cell(item) for item in row] for row in rows]
    if not rows:
        return ""
    head = list(head)
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *rows)) + "\n"


def code(text: object) -> str:
    """Return text as code, or nothing for an empty one."""
    return f"`{text}`" if str(text) else ""


def prose(docstring: str | None) -> str:
    """Return a docstring's text as Markdown paragraphs, without its numpydoc sections."""
    from bearing_sim.scene import fields

    return re.sub(r"([<*$])", r"\\\1", fields.prose(docstring))


# ------------------------------------------------------------------------------------------------------------ scene fields


def _record_sections(record: type) -> Iterator[str]:
    """Yield the sections of a record and of the records inside it, as Markdown."""
    from bearing_sim.scene.fields import blocks

    for block in blocks(record):
        if block.path:
            depth = min(2 + max(block.path.count(".") - 2, 0), 4)
            yield f"{'#' * depth} `{block.path}`" + (f" with `law: {block.law}`" if block.law else "")
        yield prose(block.record.__doc__)
        rows = [[code(fact.path.rpartition(".")[2]), *fact[1:]] for fact in block.fields]
        yield table(["field", "unit or kind", "default", "range", "meaning"], rows)


def scene_fields() -> str:
    """Return every field of a scene: unit, default, range and meaning, block by block."""
    from bearing_sim.scene.scene import Scene

    return "\n\n".join(_record_sections(Scene))


def mapping_fields() -> str:
    """Return every field of a mapping of a table: unit, default, range and meaning, block by block."""
    from bearing_sim.inputs.csv_import import Mapping, SpeedColumn

    parts, kept, has_column = list(_record_sections(Mapping)), [], False
    while parts:
        part = parts.pop(0)
        if part.startswith("#") and parts[0] == prose(SpeedColumn.__doc__):  # all columns have the same fields, each in its own unit
            described, parts = parts[:2], parts[2:]
            place = re.search(r"`([^`]+)`", part)[1]
            kept = [text.replace(f"block, see `{place}` below", "see *Every column* below") for text in kept]
            kept += [] if has_column else ["## Every column", *described]
            has_column = True
        else:
            kept.append(part)
    return "\n\n".join(kept)


def bundled() -> str:
    """Return the bundled scenes with their descriptions, and the names in the catalogue."""
    import yaml

    from bearing_sim.scene.loader import catalog_names, scene_names

    folder = PACKAGE / "scene" / "scenes"
    described = [(code(name), yaml.safe_load((folder / f"{name}.yaml").read_text()).get("description", "")) for name in scene_names()]
    kinds = [path.name for path in sorted((PACKAGE / "scene" / "catalog").iterdir()) if path.is_dir()]
    listed = [(kind, ", ".join(map(code, catalog_names(kind)))) for kind in kinds]
    return table(["scene", "description"], described) + "\n" + table(["catalogue of", "names"], listed)


# -------------------------------------------------------------------------------------------- topics, observables, recordings


def _topic_rows(topics: Iterable, direction: str = "") -> list[list[str]]:
    return [[code(topic.name), code(topic.ros_type.replace("/msg/", "/")), topic.meaning] for topic in topics]


def input_topics() -> str:
    """Return the topics that the node subscribes to."""
    from bearing_sim.messages import topics

    measured = [topics.MEASUREMENTS[name] for name in topics.MEASURED_CHANNELS]
    return table(["topic", "type", "meaning"], _topic_rows([*topics.INPUTS.values(), *measured, topics.VIBRATION]))


def output_topics() -> str:
    """Return the topics that the node publishes, and the rows of those that carry arrays."""
    from bearing_sim.messages import topics

    tilting = [topic.name for topic in topics.OUTPUTS.values() if topic.of_tilting_levels]
    listed = table(
        ["topic", "type", "meaning"], _topic_rows([*topics.OUTPUTS.values(), topics.MEASUREMENTS[topics.RESIDUAL], *topics.ESTIMATED.values()])
    )
    warm = [topic.name for topic in topics.OUTPUTS.values() if topic.of_heat]
    only = f"Only level `spatial` publishes {', '.join(map(code, tilting))}, and only scenes with a law of heat {', '.join(map(code, warm))}."
    return f"{listed}\n{only}\n"


def array_rows() -> str:
    """Return what the rows of each array topic are."""
    from bearing_sim.messages import topics
    from bearing_sim.model.sample import OBSERVABLES

    known = {observable.name: observable for observable in OBSERVABLES}
    rows = []
    for name, array in topics.ARRAYS.items():
        shape = f"{len(array.fields)} x rollers" if known[array.fields[0]].per_roller else str(len(array.fields))
        units = [known[field].unit or "1" for field in array.fields]
        rows.append([code(name), shape, ", ".join(f"`{field}` [{unit}]" for field, unit in zip(array.fields, units, strict=True))])
    return table(["topic", "shape", "rows, in order"], rows)


def cloud_fields() -> str:
    """Return the fields of a point of topic ``rollers``."""
    from bearing_sim.messages.point_cloud import ROLLER_FIELDS

    rows = [[code(field.name), field.unit or "1", field.meaning, "spatial" if field.of_tilting_levels else "all"] for field in ROLLER_FIELDS]
    return table(["field", "unit", "meaning", "levels"], rows)


def named_numbers() -> str:
    """Return the names in topics that carry named numbers."""
    from bearing_sim.messages import topics
    from bearing_sim.model.characteristic_frequencies import FREQUENCIES
    from bearing_sim.model.sample import OBSERVABLES

    meanings = {observable.name: observable.meaning for observable in OBSERVABLES}
    meanings |= {"slip_warning": "threshold of the scene for warnings", "slip_error": "threshold of the scene for errors"}
    rows = [[code("bearing_state"), code(name), meanings[name.partition(" [")[0]]] for name in topics.STATE_NAMES]
    rows += [
        [code("characteristic_frequencies"), code(name), f"{frequency.meaning} ({frequency.symbol})"]
        for name, frequency in zip(topics.FREQUENCY_NAMES, FREQUENCIES, strict=True)
    ]
    return table(["topic", "name", "meaning"], rows)


def observables() -> str:
    """Return the fields of a sample: name, unit, shape and meaning."""
    from bearing_sim.model.sample import OBSERVABLES

    rows = [[code(o.name), o.unit or "1", "one per roller" if o.per_roller else "number", o.meaning] for o in OBSERVABLES]
    return table(["name", "unit", "shape", "meaning"], rows)


def recorded_topics() -> str:
    """Return the topics of a recording besides those that the node publishes."""
    from bearing_sim.messages import topics

    return table(["topic", "type", "meaning"], _topic_rows(topics.RECORDED.values()))


# ------------------------------------------------------------------------------------------------ parameters, services, events


def _number(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def parameters() -> str:
    """Return the parameters of ``bearing_node``."""
    try:
        from bearing_sim.ros.parameters import DECLARATIONS, SCENE_DECLARATIONS
    except ImportError as error:  # a machine without ROS 2
        return f"(built without ROS 2: {error}; the parameters are in `launch_scripts/bearing_node.yaml`)"

    def rows(declarations):
        for row in declarations:
            default = "[]" if row.default == [""] else _number(row.default)
            bounds = ", ".join(map(code, row.choices)) or ("" if math.isinf(row.low) else f"{_number(row.low)} to {_number(row.high)}")
            yield [
                code(row.name),
                code(default) if default else "empty",
                bounds,
                "yes" if row.running else "",
                "yes" if row.per_bearing else "",
                row.meaning,
            ]

    head = ["parameter", "default", "range", "while running", "per bearing", "meaning"]
    return "\n\n".join(
        [
            table(head, rows(DECLARATIONS)),
            "## Parameters of the scene\n\nThese take the values of the scene unless you set them.",
            table(head, rows(SCENE_DECLARATIONS)),
        ]
    )


def services() -> str:
    """Return the services that the node and the player offer, read from the calls that create them, and those of watchers."""
    from bearing_sim.watchers.monitoring.watchers import SERVICES

    rows = [[code("bearing_node"), code(f"~/{name}"), code("std_srvs/srv/Trigger"), meaning] for name, (meaning, _) in SERVICES.items()]
    for program, module in (("bearing_node", "node"), ("bearing_player", "player")):
        for path in _reached(PACKAGE / "ros" / f"{module}.py"):
            tree = ast.parse(path.read_text())
            answers = {node.name: (ast.get_docstring(node) or "").split("\n\n")[0] for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
            for node in ast.walk(tree):
                items = node.args if isinstance(node, ast.Call) else node.elts if isinstance(node, ast.Tuple) else []
                words = [ast.unparse(item) for item in items[:3]]
                if len(words) == 3 and words[0] in ("Trigger", "SetBool") and isinstance(items[1], ast.Constant):
                    meaning = answers.get(words[2].rpartition(".")[2], "")
                    rows.append([code(program), code(f"~/{items[1].value.removeprefix('~/')}"), code(f"std_srvs/srv/{words[0]}"), meaning])
    if any(meaning for *_, meaning in rows):
        return table(["of", "service", "type", "meaning"], rows)
    return table(["of", "service", "type"], [row[:3] for row in rows])


def _reached(path: Path) -> list[Path]:
    """Return a module of ``ros`` and the modules of ``ros`` that it imports, directly or not."""
    found, waiting = [], [path]
    while waiting:
        found.append(waiting.pop())
        names = {node.module for node in ast.walk(ast.parse(found[-1].read_text())) if isinstance(node, ast.ImportFrom) and node.module}
        imported = [PACKAGE / "ros" / f"{name.rpartition('.')[2]}.py" for name in sorted(names) if name.startswith("bearing_sim.ros.")]
        waiting += [item for item in imported if item.exists() and item not in found and item not in waiting]
    return found


EVENTS = {
    "bearing.slip": ("WARN, ERROR", "cage slip above its threshold"),
    "bearing.clearance": ("WARN, ERROR", "running clearance below its threshold; a preload may be wanted, so that there is none by default"),
    "bearing.life": ("WARN, ERROR", "life at the present condition below its threshold"),
    "bearing.remaining_life": ("WARN, ERROR", "remaining life below its threshold"),
    "bearing.life_used": ("ERROR", "damage has reached 1: the rating life is used up"),
    "bearing.lambda": ("WARN, ERROR", "film thickness over roughness below its threshold"),
    "bearing.pocket_force": ("WARN, ERROR", "pocket force above its threshold"),
    "calibration.change": ("WARN", "lasting change of the measured cage speed that the calibrated model does not explain, with its likeliest cause"),
    "calibration.contradicted": ("WARN", "most measurements of the cage lie outside of what the ranges of the scene allow"),
    "clock.absent": ("WARN", "`use_sim_time` is set and no `/clock` has arrived"),
    "clock.jumped": ("WARN", "the wall clock was set; run and recording continue evenly"),
    "clock.jumped_back": (
        "WARN, ERROR",
        "`/clock` jumped back by `clock_tolerance` or more: the run restarts, or the last state is held (`clock_jump_back`)",
    ),
    "clock.leapt_ahead": ("WARN", "`/clock` jumped ahead; gaps between messages are not simulated"),
    "clock.passed": ("OK", "`/clock` has passed the time before its jump back; the model continues"),
    "clock.stands_still": ("OK", "`/clock` does not advance: paused"),
    "governor.change": ("OK, WARN", "the governor changed the level of fidelity, or the measured setting, which is the subject"),
    "estimate.absent": ("WARN", "the scene asks for bands or a calibration, and there is no response of the bearing that they could come from"),
    "governor.level": ("WARN", "the model computes below the level or the setting of the scene, because the machine is too slow"),
    "input.absent": (
        "WARN",
        "no good message of speed or load within `inputs_expected_within` of the start, or of another channel that somebody publishes; with the "
        "topic, whether it has publishers, and what to do",
    ),
    "input.frame": ("ERROR", "message refused: it is in another frame than `frame_id`"),
    "input.gap": ("WARN", "a gap in the inputs of a log; it is not simulated"),
    "input.late": ("WARN", "message refused: it is older than what was already computed"),
    "input.leftover": ("counted", "message of the time before a jump of `/clock`, left out"),
    "input.lost": ("WARN", "messages were lost, or may have been, between the sender and the node"),
    "input.malformed": ("ERROR", "message refused: it cannot be decoded, or lacks the joint or its velocity"),
    "input.negative": ("ERROR", "message refused: negative load, or reverse rotation while `input_limits.reverse_rotation` is off"),
    "input.not_finite": ("ERROR", "message refused: a value is not finite"),
    "input.not_stamped": ("ERROR", "message refused: it has no stamp, and no clock can stand in"),
    "input.publishers": ("WARN, ERROR", "several publishers of one input; ERROR if their values disagree"),
    "input.qos": ("WARN", "a publisher cannot be heard, because its quality of service does not fit"),
    "input.rate": (
        "WARN",
        "messages arrive below `input_limits.minimum_rate` or above `maximum_rate`; those of a log, at a third or three times its own rate",
    ),
    "input.returned": ("OK", "the temperature of a ring is measured again; the measured one is used"),
    "input.stale": (
        "WARN",
        "no message for longer than `input_limits.stale_after`, of temperatures than ten times that, in a slower log than three of its spacings; the "
        "last value is used, for the temperature of a ring that of the model",
    ),
    "input.standard_error": ("ERROR", "message refused: the standard error of a measured cage speed or clearance is zero, negative or infinite"),
    "input.stamp_offset": (
        "WARN",
        "stamps are more than `stamp_tolerance` ahead of or behind the node's clock (not with `use_sim_time`); the messages are used as they arrive",
    ),
    "input.stamp_not_finite": ("ERROR", "message refused: its stamp is not finite"),
    "input.time_backwards": ("ERROR", "message refused: its stamp lies before the last one"),
    "input.time_repeated": ("WARN", "message refused: its stamp repeats the last one"),
    "input.too_large": ("ERROR", "message refused: above the limit in `input_limits`"),
    "input.too_small": ("ERROR", "message refused: below the limit in `input_limits`"),
    "input.type": ("WARN", "the topic has a publisher of another type, which cannot be heard; with both types"),
    "input.unknown": (
        "WARN",
        "inputs were refused for some of the time; if they were too large, the life is an upper and the damage a lower bound",
    ),
    "input.unused": ("WARN", "the temperature of a ring is measured, but `heat.law: none` does not use it"),
    "input.unreadable": ("ERROR", "message of a log that cannot be decoded"),
    "log.unfinished": ("WARN", "a log ends before its proper end, as of a killed writer"),
    "output.dropped": ("WARN", "samples were dropped because nobody collected them in time"),
    "pace.lost": ("OK", "lag beyond `maximum_lag` was skipped"),
    "pace.outputs": ("WARN", "in each of five seconds more than a fiftieth of the outputs was left out"),
    "recording.dropped": ("WARN", "the recording does not keep up with the run"),
    "recording.part": ("ERROR", "a file of a recording could not be completed"),
    "recording.restored": ("WARN", "a file was deleted or replaced while it was written, and was restored"),
    "recording.set_aside": ("WARN", "the unfinished file of a killed run had the name of this recording and has another one now"),
    "reproduction.failed": ("ERROR", "a sample of a recording could not be computed again; the run continues from the recorded one"),
    "residual.shift": ("WARN", "lasting change of the measured against the predicted slip, or of a measured against a predicted ring temperature"),
    "run.behind": ("WARN", "the model lags behind `/clock` and catches up"),
    "run.failed": ("ERROR", "a transition of the node failed"),
    "run.given_up": ("ERROR", "the model could not be advanced ten times in a row; it waits for `~/reset`"),
    "run.paused": ("OK", "simulated time is held"),
    "run.reset": ("OK", "state and damage have returned to the start of the scene"),
    "run.start": ("OK", "the run starts"),
    "run.waiting": ("OK", "waiting for the first inputs"),
    "run.warming_up": ("WARN", "not monitored yet: the model is being compiled; inputs that arrive now are not used"),
    "run.unconfigured": ("OK", "the node waits to be configured"),
    "run.inactive": ("OK", "the node waits to be activated"),
    "run.finalized": ("OK", "the node is shut down"),
    "scene.implausible": ("WARN", "a field of the scene looks like a slip of the pen; told once, at the start"),
    "sink.failed": ("WARN, ERROR", "a recording or a view has failed or stopped"),
    "solver.crashed": ("ERROR", "the solver thread ended by a programming error; restart the node"),
    "solver.failed": ("ERROR", "time could not be advanced; the last good state is held"),
    "solver.recovered": ("OK", "time advances again"),
    "state.begun": ("OK", "nothing was known about the bearing: its state begins"),
    "state.continued": ("OK", "the bearing's state continues from the last run"),
    "state.history": ("OK, WARN", "the history of days is CSV because there is no pyarrow, or cannot be written"),
    "state.late": ("WARN", "a slow disk or machine: a kill would lose more than ten seconds of the bearing's state"),
    "state.not_written": ("ERROR", "the bearing's state cannot be written; the model continues, and writing is tried again"),
    "state.recalibrated": ("OK", "the scene was calibrated since the last run; what was learned about residuals is forgotten"),
    "state.restored": ("WARN", "the state file is damaged, missing or older than the one before; the newest good state is used"),
    "state.returned": ("WARN", "a bearing that was taken out is in service again"),
    "state.unlocked": ("WARN", "the file system has no locks, which would keep other nodes from using the same state"),
    "validity.axial_load": ("WARN", "the axial load on flanges is outside of what the model of roller ends is for"),
    "vibration.behind": ("WARN", "windows of vibration are complete faster than this machine analyses them; one is left out"),
    "vibration.gap": ("WARN", "blocks of vibration are lost, late or of another rate; the window begins again"),
    "vibration.rate": ("WARN", "blocks of vibration arrive faster or slower than their sampling rate says; the window is left out"),
    "vibration.refused": ("WARN", "a block of vibration cannot be used"),
    "validity.bearing": ("WARN", "what decides about the bearing is estimated, or lies outside of what its description is for"),
    "validity.clearance": ("WARN", "the inner ring is stressed beyond its strength, or has lost its fit on the shaft"),
    "validity.contact": ("WARN", "the elastic contact is outside of its range, such as a Hertz pressure above 4 GPa"),
    "validity.drag": ("WARN", "the drag of oil or grease is used outside of its range"),
    "validity.film": ("WARN", "a film formula is used outside of its range"),
    "validity.flange": ("WARN", "the film between rollers' ends and flanges is used outside of its range"),
    "validity.land": ("WARN", "the film of the guide lands is used outside of its range"),
    "validity.heat": ("WARN", "a conductance of the thermal network is extrapolated"),
    "validity.level": ("WARN", "a level of fidelity is used outside of what its corrected table covers"),
    "validity.life": ("WARN", "life or static safety are outside of the standards' range, such as P above 0.5 C_r"),
    "validity.oil": ("WARN", "properties of the oil are extrapolated"),
    "validity.outer_ring": ("WARN", "the outer ring that bends is loose in its housing, sits on a small arc, or is too thick for its law"),
    "validity.pocket": ("WARN", "the film of the pockets is used outside of its range"),
    "validity.speed": ("WARN", "the bearing turns faster than anything that the laws were compared with"),
    "validity.support": ("WARN", "the squeeze film around the outer ring is used outside of its range"),
    "validity.traction": ("WARN", "the traction law is used outside of its range, such as for another class of oil"),
}
"""Severity and meaning of each kind of event; `events` compares the kinds with the code."""
_STATES = {"run.unconfigured", "run.inactive", "run.finalized"}  # kinds that the node makes of the names of its states
_KIND = re.compile(rf"({'|'.join(sorted({kind.partition('.')[0] for kind in EVENTS}))})\.(?!mcap|rrd|name$|cage$)[a-z_]+")
_ROOMS_WITH_EVENTS = ("inputs", "model", "watchers", "recording", "ros", "runtime", "view")


def events() -> str:
    """Return the kinds of events with severity and meaning, and the files that raise them.

    Raises
    ------
    LookupError
        The code has a kind that `EVENTS` does not explain, or no longer has one that it does.
    """
    from bearing_sim.model.validity import LAWS

    found: dict[str, set[str]] = {}
    for path in sorted(path for room in _ROOMS_WITH_EVENTS for path in (PACKAGE / room).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and _KIND.fullmatch(node.value):
                found.setdefault(node.value, set()).add(path.relative_to(ROOT).as_posix())
    for law in LAWS:
        found.setdefault(law.kind, set()).add("bearing_sim/model/validity.py")
    if found.keys() | _STATES != EVENTS.keys():
        differing = sorted((found.keys() | _STATES) ^ EVENTS.keys())
        raise LookupError(f"doc/_extensions/generated_reference.py: EVENTS and the code differ in {', '.join(differing)}")
    rows = [[code(kind), *EVENTS[kind], ", ".join(map(code, sorted(found.get(kind, ()))))] for kind in sorted(EVENTS)]
    return table(["kind", "severity", "meaning", "raised in"], rows)


def subjects() -> str:
    """Return the subjects of diagnostics, and the beginnings of the kinds of their events."""
    from bearing_sim.messages.diagnostics import SUBJECTS
    from bearing_sim.messages.topics import INPUTS, MEASURED_CHANNELS

    others = {name: "`input.` of this topic" for name in (*INPUTS, *MEASURED_CHANNELS)} | {"view": "`recording.`, `sink.` of the view"}
    rows = ([code(each.name), each.meaning, ", ".join(map(code, each.kinds)) or others[each.name]] for each in SUBJECTS)
    return table(["subject", "about", "kinds of events begin with"], rows)


def validity() -> str:
    """Return the limits of all laws: range, source, what happens outside, and the test that drives each out of its range."""
    from bearing_sim.model.validity import LAWS

    tests = {law.name: f"test_validity.py -k {law.name}" for law in LAWS} | {"table_states": "test_two_states.py"}
    sections = []
    for kind in dict.fromkeys(law.kind for law in LAWS):
        rows = [
            [
                code(law.name),
                f"{law.law}: {law.quantity}",
                law.general_range,
                law.source,
                "; ".join(each.otherwise for each in law.variations) or "not known",
                law.instead,
                code(tests[law.name]),
            ]
            for law in LAWS
            if law.kind == kind
        ]
        head = ["name", "law and quantity", "range", "source", "effect computed with", "advice outside", "tests"]
        sections.append(f"### `{kind}`\n\n{table(head, rows)}")
    return "\n\n".join(sections)


def unwatched_laws() -> str:
    """Return the laws for which no range is watched, and why."""
    from bearing_sim.model.validity import UNWATCHED

    return table(["law", "why it is not watched"], UNWATCHED)


# ---------------------------------------------------------------------------------------------------- command line, Python API


def _commands(command, name: str, depth: int) -> Iterator[str]:
    import click

    context = click.Context(command, info_name=name)
    yield f"{'#' * depth} `{name}`"
    yield prose(command.help)
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"```text\n{name} {usage}\n```"
    rows = []
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is not None and "--help" not in record[0]:
            rows.append([code(record[0]), re.sub(r"\s+", " ", record[1])])
    yield table(["option", "meaning"], rows)
    if isinstance(command, click.Group):
        for child in command.list_commands(context):
            yield from _commands(command.get_command(context, child), f"{name} {child}", min(depth + 1, 4))


def command_line() -> str:
    """Return the exit codes, and every command of ``bearing-sim``, and ``bearing_player``, with usage and options."""
    from bearing_sim.cli.main import main
    from bearing_sim.cli.reporting import EXIT_CODES

    parts = ["## Exit codes", table(["code", "meaning"], [[str(code), meaning] for code, meaning in EXIT_CODES.items()])]
    parts += list(_commands(main, "bearing-sim", 2))
    try:
        from bearing_sim.ros.player import command
    except ImportError:  # a machine without ROS 2
        pass
    else:
        parts += _commands(command, "bearing_player", 2)
    return "\n\n".join(part for part in parts if part)


def modules() -> str:
    """Return every module of the package with the first sentence of its docstring, room by room."""
    rooms: dict[str, list] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE)
        text = ast.get_docstring(ast.parse(path.read_text())) or ""
        if place.name != "__init__.py" or text:
            rooms.setdefault(place.parts[0] if len(place.parts) > 1 else "", []).append(
                [code(f"bearing_sim/{place.as_posix()}"), text.split("\n\n")[0]]
            )
    return "\n\n".join(f"## `bearing_sim/{room}`\n\n{table(['file', 'purpose'], rows)}" for room, rows in rooms.items())


def rooms() -> str:
    """Return the import law as a table, read from ``test/test_architecture.py``."""
    tree = ast.parse((ROOT / "test" / "test_architecture.py").read_text())
    (law,) = [ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "ROOMS"]
    rows = []
    for room, (packages, allowed) in law.items():
        if room != "__init__":
            path = PACKAGE / room / "__init__.py" if (PACKAGE / room).is_dir() else PACKAGE / f"{room}.py"
            purpose = (ast.get_docstring(ast.parse(path.read_text())) or "").split("\n\n")[0]
            rows.append([code(room), purpose, ", ".join(allowed.split()), ", ".join(packages.split())])
    return table(["room", "purpose", "imports these rooms", "imports these packages"], rows)


def limits() -> str:
    """Return the limits on files that are read, by the names that raise them."""
    from bearing_sim.files.limits import LIMITS

    return table(["name", "limit", "of"], [[code(limit.name), f"{limit.default:,} {limit.unit}", limit.bounds] for limit in LIMITS])


def claims() -> str:
    """Return the names of all tests as sentences, file by file."""
    sections = []
    for path in sorted((ROOT / "test").glob("test_*.py")):
        tree = ast.parse(path.read_text())
        names = [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
        listed = "\n".join(f"- {name.removeprefix('test_').replace('_', ' ')}" for name in names)
        sections.append(f"## `test/{path.name}`\n\n{prose(ast.get_docstring(tree))}\n\n{listed}")
    return "\n\n".join(sections)


def external_links() -> str:
    """Return every address outside of this repository that a document names; no page asks for it, since nothing here opens a connection."""
    pages = [
        *sorted((ROOT / "doc").rglob("*.md")),
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "QUALITY_DECLARATION.md", "package.xml")),
    ]
    rows = [(url, page.relative_to(ROOT)) for page in pages for url in sorted(set(re.findall(r"https?://[^\s)<>\]\"'`]+", page.read_text())))]
    return "\n".join(f"{url}  ({place})" for url, place in sorted(rows))


PARTS: dict[str, Callable[[], str]] = {
    function.__name__: function
    for function in (
        *(scene_fields, mapping_fields, bundled, input_topics, output_topics, cloud_fields, named_numbers, array_rows, observables, recorded_topics),
        *(parameters, services, subjects, events, validity, unwatched_laws, command_line, modules, rooms, limits, claims, external_links),
    )
}
_REQUEST = re.compile(r"^% generated: (\w+)$", re.MULTILINE)


def expanded(text: str) -> str:
    """Return a page with each request for a generated part replaced by the part."""
    return _REQUEST.sub(lambda request: PARTS[request[1]](), text)


# ------------------------------------------------------------------------------------------------------------------- docstrings


def numpydoc_to_fields(lines: list[str]) -> None:
    """Turn the sections of one of this package's docstrings into reStructuredText, in place.

    The package writes a parameter on one line, ``name : meaning [unit]``, continued by indented lines.
    """
    text, out, section = list(lines), [], ""
    index = 0
    while index < len(text):
        line = text[index]
        if index + 1 < len(text) and re.fullmatch(r"-{3,}", text[index + 1].strip()) and line.strip():
            section = line.strip()
            out += ["", f"**{section}**", ""]
            index += 2
            continue
        entry = re.match(r"^(\*{0,2}\w[\w, *.]*?) : (.*)$", line) if section else None
        if entry:
            out += ["", f"* ``{entry[1].strip()}``: {entry[2]}"]
        elif section in ("Raises",) and re.fullmatch(r"\w+", line):
            out += ["", f"* ``{line}``:"]
        elif section and line.startswith("    "):
            out.append("  " + line.strip())
        else:
            out.append(line)
        index += 1
    lines[:] = [*out, ""]


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("source-read", lambda app, page, source: source.__setitem__(0, expanded(source[0])))
    app.connect("autodoc-process-docstring", lambda app, what, name, thing, options, lines: numpydoc_to_fields(lines))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    print(*(PARTS[name]() for name in sys.argv[1:] or PARTS), sep="\n\n")
