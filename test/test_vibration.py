# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage speed out of vibration: against synthetic records whose truth is known, recorded ones, and closed forms; every format of files.

The errors over speeds, noise and ramps, and false lines in thousands of records, are computed by
``benchmarks/vibration_study.py`` and ``benchmarks/vibration_claims.py``.
"""

import dataclasses
import math
import re
import sys
import zipfile
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
import scipy.io.wavfile
import scipy.signal
import scipy.sparse
from click.testing import CliRunner
from synthetic_vibration import Machine, _turns, record

from bearing_sim.cli.main import main
from bearing_sim.files.limits import VARIABLE, FileError
from bearing_sim.recording.writer import McapFile
from bearing_sim.watchers.vibration.analysis import Geometry, analyse
from bearing_sim.watchers.vibration.comb import families, spectra
from bearing_sim.watchers.vibration.order_tracking import constant_shaft, find_shaft, recorded_shaft
from bearing_sim.watchers.vibration.phase import Track, follow, mean_rate, smoothed
from bearing_sim.watchers.vibration.reading import read_vibration
from bearing_sim.watchers.vibration.regularity import _judged
from bearing_sim.watchers.vibration.signal import Band, Spectrum, Vibration, VibrationError, repetition

ROLLERS, SIZE, RATE = 13, 0.19, 25_600.0
SPEED = 3000.0 * math.pi / 30.0


def made(shows, seed=1, slip=0.08, **changes):
    machine = Machine(shows, ROLLERS, SIZE, slip, SPEED, **{"interfering": 0, **changes})
    return record(machine, RATE, 2.0, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def outer():
    synthetic = made("outer_ring", interfering=2)
    return synthetic, analyse(synthetic.vibration, Geometry(ROLLERS, SIZE), 1.005 * SPEED)


def test_a_damaged_outer_ring_beside_two_machines_gives_the_cage_speed_within_its_error(outer):
    synthetic, found = outer
    assert found.found and found.shows == "outer_ring"
    assert abs(found.ratio - synthetic.ratio) < 3.0 * found.ratio_error < 0.01
    assert found.cage_speed == pytest.approx(found.ratio * 2.0 * math.pi * found.shaft.frequency)
    assert abs(found.shaft.frequency / synthetic.shaft_frequency - 1.0) < 1e-3 and found.shaft.source == "lines"
    assert len(found.parts) == 4 and all(abs(part.ratio - synthetic.ratio) < 5.0 * part.ratio_error for part in found.parts)


@pytest.mark.parametrize("shows", ["inner_ring", "roller"])
def test_a_damaged_inner_ring_or_roller_is_told_from_an_outer_ring(shows):
    synthetic = made(shows)
    found = analyse(synthetic.vibration, Geometry(ROLLERS, SIZE), 1.005 * SPEED)
    assert found.shows == shows and abs(found.ratio - synthetic.ratio) < 3.0 * found.ratio_error


def test_a_line_is_followed_through_a_ramp_of_the_recorded_speed():
    synthetic = made("outer_ring", ramp=0.2)
    course = SPEED * (1.0 + 0.2 * (np.arange(len(synthetic.vibration.samples)) / len(synthetic.vibration.samples) - 0.5))
    recorded = dataclasses.replace(synthetic.vibration, shaft_speed=1.002 * course)
    found = analyse(recorded, Geometry(ROLLERS, SIZE), tolerance=0.005)
    assert found.shows == "outer_ring" and abs(found.ratio - synthetic.ratio) < 3.0 * found.ratio_error < 0.01
    constant = analyse(synthetic.vibration, Geometry(ROLLERS, SIZE), SPEED, follows_lines=False)
    assert not constant.found or abs(constant.ratio - synthetic.ratio) < 3.0 * constant.ratio_error


@pytest.mark.parametrize("seed", range(6))
def test_noise_and_healthy_machines_have_no_line(seed):
    synthetic = made("", seed, interfering=2 * (seed % 2), shaft_lines=0.3 * (seed % 2))
    found = analyse(synthetic.vibration, Geometry(ROLLERS, math.nan if seed % 3 else SIZE), SPEED)
    assert not found.found and found.reason.startswith("no line of this bearing") and math.isnan(found.cage_speed) and not found.claims_slip


@pytest.mark.parametrize("blocks", [2, 2.5, 15, 40])
@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_a_record_that_repeats_itself_is_said_to_and_has_no_line(blocks, noise):
    rng, count = np.random.default_rng(7), int(2.0 * RATE)
    block = rng.normal(size=int(count / blocks))
    samples = np.tile(block, 41)[:count] + noise * rng.normal(size=count)
    found = analyse(Vibration(samples, RATE), Geometry(ROLLERS), SPEED)
    assert not found.found and f"repeats itself every {len(block) / RATE:.6g} s" in found.reason and math.isnan(found.ratio)


def test_a_loop_that_was_sampled_again_repeats_itself_and_machines_do_not():
    rng = np.random.default_rng(8)
    loop = scipy.signal.resample_poly(np.tile(rng.normal(size=4001), 12), 147, 160)  # 3675.92 samples
    assert repetition(loop, RATE, 0.02) == pytest.approx(3676 / RATE)
    for shows in ("outer_ring", "inner_ring", "roller"):
        regular = made(shows, signal_to_noise=20.0, pocket_play=0.0, wandering=0.0, interfering=2)
        assert repetition(regular.vibration.samples, RATE, 0.02) is None
    turns = np.tile(rng.normal(size=512), 100)  # of a shaft, each like the one before
    assert repetition(turns, RATE, 0.02) is None


def test_a_result_depends_neither_on_the_unit_nor_on_the_sense_of_the_vibration_or_of_the_shaft(outer):
    synthetic, found = outer
    other = dataclasses.replace(synthetic.vibration, samples=-9.81e6 * synthetic.vibration.samples + 3.0)
    again = analyse(other, Geometry(ROLLERS, SIZE), -1.005 * SPEED)
    assert again.ratio == pytest.approx(found.ratio, rel=1e-9) and again.shows == found.shows


def test_the_lines_of_both_raceways_add_up_to_the_rollers_whatever_the_cage_does():
    by_name = {family.name: family for family in families(ROLLERS)}
    for ratio in (0.2, 0.38, 0.45):
        outer_line, inner_line = (by_name[name].orders(ratio)[0] for name in ("outer_ring", "inner_ring"))
        assert outer_line + inner_line == pytest.approx(ROLLERS) and outer_line == pytest.approx(ROLLERS * ratio)


def test_what_modulates_the_impacts_of_a_ring_or_roller_gives_sidebands_up_to_the_second():
    by_name, ratio, passes = {family.name: family for family in families(ROLLERS)}, 0.4, 5.2
    for name, line, modulation in (("inner_ring", ROLLERS * (1.0 - ratio), 1.0), ("roller", passes, ratio)):
        orders = by_name[name].orders(ratio, passes)
        for shift in (-2, -1, 0, 1, 2):
            assert np.min(np.abs(orders - line - shift * modulation)) < 1e-9, (name, shift)


def test_slip_that_another_size_of_the_rollers_explains_is_claimed_only_with_measured_diameters(outer):
    synthetic, found = outer
    assert found.claims_slip and abs(found.slip - (1.0 - synthetic.ratio / Geometry(ROLLERS, SIZE).ideal_ratio)) < 3.0 * found.slip_error
    near = Geometry(ROLLERS, 1.0 - 2.0 * synthetic.ratio / (1.0 - 0.01))  # a bearing whose drawing makes 1 % of slip of the same record
    unsure, sure = (analyse(synthetic.vibration, near._replace(is_measured=is_measured), SPEED) for is_measured in (False, True))
    assert unsure.is_claim and abs(unsure.slip) < 0.02 and not unsure.claims_slip and "measure the diameters" in unsure.reason
    assert sure.claims_slip and abs(sure.slip - 0.01) < 3.0 * sure.slip_error
    faster = analyse(synthetic.vibration, Geometry(ROLLERS, 1.0 - 2.0 * synthetic.ratio / 1.02), SPEED)  # a cage faster than its rollers
    assert faster.slip < 0.0 and not faster.claims_slip and "no cage reaches" in faster.reason


def exact_train(order, jitter=0.0, seconds=4.0, shaft_line=0.5, rounded=False, seed=1, second=None):
    """Return a record with a train of impacts at a multiple of the shaft's frequency, and perhaps another one: nothing of it by the package."""
    rng, time = np.random.default_rng(seed), np.arange(int(seconds * RATE)) / RATE
    samples = 0.5 * rng.normal(size=len(time)) + shaft_line * np.cos(SPEED * time)
    ringing = np.exp(-np.arange(200) / 30.0) * np.sin(2.0 * math.pi * 0.17 * np.arange(200))
    for each in (order, second) if second else (order,):
        period = 2.0 * math.pi / (SPEED * each)
        at = (
            (np.arange(1, int(seconds / period) - 2) + (jitter if each == order else 0.0) * rng.normal(size=int(seconds / period) - 3))
            * period
            * RATE
        )
        for place in np.floor(at) if rounded else at:
            low, part = int(place), place - int(place)
            samples[low : low + 200] += 2.0 * (1.0 - part) * ringing[: len(samples) - low]
            samples[low + 1 : low + 201] += 2.0 * part * ringing[: len(samples) - low - 1]
    return Vibration(samples, RATE)


def named_frequency(text):
    return float(re.search(r"([0-9.]+) Hz", text)[1])


RATIO = Geometry(ROLLERS, SIZE).ideal_ratio
MEASURED = Geometry(ROLLERS, SIZE, is_measured=True)


@pytest.mark.parametrize("order", [ROLLERS * RATIO * 0.97, ROLLERS * (1.0 - RATIO * 0.97)])
def test_an_exactly_periodic_train_where_a_ring_has_its_line_is_no_claim_and_its_frequency_is_named(order):
    found = analyse(exact_train(order, rounded=True), MEASURED, SPEED)
    assert not found.is_claim and not found.claims_slip and found.doubt == 1.0
    if found.found:
        assert found.shows == ("outer_ring" if order < 0.5 * ROLLERS else "inner_ring")
        (train,) = (each for each in found.alternatives if "exactly periodic" in each)
        assert named_frequency(train) == pytest.approx(order * SPEED / (2.0 * math.pi), rel=1e-3) and "cannot be told apart from" in found.reason
    assert not analyse(exact_train(order), MEASURED, SPEED).is_claim


@pytest.mark.parametrize(("jitter", "is_claim"), [(0.0, False), (0.005, True)])
def test_of_two_trains_at_the_line_of_a_ring_only_the_one_that_scatters_is_a_claim(jitter, is_claim):
    rng, rate, shaft = np.random.default_rng(1), 51_200.0, 25.0
    samples, line = 0.2 * rng.normal(size=int(4.0 * rate)), 13 * 0.4026 * shaft
    shape = 3.0 * np.exp(-np.arange(400) / 60.0) * np.sin(2.0 * math.pi * 6000.0 * np.arange(400) / rate)
    numbers = np.arange(1, int(3.95 * line))
    for place in ((numbers + jitter * rng.normal(size=len(numbers))) / line * rate).astype(int):
        samples[place : place + 400] += shape
    found = analyse(Vibration(samples, rate), Geometry(13, 0.1923), 2.0 * math.pi * shaft)
    assert found.found and found.shows == "outer_ring" and found.is_claim == is_claim, found.reason
    assert is_claim or "exactly periodic" in found.alternatives[0] and named_frequency(found.alternatives[0]) == pytest.approx(line, rel=1e-3)


@pytest.mark.parametrize("jitter", [0.01, 0.02])
def test_a_train_that_scatters_as_that_of_rollers_does_is_claimed_with_its_slip(jitter):
    found = analyse(exact_train(ROLLERS * RATIO * 0.97, jitter), MEASURED, SPEED)
    assert found.is_claim and found.shows == "outer_ring" and found.alternatives == () and found.doubt < 0.02
    assert found.claims_slip and abs(found.slip - 0.03) < 3.0 * found.slip_error < 0.006
    assert 0.4 * jitter < found.jitter < 1.5 * jitter, "large scatter is told from below: the carrier turns several times"


def test_slip_is_claimed_only_where_the_speed_of_the_shaft_is_measured():
    record_ = exact_train(ROLLERS * RATIO * 0.94, 0.01, shaft_line=0.0)
    given = analyse(record_, MEASURED, SPEED)
    assert given.is_claim and given.shaft.source == "given" and not given.claims_slip and "--speed-channel" in given.reason
    recorded = dataclasses.replace(record_, shaft_speed=np.full(len(record_.samples), SPEED))
    assert analyse(recorded, MEASURED, tolerance=0.001).claims_slip


@pytest.mark.parametrize("rollers", [ROLLERS, 14, 16])
@pytest.mark.parametrize("part", [2, 3])
def test_harmonics_of_a_slower_train_are_no_lines_of_a_bearing_however_much_it_scatters(part, rollers):
    geometry = Geometry(rollers, SIZE, is_measured=True)
    order = rollers * geometry.ideal_ratio * 0.95 / part
    found = analyse(exact_train(order, 0.005), geometry, SPEED)
    assert not found.found and named_frequency(found.reason) == pytest.approx(order * SPEED / (2.0 * math.pi), rel=3e-3), found.reason


def test_a_train_outside_of_the_slip_that_is_possible_is_no_line_of_the_bearing_and_inside_a_wider_one_is():
    record_ = exact_train(ROLLERS * RATIO * 0.75, 0.01)
    found = analyse(record_, MEASURED, SPEED)
    assert not found.found and "with no relation to this bearing" in found.reason
    skids = analyse(record_, MEASURED._replace(largest_slip=0.4), SPEED)
    assert skids.found and skids.shows == "outer_ring" and abs(skids.slip - 0.25) < 3.0 * skids.slip_error


def test_a_ring_is_found_beside_a_train_of_something_else():
    found = analyse(exact_train(ROLLERS * RATIO * 0.97, 0.008, second=0.8713), MEASURED, SPEED)
    assert found.is_claim and found.shows == "outer_ring" and abs(found.slip - 0.03) < 3.0 * found.slip_error


def test_the_scatter_of_impacts_follows_from_their_carrier_whatever_their_strengths():
    rng, period, frequency, count = np.random.default_rng(2), 0.01, 2.0 * math.pi * 3000.0, 2000
    for scatter in (0.0, 0.001, 0.002, 0.005):
        strengths = 1.0 + 0.8 * np.cos(np.arange(count) / 3.0)
        amplitudes = strengths * np.exp(-1j * frequency * scatter * period * rng.normal(size=count))
        noise = 0.3 * (rng.normal(size=count) + 1j * rng.normal(size=count))
        found = _judged(amplitudes + noise, 0.18, frequency, period, False, True)
        assert abs(found.jitter - scatter) < 0.0005 and found.is_irregular == (scatter > 0.002), "the last is certain, others may be feigned"


def test_the_rate_of_a_phase_has_an_error_that_holds_for_noise_and_for_random_walks():
    rng, places, slope = np.random.default_rng(5), np.arange(24.0), 0.01
    for walk, noise in ((0.0, 0.05), (0.05, 0.0), (0.03, 0.03)):
        scaled = []
        for _ in range(120):
            phases = slope * places + np.cumsum(walk * rng.normal(size=24)) + noise * rng.normal(size=24)
            rate = mean_rate(Track(places, phases, 1.0))
            scaled.append((rate.value - slope) / rate.standard_error)
        # The lower bound is wide on purpose: 24 segments cannot exclude a slow walk, so that the error of pure noise is stated twice too large.
        assert 0.3 < np.std(scaled) < 1.35 and abs(np.mean(scaled)) < 0.35


def test_a_smoothed_phase_errs_as_it_states_and_leaves_out_what_went_astray():
    rng, places = np.random.default_rng(9), np.arange(24.0)
    for bend in (0.0, 0.2):
        course, scaled = bend * np.sin(places / 5.0), []
        for _ in range(20):
            phases = course + 0.02 * rng.normal(size=24)
            phases[17] += 1.0
            smooth = smoothed(Track(places, phases, 1.0))
            scaled.append(np.sqrt(np.mean((smooth.phases - course) ** 2)) / smooth.error)
        assert 0.6 < np.mean(scaled) < 1.35


def test_phases_stand_in_the_middles_of_their_segments():
    track = follow(np.cos(0.8 * np.pi * np.arange(6400) / 64), 64, np.array([0.4]), np.array([1.0]), np.ones(1), 9)
    assert np.allclose(track.places, np.arange(1, 10) * 10.0, atol=0.1), "nine segments of 20 turns, half overlapping, in 100 turns"


def test_a_ramp_of_a_synthetic_shaft_is_linear_and_about_its_mean_speed():
    time = np.linspace(0.0, 2.0, 4001)
    speeds = np.diff(_turns(time, 50.0, 0.1)) / np.diff(time)
    assert np.allclose(speeds, np.linspace(47.5, 52.5, 4000), rtol=1e-4)


def test_a_rate_from_which_a_bearing_can_be_seen_is_named_and_enough():
    samples, geometry = np.random.default_rng(2).normal(size=4096), Geometry(ROLLERS)
    with pytest.raises(VibrationError, match="too slow") as refusal:
        analyse(Vibration(samples, 1000.0), geometry, SPEED)
    enough = float(re.search(r"at least ([\d.]+) Hz", str(refusal.value))[1])
    with pytest.raises(VibrationError, match="too slow"):
        analyse(Vibration(samples, 0.999 * enough), geometry, SPEED)
    assert not analyse(Vibration(samples, 1.001 * enough), geometry, SPEED).found


def test_the_phase_of_a_line_is_followed_through_noise():
    per_turn, turns, rng = 64, 400, np.random.default_rng(3)
    at = np.arange(per_turn * turns) / per_turn
    drift = 1e-3 * at + 0.05 * np.sin(2.0 * math.pi * at / turns)
    signal = sum(np.cos(2.0 * math.pi * k * (5.4 * at + drift)) for k in (1, 2)) + rng.normal(size=len(at))
    orders = np.array([5.4, 10.8])
    noise = spectra(signal, per_turn, 1, 30.0).noise_at(orders)
    track = follow(signal, per_turn, orders, np.array([1.0, 2.0]), noise, 40)
    wanted = np.interp(track.places, at, drift)
    assert np.std(track.phases - wanted) < 0.01


def test_noise_has_the_surprise_of_an_exponential_distribution_at_any_number_of_averages():
    signal = np.random.default_rng(8).normal(size=64 * 2000)
    for averages in (1, 16, 64):
        found = spectra(signal, 64, averages, 30.0, excludes_shaft=False)
        kept = found.surprise[int(1.0 / found.step) :: 4]
        assert np.mean(kept) == pytest.approx(1.0, abs=0.06)
        assert np.mean(kept > 5.0) == pytest.approx(math.exp(-5.0), abs=0.006)


def test_lines_are_cut_and_impulses_are_kept():
    time = np.arange(51_200) / 25_600.0
    rng = np.random.default_rng(2)
    noise = rng.normal(size=len(time))
    spectrum = Spectrum(noise + 30.0 * np.cos(2.0 * math.pi * 3123.4 * time), 25_600.0, 0.05).without_lines()
    plain = Spectrum(noise, 25_600.0, 0.05).without_lines()
    band = Band(3000.0, 3300.0)
    kept, uncut = (np.mean(each.envelope(band)[0] ** 2) / np.mean(plain.envelope(band)[0] ** 2) for each in (spectrum, plain))
    assert 0.6 < kept <= uncut == 1.0
    knocks = noise.copy()
    knocks[::256] += 30.0
    assert Spectrum(knocks, 25_600.0).kurtosis(Band(0.0, 12_800.0)) > 10.0 * abs(plain.kurtosis(Band(0.0, 12_800.0)))


def test_what_fills_many_bins_of_a_spectrum_is_no_discrete_line_and_is_kept():
    rng = np.random.default_rng(2)
    noise = rng.normal(size=51_200)
    lines = np.fft.rfft(noise)
    lines *= 1.0 + 19.0 * np.exp(-0.5 * ((np.arange(len(lines)) - 8020.0) / 20.0) ** 2)  # as wide as those of a cage that wanders at a high speed
    time = np.arange(51_200) / 25_600.0
    samples = np.fft.irfft(lines) + 30.0 * np.cos(2.0 * math.pi * 5123.4 * time)
    cut = Spectrum(samples, 25_600.0, 0.05).without_lines()._lines == 0.0
    assert not cut[7980:8060].any() and cut[10_244:10_250].all() and cut.mean() < 0.005


@pytest.mark.long
@pytest.mark.parametrize(("shows", "speed", "noise"), [("outer_ring", 30_000.0, -10.0), ("outer_ring", 3000.0, -20.0), ("inner_ring", 3000.0, 0.0)])
def test_a_ring_under_noise_at_high_speed_and_beside_lines_of_other_machines_is_found_within_its_error(shows, speed, noise):
    sys.path.insert(0, str(Path(__file__).with_name("benchmarks")))
    from vibration_study import Condition, errors_in

    row = errors_in(Condition(shows, speed, 0.0, noise), 1, 11)
    assert row.found == row.right == row.within == 1 and row.stated < 0.003


def test_a_line_of_another_machine_within_one_of_the_shafts_widens_the_error_of_its_speed():
    time, rng = np.arange(16_000) / 1600.0, np.random.default_rng(6)
    for order, shift in ((1.0, 0.0), (3.0, 0.005)):
        lines = sum(np.cos(2.0 * math.pi * 50.0 * each * time + each) / each for each in (1, 2, 3))
        other = np.cos(2.0 * math.pi * 50.0 * (order + shift) * time)
        signal = lines + other + 0.3 * rng.normal(size=len(time))
        found = find_shaft([(signal, 1600.0)], constant_shaft(50.3, 0.3, 10.0), 0.02)
        assert abs(found.frequency - 50.0) < 3.0 * found.standard_error, order
        assert (found.standard_error > 1e-4 * 50.0) == bool(shift)


def test_a_recorded_speed_gives_the_turns_of_its_integral():
    speed = 2.0 * math.pi * np.linspace(10.0, 14.0, 10_001)
    shaft = recorded_shaft(-speed, 1000.0, 0.01)
    assert shaft.frequency == pytest.approx(12.0) and shaft.turns[-1] == pytest.approx(120.0)
    chirp = np.cos(2.0 * math.pi * 3.0 * np.interp(np.arange(10_001) / 1000.0, shaft.times, shaft.turns))
    lines = np.abs(np.fft.rfft(np.hanning(7680) * shaft.resampled(chirp, 1000.0, 64)[:7680]))
    assert np.argmax(lines) == 360  # three orders in 120 turns


SAMPLES = np.round(np.random.default_rng(4).normal(size=2000), 6)
SPEEDS = np.linspace(100.0, 110.0, 2000)


def _write(path):
    """Write the samples in the format of a suffix, with a rate of 2 kHz in whatever way the format can say it."""
    times = np.arange(2000) / 2000.0
    suffix = path.suffix
    if suffix == ".csv":
        rows = [f"{t:.7f};{a:.6f};{s:.6f}".replace(".", ",") for t, a, s in zip(times, SAMPLES, SPEEDS)]
        path.write_text("\n".join(["# logger 7", "Time [s];acceleration [m/s^2];speed", *rows, ""]))
    elif suffix == ".txt":
        path.write_text("\n".join(["time\tacceleration\tspeed", *(f"{t}\t{a}\t{s}" for t, a, s in zip(times, SAMPLES, SPEEDS))]))
    elif suffix == ".parquet":
        pyarrow.parquet.write_table(pyarrow.table({"time": times, "acceleration": SAMPLES, "speed": SPEEDS, "note": ["x"] * 2000}), path)
    elif suffix == ".mat":
        scipy.io.savemat(path, {"acceleration": SAMPLES[:, None], "speed": SPEEDS, "fs": 2000.0, "title": "x"})
    elif suffix == ".npz":
        np.savez(path, acceleration=SAMPLES, speed=SPEEDS, fs_hz=2000.0)
    elif suffix == ".h5":
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            file["acceleration"], file["speed"] = SAMPLES, SPEEDS
            file["acceleration"].attrs["sampling_rate"] = 2000.0
    elif suffix == ".mcap":
        with McapFile(path) as recording:
            for number, (block, speeds) in enumerate(zip(SAMPLES.reshape(-1, 100), SPEEDS.reshape(-1, 100))):
                at = 1_700_000_000_000_000_000 + number * 50_000_000
                dimensions = [{"label": "samples", "size": 100, "stride": 100}, {"label": "rate", "size": 2000, "stride": 0}]
                for topic, values in (("/acceleration", block), ("/speed", speeds)):
                    recording.write(topic, "std_msgs/msg/Float64MultiArray", at, {"layout": {"dim": dimensions, "data_offset": 0}, "data": values})
    return path


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".parquet", ".mat", ".npz", ".h5", ".mcap"])
def test_every_format_gives_the_samples_their_rate_and_a_recorded_speed(suffix, tmp_path):
    prefix = "/" if suffix == ".mcap" else ""
    path = _write(tmp_path / f"record{suffix}")
    channel = "acceleration [m/s^2]" if suffix == ".csv" else f"{prefix}acceleration"
    found = read_vibration(path, channel, speed_channel=f"{prefix}speed", speed_unit="rpm")
    assert found.rate == pytest.approx(2000.0) and np.allclose(found.samples, SAMPLES, atol=1e-6)
    assert np.allclose(found.shaft_speed, SPEEDS * math.pi / 30.0, atol=1e-6)
    with pytest.raises(VibrationError, match="which channel|--channel"):
        read_vibration(path)


def test_of_a_recording_with_a_missing_block_the_longest_part_is_read_and_the_rest_is_counted_and_leads_to_the_exit_code(tmp_path):
    samples, path = exact_train(ROLLERS * RATIO * 0.97, 0.01, 2.0).samples, tmp_path / "gap.mcap"
    with McapFile(path) as recording:
        for number, block in enumerate(samples.reshape(-1, 1024)):
            if number == 7:
                continue
            dimensions = [{"label": "rate", "size": int(RATE), "stride": 0}, {"label": "sequence", "size": number, "stride": 0}]
            at = 1_700_000_000_000_000_000 + number * 40_000_000
            recording.write("/acceleration", "std_msgs/msg/Float64MultiArray", at, {"layout": {"dim": dimensions, "data_offset": 0}, "data": block})
    found = read_vibration(path)
    assert np.array_equal(found.samples, samples[8 * 1024 :]) and found.tally.counts.startswith("42 of 49 messages used (7 x behind a gap")
    result = called(path, "--rollers", ROLLERS, "--speed", "3000rpm", "--json")
    assert result.exit_code == 3 and "42 of 49" in result.stderr, result.output


def test_a_recorded_speed_has_as_many_values_as_the_vibration(tmp_path):
    np.savez(tmp_path / "r.npz", a=SAMPLES, speed=SPEEDS[:-1])
    with pytest.raises(VibrationError, match="speed has 1999 values and a 2000"):
        read_vibration(tmp_path / "r.npz", "a", 2000.0, speed_channel="speed")


def test_sounds_and_single_arrays_need_no_name(tmp_path):
    counts = np.round(1000.0 * SAMPLES).astype(np.int16)
    scipy.io.wavfile.write(tmp_path / "r.wav", 2000, counts)
    np.save(tmp_path / "r.npy", SAMPLES)
    (tmp_path / "r.dat").write_text("\n".join(map(str, SAMPLES)))
    scipy.io.savemat(tmp_path / "r.mat", {"run": {"y": np.stack((SAMPLES, SPEEDS), 1), "info": {"rate": 2000.0}}})
    wave = read_vibration(tmp_path / "r.wav")
    assert wave.rate == 2000.0 and np.array_equal(wave.samples, counts)
    for name, channel, rate in (("r.npy", None, 2000.0), ("r.dat", None, 2000.0), ("r.mat", "run.y[0]", None)):
        found = read_vibration(tmp_path / name, channel, rate)
        assert found.rate == 2000.0 and np.array_equal(found.samples, SAMPLES)


def _faulty(folder):
    """Write files that cannot be used; return by name what the message must say."""
    path = folder / "x.csv"
    good = [f"{value}" for value in SAMPLES]
    (folder / "empty.csv").write_text("")
    (folder / "words.csv").write_text("a,b\nc,d\n")
    (folder / "gap.csv").write_text("\n".join([*good[:50], "--", *good[50:]]))
    (folder / "nan.csv").write_text("\n".join([*good[:50], "nan", *good[50:]]))
    (folder / "ragged.csv").write_text("\n".join(["1,2"] * 2000 + ["1"]))
    (folder / "short.csv").write_text("\n".join(good[:100]))
    (folder / "flat.csv").write_text("\n".join(["1"] * 2000))
    (folder / "rate.csv").write_text("\n".join(good))
    (folder / "uneven.csv").write_text("\n".join(["time,a", *(f"{k + 500 * (k > 900)},{a}" for k, a in enumerate(good))]))
    path.write_text("x")
    for suffix in (".mat", ".npz", ".npy", ".wav", ".h5", ".parquet", ".mcap"):
        (folder / f"torn{suffix}").write_bytes(b"\x89HDF" * 20 if suffix == ".h5" else b"PK\x03\x04 no more of it" * 9)
    np.save(folder / "pickled.npy", np.array([{}], dtype=object), allow_pickle=True)
    with zipfile.ZipFile(folder / "bomb.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", bytes(50_000_000))
    (folder / "x.doc").write_text("1")
    (folder / "long.csv").write_text("1\n" * 20_001)
    (folder / "wide.csv").write_text(",".join(["1"] * 501))
    with zipfile.ZipFile(folder / "members.npz", "w") as archive:
        for number in range(501):
            archive.writestr(f"{number}.npy", b"")
    scipy.io.savemat(folder / "structure.mat", {"run": {"y": np.zeros(1_000_001)}}, do_compression=True)
    scipy.io.savemat(folder / "cells.mat", {"y": np.full(4001, 1.0, object)})
    pyarrow.parquet.write_table(pyarrow.table({"a": np.zeros(1_000_001, np.int8)}), folder / "rows.parquet")
    pyarrow.parquet.write_table(pyarrow.table({"time": pyarrow.array([2**60], pyarrow.timestamp("ms"))}), folder / "never.parquet")
    scipy.io.wavfile.write(folder / "chunks.wav", 2000, SAMPLES)
    with (folder / "chunks.wav").open("ab") as file:
        file.write(b"abcd\0\0\0\0" * 501)
    return {
        "empty.csv": "no row of numbers",
        "words.csv": "no row of numbers",
        "gap.csv": "line 51: '--' is no number",
        "nan.csv": "sample 50 is nan",
        "ragged.csv": "line 2001: 1 columns; expected 2",
        "short.csv": "at least 1024",
        "flat.csv": "check the sensor",
        "rate.csv": "--rate",
        "uneven.csv": "has a gap",
        **{f"torn{suffix}": "cannot be read|no row|MCAP|mcap" for suffix in (".mat", ".npz", ".npy", ".wav", ".h5", ".parquet", ".mcap")},
        "pickled.npy": "samples holds Python objects; .* expected numbers",
        "bomb.npz": "vibration_samples=NUMBER",
        "x.doc": "expected one that ends in",
        "long.csv": "vibration_text=NUMBER",
        "wide.csv": "vibration_parts=NUMBER",
        "members.npz": "vibration_parts=NUMBER",
        "structure.mat": "vibration_samples=NUMBER",
        "cells.mat": "vibration_parts=NUMBER",
        "rows.parquet": "vibration_samples=NUMBER",
        "never.parquet": "cannot be read as Parquet",
        "chunks.wav": "vibration_parts=NUMBER",
        "absent.csv": "no such file",
    }


def _complex_and_objects(folder):
    """Write files whose vibration is complex or made of objects; return by name the channel and what the message must say of it."""
    h5py = pytest.importorskip("h5py")
    wave, objects = SAMPLES + 0.5j, np.array([*SAMPLES[:-1], None], object)
    np.save(folder / "c.npy", wave)
    np.savez(folder / "c.npz", wave=wave, temperature=SPEEDS, fs=2000.0)
    np.savez(folder / "o.npz", allow_pickle=True, wave=objects, temperature=SPEEDS, fs=2000.0)
    scipy.io.savemat(folder / "c.mat", {"wave": wave[:, None], "temperature": SPEEDS, "fs": 2000.0})
    scipy.io.savemat(folder / "o.mat", {"wave": SAMPLES.astype(object), "temperature": SPEEDS, "fs": 2000.0})
    scipy.io.savemat(folder / "s.mat", {"wave": scipy.sparse.csc_array(SAMPLES[:, None]), "temperature": SPEEDS, "fs": 2000.0})
    with h5py.File(folder / "c.h5", "w") as file:
        file["wave"], file["temperature"] = wave, SPEEDS
    with h5py.File(folder / "m.h5", "w") as file:
        file["wave"] = np.array([(each, 0.5) for each in SAMPLES], [("real", "f8"), ("imag", "f8")])
        file["temperature"] = SPEEDS
    with h5py.File(folder / "t.h5", "w") as file:
        file["wave"] = [f"{each}" for each in SAMPLES]
    with h5py.File(folder / "f.h5", "w") as file:
        file["wave"] = np.array([(each, 0.5) for each in SAMPLES], [("x", "f8"), ("y", "f8")])
    pairs = pyarrow.array([{"re": each, "im": 0.5} for each in SAMPLES])
    pyarrow.parquet.write_table(pyarrow.table({"wave": pairs, "temperature": SPEEDS}), folder / "c.parquet")
    pyarrow.parquet.write_table(pyarrow.table({"wave": [f"{each}" for each in SAMPLES]}), folder / "o.parquet")
    is_complex = "wave holds complex numbers; expected the measured signal, which is real"
    return {
        "c.npy": ("samples", "samples holds complex numbers"),
        "c.npz": ("wave", is_complex),
        "o.npz": ("wave", "wave holds Python objects; these are not read"),
        "c.mat": ("wave", is_complex),
        "o.mat": ("wave", "wave holds cells or objects; expected one array"),
        "s.mat": ("wave", "wave holds a sparse matrix"),
        "c.h5": ("wave", is_complex),
        "m.h5": ("wave[0]", is_complex),
        "t.h5": ("wave", "wave holds texts; expected real numbers"),
        "f.h5": ("wave", "wave holds rows of the fields x, y"),
        "c.parquet": ("wave", "wave holds values of the type struct<re: double, im: double>"),
        "o.parquet": ("wave", "wave holds values of the type string"),
    }


def test_complex_and_object_arrays_are_named_with_what_they_hold_and_nothing_else_is_taken_for_the_vibration(tmp_path):
    for name, (channel, reason) in _complex_and_objects(tmp_path).items():
        for chosen in (channel, None):
            with pytest.raises(VibrationError, match=re.escape(reason)) as refusal:
                read_vibration(tmp_path / name, chosen, 2000.0)
            assert name in str(refusal.value)
    for name in ("c.npz", "o.npz", "c.mat", "o.mat", "s.mat", "m.h5", "c.parquet"):
        assert np.array_equal(read_vibration(tmp_path / name, "temperature", 2000.0).samples, SPEEDS)


def test_a_file_that_cannot_be_used_is_refused_with_what_is_wrong_and_where(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "vibration_samples=1e6,vibration_text=2e4,vibration_parts=500")
    for name, reason in _faulty(tmp_path).items():
        rate = None if name in ("rate.csv", "uneven.csv") else 2000.0
        with pytest.raises((FileError, VibrationError), match=reason) as refusal:
            read_vibration(tmp_path / name, rate=rate)
        assert name in str(refusal.value), str(refusal.value)


def test_an_empty_data_set_beside_the_vibration_is_passed_over(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "e.h5", "w") as file:
        file["wave"], file["nothing"] = SAMPLES, h5py.Empty("f")
    assert np.array_equal(read_vibration(tmp_path / "e.h5", rate=2000.0).samples, SAMPLES)


def called(*arguments):
    return CliRunner().invoke(main, ["vibration", *map(str, arguments)])


def test_the_command_gives_ratio_error_parts_and_a_picture(outer, tmp_path):
    import csv
    import json

    synthetic, _ = outer
    np.savez(tmp_path / "r.npz", acceleration=synthetic.vibration.samples.astype(np.float32), fs=RATE)
    arguments = (tmp_path / "r.npz", "--rollers", 13, "--speed", "3015rpm")
    result = called(*arguments, "--every", "0.5s", "--out", tmp_path / "r.csv", "--picture", tmp_path / "r.png", "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.output)
    assert abs(found["cage_to_shaft"] - synthetic.ratio) < 3.0 * found["cage_to_shaft_standard_error"] and found["shows"] == "outer_ring"
    assert found["slip_percent"] is None and not found["slip_is_claimed"]
    rows = list(csv.DictReader((tmp_path / "r.csv").open()))
    assert len(rows) == len(found["parts"]) == 4 and float(rows[0]["cage_speed_rad_s"]) == pytest.approx(found["cage_speed_rad_s"], rel=0.01)
    assert (tmp_path / "r.png").stat().st_size > 10_000
    text = called(*arguments, "--roller-diameter", "7.6mm", "--pitch-diameter", "40mm")
    assert text.exit_code == 0 and "cage over shaft" in text.output and re.search(r"slip\s*│ [78]\.", text.output), text.output


def test_a_sampling_rate_that_no_converter_has_is_refused(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,a\n" + "".join(f"{k}e-300,{(-1) ** k}\n" for k in range(3000)))
    for arguments in ((), ("--rate", "1e300 Hz")):
        refused = called(path, "--channel", "a", "--rollers", 13, "--speed", "1500rpm", *arguments)
        assert refused.exit_code == 2 and "expected at most 1e+07 Hz" in refused.stderr


def test_a_record_that_is_too_long_to_be_analysed_at_once_can_be_cut(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "vibration_analysed=1999")
    arguments = (_write(tmp_path / "r.npz"), "--channel", "acceleration", "--rollers", 13, "--speed", "1500rpm")
    refused = called(*arguments)
    assert refused.exit_code == 2 and "--from and --to" in refused.stderr and "vibration_analysed=NUMBER" in refused.stderr
    assert called(*arguments, "--to", "0.9s").exit_code == 0


def test_the_command_refuses_what_does_not_go_together(tmp_path):
    path = _write(tmp_path / "r.npz")
    for arguments, reason in (
        ((), "--rollers"),
        (("--rollers", 13, "--bearing", "NU 205"), "one of --bearing"),
        (("--rollers", 2), "Invalid value"),
        (("--bearing", "NU 2x5"), "NU 2x5"),
        (("--rollers", 13, "--pitch-diameter", "40mm"), "go together"),
        (("--rollers", 13, "--pitch-diameter", "40mm", "--roller-diameter", "12mm"), "do not fit on a circle"),
        (("--rollers", 13, "--channel", "aceleration"), "did you mean"),
        (("--rollers", 13, "--channel", "acceleration"), "how fast does the shaft turn"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "600"), "600"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "0rpm"), "at which the shaft turns"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "6000rpm", "--band", "1kHz:2kHz"), "half the sampling rate"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "30000rpm"), "too slow"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "600rpm"), "turns of the shaft"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "600rpm", "--tolerance", "50%"), "to 20 %"),
        (("--rollers", 13, "--channel", "acceleration", "--speed", "600rpm", "--from", "5s"), "within the 1 s"),
    ):
        result = called(path, *arguments)
        assert result.exit_code == 2 and reason in result.output and "Traceback" not in result.output, (arguments, result.output, result.exception)
