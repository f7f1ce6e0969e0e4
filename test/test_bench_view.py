# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The benches of view and recording measure what they say; how fast things are is for the bench, not for a test."""

import pytest
from recording_overhead import DRAWING, NO_VIEW, TAKING, VIEWERS, command, recording_cost
from view_overhead import COUNTING, RATES, run_hour, run_view_bench

from bearing_sim.scene.loader import load_scene
from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN, ViewerFailed


@pytest.mark.long
def test_every_situation_is_measured_and_the_solver_goes_on_in_all_of_them():
    try:
        report = run_view_bench(0.5, 0.5)
    except ViewerFailed as fault:
        if HOW_TO_GET_VULKAN not in str(fault):
            raise
        pytest.skip(f"needs a Vulkan driver: {fault}")
    found = {situation["name"]: situation for situation in report["situations"]}
    assert list(found) == ["no viewer", "viewer attached", "viewer frozen", "viewer killed", "view itself frozen", COUNTING]
    for name in RATES:
        assert report["together"]["with"][name]["pairs"] == sum(one["with"][name]["pairs"] for one in found.values() if one["name"] != COUNTING)
    for situation in found.values():
        assert situation["wall_rate_with"] > 0.0 and situation["dropped"] == 0
        assert 0.0 <= situation["late_wait_with"] <= situation["worst_wait_with"] <= situation["worst_tick_with"]
        for kind in ("with", "control"):
            for name in RATES:
                spread = situation[kind][name]
                assert 0.0 < spread["low"] <= spread["median"] <= spread["high"] and spread["pairs"] >= 1


@pytest.mark.long
@pytest.mark.parametrize("viewer", [TAKING, NO_VIEW])
def test_what_recording_costs_is_measured_with_a_viewer_that_draws_elsewhere_and_without_a_view(viewer):
    report = recording_cost(load_scene("deng2017_table1"), 0.3, 1000.0, 1, viewer)
    assert report["viewer"] == viewer and report["dropped"] == 0 and report["recording_mb_per_second"] > 0.1
    assert report["with"]["rate"]["median"] > 0.0 and report["with"]["rate"]["pairs"] == 1


def test_the_command_offers_the_viewers_that_there_are():
    (option,) = (option for option in command.params if option.name == "viewer")
    assert tuple(option.type.choices) == VIEWERS and option.default == DRAWING


@pytest.mark.long
def test_what_recording_costs_is_measured_with_a_viewer_and_every_tick_is_counted():
    report = recording_cost(load_scene("deng2017_table1"), 0.3, 1000.0, 1)
    if report["viewer"] != DRAWING and HOW_TO_GET_VULKAN not in report["viewer"]:
        pytest.fail(report["viewer"])
    assert report["dropped"] == 0 and report["recording_mb_per_second"] > 0.05
    for name in ("rate", "core_rate", "processor_rate"):
        assert report["with"][name]["median"] > 0.0 and report["control"][name]["pairs"] == 1
    assert 0.0 <= report["without"]["late_held_ms"] <= report["without"]["worst_held_ms"] <= report["without"]["worst_stall_ms"] + 1e-9


@pytest.mark.long
def test_a_long_run_is_written_and_opened_whole():
    try:
        found = run_hour(2.0)
    except ViewerFailed as fault:
        if HOW_TO_GET_VULKAN not in str(fault):
            raise
        pytest.skip(f"needs a Vulkan driver: {fault}")
    assert found["samples"] == 2000 and found["bytes"] > 1e5 and found["viewer_bytes"] > 1e7 and found["problems"] == []
    assert found["first_second"] == pytest.approx(1e-3) and found["last_second"] >= 2.0
