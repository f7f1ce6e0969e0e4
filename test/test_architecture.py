# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rooms keep to their rules: read from the syntax trees, not from good intentions."""

import ast
import inspect
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from bearing_sim.model.sample import COLUMN, OBSERVABLES, SCALARS, sample_dtype
from bearing_sim.watchers.monitoring.watchers import BUILT_IN

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "bearing_sim"
MODULES = {".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path for path in sorted(PACKAGE.rglob("*.py"))}
STANDARD = set(sys.stdlib_module_names)

# Every room (folder or module directly below the package), from the ground up: the packages and the rooms that it may import.
# A room imports only rooms above it in this table, so there is no cycle.
ROOMS = {
    "__init__": ("", ""),
    "files": ("numpy platformdirs yaml", ""),
    "scene": ("numpy scipy pint pydantic pydantic_core yaml", "files"),
    "numerics": ("numpy numba llvmlite", "files"),
    "physics": ("numpy scipy", "numerics"),
    "model": ("numpy pandas scipy xarray", "scene physics"),
    "levels": ("numpy", "files scene numerics physics model"),
    "simulation": ("numpy", "scene numerics model levels"),
    "messages": ("numpy rosbags", "files model"),
    "recording": ("lz4 mcap numpy pyarrow rosbags yaml zstandard", "files scene model messages"),
    "watchers": ("numpy pyarrow pydantic h5py matplotlib nptdms pyuff scipy", "files scene model messages recording physics numerics levels"),
    "inputs": ("numpy openpyxl pyarrow pydantic yaml", "files scene simulation messages recording"),
    "runtime": ("numpy", "files scene numerics model levels simulation messages recording watchers inputs"),
    "view": ("PIL numpy rerun rerun_cli", "files scene messages recording"),
    "sweep": ("numpy pandas pyarrow matplotlib distributed xarray scipy", "files scene numerics physics model levels simulation inputs"),
    "studies": (
        "numpy numba pandas scipy matplotlib pydantic sksundae",
        "files scene physics model levels simulation messages recording inputs watchers runtime sweep",
    ),
    "cli": (
        "click numpy pydantic_core rich",
        "files scene numerics model levels simulation messages recording watchers inputs runtime view sweep studies",
    ),
    "ros": (
        "click launch launch_ros numpy rcl_interfaces rclpy rich rosgraph_msgs std_srvs",
        "files scene simulation messages recording watchers inputs runtime view",
    ),
}
MOST_FLOORS = 10  # including launch_scripts, which import ros
MOST_ROOMS, MOST_ARROWS = 18, 90


@cache
def _imports(path):
    """Return (third-party top level, or dotted name inside bearing_sim) of every import in a file, wherever it stands."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            inner = {name for name in (f"{node.module}.{alias.name}" for alias in node.names) if name in MODULES}
            found |= inner or {node.module}
    return {name for name in found if name.partition(".")[0] not in STANDARD}


def _room(name):
    return (name.split(".") + ["__init__"])[1]


def test_every_room_imports_only_what_the_law_allows():
    faults, ranks = [], {room: rank for rank, room in enumerate(ROOMS)}
    for name, path in MODULES.items():
        packages, rooms = (words.split() for words in ROOMS[_room(name)])
        for imported in _imports(path):
            top = imported.partition(".")[0]
            if top != "bearing_sim":
                faults += [f"{name} imports {imported}"] * (top not in packages)
            elif _room(imported) not in {*rooms, _room(name)}:
                faults.append(f"{name} imports {imported}")
    faults += [
        f"{room} may import {other}, which stands above it"
        for room, (_, rooms) in ROOMS.items()
        for other in rooms.split()
        if ranks[other] >= ranks[room]
    ]
    assert faults == []


def test_the_law_names_all_rooms_and_no_arrow_that_nobody_needs():
    used = {(_room(name), _room(imported)) for name, path in MODULES.items() for imported in _imports(path) if imported.startswith("bearing_sim")}
    assert {_room(name) for name in MODULES} == set(ROOMS)
    assert {(room, other) for room, (_, rooms) in ROOMS.items() for other in rooms.split()} == {(a, b) for a, b in used if a != b}


def test_a_run_its_node_and_its_view_know_watchers_by_their_interface_alone():
    """Whatever watches is found by name in a table and imported only then."""
    interface = "bearing_sim.watchers.monitoring.watchers"
    named = {
        f"{name} imports {imported}"
        for name, path in MODULES.items()
        if _room(name) in ("runtime", "ros", "view")
        for imported in _imports(path)
        if imported.startswith("bearing_sim.watchers.") and imported != interface
    }
    kinds = {kind.place for kind in BUILT_IN.values()}
    assert named == set() and len(kinds) == len(BUILT_IN) and all(place.partition(":")[0] in MODULES for place in kinds)


def test_the_interface_of_watchers_imports_no_watcher():
    code = (
        "import sys; from bearing_sim.runtime import live, replay, reproduction, sim_time\n"
        "print(*sorted(name for name in sys.modules if name.startswith('bearing_sim.watchers.') and name.count('.') == 3))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, cwd=ROOT, check=True)
    assert done.stdout.split() == ["bearing_sim.watchers.monitoring.watchers"]


def test_the_house_has_few_rooms_and_few_arrows_between_them():
    assert len(ROOMS) <= MOST_ROOMS and sum(len(rooms.split()) for _, rooms in ROOMS.values()) <= MOST_ARROWS


def test_the_house_has_at_most_ten_floors():
    floors = {}
    for room, (_, rooms) in ROOMS.items():
        floors[room] = 1 + max((floors[other] for other in rooms.split()), default=0)
    assert floors["ros"] + 1 <= MOST_FLOORS and max(floors.values()) <= MOST_FLOORS


@pytest.mark.long
def test_a_second_process_finds_all_machine_code_in_the_cache():
    code = (
        "from bearing_sim import Simulation, load_scene; from bearing_sim.levels.slip import model;"
        "Simulation(load_scene('deng2017_table1')).advance(1e-3);"
        "misses = sum(model.advance.stats.cache_misses.values()) + sum(model.observe.stats.cache_misses.values());"
        "print(misses, sum(model.advance.stats.cache_hits.values()))"
    )
    run = [sys.executable, "-c", code]
    subprocess.run(run, timeout=300, cwd=ROOT, check=True, capture_output=True)
    second = subprocess.run(run, capture_output=True, text=True, timeout=300, cwd=ROOT, check=True)
    assert second.stdout.split() == ["0", "1"]


def test_a_changed_law_in_another_file_changes_the_cache_folder(tmp_path, monkeypatch):
    from bearing_sim.numerics import compilation

    shutil.copytree(PACKAGE, tmp_path / "bearing_sim", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compilation, "_PACKAGE", tmp_path / "bearing_sim")
    before = compilation.sources_hash()
    law = tmp_path / "bearing_sim/physics/contact.py"
    law.write_text(law.read_text().replace("0.05  # m/s", "0.06  # m/s"))
    assert compilation.sources_hash() != before


@pytest.mark.long
def test_the_model_runs_uncompiled_for_the_debugger():
    code = (
        "from bearing_sim import Simulation, load_scene;"
        "print(Simulation(load_scene('deng2017_table1', ['bearing.roller.count=6'])).advance(5e-4)['cage_slip'][0])"
    )
    import os

    def slip(**environment):
        found = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, cwd=ROOT, check=True, env={**os.environ, **environment}
        )
        return float(found.stdout)

    assert slip(NUMBA_DISABLE_JIT="1") == pytest.approx(slip(), rel=1e-9)


def test_public_things_have_docstrings_whose_parameters_match_the_signature():
    faults = []
    for name, path in MODULES.items():
        for node in ast.parse(path.read_text()).body:
            if not isinstance(node, (ast.FunctionDef, ast.ClassDef)) or node.name.startswith("_"):
                continue
            text = ast.get_docstring(node)
            if not text:
                faults.append(f"{name}.{node.name} has no docstring")
                continue
            section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z][a-z]+\n-+\n|\Z)", text, re.DOTALL)
            if isinstance(node, ast.FunctionDef) and section is not None:
                lines = re.findall(r"^(\S.*?) : ", section[1], re.MULTILINE)
                documented = {word.strip().lstrip("*") for line in lines for word in line.split(",")}
                arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs, node.args.vararg, node.args.kwarg]
                unknown = documented - {argument.arg for argument in arguments if argument}
                faults += [f"{name}.{node.name} documents {word}, which it does not take" for word in sorted(unknown)]
    assert faults == []


def test_every_observable_has_a_unit_a_meaning_and_its_column():
    for observable in OBSERVABLES:
        assert observable.meaning and re.fullmatch(r"[a-z][a-z0-9_]*", observable.name)
        assert observable.unit in {"", "s", "rad", "rad/s", "N", "K", "m", "h", "W", "Pa", "N*m"}
    dtype, rollers = sample_dtype(5), 5
    for name, column in COLUMN._asdict().items():
        per_roller = dtype[name].shape != ()
        expected = 8 * (SCALARS + column * rollers if per_roller else column)
        assert dtype.fields[name][1] == expected


def test_names_are_words_of_the_field_and_no_filler():
    asked_for = "get_command", "get_call_template", "get_overload"  # by click and numba
    forbidden = re.compile(r"^(calc_|get_|compute_|.*_utils$|.*Manager$|.*Helper$)")
    for path in MODULES.values():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                assert node.name in asked_for or not forbidden.match(node.name), f"{path.name}: {node.name}"


def test_quantities_in_the_scene_are_declared_once_with_unit_and_meaning():
    from bearing_sim.scene import scene as scene_module
    from bearing_sim.scene.quantity import Quantity

    for _, record in inspect.getmembers(scene_module, inspect.isclass):
        for field in getattr(record, "__dataclass_fields__", {}).values():
            for quantity in getattr(field.type, "__metadata__", ()):
                if isinstance(quantity, Quantity):
                    assert quantity.meaning and quantity.minimum < quantity.maximum, field.name


def test_cores_are_counted_in_one_place():
    """The bench pins itself to cores and tells the machine's; whoever shares out work asks `bearing_sim.files.cores`."""
    counting = {
        path.relative_to(PACKAGE).as_posix()
        for path in MODULES.values()
        if re.search(r"len\(os\.sched_getaffinity|os\.cpu_count\(\) or", path.read_text())
    }
    assert counting == {"files/cores.py"}
