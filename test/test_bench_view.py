# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench of the view measures what it says; how fast things are is for the bench, not for a test."""

import math

import pytest

from bearing_sim.screenshot import HOW_TO_GET_VULKAN, ViewerFailed
from bearing_sim.studies.bench_view import run_hour, run_view_bench


def test_every_stretch_is_measured_and_the_solver_goes_on_in_all_of_them():
    try:
        report = run_view_bench(0.3, 0.3)
    except ViewerFailed as fault:
        if HOW_TO_GET_VULKAN not in str(fault):
            raise
        pytest.skip(f"needs a Vulkan driver: {fault}")
    found = {stretch["name"]: stretch for stretch in report["stretches"]}
    assert list(found)[:4] == ["no view", "view, no viewer", "viewer attached", "viewer frozen for 0.3 s"]
    assert {"viewer killed", "view itself frozen for 0.3 s"} < set(found)
    for stretch in found.values():
        assert 0.0 < stretch["wall_rate"] <= 1.01 * stretch["rate"]
        assert 0.0 < stretch["work"] <= 1.5 / stretch["rate"], "in all the time there was, but for the grain of the books"
        assert 0.0 <= stretch["late_wait"] <= stretch["worst_wait"] <= stretch["worst_tick"]
        assert math.isfinite(stretch["rate_ratio"]) and stretch["dropped"] == 0


def test_a_long_run_is_written_and_opened_whole():
    try:
        found = run_hour(5.0)
    except ViewerFailed as fault:
        if HOW_TO_GET_VULKAN not in str(fault):
            raise
        pytest.skip(f"needs a Vulkan driver: {fault}")
    assert found["samples"] == 5000 and found["bytes"] > 1e5 and found["viewer_bytes"] > 1e7 and found["problems"] == []
    assert found["first_second"] == pytest.approx(1e-3) and found["last_second"] >= 5.0
