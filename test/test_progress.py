# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Long commands say how far they are, also where nobody watches a terminal."""

import re
import time

import pytest

from bearing_sim.cli import reporting


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_where_stderr_is_no_terminal_lines_tell_the_progress_also_while_nothing_is_done(share, monkeypatch, capsys):
    monkeypatch.setattr(reporting, "_LINE_EVERY", 0.01)
    with reporting.progress_bar("work", 4.0) as show:
        show(4.0 * share)
        until = time.monotonic() + 20.0
        told = ""
        while not told and time.monotonic() < until:
            time.sleep(0.01)
            told = capsys.readouterr().err
    assert re.match(rf"work: {100 * share:.0f} % after \d+ s\n", told)


def test_a_short_command_prints_no_line(capsys):
    with reporting.progress_bar("work", 1.0) as show:
        show(1.0)
    assert capsys.readouterr().err == ""
