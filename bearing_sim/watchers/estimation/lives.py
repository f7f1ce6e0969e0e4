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

from bearing_sim.levels.slip.forces import pitch_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import pack
from bearing_sim.model.running_clearance import uniform
from bearing_sim.model.temperatures import given_temperatures
from bearing_sim.numerics.compilation import compiled_for, kernel
from bearing_sim.physics.growth import growth_at, total_growth
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
        self._knots = np.zeros((3, len(_KNOTS)))
        self.follows_slip = scene.heat.law != "network" and self._params.life.method != METHODS["iso281"]
        self.follows_oil = bool(self._params.life.modified)
        self._by_laminae = self._params.life.method == METHODS["iso16281"]
        self._follow_slip = self._follow_films = None  # code for this bearing's types, compiled now and not during a run
        one, somewhere = np.zeros(1), self._at((1.0, 0.0, 300.0, 0.0))
        if self.follows_slip:
            self._follow_slip = _compiled(_follow_slip, (one, one, *somewhere, self._knots))
        if self.follows_oil:
            if self._by_laminae:
                self._follow_films = _compiled(_follow_films, (one, one, 0.0, *somewhere, self._knots))
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
        slips = np.ascontiguousarray(slips, float)
        found = np.zeros_like(slips)
        if self.follows_slip:
            for condition, slip, change in zip(conditions.tolist(), slips, found):
                self._follow_slip(slip, change, *self._at(condition), self._knots)
        return found

    def rating_lives(self, condition: Sequence[float], slips: np.ndarray) -> np.ndarray:
        """Return the logarithms of the rating life in revolutions at an operating point and slips of the cage, shape (m,)."""
        found = np.empty(len(slips))
        _write_lives(np.asarray(slips, float), found, *self._at(condition))
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
            for condition, slip, films in zip(conditions.tolist(), slips.tolist(), found):
                self._follow_films(films, films, slip, *self._at(condition), self._knots)
            return found
        revolutions = np.exp(np.minimum(lives, _GREATEST_LIFE)) * np.abs(conditions[:, :1]) * (3600.0 / (2.0 * math.pi))
        _modification_factors(np.exp(ratios).ravel(), revolutions.ravel(), pitch_diameter, self._params.life, found.ravel())
        found = np.where(np.isnan(lives + ratios), math.nan, np.log(found))
        return found - found[:, :1]


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
def _follow_slip(slips, found, shaft_speed, load_y, load_z, solids, params, work, ring, knots):
    """Write by how much the logarithm of the rating life at slips differs from that at the first into ``found``; both of shape (k,).

    Parameters
    ----------
    knots : memory, shape (3, 5).
    others : as of `_write_lives`.
    """
    middle, half = _range(slips)
    for k in range(_KNOTS.shape[0]):
        knots[0, k] = middle + half * _KNOTS[k]
    if half > 0.0:
        _write_lives(knots[0], knots[1], shaft_speed, load_y, load_z, solids, params, work, ring)
    _write_changes(slips, middle, half, knots, found)


@kernel
def _follow_films(films, found, slip, shaft_speed, load_y, load_z, solids, params, work, ring, knots):
    """Write by how much the logarithm of the a_ISO of all laminae differs from that of the first of `_film_loads`; both of shape (k,).

    The loads are balanced once, at a slip of the cage, for they follow no film.  ``found`` may be the films; the other parameters are those of
    `_follow_slip`.
    """
    middle, half = _range(films)
    if half > 0.0:
        _take_place(shaft_speed, solids, params, work, ring)
        ideal = 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
        pitch_loads(0.0, ideal * (1.0 - slip), load_y, load_z, OilFactors(math.nan, math.nan), params, work)
        for k in range(_KNOTS.shape[0]):
            oil = OilFactors(LARGEST_VISCOSITY_RATIO, max(middle + half * _KNOTS[k], 0.0) ** 2.5)
            knots[1, k] = math.log(equivalent_loads(work.load_moments, oil, params.life).reference_modification_factor)
    _write_changes(films, middle, half, knots, found)


@kernel
def _range(values):
    """Return the middle and half the range of values; 0 for half where the range is that of rounding or a value is NaN."""
    low, high = math.inf, -math.inf
    for k in range(values.shape[0]):
        if math.isnan(values[k]):
            return 0.0, 0.0
        low, high = min(low, values[k]), max(high, values[k])
    half = 0.5 * (high - low)
    return 0.5 * (low + high), half if 2.0 * half > _NARROWEST else 0.0


@kernel
def _write_changes(values, middle, half, knots, found):
    """Write by how much a function of values differs from that of the first, by a polynomial of the fourth degree through five points.

    Parameters
    ----------
    values : shape (k,).
    middle, half : of their range, see `_range`.
    knots : in its second row the function at `_KNOTS`, where it is not finite nothing changes; its third takes the coefficients, shape (3, 5).
    found : result, shape (k,); may be the values.  NaN where a value is.
    """
    degree = _KNOTS.shape[0] - 1
    for power in range(degree + 1):
        knots[2, power] = 0.0
        for k in range(degree + 1):
            knots[2, power] += _INVERSE[power, k] * knots[1, k]
    if not half > 0.0 or not math.isfinite(knots[2, 0]):
        for k in range(values.shape[0]):
            found[k] = 0.0 * values[k]
        return
    first = 0.0
    for k in range(values.shape[0]):
        place, change = (values[k] - middle) / half, 0.0
        for power in range(degree, 0, -1):
            change = (change + knots[2, power]) * place
        if k == 0:
            first = change
        found[k] = change - first


@kernel
def _take_place(shaft_speed, solids, params, work, ring):
    """Let the rings of a bearing be where and as large as they are before its loads are balanced; parameters as of `_lives_at`."""
    work.growth[0] = total_growth(shaft_speed, growth_at(params.mounted, solids))
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
