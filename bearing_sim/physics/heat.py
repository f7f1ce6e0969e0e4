# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How heat flows between the parts of a bearing, its oil and its surroundings: thermal conductances, formula by formula.

Each function takes and returns SI numbers and is written so that it can also be run with units (``test/test_heat.py`` does so).  A conductance
[W/K] is a heat flow over a difference of temperatures, a coefficient [W/(m^2 K)] is a conductance over an area.
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.film import DOWSON_TOYODA

STEFAN_BOLTZMANN = 5.670374419e-8  # W/(m^2 K^4)
GRAVITY = 9.80665  # m/s^2
# Dry air at 1 bar: powers of the temperature through the values at 300 K and 400 K of F. P. Incropera, D. P. DeWitt, Fundamentals of Heat and
# Mass Transfer, table A.4; within 2 % from 250 to 400 K.
_AIR_AT = 300.0  # K
_AIR_CONDUCTIVITY = 0.0263  # W/(m K)
_AIR_VISCOSITY = 15.89e-6  # m^2/s, kinematic
_AIR_PRANDTL = 0.70
_ROUGHNESS_UNIT = 1e-6  # m; the correlation of slopes below counts in um


class Air(NamedTuple):
    """Dry air at one temperature and 1 bar."""

    conductivity: float  # [W/(m K)]
    viscosity: float  # kinematic [m^2/s]
    prandtl: float


@kernel
def air_at(temperature):
    """Return the `Air` of a temperature [K]; within 2 % of the tables from 250 to 400 K."""
    ratio = temperature / _AIR_AT
    return Air(_AIR_CONDUCTIVITY * ratio**0.87, _AIR_VISCOSITY * ratio**1.766, _AIR_PRANDTL)


@kernel
def hertz_half_width(load, curvature_radius, length, reduced_modulus):
    """Return half the width of the contact of a roller [m], b = (8 Q R/(pi L E'))^(1/2) (H. Hertz, J. reine angew. Math. 92 (1881)).

    Parameters
    ----------
    load : Q [N].
    curvature_radius : effective radius R [m].
    length : L [m].
    reduced_modulus : E' = 2/sum((1 - nu^2)/E) [Pa].
    """
    return (8.0 * load * curvature_radius / (math.pi * length * reduced_modulus)) ** 0.5


@kernel
def film_in_the_middle(viscosity, pressure_viscosity, speed, load, length, curvature_radius, reduced_modulus):
    """Return the thickness of a film in the middle of its contact [m], isothermal (D. Dowson, A. Toyoda, see `bearing_sim.physics.film`).

    Its heated inlet is left out: fast films are thinner and conduct better.

    Parameters
    ----------
    viscosity, pressure_viscosity : eta_0 [Pa s] and alpha [1/Pa] of the oil at the inlet.
    speed : u, mean speed of both surfaces relative to the contact [m/s], either sign.
    load, length : Q [N] and L [m].
    curvature_radius, reduced_modulus : R [m] and E' [Pa].
    """
    law = DOWSON_TOYODA
    rolled = viscosity * abs(speed) / (reduced_modulus * curvature_radius)
    pressed = load / (reduced_modulus * curvature_radius * length)
    return curvature_radius * law.factor * rolled**law.speed * (pressure_viscosity * reduced_modulus) ** law.material * pressed**law.load


@kernel
def film_conductance(conductivity, thickness, half_width, length):
    """Return the conductance of the oil film of one contact [W/K], k 2 b L/h: conduction across a film of even thickness.

    *Assumption*: the oil conducts as at ambient pressure.  At 1 GPa it conducts about twice as well (R. Larsson, O. Andersson, Proc. Instn Mech.
    Engrs J 214 (2000) 337), so the film's share of the resistance is an upper bound.

    Parameters
    ----------
    conductivity : k of the oil [W/(m K)].
    thickness : h [m].
    half_width, length : b and L of the contact [m].
    """
    return conductivity * 2.0 * half_width * length / thickness


@kernel
def moving_contact_conductance(conductivity, diffusivity, speed, half_width, length, roller_radius):
    """Return the conductance from one body to the other through one rolling contact of equal materials, without its film [W/K].

    Two half-spaces of different temperature that touch for the time t = 2 b/u exchange e (t/pi)^(1/2) an area and a kelvin, e = k/a^(1/2) their
    effusivity (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed. 1959, section 2.8); the area u L passes in a second:

        G = e L (2 b u/pi)^(1/2).

    It holds for Peclet numbers u b/a above about 10, where nothing conducts along the surface.  A contact at rest conducts through both bodies in
    series, each pi k L/ln(4 R_w/b), after the cylinder between strips of contact (G. R. McGee, M. H. Schankula, M. M. Yovanovich, Nucl. Eng.
    Des. 86 (1985) 369); *assumption*: here as the root of the sum of both squares.

    Parameters
    ----------
    conductivity : k of both bodies [W/(m K)].
    diffusivity : a = k/(rho c) [m^2/s].
    speed : u, mean speed of both surfaces relative to the contact [m/s], either sign.
    half_width, length : b and L of the contact [m].
    roller_radius : R_w [m].
    """
    moving = conductivity * length * (2.0 * half_width * abs(speed) / (math.pi * diffusivity)) ** 0.5
    resting = math.pi * conductivity * length / (2.0 * math.log(4.0 * roller_radius / half_width))
    return (moving**2 + resting**2) ** 0.5


@kernel
def in_series(first, second):
    """Return the conductance of two in series [W/K]; 0 where either is."""
    total = first + second
    return first * second / total if total > 0.0 * total else total


@kernel
def cylinder_conductance(outer_radius, inner_radius, conductivity, width):
    """Return the conductance of a cylinder's wall for a radial flow [W/K], 2 pi k B/ln(r_o/r_i) (J. Fourier; any text on heat conduction).

    Parameters
    ----------
    outer_radius, inner_radius : [m].
    conductivity : k [W/(m K)].
    width : B [m].
    """
    return 2.0 * math.pi * conductivity * width / math.log(outer_radius / inner_radius)


@kernel
def mean_radius(outer_radius, inner_radius):
    """Return the radius that halves the cross-section of a cylinder's wall [m]; *assumption*: there it has its mean temperature."""
    return ((outer_radius**2 + inner_radius**2) / 2.0) ** 0.5


@kernel
def fit_coefficient(conductivity, fluid_conductivity, roughness, pressure, hardness, gap):
    """Return the heat transfer coefficient of a fit [W/(m^2 K)]: spots that touch, and what fills the gaps between them.

    Spots: h_c = 1.25 k_s (m/sigma) (p/H)^0.95 (M. G. Cooper, B. B. Mikic, M. M. Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279, exponent and
    factor of M. M. Yovanovich, AIAA 82-0888 (1982)), p/H from 1e-6 to 0.02.  Gaps: h_g = k_g/(Y + gap), Y = 1.53 sigma (p/H)^-0.097 (AIAA 82-0888).
    Slope of the roughness: m = 0.076 (sigma/1 um)^(1/2) (M. A. Lambert, L. S. Fletcher, J. Thermophys. Heat Transfer 11 (1997) 129).  *Assumption*: a
    fit that is loose has p/H = 1e-6, and its gap is even.

    Parameters
    ----------
    conductivity : k_s, of the solids [W/(m K)]; their harmonic mean where they differ.
    fluid_conductivity : k_g, of what fills the gaps [W/(m K)].
    roughness : sigma, root of the sum of squares of both surfaces [m].
    pressure : p [Pa]; 0 where the fit is loose.
    hardness : H of the softer surface [Pa].
    gap : mean play of a loose fit [m]; 0 for a tight one.
    """
    slope = 0.076 * (roughness / _ROUGHNESS_UNIT) ** 0.5
    relative = max(float(pressure / hardness), 1e-6)
    spots = 1.25 * conductivity * slope / roughness * relative**0.95
    return spots + fluid_conductivity / (1.53 * roughness * relative**-0.097 + gap)


@kernel
def oil_coefficient(conductivity, viscosity, diffusivity, speed):
    """Return the heat transfer coefficient between a surface of the bearing and the oil in it [W/(m^2 K)].

    h = 0.0986 k Pr^(1/3) [n (1 +/- gamma)/nu]^(1/2), n in turns a minute, + for the inner ring and - for rollers, cage and outer ring: laminar
    flow along a plate (E. R. G. Eckert), as W. J. Crecelius and J. Pirvics (AFAPL-TR-76-90, 1976) and T. A. Harris and M. N. Kotzalas (Rolling
    Bearing Analysis, 5th ed. 2006) use it, by secondary literature.  n (1 +/- gamma) is twice the speed of the surface relative to the cage, which
    the oil is taken to follow, or of the cage relative to a surface at rest.  *Assumption*: surfaces are wetted all over, whatever the fraction
    of oil.  Harris gives for the same purpose the plate of the length d_m in a flow of a third of the cage's speed, which is a third of it: take
    it as known to a factor of 3.

    Parameters
    ----------
    conductivity : k of the oil [W/(m K)].
    viscosity : kinematic, nu [m^2/s].
    diffusivity : k/(rho c) of the oil [m^2/s].
    speed : of the surface relative to the cage, or of the cage [rad/s], either sign.
    """
    turns = 0.0986 * (60.0 / math.tau) ** 0.5  # from turns a minute to radians a second
    return turns * conductivity * (viscosity / diffusivity) ** (1.0 / 3.0) * (2.0 * abs(speed) / viscosity) ** 0.5


@kernel
def natural_convection_coefficient(surface, ambient, diameter):
    """Return the heat transfer coefficient of a horizontal cylinder in still air [W/(m^2 K)].

    Nu = {0.60 + 0.387 Ra^(1/6)/[1 + (0.559/Pr)^(9/16)]^(8/27)}^2, properties at the mean of both temperatures (S. W. Churchill, H. H. S. Chu, Int. J.
    Heat Mass Transfer 18 (1975) 1049); Ra = g |T_s - T_a| d^3 Pr/(T_m nu^2) from 1e-5 to 1e12.

    Parameters
    ----------
    surface, ambient : temperatures [K].
    diameter : d [m].
    """
    mean = (surface + ambient) / 2.0
    air = air_at(mean)
    rayleigh = GRAVITY * abs(surface - ambient) * diameter**3 * air.prandtl / (mean * air.viscosity**2)
    damped = (1.0 + (0.559 / air.prandtl) ** (9.0 / 16.0)) ** (8.0 / 27.0)
    return air.conductivity / diameter * (0.60 + 0.387 * rayleigh ** (1.0 / 6.0) / damped) ** 2


@kernel
def moving_air_coefficient(surface, ambient, diameter, air_speed):
    """Return the heat transfer coefficient of a horizontal cylinder in air that moves across it [W/(m^2 K)].

    Forced: Nu = 0.3 + 0.62 Re^(1/2) Pr^(1/3)/[1 + (0.4/Pr)^(2/3)]^(1/4) [1 + (Re/282,000)^(5/8)]^(4/5), Re = v d/nu (S. W. Churchill, M. Bernstein,
    J. Heat Transfer 99 (1977) 300), Re Pr above 0.2.  *Assumption*: with natural convection as the cube root of the sum of both cubes, as
    S. W. Churchill (AIChE J. 23 (1977) 10) combines them.

    Parameters
    ----------
    surface, ambient : temperatures [K].
    diameter : d [m].
    air_speed : v [m/s]; 0 is still air.
    """
    air = air_at((surface + ambient) / 2.0)
    reynolds = air_speed * diameter / air.viscosity
    slope = 0.62 * air.prandtl ** (1.0 / 3.0) / (1.0 + (0.4 / air.prandtl) ** (2.0 / 3.0)) ** 0.25
    forced = air.conductivity / diameter * (0.3 + slope * reynolds**0.5 * (1.0 + (reynolds / 282e3) ** 0.625) ** 0.8)
    return (forced**3 + natural_convection_coefficient(surface, ambient, diameter) ** 3) ** (1.0 / 3.0)


@kernel
def radiation_coefficient(surface, ambient, emissivity):
    """Return the heat transfer coefficient of radiation to wide surroundings [W/(m^2 K)], eps sigma (T_s^2 + T_a^2)(T_s + T_a) (Stefan, Boltzmann).

    Parameters
    ----------
    surface, ambient : temperatures [K].
    emissivity : eps.
    """
    return emissivity * STEFAN_BOLTZMANN * (surface**2 + ambient**2) * (surface + ambient)


@kernel
def rotating_shaft_coefficient(surface, ambient, diameter, speed):
    """Return the heat transfer coefficient of a horizontal shaft that rotates in air [W/(m^2 K)].

    Rotation: Nu = 0.133 Re^(2/3) Pr^(1/3), Re = omega d^2/(2 nu) with the surface's speed and the diameter (K. M. Becker, Int. J. Heat Mass
    Transfer 6 (1963) 1053), Re from 1000 to 4e5.  *Assumption*: with natural convection as the cube root of the sum of both cubes, as S. W.
    Churchill (AIChE J. 23 (1977) 10) combines natural with forced convection; and beyond the range as within it.

    Parameters
    ----------
    surface, ambient : temperatures [K].
    diameter : d [m].
    speed : omega [rad/s], either sign.
    """
    air = air_at((surface + ambient) / 2.0)
    reynolds = abs(speed) * diameter**2 / (2.0 * air.viscosity)
    rotating = 0.133 * reynolds ** (2.0 / 3.0) * air.prandtl ** (1.0 / 3.0) * air.conductivity / diameter
    return (rotating**3 + natural_convection_coefficient(surface, ambient, diameter) ** 3) ** (1.0 / 3.0)


@kernel
def fin_conductance(coefficient, perimeter, conductivity, section, length):
    """Return the conductance of a shaft end to the air [W/K]: a fin with an adiabatic tip, (h P k A)^(1/2) tanh(m L), m = (h P/(k A))^(1/2).

    Closed form (any text on heat transfer), for a temperature that is even over the section: h d/k well below 1.

    Parameters
    ----------
    coefficient : h [W/(m^2 K)].
    perimeter : P [m].
    conductivity : k [W/(m K)].
    section : A [m^2].
    length : L [m].
    """
    return (coefficient * perimeter * conductivity * section) ** 0.5 * math.tanh((coefficient * perimeter / (conductivity * section)) ** 0.5 * length)


@kernel
def held_fin_conductances(coefficient, perimeter, conductivity, section, length):
    """Return the conductances from the root of a fin to the air and to its tip [W/K], where the tip's temperature is given.

    Closed form of the fin of `fin_conductance`: the heat through the root is (h P k A)^(1/2) [tanh(m L/2) (T - T_air) + (T - T_tip)/sinh(m L)].

    Parameters
    ----------
    coefficient, perimeter, conductivity, section, length : as of `fin_conductance`; L above 0.
    """
    scale = (coefficient * perimeter * conductivity * section) ** 0.5
    reach = (coefficient * perimeter / (conductivity * section)) ** 0.5 * length
    if reach < 1e-9:  # no air: conduction alone
        return 0.0, conductivity * section / length
    return scale * math.tanh(0.5 * reach), scale / math.sinh(reach)


@kernel
def flow_conductance(density, specific_heat, flow):
    """Return the heat capacity of a flow of oil [W/K], rho c Q: the heat that it takes along for each kelvin that it leaves warmer than it came.

    Parameters
    ----------
    density : [kg/m^3].
    specific_heat : c [J/(kg K)].
    flow : Q [m^3/s].
    """
    return density * specific_heat * flow


def plummer_block_area(height, width):
    """Return the surface of a plummer block that gives off heat [m^2], pi H (B + H/2) (DIN 31652-1:1983, for pedestal bearings).

    Parameters
    ----------
    height : H [m].
    width : B, along the shaft [m].
    """
    return math.pi * height * (width + height / 2.0)
