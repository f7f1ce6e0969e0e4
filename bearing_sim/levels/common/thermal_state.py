# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thermal network of a run: temperatures that advance beside a level, heated by the losses that the level's samples hold.

Temperatures change by seconds, a bearing moves by microseconds.  So losses are summed call by call, and at most once in an interval of
simulated time the network takes a step, from whose temperatures radii, viscosities and tractions follow.  A measured ring temperature then
corrects all nodes by a Kalman filter in its steady state: its gain belongs to the scene's operating point and the length of the step.
"""

import copy
import math

import numpy as np

from bearing_sim.model.params import Lubrication, Params
from bearing_sim.model.sample import COLUMN, NODE_OBSERVABLES, SCALARS
from bearing_sim.model.temperatures import local_model
from bearing_sim.model.thermal_network import POWERS, fit_gaps, start_temperatures, thermal_network
from bearing_sim.numerics.compilation import compiled_for
from bearing_sim.physics.growth import seats_at
from bearing_sim.physics.thermal_filter import filter_gain, network_matrix
from bearing_sim.physics.thermal_network import BOOK, NODE, NODES, HeatCourse, NetworkInputs, new_work, settle, step, write_conductances
from bearing_sim.scene.scene import Scene

_TEMPERATURES = slice(getattr(COLUMN, NODE_OBSERVABLES[0]), getattr(COLUMN, NODE_OBSERVABLES[-1]) + 1)
THERMAL = slice(COLUMN.shaft_temperature, COLUMN.outer_ring_temperature_uncorrected + 1)
"""Columns of a flat sample that hold temperatures and flows of heat."""
_POWERS = slice(getattr(COLUMN, POWERS[0]), getattr(COLUMN, POWERS[-1]) + 1)
_RINGS = (NODE.inner_ring, NODE.outer_ring)
_UNCORRECTED = slice(COLUMN.inner_ring_temperature_uncorrected, COLUMN.outer_ring_temperature_uncorrected + 1)
_LOADED = 0.3  # fraction of the rollers that a typical load rests on


class ThermalState:
    """Temperatures of the nodes in time.

    Parameters
    ----------
    scene : whose `heat.law` is network.
    params : of its bearing.
    inlet : temperature of the oil at the start [K].

    Attributes
    ----------
    temperatures : of the nodes [K], shape (NODES,), see `bearing_sim.physics.thermal_network.NODE`.
    uncorrected : the same without what measured temperatures have corrected; None before the first of them.
    flows : heat to the oil and to ambient over the last step [W], shape (2,).
    books : of energy since the start [J], shape (4,), see `bearing_sim.physics.thermal_network.BOOK`.
    corrected : energy that corrections by measured temperatures have put into the nodes [J].
    held : whether the temperatures stay as they are.
    """

    def __init__(self, scene: Scene, params: Params, inlet: float):
        self.network = thermal_network(scene, params)
        self._values = np.full(THERMAL.stop - THERMAL.start, math.nan)  # as a sample has them
        self.temperatures, self.flows = self._values[:NODES], self._values[NODES : -len(_RINGS)]
        self.temperatures[:] = start_temperatures(scene.heat, inlet)
        self.uncorrected: np.ndarray | None = None
        self.books, self.corrected, self.held = np.zeros(len(BOOK)), 0.0, False
        self._seats, self._gaps = np.zeros(4), fit_gaps(scene)  # see `bearing_sim.physics.growth.seats_at`
        self._since = np.zeros(3)  # time since the last step [s], and the angles of shaft and cage then [rad]
        self._scene, self._work = scene, new_work()
        self._interval = scene.heat.interval * (1.0 - 1e-9)
        self._compiled = None
        self._gains: dict[tuple[float, bool, bool], np.ndarray] = {}
        self._losses, self._loads = np.zeros(len(POWERS)), np.zeros((2, params.rollers.count))
        self._forget()

    def _forget(self) -> None:
        self._losses[:] = 0.0  # [J] by cause
        self._since[:] = 0.0

    def copy(self) -> "ThermalState":
        """Return an independent state with the same temperatures, books and losses."""
        other = copy.copy(self)
        other._values = self._values.copy()
        other.temperatures, other.flows = other._values[:NODES], other._values[NODES : -len(_RINGS)]
        other.books, other._losses, other._loads, other._work = self.books.copy(), self._losses.copy(), self._loads.copy(), new_work()
        other._seats, other._since = self._seats.copy(), self._since.copy()
        other.uncorrected = None if self.uncorrected is None else self.uncorrected.copy()
        return other

    def take_over(self, other: "ThermalState") -> None:
        """Continue from the temperatures, the books and the losses not yet taken of another state of the same bearing."""
        self.temperatures[:], self.books[:], self.flows[:] = other.temperatures, other.books, other.flows
        self.uncorrected = None if other.uncorrected is None else other.uncorrected.copy()
        self.corrected, self.held = other.corrected, other.held
        self._losses[:], self._loads[:], self._since[:], self._seats[:] = other._losses, other._loads, other._since, other._seats

    def resume(self, row: np.ndarray) -> None:
        """Continue from the temperatures of a recorded sample, laid out flat; they stay as they are where it has none."""
        if np.isfinite(row[_TEMPERATURES]).all():
            self._values[:] = row[THERMAL]
            if np.isfinite(row[_UNCORRECTED]).all() and (row[_UNCORRECTED] != self.temperatures[list(_RINGS)]).any():
                self.uncorrected = self.temperatures.copy()  # a sample holds those of the rings alone
                self.uncorrected[list(_RINGS)] = row[_UNCORRECTED]
        self._forget()

    def model(self, params: Params, inlet: float, shaft_speed: float) -> tuple[Params, Lubrication]:
        """Return parameters and lubrication at the present temperatures, and let the fits follow.

        Parameters
        ----------
        params : of the bearing before its temperatures change it.
        inlet : temperature of the oil that comes in [K].
        shaft_speed : [rad/s].
        """
        warm, lubrication = local_model(self._scene, params, inlet, self.temperatures)
        self._seats[:] = seats_at(shaft_speed, lubrication.growth, params.mounted, self._gaps)
        return warm, lubrication

    def course(self) -> HeatCourse:
        """Return the same state as compiled code advances it along a course of inputs; its arrays are those of this state."""
        return HeatCourse(
            self.network,
            self._work,
            self.temperatures,
            self._losses,
            self._loads,
            self._since,
            self._seats,
            self._gaps,
            self.flows,
            self.books,
            self._interval,
        )

    def write(self, rows: np.ndarray) -> None:
        """Write temperatures and flows of heat into samples, laid out flat."""
        nodes = self.temperatures if self.uncorrected is None else self.uncorrected
        self._values[-2], self._values[-1] = nodes[NODE.inner_ring], nodes[NODE.outer_ring]
        rows[..., THERMAL] = self._values

    def record_losses(self, before: np.ndarray, rows: np.ndarray, duration: float, inlet: float, measured: tuple[float, float]) -> bool:
        """Take the losses of a call, and step where an interval is over; return whether temperatures have changed.

        Parameters
        ----------
        before : sample before the call, laid out flat.
        rows : samples of the call, evenly spaced, laid out flat; the temperatures at its end are written into the last.
        duration : of the call [s].
        inlet : temperature of the oil that comes in [K].
        measured : temperatures of inner and outer ring [K]; NaN where they are not measured.
        """
        since = self._since
        if since[0] == 0.0:
            since[1:] = before[COLUMN.shaft_angle], before[COLUMN.cage_angle]
        self._losses += duration / len(rows) * np.add.reduce(rows[:, _POWERS], axis=0)
        since[0] += duration
        if since[0] < self._interval:
            return False
        last = rows[-1]
        count = self._loads.shape[1]
        for side, column in enumerate((COLUMN.inner_load, COLUMN.outer_load)):
            self._loads[side] = last[SCALARS + column * count : SCALARS + (column + 1) * count]
        speeds = (last[COLUMN.shaft_angle] - since[1]) / since[0], (last[COLUMN.cage_angle] - since[2]) / since[0]
        changed = self._advance(speeds, inlet, measured) if not self.held else False
        self._forget()
        self.write(last)
        return changed

    def rest(self, samples: np.ndarray, inlet: float) -> np.ndarray:
        """Return the temperatures of the nodes at which the mean losses of samples leave [K], shape (NODES,).

        Parameters
        ----------
        samples : of a settled run, see `bearing_sim.model.sample`.
        inlet : temperature of the oil that comes in [K].
        """
        losses = np.array([samples[name].mean() for name in POWERS])
        loads = np.ascontiguousarray([samples["inner_load"][-1], samples["outer_load"][-1]])
        inputs = NetworkInputs(float(samples["shaft_speed"].mean()), float(samples["cage_speed"].mean()), inlet, *self._seats.tolist())
        nodes = self.temperatures.copy()
        settle(nodes, losses, loads, inputs, self.network, np.zeros(NODES), self._work)
        return nodes

    def _advance(self, speeds: tuple[float, float], inlet: float, measured: tuple[float, float]) -> bool:
        elapsed = float(self._since[0])
        if self.uncorrected is None and any(map(math.isfinite, measured)):
            self.uncorrected = self.temperatures.copy()
        inputs = NetworkInputs(*map(float, speeds), inlet, *self._seats.tolist())
        arguments = (elapsed, self.temperatures, self._losses / elapsed, self._loads, inputs, self.network, self._work)
        (self._compiled or step)(*arguments)
        if self._compiled is None:
            self._compiled = compiled_for(step, arguments)
        books = self._work.books
        self.books += books
        self.flows[0], self.flows[1] = books[BOOK.to_oil] / elapsed, books[BOOK.to_ambient] / elapsed
        if self.uncorrected is not None:
            self._compiled(elapsed, self.uncorrected, *arguments[2:])
        self._correct(elapsed, measured)
        return True

    def _correct(self, elapsed: float, measured: tuple[float, float]) -> None:
        seen = tuple(math.isfinite(reading) for reading in measured)
        if not any(seen):
            return
        places = [node for node, is_seen in zip(_RINGS, seen) if is_seen]
        key = (float(f"{elapsed:.3g}"), *seen)
        if key not in self._gains:
            noise = self._scene.heat.filter
            walks = np.array([noise.shaft, noise.inner_ring, noise.rollers, noise.outer_ring, noise.housing, noise.oil])
            self._gains[key] = filter_gain(self._matrix(), key[0], walks, places, noise.sensor)
        innovation = np.array([reading for reading, is_seen in zip(measured, seen) if is_seen]) - self.temperatures[places]
        correction = self._gains[key] @ innovation
        self.temperatures[:] += correction
        self.corrected += float(self.network.capacities @ correction)

    def _matrix(self) -> np.ndarray:
        """Return the matrix of dT/dt = A T [1/s] at the scene's operating point, all parts as warm as the oil."""
        scene, work, count = self._scene, new_work(), self._loads.shape[1]
        speed, inlet = scene.operating.shaft_speed, scene.lubricant.temperature
        loads = np.zeros((2, count))
        loads[:, : max(round(_LOADED * count), 1)] = scene.operating.radial_load / max(_LOADED * count, 1.0)
        inputs = NetworkInputs(speed, 0.5 * speed * (1.0 - scene.bearing.diameter_ratio), inlet, 0.0, 0.0, 0.0, 0.0)
        write_conductances(np.full(NODES, inlet), loads, inputs, self.network, work.conductances)
        return network_matrix(work.conductances, self.network.capacities)
