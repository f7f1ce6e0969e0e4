"""Simulation: owns time, state and workspace of one bearing; ``advance`` returns a block of samples."""

from typing import NamedTuple

import numpy as np

from bearing_sim.scene import Scene


class Inputs(NamedTuple):
    """What drives the bearing from outside, in SI."""

    shaft_speed: float
    load_y: float
    load_z: float
    oil_temperature: float


class Counters(NamedTuple):
    """Work done since the start."""

    steps: int
    rejected_steps: int
    non_finite_steps: int
    right_hand_sides: int
    jacobians: int


class IntegrationError(RuntimeError):
    """Time could not be advanced; the simulation keeps the state from before the call."""


class Simulation:
    """One bearing in time.

    Parameters
    ----------
    scene : what to simulate.
    inputs : conditions at time 0; the scene's operating block where absent.
    """

    def __init__(self, scene: Scene, inputs: Inputs | None = None): ...

    scene: Scene
    inputs: Inputs  # the conditions now
    time: float  # [s]
    sample: np.void  # the newest sample (see `bearing_sim.sample`)
    counters: Counters

    def advance(self, duration: float, inputs: Inputs | None = None, samples: int = 1) -> np.ndarray:
        """Advance by ``duration`` [s] while the inputs go linearly from their present values to ``inputs``.

        Returns a block of ``samples`` samples, evenly spaced, the last one at the end.

        Raises
        ------
        IntegrationError
            With the reason; time and state stay as they were.
        """

    def reset(self, inputs: Inputs | None = None) -> None:
        """Return to time 0, no damage, and the state of ideal rolling at ``inputs``."""
