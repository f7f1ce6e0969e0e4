# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Running means of the rollers' loads, for lives at levels whose loads follow the dynamics."""

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.lanes import load, square_root, total


@kernel
def average_powers(share, rows, present_row, contacts, load_row, count, means):
    """Take the loads of this instant into the running means of Q_i^4 and Q_e^4.5 over all rollers.

    Parameters
    ----------
    share : weight of this instant.
    rows, present_row : rows of the rollers, and which of them says whether a lane holds one.
    contacts, load_row : rows of the contacts, those with the inner raceway first, and which of them is the normal force [N].
    count : number of rollers.
    means : changed in place, shape (2,).
    """
    blocks = rows.shape[0]
    inner, outer = 0.0, 0.0
    for block in range(blocks):
        present, q_i, q_e = load(rows, block, present_row), load(contacts, block, load_row), load(contacts, blocks + block, load_row)
        inner += total(present * (q_i * q_i) * (q_i * q_i))
        outer += total(present * (q_e * q_e) * (q_e * q_e) * square_root(q_e))
    means[0] += share * (inner / count - means[0])
    means[1] += share * (outer / count - means[1])
