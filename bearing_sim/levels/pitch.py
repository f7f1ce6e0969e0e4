# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far a cage may turn in one step."""

import math

from bearing_sim.kernels.compilation import template

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # as irrational as numbers get; fractions made of it are approached worst by ratios
HALF_PITCH = 1.0 / (2.0 + 1.0 / (3.0 + GOLDEN))  # 0.4393
FIFTH_PITCH = 1.0 / (4.0 + GOLDEN)  # 0.2165


@template
def pitch_step(cage_speed, rollers, share):
    """Return the longest sensible step [s], a share of a roller pitch of cage rotation, so that no lobe is jumped over.

    All rollers together repeat themselves each pitch, so a step of half a pitch would see the same two moments of it again and
    again and take them for the mean.  A fraction that no small denominator comes near sees all moments alike.

    Parameters
    ----------
    cage_speed : [rad/s]; a cage at rest counts as 1e-3 rad/s.
    rollers : number of rollers, Z.
    share : of a pitch, such as `HALF_PITCH`.
    """
    return share * 2.0 * math.pi / (rollers * max(abs(cage_speed), 1e-3))
