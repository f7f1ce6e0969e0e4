# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Axial load by the rules of makers: lives and loads against printed examples, limits of flanges by hand, and what has no number."""

import json
import math
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.model.params import pack
from bearing_sim.model.validity import counted
from bearing_sim.physics.rating_life import equivalent_load
from bearing_sim.scene.axial_load import axial_limits, equivalent_load_law, other_axial_limits, strength_limit
from bearing_sim.scene.loader import load_scene, scene_to_yaml
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.sheet import results, sheet
from bearing_sim.studies.spectrum import mean_speed_and_load
from bearing_sim.studies.statics import statics
from bearing_sim.sweep.conditions import OperatingPoint, combined_life
from bearing_sim.sweep.point import point_row, run_until_settled

RPM = math.pi / 30


def scene_of(bearing, rpm, radial, axial=0.0, *overrides, supply="oil_bath"):
    """Return a scene of a catalogue bearing at level steady; loads in N."""
    oil = {"grease": "lithium_mineral_nlgi_2"} if supply == "grease" else {"oil": "ISO VG 68", "supply": supply}
    tree = {
        "name": "loaded",
        "level": "steady",
        "bearing": bearing,
        "lubricant": {**oil, "temperature": "70 degC"},
        "operating": {"shaft_speed": f"{rpm} rpm", "radial_load": f"{radial} N", "axial_load": f"{axial} N"},
    }
    return load_scene(tree, list(overrides))


# Worked examples of makers and textbooks.  The life of a roller bearing depends on C, P and n alone, so any scene serves for those of other types.
LIVES = {  # source -> C [kN], P [kN], rpm, printed life [h], relative rounding of the print
    "SKF, General catalogue (2006), p. 81, example 5, interval 1": (540, 200, 50, 9136, 1e-4),
    "SKF, General catalogue (2006), p. 81, example 5, interval 2": (540, 125, 300, 7295, 1e-4),
    "SKF, General catalogue (2006), p. 81, example 5, interval 3": (540, 75, 400, 30030, 1e-4),
    "SKF, General catalogue (2006), p. 81, example 5, interval 4": (540, 50, 200, 232040, 1e-4),
    "KRW, delivery programme, p. 112: 23220EAS under 30 kN radial and 19 kN axial": (466, 90.2, 500, 7945, 3e-3),
    "NTN, Ball and roller bearings, p. A-44, example 3: a cylindrical one for 20,000 h": (1313, 200, 450, 20000, 0.025),
    "NTN, Ball and roller bearings, p. A-44, example 4: bearing I, no axial load counts": (30.5, 5.98, 2000, 1900, 0.01),
    "NTN, Ball and roller bearings, p. A-44, example 4: bearing II, 4.18 kN radial and 1.45 kN axial": (36.0, 4.67, 2000, 7550, 0.01),
    "NSK, Rolling bearings (E1102), p. A35, example 5: 1,569 N radial and 3,474 N axial": (38.0, 3.164, 600, 109750, 0.01),
    "NSK, Rolling bearings (E1102), p. A35, example 5: 3,931 N radial": (43.0, 3.931, 600, 80400, 0.01),
    "NSK, Rolling bearings (E1102), p. A36, example 6: 245 kN radial and 2.1 x 49 kN axial for f_h = 3": (
        2350,
        347.9,
        500,
        500 * 3 ** (10 / 3),
        5e-3,
    ),
    "Shigley, Mechanical engineering design, 8th ed., problem 11-3: 1,440e6 revolutions": (91.1, 10.279, 480, 50000, 3e-3),
}


@pytest.mark.parametrize("source", LIVES)
def test_the_life_is_that_of_a_printed_example(source):
    dynamic, load, rpm, printed, rounding = LIVES[source]
    scene = scene_of("NUP 232", rpm, 1e3 * load, 0.0, f"bearing.ratings.dynamic={dynamic} kN")
    assert statics(scene, 30).lives.l10 == pytest.approx(printed, rel=rounding)


def test_the_life_of_an_nup_by_ntn_leaves_out_the_axial_load():
    """NTN, Ball and roller bearings, p. A-45, example 6: NUP312 with oil, 10 kN radial, 2,000 rpm, at most 0.4 F_r axial: 51,000 h."""
    ratings = "bearing.ratings.dynamic=137 kN", "bearing.ratings.axial_load=none"
    lives = statics(scene_of("NUP 312", 2000, 10e3, 4e3, *ratings), 30).lives
    assert lives.l10 == pytest.approx(51000, rel=0.01) and lives.equivalent_load == pytest.approx(10e3)
    beyond = json.loads(CliRunner().invoke(main, ["loads", *_file(scene_of("NUP 312", 2000, 10e3, 4.1e3, *ratings)), "--json"]).stdout)
    assert beyond["l10_hours"] is None and not beyond["axial_load_within_rule"], "NTN: F_a max 0.4 F_r"


def test_the_equivalent_load_of_an_nj_by_krw_is_the_printed_one():
    """KRW, delivery programme, p. 125: NJ220E, 30 kN radial, 6 kN axial: 0.93 F_r + 0.69 F_a = 32 kN, because 0.2 is above 0.11."""
    scene = scene_of("NJ 220 E", 500, 30e3, 6e3, "bearing.ratings.axial_load=krw")
    assert round(equivalent_load(30e3, pack(scene).life) / 1e3) == 32


def test_equivalent_and_mean_load_of_a_spectrum_with_axial_loads_are_the_printed_ones():
    """NTN, Ball and roller bearings, p. A-45, example 5: a spherical roller bearing with e 0.17, X 0.67, Y 5.81; mean load 50.0 kN."""
    radial, axial, speeds, shares = [10, 12, 20, 25, 30], [2, 4, 6, 7, 10], [1200, 1000, 800, 600, 400], [5, 10, 60, 15, 10]
    laws = [SimpleNamespace(axial_load=each, axial_limit=0.17, radial_factor=0.67, axial_factor=5.81) for each in axial]
    loads = [getattr(equivalent_load, "py_func", equivalent_load)(each, law) for each, law in zip(radial, laws)]
    assert loads == pytest.approx([18.3, 31.3, 48.3, 57.4, 78.2], abs=0.05)
    assert round(mean_speed_and_load(speeds, loads, shares)[1], 1) == 50.0


def test_the_rating_that_a_spectrum_needs_is_the_printed_one():
    """U. C. Jindal, Machine Design, example 18-9, p. 512: a ball bearing for 10,000 h, 34,219 N by the companion to the book, which rounds P_m."""
    speed, load = mean_speed_and_load([1440.0, 1080.0, 720.0], [3e3, 4e3, 5e3], [0.25, 0.5, 0.25], exponent=3.0)
    assert load * (10_000 * 60 * speed / 1e6) ** (1 / 3) == pytest.approx(34219, abs=0.5)


def test_the_life_of_a_spectrum_and_its_static_safety_are_the_printed_ones():
    """SKF, General catalogue (2006), p. 81, example 5: 84,300 h, and 815 kN over 500 kN."""
    points = [OperatingPoint(1.0, 1.0, weight) for weight in (0.05, 0.40, 0.45, 0.10)]
    assert combined_life([11050.0, 57260.0, 1318000.0, 11600000.0], points) == pytest.approx(84300, rel=5e-4)
    scene = scene_of("NUP 232", 500, 500e3, 0.0, "bearing.ratings.static=815 kN")
    assert round(statics(scene, 30).lives.static_safety, 2) == 1.63


# e and Y by SKF, NKE and ZVL: 0.2 and 0.6 in series 10, 2, 3 and 4, 0.3 and 0.4 in the others; X 0.92.
SERIES = {"NJ 1010": (0.2, 0.6), "NJ 210": (0.2, 0.6), "NUP 312": (0.2, 0.6), "NJ 2308": (0.3, 0.4), "NJ 2210": (0.3, 0.4), "NCF 2928 V": (0.3, 0.4)}


@pytest.mark.parametrize("bearing", SERIES)
def test_the_axial_load_counts_from_e_on_by_skf(bearing):
    (limit, factor), radial = SERIES[bearing], 5e3
    for share in (0.0, 0.19, 0.25, 0.31, 0.5):
        lives = statics(scene := scene_of(bearing, 1000, radial, share * radial), 30).lives
        expected = radial if share <= limit else (0.92 + factor * share) * radial
        assert lives.equivalent_load == pytest.approx(expected)
        assert lives.static_safety == pytest.approx(rate(scene.bearing).static / radial), "P_0 = F_r"
        unloaded = statics(scene_of(bearing, 1000, radial), 30).lives
        assert lives.l10 / unloaded.l10 == pytest.approx((radial / expected) ** (10 / 3)) and lives.l10r == pytest.approx(unloaded.l10r)


def test_the_series_is_not_known_without_a_designation_and_the_larger_load_is_taken():
    scene = load_scene("deng2017_table1", ["bearing.flanges={inner: one, outer: both}", "operating.axial_load=300 N"])
    law = equivalent_load_law(scene.bearing)
    assert (law.limit, law.axial_factor) == (0.2, 0.6) and "want of a designation" in law.rule


@pytest.mark.parametrize(
    "bearing, supply, heat, strength",
    [  # F_ap = k_1 C_0 10^4/(n (d + D)) - k_2 F_r at 1,500 rpm and 20 kN, and 0.0045 D^1.5 or 0.0023 D^1.7, all in kN and mm
        ("NJ 210 ECP", "oil_bath", 1.5 * 69.5e4 / (1500 * 140) - 0.15 * 20, 0.0045 * 90**1.5),
        ("NJ 210 ECP", "grease", 1.0 * 69.5e4 / (1500 * 140) - 0.10 * 20, 0.0045 * 90**1.5),
        ("NJ 2308 ECP", "oil_bath", 1.5 * 120e4 / (1500 * 130) - 0.15 * 20, 0.0023 * 90**1.7),
        ("NCF 2928 V", "oil_bath", 1.0 * 390e4 / (1500 * 330) - 0.30 * 20, 0.0023 * 190**1.7),
        ("NCF 2928 V", "grease", 0.5 * 390e4 / (1500 * 330) - 0.15 * 20, 0.0023 * 190**1.7),
        ("NJ 232 ECM", "oil_bath", 1.5 * 7.5 * 680 ** (2 / 3) * 1e4 / (1500 * 450) - 0.15 * 20, 0.0045 * 290**1.5),  # pi B (d + D) > 50,000 mm^2
    ],
)
def test_what_flanges_may_carry_by_skf_is_that_of_a_pocket_calculator(bearing, supply, heat, strength):
    scene = scene_of(bearing, 1500, 20e3, 1e3, supply=supply)
    by_heat, by_strength, brief, shock = axial_limits(scene, 1500 * RPM, 20e3, 2.5)
    assert by_heat.force == pytest.approx(1e3 * heat) and by_strength.force == pytest.approx(1e3 * strength)
    least = 1e3 * min(heat, strength)
    assert (brief.force, shock.force) == (pytest.approx(2 * least), pytest.approx(3 * least))


def test_both_formulas_of_the_limit_by_heat_meet_at_420_kn():
    """C_0 = 7.5 C_0^(2/3) at 7.5^3 kN = 422 kN, where SKF's large bearings begin."""
    small, large = (
        axial_limits(scene_of(name, 1500, 1e3, 100.0, "bearing.ratings.static=421.875 kN"), 100.0, 0.0, 2.5)[0] for name in ("NJ 220", "NJ 232")
    )
    assert small.force * (100 + 180) == pytest.approx(large.force * (160 + 290))


@pytest.mark.parametrize(
    "rpm, kappa, overrides, reason",
    [
        (0.0, 2.5, [], "at rest"),
        (1500.0, 1.99, [], "kappa 2, below 2"),
        (1500.0, 2.5, ["level=spatial", "operating.misalignment=0.4 mrad"], "misalignment of 0.4 mrad"),
    ],
)
def test_outside_of_its_range_the_limit_by_heat_has_a_reason_and_no_number(rpm, kappa, overrides, reason):
    scene = scene_of("NJ 210", 1500, 5e3, 1e3, *overrides)
    by_heat, by_strength, brief, _ = axial_limits(scene, rpm * RPM, 5e3, kappa)
    assert math.isnan(by_heat.force) and reason in by_heat.reason and brief.force == pytest.approx(2 * by_strength.force)


def test_other_makers_limit_flanges_by_their_own_laws():
    """Schaeffler, HR 1, p. 49 (k_S 10 in a bath, k_B 23 in series 3), and NSK, E1102, equations 5.34 and 5.35 (k 1 in series 3), by hand."""
    d_m, rpm = 95.0, 2000.0
    schaeffler, nsk = other_axial_limits(scene_of("NUP 312", rpm, 10e3, 1e3), rpm * RPM, 2.5)
    assert schaeffler.force == pytest.approx(10 * 23 * d_m**1.5 * rpm**-0.6)
    assert nsk.force == pytest.approx(9.8 * (490 * 60**2 / 3000 - 0.000135 * 60**3.4))
    slow = other_axial_limits(scene_of("NUP 312", 1, 10e3, 1e3), 1 * RPM, 2.5)[0]
    at_rest = other_axial_limits(scene_of("NUP 312", 1, 10e3, 1e3), 0.0, math.nan)[0]
    assert slow.force == at_rest.force == pytest.approx(0.075 * 23 * d_m**2.1), "limited by the pressure on the flanges"
    schaeffler, nsk = other_axial_limits(scene_of("NUP 312", rpm, 10e3, 1e3, supply="grease"), rpm * RPM, 2.5)
    assert math.isnan(schaeffler.force) and "grease" in schaeffler.reason
    assert nsk.force == pytest.approx(9.8 * (900 * 60**2 / 3500 - 0.023 * 60**2.5))
    assert all(math.isnan(each.force) and each.reason for each in other_axial_limits(scene_of("NJ 1010", rpm, 10e3, 1e3), rpm * RPM, 2.5))


@pytest.mark.parametrize(
    "bearing, supply, kappa, factors",
    [  # k_S, the least of each range, and k_B
        ("NJ 210", "oil_air", 2.5, 7.5 * 18),
        ("NJ 2210", "oil_jet", 2.5, 12 * 18),
        ("NUP 2312", "circulating", 2.5, 12 * 23),
        ("NUP 312", "oil_bath", 0.5, 7.5 * 23),
        ("NCF 2928 V", "oil_bath", 2.5, 10 * 11),
        ("NCF 3028 V", "oil_bath", 2.5, 10 * 17),
        ("NCF 2228 V", "oil_bath", 2.5, 10 * 20),
    ],
)
def test_schaefflers_factors_are_those_of_its_tables(bearing, supply, kappa, factors):
    scene = scene_of(bearing, 1000, 10e3, 1e3, supply=supply)
    d_m = 500 * (scene.bearing.bore_diameter + scene.bearing.outside_diameter)
    assert other_axial_limits(scene, 1000 * RPM, kappa)[0].force == pytest.approx(factors * d_m**1.5 * 1000**-0.6)


@pytest.mark.parametrize(
    "bearing, limit, factor", [("NJ 210", 0.11, 0.69), ("NUP 2312", 0.17, 0.45), ("NCF 2928 V", 0.17, 0.45), ("NCF 3028 V", 0.23, 0.33)]
)
def test_the_factors_by_krw_are_those_of_its_table(bearing, limit, factor):
    law = equivalent_load_law(scene_of(bearing, 1000, 10e3, 1e3, "bearing.ratings.axial_load=krw").bearing)
    assert (law.limit, law.radial_factor, law.axial_factor, law.largest_ratio) == (limit, 0.93, factor, 0.4)


@pytest.mark.parametrize("bearing", ["NJ 210", "NJ 216", "NUP 312", "NJ 320", "NJ 224"])
def test_three_makers_permit_loads_of_one_size(bearing):
    scene = scene_of(bearing, 1500, 5e3, 1e3)
    heat = axial_limits(scene, 1500 * RPM, 5e3, 2.5)[0].force
    loads = [min(heat, strength_limit(scene.bearing)), *(each.force for each in other_axial_limits(scene, 1500 * RPM, 2.5))]
    assert max(loads) < 3.5 * min(loads)


def _file(scene) -> list[str]:
    """Write a scene into the current folder and return the arguments of a command that reads it."""
    Path("tried.yaml").write_text(scene_to_yaml(scene))
    return ["tried.yaml"]


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_sheet_has_p_its_rule_the_limits_and_what_the_life_by_laminae_counts():
    scene = scene_of("NJ 210 ECP/C3", 3000, 5e3, 1.7e3, "life.method=iso281")
    numbers = results(scene, run_until_settled(scene).window)
    rows = dict(row for group in sheet(scene, numbers) for row in group)
    assert numbers["equivalent_load"] == pytest.approx(0.92 * 5e3 + 0.6 * 1.7e3) and numbers["axial_load_permitted"]
    assert numbers["life_hours"] == pytest.approx(1e6 / (60 * 3000) * (73.5 / 5.62) ** (10 / 3), rel=1e-3)
    assert "by the radial and the axial load on the bearing" in rows["life"]
    assert "P 5.62 kN by SKF: 0.92 F_r + 0.6 F_a" in rows["axial load"] and "level spatial counts the moment" in rows["axial load"]
    assert rows["flanges may carry"].startswith("by heat 1.73 kN; by strength, all the time 3.84 kN") and ": met; " in rows["flanges may carry"]
    assert "Schaeffler 864 N (exceeded)" in rows["flanges may carry"]


@pytest.mark.parametrize("method, unknown", [("iso281", True), ("iso16281", False)])
def test_beyond_half_the_radial_load_there_is_no_p_and_no_life_by_it(method, unknown):
    at, beyond = (scene_of("NJ 210", 3000, 5e3, load, f"life.method={method}") for load in (2500.0, 2510.0))
    window = run_until_settled(beyond).window
    numbers = results(beyond, window)
    assert math.isnan(numbers["equivalent_load"]) and math.isnan(numbers["l10_hours"]) and numbers["l10r_hours"] > 1e3
    assert math.isnan(numbers["life_hours"]) == unknown
    rows = dict(row for group in sheet(beyond, numbers) for row in group)
    assert "no P: F_a/F_r 0.5" in rows["axial load"] and "EXCEEDED" in rows["flanges may carry"] and "nan" not in " ".join(rows.values())
    row = point_row(beyond)
    assert math.isnan(row["l10"]) and "flange_axial_ratio" in row["warnings"] and math.isnan(row["rating_life"]) == unknown
    assert not math.isnan(point_row(at)["l10"])


def test_at_level_spatial_the_life_by_laminae_counts_the_moment_of_the_axial_load():
    options = "level=spatial", "bearing.roller.crown=iso_log"
    with_load, without = (scene_of("NJ 210 ECP/C3", 3000, 5e3, load, *options) for load in (2e3, 0.0))
    numbers, reference = (results(scene, run_until_settled(scene, 0.05).window) for scene in (with_load, without))
    assert numbers["l10r_hours"] < 0.98 * reference["l10r_hours"]
    assert "L10r counts the moment of the axial load" in dict(row for group in sheet(with_load, numbers) for row in group)["axial load"]


def test_a_sweep_says_where_the_load_is_below_the_makers_minimum():
    """k_r (6 + 4 n/n_r)(d_m/100 mm)^2 of an NU 210 at 3,000 rpm, 553 N by the catalogue's k_r 0.15 and n_r 8,500 rpm."""
    least = 0.15e3 * (6 + 4 * 3000 / 8500) * 0.7**2
    scene = scene_of("NU 210", 3000, 0.5 * least)
    minimum = scene.bearing.ratings.minimum_load_factor * (6 + 4 * 3000 * RPM / scene.bearing.ratings.reference_speed)
    below, above, preloaded = (
        point_row(load_scene(scene, [f"operating.radial_load={load} N", *more]))["warnings"]
        for load, more in ((300, []), (1000, []), (300, ["bearing.clearance=-20 um"]))
    )
    share = 300 / (minimum * (scene.bearing.pitch_diameter / 0.1) ** 2)
    assert f"minimum_load {share:.4g}" in below and "minimum_load" not in above and "minimum_load" not in preloaded
    told = [each for each in counted([below, below, above]) if "minimum_load" in each]
    assert len(told) == 1 and told[0].startswith("2 x minimum_load") and "expected at least 1" in told[0]


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_a_bearing_without_load_has_no_life_in_figures(level):
    numbers = results(scene := scene_of("NU 210", 3000, 0.0, 0.0, f"level={level}"), run_until_settled(scene, 0.02).window)
    assert all(math.isinf(numbers[name]) for name in ("life_hours", "modified_life_hours", "l10_hours", "l10r_hours", "lnm_hours", "lnmr_hours"))
    text = " ".join(text for group in sheet(scene, numbers) for _, text in group)
    assert "infinite" in text and "e+" not in text
