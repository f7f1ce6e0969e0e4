# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Several publishers on one input: when they are told, and when they disagree."""

import math

from bearing_sim.inputs.gate import PublisherConflict
from bearing_sim.messages.events import Level


def watched(values, publishers=2):
    conflict = PublisherConflict("shaft_speed")
    conflict.publishers = publishers
    for value in values:
        conflict.receive((value,))
    return conflict


def test_one_sender_is_never_told_however_its_values_jump():
    conflict = watched([1000.0, 2000.0] * 20, publishers=1)
    assert conflict.disagreement and conflict.event(0.0) is None


def test_two_publishers_of_the_same_value_are_a_warning():
    event = watched([1000.0, 1001.0] * 20).event(3.0)
    assert event.level is Level.WARN and event.time == 3.0 and "2 publishers, expected one" in event.text


def test_two_publishers_whose_values_jump_to_and_fro_are_an_error_that_names_both():
    event = watched([1000.0, 1000.0, 1500.0] * 8).event(0.0)
    assert event.level is Level.ERROR and "and they disagree" in event.text
    assert watched([1000.0, 1000.0, 1500.0] * 8).values == {"shaft_speed jumps between": "1000 rad/s and 1500 rad/s"}


def test_a_manoeuvre_is_no_disagreement():
    ramp = [1000.0 + 100.0 * k for k in range(20)]
    assert not watched(ramp).disagreement and not watched(ramp + ramp[::-1]).disagreement
    assert not watched([1000.0 * math.sin(0.2 * k) for k in range(60)]).disagreement
    assert not watched([1000.0] * 30 + [2000.0] * 8).disagreement


def test_loads_that_differ_in_direction_alone_disagree():
    conflict = PublisherConflict("radial_load")
    conflict.publishers = 2
    for values in [(800.0, 0.0), (0.0, 800.0)] * 10:
        conflict.receive(values)
    assert "radial_load: 2 publishers" in conflict.event(0.0).text and conflict.values == {"radial_load jumps between": "0 N and 800 N"}


def test_too_few_messages_say_nothing():
    assert not watched([1000.0, 2000.0] * 3).disagreement
