# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Characteristic frequencies of a bearing: how often a damaged spot of the cage, a raceway or a roller meets its partner.

Handbooks compute them from the drawing, for rolling without slip.  Here they follow from the predicted speeds of cage and rollers.  With shaft
speed w_i, cage speed w_c, outer ring at rest, Z rollers, and contact angle 0:

- cage (fundamental train frequency, FTF): w_c/(2 pi);
- ball pass outer (BPFO), rollers that pass a point of the outer ring: Z w_c/(2 pi);
- ball pass inner (BPFI), rollers that pass a point of the inner ring: Z (w_i - w_c)/(2 pi);
- roller spin (BSF), rotation of a roller about its axis as seen from the cage: (w + phi')/(2 pi), spin w and orbital speed phi' of the roller.
  A spot on the roller meets both raceways in each rotation: it shows at twice this frequency.

Without slip w_c = w_i (1 - gamma)/2 and w R_w = r_m w_c (eq. `eq-speeds` of the theory), which turns them into the formulas of Harris and Kotzalas,
Rolling Bearing Analysis, 5th ed., vol. 1, chapter 10, for contact angle 0.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np


class Frequency(NamedTuple):
    """One characteristic frequency: name, the usual abbreviation, and what happens at this frequency."""

    name: str
    symbol: str
    meaning: str

    @property
    def column(self) -> str:
        """The name of its column in tables."""
        return f"{self.name}_frequency"


FREQUENCIES = (
    Frequency("cage", "FTF", "rotation of the cage"),
    Frequency("ball_pass_outer", "BPFO", "rollers that pass a point of the outer ring"),
    Frequency("ball_pass_inner", "BPFI", "rollers that pass a point of the inner ring"),
    Frequency("roller_spin", "BSF", "rotation of a roller seen from the cage, mean over the rollers that the inner ring loads"),
)


def characteristic_frequencies(samples: np.ndarray) -> np.ndarray:
    """Return the characteristic frequencies of samples [Hz], shape (n, 4), in the order of `FREQUENCIES`.

    The spin of rollers differs around the bearing: the frequency of a roller is the mean over the rollers that the inner ring loads at that
    instant, where a damaged spot is heard, or over all rollers if it loads none.

    Parameters
    ----------
    samples : shape (n,); see `bearing_sim.model.sample`.  Frequencies do not depend on the sense of rotation and are not negative.
    """
    cage, turns = samples["cage_speed"], samples["roller_spin"] + samples["orbital_speed"]
    rollers = turns.shape[1]
    loaded = samples["inner_load"] > 0.0
    loaded |= ~loaded.any(axis=1, keepdims=True)
    spin = np.add.reduce(turns, axis=1, where=loaded) / np.add.reduce(loaded, axis=1)
    found = np.stack((cage, rollers * cage, rollers * (samples["shaft_speed"] - cage), spin), axis=1)
    return np.abs(found) / (2.0 * np.pi)


def mean_frequencies(samples: np.ndarray) -> dict[str, float]:
    """Return the means of the characteristic frequencies over samples [Hz], by name."""
    return dict(zip((frequency.name for frequency in FREQUENCIES), map(float, characteristic_frequencies(samples).mean(axis=0))))


def frequencies_text(frequencies: Mapping[str, float]) -> str:
    """Return characteristic frequencies [Hz] for people, by their abbreviations, and which of them the level does not compute, NaN."""
    known = {each.symbol: frequencies[each.name] for each in FREQUENCIES if not math.isnan(frequencies[each.name])}
    unknown = ", ".join(each.symbol for each in FREQUENCIES if each.symbol not in known)
    shown = ", ".join(f"{symbol} {value:.5g}" for symbol, value in known.items()) + " Hz, with this slip" if known else ""
    return "; ".join(filter(None, (shown, f"not {unknown}, which this level does not compute" if unknown else "")))
