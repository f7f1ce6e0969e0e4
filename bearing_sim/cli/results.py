# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a command is: it checks its outputs before it begins, and returns a `Result`, which is written, drawn and shown in one place."""

import functools
import inspect
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

import click

from bearing_sim.cli.outputs import OUTPUTS, OutputFile, option_name, paths_in, require_distinct
from bearing_sim.cli.reporting import Ending, Points, as_ending, command_line, exit_on_sigterm, print_json, warn, write_csv
from bearing_sim.files.outputs import FORCE, Output, protecting_inputs


class Result(NamedTuple):
    """What a command found: for programs, for people and for files.

    The options ``--json``, ``--picture`` and the CSV table of ``-o`` are answered from it; a command need not take them as parameters.
    """

    report: Mapping  # the one object that --json prints
    show: Callable[[], None] = lambda: None  # prints it for people
    plot: Callable[[Path], None] | None = None  # draws it into a file
    rows: Sequence[Mapping] | None = None  # of the table
    remarks: Sequence[str] = ()  # printed after it for people
    warnings: Sequence[str] = ()  # printed on stderr after it
    files: Sequence[Path] = ()  # that were written
    after: Callable[[], None] | None = None  # prints on stderr what comes after the result
    code: int = 0  # of exit
    ending: Ending | None = None  # raised at the end: what was found is no success

    def deliver(self, as_json: bool = False, picture: Output | None = None, table: Output | None = None) -> None:
        """Write the table and the picture that are asked for, and print the result as JSON or for people, also where they cannot be written.

        Where a report has None for them, ``picture`` and ``files`` say what was written.
        """
        written, drawn = [str(file) for file in self.files], None
        try:
            if table is not None and self.rows is not None:
                write_csv(table, self.rows)
                written.append(str(table))
            if picture is not None and self.plot is not None:
                with picture.draft() as draft:
                    self.plot(draft)
                written.append(drawn := str(picture))
        finally:
            if as_json:
                made = {"picture": drawn, "files": written}
                print_json({name: made.get(name) if value is None else value for name, value in self.report.items()})
            else:
                self.show()
                for remark in [*self.remarks, *([", ".join(written)] if written else [])]:
                    click.echo(remark)
            warn(self.warnings)
            if self.after is not None:
                self.after()
        if self.ending is not None:
            raise self.ending
        if self.code:
            sys.exit(self.code)


@contextmanager
def resumed(out: Output, study: str, *bars: Points, parts: Sequence[str] = ("",)) -> Iterator:
    """Yield the journal of a study of many points, from which an interrupted one resumes, and show its bars of progress.

    Tables of another study are refused before it begins, and once more before they are replaced.

    Parameters
    ----------
    out : the table; ``parts`` is what is added to its name for all that are written.
    study : digest of what defines the study (`bearing_sim.sweep.table.study_digest`).
    """
    from bearing_sim.sweep.table import require_same_study
    from bearing_sim.sweep.tasks import Journal

    require_same_study(out, study, parts)
    with Journal(out.path.with_suffix(".journal")) as journal, ExitStack() as stack:
        for bar in bars:
            stack.enter_context(bar)
        yield journal
    require_same_study(out, study, parts)


def signed(table, study: str):
    """Return a table of results that names the command and the digest of the study that made it."""
    return table._replace(about=table.about | {"command": command_line(), "study": study})


class Command(click.Command):
    """A command whose errors are reported in one message, and whose `Result` is delivered.

    Of one that writes files all outputs are checked before it begins, and SIGTERM unwinds it, so that it leaves no drafts.
    """

    def __init__(self, *args, **options):
        super().__init__(*args, **options)
        self._writing = {parameter.name: parameter for parameter in self.params if isinstance(parameter.type, OutputFile)}
        if self._writing:
            self.params.append(click.Option([FORCE, "force"], is_flag=True, help="Replace existing files; an input is never replaced."))

    def invoke(self, context):
        """Run the command with its outputs checked."""
        with as_ending():
            if not self._writing:
                return self._delivered(context)
            force = context.params.pop("force")
            given = {name: context.params[name] for name in self._writing if context.params[name] is not None}
            inputs = [path for name, value in context.params.items() if name not in self._writing for path in paths_in(value)]
            outputs = {name: Output(value.path, force, inputs) for name, value in given.items()}
            context.params.update(outputs)
            context.meta[OUTPUTS] = outputs, force, inputs
            kinds = {option_name(self._writing[name]): (self._writing[name].type, output) for name, output in outputs.items()}
            require_distinct({option: [*kind.made(output.path), *kind.continued(output.path)] for option, (kind, output) in kinds.items()})
            for kind, output in kinds.values():
                kind.check(output)
            with protecting_inputs(), exit_on_sigterm():
                return self._delivered(context)

    def _delivered(self, context):
        """Run the command with the parameters that it takes, and deliver its result by the others."""
        taken = inspect.signature(self.callback).parameters
        ours = {name: context.params[name] for name in ("as_json", "picture", "table") if name in context.params}
        context.params = {name: value for name, value in context.params.items() if name in taken or name not in ours}
        result = super().invoke(context)
        if not isinstance(result, Result):
            return result
        result.deliver(**ours)


command = functools.partial(click.command, cls=Command)
"""Return the decorator of a command by its name."""
