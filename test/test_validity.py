# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the limits of validity: every law warns outside of its range, by every door that a user has, and is silent inside it."""

import json
import math
import re
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import write_log
from scipy.integrate import solve_bvp
from support import ListSink

from bearing_sim import Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.messages.events import Event, Level
from bearing_sim.model import validity
from bearing_sim.model.sample import new_block
from bearing_sim.model.validity import (
    BY_NAME,
    LAWS,
    MINIMUM_LOAD,
    UNWATCHED,
    Conditions,
    Effect,
    Exceedance,
    Grade,
    cell,
    counted,
    film_of_all_regimes,
    heated_shear,
    merged,
    outside,
    still_sample,
)
from bearing_sim.physics.film import DOWSON_TOYODA
from bearing_sim.recording.reader import Recording
from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.settle import settle
from bearing_sim.sweep import grading
from bearing_sim.sweep.point import point_row
from bearing_sim.watchers.monitoring.film_ratio import ThinnestFilm
from bearing_sim.watchers.monitoring.limits import LimitsMonitor

MOTOR = """
name: nu210
level: slip
bearing:
  name: NU 210
  source: sketch of a catalogue bearing
  roller: {count: 16, diameter: 11 mm, length: 12 mm}
  inner_raceway: {radius: 29.75 mm, ring_mass: 200 g, bore_radius: 25 mm}
  outer_raceway: {low_radius: 40.7775 mm, d_value: 0 mm}
  cage: {mass: 60 g, width: 14 mm, inner_radius: 33.5 mm, guide_radius: 38 mm, guide_clearance: 0.3 mm, guide_land_width: 3 mm}
lubricant: {oil: mil_l_7808, temperature: 70 degC, mixture_fraction: 0.1}
operating: {shaft_speed: 3000 rpm, radial_load: 5 kN}
"""
GEARBOX = """
name: nu232
level: slip
bearing:
  name: NU 232
  source: sketch of a catalogue bearing
  roller: {count: 17, diameter: 38 mm, length: 38 mm}
  inner_raceway: {radius: 97.5 mm, ring_mass: 6 kg, bore_radius: 80 mm}
  outer_raceway: {low_radius: 135.55 mm, d_value: 0 mm}
  cage: {mass: 2 kg, width: 46 mm, inner_radius: 106 mm, guide_radius: 128 mm, guide_clearance: 0.6 mm, guide_land_width: 8 mm}
lubricant: {oil: mil_l_7808, temperature: 70 degC, mixture_fraction: 0.1}
operating: {shaft_speed: 1650 rpm, radial_load: 100 kN}
"""
FEW_THICK_ROLLERS = """
name: thick
level: slip
bearing:
  name: seven thick rollers
  source: made up
  roller: {count: 7, diameter: 20 mm, length: 20 mm}
  inner_raceway: {radius: 20 mm, ring_mass: 200 g, bore_radius: 15 mm}
  outer_raceway: {low_radius: 40.01 mm, d_value: 0 mm}
  cage: {mass: 60 g, width: 25 mm, inner_radius: 28 mm, guide_radius: 35 mm, guide_clearance: 0.3 mm, guide_land_width: 2 mm}
lubricant: {oil: mil_l_7808, temperature: 70 degC, mixture_fraction: 0.03}
operating: {shaft_speed: 3000 rpm, radial_load: 5 kN}
"""
VG_320 = (
    "lubricant.oil={law: custom, viscosity_40: 320 mm^2/s, viscosity_100: 24 mm^2/s, density: 890 kg/m^3, pressure_viscosity: 22 1/GPa}",
    "lubricant.temperature=60 degC",
)
THICK_LANDS = "lubricant={oil: ISO VG 220, temperature: 40 degC, supply: oil_air}", "level=steady"
AVIATION_FIT = "lubricant.traction=oil_4109"
SOLVENT = "lubricant.oil={law: custom, viscosity_40: 0.5 mm^2/s, viscosity_100: 0.3 mm^2/s, density: 800 kg/m^3, pressure_viscosity: 5 1/GPa}"
WATERY = "lubricant.oil={law: custom, viscosity_40: 1 mm^2/s, viscosity_100: 0.6 mm^2/s, density: 1000 kg/m^3, pressure_viscosity: 1 1/GPa}"
ROUGH = "bearing.roughness={roller: 0.1 um, raceway: 0.2 um}"
EYRING = "lubricant.traction={law: eyring}"
BATH = "lubricant.supply=oil_bath"
GREASE = "lubricant={grease: lithium NLGI 2, temperature: 70 degC}"
FULL = "bearing.cage={guidance: full_complement}"
PAPER = "deng2017_table1"
HOT = ("heat.law=given",)
CORRECTED = ("level=steady", "table.correction=planar")
NETWORK = ("heat.law=network", "level=steady")

# Law: the command and what drives the law out of its range; the command and what keeps it inside.


def carried(stiffness, length, clearance):
    """Overrides for an outer ring on a spring [N/m] in a squeeze film of a length [mm] and a radial clearance [um]."""
    film = f"{{radius: 40 mm, length: {length} mm, clearance: {clearance} um}}"
    return "level=planar", f"support.outer_ring={{stiffness: {stiffness} N/m, squeeze_film: {film}}}"


def backed(play, thickness=4.0, shear="true"):
    """Overrides for an outer ring that bends in a massive housing with a radial play [um]."""
    ring = f"{{width: 20 mm, equivalent_thickness: {thickness} mm, seat_radius: 45 mm, shear: {shear}}}"
    return f"bearing.outer_ring={ring}", f"mounting.housing.backing={{law: elastic, massive: true, play: {play} um}}"


NJ = "bearing.flanges={inner: one, outer: both}"
CASES = {
    "table_correction": (("loads", PAPER, *CORRECTED, "table.maximum_load=400 N"), ("loads", PAPER, *CORRECTED)),
    "oil_4109_class": (("run", "motor", *VG_320, AVIATION_FIT), ("run", "motor")),
    "oil_4109_base": (("loads", "motor", "lubricant.oil=ISO VG 32", AVIATION_FIT), ("loads", "motor", "lubricant.oil=DEF STAN 91-101")),
    "estimated_rollers": (("run", "motor", "bearing.estimated=[{field: roller.count, by: a guess, low: 15, high: 17}]"), ("run", "motor")),
    "flange_axial_ratio": (("run", "motor", NJ, "operating.axial_load=2.6 kN"), ("run", "motor", NJ, "operating.axial_load=2.4 kN")),
    "flange_axial_load": (
        ("run", "motor", NJ, "operating.axial_load=6 kN", "operating.radial_load=20 kN"),
        ("run", "motor", NJ, "operating.axial_load=4 kN", "operating.radial_load=20 kN"),
    ),
    "flange_gap": (
        ("run", PAPER, "bearing.flanges={inner: both, end_clearance: 200 um}"),
        ("run", PAPER, "bearing.flanges={inner: both, end_clearance: 30 um}"),
    ),
    "full_complement_play": (("run", "motor", FULL), ("run", "motor", FULL, "bearing.roller.count=20")),
    "oil_4109_pressure": (("run", PAPER, "operating.radial_load=25 kN"), ("run", PAPER)),
    "oil_4109_speed": (("run", PAPER, "operating.shaft_speed=52000 rpm"), ("run", PAPER)),
    "oil_4109_temperature": (("run", PAPER, "lubricant.temperature=170 degC"), ("run", PAPER, "lubricant.temperature=140 degC")),
    "oil_4109_sliding": (
        ("run", PAPER, "lubricant.traction_scale=0.02", "bearing.outer_raceway.low_radius=34.9 mm", "operating.radial_load=100 N"),
        ("run", PAPER),
    ),
    "traction_sample_curve": (
        ("run", PAPER, "lubricant.traction={law: constant}"),
        ("run", PAPER, "lubricant.traction={law: constant, b: 0.5, c: 45, d: 0.02}"),
    ),
    "eyring_stress": (("run", PAPER, EYRING, "lubricant.traction.eyring_stress=20 MPa"), ("run", PAPER, EYRING)),
    "eyring_limiting_stress": (("run", PAPER, EYRING, "lubricant.traction.limiting_ratio=0.2"), ("run", PAPER, EYRING)),
    "eyring_viscosity": (("loads", PAPER, EYRING, SOLVENT, "lubricant.temperature=150 degC"), ("loads", PAPER, EYRING)),
    "film_speed": (("run", "motor", ROUGH, *VG_320, "lubricant.temperature=20 degC"), ("run", PAPER, ROUGH)),
    "film_load": (("run", "motor", ROUGH, "operating.radial_load=100 kN"), ("run", "motor", ROUGH)),
    "film_material": (("loads", "motor", ROUGH, WATERY), ("loads", "motor", ROUGH)),
    "rolling_speed": (("run", "motor", *VG_320, "lubricant.temperature=20 degC"), ("run", "motor", *VG_320)),
    "bath_viscosity": (("run", "motor", *VG_320, "lubricant.temperature=20 degC", BATH), ("run", "motor", *VG_320, BATH)),
    "bath_speed": (
        ("run", "motor", BATH, "bearing.ratings.reference_speed=2900 rpm"),
        ("run", "motor", BATH, "bearing.ratings.reference_speed=8000 rpm"),
    ),
    "mixture_fraction": (("run", "motor"), ("run", PAPER)),
    "mixture_of_jet": (("run", "motor", *VG_320, "lubricant.mixture_fraction=0.03"), ("run", PAPER)),
    "jet_flow": (
        ("loads", "motor", "lubricant={oil: mil_l_7808, supply: {law: oil_jet, flow: 1 l/min}}"),
        ("loads", "motor", "lubricant={oil: mil_l_7808, supply: {law: oil_jet, flow: 1 l/min}}", "operating.shaft_speed=9000 rpm"),
    ),
    "grease_speed": (("loads", "motor", GREASE, "lubricant.grease.speed_factor=200000"), ("loads", "motor", GREASE)),
    "grease_temperature": (("loads", "motor", GREASE, "lubricant.temperature=-30 degC"), ("loads", "motor", GREASE)),
    "thin_film": (("loads", "motor", WATERY), ("loads", "motor", WATERY, "lubricant.temperature=40 degC")),
    "starved_film": (("run", "motor", GREASE, "lubricant.temperature=20 degC"), ("run", "motor", GREASE)),
    "churning_reynolds": (
        ("run", "motor", *VG_320, "lubricant.temperature=0 degC", "operating.shaft_speed=300 rpm", "lubricant.mixture_fraction=0.01"),
        ("run", "motor"),
    ),
    "end_face_reynolds": (
        ("loads", "gearbox", SOLVENT, "lubricant.mixture_fraction=1", "lubricant.temperature=100 degC", "operating.shaft_speed=6000 rpm"),
        ("loads", "gearbox"),
    ),
    "cage_gap": (("run", "thick"), ("run", "motor")),
    "land_length": (("run", PAPER, "bearing.cage.width=80 mm", "bearing.cage.guide_land_width=36 mm"), ("run", PAPER)),
    "land_clearance": (("run", PAPER, "bearing.cage.guide_clearance=0.8 mm"), ("run", PAPER)),
    "land_laminar": (("run", PAPER, "level=planar"), ("run", PAPER)),
    "land_heating": (
        ("run", "motor", *THICK_LANDS, "operating.shaft_speed=9000 rpm"),
        ("run", "motor", *THICK_LANDS, "operating.shaft_speed=600 rpm"),
    ),
    "pocket_film": (("run", PAPER, "level=planar", "bearing.cage.pocket_clearance=0.5 mm"), ("run", PAPER, "level=planar")),
    "hertz_pressure": (("run", "motor", "operating.radial_load=800 kN"), ("run", "motor")),
    "iso_spring_steel": (
        ("run", PAPER, "bearing.contact.spring=iso", "bearing.material.youngs_modulus=310 GPa"),
        ("run", PAPER, "bearing.contact.spring=iso"),
    ),
    "roller_slenderness": (("run", PAPER, "bearing.roller.length=25 mm", "bearing.cage.width=30 mm"), ("run", PAPER)),
    "diameter_ratio": (("run", "thick"), ("run", "motor")),
    "life_load": (("loads", "motor", "operating.radial_load=40 kN"), ("loads", "motor", "operating.radial_load=30 kN")),
    "catalogue_life": (("run", PAPER, "life.method=iso281"), ("run", "motor", "life.method=iso281")),
    "static_load": (("loads", "motor", "operating.radial_load=85 kN"), ("loads", "motor", "operating.radial_load=70 kN")),
    "viscosity_ratio": (
        ("loads", "motor", *VG_320, "life.a_iso=bath_17_14"),
        ("loads", "motor", "life.a_iso=bath_17_14"),
    ),
    "life_laminae": (("run", "motor", "life.laminae=20"), ("run", "motor")),
    "roller_profile": (("run", "motor", "bearing.roller.crown=none"), ("run", "motor")),
    "oil_temperature": (("run", PAPER, "lubricant.temperature=220 degC"), ("run", PAPER)),
    "polyamide_cage": (("loads", "motor", "bearing=NU 210 ECP", "lubricant.temperature=130 degC"), ("loads", "motor", "bearing=NU 210 ECP")),
    "ring_stabilisation": (
        ("loads", "motor", "bearing=NU 210 ECM", "lubricant.temperature=130 degC"),
        ("loads", "motor", "bearing=NU 210 ECM/S1", "lubricant.temperature=130 degC"),
    ),
    "mineral_oil": (
        ("loads", "motor", "lubricant.oil=ISO VG 220", "lubricant.temperature=110 degC"),
        ("loads", "motor", "lubricant.oil=ISO VG 220 PAO", "lubricant.temperature=110 degC"),
    ),
    "local_temperature": (("run", PAPER, *HOT, "heat.inner_ring=250 degC"), ("run", PAPER, *HOT, "heat.inner_ring=150 degC")),
    "shaft_in_air": (
        ("run", PAPER, *NETWORK, "operating.shaft_speed=60000 rpm", "bearing.inner_raceway.bore_radius=27 mm"),
        ("run", PAPER, *NETWORK),
    ),
    "class_pressure_viscosity": (
        ("loads", "motor", "lubricant.oil=ISO VG 460", "lubricant.temperature=0 degC"),
        ("loads", "motor", "lubricant.oil=ISO VG 460"),
    ),
    "viscosity_index": (("loads", "motor", "lubricant.oil=ISO VG 5"), ("loads", "motor", "lubricant.oil=ISO VG 10")),
    "oil_viscosity": (
        ("loads", "motor", SOLVENT, "lubricant.temperature=210 degC"),
        ("loads", "motor", *VG_320),
    ),
    "speed_factor": (("run", PAPER, "operating.shaft_speed=52000 rpm"), ("run", PAPER)),
    "given_temperatures": (
        ("run", PAPER, *HOT, "heat.inner_ring=160 degC"),
        ("run", "motor", *HOT, "heat.inner_ring=100 degC"),
    ),
    "inner_ring_stress": (
        ("run", "motor", "mounting.shaft.interference=500 um"),
        ("run", "motor", "mounting.shaft.interference=30 um"),
    ),
    "sleeve_seat": (
        ("run", PAPER, "bearing.dimensions_at=cold", "mounting.shaft={interference: 10 um, sleeve: {bore_radius: 22 mm, interference: 0.1 um}}"),
        ("run", "motor", "mounting.shaft={fit: k5, sleeve: {bore_radius: 22 mm, interference: 20 um}}"),
    ),
    "shaft_seat": (
        ("run", PAPER, "bearing.dimensions_at=cold", "mounting.shaft.interference=10 um"),
        ("run", "motor", "mounting.shaft.fit=k5"),
    ),
    "squeeze_film_eccentricity": (("run", PAPER, *carried(8e6, 12, 150)), ("run", PAPER, *carried(4e7, 12, 150))),
    "squeeze_film_length": (("run", PAPER, *carried(4e7, 60, 60)), ("run", PAPER, *carried(4e7, 12, 60))),
    "squeeze_film_reynolds": (("run", PAPER, *carried(4e7, 12, 150)), ("run", PAPER, *carried(4e7, 12, 60))),
    "outer_ring_thickness": (("run", "motor", *backed(-2, 9.0)), ("run", "motor", *backed(-2, 6.0))),
    "seat_arc": (("run", "motor", *backed(200)), ("run", "motor", *backed(0))),
    "ring_loose": (("run", "motor", *backed(5)), ("run", "motor", *backed(-2))),
    "limiting_speed": (
        ("run", "motor", "bearing.ratings.limiting_speed=2900 rpm"),
        ("run", "motor", "bearing.ratings.limiting_speed=9000 rpm"),
    ),
}


@pytest.fixture(scope="module")
def scenes(tmp_path_factory):
    """Paths of scene files by name."""
    folder, found = tmp_path_factory.mktemp("scenes"), {PAPER: PAPER}
    for name, text in (("motor", MOTOR), ("gearbox", GEARBOX), ("thick", FEW_THICK_ROLLERS)):
        path = folder / f"{name}.yaml"
        path.write_text(text)
        found[name] = str(path)
    return found


def invoke(scenes, command, name, *overrides, json_wanted=True, verbose=False):
    """Run a command on a scene; return the result of click."""
    arguments = [command, scenes[name], *(word for each in overrides for word in ("--set", each)), *(["--verbose"] if verbose else [])]
    arguments += ["--duration", "0.2"] if command == "run" else []
    return CliRunner().invoke(main, [*arguments, *(["--json"] if json_wanted else [])])


def warned(scenes, case):
    """Return the reported exceedances of a command, by name, and what it prints with ``--verbose``."""
    result = invoke(scenes, *case, verbose=True)
    assert result.exit_code == 0, result.output
    lines = result.stderr.splitlines()
    assert len(set(lines)) == len(lines), "each is told once"
    return {each["name"]: each for each in json.loads(result.stdout)["warnings"]}, result.stderr


@pytest.fixture
def ungraded(monkeypatch):
    """Keep the grades of sources, without computing effects."""
    monkeypatch.setattr(grading, "graded", lambda scene, exceedances, sample, shown=(): list(exceedances))


@pytest.mark.parametrize("name", CASES)
def test_a_law_tells_outside_of_its_range_with_the_grade_of_its_source(ungraded, scenes, name):
    found, printed = warned(scenes, CASES[name][0])
    law = BY_NAME[name]
    assert name in found, printed
    report = found[name]
    assert report["grade"] == ("assumption" if law.source.startswith("assumption") else "warning")
    if report["grade"] == "warning" or name == "speed_factor":  # which is implausible besides
        assert f"warning: {name}: {law.law}: {law.quantity}" in printed and law.instead in printed
    else:
        assert f"note: assumption: {name}: {law.quantity}" in printed and f"warning: {name}" not in printed
    if not law.is_condition:
        assert report["value"] < (-math.inf if report["low"] is None else report["low"]) or report["value"] > report["high"]


@pytest.mark.parametrize("name", CASES)
def test_a_law_is_silent_inside_its_range(ungraded, scenes, name):
    found, printed = warned(scenes, CASES[name][1])
    assert name not in found and f"{name}:" not in printed


def test_every_law_has_a_case_a_source_and_an_alternative():
    elsewhere = {"table_states"}  # in test_two_states.py
    assert CASES.keys() | elsewhere == BY_NAME.keys() and len(BY_NAME) == len(LAWS) == len(CASES) + len(elsewhere)
    for law in LAWS:
        assert law.kind.startswith("validity.") and law.source and law.instead and law.quantity, law.name
        assert law.is_condition or law.expected or law.low < law.high, law.name


INF, BY_SCENE = math.inf, None
RANGES = {  # low and high; temperatures in degC
    "table_correction": (0.0, 1.0),
    "table_states": (-INF, 0.5),
    "oil_4109_class": (2.5, 7.5),
    "oil_4109_base": (-INF, 0.5),
    "oil_4109_pressure": (0.5, 3.0),
    "oil_4109_speed": (5.0, 80.0),
    "oil_4109_temperature": (-5.0, 150.0),
    "oil_4109_sliding": (-INF, 0.6),
    "traction_sample_curve": (-INF, 0.5),
    "eyring_stress": (2.0, 10.0),
    "eyring_limiting_stress": (0.03, 0.12),
    "eyring_viscosity": (0.2, INF),
    "film_speed": (1e-13, 1e-9),
    "film_load": (1e-5, 1e-3),
    "film_material": (1e3, 1e4),
    "rolling_speed": (6e-13, 1e-9),
    "bath_viscosity": (-INF, 500.0),
    "bath_speed": (-INF, 1.0),
    "mixture_fraction": (0.015, 0.05),
    "mixture_of_jet": (4e5, INF),
    "jet_flow": (5e5, 6e6),
    "grease_speed": (-INF, BY_SCENE),
    "grease_temperature": (BY_SCENE, BY_SCENE),
    "thin_film": (0.1, INF),
    "starved_film": (0.2, INF),
    "churning_reynolds": (0.1, 1e6),
    "end_face_reynolds": (-INF, 1e7),
    "cage_gap": (-INF, 0.25),
    "land_length": (-INF, 0.5),
    "land_clearance": (-INF, 0.02),
    "land_laminar": (-INF, 41.0),
    "land_heating": (-INF, 1.0),
    "pocket_film": (0.003, 0.05),
    "hertz_pressure": (-INF, 4.0),
    "iso_spring_steel": (200.0, 215.0),
    "roller_slenderness": (0.5, 3.0),
    "diameter_ratio": (0.01, 0.3),
    "life_load": (-INF, 0.5),
    "catalogue_life": (-INF, 1.5),
    "static_load": (-INF, 1.0),
    "viscosity_ratio": (-INF, 4.0),
    "life_laminae": (30.0, INF),
    "roller_profile": (-INF, 0.5),
    "oil_temperature": (BY_SCENE, BY_SCENE),
    "local_temperature": (-INF, BY_SCENE),
    "polyamide_cage": (-40.0, 120.0),
    "ring_stabilisation": (-INF, BY_SCENE),
    "mineral_oil": (-INF, 100.0),
    "shaft_in_air": (-INF, 4e5),
    "oil_viscosity": (0.21, 2e7),
    "class_pressure_viscosity": (1.0, 3000.0),
    "viscosity_index": (2.0, INF),
    "speed_factor": (-INF, 3e6),
    "given_temperatures": (-INF, 0.5),
    "inner_ring_stress": (-INF, BY_SCENE),
    "sleeve_seat": (0.0, INF),
    "shaft_seat": (0.0, INF),
    "squeeze_film_eccentricity": (-INF, 0.4),
    "squeeze_film_length": (-INF, 0.5),
    "squeeze_film_reynolds": (-INF, 10.0),
    "flange_axial_ratio": (-INF, 0.5),
    "flange_axial_load": (-INF, 1.0),
    "flange_gap": (-INF, 1440.0),
    "outer_ring_thickness": (-INF, BY_SCENE),
    "seat_arc": (60.0, INF),
    "ring_loose": (-INF, 0.0),
    "limiting_speed": (-INF, BY_SCENE),
    "estimated_rollers": (-INF, 0.0),
    "full_complement_play": (-INF, 1.5),
    "minimum_load": (1.0, INF),
}
RANGES_OF_SCENES = [  # limit, overrides, low, high; in SI units where the table above has BY_SCENE
    ("grease_temperature", ("lubricant={grease: {base_oil: ISO VG 100, nlgi: 2}, temperature: 70 degC}",), -INF, INF),
    ("grease_temperature", (GREASE,), 253.15, 393.15),
    ("grease_temperature", ("lubricant={grease: SKF LGMT 2, temperature: 70 degC}",), 243.15, 393.15),
    ("oil_temperature", VG_320, 253.15, 433.15),
    ("local_temperature", VG_320, -INF, 433.15),
    ("ring_stabilisation", ("bearing=NU 210 ECP",), -INF, 393.15),
    ("ring_stabilisation", ("bearing=NU 210 ECP/S0",), -INF, 423.15),
    ("ring_stabilisation", ("bearing=NU 210 ECP/S1",), -INF, 473.15),
    ("ring_stabilisation", ("bearing=NU 210 ECP/S2",), -INF, 523.15),
    ("inner_ring_stress", ("bearing.material.strength=1500 MPa",), -INF, 1500.0),
    ("outer_ring_thickness", backed(0), -INF, 1.0),
    ("outer_ring_thickness", backed(0, shear="false"), -INF, 0.28),
    ("limiting_speed", ("bearing.ratings.limiting_speed=9000 rpm",), -INF, 9000.0),
]


def test_the_ends_of_every_range_are_those_of_this_table():
    found = {law.name: (law.low, law.high) for law in (*LAWS, MINIMUM_LOAD)}
    shown = {law.name: law.shown for law in (*LAWS, MINIMUM_LOAD)}
    ends = {name: tuple(None if callable(end) else shown[name](end) for end in both) for name, both in found.items()}
    assert ends.keys() == RANGES.keys()
    for name, (low, high) in RANGES.items():
        assert [end is None for end in ends[name]] == [low is None, high is None], name
        assert [end for end in ends[name] if end is not None] == pytest.approx([end for end in (low, high) if end is not None], rel=1e-12, abs=0.0), (
            name
        )


@pytest.mark.parametrize(("name", "overrides", "low", "high"), RANGES_OF_SCENES)
def test_a_range_that_depends_on_the_scene_is_the_one_of_this_table(scenes, name, overrides, low, high):
    assert BY_NAME[name].limits(load_scene(scenes["motor"], list(overrides))) == pytest.approx((low, high), rel=1e-12)


def test_every_entry_of_the_table_of_limits_is_used():
    entries = tomllib.loads((Path(validity.__file__).parents[1] / "physics" / "limits.toml").read_text())
    assert entries.keys() - {"unwatched"} == {*BY_NAME, MINIMUM_LOAD.name}
    assert UNWATCHED == tuple(entries["unwatched"].items()) and all(law and why for law, why in UNWATCHED)


def test_the_bundled_scenes_are_calm_where_the_papers_laws_are_in_their_range(scenes):
    for scene in (PAPER, "deng2017_table2"):
        result = invoke({scene: scene}, "run", scene)
        report = json.loads(result.stdout)
        assert report["warnings"] == [] and report["implausible"] == [] and "warning" not in result.stderr
    fast = invoke({"table2": "deng2017_table2"}, "run", "table2", "operating.shaft_speed=52000 rpm")
    assert {each["name"] for each in json.loads(fast.stdout)["warnings"]} == {"oil_4109_speed", "speed_factor"}


def test_a_gear_oil_with_the_aviation_fit_and_a_jets_mixture_is_told_by_every_command(scenes):
    """3 % of oil and oil_4109 on ISO VG 320, which once went without a word."""
    told = {"oil_4109_class", "mixture_of_jet"}
    for command in ("run", "loads"):
        result = invoke(scenes, command, "motor", *VG_320, AVIATION_FIT, "lubricant.mixture_fraction=0.03")
        assert told <= {each["name"] for each in json.loads(result.stdout)["warnings"]}
        assert all(f"warning: {name}: " in result.stderr for name in told)
    row = point_row(load_scene(scenes["motor"], [*VG_320, AVIATION_FIT, "lubricant.mixture_fraction=0.03"]), 0.05)
    assert "oil_4109_class 24 mm^2/s" in row["warnings"] and "mixture_of_jet" in row["warnings"]


def test_an_overload_of_eleven_gigapascals_ends_with_warnings(scenes):
    result = invoke(scenes, "run", "motor", "operating.radial_load=800 kN", json_wanted=False)
    assert result.exit_code == 0
    assert re.search(r"warning: hertz_pressure: .* the largest Hertz pressure is 11\.[45]\d? GPa; expected at most 4 GPa", result.stderr)
    assert "warning: life_load: " in result.stderr and "warning: static_load: " in result.stderr


def settled_with(scenes, *overrides):
    """Return what a scene of the file ``motor`` settles to at level steady."""
    return settle(load_scene(scenes["motor"], list(overrides)), "steady")


def exceedance(settled, name):
    """Return an exceedance by its law."""
    return next(each for each in settled.warnings if each.law.name == name)


def test_the_effect_of_another_law_is_the_difference_of_two_runs(scenes):
    fitted = settled_with(scenes, *VG_320, AVIATION_FIT, "lubricant.mixture_fraction=0.03")
    other = settled_with(scenes, *VG_320, "lubricant.traction=eyring", "lubricant.mixture_fraction=0.03")
    effect = exceedance(fitted, "oil_4109_class").effect
    assert effect.slip == pytest.approx(other.cage_slip - fitted.cage_slip, rel=1e-3, abs=1e-6)
    assert effect.power == pytest.approx(other.shaft_power / fitted.shaft_power - 1.0, rel=1e-3, abs=1e-6)
    assert effect.life == pytest.approx(other.modified_rating_life / fitted.modified_rating_life - 1.0, rel=1e-3, abs=1e-6)


def test_lands_that_heat_themselves_take_their_part_off_the_power_loss(scenes):
    hot = settled_with(scenes, THICK_LANDS[0], "operating.shaft_speed=9000 rpm")
    found = exceedance(hot, "land_heating")
    lost = hot.land_power * (1.0 - heated_shear(found.value)) / hot.shaft_power
    assert found.grade is Grade.WARNING and found.effect.power == pytest.approx(-lost, rel=0.05)
    assert f"moves power loss by {100.0 * found.effect.power:+.2g} % (drag of lands that heat themselves)" in found.text


@pytest.mark.parametrize("nahme", [0.1, 1.0, 47.0])
def test_the_shear_of_oil_that_heats_itself_is_that_of_its_equations(nahme):
    """Couette flow with the viscosity exp(-theta) between walls of one temperature: theta'' = -Na s^2 exp(theta), s the shear stress."""

    def slopes(place, y, unknown):
        stress = unknown[0]
        return np.array([y[1], -nahme * stress**2 * np.exp(y[0]), stress * np.exp(y[0])])

    mesh = np.linspace(0.0, 1.0, 41)
    guess = np.array([np.zeros(41), np.zeros(41), mesh])
    solved = solve_bvp(slopes, lambda a, b, _: np.array([a[0], b[0], a[2], b[2] - 1.0]), mesh, guess, p=[0.5], tol=1e-8, max_nodes=20000)
    assert solved.success and heated_shear(nahme) == pytest.approx(solved.p[0], rel=1e-5)


def test_the_film_of_all_regimes_is_martins_where_bodies_are_rigid_and_near_dowson_and_toyodas_where_they_are_not():
    assert film_of_all_regimes(1e-10, 1e2, 1e-8) == pytest.approx(1.226 * 4.896 * 1e-10 / 1e-8, rel=0.03)  # h at the largest pressure
    for speed in (1e-11, 1e-10, 1e-9):
        for load in (1e-4, 1e-3):
            elastic = DOWSON_TOYODA.factor * speed**DOWSON_TOYODA.speed * 4e3**DOWSON_TOYODA.material * load**DOWSON_TOYODA.load
            assert film_of_all_regimes(speed, 4e3, load) == pytest.approx(elastic, rel=0.15)


def test_a_limit_without_effect_is_in_the_report_alone_and_one_whose_effect_is_not_known_is_a_warning(scenes):
    thick = settled_with(scenes, *VG_320, "life.a_iso=bath_17_14")  # kappa above 4, for which a_ISO is that of 4
    found = exceedance(thick, "viscosity_ratio")
    assert found.value > 4.0 and found.grade is Grade.NO_EFFECT and found.effect.life == 0.0
    assert "viscosity_ratio" not in repr(thick) and "moves no printed number" in found.text
    overloaded = settled_with(scenes, "operating.radial_load=800 kN")
    found = exceedance(overloaded, "hertz_pressure")
    assert found.grade is Grade.WARNING and found.effect is None and "effect not known" in found.text and "hertz_pressure" in repr(overloaded)


def test_an_ordinary_motor_gets_no_warning_and_its_notes_with_verbose(tmp_path):
    path = str(tmp_path / "motor.yaml")
    new = ["new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm", "--load", "5kN", "-o", path]
    assert CliRunner().invoke(main, new).exit_code == 0
    arguments = ["run", path, "--level", "steady", "--verbose", "--set", "lubricant.oil=ISO VG 320", "--set", "heat={law: none}"]
    plain, thick = (CliRunner().invoke(main, arguments[:each]) for each in (5, None))
    assert plain.exit_code == thick.exit_code == 0 and "warning:" not in plain.stderr
    notes = [line for line in thick.stderr.splitlines() if line.startswith("note: without effect: ")]
    assert notes and all("moves no printed number" in line for line in notes)


@pytest.mark.parametrize(
    ("effect", "moved"),
    [
        (Effect(4e-4, 0.019, 0.049, 0.19, 1e-3, "x"), []),
        (Effect(6e-4, 0.021, -0.051, 0.0, 1e-3, "x"), ["slip by +0.06 points", "life by +2.1 %", "power loss by -5.1 %"]),
        (Effect(6e-4, 0.021, 0.0, 0.0, 0.1, "x", is_of_life=True), []),
    ],
)
def test_a_number_has_moved_where_it_has_left_its_band(effect, moved):
    assert effect.moved == moved and (effect.size > 1.0) == bool(moved)


@pytest.mark.parametrize(
    "overrides, load, expected",
    [
        ((*VG_320, AVIATION_FIT, "lubricant.mixture_fraction=0.03"), 5e3, {"oil_4109_class", "oil_4109_base", "mixture_of_jet"}),
        ((), 700e3, {"hertz_pressure", "life_load", "static_load", "mixture_fraction"}),
    ],
)
def test_the_node_reports_a_law_outside_of_its_range_in_diagnostics_and_recording(scenes, overrides, load, expected):
    scene = load_scene(
        scenes["motor"], [*overrides, "input_limits.minimum_rate=0 Hz", "thresholds.life_warning=0", "thresholds.remaining_life_warning=0"]
    )
    sink, start = ListSink(), 1_700_000_000_000_000_000
    live = LiveModel(scene, warmed_up(scene), start)
    live.open("record", lambda start_ns: sink)
    began = time.monotonic()
    news = []
    while time.monotonic() - began < 20.0 and not expected <= {event.subject for event in news}:
        now = start + round((time.monotonic() - began) * 1e9)
        live.offer("shaft_speed", (314.0,), now, now)
        live.offer("radial_load", (load, 0.0), now, now)
        news += live.collect(now)
        time.sleep(0.02)
    condition = live.condition(now)
    live.record_diagnostics(condition, now)
    live.close()
    holding = {event.subject: event for event in condition.events if event.kind.startswith("validity.")}
    assert expected <= holding.keys() and condition.level >= Level.WARN
    for name, event in holding.items():
        assumed = BY_NAME[name].source.startswith("assumption")
        assert event.level is (Level.OK if assumed else Level.WARN) and event.action
        assert ("; assumption: effect not " if assumed else "; warning: effect not ") in event.reason
    assert expected <= {event.subject for event in sink.events} and expected <= {event.subject for event in sink.diagnostics[-1][1]}
    assert len([event for event in news if event.subject in expected]) == len(expected), "each is told once"


def block_of(scene, times, loads):
    """Return samples of made-up roller loads."""
    block = new_block(len(times), scene.bearing.roller.count)
    block[:] = still_sample(scene)[0]
    block["time"], block["inner_load"][:, 0], block["outer_load"][:, 0] = times, loads, loads
    return block


def test_a_warning_comes_once_and_goes_late(scenes):
    scene = load_scene(scenes["motor"])
    monitor = LimitsMonitor(scene)
    times = np.arange(0.0, 20.0, 0.05)
    loads = np.where((times > 2.0) & (times < 6.0) & (np.round(times * 5) % 2 == 0), 40e3, 1e3)  # flickers beyond 4 GPa
    changes = [
        (round(event.time, 1), event.level)
        for k in range(0, len(times), 7)
        for event in monitor.see(block_of(scene, times[k : k + 7], loads[k : k + 7]))
        if event.subject == "hertz_pressure"
    ]
    assert [level for _, level in changes] == [Level.WARN, Level.OK]
    assert 2.0 < changes[0][0] < 2.6 and 10.5 < changes[1][0] < 11.5
    assert monitor.worst["hertz_pressure"].value == pytest.approx(5.1, abs=0.3)
    assert not any(event.subject == "hertz_pressure" for event in monitor.events(20.0))
    monitor.restart()
    assert monitor.worst == {} and monitor.events(0.0) == []


def test_another_setting_continues_the_warnings_of_its_laws_ends_those_of_others_and_keeps_the_thresholds(scenes):
    scene = load_scene(scenes["motor"])
    other = load_scene(scene, [*CORRECTED, "table.maximum_load=4 kN"])
    monitor = LimitsMonitor(scene)

    def holding(now, load):
        monitor.see(block_of(scene, [now], [load]))
        return {event.subject for event in monitor.events(now)} & {"hertz_pressure", "table_correction"}

    assert holding(0.0, 40e3) == {"hertz_pressure"}
    monitor.follow(other)
    assert holding(1.0, 1e3) == {"hertz_pressure", "table_correction"}, "the pressure has not been back for 5 s"
    monitor.follow(scene)
    assert holding(2.0, 1e3) == {"hertz_pressure"} and holding(8.0, 1e3) == set()
    assert {"hertz_pressure", "table_correction"} <= monitor.worst.keys()
    monitor.adjust(load_scene(scene, ["thresholds.slip_from_speed=4000 rpm"]).thresholds)  # faster than the shaft
    monitor.follow(other)
    assert holding(9.0, 1e3) == set()


def test_samples_are_judged_at_most_ten_times_a_second(scenes, monkeypatch):
    scene, judged = load_scene(scenes["motor"]), []
    monitor = LimitsMonitor(scene)

    def counted_conditions(scene, block, params):
        judged.append(len(block))
        return Conditions(scene, block, params)

    monkeypatch.setattr("bearing_sim.watchers.monitoring.limits.Conditions", counted_conditions)
    for k in range(1000):
        monitor.see(block_of(scene, [k * 1e-3], [1e3]))
    assert sum(judged) == 10


def test_pressure_and_equivalent_load_are_those_of_a_hand_calculation(scenes):
    scene = load_scene(scenes["motor"])
    at = Conditions(scene, block_of(scene, [0.0], [2000.0]))
    radius, modulus = 1 / (1 / 5.5e-3 + 1 / 29.75e-3), 206e9 / (1 - 0.3**2)
    assert at.pressure[0] == pytest.approx(math.sqrt(2000.0 / 12e-3 * modulus / (2 * math.pi * radius)), rel=1e-9)
    sample = still_sample(scene)
    for reference in (3e3, 9e3):  # the radial load is 5 kN
        sample["reference_load"] = reference
        assert Conditions(scene, sample).equivalent_load[0] == max(reference, 5e3)


def test_a_thin_film_is_told_of_a_running_shaft_and_not_while_it_starts(scenes):
    scene = load_scene(scenes["motor"])  # runs at 3000 rpm
    block = block_of(scene, [0.0, 1.0, 2.0, 3.0], [1e3] * 4)
    block["viscosity_ratio"], block["shaft_speed"] = 0.05, np.array([0.0, 60.0, -2990.0, 3000.0]) * math.pi / 30
    judged = BY_NAME["thin_film"].value(Conditions(scene, block))
    np.testing.assert_array_equal(judged, [np.nan, np.nan, 0.05, 0.05])
    slow = load_scene(scenes["motor"], ["operating.shaft_speed=60 rpm"])  # and one that is meant to turn slowly is judged there
    assert BY_NAME["thin_film"].value(Conditions(slow, block))[1] == 0.05


def test_the_film_ratio_and_the_limits_see_the_same_contact_speeds(scenes):
    scene = load_scene(scenes["motor"], [ROUGH])
    block = Simulation(scene).advance(0.02, samples=2)
    at = Conditions(scene, block)
    assert np.all(at.rolling_speed > 5.0) and np.all(at.slide_to_roll < 0.1)
    assert np.all(ThinnestFilm(scene).least(block) > 0.0)


def test_cells_of_a_table_are_merged_and_counted():
    pressure, load = (Exceedance(BY_NAME[name], value, -math.inf, 4.0) for name, value in (("hertz_pressure", 5.0), ("life_load", 0.7)))
    assert cell([pressure, load]) == "hertz_pressure 5 GPa; life_load 0.7" and cell([]) == ""
    assert merged(["", "life_load 0.7", cell([pressure, load])]) == "hertz_pressure 5 GPa; life_load 0.7"
    first, second = counted([cell([pressure]), cell([pressure, load]), ""])
    assert first.startswith("2 x hertz_pressure: ") and second.startswith("1 x life_load: ")
    assert "the largest Hertz pressure is 5 GPa; expected at most 4 GPa" in first
    (spread,) = counted([cell([pressure]), cell([pressure._replace(value=9.0)])])
    assert "is 5 to 9 GPa; expected" in spread
    (profile,) = counted(["roller_profile"])
    assert "the rollers have no profile; expected a crown of the rollers" in profile


def events_of(path):
    """Return the events of a recording."""
    return [item for item in Recording(path) if isinstance(item, Event)]


def replayed(folder, scene, *options, load=5e3):
    """Replay 20 s at 3000 rpm with a burst of load from 5 to 8 s; return the result of click."""
    log, times = folder / "log.mcap", [0.2 * k for k in range(101)]
    write_log(log, [(time, 314.0) for time in times], [(time, load if 5.0 <= time <= 8.0 else 5e3, 0.0) for time in times])
    return CliRunner().invoke(main, ["replay", str(log), "--scene", scene, *options])


def test_a_replay_tells_a_burst_of_overload_and_records_when(scenes, tmp_path):
    result = replayed(tmp_path, scenes["motor"], "--json", "-o", str(tmp_path / "out.mcap"), load=700e3)
    report = json.loads(result.stdout)
    worst = {each["name"]: each for each in report["warnings"]}
    assert worst["hertz_pressure"]["value"] == pytest.approx(10.8, abs=0.3)
    assert worst["static_load"]["value"] == pytest.approx(700e3 / rate(load_scene(scenes["motor"]).bearing).static, rel=1e-6)
    assert "warning: hertz_pressure: " in result.stderr
    events = [(event.time, event.level) for event in events_of(tmp_path / "out.mcap") if event.subject == "hertz_pressure"]
    begin, end = events
    assert begin[0] == pytest.approx(5.0, abs=0.21) and begin[1] == Level.WARN
    assert end[0] == pytest.approx(13.0, abs=0.41) and end[1] == Level.OK, "5 s after the burst"


def test_a_calm_replay_is_silent(tmp_path):
    log, times = tmp_path / "log.mcap", [0.2 * k for k in range(26)]
    write_log(log, [(time, 4712.0) for time in times], [(time, 800.0, 0.0) for time in times])
    result = CliRunner().invoke(main, ["replay", str(log), "--scene", PAPER, "--json"])
    assert json.loads(result.stdout)["warnings"] == [] and "warning" not in result.stderr


def test_a_run_records_its_warnings(scenes, tmp_path):
    path = tmp_path / "run.mcap"
    arguments = ["run", scenes["motor"], "--duration", "0.05", "--set", "operating.radial_load=800 kN", "--out", str(path)]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    assert {"hertz_pressure", "static_load", "life_load"} <= {event.subject for event in events_of(path)}


def test_a_sweep_has_a_column_of_warnings(scenes, tmp_path):
    out = tmp_path / "sweep.parquet"
    arguments = ["sweep", scenes["motor"], "--vary", "operating.radial_load=5kN,40kN", "--duration", "0.02 s", "-o", str(out), "--workers", "1"]
    result = CliRunner().invoke(main, [*arguments, "--json"])
    report = json.loads(result.stdout)
    assert [("life_load" in row["warnings"]) for row in report["points"]] == [False, True]
    assert any(text.startswith("1 x life_load: ") for text in report["warnings"])
    assert "life_load 0.5664" in (tmp_path / "sweep.csv").read_text()


def test_a_reversed_shaft_is_judged_as_one_that_turns_forwards(scenes):
    found = [
        {each.law.name: each.value for each in outside(scene, Simulation(scene).advance(0.02, samples=3))}
        for scene in (load_scene(scenes["motor"], [f"operating.shaft_speed={sign}1500 rpm", "operating.radial_load=60 kN"]) for sign in ("", "-"))
    ]
    assert found[0].keys() == found[1].keys() >= {"oil_4109_speed", "life_load"}
    assert [found[1][name] for name in found[0]] == pytest.approx(list(found[0].values()), rel=0.02)


def test_at_rest_only_what_needs_no_motion_is_judged(scenes):
    scene = load_scene(scenes["motor"], ["operating.shaft_speed=0 rpm", "operating.radial_load=90 kN"])
    assert {each.law.name for each in outside(scene, still_sample(scene))} == {"mixture_fraction", "static_load"}


@pytest.mark.parametrize(
    ("fit", "applies"),
    [("interference=10 um", True), ("interference=0 um", False)],
)
def test_the_pressure_of_a_seat_is_judged_where_there_is_one_and_dimensions_are_those_of_the_cold_bearing(fit, applies):
    cold = load_scene(PAPER, ["bearing.dimensions_at=cold", f"mounting.shaft.{fit}"])
    assert BY_NAME["shaft_seat"].applies(cold) == applies
    assert not BY_NAME["shaft_seat"].applies(load_scene(PAPER))


@pytest.mark.parametrize(
    ("grease", "factor"),
    [
        ("{base_oil: ISO VG 100, nlgi: 2}", 350e3),
        ("{base_oil: ISO VG 460, nlgi: 2}", 175e3),
        ("{base_oil: ISO VG 100 PAO, nlgi: 2}", 500e3),
        ("{base_oil: ISO VG 460 PAO, nlgi: 2}", 250e3),
        ("{base_oil: ISO VG 460 PAO, nlgi: 2, speed_factor: 600000}", 600e3),
    ],
)
def test_a_grease_turns_as_fast_as_its_maker_says_or_as_is_usual_of_its_base_oil(grease, factor):
    assert BY_NAME["grease_speed"].limits(load_scene(PAPER, [f"lubricant={{grease: {grease}, temperature: 70 degC}}"]))[1] == factor


@pytest.mark.parametrize(
    ("value", "low", "high", "excess"), [(12.0, 0.0, 10.0, 0.2), (5.0, 10.0, 20.0, 0.5), (-3.0, -2.0, 1.0, 0.5), (2.0, -math.inf, 1.0, 1.0)]
)
def test_how_far_a_value_is_outside_counts_in_parts_of_the_limit_that_it_passes(value, low, high, excess):
    assert Exceedance(law=LAWS[0], value=value, low=low, high=high).excess == pytest.approx(excess)
