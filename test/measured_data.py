# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured files that are not redistributable, and so not in the repository."""

from pathlib import Path

import pytest

import bearing_sim

FOLDER = Path(bearing_sim.__file__).resolve().parents[2] / "shared" / "data"


def measured_file(name: str) -> Path:
    """Return the path of a measured file; a test without it is skipped and says so."""
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"the measured data {name} are not redistributable and not here; expected in ../shared/data beside the repository")
    return path
