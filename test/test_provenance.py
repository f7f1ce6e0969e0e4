# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about provenance: the hash is that of the package's own checkout, or nothing."""

import shutil
import subprocess
from pathlib import Path

import pytest

from bearing_sim.files import provenance


def test_hash_is_that_of_the_checkout_the_package_lies_in():
    checkout = Path(provenance.__file__).resolve().parents[2]
    if not (checkout / ".git").exists() or shutil.which("git") is None:
        pytest.skip("the package does not lie in a git checkout here, or git is absent")
    head = subprocess.run(["git", "-C", checkout, "rev-parse", "HEAD"], capture_output=True, text=True, timeout=10).stdout.strip()
    assert provenance.git_hash.__wrapped__().removesuffix("-dirty") == head


def test_an_installation_inside_another_checkout_has_no_hash(tmp_path, monkeypatch):
    """As in a virtual environment that lies in somebody's repository."""
    (tmp_path / ".git").mkdir()
    package = tmp_path / ".venv" / "site-packages" / "bearing_sim"
    package.mkdir(parents=True)
    monkeypatch.setattr(provenance, "__file__", str(package / "recording" / "provenance.py"))
    assert provenance.git_hash.__wrapped__() == ""
