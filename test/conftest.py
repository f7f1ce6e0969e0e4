# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What all tests share: hypothesis without deadlines (the first call compiles) and the same examples every time; no kept fronts; a strict rerun.

On several cores (``pytest -n auto --dist loadgroup``) the files run side by side, but never two that run something in real time.
"""

import atexit
import os
import shutil
import signal
import subprocess
import tempfile

import pytest
from hypothesis import settings

settings.register_profile("bearing_sim", deadline=None, derandomize=True)
settings.load_profile("bearing_sim")

# What somebody has measured on this machine must change no test, also in the processes that tests start.
os.environ["BEARING_SIM_FRONTS"] = tempfile.mkdtemp(prefix="bearing_sim_fronts_")
atexit.register(shutil.rmtree, os.environ["BEARING_SIM_FRONTS"], ignore_errors=True)

_REAL_TIME = {
    "test_bench_view",
    "test_demo",
    "test_first_ten_minutes",
    "test_fleet",
    "test_frozen_viewer",
    "test_governor",
    "test_governor_front",
    "test_launch_files",
    "test_live",
    "test_measure",
    "test_priority",
    "test_recorder",
    "test_recording_files",
    "test_shared_memory",
    "test_solver",
    "test_view",
}

# Each would compile the equations of the dynamic levels for itself.
_DYNAMIC = {"test_flanges", "test_level_planar", "test_planar_reference", "test_power", "test_spatial_reference", "test_support"}

# What draws beside a solver: on two cores with another test on one of them, the server of the view, in idle time, never gets to run.
_ALONE = {"test_bench_view", "test_frozen_viewer", "test_view"}


def pytest_configure():
    """Let SIGINT reach the programs that tests interrupt: a shell starts what runs in its background without it."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)  # before xdist reads the groups
def pytest_collection_modifyitems(items):
    """Keep the tests of a file together, all files that run something in real time, and all that compile the same."""
    for item in items:
        name = item.path.stem
        is_real_time = name in _REAL_TIME or (name.startswith("test_node") and name != "test_node_lifecycle")  # which is long, and in no hurry
        item.add_marker(pytest.mark.xdist_group("real_time" if is_real_time else "dynamic" if name in _DYNAMIC else name))
        if name in _ALONE:
            item.add_marker(pytest.mark.alone)


@pytest.fixture
def strict_rerun():
    """Let rerun raise where it would only log what it cannot use, and lose it."""
    import rerun as rr

    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)


@pytest.fixture
def small_disk(tmp_path):
    """Return a folder on a disk of 1 MB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(folder)], capture_output=True, text=True, check=False)
    if mounted.returncode:
        pytest.skip(f"no right to mount a small disk: {mounted.stderr.strip()}")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)
