# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks of heat and friction: reference conditions of ISO 15312, makers' thermal speeds and frictional moments.  Nothing is fitted to them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.model.params import pack
from bearing_sim.model.thermal_network import POWERS, fit_gaps, thermal_network
from bearing_sim.physics.growth import Temperatures, growth_at, seats_at
from bearing_sim.physics.thermal_network import NODE, NODES, NetworkInputs, heat_flows, new_work, settle
from bearing_sim.scene.loader import scene_from_mapping
from bearing_sim.simulation import IntegrationError
from bearing_sim.studies.friction import dimensions_of
from validation.catalogue_friction import BEARINGS, FILM_LOADS, FILM_RATIOS, heat_flow, moment_table, part_ratios, thermal_speeds
from validation.check import HOLDS, IN_PART, Check, Comparison, judged, within

GROUP = "Heat and friction"
FACTOR, MEDIAN = 2.0, 1.3  # within which single bearings and the median of all count as the same
_TEMPERATURE = 343.15  # K, of bearing and oil (ISO 15312)
_REFERENCE_OIL = {"law": "custom", "viscosity_40": "32 mm^2/s", "viscosity_100": "5.5 mm^2/s", "density": 870.0, "pressure_viscosity": 2e-8}


class ReferenceHeat(NamedTuple):
    """Heat that leaves a bearing at the reference conditions of ISO 15312 [W]: by the thermal network and by the standard."""

    bearing: str
    network: float
    standard: float

    @property
    def ratio(self) -> float:
        """The network's over the standard's."""
        return self.network / self.standard


def reference_heat(name: str) -> ReferenceHeat:
    """Return the heat that the default housing and shaft carry away with rings, rollers and oil at 70 degC in air of 20 degC.

    The housing is a plummer block of the bearing's size, the shaft has 2.5 diameters on each side.

    Parameters
    ----------
    name : designation of the bearing; it runs at its maker's reference speed.

    Raises
    ------
    IntegrationError
        The network has no steady state.
    """
    scene = scene_from_mapping(
        {
            "name": "reference conditions",
            "bearing": name,
            "lubricant": {"oil": _REFERENCE_OIL, "temperature": _TEMPERATURE, "supply": "oil_bath"},
            "operating": {"shaft_speed": "1000 rpm", "radial_load": "1 kN"},
            "mounting": {"shaft": {"fit": "k5"}, "housing": {"fit": "H7", "material": "cast_iron"}},
            "heat": {"law": "network", "ambient_temperature": "20 degC"},
        }
    )
    speed, params, held = scene.bearing.ratings.reference_speed, pack(scene), np.ones(NODES)
    held[[NODE.shaft, NODE.housing]] = 0.0
    network, work, temperatures = thermal_network(scene, params), new_work(), np.full(NODES, _TEMPERATURE)
    growth = growth_at(params.mounted, Temperatures(*(_TEMPERATURE,) * 5))
    inputs = NetworkInputs(speed, 0.45 * speed, _TEMPERATURE, *seats_at(speed, growth, params.mounted, fit_gaps(scene)))
    if not settle(temperatures, np.zeros(len(POWERS)), np.zeros((2, scene.bearing.roller.count)), inputs, network, held, work):
        raise IntegrationError(f"{name}: the thermal network has no steady state at the reference conditions")
    carried = heat_flows(temperatures, inputs, network, work)[1]
    return ReferenceHeat(name, float(carried), heat_flow(dimensions_of(scene)))


def _reference_heat() -> list[Comparison]:
    found = [reference_heat(name) for name in BEARINGS]
    return _ratios(
        "heat that housing and shaft carry away over that of the standard",
        "ISO 15312:2018",
        [each.bearing for each in found],
        [each.ratio for each in found],
    )


def _ratios(quantity: str, source: str, names: Sequence[str], ratios: Sequence[float], median: float = MEDIAN) -> list[Comparison]:
    """Return two comparisons of ratios: each within a factor of two, in part if half of them are, and their median."""
    ratios = np.array(ratios)
    near, middle = within(ratios, FACTOR), float(np.median(ratios))
    beyond = [name for name, ratio in zip(names, ratios) if not 1 / FACTOR <= ratio <= FACTOR]
    which = f"; not {', '.join(beyond)}" if 0 < len(beyond) <= 4 else ""
    return [
        judged(
            f"{quantity}, {len(ratios)} ratios",
            source,
            f"each within a factor of {FACTOR:g}",
            f"{near} of {len(ratios)}, {ratios.min():.2f} to {ratios.max():.2f}{which}",
            HOLDS if near == len(ratios) else IN_PART if near >= 0.5 * len(ratios) else False,
            f"a factor of {np.exp(np.abs(np.log(ratios)).max()):.3g}",
            f"a factor of {FACTOR:g} for all; in part: for half",
        ),
        judged(
            "median of these ratios",
            source,
            "1",
            f"{middle:.2f}",
            within([middle], median) == 1,
            f"a factor of {max(middle, 1 / middle):.3g}",
            f"a factor of {median:g}",
        ),
    ]


def _thermal_speeds() -> list[Comparison]:
    found = thermal_speeds()
    results = []
    for maker, quantity in (("nke", "as NKE prints them by ISO 15312"), ("skf", "as SKF prints them"), ("skf_model", "by SKF's own friction model")):
        printed = [each for each in found if not math.isnan(getattr(each, maker))]
        source = "NKE, catalogue" if maker == "nke" else "SKF, general catalogue"
        ratios = [each.model / getattr(each, maker) for each in printed]
        results += _ratios(
            f"speed at which friction is the heat flow of ISO 15312 over the thermal speed {quantity}",
            source,
            [each.bearing for each in printed],
            ratios,
        )
    return results


def _moments() -> list[Comparison]:
    found = moment_table()
    names = [each.bearing for each in found]
    skf = [each.model / each.skf for each in found]
    return [
        *_ratios(
            "frictional moment over makers' simple model M_0 + M_1, 0.02 to 0.2 C_0, 500 rpm to the reference speed",
            "Palmgren; Schaeffler; ISO 15312",
            names,
            [each.ratio for each in found],
            1.5,
        ),
        *_ratios("the same over SKF's friction model", "SKF, general catalogue", names, skf, 1.5),
    ]


_MIXED = 0.5  # kappa up to which SKF's sliding moment is that of asperities


def _over_films() -> list[Comparison]:
    found = part_ratios()
    at = f"kappa {FILM_RATIOS[0]:g} to {FILM_RATIOS[-1]:g}, {FILM_LOADS[0]:g} to {FILM_LOADS[-1]:g} C"
    mixed = [each for each in found if each.kappa <= _MIXED]
    parts = (
        (f"frictional moment over SKF's friction model, {at}", found, "whole"),
        ("hydrodynamic resistance to rolling over M_rr, likewise", found, "rolling"),
        (f"sliding, skew and hysteresis over M_sl, likewise up to kappa {_MIXED:g}", mixed, "sliding"),
    )
    results = []
    for quantity, points, part in parts:
        ratios = [getattr(each, part) for each in points]
        results += _ratios(quantity, "SKF, general catalogue", [each.bearing for each in points], ratios, 1.5)
    return results


CHECKS = (
    Check("reference_heat", GROUP, _reference_heat),
    Check("thermal_speeds", GROUP, _thermal_speeds, "python test/validation friction"),
    Check("frictional_moments", GROUP, _moments, "python test/validation friction"),
    Check("friction_over_films", GROUP, _over_films, "python test/validation friction", True),
)
