# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is plotted over time: entity paths, names, colours, and the numbers of a block in the units that people read."""

import math

import numpy as np

from bearing_sim.scene import Scene
from bearing_sim.sinks import colours
from bearing_sim.sinks.rerun_power import CAUSES

RPM = 30 / math.pi
ZERO_CELSIUS = 273.15
ENDLESS = 1e7  # [h]; a bearing that hardly turns has a life of 1e30 h, which would flatten everything else

LINES = {
    "/speed/shaft": ("shaft", colours.BLUE, 2.0),
    "/speed/cage": ("cage", colours.ORANGE, 2.5),
    "/speed/ideal_cage": ("cage without slip", colours.GREY, 1.5),
    "/slip/cage": ("cage slip", colours.BLUE, 2.5),
    "/slip/warning": ("warning", colours.YELLOW, 1.0),
    "/slip/error": ("error", colours.VERMILION, 1.0),
    "/life/log10_hours": ("life", colours.GREEN, 2.5),
    "/life/lamina_log10_hours": ("lamina life", colours.WHITE, 2.0),
    "/life/chosen_log10_hours": ("life by the scene's choice", colours.PURPLE, 2.0),
    "/slip/measured": ("measured cage slip", colours.WHITE, 1.5),
    "/slip/residual": ("measured less predicted slip", colours.ORANGE, 2.0),
    "/slip/no_residual": ("as predicted", colours.GREY, 1.0),
    "/speed/cage_measured": ("cage, measured", colours.WHITE, 1.5),
    "/life/warning": ("warning", colours.YELLOW, 1.0),
    "/life/error": ("error", colours.VERMILION, 1.0),
    "/damage/ppm": ("damage", colours.PURPLE, 2.5),
    "/load/radial": ("radial load", colours.YELLOW, 2.0),
    "/oil/temperature": ("oil", colours.VERMILION, 2.0),
    "/loads/inner_largest": ("inner, largest", colours.BLUE, 2.0),
    "/loads/outer_largest": ("outer, largest", colours.VERMILION, 2.0),
    "/cage/eccentricity": ("cage eccentricity e/c", colours.ORANGE, 2.0),
    "/loads/pocket_largest": ("on a roller by its pocket, largest", colours.PURPLE, 2.0),
    "/loads/pocket_warning": ("warning", colours.YELLOW, 1.0),
    "/loads/pocket_error": ("error", colours.VERMILION, 1.0),
    "/pressure/inner": ("inner, largest", colours.BLUE, 2.0),
    "/pressure/outer": ("outer, largest", colours.VERMILION, 2.0),
    "/pressure/inner_edge": ("inner, end slices", colours.WHITE, 1.0),
    "/pressure/outer_edge": ("outer, end slices", colours.YELLOW, 1.0),
    "/tilt/ring_y": ("ring towards y", colours.BLUE, 2.0),
    "/tilt/ring_z": ("ring towards z", colours.ORANGE, 2.0),
    "/tilt/cage_y": ("cage towards y", colours.ORANGE, 2.0),
    "/tilt/cage_z": ("cage towards z", colours.YELLOW, 2.0),
    "/sink/dropped": ("blocks dropped", colours.WHITE, 1.5),
} | {f"/power/{cause}": (name, colour, 2.0) for cause, (name, colour) in CAUSES.items()}

EACH = {
    "/loads/each/inner": "inner",
    "/loads/each/outer": "outer",
    "/loads/each/pocket": "pocket",
    "/rollers/inner_sliding": "inner sliding",
    "/rollers/outer_sliding": "outer sliding",
    "/rollers/spin": "spin",
    "/tilt/each/tilt": "tilt",
    "/tilt/each/skew": "skew",
}
"""Entity paths with a line for each roller, and what a line's name begins with."""

MEASURED = ("/speed/cage_measured", "/slip/measured", "/slip/residual")
"""Entity paths of what there is only where the cage is measured."""

AGGREGATION = {
    "/loads/pocket_largest": "Max",
    "/loads/inner_largest": "Max",
    "/loads/outer_largest": "Max",
    "/slip/cage": "Max",
}  # where many samples share a pixel


def plottable(values) -> np.ndarray:
    """Return float32 values with NaN, a gap in a plot, wherever there is no finite number."""
    values = np.asarray(values, np.float64)
    return np.where(np.isfinite(values), values, np.nan).astype(np.float32)


def log10_hours(life) -> np.ndarray:
    """Return log10 of a life in hours, NaN where it is endless (more than `ENDLESS`), zero or unknown."""
    life = np.asarray(life, np.float64)
    return np.log10(life, where=(life > 0) & (life <= ENDLESS), out=np.full(life.shape, np.nan))


def range_path(path: str) -> str:
    """Return the entity path of lowest and highest values beside the means of a series in a long run."""
    return f"{path}/range"


def dim(colour: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return the colour of the range around a line."""
    return (*(int(0.6 * part) for part in colour[:3]), 255)


def series(block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted of a block, in the units that people read, by entity path."""
    return {
        "/speed/shaft": RPM * block["shaft_speed"],
        "/speed/cage": RPM * block["cage_speed"],
        "/speed/ideal_cage": RPM * block["ideal_cage_speed"],
        "/slip/cage": 100 * block["cage_slip"],
        "/life/log10_hours": log10_hours(block["rating_life"]),
        "/life/hours": block["rating_life"],
        "/damage/ppm": 1e6 * block["damage"],
        "/load/radial": np.hypot(block["load_y"], block["load_z"]),
        "/oil/temperature": block["oil_temperature"] - ZERO_CELSIUS,
        "/loads/inner_largest": block["inner_load"].max(axis=1),
        "/loads/outer_largest": block["outer_load"].max(axis=1),
        "/loads/pocket_largest": np.abs(block["pocket_force"]).max(axis=1),
        "/loads/each/inner": block["inner_load"],
        "/loads/each/outer": block["outer_load"],
        "/loads/each/pocket": block["pocket_force"],
        "/cage/eccentricity": block["land_eccentricity"],
    } | {f"/power/{cause}": block[f"{cause}_power"] for cause in CAUSES}


def roller_series(scene: Scene, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return sliding speeds [m/s] and spins [rpm] of all rollers of a block, by entity path, each of shape (n, Z).

    A raceway's surface less the roller's: omega_i R_i - omega_m r_m - omega_b r on the inner ring, and omega_b r - omega_m r_m on the
    outer one, with the spin omega_b positive where the roller rolls on the outer ring (Deng 2017, section 2.3, about a resting frame).
    """
    bearing = scene.bearing
    surface = block["roller_spin"] * bearing.roller.diameter / 2
    orbital = block["orbital_speed"] * block["roller_radius"]
    return {
        "/rollers/inner_sliding": block["shaft_speed"][:, None] * bearing.inner_raceway.radius - orbital - surface,
        "/rollers/outer_sliding": surface - orbital,
        "/rollers/spin": RPM * block["roller_spin"],
    }


def threshold_lines(scene: Scene) -> dict[str, float]:
    """Return where the scene's thresholds stand in the plots, by entity path; only those there are."""
    limits = scene.thresholds
    lines = {"/slip/warning": 100 * limits.slip_warning, "/slip/error": 100 * limits.slip_error}
    for path, life in (("/life/warning", limits.life_warning), ("/life/error", limits.life_error)):
        if life > 0.0:
            lines[path] = float(log10_hours(life))
    for path, force in (("/loads/pocket_warning", limits.pocket_force_warning), ("/loads/pocket_error", limits.pocket_force_error)):
        if force is not None:
            lines[path] = force
    return lines


def measured_series(times: np.ndarray, cage_speed: np.ndarray, residual: np.ndarray, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted of a measured cage, by entity path.

    Parameters
    ----------
    times, cage_speed, residual : of the measurements [s, rad/s, fraction], shape (n,).
    block : samples around these times; they know how fast a cage without slip would be.
    """
    ideal = np.interp(times, block["time"], block["ideal_cage_speed"])
    slip = np.divide(cage_speed, ideal, out=np.full(len(times), np.nan), where=ideal != 0.0)
    return {"/speed/cage_measured": RPM * cage_speed, "/slip/measured": 100 * (1 - slip), "/slip/residual": 100 * residual}


def further_series(scene: Scene, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted besides `series` because only some scenes have it: lives, tilts, pressures by slices."""
    lines = {}
    if not scene.life.is_basic:
        lines["/life/chosen_log10_hours"] = log10_hours(block["modified_rating_life"])
    if scene.bodies_tilt:
        lines["/life/lamina_log10_hours"] = log10_hours(block["lamina_life"])
        lines |= {f"/tilt/{body}_{axis}": 1e3 * block[f"{body}_tilt_{axis}"] for body in ("ring", "cage") for axis in "yz"}
        lines |= {f"/tilt/each/{name}": 1e3 * block[f"roller_{name}"] for name in ("tilt", "skew")}
        lines |= {f"/pressure/{place}": 1e-6 * block[f"{place}_pressure"] for place in ("inner", "outer", "inner_edge", "outer_edge")}
    return lines
