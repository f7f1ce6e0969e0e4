# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether any file from a stranger makes a command crash, hang, fill the memory or pass for what it is not.

``python test/benchmarks/hostile_files.py`` gives each hostile file to the command that reads it, in a process of its own that may take
1 GB of address space on top of what the program itself occupies once its packages are loaded, and 20 s.  The table shows the exit code, the
largest memory on top of the program, the time, and the first line of the message.  The exit code of the benchmark is 1 if a case breaks the
rule: refused with one message, ``Error: ...``, of a length that can be read and without control characters, and an exit code that is not 0;
without traceback, signal, or a limit reached.  A few files
look hostile and are none; their case says why they are accepted.  ``--only TEXT`` runs the cases whose names contain the text, ``--messages``
prints whole messages, ``--json`` prints one JSON object.

Processes are forked from one that has loaded the packages, because 200 times that would be most of the work.  A node is started as a process
of its own.  The cases are in the modules ``hostile_*.py`` beside this one.
"""

import argparse
import importlib
import json
import os
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bearing_sim.cli.main import main as command_line
from bearing_sim.cli.reporting import print_rows

SPARE = 1_000_000_000  # [byte] of address space on top of that of the loaded program
PATIENCE = 20.0  # s
_LONGEST_MESSAGE = 20_000  # characters that somebody may still read
_HEADING = re.compile(r": \d+ errors?$")
_PACKAGES = (
    "numpy",
    "scipy.interpolate",
    "scipy.io",
    "scipy.signal",
    "h5py",
    "pydantic",
    "pint",
    "yaml",
    "pyarrow.dataset",
    "pyarrow.parquet",
    "mcap.reader",
    "rosbags",
    "zstandard",
    "lz4",
)
_MODULES = ("hostile_scenes", "hostile_tables", "hostile_recordings", "hostile_vibration")


@dataclass(frozen=True)
class Case:
    """A hostile file and the command that reads it.

    Attributes
    ----------
    name : what is hostile about it.
    make : writes the files into an empty folder.
    command : arguments of ``bearing-sim``, run in that folder; or a function that is called there.
    accepted : why the command is right to succeed; empty where it must refuse the file.
    """

    name: str
    make: Callable[[Path], None]
    command: tuple[str, ...] | Callable[[], object]
    accepted: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of a case.

    Attributes
    ----------
    name : of the case.
    exit_code : of the process; negative: the signal that ended it.
    memory : largest resident memory on top of the loaded program [byte].
    seconds : wall time.
    message : what was written to stdout and stderr.
    fault : which rule was broken; empty if none was.
    """

    name: str
    exit_code: int
    memory: int
    seconds: float
    message: str
    fault: str

    @property
    def first_line(self) -> str:
        """The line that begins with ``Error``, or else the first that is not empty; a list of errors goes on with the first of them."""
        lines = [line.strip() for line in self.message.splitlines() if line.strip()]
        begin = next((k for k, line in enumerate(lines) if line.startswith("Error")), 0)
        return " ".join(lines[begin : begin + 2] if _HEADING.search(" ".join(lines[begin : begin + 1])) else lines[begin : begin + 1])


def address_space() -> int:
    """Return the address space that this process occupies [byte]."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")


def resident() -> int:
    """Return the memory in which this process resides [byte]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def run_case(case: Case, folder: Path) -> Outcome:
    """Run one case in a process of its own, in a folder that is empty."""
    case.make(folder)
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as memory:
        began = time.monotonic()
        process = os.fork()
        if not process:
            os.write(memory.fileno(), str(resident()).encode())
            _run_here(case, folder, output.fileno())
        status, usage, timed_out = _waited(process, began)
        seconds = time.monotonic() - began
        memory.seek(0)
        before = int(memory.read())
        output.seek(0)
        message = output.read(10_000_000).decode(errors="backslashreplace")
    code = os.waitstatus_to_exitcode(status)
    fault = _fault(case, code, message, timed_out)
    return Outcome(case.name, code, max(usage.ru_maxrss * 1024 - before, 0), seconds, message, fault)


def _run_here(case: Case, folder: Path, output: int) -> None:
    """Run a case in this process, which ends with it."""
    code = 70
    try:
        os.setsid()
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (address_space() + SPARE,) * 2)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(output, 1)
        os.dup2(output, 2)
        if callable(case.command):
            case.command()
        else:
            command_line(list(case.command), prog_name="bearing-sim")
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _waited(process: int, began: float):
    """Wait for a process and end it when its time is up; return its status, what it used, and whether its time was up."""
    while True:
        done, status, usage = os.wait4(process, os.WNOHANG)
        if done:
            return status, usage, False
        if time.monotonic() - began > PATIENCE:
            os.killpg(process, signal.SIGKILL)
            _, status, usage = os.wait4(process, 0)
            return status, usage, True
        time.sleep(0.005)


def _fault(case: Case, code: int, message: str, timed_out: bool) -> str:
    if timed_out:
        return f"not done after {PATIENCE:g} s"
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    if "Traceback (most recent call last)" in message:
        return "traceback"
    if "MemoryError" in message or "bad_alloc" in message:
        return "out of memory"
    if "No such option" in message or "Missing argument" in message or "Missing option" in message:
        return "the command is none, so that it reads no file"
    if case.accepted:
        return "" if code == 0 else f"refused, although {case.accepted}"
    if code == 0:
        return "accepted"
    if len(message) > _LONGEST_MESSAGE:
        return f"a message of {len(message)} characters"
    if unprintable := sorted({letter for letter in message if not letter.isprintable() and letter not in "\n\t"}):
        return f"control characters {unprintable[:5]}"
    return "" if any(line.startswith("Error: ") for line in message.splitlines()) else "no message"


def all_cases() -> list[Case]:
    """Return the cases of all modules ``hostile_*.py``, whose names are unique."""
    cases = []
    for name in _MODULES:
        if Path(__file__).with_name(f"{name}.py").exists():
            cases += importlib.import_module(name).CASES
    names = [case.name for case in cases]
    assert len(set(names)) == len(names), sorted(name for name in names if names.count(name) > 1)
    return cases


def main() -> int:
    """Run the cases and print the table; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="run the cases whose names contain this text")
    parser.add_argument("--messages", action="store_true", help="print whole messages")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    options = parser.parse_args()
    for package in _PACKAGES:
        importlib.import_module(package)
    outcomes = []
    for case in all_cases():
        if options.only in case.name:
            with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
                outcomes.append(run_case(case, Path(folder)))
                if options.messages:
                    print(f"--- {case.name}: exit code {outcomes[-1].exit_code} {outcomes[-1].fault}\n{outcomes[-1].message[:3000]}", flush=True)
    _print(outcomes, options.json)
    return int(any(outcome.fault for outcome in outcomes) or not outcomes)


def _print(outcomes: Sequence[Outcome], as_json: bool) -> None:
    if as_json:
        print(json.dumps([{**vars(outcome), "message": outcome.first_line} for outcome in outcomes], indent=2))
        return
    rows = [
        (each.name, str(each.exit_code), f"{each.memory / 1e6:.0f}", f"{each.seconds:.2f}", each.fault and each.fault.upper(), each.first_line[:110])
        for each in outcomes
    ]
    print_rows("Hostile files", ("case", "exit", "MB", "s", "fault", "first line"), rows, words=("case", "fault", "first line"), width=220)
    if not outcomes:
        print("no such case")
        return
    faults, program = sum(bool(each.fault) for each in outcomes), f"{address_space() / 1e9:.2f} GB of addresses, {resident() / 1e6:.0f} MB"
    memory, seconds = max(each.memory for each in outcomes), max(each.seconds for each in outcomes)
    print(f"{len(outcomes)} cases, {faults} faults; the program itself occupies {program};")
    print(f"largest memory on top of it {memory / 1e6:.0f} MB (limit {SPARE / 1e6:.0f} MB), longest time {seconds:.1f} s (limit {PATIENCE:g} s)")


if __name__ == "__main__":
    sys.exit(main())
