# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the numbers of a sample stand in the serialised messages of its topics.

Messages of one topic differ in nothing but their stamps and numbers, so a message serialised once is a template: the next ones come of
copying numbers into it, for a recording many samples at once, for the node all topics of one sample.
"""

import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.sample import flat, new_block
from bearing_sim.sinks.ros_types import message_type
from bearing_sim.topics import Topic

_PROBE_STAMP = 1_234_567_891_987_654_321  # [ns]: seconds and nanoseconds whose bytes occur nowhere else in a message
_STAMP = struct.Struct("<iI")  # builtin_interfaces/Time
_WORD = 8  # [byte] of a number
_ENCAPSULATION = 4  # [byte] of a message before what CDR aligns


class NumberRun(NamedTuple):
    """Numbers that lie side by side in the sample and in its message."""

    source: int  # column of the sample laid out flat
    count: int
    target: int  # [byte] in the message


class MessageLayout(NamedTuple):
    """The message of one topic: a template, and what in it changes."""

    template: bytes
    runs: tuple[NumberRun, ...]
    stamps: tuple[int, ...]  # where header stamps stand [byte]


def message_layouts(topics: Sequence[Topic], rollers: int) -> tuple[MessageLayout, ...]:
    """Return where the numbers of a sample stand in the messages of some topics.

    Parameters
    ----------
    topics : output topics whose messages hold numbers of the sample as they are.
    rollers : number of rollers, as many as the samples have.

    Raises
    ------
    ValueError
        A topic changes the numbers, so that its messages cannot be filled in this way.
    """
    probe = new_block(1, rollers)
    numbers = flat(probe)
    numbers[0] = np.random.default_rng(1).uniform(1.0, 2.0, numbers.shape[1])  # nobody's numbers, each told from the others
    found = []
    for topic in topics:
        cdr = message_type(topic.ros_type).serialize(topic.message(_PROBE_STAMP, probe[0]))
        found.append(MessageLayout(cdr, _runs(topic.name, cdr, numbers[0]), _stamps(cdr)))
    return tuple(found)


class SampleMessages:
    """The messages of all topics of one sample, filled at once.

    Parameters
    ----------
    layouts : of the messages.

    Attributes
    ----------
    parts : tuple[memoryview, ...]
        The serialised messages, in the order of their layouts; `fill` changes them.
    """

    def __init__(self, layouts: Sequence[MessageLayout]):
        buffer, places_of_parts, self._stamps, pairs = bytearray(), [], [], []
        for layout in layouts:
            buffer += bytes(-(len(buffer) + _ENCAPSULATION) % _WORD)  # so that the numbers of all messages are words of the buffer
            begin = len(buffer)
            buffer += layout.template
            places_of_parts.append(slice(begin, len(buffer)))
            self._stamps += [begin + place for place in layout.stamps]
            pairs += [(begin + run.target + _WORD * k, run.source + k) for run in layout.runs for k in range(run.count)]
        buffer += bytes(-len(buffer) % _WORD)
        places, sources = np.array(pairs, np.intp).reshape(-1, 2).T
        if (places % _WORD).any():
            raise ValueError("a message's numbers are not aligned to eight bytes: it is not CDR of version 1")
        self._buffer, self._places, self._sources = buffer, places // _WORD, sources
        whole = memoryview(buffer).toreadonly()
        self.parts = tuple(whole[part] for part in places_of_parts)
        self._words = np.frombuffer(buffer, np.float64)

    def fill(self, stamp_ns: int, sample: np.void) -> None:
        """Let the messages be those of a sample, stamped so [ns since the epoch]."""
        self._words[self._places] = np.frombuffer(sample, np.float64)[self._sources]
        for place in self._stamps:
            _STAMP.pack_into(self._buffer, place, *divmod(stamp_ns, 1_000_000_000))


def _runs(name: str, cdr: bytes, numbers: np.ndarray) -> tuple[NumberRun, ...]:
    """Return where the numbers stand in a message, runs of neighbours joined."""
    places = sorted((cdr.find(number.tobytes()), column) for column, number in enumerate(numbers) if number.tobytes() in cdr)
    known = len(places) * _WORD
    doubled = sum(cdr.count(numbers[column].tobytes()) for _, column in places)
    if not places or doubled != len(places):
        raise ValueError(f"topic {name}: {known} bytes of its message are numbers of the sample, {doubled} times; expected each once")
    runs: list[NumberRun] = []
    for place, column in places:
        last = runs[-1] if runs else None
        if last is not None and last.target + _WORD * last.count == place and last.source + last.count == column:
            runs[-1] = last._replace(count=last.count + 1)
        else:
            runs.append(NumberRun(column, 1, place))
    return tuple(runs)


def _stamps(cdr: bytes) -> tuple[int, ...]:
    """Return where header stamps stand in a message [byte]."""
    pattern = _STAMP.pack(*divmod(_PROBE_STAMP, 1_000_000_000))
    return (cdr.index(pattern),) if pattern in cdr else ()
