# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Answers at many points stand at their points, whatever the batches are, and a lost worker's points have none."""

import math

import numpy as np
import pytest

from bearing_sim.studies import batches
from bearing_sim.sweep import tasks as sweep_tasks
from bearing_sim.sweep.tasks import Execution, Journal


def sums(factor, left, right):
    """Return lists of answers at points: factor times the sum of both rows, and how many points came at once."""
    return {"sum": [factor * (sum(a) + sum(b)) for a, b in zip(left, right)], "at_once": [len(left)] * len(left)}


POINTS = np.arange(14.0).reshape(7, 2), 100.0 * np.arange(7.0)[:, None]
NOTHING = {"sum": math.nan, "at_once": -1}


@pytest.mark.parametrize(("size", "at_once"), [(1, [1] * 7), (3, [3] * 6 + [1]), (7, [7] * 7), (50, [7] * 7)])
def test_answers_stand_in_the_order_of_the_points_and_progress_counts_points(size, at_once):
    told = []
    found = batches.answers_at(POINTS, sums, (2.0,), NOTHING, "sums", size, Execution(workers=1, progress=lambda *each: told.append(each)))
    np.testing.assert_array_equal(found["sum"], 2.0 * (POINTS[0].sum(axis=1) + POINTS[1][:, 0]))
    assert found["at_once"].tolist() == at_once
    assert told[0] == (0, 7) and told[-1] == (7, 7)


def test_only_the_points_of_a_lost_worker_have_no_answer(monkeypatch):
    computed = sweep_tasks.run_tasks
    lost = {"status": "failed", "reason": "the worker died"}
    monkeypatch.setattr(sweep_tasks, "run_tasks", lambda *arguments: [lost if k == 1 else each for k, each in enumerate(computed(*arguments))])
    found = batches.answers_at(POINTS, sums, (1.0,), NOTHING, "sums", 3, Execution(workers=1))
    assert np.isnan(found["sum"]).tolist() == [False] * 3 + [True] * 3 + [False]
    assert found["at_once"].tolist() == [3, 3, 3, -1, -1, -1, 1]


def test_points_in_the_journal_are_not_computed_again():
    told, journal = [], Journal()
    for _ in range(2):
        batches.answers_at(POINTS, sums, (1.0,), NOTHING, "sums", 4, Execution(journal, 1, None, lambda *each: told.append(each)))
    assert told[-1] == (0, 0), "nothing was left to do"
