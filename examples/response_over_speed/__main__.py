# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Response over speed with a support of shaft and outer ring, and without: ``python examples/response_over_speed``, from a checkout."""

import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "examples")]

from click import IntRange  # noqa: E402
from points import over_points, scene_or_paper, speed_option, varied_scene, vibrating_level  # noqa: E402

from bearing_sim.cli.options import option  # noqa: E402
from bearing_sim.cli.reporting import announce_compilation, progress_bar  # noqa: E402
from bearing_sim.cli.results import command  # noqa: E402


@command("response_over_speed")
@scene_or_paper
@speed_option("--from", "lowest", "Lowest", 10000.0)
@speed_option("--to", "highest", "Highest", 52000.0)
@option("--points", "Number of speeds.", IntRange(2, 1000), default=29)
@vibrating_level
@varied_scene
def response_over_speed(scene_name, overrides, lowest, highest, points, level):
    """Run SCENE over speeds with its support, with a rigid one, and at level slip.

    A scene whose support does not yield gets `support.elastic: true`.
    """
    import numpy as np

    announce_compilation()
    from response_over_speed.responses import plot_responses, relative_damage, respond

    speeds = [float(each) for each in np.linspace(lowest, highest, points) * (math.pi / 30)]
    with progress_bar("points", 3 * points) as show:
        found = respond(scene_name, overrides, speeds, level, progress=show)
    relative = relative_damage(found)
    title = f"response over speed, level {level}"
    return over_points(
        f"{scene_name}: {title}",
        ("model", "speed [rpm]", "slip [%]", "largest load [N]", "ring moves [µm]", "outer ring [µm]", "damage/slip's", "support [W]"),
        [_response_row(one, relative) for one in found],
        lambda draft: plot_responses(draft, f"{' '.join([scene_name, *overrides])}: {title}", found),
        {"scene": scene_name, "level": level},
    )


def _response_row(one, relative) -> dict:
    return {
        "model": one.model,
        "shaft_speed_rpm": one.shaft_speed * 30 / math.pi,
        "slip_percent": 100 * one.slip,
        "largest_inner_load_n": one.largest_load,
        "ring_motion_um": 1e6 * one.ring_swing,
        "outer_ring_motion_um": 1e6 * one.outer_swing,
        "damage_over_slip": relative[one.model, one.shaft_speed],
        "support_power_w": one.support_power,
    }


if __name__ == "__main__":
    response_over_speed()
