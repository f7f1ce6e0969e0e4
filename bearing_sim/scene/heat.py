# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Heat of a scene: where the temperatures of rings, rollers, shaft and housing come from."""

from dataclasses import field
from typing import Annotated, Literal

from pydantic import Field

from bearing_sim.scene.quantity import Quantity, check, record


@record
class NoHeat:
    """All parts have the temperature of the oil."""

    law: Literal["none"] = "none"


@record
class GivenHeat:
    """Temperatures that are known, each constant; a part without one has the temperature of the oil.

    A measured temperature of a ring replaces the one given here.  With the dimensions of the running bearing (`bearing.dimensions_at`) temperatures
    of rings and rollers change the films only, and those of shaft and housing are refused.
    """

    law: Literal["given"] = "given"
    shaft: Annotated[float, Quantity("K", "temperature of the shaft; None: the inner ring's", 220.0, 600.0, "degC")] | None = None
    inner_ring: Annotated[float, Quantity("K", "temperature of the inner ring; None: the oil's", 220.0, 600.0, "degC")] | None = None
    rollers: Annotated[float, Quantity("K", "temperature of the rollers; None: the mean of both rings", 220.0, 600.0, "degC")] | None = None
    outer_ring: Annotated[float, Quantity("K", "temperature of the outer ring; None: the oil's", 220.0, 600.0, "degC")] | None = None
    housing: Annotated[float, Quantity("K", "temperature of the housing; None: the outer ring's", 220.0, 600.0, "degC")] | None = None


@record
class Housing:
    """The housing as it gives off heat, by default a split plummer block; its material is that of `mounting.housing`."""

    height: Annotated[float, Quantity("m", "height; None: 1.25 times the outside diameter of the bearing", 1e-3, 10.0, "mm")] | None = None
    width: (
        Annotated[float, Quantity("m", "width along the shaft; None: that of the bearing and 0.6 times its outside diameter", 1e-3, 10.0, "mm")]
        | None
    ) = None
    area: Annotated[float, Quantity("m^2", "surface that gives off heat; None: pi H (B + H/2) of height and width", 0.0, 1e3)] | None = None
    mass: Annotated[float, Quantity("kg", "mass; None: 3500 kg/m^3 times the cube of the bearing's outside diameter", 1e-3, 1e6)] | None = None
    emissivity: Annotated[float, Quantity("", "emissivity of the surface, 0.9: painted or cast", 0.0, 1.0)] = 0.9


@record
class ShaftEnds:
    """The shaft outside of the bearing, two fins in the air; its bore and material are those of `mounting.shaft`.

    A free end gives off heat only.  One of given temperature brings or takes heat: a motor's rotor, a gear, a pump's cold impeller.
    """

    front: (
        Annotated[float, Quantity("m", "length before the bearing; None: 2.5 times its bore diameter; 0: no heat leaves there", 0.0, 100.0, "mm")]
        | None
    ) = None
    back: Annotated[float, Quantity("m", "length behind the bearing, likewise", 0.0, 100.0, "mm")] | None = None
    front_temperature: Annotated[float, Quantity("K", "temperature that the front end is held at; None: a free end", 200.0, 600.0, "degC")] | None = (
        None
    )
    back_temperature: Annotated[float, Quantity("K", "temperature that the back end is held at, likewise", 200.0, 600.0, "degC")] | None = None
    emissivity: Annotated[float, Quantity("", "emissivity of its surface, 0.3: machined steel", 0.0, 1.0)] = 0.3

    @check
    def _held_ends_have_a_length(self) -> list[str]:
        return [
            f"{end}: 0 mm, but {end}_temperature is given; give the length from the bearing to where the shaft has that temperature"
            for end in ("front", "back")
            if getattr(self, end) == 0.0 and getattr(self, f"{end}_temperature") is not None
        ]


def _conductance(between: str) -> Quantity:
    return Quantity("W/K", f"{between}; None: computed", 0.0, 1e9)


@record
class Conductances:
    """Thermal conductances that are known; those that are left out are computed (see `bearing_sim.physics.heat`)."""

    shaft_inner_ring: Annotated[float, _conductance("shaft to inner ring, through their fit")] | None = None
    inner_ring_rollers: Annotated[float, _conductance("inner ring to rollers, through their contacts")] | None = None
    rollers_outer_ring: Annotated[float, _conductance("rollers to outer ring, through their contacts")] | None = None
    outer_ring_housing: Annotated[float, _conductance("outer ring to housing, through their fit")] | None = None
    inner_ring_oil: Annotated[float, _conductance("inner ring to the oil in the bearing")] | None = None
    rollers_oil: Annotated[float, _conductance("rollers and cage to the oil in the bearing")] | None = None
    outer_ring_oil: Annotated[float, _conductance("outer ring to the oil in the bearing")] | None = None
    housing_oil: Annotated[float, _conductance("housing to the oil in the bearing")] | None = None
    oil_flow: Annotated[float, _conductance("heat capacity of the oil that flows through, density x specific heat x flow")] | None = None
    housing_ambient: Annotated[float, _conductance("housing to ambient")] | None = None
    shaft_ambient: Annotated[float, _conductance("shaft to ambient, both ends")] | None = None
    shaft_front: Annotated[float, _conductance("shaft to its front end, where that has a given temperature")] | None = None
    shaft_back: Annotated[float, _conductance("shaft to its back end, likewise")] | None = None


@record
class ThermalFilter:
    """Noise of the filter that corrects the network by measured ring temperatures: a Kalman filter in its steady state.

    Each node's temperature drifts from the network's by a random walk of the standard deviation given here after one second: what heat
    and conductances that are not known do to it.  The defaults are assumptions; a sensor counts for more the less its noise.  A reading that is
    held counts at each step of the network.
    """

    shaft: Annotated[float, Quantity("K/s^0.5", "process noise of the shaft", 0.0, 100.0)] = 0.1
    inner_ring: Annotated[float, Quantity("K/s^0.5", "process noise of the inner ring", 0.0, 100.0)] = 0.5
    rollers: Annotated[float, Quantity("K/s^0.5", "process noise of the rollers", 0.0, 100.0)] = 0.5
    outer_ring: Annotated[float, Quantity("K/s^0.5", "process noise of the outer ring", 0.0, 100.0)] = 0.5
    housing: Annotated[float, Quantity("K/s^0.5", "process noise of the housing", 0.0, 100.0)] = 0.1
    oil: Annotated[float, Quantity("K/s^0.5", "process noise of the oil", 0.0, 100.0)] = 1.0
    sensor: Annotated[float, Quantity("delta_degC", "noise of a measured ring temperature, standard deviation of a reading", 1e-3, 100.0, "K")] = 0.5


@record
class NetworkHeat:
    """Temperatures of a network of lumped nodes: shaft, inner ring, rollers with cage, outer ring, housing and the oil in the bearing.

    The losses heat them; conduction, convection, the flow of oil and the ambient air cool them (see ``doc/theory/heat.md``).
    """

    law: Literal["network"] = "network"
    ambient_temperature: Annotated[float, Quantity("K", "temperature of the air around housing and shaft", 200.0, 500.0, "degC")] = 293.15
    # Air that a running machine stirs; DIN 31652-1 counts 7 + 12 v^(1/2) W/(m^2 K) from 1.2 m/s on.  0 is still air.
    air_speed: Annotated[float, Quantity("m/s", "speed of the air across the housing", 0.0, 100.0)] = 1.2
    oil_flow: (
        Annotated[float, Quantity("m^3/s", "oil that flows through the bearing; None: the supply's, or of a jet 5.6e-4 m^2/s x bore", 0.0, 1.0)]
        | None
    ) = None
    oil_volume: Annotated[float, Quantity("m^3", "oil in the bearing; None: by the oil's fraction of its space", 1e-9, 10.0)] | None = None
    start: Literal["oil", "ambient", "equilibrium"] = "oil"  # temperatures at time 0: all the oil's, all the air's, or those of equilibrium
    limit: Annotated[float, Quantity("K", "highest temperature of a thermal equilibrium; beyond it the bearing runs away", 300.0, 590.0, "degC")] = (
        573.15
    )
    interval: Annotated[float, Quantity("s", "least simulated time between two steps of the network", 1e-3, 100.0)] = 1.0
    convection_factor: Annotated[float, Quantity("", "factor on the convection of rings, rollers and cage to the oil", 0.0, 100.0)] = 1.0
    oil_to_housing: Annotated[float, Quantity("W/(m^2*K)", "heat transfer coefficient of the oil on the housing's inside", 0.0, 1e5)] = 200.0
    housing: Housing = field(default_factory=Housing)
    shaft: ShaftEnds = field(default_factory=ShaftEnds)
    conductances: Conductances = field(default_factory=Conductances)
    filter: ThermalFilter = field(default_factory=ThermalFilter)


def sink_errors(heat, lubricant) -> list[str]:
    """Return an error message for a thermal network from which no heat leaves.

    Parameters
    ----------
    heat : of the scene.
    lubricant : of the scene; oil baths, grease and oil-air have no flow unless the scene gives one.
    """
    if heat.law != "network":
        return []
    given = heat.conductances
    flow = lubricant.flow if heat.oil_flow is None else heat.oil_flow
    no_flow = given.oil_flow == 0.0 if given.oil_flow is not None else flow == 0.0
    no_housing = given.housing_ambient == 0.0 if given.housing_ambient is not None else heat.housing.area == 0.0
    no_shaft = given.shaft_ambient == 0.0 if given.shaft_ambient is not None else heat.shaft.front == heat.shaft.back == 0.0
    held = any(getattr(heat.shaft, f"{end}_temperature") is not None and getattr(given, f"shaft_{end}") != 0.0 for end in ("front", "back"))
    if no_flow and no_housing and no_shaft and not held:
        return ["heat.oil_flow: no oil flows through, and housing and shaft give off no heat: the network has no sink; open one of the three"]
    return []


def given_errors(heat, dimensions_at: str) -> list[str]:
    """Return error messages for given temperatures that change nothing: films do not know shaft and housing, running dimensions no growth.

    Parameters
    ----------
    heat : of the scene.
    dimensions_at : of the bearing.
    """
    if heat.law != "given" or dimensions_at != "running":
        return []
    return [
        f"heat.{name}: the dimensions are those of the running bearing, which the temperature of the {name} does not change; set "
        "bearing.dimensions_at: cold, or leave it out"
        for name in ("shaft", "housing")
        if getattr(heat, name) is not None
    ]


Heat = Annotated[NoHeat | GivenHeat | NetworkHeat, Field(discriminator="law")]
