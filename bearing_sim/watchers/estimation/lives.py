# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How the lives of a bearing follow the slip of its cage and the viscosity of its oil, by the loads and the lives of level ``steady`` itself.

A cage that lags presses its rollers outwards by less, so that slip changes lives, upwards or downwards, and by so little at some operating points
that no fit to settled points shows it.  a_ISO has bends at viscosity ratios of 0.1, 0.4, 1 and 4, and ends at 0.1 and 50, which no polynomial
follows.  Both are cheap to compute: here is what they do to lives, and the response of a bearing (`bearing_sim.watchers.estimation.response`) is
fitted to what is left.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.polynomial import polyval

from bearing_sim.levels.common.model import write_growth
from bearing_sim.levels.slip.forces import pitch_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import pack
from bearing_sim.model.running_clearance import uniform
from bearing_sim.model.temperatures import given_temperatures
from bearing_sim.numerics.compilation import compiled_for, kernel
from bearing_sim.physics.growth import growth_at
from bearing_sim.physics.lamina_life import equivalent_loads
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
        self._params, self._heat = pack(scene), scene.heat
        work = new_work(self._params)
        self._bearing = self._params, work, work.ring.copy()
        self.follows_slip = scene.heat.law != "network" and self._params.life.method != METHODS["iso281"]
        self.follows_oil = bool(self._params.life.modified)
        self._by_laminae = self._params.life.method == METHODS["iso16281"]
        knots, somewhere = np.zeros(len(_KNOTS)), self._at((1.0, 0.0, 300.0, 0.0))  # code for this bearing's types, compiled now and not during a run
        self._write_lives = _compiled(_write_lives, (knots, knots.copy(), *somewhere)) if self.follows_slip else _write_lives
        if self.follows_oil:
            if self._by_laminae:
                self._write_factors = _compiled(_write_factors, (knots, knots.copy(), 0.0, *somewhere))
            (_film_loads if self._by_laminae else _modification_factors)(np.zeros(1), np.zeros(1), 0.05, self._params.life, np.zeros(1))

    def by_slip(self, conditions: np.ndarray, slips: np.ndarray) -> np.ndarray:
        """Return by how much the logarithm of the rating life at slips differs from that at the first of them.

        It is a polynomial of the fourth degree through the level's lives at five slips.

        Parameters
        ----------
        conditions : operating points, columns as `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).
        slips : shape (n, m).

        Returns
        -------
        shape (n, m); NaN where a slip is.
        """
        slips = np.asarray(slips, float)
        if not self.follows_slip:
            return np.zeros_like(slips)
        return _changes(slips, lambda row, knots: self.rating_lives(conditions[row].tolist(), knots))

    def rating_lives(self, condition: Sequence[float], slips: np.ndarray) -> np.ndarray:
        """Return the logarithms of the rating life in revolutions at an operating point and slips of the cage, shape (m,)."""
        found = np.empty(len(slips))
        self._write_lives(np.asarray(slips, float), found, *self._at(condition))
        return found

    def _at(self, condition: Sequence[float]) -> tuple:
        """Return the last arguments of `_write_lives` for an operating point."""
        speed, load, kelvin, angle = condition
        solids = given_temperatures(self._heat, kelvin) if self._heat.law == "given" else uniform(kelvin)
        return speed, load * math.cos(angle), load * math.sin(angle), solids, *self._bearing

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
            return np.zeros(lives.shape)
        pitch_diameter = 2.0 * self._params.raceways.pitch_radius
        found = np.empty(lives.shape)
        if self._by_laminae:
            bounded = np.minimum(lives, _GREATEST_LIFE)
            heavier = bounded[:, :1] - bounded
            _film_loads(np.exp(ratios).ravel(), heavier.ravel(), pitch_diameter, self._params.life, found.ravel())

            def factors(row: int, films: np.ndarray) -> np.ndarray:
                written = np.empty(len(films))
                self._write_factors(films, written, float(slips[row]), *self._at(conditions[row].tolist()))
                return written

            return _changes(found, factors)
        revolutions = np.exp(np.minimum(lives, _GREATEST_LIFE)) * np.abs(conditions[:, :1]) * (3600.0 / (2.0 * math.pi))
        _modification_factors(np.exp(ratios).ravel(), revolutions.ravel(), pitch_diameter, self._params.life, found.ravel())
        found = np.where(np.isnan(lives + ratios), math.nan, np.log(found))
        return found - found[:, :1]


def _changes(values: np.ndarray, function: Callable[[int, np.ndarray], np.ndarray]) -> np.ndarray:
    """Return by how much a function of values differs from that of the first in each row, by a polynomial of the fourth degree through five points.

    Parameters
    ----------
    values : shape (n, m).
    function : ``function(row, knots)`` returns the function at knots in the range of a row; where it is not finite nothing changes.

    Returns
    -------
    shape (n, m); NaN where a value is, and 0 elsewhere in such a row.
    """
    found, low, high = 0.0 * values, values.min(axis=1), values.max(axis=1)
    for row in np.flatnonzero(high - low > _NARROWEST):
        middle, half = 0.5 * (low[row] + high[row]), 0.5 * (high[row] - low[row])
        coefficients = _INVERSE @ function(row, middle + half * _KNOTS)
        if np.isfinite(coefficients[0]):
            course = polyval((values[row] - middle) / half, [0.0, *coefficients[1:]])
            found[row] = course - course[0]
    return found


def _compiled(function: Callable, arguments: tuple) -> Callable:
    """Return `compiled_for` of a function and arguments, with which it is called once."""
    function(*arguments)
    return compiled_for(function, arguments)


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
def _write_lives(slips, found, shaft_speed, load_y, load_z, solids, params, work, ring):
    """Write the logarithms of rating lives in revolutions at slips of the cage into ``found``; both of shape (k,).

    Parameters
    ----------
    slips : of the cage.
    found : result.
    shaft_speed : [rad/s].
    load_y, load_z : [N].
    solids : `bearing_sim.physics.growth.Temperatures`.
    params : `bearing_sim.model.params.Params`.
    work : of level ``slip``.
    ring : where the load balance starts, so that lives do not depend on what was asked before [m], shape (2,).
    """
    _take_place(shaft_speed, solids, params, work, ring)
    load, ideal, no_oil = math.hypot(load_y, load_z), 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio), OilFactors(math.nan, math.nan)
    for k in range(slips.shape[0]):
        equivalent = pitch_loads(0.0, ideal * (1.0 - slips[k]), load_y, load_z, no_oil, params, work)
        found[k] = math.log(rate_lives(load, equivalent, no_oil, params.life).basic)


@kernel
def _write_factors(films, found, slip, shaft_speed, load_y, load_z, solids, params, work, ring):
    """Write the logarithm of the a_ISO of all laminae at films of `_film_loads` into ``found``; both of shape (k,).

    The loads are balanced once, at a slip of the cage, for they follow no film; the other parameters are those of `_write_lives`.
    """
    _take_place(shaft_speed, solids, params, work, ring)
    ideal = 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
    pitch_loads(0.0, ideal * (1.0 - slip), load_y, load_z, OilFactors(math.nan, math.nan), params, work)
    for k in range(films.shape[0]):
        oil = OilFactors(LARGEST_VISCOSITY_RATIO, max(films[k], 0.0) ** 2.5)
        found[k] = math.log(equivalent_loads(work.load_moments, oil, params.life).reference_modification_factor)


@kernel
def _take_place(shaft_speed, solids, params, work, ring):
    """Let the rings of a bearing be where and as large as they are before its loads are balanced; parameters as of `_write_lives`."""
    write_growth(shaft_speed, growth_at(params.mounted, solids), work.growth)
    work.ring[0], work.ring[1] = ring[0], ring[1]


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
