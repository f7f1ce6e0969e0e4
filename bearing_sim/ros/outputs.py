# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Publish samples cheaply: only what somebody listens to, into messages that are made once."""

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import QoSProfile

from bearing_sim.ros.messages import fill, message_class
from bearing_sim.topics import Topic

_ALWAYS_THE_SAME = ("layout", "name", "effort")  # fields of an output that no sample changes


class Output:
    """One output topic of a bearing.

    Each message costs the node's thread more in the making and sending than in the computing; a topic without a listener is left out, and
    fields that never change are filled once.  Events of quality of service are not watched, each would wait beside every message: a
    subscriber that asks for what is not offered is warned on its own side.

    Parameters
    ----------
    node : on which the publisher is made, silent until the node is active.
    topic : what is published.
    name : of the topic.
    qos : offered.
    """

    def __init__(self, node: LifecycleNode, topic: Topic, name: str, qos: QoSProfile):
        self._node, self._topic = node, topic
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        self._publisher = node.create_lifecycle_publisher(message_class(topic.ros_type), name, qos, event_callbacks=quiet)
        self._message, self._is_filled = message_class(topic.ros_type)(), False

    def publish(self, stamp_ns: int, source) -> None:
        """Publish a sample, or whatever the topic takes, if somebody listens."""
        if self._publisher.get_subscription_count() == 0:
            return
        fields = self._topic.message(stamp_ns, source)
        if self._is_filled:
            for field in _ALWAYS_THE_SAME:
                fields.pop(field, None)
        fill(self._message, fields)
        self._is_filled = True
        self._publisher.publish(self._message)

    def destroy(self) -> None:
        """Take the topic away."""
        self._node.destroy_lifecycle_publisher(self._publisher)
