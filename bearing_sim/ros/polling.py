# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Subscriptions of many bearings, whose messages are taken together every few milliseconds.

An executor wakes up for each message and takes the interpreter's lock for it, which costs several times what is then done with the message, and as
often interrupts the solver thread, which needs that lock after each tick.
"""

from collections.abc import Callable
from contextlib import ExitStack

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from bearing_sim.ros.rclpy_internals import taker

POLLED_FROM = 10
"""Bearings in a process from which on this pays."""

_PERIOD = 0.005  # [s] half a tick: inputs act a few milliseconds later than they would


class PolledSubscriptions:
    """Subscriptions to serialised messages.

    They belong to a ROS node of their own, which no executor spins.

    Parameters
    ----------
    node : whose executor runs the callbacks; its name, with ``_inputs`` after it, is that of the other one.
    """

    def __init__(self, node: Node):
        options = {"start_parameter_services": False, "enable_rosout": False}
        self._node = rclpy.create_node(f"{node.get_name()}_inputs", namespace=node.get_namespace(), context=node.context, **options)
        self._taken: dict[Subscription, tuple[Callable[[bytes], None], Callable[[], tuple[bytes, dict] | None], ExitStack]] = {}
        self._timer = node.create_timer(_PERIOD, self._take, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def create_subscription(self, kind: type, topic: str, callback: Callable[[bytes], None], qos: QoSProfile, **options) -> Subscription:
        """Subscribe; parameters as of ``rclpy.node.Node.create_subscription``."""
        subscription = self._node.create_subscription(kind, topic, callback, qos, **options)
        borrowed = ExitStack()
        self._taken[subscription] = callback, taker(subscription, borrowed), borrowed
        return subscription

    def destroy_subscription(self, subscription: Subscription) -> None:
        """End a subscription."""
        self._taken.pop(subscription)[-1].close()
        self._node.destroy_subscription(subscription)

    def destroy(self) -> None:
        """End all subscriptions."""
        for subscription in list(self._taken):
            self.destroy_subscription(subscription)
        self._node.destroy_node()

    def _take(self) -> None:
        for callback, take, _ in list(self._taken.values()):
            while (found := take()) is not None:
                callback(found[0])
