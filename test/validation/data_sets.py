# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Open recordings of vibration that would validate slip, with the command for each; none of them was run here.

The names of files, variables and columns are those by which public readers of these data find them; we have not seen the files themselves.
"""

from typing import NamedTuple


class DataSet(NamedTuple):
    """A set of recordings.

    Attributes
    ----------
    name, bearing : of the set, and of what turns in it.
    varied : speeds and loads.
    files : their form.
    where : they are found, and the paper that describes them.
    commands : for one of its files, or a table of them.
    missing : what has to be known beside them.
    """

    name: str
    bearing: str
    varied: str
    files: str
    where: str
    commands: tuple[str, ...]
    missing: str


DATA_SETS = (
    DataSet(
        "DIRG, Politecnico di Torino",
        "roller bearings of a rig for high-speed aeronautical bearings; B1 has a cut of 150, 250 or 450 um in the inner ring (1A to 3A) or a roller "
        "(4A to 6A), 0A has none",
        "100 to 500 Hz (6,000 to 30,000 rpm), nominally 0, 1000, 1400, 1800 N",
        "VariableSpeedAndLoad/C<cut>_<speed in Hz>_<load in mV, 0.499 mV/N>_<number>.mat; one variable, which has the name of the file, with a "
        "column for each of three axes of two accelerometers; 51.2 kHz, 10 s",
        "https://zenodo.org/records/3559553 (CC BY 4.0); Daga, Fasana, Marchesiello, Garibaldi, MSSP 120 (2019) 252-273",
        (
            "bearing-sim vibration C1A_300_702_2.mat --channel C1A_300_702_2[0] --rate 51.2kHz --speed 300Hz --rollers Z --roller-diameter D_W "
            "--pitch-diameter D_M",
        ),
        "Z, D_W and D_M: rollers and diameters of B1 by the paper; the speed is nominal",
    ),
    DataSet(
        "Saarland University and ZeMA, inner ring of an NU206-E-XL-TVP2",
        "three NU206-E-XL-TVP2, first healthy, then with a small milled cut in the inner ring, in four mounting positions",
        "85, 392, 706, 969 rpm; about 0, 1600, 2500, 3300 N; 1151 recordings",
        "CSV with the columns Mod1/ai0, Mod1/ai1, Mod1/ai2 (three axes), 20 kHz, 60 s; info.csv has folder, name, speed (SpeedRPM), force level and "
        "state (DamageState) of each",
        "https://doi.org/10.5281/zenodo.15376389 (CC BY 4.0); Schnur and others, Data 10 (2025) 77",
        ('bearing-sim vibration RECORDING.csv --channel Mod1/ai0 --rate 20kHz --speed 969rpm --bearing "NU 206"',),
        "a recording with a cut, by info.csv, and the forces of its levels, by the paper",
    ),
    DataSet(
        "University of Seoul (UOS), cylindrical roller bearings",
        "N204, healthy or with a cut in outer ring (OR) or roller (B); NJ204 with a cut in the inner ring (IR); shaft healthy (H), unbalanced, "
        "misaligned or loose",
        "600 to 1600 rpm; no load stated",
        "BearingType_CylindricalRoller/SamplingRate_16000/RotatingSpeed_<rpm>/<shaft>_<cut>_<kHz>_<bearing>_<rpm>.mat with the vibration in Data, "
        "beside spectrograms; 80 s at 16 kHz, or 160 s at 8 kHz",
        "https://data.mendeley.com/datasets/7trwzz77xh; Lee and others, https://doi.org/10.1016/j.dib.2024.110940",
        (
            'bearing-sim vibration H_OR_16_N204_1000.mat --channel Data --rate 16kHz --speed 1000rpm --bearing "N 204"',
            'bearing-sim vibration H_IR_16_NJ204_1000.mat --channel Data --rate 16kHz --speed 1000rpm --bearing "NJ 204"',
        ),
        "the load, without which only gross slip can be judged",
    ),
)
