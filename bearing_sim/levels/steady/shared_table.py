# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables of operating points that one machine builds and another one uses.

A kept table is found by a hash of the numbers that it depends on.  Some of them, such as viscosities, are computed, and their last digits
depend on the machine, so that a file of the same name may not be found on another one.  A shared file has the numbers themselves: whoever
takes it compares them with those of the own scene, and keeps the table under the own hash.
"""

from pathlib import Path

import numpy as np

from bearing_sim.files.kept import Damaged, packed, unpacked
from bearing_sim.files.limits import KEPT_TABLE_FILE, FileError
from bearing_sim.files.reading import printable, read_bytes
from bearing_sim.levels.steady.table import Table
from bearing_sim.levels.steady.table_builder import (
    Quality,
    corrected_by,
    reference_of,
    shifted,
    table_arrays,
    table_numbers,
    table_of,
    table_path,
    write_table,
)
from bearing_sim.model.table_span import span_of
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.scene.scene import Scene

_TOLERANCE = 1e-9  # of a number, relative to the largest of its array: far above rounding, far below what a scene's digits say


def shared_table(scene: Scene, table: Table, quality: Quality) -> bytes:
    """Return the contents of a file from which another machine takes the table of a scene (see `take_table`)."""
    numbers = table_numbers(scene, span_of(scene))
    about = {
        "numbers": np.concatenate([number.reshape(-1) for number in numbers]),
        "sizes": np.array([number.size for number in numbers]),
        "corrected_by": np.array(corrected_by(scene)),
        "program": np.array(sources_hash()),
    }
    kept = shifted(table, -reference_of(scene, span_of(scene)).offset)
    return packed(table_arrays(kept, quality) | about)


def take_table(path: Path, scene: Scene) -> tuple[Table, Quality]:
    """Keep the table of a shared file for a scene, where `bearing_sim.levels.steady.table_builder.obtain_table` finds it, and return it.

    Raises
    ------
    FileError
        It cannot be read, is no shared table, was built by another version, or for another bearing, oil or range.
    OSError
        The table cannot be kept.
    """
    where, span = printable(path), span_of(scene)
    try:
        file = unpacked(read_bytes(path, KEPT_TABLE_FILE), KEPT_TABLE_FILE)
        theirs, sizes = np.asarray(file["numbers"], float).reshape(-1), file["sizes"].tolist()
        program, corrected = str(file["program"]), str(file["corrected_by"])
    except FileError:
        raise
    except Damaged as error:
        raise FileError(str(error), where) from None
    except Exception:  # whatever its reader raises where the file is whole and has something else in it
        raise FileError("it has no table for other machines; write one with bearing-sim table SCENE -o FILE", where) from None
    if program != sources_hash():
        raise FileError("built by another version; install the same versions of bearing_sim and numba on both machines, or build it again", where)
    own = table_numbers(scene, span)
    if sizes != [number.size for number in own] or corrected != corrected_by(scene) or not _agree(own, theirs):
        raise FileError(f"built for another bearing, oil, range or tolerance than those of {scene.name}; build it from the same scene", where)
    try:
        found = table_of(file)
    except Exception:  # whatever arrays of another kind make their reader raise
        raise FileError("it holds no whole table; build it again", where) from None
    write_table(table_path(scene, span), *found)
    return shifted(found[0], reference_of(scene, span).offset), found[1]


def _agree(own: list[np.ndarray], theirs: np.ndarray) -> bool:
    """Return whether arrays are, but for rounding, those that stand one after the other in ``theirs``."""
    if theirs.size != sum(number.size for number in own):
        return False
    first = 0
    for number in own:
        other = theirs[first : first + number.size].reshape(number.shape)
        first += number.size
        with np.errstate(invalid="ignore"):
            largest = np.nanmax(np.where(np.isfinite(number), abs(number), 0.0), initial=0.0)
        if not np.allclose(number, other, rtol=0.0, atol=_TOLERANCE * largest, equal_nan=True):
            return False
    return True
