# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read MCAP files that may have been cut short."""

from mcap.exceptions import EndOfFile


class WholeReads:
    """A stream that never returns less than asked for: the end of a file cut short shall not pass for data.

    Parameters
    ----------
    stream : a binary file.

    Raises
    ------
    EndOfFile
        By ``read``, where the stream ends before.
    """

    def __init__(self, stream):
        self._stream = stream

    def read(self, length: int) -> bytes:
        """Return exactly ``length`` bytes."""
        data = self._stream.read(length)
        if len(data) < length:
            raise EndOfFile()
        return data
