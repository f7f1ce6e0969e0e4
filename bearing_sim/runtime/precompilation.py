# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compile levels ahead of time, in parallel processes, and remove the code that older versions have compiled.

Each level is compiled when it first runs, which takes from half a minute (`slip`) to a minute (`spatial`) of one core, once per version of the model.
For a machine image or a test suite it is faster to compile everything at once, on all cores.
"""

import gc
import multiprocessing
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from bearing_sim.files.cores import cores
from bearing_sim.runtime.durations import expected, keep

if TYPE_CHECKING:
    from bearing_sim.scene.scene import Scene

_SECONDS = 1e-4  # a run this short calls everything that has to be compiled
_SLOWEST_FIRST = "spatial", "planar", "steady", "slip"
_REFERENCE = {"slip": 28.0, "steady": 36.0, "planar": 45.0, "spatial": 60.0, "thermal equilibrium": 36.0}  # seconds of a core, see `durations`
_COLLECTIONS = 100_000, 50, 10  # thresholds of the garbage collector; with Python's own a seventh of the time goes into objects that live on


class Build(NamedTuple):
    """Something to compile: a level, or the search for thermal equilibrium and for other states in its place."""

    level: str
    equilibrium: bool = False
    bends: bool = False  # for outer rings that bend, which need a version of their own

    @property
    def kind(self) -> str:
        """What is compiled, whatever the outer ring."""
        return "thermal equilibrium" if self.equilibrium else self.level

    def __str__(self) -> str:
        return f"{self.kind} with a ring that bends" if self.bends else self.kind


def is_compiled(level: str, bends: bool = False) -> bool:
    """Return whether the cache of this version of the model holds the code of a level, for outer rings that are rigid or bend."""
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.numerics.compilation import is_cached

    return is_cached(LEVELS[level].advance, bends)


def is_compiled_for(scene: "Scene", with_states: bool = False) -> bool:
    """Return whether the cache of this version of the model holds the code with which a run of a scene starts.

    Parameters
    ----------
    with_states : whether it also ends with a look for other states (`bearing_sim.sweep.states`).
    """
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.levels.steady.operating_point import find_skid_load, solve_point
    from bearing_sim.numerics.compilation import is_cached

    searches, bends = scene.heat.law == "network" and scene.heat.start == "equilibrium", scene.outer_ring_bends
    compiled = is_cached(LEVELS[scene.level].advance, bends) and (not searches or is_cached(solve_point, bends))
    return compiled and (not with_states or is_cached(find_skid_load, bends))


def builds(levels: Sequence[str], bends: bool = False) -> list[Build]:
    """Return what to compile for some levels, the slowest to compile first so that no core is idle at the end.

    Parameters
    ----------
    levels : names.
    bends : whether for outer rings that bend.
    """
    return [Build(level, bends=bends) for level in _SLOWEST_FIRST if level in levels]


def compile_for(scene: "Scene", tell: Callable[[str], None], with_states: bool = False) -> None:
    """Compile what a run of a scene starts with, in processes of their own, unless the cache has it or cannot be written.

    Parameters
    ----------
    tell : is given a line that says what is compiled and how long that will take, if anything is.
    with_states : as of `is_compiled_for`.
    """
    if is_compiled_for(scene, with_states):
        return
    # The search of thermal equilibrium finds other states, too; it is nearly all of the code of level steady.
    searches = (with_states or scene.heat.law == "network") and scene.level != "steady"
    bends = scene.outer_ring_bends
    wanted = [Build(scene.level, bends=bends)] + [Build("slip", True, bends)] * searches
    if not _can_keep():
        tell(f"compiling for this run alone, {_expected(wanted)}, since {_cache_folder()} cannot be written")
        return
    tell(announcement(wanted))
    for _ in compile_all(wanted):
        pass


def announcement(wanted: Sequence[Build]) -> str:
    """Return the line that says what is compiled and how long that will take."""
    return f"compiling, once per version: {_expected(wanted)}"


def _expected(wanted: Sequence[Build]) -> str:
    return ", ".join(f"{build} {expected(f'compiling {build}', _REFERENCE[build.kind])}" for build in wanted)


def _cache_folder() -> Path:
    from bearing_sim.numerics.compilation import CACHE_FOLDER

    return CACHE_FOLDER


def _can_keep() -> bool:
    """Return whether compiled code can be kept: whether its folder, or the first that exists above it, can be written."""
    existing = next(folder for folder in (_cache_folder(), *_cache_folder().parents) if folder.exists())
    return os.access(existing, os.W_OK | os.X_OK)


def compile_all(wanted: Sequence[Build], workers: int | None = None) -> Iterator[Build]:
    """Compile in separate processes; yields each build when it is done, and keeps how long it took.

    Parameters
    ----------
    workers : processes at once; by default the number of cores.

    Raises
    ------
    concurrent.futures.process.BrokenProcessPool
        A process was killed, for example for lack of memory: each takes up to 1 GB.
    """
    workers, fresh = workers or cores(), {build for build in wanted if not _is_built(build)}
    context = multiprocessing.get_context("spawn")
    # One process per build, because a compiler does not release its memory.
    others = multiprocessing.active_children()
    with ProcessPoolExecutor(min(workers, len(wanted)) or 1, context, max_tasks_per_child=1) as pool:
        futures = {pool.submit(_compile, build): build for build in wanted}
        try:
            for future in as_completed(futures):
                seconds, build = future.result(), futures[future]
                if build in fresh:
                    keep(f"compiling {build}", seconds)
                yield build
        except BaseException:  # interrupted: the pool would wait for its processes
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                if process not in others:
                    process.terminate()
            raise


def _is_built(build: Build) -> bool:
    from bearing_sim.levels.steady.operating_point import find_skid_load
    from bearing_sim.numerics.compilation import is_cached

    return is_cached(find_skid_load, build.bends) if build.equilibrium else is_compiled(build.level, build.bends)


def _compile(build: Build) -> float:
    """Compile, in a process that does nothing else; return how long that took [s]."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # ends without a traceback
    began = time.monotonic()
    _run(build)
    return time.monotonic() - began


def _run(build: Build) -> None:
    from bearing_sim.numerics.compilation import prune_no_references
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.simulation import Simulation, scene_inputs

    # settings of this process, which does nothing else
    gc.set_threshold(*_COLLECTIONS)
    prune_no_references()
    bending = ["mounting.housing.backing={law: rigid_bore, play: 0 um}"] * build.bends
    if build.equilibrium:
        from bearing_sim.levels.steady.equilibrium import thermal_equilibrium

        scene = load_scene("deng2017_table1_cold", [f"level={build.level}", *bending])
        thermal_equilibrium(scene, scene_inputs(scene))
        _compile_search_for_skids(scene)
        return
    simulation = Simulation(load_scene("deng2017_table1", [f"level={build.level}", *bending]))
    simulation.advance(_SECONDS, simulation.inputs, 1)
    if build.level == "steady":
        _compile_search_for_skids(simulation.scene)


def _compile_search_for_skids(scene: "Scene") -> None:
    from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
    from bearing_sim.levels.steady.model import new_work
    from bearing_sim.levels.steady.operating_point import find_skid_load
    from bearing_sim.model.params import pack
    from bearing_sim.model.temperatures import lubricate_scene

    params, speed = pack(scene), scene.operating.shaft_speed
    lubrication, work = lubricate_scene(scene, params, scene.lubricant.temperature), new_work(params)
    model = Model(params, lubrication, Drive(0.0, speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), DEFAULT_TOLERANCES)
    find_skid_load(0.05, 0.0, 1.0, 2.0, model, work.bearing, work.orbit)


def remove_other_versions() -> int:
    """Remove the machine code of all other versions of the model; return its size [byte]."""
    from bearing_sim.numerics.compilation import CACHE_FOLDER

    removed = 0
    for folder in sorted(CACHE_FOLDER.parent.iterdir()) if CACHE_FOLDER.parent.is_dir() else []:
        if folder.name != CACHE_FOLDER.name and folder.is_dir():
            removed += sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
            shutil.rmtree(folder)
    return removed
