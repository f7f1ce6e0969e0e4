# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A file that is appended to contains whole records only, whatever the disk does."""

import errno
import os

import pytest

from bearing_sim.recording.append_file import AppendFile

RECORDS = [b"%03d," % number for number in range(100)]


class Disk:
    """Lets `os.pwrite` write ``room`` more bytes, and then fail as a full disk does."""

    def __init__(self, monkeypatch):
        self.room, self._pwrite = 10**9, os.pwrite
        monkeypatch.setattr(os, "pwrite", self)

    def __call__(self, descriptor, data, offset):
        if not self.room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = self._pwrite(descriptor, data[: self.room], offset)
        self.room -= written
        return written


@pytest.mark.parametrize("room", [0, 1, 4, 42, 43])
def test_a_record_that_was_written_in_part_is_cut_off_again(tmp_path, monkeypatch, room):
    file, disk = AppendFile(tmp_path / "grows"), Disk(monkeypatch)
    disk.room = room
    for record in RECORDS:
        file.write(record)
    assert file.error.errno == errno.ENOSPC and "could not be written" in str(file.error)
    assert (tmp_path / "grows").read_bytes() == b"".join(RECORDS)[: room // 4 * 4]
    assert file.tell() == 400, "later offsets count what is still to be written"


def test_what_could_not_be_written_is_written_once_there_is_room_again(tmp_path, monkeypatch):
    file, disk = AppendFile(tmp_path / "grows"), Disk(monkeypatch)
    disk.room = 42
    for record in RECORDS:
        file.write(record)
    assert not file.retry()
    disk.room = 10**9
    assert file.retry()
    assert (tmp_path / "grows").read_bytes() == b"".join(RECORDS)
    file.close()


@pytest.mark.parametrize("replaced", [False, True])
def test_a_file_deleted_or_replaced_is_restored_with_all_that_was_in_it(tmp_path, replaced):
    file = AppendFile(tmp_path / "grows")
    for record in RECORDS[:50]:
        file.write(record)
    (tmp_path / "grows").unlink()
    if replaced:
        (tmp_path / "grows").write_bytes(b"another's")
    file.check()
    for record in RECORDS[50:]:
        file.write(record)
    file.close()
    assert file.error is None and file.path.read_bytes() == b"".join(RECORDS)
    assert (file.path != tmp_path / "grows") == replaced and len(file.news) == 1


def test_nothing_is_written_below_the_free_space_to_be_kept_until_the_end(tmp_path):
    file = AppendFile(tmp_path / "grows", keep_free=1e18)
    file.write(b"first,")
    file.check()
    file.write(b"last")
    assert "less than the" in str(file.error) and (tmp_path / "grows").read_bytes() == b"first,"
    assert file.retry() and (tmp_path / "grows").read_bytes() == b"first,last"


def test_a_closed_file_writes_no_more_into_what_may_be_another_files_descriptor(tmp_path, monkeypatch):
    file, disk = AppendFile(tmp_path / "grows"), Disk(monkeypatch)
    disk.room = 6
    file.write(b"first,")
    file.write(b"last")
    file.close()
    disk.room = 10**9
    with open(tmp_path / "other", "wb"):  # takes the free descriptor
        assert file.retry() and file.tell() == 6
    assert (tmp_path / "other").read_bytes() == b"" and (tmp_path / "grows").read_bytes() == b"first,"
