# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compile ahead of need: levels and methods in processes of their own, side by side; and let go what older versions have compiled.

Each level is compiled when it first runs, which takes from seconds (`slip`) to minutes (`spatial`) of one core, once for a version of the model.
An image for a machine, or a whole test suite, is better served by having all of it compiled at once, on all cores.
"""

import multiprocessing
import shutil
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import NamedTuple

from bearing_sim.cores import cores

_SECONDS = 1e-4  # a run as short as this calls all that there is to compile


class Build(NamedTuple):
    """One thing to compile: a level advanced by a method.

    Attributes
    ----------
    level, method : names, see `bearing_sim.levels.level`.
    fixed_step : with steps of a fixed size instead of those that the tolerance asks for.
    """

    level: str
    method: str
    fixed_step: bool = False

    def __str__(self) -> str:
        return f"{self.level} by {self.method}" + (" in fixed steps" if self.fixed_step else "")

    @property
    def overrides(self) -> list[str]:
        """What makes any scene one that runs this."""
        return [f"level={self.level}", f"integration.method={self.method}", *(["integration.fixed_step=10 us"] if self.fixed_step else [])]


def builds(levels: Sequence[str], every_method: bool = False) -> list[Build]:
    """Return what there is to compile for some levels, the dearest first so that no core idles at the end.

    Parameters
    ----------
    levels : names.
    every_method : also the methods that a level does not take by itself, and fixed steps.
    """
    from bearing_sim.levels.level import LEVELS

    dearest_first = [level for level in reversed(LEVELS) if level in levels]
    first = [Build(level, next(iter(LEVELS[level].methods))) for level in dearest_first]
    if not every_method:
        return first
    others = [
        build
        for level in dearest_first
        for name, method in LEVELS[level].methods.items()
        for build in (Build(level, name), *([Build(level, name, True)] if method.advance_fixed is not None else []))
    ]
    return first + [build for build in others if build not in first]


def compile_all(wanted: Sequence[Build], workers: int | None = None) -> Iterator[Build]:
    """Compile in processes of their own; yields what is done, as it is done.

    Parameters
    ----------
    workers : processes at once; as many as there are cores where absent.

    Raises
    ------
    concurrent.futures.process.BrokenProcessPool
        A process was killed, as where memory is short: one takes up to 1 GB.
    """
    workers = workers or cores()
    context = multiprocessing.get_context("spawn")
    # A process for each: what a compiler has taken of memory it does not give back.
    with ProcessPoolExecutor(min(workers, len(wanted)) or 1, context, max_tasks_per_child=1) as pool:
        futures = {pool.submit(_compile, build): build for build in wanted}
        for future in as_completed(futures):
            future.result()
            yield futures[future]


def _compile(build: Build) -> None:
    from bearing_sim.scene_file import load_scene
    from bearing_sim.simulation import Simulation

    simulation = Simulation(load_scene("deng2017_table1", build.overrides))
    simulation.advance(_SECONDS, simulation.inputs, 1)


def remove_other_versions(tell: Callable[[str], None] = lambda name: None) -> int:
    """Remove the machine code of all versions of the model but this one; returns how much it was [byte]."""
    from bearing_sim.kernels.compilation import CACHE_FOLDER

    removed = 0
    for folder in sorted(CACHE_FOLDER.parent.iterdir()) if CACHE_FOLDER.parent.is_dir() else []:
        if folder.name != CACHE_FOLDER.name and folder.is_dir():
            removed += sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
            shutil.rmtree(folder)
            tell(folder.name)
    return removed
