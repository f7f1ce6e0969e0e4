# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What level ``planar`` adds to the operating points of level ``steady``: a correction of their table, measured at some hundred points.

Rollers with play press on their pockets several times harder than rollers that are locked to them, the cage rubs on its land off its centre, and
passing rollers shake the inner ring.  Level ``planar`` computes all that; its settled means cost a tenth of a second of a core a point.  Here the
difference to level ``steady`` is a spline over the operating points, as smooth as the points that are left out of it ask for:

    s(S') = s(S) + c_S,    P'_n = P_n exp(c_n),    W'_k = W_k + c_k W_shaft,    tau' = tau exp(c_tau),    a'_m = a_m + c_m a,

S slip, s the scale of `bearing_sim.watchers.estimation.response.slip_scale`, P_n the equivalent loads of both rings, whole and by laminae, and the
factor that oil gives to life, W_k powers by cause, W_shaft that of the shaft, tau the cage's lag, a_m its accelerations, a their root mean square.
No c exceeds what was found at any of the points.
Such corrections of a fast model by a few runs of an accurate one are known as multi-fidelity models (M. C. Kennedy and A. O'Hagan, Biometrika 87
(2000) 1).

The errors of the correction are those at points left out of it.  Where ``planar`` settles in one state from ideal rolling and in another from more
slip, the correction is that of the state from ideal rolling, and the point is kept among `Correction.two_states`.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.kept import Damaged, packed, read_kept, unpacked, write_kept
from bearing_sim.files.limits import RESPONSE_FILE
from bearing_sim.levels.steady.operating_point import ACCELERATIONS, ANSWER
from bearing_sim.levels.steady.table_builder import CORRECTION_VERSION, FOLDER
from bearing_sim.model.validity import BY_NAME
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.scene.heat import NoHeat
from bearing_sim.scene.scene import Scene
from bearing_sim.watchers.estimation.response import CONDITIONS, Domain, coordinates, digest_of, domain_of, restored_slip, slip_scale
from bearing_sim.watchers.estimation.splines import left_out, metric_of, metric_starts, searched, spline_functions, spline_weights

LIFE_EXPONENT = 4.0
"""A life falls with this power of the equivalent loads: 4.5 times 8/9 (`bearing_sim.physics.rating_life.rating_life_revolutions`)."""
STATES_APART = 0.01 * BY_NAME["table_states"].high
"""Slips of two states differ by more."""
_SLOWEST = 0.1  # of the largest speed; slower points are corrected as these
_FACTORS = slice(ANSWER.inner_equivalent_load, ANSWER.outer_load_maximum + 1)
_POWERS = slice(ANSWER.shaft_power, len(ANSWER))
_LEAST_POWER = 1e-9  # W; of a shaft that puts in less no share is taken
_SCALES = (1.0, 2.0), (0.5, 1.0), (0.35, 0.7)  # of speed, load and temperature, from the best of which a search starts
_SMOOTHING = (0.0, 1e-3, 1e-2, 1e-1)  # that are tried
_LARGEST_SLIP_ERROR, _LARGEST_LIFE_ERROR = 0.01, 0.1  # larger ones are of jumps from one state to another, which no spline follows
_NEIGHBOURS = 8  # points whose errors tell that between them
_LOADS = list(range(len(ANSWER))[_FACTORS])
_COLUMNS = ([column for column in range(len(ANSWER)) if column not in _LOADS], _LOADS)  # what goes with slip, and with loads


class Correction(NamedTuple):
    """A correction of the table of one bearing; see the module.

    Attributes
    ----------
    domain : operating points that it is for; slower and lighter ones are corrected as the slowest and lightest.
    conditions : operating points that were measured, columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (k, 4).
    metrics : by which coordinates are multiplied before distances count, for slip and powers, and for loads; shape (2, c, c).
    weights : of `bearing_sim.watchers.estimation.splines.spline_functions`, columns `ANSWER`, shape (k + c + 1, len(ANSWER)).
    changes : what was found at the points, columns `ANSWER` on the scales of the module, shape (k, len(ANSWER)).
    errors : at each point where it is left out: of slip [1] and of life, relative; shape (k, 2).
    two_states : conditions at which level ``planar`` has two states, and the slip of each, from ideal rolling first; shape (m, 6).
    failed : points that have no answer at one of the levels.
    seconds : that the points took.
    """

    domain: Domain
    conditions: np.ndarray
    metrics: np.ndarray
    weights: np.ndarray
    changes: np.ndarray
    errors: np.ndarray
    two_states: np.ndarray
    failed: int
    seconds: float

    @property
    def slip_error(self) -> float:
        """Root mean square of the error of slip at points left out [1]; of those with two states none counts."""
        return self._error_of_one_state(0)

    @property
    def life_error(self) -> float:
        """Root mean square of the relative error of life at points left out, likewise."""
        return self._error_of_one_state(1)

    def _error_of_one_state(self, column):
        jumping = (self.conditions[:, None] == self.two_states[:, : len(CONDITIONS)]).all(axis=2).any(axis=1)
        kept = self.errors[~jumping, column]
        return float(np.sqrt(np.mean(np.square(kept)))) if len(kept) else math.inf

    def applied(self, conditions: np.ndarray, answers: np.ndarray) -> np.ndarray:
        """Return corrected answers of level ``steady``.

        Parameters
        ----------
        conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, further ones count for nothing, shape (n, 4 or more).
        answers : columns `bearing_sim.levels.steady.operating_point.ANSWER`, shape (n, len(ANSWER)).

        Returns
        -------
        answers of the same shape; NaN stays NaN.
        """
        return changed(answers, self._changes_at(np.asarray(conditions, float)[:, : len(CONDITIONS)]))

    def errors_near(self, conditions: np.ndarray) -> np.ndarray:
        """Return the root mean square of the errors of the nearest points [1, 1], of slip and of life; shape (n, 2)."""
        distances = np.square(self.places(conditions)[:, None] - self.places(self.conditions)).sum(axis=-1)
        near = np.argsort(distances, axis=1)[:, :_NEIGHBOURS]
        return np.sqrt(np.mean(np.square(self.errors[near]), axis=1))

    def places(self, conditions: np.ndarray) -> np.ndarray:
        """Return operating points as places between which distances count, shape (n, c).

        Parameters
        ----------
        conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).
        """
        return coordinates(conditions, self.domain) @ self.metrics[0]

    def _changes_at(self, conditions):
        there, centres = (coordinates(each, self.domain) for each in (conditions, self.conditions))
        found = np.empty((len(conditions), len(ANSWER)))
        for metric, columns in zip(self.metrics, _COLUMNS):
            found[:, columns] = spline_functions(there @ metric, centres @ metric) @ self.weights[:, columns]
        return np.clip(found, self.changes.min(axis=0), self.changes.max(axis=0))


def changed(answers: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Return answers changed by what a correction adds, on its scales; columns `ANSWER`, shapes (n, len(ANSWER))."""
    found = answers.copy()
    found[:, ANSWER.cage_slip] = restored_slip(slip_scale(answers[:, ANSWER.cage_slip]) + changes[:, ANSWER.cage_slip])
    found[:, ANSWER.lag] *= np.exp(changes[:, ANSWER.lag])
    found[:, ACCELERATIONS] += changes[:, ACCELERATIONS] * _usual_acceleration(answers)
    found[:, _FACTORS] *= np.exp(changes[:, _FACTORS])
    found[:, _POWERS] += changes[:, _POWERS] * answers[:, [ANSWER.shaft_power]]
    return found


def changes_between(answers: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return what makes answers of level ``steady`` those of another level, the inverse of `changed`; columns `ANSWER`, shapes (n, len(ANSWER))."""
    found = np.zeros_like(answers)
    found[:, ANSWER.cage_slip] = slip_scale(others[:, ANSWER.cage_slip]) - slip_scale(answers[:, ANSWER.cage_slip])
    with np.errstate(divide="ignore", invalid="ignore"):
        # what is not known, such as the lag of a stopped cage, does not change
        found[:, ANSWER.lag] = np.nan_to_num(np.log(others[:, ANSWER.lag] / answers[:, ANSWER.lag]), posinf=0.0, neginf=0.0)
        found[:, ACCELERATIONS] = np.nan_to_num((others - answers)[:, ACCELERATIONS] / _usual_acceleration(answers), posinf=0.0, neginf=0.0)
        found[:, _FACTORS] = np.log(others[:, _FACTORS] / answers[:, _FACTORS])
        shaft = answers[:, [ANSWER.shaft_power]]
        found[:, _POWERS] = np.where(np.abs(shaft) > _LEAST_POWER, (others - answers)[:, _POWERS] / shaft, 0.0)
    return np.where(answers == others, 0.0, found)  # no load at both: no change


def _usual_acceleration(answers):
    """Return the root mean square of each answer's accelerations that are known, shape (n, 1)."""
    squares = np.square(answers[:, ACCELERATIONS])
    return np.sqrt(np.nansum(squares, axis=1, keepdims=True) / np.maximum(np.isfinite(squares).sum(axis=1, keepdims=True), 1))


def fit_correction(domain: Domain, conditions: np.ndarray, answers: np.ndarray, others: np.ndarray, seconds: float = 0.0) -> Correction:
    """Return the correction that takes answers of level ``steady`` to those of level ``planar``.

    Parameters
    ----------
    domain : of the scene.
    conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (k, 4).
    answers, others : of level ``steady``, and of ``planar`` from ideal rolling; columns `ANSWER`, shape (k, len(ANSWER)); points where one of them
        has no answer are left out.
    seconds : that the points took.

    Raises
    ------
    ValueError
        Too few points have answers.
    """
    changes = changes_between(answers, others)
    kept = np.isfinite(changes).all(axis=1)
    there = coordinates(conditions[kept], domain)
    least = 4 * (there.shape[1] + 1)
    if len(there) < least:
        raise ValueError(f"{len(there)} of {len(conditions)} operating points have answers at both levels; expected {least} or more")
    changes, slips = changes[kept], others[kept, ANSWER.cage_slip]
    metrics, errors, weights = [], [], np.empty((len(there) + there.shape[1] + 1, len(ANSWER)))
    for columns, column, largest in zip(_COLUMNS, (ANSWER.cage_slip, ANSWER.inner_lamina_load), (_LARGEST_SLIP_ERROR, _LARGEST_LIFE_ERROR)):
        values = changes[:, [column]]
        to_error = _slip_errors(slips) if column == ANSWER.cage_slip else _life_errors
        metric, smoothing = _best_spline(there, domain, values, to_error, largest)
        metrics.append(metric)
        errors.append(to_error(left_out(there @ metric, values, smoothing)[:, 0]))
        weights[:, columns] = spline_weights(there @ metric, changes[:, columns], smoothing)
    nothing = np.zeros((0, len(CONDITIONS) + 2))
    failed = int(np.count_nonzero(~kept))
    return Correction(domain, conditions[kept], np.array(metrics), weights, changes, np.stack(errors, axis=1), nothing, failed, seconds)


def _slip_errors(slips):
    """Return the function from errors on the scale of slip to errors of slip at slips."""
    return lambda errors: restored_slip(slip_scale(slips) + errors) - slips


def _life_errors(errors):
    return np.expm1(LIFE_EXPONENT * np.abs(np.clip(errors, -2.0, 2.0)))


def _best_spline(there, domain, values, to_error, largest):
    """Return metric and smoothing whose spline misses the points that are left out least; errors above ``largest`` count alike."""
    starts = metric_starts(_SCALES[: 2 + domain.varies_in_temperature])

    def missed(parameters, smoothing):
        errors = to_error(left_out(there @ metric_of(parameters, there.shape[1]), values, smoothing)[:, 0])
        return float(np.minimum(np.abs(errors), largest).mean()) if np.isfinite(errors).all() else math.inf

    scored = [(missed(start, smoothing), k, smoothing) for k, start in enumerate(starts) for smoothing in _SMOOTHING]
    _, best, smoothing = min(scored)
    found = searched(starts[best], lambda parameters: missed(parameters, smoothing))
    return metric_of(found, there.shape[1]), smoothing


def correction_domain(scene: Scene, temperatures: tuple[float, float] | None = None) -> Domain:
    """Return the operating points over which a correction is measured: those of the response but for slow ones, which hardly differ and take long.

    Parameters
    ----------
    scene : of any level.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    """
    domain = domain_of(scene, temperatures)
    return domain._replace(speeds=(_SLOWEST * domain.speeds[1], domain.speeds[1]))


def correction_digest(scene: Scene, domain: Domain) -> str:
    """Return a hash of what a correction depends on: bearing, mounting, support, oil and life of the scene, operating points, this program."""
    return digest_of(
        sources_hash(), scene.bearing, scene.mounting, scene.support, scene.lubricant, scene.life, scene.dynamics, domain, CORRECTION_VERSION
    )


def correction_path(scene: Scene, domain: Domain) -> Path:
    """Return where the correction of a scene is kept: among the tables of operating points."""
    return FOLDER / f"{correction_digest(scene, domain)}.correction.npz"


def measured_scene(scene: Scene, level: str) -> Scene:
    """Return the scene whose points are measured at a level: without a law of heat, whose effect on the clearance the table knows by itself."""
    return replace(scene.at_level(level), heat=NoHeat())


_ARRAYS = ("conditions", "metrics", "weights", "changes", "errors", "two_states")


def write_correction(path: Path, correction: Correction) -> None:
    """Write a correction: a reader finds the old file or the new one, never a part.  Raises OSError, also if another process is writing it."""
    domain = correction.domain
    ends = np.array([*domain.speeds, *domain.loads, *domain.temperatures, domain.period, domain.mirror])
    arrays = {name: getattr(correction, name) for name in _ARRAYS} | {"domain": ends, "made": np.array([correction.failed, correction.seconds])}
    write_kept(path, packed(arrays))


def read_correction(path: Path) -> Correction | None:
    """Return a correction from disk, or None where there is none, or none that is whole."""
    return read_kept(path, RESPONSE_FILE, _correction)


def _correction(data: bytes) -> Correction:
    file = unpacked(data, RESPONSE_FILE)
    ends = file["domain"].tolist()
    domain = Domain((ends[0], ends[1]), (ends[2], ends[3]), (ends[4], ends[5]), ends[6], ends[7])
    failed, seconds = file["made"].tolist()
    conditions, metrics, weights, changes, errors, two_states = (np.ascontiguousarray(file[name], float) for name in _ARRAYS)
    shapes = changes.shape == (len(conditions), len(ANSWER)), errors.shape == (len(conditions), 2)
    whole = all(shapes) and metrics.shape[0] == 2 and weights.shape[1] == len(ANSWER)
    if not whole or not all(np.isfinite(each).all() for each in (conditions, metrics, weights, changes)):
        raise Damaged("its arrays do not fit together")
    return Correction(domain, conditions, metrics, weights, changes, errors, two_states, int(failed), seconds)
