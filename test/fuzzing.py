# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What may stand in files from strangers: generators of content for every reader, and what a reader may do with it.

A reader takes content, or refuses it with an error that the commands turn into one message; the message can be read.  Whatever else it raises is
a fault.  ``test_fuzzing.py`` tries a few examples of each and those kept in ``corpus/``, ``benchmarks/fuzz.py`` as many as there is time for.
"""

import copy
import datetime
import io
import json
import math
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import yaml
from hypothesis import strategies as st
from mcap.writer import Writer
from recordings import steady_log
from synthetic_run import synthetic_block

from bearing_sim.files import kept
from bearing_sim.files.limits import FileError
from bearing_sim.inputs.csv_guess import guess
from bearing_sim.inputs.csv_import import input_log, load_mapping, mapping_from_yaml, read_table
from bearing_sim.inputs.csv_text import TableError
from bearing_sim.inputs.log import InputLogError, read_input_log
from bearing_sim.recording.compare import compare
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene import loader
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.loader import load_scene, scene_from_yaml, scene_to_yaml
from bearing_sim.scene.quantity import to_si
from bearing_sim.watchers.stored_state.state import new_state
from bearing_sim.watchers.stored_state.state_file import VERSION, StateError, read_state
from bearing_sim.watchers.vibration.reading import read_vibration
from bearing_sim.watchers.vibration.signal import Vibration, VibrationError

CORPUS = Path(__file__).with_name("corpus")
REFUSALS = (SceneError, FileError, TableError, InputLogError, StateError, VibrationError, OSError)
"""Errors that the commands turn into one message and an exit code."""

_LONGEST_MESSAGE = 20_000  # characters that somebody may still read
_FOLDER = Path(loader.__file__).parent
_ODD_VALUES = (
    None,
    True,
    "",
    [],
    {},
    [[]],
    0,
    -1,
    10**400,
    math.nan,
    math.inf,
    -math.inf,
    1e308,
    5e-324,
    "null",
    "nan",
    "inf mm",
    "1e400 N",
    "1 N**9**9",
    "0 mm",
    "-1 mm",
    "1 mm/0",
    "800 N N",
    "120 degC/s",
    "3 um +- 1",
    "\u00b5",
    "\N{ARABIC-INDIC DIGIT THREE} mm",
    "a" * 1000,
    "../../etc/passwd",
    "/dev/zero",
    "%s%n{0}",
    "\x1b[31m",
    "\ud800",
    datetime.date(2026, 11, 23),
    datetime.datetime(1, 1, 1),
)
_YAML_TOKENS = (
    "!!int abc",
    "!!python/object:os.system {}",
    "!!binary =",
    "!!timestamp 2001-13-45",
    "&a [*a]",
    "<<: *a",
    "? ",
    "- ",
    ": ",
    "|\n",
    "{",
    "[",
    "}",
    "---\n",
    "%YAML 9.9\n",
    "\t",
    "\x00",
    "\ufeff",
    "0x",
    "1_0:90",
    "1e999",
    "'",
    '"\\ud800"',
    "#",
)
_CSV_TOKENS = (
    "1e990000",
    "-1e-990000",
    "nan",
    "inf",
    "1,5",
    "1.234.567",
    '"',
    '""',
    ";",
    "\t",
    "\r",
    "\n\n",
    "\x00",
    "\ufeff",
    "#",
    "9" * 5000,
    "2026-02-30T00:00:00Z",
    "0001-01-01",
    "1e30",
    "-5",
    "24:00",
    "\u2007",
    "=cmd()",
)


def spoiled_bytes(originals: Callable[[], list[bytes]], tokens: tuple[bytes, ...] = ()) -> st.SearchStrategy[bytes]:
    """Return a strategy of files that were good: bits flipped, parts removed, repeated and replaced, tokens inserted."""

    @st.composite
    def spoiled(draw) -> bytes:
        content = bytearray(draw(st.sampled_from(originals())))
        for _ in range(draw(st.integers(1, 4))):
            first = draw(st.integers(0, len(content)))
            length = draw(st.integers(0, 64))
            act = draw(st.sampled_from(("flip", "remove", "repeat", "number", "cut", *(["token"] * 4 if tokens else ["flip"] * 2))))
            if act == "flip" and first < len(content):
                content[first] ^= 1 << draw(st.integers(0, 7))
            elif act == "remove":
                del content[first : first + length]
            elif act == "repeat":
                content[first:first] = content[first : first + length] * draw(st.integers(1, 3))
            elif act == "number":  # lengths and offsets are little-endian integers
                content[first : first + 8] = draw(st.sampled_from((0, 1, 2**31 - 1, 2**32 - 1, 2**63, 2**64 - 1))).to_bytes(8, "little")
            elif act == "cut":
                del content[first:]
            elif tokens:
                content[first:first] = draw(st.sampled_from(tokens))
        return bytes(content)

    return spoiled()


def _values() -> st.SearchStrategy:
    """Return a strategy of what may stand in place of a value."""
    plain = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20) | st.sampled_from(_ODD_VALUES)
    return st.recursive(plain, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3), max_leaves=5)


def spoiled_trees(originals: Callable[[], list[dict]]) -> st.SearchStrategy[dict]:
    """Return a strategy of mappings that were good, with values replaced, removed, moved and renamed."""

    @st.composite
    def spoiled(draw) -> dict:
        tree = copy.deepcopy(draw(st.sampled_from(originals())))
        for _ in range(draw(st.integers(1, 3))):
            places = list(_places(tree))
            if not places:
                break
            holder, key = draw(st.sampled_from(places))
            act = draw(st.sampled_from(("replace", "replace", "replace", "remove", "rename", "move")))
            if act == "replace":
                holder[key] = draw(_values())
            elif act == "move":
                other, name = draw(st.sampled_from(places))
                holder[key] = copy.deepcopy(other[name])
            elif act == "remove" or isinstance(holder, list):
                del holder[key]
            else:
                holder[draw(st.text(max_size=12))] = holder.pop(key)
        return tree

    return spoiled()


def _places(tree) -> Iterator[tuple[dict | list, object]]:
    """Yield every (container, key or index) of a tree."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        yield tree, key
        if isinstance(value, dict | list):
            yield from _places(value)


def _as_yaml(tree: dict) -> bytes:
    return yaml.dump(tree, allow_unicode=True, sort_keys=False).encode("utf-8", "surrogatepass")


def _encoded(tokens: tuple[str, ...]) -> tuple[bytes, ...]:
    return tuple(token.encode("utf-8", "surrogatepass") for token in tokens)


@cache
def _texts(folder: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted((_FOLDER / folder).glob("*.yaml"))]


@cache
def _trees(folder: str) -> list[dict]:
    return [yaml.safe_load(text) for text in _texts(folder)]


@cache
def _full_scenes() -> list[dict]:
    """Return scenes with every field written out."""
    return [yaml.safe_load(scene_to_yaml(load_scene(name))) for name in ("deng2017_table1", "nu215_rig")]


def scenes() -> st.SearchStrategy[bytes]:
    """Return a strategy of scene files."""
    folder = "scenes"
    return (
        spoiled_trees(lambda: _trees(folder)).map(_as_yaml)
        | spoiled_trees(_full_scenes).map(_as_yaml)
        | spoiled_bytes(lambda: _texts(folder), _encoded(_YAML_TOKENS))
        | st.sampled_from(("utf-8", "latin-1", "utf-16")).flatmap(lambda encoding: st.text().map(lambda text: text.encode(encoding, "replace")))
    )


def read_scene(content: bytes, folder: Path) -> None:
    """Read a scene; one that is accepted must be the same after it has been written and read."""
    path = folder / "scene.yaml"
    path.write_bytes(content)
    scene = load_scene(path)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene, "an accepted scene changes when it is written and read"


def overrides() -> st.SearchStrategy[bytes]:
    """Return a strategy of what follows ``--set``."""
    fields = ("operating.radial_load", "bearing.roller.count", "level", "lubricant.temperature", "bearing.cage.mass", "a.b.c", "", "thresholds")
    value = _values().map(repr) | st.sampled_from(_YAML_TOKENS) | st.text(max_size=30)
    return st.tuples(st.sampled_from(fields), value).map(lambda pair: f"{pair[0]}={pair[1]}".encode("utf-8", "surrogatepass"))


def read_override(content: bytes, folder: Path) -> None:
    """Apply an override to a scene."""
    load_scene("deng2017_table1", [content.decode("utf-8", "surrogateescape")])


def quantities() -> st.SearchStrategy[bytes]:
    """Return a strategy of quantities with units."""
    part = st.sampled_from(
        ("1", "-2.5e3", "1e400", "9" * 50, "mm", "N", "degC", "rpm", "rad/s", "%", "**", "*", "/", "^", "(", ")", " ", "-", "~", "µ", "e", ".")
    )
    return (st.lists(part, max_size=12).map("".join) | st.text(max_size=30)).map(lambda text: text.encode("utf-8", "surrogatepass"))


def read_quantity(content: bytes, folder: Path) -> None:
    """Read a quantity in units of every kind; refused as `to_si` says."""
    text = content.decode("utf-8", "surrogateescape")
    for unit in ("m", "N", "K", "rad/s", "1", "Pa*s"):
        try:
            assert isinstance(to_si(text, unit), float)
        except ValueError as error:
            judge(error)


def mappings() -> st.SearchStrategy[bytes]:
    """Return a strategy of mappings of tables."""
    folder = "catalog/mappings"
    return spoiled_trees(lambda: _trees(folder)).map(_as_yaml) | spoiled_bytes(lambda: _texts(folder), _encoded(_YAML_TOKENS))


def read_mapping(content: bytes, folder: Path) -> None:
    """Read a mapping and, if it is accepted, a table by it."""
    path, table = folder / "mapping.yaml", folder / "table.csv"
    path.write_bytes(content)
    mapping, _ = load_mapping(str(path))
    table.write_text("TimeStamp_StartFormat,GenRpmMean,ActivePowerMean,TurbineName\n2023-07-01 00:00:00,1500,800,HMR_T01\n")
    read_table(table, mapping)


_TABLES = (
    b"time [s],speed [rpm],load [kN]\n0.0,1500,2.0\n0.1,1501,2.1\n0.2,1502,2.2\n0.3,1503,2.3\n",
    b"# a comment\nZeit;Drehzahl;Kraft\ns;1/min;kN\n0,0;1500;2,5\n0,1;1501;2,25\n",
    "timestamp\tspeed (rpm)\tforce (N)\n2026-11-23T00:00:00Z\t1500\t800\n2026-11-23T00:00:01Z\t1500\t\u22125\n".encode(),
)
_MAPPINGS = (
    "{name: a, time: {column: 'time [s]', unit: s}, shaft_speed: {column: 'speed [rpm]'}, radial_load: {law: sum, columns: [{column: 'load [kN]'}]}}",
    "{name: b, time: {column: timestamp, format: iso}, shaft_speed: {column: 'speed (rpm)', unit: rpm}, radial_load: {law: constant, value: 800 N}}",
)


def tables() -> st.SearchStrategy[bytes]:
    """Return a strategy of tables."""
    spoiled = spoiled_bytes(lambda: list(_TABLES), _encoded(_CSV_TOKENS))
    return spoiled | spoiled.map(lambda content: content.decode("utf-8", "replace").encode("utf-16"))


def read_a_table(content: bytes, folder: Path) -> None:
    """Read a table by mappings, and guess a mapping for it; what is accepted has a finite number at every time."""
    path = folder / "table.csv"
    path.write_bytes(content)
    _each(*(lambda text=text: _read_by(path, text) for text in _MAPPINGS), lambda: guess(path))


def _read_by(path: Path, mapping: str) -> None:
    for series in input_log(read_table(path, mapping_from_yaml(mapping)), path).series.values():
        assert all(math.isfinite(value) for values in series.values for value in values)


def _each(*acts: Callable[[], object]) -> None:
    """Do several things with one content, each of which may refuse it."""
    for act in acts:
        try:
            act()
        except REFUSALS as error:
            judge(error)


@cache
def _recordings() -> list[bytes]:
    """Return a small recording of a run and one of inputs."""
    scene = load_scene("deng2017_table1")
    with tempfile.TemporaryDirectory() as name:
        run = Path(name) / "run.mcap"
        with McapSink(run, scene, 1_700_000_000_000_000_000) as sink:
            sink.write(synthetic_block(scene, [0.01, 0.02, 0.03]))
        return [run.read_bytes(), steady_log(Path(name) / "log.mcap", duration=0.3).read_bytes()]


def recordings() -> st.SearchStrategy[bytes]:
    """Return a strategy of recordings."""
    return spoiled_bytes(_recordings)


def read_recording(content: bytes, folder: Path) -> None:
    """Read, check, recover and compare a recording."""
    path, original = folder / "run.mcap", folder / "original.mcap"
    path.write_bytes(content)
    original.write_bytes(_recordings()[0])
    _each(
        lambda: list(Recording(path).with_measurements()),
        lambda: contents(path),
        lambda: recover(path, folder / "recovered.mcap"),
        lambda: read_input_log(path),
        lambda: compare(original, path),
    )


_DEFINITIONS = (
    "float64 data\n",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    "geometry_msgs/Wrench wrench\n" + "=" * 80 + "\nMSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\n",
    "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
)
_TYPES = (
    "std_msgs/msg/Float64",
    "sensor_msgs/msg/JointState",
    "geometry_msgs/msg/WrenchStamped",
    "acme_msgs/msg/Load",
    "sensor_msgs/msg/PointCloud2",
)
_DEFINITION_TOKENS = (
    "float64[4294967296] x\n",
    "float64[<=3] y\n",
    "string<=2 s\n",
    "acme_msgs/Load inner\n",
    "float64 class\n",
    "float64 x 1e999\n",
    "int8 A=\n",
    "=" * 80 + "\n",
    "MSG: a/B\n",
    "wstring w\n",
    "\x00",
)


@st.composite
def messages(draw) -> bytes:
    """Draw a recording of another program: types, definitions and contents of messages that may not fit each other."""
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for topic in draw(st.lists(st.sampled_from(("/shaft_speed", "/radial_load", "/tilt", "")), min_size=1, max_size=3)):
        definition = draw(st.sampled_from(_DEFINITIONS)) + "".join(draw(st.lists(st.sampled_from(_DEFINITION_TOKENS), max_size=2)))
        encoding = draw(st.sampled_from(("ros2msg", "ros2msg", "ros2msg", "ros2idl", "protobuf", "")))
        schema = writer.register_schema(draw(st.sampled_from(_TYPES)), encoding, definition.encode())
        channel = writer.register_channel(topic, draw(st.sampled_from(("cdr", "cdr", "cdr", "json", ""))), schema)
        for _ in range(draw(st.integers(0, 2))):
            data = draw(st.sampled_from((b"", b"\x00\x01\x00\x00"))) + draw(st.binary(max_size=96))
            stamp = draw(st.integers(0, 2**64 - 1))
            writer.add_message(channel, stamp, data, stamp)
    writer.finish()
    return stream.getvalue()


def read_messages(content: bytes, folder: Path) -> None:
    """Read a recording of another program as a log and for a view."""
    from bearing_sim.view.bag import read_bag_series

    path = folder / "foreign.mcap"
    path.write_bytes(content)
    _each(lambda: read_input_log(path), lambda: read_input_log(path, {"radial_load": "/tilt.wrench.force.y"}), lambda: read_bag_series(path))


_BY_HAND = {"serial": "A1", "damage": 0.25, "revolutions": 1e9, "running_hours": 1200.0, "starts": 30}


@cache
def _states() -> list[dict]:
    return [_BY_HAND, new_state(load_scene("deng2017_table1"), "A1", 0).as_mapping()]


def _as_state_file(state: dict) -> bytes:
    """Return a file of a state: of version 0 by hand, of the present version with its checksum."""
    written = json.dumps(state, default=str).encode()
    if len(state) <= len(_BY_HAND):
        return b'{"format": "bearing_sim state", "version": 0, "state": %b}' % written
    head = {"format": "bearing_sim state", "version": VERSION, "checksum": kept._checksum(VERSION, written)}
    return json.dumps(head).encode()[:-1] + b', "state": ' + written + b"}\n"


def states() -> st.SearchStrategy[bytes]:
    """Return a strategy of stored states that somebody has written or changed."""
    return spoiled_trees(_states).map(_as_state_file) | spoiled_bytes(lambda: [_as_state_file(each) for each in _states()])


def read_a_state(content: bytes, folder: Path) -> None:
    """Read a stored state."""
    path = folder / "state.json"
    path.write_bytes(content)
    read_state(path)


_CONTOUR = b"angle [deg],radius [mm]\n" + b"".join(b"%d,%.4f\n" % (angle, 34.87 + 0.001 * (angle % 120)) for angle in range(0, 360, 10))


def contours() -> st.SearchStrategy[bytes]:
    """Return a strategy of measured contours."""
    return spoiled_bytes(lambda: [_CONTOUR], _encoded(_CSV_TOKENS))


def read_a_contour(content: bytes, folder: Path) -> None:
    """Read a scene with a measured raceway."""
    (folder / "contour.csv").write_bytes(content)
    path = folder / "scene.yaml"
    path.write_text(
        "name: a\nbearing: {preset: deng2017_table1, outer_raceway: {contour_file: contour.csv}}\n"
        "lubricant: {oil: mil_l_7808}\noperating: {shaft_speed: 9000 rpm, radial_load: 800 N}\n"
    )
    load_scene(path)


@cache
def _vibrations() -> list[bytes]:
    """Return a small vibration record in each format but HDF5, whose reader ends the process on some damage."""
    import numpy as np
    import pyarrow
    import pyarrow.parquet
    import scipy.io
    import scipy.io.wavfile

    samples, found = np.random.default_rng(1).normal(size=1100).astype(np.float32), []

    def kept(write: Callable[[io.BytesIO], object]) -> None:
        stream = io.BytesIO()
        write(stream)
        found.append(stream.getvalue())

    found.append("\n".join(["time [s];a [g]", *(f"{k / 2000:.4f};{value:.3f}" for k, value in enumerate(samples))]).encode())
    kept(lambda stream: np.savez_compressed(stream, a=samples, fs=2000.0))
    kept(lambda stream: np.save(stream, samples))
    kept(lambda stream: scipy.io.savemat(stream, {"run": {"a": samples, "rate": 2000.0}, "cells": np.array([samples, "x"], dtype=object)}))
    kept(lambda stream: scipy.io.savemat(stream, {"a": samples[:, None]}, do_compression=True))
    kept(lambda stream: scipy.io.wavfile.write(stream, 2000, samples))
    kept(lambda stream: pyarrow.parquet.write_table(pyarrow.table({"time": np.arange(1100) / 2000, "a": samples}), stream))
    return found


_VIBRATION_MARKS = {b"PK": ".npz", b"\x93NUMPY": ".npy", b"MATLAB": ".mat", b"RIFF": ".wav", b"PAR1": ".parquet"}


def vibrations() -> st.SearchStrategy[bytes]:
    """Return a strategy of vibration records."""
    return spoiled_bytes(_vibrations, _encoded(_CSV_TOKENS))


def read_a_vibration(content: bytes, folder: Path) -> None:
    """Read a vibration record in the format that its beginning shows; what is accepted has finite samples."""
    path = folder / f"record{next((suffix for mark, suffix in _VIBRATION_MARKS.items() if content.startswith(mark)), '.csv')}"
    path.write_bytes(content)
    _each(lambda: read_vibration(path), lambda: _finite(read_vibration(path, "a", 2000.0)), lambda: read_vibration(path, rate=2000.0))


def _finite(record: Vibration) -> None:
    assert all(math.isfinite(value) for value in record.samples.tolist())


class Target(NamedTuple):
    """What is read.

    Attributes
    ----------
    contents : generator of its content.
    read : ``read(content, folder)`` writes it into an empty folder and reads it.
    """

    contents: st.SearchStrategy[bytes]
    read: Callable[[bytes, Path], None]


TARGETS = {
    "scene": Target(scenes(), read_scene),
    "override": Target(overrides(), read_override),
    "quantity": Target(quantities(), read_quantity),
    "contour": Target(contours(), read_a_contour),
    "mapping": Target(mappings(), read_mapping),
    "table": Target(tables(), read_a_table),
    "recording": Target(recordings(), read_recording),
    "messages": Target(messages(), read_messages),
    "state": Target(states(), read_a_state),
    "vibration": Target(vibrations(), read_a_vibration),
}


def corpus(target: str) -> list[Path]:
    """Return the kept contents of a target: those that once were faults."""
    return sorted((CORPUS / target).glob("*"))


def judge(error: Exception) -> None:
    """Check that a refusal is a message that somebody can read."""
    text = str(error)
    assert text.strip(), f"{type(error).__name__} without a message"
    assert len(text) <= _LONGEST_MESSAGE, f"a message of {len(text)} characters"


def taken_or_refused(target: str, content: bytes) -> bool:
    """Read content in a folder of its own; return whether it was taken.  A fault raises."""
    with tempfile.TemporaryDirectory() as name:
        try:
            TARGETS[target].read(content, Path(name))
        except REFUSALS as error:
            judge(error)
            return False
    return True
