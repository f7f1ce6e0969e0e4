# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables of operating points: their interpolant, their error, their place on disk, and what happens beyond them."""

import json
import math
import os
import random
from functools import partial

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.interpolate import PchipInterpolator
from sim_time_bench import RATE, FalseWall, ListSink, Player, assert_same_samples, course, replayed, write

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.levels.steady import shared_table
from bearing_sim.levels.steady import table_builder as store
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table import common_period, empty_table, mirror_axis, monotone_slopes, radius_at
from bearing_sim.levels.steady.table_builder import (
    assembled,
    build_table,
    cached_table,
    holds,
    look_up,
    obtain_table,
    read_table,
    reference_of,
    solve_points,
    solve_scene,
    table_hash,
    table_path,
    write_table,
)
from bearing_sim.model.params import lubricate, pack
from bearing_sim.model.table_span import Span, span_of
from bearing_sim.physics.raceway import tabulated
from bearing_sim.runtime.sim_time import SimTimeModel
from bearing_sim.scene.contour import outer_contour

RPM = math.pi / 30
SMALL = [
    "level=steady",
    "table.maximum_speed=46000 rpm",
    "table.maximum_load=1.2 kN",
    "table.minimum_temperature=120 degC",
    "table.maximum_temperature=120 degC",
]


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    """Keep the tables of these tests apart from the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "FOLDER", tmp_path_factory.mktemp("tables"))
        yield


@pytest.fixture(scope="module")
def small():
    scene = load_scene("deng2017_table1", SMALL)
    return scene, *obtain_table(scene, workers=1)


def drawn(table, count, seed=5):
    lot = np.random.default_rng(seed)
    return np.column_stack(
        [
            lot.uniform(-table.speeds[-1], table.speeds[-1], count),
            table.loads[-1] * lot.random(count) ** 2,
            lot.uniform(table.temperatures[0], table.temperatures[-1], count),
            lot.uniform(-math.pi, math.pi, count),
            lot.uniform(table.growths[0], table.growths[-1], count),
        ]
    )


def synthetic(values_of, knots):
    """A table of the same numbers in every column."""
    grid = values_of(*np.meshgrid(*knots, indexing="ij"))
    return assembled(knots, 2 * math.pi / 3, 0.0, np.repeat(grid[None, ..., None], len(ANSWER), -1))


def uneven_knots(n):
    even = np.linspace(0.0, 1.0, n)
    return [5 * even**1.3, 3 * even**1.5, 300 + 100 * even, np.arange(n) * (2 * math.pi / 3 / n), 1e-5 * even**1.2]


def test_slopes_along_an_axis_are_those_of_scipys_monotone_cubic():
    knots = np.array([0.0, 0.3, 1.0, 1.1, 2.5, 4.0])
    values = np.random.default_rng(3).normal(size=(6, 4))
    np.testing.assert_allclose(monotone_slopes(knots, values, 0), PchipInterpolator(knots, values).derivative()(knots), rtol=1e-12, atol=1e-12)


def test_interpolant_follows_scipys_monotone_cubic_along_every_line_of_the_grid():
    lot, knots = np.random.default_rng(4), uneven_knots(5)
    grid = lot.normal(size=(5, 5, 5, 5, 5))
    table = assembled(knots, 2 * math.pi / 3, 0.0, np.repeat(grid[None, ..., None], len(ANSWER), -1))
    for axis in (0, 1, 2, 4):
        where = np.tile([knots[other][2] for other in range(5)], (50, 1))
        where[:, axis] = np.linspace(knots[axis][0], knots[axis][-1], 50)
        line = grid[tuple(slice(None) if other == axis else 2 for other in range(5))]
        np.testing.assert_allclose(look_up(table, where)[:, 0], PchipInterpolator(knots[axis], line)(where[:, axis]), rtol=1e-9, atol=1e-9)


def test_interpolant_never_leaves_what_the_corners_of_its_cell_hold():
    lot, knots = np.random.default_rng(6), uneven_knots(4)
    grid = lot.normal(size=(4, 4, 4, 4, 4)) ** 3
    table = assembled(knots, 2 * math.pi / 3, 0.0, np.repeat(grid[None, ..., None], len(ANSWER), -1))
    points = drawn(table, 3000)
    points[:, 0] = np.abs(points[:, 0])
    found = look_up(table, points)[:, 0]
    corners = []
    for axis, place in enumerate(points.T):
        place = np.mod(place, table.period) if axis == 3 else place
        low = np.clip(np.searchsorted(knots[axis], place, "right") - 1, 0, 3 if axis == 3 else 2)
        corners.append((low, (low + 1) % 4))
    values = np.array([grid[tuple(corners[axis][(corner >> axis) & 1] for axis in range(5))] for corner in range(32)])
    assert np.all(found >= values.min(axis=0) - 1e-12) and np.all(found <= values.max(axis=0) + 1e-12)


def test_interpolant_is_monotone_where_the_knots_are():
    table = synthetic(lambda a, b, c, d, e: np.tanh(2 * a - 3) + 0.3 * a + np.sqrt(b + 0.01) + 0.01 * c + 0 * d + 1e5 * e, uneven_knots(6))
    points = drawn(table, 400)
    points[:, 0] = np.abs(points[:, 0])
    for axis in (0, 1, 2, 4):
        lines = np.repeat(points[:, None, :], 40, axis=1)
        knots = (table.speeds, table.loads, table.temperatures, table.angles, table.growths)[axis]
        lines[..., axis] = np.linspace(knots[0], knots[-1], 40)
        rises = np.diff(look_up(table, lines.reshape(-1, 5))[:, 0].reshape(400, 40), axis=1)
        assert rises.min() > -1e-9


def test_error_falls_by_more_than_the_third_power_of_the_spacing():
    def smooth(a, b, c, d, e):
        return np.exp(0.3 * a) * (1 + 0.1 * np.sin(b)) + (c / 300) ** 2 + np.cos(1e5 * e)

    errors = []
    for n in (7, 13):
        table = synthetic(smooth, uneven_knots(n))
        points = drawn(table, 2000)
        points[:, 0] = np.abs(points[:, 0])
        errors.append(np.abs(look_up(table, points)[:, 0] - smooth(*points.T)).mean())
    assert errors[1] < errors[0] / 6


def test_table_keeps_its_tolerance_at_points_that_it_has_not_seen(small):
    scene, table, quality = small
    points = drawn(table, 120)
    found = look_up(table, points)
    exact = solve_points(scene, points)
    off = np.abs(found - exact)[:, ANSWER.cage_slip]
    assert np.mean(off <= 2.5e-4 + 0.02 * np.abs(exact[:, ANSWER.cage_slip])) > 0.97
    for column in (ANSWER.inner_equivalent_load, ANSWER.outer_equivalent_load):
        assert np.abs(found[:, column] / exact[:, column] - 1).max() < 0.01
    assert quality.within > 0.97 and quality.missing == 0


def test_life_never_rises_with_load_nor_shows_negative_slip_at_speed(small):
    _, table, _ = small
    loads = np.linspace(0.0, table.loads[-1], 200)
    for speed, angle in ((20000 * RPM, 0.3), (45000 * RPM, 1.0), (-45000 * RPM, 2.0)):
        found = look_up(table, np.column_stack([np.full(200, speed), loads, np.full(200, 393.15), np.full(200, angle)]))
        assert found[:, ANSWER.cage_slip].min() > 0.0
        assert found[-1, ANSWER.inner_equivalent_load] > found[0, ANSWER.inner_equivalent_load]


def test_simulation_with_a_table_is_the_one_that_solves_to_its_tolerance(small):
    scene, table, _ = small
    with_table, without = Simulation(scene, table=table), Simulation(scene, table=empty_table())
    a, b = (run.advance(0.3)[0] for run in (with_table, without))
    assert with_table._work.solutions[0] == 0 and without._work.solutions[0] == 1
    for name in ("cage_slip", "rating_life", "shaft_power"):
        assert a[name] == pytest.approx(b[name], rel=0.02)


@pytest.mark.parametrize("inputs", [(47000 * RPM, 800.0, 0.0, 393.15), (4000.0, 0.0, 1300.0, 393.15), (4000.0, 100.0, 0.0, 394.0)])
def test_condition_outside_the_table_is_solved_for_and_not_extrapolated(small, inputs):
    scene, table, _ = small
    run = Simulation(scene, Inputs(*inputs), table)
    sample = run.advance(1.0)[0]
    found = solve_scene(scene, inputs[0], math.hypot(*inputs[1:3]), inputs[3], math.atan2(inputs[2], inputs[1]))
    assert sample["cage_slip"] == pytest.approx(found[ANSWER.cage_slip], rel=1e-9)
    assert np.isnan(look_up(table, [(inputs[0], math.hypot(*inputs[1:3]), inputs[3], 0.0)])).all()


@pytest.mark.long
def test_table_with_an_axis_of_growth_agrees_with_the_solver_between_its_knots():
    scene = load_scene("deng2017_table1", [*SMALL, "bearing.dimensions_at=cold", "bearing.clearance=20 um", "table.tolerance=5 %"])
    params = pack(scene)
    span = span_of(scene)._replace(minimum_growth=-1e-6, maximum_growth=1e-6, reverse=False)
    table, quality = build_table(params, lambda kelvin: lubricate(scene.lubricant, params, kelvin), span, 0.05, workers=1, most_nodes=2500)
    lot = np.random.default_rng(8)
    points = np.column_stack([lot.choice(knots, 60) for knots in (table.speeds, table.loads, table.temperatures, table.angles)])
    points = np.column_stack([points, lot.uniform(-1e-6, 1e-6, 60)])
    found, exact = look_up(table, points), solve_points(scene, points)
    off = np.abs(found - exact)[:, ANSWER.cage_slip]
    assert np.mean(off <= 2.5e-4 + 0.05 * np.abs(exact[:, ANSWER.cage_slip])) > 0.9 and quality.missing == 0
    assert (np.diff(look_up(table, [(4000.0, 500.0, 393.15, 0.0, growth) for growth in table.growths])[:, ANSWER.inner_equivalent_load]) > 0.0).all()
    assert not holds(table, 4000.0, 500.0, 393.15, 2e-6) and np.isnan(look_up(table, [(4000.0, 500.0, 393.15, 0.0, 2e-6)])).all()


def test_course_of_inputs_is_the_same_as_one_advance_after_the_other(small):
    scene, table, _ = small
    times = np.linspace(0.1, 4.0, 40)
    inputs = np.column_stack([3000 + 400 * times, 500 + 100 * np.sin(times), 200 * np.cos(times), np.full(40, 393.15), *np.full((2, 40), math.nan)])
    one, other = Simulation(scene, table=table), Simulation(scene, table=table)
    block = one.advance_profile(np.full(40, 0.1), inputs)
    singles = np.concatenate([other.advance(0.1, Inputs(*row)) for row in inputs])
    for name in ("time", "cage_slip", "cage_angle", "damage", "inner_load", "rating_life", "shaft_angle", "oil_temperature"):
        np.testing.assert_allclose(block[name], singles[name], rtol=1e-9, atol=1e-9)
    assert one.time == pytest.approx(other.time) and one.counters.steps == other.counters.steps == 40


def test_course_by_table_under_a_clock_is_that_of_a_replay_to_the_last_bit(small, tmp_path):
    scene, table, _ = small
    messages, by_table, wall = course(1.2, oil=False), partial(Simulation, table=table), FalseWall()
    expected = replayed(write(tmp_path / "log.mcap", messages), scene, model=by_table)
    model, recordings = SimTimeModel(scene, by_table(scene), RATE, RATE, wall=wall), []

    def record(start_ns):
        recordings.append(ListSink(start_ns))
        return recordings[-1]

    model.open("record", record, reopen=True)
    player = Player(model, wall)
    player.play(messages, np.arange(0.0, 1.21, 0.1).tolist(), random.Random(3))
    player.stand(1.0)
    player.until_idle()
    assert model.close()
    assert_same_samples(recordings[-1].samples, expected.samples)
    assert len({float(sample["cage_slip"]) for sample in recordings[-1].samples.values()}) > 50, "the slip follows the inputs"


@pytest.fixture(scope="module")
def warm():
    # takes minutes: an idling bearing without load, whose cage is marched, at many speeds and temperatures
    scene = load_scene(
        "deng2017_table1",
        [
            *SMALL[:-2], "table.minimum_temperature=90 degC", "table.maximum_temperature=130 degC", "bearing.dimensions_at=cold",
            "bearing.clearance=15 um", "heat.law=network", "table.tolerance=10 %", "table.minimum_difference=-40 K", "table.maximum_difference=30 K",
        ],
    )  # fmt: skip
    params = pack(scene)
    table = build_table(
        params, lambda kelvin: lubricate(scene.lubricant, params, kelvin), span_of(scene)._replace(reverse=False), 0.1, 1, most_nodes=2000
    )
    return scene, table[0]


@pytest.mark.long
@pytest.mark.timeout(1050)
def test_course_beside_a_thermal_network_is_the_same_as_one_advance_after_the_other(warm):
    scene, table = warm
    times = np.linspace(0.1, 6.0, 120)  # intervals of half the network's: it steps at every second instant
    inputs = np.column_stack([3000 + 100 * times, 500 + 50 * np.sin(times), 100 * np.cos(times), np.full(120, 383.15), *np.full((2, 120), math.nan)])
    start = Inputs(3000.0, 500.0, 0.0, 383.15)
    one, other = Simulation(scene, start, table), Simulation(scene, start, table)
    block = one.advance_profile(np.full(120, 0.05), inputs)
    singles = np.concatenate([other.advance(0.05, Inputs(*row)) for row in inputs])
    assert len(block) == 120 and np.ptp(block["roller_temperature"]) > 1.0 and np.ptp(block["running_clearance"]) > 1e-6
    for name in ("time", "shaft_angle", "running_clearance", "inner_ring_temperature", "roller_temperature", "oil_outlet_temperature", "heat_to_oil"):
        np.testing.assert_allclose(block[name], singles[name], rtol=1e-6, atol=1e-12, err_msg=name)
    for name in ("cage_slip", "cage_angle", "damage", "inner_load", "rating_life", "viscosity_ratio"):
        np.testing.assert_allclose(block[name], singles[name], rtol=2e-4, atol=1e-6, err_msg=name)
    np.testing.assert_allclose(one.thermal.temperatures, other.thermal.temperatures, rtol=1e-7)
    np.testing.assert_allclose(one.thermal.books, other.thermal.books, rtol=1e-4)


@pytest.mark.long
@pytest.mark.timeout(1050)
def test_course_with_a_measured_temperature_leaves_the_rest_to_single_steps(warm):
    scene, table = warm
    inputs = np.array([[3000.0, 500.0, 0.0, 383.15, math.nan, math.nan]] * 3 + [[3000.0, 500.0, 0.0, 383.15, 390.0, math.nan]])
    run = Simulation(scene, Inputs(*inputs[0]), table)
    assert len(run.advance_profile(np.full(4, 0.1), inputs)) == 3 and len(run.advance_profile(np.full(1, 0.1), inputs[3:])) == 0


def test_course_ends_where_the_table_does(small):
    scene, table, _ = small
    inputs = np.column_stack([np.linspace(3000, 6000, 30), np.full(30, 500.0), np.zeros(30), np.full(30, 393.15), *np.full((2, 30), math.nan)])
    reached = Simulation(scene, table=table).advance_profile(np.full(30, 0.1), inputs)
    assert 0 < len(reached) < 30 and reached["shaft_speed"].max() <= table.speeds[-1]


def test_table_comes_back_from_disk_as_it_was(small):
    scene, table, quality = small
    again, its_quality = cached_table(scene)
    for a, b in zip(table, again):
        np.testing.assert_array_equal(a, b)
    assert its_quality == quality


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: b"",
        lambda data: data[:100],
        lambda data: data[: len(data) // 2],
        lambda data: np.random.default_rng(1).bytes(5000),
        lambda data: data[:500] + bytes(16) + data[516:],
        lambda data: data[:-1] + bytes([data[-1] ^ 1]),
    ],
)
def test_broken_file_is_as_good_as_none(small, tmp_path, spoil):
    _, table, quality = small
    path = tmp_path / "table.npz"
    write_table(path, table, quality)
    assert read_table(path) is not None
    path.write_bytes(spoil(path.read_bytes()))
    assert read_table(path) is None


@pytest.mark.parametrize("kind", ["pipe", "endless device", "folder", "sparse file of 1 GB"])
def test_what_is_no_table_is_neither_waited_for_nor_read_whole(tmp_path, kind):
    path = tmp_path / "table.npz"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "endless device":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    else:
        with open(path, "wb") as file:
            file.truncate(1_000_000_000)
    assert read_table(path) is None


def test_broken_file_is_built_anew(small, monkeypatch):
    scene, table, quality = small
    path = table_path(scene, span_of(scene))
    whole = path.read_bytes()
    path.write_bytes(whole[:1000])
    monkeypatch.setattr(store, "build_table", lambda *_, **__: (table, quality))
    assert Simulation(scene).takes_profiles is False
    assert obtain_table(scene)[1] == quality and read_table(path) is not None
    assert Simulation(scene).takes_profiles is True


def test_table_belongs_to_bearing_oil_and_span_and_to_nothing_else():
    def of(*overrides):
        scene = load_scene("deng2017_table1", [*SMALL, *overrides])
        return table_hash(scene, span_of(scene))

    same = ["name=other", "operating.radial_load=500 N", "life.reliability=99 %", "life.method=iso281", "thresholds.life_warning=10 h", "level=slip"]
    other = [
        "bearing.outer_raceway.low_radius=34.861 mm",
        "lubricant.oil=mil_l_23699",
        "lubricant.rolling_resistance=hydrodynamic",
        "table.maximum_load=1 kN",
    ]
    other += [
        "life.a_iso=bath_17_14",
        "bearing.roller.crown=iso_log",
        "bearing.cage.pocket_friction=0.04",
        "table.tolerance=3 %",
        "bearing.outer_raceway.roundness=2 um",
    ]
    assert {of(change) for change in same} == {of()}
    assert len({of(), *map(of, other)}) == len(other) + 1


@pytest.fixture
def other_machine(tmp_path, monkeypatch):
    """Return a function that goes to another machine: it has no tables, and the last digits of what it computes differ."""

    def go():
        numbers = store.table_numbers
        monkeypatch.setattr(store, "FOLDER", tmp_path / "its tables")
        for module in (store, shared_table):
            monkeypatch.setattr(module, "table_numbers", lambda scene, span: [number * (1.0 + 3e-16) for number in numbers(scene, span)])

    return go


def test_a_table_of_another_machine_is_taken_although_the_last_digits_of_its_bearing_differ(small, tmp_path, other_machine):
    scene, table, quality = small
    command, file = ["table", "deng2017_table1", *(word for change in SMALL for word in ("--set", change))], str(tmp_path / "shared.npz")
    assert CliRunner().invoke(main, [*command, "-o", file]).exit_code == 0
    other_machine()
    assert cached_table(scene) is None
    taken = CliRunner().invoke(main, [*command, "--from", file])
    assert taken.exit_code == 0, taken.output
    found, its_quality = cached_table(scene)
    assert its_quality == quality and (found.nodes == table.nodes).all()
    assert Simulation(scene).takes_profiles is True


def test_a_table_for_another_bearing_of_another_version_or_none_at_all_is_not_taken(small, tmp_path, monkeypatch):
    scene, table, quality = small
    file, kept = tmp_path / "shared.npz", set(store.FOLDER.iterdir())
    file.write_bytes(shared_table.shared_table(scene, table, quality))
    for change in ("bearing.outer_raceway.low_radius=34.861 mm", "lubricant.oil=mil_l_23699", "table.maximum_load=1.3 kN", "bearing.roller.count=17"):
        with pytest.raises(ValueError, match="shared.npz: built for another bearing, oil, range or tolerance"):
            shared_table.take_table(file, load_scene("deng2017_table1", [*SMALL, change]))
    with monkeypatch.context() as patch:
        patch.setattr(shared_table, "sources_hash", lambda: "other")
        with pytest.raises(ValueError, match="built by another version; install the same versions of bearing_sim and numba"):
            shared_table.take_table(file, scene)
    write_table(file, table, quality)
    with pytest.raises(ValueError, match="no table for other machines; write one with bearing-sim table SCENE -o FILE"):
        shared_table.take_table(file, scene)
    file.write_bytes(shared_table.shared_table(scene, table, quality)[:-100])
    with pytest.raises(ValueError, match="digest"):
        shared_table.take_table(file, scene)
    assert set(store.FOLDER.iterdir()) == kept


def raceway(*overrides):
    scene = load_scene("deng2017_table1", overrides)
    return pack(scene).raceways.contour, scene.bearing.outer_raceway


@pytest.mark.parametrize(
    ("overrides", "period", "mirrored"),
    [
        ([], 120.0, True),
        (["bearing.outer_raceway.installation_angle=13.7 deg"], 120.0, True),
        (["bearing.outer_raceway.lobes=5"], 72.0, True),
        (["bearing.outer_raceway.d_value=0 mm"], 0.0, True),
        (["bearing.outer_raceway.roundness=6 um"], 360.0, False),
    ],
)
def test_symmetry_of_the_contour_is_found(overrides, period, mirrored):
    contour, outer = raceway(*overrides)
    assert math.degrees(common_period(contour)) == pytest.approx(period)
    axis = mirror_axis(contour)
    assert math.isfinite(axis) == mirrored
    azimuths = np.linspace(0.0, 7.0, 50)
    np.testing.assert_allclose(radius_at(contour, azimuths), outer_contour(outer, azimuths)[0], atol=1e-9)
    if mirrored:
        np.testing.assert_allclose(outer_contour(outer, axis + azimuths)[0], outer_contour(outer, axis - azimuths)[0], atol=2e-9)


@pytest.mark.long
def test_contour_without_symmetry_gets_nodes_for_both_senses_only_where_wanted():
    def table(reverse):
        scene = load_scene("deng2017_table1", ["bearing.outer_raceway.roundness=6 um"])
        params = pack(scene)
        span = Span(4000.0, 1000.0, 393.15, 393.15, reverse)
        return build_table(params, lambda kelvin: lubricate(scene.lubricant, params, kelvin), span, 0.5, 1)[0]

    backwards = [(-3000.0, 500.0, 393.15, 0.7)]
    assert np.isnan(look_up(table(False), backwards)).all()
    exact = solve_scene(load_scene("deng2017_table1", ["bearing.outer_raceway.roundness=6 um"]), *backwards[0])
    assert look_up(table(True), backwards)[0, ANSWER.cage_slip] == pytest.approx(exact[ANSWER.cage_slip], rel=0.1)


def test_round_bearing_needs_one_direction():
    scene = load_scene("deng2017_table1", ["bearing.outer_raceway.d_value=0 mm", "bearing.outer_raceway.low_radius=34.86 mm"])
    params = pack(scene)
    table, _ = build_table(params, lambda kelvin: lubricate(scene.lubricant, params, kelvin), Span(4000.0, 1000.0, 393.15, 393.15, False), 0.3, 1)
    assert len(table.angles) == 1
    ahead, aside = look_up(table, [(3000.0, 700.0, 393.15, 0.0), (-3000.0, 700.0, 393.15, 2.0)])
    np.testing.assert_allclose(ahead, aside)


def test_tabulated_contour_is_the_one_that_the_symmetry_is_looked_for_in():
    table = tabulated(lambda azimuth: (1.0 + 0.1 * np.cos(4 * azimuth), -0.4 * np.sin(4 * azimuth)))
    assert common_period(table) == pytest.approx(math.pi / 2)


def test_replay_without_a_recording_comes_to_the_same_as_with_one(small, tmp_path):
    from recordings import steady_log

    from bearing_sim.inputs.log import read_input_log
    from bearing_sim.inputs.profile import judge
    from bearing_sim.recording.writer import McapSink
    from bearing_sim.runtime.replay import replay

    scene, table, _ = small
    names = {"shaft_speed": None, "radial_load": None, "oil_temperature": None}
    log = steady_log(tmp_path / "log.mcap", duration=6.0, speed=4600.0)
    course = judge(read_input_log(log, names, "shaft", "header"), scene.accepted_inputs, Inputs(0.0, 0.0, 0.0, 393.15))
    make = partial(Simulation, table=table)
    silent = replay(scene, course, None, model=make)
    with McapSink(tmp_path / "out.mcap", scene, course.start_ns) as recording:
        told = replay(scene, course, recording, model=make)
    one_by_one = replay(scene, course, None, model=lambda *given: Simulation(*given, empty_table()))
    assert silent.samples == told.samples == one_by_one.samples > 50
    assert silent.events == told.events == one_by_one.events
    np.testing.assert_allclose(silent.slip, told.slip)
    np.testing.assert_allclose(silent.weight, told.weight)
    assert silent.damage == pytest.approx(told.damage) and silent.damage == pytest.approx(one_by_one.damage, rel=0.02)


def test_command_builds_shows_and_asks(small):
    scene, _, quality = small
    arguments = ["table", "deng2017_table1", *(part for change in SMALL[1:] for part in ("--set", change)), "--workers", "1"]
    done = CliRunner().invoke(main, [*arguments, "--at", "40000,700,120,30", "--json"])
    assert done.exit_code == 0, done.output
    report = json.loads(done.stdout)
    assert report["nodes"] == quality.nodes and report["points"][0]["held"]
    of_table, exact = report["points"][0]["table_and_solution"]["cage_slip"]
    assert of_table == pytest.approx(exact, rel=0.03)
    assert "built" in CliRunner().invoke(main, arguments).output
    assert CliRunner().invoke(main, ["table", "deng2017_table1", "--at", "fast"]).exit_code == 2


def clearance_scene(name, clearance, *overrides):
    """Return a scene beside a thermal network, whose table has an axis of growth."""
    lubricant = {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "60 degC"}
    operating = {"shaft_speed": "1500 rpm", "radial_load": "3 kN"}
    tree = {"name": "played", "level": "steady", "bearing": name, "lubricant": lubricant, "operating": operating, "heat": {"law": "network"}}
    small = ["table.tolerance=50 %", "table.minimum_temperature=50 degC", "table.maximum_temperature=50 degC", "table.maximum_load=6 kN"]
    return load_scene(tree, [f"bearing.clearance={clearance} um", *small, *overrides])


@pytest.mark.parametrize("name", ["NU 210", "NJ 2308", "NU 232", "lobed"])
def test_a_bearing_of_more_clearance_runs_as_one_of_less_that_has_grown_less(name):
    lobes = ["bearing.outer_raceway={d_value: 30 um, lobes: 3}"] if name == "lobed" else []
    scene = clearance_scene("NU 210" if lobes else name, 44, *lobes)
    reference = reference_of(scene, span_of(scene))
    assert reference.offset == pytest.approx(0.5 * (44e-6 - 40e-6))
    where = np.array([[150.0, 3000.0, 333.15, 0.0, growth] for growth in (-2e-5, 0.0, 1e-5)] + [[60.0, 800.0, 333.15, 0.3, 5e-6]])
    there = where - [0.0, 0.0, 0.0, 0.0, reference.offset]
    own, other = solve_points(scene, where), solve_points(reference.scene, there)
    assert other[:, ANSWER.cage_slip] == pytest.approx(own[:, ANSWER.cage_slip], abs=5e-5)
    unshifted = solve_points(reference.scene, where)
    errors = [np.abs(each[:, ANSWER.inner_lamina_load] / own[:, ANSWER.inner_lamina_load] - 1.0).max() for each in (other, unshifted)]
    assert errors[0] < 5e-4 < 2e-3 < errors[1], "the shift counts"


def test_clearances_within_a_step_share_a_table_and_others_do_not():
    def path(clearance, *overrides):
        scene = clearance_scene("NU 210", clearance, *overrides)
        return table_path(scene, span_of(scene))

    assert path(56) == path(60) == path(64) and path(56) != path(66) and path(56) != path(56, "table.tolerance=40 %")
    plain = "heat={law: none}"  # a table of one growth has nothing to shift along
    assert path(56, plain) != path(60, plain)
    corrected = "table.correction=planar"
    assert path(56, corrected) != path(60, corrected)


@pytest.mark.long
@pytest.mark.timeout(600)
def test_a_table_is_taken_for_another_clearance_and_for_another_machine(monkeypatch, tmp_path):
    monkeypatch.setattr(store, "FOLDER", tmp_path)
    monkeypatch.setattr(store, "_MOST_WARM_NODES", 1)
    first, other = clearance_scene("NU 210", 56), clearance_scene("NU 210", 64)
    told = []
    table, _ = obtain_table(first, workers=1, progress=lambda solved, wanted: told.append((solved, wanted)))
    assert all(solved <= wanted for solved, wanted in told) and told[-1][0] == told[-1][1]
    shifted, _ = cached_table(other)
    assert shifted.growths - table.growths == pytest.approx(4e-6) and np.array_equal(shifted.nodes, table.nodes, equal_nan=True)
    where = np.array([[150.0, 3000.0, shifted.temperatures[0], 0.0, 0.0]])
    assert look_up(shifted, where) == pytest.approx(look_up(table, where - [0.0, 0.0, 0.0, 0.0, 4e-6]), nan_ok=True)
    file = tmp_path / "shared.npz"
    file.write_bytes(shared_table.shared_table(other, *cached_table(other)))
    (tmp_path / table_path(first, span_of(first)).name).unlink()
    taken, _ = shared_table.take_table(file, first)
    assert taken.growths == pytest.approx(table.growths) and cached_table(first) is not None
