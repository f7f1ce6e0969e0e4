# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Kill recorders at random moments and count what is lost."""

import multiprocessing
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.recording_reader import Recording
from bearing_sim.recovery import recover
from bearing_sim.sample import new_block
from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import Inputs
from bearing_sim.sinks.mcap_sink import McapSink

RATE = 1000.0  # Hz
_BEAT = 0.005  # [s] between blocks
_LONGEST_RUN = 3.0  # [s]
_START_UP = 60.0  # [s] that a recorder may take to begin, on a busy machine


class Kill(NamedTuple):
    """What one killed recorder left.

    Attributes
    ----------
    after : when it was killed [s after its first sample].
    recorded, recovered : samples that it had handed to its recording, and that came back.
    lost : time of the samples that did not [s].
    gaps : samples missing before the last one that came back.
    """

    after: float
    recorded: int
    recovered: int
    lost: float
    gaps: int


def kill_recorders(folder: Path, kills: int, seed: int, progress: Callable[[str], None] = lambda text: None) -> list[Kill]:
    """Start recorders of all observables at `RATE`, end each by SIGKILL at a moment of its own, and recover its file.

    Parameters
    ----------
    folder : where the recordings go; kept.
    kills : how many.
    seed : of the moments, uniform over `_LONGEST_RUN`.
    progress : told what is being done.

    Raises
    ------
    bearing_sim.recovery.RecoveryError
        Nothing could be recovered of a file.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    moments = np.random.default_rng(seed).uniform(0.0, _LONGEST_RUN, kills)
    told = []
    for number, moment in enumerate(moments.tolist()):
        told.append(_kill_one(context, folder / f"run_{number}.mcap", moment))
        progress(f"{number + 1} of {kills}: killed after {told[-1].after:.3f} s, lost {told[-1].lost:.3f} s")
    return told


def _kill_one(context, path: Path, moment: float) -> Kill:
    recorded = context.Value("q", 0)
    recorder = context.Process(target=_record, args=(path, recorded), daemon=True)
    recorder.start()
    limit = time.monotonic() + _START_UP
    while recorded.value == 0 and time.monotonic() < limit:
        time.sleep(0.001)
    began = time.monotonic()
    time.sleep(moment)
    after = time.monotonic() - began
    recorder.kill()
    recorder.join()
    if recorder.exitcode != -signal.SIGKILL:
        raise RuntimeError(f"the recorder of {path} ended by itself, exit code {recorder.exitcode}")
    good = path.with_name(f"{path.stem}_recovered.mcap")
    if not recover(path.with_name(path.name + ".active"), good).messages:  # killed before anything left the process
        return Kill(after, recorded.value, 0, recorded.value / RATE, 0)
    times = np.concatenate([item["time"] for item in Recording(good) if isinstance(item, np.ndarray)])
    last = round(float(times[-1]) * RATE)
    return Kill(after, recorded.value, len(times), max(recorded.value - last, 0) / RATE, last - len(times))


def _record(path: Path, recorded) -> None:
    """Record samples in real time, and say after each block how many there are; until killed."""
    scene = load_scene("deng2017_table1")
    inputs = Inputs(4712.0, 800.0, 0.0, 393.15)
    with McapSink(path, scene, time.time_ns()) as sink:
        samples = round(_BEAT * RATE)
        block = new_block(samples, scene.bearing.roller.count)
        noise = np.random.default_rng(1)
        began, done = time.monotonic(), 0
        while True:
            block["inner_load"] = noise.normal(size=block["inner_load"].shape)  # does not compress away
            block["time"] = (done + 1 + np.arange(samples)) / RATE
            sink.write_inputs(done / RATE, inputs)
            sink.write(block)
            done += samples
            recorded.value = done
            time.sleep(max(0.0, began + done / RATE - time.monotonic()))
