# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil properties at a temperature."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.lubricant import CustomOil, DoubleExponentialViscosity, HyperbolicPressureViscosity, Oil

_DENSITY_TEMPERATURE = 288.15  # K, of data sheets
_GRAVITY_TEMPERATURE, _WATER_DENSITY = 288.71, 999.0  # K, kg/m^3: water at 60 degF, which specific gravity refers to
_LEAST_VISCOSITY = 0.115273843  # mm^2/s, just above where Z of ASTM D341 is 1 and its double logarithm ends


class OilState(NamedTuple):
    """An oil at one temperature, in SI."""

    temperature: float  # T_0 [K]
    viscosity: float  # eta_0 [Pa s]
    density: float  # [kg/m^3]
    pressure_viscosity: float  # alpha [1/Pa]
    conductivity: float  # k [W/(m K)]
    temperature_viscosity: float  # beta = -d ln eta_0/dT [1/K]


def oil_at(oil: Oil | CustomOil, temperature: float) -> OilState:
    """Return the oil's properties at a temperature [K].

    The fit of a catalogued oil (see its ``source``), or ASTM D341 of a custom oil; a catalogued oil's density is interpolated linearly
    between its points and constant beyond them.  beta is a central difference over 0.2 K.
    """
    viscosity, density = _viscosity_and_density(oil, temperature)
    warmer, colder = (_viscosity_and_density(oil, temperature + side)[0] for side in (0.1, -0.1))
    if isinstance(oil, CustomOil):
        alpha = oil.pressure_viscosity
    elif isinstance(law := oil.pressure_viscosity, HyperbolicPressureViscosity):
        alpha = law.offset + law.slope / (temperature - law.pole)
    else:
        alpha = math.exp(law.exponent * math.log(viscosity) - law.constant) / viscosity
    thinning = math.log(colder / warmer) / 0.2
    return OilState(float(temperature), viscosity, density, alpha, oil.thermal_conductivity, thinning)


def specific_heat(oil: Oil | CustomOil, temperature: float) -> float:
    """Return the specific heat of an oil [J/(kg K)] at a temperature [K].

    The oil's own where it gives one; otherwise (1684.8 + 3.391 t)/s^(1/2), t in degC and s the specific gravity at 60 degF, which is
    0.388 + 0.00045 t in cal/(g degC) and degF of C. S. Cragoe, Thermal Properties of Petroleum Products, Bureau of Standards Misc. Publ. 97
    (1929): petroleum oils from 0 to 200 degC within 2 to 4 %.  *Assumption*: esters follow it too, within 10 %.
    """
    if oil.specific_heat is not None:
        return oil.specific_heat
    gravity = _viscosity_and_density(oil, _GRAVITY_TEMPERATURE)[1] / _WATER_DENSITY
    return (1684.8 + 3.391 * (temperature - 273.15)) / math.sqrt(gravity)


def kinematic_viscosities(oil: Oil | CustomOil, temperatures: np.ndarray) -> np.ndarray:
    """Return nu [m^2/s] of an oil at many temperatures [K], of one shape; interpolated logarithmically between whole kelvins, to 1e-4."""
    kelvins = np.arange(math.floor(temperatures.min()), math.ceil(temperatures.max()) + 1, dtype=float)
    at = [_viscosity_and_density(oil, kelvin) for kelvin in kelvins.tolist()]
    return np.exp(np.interp(temperatures, kelvins, [math.log(viscosity / density) for viscosity, density in at]))


def _viscosity_and_density(oil: Oil | CustomOil, temperature: float) -> tuple[float, float]:
    """Return eta_0 [Pa s] and density [kg/m^3]."""
    if isinstance(oil, CustomOil):
        density = oil.density * (1.0 - oil.expansion * (temperature - _DENSITY_TEMPERATURE))
        return density * walther_viscosity(temperature, oil.viscosity_40, oil.viscosity_100), density
    law, density = oil.viscosity, float(np.interp(temperature, oil.density_temperatures, oil.densities))
    if isinstance(law, DoubleExponentialViscosity):
        return law.scale * (math.exp(math.exp(law.a - law.b * math.log(temperature))) - law.c), density
    d = (law.temperature - temperature) / (law.temperature * temperature)
    return law.viscosity * math.exp(law.linear * d + law.quadratic * d * d), density


def walther_viscosity(temperature: float, viscosity_40: float, viscosity_100: float) -> float:
    """Return the kinematic viscosity at a temperature: lg lg Z is linear in lg T (C. Walther's equation, ASTM D341).

    Z = nu + 0.7 + exp(-1.47 - 1.84 nu - 0.51 nu^2) with nu in mm^2/s.

    Parameters
    ----------
    temperature : [K].
    viscosity_40, viscosity_100 : at 40 and 100 degC [m^2/s].
    """
    from scipy.optimize import brentq

    low, high = math.log10(313.15), math.log10(373.15)
    thick, thin = (_lg_lg_z(1e6 * viscosity) for viscosity in (viscosity_40, viscosity_100))
    wanted = thick + (thin - thick) * (math.log10(temperature) - low) / (high - low)
    # Solved for ln nu, from 0.2 mm^2/s (the standard ends at 0.21): the standard's own inverse is good to three digits only.  A thinner oil
    # is extrapolated to where Z is 1, so that a hot oil has a viscosity, with a warning (`bearing_sim.model.validity`), and not an error.
    thinnest = 0.2 if wanted > _lg_lg_z(0.2) else _LEAST_VISCOSITY
    log_nu = brentq(lambda log: _lg_lg_z(math.exp(log)) - wanted, math.log(thinnest), math.log(1e12), xtol=1e-15, rtol=4 * np.finfo(float).eps)
    return 1e-6 * math.exp(log_nu)


def _lg_lg_z(nu: float) -> float:
    return math.log10(math.log10(nu + 0.7 + math.exp(-1.47 - 1.84 * nu - 0.51 * nu * nu)))
