# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Limits of validity of corrected tables: their ends, and operating points at which level ``planar`` has two states, one of which the table has.

What they judge by belongs to one table and its correction, which is on disk: `laws_of_table` finds it for all who judge samples.
"""

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bearing_sim.model.table_span import span_of
from bearing_sim.model.validity import BY_NAME, Conditions, Law, towards_ends
from bearing_sim.scene.scene import Scene

if TYPE_CHECKING:
    from bearing_sim.watchers.estimation.correction import Correction


class TwoStates:
    """Looks up where level ``planar`` has two states.

    Parameters
    ----------
    correction : that knows it.
    """

    def __init__(self, correction: "Correction"):
        from scipy.spatial import cKDTree

        from bearing_sim.watchers.estimation.response import CONDITIONS

        self._correction, self._tree = correction, cKDTree(correction.places(correction.conditions))
        self._slips = np.full((len(correction.conditions), 2), math.nan)
        for state in correction.two_states:
            self._slips[(correction.conditions == state[: len(CONDITIONS)]).all(axis=1)] = state[len(CONDITIONS) :]

    def slips_near(self, conditions: np.ndarray) -> np.ndarray:
        """Return the slips [1] of both states at the nearest point that was measured, from ideal rolling first; NaN where there is one state.

        Parameters
        ----------
        conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).

        Returns
        -------
        shape (n, 2)
        """
        return self._slips[self._tree.query(self._correction.places(conditions))[1]]


def laws_of_table(scene: Scene, temperatures: tuple[float, float] | None = None) -> tuple[Law, ...]:
    """Return the laws that the corrected table of a scene is judged by, in place of those of the same name in `bearing_sim.model.validity.LAWS`.

    There are none at other levels and of plain tables.  Without a correction on disk beside the table two states are not known.

    Parameters
    ----------
    scene : whose samples are judged.
    temperatures : lowest and highest oil temperature of the table [K], instead of the scene's.
    """
    ends, states = BY_NAME["table_correction"], BY_NAME["table_states"]
    if not states.applies(scene):
        return ()
    # here, because nobody else needs corrections and the part of SciPy that they are read with
    from bearing_sim.watchers.estimation.correction import correction_domain, correction_path, read_correction

    ends = ends._replace(value=partial(towards_ends, span=span_of(scene, temperatures)))
    correction = read_correction(correction_path(scene, correction_domain(scene, temperatures)))
    if correction is None or not len(correction.two_states):
        return (ends,)
    rpm, loads = np.abs(correction.two_states[:, 0]) * (30.0 / math.pi), correction.two_states[:, 1]
    where = f"at {len(loads)} points measured, {rpm.min():.5g} to {rpm.max():.5g} rpm and {loads.min():.3g} to {loads.max():.3g} N"
    return ends, states._replace(source=f"{states.source}: {where}", value=partial(_points_apart, TwoStates(correction)))


def _points_apart(states: TwoStates, at: Conditions) -> np.ndarray:
    """Return the difference of slip between two states [percentage points], 0 where there is one and NaN at rest."""
    samples = at.samples
    angles = np.arctan2(samples["load_z"], samples["load_y"])
    slips = states.slips_near(np.column_stack([samples["shaft_speed"], at.radial_load, samples["oil_temperature"], angles]))
    return at.while_turning(np.nan_to_num(100.0 * np.abs(slips[:, 1] - slips[:, 0])))
