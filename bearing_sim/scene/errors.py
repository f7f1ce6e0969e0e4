# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The error of a scene that cannot be used, with all its invalid fields."""

import difflib
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class InvalidField:
    """One error in a scene: where it is, the value found (as text) and what was expected."""

    path: str
    value: str
    reason: str

    def __str__(self) -> str:
        found = f" = {self.value}" if self.value else ""
        return f"{self.path or 'scene'}{found}: {self.reason}"


class SceneError(ValueError):
    """A scene that cannot be used; ``errors`` lists every invalid field."""

    def __init__(self, origin: str, errors: Iterable[InvalidField]):
        self.origin = origin
        self.errors = tuple(errors)
        count = len(self.errors)
        super().__init__("\n".join([f"{origin}: {count} error{'s' * (count != 1)}"] + [f"  {error}" for error in self.errors]))


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``" (did you mean ...?)"`` for the nearest known word, or an empty text."""
    close = difflib.get_close_matches(word, list(known), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""
