# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oils and greases by name and by kind of base oil, against standards, published measurements and formulas worked out by hand."""

import math

import numpy as np
import pytest

from bearing_sim import SceneError
from bearing_sim.model.oil import class_pressure_viscosity, oil_at, pressure_index, shear_strength, specific_heat, thermal_conductivity
from bearing_sim.model.params import lubricate, mixture_fraction, pack, replenishment
from bearing_sim.model.thermal_network import oil_flow
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.drag import bath_moment, mixture_density, swept_fraction
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.rating_life import cleanliness
from bearing_sim.physics.traction import thermal_eyring_constants, traction
from bearing_sim.scene.loader import catalog_names, scene_from_yaml, scene_to_yaml
from bearing_sim.scene.lubricant import CustomOil
from bearing_sim.scene.quantity import unit_registry
from bearing_sim.scene.uncertainty import ranges_of
from bearing_sim.scene.viscosity_index import ISO_VISCOSITY_CLASSES, reference_viscosities, viscosity_at_100, viscosity_index

ZERO = 273.15
MOTOR = """
name: motor
bearing: nu210
lubricant: {oil: ISO VG 68, temperature: 70 degC}
operating: {shaft_speed: 3000 rpm, radial_load: 5 kN}
"""


def scene(*overrides):
    return scene_from_yaml(MOTOR, overrides)


def oil(name):
    return scene(f"lubricant.oil={name}").lubricant.oil


def kinematic(of, celsius):
    """Return nu in mm^2/s."""
    state = oil_at(of, celsius + ZERO)
    return 1e6 * state.viscosity / state.density


# The three examples of ASTM D2270: procedures A, B, B.
@pytest.mark.parametrize(("viscosity_40", "viscosity_100", "index"), [(73.30, 8.86, 92), (22.83, 5.05, 156), (53.47, 7.80, 111)])
def test_viscosity_indices_are_those_of_the_standards_examples(viscosity_40, viscosity_100, index):
    found = viscosity_index(viscosity_40, viscosity_100)
    assert round(found) == index
    assert viscosity_at_100(viscosity_40, found) == pytest.approx(viscosity_100, rel=1e-9)


def test_reference_viscosities_run_on_from_each_row_of_the_standard_to_the_next_up_to_the_thickest_oils():
    starts = np.array([3.8, 4.4, 5.0, 6.4, 7.0, 7.7, 9.0, 12.0, 15.0, 18.0, 22.0, 28.0, 40.0, 55.0, 70.0])
    below, at, above = (np.array([reference_viscosities(y) for y in starts * factor]) for factor in (1.0 - 1e-9, 1.0, 1.0 + 1e-6))
    np.testing.assert_allclose(at, below, rtol=2e-3)
    slopes = (above - at) / (1e-6 * starts[:, None])
    before = (below - np.array([reference_viscosities(y * (1.0 - 1e-6)) for y in starts])) / (1e-6 * starts[:, None])
    np.testing.assert_allclose(slopes, before, rtol=0.1)


def test_every_class_of_iso_3448_has_its_viscosity_and_its_kind_of_base_oil():
    assert list(ISO_VISCOSITY_CLASSES) == [2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200]
    for number, middle in ISO_VISCOSITY_CLASSES.items():
        assert abs(middle - number) <= 0.1 * middle
        for base in ("mineral", "pao", "ester", "pag"):
            found = oil(f"iso_vg_{number}_{base}")
            assert kinematic(found, 40.0) == pytest.approx(middle, rel=1e-9) and found.base == base


@pytest.mark.parametrize("name", ["ISO VG 68", "iso_vg_68", "vg68", "Iso-VG 68 mineral", "{preset: ISO VG 68}"])
def test_a_class_is_known_however_it_is_written(name):
    found = oil(name)
    assert found.name == "ISO VG 68" and found.base == "mineral" and found.viscosity_40 == pytest.approx(68e-6)
    assert kinematic(found, 100.0) == pytest.approx(8.53, abs=0.01)  # by VI 95


def test_single_values_of_a_named_oil_can_be_changed():
    thin, thick = (kinematic(oil(f"{{preset: ISO VG 68, viscosity_index: {index}}}"), 100.0) for index in (60, 160))
    assert thin < kinematic(oil("ISO VG 68"), 100.0) < thick
    changed = scene("lubricant.oil.viscosity_100=9 mm^2/s").lubricant.oil
    assert kinematic(changed, 100.0) == pytest.approx(9.0) and changed.viscosity_index is None
    jet = oil("{preset: DEF STAN 91-101, viscosity_index: 120}")
    assert jet.viscosity_100 is None and viscosity_index(26.5, kinematic(jet, 100.0)) == pytest.approx(120.0)


@pytest.mark.parametrize(
    ("name", "entry"),
    [("MIL-PRF-23699", "mil_l_23699"), ("mil prf 7808", "mil_l_7808"), ("DEF STAN 91-101", "def_stan_91_101"), ("mil_l_7808", "mil_l_7808")],
)
def test_turbine_oils_are_known_by_their_standards_and_take_the_aviation_fit(name, entry):
    lubricant = scene(f"lubricant.oil={name}").lubricant
    assert lubricant.oil.name == entry and lubricant.traction.law == "oil_4109"


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("lubricant.oil=ISO VG 70", "no class 70; the nearest is ISO VG 68"),
        ("lubricant.oil=ISO VG 68 PAOO", "did you mean 'pao'"),
        ("lubricant.oil=MIL-PRF-2369", "did you mean 'MIL-PRF-23699'"),
        ("lubricant.oil=68", "expected the name of an oil"),
        ("lubricant.oil=", "expected the name of an oil"),
        ("lubricant.oil={preset: [1]}", "expected the name of an oil"),
        ("lubricant.oil={preset: ISO VG 68, viscosity_indx: 90}", "did you mean 'viscosity_index'"),
        ("lubricant.oil={viscosity_40: 68 mm^2/s, viscosity_100: 9 mm^2/s, viscosity_index: 95}", "give one of viscosity_100 and viscosity_index"),
        ("lubricant.oil.viscosity_index=1000", "outside -60 to 450"),
        ("lubricant.grease=lithium complx NLGI 2", "did you mean 'lithium complex"),
        ("lubricant.grease=2", "expected the name of a grease"),
        ("lubricant.grease={base_oil: ISO VG 100, nlgi: 7}", "lubricant.grease.nlgi = '7'"),
        ("lubricant={grease: {nlgi: 2}}", "lubricant.oil: missing; give the base oil of the grease"),
        ("lubricant={oil: ISO VG 68, grease: {base_oil: ISO VG 100}}", "lubricant.oil is the grease's base oil"),
        ("lubricant={grease: lithium NLGI 2, supply: oil_bath}", "oil_bath is a supply of oil"),
        ("lubricant.supply=oil_spray", "did you mean 'oil_air'"),
        ("lubricant.supply={law: circulating, flow: 5 kg/s}", "wrong dimension"),
        ("lubricant.supply={law: oil_jet, flow: -1 l/min}", "lubricant.supply.flow"),
        ("life.a_iso=high cleanliness", "is a class of grease, and the bearing runs in oil; expected one of filtered_13_10"),
    ],
)
def test_a_wrong_name_or_value_is_told_with_what_was_expected(override, told):
    with pytest.raises(SceneError) as error:
        scene(override)
    assert told in str(error.value) and len(error.value.errors) == 1


def test_a_cleanliness_class_of_oil_is_refused_for_grease():
    with pytest.raises(SceneError, match="filtered_15_12 is a class of oil, and the bearing runs in grease; expected one of grease_high_cleanliness"):
        scene("lubricant.grease=SKF LGMT 2", "life.a_iso=filtered_15_12")
    assert scene("lubricant.grease=SKF LGMT 2", "life.a_iso=normal cleanliness").life.a_iso == "grease_normal_cleanliness"


@pytest.mark.parametrize(
    ("name", "diameter", "slope", "loss"),
    # ISO 281:2007, figures A.10 to A.14; high cleanliness of grease is that of an oil bath of code 13/10.
    [
        ("grease_high_cleanliness", 0.1, 0.0864, 0.6796),
        ("grease_normal_cleanliness", 0.1, 0.0432, 1.141),
        ("grease_slight_contamination", 0.499, 0.0177, 1.887),
        ("grease_slight_contamination", 0.5, 0.0177, 1.677),
        ("grease_severe_contamination", 0.1, 0.0115, 2.662),
        ("grease_very_severe_contamination", 0.1, 0.00617, 4.06),
        ("none", 0.1, 0.0, 0.0),
    ],
)
def test_contamination_classes_of_grease_have_the_standards_constants(name, diameter, slope, loss):
    assert cleanliness(name, diameter) == (slope, loss)
    assert cleanliness("grease_high_cleanliness", 0.1) == cleanliness("bath_13_10", 0.1)


@pytest.mark.parametrize("name", catalog_names("greases"))
def test_every_grease_of_the_catalogue_is_known_by_its_name_and_read_back(name):
    found = scene(f"lubricant.grease={name.replace('_', ' ').upper()}")
    lubricant = found.lubricant
    assert lubricant.grease.name == name and lubricant.supply.law == "grease" and lubricant.mixture_fraction == 0.0
    assert lubricant.grease.source and lubricant.oil.base in ("mineral", "pao", "ester") and 5.0 < kinematic(lubricant.oil, 70.0) < 150.0
    assert scene_from_yaml(scene_to_yaml(found)) == found


def test_oil_and_grease_replace_each_other_in_overrides():
    greased = scene("lubricant.supply=oil_bath", "lubricant.grease=SKF LGLT 2")
    assert greased.lubricant.supply.law == "grease" and greased.lubricant.oil.viscosity_40 == pytest.approx(18e-6)
    assert scene("lubricant.grease=SKF LGLT 2", "lubricant.oil=ISO VG 46").lubricant.grease is None
    assert scene("lubricant.grease={preset: SKF LGLT 2, base_oil: ISO VG 46}").lubricant.oil.name == "ISO VG 46"
    assert scene("lubricant.supply=grease").lubricant.grease.thickener == "lithium"


@pytest.mark.parametrize(
    # eta [mPa s] and alpha [1/GPa] at 30, 60 and 100 degC: G. W. Stachowiak, A. W. Batchelor, Engineering Tribology, table 2.3
    ("viscosities", "coefficients"),
    [((153, 34, 9.1), (23.7, 20.5, 15.8)), ((250, 50.5, 12.6), (25.0, 21.3, 17.6)), ((18.6, 6.3, 2.4), (20, 16, 13))],
)
def test_alpha_of_mineral_oils_is_near_measured_ones_at_all_temperatures(viscosities, coefficients):
    found = [1e9 * class_pressure_viscosity("mineral", 1e-6 * viscosity / 0.87) for viscosity in viscosities]
    assert found == pytest.approx(coefficients, rel=0.27)
    assert all(each <= measured for each, measured in zip(found, coefficients)), "Gold's alpha is a mean up to 0.2 GPa"


@pytest.mark.parametrize("number", [32, 68, 150, 320])
@pytest.mark.parametrize("celsius", [20.0, 40.0, 80.0])
def test_alpha_of_mineral_oils_agrees_with_another_correlation(number, celsius):
    # C. S. Wu, E. E. Klaus, J. L. Duda, J. Tribol. 111 (1989) 121: alpha = (0.1657 + 0.2332 lg nu) m 1e-8, m the slope of Walther's line
    of = oil(f"ISO VG {number}")
    z = [math.log10(math.log10(kinematic(of, each) + 0.7)) for each in (40.0, 100.0)]
    slope = (z[0] - z[1]) / math.log10(373.15 / 313.15)
    assert 1e9 * oil_at(of, celsius + ZERO).pressure_viscosity == pytest.approx(
        10 * (0.1657 + 0.2332 * math.log10(kinematic(of, celsius))) * slope, rel=0.3
    )


def test_density_conductivity_and_heat_are_those_of_tables_of_oils():
    # A textbook's engine oil at 20 and 80 degC (F. P. Incropera, D. P. DeWitt, table A.5): 888 and 852 kg/m3, 0.145 and 0.138 W/(m K),
    # 1880 and 2131 J/(kg K)
    of = oil("ISO VG 220")
    for celsius, density, conductivity, heat in ((20, 888, 0.145, 1880), (80, 852, 0.138, 2131)):
        assert oil_at(of, celsius + ZERO).density == pytest.approx(density, rel=0.01)
        assert thermal_conductivity(of, celsius + ZERO) == pytest.approx(conductivity, rel=0.15)
        assert specific_heat(of, celsius + ZERO) == pytest.approx(heat, rel=0.05)
    assert (
        oil_at(oil("ISO VG 68 PAO"), 15 + ZERO).density
        < oil_at(oil("ISO VG 68"), 15 + ZERO).density
        < oil_at(oil("ISO VG 68 PAG"), 15 + ZERO).density
    )


def coefficient(name, celsius, slide_to_roll, pressure=0.8e9, rolling=2.5):
    """Return the coefficient of traction in a contact of steel with R = L = 10 mm at a mean pressure [Pa]."""
    of, modulus, size = oil(name), 2.26e11, 0.01
    stress, ratio = shear_strength(of.base, celsius + ZERO)
    constants = thermal_eyring_constants(1.0, oil_at(of, celsius + ZERO), size, modulus, size, stress, ratio, pressure_index(of))
    load = pressure**2 * 32 * size * size / (math.pi * modulus)
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.load], contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding] = load, rolling, slide_to_roll * rolling
    traction(contacts, constants, constants, FULL_FILMS)
    return contacts[0, CONTACT.force, 0] / load


@pytest.mark.parametrize("celsius", [0.0, 40.0, 80.0])
@pytest.mark.parametrize("slide_to_roll", [0.01, 0.1])
def test_traction_falls_from_mineral_oil_through_pao_and_ester_to_glycol(celsius, slide_to_roll):
    found = [coefficient(f"ISO VG 100 {base}", celsius, slide_to_roll) for base in ("mineral", "PAO", "ester", "PAG")]
    assert found == sorted(found, reverse=True) and found[0] < 0.09


@pytest.mark.parametrize("base", ["mineral", "PAO", "ester", "PAG"])
def test_cold_oil_drags_more_than_warm_oil_and_never_beyond_its_limiting_stress(base):
    found = [coefficient(f"ISO VG 68 {base}", celsius, 0.02) for celsius in (-20.0, 0.0, 40.0, 80.0, 120.0)]
    assert found == sorted(found, reverse=True)
    for celsius in (-20.0, 40.0):
        assert coefficient(f"ISO VG 68 {base}", celsius, 0.5) < shear_strength(base.lower(), celsius + ZERO)[1]


def test_an_oil_with_its_own_alpha_keeps_it_in_its_traction():
    assert pressure_index(CustomOil(viscosity_40=68e-6, pressure_viscosity=2e-8)) is None
    assert pressure_index(oil("MIL-PRF-7808")) is None and shear_strength("aviation", 260.0) == (5e6, 0.075)


def test_a_jets_flow_gives_the_mixtures_fraction_by_parkers_formula():
    # 1e5 Q^0.37/(n d_m^1.7), Q in cm^3/min, n in 1/min, d_m in mm; with a unit library and by hand
    registry = unit_registry()
    of = scene("lubricant.supply={law: oil_jet, flow: 2 l/min}", "operating.shaft_speed=12000 rpm")
    pitch = of.bearing.pitch_diameter
    flow, speed = registry.Quantity(2, "l/min").to("cm^3/min").magnitude, registry.Quantity(of.operating.shaft_speed, "rad/s").to("rpm").magnitude
    expected = 1e5 * flow**0.37 / (speed * registry.Quantity(pitch, "m").to("mm").magnitude ** 1.7)
    assert of.lubricant.mixture_fraction is None and mixture_fraction(of.lubricant, pitch, of.operating.shaft_speed) == pytest.approx(
        expected, rel=1e-4
    )
    assert expected == pytest.approx(0.1, rel=0.1)
    params = pack(of)
    lubrication = lubricate(of.lubricant, params, 343.15)
    density = oil_at(of.lubricant.oil, 343.15).density
    for at in (of.operating.shaft_speed, -2 * of.operating.shaft_speed, 0.0):
        assert mixture_density(at, lubrication) == pytest.approx(density * mixture_fraction(of.lubricant, pitch, at), rel=1e-12)
    assert swept_fraction(28e-6, 0.0627) / 4712.4 == pytest.approx(0.03, rel=0.05), "the default flow and the default fraction of the paper's bearing"
    given = scene("lubricant.supply={law: oil_jet, flow: 2 l/min}", "lubricant.mixture_fraction=0.02")
    assert mixture_density(900.0, lubricate(given.lubricant, params, 343.15)) == pytest.approx(0.02 * density), "the given fraction wins"


def test_each_supply_has_its_drag_its_replenishment_and_its_flow():
    laws = ("oil_jet", "circulating", "oil_bath", "oil_air", "grease")
    scenes = {law: scene(f"lubricant.supply={law}", "heat.law=network") for law in laws}
    params = pack(scenes["oil_bath"])
    found = {law: lubricate(each.lubricant, params, 343.15) for law, each in scenes.items()}
    assert {law: each.mixture_density > 0 for law, each in found.items()} == {law: law == "oil_jet" for law in laws}
    assert found["circulating"].bath == pytest.approx([2 * each for each in found["oil_bath"].bath]), "SKF: a jet drags twice as much as a low bath"
    assert all(tuple(found[law].bath) == (0.0, 0.0) for law in ("oil_jet", "oil_air", "grease"))
    assert {law: replenishment(each.lubricant, params.rollers.radius) for law, each in scenes.items()} == {
        law: 6e-8 if law in ("oil_air", "grease") else 3e-8 for law in laws
    }
    assert {law for law, each in scenes.items() if oil_flow(each) > 0} == {"oil_jet", "circulating"}
    assert oil_flow(scene("lubricant.supply={law: circulating, flow: 3 l/min}", "heat.law=network")) == pytest.approx(5e-5)


def test_beyond_the_oils_of_its_model_a_bath_drags_like_a_cylinder_in_a_thick_flow():
    nu_210 = {"bore_diameter": 0.05, "outside_diameter": 0.09, "width": 0.02}
    displacing, rubbing = zip(*(bath_moment(5.5e-3, 314.0, viscosity, **nu_210) for viscosity in (250e-6, 500e-6, 5000e-6)))
    assert displacing[0] == displacing[2] and rubbing[1] == pytest.approx(rubbing[0] * 2**1.379)
    assert rubbing[2] == pytest.approx(rubbing[1] * 10**0.37)


def test_what_a_name_alone_says_about_an_oil_enters_the_uncertainty():
    found = {one.field: one for one in ranges_of(scene()) if one.field.startswith("lubricant.")}
    assert found.keys() == {"lubricant.traction_scale", "lubricant.oil.viscosity_40"}
    assert (found["lubricant.oil.viscosity_40"].low, found["lubricant.oil.viscosity_40"].high) == pytest.approx((61.2e-6, 74.8e-6))
    scale = found["lubricant.traction_scale"]
    assert scale.low * scale.high == pytest.approx(1.0) and scale.distribution == "log_uniform" and "assumption" in scale.source
    own = ranges_of(scene("uncertainty.lubricant.traction_scale=[0.9, 1.1]"))
    assert [one.high for one in own if one.field == "lubricant.traction_scale"] == [1.1], "a scene's own range counts"
    aviation = ranges_of(scene("lubricant.oil=MIL-PRF-23699"))
    measured = ranges_of(scene("lubricant.oil={viscosity_40: 70 mm^2/s, viscosity_100: 9 mm^2/s}", "lubricant.traction={law: constant, b: 0.5}"))
    assert not any(one.field.startswith("lubricant.") for one in (*aviation, *measured))


@pytest.mark.parametrize(
    ("base", "stress", "ratio"), [("mineral", 5e6, 0.07), ("pao", 5e6, 0.055), ("ester", 5e6, 0.05), ("pag", 4.5e6, 0.04), ("aviation", 5e6, 0.075)]
)
def test_shear_strengths_at_40_degrees_are_those_of_the_theory_page(base, stress, ratio):
    assert shear_strength(base, 40.0 + ZERO) == pytest.approx((stress, ratio))
