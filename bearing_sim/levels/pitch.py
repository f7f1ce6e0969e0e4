"""How far a cage may turn in one step."""

import math

from bearing_sim.kernels.compilation import template

_STEP_OF_A_PITCH = 1.0 / (2.0 + 1.0 / (3.0 + 0.5 * (math.sqrt(5.0) - 1.0)))  # 0.4393, as irrational as numbers get


@template
def pitch_step(cage_speed, rollers):
    """Return the longest sensible step [s], a little under half a roller pitch of cage rotation, so that no lobe is jumped over.

    All rollers together repeat themselves each pitch, so a step of half a pitch would see the same two moments of it again and
    again and take them for the mean.  A fraction that no small denominator comes near sees all moments alike.

    Parameters
    ----------
    cage_speed : [rad/s]; a cage at rest counts as 1e-3 rad/s.
    rollers : number of rollers, Z.
    """
    return _STEP_OF_A_PITCH * 2.0 * math.pi / (rollers * max(abs(cage_speed), 1e-3))
