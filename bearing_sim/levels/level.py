# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The levels of fidelity, each a record of functions, imported when it is looked up."""

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple


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


def _steady() -> Level:
    from bearing_sim.levels.common.state_transfer import steady_state_at
    from bearing_sim.levels.steady import model

    return Level(
        model.new_work,
        model.initial_state,
        steady_state_at,
        model.observe,
        "lag",
        model.advance,
        "all that happens within a cage turn, and what slip leaves out",
        takes_steps=False,
        advance_profile=model.advance_profile,
        advance_warm_profile=model.advance_warm_profile,
        forget=model.forget,
        supply=model.supply,
    )


def _slip() -> Level:
    from bearing_sim.levels.common.state_transfer import slip_state_at
    from bearing_sim.levels.slip import model, state

    leaves_out = "pocket play, radial vibration, cage whirl, tilt and skew"
    return Level(state.new_work, model.initial_state, slip_state_at, model.observe, "tr_bdf2", model.advance, leaves_out)


def _planar() -> Level:
    from bearing_sim.levels.common.state_transfer import planar_state_at
    from bearing_sim.levels.planar import model, state

    return Level(state.new_work, model.initial_state, planar_state_at, model.observe, "tr_bdf2", model.advance, "tilt and skew")


def _spatial() -> Level:
    from bearing_sim.levels.common.state_transfer import spatial_state_at
    from bearing_sim.levels.spatial import model, state

    leaves_out = "the rollers' way along their axes, twist of the rings"
    return Level(state.new_work, model.initial_state, spatial_state_at, model.observe, "tr_bdf2", model.advance, leaves_out)


class _Levels(Mapping):
    """The levels by name.  One is imported when it is looked up: a run needs one of them, and each takes long to import."""

    def __init__(self, **makers: Callable[[], Level]):
        self._makers: Mapping[str, Callable[[], Level]] = makers
        self._made: dict[str, Level] = {}

    def __getitem__(self, name: str) -> Level:
        if name not in self._made:
            self._made[name] = self._makers[name]()
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


LEVELS: Mapping[str, Level] = _Levels(steady=_steady, slip=_slip, planar=_planar, spatial=_spatial)
