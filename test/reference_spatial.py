# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A plain NumPy model of level ``spatial``, for comparison; written from the equations, with the laws of `reference_planar`.

Everything is a Cartesian vector in the radial plane.  A body is its centre and the inclination of its axis, both in a frame that
does not turn; its slice at x is the point centre + x inclination, which has a velocity and feels a force.  What acts on a body is the
sum of its slices' forces, and the sum of those times x.
"""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from reference_films import larger, magnitude
from reference_planar import Reference, ahead, azimuth_of, cross, dot


@dataclass
class State:
    """As in `reference_planar`, with inclinations and their rates besides."""

    ring: np.ndarray  # shape (2,)
    ring_velocity: np.ndarray
    ring_lean: np.ndarray
    ring_leaning: np.ndarray
    cage: np.ndarray
    cage_velocity: np.ndarray
    cage_lean: np.ndarray
    cage_leaning: np.ndarray
    cage_angle: float
    cage_speed: float
    place: np.ndarray  # of the rollers' centres, shape (2, Z)
    velocity: np.ndarray
    lean: np.ndarray
    leaning: np.ndarray
    spin: np.ndarray  # shape (Z,)


def sum_of_films(pieces):
    """Heat in the films of one raceway: by sliding, and by resistance to rolling of both surfaces."""
    return np.sum(pieces.force * pieces.slide), np.sum(2 * pieces.resistance * pieces.roll)


@dataclass
class SpatialReference:
    """Composed of the planar reference, whose laws hold for a slice as for an N-th of a roller."""

    planar: Reference = field(default_factory=Reference)
    slices: int = 6
    crown: np.ndarray | None = None
    gyroscopic: bool = True
    ring_free: bool = True
    moment: tuple = (0.0, 0.0)
    bent: tuple = (
        0.0,
        0.0,
        0.0,
    )  # how far the outer ring has given way to each roller [m], its slope [m/rad], and how fast where the roller is [m/s]

    def __post_init__(self):
        p = self.planar
        self.x = (np.arange(self.slices) + 0.5) * p.length / self.slices - p.length / 2
        self.drop = np.zeros(self.slices) if self.crown is None else self.crown
        self.transverse = p.mass * (3 * p.roller_radius**2 + p.length**2) / 12
        self.cage_transverse = p.cage_inertia / 2
        self.ring_polar = p.ring_mass * p.inner_radius**2 / 2
        self.land = (p.width - p.land_width) / 2

    def traction(self, load, depth, rolling, sliding, curvature_radius):
        """Tractions of all slices, each an N-th of that of a whole contact with its load per length, and the contacts' resistance to rolling.

        ``load`` is that of whole contacts with the slices' load per length; ``sliding`` a function of the place.  A slice bears where it is pressed
        in by 20 nm, and in part below; the mean gap is that of the others.  Jacobians leave out that both change: here they are real.
        """
        slides = sliding(self.x)
        force = self.planar.traction(load, rolling[:, None], slides, curvature_radius) / self.slices
        pressed = larger(depth, 0.0)
        bears = (1 - larger(1 - pressed / 2e-8, 0.0)).sum(1)
        gap = (pressed - depth).sum(1) / larger(self.slices - bears, 1.0)
        part = np.real(larger(bears / self.slices, 1e-6))
        resistance = self.planar.resistance(load.sum(1) / self.slices, rolling, curvature_radius, part, np.real(gap))
        return SimpleNamespace(x=self.x, slide=slides, roll=rolling, force=force, resistance=resistance)

    def forces(self, state):
        """All forces at a state, by name; those of slices have a last axis over slices."""
        p, x, n = self.planar, self.x, self.slices
        f = SimpleNamespace(state=state)
        r_w, r_i, omega_i = p.roller_radius, p.inner_radius, p.shaft_speed
        f.radius = np.sqrt(dot(state.place, state.place))
        f.outward = state.place / f.radius
        f.along = ahead(f.outward)
        radial_speed, f.orbit = dot(state.velocity, f.outward), dot(state.velocity, f.along)
        turning = f.orbit / f.radius

        # inner raceway: gap of each slice along the normal at the centre, and how the gap changes with the centre's place
        apart, relative = state.place - state.ring[:, None], state.velocity - state.ring_velocity[:, None]
        lean, leaning = state.lean - state.ring_lean[:, None], state.leaning - state.ring_leaning[:, None]
        f.distance = np.sqrt(dot(apart, apart))
        f.normal = apart / f.distance
        across = ahead(f.normal)
        passing = dot(relative, across) / f.distance  # angular speed of the normal
        depth = (p.raceway + r_w - f.distance)[:, None] - dot(lean, f.normal)[:, None] * x - self.drop
        f.inner_rate = -dot(relative, f.normal)[:, None] - (dot(leaning, f.normal) + dot(lean, across) * passing)[:, None] * x
        f.inner, f.inner_elastic, f.inner_energy = p.normal_contact(depth, f.inner_rate)
        f.inner_way = f.normal[:, :, None] + (across * dot(lean, across) / f.distance)[:, :, None] * x  # minus the gradient of the depth

        def inner_slide(x):
            return (omega_i * p.raceway - state.spin * r_w)[:, None] - dot(relative, across)[:, None] - dot(leaning, across)[:, None] * x

        roll_i = ((omega_i - turning) * p.raceway + (state.spin + turning) * r_w) / 2
        f.inner_traction = self.traction(f.inner, depth, roll_i, inner_slide, 1 / (1 / r_w + 1 / r_i))
        f.across = across

        # outer raceway: in the frame of the roller, where the contour is taken at the centre's azimuth
        contour, slope = p.contour(azimuth_of(state.place))
        f.moving = self.bent[2] + slope * turning
        contour, slope = contour + self.bent[0], slope + self.bent[1]
        f.tilt, f.skew = dot(state.lean, f.outward), dot(state.lean, f.along)
        tilting = dot(state.leaning, f.outward) + turning * f.skew  # in that frame
        depth = (f.radius + r_w - contour)[:, None] + f.tilt[:, None] * x - self.drop
        f.outer_rate = (radial_speed - f.moving)[:, None] + tilting[:, None] * x
        f.outer, f.outer_elastic, f.outer_energy = p.normal_contact(depth, f.outer_rate)
        f.outer_lean = (slope if p.contour_slope else 0 * slope)[:, None] / f.radius[:, None] - f.skew[:, None] / f.radius[:, None] * x

        def outer_slide(x):
            return (state.spin * r_w)[:, None] - f.orbit[:, None] - dot(state.leaning, f.along)[:, None] * x

        roll_e = (turning * (f.radius + r_w) + (state.spin + turning) * r_w) / 2
        f.outer_traction = self.traction(f.outer, depth, roll_e, outer_slide, 1 / (1 / r_w - 1 / p.low_radius))
        pitch_speed = p.pitch_radius * state.cage_speed
        drag, drag_slope = p.churning(pitch_speed)
        f.churning = drag + drag_slope * (f.orbit - pitch_speed)

        pocket_angle = state.cage_angle + 2 * np.pi * np.arange(p.rollers) / p.rollers
        f.pocket_outward = np.array([np.cos(pocket_angle), np.sin(pocket_angle)])
        f.pocket_along = ahead(f.pocket_outward)
        f.from_cage = (state.place - state.cage[:, None])[:, :, None] + (state.lean - state.cage_lean[:, None])[:, :, None] * x
        moving = (state.velocity - state.cage_velocity[:, None])[:, :, None] + (state.leaning - state.cage_leaning[:, None])[:, :, None] * x
        moving = moving - state.cage_speed * ahead(f.from_cage)
        f.pocket_slide = dot(moving, f.pocket_outward[:, :, None])
        f.pocket_rate = dot(moving, f.pocket_along[:, :, None])
        f.pocket, f.pocket_elastic, f.pocket_energy = p.pocket(
            dot(f.from_cage, f.pocket_along[:, :, None]), f.pocket_rate, p.pocket_clearance, p.pocket_film_force
        )
        f.pocket_smooth = p.rubbing_in_pockets * state.spin / np.sqrt(state.spin**2 + 10.0**2)
        guiding = p.guidance == "roller"
        middle = p.low_radius + p.d_value / 2 - r_w
        outwards = dot(f.from_cage, f.pocket_outward[:, :, None]) - middle if guiding else np.zeros((p.rollers, n))
        f.guide_rate = f.pocket_slide
        f.guide, f.guide_elastic, f.guide_energy = p.pocket(outwards, f.pocket_slide if guiding else 0.0, p.pocket_radial_clearance, 0.0)
        # a slice has an N-th of everything
        for name in ("inner", "outer", "pocket", "guide"):
            for kind in ("", "_elastic", "_energy"):
                setattr(f, name + kind, getattr(f, name + kind) / n)
        f.pocket_whole, f.guide_whole = f.pocket.sum(1), f.guide.sum(1)

        f.lands = []
        for place in (self.land, -self.land) if p.guidance != "roller" else ():
            at, velocity = state.cage + place * state.cage_lean, state.cage_velocity + place * state.cage_leaning
            ring, ring_velocity = state.ring + place * state.ring_lean, state.ring_velocity + place * state.ring_leaning
            f.lands.append(p.land(at, velocity, state.cage_speed, ring, ring_velocity))
            f.lands[-1].place = place
        f.bore_torque = p.couette(omega_i - state.cage_speed, p.inside, p.inside - r_i, p.inside_width)
        gap = p.low_radius - p.outside
        f.case_torque = -p.couette(state.cage_speed, p.outside, gap, p.outside_width) - p.end_faces(state.cage_speed)
        return f

    def accelerations(self, f):
        """Of ring, its lean, cage, its lean, cage angle, rollers, their leans and spins, under the forces ``f``."""
        p, x, state, r_w = self.planar, self.x, f.state, self.planar.roller_radius
        dragged_i, dragged_e = f.inner_traction.force.sum(1), f.outer_traction.force.sum(1)
        skewed_i, skewed_e = (f.inner_traction.force * f.inner_traction.x).sum(1), (f.outer_traction.force * f.outer_traction.x).sum(1)
        resistance_i, resistance_e = f.inner_traction.resistance, f.outer_traction.resistance
        inner = (f.inner * f.inner_way).sum(2) + (dragged_i + p.pushing[0] * resistance_i) * f.across
        outer = -f.outer.sum(1) * f.outward + ((f.outer * f.outer_lean).sum(1) + dragged_e - p.pushing[1] * resistance_e) * f.along
        pocket = -f.pocket * (f.pocket_along + f.pocket_smooth * f.pocket_outward)[:, :, None]
        pocket = pocket - f.guide * (f.pocket_outward - f.pocket_smooth * f.pocket_along)[:, :, None]
        pressed_on = magnitude(f.pocket_whole) + magnitude(f.guide_whole)
        spin_torque = r_w * (dragged_i - dragged_e - resistance_i - resistance_e - f.pocket_smooth * pressed_on)
        # both walls push at the roller's surface
        reach = np.where(np.real(f.pocket_whole) >= 0, r_w, -r_w) * cross(f.pocket_along, f.pocket_whole * f.pocket_smooth * f.pocket_outward)
        reach = reach + np.where(np.real(f.guide_whole) >= 0, r_w, -r_w) * cross(f.pocket_outward, -f.guide_whole * f.pocket_smooth * f.pocket_along)
        cage_torque = f.bore_torque + f.case_torque + np.sum(cross(f.from_cage, -pocket)) + np.sum(reach)
        cage_force, cage_moment = -pocket.sum((1, 2)), -(pocket * x).sum((1, 2))
        ring_force, ring_moment = np.array(p.load) - inner.sum(1), np.zeros(2)
        for land in f.lands:
            cage_force, cage_moment = cage_force + land.force / 2, cage_moment + land.place * land.force / 2
            cage_torque = cage_torque + land.torque / 2
            if p.guidance == "inner_ring":
                ring_force, ring_moment = ring_force - land.force / 2, ring_moment - land.place * land.force / 2
        # the outer contact's pressure on a slice acts in the roller's own frame: outwards on its tilt, nothing on its skew
        pressed = -(f.outer * x).sum(1) * f.outward + skewed_e * f.along
        inner_moment = (f.inner * x).sum(1) * f.normal + skewed_i * f.across
        moment = inner_moment + pressed + (pocket * x).sum(2)
        g = 1.0 if self.gyroscopic else 0.0

        def axis(moment, transverse, polar, speed, leaning):
            return (moment + g * polar * speed * ahead(leaning)) / transverse

        ring = axis(
            np.array(self.moment) + ring_moment - inner_moment.sum(1), self.ring_polar / 2, self.ring_polar, p.shaft_speed, state.ring_leaning
        )
        return (
            ring_force / p.ring_mass,
            ring if self.ring_free else 0 * ring,
            cage_force / p.cage_mass,
            axis(cage_moment, self.cage_transverse, p.cage_inertia, state.cage_speed, state.cage_leaning),
            cage_torque / p.cage_inertia,
            (inner + outer + pocket.sum(2) - f.churning * f.along) / p.mass,
            axis(moment, self.transverse, p.roller_inertia, -state.spin, state.leaning),
            spin_torque / p.roller_inertia,
        )

    def powers(self, f):
        """Work done on the bearing, and heat by cause [W]."""
        p, state, omega_i, omega = self.planar, f.state, self.planar.shaft_speed, f.state.cage_speed
        pressed_on = magnitude(f.pocket_whole) + magnitude(f.guide_whole)
        wall_slide = (f.pocket * f.pocket_slide - f.guide * f.pocket_rate).sum(1) + pressed_on * p.roller_radius * (state.spin + omega)
        turning = omega_i if p.guidance == "inner_ring" else 0.0
        work = {
            "shaft": omega_i * (p.raceway * (f.inner_traction.force.sum() + f.inner_traction.resistance.sum()) + f.bore_torque)
            - turning * sum(land.on_ring for land in f.lands) / 2,
            "load": dot(p.load, state.ring_velocity),
            "moment": dot(self.moment, state.ring_leaning),
        }
        (inner_sliding, inner_rolling), (outer_sliding, outer_rolling) = sum_of_films(f.inner_traction), sum_of_films(f.outer_traction)
        heat = {
            "inner traction": inner_sliding,
            "outer traction": outer_sliding,
            "inner rolling": inner_rolling,
            "outer rolling": outer_rolling,
            "normal damping": np.sum((f.inner - f.inner_elastic) * f.inner_rate + (f.outer - f.outer_elastic) * f.outer_rate),
            "pocket damping": np.sum((f.pocket - f.pocket_elastic) * f.pocket_rate + (f.guide - f.guide_elastic) * f.guide_rate),
            "pocket friction": np.sum(f.pocket_smooth * wall_slide),
            "churning": np.sum(f.churning * f.orbit),
            "guide land film": sum(land.film_heat for land in f.lands) / 2,
            "guide land contact": sum(land.touch_heat for land in f.lands) / 2,
            "mixture on the cage": f.bore_torque * (omega_i - omega) - f.case_torque * omega,
        }
        return work, heat

    def energy(self, f):
        """Kinetic and elastic energy [J]."""
        p, state = self.planar, f.state
        kinetic = (
            p.ring_mass * dot(state.ring_velocity, state.ring_velocity)
            + self.ring_polar / 2 * dot(state.ring_leaning, state.ring_leaning)
            + p.cage_mass * dot(state.cage_velocity, state.cage_velocity)
            + self.cage_transverse * dot(state.cage_leaning, state.cage_leaning)
            + p.cage_inertia * state.cage_speed**2
            + np.sum(p.mass * dot(state.velocity, state.velocity) + self.transverse * dot(state.leaning, state.leaning))
            + np.sum(p.roller_inertia * state.spin**2)
        ) / 2
        return kinetic + np.sum(f.inner_energy + f.outer_energy + f.pocket_energy + f.guide_energy) + sum(land.energy for land in f.lands) / 2
