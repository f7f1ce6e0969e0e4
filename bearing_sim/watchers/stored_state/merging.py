# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fill gaps of a stored state by recordings of the bearing: what a kill took, or what ran while nothing was stored."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.recording.reader import Recording
from bearing_sim.watchers.stored_state.keeper import RECORD, StateKeeper
from bearing_sim.watchers.stored_state.state_file import StateError, parsed

_SKIPPED = 1.5  # spacings of samples after which time was skipped by the recorded run


class Filled(NamedTuple):
    """What a recording has added to a state.

    Attributes
    ----------
    recorded, added : time that the recording holds, and how much of it was not in the state [s].
    damage : fraction of life used that was added.
    """

    recorded: float
    added: float
    damage: float


def merge(path: Path, recording: Recording) -> Filled:
    """Add the running that a recording holds to the state in a file, without the times that the state contains already.

    Parameters
    ----------
    path : of the state file.
    recording : of the same bearing.

    Raises
    ------
    StateError
        The state is another bearing's, in use, or not good, or it cannot be written.
    """
    keeper = StateKeeper(path, recording.scene, _serial(recording), once=True, fills=True)
    try:
        state = keeper.state
        before, damage, was_turning = state.totals.monitored_seconds, state.totals.damage, state.is_turning
        state.is_turning = True  # whether the shaft turned before a gap is not known: a start is counted only where it is recorded
        recorded, state = _count(keeper, recording), keeper.state
        state.is_turning = was_turning
        filled = Filled(recorded, state.totals.monitored_seconds - before, state.totals.damage - damage)
    except BaseException:
        keeper.abandon()
        raise
    if not keeper.leave():
        raise StateError(f"the state file {keeper.path} cannot be written; nothing was added")
    return filled


def _serial(recording: Recording) -> str:
    """Return the serial number that a recording names; ``""`` if it names none."""
    record = recording.records.get(RECORD)
    try:
        return "" if record is None else parsed(record["state"].encode()).serial
    except (KeyError, ValueError) as error:
        raise StateError(f"{recording.path}: the state that the recording began with cannot be read: {error}") from None


def _count(keeper: StateKeeper, recording: Recording) -> float:
    """Count the samples of a recording and return the time that they stand for [s]."""
    interval = recording.duration / max(recording.samples - 1, 1)
    last, first, recorded = None, None, 0.0
    for block in recording:
        if not isinstance(block, np.ndarray):
            continue
        steps = np.diff(block["time"], prepend=block["time"][0] if last is None else last["time"])
        interval = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else interval
        seconds = np.where(steps > _SKIPPED * interval, interval, np.maximum(steps, 0.0))
        falls = np.diff(block["damage"], prepend=block["damage"][0] if last is None else last["damage"]) < 0.0
        last = block[-1].copy()
        recorded += float(seconds.sum())
        starts = np.flatnonzero(falls).tolist()
        first = float(block["damage"][0]) if first is None else first  # of the life before, or of the run so far
        for begin, end in zip([0, *starts], [*starts, len(block)]):
            if begin in starts:  # the recorded run was reset there
                keeper.restart()
                first = float(block["damage"][begin])
            part = block[begin:end].copy()
            part["damage"] -= first
            if len(part):
                keeper.count(part, recording.start_ns, seconds[begin:end])
    return recorded
