# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A file that grows has what was put into it once, whoever hands it to the system."""

import threading

import pytest

from bearing_sim.sinks import growing_file
from bearing_sim.sinks.growing_file import GrowingFile


@pytest.mark.parametrize("second", ["drain", "watch"])
def test_two_threads_that_hand_on_at_once_write_nothing_twice_and_lose_nothing(second, tmp_path, monkeypatch):
    write_all, begun, go_on = growing_file._write_all, threading.Event(), threading.Event()

    def slow(descriptor, data, place):
        begun.set()
        assert go_on.wait(60.0)
        write_all(descriptor, data, place)

    monkeypatch.setattr(growing_file, "_write_all", slow)
    file = GrowingFile(tmp_path / "grows")
    for number in range(100):
        file.write(b"%03d," % number)
    first, other = threading.Thread(target=file.drain), threading.Thread(target=getattr(file, second))
    first.start()
    assert begun.wait(60.0)
    if second == "watch":
        (tmp_path / "grows").unlink()  # so that it is written anew, from what is in it so far
    other.start()
    other.join(0.2)
    go_on.set()
    first.join(60.0), other.join(60.0)
    assert file.fault is None and file.backlog == 0 and file.saved == 400
    assert (tmp_path / "grows").read_bytes() == b"".join(b"%03d," % number for number in range(100))
    file.close()
