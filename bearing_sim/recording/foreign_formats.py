# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read rosbag2's SQLite (``*.db3``) and bags of ROS 1 (``*.bag``), also those that are damaged, cut short, or that a stranger wrote.

Both are generators of topics (`ForeignTopic`) and messages: number of the topic, time [ns since the epoch] and data, as they stand in the
file.  The number is None for a row that is no message.  A file that cannot be read to its end raises `EndsEarly` after its messages.

A database may be more than its rows: views and generated columns compute what they return, and a tree whose pages point to each other
returns rows without end.  So only plain tables are read, without sorting, and no more than the file can contain.  Bags of ROS 1 are read
from their beginning, because those that are cut short have no index; their format is version 2.0 (http://wiki.ros.org/Bags/Format/2.0):
a record is a header of named fields, and data; messages stand in chunks, which may be compressed.
"""

import bz2
import io
import math
import sqlite3
import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

import lz4.frame

from bearing_sim.files.limits import RECORDING_EXPANSION, RECORDING_RECORD, RECORDING_TEXTS, FileError
from bearing_sim.files.reading import open_regular
from bearing_sim.recording.bag import FREE_EXPANSION, RecordingError

_TABLES = ("topics", "messages", "message_definitions")
_STEPS = 100_000  # instructions of SQLite between two looks at how many there were
_STEPS_PER_BYTE = 50  # reading a row takes some ten instructions, and a row some twenty bytes
_LEAST_ROW = 4  # [byte] of a row besides its data
_SETTINGS = ("trusted_schema=OFF", "query_only=ON", "cell_size_check=ON", "mmap_size=0")
_MAGIC = b"#ROSBAG V2.0\n"
_LENGTH = struct.Struct("<I")
_TIME = struct.Struct("<II")
_MESSAGE, _BAG, _CHUNK, _CONNECTION = 2, 3, 5, 7


class ForeignTopic(NamedTuple):
    """A topic: number in the file, name, message type, serialisation, encoding and text of its type's definition; what a node of ours calls it."""

    number: int
    name: str
    ros_type: str
    serialization: str
    encoding: str
    definition: bytes
    own_name: str = ""


class EndsEarly(Exception):
    """The file cannot be read to its end; the message says why."""


Item = ForeignTopic | tuple[int | None, int, bytes]


def sqlite_items(path: Path) -> Iterator[Item]:
    """Yield topics and messages of a database of rosbag2.

    Raises
    ------
    RecordingError
        It is no such database, or its topics cannot be read.
    EndsEarly
        After its messages.
    """
    size, seen = path.stat().st_size, 0
    try:
        with closing(_connected(path, size)) as database:
            topics = _topics(path, size, database)
    except (sqlite3.Error, UnicodeDecodeError, OverflowError) as error:
        raise RecordingError(f"{path}: cannot be read as a bag: {error}") from None
    yield from topics
    known = {topic.number for topic in topics}
    with closing(_connected(path, size)) as database:
        try:
            for number, time, data in database.execute("SELECT topic_id, timestamp, data FROM messages"):
                seen += _LEAST_ROW + (len(data) if isinstance(data, bytes) else 0)
                if seen > size:
                    raise EndsEarly("it returns more than its file can contain")
                is_message = number in known and isinstance(time, int) and isinstance(data, bytes)
                yield (number, time, data) if is_message else (None, 0, b"")
        except (sqlite3.Error, OverflowError) as error:
            raise EndsEarly(str(error)) from None


def _connected(path: Path, size: int) -> sqlite3.Connection:
    """Return a connection that changes nothing, in which no definition in the file is executed, and whose tables contain what they return."""
    database = sqlite3.connect(f"file:{quote(str(path.absolute()))}?mode=ro&immutable=1", uri=True)
    database.text_factory = bytes
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(RECORDING_RECORD.value, 2**30))
    steps = 0

    def is_too_long() -> bool:
        nonlocal steps
        steps += _STEPS
        return steps > 10 * _STEPS + _STEPS_PER_BYTE * size

    database.set_progress_handler(is_too_long, _STEPS)
    try:
        for setting in _SETTINGS:
            database.execute(f"PRAGMA {setting}")
        listing = "SELECT name, type, rootpage FROM sqlite_master WHERE name IN (?, ?, ?)"
        kinds = {name.decode(): kind == b"table" and bool(page) for name, kind, page in database.execute(listing, _TABLES)}
        if missing := [name for name in _TABLES[:2] if name not in kinds]:
            raise RecordingError(f"{path}: an SQLite database without the table {missing[0]!r}; expected a rosbag2 recording")
        for name, is_plain in kinds.items():
            columns = database.execute(f"PRAGMA table_xinfo({name})").fetchmany(1000)
            if not is_plain or any(column[-1] for column in columns):  # the last number is 0 for a column that is stored
                raise RecordingError(f"{path}: {name!r} computes what it returns; expected a plain table, as rosbag2 writes it")
    except BaseException:
        database.close()
        raise
    return database


def _topics(path: Path, size: int, database: sqlite3.Connection) -> list[ForeignTopic]:
    length = 0

    def rows(query: str) -> Iterator[list]:
        """Yield rows of a number or nothing and texts; anything that is no text as one."""
        nonlocal length
        for number, *row in database.execute(query):
            texts = [value if isinstance(value, bytes) else str(value)[:100].encode() for value in row]
            length += sum(map(len, texts))
            if length > min(RECORDING_TEXTS.value, 2 * size):
                raise RecordingError(f"{path}: it has {RECORDING_TEXTS.refusal(length)}")
            yield [number, *texts]

    definitions = {}
    if database.execute("SELECT name FROM sqlite_master WHERE type='table' AND name='message_definitions'").fetchone():
        for _, ros_type, encoding, text in rows("SELECT NULL, topic_type, encoding, encoded_message_definition FROM message_definitions"):
            definitions[ros_type] = encoding.decode() or "ros2msg", text
    return [
        ForeignTopic(number, name.decode(), ros_type.decode(), serialization.decode(), *definitions.get(ros_type, ("ros2msg", b"")))
        for number, name, ros_type, serialization in rows("SELECT id, name, type, serialization_format FROM topics")
    ]


def ros1_items(path: Path) -> Iterator[Item]:
    """Yield topics and messages of a bag of ROS 1.

    Raises
    ------
    RecordingError
        It is no regular file, does not begin as such a bag, is encrypted, or unpacks to more than the limits allow.
    EndsEarly
        After its messages.
    """
    size, known, texts, unpacked = path.stat().st_size, set(), 0, 0
    try:
        stream = open_regular(path)
    except FileError as error:
        raise RecordingError(f"{error}; expected a bag of ROS 1") from None
    with stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            raise RecordingError(f"{path}: not a bag of ROS 1 in version 2.0 ({size} bytes)")
        try:
            for fields, data in _records(stream.read, lambda: size - stream.tell(), path):
                kind, inner = fields.get(b"op", b""), [(fields, data)]
                if kind == bytes([_BAG]) and fields.get(b"encryptor"):
                    raise RecordingError(f"{path}: an encrypted bag; expected one that is not")
                if kind == bytes([_CHUNK]):
                    unpacked += _number(fields, b"size")
                    if unpacked > FREE_EXPANSION + RECORDING_EXPANSION.value * size:
                        raise RecordingError(f"{path}: its chunks unpack to {RECORDING_EXPANSION.refusal()}")
                    chunk = io.BytesIO(_unpacked(fields, data))
                    inner = _records(chunk.read, lambda chunk=chunk: len(chunk.getbuffer()) - chunk.tell(), path)
                for item, content in inner:
                    found = _item(item, content)
                    if isinstance(found, ForeignTopic):
                        if found.number in known:
                            continue
                        known.add(found.number)
                        texts += len(content)
                        if texts > RECORDING_TEXTS.value:
                            raise RecordingError(f"{path}: it has {RECORDING_TEXTS.refusal(texts)}")
                    if found is not None:
                        yield found
        except (struct.error, UnicodeDecodeError) as error:
            raise EndsEarly(str(error)) from None


def _records(read: Callable[[int], bytes], left: Callable[[], int], path: Path) -> Iterator[tuple[dict[bytes, bytes], bytes]]:
    """Yield fields and data of the records of a file or a chunk; ``left`` returns how many bytes it still has."""
    while left():
        parts = []
        for _ in range(2):
            head = read(_LENGTH.size)
            count = _LENGTH.unpack(head)[0] if len(head) == _LENGTH.size else math.inf
            if count > left():
                raise EndsEarly("it ends within a record")
            if count > RECORDING_RECORD.value:
                raise RecordingError(f"{path}: a record has {RECORDING_RECORD.refusal(count)}")
            parts.append(read(count))
        yield _fields(parts[0]), parts[1]


def _fields(header: bytes) -> dict[bytes, bytes]:
    found, at = {}, 0
    while at < len(header):
        (length,) = _LENGTH.unpack_from(header, at)
        name, sign, value = header[at + _LENGTH.size : at + _LENGTH.size + length].partition(b"=")
        at += _LENGTH.size + length
        if not sign or at > len(header):
            raise EndsEarly("a header that is not made of fields")
        found[name] = value
    return found


def _number(fields: dict[bytes, bytes], name: bytes) -> int:
    value = fields.get(name, b"")
    if len(value) != _LENGTH.size:
        raise EndsEarly(f"a record without the field {name.decode()!r}")
    return _LENGTH.unpack(value)[0]


def _unpacked(fields: dict[bytes, bytes], data: bytes) -> bytes:
    """Return the records of a chunk; never more bytes than it says and the limit allows."""
    size, compression = _number(fields, b"size"), fields.get(b"compression", b"none")
    if size > RECORDING_RECORD.value:
        raise EndsEarly(f"a chunk unpacks to {RECORDING_RECORD.refusal(size)}")
    unpackers = {b"bz2": bz2.BZ2Decompressor, b"lz4": lz4.frame.LZ4FrameDecompressor}
    if compression not in (b"none", *unpackers):
        raise EndsEarly(f"a chunk is compressed by {compression[:40]!r}; expected bz2, lz4 or none")
    try:
        data = data if compression == b"none" else unpackers[compression]().decompress(data, size + 1)
    except (OSError, EOFError, RuntimeError) as error:
        raise EndsEarly(f"a chunk cannot be unpacked: {error}") from None
    if len(data) != size:
        raise EndsEarly("a chunk is not as long as it says")
    return data


def _item(fields: dict[bytes, bytes], data: bytes) -> Item | None:
    """Return the topic or the message of a record; None for another."""
    kind = fields.get(b"op", b"")
    if kind == bytes([_CONNECTION]):
        own = _fields(data)
        topic, ros_type = fields.get(b"topic", b"").decode(), own.get(b"type", b"").decode()
        return ForeignTopic(_number(fields, b"conn"), topic, ros_type, "ros1", "ros1msg", own.get(b"message_definition", b""))
    if kind != bytes([_MESSAGE]):
        return None
    if len(fields.get(b"time", b"")) != _TIME.size:
        raise EndsEarly("a message without a time")
    seconds, nanoseconds = _TIME.unpack(fields[b"time"])
    return _number(fields, b"conn"), seconds * 1_000_000_000 + nanoseconds, data
