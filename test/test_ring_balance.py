# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The balance of rollers, bending outer ring and housing: every answer is checked against the equations themselves, written down plainly."""

import math

import numpy as np
import pytest

from bearing_sim import load_scene
from bearing_sim.model.params import pack
from bearing_sim.physics.load_balance import LOAD, balance_ring
from bearing_sim.physics.outer_ring import RingSection, bed_compliance, bore_compliance, ring_compliance
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.physics.ring_balance import POINT, ROLLER, Seat, balance_elastic_ring, new_bending, new_elastic_ring, seat_gap
from bearing_sim.scene.contour import outer_contour

SEAT_RADIUS, WIDTH = 37.5e-3, 10e-3
SECTION = RingSection(35.8e-3, WIDTH * 3.4e-3**3 / 12, 34e-6, 206e9, math.inf)


def round_bore(azimuths):
    return 0.0 * azimuths


def massive(modulus=206e9, ratio=0.3, outside=math.inf):
    return lambda n: bore_compliance(n, SEAT_RADIUS, modulus, ratio, outside)


STEEL = massive()


def seat(compliances=STEEL, play=0.0, bore=round_bore, **fit):
    return Seat(SEAT_RADIUS, WIDTH, compliances, bore, play, **fit)


class Rollers:
    """A bearing's rollers at an azimuth of the first, loaded, in a ring that bends."""

    def __init__(self, ring, rollers, stiffness, profile, contour, squeeze_radius, mass=0.0, cage_speed=0.0):
        self.ring, self.count, self.stiffness, self.profile = ring, rollers, stiffness, profile
        self.contour, self.squeeze_radius, self.mass, self.cage_speed = contour, squeeze_radius, mass, cage_speed
        self.loads, self.position, self.bending = np.zeros((len(LOAD), rollers)), np.zeros(2), new_bending(ring)

    def place(self, turn):
        azimuths = 2 * math.pi * (turn + np.arange(self.count) / self.count)
        radii, loads = self.contour(azimuths), self.loads
        loads[LOAD.cosine], loads[LOAD.sine] = np.cos(azimuths), np.sin(azimuths)
        loads[LOAD.squeeze] = self.squeeze_radius - radii
        loads[LOAD.centrifugal] = self.mass * (radii - 3.5e-3) * self.cage_speed**2
        loads[LOAD.free] = (loads[LOAD.centrifugal] / self.stiffness) ** 0.9

    def balance(self, load, angle, turn, pressure=0.0):
        self.place(turn)
        y, z = load * math.cos(angle), load * math.sin(angle)
        return balance_elastic_ring(y, z, turn, pressure, self.stiffness, self.profile, self.ring, self.loads, self.position, self.bending)


PAPER = pack(load_scene("deng2017_table1"))


def paper(ring, slip=0.0, low_radius=34.8625e-3):
    scene = load_scene("deng2017_table1", {"bearing.outer_raceway.low_radius": f"{1e3 * low_radius} mm"})
    raceways, rollers = PAPER.raceways, PAPER.rollers
    ideal = 0.5 * 45000 * math.pi / 30 * (1 - raceways.diameter_ratio)
    return Rollers(
        ring,
        rollers.count,
        raceways.stiffness,
        raceways.profile,
        lambda azimuths: outer_contour(scene.bearing.outer_raceway, azimuths)[0],
        raceways.inner_radius + 2 * rollers.radius,
        rollers.mass,
        ideal * (1 - slip),
    )


def life_and_load(rollers, positions=16):
    """Return the life [h] by eq. 18 of Deng 2017 and the largest inner load [N] over one pitch at 800 N and 45,000 rpm."""
    inner = outer = largest = 0.0
    for position in range(positions):
        assert rollers.balance(800.0, 0.0, position / (positions * rollers.count))
        inner += (rollers.loads[LOAD.inner] ** 4).mean() / positions
        outer += (rollers.loads[LOAD.outer] ** 4.5).mean() / positions
        largest = max(largest, rollers.loads[LOAD.inner].max())
    return rating_life_revolutions(inner**0.25, outer ** (2 / 9), PAPER.life) / (45000 * 60), largest


@pytest.mark.parametrize(
    "compliances, play, slip, life, load",
    [
        (STEEL, 0.0, 0.076, 669, 1782),
        (STEEL, 2e-6, 0.120, 1159, 1580),
        (STEEL, 5e-6, 0.2415, 3194, 1263),
        (massive(71e9, 0.33), 0.0, 0.1139, 1238, 1543),
        (massive(outside=1.5 * SEAT_RADIUS), 0.0, 0.06, 1216, None),
        (lambda n: bed_compliance(n, 1e13), 0.0, 0.0734, 671, 1782),
        (lambda n: bed_compliance(n, 1e13), 5e-6, 0.2465, 3430, 1243),
    ],
)
def test_an_independent_calculation_of_the_papers_bearing_is_met(compliances, play, slip, life, load):
    hours, largest = life_and_load(paper(new_elastic_ring(SECTION, seat(compliances, play), 18), slip))
    assert hours == pytest.approx(life, rel=0.015)
    assert load is None or largest == pytest.approx(load, rel=0.002)


def test_more_waves_change_the_life_by_less_than_a_per_cent():
    lives = [life_and_load(paper(new_elastic_ring(SECTION, seat(), 18, points), 0.06))[0] for points in (3, 4, 8)]
    assert abs(lives[1] / lives[2] - 1) < 0.008 and abs(lives[0] / lives[2] - 1) < 0.015


def check_equations(rollers, compliances, bore, play, load, angle, turn, radial=0.0):
    """Assert that an answer fulfils all equations, by sums over waves as they stand in the docstring of the module."""
    count, points = rollers.count, rollers.ring.seat.shape[0]
    n, azimuths = np.arange((points or 4 * count) // 2 + 1), 2 * math.pi * (turn + np.arange(count) / count)
    at, deflection = 2 * math.pi * (turn + np.arange(points) / max(points, 1)), rollers.bending.rollers[ROLLER.deflection]
    pressed, outwards = rollers.bending.points[POINT.force, :points], rollers.loads[LOAD.outer]
    ring = ring_compliance(n, SECTION)
    error = 1e-9 + ring[2] * count / 2 * (1e-3 + 1e-6 * load)  # every roller may miss its force by as much, in two waves at worst

    def moved(where):
        waves = lambda sources: np.cos(np.multiply.outer(where[:, None] - sources, n)) @ ring  # noqa: E731
        return waves(azimuths) @ outwards - waves(at) @ pressed

    assert np.abs(moved(azimuths) - deflection).max() < error
    housing = np.zeros(len(n)) if points == 0 else compliances(n) / (math.pi * SEAT_RADIUS * WIDTH)
    housing[0] /= 2
    if points % 2 == 0:
        housing[-1] /= 2
    given_way = (np.cos(np.multiply.outer(at[:, None] - at, n)) @ housing) @ pressed
    push = outwards @ np.stack([np.cos(azimuths), np.sin(azimuths)], 1)
    directions = np.stack([np.cos(at), np.sin(at)], 1)
    scale = load + outwards.sum()
    if points:
        assert np.abs(pressed @ directions - push).max() < 1e-3 + 1e-5 * scale
        in_bore = rollers.bending.points[POINT.force, points:] - radial * pressed @ directions
        free = play + bore(at) + given_way - moved(at) - directions @ in_bore
        assert (pressed >= -1e-6 * scale).all()
        assert free.min() > -error and np.abs(free[pressed > 1e-6 * scale]).max(initial=0.0) < error
    inner, exponent = rollers.loads[LOAD.inner], 10 / 9
    y, z = rollers.position
    approach = rollers.loads[LOAD.squeeze] - deflection + y * np.cos(azimuths) + z * np.sin(azimuths)
    depth = (inner / rollers.stiffness) ** (1 / exponent) + (outwards / rollers.stiffness) ** (1 / exponent)
    assert np.abs((depth - approach)[inner > 1e-3]).max(initial=0.0) < 1e-8
    assert (approach[inner == 0.0] <= rollers.loads[LOAD.free][inner == 0.0] * 1.001 + 1e-9).all()
    assert np.hypot(*(inner @ np.stack([np.cos(azimuths), np.sin(azimuths)], 1) - load * np.array([math.cos(angle), math.sin(angle)]))) < (
        0.3 + 1e-5 * load
    )


@pytest.mark.parametrize("seed", range(3))
def test_random_rings_housings_plays_and_loads_are_balanced(seed):
    random = np.random.default_rng(seed)
    for _ in range(25):
        count, lobes = int(random.integers(7, 30)), int(random.integers(0, 6))
        play = float(random.choice([0.0, 1e-6 * 10 ** random.uniform(0, 2), -1e-6 * 10 ** random.uniform(0, 1.3)]))
        height, waves, azimuth = random.choice([0.0, 5e-6]), random.choice([2, 3]), random.uniform(0, 6)
        compliances = massive(random.choice([71e9, 206e9, 1e13]), 0.3, random.choice([math.inf, 60e-3]))
        radial = random.choice([0.0, 1e-9, 1e-8])
        dip, preload = random.uniform(0, 2e-4), random.uniform(-30e-6, 30e-6)

        def bore(at, height=height, waves=waves, azimuth=azimuth):
            return height * np.cos(waves * (at - azimuth))

        def contour(at, dip=dip, lobes=lobes):
            return 34.8625e-3 + 0.5 * dip * (1 - np.cos(lobes * at))

        ring = new_elastic_ring(SECTION, seat(compliances, play, bore, radial=radial), count, int(random.integers(3, 6)))
        rollers = Rollers(
            ring, count, PAPER.raceways.stiffness, PAPER.raceways.profile, contour, 34.8625e-3 + preload, 2.11e-3, random.uniform(0, 2300)
        )
        load, angle = 10 ** random.uniform(0.5, 4), random.uniform(0, 6.28)
        for turn in np.cumsum(random.uniform(0, 0.02, 6)):
            assert rollers.balance(load, angle, turn)
            check_equations(rollers, compliances, bore, play, load, angle, turn, radial)


def test_a_free_ring_bends_by_its_rollers_alone():
    rollers = paper(new_elastic_ring(SECTION, None, 18))
    assert rollers.balance(800.0, 0.3, 0.01)
    check_equations(rollers, bed_compliance, round_bore, 0.0, 800.0, 0.3, 0.01)


def test_a_stiff_ring_in_a_stiff_housing_is_the_rigid_one():
    stiff = SECTION._replace(modulus=1e18)
    rollers = paper(new_elastic_ring(stiff, seat(massive(1e18)), 18))
    assert rollers.balance(800.0, 0.0, 0.01)
    loads, position = rollers.loads.copy(), np.zeros(2)
    assert balance_ring(800.0, 0.0, rollers.stiffness, rollers.profile, loads, position)
    assert np.allclose(rollers.loads[LOAD.inner], loads[LOAD.inner], rtol=1e-4, atol=0.02)
    assert np.allclose(rollers.position, position, atol=1e-9)


def test_an_interference_counts_only_what_the_rollers_change():
    # without load the rollers of a bearing with clearance press nowhere: the deflection by the seat alone is in the mean growth already
    n = np.arange(37)
    ring, pressure = SECTION, 5e6
    seats = 2 * math.pi * SEAT_RADIUS * WIDTH
    shrunk = float(ring_compliance(0, ring)) * seats
    pressed = shrunk + float(STEEL(n)[0])
    rollers = paper(new_elastic_ring(SECTION, seat(play=math.nan, loose=1e-12, pressed=pressed, shrunk=shrunk), 18), slip=1.0, low_radius=34.90e-3)
    assert rollers.balance(0.0, 0.0, 0.003, pressure)
    assert np.abs(rollers.bending.rollers[ROLLER.deflection]).max() < 1e-9
    assert rollers.bending.points[POINT.force, :72].sum() == pytest.approx(pressure * seats, rel=1e-6)
    assert seat_gap(-3e6, rollers.ring) == (3e-6, 0.0)


def test_turning_everything_by_a_lobe_and_mirroring_it_changes_nothing():
    lives = []
    for angle, turn, sense in ((0.2, 0.004, 1), (0.2 + 2 * math.pi / 3, 0.004 + 1 / 3, 1), (-0.2, -0.004, -1)):
        rollers = paper(new_elastic_ring(SECTION, seat(play=3e-6), 18), 0.1)
        assert rollers.balance(900.0, angle, turn)
        lives.append((np.sort(rollers.loads[LOAD.inner]), np.sort(sense * rollers.bending.rollers[ROLLER.slope])))
    for inner, slope in lives[1:]:
        assert np.allclose(inner, lives[0][0], atol=0.05) and np.allclose(slope, lives[0][1], atol=1e-9)
