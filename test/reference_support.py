# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Plain NumPy models of a carried bearing, for comparison: bodies in coordinates that do not move, springs and dampers between them.

The forces inside the bearing are those of `reference_planar` or `reference_spatial`, which see only where bodies are from each other.
"""

from dataclasses import dataclass, fields, replace

import numpy as np


@dataclass
class Carried:
    """What stands around a bearing.

    Attributes
    ----------
    bearing : `reference_planar.Reference` or `reference_spatial.SpatialReference`.
    plain : ``plain(state) -> record`` of its test, from the states of the level without a support.
    rate_of : ``rate_of(bearing, state, forces) -> rate`` of its test.
    planar : the bearing's `reference_planar.Reference`.
    """

    bearing: object
    plain: object
    rate_of: object
    planar: object
    shaft_mass: float = 0.0  # 0: rigid on the ring
    shaft_stiffness: tuple = (0.0, 0.0)
    shaft_damping: tuple = (0.0, 0.0)
    outer_mass: float = 0.0  # 0: held
    outer_stiffness: tuple = (0.0, 0.0)
    outer_damping: tuple = (0.0, 0.0)
    film: tuple = ()  # radius, length, clearance
    unbalance: float = 0.0
    unbalance_angle: float = 0.0
    shaft_acceleration: float = 0.0

    def film_force(self, place, velocity):
        if not self.film:
            return 0 * place
        radius, length, clearance = self.film
        eccentricity = np.sqrt(place @ place)
        outward = place / eccentricity
        around = np.array([-outward[1], outward[0]])
        eps, unit = eccentricity / clearance, np.pi * self.planar.viscosity * radius * (length / clearance) ** 3
        return unit * ((1 + 2 * eps**2) / (1 - eps**2) ** 2.5 * (velocity @ outward) * outward + (velocity @ around) / (1 - eps**2) ** 1.5 * around)

    def around(self, tail, ring, ring_velocity, internal):
        """Accelerations in space by what is around the bearing, of ring, outer ring and shaft; heat of dampers; work of load and unbalance.

        Parameters
        ----------
        tail : outer ring and shaft, y and z each, then their velocities; the shaft's as the level has it, from the outer ring.
        ring, ring_velocity : of the inner ring in space.
        internal : force of the bearing on the outer ring.
        """
        outer, outer_velocity, load = tail[0:2], tail[4:6], np.array(self.planar.load)
        shaft, shaft_velocity = outer + tail[2:4], outer_velocity + tail[6:8]
        speed, angle = self.planar.shaft_speed, self.unbalance_angle
        towards, ahead = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        shaken = self.unbalance * (speed**2 * towards - self.shaft_acceleration * ahead)
        on_ring, on_shaft, heat = load + shaken, 0 * tail[0:2], 0.0
        driven_velocity = ring_velocity
        if self.shaft_mass:
            sprung = np.array(self.shaft_stiffness) * (shaft - ring) + np.array(self.shaft_damping) * (shaft_velocity - ring_velocity)
            on_ring, on_shaft = sprung, (load + shaken - sprung) / self.shaft_mass
            heat = heat + np.array(self.shaft_damping) @ (shaft_velocity - ring_velocity) ** 2
            driven_velocity = shaft_velocity
        on_outer = 0 * outer
        if self.outer_mass:
            damped = np.array(self.outer_damping) * outer_velocity + self.film_force(outer, outer_velocity)
            on_outer = (internal - np.array(self.outer_stiffness) * outer - damped) / self.outer_mass
            heat = heat + damped @ outer_velocity
        return on_ring / self.planar.ring_mass, on_outer, on_shaft, heat, (load @ driven_velocity, shaken @ driven_velocity)

    def whole(self, state):
        """Rate of a state of the level with its support, then the support's heat and the work of load and unbalance [W]."""
        level, tail = state[:-8], state[-8:]
        free = self.bearing_without_load()
        record = self.plain(level)
        forces = free.forces(record)
        accelerations = free.accelerations(forces)
        ring, cage, rollers = accelerations[0], accelerations[self.cage_at], accelerations[self.rollers_at]
        internal = -(self.planar.ring_mass * ring + self.planar.cage_mass * cage + self.planar.mass * rollers.sum(1))
        given = self.around(tail, record.ring + tail[0:2], record.ring_velocity + tail[4:6], internal)
        on_ring, on_outer, on_shaft, heat, work = given
        # in space every body has its own acceleration; the level sees all but the outer ring's from the outer ring
        seen = list(accelerations)
        seen[0], seen[self.cage_at] = ring + on_ring - on_outer, cage - on_outer
        seen[self.rollers_at] = rollers - on_outer[:, None]
        rate = np.zeros_like(state)
        rate[:-8] = self.rate_of(_Given(seen), level, forces)
        rate[-8:-4] = tail[4:8]
        rate[-4:-2] = on_outer
        if self.shaft_mass:
            rate[-2:] = on_shaft - on_outer
        return rate, heat, work, internal

    def rate(self, state):
        return self.whole(state)[0]

    def bearing_without_load(self):
        free = replace(self.planar, load=(0.0, 0.0))
        return free if self.bearing is self.planar else replace(self.bearing, **{_planar_field(self.bearing): free})

    @property
    def cage_at(self):
        return 1 if self.bearing is self.planar else 2

    @property
    def rollers_at(self):
        return 3 if self.bearing is self.planar else 5

    def stored(self, state):
        """Kinetic and elastic energy [J], kinetic energy of velocities in space."""
        record, tail = self.plain(state[:-8]), state[-8:]
        seen = self.bearing.energy(self.bearing.forces(record))
        outer = tail[4:6]
        bodies = [(self.planar.ring_mass, record.ring_velocity), (self.planar.cage_mass, record.cage_velocity)]
        bodies += [(self.planar.mass, velocity) for velocity in record.velocity.T]
        stored = seen + sum(mass * (velocity @ outer + outer @ outer / 2) for mass, velocity in bodies)
        if self.shaft_mass:
            bent, velocity = tail[2:4] - record.ring, outer + tail[6:8]
            stored += self.shaft_mass * velocity @ velocity / 2 + np.array(self.shaft_stiffness) @ bent**2 / 2
        return stored + self.outer_mass * outer @ outer / 2 + np.array(self.outer_stiffness) @ tail[0:2] ** 2 / 2


class _Given:
    """A bearing whose accelerations are known."""

    def __init__(self, accelerations):
        self._accelerations = tuple(accelerations)

    def accelerations(self, forces):
        return self._accelerations


def _planar_field(bearing):
    return next(each.name for each in fields(bearing) if type(getattr(bearing, each.name)).__name__ == "Reference")
