"""What a scene may ask for that not every level has: one table, for refusals, for hints, and for choosing a level."""

from collections.abc import Callable
from typing import Any, NamedTuple

LEVELS = ("slip", "planar", "spatial")  # from the cheapest to the dearest
NUMBERS = {"steady": 0, "slip": 1, "planar": 2, "spatial": 3}  # how a sample names the level that computed it
WITHOUT_SLICES = {"spatial": "planar"}  # what a level is to round-off, several times faster, where nothing that it alone has is asked for


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


def cheaper_levels(scene) -> list[str]:
    """Return the levels cheaper than a scene's own that have all it asks for, the dearest of them first."""
    able = levels_with(asked_for(scene))
    return [level for level in reversed(LEVELS[: LEVELS.index(scene.level)]) if level in able]


def hint(scene) -> str | None:
    """Return one line that names a cheaper level at which a scene computes the same, or None."""
    cheaper = WITHOUT_SLICES.get(scene.level)
    if cheaper is None or cheaper not in levels_with(asked_for(scene)):
        return None
    missing = ", ".join(effect.field for effect in EFFECTS if scene.level in effect.levels and cheaper not in effect.levels)
    return f"level {scene.level}: the scene has nothing that needs it ({missing}); level {cheaper} computes the same several times faster"
