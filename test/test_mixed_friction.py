# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Mixed friction: shares of asperities by hand, skew and hysteresis by what they lose, derivatives, and what becomes of it with thick films."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from bearing_sim import SceneError, Simulation, load_scene, settle
from bearing_sim.levels.common.model import films_at
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table_builder import solve_points
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES, new_rows
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.film import resist_rolling
from bearing_sim.physics.mixed import (
    FILM_RATIO,
    FULL_FILMS,
    NONE,
    SKF,
    MixedFriction,
    asperity_share,
    film_state,
    hysteresis_constant,
    skf_constant,
)
from bearing_sim.physics.profile import concentrate, profile_depth, spread_tractions
from bearing_sim.physics.starvation import MinimumLoad, Starvation, starvation_rate
from bearing_sim.physics.traction import traction
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

RPM = math.pi / 30
FULL = Starvation(0.0, True)
LEAST = MinimumLoad(300.0, 0.0)


def mixed(law, mean_diameter=0.0, pitch_diameter=0.0, boundary=0.12, factor=1.0, raceways=True, skew=0.0):
    return MixedFriction(law, boundary, factor, skf_constant(mean_diameter), raceways, skew, pitch_diameter)


@pytest.mark.parametrize(
    ("pitch", "rpm", "viscosity", "film", "factor", "expected"),
    [
        # nu_1 is 4500/sqrt(3000 x 70.5) = 9.785 mm2/s: kappa 1, exp(-1.8)
        (70.5, 3000, 9.785, 1.0, 1.0, 0.16530),
        # starved to a half: exp(-1.8 x 0.5^1.2)
        (70.5, 3000, 9.785, 0.5, 1.0, 0.45672),
        # nu_1 is 45000 x 100^-0.83/sqrt(225) = 65.636 mm2/s: kappa 2, Lambda 1.5 x 2^(1/1.3) = 2.5565, exp(-1.8 x 3.0844)
        (225.0, 100, 131.27, 1.0, 1.5, 0.0038804),
    ],
)
def test_the_share_by_the_film_ratio_is_aiharas_by_hand(pitch, rpm, viscosity, film, factor, expected):
    law = mixed(FILM_RATIO, pitch_diameter=1e-3 * pitch, factor=factor)
    for way in (1, -1):
        assert asperity_share(way * rpm * RPM, 1e-6 * viscosity, film, law) == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize(
    ("mean", "rpm", "viscosity", "expected"),
    [
        # NU 210: exp(-2.6e-8 x (3000 x 12)^1.4 x 70) = exp(-4.3541)
        (70.0, 3000, 12.0, 0.012853),
        # NU 232: exp(-2.6e-8 x (100 x 60)^1.4 x 225) = exp(-1.1391)
        (225.0, 100, 60.0, 0.32009),
    ],
)
def test_the_share_by_skf_is_that_by_hand_and_knows_no_film(mean, rpm, viscosity, expected):
    law = mixed(SKF, mean_diameter=1e-3 * mean)
    for film in (1.0, 0.5):
        assert asperity_share(-rpm * RPM, 1e-6 * viscosity, film, law) == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize("law", [FILM_RATIO, SKF])
def test_asperities_carry_all_at_rest_and_less_the_faster_the_shaft_and_the_thicker_the_oil(law):
    which = mixed(law, 0.07, 0.0705)
    assert asperity_share(0.0, 1e-5, 1.0, which) == 1.0
    for each in (lambda s: asperity_share(s, 1e-5, 1.0, which), lambda s: asperity_share(100.0, 1e-7 * s, 1.0, which)):
        shares = np.array([each(s) for s in np.geomspace(0.1, 1e4, 200)])
        assert ((0.0 <= shares) & (shares <= 1.0)).all() and (np.diff(shares) <= 0.0).all() and shares[0] > 0.9 > 1e-3 > shares[-1]


def test_pockets_and_flanges_have_the_coefficient_of_asperities_in_their_share():
    law = mixed(FILM_RATIO, pitch_diameter=0.0705, skew=0.004)
    films = film_state(3000 * RPM, 1e3, 9.785e-6, 0.05, 0.03, LEAST, FULL, law)
    share = math.exp(-1.8)
    assert films.asperity_share == pytest.approx(share, rel=5e-4)
    assert films.pocket_friction == pytest.approx(0.12 * share + 0.05 * (1 - share), rel=1e-4)
    assert films.flange_friction == pytest.approx(0.12 * share + 0.03 * (1 - share), rel=1e-4)
    assert films.raceway_friction == pytest.approx(0.12 * share, rel=5e-4)
    # what slides askew over both raceways with q u loses mu Q q u = 2 F_R u; on a film SKF's mu is 0.02
    assert films.skew_resistance == pytest.approx((0.12 * share + 0.02 * (1 - share)) * 0.004 / 2, rel=1e-4)
    bare = film_state(3000 * RPM, 1e3, 9.785e-6, 0.05, 0.03, LEAST, FULL, law._replace(raceways=False))
    assert bare == films._replace(raceway_share=0.0, raceway_friction=0.0)


@pytest.mark.parametrize(("load", "counts"), [(0.0, 0.0), (300.0, 0.0), (375.0, 0.5), (450.0, 1.0), (1e5, 1.0)])
def test_asperities_of_raceways_count_from_the_minimum_load_on_and_all_others_whatever_the_load(load, counts):
    law = mixed(FILM_RATIO, pitch_diameter=0.0705, skew=0.004)
    loaded, films = (film_state(3000 * RPM, each, 9.785e-6, 0.05, 0.03, LEAST, FULL, law) for each in (1e6, load))
    assert films.raceway_share == pytest.approx(counts * loaded.asperity_share)
    assert films.raceway_friction == pytest.approx(0.12 * films.raceway_share)
    assert films._replace(raceway_share=0.0, raceway_friction=0.0) == loaded._replace(raceway_share=0.0, raceway_friction=0.0)


@pytest.mark.parametrize("law", [FILM_RATIO, SKF])
def test_a_starved_film_leaves_more_to_asperities_by_the_film_ratio_alone(law):
    starvation = Starvation(starvation_rate(3e-7, 0.05, 0.09), False)
    which = mixed(law, 0.07, 0.0705)
    full, thin = (film_state(3000 * RPM, 1e3, 12e-6, 0.05, 0.02, LEAST, each, which) for each in (FULL, starvation))
    assert thin.resistance == pytest.approx(math.exp(-3e-7 * 12 * 3000 * 140 * math.sqrt(5.1 / 80)), rel=1e-9)
    expected = math.exp(-1.8 * (math.exp(thin.log_film) * (12 / 9.785) ** (1 / 1.3)) ** 1.2) if law == FILM_RATIO else full.asperity_share
    assert thin.asperity_share == pytest.approx(expected, rel=5e-4)


@given(st.floats(-5000, 5000), st.floats(0, 1e6), st.floats(1e-7, 0.1), st.floats(0, 1), st.floats(0, 1))
def test_without_mixed_friction_coefficients_stay_exactly_as_given(speed, load, viscosity, pocket, flange):
    assert film_state(speed, load, viscosity, pocket, flange, LEAST, FULL, mixed(NONE)) == FULL_FILMS._replace(
        pocket_friction=pocket, flange_friction=flange
    )


def elastic_half_width(force, radius, modulus, length):
    """Half the width of a line contact whose surfaces come together: their slope under Hertz's pressure, integrated, undoes x/R."""
    nodes = 200
    angle = np.pi * np.arange(1, nodes + 1) / (nodes + 1)
    places, weights = np.cos(angle), np.pi / (nodes + 1) * np.sin(angle) ** 2  # Gauss and Chebyshev's, of the second kind
    at = np.cos(np.pi * (np.arange(nodes) + 0.5) / (nodes + 1))[nodes // 4]  # between two nodes, where the principal value comes out

    def opening(half_width):
        largest = force / (length * half_width * weights.sum())
        slope = 4 / (np.pi * modulus) * largest * np.sum(weights / (at - places))
        return slope - at * half_width / radius

    return brentq(opening, 1e-7, 1e-2, xtol=1e-14)


def energy_of_an_advance(force, radius, modulus, length):
    """Elastic work that the front half of a contact takes up per length rolled: the integral of Hertz's pressure times the slope x/R."""
    half_width = elastic_half_width(force, radius, modulus, length)
    x = (np.arange(200_000) + 0.5) / 200_000 * half_width
    pressure = np.sqrt(1 - (x / half_width) ** 2)
    pressure *= force / (2 * length * pressure.mean() * half_width)
    return length * np.sum(pressure * x / radius) * (x[1] - x[0])


def resisted(contacts_of, films, resistance, crowned=False):
    """Rows of a contact with the inner raceway that resists rolling."""
    contacts = new_rows(len(CONTACT), 2 * LANES)
    for name, value in contacts_of.items():
        contacts[:, getattr(CONTACT, name)] = value
    resist_rolling(contacts, resistance, films, crowned)
    return contacts[0, :, 0].copy()


def packed(*overrides):
    """Parameters and lubrication of Deng's bearing."""
    scene = load_scene("deng2017_table1", overrides)
    params = pack(scene)
    return params, lubricate(scene.lubricant, params, scene.lubricant.temperature)


@pytest.mark.parametrize("force", [10.0, 1e3, 2e4])
@pytest.mark.parametrize("preset", ["deng2017_table1", "NU 210", "NU 232"])
def test_hysteresis_loses_a_hundredth_of_the_elastic_work_of_the_front_half_of_a_contact(force, preset):
    # K. L. Johnson, Contact Mechanics, section 9.4
    tree = {"name": "x", "bearing": preset, "lubricant": {"oil": "ISO VG 68"}, "operating": {"shaft_speed": "3000 rpm", "radial_load": "1 kN"}}
    scene = load_scene(tree, ["lubricant.rolling_resistance=none", "lubricant.mixed_friction={skew: 0}"])
    params = pack(scene)
    resistance = lubricate(scene.lubricant, params, 343.15).rolling_resistance
    assert resistance.on and resistance.hydrodynamic == 0.0
    found = resisted({"load": force, "rolling": 5.0}, FULL_FILMS, resistance)[CONTACT.resistance]
    raceways = params.raceways
    work = energy_of_an_advance(force, raceways.inner_curvature_radius, raceways.reduced_modulus, params.rollers.length)
    assert 2 * found == pytest.approx(0.01 * work, rel=1e-4)  # the power 2 F_R u over u


def test_hysteresis_by_hand():
    # a = sqrt(8 x 1000 x 5 mm/(pi x 226 GPa x 10 mm)) = 75.06 um; 0.01/(3 pi) 0.07506/5 x 1000 N
    assert hysteresis_constant(0.01, 5e-3, 2.26e11, 10e-3) * 1000**1.5 == pytest.approx(0.01593, rel=1e-3)


ROLLING = {"u": [0.02, 1.0, -20.0, 60.0], "q": [0.5, 40.0, 900.0]}


@pytest.mark.parametrize("crowned", [False, True], ids=["straight", "crowned"])
@pytest.mark.parametrize("pumped", [False, True])
@pytest.mark.parametrize("rolling", ROLLING["u"])
@pytest.mark.parametrize("load", ROLLING["q"])
def test_slopes_of_resistance_by_skew_and_hysteresis_are_finite_differences(load, rolling, pumped, crowned):
    law = "hydrodynamic" if pumped else "none"
    _, lubrication = packed(f"lubricant.rolling_resistance={law}", "lubricant.mixed_friction=film_ratio")
    films, held = FULL_FILMS._replace(resistance=0.6, skew_resistance=2e-4), {"part": 0.4, "gap": 2e-6} if crowned else {}

    def at(load, rolling):
        return resisted({"load": load, "rolling": rolling, **held}, films, lubrication.rolling_resistance, crowned)

    found, step = at(load, rolling), 1e-5
    by_load = (at(load * (1 + step), rolling) - at(load * (1 - step), rolling))[CONTACT.resistance] / (2 * step * load)
    by_speed = (at(load, rolling * (1 + step)) - at(load, rolling * (1 - step)))[CONTACT.resistance] / (2 * step * rolling)
    assert found[CONTACT.resistance_d_load] == pytest.approx(by_load, rel=1e-6)
    assert found[CONTACT.resistance_d_rolling] == pytest.approx(by_speed, rel=1e-6, abs=1e-9 * abs(found[CONTACT.resistance] / rolling))
    assert found[CONTACT.resistance] * rolling > 0.0 and at(load, -rolling)[CONTACT.resistance] == -found[CONTACT.resistance]
    alone = (
        at(load, rolling)[CONTACT.resistance]
        - resisted(
            {"load": load, "rolling": rolling, **held},
            films._replace(skew_resistance=0.0),
            lubrication.rolling_resistance._replace(
                inner=lubrication.rolling_resistance.inner._replace(hysteresis=0.0),
                outer=lubrication.rolling_resistance.outer._replace(hysteresis=0.0),
            ),
            crowned,
        )[CONTACT.resistance]
    )
    constant = lubrication.rolling_resistance.inner.hysteresis
    assert alone == pytest.approx((2e-4 * load + constant * load**1.5) * rolling / math.hypot(rolling, 0.05), rel=1e-9)


ASPERITIES = FULL_FILMS._replace(log_film=math.log(0.8), asperity_share=0.3, raceway_share=0.3, raceway_friction=0.036)
LAWS = {law: [f"lubricant.traction={{law: {law}}}"] for law in ("oil_4109", "eyring", "kragelskii", "constant")}


def dragged(params, lubrication, films, load, rolling, sliding):
    """Rows of a contact with the inner raceway whose traction is computed as levels slip and planar do, on a roller with a profile or without."""
    contacts = new_rows(len(CONTACT), 2 * LANES)
    contacts[:, CONTACT.load], contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding] = load, rolling, sliding
    raceways = params.raceways
    if raceways.profile.crowned:
        contacts[:, CONTACT.penetration] = profile_depth(load, raceways.stiffness, raceways.profile)
        concentrate(raceways.stiffness, raceways.profile, contacts)
    traction(contacts, lubrication.inner, lubrication.outer, films)
    if raceways.profile.crowned:
        spread_tractions(contacts)
    return contacts[0, :, 0].copy()


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("crown", ["none", "iso_log"])
@pytest.mark.parametrize("load, rolling, sliding", [(300.0, 20.0, 2e-3), (300.0, 20.0, -0.05), (2e3, -60.0, 1.0), (20.0, 0.03, 1e-4)])
def test_slopes_of_tractions_with_asperities_are_finite_differences(law, crown, load, rolling, sliding):
    params, lubrication = packed(*LAWS[law], f"bearing.roller.crown={crown}")

    def force(load=load, rolling=rolling, sliding=sliding):
        return dragged(params, lubrication, ASPERITIES, load, rolling, sliding)[CONTACT.force]

    found = dragged(params, lubrication, ASPERITIES, load, rolling, sliding)
    by_sliding = (force(sliding=sliding * 1.0001) - force(sliding=sliding * 0.9999)) / (2e-4 * sliding)
    by_rolling = (force(rolling=rolling * 1.0001) - force(rolling=rolling * 0.9999)) / (2e-4 * rolling)
    by_load = (force(load=load * 1.001) - force(load=load * 0.999)) / (2e-3 * load)
    assert found[CONTACT.d_sliding] == pytest.approx(by_sliding, rel=1e-4)
    assert found[CONTACT.d_rolling] == pytest.approx(by_rolling, rel=1e-3, abs=1e-6 * abs(found[CONTACT.force] / rolling))
    assert found[CONTACT.d_load] == pytest.approx(by_load, rel=0.02 if crown == "iso_log" else 1e-4, abs=1e-7)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("crown", ["none", "iso_log"])
def test_asperities_add_their_friction_to_what_is_left_of_the_films(law, crown):
    params, lubrication = packed(*LAWS[law], f"bearing.roller.crown={crown}")
    for sliding in (-3.0, 1e-3, 0.4):
        films, both = (
            dragged(params, lubrication, each, 300.0, 20.0, sliding)[CONTACT.force]
            for each in (ASPERITIES._replace(asperity_share=0.0, raceway_share=0.0, raceway_friction=0.0), ASPERITIES)
        )
        ratio = sliding / math.hypot(20.0, 0.05)
        assert both == pytest.approx(0.7 * films + 0.036 * 300.0 * ratio / math.hypot(ratio, 1e-3), rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("crown", ["none", "iso_log"])
@given(st.floats(-100, 100), st.floats(-150, 150), st.floats(0, 2e4))
@settings(max_examples=150, deadline=None)
def test_tractions_with_asperities_are_odd_in_the_sliding_speed_and_never_give_power(law, crown, sliding, rolling, load):
    params, lubrication = CACHED[law, crown]
    ahead, back = (dragged(params, lubrication, ASPERITIES, load, rolling, side * sliding)[CONTACT.force] for side in (1, -1))
    assert back == pytest.approx(-ahead, rel=1e-12, abs=1e-12)
    assert ahead * sliding >= 0.0 and abs(ahead) <= (0.7 * 0.5 + 0.036) * load


CACHED = {(law, crown): packed(*LAWS[law], f"bearing.roller.crown={crown}") for law in LAWS for crown in ("none", "iso_log")}


def motor(*overrides, bearing="NU 210", oil="ISO VG 68", celsius=40.0, rpm=3000, load=5000.0, level="slip"):
    """A catalogue bearing in oil, whose block has neither starvation nor mixed_friction."""
    operating = {"shaft_speed": f"{rpm} rpm", "radial_load": f"{load} N"}
    lubricant = {"oil": oil, "temperature": f"{celsius} degC", "supply": {"law": "oil_bath", "level": "3 mm"}}
    return load_scene({"name": "motor", "level": level, "bearing": bearing, "lubricant": lubricant, "operating": operating}, overrides)


@pytest.mark.parametrize("bearing", ["NU 210", "NU 2308"])
@pytest.mark.parametrize("load", [300.0, 3000.0])
@pytest.mark.parametrize("level", ["slip", "steady"])
def test_on_films_far_thicker_than_asperities_slip_is_that_without_them(bearing, load, level):
    """At kappa 50, where nothing is starved and rollers do not run askew."""
    slips = {}
    for name, options in {
        "films alone": ["lubricant.mixed_friction=none"],
        "film_ratio": ["lubricant.mixed_friction={skew: 0, hysteresis: 0}"],
        "skf": ["lubricant.mixed_friction={law: skf, skew: 0, hysteresis: 0}"],
        "all losses": [],
    }.items():
        scene = motor("lubricant.starvation=none", *options, bearing=bearing, oil="ISO VG 460", load=load, level=level)
        run = Simulation(scene)
        slips[name] = run.advance(0.5)["cage_slip"][0]
        assert float(run.sample["viscosity_ratio"]) > 40.0
    for law in ("film_ratio", "skf"):
        assert slips[law] == pytest.approx(slips["films alone"], abs=1e-6)
    assert slips["all losses"] == pytest.approx(slips["films alone"], abs=0.005)


@pytest.mark.parametrize("law", ["film_ratio", "skf"])
def test_at_a_low_kappa_asperities_drive_rollers_and_less_slips_but_not_below_the_minimum_load(law):
    def slips(load):
        scenes = (motor(f"lubricant.mixed_friction={each}", oil="ISO VG 32", celsius=90.0, rpm=1000, load=load) for each in ("none", law))
        return [Simulation(scene).advance(1.0)["cage_slip"][0] for scene in scenes]

    without, with_asperities = slips(750.0)  # the minimum load is 462 N
    assert with_asperities < 0.8 * without
    without, with_asperities = slips(150.0)
    assert with_asperities == pytest.approx(without, rel=0.05) and without > 0.03


@pytest.mark.parametrize("bearing", ["deng2017_table1", "NU 210", "NU 232"])
def test_the_skew_is_half_of_what_flanges_leave_by_hand(bearing):
    scene = motor(bearing=bearing)
    roller, low = scene.bearing.roller, scene.bearing.outer_raceway.low_radius
    diameter, length = roller.diameter, roller.length
    edge = scene.bearing.flanges.outer_radius or low - 0.18 * diameter
    centre, rim = low - diameter / 2, 0.45 * diameter
    outwards = (edge**2 - rim**2 - centre**2) / (2 * centre)
    between = (15e-6 + 0.003 * length) / 2 / math.sqrt(rim**2 - outwards**2)
    assert pack(scene).mixed.skew == pytest.approx(0.5 * between, rel=1e-3)  # estimates of catalogue bearings are rounded
    assert between < 2 * scene.bearing.cage.pocket_clearance / length
    tight = motor("bearing.cage.pocket_clearance=5 um", bearing=bearing)
    assert pack(tight).mixed.skew == pytest.approx(5e-6 / length, rel=1e-9)


def losses(scene):
    """Power that rolling loses in steady operation [W]."""
    answer = solve_points(scene, np.array([[scene.operating.shaft_speed, scene.operating.radial_load, scene.lubricant.temperature, 0.0]]))[0]
    return answer[ANSWER.inner_rolling_power] + answer[ANSWER.outer_rolling_power]


@pytest.mark.parametrize("bearing, mean", [("NU 210", 70), ("NU 2308", 65), ("NU 232", 225)])
@pytest.mark.parametrize("load", [5e3, 15e3])
def test_the_moment_of_skew_is_within_a_factor_of_two_of_skfs_sliding_moment(bearing, mean, load):
    # 0.0015 d_m F_r mu_sl of a purely radial load [N mm], with the same coefficient; flanges have no part of it here
    for celsius, viscosity in ((40, 68.0), (90, 10.95)):
        with_skew, without = (
            losses(
                motor(
                    "lubricant.rolling_resistance=none",
                    f"lubricant.mixed_friction={{law: skf, skew: {skew}, hysteresis: 0}}",
                    bearing=bearing,
                    load=load,
                    celsius=celsius,
                )
            )
            for skew in (0.5, 0.0)
        )
        share = math.exp(-2.6e-8 * (3000 * viscosity) ** 1.4 * mean)
        makers = 0.0015 * mean * load * (0.12 * share + 0.02 * (1 - share)) * 1e-3
        assert without == 0.0 and 0.5 < with_skew / (3000 * RPM) / makers < 2.0


@pytest.mark.parametrize("level", ["slip", "planar", "spatial"])
def test_films_of_a_level_follow_its_load_and_speed(level):
    run = Simulation(motor(level=level, celsius=90.0, oil="ISO VG 32", load=3000.0))
    slow, fast = (films_at(0.0, rpm * RPM, run._model(run.inputs._replace(shaft_speed=rpm * RPM), 1.0)) for rpm in (300, 3000))
    assert slow.asperity_share > 1.5 * fast.asperity_share > 0.1 and slow.pocket_friction > fast.pocket_friction > 0.05
    powers = run.advance(2e-3)[0]
    assert all(powers[f"{name}_power"] >= 0.0 for name in ("inner_sliding", "outer_sliding", "inner_rolling", "outer_rolling", "pocket"))


@pytest.mark.parametrize("level", ["steady", "slip", "planar", "spatial"])
@pytest.mark.parametrize("bearing", ["NU 210", "NUP 2308"])
def test_asperities_in_pockets_and_on_flanges_alone_are_larger_coefficients_there(bearing, level):
    at = {"bearing": bearing, "level": level, "oil": "ISO VG 32", "celsius": 80.0, "load": 3000.0}
    axial = ["operating.axial_load=200 N"] if bearing == "NUP 2308" else []
    asperities = motor("lubricant.mixed_friction={raceways: false, skew: 0, hysteresis: 0}", *axial, **at)
    films = Simulation(asperities)
    films = films_at(0.0, films.inputs.shaft_speed, films._model(films.inputs, 1.0))
    assert films.pocket_friction > 0.055 and films.flange_friction > 0.03
    larger = [f"bearing.cage.pocket_friction={films.pocket_friction!r}", f"bearing.flanges.film_friction={films.flange_friction!r}"]
    other = motor("lubricant.mixed_friction=none", *larger, *axial, **at)
    found, expected = (Simulation(each).advance(3e-3)[0] for each in (asperities, other))
    for name in ("cage_speed", "roller_spin", "pocket_power", "flange_power", "shaft_power", "rating_life"):
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9, err_msg=name)
    plain = Simulation(motor("lubricant.mixed_friction=none", *axial, **at)).advance(3e-3)[0]
    assert abs(plain["flange_power"] / found["flange_power"] - 1.0) > 1e-3 or bearing == "NU 210"
    assert abs(plain["pocket_power"] / found["pocket_power"] - 1.0) > 1e-3


def test_a_coefficient_can_be_set_where_the_scene_says_nothing_of_mixed_friction():
    scene = motor("lubricant.mixed_friction.boundary_friction=0.08")
    assert (scene.lubricant.mixed_friction.law, scene.lubricant.mixed_friction.boundary_friction) == ("film_ratio", 0.08)
    assert pack(scene).mixed.boundary_friction == 0.08 and pack(scene).mixed.law == FILM_RATIO
    assert scene_from_yaml(scene_to_yaml(scene)) == scene
    assert motor("lubricant.mixed_friction=skf").lubricant.mixed_friction.law == "skf"
    assert motor().lubricant.mixed_friction.boundary_friction == 0.12
    assert pack(motor("lubricant.mixed_friction=none")).mixed.law == NONE
    assert settle(motor("lubricant.mixed_friction.film_ratio_factor=0.5"), "steady").cage_slip < 0.1


@pytest.mark.parametrize(
    ("override", "told"),
    [
        (
            "bearing.flanges.boundary_friction=0.1",
            "bearing.flanges.boundary_friction.*no longer a field; the coefficient of asperities everywhere is "
            "lubricant.mixed_friction.boundary_friction",
        ),
        ("lubricant.mixed_friction=filmratio", "did you mean 'film_ratio'"),
        ("lubricant.mixed_friction={law: none, skew: 0.2}", "lubricant.mixed_friction.skew"),
        ("lubricant.mixed_friction.skew=2", "lubricant.mixed_friction.skew"),
        ("lubricant.mixed_friction.boundary=0.1", "did you mean 'boundary_friction'"),
    ],
)
def test_what_cannot_be_is_refused_with_what_to_say_instead(override, told):
    with pytest.raises(SceneError, match=told):
        motor(override)
