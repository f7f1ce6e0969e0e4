# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The ROS side of sim time: the parameter, /clock, timers that go on when it stands still, and topics that lose nothing."""

from collections.abc import Callable

from rclpy.clock import Clock, ClockType, JumpHandle, JumpThreshold
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

# What a run by wall time may miss would make this one another than the recording's.
_INPUT_QOS = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
_ANY_INPUT_QOS = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.BEST_EFFORT)
OUTPUT_QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)  # a step of /clock may bring many outputs at once


def follows_clock(node: Node) -> bool:
    """Return whether a node goes by /clock."""
    return bool(node.get_parameter("use_sim_time").value)


def watch_clock(node: Node, tick: Callable[[int], None]) -> JumpHandle:
    """Call ``tick`` with every reading of /clock [ns since the epoch], as long as the handle is kept."""
    threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1), on_clock_change=True)
    return node.get_clock().create_jump_callback(threshold, post_callback=lambda _: tick(node.get_clock().now().nanoseconds))


def create_steady_timer(node: Node, period: float, callback: Callable[[], None]):
    """Return a timer of wall time [s], which goes on when /clock stands still or is not there."""
    return node.create_timer(period, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


def subscribe_to_all(
    node: Node, message_class, topic: str, callback: Callable, replaced: Callable[[Subscription], None], lost: Callable[[str], None]
) -> Subscription:
    """Return a subscription, to messages as they are serialised, that no message is lost to where its publishers are reliable.

    Parameters
    ----------
    message_class, topic, callback : as of ``create_subscription``.
    replaced : told the subscription that takes over where a publisher offers best effort only; of it messages may be lost.
    lost : told in words when that happens, and when messages were lost.
    """

    def fall_back(_) -> None:
        if fallen:
            return
        fallen.append(True)
        lost(f"{topic}: a publisher offers best effort only; what it loses on the way makes this run another than that of the recording")
        node.destroy_subscription(subscription)
        replaced(node.create_subscription(message_class, topic, callback, _ANY_INPUT_QOS, event_callbacks=told, raw=True))

    fallen: list[bool] = []
    told = SubscriptionEventCallbacks(
        message_lost=lambda info: lost(f"{topic}: {info.total_count} messages were lost on the way; inputs are linear across them")
    )
    events = SubscriptionEventCallbacks(incompatible_qos=fall_back, message_lost=told.message_lost)
    subscription = node.create_subscription(message_class, topic, callback, _INPUT_QOS, event_callbacks=events, raw=True)
    return subscription
