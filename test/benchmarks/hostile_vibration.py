# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Hostile vibration records of every format, and kept responses of the bands, for ``hostile_files.py``."""

import io
import json
import os
import random
import struct
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

import numpy as np
from hostile_files import Case
from hostile_scenes import fifo, file, link, sparse

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from made_up_response import asking_scene, made_up_response  # noqa: E402

_OPTIONS = ("--rollers", "13", "--speed", "3000rpm")
_RATE = ("--rate", "20kHz")
_NOISE = np.random.default_rng(1).normal(size=20_000)
_TEXT = "".join(f"{value:.5f}\n" for value in _NOISE)
_TEN_GIGABYTE = 10_000_000_000
_NO_LINE = "a record in which no bearing shows has that as its result"


def _read(name: str, *options: str) -> tuple[str, ...]:
    return ("vibration", name, *_OPTIONS[: 2 if "--speed-channel" in options else 4], *options)


def _text(name: str, content: str | bytes | Callable[[], bytes], *options: str, accepted: str = "") -> Case:
    """Return the case of a text; a long one is made when the case runs."""

    def make(folder: Path) -> None:
        file("record.csv", content() if callable(content) else content)(folder)

    return Case(f"vibration CSV: {name}", make, _read("record.csv", *(options or _RATE)), accepted)


def _made(name: str, target: str, make: Callable[[Path], None], *options: str, accepted: str = "") -> Case:
    return Case(f"vibration {Path(target).suffix[1:].upper()}: {name}", lambda folder: make(folder / target), _read(target, *options), accepted)


def _flipped(make: Callable[[Path], None], seed: int, flips: int, begin: int = 0) -> Callable[[Path], None]:
    """Return what makes a file and changes some bits of it at random from a byte on, counted from the end if negative; without flips it is cut."""

    def damage(path: Path) -> None:
        make(path)
        data, source = bytearray(path.read_bytes()), random.Random(seed)
        for _ in range(flips):
            data[source.randrange(begin % len(data), min(len(data), begin % len(data) + 4000))] ^= 1 << source.randrange(8)
        path.write_bytes(data if flips else data[: source.randrange(len(data))])

    return damage


def _parquet(columns: Callable[[], dict], **options: object) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        import pyarrow
        import pyarrow.parquet

        pyarrow.parquet.write_table(pyarrow.table(columns()), path, **options)

    return make


def _wide_texts() -> dict:
    import pyarrow

    text = pyarrow.DictionaryArray.from_arrays(pyarrow.array(np.zeros(1_000_000, np.int8)), ["x" * 1_000_000])
    return {"note": text, "a": np.random.default_rng(2).normal(size=1_000_000)}


def _long_list() -> dict:
    import pyarrow

    return {"a": pyarrow.FixedSizeListArray.from_arrays(pyarrow.array(np.zeros(60_000_000, np.int8)), 60_000_000)}


def _archive(members: Callable[[], Iterable[tuple[str, bytes]]], method: int = zipfile.ZIP_DEFLATED) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w", method) as archive:
            for name, data in members():
                archive.writestr(name, data)

    return make


def _array_file(shape: str, kind: str = "'<f8'", data: bytes = b"") -> bytes:
    """Return an NPY file with a shape and a type of a stranger."""
    heading = f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}}}"
    heading += " " * (-(len(heading) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(heading)) + heading.encode() + data


def _numpy(path: Path) -> None:
    np.savez(path, acceleration=_NOISE, fs=20_000.0)


def _directory_of(count: int) -> Callable[[Path], None]:
    """Return what writes an archive with the directory of so many members, all of them the same."""

    def make(path: Path) -> None:
        local = struct.pack("<4s5H3I2H", b"PK\x03\x04", 20, 0, 0, 0, 33, 0, 0, 0, 1, 0) + b"a"
        with open(path, "wb") as stream:
            stream.write(local)
            for first in range(0, count, 10_000):
                stream.write(
                    b"".join(
                        struct.pack("<4s6H3I5H2I", b"PK\x01\x02", 20, 20, 0, 0, 0, 33, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0) + b"%09d" % k
                        for k in range(first, min(first + 10_000, count))
                    )
                )
            size = stream.tell() - len(local)
            stream.write(struct.pack("<4s2Q2H2I4Q", b"PK\x06\x06", 44, 0, 45, 45, 0, 0, count, count, size, len(local))[:56])
            stream.write(struct.pack("<4sIQI", b"PK\x06\x07", 0, len(local) + size, 1))
            stream.write(struct.pack("<4s4H2IH", b"PK\x05\x06", 0, 0, 0xFFFF, 0xFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0))

    return make


def _element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def _matrix(name: bytes, kind: int, shape: tuple[int, ...], *content: bytes) -> bytes:
    """Return a matrix of a MAT file: class, shape, name and what follows."""
    flags, sizes = struct.pack("<II", kind, 0), struct.pack(f"<{len(shape)}i", *shape)
    return _element(14, _element(6, flags) + _element(5, sizes) + _element(1, name) + b"".join(content))


def _matlab(*matrices: bytes, squeezed: bool = True) -> Callable[[Path], None]:
    """Return what writes a MAT file of version 5; a matrix that is packed already begins with its tag."""

    def make(path: Path) -> None:
        head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")
        parts = [each if not squeezed or each[:4] == struct.pack("<I", 15) else _squeezed(each) for each in matrices]
        path.write_bytes(head + b"".join(parts))

    return make


def _squeezed(data: bytes) -> bytes:
    packed = zlib.compress(data)
    return struct.pack("<II", 15, len(packed)) + packed


def _zeros(matrix: bytes, count: int) -> bytes:
    """Return a packed element: the beginning of a matrix and so many zeros."""
    packer = zlib.compressobj(9)
    packed = packer.compress(matrix)
    for _ in range(count // 1_000_000):
        packed += packer.compress(bytes(1_000_000))
    packed += packer.flush()
    return struct.pack("<II", 15, len(packed)) + packed


def _plain_matlab(path: Path) -> None:
    import scipy.io

    scipy.io.savemat(path, {"run": {"y": _NOISE, "info": {"rate": 20_000.0}}}, do_compression=True)


def _bomb_in_a_structure() -> bytes:
    head = struct.pack("<II", 14, 2_000_000_100) + _element(6, struct.pack("<II", 2, 0)) + _element(5, struct.pack("<2i", 1, 1)) + _element(1, b"run")
    head += struct.pack("<HHI", 5, 4, 2) + _element(1, b"y\0")
    inner = struct.pack("<II", 14, 2_000_000_000) + _element(6, struct.pack("<II", 6, 0)) + _element(5, struct.pack("<2i", 250_000_000, 1))
    return _zeros(head + inner + _element(1, b"") + struct.pack("<II", 9, 1_999_999_900), 2_000_000_000)


def _nested(levels: int) -> bytes:
    inside = _matrix(b"", 6, (1, 1), _element(9, bytes(8)))
    for _ in range(levels):
        inside = _matrix(b"", 1, (1, 1), inside)
    return inside


def _hdf5(build: Callable[[object], None]) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        import h5py

        with h5py.File(path, "w") as stream:
            build(stream)

    return make


def _plain_hdf5(path: Path) -> None:
    _hdf5(lambda stream: stream.create_dataset("a", data=_NOISE).attrs.__setitem__("rate", 20_000.0))(path)


def _many_groups(stream) -> None:
    for k in range(6_000):
        stream.create_dataset(f"d{k}", data=1.0)


def _large_attribute(stream) -> None:
    stream.create_dataset("a", data=_NOISE, compression="gzip")
    stream.attrs["rate"] = 20_000.0
    for k in range(100):
        stream.attrs[f"n{k}"] = np.zeros(8000)


def _external(target: str) -> Callable[[Path], None]:
    return _hdf5(lambda stream: stream.create_dataset("a", (20_000,), "u1", external=[(target, 0, 20_000)]))


def _virtual(stream) -> None:
    import h5py

    layout = h5py.VirtualLayout((20_000,), "f8")
    layout[:] = h5py.VirtualSource("/dev/zero", "a", (20_000,))
    stream.create_virtual_dataset("a", layout)


def _wave(form: int = 3, channels: int = 1, rate: int = 20_000, bits: int = 64, size: int | None = None, data: bytes = b"") -> bytes:
    """Return a WAV file with a heading of a stranger."""
    step = max(channels * bits // 8, 0) & 0xFFFF
    heading = struct.pack("<HHIIHH", form, channels, rate, (rate * step) & 0xFFFFFFFF, step, bits)
    chunk = struct.pack("<4sI", b"data", len(data) if size is None else size) + data
    body = b"WAVE" + struct.pack("<4sI", b"fmt ", len(heading)) + heading + chunk
    return struct.pack("<4sI", b"RIFF", len(body) & 0xFFFFFFFF) + body


def _long_wave(data: bytes) -> bytes:
    sizes = struct.pack("<4sIQQQ", b"ds64", 24, 2**63, 2**63, 2**63)
    return b"RF64\xff\xff\xff\xffWAVE" + sizes + _wave(size=0xFFFFFFFF, data=data)[12:]


def _recording(blocks: Iterable[tuple[object, int]], kind: str = "std_msgs/msg/Float64MultiArray") -> Callable[[Path], None]:
    """Return what writes a recording of blocks with the rates that they state."""

    def make(path: Path) -> None:
        from bearing_sim.recording.writer import McapFile

        with McapFile(path) as recording:
            for number, (values, rate) in enumerate(blocks):
                dimensions = [{"label": "rate", "size": rate, "stride": 0}]
                message = {"layout": {"dim": dimensions, "data_offset": 0}, "data": np.asarray(values, float)}
                recording.write("/acceleration", kind, 1_700_000_000_000_000_000 + number * 50_000_000, message)

    return make


def _response(change: Callable[[Path], object]) -> Callable[[], None]:
    """Return what puts a changed response in the place of a scene's, in a folder of its own, and asks for it as node and commands do."""

    def ask() -> None:
        import click

        from bearing_sim.watchers.estimation import response

        response.FOLDER = Path("kept").absolute()
        response.FOLDER.mkdir()
        chosen = asking_scene()
        path = response.response_path(chosen)
        change(path)
        found = response.kept_response(chosen)
        if found is not None:
            click.echo("a response was read")
            return
        click.echo("Error: none that is whole", err=True)
        raise SystemExit(1)

    return ask


def _signed(members: Callable[[], bytes]) -> Callable[[Path], None]:
    """Return what writes a content with the checksum that fits it, as somebody does who means harm."""

    def write(path: Path) -> None:
        import hashlib

        data = members()
        path.write_bytes(data + hashlib.sha256(data).digest())

    return write


@cache
def _whole_response() -> dict[str, np.ndarray]:
    """Return what is in the file of a whole response, by name."""
    from bearing_sim.watchers.estimation.response import write_response

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "whole.npz"
        write_response(path, made_up_response(asking_scene()))
        with np.load(io.BytesIO(path.read_bytes()[:-32])) as found:
            return dict(found)


def _response_of(**changes: object) -> Callable[[], bytes]:
    """Return what makes the content of a response with some of it changed: an array, or a value of its description; None leaves it out."""

    def make() -> bytes:
        arrays = dict(_whole_response())
        written = json.loads(arrays["written"].tobytes())
        written |= {name: value for name, value in changes.items() if name in written}
        arrays |= {name: value for name, value in changes.items() if name not in written}
        arrays["written"] = np.frombuffer(json.dumps(written).encode(), np.uint8)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **{name: value for name, value in arrays.items() if value is not None})
        return buffer.getvalue()

    return make


def _archived(members: Callable[[], Iterable[tuple[str, bytes]]]) -> Callable[[], bytes]:
    def make() -> bytes:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in members():
                archive.writestr(name, data)
        return buffer.getvalue()

    return make


class _Harmful:
    def __reduce__(self):
        return os.system, ("touch harmed",)


def _pickled() -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, written=np.array([_Harmful()], dtype=object))
    return buffer.getvalue()


_FORMATS = {
    "csv": lambda path: path.write_text(_TEXT),
    "parquet": _parquet(lambda: {"acceleration": _NOISE}),
    "npz": _numpy,
    "npy": lambda path: np.save(path, _NOISE),
    "mat": _plain_matlab,
    "h5": _plain_hdf5,
    "wav": lambda path: path.write_bytes(_wave(data=_NOISE.tobytes())),
    "mcap": _recording([(_NOISE[k : k + 1000], 20_000) for k in range(0, 20_000, 1000)]),
}


def _of_every_format() -> list[Case]:
    """Return what can be in the place of a record whatever its format."""
    cases = []
    for suffix, make in _FORMATS.items():
        name, label = f"record.{suffix}", f"vibration {suffix.upper()}"
        cases += [
            Case(f"{label}: a pipe", fifo(name), _read(name, *_RATE)),
            Case(f"{label}: /dev/zero", link(name, "/dev/zero"), _read(name, *_RATE)),
            Case(f"{label}: a link to nothing", link(name, "gone"), _read(name, *_RATE)),
            Case(f"{label}: 10 GB of zeros", sparse(name, _TEN_GIGABYTE), _read(name, *_RATE)),
            Case(f"{label}: 900 MB of zeros", sparse(name, 900_000_000), _read(name, *_RATE)),
            Case(f"{label}: nothing in it", file(name, b""), _read(name, *_RATE)),
            Case(f"{label}: random bytes", file(name, random.Random(suffix).randbytes(100_000)), _read(name, *_RATE)),
            _made("cut", name, _flipped(make, 3, 0), *_RATE, accepted=_NO_LINE if suffix == "csv" else ""),
        ]
    return cases


CASES = [
    *_of_every_format(),
    _text("one sample", "1.0\n"),
    _text("1023 samples", "".join(f"{value}\n" for value in _NOISE[:1023])),
    _text("constant", "1.0\n" * 20_000),
    _text("NaN", _TEXT + "nan\n"),
    _text("only NaN", "nan\n" * 20_000),
    _text("1e990000", _TEXT + "1e990000\n"),
    _text("numbers of 10,000 digits", lambda: (b"9" * 10_000 + b"\n") * 2000),
    _text("values of 1e308", "1e308\n-1e308\n" * 10_000),
    _text("values of 5e-324", "5e-324\n0\n" * 10_000),
    _text("one knock of 1e300", _TEXT + "1e300\n"),
    _text("a line of 100 MB", lambda: b"1," * 50_000_000),
    _text("100 MB without line ends", lambda: b"1" * 100_000_000),
    _text("100 million rows", lambda: b"1\n" * 100_000_000),
    _text("450 million empty lines", lambda: b"\n" * 450_000_000),
    _text("100,000 columns", ",".join(["1"] * 100_000) + "\n" + ",".join(["2"] * 100_000)),
    _text("a heading of 10 MB", lambda: b"x" * 10_000_000 + b"\n" + _TEXT.encode()),
    _text("a heading that acts on a terminal", "\x1b]0;x\x07,\x1b[31m\n" + "1,2\n" * 2000),
    _text("Latin-1", "Zeit [\u00b5s]\n".encode("latin-1") + _TEXT.encode()),
    _text("UTF-16 cut within a letter", ("a\n" + _TEXT).encode("utf-16")[:-1]),
    _text("zeros between", _TEXT.replace("\n", "\0\n")),
    _text("times that go back", "time,a\n" + "".join(f"{-k},{value}\n" for k, value in enumerate(_NOISE)), "--channel", "a"),
    _text("times that stand still", "time,a\n" + "".join(f"1,{value}\n" for value in _NOISE), "--channel", "a"),
    _text("times that are no numbers", "time,a\n" + "".join(f"nan,{value}\n" for value in _NOISE), "--channel", "a"),
    _text("one time that is no number", "time,a\n" + "".join(f"{'nan' if k == 99 else k},{v}\n" for k, v in enumerate(_NOISE)), "--channel", "a"),
    _text("times without end", "time,a\n" + "".join(f"{k}e304,{value}\n" for k, value in enumerate(_NOISE)), "--channel", "a"),
    _text("times 1e-300 s apart", "time,a\n" + "".join(f"{k}e-300,{value}\n" for k, value in enumerate(_NOISE)), "--channel", "a"),
    _text("a speed that is no number", "a,n\n" + "".join(f"{value},nan\n" for value in _NOISE), *_RATE, "--channel", "a", "--speed-channel", "n"),
    _text("a rate of 1e300 Hz", _TEXT, "--rate", "1e300 Hz"),
    _text("a rate of 1e-300 Hz", _TEXT, "--rate", "1e-300 Hz"),
    _text("a rate of infinity", _TEXT, "--rate", "inf Hz"),
    _text("a channel that acts on a terminal", "a,b\n" + "1,2\n" * 2000, *_RATE, "--channel", "\x1b[31m"),
    _made("40 million samples", "record.npy", lambda path: np.save(path, np.resize(_NOISE, 40_000_000).astype(np.int8)), *_RATE),
    _made("60 million rows", "record.parquet", _parquet(lambda: {"a": np.zeros(60_000_000, np.int8)}), *_RATE),
    _made("texts of 1 TB", "record.parquet", _parquet(_wide_texts), *_RATE, accepted=_NO_LINE),
    _made("one row of 60 million", "record.parquet", _parquet(_long_list), *_RATE),
    _made("only texts", "record.parquet", _parquet(lambda: {"a": ["x"] * 2000}), *_RATE),
    _made("20,000 columns", "record.parquet", _parquet(lambda: {f"c{k}": [1.0] for k in range(20_000)}), *_RATE),
    _made("empty values", "record.parquet", _parquet(lambda: {"a": [None, *_NOISE.tolist()]}), *_RATE),
    *(_made(f"flipped {k}", "record.parquet", _flipped(_FORMATS["parquet"], k, 40, -500), *_RATE) for k in range(2)),
    _made("an archive that unpacks to 2 GB", "record.npz", _archive(lambda: [(f"{k}.npy", bytes(500_000_000)) for k in range(4)]), *_RATE),
    _made("an array of 2^62 numbers", "record.npz", _archive(lambda: [("a.npy", _array_file(f"({2**62},)"))]), *_RATE),
    _made("an array of 40 million texts", "record.npz", _archive(lambda: [("a.npy", _array_file("(40000000,)", "'|S1000000'"))]), *_RATE),
    _made("a negative shape", "record.npz", _archive(lambda: [("a.npy", _array_file("(-1,)"))]), *_RATE),
    _made("a type with 1 GB", "record.npz", _archive(lambda: [("a.npy", _array_file("(1,)", "[('a', '<f8', (1000, 1000, 1000))]"))]), *_RATE),
    _made("100,000 arrays", "record.npz", _archive(lambda: ((f"{k}.npy", _array_file("(1,)", data=bytes(8))) for k in range(100_000)), 0), *_RATE),
    _made("a directory of 2 million members", "record.npz", _directory_of(2_000_000), *_RATE),
    _made("members of other kinds", "record.npz", _archive(lambda: [("a.txt", b"1\n2\n")]), *_RATE),
    _made("pickled", "record.npz", lambda path: path.write_bytes(_pickled()), *_RATE),
    _made("a rate that is no number", "record.npz", lambda path: np.savez(path, a=_NOISE, fs=np.nan)),
    _made("a rate of infinity", "record.npz", lambda path: np.savez(path, a=_NOISE, fs=np.inf)),
    _made("two rates", "record.npz", lambda path: np.savez(path, a=_NOISE, fs=1e4, rate=2e4)),
    *(_made(f"flipped {k}", "record.npz", _flipped(_numpy, k, 40)) for k in range(2)),
    _made("an array of 2^62 numbers", "record.npy", lambda path: path.write_bytes(_array_file(f"({2**62},)")), *_RATE),
    _made("an array of 10^9 numbers that are not there", "record.npy", lambda path: path.write_bytes(_array_file("(1000000000,)")), *_RATE),
    _made("an archive", "record.npy", lambda path: path.write_bytes(_archived(lambda: [("a.npy", bytes(9))])()), *_RATE),
    _made("pickled", "record.npy", lambda path: np.save(path, np.array([_Harmful()], dtype=object), allow_pickle=True), *_RATE),
    _made("a heading that is a program", "record.npy", lambda path: path.write_bytes(_array_file("__import__('os').getpid()")), *_RATE),
    _made("complex numbers", "record.npy", lambda path: np.save(path, _NOISE * 1j), *_RATE),
    _made("a structure that unpacks to 2 GB", "record.mat", lambda path: _matlab(_bomb_in_a_structure())(path), *_RATE),
    _made("a matrix that says it has 2^31 numbers", "record.mat", _matlab(_matrix(b"y", 6, (2**30, 2), _element(9, bytes(80)))), *_RATE),
    _made("a negative size", "record.mat", _matlab(_matrix(b"y", 6, (-1, 20_000), _element(9, bytes(80)))), *_RATE),
    _made("2^31 cells", "record.mat", _matlab(_matrix(b"y", 1, (2**31 - 1, 1)), squeezed=False), *_RATE),
    _made(
        "10 million empty cells",
        "record.mat",
        lambda path: _matlab(_matrix(b"y", 1, (10_000_000, 1), struct.pack("<II", 14, 0) * 10_000_000))(path),
        *_RATE,
    ),
    _made("2,000 cells within cells", "record.mat", _matlab(_nested(2000)), *_RATE),
    _made(
        "100,000 variables",
        "record.mat",
        lambda path: _matlab(*[_matrix(b"v%d" % k, 6, (1, 1), _element(9, bytes(8))) for k in range(100_000)])(path),
        *_RATE,
    ),
    _made("an element longer than the file", "record.mat", _matlab(_matrix(b"y", 6, (1, 9), _element(9, bytes(72)))[:60], squeezed=False), *_RATE),
    *(_made(f"flipped {k}", "record.mat", _flipped(_plain_matlab, k, 40, 128), *_RATE) for k in range(2)),
    _made("60 million numbers", "record.h5", _hdf5(lambda stream: stream.create_dataset("a", (60_000_000,), "f8")), *_RATE),
    _made("2^62 numbers", "record.h5", _hdf5(lambda stream: stream.create_dataset("a", (2**60,), "i1", chunks=(1000,))), *_RATE),
    _made(
        "a hundred arrays of 40 million numbers",
        "record.h5",
        _hdf5(lambda stream: [stream.create_dataset(f"a{k}", (40_000_000,), "f8", chunks=(1000,)) for k in range(100)]),
        *_RATE,
    ),
    _made(
        "few numbers in a piece of 4 GB",
        "record.h5",
        _hdf5(lambda stream: stream.create_dataset("a", (2000,), "i1", maxshape=(None,), chunks=(2**32 - 1,), compression="gzip")),
        *_RATE,
    ),
    _made("numbers in /dev/zero", "record.h5", _external("/dev/zero"), *_RATE),
    _made("numbers in a secret file", "record.h5", _external("/etc/passwd"), *_RATE),
    Case(
        "vibration H5: numbers in a pipe", lambda folder: (fifo("pipe")(folder), _external("pipe")(folder / "record.h5")), _read("record.h5", *_RATE)
    ),
    _made("numbers in another HDF5 file", "record.h5", _hdf5(_virtual), *_RATE),
    _made("6,000 data sets", "record.h5", _hdf5(_many_groups), *_RATE),
    _made("attributes of 6 MB", "record.h5", _hdf5(_large_attribute), accepted=_NO_LINE),
    _made("a link to itself", "record.h5", _hdf5(lambda stream: stream.__setitem__("a", stream)), *_RATE),
    *(_made(f"flipped {k}", "record.h5", _flipped(_plain_hdf5, k, 20), *_RATE) for k in (0, 1, 2, 4, 5)),
    _made("4 GB that are not there", "record.wav", lambda path: path.write_bytes(_wave(size=2**32 - 8, data=_NOISE.tobytes()))),
    _made("2^63 bytes", "record.wav", lambda path: path.write_bytes(_long_wave(_NOISE.tobytes()))),
    _made("10 million empty chunks", "record.wav", lambda path: path.write_bytes(_wave(data=_NOISE.tobytes()) + b"abcd\0\0\0\0" * 10_000_000)),
    _made("a rate of 0", "record.wav", lambda path: path.write_bytes(_wave(rate=0, data=_NOISE.tobytes()))),
    _made("no channels", "record.wav", lambda path: path.write_bytes(_wave(channels=0, data=_NOISE.tobytes()))),
    _made("65,535 channels", "record.wav", lambda path: path.write_bytes(_wave(channels=65_535, data=_NOISE.tobytes()))),
    _made("samples of 7 bits", "record.wav", lambda path: path.write_bytes(_wave(form=1, bits=7, data=_NOISE.tobytes()))),
    _made("samples of 0 bits", "record.wav", lambda path: path.write_bytes(_wave(bits=0, data=_NOISE.tobytes()))),
    _made("an unknown form", "record.wav", lambda path: path.write_bytes(_wave(form=0x55, data=_NOISE.tobytes()))),
    _made("blocks of two rates", "record.mcap", _recording([(_NOISE, 20_000), (_NOISE, 10_000)])),
    _made("a rate of 2^32", "record.mcap", _recording([(_NOISE, 2**32 - 1)] * 2)),
    _made("NaN", "record.mcap", _recording([(_NOISE * np.nan, 20_000)] * 2)),
    _made("50,000 empty blocks", "record.mcap", _recording([((), 20_000)] * 50_000)),
    _made("60 million numbers", "record.mcap", _recording([(np.zeros(1_000_000), 20_000)] * 60)),
    Case("response: a whole one", lambda folder: None, _response(_signed(_response_of())), "nothing is wrong with it"),
    *(
        Case(f"response: {name}", lambda folder: None, _response(change))
        for name, change in {
            "nothing in it": lambda path: path.write_bytes(b""),
            "a pipe": os.mkfifo,
            "/dev/zero": lambda path: path.symlink_to("/dev/zero"),
            "a folder": Path.mkdir,
            "10 GB of zeros": lambda path: sparse(path.name, _TEN_GIGABYTE)(path.parent),
            "cut": lambda path: (_signed(_response_of())(path), path.write_bytes(path.read_bytes()[:-700])),
            "flipped": _flipped(_signed(_response_of()), 1, 3),
            "pickled": _signed(_pickled),
            "an array of 2 GB": _signed(_archived(lambda: [("written.npy", _array_file("(2000000000,)", "'|u1'") + bytes(200_000_000))])),
            "an array of 2^62 numbers": _signed(_archived(lambda: [("written.npy", _array_file(f"({2**62},)"))])),
            "a directory of 2 million members": lambda path: (_directory_of(2_000_000)(path), _signed(path.read_bytes)(path)),
            "a description that nests": _signed(_archived(lambda: [("written.npy", _array_file("(100000,)", "'|u1'", b"[" * 100_000))])),
            "weights of another shape": _signed(_response_of(weights=np.zeros((2, 2)))),
            "weights that are no numbers": lambda path: _signed(_response_of(weights=np.nan * _whole_response()["weights"]))(path),
            "texts instead of weights": _signed(_response_of(weights=np.array([["x"]]))),
            "no weights": _signed(_response_of(weights=None)),
            "terms of degree 10^9": _signed(_response_of(score_terms=np.full((3, 1), 10**9))),
            "fields of another scene": _signed(_response_of(ranges=[])),
            "a range that ends before it begins": _signed(_response_of(ranges=[{"field": "a", "low": 2.0, "high": 1.0}])),
            "a domain of texts": _signed(_response_of(domain={"speeds": "x", "loads": "y", "temperatures": "z", "period": "", "mirror": ""})),
        }.items()
    ),
]
