# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The process that writes live recordings: takes operations from its standard input until that ends, and completes every file then.

Ctrl-C and SIGTERM are left to the process that feeds this one; its end, of whatever kind, ends the input.
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
from types import SimpleNamespace
from typing import BinaryIO

from bearing_sim.sample import sample_dtype
from bearing_sim.sinks.mcap_sink import McapSink
from bearing_sim.sinks.ros_types import load_message_types


def main() -> None:
    """Write what comes on the standard input, and report what becomes of it on the standard output."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    reports = os.dup(1)
    os.dup2(2, 1)  # whatever a library prints is no report
    load_message_types()
    desk = Desk(reports)
    for operations in frames(sys.stdin.buffer):
        for number, name, arguments in operations:
            desk.do(number, name, arguments)
        desk.tell_news()
    desk.close()
    os._exit(0)  # nothing is left to be done, and the process that ends this one waits for it


def frames(stream: BinaryIO) -> Iterator[list]:
    """Yield what `bearing_sim.sinks.recorder` sends, until the stream ends, in the middle of something where the feeding process was killed."""
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


class Desk:
    """The recordings of this process by number; each has faults of its own.

    Parameters
    ----------
    reports : descriptor that reports go to, a line of JSON each.
    """

    def __init__(self, reports: int):
        self._reports, self._telling = reports, threading.Lock()
        self._sinks: dict[int, McapSink] = {}
        self._faulty: set[int] = set()
        self._closing: list[threading.Thread] = []

    def do(self, number: int, name: str, arguments: tuple) -> None:
        """Open or close a recording, or call a method of its sink; the first fault is told, and what comes after it left out."""
        try:
            if name == "open":
                path, scene, start_ns, options = arguments
                self._sinks[number] = McapSink(path, scene, start_ns, **options)
                self._tell(number, opened=True)
            elif name == "close":
                self._close(number)
            elif number in self._sinks and number not in self._faulty:
                _apply(self._sinks[number], name, arguments)
        except Exception as fault:  # even a fault of the program shall not end the other recordings
            self._faulty.add(number)
            self._tell(number, fault=_described(fault), **({"closed": True} if name == "open" else {}))

    def tell_news(self) -> None:
        """Pass on what happened to files."""
        for number, sink in list(self._sinks.items()):
            self._tell_news_of(number, sink)

    def close(self) -> None:
        """Complete what is not complete yet."""
        for number in list(self._sinks):
            self._close(number)
        for thread in self._closing:
            thread.join()

    def _close(self, number: int) -> None:
        """Complete a recording on a thread of its own: its disk may be slow, and the other recordings shall not wait for it."""
        sink = self._sinks.pop(number, None)
        if sink is None:  # it could not be opened
            return
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threading.Thread(target=self._complete, args=(number, sink), name="complete"))
        self._closing[-1].start()

    def _complete(self, number: int, sink: McapSink) -> None:
        try:
            sink.close()
        except Exception as fault:
            self._tell(number, fault=_described(fault))
        self._tell_news_of(number, sink)
        self._tell(number, closed=True)

    def _tell_news_of(self, number: int, sink: McapSink) -> None:
        if news := sink.news():
            self._tell(number, news=[[level.name, code, text] for level, code, text in news])

    def _tell(self, number: int, **told) -> None:
        with self._telling:
            try:
                os.write(self._reports, json.dumps({"recording": number, **told}).encode() + b"\n")
            except OSError:
                pass  # nobody listens any more: the feeding process was killed


def _apply(sink: McapSink, name: str, arguments: tuple) -> None:
    if name == "write":
        numbers, rollers = arguments
        sink.write(numbers.view(sample_dtype(rollers))[:, 0])
    elif name == "write_inputs":
        time, inputs, channels, origin = arguments
        sink.write_inputs(time, SimpleNamespace(**inputs), channels, origin)
    else:
        getattr(sink, name)(*arguments)


def _described(fault: Exception) -> list:
    if isinstance(fault, OSError):
        return [fault.errno, f"{fault.strerror or fault}" + (f": {fault.filename}" if fault.filename else "")]
    if isinstance(fault, ValueError):
        return [None, str(fault)]
    return [None, f"a program fault: {''.join(traceback.format_exception(fault, limit=-3)).strip()}"]


if __name__ == "__main__":
    main()
