# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The messages of a log on the real topics again, with its timing, and a clock that shows its time."""

import time
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from bearing_sim import topics
from bearing_sim.input_log import REQUIRED, InputLog
from bearing_sim.ros.messages import message, message_class
from bearing_sim.runtime.clock_report import CAUGHT_UP
from bearing_sim.simulation import Inputs

SLICE = 0.05  # [s] a sleep is cut into such slices, so that a signal is obeyed
_ACKNOWLEDGED = 1.0  # [s] how long acknowledgements are waited for
_DELIVERY = 0.2  # [s] best-effort subscribers acknowledge nothing, and a message of a publisher that is gone is lost
_COURTESY = 1.0  # [s] how long the optional channels are waited for once the required ones are heard
_SETTLED = 1.0  # [s] after the end in which a follower of the clock cannot yet know that everything has come
_SCALAR = "std_msgs/msg/Float64"


class Play(NamedTuple):
    """One message to be published."""

    time: float  # [s] since the first message of the log
    channel: str
    values: tuple[float, ...]
    stamp_ns: int  # as in the log [ns since the epoch]


def plays(log: InputLog, by_stamps: bool = False) -> list[Play]:
    """Return a log's messages in the order of their log times, or by their stamps.

    By stamps, each channel keeps its order: a message stamped before the one that it follows is due with that one.
    """
    found = []
    for channel, series in log.series.items():
        newest = 0
        for log_ns, stamp, values in zip(series.log_times, series.stamps, series.values):
            newest = max(newest, stamp)
            found.append((newest if by_stamps else log_ns, channel, values, stamp))
    found.sort(key=lambda entry: entry[0])
    return [Play((due - found[0][0]) * 1e-9, channel, values, stamp) for due, channel, values, stamp in found]


class Timeline:
    """Where in the log a playback is: wall time at a rate, but for the pauses.

    Parameters
    ----------
    rate : log seconds for each second.
    paused : whether it begins with a pause.
    """

    def __init__(self, rate: float, paused: bool = False):
        self.rate, self._held, self._anchor = rate, 0.0 if paused else None, (time.monotonic(), 0.0)

    @property
    def is_paused(self) -> bool:
        """Whether the log's time stands still."""
        return self._held is not None

    @property
    def position(self) -> float:
        """Where it is [s since the first message]."""
        held, (wall, position) = self._held, self._anchor
        return held if held is not None else position + (time.monotonic() - wall) * self.rate

    def pause(self, paused: bool) -> None:
        """Hold the log's time, or let it go on from where it is."""
        position = self.position
        self._anchor, self._held = (time.monotonic(), position), position if paused else None

    def restart(self) -> None:
        """Begin at the first message again."""
        self._anchor, self._held = (time.monotonic(), 0.0), 0.0 if self.is_paused else None


class Player:
    """Publishes plays through a node.

    Parameters
    ----------
    node : the node whose names and remappings count; somebody else spins it, for its service ``~/pause`` (std_srvs/SetBool).
    wants_end : says whether to end early.
    channels : the channels that will be published.
    timeline : the log's time.
    scalar : publish shaft speed and radial load as Float64.
    clock_rate : readings of /clock for each second of wall time [Hz]; stamps are then the log's own.  None: no clock, stamps of now.
    joints : names of the joints, by channel.
    """

    def __init__(
        self,
        node: Node,
        wants_end: Callable[[], bool],
        channels,
        timeline: Timeline,
        scalar: bool = False,
        clock_rate: float | None = None,
        joints: dict[str, str] | None = None,
    ):
        self._node, self._wants_end, self.timeline = node, wants_end, timeline
        self._clock_period, self._next_clock = 1.0 / clock_rate if clock_rate else None, 0.0
        self._joints = joints or {}
        self.sent: Counter[str] = Counter()
        self.lateness = 0.0  # [s] summed over all messages
        self.reached = 0.0  # [s] time in the log
        self._caught_up: dict[str, tuple[float, bool]] = {}
        self._types = {channel: _type_of(channel, scalar) for channel in channels}
        # Offered reliable, so that any subscriber matches; all are kept until they are acknowledged, so that none is lost in a rush.
        qos = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
        self._publishers = {channel: node.create_publisher(message_class(kind), channel, qos) for channel, kind in self._types.items()}
        node.create_service(SetBool, "~/pause", self._serve_pause)
        if clock_rate:
            self._clock = node.create_publisher(Clock, "/clock", QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE))
            name, kind = topics.DIAGNOSTICS
            node.create_subscription(message_class(kind), f"/{name}", self._note_diagnostics, 100)

    @property
    def wants_end(self) -> bool:
        """Whether to end early."""
        return self._wants_end()

    def unheard(self, channels=REQUIRED) -> list[str]:
        """Return those of the channels that nobody listens to."""
        return [channel for channel in channels if self._publishers[channel].get_subscription_count() == 0]

    def wait_until_heard(self, limit: float) -> bool:
        """Wait for a subscriber of every required channel; False when ``limit`` [s] passed or a signal came."""
        if not self._wait(REQUIRED, limit):
            return False
        self._wait(self._publishers, _COURTESY)
        return not self.wants_end

    def _wait(self, channels, limit: float) -> bool:
        deadline = time.monotonic() + limit
        while self.unheard(channels):
            if time.monotonic() > deadline or self.wants_end:
                return False
            time.sleep(SLICE)
        return True

    def play(self, plays: list[Play], progress: Callable[[float], None]) -> bool:
        """Publish all; ``progress(time)`` is called as time goes.  False after a signal."""
        start_ns, line = self._node.get_clock().now().nanoseconds, self.timeline
        first_ns = plays[0].stamp_ns
        line.restart()
        for play in plays:
            while (rest := play.time - line.position) > 0.0 or line.is_paused:
                self._show_clock(first_ns + round(min(line.position, play.time) * 1e9))
                progress(line.position)
                if self.wants_end:
                    return False
                time.sleep(min(SLICE if line.is_paused else rest / line.rate, SLICE, self._clock_period or SLICE))
            if self.wants_end:
                return False
            self.lateness += -rest / line.rate
            self.reached = play.time
            self._show_clock(first_ns + round(play.time * 1e9))
            self._publish(play, start_ns + round(play.time / line.rate * 1e9) if self._clock_period is None else play.stamp_ns)
        progress(plays[-1].time)
        end_ns = first_ns + round(plays[-1].time * 1e9)
        self._show_clock(end_ns, at_once=True)
        deadline = time.monotonic() + _ACKNOWLEDGED
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(deadline - time.monotonic(), 0.0)))
        for _ in range(4):  # a clock that is not heard to have come to the end would leave the last messages unused
            self._show_clock(end_ns, at_once=True)
            time.sleep(_DELIVERY / 4)
        return True

    def wait_until_used(self, plays: list[Play], limit: float) -> bool:
        """Show the end of what was played until every follower says that it has used all; False after ``limit`` [s] or a signal."""
        began, end_ns = time.monotonic(), plays[0].stamp_ns + round(plays[-1].time * 1e9)
        while time.monotonic() - began < limit and not self.wants_end:
            self._show_clock(end_ns)
            known = [caught_up for at, caught_up in self._caught_up.values() if at - began > _SETTLED]
            if known and all(known) and len(known) == len(self._caught_up):
                return True
            time.sleep(SLICE)
        return False

    def _publish(self, play: Play, stamp_ns: int) -> None:
        kind = self._types[play.channel]
        fields = {"data": float(play.values[0])} if kind == _SCALAR else _fields(play, stamp_ns)
        if play.channel in self._joints and "name" in fields:
            fields["name"] = [self._joints[play.channel]]
        filled = message(kind, fields)
        while not self.wants_end:
            try:
                self._publishers[play.channel].publish(filled)
            except rclpy_implementation.RCLError:  # the queue is full of what a slow subscriber has not acknowledged
                time.sleep(SLICE)
            else:
                break
        self.sent[play.channel] += 1

    def _show_clock(self, time_ns: int, at_once: bool = False) -> None:
        if self._clock_period is None or (not at_once and time.monotonic() < self._next_clock):
            return
        self._next_clock = max(self._next_clock + self._clock_period, time.monotonic())
        self._clock.publish(message("rosgraph_msgs/msg/Clock", {"clock": topics.stamp(time_ns)}))

    def _serve_pause(self, request, response):
        self.timeline.pause(request.data)
        response.success, response.message = True, f"{'paused' if request.data else 'going on'} at {self.timeline.position:.3f} s of the log"
        return response

    def _note_diagnostics(self, report) -> None:
        for status in report.status[:1]:
            for pair in status.values:
                if pair.key == CAUGHT_UP:
                    self._caught_up[status.name] = (time.monotonic(), pair.value == "True")


def _type_of(channel: str, scalar: bool) -> str:
    if scalar and _SCALAR in topics.input_types(channel):
        return _SCALAR
    return topics.input_types(channel)[0]


def _fields(play: Play, stamp_ns: int) -> dict:
    if play.channel == topics.MEASURED:
        return topics.MEASUREMENTS[play.channel].message(stamp_ns, play.values[0])
    values = (*play.values, 0.0)
    # the message of a channel reads no others
    inputs = Inputs(shaft_speed=values[0], load_y=values[0], load_z=values[1], oil_temperature=values[0])
    return topics.INPUTS[play.channel].message(stamp_ns, inputs)
