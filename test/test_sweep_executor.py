# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tasks and their journal: a kill at whatever instant loses nothing that was finished, and nothing finished is computed again."""

import collections
import functools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from sweep_tasks import deadly, noted, tasks

from bearing_sim.cli.main import main
from bearing_sim.studies.response_points import obtain_response
from bearing_sim.sweep.tasks import ClusterError, Journal, JournalInUse, run_tasks, task
from bearing_sim.watchers.estimation.response import read_response

HERE = Path(__file__).resolve().parent


def notes(folder):
    path = folder / "notes"
    return collections.Counter(path.read_text().split()) if path.exists() else collections.Counter()


def until(condition, seconds=120.0):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)


def lines(path):
    return path.read_bytes().splitlines() if path.exists() else []


def status(pid):
    try:
        return dict(line.split(":\t", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines() if ":\t" in line)
    except OSError:
        return {}


def runs(pid):
    return status(pid).get("State", "Z")[0] != "Z"


def descendants(pid):
    every = {int(path.name): int(status(path.name).get("PPid", 0)) for path in Path("/proc").iterdir() if path.name.isdigit()}
    found = {pid}
    while len(more := found | {child for child, parent in every.items() if parent in found}) > len(found):
        found = more
    return found - {pid}


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_the_tasks_each_computed_once(tmp_path, workers):
    wanted = tasks(tmp_path / "notes", 7, 0.01)
    with Journal() as journal:
        found = run_tasks([*wanted, wanted[2]], journal, workers=workers)
    assert [result["square"] for result in found] == [0, 1, 4, 9, 16, 25, 36, 4]
    assert set(notes(tmp_path).values()) == {1}
    assert len({result["process"] for result in found} - {os.getpid()}) <= workers
    assert ({result["process"] for result in found} == {os.getpid()}) == (workers == 1)


def test_after_a_kill_in_mid_run_nothing_in_the_journal_is_computed_again_and_nothing_is_lost(tmp_path):
    count, journal = 60, tmp_path / "kept.journal"
    run = subprocess.Popen([sys.executable, HERE / "sweep_tasks.py", tmp_path, str(count)], env={**os.environ, "PYTHONPATH": str(HERE.parent)})
    until(lambda: len(lines(journal)) >= 8)
    below = descendants(run.pid)
    assert len(below) >= 2
    run.send_signal(signal.SIGKILL)
    run.wait()
    until(lambda: not any(map(runs, below)))  # no orphan computes on
    kept, before = len(lines(journal)), notes(tmp_path)
    assert 8 <= kept < count
    assert sum(before.values()) <= kept + 4  # what was under way: two tasks a worker at most
    reported = []
    with Journal(journal) as again:
        found = run_tasks(tasks(tmp_path / "notes", count, 0.05), again, workers=2, progress=lambda done, total: reported.append((done, total)))
    assert [result["square"] for result in found] == [number * number for number in range(count)]
    assert reported[0] == (0, count - kept) and reported[-1] == (count - kept, count - kept)
    entries = [json.loads(line) for line in lines(journal)]
    assert len(entries) == count == len({entry["key"] for entry in entries})
    done_before = {str(round(entry["result"]["square"] ** 0.5)) for entry in entries[:kept]}
    assert all(notes(tmp_path)[number] == 1 for number in done_before)
    with Journal(journal) as again:
        run_tasks(tasks(tmp_path / "notes", count, 0.05), again, workers=2)
    assert sum(notes(tmp_path).values()) == sum(before.values()) + count - kept


def test_a_line_that_a_kill_cut_short_is_no_result_and_does_not_spoil_the_next(tmp_path):
    path = tmp_path / "j"
    with Journal(path) as journal:
        journal.add("a", {"x": 0.1 + 0.2, "y": float("inf")})
        journal.add("b", {"x": 2})
    whole = path.read_bytes()
    for cut in range(len(whole.splitlines()[0]) + 1, len(whole)):
        path.write_bytes(whole[:cut])
        with Journal(path) as journal:
            assert len(journal) == 1 and journal["a"] == {"x": 0.1 + 0.2, "y": float("inf")} and "b" not in journal
            journal.add("c", {})
        with Journal(path) as journal:
            assert len(journal) == 2 and "c" in journal


def test_two_processes_cannot_write_one_journal(tmp_path):
    with Journal(tmp_path / "j"), pytest.raises(JournalInUse, match="another process"):
        Journal(tmp_path / "j")
    Journal(tmp_path / "j").close()


def test_a_task_that_takes_its_worker_along_is_told_and_not_kept_and_the_others_are_computed(tmp_path):
    wanted = tasks(tmp_path / "notes", 8, function=deadly)
    with Journal() as journal:
        found = run_tasks(wanted, journal, workers=2)
        assert [result.get("square") for result in found] == [0, 1, 4, None, 16, 25, 36, 49]
        assert found[3]["status"] == "failed" and "worker process died" in found[3]["reason"]
        assert wanted[3].key not in journal and len(journal) == 7


def test_a_fault_of_the_program_is_no_result(tmp_path):
    with Journal() as journal, pytest.raises(FileNotFoundError):
        run_tasks(tasks(tmp_path / "absent" / "notes", 4), journal, workers=2)


def test_a_key_tells_functions_arguments_and_their_last_digit_apart(tmp_path):
    keys = [task("a", noted, "x", 1.0).key, task("a", deadly, "x", 1.0).key, task("a", noted, "x", 1.0 + 2e-16).key, task("a", noted, "y", 1.0).key]
    assert len(set(keys)) == 4
    assert task("b", noted, "x", 1.0).key == keys[0]  # the kind only says who shares machine code


def test_a_changed_law_changes_every_key(monkeypatch):
    from bearing_sim.numerics import compilation
    from bearing_sim.sweep.tasks import program_hash

    before = program_hash()
    monkeypatch.setattr(compilation, "sources_hash", lambda: "other")
    program_hash.cache_clear()
    assert program_hash() != before
    program_hash.cache_clear()


@pytest.fixture
def cluster():
    distributed = pytest.importorskip("distributed", reason="distributed is not installed: pip install 'bearing_sim[dask]'")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as local:
        yield local


@pytest.mark.long
def test_a_dask_cluster_computes_the_same_though_one_of_its_workers_is_killed_in_mid_run(tmp_path, cluster):
    count, killed = 40, []

    def kill_one(done, total):
        if done >= 6 and not killed:
            killed.append(list(cluster.workers.values())[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    cluster_tasks = tasks(tmp_path / "notes", count, 0.05)
    with Journal(tmp_path / "j") as journal:
        found = run_tasks(cluster_tasks, journal, dask=cluster.scheduler_address, progress=kill_one)
    assert killed
    assert [result["square"] for result in found] == [number * number for number in range(count)]
    assert killed[0] in {result["process"] for result in found} and len({result["process"] for result in found}) >= 2
    assert len(lines(tmp_path / "j")) == count
    with Journal(tmp_path / "j") as journal:
        assert run_tasks(cluster_tasks, journal, workers=1) == found  # and another executor goes on from there


@pytest.mark.long
def test_the_command_sweeps_on_a_cluster_what_it_sweeps_alone(tmp_path, cluster):
    words = ["sweep", "deng2017_table1", "--level", "steady", "--vary", "bearing.outer_raceway.low_radius=34.86mm:34.865mm:5", "--json"]

    def points(name, *more):
        result = CliRunner().invoke(main, [*words, "-o", str(tmp_path / name), *more], catch_exceptions=False)
        assert result.exit_code == 0, result.output
        report = json.loads(result.stdout)
        assert report["computed"] == 5
        return report["points"]

    assert points("cluster", "--dask", cluster.scheduler_address) == points("alone", "--workers", "1")


@pytest.mark.long
def test_the_response_that_a_cluster_builds_is_the_one_that_is_built_alone(tmp_path, cluster, monkeypatch):
    monkeypatch.setattr("bearing_sim.studies.response_points.DRAWS", 8)
    monkeypatch.setattr("bearing_sim.studies.response_points.obtain_response", functools.partial(obtain_response, points=256))
    words = ["table", "deng2017_table1", "--bands", "--set", "life.reliability=0.95", "--json"]  # whose response does not come with the package

    def built(name, *more):
        monkeypatch.setattr("bearing_sim.watchers.estimation.response.FOLDER", tmp_path / name)
        result = CliRunner().invoke(main, [*words, *more], catch_exceptions=False)
        assert result.exit_code == 0, result.output
        report = json.loads(result.stdout)
        assert report["points"] == 256 and Path(report["file"]).parent == tmp_path / name
        return read_response(Path(report["file"]))

    there, here = built("cluster", "--dask", cluster.scheduler_address), built("alone", "--workers", "1")
    for name in ("centres", "metrics", "weights", "errors"):
        np.testing.assert_array_equal(getattr(there, name), getattr(here, name))
    refused = CliRunner().invoke(main, [*words[:2], "--dask", cluster.scheduler_address])
    assert refused.exit_code == 2 and "--dask goes with --bands only" in refused.output


def test_a_scheduler_that_is_not_there_is_told(tmp_path, monkeypatch):
    pytest.importorskip("distributed", reason="distributed is not installed: pip install 'bearing_sim[dask]'")
    monkeypatch.setattr("bearing_sim.sweep.tasks._DASK_TIMEOUT", 0.5)
    with Journal() as journal, pytest.raises(ClusterError, match="no Dask scheduler answers"):
        run_tasks(tasks(tmp_path / "notes", 2), journal, dask="tcp://127.0.0.1:9")
    monkeypatch.setattr("bearing_sim.watchers.estimation.response.FOLDER", tmp_path)
    result = CliRunner().invoke(main, ["table", "deng2017_table1", "--set", "life.reliability=0.95", "--bands", "--dask", "tcp://127.0.0.1:9"])
    assert result.exit_code == 2 and "no Dask scheduler answers at tcp://127.0.0.1:9" in result.output
