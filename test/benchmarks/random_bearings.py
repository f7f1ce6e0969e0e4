# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether bearings of any size and speed settle, and whether those that are said to have settled stay where they are.

``python test/benchmarks/random_bearings.py --level slip --level planar`` draws 60 bearings, runs each until it has settled by the criterion of
`bearing_sim.sweep.settling`, goes on until the run is three times as long, and compares the mean slips over the last fifth of both.
``--json`` prints one JSON object, ``--only 17`` runs one bearing of the draw, ``--show 17`` prints its scene.

A bearing has 3 to 60 rollers, a bore of 15 to 400 mm, a speed of 1 to 20,000 rpm up to n d_m = 3e6 mm/min and a load of 0.001 to 0.5 C.
The remaining dimensions follow in proportion (*assumption*): rollers fill 60 to 90 % of the pitch circle as far as rings have room for them,
the clearance is that of catalogues, every fourth outer raceway has two or three lobes, cages of steel, brass or polyamide run on a ring or on
the rollers.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bearing_sim.cli.reporting import print_rows
from bearing_sim.scene.loader import scene_from_mapping, scene_to_yaml
from bearing_sim.scene.ratings import load_rating, rate
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.sweep.point import DURATION
from bearing_sim.sweep.settling import WINDOW, advance_until_settled, longest_run, sampled, shortest_run

BEARINGS, SEED = 60, 1
LONGER = 3.0  # times the settled run
AGREED = 1e-3  # of slip; 0.1 points
_LARGEST_SPEED_FACTOR = 3.0  # n d_m [m/min * 1000 = mm/min * 1e6]
_MOST_WALL = 600.0  # s that a run of the check may take


def log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    """Return a number between two bounds whose logarithm is evenly distributed."""
    return float(np.exp(random.uniform(math.log(low), math.log(high))))


def random_scene(random: np.random.Generator, number: int) -> Scene:
    """Return a bearing with an oil and its operating conditions at level ``slip``; lengths are in mm until they are written."""
    count, bore = int(round(log_uniform(random, 3, 60))), log_uniform(random, 15.0, 400.0)
    ratio = min(math.sin(math.pi / count) * random.uniform(0.6, 0.9), 0.3)  # gamma
    pitch = bore / (1.0 - 1.7 * ratio)  # the ring below a roller is 0.35 of it thick
    diameter = ratio * pitch
    length, inner = diameter * random.uniform(0.8, 1.6), 0.5 * (pitch - diameter)
    raceway = _outer_raceway(random, inner, diameter)
    speed = min(log_uniform(random, 1.0, 20_000.0), 1e6 * _LARGEST_SPEED_FACTOR / pitch)
    load = log_uniform(random, 1e-3, 0.5) * load_rating(count, 1e-3 * diameter, 1e-3 * length, ratio)
    return scene_from_mapping(
        {
            "name": f"random_{number}",
            "level": "slip",
            "bearing": {
                "name": f"random {number}",
                "source": "test/benchmarks/random_bearings.py",
                "outer_raceway": raceway,
                "inner_raceway": {
                    "radius": f"{inner:.9g} mm",
                    "bore_radius": f"{0.5 * bore:.9g} mm",
                    "ring_mass": f"{_ring_mass(bore, inner, length):.6g} kg",
                },
                "roller": {"count": count, "diameter": f"{diameter:.9g} mm", "length": f"{length:.9g} mm"},
                "cage": _cage(random, pitch, diameter, length),
            },
            "lubricant": _lubricant(random),
            "operating": {"shaft_speed": f"{speed:.9g} rpm", "radial_load": f"{load:.9g} N", "load_angle": f"{random.uniform(0.0, 120.0):.6g} deg"},
        }
    )


def _ring_mass(bore: float, inner: float, length: float) -> float:
    return 7850e-9 * math.pi * (inner**2 - 0.25 * bore**2) * 1.5 * length


def _outer_raceway(random: np.random.Generator, inner: float, diameter: float) -> Mapping:
    if random.uniform() < 0.25:
        clearance, d_value, lobes = inner * random.uniform(-4e-4, 2e-4), inner * random.uniform(1e-3, 3.5e-3), int(random.integers(2, 4))
        return {"low_radius": f"{inner + diameter + clearance:.9g} mm", "d_value": f"{d_value:.6g} mm", "lobes": lobes}
    clearance = inner * random.uniform(3e-4, 1.2e-3)
    return {"low_radius": f"{inner + diameter + clearance:.9g} mm", "d_value": "0 mm", "lobes": 3}


def _cage(random: np.random.Generator, pitch: float, diameter: float, length: float) -> Mapping:
    guidance, density = str(random.choice(["outer_ring", "inner_ring", "roller"])), float(random.choice([7850.0, 8400.0, 1150.0]))
    inside, outside = 0.5 * pitch - 0.28 * diameter, 0.5 * pitch + 0.28 * diameter
    width, pocket = 1.5 * length, diameter * random.uniform(0.005, 0.02)
    mass = density * 1e-9 * math.pi * (outside**2 - inside**2) * width * 0.4
    cage = {"guidance": guidance, "mass": f"{mass:.6g} kg", "width": f"{width:.6g} mm", "pocket_clearance": f"{pocket:.6g} mm"}
    lands = {"guide_clearance": f"{0.5 * pitch * random.uniform(2e-3, 6e-3):.6g} mm", "guide_land_width": f"{0.2 * length:.6g} mm"}
    surfaces = {"inner_radius": f"{inside:.9g} mm", "outer_radius": f"{outside:.9g} mm"}
    return cage | surfaces | (lands if guidance != "roller" else {})


def _lubricant(random: np.random.Generator) -> Mapping:
    mixture = log_uniform(random, 0.01, 0.2)
    if random.uniform() < 0.4:
        oil = str(random.choice(["mil_l_7808", "mil_l_23699"]))
        return {"oil": oil, "temperature": f"{random.uniform(60.0, 140.0):.6g} degC", "mixture_fraction": mixture}
    at_40 = float(random.choice([32.0, 68.0, 150.0, 320.0]))
    oil = {
        "law": "custom",
        "viscosity_40": f"{at_40} mm^2/s",
        "viscosity_100": f"{0.55 * at_40**0.655:.6g} mm^2/s",  # about a viscosity index of 95
        "density": 880.0,
        "pressure_viscosity": "20 1/GPa",
    }
    return {"oil": oil, "temperature": f"{random.uniform(40.0, 90.0):.6g} degC", "mixture_fraction": mixture}


def examine(scene: Scene) -> dict:
    """Return how a scene settles, and where it is when the run has gone on to three times the length; slips in %."""
    began, simulation = time.perf_counter(), Simulation(scene)
    shortest, undefined = shortest_run(scene, DURATION), 0
    row = {
        "rollers": scene.bearing.roller.count,
        "bore_mm": 2e3 * scene.bearing.inner_raceway.bore_radius,
        "speed_rpm": scene.operating.shaft_speed * 30.0 / math.pi,
        "load_by_c": scene.operating.radial_load / rate(scene.bearing).dynamic,
        "lobes": scene.bearing.outer_raceway.lobes if scene.bearing.outer_raceway.d_value else 0,
    }

    def advance(seconds):
        nonlocal undefined
        block = sampled(simulation, seconds, shortest / 1000)
        undefined += int(np.isnan(block["cage_slip"]).sum())
        return block

    try:
        outcome = advance_until_settled(simulation, shortest, longest_run(scene), advance)
        row |= {"settled": outcome.settled, "reason": outcome.reason, "simulated": outcome.simulated, "settling_time": outcome.settling_time}
        row |= {"slip": 100.0 * outcome.slip, "later_slip": math.nan}
        per_second = (time.perf_counter() - began) / outcome.simulated
        if (LONGER - 1.0) * outcome.simulated * per_second < _MOST_WALL:
            advance((LONGER - LONGER * WINDOW - 1.0) * outcome.simulated)
            before = simulation.sample.copy()
            advance(LONGER * WINDOW * outcome.simulated)
            row["later_slip"] = 100.0 * _slip_between(before, simulation.sample)
    except IntegrationError as error:
        row = {"settled": False, "reason": str(error), "simulated": simulation.time, "settling_time": math.nan, "slip": math.nan} | row
        row["later_slip"] = math.nan
    return row | {"undefined_samples": undefined, "wall_seconds": time.perf_counter() - began}


def _slip_between(before: np.void, after: np.void) -> float:
    turned, ideal = (float(after[name] - before[name]) for name in ("cage_angle", "ideal_cage_angle"))
    return 1.0 - turned / ideal


def scenes(bearings: int, seed: int) -> list[Scene]:
    """Return the bearings of a draw."""
    random = np.random.default_rng(seed)
    return [random_scene(random, number) for number in range(bearings)]


def agrees(row: Mapping) -> bool:
    """Return whether a bearing settled and was still there when the run was three times as long."""
    return row["settled"] and abs(row["later_slip"] - row["slip"]) <= 100.0 * AGREED


def print_report(level: str, rows: Sequence[Mapping]) -> None:
    """Print one row for each bearing, and the sum."""
    shown = [
        [
            str(row["number"]),
            str(row["rollers"]),
            f"{row['bore_mm']:.0f}",
            f"{row['speed_rpm']:.4g}",
            f"{row['load_by_c']:.2g}",
            str(row["lobes"]),
            f"{row['slip']:.3f}",
            f"{row['later_slip'] - row['slip']:+.3f}",
            f"{row['settling_time']:.3g}",
            f"{row['simulated']:.4g}",
            f"{row['wall_seconds']:.3g}",
            "yes" if agrees(row) else row["reason"] or "moved on",
        ]
        for row in rows
    ]
    names = ("no.", "rollers", "bore, mm", "rpm", "F/C", "lobes", "slip, %", "later, points", "since, s", "simulated, s", "wall, s", "settled")
    print_rows(f"level {level}", names, shown, words=("settled",), width=200)
    settled, undefined = sum(map(agrees, rows)), sum(row["undefined_samples"] for row in rows)
    compared = [abs(row["later_slip"] - row["slip"]) for row in rows if row["settled"]]
    farthest = max(compared, default=math.nan)
    print(f"level {level}: {settled} of {len(rows)} settled and stay within {100 * AGREED:g} points, the farthest {farthest:.3f}")
    print(f"level {level}: {undefined} samples without a slip")


def main(words: Sequence[str] | None = None) -> None:
    """Draw, run and report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", action="append", choices=("steady", "slip", "planar", "spatial"), help="can be repeated [default: slip]")
    parser.add_argument("--bearings", type=int, default=BEARINGS, help="how many are drawn")
    parser.add_argument("--seed", type=int, default=SEED, help="of the draw")
    parser.add_argument("--only", type=int, action="append", help="run this bearing of the draw alone; can be repeated")
    parser.add_argument("--show", type=int, help="print the scene of this bearing of the draw, and run nothing")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    options = parser.parse_args(words)
    drawn = scenes(options.bearings, options.seed)
    if options.show is not None:
        print(scene_to_yaml(drawn[options.show]))
        return
    report = {"seed": options.seed, "levels": {}}
    for level in options.level or ("slip",):
        rows = []
        for number, scene in enumerate(drawn):
            if options.only is None or number in options.only:
                rows.append({"number": number} | examine(replace(scene, level=level)))
                print(f"\r{level} {number + 1}/{len(drawn)}", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        report["levels"][level] = rows
        if not options.json:
            print_report(level, rows)
    if options.json:
        print(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
