# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What guides the cage: which scenes fit, what each guidance does to slip, and that pockets which guide hold the cage."""

import math

import numpy as np
import pytest

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.model.params import pack
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

OUTSIDE = "bearing.cage.outer_radius=33.35 mm"
INNER = ["bearing.cage.guidance=inner_ring", OUTSIDE]
ROLLER = ["bearing.cage.guidance=roller", OUTSIDE]
ROUND = ["bearing.outer_raceway.d_value=0", "bearing.outer_raceway.low_radius=34.87 mm"]


def scene(*overrides):
    return load_scene("deng2017_table1", overrides)


def settled(level, *overrides):
    run = Simulation(scene(f"level={level}", *overrides))
    run.advance(0.15)
    return run.advance(0.1, samples=200)


def test_bundled_bearings_are_guided_on_the_outer_ring():
    for name in ("deng2017_table1", "deng2017_table2"):
        cage = load_scene(name).bearing.cage
        assert cage.guidance == "outer_ring" and cage.land_radius == 33.5e-3
        assert cage.outside == pytest.approx(33.35e-3) and cage.bore == 29.6e-3


@pytest.mark.parametrize(
    ("given", "land", "bore", "outside"),
    [
        (INNER, 29.45e-3, 29.6e-3, 33.35e-3),  # the bore says where the lands are
        ([*INNER, "bearing.cage.inner_radius=null", "bearing.cage.guide_radius=29 mm"], 29e-3, 29.15e-3, 33.35e-3),
        ([*INNER, "bearing.cage.guide_radius=29.45 mm"], 29.45e-3, 29.6e-3, 33.35e-3),
        (["bearing.cage.guide_radius=null", OUTSIDE], 33.5e-3, 29.6e-3, 33.35e-3),
        (ROLLER, math.nan, 29.6e-3, 33.35e-3),
    ],
)
def test_surface_and_lands_follow_from_each_other(given, land, bore, outside):
    cage = scene(*given).bearing.cage
    assert (cage.land_radius, cage.bore, cage.outside) == pytest.approx((land, bore, outside), nan_ok=True)
    assert scene_from_yaml(scene_to_yaml(scene(*given))) == scene(*given)


def test_oil_drags_at_the_faces_that_run_on_no_lands():
    widths = {name: pack(scene(*given)).cage for name, given in (("outer", []), ("inner", INNER), ("roller", ROLLER))}
    found = {name: (round(1e3 * cage.outer_width, 9), round(1e3 * cage.inner_width, 9), cage.guide_width) for name, cage in widths.items()}
    assert found == {"outer": (7.0, 12.0, 5e-3), "inner": (12.0, 7.0, 5e-3), "roller": (12.0, 12.0, 0.0)}


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (["bearing.cage.guidance=inner_ring"], "outer_radius: missing; a cage with guidance inner_ring needs it"),
        (["bearing.cage.guidance=roller"], "outer_radius: missing; a cage with guidance roller needs it"),
        (["bearing.cage.guidance=rollers"], "'outer_ring', 'inner_ring', 'roller' or 'full_complement'"),
        (["bearing.cage.guide_radius=null"], "needs the radius of its lands, or outer_radius"),
        (["bearing.cage.guide_clearance=null"], "guide_clearance: missing"),
        ([OUTSIDE, "bearing.cage.guide_radius=33.6 mm"], "leave it at 33.45 mm; give one of outer_radius and guide_radius"),
        ([*INNER, "bearing.cage.guide_radius=29 mm"], "inner_radius: 29.6 mm, but lands at guide_radius 29 mm .* leave it at 29.15 mm"),
        ([*INNER, "bearing.cage.inner_radius=32 mm"], "lands of the inner ring lie inside the pitch circle .31.375 mm., found 31.85 mm"),
        (["bearing.cage.guide_radius=31 mm"], "lands of the outer ring lie outside the pitch circle .*set guidance: inner_ring"),
        ([*INNER, "bearing.cage.inner_radius=27 mm"], "cage's bore, at 27 mm, cuts into the inner raceway"),
        (["bearing.cage.guide_radius=35.5 mm"], "outer surface, at 35.35 mm, cuts into the outer raceway .34.8625 mm"),
        ([*ROLLER, "bearing.cage.inner_radius=33.4 mm"], "lies outside its outer surface"),
        ([*ROLLER, "bearing.cage.guide_clearance=0.1 mm"], "guide_clearance: a cage with guidance roller has no lands; leave it out"),
        ([*ROLLER, "bearing.cage.assumed_eccentricity=0.5"], "no lands to be eccentric in"),
        (["bearing.cage.pocket_radial_clearance=0.1 mm"], "lands guide this cage .outer_ring.; leave it out, or set guidance: roller"),
        ([*ROLLER, "bearing.cage.pocket_radial_clearance=40 um"], "lobes move the rollers outwards and inwards by 49 um"),
        ([*ROLLER, "bearing.cage.pocket_radial_clearance=2 mm"], "lets the cage touch a raceway, 1.5125 mm away, before its guidance stops it"),
    ],
)
def test_a_cage_that_does_not_fit_is_refused_with_what_to_do(given, expected):
    with pytest.raises(SceneError, match=expected):
        scene(*given)


@pytest.mark.parametrize("level", ["slip", "planar"])
@pytest.mark.parametrize("load", [100.0, 800.0])
def test_a_cage_guided_on_the_inner_ring_slips_less_than_one_on_lands_of_the_outer_ring(level, load):
    # same clearance, width and friction; the ring that turns with the shaft drives the cage where the other brakes it
    outer, inner = (settled(level, f"operating.radial_load={load} N", *given)["cage_slip"].mean() for given in ([], INNER))
    assert inner < outer - 0.0015


def test_without_traction_lands_of_the_inner_ring_pull_the_cage_and_those_of_the_outer_ring_hold_it():
    still = ["lubricant.traction_scale=0", "lubricant.mixture_fraction=0", "bearing.cage.pocket_friction=0"]
    outer, inner, none = (settled("slip", *still, *given)["cage_speed"].mean() for given in ([], INNER, ROLLER))
    assert outer < none < inner


def test_at_level_slip_lands_lose_their_torque_times_the_speed_at_which_they_slide():
    run = Simulation(scene(*INNER))
    run.advance(0.01)
    cage_speed, shaft_speed = run.sample["cage_speed"], run.inputs.shaft_speed
    slope = 2 * math.pi * run._lubrication.viscosity * 29.45e-3**3 * 5e-3 / 0.15e-3
    assert run.sample["land_power"] == pytest.approx(slope * (shaft_speed - cage_speed) ** 2, rel=1e-9)
    assert Simulation(scene(*ROLLER)).advance(0.01)["land_power"][0] == 0.0


@pytest.mark.parametrize("raceway", [[], ROUND], ids=["lobed", "round"])
@pytest.mark.parametrize("clearance", [0.06, 0.1, 0.2])
def test_pockets_that_guide_keep_the_cages_centre_within_their_play(clearance, raceway):
    run = Simulation(scene("level=planar", *ROLLER, f"bearing.cage.pocket_radial_clearance={clearance} mm", *raceway))
    block = run.advance(0.1, samples=1000)
    reach = 1e3 * np.hypot(block["cage_y"], block["cage_z"]).max()
    lift = 0.0 if raceway else 0.049  # rollers give way by half the D value
    assert reach < clearance + lift + 5e-3
    assert block["land_power"].max() == 0.0 and block["land_eccentricity"].max() == pytest.approx(reach / clearance)


def test_pockets_with_walls_along_the_orbit_alone_would_let_the_cage_go():
    """Why a cage without lands needs more than the pockets of one that has them: rollers shift along the orbit with the cage."""
    run = Simulation(scene("level=planar", *ROLLER, "bearing.cage.pocket_radial_clearance=1.5 mm"))
    block = run.advance(0.02, samples=200)
    assert np.hypot(block["cage_y"], block["cage_z"]).max() > 10 * 0.1e-3  # many times the clearance along the orbit


@pytest.mark.parametrize("given", [INNER, ROLLER], ids=["inner ring", "roller"])
def test_rough_courses_stay_finite(given):
    for overrides in (["operating.shaft_speed=-20000 rpm"], ["bearing.outer_raceway.low_radius=34.89 mm", "operating.radial_load=0"]):
        run = Simulation(scene("level=planar", *given, *overrides))
        end = run.inputs._replace(load_z=3000.0, shaft_speed=-run.inputs.shaft_speed)
        for target in (end, run.inputs):
            block = run.advance(0.03, target, samples=30)
            for name in ("cage_speed", "cage_y", "roller_spin", "inner_load", "outer_load", "pocket_force", "damage"):
                assert np.isfinite(block[name]).all(), name
            assert block["land_eccentricity"].max() < 1.6
