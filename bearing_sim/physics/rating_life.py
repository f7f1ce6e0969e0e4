# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rating life from roller loads: by whole rollers, by slices, and modified by oil and reliability (ISO 281:2007, ISO/TS 16281:2008)."""

import math

import numpy as np

from bearing_sim.numerics.compilation import kernel

ROTATING_EXPONENT = 4.0  # of the mean load of a ring that rotates against the load (ISO/TS 16281)
STATIONARY_EXPONENT = 4.5  # and of one that is stationary
LARGEST_MODIFICATION = 50.0  # a_ISO is never more
LARGEST_VISCOSITY_RATIO = 4.0  # kappa counts no more than that
_LEAST_VISCOSITY_RATIO = 0.1  # below it a_ISO is at its least, 0.1

# Cleanliness class -> (slope, loss) of e_C = min(slope kappa^0.68 D_pw^0.55, 1) (1 - loss/D_pw^(1/3)), D_pw in mm (ISO 281:2007,
# annex A): circulating oil filtered in line (A.4), oil bath or oil filtered off the line (A.5), by the end of the ISO 4406 code.
CLEANLINESS = {
    "filtered_13_10": (0.0864, 0.5663),
    "filtered_15_12": (0.0432, 0.9987),
    "filtered_17_14": (0.0288, 1.6329),
    "filtered_19_16": (0.0216, 2.3362),
    "bath_13_10": (0.0864, 0.5796),
    "bath_15_12": (0.0288, 1.141),
    "bath_17_14": (0.0133, 1.67),
    "bath_19_16": (0.00864, 2.5164),
    "bath_21_18": (0.00411, 3.8974),
}


def load_rating(rollers, roller_diameter, length, gamma):
    """Return the basic dynamic radial load rating C_r [N] (ISO 281:2007, 7.1).

    C_r = b_m f_c (L cos alpha)^(7/9) Z^(3/4) D_w^(29/27) in N and mm with b_m = 1.1, alpha = 0 and the f_c of ISO/TR 1281-1,
    207.9 x 0.83 gamma^(2/9) (1 - gamma)^(29/27) (1 + gamma)^(-1/4) {1 + [1.04 ((1 - gamma)/(1 + gamma))^(143/108)]^(9/2)}^(-2/9).

    Parameters
    ----------
    rollers : number of rollers, Z.
    roller_diameter, length : D_w and L [m].
    gamma : D_w / d_m.
    """
    ratio = (1 - gamma) / (1 + gamma)
    f_c = 207.9 * 0.83 * gamma ** (2 / 9) * (1 - gamma) ** (29 / 27) * (1 + gamma) ** -0.25 * (1 + (1.04 * ratio ** (143 / 108)) ** 4.5) ** (-2 / 9)
    return 1.1 * f_c * (1e3 * length) ** (7 / 9) * rollers**0.75 * (1e3 * roller_diameter) ** (29 / 27)


def ring_ratings(rollers, roller_diameter, length, gamma):
    """Return the load ratings (Q_ci, Q_ce) [N] of one roller on the inner and outer ring (ISO/TS 16281, 5.2).

    Parameters as in `load_rating`.
    """
    rating = load_rating(rollers, roller_diameter, length, gamma)
    g = (1.038 * ((1 - gamma) / (1 + gamma)) ** (143 / 108)) ** 4.5
    inner = rating / (0.83 * 0.378 * rollers) * (1 + g) ** (2 / 9)
    outer = rating / (0.83 * 0.364 * rollers) * (1 + 1 / g) ** (2 / 9)
    return inner, outer


@kernel
def rating_life_revolutions(inner_equivalent, outer_equivalent, life):
    """Return L10 in revolutions (ISO/TS 16281; Deng 2017, eq. 18 with rating and load in the right places).

    Parameters
    ----------
    inner_equivalent, outer_equivalent : dynamic equivalent roller loads Q_ei, Q_ee [N].
    life : `bearing_sim.model.params.Life`.
    """
    inner = (inner_equivalent / life.inner_rating) ** 4.5
    outer = (outer_equivalent / life.outer_rating) ** 4.5
    return 1e6 * (inner + outer) ** (-8.0 / 9.0)


def static_rating(rollers, roller_diameter, length, gamma):
    """Return the basic static radial load rating C_0r = 44 (1 - gamma) Z L D_w [N] (ISO 76); parameters as in `load_rating`."""
    return 44.0 * (1 - gamma) * rollers * (1e3 * length) * (1e3 * roller_diameter)


def fatigue_limit(static, pitch_diameter):
    """Return the fatigue load limit C_u [N] (ISO 281, B.3.3): C_0r/8.2, less where the pitch diameter is above 100 mm.

    Parameters
    ----------
    static : C_0r [N].
    pitch_diameter : [m].
    """
    return static / 8.2 * min(1.0, 0.1 / pitch_diameter) ** 0.3


def reliability_factor(reliability):
    """Return a_1, the fraction of L10 that a bearing survives with a probability (ISO 281:2007, table 12).

    The table's values are, to the digits printed, those of a Weibull distribution with slope 1.5 that starts at 0.05 of L10:
    a_1 = 0.05 + 0.95 [ln(1/R)/ln(1/0.9)]^(2/3).

    Parameters
    ----------
    reliability : the probability, 0.9 or more.
    """
    return 1.0 if reliability == 0.9 else 0.05 + 0.95 * (math.log(1.0 / reliability) / math.log(1.0 / 0.9)) ** (1 / 1.5)


def stress_risers(slices):
    """Return f(k) = 1 - 0.01/ln(1.985 |(2 k - N - 1)/(2 N - 2)|) of each slice (ISO/TS 16281, 5.3.3), shape (N,).

    They raise the load of the outer slices for the stress concentration at the edges; the middle slice of an odd number has 1.

    Parameters
    ----------
    slices : their number N, at least 2.
    """
    position = np.abs(2.0 * np.arange(1, slices + 1) - slices - 1.0) / (2.0 * slices - 2.0)
    with np.errstate(divide="ignore"):
        return 1.0 - 0.01 / np.log(1.985 * position)


@kernel
def add_slice_powers(inner, outer, risers, fraction, inner_means, outer_means):
    """Add one instant to running means of the slices' loads, stress risers included, to the exponents of both rings.

    m_k is kept up to date as m_k + fraction ((sum over rollers of (f_k q_jk)^p)/Z - m_k): a fraction of 1 restarts the mean, 1/(n + 1) gives
    the plain mean of n + 1 instants, 1 - exp(-h/T) a mean that forgets.

    Parameters
    ----------
    inner, outer : loads of all slices [N], shape (Z, N).
    risers : see `stress_risers`, shape (N,).
    fraction : weight of this instant.
    inner_means, outer_means : means of the powers 4 and 4.5, shape (N,); changed in place.
    """
    rollers, slices = inner.shape
    for k in range(slices):
        rotating, stationary = 0.0, 0.0
        for j in range(rollers):
            q_i, q_e = risers[k] * inner[j, k], risers[k] * outer[j, k]
            rotating += (q_i * q_i) * (q_i * q_i)
            stationary += (q_e * q_e) * (q_e * q_e) * math.sqrt(q_e)
        inner_means[k] += fraction * (rotating / rollers - inner_means[k])
        outer_means[k] += fraction * (stationary / rollers - outer_means[k])


@kernel
def lamina_life_revolutions(inner_means, outer_means, life):
    """Return the reference rating life L10r by slices, in revolutions (ISO/TS 16281, 5.3).

    L10r = [sum over k of (q_kei/q_kci)^(9/2) + (q_kee/q_kce)^(9/2)]^(-8/9) million, q_kc = Q_c N^(-7/9).

    Parameters
    ----------
    inner_means, outer_means : see `add_slice_powers`, shape (N,).
    life : `bearing_sim.model.params.Life`.
    """
    slices = inner_means.shape[0]
    fraction = slices ** (-7.0 / 9.0)
    inner_scale, outer_scale = (life.inner_rating * fraction) ** -4.5, (life.outer_rating * fraction) ** -4.5
    total = 0.0
    for k in range(slices):
        total += inner_means[k] ** (4.5 / ROTATING_EXPONENT) * inner_scale + outer_means[k] * outer_scale
    return 1e6 * total ** (-8.0 / 9.0)


@kernel
def viscosity_ratio(kinematic_viscosity, shaft_speed, pitch_diameter):
    """Return kappa = nu/nu_1 (ISO 281, 9.3.3.2); 0 at rest.

    nu_1 = 45000 n^-0.83 D_pw^-0.5 mm^2/s below 1000 rpm, 4500 n^-0.5 D_pw^-0.5 above, D_pw in mm.

    Parameters
    ----------
    kinematic_viscosity : nu [m^2/s].
    shaft_speed : [rad/s].
    pitch_diameter : D_pw [m].
    """
    rpm = abs(shaft_speed) * (30.0 / math.pi)
    # as a ratio, which is finite at rest
    speed = rpm**0.83 / 45000.0 if rpm < 1000.0 else math.sqrt(rpm) / 4500.0
    return 1e6 * kinematic_viscosity * speed * math.sqrt(1e3 * pitch_diameter)


@kernel
def contamination_factor(kappa, slope, loss, pitch_diameter):
    """Return e_C (ISO 281:2007, annex A), 0 to 1.

    Parameters
    ----------
    kappa : viscosity ratio.
    slope, loss : of a class in `CLEANLINESS`.
    pitch_diameter : D_pw [m].
    """
    millimetres = 1e3 * pitch_diameter
    filtered = min(slope * min(kappa, LARGEST_VISCOSITY_RATIO) ** 0.68 * millimetres**0.55, 1.0)
    return filtered * max(1.0 - loss / millimetres ** (1.0 / 3.0), 0.0)


@kernel
def modification_factor(kappa, limit_ratio):
    """Return a_ISO of a radial roller bearing (ISO 281:2007, 9.3.3.3), 0.1 to 50.

    a_ISO = 0.1 [1 - (1.5859 - c/kappa^p) (e_C C_u/P)^0.4]^-9.185.

    Parameters
    ----------
    kappa : viscosity ratio; counts from 0.1, where a_ISO is at its least, to 4.
    limit_ratio : e_C C_u/P, from 0 to infinity.
    """
    kappa = min(kappa, LARGEST_VISCOSITY_RATIO)
    if not kappa > _LEAST_VISCOSITY_RATIO or not limit_ratio > 0.0:
        return 0.1
    if kappa < 0.4:
        film = 1.5859 - 1.3993 / kappa**0.054381
    elif kappa < 1.0:
        film = 1.5859 - 1.2348 / kappa**0.19087
    else:
        film = 1.5859 - 1.2348 / kappa**0.071739
    left = 1.0 - max(film, 0.0) * limit_ratio**0.4
    if not left > 0.0:
        return LARGEST_MODIFICATION
    return min(0.1 * left**-9.185, LARGEST_MODIFICATION)


@kernel
def modified_life_revolutions(revolutions, shaft_speed, kinematic_viscosity, pitch_diameter, life):
    """Return L_nm = a_1 a_ISO L10 in revolutions (ISO 281).

    a_ISO takes for P the load that gives this L10, P = C_r L10^(-3/10): ISO/TS 16281's reference equivalent load.

    Parameters
    ----------
    revolutions : L10 or L10r; may be infinite.
    shaft_speed : [rad/s].
    kinematic_viscosity : of the oil [m^2/s].
    pitch_diameter : [m].
    life : `bearing_sim.model.params.Life`.
    """
    if not life.modified:
        return life.reliability_factor * revolutions
    kappa = viscosity_ratio(kinematic_viscosity, shaft_speed, pitch_diameter)
    cleanliness = contamination_factor(kappa, life.cleanliness_slope, life.cleanliness_loss, pitch_diameter)
    limit_ratio = cleanliness * life.fatigue_limit_ratio * (revolutions * 1e-6) ** 0.3 if cleanliness > 0.0 else 0.0
    return life.reliability_factor * modification_factor(kappa, limit_ratio) * revolutions
