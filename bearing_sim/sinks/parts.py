# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A recording in one file or in several, in a bag's folder or not."""

import math
import threading
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bearing_sim.events import Level
from bearing_sim.sinks.bag_metadata import Part, TopicCount, bag_metadata, write_bag_metadata
from bearing_sim.sinks.limits import UNPARTED, Limits
from bearing_sim.sinks.mcap_file import McapFile
from bearing_sim.sinks.mcap_rows import RowLayout


class Parts:
    """The files of a recording, one after the other; each can be read alone.

    Parameters
    ----------
    path : ``run.mcap`` is one file, or ``run_0.mcap``, ``run_1.mcap`` ... where ``limits`` part it.  A name without ``.mcap`` is a bag: a
        folder of such files with a ``metadata.yaml``, as rosbag2 makes it.
    metadata, custom_data, flush_every, replace : see `bearing_sim.sinks.mcap_file.McapFile`; a bag is never replaced.
    limits : where files end.

    Raises
    ------
    OSError
        The first file cannot be made; FileExistsError where there is one.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: Mapping[str, Mapping[str, str]],
        custom_data: Mapping[str, str],
        flush_every: float = 0.5,
        replace: bool = False,
        limits: Limits = UNPARTED,
    ):
        self.path, self.limits = Path(path), limits
        self._is_bag = self.path.suffix != ".mcap"
        self._parted = math.isfinite(limits.part_size) or math.isfinite(limits.part_duration)
        if self._is_bag and self.path.exists():
            what = "is a folder" if self.path.is_dir() else "exists"
            raise FileExistsError(f"{self.path} {what}; a recording does not replace another one (a name that ends in .mcap makes a single file)")
        self._metadata, self._custom_data, self._flush_every, self._replace = metadata, custom_data, flush_every, replace
        self._done: list[tuple[Part, list[TopicCount]]] = []
        self._news: list[tuple[Level, str, str]] = []
        self._completing: threading.Thread | None = None
        self._file = self._open()

    @property
    def current(self) -> McapFile:
        """The file that is being written."""
        return self._file

    def write(self, topic: str, ros_type: str, time_ns: int, message: dict) -> None:
        """Write one message (see `McapFile.write`)."""
        self._turn_page()
        self._file.write(topic, ros_type, time_ns, message)

    def write_cdr(self, topic: str, ros_type: str, time_ns: int, data: bytes, publish_ns: int | None = None) -> None:
        """Write one serialised message (see `McapFile.write_cdr`)."""
        self._turn_page()
        self._file.write_cdr(topic, ros_type, time_ns, data, publish_ns)

    def write_rows(self, layout: RowLayout, block: np.ndarray, times_ns: np.ndarray) -> None:
        """Write a block of samples (see `McapFile.write_rows`)."""
        self._turn_page()
        self._file.write_rows(layout, block, times_ns)

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._file.flush()

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, code, text) of what a person should be told since the last call."""
        told, self._news = self._news, []
        return told + self._file.news()

    def close(self) -> None:
        """Complete the last file and the bag; a second call does nothing."""
        if self._completing is not None:
            self._completing.join()
        self._complete(self._file)

    def _path_of(self, number: int) -> Path:
        if self._is_bag:
            return self.path / f"{self.path.name}_{number}.mcap"
        return self.path.with_stem(f"{self.path.stem}_{number}") if self._parted else self.path

    def _open(self) -> McapFile:
        number = len(self._done)
        metadata = {name: {**record, "part": str(number)} if name == "bearing_sim" else record for name, record in self._metadata.items()}
        return McapFile(self._path_of(number), metadata, self._custom_data, self._flush_every, self._replace, self.limits.keep_free)

    def _turn_page(self) -> None:
        start, end = self._file.span
        if self._file.length < self.limits.part_size and end - start < 1e9 * self.limits.part_duration:
            return
        full = self._file
        if self._completing is not None:
            self._completing.join()
        self._done.append((full.part(), full.topic_counts()))
        self._file = self._open()
        # Completing waits for the disk, which the writer of messages shall not.
        self._completing = threading.Thread(target=self._complete_aside, args=(full,), name="mcap-complete", daemon=True)
        self._completing.start()

    def _complete_aside(self, full: McapFile) -> None:
        try:
            full.close()
            if self._is_bag:
                self._write_metadata(self._done)
        except OSError as fault:
            self._news.append((Level.ERROR, "recording.part", f"{full.path} could not be completed: {fault}"))
        self._news += full.news()

    def _complete(self, last: McapFile) -> None:
        last.close()
        if self._is_bag:
            self._write_metadata([*self._done, (last.part(), last.topic_counts())])

    def _write_metadata(self, done: list[tuple[Part, list[TopicCount]]]) -> None:
        write_bag_metadata(self.path, bag_metadata([part for part, _ in done], [topics for _, topics in done], self._custom_data))
