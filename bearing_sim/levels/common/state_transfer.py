# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the state of a level starts: in ideal rolling, or where the sample of another level is.

From a sample come cage angle and speed, the rollers' positions, orbital speeds and spins, and all tilts.  What a sample does not hold
starts at rest: the radial speeds of rollers and the speeds of ring centre, cage centre and tilts; contacts damp these within a
millisecond.  Spins that a level does not compute (``steady``) start as rolling on the outer raceway.  If the sample's level has no whirl,
its cage is in the centre of what guides it and starts to whirl as at the beginning of a run; if it has no vibration, outer ring and
shaft start where load and springs hold them.
"""

import math

import numpy as np

from bearing_sim.levels.common.model import write_growth
from bearing_sim.levels.common.support import place_support, resume_support, tail_of
from bearing_sim.levels.slip import model as slip
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.forces import balance_loads, pitch_loads
from bearing_sim.model.params import SUPPORT
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.growth import cold_growth
from bearing_sim.physics.lamina_life import MOMENTS, write_lamina_means
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT, OilFactors
from bearing_sim.physics.ring_balance import POINT
from bearing_sim.scene.fidelity import NUMBERS, WHIRLING

_VIBRATING = tuple(NUMBERS[level] for level in WHIRLING)
_FIRST_ECCENTRICITY = 0.3  # of the guide clearance; assumption: a cage exactly in the centre would have no direction to whirl from
FIRST_CAGE_TILT = 1e-6  # rad (assumption); at the lands some 5 nm: far less than a film, far more than round-off


def rolling_state(at, params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling with all rollers in the middle of their pockets and in quasi-static balance, and the inner raceway's growth [m].

    Parameters
    ----------
    at : module of the level's state, of ``planar`` or ``spatial``.
    params : of the bearing.
    work : the level's workspace.
    shaft_speed, load_y, load_z : conditions [rad/s, N].
    """
    count = params.rollers.count
    balance, rolling = slip_state.new_work(params), slip.initial_state(params, None, shaft_speed, load_y, load_z)
    cage_speed = rolling[slip_state.OMEGA]
    write_growth(shaft_speed, cold_growth(params.mounted), balance.growth)  # growth by heat, unknown here, comes with the first step
    balance_loads(0.0, cage_speed, load_y, load_z, params, balance)
    state, rollers = _new_state(at, params)
    own_y, own_z = (0.0, 0.0) if balance.bending is None else balance.bending.points[POINT.force, -2:]  # of the outer ring in its housing
    state[at.RING_Y], state[at.RING_Z] = balance.ring + (own_y, own_z)
    state[at.OMEGA] = cage_speed
    rollers[at.R] = balance.loads[LOAD.radius] + own_y * balance.loads[LOAD.cosine] + own_z * balance.loads[LOAD.sine]
    rollers[at.PHI] = 2.0 * math.pi * np.arange(count) / count
    rollers[at.PHI_SPEED] = cage_speed
    rollers[at.SPIN] = rolling[slip_state.SPIN :]
    return state, balance.growth[0]


def start_means(model, work, cage_speed, sample=None):
    """Let the running means of the loads start in quasi-static balance, without its vibration.

    Parameters
    ----------
    model : of the level; its drive has the conditions.
    work : the level's workspace, changed.
    cage_speed : [rad/s].
    sample : scales the means so that the equivalent loads are those of this sample; as they are where absent.
    """
    params, drive, balance = model.params, model.drive, slip_state.new_work(model.params)
    write_growth(drive.shaft_speed, model.lubrication.growth, balance.growth)
    equivalent = pitch_loads(0.0, cage_speed, drive.load_y, drive.load_z, OilFactors(1.0, 1.0), params, balance)
    moments, laminae = balance.load_moments, np.zeros((2, len(params.life.laminae.positions)))
    write_lamina_means(moments, params.life.laminae, *laminae)
    if sample is not None:
        _scale(moments, laminae, equivalent, sample)
    work.load_moments[:] = work.last_moments[:] = moments
    if hasattr(work, "lamina_powers"):
        work.lamina_powers[:] = work.lamina_last[:] = laminae[:, :, None] / LANES


def _scale(moments, laminae, equivalent, sample):
    """Scale moments and means of laminae so that the equivalent loads are those of a sample."""
    wanted = [float(sample[f"{ring}_{kind}_load"]) for kind in ("equivalent", "lamina") for ring in ("inner", "outer")]
    for ring, exponent in enumerate((ROTATING_EXPONENT, STATIONARY_EXPONENT)):
        if equivalent[ring] > 0.0 and wanted[ring] > 0.0:
            moments[ring] *= (wanted[ring] / equivalent[ring]) ** (exponent + np.arange(MOMENTS))
        if equivalent[2 + ring] > 0.0 and wanted[2 + ring] > 0.0:
            laminae[ring] *= (wanted[2 + ring] / equivalent[2 + ring]) ** exponent


def first_cage_centre(params, ring_y, ring_z):
    """Return y, z [m] of a cage that starts to whirl, given the ring's centre: lands of the inner ring are where the ring is."""
    turning = params.cage.guidance.turning
    return turning * ring_y + _FIRST_ECCENTRICITY * params.cage.guide_clearance, turning * ring_z


def steady_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``steady`` at a sample; parameters as of `slip_state_at`."""
    work.bearing.ring[:] = sample["ring_y"], sample["ring_z"]
    return np.array([sample["cage_angle"], sample["cage_speed"], sample["cage_speed"]])


def slip_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``slip`` at a sample.

    Parameters
    ----------
    params : of the bearing.
    work : the level's workspace; what it remembers of the past starts at the sample's values too.
    sample : of any level, see `bearing_sim.model.sample`.
    """
    work.ring[:] = sample["ring_y"], sample["ring_z"]
    return np.concatenate([[sample["cage_angle"], sample["cage_speed"]], _spins(params, sample)])


def planar_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``planar`` at a sample; parameters as of `slip_state_at`."""
    from bearing_sim.levels.planar import state as planar

    return _dynamic_state_at(planar, params, work, sample)[0]


def spatial_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``spatial`` at a sample; parameters as of `slip_state_at`."""
    from bearing_sim.levels.spatial import state as at

    state, rollers = _dynamic_state_at(at, params, work, sample)
    state[at.RING_TILT_Y], state[at.RING_TILT_Z] = sample["ring_tilt_y"], sample["ring_tilt_z"]
    tilted = sample["cage_tilt_y"] != 0.0 or sample["cage_tilt_z"] != 0.0
    state[at.CAGE_TILT_Y], state[at.CAGE_TILT_Z] = (sample["cage_tilt_y"], sample["cage_tilt_z"]) if tilted else (FIRST_CAGE_TILT, 0.0)
    rollers[at.TILT], rollers[at.SKEW] = sample["roller_tilt"], sample["roller_skew"]
    return state


def _dynamic_state_at(at, params, work, sample):
    """Return a state without tilts and its part of the rollers, shape (BLOCK, Z); ``at`` as of `rolling_state`."""
    state, rollers = _new_state(at, params)
    in_seat = _place_in_seat(params, sample)
    ring = sample["ring_y"] + in_seat[0], sample["ring_z"] + in_seat[1]
    state[at.RING_Y], state[at.RING_Z] = ring
    whirls = math.hypot(sample["cage_y"], sample["cage_z"]) > 0.0
    centre = (sample["cage_y"], sample["cage_z"]) if whirls else first_cage_centre(params, *ring)
    state[at.CAGE_Y], state[at.CAGE_Z] = centre
    state[at.THETA], state[at.OMEGA] = sample["cage_angle"], sample["cage_speed"]
    along = in_seat[0] * np.cos(sample["roller_angle"]) + in_seat[1] * np.sin(sample["roller_angle"])
    rollers[at.R], rollers[at.PHI] = sample["roller_radius"] + along, _roller_angles(sample)
    rollers[at.PHI_SPEED], rollers[at.SPIN] = sample["orbital_speed"], _spins(params, sample)
    if sample["level"] in _VIBRATING:
        resume_support(params, state, sample)
    else:
        place_support(params, state, ring, (sample["load_y"], sample["load_z"]))
    return state, rollers


def _place_in_seat(params, sample):
    """Return where an outer ring that bends is in its housing by a sample, y, z [m]; on a support that moves both it is not known, and taken as 0."""
    if params.outer_ring is None or params.support[SUPPORT.outer_moves] or not np.isfinite(sample["outer_ring_y"]):
        return 0.0, 0.0
    return sample["outer_ring_y"], sample["outer_ring_z"]


def _new_state(at, params):
    """Return a zeroed state of a level with the tail of its support, and its part of the rollers, shape (BLOCK, Z)."""
    rollers, count = 2 * at.BORDER, params.rollers.count
    state = np.zeros(rollers + at.BLOCK * count + tail_of(params.support))
    return state, state[rollers : rollers + at.BLOCK * count].reshape(at.BLOCK, count)


def _spins(params, sample):
    """Return the rollers' spins; those of a level that does not compute them are of rolling on the outer raceway."""
    rolling = sample["orbital_speed"] * params.raceways.pitch_radius / params.rollers.radius
    return np.where(np.isfinite(sample["roller_spin"]), sample["roller_spin"], rolling)


def _roller_angles(sample):
    """Return the rollers' azimuths with the whole turns of the cage's angle, which a pocket needs; those of a sample may lack them."""
    count = sample["roller_angle"].shape[0]
    pockets = sample["cage_angle"] + 2.0 * math.pi * np.arange(count) / count
    apart = sample["roller_angle"] - pockets
    return pockets + apart - 2.0 * math.pi * np.round(apart / (2.0 * math.pi))
