# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A cold start over time: a bearing idles while its losses warm it, then the load comes; slip, films, temperatures and sliding power.

All parts start as cold as the oil and the air, once with a cage that rolls and once with one that stands.  The thermal network warms them at level
``steady``.  What the load does to a skidding cage takes a fraction of a second: level ``slip`` computes it, at the temperatures of several instants
of idling, and for a machine that idles again when it is warm.  Oil that flows through the bearing comes in as cold as it was at the start.
"""

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.model.films import films_of
from bearing_sim.model.params import pack
from bearing_sim.model.plausibility import minimum_load
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.model.validity import contact_speeds
from bearing_sim.physics.heat import hertz_half_width
from bearing_sim.physics.thermal_network import NODES
from bearing_sim.scene.display import ZERO_CELSIUS
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation, scene_inputs, thermal_nodes
from bearing_sim.sweep.pictures import new_figure, plain_numbers, save
from bearing_sim.sweep.settling import advance_until_settled, longest_run, shortest_run
from bearing_sim.sweep.states import ROLLING, SKID, at_level_slip, standing_cage
from bearing_sim.sweep.thermal import SKIDS, equilibrium_temperatures, simulation_held_at
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm

DEFAULT_SCENE = "nu232_wind_gearbox"
DEFAULT_OVERRIDES = ("lubricant.supply={law: oil_bath}", "lubricant.mixture_fraction=null")  # of that scene: no oil flows that stays cold
COLD = 273.15  # K, at the start
SHARES = (0.05, 0.3)  # loads while idling, of the makers' minimum load
LOADED = 0.1  # load afterwards, of C
IDLING = 3600.0  # s
RISE = 1.0  # s in which the load rises
NEAR = 2.0  # K from thermal equilibrium, at which a course ends
_LONGEST = 48 * 3600.0  # s under load
_FIRST, _FIRST_LOADED, _GROWTH = 1.0, 60.0, 1.25  # s to the first sample of idling and under load; time of a sample over that of the one before
_INTERVAL = 0.1  # of the network, over the time since conditions changed, so that losses follow temperatures
_LEAST_INTERVAL, _LARGEST_INTERVAL = 0.5, 100.0  # s
_SAME_SLIP, _SAME_TEMPERATURE = 1e-3, 0.1  # K; differences of two courses that have become one
_LOADED_AFTER = (60.0, 300.0, 900.0)  # s of idling after which the load comes, besides the first second and the end of idling
_RATE, _HELD = 2000.0, 1.0  # samples a second while it does; s for which it stays
_ROLLS = 0.02  # slip of a cage that rolls


class Instant(NamedTuple):
    """State of a bearing at an instant of a course."""

    time: float  # since the start [s]
    cage_slip: float
    film: float  # least thickness between any roller and raceway [m]
    film_left: float  # thickness over that of full inlets, as lives take it
    asperity_share: float  # share of loads that asperities carry; NaN where the scene has none
    sliding_power: float  # in the contacts with both raceways [W]
    friction_moment: float  # [N m]
    temperatures: tuple[float, ...]  # by `bearing_sim.model.sample.NODE_OBSERVABLES` [K]


class Course(NamedTuple):
    """A cold start over time."""

    load: float  # while idling [N]
    start: str  # of the cage, `ROLLING` or `SKID`
    instants: tuple[Instant, ...]
    loaded_at: float  # when the load comes [s]
    remaining: float  # of the warmest difference from equilibrium at the end [K]


class Loading(NamedTuple):
    """What a cage goes through if the load comes after some time, at the temperatures that the bearing has then."""

    load: float  # while idling [N]
    start: str
    time: float  # since the start [s]; of a machine that idles again when it is warm, that of the course's end
    cage_slip: float  # before
    idling_power: float  # largest sliding power of a contact before [W]
    contact_power: float  # and while the load comes [W]
    intensity: float  # the latter over the area of its contact [W/m^2]
    energy: float  # of sliding in all contacts until the cage rolls [J]
    rolls_after: float  # from the beginning of the rise of the load [s]; infinite where it skids on


class ColdStart(NamedTuple):
    """A cold start from all loads and starts."""

    minimum_load: float  # of the makers [N]
    loaded: float  # load afterwards [N]
    courses: tuple[Course, ...]
    loadings: tuple[Loading, ...]


def cold_scene(scene: Scene, start: float = COLD) -> Scene:
    """Return a scene at level steady whose parts, oil and air are as cold as ``start`` [K], with a thermal network."""
    celsius = f"{start - ZERO_CELSIUS} degC"
    network = [] if scene.heat.law == "network" else ["heat={law: network}"]
    changed = load_scene(scene, [*network, f"heat.ambient_temperature={celsius}", f"lubricant.temperature={celsius}"])
    return changed.at_level("steady")


def cold_start(
    scene: Scene,
    loads: Sequence[float] = (),
    loaded: float | None = None,
    idling: float = IDLING,
    start: float = COLD,
    rise: float = RISE,
    progress: Callable[[int], None] = lambda done: None,
) -> ColdStart:
    """Return the courses of a bearing that idles and then is loaded until it is within `NEAR` of equilibrium.

    Parameters
    ----------
    scene : its bearing, oil, supply, surroundings and shaft speed count.
    loads : while idling [N]; `SHARES` of the makers' minimum load where there are none.
    loaded : load afterwards [N]; `LOADED` times C where absent.
    idling : time under the first load [s].
    start : temperature of all parts, the oil and the air [K].
    rise : time in which the load rises [s].
    progress : called with the number of courses that are done.

    Raises
    ------
    IntegrationError
        There is no thermal equilibrium under the load.
    """
    scene, least = cold_scene(scene, start), float(minimum_load(scene)[0])
    loaded = LOADED * rate(scene.bearing).dynamic if loaded is None else loaded
    courses, loadings = [], []
    for done, load in enumerate(loads or [share * least for share in SHARES]):
        progress(done)
        idle = scene_inputs(scene).at(radial_load=load)
        conditions = _Conditions(scene, idle, idle.at(radial_load=loaded), idling, rise)
        known: list[tuple[np.void, _Warming]] = []  # ends of idling, and what follows
        for begin in (ROLLING, SKID):
            course, tried = _course(conditions, begin, known)
            courses.append(course)
            loadings += [_loading(conditions, begin, *each) for each in tried]
    return ColdStart(least, loaded, tuple(courses), tuple(loadings))


_Warming = list[tuple[float, np.void]]  # times since conditions changed [s], and samples


class _Conditions(NamedTuple):
    """What a course goes through."""

    scene: Scene  # cold, at level steady
    idle: Inputs
    full: Inputs
    idling: float  # [s]
    rise: float  # [s]

    @property
    def load(self) -> float:
        """While idling [N]."""
        return math.hypot(self.idle.load_y, self.idle.load_z)


def _course(conditions: _Conditions, begin: str, known: list[tuple[np.void, _Warming]]) -> tuple[Course, list[tuple[float, np.ndarray, bool]]]:
    """Return a course, and when the load is tried: times, temperatures of the nodes, and whether the cage comes from a skid."""
    scene, idle, full, idling, _ = conditions
    nodes = np.full(NODES, scene.lubricant.temperature)
    sample = standing_cage(scene, idle, nodes) if begin == SKID else Simulation(scene, idle, nodes=nodes).sample
    tries = [each for each in _LOADED_AFTER if each < idling]
    cold = list(_warm(scene, sample, nodes, idle, _times(_FIRST, idling, tries)))
    sample = cold[-1][1]
    warm = next((found for other, found in known if _is_same(other, sample)), None)
    if warm is None:
        warm = _to_equilibrium(conditions, sample)
        known.append((sample, warm))
    end, film = warm[-1][1], ThinnestFilm(scene)
    tried = [(elapsed, thermal_nodes(at), float(at["cage_slip"]) > SKIDS) for elapsed, at in cold if elapsed in (_FIRST, *tries, idling)]
    tried.append((idling + warm[-1][0], thermal_nodes(end), begin == SKID))
    instants = [_instant(scene, elapsed, at, film) for elapsed, at in (*cold, *((idling + elapsed, at) for elapsed, at in warm))]
    remaining = float(np.abs(thermal_nodes(end) - equilibrium_temperatures(scene, full, end)).max())
    return Course(conditions.load, begin, tuple(instants), idling, remaining), tried


def _is_same(sample: np.void, other: np.void) -> bool:
    apart = np.abs(thermal_nodes(sample) - thermal_nodes(other)).max()
    return bool(abs(sample["cage_slip"] - other["cage_slip"]) < _SAME_SLIP and apart < _SAME_TEMPERATURE)


def _to_equilibrium(conditions: _Conditions, sample: np.void) -> _Warming:
    """Return times since the load begins to rise and samples from there to thermal equilibrium."""
    scene, idle, full, _, rise = conditions
    equilibrium = equilibrium_temperatures(scene, full, sample)
    sample = Simulation(scene, idle, start=sample, nodes=thermal_nodes(sample)).advance(rise, full)[-1]
    found = [(rise, sample)]
    for elapsed, at in _warm(scene, sample, thermal_nodes(sample), full, _times(_FIRST_LOADED, _LONGEST)):
        found.append((rise + elapsed, at))
        if np.abs(thermal_nodes(at) - equilibrium).max() < NEAR:
            break
    return found


def _warm(scene: Scene, start: np.void, nodes: np.ndarray, inputs: Inputs, times: Sequence[float]) -> Iterator[tuple[float, np.void]]:
    """Yield times since the beginning [s] and samples of a bearing that warms under constant conditions."""
    elapsed, sample = 0.0, start
    for stop in times:
        interval = min(max(_INTERVAL * stop, _LEAST_INTERVAL), _LARGEST_INTERVAL)
        paced = dataclasses.replace(scene, heat=dataclasses.replace(scene.heat, interval=interval))
        sample = Simulation(paced, inputs, start=sample, nodes=nodes).advance(stop - elapsed)[-1]
        elapsed, nodes = stop, thermal_nodes(sample)
        yield elapsed, sample


def _times(first: float, duration: float, more: Sequence[float] = ()) -> list[float]:
    """Return times of samples [s], each `_GROWTH` times that before, with ``more`` and the end among them."""
    count = math.ceil(math.log(duration / first) / math.log(_GROWTH)) if duration > first else 0
    return sorted({first * _GROWTH**k for k in range(count)} | {each for each in more if each > 0.0} | {duration})


def _instant(scene: Scene, time: float, sample: np.void, film: ThinnestFilm) -> Instant:
    state = films_of(scene, sample)
    return Instant(
        time,
        float(sample["cage_slip"]),
        float(film.least(np.array([sample]))[0]),
        state.left,
        state.asperity_share,
        float(_sliding(sample)),
        float(sample["friction_moment"]),
        tuple(thermal_nodes(sample).tolist()),
    )


def _sliding(samples: np.ndarray | np.void) -> np.ndarray:
    """Return the sliding power in the contacts with both raceways [W]."""
    return samples["inner_sliding_power"] + samples["outer_sliding_power"]


def _loading(conditions: _Conditions, begin: str, time: float, nodes: np.ndarray, skids: bool) -> Loading:
    """Return what happens at level slip if the load comes at temperatures of the nodes, to a cage that comes from a skid or from rolling."""
    simple, idle, rise = at_level_slip(conditions.scene), conditions.idle, conditions.rise
    run = simulation_held_at(simple, idle, nodes, standing_cage(simple, idle, nodes) if skids else None)
    before = advance_until_settled(run, shortest_run(simple, 0.0), longest_run(simple)).window
    rising = run.advance(rise, conditions.full, samples=max(round(rise * _RATE), 1))
    held = run.advance(_HELD, samples=round(_HELD * _RATE))
    params, samples = pack(simple), np.concatenate([rising, held])
    power, load, radius = max(_heaviest(rising, params), _heaviest(held, params))
    width = hertz_half_width(load, radius, params.rollers.length, params.raceways.reduced_modulus)
    skidding = np.flatnonzero(samples["cage_slip"] > _ROLLS)
    last = int(skidding[-1]) + 1 if len(skidding) else 0
    return Loading(
        conditions.load,
        begin,
        time,
        float(before["cage_slip"].mean()),
        _heaviest(before, params)[0],
        power,
        power / (2.0 * width * params.rollers.length),
        float(_sliding(samples[:last]).sum()) / _RATE,
        last / _RATE if last < len(samples) else math.inf,
    )


def _heaviest(samples: np.ndarray, params) -> tuple[float, float, float]:
    """Return the largest sliding power of any contact in samples of level slip [W], its load [N] and its radius of curvature [m].

    The power in the contacts with a raceway is shared by load times sliding speed: one coefficient of friction for all of them.
    """
    raceways, found = params.raceways, []
    radii = raceways.inner_curvature_radius, raceways.outer_curvature_radius
    for ring, radius, (_, sliding) in zip(("inner", "outer"), radii, contact_speeds(samples, params)):
        weights = samples[f"{ring}_load"] * np.abs(sliding)
        whole = np.maximum(weights.sum(axis=1, keepdims=True), 1e-300)
        powers = samples[f"{ring}_sliding_power"][:, None] * weights / whole
        k = np.unravel_index(np.argmax(powers), powers.shape)
        found.append((float(powers[k]), float(samples[f"{ring}_load"][k]), radius))
    return max(found)


def plot_cold_start(found: ColdStart, path: Path, title: str) -> None:
    """Draw slip, sliding power, films and temperatures over time, a column for each load while idling.

    Parameters
    ----------
    found : courses.
    path : of the picture.
    title : above it.
    """
    loads = list(dict.fromkeys(course.load for course in found.courses))
    figure = new_figure(4.6 * len(loads) + 1.2, 10.0)
    rows = figure.subplots(5, len(loads), squeeze=False, sharex=True, sharey="row")
    for column, load in enumerate(loads):
        axes = rows[:, column]
        for course in (each for each in found.courses if each.load == load):
            _draw_course(course, axes, column == 0)
        for start, mark in ((SKID, "o"), (ROLLING, "x")):
            tried = [each for each in found.loadings if (each.load, each.start) == (load, start)]
            minutes, words = [each.time / 60.0 for each in tried], _words(start)
            axes[2].plot(minutes, [each.contact_power for each in tried], mark, color="tab:red", label=f"as the load comes, {words}")
            axes[2].plot(minutes, [max(each.idling_power, 1e-3) for each in tried], mark, color="tab:blue", label=f"idling, {words}")
        for axis in axes:
            axis.axvline(course.loaded_at / 60.0, color="0.6", ls="--", lw=1.0)
            axis.grid(alpha=0.3)
        axes[0].set(xscale="log", title=f"idling under {load / 1e3:.3g} kN, {100 * load / found.minimum_load:.2g} % of the minimum load")
        for axis in axes[1:4]:
            axis.set_yscale("log")
            plain_numbers(axis.yaxis)
        plain_numbers(axes[0].xaxis)
        axes[4].set_xlabel("time [min]")
    words = ("cage slip [%]", "sliding, all contacts [W]", "sliding, worst contact [W]", "least film [µm]", "temperature [°C]")
    for axis, text in zip(rows[:, 0], words):
        axis.set_ylabel(text)
    for row, place in ((0, "center left"), (2, "center"), (3, "upper left"), (4, "upper left")):
        rows[row, 0].legend(fontsize=7, frameon=False, loc=place, ncols=2 if row == 2 else 1)
    save(figure, path, f"{title}\nload rises to {found.loaded / 1e3:.3g} kN (dashed); from a skid (line), from rolling (dotted)", 11)


def _words(start: str) -> str:
    return "from a skid" if start == SKID else "from rolling"


def _draw_course(course: Course, axes, labelled: bool) -> None:
    from_skid, minutes = course.start == SKID, [each.time / 60.0 for each in course.instants]

    def plot(row, values, label=None, colour="k"):
        axes[row].plot(minutes, values, color=colour, label=label, ls="-" if from_skid else ":", lw=1.6)

    plot(0, [100.0 * each.cage_slip for each in course.instants], _words(course.start))
    plot(1, [each.sliding_power for each in course.instants])
    plot(3, [1e6 * each.film for each in course.instants])
    named = labelled and from_skid
    plot(3, [1e6 * each.film / each.film_left for each in course.instants], "with full inlets" if named else None, "0.6")
    for place, name in enumerate(NODE_OBSERVABLES):
        label = name.removesuffix("_temperature").replace("_", " ") if named else None
        plot(4, [each.temperatures[place] - ZERO_CELSIUS for each in course.instants], label, f"C{place}")
