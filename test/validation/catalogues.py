# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks against makers' catalogues: ratings, lives, boundary dimensions and clearances, estimated rollers, characteristic frequencies.

Raceway diameters F and E and the ratings are those of Koyo's catalogue (JTEKT, ball and roller bearings; NSK's rows are the same).  The roller
diameter is (E - F)/2.  Numbers of rollers are published for NU 206, NU 210 and NU 215 and deduced for the others; the effective length is
that which gives the catalogue's C_0 by ISO 76, so that C_r is a check of C against C_0: two rollers more or less move it by half a percent.
"""

import numpy as np

from bearing_sim.model.characteristic_frequencies import characteristic_frequencies
from bearing_sim.model.sample import new_block
from bearing_sim.scene.loader import scene_from_mapping, scene_from_yaml
from bearing_sim.scene.mounting import clearance_limits
from bearing_sim.scene.ratings import rate
from bearing_sim.studies.statics import statics
from validation.catalog_rules import left_out, printed_rating_ratios, summary
from validation.check import HOLDS, IN_PART, Check, Comparison, compared, judged

GROUP = "Catalogues"
KOYO = {  # bore, raceway diameters F, E [mm], rollers, effective length [mm], C, C_0 [kN]
    "NU 205": (25, 31.5, 46.5, 13, 7.99, 29.3, 27.7),
    "NU 2205": (25, 31.5, 46.5, 13, 9.99, 34.9, 34.6),
    "NJ 305": (25, 34, 54, 11, 10.00, 41.6, 37.4),
    "N 206": (30, 37.5, 55.5, 13, 9.01, 39.1, 37.4),
    "NU 2206": (30, 37.5, 55.5, 13, 12.00, 48.9, 49.8),
    "N 306": (30, 40.5, 62.5, 12, 10.99, 53.1, 50.2),
    "NU 207": (35, 44, 64, 14, 10.00, 50.2, 50.2),
    "NJ 308": (40, 52, 80, 12, 13.99, 83.1, 81.5),
    "NU 2308": (40, 52, 80, 12, 20.95, 114, 122),
    "NU 210": (50, 59.5, 81.5, 16, 11.00, 66.1, 71.9),
    "NU 2210": (50, 59.5, 81.5, 16, 14.00, 79.7, 91.5),
    "NJ 2310": (50, 65, 97, 13, 25.46, 163, 187),
    "N 212": (60, 72, 100, 16, 12.97, 97.7, 107),
    "NU 215": (75, 88.5, 118.5, 18, 15.36, 130, 156),
    "NU 315": (75, 95, 143, 13, 24.00, 240, 263),
    "NU 2324": (120, 154, 230, 13, 59.08, 793, 1030),
    "NU 232": (160, 195, 259, 18, 30.59, 498, 666),
}
"""Bearings of Koyo's catalogue."""
NORMAL_CLEARANCE = {25: 0.0325, 30: 0.0325, 35: 0.0375, 40: 0.0375, 50: 0.045, 60: 0.055, 75: 0.0575, 120: 0.07, 160: 0.0975}
"""Middle of the normal group of diametral clearance [mm] by bore [mm] (ISO 5753-1)."""
SPEED = 1000.0  # rpm

# D, B of the general catalogue of IBB (types with a cage) and of INA's price list (SL18 29 and 30, which are NCF), none of which the tables of
# caged bearings were made from; and clearances as SKF's general catalogue prints them for the bore (ISO 5753-1) [mm, um].
BOUNDARIES = {
    "NU 1005": (25, 47, 12, "CN", 20, 45),
    "NU 1030 ML/C3": (150, 225, 35, "C3", 115, 165),
    "NU 1052/C4": (260, 400, 65, "C4", 260, 330),
    "NU 1080": (400, 600, 90, "CN", 190, 280),
    "NU 210 ECP/C3": (50, 90, 20, "C3", 50, 80),
    "N 232": (160, 290, 48, "CN", 70, 120),
    "NJ 260/C2": (300, 540, 85, "C2", 55, 130),
    "NU 2205": (25, 52, 18, "CN", 20, 45),
    "NJ 2220 ECP/C5": (100, 180, 46, "C5", 155, 190),
    "NUP 2252": (260, 480, 130, "CN", 125, 195),
    "NU 306": (30, 72, 19, "CN", 20, 45),
    "NUP 324/C3": (120, 260, 55, "C3", 85, 125),
    "NF 348": (240, 500, 95, "CN", 110, 175),
    "NU 2304": (20, 52, 21, "CN", 20, 45),
    "NJ 2332 MA/C4": (160, 340, 114, "C4", 165, 215),
    "NU 410/C2": (50, 130, 31, "C2", 5, 35),
    "NJ 430": (150, 380, 85, "CN", 70, 120),
    "NCF 2928 CV/C3": (140, 190, 30, "C3", 100, 145),
    "NCF 2948 CV": (240, 320, 48, "CN", 110, 175),
    "NCF 3008 CV": (40, 68, 21, "CN", 25, 50),
    "NCF 3012 CV/C4": (60, 95, 26, "C4", 80, 110),
}
"""Bearings of all series and types with bore, outside diameter, width [mm], group of clearance and its limits [um]."""


def koyo_scene(name: str, clearance: float = 0.0, row: tuple | None = None, ratings: bool = True) -> str:
    """Return the scene of a bearing of Koyo's catalogue under a tenth of its maker's C, as YAML.

    Parameters
    ----------
    name : of the bearing.
    clearance : the diametral one [mm].
    row : of numbers as in `KOYO`, of a bearing that is not there.
    ratings : whether the scene gives the maker's ratings.
    """
    _, inner, outer, rollers, length, dynamic, static = row or KOYO[name]
    diameter, pitch = (outer - inner) / 2, (outer + inner) / 2
    cage = f"{{mass: {1e-6 * pitch**3:.3g} kg, inner_radius: {pitch / 2 - 0.2 * diameter} mm, guide_radius: {pitch / 2 + 0.3 * diameter} mm"
    maker = f"ratings: {{dynamic: {dynamic} kN, static: {static} kN}}" if ratings else ""
    return f"""
name: catalogue
bearing:
  name: {name}
  source: Koyo catalogue
  dimensions_at: running
  outer_raceway: {{low_radius: {inner / 2 + diameter + clearance / 2} mm, d_value: 0 mm, lobes: 3}}
  inner_raceway: {{radius: {inner / 2} mm}}
  roller: {{count: {rollers}, diameter: {diameter} mm, length: {length} mm}}
  cage: {cage}, guide_clearance: 0.3 mm, guide_land_width: 2 mm, width: {length + 6} mm}}
  {maker}
lubricant: {{oil: mil_l_23699, temperature: 80 degC, mixture_fraction: 0.03}}
operating: {{shaft_speed: {SPEED} rpm, radial_load: {100 * dynamic} N}}
"""


def _ratings() -> list[Comparison]:
    computed = [rate(scene_from_yaml(koyo_scene(name)).bearing).computed for name in KOYO]
    dynamic, static = ([row[column] for row in KOYO.values()] for column in (5, 6))
    source = "Koyo and NSK, catalogues"
    return [
        compared(
            f"C of {len(KOYO)} bearings, series 2, 3, 22, 23", source, dynamic, [1e-3 * each.dynamic for each in computed], unit="kN", relative=5e-3
        ),
        compared(
            "their C_0, by which the length of the rollers was found",
            source,
            static,
            [1e-3 * each.static for each in computed],
            unit="kN",
            relative=3e-3,
        ),
    ]


def _lives() -> list[Comparison]:
    lives = [statics(scene_from_yaml(koyo_scene(name, NORMAL_CLEARANCE[KOYO[name][0]])), 40).lives for name in KOYO]
    ratios = np.array([each.l10r / each.l10 for each in lives])
    expected = 1e6 * 10 ** (10 / 3) / (60 * SPEED)
    return [
        compared(
            f"L10 of {len(KOYO)} bearings at C/P = 10",
            "ISO 281, (C/P)^(10/3)",
            [expected] * len(lives),
            [each.l10 for each in lives],
            unit="h",
            relative=1e-9,
        ),
        judged(
            "L10r by ISO/TS 16281 over L10 by ISO 281 at C/P = 10 with normal clearance; their exponents, 4 and 10/3, part them",
            "range that the standards' exponents leave",
            "1 to 2.25",
            f"{ratios.min():.3g} to {ratios.max():.3g}",
            (ratios > 1.0).all() and (ratios < 2.25).all(),
            tolerance="the range",
        ),
    ]


def _boundaries() -> list[Comparison]:
    expected, found, limits, computed = [], [], [], []
    for text, (bore, outside, width, group, low, high) in BOUNDARIES.items():
        of = {"name": "designation", "level": "steady", "bearing": text, "lubricant": {"oil": "ISO VG 32"}}
        bearing = scene_from_mapping({**of, "operating": {"shaft_speed": "1000 rpm", "radial_load": "5 kN"}}).bearing
        expected += [bore, outside, width]
        found += [2e3 * bearing.inner_raceway.bore_radius, 2e3 * bearing.outer_raceway.outside_radius, 1e3 * bearing.width]
        limits += [low, high]
        computed += [1e6 * each for each in clearance_limits(group, 1e-3 * bore)]
    names = f"of {len(BOUNDARIES)} designations of all series and types"
    return [
        compared(f"bore, outside diameter and width {names}", "IBB, general catalogue; INA, price list", expected, found, unit="mm", absolute=1e-6),
        compared(f"limits of clearance {names}", "SKF, general catalogue (ISO 5753-1)", limits, computed, unit="um", absolute=1e-3),
    ]


def _estimated_rollers() -> list[Comparison]:
    found = left_out(True)
    exact = np.mean([each.count_error == 0 for each in found])
    furthest = max(abs(each.count_error) for each in found)
    diameters = np.array([abs(each.diameter_error) for each in found])
    diameters = diameters[np.isfinite(diameters)]
    ratings = summary(each.rating_error for each in found)
    rows = f"{len(found)} high-capacity bearings, each left out of the fit in turn"
    near = np.mean(diameters <= 0.01)
    return [
        judged(
            f"number of rollers of {rows}",
            "static ratings of two widths of a section",
            "exact",
            f"exact for {100 * exact:.0f} %, at most {furthest} off",
            HOLDS if exact == 1.0 else IN_PART if furthest <= 1 else False,
            f"{furthest} roller",
            "exact; in part: one roller off",
        ),
        judged(
            "diameter of the rollers of the same",
            "raceways as printed",
            "within 1 %",
            f"within 1 % for {100 * near:.0f} %",
            HOLDS if near == 1.0 else IN_PART if near >= 0.9 else False,
            f"{100 * diameters.max():.2g} %",
            "1 % for all; in part: for 90 %",
        ),
        judged(
            "C of the same with estimated rollers",
            "Koyo, catalogue",
            "C as printed",
            f"off by {100 * ratings.median:.2g} % in the median",
            ratings.largest <= 0.05,
            f"{100 * ratings.largest:.2g} %",
            "5 %",
        ),
    ]


def _printed_ratings() -> list[Comparison]:
    found = []
    for maker in ("Koyo", "SKF", "NKE"):
        ratios = np.array(list(printed_rating_ratios(maker).values()))
        middle = float(np.median(ratios))
        words = f"{middle:.3f} in the median, {ratios.min():.3f} to {ratios.max():.3f}"
        quantity = f"C_r by ISO 281 with known rollers over the C that {maker} prints, {len(ratios)} bearings"
        found.append(
            judged(
                quantity,
                f"{maker}, catalogue",
                "1 in the median where the maker rates by ISO 281",
                words,
                abs(middle - 1.0) <= 0.05,
                f"{100 * abs(middle - 1.0):.2g} %",
                "5 %",
            )
        )
    return found


def _frequencies() -> list[Comparison]:
    scene = scene_from_mapping(
        {"name": "NU 206", "bearing": "NU 206 E", "lubricant": {"oil": "ISO VG 32"}, "operating": {"shaft_speed": "60 rpm", "radial_load": "1 kN"}}
    )
    bearing, block = scene.bearing, new_block(1, scene.bearing.roller.count)
    gamma = bearing.diameter_ratio
    block["shaft_speed"] = 2.0 * np.pi
    block["cage_speed"] = np.pi * (1.0 - gamma)
    block["orbital_speed"] = block["cage_speed"][:, None]
    block["roller_spin"] = block["orbital_speed"] / gamma
    found = characteristic_frequencies(block)[0]
    quantity = "cage, outer race, inner race and roller lines of an NU 206 over the shaft's, without slip"
    return [compared(quantity, "Schaeffler, NU206-E-XL-TVP2", (0.40, 5.24, 7.76, 2.49), found, absolute=0.0051, digits=4)]


CHECKS = (
    Check("catalogue_ratings", GROUP, _ratings),
    Check("catalogue_lives", GROUP, _lives),
    Check("boundary_dimensions", GROUP, _boundaries),
    Check("estimated_rollers", GROUP, _estimated_rollers, "python test/validation catalog"),
    Check("printed_ratings", GROUP, _printed_ratings, "python test/validation catalog"),
    Check("characteristic_frequencies", GROUP, _frequencies),
)
