# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The docstrings are as ament_pep257 wants them, by the numpy convention in which they are written."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CHECKED = ["bearing_sim", "launch_scripts", "test"]
# As ament, no docstring where the name says all (D100 to D107). Values are told by nouns, not in the imperative mood (D401).
LEFT_OUT = ["D100", "D101", "D102", "D103", "D104", "D105", "D106", "D107", "D401", "D400"]
INSTEAD = ["D415"]  # of D400: a first line may end with a question mark


@pytest.mark.long
@pytest.mark.linter
@pytest.mark.pep257
def test_ament_pep257_finds_no_fault(monkeypatch, capsys):
    main = pytest.importorskip("ament_pep257.main", reason="ament_pep257 is a linter of ROS 2")
    monkeypatch.chdir(ROOT)
    code = main.main(argv=["--convention", "numpy", "--add-ignore", *LEFT_OUT, "--add-select", *INSTEAD, "--", *CHECKED])
    found = capsys.readouterr()
    assert code == 0, "\n".join(line for line in (found.out + found.err).splitlines() if ": D" in line)
