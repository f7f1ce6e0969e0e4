# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Load ratings of a bearing: by the standards from its dimensions (ISO 281:2007, ISO 76:2006), or its maker's."""

from typing import Annotated, Literal, NamedTuple

from bearing_sim.scene.quantity import Quantity, check, record


@record
class Ratings:
    """A maker's ratings.  Load ratings that are left out follow from the dimensions by the standards; the others serve warnings only.

    The ratings of the rollers' contacts (ISO/TS 16281) are in proportion to C, so a maker's C applies to every life.
    """

    dynamic: Annotated[float, Quantity("N", "basic dynamic radial load rating, C", 1.0, 1e9)] | None = None
    static: Annotated[float, Quantity("N", "basic static radial load rating, C_0", 1.0, 1e9)] | None = None
    fatigue_limit: Annotated[float, Quantity("N", "fatigue load limit, C_u", 0.1, 1e8)] | None = None
    minimum_load_factor: (
        Annotated[float, Quantity("N", "minimum load factor, k_r; makers print 0.15 for 0.15 kN or 150 for 150 N", 10.0, 1e4, "kN")] | None
    ) = None
    reference_speed: Annotated[float, Quantity("rad/s", "reference speed, n_r", 1.0, 12000.0, "rpm")] | None = None
    limiting_speed: Annotated[float, Quantity("rad/s", "limiting speed", 1.0, 12000.0, "rpm")] | None = None
    axial_load: Literal["skf", "krw", "none"] = "skf"  # whose rule counts an axial load in the equivalent load, see `bearing_sim.scene.axial_load`

    @check
    def _are_of_one_bearing(self) -> list[str]:
        if self.fatigue_limit is not None and self.static is not None and self.fatigue_limit >= self.static:
            return [f"fatigue_limit: {self.fatigue_limit:g} N is not below the static rating, {self.static:g} N; C_u is about C_0/8"]
        return []


class Rated(NamedTuple):
    """The load ratings that a bearing is computed with."""

    dynamic: float  # C [N]
    static: float  # C_0 [N]
    fatigue_limit: float  # C_u [N]
    computed: Ratings  # all three by the standards, for comparison with a maker's


def rate(bearing) -> Rated:
    """Return the load ratings of a `bearing_sim.scene.bearing.Bearing`: its maker's where the scene gives them, else by the standards.

    A maker's C_0 also gives the fatigue limit, unless the maker gives that too.
    """
    roller, given = bearing.roller, bearing.ratings
    computed = ratings_by_standards(roller.count, roller.diameter, roller.length, bearing.pitch_diameter)
    static = computed.static if given.static is None else given.static
    limit = fatigue_limit(static, bearing.pitch_diameter) if given.fatigue_limit is None else given.fatigue_limit
    return Rated(computed.dynamic if given.dynamic is None else given.dynamic, static, limit, computed)


def ratings_by_standards(rollers: int, roller_diameter: float, length: float, pitch_diameter: float) -> Ratings:
    """Return the load ratings by ISO 281 and ISO 76; parameters as in `load_rating` and `fatigue_limit`."""
    dimensions = rollers, roller_diameter, length, roller_diameter / pitch_diameter
    static = static_rating(*dimensions)
    return Ratings(dynamic=load_rating(*dimensions), static=static, fatigue_limit=fatigue_limit(static, pitch_diameter))


class MinimumLoadLaw(NamedTuple):
    """Load below which makers expect slip."""

    at_rest: float  # [N]
    by_speed: float  # by how much it grows with the speed of the shaft [N s/rad]
    rule: str  # where it comes from


_MINIMUM_OF_RATING = 0.02  # of C_r: the least load of roller bearings where a maker gives no factor (SKF, Schaeffler)


def minimum_load_law(bearing) -> MinimumLoadLaw:
    """Return the minimum load of a `bearing_sim.scene.bearing.Bearing`.

    P_min = k_r (6 + 4 n/n_r)(d_m/100 mm)^2 (SKF, LYC) where ``bearing.ratings`` has k_r and n_r, otherwise 0.02 C_r.
    """
    limits = bearing.ratings
    if limits.minimum_load_factor is not None and limits.reference_speed is not None:
        scale = limits.minimum_load_factor * (bearing.pitch_diameter / 0.1) ** 2
        return MinimumLoadLaw(6.0 * scale, 4.0 * scale / limits.reference_speed, "k_r (6 + 4 n/n_r)(d_m/100 mm)^2")
    rule = "0.02 C_r; give minimum_load_factor and reference_speed in bearing.ratings"
    return MinimumLoadLaw(_MINIMUM_OF_RATING * rate(bearing).dynamic, 0.0, rule)


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
