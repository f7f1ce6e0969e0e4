# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The levels of fidelity, each a record of functions."""

from collections.abc import Callable, Mapping
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
from bearing_sim.numerics.bdf import new_history
from bearing_sim.numerics.time_stepping import new_memory


class Method(NamedTuple):
    """A level advanced by one integrator; compiled when first called, so that a run compiles what it uses.

    Attributes
    ----------
    new_memory : number of states -> what the method keeps; ``scratch`` in it is free between calls.
    advance : compiled, see `bearing_sim.levels.common.advance.advance_by`.
    advance_fixed : the same without error control, in steps of the maximum step; None where the method lives by its estimates.
    """

    new_memory: Callable
    advance: Callable
    advance_fixed: Callable | None = None


class Level(NamedTuple):
    """One complete model.

    Attributes
    ----------
    new_work : params -> workspace.
    initial_state : (params, work, shaft speed, load y, load z) -> state of ideal rolling.
    state_at : (params, work, sample of any level) -> state that continues from there, see `bearing_sim.levels.common.state_transfer`.
    observe : compiled, see `bearing_sim.levels.slip.model`.
    methods : by name (see `bearing_sim.scene.methods`), the level's own first.
    leaves_out : what the level does not model, in words.
    advance_profile : compiled, goes over a whole course of inputs at once; None at a level that marches.
    """

    new_work: Callable
    initial_state: Callable
    state_at: Callable
    observe: Callable
    methods: Mapping[str, Method]
    leaves_out: str
    advance_profile: Callable | None = None

    def method(self, name: str | None) -> Method:
        """Return the method called ``name``, or the level's own."""
        return self.methods[name if name is not None else next(iter(self.methods))]


LEVELS = {
    "steady": Level(
        steady.new_work,
        steady.initial_state,
        state_transfer.steady_state_at,
        steady.observe,
        {"lag": Method(new_memory, steady.advance)},
        "all that happens within a cage turn, and what slip leaves out",
        steady.advance_profile,
    ),
    "slip": Level(
        slip_state.new_work,
        slip.initial_state,
        state_transfer.slip_state_at,
        slip.observe,
        {
            "rosenbrock2": Method(new_memory, slip_methods.advance_rosenbrock2, slip_methods.advance_rosenbrock2_fixed),
            "bdf": Method(new_history, slip_methods.advance_bdf),
        },
        "pocket play, radial vibration, cage whirl, tilt and skew",
    ),
    "planar": Level(
        planar_state.new_work,
        planar.initial_state,
        state_transfer.planar_state_at,
        planar.observe,
        {
            "sdirk2": Method(new_memory, planar_methods.advance_sdirk2, planar_methods.advance_sdirk2_fixed),
            "bdf": Method(new_history, planar_methods.advance_bdf),
        },
        "tilt and skew",
    ),
    "spatial": Level(
        spatial_state.new_work,
        spatial.initial_state,
        state_transfer.spatial_state_at,
        spatial.observe,
        {
            "sdirk2": Method(new_memory, spatial_methods.advance_sdirk2, spatial_methods.advance_sdirk2_fixed),
        },
        "the rollers' way along their axes, bending of the rings",
    ),
}
