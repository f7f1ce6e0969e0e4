# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The six situations show what their names say, in numbers and, where a Vulkan driver is there, in pictures without complaints.

The pictures are kept in the folder that the environment variable BEARING_SIM_PICTURES names, for people to look at.
"""

import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner
from rerun.chunk import RrdReader
from situations.__main__ import situations
from situations.situations import SITUATIONS

from bearing_sim.view.screenshot import HOW_TO_GET_VULKAN

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    wanted = os.environ.get("BEARING_SIM_PICTURES")
    return Path(wanted) if wanted else tmp_path_factory.mktemp("situations")


@pytest.fixture(scope="module")
def command_output(folder):
    """Return the output of the command, with pictures where there is a driver; it fails where a view or the viewer complains.

    Pictures that nobody wants to look at are small, and those of the lively levels are made of half the samples.
    """
    with pytest.MonkeyPatch.context() as patch:
        size = []
        if "BEARING_SIM_PICTURES" not in os.environ:
            size = ["--size", "1000x640"]
            coarse = [each if each.fault else each._replace(rate=0.5 * each.rate) for each in SITUATIONS]
            patch.setattr("situations.situations.SITUATIONS", tuple(coarse))
        return _output_of(["--out", str(folder), *size, "--json"])


def _output_of(words):
    result = CliRunner().invoke(situations, words)
    if HOW_TO_GET_VULKAN in result.output:
        result = CliRunner().invoke(situations, [*words, "--no-pictures", "--force"])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def reported(command_output):
    return json.loads(command_output)


def test_there_are_six(reported):
    assert len(reported) == 6 and list(reported) == [situation.name for situation in SITUATIONS]


def test_the_start_begins_at_rest_and_ends_rolling(reported, folder):
    found = reported["start_from_rest"]
    assert 5_000 < found["shaft_speed_rpm"] < 19_000, "in the middle of the run-up"
    states = [state for (state,) in _column(folder / "start_from_rest.rrd", "/regime", "StateChange:state")]
    assert states[0] == "at rest" and states[-1] == "rolling"


def test_under_a_light_load_the_lobes_keep_the_cage_steady(reported):
    found = reported["steady_light_load"]
    assert found["radial_load"] == pytest.approx(100.0) and 0.0 < found["slip"] < 0.05
    assert found["slip"] == pytest.approx(found["slip_at_last"], abs=2e-3)
    assert found["largest_load"] > 5 * found["radial_load"], "preload, not load"


def test_slip_rises_beyond_its_error_limit_in_the_gust_and_falls_after_it(reported):
    found = reported["skid_in_a_gust"]
    assert found["slip_at_first"] < 0.08 and found["slip_at_last"] < 0.08 and found["slip"] > 0.10
    assert found["events"].count("bearing.slip") >= 2


def test_rollers_of_a_misaligned_bearing_tilt_and_skew_and_of_others_do_not(reported):
    found = reported["misaligned"]
    assert 0.5e-3 < found["largest_tilt"] < 2e-3 and found["largest_skew"] > 0.1e-3
    assert all(other["largest_tilt"] == other["largest_skew"] == 0.0 for name, other in reported.items() if name != "misaligned")


def test_a_heavy_load_drives_the_cage_and_costs_life(reported):
    found = reported["heavy_load"]
    assert found["slip"] < 0.02 and found["rating_life"] < 100.0 < reported["steady_light_load"]["rating_life"]
    assert "bearing.life" in found["events"]


def test_the_injected_fault_shows_in_the_residual_alone(reported, folder):
    found = reported["fault_injected"]
    assert found["residual"] > 0.005 and found["slip"] == pytest.approx(found["slip_at_first"], abs=1e-3), "the model knows nothing of it"
    assert found["events"].index("study.fault") < found["events"].index("residual.shift")
    residuals = [value for (value,) in _column(folder / "fault_injected.rrd", "/slip/residual", "Scalars:scalars")]
    assert abs(sum(residuals[100:350]) / 250) < 0.05 < 0.5 < sum(residuals[-50:]) / 50, "points, before and after"


@pytest.mark.parametrize("name", [situation.name for situation in SITUATIONS])
def test_every_picture_is_drawn(name, folder, reported):
    if not (folder / f"{name}.png").exists():
        pytest.skip(f"needs a Vulkan driver: {HOW_TO_GET_VULKAN}")
    picture = (folder / f"{name}.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) > 100_000, "an empty window is a tenth of that"


def test_an_unknown_situation_is_told_with_those_there_are(folder):
    result = CliRunner().invoke(situations, ["--out", str(folder), "--only", "flight"])
    assert result.exit_code == 2 and "skid_in_a_gust" in result.output


def _column(path, entity, component):
    """Return the values of one component in the order of time."""
    rows = []
    for chunk in RrdReader(str(path)).stream():
        table = chunk.to_record_batch()
        if chunk.entity_path == entity and not chunk.is_static and component in table.schema.names:
            rows += zip(table.column("sim_time").cast("int64").to_pylist(), table.column(component).to_pylist())
    return [value for _, value in sorted(rows, key=lambda row: row[0])]
