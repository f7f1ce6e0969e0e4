# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The monitor judges slip, life, remaining life, film and pocket force of courses of samples, each trouble once."""

import math

import numpy as np
import pytest

from bearing_sim.messages.events import Level
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import pack
from bearing_sim.model.sample import joined, new_block
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm
from bearing_sim.watchers.monitoring.monitor import Monitor

STEP = 0.1  # s
ROUGH = ["bearing.roughness={roller: 0.1 um, raceway: 0.2 um}"]


def course(count, **values):
    """Return samples at even times; values are numbers or one for each sample."""
    block = new_block(count, 18)
    block["time"] = STEP * np.arange(1, count + 1)
    block["shaft_speed"], block["oil_temperature"], block["cage_slip"] = 1000.0, 393.15, 0.01
    block["rating_life"] = block["modified_rating_life"] = 1000.0
    for name, value in values.items():
        value = np.asarray(value, float)
        block[name] = value[:, None] if block[name].ndim == 2 and value.ndim else value
    return block


def told(monitor, block, size=1):
    """Return (time, code, level) of each event when it begins, feeding ``size`` samples at a time."""
    found, holding = [], set()
    for k in range(0, len(block), size):
        monitor.judge(block[k : k + size])
        now = float(block["time"][k : k + size][-1])
        events = {(event.kind, event.level) for event in monitor.events(now)}
        found += [(round(now, 6), *event) for event in sorted(events - holding)]
        holding = events
    return found


def monitor(*overrides):
    return Monitor(load_scene("deng2017_table1", [*overrides]))


def test_a_slip_that_lasts_is_a_warning_then_an_error_and_over_when_it_is_back():
    slip = np.repeat([0.01, 0.06, 0.12, 0.01], 50)
    one = monitor()
    assert told(one, course(200, cage_slip=slip)) == [(5.6, "bearing.slip", Level.WARN), (10.6, "bearing.slip", Level.ERROR)]
    assert one.events(20.0) == []


def test_a_slip_that_flickers_around_its_limit_is_one_event():
    slip = 0.05 + 0.004 * np.random.default_rng(1).uniform(-1, 1, 5000)
    assert [event[1:] for event in told(monitor(), course(5000, cage_slip=slip))] == [("bearing.slip", Level.WARN)]


def test_backward_slip_counts_and_a_shaft_that_hardly_turns_or_rests_does_not():
    assert told(monitor(), course(20, cage_slip=-0.2))[-1][2] is Level.ERROR
    assert told(monitor(), course(100, cage_slip=0.9, shaft_speed=5.0)) == []
    assert told(monitor(), course(100, cage_slip=math.nan, shaft_speed=0.0, modified_rating_life=math.inf)) == []


def test_of_a_block_the_worst_sample_counts():
    slip = np.tile([0.01, 0.01, 0.01, 0.06], 25)
    assert [event[1] for event in told(monitor(), course(100, cage_slip=slip), size=4)] == ["bearing.slip"]
    assert told(monitor(), course(100, cage_slip=slip), size=1) == [], "alone it does not last"


def test_a_short_life_is_a_warning_with_hours_in_its_text_and_an_error_where_asked_for():
    one = monitor("thresholds.life_error=100")
    life = np.repeat([1000.0, 250.0, 50.0], 30)
    assert [event[1:] for event in told(one, course(90, modified_rating_life=life)) if event[1] == "bearing.life"] == [
        ("bearing.life", Level.WARN),
        ("bearing.life", Level.ERROR),
    ]
    assert "50 h is below 100 h" in next(event.text for event in one.events(9.0) if event.kind == "bearing.life")


def test_remaining_life_is_what_damage_leaves_at_the_present_rate():
    one = monitor("thresholds.remaining_life_memory=1 ms")
    one.judge(course(1, modified_rating_life=2000.0, damage=0.75))
    assert one.values(0.0)["remaining life [h]"] == pytest.approx(500.0)
    assert [event[1] for event in told(one, course(30, modified_rating_life=1000.0, damage=0.75))] == ["bearing.remaining_life"]


def test_the_rate_of_damage_is_a_mean_of_rates_not_of_lives():
    """A life that swings between 100 and 300 h uses up a bearing in 150 h."""
    one = monitor()
    told(one, course(6000, modified_rating_life=np.tile([100.0, 300.0], 3000)))
    assert one.values(0.0)["remaining life [h]"] == pytest.approx(150.0, rel=0.01)


def test_a_bearing_that_rests_lives_for_ever_and_a_used_up_one_is_told():
    one = monitor()
    one.judge(course(1, modified_rating_life=math.inf))
    assert one.values(0.0)["remaining life [h]"] == math.inf
    one.judge(course(1, modified_rating_life=1e4, damage=1.2))
    assert [(event.kind, event.level) for event in one.events(1.0)] == [("bearing.life_used", Level.ERROR)]
    assert one.values(0.0)["remaining life [h]"] == 0.0


def test_pocket_forces_of_either_sign_are_judged_where_a_limit_is_set():
    force = np.repeat([1.0, -30.0], 20)
    assert told(monitor(), course(40, pocket_force=force)) == []
    one = monitor("thresholds.pocket_force_warning=20 N", "thresholds.pocket_force_error=50 N")
    assert told(one, course(40, pocket_force=force)) == [(2.6, "bearing.pocket_force", Level.WARN)]
    assert one.values(0.0)["largest pocket force [N]"] == 30.0
    assert told(one, course(5, pocket_force=math.nan)) == [(0.1, "bearing.pocket_force", Level.WARN)], "not told at this level: clears in its time"


def rolling_block(shaft_speed, force=500.0, count=1):
    scene = load_scene("deng2017_table1", ROUGH)
    bearing = scene.bearing
    block = course(count, shaft_speed=shaft_speed)
    block["roller_radius"] = bearing.pitch_radius
    block["orbital_speed"] = 0.5 * shaft_speed * (1 - bearing.diameter_ratio)
    block["roller_spin"] = block["orbital_speed"] * bearing.pitch_radius / (bearing.roller.diameter / 2)
    block["inner_load"], block["outer_load"] = force, 1.2 * force
    return scene, block


def test_the_thinnest_film_is_that_of_the_inner_contact_and_lambda_is_it_over_the_composite_roughness():
    """Against the published formulas, in pure rolling: there both surfaces run through the contact as fast as the inner one."""
    scene, block = rolling_block(1000.0)
    params, oil = pack(scene), oil_at(scene.lubricant.oil, 393.15)
    radius, modulus = params.raceways.inner_curvature_radius, params.raceways.reduced_modulus
    rolling = (1000.0 - block["orbital_speed"][0, 0]) * scene.bearing.inner_raceway.radius  # of the inner surface, seen from the contact
    u, w = oil.viscosity * rolling / (modulus * radius), 500.0 / (modulus * radius * scene.bearing.roller.length)
    film = radius * 2.65 * u**0.70 * (oil.pressure_viscosity * modulus) ** 0.54 * w**-0.13
    film /= 1 + 0.1 * (oil.viscosity * oil.temperature_viscosity * rolling**2 / oil.conductivity) ** 0.64
    assert ThinnestFilm(scene).least(block)[0] == pytest.approx(film, rel=0.01)
    assert ThinnestFilm(scene).roughness == pytest.approx(math.hypot(0.1e-6, 0.2e-6))


def test_films_grow_with_speed_and_falls_with_load_heat_and_sliding():
    ratio = lambda scene, block: ThinnestFilm(scene).least(block)[0]  # noqa: E731
    usual = ratio(*rolling_block(1000.0))
    assert ratio(*rolling_block(500.0)) < usual < ratio(*rolling_block(1000.0, force=100.0))
    scene, block = rolling_block(1000.0)
    block["oil_temperature"] = 450.0
    assert ratio(scene, block) < 0.7 * usual
    scene, block = rolling_block(1000.0)
    block["roller_spin"] *= 0.5
    assert ratio(scene, block) < usual


def test_spins_that_a_level_does_not_tell_are_those_of_rolling_and_unloaded_rollers_have_no_film():
    scene, block = rolling_block(1000.0)
    usual = ThinnestFilm(scene).least(block)[0]
    block["roller_spin"] = math.nan
    assert ThinnestFilm(scene).least(block)[0] == pytest.approx(usual)
    block["inner_load"] = block["outer_load"] = 0.0
    assert math.isnan(ThinnestFilm(scene).least(block)[0])


def test_a_thin_film_is_a_warning_where_the_bearing_has_a_roughness():
    scene, slow = rolling_block(21.0, count=50)
    assert [event[1] for event in told(Monitor(scene), slow)] == ["bearing.lambda"]
    assert told(monitor(), slow) == []
    _, resting = rolling_block(0.0, count=50)
    assert told(Monitor(scene), resting) == [], "at rest there is no film, and nothing rubs"


def test_other_thresholds_in_mid_run_hold_from_then_on():
    one, block = monitor(), course(100, cage_slip=0.03)
    assert told(one, block[:50]) == []
    one.adjust(load_scene("deng2017_table1", ["thresholds.slip_warning=2 %"]).thresholds)
    assert told(one, block[50:]) == [(5.6, "bearing.slip", Level.WARN)]


def test_a_restart_forgets_troubles_and_damage():
    one = monitor()
    told(one, course(50, cage_slip=0.2, damage=2.0))
    one.restart()
    assert one.events(5.0) == [] and one.values(0.0) == {}


def test_thresholds_take_units_and_faults_are_told():
    limits = load_scene("deng2017_table1", ["thresholds.residual.false_alarm_time=100 h", "thresholds.slip_hold={raise_after: 100 ms}"]).thresholds
    assert (limits.residual.false_alarm_time, limits.slip_hold.raise_after, limits.slip_hold.clear_after) == (3.6e5, 0.1, 2.0)
    with pytest.raises(SceneError, match="raise_after"):
        load_scene("deng2017_table1", ["thresholds.slip_hold.raise_after=-1 s"])


@pytest.mark.parametrize("rough", [(), ROUGH], ids=["no roughness", "roughness"])
def test_blocks_judged_together_leave_the_same_events_and_numbers_as_one_by_one(rough):
    """Slip, life, damage and film wander across their limits; what stands at the end of each review is compared."""
    noise, count = np.random.default_rng(3), 3000
    wander = np.cumsum(noise.normal(size=count)) * 0.02
    slip = np.where(noise.random(count) < 0.02, np.nan, 0.06 + 0.05 * np.sin(np.arange(count) / 180) + 1e-3 * noise.normal(size=count))
    life = 300.0 * np.exp(wander)
    block = course(count, cage_slip=slip, rating_life=life, modified_rating_life=life, damage=np.linspace(0.0, 0.9, count), pocket_force=5.0)
    block["inner_load"], block["roller_spin"] = 100.0 + 900.0 * noise.random((count, 1)), math.nan
    block["time"] = 0.01 * np.arange(1, count + 1)
    together, single = monitor(*rough), monitor(*rough)
    told_ones, begin = set(), 0
    while begin < count:
        size = int(noise.integers(1, 40))
        samples = [block[k : k + 1].copy() for k in range(begin, min(begin + size, count))]
        together.see(joined(samples))
        for sample in samples:
            single.judge(sample)
        now = float(samples[-1]["time"][0])
        # Of a film that is told ten times a second, the instant of telling depends on where the blocks begin.
        assert [event for event in together.events(now) if event.kind != "bearing.lambda"] == [
            event for event in single.events(now) if event.kind != "bearing.lambda"
        ]
        found, expected = dict(together.values(0.0)), dict(single.values(0.0))
        found.pop("film over roughness, lambda", None), expected.pop("film over roughness, lambda", None)
        assert found == pytest.approx(expected, nan_ok=True)
        told_ones |= {event.kind for event in together.events(now)}
        begin += size
    assert {"bearing.slip", "bearing.life"} <= told_ones


@pytest.mark.parametrize("limit, clearances", [(20.0, (30.0, 10.0, 30.0)), (0.0, (5.0, -1.0, 5.0)), (-10.0, (-5.0, -12.0, -5.0))])
def test_a_running_clearance_below_its_limit_is_a_warning_on_either_side_of_preload(limit, clearances):
    one = monitor(f"thresholds.clearance_warning={limit} um")
    block = course(150, running_clearance=1e-6 * np.repeat(clearances, 50))
    assert told(one, block) == [(5.6, "bearing.clearance", Level.WARN)]
    assert not one.events(15.0), "it is over once the clearance has been back for long enough"
    one.judge(course(1, running_clearance=1e-6 * clearances[1]))


def test_a_preload_flickers_around_its_limit_in_one_event_and_an_error_outranks_the_warning():
    one = monitor("thresholds.clearance_warning=-10 um", "thresholds.clearance_error=-20 um")
    flicker = -10e-6 + 0.8e-6 * np.random.default_rng(2).uniform(-1, 1, 3000)  # within the hysteresis of a tenth
    assert [event[1:] for event in told(one, course(3000, running_clearance=flicker))] == [("bearing.clearance", Level.WARN)]
    gone = course(20, running_clearance=np.full(20, -30e-6))
    gone["time"] += 300.0
    assert [event[1:] for event in told(one, gone)] == [("bearing.clearance", Level.WARN), ("bearing.clearance", Level.ERROR)]
    (event,) = one.events(302.0)
    assert event.text == "running clearance: -30 um is below -20 um"


def test_no_running_clearance_is_wrong_unless_the_scene_says_so():
    assert told(monitor(), course(50, running_clearance=np.full(50, -200e-6))) == []


def test_samples_of_a_long_life_are_calm_and_those_that_use_up_the_life_are_not():
    assert monitor().is_calm(course(10, rating_life=1e5, modified_rating_life=1e5))
    nearly = course(10, damage=np.full(10, 0.99))  # 10 of 1000 h are left
    assert monitor("thresholds.remaining_life_warning=5 h", "thresholds.remaining_life_error=1 h").is_calm(nearly)
    assert not monitor("thresholds.remaining_life_warning=20 h", "thresholds.remaining_life_error=1 h").is_calm(nearly)
