# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thermal network: its books close, single nodes follow closed forms, runs continue it and repeat."""

import itertools
import math
import types

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.model.params import pack
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.model.temperatures import given_temperatures, lubricate_scene, warm_cage
from bearing_sim.model.thermal_network import POWERS, boundary_dimensions, oil_flow, thermal_network
from bearing_sim.physics.growth import Temperatures
from bearing_sim.physics.heat import fin_conductance, held_fin_conductances
from bearing_sim.physics.thermal_filter import filter_gain, network_matrix
from bearing_sim.physics.thermal_network import BOOK, LINK, LINKS, NODE, NODES, NetworkInputs, new_work, settle, step
from bearing_sim.scene.loader import SceneError
from bearing_sim.simulation import IntegrationError, scene_inputs
from bearing_sim.sweep import thermal
from bearing_sim.sweep.point import point_row
from bearing_sim.sweep.thermal import begin_in_equilibrium

COLD = [
    *("bearing.dimensions_at=cold", "bearing.outer_raceway.low_radius=null", "bearing.clearance=C3"),
    *("bearing.outer_raceway.outside_radius=36.7 mm", "bearing.inner_raceway.bore_radius=25 mm"),
]


def scene(*overrides, level="slip"):
    return load_scene("deng2017_table1", [f"level={level}", "heat.law=network", "heat.interval=0.1", *overrides])


def network_of(*overrides):
    of = scene(*overrides)
    return of, thermal_network(of, pack(of))


def at(shaft_speed=3000.0, inlet=393.15):
    return NetworkInputs(shaft_speed, 0.45 * shaft_speed, inlet, 1e7, 0.0, 0.0, 1e-5)


def loads_of(of):
    loads = np.zeros((2, of.bearing.roller.count))
    loads[:, :5] = 400.0
    return loads


NAMES = LINK._fields


def only(**conductances):
    """Overrides that give every conductance: those named, the others 0."""
    return [f"heat.conductances.{name}={conductances.get(name, 0.0)}" for name in NAMES]


@pytest.mark.parametrize("duration", [1e-6, 1e-3, 0.1, 10.0, 1e3, 1e6])
def test_the_books_of_energy_close_to_round_off_in_a_step_of_any_length(duration):
    of, network = network_of()
    random = np.random.default_rng(7)
    temperatures, powers, work = random.uniform(300.0, 450.0, NODES), random.uniform(0.0, 500.0, len(POWERS)), new_work()
    before = temperatures.copy()
    step(duration, temperatures, powers, loads_of(of), at(), network, work)
    books = work.books
    assert books[BOOK.losses] == pytest.approx(duration * powers.sum(), rel=1e-12)
    assert books[BOOK.stored] == pytest.approx(network.capacities @ (temperatures - before), rel=1e-9, abs=1e-7)
    gap = books[BOOK.losses] - books[BOOK.to_oil] - books[BOOK.to_ambient] - books[BOOK.stored]
    assert abs(gap) < 1e-12 * np.abs(books).max() + 1e-12
    assert np.isfinite(temperatures).all() and (temperatures > 290.0).all()


@pytest.mark.parametrize(
    ("node", "link", "end"),
    [("housing", "housing_ambient", 293.15), ("shaft", "shaft_ambient", 293.15), ("oil", "oil_flow", 353.15)],
)
def test_a_single_node_relaxes_with_the_time_constant_of_the_closed_form(node, link, end):
    of, network = network_of(*only(**{link: 2.5}))
    place, temperatures, work = getattr(NODE, node), np.full(NODES, 400.0), new_work()
    constant = network.capacities[place] / 2.5
    steps = 4000
    for _ in range(steps):
        step(constant / steps, temperatures, np.zeros(len(POWERS)), loads_of(of), at(inlet=353.15), network, work)
    assert (temperatures[place] - end) / (400.0 - end) == pytest.approx(math.exp(-1.0), rel=1e-6)
    others = [other for other in range(NODES) if other != place]
    assert (temperatures[others] == 400.0).all()


def test_two_nodes_exchange_heat_with_the_time_constant_of_both_capacities():
    of, network = network_of(*only(shaft_inner_ring=5.0, housing_ambient=1.0))
    temperatures, work, steps = np.array([400.0, 300.0, 350.0, 350.0, 293.15, 350.0]), new_work(), 4000
    first, second = network.capacities[[NODE.shaft, NODE.inner_ring]]
    constant = first * second / (first + second) / 5.0
    for _ in range(steps):
        step(constant / steps, temperatures, np.zeros(len(POWERS)), loads_of(of), at(), network, work)
    assert temperatures[0] - temperatures[1] == pytest.approx(100.0 * math.exp(-1.0), rel=1e-6)


def test_the_step_is_of_second_order():
    def error(steps):
        of, network = network_of(*only(housing_ambient=2.5))
        temperatures, work = np.full(NODES, 400.0), new_work()
        constant = network.capacities[NODE.housing] / 2.5
        for _ in range(steps):
            step(constant / steps, temperatures, np.zeros(len(POWERS)), loads_of(of), at(), network, work)
        return abs(temperatures[NODE.housing] - 293.15 - (400.0 - 293.15) * math.exp(-1.0))

    assert error(20) / error(40) == pytest.approx(4.0, rel=0.1)


def test_the_integral_of_a_transient_closes_to_a_millionth():
    of, network = network_of()
    temperatures, work, powers = np.full(NODES, 393.15), new_work(), np.full(len(POWERS), 60.0)
    books, before = np.zeros(4), temperatures.copy()
    for k in range(500):
        step(0.5, temperatures, powers * (1.0 + 0.5 * math.sin(0.05 * k)), loads_of(of), at(), network, work)
        books += work.books
    stored = network.capacities @ (temperatures - before)
    assert abs(books[BOOK.losses] - books[BOOK.to_oil] - books[BOOK.to_ambient] - stored) < 1e-9 * books[BOOK.losses]


def test_the_steady_state_is_the_end_of_a_long_transient_and_gives_off_what_comes_in():
    of, network = network_of()
    powers, work = np.full(len(POWERS), 60.0), new_work()
    settled, marched = np.full(NODES, 393.15), np.full(NODES, 393.15)
    assert settle(settled, powers, loads_of(of), at(), network, np.zeros(NODES), work)
    for _ in range(400):
        step(100.0, marched, powers, loads_of(of), at(), network, work)
    assert marched == pytest.approx(settled, abs=1e-6)
    assert work.books[BOOK.to_oil] + work.books[BOOK.to_ambient] == pytest.approx(100.0 * powers.sum(), rel=1e-9)


def test_each_loss_becomes_heat_once():
    _, network = network_of()
    assert network.partition.shape == (len(POWERS), NODES)
    assert network.partition.sum(axis=1) == pytest.approx(1.0, abs=1e-15)


def test_a_conductance_that_is_given_replaces_the_computed_one():
    of, network = network_of("heat.conductances.housing_oil=12.5")
    work = new_work()
    step(0.1, np.full(NODES, 393.15), np.zeros(len(POWERS)), loads_of(of), at(), network, work)
    assert work.conductances[LINK.housing_oil] == 12.5 and len(work.conductances) == LINKS
    free_ends = [LINK.shaft_front, LINK.shaft_back]
    assert (np.delete(work.conductances, free_ends) > 0.0).all() and (work.conductances[free_ends] == 0.0).all()


@pytest.mark.parametrize(("tip", "length"), [(30.0, 0.04), (-20.0, 0.15), (80.0, 0.5)])
def test_a_shaft_end_of_given_temperature_conducts_as_the_fin_solved_numerically(tip, length):
    """Against the boundary value problem k A T'' = h P (T - T_air) with both ends held, by SciPy's collocation."""
    coefficient, perimeter, conductivity, section, root = 35.0, 0.157, 46.0, 1.96e-3, 50.0  # temperatures over the air's

    def slopes(x, y):
        return np.vstack([y[1], coefficient * perimeter / (conductivity * section) * y[0]])

    grid = np.linspace(0.0, length, 60)
    found = solve_bvp(slopes, lambda at, to: np.array([at[0] - root, to[0] - tip]), grid, np.zeros((2, grid.size)), tol=1e-8)
    to_air, to_tip = held_fin_conductances(coefficient, perimeter, conductivity, section, length)
    assert found.success and to_air * root + to_tip * (root - tip) == pytest.approx(-conductivity * section * found.sol(0.0)[1], rel=1e-5)


def test_a_fin_without_air_is_a_conductor_and_a_long_one_does_not_feel_its_tip():
    assert held_fin_conductances(0.0, 0.157, 46.0, 2e-3, 0.1) == (0.0, pytest.approx(46.0 * 2e-3 / 0.1))
    to_air, to_tip = held_fin_conductances(35.0, 0.157, 46.0, 2e-3, 5.0)
    assert to_tip < 1e-9 and to_air == pytest.approx(fin_conductance(35.0, 0.157, 46.0, 2e-3, 5.0))


@pytest.mark.parametrize(("name", "hot"), [("NU 210/C3", 140.0), ("NJ 2308", 110.0), ("NU 232", 120.0)])
def test_a_hot_shaft_warms_the_inner_ring_over_the_outer_and_the_books_close(name, hot):
    heat = {"law": "network", "shaft": {"back": "20 mm"}}
    lubricant = {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "40 degC"}
    about = {"name": name, "bearing": name, "lubricant": lubricant, "operating": {"shaft_speed": "1500 rpm", "radial_load": "5 kN"}, "heat": heat}
    cold = load_scene(about)
    warm = load_scene(cold, [f"heat.shaft.back_temperature={hot} degC"])
    free, held = (thermal_equilibrium(each, scene_inputs(each)) for each in (cold, warm))
    excess = [each.temperatures[NODE.inner_ring] - each.temperatures[NODE.outer_ring] for each in (free, held)]
    assert excess[1] > max(excess[0], 0.0) + 1.0
    assert held.heat_to_oil + held.heat_to_ambient == pytest.approx(held.powers["shaft_power"], rel=1e-6)


def test_a_shaft_end_of_given_temperature_needs_a_length():
    with pytest.raises(SceneError, match="front: 0 mm, but front_temperature is given"):
        scene("heat.shaft.front=0 mm", "heat.shaft.front_temperature=90 degC")


def test_a_network_without_a_sink_is_refused():
    closed = ["heat.oil_flow=0", "heat.housing.area=0", "heat.shaft.front=0 mm"]
    with pytest.raises(SceneError, match="no sink"):
        scene(*closed, "heat.shaft.back=0 mm")
    scene(*closed)  # one end of the shaft is enough
    with pytest.raises(SceneError, match="no sink"):
        scene(*only())
    bath = ["lubricant.supply=oil_bath", *closed[1:], "heat.shaft.back=0 mm"]  # nothing flows through a bath unless a flow is given
    with pytest.raises(SceneError, match="no sink"):
        scene(*bath)
    scene(*bath, "heat.oil_flow=1 l/min")


def test_a_bath_has_no_flow_and_a_jet_one_by_the_bore():
    assert oil_flow(scene("lubricant.supply=oil_bath")) == 0.0
    assert oil_flow(scene()) == pytest.approx(5.6e-4 * 2 * boundary_dimensions(scene().bearing).bore_radius)


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_a_run_books_the_heat_of_its_samples(level):
    run = Simulation(scene(level=level))
    total = 0.0
    for _ in range(30):
        block = run.advance(0.1, samples=10)
        total += 0.01 * sum(float(block[name].sum()) for name in POWERS)
    books = run.thermal.books
    assert books[BOOK.losses] == pytest.approx(total, rel=1e-6)
    assert books[BOOK.losses] == pytest.approx(books[1:].sum(), rel=1e-12)
    assert run.sample["inner_ring_temperature"] > 393.15 + 1.0


def test_a_run_repeats_to_the_last_bit_and_a_level_change_continues_the_temperatures():
    def go():
        run = Simulation(scene())
        blocks = [run.advance(0.05, samples=5) for _ in range(30)]
        other = Simulation(scene(level="steady"))
        other.take_over(run)
        assert other.sample["roller_temperature"] == run.sample["roller_temperature"]
        blocks += [other.advance(0.05, samples=5) for _ in range(30)]
        return np.concatenate(blocks)

    first, second = go(), go()
    assert first.tobytes() == second.tobytes()
    change = np.abs(np.diff(first["roller_temperature"]))
    assert change.max() < 8.0 and first["roller_temperature"][-1] > first["roller_temperature"][150]


def test_a_run_resumes_with_the_temperatures_of_a_sample():
    run = Simulation(scene(level="steady"))
    for _ in range(30):
        run.advance(0.1)
    other = Simulation(scene(level="steady"))
    other.resume(run.sample)
    assert [other.sample[name] for name in NODE_OBSERVABLES] == [run.sample[name] for name in NODE_OBSERVABLES]
    after, theirs = other.advance(2.0), run.advance(2.0)
    assert float(after["roller_temperature"][0]) == pytest.approx(float(theirs["roller_temperature"][0]), abs=1e-6)


def test_without_a_law_of_heat_samples_have_no_temperatures():
    run = Simulation(load_scene("deng2017_table1"))
    block = run.advance(1e-3)
    assert all(math.isnan(block[name][0]) for name in (*NODE_OBSERVABLES, "heat_to_oil", "heat_to_ambient"))


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_warmer_parts_close_the_clearance_of_a_cold_scene_at_once(level):
    of = load_scene("deng2017_table1", [f"level={level}", *COLD, "heat={law: given, inner_ring: 150 degC, rollers: 140 degC}"])
    run, plain = Simulation(of), Simulation(load_scene("deng2017_table1", [f"level={level}", *COLD]))
    closed = plain.sample["running_clearance"] - run.sample["running_clearance"]
    bearing = of.bearing
    expected = 2 * bearing.material.expansion * (30.0 * bearing.inner_raceway.radius + 20.0 * bearing.roller.diameter)
    assert closed == pytest.approx(expected, rel=0.05)  # the fit of the housing takes a little of it
    assert run.sample["inner_ring_temperature"] == 423.15 and run.sample["outer_ring_temperature"] == 393.15


def test_measured_temperatures_replace_given_ones():
    heat = load_scene("deng2017_table1", ["heat={law: given, inner_ring: 150 degC}"]).heat
    assert given_temperatures(heat, 393.15) == Temperatures(423.15, 423.15, 408.15, 393.15, 393.15)
    assert given_temperatures(heat, 393.15, (430.0, math.nan)).inner_ring == 430.0
    assert given_temperatures(heat, 393.15, (math.nan, 400.0)) == Temperatures(423.15, 423.15, 411.575, 400.0, 400.0)
    run = Simulation(load_scene("deng2017_table1", ["heat={law: given, inner_ring: 150 degC}"]))
    inputs = scene_inputs(run.scene)
    assert run.advance(1e-3, inputs._replace(inner_ring_temperature=430.0))["inner_ring_temperature"][0] == 430.0
    assert run.advance(1e-3, inputs)["inner_ring_temperature"][0] == 423.15


def test_a_warm_cage_closes_the_land_of_a_colder_ring():
    of = load_scene("deng2017_table1", [*COLD])
    params = pack(of)
    warm = warm_cage(of, params, Temperatures(390.0, 390.0, 430.0, 390.0, 390.0))
    even = warm_cage(of, params, Temperatures(390.0, 390.0, 390.0, 390.0, 390.0))
    assert even.cage.guide_clearance == pytest.approx(params.cage.guide_clearance, abs=1e-7)
    closed = even.cage.guide_clearance - warm.cage.guide_clearance
    assert closed == pytest.approx(of.bearing.cage.material.expansion * 40.0 * params.cage.guide_radius, rel=1e-9)


def test_the_filter_of_one_state_is_the_closed_form():
    """With x' = a x + w, z = x + v the steady covariance of the prediction solves a quadratic."""
    rate, interval, walk, sensor = -0.2, 0.5, 0.3, 0.8
    gain = filter_gain(np.array([[rate]]), interval, np.array([walk]), [0], sensor)
    a, q, r = math.exp(rate * interval), interval * walk**2, sensor**2
    b = r * (1 - a * a) - q
    predicted = 0.5 * (-b + math.sqrt(b * b + 4 * q * r))
    assert gain[0, 0] == pytest.approx(predicted / (predicted + r), rel=1e-9)


def test_the_matrix_of_the_network_is_that_of_its_step():
    of, network = network_of()
    work, before = new_work(), np.random.default_rng(3).uniform(380.0, 400.0, NODES)
    after, duration = before.copy(), 1e-7
    step(duration, after, np.zeros(len(POWERS)), loads_of(of), at(), network, work)
    matrix = network_matrix(work.conductances, network.capacities)
    boundary = np.zeros(NODES)
    for link, end in (("oil_flow", 393.15), ("housing_ambient", 293.15), ("shaft_ambient", 293.15)):
        place = {"oil_flow": NODE.oil, "housing_ambient": NODE.housing, "shaft_ambient": NODE.shaft}[link]
        boundary[place] += work.conductances[getattr(LINK, link)] * end / network.capacities[place]
    assert (after - before) / duration == pytest.approx(matrix @ before + boundary, rel=1e-3)


def test_measured_rings_draw_the_network_to_them_and_the_correction_is_booked():
    run, free = Simulation(scene(level="steady")), Simulation(scene(level="steady"))
    inputs = scene_inputs(run.scene)
    for _ in range(150):
        run.advance(0.2, inputs._replace(inner_ring_temperature=450.0, outer_ring_temperature=430.0))
        free.advance(0.2)
    gap = abs(run.sample["inner_ring_temperature"] - 450.0)
    assert gap < 0.3 * abs(free.sample["inner_ring_temperature"] - 450.0)
    assert abs(run.sample["outer_ring_temperature"] - 430.0) < 5.0
    stored = run.thermal.network.capacities @ (run.thermal.temperatures - 393.15)
    books = run.thermal.books
    assert run.thermal.corrected != 0.0
    assert books[BOOK.stored] + run.thermal.corrected == pytest.approx(stored, rel=1e-9)


OPERATING_POINTS = {
    "paper": [],
    "slower": ["operating.shaft_speed=15000 rpm"],
    "cold, with fits": [*COLD, "mounting={shaft: {fit: k5}, housing: {fit: H6}}", "operating.shaft_speed=20000 rpm"],
    "thermal Eyring film": ["lubricant.traction={law: eyring}", "lubricant.rolling_resistance=hydrodynamic", "operating.shaft_speed=20000 rpm"],
    "bath": [*("lubricant.supply=oil_bath", "lubricant.mixture_fraction=0"), "operating.shaft_speed=5000 rpm"],
}


@pytest.mark.parametrize("name", OPERATING_POINTS)
def test_at_equilibrium_shaft_power_leaves_as_heat_to_a_millionth(name):
    of = scene(*OPERATING_POINTS[name])
    found = thermal_equilibrium(of, scene_inputs(of))
    assert found.converged and found.reason == ""
    power = found.powers["shaft_power"]
    assert found.heat_to_oil + found.heat_to_ambient == pytest.approx(power, rel=1e-6)
    assert sum(found.powers[each] for each in POWERS) == pytest.approx(power, rel=1e-6)


def test_a_run_that_starts_in_equilibrium_stays_there():
    run = Simulation(scene("heat.start=equilibrium", level="steady"))
    before = run.thermal.temperatures.copy()
    for _ in range(20):
        run.advance(1.0)
    assert run.thermal.temperatures == pytest.approx(before, abs=0.3)  # the loads of conductances are those of an instant


def test_preload_that_heat_closes_further_has_no_equilibrium_and_the_reason_says_so():
    inside = dict(shaft_inner_ring=2.0, inner_ring_rollers=2.0, rollers_outer_ring=2.0, outer_ring_housing=2.0, rollers_oil=2.0)
    links = only(**inside, housing_ambient=0.3)
    of = scene(*COLD, "bearing.clearance=-20 um", "operating.shaft_speed=15000 rpm", *links)
    found = thermal_equilibrium(of, scene_inputs(of))
    assert not found.converged
    assert "no thermal equilibrium below the limit of 300 degC" in found.reason and "the clearance is gone" in found.reason


def test_a_long_call_is_as_good_as_short_ones():
    """Inputs change linearly over both, losses follow temperatures in both."""
    run, other = Simulation(scene(level="steady")), Simulation(scene(level="steady"))
    end = scene_inputs(run.scene)._replace(shaft_speed=3000.0)
    start = run.inputs
    long = run.advance(20.0, end, samples=4)
    short = [other.advance(0.1, start._replace(shaft_speed=start.shaft_speed + (k + 1) / 200 * (3000.0 - start.shaft_speed))) for k in range(200)]
    assert long["time"] == pytest.approx([5.0, 10.0, 15.0, 20.0]) and run.time == pytest.approx(20.0)
    assert long["shaft_speed"][-1] == 3000.0 and run.inputs == end
    for name in NODE_OBSERVABLES:
        assert long[name][-1] == pytest.approx(short[-1][name][0], abs=0.1)
    assert run.sample["damage"] == pytest.approx(other.sample["damage"], rel=1e-3)


def test_a_long_call_that_fails_leaves_the_simulation_as_it_was():
    run = Simulation(scene("integration.step_budget=2000"))
    run.advance(0.01)
    before, nodes = run.sample.tobytes(), run.thermal.temperatures.copy()
    with pytest.raises(IntegrationError):
        run.advance(30.0)
    assert run.sample.tobytes() == before and (run.thermal.temperatures == nodes).all() and run.time == 0.01


def test_a_run_begins_in_the_equilibrium_of_its_own_level_and_stays_there():
    of = scene("heat.interval=0.02")
    steady = thermal_equilibrium(of, scene_inputs(of)).temperatures
    run = Simulation(of)
    begin_in_equilibrium(run, 0.05, 0.2)
    assert run.time == 0.0 and run.thermal.temperatures == pytest.approx(steady, abs=1.5)
    began = run.thermal.temperatures.copy()
    run.advance(0.5, samples=50)
    assert run.thermal.temperatures == pytest.approx(began, abs=0.5)


def test_a_point_of_a_sweep_without_equilibrium_fails_and_says_why():
    row = point_row(scene("heat.limit=130 degC", level="steady"))
    assert row["status"] == "failed" and "no thermal equilibrium below the limit of 130 degC" in row["reason"]


def test_temperatures_can_be_set_and_held_only_with_a_network():
    run = Simulation(scene(level="steady"))
    run.set_temperatures(np.full(NODES, 400.0))
    run.advance(5.0)
    assert (run.thermal.temperatures == 400.0).all() and run.sample["housing_temperature"] == 400.0
    with pytest.raises(ValueError, match="heat.law=network"):
        Simulation(load_scene("deng2017_table1")).set_temperatures(np.full(NODES, 400.0))


def test_inputs_of_a_scene_with_a_network_count_as_the_oil_that_comes_in():
    run = Simulation(scene(level="steady"), Inputs(3000.0, 800.0, 0.0, 373.15))
    run.advance(3.0)
    assert run.sample["oil_temperature"] == 373.15 and run.sample["oil_outlet_temperature"] > 380.0


def test_the_lubrication_of_a_scene_without_heat_is_that_of_its_oil():
    of = load_scene("deng2017_table1")
    params = pack(of)
    assert lubricate_scene(of, params, 380.0).temperature == 380.0


@pytest.mark.parametrize(("scatter", "agrees"), [(0.2, True), (1.2, True), (6.0, False)])
def test_losses_that_scatter_from_run_to_run_are_averaged_until_temperatures_agree(monkeypatch, scatter, agrees):
    at_rest = itertools.cycle([330.0 + scatter, 330.0 - scatter])
    resting = types.SimpleNamespace(rest=lambda window, inlet: np.full(6, next(at_rest)))
    limit = types.SimpleNamespace(level="planar", heat=types.SimpleNamespace(limit=500.0))
    run = types.SimpleNamespace(inputs=types.SimpleNamespace(oil_temperature=320.0), thermal=resting, scene=limit, started=[])
    run.reset, run.set_temperatures = lambda *state: run.started.append(state[1]), lambda nodes: None
    found = types.SimpleNamespace(converged=True, temperatures=np.full(6, 325.0))
    monkeypatch.setattr("bearing_sim.levels.steady.equilibrium.thermal_equilibrium", lambda *given: found)
    monkeypatch.setattr(thermal, "advance_until_settled", lambda *given: types.SimpleNamespace(window=None))
    if not agrees:
        with pytest.raises(IntegrationError, match="no thermal equilibrium at level planar: temperatures still change by"):
            begin_in_equilibrium(run, 0.05, 0.2)
        return
    begin_in_equilibrium(run, 0.05, 0.2)
    assert run.started[-1] == pytest.approx(np.full(6, 330.0), abs=0.35)
