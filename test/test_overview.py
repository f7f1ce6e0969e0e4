# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Thinning out of long runs: nothing that happened is lost, whatever blocks it came in."""

import numpy as np
import pytest

from bearing_sim.view.plots import AROUND, FULL_ROWS, Lines, Overview, bucket_for

INTERVAL, BUCKET = 1e-3, 0.5
TIMES = INTERVAL * np.arange(60_000)


def signal(times):
    return np.sin(times) + 0.1 * np.sin(700.0 * times)


def thinned(values, marks=(), parts=37, seen_late=0.3, **options):
    """Return all lines and ranges; each event is told once rows up to ``seen_late`` [s] after it have come."""
    overview, out, told = Overview(BUCKET, **options), [], 0
    for place in np.array_split(np.arange(len(TIMES)), parts):
        part = Lines(TIMES[place], {path: rows[place] for path, rows in values.items()})
        while told < len(marks) and marks[told] + seen_late < part.times[-1]:
            overview.mark(marks[told])
            told += 1
        out.append(overview.add(part))
    out.append(overview.finish())
    out = [piece for piece in out if piece is not None]
    joined = [np.concatenate([piece.lines.times for piece in out]), np.concatenate([piece.ranges.times for piece in out])]
    lines = {path: np.concatenate([piece.lines.values[path] for piece in out]) for path in values}
    ranges = {
        path: np.concatenate([piece.ranges.values[path] for piece in out if path in piece.ranges.values]) for path in values if values[path].ndim == 1
    }
    return joined[0], lines, joined[1], ranges


@pytest.mark.parametrize("parts", [1, 37, 6000])
def test_means_and_ranges_are_those_of_the_buckets_whatever_the_blocks(parts):
    values = signal(TIMES)
    times, lines, middles, ranges = thinned({"/a": values, "/each": np.stack((values, 2 * values), axis=1)}, parts=parts)
    of_buckets = values.reshape(-1, 500)
    np.testing.assert_allclose(times, BUCKET * (np.arange(120) + 0.5))
    np.testing.assert_allclose(lines["/a"], of_buckets.mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(lines["/each"][:, 1], 2 * of_buckets.mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(ranges["/a"], np.stack((of_buckets.min(axis=1), of_buckets.max(axis=1)), axis=1))
    np.testing.assert_allclose(middles, times)


def test_every_row_around_an_event_is_kept_though_the_event_is_told_late():
    values = signal(TIMES)
    times, lines, _, _ = thinned({"/a": values}, marks=(20.0, 41.25))
    for mark in (20.0, 41.25):
        within = (TIMES >= mark - AROUND) & (TIMES < mark + AROUND)
        found = np.isin(np.round(TIMES[within], 9), np.round(times, 9))
        assert found.all()
        np.testing.assert_array_equal(lines["/a"][np.isin(np.round(times, 9), np.round(TIMES[within], 9))], values[within])
    assert len(times) < 0.1 * len(TIMES) and (np.diff(times) >= 0).all()


def test_a_spike_of_one_row_is_in_the_ranges():
    values = signal(TIMES)
    values[31_234] = 50.0
    _, _, middles, ranges = thinned({"/a": values})
    assert ranges["/a"].max() == 50.0 and middles[ranges["/a"][:, 1].argmax()] == pytest.approx(31.25)


def test_unknown_values_are_left_out_of_means_and_a_bucket_of_nothing_else_is_unknown():
    values = np.ones(len(TIMES))
    values[:600] = np.nan
    _, lines, _, ranges = thinned({"/a": values})
    assert np.isnan(lines["/a"][0]) and np.isnan(ranges["/a"][0]).all() and (lines["/a"][1:] == 1.0).all()


def test_rows_around_events_are_bounded():
    overview = Overview(BUCKET)
    overview._allowed = 5000
    for mark in np.arange(1.0, 59.0):
        overview.mark(mark)
    kept = overview.add(Lines(TIMES, {"/a": TIMES})).lines
    assert 4000 <= len(kept.times) <= 5000 + 120


def test_the_beginning_of_a_run_without_known_end_is_kept_in_full():
    times, *_ = thinned({"/a": signal(TIMES)}, full_rows=20_000)
    np.testing.assert_array_equal(times[:20_000], TIMES[:20_000])
    assert len(times) < 22_500


def test_short_runs_are_kept_and_long_ones_have_buckets_worth_it():
    assert bucket_for(1e-3, FULL_ROWS * 1e-3) is None
    assert bucket_for(1e-3, 3600.0) == pytest.approx(0.45)
    assert bucket_for(1.0, 2e5) == pytest.approx(25.0)
    assert bucket_for(0.01, None) == pytest.approx(0.2)
