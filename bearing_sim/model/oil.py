# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil properties at a temperature."""

import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.lubricant import CustomOil, DoubleExponentialViscosity, HyperbolicPressureViscosity, Oil
from bearing_sim.scene.viscosity_index import viscosity_at_100

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


class BaseOil(NamedTuple):
    """What the kind of base oil says about an oil whose data sheet does not."""

    viscosity_index: float
    pressure_scale: float  # s and t of alpha = s nu^t, alpha in 1/GPa, nu in mm^2/s
    pressure_exponent: float
    density_of: Callable[[float], float]  # density at 15 degC [kg/m^3] by the kinematic viscosity at 40 degC [mm^2/s]
    conductivity: float | None  # [W/(m K)]; None: by density and temperature
    eyring_stress: float  # at 40 degC [Pa]
    limiting_ratio: float  # limiting shear stress over mean Hertz pressure at 40 degC
    limiting_cooling: float  # its fall by temperature, of its value at 40 degC [1/K]
    pressure_index: float | None  # Roelands' Z at the pressure of contacts; None: by alpha


def _petroleum_density(viscosity_40: float) -> float:
    """Return the density of a mineral oil by its viscosity-gravity constant, 0.81 of solvent-refined paraffinic oils.

    ASTM D2501: VGC = [G - 0.0664 - 0.1154 lg(nu - 5.5)]/[0.94 - 0.109 lg(nu - 5.5)], nu at 40 degC in mm^2/s, G at 60 degF; solved for G.
    *Assumption*: thinner oils than 7 mm^2/s are as dense as one of that viscosity.
    """
    logarithm = math.log10(max(viscosity_40, _LEAST_GRAVITY_VISCOSITY) - 5.5)
    return _WATER_DENSITY * (_VISCOSITY_GRAVITY * (0.94 - 0.109 * logarithm) + 0.0664 + 0.1154 * logarithm)


def _olefin_density(viscosity_40: float) -> float:
    """Return the density of a poly-alpha-olefin, interpolated in ln nu between makers' PAO 2, 4, 6, 8, 10, 40 and 100."""
    return float(np.interp(math.log(viscosity_40), np.log((5.0, 19.0, 31.0, 48.0, 66.0, 396.0, 1240.0)), (798, 820, 827, 833, 835, 850, 853)))


_LEAST_GRAVITY_VISCOSITY, _VISCOSITY_GRAVITY = 7.0, 0.81
# s and t: P. W. Gold et al., J. Synth. Lubr. 18 (2001) 51, as secondary literature quotes them.  Viscosity indices, densities of esters and
# glycols and the conductivities that are not None: assumptions, usual values of data sheets.  Shear strength: see `shear_strength`.
BASE_OILS = {
    "mineral": BaseOil(95.0, 9.904, 0.139, _petroleum_density, None, 5e6, 0.07, 0.0025, 0.65),
    "pao": BaseOil(140.0, 7.382, 0.1335, _olefin_density, 0.15, 5e6, 0.055, 0.0025, 0.5),
    "ester": BaseOil(140.0, 6.605, 0.136, lambda viscosity: 960.0, 0.15, 5e6, 0.05, 0.0025, 0.48),
    "pag": BaseOil(200.0, 5.489, 0.1485, lambda viscosity: 1040.0, 0.155, 4.5e6, 0.04, 0.0025, 0.41),
    "aviation": BaseOil(135.0, 6.605, 0.136, lambda viscosity: 990.0, 0.15, 5e6, 0.075, 0.0, None),
}
_STRENGTH_AT, _STRENGTH_FROM, _STRENGTH_TO = 313.15, 253.15, 383.15  # [K]
_EXPANSION = 0.6278  # [kg/(m^3 K)] K_1 of lubricating oils in ASTM D1250 (table 53D): expansion at 15 degC = K_1/rho_15


def oil_at(oil: Oil | CustomOil, temperature: float) -> OilState:
    """Return the oil's properties at a temperature [K].

    The fit of a catalogued oil (see its ``source``), or ASTM D341 of an oil by its data sheet, whose other properties follow from its kind of
    base oil where the sheet does not give them; a catalogued oil's density is interpolated linearly between its points and constant beyond
    them.  beta is a central difference over 0.2 K.
    """
    viscosity, density = _viscosity_and_density(oil, temperature)
    warmer, colder = (_viscosity_and_density(oil, temperature + side)[0] for side in (0.1, -0.1))
    if isinstance(oil, CustomOil):
        alpha = oil.pressure_viscosity
        if alpha is None:
            alpha = class_pressure_viscosity(oil.base, viscosity / density)
    elif isinstance(law := oil.pressure_viscosity, HyperbolicPressureViscosity):
        alpha = law.offset + law.slope / (temperature - law.pole)
    else:
        alpha = math.exp(law.exponent * math.log(viscosity) - law.constant) / viscosity
    thinning = math.log(colder / warmer) / 0.2
    return OilState(float(temperature), viscosity, density, alpha, thermal_conductivity(oil, temperature), thinning)


def shear_strength(base: str, temperature: float) -> tuple[float, float]:
    """Return Eyring stress [Pa] and limiting shear stress over mean pressure of a kind of base oil at a temperature [K].

    The Eyring stress goes with the absolute temperature, tau_E = k T/v with an activation volume v (H. Eyring, J. Chem. Phys. 4 (1936) 283);
    the limiting stress falls linearly with temperature, as measured from -20 to 110 degC (V. Wikstrom, E. Hoglund, J. Tribol. 116 (1994) 612),
    held beyond.  *Assumptions*: the numbers, by the order in which measured traction falls from mineral oils through PAO and esters to glycols; see
    the theory of traction.  Oils of kind ``aviation`` have the constants 5 MPa and 0.075.
    """
    kind = BASE_OILS[base]
    if base == "aviation":
        return kind.eyring_stress, kind.limiting_ratio
    warmer = min(max(temperature, _STRENGTH_FROM), _STRENGTH_TO) - _STRENGTH_AT
    return kind.eyring_stress * temperature / _STRENGTH_AT, kind.limiting_ratio * (1.0 - kind.limiting_cooling * warmer)


def pressure_index(oil: Oil | CustomOil) -> float | None:
    """Return Roelands' index Z of an oil at the pressure of contacts by its kind of base oil; None of an oil that gives its own alpha.

    alpha = s nu^t is the rise of viscosity up to 0.2 GPa; extrapolated to a contact's pressure it leaves too little traction.  From alpha at
    30, 60 and 100 degC in G. W. Stachowiak, A. W. Batchelor, Engineering Tribology, table 2.3, follows Z of 0.59 to 0.84 of nine mineral oils
    and 0.41 to 0.43 of a copolymer of ethylene and propylene oxide.  *Assumptions*: 0.65 of refined paraffinic oils, 0.50 of PAO, 0.48 of esters.
    """
    return BASE_OILS[oil.base].pressure_index if isinstance(oil, CustomOil) and oil.pressure_viscosity is None else None


def class_pressure_viscosity(base: str, kinematic_viscosity: float) -> float:
    """Return alpha [1/Pa] of a kind of base oil: s nu^t (P. W. Gold et al., J. Synth. Lubr. 18 (2001) 51).

    The measured viscosity falls with temperature, and alpha with it.

    Parameters
    ----------
    base : of `BASE_OILS`.
    kinematic_viscosity : nu at the oil's temperature [m^2/s].
    """
    kind = BASE_OILS[base]
    return 1e-9 * kind.pressure_scale * (1e6 * kinematic_viscosity) ** kind.pressure_exponent


def viscosity_100(oil: CustomOil) -> float:
    """Return the kinematic viscosity of an oil at 100 degC [m^2/s]: its own, or by its viscosity index (ASTM D2270)."""
    if oil.viscosity_100 is not None:
        return oil.viscosity_100
    index = BASE_OILS[oil.base].viscosity_index if oil.viscosity_index is None else oil.viscosity_index
    return 1e-6 * viscosity_at_100(1e6 * oil.viscosity_40, index)


def thermal_conductivity(oil: Oil | CustomOil, temperature: float) -> float:
    """Return the thermal conductivity of an oil [W/(m K)] at a temperature [K].

    The oil's own where it gives one; of a mineral oil 0.1172 (1 - 0.00054 t)/s, t in degC and s the specific gravity at 60 degF (C. S. Cragoe,
    Bureau of Standards Misc. Publ. 97 (1929): within 10 % from 0 to 200 degC); of other base oils a constant (`BASE_OILS`).
    """
    if oil.thermal_conductivity is not None:
        return oil.thermal_conductivity
    constant = BASE_OILS[oil.base].conductivity
    if constant is not None:
        return constant
    return 0.1172 * (1.0 - 0.00054 * (temperature - 273.15)) / _specific_gravity(oil)


def specific_heat(oil: Oil | CustomOil, temperature: float) -> float:
    """Return the specific heat of an oil [J/(kg K)] at a temperature [K].

    The oil's own where it gives one; otherwise (1684.8 + 3.391 t)/s^(1/2), t in degC and s the specific gravity at 60 degF, which is
    0.388 + 0.00045 t in cal/(g degC) and degF of C. S. Cragoe, Thermal Properties of Petroleum Products, Bureau of Standards Misc. Publ. 97
    (1929): petroleum oils from 0 to 200 degC within 2 to 4 %.  *Assumption*: synthetic oils follow it too, within 12 %.
    """
    if oil.specific_heat is not None:
        return oil.specific_heat
    return (1684.8 + 3.391 * (temperature - 273.15)) / math.sqrt(_specific_gravity(oil))


@functools.lru_cache(maxsize=256)
def _specific_gravity(oil: Oil | CustomOil) -> float:
    """Return the density of an oil at 60 degF over that of water."""
    return _viscosity_and_density(oil, _GRAVITY_TEMPERATURE)[1] / _WATER_DENSITY


def kinematic_viscosities(oil: Oil | CustomOil, temperatures: np.ndarray) -> np.ndarray:
    """Return nu [m^2/s] of an oil at many temperatures [K], of one shape; interpolated logarithmically between whole kelvins, to 1e-4."""
    kelvins = np.arange(math.floor(temperatures.min()), math.ceil(temperatures.max()) + 1, dtype=float)
    at = [_viscosity_and_density(oil, kelvin) for kelvin in kelvins.tolist()]
    return np.exp(np.interp(temperatures, kelvins, [math.log(viscosity / density) for viscosity, density in at]))


def _viscosity_and_density(oil: Oil | CustomOil, temperature: float) -> tuple[float, float]:
    """Return eta_0 [Pa s] and density [kg/m^3]."""
    if isinstance(oil, CustomOil):
        thick, thin, heaviness, expansion = _data_sheet(oil)
        density = heaviness * (1.0 - expansion * (temperature - _DENSITY_TEMPERATURE))
        return density * walther_viscosity(temperature, thick, thin), density
    law, density = oil.viscosity, float(np.interp(temperature, oil.density_temperatures, oil.densities))
    if isinstance(law, DoubleExponentialViscosity):
        return law.scale * (math.exp(math.exp(law.a - law.b * math.log(temperature))) - law.c), density
    d = (law.temperature - temperature) / (law.temperature * temperature)
    return law.viscosity * math.exp(law.linear * d + law.quadratic * d * d), density


@functools.lru_cache(maxsize=256)
def _data_sheet(oil: CustomOil) -> tuple[float, float, float, float]:
    """Return nu at 40 and 100 degC [m^2/s], density at 15 degC [kg/m^3] and expansion [1/K]: the oil's own, or those of its kind of base oil."""
    density = BASE_OILS[oil.base].density_of(1e6 * oil.viscosity_40) if oil.density is None else oil.density
    return oil.viscosity_40, viscosity_100(oil), density, _EXPANSION / density if oil.expansion is None else oil.expansion


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
