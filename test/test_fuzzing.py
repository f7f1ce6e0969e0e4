# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files from strangers are read or refused with a message; ``benchmarks/fuzz.py`` tries more of them."""

import fuzzing
import pytest
from hypothesis import HealthCheck, given, settings

from bearing_sim.cli.reporting import UsageError

EXAMPLES = 12
KEPT = [pytest.param(target, path, id=f"{target}: {path.name}") for target in fuzzing.TARGETS for path in fuzzing.corpus(target)]


@pytest.mark.parametrize("target", fuzzing.TARGETS)
def test_any_content_is_taken_or_refused_with_a_message(target):
    @settings(max_examples=EXAMPLES, database=None, suppress_health_check=list(HealthCheck))
    @given(fuzzing.TARGETS[target].contents)
    def read(content):
        fuzzing.taken_or_refused(target, content)

    read()


@pytest.mark.parametrize(("target", "path"), KEPT)
def test_what_once_was_a_fault_is_taken_or_refused_with_a_message(target, path):
    fuzzing.taken_or_refused(target, path.read_bytes())


def test_a_message_escapes_what_would_act_on_a_terminal():
    message = UsageError("the header has \x1b[2J\x07\u202e\ud800: expected\n\tµm, 温度").format_message()
    assert message == "the header has \\x1b[2J\\x07\\u202e\\ud800: expected\n\tµm, 温度"
