# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The page "extend it": each of its changes applies to the package as it is, and does what the page says."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CHANGES = dict(zip(("watcher", "law", "observable"), re.findall(r"```diff\n(.*?)```", (ROOT / "doc/contributing/extend.md").read_text(), re.DOTALL)))


@pytest.fixture
def changed(tmp_path):
    """Return a function that applies a change to a copy of the package, and one that runs Python there."""
    shutil.copytree(ROOT / "bearing_sim", tmp_path / "bearing_sim", ignore=shutil.ignore_patterns("__pycache__"))

    def apply(name):
        done = subprocess.run(["git", "apply", "-"], input=CHANGES[name], text=True, cwd=tmp_path, capture_output=True)
        assert done.returncode == 0, done.stderr

    def python(code):
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=550)
        assert done.returncode == 0, done.stderr[-2000:]
        return json.loads(done.stdout.splitlines()[-1])

    return apply, python


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_applies_to_the_package_as_it_is(changed, name):
    apply, _ = changed
    apply(name)


def test_a_watcher_is_one_file_and_one_line(changed):
    apply, python = changed
    apply("watcher")
    assert CHANGES["watcher"].count("\n+++ ") == 2 and CHANGES["watcher"].count("\n-") - CHANGES["watcher"].count("\n--- ") == 0
    found = python(
        "import json, numpy as np; from bearing_sim import load_scene; from bearing_sim.model.sample import new_block\n"
        "from bearing_sim.watchers.monitoring.watchers import Watchers\n"
        "scene = load_scene('deng2017_table1', ['watchers=[hottest_roller]']); watchers = Watchers(scene)\n"
        "block = new_block(2, scene.bearing.roller.count); block['shaft_speed'] = 1000.0; block['inner_load'][:, 3] = 500.0\n"
        "watchers.see(block); print(json.dumps([watchers.values(0.0), [event.kind for event in watchers.events(0.0)]]))"
    )
    # 0.05 times 500 N times 1000 rad/s times 27.875 mm, of a roller that stands
    assert found[0] == {"watcher hottest_roller: hottest roller": 3, "watcher hottest_roller: sliding power [W]": pytest.approx(696.875)}
    assert found[1] == ["watcher.hottest_roller"]


@pytest.mark.long
def test_a_traction_law_needs_its_record_and_its_constants(changed):
    apply, python = changed
    apply("law")
    found = python(
        "import json; from bearing_sim import load_scene, Simulation\n"
        "law = ['lubricant.traction={law: saturating, mu_inf: 0.04, s_0: 0.02}']\n"
        "slips = [float(Simulation(load_scene('deng2017_table1', [*law, f'lubricant.traction.mu_inf={mu}'])).advance(0.05)['cage_slip'][-1])"
        " for mu in (0.005, 0.04)]\n"
        "print(json.dumps(slips))"
    )
    assert all(map(math.isfinite, found)) and found[0] > found[1]  # the less friction, the more slip


@pytest.mark.long
@pytest.mark.parametrize("level", ["slip", "planar"])
def test_an_observable_is_in_samples_topics_and_plots(changed, level):
    apply, python = changed
    apply("observable")
    found = python(
        "import json; from bearing_sim import load_scene, Simulation; from bearing_sim.messages.topics import ARRAYS\n"
        "from bearing_sim.view.plots import series\n"
        f"scene = load_scene('deng2017_table1', ['level={level}']); block = Simulation(scene).advance(0.002, samples=5)\n"
        "print(json.dumps([block['rollers_loaded'].tolist(), (block['inner_load'] > 0).sum(axis=1).tolist(), "
        "'rollers_loaded' in ARRAYS['operating_point'].fields, series(scene, block)['/loads/rollers'].tolist()]))"
    )
    assert found[0] == found[1] == found[3] and found[2] and max(found[0]) > 0
