# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The running clearance of a scene with its parts, for reports."""

from collections.abc import Mapping

import numpy as np

from bearing_sim.messages.topics import ARRAYS
from bearing_sim.scene.display import with_sign
from bearing_sim.scene.scene import Scene

PARTS = ARRAYS["running_clearance"].fields
"""The running clearance, then its parts (see `bearing_sim.model.sample`)."""


def clearance_report(scene: Scene, samples: np.ndarray) -> dict:
    """Return the running clearance and its parts [um], means over samples of shape (n,), and what the dimensions are."""
    return clearance_of(scene, {name: float(np.mean(samples[name])) for name in PARTS})


def clearance_of(scene: Scene, values: Mapping[str, float]) -> dict:
    """Return the report of given clearances [m] by the names of `PARTS`."""
    return {"dimensions_at": scene.bearing.dimensions_at, **{f"{name}_um": 1e6 * values[name] for name in PARTS}}


def clearance_text(scene: Scene, report: Mapping) -> str:
    """Return the running clearance with its parts in words, from `clearance_report`."""
    shown = {name.removesuffix("_clearance"): report[f"{name}_um"] for name in PARTS}
    running, text = shown.pop("running"), ""
    if not shown["contour"]:
        del shown["contour"]
    if scene.bearing.dimensions_at == "running":
        del shown["fit"], shown["rotation"], shown["heat"]
        text = "; the dimensions are those of the running bearing: fits, rotation and heat change nothing"
    parts = ", ".join(f"{name} {_signed(value)}" for name, value in shown.items())
    side = "preload" if running < 0.0 else "play"
    return f"{_signed(running)} µm ({side}): {parts}{text or _unsaid(scene)}"


def _signed(micrometres: float) -> str:
    return with_sign(round(micrometres, 2))


def _unsaid(scene: Scene) -> str:
    """Return what a cold bearing's scene leaves open."""
    missing = [name for name in ("shaft", "housing") if (seat := getattr(scene.mounting, name)).fit is None and seat.interference is None]
    unsaid = f"; no fit of the {' and the '.join(missing)} is given" if missing else ""
    return unsaid + ("; all temperatures are taken as the oil's" if scene.heat.law == "none" else "")
