# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Scene files may give diameters wherever records hold radii."""

import pytest

from bearing_sim.scene.diameters import diameters
from bearing_sim.scene.loader import SceneError, load_scene, scene_from_mapping
from bearing_sim.scene.quantity import to_si
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities
from bearing_sim.sweep.grid import field_of

REST = {"name": "motor", "lubricant": {"oil": "iso_vg_32"}, "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"}}


def scene_with(bearing, **blocks):
    return scene_from_mapping({**REST, "bearing": {"preset": "nu210", **bearing}, **blocks})


def test_a_bearing_by_diameters_is_the_bearing_by_radii():
    by_diameters = scene_with({"inner_raceway": {"diameter": "59.4 mm", "bore_diameter": "50 mm"}, "outer_raceway": {"outside_diameter": "90 mm"}})
    by_radii = scene_with({"inner_raceway": {"radius": "29.7 mm", "bore_radius": "25 mm"}, "outer_raceway": {"outside_radius": "45 mm"}})
    assert by_diameters == by_radii


def test_the_diameter_of_a_round_raceway_replaces_the_clearance_of_the_preset():
    assert scene_with({"outer_raceway": {"diameter": "81.55 mm"}}).bearing.radial_clearance_at_low_points == pytest.approx(0.5 * 50e-6, abs=1e-12)


@pytest.mark.parametrize("path", [path for path in diameters(Scene) if not path.endswith("outer_raceway.diameter")])
def test_every_radius_has_a_diameter_of_twice_its_bounds(path):
    found = diameters(Scene)[path]
    radius = quantities(Scene)[found.radius]
    assert (found.quantity.minimum, found.quantity.maximum) == (2 * radius.minimum, 2 * radius.maximum)
    assert found.radius.replace("radius", "diameter") == path and found.quantity.read("50 mm", written=True) / 2 == pytest.approx(to_si("25 mm", "m"))


def test_all_faults_of_diameters_come_at_once_in_the_words_of_the_file():
    with pytest.raises(SceneError) as caught:
        inner = {"radius": "29.75 mm", "diameter": "59.5 mm"}
        bearing = {"outer_raceway": {"diameter": "81.55 apples"}, "inner_raceway": inner, "cage": {"outer_diameter": 81}}
        scene_with(bearing, uncertainty={"bearing.inner_raceway.bore_diameter": ["49.99 mm", "50.01 pears"]})
    told = {error.path: error.reason for error in caught.value.errors}
    assert "unknown unit 'apples'" in told["bearing.outer_raceway.diameter"]
    assert "radius is given, too ('29.75 mm'); give one of the two" in told["bearing.inner_raceway.diameter"]
    assert told["bearing.cage.outer_diameter"] == "81 m is outside 2 mm to 4000 mm; a bare number is SI: write 81 mm?"
    assert "unknown unit 'pears'" in told["uncertainty.bearing.inner_raceway.bore_diameter.high"]
    assert len(told) == 4, "and no consequences of them"


@pytest.mark.parametrize(
    "given", [["bearing.outer_raceway.diameter=69.73mm"], ["bearing.outer_raceway.low_radius=34mm", "bearing.outer_raceway.diameter=69.73mm"]]
)
def test_a_raceway_with_lobes_has_no_one_diameter(given):
    with pytest.raises(SceneError, match="this raceway has lobes, and no one diameter; give low_diameter or low_radius"):
        load_scene("deng2017_table1", given)


def test_the_last_override_of_a_radius_or_its_diameter_counts():
    both = ["bearing.outer_raceway.low_radius=34.863mm", "bearing.outer_raceway.low_diameter=69.73mm"]
    assert load_scene("deng2017_table1", both).bearing.outer_raceway.low_radius == pytest.approx(34.865e-3)
    assert load_scene("deng2017_table1", both[::-1]).bearing.outer_raceway.low_radius == pytest.approx(34.863e-3)


def test_ranges_of_diameters_become_ranges_of_radii():
    ranges = {"bearing.inner_raceway.diameter": {"low": "59.49 mm", "high": "59.51 mm", "source": "drawing"}}
    (one,) = scene_with({}, uncertainty=ranges).uncertainty
    assert (one.field, one.source) == ("bearing.inner_raceway.radius", "drawing")
    assert (one.low, one.high) == pytest.approx((29.745e-3, 29.755e-3), rel=1e-12)


def test_a_sweep_takes_a_diameter():
    field = field_of("bearing.outer_raceway.low_diameter")
    assert field.unit == "mm" and field.shown(0.06973) == pytest.approx(69.73)
