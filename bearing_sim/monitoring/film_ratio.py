# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lambda ratio: how far the oil film keeps the surfaces of rollers and raceways apart."""

import numpy as np

from bearing_sim.kernels.film import DOWSON_HIGGINSON, HEAT_EXPONENT, HEAT_FACTOR, SHEAR_EXPONENT, SHEAR_FACTOR
from bearing_sim.oil import OilState, oil_at
from bearing_sim.params import pack
from bearing_sim.scene import Scene

_SAME_OIL = 0.1  # [K] an oil so much warmer is the same oil: its film differs by half a percent at most
_LOADED_FROM = 1.0  # [N] a roller that is pressed by less is not separated from anything


class FilmRatio:
    """lambda = h_min/sigma of the thinnest film between any loaded roller and either raceway.

    h_min = R 2.65 U^0.70 G^0.54 W^-0.13 (Dowson and Higginson, see `bearing_sim.kernels.film.minimum_film`) times what heating of
    the inlet leaves of it (`thermal_factor`); sigma is the composite roughness of `bearing_sim.scene.Roughness`.  Almost always it
    is the inner ring's most heavily loaded contact: there the effective radius R is smallest.  Spins that a sample does not tell
    are those of rolling on the outer ring.

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
        samples : shape (n,), see `bearing_sim.sample`.
        """
        raceways, rollers, oil = self._params.raceways, self._params.rollers, self._oil_at(float(samples["oil_temperature"][-1]))
        orbit, orbital = samples["roller_radius"], samples["orbital_speed"]
        spin = np.where(np.isnan(samples["roller_spin"]), orbital * orbit / rollers.radius, samples["roller_spin"])
        surface, shaft = spin * rollers.radius, samples["shaft_speed"][:, None]
        rolled = surface + orbital * rollers.radius  # the roller's surface, seen from the contact
        films = [
            self._film(oil, raceways.inner_curvature_radius, samples["inner_load"], 0.5 * ((shaft - orbital) * raceways.inner_radius + rolled),
                       shaft * raceways.inner_radius - orbital * orbit - surface),
            self._film(oil, raceways.outer_curvature_radius, samples["outer_load"], 0.5 * (orbital * (orbit + rollers.radius) + rolled),
                       surface - orbital * orbit),
        ]  # fmt: skip
        thinnest = np.minimum(*(film.min(axis=1) for film in films))
        return np.where(np.isinf(thinnest), np.nan, thinnest) / self._roughness

    def _film(self, oil: OilState, radius: float, force: np.ndarray, rolling: np.ndarray, sliding: np.ndarray) -> np.ndarray:
        """Return the least thickness [m] of the contacts of one ring, infinite where a roller is not loaded; arrays of one shape."""
        law, modulus = DOWSON_HIGGINSON, self._params.raceways.reduced_modulus
        rolling, pressed = np.maximum(np.abs(rolling), 1e-9), np.maximum(force, _LOADED_FROM)
        speed, load = oil.viscosity * rolling / (modulus * radius), pressed / (modulus * radius * self._params.rollers.length)
        thickness = radius * law.factor * speed**law.speed * (oil.pressure_viscosity * modulus) ** law.material * load**law.load
        thermal_load = oil.viscosity * oil.temperature_viscosity * rolling**2 / oil.conductivity
        sheared = 1.0 + SHEAR_FACTOR * (np.abs(sliding) / rolling) ** SHEAR_EXPONENT
        return np.where(force > _LOADED_FROM, thickness / (1.0 + HEAT_FACTOR * sheared * thermal_load**HEAT_EXPONENT), np.inf)

    def _oil_at(self, temperature: float) -> OilState:
        if self._oil is None or abs(self._oil.temperature - temperature) > _SAME_OIL:
            self._oil = oil_at(self._lubricant.oil, temperature)
        return self._oil
