# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How the lives of a bearing follow the slip of its cage and the viscosity of its oil, by the loads and the lives of level ``steady`` itself.

A cage that lags presses its rollers outwards by less, so that slip changes lives, upwards or downwards, and by so little at some operating points
that no fit to settled points shows it.  a_ISO has bends at viscosity ratios of 0.1, 0.4, 1 and 4, and ends at 0.1 and 50, which no polynomial
follows.  Both are cheap to compute: here is what they do to lives, and the response of a bearing (`bearing_sim.estimation.response`) is fitted to
what is left.
"""

import functools
import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model, inner_growth
from bearing_sim.levels.common.observation import oil_at_speed
from bearing_sim.levels.slip.forces import pitch_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import lubricate_scene
from bearing_sim.numerics.compilation import compiled_for, kernel
from bearing_sim.physics.rating_life import METHODS, OilFactors, contamination_factor, modified_by_oil, rate_lives
from bearing_sim.scene.scene import Scene

_KNOTS = -np.cos(math.pi * np.arange(5) / 4.0)  # slips at which lives are computed, over half the range (Chebyshev's)
_INVERSE = np.linalg.inv(np.vander(_KNOTS, increasing=True))  # coefficients of the polynomial through values at the knots
_NARROWEST = 1e-9  # range of slip that changes no life
_GREATEST_LIFE = 700.0  # logarithm of hours, beyond which a life counts as that
_TEMPERATURES = 512  # that lubrications are kept for


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
        self._compiled = None  # code of the lives at a slip, from its first call on
        if self.follows_oil:
            _modification_factors(np.zeros(1), np.zeros(1), 0.05, self._params.life, np.zeros(1))  # compiled now, and not during a run

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
        changes = np.zeros_like(slips)
        if not self.follows_slip:
            return changes
        for condition, slip, change in zip(conditions.tolist(), slips, changes):
            low, high = float(slip.min()), float(slip.max())
            if not high - low > _NARROWEST:
                change[:] = 0.0 * slip
                continue
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            lives = self.rating_lives(condition, (middle + half * _KNOTS).tolist())
            if not np.isfinite(lives).all():
                continue
            coefficients = _INVERSE @ lives
            place = (slip - middle) / half
            for coefficient in coefficients[:0:-1]:
                change += coefficient
                change *= place
            change -= change[0]
        return changes

    def rating_lives(self, condition: Sequence[float], slips: Sequence[float]) -> np.ndarray:
        """Return the logarithms of the rating life in revolutions at an operating point and slips of the cage, shape (m,)."""
        speed, load, kelvin, angle = condition
        load_y, load_z, params, work = load * math.cos(angle), load * math.sin(angle), self._params, self._work
        model = Model(params, self._lubrication(float(round(kelvin))), Drive(0.0, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0), DEFAULT_TOLERANCES)
        work.growth[0], work.ring[:] = inner_growth(speed, model), self._ring
        oil = oil_at_speed(speed, model)
        ideal = 0.5 * speed * (1.0 - params.raceways.diameter_ratio)
        if self._compiled is None:
            equivalent = pitch_loads(0.0, ideal, load_y, load_z, oil, params, work)
            rate_lives(load, equivalent, oil, params.life)
            loads = compiled_for(pitch_loads, (0.0, ideal, load_y, load_z, oil, params, work))
            self._compiled = loads, compiled_for(rate_lives, (load, equivalent, oil, params.life))
        loads, rated = self._compiled
        lives = [rated(load, loads(0.0, ideal * (1.0 - slip), load_y, load_z, oil, params, work), oil, params.life).basic for slip in slips]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log(lives)

    def by_oil(self, conditions: np.ndarray, lives: np.ndarray, ratios: np.ndarray) -> np.ndarray:
        """Return by how much the logarithm of a_ISO differs from the first one, for viscosity ratios and the loads that rating lives stand for.

        Parameters
        ----------
        conditions : as of `by_slip`.
        lives : logarithms of rating lives [h], shape (n, m).
        ratios : logarithms of kappa, shape (n, m).

        Returns
        -------
        shape (n, m); NaN where one of them is.
        """
        if not self.follows_oil:
            return np.zeros_like(lives)
        revolutions = np.exp(np.minimum(lives, _GREATEST_LIFE)) * np.abs(conditions[:, :1]) * (3600.0 / (2.0 * math.pi))
        found = np.empty_like(lives)
        pitch_diameter = 2.0 * self._params.raceways.pitch_radius
        _modification_factors(np.exp(ratios).ravel(), revolutions.ravel(), pitch_diameter, self._params.life, found.ravel())
        found = np.where(np.isnan(lives + ratios), math.nan, np.log(found))
        return found - found[:, :1]


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
