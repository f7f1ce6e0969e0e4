# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Every source file says whose it is and under which licence."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
STATEMENT = "# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0"
SOURCES = [
    *(ROOT / "bearing_sim").rglob("*.py"),
    *(ROOT / "test").rglob("*.py"),
    *(ROOT / "launch_scripts").iterdir(),
    ROOT / "setup.py",
    ROOT / ".ci" / "run",
]


@pytest.mark.linter
def test_every_source_file_begins_with_the_copyright_statement():
    for path in SOURCES:
        lines = path.read_text().splitlines() if path.is_file() else []
        if lines:
            assert STATEMENT in lines[:2], f"{path.relative_to(ROOT)}: begin with the line (after #! if there is one)\n{STATEMENT}"
