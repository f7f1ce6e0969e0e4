# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The scene: everything a run needs, as frozen records in SI.

One record per block of the YAML file.  Each quantity is declared once, with unit, bounds and meaning;
`bearing_sim.scene.loader` reads files against these declarations.
"""

import math
import re
import types
import typing
from collections.abc import Container, Mapping
from dataclasses import field, replace
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, ValidationError
from pydantic_core import PydanticCustomError

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.diameters import override_by_radius
from bearing_sim.scene.errors import InvalidField, SceneError, did_you_mean
from bearing_sim.scene.estimation import Estimation, estimation_errors
from bearing_sim.scene.fidelity import LEVELS, Level, WantName, refusals
from bearing_sim.scene.flanges import axial_errors
from bearing_sim.scene.heat import Heat, NoHeat, given_errors, sink_errors
from bearing_sim.scene.lubricant import Lubricant
from bearing_sim.scene.mounting import Mounting, mounting_errors
from bearing_sim.scene.outer_ring import backing_errors
from bearing_sim.scene.quantity import Quantity, check, record
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.support import Support, support_errors
from bearing_sim.scene.uncertainty import Range, messages, nearest, quantities, range_errors, with_values
from bearing_sim.scene.vibration import VibrationInput
from bearing_sim.scene.watchers import watcher_errors

NO_CLEARANCE_LIMIT = -1e-3
"""A threshold of the running clearance that none falls below [m]."""
OPERATING_POINT = {
    "shaft_speed": "operating.shaft_speed",
    "radial_load": "operating.radial_load",
    "load_angle": "operating.load_angle",
    "oil_temperature": "lubricant.temperature",
}
"""Fields of the operating point by the names that `Scene.at`, `bearing_sim.settle` and files of operating points give them."""
_LONGEST_STEP = 0.5  # roller pitches of cage rotation in a fixed step
_LARGEST_SPEED, _LARGEST_LOAD = 12000.0, 1e8  # rad/s, N
# Inputs that no bearing survives, so that a message beyond them is a fault of a sensor (assumption): a hoop stress of 1 GPa in the inner
# ring, rho v^2; and a contact pressure of 4 GPa times the root of ten, for C_0 is the load of 4 GPa (ISO 76).
_BURSTING_SPEED = 350.0  # m/s
_CRUSHING_LOAD = 10.0  # times C_0r


@record
class Operating:
    """Constant conditions of `bearing-sim run`; a live run uses them until an input arrives."""

    shaft_speed: Annotated[float, Quantity("rad/s", "shaft speed, omega_i", -_LARGEST_SPEED, _LARGEST_SPEED, "rpm")]
    radial_load: Annotated[float, Quantity("N", "radial load on the inner ring, F_r", 0.0, _LARGEST_LOAD)] = 0.0
    load_angle: Annotated[float, Quantity("rad", "azimuth of the radial load, from +y", -2 * math.pi, 2 * math.pi, "deg")] = 0.0
    axial_load: Annotated[
        float, Quantity("N", "axial load on the inner ring along +x, F_a, which flanges of both rings carry", -_LARGEST_LOAD, _LARGEST_LOAD)
    ] = 0.0
    moment: Annotated[float, Quantity("N*m", "moment on the inner ring, which then tilts freely; None: its tilt is held", 0.0, 1e5)] | None = None
    moment_angle: Annotated[
        float, Quantity("rad", "azimuth to which the moment leans the ring's +x end, from +y", -2 * math.pi, 2 * math.pi, "deg")
    ] = 0.0
    misalignment: Annotated[float, Quantity("rad", "tilt at which the inner ring is held", 0.0, 0.02, "mrad")] = 0.0
    misalignment_angle: Annotated[float, Quantity("rad", "azimuth to which the ring's +x end leans, from +y", -2 * math.pi, 2 * math.pi, "deg")] = 0.0

    @check
    def _ring_is_held_or_free(self) -> list[str]:
        if self.moment is not None and self.misalignment != 0.0:
            return ["misalignment: a ring under a moment tilts freely; give the moment or the misalignment"]
        return []


@record
class Dynamics:
    """What the equations of motion take into account."""

    gyroscopic: bool = True  # whether tilting bodies have gyroscopic moments; Deng leaves them out


@record
class AbsoluteTolerance:
    """What a step may err in each kind of state, however small the state is."""

    position: Annotated[float, Quantity("m", "error allowed in a step in the position of a roller or the inner ring", 1e-14, 1e-3, "um")] = 2.5e-6
    play: Annotated[
        float, Quantity("m", "error allowed in a step in what has play: a roller in its pocket, the cage in its guide", 1e-14, 1e-3, "um")
    ] = 5e-6
    speed: Annotated[
        float, Quantity("m/s", "error allowed in a step in an orbital or surface speed, besides the relative one", 1e-12, 10.0, "mm/s")
    ] = 1e-2


@record
class Integration:
    """How time is advanced, and how accurately.

    In each step the estimated error of every state is at most its tolerance: `absolute_tolerance.position` or `.play` for a
    position, `absolute_tolerance.speed` + `relative_tolerance` x the speed of ideal rolling for a speed.  ``doc/theory/tolerances.md``
    says how states are weighed and what each setting buys.  With a fixed step nothing is estimated: the tolerances only end
    the iterations within a step, and first and longest step are not used.
    """

    absolute_tolerance: AbsoluteTolerance = field(default_factory=AbsoluteTolerance)
    relative_tolerance: Annotated[float, Quantity("", "error allowed in a step in a speed, relative to ideal rolling", 1e-12, 1.0, "%")] = 0.01
    maximum_step: Annotated[float, Quantity("s", "longest step", 1e-9, 1.0, "us")] = 1e-2
    first_step: Annotated[float, Quantity("s", "first step", 1e-12, 1.0, "us")] = 1e-5
    fixed_step: Annotated[float, Quantity("s", "step without error control, for hard real time", 1e-9, 1e-2, "us")] | None = None
    step_budget: Annotated[int, Field(ge=10, le=1_000_000_000)] = 2_000_000  # most steps in one call of `Simulation.advance`

    def with_tolerances(self, factor: float) -> "Integration":
        """Return the same with all tolerances multiplied by ``factor``."""
        absolute = self.absolute_tolerance
        scaled = AbsoluteTolerance(position=factor * absolute.position, play=factor * absolute.play, speed=factor * absolute.speed)
        return replace(self, absolute_tolerance=scaled, relative_tolerance=factor * self.relative_tolerance)


def tolerance_overrides(factor: float) -> list[str]:
    """Return the overrides of a scene that set all its tolerances to ``factor`` times their defaults."""
    integration = Integration().with_tolerances(factor)
    absolute = integration.absolute_tolerance
    return [
        f"integration.absolute_tolerance.position={absolute.position:.6g}",
        f"integration.absolute_tolerance.play={absolute.play:.6g}",
        f"integration.absolute_tolerance.speed={absolute.speed:.6g}",
        f"integration.relative_tolerance={integration.relative_tolerance:.6g}",
    ]


@record
class InputLimits:
    """Limits of input messages; others are faults of a sensor: they are refused and reported, and the last good value is held.

    Where no largest speed or load is given, it is more than the bearing can take (see `Scene.accepted_inputs`).
    """

    maximum_speed: (
        Annotated[float, Quantity("rad/s", "largest shaft speed accepted; None: the inner raceway at 350 m/s", 0.0, _LARGEST_SPEED, "rpm")] | None
    ) = None
    maximum_load: (
        Annotated[float, Quantity("N", "largest radial load accepted; None: ten times the static load rating", 0.0, _LARGEST_LOAD)] | None
    ) = None
    minimum_temperature: Annotated[float, Quantity("K", "lowest temperature accepted, of oil and rings", 150.0, 800.0, "degC")] = 233.15
    maximum_temperature: Annotated[float, Quantity("K", "highest temperature accepted, of oil and rings", 150.0, 800.0, "degC")] = 523.15
    reverse_rotation: bool = True  # whether negative shaft speeds are accepted
    stale_after: Annotated[float, Quantity("s", "age at which an input counts as stale", 1e-3, 3600.0)] = 1.0
    minimum_rate: Annotated[float, Quantity("Hz", "lowest message rate expected", 0.0, 1e5)] = 1.0
    maximum_rate: Annotated[float, Quantity("Hz", "highest message rate expected", 0.0, 1e5)] = 2000.0


@record
class Hold:
    """Hysteresis and delays of an alarm (see `bearing_sim.watchers.monitoring.monitor.Alarm`)."""

    hysteresis: Annotated[float, Quantity("", "fraction of the limit by which a value must return before the alarm clears", 0.0, 0.9, "%")] = 0.1
    raise_after: Annotated[float, Quantity("s", "time beyond the limit before the alarm is raised", 0.0, 86400.0)] = 0.5
    clear_after: Annotated[float, Quantity("s", "time back within the limit before the alarm clears", 0.0, 86400.0)] = 2.0


def _detection_errors(detection: "ResidualDetection | TemperatureResidualDetection") -> list[str]:
    """Return why the times of a detection do not fit together."""
    batch, errors = detection.batch, []
    if detection.learning < 30 * batch:
        errors.append(f"learning: {detection.learning:g} s are {detection.learning / batch:.3g} batches of {batch:g} s; expected 30 or more")
    if detection.false_alarm_time < 20 * batch:
        errors.append(f"false_alarm_time: {detection.false_alarm_time:g} s is less than 20 batches of {batch:g} s")
    return errors


@record
class ResidualDetection:
    """How measured slip is compared with predicted slip (see `bearing_sim.watchers.monitoring.residual`)."""

    false_alarm_time: Annotated[float, Quantity("s", "mean time between false alarms", 60.0, 1e10, "h")] = 3.6e6
    tolerance: Annotated[
        float, Quantity("", "lasting change of the residual that is not a fault: the error of the model between conditions", 1e-6, 1.0, "%")
    ] = 0.002
    batch: Annotated[float, Quantity("s", "time over which residuals are averaged before the test", 0.01, 3600.0)] = 1.0
    learning: Annotated[float, Quantity("s", "measured time from which the reference mean and scatter of the residual are learned", 1.0, 1e6)] = 120.0
    settling: Annotated[float, Quantity("s", "time after rest or a change of speed that is ignored", 0.0, 3600.0)] = 5.0
    memory: Annotated[float, Quantity("s", "time constant of the displayed exponential mean and standard deviation", 0.1, 1e6)] = 60.0

    @check
    def _times_fit_together(self) -> list[str]:
        return _detection_errors(self)


@record
class TemperatureResidualDetection:
    """How measured temperatures of rings are compared with those that the thermal network has without them.

    See `bearing_sim.watchers.monitoring.residual`.
    """

    false_alarm_time: Annotated[float, Quantity("s", "mean time between false alarms", 60.0, 1e10, "h")] = 3.6e6
    tolerance: Annotated[
        float, Quantity("delta_degC", "lasting change of the residual that is not a fault: the error of the network", 1e-6, 100.0, "K")
    ] = 1.0
    batch: Annotated[float, Quantity("s", "time over which residuals are averaged before the test", 0.01, 3600.0)] = 10.0
    learning: Annotated[float, Quantity("s", "measured time from which the reference mean and scatter of the residual are learned", 1.0, 1e6)] = 600.0
    settling: Annotated[float, Quantity("s", "time after a change of speed that is ignored", 0.0, 36000.0)] = 60.0
    memory: Annotated[float, Quantity("s", "time constant of the displayed exponential mean and standard deviation", 0.1, 1e6)] = 300.0

    @check
    def _times_fit_together(self) -> list[str]:
        return _detection_errors(self)


@record
class Thresholds:
    """When the condition is a warning or an error."""

    slip_warning: Annotated[float, Quantity("", "cage slip that is a warning", 0.0, 1.0, "%")] = 0.05
    slip_error: Annotated[float, Quantity("", "cage slip that is an error (Deng 2017: 10 %)", 0.0, 1.0, "%")] = 0.10
    # Just above rest the slip may be large, but it does no harm.
    slip_from_speed: Annotated[float, Quantity("rad/s", "shaft speed above which slip and film are monitored", 0.0, _LARGEST_SPEED, "rpm")] = 20.0
    slip_hold: Hold = field(default_factory=Hold)
    life_warning: Annotated[float, Quantity("h", "rating life below which there is a warning (Deng 2017: 300 h)", 0.0, 1e9)] = 300.0
    life_error: Annotated[float, Quantity("h", "rating life below which there is an error; 0: never", 0.0, 1e9)] = 0.0
    life_hold: Hold = field(default_factory=Hold)
    remaining_life_warning: Annotated[float, Quantity("h", "remaining life below which there is a warning (Deng 2017: 300 h)", 0.0, 1e9)] = 300.0
    remaining_life_error: Annotated[float, Quantity("h", "remaining life below which there is an error; 0: never", 0.0, 1e9)] = 0.0
    remaining_life_memory: Annotated[
        float, Quantity("s", "time constant of the mean damage rate from which remaining life is computed", 1e-3, 1e9)
    ] = 60.0
    remaining_life_hold: Hold = field(default_factory=Hold)
    lambda_warning: Annotated[float, Quantity("", "film thickness over roughness below which there is a warning", 0.0, 100.0)] = 1.0
    lambda_error: Annotated[float, Quantity("", "film thickness over roughness below which there is an error; 0: never", 0.0, 100.0)] = 0.0
    lambda_hold: Hold = field(default_factory=Hold)
    pocket_force_warning: Annotated[float, Quantity("N", "pocket force that is a warning; None: none is", 0.0, 1e6)] | None = None
    pocket_force_error: Annotated[float, Quantity("N", "pocket force that is an error; None: none is", 0.0, 1e6)] | None = None
    pocket_force_hold: Hold = field(default_factory=Hold)
    # A preload may be wanted, so that no clearance is wrong for every bearing.
    clearance_warning: Annotated[
        float, Quantity("m", "running clearance below which there is a warning; -1 mm: never", NO_CLEARANCE_LIMIT, 1e-2, "um")
    ] = NO_CLEARANCE_LIMIT
    clearance_error: Annotated[
        float, Quantity("m", "running clearance below which there is an error; -1 mm: never", NO_CLEARANCE_LIMIT, 1e-2, "um")
    ] = NO_CLEARANCE_LIMIT
    clearance_hold: Hold = field(default_factory=Hold)
    residual: ResidualDetection = field(default_factory=ResidualDetection)
    temperature_residual: TemperatureResidualDetection = field(default_factory=TemperatureResidualDetection)

    @check
    def _warnings_come_before_errors(self) -> list[str]:
        errors, rising, falling = [], (1.0, "above"), (-1.0, "below")
        for name, is_off, factor, unit, (sense, relation) in (
            ("slip", None, 100.0, " %", rising),
            ("pocket_force", None, 1.0, " N", rising),
            ("life", 0.0, 1.0, " h", falling),
            ("remaining_life", 0.0, 1.0, " h", falling),
            ("lambda", 0.0, 1.0, "", falling),
            ("clearance", NO_CLEARANCE_LIMIT, 1e6, " um", falling),
        ):
            warning, error = getattr(self, f"{name}_warning"), getattr(self, f"{name}_error")
            if is_off not in (warning, error) and sense * warning > sense * error:
                shown = f"{name}_warning: {factor * warning:g}{unit} is {relation} {name}_error, {factor * error:g}{unit}"
                errors.append(f"{shown}, so that no warning could come before the error; change the other one first, or both at once")
        return errors


CLEANLINESS = Literal[
    "none",
    "filtered_13_10",
    "filtered_15_12",
    "filtered_17_14",
    "filtered_19_16",
    "bath_13_10",
    "bath_15_12",
    "bath_17_14",
    "bath_19_16",
    "bath_21_18",
    "grease_high_cleanliness",
    "grease_normal_cleanliness",
    "grease_slight_contamination",
    "grease_severe_contamination",
    "grease_very_severe_contamination",
]


def _cleanliness_class(value: object) -> object:
    """Return the class of a name in words, such as ``high cleanliness`` of a grease; anything else as it is."""
    if not isinstance(value, str):
        return value
    name = "_".join(re.findall(r"[a-z0-9]+", value.casefold()))
    known = typing.get_args(CLEANLINESS)
    return next((each for each in (name, f"grease_{name}") if each in known), value)


@record
class LifeRating:
    """The rating life that is shown, monitored and counted as damage: L_nm = a_1 a_ISO L_10.

    The method is `iso16281` (ISO/TS 16281:2008: the loads on laminae of every roller, with stress risers: L10r, L_nmr), `iso281` (ISO 281:2007:
    the radial load on the bearing alone, as in a catalogue, (C/P)^(10/3): L10, L_nm), or `deng2017` (Deng et al. 2017, eq. 18: the loads of whole
    rollers, without stress risers; two to three times L10r under the same loads, for their figures only).  The loads of rollers contain preload and
    centrifugal force, so that these lives of a preloaded bearing may be far shorter than that of a catalogue.

    a_iso names the oil's cleanliness by the end of its ISO 4406 code: `filtered`, circulating through an in-line filter,
    or `bath`, without a filter or with an off-line filter; or that of a grease in the words of ISO 281, such as `high cleanliness`;
    `none` sets a_ISO = 1.
    """

    reliability: Annotated[float, Quantity("", "probability of reaching the life", 0.9, 0.9995, "%")] = 0.9
    a_iso: Annotated[CLEANLINESS, BeforeValidator(_cleanliness_class)] = "none"  # cleanliness class of the lubricant for a_ISO; none: a_ISO = 1
    method: Literal["iso16281", "iso281", "deng2017"] = "iso16281"  # which rating life is shown, monitored and counted as damage
    laminae: Annotated[int, Field(ge=2, le=400)] = 40  # per roller for L10r; ISO/TS 16281 requires 30 or more

    @property
    def is_basic(self) -> bool:
        """Whether damage is computed from a basic life, without reliability and oil."""
        return self.reliability == 0.9 and self.a_iso == "none"

    @property
    def loads(self) -> str:
        """By which loads the method rates, in words."""
        return {
            "iso16281": "the loads on the laminae of all rollers",
            "iso281": "the radial load on the bearing",
            "deng2017": "the loads of whole rollers (eq. 18 of Deng et al. 2017)",
        }[self.method]

    @property
    def symbols(self) -> tuple[str, str]:
        """The standard's symbols of the basic and the modified life by the method; Deng et al. 2017 write L for both."""
        return {"iso16281": ("L10r", "L_nmr"), "iso281": ("L10", "L_nm"), "deng2017": ("L (Deng 2017)", "L_nm (Deng 2017)")}[self.method]


@record
class SteadyTable:
    """The table of operating points of level ``steady``: its tolerance and range; it covers all load directions."""

    tolerance: Annotated[float, Quantity("", "error allowed in slip, over 0.025 points of it, and in life, relative", 1e-4, 0.5, "%")] = 0.02
    maximum_speed: (
        Annotated[float, Quantity("rad/s", "highest shaft speed; None: a fifth above the operating speed", 1.0, _LARGEST_SPEED, "rpm")] | None
    ) = None
    maximum_load: Annotated[float, Quantity("N", "largest radial load; None: half the bearing's dynamic load rating", 1.0, _LARGEST_LOAD)] | None = (
        None
    )
    minimum_temperature: Annotated[float, Quantity("K", "lowest oil temperature", 220.0, 600.0, "degC")] = 313.15
    maximum_temperature: Annotated[float, Quantity("K", "highest oil temperature", 220.0, 600.0, "degC")] = 453.15
    # With a law of heat the table has an axis for how far the clearance has closed, as far as these differences between the rings need.
    minimum_difference: Annotated[
        float, Quantity("delta_degC", "least temperature of the inner ring over the outer one's", -300.0, 300.0, "K")
    ] = -20.0
    maximum_difference: Annotated[float, Quantity("delta_degC", "largest temperature of the inner ring over the outer one's", -300.0, 300.0, "K")] = (
        40.0
    )
    # planar: operating points are corrected by what level planar settles in at some hundred of them, measured once for this bearing and oil
    correction: Literal["none", "planar"] = "none"  # which level's pocket forces, whirl and vibration the table contains

    @check
    def _spans_something(self) -> list[str]:
        if self.maximum_temperature < self.minimum_temperature:
            return [f"minimum_temperature: {self.minimum_temperature:g} K is above the maximum_temperature, {self.maximum_temperature:g} K"]
        if self.maximum_difference <= self.minimum_difference:
            return [f"minimum_difference: {self.minimum_difference:g} K is not below the maximum_difference, {self.maximum_difference:g} K"]
        return []


@record
class WantedError:
    """The largest error that a scene accepts of something that it wants."""

    want: Literal["slip", "life", "roller_loads", "edge_loads"]  # entry of wants
    error: Annotated[float, Field(gt=0.0, le=1.0)]  # 0.003 of slip are 0.3 percentage points; others are relative


def _absent(scene: "Scene", path: str) -> str:
    """Return which record on the way to a quantity a scene has not, or not of the kind that has it; empty where it has all of them."""
    here, passed = scene, []
    for name in path.split("."):
        if not hasattr(here, name):
            return ".".join(passed)
        here = getattr(here, name)
        passed.append(name)
    return ""


@record
class Scene:
    """One bearing, its oil, its operating conditions, and how it is computed."""

    name: str  # name of the scene
    description: str = ""  # what it is, in a sentence
    level: Level = "slip"  # level of fidelity; a file may also say auto
    # With `level: auto` a file gets the lowest level that has these and all other effects of the scene; level_reason says why.  A mapping to largest
    # errors, such as {slip: 0.3 %, life: 5 %}, asks for the fastest setting whose errors `bearing-sim trade` has measured to be below them.
    wants: tuple[WantName, ...] = ()
    wanted_errors: tuple[WantedError, ...] = ()  # those of a mapping wants, which a file gives there
    # path, from the folder of the scene file, of what `bearing-sim trade --front` measured: `level: auto` with errors in wants chooses by it, on
    # every machine alike; None: by what this machine has kept, which level_reason says; a loaded scene has the level and no front
    front: str | None = None
    level_reason: str = ""  # why the level was chosen, filled in for `level: auto`
    bearing: Bearing
    lubricant: Lubricant
    operating: Operating
    mounting: Mounting = field(default_factory=Mounting)
    support: Support = field(default_factory=Support)
    heat: Heat = field(default_factory=NoHeat)
    dynamics: Dynamics = field(default_factory=Dynamics)
    integration: Integration = field(default_factory=Integration)
    input_limits: InputLimits = field(default_factory=InputLimits)
    thresholds: Thresholds = field(default_factory=Thresholds)
    life: LifeRating = field(default_factory=LifeRating)
    table: SteadyTable = field(default_factory=SteadyTable)
    uncertainty: tuple[Range, ...] = ()  # a mapping of field to range in a file, see `bearing_sim.scene.uncertainty`
    estimation: Estimation = field(default_factory=Estimation)
    vibration: VibrationInput = field(default_factory=VibrationInput)
    watchers: tuple[str, ...] = ()  # names of optional watchers of a run, see `bearing_sim.watchers.monitoring.watchers`

    def at(
        self,
        fields: Mapping[str, float | str | None] | None = None,
        *,
        shaft_speed: float | str | None = None,
        radial_load: float | str | None = None,
        load_angle: float | str | None = None,
        oil_temperature: float | str | None = None,
    ) -> "Scene":
        """Return the scene at another operating point, or with other quantities; it takes a fraction of a millisecond.

        Parameters
        ----------
        fields : values by dotted path, such as ``{"bearing.clearance": "40 um"}``; quantities of bearing, lubricant, operating, mounting, heat
            and support.  `bearing_sim.load_scene` with overrides changes every other field, too.
        shaft_speed, radial_load, load_angle, oil_temperature : of the operating point; unchanged where absent.

        A value is a number in SI, as everywhere in Python, or a text with a unit, such as ``"3000 rpm"``.

        Raises
        ------
        SceneError
            A field is unknown, a value is no such quantity or out of bounds, or the values contradict each other.
        TypeError
            ``fields`` is no mapping.
        """
        point = {"shaft_speed": shaft_speed, "radial_load": radial_load, "load_angle": load_angle, "oil_temperature": oil_temperature}
        if not isinstance(fields, (Mapping, types.NoneType)):
            raise TypeError(f"fields = {fields!r}: expected a mapping such as {{'bearing.clearance': '40 um'}}")
        given = {OPERATING_POINT[name]: value for name, value in point.items() if value is not None} | dict(fields or {})
        known, values, errors = quantities(type(self)), {}, []
        for asked, value in given.items():
            path, value = override_by_radius(asked, value, type(self))
            if path not in known:
                reason = f"no quantity of a scene{nearest(path, known)}; load_scene(scene, ['{asked}=...']) changes fields of other kinds"
                errors.append(InvalidField(asked, "", reason))
                continue
            absent = _absent(self, path)
            if absent:
                reason = f"the scene has no {absent} with such a field; load_scene(scene, ['{absent}=...']) gives it one"
                errors.append(InvalidField(asked, "", reason))
                continue
            try:
                values[path] = None if value is None else known[path].read(value)
            except PydanticCustomError as error:
                errors.append(InvalidField(asked, repr(value), error.message()))
        if not errors:
            try:
                return _without_estimates(with_values(self, values), values)
            except ValidationError as error:
                errors.append(InvalidField(", ".join(given), "", messages(error)))
        raise SceneError(self.name, errors)

    def at_level(self, level: Level) -> "Scene":
        """Return the scene at another level of fidelity, with that level's default integration: settings belong to the scene's own level.

        Raises
        ------
        SceneError
            There is no such level, or it would ignore what the scene asks for.
        """
        if level == self.level:
            return self
        if level not in LEVELS:
            raise SceneError(
                self.name, [InvalidField("level", repr(level), f"expected one of {', '.join(LEVELS)}{did_you_mean(str(level), LEVELS)}")]
            )
        try:
            return replace(self, integration=Integration(), level=level, level_reason="")
        except ValidationError as error:
            raise SceneError(self.name, [InvalidField("level", repr(level), messages(error))]) from None

    @property
    def accepted_inputs(self) -> InputLimits:
        """The limits of input messages, those that are not given by what no bearing of this size survives."""
        limits, bearing = self.input_limits, self.bearing
        speed, load = _BURSTING_SPEED / bearing.inner_raceway.radius, _CRUSHING_LOAD * rate(bearing).static
        return replace(
            limits,
            maximum_speed=min(speed, _LARGEST_SPEED) if limits.maximum_speed is None else limits.maximum_speed,
            maximum_load=min(load, _LARGEST_LOAD) if limits.maximum_load is None else limits.maximum_load,
        )

    @property
    def uses_ring_temperatures(self) -> bool:
        """Whether the temperatures of the rings matter, so that measured ones are used."""
        return self.heat.law != "none"

    @property
    def outer_ring_bends(self) -> bool:
        """Whether the outer ring is elastic."""
        return self.mounting.housing.backing.law != "rigid"

    @property
    def cage_whirls(self) -> bool:
        """Whether the level moves the cage's centre."""
        return self.level not in ("steady", "slip")

    @property
    def bodies_tilt(self) -> bool:
        """Whether the level tilts rollers, ring and cage, and resolves loads along a roller."""
        return self.level == "spatial"

    @check
    def _level_has_all_effects(self) -> list[str]:
        return refusals(self)

    @check
    def _operation_is_within_bounds(self) -> list[str]:
        errors = step_errors(self) + moment_errors(self) + mounting_errors(self.bearing, self.mounting) + support_errors(self)
        errors += backing_errors(self)
        errors += axial_errors(self) + sink_errors(self.heat, self.lubricant) + given_errors(self.heat, self.bearing.dimensions_at)
        errors += cleanliness_errors(self)
        return errors + range_errors(self) + estimation_errors(self) + watcher_errors(self)


def _without_estimates(scene: Scene, paths: Container[str]) -> Scene:
    """Return a scene in whose bearing none of the fields at these paths counts as estimated, because somebody has given them."""
    bearing = scene.bearing
    kept = tuple(each for each in bearing.estimated if f"bearing.{each.field}" not in paths)
    return scene if len(kept) == len(bearing.estimated) else replace(scene, bearing=replace(bearing, estimated=kept))


def cleanliness_errors(scene) -> list[str]:
    """Return an error message for a cleanliness class of oil that is asked for a grease, or the other way round."""
    name, greased = scene.life.a_iso, scene.lubricant.grease is not None
    if name == "none" or name.startswith("grease_") == greased:
        return []
    kinds = [each for each in typing.get_args(CLEANLINESS) if each != "none" and each.startswith("grease_") == greased]
    classed, used = ("oil", "grease") if greased else ("grease", "oil")
    return [f"life.a_iso: {name} is a class of {classed}, and the bearing runs in {used}; expected one of {', '.join(kinds)}, or none"]


def moment_errors(scene) -> list[str]:
    """Return error messages for a moment beyond the capacity of a bearing of this size."""
    bearing, moment = scene.bearing, scene.operating.moment
    bound = rate(bearing).static * bearing.roller.length
    if moment is None or moment <= bound:
        return []
    return [
        f"operating.moment: {moment:.6g} N m is beyond the capacity of the bearing; expected at most {bound:.6g} N m, the static load rating times "
        f"roller.length"
    ]


def step_errors(scene) -> list[str]:
    """Return error messages for a fixed step that is too long: without error control it would skip lobes or rollers."""
    step, bearing, speed = scene.integration.fixed_step, scene.bearing, abs(scene.operating.shaft_speed)
    if step is None or speed == 0.0:
        return []
    pitch = 2 * math.pi / (bearing.roller.count * 0.5 * speed * (1 - bearing.diameter_ratio))
    if step <= _LONGEST_STEP * pitch:
        return []
    bound = f"at most half a pitch, {1e6 * _LONGEST_STEP * pitch:.6g} us, or adaptive steps (leave fixed_step out)"
    taken = f"{step / pitch:.3g} roller pitches of the cage at {speed * 30 / math.pi:.6g} rpm"
    return [f"integration.fixed_step: {1e6 * step:.6g} us is {taken}; expected {bound}"]
