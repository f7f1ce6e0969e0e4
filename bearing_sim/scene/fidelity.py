# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fidelity levels: what each can compute, and the choice of a level for a scene."""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, get_args

Level = Literal["steady", "slip", "planar", "spatial"]
LEVELS = get_args(Level)  # from the lowest to the highest fidelity
WantName = Literal[
    "slip",
    "life",
    "roller_loads",
    "power",
    "fast_transients",
    "pocket_forces",
    "cage_orbit",
    "vibration",
    "misalignment",
    "tilt_and_skew",
    "edge_loads",
]
NUMBERS = {"steady": 0, "slip": 1, "planar": 2, "spatial": 3}  # code of a level in a sample
REDUCES_TO = {"spatial": "planar"}  # equal motion and loads, of straight rollers to round-off, unless the scene uses what only the higher level has


class Effect(NamedTuple):
    """One effect that only some levels have.

    Attributes
    ----------
    field : dotted path in the scene.
    levels : that have the effect, in order of fidelity.
    because : why these levels, as a relative clause.
    asked : scene -> whether the scene asks for it; may be the name of what it asks for.
    """

    field: str
    levels: tuple[str, ...]
    because: str
    asked: Callable[[Any], bool | str]


class Want(NamedTuple):
    """An output or behaviour that a scene can ask for by name in its list ``wants``."""

    levels: tuple[str, ...]  # that have it, in order of fidelity
    because: str  # as in `Effect`


ENDLESS = 1e4  # s; longer than any lag of a cage; at level steady simulated time costs nothing
MARCHING, WHIRLING, TILTING = ("slip", "planar", "spatial"), ("planar", "spatial"), ("spatial",)
WANTS: dict[WantName, Want] = {
    "slip": Want(LEVELS, "which all compute it"),
    "life": Want(LEVELS, "which all compute it"),
    "roller_loads": Want(LEVELS, "which all compute them"),
    "power": Want(LEVELS, "which all compute it"),
    "fast_transients": Want(MARCHING, "which integrate the motion within a cage turn"),
    "pocket_forces": Want(WHIRLING, "whose rollers have clearance in their pockets"),
    "cage_orbit": Want(WHIRLING, "whose cage whirls"),
    "vibration": Want(WHIRLING, "whose rollers and inner ring have radial inertia"),
    "misalignment": Want(TILTING, "whose ring tilts"),
    "tilt_and_skew": Want(TILTING, "whose rollers tilt and skew"),
    "edge_loads": Want(TILTING, "which slices the rollers"),
}


EFFECTS = (
    Effect("operating.moment", ("spatial",), "whose ring tilts", lambda scene: scene.operating.moment is not None),
    Effect("operating.misalignment", ("spatial",), "whose ring tilts", lambda scene: scene.operating.misalignment != 0.0),
    Effect("integration.fixed_step", MARCHING, "which take steps", lambda scene: scene.integration.fixed_step is not None),
    Effect("lubricant.rolling_resistance", LEVELS, "whose contacts resist rolling", lambda scene: scene.lubricant.rolling_resistance.law != "none"),
    Effect("lubricant.supply", LEVELS, "whose rollers and cage move through oil", lambda scene: scene.lubricant.has_bath),
    Effect("bearing.seals", LEVELS, "whose seals rub on the shaft", lambda scene: scene.bearing.seals.law != "none"),
    Effect(
        "bearing.cage.guidance",
        ("steady", "slip"),
        "whose rollers orbit at one speed, as touching ones do",
        lambda scene: "full_complement" if scene.bearing.cage.is_absent else False,
    ),
    Effect("bearing.flanges", LEVELS, "whose rollers rub on flanges", lambda scene: scene.bearing.flanges.present),
    Effect(
        "mounting.housing.backing",
        LEVELS,
        "whose outer ring bends",
        lambda scene: scene.mounting.housing.backing.law not in ("rigid", "free") and scene.mounting.housing.backing.law,
    ),
    Effect(
        "mounting.housing.backing.law",
        ("steady", "slip"),
        "at which the mass of a ring that nothing backs does not matter",
        lambda scene: scene.mounting.housing.backing.law == "free" and "free",
    ),
    Effect("bearing.dimensions_at", LEVELS, "whose rings grow", lambda scene: scene.bearing.dimensions_at == "cold"),
    Effect("support.unbalance", WHIRLING, "whose inner ring has inertia", lambda scene: scene.support.unbalance.amount > 0.0),
    *(Effect(f"wants.{name}", want.levels, want.because, lambda scene, name=name: name in scene.wants) for name, want in WANTS.items()),
)


def asked_for(scene) -> list[Effect]:
    """Return the effects that a scene asks for."""
    return [effect for effect in EFFECTS if effect.asked(scene)]


def refusals(scene) -> list[str]:
    """Return an error message for each effect that the scene asks for but its level would ignore."""
    return [_refusal(effect, scene) for effect in asked_for(scene) if scene.level not in effect.levels]


def _refusal(effect: Effect, scene) -> str:
    word, names = effect.asked(scene), " or ".join(effect.levels)
    said = f"{word} " if isinstance(word, str) else ""
    return f"{effect.field}: {said}needs level {names}, {effect.because}; level {scene.level} would ignore it"


def levels_with(effects) -> list[str]:
    """Return the levels that have all the given effects, in order of fidelity."""
    return [level for level in LEVELS if all(level in effect.levels for effect in effects)]


class Choice(NamedTuple):
    """What `choose` found."""

    level: str | None  # None if no level has everything
    reason: str  # one line


def choose(scene) -> Choice:
    """Return the lowest level that has everything a scene asks for, whatever its own level."""
    asked = asked_for(scene)
    able = levels_with(asked)
    demanding = [effect for effect in asked if effect.levels != LEVELS]
    if not able:
        needs = [f"{effect.field} ({', '.join(effect.levels)})" for effect in demanding]
        return Choice(None, f"no level has all of {'; '.join(needs)}")
    needed = [effect for effect in demanding if effect.levels[0] == able[0]]  # what excludes the lower levels
    because = ", ".join(f"{effect.field}: {effect.because}" for effect in needed) or "nothing in the scene needs a higher one"
    return Choice(able[0], f"level {able[0]} chosen, the lowest with everything that the scene asks for ({because})")


def level_of(sample) -> str:
    """Return the name of the level that computed a sample."""
    return {number: name for name, number in NUMBERS.items()}[int(sample["level"])]


def lower_levels(scene) -> list[str]:
    """Return the levels below a scene's own that have everything it asks for, whatever its steps, the highest of them first."""
    able = levels_with([effect for effect in asked_for(scene) if effect.field != "integration.fixed_step"])
    return [level for level in reversed(LEVELS[: LEVELS.index(scene.level)]) if level in able]


def hint(scene) -> str | None:
    """Return one line on why a level was chosen, or on a lower level that would give the same motion and loads, or None."""
    if scene.level_reason.startswith(f"level {scene.level} "):
        return scene.level_reason
    lower = REDUCES_TO.get(scene.level)
    if lower is None or lower not in levels_with(asked_for(scene)):
        return None
    of_scenes = [effect for effect in EFFECTS if not effect.field.startswith("wants.")]
    missing = ", ".join(effect.field for effect in of_scenes if scene.level in effect.levels and lower not in effect.levels)
    faster = f"level {lower} computes the same motion and loads several times faster"
    upright = ", unless the cage tilts by itself" if scene.level == "spatial" else ""
    return f"level {scene.level}: nothing in the scene needs it ({missing}); {faster}{upright}"
