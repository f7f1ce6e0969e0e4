# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The running clearance of a scene: from fits, materials and dimensions on the drawing to the numbers of `bearing_sim.physics.growth`."""

import math

import numpy as np

from bearing_sim.model.sample import part_temperature
from bearing_sim.physics.growth import AS_RUNNING, Expansion, HousingFit, Mounted, ShaftFit, Temperatures
from bearing_sim.physics.layers import Layer, State, compliance_matrix, displacement, hoop_stress, misfits, spinning_roller_growth
from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.material import Material
from bearing_sim.scene.mounting import Mounting, housing_interference, shaft_interference, smoothed

_LEAST_PLAY = 1.5  # times the film at which surfaces touch: what a cage keeps that its growth would jam
_HOUSING_RATIO = 1.5  # assumption: outside radius of a housing over that of the ring; from 1.3 to 3 the ring shrinks by a third more or less


def uniform(temperature: float) -> Temperatures:
    """Return one temperature [K] for everything."""
    return Temperatures(*(temperature,) * 5)


def mounted(bearing: Bearing, mounting: Mounting) -> Mounted:
    """Return what the growth of a bearing follows from; nothing where its dimensions are those of the running bearing."""
    if bearing.dimensions_at == "running":
        return AS_RUNNING
    inner, outer, roller = bearing.inner_raceway, bearing.outer_raceway, bearing.roller
    alpha = bearing.material.expansion
    # Rollers that roll on the outer raceway without slip spin at w (1 - gamma^2)/(2 gamma).
    spin = 0.5 * (1 - bearing.diameter_ratio**2) / bearing.diameter_ratio
    return Mounted(
        shaft=_shaft_fit(bearing, mounting),
        housing=_housing_fit(bearing, mounting),
        expansion=Expansion(alpha * inner.radius, alpha * roller.diameter, alpha * _mean_raceway(outer), bearing.reference_temperature),
        roller_free=2 * spinning_roller_growth(_layer(0.0, roller.diameter / 2, bearing.material), spin * spin),
    )


def _mean_raceway(outer) -> float:
    return outer.low_radius + outer.d_value / 2


def _layer(inside: float, outside: float, material: Material) -> Layer:
    return Layer(inside, outside, material.youngs_modulus, material.poisson_ratio, material.density, material.expansion)


def _inner_ring(bearing: Bearing) -> Layer:
    return _layer(bearing.inner_raceway.bore_radius, bearing.inner_raceway.radius, bearing.material)


def shaft_layers(bearing: Bearing, mounting: Mounting) -> tuple[Layer, ...]:
    """Return shaft, sleeve if there is one, and inner ring, from bore to raceway."""
    inner, shaft = bearing.inner_raceway, mounting.shaft
    ring, sleeve = _inner_ring(bearing), shaft.sleeve
    if sleeve is None:
        return _layer(shaft.bore_radius, inner.bore_radius, shaft.material), ring
    return _layer(shaft.bore_radius, sleeve.bore_radius, shaft.material), _layer(sleeve.bore_radius, inner.bore_radius, sleeve.material), ring


def housing_layers(bearing: Bearing, mounting: Mounting) -> tuple[Layer, Layer]:
    """Return outer ring, from its mean raceway outwards, and housing."""
    outer, housing = bearing.outer_raceway, mounting.housing
    around = housing.outside_radius if housing.outside_radius is not None else _HOUSING_RATIO * outer.outside_radius
    return _layer(_mean_raceway(outer), outer.outside_radius, bearing.material), _layer(outer.outside_radius, around, housing.material)


def _seats(layers: tuple[Layer, ...], interferences: list[float]) -> np.ndarray:
    """Return pressures of the seats [Pa]: by interference, then what square speed, warmth of all rings but the outer, and warmth of that change.

    The seats hold: where one lets go, its pressure is negative.  Shape (4, seats).
    """
    nothing, count, compliance = [0.0] * len(interferences), len(layers), compliance_matrix(layers)
    still, turning, inside, outside = [0.0] * count, [1.0] * count, [1.0] * (count - 1) + [0.0], [0.0] * (count - 1) + [1.0]
    overlaps = (
        misfits(layers, interferences, still, still),
        misfits(layers, nothing, turning, still),
        misfits(layers, nothing, still, inside),
        misfits(layers, nothing, still, outside),
    )
    return np.linalg.solve(compliance, np.transpose(overlaps)).T


def _shaft_seats(bearing: Bearing, mounting: Mounting) -> np.ndarray | None:
    """Return `_seats` of shaft, sleeve and inner ring; None without a fit of the ring."""
    layers, shaft = shaft_layers(bearing, mounting), mounting.shaft
    limits = shaft_interference(shaft, 2 * layers[-1].inner_radius)
    if limits is None:
        return None
    own = [] if shaft.sleeve is None else [shaft.sleeve.interference]
    return _seats(layers, [*own, smoothed(limits.mean, shaft)])


def sleeve_pressure(bearing: Bearing, mounting: Mounting, shaft_speed):
    """Return the pressure between shaft and sleeve at the reference temperature [Pa], below 0 where it would let go; infinite without a sleeve."""
    seats = None if mounting.shaft.sleeve is None else _shaft_seats(bearing, mounting)
    return math.inf if seats is None else seats[0, 0] + seats[1, 0] * shaft_speed * shaft_speed


def _shaft_fit(bearing: Bearing, mounting: Mounting) -> ShaftFit:
    ring, seats = _inner_ring(bearing), _shaft_seats(bearing, mounting)
    raceway = ring.outer_radius
    free = displacement(ring, raceway, State(square_speed=1.0))
    if seats is None:
        return ShaftFit(free, 0.0, 0.0, 0.0, 0.0, 0.0)
    pressure, by_square_speed, by_shaft, by_ring = seats[:, -1].tolist()
    return ShaftFit(free, displacement(ring, raceway, State(inner_pressure=1.0)), pressure, by_square_speed, by_shaft, by_ring)


def _housing_fit(bearing: Bearing, mounting: Mounting) -> HousingFit:
    outside = bearing.outer_raceway.outside_radius
    limits = None if outside is None else housing_interference(mounting.housing, 2 * outside)
    if limits is None:
        return HousingFit(0.0, 0.0, 0.0, 0.0)
    ring, around = housing_layers(bearing, mounting)
    pressure, _, by_ring, by_housing = _seats((ring, around), [smoothed(limits.mean, mounting.housing)])[:, 0].tolist()
    return HousingFit(-displacement(ring, ring.inner_radius, State(outer_pressure=1.0)), pressure, by_ring, by_housing)


def seat_compliance(bearing: Bearing, mounting: Mounting) -> float:
    """Return by how much a pressure between outer ring and housing parts them in the mean [m/Pa]."""
    return float(compliance_matrix(housing_layers(bearing, mounting))[0, 0])


def running_play(bearing: Bearing, mounting: Mounting, shaft_speed: float) -> float:
    """Return how far the cage's centre can move in its guidance [m] at a shaft speed [rad/s] and the reference temperature.

    A cage on the outer ring's lands grows into them as a ring that turns, one on the inner ring's lands away from them, while that ring
    grows after it.  *Assumption*: the cage turns without slip, and its bars between the pockets do not weaken it.
    """
    cage = bearing.cage
    if bearing.dimensions_at == "running" or not cage.has_lands:
        return cage.play
    body = _layer(cage.bore, cage.outside, cage.material)
    square = (0.5 * shaft_speed * (1 - bearing.diameter_ratio)) ** 2
    if cage.guidance == "outer_ring":
        play = cage.play - displacement(body, cage.outside, State(square_speed=square))
    else:
        fit, turned = _shaft_fit(bearing, mounting), shaft_speed * shaft_speed
        pressure = max(0.0, fit.pressure + fit.by_square_speed * turned)
        ring = _inner_ring(bearing)
        land = displacement(ring, ring.outer_radius, State(inner_pressure=pressure, square_speed=turned))
        play = cage.play + displacement(body, cage.bore, State(square_speed=square)) - land
    return max(play, _LEAST_PLAY * cage.land_film)


def clearance_at_speed(bearing: Bearing, mounting: Mounting, shaft_speed: float) -> float:
    """Return the diametral clearance of the running bearing at the reference temperature [m]; negative: preload.

    Parameters
    ----------
    bearing, mounting : of the scene.
    shaft_speed : [rad/s].
    """
    parts, square = mounted(bearing, mounting), shaft_speed * shaft_speed
    growth = parts.housing.shrunk * max(0.0, parts.housing.pressure) + (parts.shaft.free + parts.roller_free) * square
    growth += parts.shaft.fitted * max(0.0, parts.shaft.pressure + parts.shaft.by_square_speed * square)
    return 2.0 * (bearing.radial_clearance_at_low_points - growth)


def seat_pressure(parts: Mounted, samples: np.ndarray) -> np.ndarray:
    """Return the pressure between shaft and inner ring in samples [Pa], shape (n,); negative where they have parted.

    Parameters
    ----------
    parts : `mounted` of the bearing.
    samples : shape (n,), see `bearing_sim.model.sample`; where they hold no temperatures, shaft and ring are as warm as each other.
    """
    fit, reference = parts.shaft, parts.expansion.reference
    pressure = fit.pressure + fit.by_square_speed * samples["shaft_speed"] ** 2
    for factor, name in ((fit.by_shaft, "shaft_temperature"), (fit.by_ring, "inner_ring_temperature")):
        pressure = pressure + factor * (part_temperature(samples, name) - reference)
    return pressure


def largest_hoop_stress(bearing: Bearing, parts: Mounted, shaft_speed):
    """Return the tangential stress at the bore of the inner ring [Pa], by rotation and fit at the reference temperature.

    Parameters
    ----------
    bearing : with a bore radius.
    parts : `mounted` of the bearing.
    shaft_speed : [rad/s], a number or an array.
    """
    ring, square = _inner_ring(bearing), shaft_speed * shaft_speed
    pressure = np.maximum(0.0, parts.shaft.pressure + parts.shaft.by_square_speed * square)
    return hoop_stress(ring, ring.inner_radius, State(inner_pressure=pressure, square_speed=square))
