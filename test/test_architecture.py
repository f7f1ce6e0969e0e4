# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The rooms keep to their rules: read from the syntax trees, not from good intentions."""

import ast
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

from bearing_sim.sample import COLUMN, OBSERVABLES, SCALARS, sample_dtype

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "bearing_sim"
MODULES = sorted(PACKAGE.rglob("*.py"))
OWN = {"bearing_sim"}
NUMBERS = {"numpy", "scipy", "numba", "llvmlite"}
STANDARD = set(sys.stdlib_module_names)

# room: (third-party packages, rooms and modules of bearing_sim) that it may import
ALLOWED = {
    "kernels": (NUMBERS | {"platformdirs"}, {"kernels", "params"}),
    "integrators": (NUMBERS, {"integrators", "kernels.compilation"}),
    "levels": (NUMBERS, {"levels", "kernels", "integrators", "params", "sample", "rating_life"}),
    "sample.py": ({"numpy"}, set()),
    "events.py": (set(), set()),
    "quantity.py": ({"pint", "pydantic_core"}, set()),
    "methods.py": (set(), set()),
    "effects.py": (set(), set()),
    "crown.py": ({"numpy", "pydantic"}, {"quantity", "scene_record"}),
    "contour_file.py": ({"numpy", "scipy"}, {"quantity"}),
    "contour.py": ({"numpy"}, {"contour_file"}),
    "scene_record.py": ({"pydantic"}, set()),
    "scene_cage.py": ({"pydantic"}, {"quantity", "scene_record"}),
    "scene_raceway.py": ({"pydantic"}, {"contour", "quantity", "scene_record"}),
    "scene_lubricant.py": ({"pydantic"}, {"quantity", "scene_record"}),
    "scene_monitoring.py": ({"pydantic"}, {"quantity", "scene_record"}),
    "scene_uncertainty.py": ({"pydantic", "pydantic_core"}, {"quantity", "scene_record"}),
    "ring_growth.py": (set(), {"scene"}),
    "film_ratio.py": ({"numpy"}, {"kernels.film", "oil", "params", "scene"}),
    "contour_scene.py": (set(), {"contour", "scene_raceway"}),
    "scene.py": (
        {"pydantic"},
        {
            "crown",
            "effects",
            "methods",
            "quantity",
            "scene_bounds",
            "scene_cage",
            "scene_lubricant",
            "scene_monitoring",
            "scene_raceway",
            "scene_record",
            "scene_uncertainty",
        },
    ),
    "scene_bounds.py": (set(), set()),
    "scene_file.py": (
        {"pydantic", "pydantic_core", "yaml"},
        {"contour_scene", "crown", "effects", "scene", "scene_cage", "scene_uncertainty", "quantity"},
    ),
    "oil.py": ({"numpy"}, {"scene_lubricant"}),
    "params.py": ({"numpy"}, {"contour", "crown", "kernels", "oil", "rating_life", "ring_growth", "scene", "scene_lubricant"}),
    "rating_life.py": ({"numpy"}, {"kernels.compilation"}),
    "cores.py": (set(), set()),
    "tables": ({"numpy", "platformdirs"}, {"tables", "cores", "kernels.compilation", "levels", "params", "rating_life", "scene"}),
    "compiled_call.py": ({"numba"}, set()),
    "simulation.py": ({"numpy"}, {"compiled_call", "effects", "integrators.status", "levels", "oil", "params", "sample", "scene", "tables"}),
    "screenshot.py": ({"rerun", "rerun_cli"}, {"sinks.priority"}),
    "sinks": (
        {"numpy", "mcap", "rosbags", "rerun", "yaml"},
        {"sinks", "contour", "effects", "sample", "scene", "scene_file", "events", "topics", "provenance", "simulation"},
    ),
    "sweep": (
        {"numpy", "pyarrow", "distributed", "matplotlib"},
        {"sweep", "cores", "kernels.compilation", "levels.steady_table", "provenance", "quantity", "sample", "scene", "scene_file", "simulation"},
    ),
    "studies": (
        NUMBERS | {"sksundae", "matplotlib", "pydantic"},
        {
            "studies",
            "cores",
            "effects",
            "events",
            "integrators.status",
            "levels",
            "params",
            "provenance",
            "rating_life",
            "recording_reader",
            "recovery",
            "runtime",
            "sample",
            "scene",
            "scene_file",
            "scene_uncertainty",
            "screenshot",
            "simulation",
            "sinks",
            "sweep",
            "tables",
        },
    ),
    "message_rows.py": ({"numpy", "mcap"}, set()),
    "message_numbers.py": ({"numpy", "rosbags"}, {"topics"}),
    "mcap_stream.py": ({"mcap", "zstandard"}, {"message_rows"}),
    "mcap_index.py": ({"numpy", "mcap"}, {"mcap_stream", "message_rows"}),
    "recording_completion.py": ({"numpy"}, {"contour", "effects", "params", "scene", "topics"}),
    "recording_samples.py": ({"numpy"}, {"message_numbers", "message_rows", "recording_completion", "sample", "scene", "topics"}),
    "runtime": ({"numpy", "scipy"}, {"runtime", "film_ratio", "simulation", "scene", "scene_monitoring", "effects", "events", "sample", "topics"}),
}


def imports(path):
    """Yield (third-party top level, or path inside bearing_sim) of every import in a file, wherever it stands."""
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            whole = {f"{node.module}.{alias.name}" for alias in node.names}
            modules = {name for name in whole if (ROOT / name.replace(".", "/")).with_suffix(".py").exists()}
            names = [node.module] if whole - modules else []
            names += sorted(modules)
        for name in names:
            if name.split(".")[0] not in STANDARD:
                yield name


def room(path):
    relative = path.relative_to(PACKAGE)
    return relative.parts[0]


@pytest.mark.parametrize("path", [m for m in MODULES if room(m) in ALLOWED], ids=lambda p: str(p.relative_to(ROOT)))
def test_rooms_import_only_what_they_may(path):
    packages, rooms = ALLOWED[room(path)]
    for name in imports(path):
        top, _, inner = name.partition(".")
        if top in OWN:
            assert any(inner == allowed or inner.startswith(allowed + ".") for allowed in rooms), f"{path.name} imports {name}"
        else:
            assert top in packages, f"{path.name} imports {name}"


@pytest.mark.parametrize("path", [m for m in MODULES if room(m) != "ros"], ids=lambda p: str(p.relative_to(ROOT)))
def test_nothing_imports_ros(path):
    for name in imports(path):
        assert not name.startswith("bearing_sim.ros") and name.split(".")[0] not in {"rclpy", "std_msgs", "sensor_msgs"}, name


def test_the_core_needs_neither_ros_nor_mcap_nor_rerun():
    code = (
        "import sys, bearing_sim; bearing_sim.Simulation, bearing_sim.load_scene;"
        "print(*(m for m in ('rclpy', 'mcap', 'rerun', 'rosbags') if m in sys.modules))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, cwd=ROOT, check=True)
    assert found.stdout.strip() == ""


def test_help_does_not_load_the_model():
    code = (
        "import sys; from bearing_sim.cli import main; main(['run', '--help'], standalone_mode=False);"
        "print(*(m for m in ('numba', 'pint', 'scipy', 'rerun', 'pydantic') if m in sys.modules), file=sys.stderr)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, cwd=ROOT, check=True)
    assert found.stderr.strip() == "" and "SCENE" in found.stdout


def test_a_second_process_finds_all_machine_code_in_the_cache():
    code = (
        "from bearing_sim import Simulation, load_scene; from bearing_sim.levels import slip;"
        "Simulation(load_scene('deng2017_table1')).advance(1e-3);"
        "misses = sum(slip.advance.stats.cache_misses.values()) + sum(slip.observe.stats.cache_misses.values());"
        "print(misses, sum(slip.advance.stats.cache_hits.values()))"
    )
    run = [sys.executable, "-c", code]
    subprocess.run(run, timeout=300, cwd=ROOT, check=True, capture_output=True)
    second = subprocess.run(run, capture_output=True, text=True, timeout=300, cwd=ROOT, check=True)
    assert second.stdout.split() == ["0", "1"]


def test_a_changed_law_in_another_file_changes_the_cache_folder(tmp_path, monkeypatch):
    import shutil

    from bearing_sim.kernels import compilation

    shutil.copytree(PACKAGE, tmp_path / "bearing_sim", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compilation, "_PACKAGE", tmp_path / "bearing_sim")
    before = compilation.sources_hash()
    law = tmp_path / "bearing_sim/kernels/contact_rows.py"
    law.write_text(law.read_text().replace("0.05  # m/s", "0.06  # m/s"))
    assert compilation.sources_hash() != before


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


@pytest.mark.parametrize("path", MODULES + sorted((ROOT / "test").glob("*.py")), ids=lambda p: str(p.relative_to(ROOT)))
def test_no_file_is_longer_than_400_lines(path):
    assert len(path.read_text().splitlines()) <= 400


def _public_functions():
    for path in MODULES:
        if room(path) in {"ros"} or path.name == "__init__.py":
            continue
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        tree = ast.parse(path.read_text())
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                yield pytest.param(name, node, id=f"{name}.{node.name}")
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                yield pytest.param(name, node, id=f"{name}.{node.name}")


@pytest.mark.parametrize(("module", "node"), list(_public_functions()))
def test_public_things_have_docstrings_whose_parameters_match_the_signature(module, node):
    text = ast.get_docstring(node)
    assert text, f"{module}.{node.name} has no docstring"
    if not isinstance(node, ast.FunctionDef):
        return
    section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z][a-z]+\n-+\n|\Z)", text, re.DOTALL)
    if section is None:
        return
    told = [name.strip().lstrip("*") for line in section[1].splitlines() if re.match(r"\S.* : ", line) for name in line.split(" : ")[0].split(",")]
    taken = [argument.arg for argument in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]]
    taken += [argument.arg for argument in (node.args.vararg, node.args.kwarg) if argument]
    assert not set(told) - set(taken), f"{module}.{node.name} documents {set(told) - set(taken)}, which it does not take"


def test_every_observable_has_a_unit_a_meaning_and_its_column():
    for observable in OBSERVABLES:
        assert observable.meaning and re.fullmatch(r"[a-z][a-z0-9_]*", observable.name)
        assert observable.unit in {"", "s", "rad", "rad/s", "N", "K", "m", "h", "W", "Pa"}
    dtype, rollers = sample_dtype(5), 5
    for name, column in COLUMN._asdict().items():
        per_roller = dtype[name].shape != ()
        expected = 8 * (SCALARS + column * rollers if per_roller else column)
        assert dtype.fields[name][1] == expected


def test_every_module_imports():
    for path in MODULES:
        if room(path) != "ros":
            importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"))


def test_names_are_words_of_the_field_and_no_filler():
    forbidden = re.compile(r"^(calc_|get_|compute_|.*_utils$|.*Manager$|.*Helper$)")
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                # click asks for get_command by name
                assert node.name == "get_command" or not forbidden.match(node.name), f"{path.name}: {node.name}"


def test_quantities_in_the_scene_are_declared_once_with_unit_and_meaning():
    from bearing_sim import scene as scene_module
    from bearing_sim.quantity import Quantity

    for _, record in inspect.getmembers(scene_module, inspect.isclass):
        for field in getattr(record, "__dataclass_fields__", {}).values():
            for quantity in getattr(field.type, "__metadata__", ()):
                if isinstance(quantity, Quantity):
                    assert quantity.meaning and quantity.minimum < quantity.maximum, field.name


def test_cores_are_counted_in_one_place():
    """The bench pins itself to cores and tells the machine's; whoever shares out work asks `bearing_sim.cores`."""
    counting = {
        path.relative_to(PACKAGE).as_posix() for path in MODULES if re.search(r"len\(os\.sched_getaffinity|os\.cpu_count\(\) or", path.read_text())
    }
    assert counting == {"cores.py"}
