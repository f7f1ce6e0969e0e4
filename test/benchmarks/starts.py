# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What starts cost: ``python test/benchmarks/starts.py``, in seconds of a core (user and system) beside ``import numba``.

Each start runs ``--times`` times in a process of its own, by turns with all others, after one run that is not counted and compiles what is not
compiled yet; the table has the medians.  ``bearing_node`` counts with the processes that it has started.  ``without byte code`` is a machine where
Python finds no compiled modules and may write none, as in a container whose files were installed without.  ``--tree`` measures other trees of the
package beside this one, such as the version before.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import click

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from measure import processes_of  # noqa: E402
from ros_bench import Client, fresh_domain  # noqa: E402

from bearing_sim.cli.reporting import print_rows  # noqa: E402

_ROOT = Path(__file__).resolve().parents[2]
_IMPORT = "import numba"
_NODE = "bearing_node to its first cage_slip"
_CLI = ("-m", "bearing_sim.cli")
_NEW = ("new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000 rpm", "--load", "5 kN")
STARTS = {
    _IMPORT: ("-c", _IMPORT),
    "bearing-sim --help": (*_CLI, "--help"),
    "bearing-sim catalog": (*_CLI, "catalog"),
    "bearing-sim new": (*_CLI, *_NEW),
    "bearing-sim fields": (*_CLI, "fields"),
    "import Simulation, load_scene, settle": ("-c", "from bearing_sim import Simulation, load_scene, settle"),
    "bearing-sim run": (*_CLI, "run", "deng2017_table1"),
    "import bearing_sim.ros.node": ("-c", "import bearing_sim.ros.node"),
    _NODE: ("-m", "bearing_sim.ros.node"),
}


def seconds(tree: Path, start: str, *, byte_code: bool) -> float:
    """Return the time of a core that a start in a tree of the package takes [s]."""
    with tempfile.TemporaryDirectory() as empty:
        environment = {**os.environ, "PYTHONPATH": str(tree), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        if not byte_code:
            environment |= {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPYCACHEPREFIX": empty}
        if start == _NODE:
            return _node_seconds(environment, empty)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *STARTS[start]], check=True, capture_output=True, env=environment, cwd=empty)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _node_seconds(environment: dict[str, str], folder: str) -> float:
    """Return the time of a core that a node and its processes have taken when its first slip arrives [s]."""
    domain = fresh_domain()
    environment |= {"ROS_DOMAIN_ID": str(domain), "ROS_LOG_DIR": folder}
    process = subprocess.Popen([sys.executable, *STARTS[_NODE]], env=environment, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    client, node = Client(domain), SimpleNamespace(process=process, text="")
    try:
        client.wait_until_matched(node)
        client.drive_until(lambda: client.received["cage_slip"], "the first slip arrives", node)
        texts = [Path(f"/proc/{each}/stat").read_text().rpartition(")")[2].split() for each in processes_of(process.pid)]
    finally:
        process.terminate()
        client.close()
        process.wait()
    return sum(sum(map(int, text[11:15])) for text in texts) / os.sysconf("SC_CLK_TCK")  # their own, and that of processes that have ended


@click.command()
@click.option("--times", default=5, show_default=True, type=click.IntRange(1), help="How often each start is measured.")
@click.option("--only", multiple=True, type=click.Choice(list(STARTS)), help="Start to measure; can be repeated [default: all].")
@click.option(
    "--tree", "trees", multiple=True, type=click.Path(exists=True, path_type=Path), help="Folder of another package bearing_sim to measure beside."
)
@click.option("--json", "as_json", is_flag=True, help="Print every measurement as JSON.")
def main(times, only, trees, as_json):
    """Measure the starts of the package."""
    starts = [start for start in STARTS if not only or start in only or start == _IMPORT]
    kinds = [(tree.resolve(), byte_code) for byte_code in (True, False) for tree in (*trees, _ROOT)]
    found = {(start, kind): [] for start in starts for kind in kinds}
    for turn in range(times + 1):
        for start, kind in found:
            measured = seconds(kind[0], start, byte_code=kind[1])
            if turn:
                found[start, kind].append(measured)
    if as_json:
        print(
            json.dumps(
                [{"start": start, "tree": str(tree), "byte_code": on, "seconds": each} for (start, (tree, on)), each in found.items()], indent=2
            )
        )
        return
    middle = {key: statistics.median(each) for key, each in found.items()}
    names = [f"{'with' if on else 'without'} byte code{f', {tree.name}' if trees else ''}" for tree, on in kinds]
    columns = ["start", *(heading for name in names for heading in (f"{name} [s]", f"over {_IMPORT}"))]
    rows = [
        [start, *(text for kind in kinds for text in (f"{middle[start, kind]:.2f}", f"{middle[start, kind] / middle[_IMPORT, kind]:.2f}"))]
        for start in starts
    ]
    print_rows(f"seconds of a core, medians of {times}", columns, rows, words=("start",))


if __name__ == "__main__":
    main()
