# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A course of messages played to a `SimTimeModel` in any order and at any pace of its clock, and the same course replayed offline."""

import math
import time
from collections import defaultdict
from typing import NamedTuple

import numpy as np
from recordings import JOINTS, SECOND, TEMPERATURE, WRENCH, joint_state, temperature, wrench

from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import judge
from bearing_sim.messages import topics
from bearing_sim.messages.events import Event, MeasuredClearance, Measurement, ReceivedInputs, Report, Start
from bearing_sim.recording.writer import McapFile
from bearing_sim.runtime.replay import replay
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation

SCENE = load_scene("deng2017_table1")
START_NS = 1_700_000_000 * SECOND
RATE = 50.0  # [Hz] of outputs
PATIENCE = 60.0  # [s]


class Message(NamedTuple):
    """One message, ``stamp`` in seconds after `START_NS`."""

    stamp: float
    channel: str
    values: tuple[float, ...]

    @property
    def stamp_ns(self) -> int:
        return START_NS + round(self.stamp * 1e9)


def course(seconds: float, begin: float = 0.0, oil: bool = True, cage: bool = False) -> list[Message]:
    """Return a manoeuvre: speed at 40 Hz, a load of its own times, oil at 2 Hz, a measured cage at 10 Hz and clearance at 5 Hz.

    All times are odd to those of outputs.
    """
    messages = []
    for time_ in begin + np.arange(0.0, seconds, 0.025) + 0.0013:
        messages.append(Message(float(time_), "shaft_speed", (1500.0 + 300.0 * math.sin(2.0 * time_),)))
    for time_ in begin + np.arange(0.0, seconds, 0.034) + 0.0071:
        messages.append(Message(float(time_), "radial_load", (800.0 + 200.0 * math.cos(3.0 * time_), 50.0 * math.sin(time_))))
    if oil:
        for time_ in begin + np.arange(0.3, seconds, 0.5) + 0.0042:
            messages.append(Message(float(time_), "oil_temperature", (360.0 + 5.0 * time_,)))
    if cage:
        for time_ in begin + np.arange(0.0, seconds, 0.1) + 0.0093:
            messages.append(Message(float(time_), topics.MEASURED, (600.0 + time_,)))
        for time_ in begin + np.arange(0.0, seconds, 0.2) + 0.0057:
            messages.append(Message(float(time_), topics.MEASURED_CLEARANCE, (3e-5 + 1e-6 * time_, 1e-6)))
    return sorted(messages)


def write(path, messages: list[Message]):
    """Write messages as a recording whose log times are their stamps."""
    with McapFile(path) as recording:
        for message in messages:
            ns = message.stamp_ns
            fields = {
                "shaft_speed": lambda m=message, ns=ns: joint_state(ns, m.values[0]),
                "radial_load": lambda m=message, ns=ns: wrench(ns, *m.values),
                **dict.fromkeys(topics.TEMPERATURES, lambda m=message, ns=ns: temperature(ns, m.values[0] - topics.ZERO_CELSIUS)),
                **{name: lambda m=message, ns=ns: topics.MEASUREMENTS[m.channel].message(ns, m.values) for name in topics.MEASURED_CHANNELS},
            }[message.channel]()
            kind = ({"radial_load": WRENCH} | dict.fromkeys(topics.TEMPERATURES, TEMPERATURE)).get(message.channel, JOINTS)
            recording.write(f"/{message.channel}", kind, ns, fields)
    return path


class ListSink:
    """Keeps what a recorder would write, by time in nanoseconds since the epoch."""

    def __init__(self, start_ns: int = 0):
        self.start_ns, self.closed = start_ns, False
        self.samples, self.inputs, self.measurements, self.clearances = {}, [], [], []
        self.events, self.diagnostics = [], []

    keeps_all = True

    def write(self, record):
        match record:
            case np.ndarray() | Start():
                for sample in record.block if isinstance(record, Start) else record:
                    self.samples[self._ns(sample["time"])] = sample.copy()
            case ReceivedInputs(time, inputs, channels):
                known = {name: value for name, value in inputs._asdict().items() if not math.isnan(value)}  # NaN is not equal to itself
                self.inputs.append((self._ns(time), known, tuple(channels)))
            case Measurement(time, cage_speed, residual):
                self.measurements.append((self._ns(time), cage_speed, residual))
            case MeasuredClearance(time, clearance, standard_error):
                self.clearances.append((self._ns(time), clearance, standard_error))
            case Event():
                self.events.append(record)
            case Report(time, events, values):
                self.diagnostics.append((time, list(events), values))

    def close(self):
        self.closed = True

    def _ns(self, time) -> int:
        return self.start_ns + round(float(time) * 1e9)


def replayed(path, scene=SCENE, rate: float = RATE, model=Simulation) -> ListSink:
    """Return what an offline replay writes."""
    held = Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature)
    judged = judge(read_input_log(path), scene.accepted_inputs, held, heat_law=scene.heat.law)
    sink = ListSink(judged.start_ns)
    replay(scene, judged, sink, rate=rate, model=model)
    return sink


class Player:
    """Offers messages to a model, each before the clock passes its stamp by a tick, while a false wall clock goes on."""

    def __init__(self, model, wall):
        self.model, self.wall, self.news = model, wall, []
        self.expects = defaultdict(bool)

    def play(self, messages, ticks, shuffled=None, pace=1.0):
        """Play messages to a clock that shows ``ticks`` [s after `START_NS`] and goes ``pace`` times as fast as the wall."""
        left = list(messages)
        before = ticks[0]
        for tick in ticks:
            self.wall.now += max(tick - before, 0.0) / pace
            before = tick
            due = [message for message in left if message.stamp <= tick]
            left = left[len(due) :]
            if shuffled is not None:
                due = by_channels(due, shuffled)
            for message in due:
                self.offer(message)
            self.tick(tick)
        return left

    def offer(self, message, stamped=True):
        now = self.model_now()
        return self.model.offer(message.channel, message.values, message.stamp_ns if stamped else None, now)

    def model_now(self):
        return self.now_ns

    now_ns = 0

    def tick(self, seconds):
        self.now_ns = START_NS + round(seconds * 1e9)
        self.model.tick(self.now_ns)
        self.collect()

    def collect(self):
        self.news += self.model.collect(self.now_ns)

    def stand(self, seconds, slices=10):
        """Let wall time pass, the clock stands."""
        for _ in range(slices):
            self.wall.now += seconds / slices
            self.collect()

    def until(self, condition, what=""):
        """Let the model work until a condition holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"waited in vain: {what}; {self.model.condition(self.now_ns)}"
            time.sleep(0.002)
            self.collect()

    def until_idle(self):
        """Let the model compute all that it can."""
        self.until(lambda: self.model.solver.is_idle, "the model has computed all that it can")
        self.collect()


def by_channels(messages, lot):
    """Return messages with the order between channels changed at random, each channel's own kept."""
    queues = defaultdict(list)
    for message in messages:
        queues[message.channel].append(message)
    mixed = []
    while queues:
        channel = lot.choice(sorted(queues))
        mixed.append(queues[channel].pop(0))
        if not queues[channel]:
            del queues[channel]
    return mixed


class FalseWall:
    """A wall clock that goes when it is told to."""

    def __init__(self):
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def assert_same_samples(got: dict, expected: dict):
    """Assert that samples of the same stamps are the same to the last bit."""
    assert list(got) == list(expected)
    for ns, sample in got.items():
        for name in sample.dtype.names:
            np.testing.assert_array_equal(sample[name], expected[ns][name], err_msg=f"{name} at {ns}")
