# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Services that are looked at now and then, so that messages which come all the time cost less.

rclpy makes the set of all it waits for anew at every message.  A node has a dozen and a half of services, most of them rclpy's own, of
which one is called in a minute; leaving them out of most of these sets saves about half of what waiting costs.
"""

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node


class OfficeHours(CallbackGroup):
    """A callback group that an executor passes by while it is closed; open, it is the node's default group.

    Parameters
    ----------
    node : whose services so far come in.
    """

    def __init__(self, node: Node):
        super().__init__()
        self._group, self.is_open = node.default_callback_group, True
        for service in node.services:
            service.callback_group = self
            self.add_entity(service)

    def add_entity(self, entity) -> None:
        """Take an entity in, here and in the default group, which keeps callbacks from running beside each other."""
        super().add_entity(entity)
        self._group.add_entity(entity)

    def can_execute(self, entity) -> bool:
        """Return whether the entity's turn could be now."""
        return self.is_open and self._group.can_execute(entity)

    def beginning_execution(self, entity) -> bool:
        """Return whether the entity may begin; one that was ready when it closed still may."""
        return self._group.beginning_execution(entity)

    def ending_execution(self, entity) -> None:
        """Take notice of the end."""
        self._group.ending_execution(entity)
