# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether any command loses a file of its user: ``python test/benchmarks/output_walk.py``, as root because it mounts small disks.

Every output option of every command (found in the tree of commands, see ``test/output_cases.py``) is tried in these ways:

- input: it names an input of the command, by its name, a hard link and a symbolic link, with ``--force``;
- exists: there is a file already, without ``--force``; of a table, its Parquet file and its CSV file;
- no file: it names a device, a pipe, a folder, a link to nothing, and a file in a folder that does not exist, with ``--force``;
- full disk: there is a file already, and no space left, with ``--force``;
- killed: likewise, with SIGTERM, SIGINT and SIGKILL at random instants.

How to read it: numbers are trials.  A trial is lost, and the exit code 1, if an input or what stood at the output has changed although the exit code
is not 0 (unless the new file is whole: the signal came after it had got its name), or if the exit code is 0 where the output cannot have been
written.  "left" counts files that a trial has left besides: drafts after anything but SIGKILL must not be among them.  Recordings of interrupted runs
(``.active``) and journals are kept on purpose and are not counted.  "next" is the exit code of the same command after the last kill, with
``--force``.  Commands that take longer than ``--longest`` are tried in the first three ways only, and have a dash in the others.
"""

import hashlib
import math
import os
import random
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import click
import numpy as np
from click.testing import CliRunner

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from output_cases import CASES, file_name, outputs  # noqa: E402
from synthetic_vibration import Machine, record  # noqa: E402

from bearing_sim.cli.main import main  # noqa: E402
from bearing_sim.cli.outputs import OutputFolder, OutputJournal, OutputWithJournal  # noqa: E402
from bearing_sim.cli.reporting import print_rows  # noqa: E402

_COMMAND = [sys.executable, "-m", "bearing_sim.cli"]
_OLD = random.Random(19).randbytes(20_000)
_DISK = 64 * 1024  # [byte] of a small disk
_CAGE_RATIO = 0.42152  # of cage to shaft speed in the measured log: that of the scene with a mixture fraction of about 0.5
_CAGE_NOISE = 2e-5  # standard deviation of that ratio
_PATIENCE = 600.0  # [s] for a command to end
_WITH_END = (".html", ".mcap", ".parquet", ".png", ".rrd")  # formats whose last bytes say that they are complete
_KEPT = (".active", ".journal")  # by intention


def prepare(folder: Path) -> None:
    """Make one file for each input that commands are tried with."""

    def done(*arguments):
        result = CliRunner().invoke(main, [str(argument) for argument in arguments])
        if result.exit_code not in (0, 3):  # 3: inputs of the log are unknown for some of the time
            raise click.ClickException(f"{' '.join(map(str, arguments))}: {result.output}")

    done("new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm", "--load", "5kN", "--temperature", "70degC", "-o", folder / "scene")
    done("run", folder / "scene", "--duration", "0.05", "--out", folder / "recording.mcap")
    (folder / "recording.mcap").rename(folder / "recording")
    whole = (folder / "recording").read_bytes()
    (folder / "broken").write_bytes(whole[: len(whole) // 2])
    heading = "t [s],n [rpm],F [N],cage [rpm]\n"
    noise = random.Random(19)
    speeds = [3000 + 20 * (place // 50) for place in range(200)]
    lines = [f"{place / 10},{speed},5000,{(_CAGE_RATIO + noise.gauss(0.0, _CAGE_NOISE)) * speed}\n" for place, speed in enumerate(speeds)]
    (folder / "data").write_text(heading + "".join(lines))
    columns = ["--column", "time=t [s]", "--column", "shaft_speed=n [rpm]", "--column", "radial_load=F [N]", "--column", "cage_speed=cage [rpm]"]
    done("import-csv", "--guess", folder / "data", *columns, "-o", folder / "mapping.yaml")
    (folder / "mapping.yaml").rename(folder / "mapping")
    machine = Machine("outer_ring", 13, 0.19, 0.08, 3000.0 * math.pi / 30.0)
    np.savez(folder / "accelerations.npz", samples=record(machine, 25_600.0, 2.0, np.random.default_rng(1)).vibration.samples, fs=25_600.0)
    done("import-csv", folder / "data", folder / "mapping", "-o", folder / "measured")
    shutil.copy(folder / "measured", folder / "log.mcap")
    (folder / "log.mcap").rename(folder / "log")
    done("sweep", folder / "scene", "--level", "steady", "--vary", "operating.radial_load=4kN:5kN:2", "--workers", "1", "-o", folder / "t.parquet")
    (folder / "t.parquet").rename(folder / "table.parquet")
    for left in ("t.csv", "t.journal"):
        (folder / left).unlink()
    done("replay", folder / "log", "--scene", folder / "scene", "--set", "level=slip", "--state-file", folder / "state")


def arguments_of(name: str, inputs: Path, option, target: Path, *more: str) -> list[str]:
    """Return the arguments of a command that reads files in a folder and writes to a target."""
    files = {path.stem: str(path) for path in inputs.iterdir() if not path.name.startswith(".")}
    return [*(argument.format_map(files) for argument in CASES[name].arguments), option.opts[-1], str(target), *more]


def digests(*folders: Path) -> dict[Path, str]:
    """Return what is at every path in some folders: digests of files, otherwise the kind and the target."""
    found = {}
    for folder in folders:
        for path in folder.rglob("*"):
            mode = path.lstat().st_mode
            if stat.S_ISREG(mode):
                found[path] = hashlib.sha256(path.read_bytes()).hexdigest()
            else:
                found[path] = f"{stat.S_IFMT(mode):o} {os.readlink(path) if path.is_symlink() else ''}"
    return found


class Walk:
    """The trials of one output option; ``counts`` of trials, losses and files left, by the way."""

    def __init__(self, name: str, option, inputs: Path, folder: Path):
        self.name, self.option, self.counts = name, option, Counter()
        self.next = "-"
        self.faults: list[str] = []
        self._inputs, self._folder, self._kind = inputs, folder, option.type
        self._places = 0
        self._usual: dict[str, tuple[int, bytes]] = {}  # length and last bytes of what the command writes, by name

    def _place(self) -> tuple[Path, Path, Path]:
        """Return a folder with copies of the inputs, an empty one, and a target in that."""
        self._places += 1
        place = self._folder / str(self._places)
        shutil.copytree(self._inputs, place / "in")
        (place / "out").mkdir()
        return place / "in", place / "out", place / "out" / file_name(self.option)

    def _own(self, target: Path) -> list[Path]:
        return [*self._kind.made(target), *self._kind.continued(target)]

    def _refused(self, way: str, inputs: Path, out: Path, target: Path, *more: str) -> None:
        before = digests(inputs, out)
        code = self._called(arguments_of(self.name, inputs, self.option, target, *more))
        self._judge(way, code, before, digests(inputs, out), must_fail=True)

    def _called(self, arguments: list[str]) -> int:
        """Return the exit code of a command; an exception that it does not handle is a fault."""
        result = CliRunner().invoke(main, arguments)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            self.counts["lost"] += 1
            self.faults.append(f"{' '.join(arguments)}: {result.exception!r}")
        return result.exit_code

    def _judge(self, way: str, code: int, before: dict, after: dict, must_fail: bool = False, drafts_count: bool = True) -> None:
        self.counts[way] += 1
        changed = [path for path, digest in before.items() if after.get(path) != digest] if code or must_fail else []
        lost = [path.name for path in changed if not self._is_complete(path)]
        if lost or (must_fail and not code):
            self.counts["lost"] += 1
            self.faults.append(f"{way}: exit code {code}, changed: {', '.join(lost) or 'nothing'}")
        left = [path for path in set(after) - set(before) if code and path.suffix not in _KEPT]
        left = [path for path in left if drafts_count or ".bearing_sim_draft" not in path.name]
        if left:
            self.counts["left"] += len(left)
            self.faults.append(f"{way}: exit code {code}, left: {', '.join(path.name for path in left)}")

    def _is_complete(self, path: Path) -> bool:
        """Return whether a file is what the command writes when nothing happens to it, which it is if the signal came after that."""
        usual = self._usual.get(path.name)
        if usual is None or not path.is_file() or path.read_bytes()[-8:] != usual[1]:
            return False
        return path.suffix in _WITH_END or abs(path.stat().st_size - usual[0]) <= 0.05 * usual[0]

    def try_refusals(self) -> None:
        """Try everything that a command has to refuse before it begins."""
        reads = [argument[1:-1] for argument in CASES[self.name].arguments if argument.startswith("{")]
        for source in reads:
            for link in (None, os.link, os.symlink):
                inputs, out, target = self._place()
                path = next(inputs.glob(f"{source}*"))
                if link is None and (self._kind.made(target) and not self._kind.suffixes and not isinstance(self._kind, OutputFolder)):
                    self._refused("input", inputs, out, path, "--force")
                elif link is not None:
                    link(path, self._own(target)[0])
                    self._refused("input", inputs, out, target, "--force")
        if not isinstance(self._kind, (OutputJournal, OutputFolder)):
            for path in self._tables(Path("x") / file_name(self.option)):
                inputs, out, target = self._place()
                (out / path.name).write_bytes(_OLD)
                self._refused("exists", inputs, out, target)
        for make in (lambda path: os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 7)), os.mkfifo, os.mkdir, lambda path: path.symlink_to("gone")):
            if make is os.mkdir and isinstance(self._kind, OutputFolder):
                continue
            inputs, out, target = self._place()
            make(self._own(target)[0])
            self._refused("no file", inputs, out, target, "--force")
        inputs, out, target = self._place()
        self._refused("no file", inputs, out, out / "absent" / target.name, "--force")

    def _tables(self, target: Path) -> list[Path]:
        """Return the files that stand at an output which is replaced."""
        return [path for path in self._own(target) if path.suffix not in _KEPT] if isinstance(self._kind, OutputWithJournal) else [target]

    def try_failures(self, kills: int, chance: random.Random) -> None:
        """Try a full disk, and kills at random instants."""
        inputs, out, target = self._place()
        usual = self._called(arguments_of(self.name, inputs, self.option, target))
        if usual not in (0, 3):  # 3: inputs of the log are unknown for some of the time
            self.counts["lost"] += 1
            self.faults.append(f"exit code {usual} when nothing happens to it, so that no way of failing was tried")
            return
        self._usual = {path.name: (path.stat().st_size, path.read_bytes()[-8:]) for path in out.iterdir()}
        self._full_disk()
        if not kills:
            return
        began = time.monotonic()
        subprocess.run(_COMMAND + arguments_of(self.name, inputs, self.option, target, "--force"), capture_output=True, timeout=_PATIENCE)
        seconds = time.monotonic() - began
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGKILL) * kills:
            inputs, out, target = self._place()
            for path in self._tables(target):
                path.write_bytes(_OLD)
            before = digests(inputs, out)
            command = _COMMAND + arguments_of(self.name, inputs, self.option, target, "--force")
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                process.wait(chance.uniform(0.3, 1.0) * seconds)
            except subprocess.TimeoutExpired:
                process.send_signal(number)
            code = process.wait(_PATIENCE)
            self._judge("killed", 0 if code == usual else code, before, digests(inputs, out), drafts_count=number != signal.SIGKILL)
        again = self._called(command[len(_COMMAND) :])
        self.next = f"{again}"
        if again != usual:
            self.counts["lost"] += 1
            self.faults.append(f"next: exit code {again} instead of {usual}")

    def _full_disk(self) -> None:
        inputs, out, target = self._place()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={_DISK}", "tmpfs", str(out)], check=True)
        try:
            for path in self._tables(target):
                path.write_bytes(_OLD[:4096])
            with open(out / "filler", "wb", buffering=0) as filler:
                try:
                    while filler.write(bytes(1024)):
                        pass
                except OSError:
                    pass
            before = digests(inputs, out)
            code = self._called(arguments_of(self.name, inputs, self.option, target, "--force"))
            self._judge("full disk", code, before, digests(inputs, out), must_fail=True)
        finally:
            subprocess.run(["umount", "-l", str(out)], check=True)


@click.command()
@click.option("--only", multiple=True, metavar="COMMAND", help="Try this command; can be repeated [default: all].")
@click.option("--longest", default=10.0, show_default=True, metavar="S", help="Kill only commands that take about as long.")
@click.option("--kills", default=1, show_default=True, help="Kills by each signal of each output.")
@click.option("--seed", default=19, show_default=True, help="Seed of the instants of kills.")
def walk(only, longest, kills, seed):
    """Try every output of every command, and print a table of it."""
    chance, rows, lost = random.Random(seed), [], 0
    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder) / "inputs"
        inputs.mkdir()
        os.chdir(folder)  # outputs that are not named go into the current folder
        prepare(inputs)
        for number, (name, option) in enumerate(outputs()):
            if only and name not in only:
                continue
            found = Walk(name, option, inputs, Path(folder) / str(number))
            found.try_refusals()
            if CASES[name].seconds <= longest and not isinstance(option.type, (OutputFolder, OutputJournal)):
                found.try_failures(kills, chance)
            counts = [str(found.counts[way] or "-") for way in ("input", "exists", "no file", "full disk", "killed")]
            rows.append((f"{name} {option.opts[-1]}", *counts, str(found.counts["left"]), found.next, str(found.counts["lost"])))
            lost += found.counts["lost"] + found.counts["left"]
            for fault in found.faults:
                click.echo(f"{name} {option.opts[-1]}: {fault}", err=True)
            click.echo(" ".join(rows[-1]), err=True)
            shutil.rmtree(Path(folder) / str(number))
    columns = ("output", "input", "exists", "no file", "full disk", "killed", "left", "next", "lost")
    print_rows(f"{len(rows)} outputs", columns, rows, words=("output",))
    sys.exit(1 if lost else 0)


if __name__ == "__main__":
    walk()
