# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Estimation of a scene: bands on what is published, and which fields measurements calibrate while the model runs.

Both start from the ranges of the scene's fields (`bearing_sim.scene.uncertainty.ranges_of`).  A scene that asks for neither pays nothing.
"""

from collections.abc import Iterator
from dataclasses import field
from typing import Annotated

from pydantic import BeforeValidator

from bearing_sim.scene.quantity import Quantity, check, record
from bearing_sim.scene.uncertainty import nearest, ranges_of

_LONGEST = 1e10  # s


def _paths(value: object) -> object:
    """Return the list of paths that was given by one path alone; anything else as it is."""
    return (value,) if isinstance(value, str) else value


@record
class Drift:
    """How calibrated fields change in service: slowly, as random walks, and now and then suddenly.

    The times are assumptions: oil ages and rings wear over hundreds of hours of service.
    """

    wander_time: Annotated[
        float, Quantity("s", "time in which a calibrated field wanders by one standard deviation of its range", 60.0, _LONGEST, "h")
    ] = 3.6e6
    step_time: Annotated[
        float, Quantity("s", "mean time between sudden changes, after which a field may lie anywhere in its range", 60.0, _LONGEST, "h")
    ] = 3.6e5


@record
class MeasurementNoise:
    """What single readings are off by: standard deviations, and the fraction of readings that say nothing.

    A reading that brings its own standard error, such as a cage speed out of vibration, counts by that instead.
    """

    cage_speed: Annotated[
        float, Quantity("", "noise of a measured cage speed over the ideal cage's speed: of a reading of slip (assumption)", 1e-6, 1.0, "%")
    ] = 0.002
    temperature: Annotated[
        float, Quantity("delta_degC", "noise of a measured ring temperature (assumption; as heat.filter.sensor)", 1e-3, 100.0, "K")
    ] = 0.5
    clearance: Annotated[float, Quantity("m", "noise of a measured running clearance (assumption)", 1e-8, 1e-3, "um")] = 2e-6
    outliers: Annotated[float, Quantity("", "fraction of wild readings (assumption)", 0.0, 0.5, "%")] = 0.01


@record
class ModelError:
    """What the model errs by where all its fields are right: standard deviations, of errors that last."""

    slip: Annotated[float, Quantity("", "error in cage slip (assumption; as thresholds.residual.tolerance)", 0.0, 1.0, "%")] = 0.002
    temperature: Annotated[
        float, Quantity("delta_degC", "error in a ring temperature (assumption; as thresholds.temperature_residual.tolerance)", 0.0, 100.0, "K")
    ] = 1.0
    clearance: Annotated[float, Quantity("m", "error in the running clearance (assumption)", 0.0, 1e-3, "um")] = 1e-6


@record
class Estimation:
    """What is said about how sure the predictions are, and what measurements change in them.

    `bands` publishes cage slip, rating life, running clearance and remaining life with the 5 and 95 % quantiles that the ranges of the scene's
    fields lead to.  `calibrated` names fields whose values a recursive Bayesian estimator learns from measurements; the others keep their
    ranges.
    """

    bands: bool = False  # whether cage slip, rating life, running clearance and remaining life get a 5 to 95 % band
    rate: Annotated[float, Quantity("Hz", "most bands in a simulated second", 1e-4, 1000.0)] = 50.0
    # Fields that measurements calibrate, by dotted path, each with a range; none: no calibration.
    calibrated: Annotated[tuple[str, ...], BeforeValidator(_paths)] = ()
    interval: Annotated[float, Quantity("s", "least time between two updates by measurements; readings in between are averaged", 0.01, 3600.0)] = 1.0
    drift: Drift = field(default_factory=Drift)
    noise: MeasurementNoise = field(default_factory=MeasurementNoise)
    model_error: ModelError = field(default_factory=ModelError)

    @property
    def is_asked(self) -> bool:
        """Whether the scene asks for bands or for a calibration."""
        return self.bands or bool(self.calibrated)

    @check
    def _each_field_is_named_once(self) -> list[str]:
        twice = sorted({path for path in self.calibrated if self.calibrated.count(path) > 1})
        return [f"calibrated: {path} is named twice" for path in twice]


def estimation_errors(scene) -> list[str]:
    """Return error messages for bands without any range, and for calibrated fields without one."""
    return list(_estimation_errors(scene)) if scene.estimation.is_asked else []


def _estimation_errors(scene) -> Iterator[str]:
    ranged = [one.field for one in ranges_of(scene)]
    if not ranged:
        yield (
            "estimation: no field of this scene has a range, so that there is nothing to be uncertain about; give some in the block uncertainty, "
            "such as lubricant.mixture_fraction: [0.015, 0.05]"
        )
        return
    for path in scene.estimation.calibrated:
        if path not in ranged:
            yield (
                f"estimation.calibrated: {path} has no range in this scene{nearest(path, ranged)}; give one as uncertainty.{path}: [low, high], or "
                f"name one of {', '.join(ranged)}"
            )
