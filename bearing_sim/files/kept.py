# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files that the program keeps for itself: each has a checksum, so that a damaged one is never used, and is replaced as a whole.

What is kept is a convenience: a file that is damaged or cannot be read counts as missing, where none can be written the run goes on without, and both
are said once, on the log of this module.
"""

import hashlib
import io
import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from bearing_sim.files.limits import FileError, Limit
from bearing_sim.files.outputs import BeingWritten, replaced
from bearing_sim.files.reading import printable, read_bytes

if TYPE_CHECKING:
    import numpy as np

_DIGEST = hashlib.sha256().digest_size
_told: set[str] = set()
_Read = TypeVar("_Read")


class Damaged(ValueError):
    """Contents of a file that are not what was written there; the message says why."""


def cache_folder() -> Path:
    """Return the user's folder for what this program can make again; for a user without a home folder one that cannot be made."""
    return _user_folder("user_cache_dir")


def state_folder() -> Path:
    """Return the user's folder for what this program goes on with; for a user without a home folder one that cannot be made."""
    return _user_folder("user_state_dir")


def _user_folder(kind: str) -> Path:
    import platformdirs

    try:
        return Path(getattr(platformdirs, kind)("bearing_sim"))
    except RuntimeError:
        return Path(os.devnull, "bearing_sim")


def read_kept(path: Path, limit: Limit, parsed: Callable[[bytes], _Read]) -> _Read | None:
    """Return what a file holds; None where there is none, or none that can be used, which is said with the reason.

    Parameters
    ----------
    path : of the file.
    limit : on its size.
    parsed : returns what its contents stand for, and raises any exception where they are damaged.
    """
    if not os.path.lexists(path):
        return None
    try:
        return parsed(read_bytes(path, limit))
    except FileError as error:
        fault = f"cannot be read: {error.reason}"
    except Damaged as error:
        fault = f"is damaged: {error}"
    except Exception:  # whatever contents that another version has written make their reader raise
        fault = "is damaged: it holds something else than this version keeps there"
    tell_once(f"{printable(path)} {fault}; it is ignored and built again", path)
    return None


def write_kept(path: Path, data: bytes) -> None:
    """Write a file: a reader finds the old one or the new one, never a part.  Raises OSError, also if another process is writing it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as draft:
        draft.write_bytes(data)


@contextmanager
def kept_if_possible(path: Path) -> Iterator[None]:
    """Go on where the block cannot write a file, and say so once for its folder, unless another process is writing it."""
    try:
        yield
    except BeingWritten:
        pass
    except OSError as error:
        tell_once(
            f"{printable(path.parent)}: nothing is kept there for the next run, since it cannot be written: {error.strerror or error}", path.parent
        )


def tell_once(text: str, about: object = None) -> None:
    """Log a warning, once for what it is about, or for its text; worker processes leave that to the process that has started them."""
    import logging
    import multiprocessing

    about = str(about or text)
    if about not in _told and multiprocessing.parent_process() is None:
        _told.add(about)
        logging.getLogger(__name__).warning("%s", text)


def with_checksum(kind: str, version: int, contents: Mapping[str, object]) -> bytes:
    """Return contents as JSON with their kind, version and checksum, as `checked_contents` reads it."""
    data = json.dumps(contents, allow_nan=False).encode()
    head = {"format": _format(kind), "version": version, "checksum": _checksum(version, data)}
    return json.dumps(head).encode()[:-1] + _before_contents(kind) + data + b"}\n"


def checked_contents(data: bytes, kind: str) -> tuple[int, dict[str, object]]:
    """Return version and contents of what `with_checksum` has made; without a checksum only if people wrote it, which is version 0.

    Raises
    ------
    Damaged
        A bit or more differs from what was written, or it is of another kind.
    """
    try:
        whole = json.loads(data)
    except RecursionError:
        raise Damaged("it is cut short or overwritten: lists in lists without end") from None
    except ValueError as error:
        raise Damaged(f"it is cut short or overwritten: {error}" if data.strip() else "it is empty") from None
    if not isinstance(whole, dict) or whole.get("format") != _format(kind) or not isinstance(whole.get("version"), int):
        raise Damaged(f"it is no {kind} file: expected format {_format(kind)!r} and a version")
    version, contents = whole["version"], whole.get(kind)
    if not isinstance(contents, dict):
        raise Damaged(f"it has no {kind}")
    # By the bytes: another spelling of a number is damage, too.
    if (version > 0 or "checksum" in whole) and whole.get("checksum") != _checksum(
        version, data.partition(_before_contents(kind))[2].removesuffix(b"}\n")
    ):
        raise Damaged("its checksum does not fit its contents")
    return version, contents


def _format(kind: str) -> str:
    return f"bearing_sim {kind}"


def _before_contents(kind: str) -> bytes:
    return f', "{kind}": '.encode()


def _checksum(version: int, data: bytes) -> str:
    return hashlib.sha256(b"%d " % version + data).hexdigest()


def with_digest(data: bytes) -> bytes:
    """Return data with a digest behind them, as `without_digest` reads them."""
    return data + hashlib.sha256(data).digest()


def without_digest(stored: bytes) -> bytes:
    """Return what `with_digest` was given.  Raises `Damaged` where a bit or more differs."""
    data = stored[:-_DIGEST]
    if hashlib.sha256(data).digest() != stored[-_DIGEST:]:
        raise Damaged("its digest does not fit its contents" if stored else "it is empty")
    return data


def packed(arrays: "Mapping[str, np.ndarray]") -> bytes:
    """Return arrays by name as the contents of a file, as `unpacked` reads it: compressed, and a digest of that."""
    import numpy as np  # here, because workers set their numbers of threads before they import it

    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return with_digest(buffer.getvalue())


def unpacked(stored: bytes, limit: Limit) -> "dict[str, np.ndarray]":
    """Return the arrays in the contents of a file that `packed` has made.

    Parameters
    ----------
    limit : on the size of all arrays.

    Raises
    ------
    Damaged
        A bit or more differs from what was written.
    LimitError
        They are larger.
    """
    import zipfile

    import numpy as np

    data = without_digest(stored)
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        limit.check(sum(member.file_size for member in archive.infolist()), "its arrays")
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}
