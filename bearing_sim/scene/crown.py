# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Crown: how far a roller's profile drops from a straight cylinder towards its ends, and the drops of its slices."""

import csv
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from bearing_sim.files.limits import CROWN_FILE, CROWN_POINTS, FileError
from bearing_sim.files.reading import read_text
from bearing_sim.scene.quantity import Quantity, check, named_law, record

_TABLE_HEADER = "expected a header of two columns, position and drop, each with its unit in brackets, such as position[mm],drop[um]"


@record
class NoCrown:
    """A straight cylinder: no drop anywhere."""

    law: Literal["none"] = "none"


@record
class IsoLogCrown:
    """The logarithmic profile of ISO/TS 16281: P(x) = 0.00035 D_w ln(1/(1 - (2 x/L)^2)); infinite at the end, x = L/2."""

    law: Literal["iso_log"] = "iso_log"


@record
class StraightArcCrown:
    """Straight in the middle, then an arc: P(x) = R_c - sqrt(R_c^2 - s^2), s = |x| - straight_length/2, where s > 0."""

    law: Literal["straight_arc"] = "straight_arc"
    straight_length: Annotated[float, Quantity("m", "length of the straight middle part", 0.0, 0.5, "mm")]
    crown_radius: Annotated[float, Quantity("m", "radius of the arcs on both sides of it, R_c", 1e-3, 1e3, "mm")]


@record
class TableCrown:
    """A measured profile, linear between its points; positions are measured from the roller's middle along x."""

    law: Literal["table"] = "table"
    positions: tuple[Annotated[float, Quantity("m", "position along the roller, from its middle", -0.25, 0.25, "mm")], ...]
    drops: tuple[Annotated[float, Quantity("m", "drop from the cylinder of the largest diameter", 0.0, 5e-3, "um")], ...]

    @check
    def _points_pair_up(self) -> list[str]:
        if len(self.positions) != len(self.drops) or len(self.drops) < 2:
            return [f"drops: {len(self.drops)} values for {len(self.positions)} positions; expected the same number, at least two"]
        if any(b <= a for a, b in zip(self.positions, self.positions[1:])):
            return ["positions: expected increasing positions"]
        return []


def _from_shorthand(value):
    """Return the record for a bare name or for the path of a CSV file."""
    if isinstance(value, dict) and "file" in value and value.get("law", "table") == "table":
        if not isinstance(value["file"], (str, Path)) or "positions" in value or "drops" in value:
            raise ValueError("file: expected the path of a CSV file; give either file, or positions and drops")
        return {"law": "table", **{key: item for key, item in value.items() if key != "file"}, **crown_points(value["file"])}
    return named_law(value)


Crown = Annotated[
    NoCrown | IsoLogCrown | StraightArcCrown | TableCrown,
    Field(discriminator="law"),
    BeforeValidator(_from_shorthand),
]
"""A crown in a scene: a record, or the bare name of one that needs no numbers (``none``, ``iso_log``)."""


def crown_points(path: str | Path) -> dict[str, list[str]]:
    """Return positions and drops from a CSV file, as text with units.

    Parameters
    ----------
    path : of a file whose first line names the columns with units, ``position[mm],drop[um]``; ``#`` begins a comment.

    Raises
    ------
    ValueError
        The file cannot be read or has another format.
    """
    try:
        lines = [line for line in read_text(path, CROWN_FILE).splitlines() if not line.lstrip().startswith("#")]
        rows = [row for row in csv.reader(lines) if any(cell.strip() for cell in row)]
        CROWN_POINTS.check(len(rows), "its points")
    except FileError as error:
        raise ValueError(f"file {str(path)!r} cannot be read: {error.reason}") from None
    except csv.Error as error:
        raise ValueError(f"file {str(path)!r} cannot be read: {error}") from None
    names = [cell.strip().rstrip("]").split("[") for cell in rows[0]] if rows else []
    units = {name[0].strip(): (column, name[1]) for column, name in enumerate(names) if len(name) == 2}
    if len(names) != 2 or set(units) != {"position", "drop"}:
        raise ValueError(f"file {str(path)!r}: {_TABLE_HEADER}")
    short = next((number for number, row in enumerate(rows[1:], 1) if len(row) != 2), None)
    if short is not None:
        raise ValueError(f"file {str(path)!r}: row {short} has {len(rows[short])} columns, expected 2")
    return {f"{name}s": [f"{row[column].strip()} {unit}" for row in rows[1:]] for name, (column, unit) in units.items()}


def slice_middles(length: float, slices: int) -> np.ndarray:
    """Return the middles of a roller's slices along x, x_k = (k - 1/2) L/N - L/2 [m], shape (slices,)."""
    return (np.arange(slices) + 0.5) * (length / slices) - length / 2


def log_scale(roller_diameter: float) -> float:
    """Return the factor of the logarithm in the profile of ISO/TS 16281 [m]."""
    return 0.00035 * roller_diameter


def crown_drops(crown, roller_diameter: float, length: float, slices: int) -> np.ndarray:
    """Return the drop C_k of every slice at its middle [m], shape (slices,).

    The drop reduces the penetration of each of the two contacts: delta_k = delta - C_k + tilt x_k.  ISO/TS 16281 counts the
    approach of both rings as one and subtracts 2 P(x_k), which is equivalent.

    Parameters
    ----------
    crown : one of the records of this module.
    roller_diameter, length : D_w and L [m].
    slices : their number, N.
    """
    x = slice_middles(length, slices)
    if isinstance(crown, IsoLogCrown):
        return -log_scale(roller_diameter) * np.log1p(-((2.0 * x / length) ** 2))
    if isinstance(crown, StraightArcCrown):
        on_arc = np.maximum(np.abs(x) - crown.straight_length / 2, 0.0)
        # R - sqrt(R^2 - s^2), written without the difference of two large numbers
        return on_arc**2 / (crown.crown_radius + np.sqrt(crown.crown_radius**2 - on_arc**2))
    if isinstance(crown, TableCrown):
        return np.interp(x, crown.positions, crown.drops)
    return np.zeros(slices)


def crown_errors(crown, length: float) -> list[str]:
    """Return error messages for a crown that does not fit a roller of the given length [m]."""
    half = length / 2
    if isinstance(crown, StraightArcCrown):
        if crown.straight_length > length:
            return [f"crown.straight_length: {1e3 * crown.straight_length:.6g} mm is longer than the roller, {1e3 * length:.6g} mm"]
        if crown.crown_radius <= half - crown.straight_length / 2:
            return [f"crown.crown_radius: {1e3 * crown.crown_radius:.6g} mm is too small: the arc would end before the end of the roller"]
    if isinstance(crown, TableCrown) and not (crown.positions[0] <= -half * (1 - 1e-9) and crown.positions[-1] >= half * (1 - 1e-9)):
        reached = f"{1e3 * crown.positions[0]:.6g} to {1e3 * crown.positions[-1]:.6g} mm"
        return [f"crown.positions: {reached} do not cover the roller, {-1e3 * half:.6g} to {1e3 * half:.6g} mm"]
    return []
