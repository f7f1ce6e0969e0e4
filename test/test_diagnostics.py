# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Diagnostics as programs that collect them understand them: one status of a name, always there, never stale, OK as soon as it is."""

import importlib.util
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from aggregator import ERROR, OK, STALE, WARN, Aggregator, statuses_of

from bearing_sim.messages.diagnostics import SUBJECTS, UNUSED, WHOLE, event_report, events_of, report, subject_of
from bearing_sim.messages.events import Event, Level
from bearing_sim.runtime.health import not_running

ROOT = Path(__file__).resolve().parents[1]
ANALYZERS = yaml.safe_load((ROOT / "launch_scripts" / "diagnostic_analyzers.yaml").read_text())["/**"]["ros__parameters"]
NAMES = [f"bearing_node: {name}" for name in (WHOLE, *(subject.name for subject in SUBJECTS))]


def kinds_of_events():
    """Return the levels of all kinds of events, from the reference."""
    place = ROOT / "doc" / "_extensions" / "generated_reference.py"
    spec = importlib.util.spec_from_file_location("generated_reference_of_events", place)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return {kind: levels for kind, (levels, _) in module.EVENTS.items()}


KINDS = kinds_of_events()


@pytest.mark.parametrize(
    "settings, statuses, expected",
    [
        ({}, {"a": OK, "b": WARN}, WARN),
        ({}, {"a": OK, "b": STALE}, ERROR),
        ({}, {"a": STALE, "b": STALE}, STALE),
        ({}, {}, STALE),
        ({"discard_stale": True}, {}, OK),
        ({"num_items": 2}, {"a": OK, "b": OK}, OK),
        ({"num_items": 3}, {"a": OK, "b": OK}, ERROR),
        ({"expected": ["c"]}, {"a": OK}, ERROR),
    ],
)
def test_the_check_follows_the_published_rules_of_an_analyzer(settings, statuses, expected):
    analyzer = {"type": "diagnostic_aggregator/GenericAnalyzer", "path": "x", "contains": ["a", "b"], **settings}
    aggregator = Aggregator({"path": "top", "x": analyzer})
    aggregator.receive(0.0, [(name, level, "") for name, level in statuses.items()])
    assert aggregator.report(1.0)["/top/x"] == aggregator.report(1.0)["/top"] == expected


def test_the_check_forgets_nothing_and_sees_a_silent_name_as_stale_and_so_as_an_error_of_its_group():
    """What a report of events alone led to: after the cure the group stays at ERROR, and of two statuses of a name the last one wins."""
    aggregator = Aggregator({"path": "top", "x": {"type": "diagnostic_aggregator/GenericAnalyzer", "path": "x", "contains": ["n: "]}})
    aggregator.receive(0.0, [("n: condition", WARN, ""), ("n: input.stale", ERROR, "speed"), ("n: input.stale", WARN, "load")])
    assert aggregator.report(0.0)["/top"] == WARN
    for second in range(1, 7):
        aggregator.receive(float(second), [("n: condition", OK, "")])
    assert aggregator.report(6.5)["/top/x/n: input.stale"] == STALE and aggregator.report(6.5)["/top"] == ERROR


def test_a_report_has_every_subject_once_whatever_holds_and_each_has_a_value():
    values = {"cage slip [fraction]": 0.06, "level": "slip", "phase": "running", "state": "active"}
    for events in ([], [Event(1.0, Level.WARN, kind, "shaft_speed", "reason") for kind in KINDS]):
        statuses = report(0, events, values, "bearing_node", "A-17")["status"]
        shown = {pair["key"]: pair["value"] for status in statuses[1:] for pair in status["values"]}
        assert {key: shown[key] for key in values} == {**values, "cage slip [fraction]": "0.06"}, "no event hides a number"
        assert [status["name"] for status in statuses] == NAMES
        assert all(status["values"] and status["hardware_id"] == "A-17" for status in statuses)
        assert all(len({pair["key"] for pair in status["values"]}) == len(status["values"]) for status in statuses)


def test_every_kind_of_event_has_a_subject_of_its_own_word_and_names_of_subjects_are_words_for_programs():
    named = {kind: subject_of(Event(0.0, Level.WARN, kind, "", "")) for kind in KINDS}
    assert {kind for kind, subject in named.items() if subject == "run"} == {
        kind for kind in KINDS if kind.startswith(("run.", "solver.", "reproduction.")) and kind != "run.behind"
    }
    assert subject_of(Event(0.0, Level.WARN, "input.stale", "radial_load", "")) == "radial_load"
    assert subject_of(Event(0.0, Level.WARN, "sink.failed", "view", "")) == "view"
    assert named["run.behind"] == "pace" and named["bearing.life_used"] == named["bearing.remaining_life"] == "life"
    assert len(set(NAMES)) == len(NAMES) and all(subject.name.replace("_", "").isalpha() and subject.name.islower() for subject in SUBJECTS)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_each_fault_shows_in_its_subject_alone_and_its_cure_is_seen_within_a_report(kind):
    level = max((Level[name] for name in KINDS[kind].split(", ") if name in Level.__members__), default=Level.OK)
    event = Event(10.0, level, kind, "", "reason")
    aggregator = Aggregator(ANALYZERS)
    for second in range(30):
        holding = [event] if 10 <= second < 20 else []
        aggregator.receive(float(second), statuses_of(report(second, holding, {}, "bearing_node")))
        levels = aggregator.report(second + 0.9)
        assert levels["/Bearings"] == (level if holding else OK)
        wrong = {path.rpartition(": ")[2] for path, found in levels.items() if found and ": " in path}
        assert wrong == ({subject_of(event), WHOLE} if holding and level else set())
    assert "/Bearings/Other" not in levels
    assert aggregator.report(40.0)["/Bearings"] == STALE, "the node has ended"


def test_an_expected_number_of_items_is_the_number_of_subjects_of_the_bearings():
    counted = {**ANALYZERS, "inputs": {**ANALYZERS["inputs"], "num_items": 9}}
    aggregator = Aggregator(counted)
    aggregator.receive(0.0, statuses_of(report(0, component="bearing_node/front")))
    assert aggregator.report(0.0)["/Bearings/Inputs"] == OK
    aggregator.receive(0.0, statuses_of(report(0, component="bearing_node/rear")))
    assert aggregator.report(0.0)["/Bearings/Inputs"] == ERROR, "a second bearing has as many again"


def test_subjects_that_a_run_does_without_share_one_status_that_is_always_there_unless_there_is_something_to_say_of_them():
    unused, why = {"view", "vibration", "oil_temperature", "estimate"}, {"view": "no view"}
    names = lambda made: [status["name"].partition(": ")[2] for status in made["status"]]  # noqa: E731
    made = report(0, [], {}, "n", "", why, "OK", unused)
    assert names(made) == [name for name in (WHOLE, *(each.name for each in SUBJECTS), UNUSED) if name not in unused]
    told = status(made, UNUSED)
    assert told.message == "not used: oil_temperature, vibration, estimate, view" and told.level == OK
    assert {pair.key: pair.value for pair in told.values if pair.value} == {**dict.fromkeys(unused, "OK"), "view": "no view", "events": "0"}
    failed = report(0, [Event(1.0, Level.WARN, "sink.failed", "view", "does not start")], {}, "n", "", why, "OK", unused)
    assert "view" in names(failed) and status(failed, "view").level == WARN and "view" not in status(failed, UNUSED).message
    assert status(report(0, [], {}, "n", unused=()), UNUSED).message == "not used: nothing"
    assert UNUSED not in names(report(0)), "a recording has all"


def test_without_anything_optional_no_group_of_the_example_is_empty_which_would_be_stale():
    aggregator = Aggregator(ANALYZERS)
    condition = not_running(Event(0.0, Level.OK, "run.inactive", "", "inactive"))
    aggregator.receive(0.0, statuses_of(report(0, condition.events, {}, "bearing_node", "", {}, condition.otherwise, condition.unused)))
    assert set(aggregator.report(0.0).values()) == {OK} and "/Bearings/Other" not in aggregator.report(0.0)


@pytest.mark.parametrize("node", ["bearing_node", "ship/bearing_node", "bearing_node/front", "front/bearing_front", "plant/hall/bearing_node/rear"])
def test_the_example_takes_all_statuses_of_a_node_whatever_its_namespace_and_none_of_another(node):
    aggregator = Aggregator(ANALYZERS)
    aggregator.receive(0.0, [*statuses_of(report(0, component=node)), ("motor: slip", WARN, ""), ("camera: life", WARN, "")])
    levels = aggregator.report(0.0)
    assert sorted(path for path in levels if path.startswith("/Bearings/Other/")) == ["/Bearings/Other/camera: life", "/Bearings/Other/motor: slip"]
    assert len([path for path in levels if ": " in path and "Other" not in path]) == len(NAMES)


def status(made, name):
    """Return a status of a report as a message."""
    (found,) = [status for status in made["status"] if status["name"].endswith(f": {name}")]
    values = [SimpleNamespace(**pair) for pair in found["values"]]
    return SimpleNamespace(name=found["name"], level=found["level"][0], message=found["message"], values=values)


def test_events_of_one_subject_share_its_status_the_worst_first_and_can_be_read_back():
    events = [
        Event(2.0, Level.WARN, "input.rate", "shaft_speed", "2 Hz"),
        Event(2.0, Level.ERROR, "input.not_finite", "shaft_speed", "nan rad/s is not finite", "message refused", 7),
        Event(2.0, Level.OK, "input.returned", "inner_ring_temperature", "it is measured again"),
    ]
    made = report(0, events)
    speed = status(made, "shaft_speed")
    assert speed.level == ERROR
    assert speed.message == "shaft_speed: nan rad/s is not finite; message refused (and 1 more)"
    assert events_of(2.0, speed) == [events[1], events[0]]
    assert events_of(2.0, status(made, "inner_ring_temperature")) == events[2:]
    assert events_of(2.0, status(made, WHOLE)) == events_of(2.0, status(made, "slip")) == []
    statuses = event_report(0, events[0])["status"]
    assert [event for each in statuses for event in events_of(2.0, status({"status": [each]}, "shaft_speed"))] == events[:1]


def test_statuses_of_earlier_versions_and_of_other_programs_are_read_as_events():
    values = [
        SimpleNamespace(key=key, value=value) for key, value in {"subject": "radial_load", "reason": "late", "action": "held", "count": "3"}.items()
    ]
    earlier = SimpleNamespace(name="bearing_sim: input.stale", level=1, message="radial_load: late; held (3 times)", values=values)
    assert events_of(5.0, earlier) == [Event(5.0, Level.WARN, "input.stale", "radial_load", "late", "held", 3)]
    other = SimpleNamespace(name="pump: pressure", level=2, message="too low", values=[])
    assert events_of(5.0, other) == [Event(5.0, Level.ERROR, "pressure", "", "too low")]
