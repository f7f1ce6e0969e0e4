# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The gain by which measured temperatures correct a thermal network: a Kalman filter in its steady state."""

from collections.abc import Sequence

import numpy as np

from bearing_sim.physics.thermal_network import ENDS, NODES


def network_matrix(conductances: np.ndarray, capacities: np.ndarray) -> np.ndarray:
    """Return A of dT/dt = A T + ... [1/s], shape (NODES, NODES).

    Parameters
    ----------
    conductances : [W/K], in the order of `bearing_sim.physics.thermal_network.LINK`.
    capacities : of the nodes [J/K].
    """
    balance = np.zeros((NODES, NODES))
    for conductance, (one, other) in zip(conductances, ENDS.tolist()):
        balance[one, one] += conductance
        if other >= 0:
            balance[other, other] += conductance
            balance[one, other] -= conductance
            balance[other, one] -= conductance
    return -balance / capacities[:, None]


def filter_gain(matrix: np.ndarray, interval: float, walks: np.ndarray, places: Sequence[int], sensor: float) -> np.ndarray:
    """Return the gain of the filter in its steady state, shape (n, readings): T is corrected by gain times (reading less prediction).

    The prediction over an interval is exp(A dt) T, its error a random walk of each state; a reading is a state with white noise (R. E. Kalman, J.
    Basic Eng. 82 (1960) 35).  The steady state of its covariance solves the discrete algebraic Riccati equation.

    Parameters
    ----------
    matrix : A [1/s], shape (n, n), see `network_matrix`.
    interval : dt, time between readings [s].
    walks : standard deviation of each state's walk after a second [K/s^0.5], shape (n,).
    places : states that are read.
    sensor : standard deviation of a reading [K].
    """
    from scipy.linalg import expm, solve_discrete_are

    transition, reading = expm(interval * matrix), np.eye(len(matrix))[list(places)]
    error, readings = np.diag(interval * walks**2), sensor**2 * np.eye(len(reading))
    covariance = solve_discrete_are(transition.T, reading.T, error, readings)
    return covariance @ reading.T @ np.linalg.inv(reading @ covariance @ reading.T + readings)
