# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compiled functions are linked once, into the one that Python calls, get tuples by reference, and are kept with a digest.

What is used of numba beyond its promises: `CPUDispatcher` with ``_cache``, ``_compiler``, ``overloads``, ``get_call_template`` and ``get_overload``;
`_FunctionCompiler` and ``compile_extra``; `CPUCodeLibrary` and `JITCodeLibrary` with ``finalize``, ``_linking_libraries``, ``_final_module`` and
``_optimize_final_module``; `CompileResult`; data models.  All of it is exercised here, so that a new numba fails a test, not a run.
"""

import os
import random
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest

from bearing_sim.files import kept
from bearing_sim.files.limits import COMPILED_FILE
from bearing_sim.numerics import linking
from bearing_sim.numerics.compilation import fused, kernel

ROOT = Path(__file__).resolve().parents[1]


class Inner(NamedTuple):
    count: int
    on: bool
    pair: tuple[float, float]
    values: np.ndarray


class Outer(NamedTuple):
    scale: float
    inner: Inner
    same: tuple[float, float, float]
    nothing: None


def outer(scale: float = 2.0, on: bool = True) -> Outer:
    return Outer(scale, Inner(3, on, (0.25, 4.0), np.arange(6.0).reshape(2, 3)), (1.0, 2.0, 3.0), None)


@kernel
def leaf(inner, x):
    first, second = inner.pair
    return x * first + second + (100.0 if inner.on else 0.0) + inner.values[1, inner.count - 1]


@fused
def branch(law, whole, x):
    total = 0.0
    for k in range(len(whole.same)):
        total += law(whole.inner, whole.same[k] * x)
    whole.inner.values[0, 0] += total
    return total


@kernel
def root(whole, x):
    if whole.nothing is not None:
        return -1.0
    return branch(leaf, whole, x) * whole.scale


@kernel
def shared(x):
    return 2.0 * x


@kernel
def unused(x):
    return shared(x) + 1.0


@kernel
def used(x):
    return shared(x) + 3.0


@kernel
def with_a_call_that_is_never_made(x):
    if x != x and x == x:
        return unused(x)
    return used(x)


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    """Keep the machine code of `root` in an empty folder, and forget what is compiled."""
    for function in (root, used, with_a_call_that_is_never_made):
        monkeypatch.setattr(function._cache, "folder", tmp_path / "compiled")
        function._reset_overloads()
    return tmp_path / "compiled"


@pytest.mark.parametrize("on", [True, False])
def test_nested_tuples_by_reference_give_what_python_gives_and_arrays_are_changed(on, own_folder):
    compiled, plain = outer(on=on), outer(on=on)
    by_hand = sum(same * 0.7 * 0.25 + 4.0 + 100.0 * on + 5.0 for same in (1.0, 2.0, 3.0))
    assert root(compiled, 0.7) == pytest.approx(2.0 * by_hand, rel=1e-14)
    assert compiled.inner.values[0, 0] == pytest.approx(by_hand, rel=1e-14) and plain.inner.values[0, 0] == 0.0
    assert root(outer(-1.5, on), 0.0) == pytest.approx(-1.5 * 3 * (9.0 + 100.0 * on), rel=1e-14), "other numbers, the same code"


def test_only_the_function_that_python_calls_has_machine_code_and_a_file(own_folder):
    before = {each: len(each.overloads) for each in (leaf, branch)}
    root(outer(), 1.0)
    assert {each: len(each.overloads) for each in (leaf, branch)} == before and len(root.overloads) == 1
    assert [file.name.partition("-")[0] for file in own_folder.iterdir()] == [f"{__name__}.root"]


def test_a_function_called_by_both_a_dropped_and_a_living_one_is_linked(own_folder):
    assert with_a_call_that_is_never_made(2.0) == 7.0


def test_a_function_that_is_called_from_compiled_code_can_be_called_from_python_too(monkeypatch, tmp_path):
    monkeypatch.setattr(leaf._cache, "folder", tmp_path)
    assert leaf(outer().inner, 2.0) == pytest.approx(2.0 * 0.25 + 4.0 + 100.0 + 5.0) and leaf(outer().inner, 2.0) == leaf.py_func(outer().inner, 2.0)


def test_a_function_that_numba_itself_compiles_may_call_it(own_folder):
    """As a user's own would: such a function links what it calls alone, not what that calls in turn."""
    law = numba.njit(lambda whole, x: root(whole, x) + with_a_call_that_is_never_made(x))
    assert law(outer(), 0.7) == pytest.approx(root(outer(), 0.7) + with_a_call_that_is_never_made(0.7), rel=1e-14)


def test_what_is_kept_is_loaded_and_gives_the_same(own_folder):
    found = root(outer(), 1.0)
    root._reset_overloads()
    hits = sum(root.stats.cache_hits.values())
    assert root(outer(), 1.0) == found and sum(root.stats.cache_hits.values()) == hits + 1


def test_no_flipped_bit_and_no_cut_of_a_file_is_ever_loaded(own_folder):
    used(1.0)
    [file] = own_folder.iterdir()
    whole, chance = file.read_bytes(), random.Random(46)
    context = used.targetctx

    def loads(data: bytes) -> bool:
        file.write_bytes(data)
        return kept.read_kept(file, COMPILED_FILE, lambda stored: linking._loaded(stored, context)) is not None

    for _ in range(200):
        place = chance.randrange(8 * len(whole))
        damaged = bytearray(whole)
        damaged[place // 8] ^= 1 << place % 8
        assert not loads(bytes(damaged)), f"bit {place} is flipped"
    assert not any(loads(whole[: len(whole) * k // 20]) for k in range(20)) and not loads(whole + b"x")
    assert loads(whole), "and the file itself is"


def test_a_damaged_file_is_compiled_anew_and_replaced(own_folder, caplog):
    used(1.0)
    [file] = own_folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    used._reset_overloads()
    assert used(1.0) == 5.0 and f"{file.name} is damaged" in caplog.text
    used._reset_overloads()
    hits = sum(used.stats.cache_hits.values())
    assert used(1.0) == 5.0 and sum(used.stats.cache_hits.values()) == hits + 1


def test_where_no_file_can_be_written_the_code_runs_all_the_same_and_it_is_said_once(tmp_path, monkeypatch, caplog):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(kept, "_told", set())
    for function in (used, with_a_call_that_is_never_made):
        monkeypatch.setattr(function._cache, "folder", tmp_path / "file" / "compiled")
        function._reset_overloads()
    assert used(1.0) == 5.0 and with_a_call_that_is_never_made(1.0) == 5.0
    assert caplog.text.count("cannot be written") == 1 and str(tmp_path / "file") in caplog.text


def test_two_installations_share_what_one_of_them_has_compiled(tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(ROOT / "bearing_sim", copy / "bearing_sim", ignore=shutil.ignore_patterns("__pycache__"))
    code = (
        "from bearing_sim.numerics.elementary import ninth_root as law; law(2.0);"
        "print(sum(law.stats.cache_hits.values()), sum(law.stats.cache_misses.values()))"
    )
    found = [
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": str(place), "PYTHONSAFEPATH": "1"},
            cwd=tmp_path,
            check=True,
            capture_output=True,
            text=True,
            timeout=120,
        ).stdout.split()
        for place in (ROOT, copy, copy)
    ]
    assert found == [["0", "1"], ["1", "0"], ["1", "0"]]


@pytest.mark.parametrize(("level", "functions", "megabytes"), [("slip", 6, 1.2), ("steady", 6, 1.8)])
def test_the_code_of_a_level_stays_within_its_budget(level, functions, megabytes):
    """What a run loads, and its bytes, which follow from what is compiled; ``test/benchmarks/compile_seconds.py`` has the seconds of a core."""
    code = (
        "import gc; from bearing_sim import Simulation, load_scene; from bearing_sim.numerics.linking import LinkingDispatcher;"
        f"Simulation(load_scene('deng2017_table1', ['level={level}'])).advance(1e-4);"
        "called = [each for each in gc.get_objects() if isinstance(each, LinkingDispatcher)];"
        "[print(each._cache._path(s, each.targetctx.codegen())) for each in called for s in each.overloads]"
    )
    ran = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True, timeout=300)
    sizes = {Path(line).name: Path(line).stat().st_size for line in ran.stdout.split("\n") if line}
    assert 2 <= len(sizes) <= functions and 0.3 < 1e-6 * sum(sizes.values()) < megabytes, sizes
