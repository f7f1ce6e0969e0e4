# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read bags of ROS 1 (``*.bag``) from their beginning to their end, also those without an index, cut short or damaged.

By the specification of the format, version 2.0 (http://wiki.ros.org/Bags/Format/2.0): a record is a header of named fields and data.
Messages stand in chunks, which may be compressed; before the first message of a connection stands what it is.
"""

import bz2
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

import lz4.frame

from bearing_sim.files.limits import RECORDING_EXPANSION, RECORDING_RECORD, RECORDING_TEXTS, FileError
from bearing_sim.files.reading import open_regular
from bearing_sim.recording.bag import FREE_EXPANSION, RecordingError

_MAGIC = b"#ROSBAG V2.0\n"
_LENGTH = struct.Struct("<I")
_TIME = struct.Struct("<II")
_MESSAGE, _BAG, _CHUNK, _CONNECTION = 2, 3, 5, 7


class Connection(NamedTuple):
    """Of messages: its number, topic, type as ROS 2 names it, and the definition of the type."""

    number: int
    topic: str
    ros_type: str
    definition: bytes


class _Damaged(ValueError):
    """Bytes that are not the record that they should be."""


class Ros1Bag:
    """The connections and messages of a bag of ROS 1.

    Iterating yields each `Connection` before its messages, and messages as number of the connection, time [ns since the epoch] and data.

    Parameters
    ----------
    path : the file.

    Attributes
    ----------
    ends : after reading: why it ended early, or ``""``.

    Raises
    ------
    RecordingError
        It is no regular file, does not begin as such a bag, is encrypted, or unpacks to more than the limits allow.
    """

    def __init__(self, path: Path):
        self._path, self.ends = path, ""
        with self._opened() as stream:
            self._size = path.stat().st_size
            if stream.read(len(_MAGIC)) != _MAGIC:
                raise RecordingError(f"{path}: not a bag of ROS 1 in version 2.0 ({self._size} bytes)")

    def __iter__(self) -> Iterator[Connection | tuple[int, int, bytes]]:
        self.ends, known, texts, unpacked = "", set(), 0, 0
        with self._opened() as stream:
            stream.seek(len(_MAGIC))
            try:
                for fields, data in self._records(stream):
                    kind = fields.get(b"op", b"")
                    inner = [(fields, data)]
                    if kind == bytes([_BAG]) and fields.get(b"encryptor"):
                        raise RecordingError(f"{self._path}: an encrypted bag; expected one that is not")
                    if kind == bytes([_CHUNK]):
                        unpacked += _number(fields, b"size")
                        if unpacked > FREE_EXPANSION + RECORDING_EXPANSION.value * self._size:
                            raise RecordingError(f"{self._path}: its chunks unpack to {RECORDING_EXPANSION.refusal()}")
                        inner = _split(_unpacked(fields, data))
                    for item in inner:
                        found = _item(*item)
                        if isinstance(found, Connection):
                            if found.number in known:
                                continue
                            known.add(found.number)
                            texts += len(item[1])
                            if texts > RECORDING_TEXTS.value:
                                raise RecordingError(f"{self._path}: it has {RECORDING_TEXTS.refusal(texts)}")
                        if found is not None:
                            yield found
            except (_Damaged, struct.error, UnicodeDecodeError) as error:
                self.ends = str(error)

    def _opened(self) -> BinaryIO:
        try:
            return open_regular(self._path)
        except FileError as error:
            raise RecordingError(f"{error}; expected a bag of ROS 1") from None

    def _records(self, stream: BinaryIO) -> Iterator[tuple[dict[bytes, bytes], bytes]]:
        """Yield fields and data of the records of the file."""
        while head := stream.read(_LENGTH.size):
            fields = _fields(self._part(stream, head))
            yield fields, self._part(stream, stream.read(_LENGTH.size))

    def _part(self, stream: BinaryIO, length: bytes) -> bytes:
        """Return the next bytes, which are as many as ``length`` says."""
        if len(length) < _LENGTH.size:
            raise _Damaged("it ends within a record")
        (count,) = _LENGTH.unpack(length)
        if count > self._size - stream.tell():
            raise _Damaged("it ends within a record")
        if count > RECORDING_RECORD.value:
            raise RecordingError(f"{self._path}: a record has {RECORDING_RECORD.refusal(count)}")
        return stream.read(count)


def _fields(header: bytes) -> dict[bytes, bytes]:
    found, at = {}, 0
    while at < len(header):
        (length,) = _LENGTH.unpack_from(header, at)
        name, sign, value = header[at + _LENGTH.size : at + _LENGTH.size + length].partition(b"=")
        at += _LENGTH.size + length
        if not sign or at > len(header):
            raise _Damaged("a header that is not made of fields")
        found[name] = value
    return found


def _number(fields: dict[bytes, bytes], name: bytes) -> int:
    value = fields.get(name, b"")
    if len(value) != _LENGTH.size:
        raise _Damaged(f"a record without the field {name.decode()!r}")
    return _LENGTH.unpack(value)[0]


def _unpacked(fields: dict[bytes, bytes], data: bytes) -> bytes:
    """Return the records of a chunk; never more bytes than it says and the limit allows."""
    size, compression = _number(fields, b"size"), fields.get(b"compression", b"none")
    if size > RECORDING_RECORD.value:
        raise _Damaged(f"a chunk unpacks to {RECORDING_RECORD.refusal(size)}")
    try:
        if compression == b"bz2":
            data = bz2.BZ2Decompressor().decompress(data, size + 1)
        elif compression == b"lz4":
            data = lz4.frame.LZ4FrameDecompressor().decompress(data, size + 1)
        elif compression != b"none":
            raise _Damaged(f"a chunk is compressed by {compression[:40]!r}; expected bz2, lz4 or none")
    except (OSError, EOFError, RuntimeError) as error:
        raise _Damaged(f"a chunk cannot be unpacked: {error}") from None
    if len(data) != size:
        raise _Damaged("a chunk is not as long as it says")
    return data


def _split(data: bytes) -> Iterator[tuple[dict[bytes, bytes], bytes]]:
    """Yield fields and data of the records of a chunk."""
    at = 0
    while at < len(data):
        parts = []
        for _ in range(2):
            (length,) = _LENGTH.unpack_from(data, at)
            begin = at + _LENGTH.size
            at = begin + length
            if at > len(data):
                raise _Damaged("a chunk ends within a record")
            parts.append(data[begin:at])
        yield _fields(parts[0]), parts[1]


def _item(fields: dict[bytes, bytes], data: bytes) -> Connection | tuple[int, int, bytes] | None:
    """Return the connection or the message of a record; None for another."""
    kind = fields.get(b"op", b"")
    if kind == bytes([_CONNECTION]):
        own = _fields(data)
        package, _, name = own.get(b"type", b"").decode().rpartition("/")
        topic = fields.get(b"topic", b"").decode()
        return Connection(_number(fields, b"conn"), topic, f"{package}/msg/{name}" if package else name, own.get(b"message_definition", b""))
    if kind != bytes([_MESSAGE]):
        return None
    if len(fields.get(b"time", b"")) != _TIME.size:
        raise _Damaged("a message without a time")
    seconds, nanoseconds = _TIME.unpack(fields[b"time"])
    return _number(fields, b"conn"), seconds * 1_000_000_000 + nanoseconds, data
