# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The sample record: everything that a level observes at one instant.

One line per observable (name, unit, meaning, shape).  MCAP topics, rerun paths, CSV headers and ROS
messages derive from it, so a new observable is one line here and one in a level's ``observe``.
"""

import functools
from collections import namedtuple
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class Observable(NamedTuple):
    """One field of the sample record."""

    name: str
    unit: str
    meaning: str
    per_roller: bool = False


RING_TEMPERATURES = ("inner_ring_temperature", "outer_ring_temperature")
"""The inputs that are measurements of what the model predicts.

A sample holds them with ``_measured`` behind the name.  Without it stands the temperature that the model has, which measured ones correct; with
``_uncorrected`` what a thermal network predicts without that.
"""

NODE_OBSERVABLES = (
    "shaft_temperature",
    "inner_ring_temperature",
    "roller_temperature",
    "outer_ring_temperature",
    "housing_temperature",
    "oil_outlet_temperature",
)
"""Observables of the temperatures of a thermal network, in the order of its nodes (`bearing_sim.physics.thermal_network.NODE`)."""
OBSERVABLES = (
    Observable("time", "s", "simulated time since the start of the run"),
    Observable("shaft_angle", "rad", "shaft rotation since the start"),
    Observable("shaft_speed", "rad/s", "shaft speed"),
    Observable("load_y", "N", "radial load on the inner ring along y"),
    Observable("load_z", "N", "radial load on the inner ring along z"),
    Observable("oil_temperature", "K", "oil temperature"),
    *(
        Observable(f"{name}_measured", "K", f"measured temperature of the {ring} ring; NaN where it is not measured")
        for name, ring in zip(RING_TEMPERATURES, ("inner", "outer"))
    ),
    Observable("running_clearance", "m", "diametral clearance of the running bearing at its lowest point; negative: preload"),
    Observable("initial_clearance", "m", "the part of it that is on the drawing, 2 (R_low - R_i - D_w)"),
    Observable("fit_clearance", "m", "the part by the fits of the rings"),
    Observable("rotation_clearance", "m", "the part by rotation of inner ring, shaft and rollers"),
    Observable("heat_clearance", "m", "the part by temperatures"),
    Observable("contour_clearance", "m", "the part by points of the contour that lie below R_low"),
    Observable("bending_clearance", "m", "the part by the outer ring that bends, where rollers carry: mean by their loads; 0 of a rigid ring"),
    Observable("level", "", "level that computed the sample: 0 steady, 1 slip, 2 planar, 3 spatial"),
    Observable("cage_angle", "rad", "cage rotation since the start"),
    Observable("cage_speed", "rad/s", "cage angular speed"),
    Observable("ideal_cage_angle", "rad", "rotation of a cage without slip since the start"),
    Observable("ideal_cage_speed", "rad/s", "cage speed without slip, omega_i (1 - gamma)/2"),
    Observable("cage_slip", "", "cage slip, 1 - cage speed / ideal cage speed (Deng 2017, eq. 17); NaN at rest"),
    Observable("rating_life", "h", "basic rating life at the present condition by the method of the scene; infinite at rest"),
    Observable("modified_rating_life", "h", "the same with reliability and oil, a_1 a_ISO times as long (ISO 281); damage counts it"),
    Observable("damage", "", "fraction of life used since the start (Miner)"),
    Observable("inner_equivalent_load", "N", "dynamic equivalent roller load of the rotating inner ring"),
    Observable("outer_equivalent_load", "N", "dynamic equivalent roller load of the stationary outer ring"),
    Observable("inner_lamina_load", "N", "the same of the inner ring by laminae with stress risers (ISO/TS 16281)"),
    Observable("outer_lamina_load", "N", "and of the outer ring"),
    Observable("reference_modification_factor", "", "a_ISO of all laminae together, L_nmr/(a_1 L10r); 1 without a cleanliness class"),
    Observable("l10", "h", "basic rating life L10 = (C/P)^(10/3) (ISO 281)"),
    Observable("lnm", "h", "modified rating life L_nm = a_1 a_ISO L10 (ISO 281)"),
    Observable("l10r", "h", "basic reference rating life L10r, by laminae (ISO/TS 16281)"),
    Observable("lnmr", "h", "modified reference rating life L_nmr, with a_ISO lamina by lamina (ISO/TS 16281)"),
    Observable("inner_load_maximum", "N", "largest normal force between any roller and the inner raceway since the sample before"),
    Observable("outer_load_maximum", "N", "largest normal force between any roller and the outer raceway since the sample before"),
    Observable("equivalent_load", "N", "dynamic equivalent load of the bearing, P: F_r, more under axial load (ISO 281)"),
    Observable("reference_load", "N", "dynamic equivalent reference load P_ref, under which L10 would be L10r (ISO/TS 16281)"),
    Observable("viscosity_ratio", "", "viscosity ratio kappa (ISO 281)"),
    Observable("contamination_factor", "", "contamination factor e_C (ISO 281); NaN where the scene names no cleanliness class"),
    Observable("modification_factor", "", "life modification factor a_ISO at P (ISO 281); 1 without a cleanliness class"),
    Observable("static_safety", "", "static safety factor S_0 = C_0/P_0 (ISO 76); infinite without load"),
    Observable("ring_y", "m", "inner-ring centre displacement along y, from the outer ring's centre"),
    Observable("ring_z", "m", "inner-ring centre displacement along z, from the outer ring's centre"),
    Observable("ring_tilt_y", "rad", "inclination of the inner ring's axis towards y; 0 at a level without tilts"),
    Observable("ring_tilt_z", "rad", "inclination of the inner ring's axis towards z; 0 at a level without tilts"),
    Observable("cage_y", "m", "cage centre displacement along y; 0 at a level without whirl"),
    Observable("cage_z", "m", "cage centre displacement along z; 0 at a level without whirl"),
    Observable("cage_tilt_y", "rad", "inclination of the cage's axis towards y; 0 at a level without tilts"),
    Observable("cage_tilt_z", "rad", "inclination of the cage's axis towards z; 0 at a level without tilts"),
    Observable("inner_pressure", "Pa", "largest Hertzian pressure of any lamina on the inner raceway; 0 at a level without tilts"),
    Observable("outer_pressure", "Pa", "largest Hertzian pressure of any lamina on the outer raceway; 0 at a level without tilts"),
    Observable("inner_edge_pressure", "Pa", "largest Hertzian pressure of a roller's end laminae on the inner raceway; 0 at a level without tilts"),
    Observable("outer_edge_pressure", "Pa", "largest Hertzian pressure of a roller's end laminae on the outer raceway; 0 at a level without tilts"),
    Observable("outer_ring_y", "m", "displacement of the outer ring along y, in its seat or on its support; 0 where it is held"),
    Observable("outer_ring_z", "m", "displacement of the outer ring along z, likewise"),
    Observable("seat_arc", "rad", "how much of the outer ring's seat touches the housing; NaN of a rigid or a free ring"),
    Observable("shaft_y", "m", "displacement of the shaft's mass in space along y; 0 at a level without vibration"),
    Observable("shaft_z", "m", "displacement of the shaft's mass in space along z, likewise"),
    Observable(
        "inner_flange_force",
        "N",
        "force of the inner ring's flanges on a roller along the orbit, mean over rollers; positive drives them; 0 at level steady",
    ),
    Observable("outer_flange_force", "N", "force of the outer ring's flanges on a roller along the orbit, mean over the rollers; likewise"),
    Observable(
        "flange_load",
        "N",
        "largest axial force between a roller's end and a flange: by axial load and guidance, and of corners that stop its skew; 0 at level steady",
    ),
    Observable("land_eccentricity", "", "cage eccentricity in what guides it, over its clearance, e/c; 0 at a level without whirl"),
    Observable(
        "shaft_power",
        "W",
        "power that the shaft puts in: through tractions and rolling resistance on the inner ring, the mixture in the cage's bore, guide lands on "
        "the inner ring, its flanges, and seals",
    ),
    Observable("inner_sliding_power", "W", "power lost by sliding between rollers and inner raceway"),
    Observable("outer_sliding_power", "W", "power lost by sliding between rollers and outer raceway"),
    Observable("inner_rolling_power", "W", "power lost by the resistance to rolling of the contacts with the inner raceway"),
    Observable("outer_rolling_power", "W", "power lost by the resistance to rolling of the contacts with the outer raceway"),
    Observable("churning_power", "W", "power lost by rollers in the oil-air mixture, or by rollers and cage in the oil bath"),
    Observable("windage_power", "W", "power lost by the cage in the oil-air mixture"),
    Observable("land_power", "W", "power lost in the guide lands: oil film and boundary friction"),
    Observable("pocket_power", "W", "power lost in the pockets: friction, and damping of their film"),
    Observable("damping_power", "W", "power lost by Hunt and Crossley's damping of all normal contacts; 0 at a level without vibration"),
    Observable("seal_power", "W", "power lost by seals on the shaft"),
    Observable("flange_power", "W", "power lost between the rollers' ends and flanges: oil film and friction; 0 without flanges"),
    Observable("support_power", "W", "power lost by the dampers of shaft and outer ring; 0 without a support and at a level without vibration"),
    Observable("friction_moment", "N*m", "frictional moment of the bearing, shaft power / shaft speed; NaN at rest"),
    Observable("shaft_temperature", "K", "temperature of the shaft; NaN where no law of heat computes or gives it"),
    Observable("inner_ring_temperature", "K", "temperature of the inner ring, likewise"),
    Observable("roller_temperature", "K", "temperature of rollers and cage, likewise"),
    Observable("outer_ring_temperature", "K", "temperature of the outer ring, likewise"),
    Observable("housing_temperature", "K", "temperature of the housing, likewise"),
    Observable("oil_outlet_temperature", "K", "temperature of the oil in the bearing, with which it leaves; NaN without a thermal network"),
    Observable("heat_to_oil", "W", "heat that the oil takes along as it flows through; NaN without a thermal network"),
    Observable("heat_to_ambient", "W", "heat that housing and shaft give off, to the air and along the shaft; NaN without a thermal network"),
    *(
        Observable(f"{name}_uncorrected", "K", f"temperature of the {ring} ring by the network without the measured ones; NaN without a network")
        for name, ring in zip(RING_TEMPERATURES, ("inner", "outer"))
    ),
    Observable("roller_angle", "rad", "azimuth of the roller centre", True),
    Observable("roller_radius", "m", "distance of the roller centre from the outer-ring centre", True),
    Observable("roller_spin", "rad/s", "roller spin, positive where it rolls on the outer ring", True),
    Observable("roller_rotation", "rad", "roller rotation about its own axis since the start", True),
    Observable("inner_load", "N", "normal force between roller and inner raceway", True),
    Observable("outer_load", "N", "normal force between roller and outer raceway", True),
    Observable("raceway_deflection", "m", "how far the outer ring has bent outwards at the roller; 0 of a rigid ring", True),
    Observable("orbital_speed", "rad/s", "angular speed of the roller centre about the outer-ring centre", True),
    Observable("pocket_force", "N", "force of the cage's pocket on the roller, positive where it drives the roller", True),
    Observable("roller_tilt", "rad", "inclination of the roller's axis outwards; 0 at a level without tilts", True),
    Observable("roller_skew", "rad", "inclination of the roller's axis along the orbit; 0 at a level without tilts", True),
)


@functools.cache
def sample_dtype(rollers: int) -> np.dtype:
    """Return the structured dtype of one sample of a bearing with that many rollers."""
    return np.dtype([(o.name, np.float64, (rollers,)) if o.per_roller else (o.name, np.float64) for o in OBSERVABLES])


def part_temperature(samples: np.ndarray, name: str) -> np.ndarray:
    """Return an observable of the temperature of a part [K], the oil's that comes in where no law of heat computes it.

    Parameters
    ----------
    samples : shape (n,) or a single one.
    name : of the observable.
    """
    temperature = samples[name]
    return np.where(temperature > 0.0, temperature, samples["oil_temperature"])


def new_block(samples: int, rollers: int) -> np.ndarray:
    """Return a block of ``samples`` zeroed samples, shape (samples,); zeroed as plain numbers, which NumPy does faster than records."""
    dtype = sample_dtype(rollers)
    return np.zeros(samples * dtype.itemsize // 8).view(dtype)


# Where compiled code finds an observable in a sample laid out flat: scalars first, then one run of Z numbers
# per roller observable.
SCALARS = sum(not o.per_roller for o in OBSERVABLES)
COLUMN = namedtuple("Column", [o.name for o in OBSERVABLES])(*[i if i < SCALARS else i - SCALARS for i in range(len(OBSERVABLES))])


def flat(block: np.ndarray) -> np.ndarray:
    """Return a block's numbers as a matrix that shares its memory, shape (samples, SCALARS + runs * Z)."""
    return block.view(np.float64).reshape(block.shape[0], -1)


def joined(blocks: Sequence[np.ndarray]) -> np.ndarray:
    """Return contiguous blocks of samples as one block; there must be at least one.

    The blocks are joined as plain numbers: NumPy would compare the dtypes of records field by field, which takes longer than the copy.
    """
    return np.concatenate([block.view(np.float64) for block in blocks]).view(blocks[0].dtype)
