# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is known of a bearing: dimensions, clearance, ratings, and which of them are estimated."""

import math

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.display import force
from bearing_sim.scene.mounting import clearance_limits, clearance_source
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.uncertainty import value_at

GUIDES = {
    "outer_ring": "guided by the outer ring",
    "inner_ring": "guided by the inner ring",
    "roller": "guided by the rollers",
    "full_complement": "none: a full complement of rollers",
}
"""What guides a cage, in words."""


def facts(bearing: Bearing) -> dict:
    """Return what is known of a bearing, for JSON; lengths in mm, forces in N, speeds in rpm."""
    rated, ratings = rate(bearing), bearing.ratings
    limits = _clearance_limits(bearing)
    return {
        "designation": bearing.designation,
        "source": bearing.source,
        "bore_diameter_mm": 1e3 * bearing.bore_diameter,
        "outside_diameter_mm": 1e3 * bearing.outside_diameter,
        "width_mm": 1e3 * bearing.boundary_width,
        "inner_raceway_diameter_mm": 2e3 * bearing.inner_raceway.radius,
        "outer_raceway_diameter_mm": 2e3 * bearing.outer_raceway.low_radius,
        "rollers": bearing.roller.count,
        "roller_diameter_mm": 1e3 * bearing.roller.diameter,
        "roller_effective_length_mm": 1e3 * bearing.roller.length,
        "clearance_group": bearing.clearance if isinstance(bearing.clearance, str) else None,
        "clearance_um": limits and [1e6 * limits.least, 1e6 * limits.largest],
        "cage_guidance": bearing.cage.guidance,
        "cage_mass_g": 1e3 * bearing.cage.mass,
        "dynamic_rating": rated.dynamic,
        "static_rating": rated.static,
        "fatigue_limit": rated.fatigue_limit,
        "computed_dynamic_rating": rated.computed.dynamic,
        "computed_static_rating": rated.computed.static,
        "makers_dynamic_rating": ratings.dynamic,
        "reference_speed_rpm": _rpm(ratings.reference_speed),
        "limiting_speed_rpm": _rpm(ratings.limiting_speed),
        "estimated": [{"field": each.field, "value": value_at(bearing, each.field), "by": each.by} for each in bearing.estimated],
    }


def rows(bearing: Bearing) -> list[tuple[str, str]]:
    """Return the facts as rows of a table."""
    known = facts(bearing)

    def mm(name):
        return f"{known[name]:.5g} mm"

    estimated = {each.field for each in bearing.estimated}

    def marked(text, *fields):
        return f"{text} (estimated)" if estimated & set(fields) else text

    clearance = known["clearance_um"]
    rating = "maker's" if known["makers_dynamic_rating"] is not None else "by ISO 281 and ISO 76 from the dimensions"
    speeds = [f"{word} {known[f'{word}_speed_rpm']:.0f} rpm" for word in ("reference", "limiting") if known[f"{word}_speed_rpm"] is not None]
    raceways = f"F {mm('inner_raceway_diameter_mm')}, E {mm('outer_raceway_diameter_mm')}"
    cage_mass = marked(f"{known['cage_mass_g']:.4g} g", "cage.mass")
    symbols = {"C": "dynamic_rating", "C_0": "static_rating", "C_u": "fatigue_limit"}
    ratings = ", ".join(f"{symbol} {force(known[name])}" for symbol, name in symbols.items())
    found = [
        ("boundary dimensions", f"d {mm('bore_diameter_mm')}, D {mm('outside_diameter_mm')}, B {mm('width_mm')}"),
        ("raceways", marked(raceways, "inner_raceway.radius", "outer_raceway.low_radius")),
        (
            "rollers",
            f"{marked(str(known['rollers']), 'roller.count')} of {marked(mm('roller_diameter_mm'), 'roller.diameter')}, effective length "
            f"{marked(mm('roller_effective_length_mm'), 'roller.length')}",
        ),
        ("cage", GUIDES[known["cage_guidance"]] + ("" if bearing.cage.is_absent else f", {cage_mass}")),
        ("load ratings", f"{ratings}; {rating}; C by ISO 281 {force(known['computed_dynamic_rating'])}"),
        ("source", bearing.source.strip()),
    ]
    if clearance is not None:
        found.insert(
            3,
            (
                "clearance",
                f"{known['clearance_group']}: {clearance[0]:.0f} to {clearance[1]:.0f} µm, diametral ({clearance_source(known['clearance_group'])})",
            ),
        )
    if speeds:
        found.insert(-1, ("speeds", ", ".join(speeds)))
    found += [(f"estimated {each['field']}", each["by"]) for each in known["estimated"]]
    return found


def _clearance_limits(bearing: Bearing):
    return clearance_limits(bearing.clearance, bearing.bore_diameter) if isinstance(bearing.clearance, str) else None


def _rpm(speed: float | None) -> float | None:
    return None if speed is None else speed * 30 / math.pi
