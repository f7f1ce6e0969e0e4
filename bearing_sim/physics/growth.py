# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far fits, rotation and heat close a mounted bearing: the growth of its inner raceway, and the clearance that is left.

The inner raceway grows by the pressure of the shaft's fit, by rotation and by heat; rollers by rotation and heat; the outer raceway shrinks by
the pressure of the housing's fit and grows by heat.  What rollers gain in diameter and the outer raceway in radius is counted at the inner
raceway: the play is what matters, and the rollers' orbit changes by a ten-thousandth.  With w the shaft's speed,

    g = heat + housing + free w^2 + fitted max(0, pressure + pressure_by_square_speed w^2),

exact for linear elastic rings (`bearing_sim.physics.layers`): the last term is the fit of the shaft, which is lost where its pressure vanishes.
All coefficients are 0 for a bearing whose dimensions are those of the running one.
"""

from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel


class Temperatures(NamedTuple):
    """Temperatures of what carries and makes up a bearing [K]; the cage has that of the rollers."""

    shaft: float
    inner_ring: float
    rollers: float
    outer_ring: float
    housing: float


class ShaftFit(NamedTuple):
    """Inner ring on its shaft; linear coefficients."""

    free: float  # growth of the raceway by the square of the speed without pressure [m s^2]
    fitted: float  # growth of the raceway by pressure [m/Pa]; 0 without a fit
    pressure: float  # at rest and at the reference temperature; negative: what a gap lacks to close [Pa]
    by_square_speed: float  # change of the pressure by the square of the speed [Pa s^2]
    by_shaft: float  # by the shaft's temperature [Pa/K]
    by_ring: float  # by the ring's temperature [Pa/K]


class HousingFit(NamedTuple):
    """Outer ring in its housing; linear coefficients."""

    shrunk: float  # shrinkage of the raceway by pressure [m/Pa]; 0 without a fit
    pressure: float  # at the reference temperature; negative: what a gap lacks to close [Pa]
    by_ring: float  # by the ring's temperature [Pa/K]
    by_housing: float  # by the housing's temperature [Pa/K]


class Expansion(NamedTuple):
    """Growth by temperature of what decides the play."""

    inner_raceway: float  # of its radius [m/K]
    roller: float  # of the diameter [m/K]
    outer_raceway: float  # of its mean radius [m/K]
    reference: float  # temperature at which the dimensions are valid [K]


class Mounted(NamedTuple):
    """A bearing on its shaft and in its housing: all that its growth follows from."""

    shaft: ShaftFit
    housing: HousingFit
    expansion: Expansion
    roller_free: float  # growth of the rollers' diameter by the square of the shaft's speed [m s^2]


AS_RUNNING = Mounted(ShaftFit(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), HousingFit(0.0, 0.0, 0.0, 0.0), Expansion(0.0, 0.0, 0.0, 0.0), 0.0)
"""A bearing whose dimensions are those of the running one: nothing grows."""


class Growth(NamedTuple):
    """Growth of the inner raceway against rollers and outer raceway at given temperatures; see the docstring of the module."""

    heat: float  # [m]
    housing: float  # by the fit of the housing [m]
    free: float  # by the square of the speed, of a ring without a shaft, and rollers [m s^2]
    fitted: float  # by the pressure of the shaft's fit [m/Pa]
    pressure: float  # of that fit at rest; negative where it is loose [Pa]
    pressure_by_square_speed: float  # [Pa s^2]
    housing_pressure: float  # of the fit in the housing; negative where it is loose [Pa]


@kernel
def growth_at(mounted, temperatures):
    """Return the `Growth` of a `Mounted` bearing at `Temperatures`."""
    shaft, housing, expansion = mounted.shaft, mounted.housing, mounted.expansion
    inner, outer = temperatures.inner_ring - expansion.reference, temperatures.outer_ring - expansion.reference
    heat = expansion.inner_raceway * inner + expansion.roller * (temperatures.rollers - expansion.reference) - expansion.outer_raceway * outer
    outside = housing.pressure + housing.by_ring * outer + housing.by_housing * (temperatures.housing - expansion.reference)
    inside = shaft.pressure + shaft.by_ring * inner + shaft.by_shaft * (temperatures.shaft - expansion.reference)
    shrunk = housing.shrunk * max(0.0, outside)
    return Growth(heat, shrunk, shaft.free + mounted.roller_free, shaft.fitted, inside, shaft.by_square_speed, outside)


@kernel
def cold_growth(mounted):
    """Return the `Growth` of a `Mounted` bearing at the temperature at which its dimensions are valid."""
    cold = mounted.expansion.reference
    return growth_at(mounted, Temperatures(cold, cold, cold, cold, cold))


@kernel
def total_growth(shaft_speed, growth):
    """Return a `Growth` at a shaft speed [rad/s], in metres."""
    square = shaft_speed * shaft_speed
    fit = max(0.0, growth.pressure + growth.pressure_by_square_speed * square)
    return growth.heat + growth.housing + growth.free * square + growth.fitted * fit


@kernel
def excess_growth(shaft_speed, temperature, growth, mounted):
    """Return by how much a `Growth` exceeds that of the same bearing at one temperature [K], in metres; 0 where temperatures are uniform.

    Parameters
    ----------
    shaft_speed : [rad/s].
    temperature : at which the bearing is compared.
    growth : `Growth` at the present temperatures.
    mounted : `Mounted`.
    """
    even = growth_at(mounted, Temperatures(temperature, temperature, temperature, temperature, temperature))
    return total_growth(shaft_speed, growth) - total_growth(shaft_speed, even)


@kernel
def seats_at(shaft_speed, growth, mounted, gaps):
    """Return pressure [Pa] and mean play [m] of the fit on the shaft, then of that in the housing.

    Parameters
    ----------
    shaft_speed : [rad/s].
    growth : `Growth` at the present temperatures.
    mounted : `Mounted`.
    gaps : mean play of both fits where they are loose [m].
    """
    inner = max(growth.pressure + growth.pressure_by_square_speed * shaft_speed * shaft_speed, 0.0) if growth.fitted != 0.0 else 0.0
    outer = growth.housing / mounted.housing.shrunk if mounted.housing.shrunk != 0.0 else 0.0
    return inner, 0.0 if inner > 0.0 else gaps[0], outer, 0.0 if outer > 0.0 else gaps[1]


class Clearance(NamedTuple):
    """Running clearance and its parts, diametral [m]; positive is play, negative preload.  The parts sum to the running clearance."""

    initial: float  # 2 (R_low - R_i - D_w) on the drawing
    fits: float  # by the fits, at rest and at the reference temperature
    rotation: float
    heat: float
    contour: float  # by points of the contour that lie below R_low
    running: float


@kernel
def clearance_at(shaft_speed, growth, params):
    """Return the `Clearance` of a bearing.

    Parameters
    ----------
    shaft_speed : [rad/s].
    growth : `Growth` at the present temperatures.
    params : `bearing_sim.model.params.Params`.
    """
    raceways, cold = params.raceways, cold_growth(params.mounted)
    initial = 2.0 * (raceways.low_radius - raceways.inner_radius - 2.0 * params.rollers.radius)
    fits = 0.0 - 2.0 * (cold.housing + cold.fitted * max(0.0, cold.pressure))
    rotation = 0.0 - 2.0 * total_growth(shaft_speed, cold) - fits
    heat = 0.0 - 2.0 * (total_growth(shaft_speed, growth) - total_growth(shaft_speed, cold))
    contour = 2.0 * raceways.contour_dip
    return Clearance(initial, fits, rotation, heat, contour, initial + fits + rotation + heat + contour)
