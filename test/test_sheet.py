# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The answer sheet: its lines against hand values and standards, on bearings of several sizes, types and lubricants."""

import math

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.cli.reporting import UsageError, refuse_idle_temperature
from bearing_sim.model.params import pack
from bearing_sim.scene.grease_life import relubrication_interval
from bearing_sim.scene.loader import load_scene, scene_to_yaml
from bearing_sim.studies.sheet import aligned_pressures, results, sheet
from bearing_sim.sweep.point import run_until_settled

BEARINGS = {  # designation -> supply, speed [rpm], load [N]; roller counts that are no multiple of anything in common
    "NU 210/C3": ("oil_bath", 3000.0, 5e3),
    "NJ 2308": ("oil_bath", 1450.0, 4e3),
    "NU 232": ("circulating", 1500.0, 60e3),
    "N 1014": ("oil_jet", 6000.0, 2e3),
    "NUP 308": ("grease", 1000.0, 6e3),
    "NCF 2928 V": ("oil_bath", 500.0, 30e3),
}


def scene_of(name: str, *overrides: str):
    supply, speed, load = BEARINGS[name]
    oil = {"grease": "lithium_mineral_nlgi_2"} if supply == "grease" else {"oil": "ISO VG 68", "supply": supply}
    operating = {"shaft_speed": f"{speed} rpm", "radial_load": f"{load} N"}
    tree = {"name": "tried", "bearing": name, "lubricant": {**oil, "temperature": "70 degC"}, "operating": operating, "life": {"method": "iso281"}}
    return load_scene(tree, list(overrides))


@pytest.fixture(scope="module", params=list(BEARINGS))
def found(request):
    scene = scene_of(request.param)
    return scene, results(scene, run_until_settled(scene).window)


def test_lives_and_safety_are_those_of_a_pocket_calculator(found):
    scene, numbers = found
    _, rpm, load = BEARINGS[scene.bearing.designation]
    dynamic, static = numbers["dynamic_rating"], numbers["static_rating"]
    assert numbers["l10_hours"] == pytest.approx(1e6 / (60 * rpm) * (dynamic / load) ** (10 / 3), rel=1e-6)
    assert numbers["static_safety"] == pytest.approx(static / load) and numbers["equivalent_load"] == pytest.approx(load)


def test_viscosities_give_kappa_by_iso_281(found):
    scene, numbers = found
    _, rpm, _ = BEARINGS[scene.bearing.designation]
    pitch = 1e3 * scene.bearing.pitch_diameter
    rated = 45_000 * rpm**-0.83 * pitch**-0.5 if rpm < 1000 else 4500 * rpm**-0.5 * pitch**-0.5
    assert numbers["rated_viscosity_mm2_s"] == pytest.approx(rated, rel=1e-3)
    full = numbers["films"]["full_viscosity_ratio"]
    assert numbers["viscosity_mm2_s"] / rated == pytest.approx(full, rel=1e-3) and numbers["viscosity_ratio"] <= full * 1.0001


def test_the_largest_pressure_of_a_straight_roller_is_that_of_hertz(found):
    scene, _ = found
    params = pack(load_scene(scene, ["bearing.roller.crown=none"]))
    load = 0.3 * scene.bearing.roller.length * scene.bearing.roller.diameter * 1e9 / 10  # some 3 kN for 10 x 10 mm
    for ring, sign in (("inner", 1), ("outer", -1)):
        raceway = scene.bearing.inner_raceway.radius if ring == "inner" else scene.bearing.outer_raceway.low_radius
        curvature = 2.0 / scene.bearing.roller.diameter + sign / raceway
        modulus = 2.06e11 / (2 * (1 - 0.3**2))  # of both steels
        hertz = math.sqrt(load / scene.bearing.roller.length * curvature * modulus / math.pi)
        whole, edge = aligned_pressures(load, ring, params)
        assert whole == pytest.approx(hertz, rel=2e-3) and edge == pytest.approx(whole, rel=1e-9)


def test_a_crown_takes_pressure_from_the_ends_to_the_middle(found):
    scene, _ = found
    straight, crowned = (pack(load_scene(scene, [f"bearing.roller.crown={each}"])) for each in ("none", "iso_log"))
    load = 0.02 * scene.bearing.ratings.static if scene.bearing.ratings.static else 1e3
    even, _ = aligned_pressures(load, "inner", straight)
    middle, edge = aligned_pressures(load, "inner", crowned)
    assert edge < even < middle


def test_the_sheet_has_what_an_engineer_looks_for_in_its_order(found):
    scene, numbers = found
    rows = [name for group in sheet(scene, numbers) for name, _ in group]
    wanted = ["bearing", "load ratings", "speed and load", "lubricant", "temperatures", "life", "by ISO 281", "by ISO/TS 16281", "static safety"]
    wanted += ["largest pressure", "largest roller load", "lubrication", "speed limits", "minimum load", "friction", "running clearance", "cage slip"]
    assert [each for each in rows if each in wanted] == wanted
    assert ("grease" in rows) == (scene.lubricant.grease is not None)
    text = " ".join(text for group in sheet(scene, numbers) for _, text in group)
    assert "nan" not in text and "e+0" not in text and scene.bearing.designation in text


def test_the_makers_moment_stands_beside_ours(found):
    scene, numbers = found
    rows = dict(row for group in sheet(scene, numbers) for row in group)
    if numbers["makers_moment"] is None:
        assert "makers' moment" not in rows and numbers["no_makers_moment"]
    else:
        assert 0.2 < numbers["friction_moment"] / numbers["makers_moment"] < 4.0 and "SKF" in rows["makers' moment"]


def test_parts_of_the_friction_add_up_as_printed(found):
    scene, numbers = found
    text = dict(row for group in sheet(scene, numbers) for row in group)["friction"]
    total, parts = text.split(" W: ")
    printed = [float(part.split()[-1].replace(",", "")) for part in parts.replace(", ", ";").split(";")]
    whole = float(total.split()[-1].replace(",", ""))
    decimals = len(total.rpartition(".")[2]) if "." in total.rpartition(",")[2] else 0
    assert abs(sum(printed) - whole) <= 0.5 * 10.0**-decimals * (len(printed) + 1) * 1.001


def test_a_bearing_at_rest_has_no_film_no_slip_and_no_number_that_is_none():
    scene = scene_of("NU 210/C3", "operating.shaft_speed=0 rpm", "life.a_iso=bath_17_14")
    numbers = results(scene, run_until_settled(scene).window)
    rows = dict(row for group in sheet(scene, numbers) for row in group)
    assert rows["lubrication"].startswith("no film") and rows["cage slip"].startswith("none") and rows["friction"].startswith("none")
    assert not any("nan" in text for text in rows.values())


@pytest.mark.parametrize(
    ("name", "rpm", "celsius", "expected"),
    [
        ("NU 210", 1500.0, 70.0, 5 * (14e6 / (1500 * math.sqrt(50)) - 4 * 50)),
        ("NU 210", 1500.0, 85.0, 2.5 * (14e6 / (1500 * math.sqrt(50)) - 4 * 50)),
        ("NU 210", 3000.0, 55.0, 10 * (14e6 / (3000 * math.sqrt(50)) - 4 * 50)),
        ("NU 210", 3000.0, 20.0, 10 * (14e6 / (3000 * math.sqrt(50)) - 4 * 50)),  # doubled once at most
        ("NU 210 MA", 1500.0, 70.0, 2.5 * (14e6 / (1500 * math.sqrt(50)) - 4 * 50)),
        ("NU 210", 10.0, 70.0, 30_000.0),
        ("NU 232", 3000.0, 70.0, 0.0),
    ],
)
def test_the_relubrication_interval_by_hand(name, rpm, celsius, expected):
    scene = load_scene(
        {
            "name": "greased",
            "bearing": name,
            "lubricant": {"grease": "lithium_mineral_nlgi_2", "temperature": "70 degC"},
            "operating": {"shaft_speed": "1000 rpm", "radial_load": "5 kN"},
        }
    )
    found = relubrication_interval(scene, rpm * math.pi / 30, celsius + 273.15)
    assert found.hours == pytest.approx(max(min(expected, 30_000.0), 0.0), rel=1e-9)


def test_heat_of_an_equilibrium_is_the_friction_and_a_colder_inner_ring_is_said():
    scene = scene_of("NU 210/C3", "heat={law: network}", "mounting.shaft.fit=k5")
    from bearing_sim.simulation import Simulation
    from bearing_sim.sweep.thermal import begin_in_equilibrium

    run = Simulation(scene)
    begin_in_equilibrium(run, 0.2, 5.0)
    window = np.concatenate([run.advance(0.05, samples=20) for _ in range(4)])
    numbers = results(scene, window)
    assert numbers["heat_to_oil_w"] + numbers["heat_to_ambient_w"] == pytest.approx(numbers["shaft_power"], rel=1e-9)
    rows = dict(row for group in sheet(scene, numbers) for row in group)
    assert "colder than the outer" in rows["rings"] and "heated shaft" in rows["rings"]
    warm = load_scene(scene, ["heat.shaft.back=20 mm", "heat.shaft.back_temperature=140 degC"])
    assert "heated shaft" not in dict(row for group in sheet(warm, numbers) for row in group)["rings"]


@pytest.mark.parametrize("command", ["run", "loads", "uncertainty", "study friction", "sweep"])
def test_an_oil_temperature_that_the_network_computes_is_refused_where_it_would_do_nothing(command, tmp_path):
    file = tmp_path / "bath.yaml"
    file.write_text(scene_to_yaml(scene_of("NU 210/C3", "heat={law: network}")))
    given = (
        ["--vary", "lubricant.temperature=0degC:60degC:2", "-o", str(tmp_path / "s")]
        if command == "sweep"
        else ["--set", "lubricant.temperature=0degC"]
    )
    refused = CliRunner().invoke(main, [*command.split(), str(file), *given])
    assert refused.exit_code == 2 and "heat.law network computes how warm it gets" in refused.output and "heat.law=none" in refused.output


def test_an_oil_temperature_counts_where_oil_flows_through_or_nothing_computes_it():
    flowing = scene_of("NU 232", "heat={law: network}", "lubricant.temperature=20 degC")
    refuse_idle_temperature(flowing, ["lubricant.temperature=20 degC"])
    refuse_idle_temperature(scene_of("NU 210/C3"), ["lubricant.temperature=20 degC"])
    with pytest.raises(UsageError):
        refuse_idle_temperature(scene_of("NU 210/C3", "heat={law: network}"), ["lubricant.temperature=20 degC"])


@pytest.mark.parametrize("designation", ["NU 210 ECX", "NU 99999", "our own 7"])
def test_a_designation_that_nobody_can_read_takes_no_rule_of_a_series_and_stops_nothing(designation):
    tree = {"name": "tried", "bearing": "NJ 2308", "lubricant": {"grease": "lithium_mineral_nlgi_2", "temperature": "70 degC"}}
    tree["operating"] = {"shaft_speed": "1000 rpm", "radial_load": "4 kN", "axial_load": "1.5 kN"}
    scene = load_scene(tree, [f"bearing.designation={designation!r}"])
    numbers = results(scene, run_until_settled(scene).window)
    assert numbers["equivalent_load"] == pytest.approx(0.92 * 4e3 + 0.6 * 1.5e3), "that of series 2, which is the larger one"
    assert numbers["makers_moment"] is None and "want of a designation" in dict(row for group in sheet(scene, numbers) for row in group)["axial load"]
