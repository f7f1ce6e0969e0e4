# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a synthetic vibration record holds of its comb when everything but noise is known: band, shaft speed and ratio of cage to shaft.

    python test/benchmarks/vibration_bounds.py --speed 30000 --noise -20

For each record of a row of ``vibration_study.py --runs 3 --seed 11`` it prints the logarithm of how improbable the envelope's lines at
their true places are in noise, the best of three bands about the resonance, of five resolutions and of one to three harmonics without and with
sidebands [nat]; how high the loudest line of the vibration itself stands over the noise within 20 Hz [dB]; and what was found without knowing
anything.  A search has to exclude all candidates, bands and resolutions besides, which costs about 14 nat, and one false alarm in 10,000
records, 9 nat.
"""

import argparse
import math

import numpy as np
from vibration_study import KINDS, Condition, Synthetic, _run

from bearing_sim.watchers.vibration.comb import _log_gamma_tail, families, spectra
from bearing_sim.watchers.vibration.order_tracking import constant_shaft
from bearing_sim.watchers.vibration.signal import Band, Spectrum

ROLLERS, SIZE = 13, 0.19
SPIN = (1.0 - SIZE**2) / SIZE
SHIFTS = np.linspace(-0.5, 0.5, 5)  # of the resolution of a spectrum


def surprise(synthetic: Synthetic, shows: str) -> float:
    """Return how improbable the lines of the envelope are in noise [nat]."""
    samples, rate = synthetic.vibration.samples, synthetic.vibration.rate
    spectrum = Spectrum(samples, rate, 0.05).without_lines()
    shaft = constant_shaft(synthetic.shaft_frequency, 0.0, synthetic.vibration.duration)
    family = next(each for each in families(ROLLERS) if each.name == shows)
    orders = family.orders(synthetic.ratio, SPIN)
    per_centre, best = 1 + 2 * len(family.sidebands), 0.0
    for lines in (1.0, 2.0, 4.0):
        width = lines * 2.2 * 8.0 * synthetic.shaft_frequency
        if width > rate / 2.0:
            break
        low = min(max(0.0, synthetic.resonance - width / 2.0), rate / 2.0 - width)
        envelope, slower = spectrum.envelope(Band(low, low + width))
        per_turn = min(70.0, slower / synthetic.shaft_frequency)
        signal = shaft.resampled(envelope - envelope.mean(), slower, per_turn)
        for averages in (1, 4, 16, 64, 256):
            found = spectra(signal, per_turn, averages, min(per_turn / 2.0, 30.0))
            if found is None:
                continue
            at = np.max([found.at(orders + shift * found.resolution) for shift in SHIFTS], axis=0)
            sets = [at[::per_centre][:count] for count in (1, 2, 3)] + [at[: count * per_centre] for count in (1, 2, 3)]
            best = max(best, *(-_log_gamma_tail(len(each), float(each.sum())) for each in sets))
    return best


def loudest(synthetic: Synthetic, shows: str) -> float:
    """Return how high the loudest multiple of the ball-pass frequency stands over the noise in the vibration itself, within 20 Hz [dB]."""
    samples, rate = synthetic.vibration.samples, synthetic.vibration.rate
    power, step = np.abs(np.fft.rfft(samples * np.hanning(len(samples)))) ** 2, rate / len(samples)
    turns = {"outer_ring": ROLLERS * synthetic.ratio, "inner_ring": ROLLERS * (1.0 - synthetic.ratio), "roller": SPIN}[shows]
    within, highest = int(10.0 / step), 0.0
    for frequency in np.arange(1, int(0.48 * rate / (turns * synthetic.shaft_frequency))) * turns * synthetic.shaft_frequency:
        if abs(frequency - synthetic.resonance) < 0.1 * synthetic.resonance:
            at = int(round(frequency / step))
            noise = np.median(power[max(0, at - 40 * within) : at + 40 * within]) / math.log(2.0)
            highest = max(highest, float(np.mean(power[at - within : at + within + 1]) / noise))
    return 10.0 * math.log10(max(highest, 1e-3))


def main() -> None:
    """Print the row of a speed and a noise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--speed", type=float, default=30_000.0, help="of the shaft [rpm]")
    parser.add_argument("--noise", type=float, default=-20.0, help="impacts over noise [dB]")
    arguments = parser.parse_args()
    for shows in KINDS:
        for number in range(3):
            condition = Condition(shows, arguments.speed, 0.0, arguments.noise)
            words = (11, number, KINDS.index(shows), int(arguments.speed), 0, int(-arguments.noise))
            synthetic, found = _run(condition, np.random.default_rng(words))
            seen = found.shows if found.found else "no line"
            print(f"{shows:10} {surprise(synthetic, shows):6.1f} nat {loudest(synthetic, shows):6.1f} dB  {seen}", flush=True)


if __name__ == "__main__":
    main()
