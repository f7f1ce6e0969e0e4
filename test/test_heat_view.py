# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Temperatures in the view: bodies by colour, measured beside predicted, only where a scene has a law of heat."""

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun_files import last_value, views_in, written
from synthetic_run import synthetic_block

from bearing_sim.scene.loader import load_scene
from bearing_sim.view.blueprint import blueprint
from bearing_sim.view.colours import DARK_STEEL, heat_colours, heat_palette
from bearing_sim.view.drawings import BODIES

COLD, WARM = (load_scene("deng2017_table1", [f"heat.law={law}"]) for law in ("none", "network"))
CELSIUS = {"housing": 61.0, "outer_ring": 72.0, "rollers": 88.0, "inner_ring": 94.0, "shaft": 97.0, "oil_outlet": 79.0}
ROUND = ("housing", "outer_ring", "inner_ring", "shaft")

pytestmark = pytest.mark.usefixtures("strict_rerun")


def warm_block(celsius=None):
    block = synthetic_block(WARM, 1e-3 * np.arange(1, 30))
    for body, value in (CELSIUS | (celsius or {})).items():
        block[BODIES[body].observable] = value + 273.15
    block["inner_ring_temperature_measured"], block["outer_ring_temperature_measured"] = 95.5 + 273.15, np.nan
    return block


def brightness(colours):
    """Return the relative luminance of 32-bit RGBA colours (IEC 61966-2-1)."""
    channels = np.array([[(colour >> shift) & 255 for shift in (24, 16, 8)] for colour in colours]) / 255
    return ((channels + 0.055) / 1.055) ** 2.4 @ [0.2126, 0.7152, 0.0722]


def test_a_hotter_body_is_brighter_and_each_is_named_with_its_temperature_and_the_measured_one(tmp_path):
    chunks = written(tmp_path / "run.rrd", WARM, warm_block())
    bodies = last_value(chunks, "/temperatures/bodies", "Ellipses2D:colors")
    order = np.argsort([CELSIUS[name] for name in ROUND])
    assert (np.diff(brightness(bodies)[order]) > 0.0).all()
    texts = last_value(chunks, "/temperatures/texts", "Arrows2D:labels")
    assert texts[list(BODIES).index("inner_ring")] == "inner ring 94.0 °C, measured 95.5 °C"
    assert texts[list(BODIES).index("outer_ring")] == "outer ring 72.0 °C", "it is not measured"
    keys, rollers = (last_value(chunks, f"/temperatures/{path}", "Points2D:colors") for path in ("keys", "rollers"))
    assert keys[list(BODIES).index("rollers")] == rollers[0] and keys[list(BODIES).index("shaft")] == bodies[ROUND.index("shaft")]
    low, *_, high = (float(tick.removesuffix(" °C")) for tick in last_value(chunks, "/temperatures/legend/ticks", "Arrows2D:labels"))
    assert low <= min(CELSIUS.values()) and max(CELSIUS.values()) <= high
    for body, celsius in CELSIUS.items():
        assert last_value(chunks, f"/temperature/{body}", "Scalars:scalars") == [pytest.approx(celsius, abs=1e-3)]


def test_a_temperature_that_a_recording_does_not_hold_is_unknown_and_has_the_colour_of_steel(tmp_path):
    chunks = written(tmp_path / "run.rrd", WARM, warm_block(dict.fromkeys(CELSIUS, np.nan)))
    assert last_value(chunks, "/temperatures/texts", "Arrows2D:labels")[0] == "housing unknown"
    steel = int.from_bytes(bytes(DARK_STEEL), "big")
    assert set(last_value(chunks, "/temperatures/bodies", "Ellipses2D:colors")) == {steel}


def test_only_a_scene_with_a_law_of_heat_shows_temperatures(tmp_path):
    names = {
        scene.heat.law: {view.name for view in views_in(blueprint(scene, ((-40, 40), (-40, 40)), live=False).root_container)}
        for scene in (COLD, WARM)
    }
    assert any(name.startswith("Temperatures") for name in names["network"]) and not any(name.startswith("Temperatures") for name in names["none"])
    assert "Running clearance" in names["network"] & names["none"]
    paths = {
        chunk.entity_path for chunk in written(tmp_path / "run.rrd", COLD, synthetic_block(COLD, 1e-3 * np.arange(1, 30))) if not chunk.is_static
    }
    assert not any(path.startswith(("/temperature/", "/temperatures")) for path in paths)


def test_every_series_of_a_scene_with_heat_has_a_plot(tmp_path):
    chunks = written(tmp_path / "run.rrd", WARM, warm_block())
    series = {chunk.entity_path for chunk in chunks if not chunk.is_static and "Scalars:scalars" in chunk.to_record_batch().schema.names}
    views = views_in(blueprint(WARM, ((-40, 40), (-40, 40)), live=False).root_container)
    plotted = {path for view in views if isinstance(view, rrb.TimeSeriesView) for path in view.contents}
    assert {path for path in series - plotted if path.startswith(("/temperature", "/clearance"))} == set()


def test_colours_of_temperatures_rise_in_brightness_and_stay_within_their_scale():
    channels = heat_palette(64) / 255
    assert (np.diff(((channels + 0.055) / 1.055) ** 2.4 @ [0.2126, 0.7152, 0.0722]) > 0.0).all()
    ends = heat_colours(np.array([-50.0, 20.0, 80.0, 500.0, np.nan]), (20.0, 80.0))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[2], ends[3])
    assert tuple(ends[4]) == DARK_STEEL
