# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Ports in shared memory that a killed program left unfinished do not keep later programs from starting."""

import os
import threading
import time

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.utilities import get_rmw_implementation_identifier  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from support import wait_for  # noqa: E402

from bearing_sim.ros.shared_memory import SHARED_MEMORY, remove_unfinished_ports  # noqa: E402

FINISHED = b"\x02\x00\x00\x00" + bytes(60)
INITIALISING = b"\x01\x00\x00\x00" + bytes(60)
HOUR = 3600.0


def file_of(path, content, age=HOUR):
    path.write_bytes(content)
    os.utime(path, (time.time() - age,) * 2)
    return path


@pytest.mark.parametrize("content", [b"", b"\x00\x00", INITIALISING], ids=["empty", "cut off", "being initialised"])
def test_an_old_unfinished_port_is_removed_at_once_and_named(tmp_path, content):
    port = file_of(tmp_path / "fastrtps_port12661", content)
    began = time.monotonic()
    (note,) = remove_unfinished_ports(tmp_path, patience=30.0)
    assert time.monotonic() - began < 15.0
    assert not port.exists() and note.startswith(f"{port}: removed")


def test_finished_ports_locks_and_files_of_others_are_kept_and_nothing_waits(tmp_path):
    kept = [file_of(tmp_path / "fastrtps_port12661", FINISHED, age=0.0)]
    kept += [
        file_of(tmp_path / name, b"", age=0.0) for name in ("fastrtps_port12661_el", "fastrtps_port12661_sl", "fastrtps_0123456789abcdef", "sem.x")
    ]
    began = time.monotonic()
    assert remove_unfinished_ports(tmp_path, patience=30.0) == []
    assert time.monotonic() - began < 15.0 and all(path.exists() for path in kept)


def test_a_port_that_its_program_finishes_in_the_meantime_is_kept(tmp_path):
    port = file_of(tmp_path / "fastrtps_port12661", b"", age=0.0)
    finish = threading.Timer(0.3, port.write_bytes, [FINISHED])
    finish.start()
    assert remove_unfinished_ports(tmp_path, patience=30.0) == []
    finish.join()
    assert port.read_bytes() == FINISHED


def test_a_young_unfinished_port_is_removed_after_the_patience(tmp_path):
    port = file_of(tmp_path / "fastrtps_port12661", b"", age=0.0)
    began = time.monotonic()
    assert len(remove_unfinished_ports(tmp_path, patience=0.3)) == 1
    assert time.monotonic() - began > 0.25 and not port.exists()


def test_a_port_that_is_begun_while_another_is_waited_for_is_kept(tmp_path):
    left, begun = file_of(tmp_path / "fastrtps_port12661", b"", age=0.0), tmp_path / "fastrtps_port12663"
    begin = threading.Timer(0.5, begun.write_bytes, [b""])
    begin.start()
    assert [note.split(":")[0] for note in remove_unfinished_ports(tmp_path, patience=1.0)] == [str(left)]
    begin.join()
    assert begun.exists()


def test_a_time_of_the_file_in_the_future_delays_no_longer_than_the_patience(tmp_path):
    file_of(tmp_path / "fastrtps_port12661", b"", age=-HOUR)
    began = time.monotonic()
    assert len(remove_unfinished_ports(tmp_path, patience=0.3)) == 1
    assert time.monotonic() - began < 15.0


def test_without_shared_memory_there_is_nothing_to_do(tmp_path):
    assert remove_unfinished_ports(tmp_path / "none") == []


@pytest.mark.long
@pytest.mark.skipif("fastrtps" not in get_rmw_implementation_identifier() or not SHARED_MEMORY.is_dir(), reason="the ports are those of Fast DDS")
def test_a_node_starts_in_a_domain_where_a_program_was_killed_while_making_its_port(tmp_path):
    domain = fresh_domain()
    port = file_of(SHARED_MEMORY / f"fastrtps_port{7400 + 250 * domain + 11}", b"")  # of the first participant (DDSI-RTPS 2.5, section 9.6.2.3)
    node = NodeProcess(tmp_path, domain)
    client = None
    try:
        wait_for(lambda: f"{port}: removed" in node.text)
        client = Client(domain)
        client.wait_until_matched(node)
        client.drive_until(lambda: client.received["cage_slip"], "the node runs", node)
    finally:
        if client is not None:
            client.close()
        node.end(9)
