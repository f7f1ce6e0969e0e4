# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Open and read files that a user names: only regular ones, only as much as a limit allows, and decoded.

A pipe would be waited for without end and a device such as ``/dev/zero`` never ends, so neither is opened.
"""

import os
import stat
from pathlib import Path
from typing import BinaryIO

from bearing_sim.files.limits import FileError, Limit, printable
from bearing_sim.files.outputs import kind_of, remember_input

NO_FILE = "no such file"
"""Why a path cannot be read at which there is nothing."""

_PIECE = 1 << 20  # [byte] that is read at once
_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))


def why_not_readable(path: str | Path) -> str:
    """Return why a path cannot be opened as a regular file, in a few words; empty if it can.

    Nothing is opened, so that neither a pipe nor a device is touched.
    """
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return "a link to a file that does not exist" if os.path.islink(path) else NO_FILE
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        return (getattr(error, "strerror", None) or str(error)).lower()
    return "" if stat.S_ISREG(mode) else f"{kind_of(mode)}, expected a file"


def open_regular(path: str | Path, limit: Limit | None = None) -> BinaryIO:
    """Open a regular file for reading bytes; never a pipe, a device or a folder, and never waiting.

    Parameters
    ----------
    path : of the file.
    limit : on its size; None for a file that is read piece by piece.

    Raises
    ------
    FileError
        There is no such file, it is no regular file, may not be read, or is larger than the limit.
    """
    if reason := why_not_readable(path):
        raise FileError(reason, printable(path))
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        raise FileError((error.strerror or "cannot be opened").lower(), printable(path)) from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):  # replaced since it was looked at
            raise FileError("no regular file", printable(path))
        if limit is not None:
            limit.check(status.st_size, printable(path))
        remember_input(path)
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_bytes(path: str | Path, limit: Limit) -> bytes:
    """Return the content of a regular file.

    Parameters
    ----------
    path : of the file.
    limit : on its size; it holds too for files that the system makes up, whose size is given as zero.

    Raises
    ------
    FileError
        See `open_regular`; or reading fails.
    """
    pieces, length = [], 0
    with open_regular(path, limit) as stream:
        try:
            while piece := stream.read(_PIECE):
                pieces.append(piece)
                length += len(piece)
                limit.check(length, printable(path))
        except OSError as error:
            raise FileError((error.strerror or "cannot be read").lower(), printable(path)) from None
    return b"".join(pieces)


def read_text(path: str | Path, limit: Limit) -> str:
    """Return the text of a regular file in UTF-8, or in the encoding of its byte-order mark.

    Raises
    ------
    FileError
        See `read_bytes`; or it is no such text.
    """
    return decoded(read_bytes(path, limit), path)


def encoding_by_mark(data: bytes) -> str:
    """Return the encoding of a text that begins with these bytes: that of its byte-order mark, or UTF-8."""
    return next((name for mark, name in _MARKS if data.startswith(mark)), "utf-8")


def decoded(data: bytes, origin: str | Path) -> str:
    """Return bytes as text: UTF-8, or the encoding of their byte-order mark; line ends become line feeds.

    Raises
    ------
    FileError
        The bytes are no text in that encoding; the message names the line and the byte.
    """
    encoding = encoding_by_mark(data)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        found = f"line {line}: byte 0x{data[error.start]:02x} is no UTF-8 text" if encoding.startswith("utf-8") else f"no {encoding.upper()} text"
        raise FileError(f"{found}; save the file as UTF-8", printable(origin)) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")
