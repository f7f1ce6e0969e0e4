# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The study of the housing: bending and sliding of a ring against closed forms and finite differences; plays, limits and messages."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.physics.outer_ring import RingSection, ring_compliance
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies import clearance_map, housing_map
from bearing_sim.studies.housing_map import PLAY, bending_moment, endurance_limit, map_housings, ring_facts, row_at, seat_slide, solved

RADIUS, THICKNESS, WIDTH, MODULUS = 35.8e-3, 3.4e-3, 10e-3, 206e9
MASSIVE = "mounting.housing.backing={law: elastic, massive: true, play: 2 um}"
CATALOGUE = {
    "name": "nu210",
    "level": "steady",
    "bearing": "NU 210/C3",
    "lubricant": {"oil": "ISO VG 68", "temperature": "50 degC"},
    "operating": {"shaft_speed": "1500 rpm", "radial_load": "8 kN"},
}
LOBED = ("bearing.outer_raceway.lobes=3", "bearing.outer_raceway.d_value=0.1 mm", "bearing.outer_raceway.low_radius=40.74 mm")


def section(shear=True):
    return RingSection(RADIUS, WIDTH * THICKNESS**3 / 12, WIDTH * THICKNESS, MODULUS, 0.385 * MODULUS if shear else math.inf)


def catalogue(*overrides):
    return load_scene(CATALOGUE, overrides)


def lobed(*overrides):
    """Return a bearing of 16 rollers, no whole number of which stands on each of its three lobes, that nothing but its lobes preloads."""
    return catalogue(*LOBED, "operating.radial_load=2 kN", *overrides)


FORCES = np.array([(0.0, 700.0), (0.9, -300.0), (2.5, 450.0), (4.0, 200.0)])  # azimuth [rad], force outwards [N]


def test_a_force_that_a_cosine_pressure_balances_bends_a_ring_by_its_closed_form():
    assert bending_moment(0.0, RADIUS) == pytest.approx(3 / (4 * math.pi) * RADIUS, rel=1e-12)
    n, behind = np.arange(2, 200_000), np.array([0.0, 0.4, 2.0, -1.1])
    series = RADIUS / math.pi * np.cos(np.multiply.outer(behind, n)) @ (1.0 / (n * n - 1.0))
    assert bending_moment(behind, RADIUS) == pytest.approx(series, rel=1e-4)


def test_the_bending_moment_is_the_change_of_curvature_of_the_deflection():
    ring, n, step = section(shear=False), np.arange(2, 3000), 2e-3
    at = np.array([0.4, 1.7, 3.2, 5.5])

    def deflection(phi):
        return sum(force * np.cos(np.multiply.outer(phi - azimuth, n)) @ ring_compliance(n, ring) for azimuth, force in FORCES)

    curved = (deflection(at + step) - 2 * deflection(at) + deflection(at - step)) / step**2 + deflection(at)
    moment = sum(force * bending_moment(at - azimuth, RADIUS) for azimuth, force in FORCES)
    assert moment == pytest.approx(-MODULUS * ring.second_moment / RADIUS**2 * curved, rel=1e-3)


def test_the_seat_slides_as_a_ring_does_that_bends_without_stretching():
    ring, n, step, offset = section(shear=False), np.arange(2, 61), 1e-4, 1.7e-3
    at = np.linspace(0.0, 6.0, 7)

    def deflection(phi):
        return np.cos(np.multiply.outer(phi, n)) @ ring_compliance(n, ring)

    def slide(phi, offset=0.0):
        return seat_slide(phi, offset, ring, 60)

    assert (slide(at + step) - slide(at - step)) / (2 * step) == pytest.approx(-deflection(at), rel=1e-5)
    slope = (deflection(at + step) - deflection(at - step)) / (2 * step)
    assert slide(at, offset) == pytest.approx(slide(at) - offset / RADIUS * (slope - slide(at)), rel=1e-5, abs=1e-14)


def test_shear_lets_the_neutral_line_slide_farther_but_turns_no_section():
    stiff, soft, n = section(shear=False), section(), np.arange(2, 31)
    at = np.array([0.3, 1.0])
    turned = [seat_slide(at, 1e-3, ring, 30) - seat_slide(at, 0.0, ring, 30) for ring in (stiff, soft)]
    assert turned[0] == pytest.approx(turned[1], rel=1e-9)
    more = np.sin(np.multiply.outer(at, n)) @ ((ring_compliance(n, stiff) - ring_compliance(n, soft)) / n)
    assert seat_slide(at, 0.0, soft, 30) - seat_slide(at, 0.0, stiff, 30) == pytest.approx(more, rel=1e-9)


def test_the_endurance_limit_is_half_the_strength_and_at_most_700_mpa():
    assert endurance_limit(1e9) == 5e8 and endurance_limit(1.5e9) == 7e8


@pytest.mark.parametrize("backing", ["free", "{law: elastic, massive: true, play: 3 um}"])
def test_forces_of_rollers_and_seat_balance_the_ring_and_deflect_it_as_found(backing):
    scene = lobed(f"mounting.housing.backing={backing}")
    _, pitch = solved(scene)
    count, points = pitch.rollers.shape[1], pitch.seat.shape[1]
    around, seats = 2 * np.pi * np.arange(count) / count, 2 * np.pi * np.arange(points) / max(points, 1)
    along = np.exp(1j * pitch.angles)
    assert (pitch.inner @ np.exp(1j * around)) * along == pytest.approx(scene.operating.radial_load, rel=1e-4)
    if points:
        assert pitch.rollers @ np.exp(1j * around) == pytest.approx(pitch.seat @ np.exp(1j * seats), rel=1e-4)
    geometry, n = housing_map.ring_geometry(scene.bearing), np.arange(count * 16 // 2 + 1)
    modulus = scene.bearing.material.youngs_modulus
    ring = RingSection(geometry.radius, geometry.second_moment, geometry.area, modulus, modulus / 2.6)
    at, forces = np.concatenate([around, seats]), np.hstack([pitch.rollers, -pitch.seat])
    influence = np.cos(np.multiply.outer(np.subtract.outer(around, at), n)) @ ring_compliance(n, ring)
    assert pitch.deflections == pytest.approx(forces @ influence.T, rel=1e-3, abs=2e-9)


def test_turning_load_and_raceway_together_changes_nothing():
    first, second = (
        row_at(lobed(MASSIVE, f"operating.load_angle={angle} deg", f"bearing.outer_raceway.installation_angle={angle} deg"), "cast_iron", 3e-6)
        for angle in (0, 37)
    )
    for name, tolerance in (("cage_slip", 1e-3), ("life", 2e-3), ("inner_load_maximum", 1e-3), ("seat_pressure", 1e-3), ("seat_arc", 1e-9)):
        assert second[name] == pytest.approx(first[name], rel=tolerance), name


def test_a_rigid_ring_is_the_scene_without_a_housing():
    scene = lobed()
    row, operating = row_at(scene, "rigid", 0.0), scene.operating
    known = clearance_map.row_at(scene, operating.shaft_speed, operating.radial_load)
    assert (row["cage_slip"], row["life"]) == (known["cage_slip"], known["life"])
    assert math.isnan(row["seat_arc"]) and math.isnan(row[PLAY]) and row["bending_clearance"] == 0.0


def test_the_fit_of_the_scene_gives_way_to_the_play_that_is_asked_for():
    fitted = catalogue("mounting.housing.fit=H7", "mounting.housing.backing={law: elastic, massive: true}")
    within = housing_map.scene_in(fitted, "scene", 4e-6).mounting.housing
    assert within.fit is None and within.backing.play == 4e-6
    assert housing_map.housings_of(fitted)[0] == "scene" and "scene" not in housing_map.housings_of(catalogue())


def test_waves_of_the_bore_are_those_of_the_scene_in_every_housing():
    waves = "mounting.housing.backing={law: rigid_bore, play: 2 um, bore_waves: [{waves: 2, amplitude: 3 um, azimuth: 20 deg}]}"
    scene = catalogue(waves)
    for housing in ("aluminium", "rigid_bore", "scene"):
        assert housing_map.scene_in(scene, housing, 1e-6).mounting.housing.backing.bore_waves == scene.mounting.housing.backing.bore_waves


def test_the_largest_play_is_where_slip_passes_its_limit_and_the_smallest_where_life_does():
    scene = load_scene("deng2017_table1")
    found = map_housings(scene, ["steel"], [0.0, 3e-6], 0.1, 800.0)
    slip, life = found.limits
    assert (slip.kind, slip.verdict, life.kind, life.verdict) == ("slip", "bounded", "life", "bounded")
    below, above = (row_at(scene, "steel", play)["cage_slip"] for play in (slip.play, slip.play + 5e-8))
    assert below < 10.0 <= above
    shorter, longer = (row_at(scene, "steel", play)["life"] for play in (life.play - 5e-8, life.play))
    assert shorter <= 800.0 < longer
    assert [each.verdict for each in map_housings(scene, ["steel"], [0.0, 1e-6], 0.01, 1e6).limits] == ["none", "none"]
    assert [each.verdict for each in map_housings(scene, ["steel"], [0.0, 1e-6], 0.9, 1.0).limits] == ["any", "any"]


def test_plays_without_a_result_leave_a_limit_unknown_that_the_others_do_not_decide(monkeypatch):
    def row(scene, housing, play):
        known = play < 1.5e-6
        return {"housing": housing, PLAY: 1e6 * play, "status": "ok" if known else "failed", "cage_slip": 5.0, "life": 100.0}

    monkeypatch.setattr(housing_map, "row_at", row)
    for slip, life, verdicts in ((0.1, 200.0, ["unknown", "unknown"]), (0.01, 50.0, ["none", "any"])):
        found = map_housings(load_scene("deng2017_table1"), ["steel"], [1e-6, 2e-6], slip, life)
        assert [each.verdict for each in found.limits] == verdicts


def test_a_soft_housing_takes_more_of_the_preload_of_lobes_than_a_stiff_one():
    soft, stiff = (row_at(lobed(), housing, 0.0) for housing in ("aluminium", "steel"))
    rigid = row_at(lobed(), "rigid", 0.0)
    assert rigid["inner_load_maximum"] > stiff["inner_load_maximum"] > soft["inner_load_maximum"]
    assert soft["life"] > stiff["life"] > rigid["life"] and soft["seat_pressure"] < stiff["seat_pressure"]


def test_a_free_ring_has_no_seat_and_bends_less_than_one_force_would_bend_it():
    scene = catalogue("mounting.housing.backing=free")
    found, geometry = ring_facts(scene), housing_map.ring_geometry(scene.bearing)
    assert math.isnan(found.least_arc) and math.isnan(found.seat_pressure) and math.isnan(found.micromotion)
    bound = geometry.bending_stress(3 / (4 * math.pi) * scene.operating.radial_load * geometry.radius)
    assert 0.05 * bound < max(found.largest_stress, -found.least_stress) < bound
    assert found.stress_range <= found.largest_stress - found.least_stress
    assert len(housing_map.facts_in_words(found)) == 3 and ring_facts(catalogue()) is None


def test_a_seat_that_touches_all_around_slides_less_than_its_points_lie_apart():
    found = ring_facts(lobed(MASSIVE.replace("2 um", "-20 um")))
    assert found.least_arc == found.largest_arc == pytest.approx(2 * math.pi)
    assert 0.0 < found.micromotion < 1e-5


def run(*words):
    return CliRunner().invoke(main, ["study", "housing", "deng2017_table1", *words])


@pytest.mark.parametrize(
    "words, message",
    [
        (["--housing", "aluminum"], "did you mean 'aluminium'"),
        (["--housing", "scene"], "mounting.housing.backing is rigid, which has no play"),
        (["--play", "0:5:3"], "unit"),
        (["--play", "0um:5um"], "START:STOP:N"),
        (["--slip-below", "120 %"], "--slip-below"),
        (["--set", "operating.shaft_speed=0 rpm"], "operating.shaft_speed: 0"),
        (["--set", "bearing.outer_ring={neutral_radius: 50 mm}", "--housing", "steel"], "bearing.outer_ring.neutral_radius"),
    ],
)
def test_wrong_inputs_are_refused_with_the_reason(words, message):
    found = run(*words)
    assert found.exit_code == 2 and message in found.output, found.output


def test_the_command_writes_table_and_picture_and_says_what_it_finds(tmp_path):
    words = ["--set", MASSIVE, "--play", "0um:2um:2", "--housing", "scene", "--housing", "rigid", "--slip-below", "10%", "--json"]
    found = run(*words, "-o", str(tmp_path / "map.parquet"), "--picture", str(tmp_path / "map.png"))
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    assert [row["housing"] for row in report["points"]] == ["scene", "scene", "rigid"] and report["points"][-1][PLAY] is None
    assert report["found"][0].startswith("scene: slip stays below 10 % up to a play of ") and report["limits"][0]["verdict"] == "bounded"
    assert 0.0 < report["ring"]["stress_range"] < report["ring"]["endurance_limit"] == 7e8
    assert (tmp_path / "map.csv").read_text().startswith("housing,mounting.housing.backing.play [um],cage_slip [%],life [h]")
    assert (tmp_path / "map.png").stat().st_size > 10_000
