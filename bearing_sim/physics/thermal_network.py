# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lumped temperatures of a bearing: six nodes, their conductances, and a step of any length that keeps the books of energy.

    C_i dT_i/dt = P_i + sum_j G_ij (T_j - T_i) + G_io (T_boundary - T_i)

Nodes: shaft, inner ring, rollers with cage, outer ring, housing, and the oil in the bearing, which is mixed, so that it leaves with
its temperature.  Boundaries: the oil that comes in, the ambient air, and the ends of the shaft whose temperatures are given.  Conductances follow
`bearing_sim.physics.heat`; those of contacts, convection and air change with speeds, loads and temperatures and are held within a step.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.linear_algebra import back_substitute, decompose
from bearing_sim.physics.heat import (
    cylinder_conductance,
    film_conductance,
    film_in_the_middle,
    fin_conductance,
    fit_coefficient,
    flow_conductance,
    held_fin_conductances,
    hertz_half_width,
    in_series,
    mean_radius,
    moving_air_coefficient,
    moving_contact_conductance,
    oil_coefficient,
    radiation_coefficient,
    rotating_shaft_coefficient,
)

NODES = 6
_LOADED_FROM = 1.0  # N; a contact that carries less passes no heat
_SLOWEST = 1e-3  # m/s; a contact at rest has no film of its own speed: it keeps the one of a creeping roller
_STAGE = 1.0 - math.sqrt(0.5)  # gamma of the method
_ROUNDS = 60  # of the steady state
_AGREED = 1e-9  # K


class Node(NamedTuple):
    """Places of the nodes."""

    shaft: int = 0
    inner_ring: int = 1
    rollers: int = 2  # and the cage
    outer_ring: int = 3
    housing: int = 4
    oil: int = 5


NODE = Node()


class Link(NamedTuple):
    """Places of the conductances, by the names of `bearing_sim.scene.heat.Conductances`."""

    shaft_inner_ring: int = 0
    inner_ring_rollers: int = 1
    rollers_outer_ring: int = 2
    outer_ring_housing: int = 3
    inner_ring_oil: int = 4
    rollers_oil: int = 5
    outer_ring_oil: int = 6
    housing_oil: int = 7
    oil_flow: int = 8  # from here on to a boundary
    housing_ambient: int = 9
    shaft_ambient: int = 10
    shaft_front: int = 11  # to an end of given temperature; 0 where the end is free
    shaft_back: int = 12


LINK = Link()
LINKS = len(LINK)
# The nodes that each link joins; a boundary is -1, the oil that comes in, -2, the ambient air, -3 or -4, the front or the back end of the shaft.
ENDS = np.array([(0, 1), (1, 2), (2, 3), (3, 4), (1, 5), (2, 5), (3, 5), (4, 5), (5, -1), (4, -2), (0, -2), (0, -3), (0, -4)], np.int64)
BOUNDARIES = 4


class Contacts(NamedTuple):
    """Rollers and raceways as far as heat passes their contacts."""

    count: int  # Z
    roller_radius: float  # R_w [m]
    length: float  # L [m]
    inner_curvature_radius: float  # [m]
    outer_curvature_radius: float
    inner_radius: float  # R_i [m]
    outer_radius: float  # mean radius of the outer raceway [m]
    reduced_modulus: float  # E' [Pa]
    conductivity: float  # of rings and rollers [W/(m K)]
    diffusivity: float  # [m^2/s]


class Bodies(NamedTuple):
    """Rings, shaft and housing."""

    bore_radius: float  # of the inner ring [m]
    outside_radius: float  # of the outer ring [m]
    width: float  # B of both [m]
    shaft_bore: float  # radius of the shaft's bore [m]; 0: solid
    housing_radius: float  # outside of the housing, as a cylinder [m]
    conductivity: float  # of the rings [W/(m K)]
    shaft_conductivity: float
    housing_conductivity: float
    shaft_roughness: float  # of the fit on the shaft, R_q of both surfaces together [m]
    housing_roughness: float
    hardness: float  # of the softer surface of a fit [Pa]


class Surfaces(NamedTuple):
    """What gives off heat to the oil and to the air."""

    inner_ring: float  # area that the oil wets [m^2]
    rollers: float
    outer_ring: float
    housing_inside: float
    housing: float  # area to the air [m^2]
    housing_emissivity: float
    air_speed: float  # of the air across it [m/s]
    front: float  # length of the shaft before the bearing [m]
    back: float
    shaft_emissivity: float
    oil_to_housing: float  # [W/(m^2 K)]
    convection_factor: float
    oil_flow: float  # [m^3/s]


class Oils(NamedTuple):
    """The oil by temperature: a table in even steps."""

    first: float  # temperature of the first row [K]
    step: float  # [K]
    rows: np.ndarray  # ln nu, density, specific heat, ln alpha, shape (n, 4)
    conductivity: float  # [W/(m K)]


class Network(NamedTuple):
    """The network of a bearing; everything but the temperatures."""

    contacts: Contacts
    bodies: Bodies
    surfaces: Surfaces
    oils: Oils
    given: np.ndarray  # conductances that are known [W/K], NaN where they are computed, shape (LINKS,)
    capacities: np.ndarray  # heat capacities of the nodes [J/K], shape (NODES,)
    partition: np.ndarray  # fraction of each power, in the order of the observables, that goes to each node, shape (powers, NODES)
    ambient: float  # temperature of the air [K]
    front: float  # temperature of the front end of the shaft [K]; NaN: a free end
    back: float


class NetworkInputs(NamedTuple):
    """What drives the network besides the losses, means over a step."""

    shaft_speed: float  # [rad/s]
    cage_speed: float
    inlet: float  # temperature of the oil that comes in [K]
    inner_fit_pressure: float  # [Pa]; 0 where loose
    inner_fit_gap: float  # mean play [m]; 0 where tight
    outer_fit_pressure: float
    outer_fit_gap: float


class Work(NamedTuple):
    """Memory that a step writes."""

    conductances: np.ndarray  # [W/K], shape (LINKS,)
    matrix: np.ndarray  # shape (NODES, NODES)
    balance: np.ndarray  # the same before it is decomposed [W/K], shape (NODES, NODES)
    order: np.ndarray  # int64, shape (NODES,)
    source: np.ndarray  # heat and what comes from the boundaries [W], shape (NODES,)
    boundaries: np.ndarray  # temperatures of the boundaries [K], shape (BOUNDARIES,)
    stages: np.ndarray  # flows of heat into each node at both stages [W], shape (2, NODES)
    between: np.ndarray  # temperatures [K], shape (NODES,)
    heat: np.ndarray  # into each node [W], shape (NODES,)
    books: np.ndarray  # of the last step [J]: see `BOOK`, shape (4,)


class Book(NamedTuple):
    """Places of the books of energy."""

    losses: int = 0  # heat from the losses
    to_oil: int = 1  # taken along by the oil that flows through
    to_ambient: int = 2  # given off through housing and shaft
    stored: int = 3  # in the nodes


BOOK = Book()


def new_work() -> Work:
    """Return zeroed memory."""
    return Work(
        np.zeros(LINKS),
        np.zeros((NODES, NODES)),
        np.zeros((NODES, NODES)),
        np.zeros(NODES, np.int64),
        np.zeros(NODES),
        np.zeros(BOUNDARIES),
        np.zeros((2, NODES)),
        np.zeros(NODES),
        np.zeros(NODES),
        np.zeros(len(BOOK)),
    )


class HeatCourse(NamedTuple):
    """A thermal network that advances along a course of inputs; arrays are changed in place.  See `bearing_sim.levels.common.thermal_state`."""

    network: Network
    work: Work
    temperatures: np.ndarray  # of the nodes [K], shape (NODES,)
    losses: np.ndarray  # by cause since the last step [J], shape (powers,)
    loads: np.ndarray  # of the newest step, inner and outer [N], shape (2, Z)
    since: np.ndarray  # time since the last step [s], and the angles of shaft and cage then [rad], shape (3,)
    seats: np.ndarray  # pressure and mean play of the fits on shaft and in housing, shape (4,)
    gaps: tuple[float, float]  # play of both fits where they are loose [m]
    flows: np.ndarray  # heat to oil and ambient over the last step [W], shape (2,)
    books: np.ndarray  # of energy since the start [J], shape (4,)
    interval: float  # at least from step to step [s]


@kernel
def oil_properties(temperature, oils):
    """Return kinematic viscosity [m^2/s], density [kg/m^3], specific heat [J/(kg K)] and alpha [1/Pa]; beyond the table as at its end."""
    rows = oils.rows
    place = min(max((temperature - oils.first) / oils.step, 0.0), rows.shape[0] - 1.0)
    row = min(int(place), rows.shape[0] - 2)
    part = place - row
    viscosity = math.exp((1.0 - part) * rows[row, 0] + part * rows[row + 1, 0])
    alpha = math.exp((1.0 - part) * rows[row, 3] + part * rows[row + 1, 3])
    return viscosity, (1.0 - part) * rows[row, 1] + part * rows[row + 1, 1], (1.0 - part) * rows[row, 2] + part * rows[row + 1, 2], alpha


@kernel
def _raceway_conductance(loads, speed, temperature, curvature_radius, contacts, oils):
    """Return the conductance of all contacts of one raceway [W/K]: film and bodies in series, contact by contact."""
    viscosity, density, _, alpha = oil_properties(temperature, oils)
    total, faster = 0.0, max(abs(speed), _SLOWEST)
    for load in loads:
        if load > _LOADED_FROM:
            half = hertz_half_width(load, curvature_radius, contacts.length, contacts.reduced_modulus)
            thickness = film_in_the_middle(viscosity * density, alpha, faster, load, contacts.length, curvature_radius, contacts.reduced_modulus)
            film = film_conductance(oils.conductivity, thickness, half, contacts.length)
            bodies = moving_contact_conductance(contacts.conductivity, contacts.diffusivity, speed, half, contacts.length, contacts.roller_radius)
            total += in_series(film, bodies)
    return total


@kernel
def _fit_conductance(outer, inner, seat, wall, core, coefficient, width):
    """Return the conductance from the mean radius of one cylinder to that of the next, through the seat between both [W/K].

    Parameters
    ----------
    outer, inner : mean radii of the outer and the inner body [m].
    seat : radius of the fit [m].
    wall, core : conductivities of the outer and the inner body [W/(m K)].
    coefficient : of the fit [W/(m^2 K)].
    width : [m].
    """
    touching = coefficient * 2.0 * math.pi * seat * width
    return in_series(in_series(cylinder_conductance(outer, seat, wall, width), touching), cylinder_conductance(seat, inner, core, width))


@kernel
def _shaft_end(fin, length, temperature):
    """Return the conductances of one end of the shaft to the air and to its tip [W/K], whose temperature is NaN if it is free."""
    coefficient, perimeter, conductivity, section = fin
    if math.isnan(temperature):
        return fin_conductance(coefficient, perimeter, conductivity, section, length), 0.0
    return held_fin_conductances(coefficient, perimeter, conductivity, section, length)


@kernel
def write_conductances(temperatures, loads, inputs, network, conductances):
    """Write the conductances at temperatures and loads [W/K]; those that are known replace them.

    Parameters
    ----------
    temperatures : of the nodes [K], shape (NODES,).
    loads : normal forces of inner and outer contacts [N], shape (2, Z).
    inputs : `NetworkInputs`.
    network : `Network`.
    conductances : result, shape (LINKS,).
    """
    contacts, bodies, surfaces, oils, given = network.contacts, network.bodies, network.surfaces, network.oils, network.given
    relative = inputs.shaft_speed - inputs.cage_speed
    inner_film, outer_film = (
        0.5 * (temperatures[NODE.inner_ring] + temperatures[NODE.rollers]),
        0.5 * (temperatures[NODE.outer_ring] + temperatures[NODE.rollers]),
    )
    inner_ring = mean_radius(contacts.inner_radius, bodies.bore_radius)
    outer_ring = mean_radius(bodies.outside_radius, contacts.outer_radius)
    seat = 2.0 * in_series(bodies.conductivity, bodies.shaft_conductivity)  # the harmonic mean
    coefficient = fit_coefficient(seat, oils.conductivity, bodies.shaft_roughness, inputs.inner_fit_pressure, bodies.hardness, inputs.inner_fit_gap)
    conductances[LINK.shaft_inner_ring] = _fit_conductance(
        inner_ring,
        mean_radius(bodies.bore_radius, bodies.shaft_bore),
        bodies.bore_radius,
        bodies.conductivity,
        bodies.shaft_conductivity,
        coefficient,
        bodies.width,
    )
    rolling = _raceway_conductance(loads[0], relative * contacts.inner_radius, inner_film, contacts.inner_curvature_radius, contacts, oils)
    conductances[LINK.inner_ring_rollers] = in_series(
        rolling, cylinder_conductance(contacts.inner_radius, inner_ring, bodies.conductivity, bodies.width)
    )
    rolling = _raceway_conductance(loads[1], inputs.cage_speed * contacts.outer_radius, outer_film, contacts.outer_curvature_radius, contacts, oils)
    conductances[LINK.rollers_outer_ring] = in_series(
        rolling, cylinder_conductance(outer_ring, contacts.outer_radius, bodies.conductivity, bodies.width)
    )
    seat = 2.0 * in_series(bodies.conductivity, bodies.housing_conductivity)
    coefficient = fit_coefficient(seat, oils.conductivity, bodies.housing_roughness, inputs.outer_fit_pressure, bodies.hardness, inputs.outer_fit_gap)
    conductances[LINK.outer_ring_housing] = _fit_conductance(
        mean_radius(bodies.housing_radius, bodies.outside_radius),
        outer_ring,
        bodies.outside_radius,
        bodies.housing_conductivity,
        bodies.conductivity,
        coefficient,
        bodies.width,
    )
    viscosity, density, specific_heat, _ = oil_properties(temperatures[NODE.oil], oils)
    diffusivity = oils.conductivity / (density * specific_heat)
    at_ring = surfaces.convection_factor * oil_coefficient(oils.conductivity, viscosity, diffusivity, relative)
    at_cage = surfaces.convection_factor * oil_coefficient(oils.conductivity, viscosity, diffusivity, inputs.cage_speed)
    conductances[LINK.inner_ring_oil] = at_ring * surfaces.inner_ring
    conductances[LINK.rollers_oil] = at_cage * surfaces.rollers
    conductances[LINK.outer_ring_oil] = at_cage * surfaces.outer_ring
    conductances[LINK.housing_oil] = surfaces.oil_to_housing * surfaces.housing_inside
    middle = oil_properties(0.5 * (temperatures[NODE.oil] + inputs.inlet), oils)
    arriving = oil_properties(inputs.inlet, oils)[1]
    conductances[LINK.oil_flow] = flow_conductance(arriving, middle[2], surfaces.oil_flow)
    air, wall, shaft = network.ambient, temperatures[NODE.housing], temperatures[NODE.shaft]
    coefficient = moving_air_coefficient(wall, air, 2.0 * bodies.housing_radius, surfaces.air_speed)
    conductances[LINK.housing_ambient] = (coefficient + radiation_coefficient(wall, air, surfaces.housing_emissivity)) * surfaces.housing
    coefficient = rotating_shaft_coefficient(shaft, air, 2.0 * bodies.bore_radius, inputs.shaft_speed)
    coefficient += radiation_coefficient(shaft, air, surfaces.shaft_emissivity)
    perimeter, section = 2.0 * math.pi * bodies.bore_radius, math.pi * (bodies.bore_radius**2 - bodies.shaft_bore**2)
    fin = coefficient, perimeter, bodies.shaft_conductivity, section
    front, conductances[LINK.shaft_front] = _shaft_end(fin, surfaces.front, network.front)
    back, conductances[LINK.shaft_back] = _shaft_end(fin, surfaces.back, network.back)
    conductances[LINK.shaft_ambient] = front + back
    for link in range(LINKS):
        if not math.isnan(given[link]):
            conductances[link] = given[link]


@kernel
def _write_boundaries(inlet, network, boundaries):
    """Write the temperatures of the boundaries [K]; a free end of the shaft, to which no heat flows, has that of the air."""
    boundaries[0] = inlet
    boundaries[1] = network.ambient
    boundaries[2] = network.ambient if math.isnan(network.front) else network.front
    boundaries[3] = network.ambient if math.isnan(network.back) else network.back


@kernel
def _write_balance(conductances, boundaries, heat, balance, source):
    """Write G and s of the flows into the nodes, s - G T [W]."""
    for i in range(NODES):
        source[i] = heat[i]
        for j in range(NODES):
            balance[i, j] = 0.0
    for link in range(LINKS):
        conductance, one, other = conductances[link], ENDS[link, 0], ENDS[link, 1]
        balance[one, one] += conductance
        if other < 0:
            source[one] += conductance * boundaries[-1 - other]
        else:
            balance[other, other] += conductance
            balance[one, other] -= conductance
            balance[other, one] -= conductance


@kernel
def write_heat(powers, partition, heat):
    """Write the heat into each node [W] from the powers by cause [W]."""
    for i in range(NODES):
        heat[i] = 0.0
        for k in range(powers.shape[0]):
            heat[i] += partition[k, i] * powers[k]


@kernel
def _heat_given_off(conductances, reached, boundaries):
    """Return the heat at node temperatures that the oil takes along, and that leaves through housing and shaft [W]."""
    to_oil, elsewhere = 0.0, 0.0
    for link in range(LINKS):
        other = ENDS[link, 1]
        if other < 0:
            flow = conductances[link] * (reached[ENDS[link, 0]] - boundaries[-1 - other])
            if other == -1:
                to_oil += flow
            else:
                elsewhere += flow
    return to_oil, elsewhere


@kernel
def step(duration, temperatures, powers, loads, inputs, network, work):
    """Advance the temperatures by a step of any length and write the books of energy into ``work.books``.

    Two stages of a diagonally implicit method of order two, stiffly accurate and L-stable (R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006,
    gamma = 1 - 1/sqrt(2)), with one decomposition: nothing limits the step's length, and what flows between two nodes leaves one and enters the
    other with the same weights, so that the books close to round-off.  Conductances are those at its beginning.

    Parameters
    ----------
    duration : [s].
    temperatures : of the nodes [K], changed in place, shape (NODES,).
    powers : losses by cause [W], means over the step, in the order of the network's partition.
    loads : normal forces of inner and outer contacts [N], shape (2, Z).
    inputs : `NetworkInputs`.
    network : `Network`.
    work : `Work`.
    """
    write_conductances(temperatures, loads, inputs, network, work.conductances)
    write_heat(powers, network.partition, work.heat)
    _write_boundaries(inputs.inlet, network, work.boundaries)
    advance_held(duration, temperatures, network.capacities, work)


@kernel
def advance_held(duration, temperatures, capacities, work):
    """Advance the temperatures by `step`'s method with the conductances, the boundaries and the heat that ``work`` holds."""
    _write_balance(work.conductances, work.boundaries, work.heat, work.balance, work.source)
    for i in range(NODES):
        for j in range(NODES):
            work.matrix[i, j] = _STAGE * duration * work.balance[i, j]
        work.matrix[i, i] += capacities[i]
    decompose(work.order.shape[0], work.matrix, work.order)
    to_oil, to_ambient = 0.0, 0.0
    for stage in range(2):
        for i in range(NODES):
            base = temperatures[i]
            if stage == 1:
                base += (1.0 - _STAGE) * duration * work.stages[0, i] / capacities[i]
            work.between[i] = base
        for i in range(NODES):
            flow = work.source[i]
            for j in range(NODES):
                flow -= work.balance[i, j] * work.between[j]
            work.stages[stage, i] = flow
        # the rate of each stage, C k = s - G (T + gamma dt k)
        back_substitute(work.order.shape[0], work.matrix, work.order, work.stages[stage])
        for i in range(NODES):
            work.between[i] += _STAGE * duration * work.stages[stage, i]
            work.stages[stage, i] *= capacities[i]
        weight = duration * (1.0 - _STAGE if stage == 0 else _STAGE)
        flows = _heat_given_off(work.conductances, work.between, work.boundaries)
        to_oil += weight * flows[0]
        to_ambient += weight * flows[1]
    work.books[BOOK.losses] = 0.0
    work.books[BOOK.stored] = 0.0
    for i in range(NODES):
        gained = duration * ((1.0 - _STAGE) * work.stages[0, i] + _STAGE * work.stages[1, i])
        temperatures[i] += gained / capacities[i]
        work.books[BOOK.losses] += duration * work.heat[i]
        work.books[BOOK.stored] += gained
    work.books[BOOK.to_oil] = to_oil
    work.books[BOOK.to_ambient] = to_ambient


@kernel
def settle(temperatures, powers, loads, inputs, network, held, work):
    """Find the temperatures at which all heat leaves; return whether they were found.

    Conductances follow the temperatures by repeated substitution.

    Parameters
    ----------
    temperatures : first guess and result [K], shape (NODES,).
    powers, loads, inputs, network, work : as of `step`.
    held : 1 for nodes whose temperature stays, else 0, shape (NODES,).
    """
    write_heat(powers, network.partition, work.heat)
    _write_boundaries(inputs.inlet, network, work.boundaries)
    for _ in range(_ROUNDS):
        write_conductances(temperatures, loads, inputs, network, work.conductances)
        _write_balance(work.conductances, work.boundaries, work.heat, work.balance, work.source)
        for i in range(NODES):
            work.between[i] = work.source[i]
            for j in range(NODES):
                work.matrix[i, j] = work.balance[i, j]
            if held[i] == 1.0:
                for j in range(NODES):
                    work.matrix[i, j] = 0.0
                work.matrix[i, i] = 1.0
                work.between[i] = temperatures[i]
        if not decompose(work.order.shape[0], work.matrix, work.order):
            return False
        back_substitute(work.order.shape[0], work.matrix, work.order, work.between)
        change = 0.0
        for i in range(NODES):
            change = max(change, abs(work.between[i] - temperatures[i]))
            temperatures[i] = work.between[i]
        if change < _AGREED:
            return True
    return change < 1e-3


@kernel
def heat_flows(temperatures, inputs, network, work):
    """Return the heat that the oil takes along, and that leaves through housing and shaft [W], with the conductances that ``work`` holds."""
    _write_boundaries(inputs.inlet, network, work.boundaries)
    return _heat_given_off(work.conductances, temperatures, work.boundaries)
