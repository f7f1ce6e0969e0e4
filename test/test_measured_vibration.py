# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A loaded bearing of 25 mm bore at 600 to 1000 rpm does not slip grossly: neither the model nor recorded vibration shows it.

The recordings (Li, Ping, Wang, Chen and Cao, Sensors 13, 2013) say neither rollers nor load, so that nothing is fitted to them: a cut in the outer
raceway rings Z times in a turn of the cage, and the shaft's own line stands in the same spectrum.
"""

import numpy as np
import pytest
import scipy.signal
from support import measured_file

from bearing_sim import settle
from bearing_sim.scene.loader import scene_from_mapping

NO_GROSS_SLIP = 0.02


@pytest.mark.parametrize("speed", [600, 1000])
@pytest.mark.parametrize("load", [150, 1000])
def test_the_model_of_a_bearing_of_25_mm_bore_does_not_slip_from_its_makers_minimum_load_on(speed, load):
    scene = scene_from_mapping(
        {
            "name": "rig",
            "bearing": "NU 205",
            "lubricant": {"oil": "ISO VG 32", "supply": "oil_bath", "temperature": "40 degC"},
            "operating": {"shaft_speed": f"{speed} rpm", "radial_load": f"{load} N"},
        }
    )
    assert abs(settle(scene).cage_slip) < NO_GROSS_SLIP


def lines(name):
    """Return the envelope spectrum of a recording: frequencies over the nominal shaft speed, and amplitudes."""
    recording = np.load(measured_file(f"jnu_roller_bearing/{name}.npz"))
    rate, signal = float(recording["fs_hz"]), recording["counts"] * float(recording["scale"])
    band = scipy.signal.butter(4, [6000.0, 12000.0], "bandpass", fs=rate, output="sos")
    envelope = np.abs(scipy.signal.hilbert(scipy.signal.sosfiltfilt(band, signal)))
    nominal = int("".join(letter for letter in name.split("_")[0] if letter.isdigit())) / 60.0
    padded = 4 * len(envelope)
    spectrum = np.abs(np.fft.rfft((envelope - envelope.mean()) * np.hanning(len(envelope)), padded))
    return np.fft.rfftfreq(padded, 1.0 / rate) / nominal, spectrum


def line_near(frequencies, spectrum, low, high):
    within = (frequencies > low) & (frequencies < high)
    return frequencies[within][np.argmax(spectrum[within])]


def test_the_cage_of_the_recorded_bearing_turns_by_the_same_share_of_the_shaft_at_600_and_at_1000_rpm():
    # The line of the outer raceway is Z cage turns; by Z it cancels in the comparison.
    shares = []
    for name in ("ob600_2", "ob1000_2"):
        frequencies, spectrum = lines(name)
        shaft = line_near(frequencies, spectrum, 1.9, 2.1) / 2.0
        shares.append(line_near(frequencies, spectrum, 4.6, 6.2) / shaft)
    assert abs(shares[1] / shares[0] - 1.0) < NO_GROSS_SLIP
