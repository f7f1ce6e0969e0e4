# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Lines in recorded vibration against an independent fit of the same recordings.

The recordings are of N205 and NU205 with cuts (Li, Ping, Wang, Chen and Cao, Sensors 13, 2013, 8013): 13 rollers, 50 kHz, 10 s.  Their speeds are
nominal; load and diameters are not stated.  They are not redistributable, so a page made without them says that these checks were not run.  What
is compared are ratios of lines to the shaft's own line; without measured diameters none of them is a slip.
"""

import math
from functools import partial
from pathlib import Path
from typing import NamedTuple

from bearing_sim.files.limits import FileError
from bearing_sim.watchers.vibration.analysis import Geometry, analyse
from bearing_sim.watchers.vibration.reading import read_vibration
from bearing_sim.watchers.vibration.signal import Vibration
from validation.check import FAILS, HOLDS, IN_PART, NOT_RUN, Check, Comparison, judged

_ROLLERS = 13
_SOURCE = "independent fit of the same recording; Li and others, Sensors 13, 2013"


class Recording(NamedTuple):
    """A recording of a bearing with a cut, and what an independent fit found in it.

    Attributes
    ----------
    name : of the file, without its suffix.
    speed : nominal speed of the shaft [rpm].
    shows : the ring that is cut, as `bearing_sim.watchers.vibration.analysis.Analysis.shows` calls it.
    bearing : its designation.
    line, error : frequency of the line over that of the shaft, and its error.
    """

    name: str
    speed: float
    shows: str
    bearing: str
    line: float
    error: float


RECORDINGS = (
    Recording("ob600_2", 600.0, "outer_ring", "N205", 5.4034, 0.0005),
    Recording("ib800_2", 800.0, "inner_ring", "NU205", 7.7661, 0.001),
)


def recorded_checks(folder: Path | None) -> tuple[Check, ...]:
    """Return a check for each recording.

    Parameters
    ----------
    folder : that holds the recordings as NPZ, with counts and sampling rate; None: the checks are lines that were not run.

    Raises
    ------
    FileError
        A recording is not there, or cannot be read.
    VibrationError
        A recording holds no vibration.
    """
    if folder is not None and not folder.is_dir():
        expected = ", ".join(f"{each.name}.npz" for each in RECORDINGS)
        raise FileError(f"no such folder; --recordings expects one with {expected}", str(folder))
    return tuple(
        Check(
            f"recorded_{each.name}",
            "Frequency ratios of recorded vibration",
            partial(_compare, each, None if folder is None else read_vibration(folder / f"{each.name}.npz")),
            f"bearing-sim vibration {each.name}.npz --rollers {_ROLLERS} --speed {each.speed:g}rpm",
        )
        for each in RECORDINGS
    )


def _compare(recording: Recording, vibration: Vibration | None) -> list[Comparison]:
    """Return the comparison of the line found with that of the independent fit: it holds within the error of that fit, in part within three of it."""
    quantity = f"line of the {recording.shows.replace('_', ' ')} over the shaft's, {recording.bearing} at {recording.speed:g} rpm"
    expected = f"{recording.line:.4f} +- {recording.error:g}"
    tolerance = f"{recording.error:g}; in part {3.0 * recording.error:g}"
    if vibration is None:
        reason = "the recordings are not redistributable; give their folder with --recordings"
        return [Comparison(quantity, _SOURCE, expected, reason, "", tolerance, NOT_RUN)]
    found = analyse(vibration, Geometry(_ROLLERS), recording.speed * math.pi / 30.0)
    if found.shows != recording.shows:
        shown = f"a line of the {found.shows.replace('_', ' ')}" if found.found else found.reason
        return [Comparison(quantity, _SOURCE, expected, shown, "", tolerance, FAILS)]
    off = abs(found.line - recording.line)
    verdict = HOLDS if off <= recording.error else IN_PART if off <= 3.0 * recording.error else FAILS
    return [judged(quantity, _SOURCE, expected, f"{found.line:.4f} +- {found.line_error:.4f}", verdict, f"{off:.4f}", tolerance)]
