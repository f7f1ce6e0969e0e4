# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Open recordings of vibration that would validate slip, with the command for each; none of them was run here.

Form of the files as their authors and readers of them in public repositories describe it.
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
        "roller bearings of a rig for high-speed aeronautical bearings; B1 with cuts of 150 to 450 um in inner ring or roller",
        "100 to 500 Hz (6,000 to 30,000 rpm), nominally 0, 1000, 1400, 1800 N",
        "MAT, C<fault>_<speed in Hz>_<load in mV>_<number>.mat, 6 columns (two accelerometers, three axes), 51.2 kHz, 10 s; 0.499 mV/N",
        "ftp://ftp.polito.it/people/DIRG_BearingData; Daga, Fasana, Marchesiello, Garibaldi, MSSP 120 (2019) 252-273",
        (),
        "rollers and diameters of the bearing, which the paper gives; the speed is nominal",
    ),
    DataSet(
        "Saarland University and ZeMA, inner ring of an NU206-E-XL-TVP2",
        "NU206-E-XL-TVP2, healthy and with small cuts in the inner ring, several bearings and mountings",
        "a grid of shaft speeds and force levels, 1151 recordings of the published design",
        "CSV of three columns (x, y, z), 20 kHz, 60 s; info.csv lists the folder, speed and force level of each",
        "Schnur and others 2025; info.csv of the archive says which files belong to the design",
        (),
        "force levels in N are those of the paper; the inner ring's lines need a cut one",
    ),
    DataSet(
        "University of Seoul (UOS)",
        "N204 and NJ204, beside ball and taper roller bearings; healthy and with cuts in inner ring, outer ring or roller",
        "600 to 1600 rpm, no load stated",
        "MAT, <rotor>_<bearing's fault>_<kHz>_<designation>_<rpm>.mat, 8 or 16 kHz",
        "Lee and others, Data in Brief 2024, Mendeley Data",
        (),
        "the load, so that it shows gross slip only",
    ),
)
