# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Flanges: their law by hand, what they do to rollers, ring and shaft at each level, and the axial load that rests on them."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from test_level_planar import dense_jacobian as planar_jacobian
from test_power import planar_gap, rough_planar_state, simulation
from test_spatial_reference import by_roller, dense_jacobian, kinds, plain, rough_state

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.slip import model as slip
from bearing_sim.levels.slip.power import slip_powers
from bearing_sim.levels.slip.state import OMEGA, SPIN
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial.power import spatial_powers
from bearing_sim.levels.spatial.state import BORDER
from bearing_sim.levels.spatial.state import SLICED as SLICED_ROW
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table_builder import solve_points
from bearing_sim.model.params import pack
from bearing_sim.numerics.linear_algebra import ARROW
from bearing_sim.numerics.simd import by_roller as lanes_by_roller
from bearing_sim.physics.flange import end_integrals, rim_corner, rub, shear
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.mixed import film_state
from bearing_sim.scene.flanges import flange_geometry

NUP = ["bearing.flanges={inner: both, outer: both, end_clearance: 20 um}"]
NU, N = ["bearing.flanges={outer: both}"], ["bearing.flanges={inner: both}"]
NJ = ["bearing.flanges={inner: one, outer: both}"]
LOADED = [*NUP, "operating.axial_load=90 N", "bearing.flanges.guiding_load=1 %"]


def lens_area(a, b, distance):
    """Area that two circles of radii a and b at a distance have in common."""
    u, v = (distance**2 + a**2 - b**2) / (2 * distance), (distance**2 + b**2 - a**2) / (2 * distance)
    return a**2 * math.acos(u / a) + b**2 * math.acos(v / b) - u * math.sqrt(a**2 - u**2) - v * math.sqrt(b**2 - v**2)


INNER_END = 29.75e-3, 31.7e-3, 35.25e-3, 4.95e-3
OUTER_END = 40.78e-3, 38.8e-3, 35.27e-3, 4.95e-3


@pytest.mark.parametrize("raceway, edge, centre, rim", [INNER_END, OUTER_END])
def test_overlap_of_parallel_faces_is_the_area_that_two_circles_share(raceway, edge, centre, rim):
    inside = lens_area(edge, rim, centre)
    expected = inside if edge > raceway else math.pi * rim**2 - inside
    assert end_integrals(raceway, edge, centre, rim, 1.0, 0.0)[0] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("raceway, edge, centre, rim", [INNER_END, OUTER_END])
def test_integrals_over_an_opening_gap_are_those_of_a_grid(raceway, edge, centre, rim):
    gap, layback, side = 25e-6, math.tan(math.radians(0.5)), np.linspace(-rim, rim, 2001)
    outwards, along = np.meshgrid(side, side)
    radius = np.hypot(centre + outwards, along)
    over = (outwards**2 + along**2 < rim**2) & ((radius < edge) if edge > raceway else (radius > edge))
    per = over * (side[1] - side[0]) ** 2 / (gap + layback * np.abs(radius - raceway))
    expected = per.sum(), (per * outwards).sum(), (per * (outwards**2 + along**2)).sum()
    assert end_integrals(raceway, edge, centre, rim, gap, layback) == pytest.approx(expected, rel=1e-3)


def test_concentric_discs_shear_as_couette_says():
    """A face that overlaps all of a flange around the same axis: M = pi eta s (R_2^4 - R_1^4)/(2 h), and no force."""
    radius, gap, viscosity, speed = 3e-3, 20e-6, 0.01, 700.0
    area, first, second = end_integrals(1.0 - radius, 1.0 + 2 * radius, 1.0, radius, gap, 0.0)  # a roller far out on a straight flange
    force, moment, *_ = shear(viscosity * area, viscosity * first, viscosity * second, 0.0, speed)
    assert moment == pytest.approx(-math.pi * viscosity * speed * radius**4 / (2 * gap), rel=1e-6)
    assert abs(force) < 1e-6 * abs(moment) / radius


def test_corners_stand_on_both_circles():
    _, edge, centre, rim = OUTER_END
    outwards, along = rim_corner(edge, centre, rim)
    assert math.hypot(outwards, along) == pytest.approx(rim) and math.hypot(centre + outwards, along) == pytest.approx(edge)


def test_friction_derives_from_the_power_that_it_loses():
    u, s, offset, corner, step = 1.3, 900.0, 2.5e-3, 1.7e-3, 1e-5
    law = getattr(rub, "py_func", rub)

    def at(u, s):
        return np.array(law(math.sqrt, 3.0, offset, corner, u, s)[:2])

    _, _, uu, us, ss, by_u, by_s = law(math.sqrt, 3.0, offset, corner, u, s)
    by_speed, by_turn = (at(u + step, s) - at(u - step, s)) / (2 * step), (at(u, s + 1e2 * step) - at(u, s - 1e2 * step)) / (2e2 * step)
    assert by_speed == pytest.approx([-uu, -us], rel=1e-6) and by_turn == pytest.approx([-us, -ss], rel=1e-6)
    assert -at(u, s) @ [u, s] == pytest.approx(3.0 * math.hypot(u - s * offset, s * corner), rel=1e-4)
    assert (by_u, by_s) == pytest.approx(tuple(-at(u, s) / 3.0))


def test_friction_falls_from_boundary_to_film_as_skf_weighs_it():
    params = pack(load_scene("deng2017_table1", [*NUP, "lubricant.mixed_friction=skf"]))
    mean = 0.5 * (50.027 + 73.4)
    for speed, viscosity in ((500.0, 12.0), (3000.0, 12.0), (20000.0, 2.0)):
        weight = math.exp(-2.6e-8 * (speed * viscosity) ** 1.4 * mean)
        expected = weight * 0.12 + (1 - weight) * 0.02
        assert params.flanges.film_friction == 0.02
        given = params.flanges.film_friction, params.minimum_load, params.starvation, params.mixed
        films = film_state(speed * math.pi / 30, 800.0, 1e-6 * viscosity, 0.05, *given)
        assert films.flange_friction == pytest.approx(expected, rel=1e-9)


def rough_slip_state(run, seed):
    random = np.random.default_rng(seed)
    state = run._state.copy()
    state[0], state[1] = random.uniform(0, 2 * math.pi), state[1] * random.uniform(0.5, 1.2)
    state[2:] *= random.uniform(0.3, 1.3, size=len(state) - 2)
    return state


def rates(level, overrides, state, extra=()):
    """dy/dt of a level with and without its flanges, and the powers with them and without."""
    found = []
    for options in (overrides, []):
        run = Simulation(load_scene("deng2017_table1", [f"level={level[0]}", *extra, *options]))
        model, rate = run._model(run.inputs, 1.0), np.zeros_like(state)
        assert level[1].rhs(0.0, state, model, run._work, rate)
        found.append((rate, run, model))
    return found


@pytest.mark.parametrize("options", [NU, N, NJ, NUP, LOADED], ids=["NU", "N", "NJ", "NUP", "loaded"])
@pytest.mark.parametrize("seed", range(3))
def test_flanges_stand_in_the_books_of_level_slip(seed, options):
    state = rough_slip_state(simulation("slip"), seed)
    (rate, run, model), (without, bare, bare_model) = rates(("slip", slip), options, state)
    speed = run.inputs.shaft_speed
    powers = slip_powers(state[OMEGA], state[SPIN:], speed, model, run._work)
    before = slip_powers(state[OMEGA], state[SPIN:], speed, bare_model, bare._work)
    params, radius = run._params, run._work.loads[LOAD.radius]
    inertia = params.cage.inertia + params.rollers.mass * (np.array(radius) ** 2).sum()
    gained = state[OMEGA] * (rate - without)[OMEGA] * inertia + params.rollers.inertia * state[SPIN:] @ (rate - without)[SPIN:]
    assert powers.flange > 0.0 == before.flange
    given, lost = powers.shaft - before.shaft, sum(powers[1:]) - sum(before[1:])
    assert given - lost == pytest.approx(gained, abs=1e-9 * (abs(given) + abs(lost) + abs(gained)))


@pytest.mark.parametrize("options", [NU, N, NUP, LOADED], ids=["NU", "N", "NUP", "loaded"])
@pytest.mark.parametrize("seed", range(2))
def test_flanges_stand_in_the_books_of_level_planar(seed, options):
    run = simulation("planar", *options)
    gap, largest, powers = planar_gap(run, rough_planar_state(run, seed))
    assert powers.flange > 0.0
    assert abs(gap) < 1e-8 * largest


def rough_skew(seed):
    """A rough state whose rollers are skewed beyond the end clearance, some of them."""
    run = Simulation(load_scene("deng2017_table1", ["level=spatial", "bearing.roller.slices=6", "operating.moment=2"]))
    state = rough_state(run, seed, 0.3)
    by_roller(state)[3] += np.random.default_rng(seed).normal(size=18) * 6e-3
    return state


SLICED = ["bearing.roller.slices=6", "operating.moment=2"]


@pytest.mark.parametrize("options", [NU, N, NUP, LOADED], ids=["NU", "N", "NUP", "loaded"])
def test_flanges_stand_in_the_books_of_level_spatial(options):
    state = rough_skew(3)
    (rate, run, model), (without, bare, bare_model) = rates(("spatial", spatial), options, state, SLICED)
    speed, params, change = run.inputs.shaft_speed, run._params, rate - without
    powers = spatial_powers(0.0, state, speed, model, run._work)
    before = spatial_powers(0.0, state, speed, bare_model, bare._work)
    rollers, faster = by_roller(state), by_roller(change)
    radius, _, tilt, skew, radius_speed, phi_speed, tilting, skewing, spin = rollers
    _, _, _, _, outwards, turning, tilted, skewed, spun = faster
    mass, across, polar = params.rollers.mass, params.tilts.roller_inertia, params.rollers.inertia
    gained = (mass * (radius_speed * outwards + radius**2 * phi_speed * turning) + polar * spin * spun).sum()
    gained += (across * ((tilting - phi_speed * skew) * (tilted - turning * skew) + (skewing + phi_speed * tilt) * (skewed + turning * tilt))).sum()
    border = np.repeat([params.ring.mass, params.tilts.ring_inertia], 2)
    gained += (border * state[BORDER : BORDER + 4] * change[BORDER : BORDER + 4]).sum()
    kept, flanges, body = 0.0, params.flanges, plain(state)
    apart, leans, leaning = body.place - body.ring[:, None], body.lean - body.ring_lean[:, None], body.leaning - body.ring_leaning[:, None]
    step, loads = 1e-9, lanes_by_roller(run._work.contacts[:5], SLICED_ROW.load, 18)
    share = flanges.load * (loads + 1.0) / (loads.sum() + 18.0)

    def stored(shift):
        """Elastic energy of the corners a moment later, and what the couples of the axial load have not given yet, from positions alone."""
        place = apart + shift * (body.velocity - body.ring_velocity[:, None])
        normal = place / np.hypot(*place)
        lean, later = leans + shift * leaning, rollers[:4] + shift * rollers[4:8]
        tangent = np.stack([-normal[1], normal[0]])
        energy = 0.0
        for face, turned in ((flanges.inner, (lean * tangent).sum(0)), (flanges.outer, later[3])):
            depth = np.abs(turned) * face.corner - flanges.clearance
            energy += (0.8 * flanges.stiffness * np.maximum(depth, 0.0) ** 2.5).sum() if face.corner > 0.0 else 0.0
        return energy + (share * (flanges.inner.offset * (lean * normal).sum(0) - flanges.outer.offset * later[2])).sum()

    kept = (stored(step) - stored(-step)) / (2 * step)
    given, lost = powers.shaft - before.shaft, sum(powers[1:]) - sum(before[1:])
    assert powers.flange > 0.0
    assert given - lost == pytest.approx(gained + kept, abs=1e-6 * (abs(given) + abs(lost) + abs(gained) + abs(kept)))


SPATIAL_STEPS = [1e-8, 1e-8, 1e-6, 1e-6, 1.0, 1e-6, 1e-4, 1.0, 1e-3, 1e-3, 1e-8, 1e-7, 1e-7, 1e-7, 1e-3, 1e-1, 1e-2, 1e-2, 0.1]
PLANAR_STEPS = [1e-8, 1e-8, 1e-6, 1e-3, 1e-3, 1e-3, 1e-8, 1e-7, 1e-3, 1e-1, 0.1]


def planar_kinds(count):
    return np.concatenate([[0, 0, 1, 1, 2, 3, 3, 4, 4, 5], np.repeat(np.arange(6, 11), count)])


@pytest.mark.parametrize(
    "level, module, dense, kinds, steps, rough, extra",
    [
        ("planar", planar, planar_jacobian, planar_kinds, PLANAR_STEPS, lambda: rough_planar_state(simulation("planar"), 5), []),
        ("spatial", spatial, dense_jacobian, kinds, SPATIAL_STEPS, lambda: rough_skew(5), SLICED),
    ],
    ids=["planar", "spatial"],
)
@pytest.mark.parametrize("options", [NUP, LOADED], ids=["NUP", "loaded"])
def test_jacobian_has_what_flanges_add_to_the_right_hand_side(level, module, dense, kinds, steps, rough, extra, options):
    state, which, steps = rough(), kinds(18), np.array(steps)
    found = [Simulation(load_scene("deng2017_table1", [f"level={level}", *extra, *with_flanges])) for with_flanges in (options, [])]
    expected = dense(found[0], state) - dense(found[1], state)
    # how rollers share an axial load is taken as constant, so that only columns by spin are complete
    columns = range(len(steps)) if options is NUP else [len(steps) - 1]

    models = [run._model(run.inputs, 1.0) for run in found]

    def added(state):
        rates = []
        for run, model in zip(found, models):
            rate = np.zeros_like(state)
            module.rhs(0.0, state, model, run._work, rate)
            rates.append(rate)
        whole[:] = rates[0]
        return rates[0] - rates[1]

    whole = np.zeros_like(state)
    difference = np.zeros_like(expected)
    for column, step in enumerate(steps[which]):
        shift = np.zeros_like(state)
        shift[column] = step
        difference[:, column] = (added(state + shift) - added(state - shift)) / (2 * step)
    for row in range(len(steps)):
        for column in columns:
            block = np.ix_(which == row, which == column)
            largest = max(np.abs(expected[block]).max(), np.abs(difference[block]).max())
            round_off = 1e-12 * np.abs(whole[which == row]).max() / steps[column]
            assert np.abs(expected[block] - difference[block]).max() <= 2e-4 * largest + round_off, (row, column)


@pytest.mark.parametrize("options", [NUP, LOADED], ids=["NUP", "loaded"])
def test_jacobian_of_level_slip_has_the_flanges(options):
    found, differences = [], []
    for with_flanges in (options, []):
        run = simulation("slip", "bearing.cage.pocket_friction=0", *with_flanges)
        state, model, rate = rough_slip_state(run, 2), run._model(run.inputs, 1.0), np.zeros(20)
        assert slip.rhs_and_jacobian(0.0, state, model, run._work, rate)
        found.append((run._work.jacobian.rows.copy(), run._work.jacobian.border.copy()))
        columns = []
        for index, step in ((OMEGA, 1e-3), (SPIN + 4, 1e-2)):
            ends = [np.zeros(20), np.zeros(20)]
            for end, sign in zip(ends, (1, -1)):
                shifted = state.copy()
                shifted[index] += sign * step
                slip.rhs(0.0, shifted, model, run._work, end)
            columns.append((ends[0] - ends[1]) / (2 * step))
        differences.append(columns)
    by_cage, by_spin = (one - other for one, other in zip(*differences))
    rows, border = found[0][0] - found[1][0], found[0][1] - found[1][1]
    assert rows[ARROW.diagonal, 4] == pytest.approx(by_spin[SPIN + 4], rel=1e-5)
    assert rows[ARROW.row, 4] == pytest.approx(by_spin[OMEGA], rel=1e-5)
    if options is LOADED:  # the cage's speed moves the loads, and with them how the rollers share the axial one
        return
    assert rows[ARROW.column] == pytest.approx(by_cage[SPIN:], rel=1e-4)
    assert border[1] == pytest.approx(by_cage[OMEGA], rel=1e-3)


def test_sizes_of_flanges_that_are_not_there_change_nothing():
    plainly, described = (
        simulation("slip", *options).advance(2e-3, samples=5)
        for options in ([], ["bearing.flanges={inner: none, outer: none, film_friction: 0.3, film: 2 um}"])
    )
    assert plainly.tobytes() == described.tobytes() and (plainly["flange_power"] == 0.0).all()


def test_flanges_on_both_sides_bound_the_skew_by_the_end_clearance():
    """On a ring that is held inclined by 3 mrad rollers skew by more than a close end clearance leaves them between two flanges."""
    inclined, skews = ["operating.misalignment=3 mrad", "bearing.roller.slices=6"], []
    for options in ([], ["bearing.flanges={outer: both, end_clearance: 20 um}"]):
        run = simulation("spatial", *inclined, *options)
        skews.append(np.abs(run.advance(0.03, samples=300)["roller_skew"]).max())
    bound = run._params.flanges.clearance / run._params.flanges.outer.corner
    assert skews[1] < 1.2 * bound < 1.6 * bound < skews[0]


ROUND = ["bearing.outer_raceway.d_value=0 mm", "bearing.outer_raceway.low_radius=34.885 mm"]
UNLOADED = [
    *ROUND,
    "operating.radial_load=0 N",
    "operating.shaft_speed=2000 rpm",
    "bearing.cage.guidance=roller",
    "bearing.cage.outer_radius=33.35 mm",
]
CLOSE = "end_clearance: 8 um"


def slip_without_load(mixture, *options):
    run = simulation("slip", *UNLOADED, f"lubricant.mixture_fraction={mixture}", *options)
    return run.advance(30.0)["cage_slip"][-1], run._params


def test_inner_flanges_let_a_cage_run_ahead_of_rolling_and_outer_ones_brake_it():
    """No load, a cage that its rollers guide, and a mist that brakes them a little; nothing but flanges of the inner ring can drive them."""
    inner, outer = ([f"bearing.flanges={{{ring}: both, {CLOSE}}}"] for ring in ("inner", "outer"))
    slips = [slip_without_load(0.00015, *options)[0] for options in (inner, [], outer)]
    assert slips[0] < -0.05 and 0.0 < slips[1] < slips[2]


def test_flanges_that_nothing_brakes_carry_rollers_at_the_speed_at_which_they_lose_least():
    """Rollers that roll on the outer raceway, w = r omega_c/R_w: there the power A u^2 - 2 S u s + I s^2 of their shear is least."""
    slip_found, params = slip_without_load(0, f"bearing.flanges={{inner: both, {CLOSE}}}")
    face, radius, pitch = params.flanges.inner, params.rollers.radius, params.flanges.pitch_radius
    orbit = params.raceways.low_radius - radius
    ideal = 0.5 * (1.0 - params.raceways.diameter_ratio)

    def lost(slip):
        u, s = orbit * ideal * (1.0 - slip) - pitch, orbit * ideal * (1.0 - slip) / radius + 1.0
        return face.area * u * u - 2.0 * face.first * u * s + face.second * s * s

    assert slip_found == pytest.approx(minimize_scalar(lost, bounds=(-0.5, 0.5), method="bounded").x, abs=1e-3)


def settled(*options):
    scene = load_scene("deng2017_table1", [*ROUND, "lubricant.mixture_fraction=0", *options])
    return scene, solve_points(scene, np.array([[scene.operating.shaft_speed, scene.operating.radial_load, 393.15, 0.0]]))[0]


@pytest.mark.parametrize(
    "axial, message", [(NU, "the inner ring has no flanges"), (N, "the outer ring has no flanges"), ([], "inner ring and the outer")]
)
def test_a_bearing_without_flanges_on_both_rings_refuses_an_axial_load(axial, message):
    with pytest.raises(SceneError, match=f"operating.axial_load: 90 N cannot be carried, because .*{message}"):
        load_scene("deng2017_table1", [*axial, "operating.axial_load=90 N"])


def test_one_flange_carries_one_direction_and_two_carry_both():
    load_scene("deng2017_table1", [*NJ, "operating.axial_load=90 N"])
    with pytest.raises(SceneError, match="pulls the rings apart, because the inner ring has one flange.*give 90 N"):
        load_scene("deng2017_table1", [*NJ, "operating.axial_load=-90 N"])
    options = [*NUP, "operating.radial_load=800 N", "operating.shaft_speed=2000 rpm"]
    one, other = (settled(*options, f"operating.axial_load={load} N")[1] for load in (90, -90))
    np.testing.assert_array_equal(one, other)


def test_an_axial_load_costs_a_moment_in_the_range_of_makers():
    """Harris and Kotzalas 2006, f_f F_a d_m with 0.002 to 0.006 for oil; SKF's 0.16 d_m^0.9 F_a mu_sl; the model's power over the shaft's speed."""
    for speed in (600, 3000):
        options = ["operating.radial_load=3 kN", f"operating.shaft_speed={speed} rpm", "lubricant.mixed_friction=skf"]
        moments = []
        for load in (0, 300):
            scene, answer = settled(*NJ, f"operating.axial_load={load} N", *options)
            moments.append(answer[ANSWER.flange_power] / scene.operating.shaft_speed)
        by_load, mean = 1e3 * (moments[1] - moments[0]) / 300, 1e3 * 0.5 * (scene.bearing.bore_diameter + scene.bearing.outside_diameter)
        assert 0.002 < by_load / mean < 0.012
        weight = math.exp(-2.6e-8 * (speed * 2.37) ** 1.4 * mean)  # SKF's, of an oil of 2.37 mm2/s
        assert 0.3 < by_load / (0.16 * mean**0.9 * (weight * 0.12 + (1 - weight) * 0.02)) < 3.0


def test_estimated_sizes_follow_the_roller():
    bearing = load_scene("deng2017_table1", NUP[:0] + ["bearing.flanges={inner: both, outer: both}"]).bearing
    size = flange_geometry(bearing)
    assert (size.inner_radius - bearing.inner_raceway.radius) == pytest.approx(0.18 * 7e-3)
    assert size.end_clearance == pytest.approx(36e-6) and size.corner_radius == pytest.approx(0.35e-3)


@pytest.mark.parametrize(
    "flanges, message",
    [
        ("{end_clearance: 20 um}", "flanges.end_clearance: neither ring has flanges"),
        ("{outer: both, inner_radius: 29 mm}", "flanges.inner_radius: the inner ring has no flanges"),
        ("{outer: both, outer_diameter: 60 mm}", "flanges.outer_radius: 30 mm puts the flange's edge 4.8625 mm below the outer raceway"),
        ("{outer: both, corner_radius: 3.5 mm}", "flanges.corner_radius: 3.5 mm leaves no end face"),
        ("{outer: both, end_radius: 100 mm}", "flanges.end_radius: 100 mm touches a flange .* expected 256.688 to 360.968"),
        ("{outer: two}", "bearing.flanges.outer = 'two': expected 'none', 'one' or 'both'"),
    ],
)
def test_flanges_that_do_not_fit_are_refused(flanges, message):
    with pytest.raises(SceneError, match=message):
        load_scene("deng2017_table1", [f"bearing.flanges={flanges}"])


def test_a_bearing_by_designation_has_the_flanges_of_its_type_and_gives_them_up_where_the_file_says_so():
    tree = {"name": "x", "lubricant": {"oil": "ISO VG 68"}, "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"}}
    sides = {}
    for kind in ("N", "NU", "NJ", "NUP"):
        bearing = load_scene({**tree, "bearing": f"{kind} 210"}).bearing
        sides[kind] = bearing.flanges.inner, bearing.flanges.outer
        assert "flanges.end_clearance" in {each.field for each in bearing.estimated}
    assert sides == {"N": ("both", "none"), "NU": ("none", "both"), "NJ": ("one", "both"), "NUP": ("both", "both")}
    without = load_scene({**tree, "bearing": {"preset": "NUP 210", "flanges": {"inner": "none", "outer": "none"}}}).bearing
    assert not without.flanges.present and "flanges.end_clearance" not in {each.field for each in without.estimated}
    known = load_scene({**tree, "bearing": {"preset": "NUP 210", "flanges": {"end_clearance": "60 um"}}}).bearing
    assert known.flanges.end_clearance == pytest.approx(60e-6) and "flanges.end_clearance" not in {each.field for each in known.estimated}
