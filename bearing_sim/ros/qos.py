# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Quality of service of the node's topics, and the parameters that override it.

The parameters have the names of rclpy's ``QoSOverridingOptions``, such as ``qos_overrides./cage_slip.publisher.depth``.  They are declared here
because rclpy would declare them when a topic is made, too late to report all errors at once, and for good: the defaults depend on ``use_sim_time``.
"""

import copy
from collections.abc import Callable, Sequence
from typing import NamedTuple

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from bearing_sim.messages import topics
from bearing_sim.ros.parameters import QOS_OVERRIDES, Declaration, ParameterServer
from bearing_sim.scene.scene import Scene

STATE_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
SIM_TIME_OUTPUT_QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)  # one step of /clock may bring many outputs at once
# Like sensor data, so that any publisher matches, but deeper: a recording must not miss inputs when the machine stalls.
INPUT_QOS = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)
# With sim time, a lost message would make this run differ from the recording it follows.
LOSSLESS_QOS = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
LOSSY_QOS = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.BEST_EFFORT)

_DEEPEST = 2**31 - 1
# Deadlines, lifespans and liveliness are left out: nothing here would act on them.
_POLICIES = {
    "history": (HistoryPolicy, ("keep_last", "keep_all"), "which messages wait: the last ones, as many as depth says, or all"),
    "depth": (int, (), "how many messages wait where history is keep_last"),
    "reliability": (ReliabilityPolicy, ("reliable", "best_effort"), "whether lost messages are sent again"),
    "durability": (DurabilityPolicy, ("volatile", "transient_local"), "whether a subscription that comes later gets the last messages"),
}


class Entity(NamedTuple):
    """A publisher or a subscription of the node: the full name of its topic, its kind as in the names of parameters, and what it is by default."""

    topic: str
    kind: str
    default: QoSProfile


def publisher(topic: str, default: QoSProfile) -> Entity:
    """Return a publisher on a topic with this full name."""
    return Entity(topic, "publisher", default)


def subscription(topic: str, default: QoSProfile) -> Entity:
    """Return a subscription to a topic with this full name."""
    return Entity(topic, "subscription", default)


def entities_of_bearing(scene: Scene, full_name: Callable[[str], str], with_sim_time: bool) -> list[Entity]:
    """Return the publishers and subscriptions of a bearing; ``full_name(topic)`` returns the full name of one of its topics."""
    outputs = [*topics.outputs(scene), topics.RESIDUAL, *topics.estimated(scene)]
    inputs = [*topics.inputs(scene), *topics.MEASURED_CHANNELS, *([topics.VIBRATION.name] if scene.vibration.is_asked and not with_sim_time else [])]
    output, received = (SIM_TIME_OUTPUT_QOS, LOSSLESS_QOS) if with_sim_time else (STATE_QOS, INPUT_QOS)
    return [*(publisher(full_name(name), output) for name in outputs), *(subscription(full_name(name), received) for name in inputs)]


def profiles(parameters: ParameterServer, entities: Sequence[Entity]) -> dict[tuple[str, str], QoSProfile]:
    """Declare the parameters of publishers and subscriptions, and return the profile of each by its topic and kind.

    Raises
    ------
    SettingsError
        Listing every override that cannot be used.
    """
    values = parameters.declare_further([row for entity in entities for row in _rows(entity)])
    found = {}
    for entity in entities:
        profile = copy.copy(entity.default)
        for policy, (kind, _, _) in _POLICIES.items():
            value = values[_name(entity, policy)]
            setattr(profile, policy, value if kind is int else kind[value.upper()])
        found[entity.topic, entity.kind] = profile
    return found


def _name(entity: Entity, policy: str) -> str:
    return f"{QOS_OVERRIDES}.{entity.topic}.{entity.kind}.{policy}"


def _rows(entity: Entity) -> list[Declaration]:
    rows = []
    for policy, (kind, choices, meaning) in _POLICIES.items():
        value = getattr(entity.default, policy)
        default = max(value, 1) if kind is int else value.name.lower()  # a profile that keeps all may have a depth of 0
        low, high = (1, _DEEPEST) if kind is int else (-1, 1)
        rows.append(Declaration(_name(entity, policy), default, f"quality of service of the {entity.kind}: {meaning}", low, high, choices))
    return rows
