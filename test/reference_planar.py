# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A plain NumPy model of level ``planar``, for comparison: no code shared with the package, written from the equations; films in `reference_films`.

Everything is a Cartesian vector in the radial plane, rollers too: places and velocities in y and z, shape (2, Z).  Each force is
written down once, at the body and the point where it acts; there is no derivative by hand.  Functions of complex numbers are
kept analytic (branches look at real parts, nothing takes an absolute value), so that a complex step differentiates them.
"""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from reference_films import Oil, couette_factor, films_of, hydrodynamic_resistance, larger, magnitude, power_of_positive


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def cross(a, b):
    """Moment of b at arm a about the shaft axis x."""
    return a[0] * b[1] - a[1] * b[0]


def ahead(a):
    """A vector turned by 90 degrees from y towards z."""
    return np.array([-a[1], a[0]])


def azimuth_of(place):
    rough = np.arctan2(np.real(place[1]), np.real(place[0]))
    c, s = np.cos(rough), np.sin(rough)
    return rough + np.arctan((place[1] * c - place[0] * s) / (place[0] * c + place[1] * s))


@dataclass
class State:
    """Places [m], velocities [m/s], angles [rad] and speeds [rad/s]; spins are positive where rollers roll on the outer ring."""

    ring: np.ndarray  # shape (2,)
    ring_velocity: np.ndarray
    cage: np.ndarray
    cage_velocity: np.ndarray
    cage_angle: float
    cage_speed: float
    place: np.ndarray  # of the rollers' centres, shape (2, Z)
    velocity: np.ndarray
    spin: np.ndarray  # shape (Z,)


@dataclass
class Reference:
    """Bearing of Deng 2017, Table 1 (SI), 45,000 rpm, MIL-L-7808 at 120 degC, with the defaults of the package for what it leaves open.

    ``films`` are fields of `reference_films.Films`.
    """

    low_radius: float = 34.8625e-3
    d_value: float = 0.098e-3
    knots: int = 720  # of the periodic cubic table that stands for the contour; 0 takes the cosine itself
    contour_slope: bool = True
    straight_churning: bool = True  # as the package does: the drag on rollers along its tangent at the cage's speed
    shaft_speed: float = 45000 * np.pi / 30
    load: tuple = (800.0, 0.0)
    rollers: int = 18
    roller_radius: float = 3.5e-3
    length: float = 7e-3
    inner_radius: float = 27.875e-3
    ring_mass: float = 0.55
    cage_mass: float = 0.05
    contact_damping: float = 0.104
    damping_time: float = 2.5e-6
    damping_depth: float = 1e-7
    pocket_friction: float = 0.05
    pocket_clearance: float = 0.1e-3
    pocket_film_force: float = 67.0
    pocket_film_damping: float = 5.0
    land_friction: float = 0.08
    land_film: float = 3e-6
    land_squeeze: bool = True
    guide_clearance: float = 0.15e-3
    guidance: str = "outer_ring"
    pocket_radial_clearance: float = 0.1e-3
    rolling_resistance: bool = False
    growth: float = 0.0  # of the inner raceway's radius while running [m]
    temperature: float = 393.15
    mixture_fraction: float = 0.03
    bore: float = 50.027e-3  # boundary diameters
    outer_diameter: float = 73.4e-3
    cage_width: float = 12e-3
    cage_outside: float = 33.35e-3
    cage_inside: float = 29.6e-3
    land_width: float = 2.5e-3  # of each of two
    land_radius: float = 33.5e-3  # of lands on the outer ring
    land_vortices: bool = False
    rubbing_in_pockets: float | None = None  # coefficient of friction there; None: that of pocket_friction and asperities
    films: dict = field(default_factory=dict)

    def __post_init__(self):
        self.pitch_radius = self.inner_radius + self.roller_radius
        self.raceway = self.inner_radius + self.growth
        self.pushing = 1 - 2 * self.roller_radius / self.pitch_radius, 1 + 2 * self.roller_radius / self.pitch_radius
        self.mass = np.pi * self.roller_radius**2 * self.length * 7850.0
        self.roller_inertia = 0.5 * self.mass * self.roller_radius**2
        self.cage_inertia = self.cage_mass * self.pitch_radius**2
        eta = 2 * (1 - 0.3**2) / 2.06e5  # 1/MPa
        self.stiffness = (self.length * 1e3) ** (8 / 9) / (1.36 * eta**0.9) ** (10 / 9) * 1000 ** (10 / 9)
        self.modulus = 2 / (2 * (1 - 0.3**2) / 2.06e11)
        self.oil = Oil(self.temperature)
        self.viscosity = self.oil.viscosity
        self.density = self.mixture_fraction * self.oil.density
        self.outside, self.inside, self.width = self.cage_outside, self.cage_inside, self.cage_width
        on_ring = {"outer_ring": self.land_radius, "inner_ring": self.inside - self.guide_clearance, "roller": np.nan}
        self.guide_radius = on_ring[self.guidance]
        self.outside_width = self.width - (2 * self.land_width if self.guidance == "outer_ring" else 0.0)
        self.inside_width = self.width - (2 * self.land_width if self.guidance == "inner_ring" else 0.0)
        self.film = films_of(self)
        if self.rubbing_in_pockets is None:
            self.rubbing_in_pockets = self.film.mixed(self.pocket_friction)

    def contour(self, azimuth):
        """R_e and its slope by azimuth."""
        half = self.d_value / 2

        def cosine(phi):
            return self.low_radius + half - half * np.cos(3 * phi), 3 * half * np.sin(3 * phi)

        if not self.knots:
            return cosine(azimuth)
        spacing = 2 * np.pi / self.knots
        knot = np.floor(np.real(azimuth) / spacing) * spacing
        s = (azimuth - knot) / spacing
        (a, da), (b, db) = cosine(knot), cosine(knot + spacing)
        radius = (1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * spacing * da + s**2 * (3 - 2 * s) * b + s**2 * (s - 1) * spacing * db
        slope = 6 * s * (1 - s) * (b - a) / spacing + (1 - s) * (1 - 3 * s) * da + s * (3 * s - 2) * db
        return radius, slope

    def normal_contact(self, penetration, rate):
        """Force with damping by the load and by the stiffness, never pulling; its elastic part; and the energy of that."""
        elastic = self.stiffness * power_of_positive(penetration, 10 / 9)
        energy = 9 / 19 * self.stiffness * power_of_positive(penetration, 19 / 9)
        by_stiffness = 10 / 9 * self.damping_time / (larger(penetration, 0.0) + self.damping_depth)
        return elastic * larger(1 + (self.contact_damping + by_stiffness) * rate, 0.0), elastic, energy

    def traction(self, load, rolling, sliding, curvature_radius):
        """The force mu Q, odd in the sliding speed (Deng 2017, ref. 17); load and rolling speed kept off zero, where the powers run away."""
        rolled, rolling = rolling, np.sqrt(rolling**2 + 0.05**2)
        w = larger(load, 1e-3) / (self.modulus * curvature_radius**2)
        u = self.viscosity * rolling / (self.modulus * curvature_radius)
        t = 0.0966 * self.temperature / (self.viscosity * rolling**2)
        a = -696 * w**-0.163 * u**0.577 * t**0.308
        b = 5.19e6 * w**-0.373 * u * t**0.687
        c = 6.826e5 * w**-0.170 * u**0.578 * t**0.373
        s = magnitude(sliding) / rolling
        force = load * np.where(np.real(sliding) >= 0, 1, -1) * ((a + b * s) * np.exp(-c * s) - a)
        return self.film.traction(load, rolled, sliding, force)

    def resistance(self, load, rolling, curvature_radius, part=1.0, gap=0.0):
        """Resistance to rolling of oil, of skew and of hysteresis; the contact bears on a ``part`` of its length, beside which there is a ``gap``."""
        force = self.film.losses_of_rolling(load, rolling, curvature_radius, self.modulus)
        if self.rolling_resistance:
            flooded = hydrodynamic_resistance(load, rolling, curvature_radius, self.oil, self.modulus, self.length, part, gap)
            force = force + self.film.resistance * flooded
        return force

    def pocket(self, offset, rate, clearance, film_force):
        """Force of a pocket's walls against a roller's offset, its elastic part, and the energy of that."""
        way, sign = magnitude(offset), np.where(np.real(offset) >= 0, 1, -1)
        film = film_force / clearance
        excess = larger(way - clearance, 0.0)
        in_film = way - excess
        wall, wall_elastic, wall_energy = self.normal_contact(excess, rate * sign)
        elastic = sign * (film * in_film + wall_elastic)
        energy = film * (in_film**2 / 2 + in_film * excess) + wall_energy
        return sign * (film * in_film + wall) + self.pocket_film_damping * rate, elastic, energy

    def churning(self, speed):
        """Drag of the mixture on a roller by its orbital speed, and its slope; the drag is a power of the speed between table points."""
        v = magnitude(speed)
        reynolds = np.log(self.density * v * 2 * self.roller_radius / self.viscosity)
        points = np.log([1e-1, 1, 10, 100, 1e3, 1e4, 2e5, 3e5, 4e5, 5e5, 1e6])
        values = np.log([60, 10, 3, 1.8, 1.0, 1.2, 1.2, 0.9, 0.65, 0.3, 0.3])
        segment = np.clip(np.searchsorted(points, np.real(reynolds)) - 1, 0, len(points) - 2)
        share = (reynolds - points[segment]) / (points[segment + 1] - points[segment])
        coefficient = np.exp(values[segment] + share * (values[segment + 1] - values[segment]))
        force = 0.5 * self.density * coefficient * self.length * 2 * self.roller_radius * v * speed
        return force, (2 + (values[segment + 1] - values[segment]) / (points[segment + 1] - points[segment])) * force / speed

    def couette(self, speed, radius, gap, length):
        factor = couette_factor(speed, radius, gap, self.density, self.viscosity)
        return 2 * np.pi * self.viscosity * radius**3 * speed * length / gap * factor

    def end_faces(self, omega):
        reynolds = self.density * magnitude(omega) * self.outside**2 / self.viscosity
        assert np.real(reynolds) < 2.5e5
        return 0.5 * self.density * omega * magnitude(omega) * (self.outside**5 - self.inside**5) * 3.87 * reynolds**-0.5

    def journal_film(self, place, velocity, speeds):
        """Force on a journal in a short bearing with half a film; nearer to the bearing than its thinnest film it finds the film no stiffer.

        Place and velocity of the journal's centre are seen from the bearing's; ``speeds`` is the sum of both angular speeds.
        """
        c, radius = self.guide_clearance, self.guide_radius
        eccentricity = np.sqrt(dot(place, place))
        outward = place / eccentricity
        eps, thinnest = eccentricity / c, 1 - self.land_film / c
        clipped = np.where(np.real(eps) > thinnest, thinnest, eps)
        rest = 1 - clipped**2
        scale = 2 * self.viscosity * radius * self.land_width**3 / c**2
        rate, along = (dot(velocity, outward) / c, dot(velocity, ahead(outward)) / c) if self.land_squeeze else (0.0, 0.0)
        wedge = eps * speeds - 2 * along
        side = wedge / np.sqrt(wedge**2 + 10.0**2)
        inwards = clipped / rest**2 * wedge * side + np.pi / 2 * (1 + 2 * clipped**2) / rest**2.5 * rate
        across = np.pi / 4 / rest**1.5 * wedge + 2 * clipped / rest**2 * side * rate
        friction = 2 * np.pi * self.viscosity * radius * radius**2 * 2 * self.land_width / (c * np.sqrt(rest))
        return scale * (across * ahead(outward) - inwards * outward), friction

    def land(self, cage, cage_velocity, omega, ring, ring_velocity):
        """What lands do to the cage where its axis and the inner ring's pass them: force, torque, torque on the ring, heats, energy."""
        inner = self.guidance == "inner_ring"
        if not inner:
            ring, ring_velocity, turning = 0 * ring, 0 * ring_velocity, 0.0
        else:
            turning = self.shaft_speed
        apart, velocity = cage - ring, cage_velocity - ring_velocity
        land = SimpleNamespace()
        if inner:  # the ring is the journal, the cage its bearing
            on_ring, friction = self.journal_film(-apart, -velocity, omega + turning)
            film = -on_ring
        else:
            film, friction = self.journal_film(apart, velocity, omega + turning)
        if self.land_vortices:  # of a concentric land that is full of oil
            friction = friction * couette_factor(turning - omega, self.guide_radius, self.guide_clearance, self.oil.density, self.viscosity)
        torque = friction * (turning - omega)
        on_ring = -torque - cross(apart, film)
        land.film_heat = -dot(film, velocity) - torque * omega - on_ring * turning

        eccentricity = np.sqrt(dot(apart, apart))
        outward = apart / eccentricity
        depth, rate = eccentricity - (self.guide_clearance - self.land_film), dot(velocity, outward)
        normal, elastic, land.energy = self.normal_contact(depth, rate)
        to_touch = -outward if inner else outward  # from either centre to where both surfaces meet
        touch = cage + self.guide_radius * to_touch
        surface = (omega - turning) * self.guide_radius
        rubbing = self.land_friction * normal * surface / np.sqrt(surface**2 + 0.1**2)
        force = -normal * outward - rubbing * ahead(to_touch)
        slide = cage_velocity + omega * ahead(touch - cage) - ring_velocity - turning * ahead(touch - ring)
        land.touch_heat = (normal - elastic) * rate + rubbing * dot(slide, ahead(to_touch))
        land.force = film + force
        land.torque = torque + cross(touch - cage, -rubbing * ahead(to_touch))
        land.on_ring = on_ring + cross(touch - ring, rubbing * ahead(to_touch))
        return land

    def no_land(self, cage):
        return SimpleNamespace(force=0 * cage, torque=0.0, on_ring=0.0, film_heat=0.0, touch_heat=0.0, energy=0.0)

    def forces(self, state):
        """All forces at a state, by name, with the speeds that they work at."""
        f = SimpleNamespace(state=state)
        r_w, r_i, omega_i = self.roller_radius, self.inner_radius, self.shaft_speed
        ring, ring_velocity = state.ring[:, None], state.ring_velocity[:, None]
        f.radius = np.sqrt(dot(state.place, state.place))
        f.outward = state.place / f.radius
        f.along = ahead(f.outward)
        radial_speed, f.orbit = dot(state.velocity, f.outward), dot(state.velocity, f.along)
        turning = f.orbit / f.radius

        from_ring, relative = state.place - ring, state.velocity - ring_velocity
        f.distance = np.sqrt(dot(from_ring, from_ring))
        f.normal = from_ring / f.distance
        f.inner_rate = -dot(relative, f.normal)
        f.inner, f.inner_elastic, f.inner_energy = self.normal_contact(self.raceway + r_w - f.distance, f.inner_rate)
        contour, slope = self.contour(azimuth_of(state.place))
        f.outer_rate = radial_speed - slope * turning
        f.outer, f.outer_elastic, f.outer_energy = self.normal_contact(f.radius + r_w - contour, f.outer_rate)
        f.lean = (slope if self.contour_slope else 0 * slope) / f.radius

        f.inner_slide = omega_i * self.raceway - dot(relative, ahead(f.normal)) - state.spin * r_w
        f.outer_slide = state.spin * r_w - f.orbit
        f.roll_i = roll_i = ((omega_i - turning) * self.raceway + (state.spin + turning) * r_w) / 2
        f.roll_e = roll_e = (turning * (f.radius + r_w) + (state.spin + turning) * r_w) / 2
        f.inner_resistance = self.resistance(f.inner, roll_i, 1 / (1 / r_w + 1 / r_i))
        f.outer_resistance = self.resistance(f.outer, roll_e, 1 / (1 / r_w - 1 / self.low_radius))
        f.inner_traction = self.traction(f.inner, roll_i, f.inner_slide, 1 / (1 / r_w + 1 / r_i))
        f.outer_traction = self.traction(f.outer, roll_e, f.outer_slide, 1 / (1 / r_w - 1 / self.low_radius))
        f.churning, _ = self.churning(f.orbit)
        if self.straight_churning:
            pitch_speed = self.pitch_radius * state.cage_speed
            force, slope = self.churning(pitch_speed)
            f.churning = force + slope * (f.orbit - pitch_speed)

        pocket_angle = state.cage_angle + 2 * np.pi * np.arange(self.rollers) / self.rollers
        f.pocket_outward = np.array([np.cos(pocket_angle), np.sin(pocket_angle)])
        f.pocket_along = ahead(f.pocket_outward)
        f.from_cage = state.place - state.cage[:, None]
        cage_there = state.cage_velocity[:, None] + state.cage_speed * ahead(f.from_cage)
        f.pocket_slide = dot(state.velocity - cage_there, f.pocket_outward)  # of the roller's centre past the wall
        f.pocket_rate = dot(state.velocity - cage_there, f.pocket_along)
        f.pocket, f.pocket_elastic, f.pocket_energy = self.pocket(
            dot(f.from_cage, f.pocket_along), f.pocket_rate, self.pocket_clearance, self.pocket_film_force
        )
        f.pocket_smooth = self.rubbing_in_pockets * state.spin / np.sqrt(state.spin**2 + 10.0**2)

        f.guide = f.guide_elastic = f.guide_energy = f.guide_rate = np.zeros(self.rollers)
        if self.guidance == "roller":
            f.land = self.no_land(state.cage)
            middle = self.low_radius + self.d_value / 2 - r_w
            f.guide_rate = f.pocket_slide
            offset = dot(f.from_cage, f.pocket_outward) - middle
            f.guide, f.guide_elastic, f.guide_energy = self.pocket(offset, f.guide_rate, self.pocket_radial_clearance, 0.0)
        else:
            f.land = self.land(state.cage, state.cage_velocity, state.cage_speed, state.ring, state.ring_velocity)
        f.bore_torque = self.couette(omega_i - state.cage_speed, self.inside, self.inside - r_i, self.inside_width)
        gap = self.low_radius - self.outside
        f.case_torque = -self.couette(state.cage_speed, self.outside, gap, self.outside_width) - self.end_faces(state.cage_speed)
        return f

    def accelerations(self, f):
        """Of ring, cage, cage angle, rollers and spins, under the forces ``f``."""
        r_w = self.roller_radius
        inner = f.inner * f.normal + (f.inner_traction + self.pushing[0] * f.inner_resistance) * ahead(f.normal)
        outer = -f.outer * f.outward + (f.outer * f.lean + f.outer_traction - self.pushing[1] * f.outer_resistance) * f.along
        # a wall pushes back along the orbit, and its friction drags along the wall, against the turning surface
        pocket = -f.pocket * (f.pocket_along + f.pocket_smooth * f.pocket_outward)
        guide = -f.guide * (f.pocket_outward - f.pocket_smooth * f.pocket_along)
        rubbed = f.pocket_smooth * (magnitude(f.pocket) + magnitude(f.guide))
        spin_torque = r_w * (f.inner_traction - f.outer_traction - f.inner_resistance - f.outer_resistance - rubbed)
        touch = f.from_cage + np.where(np.real(f.pocket) >= 0, r_w, -r_w) * f.pocket_along
        guide_touch = f.from_cage + np.where(np.real(f.guide) >= 0, r_w, -r_w) * f.pocket_outward
        cage_torque = f.land.torque + f.bore_torque + f.case_torque + np.sum(cross(touch, -pocket)) + np.sum(cross(guide_touch, -guide))
        on_ring = f.land.force if self.guidance == "inner_ring" else 0 * f.land.force
        return (
            (np.array(self.load) - inner.sum(1) - on_ring) / self.ring_mass,
            (f.land.force - pocket.sum(1) - guide.sum(1)) / self.cage_mass,
            cage_torque / self.cage_inertia,
            (inner + outer + pocket + guide - f.churning * f.along) / self.mass,
            spin_torque / self.roller_inertia,
        )

    def powers(self, f):
        """Work done on the bearing, and heat by cause [W]."""
        state, omega_i, omega = f.state, self.shaft_speed, f.state.cage_speed
        wall_slide = f.pocket * f.pocket_slide + magnitude(f.pocket) * self.roller_radius * (state.spin + omega)
        wall_slide = wall_slide - f.guide * f.pocket_rate + magnitude(f.guide) * self.roller_radius * (state.spin + omega)
        turning = omega_i if self.guidance == "inner_ring" else 0.0
        work = {
            "shaft": omega_i * (self.raceway * (f.inner_traction + f.inner_resistance).sum() + f.bore_torque) - turning * f.land.on_ring,
            "load": dot(self.load, state.ring_velocity),
        }
        heat = {
            "inner traction": np.sum(f.inner_traction * f.inner_slide),
            "outer traction": np.sum(f.outer_traction * f.outer_slide),
            "inner rolling": np.sum(2 * f.inner_resistance * f.roll_i),
            "outer rolling": np.sum(2 * f.outer_resistance * f.roll_e),
            "normal damping": np.sum((f.inner - f.inner_elastic) * f.inner_rate + (f.outer - f.outer_elastic) * f.outer_rate),
            "pocket damping": np.sum((f.pocket - f.pocket_elastic) * f.pocket_rate + (f.guide - f.guide_elastic) * f.guide_rate),
            "pocket friction": np.sum(f.pocket_smooth * wall_slide),
            "churning": np.sum(f.churning * f.orbit),
            "guide land film": f.land.film_heat,
            "guide land contact": f.land.touch_heat,
            "mixture on the cage": f.bore_torque * (omega_i - omega) - f.case_torque * omega,
        }
        return work, heat

    def energy(self, f):
        """Kinetic and elastic energy [J]."""
        state = f.state
        kinetic = (
            self.ring_mass * dot(state.ring_velocity, state.ring_velocity)
            + self.cage_mass * dot(state.cage_velocity, state.cage_velocity)
            + self.cage_inertia * state.cage_speed**2
            + np.sum(self.mass * dot(state.velocity, state.velocity) + self.roller_inertia * state.spin**2)
        ) / 2
        return kinetic + np.sum(f.inner_energy + f.outer_energy + f.pocket_energy + f.guide_energy) + f.land.energy

    def momentum(self, state):
        """Linear momentum, shape (2,), and angular momentum about the outer ring's centre of all that moves but the shaft's turning."""
        linear = self.ring_mass * state.ring_velocity + self.cage_mass * state.cage_velocity + self.mass * state.velocity.sum(1)
        angular = (
            self.ring_mass * cross(state.ring, state.ring_velocity)
            + self.cage_mass * cross(state.cage, state.cage_velocity)
            + self.cage_inertia * state.cage_speed
            + np.sum(self.mass * cross(state.place, state.velocity) - self.roller_inertia * state.spin)
        )
        return linear, angular

    def impulses(self, f):
        """Force on the whole from outside, shape (2,), and its moment about the outer ring's centre with the shaft's torque.

        The shaft's torque acts where the roller has its inner contact, a roller radius from its centre.
        """
        state = f.state
        on_rollers = -f.outer * f.outward + (f.outer * f.lean + f.outer_traction - f.churning) * f.along
        inner_land = self.guidance == "inner_ring"
        land_force = 0 * f.land.force if inner_land else f.land.force
        force = np.array(self.load) + on_rollers.sum(1) + land_force
        shaft = np.sum(f.inner_traction * (f.distance - self.roller_radius)) + f.bore_torque
        moment = cross(state.ring, self.load) + np.sum(cross(state.place, on_rollers) + self.roller_radius * f.outer_traction)
        # through lands of its own the shaft turns the cage and pushes it, and is pushed back
        land = -f.land.on_ring if inner_land else cross(state.cage, land_force) + f.land.torque
        return force, moment + land + f.case_torque + shaft
