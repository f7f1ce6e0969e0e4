# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The files of a recording: limits that split it, the folder of a bag, and rosbag2's metadata (version 9) inside and beside the files."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

import yaml

from bearing_sim.files.limits import BAG_METADATA, FileError
from bearing_sim.files.outputs import replaced
from bearing_sim.files.reading import read_text, why_not_readable
from bearing_sim.files.tally import Tally
from bearing_sim.files.yaml_text import values_of

ACTIVE = ".active"
"""Suffix of the name of an unfinished file."""

_FOREVER = {"sec": 9223372036, "nsec": 854775807}
QOS = [
    {
        "history": "keep_last",
        "depth": 10,
        "reliability": "reliable",  # so that a played-back topic also suits best-effort subscribers
        "durability": "volatile",
        "deadline": _FOREVER,
        "lifespan": _FOREVER,
        "liveliness": "automatic",
        "liveliness_lease_duration": _FOREVER,
        "avoid_ros_namespace_conventions": False,
    }
]
"""Quality of service that recorded topics offer."""


class RecordingError(FileError):
    """A recording that cannot be used: the message says what is wrong, where, what was expected and what to do."""


class PartialRecording(RecordingError):
    """A recording of which only a part could be read, raised after all of that part: nobody takes it for the whole.

    Attributes
    ----------
    tally : what was there, what was used, and what was not and why.
    """

    def __init__(self, where: str, tally: Tally):
        self.tally = tally
        super().__init__(f"{tally.text}; allow_partial=True takes the part for what it is", where)


class Limits(NamedTuple):
    """When a recording begins its next file, and when it stops.

    Attributes
    ----------
    part_size : length of a file [byte] beyond which the next one begins.
    part_duration : time between its first and last message [s] beyond which the next one begins.
    keep_free : free space to leave on the disk [byte]; below it the recording stops.
    """

    part_size: float = math.inf
    part_duration: float = math.inf
    keep_free: float = 100e6


UNLIMITED = Limits()
"""A single file."""


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


def bag_metadata(parts: Sequence[Part], topics: Sequence[Iterable[TopicCount]], custom_data: Mapping[str, str]) -> str:
    """Return the YAML of a bag, or of one of its files.

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
    """Write ``metadata.yaml`` into a bag's folder; a reader never sees half of it."""
    with replaced(folder / "metadata.yaml") as draft:
        draft.write_text(text)


def _times(part: Part) -> dict:
    return {
        "duration": {"nanoseconds": part.end - part.start},
        "starting_time": {"nanoseconds_since_epoch": part.start},
        "message_count": part.messages,
    }


class _PlainDumper(yaml.SafeDumper):
    """SafeDumper without anchors, which some readers of bag metadata do not follow."""

    def ignore_aliases(self, data):
        return True


def to_yaml(tree) -> str:
    """Return plain YAML without anchors, in the order given."""
    return yaml.dump(tree, Dumper=_PlainDumper, sort_keys=False)


LATEST = 2**62
"""Time after all those of recordings [ns since the epoch], in the year 2116; with later ones, differences would not fit 64 bits."""
FREE_EXPANSION = 64_000_000
"""Bytes to which the compressed parts of a recording may unpack however small it is."""
PACKED_SUFFIXES = (".zstd", ".zst", ".lz4")
"""Of files that are compressed as a whole."""
_RENAMED_MEANWHILE = 5  # times that a folder is listed again while a recorder completes its parts
QOS_TEXT = to_yaml(QOS)
"""The same as YAML, for the metadata of a channel."""


def mcap_files(path: str | Path) -> list[Path]:
    """Return the MCAP files of a recording in order.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), or the folder of a bag of MCAP files.

    Raises
    ------
    RecordingError
        There is no such recording, or it is in another format.
    """
    files = recording_files(path)
    if Path(path).is_file():
        return files
    if sqlite := [file.name for file in files if file.suffix == ".db3"]:
        raise RecordingError(f"{path}: an SQLite bag ({', '.join(sqlite)}); expected MCAP. `view`, `info` and `replay` read it as it is")
    unusable = [file.name for file in files if ".mcap" not in file.name or file.suffix in PACKED_SUFFIXES]
    if unusable or not files:
        raise RecordingError(f"{path}: expected uncompressed .mcap files, {'cannot use ' + ', '.join(unusable) if unusable else 'found none'}")
    return files


def recording_files(path: str | Path) -> list[Path]:
    """Return the files of a recording in whatever format, in order: the file itself, or those of a bag's folder.

    Raises
    ------
    RecordingError
        There is no such recording, files that its metadata names are missing, or it has files of several formats.
    """
    path = Path(path)
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise RecordingError(f"{path}: {why_not_readable(path)}; expected an MCAP file or the folder of a bag")
    files = _files_in(path)
    for _ in range(_RENAMED_MEANWHILE):
        if all(file.exists() for file in files if file.name.endswith(ACTIVE)):
            break
        files = _files_in(path)  # a recorder completed one, which then has another name
    if missing := [file.name for file in files if not file.is_file()]:
        raise RecordingError(f"{path}: {_what_is_missing(path, files, missing)}")
    other = [file.name for file in files if ".db3" not in file.name]
    if other and len(other) < len(files):
        raise RecordingError(f"{path}: it has both SQLite and other files ({', '.join(other[:3])}); expected one kind")
    return files


def _what_is_missing(path: Path, files: Sequence[Path], missing: Sequence[str]) -> str:
    """Return which files of a bag's folder are missing, which are there instead, and what to do."""
    others = sorted(file for file in path.iterdir() if file.is_file() and file.name != "metadata.yaml" and file not in files)
    there = [file for file in files if file.is_file()] + others
    listed = f"metadata.yaml names {', '.join(missing)}, which {'is' if len(missing) == 1 else 'are'} not there"
    if not there:
        return f"{listed}, and there is no other file; the folder has lost its recording"
    found = f"there {'is' if len(there) == 1 else 'are'} {', '.join(file.name for file in there)}"
    return f"{listed}; {found}. Restore the name, or give the file itself: {there[0]}"


def listed_files(path: Path) -> list[Path] | None:
    """Return the files that the metadata of a bag's folder lists, which are in that folder; None if it has none."""
    metadata = folder_metadata(path)
    if metadata is None:
        return None
    names = metadata.get("relative_file_paths")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise RecordingError(f"{path / 'metadata.yaml'}: not the metadata of a bag; expected relative_file_paths, a list of names")
    # Of a path only the name counts: earlier versions of rosbag2 wrote the folder before it, and a stranger may name any file of the machine.
    return [path / (PurePosixPath(name.replace("\0", "")).name or "unnamed") for name in names]


def folder_metadata(path: Path) -> dict | None:
    """Return what the metadata of a bag's folder says; None if it has none.

    Raises
    ------
    RecordingError
        There is a ``metadata.yaml``, but it is not the metadata of a bag.
    """
    index = path / "metadata.yaml"
    if not index.exists():
        return None
    try:
        found = values_of(read_text(index, BAG_METADATA))
    except FileError as error:
        text = str(error)
        raise RecordingError(text if text.startswith(str(index)) else f"{index}: not the metadata of a bag: {text}") from None
    bag = found.get("rosbag2_bagfile_information") if isinstance(found, dict) else None
    if not isinstance(bag, dict):
        raise RecordingError(f"{index}: not the metadata of a bag; expected the block rosbag2_bagfile_information")
    return bag


def _files_in(path: Path) -> list[Path]:
    """Return the files of a bag's folder in order, those that its metadata lists first; without metadata, of its formats only one."""
    files, named = sorted(filter(Path.is_file, path.iterdir()), key=_by_number), listed_files(path)
    if named is not None:
        # A killed recorder leaves files that are unfinished or not listed yet; they come last.
        files = [file for file in files if file.name.endswith((".mcap", f".mcap{ACTIVE}")) and file not in named]
        return named + [file for file in files if file.name.endswith(ACTIVE) or file.stem.startswith(f"{path.name}_")]
    sqlite = [file for file in files if plain_name(file).endswith(".db3")]
    plain = [file for file in sqlite if file.suffix == ".db3"]
    return plain or sqlite or [file for file in files if plain_name(file).endswith((".mcap", f".mcap{ACTIVE}"))]


def plain_name(file: Path) -> str:
    """Return the name that a file has when it is not compressed."""
    return file.stem if file.suffix in PACKED_SUFFIXES else file.name


def _by_number(file: Path) -> tuple:
    """Return the key by which ``run_10.mcap`` comes after ``run_9.mcap``."""
    return tuple(int(part) if k % 2 else part for k, part in enumerate(re.split(r"(\d+)", file.name)))
