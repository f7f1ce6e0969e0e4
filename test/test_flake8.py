# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The code is as ament_flake8 wants it, by the project's configuration."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CHECKED = ["bearing_sim", "launch_scripts", "setup.py", "test"]


@pytest.mark.long
@pytest.mark.flake8
@pytest.mark.linter
def test_ament_flake8_finds_no_fault(monkeypatch):
    main = pytest.importorskip("ament_flake8.main", reason="ament_flake8 is a linter of ROS 2")
    monkeypatch.chdir(ROOT)
    code, faults = main.main_with_errors(argv=["--config", str(ROOT / ".flake8"), *CHECKED])
    assert code == 0, f"{len(faults)} faults\n" + "\n".join(faults)
