# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The error that a governed model publishes beside the one it has.

First ``bearing-sim trade SCENE``, then ``python test/benchmarks/governed_error.py SCENE``.

One live model runs in real time while other processes keep the cores busy, so that its governor falls along the front that `trade` kept for this
bearing and machine.  The load alternates between all and half of the scene's.  Over the second half of each stretch of constant load, the mean
slip is compared with that of level planar at a tenth of the scene's tolerances, settled at the same inputs; the table has the root mean
square of these differences for each setting that ran, beside the measured error that the model published meanwhile.
"""

import dataclasses
import subprocess
import sys
import time

import click
import numpy as np

from bearing_sim.cli.options import json_option, set_option
from bearing_sim.cli.reporting import print_json, print_rows
from bearing_sim.runtime.governor import settings_to_fall
from bearing_sim.runtime.live import LiveModel, governor_of, warmed_up
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.measured_tradeoffs import read_kept_tradeoffs
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation

_INPUT_PERIOD = 0.02  # [s] between messages
_SETTLING = 0.3, 0.3  # [s] of the reference: before its mean, and of it
_TIGHT = 0.1  # times the scene's tolerances
_SHARES = 1.0, 0.5  # of the scene's load


class _Kept:
    """A sink that keeps time and slip of every sample."""

    dropped = 0

    def __init__(self):
        self.samples = []

    def write(self, record) -> None:
        if isinstance(record, np.ndarray):
            self.samples += zip(record["time"].tolist(), record["cage_slip"].tolist())

    def close(self) -> None:
        pass


def settled_slip(scene: Scene, share: float) -> float:
    """Return the mean slip in which level planar settles at a share of the scene's load, at tight tolerances."""
    tight = dataclasses.replace(scene, level="planar", integration=scene.integration.with_tolerances(_TIGHT))
    simulation = Simulation(tight)
    inputs = simulation.inputs._replace(load_y=share * simulation.inputs.load_y, load_z=share * simulation.inputs.load_z)
    simulation.advance(_SETTLING[0], inputs)
    return float(simulation.advance(_SETTLING[1], inputs, 300)["cage_slip"].mean())


def governed(scene: Scene, busy: int, stretch: float, stretches: int) -> dict:
    """Run the scene in real time beside busy processes and return published and measured errors of slip by setting.

    Parameters
    ----------
    scene : whose front is kept.
    busy : processes that only count.
    stretch : time of constant load [s].
    stretches : how many.

    Raises
    ------
    click.ClickException
        No front is kept where the scene operates.
    """
    kept = read_kept_tradeoffs(scene)
    settings = settings_to_fall(scene, kept)
    if not settings:
        raise click.ClickException(f"no front is kept for this bearing and machine; measure it with: bearing-sim trade {scene.name}")
    reference = [settled_slip(scene, share) for share in _SHARES]
    simulation = warmed_up(scene)
    governor, sink, notes = governor_of(simulation, settings, kept.at(scene).courses), _Kept(), []
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
    start = time.time_ns()
    live = LiveModel(scene, simulation, start, governor=governor)
    live.sinks.attach("kept", sink)
    try:
        inputs, began = simulation.inputs, time.monotonic()
        while (now := time.monotonic() - began) < stretch * stretches:
            share = _SHARES[int(now / stretch) % len(_SHARES)]
            live.offer("shaft_speed", (inputs.shaft_speed,), time.time_ns(), time.time_ns())
            live.offer("radial_load", (share * inputs.load_y, share * inputs.load_z), time.time_ns(), time.time_ns())
            live.collect(time.time_ns())
            notes.append((live.run_time(time.time_ns()), governor.setting, governor.slip_error))
            time.sleep(_INPUT_PERIOD)
    finally:
        for other in others:
            other.kill()
            other.wait()
        live.close()
    rows = _by_setting(np.array(sink.samples), notes, reference, stretch, stretches)
    return {"scene": scene.name, "busy": busy, "settings": rows, "real_time": float(sink.samples[-1][0] / (stretch * stretches))}


def _by_setting(samples: np.ndarray, notes: list[tuple[float, str, float]], reference: list[float], stretch: float, stretches: int) -> list[dict]:
    """Return published and measured error of each setting, from the second half of each stretch that it ran alone."""
    errors, published = {}, {}
    for k in range(stretches):
        begin, end = (k + 0.5) * stretch, (k + 1) * stretch
        ran = {(setting, error) for at, setting, error in notes if begin <= at < end}
        within = samples[(samples[:, 0] >= begin) & (samples[:, 0] < end), 1]
        if len(ran) != 1 or not within.size:
            continue
        setting, error = ran.pop()
        published[setting] = error
        errors.setdefault(setting, []).append(within.mean() - reference[k % len(_SHARES)])
    return [
        {"setting": name, "stretches": len(found), "published": published[name], "measured": float(np.sqrt(np.mean(np.square(found))))}
        for name, found in errors.items()
    ]


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("scene_name", metavar="SCENE")
@set_option
@click.option("--busy", type=click.IntRange(min=0), default=2, show_default=True, help="Processes that keep the cores busy.")
@click.option("--stretch", type=click.FloatRange(min=0.2), default=2.0, show_default=True, metavar="S", help="Time of constant load.")
@click.option("--stretches", type=click.IntRange(min=2), default=20, show_default=True, metavar="N")
@json_option
def main(scene_name: str, overrides: tuple[str, ...], busy: int, stretch: float, stretches: int, as_json: bool) -> None:
    """Compare the error of slip that a governed model publishes with the one it has."""
    report = governed(load_scene(scene_name, overrides), busy, stretch, stretches)
    if as_json:
        print_json(report)
        return
    rows = [[r["setting"], str(r["stretches"]), f"{100 * r['published']:.3f}", f"{100 * r['measured']:.3f}"] for r in report["settings"]]
    title = f"{report['scene']} beside {busy} busy processes: {report['real_time']:.3g} of real time"
    print_rows(title, ["setting", "stretches", "published [points]", "measured [points]"], rows, words={"setting"})


if __name__ == "__main__":
    main()
