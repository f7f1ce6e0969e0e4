# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Roller ends on flanges: shear of the oil in the end gap, friction under an axial load, and corners that stop a skewed roller.

At a point (rho_r, rho_t) of a roller's end face, measured outwards and along the orbit from the roller's axis, the end slides over the flange of
a ring that turns at Omega by

    v_t = u - s rho_r,   v_r = s rho_t,   u = speed of the roller's centre along the orbit less Omega r_m,   s = w + Omega

(Omega = 0 of the outer ring, which rests).  Everything here is a sum of such shear forces, so that force along the orbit F and torque M on the
roller's spin are minus the derivatives of one dissipation function by u and s: what is lost is -(F u + M s), never negative, and their matrix of
derivatives is symmetric.

**End gap.** Couette's shear stress eta v/h of a laminar, isoviscous film (as N. P. Petroff, 1883, between coaxial cylinders):

    F = -eta (A u - S s),   M = eta (S u - I s),   A, S, I = integral of 1, rho_r, rho_r^2 + rho_t^2 over h,

over the overlap of end face and flange.  *Assumptions*: the gap is full of oil of the bearing's temperature; a roller stands in the middle of its
end clearance unless an axial load presses it; the flange opens by its layback beyond the root.

**Friction.** A contact under the force N at the offset rho on the axis of symmetry: F = -mu N V_u, M = -mu N V_s, with the smooth sliding speed
V = sqrt(v_t^2 + (s e)^2 + v_0^2), e how far the contact stands off that axis.  mu mixes boundary and film friction (`bearing_sim.physics.mixed`).

**Where.** A flat end presses on a flange that opens by its layback with the rim of its face, at rho = R_w - r_c; a spherical end of radius R_s at R_s
sin(layback) (T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology, 2006, on roller ends and flange layback).

**Skew.** Between two flanges a roller that skews by q touches with a corner of each end where flange and rim meet, e off the axis of symmetry,
once |q| e exceeds half the end clearance: N = K delta^(3/2) (1 + a delta') of Hertz's point contact at each of the two.  The oil that both
ends displace damps the skewing before: a strip of length 2 e and width B over the gap g, with ambient pressure at both edges,
resists with eta B^3 (2 e)^3/(12 h^3) q', h in the middle of the strip.  *Assumption*: K is that of a sphere of radius
sqrt(r_c (R_w - r_c)/layback) on a plane, the geometric mean of the rim's principal radii.
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import larger, magnitude, spread, square_root, total, where_positive

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)
_STILL = 1e-2  # m/s; assumption: friction is proportional to the sliding speed well below this
_EVEN = 1.0  # N; assumption: rollers that carry less share the axial load evenly


class Face(NamedTuple):
    """The flanges of one ring against the ends of a roller; all zero where the ring has none."""

    area: float  # A, all ends together [m]
    first: float  # S [m^2]
    second: float  # I [m^3]
    offset: float  # rho of the loaded contact, negative inwards of the roller's axis [m]
    corner_offset: float  # rho of the corners that touch when it skews [m]
    corner: float  # e of these [m]; 0 where flanges on both sides do not hold the roller
    squeeze: float  # resistance to skewing over the viscosity, all ends together [m^3]


class Flanges(NamedTuple):
    """Flanges of both rings, and what roller ends do on them."""

    on: bool  # whether there are any
    guide: bool  # whether those of one ring hold a roller between them
    inner: Face
    outer: Face
    pitch_radius: float  # r_m [m]
    load: float  # axial load of the bearing [N], not negative
    guiding: float  # axial force that guides a roller, over its load on the inner raceway
    couple: float  # its sense: 1 where it presses the inner ring along +x, -1 the other way
    clearance: float  # half the end clearance [m]
    stiffness: float  # K of a corner [N/m^1.5]
    damping: float  # a [s/m]
    film_friction: float  # coefficient on a full film


NO_FACE = Face(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@functools.lru_cache(maxsize=256)
def end_integrals(raceway: float, edge: float, centre: float, rim: float, gap: float, layback: float) -> tuple[float, float, float]:
    """Return A [m], S [m^2] and I [m^3] of one end of a roller over one flange, the integrals of 1, rho_r and rho^2 over h.

    Around the bearing's axis h depends on the radius alone, so that the integral over the azimuth is in closed form.

    Parameters
    ----------
    raceway, edge : radii of the flange's root and edge [m].
    centre : radius of the roller's axis [m].
    rim : radius of the flat end face [m].
    gap : h at the root [m].
    layback : slope by which the flange opens away from its root.
    """
    start, end = max(min(raceway, edge), centre - rim), min(max(raceway, edge), centre + rim)
    if end <= start:
        return 0.0, 0.0, 0.0
    # where the rim ends, the overlap narrows as a root of the distance: nodes in even angles make it smooth
    width, turns = end - start, 0.5 * math.pi * (_NODES + 1.0)
    radii = start + 0.5 * width * (1.0 - np.cos(turns))
    weights = 0.25 * math.pi * width * np.sin(turns) * _WEIGHTS
    angles = np.arccos(np.clip((radii**2 + centre**2 - rim**2) / (2.0 * radii * centre), -1.0, 1.0))
    film = gap + layback * np.abs(radii - raceway)
    chord = radii * np.sin(angles)
    per = weights * radii * 2.0 / film
    area, first = float((per * angles).sum()), float((per * (chord - centre * angles)).sum())
    return area, first, float((per * ((radii**2 + centre**2) * angles - 2.0 * centre * chord)).sum())


def rim_corner(edge: float, centre: float, rim: float) -> tuple[float, float]:
    """Return where the rim of a roller's end crosses the edge of a flange: outwards of the roller's axis, and along the orbit [m]."""
    outwards = (edge**2 - rim**2 - centre**2) / (2.0 * centre)
    return outwards, math.sqrt(max(rim**2 - outwards**2, 0.0))


def flange_face(sides: str, gaps, raceway: float, edge: float, centre: float, rim: float, layback: float, contact: float) -> Face:
    """Return the `Face` of a ring.

    Parameters
    ----------
    sides : ``none``, ``one`` or ``both``.
    gaps : at the flanges' roots, one for each [m].
    raceway, edge, centre, rim, layback : as of `end_integrals`.
    contact : distance of the loaded contact from the roller's axis [m].
    """
    if sides == "none":
        return NO_FACE
    area, first, second = (sum(each) for each in zip(*(end_integrals(raceway, edge, centre, rim, gap, layback) for gap in gaps)))
    sign = -1.0 if edge > raceway else 1.0
    outwards, along = rim_corner(edge, centre, rim)
    reach = abs(centre + sign * rim - edge)
    strip, opened = 2.0 / 3.0 * reach, layback * (abs(edge - raceway) - 0.5 * reach)  # mean width of the segment, and h - g in its middle
    squeeze = sum(strip**3 * (2.0 * along) ** 3 / (12.0 * (gap + opened) ** 3) for gap in gaps)
    guides = sides == "both"
    return Face(area, first, second, sign * contact, outwards, along if guides else 0.0, squeeze if guides else 0.0)


def corner_stiffness(rim: float, corner_radius: float, layback: float, youngs_modulus: float, poisson_ratio: float) -> float:
    """Return K of N = K delta^(3/2) [N/m^1.5]: (4/3) E* sqrt(R), 1/E* = 2 (1 - nu^2)/E (Hertz), R as in the docstring of the module."""
    return 4.0 / 3.0 * youngs_modulus / (2.0 * (1.0 - poisson_ratio**2)) * (corner_radius * rim / layback) ** 0.25


@kernel
def axial_share(load, total_load, count, flanges):
    """Return the axial force of a roller on a flange of each ring [N].

    F_a (Q + 1 N)/(sum Q + Z 1 N) + guiding_load Q: a roller without load on its raceways cannot hold the couple of both flanges against it; it tilts
    and gives way.  *Assumption*: rollers share the axial load as they share the radial one, and evenly where there is none.

    Parameters
    ----------
    load, total_load : of the roller and of all rollers on the inner raceway [N].
    count : number of rollers.
    flanges : `Flanges`.
    """
    return (flanges.load / (total_load + count * _EVEN)) * (load + _EVEN) + flanges.guiding * load


@kernel
def shear(area, first, second, u, s):
    """Return F [N], M [N m] of the end gap, and -dF/du, -dF/ds = -dM/du, -dM/ds; A, S and I times the viscosity."""
    return first * s - area * u, first * u - second * s, area, -first, second


@kernel
def rub(root, force, offset, corner, u, s):
    """Return F [N], M [N m] of friction at a contact, -dF/du, -dF/ds = -dM/du, -dM/ds, and V_u and V_s.

    Parameters
    ----------
    root : square root, of a number or of lanes.
    force : mu N [N].
    offset, corner : rho and e [m].
    u, s : see the docstring of the module.
    """
    slide, turned = u - s * offset, corner * corner * s
    inverse = 1.0 / root(slide * slide + turned * s + _STILL * _STILL)
    by_u, by_s = slide * inverse, (turned - offset * slide) * inverse
    scale = force * inverse
    uu, us = scale * (1.0 - by_u * by_u), scale * (-offset - by_u * by_s)
    return -(force * by_u), -(force * by_s), uu, us, scale * (offset * offset + corner * corner - by_s * by_s), by_u, by_s


@kernel
def stop_skew(skew, rate, face, flanges):
    """Return the force at each of the two corners [N], its derivatives by skew and by its rate, and its elastic part (lanes).

    Parameters
    ----------
    skew, rate : q [rad] and q' [rad/s] of the roller against the flanges.
    face, flanges : `Face` and `Flanges`.
    """
    force, d_skew, d_rate, elastic = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    depth = magnitude(skew) * face.corner - flanges.clearance
    if face.corner > 0.0 and total(where_positive(depth, 1.0, 0.0)) > 0.0:
        side = where_positive(skew, face.corner, -face.corner)
        spring = flanges.stiffness * square_root(larger(depth, 0.0))
        factor = 1.0 + flanges.damping * (side * rate)
        pressed = where_positive(factor, 1.0, 0.0)
        elastic = spring * larger(depth, 0.0)
        force = pressed * elastic * factor
        d_skew = pressed * side * 1.5 * spring * factor
        d_rate = pressed * side * elastic * flanges.damping
    return force, d_skew, d_rate, elastic
