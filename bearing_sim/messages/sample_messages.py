# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Serialised messages of samples, filled by copying numbers.

The messages of one output topic differ only in their stamps and numbers.  Each topic is therefore serialised once as a template; where its
numbers and stamp stand follows from the definition of its type (`bearing_sim.messages.cdr`).  A recording then fills the templates
of many samples at once, the node those of all topics of one sample.  Numbers that are not in a sample, but follow from it, are computed for all
samples of a block together, and in the node only for topics that somebody listens to.
"""

import struct
from collections.abc import Callable, Sequence
from functools import reduce
from operator import getitem
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.cdr import ENCAPSULATION, STAMP_FIELDS, CdrLayout, message_type
from bearing_sim.messages.topics import ESTIMATED, FRAME, Topic
from bearing_sim.model.sample import new_block, sample_dtype

_STAMP = struct.Struct("<iI")  # builtin_interfaces/Time
_WORD = 8  # [byte] of a number


class NumberRun(NamedTuple):
    """Numbers that stand side by side both in the sample and in its message."""

    source: int  # column of the sample laid out flat
    count: int
    target: int  # [byte] in the message


class ComputedRun(NamedTuple):
    """Numbers that stand side by side in a message and are computed from samples."""

    numbers: Callable[[np.ndarray], np.ndarray]  # see `bearing_sim.messages.topics.Computed`
    dtype: np.dtype
    count: int
    target: int  # [byte] in the message


class MessageTemplate(NamedTuple):
    """The message of one topic, and the places that change from sample to sample."""

    data: bytes
    runs: tuple[NumberRun, ...]
    stamp: int | None  # [byte] of the header's stamp; None without a header
    computed: ComputedRun | None = None


def message_templates(topics: Sequence[Topic], rollers: int, frame: str = FRAME) -> tuple[MessageTemplate, ...]:
    """Return the templates of some output topics.

    Parameters
    ----------
    topics : output topics with observables, or with numbers that are computed from samples.
    rollers : number of rollers of the samples.
    frame : the bearing's, for headers.

    Raises
    ------
    ValueError
        A topic does not carry numbers of the sample, or not as float64.
    """
    sample = new_block(1, rollers)[0]
    templates = []
    for topic in topics:
        message = topic.message(0, sample)
        if "header" in message:
            message["header"]["frame_id"] = frame
        templates.append(_template(topic, message_type(topic.ros_type).serialize(message), rollers))
    return tuple(templates)


def sample_columns(topic: Topic, rollers: int) -> dict[str, np.ndarray]:
    """Return the columns, in a sample laid out flat, of the numbers of a topic's message, by field."""
    dtype = sample_dtype(rollers)

    def columns(name: str) -> np.ndarray:
        return dtype.fields[name][1] // _WORD + np.arange(dtype[name].itemsize // _WORD)

    return {field: np.concatenate([columns(name) for name in names]) for field, names in topic.observables.items()}


def _template(topic: Topic, data: bytes, rollers: int) -> MessageTemplate:
    layout = CdrLayout(topic.ros_type, data)
    runs = []
    for path, columns in sample_columns(topic, rollers).items():
        field = layout.by_path[path]
        if field.dtype != np.float64 or field.count < len(columns):
            raise ValueError(f"topic {topic.name}: {path} has {field.count} numbers of {field.dtype}, expected {len(columns)} of float64")
        starts = [0, *np.flatnonzero(np.diff(columns) != 1) + 1]
        runs += [
            NumberRun(int(columns[start]), int(end - start), field.begin + _WORD * int(start))
            for start, end in zip(starts, [*starts[1:], len(columns)])
        ]
    if not runs and topic.computed is None:
        raise ValueError(f"topic {topic.name}: its messages hold no number of a sample; expected Topic.observables to name some, or Topic.computed")
    stamp = layout.by_path[STAMP_FIELDS[0]].begin if STAMP_FIELDS[0] in layout.by_path else None
    computed = None
    if topic.computed is not None:
        numbers = topic.computed.numbers(new_block(1, rollers))
        computed = ComputedRun(topic.computed.numbers, numbers.dtype, numbers.shape[1], layout.by_path[topic.computed.field].begin)
    return MessageTemplate(data, tuple(runs), stamp, computed)


class SampleMessages:
    """The messages of all topics of one sample, filled at once.

    Parameters
    ----------
    templates : of the messages (see `message_templates`).

    Attributes
    ----------
    parts : tuple[memoryview, ...]
        The serialised messages, in the order of their templates; `fill` changes them.
    """

    def __init__(self, templates: Sequence[MessageTemplate]):
        buffer, slices, self._stamps, pairs, computed = bytearray(), [], [], [], []
        for template in templates:
            buffer += bytes(-(len(buffer) + ENCAPSULATION) % _WORD)  # so that the numbers of all messages are words of the buffer
            begin = len(buffer)
            buffer += template.data
            slices.append(slice(begin, len(buffer)))
            self._stamps += [] if template.stamp is None else [begin + template.stamp]
            computed.append(None if template.computed is None else template.computed._replace(target=begin + template.computed.target))
            pairs += [(begin + run.target + _WORD * k, run.source + k) for run in template.runs for k in range(run.count)]
        buffer += bytes(-len(buffer) % _WORD)
        targets, sources = np.array(pairs, np.intp).reshape(-1, 2).T
        self._buffer, self._targets, self._sources = buffer, targets // _WORD, sources
        whole = memoryview(buffer).toreadonly()
        self.parts = tuple(whole[part] for part in slices)
        self._words = np.frombuffer(buffer, np.float64)
        self._computed = [run and (run.numbers, np.frombuffer(buffer, run.dtype, run.count, run.target)) for run in computed]
        self._wanted = [run for run in self._computed if run]

    def compute(self, wanted: Sequence[bool]) -> None:
        """Say which messages `fill` fills with numbers that must be computed, in the order of the templates; at first all."""
        self._wanted = [run for run, is_wanted in zip(self._computed, wanted, strict=True) if run and is_wanted]

    def fill(self, stamp_ns: int, sample: np.void) -> None:
        """Fill the messages with the numbers of a sample and a stamp [ns since the epoch]."""
        if self._wanted:
            block = np.frombuffer(sample, sample.dtype)
            for numbers, target in self._wanted:
                target[:] = numbers(block)[0]
        self._words[self._targets] = np.frombuffer(sample, np.float64)[self._sources]
        for at in self._stamps:
            _STAMP.pack_into(self._buffer, at, *divmod(stamp_ns, 1_000_000_000))


class FilledMessages:
    """Serialised messages of inputs, measurements and bands: those of a topic, frame and joints differ in stamp and numbers only."""

    def __init__(self):
        self._templates: dict[tuple[str | None, ...], tuple[bytearray, int | None, list[tuple[int, list[str]]]]] = {}

    def serialized(self, topic: Topic, stamp_ns: int, source, frame: str | None = None) -> bytes:
        """Return a message.

        Parameters
        ----------
        topic : of `bearing_sim.messages.topics.INPUTS`, ``MEASUREMENTS`` or ``ESTIMATED``.
        stamp_ns : of its header, if it has one [ns since the epoch].
        source : what `Topic.message` takes.
        frame : in its header; that of the topic if absent.
        """
        message = topic.message(0, source)
        key = (topic.name, frame, *message.get("name", ()))
        if key not in self._templates:
            if frame is not None and "header" in message:
                message["header"]["frame_id"] = frame
            data = message_type(topic.ros_type).serialize(message)
            layout = CdrLayout(topic.ros_type, data)
            stamp = layout.by_path[STAMP_FIELDS[0]].begin if STAMP_FIELDS[0] in layout.by_path else None
            self._templates[key] = bytearray(data), stamp, [(field.begin, field.path.split(".")) for field in layout.numbers]
        data, stamp, fields = self._templates[key]
        if stamp is not None:
            _STAMP.pack_into(data, stamp, *divmod(int(stamp_ns), 1_000_000_000))
        for begin, path in fields:
            numbers = np.asarray(reduce(getitem, path, message), np.float64).tobytes()
            data[begin : begin + len(numbers)] = numbers
        return bytes(data)

    def of_bands(self, bands: Bands, stamps_ns: Sequence[int], frame: str) -> list[bytes]:
        """Return the message of each instant of bands, with its stamp [ns since the epoch]."""
        each = zip(stamps_ns, bands.numbers, strict=True)
        return [self.serialized(ESTIMATED[bands.topic], stamp_ns, bands._replace(numbers=numbers[None]), frame) for stamp_ns, numbers in each]
