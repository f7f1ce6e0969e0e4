# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""From temperatures to what a level computes with: viscosities, tractions, growth of the rings, clearance of the cage in its lands."""

import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.model.params import Lubrication, Params, lubricate
from bearing_sim.model.sample import part_temperature
from bearing_sim.physics.growth import Temperatures
from bearing_sim.physics.thermal_network import NODE
from bearing_sim.scene.heat import GivenHeat
from bearing_sim.scene.scene import Scene

NOT_MEASURED = (math.nan, math.nan)
_LEAST_LAND = 1.5  # times the film at which surfaces touch: the least clearance of a cage that its warm ring or itself closes


def given_temperatures(heat: GivenHeat, oil: float, measured: Sequence[float] = NOT_MEASURED) -> Temperatures:
    """Return the temperatures of a scene that gives them [K].

    A measured ring counts before the given one; without either a ring has the temperature of the oil, rollers have the mean of both rings, shaft
    and housing have that of their ring.

    Parameters
    ----------
    heat : of the scene.
    oil : temperature of the oil [K].
    measured : of inner and outer ring [K]; NaN where it is not measured.
    """

    def first(*values):
        return next(float(value) for value in values if value is not None and not math.isnan(value))

    inner, outer = first(measured[0], heat.inner_ring, oil), first(measured[1], heat.outer_ring, oil)
    return Temperatures(first(heat.shaft, inner), inner, first(heat.rollers, 0.5 * (inner + outer)), outer, first(heat.housing, outer))


def film_temperatures(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the temperatures of the films on inner and outer raceway in samples [K]: means of ring and rollers, the oil's where these are unknown.

    Parameters
    ----------
    samples : shape (n,) or a single one, see `bearing_sim.model.sample`.
    """
    rollers = part_temperature(samples, "roller_temperature")
    inner, outer = (0.5 * (part_temperature(samples, f"{ring}_ring_temperature") + rollers) for ring in ("inner", "outer"))
    return inner, outer


def lubricate_scene(scene: Scene, params: Params, oil: float, measured: Sequence[float] = NOT_MEASURED) -> Lubrication:
    """Return the lubrication of a scene at a temperature of the oil, without a thermal network: parts as warm as given, otherwise as the oil.

    Parameters
    ----------
    scene, params : of the bearing.
    oil : temperature of the oil [K].
    measured : temperatures of inner and outer ring [K]; NaN where they are not measured.
    """
    solids = given_temperatures(scene.heat, oil, measured) if scene.heat.law == "given" else None
    return lubricate(scene.lubricant, params, oil, solids)


def local_model(scene: Scene, params: Params, inlet: float, nodes: np.ndarray) -> tuple[Params, Lubrication]:
    """Return parameters and lubrication of a bearing at the temperatures of its thermal network.

    Films of the inner contacts are at the mean temperature of inner ring and rollers, those of the outer contacts likewise; drag and lands are
    at that of the oil in the bearing.

    Parameters
    ----------
    scene : of the bearing.
    params : of the bearing before its temperatures change it.
    inlet : temperature of the oil that comes in [K].
    nodes : temperatures of the network's nodes [K], shape (NODES,).
    """
    solids = Temperatures(*nodes[: NODE.oil].tolist())
    lubrication = lubricate(scene.lubricant, params, float(nodes[NODE.oil]), solids)
    return warm_cage(scene, params, solids), lubrication._replace(temperature=inlet)


def warm_cage(scene: Scene, params: Params, solids: Temperatures) -> Params:
    """Return parameters with the clearance of a cage on lands at the temperatures of cage and ring; `running` dimensions stay.

    *Assumption*: the ring expands freely, at its material's rate; fits are left out.  Rotation is in the parameters.

    Parameters
    ----------
    scene, params : of the bearing.
    solids : temperatures; the cage has that of the rollers.
    """
    bearing, cage = scene.bearing, params.cage
    if bearing.dimensions_at == "running" or not bearing.cage.has_lands:
        return params
    reference, ring, own = bearing.reference_temperature, bearing.material.expansion, bearing.cage.material.expansion
    on_outer = bearing.cage.guidance == "outer_ring"
    warmer = (solids.outer_ring if on_outer else solids.inner_ring) - reference
    opened = cage.guide_radius * (ring * warmer - own * (solids.rollers - reference))
    clearance = cage.guide_clearance + (opened if on_outer else -opened)
    return params._replace(cage=cage._replace(guide_clearance=max(clearance, _LEAST_LAND * cage.land_film)))
