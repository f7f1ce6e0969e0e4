# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a scene may ask for that not every level has: one table, for refusals, for hints, and for choosing a level."""

from collections.abc import Callable
from typing import Any, NamedTuple

LEVELS = ("steady", "slip", "planar", "spatial")  # from the cheapest to the dearest
NUMBERS = {"steady": 0, "slip": 1, "planar": 2, "spatial": 3}  # how a sample names the level that computed it
REDUCES_TO = {"spatial": "planar"}  # what a level moves and loads like, to round-off, where nothing that it alone has is asked for


class Effect(NamedTuple):
    """One effect that only some levels have.

    Attributes
    ----------
    field : of the scene, as an author writes it.
    levels : that have it, from the cheapest.
    because : why these, as the rest of a sentence about them.
    asked : scene -> whether the scene asks for it; may be a word that tells what it asks for.
    """

    field: str
    levels: tuple[str, ...]
    because: str
    asked: Callable[[Any], bool | str]


class Want(NamedTuple):
    """An output or behaviour that a scene may ask for by name, in its list ``wants``."""

    levels: tuple[str, ...]  # that have it, from the cheapest
    because: str  # as in `Effect`


MARCHING, WHIRLING, TILTING = ("slip", "planar", "spatial"), ("planar", "spatial"), ("spatial",)
WANTS = {
    "slip": Want(LEVELS, "which all tell it"),
    "life": Want(LEVELS, "which all tell it"),
    "roller_loads": Want(LEVELS, "which all tell them"),
    "power": Want(LEVELS, "which all tell it"),
    "fast_transients": Want(MARCHING, "which march through what happens within a cage turn"),
    "pocket_forces": Want(WHIRLING, "whose rollers have play in their pockets"),
    "cage_orbit": Want(WHIRLING, "whose cage whirls"),
    "vibration": Want(WHIRLING, "whose rollers and inner ring have inertia across their paths"),
    "misalignment": Want(TILTING, "whose ring tilts"),
    "tilt_and_skew": Want(TILTING, "whose rollers tilt and skew"),
    "edge_loads": Want(TILTING, "which slices the rollers"),
}


def _crown(scene) -> str:
    law = scene.bearing.roller.crown.law
    return law if law != "none" else ""


EFFECTS = (
    Effect("bearing.roller.crown", ("spatial",), "which slices the rollers", _crown),
    Effect("operating.moment", ("spatial",), "whose ring tilts", lambda scene: scene.operating.moment is not None),
    Effect("operating.misalignment", ("spatial",), "whose ring tilts", lambda scene: scene.operating.misalignment != 0.0),
    Effect("life.lamina", ("spatial",), "which slices the rollers", lambda scene: scene.life.lamina),
    Effect("lubricant.pumping", LEVELS, "whose contacts pump oil", lambda scene: scene.lubricant.pumping),
    Effect("bearing.ring_growth.centrifugal", LEVELS, "whose rings grow", lambda scene: scene.bearing.ring_growth.centrifugal),
    Effect("bearing.ring_growth.thermal", LEVELS, "whose rings grow", lambda scene: scene.bearing.ring_growth.thermal),
    *(Effect(f"wants.{name}", want.levels, want.because, lambda scene, name=name: name in scene.wants) for name, want in WANTS.items()),
)


def asked_for(scene) -> list[Effect]:
    """Return the effects that a scene asks for."""
    return [effect for effect in EFFECTS if effect.asked(scene)]


def refusals(scene) -> list[str]:
    """Return, for each effect that a scene asks for and its level would ignore, which level it needs and why."""
    return [_need(effect, scene) for effect in asked_for(scene) if scene.level not in effect.levels]


def _need(effect: Effect, scene) -> str:
    word, names = effect.asked(scene), " or ".join(effect.levels)
    said = f"{word} " if isinstance(word, str) else ""
    return f"{effect.field}: {said}needs level {names}, {effect.because}; level {scene.level} would ignore it"


def levels_with(effects) -> list[str]:
    """Return the levels that have all of some effects, from the cheapest to the dearest."""
    return [level for level in LEVELS if all(level in effect.levels for effect in effects)]


class Choice(NamedTuple):
    """What `choose` found."""

    level: str | None  # None where no level has all that is asked for
    reason: str  # one line


def choose(scene) -> Choice:
    """Return the cheapest level that has all that a scene asks for; its own level does not count."""
    asked = asked_for(scene)
    able = levels_with(asked)
    demanding = [effect for effect in asked if effect.levels != LEVELS]
    if not able:
        told = [f"{effect.field} ({', '.join(effect.levels)})" for effect in demanding]
        return Choice(None, f"no level has all of {'; '.join(told)}")
    needed = [effect for effect in demanding if effect.levels[0] == able[0]]  # what rules out the cheaper ones
    because = ", ".join(f"{effect.field}: {effect.because}" for effect in needed) or "nothing that is asked for needs a dearer one"
    return Choice(able[0], f"level {able[0]} chosen, the cheapest with all that is asked for ({because})")


def level_of(sample) -> str:
    """Return the name of the level that computed a sample."""
    return {number: name for name, number in NUMBERS.items()}[int(sample["level"])]


def cheaper_levels(scene) -> list[str]:
    """Return the levels cheaper than a scene's own that have all it asks for, the dearest of them first."""
    able = levels_with(asked_for(scene))
    return [level for level in reversed(LEVELS[: LEVELS.index(scene.level)]) if level in able]


def hint(scene) -> str | None:
    """Return one line that says why a level was chosen, or names a cheaper one at which the scene computes the same, or None."""
    if scene.level_reason.startswith(f"level {scene.level} "):
        return scene.level_reason
    cheaper = REDUCES_TO.get(scene.level)
    if cheaper is None or cheaper not in levels_with(asked_for(scene)):
        return None
    of_scenes = [effect for effect in EFFECTS if not effect.field.startswith("wants.")]
    missing = ", ".join(effect.field for effect in of_scenes if scene.level in effect.levels and cheaper not in effect.levels)
    faster = f"level {cheaper} computes the same motion and loads several times faster"
    return f"level {scene.level}: the scene has nothing that needs it ({missing}); {faster}"
