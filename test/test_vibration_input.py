# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage speed out of blocks of vibration that come while a model runs: windows, gaps, refusals, the process that analyses them."""

import math
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from synthetic_vibration import Machine, record

from bearing_sim.scene.loader import SceneError, scene_from_mapping
from bearing_sim.watchers.vibration.meter import CageSpeedMeter
from bearing_sim.watchers.vibration.reading import Block, block_of
from bearing_sim.watchers.vibration.worker import Outcome

RATE, LENGTH, SPEED = 1000.0, 100, 300.0
FOUND = Outcome(True, True, "outer_ring", "", 0.4, 0.001, 120.0, 0.3, SPEED)


def scene(**vibration):
    return scene_from_mapping(
        {
            "name": "rig",
            "bearing": "NU 210/C3",
            "lubricant": {"oil": "ISO VG 68", "supply": "oil_bath", "temperature": "60 degC"},
            "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
            "vibration": {"window": "1 s", **vibration},
        }
    )


def blocks(count, rate=RATE, first=0):
    return [Block(np.sin(np.arange(LENGTH) + number), rate, number) for number in range(first, first + count)]


class Fed:
    """A meter, with the windows that it hands over; outcomes come when they are let go."""

    def __init__(self, **vibration):
        self.windows, self.events, self.free = [], [], threading.Event()
        self.meter = CageSpeedMeter(scene(**vibration), self.analysed)
        self.now = 0.0

    def analysed(self, window):
        self.windows.append(window)
        self.free.wait(30.0)
        return FOUND

    def feed(self, found, speed=SPEED, spacing=LENGTH / RATE):
        for block in found:
            self.now += spacing
            self.events += self.meter.receive(block, self.now, speed)

    @property
    def kinds(self):
        return [event.kind for event in self.events]


@pytest.fixture
def fed():
    made = Fed()
    yield made
    made.free.set()
    made.meter.close()


def until(condition):
    end = time.monotonic() + 120.0  # [s] on a busy machine
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.005)


def test_blocks_become_windows_with_the_shaft_speed_of_each_instant_and_readings_follow_the_speed_of_now(fed):
    for number, block in enumerate(blocks(10)):
        fed.feed([block], speed=100.0 + number)
    until(lambda: fed.windows)
    (window,) = fed.windows
    assert len(window.samples) == 1000 and window.rate == RATE and window.geometry.rollers == scene().bearing.roller.count
    assert window.shaft_speed[[0, 50, 500, 999]] == pytest.approx([100.0, 100.0, 104.5, 109.0]) and not fed.events
    assert fed.meter.readings(SPEED) == []
    fed.free.set()
    found = []
    until(lambda: found.extend(fed.meter.readings(-0.5 * SPEED)) or found)
    assert found == [(pytest.approx(-60.0), pytest.approx(0.15))] and "outer ring shows" in fed.meter.last


def test_lost_and_late_blocks_begin_the_window_again_and_are_counted(fed):
    fed.feed(blocks(9))
    fed.feed(blocks(4, first=12))
    assert fed.kinds == ["vibration.gap"] and "block 12 follows block 8" in fed.events[0].text
    assert fed.meter.values(0.0)["vibration: blocks lost"] == 3
    fed.now += 2.0
    fed.feed([block._replace(sequence=None) for block in blocks(5)])
    assert fed.kinds[1:] == ["vibration.gap"] and "later than the samples" in fed.events[1].text and not fed.windows
    fed.feed(blocks(3, rate=2000.0), spacing=0.05)
    assert fed.kinds[2:] == ["vibration.gap"] and "1000 to 2000 Hz" in fed.events[2].text


def test_a_rate_that_arrivals_contradict_is_said_and_nothing_follows_from_it():
    fed = Fed(window="20 s")
    fed.feed(blocks(200), spacing=0.05)
    assert fed.kinds == ["vibration.rate"] and "20 s" not in fed.events[0].text and not fed.windows
    fed.meter.close()


def test_windows_that_come_faster_than_they_are_analysed_are_left_out_and_said(fed):
    fed.feed(blocks(10))
    until(lambda: fed.windows)
    fed.feed(blocks(40, first=10))
    assert fed.kinds == ["vibration.behind"] * 3 and fed.meter.values(0.0)["vibration: windows left out"] == 3


@pytest.mark.parametrize(
    ("block", "speed", "reason"),
    [
        (Block(np.ones(10), math.nan), SPEED, "label 'rate'"),
        (Block(np.ones(0), RATE), SPEED, "empty"),
        (Block(np.array([1.0, math.nan]), RATE), SPEED, "sample 1 of the block is nan"),
        (Block(np.ones(10), 4e9), SPEED, "shorten the window"),
        (Block(np.ones(10), RATE), math.nan, "no shaft speed has been measured yet"),
    ],
)
def test_a_block_that_cannot_be_used_is_refused_with_what_was_expected(fed, block, speed, reason):
    (event,) = fed.meter.receive(block, 1.0, speed)
    assert event.kind == "vibration.refused" and reason in event.text and fed.meter.values(0.0)["vibration: blocks refused"] == 1


def test_an_analysis_that_fails_ends_nothing(fed):
    fed.meter._analysed = lambda window: 1 / 0
    fed.feed(blocks(10))
    until(lambda: not fed.meter.readings(SPEED) and "division by zero" in fed.meter.last)
    fed.feed(blocks(10, first=10))
    until(lambda: not fed.meter.readings(SPEED) and fed.meter.values(0.0)["vibration: windows"] == 2)


@pytest.mark.long
def test_the_process_finds_the_cage_in_a_window_and_says_that_noise_has_no_line():
    own = scene(window="2 s")
    size = own.bearing.roller.diameter / own.bearing.pitch_diameter
    meter = CageSpeedMeter(own)
    machine = Machine("outer_ring", own.bearing.roller.count, size, 0.05, 314.0, interfering=0)
    synthetic = record(machine, 25_600.0, 2.0, np.random.default_rng(3))
    found = []
    for samples in (synthetic.vibration.samples, np.random.default_rng(4).normal(size=51_200)):
        before = meter.values(0.0)["vibration: windows"]
        assert meter.receive(Block(samples, 25_600.0), 0.0, 314.0) == []
        until(lambda: found.extend(meter.readings(314.0)) or meter.values(0.0)["vibration: windows"] > before)
    assert meter.values(0.0)["vibration: windows without a claim"] == 1 and "no line of this bearing" in meter.last, meter.values(0.0)
    ((speed, error),) = found
    assert abs(speed / (2.0 * math.pi * synthetic.shaft_frequency * synthetic.ratio) - 1.0) < 0.02 and 0.0 < error < 4.0
    meter.close()


def test_a_message_tells_its_samples_rate_and_number():
    def sized(label, size):
        return SimpleNamespace(label=label, size=size)

    message = SimpleNamespace(data=[1.0, 2.0], layout=SimpleNamespace(dim=[sized("rate", 50_000), sized("sequence", 7)]))
    block = block_of(message)
    assert block.rate == 50_000.0 and block.sequence == 7 and list(block.samples) == [1.0, 2.0]
    assert math.isnan(block_of(SimpleNamespace(data=[1.0])).rate) and block_of(SimpleNamespace(data=[1.0])).sequence is None


def test_absurd_settings_are_refused_with_the_field_and_nothing_is_listened_to_unless_asked():
    for settings, field in (
        ({"window": "2 h"}, "vibration.window"),
        ({"rate": "1 GHz"}, "vibration.rate"),
        ({"tolerance": "0 %"}, "vibration.tolerance"),
    ):
        with pytest.raises(SceneError, match=field):
            scene(**settings)
    assert scene().vibration.is_asked and not scene(window="0 s").vibration.is_asked
