# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Hostile mappings, measured tables, tables of results, of operating points and of bearings, and stored states, for ``hostile_files.py``."""

import hashlib
import json
import math
import random
from collections.abc import Callable, Mapping
from pathlib import Path

from hostile_files import Case
from hostile_scenes import fifo, file, files, link, sparse

from bearing_sim.watchers.stored_state.state import VERSION

_IMPORT = ("import-csv", "data.csv", "mapping.yaml", "-o", "out.mcap")
_GUESS = ("import-csv", "data.csv", "--guess")
_PLOT = ("plot", "table.parquet", "-o", "picture.png")
_REPORT = ("report", "table.parquet", "-o", "page.html")
_DESIGN = ("design", "deng2017_table1", "--slip-below", "10%", "--life-above", "300h", "--points", "points.csv")
_FLEET = ("replay-fleet", "log.mcap", "--bearings", "bearings.csv")
_STATE = ("state", "show", "state.json")
_MAPPING = """\
name: test
time: {column: t, unit: s%s}
shaft_speed: {column: n, unit: rpm}
radial_load: {law: sum, columns: [{column: f, unit: N}]}
"""
_TIMES = _MAPPING.replace("unit: s%s", "format: '%s'")
_HEADING = "t,n,f\n"
_ROWS = "".join(f"{k},1500,800\n" for k in range(100))
_PROPOSAL = "a guess is a proposal to be checked, and computes nothing"
_TEN_GIGABYTE = 10_000_000_000


def _mapping(name: str, content: str | bytes) -> Case:
    return Case(f"mapping: {name}", files(data__csv=_HEADING + _ROWS, mapping__yaml=content), _IMPORT)


def _table(name: str, content: str | bytes, mapping: str = _MAPPING % "", accepted: str = "") -> Case:
    return Case(f"CSV: {name}", files(data__csv=content, mapping__yaml=mapping), _IMPORT, accepted)


def _special(name: str, make: Callable[[Path], None], command: tuple[str, ...]) -> Case:
    def both(folder: Path) -> None:
        file("mapping.yaml", _MAPPING % "")(folder)
        make(folder)

    return Case(name, both, command)


def _guess(name: str, content: str | bytes, accepted: str = "") -> Case:
    return Case(f"guess: {name}", file("data.csv", content), _GUESS, accepted)


def _parquet(make_table: Callable[[], object], name: str = "table.parquet", flips: int = 0) -> Callable[[Path], None]:
    """Return what writes a Parquet table, with some of its bytes changed at random."""

    def make(folder: Path) -> None:
        import pyarrow.parquet

        pyarrow.parquet.write_table(make_table(), folder / name)
        data, source = bytearray((folder / name).read_bytes()), random.Random(flips)
        for _ in range(flips):
            data[source.randrange(4, len(data) - 4)] ^= 1 << source.randrange(8)
        (folder / name).write_bytes(data)
        file("mapping.yaml", _MAPPING % "")(folder)

    return make


def _result(about: object, columns: Mapping[str, list] | None = None, notes: Mapping[bytes, bytes] | None = None) -> Callable[[], object]:
    """Return what makes a table as a sweep writes it, with hostile metadata."""

    def make() -> object:
        import pyarrow

        arrays = columns or {"operating.radial_load": [1.0, 2.0], "cage_slip": [0.1, 0.2], "rating_life": [1.0, 2.0]}
        fields = [pyarrow.field(name, pyarrow.array(values).type, metadata=dict(notes or {b"unit": b"N"})) for name, values in arrays.items()]
        text = about if isinstance(about, bytes) else json.dumps(about).encode()
        return pyarrow.table(list(arrays.values()), schema=pyarrow.schema(fields, metadata={b"bearing_sim": text}))

    return make


def _huge(rows: int) -> Callable[[], object]:
    def make() -> object:
        import pyarrow

        same = pyarrow.DictionaryArray.from_arrays(pyarrow.array([0], pyarrow.int8()), ["x" * 1_000_000])
        column = pyarrow.chunked_array([same] * rows)
        schema = pyarrow.schema([pyarrow.field("t", column.type), pyarrow.field("n", column.type), pyarrow.field("f", column.type)])
        return pyarrow.table([column, column, column], schema=schema.with_metadata({b"bearing_sim": b"{}"}))

    return make


def _same_rows(rows: int) -> Callable[[], object]:
    def make() -> object:
        import numpy
        import pyarrow

        column = numpy.zeros(rows)
        return pyarrow.table({"t": column, "n": column, "f": column}).replace_schema_metadata({b"bearing_sim": b"{}"})

    return make


def _both(name: str, make: Callable[[Path], None], shown: str = "") -> list[Case]:
    """Return the cases of a table for ``plot`` and for ``report``; ``shown`` says why a page may show it."""
    return [Case(f"plot: {name}", make, _PLOT), Case(f"report: {name}", make, _REPORT, shown)]


def _state_text(**fields: object) -> bytes:
    """Return a state with fields of a stranger and the checksum that fits them."""
    state = json.dumps({"serial": "A1", "identity": {}, "totals": {}} | fields).encode()
    checksum = hashlib.sha256(b"%d " % VERSION + state).hexdigest()
    return json.dumps({"format": "bearing_sim state", "version": VERSION, "checksum": checksum}).encode()[:-1] + b', "state": ' + state + b"}\n"


def _state(name: str, content: str | bytes, accepted: str = "") -> Case:
    return Case(f"state: {name}", file("state.json", content), _STATE, accepted)


def _points(name: str, content: str | bytes) -> Case:
    return Case(f"operating points: {name}", file("points.csv", content), _DESIGN)


def _bearings(name: str, content: str | bytes) -> Case:
    return Case(f"bearings: {name}", files(bearings__csv=content, log__mcap=b""), _FLEET)


CASES = [
    _mapping("Latin-1", (_MAPPING % "").replace("test", "Prüfstand").encode("latin-1")),
    _mapping("a date that is none", _MAPPING % ", epoch: 2001-13-45"),
    _mapping("an epoch of words", _MAPPING % ", epoch: yesterday"),
    _mapping("an epoch of the year 9999", _MAPPING % ", epoch: 9999-12-31"),
    _mapping("an epoch of the year 1", _MAPPING % ", epoch: 0001-01-01"),
    _mapping("an epoch with a hostile zone", _MAPPING % ", epoch: '2001-01-01T00:00:00+99:99'"),
    _mapping("a time in powers of powers", (_MAPPING % "").replace("unit: s", "unit: s**9**9**9**9")),
    _mapping("a time in light years", (_MAPPING % "").replace("unit: s", "unit: light_year")),
    _mapping("a time in a million letters", (_MAPPING % "").replace("unit: s", f"unit: {'s' * 1_000_000}")),
    _mapping("a speed in powers of powers", (_MAPPING % "").replace("rpm", "rpm**9**9**9**9")),
    _mapping("a heading of a million letters", (_MAPPING % "").replace("column: n, unit: rpm", f"column: '{'n [' * 300_000}'")),
    _mapping("a scale beyond all bounds", (_MAPPING % "").replace("unit: rpm", "scale: 1e308 rpm, offset: 1e308 rad/s")),
    _mapping("a format of the same thing twice", _TIMES % "%Y %Y"),
    _mapping("a format with a percent sign at its end", _TIMES % "%Y %"),
    _mapping("a format of an unknown letter", _TIMES % "%Q"),
    _mapping("a format of 100,000 letters", _TIMES % ("%Y" + "%m" * 50_000)),
    _mapping("a format that takes long", _TIMES % ("%f" * 6 + ".*" * 20)),
    _mapping("a zone that is a path", (_TIMES % "iso").replace("'iso'", "iso, zone: ../../../../etc/passwd")),
    _mapping("a zone that is an absolute path", (_TIMES % "iso").replace("'iso'", "iso, zone: /etc/passwd")),
    _mapping("a zone of a million letters", (_TIMES % "iso").replace("'iso'", f"iso, zone: {'x' * 1_000_000}")),
    _mapping("a zone that is a folder", (_TIMES % "iso").replace("'iso'", "iso, zone: Europe")),
    _mapping("a zone of 99 hours", (_TIMES % "iso").replace("'iso'", "iso, zone: '+99:99'")),
    _mapping("a zone with a null character", (_TIMES % "iso").replace("'iso'", 'iso, zone: "a\\0b"')),
    _mapping("an encoding that is none", (_MAPPING % "") + "encoding: klingon\n"),
    _mapping("an encoding that compresses", (_MAPPING % "") + "encoding: zip\n"),
    _mapping("an encoding that turns letters", (_MAPPING % "") + "encoding: rot13\n"),
    _mapping("an encoding with a null character", (_MAPPING % "") + 'encoding: "utf-8\\0"\n'),
    _mapping("an encoding of host names", (_MAPPING % "") + "encoding: idna\n"),
    _mapping("an encoding of 16 bits that the file has not", (_MAPPING % "") + "encoding: utf-16\n"),
    _mapping("a quotation mark as delimiter", (_MAPPING % "") + "delimiter: '\"'\n"),
    _mapping("a line end as delimiter", (_MAPPING % "") + 'delimiter: "\\n"\n'),
    _mapping("a carriage return as delimiter", (_MAPPING % "") + 'delimiter: "\\r"\n'),
    _mapping("a null character as delimiter", (_MAPPING % "") + 'delimiter: "\\0"\n'),
    _mapping("a blank as delimiter", (_MAPPING % "") + "delimiter: ' '\n"),
    _mapping("10,000 columns of loads", (_MAPPING % "").replace("[{", "[" + "{column: f, unit: N}, " * 4_000 + "{")),
    _mapping("aliases that grow", (_MAPPING % "") + "a: &a [1,1,1,1,1,1,1,1,1]\n" + "".join(f"a{k}: &a{k} [{'*a, ' * 9}]\n" for k in range(999))),
    Case("mapping: /dev/zero", file("data.csv", _HEADING + _ROWS), ("import-csv", "data.csv", "/dev/zero", "-o", "out.mcap")),
    Case(
        "mapping: an override of 3,000 brackets",
        file("data.csv", _HEADING),
        (*_GUESS[:2], "wind_turbine_scada", "-o", "o.mcap", "--set", "a=" + "[" * 3000),
    ),
    _table("a number of 990,000 digits as a time", _HEADING + "1e990000,1500,800\n" + _ROWS, accepted="the line is counted as one without a time"),
    _table("a time of 1e30", _HEADING + "1e30,1500,800\n"),
    _table("a time of 2e10", _HEADING + _ROWS + "2e10,1500,800\n", accepted="the line is counted as one without a time"),
    _table("a time of -5", _HEADING + "-5,1500,800\n" + _ROWS, accepted="the line is counted as one without a time"),
    _table("all times before 1970", _HEADING + "-5,1500,800\n-4,1500,800\n"),
    _table("a time of 1e-990000", _HEADING + "1e-990000,1500,800\n1,1500,800\n", accepted="it is zero to the nanosecond"),
    _table("a time of a million digits", _HEADING + "1" * 1_000_000 + ",1500,800\n" + _ROWS),
    _table("a time of 100,000 digits", _HEADING + "1" * 100_000 + ",1500,800\n" + _ROWS, accepted="the line is counted as one without a time"),
    _table("times that are none", _HEADING + "nan,1500,800\ninf,1500,800\n-inf,1500,800\nsNaN,1500,800\nNaN123,1,1\n"),
    _table("a speed of 990,000 digits", _HEADING + "0,1e990000,800\n" + _ROWS, accepted="the cell is counted as one that is not finite"),
    _table("speeds beyond all bounds", _HEADING + "0,1e308,800\n1,-1e308,800\n", accepted="the node and replay judge inputs by the scene's limits"),
    _table("loads whose sum overflows", _HEADING + "0,1500,1e308\n1,1500,1e308\n", (_MAPPING % "").replace("[{", "[{column: f, unit: MN}, {")),
    _table("digits of another script", _HEADING + "٠,١٥٠٠,٨٠٠\n١,١٥٠٠,٨٠٠\n", accepted="Python reads digits of every script"),
    _table("a date of the year 9999", "t,n,f\n9999-12-31T23:59:59,1500,800\n", (_TIMES % "iso").replace("'iso'", "iso, zone: '-12:00'")),
    _table("a date of the year 1", "t,n,f\n0001-01-01T00:00:00,1500,800\n", (_TIMES % "iso").replace("'iso'", "iso, zone: Europe/Berlin")),
    _table("a date of 2300", "t,n,f\n2300-01-01T00:00:00,1500,800\n", (_TIMES % "iso").replace("'iso'", "iso")),
    _table("one line of 50 MB", "x" * 50_000_000),
    _table("one row of 50 MB", _HEADING + "1," * 25_000_000),
    _table("a cell of 20 MB in quotation marks", _HEADING + '0,"' + "1" * 20_000_000 + '",800\n'),
    _table("a cell of 20 MB of lines in quotation marks", _HEADING + '0,"' + "1\n" * 10_000_000),
    _table("a million columns", ",".join(f"c{k}" for k in range(1_000_000)) + "\n" + _HEADING),
    _table("a header of 900 kB of brackets", "t,n,f,x" + "[" * 900_000 + "\n" + _ROWS),
    _table("a header of 900 kB of blanks", "t,n,f,x" + " " * 900_000 + "y\n" + _ROWS.replace("\n", ",1\n"), accepted="its columns are there"),
    _table("null characters", _HEADING + "0,\0,800\n"),
    _table("null characters in UTF-16", ("t,n,f\n" + "0,\0,800\n").encode("utf-16")),
    _table("UTF-16 cut in a character", (_HEADING + _ROWS).encode("utf-16")[:-1]),
    _table("UTF-16 of lone surrogates", b"\xff\xfe" + b"\x00\xd8" * 1000),
    _table("random bytes", bytes((k * k * 7 + k * 13) % 255 + 1 for k in range(100_000))),
    _table("a workbook", b"PK\x03\x04" + bytes(1000)),
    _table("empty", b""),
    _table("line ends only", b"\n" * 1_000_000),
    _table("carriage returns only", b"\r" * 1_000_000),
    _table("comments only", b"#\n" * 1_000_000),
    _table("escape sequences for a terminal", "t,n,f\n\x1b[2J,\x1b]0;owned\x07,8\n"),
    _table("6 million rows", _HEADING + "".join(f"{k},1,1\n" for k in range(6_000_000))),
    _special("CSV: a pipe", fifo("data.csv"), _IMPORT),
    _special("CSV: /dev/zero through a link", link("data.csv", "/dev/zero"), _IMPORT),
    _special("CSV: 10 GB of zeros", sparse("data.csv", _TEN_GIGABYTE), _IMPORT),
    _special("CSV: a folder", lambda folder: (folder / "data.csv").mkdir(), _IMPORT),
    _special("CSV: a dangling link", link("data.csv", "nowhere"), _IMPORT),
    _special("guess: a pipe", fifo("data.csv"), _GUESS),
    _guess("one line of 50 MB", "x" * 50_000_000),
    _guess("a heading of 900 kB of brackets", "time,speed " + "[" * 900_000 + "\n" + _ROWS),
    _guess("a heading of 900 kB of blanks", "time,speed" + " " * 900_000 + "rpm]\n" + _ROWS),
    _guess("a heading of 900 kB of underscores", "time,speed" + "_ " * 450_000 + "[\n" + _ROWS),
    _guess("a unit of powers of powers", "time [s],speed [rpm**9**9**9**9],load [N]\n" + _ROWS, accepted=_PROPOSAL),
    _guess("100,000 columns", ",".join(f"speed{k} [rpm]" for k in range(100_000)) + "\n" + ",".join("1" for _ in range(100_000)) + "\n"),
    _guess("5,000 columns of times", "\n".join([",".join(f"time{k}" for k in range(5_000)), *[",".join("1" for _ in range(5_000))] * 3])),
    _guess("times beyond all bounds", "time [ns],speed [rpm],load [N]\n1e999,1,1\n2e999,1,1\n", accepted=_PROPOSAL),
    _guess("times of the size of nanoseconds, negative", "time,speed [rpm],load [N]\n-1e18,1,1\n-1e17,1,1\n"),
    _guess("a date that is none", "date,speed [rpm],load [N]\n99/99/2026,1,1\n", accepted=_PROPOSAL),
    Case("Parquet: a table with bytes changed", _parquet(_result({}), "data.csv", 20), _IMPORT),
    Case("Parquet: its first letters only", file("data.csv", b"PAR1"), (*_GUESS[:2], "wind_turbine_scada", "-o", "o.mcap")),
    Case("Parquet: a length of 2^31", files(mapping__yaml=_MAPPING % "", data__csv=b"PAR1" + bytes(100) + b"\xff\xff\xff\x7fPAR1"), _IMPORT),
    Case("Parquet: a bomb of 100 rows of 1 MB", _parquet(_huge(100), "data.csv"), _IMPORT),
    Case("Parquet: a bomb of 50 million rows", _parquet(_same_rows(50_000_000), "data.csv"), _IMPORT),
    Case(
        "Parquet: a folder of links to /dev/zero",
        lambda f: ((f / "data.csv").mkdir(), link("data.csv/a.parquet", "/dev/zero")(f), None)[2],
        _IMPORT[:2] + ("wind_turbine_scada",) + _IMPORT[3:],
    ),
    *_both("a table of something else", _parquet(_result(b"[]"))),
    *_both("metadata that is no JSON", _parquet(_result(b"{"))),
    *_both("metadata that is no UTF-8", _parquet(_result(b"\xff\xfe"))),
    *_both("metadata nested 3,000 deep", _parquet(_result(b"[" * 3_000 + b"]" * 3_000))),
    *_both("metadata with an integer of 5,000 digits", _parquet(_result(b'{"axes": ' + b"9" * 5_000 + b"}"))),
    *_both("units that are no UTF-8", _parquet(_result({"axes": []}, notes={b"unit": b"\xff"}))),
    *_both("axes that are a number", _parquet(_result({"axes": 5}))),
    *_both("axes without fields", _parquet(_result({"axes": [{}]}))),
    *_both("axes of columns that are not there", _parquet(_result({"axes": [{"field": "nothing", "values": [1.0]}]}))),
    *_both(
        "lists instead of numbers",
        _parquet(_result({"axes": []}, {"cage_slip": [[1.0], [2.0]], "rating_life": [[1.0], [2.0]]})),
        "a page shows whatever is in a table",
    ),
    *_both("10 GB of zeros", sparse("table.parquet", _TEN_GIGABYTE)),
    *_both("a pipe", fifo("table.parquet")),
    *_both("bytes changed", _parquet(_result({"axes": []}), flips=20)),
    *_both("a bomb of 50 million rows", _parquet(_same_rows(50_000_000))),
    Case("plot: a CSV table of 20 MB in one line", file("table.csv", b"x" * 20_000_000), ("plot", "table.csv", "-o", "p.png")),
    Case("plot: a CSV table that is a pipe", fifo("table.csv"), ("plot", "table.csv", "-o", "p.png")),
    Case("plot: a CSV table in Latin-1", file("table.csv", "ü,b\n1,2\n".encode("latin-1")), ("plot", "table.csv", "-o", "p.png")),
    Case("report: a folder of a million brackets", file("study.json", b"[" * 1_000_000), ("report", ".", "-o", "page.html")),
    _state("empty", b""),
    _state("bytes of zero", bytes(1000)),
    _state("a list", b"[]"),
    _state("nested 3,000 deep", b"[" * 3_000 + b"]" * 3_000),
    _state("nested 1,000,000 deep", b"[" * 1_000_000),
    _state("an integer of 5,000 digits", b'{"format": "bearing_sim state", "version": ' + b"9" * 5_000 + b"}"),
    _state("a version of 10^30", b'{"format": "bearing_sim state", "version": 1' + b"0" * 30 + b', "state": {}}'),
    _state("no totals", json.dumps({"format": "bearing_sim state", "version": 0, "state": {"serial": "A", "identity": {}}})),
    _state("totals that are words", _state_text(totals={"damage": "much", "starts": "many"})),
    _state("totals beyond all bounds", _state_text(totals={"damage": 1e308, "starts": 10**300, "running_seconds": -1e308})),
    _state("totals that are none", _state_text(totals={"damage": math.nan})),
    _state("a time of 1e30", _state_text(written_ns=10**30)),
    _state("a time of -1e30", _state_text(until_ns=-(10**30), written_ns=-(10**30), created_ns=-(10**30))),
    _state(
        "a time that is infinite",
        _state_text(written_ns=math.inf),
    ),
    _state("a stretch of 1e30", _state_text(covered=[[0, 10**30]])),
    _state("stretches that are words", _state_text(covered=["ab", "cd"])),
    _state("temperatures that are words", _state_text(thermal={"time_ns": 10**30, "nodes": ["hot"], "rings": []})),
    _state("an identity that is a list", _state_text(identity=[1, 2])),
    _state("a calibration that is words", _state_text(calibration={"a": "b"})),
    _state("what was learned is a number", _state_text(learned=5)),
    _state("a retirement in words", _state_text(retired_ns="tomorrow")),
    _state("a serial number for a terminal", _state_text(serial="\x1b[2J\x1b]0;owned\x07")),
    _state("UTF-16", _state_text().decode().encode("utf-16")),
    Case("state: a pipe", fifo("state.json"), _STATE),
    Case("state: /dev/zero through a link", link("state.json", "/dev/zero"), _STATE),
    Case("state: 10 GB of zeros", sparse("state.json", _TEN_GIGABYTE), _STATE),
    Case("state: a folder", lambda folder: (folder / "state.json").mkdir(), _STATE),
    _points("powers of powers", "shaft_speed [rpm],radial_load [N**9**9**9**9],weight\n3000,1,1\n"),
    _points("Latin-1", "shaft_speed [rpm],radial_load [N],weight ü\n3000,1,1\n".encode("latin-1")),
    _points("null characters", b"shaft_speed [rpm],radial_load [N],weight\n\0,1,1\n"),
    _points("a cell of 1 MB", "shaft_speed [rpm],radial_load [N],weight\n" + "1" * 1_000_000 + ",1,1\n"),
    _points("a heading of 100 kB of blanks", "shaft_speed [rpm]" + " " * 100_000 + "x,radial_load [N],weight\n1,1,1\n"),
    _points("a million", "shaft_speed [rpm],radial_load [N],weight\n" + "3000,1,1\n" * 1_000_000),
    Case("operating points: a pipe", fifo("points.csv"), _DESIGN),
    Case("operating points: /dev/zero through a link", link("points.csv", "/dev/zero"), _DESIGN),
    Case("operating points: 10 GB of zeros", sparse("points.csv", _TEN_GIGABYTE), _DESIGN),
    _bearings("a scene that is /dev/zero", "log,scene\nlog.mcap,/dev/zero\n"),
    _bearings("null characters", b"log,scene\n\0,\0\n"),
    _bearings("a quotation mark that is not closed", 'log,scene\n"' + "x\n" * 1_000_000),
    _bearings("a column of 100 kB", "log,scene," + "x" * 100_000 + "\nlog.mcap,a,b\n"),
    Case("bearings: a pipe", fifo("bearings.csv"), _FLEET),
    Case("bearings: 10 GB of zeros", sparse("bearings.csv", _TEN_GIGABYTE), _FLEET),
]
