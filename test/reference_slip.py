# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A plain NumPy model of level ``slip``, for comparison: one file, no code shared with the package, written from the equations.

Slow and readable: loads by root finding on one roller at a time and a general equation solver for the ring, traction by the
published powers, no Jacobian.  Integrated by scipy's Radau.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root


@dataclass
class Reference:
    """Bearing of Deng 2017, Table 1 (SI), 45,000 rpm, MIL-L-7808 at 120 degC, with the defaults of the package for what it leaves open."""

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

    def __post_init__(self):
        self.pitch_radius = self.inner_radius + self.roller_radius
        self.mass = np.pi * self.roller_radius**2 * self.length * 7850.0
        eta = 2 * (1 - 0.3**2) / 2.06e5  # 1/MPa
        self.stiffness = (7.0 ** (8 / 9)) / (1.36 * eta**0.9) ** (10 / 9) * 1000 ** (10 / 9)
        self.modulus = 2 / (2 * (1 - 0.3**2) / 2.06e11)
        self.temperature = 393.15
        self.viscosity = 9.997e-4 * (np.exp(np.exp(22.216 - 3.7048 * np.log(393.15))) - 0.87)
        self.density = self.mixture_fraction * (914 + (870 - 914) * (393.15 - 367) / (422 - 367))
        self.pitch_angles = 2 * np.pi * np.arange(self.rollers) / self.rollers
        self.ring = np.zeros(2)
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

        found = root(residual, self.ring * 1e6, tol=1e-11)
        assert np.abs(residual(found.x)).max() < 1e-5, found.message
        self.ring = found.x * 1e-6
        inner, outer_penetration = balance(self.ring)
        return inner, inner + centrifugal, contour - self.roller_radius + outer_penetration, slope, azimuth, self.ring

    def traction_coefficient(self, load, rolling, sliding, curvature_radius):
        """Odd in the sliding speed (Deng 2017, ref. 17, as physics books print it)."""
        rolling = np.abs(rolling)
        load = np.maximum(load, 1e-3)
        w = load / (self.modulus * curvature_radius**2)
        u = self.viscosity * rolling / (self.modulus * curvature_radius)
        t = 0.0966 * self.temperature / (self.viscosity * rolling**2)
        a = -696 * w**-0.163 * u**0.577 * t**0.308
        b = 5.19e6 * w**-0.373 * u * t**0.687
        c = 6.826e5 * w**-0.170 * u**0.578 * t**0.373
        s = np.abs(sliding) / rolling
        return np.sign(sliding) * ((a + b * s) * np.exp(-c * s) - a)

    def cage_drag(self, omega):
        """Torque of lands and mixture on the cage body."""
        eta, rho = self.viscosity, self.density
        guide, clearance, inside, width, land = 33.5e-3, 0.15e-3, 29.6e-3, 12e-3, 5e-3
        outside = guide - clearance

        def couette(speed, radius, gap, length):
            reynolds = rho * abs(speed) * radius * gap / eta
            factor = max(1.0, 1.3 * (reynolds * np.sqrt(gap / radius) / 41) ** 0.539, 3.0 * (reynolds / 2500) ** 0.856)
            return 2 * np.pi * eta * radius**3 * speed * length / gap * factor

        reynolds = rho * omega * outside**2 / eta
        assert reynolds < 2.5e5
        faces = 0.5 * rho * omega**2 * (outside**5 - inside**5) * 3.87 * reynolds**-0.5
        lands = 2 * np.pi * eta * (guide * omega) * guide**2 * land / clearance
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

        def inner_traction(faster):
            return inner * self.traction_coefficient(inner, roll_i, slide_i + faster, 1 / (1 / r_w + 1 / r_i))

        def outer_traction(faster):
            return outer * self.traction_coefficient(outer, roll_e, slide_e + faster, 1 / (1 / r_w - 1 / self.low_radius))

        traction_i, traction_e = inner_traction(0.0), outer_traction(0.0)
        lean = (outer * slope + inner * (ring_y * np.sin(azimuth) - ring_z * np.cos(azimuth))) / radius
        along = traction_i + traction_e - self.churning(omega) + lean - 2 * self.mass * slope * omega**2
        cage_inertia = 0.05 * self.pitch_radius**2
        acceleration = (radius @ along + self.cage_drag(omega)) / (cage_inertia + self.mass * radius @ radius)
        driven = along - self.mass * radius * acceleration
        pocket = self.pocket_forces(driven, inner_traction, outer_traction, omega)
        self.pocket, self.pocket_without_play = pocket, driven
        braking = self.pocket_friction * np.abs(pocket) * r_w * spin / np.sqrt(spin**2 + 10.0**2)
        spin_acceleration = (r_w * (traction_i - traction_e) - braking) / (0.5 * self.mass * r_w**2)
        return np.concatenate([[omega, acceleration], spin_acceleration])

    def slip(self, times, rtol=1e-6):
        """Cage slip at times [s], from ideal rolling."""
        gamma = self.roller_radius / self.pitch_radius
        ideal = self.shaft_speed * (1 - gamma) / 2
        start = np.concatenate([[0.0, ideal], np.full(self.rollers, ideal * self.pitch_radius / self.roller_radius)])
        solution = solve_ivp(self.rate, (0.0, times[-1]), start, "Radau", t_eval=times, rtol=rtol, atol=1e-4, max_step=5e-5)
        assert solution.success, solution.message
        return 1 - solution.y[1] / ideal
