# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Diagnostics: one diagnostic_msgs/DiagnosticStatus for each subject of a bearing, whether there is anything to say about it or not.

Programs that collect diagnostics, such as diagnostic_aggregator, know a status by its name alone, keep the newest of each name, and take a
name that is silent for some seconds for a fault.  A report therefore has every subject of `SUBJECTS` that the run uses, in every state, once; those
that it does without share the status `UNUSED`.  An event belongs to one subject (`subject_of`); several events of a subject share its status.

Alarms are raised where the text of a status changes.  So a text changes with the state alone; numbers, which change all the time, are values.
"""

import math
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import ARRAYS, INPUTS, LIFE_SYMBOLS, MEASURED_CHANNELS, ZERO_CELSIUS, header
from bearing_sim.model.sample import RING_TEMPERATURES

WHOLE = "condition"
"""The subject of the first status of a report: its level and message are those of the worst event, its values are all numbers."""

UNUSED = "unused"
"""The subject of the last status of a report: the names of the subjects that the run does without, and why."""


class Subject(NamedTuple):
    """What one status of a bearing is about.

    Attributes
    ----------
    name : second half of the status' name, after the component.
    meaning : for people.
    kinds : beginnings of the kinds of its events; of several that fit, the longest decides.
    values : beginnings of the keys of the numbers that its status shows, too.
    """

    name: str
    meaning: str
    kinds: tuple[str, ...] = ()
    values: tuple[str, ...] = ()


SETTING_ERRORS = ("measured slip error [fraction]", "measured life error [fraction]")
"""Keys of the errors of the setting that runs, as `bearing-sim trade` has measured them; of slip 0.01 is a point."""
_CHANNELS = (*INPUTS, *MEASURED_CHANNELS)
SUBJECTS = tuple(
    Subject(name, entry["meaning"], tuple(entry.get("kinds", ())), tuple(entry.get("values", ())))
    for name, entry in tomllib.loads(Path(__file__).with_name("subjects.toml").read_text("utf-8")).items()
)
"""The subjects of a bearing, in the order of a report, from ``subjects.toml``."""

JUDGED = ("slip", "life", "film", "pocket_force", "clearance", "residual", "validity")
"""The subjects that samples are judged by."""


def sink_subject(name: str) -> str:
    """Return the name of the subject of a sink (see `bearing_sim.runtime.sink_registry.SinkRegistry`)."""
    return "view" if name == "view" else "recording"


def subject_of(event: Event) -> str:
    """Return the name of the subject that an event belongs to; a kind of another program belongs to the run."""
    if event.kind.startswith("input.") and event.subject in _CHANNELS:
        return event.subject
    if event.kind.startswith(("sink.", "recording.")):
        return sink_subject(event.subject)
    return _subject_of_kind(event.kind)


@cache
def _subject_of_kind(kind: str) -> str:
    fitting = [(len(begin), subject.name) for subject in SUBJECTS for begin in subject.kinds if kind.startswith(begin)]
    return max(fitting, default=(0, "run"))[1]


@cache
def _subjects_of_value(key: str) -> tuple[str, ...]:
    return tuple(subject.name for subject in SUBJECTS if key.startswith(subject.values or ("\0",)))


def report(
    stamp_ns: int,
    events: Iterable[Event] = (),
    values: Mapping[str, object] = MappingProxyType({}),
    component: str = "bearing_sim",
    hardware_id: str = "",
    remarks: Mapping[str, str] = MappingProxyType({}),
    otherwise: str = "OK",
    unused: Collection[str] | None = None,
) -> dict:
    """Return diagnostic_msgs/DiagnosticArray: one status for the whole, then one for each subject.

    Parameters
    ----------
    stamp_ns : time of the message [ns since the epoch].
    events : what holds now.
    values : key to value, the unit written in the key (see `condition`); shown with the first status, and with their subjects.
    component : first half of each status' name: the node's name by convention, and the bearing's where the node has several.
    hardware_id : of the bearing.
    remarks : messages of subjects without events, by name.
    otherwise : message of subjects without events or remark.
    unused : subjects that share the status `UNUSED` unless they have events; None: there is no such status.
    """
    events = list(events)
    of_subject: dict[str, list[Event]] = {}
    for event in events:
        of_subject.setdefault(subject_of(event), []).append(event)
    shown: dict[str, dict[str, object]] = {}
    for key, value in values.items():
        for name in _subjects_of_value(key):
            shown.setdefault(name, {})[key] = value
    status = [_status(component, WHOLE, hardware_id, events, {**values, "events": len(events)}, otherwise)]
    left_out = {subject.name for subject in SUBJECTS} & set(unused or ()) - of_subject.keys()
    for subject in SUBJECTS:
        if subject.name in left_out:
            continue
        own = of_subject.get(subject.name, ())
        told = {**shown.get(subject.name, {}), "events": len(own), **_event_values(own)}
        status.append(_status(component, subject.name, hardware_id, own, told, remarks.get(subject.name, otherwise)))
    if unused is not None:
        why = {subject.name: remarks.get(subject.name, otherwise) for subject in SUBJECTS if subject.name in left_out}
        status.append(_status(component, UNUSED, hardware_id, (), {**why, "events": 0}, f"not used: {', '.join(why) or 'nothing'}"))
    return {"header": header(stamp_ns), "status": status}


def event_report(stamp_ns: int, event: Event, component: str = "bearing_sim", hardware_id: str = "") -> dict:
    """Return diagnostic_msgs/DiagnosticArray with one event, in the status of its subject; a recording has one at the time of each event."""
    values = {"events": 1, **_event_values([event])}
    return {"header": header(stamp_ns), "status": [_status(component, subject_of(event), hardware_id, [event], values, "")]}


def _status(component: str, subject: str, hardware_id: str, events: Sequence[Event], values: Mapping[str, object], remark: str) -> dict:
    """Return the status of a subject: the level of the worst event, its text, and how many others there are."""
    level, text = Level.OK, remark
    if events:
        worst = max(events, key=lambda event: event.level)
        level, text = worst.level, worst._replace(count=1).text  # how often is a value
        if len(events) > 1:
            text += f" (and {len(events) - 1} more)"
    pairs = [{"key": key, "value": f"{value:.9g}" if isinstance(value, float) else str(value)} for key, value in values.items()]
    return {"level": bytes([level]), "name": f"{component}: {subject}", "message": text, "hardware_id": hardware_id, "values": pairs}


def _event_values(events: Sequence[Event]) -> dict[str, object]:
    """Return the fields of the events of a status, the worst first; the keys of the second begin with ``2: `` and so on."""
    values: dict[str, object] = {}
    for number, event in enumerate(sorted(events, key=lambda event: -event.level), 1):
        prefix = f"{number}: " if number > 1 else ""
        fields = {"kind": event.kind, "severity": event.level.name, "subject": event.subject, "time [s]": event.time}
        fields |= {"reason": event.reason, "action": event.action, "count": event.count if event.count > 1 else ""}
        values |= {f"{prefix}{key}": value for key, value in fields.items() if value != ""}
    return values


def events_of(time: float, status) -> list[Event]:
    """Return the events of a diagnostic_msgs/DiagnosticStatus that this package, an earlier version of it, or another program has made.

    The status of the whole has none: it repeats those of the others.

    Parameters
    ----------
    time : of the events [s].
    status : deserialised message; of another program's status, the message becomes the reason.
    """
    component_subject, values = status.name.partition(": ")[2] or status.name, {pair.key: pair.value for pair in status.values}
    if component_subject == WHOLE:
        return []
    if "events" not in values:
        return [_only_event_of(time, status, component_subject, values)]
    events, prefix = [], ""
    while f"{prefix}kind" in values:
        get = lambda key: values.get(f"{prefix}{key}", "")  # noqa: E731
        events.append(Event(time, Level[get("severity")], get("kind"), get("subject"), get("reason"), get("action"), int(get("count") or 1)))
        prefix = f"{len(events) + 1}: "
    return events


def _only_event_of(time: float, status, kind: str, values: Mapping[str, str]) -> Event:
    """Return the event of a status of another program, or of a version of this one that gave each event a status of its own."""
    if "reason" not in values:
        return Event(time, Level(int(status.level)), kind, "", status.message)
    count = int(values.get("count", 1))
    return Event(time, Level(int(status.level)), kind, values.get("subject", ""), values["reason"], values.get("action", ""), count)


def condition(sample) -> dict[str, float]:
    """Return the numbers of one sample for diagnostics, in the units of the topics, which stand in the keys."""
    return {
        "shaft speed [rad/s]": float(sample["shaft_speed"]),
        "radial load [N]": math.hypot(sample["load_y"], sample["load_z"]),
        "oil temperature [degC]": float(sample["oil_temperature"]) - ZERO_CELSIUS,
        "running clearance [m]": float(sample["running_clearance"]),
        "cage slip [fraction]": float(sample["cage_slip"]),
        "rating life [h]": float(sample["rating_life"]),
        "damage [fraction of life]": float(sample["damage"]),
    }


def further_condition(scene, sample) -> dict[str, object]:
    """Return the numbers that depend on the scene, in addition to `condition`: which life, the standards' lives, pressures and tilts by slices."""
    numbers = {"life method": scene.life.method}
    if not scene.life.is_basic:
        numbers["modified rating life [h]"] = float(sample["modified_rating_life"])
    numbers |= {f"{symbol} [h]": float(sample[name]) for name, symbol in LIFE_SYMBOLS.items()}
    if scene.uses_ring_temperatures:
        shown = (*ARRAYS["predicted_temperatures"].fields, *(f"{name}_measured" for name in RING_TEMPERATURES))
        celsius = {name: float(sample[name]) - ZERO_CELSIUS for name in shown}
        numbers |= {f"{name.replace('_', ' ')} [degC]": value for name, value in celsius.items() if not math.isnan(value)}
    if scene.bodies_tilt:
        for name, fields in (("largest", ("inner_pressure", "outer_pressure")), ("largest edge", ("inner_edge_pressure", "outer_edge_pressure"))):
            numbers[f"{name} pressure [Pa]"] = max(float(sample[field]) for field in fields)
        numbers["largest roller tilt [rad]"] = float(np.abs(sample["roller_tilt"]).max())
        numbers["largest roller skew [rad]"] = float(np.abs(sample["roller_skew"]).max())
    return numbers
