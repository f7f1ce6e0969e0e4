# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages of recordings of any origin: MCAP files, also unfinished or damaged ones, and by the rosbags library SQLite and ROS 1 bags."""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from mcap.records import Channel, Schema
from mcap_ros2.decoder import DecoderFactory

from bearing_sim.messages.cdr import typestore
from bearing_sim.recording.bag import RecordingError, listed_files, mcap_files, require_listed
from bearing_sim.recording.mcap_format import Message
from bearing_sim.recording.mcap_reader import McapReader


class BagTopic(NamedTuple):
    """A topic of a recording.

    Attributes
    ----------
    name, ros_type : full topic name, and message type; ``""`` if the recording does not say.
    decode : ``decode(data)`` returns an object with the fields of the message as attributes; it may raise any exception for damaged data.
    """

    name: str
    ros_type: str
    decode: Callable[[bytes], object]


class BagReader:
    """The topics and messages of a recording.

    Iterating yields the messages (topic, log time [ns since the epoch], data) in file order, and each `BagTopic` before its messages, once for
    each file.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), an SQLite file (``*.db3``), a ROS 1 bag (``*.bag``), or a bag's folder.

    Attributes
    ----------
    is_foreign : whether it is no MCAP, so that the rosbags library reads it.
    unfinished : after reading: why a file ended early, or ``""``.

    Raises
    ------
    RecordingError
        There is no such recording, or it cannot be read.
    """

    def __init__(self, path: str | Path):
        self._path, self.unfinished = Path(path), ""
        self.is_foreign = self._is_foreign()
        self._files = [] if self.is_foreign else mcap_files(self._path)

    def __iter__(self) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        self.unfinished = ""
        if not self._files:
            yield from self._by_rosbags()
        for file in self._files:
            yield from self._mcap(file)

    def _is_foreign(self) -> bool:
        if self._path.is_file():
            return self._path.suffix in (".db3", ".bag")
        if not self._path.is_dir():
            return False
        listed = listed_files(self._path) or []
        if not any(".db3" in file.name for file in listed) and not any(self._path.glob("*.db3")):
            return False
        require_listed(self._path, listed)
        return True

    def _by_rosbags(self) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        from rosbags.highlevel import AnyReader, AnyReaderError

        try:
            with _named_as_folder(self._path) as path, AnyReader([path], default_typestore=typestore()) as bag:
                found = {each.id: BagTopic(each.topic, each.msgtype, partial(_deserialized, bag, each.msgtype)) for each in bag.connections}
                yield from found.values()
                for connection, log_ns, data in bag.messages() if found else ():
                    yield found[connection.id], log_ns, data
        except (AnyReaderError, OSError, sqlite3.Error) as error:
            raise RecordingError(f"{self._path}: cannot be read as a bag: {error}") from None

    def _mcap(self, file: Path) -> Iterator[BagTopic | tuple[BagTopic, int, bytes]]:
        schemas: dict[int, Schema] = {}
        found: dict[int, BagTopic] = {}
        reader = McapReader(file, stops_at_damage=True)
        for record in reader:
            if isinstance(record, Message):
                if record.channel_id in found:
                    yield found[record.channel_id], record.log_time, record.data
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in found:
                schema = schemas.get(record.schema_id, Schema(id=0, name="", encoding="", data=b""))
                described = record.topic, record.message_encoding, schema.name, schema.encoding, schema.data
                found[record.id] = BagTopic(record.topic, schema.name, partial(_decoded, *described))
                yield found[record.id]
        if not reader.is_finished:
            text = f"{file.name}: ends early ({reader.ends}); the messages before that are used"
            self.unfinished = "; ".join(filter(None, (self.unfinished, text)))


@contextmanager
def _named_as_folder(path: Path) -> Iterator[Path]:
    """Yield a path of a recording that the library takes for what it is: by its name, a folder that ends in ``.bag`` would be a ROS 1 file."""
    if path.suffix != ".bag" or not path.is_dir():
        yield path
        return
    with TemporaryDirectory() as folder:
        link = Path(folder) / "recording"
        link.symlink_to(path.absolute(), target_is_directory=True)
        yield link


def _deserialized(bag, ros_type: str, data: bytes) -> object:
    return bag.deserialize(data, ros_type)


def _decoded(topic: str, message_encoding: str, name: str, encoding: str, definition: bytes, data: bytes) -> object:
    return _decoder(topic, message_encoding, name, encoding, definition)(data)


@lru_cache(maxsize=256)
def _decoder(topic: str, message_encoding: str, name: str, encoding: str, definition: bytes) -> Callable[[bytes], object]:
    if message_encoding != "cdr":
        raise RecordingError(f"{topic} is encoded as {message_encoding!r}; expected cdr")
    decoder = DecoderFactory().decoder_for(message_encoding, Schema(id=1, name=name, encoding=encoding, data=definition))
    if decoder is not None:
        return decoder
    from rosbags.typesys import Stores, get_types_from_idl, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)  # one of its own, since types are added
    if name not in store.types:
        store.register({kind: fields for kind, fields in get_types_from_idl(definition.decode()).items() if kind not in store.types})
    return lambda data: store.deserialize_cdr(data, name)
