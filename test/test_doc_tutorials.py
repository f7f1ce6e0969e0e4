# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The tutorials, the page on the Python API and the README do what they say: their blocks are executed, in order, in an empty folder.

Blocks marked ``bash`` and ``python`` are executed, those marked ``text`` are not.  The Python blocks of a page share one namespace, as in a notebook.
Notebooks are executed by a kernel of Jupyter.
``tutorials/live_monitoring.md`` needs a ROS graph: `test_first_ten_minutes` executes its commands.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import preloaded
import pytest
from support import FOLDER, measured_file

ROOT = Path(__file__).resolve().parents[1]
DOC = ROOT / "doc"
LIVE = "doc/tutorials/live_monitoring.md"
SOURCES = [ROOT / "README.md", DOC / "python_api.md", *DOC.glob("tutorials/*.md"), *DOC.glob("how-to/*.md")]
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in SOURCES)
NOTEBOOKS = sorted(path.relative_to(ROOT).as_posix() for path in DOC.glob("tutorials/*.ipynb"))
WIND = "doc/tutorials/wind_turbine.md"
SCADA = "wind_scada_HMR_july2023.csv"
PROGRAMS = {"bearing-sim": "bearing_sim.cli", "bearing_node": "bearing_sim.ros.node", "bearing_player": "bearing_sim.ros.player"}

# Imported ahead by the process that the programs are forked from: what most of them need.
PRELOADED = ["bearing_sim.cli.run", "bearing_sim.runtime.replay", "bearing_sim.sweep.point", "bearing_sim.studies.page", "matplotlib.figure"]

# Executes a page: argv holds the language and the text of each block in turn; a failing block ends the run with its text.
_DRIVER = """
import subprocess, sys
namespace = {"__name__": "__main__"}
for language, text in zip(sys.argv[1::2], sys.argv[2::2]):
    print(f"--- {language}\\n{text}", flush=True)
    if language == "bash":
        subprocess.run(["bash", "-euo", "pipefail", "-c", text], check=True)
    else:
        exec(compile(text, "<block>", "exec"), namespace)
"""


def blocks(path):
    """Return (language, text) of the blocks of a page that are executed, in order."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", path.read_text(), flags=re.MULTILINE | re.DOTALL)
    return [(language, text) for language, text in found if language in ("bash", "python")]


@pytest.fixture(scope="module")
def server():
    """Return a server that has imported what the programs of the pages need."""
    return preloaded.PreloadingServer(PRELOADED, [ROOT])


def run(path, folder, server):
    """Execute the blocks of a page in a folder and return what they print; programs run on the server."""
    programs = folder / ".programs"
    programs.mkdir()
    for name, module in PROGRAMS.items():
        client = f'"{sys.executable}" -I -S "{preloaded.__file__}" --run "{server.address}"'
        (programs / name).write_text(f'#!/bin/sh\nexec {client} {module} "$@"\n')
        (programs / name).chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{programs}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "MPLBACKEND": "Agg",
        "WIND_SCADA": str(FOLDER / SCADA),
    }
    words = [word for block in blocks(path) for word in block]
    done = subprocess.run(
        [sys.executable, "-c", _DRIVER, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=900, check=False
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.mark.long
@pytest.mark.timeout(1000)
@pytest.mark.parametrize("page", [page for page in PAGES if blocks(ROOT / page)])
def test_the_blocks_of_a_page_run_in_an_empty_folder(page, tmp_path, server):
    pytest.importorskip("pandas", reason="pip install 'bearing_sim[tables]'")
    pytest.importorskip("xarray", reason="pip install 'bearing_sim[tables]'")
    if page == WIND:
        measured_file(SCADA)
    printed = run(ROOT / page, tmp_path, server)
    if page == WIND:
        assert_printed(ROOT / page, printed)


def assert_printed(path, printed):
    """Assert that the rows in the blocks of a page marked ``text`` stand in what its commands print, in this order, numbers within a twentieth."""
    rows = re.findall(
        r"^(?:# .*|[\w: ]+ \| .*)$", "\n".join(re.findall(r"^```text\n(.*?)^```$", path.read_text(), re.MULTILINE | re.DOTALL)), re.MULTILINE
    )
    assert len(rows) > 10
    lines = iter(printed.splitlines())
    for row in rows:
        name, _, value = (part.strip() for part in row.partition("|"))
        found = next((line for line in lines if name in line), "")
        assert found, f"{row!r} is not printed after the row before"
        told, shown = (re.findall(r"\d+\.?\d*", text) for text in (value, found.replace(",", "").partition(name)[2]))
        assert [float(number) for number in shown[: len(told)]] == pytest.approx([float(number) for number in told], rel=0.05), (row, found)


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize("notebook", NOTEBOOKS)
def test_the_cells_of_a_notebook_run_in_a_new_kernel_and_are_kept_without_outputs(notebook, tmp_path, monkeypatch):
    nbclient = pytest.importorskip("nbclient", reason="pip install 'bearing_sim[test]'")
    nbformat = pytest.importorskip("nbformat", reason="pip install 'bearing_sim[test]'")
    for package in ("ipykernel", "pandas", "xarray"):
        pytest.importorskip(package, reason="pip install 'bearing_sim[test]'")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    book = nbformat.read(ROOT / notebook, as_version=4)
    nbformat.validate(book)
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in cells), "outputs depend on the machine: clear them before you commit"
    nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert all(cell.execution_count for cell in cells)
    assert any("image/png" in output.get("data", {}) for cell in cells for output in cell.outputs), "a notebook shows a picture"


def test_every_tutorial_is_executed():
    assert len(NOTEBOOKS) >= 3
    listed = re.findall(r"^[a-z_]+$", (DOC / "tutorials/index.md").read_text(), flags=re.MULTILINE)
    assert sorted(listed) == sorted({path.stem for path in DOC.glob("tutorials/*.*")} - {"index"})
    tutorials = {page for page in PAGES if page.startswith("doc/tutorials/")} - {"doc/tutorials/index.md"}
    assert {page for page in tutorials if not blocks(ROOT / page)} == {LIVE}
    assert {language for language, _ in blocks(ROOT / "README.md")} == {"bash", "python"}


def test_a_failing_block_fails_the_page(tmp_path, server):
    page = tmp_path / "page.md"
    page.write_text("```python\nx = 1\n```\n\n```bash\ntest -e nothing_here\n```\n")
    (tmp_path / "folder").mkdir()
    with pytest.raises(AssertionError, match="nothing_here"):
        run(page, tmp_path / "folder", server)
