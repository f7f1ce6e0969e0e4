# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The metadata of a rosbag2 bag, version 9: of one file, inside it, and of a folder of files, beside them."""

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import yaml

_FOREVER = {"sec": 9223372036, "nsec": 854775807}
QOS = [
    {
        "history": "keep_last",
        "depth": 10,
        "reliability": "reliable",  # offered reliable, a played-back topic suits best-effort subscribers too
        "durability": "volatile",
        "deadline": _FOREVER,
        "lifespan": _FOREVER,
        "liveliness": "automatic",
        "liveliness_lease_duration": _FOREVER,
        "avoid_ros_namespace_conventions": False,
    }
]
"""Quality of service that recorded topics offer."""


class Part(NamedTuple):
    """One file of a bag: its name, first and last log time [ns since the epoch] and number of messages."""

    name: str
    start: int
    end: int
    messages: int


class TopicCount(NamedTuple):
    """One topic of a bag and how many messages it has."""

    name: str
    ros_type: str
    type_hash: str
    messages: int


def part_metadata(part: Part, topics: Iterable[TopicCount], custom_data: Mapping[str, str]) -> str:
    """Return the YAML that a file of a bag holds about itself."""
    return bag_metadata([part], [topics], custom_data)


def bag_metadata(parts: Sequence[Part], topics: Sequence[Iterable[TopicCount]], custom_data: Mapping[str, str]) -> str:
    """Return the YAML of a bag.

    Parameters
    ----------
    parts : the files, in order.
    topics : the topics of each of them.
    custom_data : shown by ``ros2 bag info``.
    """
    together: dict[str, TopicCount] = {}
    for counts in topics:
        for count in counts:
            before = together.get(count.name)
            together[count.name] = count if before is None else count._replace(messages=before.messages + count.messages)
    filled = [part for part in parts if part.messages] or list(parts[:1])
    whole = Part("", min(part.start for part in filled), max(part.end for part in filled), sum(part.messages for part in parts))
    bag = {
        "version": 9,
        "storage_identifier": "mcap",
        **_times(whole),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": count.name,
                    "type": count.ros_type,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": QOS,
                    "type_description_hash": count.type_hash,
                },
                "message_count": count.messages,
            }
            for count in together.values()
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [part.name for part in parts],
        "files": [{"path": part.name, **_times(part)} for part in parts],
        "custom_data": dict(custom_data),
        "ros_distro": "jazzy",
    }
    return to_yaml({"rosbag2_bagfile_information": bag})


def write_bag_metadata(folder: Path, text: str) -> None:
    """Write ``metadata.yaml`` into a bag's folder, at once: there is always a whole one."""
    draft = folder / "metadata.yaml.active"
    draft.write_text(text)
    os.replace(draft, folder / "metadata.yaml")


def _times(part: Part) -> dict:
    return {
        "duration": {"nanoseconds": part.end - part.start},
        "starting_time": {"nanoseconds_since_epoch": part.start},
        "message_count": part.messages,
    }


class _PlainDumper(yaml.SafeDumper):
    """SafeDumper without anchors, which not every reader of bag metadata follows."""

    def ignore_aliases(self, data):
        return True


def to_yaml(tree) -> str:
    """Return plain YAML without anchors, in the order given."""
    return yaml.dump(tree, Dumper=_PlainDumper, sort_keys=False)


QOS_TEXT = to_yaml(QOS)
"""The same as the metadata of a channel have it."""
