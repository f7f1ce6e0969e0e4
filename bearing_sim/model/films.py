# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is left of the films of a bearing, and what asperities carry, for people: two answers where the safe sides are opposite."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.model.oil import kinematic_viscosities
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import film_temperatures
from bearing_sim.physics.mixed import NONE, film_state
from bearing_sim.physics.rating_life import viscosity_ratio
from bearing_sim.physics.starvation import Starvation, starvation_exponent, starved_film
from bearing_sim.scene.scene import Scene

_FULL = 0.995  # what is left of a film that rounds to all of it


class Films(NamedTuple):
    """Films of a bearing at an instant."""

    full_viscosity_ratio: float  # kappa with full inlets
    left: float  # thickness over that of full inlets, as lives take it
    drag_left: float  # the same as drag and traction take it: nearer to 1 below the minimum load
    asperity_share: float  # share of loads that asperities carry; NaN where the scene has none

    @property
    def text(self) -> str:
        """In words; empty where inlets are full and asperities do not count."""
        parts = []
        if self.left < _FULL:
            parts.append(f"{100.0 * self.left:.3g} % of full films, with which kappa would be {self.full_viscosity_ratio:.3g}")
            if self.drag_left > self.left:
                parts.append(f"slip is computed with {100.0 * self.drag_left:.3g} % of them, on the safe side below the minimum load")
        if self.asperity_share > 0.0:
            parts.append(f"asperities carry {100.0 * self.asperity_share:.2g} %")
        return "; ".join(parts)


def starvation_exponents(speeds: np.ndarray, viscosity: np.ndarray | float, starvation: Starvation) -> np.ndarray:
    """Return the exponents x of many instants (`bearing_sim.physics.starvation`), in NumPy.

    Parameters
    ----------
    speeds : of the shaft [rad/s].
    viscosity : kinematic, nu in the films [m^2/s], one or as many.
    starvation : of the bearing.
    """
    uncompiled = getattr(starvation_exponent, "py_func", starvation_exponent)
    return uncompiled(speeds, viscosity, starvation)


def films_of(scene: Scene, sample: np.void) -> Films:
    """Return the `Films` of a sample of a turning shaft (`bearing_sim.model.sample`)."""
    params = pack(scene)
    viscosity = float(kinematic_viscosities(scene.lubricant.oil, np.atleast_1d(0.5 * sum(film_temperatures(sample))))[0])
    speed, load = float(sample["shaft_speed"]), math.hypot(sample["load_y"], sample["load_z"])
    pocket, flange = params.cage.pocket_friction, params.flanges.film_friction
    state = film_state(speed, load, viscosity, pocket, flange, params.minimum_load, params.starvation, params.mixed)
    return Films(
        viscosity_ratio(viscosity, speed, 2.0 * params.raceways.pitch_radius),
        starved_film(starvation_exponent(speed, viscosity, params.starvation)),
        math.exp(state.log_film),
        state.asperity_share if params.mixed.law != NONE else math.nan,
    )
