# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tasks for tests of the executor: they count how often they were computed, in a file that all processes append to."""

import os
import sys
import time
from pathlib import Path

from bearing_sim.sweep.tasks import Journal, run_tasks, task


def noted(path, number, pause=0.0):
    """Take a while, note the number down, and return its square."""
    time.sleep(pause)
    with open(path, "a") as file:  # a short line is appended whole, whoever else appends
        file.write(f"{number}\n")
    return {"square": number * number, "process": os.getpid()}


def deadly(path, number):
    """Note the number down and, where it is 3, take the process along."""
    noted(path, number)
    if number == 3:
        os._exit(9)
    return {"square": number * number}


def tasks(path, count, pause=0.0, function=noted):
    """Return so many tasks."""
    rest = (pause,) if function is noted else ()
    return [task("noted", function, str(path), number, *rest) for number in range(count)]


if __name__ == "__main__":  # a run that a test kills
    folder, count = Path(sys.argv[1]), int(sys.argv[2])
    with Journal(folder / "kept.journal") as journal:
        run_tasks(tasks(folder / "notes", count, 0.05), journal, workers=2)
