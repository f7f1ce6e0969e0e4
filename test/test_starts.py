# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What each start imports: how many modules at most, and what it does without.  ``test/benchmarks/starts.py`` measures the seconds."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
# Numba imports the package coverage where it is installed, and with compiled code scipy.linalg.
_HEAVY = "pint matplotlib pandas xarray pyarrow rich rerun h5py distributed rosbags.rosbag2".split()
_SCIPY = [f"scipy.{name}" for name in "stats signal interpolate ndimage optimize special spatial".split()]
_WATCHERS = [f"bearing_sim.watchers.{name}" for name in ("estimation.response", "estimation.live", "vibration")]
_OWN = [*_WATCHERS, "bearing_sim.recording", "bearing_sim.view"]
_RUN = [*_HEAVY, *_SCIPY, *_OWN, "rosbags", "mcap", "rclpy"]
_NO_MODEL = [*_RUN, "scipy", "numba", "bearing_sim.levels", "bearing_sim.physics", "bearing_sim.simulation"]
_HIGHER = ["bearing_sim.levels.planar", "bearing_sim.levels.spatial"]
_NEW = ["new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000 rpm", "--load", "5 kN"]


def _command(*words):
    return f"from bearing_sim.cli.main import main; main({list(words)!r}, standalone_mode=False)"


def _run(level):
    return _command("run", "deng2017_table1", "--level", level, "--duration", "1 ms")


def _need_ros():
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")


# By name: what starts, modules at most (a tenth more than there are today), and what is not among them.
STARTS = {
    "--help": (_command("--help"), 85, [*_NO_MODEL, "numpy", "pydantic", "yaml", "bearing_sim.scene"]),
    "run --help": (_command("run", "--help"), 100, [*_NO_MODEL, "numpy", "pydantic", "yaml"]),
    "catalog": (_command("catalog"), 225, [*_NO_MODEL, "numpy", "yaml", "bearing_sim.scene.scene"]),
    "new": (_command(*_NEW), 380, _NO_MODEL),
    "fields": (_command("fields"), 345, _NO_MODEL),
    "scenes": (_command("scenes"), 380, _NO_MODEL),
    "import": ("from bearing_sim import Simulation, load_scene, settle", 710, [*_RUN, *_HIGHER, "scipy.linalg"]),
    "run": (_command("run", "deng2017_table1"), 1000, [*_RUN, *_HIGHER]),
    "run steady": (_run("steady"), 1000, [*_RUN, *_HIGHER]),
    "run planar": (_run("planar"), 1000, [*_RUN, "bearing_sim.levels.spatial"]),
    "run spatial": (_run("spatial"), 1000, _RUN),
    "node": (
        "import bearing_sim.ros.node",
        950,
        [*_HEAVY, *_SCIPY, *_HIGHER, "scipy.linalg", "bearing_sim.watchers.estimation.live", "bearing_sim.watchers.vibration"],
    ),
}
_LONG = ("run planar", "run spatial")


def modules(code):
    """Return the names of the modules that a program imports, without those of the interpreter's own start."""
    program = f"import sys; before = set(sys.modules)\n{code}\nimport json; print(json.dumps(sorted(set(sys.modules) - before)), file=sys.stderr)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, timeout=600, check=True)
    return [name for name in json.loads(done.stderr.splitlines()[-1]) if name.partition(".")[0] != "coverage"]


def faults(found, most, forbidden):
    """Return what is wrong with the modules of a start: forbidden ones, and how many there are if these are too many."""
    wrong = [name for name in forbidden if any(each == name or each.startswith(f"{name}.") for each in found)]
    return wrong + ([f"{len(found)} modules"] if len(found) > most else [])


@pytest.mark.parametrize("start", [pytest.param(name, marks=pytest.mark.long) if name in _LONG else name for name in STARTS])
def test_a_start_imports_what_it_uses(start):
    if start == "node":
        _need_ros()
    code, most, forbidden = STARTS[start]
    found = modules(code)
    assert faults(found, most, forbidden) == []
    assert len(found) > 0.5 * most, "the limit is far above what is there: lower it"


@pytest.mark.parametrize("added", ["pint", "scipy.stats", "bearing_sim.levels.spatial.model", "bearing_sim.watchers.estimation.bands"])
def test_an_import_that_is_not_used_is_found(added):
    code, most, forbidden = STARTS["import"]
    assert faults(modules(f"{code}; import {added}"), most, forbidden) != []


@pytest.mark.parametrize(
    ("level", "builds_on"), [("", ()), ("slip", ()), ("steady", ("slip",)), ("planar", ("slip",)), ("spatial", ("slip", "planar"))]
)
def test_a_level_is_imported_when_it_is_looked_up(level, builds_on):
    found = modules(f"from bearing_sim.levels.level import LEVELS; list(LEVELS); {level!r} and LEVELS[{level!r}]")
    assert {name.split(".")[2] for name in found if name.startswith("bearing_sim.levels.")} - {"common", "level"} == {level, *builds_on} - {""}
