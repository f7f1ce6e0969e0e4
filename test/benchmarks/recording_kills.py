# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How much a killed recording loses: ``python test/benchmarks/recording_kills.py``.

A thread of the process that simulates writes (`bearing_sim.recording.recorder`).  The benchmark kills the process at random moments, recovers every
file, and counts what is missing.

How to read it: "lost" is the time between the last sample handed over and the last sample recovered; no file may lose more than 1 s or have a hole
before its last sample.  Exit code 1 otherwise.
"""

import multiprocessing
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np

from bearing_sim.cli.options import json_option
from bearing_sim.cli.reporting import FailedRun, print_json, print_table
from bearing_sim.messages.events import ReceivedInputs
from bearing_sim.model.sample import new_block
from bearing_sim.recording.bag import RecordingError
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recorder import Recorder
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

RATE = 1000.0  # Hz
_BLOCK_PERIOD = 0.005  # [s] between blocks
_LONGEST_RUN = 3.0  # [s]
_START_UP = 60.0  # [s] for processes to start and to end on a busy machine
_PROMISE = 1.0  # [s] that a killed recording may lose


class Kill(NamedTuple):
    """The result of killing one recording.

    Attributes
    ----------
    after : when it was killed [s after its first sample].
    recorded, recovered : samples handed to the recording, and samples recovered.
    lost : time between the last sample handed over and the last one recovered [s].
    gaps : samples missing before the last one recovered.
    """

    after: float
    recorded: int
    recovered: int
    lost: float
    gaps: int


def kill_recordings(folder: Path, kills: int, seed: int, progress: Callable[[str], None] = lambda text: None) -> list[Kill]:
    """Start recordings of all observables at `RATE`, end each by SIGKILL at a random moment, and read or recover its file.

    Parameters
    ----------
    folder : for the recordings, which are kept.
    kills : number of recordings.
    seed : of the moments, uniform over `_LONGEST_RUN`.
    progress : called with a text after each kill.

    Raises
    ------
    bearing_sim.recording.bag.RecordingError
        Nothing could be recovered from a file.
    RuntimeError
        A recording did not begin.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    moments = np.random.default_rng(seed).uniform(0.0, _LONGEST_RUN, kills)
    kills_done = []
    for number, moment in enumerate(moments.tolist()):
        kills_done.append(_kill_one(context, folder / f"run_{number}.mcap", moment))
        progress(f"{number + 1} of {kills}: killed after {kills_done[-1].after:.3f} s, lost {kills_done[-1].lost:.3f} s")
    return kills_done


def _kill_one(context, path: Path, moment: float) -> Kill:
    recorded = context.Value("q", 0)
    feeder = context.Process(target=_record, args=(path, recorded), daemon=True)
    feeder.start()
    _wait_until(lambda: recorded.value or feeder.exitcode is not None, f"{path} begins")
    began = time.monotonic()
    time.sleep(moment)
    after = time.monotonic() - began
    feeder.kill()
    feeder.join()
    times = _times(path)
    if not len(times):
        return Kill(after, recorded.value, 0, recorded.value / RATE, 0)
    last = round(float(times[-1]) * RATE)
    return Kill(after, recorded.value, len(times), max(recorded.value - last, 0) / RATE, last - len(times))


def _times(path: Path) -> np.ndarray:
    """Return the times of the samples that are recovered [s]."""
    remains, path = path.with_name(path.name + ".active"), path.with_name(f"{path.stem}_recovered.mcap")
    recover(remains, path)
    if not contents(path).messages:  # killed before anything had left the process
        return np.empty(0)
    return np.concatenate([item["time"] for item in Recording(path) if isinstance(item, np.ndarray)])


def _wait_until(condition: Callable[[], object], what: str) -> None:
    limit = time.monotonic() + _START_UP
    while not condition():
        if time.monotonic() > limit:
            raise RuntimeError(f"waited {_START_UP:g} s in vain: {what}")
        time.sleep(0.001)


def _record(path: Path, recorded) -> None:
    """Record samples in real time and report their number after each block, until killed."""
    scene = load_scene("deng2017_table1")
    inputs = Inputs(4712.0, 800.0, 0.0, 393.15)
    recorder = Recorder()
    sink = recorder.open(path, scene, time.time_ns())
    samples = round(_BLOCK_PERIOD * RATE)
    block = new_block(samples, scene.bearing.roller.count)
    noise = np.random.default_rng(1)
    began, done = time.monotonic(), 0
    while True:
        block["inner_load"] = noise.normal(size=block["inner_load"].shape)  # incompressible
        block["time"] = (done + 1 + np.arange(samples)) / RATE
        sink.write(ReceivedInputs(done / RATE, inputs))
        sink.write(block.copy())
        done += samples
        recorded.value = done
        time.sleep(max(0.0, began + done / RATE - time.monotonic()))


@click.command()
@click.option("--kills", type=click.IntRange(min=1), default=60, show_default=True, metavar="N", help="Number of recordings to kill.")
@click.option("--seed", type=int, default=1, show_default=True, help="Seed of the random moments.")
@json_option
def command(kills, seed, as_json):
    """Kill recordings of all observables at 1 kHz at random moments (SIGKILL), recover every file, and report what was lost.

    Exit code 1 if a file lost more than 1 s or has a gap.
    """
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = kill_recordings(Path(folder), kills, seed, lambda text: click.echo(text, err=True))
        except RecordingError as error:
            raise FailedRun(str(error)) from None
    lost = np.array([kill.lost for kill in done])
    holes = sum(kill.gaps for kill in done)
    report = {
        "kills": kills,
        "seed": seed,
        "recovered": len(done),
        "lost_median": float(np.median(lost)),
        "lost_most": float(lost.max()),
        "holes": holes,
    }
    if as_json:
        print_json({**report, "each": [kill._asdict() for kill in done]})
    else:
        rows = [
            ("recovered", f"{len(done)} of {kills} files"),
            ("lost", f"median {np.median(lost):.3f} s, most {lost.max():.3f} s"),
            ("samples missing before the last", str(holes)),
        ]
        print_table(f"recordings of all observables at 1 kHz, killed (seed {seed})", rows)
    if lost.max() > _PROMISE or holes:
        raise FailedRun(f"a killed recording lost {lost.max():.3f} s, {holes} samples are missing in between")


if __name__ == "__main__":
    command()
