# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The lubricant of a scene: laws of viscosity, oils, laws of traction."""

from dataclasses import field
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from bearing_sim.scene.quantity import check, named_law, quantity, record


@record
class DoubleExponentialViscosity:
    """eta0 = scale (exp(exp(a - b ln T)) - c), T in kelvin."""

    law: Literal["double_exponential"] = "double_exponential"
    scale: quantity("Pa*s", "factor", 1e-12, 1e3)
    a: float  # coefficient a
    b: float  # coefficient b
    c: float  # coefficient c


@record
class ReferenceViscosity:
    """eta0 = viscosity exp(linear d + quadratic d^2), d = (T_ref - T)/(T_ref T)."""

    law: Literal["reference"] = "reference"
    temperature: quantity("K", "reference temperature, T_ref", 150.0, 800.0, "degC")
    viscosity: quantity("Pa*s", "viscosity at the reference temperature", 1e-6, 1e3)
    linear: float  # coefficient of d [K]
    quadratic: float  # coefficient of d^2 [K^2]


@record
class HyperbolicPressureViscosity:
    """alpha = offset + slope/(T - pole), T in kelvin, alpha in 1/Pa."""

    law: Literal["hyperbolic"] = "hyperbolic"
    offset: float  # [1/Pa]
    slope: float  # [K/Pa]
    pole: float  # temperature of the pole [K]


@record
class PowerPressureViscosity:
    """alpha = exp(exponent ln eta0 - constant)/eta0, alpha in 1/Pa."""

    law: Literal["power"] = "power"
    exponent: float  # factor of ln eta0
    constant: float  # subtracted from it


@record
class Oil:
    """An oil's properties as functions of temperature (see `bearing_sim.model.oil`)."""

    law: Literal["fitted"] = "fitted"
    name: str  # name of the oil
    source: str  # where its data come from
    viscosity: Annotated[DoubleExponentialViscosity | ReferenceViscosity, Field(discriminator="law")]
    pressure_viscosity: Annotated[HyperbolicPressureViscosity | PowerPressureViscosity, Field(discriminator="law")]
    density_temperatures: tuple[quantity("K", "temperature of a density point", 150.0, 800.0, "degC"), ...]
    densities: tuple[quantity("kg/m^3", "density at that temperature", 100.0, 3000.0), ...]
    thermal_conductivity: quantity("", "thermal conductivity [W/(m K)]", 0.01, 10.0) = 0.0966
    specific_heat: quantity("J/(kg*K)", "specific heat; None: by density and temperature (Cragoe 1929)", 100.0, 1e4) | None = None

    @check
    def _density_points_pair_up(self) -> list[str]:
        if len(self.density_temperatures) != len(self.densities) or len(self.densities) < 1:
            return [
                f"densities: {len(self.densities)} values for {len(self.density_temperatures)} density_temperatures; expected the same number, "
                "at least one"
            ]
        if any(b <= a for a, b in zip(self.density_temperatures, self.density_temperatures[1:])):
            return ["density_temperatures: expected increasing temperatures"]
        return []


@record
class CustomOil:
    """An oil by the values of its data sheet: kinematic viscosities at 40 and 100 degC (ASTM D341), density, pressure viscosity."""

    law: Literal["custom"] = "custom"
    name: str = "custom"  # name of the oil
    source: str = ""  # where its data come from
    viscosity_40: quantity("m^2/s", "kinematic viscosity at 40 degC", 2e-7, 0.1, "mm^2/s")
    viscosity_100: quantity("m^2/s", "kinematic viscosity at 100 degC", 2e-7, 0.1, "mm^2/s")
    density: quantity("kg/m^3", "density at 15 degC", 100.0, 3000.0)
    expansion: quantity("1/K", "thermal expansion of the volume", 0.0, 1e-2) = 6.5e-4
    pressure_viscosity: quantity("1/Pa", "pressure-viscosity coefficient, alpha", 1e-10, 1e-7, "1/GPa")
    thermal_conductivity: quantity("", "thermal conductivity [W/(m K)]", 0.01, 10.0) = 0.14
    specific_heat: quantity("J/(kg*K)", "specific heat; None: by density and temperature (Cragoe 1929)", 100.0, 1e4) | None = None

    @check
    def _thins_when_heated(self) -> list[str]:
        if self.viscosity_100 >= self.viscosity_40:
            return ["viscosity_100: expected less than viscosity_40"]
        return []


@record
class Oil4109Traction:
    """Traction of the 4109 aviation oil by dimensionless load, speed and temperature (Wang Yanshuang's fit, see `bearing_sim.physics.traction`)."""

    law: Literal["oil_4109"] = "oil_4109"


@record
class ConstantTraction:
    """mu(s) = (A + B s) exp(-C s) + D with constant coefficients; D = -A keeps mu(0) = 0."""

    law: Literal["constant"] = "constant"
    a: quantity("", "A", -1.0, 0.0) = -0.0196
    b: quantity("", "B", 0.0, 1e3) = 0.39873
    c: quantity("", "C", 0.0, 1e4) = 39.002
    d: quantity("", "D", 0.0, 1.0) = 0.01984


@record
class KragelskiiTraction:
    """mu(v) = (A + B v) exp(-C v) + D by sliding speed v, from points of the curve (Kragelskii, as given by Gupta)."""

    law: Literal["kragelskii"] = "kragelskii"
    mu_0: quantity("", "coefficient as sliding begins; reached at rise_speed", 0.0, 1.0) = 0.0
    mu_max: quantity("", "largest coefficient", 1e-6, 1.0) = 0.05
    v_max: quantity("m/s", "sliding speed of the largest coefficient", 1e-3, 1e3) = 1.0
    mu_inf: quantity("", "coefficient at high sliding speed", 0.0, 1.0) = 0.036
    rise_speed: quantity("m/s", "sliding speed at which mu_0 is reached", 1e-4, 10.0) = 0.01

    @check
    def _maximum_is_one(self) -> list[str]:
        errors = [f"{name}: expected less than mu_max" for name in ("mu_0", "mu_inf") if getattr(self, name) >= self.mu_max]
        if self.mu_0 > 0.0 and self.rise_speed > 0.1 * self.v_max:
            errors.append("rise_speed: expected at most a tenth of v_max")
        return errors


@record
class EyringTraction:
    """Thermal Eyring film with limiting shear stress (see `bearing_sim.physics.traction`)."""

    law: Literal["eyring"] = "eyring"
    eyring_stress: quantity("Pa", "Eyring stress, tau_E", 1e5, 1e9, "MPa") = 5e6
    limiting_ratio: quantity("", "limiting shear stress over mean Hertz pressure, Lambda", 1e-3, 0.5) = 0.075


Traction = Annotated[Oil4109Traction | ConstantTraction | KragelskiiTraction | EyringTraction, Field(discriminator="law")]


@record
class NoRollingResistance:
    """Contacts that roll without resistance, as in Deng 2017."""

    law: Literal["none"] = "none"


@record
class HydrodynamicRollingResistance:
    """Resistance of the oil that contact inlets pump back (see `bearing_sim.physics.film.resistance_constants`)."""

    law: Literal["hydrodynamic"] = "hydrodynamic"
    inlet_heating: bool = True  # whether the inlet heats itself and thins its oil
    replenishment: (
        quantity("", "K_rs of SKF's replenishment factor, 0: flooded; None: 3e-8, or 0 in a bath above half a roller", 0.0, 1e-6) | None
    ) = None


RollingResistance = Annotated[NoRollingResistance | HydrodynamicRollingResistance, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``none``, ``hydrodynamic``)."""


@record
class OilJet:
    """Oil that is sprayed in and drained: rollers and cage move in a mixture of oil and air."""

    law: Literal["oil_jet"] = "oil_jet"


@record
class OilBath:
    """Oil that stands in a bearing whose shaft is horizontal (see `bearing_sim.physics.drag.bath_moment`)."""

    law: Literal["oil_bath"] = "oil_bath"
    level: quantity("m", "oil level above the lowest point of the outer raceway, H; None: the middle of the lowest roller", 0.0, 4.0, "mm") | None = (
        None
    )


Supply = Annotated[OilJet | OilBath, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``oil_jet``, ``oil_bath``)."""
_MIXTURE_FRACTION = {"oil_jet": 0.03, "oil_bath": 0.0}  # an assumption; SKF's drag in a bath is that of rollers and cage together


@record
class Lubricant:
    """The oil and how it is supplied, its fraction in the oil-air mixture inside the bearing, its traction law and its resistance to rolling."""

    oil: Annotated[Oil | CustomOil, Field(discriminator="law")]
    temperature: quantity("K", "oil temperature", 220.0, 600.0, "degC") = 393.15
    supply: Supply = field(default_factory=OilJet)
    mixture_fraction: quantity("", "volume fraction of oil in the oil-air mixture; None: 0.03, or 0 in a bath", 0.0, 1.0) | None = None
    traction_scale: quantity("", "factor on every traction coefficient", 0.0, 100.0) = 1.0
    traction: Traction = field(default_factory=Oil4109Traction)
    rolling_resistance: RollingResistance = field(default_factory=HydrodynamicRollingResistance)

    @model_validator(mode="after")
    def _fraction_of_the_supply(self):
        if self.mixture_fraction is None:
            object.__setattr__(self, "mixture_fraction", _MIXTURE_FRACTION[self.supply.law])
        return self
