# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Outputs of commands: types of the options that name them.

`bearing_sim.cli.results.Command` refuses an output that is an input, exists (without ``--force``), is no regular file, or is named twice.
"""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from bearing_sim.cli.reporting import UsageError, note
from bearing_sim.files.outputs import Output, RefusedOutput

_RECORDINGS = (".mcap", ".active", ".db3", ".bag", ".zstd", ".yaml")  # files of an input folder that no command replaces
OUTPUTS = "bearing_sim.outputs"
"""Key of what a command writes in the meta data of click's contexts: outputs by parameter, whether by force, and its inputs."""


class OutputFile(click.ParamType):
    """The type of an option that names a file to write; the command gets an `Output`.

    Parameters
    ----------
    suffixes : of which the name must have one; empty if any will do.
    """

    name = "file"

    def __init__(self, *suffixes: str):
        self.suffixes = suffixes

    def convert(self, value, param, ctx):
        """Return the output, which `bearing_sim.cli.results.Command` completes by the rest of the command line; a wrong suffix is refused."""
        output = value if isinstance(value, Output) else Output(value)
        if self.suffixes and output.path.suffix.lower() not in self.suffixes:
            raise UsageError(f"{option_name(param)} {output}: expected a name that ends in {', '.join(self.suffixes)}")
        return output

    may_exist = False  # because it is continued, or because the command itself decides whether it may replace it

    def beside(self, path: Path) -> list[Path]:
        """Return further files that this option makes, which may exist."""
        return []

    def made(self, path: Path) -> list[Path]:
        """Return the files that this option makes, which must not exist unless by force."""
        return [] if self.may_exist else [path]

    def continued(self, path: Path) -> list[Path]:
        """Return the files that this option makes and that may exist."""
        return [path, *self.beside(path)] if self.may_exist else self.beside(path)

    def check(self, output: Output) -> None:
        """Raise `RefusedOutput` if one of the files must not be written."""
        for path in self.made(output.path):
            Output(path, output.force, output.inputs).check()
        for path in self.continued(output.path):
            Output(path, True, output.inputs).check()


class OutputRecording(OutputFile):
    """The type of an option that names a recording, which is ``PATH.active`` while it is written; one that a killed run has left is set aside."""

    def beside(self, path: Path) -> list[Path]:
        """Return the recording's draft."""
        return [path.with_name(f"{path.name}.active")]


class OutputJournal(OutputFile):
    """The type of an option that names a journal, to which results are appended."""

    may_exist = True


class OutputWithJournal(OutputFile):
    """The type of an option that names a file with a journal beside it, from which an interrupted run resumes.

    Whether a file that exists may be replaced is for the command to decide once it knows its study (`bearing_sim.sweep.table.same_points`).
    """

    may_exist = True

    def beside(self, path: Path) -> list[Path]:
        """Return the journal."""
        return [path.with_suffix(".journal")]


class OutputTable(OutputWithJournal):
    """The type of an option that names the table of many points: Parquet, CSV and a journal.

    Whether tables that exist may be replaced is for the command to decide once it knows its study (`bearing_sim.sweep.table.require_same_study`).

    Parameters
    ----------
    parts : what is added to the name for further tables.
    """

    def __init__(self, *parts: str):
        super().__init__()
        self._parts = ("", *parts)

    def continued(self, path: Path) -> list[Path]:
        """Return the tables and the journal."""
        tables = (path.with_name(f"{path.stem}{part}{suffix}") for part in self._parts for suffix in (".parquet", ".csv"))
        return [*tables, *self.beside(path)]


class OutputFolder(OutputFile):
    """The type of an option that names a folder to write into, which is made if absent; what is in it is for the command to check."""

    name = "folder"

    def made(self, path: Path) -> list[Path]:
        """Return the folder if it has to be made."""
        return [] if path.is_dir() else [path]


@contextmanager
def recording_into(output: Output, sink) -> Iterator:
    """Yield the sink that writes an output, say what happened to its file, and where an interrupted recording is.

    Parameters
    ----------
    output : the recording.
    sink : a `bearing_sim.recording.writer.McapSink`, which this completes.
    """
    for _, _, text in sink.news():
        note(f"warning: {text}")
    try:
        with sink:
            yield sink
    except BaseException:
        unfinished = output.path.with_name(f"{output.path.name}.active")
        note(f"interrupted; what was recorded until then is {unfinished if unfinished.exists() else output}")
        raise


def default_output(path: Path) -> Output:
    """Return an output of the running command under a name that the command chooses, checked; an option names it otherwise.

    Raises
    ------
    RefusedOutput
        It must not be written, or another option names it.
    """
    outputs, force, inputs = click.get_current_context().meta[OUTPUTS]
    require_distinct({"the default output": [path]} | {f"--{name}": [output.path] for name, output in outputs.items()})
    output = Output(path, force, inputs)
    output.check()
    return output


def paths_in(value) -> Iterator[Path]:
    """Yield the files that the value of an option or argument may name: paths, names of scene files, ``FIELD=FILE``, files of a bag's folder."""
    if isinstance(value, (tuple, list)):
        for each in value:
            yield from paths_in(each)
    elif isinstance(value, str):
        for text in {value, value.rpartition("=")[2]}:
            if 0 < len(text) < 4096 and "\0" not in text:
                yield from paths_in(Path(text))
    elif isinstance(value, Path):
        yield value
        if os.path.isdir(value):  # False also for a text that is too long for a path
            yield from (path for path in value.glob("*") if path.suffix in _RECORDINGS)


def require_distinct(files: dict[str, Sequence[Path]]) -> None:
    """Raise `RefusedOutput` if two options name the same file."""
    owners: dict[str, str] = {}
    for option, paths in files.items():
        for path in dict.fromkeys(os.path.realpath(each) for each in paths):
            if path in owners:
                raise RefusedOutput(f"{owners[path]} and {option} both write {path}; name different files")
            owners[path] = option


def option_name(parameter) -> str:
    """Return how an output's option is called in messages."""
    return max(parameter.opts[:2], key=len) if parameter is not None else "output"
