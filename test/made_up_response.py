# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A response of a bearing with known numbers, for tests of what comes after it: nothing is solved."""

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.response_points import design
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import domain_of, fit_response, scene_fields

FIELD = "lubricant.mixture_fraction"
FACTOR = 3.0
"""By which slip differs between both ends of the field's range."""
ASKING = ("uncertainty=null", f"uncertainty.{FIELD}=[0.02, 0.06]", "estimation.bands=true")
"""Overrides of a scene that asks for bands and has one uncertain field."""


def asking_scene(*overrides):
    return load_scene("deng2017_table1", [*ASKING, *overrides])


def made_up_response(scene):
    """Return the response of a scene with one field: a higher one raises slip by a factor and shortens life by a fifth of that, at all points."""
    fields = scene_fields(scene)
    conditions, scores = design(scene, 2048)
    share = fields.fractions_of(scores)[:, 0] - 0.5
    slip, life = 0.02 * FACTOR**share, 400.0 * FACTOR ** (-0.2 * share)
    ones = np.ones(len(share))
    answers = np.stack([slip, life, life, -25e-6 + 4e-6 * share, np.nan * ones, np.nan * ones, ones], axis=1)
    return fit_response(fields, domain_of(scene), conditions, scores, answers, SlipAndOil(scene))
