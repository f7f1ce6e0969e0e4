# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a housing does to a bearing whose outer ring bends: slip, life and seat over play and housing, and what the ring itself endures.

Rollers and seat push the ring with forces F_i at azimuths phi_i, outwards positive, F_n their sum in n waves.  Equilibrium alone gives its bending
moment, positive where the outside is stretched,

    M(phi) = R/pi sum over n >= 2 of F_n/(n^2 - 1) cos n phi,

of one force M = F R [1/2 + cos x/4 - (pi - x)/2 sin x]/pi with x from 0 to 2 pi behind it (S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability,
second edition 1961, section 7.1): 3/(4 pi) F R under a force that a pressure like a cosine balances.  The neutral line does not stretch and sections
stay plane, so that a point of the seat, R_s from the centre, slides along the circumference by

    sum over n >= 2 of F_n [(R_s - R) R^2/(pi E I n (n^2 - 1)) - c_n/n] sin n phi,

c_n the compliance of `bearing_sim.physics.outer_ring`, besides what the ring moves as a whole.  Friction, which would hold the seat, and how far the
bore itself moves along its circumference are left out.
"""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.levels.common.model import write_growth
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.model.params import pack, ring_section
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.outer_ring import RingSection, ring_compliance
from bearing_sim.physics.ring_balance import POINT, ROLLER
from bearing_sim.scene.display import hours, number
from bearing_sim.scene.fidelity import ENDLESS
from bearing_sim.scene.loader import catalog_names, did_you_mean, load_scene
from bearing_sim.scene.outer_ring import ring_geometry
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation, scene_inputs
from bearing_sim.studies.clearance_map import at_level_steady
from bearing_sim.studies.columns import columns_of
from bearing_sim.sweep.pictures import legend_below, look_of, new_figure, plain_numbers, save, set_limits, with_gaps
from bearing_sim.sweep.point import FAILED, OK
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.thermal import operating_state

PLAY = "mounting.housing.backing.play"
RIGID, RIGID_BORE, OWN = "rigid", "rigid_bore", "scene"
"""Housings beside materials of the catalogue: a rigid ring, a ring that bends in a rigid bore, and the housing of the scene."""
MATERIALS = ("aluminium", "cast_iron", "steel")
COLUMNS = columns_of("housing")
_PARTS = 16  # of a roller pitch: cage angles, and points of the seat, of which arcs and pressures need more than lives do
_NEAR = 5e-8  # m, to which bisection finds a play
_LARGEST_LIMIT = 7e8  # Pa, of `endurance_limit`


class PlayLimit(NamedTuple):
    """Up to which play slip stays below its limit in a housing, or from which play on life is above its own."""

    housing: str
    kind: str  # slip, life
    limit: float  # of slip; of life [h]
    play: float  # [m]; NaN where no play of the range is the last or the first
    verdict: str  # bounded; any: every play of the range meets it; none: the least does not, nor for a life any other; unknown: points have no result


class RingFacts(NamedTuple):
    """What an outer ring and its seat endure while the cage turns by a roller pitch; of a free ring the seat has NaN."""

    least_arc: float  # of contact with the housing [rad]
    largest_arc: float
    seat_pressure: float  # the largest [Pa]; mean over a point of the seat
    least_stress: float  # by bending, at an edge of the section [Pa], negative: compression
    largest_stress: float
    stress_range: float  # largest less least at a point fixed on the ring, where that is largest [Pa]
    endurance_limit: float  # [Pa], see `endurance_limit`
    micromotion: float  # largest range over which a point of the ring's seat slides while it touches, without friction [m]


class HousingMap(NamedTuple):
    """Results: a row for each housing and play, the plays at which limits are met, and the ring in the scene's own housing; None: it is rigid."""

    table: Table
    limits: tuple[PlayLimit, ...]
    ring: RingFacts | None


class Pitch(NamedTuple):
    """A bearing in balance at K cage angles over a roller pitch, Z rollers and M = K Z points of the seat, which turn with the cage."""

    angles: np.ndarray  # of roller 0 [rad], shape (K,)
    inner: np.ndarray  # loads on the inner raceway [N], shape (K, Z)
    rollers: np.ndarray  # forces on the outer ring, outwards [N], shape (K, Z); of a ring that bends
    seat: np.ndarray  # forces of the housing on the ring, inwards [N], shape (K, M); M = 0 of a free ring
    moved: np.ndarray  # the ring in its housing, y and z [m], shape (K, 2)
    deflections: np.ndarray  # of the ring at the rollers, outwards [m], shape (K, Z)


def housings_of(scene: Scene) -> tuple[str, ...]:
    """Return the names of the housings that are compared where nobody chooses others."""
    own = (OWN,) if scene.mounting.housing.backing.law == "elastic" else ()
    return (*own, *MATERIALS, RIGID_BORE, RIGID)


def scene_in(scene: Scene, housing: str, play: float) -> Scene:
    """Return a scene at level steady with its outer ring in another housing, with the waves of its bore.

    Parameters
    ----------
    housing : `OWN`, `RIGID`, `RIGID_BORE` or a material of the catalogue, of which the housing is massive.
    play : radial play of the running ring [m]; it replaces fit and interference of the scene.

    Raises
    ------
    ValueError
        There is no such housing, or the scene has none of its own.
    SceneError
        The ring cannot bend there: it says why.
    """
    backing, materials = scene.mounting.housing.backing, catalog_names("materials")
    bore = {"play": play, "bore_waves": [asdict(wave) for wave in getattr(backing, "bore_waves", ())]}
    given: dict = {"fit": None, "interference": None}
    if housing == RIGID:
        given = {"backing": RIGID}
    elif housing == OWN:
        if not hasattr(backing, "play"):
            raise ValueError(f"housing {OWN}: mounting.housing.backing is {backing.law}, which has no play; choose elastic, rigid_bore or bed there")
        given["backing"] = asdict(backing) | bore
    elif housing == RIGID_BORE:
        given["backing"] = {"law": RIGID_BORE, **bore}
    elif housing in materials:
        given |= {"material": housing, "outside_radius": None, "backing": {"law": "elastic", "massive": True, **bore}}
    else:
        known = (OWN, RIGID, RIGID_BORE, *materials)
        raise ValueError(f"housing {housing!r}: unknown{did_you_mean(housing, known)}; known: {', '.join(known)}")
    return load_scene(at_level_steady(scene), [f"mounting.housing.{name}={json.dumps(value)}" for name, value in given.items()])


def solved(scene: Scene) -> tuple[np.void, Pitch]:
    """Return the sample of a scene at level steady under its constant conditions, and the bearing over one roller pitch at the speed of its cage.

    Raises
    ------
    ArithmeticError, IntegrationError
        There is no operating point, balance or thermal equilibrium: it says why.
    """
    inputs = scene_inputs(scene)
    _, lubrication, temperatures = operating_state(scene, inputs)
    simulation = Simulation(scene, inputs, empty_table())
    if simulation.thermal is not None:
        simulation.set_temperatures(temperatures)
    sample = simulation.advance(ENDLESS, samples=2)[-1]
    finer = replace(scene.bearing, outer_ring=replace(scene.bearing.outer_ring, points=_PARTS))
    params = pack(replace(scene, bearing=finer))
    work, count, found = new_work(params), params.rollers.count, []
    write_growth(inputs.shaft_speed, lubrication.growth, work.growth)
    angles = scene.operating.load_angle + 2.0 * math.pi / count * np.arange(_PARTS) / _PARTS
    for angle in angles:
        if not balance_loads(angle, float(sample["cage_speed"]), inputs.load_y, inputs.load_z, params, work):
            raise ArithmeticError(f"the balance of rollers and outer ring did not converge at a cage angle of {math.degrees(angle):.4g} deg")
        bent, inner = work.bending, work.loads[LOAD.inner].copy()
        if bent is None:
            found.append((inner, 0.0 * inner, np.zeros(0), np.zeros(2), 0.0 * inner))
        else:
            seat, moved = np.split(bent.points[POINT.force].copy(), [-2])
            found.append((inner, bent.rollers[ROLLER.force].copy(), seat, moved, bent.rollers[ROLLER.deflection].copy()))
    return sample, Pitch(angles, *map(np.array, zip(*found)))


def _arcs(pitch: Pitch) -> np.ndarray:
    """Return the angle over which the seat touches at each cage angle [rad]; NaN of a ring without a seat."""
    points = pitch.seat.shape[1]
    return 2.0 * math.pi * np.sum(pitch.seat > 0.0, axis=1) / points if points else np.full(len(pitch.angles), math.nan)


def _pressure(pitch: Pitch, scene: Scene) -> float:
    """Return the largest pressure of the seat, a mean over one of its points [Pa]."""
    points, section = pitch.seat.shape[1], ring_geometry(scene.bearing)
    return float(pitch.seat.max()) * points / (2.0 * math.pi * section.seat_radius * section.width) if points else math.nan


def row_at(scene: Scene, housing: str, play: float) -> dict:
    """Return the results of a scene in a housing with a play, by the names of `COLUMNS` and in their units; parameters as of `scene_in`."""
    row = {column.name: math.nan for column in COLUMNS}
    row |= {"housing": housing, PLAY: math.nan if housing == RIGID else round(1e6 * play, 6), "status": OK, "reason": ""}
    within = scene_in(scene, housing, play)
    try:
        sample, pitch = solved(within)
    except (ArithmeticError, IntegrationError) as error:
        return row | {"status": FAILED, "reason": str(error)}
    bent = 2.0 * np.sum(pitch.inner * pitch.deflections, axis=1) / np.fmax(pitch.inner.sum(axis=1), 1e-9)
    return row | {
        "cage_slip": 100.0 * float(sample["cage_slip"]),
        "life": float(sample["modified_rating_life"]),
        "inner_load_maximum": float(pitch.inner.max()),
        "seat_arc": math.degrees(_arcs(pitch).mean()),
        "seat_pressure": 1e-6 * _pressure(pitch, within),
        "bending_clearance": round(1e6 * float(bent.mean()), 6) + 0.0,
    }


def map_housings(
    scene: Scene,
    housings: Sequence[str],
    plays: Sequence[float],
    slip_below: float,
    life_above: float | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> HousingMap:
    """Return what housings and plays do to a scene.

    Parameters
    ----------
    scene : see `bearing_sim.studies.clearance_map.at_level_steady`.
    housings : see `scene_in`.
    plays : radial [m], ascending.
    slip_below, life_above : limits of slip and of life [h] for which plays are sought; None: none for the life.
    progress : called with the number of finished points.
    """
    rows, limits = [], []
    kinds = {"slip": slip_below} | ({} if life_above is None else {"life": life_above})
    for housing in housings:
        scene_in(scene, housing, plays[0])  # refused before anything is computed
    ring = ring_facts(scene)
    for housing in housings:
        line = []
        for play in plays[:1] if housing == RIGID else plays:
            line.append(row_at(scene, housing, play))
            progress(len(rows) + len(line))
        rows += line
        if housing != RIGID:
            limits += [_limit(scene, line, kind, limit) for kind, limit in kinds.items()]
    about = {"kind": "housing", "scene": scene.name, "level": "steady", "version": package_version(), "commit": git_hash()}
    axes = (("housing", "", list(housings)), (PLAY, "um", [round(1e6 * each, 6) for each in plays]))
    about["axes"] = [dict(zip(("field", "unit", "values"), each)) for each in axes]
    return HousingMap(Table(COLUMNS, rows, about), tuple(limits), ring)


def _limit(scene: Scene, line: Sequence[dict], kind: str, limit: float) -> PlayLimit:
    """Return the play at which one housing's rows first cease to meet a limit of slip, or first meet one of life."""
    housing, found = line[0]["housing"], [row for row in line if row["status"] == OK]

    def meets(row: dict) -> bool:
        return row["cage_slip"] < 100.0 * limit if kind == "slip" else row["life"] > limit

    held = [meets(row) for row in found]
    wanted = kind == "slip"
    if not held or held[0] != wanted or all(each == wanted for each in held):
        is_known = bool(held) and (held[0] != wanted or len(found) == len(line))
        return PlayLimit(housing, kind, limit, math.nan, ("any" if held[0] else "none") if is_known else "unknown")
    first = held.index(not wanted)
    low, high = (1e-6 * found[k][PLAY] for k in (first - 1, first))
    while high - low > _NEAR:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if meets(row_at(scene, housing, middle)) == wanted else (low, middle)
    return PlayLimit(housing, kind, limit, low if wanted else high, "bounded")


def bending_moment(behind, radius: float):
    """Return the bending moment of a ring by a unit force [N m/N], positive where its outside is stretched.

    Parameters
    ----------
    behind : angle from the force [rad].
    radius : of the neutral line [m].
    """
    x = np.mod(behind, 2.0 * math.pi)
    return radius / math.pi * (0.5 + 0.25 * np.cos(x) - 0.5 * (math.pi - x) * np.sin(x))


def seat_slide(behind, offset: float, ring: RingSection, waves: int):
    """Return how far a unit force moves the seat of a ring along its circumference [m/N], see the docstring of the module.

    Parameters
    ----------
    behind : angle from the force [rad].
    offset : of the seat from the neutral line, R_s - R [m].
    ring : its section.
    waves : as many as the ring bends in.
    """
    n = np.arange(2.0, waves + 1.0)
    turned = ring.radius**2 / (math.pi * ring.modulus * ring.second_moment * n * (n * n - 1.0))
    return np.sin(np.multiply.outer(behind, n)) @ (offset * turned - ring_compliance(n, ring) / n)


def endurance_limit(strength: float) -> float:
    """Return the endurance limit of a polished rotating-beam specimen of steel [Pa] by its tensile strength [Pa].

    Half of it, at most 700 MPa (R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, 9th edition 2011, eq. 6-8).  That of a part is
    lower by its surface, size, reliability and mean stress.
    """
    return min(0.5 * strength, _LARGEST_LIMIT)


def ring_facts(scene: Scene) -> RingFacts | None:
    """Return what the outer ring of a scene and its seat endure in the scene's own housing; None where the ring is rigid.

    Raises
    ------
    ArithmeticError, IntegrationError
        There is no operating point, balance or thermal equilibrium: it says why.
    """
    if not scene.outer_ring_bends:
        return None
    bearing, section, ring = scene.bearing, ring_geometry(scene.bearing), ring_section(scene.bearing)
    _, pitch = solved(at_level_steady(scene))
    offset, points = section.seat_radius - section.radius, np.arange(_PARTS * bearing.roller.count)
    fixed = pitch.angles[0] + 2.0 * math.pi / len(points) * points  # points of the seat at the first cage angle; at the next one those after them
    seat = np.array([np.roll(forces, k) for k, forces in enumerate(pitch.seat)]) if pitch.seat.size else np.zeros((_PARTS, len(points)))
    forces = -seat
    for k, rollers in enumerate(pitch.rollers):
        forces[k, k::_PARTS] += rollers
    behind = np.subtract.outer(points, points) % len(points)
    moments = forces @ bending_moment(fixed - fixed[0], section.radius)[behind].T
    slides = forces @ seat_slide(fixed - fixed[0], offset, ring, len(points) // 2)[behind].T
    slides += np.multiply.outer(pitch.moved[:, 1], np.cos(fixed)) - np.multiply.outer(pitch.moved[:, 0], np.sin(fixed))
    stresses = np.multiply.outer([offset, section.inner_edge - section.radius], moments) / section.second_moment
    touches = seat > 0.0
    slid = np.where(touches, slides, -math.inf).max(axis=0) - np.where(touches, slides, math.inf).min(axis=0)  # negative where nothing touches
    arcs = _arcs(pitch)
    return RingFacts(
        least_arc=float(arcs.min()),
        largest_arc=float(arcs.max()),
        seat_pressure=_pressure(pitch, scene),
        least_stress=float(stresses.min()),
        largest_stress=float(stresses.max()),
        stress_range=float(np.ptp(stresses, axis=1).max()),
        endurance_limit=endurance_limit(bearing.material.strength),
        micromotion=float(slid.max()) if pitch.seat.size else math.nan,
    )


def in_words(found: HousingMap) -> list[str]:
    """Return the plays at which limits are met, a sentence for each."""
    return [_said(each) for each in found.limits]


def _said(each: PlayLimit) -> str:
    play = f"{number(1e6 * each.play, 3)} µm"
    if each.kind == "slip":
        what, bounded = f"slip stays below {number(100.0 * each.limit)} %", f"up to a play of {play}"
    else:
        what, bounded = f"life is above {hours(each.limit)}", f"from a play of {play} on"
    where = {"bounded": bounded, "any": "with every play of the range", "none": "with no play of the range", "unknown": "is not known"}[each.verdict]
    return f"{each.housing}: {what} {where}"


def facts_in_words(ring: RingFacts) -> list[tuple[str, str]]:
    """Return what a ring and its seat endure, as names and texts."""
    least, largest, pressure = math.degrees(ring.least_arc), math.degrees(ring.largest_arc), 1e-6 * ring.seat_pressure
    low, high, span, endured = (1e-6 * each for each in (ring.least_stress, ring.largest_stress, ring.stress_range, ring.endurance_limit))
    seat = [
        ("contact arc of the seat", f"{number(least, 3)} to {number(largest, 3)}°"),
        ("largest pressure of the seat", f"{number(pressure, 3)} MPa"),
        ("sliding in the seat, without friction", f"{number(1e6 * ring.micromotion, 3)} µm"),
    ]
    return [
        *(() if math.isnan(ring.least_arc) else seat),
        ("bending stress at the ring's edges", f"{number(low, 3)} to {number(high, 3)} MPa"),
        ("largest stress amplitude at a point", f"{number(0.5 * span, 3)} MPa"),
        ("endurance limit, polished specimen", f"{number(endured, 3)} MPa"),
    ]


_DRAWN = (("cage_slip", "cage slip [%]"), ("life", "life [h]"), ("seat_arc", "contact arc of the seat [°]"))


def plot_housing_map(path: Path, title: str, found: HousingMap) -> None:
    """Draw slip, life and contact arc over play, a line for each housing; the suffix of ``path`` gives the format."""
    figure = new_figure(13, 4.8)
    axes, names = figure.subplots(1, 3), list(dict.fromkeys(found.table.values("housing")))
    for each, (column, label) in zip(axes, _DRAWN):
        for k, name in enumerate(names):
            rows = [row for row in found.table.rows if row["housing"] == name]
            values = with_gaps([row[column] for row in rows])
            if name == RIGID:
                each.axhline(values[0], color="0.45", ls=":", lw=1.6, label="rigid ring")
            else:
                each.plot([row[PLAY] for row in rows], values, **look_of(k, ms=4, lw=1.4, label=name.replace("_", " ")))
        each.set(xlabel="radial play of the ring [µm]", ylabel=label)
        each.grid(alpha=0.3)
        plain_numbers(each.xaxis)
    for limit in found.limits:
        place = 0 if limit.kind == "slip" else 1
        value = 100.0 * limit.limit if limit.kind == "slip" else limit.limit
        axes[place].axhline(value, color="black", ls="--", lw=1.0, label="" if limit is not found.limits[0] else "limit")
        if limit.verdict == "bounded":
            axes[place].plot(1e6 * limit.play, value, "x", color="black", ms=7, mew=1.6)
    axes[0].set_ylim(bottom=0.0)
    lives = np.array(found.table.values("life"))
    set_limits(axes[1], lives[np.isfinite(lives)], True)
    axes[2].set_ylim(bottom=0.0)
    legend_below(figure, axes[0])
    save(figure, path, title, 11)
