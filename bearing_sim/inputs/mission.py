# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bundled mission: a synthetic engine cycle for demonstrations, not a measurement.

Start, idle, take-off at 45,000 rpm, cruise, descent under light load with a gust, stop.
"""

import csv
import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.messages import topics
from bearing_sim.recording.writer import McapFile
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation

DURATION = 60.0  # [s]
METADATA = "bearing_sim_mission"
"""Name of the metadata record: synthetic ("true"), duration [s], rate [Hz], package_version, git_hash; of a cage what is said to be measured."""
CAGE_RATE, CAGE_NOISE = 10.0, 0.002
"""Of the synthetic sensor of the cage: readings a second [Hz], and the standard deviation of one over the ideal cage's speed."""
_SEED = 1

_ROWS = csv.reader(Path(__file__).with_name("mission.csv").read_text("utf-8").splitlines()[1:])
PHASES = tuple((name, *map(float, numbers)) for name, *numbers in _ROWS)
"""For each phase: its name, its end as a fraction of the mission, and the inputs at its end (see the heading of the file)."""
_GUST = (0.73, 0.05, 700.0, -400.0)  # centre and width as fractions of the mission; peak of the additional load along y and z [N]


def mission(time: float, duration: float = DURATION) -> Inputs:
    """Return the inputs at a time of the mission.

    Every input follows the smooth step 3 s^2 - 2 s^3 from phase to phase, so its first derivative is continuous; the gust during the descent
    is a raised cosine.  Before the start and after the end the shaft is at rest.

    Parameters
    ----------
    time : since the start of the mission [s].
    duration : length of the whole mission [s]; all phases scale with it.
    """
    fraction = min(max(time / duration, 0.0), 1.0)
    begin, before = 0.0, PHASES[0][2:]
    for _, end, *reached in PHASES:
        if fraction <= end:
            break
        begin, before = end, reached
    part = (fraction - begin) / (end - begin)
    step = part * part * (3.0 - 2.0 * part)
    speed_rpm, load_y, load_z, celsius = (old + step * (new - old) for old, new in zip(before, reached))
    gust = _gust(fraction)
    return Inputs(speed_rpm * math.pi / 30, load_y + gust * _GUST[2], load_z + gust * _GUST[3], celsius + topics.ZERO_CELSIUS)


def _gust(fraction: float) -> float:
    centre, width = _GUST[:2]
    away = abs(fraction - centre) / width
    return 0.5 * (1.0 + math.cos(2.0 * math.pi * away)) if away < 0.5 else 0.0


def write_mission(
    path: str | Path,
    start_ns: int,
    duration: float = DURATION,
    rate: float = 50.0,
    progress: Callable[[float], None] = lambda seconds: None,
    replace: bool = True,
    machine: Scene | None = None,
) -> int:
    """Write the mission as an input log.

    Parameters
    ----------
    path : the recording to write.
    start_ns : time 0 [ns since the epoch].
    duration : length of the mission [s].
    rate : rate of the messages of speed and load [Hz]; the oil temperature has one per second.
    progress : called repeatedly with the time reached [s].
    replace : whether an existing recording is replaced.
    machine : a bearing whose cage is said to be measured: what its model computes, with noise.  None: no cage is measured.

    Returns
    -------
    Number of messages written.

    Raises
    ------
    IntegrationError
        The model of the machine cannot be advanced.
    """
    origin = {"package_version": package_version(), "git_hash": git_hash()}
    record = {"synthetic": "true", "duration": repr(duration), "rate": repr(rate), **origin}
    if machine is not None:
        text = (
            f"synthetic: the model of {machine.name} at level {machine.level}, with noise of {100 * CAGE_NOISE:g} points of slip at {CAGE_RATE:g} Hz"
        )
        record["cage"] = text
    cage = _Cage(machine, duration) if machine is not None else None
    ticks, written = round(duration * rate), 0
    with McapFile(path, {METADATA: record}, {"generator": "bearing_sim", "synthetic": "true", **origin}, replace=replace) as recording:
        next_oil = 0.0
        for tick in range(ticks + 1):
            time = tick / rate
            inputs, stamp = mission(time, duration), start_ns + round(tick * 1e9 / rate)
            channels = ["shaft_speed", "radial_load"]
            if time >= next_oil:
                channels.append("oil_temperature")
                next_oil += 1.0
            for channel in channels:
                topic = topics.INPUTS[channel]
                recording.write(f"/{topic.name}", topic.ros_type, stamp, topic.message(stamp, inputs))
            written += len(channels)
            if cage is not None:
                for reading, speed in cage.until(time):
                    topic, stamp = topics.MEASUREMENTS[topics.MEASURED], start_ns + round(reading * 1e9)
                    recording.write(f"/{topic.name}", topic.ros_type, stamp, topic.message(stamp, (speed,)))
                    written += 1
            progress(time)
    return written


class _Cage:
    """The synthetic measured cage of the mission.

    Parameters
    ----------
    machine : whose model is the machine.
    duration : of the mission [s].
    """

    def __init__(self, machine: Scene, duration: float):
        self._simulation, self._duration = Simulation(machine, mission(0.0, duration)), duration
        self._random, self._count = np.random.default_rng(_SEED), 0

    def until(self, time: float) -> Iterator[tuple[float, float]]:
        """Yield times [s] and measured speeds [rad/s] of the readings up to a time of the mission [s]."""
        while (reading := (self._count + 1) / CAGE_RATE) <= time + 1e-9:
            self._count += 1
            sample = self._simulation.advance(1.0 / CAGE_RATE, mission(reading, self._duration))[-1]
            noise = CAGE_NOISE * float(sample["ideal_cage_speed"]) * self._random.normal()
            yield reading, float(sample["cage_speed"]) + noise
