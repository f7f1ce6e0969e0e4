# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Film thickness: how far the oil keeps the surfaces of rollers and raceways apart, and its ratio to their roughness, lambda."""

import math

import numpy as np

from bearing_sim.model.films import starvation_exponents
from bearing_sim.model.oil import OilState, oil_at
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import film_temperatures
from bearing_sim.model.validity import contact_speeds
from bearing_sim.physics.film import DOWSON_HIGGINSON, films
from bearing_sim.physics.starvation import starved_film
from bearing_sim.scene.scene import Scene

_SAME_OIL = 0.1  # [K] an oil so much warmer is the same oil: its film differs by half a percent at most
_LOADED_FROM = 1.0  # [N] a roller that is pressed by less is not separated from anything


class ThinnestFilm:
    """h_min of the thinnest film between any loaded roller and either raceway.

    It is that of Dowson and Higginson, thinned by the heated inlet (`bearing_sim.physics.film.film_thickness`) and by what little oil flows back
    (`bearing_sim.physics.starvation`).  Almost always it is that of the
    inner ring's most heavily loaded contact, whose effective radius R is smallest.  Spins that a sample does not hold are those of rolling
    on the outer ring.

    Parameters
    ----------
    scene : of the bearing and its oil.

    Attributes
    ----------
    roughness : composite roughness sigma [m] (`bearing_sim.scene.bearing.Roughness`); lambda = h_min/sigma.  NaN where the scene gives none.
    """

    def __init__(self, scene: Scene):
        self._params, self._lubricant = pack(scene), scene.lubricant
        self.roughness = scene.bearing.roughness.composite if scene.bearing.roughness is not None else math.nan
        self._oils: dict[str, OilState] = {}

    def least(self, samples: np.ndarray) -> np.ndarray:
        """Return the least thickness in each sample [m], shape (n,), NaN where no roller is loaded; all of the temperatures of the last one.

        Parameters
        ----------
        samples : shape (n,), see `bearing_sim.model.sample`.
        """
        raceways, (inner_film, outer_film) = self._params.raceways, map(float, film_temperatures(samples[-1]))
        inner, outer = contact_speeds(samples, self._params)
        left = self._left(samples, 0.5 * (inner_film + outer_film))
        films = [
            self._film(self._oil_at("inner", inner_film), raceways.inner_curvature_radius, samples["inner_load"], *inner),
            self._film(self._oil_at("outer", outer_film), raceways.outer_curvature_radius, samples["outer_load"], *outer),
        ]
        thinnest = np.minimum(*(film.min(axis=1) for film in films))
        return left * np.where(np.isinf(thinnest), np.nan, thinnest)

    def _left(self, samples: np.ndarray, temperature: float) -> np.ndarray:
        """Return what starved inlets leave of films at a mean temperature [K], shape (n,)."""
        starvation = self._params.starvation
        if starvation.rate == 0.0:
            return np.ones(len(samples))
        oil = self._oil_at("mean", temperature)
        exponents = starvation_exponents(samples["shaft_speed"], oil.viscosity / oil.density, starvation)
        return np.array([starved_film(exponent) for exponent in exponents.tolist()])

    def _film(self, oil: OilState, radius: float, force: np.ndarray, rolling: np.ndarray, sliding: np.ndarray) -> np.ndarray:
        """Return the least thickness [m] of the contacts of one ring, infinite where a roller is not loaded; arrays of one shape."""
        rolling, pressed = np.maximum(np.abs(rolling), 1e-9), np.maximum(force, _LOADED_FROM)
        modulus, length = self._params.raceways.reduced_modulus, self._params.rollers.length
        return np.where(force > _LOADED_FROM, films(DOWSON_HIGGINSON, oil, radius, modulus, length, pressed, rolling, sliding), np.inf)

    def _oil_at(self, ring: str, temperature: float) -> OilState:
        """Return the oil in the contacts of a ring at a temperature [K], computed again where that has changed enough to be seen."""
        before = self._oils.get(ring)
        if before is None or abs(before.temperature - temperature) > _SAME_OIL:
            self._oils[ring] = before = oil_at(self._lubricant.oil, temperature)
        return before
