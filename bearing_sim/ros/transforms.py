# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Static transforms of a node: those of its bearings are published on ``/tf_static``, those of others are read there.

tf2_msgs comes with every ROS installation, but not with the wheels of ROS: without it a bearing cannot have a parent frame, and a load in another
frame than the bearing's is refused.
"""

from collections.abc import Sequence

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from bearing_sim.inputs.static_transforms import StaticTransforms, Transform
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import message_type, typestore
from bearing_sim.ros.messages import message_class
from bearing_sim.ros.parameters import BearingSettings, SettingsError
from bearing_sim.ros.qos import profiles, publisher, subscription

_TOPIC, _TYPE = "/tf_static", "tf2_msgs/msg/TFMessage"
_LACKS = "transforms between frames need the package tf2_msgs, which is not installed (ros-DISTRO-tf2-msgs)"


def _qos(depth: int) -> QoSProfile:
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)


class TransformInterface:
    """The static transforms of a node, from its configure to its cleanup.

    Messages are serialised here: one message has the transforms of all bearings, because a late subscriber gets a publisher's last message only.

    Parameters
    ----------
    node : owner of publisher and subscription.
    bearings : settings of its bearings.

    Attributes
    ----------
    transforms : StaticTransforms
        Those of the node's bearings and of other nodes.

    Raises
    ------
    SettingsError
        A bearing has a parent frame, but tf2_msgs is not installed, or two bearings give one frame a parent.
    """

    def __init__(self, node: Node, bearings: Sequence[BearingSettings]):
        self._node, self._publisher, self._subscription = node, None, None
        own = [transform for settings in bearings if (transform := settings.transform) is not None]
        try:
            kind = message_class(_TYPE)
        except ModuleNotFoundError:
            kind = None
        if errors := _errors(own, kind is not None):
            raise SettingsError(errors)
        self.transforms = StaticTransforms("" if kind is not None else _LACKS)
        self.transforms.receive(own)
        if kind is None:
            return
        name = node.resolve_topic_name(_TOPIC)
        chosen = profiles(node.parameters, [subscription(name, _qos(100)), *([publisher(name, _qos(1))] if own else [])])
        self._subscription = node.create_subscription(kind, _TOPIC, self._receive, chosen[name, "subscription"], raw=True)
        if own:
            self._publisher = node.create_publisher(kind, _TOPIC, chosen[name, "publisher"])
            self._publisher.publish(message_type(_TYPE).serialize(topics.transforms(node.now_ns(), own)))
            for parent, child, *_ in own:
                node.get_logger().info(f"static transform from {child!r} to {parent!r} on {_TOPIC}")

    def destroy(self) -> None:
        """Destroy publisher and subscription."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)

    def _receive(self, cdr: bytes) -> None:
        try:
            received = typestore().deserialize_cdr(cdr, _TYPE).transforms
            refused = self.transforms.receive(map(_transform, received))
        except Exception as error:  # its type depends on what is wrong with the bytes
            refused = [f"{len(cdr)} bytes are not a {_TYPE}: {error}"]
        for text in refused:
            self._node.get_logger().warning(f"{_TOPIC}: {text}; it is ignored")


def _transform(stamped) -> Transform:
    """Return the transform of a geometry_msgs/TransformStamped."""
    position, orientation = stamped.transform.translation, stamped.transform.rotation
    return Transform(
        stamped.header.frame_id,
        stamped.child_frame_id,
        (position.x, position.y, position.z),
        (orientation.x, orientation.y, orientation.z, orientation.w),
    )


def _errors(own: Sequence[Transform], is_installed: bool) -> list[str]:
    """Return why transforms cannot be published, one text for each reason."""
    if own and not is_installed:
        return [f"parent_frame = {own[0].parent!r}: {_LACKS}"]
    children = [transform.child for transform in own]
    looped = [transform for transform in own if transform.parent.removeprefix("/") == transform.child.removeprefix("/")]
    return [f"parent_frame = {transform.parent!r}: the bearing's own frame; no frame is its own parent" for transform in looped] + [
        f"frame_id = {child!r}: {children.count(child)} bearings have this frame and a parent_frame; give each its own, NAME.frame_id"
        for child in dict.fromkeys(children)
        if children.count(child) > 1
    ]
