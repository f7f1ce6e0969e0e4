# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks against formulas that are solved by hand: contour, elasticity, oil films and baths, load distribution, life, heat, sensitivity indices."""

import math

import numpy as np
from scipy import stats

from bearing_sim.model.oil import OilState
from bearing_sim.model.params import lubricate, pack
from bearing_sim.model.thermal_network import POWERS, thermal_network
from bearing_sim.physics.drag import bath_moment
from bearing_sim.physics.film import DOWSON_HIGGINSON, DOWSON_TOYODA, films
from bearing_sim.physics.land import land_torque
from bearing_sim.physics.layers import Layer, State, contact_pressures, displacement, hoop_stress
from bearing_sim.physics.raceway import TABLE_INTERVALS, contour_at, tabulated
from bearing_sim.physics.rating_life import modification_factor, rating_life_revolutions
from bearing_sim.physics.thermal_network import LINK, NODE, NODES, NetworkInputs, new_work, step
from bearing_sim.scene.bearing import OuterRaceway
from bearing_sim.scene.contour import outer_contour
from bearing_sim.scene.loader import load_scene, scene_from_yaml
from bearing_sim.simulation import Simulation
from bearing_sim.studies.statics import statics
from bearing_sim.studies.uncertainty_propagation import design, indices
from validation.catalogues import KOYO, koyo_scene
from validation.check import Check, Comparison, compared

GROUP = "Closed forms"
_RPM = math.pi / 30
_STEEL = (2.06e11, 0.3, 7850.0, 1.2e-5)  # Young's modulus, Poisson's ratio, density, expansion


def _contour() -> list[Comparison]:
    raceway = OuterRaceway(low_radius=34.86e-3, d_value=0.098e-3, lobes=3, installation_angle=0.3)
    table = tabulated(lambda at: outer_contour(raceway, at))
    azimuths = np.linspace(0.0, 2 * math.pi, 3600, endpoint=False)
    found = [contour_at(table, azimuth / (2 * math.pi) * TABLE_INTERVALS)[0] for azimuth in azimuths]
    expected = 34.86e-3 + 0.049e-3 * (1.0 - np.cos(3 * (azimuths - 0.3)))
    quantity = "radius of a trilobe raceway at 3600 azimuths"
    return [compared(quantity, "Deng 2017, eq. 2", 1e6 * expected, 1e6 * np.array(found), unit="um", absolute=1e-5, digits=8)]


def _rotating_rings() -> list[Comparison]:
    omega, (modulus, nu, density, _) = 4712.0, _STEEL
    disc, ring = Layer(0.0, 25e-3, *_STEEL), Layer(15e-3, 25e-3, *_STEEL)
    thin = Layer(26.4e-3, 26.4e-3 * (1 + 1e-7), *_STEEL)
    turning = State(square_speed=omega**2)
    grown = (1 - nu) * density * omega**2 * 25e-3**3 / (4 * modulus), density * omega**2 * 26.4e-3**3 / modulus
    found = displacement(disc, 25e-3, turning), displacement(thin, 26.4e-3, turning)
    stress = density * omega**2 / 4 * ((3 + nu) * 25e-3**2 + (1 - nu) * 15e-3**2)
    source = "theory of elasticity, plane stress"
    return [
        compared(
            "growth of a disc of 25 mm and of a thin ring of 26.4 mm radius at 45,000 rpm",
            source,
            *(1e6 * np.array(each) for each in (grown, found)),
            unit="um",
            relative=1e-6,
        ),
        compared(
            "hoop stress at the bore of a disc of 15 and 25 mm radius",
            source,
            1e-6 * stress,
            1e-6 * hoop_stress(ring, 15e-3, turning),
            unit="MPa",
            relative=1e-10,
        ),
    ]


def _shrink_fits() -> list[Comparison]:
    ring, expected, found = Layer(25e-3, 27.875e-3, *_STEEL), [], []
    for bore in (0.0, 15e-3):
        a, b, c = bore, 25e-3, 27.875e-3
        expected.append(2.06e11 * 20e-6 / (2 * b) / ((b * b + a * a) / (b * b - a * a) + (c * c + b * b) / (c * c - b * b)))
        found.append(contact_pressures((Layer(bore, 25e-3, *_STEEL), ring), (20e-6,), (0.0, 0.0), (0.0, 0.0))[0])
    quantity = "pressure of a fit with 20 um of interference, on a solid and on a hollow shaft"
    return [compared(quantity, "Lamé's equations, as in handbooks", 1e-6 * np.array(expected), 1e-6 * np.array(found), unit="MPa", relative=1e-10)]


def _oil_between_cage_and_land() -> list[Comparison]:
    scene = load_scene("deng2017_table1")
    params = pack(scene)
    lubrication = lubricate(scene.lubricant, params, 393.15)._replace(viscosity=2e-3)
    found = [-land_torque(2000.0, 0.0, eccentricity, lubrication, params.cage)[0] for eccentricity in (0.0, 0.8)]
    central = 2 * math.pi * 2e-3 * 2000 * 33.5e-3**3 * 5e-3 / 0.15e-3
    quantity = "torque of a land of the paper's cage at 2000 rad/s, central and 0.8 eccentric"
    return [compared(quantity, "Petroff; 1/sqrt(1 - e^2) of it", (central, central / 0.6), found, unit="N m", relative=1e-10)]


def _oil_bath() -> list[Comparison]:
    # by hand, NU 210 at 9000 rpm and 12 mm2/s with oil to the middle of the lowest roller: H/d_m 5.5/70, V_M 7.97e-5, K_roll 1.160e-11,
    # l_D 0.9286, C_w 0.6618, t 1.0356, f_t 0.4948, f_A 0.8925, R_s 276.2 mm2, Reynolds number 1.8187e6
    displacing = 4 * 7.97e-5 * 1.160e-11 * 0.6618 * 20 * 70**4 * 9000**2 * 1e-3
    rubbing = 1.093e-7 * 9000**2 * 70**3 * 1.8187e6**-1.379 * 276.2 * 1e-3
    found = bath_moment(5.5e-3, 9000 * _RPM, 12e-6, bore_diameter=50e-3, outside_diameter=90e-3, width=20e-3)
    quantity = "both moments of an oil bath, NU 210 at 9000 rpm"
    return [compared(quantity, "SKF's formula, worked by hand", (displacing, rubbing), found, unit="N m", relative=2e-3)]


def _film(law, speed: float, material: float, load: float) -> float:
    """Return h/R for U, G and W, of a contact that has 1 for everything else."""
    oil = OilState(temperature=1.0, viscosity=speed, density=1.0, pressure_viscosity=material, conductivity=1.0, temperature_viscosity=1e-300 / speed)
    return float(films(law, oil, 1.0, 1.0, 1.0, np.array(load), np.array(1.0), np.array(0.0)))


def _film_thickness() -> list[Comparison]:
    material, points = 5000.0, [(speed, load) for speed in (3e-12, 1e-11, 5e-11) for load in (2e-5, 5e-5)]
    least, middle = ([_film(law, speed, material, load) for speed, load in points] for law in (DOWSON_HIGGINSON, DOWSON_TOYODA))
    theirs = [1.714 * load**-0.128 * speed**0.694 * material**0.568 for speed, load in points]
    theirs_middle = [2.922 * load**-0.166 * speed**0.692 * material**0.470 for speed, load in points]
    source = "Pan and Hamrock 1989, another numerical solution"
    return [
        compared("least film h/R of a line contact at six speeds and loads", source, theirs, least, relative=0.1),
        compared("film in the middle, likewise", source, theirs_middle, middle, relative=0.3),
    ]


def _heaviest_roller() -> list[Comparison]:
    # half of the circumference loaded; 0.2453 is the radial integral of line contact
    found, expected = [], []
    for name in ("NU 205", "NU 210", "NU 215", "NU 232"):
        straight = koyo_scene(name).replace(" mm}\n  cage", " mm, crown: none}\n  cage")
        found.append(float(statics(scene_from_yaml(straight), 40).inner.max()))
        expected.append(100 * KOYO[name][5] / (KOYO[name][3] * 0.2453))
    quantity = "load of the heaviest roller of four bearings without clearance; the integral is over a continuum of rollers"
    return [compared(quantity, "Harris, Rolling Bearing Analysis, table 7.1", expected, found, unit="N", relative=0.02)]


def _modified_life() -> list[Comparison]:
    # kappa = 1: 1.5859 - 1.2348 = 0.3511, times 0.1^0.4 = 0.139775: 0.1 (1 - 0.139775)^-9.185 = 0.39862; the others likewise
    by_hand = {
        (1.0, 0.1): 0.39862,
        (1.0, 1.0): 5.3109,
        (0.4, 0.5): 0.23126,
        (2.0, 0.2): 0.93369,
        (0.2, 1.0): 0.17415,
        (4.0, 5.0): 50.0,
        (0.1, 5.0): 0.1,
    }
    life = pack(load_scene("deng2017_table1")).life
    halved = rating_life_revolutions(900.0, 1100.0, life) / rating_life_revolutions(1800.0, 2200.0, life)
    return [
        compared(
            "a_ISO at seven viscosity ratios and loads",
            "ISO 281:2007, worked by hand",
            list(by_hand.values()),
            [modification_factor(*at) for at in by_hand],
            relative=1e-4,
        ),
        compared("life under half of the loads", "2^4, ISO/TS 16281", 16.0, halved, relative=1e-12),
    ]


def _thermal_nodes() -> list[Comparison]:
    found = [
        _left_after_a_time_constant(*each)
        for each in (("housing", "housing_ambient", 293.15), ("shaft", "shaft_ambient", 293.15), ("oil", "oil_flow", 353.15))
    ]
    quantity = "fraction of a temperature difference that is left after one time constant: housing, shaft, oil"
    return [compared(quantity, "exp(-1)", [math.exp(-1.0)] * 3, found, relative=1e-6, digits=7)]


def _left_after_a_time_constant(node: str, link: str, end: float) -> float:
    """Return the fraction of a node's difference in temperature that is left if one conductance, to a temperature ``end`` [K], is all there is."""
    conductances = [f"heat.conductances.{name}={2.5 if name == link else 0.0}" for name in LINK._fields]
    scene = load_scene("deng2017_table1", ["heat.law=network", *conductances])
    network, place, temperatures, work = thermal_network(scene, pack(scene)), getattr(NODE, node), np.full(NODES, 400.0), new_work()
    inputs = NetworkInputs(3000.0, 1350.0, 353.15, 1e7, 0.0, 0.0, 1e-5)
    loads, losses, steps = np.zeros((2, scene.bearing.roller.count)), np.zeros(len(POWERS)), 4000
    for _ in range(steps):
        step(network.capacities[place] / 2.5 / steps, temperatures, losses, loads, inputs, network, work)
    return float((temperatures[place] - end) / (400.0 - end))


def _ideal_rolling() -> list[Comparison]:
    free = ["lubricant.mixture_fraction=0", "bearing.cage.guide_land_width=1 um", "bearing.cage.pocket_friction=0"]
    scene = load_scene("deng2017_table1", [*free, "bearing.outer_raceway.low_radius=34.86 mm", "lubricant.traction_scale=5"])
    slip = 100.0 * float(Simulation(scene).advance(0.05)["cage_slip"][0])
    return [compared("cage slip where nothing drags", "epicyclic kinematics", 0.0, slip, unit="%", absolute=0.02)]


def _sensitivity_indices() -> list[Comparison]:
    a, b = 7.0, 0.1
    drawn = design([stats.uniform(-math.pi, 2 * math.pi)] * 3, 2048, seed=1)
    x = drawn.points.T
    found = indices(np.sin(x[0]) + a * np.sin(x[1]) ** 2 + b * x[2] ** 4 * np.sin(x[0]), 2048, seed=1)
    first = np.array([0.5 * (1 + b * math.pi**4 / 5) ** 2, a**2 / 8, 0.0])
    third = 8 * b**2 * math.pi**8 / 225
    variance = first.sum() + third
    expected = [*(first / variance), *((first + [third, 0.0, third]) / variance)]
    quantity = "first and total Sobol indices of the Ishigami function, 2048 samples"
    return [compared(quantity, "Ishigami and Homma 1990", expected, [*found.first, *found.total], absolute=0.03, digits=3)]


CHECKS = (
    Check("contour", GROUP, _contour),
    Check("rotating_rings", GROUP, _rotating_rings),
    Check("shrink_fits", GROUP, _shrink_fits),
    Check("oil_between_cage_and_land", GROUP, _oil_between_cage_and_land),
    Check("oil_bath", GROUP, _oil_bath),
    Check("film_thickness", GROUP, _film_thickness),
    Check("heaviest_roller", GROUP, _heaviest_roller),
    Check("modified_life", GROUP, _modified_life),
    Check("thermal_nodes", GROUP, _thermal_nodes),
    Check("ideal_rolling", GROUP, _ideal_rolling),
    Check("sensitivity_indices", GROUP, _sensitivity_indices),
)
