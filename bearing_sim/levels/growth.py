# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far the inner raceway has grown against rollers and outer raceway, the same at every level."""

from bearing_sim.kernels.compilation import template


@template
def inner_growth(shaft_speed, model):
    """Return the growth of the inner raceway's radius [m] by rotation and heat; fits are in the radius itself.

    Parameters
    ----------
    shaft_speed : [rad/s].
    model : `bearing_sim.levels.slip.Model`.
    """
    return model.lubrication.ring_growth + model.params.growth.by_square_speed * shaft_speed * shaft_speed
