# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recorder, view and viewers leave the processor to the solver, in every one of their threads; Ctrl-C is left to who feeds them."""

import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from rerun.chunk import RrdReader
from support import wait_for
from synthetic_run import synthetic_block

from bearing_sim.recording import priority
from bearing_sim.ros.warm_up import start_compiling
from bearing_sim.scene.loader import load_scene
from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN, HeadlessViewer, ViewerFailed
from bearing_sim.view.sink import RerunSink
from bearing_sim.view.viewer import free_port

if not hasattr(os, "SCHED_IDLE") or not Path("/proc/self/task").is_dir():
    pytest.skip("needs Linux' policies and its /proc", allow_module_level=True)

SCENE = load_scene("deng2017_table1")
BLOCK = synthetic_block(SCENE, 1e-3 * np.arange(1, 201))
LIBC = ctypes.CDLL(None, use_errno=True)  # its own view of policies, where Python's is what is tested
IDLE, BATCH = 5, 3  # of sched(7)


def policies(pid):
    """Return the policy of every thread of a process, by the kernel; but for those of Mesa's disk cache, which set their own where they may."""
    threads = {int(thread.name): (thread / "comm").read_text() for thread in Path(f"/proc/{pid}/task").iterdir()}
    return {number: LIBC.sched_getscheduler(number) for number, name in threads.items() if ":disk$" not in name}


def is_gone(pid):
    return not Path(f"/proc/{pid}").exists()


def feed(sink, seconds):
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        sink.write(BLOCK)
        time.sleep(0.05)


def test_every_thread_of_the_view_runs_in_idle_time_in_the_session_of_its_feeder_and_in_a_group_of_its_own():
    with RerunSink(SCENE, serve_port=free_port()) as sink:
        assert sink.wait_until_ready(60.0)
        feed(sink, 1.0)
        found = policies(sink.pid)
        assert len(found) > 5 and set(found.values()) == {IDLE}, "those of rerun as well"
        assert os.getsid(sink.pid) == os.getsid(0) and os.getpgid(sink.pid) == sink.pid != os.getpgid(0)


@pytest.mark.long
def test_a_view_that_writes_a_file_gives_way_but_has_a_share_of_its_own(tmp_path):
    with RerunSink(SCENE, path=tmp_path / "run.rrd", serve_port=free_port()) as sink:
        assert sink.wait_until_ready(60.0)
        feed(sink, 0.5)
        assert set(policies(sink.pid).values()) == {BATCH} and os.getsid(sink.pid) == sink.pid != os.getsid(0)


@pytest.mark.long
def test_every_thread_of_a_viewer_that_we_start_beside_a_solver_runs_in_idle_time():
    with RerunSink(SCENE, serve_port=(port := free_port())) as sink:
        assert sink.wait_until_ready(60.0)
        feed(sink, 1.0)
        try:
            with HeadlessViewer(f"rerun+http://127.0.0.1:{port}/proxy", size=(400, 300), in_idle_time=True) as viewer:
                found = policies(viewer.pid)
                assert os.getsid(viewer.pid) == os.getsid(0)
        except ViewerFailed as fault:
            if HOW_TO_GET_VULKAN not in str(fault):
                raise
            pytest.skip(f"needs a Vulkan driver: {fault}")
    assert len(found) > 5 and set(found.values()) == {IDLE}


def test_compiling_cheaper_levels_gives_way_but_does_not_wait_for_idle_time_which_a_solver_that_is_too_slow_leaves_none_of():
    process = start_compiling(SCENE, lower=True)
    try:
        wait_for(lambda: set(policies(process.pid).values()) == {BATCH})
        assert os.getpriority(os.PRIO_PROCESS, process.pid) == min(19, os.getpriority(os.PRIO_PROCESS, 0) + 10)
    finally:
        process.kill()
        process.wait()


ON_ONE_CORE = """
import os, subprocess, sys, time
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
sys.path.insert(0, sys.argv[2])
from test_priority import BLOCK, SCENE
from bearing_sim.recording.recorder import Recorder
with Recorder(capacity=2_000_000) as recorder:
    sink = recorder.open(sys.argv[1], SCENE, 0)
    beside = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        for k in range(10):  # 2 s at 1 kHz, as they would come
            block = BLOCK.copy()
            block["time"] += 0.2 * k
            sink.write(block)
            time.sleep(0.2)
    finally:
        for process in beside:
            process.kill()
    sink.close(60.0)
print(sink.dropped)
"""


@pytest.mark.long
def test_a_recording_is_complete_though_busy_processes_of_the_same_session_take_the_core_that_it_has(tmp_path):
    command = [sys.executable, "-c", ON_ONE_CORE, str(tmp_path / "run.mcap"), str(Path(__file__).parent)]
    found = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=120, check=True, start_new_session=True)
    assert found.stdout.strip() == "0" and rows(tmp_path / "run.mcap") == 2000


def rows(path):
    with open(path, "rb") as stream:
        return sum(1 for _, channel, _ in make_reader(stream).iter_messages(topics=["/roller_loads"]))


AT_A_TERMINAL = """
import fcntl, json, signal, sys, termios, time
fcntl.ioctl(0, termios.TIOCSCTTY, 0)  # the terminal of this session, in whose foreground this process is
interrupted = []
signal.signal(signal.SIGINT, lambda *_: interrupted.append(True))
sys.path.insert(0, sys.argv[2])
from test_priority import BLOCK, RerunSink, SCENE, free_port
from bearing_sim.recording.recorder import Recorder
with Recorder() as recorder, RerunSink(SCENE, path=sys.argv[1] + ".rrd") as view, RerunSink(SCENE, serve_port=free_port()) as pictures:
    record = recorder.open(sys.argv[1] + ".mcap", SCENE, 0)
    written = 0
    def write():
        global written
        block = BLOCK[:10].copy()
        block["time"] += 0.01 * written
        record.write(block)
        view.write(block)
        written += 1
    print(json.dumps([view.pid, pictures.pid]), flush=True)  # as early as can be: the view may not even have begun to read
    while not interrupted:
        write()
        time.sleep(0.05)
    print("interrupted", flush=True)
    sys.stdin.readline()
    view.wait_until_ready(60.0)
    time.sleep(1.0)  # it has some seconds for what is left when its input ends
    write()
    record.close(60.0)
    print(json.dumps([written, view.close(60.0), pictures.failure]), flush=True)
"""


@pytest.mark.long
def test_ctrl_c_at_a_terminal_reaches_who_feeds_and_no_view_before_it_is_fed_to_the_end(tmp_path):
    ours, terminal = os.openpty()
    command = [sys.executable, "-c", AT_A_TERMINAL, str(tmp_path / "run"), str(Path(__file__).parent)]
    with subprocess.Popen(command, stdin=terminal, stdout=subprocess.PIPE, text=True, start_new_session=True) as feeder:
        try:
            pids = json.loads(feeder.stdout.readline())
            time.sleep(0.3)
            os.write(ours, b"\x03")
            assert feeder.stdout.readline() == "interrupted\n"
            time.sleep(0.3)
            assert not any(map(is_gone, pids))
            os.write(ours, b"\n")
            written, is_shown, fault = json.loads(feeder.stdout.readline())
            assert feeder.wait(60.0) == 0
        finally:
            feeder.kill()
            os.close(ours)
            os.close(terminal)
    wait_for(lambda: all(map(is_gone, pids)))
    assert is_shown and fault is None and shown_rows(tmp_path / "run.rrd") == rows(tmp_path / "run.mcap") == 10 * written


def shown_rows(path):
    chunks = (chunk for chunk in RrdReader(str(path)).stream() if chunk.entity_path == "/slip/cage" and not chunk.is_static)
    return sum(chunk.to_record_batch().num_rows for chunk in chunks)


WITHOUT = """
import os, sys
def refused(*_):
    raise PermissionError(1, "Operation not permitted")
def gone(name):
    if hasattr(os, name):
        delattr(os, name)
if sys.argv[1] == "forbidden":
    os.sched_setscheduler = refused
else:
    for name in ("sched_setscheduler", "SCHED_IDLE", "SCHED_BATCH", "sched_param", "getsid"):
        gone(name)
from bearing_sim.recording import priority
{"idle": priority.use_idle_time, "way": lambda: priority.use_low_priority(5)}[sys.argv[2]]()
print(os.nice(0))
"""


@pytest.mark.parametrize("system", ["forbidden", "absent"])
@pytest.mark.parametrize(("manner", "niceness"), [("idle", 19), ("way", 5)])
def test_where_policies_are_forbidden_or_unknown_niceness_is_what_is_left(system, manner, niceness):
    found = subprocess.run([sys.executable, "-c", WITHOUT, system, manner], capture_output=True, text=True, timeout=60, check=True)
    assert int(found.stdout) == min(19, os.nice(0) + niceness)


def test_a_command_in_idle_time_is_the_same_process_with_the_same_words_and_environment():
    told = "import os, sys, json; print(json.dumps([os.getpid(), sys.argv[1:], os.environ['WORD'], os.sched_getscheduler(0)]))"
    command = priority.in_idle_time([Path(sys.executable), "-c", told, "a b", "--idle-time"])
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ, WORD="kept")) as process:
        assert json.loads(process.stdout.readline()) == [process.pid, ["a b", "--idle-time"], "kept", IDLE]


def test_a_program_that_is_not_there_is_told_in_a_line():
    found = subprocess.run(priority.with_low_priority(["/nowhere/rerun"], 3), capture_output=True, text=True, timeout=60)
    assert found.returncode == 1 and found.stderr.strip() == "/nowhere/rerun cannot be started: No such file or directory"


def test_signals_end_what_runs_in_idle_time_as_they_would_without():
    process = subprocess.Popen(
        priority.in_idle_time(["sleep", "60"]),
        # a shell starts background jobs with SIGINT ignored, and children inherit that
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    wait_for(lambda: Path(f"/proc/{process.pid}/comm").read_text() == "sleep\n")
    process.send_signal(signal.SIGINT)
    assert process.wait(30) == -signal.SIGINT
