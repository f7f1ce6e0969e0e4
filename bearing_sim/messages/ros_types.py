# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""ROS 2 message types as a recording needs them: definition, hash and CDR, by the ROS-free definitions of the rosbags library."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from bearing_sim import topics

_ARRAY = "std_msgs/msg/Float64MultiArray"


class MessageType(NamedTuple):
    """What a recording needs to know of one ROS type."""

    definition: str  # ros2msg text
    hash: str  # RIHS01
    serialize: Callable[[dict], bytes]  # nested dict -> CDR


@cache
def _typestore():
    return get_typestore(Stores.ROS2_JAZZY)


@cache
def message_type(ros_type: str) -> MessageType:
    """Return definition, hash and serialiser of a ROS type such as ``"std_msgs/msg/Float64"``.

    Raises
    ------
    KeyError
        The type is not among ROS 2 Jazzy's standard messages.
    """
    store = _typestore()
    fill = _filler(ros_type)
    definition, _ = store.generate_msgdef(ros_type, ros_version=2)

    def serialize(message: dict) -> bytes:
        return bytes(store.serialize_cdr(fill(message), ros_type))

    return MessageType(definition, store.hash_rihs01(ros_type), _array_serializer(serialize) if ros_type == _ARRAY else serialize)


def load_message_types() -> None:
    """Make the types of all topics of a recording ready, which takes a part of a second, before the first message is to be written."""
    for topic in (*topics.INPUTS.values(), *topics.MEASUREMENTS.values(), *topics.RECORDED.values(), *topics.OUTPUTS.values()):
        message_type(topic.ros_type)
    message_type(topics.DIAGNOSTICS[1])


def _array_serializer(serialize: Callable[[dict], bytes]) -> Callable[[dict], bytes]:
    """Return a serialiser of arrays that keeps the bytes before the numbers: most of a sample are arrays of unchanging lay-out."""
    heads: dict[tuple, bytes] = {}

    def serialize_array(message: dict) -> bytes:
        layout, data = message["layout"], np.asarray(message["data"], "<f8")
        key = (layout["data_offset"], data.size, *[(dim["label"], dim["size"], dim["stride"]) for dim in layout["dim"]])
        if key not in heads:
            whole = serialize(message)
            heads[key] = whole[: len(whole) - data.nbytes]
        return heads[key] + data.tobytes()

    return serialize_array


@cache
def _filler(ros_type: str) -> Callable[[dict], object]:
    store = _typestore()
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
