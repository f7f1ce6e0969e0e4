# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Hostile scenes, contours and crowns, for ``hostile_files.py``."""

import os
from collections.abc import Callable
from pathlib import Path

from hostile_files import Case

SCENE = """\
name: motor
bearing: {preset: NU 210/C3%s}
lubricant: {oil: ISO VG 68, supply: oil_bath, temperature: 70 degC}
operating: {shaft_speed: 3000 rpm, radial_load: %s}
"""
"""A scene of a motor's bearing, with further fields of the bearing and with its load to be filled in."""
_READ = ("loads", "scene.yaml")


def plain(load: str = "5 kN", bearing: str = "") -> str:
    """Return the scene with a load and further fields of the bearing."""
    return SCENE % (f", {bearing}" if bearing else "", load)


def file(name: str, content: str | bytes) -> Callable[[Path], None]:
    """Return what writes one file into a folder."""

    def make(folder: Path) -> None:
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())

    return make


def files(**contents: str | bytes) -> Callable[[Path], None]:
    """Return what writes several files into a folder; two underscores in a name stand for the point of its suffix."""

    def make(folder: Path) -> None:
        for name, content in contents.items():
            file(name.replace("__", "."), content)(folder)

    return make


def _scene(name: str, content: str | bytes, accepted: str = "") -> Case:
    return Case(f"scene: {name}", file("scene.yaml", content), _READ, accepted)


def _load(name: str, load: str) -> Case:
    return _scene(name, plain(load))


def _aliases(levels: int) -> str:
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, levels)]
    return "\n".join(lines) + "\n" + plain()


def _merges(levels: int) -> str:
    lines = ["a0: &a0 {k: 1}"] + [f"a{k}: &a{k} {{<<: [{', '.join([f'*a{k - 1}'] * 9)}]}}" for k in range(1, levels)]
    return "\n".join(lines) + "\n" + plain()


def _special(name: str, make: Callable[[Path], None]) -> Case:
    return Case(f"scene: {name}", make, _READ)


def fifo(name: str, scene: str = "") -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        os.mkfifo(folder / name)
        if scene:
            (folder / "scene.yaml").write_text(scene)

    return make


def link(name: str, target: str, scene: str = "") -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        (folder / name).symlink_to(target)
        if scene:
            (folder / "scene.yaml").write_text(scene)

    return make


def sparse(name: str, size: int, scene: str = "") -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        with open(folder / name, "wb") as stream:
            stream.truncate(size)
        if scene:
            (folder / "scene.yaml").write_text(scene)

    return make


_CONTOUR = plain(bearing="outer_raceway: {contour_file: %s}")
_CROWN = plain(bearing="roller: {crown: {law: table, file: %s}}")
_TEN_GIGABYTE = 10_000_000_000


def _contour(name: str, content: str | bytes) -> Case:
    return Case(f"contour: {name}", files(scene__yaml=_CONTOUR % "c.csv", c__csv=content), _READ)


def _crown(name: str, content: str | bytes) -> Case:
    return Case(f"crown: {name}", files(scene__yaml=_CROWN % "c.csv", c__csv=content), _READ)


_POINTS = "".join(f"{angle},{40.0}\n" for angle in range(360))

CASES = [
    _scene("Latin-1", plain().replace("motor", "Prüfstand").encode("latin-1")),
    _scene("UTF-16 without a mark", plain().encode("utf-16-le")),
    _scene("UTF-16 with a mark", plain().encode("utf-16"), accepted="its encoding is marked"),
    _scene("UTF-8 with a mark", plain().encode("utf-8-sig"), accepted="its encoding is marked"),
    _scene("UTF-32", plain().encode("utf-32")),
    _scene("UTF-16 cut in a character", plain().encode("utf-16")[:-1]),
    _scene("bytes of zero", b"\0" * 1000),
    _scene("control characters", plain().replace("motor", "mo\x07tor")),
    _scene("escape sequences for a terminal", plain().replace("motor", '"\\e[2J\\e]0;owned\\a"').replace("3000 rpm", '"\\e[2J"')),
    _scene("lone surrogate", plain().replace("motor", '"\\ud800"').replace("3000 rpm", '"\\ud800"')),
    _scene("empty", b""),
    _scene("a list", "- 1\n- 2\n"),
    _scene("a number", "5"),
    _scene("several documents", f"{plain()}---\n{plain()}"),
    _scene("random bytes", bytes((k * k * 7 + k * 13) % 251 for k in range(100_000))),
    _scene("an MCAP file", b"\x89MCAP0\r\n" + bytes(1000)),
    _scene("a date that is none", f"{plain()}description: 2001-13-45\n"),
    _scene("a time that is none", f"{plain()}description: 2001-01-01 25:61:61\n"),
    _scene("a year of zero", f"{plain()}description: 0000-01-01\n"),
    _scene("a tag !!int on a word", f"{plain()}level: !!int abc\n"),
    _scene("a tag !!float on a word", f"{plain()}level: !!float abc\n"),
    _scene("a tag !!bool on a word", f"{plain()}level: !!bool abc\n"),
    _scene("a tag !!timestamp on a word", f"{plain()}level: !!timestamp abc\n"),
    _scene("a tag !!binary", f"{plain()}level: !!binary abc\n"),
    _scene("a tag !!set", f"{plain()}level: !!set {{a, b}}\n"),
    _scene("a tag !!omap", f"{plain()}level: !!omap [a: 1]\n"),
    _scene("a tag !!pairs on a word", f"{plain()}level: !!pairs 3\n"),
    _scene("a tag !!map on a list", f"{plain()}level: !!map [1, 2]\n"),
    _scene("a tag !!seq on a word", f"{plain()}level: !!seq abc\n"),
    _scene("a tag that makes an object", f"{plain()}level: !!python/object/apply:os.system [echo owned]\n"),
    _scene("an unknown tag", f"{plain()}level: !secret abc\n"),
    _scene("a merge of a number", f"{plain()}<<: 5\n"),
    _scene("a merge of a list of numbers", f"{plain()}<<: [5]\n"),
    _scene("a key that is a list", f"{plain()}? [a, b]\n: 1\n"),
    _scene("a key that is null", f"{plain()}null: 1\n"),
    _scene("a key of bytes", f"{plain()}? !!binary YQ==\n: 1\n"),
    _scene("an alias of nothing", f"{plain()}level: *nothing\n"),
    _scene("an alias of itself", f"{plain()}level: &a [*a]\n"),
    _scene("a mapping that contains itself", f"{plain()}heat: &a {{law: *a}}\n"),
    _scene("aliases that grow to 9^9 values", _aliases(9)),
    _scene("aliases that grow to 9^5 values", _aliases(5)),
    _scene("merges that grow to 9^9 values", _merges(9)),
    _scene("lists in lists, 3,000 deep", plain("[" * 3000 + "]" * 3000)),
    _scene("lists in lists, 300 deep", plain("[" * 300 + "]" * 300)),
    _scene("blocks in blocks, 3,000 deep", plain() + "".join(f"{' ' * k}a:\n" for k in range(3000))),
    _scene("mappings opened and not closed, 100,000", plain("{a: " * 100_000)),
    _scene("dashes, 100,000 deep", plain() + "- " * 100_000),
    _scene("an anchor of a million letters", plain(f"&{'a' * 1_000_000} 5 kN") + "level: *b\n"),
    _scene("100,000 unknown fields", plain() + "".join(f"field{k}: 1\n" for k in range(100_000))),
    _scene("10,000 unknown fields", plain() + "".join(f"field{k}: 1\n" for k in range(9000))),
    _scene("100,000 unknown fields of one block", plain("5 kN, " + ", ".join(f"f{k}: 1" for k in range(100_000)))),
    _scene("an unknown field of a million letters", f"{plain()}? {'b' * 1_000_000}\n: 1\n"),
    _scene("a level of a million letters", f"{plain()}level: {'slip' * 250_000}\n"),
    _scene("an oil of a million letters", plain().replace("ISO VG 68", "x" * 1_000_000)),
    _scene("a bearing of a million letters", plain().replace("NU 210/C3", "NU 210" * 160_000)),
    _scene("a bearing of a million digits", plain().replace("NU 210/C3", "9" * 1_000_000)),
    _scene("20 MB of a comment", plain() + "#" * 20_000_000),
    _scene("7 MB of blanks", plain() + " " * 7_000_000 + "x"),
    _scene("7 MB of line ends", plain() + "\n" * 7_000_000 + "x"),
    _scene("7 MB of quotation marks", plain("'" * 7_000_000)),
    _scene("7 MB of escapes", plain('"' + "\\n" * 3_500_000 + '"')),
    _scene("1 MB of question marks", plain() + "? " * 500_000),
    _scene("3 MB of list entries", plain("[" + "1," * 1_500_000 + "]")),
    _load("an integer of 5,000 digits", "9" * 5000),
    _load("an integer of 4,000 digits", "9" * 4000),
    _load("an integer of 400 digits", "9" * 400),
    _load("a number of a million digits", "1" + "0" * 1_000_000 + ".0 N"),
    _load("a number beyond all bounds", "1e999 N"),
    _load("a number that is none", ".nan"),
    _load("infinity", ".inf"),
    _load("a date", "2001-01-01"),
    _load("powers of powers in a unit", "1 N**9**9**9**9"),
    _load("powers of powers of a number in a unit", "1 9**9**9**9 N"),
    _load("powers in brackets in a unit", "1 N*(((9**9)**9)**9)**9"),
    _load("shifted powers in a unit", "1 N^9^9^9^9"),
    _load("a unit of a million letters", f"1 {'N' * 1_000_000}"),
    _load("a unit of 10,000 products", f"1 {'N*' * 10_000}N"),
    _load("10,000 brackets in a unit", f"1 {'(' * 10_000}N{')' * 10_000}"),
    _load("a million blanks in a unit", f"'1 N{' ' * 1_000_000}N'"),
    _load("a unit that is code", "1 __import__('os').system('echo owned')"),
    _load("a unit with a lambda", "1 (lambda: 5)()"),
    _load("a unit with a prefix of 10^24", "1 yottayottanewton"),
    _load("a unit with line ends", '"1 N\\n\\n\\nimport os"'),
    _load("digits of another script", "٣ kN٣"),
    _scene("uncertainty of a million points", f"{plain()}uncertainty: {{operating.radial_load: [{'1 N, ' * 1_000_000}]}}\n"),
    _scene("4,500 ranges of unknown fields", plain() + "uncertainty:\n" + "".join(f"  bearing.field{k}: [1, 2]\n" for k in range(4500))),
    _scene("a range of a field of 100,000 letters", f"{plain()}uncertainty:\n  ? {'bearing.' * 12_500}\n  : [1, 2]\n"),
    _scene("slices of 10^9", f"{plain()}model: {{slices: 1000000000}}\n"),
    _scene("rollers of 10^9", plain(bearing="roller: {count: 1000000000}")),
    _special("a pipe", fifo("scene.yaml")),
    _special("a folder", lambda folder: (folder / "scene.yaml").mkdir()),
    _special("a dangling link", link("scene.yaml", "nowhere")),
    _special("a link to itself", link("scene.yaml", "scene.yaml")),
    _special("a link to /dev/zero", link("scene.yaml", "/dev/zero")),
    _special("10 GB of zeros", sparse("scene.yaml", _TEN_GIGABYTE)),
    Case("scene: a name of 5,000 letters", lambda folder: None, ("loads", "x" * 5000)),
    Case("scene: the memory of the process", lambda folder: None, ("loads", "/proc/self/mem")),
    Case("contour: /dev/zero", file("scene.yaml", _CONTOUR % "/dev/zero"), (*_READ, "--allow-outside")),
    Case("contour: /dev/zero through a link", link("c.csv", "/dev/zero", _CONTOUR % "c.csv"), _READ),
    Case("contour: a pipe", fifo("c.csv", _CONTOUR % "c.csv"), _READ),
    Case("contour: 10 GB of zeros", sparse("c.csv", _TEN_GIGABYTE, _CONTOUR % "c.csv"), _READ),
    Case("contour: /etc/passwd", file("scene.yaml", _CONTOUR % "/etc/passwd"), _READ),
    Case("contour: /etc/passwd from above", file("scene.yaml", _CONTOUR % ("../" * 20 + "etc/passwd")), _READ),
    Case("contour: /etc/passwd through a link", link("c.csv", "/etc/passwd", _CONTOUR % "c.csv"), _READ),
    Case("contour: /etc/passwd, allowed", file("scene.yaml", _CONTOUR % "/etc/passwd"), (*_READ, "--allow-outside")),
    Case("contour: a folder", file("scene.yaml", _CONTOUR % "."), _READ),
    Case("contour: a null character", file("scene.yaml", _CONTOUR % '"a\\0b"'), _READ),
    Case("contour: a name of 100,000 letters", file("scene.yaml", _CONTOUR % ("x" * 100_000)), _READ),
    _contour("Latin-1", "# Prüfstand\n".encode("latin-1") + _POINTS.encode()),
    _contour("bytes of zero", bytes(100_000)),
    _contour("a line of 3 MB", "1," * 1_500_000),
    _contour("a header of 3 MB of blanks", "angle" + " " * 3_000_000 + "x\n" + _POINTS),
    _contour("a header of 3 MB of letters", "angle [" + "a" * 3_000_000 + "], radius [mm]\n" + _POINTS),
    _contour("a unit that is a power of powers", f"angle [deg], radius [mm**9**9**9**9]\n{_POINTS}"),
    _contour("a million points", "angle [deg], radius [mm]\n" + "1,1\n" * 990_000),
    _contour("a million lines that are none", "angle [deg], radius [mm]\n" + "a\n" * 1_900_000),
    _contour("radii beyond all bounds", "angle [deg], radius [mm]\n" + "".join(f"{k},1e308\n" for k in range(360))),
    _contour("radii of a million digits", "angle [deg], radius [mm]\n" + "".join(f"{k},{'4' * 100_000}\n" for k in range(36))),
    _contour("angles that are none", "angle [deg], radius [mm]\n" + "nan,40\n" * 360),
    Case(
        "contour: a text of 5 MB in the scene",
        file("scene.yaml", plain(bearing=f'outer_raceway: {{contour: "{"1,1 " * 1_200_000}"}}')),
        _READ,
    ),
    Case("crown: /dev/zero", file("scene.yaml", _CROWN % "/dev/zero"), (*_READ, "--allow-outside")),
    Case("crown: /dev/zero through a link", link("c.csv", "/dev/zero", _CROWN % "c.csv"), _READ),
    Case("crown: a pipe", fifo("c.csv", _CROWN % "c.csv"), _READ),
    Case("crown: 10 GB of zeros", sparse("c.csv", _TEN_GIGABYTE, _CROWN % "c.csv"), _READ),
    Case("crown: /etc/passwd", file("scene.yaml", _CROWN % "/etc/passwd"), _READ),
    Case("crown: /etc/passwd, allowed", file("scene.yaml", _CROWN % "/etc/passwd"), (*_READ, "--allow-outside")),
    _crown("Latin-1", "position[mm],drop[um]\n0,1 # ü\n".encode("latin-1")),
    _crown("a quotation mark that is not closed", 'position[mm],drop[um]\n"' + "1,1\n" * 200_000),
    _crown("a header of 900 kB", "position[" + "m" * 900_000 + "],drop[um]\n1,1\n"),
    _crown("a unit that is a power of powers", "position[mm],drop[um**9**9**9**9]\n0,1\n"),
    _crown("200,000 points", "position[mm],drop[um]\n" + "1,1\n" * 200_000),
    _crown("200,000 points that are none", "position[mm],drop[um]\n" + "x,y\n" * 200_000),
    _crown("a file in a list", "position[mm],drop[um]\n[1],{2}\n"),
    Case("crown: a file that is a list", file("scene.yaml", _CROWN % "[a, b]"), _READ),
]
