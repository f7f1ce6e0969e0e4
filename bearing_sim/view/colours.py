# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Colours of the view: maps for loads and temperatures and a palette for lines, all readable with any kind of colour blindness."""

import numpy as np

# Viridis (S. van der Walt, N. Smith, CC0) at nine even points, the first one lightened for a dark background; between them
# linear, which the eye does not notice.
_ANCHORS = np.array(
    [(82, 24, 110), (71, 44, 122), (59, 81, 139), (44, 113, 142), (33, 144, 141), (39, 173, 129), (92, 200, 99), (170, 220, 50), (253, 231, 37)],
    float,
)

# Inferno (S. van der Walt, N. Smith, CC0) at nine even points from a fifth of its length on, which a dark background leaves visible.
_HEAT_ANCHORS = np.array(
    [(66, 10, 104), (106, 23, 110), (146, 37, 104), (185, 53, 86), (218, 78, 60), (241, 115, 29), (251, 157, 7), (248, 205, 55), (245, 249, 146)],
    float,
)

# Okabe and Ito's palette, lightened where needed for a dark background.
BLUE = (86, 180, 233, 255)
ORANGE = (230, 159, 0, 255)
GREEN = (44, 196, 146, 255)
YELLOW = (240, 228, 66, 255)
VERMILION = (232, 106, 32, 255)
PURPLE = (204, 121, 167, 255)
WHITE = (235, 235, 235, 255)
GREY = (150, 155, 165, 255)
DARK_BLUE = (58, 108, 184, 255)
DARK_VERMILION = (168, 70, 40, 255)
LIME = (168, 208, 64, 255)
SAND = (196, 186, 140, 255)
STEEL = (92, 98, 110, 255)
DARK_STEEL = (52, 57, 68, 255)
BRONZE = (150, 112, 66, 255)
DARK_BRONZE = (112, 84, 52, 255)
UNLOADED = (86, 92, 106, 255)


def load_palette(entries: int = 256) -> np.ndarray:
    """Return the colour map from no load to full scale, uint8, shape (entries, 3)."""
    return _palette(_ANCHORS, entries)


def heat_palette(entries: int = 256) -> np.ndarray:
    """Return the colour map from cold to hot, uint8, shape (entries, 3)."""
    return _palette(_HEAT_ANCHORS, entries)


def _palette(anchors: np.ndarray, entries: int) -> np.ndarray:
    position = np.linspace(0.0, len(anchors) - 1, entries)
    return np.stack([np.interp(position, np.arange(len(anchors)), anchors[:, channel]) for channel in range(3)], axis=1).round().astype(np.uint8)


_PALETTE, _HEAT_PALETTE = load_palette(), heat_palette()


def load_colours(loads: np.ndarray, scale: float) -> np.ndarray:
    """Return one RGBA colour for each load [N], uint8, shape (..., 4); unloaded rollers are grey.

    Parameters
    ----------
    loads : loads [N]; NaN counts as none.
    scale : load at the upper end of the map [N].
    """
    loads = np.nan_to_num(np.asarray(loads, float))
    index = np.clip(255 * loads / scale, 0, 255).astype(int)
    colours = np.concatenate((_PALETTE[index], np.full((*loads.shape, 1), 255, np.uint8)), axis=-1)
    colours[loads <= 0] = UNLOADED
    return colours


def heat_colours(temperatures: np.ndarray, scale: tuple[float, float]) -> np.ndarray:
    """Return one RGBA colour for each temperature, uint8, shape (..., 4); unknown ones are the colour of steel.

    Parameters
    ----------
    temperatures : in the unit of the scale; NaN: unknown.
    scale : temperatures at both ends of the map.
    """
    temperatures, (low, high) = np.asarray(temperatures, float), scale
    index = np.clip(255 * (np.nan_to_num(temperatures, nan=low) - low) / (high - low), 0, 255).astype(int)
    colours = np.concatenate((_HEAT_PALETTE[index], np.full((*temperatures.shape, 1), 255, np.uint8)), axis=-1)
    colours[np.isnan(temperatures)] = DARK_STEEL
    return colours
