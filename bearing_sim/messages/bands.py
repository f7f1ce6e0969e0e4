# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bands: quantities with the 5 and 95 % quantiles of what they may be, at some instants; what topics, recordings and views carry of them."""

import re
from typing import NamedTuple

import numpy as np

BANDS, ESTIMATES = "bands", "estimates"
"""The topics: results of the model, and the fields that measurements calibrate."""
EDGES = ("5 %", "95 %")
_NAME = re.compile(r"(?P<name>[^\[\]]+?)(?: \[(?P<unit>[^\[\]]+)\])?")


class Bands(NamedTuple):
    """Quantities with their bands at some instants.

    Attributes
    ----------
    topic : `BANDS` or `ESTIMATES`.
    names : of the quantities.
    units : of each, in SI or h; ``""`` for pure numbers.
    times : [s] since the start of the run, shape (n,).
    numbers : value, 5 % and 95 % quantile of each quantity, shape (n, quantities, 3).
    """

    topic: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    times: np.ndarray
    numbers: np.ndarray

    @property
    def message_names(self) -> tuple[str, ...]:
        """The name of each number of a message: the quantity, and behind it which edge of the band, with the unit."""
        return tuple(
            f"{name}{edge} [{unit}]" if unit else f"{name}{edge}"
            for name, unit in zip(self.names, self.units, strict=True)
            for edge in ("", *(f" {edge}" for edge in EDGES))
        )


def bands_of_message(topic: str, time: float, message_names: list[str], numbers: np.ndarray) -> Bands:
    """Return the bands of one message.

    Parameters
    ----------
    topic : `BANDS` or `ESTIMATES`.
    time : of the message [s] since the start of the run.
    message_names, numbers : as the message has them, see `Bands.message_names`.

    Raises
    ------
    ValueError
        The names and numbers are not those of bands.
    """
    found = [_NAME.fullmatch(name) for name in message_names[::3]]
    if None not in found and len(message_names) == len(numbers) == 3 * len(found):
        names, units = tuple(each["name"] for each in found), tuple(each["unit"] or "" for each in found)
        bands = Bands(topic, names, units, np.array([time]), np.array(numbers, float).reshape(1, -1, 3))
        if list(bands.message_names) == list(message_names):
            return bands
    raise ValueError(f"{len(message_names)} names and {len(numbers)} numbers; expected each quantity with its {' and '.join(EDGES)} quantiles")
