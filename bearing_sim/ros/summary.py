# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What came of a run, read back from its recording."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.recording_reader import Recording


class Summary(NamedTuple):
    """Key figures of a recorded run, in SI but for life in hours."""

    seconds: float  # from the first sample to the last
    samples: int
    largest_speed: float  # [rad/s]
    slips: tuple[float, float, float]  # mean, 95 % quantile and largest, above a hundredth of the largest speed
    shortest_life: float  # [h] life at the worst condition, by the scene's choice
    damage: float
    warnings: dict[str, int]  # code of warnings and errors -> how often told
    lost: float  # [s] time that the solver did not hold
    solver_factors: tuple[float, float]  # least and median of simulated over solver seconds

    def table(self) -> str:
        """Return the figures as a table of text."""
        told = ", ".join(f"{code} ({count})" for code, count in self.warnings.items()) or "none"
        (mean, mostly, most), (least, median) = self.slips, self.solver_factors
        rows = [
            ("recorded", f"{self.seconds:.1f} s, {self.samples} samples"),
            ("largest shaft speed", f"{self.largest_speed * 30 / math.pi:.0f} rpm"),
            ("cage slip while turning", f"mean {100 * mean:.2f} %, 95 % of the time below {100 * mostly:.2f} %, largest {100 * most:.2f} %"),
            ("life at the worst condition", f"{self.shortest_life:.4g} h"),
            ("life used", f"{100 * self.damage:.3g} %"),
            ("real time", f"{self.lost:.2f} s lost; the solver alone: {median:.1f} times as fast (median), {least:.1f} times (least)"),
            ("warnings and errors (times told)", told),
        ]
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def summarize(path: Path) -> Summary:
    """Return the key figures of a recording of ours.

    Raises
    ------
    RecordingError
        The file is none.
    """
    recording = Recording(path)
    slips, speeds, lives, damages, told = [], [], [], [], {}
    for item in recording:
        if isinstance(item, Event):
            if item.level > Level.OK and item.code != "condition":
                told[item.code] = told.get(item.code, 0) + 1
            continue
        slips.append(item["cage_slip"])
        speeds.append(item["shaft_speed"])
        lives.append(item["modified_rating_life"])
        damages.append(item["damage"])
    reports = _numbers(path)
    factors = [report["real-time factor possible"] for report in reports if math.isfinite(report.get("real-time factor possible", math.nan))]
    slip = np.concatenate(slips)
    speed = np.abs(np.concatenate(speeds))
    turning = slip[np.isfinite(slip) & (speed > 0.01 * speed.max())]
    return Summary(
        seconds=recording.duration,
        samples=recording.samples,
        largest_speed=float(speed.max()),
        slips=(float(turning.mean()), float(np.quantile(turning, 0.95)), float(turning.max())) if turning.size else (math.nan,) * 3,
        shortest_life=float(np.concatenate(lives).min()),
        damage=float(np.concatenate(damages).max()),
        warnings=told,
        lost=reports[-1].get("time lost [s]", math.nan) if reports else math.nan,
        solver_factors=(min(factors), float(np.median(factors))) if factors else (math.nan, math.nan),
    )


def _numbers(path: Path) -> list[dict[str, float]]:
    """Return the numbers of every diagnostics report of the node in a finished recording."""
    reports = []
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, _, _, report in reader.iter_decoded_messages([f"/{topics.DIAGNOSTICS[0]}"]):
            if report.status[0].values:
                reports.append({pair.key: float(pair.value) for pair in report.status[0].values if _is_number(pair.value)})
    return reports


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
