# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Six typical situations, each a short run of the bearing of Deng 2017, Table 1.

Start from rest, steady light load, skidding during a loss of load, misaligned rings, heavy load, and a fault: the guide land of
the running machine closes up, unknown to the model, and the measured cage falls behind the predicted one.
"""

import dataclasses
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Event, Level, Measurement
from bearing_sim.runtime.health import Changes
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation, scene_inputs
from bearing_sim.watchers.monitoring.monitor import Monitor
from bearing_sim.watchers.monitoring.residual import ResidualMonitor

BASE = "deng2017_table1"
_BLOCK = 10  # samples
_NOISE = 3e-4  # standard deviation of a measured slip, a fraction
_LOOSE = "bearing.outer_raceway.low_radius=34.87 mm"  # little preload, so that the cage slips early
_QUICK = [  # short delays of alarms, for runs of a second
    "thresholds.slip_hold={raise_after: 10 ms, clear_after: 50 ms}",
    "thresholds.life_hold={raise_after: 10 ms, clear_after: 50 ms}",
    "thresholds.residual={batch: 10 ms, learning: 1 s, settling: 100 ms, memory: 100 ms, false_alarm_time: 1 h, tolerance: 0.1 %}",
]


class Situation(NamedTuple):
    """One situation.

    Attributes
    ----------
    name : of its files.
    title : one sentence.
    overrides : of the scene `BASE`.
    duration, rate : simulated time [s] and samples per second.
    course : function of the time [s] and the scene's inputs that returns the inputs; constant by default.
    picture_at : time of the picture [s].
    fault : time of a change of the machine [s] and its overrides; None: no separate machine is simulated.
    """

    name: str
    title: str
    overrides: tuple[str, ...]
    duration: float
    rate: float
    picture_at: float
    course: Callable[[float, Inputs], Inputs] = lambda time, inputs: inputs
    fault: tuple[float, tuple[str, ...]] | None = None

    def scene(self) -> Scene:
        """Return the scene of the model."""
        return dataclasses.replace(load_scene(BASE, [*_QUICK, *self.overrides]), name=self.name, description=self.title)


def _smooth(fraction: float) -> float:
    fraction = min(max(fraction, 0.0), 1.0)
    return fraction * fraction * (3.0 - 2.0 * fraction)


def _run_up(time: float, inputs: Inputs) -> Inputs:
    return inputs._replace(shaft_speed=inputs.shaft_speed * _smooth((time - 0.02) / 0.5))


def _gust(time: float, inputs: Inputs) -> Inputs:
    factor = 1.0 - 0.95 * (_smooth((time - 0.3) / 0.03) - _smooth((time - 0.45) / 0.03))
    return inputs._replace(load_y=inputs.load_y * factor, load_z=inputs.load_z * factor)


SITUATIONS = (
    Situation(
        "start_from_rest",
        "The shaft runs up from rest to 20,000 rpm in half a second; the rollers drag the cage along.",
        ("level=planar", "operating.shaft_speed=20000 rpm", "operating.radial_load=300 N"),
        0.6,
        1000.0,
        0.3,
        course=_run_up,
    ),
    Situation(
        "steady_light_load",
        "30,000 rpm and 100 N: the preload of the lobes alone keeps the cage near its speed.",
        ("level=planar", "operating.shaft_speed=30000 rpm", "operating.radial_load=100 N"),
        0.1,
        6000.0,
        0.1,
    ),
    Situation(
        "skid_in_a_gust",
        "A gust removes nearly all of the load for 0.15 s at 33,000 rpm and little preload: the cage skids, and recovers when the load returns.",
        ("level=planar", _LOOSE, "operating.shaft_speed=33000 rpm", "operating.radial_load=1200 N"),
        0.7,
        1500.0,
        0.36,
        course=_gust,
    ),
    Situation(
        "misaligned",
        "The inner ring is misaligned by 2 mrad at 5000 rpm and 2 kN: rollers tilt and skew, with high pressure at their ends.",
        (
            "level=spatial",
            "bearing.roller.crown=iso_log",
            "operating.misalignment=2 mrad",
            "operating.shaft_speed=5000 rpm",
            "operating.radial_load=2 kN",
        ),
        0.03,
        8000.0,
        0.03,
    ),
    Situation(
        "heavy_load",
        "6 kN at 15,000 rpm: the loaded rollers drive the cage at its ideal speed; the rating life is a few hours.",
        ("level=planar", "operating.shaft_speed=15000 rpm", "operating.radial_load=6 kN"),
        0.1,
        3000.0,
        0.1,
    ),
    Situation(
        "fault_injected",
        "The guide land of the machine closes from 150 to 10 um and brakes the cage, unknown to the model: measured slip departs from prediction.",
        ("level=slip", "operating.shaft_speed=30000 rpm"),
        2.2,
        250.0,
        2.2,
        fault=(1.5, ("bearing.cage.guide_clearance=10 um", "bearing.cage.outer_radius=null")),
    ),
)


def play(situation: Situation, scene: Scene) -> Iterator[np.ndarray | Event | Measurement]:
    """Run a situation; yield blocks of samples, events and measurements of the cage, in order of time.

    Parameters
    ----------
    situation : to run.
    scene : as returned by `Situation.scene`.
    """
    given = scene_inputs(scene)
    model = Simulation(scene, situation.course(0.0, given))
    machine = Simulation(scene, model.inputs) if situation.fault else None
    monitors, samples, random = _Monitors(scene), round(situation.duration * situation.rate), np.random.default_rng(1)
    for done in range(0, samples, _BLOCK):
        count = min(_BLOCK, samples - done)
        end = (done + count) / situation.rate
        inputs = situation.course(end, given)
        block = model.advance(count / situation.rate, inputs, count)
        yield block
        if machine is not None:
            machine = _with_fault(machine, situation, done / situation.rate)
            yield from monitors.compare(block, machine.advance(count / situation.rate, inputs, count), random)
        yield from monitors.changes(block)
        if machine is not None and done / situation.rate < situation.fault[0] <= end:
            yield Event(end, Level.OK, "study.fault", "", "the guide land of the machine closes, unknown to the model")


def _with_fault(machine: Simulation, situation: Situation, now: float) -> Simulation:
    """Return the machine from time ``now`` [s] on."""
    begins, changes = situation.fault
    if now < begins * (1 - 1e-9) or machine.scene.bearing.cage != situation.scene().bearing.cage:
        return machine
    changed = Simulation(situation._replace(overrides=(*situation.overrides, *changes)).scene(), machine.inputs)
    changed.take_over(machine)
    return changed


class _Monitors:
    """Monitors of one run; each change of a condition is reported once."""

    def __init__(self, scene: Scene):
        self._monitor = Monitor(scene)
        self._residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self._changes = Changes()

    def changes(self, block: np.ndarray) -> list[Event]:
        """Return the conditions that changed in a block."""
        self._monitor.judge(block)
        now = float(block["time"][-1])
        return self._changes.update(now, (*self._monitor.events(now), *self._residual.events(now)))

    def compare(self, predicted: np.ndarray, true: np.ndarray, random: np.random.Generator) -> Iterator[Measurement]:
        """Yield measurements of the machine with sensor noise, and monitor their residuals."""
        for one, other in zip(predicted, true):
            ideal = float(one["ideal_cage_speed"])
            speed = float(other["cage_speed"]) + _NOISE * ideal * random.normal()
            measured = 1.0 - speed / ideal
            self._residual.compare(float(one["time"]), float(one["shaft_speed"]), measured, float(one["cage_slip"]))
            yield Measurement(float(one["time"]), speed, measured - float(one["cage_slip"]))
