# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What was there of something that was read, what of it was used, and what was not and why: one record that every reader fills.

Commands print it and end with the exit code of a part (`bearing_sim.cli.reporting.tell_use`).  In Python it is an attribute of what was
read, and a part cannot be overlooked: a recording of a run raises at its end (`bearing_sim.recording.bag.PartialRecording`); a log of inputs, in
which single bad messages are no surprise, warns (`PartlyUsedWarning`).
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field


class PartlyUsedWarning(UserWarning):
    """Only a part of a log is used; the message says how much, why, and what may help."""


@dataclass
class Tally:
    """What was there, what was used, and what was not and why.

    Attributes
    ----------
    unit : what is counted: ``messages``, ``rows`` or ``samples``.
    there : how many there were, as far as the source could be read or says itself.
    used : how many of them were used.
    refused : by reason, how many were not; one that has several faults counts for each.
    unread : where and why the source could not be read to its end; nobody knows how many were there.
    remedies : what may help.
    notes : what was read in another way than the source says; nothing is missing for that.
    """

    unit: str = "messages"
    there: int = 0
    used: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    unread: list[str] = field(default_factory=list)
    remedies: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def is_whole(self) -> bool:
        """Whether all that was there was used."""
        return self.used == self.there and not self.unread

    @property
    def counts(self) -> str:
        """The numbers in words: ``40 of 400 messages used (360 x input.time_backwards)``."""
        reasons = ", ".join(f"{count} x {reason}" for reason, count in sorted(self.refused.items()))
        return f"{self.used} of {self.there} {self.unit} used{f' ({reasons})' if reasons else ''}"

    @property
    def text(self) -> str:
        """Everything but the notes in one sentence."""
        return "; ".join([self.counts, *self.unread, *self.remedies])

    @property
    def unfinished(self) -> str:
        """Where and why the source could not be read to its end, or ``""``."""
        return "; ".join(self.unread)

    def refuse(self, reason: str, count: int = 1) -> None:
        """Count items that were there and are not used."""
        self.there += count
        self.refused[reason] += count

    def use(self, count: int = 1) -> None:
        """Count items that were there and are used."""
        self.there += count
        self.used += count

    def add(self, others: Iterable["Tally"]) -> None:
        """Add what other readers of the same unit found."""
        for other in others:
            self.there += other.there
            self.used += other.used
            self.refused += other.refused
            for own, texts in ((self.unread, other.unread), (self.remedies, other.remedies), (self.notes, other.notes)):
                own += [text for text in texts if text not in own]

    def report(self) -> dict:
        """Return the numbers and texts by name, for JSON."""
        found = {"unit": self.unit, "there": self.there, "used": self.used, "not_used_by_reason": dict(self.refused)}
        return found | {"unread": self.unread, "remedies": self.remedies, "notes": self.notes}
