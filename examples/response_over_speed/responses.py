# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Response over speed: how a bearing vibrates on its support, beside the same bearing in a rigid housing and in quasi-static balance."""

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.display import RPM, heading, larger_unit
from bearing_sim.scene.loader import load_scene
from bearing_sim.sweep.pictures import legend_below, look_of, new_figure, plain_numbers, save
from bearing_sim.sweep.thermal import simulation_in_equilibrium

STILL, HELD, CARRIED = "slip", "rigid support", "support"
_SETTLING, _SHOWN, _PER_TURN = 60.0, 20.0, 60  # cage turns before and in the means, and samples in each


class Response(NamedTuple):
    """Results of one model at one speed, over some cage turns after settling."""

    model: str  # `STILL`, `HELD` or `CARRIED`
    shaft_speed: float  # [rad/s]
    slip: float  # mean
    largest_load: float  # between a roller and the inner raceway [N]
    ring_swing: float  # the largest extent of the inner ring's motion against the outer ring along y or z [m]
    outer_swing: float  # of the outer ring's in space [m]
    damage_rate: float  # mean of 1/(modified rating life) [1/h]
    support_power: float  # mean [W]


def respond(
    name: str,
    overrides: Sequence[str],
    shaft_speeds: Sequence[float],
    level: str = "planar",
    progress: Callable[[int], None] = lambda done: None,
) -> list[Response]:
    """Run a scene over speeds at level ``slip``, and at a level with vibration in a rigid housing and on its support.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene.loader.load_scene` takes them; a support that yields is `support.elastic` if it has none.
    shaft_speeds : [rad/s], not 0.
    level : ``planar`` or ``spatial``.
    progress : called with the number of finished points.

    Raises
    ------
    SceneError
        The scene is invalid.
    IntegrationError
        A run stopped early.
    """
    given = load_scene(name, [*overrides, f"level={level}"]).support
    carried = () if given.shaft_bends or given.outer_ring_moves else ("support.elastic=true",)
    shaft = f"shaft: {{mass: {given.shaft.mass!r} kg}}"
    unbalance = f"unbalance: {{amount: {given.unbalance.amount!r}, angle: {given.unbalance.angle!r}}}"
    models = {
        STILL: (f"support={{{shaft}}}", "level=slip"),
        HELD: (f"support={{{shaft}, {unbalance}}}", f"level={level}"),
        CARRIED: (*carried, f"level={level}"),
    }
    found = []
    for speed, (model, own) in itertools.product(shaft_speeds, models.items()):
        found.append(_run(load_scene(name, [*overrides, *own, f"operating.shaft_speed={speed!r} rad/s"]), model))
        progress(len(found))
    return found


def _run(scene, model):
    turn = 4.0 * np.pi / (abs(scene.operating.shaft_speed) * (1.0 - scene.bearing.diameter_ratio))
    run = simulation_in_equilibrium(scene)
    run.advance(_SETTLING * turn)
    block = run.advance(_SHOWN * turn, samples=round(_SHOWN * _PER_TURN))
    return Response(
        model,
        scene.operating.shaft_speed,
        float(block["cage_slip"].mean()),
        float(block["inner_load"].max()),
        *(float(max(np.ptp(block[f"{ring}_y"]), np.ptp(block[f"{ring}_z"]))) for ring in ("ring", "outer_ring")),
        float((1.0 / block["modified_rating_life"]).mean()),
        float(block["support_power"].mean()),
    )


def relative_damage(found: Sequence[Response]) -> dict[tuple[str, float], float]:
    """Return the damage rate of each model and speed over that of level ``slip`` at the speed."""
    still = {one.shaft_speed: one.damage_rate for one in found if one.model == STILL}
    return {(one.model, one.shaft_speed): one.damage_rate / still[one.shaft_speed] for one in found}


def plot_responses(path: Path, title: str, found: Sequence[Response]) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure, relative = new_figure(13, 8), relative_damage(found)
    axes = figure.subplots(2, 2).ravel()
    unit, factor = larger_unit("N", [one.largest_load for one in found])
    label = heading("inner_load_maximum", unit)
    panels = (
        (label, lambda one: one.largest_load / factor),
        ("damage rate over that of level slip", lambda one: relative[one.model, one.shaft_speed]),
        ("motion of the inner ring against the outer [µm]", lambda one: 1e6 * one.ring_swing),
        ("cage slip [%]", lambda one: 100 * one.slip),
    )
    for each, (label, value) in zip(axes, panels):
        for k, model in enumerate((STILL, HELD, CARRIED)):
            mine = [one for one in found if one.model == model]
            each.plot([RPM * one.shaft_speed for one in mine], [value(one) for one in mine], **look_of(k, ms=4, label=model))
        each.set(xlabel="shaft speed [rpm]", ylabel=label, ylim=(0, None))
        plain_numbers(each.xaxis, each.yaxis)
        each.grid(alpha=0.3)
    legend_below(figure, axes[0])
    save(figure, path, title)
