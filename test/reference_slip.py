# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A plain NumPy model of level ``slip``, for comparison: no code shared with the package, written from the equations; films in `reference_films`.

Slow and readable: loads by root finding on one roller at a time and a general equation solver for the ring, traction by the
published powers, no Jacobian.  Integrated by scipy's Radau.
"""

from dataclasses import dataclass, field

import numpy as np
from reference_films import Oil, couette_factor, films_of, hydrodynamic_resistance
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root


@dataclass
class Reference:
    """Bearing of Deng 2017, Table 1 (SI), 45,000 rpm, MIL-L-7808 at 120 degC, with the defaults of the package for what it leaves open.

    ``films`` are fields of `reference_films.Films`.
    """

    low_radius: float = 34.8625e-3
    d_value: float = 0.098e-3
    installation_angle: float = 0.0
    shaft_speed: float = 45000 * np.pi / 30
    load: float = 800.0
    rollers: int = 18
    roller_radius: float = 3.5e-3
    length: float = 7e-3
    inner_radius: float = 27.875e-3
    mixture_fraction: float = 0.03
    pocket_friction: float = 0.05
    pocket_clearance: float = 1e-4
    pocket_film_force: float = 67.0
    pocket_film_damping: float = 5.0
    temperature: float = 393.15
    bore: float = 50.027e-3  # boundary diameters
    outer_diameter: float = 73.4e-3
    cage_mass: float = 0.05
    cage_width: float = 12e-3
    cage_outside: float = 33.35e-3
    cage_inside: float = 29.6e-3
    land_width: float = 2.5e-3  # of each of two
    land_radius: float = 33.5e-3
    guide_clearance: float = 0.15e-3
    land_vortices: bool = False
    rolling_resistance: bool = False
    rubbing_in_pockets: float | None = None  # coefficient of friction there; None: that of pocket_friction and asperities
    films: dict = field(default_factory=dict)

    def __post_init__(self):
        self.pitch_radius = self.inner_radius + self.roller_radius
        self.mass = np.pi * self.roller_radius**2 * self.length * 7850.0
        eta = 2 * (1 - 0.3**2) / 2.06e5  # 1/MPa
        self.stiffness = (self.length * 1e3) ** (8 / 9) / (1.36 * eta**0.9) ** (10 / 9) * 1000 ** (10 / 9)
        self.modulus = 2 / (2 * (1 - 0.3**2) / 2.06e11)
        self.oil = Oil(self.temperature)
        self.viscosity = self.oil.viscosity
        self.density = self.mixture_fraction * self.oil.density
        self.pitch_angles = 2 * np.pi * np.arange(self.rollers) / self.rollers
        play = self.low_radius - self.inner_radius - 2 * self.roller_radius
        self.ring = np.array([1.3 * max(play, 0.0), 0.0])
        self.film = films_of(self)
        if self.rubbing_in_pockets is None:
            self.rubbing_in_pockets = self.film.mixed(self.pocket_friction)
        self.pocket = self.pocket_without_play = np.zeros(self.rollers)  # of the last rate, what pockets take from their rollers [N]

    def contour(self, azimuth):
        half = self.d_value / 2
        phase = 3 * (azimuth - self.installation_angle)
        return self.low_radius + half - half * np.cos(phase), 3 * half * np.sin(phase)

    def roller_balance(self, approach, centrifugal):
        """Inner load and outer penetration of one roller."""
        free = (centrifugal / self.stiffness) ** 0.9
        if approach <= free:
            return 0.0, free

        def residual(outer):
            return self.stiffness * (outer ** (10 / 9) - (approach - outer) ** (10 / 9)) - centrifugal

        outer = brentq(residual, approach / 2, approach, xtol=1e-15, rtol=1e-14)
        return self.stiffness * (approach - outer) ** (10 / 9), outer

    def loads(self, theta, cage_speed):
        """Inner and outer loads, orbit radii, contour slopes, azimuths and ring position at a cage angle."""
        azimuth = theta + self.pitch_angles
        contour, slope = self.contour(azimuth)
        centrifugal = self.mass * (contour - self.roller_radius) * cage_speed**2
        direction = np.array([np.cos(azimuth), np.sin(azimuth)])

        def balance(ring):
            approach = self.inner_radius + 2 * self.roller_radius - contour + ring @ direction
            return np.array([self.roller_balance(a, c) for a, c in zip(approach, centrifugal)]).T

        def residual(micrometres):
            inner, _ = balance(micrometres * 1e-6)
            return direction @ inner - [self.load, 0.0]

        for further in (0.0, 10.0, 30.0, 100.0):  # the hybrid method may stop where rollers let go: then it begins where they are pressed
            found = root(residual, self.ring * 1e6 + [further, 0.0], tol=1e-11)
            if np.abs(residual(found.x)).max() < 1e-5:
                break
        assert np.abs(residual(found.x)).max() < 1e-5, found.message
        self.ring = found.x * 1e-6
        inner, outer_penetration = balance(self.ring)
        return inner, inner + centrifugal, contour - self.roller_radius + outer_penetration, slope, azimuth, self.ring

    def traction(self, load, rolling, sliding, curvature_radius):
        """Force, odd in the sliding speed (Deng 2017, ref. 17, as physics books print it); rolling is kept off zero, where the powers run away."""
        rolled, rolling = rolling, np.hypot(rolling, 0.05)
        w = np.maximum(load, 1e-3) / (self.modulus * curvature_radius**2)
        u = self.viscosity * rolling / (self.modulus * curvature_radius)
        t = 0.0966 * self.temperature / (self.viscosity * rolling**2)
        a = -696 * w**-0.163 * u**0.577 * t**0.308
        b = 5.19e6 * w**-0.373 * u * t**0.687
        c = 6.826e5 * w**-0.170 * u**0.578 * t**0.373
        s = np.abs(sliding) / rolling
        return self.film.traction(load, rolled, sliding, load * np.sign(sliding) * ((a + b * s) * np.exp(-c * s) - a))

    def resistance(self, load, rolling, curvature_radius):
        force = self.film.losses_of_rolling(load, rolling, curvature_radius, self.modulus)
        if self.rolling_resistance:
            force = force + self.film.resistance * hydrodynamic_resistance(load, rolling, curvature_radius, self.oil, self.modulus, self.length)
        return force

    def cage_drag(self, omega):
        """Torque of lands and mixture on the cage body."""
        eta, rho = self.viscosity, self.density
        guide, clearance, land = self.land_radius, self.guide_clearance, 2 * self.land_width
        outside, inside, width = self.cage_outside, self.cage_inside, self.cage_width

        def couette(speed, radius, gap, length):
            return 2 * np.pi * eta * radius**3 * speed * length / gap * couette_factor(speed, radius, gap, rho, eta)

        reynolds = rho * omega * outside**2 / eta
        assert reynolds < 2.5e5
        faces = 0.5 * rho * omega**2 * (outside**5 - inside**5) * 3.87 * reynolds**-0.5
        lands = 2 * np.pi * eta * (guide * omega) * guide**2 * land / clearance
        if self.land_vortices:  # lands are full of oil
            lands *= couette_factor(omega, guide, clearance, self.oil.density, eta)
        outer_face = couette(omega, outside, self.low_radius - outside, width - land)
        inner_face = couette(self.shaft_speed - omega, inside, inside - self.inner_radius, width)
        return inner_face - lands - outer_face - faces

    def churning(self, omega):
        speed = self.pitch_radius * omega
        reynolds = self.density * speed * 2 * self.roller_radius / self.viscosity
        points = [1e-1, 1, 10, 100, 1e3, 1e4, 2e5, 3e5, 4e5, 5e5, 1e6]
        values = [60, 10, 3, 1.8, 1.0, 1.2, 1.2, 0.9, 0.65, 0.3, 0.3]
        coefficient = np.exp(np.interp(np.log(reynolds), np.log(points), np.log(values)))
        return 0.5 * self.density * coefficient * self.length * 2 * self.roller_radius * speed**2

    def pocket_forces(self, driven, inner, outer, omega):
        """What pockets with play take from their rollers, which drives each by ``driven``; tractions are functions of a change of sliding speed."""

        def slope(traction):
            return np.maximum((traction(1e-7) - traction(-1e-7)) / 2e-7, 0.0)

        # a roller that gains on the cage by a speed of 1 spins faster by s, so that its tractions do not turn it: i (1 + s) = e (1 - s)
        i, e = slope(inner), slope(outer)
        faster = np.divide(e - i, e + i, out=np.zeros_like(i), where=e + i > 0)
        held = i * (1 + faster) + e * (1 - faster)
        time = 1 / (2 * omega)
        film = self.pocket_film_damping + self.pocket_film_force / self.pocket_clearance * time
        moved = np.abs(driven) * time / (held + film)
        soft = film / (film + held)
        felt = soft + (1 - soft) * moved / (moved + self.pocket_clearance)
        shared = driven @ (1 - felt) / max(np.sum(1 - felt), 1e-300)
        return felt * driven + (1 - felt) * shared

    def rate(self, t, y):
        theta, omega, spin = y[0], y[1], y[2:]
        inner, outer, radius, slope, azimuth, (ring_y, ring_z) = self.loads(theta, omega)
        r_w, r_i, omega_i = self.roller_radius, self.inner_radius, self.shaft_speed
        orbital = radius * omega
        slide_i, slide_e = omega_i * r_i - (orbital + spin * r_w), -(orbital - spin * r_w)
        roll_i = ((omega_i - omega) * r_i + (spin + omega) * r_w) / 2
        roll_e = (omega * (radius + r_w) + (spin + omega) * r_w) / 2

        curved_i, curved_e = 1 / (1 / r_w + 1 / r_i), 1 / (1 / r_w - 1 / self.low_radius)

        def inner_traction(faster):
            return self.traction(inner, roll_i, slide_i + faster, curved_i)

        def outer_traction(faster):
            return self.traction(outer, roll_e, slide_e + faster, curved_e)

        traction_i, traction_e = inner_traction(0.0), outer_traction(0.0)
        resistance_i, resistance_e = self.resistance(inner, roll_i, curved_i), self.resistance(outer, roll_e, curved_e)
        lean = (outer * slope + inner * (ring_y * np.sin(azimuth) - ring_z * np.cos(azimuth))) / radius
        along = traction_i + traction_e - self.churning(omega) + lean - 2 * self.mass * slope * omega**2
        along = along + (1 - 2 * r_w / radius) * resistance_i - (1 + 2 * r_w / radius) * resistance_e
        cage_inertia = self.cage_mass * self.pitch_radius**2
        acceleration = (radius @ along + self.cage_drag(omega)) / (cage_inertia + self.mass * radius @ radius)
        driven = along - self.mass * radius * acceleration
        pocket = self.pocket_forces(driven, inner_traction, outer_traction, omega)
        self.pocket, self.pocket_without_play = pocket, driven
        braking = self.rubbing_in_pockets * np.abs(pocket) * r_w * spin / np.sqrt(spin**2 + 10.0**2)
        spin_acceleration = (r_w * (traction_i - traction_e - resistance_i - resistance_e) - braking) / (0.5 * self.mass * r_w**2)
        return np.concatenate([[omega, acceleration], spin_acceleration])

    def slip(self, times, rtol=1e-6):
        """Cage slip at times [s], from ideal rolling."""
        gamma = self.roller_radius / self.pitch_radius
        ideal = self.shaft_speed * (1 - gamma) / 2
        start = np.concatenate([[0.0, ideal], np.full(self.rollers, ideal * self.pitch_radius / self.roller_radius)])
        solution = solve_ivp(self.rate, (0.0, times[-1]), start, "Radau", t_eval=times, rtol=rtol, atol=1e-4, max_step=5e-5)
        assert solution.success, solution.message
        return 1 - solution.y[1] / ideal
