"""Oil properties at a temperature."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.scene import DoubleExponentialViscosity, HyperbolicPressureViscosity, Oil


class OilState(NamedTuple):
    """An oil at one temperature, in SI."""

    temperature: float  # T_0 [K]
    viscosity: float  # eta_0 [Pa s]
    density: float  # [kg/m^3]
    pressure_viscosity: float  # alpha [1/Pa]
    conductivity: float  # k [W/(m K)]


def oil_at(oil: Oil, temperature: float) -> OilState:
    """Return the oil's properties at a temperature [K].

    Fits of the ADORE-style data base (see the oil's ``source``); the density is interpolated linearly
    between its points and held beyond them.
    """
    law = oil.viscosity
    if isinstance(law, DoubleExponentialViscosity):
        viscosity = law.scale * (math.exp(math.exp(law.a - law.b * math.log(temperature))) - law.c)
    else:
        d = (law.temperature - temperature) / (law.temperature * temperature)
        viscosity = law.viscosity * math.exp(law.linear * d + law.quadratic * d * d)
    pressure_law = oil.pressure_viscosity
    if isinstance(pressure_law, HyperbolicPressureViscosity):
        alpha = pressure_law.offset + pressure_law.slope / (temperature - pressure_law.pole)
    else:
        alpha = math.exp(pressure_law.exponent * math.log(viscosity) - pressure_law.constant) / viscosity
    density = float(np.interp(temperature, oil.density_temperatures, oil.densities))
    return OilState(float(temperature), viscosity, density, alpha, oil.thermal_conductivity)
