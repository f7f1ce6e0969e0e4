# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All states in which a cage stays under the same inputs, and the load below which it stays in a skid.

Thick oil brakes a cage that is slow beside its rollers more than a light load drives it.  One that rolls then continues to roll, and one that skids,
as after a start with cold oil or while the load was low, continues to skid.  The scan of an operating point
(`bearing_sim.levels.steady.operating_point`) sees where the mean drive of a cage changes from braking to driving.  Each such slip is a state of its
own.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import Model
from bearing_sim.levels.steady.model import Work, forget, new_work, solve_condition
from bearing_sim.levels.steady.operating_point import ANSWER, CREEP, SCANNED, basin, find_skid_load, stable_balances
from bearing_sim.model.losses import power_loss
from bearing_sim.scene.display import force, hours, power
from bearing_sim.scene.scene import Integration, Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, inputs_of, scene_inputs, thermal_nodes
from bearing_sim.sweep.ring_resonance import Resonance, ring_resonance
from bearing_sim.sweep.settling import Outcome, advance_until_settled, longest_run, mean_life, shortest_run
from bearing_sim.sweep.thermal import SKIDS, lives_of, operating_state, simulation_held_at, steady_model

ROLLING, SKID = "rolling", "skid"  # from where a run starts
_FIRST, _MOST = 1e-3, 0.5  # loads at which the search for a skid load begins and ends, over the static load rating
_STANDSTILL = 1e-3  # rad/s; a cage that stands
_LIFTED = 1e-5  # m, by which a ring is displaced against its load
_LONGER = 1.5  # than the run; the longest one from another start
_OTHER_SLIP, _OTHER_LIFE, _OTHER_POWER = 5e-3, 0.1, 0.1  # differences of another state: of slip, and relative


class State(NamedTuple):
    """A state in which a bearing stays."""

    cage_slip: float
    rating_life: float  # by the loads on both rings [h]
    shaft_power: float  # [W]
    start: str  # from where the bearing comes to it
    basin: tuple[float, float] = (math.nan, math.nan)  # slips between which a cage comes to it, where level steady tells

    @property
    def from_standstill(self) -> bool:
        """Whether a cage that stands comes to it, and one that rolls does not."""
        return self.basin[0] > -math.inf and self.basin[1] == math.inf


class States(NamedTuple):
    """What level steady knows of the states of a bearing under constant conditions."""

    found: tuple[State, ...]  # the one to which the cage comes from ideal rolling first; none where no state was found, or at rest
    skid_load: float  # load below which a skid lasts, at the same speed and temperatures [N]; 0 where none does, NaN where it was not sought

    def of(self, slip: float) -> State | None:
        """Return the state of a bearing whose cage has settled with such a slip; None where none was found."""
        return min(self.found, key=lambda state: abs(state.cage_slip - slip), default=None)

    def beside(self, slip: float) -> tuple[State, ...]:
        """Return the other states of such a bearing."""
        own = self.of(slip)
        return tuple(state for state in self.found if state is not own)


class Others(NamedTuple):
    """What a bearing that has settled might do as well under the same conditions."""

    states: tuple[State, ...]
    skid_load: float  # see `States`
    resonance: Resonance | None  # of the inner ring, at levels that compute its motion


def states(scene: Scene, inputs: Inputs | None = None, nodes: np.ndarray | None = None, skid_load: bool = True) -> States:
    """Return the states of a bearing under constant conditions, by level steady.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions; the scene's operating block where absent.
    nodes : temperatures of the thermal network's nodes [K]; those of its equilibrium where absent or NaN.
    skid_load : whether to look for the skid load, which takes longer than the states.

    Raises
    ------
    IntegrationError
        There is no thermal equilibrium.
    """
    inputs = scene_inputs(scene) if inputs is None else inputs
    if abs(inputs.shaft_speed) < CREEP:
        return States((), math.nan)
    model = steady_model(operating_state(scene, inputs, nodes), inputs)
    work, below = new_work(model.params), math.nan
    found = tuple(_state(*found, model) for found in _balances(inputs, model, work))
    if skid_load and found:
        rating = model.params.life.static_rating
        below = find_skid_load(SKIDS, math.atan2(inputs.load_z, inputs.load_y), _FIRST * rating, _MOST * rating, model, work.bearing, work.orbit)
    return States(found, float(below))


def other_states(scene: Scene, outcome: Outcome, start: str = ROLLING, skid_load: bool = True) -> Others:
    """Return the other states of a bearing under the conditions of a run that has ended.

    Levels steady and slip have those of the mean drive of the cage.  Levels planar and spatial start once more from each of these, and, where the
    passing rollers may keep the inner ring vibrating (`bearing_sim.sweep.ring_resonance`), with a ring that is displaced against its load, and one
    that does not vibrate if this one does.  A run that has not settled has no other states.

    Parameters
    ----------
    scene : under constant conditions.
    outcome : of its run.
    start : from where it began, such as `ROLLING`.
    skid_load : as of `states`.
    """
    sample, slip = outcome.window[-1], outcome.slip
    inputs, nodes = inputs_of(sample), thermal_nodes(sample)
    if not math.isfinite(slip):
        return Others((), math.nan, None)
    known = states(scene, inputs, nodes, skid_load)
    if scene.level in ("steady", "slip"):
        return Others(known.beside(slip), known.skid_load, None)
    resonance, own, found = ring_resonance(scene, slip, inputs, nodes), state_of(outcome, ""), []
    beside = known.beside(slip) if outcome.settled else ()  # a bearing that wanders visits what it may
    starts = [(state.start, _settled_at_slip(scene, state.from_standstill, inputs, nodes)) for state in beside]
    if outcome.settled and resonance is not None and resonance.may_vibrate:
        quiet = known.of(slip)
        if quiet is not None and not own.rating_life > (1.0 - _OTHER_LIFE) * quiet.rating_life:
            starts.append(("from a ring that does not vibrate", _settled_at_slip(scene, quiet.from_standstill, inputs, nodes)))
        starts.append(("from a displaced ring", _lifted(sample)))
    starts = [(words, sample) for words, sample in starts if sample is not None]
    if start != ROLLING and outcome.settled:
        starts.append(("from ideal rolling", None))
    for words, begin in starts:
        state = _state_from(scene, begin, words, inputs, nodes, outcome)
        if state and _differs(state, own) and not any(not _differs(state, each) for each in found):
            found.append(state)
    return Others(tuple(found), known.skid_load, resonance)


def state_of(outcome: Outcome, start: str) -> State:
    """Return the state that a run has settled in, and from where it came."""
    return State(outcome.slip, mean_life(outcome.window["rating_life"]), power_loss(outcome.window), start)


def _differs(state: State, other: State) -> bool:
    def apart(one, two):
        return abs(one - two) / max(min(abs(one), abs(two)), 1e-300) if one != two else 0.0

    return (
        abs(state.cage_slip - other.cage_slip) > _OTHER_SLIP
        or apart(state.rating_life, other.rating_life) > _OTHER_LIFE
        or apart(state.shaft_power, other.shaft_power) > _OTHER_POWER
    )


def _state_from(scene: Scene, start: np.void | None, words: str, inputs: Inputs, nodes: np.ndarray, outcome: Outcome) -> State | None:
    """Return the state that a bearing comes to from a sample, at the temperatures of a run; None where it does not settle."""
    shortest = shortest_run(scene, 0.0)
    try:
        run = simulation_held_at(scene, inputs, nodes, start)
        found = advance_until_settled(run, shortest, max(shortest, _LONGER * outcome.simulated))
    except IntegrationError:
        return None
    return state_of(found, words if found.settled else f"{words}, {found.verdict}")


def _settled_at_slip(scene: Scene, from_standstill: bool, inputs: Inputs, nodes: np.ndarray) -> np.void | None:
    """Return the sample of level slip that has settled from a cage that stands or rolls, at the temperatures of a run; None where it does not."""
    simple = at_level_slip(scene)
    try:
        run = simulation_held_at(simple, inputs, nodes, standing_cage(simple, inputs, nodes) if from_standstill else None)
        return advance_until_settled(run, shortest_run(simple, 0.0), longest_run(simple, 1.0)).window[-1]
    except IntegrationError:
        return None


def _lifted(sample: np.void) -> np.void:
    """Return a sample whose inner ring is displaced against its load."""
    lifted, load = sample.copy(), math.hypot(sample["load_y"], sample["load_z"])
    for axis in ("y", "z"):
        lifted[f"ring_{axis}"] -= _LIFTED * float(sample[f"load_{axis}"]) / max(load, 1e-300)
    return lifted


def at_level_slip(scene: Scene) -> Scene:
    """Return a scene at level slip, without what that level leaves out."""
    operating = replace(scene.operating, moment=None, misalignment=0.0)
    support = replace(scene.support, unbalance=replace(scene.support.unbalance, amount=0.0))
    return replace(scene, level="slip", level_reason="", wants=(), integration=Integration(), operating=operating, support=support)


def _balances(inputs: Inputs, model: Model, work: Work):
    """Yield answer, basin (`bearing_sim.levels.steady.operating_point.basin`) and start of each state."""
    forget(work)
    if not solve_condition(*inputs[:3], model, work, to_standstill=True):
        return
    rolling, scanned = tuple(work.basin.tolist()), work.orbit.scanned.copy()
    yield work.solved.copy(), rolling, "from ideal rolling"
    for low, high in stable_balances(scanned):
        reached = basin(low, high, scanned)
        if reached == rolling:
            continue
        start = 1.0 if high == len(SCANNED) else float(SCANNED[high])
        if solve_condition(*inputs[:3], model, work, start):
            yield work.solved.copy(), reached, "from a skid" if start > 0.0 else "from a cage that leads"


def _state(answer: np.ndarray, reached: tuple[float, float], start: str, model: Model) -> State:
    hours = lives_of(answer, model).basic * 2.0 * math.pi / (3600.0 * abs(model.drive.shaft_speed))
    return State(float(answer[ANSWER.cage_slip]), float(hours), float(answer[ANSWER.shaft_power]), start, reached)


def standing_cage(scene: Scene, inputs: Inputs | None = None, nodes: np.ndarray | None = None) -> np.void:
    """Return a sample of a bearing whose cage stands while the shaft turns, to start a simulation in a skid.

    The rollers roll on the inner raceway.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions; the scene's operating block where absent.
    nodes : temperatures of the thermal network's nodes [K]; those of the scene's start where absent.
    """
    rolling = Simulation(scene, inputs, nodes=nodes).sample
    sample = rolling.copy()
    # The spin of rolling is that of an inner raceway that turns by omega_i - omega_c under a cage that is held.
    faster = rolling["shaft_speed"] / (rolling["shaft_speed"] - rolling["cage_speed"])
    sample["roller_spin"] = rolling["roller_spin"] * faster
    sample["cage_speed"] = sample["orbital_speed"] = math.copysign(_STANDSTILL, rolling["shaft_speed"])
    sample["cage_slip"] = 1.0
    return sample


def skid_start(scene: Scene, inputs: Inputs | None = None) -> np.void:
    """Return the sample from which a bearing starts in a skid.

    At levels steady and slip the cage stands.  At the others the bearing starts as level slip has settled from there, at the temperatures of
    the inputs: a cage that stands would be thrown about.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions; the scene's operating block where absent.
    """
    inputs = scene_inputs(scene) if inputs is None else inputs
    if scene.level in ("steady", "slip"):
        return standing_cage(scene, inputs)
    nodes = operating_state(scene, inputs).temperatures
    found = _settled_at_slip(scene, True, inputs, nodes)
    return standing_cage(scene, inputs, nodes) if found is None else found


def state_rows(others: Others, start: str) -> list[tuple[str, str]]:
    """Return rows of a table: the state that is shown, the others, the skid load, and how the passing rollers excite the ring."""
    came = {ROLLING: "from ideal rolling", SKID: "from a skid"}.get(start, "from a neighbouring point")
    rows = [("state", f"{came}{'' if others.states else '; no other was found'}")]
    rows += [("also stays at", state_text(state)) for state in others.states]
    if others.skid_load > 0.0:
        rows.append(("skid load", f"{force(others.skid_load)}; below it a skidding cage continues to skid"))
    if others.resonance is not None:
        rows.append(("inner ring", resonance_text(others.resonance)))
    return rows


def state_text(state: State) -> str:
    """Return a state in words."""
    return f"{100.0 * state.cage_slip:.2f} % cage slip, {hours(state.rating_life)}, {power(state.shaft_power)}: {state.start}"


def resonance_text(resonance: Resonance) -> str:
    """Return how the passing rollers excite the inner ring, in words."""
    low, high = resonance.ratios
    frequencies = " and ".join(f"{frequency:.0f}" for frequency in resonance.frequencies)
    text = (
        f"moves with {resonance.moving_mass:.3g} kg ({resonance.ring_mass:.3g} kg of it the ring's own); {frequencies} Hz on its contacts, "
        f"{low:.2f} and {high:.2f} of the {resonance.passage:.0f} Hz of the passing rollers"
    )
    if resonance.excited:
        return f"{text}: near {resonance.order:g}, they make it vibrate; its mass and bearing.contact.damping_time decide slip and life"
    if resonance.may_vibrate:
        return f"{text}: near {resonance.order:g}, they may keep it vibrating"
    return text
