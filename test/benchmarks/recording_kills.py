# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Kill live recordings at random moments and count what is lost.

A recording in real time has two processes, the one that simulates and feeds, and the one that writes (`bearing_sim.sinks.recorder`).
"""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.recording_reader import Recording
from bearing_sim.recovery import contents, recover
from bearing_sim.sample import new_block
from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import Inputs
from bearing_sim.sinks.recorder import Recorder

RATE = 1000.0  # Hz
_BEAT = 0.005  # [s] between blocks
_LONGEST_RUN = 3.0  # [s]
_START_UP = 60.0  # [s] that processes may take to begin and to end, on a busy machine
_TOLD = 42  # exit code of a feeder that was told of its writer's end
VICTIMS = ("feeder", "writer", "both")
"""Processes to kill: the one that feeds, whose file the other one completes; the one that writes, whose file is recovered; both at once."""


class Kill(NamedTuple):
    """What one killed recording left.

    Attributes
    ----------
    victim : one of `VICTIMS`.
    after : when it was killed [s after its first sample].
    recorded, recovered : samples that it had handed to its recording, and that came back.
    lost : time of the samples that did not [s].
    gaps : samples missing before the last one that came back.
    """

    victim: str
    after: float
    recorded: int
    recovered: int
    lost: float
    gaps: int


def kill_recordings(folder: Path, kills: int, seed: int, progress: Callable[[str], None] = lambda text: None) -> list[Kill]:
    """Start recordings of all observables at `RATE`, end each by SIGKILL at a moment of its own, and read or recover its file.

    Parameters
    ----------
    folder : where the recordings go; kept.
    kills : how many; the victims take turns.
    seed : of the moments, uniform over `_LONGEST_RUN`.
    progress : told what is being done.

    Raises
    ------
    bearing_sim.recovery.RecoveryError
        Nothing could be recovered of a file.
    RuntimeError
        A process did not do what it should.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    moments = np.random.default_rng(seed).uniform(0.0, _LONGEST_RUN, kills)
    told = []
    for number, moment in enumerate(moments.tolist()):
        told.append(_kill_one(context, folder / f"run_{number}.mcap", moment, VICTIMS[number % len(VICTIMS)]))
        progress(f"{number + 1} of {kills}: {told[-1].victim} killed after {told[-1].after:.3f} s, lost {told[-1].lost:.3f} s")
    return told


def _kill_one(context, path: Path, moment: float, victim: str) -> Kill:
    recorded, writer = context.Value("q", 0), context.Value("q", 0)
    feeder = context.Process(target=_record, args=(path, recorded, writer), daemon=True)
    feeder.start()
    _wait_until(lambda: recorded.value or feeder.exitcode is not None, f"{path} begins")
    began = time.monotonic()
    time.sleep(moment)
    after = time.monotonic() - began
    if victim != "feeder":
        os.kill(writer.value, signal.SIGKILL)
    if victim != "writer":
        feeder.kill()
    feeder.join()
    if feeder.exitcode != (_TOLD if victim == "writer" else -signal.SIGKILL):
        raise RuntimeError(f"the process that feeds {path} ended otherwise than by the death of the {victim}, exit code {feeder.exitcode}")
    times = _times(path, complete=victim == "feeder")
    if not len(times):
        return Kill(victim, after, recorded.value, 0, recorded.value / RATE, 0)
    last = round(float(times[-1]) * RATE)
    return Kill(victim, after, recorded.value, len(times), max(recorded.value - last, 0) / RATE, last - len(times))


def _times(path: Path, complete: bool) -> np.ndarray:
    """Return the times of the samples that are left [s]; a file is to be complete in a moment, or is recovered."""
    if complete:
        _wait_until(path.exists, f"{path} is completed")
    else:
        remains, path = path.with_name(path.name + ".active"), path.with_name(f"{path.stem}_recovered.mcap")
        recover(remains, path)
    if not contents(path).messages:  # killed before anything left the process
        return np.empty(0)
    return np.concatenate([item["time"] for item in Recording(path) if isinstance(item, np.ndarray)])


def _wait_until(condition: Callable[[], object], what: str) -> None:
    limit = time.monotonic() + _START_UP
    while not condition():
        if time.monotonic() > limit:
            raise RuntimeError(f"waited {_START_UP:g} s in vain until {what}")
        time.sleep(0.001)


def _record(path: Path, recorded, writer) -> None:
    """Record samples in real time, and say after each block how many there are; until killed, or told that nobody writes any more."""
    scene = load_scene("deng2017_table1")
    inputs = Inputs(4712.0, 800.0, 0.0, 393.15)
    recorder = Recorder()
    sink = recorder.open(path, scene, time.time_ns())
    writer.value = recorder.pid
    samples = round(_BEAT * RATE)
    block = new_block(samples, scene.bearing.roller.count)
    noise = np.random.default_rng(1)
    began, done = time.monotonic(), 0
    while True:
        block["inner_load"] = noise.normal(size=block["inner_load"].shape)  # does not compress away
        block["time"] = (done + 1 + np.arange(samples)) / RATE
        try:
            sink.write_inputs(done / RATE, inputs)
            sink.write(block)
        except OSError:
            os._exit(_TOLD)
        done += samples
        recorded.value = done
        time.sleep(max(0.0, began + done / RATE - time.monotonic()))
