# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How the lives of a bearing follow the slip of its cage and the viscosity of its oil, by the loads and the lives of level ``steady`` itself.

A cage that lags presses its rollers outwards by less, so that slip changes lives, upwards or downwards, and by so little at some operating points
that no fit to settled points shows it.  a_ISO has bends at viscosity ratios of 0.1, 0.4, 1 and 4, and ends at 0.1 and 50, which no polynomial
follows.  Both are cheap to compute: here is what they do to lives, and the response of a bearing (`bearing_sim.estimation.response`) is fitted to
what is left.
"""

import functools
import math
from collections.abc import Callable, Sequence

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model, inner_growth
from bearing_sim.levels.common.observation import oil_at_speed
from bearing_sim.levels.slip.forces import pitch_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import lubricate_scene
from bearing_sim.numerics.compilation import compiled_for, kernel
from bearing_sim.physics.rating_life import (
    LARGEST_VISCOSITY_RATIO,
    METHODS,
    OilFactors,
    contamination_factor,
    modification_factor,
    modified_by_oil,
    rate_lives,
)
from bearing_sim.scene.scene import Scene

_KNOTS = -np.cos(math.pi * np.arange(5) / 4.0)  # where lives are computed, over half the range (Chebyshev's)
_INVERSE = np.linalg.inv(np.vander(_KNOTS, increasing=True))  # coefficients of the polynomial through values at the knots
_NARROWEST = 1e-9  # range of slip or film that changes no life
_GREATEST_LIFE = 700.0  # logarithm of hours, beyond which a life counts as that
_TEMPERATURES = 512  # that lubrications are kept for
_LIMIT_RATIO, _EXPONENT = 1e-3, 9.185  # at which films are compared; a_ISO = 0.1 (1 - film e_C C_u/P^0.4)^-9.185


class SlipAndOil:
    """What slip and oil do to the lives of a scene's bearing.

    Dimensions are those of the scene itself.  Where a thermal network computes the temperatures slip changes these too, which only the settled
    points show: there lives do not follow slip here.

    Parameters
    ----------
    scene : of any level.
    """

    def __init__(self, scene: Scene):
        self._params = pack(scene)
        self._work = new_work(self._params)
        self._ring = self._work.ring.copy()  # from where the load balance starts, so that lives do not depend on what was asked before
        self.follows_slip = scene.heat.law != "network" and self._params.life.method != METHODS["iso281"]
        self.follows_oil = bool(self._params.life.modified)
        self._lubrication = functools.lru_cache(maxsize=_TEMPERATURES)(lambda kelvin: lubricate_scene(scene, self._params, kelvin))
        self._by_laminae = self._params.life.method == METHODS["iso16281"]
        self._loads = self._rated = None  # code of the loads and lives at a slip, from its first call on
        if self.follows_oil:  # compiled now, and not during a run
            (_film_loads if self._by_laminae else _modification_factors)(np.zeros(1), np.zeros(1), 0.05, self._params.life, np.zeros(1))

    def by_slip(self, conditions: np.ndarray, slips: np.ndarray) -> np.ndarray:
        """Return by how much the logarithm of the rating life at slips differs from that at the first of them.

        It is a polynomial of the fourth degree through the level's lives at five slips.  Rings grow as they do at whole kelvins.

        Parameters
        ----------
        conditions : operating points, columns as `bearing_sim.estimation.response.CONDITIONS`, shape (n, 4).
        slips : shape (n, m).

        Returns
        -------
        shape (n, m); NaN where a slip is.
        """
        if not self.follows_slip:
            return np.zeros_like(slips)
        there = zip(conditions.tolist(), slips)
        return np.stack([_differences(slip, functools.partial(self.rating_lives, condition)) for condition, slip in there])

    def rating_lives(self, condition: Sequence[float], slips: Sequence[float]) -> np.ndarray:
        """Return the logarithms of the rating life in revolutions at an operating point and slips of the cage, shape (m,)."""
        arguments, ideal = self._arguments_at(condition)
        load, (load_y, load_z, oil, params, work) = condition[1], arguments
        rated = self._rated
        lives = [rated(load, self._loads(0.0, ideal * (1.0 - slip), load_y, load_z, oil, params, work), oil, params.life).basic for slip in slips]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log(lives)

    def _arguments_at(self, condition: Sequence[float]) -> tuple[tuple, float]:
        """Return the arguments of `bearing_sim.levels.slip.forces.pitch_loads` at an operating point from the loads on, and the ideal cage speed."""
        speed, load, kelvin, angle = condition
        load_y, load_z, params, work = load * math.cos(angle), load * math.sin(angle), self._params, self._work
        model = Model(params, self._lubrication(float(round(kelvin))), Drive(0.0, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0), DEFAULT_TOLERANCES)
        work.growth[0], work.ring[:] = inner_growth(speed, model), self._ring
        oil = oil_at_speed(speed, model)
        ideal = 0.5 * speed * (1.0 - params.raceways.diameter_ratio)
        if self._loads is None:
            equivalent = pitch_loads(0.0, ideal, load_y, load_z, oil, params, work)
            rate_lives(load, equivalent, oil, params.life)
            self._loads = compiled_for(pitch_loads, (0.0, ideal, load_y, load_z, oil, params, work))
            self._rated = compiled_for(rate_lives, (load, equivalent, oil, params.life))
        return (load_y, load_z, oil, params, work), ideal

    def by_oil(self, conditions: np.ndarray, slips: np.ndarray, lives: np.ndarray, ratios: np.ndarray) -> np.ndarray:
        """Return by how much the logarithm of a_ISO differs from the first one, for viscosity ratios and the loads that rating lives stand for.

        Parameters
        ----------
        conditions : as of `by_slip`.
        slips : of the cage where viscosity ratio and life are the first ones, shape (n,).
        lives : logarithms of rating lives [h], shape (n, m).
        ratios : logarithms of kappa, shape (n, m).

        Returns
        -------
        shape (n, m); NaN where one of them is.
        """
        if not self.follows_oil:
            return np.zeros_like(lives)
        pitch_diameter = 2.0 * self._params.raceways.pitch_radius
        found = np.empty_like(lives)
        if self._by_laminae:
            bounded = np.minimum(lives, _GREATEST_LIFE)
            heavier = bounded[:, :1] - bounded
            _film_loads(np.exp(ratios).ravel(), heavier.ravel(), pitch_diameter, self._params.life, found.ravel())
            there = zip(conditions.tolist(), slips.tolist(), found)
            return np.stack([_differences(films, functools.partial(self._lamina_factors, *at)) for *at, films in there])
        revolutions = np.exp(np.minimum(lives, _GREATEST_LIFE)) * np.abs(conditions[:, :1]) * (3600.0 / (2.0 * math.pi))
        _modification_factors(np.exp(ratios).ravel(), revolutions.ravel(), pitch_diameter, self._params.life, found.ravel())
        found = np.where(np.isnan(lives + ratios), math.nan, np.log(found))
        return found - found[:, :1]

    def _lamina_factors(self, condition: Sequence[float], slip: float, films: Sequence[float]) -> np.ndarray:
        """Return the logarithms of a_ISO of all laminae at an operating point, a slip of the cage and values of `_film_loads`, shape (m,)."""
        (load_y, load_z, _, params, work), ideal = self._arguments_at(condition)
        cage, oils = ideal * (1.0 - slip), [OilFactors(LARGEST_VISCOSITY_RATIO, max(film, 0.0) ** 2.5) for film in films]
        factors = [self._loads(0.0, cage, load_y, load_z, oil, params, work).reference_modification_factor for oil in oils]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log(factors)


def _differences(values: np.ndarray, function: Callable[[list[float]], np.ndarray]) -> np.ndarray:
    """Return by how much a function of values differs from that of the first, by a polynomial of the fourth degree through five points.

    Parameters
    ----------
    values : shape (m,).
    function : of a list of values.

    Returns
    -------
    shape (m,); NaN where a value is, 0 where the range of the values is that of rounding or the function is not finite.
    """
    low, high = float(values.min()), float(values.max())
    if not high - low > _NARROWEST:
        return 0.0 * values
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    known = function((middle + half * _KNOTS).tolist())
    change = np.zeros_like(values)
    if np.isfinite(known).all():
        place = (values - middle) / half
        for coefficient in (_INVERSE @ known)[:0:-1]:
            change += coefficient
            change *= place
        change -= change[0]
    return change


@kernel
def _modification_factors(ratios, revolutions, pitch_diameter, life, found):
    """Write a_ISO for viscosity ratios and rating lives into ``found``; all of shape (k,).

    Parameters
    ----------
    ratios : kappa.
    revolutions : rating lives, which stand for loads (`bearing_sim.physics.rating_life.modified_by_oil`).
    pitch_diameter : [m].
    life : `bearing_sim.model.params.Life`.
    found : result.
    """
    for k in range(ratios.shape[0]):
        cleanliness = contamination_factor(ratios[k], life.cleanliness_slope, life.cleanliness_loss, pitch_diameter)
        found[k] = modified_by_oil(revolutions[k], OilFactors(ratios[k], cleanliness), life)


@kernel
def _film_loads(ratios, heavier, pitch_diameter, life, found):
    """Write what a_ISO of laminae follows: (e_C/F)^0.4 with F a factor of their loads, with e_C for which kappa = 4 would give the same a_ISO.

    a_ISO follows a product of a function of kappa and (e_C C_u/P)^0.4 alone (`bearing_sim.physics.rating_life.modification_factor`); all of shape
    (k,).

    Parameters
    ----------
    ratios : kappa.
    heavier : logarithms of the first life over each: F is its 0.3th power, as P = C L^(-3/10).
    pitch_diameter : [m].
    life : `bearing_sim.model.params.Life`.
    found : result.
    """
    thickest = 1.0 - (10.0 * modification_factor(LARGEST_VISCOSITY_RATIO, _LIMIT_RATIO)) ** (-1.0 / _EXPONENT)
    for k in range(ratios.shape[0]):
        cleanliness = contamination_factor(ratios[k], life.cleanliness_slope, life.cleanliness_loss, pitch_diameter)
        film = 1.0 - (10.0 * modification_factor(ratios[k], _LIMIT_RATIO)) ** (-1.0 / _EXPONENT)
        found[k] = film / thickest * (cleanliness * math.exp(-0.3 * heavier[k])) ** 0.4 + 0.0 * (ratios[k] + heavier[k])
