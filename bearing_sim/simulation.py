# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Simulation: owns time, state and workspace of one bearing; ``advance`` returns a block of samples."""

import math
import numbers
from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bearing_sim.levels.common.model import Drive, Model, Tolerances
from bearing_sim.levels.common.observation import TALLY
from bearing_sim.levels.common.state_transfer import start_means
from bearing_sim.levels.common.thermal_state import THERMAL, ThermalState
from bearing_sim.levels.level import LEVELS
from bearing_sim.model.oil import kinematic_viscosities
from bearing_sim.model.params import pack
from bearing_sim.model.sample import COLUMN, NODE_OBSERVABLES, RING_TEMPERATURES, flat, joined, new_block, sample_dtype
from bearing_sim.model.temperatures import given_temperatures, lubricate_scene
from bearing_sim.numerics.compilation import compiled_for
from bearing_sim.numerics.time_stepping import COUNT, NEEDS_POINT, NOT_EVALUATED, OK, REASONS, new_counts, new_memory
from bearing_sim.numerics.time_stepping import STEP_BUDGET as STEP_BUDGET  # noqa: F401, a status of `IntegrationError`
from bearing_sim.scene.fidelity import NUMBERS
from bearing_sim.scene.quantity import Quantity, to_si
from bearing_sim.scene.scene import OPERATING_POINT, Integration, Operating, Scene
from bearing_sim.scene.uncertainty import quantities

if TYPE_CHECKING:
    from bearing_sim.levels.steady.table import Table
    from bearing_sim.model.names import Block, Sample

_MEASURED_COLUMNS = slice(COLUMN.inner_ring_temperature_measured, COLUMN.outer_ring_temperature_measured + 1)
# What a workspace remembers of the past; everything else in it is found again at the next evaluation.
_REMEMBERED = ("tally", "load_moments", "last_moments", "lamina_powers", "lamina_last", "lamina_turn", "ring_stiffness")
_NO_MEANS: Mapping[str, np.ndarray] = MappingProxyType({})
_LONGEST_CALL = 2.0  # intervals of the thermal network
_FOUND_AGAIN = ("_dtype", "_level", "_compiled")  # attributes of a simulation that are code, or the same for all of their kind
_OWNS_ITS_DATA = 0x4  # flag of an array, which its type does not depend on
_compiled_versions: dict[Hashable, Callable] = {}
_FINEST_WITH_FIXED_STEP = Tolerances(position=2.5e-11, play=5e-11, speed=1e-7, relative=3e-7)


class Inputs(NamedTuple):
    """What drives the bearing from outside, and last the temperatures that are measured on it; in SI, NaN where they are not measured.

    `of` and `at` read texts with units.  `Simulation` checks that inputs are finite and within the bounds of a scene.
    """

    shaft_speed: float
    load_y: float
    load_z: float
    oil_temperature: float
    inner_ring_temperature: float = math.nan
    outer_ring_temperature: float = math.nan

    @classmethod
    def of(
        cls,
        *,
        shaft_speed: float | str,
        oil_temperature: float | str,
        radial_load: float | str = 0.0,
        load_angle: float | str = 0.0,
        inner_ring_temperature: float | str | None = None,
        outer_ring_temperature: float | str | None = None,
    ) -> "Inputs":
        """Return inputs from numbers in SI or texts with a unit, such as ``"3000 rpm"``, ``"5 kN"`` and ``"80 degC"``.

        Parameters
        ----------
        load_angle : azimuth of the radial load, from +y.
        inner_ring_temperature, outer_ring_temperature : measured; None where they are not.

        Raises
        ------
        ValueError
            A value is no such quantity, or out of the bounds that it has in a scene; the message has all of them.
        """
        return cls(0.0, 0.0, 0.0, math.nan).at(
            shaft_speed=shaft_speed,
            radial_load=radial_load,
            load_angle=load_angle,
            oil_temperature=oil_temperature,
            inner_ring_temperature=inner_ring_temperature,
            outer_ring_temperature=outer_ring_temperature,
        )

    def at(
        self,
        *,
        shaft_speed: float | str | None = None,
        radial_load: float | str | None = None,
        load_angle: float | str | None = None,
        oil_temperature: float | str | None = None,
        inner_ring_temperature: float | str | None = None,
        outer_ring_temperature: float | str | None = None,
    ) -> "Inputs":
        """Return the same inputs but for those that are given; values and errors as of `of`."""
        given = {
            "shaft_speed": shaft_speed,
            "radial_load": radial_load,
            "load_angle": load_angle,
            "oil_temperature": oil_temperature,
            "inner_ring_temperature": inner_ring_temperature,
            "outer_ring_temperature": outer_ring_temperature,
        }
        values, errors = {}, []
        for name, value in given.items():
            try:
                values |= {} if value is None else {name: _DECLARED[name].read(value)}
            except ValueError as error:  # pydantic's error of a quantity is one, too
                errors.append(f"{name} = {value!r}: {error}")
        if errors:
            raise ValueError("; ".join(errors))
        if "radial_load" in values or "load_angle" in values:
            load = values.pop("radial_load", math.hypot(self.load_y, self.load_z))
            angle = values.pop("load_angle", math.atan2(self.load_z, self.load_y))
            values |= {"load_y": load * math.cos(angle), "load_z": load * math.sin(angle)}
        return self._replace(**values)


# Declarations of the inputs as `Inputs.at` names them.
_DECLARED = {name: quantities(Scene)[path] for name, path in OPERATING_POINT.items()} | dict.fromkeys(
    RING_TEMPERATURES, Quantity("K", "measured temperature of a ring", 150.0, 800.0, "degC")
)
# The bounds of `Inputs`, by field.
_DECLARED_FIELDS = (
    _DECLARED["shaft_speed"],
    *[replace(_DECLARED["radial_load"], minimum=-_DECLARED["radial_load"].maximum)] * 2,
    _DECLARED["oil_temperature"],
    *(_DECLARED[name] for name in RING_TEMPERATURES),
)
_LOWEST, _HIGHEST = tuple(each.minimum for each in _DECLARED_FIELDS), tuple(each.maximum for each in _DECLARED_FIELDS)
_INPUT_OBSERVABLES = tuple(f"{name}_measured" if name in RING_TEMPERATURES else name for name in Inputs._fields)


class Counters(NamedTuple):
    """Work done since the start."""

    steps: int
    rejected_steps: int
    non_finite_steps: int
    right_hand_sides: int
    jacobians: int
    factorisations: int
    smallest_steps: int = 0  # taken at the smallest length whatever their error
    unsettled_points: int = 0  # operating points of level steady that have no steady state, taken as far as marching came


class IntegrationError(RuntimeError):
    """Time could not be advanced; the simulation keeps the state from before the call.

    Attributes
    ----------
    status : why, see `bearing_sim.numerics.time_stepping`; None where it is not known.
    """

    def __init__(self, message: str, status: int | None = None):
        super().__init__(message)
        self.status = status


def thermal_nodes(sample: np.void) -> np.ndarray:
    """Return the temperatures of the thermal network's nodes that a sample holds [K], shape (NODES,)."""
    return np.array([float(sample[name]) for name in NODE_OBSERVABLES])


def begin_at_temperatures(simulation: "Simulation", inputs: Inputs, nodes: np.ndarray, rings: np.ndarray) -> None:
    """Return a simulation with a thermal network to the start at inputs, as warm as another run has left the bearing.

    Parameters
    ----------
    nodes : temperatures of the network's nodes [K], shape (NODES,).
    rings : of inner and outer ring without what measured temperatures have corrected [K], shape (2,).
    """
    simulation.reset(inputs, nodes)
    uncorrected = nodes.copy()
    uncorrected[[NODE_OBSERVABLES.index(name) for name in RING_TEMPERATURES]] = rings
    if np.isfinite(rings).all() and (uncorrected != nodes).any():
        simulation.thermal.uncorrected = uncorrected
        simulation.set_temperatures(nodes, held=False)


def scene_inputs(scene: Scene) -> Inputs:
    """Return the operating conditions of a scene as inputs."""
    operating: Operating = scene.operating
    load_y, load_z = operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle)
    return Inputs(operating.shaft_speed, load_y, load_z, scene.lubricant.temperature)


def inputs_of(sample: np.void) -> Inputs:
    """Return the inputs that a sample holds (see `bearing_sim.model.sample`)."""
    return Inputs(*(float(sample[name]) for name in _INPUT_OBSERVABLES))


class Simulation:
    """One bearing in time.

    It can be copied (`copy.deepcopy`), pickled and sent to another process, and continues there to the last digit as it would have here.

    Parameters
    ----------
    scene : what to simulate.
    inputs : conditions at time 0; the scene's operating block where absent.
    table : of operating points, for level ``steady``; the one on disk where absent.  Without one each of them is solved.
    start : sample in whose positions and speeds to begin, see `reset`.
    nodes : temperatures of the thermal network's nodes to begin with, see `reset`.

    Raises
    ------
    IntegrationError
        The scene asks for a corrected table, and there is none on disk; or as of `reset`.
    """

    def __init__(
        self, scene: Scene, inputs: Inputs | None = None, table: "Table | None" = None, start: np.void | None = None, nodes: np.ndarray | None = None
    ):  # fmt: skip
        if not isinstance(scene, Scene):
            raise TypeError(f"scene = {scene!r}: expected a Scene; load_scene reads one by name or from a file: Simulation(load_scene(...))")
        self.scene = scene
        self._params, self._tolerances = pack(scene), tolerances_of(scene.integration)
        self._dtype = sample_dtype(self._params.rollers.count)
        self._cold = self._params  # before temperatures change them
        self._level = LEVELS[scene.level]
        self._thermal: ThermalState | None = None  # of a thermal network
        self._temperatures = np.full(THERMAL.stop - THERMAL.start, math.nan)  # without one: those that are given
        self._tables = ()  # what the level's workspace is made of besides the parameters
        if self._level.advance_profile is not None:
            from bearing_sim.levels.steady.table_builder import cached_table

            kept = cached_table(scene) if table is None else (table,)
            if kept is None and scene.table.correction != "none":
                raise IntegrationError(
                    f"table.correction = {scene.table.correction}: there is no such table of {scene.name} for its block table; "
                    "`bearing-sim table` with this scene builds it"
                )
            self._tables = kept[:1] if kept else ()
        self.reset(inputs, nodes, start)

    def __repr__(self) -> str:
        slip = 100.0 * float(self.sample["cage_slip"])
        return f"Simulation of {self.scene.name} at level {self.scene.level}, {self.time:.6g} s, cage slip {slip:.3g} %"

    def __getstate__(self) -> dict:
        kept, thermal = {name: value for name, value in self.__dict__.items() if name not in _FOUND_AGAIN}, self._thermal
        return kept if thermal is None else kept | {"_thermal": (thermal.course(), thermal.uncorrected, thermal.corrected, thermal.held)}

    def __setstate__(self, kept: dict) -> None:
        self.__dict__.update(kept)
        self._dtype, self._level, self._compiled = sample_dtype(self._params.rollers.count), LEVELS[self.scene.level], None
        if self._thermal is None:
            return
        course, uncorrected, corrected, held = self._thermal
        self._thermal = self._new_thermal()
        for own, theirs in zip(self._thermal.course(), course):  # the arrays of a course are those of its state
            if isinstance(own, np.ndarray):
                own[:] = theirs
        self._thermal.uncorrected, self._thermal.corrected, self._thermal.held = uncorrected, corrected, held

    def reset(self, inputs: Inputs | None = None, nodes: np.ndarray | None = None, start: np.void | None = None) -> None:
        """Return to time 0, no damage, and the state of ideal rolling at ``inputs``, or that of a sample.

        Parameters
        ----------
        inputs : conditions at time 0; the scene's operating block where absent.
        nodes : temperatures of the thermal network's nodes [K]; those of the scene's start where absent, or without a network.
        start : sample of a bearing with as many rollers, at any level, in whose positions and speeds to begin; speeds change with that of the
            shaft, so that the cage slips as much as there.

        Raises
        ------
        ValueError
            An input is not finite, except for a measured temperature that is NaN; or the sample has another number of rollers.
        IntegrationError
            The scene starts in thermal equilibrium, and there is none.
        """
        self.inputs = _checked(inputs if inputs is not None else scene_inputs(self.scene))
        self.time = 0.0
        self._work = self._new_work()
        self._counts = new_counts()
        self._thermal = self._new_thermal()
        if self._thermal is not None:
            self._thermal.temperatures[:] = self._start_temperatures() if nodes is None else nodes
        self._take_temperatures()
        before = new_block(1, self._params.rollers.count)
        if start is None:
            rolling = 0.5 * self.inputs.shaft_speed * (1.0 - self._params.raceways.diameter_ratio)
            self._begin(self._level.initial_state(self._params, self._work, *self.inputs[:3]), before, rolling)
        else:
            sample = self._at_present_speed(start)
            self._begin(self._level.state_at(self._params, self._work, sample), before, float(sample["cage_speed"]))

    def _at_present_speed(self, sample: np.void) -> np.void:
        """Return a sample with the speeds that its bearing has with the same slip at the present speed of the shaft."""
        if sample.dtype != self._dtype:
            raise ValueError(f"cannot start a bearing of {self._params.rollers.count} rollers from a sample of another bearing")
        sample, before = sample.copy(), float(sample["shaft_speed"])
        if before == 0.0:
            raise ValueError("cannot start from a sample of a shaft at rest, which has no slip; leave start out")
        for name in ("cage_speed", "orbital_speed", "roller_spin"):
            sample[name] *= self.inputs.shaft_speed / before
        sample["cage_angle"] %= 2.0 * math.pi
        return sample

    def take_over(self, other: "Simulation") -> None:
        """Continue from the state of another `Simulation` of the same bearing, at another level or with other settings.

        Time, inputs, damage, the angles of all bodies and the speeds of cage and rollers continue without a jump; see
        `bearing_sim.levels.common.state_transfer`.  Counters keep counting this simulation's own work.

        Raises
        ------
        ValueError
            The other bearing has another number of rollers.
        TypeError
            ``other`` is no simulation.
        """
        if not isinstance(other, Simulation):
            raise TypeError(f"other = {other!r:.60}: expected a Simulation")
        if other._params.rollers.count != self._params.rollers.count:
            theirs, own = other._params.rollers.count, self._params.rollers.count
            raise ValueError(f"cannot continue a bearing of {theirs} rollers with one of {own}: both simulations need the same bearing")
        self.inputs, self.time = other.inputs, other.time
        self._work = self._new_work()
        self._thermal = self._new_thermal()
        if self._thermal is not None and other._thermal is not None:
            self._thermal.take_over(other._thermal)
        self._take_temperatures()
        before = other._newest.copy().view(other._dtype)
        for name in ("roller_spin", "roller_rotation"):  # of a level that does not follow them
            before[name] = np.nan_to_num(before[name])
        means = {name: getattr(other._work, name) for name in other._remembered} if other._level.takes_steps else {}
        self._begin(self._level.state_at(self._params, self._work, other.sample), before, float(other.sample["cage_speed"]), other.sample, means)

    def resume(self, sample: np.void) -> None:
        """Continue from a recorded sample: its inputs, positions and speeds (see `take_over`).

        What a sample does not hold, such as the radial speeds of rollers, starts at rest.

        Parameters
        ----------
        sample : all observables of an instant (see `bearing_sim.model.sample`); its time becomes the simulation's.
        """
        self.inputs = _checked(inputs_of(sample))
        self.time = float(sample["time"])
        self._work = self._new_work()
        before = new_block(1, self._params.rollers.count)
        before[0] = sample
        self._thermal = self._new_thermal()
        if self._thermal is not None:
            self._thermal.resume(flat(before)[0])
        self._take_temperatures()
        for name in ("roller_spin", "roller_rotation"):  # of a level that does not follow them
            before[name] = np.nan_to_num(before[name])
        self._begin(self._level.state_at(self._params, self._work, before[0]), before, float(sample["cage_speed"]), sample)

    def _begin(
        self, state: np.ndarray, previous: np.ndarray, cage_speed: float, sample: np.void | None = None, means: Mapping[str, np.ndarray] = _NO_MEANS
    ) -> None:  # fmt: skip
        """Take a state as the present one.

        Parameters
        ----------
        previous : block of one sample, from which sums over time continue.
        cage_speed : of the state [rad/s].
        sample : where running means of loads continue; those of quasi-static balance where absent.
        means : running means that continue as they are, by their names in a workspace.
        """
        self._state = state
        self._compiled = None  # the code of `advance`, from its first call on: the types of its arguments stay
        self._memory = new_memory(state.size)
        self._step = float(self.scene.integration.first_step)
        self._newest = flat(new_block(1, self._params.rollers.count))[0]
        before = flat(previous)[0]
        self._newest[COLUMN.shaft_angle] = before[COLUMN.shaft_angle]
        model, work = self._model(self.inputs, 1.0), self._work
        self._remembered = tuple(name for name in _REMEMBERED if hasattr(work, name))
        if self._level.takes_steps:
            start_means(model, work, cage_speed, sample)
        self._restore(means)
        work.tally[:] = 0.0
        work.tally[TALLY.damage] = before[COLUMN.damage]
        observed = self.time, state, model, work, 0.0, before, self._newest, self._memory
        if self._level.observe(*observed) == NEEDS_POINT and self._level.supply(*observed[2:4]):
            self._level.observe(*observed)
        self._newest[COLUMN.level] = NUMBERS[self.scene.level]
        self._newest[_MEASURED_COLUMNS] = self.inputs[-len(RING_TEMPERATURES) :]
        self._write_temperatures(self._newest)

    def _new_thermal(self) -> ThermalState | None:
        if self.scene.heat.law != "network":
            return None
        return ThermalState(self.scene, self._cold, self.inputs.oil_temperature)

    def _start_temperatures(self) -> np.ndarray:
        if self.scene.heat.start != "equilibrium":
            return self._thermal.temperatures
        from bearing_sim.levels.steady.equilibrium import thermal_equilibrium

        found = thermal_equilibrium(self.scene, self.inputs)
        if not found.converged:
            raise IntegrationError(f"{found.reason}; start the network with heat.start=oil to see how it runs away")
        return found.temperatures

    def _take_temperatures(self) -> None:
        """Let radii, clearances and oil follow the present temperatures."""
        if self._thermal is None:
            self._follow_inputs(self.inputs)
            return
        self._params, self._lubrication = self._thermal.model(self._cold, self.inputs.oil_temperature, self.inputs.shaft_speed)
        if self._level.forget is not None:
            self._level.forget(self._work)

    def _follow_inputs(self, inputs: Inputs) -> None:
        """Let radii and oil follow the temperatures that come from outside."""
        oil, measured = inputs.oil_temperature, inputs[-len(RING_TEMPERATURES) :]
        if self._thermal is not None:
            self._lubrication = self._lubrication._replace(temperature=oil)  # that of the oil that comes in
            return
        self._lubrication = lubricate_scene(self.scene, self._params, oil, measured)
        if self.scene.heat.law == "given":
            solids = given_temperatures(self.scene.heat, oil, measured)
            self._temperatures[: len(solids)] = solids
        if self._level.forget is not None:
            self._level.forget(self._work)

    def _write_temperatures(self, rows: np.ndarray) -> None:
        if self._thermal is None:
            rows[..., THERMAL] = self._temperatures
        else:
            self._thermal.write(rows)

    @property
    def thermal(self) -> ThermalState | None:
        """The state of the thermal network; None where the scene has none."""
        return self._thermal

    def set_temperatures(self, nodes: np.ndarray, held: bool = True) -> None:
        """Set the temperatures of the thermal network's nodes.

        Parameters
        ----------
        nodes : [K], in the order of `bearing_sim.physics.thermal_network.NODE`.
        held : whether they stay so, however long the simulation advances; otherwise the network goes on from them.

        Raises
        ------
        ValueError
            The scene has no thermal network.
        """
        if self._thermal is None:
            raise ValueError(f"heat.law is {self.scene.heat.law}: only a network has temperatures to set; choose heat.law=network")
        self._thermal.temperatures[:] = nodes
        self._thermal.held = held
        self._take_temperatures()
        self._write_temperatures(self._newest)

    def _remember(self) -> dict[str, np.ndarray]:
        """Return copies of what the workspace remembers of the past."""
        return {name: getattr(self._work, name).copy() for name in self._remembered}

    def _restore(self, remembered: Mapping[str, np.ndarray]) -> None:
        for name in self._remembered:
            if name in remembered:
                getattr(self._work, name)[:] = remembered[name]

    def _new_work(self):
        return self._level.new_work(self._params, *self._tables)

    def _model(self, end: Inputs, duration: float) -> Model:
        now = self.inputs
        drive = Drive(
            self.time,
            now.shaft_speed,
            (end.shaft_speed - now.shaft_speed) / duration,
            now.load_y,
            (end.load_y - now.load_y) / duration,
            now.load_z,
            (end.load_z - now.load_z) / duration,
            float(self._newest[COLUMN.shaft_angle]),
        )
        return Model(self._params, self._lubrication, drive, self._tolerances)

    @property
    def sample(self) -> "Sample":
        """The newest sample (see `bearing_sim.model.sample`)."""
        return self._newest.view(self._dtype)[0]

    @property
    def state(self) -> np.ndarray:
        """A copy of the level's state vector."""
        return self._state.copy()

    @property
    def counters(self) -> Counters:
        """Work done since the start."""
        return Counters(*(int(self._counts[index]) for index in COUNT))

    def advance(self, duration: float | str, inputs: Inputs | None = None, samples: int = 1) -> "Block":
        """Advance by ``duration`` [s] while the inputs change linearly from their present values to ``inputs``.

        Temperatures take their new values at the start: they change slowly, and every oil property depends on that of the oil.  With a thermal
        network a long call is cut into parts of at most two of its intervals.

        Parameters
        ----------
        duration : length of the interval [s], positive; or a text with a unit, such as ``"10 ms"``.
        inputs : conditions at its end; unchanged where absent.
        samples : how many samples to return, evenly spaced, the last one at the end.

        Returns
        -------
        block : samples, shape (samples,), see `bearing_sim.model.sample.sample_dtype`.

        Raises
        ------
        IntegrationError
            With the reason; time and state stay as they were.
        ValueError
            ``duration`` is no positive finite time, ``samples`` is no whole number of at least 1, or an input is not finite, except for a measured
            temperature that is NaN.
        TypeError
            ``inputs`` are no `Inputs`.
        """
        duration = positive_seconds("duration", duration)
        if not isinstance(samples, numbers.Integral) or samples < 1:
            raise ValueError(f"samples = {samples!r}: expected a whole number of at least 1")
        end = self.inputs if inputs is None else _checked(inputs)
        if self._thermal is not None and not self._thermal.held and duration > _LONGEST_CALL * self.scene.heat.interval:
            return self._advance_in_parts(float(duration), end, samples)
        return self._advance_at_once(duration, end, samples)

    def _advance_in_parts(self, duration: float, end: Inputs, samples: int) -> np.ndarray:
        """Advance by calls in which temperatures hardly change, so that losses follow them; on an error return to where the first began."""
        before, thermal, remembered = dict(self.__dict__), self._thermal.copy(), self._remember()
        interval, longest, start = duration / samples, _LONGEST_CALL * self.scene.heat.interval, self.inputs
        parts = math.ceil(interval / longest * (1.0 - 1e-9))  # of the time between two samples
        together = max(int(longest / interval * (1.0 + 1e-9)), 1)  # samples of a call
        blocks, done = [], 0
        try:
            while done < samples:
                size = min(together, samples - done)
                for part in range(1, parts + 1):
                    there = (done + size * part / parts) / samples
                    between = (old + there * (new - old) for old, new in zip(start[: -len(RING_TEMPERATURES)], end))
                    reached = end if there == 1.0 else Inputs(*between, *end[-len(RING_TEMPERATURES) :])._replace(oil_temperature=end.oil_temperature)
                    block = self._advance_at_once(size * interval / parts, reached, size if parts == 1 else 1)
                blocks.append(block)
                done += size
        except IntegrationError:
            self.__dict__.update(before)
            self._thermal = thermal
            self._take_temperatures()
            self._work = self._new_work()
            self._restore(remembered)
            raise
        return joined(blocks)

    def _advance_at_once(self, duration: float, end: Inputs, samples: int) -> np.ndarray:
        if end.oil_temperature != self._lubrication.temperature or self._rings_changed(end):
            self._follow_inputs(end)
        block = new_block(samples, self._params.rollers.count)
        rows = flat(block)
        state, remembered = self._state.copy(), self._remember()
        integration = self.scene.integration
        advance = self._level.advance
        arguments = (
            integration.fixed_step is not None,
            self.time,
            float(duration),
            state,
            self._step,
            integration.maximum_step if integration.fixed_step is None else integration.fixed_step,
            integration.step_budget,
            self._model(end, duration),
            self._work,
            self._memory,
            self._counts,
            self._newest,
            rows,
        )
        status, step = (self._compiled or advance)(*arguments)
        if self._compiled is None:
            self._compiled = _compiled_version(advance, arguments)
        while status == NEEDS_POINT:
            status, step = self._compiled(*arguments) if self._level.supply(arguments[7], self._work) else (NOT_EVALUATED, step)
        if status != OK:
            self._work = self._new_work()  # a failed search may have left nonsense to start the next one from
            self._restore(remembered)
            self._memory = new_memory(state.size)
            self._step = float(integration.first_step)
            raise IntegrationError(
                f"{REASONS[status]} between {self.time:.6g} and {self.time + duration:.6g} s (shaft {end.shaft_speed:.6g} rad/s, "
                f"load {math.hypot(end.load_y, end.load_z):.6g} N, {end.oil_temperature:.6g} K); the state before is kept",
                status,
            )
        rows[:, COLUMN.level] = NUMBERS[self.scene.level]
        rows[:, _MEASURED_COLUMNS] = end[-len(RING_TEMPERATURES) :]
        self._write_temperatures(rows)
        self.time += duration
        self.inputs, self._state, self._step = end, state, step
        if self._thermal is not None and self._thermal.record_losses(
            self._newest, rows, duration, end.oil_temperature, end[-len(RING_TEMPERATURES) :]
        ):
            self._take_temperatures()
        self._newest = rows[-1].copy()
        return block

    def _rings_changed(self, end: Inputs) -> bool:
        """Return whether measured temperatures stand for given ones and have changed."""
        if self.scene.heat.law != "given":
            return False
        return str(end[-len(RING_TEMPERATURES) :]) != str(self.inputs[-len(RING_TEMPERATURES) :])  # as text NaN equals NaN

    def _alone(self, inputs: np.ndarray) -> int:
        """Return up to which of many instants the thermal network runs without a measured temperature, without being held."""
        if self._thermal.held or self._thermal.uncorrected is not None:
            return 0
        measured = np.flatnonzero(np.isfinite(inputs[:, -len(RING_TEMPERATURES) :]).any(axis=1))
        return int(measured[0]) if len(measured) else len(inputs)

    @property
    def takes_profiles(self) -> bool:
        """Whether `advance_profile` goes over many instants at once."""
        return bool(self._tables) and self.scene.heat.law != "given"

    def advance_profile(self, stretches: np.ndarray, inputs: np.ndarray) -> np.ndarray:
        """Advance from instant to instant of a course, as far as the level's table holds it, many times as fast as by `advance`.

        Parameters
        ----------
        stretches : time from each instant to the next [s], positive, shape (n,).
        inputs : conditions at the instants, columns as `Inputs`, shape (n, 6); linear in between.

        Returns
        -------
        block : a sample at each instant that was reached, from none to n; time and state are those of the last.

        Raises
        ------
        ValueError
            The level takes no courses, a stretch is not positive and finite, or an input is not finite, except for a measured
            temperature that is NaN.
        """
        if not self.takes_profiles:
            raise ValueError(f"level {self.scene.level} without a table takes no courses of inputs; use advance")
        are_usable = np.isfinite(inputs[:, : -len(RING_TEMPERATURES)]).all() and not np.isinf(inputs).any()
        if not (are_usable and np.isfinite(stretches).all() and (stretches > 0.0).all()):
            raise ValueError("advance_profile takes positive finite stretches and finite inputs")
        block = new_block(len(stretches), self._params.rollers.count)
        rows = flat(block)
        course = np.ascontiguousarray(stretches, float), np.ascontiguousarray(np.vstack([[*self.inputs], inputs]), float)
        state = self._state, self._model(self.inputs, 1.0), self._work, self._counts, self._newest, rows
        if self._thermal is None:
            viscosities = kinematic_viscosities(self.scene.lubricant.oil, np.ascontiguousarray(inputs[:, 3], float))
            reached = self._level.advance_profile(self.time, *course, viscosities, *state)
        else:
            alone = self._alone(inputs)
            course = course[0][:alone], course[1][: alone + 1]
            reached = self._level.advance_warm_profile(self.time, *course, *state, self._thermal.course()) if alone else 0
        if reached:
            self.inputs = Inputs(*map(float, inputs[reached - 1]))
            self.time = float(block["time"][reached - 1])
            rows[:, COLUMN.level] = NUMBERS[self.scene.level]
            rows[:reached, _MEASURED_COLUMNS] = inputs[:reached, -len(RING_TEMPERATURES) :]
            if self._thermal is None:
                self._write_temperatures(rows[:reached])
            self._newest = rows[reached - 1].copy()
            if self._thermal is not None:
                self._take_temperatures()
            elif self.inputs.oil_temperature != self._lubrication.temperature:
                self._follow_inputs(self.inputs)
        return block[:reached]


def tolerances_of(integration: Integration) -> Tolerances:
    """Return the tolerances of the integration.

    With a fixed step they only end the iteration of a stage, and at a bend of a law of friction an iteration cannot come closer
    than the finest ones here, however the step is divided.
    """
    absolute = integration.absolute_tolerance
    wanted = Tolerances(*(float(value) for value in (absolute.position, absolute.play, absolute.speed, integration.relative_tolerance)))
    return wanted if integration.fixed_step is None else Tolerances(*map(max, wanted, _FINEST_WITH_FIXED_STEP))


def _compiled_version(function: Callable, arguments: tuple) -> Callable:
    """Return `compiled_for` of a function and arguments, looked up once for arguments of the same structure."""
    key = function, _structure(arguments)
    if key not in _compiled_versions:
        _compiled_versions[key] = compiled_for(function, arguments)
    return _compiled_versions[key]


def _structure(value) -> Hashable:
    """Return what the type of a value in compiled code follows from; numba's own look at a bearing takes twenty times as long."""
    if isinstance(value, tuple):
        return type(value), *map(_structure, value)
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.num & ~_OWNS_ITS_DATA
    return type(value)


def start_sample(simulation: Simulation) -> np.ndarray:
    """Return the newest sample as a block of its own: at the start of a run a recording begins with it, so that the run can be reproduced."""
    return np.array([simulation.sample])


def positive_seconds(name: str, value: float | str) -> float:
    """Return a time [s], a number or a text with a unit; raise `ValueError` with its name where it is no positive finite time."""
    try:
        seconds = value if type(value) is float else to_si(value, "s")
    except ValueError as error:
        raise ValueError(f"{name} = {value!r}: {error}") from None
    if not 0.0 < seconds < math.inf:
        raise ValueError(f"{name} = {value!r}: expected a positive time such as '0.5 s'")
    return seconds


def _checked(inputs: Inputs) -> Inputs:
    """Return inputs as plain numbers; raise `ValueError` where one is no finite number within its bounds, or NaN where it is not measured."""
    if not isinstance(inputs, Inputs):
        raise TypeError(
            f"inputs = {inputs!r}: expected Inputs; Inputs.of makes them of numbers in SI or texts with units, simulation.inputs.at changes them"
        )
    try:
        inputs = Inputs(*map(float, inputs))
    except (TypeError, ValueError) as error:
        raise ValueError(f"{inputs}: {error}; inputs are numbers in SI, Inputs.of reads texts with units") from None
    for index, (value, lowest, highest) in enumerate(zip(inputs, _LOWEST, _HIGHEST)):
        if not lowest <= value <= highest and not (value != value and Inputs._fields[index] in RING_TEMPERATURES):
            name, declared = Inputs._fields[index], _DECLARED_FIELDS[index]
            if not math.isfinite(value):
                raise ValueError(f"{name} = {value}: expected a finite number")
            bounds = f"{declared.show(declared.minimum)} to {declared.show(declared.maximum)}"
            raise ValueError(f"{name} = {value} {declared.unit}: expected {bounds}; inputs are numbers in SI, Inputs.of reads texts with units")
    return inputs
