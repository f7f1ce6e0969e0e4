# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Look for files that a reader neither takes nor refuses: ``python test/benchmarks/fuzz.py --minutes 60``.

Every target of ``test/fuzzing.py`` gets its share of the time, in a process of its own with 2 GB of address space on top of what the loaded
program occupies.  hypothesis makes the content, from another seed each time, and reduces what fails to a small example, which is written to the
folder ``--keep`` with the traceback beside it.  A content that takes longer than `SLOW` is a fault, too.  The exit code is 1 if there was one; copy
such a content to ``test/corpus/TARGET/`` once it is mended, so that the tests read it ever after.
"""

import random
import resource
import sys
import time
import traceback
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import click

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import fuzzing  # noqa: E402
from hypothesis import HealthCheck, Phase, given, seed, settings  # noqa: E402
from hypothesis.errors import Flaky, FlakyFailure  # noqa: E402

from bearing_sim.cli.reporting import print_rows  # noqa: E402

SLOW = 20.0  # [s] that reading a small file may take
_SPARE = 2_000_000_000  # [byte]
_ROUND = 200  # examples between looks at the clock
_PHASES = (Phase.generate, Phase.shrink)


class Outcome(NamedTuple):
    """What came of one target.

    Attributes
    ----------
    examples, taken : contents read, and those that were not refused.
    longest : time that one took [s].
    memory : largest resident memory of the process [MB].
    faults : by place in the code, a content and its traceback.
    """

    examples: int
    taken: int
    longest: float
    memory: float
    faults: dict[str, tuple[bytes, str]]


def _fuzzed(target: str, seconds: float, first_seed: int) -> Outcome:
    """Read contents of a target for a while."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + _SPARE
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    examples, taken, longest, faults, number = 0, 0, 0.0, {}, first_seed
    newest: list[tuple[str, bytes, str]] = []

    def read(content: bytes) -> None:
        nonlocal examples, taken, longest
        examples += 1
        began = time.monotonic()
        try:
            taken += fuzzing.taken_or_refused(target, content)
        except Exception as error:
            place = _place(error)
            newest.append((place, content, traceback.format_exc()))
            if place in faults:
                return  # known: look for others
            raise
        finally:
            longest = max(longest, time.monotonic() - began)
        if time.monotonic() - began > SLOW:
            faults.setdefault(f"slower than {SLOW:g} s", (content, ""))

    end = time.monotonic() + seconds
    while time.monotonic() < end:
        number += 1
        chosen = settings(
            max_examples=_ROUND, database=None, deadline=None, derandomize=False, phases=_PHASES, suppress_health_check=list(HealthCheck)
        )
        try:
            seed(number)(chosen(given(fuzzing.TARGETS[target].contents)(read)))()
        except (Flaky, FlakyFailure):
            pass  # the reduced content fails elsewhere, where a fault is known
        except Exception:  # the fault, reduced
            pass
        for place, content, text in newest:
            if place not in faults or len(content) < len(faults[place][0]):
                faults[place] = (content, text)
        newest.clear()
    return Outcome(examples, taken, longest, 1e-3 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, faults)


def _place(error: BaseException) -> str:
    """Return where in the package an error comes from: type, file and line."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if "bearing_sim/" in frame.filename] or frames
    return f"{type(error).__name__} at {own[-1].filename.partition('bearing_sim/')[2] or own[-1].filename}:{own[-1].lineno}"


@click.command()
@click.option("--minutes", default=10.0, show_default=True, help="Time for all targets together, on one core.")
@click.option("--target", "targets", type=click.Choice([*fuzzing.TARGETS]), multiple=True, help="Only this target; can be repeated.")
@click.option("--seed", "first_seed", type=int, help="Of the first examples [default: random].")
@click.option("--keep", default="faults", show_default=True, type=click.Path(path_type=Path), help="Folder for contents that fail.")
def main(minutes: float, targets: tuple[str, ...], first_seed: int | None, keep: Path):
    """Look for files that a reader neither takes nor refuses."""
    chosen = targets or tuple(fuzzing.TARGETS)
    first_seed = random.randrange(2**31) if first_seed is None else first_seed
    rows, found = [], 0
    for target in chosen:
        with ProcessPoolExecutor(1) as pool:
            outcome = pool.submit(_fuzzed, target, 60.0 * minutes / len(chosen), first_seed).result()
        for number, (place, (content, text)) in enumerate(outcome.faults.items(), 1):
            folder = keep / target
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{first_seed}_{number}").write_bytes(content)
            (folder / f"{first_seed}_{number}.txt").write_text(f"{place}\n{text}")
            click.echo(f"{target}: {place}: {folder / f'{first_seed}_{number}'}", err=True)
        found += len(outcome.faults)
        figures = (outcome.examples, outcome.taken, f"{outcome.longest:.2f}", f"{outcome.memory:.0f}", len(outcome.faults))
        rows.append((target, *map(str, figures)))
    print_rows(f"From seed {first_seed}", ("target", "contents", "taken", "longest [s]", "memory [MB]", "faults"), rows)
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
