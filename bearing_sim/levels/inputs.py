# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Inputs as compiled levels see them: straight lines in time."""

from typing import NamedTuple

from bearing_sim.kernels.compilation import template


class Drive(NamedTuple):
    """Inputs as straight lines in time."""

    start: float  # [s]
    shaft_speed: float  # at the start [rad/s]
    shaft_acceleration: float  # [rad/s^2]
    load_y: float  # [N]
    load_y_rate: float  # [N/s]
    load_z: float
    load_z_rate: float


@template
def shaft_speed_at(t, drive):
    """Return the shaft speed [rad/s] at a time [s]."""
    return drive.shaft_speed + drive.shaft_acceleration * (t - drive.start)


@template
def load_at(t, drive):
    """Return the radial load (y, z) [N] at a time [s]."""
    elapsed = t - drive.start
    return drive.load_y + drive.load_y_rate * elapsed, drive.load_z + drive.load_z_rate * elapsed
