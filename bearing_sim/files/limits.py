# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The limits on what is read: each bounds the memory or the time that a file from a stranger can cost.

They are generous: what people write stays far below them.  Whoever means a larger file raises a limit by its name in the environment
variable ``BEARING_SIM_LIMITS``, such as ``BEARING_SIM_LIMITS=scene_file=16e6,yaml_nodes=50000``; a refusal says which.  A file cannot raise
a limit itself, because then it would bound nothing.  The variable applies to commands, nodes and the processes that they start.
"""

import os
from dataclasses import dataclass
from functools import lru_cache

VARIABLE = "BEARING_SIM_LIMITS"
"""Environment variable that raises limits: ``NAME=NUMBER``, separated by commas."""

_LARGEST = 2**63 - 1


LONGEST_NAME = 300
"""Characters of a path or of a name from a file that a message shows."""


def printable(text: str | os.PathLike, longest: int = LONGEST_NAME) -> str:
    """Return a path or a text from a file as messages show it: at most so many characters, and none that would act on a terminal.

    Of a longer one the beginning and the end are kept: a path is recognised by its last part.
    """
    text = _shortened(str(text), longest)  # before anything is escaped, because a file can hold a text of any length
    return text if text.isprintable() else _shortened(repr(text)[1:-1], longest)


def _shortened(text: str, longest: int) -> str:
    end = (longest - 3) // 2
    return text if len(text) <= longest else f"{text[: longest - 3 - end]}...{text[-end:]}"


class FileError(ValueError):
    """A file that cannot be read, or whose content exceeds a limit; the message says which file, why and what to do.

    Attributes
    ----------
    reason : the message without the name of the file.
    """

    def __init__(self, reason: str, where: str = ""):
        self.reason = reason
        super().__init__(f"{where}: {reason}" if where else reason)


class LimitError(FileError):
    """A file or a text that exceeds a limit; or ``BEARING_SIM_LIMITS`` itself cannot be read."""


@dataclass(frozen=True)
class Limit:
    """One limit on what is read.

    Attributes
    ----------
    name : by which ``BEARING_SIM_LIMITS`` raises it.
    default : its value unless it is raised.
    unit : of the value, in the plural.
    bounds : what it bounds, in words.
    """

    name: str
    default: int
    unit: str
    bounds: str

    @property
    def value(self) -> int:
        """The limit in force.

        Raises
        ------
        LimitError
            ``BEARING_SIM_LIMITS`` cannot be read.
        """
        return _raised(os.environ.get(VARIABLE, "")).get(self.name, self.default)

    def check(self, found: int, what: str) -> None:
        """Refuse something that exceeds the limit.

        Parameters
        ----------
        found : how much it has, in the unit of the limit.
        what : the file, line or field, which begins the message.

        Raises
        ------
        LimitError
            ``found`` is above the limit.
        """
        if found > self.value:
            raise LimitError(self.refusal(found), what)

    def refusal(self, found: int | None = None) -> str:
        """Return why something is refused and which name raises the limit.

        Parameters
        ----------
        found : how much it has; None where only that it is too much is known.
        """
        has = f"more {self.unit}" if found is None else f"{found:,} {self.unit}, more"
        advice = f"if it is meant, raise the limit: {VARIABLE}={self.name}=NUMBER"
        return f"{has} than the limit of {self.value:,} for {self.bounds}; {advice}"


SCENE_FILE = Limit("scene_file", 5_000_000, "bytes", "a scene, a mapping or another YAML file")
YAML_NODES = Limit("yaml_nodes", 20_000, "values", "a YAML text with its aliases written out")
YAML_DEPTH = Limit("yaml_depth", 40, "levels", "blocks within blocks of a YAML text")
CONTOUR_FILE = Limit("contour_file", 4_000_000, "bytes", "the contour of one turn")
CONTOUR_POINTS = Limit("contour_points", 100_000, "points", "the contour of one turn")
CROWN_FILE = Limit("crown_file", 1_000_000, "bytes", "the profile of a roller")
CROWN_POINTS = Limit("crown_points", 5_000, "points", "the profile of a roller")
TABLE_FILE = Limit("table_file", 4_000_000_000, "bytes", "a measured table")
TABLE_ROWS = Limit("table_rows", 5_000_000, "rows", "a measured table")
TABLE_LINE = Limit("table_line", 1_000_000, "characters", "one line of a measured table")
TABLE_COLUMNS = Limit("table_columns", 2_000, "columns", "a measured table")
TABLE_BYTES = Limit("table_bytes", 2_000_000_000, "bytes", "the columns of a Parquet table that are read")
WORKBOOK_BYTES = Limit("workbook_bytes", 250_000_000, "bytes", "a workbook, unpacked")
VIBRATION_FILE = Limit("vibration_file", 1_000_000_000, "bytes", "a vibration record")
VIBRATION_SAMPLES = Limit("vibration_samples", 50_000_000, "numbers", "all channels of a vibration record")
VIBRATION_TEXT = Limit("vibration_text", 10_000_000, "numbers or lines", "a vibration record in text")
VIBRATION_PARTS = Limit("vibration_parts", 5_000, "parts", "the columns, variables, cells, fields and data sets of a vibration record")
VIBRATION_ANALYSED = Limit("vibration_analysed", 3_000_000, "samples", "the part of a vibration record that is analysed at once")
BEARINGS_ROWS = Limit("bearings_rows", 10_000, "rows", "a table of bearings")
POINTS_FILE = Limit("points_file", 1_000_000, "bytes", "a table of operating points")
POINTS_ROWS = Limit("points_rows", 10_000, "points", "a table of operating points")
RESULT_TEXT = Limit("result_text", 64_000_000, "bytes", "a table of results as CSV")
RESULT_ROWS = Limit("result_rows", 200_000, "rows", "a table of results")
RESULT_CELLS = Limit("result_cells", 5_000_000, "cells", "a table of results")
STATE_FILE = Limit("state_file", 4_000_000, "bytes", "a stored state, which has some 50 kB")
RESPONSE_FILE = Limit("response_file", 64_000_000, "bytes", "the kept response of a bearing, packed and unpacked")
KEPT_TABLE_FILE = Limit("kept_table_file", 256_000_000, "bytes", "the kept table of a bearing, packed and unpacked")
COMPILED_FILE = Limit("compiled_file", 64_000_000, "bytes", "the machine code of a function")
HISTORY_FILE = Limit("history_file", 64_000_000, "bytes", "the history of days of a stored state")
JSON_FILE = Limit("json_file", 64_000_000, "bytes", "the description or a figure of a study")
RECORDING_RECORD = Limit("recording_record", 128_000_000, "bytes", "one record of a recording, compressed or not")
RECORDING_EXPANSION = Limit("recording_expansion", 100, "times its size", "what a compressed recording unpacks to, beyond its first 64 MB")
RECORDING_TEXTS = Limit("recording_texts", 64_000_000, "bytes", "topics, message definitions and metadata of a recording")
BAG_METADATA = Limit("bag_metadata", 2_000_000, "bytes", "the metadata.yaml of a bag")
DEFINITION = Limit("definition", 2_000_000, "bytes", "the definition of a message type")
DEFINITION_FIELDS = Limit("definition_fields", 10_000, "fields", "the definition of a message type")
DEFINITION_DEPTH = Limit("definition_depth", 32, "levels", "messages within messages")
MESSAGE_ITEMS = Limit("message_items", 1_000_000, "texts, arrays and messages", "what one message contains")
LOG_MESSAGES = Limit("log_messages", 10_000_000, "messages", "one channel of an input log")
VIEW_NUMBERS = Limit("view_numbers", 50_000_000, "numbers", "the view of a bag from another source")
VIEW_LINES = Limit("view_lines", 2_000, "lines", "the view of a bag from another source")
VIEW_EVENTS = Limit("view_events", 100_000, "events", "the view of a bag from another source")

LIMITS = tuple(each for each in tuple(globals().values()) if isinstance(each, Limit))
"""All limits, in the order in which the documentation lists them."""


@lru_cache(maxsize=4)
def _raised(text: str) -> dict[str, int]:
    """Return the values that the environment variable sets, by name."""
    values, known = {}, {limit.name for limit in LIMITS}
    for entry in filter(None, (part.strip() for part in text.split(","))):
        name, _, number = (part.strip() for part in entry.partition("="))
        if name not in known:
            raise LimitError(f"{VARIABLE}: {name!r} is no limit; expected NAME=NUMBER with one of {', '.join(sorted(known))}")
        try:
            value = float(number)
        except ValueError:
            value = 0.0
        if not 1.0 <= value < _LARGEST:
            raise LimitError(f"{VARIABLE}: {name}={number}: expected a number of at least 1 and below 2^63, such as 16e6")
        values[name] = int(value)
    return values
