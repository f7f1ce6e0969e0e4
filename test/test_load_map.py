# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The load map: loads stand where they act, whatever the run's length."""

import io
import math
import struct

import numpy as np
from PIL import Image
from synthetic_run import synthetic_block

from bearing_sim.scene.loader import load_scene
from bearing_sim.view.load_map import AZIMUTH_BINS, COLUMNS, LoadMap, map_size, palette_png

SCENE = load_scene("deng2017_table1")


def standing_load(times, azimuth=math.pi / 2, load=1000.0):
    """Rollers pass by; whichever is within 12 deg of an azimuth carries a load."""
    block = synthetic_block(SCENE, times)
    away = np.angle(np.exp(1j * (block["roller_angle"] - azimuth)))
    block["inner_load"] = np.where(np.abs(away) < math.radians(12), load, 0.0)
    return block


def test_load_that_stands_still_is_a_level_band_at_its_azimuth():
    chart = LoadMap(1.0, rolling=False)
    chart.add(standing_load(np.linspace(1e-4, 1.0, 8000)))
    mean = np.nanmean(chart.loads(), axis=1)
    centre = (np.arange(AZIMUTH_BINS) + 0.5) * 360 / AZIMUTH_BINS
    assert (mean[np.abs(centre - 90) < 7] > 990).all()
    assert (mean[np.abs(centre - 90) > 18] < 10).all()


def test_run_longer_than_expected_keeps_its_beginning():
    chart = LoadMap(1.0, rolling=False)
    times = np.linspace(1e-3, 3.9, 6000)
    for part in np.array_split(standing_load(times), 40):
        chart.add(part)
    assert chart.span == 4.0 and chart.start == times[0]
    known = ~np.isnan(chart.loads()).all(axis=0)
    assert known[: int(0.95 * COLUMNS)].all() and not known[-2:].any()
    assert np.nanmax(chart.loads()) == 1000.0


def test_rolling_map_shows_the_newest_seconds_only():
    chart = LoadMap(1.0, rolling=True)
    chart.add(standing_load(np.linspace(0.01, 1.0, 2000), azimuth=math.pi))
    for part in np.array_split(standing_load(np.linspace(1.0, 5.0, 8000)), 80):
        chart.add(part)
    assert 3.95 <= chart.start <= 4.02
    mean = np.nanmean(chart.loads(), axis=1)
    assert mean[AZIMUTH_BINS // 4] > 900 and mean[AZIMUTH_BINS // 2] < 10


def test_jump_ahead_leaves_nothing_of_the_past():
    chart = LoadMap(1.0, rolling=True)
    chart.add(standing_load(np.linspace(0.01, 1.0, 500)))
    chart.add(standing_load(np.array([1000.0, 1000.001])))
    assert (~np.isnan(chart.loads()).all(axis=0)).sum() == 1


def test_columns_narrower_than_samples_show_what_lies_between_their_neighbours_and_a_gap_stays_empty():
    chart = LoadMap(20.0, rolling=False, rollers=18)  # 0.125 s a column
    for time in [*np.arange(0.0, 10.01, 0.5), *np.arange(15.0, 20.01, 0.5)]:
        block = synthetic_block(SCENE, np.array([time]))
        block["inner_load"] = 100.0 * time
        chart.add(block)
    loads, left = chart.loads(), np.arange(COLUMNS) * 20.0 / COLUMNS
    known = ~np.isnan(loads[0])
    assert known[left <= 10.0].all() and known[(left >= 15.0)].all() and not known[(left > 10.6) & (left < 14.9)].any()
    inside = left <= 10.0
    np.testing.assert_allclose(loads[3, inside], 100.0 * left[inside], atol=1e-6)


def test_unknown_loads_pass_for_none():
    block = standing_load(np.linspace(0.01, 1.0, 500))
    block["inner_load"][:] = np.nan
    chart = LoadMap(1.0, rolling=False)
    chart.add(block)
    assert np.nanmax(chart.loads()) == 0.0
    assert chart.png(1000.0).startswith(b"\x89PNG")


def test_png_holds_the_pixels_it_was_given():
    index = np.arange(12, dtype=np.uint8).reshape(3, 4)
    palette = np.random.default_rng(1).integers(0, 255, (12, 3)).astype(np.uint8)
    pixels = np.asarray(Image.open(io.BytesIO(palette_png(index, palette))).convert("RGB"))
    np.testing.assert_array_equal(pixels, palette[index])


def test_map_has_one_block_of_pixels_a_cell():
    chart = LoadMap(1.0, rolling=False)
    chart.add(standing_load(np.linspace(0.01, 1.0, 100)))
    width, height = struct.unpack(">II", chart.png(100.0)[16:24])
    assert (width, height) == map_size()
    assert width % COLUMNS == 0 and height % AZIMUTH_BINS == 0


def test_narrow_map_is_higher_for_its_width():
    chart = LoadMap(1.0, rolling=False, narrow=True)
    chart.add(standing_load(np.linspace(0.01, 1.0, 100)))
    width, height = struct.unpack(">II", chart.png(100.0)[16:24])
    assert (width, height) == map_size(narrow=True)
    assert height / width > map_size()[1] / map_size()[0]


def test_a_roller_that_alone_bears_load_is_a_level_band_in_the_map_by_roller():
    chart = LoadMap(1.0, rolling=False, rollers=18)
    block = synthetic_block(SCENE, np.linspace(1e-3, 1.0, 500))
    block["inner_load"] = 0.0
    block["inner_load"][:, 4] = 700.0
    chart.add(block)
    loads = chart.loads()
    assert loads.shape == (18, COLUMNS)
    np.testing.assert_allclose(np.nanmean(loads, axis=1), 700.0 * (np.arange(18) == 4))
    assert len(chart.png(1000.0)) > 100
