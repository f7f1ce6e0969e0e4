# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The levels of fidelity, each a record of functions."""

from collections.abc import Callable
from typing import NamedTuple

from bearing_sim.levels.common import state_transfer
from bearing_sim.levels.planar import methods as planar_methods
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.planar import state as planar_state
from bearing_sim.levels.slip import methods as slip_methods
from bearing_sim.levels.slip import model as slip
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.spatial import methods as spatial_methods
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial import state as spatial_state
from bearing_sim.levels.steady import model as steady


class Level(NamedTuple):
    """One complete model.

    Attributes
    ----------
    new_work : params -> workspace.
    initial_state : (params, work, shaft speed, load y, load z) -> state of ideal rolling.
    state_at : (params, work, sample of any level) -> state that continues from there, see `bearing_sim.levels.common.state_transfer`.
    observe : compiled, see `bearing_sim.levels.slip.model`.
    method : name of the integration method, see ``doc/theory/integrators.md``.
    advance : compiled when first called, so that a run compiles what it uses; see `bearing_sim.levels.common.advance.advance_by`.
    leaves_out : what the level does not model, in words.
    takes_steps : whether it takes steps, which may be fixed; a level that takes none ignores that argument of ``advance``.
    advance_profile : compiled, goes over a whole course of inputs at once; None at a level that marches.
    advance_warm_profile : the same beside a thermal network.
    forget : lets a workspace drop what it remembers of parameters and lubrication; None at a level that remembers nothing.
    supply : ``(model, work)`` solves for the operating point that compiled code has asked for by the status NEEDS_POINT, and returns whether there
        is one; None at a level that asks for none.
    """

    new_work: Callable
    initial_state: Callable
    state_at: Callable
    observe: Callable
    method: str
    advance: Callable
    leaves_out: str
    takes_steps: bool = True
    advance_profile: Callable | None = None
    advance_warm_profile: Callable | None = None
    forget: Callable | None = None
    supply: Callable | None = None


LEVELS = {
    "steady": Level(
        steady.new_work,
        steady.initial_state,
        state_transfer.steady_state_at,
        steady.observe,
        "lag",
        steady.advance,
        "all that happens within a cage turn, and what slip leaves out",
        takes_steps=False,
        advance_profile=steady.advance_profile,
        advance_warm_profile=steady.advance_warm_profile,
        forget=steady.forget,
        supply=steady.supply,
    ),
    "slip": Level(
        slip_state.new_work,
        slip.initial_state,
        state_transfer.slip_state_at,
        slip.observe,
        "tr_bdf2",
        slip_methods.advance,
        "pocket play, radial vibration, cage whirl, tilt and skew",
    ),
    "planar": Level(
        planar_state.new_work,
        planar.initial_state,
        state_transfer.planar_state_at,
        planar.observe,
        "tr_bdf2",
        planar_methods.advance,
        "tilt and skew",
    ),
    "spatial": Level(
        spatial_state.new_work,
        spatial.initial_state,
        state_transfer.spatial_state_at,
        spatial.observe,
        "tr_bdf2",
        spatial_methods.advance,
        "the rollers' way along their axes, bending of the rings",
    ),
}
