# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The levels of fidelity, each a record of functions."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from bearing_sim.integrators.history import new_history
from bearing_sim.integrators.memory import new_memory
from bearing_sim.levels import carried, planar, planar_methods, planar_state, slip, slip_methods, spatial, spatial_methods, spatial_state, steady


class Method(NamedTuple):
    """A level advanced by one integrator; compiled when first called, so that a run compiles what it uses.

    Attributes
    ----------
    new_memory : number of states -> what the method keeps; ``scratch`` in it is free between calls.
    advance : compiled, see `bearing_sim.levels.advance.advance_by`.
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
    state_at : (params, work, sample of any level) -> state that goes on from there, see `bearing_sim.levels.carried`.
    observe : compiled, see `bearing_sim.levels.slip`.
    methods : by name (see `bearing_sim.methods`), the level's own first.
    leaves_out : what the level does not model, in words.
    advance_course : compiled, goes over a whole course of inputs at once; None at a level that marches.
    """

    new_work: Callable
    initial_state: Callable
    state_at: Callable
    observe: Callable
    methods: Mapping[str, Method]
    leaves_out: str
    advance_course: Callable | None = None

    def method(self, name: str | None) -> Method:
        """Return the method of that name, or the level's own."""
        return self.methods[name if name is not None else next(iter(self.methods))]


LEVELS = {
    "steady": Level(
        steady.new_work,
        steady.initial_state,
        carried.steady_state_at,
        steady.observe,
        {"lag": Method(new_memory, steady.advance)},
        "all that happens within a cage turn, and what slip leaves out",
        steady.advance_course,
    ),
    "slip": Level(
        slip.new_work,
        slip.initial_state,
        carried.slip_state_at,
        slip.observe,
        {
            "rosenbrock2": Method(new_memory, slip.advance, slip_methods.advance_fixed),
            "bdf": Method(new_history, slip_methods.advance_bdf),
            "rk45": Method(new_memory, slip_methods.advance_rk45),
        },
        "pocket play, radial vibration, cage whirl, tilt and skew",
    ),
    "planar": Level(
        planar_state.new_work,
        planar.initial_state,
        carried.planar_state_at,
        planar.observe,
        {
            "sdirk2": Method(new_memory, planar.advance, planar_methods.advance_fixed),
            "bdf": Method(new_history, planar_methods.advance_bdf),
            "rk45": Method(new_memory, planar_methods.advance_rk45),
        },
        "tilt and skew",
    ),
    "spatial": Level(
        spatial_state.new_work,
        spatial.initial_state,
        carried.spatial_state_at,
        spatial.observe,
        {
            "sdirk2": Method(new_memory, spatial.advance, spatial_methods.advance_fixed),
            "bdf": Method(new_history, spatial_methods.advance_bdf),
            "rk45": Method(new_memory, spatial_methods.advance_rk45),
        },
        "the rollers' way along their axes, bending of the rings",
    ),
}
