# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Hostile recordings and bags, for ``hostile_files.py``: MCAP, SQLite, bags of ROS 1, folders of bags, and recordings of runs."""

import bz2
import os
import sqlite3
import struct
import sys
import zlib
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import lz4.frame
import zstandard
from hostile_files import Case
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, ChunkIndex, DataEnd, Footer, Header, Metadata, MetadataIndex, Schema, Statistics

from bearing_sim.recording.mcap_format import CHECKSUM_RECORD, MAGIC, RECORD, Message, checksum_record, packed, packed_message

sys.path.insert(0, str(Path(__file__).parents[1]))

from recordings import JOINTS, SECOND, WRENCH, joint_state, wrench  # noqa: E402
from synthetic_run import synthetic_block  # noqa: E402

from bearing_sim.messages.cdr import message_type  # noqa: E402
from bearing_sim.recording.writer import McapSink  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402

T0 = 1_700_000_000 * SECOND
SPLIT = "=" * 80 + "\n"
NUMBER = ("std_msgs/msg/Float64", "ros2msg", b"float64 data\n")
_DATA = b"\0\1\0\0" + struct.pack("<d", 1.0)
_RLE_BLOCK = 131_072  # bytes of one zstd block that repeats one byte

VIEW = ("view", "log.mcap", "--no-open", "-o", "log.rrd")
REPLAY = ("replay", "log.mcap", "--scene", "deng2017_table1", "--set", "level=steady", "--out", "run.mcap")


def zeros_by_zstd(length: int, states_length: bool) -> bytes:
    """Return a zstd frame of zeros by the specification (RFC 8878): four bytes for each 128 KiB."""
    head = struct.pack("<IBB", 0xFD2FB528, 0xC0 if states_length else 0, 0x70) + (struct.pack("<Q", length) if states_length else b"")
    count = length // _RLE_BLOCK
    blocks = [struct.pack("<I", _RLE_BLOCK << 3 | 1 << 1 | int(k == count - 1))[:3] + b"\0" for k in (0, count - 1)]
    return head + blocks[0] * (count - 1) + blocks[1]


def chunk(data: bytes, compression: str = "", size: int | None = None, crc: int = 0) -> bytes:
    """Return the record of a chunk that says that it unpacks to a size."""
    return packed(Chunk(compression, data, T0, T0, crc, len(data) if size is None else size))


def described(topic: str = "/x", kind: tuple[str, str, bytes] = NUMBER, number: int = 1, encoding: str = "cdr") -> bytes:
    """Return schema and channel of a topic."""
    name, syntax, text = kind
    return packed(Schema(number, text, syntax, name)) + packed(Channel(number, topic, encoding, {}, number))


def message(data: bytes = _DATA, number: int = 1, time: int = T0) -> bytes:
    """Return the record of a message."""
    return packed_message(Message(number, 0, time, time, data))


def sound(count: int = 30) -> bytes:
    """Return the records of a log that can be replayed, on channels 11 and 12."""
    found = b""
    for number, topic, kind in ((11, "/shaft_speed", JOINTS), (12, "/radial_load", WRENCH)):
        found += described(topic, (kind, "ros2msg", message_type(kind).definition.encode()), number)
    for k in range(count):
        time = T0 + k * SECOND // 10
        found += message(message_type(JOINTS).serialize(joint_state(time, 400.0)), 11, time)
        found += message(message_type(WRENCH).serialize(wrench(time, 800.0)), 12, time)
    return found


def mcap(*records: bytes, ends: bool = True) -> bytes:
    """Return a file of these records."""
    end = packed(DataEnd(0)) + packed(Footer(0, 0, 0)) + MAGIC if ends else b""
    return MAGIC + packed(Header("ros2", "stranger")) + b"".join(records) + end


def typed(text: str | bytes, data: bytes = b"", count: int = 1, syntax: str = "ros2msg") -> bytes:
    """Return a file with messages of a type that this text defines."""
    kind = ("drive_msgs/msg/State", syntax, text if isinstance(text, bytes) else text.encode())
    return mcap(described(kind=kind), message(b"\0\1\0\0" + data) * count)


def log(content: Callable[[], bytes] | bytes, name: str = "log.mcap") -> Callable[[Path], None]:
    """Return what writes one file into a folder."""
    return lambda folder: (folder / name).write_bytes(content() if callable(content) else content) and None


def _mcap_case(name: str, content, command: tuple[str, ...] = VIEW, **more) -> Case:
    return Case(f"MCAP: {name}", log(content), command, **more)


def _with_summary(summary_start: int | None = None, summary: bytes = b"") -> bytes:
    """Return a sound log with a summary, at whatever place its footer says."""
    body = MAGIC + packed(Header("ros2", "stranger")) + sound() + packed(DataEnd(0))
    return body + summary + packed(Footer(len(body) if summary_start is None else summary_start, 0, 0)) + MAGIC


def _corrupt(content: bytes, at: int, by: bytes) -> bytes:
    return content[:at] + by + content[at + len(by) :]


def _record(opcode: int, length: int, content: bytes = b"") -> bytes:
    return RECORD.pack(opcode, length) + content


def _doubling(levels: int, leaf: str) -> str:
    types = [f"{SPLIT}MSG: drive_msgs/N{k}\nN{k + 1} a\nN{k + 1} b\n" for k in range(levels)]
    return "N0 a\nN0 b\n" + "".join(types) + f"{SPLIT}MSG: drive_msgs/N{levels}\n{leaf}\n"


def _nested(levels: int) -> str:
    return "N0 a\n" + "".join(f"{SPLIT}MSG: drive_msgs/N{k}\nN{k + 1} a\n" for k in range(levels)) + f"{SPLIT}MSG: drive_msgs/N{levels}\nbyte a\n"


_MANY = struct.pack("<I", 2**32 - 1)

COMPRESSION = [
    *(
        _mcap_case(
            f"262 kB of zstd that unpack to 8.2 GB, {says}, by {command[0]}",
            lambda frame=frame, size=size: mcap(described(), chunk(zeros_by_zstd(8_200_000_000 // _RLE_BLOCK * _RLE_BLOCK, frame), "zstd", size)),
            command,
        )
        for says, frame, size in (
            ("as both say", True, 8_200_000_000 // _RLE_BLOCK * _RLE_BLOCK),
            ("as the chunk says", False, 8_200_000_000 // _RLE_BLOCK * _RLE_BLOCK),
            ("as only the frame says", True, 100),
            ("as nothing says", False, 100),
        )
        for command in (VIEW, REPLAY, ("recover", "log.mcap", "-o", "out.mcap"), ("to-csv", "log.mcap", "-o", "out.csv"))
    ),
    _mcap_case("100 chunks that unpack to 127 MB each", lambda: mcap(chunk(zeros_by_zstd(968 * _RLE_BLOCK, True), "zstd", 968 * _RLE_BLOCK) * 100)),
    _mcap_case("a chunk of 63 MB of zeros", lambda: mcap(chunk(zeros_by_zstd(480 * _RLE_BLOCK, True), "zstd", 480 * _RLE_BLOCK))),
    _mcap_case(
        "a chunk of 600,000 empty messages",
        lambda: mcap(described(), chunk(zstandard.compress(message(b"") * 600_000), "zstd", 600_000 * 31)),
    ),
    _mcap_case("lz4 that unpacks to 400 MB", lambda: mcap(chunk(lz4.frame.compress(bytes(400_000_000)), "lz4", 400_000_000))),
    _mcap_case("lz4 that unpacks to more than the chunk says", lambda: mcap(chunk(lz4.frame.compress(bytes(200_000_000)), "lz4", 1000))),
    _mcap_case("lz4 cut short", lambda: mcap(chunk(lz4.frame.compress(message() * 1000)[:-20], "lz4", 1000 * len(message())))),
    _mcap_case(
        "lz4 with bytes overwritten",
        lambda: mcap(chunk(_corrupt(lz4.frame.compress(message() * 1000), 20, b"\xff" * 20), "lz4", 1000 * len(message()))),
    ),
    _mcap_case("lz4 that is zstd", lambda: mcap(chunk(zstandard.compress(message() * 9), "lz4", 9 * len(message())))),
    _mcap_case("zstd cut short", lambda: mcap(chunk(zstandard.compress(message() * 9)[:-9], "zstd", 9 * len(message())))),
    _mcap_case("a chunk within a chunk", lambda: mcap(described(), chunk(chunk(message())))),
    _mcap_case("a compression that nobody knows", lambda: mcap(described(), chunk(message(), "\x1b[31mbrotli"))),
]


def _lost_sections(count: int) -> bytes:
    """Return a file with checksum records, before each of whose sections stands a byte that belongs to none."""
    found = MAGIC + packed(Header("ros2", "stranger"))
    parts, begin = [found, checksum_record(0, zlib.crc32(found))], len(found) + CHECKSUM_RECORD.size
    record = _record(0x90, 9, b"123456789")
    for _ in range(count):
        parts += [b"\x90", record, checksum_record(begin + 1, zlib.crc32(record))]
        begin += 1 + len(record) + CHECKSUM_RECORD.size
    return b"".join(parts)


def _hole_as_summary(folder: Path) -> None:
    """Write a file whose footer says that its summary is almost all of it."""
    begin = mcap(ends=False) + packed(DataEnd(0))
    with open(folder / "log.mcap", "wb") as stream:
        stream.write(begin)
        stream.seek(10**10)
        stream.write(packed(Footer(len(begin), 0, 1)) + MAGIC)


RECOVER = ("recover", "log.mcap", "-o", "good.mcap")
LENGTHS = [
    _mcap_case("a record of 2^63 bytes", mcap(_record(Opcode.CHUNK, 2**63), ends=False)),
    _mcap_case("a record of 2^64-1 bytes", mcap(_record(Opcode.MESSAGE, 2**64 - 1), ends=False), REPLAY),
    _mcap_case("chunk data of 2^63 bytes", mcap(_record(Opcode.CHUNK, 100, struct.pack("<QQQIIQ", 0, 0, 9, 0, 0, 2**63) + bytes(60)))),
    _mcap_case("a chunk of 2^64-1 bytes", mcap(chunk(b"", "zstd", 2**64 - 1))),
    _mcap_case("a compression of 4 GB", mcap(_record(Opcode.CHUNK, 100, struct.pack("<QQQII", 0, 0, 9, 0, 2**32 - 1) + bytes(68)))),
    _mcap_case("a schema's name of 4 GB", mcap(_record(Opcode.SCHEMA, 10, struct.pack("<HI", 1, 2**32 - 1) + b"abcd"))),
    _mcap_case("a channel's metadata of 4 GB", mcap(_record(Opcode.CHANNEL, 16, struct.pack("<HHIII", 1, 1, 0, 0, 2**32 - 1)))),
    _mcap_case("metadata of 4 GB", mcap(_record(Opcode.METADATA, 8, struct.pack("<II", 0, 2**32 - 1)))),
    _mcap_case("an attachment of 2^63 bytes", mcap(_record(Opcode.ATTACHMENT, 36, struct.pack("<QQIIQI", 0, 0, 0, 0, 2**63, 0)))),
    _mcap_case("a message of 3 bytes", mcap(described(), _record(Opcode.MESSAGE, 3, b"abc"))),
    _mcap_case("a summary at 2^63", lambda: _with_summary(2**63 - 1), ("to-csv", "log.mcap", "-o", "out.csv")),
    _mcap_case("a summary that is the whole file", lambda: _with_summary(8), ("to-csv", "log.mcap", "-o", "out.csv")),
    _mcap_case(
        "an index of chunks at 2^63",
        lambda: _with_summary(
            summary=packed(ChunkIndex(2**63, 2**63, "", 2**63, 0, 2**63, {11: 2**63}, 0, 2**63))
            + packed(Channel(11, "/roller_loads", "cdr", {}, 0))
            + packed(Statistics(0, 1, {11: 2**63}, 1, 2**63, 0, 0, 0, 1))
        ),
        ("to-csv", "log.mcap", "-o", "out.csv"),
    ),
    _mcap_case(
        "100,000 entries for one metadata record",
        lambda: _with_summary(summary=packed(MetadataIndex(8, 100, "x")) * 100_000),
        ("to-csv", "log.mcap", "-o", "out.csv"),
    ),
    Case(
        "MCAP: a hole of 10 GB that is one record", lambda folder: _sparse(folder / "log.mcap", mcap(_record(Opcode.CHUNK, 10**10), ends=False)), VIEW
    ),
    Case("MCAP: a hole of 10 GB without records", lambda folder: _sparse(folder / "log.mcap", mcap(ends=False)), VIEW),
    _mcap_case("500,000 sections, every second of which is lost", lambda: _lost_sections(500_000), RECOVER),
    Case(
        "MCAP: a hole of 10 GB after a sound section",
        lambda folder: _sparse(folder / "log.mcap", _lost_sections(0)),
        ("recover", "log.mcap", "-o", "good.mcap"),
    ),
    Case("MCAP: a summary that is a hole of 10 GB", _hole_as_summary, RECOVER),
    _mcap_case("nothing but its first bytes", MAGIC),
    _mcap_case("an empty file", b"", REPLAY),
    _mcap_case("random bytes", bytes(range(256)) * 100, ("info", "log.mcap")),
]
DEFINITIONS = [
    _mcap_case("a definition of 100,000 fields for 10,000 messages", lambda: typed("".join(f"byte x{k}\n" for k in range(100_000)), count=10_000)),
    _mcap_case("a definition of 100,000 fields, by replay", lambda: typed("".join(f"byte x{k}\n" for k in range(100_000))), REPLAY),
    _mcap_case("a definition of 30 MB", lambda: typed("# " + "x" * 30_000_000)),
    _mcap_case(
        "3,000 definitions of 30 kB each", lambda: mcap(*(described(f"/x{k}", ("a/msg/B", "ros2msg", b"#" * 30_000), k) for k in range(3000)))
    ),
    _mcap_case("types within types, 3,000 levels", lambda: typed(_nested(3000))),
    _mcap_case("types that double 60 times, of texts", lambda: typed(_doubling(25, "string a"), bytes(4000))),
    _mcap_case("types that double 60 times, of bytes in arrays", lambda: typed(_doubling(25, "uint8[1] a"), bytes(4000))),
    _mcap_case("a type that contains itself", typed(f"A a\n{SPLIT}MSG: drive_msgs/A\nA[] a\n", bytes(1000))),
    _mcap_case("an array of 4,000 million messages of bytes", typed(f"B[] a\n{SPLIT}MSG: drive_msgs/B\nuint8[1] a\n", _MANY)),
    _mcap_case("an array of 1,000 million texts", typed("string[1000000000] a\n", bytes(100))),
    _mcap_case("an array of 4,000 million numbers", typed("float64[] a\n", _MANY)),
    _mcap_case("a text of 4 GB", typed("string a\n", _MANY)),
    _mcap_case("arrays of arrays of arrays", typed(_doubling(3, "byte[] a").replace(" b\n", "[100000] b\n"), bytes(100))),
    _mcap_case("a definition that is not UTF-8", typed(b"float64 \xff\xfe\n")),
    _mcap_case("a definition that is not one", typed("'; import os; os.system('true')\n")),
    _mcap_case("field names of Python's own", typed("float64 __class__\nfloat64 __dict__\n", bytes(16))),
    _mcap_case("a definition in IDL that is not one", typed("module a { struct", syntax="ros2idl")),
    _mcap_case("a definition in IDL, 50,000 levels", lambda: typed("module a {" * 50_000, syntax="ros2idl")),
    _mcap_case("a definition in IDL of 1.9 MB of brackets", lambda: typed("(" * 1_900_000, syntax="ros2idl")),
    _mcap_case("a definition in IDL with an array of 4,000 million", typed("module a { struct S { double x[4000000000]; }; };", syntax="ros2idl")),
    _mcap_case("a definition in a syntax that nobody knows", typed("{}", syntax="jsonschema")),
    _mcap_case("JointState with texts as velocities", lambda: _redefined(JOINTS, "string[] name\nstring[] velocity\n")),
    _mcap_case("JointState without any field, by replay", lambda: _redefined(JOINTS, ""), REPLAY),
    _mcap_case("JointState with stamps of 64 bits, by replay", lambda: _redefined(JOINTS, "Stamped header\n"), REPLAY),
    _mcap_case("messages in JSON", mcap(described(encoding="json"), message(b"{}"))),
    _mcap_case("messages in big-endian parameter lists", mcap(described(), message(b"\0\2\0\0" + bytes(8)))),
    _mcap_case("a point cloud of 4,000 million points", lambda: _cloud(2**32 - 1)),
    _mcap_case("a point cloud whose fields lie outside", lambda: _cloud(1, offset=2**32 - 1)),
    _mcap_case("a diagnostics message whose texts are numbers", lambda: _redefined("diagnostic_msgs/msg/DiagnosticArray", "uint8[] status\n")),
    _mcap_case(
        "10,000 messages with other joints each",
        lambda: mcap(
            described("/joints", (JOINTS, "ros2msg", b"string[] name\nfloat64[] velocity\n")),
            *(message(b"\0\1\0\0" + struct.pack("<II7sxI4xd", 1, 7, b"%06d" % k, 1, 1.0)) for k in range(10_000)),
        ),
        accepted="2,000 lines are shown, and the message says that there are more",
    ),
]
TIMES = [
    _mcap_case("log times of 2^64-1", mcap(described(), message(time=2**64 - 1) * 9)),
    _mcap_case("log times of 2^63, by replay", lambda: mcap(sound(0), *(message(number=n, time=2**63) for n in (11, 12))), REPLAY),
]
NAMES = [
    _mcap_case("a topic that writes on the terminal", mcap(described("/\x1b]0;owned\x07\x1b[2J\r\n/x"), message(b"\0\1\0\0"))),
    _mcap_case("a type that writes on the terminal", mcap(described("/x", ("a/msg/\x1b[31m", "ros2msg", b"")), message())),
    _mcap_case("a topic of 10 MB", lambda: mcap(described("/" + "x" * 10_000_000), message(b"\0\1\0\0"))),
    _mcap_case("65,000 topics that cannot be read", lambda: mcap(*(described(f"/{k}", number=k) + message(b"", k) for k in range(1, 65_000)))),
    _mcap_case("65,000 topics, by replay", lambda: mcap(*(described(f"/{k}", number=k) for k in range(1, 65_000))), REPLAY),
    _mcap_case("a topic with a null character", mcap(described("/a\0b"), message(b"\0\1\0\0"))),
    _mcap_case("a topic with an unpaired surrogate", mcap(_record(Opcode.CHANNEL, 19, struct.pack("<HHI3sII", 1, 1, 3, b"\xed\xa0\x80", 0, 0)))),
    _mcap_case(
        "metadata that write on the terminal", mcap(packed(Metadata("\x1b[31m", {"\x1b": "\x07"})), ends=False), ("to-csv", "log.mcap", "-o", "a.csv")
    ),
    _mcap_case("joints that write on the terminal, by replay", lambda: _other_joints("\x1b[31mshaft\x07"), REPLAY),
    _mcap_case(
        "an attachment called ../../x, by recover",
        mcap(packed(Attachment(0, 0, "../../x", "a", b"x")), ends=False),
        ("recover", "log.mcap", "-o", "o.mcap"),
    ),
]


def _sparse(path: Path, begin: bytes) -> None:
    path.write_bytes(begin)
    os.truncate(path, len(begin) + 10**10)


def _redefined(kind: str, text: str) -> bytes:
    """Return a log in which a standard type has other fields."""
    more = f"{SPLIT}MSG: sensor_msgs/Stamped\nTime stamp\n{SPLIT}MSG: sensor_msgs/Time\nuint64 sec\nuint64 nanosec\n" if "Stamped" in text else ""
    topic = "/shaft_speed" if kind == JOINTS else "/diagnostics"
    data = b"\0\1\0\0" + struct.pack("<IIIIII", 1, 2, 97, 1, 2, 97) if "velocity" in text else b"\0\1\0\0" + b"\xff" * 64
    return mcap(described(topic, (kind, "ros2msg", (text + more).encode())), message(data) * 5)


def _cloud(width: int, offset: int = 0) -> bytes:
    kind = "sensor_msgs/msg/PointCloud2"
    fields = [{"name": name, "offset": offset, "datatype": 7, "count": 1} for name in "xyz"]
    head = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    whole = {"header": head, "height": 1, "width": width, "fields": fields, "is_bigendian": False, "point_step": 12, "row_step": 12 * width % 2**32}
    data = message_type(kind).serialize({**whole, "data": [0] * 12, "is_dense": True})
    return mcap(described("/cloud", (kind, "ros2msg", message_type(kind).definition.encode())), message(data))


def _other_joints(name: str) -> bytes:
    return sound().replace(b"shaft\0", b"shift\0").replace(b"other\0", name[:5].encode() + b"\0")


def database(*statements: str, rows: tuple = (("/x", "std_msgs/msg/Float64", "cdr"),), messages: int = 5) -> Callable[[Path], None]:
    """Return what writes a bag in SQLite; the statements are executed at its end."""

    def make(folder: Path) -> None:
        with closing(sqlite3.connect(folder / "log.db3")) as bag:
            bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format, offered_qos_profiles)")
            bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
            bag.executemany("INSERT INTO topics(name, type, serialization_format, offered_qos_profiles) VALUES (?, ?, ?, '')", rows)
            bag.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)", [(T0 + k, _DATA) for k in range(messages)])
            for statement in statements:
                bag.execute(statement)
            bag.commit()

    return make


def _sqlite(
    name: str, *statements: str, command: tuple[str, ...] = ("view", "log.db3", "--no-open", "-o", "log.rrd"), accepted: str = "", **more
) -> Case:
    return Case(f"SQLite: {name}", database(*statements, **more), command, accepted)


def _damaged_database(offset: int, by: bytes) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        database(messages=2000)(folder)
        path = folder / "log.db3"
        path.write_bytes(_corrupt(path.read_bytes(), offset, by))

    return make


def _folder(metadata: str | bytes, *files: tuple[str, bytes]) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        bag = folder / "bag"
        bag.mkdir()
        (bag / "metadata.yaml").write_bytes(metadata if isinstance(metadata, bytes) else metadata.encode())
        for name, content in files:
            (bag / name).write_bytes(content)

    return make


def _listing(*names: str, more: str = "") -> str:
    return f"rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths: [{', '.join(names)}]\n{more}"


def _in_folder(
    name: str, make: Callable[[Path], None], command: tuple[str, ...] = ("view", "bag", "--no-open", "-o", "bag.rrd"), accepted: str = ""
) -> Case:
    return Case(f"folder: {name}", make, command, accepted)


def _looping_database(folder: Path) -> None:
    """Write a database whose table of messages has one inner page again and again, as deep as SQLite goes."""
    database(messages=5000)(folder)
    path = folder / "log.db3"
    data = bytearray(path.read_bytes())
    size = int.from_bytes(data[16:18], "big")
    for page in range(1, len(data) // size):
        begin = page * size
        if data[begin] == 5:  # an inner page of a table: all its children become its first one
            cells = int.from_bytes(data[begin + 3 : begin + 5], "big")
            first = int.from_bytes(data[begin + 12 : begin + 14], "big")
            child = data[begin + first : begin + first + 4]
            for k in range(1, cells):
                at = begin + int.from_bytes(data[begin + 12 + 2 * k : begin + 14 + 2 * k], "big")
                data[at : at + 4] = child
            data[begin + 8 : begin + 12] = (page + 1).to_bytes(4, "big")
    path.write_bytes(data)


_COUNTING = "WITH RECURSIVE n(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM n) SELECT"
_DEFINITION = (
    "CREATE TABLE message_definitions(topic_type, encoding, encoded_message_definition)",
    "INSERT INTO message_definitions WITH RECURSIVE n(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM n WHERE k < 100000) "
    "SELECT 'std_msgs/msg/Float64', 'ros2msg', group_concat('byte x' || k, char(10)) FROM n",
)
SQLITE = [
    Case("SQLite: no database", log(b"SQLite format 3\0" + bytes(range(256)) * 40, "log.db3"), ("view", "log.db3", "--no-open")),
    Case("SQLite: an empty file", log(b"", "log.db3"), ("replay", "log.db3", "--scene", "deng2017_table1")),
    Case("SQLite: a page of 0xff", _damaged_database(4096, b"\xff" * 4096), ("view", "log.db3", "--no-open")),
    Case("SQLite: the schema overwritten", _damaged_database(100, b"\xff" * 600), ("view", "log.db3", "--no-open")),
    Case("SQLite: a text of the schema overwritten", _damaged_database(3900, b"\xff\xfe" * 60), ("view", "log.db3", "--no-open")),
    Case(
        "SQLite: pages that lead to themselves",
        _looping_database,
        ("view", "log.db3", "--no-open"),
        accepted="the messages before the damage are used, and the message says so",
    ),
    _sqlite(
        "messages that a view counts without end",
        "DROP TABLE messages",
        f"CREATE VIEW messages AS {_COUNTING} k, 1 topic_id, k timestamp, x'00' data FROM n",
    ),
    _sqlite(
        "topics that a view counts without end",
        "DROP TABLE topics",
        f"CREATE VIEW topics AS {_COUNTING} k id, 'a' name, 'b' type, 'cdr' serialization_format FROM n",
    ),
    _sqlite(
        "messages of 1 GB that a column generates",
        "ALTER TABLE messages RENAME COLUMN data TO d",
        "ALTER TABLE messages ADD COLUMN data AS (zeroblob(1000000000))",
    ),
    _sqlite("a virtual table", "DROP TABLE messages", "CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)"),
    _sqlite("no table of messages", "DROP TABLE messages"),
    _sqlite("no topics", "DELETE FROM topics"),
    _sqlite("times that are texts", "UPDATE messages SET timestamp = 'soon'"),
    _sqlite("times before 1970 and after 2116", "UPDATE messages SET timestamp = -9223372036854775808"),
    _sqlite("data that are numbers", "UPDATE messages SET data = 5"),
    _sqlite("topics that are nothing", "UPDATE topics SET name = NULL, type = NULL, serialization_format = NULL"),
    _sqlite("a topic that writes on the terminal", rows=(("/\x1b[31m\x07", "a/msg/\x1b]0;x\x07", "cdr"),)),
    _sqlite("a topic that is not UTF-8", "UPDATE topics SET name = CAST(x'fffe' AS TEXT)"),
    _sqlite("a definition of 100,000 fields", *_DEFINITION),
    _sqlite("a definition of 100,000 fields, by replay", *_DEFINITION, command=("replay", "log.db3", "--scene", "deng2017_table1", "--speed", "/x")),
    _sqlite("messages that are serialised as JSON", rows=(("/x", "std_msgs/msg/Float64", "json"),)),
    Case(
        "SQLite: a name that is an address",
        lambda folder: (database()(folder), (folder / "log.db3").rename(folder / "a?mode=memory&vfs=x#%00.db3")) and None,
        ("view", "a?mode=memory&vfs=x#%00.db3", "--no-open", "-o", "log.rrd"),
        accepted="the name is that of a file",
    ),
    _in_folder(
        "a database of 33 kB that unpacks to 1 GB",
        lambda folder: _folder(
            _listing("bag.db3.zstd", more="  compression_format: zstd\n  compression_mode: FILE\n"), ("bag.db3.zstd", zeros_by_zstd(2**30, True))
        )(folder),
    ),
    _in_folder(
        "a compression that nobody knows",
        lambda folder: (
            (database()(folder), _folder(_listing("bag.db3", more="  compression_format: xz\n  compression_mode: FILE\n"), ("bag.db3", b""))(folder))
            and None
        ),
    ),
]
_ALIASES = "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 12))
FOLDERS = [
    _in_folder("metadata that name /etc/passwd", _folder(_listing("/etc/passwd"))),
    _in_folder("metadata that name ../../etc/passwd.mcap", _folder(_listing("../../../../etc/passwd.mcap"))),
    _in_folder("metadata that name /dev/zero", _folder(_listing("/dev/zero.mcap", "..", "."))),
    _in_folder("metadata with aliases of aliases", _folder("a0: &a0 [1]\n" + _ALIASES + _listing("*a11"))),
    _in_folder("metadata of 3,000 levels", _folder("[" * 3000)),
    _in_folder("metadata of 100,000 levels", _folder("[" * 100_000)),
    _in_folder("metadata of 50 MB", lambda folder: _folder("# " + "x" * 50_000_000)(folder)),
    _in_folder("metadata in Latin-1", _folder("rosbag2_bagfile_information: {f\xfcr: 1}".encode("latin-1"))),
    _in_folder("metadata that name a class of Python", _folder("!!python/object/apply:os.system ['true']")),
    _in_folder("metadata that are a list", _folder("- 1\n- 2\n")),
    _in_folder("metadata that list numbers", _folder(_listing("1", "2"))),
    _in_folder("metadata that list a null character", _folder(_listing('"a\\0b.mcap"'))),
    _in_folder("metadata that are a pipe", lambda folder: ((folder / "bag").mkdir(), os.mkfifo(folder / "bag" / "metadata.yaml")) and None),
    _in_folder("a file that is a pipe", lambda folder: ((folder / "bag").mkdir(), os.mkfifo(folder / "bag" / "a.mcap")) and None),
    _in_folder("a file that is a device", lambda folder: ((folder / "bag").mkdir(), (folder / "bag" / "a.mcap").symlink_to("/dev/zero")) and None),
    _in_folder(
        "a file that is a device, by replay",
        lambda folder: ((folder / "bag").mkdir(), (folder / "bag" / "a.db3").symlink_to("/dev/zero")) and None,
        ("replay", "bag", "--scene", "deng2017_table1"),
    ),
    _in_folder(
        "a file that is a link to nothing", lambda folder: ((folder / "bag").mkdir(), (folder / "bag" / "a.mcap").symlink_to("nowhere")) and None
    ),
    _in_folder("a link to itself", lambda folder: (folder / "bag").symlink_to("bag")),
    Case("recording: a pipe", lambda folder: os.mkfifo(folder / "log.mcap"), VIEW),
    Case("recording: a pipe, by replay", lambda folder: os.mkfifo(folder / "log.db3"), ("replay", "log.db3", "--scene", "deng2017_table1")),
    Case("recording: /dev/zero", lambda folder: None, ("view", "/dev/zero", "--no-open", "-o", "a.rrd")),
    Case("recording: /dev/zero, by compare", lambda folder: None, ("compare", "/dev/zero", "/dev/zero")),
    Case("recording: a file of users, by info", lambda folder: None, ("info", "/etc/passwd")),
    Case("recording: a file of users, by view", lambda folder: None, ("view", "/etc/passwd", "--no-open", "-o", "a.rrd")),
    Case(
        "recording: a name that writes on the terminal",
        lambda folder: (folder / "\x1b[31m.mcap").write_bytes(b"x") and None,
        ("info", "\x1b[31m.mcap"),
    ),
]


def ros1(*records: tuple[dict[str, bytes], bytes]) -> bytes:
    """Return a bag of ROS 1 of these records."""
    found = b"#ROSBAG V2.0\n"
    for fields, data in records:
        parts = [name.encode() + b"=" + value for name, value in fields.items()]
        head = b"".join(struct.pack("<I", len(part)) + part for part in parts)
        found += struct.pack("<I", len(head)) + head + struct.pack("<I", len(data)) + data
    return found


def _ros1_chunk(compression: bytes, size: int, data: bytes) -> tuple[dict[str, bytes], bytes]:
    return {"op": b"\5", "compression": compression, "size": struct.pack("<I", size)}, data


def _connection(definition: bytes, topic: bytes = b"/x") -> tuple[dict[str, bytes], bytes]:
    parts = [b"type=std_msgs/Float64", b"md5sum=*", b"message_definition=" + definition]
    data = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    return {"op": b"\7", "conn": bytes(4), "topic": topic}, data


def _ros1_case(name: str, content: Callable[[], bytes] | bytes) -> Case:
    return Case(f"ROS 1: {name}", log(content, "log.bag"), ("view", "log.bag", "--no-open", "-o", "log.rrd"))


_ROS1_MESSAGE = ({"op": b"\2", "conn": bytes(4), "time": struct.pack("<II", 1_700_000_000, 0)}, bytes(8))
ROS1 = [
    _ros1_case("bzip2 that unpacks to 300 MB", lambda: ros1(_ros1_chunk(b"bz2", 300_000_000, bz2.compress(bytes(300_000_000))))),
    _ros1_case("bzip2 that unpacks to more than it says", lambda: ros1(_ros1_chunk(b"bz2", 100, bz2.compress(bytes(300_000_000))))),
    _ros1_case("lz4 that unpacks to 2 GB as it says", lambda: ros1(_ros1_chunk(b"lz4", 2**31, lz4.frame.compress(bytes(1000))))),
    _ros1_case("a record of 4 GB", b"#ROSBAG V2.0\n" + _MANY),
    _ros1_case("fields of 4 GB", b"#ROSBAG V2.0\n" + struct.pack("<I", 8) + _MANY + b"a=bc" + bytes(4)),
    _ros1_case("records that are no fields", b"#ROSBAG V2.0\n" + bytes(4000)),
    _ros1_case(
        "a definition of 100,000 fields", lambda: ros1(_connection(b"".join(b"byte x%d\n" % k for k in range(100_000))), *[_ROS1_MESSAGE] * 1000)
    ),
    _ros1_case(
        "4,000 million empty messages in one", ros1(_connection(b"E[] a\n" + SPLIT.encode() + b"MSG: std_msgs/E\n"), (_ROS1_MESSAGE[0], _MANY))
    ),
    _ros1_case("an encrypted bag", ros1(({"op": b"\3", "encryptor": b"x"}, b""))),
    _ros1_case("a topic that writes on the terminal", ros1(_connection(b"string a\n", b"/\x1b[31m\x07"), (_ROS1_MESSAGE[0], _MANY))),
    _ros1_case("another version", b"#ROSBAG V1.2\n" + bytes(100)),
]


def run(scene: str | None = None, start: str | None = None, **records: dict[str, str]) -> Callable[[Path], None]:
    """Return what writes the recording of a run, with another scene or start in its metadata, and with further metadata."""

    def make(folder: Path) -> None:
        own = load_scene("deng2017_table1")
        with McapSink(folder / "whole.mcap", own, T0) as sink:
            sink.write(synthetic_block(own, [0.001 * k for k in range(1, 50)]))
        rewritten(folder / "whole.mcap", folder / "log.mcap", scene, start, records)

    return make


def rewritten(source: Path, target: Path, scene: str | None, start: str | None, records: dict[str, dict[str, str]]) -> None:
    """Copy a recording with other metadata."""
    from bearing_sim.recording.mcap_reader import McapReader
    from bearing_sim.recording.mcap_writer import McapWriter

    with open(target, "wb") as stream:
        writer, schemas, channels = McapWriter(stream), {}, {}
        for record in McapReader(source):
            if isinstance(record, Schema):
                schemas[record.id] = writer.add_schema(record.name, record.encoding, record.data)
            elif isinstance(record, Channel):
                channels[record.id] = writer.add_channel(record.topic, record.message_encoding, schemas[record.schema_id], record.metadata)
            elif isinstance(record, Message):
                writer.add_message(record._replace(channel_id=channels[record.channel_id]))
            elif isinstance(record, Metadata):
                own = {"scene": scene, "start_ns": start} if record.name == "bearing_sim" else {}
                writer.add_metadata(record.name, {**record.metadata, **{key: text for key, text in own.items() if text is not None}})
        for name, record in records.items():
            writer.add_metadata(name, record)
        writer.finish()


_CSV = ("to-csv", "log.mcap", "-o", "out.csv")
_SECRET = "bearing: {preset: NU 210, outer_raceway: {contour_file: /etc/passwd}}\nlubricant: {oil: ISO VG 68}\noperating: {shaft_speed: 1 rpm}\n"
RUNS = [
    Case("run: a scene whose contour is /etc/passwd", run(_SECRET), _CSV),
    Case("run: a scene whose contour is /dev/zero", run(_SECRET.replace("/etc/passwd", "/dev/zero")), ("plot", "log.mcap", "-o", "a.png")),
    Case("run: a scene of aliases of aliases", run("a0: &a0 [1]\n" + _ALIASES), ("report", "log.mcap", "-o", "a.html")),
    Case("run: a scene of 3,000 levels", run("[" * 3000), ("to-parquet", "log.mcap", "-o", "a.parquet")),
    Case("run: a scene of nothing", run(""), ("replay", "log.mcap", "--from-recording", "--out", "b.mcap")),
    Case("run: a scene that names a class of Python", run("!!python/object/apply:os.system ['true']"), _CSV),
    Case("run: a scene with 100 million rollers", lambda folder: run(_with_rollers(100_000_000))(folder), _CSV),
    Case("run: a scene with another count of rollers", lambda folder: run(_with_rollers(12))(folder), _CSV),
    Case("run: a start of 5,000 digits", run(start="9" * 5000), _CSV),
    Case("run: a start of 300 digits", run(start="9" * 300), _CSV),
    Case("run: a start that is no number", run(start="\x1b[31mnow"), _CSV),
    Case(
        "run: a stored state that is not one",
        run(bearing_sim_state={"state": "[" * 100_000, "counts": "once"}),
        ("replay", "log.mcap", "--from-recording", "--out", "b.mcap"),
        accepted="",
    ),
]


def _with_rollers(count: int) -> str:
    from bearing_sim.scene.loader import scene_to_yaml

    lines = scene_to_yaml(load_scene("deng2017_table1")).splitlines()
    return "\n".join(f"{line.partition(':')[0]}: {count}" if line.strip().startswith("count:") else line for line in lines)


CASES = [*COMPRESSION, *LENGTHS, *DEFINITIONS, *TIMES, *NAMES, *SQLITE, *FOLDERS, *ROS1, *RUNS]
