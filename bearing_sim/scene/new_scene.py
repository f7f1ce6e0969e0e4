# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write the file of a new scene from a designation, an oil, a speed and a load: every choice that nobody made is named in a comment."""

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import yaml

from bearing_sim.scene.fidelity import WHIRLING
from bearing_sim.scene.loader import scene_from_mapping
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import value_at

_WIDTH = 110  # of comments
_LOW_LOAD = 12.0  # C/P above which a load is low
# Shaft seats of radial roller bearings under circumferential load on the inner ring: bore up to [mm], class under low load, class under normal
# or high load (Schaeffler, Technical principles, shaft tolerances of radial bearings with cylindrical bore).
_SHAFT_FITS = ((60.0, "j6", "k6"), (200.0, "k6", "m6"), (math.inf, "m6", "n6"))
_HOUSING_FIT = "H7"  # point load on the outer ring, unsplit housing, from the same table


_JET_FROM = 0.4  # n d_m [1e6 mm/min] from which makers advise an oil jet; below it oil stands in the bearing
_TEMPERATURES = {"oil_jet": "60 degC", "oil_bath": "40 degC", "grease": "40 degC"}  # where nobody gives one; assumptions
# Normal cleanliness without a filter (ISO 281, annex A); assumption.
_CLEANLINESS = {"oil": "bath_17_14", "grease": "grease_normal_cleanliness"}


_STEEL = 7850.0  # kg/m^3
_SHAFT_WIDTHS = (3.0, 1.0, 10.0)  # lengths of a shaft that moves with the inner ring, usual, least and most, over the bearing's width; assumptions


class ShaftEnd(NamedTuple):
    """What a shaft leads to: its temperature and distance, each usual, least and most; all of them assumptions."""

    what: str
    temperatures: tuple[float, float, float]  # [degC]
    distances: tuple[float, float, float]  # from the bearing, over its bore diameter


SHAFTS = {
    # Windings of thermal classes B to F reach 120 to 145 degC (IEC 60034-1); the rotor's core is about as warm.
    "motor": ShaftEnd("the rotor of an electric motor", (120.0, 80.0, 145.0), (0.5, 0.25, 1.5)),
    "gear": ShaftEnd("a gear, whose teeth and oil heat it", (90.0, 70.0, 110.0), (0.75, 0.25, 1.5)),
    "cold": ShaftEnd("what is cold, such as the impeller of a water pump", (15.0, 0.0, 40.0), (1.5, 0.5, 3.0)),
}
"""What the choices of ``new --shaft`` are; ``free``: ends in the air that only give off heat."""


class Wish(NamedTuple):
    """What somebody wants to know about a bearing; texts as a scene file has them.

    Attributes
    ----------
    bearing : designation, or name of a bearing in the catalogue.
    lubricant : block ``lubricant``, such as ``{"oil": "ISO VG 68"}``; without a supply the speed decides.
    speed, load : of the shaft, and on it.
    temperature : of lubricant and bearing; None: a thermal network computes the temperatures.
    level : of fidelity.
    mass : of shaft and rotor that moves with the inner ring; None: estimated, with a range.  Levels steady and slip have no use for it.
    shaft : what heats or cools the shaft, a name of `SHAFTS`, or ``free``; None: nobody said, which a run tells where it is unsafe.
    """

    bearing: str
    lubricant: dict
    speed: str
    load: str
    temperature: str | None = None
    level: str = "slip"
    mass: str | None = None
    shaft: str | None = None


def new_scene(wish: Wish, name: str, command: str) -> tuple[str, Scene]:
    """Return the text of a scene file with comments, and the scene that it gives.

    Parameters
    ----------
    wish : what the scene is about.
    name : of the scene.
    command : the command line that asks for it, for the comment at the top.

    Raises
    ------
    bearing_sim.scene.loader.SceneError
        The wish has errors; all of them are listed.
    """
    tree = _tree(wish, name)
    scene = scene_from_mapping(tree, "new scene")
    _choose(tree, scene, wish)
    scene = scene_from_mapping(tree, "new scene")
    lines = [*_title(scene, wish, command), f"name: {_written(name)}", f"level: {wish.level}  # steady, slip, planar or spatial", ""]
    notes = {
        "bearing": _about_bearing(scene),
        "mounting": ["Assumption: a shaft that turns under a load that stands still, usual classes by Schaeffler's table; materials are steel."],
        "lubricant": _about_lubricant(scene, wish),
        "heat": [*_about_heat(wish)],
        "support": [] if wish.mass is not None else _about_mass(),
        "life": ["Assumption: normal cleanliness, for a_ISO of ISO 281; none: a_ISO = 1."],
    }
    for block in ("bearing", "mounting", "support", "lubricant", "operating", "heat", "life", "uncertainty"):
        if block in tree:
            written = yaml.dump({block: tree[block]}, sort_keys=False, allow_unicode=True, width=_WIDTH)
            lines += [*_comments(notes.get(block, ())), *written.splitlines(), ""]
    return "\n".join(lines[:-1]) + "\n", scene


def shaft_fit(scene: Scene) -> str:
    """Return the class of ISO 286 usual for the shaft's seat of a roller bearing, by its bore and load (Schaeffler, Technical principles)."""
    bore, load = 1e3 * scene.bearing.bore_diameter, scene.operating.radial_load
    low, normal = next(classes for largest, *classes in _SHAFT_FITS if bore <= largest)
    return low if load * _LOW_LOAD < rate(scene.bearing).dynamic else normal


def default_name(path: Path | None) -> str:
    """Return the name of a scene by the file that it is written to."""
    return path.stem if path is not None else "new_scene"


def _tree(wish: Wish, name: str) -> dict:
    tree = {
        "name": name,
        "level": wish.level,
        "bearing": {"preset": wish.bearing},
        "lubricant": dict(wish.lubricant),
        "operating": {"shaft_speed": wish.speed, "radial_load": wish.load},
    }
    if wish.temperature is not None:
        tree["lubricant"]["temperature"] = wish.temperature
    return tree


def _choose(tree: dict, scene: Scene, wish: Wish) -> None:
    """Write what nobody chose into the tree of a scene, in place: supply, temperatures, fits, cleanliness."""
    lubricant, is_grease = tree["lubricant"], scene.lubricant.grease is not None
    if "supply" not in lubricant and not is_grease:
        fast = abs(scene.operating.shaft_speed) * 30 / math.pi * 1e3 * scene.bearing.pitch_diameter >= 1e6 * _JET_FROM
        lubricant["supply"] = "oil_jet" if fast else "oil_bath"
    if wish.temperature is None:
        supply = "grease" if is_grease else lubricant["supply"]
        law = supply["law"] if isinstance(supply, dict) else supply
        lubricant["temperature"] = _TEMPERATURES.get(law, _TEMPERATURES["oil_jet"])
        tree["heat"] = {"law": "network", "ambient_temperature": "20 degC", **_shaft_block(tree, scene, wish)}
    tree["life"] = {"a_iso": _CLEANLINESS["grease" if is_grease else "oil"]}
    if wish.mass is not None:
        tree["support"] = {"shaft": {"mass": wish.mass}}
    elif wish.level in WHIRLING:
        usual, low, high = (f"{_shaft_mass(scene, widths):.3g} kg" for widths in _SHAFT_WIDTHS)
        tree["support"] = {"shaft": {"mass": usual}}
        source = "how much of shaft and rotor moves with the inner ring (assumption)"
        tree.setdefault("uncertainty", {})["support.shaft.mass"] = {"low": low, "high": high, "distribution": "log_uniform", "source": source}
    if scene.bearing.dimensions_at == "cold":
        tree["mounting"] = {"shaft": {"fit": shaft_fit(scene)}, "housing": {"fit": _HOUSING_FIT}}


def _shaft_block(tree: dict, scene: Scene, wish: Wish) -> dict:
    """Return the part of the block ``heat`` on what the shaft leads to, and write the ranges of it into the tree."""
    if wish.shaft in (None, "free"):
        return {}
    end, bore = SHAFTS[wish.shaft], 1e3 * scene.bearing.bore_diameter
    usual, *ends = (f"{celsius:g} degC" for celsius in end.temperatures)
    distance, *places = (f"{round(share * bore, 1):g} mm" for share in end.distances)
    for name, (low, high) in (("temperature", ends), ("distance", places)):
        field = "heat.shaft.back_temperature" if name == "temperature" else "heat.shaft.back"
        source = f"{name} of {end.what} (assumption)"
        tree.setdefault("uncertainty", {})[field] = {"low": low, "high": high, "distribution": "uniform", "source": source}
    return {"shaft": {"back": distance, "back_temperature": usual}}


def _about_heat(wish: Wish) -> Iterator[str]:
    yield "The temperatures follow from the losses. Assumptions: a plummer block of usual size, in air that a machine stirs."
    if wish.shaft in SHAFTS:
        yield f"Behind the bearing the shaft leads to {SHAFTS[wish.shaft].what}: assumptions, with ranges in the block uncertainty."
    else:
        yield "Both ends of the shaft only give off heat. Where something heats or cools the shaft, say so: new --shaft motor, gear or cold."
    yield "Where temperatures are known, give them: heat: {law: given, inner_ring: 70 degC, outer_ring: 60 degC}."


def _shaft_mass(scene: Scene, widths: float) -> float:
    """Return the mass of a piece of a solid steel shaft, so many bearing widths long [kg]."""
    return widths * _STEEL * math.pi / 4.0 * scene.bearing.bore_diameter**2 * scene.bearing.boundary_width


def _about_mass() -> list[str]:
    usual, low, high = _SHAFT_WIDTHS
    return [
        "The mass of shaft and rotor that moves with the inner ring, which vibrates on its rollers at some kHz: where the passing rollers excite it, "
        "it decides slip and life. Nobody gave it (new --mass). "
        f"Assumption: a solid shaft of {usual:g} bearing widths; the range in the block uncertainty is that of {low:g} to {high:g}."
    ]


def _title(scene: Scene, wish: Wish, command: str) -> list[str]:
    lubricant = wish.lubricant.get("oil") or wish.lubricant.get("grease")
    about = f"{scene.bearing.designation or scene.bearing.name} in {lubricant}, {wish.speed}, {wish.load}."
    fields = "Every field, its unit, range and meaning: bearing-sim fields, such as bearing-sim fields lubricant."
    return [*_comments([about, f"Written by: {command}", fields]), ""]


def _about_bearing(scene: Scene) -> Iterator[str]:
    bearing = scene.bearing
    rated = rate(bearing)
    yield (
        f"d {_mm(bearing.bore_diameter)}, D {_mm(bearing.outside_diameter)}, B {_mm(bearing.boundary_width)}; C {1e-3 * rated.dynamic:.4g} kN, "
        f"C_0 {1e-3 * rated.static:.4g} kN, C_u {1e-3 * rated.fatigue_limit:.4g} kN. {bearing.source.strip()}"
    )
    if bearing.estimated:
        yield "Estimated, because no source prints it (give what you know here; the ranges go into bearing-sim uncertainty):"
    for each in bearing.estimated:
        value = value_at(bearing, each.field)
        shown = _mm(value) if isinstance(value, float) and not each.field.endswith(("mass", "friction")) else f"{value:.4g}"
        yield f"  {each.field}: {shown}, {each.by}"


def _about_lubricant(scene: Scene, wish: Wish) -> Iterator[str]:
    lubricant, chosen = scene.lubricant, "" if "supply" in wish.lubricant or scene.lubricant.grease is not None else "Assumption: the supply. "
    yield f"{lubricant.oil.name}: {lubricant.oil.source.strip()}"
    if wish.temperature is None:
        network = {"oil_jet": "of the oil that comes in", "circulating": "of the oil that comes in"}
        yield f"{chosen}Assumption: the temperature, {network.get(lubricant.supply.law, 'from which the search for thermal equilibrium begins')}."
    elif chosen:
        yield chosen.strip()


def _mm(length: float) -> str:
    return f"{1e3 * length:.5g} mm"


def _written(text: str) -> str:
    return yaml.dump(text, allow_unicode=True).splitlines()[0]


def _comments(notes) -> list[str]:
    return [line for note in notes for line in textwrap.wrap(note, _WIDTH, initial_indent="# ", subsequent_indent="#   ", drop_whitespace=True)]
