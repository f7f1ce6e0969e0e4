# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read rosbag2 recordings in SQLite (``*.db3``), also those that are damaged or that a stranger wrote.

A database may be more than its rows: views and generated columns compute what they return, and a tree whose pages point to each other
returns rows without end.  So only plain tables are read, without sorting, and no more than the file can contain.  A text or message that
is longer than a limit is never made.
"""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from bearing_sim.files.limits import RECORDING_RECORD, RECORDING_TEXTS
from bearing_sim.recording.bag import RecordingError

_TABLES = ("topics", "messages", "message_definitions")
_STEPS = 100_000  # instructions of SQLite between two looks at how many there were
_STEPS_PER_BYTE = 50  # reading a row takes some ten instructions, and a row some twenty bytes
_LEAST_ROW = 4  # [byte] of a row besides its data


class SqliteTopic(NamedTuple):
    """A topic: number in the database, name, message type, serialisation, and the definition of the type with its encoding."""

    number: int
    name: str
    ros_type: str
    serialization: str
    encoding: str
    definition: bytes


class SqliteBag:
    """The topics and messages of one database of a rosbag2 recording.

    Parameters
    ----------
    path : the file.

    Attributes
    ----------
    topics : as the database lists them.
    left_out : after reading: rows that are no messages.
    ends : after reading: why it ended early, or ``""``.

    Raises
    ------
    RecordingError
        It is no such database, or its topics cannot be read.
    """

    def __init__(self, path: Path):
        self._path, self._size = path, path.stat().st_size
        self.left_out, self.ends = 0, ""
        try:
            with closing(self._connected()) as database:
                self.topics = self._topics(database)
        except (sqlite3.Error, UnicodeDecodeError, OverflowError) as error:
            raise RecordingError(f"{path}: cannot be read as a bag: {error}") from None

    def __iter__(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield number of the topic, time [ns since the epoch] and data of the messages, as they stand in the file."""
        self.left_out, self.ends, seen = 0, "", 0
        known = {topic.number for topic in self.topics}
        with closing(self._connected()) as database:
            try:
                for number, time, data in database.execute("SELECT topic_id, timestamp, data FROM messages"):
                    seen += _LEAST_ROW + (len(data) if isinstance(data, bytes) else 0)
                    if seen > self._size:
                        self.ends = "it returns more than its file can contain"
                        return
                    if number in known and isinstance(time, int) and isinstance(data, bytes):
                        yield number, time, data
                    else:
                        self.left_out += 1
            except (sqlite3.Error, OverflowError) as error:
                self.ends = str(error)

    def _connected(self) -> sqlite3.Connection:
        """Return a connection that changes nothing and in which no definition in the file is executed."""
        address = f"file:{quote(str(self._path.absolute()))}?mode=ro&immutable=1"
        database = sqlite3.connect(address, uri=True)
        database.text_factory = bytes
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, min(RECORDING_RECORD.value, 2**30))
        steps = 0

        def is_too_long() -> bool:
            nonlocal steps
            steps += _STEPS
            return steps > 10 * _STEPS + _STEPS_PER_BYTE * self._size

        database.set_progress_handler(is_too_long, _STEPS)
        try:
            for setting in ("trusted_schema=OFF", "query_only=ON", "cell_size_check=ON", "mmap_size=0"):
                database.execute(f"PRAGMA {setting}")
            self._require_tables(database)
        except BaseException:
            database.close()
            raise
        return database

    def _require_tables(self, database: sqlite3.Connection) -> None:
        """Raise `RecordingError` unless the tables of a bag are there and contain what they return."""
        listing = "SELECT name, type, rootpage FROM sqlite_master WHERE name IN (?, ?, ?)"
        kinds = {name.decode(): kind == b"table" and bool(page) for name, kind, page in database.execute(listing, _TABLES)}
        if missing := [name for name in _TABLES[:2] if name not in kinds]:
            raise RecordingError(f"{self._path}: an SQLite database without the table {missing[0]!r}; expected a rosbag2 recording")
        for name, is_plain in kinds.items():
            columns = database.execute(f"PRAGMA table_xinfo({name})").fetchmany(1000)
            if not is_plain or any(column[-1] for column in columns):  # the last number is 0 for a column that is stored
                raise RecordingError(f"{self._path}: {name!r} computes what it returns; expected a plain table, as rosbag2 writes it")

    def _topics(self, database: sqlite3.Connection) -> list[SqliteTopic]:
        definitions, length, found = {}, 0, []
        tables = {name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type='table'")}
        if b"message_definitions" in tables:
            for row in database.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"):
                ros_type, encoding, text = map(_bytes, row)
                definitions[ros_type] = encoding.decode(), text
                length += sum(map(len, map(_bytes, row)))
                self._require_short(length)
        for number, *row in database.execute("SELECT id, name, type, serialization_format FROM topics"):
            name, ros_type, serialization = map(_bytes, row)
            length += len(name) + len(ros_type) + len(serialization)
            self._require_short(length)
            topic = SqliteTopic(number, name.decode(), ros_type.decode(), serialization.decode(), *definitions.get(ros_type, ("", b"")))
            found.append(topic)
        return found

    def _require_short(self, length: int) -> None:
        if length > min(RECORDING_TEXTS.value, 2 * self._size):
            raise RecordingError(f"{self._path}: it has {RECORDING_TEXTS.refusal(length)}")


def _bytes(value) -> bytes:
    """Return a text of a database; whatever else stands there as text."""
    return value if isinstance(value, bytes) else str(value)[:100].encode()
