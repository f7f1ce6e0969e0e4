# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about pictures of runs: no label lies on another, extremes remain, lives are logarithmic, the minimum load is the maker's; no viewer."""

import dataclasses
import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.text import Text
from synthetic_run import synthetic_block

from bearing_sim.cli.main import main
from bearing_sim.messages.bands import BANDS, ESTIMATES, Bands
from bearing_sim.model.losses import CAUSES
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies import run_plot
from bearing_sim.studies.run_plot import (
    SlipBand,
    course_of,
    minimum_loads,
    plot_over_load,
    plot_over_time,
    plot_table_over_load,
    recorded_bands,
    thinned,
)
from bearing_sim.sweep import pictures
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, write_table

SCENE = load_scene("deng2017_table1")
MODIFIED = load_scene("deng2017_table1", ["life.reliability=95 %"])


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Draw coarse files, in a fraction of the time; readability is judged at the figure's own resolution."""
    monkeypatch.setattr(pictures, "DPI", 30)


def shown_texts(figure):
    """Return (text, box in pixels) of everything that is written in a drawn figure: not the labels of ticks outside of the limits of an axis."""
    hidden = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-9 * (high - low)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not low - slack <= tick.get_loc() <= high + slack or not (axis.get_visible() and axes.axison):
                    hidden |= {tick.label1, tick.label2}
    renderer = figure.canvas.get_renderer()
    found = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip() and text not in hidden]
    return [(text.get_text(), text.get_window_extent(renderer)) for text in found]


def assert_readable(figure):
    """Assert that no two texts overlap, and that each lies within the picture."""
    figure.draw_without_rendering()
    texts, whole = shown_texts(figure), figure.bbox
    assert len(texts) > 6
    for (one, first), (other, second) in itertools.combinations(texts, 2):
        across = min(first.x1, second.x1) - max(first.x0, second.x0)
        up = min(first.y1, second.y1) - max(first.y0, second.y0)
        assert across <= 0.5 or up <= 0.5, f"{one!r} lies on {other!r}"
    for text, box in texts:
        assert whole.x0 - 1 <= box.x0 and box.x1 <= whole.x1 + 1 and whole.y0 - 1 <= box.y0 and box.y1 <= whole.y1 + 1, f"{text!r} is cut off"


def run_of(times, **columns):
    block = synthetic_block(SCENE, times)
    block["running_clearance"] = 30e-6 + 1e-6 * np.sin(np.asarray(times))
    block["inner_ring_temperature"], block["outer_ring_temperature"] = block["oil_temperature"] + 8, block["oil_temperature"] - 3
    for name in ("roller_temperature", "housing_temperature", "inner_ring_temperature_measured", "outer_ring_temperature_measured"):
        block[name] = np.nan
    for name, values in columns.items():
        block[name] = values
    return block


def course(block, name="run.mcap", panels=run_plot.DEFAULT_PANELS, scene=SCENE):
    return course_of(iter([block]), scene, name, len(block), panels)


LINEAR = np.linspace(0.0, 1.0, 300)
RUNS = {
    "usual": run_of(LINEAR),
    "reverse": run_of(LINEAR, shaft_speed=-4700.0 * LINEAR, load_y=-800.0, load_z=-5e6, cage_slip=-0.3 * LINEAR),
    "constant": run_of(
        LINEAR, shaft_speed=4712.389 * (1 + 1e-15 * LINEAR), cage_slip=0.0123456789, modified_rating_life=605.4321, oil_temperature=393.15
    ),
    "at rest": run_of(LINEAR, shaft_speed=0.0, cage_slip=np.nan, modified_rating_life=np.inf, running_clearance=np.nan),
    "mostly not finite": run_of(LINEAR, cage_slip=np.where(LINEAR < 0.99, np.nan, 1.0), modified_rating_life=np.where(LINEAR < 0.5, np.inf, 0.0)),
    "one sample": run_of([12.5]),
    "two samples": run_of([0.0, 3e6]),
    "tiny and huge": run_of(1e5 + LINEAR, shaft_speed=1e-7 * LINEAR, load_y=1e7, cage_slip=1e-9 * LINEAR, modified_rating_life=10.0 ** (40 * LINEAR)),
    "minutes": run_of(600 * LINEAR),
    "hours": run_of(36000 * LINEAR),
    "days": run_of(31 * 86400 * LINEAR),
}


@pytest.mark.long
@pytest.mark.parametrize("name", ["reverse", "constant", "at rest", "one sample", "tiny and huge", "days"])
def test_no_label_lies_on_another_over_time_and_over_load_whatever_the_run(tmp_path, name):
    shown = course(RUNS[name])
    assert_readable(plot_over_time(tmp_path / "time.png", [shown], f"{name}: " + 20 * "a long title "))
    if name in ("reverse", "one sample", "tiny and huge"):
        assert_readable(plot_over_load(tmp_path / "load.png", [shown], name))


def test_no_label_lies_on_another_in_comparisons_with_long_names_and_all_panels(tmp_path):
    runs = [course(block, f"{name}_{'with_a_very_long_name_' * 4}.mcap", list(run_plot.PANELS)) for name, block in RUNS.items()]
    assert_readable(plot_over_time(tmp_path / "time.png", runs, "compared"))
    assert_readable(plot_over_load(tmp_path / "load.png", runs[:3], "compared"))


def test_units_are_those_that_users_say(tmp_path):
    figure = plot_over_time(tmp_path / "a.png", [course(RUNS["usual"])])
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == [
        "shaft speed [rpm]",
        "radial load [N]",
        "cage slip [%]",
        f"rating life {SCENE.life.symbols[0]} [h]",
        "temperature [°C]",
        "running clearance [µm]",
    ]
    lines = {axes.get_ylabel(): axes.lines[0].get_ydata() for axes in figure.axes}
    assert lines["shaft speed [rpm]"][-1] == pytest.approx(4700 * 30 / math.pi) and lines["radial load [N]"][0] == pytest.approx(800.0)
    assert lines["cage slip [%]"][-1] == pytest.approx(16.0) and lines["temperature [°C]"][0] == pytest.approx(120.0)
    assert lines["running clearance [µm]"][0] == pytest.approx(30.0)
    assert figure.axes[3].get_yscale() == "log"


def test_the_power_is_what_is_lost_without_the_state_from_which_the_solver_starts():
    """The power of the shaft is less than nothing while the cage slows down, and at time 0 pockets are hit that a run in motion never hits."""
    block = run_of(LINEAR, shaft_power=-964.0, **{name: 0.0 for names in CAUSES.values() for name in names})
    block["churning_power"], block["seal_power"], block["pocket_power"][0] = 60.0, 15.0, 65.0
    _, values = course(block, panels=("power",)).lines["power", 0]
    assert np.isnan(values[0]) and np.all(values[1:] == 75.0)
    cut = course_of(iter([block[:100], block[100:]]), SCENE, "cut", len(block), ("power",)).lines["power", 0][1]
    assert np.isnan(cut).sum() == 1, "only a run has a start, not each block of it"


def test_axes_of_lives_name_the_life_of_the_scene_and_runs_that_differ_name_their_own(tmp_path):
    basic, modified = (course(RUNS["usual"], f"{name}.mcap", ("life",), scene) for name, scene in (("a", SCENE), ("b", MODIFIED)))
    labels = [plot_over_time(tmp_path / "a.png", runs).axes[0].get_ylabel() for runs in ([basic], [modified], [basic, modified])]
    assert labels == [f"rating life {SCENE.life.symbols[0]} [h]", f"modified rating life {MODIFIED.life.symbols[1]} [h]", "life [h]"]
    names = [text.get_text() for text in plot_over_time(tmp_path / "a.png", [basic, modified]).legends[0].get_texts()]
    assert "a.mcap: rating life" in names[0] and "b.mcap: modified rating life" in names[1]


def test_where_colours_tell_runs_apart_no_two_lines_of_a_panel_look_alike(tmp_path):
    warm = run_of(LINEAR, roller_temperature=400.0, housing_temperature=350.0, inner_ring_temperature_measured=401.0)
    axes = plot_over_time(tmp_path / "a.png", [course(warm, name, ("temperature",)) for name in ("a", "b")]).axes[0]
    drawn = [(line.get_color(), line._dash_pattern[1] and tuple(line._dash_pattern[1])) for line in axes.lines]
    assert len(set(drawn)) == len(drawn) == 12
    assert len({line.get_color() for line in axes.get_legend().get_lines()}) == 1, "the legend of quantities has no colour of a run"


@pytest.mark.parametrize("seconds, unit, last", [(100, "s", 100), (1000, "min", 1000 / 60), (36000, "h", 10), (31 * 86400, "d", 31)])
def test_the_time_axis_has_the_unit_of_its_length(tmp_path, seconds, unit, last):
    figure = plot_over_time(tmp_path / "a.png", [course(run_of(seconds * LINEAR), panels=("speed",))])
    assert figure.axes[-1].get_xlabel().endswith(f"[{unit}]") and figure.axes[0].lines[0].get_xdata()[-1] == pytest.approx(last)


def test_a_long_run_keeps_its_extremes_and_where_it_was_not_simulated():
    """A million samples of noise with one spike up, one down, a stretch without values, and a gap of 1000 s."""
    times = np.arange(1_000_000) * 0.1
    times[600_000:] += 1000.0
    values = np.random.default_rng(1).normal(size=len(times))
    values[123_456], values[777_777], values[300_000:310_000] = 50.0, -60.0, np.nan
    kept_times, kept = thinned(times, values, 500, [600_000])
    assert len(kept) < 5000 and np.all(np.diff(kept_times) >= 0)
    assert (np.nanmax(kept), np.nanmin(kept)) == (50.0, -60.0)
    assert kept_times[np.nanargmax(kept)] == pytest.approx(12345.6) and kept_times[np.nanargmin(kept)] == pytest.approx(77777.7 + 1000)
    assert np.isnan(kept[(kept_times > 30_050) & (kept_times < 30_950)]).all()
    before = np.searchsorted(kept_times, times[600_000]) - 1
    assert np.isnan(kept[before]) and kept_times[before] == times[599_999]


def test_blocks_give_the_same_lines_as_one_and_gaps_of_a_log_interrupt_them():
    whole = run_of(np.concatenate([np.arange(300.0), 9000.0 + np.arange(300.0)]))
    cut = course_of(iter([whole[:100], whole[100:350], whole[350:]]), SCENE, "cut", len(whole))
    times, values = cut.lines["speed", 0]
    assert np.isnan(values).sum() == 1 and times[np.isnan(values)] == 299.0 and len(times) == 601
    np.testing.assert_allclose(values[np.isfinite(values)], whole["shaft_speed"] * 30 / math.pi, rtol=1e-14)
    assert (cut.first, cut.last, cut.samples) == (0.0, 9299.0, 600)


def test_slip_near_rest_has_no_meaning_and_does_not_spoil_the_axis(tmp_path):
    speeds = np.where(LINEAR < 0.9, 4000.0, 4000.0 * 10 ** (-60 * (LINEAR - 0.9)))
    block = run_of(LINEAR, shaft_speed=speeds, cage_slip=np.where(LINEAR < 0.9, 0.1 * LINEAR, -1e3 / speeds))
    shown = course(block)
    assert 9.0 <= np.nanmax(np.abs(shown.lines["slip", 0][1])) < 1e4 and np.isnan(shown.lines["slip", 0][1][-1])
    assert plot_over_time(tmp_path / "a.png", [shown]).axes[2].get_ylim()[0] > -1e4
    assert np.isfinite(shown.lines["speed", 0][1]).all() and np.nanmax(np.abs(shown.loaded[:, 2])) < 1e4


def test_a_band_is_drawn_only_where_there_is_one(tmp_path):
    shown = course(RUNS["usual"], panels=("speed", "load", "slip"))
    figure = plot_over_time(tmp_path / "a.png", [shown])
    assert not figure.axes[2].collections and not figure.legends
    shown.band = SlipBand(np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.1, 0.2]), np.array([0.1, 0.3, 0.5]))
    figure = plot_over_time(tmp_path / "b.png", [shown])
    assert len(figure.axes[2].collections) == 1 and len(figure.axes[2].collections[0].get_paths()) == 1, "one area, without seams"
    assert "5 to 95 %" in figure.legends[0].get_texts()[0].get_text()
    assert figure.axes[2].get_ylim()[1] >= 50.0
    assert_readable(figure)


def test_bands_that_a_run_published_are_shaded_but_not_at_rest_and_dashed_where_measurements_moved_them(tmp_path):
    block = run_of(LINEAR, shaft_speed=np.where(LINEAR < 0.5, 0.0, 4700.0), cage_slip=0.02, modified_rating_life=500.0)
    shown = course(block, panels=("slip", "life", "clearance"))
    names, units = ("cage_slip", "rating_life", "running_clearance"), ("", "h", "m")
    numbers = np.tile([[0.03, 0.02, 0.05], [2000.0, 900.0, 7000.0], [28e-6, 26e-6, 31e-6]], (300, 1, 1))
    published = [Bands(BANDS, names, units, LINEAR[k : k + 1], numbers[k : k + 1]) for k in range(300)]
    shown.recorded = recorded_bands(published, shown.lines, SCENE)
    slip, clearance = shown.recorded["slip"], shown.recorded["clearance"]
    assert np.isnan(slip.high[slip.times < 0.5]).all() and slip.high[-1] == pytest.approx(5.0) and clearance.low[0] == pytest.approx(26.0)
    figure = plot_over_time(tmp_path / "a.png", [shown])
    assert [len(axes.collections) for axes in figure.axes] == [1, 1, 1] and [len(axes.lines) for axes in figure.axes] == [1, 1, 1]
    low, high = figure.axes[1].get_ylim()
    assert low <= 500.0 and high >= 7000.0, "the band of the life lies on its axis"
    assert "as the run published it" in figure.legends[0].get_texts()[0].get_text()
    shown.recorded = recorded_bands([*published, Bands(ESTIMATES, ("x",), ("",), LINEAR[:1], np.ones((1, 1, 3)))], shown.lines, SCENE)
    figure = plot_over_time(tmp_path / "b.png", [shown])
    assert [len(axes.lines) for axes in figure.axes] == [2, 2, 2] and "dashed: as measurements" in figure.legends[0].get_texts()[0].get_text()
    assert_readable(figure)
    shown.recorded = recorded_bands(published, shown.lines, MODIFIED)
    figure = plot_over_time(tmp_path / "c.png", [shown])
    assert [len(axes.lines) for axes in figure.axes] == [1, 2, 1], "the line is the modified life, the band is about the basic one"
    assert figure.axes[1].lines[1].get_ydata()[-1] == 2000.0 and SCENE.life.symbols[0] in figure.legends[0].get_texts()[0].get_text()
    assert_readable(figure)


def test_the_minimum_load_is_the_makers_at_the_speed_of_the_run(tmp_path):
    """By hand for k_r = 0.15 kN, n_r = 5000 rpm, d_m = 150 mm: 150 N (6 + 4 x 3000/5000) 1.5^2 = 2835 N."""
    ratings = dataclasses.replace(SCENE.bearing.ratings, minimum_load_factor=150.0, reference_speed=5000 * math.pi / 30)
    scene = dataclasses.replace(SCENE, bearing=dataclasses.replace(SCENE.bearing, ratings=ratings))
    by_hand = 150.0 * (6 + 4 * np.array([3000.0, 1000.0, 3000.0]) / 5000) * (scene.bearing.pitch_diameter / 0.1) ** 2
    assert minimum_loads(scene, np.array([3000.0, 1000.0, -3000.0])) == pytest.approx(by_hand)
    turning = run_of(LINEAR, shaft_speed=np.array([0.0, *np.linspace(1000, 3000, 299)]) * math.pi / 30)
    figure = plot_over_load(tmp_path / "a.png", [course(turning, scene=scene)])
    marks = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert marks[0].get_xdata()[0] == pytest.approx(by_hand[0])
    assert "1,000 to 3,000 rpm" in figure.legends[0].get_texts()[0].get_text()


def test_a_sweep_over_load_has_a_line_for_each_speed_and_the_minimum_load(tmp_path):
    points = [
        {"load": load, "slip": slip / load, "life": life * load**-3, "speed": speed, "family": f"shaft speed {speed:,.0f} rpm"}
        for speed, slip, life in ((1000.0, 100.0, 1e12), (45000.0, 4000.0, 1e9))
        for load in (100.0, 300.0, 1000.0, 3000.0)
    ]
    points[0]["slip"], points[1]["life"] = math.nan, math.inf
    figure = plot_table_over_load(tmp_path / "a.png", points, SCENE, "a sweep", "rating life [h]")
    assert_readable(figure)
    assert len(figure.axes[0].lines) == 3 and figure.axes[1].get_yscale() == "log" and figure.axes[0].get_xlabel() == "radial load [kN]"


def plotted(*arguments):
    return CliRunner().invoke(main, ["plot", *map(str, arguments)])


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    done = CliRunner().invoke(main, ["run", "deng2017_table1", "--duration", "0.02", "--out", str(path)])
    assert done.exit_code == 0, done.output
    return path


@pytest.mark.long
@pytest.mark.parametrize("suffix, magic", [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")])
def test_the_command_draws_a_recording_into_the_format_of_the_suffix(recording, tmp_path, suffix, magic):
    done = plotted(recording, "-o", tmp_path / f"a{suffix}")
    assert done.exit_code == 0 and (tmp_path / f"a{suffix}").read_bytes().startswith(magic)


def test_the_command_compares_recordings_over_time_and_load_and_takes_panels(recording, tmp_path):
    for options in (("--over", "load"), ("--panel", "slip", "--panel", "damage")):
        done = plotted(recording, recording, *options, "-o", tmp_path / "a.png", "--force")
        assert done.exit_code == 0, done.output
    assert plotted(recording, "--panel", "slip").exit_code == 0 and recording.with_suffix(".png").is_file()
    refused = plotted(recording, "--panel", "slip")
    assert refused.exit_code == 2 and "exists; use --force to replace it" in refused.output


@pytest.mark.parametrize(
    "options, words",
    [
        (("--panel", "slp"), "no such panel (did you mean 'slip'?)"),
        (("-o", "a.jpeg"), "--out a.jpeg: expected a name that ends in .png, .svg, .pdf"),
        (("--quantity", "cage_slip"), "--quantity is for tables"),
        (("--over", "load", "--panel", "slip"), "go with a picture over time"),
        (("--over", "weather"), "'time', 'load'"),
        (("--band", "8", "--over", "load"), "go with a picture over time"),
    ],
)
def test_options_that_do_not_fit_are_refused_in_words(recording, tmp_path, options, words):
    refused = plotted(recording, *options, "--force")
    assert refused.exit_code == 2 and words in refused.stderr


def test_a_band_is_computed_from_the_ranges_of_the_scene_where_it_is_asked_for(recording, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(run_plot, "plot_over_time", lambda path, courses, title: drawn.extend(courses))
    assert plotted(recording, "--band", "8", "-o", tmp_path / "a.png").exit_code == 0
    band = drawn[0].band
    assert len(band.times) == len(drawn[0].conditions) > 1 and np.all(band.low < band.high) and np.all((0 < band.low) & (band.high < 0.3))
    assert np.ptp(band.low) == 0.0, "the inputs are constant"


def test_what_cannot_be_drawn_is_refused_in_words(recording, tmp_path):
    (tmp_path / "a.mcap").write_bytes(b"nothing")
    assert plotted(tmp_path / "a.mcap").exit_code == 2 and plotted(tmp_path / "absent.mcap").exit_code == 2
    (tmp_path / "a.csv").write_text("x,y\n1,2\n")
    assert "no column operating.radial_load" in plotted(tmp_path / "a.csv", "--over", "load").stderr
    assert "give --over load" in plotted(tmp_path / "a.csv").stderr
    assert "a table is drawn alone" in plotted(tmp_path / "a.csv", recording).stderr
    assert "is an input of this command" in plotted(recording, "-o", _as_png(recording, tmp_path)).stderr


def _as_png(recording, folder):
    link = folder / "same.png"
    link.symlink_to(recording)
    return link


def test_a_sweep_is_drawn_over_its_loads_from_parquet_and_from_csv_alone(tmp_path):
    columns = (Column("operating.radial_load", "N", "radial load"), Column("operating.shaft_speed", "rpm", "shaft speed"))
    columns += (Column("cage_slip", "%", "slip"), Column("rating_life", "h", "life"), Column("status", "", "how it ended"))
    rows = [
        {"operating.radial_load": load, "operating.shaft_speed": speed, "cage_slip": speed / load, "rating_life": 1e12 / load**3, "status": "ok"}
        for speed in (20000.0, 45000.0)
        for load in (200.0, 800.0, 2000.0)
    ]
    from bearing_sim.scene.loader import scene_to_yaml

    axes = [{"field": "operating.radial_load", "unit": "N", "values": [200.0, 800.0, 2000.0]}]
    axes.append({"field": "operating.shaft_speed", "unit": "rpm", "values": [20000.0, 45000.0]})
    about = {"kind": "sweep", "scene": "s", "overrides": [], "level": "slip", "axes": axes, "scene_of_first_point": scene_to_yaml(SCENE)}
    parquet, text = write_table(tmp_path / "s.parquet", Table(columns, rows, about))
    assert plotted(parquet, "--over", "load").exit_code == 0
    assert plotted(parquet, "--quantity", "cage_slip", "--quantity", "rating_life", "-o", tmp_path / "b.png").exit_code == 0
    parquet.unlink()
    alone = plotted(text, "--over", "load", "-o", tmp_path / "c.png")
    assert alone.exit_code == 0 and "no minimum load" in alone.stderr and (tmp_path / "c.png").is_file()


@pytest.mark.parametrize(
    ("count", "span", "start_ns", "label"),
    [
        (1, 3599.0, 1_700_000_000 * 10**9, "simulated time [s]"),
        (1, 3600.0, 1_700_000_000 * 10**9, "time since 2023-11-14 22:13 UTC [s]"),
        (1, 86400.0, None, "simulated time [s]"),
        (2, 86400.0, 1_700_000_000 * 10**9, "simulated time from the start of each run [s]"),
    ],
)
def test_the_axis_of_a_long_run_names_the_date_of_its_start(count, span, start_ns, label):
    assert run_plot._time_label([SimpleNamespace(start_ns=start_ns)] * count, span, "s") == label
