# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the package weighs: tokens by room.  A change raises a budget by what it brings, which the changelog names, and by nothing else.

Tokens are names, operators, numbers and strings, so that neither longer lines nor fewer blank ones change them.
"""

import io
import tokenize
from collections import Counter
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "bearing_sim"
TOKENS = {tokenize.NAME, tokenize.OP, tokenize.NUMBER, tokenize.STRING}
BUDGETS = {
    "__init__": 82,
    "simulation": 5_210,
    "files": 7_287,
    "messages": 12_560,
    "numerics": 13_940,
    "sweep": 23_230,
    "model": 23_920,
    "physics": 35_050,
    "ros": 30_565,
    "recording": 30_560,
    "inputs": 31_844,
    "runtime": 29_660,
    "view": 31_760,
    "cli": 44_690,
    "scene": 53_490,
    "watchers": 75_500,
    "studies": 74_350,
    "levels": 90_550,
}
SLACK = 0.03  # a budget that is larger than the room by more is lowered


def tokens(text):
    """Return the number of tokens of a source."""
    return sum(each.type in TOKENS for each in tokenize.generate_tokens(io.StringIO(text).readline))


def weights():
    """Return the tokens by room."""
    found = Counter()
    for path in PACKAGE.rglob("*.py"):
        found[path.relative_to(PACKAGE).parts[0].removesuffix(".py")] += tokens(path.read_text())
    return found


def test_no_room_weighs_more_than_its_budget_and_no_budget_is_left_behind():
    found = weights()
    assert found.keys() == BUDGETS.keys()
    heavy = {room: f"{found[room]} of {budget}" for room, budget in BUDGETS.items() if found[room] > budget}
    loose = {room: f"{found[room]} of {budget}" for room, budget in BUDGETS.items() if found[room] < (1.0 - SLACK) * budget - 20}
    assert not heavy and not loose


def test_a_token_is_a_word_and_no_blank_comment_or_line():
    assert tokens("a = 'b c'  # d\n\n\n") == 3 == tokens("a='b c'\n")
