# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Names of the optional watchers of a run that a scene may ask for, and where each of them is; see `bearing_sim.watchers.monitoring.watchers`."""

from importlib.metadata import entry_points

from bearing_sim.scene.errors import did_you_mean

WATCHERS = {
    "loaded_rollers": "bearing_sim.watchers.monitoring.loaded_rollers:LoadedRollers",
}
"""Module and class by name."""

GROUP = "bearing_sim.watchers"
"""Entry points of other packages: ``name = module:class``; the names above come first."""


def place_of(name: str) -> str | None:
    """Return module and class of a watcher, ``module:class``; None where no installed package has one of this name."""
    if name in WATCHERS:
        return WATCHERS[name]
    return next((each.value for each in entry_points(group=GROUP, name=name)), None)


def watcher_errors(scene) -> list[str]:
    """Return an error message for each watcher of a scene that is not installed or is named twice."""
    errors = []
    for name in dict.fromkeys(scene.watchers):
        if place_of(name) is None:
            known = sorted({*WATCHERS, *(each.name for each in entry_points(group=GROUP))})
            errors.append(f"watchers: there is no watcher {name!r}{did_you_mean(name, known)}; expected some of {', '.join(known)}")
        elif scene.watchers.count(name) > 1:
            errors.append(f"watchers: {name} is named twice")
    return errors
