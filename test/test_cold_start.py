# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A cold start: slip and what the load does to the cage fall as a bearing warms, whatever the bearing; courses against plain runs."""

import dataclasses
import itertools
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.model.params import pack
from bearing_sim.model.plausibility import minimum_load
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.physics.contact import CONTACT
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.ratings import rate
from bearing_sim.simulation import Simulation, scene_inputs
from bearing_sim.studies import cold_start
from bearing_sim.studies.cold_start import NEAR, ROLLING, SKID, cold_scene
from bearing_sim.sweep.states import at_level_slip, standing_cage
from bearing_sim.sweep.thermal import simulation_held_at

BEARINGS = {"NU 205": ("ISO VG 68", 3000), "NU 210": ("ISO VG 68", 3000), "NU 2308": ("ISO VG 100", 3000)}  # 13, 16 and 12 rollers
IDLING = 600.0
COLD = np.full(len(NODE_OBSERVABLES), 273.15)


def of(name):
    oil, rpm = BEARINGS.get(name, ("ISO VG 320", 1500))
    lubricant = {"oil": oil, "supply": "oil_bath", "temperature": "20 degC"}
    return load_scene({"name": name, "bearing": name, "lubricant": lubricant, "operating": {"shaft_speed": f"{rpm} rpm", "radial_load": "1 kN"}})


@pytest.fixture(scope="module", params=BEARINGS)
def bearing(request):
    return request.param


@pytest.fixture(scope="module")
def found(bearing):
    scene = of(bearing)
    return cold_start.cold_start(scene, [0.2 * float(minimum_load(scene)[0])], idling=IDLING)


def test_a_cold_bearing_skids_while_it_idles_and_the_less_the_warmer_it_is(found):
    for course in found.courses:
        idle = [each for each in course.instants if 5.0 < each.time <= IDLING]
        assert idle[0].cage_slip > 0.3 and idle[0].cage_slip > idle[-1].cage_slip + 0.05
        assert all(warm.cage_slip < cold.cage_slip + 5e-3 for cold, warm in itertools.pairwise(idle))
        assert max(each.cage_slip for each in course.instants if each.time > IDLING + 2.0) < 0.01


def test_the_load_does_the_less_to_the_cage_the_later_it_comes(found):
    for start in (ROLLING, SKID):
        tried = [each for each in found.loadings if each.start == start and each.time > 5.0]
        assert len(tried) == 4 and tried[-2].time == IDLING < tried[-1].time
        for early, late in itertools.pairwise(tried):
            assert late.contact_power < early.contact_power and late.energy < early.energy and late.idling_power < early.idling_power
        assert tried[0].contact_power > 2.0 * tried[-1].contact_power and all(each.rolls_after < 0.5 for each in tried[:-1])


def test_a_course_ends_near_equilibrium_from_where_all_was_cold(found):
    for course in found.courses:
        temperatures, times = np.array([each.temperatures for each in course.instants]), [each.time for each in course.instants]
        assert (np.diff(times) > 0).all() and np.abs(temperatures[0] - 273.15).max() < 2.0 and course.remaining < NEAR
        assert (temperatures[-1] > 283.0).all() and all(0.0 < each.film_left <= 1.0 and each.film > 0.0 for each in course.instants)


def test_intensity_is_the_power_over_the_area_of_a_hertzian_contact_under_a_load_between_idling_and_the_whole(bearing, found):
    size = of(bearing).bearing
    radius, length, modulus = size.roller.diameter / 2, size.roller.length, 2.06e11 / (1 - 0.3**2)
    inner = radius * size.inner_raceway.radius / (radius + size.inner_raceway.radius)  # effective radius of the inner contact
    for each in found.loadings:
        half_width = each.contact_power / (2.0 * length * each.intensity)
        load = half_width**2 * math.pi * length * modulus / (8.0 * inner)  # b^2 = 8 Q R/(pi L E')
        assert 0.3 * each.load < load < found.loaded


@pytest.mark.long
@pytest.mark.parametrize("name", BEARINGS)
def test_growing_intervals_warm_a_bearing_as_a_plain_run_with_short_ones_does(name):
    scene = cold_scene(of(name))
    idle = scene_inputs(scene).at(radial_load=0.2 * float(minimum_load(scene)[0]))
    start = standing_cage(scene, idle, COLD)
    course = list(cold_start._warm(scene, start, COLD, idle, cold_start._times(1.0, 300.0)))
    fine = dataclasses.replace(scene, heat=dataclasses.replace(scene.heat, interval=0.25))
    plain = Simulation(fine, idle, start=start, nodes=COLD).advance(300.0, samples=300)
    for elapsed, sample in course[5:]:
        beside = plain[round(elapsed) - 1]
        assert sample["cage_slip"] == pytest.approx(beside["cage_slip"], abs=0.02)
        for node in NODE_OBSERVABLES:
            assert sample[node] == pytest.approx(beside[node], abs=1.0)


@pytest.mark.parametrize("name", ["NU 232", *BEARINGS])
def test_the_sliding_power_of_the_worst_contact_is_that_of_its_traction_to_a_tenth(name):
    scene = at_level_slip(cold_scene(of(name)))
    idle, count, compared = scene_inputs(scene).at(radial_load=0.3 * float(minimum_load(scene)[0])), scene.bearing.roller.count, 0
    run = simulation_held_at(scene, idle, COLD, standing_cage(scene, idle, COLD))
    run.advance(0.5)
    for share in np.linspace(0.02, 0.2, 10):
        sample = run.advance(0.02, idle.at(radial_load=share * 0.1 * rate(scene.bearing).dynamic))
        contacts = run._work.contacts  # of the last state: tractions from the law, lane by lane
        powers = contacts[:, CONTACT.force] * contacts[:, CONTACT.sliding]
        half = len(powers) // 2
        inner, outer = powers[:half].ravel()[:count], powers[half:].ravel()[:count]
        assert inner.sum() == pytest.approx(float(sample["inner_sliding_power"][0]), rel=1e-6, abs=1e-9)
        worst = max(inner.max(), outer.max())
        if worst > 5.0:
            compared += 1
            assert cold_start._heaviest(sample, pack(scene))[0] == pytest.approx(worst, rel=0.1)
    assert compared >= 3


def test_a_skid_that_rolling_avoids_ends_by_itself_in_seconds_where_two_states_are_near():
    # NU 232 at 10 degC and 3 kN has both states (`test_cold_oil.py`)
    scene = cold_scene(of("NU 232"), 283.15)
    idle, nodes = scene_inputs(scene).at(radial_load=3000.0), COLD + 10.0
    slips = {}
    for start in (SKID, ROLLING):
        begin = standing_cage(scene, idle, nodes) if start == SKID else Simulation(scene, idle, nodes=nodes).sample
        slips[start] = [float(sample["cage_slip"]) for _, sample in cold_start._warm(scene, begin, nodes, idle, [1.0, 60.0])]
    assert slips[SKID][0] > 0.3 > 0.01 > slips[ROLLING][0]
    assert slips[SKID][1] == pytest.approx(slips[ROLLING][1], abs=1e-3)


@pytest.mark.parametrize(("first", "duration"), [(1.0, 3600.0), (60.0, 172800.0), (1.0, 0.5), (1.0, 1.0)])
def test_times_grow_evenly_up_to_the_end(first, duration):
    times = cold_start._times(first, duration, [each for each in (60.0, 300.0) if each < duration])
    assert times[-1] == duration and all(0.0 < early < late <= 1.26 * max(early, 0.8 * first) for early, late in itertools.pairwise(times))
    assert {60.0, 300.0} & set(times) == {each for each in (60.0, 300.0) if each < duration}


@pytest.mark.long
def test_the_command_reports_draws_and_refuses(tmp_path):
    def call(*arguments):
        return CliRunner().invoke(main, ["study", "cold-start", "nu215_rig", *arguments])

    picture = tmp_path / "start.png"
    given = ("--load", "0.3 kN", "--idling", "30 s", "--temperature", "10 degC", "--set", "lubricant.supply={law: oil_bath}")
    result = call(*given, "--set", "lubricant.mixture_fraction=null", "--json", "--out", str(picture))
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert [course["start"] for course in report["courses"]] == [ROLLING, SKID] and picture.stat().st_size > 10_000
    first = report["courses"][0]["instants"][0]
    assert set(first["temperatures"]) == set(NODE_OBSERVABLES) and first["temperatures"]["shaft_temperature"] == pytest.approx(283.15, abs=0.5)
    assert report["loaded"] == pytest.approx(0.1 * rate(load_scene("nu215_rig").bearing).dynamic)
    assert all(math.isfinite(each["contact_power"]) for each in report["loadings"])
    for wrong, said in (
        (("--load", "-5 N"), "--load"),
        (("--idling", "0 s"), "--idling"),
        (("--rise", "11 s"), "--rise"),
        (("--set", "operating.shaft_speed=0"), "shaft_speed"),
    ):
        refused = call(*wrong)
        assert refused.exit_code == 2 and said in refused.output
