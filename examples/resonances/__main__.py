# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the passing rollers make the inner ring vibrate, over speed: ``python examples/resonances``, from a checkout."""

import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "examples")]

from click import IntRange  # noqa: E402
from points import over_points, scene_or_paper, speed_option, varied_scene, vibrating_level  # noqa: E402

from bearing_sim.cli.options import option  # noqa: E402
from bearing_sim.cli.reporting import UsageError, announce_compilation, progress_bar, scene_of  # noqa: E402
from bearing_sim.cli.results import command  # noqa: E402


@command("resonances")
@scene_or_paper
@speed_option("--from", "lowest", "Lowest", otherwise=" [default: 0.5 of the scene's]")
@speed_option("--to", "highest", "Highest", otherwise=" [default: 1.3 of the scene's]")
@option("--points", "Number of speeds.", IntRange(2, 1000), default=33)
@vibrating_level
@varied_scene
def main(scene_name, overrides, lowest, highest, points, level):
    """Show over speed where the passing rollers make the inner ring of SCENE vibrate on its contacts, and in which states it stays."""
    import numpy as np

    scene = scene_of(scene_name, overrides, level)
    announce_compilation(scene)
    from resonances.ring_on_rollers import plot_resonances, resonances

    own = abs(scene.operating.shaft_speed) * 30.0 / math.pi
    if own == 0.0 and None in (lowest, highest):
        raise UsageError("the scene's shaft stands still; give --from and --to")
    speeds = np.linspace(0.5 * own if lowest is None else lowest, 1.3 * own if highest is None else highest, points) * (math.pi / 30.0)
    with progress_bar("speeds", points) as show:
        found = resonances(scene, speeds, show)
    rows = [row for each in found for row in _resonance_rows(each)]
    title = f"{' '.join([scene_name, *overrides])}: the inner ring on its rollers, level {level}"
    return over_points(
        f"{scene_name}: the inner ring on its rollers over speed, level {level}",
        ("speed [rpm]", "over passage", "multiplier", "nearby", "slip [%]", "life [h]", "state"),
        rows,
        lambda draft: plot_resonances(draft, title, found),
        {"scene": scene_name, "level": level},
        [(speed, f"{low:.2f}, {high:.2f}", *others) for speed, low, high, *others in (row.values() for row in rows)],
        ("over passage", "state"),
    )


def _resonance_rows(speed) -> list[dict]:
    ring = speed.resonance
    low, high = (math.nan, math.nan) if ring is None else ring.ratios
    known = {
        "shaft_speed_rpm": speed.shaft_speed * 30.0 / math.pi,
        "lower_ratio": low,
        "higher_ratio": high,
        "multiplier": math.nan if ring is None else ring.multiplier,
        "multiplier_nearby": math.nan if ring is None else ring.multiplier_nearby,
    }
    states = [(100.0 * state.cage_slip, state.rating_life, state.start) for state in speed.states] or [(math.nan, math.nan, "the run stopped early")]
    return [known | {"slip_percent": slip, "rating_life_h": life, "state": start} for slip, life, start in states]


if __name__ == "__main__":
    main()
