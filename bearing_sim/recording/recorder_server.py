# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The process that writes live recordings.

It reads operations from its standard input until that ends, and then completes every file.  Ctrl-C and SIGTERM are left to the process that feeds
it; when that process ends in whatever way, so does the input.
"""

import json
import os
import pickle
import signal
import struct
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import BinaryIO

from bearing_sim.messages.cdr import load_message_types
from bearing_sim.model.sample import sample_dtype
from bearing_sim.recording.append_file import NO_SPACE
from bearing_sim.recording.writer import McapSink

_RETRY_EVERY = 2.0  # [s] to complete a recording once there is space again; the last try is at the end of the process


def main() -> None:
    """Serve the operations on the standard input, and report on the standard output."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    reports = os.dup(1)
    os.dup2(2, 1)  # keeps what a library prints out of the reports
    load_message_types()
    server = RecorderServer(reports)
    for operations in frames(sys.stdin.buffer):
        for number, name, arguments in operations:
            server.do(number, name, arguments)
        server.report_news()
    server.close()
    os._exit(0)  # nothing is left to do, and the feeding process waits


def frames(stream: BinaryIO) -> Iterator[list]:
    """Yield the lists of operations that `bearing_sim.recording.recorder` sends, until the stream ends, perhaps within one."""
    while len(head := stream.read(4)) == 4:
        (count,) = struct.unpack("<I", head)
        lengths = stream.read(8 * count)
        if len(lengths) < 8 * count:
            return
        parts = []
        for length in struct.unpack(f"<{count}Q", lengths):
            parts.append(stream.read(length))
            if len(parts[-1]) < length:
                return
        yield pickle.loads(parts[0], buffers=parts[1:])


class RecorderServer:
    """The recordings of this process by number; an error of one does not affect the others.

    Parameters
    ----------
    reports : descriptor for reports, one line of JSON each.
    """

    def __init__(self, reports: int):
        self._reports, self._reporting = reports, threading.Lock()
        self._sinks: dict[int, McapSink] = {}
        self._failed: set[int] = set()
        self._closing: list[threading.Thread] = []
        self._ending = threading.Event()

    def do(self, number: int, name: str, arguments: tuple) -> None:
        """Open or close a recording, or call a method of its sink; after the first error, which is reported, the recording gets nothing more."""
        try:
            if name == "open":
                path, scene, start_ns, options = arguments
                self._sinks[number] = McapSink(path, scene, start_ns, **options)
                self._report(number, opened=True)
            elif name == "close":
                self._close(number)
            elif number in self._sinks and number not in self._failed:
                _apply(self._sinks[number], name, arguments)
        except Exception as error:  # even a programming error must not end the other recordings
            self._failed.add(number)
            self._report(number, error=_described(error), **({"closed": True} if name == "open" else {}))

    def report_news(self) -> None:
        """Report what happened to files."""
        for number, sink in list(self._sinks.items()):
            self._report_news_of(number, sink)

    def close(self) -> None:
        """Complete what is not complete yet."""
        self._ending.set()
        for number in list(self._sinks):
            self._close(number)
        for thread in self._closing:
            thread.join()

    def _close(self, number: int) -> None:
        """Complete a recording on a thread of its own, so that the other recordings do not wait for its disk."""
        sink = self._sinks.pop(number, None)
        if sink is None:  # it could not be opened
            return
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threading.Thread(target=self._complete, args=(number, sink), name="complete"))
        self._closing[-1].start()

    def _complete(self, number: int, sink: McapSink) -> None:
        try:
            sink.close()
            lacks_space = False
        except Exception as error:
            self._report(number, error=_described(error))
            lacks_space = isinstance(error, OSError) and error.errno in NO_SPACE
        self._report_news_of(number, sink)
        self._report(number, closed=True)
        while lacks_space:
            is_last = self._ending.wait(_RETRY_EVERY)
            with suppress(OSError):
                sink.close()
                return
            lacks_space = not is_last

    def _report_news_of(self, number: int, sink: McapSink) -> None:
        if news := sink.news():
            self._report(number, news=[[level.name, kind, text] for level, kind, text in news])

    def _report(self, number: int, **report) -> None:
        with self._reporting:
            try:
                os.write(self._reports, json.dumps({"recording": number, **report}).encode() + b"\n")
            except OSError:
                pass  # the feeding process was killed


def _apply(sink: McapSink, name: str, arguments: tuple) -> None:
    if name == "write":
        numbers, rollers = arguments
        sink.write(numbers.view(sample_dtype(rollers))[:, 0])
    elif name == "write_inputs":
        time, inputs, channels, origin = arguments
        sink.write_inputs(time, SimpleNamespace(**inputs), channels, origin)
    else:
        getattr(sink, name)(*arguments)


def _described(error: Exception) -> list:
    if isinstance(error, OSError):
        return [error.errno, f"{error.strerror or error}" + (f": {error.filename}" if error.filename else "")]
    if isinstance(error, ValueError):
        return [None, str(error)]
    return [None, f"programming error: {''.join(traceback.format_exception(error, limit=-3)).strip()}"]


if __name__ == "__main__":
    main()
