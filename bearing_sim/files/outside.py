# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether files that a file names, such as the contour of a scene, may lie outside of its folder.

A scene from a stranger could otherwise make a command read, and its messages or recordings print, any file that the user may read.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

OPTION = "--allow-outside"
"""Option of the command line; the node has the parameter ``allow_outside``, Python the argument of that name."""

_is_allowed: ContextVar[bool] = ContextVar("files outside are allowed", default=False)


@contextmanager
def allowing_outside(allowed: bool = True) -> Iterator[None]:
    """Allow files outside of the folder within the block, if ``allowed``; otherwise leave it as it is.

    Only the thread of the block is allowed to, so that what one thread of a node reads is never decided by the parameters of another.
    """
    before = _is_allowed.set(_is_allowed.get() or allowed)
    try:
        yield
    finally:
        _is_allowed.reset(before)


def why_outside(named: str, folder: Path) -> str:
    """Return why a file that is named in a file must not be read; empty if it may.

    Parameters
    ----------
    named : path as it is written, relative to the folder.
    folder : of the file that names it.  Symbolic links are followed: one that leads out of the folder is outside, too.
    """
    if _is_allowed.get():
        return ""
    try:
        inside = (folder / named).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError) as error:  # RuntimeError: links in a circle; ValueError: a null character
        return f"no usable path ({error})"
    if inside:
        return ""
    return f"outside of the folder of the file that names it, so it is not read; move it there, or allow it: {OPTION} (node: allow_outside)"
