# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The lubricant of a scene: laws of viscosity, oils, laws of traction."""

from collections.abc import Mapping
from dataclasses import field
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from bearing_sim.scene.quantity import Quantity, check, named_law, record

BASE_OILS = Literal["mineral", "pao", "ester", "pag", "aviation"]
"""Kinds of base oil: mineral, poly-alpha-olefin, ester, polyalkylene glycol, and the esters of aviation turbine oils."""


@record
class DoubleExponentialViscosity:
    """eta0 = scale (exp(exp(a - b ln T)) - c), T in kelvin."""

    law: Literal["double_exponential"] = "double_exponential"
    scale: Annotated[float, Quantity("Pa*s", "factor", 1e-12, 1e3)]
    a: float  # coefficient a
    b: float  # coefficient b
    c: float  # coefficient c


@record
class ReferenceViscosity:
    """eta0 = viscosity exp(linear d + quadratic d^2), d = (T_ref - T)/(T_ref T)."""

    law: Literal["reference"] = "reference"
    temperature: Annotated[float, Quantity("K", "reference temperature, T_ref", 150.0, 800.0, "degC")]
    viscosity: Annotated[float, Quantity("Pa*s", "viscosity at the reference temperature", 1e-6, 1e3)]
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
    base: BASE_OILS = "aviation"  # kind of base oil; it decides which law of traction is taken unless one is given
    viscosity: Annotated[DoubleExponentialViscosity | ReferenceViscosity, Field(discriminator="law")]
    pressure_viscosity: Annotated[HyperbolicPressureViscosity | PowerPressureViscosity, Field(discriminator="law")]
    density_temperatures: tuple[Annotated[float, Quantity("K", "temperature of a density point", 150.0, 800.0, "degC")], ...]
    densities: tuple[Annotated[float, Quantity("kg/m^3", "density at that temperature", 100.0, 3000.0)], ...]
    thermal_conductivity: Annotated[float, Quantity("", "thermal conductivity [W/(m K)]", 0.01, 10.0)] = 0.0966
    specific_heat: Annotated[float, Quantity("J/(kg*K)", "specific heat; None: by density and temperature (Cragoe 1929)", 100.0, 1e4)] | None = None

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
    """An oil by the values of its data sheet; what the sheet does not say follows from the kind of base oil (see `bearing_sim.model.oil`).

    The viscosity at 100 degC is given, or follows from the viscosity index by ASTM D2270; between and beyond both temperatures ASTM D341 holds.
    """

    law: Literal["custom"] = "custom"
    name: str = "custom"  # name of the oil
    source: str = ""  # where its data come from
    base: BASE_OILS = "mineral"  # kind of base oil
    viscosity_40: Annotated[float, Quantity("m^2/s", "kinematic viscosity at 40 degC", 2e-7, 0.1, "mm^2/s")]
    viscosity_100: Annotated[float, Quantity("m^2/s", "kinematic viscosity at 100 degC; None: by the index", 2e-7, 0.1, "mm^2/s")] | None = None
    viscosity_index: (
        Annotated[float, Quantity("", "viscosity index; None: usual of the base oil, if viscosity_100 is not given either", -60.0, 450.0)] | None
    ) = None
    density: Annotated[float, Quantity("kg/m^3", "density at 15 degC; None: by base oil and viscosity", 100.0, 3000.0)] | None = None
    expansion: Annotated[float, Quantity("1/K", "thermal expansion of the volume; None: by base oil and density", 0.0, 1e-2)] | None = None
    pressure_viscosity: (
        Annotated[
            float, Quantity("1/Pa", "pressure-viscosity coefficient, alpha; None: by base oil and viscosity (Gold et al. 2001)", 1e-10, 1e-7, "1/GPa")
        ]
        | None
    ) = None
    thermal_conductivity: Annotated[float, Quantity("", "thermal conductivity [W/(m K)]; None: by base oil", 0.01, 10.0)] | None = None
    specific_heat: Annotated[float, Quantity("J/(kg*K)", "specific heat; None: by density and temperature (Cragoe 1929)", 100.0, 1e4)] | None = None

    @check
    def _thins_when_heated(self) -> list[str]:
        if self.viscosity_100 is not None and self.viscosity_index is not None:
            return ["viscosity_index: follows from viscosity_40 and viscosity_100; give one of viscosity_100 and viscosity_index"]
        if self.viscosity_100 is not None and self.viscosity_100 >= self.viscosity_40:
            return ["viscosity_100: expected less than viscosity_40"]
        return []


def _as_text(value: object) -> object:
    """Return a number as its text, because files write NLGI classes as numbers."""
    return f"{value:g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _law_or(name: str) -> BeforeValidator:
    """Return the validator of a record that may be given by its law's bare name, or without its law, which then is ``name``."""
    return BeforeValidator(lambda value: {"law": name} | dict(given) if isinstance(given := named_law(value), Mapping) else given)


THICKENERS = Literal[
    "lithium",
    "lithium_complex",
    "lithium_calcium",
    "calcium",
    "calcium_sulfonate_complex",
    "aluminium_complex",
    "barium_complex",
    "sodium",
    "bentonite",
    "polyurea",
    "ptfe",
]


@record
class Grease:
    """A grease's thickener and consistency; its base oil is `lubricant.oil`, whose viscosity counts in films."""

    name: str = ""  # name of the grease
    source: str = ""  # where its data come from
    thickener: THICKENERS = "lithium"  # what thickens the base oil
    nlgi: Annotated[Literal["000", "00", "0", "1", "1.5", "2", "2.5", "3", "4"], BeforeValidator(_as_text)] = "2"  # consistency (ASTM D217)
    density: Annotated[float, Quantity("kg/m^3", "density at 20 degC; None: 900 kg/m^3", 500.0, 2500.0)] | None = None
    speed_factor: (
        Annotated[float, Quantity("", "highest n d_m that the grease is for [rpm mm]; None: by base oil and NLGI class", 1e3, 5e6)] | None
    ) = None
    lowest_temperature: (
        Annotated[float, Quantity("K", "lowest temperature that the grease is for; None: not judged", 150.0, 400.0, "degC")] | None
    ) = None
    highest_temperature: (
        Annotated[float, Quantity("K", "highest temperature that the grease is for; None: not judged", 250.0, 600.0, "degC")] | None
    ) = None

    @check
    def _temperatures_span_something(self) -> list[str]:
        low, high = self.lowest_temperature, self.highest_temperature
        if low is not None and high is not None and low >= high:
            return [f"lowest_temperature: {low - 273.15:.6g} degC is not below the highest_temperature, {high - 273.15:.6g} degC"]
        return []


@record
class Oil4109Traction:
    """Traction of the 4109 aviation oil by dimensionless load, speed and temperature (Wang Yanshuang's fit, see `bearing_sim.physics.traction`)."""

    law: Literal["oil_4109"] = "oil_4109"


@record
class ConstantTraction:
    """mu(s) = (A + B s) exp(-C s) + D with constant coefficients; D = -A keeps mu(0) = 0."""

    law: Literal["constant"] = "constant"
    a: Annotated[float, Quantity("", "A", -1.0, 0.0)] = -0.0196
    b: Annotated[float, Quantity("", "B", 0.0, 1e3)] = 0.39873
    c: Annotated[float, Quantity("", "C", 0.0, 1e4)] = 39.002
    d: Annotated[float, Quantity("", "D", 0.0, 1.0)] = 0.01984


@record
class KragelskiiTraction:
    """mu(v) = (A + B v) exp(-C v) + D by sliding speed v, from points of the curve (Kragelskii, as given by Gupta)."""

    law: Literal["kragelskii"] = "kragelskii"
    mu_0: Annotated[float, Quantity("", "coefficient as sliding begins; reached at rise_speed", 0.0, 1.0)] = 0.0
    mu_max: Annotated[float, Quantity("", "largest coefficient", 1e-6, 1.0)] = 0.05
    v_max: Annotated[float, Quantity("m/s", "sliding speed of the largest coefficient", 1e-3, 1e3)] = 1.0
    mu_inf: Annotated[float, Quantity("", "coefficient at high sliding speed", 0.0, 1.0)] = 0.036
    rise_speed: Annotated[float, Quantity("m/s", "sliding speed at which mu_0 is reached", 1e-4, 10.0)] = 0.01

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
    eyring_stress: Annotated[float, Quantity("Pa", "Eyring stress, tau_E; None: by base oil and temperature", 1e5, 1e9, "MPa")] | None = None
    limiting_ratio: (
        Annotated[float, Quantity("", "limiting shear stress over mean Hertz pressure, Lambda; None: by base oil and temperature", 1e-3, 0.5)] | None
    ) = None
    pressure_index: Annotated[float, Quantity("", "Roelands' pressure index, Z; None: by the oil's own alpha, or by base oil", 0.05, 2.0)] | None = (
        None
    )


Traction = Annotated[Oil4109Traction | ConstantTraction | KragelskiiTraction | EyringTraction, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``oil_4109``, ``constant``, ``kragelskii``, ``eyring``)."""


@record
class NoRollingResistance:
    """Contacts that roll without resistance, as in Deng 2017."""

    law: Literal["none"] = "none"


@record
class HydrodynamicRollingResistance:
    """Resistance of the oil that contact inlets pump back (see `bearing_sim.physics.film.resistance_constants`)."""

    law: Literal["hydrodynamic"] = "hydrodynamic"
    inlet_heating: bool = True  # whether the inlet heats itself and thins its oil


RollingResistance = Annotated[NoRollingResistance | HydrodynamicRollingResistance, Field(discriminator="law"), _law_or("hydrodynamic")]
"""A record, or its bare name (``none``, ``hydrodynamic``)."""


@record
class NoStarvation:
    """Contacts whose inlets are always full."""

    law: Literal["none"] = "none"


@record
class SkfStarvation:
    """Contacts that little oil flows back to: film and resistance to rolling fall together (see `bearing_sim.physics.starvation`)."""

    law: Literal["skf"] = "skf"
    constant: (
        Annotated[float, Quantity("", "K_rs of SKF; None: 3e-8, 6e-8 of grease and oil-air, 0 in a bath above half a roller", 0.0, 1e-6)] | None
    ) = None
    under_minimum_load: Literal["flooded", "starved"] = "flooded"  # what contacts resist as below the makers' minimum load, where a cage may skid


Starvation = Annotated[NoStarvation | SkfStarvation, Field(discriminator="law"), _law_or("skf")]
"""A record, or its bare name (``none``, ``skf``)."""


@record
class NoMixedFriction:
    """Contacts that films alone carry, as in Deng 2017."""

    law: Literal["none"] = "none"


@record
class MixedFriction:
    """Asperities that share the load by a film ratio or by SKF's weight; skew and hysteresis (see `bearing_sim.physics.mixed`)."""

    law: Literal["film_ratio", "skf"] = "film_ratio"
    boundary_friction: Annotated[float, Quantity("", "friction coefficient of asperities, mu_b", 0.0, 1.0)] = 0.12
    film_ratio_factor: Annotated[
        float, Quantity("", "film ratio over kappa^(1/1.3), for surfaces smoother or rougher than usual; of film_ratio", 0.1, 10.0)
    ] = 1.0
    raceways: bool = True  # whether asperities count for the traction of the raceways, from the makers' minimum load on
    skew: Annotated[float, Quantity("", "mean skew of rollers over what their end clearance leaves them", 0.0, 1.0)] = 0.5
    hysteresis: Annotated[float, Quantity("", "part of the elastic energy of a rolling contact that is lost", 0.0, 0.1)] = 0.01


Mixed = Annotated[NoMixedFriction | MixedFriction, Field(discriminator="law"), _law_or("film_ratio")]
"""A record, or its bare name (``none``, ``film_ratio``, ``skf``)."""


_FLOW = Annotated[float, Quantity("m^3/s", "oil that flows through the bearing", 0.0, 1.0, "l/min")]


@record
class OilJet:
    """Oil that is sprayed in and drained: rollers and cage move in a mixture of oil and air.

    With a flow the fraction of oil in the mixture follows from flow, size and speed (see `bearing_sim.physics.drag.swept_fraction`); without one
    it is 0.03.
    """

    law: Literal["oil_jet"] = "oil_jet"
    flow: _FLOW | None = None  # None: the mixture's fraction does not depend on it


@record
class Circulating:
    """Oil that is led in beside the rollers and drains off: it stands up to a low level and flows (see `bearing_sim.physics.drag.bath_moment`)."""

    law: Literal["circulating"] = "circulating"
    flow: _FLOW | None = None  # carries heat away; None: as of a jet
    level: (
        Annotated[
            float, Quantity("m", "oil level above the lowest point of the outer raceway, H; None: the middle of the lowest roller", 0.0, 4.0, "mm")
        ]
        | None
    ) = None


@record
class OilBath:
    """Oil that stands in a bearing whose shaft is horizontal (see `bearing_sim.physics.drag.bath_moment`)."""

    law: Literal["oil_bath"] = "oil_bath"
    level: (
        Annotated[
            float, Quantity("m", "oil level above the lowest point of the outer raceway, H; None: the middle of the lowest roller", 0.0, 4.0, "mm")
        ]
        | None
    ) = None


@record
class OilAir:
    """Small doses of oil in a stream of air, or oil mist: next to no oil to displace."""

    law: Literal["oil_air"] = "oil_air"
    flow: Annotated[float, Quantity("m^3/s", "oil that is dosed; it carries heat away; None: none that counts", 0.0, 1e-3, "ml/h")] | None = None


@record
class GreaseSupply:
    """Grease that has been run in: it lies beside the rollers and bleeds oil."""

    law: Literal["grease"] = "grease"
    fill: Annotated[float, Quantity("", "volume of grease over the free space of the bearing", 0.01, 1.0, "%")] = 0.3


Supply = Annotated[OilJet | Circulating | OilBath | OilAir | GreaseSupply, Field(discriminator="law"), BeforeValidator(named_law)]
"""A record, or its bare name (``oil_jet``, ``circulating``, ``oil_bath``, ``oil_air``, ``grease``)."""
# 0.03 is an assumption.  SKF's drag in a bath is that of rollers and cage together, and its model has none for oil-air and for run-in grease.
_MIXTURE_FRACTION = {"oil_jet": 0.03, "circulating": 0.0, "oil_bath": 0.0, "oil_air": 0.0, "grease": 0.0}


@record
class Lubricant:
    """The oil and how it is supplied, its fraction in the oil-air mixture inside the bearing, its traction law and its resistance to rolling.

    Of a grease `oil` is the base oil.  A field that is None in a file is filled in by what the others say.
    """

    oil: Annotated[Oil | CustomOil, Field(discriminator="law")]
    grease: Grease | None = None  # thickener and consistency; None: lubrication with oil
    temperature: Annotated[float, Quantity("K", "oil temperature", 220.0, 600.0, "degC")] = 393.15
    supply: Supply | None = None  # None: an oil jet, or of a grease its supply
    mixture_fraction: (
        Annotated[float, Quantity("", "volume fraction of oil in the oil-air mixture; None: of a jet by its flow or 0.03, else 0", 0.0, 1.0)] | None
    ) = None
    traction_scale: Annotated[float, Quantity("", "factor on every traction coefficient", 0.0, 100.0)] = 1.0
    traction: Traction | None = None  # None: oil_4109 of aviation oils, eyring of all others
    rolling_resistance: RollingResistance = field(default_factory=HydrodynamicRollingResistance)
    starvation: Starvation = field(default_factory=SkfStarvation)
    mixed_friction: Mixed = field(default_factory=MixedFriction)

    @model_validator(mode="after")
    def _fill_in(self):
        fill = object.__setattr__
        if self.supply is None:
            fill(self, "supply", OilJet() if self.grease is None else GreaseSupply())
        if self.supply.law == "grease" and self.grease is None:
            fill(self, "grease", Grease())
        if self.mixture_fraction is None and not self.fraction_follows_flow:
            fill(self, "mixture_fraction", _MIXTURE_FRACTION[self.supply.law])
        if self.traction is None:
            fill(self, "traction", Oil4109Traction() if self.oil.base == "aviation" else EyringTraction())
        return self

    @check
    def _grease_is_supplied_as_grease(self) -> list[str]:
        if self.grease is not None and self.supply.law != "grease":
            return [f"supply: {self.supply.law} is a supply of oil, and lubricant.grease is given; expected grease, or no lubricant.grease"]
        return []

    @property
    def fraction_follows_flow(self) -> bool:
        """Whether the mixture's fraction of oil depends on flow and speed, unless `mixture_fraction` is given."""
        return self.supply.law == "oil_jet" and self.supply.flow is not None

    @property
    def flow(self) -> float | None:
        """Oil that flows through the bearing [m^3/s]: the supply's, 0 where none flows, None where it is not known."""
        given = getattr(self.supply, "flow", None)
        return given if given is not None or self.supply.law in ("oil_jet", "circulating") else 0.0

    @property
    def has_bath(self) -> bool:
        """Whether oil stands in the bearing up to a level."""
        return self.supply.law in ("oil_bath", "circulating")
