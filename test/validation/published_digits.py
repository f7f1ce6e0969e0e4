# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks against digits that others have printed: lamina codes, standards, textbooks, measured properties of oils."""

import math

import numpy as np

from bearing_sim.levels.common.slice_balance import balance, roller_loads
from bearing_sim.model.oil import class_pressure_viscosity, oil_at, specific_heat, thermal_conductivity
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics import heat
from bearing_sim.physics.contact import CONTACT, line_contact_stiffness
from bearing_sim.physics.lamina_life import add_lamina_powers, equivalent_lamina_loads, stress_risers
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.rating_life import OilFactors, rate_lives, reliability_factor, ring_ratings
from bearing_sim.physics.traction import traction
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.mounting import clearance_limits, tolerance_limits
from bearing_sim.scene.ratings import load_rating
from bearing_sim.scene.viscosity_index import reference_viscosities, viscosity_index
from bearing_sim.studies.machining import Blank, Pressing, machine
from validation.check import Check, Comparison, compared

GROUP = "Published digits"
_ZERO = 273.15
_AT_REST = (0.0, 0.0)
_LAMINA_CODE = "independent lamina code for ISO/TS 16281"  # the public repository minzhun/ISO16281, its stress risers of the outer ring corrected
_INCROPERA = "Incropera and DeWitt, Fundamentals of Heat and Mass Transfer"


def round_bearing(count, diameter, pitch, length, clearance, *overrides, slices=40, crown="none"):
    """Return the parameters of a round bearing with ISO's spring constant.

    Parameters
    ----------
    count : of the rollers.
    diameter, pitch, length : of rollers and of their pitch circle [mm].
    clearance : the radial one, on the diameter [mm].
    overrides : of further fields of the scene.
    slices : of each roller.
    crown : law of the rollers' profile.
    """
    inner = pitch / 2 - diameter / 2
    overrides = [
        "level=spatial",
        f"bearing.roller={{count: {count}, diameter: {diameter} mm, length: {length} mm, slices: {slices}, crown: {crown}}}",
        f"bearing.inner_raceway.radius={inner} mm",
        "bearing.inner_raceway.bore_radius=null",
        f"bearing.outer_raceway={{low_radius: {inner + diameter + clearance / 2} mm, d_value: 0 mm}}",
        f"bearing.cage.guide_radius={pitch / 2 + 2} mm",
        f"bearing.cage.inner_radius={pitch / 2 - 1} mm",
        "bearing.contact.spring=iso",
        *overrides,
    ]
    return pack(load_scene("deng2017_table1", overrides))


def _load_distributions() -> list[Comparison]:
    straight = balance(round_bearing(18, 7, 62.75, 7, 0.02), *_AT_REST, (800.0, 0.0))
    crowned = balance(round_bearing(18, 7, 62.75, 7, 0.02, crown="iso_log"), *_AT_REST, (800.0, 0.0))
    # ISO/TS 16281 counts the tilt the other way round, hence the sign
    tilted = balance(round_bearing(6, 9, 43.5, 13.6, 0.01, crown="iso_log"), *_AT_REST, (1000.0, 0.0), (0.0, 1.0))
    largest = [float(roller_loads(each)[0].max()) for each in (straight, crowned, tilted)]
    micrometres = [1e6 * float(each.ring[0]) for each in (straight, crowned, tilted)]
    three = "18 straight rollers; with ISO's logarithmic profile; 6 crowned rollers under 1 N m"
    return [
        compared(
            f"displacement of the ring: {three}", _LAMINA_CODE, (13.142634, 14.853279, 12.228586), micrometres, unit="um", relative=1e-5, digits=8
        ),
        compared(f"largest load of a roller: {three}", _LAMINA_CODE, (335.8060, 307.010084, 941.779289), largest, unit="N", relative=1e-5, digits=7),
        compared(
            "loads of the three rollers of 18 next to the load line",
            _LAMINA_CODE,
            (335.8060, 243.1335, 4.7338),
            roller_loads(straight)[0][:3],
            unit="N",
            absolute=1e-4,
            digits=7,
        ),
        compared("tilt of the ring, 6 crowned rollers", _LAMINA_CODE, -0.514342, -1e3 * float(tilted.ring[3]), unit="mrad", relative=1e-5, digits=6),
    ]


_REFERENCE_LIVES = (  # bearing; load [N], C [N], laminae, crown; L10r [million revolutions], P_ref [N]
    ((18, 7, 62.75, 7, 0.02), 800.0, 25e3, 40, "iso_log", 110_512.56, 767.214),
    ((18, 7, 62.75, 7, 0.02), 800.0, 25e3, 40, "none", 118_150.16, 751.986),
    ((12, 10, 60, 10, 0.0184), 3000.0, 40e3, 31, "none", 8_868.00, 2_616.449),
)


def _reference_lives() -> list[Comparison]:
    lives = []
    for bearing, load, rating, slices, crown, *_ in _REFERENCE_LIVES:
        own = f"life.laminae={slices}", f"bearing.ratings.dynamic={rating} N"
        params = round_bearing(*bearing, *own, slices=slices, crown=crown)
        at, inner, outer = balance(params, *_AT_REST, (load, 0.0)), np.zeros(slices), np.zeros(slices)
        add_lamina_powers(at.inner, at.outer, stress_risers(slices), 1.0, inner, outer)
        oil = OilFactors(1.0, math.nan)
        lives.append(rate_lives(load, equivalent_lamina_loads(0.0, 0.0, inner, outer, oil, params.life), oil, params.life))
    expected, references = ([case[column] for case in _REFERENCE_LIVES] for column in (5, 6))
    found = [1e-6 * each.l10r for each in lives]
    return [
        compared("L10r of three bearings", _LAMINA_CODE, expected, found, unit="million revolutions", relative=1e-5, digits=8),
        compared(
            "reference load of three bearings", _LAMINA_CODE, references, [each.reference_load for each in lives], unit="N", relative=1e-5, digits=7
        ),
    ]


def _ratings_of_the_paper() -> list[Comparison]:
    gamma = 7 / 62.75
    dynamic = load_rating(18, 7e-3, 7e-3, gamma)
    source = "ISO 281 and ISO/TS 16281, worked by hand"
    return [
        compared("C_r of the bearing of Deng 2017, table 1", source, 30.2, 1e-3 * dynamic, unit="kN", relative=1e-3),
        compared("its ratings of the rings, Q_ci and Q_ce", source, (5681, 7646), ring_ratings(dynamic, 18, gamma), unit="N", relative=1e-4),
    ]


_RELIABILITY = {0.9: 1, 0.95: 0.64, 0.96: 0.55, 0.97: 0.47, 0.98: 0.37, 0.99: 0.25, 0.992: 0.22, 0.994: 0.19, 0.996: 0.16, 0.998: 0.12}
_HIGH_RELIABILITY = {0.999: 0.093, 0.9992: 0.087, 0.9994: 0.080, 0.9995: 0.077}


def _reliability_factors() -> list[Comparison]:
    return [
        compared(
            f"reliability factor a_1 at reliabilities of {min(table)} to {max(table)}",
            "ISO 281:2007, table 12",
            list(table.values()),
            [reliability_factor(reliability) for reliability in table],
            absolute=rounding,
        )
        for table, rounding in ((_RELIABILITY, 0.0051), (_HIGH_RELIABILITY, 0.00051))
    ]


def _traction_of_oil_4109() -> list[Comparison]:
    scene = load_scene("deng2017_table1")
    lubrication, load, rolling = lubricate(scene.lubricant, pack(scene), 393.15), 1000.0, 73.0
    found = []
    for slide_to_roll in (0.01, 0.05, 0.2):
        contacts = np.zeros((2, len(CONTACT), LANES))
        contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding], contacts[:, CONTACT.load] = rolling, slide_to_roll * rolling, load
        traction(contacts, lubrication.inner, lubrication.outer, FULL_FILMS)
        found.append(float(contacts[0, CONTACT.force, 0]) / load)
    quantity = "coefficient of traction of 4109 oil at 1000 N, 73 m/s, slide-to-roll ratios of 0.01, 0.05, 0.2"
    return [compared(quantity, "Wang's fit, two digits", (0.0013, 0.0052, 0.0094), found, absolute=0.6e-4, digits=2)]


def _viscosities() -> list[Comparison]:
    found = []
    for oil, kelvin in (("mil_l_7808", 393.15), ("mil_l_23699", 373.15)):
        found.append(1e3 * oil_at(load_scene("deng2017_table1", [f"lubricant.oil={oil}"]).lubricant.oil, kelvin).viscosity)
    quantity = "viscosity of MIL-L-7808 at 120 degC and of MIL-L-23699 at 100 degC"
    return [compared(quantity, "published fits of viscosity and density", (2.09, 5.01), found, unit="mPa s", relative=2e-3, digits=3)]


def _viscosity_index() -> list[Comparison]:
    examples = ((73.30, 8.86, 92), (22.83, 5.05, 156), (53.47, 7.80, 111))
    table = {2.0: (7.994, 6.394), 5.0: (40.23, 28.49), 10.0: (147.7, 82.87), 20.0: (493.2, 229.5)}
    found = [viscosity_index(at_40, at_100) for at_40, at_100, _ in examples]
    references = [number for viscosity in table for number in reference_viscosities(viscosity)]
    expected = [number for pair in table.values() for number in pair]
    return [
        compared("viscosity index of three oils", "ASTM D2270, examples", [index for *_, index in examples], found, absolute=0.5),
        compared("reference viscosities L and H at 2, 5, 10, 20 mm2/s", "ASTM D2270, table", expected, references, unit="mm2/s", relative=1e-3),
    ]


_PRESSURE_VISCOSITY = ((153, 34, 9.1), (250, 50.5, 12.6), (18.6, 6.3, 2.4)), ((23.7, 20.5, 15.8), (25.0, 21.3, 17.6), (20, 16, 13))


def _properties_of_oils() -> list[Comparison]:
    viscosities, coefficients = _PRESSURE_VISCOSITY
    alphas = [1e9 * class_pressure_viscosity("mineral", 1e-6 * each / 0.87) for oil in viscosities for each in oil]
    motor = {
        "name": "motor",
        "bearing": "NU 210",
        "lubricant": {"oil": "ISO VG 220"},
        "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
    }
    oil, at = load_scene(motor).lubricant.oil, (20.0 + _ZERO, 80.0 + _ZERO)
    book = f"{_INCROPERA}, table A.5, engine oil"
    return [
        compared(
            "pressure-viscosity coefficient of three mineral oils at 30, 60, 100 degC; the law's is a mean up to 0.2 GPa and lower",
            "Stachowiak and Batchelor, Engineering Tribology, table 2.3",
            [each for oil in coefficients for each in oil],
            alphas,
            unit="1/GPa",
            relative=0.27,
        ),
        compared(
            "density of mineral oil at 20 and 80 degC", book, (888, 852), [oil_at(oil, each).density for each in at], unit="kg/m3", relative=0.01
        ),
        compared("specific heat, likewise", book, (1880, 2131), [specific_heat(oil, each) for each in at], unit="J/(kg K)", relative=0.05),
        compared("conductivity, likewise", book, (0.145, 0.138), [thermal_conductivity(oil, each) for each in at], unit="W/(m K)", relative=0.15),
    ]


_AIR = ((250.0, 11.44, 22.3), (300.0, 15.89, 26.3), (350.0, 20.92, 30.0), (400.0, 26.41, 33.8))  # K, 1e-6 m2/s, 1e-3 W/(m K)


def _air_and_convection() -> list[Comparison]:
    air = [heat.air_at(kelvin) for kelvin, *_ in _AIR]
    table, at = f"{_INCROPERA}, table A.4", "at 250, 300, 350, 400 K"
    return [
        compared(
            f"kinematic viscosity of air {at}", table, [row[1] for row in _AIR], [1e6 * each.viscosity for each in air], unit="mm2/s", relative=0.02
        ),
        compared(
            f"conductivity of air {at}", table, [row[2] for row in _AIR], [1e3 * each.conductivity for each in air], unit="mW/(m K)", relative=0.02
        ),
        compared(
            "natural convection at a horizontal pipe of 0.1 m, 165 degC in air of 23 degC",
            f"{_INCROPERA}, example 9.4",
            7.29,
            heat.natural_convection_coefficient(438.15, 296.15, 0.1),
            unit="W/(m2 K)",
            relative=0.02,
        ),
    ]


def _palmgrens_stiffness() -> list[Comparison]:
    found = line_contact_stiffness(7e-3, 2.06e11, 0.3) / 1000 ** (10 / 9)
    return [compared("stiffness of a steel roller of 7 mm", "Palmgren", 4.535e5, found, unit="N/mm^(10/9)", relative=1e-3)]


_LIMITS = (  # class, diameter [mm], limits [um]
    *(("k5", 50, 2, 13), ("k6", 80, 2, 21), ("m6", 100, 13, 35), ("n6", 140, 27, 52), ("p6", 200, 50, 79), ("r6", 150, 65, 90)),
    *(("j6", 110, -9, 13), ("h6", 50, -16, 0), ("g6", 50, -25, -9), ("H7", 90, 0, 35), ("J7", 90, -13, 22), ("K7", 72, -21, 9)),
    *(("M7", 72, -30, 0), ("N7", 72, -39, -9), ("P7", 72, -51, -21), ("G7", 90, 12, 47), ("F7", 90, 36, 71)),
)


def _fits_and_clearances() -> list[Comparison]:
    expected = [limit for *_, least, largest in _LIMITS for limit in (least, largest)]
    found = [1e6 * limit for name, diameter, *_ in _LIMITS for limit in tolerance_limits(name, 1e-3 * diameter)]
    groups = [1e6 * limit for group, bore in (("CN", 50e-3), ("C3", 160e-3)) for limit in clearance_limits(group, bore)]
    return [
        compared(f"limits of {len(_LIMITS)} tolerance classes", "ISO 286-2, as makers print it", expected, found, unit="um", absolute=1e-3),
        compared("clearance CN of 50 mm bore and C3 of 160 mm", "ISO 5753-1", (30, 60, 115, 165), groups, unit="um", absolute=1e-3),
    ]


def _machined_raceway() -> list[Comparison]:
    section = Blank(mean_radius=35.8e-3, width=12e-3, thickness=3.4e-3, modulus=2.06e11)
    found = machine(section, Pressing(2e6), low_radius=34.8625e-3)
    quantity = "D of a raceway machined under 2 MPa; the ring's equivalent thickness is given to two digits, and D goes with its cube"
    return [compared(quantity, "Deng 2017, Fig. 3, by finite elements", 0.098, 1e3 * found.d_value, unit="mm", relative=0.03)]


CHECKS = (
    Check("load_distributions", GROUP, _load_distributions),
    Check("reference_lives", GROUP, _reference_lives),
    Check("ratings_of_the_paper", GROUP, _ratings_of_the_paper),
    Check("reliability_factors", GROUP, _reliability_factors),
    Check("traction_of_oil_4109", GROUP, _traction_of_oil_4109),
    Check("viscosities", GROUP, _viscosities),
    Check("viscosity_index", GROUP, _viscosity_index),
    Check("properties_of_oils", GROUP, _properties_of_oils),
    Check("air_and_convection", GROUP, _air_and_convection),
    Check("palmgrens_stiffness", GROUP, _palmgrens_stiffness),
    Check("fits_and_clearances", GROUP, _fits_and_clearances),
    Check("machined_raceway", GROUP, _machined_raceway),
)
