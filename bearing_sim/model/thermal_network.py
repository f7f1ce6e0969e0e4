# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""From a scene to the numbers of its thermal network: geometry, heat capacities, and where each loss becomes heat.

`bearing_sim.physics.thermal_network` computes with them; ``doc/theory/heat.md`` gives every conductance.
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from bearing_sim.model.oil import oil_at, specific_heat, thermal_conductivity
from bearing_sim.model.params import Params, mixture_fraction
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.physics.heat import plummer_block_area
from bearing_sim.physics.thermal_network import LINK, NODE, NODES, Bodies, Contacts, Network, Oils, Surfaces
from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.heat import NetworkHeat
from bearing_sim.scene.lubricant import CustomOil, Oil
from bearing_sim.scene.mounting import housing_interference, shaft_interference
from bearing_sim.scene.scene import Scene

POWERS = tuple(each.name for each in OBSERVABLES if each.name.endswith("_power") and each.name != "shaft_power")
"""Losses by cause, in the order of the observables: the rows of the partition."""

# Where a loss becomes heat.  Sliding between bodies of one material at nearly equal speeds: to both alike (H. Blok, 1937; J. C. Jaeger, 1942).
# Assumptions: half of what the contacts' inlets shear goes away with the oil that they push back, the rest to both surfaces; a land heats its
# ring and the cage alike; damping is half in the rollers; a lip seal, which conducts badly, heats the ring that slides on it;
# dampers are in the housing.
_PARTITION = {
    "inner_sliding_power": {NODE.inner_ring: 0.5, NODE.rollers: 0.5},
    "outer_sliding_power": {NODE.outer_ring: 0.5, NODE.rollers: 0.5},
    "inner_rolling_power": {NODE.oil: 0.5, NODE.inner_ring: 0.25, NODE.rollers: 0.25},
    "outer_rolling_power": {NODE.oil: 0.5, NODE.outer_ring: 0.25, NODE.rollers: 0.25},
    "churning_power": {NODE.oil: 1.0},
    "windage_power": {NODE.oil: 1.0},
    "pocket_power": {NODE.rollers: 1.0},
    "damping_power": {NODE.rollers: 0.5, NODE.inner_ring: 0.25, NODE.outer_ring: 0.25},
    "seal_power": {NODE.inner_ring: 1.0},
    "support_power": {NODE.housing: 1.0},
}
# Assumptions where the scene names no value.
_HOUSING_HEIGHT, _HOUSING_WIDTH = 1.25, 0.6  # of the outside diameter; split plummer blocks: height 1.2 to 1.4, width less the bearing's 0.5 to 0.8
_HOUSING_DENSITY = 3500.0  # kg/m^3; mass of such a block over the cube of the bearing's outside diameter, 3000 to 4000
_SHAFT_LENGTH = 2.5  # of the bore diameter
_JET = 5.6e-4  # m^2/s; flow over bore: 4 l/min at 118 mm, of the 1.9 to 10.2 l/min of F. T. Schuller, NASA TP-1413 (1979)
_BATH = 1.0 / 3.0  # of the space of the bearing that its oil takes
_FREE_SPACE = 1.0 / 3.0  # of the space between bore, outside and faces that is free of steel
_CONDUCTIVITY_AT = 333.15  # [K] temperature of the oil's conductivity, which changes by 0.05 % a kelvin
_MEAN_SQUARE = 0.2  # R_q over R_z of turned and ground surfaces, 0.15 to 0.25
_HARDNESS = 2.5e9  # Pa; heat-treated shaft steel, 250 HB
_COLDEST, _HOTTEST, _OIL_STEP = 220.0, 600.0, 2.0  # K; range and spacing of the table of the oil


class Dimensions(NamedTuple):
    """Boundary dimensions of a bearing, those that the scene leaves out by assumption."""

    bore_radius: float  # [m]
    outside_radius: float
    width: float


def boundary_dimensions(bearing: Bearing) -> Dimensions:
    """Return bore, outside radius and width of a bearing, estimated where its scene does not name them."""
    return Dimensions(bearing.bore_diameter / 2, bearing.outside_diameter / 2, bearing.boundary_width)


def oil_flow(scene: Scene) -> float:
    """Return the oil that flows through a bearing with a thermal network [m^3/s]: the scene's, or a plausible one of a jet or of circulating oil."""
    flow = scene.lubricant.flow if scene.heat.oil_flow is None else scene.heat.oil_flow
    return _JET * 2.0 * boundary_dimensions(scene.bearing).bore_radius if flow is None else flow


def _oil_fraction(scene: Scene) -> float:
    """Return the fraction of the bearing's space that its oil or grease takes."""
    lubricant, bearing = scene.lubricant, scene.bearing
    if lubricant.supply.law == "grease":
        return _FREE_SPACE * lubricant.supply.fill
    if lubricant.has_bath:
        return _BATH
    return float(mixture_fraction(lubricant, bearing.pitch_diameter, scene.operating.shaft_speed))


def thermal_network(scene: Scene, params: Params) -> Network:
    """Return the thermal network of a scene whose `heat.law` is network, as compiled code needs it.

    Parameters
    ----------
    scene : the scene.
    params : of its bearing.
    """
    heat, bearing, size = scene.heat, scene.bearing, boundary_dimensions(scene.bearing)
    material, shaft, housing = bearing.material, heat.shaft, heat.housing
    shaft_seat, housing_seat = scene.mounting.shaft, scene.mounting.housing
    height = housing.height if housing.height is not None else _HOUSING_HEIGHT * 2.0 * size.outside_radius
    width = housing.width if housing.width is not None else size.width + _HOUSING_WIDTH * 2.0 * size.outside_radius
    inner_radius, outer_radius = params.raceways.inner_radius, float(params.raceways.contour[:, 3].mean())
    bore = min(shaft_seat.bore_radius, 0.99 * size.bore_radius)
    front, back = (_SHAFT_LENGTH * 2.0 * size.bore_radius if length is None else length for length in (shaft.front, shaft.back))
    rollers = params.rollers
    return Network(
        contacts=Contacts(
            rollers.count,
            rollers.radius,
            rollers.length,
            params.raceways.inner_curvature_radius,
            params.raceways.outer_curvature_radius,
            inner_radius,
            outer_radius,
            params.raceways.reduced_modulus,
            material.thermal_conductivity,
            material.thermal_conductivity / (material.density * material.specific_heat),
        ),
        bodies=Bodies(
            size.bore_radius,
            size.outside_radius,
            size.width,
            bore,
            max(0.5 * height, 1.02 * size.outside_radius),
            material.thermal_conductivity,
            shaft_seat.material.thermal_conductivity,
            housing_seat.material.thermal_conductivity,
            _MEAN_SQUARE * math.hypot(shaft_seat.roughness, shaft_seat.ring_roughness),
            _MEAN_SQUARE * math.hypot(housing_seat.roughness, housing_seat.ring_roughness),
            _HARDNESS,
        ),
        surfaces=Surfaces(
            2.0 * math.pi * (inner_radius * size.width + inner_radius**2 - size.bore_radius**2),
            rollers.count * 2.0 * math.pi * rollers.radius * (rollers.length + rollers.radius)
            + 8.0 * math.pi * bearing.pitch_radius * bearing.cage.width,
            2.0 * math.pi * (outer_radius * size.width + size.outside_radius**2 - outer_radius**2),
            2.0 * math.pi * size.outside_radius * (size.outside_radius + max(width - size.width, 0.0)),
            housing.area if housing.area is not None else plummer_block_area(height, width),
            housing.emissivity,
            heat.air_speed,
            front,
            back,
            shaft.emissivity,
            heat.oil_to_housing,
            heat.convection_factor,
            oil_flow(scene),
        ),
        oils=_oils(scene.lubricant.oil),
        given=np.array([_unless_given(getattr(heat.conductances, name)) for name in LINK._fields]),
        capacities=_capacities(scene, params, size, bore, 0.5 * (front + back)),
        partition=partition(bearing),
        ambient=heat.ambient_temperature,
        front=_unless_given(shaft.front_temperature),
        back=_unless_given(shaft.back_temperature),
    )


def _unless_given(number: float | None) -> float:
    return math.nan if number is None else number


def _capacities(scene: Scene, params: Params, size: Dimensions, bore: float, beside: float) -> np.ndarray:
    """Return the heat capacities of the nodes [J/K]; of the shaft outside of the bearing half counts, for it is colder."""
    bearing, heat = scene.bearing, scene.heat
    material, outer = bearing.material, float(params.raceways.contour[:, 3].mean())
    core, around = scene.mounting.shaft.material, scene.mounting.housing.material
    steel = material.density * material.specific_heat
    volume = math.pi * (size.outside_radius**2 - size.bore_radius**2) * size.width
    oil = oil_at(scene.lubricant.oil, scene.lubricant.temperature)
    fraction = _oil_fraction(scene)
    poured = heat.oil_volume if heat.oil_volume is not None else fraction * volume
    housing = heat.housing.mass if heat.housing.mass is not None else _HOUSING_DENSITY * (2.0 * size.outside_radius) ** 3
    capacities = np.empty(NODES)
    capacities[NODE.shaft] = core.density * core.specific_heat * math.pi * (size.bore_radius**2 - bore**2) * (size.width + beside)
    capacities[NODE.inner_ring] = steel * math.pi * (params.raceways.inner_radius**2 - size.bore_radius**2) * size.width
    capacities[NODE.rollers] = (
        params.rollers.count * params.rollers.mass * material.specific_heat + bearing.cage.mass * bearing.cage.material.specific_heat
    )
    capacities[NODE.outer_ring] = steel * math.pi * (size.outside_radius**2 - outer**2) * size.width
    capacities[NODE.housing] = housing * around.specific_heat
    capacities[NODE.oil] = max(poured, 1e-9) * oil.density * specific_heat(scene.lubricant.oil, scene.lubricant.temperature)
    return capacities


def partition(bearing: Bearing) -> np.ndarray:
    """Return the fraction of each loss that becomes heat in each node, shape (len(POWERS), NODES); each row adds up to 1."""
    ring = NODE.inner_ring if bearing.cage.guidance == "inner_ring" else NODE.outer_ring
    flanged = [node for node, sides in ((NODE.inner_ring, bearing.flanges.inner), (NODE.outer_ring, bearing.flanges.outer)) if sides != "none"]
    rubbed = {NODE.rollers: 0.5, **{node: 0.5 / len(flanged) for node in flanged}} if flanged else {NODE.rollers: 1.0}
    places = {**_PARTITION, "land_power": {ring: 0.5, NODE.rollers: 0.5}, "flange_power": rubbed}
    fractions = np.zeros((len(POWERS), NODES))
    for row, name in enumerate(POWERS):
        for node, fraction in places[name].items():
            fractions[row, node] = fraction
    return fractions


@functools.lru_cache(maxsize=2048)  # as many oils as a study of an uncertain viscosity has draws, 6 kB each
def _oils(oil: Oil | CustomOil) -> Oils:
    temperatures = np.arange(_COLDEST, _HOTTEST + 0.5 * _OIL_STEP, _OIL_STEP)
    rows = []
    for temperature in temperatures.tolist():
        state = oil_at(oil, temperature)
        rows.append(
            (
                math.log(state.viscosity / state.density),
                state.density,
                specific_heat(oil, temperature),
                math.log(state.pressure_viscosity),
            )
        )
    return Oils(_COLDEST, _OIL_STEP, np.array(rows), thermal_conductivity(oil, _CONDUCTIVITY_AT))


def start_temperatures(heat: NetworkHeat, inlet: float) -> np.ndarray:
    """Return the temperatures of the nodes at time 0 [K], shape (NODES,): all the oil's that comes in, or all the air's."""
    return np.full(NODES, heat.ambient_temperature if heat.start == "ambient" else inlet)


def fit_gaps(scene: Scene) -> tuple[float, float]:
    """Return the mean play of the fits on the shaft and in the housing [m], on the drawing; 0 where there is none, or no fit is given."""
    size, mounting = boundary_dimensions(scene.bearing), scene.mounting
    limits = shaft_interference(mounting.shaft, 2.0 * size.bore_radius), housing_interference(mounting.housing, 2.0 * size.outside_radius)
    return tuple(0.0 if each is None else max(-0.5 * each.mean, 0.0) for each in limits)
