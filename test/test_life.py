# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about lives: by slices, and modified by reliability and oil, against values computed by hand."""

import math

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.common.slice_balance import balance
from bearing_sim.model.params import lubricate, pack
from bearing_sim.physics.rating_life import (
    CLEANLINESS,
    add_slice_powers,
    contamination_factor,
    fatigue_limit,
    lamina_life_revolutions,
    modification_factor,
    modified_life_revolutions,
    rating_life_revolutions,
    reliability_factor,
    static_rating,
    stress_risers,
    viscosity_ratio,
)

PITCH = 62.75e-3


def deng(*overrides, level="spatial"):
    return load_scene("deng2017_table1", [f"level={level}", *overrides])


def lamina_life(inner, outer, life, risers=None):
    slices = inner.shape[1]
    inner_means, outer_means = np.zeros(slices), np.zeros(slices)
    add_slice_powers(inner, outer, np.ones(slices) if risers is None else risers, 1.0, inner_means, outer_means)
    return lamina_life_revolutions(inner_means, outer_means, life)


def life_at(tilt, crown="none", speed=2000.0, slices=30, risers=True):
    """Return the lamina life [revolutions] at a misalignment [rad], the mean over a roller pitch."""
    params = pack(deng(f"bearing.roller.crown={crown}", f"bearing.roller.slices={slices}"))
    factors = stress_risers(slices) if risers else np.ones(slices)
    inner_means, outer_means, at = np.zeros(slices), np.zeros(slices), None
    for position in range(5):
        at = balance(params, 2 * math.pi * position / (5 * 18), speed, (800.0, 0.0), tilts=(0.0, tilt), slices=at)
        add_slice_powers(at.inner, at.outer, factors, 1 / (position + 1), inner_means, outer_means)
    return lamina_life_revolutions(inner_means, outer_means, params.life)


@pytest.mark.parametrize("slices", [2, 20, 31])
def test_even_slices_have_the_life_of_whole_rollers(slices):
    life = pack(deng()).life
    inner, outer = np.linspace(0, 500, 18), np.linspace(80, 580, 18)
    whole = rating_life_revolutions(np.mean(inner**4) ** 0.25, np.mean(outer**4.5) ** (1 / 4.5), life)
    sliced = lamina_life(np.repeat(inner[:, None] / slices, slices, 1), np.repeat(outer[:, None] / slices, slices, 1), life)
    assert sliced == pytest.approx(whole, rel=1e-12)


def test_no_load_lasts_for_ever():
    life = pack(deng()).life
    assert lamina_life(np.zeros((18, 20)), np.zeros((18, 20)), life) == math.inf
    assert modified_life_revolutions(math.inf, 4712.0, 2.4e-6, PITCH, life) == math.inf
    cleaned = pack(deng("life.a_iso=filtered_15_12")).life
    assert modified_life_revolutions(math.inf, 4712.0, 2.4e-6, PITCH, cleaned) == math.inf
    assert modified_life_revolutions(math.inf, 0.0, 2.4e-6, PITCH, cleaned) == math.inf


def test_stress_risers_by_hand():
    # N = 30: at the ends |..| = 29/58, ln 0.9925 = -0.0075283; next to the middle 1/58, ln(1.985/58) = -3.37475
    risers = stress_risers(30)
    assert risers[[0, 29]] == pytest.approx([1 + 0.01 / 0.0075283] * 2, rel=1e-4)
    assert risers[[14, 15]] == pytest.approx([1 + 0.01 / 3.37475] * 2, rel=1e-6)
    assert stress_risers(31)[15] == 1.0 and (np.diff(stress_risers(31)[15:]) > 0).all()


def test_running_means_of_instants_are_their_mean():
    random = np.random.default_rng(1)
    loads, risers = random.uniform(0, 50, (4, 2, 6, 5)), stress_risers(5)
    inner_means, outer_means = np.zeros(5), np.zeros(5)
    for instant, (inner, outer) in enumerate(loads):
        add_slice_powers(inner, outer, risers, 1 / (instant + 1), inner_means, outer_means)
    np.testing.assert_allclose(inner_means, np.mean((risers * loads[:, 0]) ** 4, axis=(0, 1)), rtol=1e-12)
    np.testing.assert_allclose(outer_means, np.mean((risers * loads[:, 1]) ** 4.5, axis=(0, 1)), rtol=1e-12)


def test_life_falls_with_edge_load_and_a_crown_saves_it():
    straight, crowned = ([life_at(1e-3 * tilt, crown) for tilt in (0.0, 0.5, 1.0, 2.0, 3.0)] for crown in ("none", "iso_log"))
    assert all(b < a for a, b in zip(straight, straight[1:])) and all(b < a for a, b in zip(crowned, crowned[1:]))
    # in line and with its edges' stress risers, too, the crowned roller is the better one
    assert all(c > s for c, s in zip(crowned, straight))


def test_the_life_by_slices_does_not_hang_on_their_number():
    lives = [life_at(1e-3, "iso_log", slices=slices, risers=False) for slices in (20, 40, 80, 160)]
    assert lives[2] == pytest.approx(lives[3], rel=5e-3) and lives[0] == pytest.approx(lives[3], rel=5e-2)


def test_reliability_factors_are_those_of_the_standards_table():
    table = {0.9: 1, 0.95: 0.64, 0.96: 0.55, 0.97: 0.47, 0.98: 0.37, 0.99: 0.25, 0.992: 0.22, 0.994: 0.19, 0.996: 0.16, 0.998: 0.12}
    for reliability, factor in table.items():
        assert reliability_factor(reliability) == pytest.approx(factor, abs=0.0051)
    for reliability, factor in {0.999: 0.093, 0.9992: 0.087, 0.9994: 0.080, 0.9995: 0.077}.items():
        assert reliability_factor(reliability) == pytest.approx(factor, abs=0.00051)


def test_viscosity_ratio_by_hand():
    # 3000 rpm, 64 mm: nu_1 = 4500/(sqrt(3000) * 8) = 10.2698 mm^2/s; 100 rpm, 64 mm: 45000 * 100^-0.83/8 = 123.06 mm^2/s
    assert viscosity_ratio(10.2698e-6, 100 * math.pi, 64e-3) == pytest.approx(1.0, rel=1e-5)
    assert viscosity_ratio(123.06e-6, 100 * math.pi / 30, 64e-3) == pytest.approx(1.0, rel=1e-4)
    assert viscosity_ratio(1e-5, -100 * math.pi, 64e-3) == viscosity_ratio(1e-5, 100 * math.pi, 64e-3)
    assert viscosity_ratio(1e-5, 0.0, 64e-3) == 0.0
    # the standard's two laws meet at 1000 rpm to 2.3 %: 45 * 1000^0.17 = 145.6 and 4.5 * 1000^0.5 = 142.3
    below, above = (viscosity_ratio(1e-5, rpm * math.pi / 30, 64e-3) for rpm in (999.9999, 1000.0001))
    assert below == pytest.approx(142.30 / 145.62 * above, rel=1e-4)


@pytest.mark.parametrize(
    "kappa, ratio, factor",
    [
        # kappa = 1: 1.5859 - 1.2348 = 0.3511; 0.3511 * 0.1^0.4 = 0.139775; 0.1 * 0.860225^-9.185 = 0.39862
        (1.0, 0.1, 0.39862),
        # 0.3511 * 1: 0.1 * 0.6489^-9.185 = 5.3109
        (1.0, 1.0, 5.3109),
        # kappa = 0.4: 1.2348/0.4^0.19087 = 1.470793, film 0.115107; 0.5^0.4 = 0.757858: 0.1 * 0.912764^-9.185 = 0.23126
        (0.4, 0.5, 0.23126),
        # kappa = 2: 1.2348/2^0.071739 = 1.174900, film 0.411000; 0.2^0.4 = 0.525306: 0.1 * 0.784099^-9.185 = 0.93369
        (2.0, 0.2, 0.93369),
        # kappa = 0.2: 1.3993/0.2^0.054381 = 1.527290, film 0.058610: 0.1 * 0.941390^-9.185 = 0.17415
        (0.2, 1.0, 0.17415),
        (4.0, 5.0, 50.0),
        (0.1, 5.0, 0.1),
        (0.0, 0.0, 0.1),
        (4.0, 0.0, 0.1),
        (1.0, math.inf, 50.0),
    ],
)
def test_a_iso_by_hand(kappa, ratio, factor):
    assert modification_factor(kappa, ratio) == pytest.approx(factor, rel=1e-4)


def test_a_iso_rises_with_film_and_cleanliness_and_has_no_jumps():
    kappas = np.geomspace(0.02, 8.0, 2000)
    for ratio in (0.01, 0.1, 0.5):
        factors = np.array([modification_factor(kappa, ratio) for kappa in kappas])
        assert (np.diff(factors) >= -1e-12).all() and (factors[1:] / factors[:-1] < 1.05).all()
    ratios = np.geomspace(1e-3, 20.0, 500)
    assert (np.diff([modification_factor(1.5, ratio) for ratio in ratios]) >= 0).all()


@pytest.mark.parametrize(
    "name, kappa, millimetres, factor",
    [
        # 64^0.55 = 9.849155, 64^(1/3) = 4
        ("filtered_13_10", 1.0, 64, 0.0864 * 9.849155 * (1 - 0.5663 / 4)),
        ("filtered_15_12", 1.0, 64, 0.0432 * 9.849155 * (1 - 0.9987 / 4)),
        ("bath_15_12", 1.0, 64, 0.0288 * 9.849155 * (1 - 1.141 / 4)),
        ("bath_21_18", 0.5, 64, 0.00411 * 0.5**0.68 * 9.849155 * (1 - 3.8974 / 4)),
        ("filtered_13_10", 4.0, 1000, 1 - 0.05663),
        ("bath_21_18", 1.0, 27, 0.0),
    ],
)
def test_contamination_factors_by_hand(name, kappa, millimetres, factor):
    assert contamination_factor(kappa, *CLEANLINESS[name], 1e-3 * millimetres) == pytest.approx(factor, rel=1e-6)


def test_contamination_factors_are_in_the_ranges_of_the_standards_table():
    # ISO 281:2007, table 13, D_pw below 100 mm: high cleanliness 0.8 to 0.6, normal 0.6 to 0.5, slight contamination 0.5 to 0.3
    assert 0.6 <= contamination_factor(1.0, *CLEANLINESS["filtered_13_10"], PITCH) <= 0.8
    assert 0.3 <= contamination_factor(1.0, *CLEANLINESS["filtered_15_12"], PITCH) <= 0.6


def test_dirtier_oil_never_has_the_larger_factor_and_a_thicker_film_never_the_smaller():
    for family in ("filtered", "bath"):
        names = [name for name in CLEANLINESS if name.startswith(family)]
        for kappa in (0.1, 1.0, 4.0):
            factors = [contamination_factor(kappa, *CLEANLINESS[name], PITCH) for name in names]
            assert factors == sorted(factors, reverse=True) and all(0.0 <= factor <= 1.0 for factor in factors)
    factors = [contamination_factor(kappa, *CLEANLINESS["filtered_17_14"], PITCH) for kappa in np.linspace(0, 5, 50)]
    assert factors == sorted(factors)


def test_the_scenes_classes_are_the_tables():
    from bearing_sim.scene.scene import CLEANLINESS as NAMES

    assert set(NAMES.__args__) == {"none", *CLEANLINESS}


def test_fatigue_limit_by_hand():
    # 44 (1 - 7/62.75) 18 * 7 * 7 = 34479 N
    static = static_rating(18, 7e-3, 7e-3, 7 / 62.75)
    assert static == pytest.approx(34479, rel=1e-4)
    assert fatigue_limit(static, PITCH) == pytest.approx(static / 8.2)
    assert fatigue_limit(static, 0.2) == pytest.approx(static / 8.2 * 0.5**0.3)


def test_without_a_choice_all_lives_are_the_basic_one():
    block = Simulation(deng(level="slip")).advance(0.002, samples=4)
    np.testing.assert_array_equal(block["lamina_life"], block["rating_life"])
    np.testing.assert_array_equal(block["modified_rating_life"], block["rating_life"])


@pytest.mark.parametrize("level", ["slip", "planar"])
def test_damage_counts_the_modified_life(level):
    scene = deng("life.a_iso=filtered_17_14", "life.reliability=99 %", level=level)
    simulation = Simulation(scene)
    block = simulation.advance(0.004, samples=40)
    last, params = block[-1], pack(scene)
    oil = lubricate(scene.lubricant, params, 393.15)
    kappa = viscosity_ratio(oil.kinematic_viscosity, last["shaft_speed"], PITCH)
    assert oil.kinematic_viscosity == pytest.approx(2.343e-6, rel=1e-3) and kappa == pytest.approx(0.875, abs=1e-3)
    load = 30.2e3 * (last["rating_life"] * 45000 * 60 / 1e6) ** -0.3
    limit = contamination_factor(kappa, *CLEANLINESS["filtered_17_14"], PITCH) * 34479 / 8.2 / load
    factor = reliability_factor(0.99) * modification_factor(kappa, limit)
    assert last["modified_rating_life"] == pytest.approx(factor * last["rating_life"], rel=2e-3)
    expected = np.sum(1e-4 / 3600 / block["modified_rating_life"])
    assert last["damage"] == pytest.approx(expected, rel=1e-3)


def test_at_rest_no_life_is_used():
    sample = Simulation(deng("life.a_iso=bath_15_12", "operating.shaft_speed=0 rpm", level="slip")).advance(0.001)[0]
    assert math.isinf(sample["modified_rating_life"]) and math.isinf(sample["lamina_life"]) and sample["damage"] == 0.0
