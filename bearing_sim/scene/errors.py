# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The error of a scene that cannot be used, with all its invalid fields."""

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

_LONGEST_VALUE, _LONGEST_REASON = 200, 2000  # characters in a message
_LONGEST_WORD = 80  # characters of a name; finding the nearest of a long text takes long


def shortened(text: str, longest: int) -> str:
    """Return a text for a message, without its middle if it is longer than that many characters; it may be as long as a file."""
    return text if len(text) <= longest else f"{text[: longest // 2]} ... ({len(text)} characters) ... {text[-longest // 4 :]}"


@dataclass(frozen=True)
class InvalidField:
    """One error in a scene: where it is, the value found (as text) and what was expected."""

    path: str
    value: str
    reason: str

    def __str__(self) -> str:
        found = f" = {shortened(self.value, _LONGEST_VALUE)}" if self.value else ""
        return f"{shortened(self.path, _LONGEST_VALUE) or 'scene'}{found}: {shortened(self.reason, _LONGEST_REASON)}"


class SceneError(ValueError):
    """A scene that cannot be used; ``errors`` lists every invalid field."""

    def __init__(self, origin: str, errors: Iterable[InvalidField]):
        self.origin = origin
        self.errors = tuple(errors)
        count = len(self.errors)
        heading = f"{shortened(origin, _LONGEST_VALUE)}: {count} error{'s' * (count != 1)}"
        super().__init__("\n".join([heading, *(f"  {error}" for error in self.errors)]))


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``" (did you mean ...?)"`` for the nearest known word, whatever its capitals, or an empty text."""
    by_fold = {each.casefold(): each for each in known}
    close = difflib.get_close_matches(word.casefold(), list(by_fold), n=1) if len(word) <= _LONGEST_WORD else []
    return f" (did you mean {by_fold[close[0]]!r}?)" if close else ""
