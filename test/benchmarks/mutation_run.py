# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Plant faults into the package, one at a time, and see whether the tests notice.

    python test/benchmarks/mutation_run.py --faults 200 --seed 1

Each fault is one changed operator, number, condition or removed statement, drawn with a seed from all rooms.  It is planted in a clone of the last
commit, and the 16 test files nearest to the changed module run until one fails or their time is over: first those named like it, then those that
import it, directly or through other modules.  Faults in compiled code come last, because each costs a compilation.  A test that fails with a fault
is run once without it, so that no test that fails anyway counts.  Rows are kept in ``FOLDER/faults.jsonl``; the same command continues where it
was stopped.

A fault that survives is either a claim that no test makes, a change without consequence, or one that only tests further away would see.
"""

import argparse
import ast
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "bearing_sim"
LEAST_PER_ROOM = 6
MOST_IMPORTS = 4  # from a test to the module, that are followed
MOST_TESTS = 16
COMPILED = ("numerics", "physics", "levels")  # rooms whose change compiles everything anew
SKIPPED_TESTS = {"test_flake8", "test_pep257", "test_doc", "test_architecture", "test_package"}  # they look at the text
ARITHMETIC = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
COMPARISON = {
    ast.Lt: ("<", ("<=", ">=")),
    ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<=")),
    ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
}


class Fault(NamedTuple):
    """A change of the text of one file from ``begin`` to ``end`` (offsets in characters)."""

    file: str
    line: int
    begin: int
    end: int
    old: str
    new: str
    kind: str


class _Finder(ast.NodeVisitor):
    """Collects the faults that can be planted in one file."""

    def __init__(self, file: str, text: str):
        self.file, self.text, self.faults = file, text, []
        self._lines = [0]
        for line in text.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))
        self._texts = text.splitlines()

    def _offset(self, line: int, column: int) -> int:
        """Return the offset of a position of the syntax tree, whose columns are in bytes."""
        return self._lines[line - 1] + len(self._texts[line - 1].encode()[:column].decode())

    def _range(self, node: ast.AST) -> tuple[int, int]:
        return self._offset(node.lineno, node.col_offset), self._offset(node.end_lineno, node.end_col_offset)

    def _add(self, node: ast.AST, begin: int, end: int, new: str, kind: str) -> None:
        self.faults.append(Fault(self.file, node.lineno, begin, end, self.text[begin:end], new, kind))

    def _between(self, node: ast.AST, left: ast.AST, right: ast.AST, old: str, new: str, kind: str) -> None:
        begin, end = self._range(left)[1], self._range(right)[0]
        at = self.text.find(old, begin, end)
        if at >= 0 and self.text[begin:end].count(old) == 1:
            self._add(node, at, at + len(old), new, kind)

    def visit_BinOp(self, node: ast.BinOp) -> None:  # noqa: N802
        if type(node.op) in ARITHMETIC and not any(isinstance(side, ast.JoinedStr | ast.List | ast.Tuple) for side in (node.left, node.right)):
            self._between(node, node.left, node.right, *ARITHMETIC[type(node.op)], "arithmetic")
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:  # noqa: N802
        if len(node.ops) == 1 and type(node.ops[0]) in COMPARISON:
            old, others = COMPARISON[type(node.ops[0])]
            for new in others:
                self._between(node, node.left, node.comparators[0], f" {old} ", f" {new} ", "comparison")
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:  # noqa: N802
        old, new = (" and ", " or ") if isinstance(node.op, ast.And) else (" or ", " and ")
        for left, right in zip(node.values, node.values[1:]):
            self._between(node, left, right, old, new, "condition")
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:  # noqa: N802
        begin, end = self._range(node.test)
        self._add(node, begin, end, f"not ({self.text[begin:end]})", "condition")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:  # noqa: N802
        begin, end = self._range(node)
        if isinstance(node.value, bool):
            self._add(node, begin, end, str(not node.value), "number")
        elif isinstance(node.value, int):
            self._add(node, begin, end, str(node.value + 1), "number")
        elif isinstance(node.value, float):
            self._add(node, begin, end, repr(1.1 * node.value if node.value else 0.1), "number")

    def visit_Expr(self, node: ast.Expr) -> None:  # noqa: N802
        if isinstance(node.value, ast.Call):
            self._remove(node)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:  # noqa: N802
        self._remove(node)
        self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:  # noqa: N802
        self._remove(node)  # the text of a message is nothing that a test has to hold

    def _remove(self, node: ast.stmt) -> None:
        self._add(node, *self._range(node), "pass", "statement removed")

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:  # noqa: N802
        for child in (*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body):  # no decorators, no annotations
            self.visit(child)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:  # noqa: N802
        if node.value is not None:
            self.visit(node.value)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:  # noqa: N802
        for child in node.body:
            self.visit(child)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:  # noqa: N802
        """Leave texts as they are."""


def room_of(file: str) -> str:
    """Return the room of a file."""
    parts = Path(file).parts
    return parts[1] if len(parts) > 2 else PACKAGE


def drawn(root: Path, number: int, seed: int) -> list[Fault]:
    """Return faults of all rooms: as many of each as it has lines, but `LEAST_PER_ROOM` at least, in an order of chance."""
    source, lines, by_room = random.Random(seed), Counter(), {}
    for path in sorted((root / PACKAGE).rglob("*.py")):
        text, file = path.read_text(encoding="utf-8"), path.relative_to(root).as_posix()
        finder = _Finder(file, text)
        finder.visit(ast.parse(text))
        lines[room_of(file)] += text.count("\n")
        by_room.setdefault(room_of(file), []).extend(finder.faults)
    by_room = {room: faults for room, faults in by_room.items() if len(faults) >= LEAST_PER_ROOM}
    left = number - LEAST_PER_ROOM * len(by_room)
    total = sum(lines[room] for room in by_room)
    chosen = []
    for room, faults in by_room.items():
        chosen += source.sample(faults, min(len(faults), LEAST_PER_ROOM + max(round(left * lines[room] / total), 0)))
    source.shuffle(chosen)
    return chosen[:number]


def is_compiled(fault: Fault) -> bool:
    """Return whether a fault is in compiled code."""
    return room_of(fault.file) in COMPILED


def imports_of(path: Path) -> set[str]:
    """Return the modules of the package that a file imports, also by name as the command line does."""
    text = path.read_text(encoding="utf-8")
    found = {f"{PACKAGE}.{path.parent.name}.{module}" for module in re.findall(r"^[\w-]+ +(\w+):\w+ +[A-Z]", text, re.M)}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith(PACKAGE):
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names if name.name.startswith(PACKAGE)}
    return found


def nearest_tests(root: Path) -> dict[str, list[str]]:
    """Return for each module of the package the test files that may see a fault in it, the nearest first.

    Near is a test that names the module in its own name, then one that imports it, directly or through other modules, or runs it as a program.
    """
    tests = [path for path in sorted((root / "test").glob("test_*.py")) if path.stem not in SKIPPED_TESTS]
    modules = {path.relative_to(root).as_posix(): path for path in (root / PACKAGE).rglob("*.py")}
    names = {file: file[:-3].replace("/", ".").removesuffix(".__init__") for file in modules}
    imported = {names[file]: imports_of(path) for file, path in modules.items()}
    by_test = {path: imports_of(path) for path in tests}
    texts = {path: path.read_text(encoding="utf-8") for path in tests}
    found = {}
    for file, module in names.items():
        stem = module.rsplit(".", 1)[-1]
        distances = _distances(module, imported)
        ranked = []
        for path in tests:
            distance = min((distances[other] for other in by_test[path] if other in distances), default=MOST_IMPORTS)
            runs_it = module in texts[path]
            named = 0 if stem in path.stem else 1 if re.search(rf"\b{stem}\b", texts[path]) else 2
            if distance < MOST_IMPORTS or runs_it or named == 0:
                ranked.append((named != 0, distance - runs_it + named, path.stem.startswith("test_node"), len(by_test[path]), path.name))
        found[file] = [f"test/{name}" for *_, name in sorted(ranked)][:MOST_TESTS]
    return found


def _distances(module: str, imported: dict[str, set[str]]) -> dict[str, int]:
    """Return the modules that import a module, directly or through others, with the number of imports between them."""
    distances, nearest = {module: 0}, {module}
    for distance in range(1, MOST_IMPORTS):
        nearest = {other for other, used in imported.items() if other not in distances and used & nearest}
        distances |= dict.fromkeys(nearest, distance)
    return distances


def run_tests(folder: Path, files: list[str], seconds: float) -> tuple[str, str, float]:
    """Run tests until one fails; return what happened (passed, failed, over time, broken), which test failed, and how long it took [s]."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", *files]
    began = time.monotonic()
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    ) as child:
        try:
            told, _ = child.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            return "over time", "", time.monotonic() - began
    failed = re.search(r"^(?:FAILED|ERROR) (\S+?\.py(?:::.+?)?)(?: - |$)", told, re.MULTILINE)
    outcome = "passed" if child.returncode in (0, 5) else "failed" if failed else "broken"
    return outcome, failed[1] if failed else told[-300:], time.monotonic() - began


def try_fault(folder: Path, fault: Fault, tests: list[str], seconds: float, good: dict[str, bool]) -> dict[str, object]:
    """Plant a fault, run the tests file by file, take the fault out again, and return the row of what happened."""
    path = folder / fault.file
    text = path.read_text(encoding="utf-8")
    assert text[fault.begin : fault.end] == fault.old
    row = {**fault._asdict(), "outcome": "survived", "by": "", "files": 0}
    began = time.monotonic()
    for files in _in_groups(tests):
        left = seconds - (time.monotonic() - began)
        if left <= 0:
            row["outcome"] = "survived so far"
            break
        path.write_text(text[: fault.begin] + fault.new + text[fault.end :], encoding="utf-8")
        try:
            outcome, by, _ = run_tests(folder, files, left)
        finally:
            path.write_text(text, encoding="utf-8")
        row["files"] += len(files)
        if outcome == "over time":
            row["outcome"] = "survived so far"
            break
        if outcome in ("failed", "broken"):
            target = by if outcome == "failed" else files[0]
            if target not in good:
                good[target] = run_tests(folder, [target], 600.0)[0] == "passed"
            if good[target]:
                row["outcome"], row["by"] = "caught", by
                break
    row["seconds"] = round(time.monotonic() - began, 1)
    return row


def _in_groups(tests: list[str]) -> list[list[str]]:
    """Return test files in groups that run together: the first alone, then more at a time, for a start of pytest costs seconds."""
    groups, size, at = [], 1, 0
    while at < len(tests):
        groups.append(tests[at : at + size])
        at, size = at + size, min(size * 2, 8)
    return groups


def told(rows: list[dict[str, object]]) -> str:
    """Return the table by rooms, and what survived."""
    rooms = sorted({room_of(row["file"]) for row in rows})
    lines = ["| room | faults | caught | survived | out of time |", "|---|---|---|---|---|"]
    for room in [*rooms, "all"]:
        own = [row for row in rows if room in ("all", room_of(row["file"]))]
        count = Counter(row["outcome"] for row in own)
        lines.append(f"| {room} | {len(own)} | {count['caught']} | {count['survived']} | {count['survived so far']} |")
    lines.append("")
    for row in rows:
        if row["outcome"] != "caught":
            lines.append(f"{row['file']}:{row['line']}: {row['old']!r} -> {row['new']!r} ({row['outcome']}, {row['files']} test files)")
    return "\n".join(lines)


def main() -> None:
    """Plant faults and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--faults", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=240.0, help="of tests for each fault")
    parser.add_argument("--again", action="store_true", help="repeat those whose time was over before all their tests had run")
    parser.add_argument("--room", action="append", help="plant in this room only; can be repeated")
    parser.add_argument("--each", type=int, help="plant at most so many of each room, the first of those drawn")
    parser.add_argument("--tests", type=int, default=MOST_TESTS, help="test files to run for each fault, the nearest")
    parser.add_argument("--folder", type=Path, default=Path("mutation_run"), help="for the clone and the rows")
    chosen = parser.parse_args()
    clone, rows_file = chosen.folder.resolve() / "clone", chosen.folder / "faults.jsonl"
    if not clone.exists():
        subprocess.run(["git", "clone", "-q", str(ROOT), str(clone)], check=True)
    subprocess.run(["git", "checkout", "-q", "--", "."], cwd=clone, check=True)
    rows = [json.loads(line) for line in rows_file.read_text().splitlines()] if rows_file.exists() else []
    if chosen.again:
        rows = [row for row in rows if row["outcome"] != "survived so far"]
        rows_file.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    done = {(row["file"], row["begin"], row["new"]) for row in rows}
    tests, good = nearest_tests(clone), {}
    planted = Counter()
    for fault in sorted(drawn(clone, chosen.faults, chosen.seed), key=is_compiled):
        room = room_of(fault.file)
        if (chosen.room and room not in chosen.room) or (chosen.each is not None and planted[room] >= chosen.each):
            continue
        planted[room] += 1
        if (fault.file, fault.begin, fault.new) in done:
            continue
        row = try_fault(clone, fault, tests[fault.file][: chosen.tests], chosen.seconds, good)
        rows.append(row)
        with open(rows_file, "a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        change = f"{row['old'][:40]!r} -> {row['new'][:40]!r}"
        print(f"{len(rows):4d} {row['outcome']:16s} {row['seconds']:6.1f} s  {row['file']}:{row['line']}  {change}  {row['by'][:90]}", flush=True)
    print(told(rows))


if __name__ == "__main__":
    main()
