# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rollers cut into laminae for the reference rating life L10r of ISO/TS 16281:2008: lamina loads, stress risers, dynamic equivalent loads.

L10r = [sum over k of (q_kei/q_kci)^(9/2) + (q_kee/q_kce)^(9/2)]^(-8/9) million revolutions, with q_kc = Q_c N^(-7/9) and the power means q_ke
over the rollers of the lamina loads times the stress risers f_k.  The modified reference rating life takes a_ISO lamina by lamina,

    L_nmr = a_1 {sum over k of a_ISO,k^(-9/8) [(q_kei/q_kci)^(9/2) + (q_kee/q_kce)^(9/2)]}^(-8/9),

each at the load P_sk that would give a bearing of such laminae its life,
P_sk = 0.323 Z N {[q_kei^(9/2) + (1.038 q_kee Q_ci/Q_ce)^(9/2)]/[1 + (1.038 Q_ci/Q_ce)^(9/2)]}^(2/9) (ISO 16281:2025, formulas 31 and 33).

**Both rings as one load each.**  An inner raceway with the *equivalent roller load by laminae*

    Q_ei = N^(7/9) [sum over k of q_kei^(9/2)]^(2/9),

and the outer raceway likewise, makes L10r = [(Q_ei/Q_ci)^(9/2) + (Q_ee/Q_ce)^(9/2)]^(-8/9), the form of whole rollers: laminae that carry equal
loads without stress risers have the equivalent load of the whole roller.

**Levels without slices.**  An aligned roller's lamina loads follow from its load and its profile: q_k = K/N (delta - C_k)^(10/9), sum q_k = Q.
How a load is shared by the laminae changes slowly with it, so that the mean over rollers and time of (f_k q_k)^p, a mean of
Q^p (f_k q_k/Q)^p, is taken at two loads: those of the Gauss quadrature with weight Q^p, which running means of Q^p, Q^(p + 1), Q^(p + 2) and
Q^(p + 3) give.  It is exact where (f_k q_k/Q)^p is a cubic polynomial of the load.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.elementary import ninth_root
from bearing_sim.physics.contact import EXPONENT, TINY
from bearing_sim.physics.rating_life import LARGEST_MODIFICATION, ROTATING_EXPONENT, STATIONARY_EXPONENT, modification_factor

MOMENTS = 4  # of roller loads, per ring
_POINTS = 1024  # of the table of penetrations; interpolated shares of a load err by less than 1e-5
_LEAST_LOAD, _LARGEST_LOAD = 1e-6, 1e2  # its range, in load ratings of a roller; shares change no more below
_ALIKE = 1e-12  # m; halves of a profile that differ by less are taken as equal
_SPREAD = 1e-9  # square of the relative spread of loads that are taken as equal


class EquivalentLoads(NamedTuple):
    """Dynamic equivalent roller loads of both rings [N], of whole rollers and by laminae with stress risers."""

    inner: float
    outer: float
    inner_lamina: float
    outer_lamina: float
    reference_modification_factor: float  # a_ISO of all laminae together, L_nmr/(a_1 L10r)


class Laminae(NamedTuple):
    """The laminae into which a roller is cut for its life."""

    positions: np.ndarray  # of their middles from the roller's [m], shape (N,)
    crown: np.ndarray  # drop of the profile there below its highest lamina, C_k [m], shape (N,)
    highest: float  # drop of that lamina [m]
    risers: np.ndarray  # stress risers f_k, shape (N,)
    mirrored: bool  # whether both halves of the profile are alike
    penetrations: np.ndarray  # ln delta of an aligned roller's contact, at loads in equal steps of ln Q, shape (M,)
    log_least: float  # ln Q of the first
    per_log: float  # steps per unit of ln Q
    stiffness: float  # of a lamina, K/N [N/m^(10/9)]
    outer_weight: float  # (1.038 Q_ci/Q_ce)^(9/2)
    load_factor: float  # P_sk over [q_kei^(9/2) + outer_weight q_kee^(9/2)]^(2/9)


def stress_risers(laminae):
    """Return f_k = 1 - 0.01/ln(1.985 |(2 k - N - 1)/(2 N - 2)|) of each lamina (ISO/TS 16281, 5.3.3), shape (N,).

    They raise the load of the outer laminae for the stress concentration at the edges; the middle one of an odd number has 1.

    Parameters
    ----------
    laminae : their number N, at least 2.
    """
    position = np.abs(2.0 * np.arange(1, laminae + 1) - laminae - 1.0) / (2.0 * laminae - 2.0)
    with np.errstate(divide="ignore"):
        return 1.0 - 0.01 / np.log(1.985 * position)


def new_laminae(positions, crown, stiffness, inner_rating, outer_rating, rollers) -> Laminae:
    """Return the laminae of a roller.

    Parameters
    ----------
    positions, crown : of their middles, and the profile's drop there [m], shape (N,).
    stiffness : K of the whole contact [N/m^(10/9)].
    inner_rating, outer_rating : load ratings of a roller, Q_ci and Q_ce [N]; the inner one gives the range of loads too.
    rollers : their number, Z.
    """
    rating, outer_weight = inner_rating, (1.038 * inner_rating / outer_rating) ** 4.5
    count, highest = len(crown), float(crown.min())
    log_loads = np.linspace(math.log(_LEAST_LOAD * rating), math.log(_LARGEST_LOAD * rating), _POINTS)
    # the load of a grid of penetrations, as dense as needed to invert it
    deepest = (_LARGEST_LOAD * rating / stiffness) ** (1.0 / EXPONENT) + float(crown.max()) - highest
    shallowest = 1e-2 * (_LEAST_LOAD * rating / stiffness) ** (1.0 / EXPONENT)
    depths = np.geomspace(shallowest, deepest, 8 * _POINTS)
    drops, laminae = np.unique(crown - highest, return_counts=True)  # both halves of a profile are usually alike
    carried = stiffness / count * (np.maximum(depths[:, None] - drops, 0.0) ** EXPONENT @ laminae)
    penetrations = np.interp(log_loads, np.log(carried), np.log(depths))
    return Laminae(
        positions=np.ascontiguousarray(positions, np.float64),
        crown=np.ascontiguousarray(crown - highest, np.float64),
        highest=highest,
        risers=stress_risers(count),
        mirrored=bool(np.abs(crown - crown[::-1]).max() <= _ALIKE),
        penetrations=penetrations,
        log_least=float(log_loads[0]),
        per_log=float((_POINTS - 1) / (log_loads[-1] - log_loads[0])),
        stiffness=float(stiffness / count),
        outer_weight=float(outer_weight),
        load_factor=float(0.323 * rollers * count / (1.0 + outer_weight) ** (2.0 / 9.0)),
    )


@kernel
def penetration_of(load, laminae):
    """Return the penetration of an aligned roller's contact [m] and the load that it belongs to [N]: ``load`` within the range of the table.

    Parameters
    ----------
    load : of the roller [N].
    laminae : `Laminae`.
    """
    last = laminae.penetrations.shape[0] - 1
    place = min(max((math.log(max(load, 1e-300)) - laminae.log_least) * laminae.per_log, 0.0), float(last))
    k = min(int(place), last - 1)
    log_depth = laminae.penetrations[k] + (place - k) * (laminae.penetrations[k + 1] - laminae.penetrations[k])
    return math.exp(log_depth), math.exp(laminae.log_least + place / laminae.per_log)


# Powers by products and roots, which cost less than `pow`.
@kernel
def _fourth(x):
    square = x * x
    return square * square


@kernel
def _nine_halves(x):
    return _fourth(x) * math.sqrt(x)


@kernel
def _nine_eighths(x):
    """Return x^(9/8), from power means with `ROTATING_EXPONENT` to those with 9/2."""
    return x * math.sqrt(math.sqrt(math.sqrt(x)))


@kernel
def add_load_moments(inner, outer, weight, moments):
    """Add the loads of one roller to sums of their powers: 4 to 7 of the inner, 4.5 to 7.5 of the outer load.

    Parameters
    ----------
    inner, outer : loads of a roller [N].
    weight : factor of what is added.
    moments : changed in place, shape (2, MOMENTS).
    """
    inside, outside = weight * _fourth(inner), weight * _nine_halves(outer)
    for k in range(MOMENTS):
        moments[0, k] += inside
        moments[1, k] += outside
        inside *= inner
        outside *= outer


@kernel
def _gauss_loads(moments):
    """Return two loads and their parts of the weight that have the same four moments: load, weight, load, weight."""
    weight = moments[0]
    if not weight > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    mean, second, third = moments[1] / weight, moments[2] / weight, moments[3] / weight
    variance = second - mean * mean
    if not variance > _SPREAD * mean * mean:
        return mean, weight, mean, 0.0
    skew = (third - 3.0 * mean * second + 2.0 * mean * mean * mean) / (2.0 * variance)
    root = math.sqrt(skew * skew + variance)
    above, below = skew + root, skew - root
    return mean + above, -below / (above - below) * weight, max(mean + below, 0.0), above / (above - below) * weight


@kernel
def equivalent_loads(moments, oil, life):
    """Return the `EquivalentLoads` of aligned rollers by moments of their loads.

    Parameters
    ----------
    moments : means over rollers and time of the loads' powers, shape (2, MOMENTS); see `add_load_moments`.
    oil : `bearing_sim.physics.rating_life.OilFactors`.
    life : `bearing_sim.model.params.Life`.
    """
    laminae = life.laminae
    inside, outside = _aligned_rollers(moments[0], laminae), _aligned_rollers(moments[1], laminae)
    inner, outer, modified = 0.0, 0.0, 0.0
    count = laminae.crown.shape[0]
    for k in range((count + 1) // 2 if laminae.mirrored else count):
        number = 2.0 if laminae.mirrored and 2 * k + 1 < count else 1.0  # of laminae like this one; the middle one is alone
        rotating, stationary = _lamina_means(k, inside, outside, laminae)
        of_inner = _nine_eighths(rotating)
        inner += number * of_inner
        outer += number * stationary
        modified += number * _modified_part(of_inner, stationary, oil, life)
    whole_inner, whole_outer = moments[0, 0] ** (1.0 / ROTATING_EXPONENT), moments[1, 0] ** (1.0 / STATIONARY_EXPONENT)
    return _summed(whole_inner, whole_outer, inner, outer, modified, life)


@kernel
def _aligned_rollers(moments, laminae):
    """Return penetration, load and weight of both loads that stand for the moments of a ring's."""
    load_1, weight_1, load_2, weight_2 = _gauss_loads(moments)
    (depth_1, load_1), (depth_2, load_2) = penetration_of(load_1, laminae), penetration_of(load_2, laminae)
    return depth_1, load_1, weight_1, depth_2, load_2, weight_2


@kernel
def _lamina_means(k, inside, outside, laminae):
    """Return the means over rollers and time of the powers 4 and 4.5 of a lamina's loads on both rings, given `_aligned_rollers` of each."""
    drop, stiffness = laminae.crown[k], laminae.risers[k] * laminae.stiffness
    d_1, q_1, w_1, d_2, q_2, w_2 = inside
    d_3, q_3, w_3, d_4, q_4, w_4 = outside
    rotating = w_1 * _fourth(_share(d_1 - drop, stiffness / q_1)) + w_2 * _fourth(_share(d_2 - drop, stiffness / q_2))
    stationary = w_3 * _nine_halves(_share(d_3 - drop, stiffness / q_3)) + w_4 * _nine_halves(_share(d_4 - drop, stiffness / q_4))
    return rotating, stationary


@kernel
def write_lamina_means(moments, laminae, inner_means, outer_means):
    """Write the means of `add_lamina_powers` that aligned rollers have, by moments of their loads (see `add_load_moments`)."""
    inside, outside = _aligned_rollers(moments[0], laminae), _aligned_rollers(moments[1], laminae)
    for k in range(laminae.crown.shape[0]):
        inner_means[k], outer_means[k] = _lamina_means(k, inside, outside, laminae)


@kernel
def _modified_part(inner, outer, oil, life):
    """Return what a lamina adds to the sum of the modified life, times N^(-7/2).

    Parameters
    ----------
    inner, outer : q_kei^(9/2) and q_kee^(9/2) [N^(9/2)].
    oil, life : as of `equivalent_loads`.
    """
    basic = inner / life.inner_rating**4.5 + outer / life.outer_rating**4.5
    if not life.modified or not basic > 0.0:
        return basic
    load = life.laminae.load_factor * (inner + life.laminae.outer_weight * outer) ** (2.0 / 9.0)
    return basic / _nine_eighths(modification_factor(oil.viscosity_ratio, oil.contamination_factor * life.fatigue_limit / load))


@kernel
def _summed(whole_inner, whole_outer, inner, outer, modified, life):
    """Return the `EquivalentLoads` of whole rollers and of sums over the laminae of q_kei^(9/2), q_kee^(9/2) and `_modified_part`."""
    basic = inner / life.inner_rating**4.5 + outer / life.outer_rating**4.5
    factor = 1.0
    if life.modified:
        factor = (modified / basic) ** (-8.0 / 9.0) if basic > 0.0 else LARGEST_MODIFICATION
    count = life.laminae.crown.shape[0]
    return EquivalentLoads(whole_inner, whole_outer, _of_laminae(inner, count), _of_laminae(outer, count), factor)


@kernel
def _share(depth, stiffness):
    """Return a lamina's part of the roller's load, times its stress riser; ``stiffness`` is over the load."""
    return stiffness * depth * ninth_root(max(depth, TINY)) if depth > 0.0 else 0.0


@kernel
def _of_laminae(total, count):
    """Return N^(7/9) [sum of q_ke^(9/2)]^(2/9) [N]."""
    return count ** (7.0 / 9.0) * total ** (2.0 / 9.0)


@kernel
def add_lamina_powers(inner, outer, risers, fraction, inner_means, outer_means):
    """Add one instant to running means of the laminae's loads, stress risers included, to the exponents of both rings.

    m_k is kept up to date as m_k + fraction ((sum over rollers of (f_k q_jk)^p)/Z - m_k): a fraction of 1 restarts the mean, 1/(n + 1) gives
    the plain mean of n + 1 instants, 1 - exp(-h/T) a mean that forgets.

    Parameters
    ----------
    inner, outer : loads of all laminae [N], shape (Z, N).
    risers : see `stress_risers`, shape (N,).
    fraction : weight of this instant.
    inner_means, outer_means : means of the powers 4 and 4.5, shape (N,); changed in place.
    """
    rollers, laminae = inner.shape
    for k in range(laminae):
        rotating, stationary = 0.0, 0.0
        for j in range(rollers):
            q_i, q_e = risers[k] * inner[j, k], risers[k] * outer[j, k]
            rotating += _fourth(q_i)
            stationary += _nine_halves(q_e)
        inner_means[k] += fraction * (rotating / rollers - inner_means[k])
        outer_means[k] += fraction * (stationary / rollers - outer_means[k])


@kernel
def equivalent_lamina_loads(whole_inner, whole_outer, inner_means, outer_means, oil, life):
    """Return the `EquivalentLoads` of rollers whose laminae are known.

    Parameters
    ----------
    whole_inner, whole_outer : dynamic equivalent loads of whole rollers [N].
    inner_means, outer_means : as of `add_lamina_powers`, shape (N,).
    oil, life : as of `equivalent_loads`.
    """
    inner, outer, modified = 0.0, 0.0, 0.0
    for k in range(inner_means.shape[0]):
        of_inner = _nine_eighths(inner_means[k])
        inner += of_inner
        outer += outer_means[k]
        modified += _modified_part(of_inner, outer_means[k], oil, life)
    return _summed(whole_inner, whole_outer, inner, outer, modified, life)
