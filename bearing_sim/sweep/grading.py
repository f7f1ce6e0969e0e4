# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""By how much laws outside of their ranges move slip, life, power and film: each exceedance of a scene is computed otherwise by level ``steady``.

Temperatures are held, those of a thermal network too: what is varied would change them, and the network would carry a part of the effect off.
"""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.operating_point import ANSWER, CREEP
from bearing_sim.model.validity import PARTS, SHOWN, Conditions, Effect, Exceedance, Variation
from bearing_sim.physics.traction import EYRING, ROW, TractionConstants
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import inputs_of, thermal_nodes
from bearing_sim.sweep.thermal import OperatingState, begin_at, lives_of, operating_state, solved_answer, steady_model


class _Figures(NamedTuple):
    """What is compared."""

    slip: float
    life: float  # [revolutions]
    power: float  # [W]
    film: float  # over that of the scene


def graded(
    scene: Scene, exceedances: Iterable[Exceedance], sample: np.void | Mapping[str, np.void], shown: tuple[str, ...] = SHOWN
) -> list[Exceedance]:
    """Return exceedances with their effects and grades, in their order; those whose effect is not known as they are.

    The first use compiles level ``steady``; then an exceedance takes tenths of a second.

    Parameters
    ----------
    scene : of any level.
    exceedances : see `bearing_sim.model.validity.outside`.
    sample : settled, whose conditions and temperatures count; or one for each exceedance by the name of its law, where each was at its worst.
    shown : numbers that somebody reads, of `bearing_sim.model.validity.SHOWN`; the others do not count.
    """
    found, bases = [], {}
    for each in exceedances:
        there = sample.get(each.law.name) if isinstance(sample, Mapping) else sample
        effect = _effect(scene, each, there, bases, shown) if each.law.variations and there is not None else None
        found.append(each if effect is None else each.graded(effect))
    return found


def _effect(scene: Scene, exceedance: Exceedance, sample: np.void, bases: dict, shown: tuple[str, ...]) -> Effect | None:
    """Return the largest effect of a law's variations; None where one of them cannot be computed."""
    moment = float(sample["time"])
    if moment not in bases:
        bases[moment] = _figures(scene, sample, {})
    base, effects = bases[moment], []
    if base is None:
        return None
    at = Conditions(scene, np.array([sample]))
    for variation in exceedance.law.variations:
        factors = {part: factor(exceedance, at) if callable(factor) else factor for part, factor in variation.factors.items()}
        other = _varied_figures(scene, variation, exceedance, sample, factors)
        if other is None:
            return None
        life, power = (after / before - 1.0 if before > 0.0 else 0.0 for after, before in ((other.life, base.life), (other.power, base.power)))
        is_of_life = exceedance.law.kind == "validity.life"
        effects.append(Effect(other.slip - base.slip, life, power, other.film - 1.0, base.slip, variation.otherwise, is_of_life, shown))
    return max(effects, key=lambda effect: effect.size)


def _varied_figures(scene: Scene, variation: Variation, exceedance: Exceedance, sample: np.void, factors: Mapping[str, float]) -> _Figures | None:
    if not all(math.isfinite(factor) for factor in factors.values()):
        return None
    overrides = variation.overrides(exceedance) if callable(variation.overrides) else variation.overrides
    try:
        return _figures(load_scene(scene, list(overrides)) if overrides else scene, sample, factors)
    except SceneError:  # a scene that cannot be computed so
        return None


def _figures(scene: Scene, sample: np.void, factors: Mapping[str, float]) -> _Figures | None:
    """Return the figures of a scene under the conditions of a sample, parts of its model multiplied; None at rest, and where none were found."""
    inputs = inputs_of(sample)
    if not abs(inputs.shaft_speed) >= CREEP:
        return None
    state = _multiplied(operating_state(scene, inputs, thermal_nodes(sample)), factors)
    answer = solved_answer(state, inputs, start=begin_at(float(sample["cage_slip"])))
    if math.isnan(answer[ANSWER.cage_slip]):
        return None
    # kappa is that of lives alone: the viscosity that drives starvation and asperities stays
    kappa = factors.get("viscosity_ratio", 1.0) * state.lubrication.kinematic_viscosity
    model = steady_model(state._replace(lubrication=state.lubrication._replace(kinematic_viscosity=kappa)), inputs)
    lives = lives_of(answer, model)
    return _Figures(float(answer[ANSWER.cage_slip]), lives.modified, float(answer[ANSWER.shaft_power]), factors.get("film", 1.0))


def _multiplied(state: OperatingState, factors: Mapping[str, float]) -> OperatingState:
    """Return the state of a bearing whose model has parts, names of `bearing_sim.model.validity.PARTS`, that are multiplied."""
    params, lubrication = state.params, state.lubrication
    film, resistance, drag, lands, _ = (factors.get(part, 1.0) for part in PARTS)  # the last is that of lives
    inner, outer = (
        each._replace(elastic=each.elastic + math.log(resistance))
        for each in (lubrication.rolling_resistance.inner, lubrication.rolling_resistance.outer)
    )
    lubrication = lubrication._replace(
        inner=_with_film(lubrication.inner, film),
        outer=_with_film(lubrication.outer, film),
        rolling_resistance=lubrication.rolling_resistance._replace(inner=inner, outer=outer),
        mixture_density=drag * lubrication.mixture_density,
        mixture_flow=drag * lubrication.mixture_flow,
        bath=type(lubrication.bath)(*(drag * number for number in lubrication.bath)),
    )
    params = params._replace(cage=params.cage._replace(guide_width=lands * params.cage.guide_width))
    return state._replace(params=params, lubrication=lubrication)


def _with_film(traction: TractionConstants, factor: float) -> TractionConstants:
    """Return constants of a contact whose film, where its law has one, is multiplied."""
    if traction.law != EYRING:
        return traction
    special = traction.special.copy()
    special[ROW.film] += math.log(factor)
    return traction._replace(special=special)
