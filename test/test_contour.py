# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Contours of the outer raceway: forms, measured files, and the one table that they all become."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.physics.raceway import TABLE_INTERVALS, contour_at, tabulated
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.bearing import ContourPoint, OuterRaceway
from bearing_sim.scene.contour import ContourError, measured_spline, outer_contour, read_contour
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

LOW, D = 34.8625e-3, 98e-6


def trilobe(azimuth):
    return LOW + D / 2 * (1 - np.cos(3 * azimuth))


def text_of(angles, radii, header="angle [deg], radius [mm]"):
    return "\n".join([header, *(f"{math.degrees(a):.9g}, {1e3 * r:.9g}" for a, r in zip(angles, radii))])


def even(count, start=0.0):
    return start + 2 * math.pi * np.arange(count) / count


def table_radii(table, azimuths):
    return np.array([contour_at(table, a % (2 * math.pi) / (2 * math.pi) * len(table))[0] for a in azimuths])


def raceway_with(*overrides):
    return load_scene("deng2017_table1", [f"bearing.outer_raceway.{override}" for override in overrides]).bearing.outer_raceway


def test_roundness_spreads_the_lows_and_lets_the_next_high_fall_where_a_low_rises():
    e, third = 6e-6, 2 * math.pi / 3
    raceway = OuterRaceway(low_radius=LOW, d_value=D, lobes=3, roundness=e)
    lows, low_slopes = outer_contour(raceway, third * np.arange(3))
    highs, high_slopes = outer_contour(raceway, third * (np.arange(3) + 0.5))
    np.testing.assert_allclose(lows, LOW + e * np.array([-0.5, 0, 0.5]), atol=1e-15)
    np.testing.assert_allclose(highs, LOW + D + e * np.array([0.5, 0, -0.5]), atol=1e-15)
    np.testing.assert_allclose([*low_slopes, *high_slopes], 0.0, atol=1e-12)


def test_vanishing_roundness_is_the_ideal_contour():
    azimuths = np.linspace(0, 7, 500)
    nearly = outer_contour(OuterRaceway(low_radius=LOW, d_value=D, roundness=1e-14), azimuths)
    ideal = outer_contour(OuterRaceway(low_radius=LOW, d_value=D), azimuths)
    np.testing.assert_allclose(nearly[0], ideal[0], atol=1e-13)
    np.testing.assert_allclose(nearly[1], ideal[1], atol=1e-11)


FORMS = {
    "lobes": OuterRaceway(low_radius=LOW, d_value=D, lobes=5, installation_angle=0.3),
    "one lobe": OuterRaceway(low_radius=LOW, d_value=D, lobes=1),
    "roundness": OuterRaceway(low_radius=LOW, d_value=D, lobes=2, roundness=8e-6, installation_angle=-0.7),
    "points": OuterRaceway(
        low_points=tuple(ContourPoint(azimuth=a, radius=r) for a, r in ((0.1, LOW), (2.3, LOW + 2e-6), (4.0, LOW - 3e-6))),
        high_points=tuple(ContourPoint(azimuth=a, radius=r) for a, r in ((1.0, LOW + D), (3.1, LOW + 1.1 * D), (5.4, LOW + 0.9 * D))),
        installation_angle=1.1,
    ),
    "measured": OuterRaceway(contour=text_of(even(90, 0.02), trilobe(even(90, 0.02))), installation_angle=0.4),
}


@pytest.mark.parametrize("raceway", FORMS.values(), ids=FORMS)
def test_every_form_is_periodic_and_smooth_with_its_slope(raceway):
    azimuths, step = np.linspace(-7, 7, 999), 1e-6
    radius, slope = outer_contour(raceway, azimuths)
    np.testing.assert_allclose(outer_contour(raceway, azimuths + 2 * math.pi)[0], radius, atol=1e-15)
    difference = (outer_contour(raceway, azimuths + step)[0] - outer_contour(raceway, azimuths - step)[0]) / (2 * step)
    np.testing.assert_allclose(slope, difference, atol=2e-9)


@pytest.mark.parametrize("raceway", FORMS.values(), ids=FORMS)
def test_the_table_is_every_form_to_a_nanometre(raceway):
    table = tabulated(lambda azimuth: outer_contour(raceway, azimuth))
    azimuths = np.random.default_rng(1).uniform(0, 2 * math.pi, 2000)
    np.testing.assert_allclose(table_radii(table, azimuths), outer_contour(raceway, azimuths)[0], atol=1e-9)


def test_the_table_of_a_finely_measured_rough_contour_is_within_a_nanometre():
    # 1,000 points with 0.1 um of noise, none of them on a knot of the usual table
    angles = even(1000, 0.001)
    raceway = OuterRaceway(contour=text_of(angles, trilobe(angles) + 1e-7 * np.random.default_rng(2).normal(size=1000)), installation_angle=0.2)
    table = tabulated(lambda azimuth: outer_contour(raceway, azimuth))
    assert len(table) > TABLE_INTERVALS
    azimuths = np.random.default_rng(3).uniform(0, 2 * math.pi, 5000)
    np.testing.assert_allclose(table_radii(table, azimuths), outer_contour(raceway, azimuths)[0], atol=1e-9)


def test_a_coarsely_measured_contour_is_read_as_the_smooth_one_it_was():
    # 24 points on three lobes: the curve between them is not better than measured, and not invented either
    raceway = OuterRaceway(contour=text_of(even(24, 0.05), trilobe(even(24, 0.05))))
    azimuths = np.linspace(0, 2 * math.pi, 1000)
    np.testing.assert_allclose(outer_contour(raceway, azimuths)[0], trilobe(azimuths), atol=0.02 * D)
    assert raceway.lobes == 3 and raceway.low_radius == pytest.approx(LOW, abs=0.01 * D) and raceway.d_value == pytest.approx(D, rel=0.02)


def test_points_too_few_for_their_contour_are_refused():
    with pytest.raises(ValueError, match="12 points are too few for this contour: .* leaves the measured radii by 1[0-9.]* um"):
        OuterRaceway(contour=text_of(even(12, math.pi / 12), trilobe(even(12, math.pi / 12))))


@given(st.sampled_from(["angle_deg,radius_mm", "angle [deg]; radius [mm]", "azimuth (deg)\tradius (mm)", "phi [deg] radius [mm]"]))
def test_headers_carry_the_units_however_columns_are_parted(header):
    part = next(mark for mark in ";\t, " if mark in header)
    decimal = "," if part == ";" else "."
    lines = [part.join(f"{number:.6f}".replace(".", decimal) for number in (15.0 * k, 34.9)) for k in range(24)]
    angles, radii = read_contour("\n".join(["# profile 7", header, *lines, ""]))
    np.testing.assert_allclose(angles, even(24), atol=1e-9)
    np.testing.assert_allclose(radii, 34.9e-3)


def test_columns_may_come_the_other_way_round_and_units_from_the_scene():
    swapped = read_contour("radius [um], angle [rad]\n" + "\n".join(f"34900, {a}" for a in even(12)))
    np.testing.assert_allclose(swapped[0], even(12))
    np.testing.assert_allclose(swapped[1], 34.9e-3)
    bare = read_contour("\n".join(f"{30 * k} 34.9" for k in range(12)), "deg", "mm")
    np.testing.assert_allclose(bare[0], even(12))


def test_a_closed_turn_loses_its_repeated_point():
    angles, radii = read_contour(text_of(np.linspace(0, 2 * math.pi, 73), trilobe(np.linspace(0, 2 * math.pi, 73))))
    assert len(angles) == len(radii) == 72


GOOD = [f"{10 * k}, {1e3 * trilobe(math.radians(10 * k)):.7f}" for k in range(36)]


def changed(**lines):
    return "\n".join(["angle [deg], radius [mm]", *(lines.get(f"l{k}", line) for k, line in enumerate(GOOD) if lines.get(f"l{k}") != "")])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "the contour is empty"),
        ("\n".join(GOOD), "the angle has no unit.*the radius has no unit"),
        ("angle [furlong], radius [mm]\n" + "\n".join(GOOD), "angle unit: "),
        ("angle [deg], weight [mm]\n" + "\n".join(GOOD), "expected a header such as"),
        ("radius [mm], r [mm]\n" + "\n".join(GOOD), "expected one angle and one radius"),
        ("angle [deg], radius [mm]\n" + "\n".join(GOOD[:11]), "11 points"),
        (changed(l5="50, nan", l7="70; inf"), "line 7: '50, nan' is not finite.*line 9"),
        (changed(l5="50", l7="70, x"), "line 7: expected an angle and a radius.*line 9"),
        (changed(l5="40, 34.9"), "line 7: the angle 40 deg is repeated"),
        (changed(l5="35, 34.9"), "line 7: the angle decreases from 40 to 35 deg"),
        (changed(l5="50, 34900"), "line 7: radius outside 1 mm to 2 m; check the unit"),
        (changed(**{f"l{k}": "" for k in (8, 9, 10)}), "a gap of 40 deg after 70 deg; the usual spacing is 10 deg"),
        (changed(**{f"l{k}": "" for k in range(28, 36)}), "after 270 deg; .*the turn is not complete"),
        (changed(l35="360, 34.9"), "the turn does not close: its ends differ by 37.5 um"),
        (changed(l35="375, 34.9"), "the angles cover 375 deg"),
    ],
)
def test_errors_in_a_file_are_reported_with_line_and_reason(text, expected):
    with pytest.raises(ContourError, match=expected):
        read_contour(text)


@given(st.text(alphabet="0123456789.,;# \n-eanglrdius[]m", max_size=80))
def test_no_text_crashes_the_reader(text):
    with pytest.raises(ContourError):
        measured_spline(text, "deg", "mm")


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["contour_file=nowhere.csv"], "contour_file = 'nowhere.csv': no such file"),
        (["contour_file=CONTOUR", "low_radius=34.9 mm"], "low_radius: follows from the points of the contour \\(34.8625 mm\\); leave it out"),
        (["contour_file=CONTOUR", "roundness=4 um"], "contour and roundness exclude each other"),
        (["contour_fil=CONTOUR"], "did you mean 'contour_file'"),
        (["contour_angle_unit=deg"], "contour_angle_unit: applies only to a contour from a file"),
        (["contour_file=CONTOUR", "contour_angle_unit=rad"], "the header says deg for the angle, the scene rad"),
        (["roundness=4 um", "lobes=1"], "roundness: needs two or more low points"),
        (["roundness=0.2 mm"], "roundness: expected less than d_value"),
        (["low_points=[{azimuth: 0 deg, radius: 34.86 mm}]"], "low_points: 1 for 0 high_points"),
        (
            ["low_points=[{azimuth: 0, radius: 34.86 mm}, {azimuth: 1, radius: 34.86 mm}]",
             "high_points=[{azimuth: 2, radius: 34.9 mm}, {azimuth: 3, radius: 34.9 mm}]"],
            "no high point between 0 and 57.2958 deg; high_points: no low point between 114.592 and 171.887 deg",
        ),
        (["low_points=[{azimuth: 0, radius: 34.9 mm}]", "high_points=[{azimuth: 3, radius: 34.8 mm}]"], "the low point is not lower"),
        (["low_points=[{azimuth: 0, radius: 34.8 mm}]", "high_points=[{azimuth: 0.01, radius: 34.9 mm}]"], "less than 2 deg apart"),
    ],
)  # fmt: skip
def test_contours_that_contradict_themselves_say_how(tmp_path, overrides, expected):
    (tmp_path / "c.csv").write_text(text_of(even(72), trilobe(even(72))))
    with pytest.raises(SceneError, match=expected):
        raceway_with(*(override.replace("CONTOUR", str(tmp_path / "c.csv")) for override in overrides))


def test_a_missing_file_is_reported_together_with_the_other_errors_of_the_scene():
    with pytest.raises(SceneError) as error:
        load_scene("deng2017_table1", ["bearing.outer_raceway.contour_file=nowhere.csv", "bearing.roller.cout=3"])
    assert {each.path for each in error.value.errors} == {"bearing.roller.cout", "bearing.outer_raceway.contour_file"}


def scene_with_contour(tmp_path):
    (tmp_path / "made").mkdir()
    (tmp_path / "made/ring_7.csv").write_text("# ring 7\n" + text_of(even(72), trilobe(even(72))) + "\n")
    (tmp_path / "scene.yaml").write_text(
        "name: measured\nbearing: {preset: deng2017_table1, outer_raceway: {contour_file: made/ring_7.csv, installation_angle: 10 deg}}\n"
        "lubricant: {oil: mil_l_7808}\noperating: {shaft_speed: 45000 rpm, radial_load: 800 N}\n"
    )
    return load_scene(tmp_path / "scene.yaml")


def test_a_contour_file_is_looked_for_beside_the_scene_and_kept_in_it(tmp_path):
    scene = scene_with_contour(tmp_path)
    raceway = scene.bearing.outer_raceway
    assert raceway.contour_file == "ring_7.csv" and raceway.contour.startswith("# ring 7")
    assert (raceway.low_radius, raceway.d_value, raceway.lobes) == pytest.approx((LOW, D, 3), rel=1e-6)
    (tmp_path / "made/ring_7.csv").unlink()
    assert scene_from_yaml(scene_to_yaml(scene)) == scene
    assert str(tmp_path) not in scene_to_yaml(scene)


def test_a_recording_holds_the_contour_that_was_simulated(tmp_path):
    scene = scene_with_contour(tmp_path)
    run = Simulation(scene)
    with McapSink(tmp_path / "run.mcap", scene, 0) as sink:
        sink.write(run.advance(1e-3, samples=5))
    (tmp_path / "made/ring_7.csv").unlink()
    assert Recording(tmp_path / "run.mcap").scene == scene


def test_a_measured_trilobe_slips_as_the_trilobe(tmp_path):
    (tmp_path / "c.csv").write_text(text_of(even(720), trilobe(even(720))))
    measured, ideal = [f"bearing.outer_raceway.contour_file={tmp_path / 'c.csv'}"], []
    slips = [Simulation(load_scene("deng2017_table1", overrides)).advance(5e-3)["cage_slip"][0] for overrides in (measured, ideal)]
    assert slips[0] == pytest.approx(slips[1], rel=1e-4)


def test_turning_a_measured_contour_turns_its_radii():
    turned = OuterRaceway(contour=text_of(even(72), trilobe(even(72))), installation_angle=0.5)
    straight = OuterRaceway(contour=text_of(even(72), trilobe(even(72))))
    azimuths = np.linspace(0, 6, 50)
    np.testing.assert_allclose(outer_contour(turned, azimuths)[0], outer_contour(straight, azimuths - 0.5)[0], atol=1e-15)


def test_points_given_later_replace_the_form_given_before(tmp_path):
    (tmp_path / "c.csv").write_text(text_of(even(72), trilobe(even(72)) + 1e-5))
    before = scene_with_contour(tmp_path)
    after = scene_from_yaml(scene_to_yaml(before), [f"bearing.outer_raceway.contour_file={tmp_path / 'c.csv'}"])
    assert after.bearing.outer_raceway.low_radius == pytest.approx(LOW + 1e-5, rel=1e-6)
    points = ["low_points=[{azimuth: 0, radius: 34.86 mm}]", "high_points=[{azimuth: 3, radius: 34.95 mm}]"]
    last = scene_from_yaml(scene_to_yaml(after), [f"bearing.outer_raceway.{point}" for point in points]).bearing.outer_raceway
    assert last.contour is None and last.lobes == 1 and last.d_value == pytest.approx(90e-6)
