# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""No output of any command destroys a file of its user; ``python test/benchmarks/output_walk.py`` kills commands and fills disks."""

import errno
import json
import os
import signal
import stat
import subprocess
import sys
import threading
import time

import click
import pytest
from click.testing import CliRunner
from output_cases import CASES, commands, file_name, outputs

from bearing_sim.cli.main import main
from bearing_sim.cli.options import csv_option, json_option, picture_option
from bearing_sim.cli.outputs import OutputFile, OutputFolder, OutputJournal, OutputWithJournal
from bearing_sim.cli.reporting import note
from bearing_sim.cli.results import Command, Result, command
from bearing_sim.files.outputs import Output, RefusedOutput, protecting_inputs, remember_input, rename_without_replacing, replaced
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, require_same_study, study_digest, write_table
from bearing_sim.sweep.tasks import Journal, JournalInUse

OLD = b"worth a lot"
INPUTS = {
    "replay --state-file",
    "replay-fleet --bearings",
    "design --points",
    "uncertainty --log",
    "table --from",
}
"""Options with a path that is read; the state file of `replay` is also kept by it, as by the node."""
OUTPUTS = outputs()
NAMES = [f"{name} {option.opts[-1]}" for name, option in OUTPUTS]
READING = [(name, option) for name, option in OUTPUTS if any(argument.startswith("{") for argument in CASES[name].arguments)]
CONTINUED = (OutputWithJournal, OutputJournal, OutputFolder)


def called(arguments, folder):
    """Return the outcome of a command with files of a folder in place of its inputs."""
    return CliRunner().invoke(main, [argument.format_map(Names(folder)) for argument in arguments])


class Names(dict):
    """A file in a folder for every name of an input."""

    def __init__(self, folder):
        self._folder = folder

    def __missing__(self, name):
        return str(self._folder / name)


def contents(folder):
    """Return what is in a folder: bytes of files, targets of links, kinds of other things."""
    return {
        path.name: path.read_bytes() if path.is_file() else os.readlink(path) if path.is_symlink() else stat.S_IFMT(path.lstat().st_mode)
        for path in folder.iterdir()
    }


def test_every_option_with_a_path_is_known_as_an_output_or_an_input_and_every_output_is_tried():
    plain = {
        f"{name} {max(option.opts, key=len)}"
        for name, command in commands()
        for option in command.params
        if isinstance(option, click.Option) and isinstance(option.type, click.Path)
    }
    assert plain == INPUTS, "an output has a type of bearing_sim.cli.outputs"
    assert {name for name, _ in OUTPUTS} == set(CASES)
    assert all(isinstance(command, Command) for name, command in commands() if name in CASES)


@pytest.mark.parametrize(("name", "option"), OUTPUTS, ids=NAMES)
def test_an_output_is_refused_where_there_is_anything_but_a_file_of_its_own(name, option, tmp_path):
    target = tmp_path / file_name(option)
    arguments = [*CASES[name].arguments, option.opts[-1], str(target)]

    def refused(reason, *more):
        before = contents(tmp_path)
        result = called([*arguments, *more], tmp_path)
        assert result.exit_code == 2 and reason in result.output, result.output
        assert "Traceback" not in result.output and contents(tmp_path) == before

    for path in (*option.type.made(target), *option.type.continued(target)):
        os.mkfifo(path)
        refused(f"{path} is a pipe", "--force")
        path.unlink()
        if not isinstance(option.type, OutputFolder):
            path.mkdir()
            refused(f"{path} is a folder", "--force")
            path.rmdir()
        path.symlink_to(tmp_path / "gone")
        refused("which does not exist", "--force")
        path.unlink()
    if not isinstance(option.type, CONTINUED):
        target.write_bytes(OLD)
        refused("exists; use --force to replace it")
    arguments[-1] = str(tmp_path / "absent" / target.name)
    refused("there is no folder")


@pytest.mark.parametrize(("name", "option"), READING, ids=[f"{name} {option.opts[-1]}" for name, option in READING])
def test_an_output_never_replaces_an_input_by_whatever_name(name, option, tmp_path):
    arguments = CASES[name].arguments
    given = [argument for argument in arguments if argument.startswith("{")]
    target = tmp_path / file_name(option)
    written = [*option.type.made(target), *option.type.continued(target)][0]
    for source in given:
        path = tmp_path / source[1:-1]
        for link in (os.link, os.symlink):
            path.write_bytes(OLD)
            link(path, written)
            result = called([*arguments, option.opts[-1], str(target), "--force"], tmp_path)
            if isinstance(option.type, OutputFolder):
                assert result.exit_code == 2
            else:
                assert result.exit_code == 2 and "is an input of this command" in result.output, result.output
            assert path.read_bytes() == OLD
            written.unlink()


def drawing(fails):
    """Return a command that writes a file of its own, a table and a picture, whose drawing may fail."""

    @command("draw")
    @csv_option("Write a table.")
    @picture_option("Draw it")
    @json_option
    def found():
        def plot(draft):
            if fails:
                raise OSError(errno.EIO, "the disk has failed")
            draft.write_bytes(b"drawn")

        return Result(
            {"slip": 0.5, "picture": None, "files": None, "kept": None},
            lambda: click.echo("slip 0.5"),
            plot,
            [{"slip": 0.5}],
            files=["own.txt"],
            warnings=["outside of its range"],
            after=lambda: note("after it"),
        )

    return found


@pytest.mark.parametrize("fails", [False, True])
@pytest.mark.parametrize("as_json", [False, True])
def test_a_result_is_told_with_its_warnings_and_the_files_written_also_where_its_picture_cannot_be_drawn(fails, as_json, tmp_path):
    table, picture = str(tmp_path / "a.csv"), str(tmp_path / "a.png")
    told = CliRunner().invoke(drawing(fails), ["-o", table, "--picture", picture, *(["--json"] if as_json else [])])
    written = ["own.txt", table] + ([] if fails else [picture])
    if as_json:
        assert json.loads(told.stdout) == {"slip": 0.5, "picture": None if fails else picture, "files": written, "kept": None}
    else:
        assert told.stdout.splitlines() == ["slip 0.5", ", ".join(written)]
    assert told.stderr.startswith("warning: outside of its range\nafter it\n") and ("the disk has failed" in told.stderr) == fails
    assert (told.exit_code != 0) == fails and os.path.exists(picture) != fails


def test_two_outputs_of_a_command_are_two_files(tmp_path):
    result = called(["run", "deng2017_table1", "--out", str(tmp_path / "x"), "--rrd", str(tmp_path / "." / "x")], tmp_path)
    assert result.exit_code == 2 and "--out and --rrd both write" in result.output and not contents(tmp_path)


def test_a_file_that_a_scene_names_is_an_input_too(tmp_path):
    contour = tmp_path / "contour.csv"
    with protecting_inputs():
        contour.write_bytes(OLD)
        remember_input(contour)
        with pytest.raises(RefusedOutput, match="input of this command"):
            Output(contour, force=True).check()
    Output(contour, force=True).check()


def test_what_another_thread_reads_is_no_input_of_this_command(tmp_path):
    (tmp_path / "s.csv").write_bytes(OLD)
    with protecting_inputs():
        other = threading.Thread(target=remember_input, args=(tmp_path / "s.csv",))
        other.start()
        other.join()
        Output(tmp_path / "s.csv", force=True).check()


@pytest.mark.parametrize("has_links", [True, False])
def test_a_file_takes_a_free_name_and_no_taken_one_on_any_file_system(has_links, tmp_path, monkeypatch):
    def no_links(*_):
        raise OSError(errno.EPERM, "no links here")

    if not has_links:
        monkeypatch.setattr(os, "link", no_links)
    (tmp_path / "draft").write_bytes(b"new")
    (tmp_path / "taken").write_bytes(OLD)
    (tmp_path / "gone").symlink_to("nowhere")
    for name in ("taken", "gone"):
        with pytest.raises(FileExistsError):
            rename_without_replacing(tmp_path / "draft", tmp_path / name)
    assert contents(tmp_path) == {"draft": b"new", "taken": OLD, "gone": "nowhere"}
    rename_without_replacing(tmp_path / "draft", tmp_path / "free")
    assert contents(tmp_path) == {"free": b"new", "taken": OLD, "gone": "nowhere"}


def test_a_study_completes_its_own_table_and_replaces_no_other(tmp_path):
    def written(digest, slip, force=False):
        require_same_study(Output(tmp_path / "s.parquet", force), digest)
        write_table(tmp_path / "s.parquet", Table((Column("slip", "", "of the cage"),), [{"slip": slip}], {"study": digest}))
        return contents(tmp_path)

    ours, others = study_digest("sweep", [0.5, 0.8]), study_digest("sweep", [0.5, 0.9])
    (tmp_path / "s.csv").write_bytes(OLD)
    with pytest.raises(RefusedOutput, match=r"s\.csv exists and was not written by this study; use --force to replace it"):
        written(ours, 0.1)
    (tmp_path / "s.csv").unlink()
    assert set(made := written(ours, 0.1)) == {"s.csv", "s.parquet"}
    assert (again := written(ours, 0.2)) != made
    with pytest.raises(RefusedOutput, match=r"s\.parquet exists and was not written by this study"):
        written(others, 0.3)
    assert contents(tmp_path) == again != written(others, 0.3, force=True)
    (tmp_path / "s.csv").write_bytes(OLD)  # notes of the user in the table that we made
    with pytest.raises(RefusedOutput, match=r"s\.csv exists"):
        written(others, 0.3)
    assert contents(tmp_path)["s.csv"] == OLD


def test_a_journal_is_never_added_to_another_file(tmp_path):
    with Journal(tmp_path / "s.journal") as journal:
        journal.add("a", {})
        journal.add("b", {})
    whole = (tmp_path / "s.journal").read_bytes()
    for old in (OLD, b"", whole[:4], whole[:-30]):
        (tmp_path / "s.journal").write_bytes(old)
        if old == OLD:
            with pytest.raises(JournalInUse, match="no journal of bearing-sim"), Journal(tmp_path / "s.journal"):
                pass
            assert (tmp_path / "s.journal").read_bytes() == OLD
        else:
            with Journal(tmp_path / "s.journal") as journal:
                assert len(journal) == old.count(b"\n")


@pytest.mark.parametrize("error", [ValueError("bad"), OSError(errno.EIO, "bad"), KeyboardInterrupt(), SystemExit(143)], ids=repr)
@pytest.mark.parametrize("old", [None, OLD])
def test_a_write_that_fails_leaves_the_old_file_and_no_draft(tmp_path, old, error):
    if old is not None:
        (tmp_path / "a.csv").write_bytes(old)
    before = contents(tmp_path)
    for writing in (Output(tmp_path / "a.csv", force=True).draft(), replaced(tmp_path / "a.csv")):
        with pytest.raises(type(error)), writing as draft:
            draft.write_bytes(b"half")
            raise error
        assert contents(tmp_path) == before


def test_a_full_disk_leaves_the_old_file_and_no_draft(small_disk):
    (small_disk / "a.csv").write_bytes(OLD)
    with pytest.raises(OSError) as raised:
        Output(small_disk / "a.csv", force=True).write_bytes(bytes(2_000_000))
    assert raised.value.errno == errno.ENOSPC and contents(small_disk) == {"a.csv": OLD}


@pytest.fixture
def usual_handlers():
    """Handle signals as in a terminal; a shell starts background jobs with SIGINT ignored, and nohup ignores SIGHUP."""
    usual = {signal.SIGTERM: signal.SIG_DFL, signal.SIGINT: signal.default_int_handler, signal.SIGHUP: signal.SIG_DFL}
    before = {number: signal.signal(number, handler) for number, handler in usual.items()}
    yield usual
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_unwinds_a_command_that_writes(tmp_path, usual_handlers, number):
    @click.command(cls=Command)
    @click.option("--out", type=OutputFile())
    def write(out):
        with out.draft() as draft:
            draft.write_bytes(b"half")
            os.kill(os.getpid(), number)
            time.sleep(60)  # the handler runs before this returns

    (tmp_path / "a.csv").write_bytes(OLD)
    result = CliRunner().invoke(write, ["--out", str(tmp_path / "a.csv"), "--force"])
    assert result.exit_code == (1 if number == signal.SIGINT else 128 + number) and contents(tmp_path) == {"a.csv": OLD}
    assert usual_handlers == {each: signal.getsignal(each) for each in usual_handlers}


def test_an_output_keeps_permissions_and_links(tmp_path):
    (tmp_path / "real.csv").write_bytes(OLD)
    (tmp_path / "real.csv").chmod(0o640)
    (tmp_path / "link.csv").symlink_to("real.csv")
    Output(tmp_path / "link.csv", force=True).write_bytes(b"new")
    assert contents(tmp_path) == {"real.csv": b"new", "link.csv": b"new"} and (tmp_path / "link.csv").is_symlink()
    assert stat.S_IMODE((tmp_path / "real.csv").stat().st_mode) == 0o640


def test_a_file_made_meanwhile_is_not_replaced(tmp_path):
    with pytest.raises(RefusedOutput, match="exists"), Output(tmp_path / "a.csv").draft() as draft:
        draft.write_bytes(b"new")
        (tmp_path / "a.csv").write_bytes(OLD)
    assert contents(tmp_path) == {"a.csv": OLD}


def test_one_program_writes_a_file_at_a_time_and_what_a_killed_one_left_blocks_nobody(tmp_path):
    output = Output(tmp_path / "a.csv")
    with output.draft() as draft:
        draft.write_bytes(b"first")
        with pytest.raises(RefusedOutput, match="another program"), Output(tmp_path / "a.csv").draft():
            pass
    assert contents(tmp_path) == {"a.csv": b"first"}
    draft.write_bytes(b"much longer than what comes now")  # as a killed process leaves it
    Output(tmp_path / "a.csv", force=True).write_bytes(b"second")
    assert contents(tmp_path) == {"a.csv": b"second"}
    os.link(tmp_path / "a.csv", draft)  # killed just when the file had got its name
    with pytest.raises(KeyboardInterrupt), Output(tmp_path / "a.csv", force=True).draft():
        raise KeyboardInterrupt
    assert contents(tmp_path) == {"a.csv": b"second"}


@pytest.mark.parametrize("name", ["a" * 251 + ".csv", "\udce4\udcff.csv", " ", "a\nb.png"])
def test_names_of_any_kind_are_written(tmp_path, name):
    Output(tmp_path / name).write_bytes(b"new")
    assert contents(tmp_path) == {name: b"new"}


def test_on_a_system_without_posix_locks_a_scene_loads_and_an_output_is_refused_in_a_sentence(tmp_path):
    code = f"""
import sys
sys.modules["fcntl"] = None  # as on Windows
from bearing_sim import load_scene
from bearing_sim.files.outputs import RefusedOutput, replaced
load_scene("deng2017_table1")
try:
    with replaced({str(tmp_path / "kept")!r}):
        pass
except RefusedOutput as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert "which this system does not have" in done.stdout and not done.stderr and not list(tmp_path.iterdir())
