# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Answers at many points: points go in batches to worker processes or a cluster, with a journal of those that are finished."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from bearing_sim.sweep.tasks import IN_MEMORY, Execution, task


def answers_at(
    points: Sequence[np.ndarray], function: Callable[..., dict], arguments: Sequence, nothing: Mapping[str, Any], kind: str, size: int,
    execution: Execution = IN_MEMORY,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Return what a function answers at points, by the names of ``nothing``, along the first axis.

    Parameters
    ----------
    points : arrays of n rows.
    function : takes ``arguments``, then of each array a tuple of rows, themselves tuples; returns lists of as many answers by name.
    nothing : answer at a point whose worker was lost, by name.
    kind : of the tasks, see `bearing_sim.sweep.tasks.task`.
    size : number of points of a task.
    execution : see `bearing_sim.sweep.tasks.Execution`.
    """
    count = len(points[0])
    parts = [[tuple(map(tuple, each[first : first + size].tolist())) for each in points] for first in range(0, count, size)]
    counting = execution._replace(progress=lambda *batches: execution.progress(*(min(size * each, count) for each in batches)))
    results = counting.run([task(kind, function, *arguments, *part) for part in parts])
    answers = {name: [result.get(name, [absent] * len(part[0])) for result, part in zip(results, parts)] for name, absent in nothing.items()}
    return {name: np.array(list(itertools.chain.from_iterable(lists))) for name, lists in answers.items()}
