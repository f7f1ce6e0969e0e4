# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Publish the samples of a bearing cheaply: only what somebody listens to, serialised for all topics at once."""

from collections.abc import Callable
from contextlib import ExitStack

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from bearing_sim import topics
from bearing_sim.ros.messages import message, message_class
from bearing_sim.scene import Scene
from bearing_sim.sinks.message_layout import SampleMessages, message_layouts
from bearing_sim.topics import Topic


class Soon:
    """Has something done on the thread that spins a node, soon, and once however often it is asked for meanwhile.

    Parameters
    ----------
    node : whose executor does it.
    action : what is to be done.
    """

    def __init__(self, node: Node, action: Callable[[], None]):
        self._node, self._action, self._is_asked = node, action, False

    def __call__(self) -> None:
        """Ask for it, from any one thread; nothing comes of it while the node has no executor."""
        executor = self._node.executor
        if executor is None or self._is_asked:
            return
        self._is_asked = True
        executor.create_task(self._act)

    def _act(self) -> None:
        self._is_asked = False  # before, so that what comes up in the middle of it is not missed
        self._action()


class Outputs:
    """The output topics of a bearing, and the residual slip where its cage is measured.

    Making message objects and having rclpy serialise them would cost more than all else in the node; so the serialised messages of a
    sample are filled by its numbers all at once, and a topic without a listener is left out.  Events of quality of service are not
    watched: a subscriber that asks for what is not offered is warned on its own side.  The publishers are plain ones: while the node is
    not active there are no samples, and rclpy's lifecycle publishers would look whether it is at every message.

    Parameters
    ----------
    node : on which the publishers are made.
    scene : of the bearing; its level has the topics.
    name_of : ``name_of(topic)`` is the name under which a topic is published.
    qos : offered.
    """

    def __init__(self, node: Node, scene: Scene, name_of: Callable[[str], str], qos: QoSProfile):
        self._node, self._name_of, self._qos = node, name_of, qos
        self._topics, self._rollers = tuple(topics.outputs(scene).values()), scene.bearing.roller.count
        self._publishers = [self._publisher(topic) for topic in self._topics]
        self._held = ExitStack()
        self._sends = [_send_bytes(publisher, self._held) for publisher in self._publishers]
        self._messages: SampleMessages | None = None
        residual = topics.MEASUREMENTS["cage_slip_residual"]
        self._residual_topic, self._residual = residual, self._publisher(residual)
        self._heard: list[tuple[memoryview, Callable[[bytes], None]]] = []

    def lay_out(self) -> None:
        """Find out where the numbers stand in the messages; before anything is published, on any thread, for it takes a moment."""
        self._messages = SampleMessages(message_layouts(self._topics, self._rollers))

    def look(self) -> None:
        """Take notice of who listens; asking at every message would cost a quarter of what sending it does."""
        heard = (publisher.get_subscription_count() for publisher in self._publishers)
        self._heard = [(part, send) for part, send, count in zip(self._messages.parts, self._sends, heard) if count]

    def publish(self, stamp_ns: int, sample) -> None:
        """Publish a sample on the topics that somebody listened to when last looked at."""
        if not self._heard:
            return
        self._messages.fill(stamp_ns, sample)
        for part, send in self._heard:
            send(bytes(part))

    def publish_residual(self, stamp_ns: int, residual: float) -> None:
        """Publish how much more than predicted the cage slips."""
        topic = self._residual_topic
        self._residual.publish(message(topic.ros_type, topic.message(stamp_ns, residual)))

    def destroy(self) -> None:
        """Take the topics away."""
        self._held.close()
        for publisher in (*self._publishers, self._residual):
            self._node.destroy_publisher(publisher)

    def _publisher(self, topic: Topic):
        quiet = PublisherEventCallbacks(use_default_callbacks=False)
        return self._node.create_publisher(message_class(topic.ros_type), self._name_of(topic.name), self._qos, event_callbacks=quiet)


def _send_bytes(publisher: Publisher, held: ExitStack) -> Callable[[bytes], None]:
    """Return what publishes a serialised message, until ``held`` is closed.

    That is what `Publisher.publish` comes to in the end; what it does before, for every message the same, is done once here, which saves
    a sixth of what publishing costs.
    """
    handle = publisher.handle
    if not hasattr(handle, "publish_raw"):  # another rclpy
        return publisher.publish
    held.enter_context(handle)
    return handle.publish_raw
