# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim report``: one page of any result, or of what the model has been compared with."""

from pathlib import Path

import click

from bearing_sim.cli.outputs import OutputFile, WritingCommand, default_output
from bearing_sim.cli.reporting import UsageError, announce_compilation, as_file_error, as_usage_error, command_line, progress_bar, tell_use
from bearing_sim.files.limits import FileError
from bearing_sim.scene.errors import did_you_mean

_VALIDATION = "validation"
_HTML, _MARKDOWN = (".html", ".htm"), ".md"


@click.command("report", cls=WritingCommand)
@click.argument("source", metavar="RESULT")
@click.option(
    "-o",
    "--out",
    type=OutputFile(),
    metavar="PATH.html",
    help="The page [default: RESULT.html, or report.html in a folder]; of validation also PATH.md.",
)
@click.option("--only", "names", multiple=True, metavar="CHECK", help="Of validation: run only this check; can be repeated.")
@click.option(
    "--tests",
    type=click.Path(path_type=Path),
    metavar="FILE.xml",
    help="Of validation: what pytest wrote with --junitxml, of the claims of the test suite.",
)
@click.option(
    "--recordings",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Of validation: where the recorded vibration of Li and others (2013) lies, which is not redistributable.",
)
@click.option("--quick", is_flag=True, help="Of validation: leave out the checks that take minutes; the page says so.")
def report(source, out, names, tests, recordings, quick):
    """Make one page of RESULT: scene and bearing, tables, pictures, warnings, where it comes from, and the command that made it.

    RESULT is a table written by `sweep`, `design` or `study` (.parquet, or the .csv beside it), a recording written by `run` or `replay`
    (.mcap, or a bag's folder), a folder of such files, or the folder of `bearing-sim study deng2017`. The page is self-contained: it
    needs no network and no other file.

    The word `validation` (a result of that name: ./validation) runs every check of the model against something independent of it and makes a page
    of figures, tolerances and verdicts, which begins with what is not validated.
    """
    if source == _VALIDATION:  # as it is written: ./validation is a path
        if out is not None and out.path.suffix.lower() not in (*_HTML, _MARKDOWN):
            raise UsageError(f"-o {out}: expected a name that ends in .html or .md")
        _report_validation(out or default_output(Path("validation.html")), names, tests, recordings, quick)
        return
    if names or tests or recordings or quick:
        raise UsageError(f"--only, --tests, --recordings and --quick are for `bearing-sim report {_VALIDATION}`; {source} is a result")
    if out is not None and out.path.suffix.lower() not in _HTML:
        raise UsageError(f"-o {out}: expected a name that ends in .html")
    from bearing_sim.studies.page import NoResults
    from bearing_sim.studies.report_page import page_of

    result = Path(source)
    out = out or default_output(result / "report.html" if result.is_dir() else result.with_suffix(".html"))
    with as_usage_error(NoResults), as_file_error():
        page = page_of(result, tell_use)
        out.write_text(page)
    click.echo(f"{out}: {len(page.encode()) / 1e6:.1f} MB")


def _report_validation(out, names, tests, recordings, quick) -> None:
    if names and tests:
        raise UsageError("--tests adds the claims of the test suite to the page of all checks, --only chooses single checks; give one of them")
    announce_compilation()
    from bearing_sim.studies.validation.check import run
    from bearing_sim.studies.validation.checks import all_checks
    from bearing_sim.studies.validation.page import counted, html_page, markdown_page
    from bearing_sim.studies.validation.suite import SuiteError, suite_results
    from bearing_sim.vibration.signal import VibrationError

    with as_usage_error(SuiteError, FileError, VibrationError):
        checks = all_checks(recordings)
        held_by_tests = [] if names else suite_results(tests)
    known = {check.name: check for check in checks}
    for name in names:
        if name not in known:
            raise UsageError(f"--only {name}: there is no such check{did_you_mean(name, list(known))}; expected one of {', '.join(known)}")
    chosen = [known[name] for name in dict.fromkeys(names)] or checks
    with progress_bar("checks", len(chosen)) as show:
        results = [*run(chosen, quick, show), *held_by_tests]
    page = (markdown_page if out.path.suffix.lower() == _MARKDOWN else html_page)(results, command_line())
    with as_file_error():
        out.write_text(page)
    for each in results:
        if each.verdict != "holds":
            click.echo(f"{each.verdict}: {each.quantity}: {each.found}")
    click.echo(f"{out}: {counted(results)}")
