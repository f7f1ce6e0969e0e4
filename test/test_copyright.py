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
    texts = {path: path.read_text() for path in SOURCES if path.is_file()}
    without = [str(path.relative_to(ROOT)) for path, text in texts.items() if text and STATEMENT not in text.splitlines()[:2]]
    assert not without, f"begin these files (after #! if there is one) with\n{STATEMENT}\n" + "\n".join(without)
