# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The lay-out of the view: everything that is computed is shown, at the same paths at every level, with units, in colours that all can tell apart."""

import itertools
import re

import numpy as np
import pytest
import rerun as rr
import rerun.blueprint as rrb
from rerun_files import column, views_in, written
from synthetic_run import synthetic_block

from bearing_sim.messages.events import Event, Level, Measurement
from bearing_sim.messages.topics import MEASURED, MEASURED_CHANNELS, MEASURED_CLEARANCE
from bearing_sim.scene.loader import load_scene
from bearing_sim.view.blueprint import blueprint
from bearing_sim.view.drawings import BarDrawing
from bearing_sim.view.plots import AROUND, LINES, RunSeries, features, roller_series, table, threshold_lines
from bearing_sim.view.worker import RerunFile

SCENES = {level: load_scene("deng2017_table1", [f"level={level}"]) for level in ("steady", "slip", "planar", "spatial")}
SLIP = SCENES["slip"]
BOUNDS = ((-40, 40), (-40, 40))


pytestmark = pytest.mark.usefixtures("strict_rerun")


def shown(scene, **options):
    return list(views_in(blueprint(scene, BOUNDS, live=False, **options).root_container))


def plots(scene):
    return [view for view in shown(scene, measured=MEASURED_CHANNELS) if isinstance(view, rrb.TimeSeriesView)]


@pytest.mark.parametrize("level", SCENES)
def test_every_plot_says_its_unit(level):
    for plot in plots(SCENES[level]):
        assert re.search(r"\[.+\]|log10 of hours", plot.name), plot.name


def paths_in(tmp_path, scene, level_number):
    block = synthetic_block(scene, 1e-3 * np.arange(1, 30))
    block["level"] = level_number
    chunks = written(tmp_path / f"{scene.level}.rrd", scene, block)
    return {chunk.entity_path for chunk in chunks if not chunk.is_static}


def test_what_two_levels_have_in_common_stands_at_the_same_paths(tmp_path):
    found = [paths_in(tmp_path, scene, number) for number, scene in enumerate(SCENES.values())]
    for cheaper, dearer in itertools.pairwise(found):
        assert cheaper <= dearer
    assert {path.split("/")[1] for path in found[2] - found[1]} == {"cage_orbit"}
    assert {path.split("/")[1] for path in found[3] - found[2]} == {"tilt", "pressure"}


@pytest.mark.parametrize("level", SCENES)
def test_every_series_that_is_written_has_a_plot(tmp_path, level):
    scene = SCENES[level]
    block = synthetic_block(scene, 1e-3 * np.arange(1, 30))
    series = {
        chunk.entity_path
        for chunk in written(tmp_path / "run.rrd", scene, block)
        if not chunk.is_static and "Scalars:scalars" in chunk.to_record_batch().schema.names
    }
    plotted = {path for plot in plots(scene) for path in plot.contents}
    of_readers = {"/life/hours"} | ({"/cage/eccentricity"} if not scene.cage_whirls else set())
    assert series - plotted <= of_readers, "which are there for whoever reads the file"


@pytest.mark.parametrize("level", SCENES)
def test_every_line_that_a_scene_may_have_is_in_a_plot(level):
    scene = SCENES[level]
    plotted = {path for plot in plots(scene) for path in plot.contents}
    lines = {path for path, row in LINES.items() if row.needs in features(scene, MEASURED_CHANNELS)}
    assert lines - plotted == {"/sink/dropped"} | ({"/cage/eccentricity"} if not scene.cage_whirls else set())


def test_lives_and_temperatures_do_not_begin_at_zero_and_frequencies_have_a_legend():
    axes = {row["title"].split(" ")[0]: row["axis"] for row in table("plots") if row["axis"]}
    assert axes == {"Lives,": "free", "Remaining": "free", "Temperatures": "free", "Frequencies": "legend"}


def test_each_threshold_of_a_scene_has_a_line_in_the_unit_of_its_plot_and_one_that_is_not_set_has_none():
    limits = ("clearance_warning=20um", "clearance_error=10um", "pocket_force_warning=50N", "pocket_force_error=80N", "life_error=100h")
    of_slip_and_life = {"/slip/warning": 5.0, "/slip/error": 10.0, "/life/warning": np.log10(300.0)}
    assert threshold_lines(SLIP) == pytest.approx(of_slip_and_life)
    further = {"/clearance/warning": 20.0, "/clearance/error": 10.0, "/loads/pocket_warning": 50.0, "/loads/pocket_error": 80.0, "/life/error": 2.0}
    scene = load_scene("deng2017_table1", [f"thresholds.{limit}" for limit in limits])
    assert threshold_lines(scene) == pytest.approx(of_slip_and_life | further)


def test_a_scene_without_bands_has_no_band_in_its_plots_and_one_with_bands_has_all():
    bands = ["/slip/band", "/life/band", "/remaining_life/band", "/clearance/band"]
    for scene, expected in ((SLIP, []), (load_scene("deng2017_table1", ["estimation.bands=true"]), bands)):
        assert [path for plot in plots(scene) for path in plot.contents if path.endswith("/band") and not path.startswith("/range")] == expected


def test_of_samples_that_share_a_pixel_the_largest_slip_and_loads_are_drawn():
    largest = {"/slip/cage", "/loads/inner_largest", "/loads/outer_largest", "/loads/pocket_largest"}
    assert {path: row.pixel for path, row in LINES.items() if row.pixel} == dict.fromkeys(largest, "Max")


# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009): full severity, linear RGB.
SIGHTS = {
    "all cones": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def lab(colour, sight):
    """Return CIE L*a*b* (D65) of an sRGB colour as seen."""
    linear = ((np.array(colour[:3]) / 255 + 0.055) / 1.055) ** 2.4
    seen = np.clip(np.array(SIGHTS[sight]) @ linear, 0.0, 1.0)
    xyz = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]) @ seen
    f = np.cbrt(np.maximum(xyz / [0.95047, 1.0, 1.08883], 0.008856))
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", SIGHTS)
def test_lines_of_one_plot_can_be_told_apart_with_any_sight(sight):
    for plot in [plot for scene in SCENES.values() for plot in plots(scene)]:
        coloured = [(path, lab(LINES[path].colour, sight)) for path in plot.contents if path in LINES]
        if plot.name.startswith(("Plot [W]", "Clearance [µm]")):  # so many causes and parts, which the bars beside name
            continue
        for (one, first), (other, second) in itertools.combinations(coloured, 2):
            assert np.linalg.norm(first - second) > 15.0, f"{plot.name}: {one}, {other}"


def test_the_lane_of_levels_tells_where_a_governor_fell_and_came_back(tmp_path):
    scene, block = SCENES["planar"], synthetic_block(SCENES["planar"], 1e-3 * np.arange(1, 101))
    block["level"] = np.where((np.arange(100) >= 40) & (np.arange(100) < 70), 1, 2)
    written(tmp_path / "run.rrd", scene, block)
    times, states = column(tmp_path / "run.rrd", "/level", "StateChange:state")
    assert list(states) == ["planar", "slip, not planar", "planar"]
    np.testing.assert_allclose(times, block["time"][[0, 40, 70]], atol=1e-6)


def test_rollers_that_roll_slide_nowhere_and_a_spin_too_slow_slides_on_both_rings():
    bearing, block = SLIP.bearing, synthetic_block(SLIP, [0.1])
    radius = bearing.roller.diameter / 2
    pitch = bearing.inner_raceway.radius + radius
    block["roller_radius"], block["orbital_speed"] = pitch, 1000.0
    block["roller_spin"] = 1000.0 * pitch / radius  # rolls on the outer ring
    block["shaft_speed"] = 2 * 1000.0 * pitch / bearing.inner_raceway.radius  # and on the inner one
    for path in ("/rollers/inner_sliding", "/rollers/outer_sliding"):
        np.testing.assert_allclose(roller_series(SLIP, block)[path], 0.0, atol=1e-9)
    block["roller_spin"] -= 10.0
    found = roller_series(SLIP, block)
    np.testing.assert_allclose(found["/rollers/inner_sliding"], 10.0 * radius)
    np.testing.assert_allclose(found["/rollers/outer_sliding"], -10.0 * radius)


def test_thresholds_that_a_scene_has_are_drawn_and_others_are_not():
    assert set(threshold_lines(SLIP)) == {"/slip/warning", "/slip/error", "/life/warning"}
    stricter = ["thresholds.life_error=100 h", "thresholds.pocket_force_warning=50 N", "thresholds.pocket_force_error=90 N"]
    found = threshold_lines(load_scene("deng2017_table1", stricter))
    assert found["/life/error"] == pytest.approx(2.0) and (found["/loads/pocket_warning"], found["/loads/pocket_error"]) == (50.0, 90.0)


def test_residual_has_a_plot_where_the_cage_is_measured_and_only_there():
    names = [[view.name for view in shown(SLIP, measured=measured)] for measured in ([MEASURED_CLEARANCE], [MEASURED])]
    assert [any(name.startswith("Residual slip") for name in found) for found in names] == [False, True]


def test_a_measured_clearance_stands_beside_the_predicted_one_where_there_is_one():
    for measured, is_shown in (((), False), ([MEASURED], False), ([MEASURED_CLEARANCE], True)):
        (plot,) = [view for view in shown(SLIP, measured=measured) if view.name.startswith("Clearance")]
        assert ("/clearance/measured" in plot.contents) == ("measured" in plot.name) == is_shown


def test_residual_slip_is_written_in_points_and_a_zero_line_beside_it(tmp_path):
    block = synthetic_block(SLIP, 1e-3 * np.arange(1, 101))
    with RerunFile(SLIP, tmp_path / "run.rrd") as sink:
        for part in np.array_split(block, 10):
            sink.write(part)
            sink.write(Measurement(float(part["time"][-1]), 0.95 * float(part["ideal_cage_speed"][-1]), 0.05 - float(part["cage_slip"][-1])))
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/slip/measured")[1], 5.0, rtol=1e-4)
    np.testing.assert_allclose(column(tmp_path / "run.rrd", "/slip/residual")[1], 5.0 - 100 * block["cage_slip"][9::10], atol=1e-4)
    assert set(column(tmp_path / "run.rrd", "/slip/no_residual")[1]) == {0.0}


@pytest.mark.long
def test_a_long_run_is_thinned_out_but_for_what_happened(tmp_path):
    seconds, rate, event = 260.0, 400.0, 200.0
    block = synthetic_block(SLIP, np.arange(1, round(seconds * rate) + 1) / rate, slips=(0.01, 0.02))
    block["cage_slip"][30_000] = 0.04
    recording = rr.RecordingStream("test")
    recording.save(tmp_path / "run.rrd")
    series = RunSeries(recording, SLIP, thin=True, duration=seconds)
    for part in np.array_split(block, 260):
        series.write(part)
        if part["time"][0] <= event <= part["time"][-1]:
            series.write_event(Event(event, Level.WARN, "test", "", "something happened"))
    series.finish()
    recording.disconnect()
    times, slips = column(tmp_path / "run.rrd", "/slip/cage")
    assert len(times) < 12_000 and times[0] == pytest.approx(1 / rate) and times[-1] == pytest.approx(seconds, abs=0.1)
    within = np.abs(block["time"] - event) < 0.9713 * AROUND
    kept = np.abs(times - event) < 0.9713 * AROUND
    np.testing.assert_allclose(times[kept], block["time"][within], atol=1e-6)
    np.testing.assert_allclose(slips[kept], 100 * block["cage_slip"][within], rtol=1e-5)
    assert max(high for _, high in column_of_pairs(tmp_path / "run.rrd", "/slip/cage/range")) == pytest.approx(4.0)


def column_of_pairs(path, entity):
    from rerun.chunk import RrdReader

    for chunk in RrdReader(str(path)).stream():
        if chunk.entity_path == entity and not chunk.is_static:
            yield from chunk.to_record_batch().column("Scalars:scalars").to_pylist()


class KeptBars(BarDrawing):
    """Bars that keep what they log instead of writing it."""

    def __init__(self, values):
        super().__init__(None, "/bars", [LINES["/power/shaft"]._replace(observable=name) for name in values], signed=True)
        self.logged = {}
        self.add({name: np.full(4, value) for name, value in values.items()})
        self.draw()

    def _log(self, part, static=False, **fields):
        self.logged[part] = rr.LineStrips2D.from_fields(**fields)

    def _write(self, path, positions, texts, static=False):
        self.logged[path] = texts


def test_a_bar_with_its_round_ends_reaches_from_zero_to_its_value_however_short_it_is():
    values = {"long": 80.0, "negative": -40.0, "short": 0.8, "tiny": 1e-3, "none": 0.0}
    bars = KeptBars(values).logged["bars"]
    strips, radii = bars.strips.as_arrow_array().to_pylist(), np.array(bars.radii.as_arrow_array().to_pylist())
    for value, radius, ((left, _), (right, _)) in zip(values.values(), radii, strips):
        assert left - 1e-5 <= right and (left - radius, right + radius) == pytest.approx((min(1.25 * value, 0.0), max(1.25 * value, 0.0)), abs=1e-4)
