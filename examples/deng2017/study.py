# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Reproduction of Deng 2017: the sweeps behind each figure, with the parameters of the bundled scenes.

Nothing is tuned for any figure.  Each sweep runs at level ``slip`` and at level ``planar``.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError
from bearing_sim.sweep.grid import Plan, plan_sweep, read_axis
from bearing_sim.sweep.point import DURATION, run_until_settled
from bearing_sim.sweep.tasks import Task, task
from bearing_sim.sweep.thermal import simulation_in_equilibrium

LEVELS = ("slip", "planar")
LOW, D_VALUE, SPEED, LOAD = "bearing.outer_raceway.low_radius", "bearing.outer_raceway.d_value", "operating.shaft_speed", "operating.radial_load"
ANGLE, ROUNDNESS = "bearing.outer_raceway.installation_angle", "bearing.outer_raceway.roundness"
MIXTURE, MASS = "lubricant.mixture_fraction", "support.shaft.mass"
LOW_RADII = (34.8600, 34.8625, 34.8650, 34.8675)  # mm, of the figures with four curves
_FOUR = "34.86mm,34.8625mm,34.865mm,34.8675mm"
_LOADS = "100,200,400,600,800,1000,1250,1500,1750,2000,2500,3000"
QUICK_DURATION = 0.2  # s
LONGEST = 30.0  # s of the longest run: points that settle do within 13 s, and one at planar never does
_BINS = 72  # of azimuth, for load distributions
_ORBIT_TURNS, _PER_TURN = 12, 120  # of the cage in a trajectory


_TABLE1 = "deng2017_table1"


class Study(NamedTuple):
    """One sweep of the paper.

    Attributes
    ----------
    name : of its files.
    figures : of the paper; empty for a sweep behind a reason in the claims table.
    title : what is varied.
    axes : as `bearing_sim.sweep.grid.read_axis` reads them.
    quick_axes : the same with few points.
    overrides : of the scene.
    scene : name of the bundled scene.
    """

    name: str
    figures: str
    title: str
    axes: tuple[str, ...]
    quick_axes: tuple[str, ...]
    overrides: tuple[str, ...] = ()
    scene: str = _TABLE1


_SPEEDS = f"{SPEED}=15000rpm,18000rpm,21000rpm,24000rpm,27000rpm,30000rpm,34000rpm,38000rpm,42000rpm,45000rpm,48500rpm,52000rpm"
_FEW_SPEEDS = f"{SPEED}=15000rpm,38000rpm,52000rpm"
STUDIES = (
    Study("low_radius", "11, 12", "low-point radius", (f"{LOW}=34.86mm:34.8675mm:16",), (f"{LOW}=34.86mm:34.8675mm:4",)),
    Study("d_value", "13, 14", "D value", (f"{D_VALUE}=0.08mm:0.12mm:17",), (f"{D_VALUE}=0.08mm:0.12mm:3",)),
    Study("speed", "15, 16", "shaft speed", (f"{LOW}={_FOUR}", _SPEEDS), (f"{LOW}={_FOUR}", _FEW_SPEEDS)),
    Study("load", "17, 18", "radial load", (f"{LOW}={_FOUR}", f"{LOAD}={_LOADS}"), (f"{LOW}={_FOUR}", f"{LOAD}=100,800,3000")),
    Study("angle", "19, 20", "installation angle", (f"{ANGLE}=0deg:60deg:13",), (f"{ANGLE}=0deg:60deg:3",)),
    Study(
        "map",
        "21",
        "D value and low-point radius",
        (f"{LOW}=34.86mm:34.8675mm:7", f"{D_VALUE}=0.08mm,0.085mm,0.09mm,0.095mm,0.098mm,0.1mm,0.105mm,0.11mm,0.115mm,0.12mm"),
        (f"{LOW}=34.86mm:34.865mm:3", f"{D_VALUE}=0.085mm,0.098mm,0.12mm"),
    ),
    Study("roundness", "22", "roundness of the low points", (f"{ROUNDNESS}=0um:10um:6",), (f"{ROUNDNESS}=0um:10um:3",), (f"{D_VALUE}=0.095mm",)),
    Study("table2", "23", "shaft speed, bearing of Table 2", (_SPEEDS,), (_FEW_SPEEDS,), scene="deng2017_table2"),
    Study(
        "mixture",
        "",
        "oil in the oil-air mixture, at R_low = 34.8650 mm and D = 0.105 mm",
        (f"{MIXTURE}=1.5%:5%:8",),
        (f"{MIXTURE}=1.5%:5%:3",),
        (f"{LOW}=34.865mm", f"{D_VALUE}=0.105mm"),
    ),
    Study(
        "neighbours",
        "",
        "shaft speed next to 45,000 rpm, at R_low = 34.8675 mm",
        (f"{SPEED}=44980rpm:45020rpm:9",),
        (f"{SPEED}=44990rpm:45010rpm:2",),
        (f"{LOW}=34.8675mm",),
    ),
    Study(
        "supported_mass",
        "",
        "mass of the shaft that moves with the inner ring, at R_low = 34.8675 mm",
        (f"{MASS}=0.1kg,0.25kg,0.5kg,1kg,2kg,4kg",),
        (f"{MASS}=0.5kg,2kg",),
        (f"{LOW}=34.8675mm",),
    ),
)

# Load distributions: name of their sweep, field, values.
PROFILES = (
    ("low_radius", LOW, ("34.86mm", "34.8625mm", "34.865mm", "34.8675mm")),
    ("d_value", D_VALUE, ("0.08mm", "0.095mm", "0.105mm", "0.12mm")),
    ("speed", SPEED, ("15000rpm", "30000rpm", "45000rpm", "52000rpm")),
    ("load", LOAD, ("100", "800", "1500", "3000")),
    ("angle", ANGLE, ("0deg", "30deg", "60deg")),
)


class Planned(NamedTuple):
    """All computations of the study.

    Attributes
    ----------
    sweeps : plans by the name of the sweep and the level.
    profiles : tasks of load distributions by sweep, value and level.
    trajectories : tasks by low-point radius [mm].
    duration : of a run without extension [s].
    """

    sweeps: dict[tuple[str, str], Plan]
    profiles: dict[tuple[str, str, str], Task]
    trajectories: dict[float, Task]
    duration: float

    @property
    def tasks(self) -> list[Task]:
        """All tasks, in the order of the attributes."""
        return [each for plan in self.sweeps.values() for each in plan.tasks] + [*self.profiles.values(), *self.trajectories.values()]


def plan_study(quick: bool = False, overrides: Sequence[str] = ()) -> Planned:
    """Return the plan of the study.

    Parameters
    ----------
    quick : few points and short runs, for testing.
    overrides : of every scene besides what a sweep sets, such as a support.
    """
    duration = QUICK_DURATION if quick else DURATION
    # Level planar rests late or never: a quick study does not wait for it.
    longest = {level: duration if quick and level == "planar" else LONGEST for level in LEVELS}
    sweeps = {
        (each.name, level): plan_sweep(
            each.scene,
            [*overrides, *each.overrides, f"level={level}"],
            [read_axis(text) for text in (each.quick_axes if quick else each.axes)],
            duration,
            longest[level],
        )
        for level in LEVELS
        for each in STUDIES
    }
    profiles = {
        (name, value, level): task(
            level, load_profile, load_scene(_TABLE1, [*overrides, f"{field}={value}", f"level={level}"]), duration, longest[level]
        )
        for level in LEVELS
        for name, field, values in PROFILES
        for value in (values if not quick else (values[0], values[-1]))
    }
    radii = LOW_RADII if not quick else (LOW_RADII[0], LOW_RADII[-1])
    trajectories = {low: task("planar", trajectory, load_scene(_TABLE1, [*overrides, f"{LOW}={low}mm", "level=planar"]), duration) for low in radii}
    return Planned(sweeps, profiles, trajectories, duration)


def load_profile(scene: Scene, duration: float, longest: float) -> dict:
    """Return the mean roller loads of a settled bearing over the azimuth: lists ``azimuth`` [deg], ``inner_load`` and ``outer_load`` [N].

    Parameters
    ----------
    scene, duration, longest : see `bearing_sim.sweep.point.run_until_settled`.
    """
    try:
        window = run_until_settled(scene, duration, longest).window
    except IntegrationError as error:
        return {"status": "failed", "reason": str(error)}
    bins = np.floor(np.mod(window["roller_angle"], 2 * np.pi) / (2 * np.pi) * _BINS).astype(int).ravel() % _BINS
    counts = np.bincount(bins, minlength=_BINS)
    with np.errstate(invalid="ignore"):
        loads = {name: (np.bincount(bins, window[name].ravel(), _BINS) / counts).tolist() for name in ("inner_load", "outer_load")}
    return {"status": "ok", "reason": "", "azimuth": ((np.arange(_BINS) + 0.5) * 360.0 / _BINS).tolist(), **loads}


def trajectory(scene: Scene, duration: float) -> dict:
    """Return the motion of a settled bearing over some cage turns.

    Lists ``time`` [s], cage centre ``cage_y``, ``cage_z`` [um], and of roller 0 the azimuth ``roller_angle`` [deg] and ``spin_ratio``, its
    spin relative to that in a bearing without slip.

    Parameters
    ----------
    scene : of a level whose cage whirls.
    duration : simulated before [s].
    """
    bearing = scene.bearing
    ideal = 0.5 * scene.operating.shaft_speed * (1.0 - bearing.diameter_ratio)
    try:
        run = simulation_in_equilibrium(scene)
        run.advance(duration)
        window = run.advance(_ORBIT_TURNS * 2 * np.pi / ideal, samples=_ORBIT_TURNS * _PER_TURN)
    except IntegrationError as error:
        return {"status": "failed", "reason": str(error)}
    rolling = ideal * bearing.pitch_radius / (bearing.roller.diameter / 2)
    return {
        "status": "ok",
        "reason": "",
        "time": (window["time"] - window["time"][0]).tolist(),
        "cage_y": (1e6 * window["cage_y"]).tolist(),
        "cage_z": (1e6 * window["cage_z"]).tolist(),
        "roller_angle": np.degrees(np.mod(window["roller_angle"][:, 0], 2 * np.pi)).tolist(),
        "spin_ratio": (window["roller_spin"][:, 0] / rolling).tolist(),
    }
