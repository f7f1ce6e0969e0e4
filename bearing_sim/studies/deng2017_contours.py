# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Figures 3 and 10 of Deng 2017: raceways that pre-deformation machining makes, with one arc turned by 0 to 5 deg."""

import math
from collections.abc import Mapping

import numpy as np

from bearing_sim.studies.deng2017_claims import FAILS, HOLDS, IN_PART, Finding
from bearing_sim.studies.machining import Machined, Pressing, RingSection, machine
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table

TURNS = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)  # deg
_SECTION = RingSection(35.8e-3, 12e-3, 3.4e-3, 206e9)  # the command machine's defaults
_PRESSURE, _LOW_RADIUS = 2.0e6, 34.8625e-3


def machined_rings() -> dict[float, Machined]:
    """Return the released raceways by the turn of an arc [deg], all ground to the radius that gives the even one its low points."""
    ground = machine(_SECTION, Pressing(_PRESSURE), low_radius=_LOW_RADIUS).ground_radius
    return {turn: machine(_SECTION, Pressing(_PRESSURE, math.radians(turn)), ground_radius=ground) for turn in TURNS}


def machining_table(rings: Mapping[float, Machined]) -> Table:
    """Return low and high points, D value and roundness by the turn of an arc."""
    rows = [
        {
            "arc_turn": turn,
            "low_radius": 1e3 * float(ring.lows[:, 1].min()),
            "high_radius": 1e3 * float(ring.highs[:, 1].max()),
            "d_value": 1e6 * ring.d_value,
            "roundness": 1e6 * ring.roundness,
        }
        for turn, ring in rings.items()
    ]
    columns = (
        Column("arc_turn", "deg", "turn of one of the three pressed arcs"),
        Column("low_radius", "mm", "lowest low point"),
        Column("high_radius", "mm", "highest high point"),
        Column("d_value", "um", "mean of highs less mean of lows, D"),
        Column("roundness", "um", "highest less lowest of the low points"),
    )
    return Table(columns, rows, {"kind": "machining"})


def contour_finding(rings: Mapping[float, Machined]) -> Finding:
    """Return what becomes of the claim of figure 3."""
    rows = machining_table(rings).rows
    courses = {name: np.diff([row[name] for row in rows]) for name in ("high_radius", "low_radius", "d_value", "roundness")}
    courses["low_radius"] *= -1
    wrong = [name.replace("_", " ") for name, steps in courses.items() if not (steps > 0).all()]
    first, last = rows[0], rows[-1]
    gives = (
        f"from 0 to {last['arc_turn']:g} deg the highest high point rises by {1e3 * (last['high_radius'] - first['high_radius']):.1f} um, "
        f"the lowest low falls by {1e3 * (first['low_radius'] - last['low_radius']):.1f} um, "
        f"D {first['d_value']:.1f} to {last['d_value']:.1f} um, roundness {first['roundness']:.1f} to {last['roundness']:.1f} um"
    )
    verdict = HOLDS if not wrong else IN_PART if len(wrong) < len(courses) else FAILS
    return Finding(
        0,
        "3, 10",
        "Machining with one arc turned: highs rise, lows fall, D and roundness grow",
        "elastic ring",
        verdict,
        gives,
        f"not at every step: {', '.join(wrong)}" if wrong else "",
        "not explained" if wrong else "",
    )
