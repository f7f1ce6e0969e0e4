# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pre-deformation machining: the ring against closed forms and textbooks, the contour against Deng 2017, Fig. 3, and its file in a scene."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp

from bearing_sim import load_scene
from bearing_sim.cli.main import main
from bearing_sim.scene.contour import outer_contour
from bearing_sim.scene.loader import load_bearing
from bearing_sim.scene.outer_ring import ring_geometry
from bearing_sim.studies.machining import Blank, Pressing, deflection, machine, pressure_harmonics

SECTION = Blank(mean_radius=35.8e-3, width=12e-3, thickness=3.4e-3, modulus=2.06e11)
TURN = np.linspace(0, 2 * math.pi, 3601)


@pytest.mark.parametrize("n", [2, 3, 7])
def test_one_harmonic_bends_the_ring_as_its_differential_equation_says(n):
    # Thin ring without stretch, pressure q cos(n phi): w'''''' + 2 w'''' + w'' = (q'' b R^4)/(E I); integrated over half a wave.
    q = 1e6
    stiffness = SECTION.modulus * SECTION.second_moment
    harmonics = np.zeros(n + 1, complex)
    harmonics[n] = q
    wave = deflection(TURN, SECTION, harmonics)
    amplitude = wave[0]
    np.testing.assert_allclose(wave, amplitude * np.cos(n * TURN), atol=1e-15)

    def rate(phi, w):
        return [*w[1:], -2 * w[4] - w[2] - n**2 * q * math.cos(n * phi) * SECTION.width * SECTION.mean_radius**4 / stiffness]

    start = [amplitude * n**k * (0 if k % 2 else (-1) ** (k // 2)) for k in range(6)]
    course = solve_ivp(rate, (0, math.pi / n), start, rtol=1e-11, atol=1e-16, t_eval=np.linspace(0, math.pi / n, 50))
    np.testing.assert_allclose(course.y[0], amplitude * np.cos(n * course.t), rtol=1e-6, atol=1e-6 * amplitude)


def test_two_opposite_narrow_loads_flatten_a_thin_ring_as_in_the_textbook():
    # Timoshenko: under two opposite forces P the diameter along them shrinks by (pi/4 - 2/pi) P R^3/(E I), the other grows by (2/pi - 1/2).
    pressing = Pressing(1e8, arc_width=1e-3, arcs=2)
    force = 1e8 * SECTION.width * SECTION.mean_radius * 1e-3
    harmonics = pressure_harmonics(pressing, 400)
    harmonics[0] = 0.0  # the textbook's ring does not stretch
    along, across = deflection(np.array([math.pi / 2, 0.0]), SECTION, harmonics)
    unit = force * SECTION.mean_radius**3 / (SECTION.modulus * SECTION.second_moment)
    assert 2 * along / unit == pytest.approx(math.pi / 4 - 2 / math.pi, rel=1e-4)
    assert -2 * across / unit == pytest.approx(2 / math.pi - 1 / 2, rel=1e-4)


def test_even_pressure_shrinks_a_ring_as_a_thin_hoop():
    harmonics = np.array([3e6 + 0j])
    assert deflection(0.0, SECTION, harmonics) == pytest.approx(3e6 * SECTION.mean_radius**2 / (SECTION.modulus * SECTION.thickness))


@pytest.mark.parametrize("degrees", [0.0, 4.0, -7.0])
def test_the_fourier_series_is_the_pressure_and_its_resultant_vanishes(degrees):
    pressing = Pressing(2e6, math.radians(degrees))
    harmonics = pressure_harmonics(pressing, 4000)
    assert abs(harmonics[1]) < 1e-6
    at = np.concatenate([pressing.centres, pressing.centres[:1] + math.pi / 3])
    summed = (np.exp(1j * np.multiply.outer(at, np.arange(4001))) @ harmonics).real
    np.testing.assert_allclose(summed, [*pressing.pressures, 0.0], atol=2e3)
    assert pressing.pressures.mean() == pytest.approx(2e6)


def test_d_is_near_deng_s_at_2_mpa():
    # 0.098 mm stands in the paper for 2.0 MPa by finite elements; the equivalent thickness is given to two digits, and D goes with its cube
    machined = machine(SECTION, Pressing(2e6), low_radius=34.8625e-3)
    assert machined.d_value == pytest.approx(0.098e-3, rel=0.03)
    assert machined.roundness < 1e-12 and machined.radii.min() == pytest.approx(34.8625e-3, abs=1e-12)
    np.testing.assert_allclose(np.degrees(machined.lows[:, 0]), [0, 120, 240], atol=0.1)


def test_with_the_arc_turn_highs_rise_lows_fall_d_and_roundness_grow():
    made = [machine(SECTION, Pressing(2e6, math.radians(turn)), ground_radius=34.91e-3) for turn in range(7)]
    highs, lows = np.array([[m.highs[:, 1].mean(), m.lows[:, 1].mean()] for m in made]).T
    assert (np.diff(highs) > 0).all() and (np.diff(lows) < 0).all()
    assert (np.diff([m.highs[:, 1].max() for m in made]) > 0).all() and (np.diff([m.lows[:, 1].min() for m in made]) < 0).all()
    assert (np.diff([m.d_value for m in made]) > 0).all() and (np.diff([m.roundness for m in made]) > 0).all()


def test_turning_an_arc_one_way_mirrors_turning_it_the_other():
    ahead, back = (machine(SECTION, Pressing(2e6, turn), ground_radius=34.91e-3).radii for turn in (0.05, -0.05))
    # arcs at 60, 180, 300 + t deg, seen in the mirror, are those at 60, 180, 300 - t, a third of a turn on
    np.testing.assert_allclose(np.roll(ahead[::-1], 1), np.roll(back, 240), atol=1e-15)


def command(*arguments):
    return CliRunner().invoke(main, ["machine", *map(str, arguments)])


def test_the_command_writes_a_contour_that_a_scene_uses(tmp_path):
    ran = command("--arc-turn", "1 deg", "-o", tmp_path / "c.csv", "--picture", tmp_path / "c.png", "--json")
    assert ran.exit_code == 0, ran.output
    report = json.loads(ran.stdout)
    raceway = load_scene("deng2017_table1", [f"bearing.outer_raceway.contour_file={tmp_path / 'c.csv'}"]).bearing.outer_raceway
    assert raceway.lobes == 3 and 1e3 * raceway.low_radius == pytest.approx(report["low_radius_mm"], abs=1e-7)
    for point in (*report["low_points"], *report["high_points"]):
        assert 1e3 * outer_contour(raceway, math.radians(point["angle_deg"]))[0] == pytest.approx(point["radius_mm"], abs=1e-6)
    assert (tmp_path / "c.png").read_bytes()[1:4] == b"PNG"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--pressure", "2 mm"], "--pressure 2 mm: '2 mm' has the wrong dimension"),
        (["--arc-width", "130 deg"], "the arcs overlap"),
        (["--low-radius", "34 mm", "--ground-radius", "35 mm"], "give one"),
        (["--picture", "c.jpg"], "expected a name that ends in .png"),
        (["--thickness", "0 mm"], "0 mm is outside 0.01 mm to 500 mm"),
        (["-o", "/nowhere/c.csv"], "there is no folder /nowhere"),
    ],
)
def test_what_cannot_be_machined_says_why(arguments, expected):
    ran = command(*arguments)
    assert ran.exit_code == 2 and expected in ran.output


def test_a_swallowed_lobe_is_told():
    ran = command("--arc-turn", "12 deg")
    assert ran.exit_code == 0 and "removed a lobe" in ran.output


@pytest.mark.parametrize("arguments", [("--arcs", 7), ("--arcs", 6), ("--arc-turn", "70 deg", "--arcs", 5)])
def test_arcs_that_overlap_or_leave_no_gap_are_refused(arguments):
    """Six arcs of 60 deg press the whole ring evenly, so that no lobe is left."""
    ran = command(*arguments)
    assert ran.exit_code == 2 and "the arcs overlap, or leave no gap" in ran.output


def test_the_ring_of_a_scene_is_machined_unless_the_command_line_gives_its_section(tmp_path):
    def ring(*arguments):
        report = json.loads(CliRunner().invoke(main, ["machine", "--scene", str(path), *arguments, "--low-radius", "40.7mm", "--json"]).stdout)
        return report["mean_radius_mm"], report["thickness_mm"]

    section, path = ring_geometry(load_bearing("NU 210/C3")), tmp_path / "ring.yaml"
    rest = "lubricant: {oil: ISO VG 68, temperature: 60 degC}\noperating: {shaft_speed: 1500 rpm}\n"
    path.write_text(f"name: ring\nlevel: slip\nbearing: NU 210/C3\n{rest}")
    assert ring() == pytest.approx((1e3 * section.radius, 1e3 * section.equivalent_thickness))
    assert ring("--thickness", "3 mm") == pytest.approx((1e3 * section.radius, 3.0))
