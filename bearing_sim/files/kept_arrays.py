# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Arrays that were expensive to compute and are kept on disk, with a digest by which a file that is not whole is seen."""

import hashlib
import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bearing_sim.files.limits import FileError, Limit
from bearing_sim.files.outputs import replaced
from bearing_sim.files.reading import printable, read_bytes

_DIGEST = hashlib.sha256().digest_size


def packed(arrays: Mapping[str, np.ndarray]) -> bytes:
    """Return the contents of a file of arrays by name, as `read_arrays` reads it."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    data = buffer.getvalue()
    return data + hashlib.sha256(data).digest()


def write_arrays(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Write arrays by name: a reader finds the old file or the new one, never a part.  Raises OSError, also if another process is writing it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as draft:
        draft.write_bytes(packed(arrays))


def read_arrays(path: Path, limit: Limit) -> dict[str, np.ndarray]:
    """Return the arrays of a file that `write_arrays` wrote.

    Parameters
    ----------
    path : of the file.
    limit : on its size, and on that of all arrays once they are unpacked.

    Raises
    ------
    FileError
        See `bearing_sim.files.reading.read_bytes`; or the file is not whole.
    Exception
        What its readers raise where the digest fits and the contents are none of `write_arrays`.
    """
    stored = read_bytes(path, limit)
    data = stored[:-_DIGEST]
    if hashlib.sha256(data).digest() != stored[-_DIGEST:]:
        raise FileError("its digest does not fit its contents", printable(path))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        limit.check(sum(member.file_size for member in archive.infolist()), printable(path))
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}
