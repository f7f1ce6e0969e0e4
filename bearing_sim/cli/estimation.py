# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the commands share about estimates: the response of a scene, and bands as rows and numbers."""

import math

from bearing_sim.cli.reporting import note, progress_bar
from bearing_sim.scene.display import hours


def _percent(low, high) -> str:
    return f"{100 * low:.2f} to {100 * high:.2f} %"


def _hours(low, high) -> str:
    return f"{hours(low)} to {hours(high)}"


def _micrometres(low, high) -> str:
    return f"{1e6 * low:.1f} to {1e6 * high:.1f} µm"


_SHOWN = {  # words and text of the bands of a replay by name
    "cage_slip": ("cage slip, 5 to 95 %", lambda low, high: f"{_percent(low, high)}, mean while turning"),
    "largest_cage_slip": ("largest cage slip, 5 to 95 %", _percent),
    "least_rating_life": ("least rating life, 5 to 95 %", _hours),
    "least_running_clearance": ("least running clearance, 5 to 95 %", _micrometres),
    "remaining_life": ("remaining life at the end, 5 to 95 %", _hours),
}
# Of a run at its end.  Its remaining life would be the rating life under the same conditions, but for the damage of its first seconds, in which the
# cage comes to its slip: that is no answer about a bearing in service.
_NEWEST = {
    "cage_slip": ("cage slip, 5 to 95 %", _percent),
    "rating_life": ("rating life, 5 to 95 %", _hours),
    "running_clearance": ("running clearance, 5 to 95 %", _micrometres),
}


def response_with_progress(scene, rebuild=False, workers=None, dask=None):
    """Return the response of a scene to its uncertain fields, from disk or newly built.

    Parameters
    ----------
    scene : the scene.
    rebuild : whether to build it even if it is kept.
    workers : number of processes; None: all cores.
    dask : address of a Dask scheduler to compute on instead; None: this machine.

    Raises
    ------
    UsageError
        The scene has no uncertain fields, another command is building the response, or the scheduler does not answer.
    """
    from bearing_sim.studies.response_points import obtain_response
    from bearing_sim.sweep.tasks import Execution
    from bearing_sim.watchers.estimation.response import kept_response

    if not rebuild and (kept := kept_response(scene)) is not None:
        return kept
    note(f"building the response of {scene.name} to its uncertain fields, once for this bearing and oil ...")
    with progress_bar("operating points", 1.0) as show:
        return obtain_response(scene, Execution(None, workers, dask, lambda done, total: show(done / max(total, 1))), rebuild)


def estimation_with_progress(scene):
    """Return what estimates during a run of a scene that asks for it (`bearing_sim.watchers.estimation.live.LiveEstimation`); None otherwise."""
    if not scene.estimation.is_asked:
        return None
    from bearing_sim.watchers.estimation.live import LiveEstimation

    return LiveEstimation(scene, response_with_progress(scene))


def band_rows(statistics, scene) -> list[tuple[str, str]]:
    """Return the rows of a table for the bands of a replay of a scene (`bearing_sim.runtime.replay.Replay.band_statistics`)."""
    return _rows(_SHOWN, statistics, scene)


def live_band_rows(newest, scene) -> list[tuple[str, str]]:
    """Return the rows of a table for the newest bands of a run of a scene (`bearing_sim.watchers.estimation.live.LiveEstimation.newest`)."""
    return _rows(_NEWEST, newest, scene)


def _rows(shown, bands, scene) -> list[tuple[str, str]]:
    from bearing_sim.scene.uncertainty import ranges_of, without_dimensions

    note = without_dimensions(one.field for one in ranges_of(scene))
    return [
        (words, f"{text(*bands[name])}{note if name.endswith('life') else ''}")
        for name, (words, text) in shown.items()
        if name in bands and not math.isnan(sum(bands[name]))
    ]


def band_numbers(bands) -> dict[str, list[float]]:
    """Return bands for JSON: the 5 and 95 % quantiles by name."""
    return {f"{name}_band": list(pair) for name, pair in bands.items()}


def live_band_numbers(newest) -> dict[str, list[float]]:
    """Return the bands of `live_band_rows` for JSON."""
    return band_numbers({name: newest[name] for name in _NEWEST if name in newest})
