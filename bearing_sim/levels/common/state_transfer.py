# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The state of a level that goes on where another level's sample is.

Cage angle and speed, the rollers' places, orbital speeds and spins, and what tilts, come from the sample, whole.  What a sample does
not tell begins at rest: radial speeds, those of the centres of ring and cage, and of all tilts; contacts damp these within a millisecond.
Spins that a level does not follow (``steady``) begin rolling on the outer raceway.  Where the sample's level has no whirl its cage is in
the centre of what guides it, and begins to whirl as at the start of a run.
"""

import math

import numpy as np

from bearing_sim.levels import planar_algebra, planar_state, spatial_algebra, spatial_state
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT

FIRST_ECCENTRICITY = 0.3  # of the guide clearance; a cage exactly in the centre would have no direction to whirl from


def steady_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``steady`` at a sample; parameters as of `slip_state_at`."""
    work.bearing.ring[:] = sample["ring_y"], sample["ring_z"]
    return np.array([sample["cage_angle"], sample["cage_speed"]])


def slip_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``slip`` at a sample.

    Parameters
    ----------
    params : of the bearing.
    work : the level's workspace; what it remembers of the past starts at the sample's values too.
    sample : of any level, see `bearing_sim.sample`.
    """
    work.ring[:] = sample["ring_y"], sample["ring_z"]
    return np.concatenate([[sample["cage_angle"], sample["cage_speed"]], _spins(params, sample)])


def planar_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``planar`` at a sample; parameters as of `slip_state_at`."""
    at, count = planar_state, params.rollers.count
    state = np.zeros(2 * planar_algebra.BORDER + planar_algebra.BLOCK * count)
    state[at.RING_Y], state[at.RING_Z] = sample["ring_y"], sample["ring_z"]
    state[at.CAGE_Y], state[at.CAGE_Z] = _cage_centre(params, sample)
    state[at.THETA], state[at.OMEGA] = sample["cage_angle"], sample["cage_speed"]
    rollers = state[at.ROLLERS :].reshape(planar_algebra.BLOCK, count)
    rollers[at.R], rollers[at.PHI] = sample["roller_radius"], _roller_angles(sample)
    rollers[at.PHI_SPEED], rollers[at.SPIN] = sample["orbital_speed"], _spins(params, sample)
    _carry_means(work, sample)
    return state


def spatial_state_at(params, work, sample) -> np.ndarray:
    """Return the state of level ``spatial`` at a sample; parameters as of `slip_state_at`."""
    at, count = spatial_state, params.rollers.count
    state = np.zeros(2 * spatial_algebra.BORDER + spatial_algebra.BLOCK * count)
    state[at.RING_Y], state[at.RING_Z] = sample["ring_y"], sample["ring_z"]
    state[at.RING_TILT_Y], state[at.RING_TILT_Z] = sample["ring_tilt_y"], sample["ring_tilt_z"]
    state[at.CAGE_Y], state[at.CAGE_Z] = _cage_centre(params, sample)
    state[at.CAGE_TILT_Y], state[at.CAGE_TILT_Z] = sample["cage_tilt_y"], sample["cage_tilt_z"]
    state[at.THETA], state[at.OMEGA] = sample["cage_angle"], sample["cage_speed"]
    rollers = state[at.ROLLERS :].reshape(spatial_algebra.BLOCK, count)
    rollers[at.R], rollers[at.PHI] = sample["roller_radius"], _roller_angles(sample)
    rollers[at.TILT], rollers[at.SKEW] = sample["roller_tilt"], sample["roller_skew"]
    rollers[at.PHI_SPEED], rollers[at.SPIN] = sample["orbital_speed"], _spins(params, sample)
    _carry_means(work, sample)
    return state


def _spins(params, sample):
    """Return the rollers' spins; those of a level that does not follow them are of rolling on the outer raceway, as the drags let them."""
    rolling = sample["orbital_speed"] * params.raceways.pitch_radius / params.rollers.radius
    return np.where(np.isfinite(sample["roller_spin"]), sample["roller_spin"], rolling)


def _cage_centre(params, sample):
    if math.hypot(sample["cage_y"], sample["cage_z"]) > 0.0:
        return sample["cage_y"], sample["cage_z"]
    turning = params.cage.guidance.turning  # lands of the inner ring are where the ring is
    return turning * sample["ring_y"] + FIRST_ECCENTRICITY * params.cage.guide_clearance, turning * sample["ring_z"]


def _roller_angles(sample):
    """Return the rollers' azimuths counted on with the cage's angle, which a pocket needs; a sample's may have lost whole turns."""
    count = sample["roller_angle"].shape[0]
    pockets = sample["cage_angle"] + 2.0 * math.pi * np.arange(count) / count
    apart = sample["roller_angle"] - pockets
    return pockets + apart - 2.0 * math.pi * np.round(apart / (2.0 * math.pi))


def _carry_means(work, sample):
    """Let the running means of the rollers' loads go on; those of slices begin anew."""
    work.load_means[:] = sample["inner_equivalent_load"] ** ROTATING_EXPONENT, sample["outer_equivalent_load"] ** STATIONARY_EXPONENT
