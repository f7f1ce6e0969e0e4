# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""ROS 2 message types as a recording needs them: definition, hash and serialiser, without a ROS installation."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype

from bearing_sim.messages import topics
from bearing_sim.messages.cdr_layout import typestore


class MessageType(NamedTuple):
    """Definition, hash and serialiser of one ROS type."""

    definition: str  # ros2msg text
    hash: str  # RIHS01
    serialize: Callable[[dict], bytes]  # nested dict -> CDR


@cache
def message_type(ros_type: str) -> MessageType:
    """Return definition, hash and serialiser of a ROS type such as ``"std_msgs/msg/Float64"``.

    Raises
    ------
    KeyError
        The type is not among ROS 2 Jazzy's standard messages.
    """
    store, fill = typestore(), _filler(ros_type)
    definition, _ = store.generate_msgdef(ros_type, ros_version=2)
    return MessageType(definition, store.hash_rihs01(ros_type), lambda message: bytes(store.serialize_cdr(fill(message), ros_type)))


def load_message_types() -> None:
    """Load the types of all topics of a recording, so that the first message does not wait a fraction of a second for them."""
    for topic in (*topics.INPUTS.values(), *topics.MEASUREMENTS.values(), *topics.RECORDED.values(), *topics.OUTPUTS.values()):
        message_type(topic.ros_type)
    message_type(topics.DIAGNOSTICS[1])


@cache
def _filler(ros_type: str) -> Callable[[dict], object]:
    store = typestore()
    message_class = store.types[ros_type]
    fields = [(name, _field_filler(*kind)) for name, kind in store.fielddefs[ros_type][1]]

    def fill(message: dict) -> object:
        return message_class(**{name: convert(message[name]) for name, convert in fields})

    return fill


def _field_filler(node: Nodetype, detail) -> Callable:
    if node == Nodetype.NAME:
        return _filler(detail)
    if node == Nodetype.BASE:
        return (lambda value: value[0]) if detail[0] == "byte" else (lambda value: value)
    (item_node, item_detail), _ = detail
    if item_node == Nodetype.NAME:
        fill = _filler(item_detail)
        return lambda values: [fill(value) for value in values]
    return list if item_detail[0] == "string" else (lambda values: np.asarray(values, item_detail[0]))
