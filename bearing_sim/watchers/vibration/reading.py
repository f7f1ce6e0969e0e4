# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Vibration records of any logger: text, Parquet, MAT, NPZ and NPY, WAV, HDF5, TDMS, universal files, and recordings (MCAP and other bags).

A file is taken as channels: names with numbers.  Which of them is the vibration follows from its name where it is given, or where only one is
long enough to be it; the rate from the file where it says one, or from its column of times.  What may mean two things is asked for.
"""

import io
import itertools
import math
import re
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from bearing_sim.files.extras import what_is_missing
from bearing_sim.files.labview_text import plain_lines
from bearing_sim.files.limits import TABLE_LINE, VIBRATION_FILE, VIBRATION_PARTS, VIBRATION_SAMPLES, VIBRATION_TEXT, FileError, LimitError, printable
from bearing_sim.files.reading import encoding_by_mark, open_regular
from bearing_sim.files.tally import Tally
from bearing_sim.recording.bag_reader import BagReader, BagTopic
from bearing_sim.scene.errors import did_you_mean
from bearing_sim.scene.quantity import to_si
from bearing_sim.watchers.vibration.signal import FEWEST_SAMPLES, Vibration, VibrationError

_RATE_NAMES = re.compile(r"(?:^|[^a-z])(?:fs|sr|rate|sampling_?rate|sample_?rate|sampling_?frequency|samples_per_second)(?:_?hz)?$", re.IGNORECASE)
_TIME_NAMES = re.compile(r"(?:^|[^a-z])(?:t|time|times|timestamp|seconds|x_value)(?:_?s)?(?:\s*[\[(].*)?$", re.IGNORECASE)
_UNIT = re.compile(r"[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_FIRST_LINES = 200
_MOST_SHOWN = 12
_MOST_DESCRIBED = 3
_DEEPEST = 8  # levels of structures in a MAT or HDF5 file
_MOST_CHANNELS = 2000
_UNEVEN = 0.01  # of the spacing of times
_HIGHEST_RATE = 1e7  # Hz, the most that a scene takes, see `bearing_sim.scene.vibration`
_ROUNDINGS = 1.5  # between times and those of an even rate, if they are only rounded
_COMMENTS = ("#", "%", "//")
_PIECE = 1 << 20  # [byte] that is unpacked at once
_MAT_MATRIX, _MAT_COMPRESSED = 14, 15  # types of elements of a MAT file
_MAT_TAGS = 8  # elements of a usual matrix, and some more
_DEEPEST_MAT = 32
_ARCHIVE_END = 22 + 65_535  # [byte] in which the end of an archive stands, with its comment
_SHORTEST_MEMBER = 46  # [byte] in the list of an archive's members
_COMPLEX, _OBJECTS, _CELLS, _SPARSE = "complex numbers", "Python objects", "cells or objects", "a sparse matrix"
_KINDS = {"c": _COMPLEX, "U": "texts", "S": "texts", "M": "dates", "m": "spans of time", "V": "bytes"}  # by kind of NumPy type
_EXPECTED = {
    _COMPLEX: "expected the measured signal, which is real: save that, or the real part if the other is zero",
    _OBJECTS: "these are not read, because they can run programs; expected numbers: save numpy.asarray(ARRAY, float)",
    _CELLS: "expected one array of numbers: save cell2mat(...) or [...{:}] of them",
    _SPARSE: "expected an array of numbers: save full(...) of it",
}


class Unusable(NamedTuple):
    """An array of something else than real numbers.

    Attributes
    ----------
    holds : what it holds, in words.
    may_be_meant : whether it may be the vibration, saved in a wrong way.
    """

    holds: str
    may_be_meant: bool

    def describe(self, name: str) -> str:
        """Return what is wrong with it, and what was expected."""
        return f"{printable(name)} holds {self.holds}; {_EXPECTED.get(self.holds, 'expected real numbers')}"


class Channels:
    """The numbers in a file.

    Attributes
    ----------
    path : of the file.
    form : name of its format, for messages.
    arrays : by name, shape (n,) each.
    numbers : single numbers by name, among them perhaps the rate.
    rate : of the samples [Hz], if the format has one.
    unusable : arrays that do not hold real numbers, by name.
    tally : what of a bag was read; None of other formats, which are read whole or not at all.
    """

    def __init__(self, path: Path, form: str):
        self.path, self.form = path, form
        self.arrays: dict[str, np.ndarray] = {}
        self.numbers: dict[str, float] = {}
        self.unusable: dict[str, Unusable] = {}
        self.rate: float | None = None
        self.tally, self._values = None, 0

    def add(self, name: str, value, depth: int = 0) -> None:
        """Add an array of any shape, a number, or what a structure holds; of anything else only its name and what it holds."""
        if depth > _DEEPEST or len(self.arrays) >= _MOST_CHANNELS:
            return
        value = np.asarray(value)
        if value.dtype.names:
            for field in value.dtype.names:
                self.add(f"{name}.{field}", value[field], depth + 1)
        elif value.dtype == object:
            if value.size >= FEWEST_SAMPLES:
                self.pass_over(name, _CELLS, value.size)
            for index, item in enumerate(value.ravel()[:_MOST_CHANNELS]):
                self.add(name if value.size == 1 else f"{name}[{index}]", item, depth + 1)
        elif value.dtype.kind not in "iufb":
            self.pass_over(name, _KINDS.get(value.dtype.kind, f"values of the type {value.dtype}"), value.size)
        elif (value := np.squeeze(value)).ndim > 2:
            self.pass_over(name, f"numbers in {value.ndim} dimensions", value.size)
        elif value.ndim == 0:
            self.numbers[name] = float(value)
        else:
            self.count(value.size)
            if value.ndim == 1:
                self.arrays[name] = value
                return
            columns = value if value.shape[1] <= value.shape[0] else value.T
            for index, column in enumerate(columns.T[:_MOST_CHANNELS]):
                self.arrays[f"{name}[{index}]"] = column

    def add_loaded(self, name: str, load: Callable[[], np.ndarray]) -> None:
        """Add what ``load`` returns; Python objects, which NumPy refuses to read, are passed over."""
        try:
            value = load()
        except ValueError as error:
            if "allow_pickle" not in str(error):
                raise
            self.pass_over(name, _OBJECTS, FEWEST_SAMPLES)  # how many they are is not known without reading them
        else:
            self.add(name, value)

    def pass_over(self, name: str, holds: str, count: int) -> None:
        """Keep the name of an array that cannot be used, with what it holds and how many."""
        if len(self.unusable) < _MOST_CHANNELS:
            self.unusable[name] = Unusable(holds, count >= FEWEST_SAMPLES and holds in _EXPECTED)

    def count(self, values: int) -> None:
        """Refuse more numbers than the limit; raise LimitError."""
        self._values += values
        VIBRATION_SAMPLES.check(self._values, str(self.path))


def read_vibration(
    path: str | Path,
    channel: str | None = None,
    rate: float | None = None,
    time_channel: str | None = None,
    speed_channel: str | None = None,
    speed_unit: str = "rpm",
) -> Vibration:
    """Read a vibration record.

    Parameters
    ----------
    path : of the file, or of a bag's folder.
    channel : name of the vibration in it: of a column, variable or data set, ``name[k]`` for the column k of a matrix, or ``/topic.field`` of a
        recording; None if there is only one.
    rate : of the samples [Hz]; None if the file says it.
    time_channel : name of the times [s]; None if none is needed, or it is called so.
    speed_channel : name of the shaft speed, which must have as many values as the vibration; None if there is none.
    speed_unit : of these speeds.

    Raises
    ------
    FileError
        The file cannot be read, or is larger than a limit.
    VibrationError
        It has no such channel, or no rate; the message lists what it has.
    """
    path = Path(path)
    form, reader = ("bag", _bag) if path.is_dir() else FORMATS.get(path.suffix.lower(), ("", None))
    if reader is None:
        raise VibrationError(f"{path}: no format is known by this name; expected one that ends in {', '.join(FORMATS)}, or the folder of a bag")
    found = Channels(path, form)
    if reader is _bag:
        _bag(found, tuple(name for name in (channel, speed_channel) if name))
    else:
        _read(found, reader)
    name = channel or _only_channel(found, time_channel, speed_channel)
    samples = _array(found, name, "--channel")
    speeds = None
    if speed_channel is not None:
        speeds = _array(found, speed_channel, "--speed-channel")
        if len(speeds) != len(samples):
            raise VibrationError(f"{path}: {speed_channel} has {len(speeds)} values and {name} {len(samples)}; expected as many of each")
        speeds = speeds * _factor(speed_unit)
    rate, note = (rate, "") if rate is not None else _rate(found, time_channel, len(samples))
    if rate > _HIGHEST_RATE:
        raise VibrationError(
            f"{path}: a sampling rate of {rate:.4g} Hz; expected at most {_HIGHEST_RATE:g} Hz: check --rate, or the unit of the times"
        )
    return Vibration(samples, rate, f"{path.name}, {printable(name)}{note}", speeds, found.tally)


def _factor(unit: str) -> float:
    try:
        return to_si(f"1 {unit}", "rad/s")
    except ValueError as error:
        raise VibrationError(f"--speed-unit {unit}: {error}") from None


def _listed(names) -> str:
    shown = [printable(each) for each in names]
    return ", ".join(shown[:_MOST_SHOWN]) + (f", and {len(shown) - _MOST_SHOWN} more" if len(shown) > _MOST_SHOWN else "") if shown else "none"


def _array(found: Channels, name: str, option: str) -> np.ndarray:
    if name in found.arrays:
        with np.errstate(invalid="ignore"):  # of numbers that are none, which the record refuses
            return np.asarray(found.arrays[name], float)
    for whole in (name, name.rpartition("[")[0]):
        if whole in found.unusable:
            raise VibrationError(f"{found.path}: {found.unusable[whole].describe(whole)}")
    raise VibrationError(
        f"{found.path}: no channel {name!r}{did_you_mean(name, list(found.arrays))}; there are {_listed(found.arrays)}; choose one with {option}"
    )


def _only_channel(found: Channels, time_channel: str | None, speed_channel: str | None) -> str:
    """Return the name of the channel that must be the vibration, because no other is long enough."""
    given = {time_channel, speed_channel}
    names = [name for name in found.arrays if name not in given and not _TIME_NAMES.search(name) and len(found.arrays[name]) >= FEWEST_SAMPLES]
    doubtful = [name for name, array in found.unusable.items() if array.may_be_meant and name not in given]
    if len(names) == 1 and not doubtful:
        return names[0]
    others = doubtful or list(found.unusable)
    beside = "".join(f"; {found.unusable[name].describe(name)}" for name in others[:_MOST_DESCRIBED])
    beside += f"; {len(others) - _MOST_DESCRIBED} more are not of real numbers" if len(others) > _MOST_DESCRIBED else ""
    if not names:
        raise VibrationError(f"{found.path}: no channel of at least {FEWEST_SAMPLES} numbers; it has {_listed(found.arrays)}{beside}")
    raise VibrationError(
        f"{found.path}: which channel is the vibration? there are {_listed(names)}; choose one with --channel{beside if doubtful else ''}"
    )


def _rate(found: Channels, time_channel: str | None, count: int) -> tuple[float, str]:
    """Return the rate of the samples by the file, and what is to be said about it."""
    note = ""
    if time_channel is None and found.rate is not None:
        return found.rate, note
    if time_channel is None:
        rates = {name: value for name, value in found.numbers.items() if _RATE_NAMES.search(name) and value > 0.0}
        if len(set(rates.values())) == 1:
            return next(iter(rates.values())), note
        if rates:
            listed = ", ".join(f"{printable(name)} = {value:g}" for name, value in rates.items())
            raise VibrationError(f"{found.path}: {listed}; choose one with --rate")
    names = [time_channel] if time_channel else [name for name, array in found.arrays.items() if _TIME_NAMES.search(name) and len(array) == count]
    if len(names) != 1:
        raise VibrationError(f"{found.path}: the file does not say its sampling rate; give it with --rate, such as --rate 50kHz")
    times = _array(found, names[0], "--time-channel")
    steps = np.diff(times)
    changes = np.flatnonzero(steps) + 1
    if len(times) != count or len(changes) < 2 or not steps.min() >= 0.0:
        raise VibrationError(f"{found.path}: {names[0]} is no column of increasing times; give the sampling rate with --rate")
    mean, usual = float(times[-1] - times[0]) / (count - 1), float(np.median(steps))
    if abs(mean - usual) > _UNEVEN * usual:  # times with fewer digits than their steps need, or a gap
        mean = float(times[changes[-1]] - times[changes[0]]) / float(changes[-1] - changes[0])
        off = np.abs(times - times[changes[0]] - mean * (np.arange(count) - changes[0]))
        if off.max() > _ROUNDINGS * float(np.median(steps[steps > 0.0])):
            worst = int(np.argmax(np.abs(steps - mean)))
            raise VibrationError(
                f"{found.path}: {names[0]} has a gap: {times[worst]:g} is followed by {times[worst + 1]:g}; expected equal steps:"
                " cut the record there"
            )
        note = f"; {printable(names[0])} has rounded times, so the rate is the mean one"
    unit = _UNIT.search(names[0])
    seconds = {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}.get(unit[1] if unit else "", 1.0)
    return 1.0 / (mean * seconds), note


def _read(found: Channels, reader: Callable[[BinaryIO, Channels], None]) -> None:
    """Read a file; a damaged one makes its reader raise exceptions of any kind."""
    with open_regular(found.path, VIBRATION_FILE) as stream:
        try:
            reader(stream, found)
        except (FileError, VibrationError):
            raise
        except ModuleNotFoundError as error:
            raise VibrationError(f"{found.path}: {what_is_missing(error)}") from None
        except Exception as error:
            reason = "it asks for more memory than there is" if isinstance(error, MemoryError) else printable(" ".join(str(error).split()))
            raise FileError(f"cannot be read as {found.form}: {reason or type(error).__name__}", str(found.path)) from None


def _lines(path: Path) -> Iterator[str]:
    """Yield the lines of a text in UTF-8, or in the encoding of its byte-order mark; nothing but the present one is kept."""
    number, longest, most = 0, TABLE_LINE.value, VIBRATION_TEXT.value
    with open_regular(path, VIBRATION_FILE) as stream:
        encoding = encoding_by_mark(stream.peek(4)[:4])
        text = io.TextIOWrapper(stream, encoding=encoding)
        try:
            while line := text.readline(longest + 1):
                number += 1
                if len(line) > longest:
                    raise LimitError(TABLE_LINE.refusal(), f"{path}, line {number}")
                if number > most:
                    raise LimitError(VIBRATION_TEXT.refusal(), str(path))
                yield line
        except UnicodeError:
            raise FileError(f"no {encoding.upper()} text from about line {number + 1} on; save the file as UTF-8", str(path)) from None


def _rows(path: Path, begin: int) -> Iterator[tuple[int, str]]:
    """Yield the lines of numbers of a text, with their numbers, from the line with the index ``begin`` on."""
    for number, line in enumerate(itertools.islice(plain_lines(_lines(path)), begin, None), begin + 1):
        if line.strip() and not line.lstrip().startswith(_COMMENTS):
            yield number, line


def _text(_, found: Channels) -> None:
    """Read the columns of a text: numbers between commas, semicolons, tabs or blanks, under headings or none."""
    path = found.path
    first_lines = list(itertools.islice(plain_lines(_lines(path)), _FIRST_LINES))
    begin, delimiter, decimal = _first_row(path, first_lines)
    heading = first_lines[begin - 1] if begin else ""
    names = [cell.strip().strip('"').lstrip("#% ") for cell in _cells(heading, delimiter)]
    width = len(_cells(first_lines[begin], delimiter))
    VIBRATION_PARTS.check(width, f"{path}, line {begin + 1}")
    if len(names) != width or any(_is_number(name, decimal) for name in names):
        names = [f"column {number}" for number in range(1, width + 1)]
    elif len(set(names)) < width:
        names = [f"{name} ({number})" for number, name in enumerate(names, 1)]

    def rows() -> Iterator[str]:
        for count, (_, line) in enumerate(_rows(path, begin), 1):
            if count * width > VIBRATION_TEXT.value:
                raise LimitError(VIBRATION_TEXT.refusal(), str(path))
            yield line.replace(",", ".") if decimal == "," else line

    try:
        table = np.loadtxt(rows(), delimiter=delimiter, ndmin=2, comments=None)
    except FileError:
        raise
    except ValueError:
        raise VibrationError(_first_fault(path, begin, delimiter, decimal, width)) from None
    found.arrays.update(zip(names, table.T))


def _cells(line: str, delimiter: str | None) -> list[str]:
    return line.split(delimiter) if delimiter else line.split()


def _is_number(text: str, decimal: str) -> bool:
    try:
        float(text.replace(decimal, "."))
    except ValueError:
        return False
    return True


def _first_row(path: Path, lines: list[str]) -> tuple[int, str | None, str]:
    """Return index of the first row of numbers, delimiter (None: blanks) and decimal mark."""
    for index, line in enumerate(lines[:_FIRST_LINES]):
        if not line.strip() or line.lstrip().startswith(_COMMENTS):
            continue
        for delimiter, decimal in ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (None, "."), (None, ",")):
            if delimiter is not None and delimiter not in line:
                continue
            if all(_is_number(cell.strip(), decimal) for cell in _cells(line, delimiter)):
                return index, delimiter, decimal
    raise VibrationError(f"{path}: no row of numbers in the first {min(len(lines), _FIRST_LINES)} lines; expected columns of numbers under a heading")


def _first_fault(path: Path, begin: int, delimiter: str | None, decimal: str, width: int) -> str:
    """Return what is wrong with the first row that cannot be read."""
    for number, line in _rows(path, begin):
        cells = _cells(line, delimiter)
        if len(cells) != width:
            return f"{path}, line {number}: {len(cells)} columns; expected {width}, as in line {begin + 1}"
        for cell in cells:
            if not _is_number(cell.strip(), decimal):
                return f"{path}, line {number}: {printable(cell.strip(), 40)!r} is no number; expected a record without gaps: cut it there"
    return f"{path}: cannot be read as columns of numbers"


def _parquet(stream: BinaryIO, found: Channels) -> None:
    import pyarrow
    import pyarrow.parquet

    types, file = pyarrow.types, pyarrow.parquet.ParquetFile(stream)
    VIBRATION_PARTS.check(len(file.schema_arrow), str(found.path))
    fields = []
    for each in file.schema_arrow:
        if types.is_floating(each.type) or types.is_integer(each.type) or types.is_timestamp(each.type):
            fields.append(each)
        else:
            is_meant = types.is_nested(each.type) or types.is_decimal(each.type)
            found.unusable[each.name] = Unusable(f"values of the type {printable(str(each.type), 60)}", is_meant)
    batches = []
    for batch in file.iter_batches(columns=[each.name for each in fields]):  # what the file says about its length need not be true
        found.count(batch.num_rows * batch.num_columns)
        batches.append(batch)
    table = pyarrow.Table.from_batches(batches, pyarrow.schema(fields)) if batches else pyarrow.table({})
    found.arrays |= {name: _numbers_of(column) for name, column in zip(table.column_names, table.columns)}


def _numbers_of(column) -> np.ndarray:
    """Return a column of Parquet as numbers, times in seconds."""
    import pyarrow

    if pyarrow.types.is_timestamp(column.type):
        return column.cast(pyarrow.timestamp("ns", column.type.tz)).cast(pyarrow.int64()).to_numpy() * 1e-9
    return column.to_numpy()


class _Content:
    """The content of a matrix of a MAT file, compressed or not, read once from its beginning and not kept."""

    def __init__(self, stream: BinaryIO, size: int, is_packed: bool):
        self._pieces = _unpacked(stream, size) if is_packed else _pieces(stream, size)
        self._ready, self.position = io.BytesIO(), 0

    def read(self, count: int) -> bytes:
        """Return the next bytes, fewer where it ends."""
        found = self._ready.read(count)
        while len(found) < count and (piece := next(self._pieces, None)) is not None:
            self._ready = io.BytesIO(piece)
            found += self._ready.read(count - len(found))
        self.position += len(found)
        return found

    def skip(self, count: int) -> None:
        """Pass over bytes."""
        while count > 0 and (found := self.read(min(count, _PIECE))):
            count -= len(found)


def _pieces(stream: BinaryIO, size: int) -> Iterator[bytes]:
    while size > 0 and (piece := stream.read(min(size, _PIECE))):
        size -= len(piece)
        yield piece


def _unpacked(stream: BinaryIO, size: int) -> Iterator[bytes]:
    unpacker = zlib.decompressobj()
    for piece in _pieces(stream, size):
        while piece and not unpacker.eof:
            yield unpacker.decompress(piece, _PIECE)
            piece = unpacker.unconsumed_tail


def _check_matlab(path: Path, stream: BinaryIO) -> None:
    """Refuse a MAT file of version 5 that unpacks to more than the limits allow, before its reader keeps anything of it.

    The elements of the format stand in "MAT-File Format" of The MathWorks: a tag of type and length, then data, or elements within a matrix.

    Raises
    ------
    LimitError
        It has more numbers or parts than the limits.
    FileError
        Cells or structures stand too deep within each other.
    """
    order = ">" if stream.read(128)[126:128] == b"MI" else "<"
    parts = unpacked = 0
    while len(tag := stream.read(8)) == 8:
        kind, size = struct.unpack(f"{order}II", tag)
        begin = stream.tell()
        if kind in (_MAT_COMPRESSED, _MAT_MATRIX):
            element = _Content(stream, size, kind == _MAT_COMPRESSED)
            ends = [8 if kind == _MAT_COMPRESSED else size]  # a compressed one begins with the tag of the matrix
            while ends:
                if element.position >= ends[-1] or len(inner := element.read(8)) < 8:
                    ends.pop()
                    continue
                parts += 1
                VIBRATION_PARTS.check(parts // _MAT_TAGS, str(path))
                inner_kind, length = struct.unpack(f"{order}II", inner)
                if inner_kind == _MAT_MATRIX:
                    ends.append(element.position + length)
                    if len(ends) > _DEEPEST_MAT:
                        raise FileError(f"cells or structures stand more than {_DEEPEST_MAT} deep within each other; expected a record", str(path))
                elif not inner_kind >> 16:  # a short element is its own tag
                    VIBRATION_SAMPLES.check((unpacked + length) // 8, str(path))
                    element.skip(length + -length % 8)
                    unpacked += length
        stream.seek(begin + size)


def _matlab(stream: BinaryIO, found: Channels) -> None:
    import scipy.io
    import scipy.sparse

    head, path = stream.read(128), str(found.path)
    stream.seek(0)
    if b"MATLAB 7.3" in head or head.startswith(b"\x89HDF"):
        found.form = "HDF5"
        return _hdf5(stream, found)
    if 0 not in head[:4]:  # version 4 begins with a number, and holds neither cells nor anything compressed
        _check_matlab(found.path, stream)
        stream.seek(0)
    shapes = scipy.io.whosmat(stream)
    VIBRATION_SAMPLES.check(sum(math.prod(shape) for _, shape, kind in shapes if kind not in ("struct", "cell")), path)
    stream.seek(0)
    for name, value in scipy.io.loadmat(stream).items():
        if name.startswith("__"):
            continue
        if scipy.sparse.issparse(value):
            found.pass_over(name, _SPARSE, math.prod(value.shape))
        elif isinstance(value, (scipy.io.matlab.MatlabOpaque, scipy.io.matlab.MatlabFunction)):
            found.pass_over(name, _CELLS, FEWEST_SAMPLES)  # of an object only its class is known
        else:
            found.add(name, value)


def _hdf5(stream: BinaryIO, found: Channels) -> None:
    import h5py

    parts, values, path = 0, 0, str(found.path)

    def held(kind: np.dtype) -> str:
        """Return what a data set holds that does not hold numbers."""
        if kind.names in (("r", "i"), ("real", "imag")):  # as MATLAB and others write complex numbers
            return _COMPLEX
        if h5py.check_string_dtype(kind) is not None:
            return "texts"
        if h5py.check_ref_dtype(kind) is not None:
            return _CELLS  # as MATLAB writes them
        return f"rows of the fields {_listed(kind.names)}" if kind.names else _KINDS.get(kind.kind, f"values of the type {kind}")

    def visit(name: str, item) -> None:
        nonlocal parts, values
        parts += 1 + len(item.attrs)
        VIBRATION_PARTS.check(parts, path)
        for key in item.attrs:
            attribute = item.attrs.get_id(key)
            if attribute.shape == () and attribute.dtype.kind in "iuf":
                found.numbers[f"{name}.{key}"] = float(item.attrs[key])
        if not isinstance(item, h5py.Dataset) or name.startswith("#refs#") or item.shape is None:  # a data set without a shape is empty
            return
        if item.dtype.kind not in "iuf":
            found.pass_over(name, held(item.dtype), item.size)
            return
        if item.external or item.is_virtual:
            raise FileError(f"the numbers of {printable(name)} are in another file; expected them in this one", path)
        values += max(item.size, math.prod(item.chunks or (0,)))  # a piece is unpacked as a whole, however little of it counts
        VIBRATION_SAMPLES.check(values, path)
        found.add(name, item[()])

    with h5py.File(stream, "r") as file:
        visit("", file)
        file.visititems(visit)


def _check_archive(path: Path, stream: BinaryIO) -> None:
    """Refuse an archive with too many members or too much in them; the list of its members is not read before its length is known."""
    stream.seek(0, io.SEEK_END)
    stream.seek(max(stream.tell() - _ARCHIVE_END, 0))
    end = stream.read()
    place = end.rfind(b"PK\x05\x06")
    if place >= 0 and len(end) >= place + 22:
        length = struct.unpack("<I", end[place + 12 : place + 16])[0]
        VIBRATION_PARTS.check(length // _SHORTEST_MEMBER, str(path))
        if end[max(place - 20, 0) : place].startswith(b"PK\x06\x07"):
            raise FileError("an archive in the format for more than 65,535 members or 4 GB; expected a smaller one", str(path))
    stream.seek(0)
    with zipfile.ZipFile(stream) as archive:
        VIBRATION_PARTS.check(len(archive.infolist()), str(path))
        VIBRATION_SAMPLES.check(sum(item.file_size for item in archive.infolist()) // 8, str(path))
    stream.seek(0)


def _archive(stream: BinaryIO, found: Channels) -> None:
    _check_archive(found.path, stream)
    with np.load(stream, allow_pickle=False) as arrays:
        for name in arrays.files:
            found.add_loaded(name, lambda: arrays[name])


def _single_array(stream: BinaryIO, found: Channels) -> None:
    if stream.read(6) != b"\x93NUMPY":
        raise ValueError("it does not begin as one; the name of an archive of arrays ends in .npz")
    stream.seek(0)
    found.add_loaded("samples", lambda: np.load(stream, allow_pickle=False))


def _check_wave(path: Path, stream: BinaryIO) -> None:
    """Refuse a WAV file of too many chunks."""
    order, parts = ">" if stream.read(12)[:4] == b"RIFX" else "<", 0
    while len(tag := stream.read(8)) == 8:
        parts += 1
        VIBRATION_PARTS.check(parts, str(path))
        stream.seek(struct.unpack(f"{order}I", tag[4:])[0], io.SEEK_CUR)
    stream.seek(0)


def _wave(stream: BinaryIO, found: Channels) -> None:
    import warnings

    import scipy.io.wavfile

    _check_wave(found.path, stream)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", scipy.io.wavfile.WavFileWarning)  # chunks of loggers that are not known
        rate, samples = scipy.io.wavfile.read(stream)
    found.add("samples", samples)
    found.rate = float(rate)


def _tdms(stream: BinaryIO, found: Channels) -> None:
    """Read the channels of a file of LabVIEW and other programs of National Instruments."""
    import nptdms

    values = 0
    with nptdms.TdmsFile.open(stream) as file:
        for channel in (each for group in file.groups() for each in group.channels()):
            values += len(channel)
            VIBRATION_SAMPLES.check(values, str(found.path))
            properties = channel.properties
            name = f"{channel.group_name}/{channel.name}" + (f" [{properties['unit_string']}]" if properties.get("unit_string") else "")
            found.add(name, channel[:] if len(channel) else np.zeros(0))
            _note_rate(found, name, properties.get("wf_increment", 0.0))


def _note_rate(found: Channels, name: str, step: float) -> None:
    """Take the step of a channel's times [s], if there is one."""
    if float(step) > 0.0:
        found.numbers[f"{name}.rate"] = 1.0 / float(step)


def _universal(_, found: Channels) -> None:
    """Read the functions of time of a universal file: its data sets 58, as text or binary."""
    import pyuff

    file = pyuff.UFF(str(found.path))
    kinds = list(file.get_set_types())
    VIBRATION_PARTS.check(len(kinds), str(found.path))
    for number in (number for number, kind in enumerate(kinds) if int(kind) == 58):
        data = file.read_sets([number])
        unit, title = str(data.get("ordinate_axis_units_lab", "")).strip(), str(data.get("id1", "")).strip()
        name = f"{number + 1} {title}".replace(" NONE", "") + (f" [{unit}]" if unit not in ("", "NONE") else "")
        found.add(name, data["data"])
        step = data.get("abscissa_inc", 0.0) if int(data.get("abscissa_spacing", 0)) else 0.0
        _note_rate(found, name, step)
        if not float(step) > 0.0 and "x" in data:
            found.add(f"{name} time", np.real(data["x"]))


class Block(NamedTuple):
    """Samples of one message.

    Attributes
    ----------
    samples : shape (n,).
    rate : of the samples [Hz]; NaN where the message does not say it.
    sequence : number of the block; None where the message does not say it.
    """

    samples: np.ndarray
    rate: float
    sequence: int | None = None


def block_of(message, field: str = "data") -> Block:
    """Return the samples of a message, their rate and number.

    A std_msgs/Float64MultiArray tells the rate as the size of a dimension with the label ``rate``, and its number as that of one labelled
    ``sequence``.

    Parameters
    ----------
    message : any object with the fields of a message as attributes.
    field : path of the samples in it: of an array, or of one number.

    Raises
    ------
    ValueError
        There is no such field, or it does not hold numbers.
    """
    value = message
    for part in field.split("."):
        if not hasattr(value, part):
            raise ValueError(f"no field {field!r} in the message")
        value = getattr(value, part)
    try:
        samples = np.atleast_1d(np.asarray(value, float))
    except (TypeError, ValueError):
        raise ValueError(f"{field} holds no numbers") from None
    if samples.ndim != 1:
        raise ValueError(f"{field} holds no row of numbers")
    sizes = {str(each.label): int(each.size) for each in getattr(getattr(message, "layout", None), "dim", ())}
    return Block(samples, float(sizes["rate"]) if sizes.get("rate", 0) > 0 else math.nan, sizes.get("sequence"))


def _bag(found: Channels, wanted: tuple[str, ...]) -> None:
    """Read the channels of a recording: those that are named, or all topics of arrays of numbers."""
    path = found.path
    bag, topics = BagReader(path), {}
    named = {name: _topic_and_field(name) for name in wanted}
    unreadable: Counter[str] = Counter()
    pieces: dict[str, list[Block]] = {}
    times: dict[str, list[int]] = {}
    for item in bag:
        if isinstance(item, BagTopic):
            topics[item.name] = item.ros_type
            continue
        topic, time, data = item
        for name, field in _channels_of(topic, named):
            try:
                block = block_of(topic.decode(data), field)
            except Exception as error:  # decoders raise exceptions of any kind on damaged data
                if named:
                    raise VibrationError(f"{path}, {name}: a message cannot be used: {printable(str(error))}") from None
                unreadable[name] += 1
                continue
            found.count(len(block.samples))
            pieces.setdefault(name, []).append(block)
            times.setdefault(name, []).append(time)
    missing = [name for name in wanted if name not in pieces]
    if missing:
        raise VibrationError(f"{path}: no messages on {missing[0]}{did_you_mean(missing[0], list(topics))}; there are {_listed(topics)}")
    if not pieces:
        raise VibrationError(f"{path}: no topic of std_msgs/msg/Float64MultiArray; name one with --channel /topic.field; there are {_listed(topics)}")
    name = wanted[0] if wanted else max(pieces, key=lambda each: sum(len(block.samples) for block in pieces[each]))
    begin, end = _longest_stretch(pieces[name])
    tally = Tally(used=end - begin, there=end - begin, unread=bag.tally.unread, remedies=bag.tally.remedies, notes=bag.tally.notes)
    for reason, count in ((f"behind a gap of {name}", len(pieces[name]) - tally.used), (f"not readable on {name}", unreadable[name])):
        if count:
            tally.refuse(reason, count)
    if len(wanted) == 1 or not wanted:  # channels that go together keep all of theirs
        pieces[name], times[name] = pieces[name][begin:end], times[name][begin:end]
    elif tally.used < tally.there:
        raise VibrationError(f"{path}, {name}: blocks are missing ({tally.counts}); expected a record without gaps where a speed goes with it")
    stamps, blocks = times[name], pieces[name]
    found.arrays |= {each: np.concatenate([block.samples for block in parts]) for each, parts in pieces.items()}
    rates = {block.rate for block in blocks if math.isfinite(block.rate)}
    if len(rates) > 1:
        raise VibrationError(f"{path}, {name}: blocks of {' and '.join(f'{rate:g} Hz' for rate in sorted(rates)[:4])}; expected one rate")
    rate = next(iter(rates), None)
    if rate is None and len(stamps) > 1 and stamps[-1] > stamps[0]:
        rate = sum(len(block.samples) for block in blocks[1:]) / ((stamps[-1] - stamps[0]) * 1e-9)
    found.rate, found.tally = rate, tally


def _longest_stretch(blocks: list[Block]) -> tuple[int, int]:
    """Return the indices of the first block and behind the last one of the longest part in which no block is missing by its number."""
    ends = [0, *(k for k in range(1, len(blocks)) if None not in (a := blocks[k - 1].sequence, b := blocks[k].sequence) and b != a + 1), len(blocks)]
    return max(zip(ends, ends[1:]), key=lambda part: part[1] - part[0])


def _topic_and_field(name: str) -> tuple[str, str]:
    topic, _, field = name.partition(".")
    return (topic if topic.startswith("/") else f"/{topic}"), field or "data"


def _channels_of(topic: BagTopic, named: Mapping[str, tuple[str, str]]) -> Iterator[tuple[str, str]]:
    if not named and topic.ros_type == "std_msgs/msg/Float64MultiArray":
        yield topic.name, "data"
    for name, (wanted, field) in named.items():
        if wanted == topic.name:
            yield name, field


FORMATS = {
    **dict.fromkeys((".csv", ".txt", ".tsv", ".dat", ".lvm"), ("text", _text)),
    ".parquet": ("Parquet", _parquet),
    ".mat": ("MAT", _matlab),
    ".npz": ("NPZ", _archive),
    ".npy": ("NPY", _single_array),
    ".wav": ("WAV", _wave),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), ("HDF5", _hdf5)),
    ".tdms": ("TDMS", _tdms),
    **dict.fromkeys((".uff", ".unv", ".u58", ".uf"), ("universal file", _universal)),
    **dict.fromkeys((".mcap", ".active", ".db3", ".bag", ".zstd", ".zst", ".lz4"), ("bag", _bag)),
}
"""Names of formats and their readers, by the suffix of a file; a folder is a bag."""
