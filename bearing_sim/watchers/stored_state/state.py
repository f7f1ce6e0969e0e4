# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is remembered of one bearing: whose it is, its totals, the times that they contain, and what the monitor has learned about it."""

import copy
import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import AfterValidator, FiniteFloat, PlainValidator, TypeAdapter, ValidationError

from bearing_sim.files.kept import Damaged
from bearing_sim.files.provenance import package_version
from bearing_sim.scene.scene import OPERATING_POINT, Scene
from bearing_sim.scene.uncertainty import value_at
from bearing_sim.watchers.stored_state.covered import Covered
from bearing_sim.watchers.stored_state.totals import Criteria, Instant, Totals, totals_of

VERSION = 2
"""Of the contents of a state file; `migrated` brings older ones to it."""

_LONGEST_REASON = 300  # characters
_DAY, _HOUR = 86_400_000_000_000, 3_600_000_000_000  # [ns]
_MOST_ESTIMATES = 400  # entries of the history of calibrated fields; a longer one is kept at wider intervals
_SAME_STRETCH = 1_000_000  # [ns] between samples that follow each other: stamps are rounded
_CALIBRATED = "lubricant.mixture_fraction"  # what `bearing-sim calibrate` fits unless told otherwise
_OF_BEARING = (
    "bearing.name",
    "bearing.roller.count",
    "bearing.roller.diameter",
    "bearing.roller.length",
    "bearing.inner_raceway.radius",
    "bearing.outer_raceway.low_radius",
    "bearing.outer_raceway.lobes",
)
_OF_SCENE = ("name", "life.method", "life.reliability")
_SAME = 1e-9  # relative difference of two numbers that are one


@dataclass
class Thermal:
    """Temperatures of a thermal network.

    Attributes
    ----------
    time_ns : when [ns since the epoch].
    nodes : of its nodes [K], in the order of `bearing_sim.model.sample.NODE_OBSERVABLES`.
    rings : of inner and outer ring without what measured temperatures have corrected [K].
    """

    time_ns: Instant
    nodes: list[FiniteFloat]
    rings: list[FiniteFloat]


class PastEstimates(NamedTuple):
    """Calibrated fields at an instant.

    Attributes
    ----------
    time_ns : [ns since the epoch].
    fields : value, 5 and 95 % quantile [SI] by dotted path.
    """

    time_ns: Instant
    fields: dict[str, tuple[FiniteFloat, FiniteFloat, FiniteFloat]]


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("expected printable characters")
    return text


_STRETCHES = TypeAdapter(list[tuple[Instant, Instant]])


@dataclass
class StoredState:
    """The state of a bearing in service.

    Attributes
    ----------
    serial : its number; ``""`` where none is given.
    identity : scene fields by which another bearing or another scene is recognised, with their values.
    totals : since the bearing is in service.
    covered : the wall time whose running they contain.
    until_ns : the newest instant that was counted [ns since the epoch]; 0 before the first.
    days : totals by UTC day (``2026-11-23``) that are not in the history of days yet; today is always here.
    folds : how often days were moved to the history, so that none gets there twice.
    is_turning : whether the shaft turned at the end.
    calibration : the scene's values of fields that a calibration fits.
    thermal : of the thermal network; None without one.
    learned : statistics of residuals by what is compared (see `bearing_sim.watchers.monitoring.residual.ResidualMonitor.learned`), and what
        measurements have taught about uncertain fields, as ``estimation`` (see `bearing_sim.watchers.estimation.live.LiveEstimation.learned`).
    estimates : the calibrated fields as they were, at most one entry an hour.
    writes : how often it was written.
    created_ns, written_ns : when it was begun, and written last [ns since the epoch].
    retired_ns : when the bearing was taken out (``~/replace_bearing``); None while it is in service.
    """

    serial: Annotated[str, AfterValidator(_printable)]
    identity: dict[str, object]
    totals: Totals = field(default_factory=Totals)
    covered: Annotated[Covered, PlainValidator(lambda stretches: Covered(_STRETCHES.validate_python(stretches)))] = field(default_factory=Covered)
    until_ns: Instant = 0
    days: dict[str, Totals] = field(default_factory=dict)
    folds: Instant = 0
    is_turning: bool = False
    calibration: dict[str, FiniteFloat] = field(default_factory=dict)
    thermal: Thermal | None = None
    learned: dict[str, dict] = field(default_factory=dict)
    estimates: list[PastEstimates] = field(default_factory=list)
    writes: Instant = 0
    created_ns: Instant = 0
    written_ns: Instant = 0
    retired_ns: Instant | None = None

    def accumulate(self, block: np.ndarray, times_ns: np.ndarray, seconds: np.ndarray, by: Criteria, counted: np.ndarray | None = None) -> None:
        """Count samples.

        Parameters
        ----------
        block : samples in order, shape (n,); their damage is the bearing's (see `bearing_sim.watchers.stored_state.counting.LifeCounter`).
        times_ns : of the samples [ns since the epoch], shape (n,), int64.
        seconds : simulated time that each stands for, which ends at it [s], shape (n,).
        by : what they are classed by.
        counted : fraction of that time that counts, shape (n,); all of it where absent.
        """
        if not len(block):
            return
        used = np.maximum(np.diff(block["damage"], prepend=self.totals.damage), 0.0)
        self._cover(times_ns, seconds)
        if counted is not None:
            seconds = seconds * counted
        damage = max(float(block["damage"][-1]), self.totals.damage)
        numbers = times_ns // _DAY
        cuts = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), len(block)]
        for begin, end in zip(cuts, cuts[1:]):
            part = slice(begin, end)
            totals, self.is_turning = totals_of(block[part], times_ns[part], seconds[part], used[part], by, self.is_turning)
            self.totals.add(totals)
            if totals.monitored_seconds or totals.damage:
                self.days.setdefault(day_of(int(times_ns[begin])), Totals()).add(totals)
        self.totals.damage = damage  # the last digit of a sum depends on how it is divided
        self.until_ns = max(self.until_ns, int(times_ns[-1]))

    def _cover(self, times_ns: np.ndarray, seconds: np.ndarray) -> None:
        counts = seconds > 0.0
        times, begins = times_ns[counts], (times_ns - np.rint(1e9 * seconds).astype(np.int64))[counts]
        if not len(times):
            return
        cuts = [0, *(np.flatnonzero(begins[1:] - times[:-1] > _SAME_STRETCH) + 1).tolist(), len(times)]
        for first, after in zip(cuts, cuts[1:]):
            self.covered.cover(int(begins[first]), int(times[after - 1]))

    def note_estimates(self, time_ns: int, fields: Mapping[str, tuple[float, float, float]]) -> None:
        """Take the calibrated fields as they are at an instant [ns since the epoch], unless the newest entry is of the same hour.

        Parameters
        ----------
        fields : value, 5 and 95 % quantile [SI] by dotted path.
        """
        past = self.estimates
        if not fields or past and time_ns - past[-1].time_ns < max(_HOUR, (past[-1].time_ns - past[0].time_ns) // _MOST_ESTIMATES):
            return
        past = [*past, PastEstimates(time_ns, dict(fields))]
        self.estimates = past[::2] if len(past) > _MOST_ESTIMATES else past  # a new list: copies of the state share the old one

    def copy(self) -> "StoredState":
        """Return an independent state with the same contents."""
        days = {day: copy.copy(totals) for day, totals in self.days.items()}  # totals never change their lists
        return dataclasses.replace(self, totals=copy.copy(self.totals), covered=self.covered.copy(), days=days)

    def differences(self, scene: Scene, serial: str) -> list[str]:
        """Return what makes a bearing in a scene, with a serial number or ``""``, another one than this; empty for the same one."""
        found = [f"serial number {serial!r} instead of {self.serial!r}"] if serial and self.serial and serial != self.serial else []
        given, fitted = identity_of(scene), calibration_of(scene)
        for name, value in self.identity.items():
            if name in given and name not in fitted and not _is_same(given[name], value):
                found.append(f"{'scene ' if name == 'name' else ''}{name} {given[name]!r} instead of {value!r}")
        return found

    def adopt(self, scene: Scene, serial: str = "") -> None:
        """Take a scene, and a serial number where one is given, as this bearing's own."""
        self.identity, self.serial = identity_of(scene), serial or self.serial

    def as_mapping(self) -> dict[str, object]:
        """Return the contents of a state file."""
        return {
            **vars(self),  # not copied: what was learned and the estimates of years may be long, and this is called every few seconds
            "totals": dataclasses.asdict(self.totals),
            "covered": self.covered.stretches,
            "days": {day: dataclasses.asdict(totals) for day, totals in self.days.items()},
            "thermal": self.thermal and dataclasses.asdict(self.thermal),
            "package_version": package_version(),
        }

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, object]) -> "StoredState":
        """Return the state of the contents of a file of this `VERSION`.

        Raises
        ------
        Damaged
            They are not a state's.
        """
        if "totals" not in mapping:
            raise Damaged("it is not a bearing's state: it has no totals")
        try:
            return _CONTENTS.validate_python(mapping)
        except ValidationError as error:
            first = error.errors()[0]
            reason = f"{'.'.join(map(str, first['loc']))}: {first['msg']}; found {first['input']!r}"
            raise Damaged(f"it is not a bearing's state: {reason[:_LONGEST_REASON]}") from None


_CONTENTS = TypeAdapter(StoredState)


def new_state(scene: Scene, serial: str, now_ns: int) -> StoredState:
    """Return the state of a bearing that nothing is known about yet."""
    return StoredState(serial, identity_of(scene), calibration=calibration_of(scene), created_ns=now_ns)


def identity_of(scene: Scene) -> dict[str, object]:
    """Return the fields by which a bearing and its scene are recognised, with their values."""
    return {name: value_at(scene, name) for name in (*_OF_BEARING, *_OF_SCENE)}


def calibration_of(scene: Scene) -> dict[str, float]:
    """Return the values of the fields that a calibration fits: those that the scene calls uncertain, and the mixture fraction."""
    names = dict.fromkeys([_CALIBRATED, *(each.field for each in scene.uncertainty)])
    values = {name: value_at(scene, name) for name in names if name not in OPERATING_POINT.values()}
    return {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}


def day_of(time_ns: int) -> str:
    """Return the UTC day of an instant [ns since the epoch], such as ``2026-11-23``."""
    return f"{datetime.fromtimestamp(time_ns // 1_000_000_000, UTC):%Y-%m-%d}"


def time_text(time_ns: int) -> str:
    """Return an instant [ns since the epoch] as people write it, in UTC, to the second."""
    return f"{datetime.fromtimestamp(time_ns // 1_000_000_000, UTC):%Y-%m-%d %H:%M:%S} UTC"


def migrated(version: int, contents: Mapping[str, object]) -> Mapping[str, object]:
    """Return the contents of a state file of an older version as those of `VERSION`.

    Raises
    ------
    Damaged
        The version is unknown, or the contents are not what that version has.
    """
    if version not in range(VERSION + 1):
        raise Damaged(f"its version {version} is unknown")
    return contents if version else _from_books(contents)  # version 1 had no estimates, and nothing else has changed since


def _from_books(contents: Mapping[str, object]) -> dict[str, object]:
    """Migrate from version 0, which people write by hand for a bearing whose life so far is in the books of the plant."""
    numbers = {name: contents.get(name, 0) for name in ("damage", "running_hours", "revolutions", "starts")}
    if unknown := sorted(contents.keys() - numbers.keys() - {"serial"}):
        raise Damaged(f"version 0 has no {', '.join(unknown)}; expected some of {', '.join(sorted({*numbers, 'serial'}))}")
    for name, value in numbers.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < math.inf:
            raise Damaged(f"{name} = {value!r}: expected a finite number, not negative")
    seconds = 3600.0 * numbers.pop("running_hours")
    unclassed = {"slip_seconds": [0.0, 0.0, 0.0, seconds], "lubrication_seconds": [0.0] * 5 + [seconds]}
    totals = {**numbers, "running_seconds": seconds, "monitored_seconds": seconds, **unclassed}
    return {"serial": str(contents.get("serial", "")), "identity": {}, "totals": totals}


def _is_same(one: object, other: object) -> bool:
    if isinstance(one, (int, float)) and isinstance(other, (int, float)) and not isinstance(one, bool):
        return math.isclose(one, other, rel_tol=_SAME)
    return one == other
