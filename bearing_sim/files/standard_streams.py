# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What programs do where a standard stream is closed or full: they do their work all the same."""

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


class _Stream(io.FileIO):
    """A standard stream that drops what is written after the first failure, which it remembers."""

    failure: OSError | None = None

    def write(self, data) -> int | None:
        """Write; see `io.RawIOBase.write`."""
        if self.failure is None:
            try:
                return super().write(data)
            except OSError as error:
                self.failure = error
        return len(data)


@contextmanager
def standard_streams() -> Iterator[None]:
    """Run a program in the block: where nobody reads its output any more, it goes on quietly; output that cannot be written fails it at its end.

    A reader that closes its pipe, as ``head`` does, is served, and a stream that is closed from the beginning is not wanted, so neither changes the
    exit code.  A full disk does: one line on stderr, and exit code 1 where it was 0.  Streams that somebody has replaced, such as tests, are left
    alone.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:  # closed: the next file that is opened, such as a recording, would become this stream
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    sys.stdin = sys.stdin or open(0)
    stdout = _forgiving("stdout", 1)
    _forgiving("stderr", 2)
    try:
        yield
    except SystemExit as ending:
        if _has_failed(stdout):
            raise SystemExit(ending.code or 1) from None
        raise
    if _has_failed(stdout):
        raise SystemExit(1)


def _forgiving(name: str, descriptor: int) -> _Stream | None:
    """Put a stream that never raises in the place of `sys.stdout` or `sys.stderr`, and return what it writes to."""
    before = getattr(sys, name)
    if before is not getattr(sys, f"__{name}__"):
        return None
    stream, like = _Stream(descriptor, "w", closefd=False), {"encoding": "utf-8", "errors": "backslashreplace"}
    if before is not None:
        like = {each: getattr(before, each) for each in ("encoding", "errors", "line_buffering", "write_through")}
    setattr(sys, name, io.TextIOWrapper(io.BufferedWriter(stream), **like))
    return stream


def _has_failed(stdout: _Stream | None) -> bool:
    """Return whether stdout could not be written although somebody wants it, and say so."""
    if stdout is None:
        return False
    sys.stdout.flush()
    if stdout.failure is None or stdout.failure.errno == errno.EPIPE:
        return False
    print(f"Error: standard output could not be written: {stdout.failure.strerror}", file=sys.stderr, flush=True)
    return True
