# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The process that analyses windows of vibration for a live run, so that the model is not held up; it ends when its input closes.

It reads pickled fields of a `Window` from its standard input and writes those of its `Outcome` to its standard output; plain tuples, because the
classes have another name where this module is the main one.  Both ends are this program.
"""

import pickle
import signal
import sys
from typing import NamedTuple

import numpy as np

from bearing_sim.watchers.vibration.analysis import Geometry, analyse
from bearing_sim.watchers.vibration.signal import Vibration, VibrationError


class Window(NamedTuple):
    """What is to be analysed.

    Attributes
    ----------
    samples : shape (n,).
    rate : of the samples [Hz].
    shaft_speed : at each sample [rad/s], shape (n,).
    tolerance : of the shaft speed, relative.
    geometry : of the bearing.
    """

    samples: np.ndarray
    rate: float
    shaft_speed: np.ndarray
    tolerance: float
    geometry: Geometry


class Outcome(NamedTuple):
    """What a window shows.

    Attributes
    ----------
    is_claim : whether the lines are those of the bearing and of nothing else.
    found : whether there are lines that may be the bearing's; otherwise all numbers are NaN.
    shows : which part shows, as in `bearing_sim.watchers.vibration.analysis.Analysis`.
    reason : why there is no line, or why the window cannot be used.
    ratio, ratio_error : cage over shaft speed, and its standard error.
    cage_speed, cage_speed_error : [rad/s], mean over the window, without a sign.
    shaft_speed : mean of the measured one over the window [rad/s], with its sign.
    """

    is_claim: bool
    found: bool
    shows: str
    reason: str
    ratio: float
    ratio_error: float
    cage_speed: float
    cage_speed_error: float
    shaft_speed: float


def outcome_of(window: Window) -> Outcome:
    """Return what a window shows."""
    mean, nan = float(np.mean(window.shaft_speed)), float("nan")
    try:
        record = Vibration(window.samples, window.rate, name="vibration", shaft_speed=window.shaft_speed)
        found = analyse(record, window.geometry, tolerance=window.tolerance, parts=1)
    except VibrationError as error:
        return Outcome(False, False, "", str(error), nan, nan, nan, nan, mean)
    return Outcome(
        found.is_claim, found.found, found.shows, found.reason, found.ratio, found.ratio_error, found.cage_speed, found.cage_speed_error, mean
    )


def main() -> None:
    """Analyse windows until the input closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the one that started this process ends it by closing its input
    while True:
        try:
            window = Window(*pickle.load(sys.stdin.buffer))
        except EOFError:
            return
        pickle.dump(tuple(outcome_of(window)), sys.stdout.buffer)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main()
