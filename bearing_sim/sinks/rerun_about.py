# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The description of a run that the view shows as text."""

import math

from bearing_sim.scene import Scene
from bearing_sim.sinks.rerun_lines import ZERO_CELSIUS

_WHIRL = """The cage's displacement and its {play} have a factor of their own, which the title says; cage orbit: the place of
its centre in the {play}{seen} and its path in the last turns, dots where samples are too far apart for a line.
"""
_GUIDES = {"outer_ring": "green: guide land on the outer ring. ", "inner_ring": "green: guide land on the inner ring. ", "roller": ""}


def _whirl(scene: Scene) -> str:
    if not scene.cage_whirls:
        return ""
    cage = scene.bearing.cage
    seen = ", seen from the inner ring's centre," if cage.guidance == "inner_ring" else ""
    return _WHIRL.format(play="guide clearance" if cage.has_lands else "play in the pockets that guide it", seen=seen)


_TILTS = """The solid picture draws tilts of ring and rollers and skews by factors of their own, which its title says, and the cage's tilt by
the cage's factor. Pressures are Hertz's of slices, largest
of all rollers; those of the end slices say how hard edges press, without the rise at a sharp edge.
"""


def about(scene: Scene, factor: int) -> str:
    """Return the description of a run as Markdown."""
    bearing, oil, limits = scene.bearing, scene.lubricant, scene.thresholds
    raceway, roller = bearing.outer_raceway, bearing.roller
    return f"""## {scene.name}

{scene.description}

**Bearing** {bearing.name}: {roller.count} rollers {1e3 * roller.diameter:g} x {1e3 * roller.length:g} mm,
outer raceway with {raceway.lobes} lobes, R_low {1e3 * raceway.low_radius:.4f} mm, D {1e6 * raceway.d_value:g} um,
low point at {math.degrees(raceway.installation_angle):g} deg,
play at the low points {1e6 * bearing.radial_clearance_at_low_points:.1f} um (negative: preload).

**Oil** {oil.oil.name}, {oil.temperature - ZERO_CELSIUS:g} °C at the start, {100 * oil.mixture_fraction:g} % in the air,
traction law {oil.traction.law}.

**Level** {scene.level}.

**Picture**: bodies to scale; every radial departure from the ideal bearing (lobes, play, elastic approach, ring displacement)
is drawn x{factor}. Seen against the x axis: Y right, Z up; azimuth runs from +Y towards +Z. Red line: outer raceway; dashed: ideal
round raceway; {_GUIDES[bearing.cage.guidance]}Rollers are coloured by inner contact load, grey ones carry none. Arrows at the raceways: contact
forces on the rings, full scale of the colours = longest; yellow: radial load on the inner ring, twice that scale as far as there is room.
The orange cage bar and the white marks show rotation. Purple arrows: forces of the pockets on the rollers, scale in the middle.
{_whirl(scene)}{_TILTS if scene.bodies_tilt else ""}
**Power** by cause: what the shaft puts in by the tractions on the inner ring, the mixture in the cage's bore and guide lands of its own is lost, or
stored for a moment in motion and elastic contacts; the bars are means of the newest samples.

**Thresholds**: slip {100 * limits.slip_warning:g} % warning, {100 * limits.slip_error:g} % error; life below {limits.life_warning:g} h warning.

**Loads** are those of the sampled instants: at constant speed samples may meet the rollers in the same places again and
again, and then the largest load changes with the speed while the bearing's does not.
"""
