# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Shared by the commands: errors and exit codes, announcements, JSON, tables and progress bars."""

import csv
import errno
import functools
import importlib.util
import json
import math
import shlex
import shutil
import signal
import sys
import textwrap
import threading
import time
from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import click

from bearing_sim.files.limits import printable
from bearing_sim.files.outputs import Output

EXIT_CODES = {
    0: "success; all of the input was used",
    1: "failure of a run, a check or a disk; `info` found damage, `compare` a difference, or `import-csv --guess` needs a decision",
    2: "an argument or an input is invalid; nothing is written",
    3: "success, but only a part of the input was used; the last message says how much, why, and what may help",
    4: "success, but the run has not settled",
    129: "the terminal was closed (SIGHUP); recordings are completed up to that moment, other files are not written",
    143: "SIGTERM; likewise",
}
"""What the exit codes of commands mean, for `bearing-sim --help` and the reference."""


class Ending(click.ClickException):
    """An end of a command with one message and an exit code."""

    def format_message(self) -> str:
        """Return the message with everything escaped that would act on a terminal: it may quote a file from a stranger."""
        return "".join(letter if letter.isprintable() or letter in "\n\t" else repr(letter)[1:-1] for letter in self.message)


class UsageError(Ending):
    """An argument or an input that cannot be used: one message, exit code 2."""

    exit_code = 2


class FailedRun(Ending):
    """A run that failed: one message, exit code 1."""

    exit_code = 1


class PartlyUsed(Ending):
    """A command that used only a part of what was there: one message after the result, exit code 3.  `tell_use` leads to it."""

    exit_code = 3


class Unsettled(Ending):
    """A run that was to go on until it settles and has not: one message after the result, exit code 4."""

    exit_code = 4


_PARTS = "bearing_sim.parts"  # key of what `tell_use` noted in the meta data of click's contexts


def tell_use(tally, source: str | Path, *more: str) -> None:
    """Let the running command end with `PartlyUsed` if it used only a part of what was there; nothing happens otherwise.

    Every command that reads calls this once it has read, and goes on to its result.

    Parameters
    ----------
    tally : a `bearing_sim.files.tally.Tally`.
    source : what was read.
    more : further texts for the message.
    """
    if not tally.is_whole:
        text = "; ".join([f"{printable(source)}: {tally.text}", *more])
        click.get_current_context().meta.setdefault(_PARTS, []).append(text)


def require_whole(context: click.Context) -> None:
    """Raise `PartlyUsed` if `tell_use` has noted parts in a context, which is at its end."""
    if parts := context.meta.get(_PARTS):
        raise PartlyUsed("\n".join(["only a part of what was there was used:", *(f"  {part}" for part in parts)] if len(parts) > 1 else parts))


@contextmanager
def as_usage_error(*kinds: type[Exception], ending: type[Ending] = UsageError) -> Iterator[None]:
    """Convert exceptions of these types to a `UsageError`, or to another ending of the command."""
    try:
        yield
    except kinds as error:
        raise ending(str(error)) from None


as_failed_run = functools.partial(as_usage_error, ending=FailedRun)
"""Convert exceptions of these types to a `FailedRun`."""


_FAILURES = ("IntegrationError", "NoWebViewer", "ViewerFailed")  # errors of the package that no other argument or input would have avoided
_DISK_FAILED = (errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.EFBIG)


@contextmanager
def as_ending() -> Iterator[None]:
    """Convert the errors that the package raises on purpose, and OSError, to an `Ending`: all others are faults of the program.

    A run that failed, and a disk that fails or is full, end with a `FailedRun`, anything else, such as a file that cannot be opened or a scene that
    is not valid, with a `UsageError`.
    """
    try:
        yield
    except (click.ClickException, BrokenPipeError):
        raise
    except OSError as error:
        raise (FailedRun if error.errno in _DISK_FAILED else UsageError)(str(error)) from None
    except Exception as error:
        kind = type(error)
        if not kind.__module__.startswith("bearing_sim.") or kind.__name__.startswith("_"):
            raise
        raise (FailedRun if kind.__name__ in _FAILURES else UsageError)(str(error)) from None


@contextmanager
def exit_on_sigterm() -> Iterator[None]:
    """Let SIGTERM unwind the program as Ctrl-C does, so that recordings are completed and drafts removed; exit code 143.

    Further signals of the kind do not disturb this.  The same holds for SIGHUP, which comes when a terminal is closed, unless it is ignored, as it
    is under nohup; exit code 129.
    """
    if threading.current_thread() is not threading.main_thread():  # only the main thread may set handlers
        yield
        return

    def unwind(number, _):
        signal.signal(number, signal.SIG_IGN)
        sys.exit(128 + number)

    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}
    for number, handler in before.items():
        if number == signal.SIGTERM or handler == signal.SIG_DFL:
            signal.signal(number, unwind)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def scene_of(name: str, overrides: Sequence[str], level: str | None = None):
    """Return a scene by name or file with the overrides of the command line, at another level if one is given."""
    from bearing_sim.scene.loader import load_scene

    return load_scene(name, [*overrides, *([f"level={level}"] if level else [])])


def judged(log, scene, longest_gap: float | None = None):
    """Return the profile of a log for a scene; every result depends on it.

    The command ends with `PartlyUsed` if only a part of the log can be used.  ``longest_gap`` as of `bearing_sim.inputs.profile.judge`.
    """
    from bearing_sim.inputs.profile import judge
    from bearing_sim.simulation import Inputs

    held = Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature)
    profile = judge(log, scene.accepted_inputs, held, longest_gap, scene.heat.law)
    tell_idle_temperature(scene, log)
    tell_use(profile.tally, log.path, *([profile.unknown_event.text] if profile.unknown_seconds else []))
    return profile


def unknown_report(profile) -> dict:
    """Return what of a log was used, for how long its inputs are unknown, and what that means for results (``verdict``), for JSON."""
    seconds = {"log_seconds": profile.log_seconds, "unknown_seconds": profile.unknown_seconds, "dropped_seconds": profile.dropped_seconds}
    return {"read": profile.tally.report(), **seconds, "verdict": profile.verdict}


def scene_of_point(name: str, overrides: Sequence[str], level: str | None = None, before_results: bool = True):
    """Return a scene as `scene_of` for results in thermal equilibrium, and print what is implausible about it as `warn_of_scene`.

    An oil temperature that its network computes is refused among the overrides (`refuse_idle_temperature`).
    """
    scene = scene_of(name, overrides, level)
    refuse_idle_temperature(scene, overrides)
    warn_of_scene(scene, before_results)
    return scene


ARGUMENTS = "bearing_sim.arguments"
"""Key of the arguments of the command line in the meta data of click's contexts."""


def command_line() -> str:
    """Return the command line of the running command as it was written, but for folders of absolute paths, which nobody else needs to know."""
    return shlex.join(["bearing-sim", *map(_without_folder, click.get_current_context().meta.get(ARGUMENTS, ()))])


def _without_folder(argument: str) -> str:
    """Return an argument with only the name of a file whose absolute path it is, or has after an equals sign; topics begin with a slash, too."""
    begin, sign, text = argument.rpartition("=")
    path = Path(text)
    try:
        is_file = len(path.parts) > 2 and path.is_absolute() and path.parent.is_dir()
    except (OSError, ValueError):  # ValueError: a null character
        is_file = False
    return f"{begin}{sign}{path.name}" if is_file else argument


def announce_compilation(scene=None, with_states: bool = False, bends: bool = False) -> None:
    """Announce on stderr that compiling will take a while, and how long, if what is needed has not been compiled in this version of the model yet.

    Parameters
    ----------
    scene : that is going to run; what it needs is known then, and compiled here.
    with_states : as of `bearing_sim.runtime.precompilation.is_compiled_for`.
    bends : whether outer rings bend in what is going to run; it is compiled when it is first needed.
    """
    from bearing_sim.numerics.compilation import CACHE_FOLDER
    from bearing_sim.runtime.precompilation import announcement, builds, compile_for, is_compiled

    if scene is not None:
        compile_for(scene, note, with_states)
    elif not any(CACHE_FOLDER.rglob("*.code")) or (bends and not any(is_compiled(level, bends) for level in ("steady", "slip"))):
        note(f"{announcement(builds(('steady', 'slip', 'planar'), bends))}, each when it is first needed")


def suggest_level(scene) -> None:
    """Suggest a faster level on stderr if one gives the same results."""
    from bearing_sim.scene.fidelity import hint

    if line := hint(scene):
        note(line)


def refuse_idle_temperature(scene, fields: Iterable[str]) -> None:
    """Raise `UsageError` where a command in thermal equilibrium was given an oil temperature that its network computes.

    Parameters
    ----------
    scene : with the overrides.
    fields : that the command line sets or varies, or ``FIELD=VALUE``.
    """
    named = {each.partition("=")[0].strip() for each in fields}
    if "lubricant.temperature" in named and (reason := _idle_temperature(scene)):
        raise UsageError(
            f"lubricant.temperature: {reason}; for a bearing and oil of this temperature add --set heat.law=none; for a cold or warm place set "
            "heat.ambient_temperature; for oil that flows through set heat.oil_flow"
        )


def tell_idle_temperature(scene, log) -> None:
    """Warn where a log has oil temperatures that the thermal network of a scene computes: they are where it begins, and no more."""
    if "oil_temperature" in log.series and (reason := _idle_temperature(scene)):
        warn([f"oil_temperature: {reason}: the log's temperatures are only where it begins; to run at them add --set heat.law=none"])


def _idle_temperature(scene) -> str:
    """Return why the temperature of the oil that comes in does not count in a scene; empty where it does."""
    if scene.heat.law != "network":
        return ""
    from bearing_sim.model.thermal_network import oil_flow

    given = scene.heat.conductances.oil_flow
    if (oil_flow(scene) if given is None else given) > 0.0:
        return ""
    return f"no oil flows through (supply {scene.lubricant.supply.law}), and heat.law network computes how warm it gets"


def note(line: str) -> None:
    """Print a line on stderr: what a person wants to know, and what is no result."""
    click.echo(line, err=True)


def warn(lines: Iterable[str]) -> None:
    """Print warnings on stderr, one on a line."""
    for line in lines:
        note(f"warning: {line}")


def warn_of_scene(scene, before_results: bool = True) -> None:
    """Print on stderr what is implausible about a scene, and which limits of laws it exceeds whatever it is used for.

    Parameters
    ----------
    scene : of the command.
    before_results : whether `warn_of_limits` follows, which knows more about those whose effect is computed.
    """
    from bearing_sim.model.plausibility import plausibility

    warn([*plausibility(scene), *(each.text for each in _warnings_of_scene(scene, before_results))])


def _warnings_of_scene(scene, before_results: bool = True) -> list:
    """Return the exceedances of a scene that `warn_of_scene` prints."""
    from bearing_sim.model.validity import Grade, scene_exceedances

    return [each for each in scene_exceedances(scene) if each.grade == Grade.WARNING and not (before_results and each.law.variations)]


def warn_of_limits(scene, exceedances: Iterable, verbose: bool = False) -> None:
    """Print on stderr which laws are used outside of their ranges and move a result, except for what `warn_of_scene` has printed.

    Parameters
    ----------
    scene : of the results.
    exceedances : graded, see `bearing_sim.sweep.grading.graded`.
    verbose : whether to print a note of those without effect and of assumptions, too.
    """
    from bearing_sim.model.plausibility import plausibility
    from bearing_sim.model.validity import Grade

    printed, implausible = {each.law.name for each in _warnings_of_scene(scene)}, plausibility(scene)
    for each in exceedances:
        if each.grade != Grade.WARNING:
            if verbose:
                note(f"note: {each.note}")
        elif each.law.name not in printed and each.text not in implausible:
            warn([each.text])


def warnings_report(scene, exceedances: Iterable) -> dict[str, list]:
    """Return for JSON ``warnings``, laws outside of their ranges with their grades, and ``implausible``, what is odd about the scene."""
    from bearing_sim.model.plausibility import plausibility

    return {"warnings": [each.report() for each in exceedances], "implausible": plausibility(scene)}


def attributes(source, *names: str) -> dict:
    """Return attributes of an object by their names, for JSON."""
    return {name: getattr(source, name) for name in names}


def print_json(report: Mapping) -> None:
    """Print one JSON object and nothing else; NaN and infinity become null."""
    click.echo(json.dumps(_finite(report), indent=2, allow_nan=False))


def _finite(value):
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_csv(output: Output, rows: Sequence[Mapping]) -> None:
    """Write rows to a CSV table; the keys of the first row are the columns of all."""
    if not rows:
        raise UsageError(f"{output}: nothing to write")
    with output.draft() as draft, open(draft, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def print_table(title: str, rows: Iterable[tuple[str, str]]) -> None:
    """Print a table of names and values."""
    print_groups(title, [list(rows)])


def print_groups(title: str, groups: Iterable[Sequence[tuple[str, str]]]) -> None:
    """Print a table of names and values with a line between groups; empty groups are left out."""
    groups = [group for group in groups if group]
    names, values = (max((len(row[place]) for group in groups for row in group), default=0) for place in (0, 1))
    room = shutil.get_terminal_size((150, 24)).columns - 1 - 2 * _BORDER
    names = min(names, max(room - values, (room + 1) // 2))
    _draw(title, (), groups, (names, min(values, room - names)), (True, True))


def print_rows(
    title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], words: Container[str] = (), width: int = 150, keys: int = 1
) -> None:
    """Print rows under headings, numbers aligned right.

    A number is never cut or broken: a table wider than the terminal is printed in parts, each of which begins with the same first columns.

    Parameters
    ----------
    title : above the table.
    columns : headings; they break between words.
    rows : texts, one per column.
    words : columns to align left, whose texts may break between words.
    width : of the table if there is no terminal, and the environment has no COLUMNS.
    keys : how many of the first columns stand in every part.
    """
    rows, available = [tuple(row) for row in rows], shutil.get_terminal_size((width, 24)).columns
    least = [_least_width(name, [row[place] for row in rows], name in words) for place, name in enumerate(columns)]
    parts = _parts(least, available, keys)
    for number, part in enumerate(parts):
        some = "" if len(parts) == 1 else f" ({number + 1} of {len(parts)})"
        headings, cells = [columns[place] for place in part], [[row[place] for place in part] for row in rows]
        _draw(f"{title}{some}", headings, [cells], _widths(headings, cells, words, available), [name in words for name in headings])


def print_points(title: str, table, names: Sequence[str], rows: Sequence[Mapping] | None = None, keys: int = 1, most: int = 50) -> None:
    """Print columns of a table of many points, of a long one the first rows, and the commonest reasons why points have no or no good result.

    Parameters
    ----------
    title : above the table.
    table : a `bearing_sim.sweep.table.Table`.
    names : of its columns.
    rows : in another order.
    keys : as of `print_rows`.
    most : number of rows that are printed.
    """
    rows = table.rows if rows is None else rows
    columns = [column_texts(table.column(name), [row[name] for row in rows[:most]]) for name in names]
    print_rows(title, [heading for heading, _ in columns], zip(*(texts for _, texts in columns)), words=("bearing", "housing", "status"), keys=keys)
    if len(rows) > most:
        click.echo(f"... and {len(rows) - most} more; all are in the files")
    for reason, count in Counter(f"{row['status']}: {row['reason']}" for row in rows if row["reason"]).most_common(5):
        click.echo(f"{count} x {reason}")


def column_texts(column, values) -> tuple[str, list[str]]:
    """Return the heading of a column of a table (`bearing_sim.sweep.point.Column`), and its values as people write them."""
    from bearing_sim.scene.display import LONGEST_LIFE, heading, number, shown
    from bearing_sim.sweep.pictures import as_shown

    if any(isinstance(value, (str, bool)) for value in values):
        return heading(column.name, column.unit), [str(value) for value in values]
    texts, digits = as_shown(column.name, column.unit, values), max(shown(column.name).digits, 4)
    longest = LONGEST_LIFE if column.unit == "h" else math.inf
    return texts.label, [f"> {number(longest)}" if value > longest else number(value, digits) for value in texts.values.tolist()]


_BORDER = 3  # characters that a column adds
_LEAST_OF_WORDS = 24  # characters of a column of words that is broken into lines


def _least_width(name: str, texts: Sequence[str], of_words: bool) -> int:
    """Return the width that a column needs."""
    heading = max((len(word) for word in name.split()), default=0)
    longest = max(map(len, texts), default=0)
    return max(heading, min(longest, _LEAST_OF_WORDS) if of_words else longest)


def _parts(least: Sequence[int], available: int, keys: int) -> list[list[int]]:
    """Return the places of the columns of each part of a table."""
    first, parts, part = list(range(min(keys, len(least)))), [], []
    room = available - 1 - sum(least[place] + _BORDER for place in first)
    left = room
    for place in range(len(first), len(least)):
        needed = least[place] + _BORDER
        if part and needed > left:
            parts.append(first + part)
            part, left = [], room
        part.append(place)
        left -= needed
    return [*parts, first + part]


def _draw(title: str, columns: Sequence[str], groups: Sequence[Sequence[Sequence[str]]], widths: Sequence[int], left: Sequence[bool]) -> None:
    """Draw a table: title, headings if there are any, and groups of rows with a line between them.

    Parameters
    ----------
    title, columns : texts; none: no headings.
    groups : of rows, which have a text a column; longer ones are broken between words.
    widths : of the columns [characters].
    left : whether a column is aligned left.
    """

    def rule(begin: str, between: str, end: str, dash: str = "─") -> list[str]:
        return [begin + between.join(dash * (width + 2) for width in widths) + end]

    def lines_of(row: Sequence[str], bar: str, is_heading: bool = False) -> Iterator[str]:
        cells = [_broken(text, width) for text, width in zip(row, widths)]
        height = max(map(len, cells))
        blanks = ([""] * (height - len(cell)) for cell in cells)
        for texts in zip(*(blank + cell if is_heading else cell + blank for cell, blank in zip(cells, blanks))):
            shown = (text.ljust(width) if to_left else text.rjust(width) for text, width, to_left in zip(texts, widths, left))
            yield bar + bar.join(f" {click.style(text, bold=True) if is_heading else text} " for text in shown) + bar

    lines = [click.style(line, italic=True) for line in _broken(title, sum(widths) + _BORDER * len(widths) + 1)]
    if columns:
        lines += [*rule("┏", "┳", "┓", "━"), *lines_of(columns, "┃", is_heading=True), *rule("┡", "╇", "┩", "━")]
    else:
        lines += rule("┌", "┬", "┐")
    for number, group in enumerate(groups):
        lines += rule("├", "┼", "┤") if number else []
        lines += [line for row in group for line in lines_of(row, "│")]
    click.echo("\n".join([*lines, *rule("└", "┴", "┘")]))


def _broken(text: str, width: int) -> list[str]:
    """Return a text in lines, broken between words, or within a word that is wider than a line."""
    if len(text) <= width and "\n" not in text:
        return [text]
    return [part for line in text.splitlines() for part in textwrap.wrap(line, width, break_on_hyphens=False) or [""]]


def _widths(columns: Sequence[str], rows: Sequence[Sequence[str]], words: Container[str], available: int) -> list[int]:
    """Return the widths of the columns: what each needs, and what is left for those whose heading or words would break."""
    texts = [[row[place] for row in rows] for place in range(len(columns))]
    widths = [_least_width(name, each, name in words) for name, each in zip(columns, texts)]
    over = sum(width + _BORDER for width in widths) + 1 - available
    if over > 0 and (broken := [place for place, name in enumerate(columns) if name in words]):  # one column of words beside the first ones
        widths[broken[-1]] = max(widths[broken[-1]] - over, 1)
    wanted = [max(width, len(name), *map(len, each or [""])) for name, each, width in zip(columns, texts, widths)]
    left = available - 1 - sum(width + _BORDER for width in widths)
    while left > 0 and (open_places := [place for place, width in enumerate(widths) if width < wanted[place]]):
        place = min(open_places, key=lambda each: widths[each] / wanted[each])
        widths[place] += 1
        left -= 1
    return widths


@contextmanager
def progress_bar(text: str, total: float) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on stderr, where that is no terminal a line now and then; yields the function that takes how much of ``total`` is done."""
    if not (sys.stderr.isatty() and importlib.util.find_spec("rich")):
        with _progress_lines(text, total) as show:
            yield show
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.table import Column

    def whole(width):  # a narrow terminal cuts the words, never the times
        return Column(no_wrap=True, min_width=width)

    columns = (
        TextColumn("{task.description}", table_column=Column(ratio=1, no_wrap=True, overflow="ellipsis")),
        BarColumn(16),
        TaskProgressColumn(table_column=whole(4)),
        TimeElapsedColumn(table_column=whole(7)),
        TextColumn("left", table_column=whole(4)),
        TimeRemainingColumn(table_column=whole(7)),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True, expand=True) as bar:
        task = bar.add_task(text, total=total)
        yield lambda done: bar.update(task, completed=done)


_LINE_EVERY = 10.0  # [s]


@contextmanager
def _progress_lines(text: str, total: float) -> Iterator[Callable[[float], None]]:
    """Print a line of progress on stderr every `_LINE_EVERY`, also while nothing is done; yields the function that takes how much is."""
    begun, done, ended = time.monotonic(), [0.0], threading.Event()

    def tell() -> None:
        while not ended.wait(_LINE_EVERY):
            if done[0] < total:  # what follows, such as writing, has no measure
                note(f"{text}: {100.0 * done[0] / total:.0f} % after {time.monotonic() - begun:.0f} s")

    def show(now: float) -> None:
        done[0] = now

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield show
    finally:
        ended.set()
        teller.join()


class Points:
    """A progress bar for points, which counts those computed now and those kept from an earlier run; a context manager.

    Attributes
    ----------
    computed, kept : counts so far.
    """

    def __init__(self, text: str, total: int):
        self._text, self._total, self._stack = text, total, ExitStack()
        self._show = None
        self.computed, self.kept = 0, total

    def __enter__(self):
        self._stack.enter_context(progress_bar(f"{self._text}: preparing", 1.0))
        return self

    def __exit__(self, *error):
        return self._stack.__exit__(*error)

    def update(self, done: int, pending: int) -> None:
        """Update the bar: how many of the pending points are done, and how many there are; none done begins a new bar."""
        self.computed, self.kept = done, self._total - pending
        if self._show is None or done == 0:
            self._stack.close()
            kept = f", {self.kept} kept from before" if self.kept > 0 else ""
            self._show = self._stack.enter_context(progress_bar(f"{self._text}: {pending} points{kept}", max(pending, 1)))
        self._show(done)
