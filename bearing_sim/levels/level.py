"""The levels of fidelity, each a record of functions."""

from collections.abc import Callable
from typing import NamedTuple

from bearing_sim.levels import planar, planar_state, slip


class Level(NamedTuple):
    """One complete model.

    Attributes
    ----------
    new_work : params -> workspace.
    initial_state : (params, work, shaft speed, load y, load z) -> state of ideal rolling.
    observe, advance : compiled, see `bearing_sim.levels.slip`.
    leaves_out : what the level does not model, in words.
    """

    new_work: Callable
    initial_state: Callable
    observe: Callable
    advance: Callable
    leaves_out: str


LEVELS = {
    "slip": Level(slip.new_work, slip.initial_state, slip.observe, slip.advance, "pocket play, radial vibration, cage whirl, tilt and skew"),
    "planar": Level(planar_state.new_work, planar.initial_state, planar.observe, planar.advance, "tilt and skew"),
}
