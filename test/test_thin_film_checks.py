# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What thin films are checked with is right itself: inlets against asymptotes and published films, torques against plain formulas."""

import math

import pytest
from validation import thin_films
from validation.check import FAILS, HOLDS, run
from validation.thin_films import (
    CHECKS,
    LARGE,
    SMALL,
    elastic_inlet,
    film_ratio_over_kappa,
    greenwood_tripp_share,
    hamrock_dowson_film,
    law_of,
    rigid_inlet,
    rolling_torque,
    share_at,
)

RPM = math.pi / 30


def verdicts(name):
    return [each.verdict for each in run([check for check in CHECKS if check.name == name])]


def test_the_gap_beside_a_contact_is_that_of_hertz_near_its_edge_and_a_parabola_far_from_it():
    opening = thin_films._opening
    assert opening(math.acosh(1.0 + 1e-4)) == pytest.approx(2 * math.sqrt(2) / 3 * 1e-4**1.5, rel=1e-4)
    assert opening(math.acosh(1e4)) == pytest.approx(0.5 * 1e8, rel=1e-6)


@pytest.mark.parametrize(("speed", "load"), [(1e-12, 5e-5), (1e-11, 5e-5), (1e-11, 3e-4)])
def test_the_full_inlet_gives_the_film_of_grubin(speed, load):
    # 12 G U (R/b)^3 I = 1 where the oil is solid; A. N. Grubin 1949: h/R = 1.95 (G U)^(8/11) W^(-1/11)
    material, half_width = 5000.0, math.sqrt(8 * load / math.pi)
    published = 1.95 * (material * speed) ** (8 / 11) * load ** (-1 / 11)
    film = published / half_width**2
    pressure = 12 * material * speed / half_width**3 * thin_films._elastic_integrals(film, 1e7 * film)[0]
    assert pressure ** (3 / 4) == pytest.approx(1.0, abs=0.05)  # the film goes with the power 3/4 of what builds up


def test_a_full_gap_between_rigid_cylinders_carries_the_load_of_martin():
    assert 24 * thin_films._rigid_integrals(0.5 * math.pi - 1e-9)[0] == pytest.approx(4.896, rel=1e-3)


@pytest.mark.parametrize("inlet", [rigid_inlet, lambda degree: elastic_inlet(0.05, degree)])
def test_less_oil_leaves_less_film_and_still_less_resistance(inlet):
    films, resistances = zip(*(inlet(degree) for degree in (2.0, 5.0, 20.0, 300.0)))
    assert list(films) == sorted(films) and list(resistances) == sorted(resistances)
    assert all(resistance < film < 1.0 for film, resistance in zip(films, resistances))
    assert films[-1] == pytest.approx(1.0, abs=0.01) and resistances[-1] == pytest.approx(1.0, abs=0.12)


def test_two_solutions_for_starved_inlets_agree_with_each_other():
    for degree in (2.0, 5.0, 10.0, 30.0):
        film = elastic_inlet(0.05, degree).film
        assert hamrock_dowson_film(0.05, degree, film) == pytest.approx(film, rel=0.06)


def test_the_degree_of_starvation_and_the_exponent_of_the_package_belong_together():
    for degree in (2.5, 7.0, 40.0):
        found = law_of(degree)
        assert found.film == pytest.approx(1 / (1 + 1 / (0.75 * degree)), rel=1e-9)
        assert found.resistance == pytest.approx((degree**2 + 162.8 * degree) / (degree**2 + 193.1 * degree + 1257), rel=1e-12)


def test_checks_of_starved_inlets_and_of_shares_fail_where_laws_are_others(monkeypatch):
    assert set(verdicts("starved_inlets")) == set(verdicts("asperity_shares")) == {HOLDS}
    monkeypatch.setattr(thin_films, "starved_film", lambda exponent: 1.0)
    monkeypatch.setattr(thin_films, "starved_resistance", lambda exponent: math.exp(-2.0 * exponent))
    assert set(verdicts("starved_inlets")) == {FAILS}
    monkeypatch.setattr(thin_films, "asperity_share", lambda *_: 0.4)
    assert set(verdicts("asperity_shares")) == {FAILS}


def test_shares_are_those_that_publications_print():
    # Greenwood and Tripp's integral and 1 - erf as the public repository sckim-ai/TRB prints them
    for ratio, printed in ((0.75, 0.230), (1.0, 0.131), (1.5, 0.037), (2.0, 0.0088), (3.0, 0.00028)):
        assert greenwood_tripp_share(ratio) == pytest.approx(printed, rel=0.02)
    assert share_at(1.0) == pytest.approx(math.exp(-1.8), rel=1e-9) and share_at(1e-6) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("bearing", "oil", "rpm"), [(SMALL, "_THIN_OIL", 4000), (SMALL, "_THIN_OIL", 1600), (LARGE, "_THICK_OIL", 2000)])
def test_the_torque_of_rolling_is_that_of_plain_formulas(bearing, oil, rpm):
    oil, speed = getattr(thin_films, oil), rpm * RPM
    modulus, radius, outside, inside = 2.06e11 / 0.91, bearing.roller_diameter / 2, bearing.outer_radius, bearing.inner_radius
    cage = speed * inside / (inside + outside)
    rolling, load = cage * outside, bearing.axial_load / bearing.count / math.sin(bearing.outer_angle)
    torque = 0.0
    for side, raceway, angle in ((-1, outside, bearing.outer_angle), (1, inside, bearing.outer_angle - 2 * bearing.roller_angle)):
        effective = 1 / (1 / radius + side * math.cos(angle) / raceway)
        u, g = oil.viscosity * rolling / (modulus * effective), oil.pressure_viscosity * modulus
        w, size = load / bearing.length / (modulus * effective), modulus * effective * bearing.length
        elastic, rigid = 4.318 * size * (g * u) ** 0.658 * w**0.0126 / g, 1.42 * size * math.sqrt(2 * u * w)
        heated = 1 + 0.411483 * (oil.viscosity * oil.temperature_viscosity * rolling**2 / oil.conductivity) ** 0.707071
        force = (elastic**-10 + rigid**-10) ** -0.1 / heated
        torque += bearing.count * force * (raceway + side * effective * math.cos(bearing.outer_angle))
    d, outer = 1e3 * bearing.bore_diameter, 1e3 * bearing.outside_diameter
    left = math.exp(-bearing.constant * 1e6 * oil.viscosity / oil.density * rpm * (d + outer) * math.sqrt(5.1 / (2 * (outer - d))))
    assert rolling_torque(bearing, oil, speed) == pytest.approx(left * torque, rel=3e-3)


def test_the_factor_on_the_film_ratio_is_that_with_which_the_share_falls_as_measured():
    fall, factor = film_ratio_over_kappa(SMALL, thin_films._THIN_OIL, 200 * RPM, 800 * RPM, 0.15)
    low, high = (share_at_speed(rpm) for rpm in (200, 800))
    assert fall == pytest.approx(high / low, rel=1e-9)
    assert (high / low) ** (factor**1.2) == pytest.approx(0.15, rel=1e-9)


def share_at_speed(rpm):
    """Share of asperities in the small bearing by kappa of ISO 281, written out."""
    pitch = 1e3 * (SMALL.outer_radius + SMALL.inner_radius)
    kappa = 8.0 / (45000 * rpm**-0.83 * pitch**-0.5)
    return math.exp(-1.8 * kappa ** (1.2 / 1.3))
