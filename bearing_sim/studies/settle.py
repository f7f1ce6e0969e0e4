# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a bearing settles to at an operating point: one call from Python, made to be called again and again by an optimiser."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from bearing_sim.model.sample import OBSERVABLES, RING_TEMPERATURES
from bearing_sim.model.validity import Exceedance, Grade, outside
from bearing_sim.scene.display import RPM, ZERO_CELSIUS, force, hours, number, power
from bearing_sim.scene.errors import did_you_mean
from bearing_sim.scene.fidelity import Level
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import ranges_of, without_dimensions
from bearing_sim.simulation import positive_seconds
from bearing_sim.sweep.point import DURATION, RESULTS, results_of, run_until_settled
from bearing_sim.sweep.settling import Outcome
from bearing_sim.sweep.states import ROLLING, SKID, Others, other_states, skid_start, state_rows
from bearing_sim.sweep.tasks import Execution

if TYPE_CHECKING:
    import pandas

    from bearing_sim.model.names import Sample, SettledResults
    from bearing_sim.studies.uncertainty_propagation import Band
else:
    SettledResults = object

SAMPLES, SEED = 64, 2017  # of bands
NEARBY = "nearby"  # start at a neighbouring point
_OBSERVED = {each.name: each for each in OBSERVABLES}
_RESULTS = {each.name: each for each in RESULTS}


@dataclass(frozen=True, eq=False, repr=False)
class Settled(SettledResults):
    """The settled state of a bearing at an operating point.

    Results are attributes, in SI but for lives, which are in hours: ``cage_slip``, ``rating_life``, ``inner_load_maximum``, ``shaft_power`` and
    all others of a sweep's table; and every observable of a sample as its mean over the last window, an array for those of single rollers.
    Lives are averaged by their rates, because damage adds up.  `to_pandas` lists the results with their units and meanings.

    Attributes
    ----------
    scene : at the operating point and the level that were computed.
    outcome : how the run ended, with its ``slip`` and ``counters``; all that it has is also here.
    verdict : ``settled``; otherwise what the bearing did: ``drifting``, ``limit cycle``, ``wandering``, ``too short`` to tell, or
        ``no steady state`` at level steady.
    reason : the same in a sentence; empty where it has settled.
    settling_time : since when slip has been as at the end [s]; NaN where it has not settled.
    window : samples of the last fifth of the run, for `bearing_sim.to_xarray` and `bearing_sim.to_pandas`.
    bands : of ``cage_slip`` and ``modified_rating_life`` over the scene's uncertain fields, 5, 50 and 95 % quantiles with their sampling errors;
        empty unless asked for.
    start : from where the bearing came to this state: ``rolling``, ``skid`` or ``nearby``, a neighbouring point.
    """

    scene: Scene
    outcome: Outcome
    bands: "Mapping[str, Band]"
    start: Literal["rolling", "skid", "nearby"] = ROLLING

    @property
    def settled(self) -> bool:
        """Whether slip, temperature and life rest."""
        return self.outcome.settled

    @property
    def sample(self) -> "Sample":
        """The last sample, from which another run can begin (`bearing_sim.Simulation.reset`, `resume`)."""
        return self.outcome.window[-1]

    @cached_property
    def results(self) -> Mapping[str, float]:
        """The results of a sweep's table by name, in SI, lives in hours."""
        return MappingProxyType(results_of(self.outcome))

    @cached_property
    def others(self) -> Others:
        """The other states in which the bearing stays under the same conditions, the load below which a skid lasts, and the ring's resonance.

        They are looked for when they are first asked for, see `bearing_sim.sweep.states.other_states`.
        """
        return other_states(self.scene, self.outcome, self.start)

    @cached_property
    def warnings(self) -> tuple[Exceedance, ...]:
        """Laws that are used outside of their ranges, each with its worst value, what it moves, and its grade."""
        from bearing_sim.sweep.grading import graded  # here, because it takes long to import

        return tuple(graded(self.scene, outside(self.scene, self.outcome.window), self.outcome.window[-1]))

    if not TYPE_CHECKING:  # a checker knows the names from `SettledResults`

        def __getattr__(self, name: str):
            if name in Outcome._fields:
                return getattr(self.outcome, name)
            if name in _RESULTS:
                return self.results[name]
            if name in _OBSERVED:
                mean = self.outcome.window[name].mean(axis=0)
                return mean if _OBSERVED[name].per_roller else float(mean)
            raise AttributeError(f"no result {name!r}{did_you_mean(name, [*_RESULTS, *_OBSERVED])}; to_pandas() lists the results")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *Outcome._fields, *_RESULTS, *_OBSERVED})

    def __getstate__(self) -> dict:
        # Without what is computed on demand, whose mapping cannot be pickled.
        return {"scene": self.scene, "outcome": self.outcome, "bands": dict(self.bands), "start": self.start}

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the results as a table: value, unit, the ends of the band where there is one, and meaning, by the name of the result."""
        import pandas

        rows = []
        for name, value in self.results.items():
            column, band = _RESULTS[name], self.bands.get(name)
            low, high = (band.low, band.high) if band is not None else (math.nan, math.nan)
            rows.append((name, value, column.si_unit or "1", low, high, column.meaning))
        return pandas.DataFrame(rows, columns=["result", "value", "unit", "low", "high", "meaning"]).set_index("result")

    def __repr__(self) -> str:
        operating, last = self.scene.operating, self.outcome.window[-1]
        point = f"{number(RPM * operating.shaft_speed, 6)} rpm, {force(operating.radial_load)}"
        took = "from the start" if self.settling_time == 0.0 else f"after {self.settling_time:.3g} s"
        slip = "none, the shaft is at rest" if math.isnan(self.cage_slip) else f"{100.0 * self.cage_slip:.3g} %"
        lines = [
            f"{self.scene.name} at {point}, oil at {self.scene.lubricant.temperature - ZERO_CELSIUS:.4g} °C; level {self.scene.level}",
            f"  settled              {took if self.settled else f'no, {self.verdict}: {self.reason}'}",
            f"  cage slip            {slip}{self._band('cage_slip', 100.0, '%')}",
            f"  rating life          {hours(self.rating_life)}; modified {hours(self.modified_rating_life)}{self._band('modified_rating_life')}",
            f"  largest roller load  inner raceway {force(self.inner_load_maximum)}, outer raceway {force(self.outer_load_maximum)}",
            f"  running clearance    {number(1e6 * self.running_clearance)} µm",
            f"  power loss           {power(self.shaft_power)}",
        ]
        rows = state_rows(self.others, self.start) if math.isfinite(self.cage_slip) else []
        lines += [f"  {name:<20} {text}" for name, text in rows]
        if math.isfinite(last[RING_TEMPERATURES[0]]):
            inner, outer = (last[name] - ZERO_CELSIUS for name in RING_TEMPERATURES)
            lines.append(f"  ring temperatures    inner {inner:.4g} °C, outer {outer:.4g} °C")
        lines += [
            f"  beyond its range     {each.law.law} ({each.short}): {each.said_effect}, see warnings"
            for each in self.warnings
            if each.grade == Grade.WARNING
        ]
        return "\n".join(lines)

    def _band(self, name: str, factor: float = 1.0, unit: str = "h") -> str:
        band = self.bands.get(name)
        note = without_dimensions(one.field for one in ranges_of(self.scene)) if unit == "h" else ""
        return "" if band is None else f", 90 % of cases between {factor * band.low:.3g} and {factor * band.high:.3g} {unit}{note}"


def settle(
    scene: Scene | Mapping | str | Path,
    level: Level | None = None,
    *,
    shaft_speed: float | str | None = None,
    radial_load: float | str | None = None,
    load_angle: float | str | None = None,
    oil_temperature: float | str | None = None,
    start: Settled | Literal["rolling", "skid"] | None = None,
    longest: float | str | None = None,
    bands: bool = False,
    samples: int = SAMPLES,
    workers: int = 1,
) -> Settled:
    """Return what a bearing settles to under constant conditions.

    From ideal rolling it runs until slip, temperature and life rest (``doc/theory/settling.md``); with a thermal network it begins in thermal
    equilibrium.  At level ``steady`` a point takes milliseconds, because its periodic state is solved for.

    Parameters
    ----------
    scene : a scene, the name of a bundled one, the path of a YAML file, or what such a file holds.
    level : of fidelity; the scene's own where absent.
    shaft_speed, radial_load, load_angle, oil_temperature : of the operating point, numbers in SI or texts with a unit, such as ``"3000 rpm"``;
        the scene's own where absent.
    start : ``"skid"`` to begin with a cage that skids instead of in ideal rolling (``"rolling"``); or what the bearing settled to at a neighbouring
        point, at any level.  The run from there is as short as 15 cage turns, and the search for thermal equilibrium begins with those temperatures.
        Where there are several states, the result may be another one than from ideal rolling.
    longest : simulated time after which a bearing that does not settle is given up [s]; 1000 s, or 2000 cage turns, where absent.
    bands : whether to compute bands of slip and life over the ranges of the scene's uncertain fields (`bearing_sim.studies.uncertainty_propagation`).
    samples : size of each of the two samples of the bands, rounded up to a power of two.
    workers : processes that compute the bands.

    Returns
    -------
    settled : the state, also where the bearing does not settle: its ``verdict`` says what it does.

    Raises
    ------
    SceneError
        There is no such scene or level, or a value is no such quantity or out of bounds; it lists all errors.
    IntegrationError
        The run stopped early, or there is no thermal equilibrium.
    UncertaintyError
        With ``bands``: the scene has no uncertain fields, or a range excludes the scene's value.
    """
    found = scene if isinstance(scene, Scene) else load_scene(scene)
    found = found.at(shaft_speed=shaft_speed, radial_load=radial_load, load_angle=load_angle, oil_temperature=oil_temperature)
    if level is not None:
        found = found.at_level(level)
    if not isinstance(samples, int) or samples < 1:
        raise ValueError(f"samples = {samples!r}: expected a whole number of at least 1")
    at_most = None if longest is None else positive_seconds("longest", longest)
    shortest, sample = DURATION, None
    if isinstance(start, Settled):
        shortest, sample = 0.0 if found.operating.shaft_speed else DURATION, start.sample  # near its end 15 cage turns will do
    elif start == SKID:
        sample = skid_start(found)
    elif start not in (None, ROLLING):
        raise ValueError(f"start = {start!r}: expected 'rolling', 'skid', or what settle has returned for a neighbouring point")
    outcome = run_until_settled(found, shortest, at_most, sample)
    shown = start if isinstance(start, str) else (ROLLING if start is None else NEARBY)
    return Settled(found, outcome, _bands(found, samples, workers) if bands else MappingProxyType({}), shown)


def _bands(scene: Scene, samples: int, workers: int) -> "Mapping[str, Band]":
    """Return the bands of a scene by the names of its results."""
    from bearing_sim.studies.uncertainty_propagation import (
        rounded_up,
        study,
    )  # here, because importing SciPy's statistics takes longer than to settle

    found = study(scene, rounded_up(samples), SEED, shares=False, execution=Execution(workers=workers))
    return MappingProxyType({"cage_slip": found.bands["cage_slip"], "modified_rating_life": found.bands["life_hours"]})
