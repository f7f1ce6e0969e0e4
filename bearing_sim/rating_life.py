"""Rating life from roller loads (ISO 281, ISO/TS 16281)."""

from bearing_sim.kernels.compilation import kernel

ROTATING_EXPONENT = 4.0
STATIONARY_EXPONENT = 4.5


def load_rating(rollers, roller_diameter, length, gamma):
    """Return the basic dynamic radial load rating C_r [N] (ISO 281, 7.1; b_m = 1.1).

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
    """Return L10 in revolutions (ISO/TS 16281; Deng 2017, eq. 18 with rating and load in their right places).

    Parameters
    ----------
    inner_equivalent, outer_equivalent : dynamic equivalent roller loads Q_ei, Q_ee [N].
    life : `bearing_sim.params.Life`.
    """
    inner = (inner_equivalent / life.inner_rating) ** 4.5
    outer = (outer_equivalent / life.outer_rating) ** 4.5
    return 1e6 * (inner + outer) ** (-8.0 / 9.0)
