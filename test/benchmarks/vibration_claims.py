# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What `bearing-sim vibration` claims where something else vibrates, and where a bearing does beside it; made-up records whose truth is known.

    python test/benchmarks/vibration_claims.py --records 2000 --jobs 2 --out claims.json

Half of the records hold no line of the bearing, but trains of other machines, of gears and of the mains, gear meshes with sidebands, random knocks,
resonances under noise and harmonics of the shaft; the others hold one beside them.  Instants of impacts scatter by 0 to 2 % of their period, each
for itself or one after another (a walk), for the bearing and for everything else.  Impacts stand between samples or at whole ones.

It prints how many records of each kind end in a claim, in "cannot be told apart" and in nothing; of the true lines also the right part and how
often the truth is within two and three stated errors.
"""

import argparse
import json
import math
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

import numpy as np

FOREIGN = ("machine", "gear tooth", "gear mesh", "mains", "knocks", "resonance", "shaft")
PARTS = ("outer_ring", "inner_ring", "roller")
JITTERS = (0.0, 0.0, 0.002, 0.005, 0.01, 0.02)


class Record:
    """A made-up record: samples as they come together, and what they hold."""

    def __init__(self, number: int, has_line: bool):
        self.rng = rng = np.random.default_rng((7, number, has_line))
        self.rate = float(rng.choice([20e3, 25.6e3, 51.2e3]))
        self.rollers = int(rng.integers(8, 21))
        self.size = float(rng.uniform(0.6, 0.9) * math.sin(math.pi / self.rollers))
        self.is_measured = bool(rng.random() < 0.5)
        self.shaft = float(math.exp(rng.uniform(math.log(8.0), math.log(60.0))))  # [Hz]
        turns = float(rng.uniform(60.0, 200.0))
        self.duration = float(np.clip(turns / self.shaft, 2.0, 300_000 / self.rate))
        self.time = np.arange(int(self.duration * self.rate)) / self.rate
        self.has_shaft_lines = bool(rng.random() < 0.7)
        self.slip = float(rng.choice([rng.uniform(0.0, 0.01), rng.uniform(0.0, 0.09)]))
        self.ideal = 0.5 * (1.0 - self.size)
        self.spin = (1.0 - self.size**2) / self.size
        self.samples = rng.standard_normal(len(self.time))
        self.jitter, self.walks = float(rng.choice(JITTERS)), bool(rng.random() < 0.3)
        self.part = str(rng.choice(PARTS)) if has_line else ""
        self.foreign: list[tuple[str, float, float]] = []  # kind, order of the fundamental, jitter
        if has_line:
            self._bearing()
        for kind in rng.choice(FOREIGN, size=int(rng.integers(1, 3)), replace=False):
            getattr(self, "_" + kind.replace(" ", "_"))()
        if self.has_shaft_lines:
            for order in (1, 2, 3):
                self.samples += rng.uniform(0.2, 1.0) / order * np.cos(2 * np.pi * (order * self.shaft * self.time + rng.random()))

    def _ringing(self) -> np.ndarray:
        frequency, damping = self.rng.uniform(0.1, 0.35) * self.rate, self.rng.uniform(0.02, 0.08)
        lasting = np.arange(int(8.0 / (2 * np.pi * damping * frequency) * self.rate) + 1) / self.rate
        return np.exp(-2 * np.pi * damping * frequency * lasting) * np.sin(2 * np.pi * frequency * lasting)

    def _train(self, frequency: float, jitter: float, walks: bool, strength=lambda at: np.ones(len(at)), height: float | None = None) -> None:
        rng = self.rng
        numbers = np.arange(int(self.duration * frequency) + 2)
        scatter = jitter * rng.standard_normal(len(numbers))
        scatter = np.cumsum(scatter) / 4.0 if walks else scatter
        at = (numbers + rng.random() + scatter) / frequency
        at = at[(at > 0.0) & (at < self.duration - 2.0 / self.rate)]
        places = at * self.rate
        if rng.random() < 0.5:
            places = np.floor(places)  # as many made-up records have it
        blows, low, strengths = np.zeros(len(self.time)), places.astype(int), strength(at)
        np.add.at(blows, low, strengths * (1.0 - (places - low)))
        np.add.at(blows, low + 1, strengths * (places - low))
        shape = self._ringing()
        made = np.fft.irfft(np.fft.rfft(blows, 2 * len(blows)) * np.fft.rfft(shape, 2 * len(blows)))[: len(blows)]
        level = height if height is not None else 10.0 ** (rng.uniform(-10.0, 5.0) / 20.0)
        self.samples += made / max(np.std(made), 1e-12) * level

    def _bearing(self) -> None:
        rng, shaft = self.rng, self.shaft
        ratio = self.ideal * (1.0 - self.slip)
        varied = rng.uniform(0.0, 0.3)

        def strength(load):
            return lambda at: load(at) * np.maximum(0.0, 1.0 + varied * rng.standard_normal(len(at)))

        if self.part == "outer_ring":
            load = strength(lambda at: 1.0 + 0.2 * np.cos(2 * np.pi * shaft * at))
            self.line = self.rollers * ratio
        elif self.part == "inner_ring":
            load = strength(lambda at: np.maximum(0.0, np.cos(2 * np.pi * shaft * at)) ** 1.5)
            self.line = self.rollers * (1.0 - ratio)
        else:
            load = strength(lambda at: np.maximum(0.0, np.cos(2 * np.pi * ratio * shaft * at)) ** 1.5)
            self.line = self.spin
        self.ratio = ratio
        self._train(self.line * shaft, self.jitter, self.walks, load)

    def _some_jitter(self) -> float:
        return float(self.rng.choice(JITTERS))

    def _machine(self) -> None:
        order, jitter = float(math.exp(self.rng.uniform(math.log(0.3), math.log(12.0)))), self._some_jitter()
        self.foreign.append(("machine", order, jitter))
        self._train(order * self.shaft, jitter, bool(self.rng.random() < 0.3))

    def _gear_tooth(self) -> None:
        order = float(self.rng.integers(9, 60) / self.rng.integers(9, 60))
        self.foreign.append(("gear tooth", order, 0.0))
        self._train(order * self.shaft, 0.0, False)

    def _gear_mesh(self) -> None:
        rng = self.rng
        order = float(rng.integers(9, 60) / rng.integers(9, 60)) if rng.random() < 0.5 else 1.0
        teeth = int(rng.integers(13, 60))
        self.foreign.append(("gear mesh", order, 0.0))
        angle = 2 * np.pi * order * self.shaft * self.time
        modulation = 1.0 + 0.6 * np.cos(angle + 6.28 * rng.random()) + 0.3 * np.cos(2 * angle + 6.28 * rng.random())
        for harmonic in (1, 2, 3):
            if harmonic * teeth * order * self.shaft < 0.45 * self.rate:
                self.samples += rng.uniform(0.3, 2.0) / harmonic * modulation * np.cos(harmonic * teeth * angle + 6.28 * rng.random())

    def _mains(self) -> None:
        mains = float(self.rng.choice([50.0, 60.0]))
        self.foreign.append(("mains", 2.0 * mains / self.shaft, 0.0))
        self._train(2.0 * mains, 0.0, False)
        for harmonic in range(1, 20):
            self.samples += 0.3 / harmonic * np.cos(2 * np.pi * mains * harmonic * self.time + 6.28 * self.rng.random())

    def _knocks(self) -> None:
        self.foreign.append(("knocks", math.nan, math.nan))
        count = int(self.rng.uniform(5.0, 200.0))
        for at in self.rng.integers(0, len(self.samples) - 1, count):
            shape = self._ringing()[: len(self.samples) - at]
            self.samples[at : at + len(shape)] += self.rng.exponential(5.0) * shape

    def _resonance(self) -> None:
        self.foreign.append(("resonance", math.nan, math.nan))
        for _ in range(2):
            noise = np.convolve(self.rng.standard_normal(len(self.samples)), self._ringing(), "same")
            self.samples += self.rng.uniform(0.5, 3.0) * noise / np.std(noise)

    def _shaft(self) -> None:
        self.foreign.append(("shaft", float(self.rng.choice([0.5, 1.0])), 0.0))
        order = self.foreign[-1][1]
        self._train(order * self.shaft, 0.0, False)
        for harmonic in range(1, 16):
            self.samples += 0.5 / harmonic * np.cos(2 * np.pi * harmonic * self.shaft * self.time + 6.28 * self.rng.random())


def judged(task: tuple[int, bool]) -> dict:
    """Return what is said of one record, beside its truth."""
    from bearing_sim.watchers.vibration.analysis import Geometry, analyse
    from bearing_sim.watchers.vibration.signal import Vibration, VibrationError

    record = Record(*task)
    geometry = Geometry(record.rollers, record.size, record.is_measured)
    given = 2 * np.pi * record.shaft * (1.0 + record.rng.uniform(-0.008, 0.008))
    begun = time.process_time()
    row = {
        "number": task[0],
        "part": record.part,
        "jitter": record.jitter,
        "walks": record.walks,
        "foreign": record.foreign,
        "slip": record.slip,
        "measured": record.is_measured,
        "rollers": record.rollers,
        "size": record.size,
        "turns": record.shaft * record.duration,
        "true_ratio": getattr(record, "ratio", math.nan),
        "line": getattr(record, "line", math.nan),
    }
    try:
        found = analyse(Vibration(record.samples, record.rate), geometry, given, 0.01)
    except VibrationError as error:  # refusals; other exceptions are defects and end the study
        return row | {"found": False, "is_claim": False, "reason": str(error), "seconds": time.process_time() - begun}
    return row | {
        "found": found.found,
        "is_claim": bool(getattr(found, "is_claim", found.found)),
        "shows": found.shows,
        "ratio": found.ratio,
        "ratio_error": found.ratio_error,
        "claims_slip": found.claims_slip,
        "found_slip": found.slip,
        "slip_error": found.slip_error,
        "order": found.line,
        "source": found.shaft.source,
        "alternatives": list(getattr(found, "alternatives", ())),
        "jitter_found": getattr(found, "jitter", math.nan),
        "reason": found.reason,
        "seconds": time.process_time() - begun,
    }


def bands_of(row: dict) -> dict[str, tuple[float, float]]:
    """Return the orders that each part's first line may have, with slip from 0 to 10 % and 3 % of another roller size where not measured."""
    ideal, spin = 0.5 * (1.0 - row["size"]), (1.0 - row["size"] ** 2) / row["size"]
    play = 0.002 if row["measured"] else 0.03
    low, high, z = ideal * (0.9 - play), ideal * (1.0 + play), row["rollers"]
    return {
        "outer_ring": (z * low, z * high),
        "inner_ring": (z * (1 - high), z * (1 - low)),
        "roller": (spin * 0.88, spin * 1.06),
        "cage": (low, high),
    }


def outside_all(row: dict) -> bool:
    """Return whether every foreign train is clearly outside of all bands."""
    margin = 4.0 / row["turns"]
    orders = [order for _, order, _ in row["foreign"] if math.isfinite(order)]
    return not any(low - margin <= order <= high + margin for order in orders for low, high in bands_of(row).values())


def printed(rows: list[dict]) -> None:
    """Print the tables."""
    without, with_line = [row for row in rows if not row["part"]], [row for row in rows if row["part"]]
    outside, inside = [row for row in without if outside_all(row)], [row for row in without if not outside_all(row)]
    for name, some in (("no line, trains outside all bands", outside), ("no line, a train inside a band", inside)):
        claims = [row for row in some if row["is_claim"]]
        apart = sum(row["found"] and not row["is_claim"] for row in some)
        slips = sum(row.get("claims_slip", False) for row in some)
        print(f"{name}: {len(some)} records, {len(claims)} claims, {apart} cannot be told apart, {slips} slips claimed")
        print("   claims by kind:", Counter(str([kind for kind, *_ in row["foreign"]]) for row in claims).most_common(8))
    for least, most in ((0.0, 0.001), (0.001, 0.003), (0.003, 0.03)):
        some = [row for row in with_line if least <= row["jitter"] < most]
        found, claims = [row for row in some if row["found"]], [row for row in some if row["is_claim"]]
        right, right_found = (sum(row["shows"] == row["part"] for row in each) for each in (claims, found))
        slips = [row for row in some if row.get("claims_slip")]
        within = np.array([abs(row["found_slip"] - row["slip"]) / row["slip_error"] for row in slips])
        ratios = np.array([abs(row["ratio"] - row["true_ratio"]) / row["ratio_error"] for row in claims])
        print(f"a line with jitter {least:g} to {most:g}: {len(some)} records, {len(found)} found ({right_found} right)")
        print(f"   {len(claims)} claims ({right} right), {np.mean(ratios < 2.0):.3f} of their ratios within 2 stated errors")
        print(f"   {len(slips)} slips claimed, {np.mean(within < 2.0):.3f} within 2 stated errors, {np.mean(within < 3.0):.3f} within 3")
    print(f"median {np.median([row['seconds'] for row in rows]):.2f} s of a core a record")


def main() -> None:
    """Judge records and print what was claimed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=200, help="of each half")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", help="file for all rows as JSON")
    arguments = parser.parse_args()
    tasks = [(number, has_line) for number in range(arguments.records) for has_line in (False, True)]
    with ProcessPoolExecutor(arguments.jobs) as pool:
        rows = list(pool.map(judged, tasks, chunksize=4))
    if arguments.out:
        with open(arguments.out, "w") as file:
            json.dump(rows, file)
    printed(rows)


if __name__ == "__main__":
    main()
