# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The installed programs: what SIGINT does while they import, and what they say where a package is missing."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bearing_sim.files import programs

ROOT = Path(__file__).resolve().parent.parent
SLOW = """
import os, signal, sys
os.kill(os.getpid(), getattr(signal, os.environ.get("SENT", "SIGINT")))
raise SystemExit("the signal was not obeyed")
"""


def run(code, folder, **environment):
    environment = os.environ | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"} | environment
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("sent", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("interrupted", [0, 130])
def test_a_signal_during_the_import_ends_a_program_without_a_word(tmp_path, interrupted, sent):
    (tmp_path / "slow.py").write_text(SLOW)
    done = run(f"import sys; from bearing_sim.files.programs import _run; sys.exit(_run('slow', {interrupted}))", tmp_path, SENT=sent)
    assert done.returncode == interrupted and done.stderr == done.stdout == ""


@pytest.mark.parametrize("sent", ["SIGINT", "SIGTERM"])
def test_a_signal_while_the_node_imports_ends_it_with_code_0_also_where_python_runs_its_module(tmp_path, sent):
    pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
    (tmp_path / "std_srvs").mkdir()
    (tmp_path / "std_srvs" / "__init__.py").write_text(SLOW)
    done = run("import runpy; runpy.run_module('bearing_sim.ros.node', run_name='__main__', alter_sys=True)", tmp_path, SENT=sent)
    assert done.returncode == 0 and done.stderr == done.stdout == ""


def test_a_command_is_interrupted_in_the_usual_way_but_not_in_the_middle_of_an_import(tmp_path):
    (tmp_path / "slow.py").write_text(SLOW)
    (tmp_path / "command.py").write_text("import os, signal\ndef main():\n    os.kill(os.getpid(), signal.SIGINT)")
    (tmp_path / "importing.py").write_text("def main():\n    import slow")
    start = "import sys; from bearing_sim.files.programs import _INTERRUPTED, _interrupt, _run\n"
    caught = run(f"{start}try: _run('command', _INTERRUPTED, _interrupt)\nexcept KeyboardInterrupt: print('caught')", tmp_path)
    assert caught.stdout == "caught\n"
    ended = run(f"{start}_run('importing', _INTERRUPTED, _interrupt)", tmp_path)
    assert ended.returncode == 130 and ended.stderr == ""


def test_a_program_names_the_extra_that_it_lacks_and_raises_what_is_no_extra(tmp_path, monkeypatch, capsys):
    for name, missing in (("needs_ros", "rclpy"), ("needs_other", "nobody_has_this")):
        (tmp_path / f"{name}.py").write_text(f"import {missing}\nmain = None\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert programs._run("needs_ros", 0) == 2 and "pip install 'bearing_sim[ros]'" in capsys.readouterr().err
    with pytest.raises(ModuleNotFoundError):
        programs._run("needs_other", 0)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize(
    ("words", "expected"), [(["import-cvs"], "did you mean 'import-csv'?"), (["study", "clearence"], "did you mean 'clearance'?")]
)
def test_an_unknown_command_is_refused_with_the_nearest_name(words, expected):
    from click.testing import CliRunner

    from bearing_sim.cli.main import main

    result = CliRunner().invoke(main, words)
    assert result.exit_code == 2 and expected in result.output
