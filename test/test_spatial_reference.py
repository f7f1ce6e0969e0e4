# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The spatial level against a plain NumPy model: its forces, its derivatives, its energy."""

import math
from functools import partial

import numpy as np
import pytest
from cold_scenes import OTHERWISE, SCENES
from complex_step import assert_blocks_agree, complex_step_jacobian
from dense_arrow import dense_arrow
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_planar import Reference
from reference_spatial import SpatialReference, State
from scipy.integrate import solve_ivp
from test_planar_reference import GROWN, TIGHTER
from test_power import HOUSED

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial.power import spatial_powers
from bearing_sim.levels.spatial.state import BLOCK, BORDER, LAYOUT
from bearing_sim.physics.ring_balance import POINT, ROLLER

BORDER_STATES = 2 * BORDER
CROWN = np.array([3e-6, 1e-6, 0.0, 0.0, 1e-6, 3e-6])


def simulation(*overrides, crown=None):
    run = Simulation(load_scene("deng2017_table1", ["level=spatial", "bearing.roller.slices=6", *overrides]))
    if crown is not None:
        run._params.slices.crown[:] = crown
    return run


def by_roller(state):
    """View of the rollers' part of a state vector: rows r, phi, tilt, skew, their rates, w, shape (9, Z)."""
    return state[BORDER_STATES:].reshape(BLOCK, -1)


def frame(phi):
    return np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])


def plain(state):
    """The state vector as the reference's record."""
    radius, phi, tilt, skew, radius_speed, phi_speed, tilting, skewing, spin = by_roller(state)
    outward, along = frame(phi)
    q, v = state[:BORDER], state[BORDER:BORDER_STATES]
    velocity = radius_speed * outward + radius * phi_speed * along
    leaning = (tilting - phi_speed * skew) * outward + (skewing + phi_speed * tilt) * along
    lean = tilt * outward + skew * along
    return State(
        q[0:2], v[0:2], q[2:4], v[2:4], q[4:6], v[4:6], q[6:8], v[6:8], q[8], v[8], radius * outward, velocity, lean, leaning, spin.copy()
    )  # fmt: skip


def rate_of(reference, state, forces=None):
    """dy/dt of the state vector by the reference: Cartesian accelerations in each roller's own frame."""
    radius, phi, tilt, skew, radius_speed, phi_speed, tilting, skewing, _ = by_roller(state)
    ring, ring_lean, cage, cage_lean, turning, rollers, leans, spin = reference.accelerations(forces or reference.forces(plain(state)))
    outward, along = frame(phi)
    rate = np.zeros_like(state)
    rate[:BORDER] = state[BORDER:BORDER_STATES]
    rate[BORDER:BORDER_STATES] = np.concatenate([ring, ring_lean, cage, cage_lean, [turning]])
    angular = ((rollers * along).sum(0) - 2 * radius_speed * phi_speed) / radius
    by_roller(rate)[:] = (
        radius_speed,
        phi_speed,
        tilting,
        skewing,
        (rollers * outward).sum(0) + radius * phi_speed**2,
        angular,
        (leans * outward).sum(0) + 2 * phi_speed * skewing + angular * skew + phi_speed**2 * tilt,
        (leans * along).sum(0) - 2 * phi_speed * tilting - angular * tilt + phi_speed**2 * skew,
        spin,
    )
    return rate


def rough_state(run, seed, scale=1.0):
    """Rollers pressed, parted and colliding, tilted and skewed, some against a pocket's wall, and the cage anywhere up to its land."""
    random = np.random.default_rng(seed)
    state = run._state.copy()
    eccentricity, azimuth = random.choice([random.uniform(0.0, 0.145e-3), 0.1485e-3]), random.uniform(0.0, 2 * math.pi)
    state[0:2] += random.normal(size=2) * 3e-6
    state[2:4] += random.normal(size=2) * 5e-4
    turning = run._params.cage.guidance.turning
    state[4:6] = turning * state[0:2] + eccentricity * np.array([math.cos(azimuth), math.sin(azimuth)])
    state[6:8] = turning * state[2:4] + random.normal(size=2) * 1e-3
    state[8] = random.uniform(-10.0, 10.0)
    state[9:13] += random.normal(size=4) * [2e-2, 2e-2, 2.0, 2.0]
    state[13:17] += random.normal(size=4) * [2e-2, 2e-2, 2.0, 2.0]
    if run._params.tilts.ring_free == 0.0:
        state[11:13] = 0.0
    slowed = random.uniform(0.6, 1.05)
    state[17] *= slowed
    rollers = by_roller(state)
    rollers[1] += state[8]
    rollers[5] *= slowed
    rough = np.array([2e-6, 3e-3, 5e-4, 2e-3, 2e-2, 0.5, 5.0, 5.0, 200.0])
    rollers += random.normal(size=rollers.shape) * rough[:, None] * scale
    return state


def kinds(count):
    """Which entries of a state vector are of one kind."""
    which = np.zeros(BORDER_STATES + BLOCK * count, int)
    which[:BORDER_STATES] = 0, 0, 1, 1, 2, 2, 3, 3, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9
    by_roller(which)[:] = np.arange(10, 19)[:, None]
    return which


MOMENT = ["operating.moment=2", "operating.moment_angle=30 deg"]
INNER = ["bearing.cage.guidance=inner_ring", "bearing.cage.outer_radius=33.35 mm"]
ROLLER_GUIDED = ["bearing.cage.guidance=roller", "bearing.cage.outer_radius=33.35 mm"]
VARIANTS = {
    "guided on the free inner ring": (
        lambda: SpatialReference(Reference(guidance="inner_ring"), moment=(2 * math.cos(math.pi / 6), 1.0)),
        [*INNER, *MOMENT],
        None,
    ),
    "guided on the held inner ring": (
        lambda: SpatialReference(Reference(guidance="inner_ring"), ring_free=False),
        [*INNER, "operating.misalignment=1 mrad"],
        None,
    ),
    "guided by rollers": (
        lambda: SpatialReference(Reference(guidance="roller", pocket_radial_clearance=0.06e-3), moment=(2 * math.cos(math.pi / 6), 1.0)),
        [*ROLLER_GUIDED, "bearing.cage.pocket_radial_clearance=0.06 mm", *MOMENT],
        None,
    ),
    "free ring": (lambda: SpatialReference(moment=(2 * math.cos(math.pi / 6), 1.0)), MOMENT, None),
    "held ring, crown, Deng's axes": (
        lambda: SpatialReference(Reference(contour_slope=False), ring_free=False, gyroscopic=False, crown=CROWN),
        [
            "operating.misalignment=1 mrad",
            "dynamics.gyroscopic=false",
            "bearing.outer_raceway.contour_slope=false",
        ],
        CROWN,
    ),
    "rolling resistance, and a raceway that grows": (
        lambda: SpatialReference(
            Reference(rolling_resistance=True, growth=GROWN, guide_clearance=TIGHTER), moment=(2 * math.cos(math.pi / 6), 1.0), crown=CROWN
        ),
        [*MOMENT, "lubricant.rolling_resistance=hydrodynamic", "bearing.dimensions_at=cold"],
        CROWN,
    ),
    "nine rollers backwards, crown": (
        lambda: SpatialReference(
            Reference(rollers=9, contact_damping=1.0, shaft_speed=-1500.0), crown=CROWN, moment=(2 * math.cos(math.pi / 6), 1.0)
        ),
        ["bearing.roller.count=9", "bearing.contact.damping=1", "operating.shaft_speed=-1500 rad/s", *MOMENT],
        CROWN,
    ),
}


def pair(variant, **changes):
    """A run of a variant, or of a scene with starved inlets, asperities and vortices, and its plain model with some fields changed."""
    if variant in VARIANTS:
        new_reference, overrides, crown = VARIANTS[variant]
        return simulation(*overrides, crown=crown), new_reference()
    cold = SCENES[variant]
    run = Simulation(cold.scene("spatial", "bearing.roller.slices=6", *MOMENT))
    run._params.slices.crown[:] = CROWN
    ring_mass = run.scene.bearing.inner_raceway.ring_mass + 0.5  # of the shaft
    plane = Reference(load=(cold.load, 0.0), ring_mass=ring_mass, **cold.fields(changes))
    return run, SpatialReference(plane, moment=(2 * math.cos(math.pi / 6), 1.0), crown=CROWN)


def largest_errors(run, reference, state):
    """Largest difference of each kind of rate from the plain model's, over the largest rate of that kind."""
    rate, which = np.zeros_like(state), kinds(reference.planar.rollers)
    assert spatial.rhs(0.0, state, run._model(run.inputs, 1.0), run._work, rate)
    forces = reference.forces(plain(state))
    expected, pocket, half = rate_of(reference, state, forces), np.abs(forces.pocket_whole).max(), reference.planar.length / 2
    # what ring and cage feel is a sum over rollers: its terms, not what is left of them, say what round-off may be
    pressed = forces.inner.sum(1).max()
    terms = {5: pressed / reference.planar.ring_mass, 6: pressed * half / reference.ring_polar}
    terms |= {7: pocket / reference.planar.cage_mass, 8: pocket * half / reference.cage_transverse}
    terms |= {9: pocket * reference.planar.pitch_radius / reference.planar.cage_inertia}
    largest = np.array([max(np.abs(expected[which == kind]).max(), terms.get(kind, 0.0)) for kind in range(19)])
    return np.array([np.abs(rate - expected)[which == kind].max() for kind in range(19)]) / np.maximum(largest, 1e-300)


@pytest.mark.parametrize("variant", [*VARIANTS, *SCENES])
def test_right_hand_side_is_that_of_the_plain_numpy_model(variant):
    run, reference = pair(variant)

    @settings(max_examples=40, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.sampled_from([0.03, 0.3, 1.0]))
    def follows(seed, scale):
        errors = largest_errors(run, reference, rough_state(run, seed, scale))
        assert errors.max() <= 1e-9, errors

    follows()


@pytest.mark.parametrize("part", OTHERWISE)
def test_the_plain_numpy_model_tells_what_films_and_asperities_do(part):
    variant, changes = OTHERWISE[part]
    run, reference = pair(variant, **changes)
    assert max(largest_errors(run, reference, rough_state(run, seed, 0.3)).max() for seed in range(3)) > 1e-5


def dense_jacobian(run, state):
    model, work, rate = run._model(run.inputs, 1.0), run._work, np.zeros_like(state)
    spatial.KERNELS.rhs_and_jacobian(0.0, state, model, work, rate)
    return dense_arrow(LAYOUT, work, run._params.rollers.count)


@pytest.mark.parametrize("variant", [*VARIANTS, *SCENES])
@pytest.mark.parametrize("seed", range(3))
def test_jacobian_is_that_of_a_complex_step_through_the_plain_numpy_model(variant, seed):
    run, reference = pair(variant)
    state = rough_state(run, seed, 0.3)
    found, expected = dense_jacobian(run, state), complex_step_jacobian(partial(rate_of, reference), state)
    assert_blocks_agree(found, expected, kinds(run._params.rollers.count))


def test_block_arrow_solution_is_that_of_the_dense_matrix():
    run = simulation(*MOMENT)
    state, shift = rough_state(run, 1, 0.3), 2e-5
    matrix = np.eye(state.size) - shift * dense_jacobian(run, state)
    right = np.random.default_rng(2).normal(size=state.size)
    x = right.copy()
    assert spatial.KERNELS.factor(shift, run._work)
    spatial.KERNELS.solve(run._work, x)
    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("variant", [*VARIANTS, *SCENES])
def test_powers_are_those_of_the_plain_numpy_model(variant):
    run, reference = pair(variant)
    for seed in range(3):
        run._begin(rough_state(run, seed, 0.3), np.array([run.sample]), float(run.sample["cage_speed"]))
        model = run._model(run.inputs, 1.0)
        spatial.rhs(0.0, run._state, model, run._work, np.zeros_like(run._state))
        powers = spatial_powers(0.0, run._state, run.inputs.shaft_speed, model, run._work)
        work, heat = reference.powers(reference.forces(plain(run._state)))
        expected = {
            "inner_sliding_power": heat["inner traction"],
            "outer_sliding_power": heat["outer traction"],
            "inner_rolling_power": heat["inner rolling"],
            "outer_rolling_power": heat["outer rolling"],
            "churning_power": heat["churning"],
            "windage_power": heat["mixture on the cage"],
        }
        found = run.sample
        assert powers.shaft == pytest.approx(work["shaft"], rel=1e-9)
        for name, power in expected.items():
            assert found[name] == pytest.approx(power, rel=1e-9), name
        lost = sum(found[name] for name in ("land_power", "pocket_power", "damping_power"))
        rest = sum(heat[name] for name in ("guide land film", "guide land contact", "pocket damping", "pocket friction", "normal damping"))
        assert lost == pytest.approx(rest, rel=1e-9)


@pytest.mark.parametrize("crown", [None, CROWN])
def test_energy_is_kept(crown):
    """An explicit method of order 8 through a run under a moment: work less heat is the gain, to the method's accuracy."""
    reference, run, duration = SpatialReference(moment=(2 * math.cos(math.pi / 6), 1.0), crown=crown), simulation(*MOMENT, crown=crown), 3e-5
    run.advance(5e-3)
    state = run._state.copy()
    by_roller(state)[3] += np.linspace(-1e-2, 1e-2, 18)  # and rollers skewed against their pockets
    size = state.size

    def rate(t, y):
        forces = reference.forces(plain(y[:size]))
        work, heat = reference.powers(forces)
        return np.concatenate([rate_of(reference, y[:size], forces), list(work.values()), list(heat.values())])

    absolute = np.full(size + 14, 1e-12)
    absolute[BORDER_STATES + 8 * 18 : size] = 1e-6
    absolute[BORDER_STATES + 4 * 18 : BORDER_STATES + 8 * 18] = 1e-9
    with np.errstate(all="ignore"):
        solution = solve_ivp(rate, (0.0, duration), np.concatenate([state, np.zeros(14)]), "DOP853", rtol=1e-9, atol=absolute, first_step=1e-8)
    end = solution.y[:, -1]
    work, heat = end[size : size + 3].sum(), end[size + 3 :]
    before, after = (reference.forces(plain(y)) for y in (state, end[:size]))
    gained = reference.energy(after) - reference.energy(before)
    assert work - heat.sum() - gained == pytest.approx(0.0, abs=1e-8 * (abs(work) + np.abs(heat).sum()))


class BentRing:
    """A run of level ``spatial`` whose outer ring bends in aluminium, its plain model at a rough state, and what the ring does there."""

    def __init__(self, play, seed, *overrides, crown=CROWN):
        backing = f"mounting.housing.backing={{law: elastic, massive: true, play: {play} um}}"
        self.run = simulation(*HOUSED, backing, *MOMENT, *overrides, crown=crown)
        self.state, self.crown, self.play = rough_state(self.run, seed, 0.3), crown, 1e-6 * play
        self.count = self.run._params.rollers.count

    def rate(self, state):
        """dy/dt; what rollers off the middles of their pockets meet follows from the evaluation before."""
        rate = np.zeros_like(state)
        for _ in range(4):
            assert spatial.rhs(0.0, state, self.run._model(self.run.inputs, 1.0), self.run._work, rate)
        return rate

    def plain(self, state):
        """The plain model of the ring that `rate` has found, and its forces."""
        rows = self.run._work.bending.rollers
        ahead = by_roller(state)[1] - state[BORDER - 1] - 2 * math.pi * np.arange(self.count) / self.count
        cage, orbits = state[BORDER_STATES - 1], by_roller(state)[5]
        slope, gone = rows[ROLLER.slope].copy(), rows[ROLLER.moved] + rows[ROLLER.slope] * ahead
        bent = gone, slope, rows[ROLLER.rate] + slope * (orbits - cage)
        reference = SpatialReference(moment=(2 * math.cos(math.pi / 6), 1.0), crown=self.crown, bent=bent)
        return reference, reference.forces(plain(state))

    def energy(self, state):
        """Kinetic and elastic energy [J]; that of ring and housing is half of all forces times their ways."""
        self.rate(state)
        reference, forces = self.plain(state)
        bending = self.run._work.bending
        seat = bending.points[POINT.force, :-2]
        return reference.energy(forces) + 0.5 * (bending.rollers[ROLLER.force] @ bending.rollers[ROLLER.moved] - self.play * seat.sum())


BENT = pytest.mark.parametrize(("play", "seed"), [(0.0, 0), (0.0, 1), (3.0, 2), (40.0, 3), (-5.0, 4)])


@pytest.mark.long
@BENT
def test_a_ring_that_bends_presses_the_plain_model_as_a_contour_that_moves(play, seed):
    ring = BentRing(play, seed)
    rate = ring.rate(ring.state)
    reference, forces = ring.plain(ring.state)
    expected, which = rate_of(reference, ring.state, forces), kinds(ring.count)
    for kind in range(19):
        # of sums, what their terms are; the ring is found to 1 mN, a millionth of these forces
        scale = max(np.abs(expected[which == kind]).max(), forces.inner.sum(1).max() / reference.planar.ring_mass if kind in (5, 6) else 0.0)
        assert np.abs(rate - expected)[which == kind].max() <= 1e-4 * scale, kind


@pytest.mark.long
@BENT
def test_the_ring_that_bends_follows_the_plain_forces_of_all_slices(play, seed):
    ring = BentRing(play, seed)
    ring.rate(ring.state)
    elastic, bending = ring.run._params.outer_ring, ring.run._work.bending
    pressed, seat = ring.plain(ring.state)[1].outer_elastic.sum(1), bending.points[POINT.force, :-2]
    points, theta = len(seat), ring.state[BORDER - 1]
    per_pitch, at = points // ring.count, theta + 2 * math.pi * np.arange(points) / points
    rollers, each = at[::per_pitch], np.arange(points)
    x = bending.points[POINT.force, -2:]
    by_rollers = elastic.between[np.abs(each[:, None] - per_pitch * np.arange(ring.count))] @ pressed
    deflection = by_rollers - elastic.between[np.abs(each[:, None] - each)] @ seat
    moved = deflection + x[0] * np.cos(at) + x[1] * np.sin(at)
    largest = np.abs(moved).max()
    shrunk = max(-ring.play, 0.0) * elastic.shrunk / elastic.pressed  # is in the mean growth
    assert np.abs(moved[::per_pitch] + shrunk - bending.rollers[ROLLER.moved]).max() <= 1e-4 * largest
    waves = 1j * np.arange(points // 2 + 1) * np.fft.rfft(moved)
    waves[-1] *= points % 2  # the finest wave has one phase, and no slope where its crests are
    slopes = np.fft.irfft(waves, points)[::per_pitch]
    assert np.abs(slopes - bending.rollers[ROLLER.slope]).max() <= 1e-4 * np.abs(slopes).max()
    yielding = (elastic.seat[np.abs(each[:, None] - each)] - elastic.between[np.abs(each[:, None] - each)]) @ seat
    wave = np.exp(1j * at)
    gap = ring.play + yielding + elastic.radial * np.real(np.conj(wave) * (seat @ wave)) - moved  # the seat stays where it is
    pushed, held = pressed @ np.exp(1j * rollers), seat @ wave
    assert abs(pushed - held) <= 1e-4 * pressed.sum()
    assert (seat >= 0.0).all() and (gap >= -1e-4 * largest).all()
    assert np.abs(gap[seat > 0.0]).max(initial=0.0) <= 1e-4 * largest


@pytest.mark.long
@pytest.mark.parametrize("crown", [CROWN, None])
@BENT
def test_the_speed_of_a_ring_that_bends_is_that_of_where_it_is(play, seed, crown):
    ring = BentRing(play, seed, crown=crown)
    by_roller(ring.state)[1] = ring.state[BORDER - 1] + 2 * math.pi * np.arange(ring.count) / ring.count
    rate = ring.rate(ring.state)
    rows = ring.run._work.bending.rollers
    told, pressed, step = rows[ROLLER.rate].copy(), rows[ROLLER.force] > 10.0, 1e-7

    def moved(time):
        ring.rate(ring.state + time * rate)
        return rows[ROLLER.moved].copy()

    found = (moved(step) - moved(-step)) / (2 * step)
    assert np.abs(found - told)[pressed].max() <= 1e-3 * np.abs(found[pressed]).max()


@pytest.mark.long
@BENT
def test_a_ring_that_bends_keeps_the_books_of_level_spatial(play, seed):
    ring = BentRing(play, seed)
    # as the ring sees them: in the middles of their pockets
    by_roller(ring.state)[1] = ring.state[BORDER - 1] + 2 * math.pi * np.arange(ring.count) / ring.count
    rate = ring.rate(ring.state)
    reference, forces = ring.plain(ring.state)
    model, work = ring.run._model(ring.run.inputs, 1.0), ring.run._work
    powers = spatial_powers(0.0, ring.state, ring.run.inputs.shaft_speed, model, work)
    given, _ = reference.powers(forces)

    def difference(h):
        return (ring.energy(ring.state + h * rate) - ring.energy(ring.state - h * rate)) / (2 * h)

    stored = (4 * difference(2e-9) - difference(4e-9)) / 3
    gap = sum(given.values()) - sum(powers[1:]) - stored
    # the seat has points, which turn with the cage: forces between them push a little along the orbit
    rows = work.bending.rollers
    assert abs(gap + rows[ROLLER.force] @ rows[ROLLER.slope] * ring.state[BORDER_STATES - 1]) < 1e-3 * max(*powers, abs(stored))


@pytest.mark.long
@BENT
def test_the_jacobian_of_a_roller_is_that_of_a_ring_that_gives_way(play, seed):
    ring = BentRing(play, seed, "bearing.contact.damping=0")
    ring.rate(ring.state)
    found, step = dense_jacobian(ring.run, ring.state), {0: 1e-10, 2: 1e-8}
    for j in range(ring.count):
        rows = [BORDER_STATES + k * ring.count + j for k in (4, 6)]
        if ring.run._work.bending.rollers[ROLLER.force, j] < 10.0:
            continue  # no contact, or one that the ring's own accuracy hardly tells from none
        for variable, h in step.items():
            column = BORDER_STATES + variable * ring.count + j
            states = [ring.state.copy() for _ in range(2)]
            states[0][column] += h
            states[1][column] -= h
            ahead, behind = (ring.rate(state)[rows] for state in states)
            expected = (ahead - behind) / (2 * h)
            assert found[rows, column] == pytest.approx(expected, abs=0.2 * np.abs(expected).max()), (
                j,
                variable,
            )  # others are taken for a little stiffer


@pytest.mark.parametrize("variant", VARIANTS)
def test_pressures_are_those_of_hertz_under_laminae_of_the_plain_numpy_model(variant):
    new_reference, overrides, crown = VARIANTS[variant]
    reference, run = new_reference(), simulation("life.laminae=6", *overrides, crown=crown)
    life = run._params.life  # its laminae are shared by all bearings with such rollers
    run._params = run._params._replace(life=life._replace(laminae=life.laminae._replace(crown=np.zeros(6) if crown is None else crown)))
    run._begin(rough_state(run, 4, 0.3), np.array([run.sample]), float(run.sample["cage_speed"]))
    forces, plane = reference.forces(plain(run._state)), reference.planar
    for ring, curvature in (("inner", 1 / plane.roller_radius + 1 / plane.inner_radius), ("outer", 1 / plane.roller_radius - 1 / plane.low_radius)):
        pressure = np.sqrt(getattr(forces, ring) * reference.slices / plane.length * plane.modulus * curvature / (2 * np.pi))
        assert run.sample[f"{ring}_pressure"] == pytest.approx(pressure.max(), rel=1e-9)
        assert run.sample[f"{ring}_edge_pressure"] == pytest.approx(pressure[:, [0, -1]].max(), rel=1e-9)
