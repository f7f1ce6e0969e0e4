# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files that the program keeps for itself: a damaged one is never used and never an error, and where none can be written the run goes on."""

import json
import math
import os
import random
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from made_up_response import asking_scene, made_up_response

from bearing_sim import load_scene
from bearing_sim.files import kept
from bearing_sim.files.kept import checked_contents, kept_if_possible, read_kept, with_checksum, write_kept
from bearing_sim.files.limits import JSON_FILE
from bearing_sim.levels.steady import table_builder
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.levels.steady.table_builder import Quality, assembled, read_table, write_table
from bearing_sim.scene import measured_tradeoffs
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, kept_path, read_kept_tradeoffs
from bearing_sim.sweep.tasks import Journal, JournalInUse
from bearing_sim.watchers.estimation.correction import Correction, read_correction, write_correction
from bearing_sim.watchers.estimation.response import Domain, read_response, write_response
from bearing_sim.watchers.stored_state import history
from bearing_sim.watchers.stored_state.state import new_state
from bearing_sim.watchers.stored_state.state_file import StateError, StateFile, previous_path, read_state
from bearing_sim.watchers.stored_state.totals import Totals

FLIPS, CUTS = 200, 20
SCENE = load_scene("deng2017_table1")
QUALITY = Quality(*(kind(1) for kind in Quality.__annotations__.values()))


def _front(folder):
    errors = dict.fromkeys(measured_tradeoffs.ERRORS, math.nan) | {"slip": 1.9, "largest_slip": 3.8}
    extent = {"shaft_speed": (1000.0, 5000.0), "radial_load": (400.0, 800.0), "oil_temperature": (370.0, 380.0)}
    setting = Setting("slip", "tolerances x 1", ("integration.fixed_step=null",), 12.0, errors)
    measured_tradeoffs.keep(SCENE, MeasuredCourse("idle", "planar", errors, extent, (setting,)))
    return kept_path(SCENE), lambda: read_kept_tradeoffs(SCENE)


@cache
def _made_up():
    return made_up_response(asking_scene())


def _response(folder):
    write_response(path := folder / "one.bands.npz", _made_up())
    return path, lambda: read_response(path)


def _table(folder):
    axes = [np.linspace(1.0, 2.0, size) for size in (4, 5, 2, 2, 1)]
    values = np.random.default_rng(1).random((1, *map(len, axes), len(ANSWER)))
    table = assembled([*axes[:3], np.array([0.0, 1.0]), np.zeros(1)], math.inf, math.nan, values)
    write_table(path := folder / "one.npz", table, QUALITY)
    return path, lambda: read_table(path)


def _correction(folder):
    arrays = [np.ones(shape) for shape in ((9, 4), (2, 3, 3), (9, len(ANSWER)), (9, len(ANSWER)), (9, 2), (1, 6))]
    write_correction(
        path := folder / "one.correction.npz", Correction(Domain((1.0, 2.0), (1.0, 2.0), (300.0, 310.0), 0.0, math.nan), *arrays, 0, 1.0)
    )
    return path, lambda: read_correction(path)


def _state(folder):
    state = new_state(SCENE, "A1", 0)
    state.totals.damage, state.writes, state.written_ns = 0.1, 1, 10**18
    file = StateFile(folder / "a.json")
    file.write(state)
    file.close()
    assert not previous_path(file.path).exists()

    def read():
        try:
            return read_state(file.path)[0]
        except StateError as error:
            assert f"{file.path}: " in str(error) and "put a copy in its place" in str(error)
            return None

    return file.path, read


def _journal(folder):
    results = {f"{k:032x}": {"slip": [k / 7.0, math.nan], "reason": f"number {k}"} for k in range(10)}
    with Journal(path := folder / "one.journal") as journal:
        for key, result in results.items():
            journal.add(key, result)

    def read():
        whole = path.read_bytes()
        try:
            with Journal(path) as journal:
                wrong = [key for key in results if key in journal and repr(journal[key]) != repr(results[key])]
                return True if wrong or len(journal) == len(results) else None  # lines are accepted or refused one by one
        except JournalInUse:
            return None
        finally:
            path.write_bytes(whole)

    return path, read


def _days(folder, with_pyarrow):
    path, rows = folder / "a.json", [{"day": f"2024-10-{day:02}", **history.row_of(Totals(damage=0.1 / day, starts=day))} for day in range(1, 9)]
    parquet, table = history.history_paths(path)
    if with_pyarrow:
        pytest.importorskip("pyarrow")
        history.write_history(path, rows, 1)
    else:
        history._write_csv(table, rows, history.Move(1, [row["day"] for row in rows]))
    assert history.read_history(path)[0] == rows

    def read():
        try:
            found = history.read_history(path)
        except (OSError, ValueError):
            return None
        # what stands beside the rows, such as the name of the library that wrote them, is not of interest
        return True if found[0] != rows or found[1] != history.Move(1, [row["day"] for row in rows]) or whole == file.read_bytes() else None

    file = parquet if with_pyarrow else table
    whole = file.read_bytes()
    return file, read


KINDS = {
    "front": _front,
    "response": _response,
    "table": _table,
    "correction": _correction,
    "state": _state,
    "journal": _journal,
    "days in Parquet": lambda folder: _days(folder, True),
    "days in CSV": lambda folder: _days(folder, False),
}
IN_THE_CACHE = ("front", "response", "table", "correction")


@pytest.fixture(params=KINDS)
def file(request, tmp_path, monkeypatch):
    """Return a kept file and the function that returns what it holds, None where that cannot be used."""
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path)
    monkeypatch.setattr(kept, "_told", set())
    return KINDS[request.param](tmp_path)


def test_no_flipped_bit_and_no_cut_is_accepted_or_an_error_and_what_is_whole_is_accepted(file):
    path, read = file
    assert read() is not None
    whole, chosen = path.read_bytes(), random.Random(46)
    for _ in range(FLIPS):
        data = bytearray(whole)
        data[chosen.randrange(len(data))] ^= 1 << chosen.randrange(8)
        path.write_bytes(data)
        assert read() is None, [at for at in range(len(whole)) if data[at] != whole[at]]
    for length in np.linspace(0, len(whole) - 1, CUTS).astype(int).tolist():
        path.write_bytes(whole[:length])
        assert read() is None, length
    path.write_bytes(whole)
    assert read() is not None


@pytest.mark.parametrize("kind", IN_THE_CACHE)
@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (lambda path: path.write_bytes(path.read_bytes()[:-1]), "is damaged: it"),
        (lambda path: path.write_bytes(b""), "is damaged: it is empty"),
        (lambda path: (path.unlink(), path.mkdir()), "cannot be read: a folder, expected a file"),
        (lambda path: (path.unlink(), path.symlink_to("nowhere")), "cannot be read: a link to a file that does not exist"),
        (lambda path: (path.unlink(), os.mkfifo(path)), "cannot be read: a pipe, expected a file"),
    ],
)
def test_what_cannot_be_used_is_said_once_with_its_file_and_reason(kind, spoil, reason, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path)
    path, read = KINDS[kind](tmp_path)
    assert read() is not None and not caplog.messages
    spoil(path)
    assert read() is read() is None
    (said,) = caplog.messages
    assert said.startswith(f"{path} {reason}") and said.endswith("; it is ignored and built again")


def test_an_absent_file_is_nothing_to_speak_of(tmp_path, caplog):
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "absent", tmp_path / "no folder" / "absent", tmp_path / "file" / "absent"):
        assert read_kept(path, JSON_FILE, bytes) is None
    assert not caplog.messages


def test_a_front_of_another_version_counts_as_none_and_a_new_one_takes_its_place(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path)
    path, read = _front(tmp_path)
    version, contents = checked_contents(path.read_bytes(), "front")
    write_kept(path, with_checksum("front", version + 1, contents))
    assert read() is None and "is of version" in caplog.text
    _front(tmp_path)
    assert read() is not None


def test_what_is_written_is_plain_json_for_others():
    assert json.loads(with_checksum("lock", 3, {"a": 1.5})) | {"checksum": ""} == {
        "format": "bearing_sim lock", "version": 3, "checksum": "", "lock": {"a": 1.5}
    }  # fmt: skip


def test_damaged_lines_of_a_journal_are_computed_again_and_their_number_is_said(tmp_path, caplog, monkeypatch):
    monkeypatch.setattr(kept, "_told", set())
    path, _ = _journal(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[3], lines[7] = lines[3].replace(b"number 3", b"number 8"), lines[7][:20] + b"\n"
    path.write_bytes(b"".join(lines))
    with Journal(path) as journal:
        assert [k for k in range(10) if f"{k:032x}" not in journal] == [3, 7]
        journal.add(f"{3:032x}", {"slip": 0.0})
    assert caplog.messages == [f"{path} is damaged: 2 of its lines; their tasks are computed again"]
    with Journal(path) as journal:
        assert len(journal) == 9 and journal[f"{3:032x}"] == {"slip": 0.0}


UNWRITABLE = {
    "a file in the place of the folder": lambda folder: (folder.parent / "file").write_text("") and None or folder.parent / "file" / "tables",
    "a file system that takes no files": lambda folder: Path("/proc/tables"),
    "no right to write": lambda folder: folder,
}


@pytest.fixture(params=UNWRITABLE)
def unwritable(request, tmp_path, monkeypatch):
    folder = tmp_path / "tables"
    folder.mkdir(mode=0o555)
    if request.param == "no right to write" and os.access(folder, os.W_OK):
        pytest.skip("root may write everywhere")
    monkeypatch.setattr(kept, "_told", set())
    return UNWRITABLE[request.param](folder)


def test_a_folder_that_cannot_be_written_is_said_once_and_the_run_goes_on(unwritable, caplog):
    for name in ("one.npz", "two.npz"):
        with kept_if_possible(unwritable / name):
            write_kept(unwritable / name, b"data")
    with Journal(unwritable / "one.journal", is_own=True) as journal:
        journal.add("a", {"slip": 1.0})
        assert journal["a"] == {"slip": 1.0}
    (said,) = caplog.messages
    assert said.startswith(f"{unwritable}: nothing is kept there for the next run, since it cannot be written: ")
    with pytest.raises(OSError):
        Journal(unwritable / "one.journal")  # that a user has named


def test_nothing_is_kept_for_a_user_without_a_home_folder(monkeypatch, caplog):
    def refuse(name):
        raise RuntimeError("could not determine the home directory")

    monkeypatch.setattr("platformdirs.user_cache_dir", refuse)
    monkeypatch.setattr(kept, "_told", set())
    path = kept.cache_folder() / "tables" / "one.npz"
    assert read_kept(path, JSON_FILE, bytes) is None and not caplog.messages
    with kept_if_possible(path):
        write_kept(path, b"data")
    assert len(caplog.messages) == 1 and str(path.parent) in caplog.text


def test_a_full_disk_ends_no_journal_of_the_cache(tmp_path, caplog, monkeypatch):
    monkeypatch.setattr(kept, "_told", set())
    with Journal(tmp_path / "one.journal", is_own=True) as journal:
        journal._file.close()
        journal._file = open("/dev/full", "r+b")
        journal.add("a", {"slip": 1.0})
        journal.add("b", {"slip": 2.0})
        assert journal["a"] == {"slip": 1.0}
    assert len(caplog.messages) == 1 and "No space left on device" in caplog.text


def test_a_table_is_built_where_none_can_be_kept(unwritable, caplog, monkeypatch):
    monkeypatch.setattr(table_builder, "FOLDER", unwritable)
    monkeypatch.setattr(table_builder, "build_table", lambda *_, **__: (empty_table(), QUALITY))
    assert table_builder.obtain_table(SCENE)[1] == table_builder.obtain_table(SCENE)[1] == QUALITY
    assert len(caplog.messages) == 1 and str(unwritable) in caplog.text


def test_files_of_the_web_viewer_are_taken_again_if_damaged_and_for_this_process_where_they_cannot_be_kept(tmp_path, monkeypatch, caplog):
    web = pytest.importorskip("bearing_sim.view.web")
    taken = []

    def unpack(folder):
        taken.append(folder)
        for name in web._NEEDED:
            (folder / name).write_bytes(b"<html></html>")

    monkeypatch.setattr(web, "_unpack", unpack)
    monkeypatch.setattr(web, "version", lambda name: "0.0")
    monkeypatch.setattr(web, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(kept, "_told", set())
    folder = web.viewer_files()
    assert folder == web.viewer_files() == tmp_path / "cache" / "web_viewer" / "0.0" and len(taken) == 1
    for name in (*web._NEEDED, web._DIGESTS):
        whole = (folder / name).read_bytes()
        (folder / name).write_bytes(bytes([whole[0] ^ 1]) + whole[1:])
        assert web.viewer_files() == folder and (folder / name).read_bytes() == whole
    assert len(taken) == 5 and "is damaged" in caplog.text
    monkeypatch.setattr(web, "cache_folder", lambda: Path("/proc"))
    elsewhere = web.viewer_files()
    assert (elsewhere / web._NEEDED[0]).is_file() and "/proc/web_viewer: nothing is kept there" in caplog.text
