# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lambda ratio: how far the oil film keeps the surfaces of rollers and raceways apart."""

import numpy as np

from bearing_sim.model.oil import OilState, oil_at
from bearing_sim.model.params import pack
from bearing_sim.model.validity import contact_speeds
from bearing_sim.physics.film import DOWSON_HIGGINSON, films
from bearing_sim.scene.scene import Scene

_SAME_OIL = 0.1  # [K] an oil so much warmer is the same oil: its film differs by half a percent at most
_LOADED_FROM = 1.0  # [N] a roller that is pressed by less is not separated from anything


class FilmRatio:
    """lambda = h_min/sigma of the thinnest film between any loaded roller and either raceway.

    h_min is that of Dowson and Higginson, thinned by the heated inlet (`bearing_sim.physics.film.film_thickness`); sigma is the composite
    roughness of `bearing_sim.scene.scene.Roughness`.  Almost always the thinnest film is that of the inner ring's most heavily loaded
    contact, whose effective radius R is smallest.  Spins that a sample does not hold are those of rolling on the outer ring.

    Parameters
    ----------
    scene : whose bearing has a roughness.

    Raises
    ------
    ValueError
        It has none.
    """

    def __init__(self, scene: Scene):
        if scene.bearing.roughness is None:
            raise ValueError("bearing.roughness: missing; a lambda ratio needs the roughness of rollers and raceways")
        self._params, self._lubricant, self._roughness = pack(scene), scene.lubricant, scene.bearing.roughness.composite
        self._oil: OilState | None = None

    def least(self, samples: np.ndarray) -> np.ndarray:
        """Return the lambda ratio of each sample, shape (n,), NaN where no roller is loaded; all of one oil temperature, the last one's.

        Parameters
        ----------
        samples : shape (n,), see `bearing_sim.model.sample`.
        """
        raceways, oil = self._params.raceways, self._oil_at(float(samples["oil_temperature"][-1]))
        inner, outer = contact_speeds(samples, self._params)
        films = [
            self._film(oil, raceways.inner_curvature_radius, samples["inner_load"], *inner),
            self._film(oil, raceways.outer_curvature_radius, samples["outer_load"], *outer),
        ]
        thinnest = np.minimum(*(film.min(axis=1) for film in films))
        return np.where(np.isinf(thinnest), np.nan, thinnest) / self._roughness

    def _film(self, oil: OilState, radius: float, force: np.ndarray, rolling: np.ndarray, sliding: np.ndarray) -> np.ndarray:
        """Return the least thickness [m] of the contacts of one ring, infinite where a roller is not loaded; arrays of one shape."""
        rolling, pressed = np.maximum(np.abs(rolling), 1e-9), np.maximum(force, _LOADED_FROM)
        modulus, length = self._params.raceways.reduced_modulus, self._params.rollers.length
        return np.where(force > _LOADED_FROM, films(DOWSON_HIGGINSON, oil, radius, modulus, length, pressed, rolling, sliding), np.inf)

    def _oil_at(self, temperature: float) -> OilState:
        if self._oil is None or abs(self._oil.temperature - temperature) > _SAME_OIL:
            self._oil = oil_at(self._lubricant.oil, temperature)
        return self._oil
