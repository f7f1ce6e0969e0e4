# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim compile``: all that runs later is compiled, and nothing of this version is thrown away."""

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.levels.level import LEVELS
from bearing_sim.numerics import compilation
from bearing_sim.numerics.vector_width import VARIABLE, lanes_for
from bearing_sim.runtime import precompilation
from bearing_sim.runtime.precompilation import Build, builds

_RUN = """
import gc, sys
from numba.core.dispatcher import Dispatcher
from bearing_sim import Simulation, load_scene
run = Simulation(load_scene("deng2017_table1", sys.argv[1:]))
run.advance(0.001, run.inputs._replace(shaft_speed=1000.0), 7)
kernels = [found for found in gc.get_objects() if isinstance(found, Dispatcher)]
print(sum(sum(kernel.stats.cache_hits.values()) for kernel in kernels), sum(sum(kernel.stats.cache_misses.values()) for kernel in kernels))
"""


def test_every_level_is_built_once_the_slowest_first():
    assert sorted(build.level for build in builds(tuple(LEVELS))) == sorted(LEVELS)
    assert builds(("slip", "planar")) == [Build("planar"), Build("slip")]


@pytest.mark.long
@pytest.mark.parametrize("steps", [(), ("integration.fixed_step=10 us",)], ids=["error control", "fixed steps"])
def test_run_after_compile_finds_all_its_code_on_disk(steps):
    result = CliRunner().invoke(main, ["compile", "--level", "slip"])
    assert result.exit_code == 0 and "slip: compiled" in result.output, result.output
    run = subprocess.run([sys.executable, "-c", _RUN, "level=slip", *steps], check=True, timeout=300, capture_output=True, text=True)
    loaded, compiled = map(int, run.stdout.split())
    assert loaded > 0 and compiled == 0


def test_unknown_level_is_refused_with_the_known_ones():
    result = CliRunner().invoke(main, ["compile", "--level", "plane"])
    assert result.exit_code == 2 and "'--level': 'plane' is not one of 'steady', 'slip', 'planar', 'spatial'" in result.output


def test_prune_removes_other_versions_and_keeps_this_one(tmp_path, monkeypatch):
    for version in ("present", "older"):
        (tmp_path / version / "levels").mkdir(parents=True)
        (tmp_path / version / "levels" / "slip.code").write_bytes(bytes(1_500_000))
    monkeypatch.setattr(compilation, "CACHE_FOLDER", tmp_path / "present")
    monkeypatch.setattr(precompilation, "compile_all", lambda wanted, workers: iter(()))
    result = CliRunner().invoke(main, ["compile", "--prune"])
    assert result.exit_code == 0 and "2 MB of other versions removed" in result.output, result.output
    assert [folder.name for folder in tmp_path.iterdir()] == ["present"]
    assert (tmp_path / "present" / "levels" / "slip.code").stat().st_size == 1_500_000


@pytest.mark.parametrize(
    ("features", "lanes"),
    [
        ("64bit,+sse2,+sse4.2,-avx,-avx2", 2),
        ("64bit,+sse2,+avx,+avx2,+fma", 4),
        ("64bit,+sse2,+avx,+avx2,+avx512f,+avx512vl", 4),
        ("+neon,+fp-armv8,+crc,-sve", 2),
        ("+neon,+fp-armv8,+sve,+sve2", 2),
        ("", 2),
    ],
)
def test_a_block_has_as_many_rollers_as_a_vector_register_holds_doubles_up_to_four(features, lanes):
    assert lanes_for(features) == lanes


def test_another_number_of_lanes_can_be_set_and_has_compiled_code_of_its_own():
    code = "from bearing_sim.numerics.simd import LANES; from bearing_sim.numerics.compilation import CACHE_FOLDER; print(LANES, CACHE_FOLDER)"

    def started(lanes):
        environment = os.environ | {VARIABLE: lanes}
        return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=100)

    (two, its_folder), (four, other_folder) = (started(lanes).stdout.split() for lanes in ("2", "4"))
    assert (two, four) == ("2", "4") and its_folder != other_folder
    assert "BEARING_SIM_LANES=3: expected 1, 2, 4 or 8 rollers per vector" in started("3").stderr
