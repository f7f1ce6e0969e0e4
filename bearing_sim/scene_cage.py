# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage of a scene: its body, its pockets, and what guides it."""

from typing import Literal

from pydantic import model_validator

from bearing_sim.quantity import quantity
from bearing_sim.scene_record import record

LAND_FIELDS = ("guide_radius", "guide_clearance", "guide_land_width", "guide_land_distance")
_CLOSE = 1e-8  # m; lengths that were meant to be the same
# What each guidance must know beside the fields that every cage has.
_NEEDS = {
    "outer_ring": ("inner_radius", "guide_clearance", "guide_land_width"),
    "inner_ring": ("outer_radius", "guide_clearance", "guide_land_width"),
    "roller": ("inner_radius", "outer_radius"),
}


@record
class Cage:
    """The cage, guided by two lands of a ring or by the rollers in its pockets (Harris and Kotzalas 2006, chapter 18).

    ``outer_ring``: lands of radius R_g on the outer ring around the cage, whose outer surface is at R_g - c.
    ``inner_ring``: lands of radius R_g on the inner ring within the cage, whose bore is at R_g + c.
    ``roller``: no lands; pockets that also hold the rollers radially carry the cage.
    Of a surface that runs on lands give the radius, or that of the lands, or both where they fit.
    """

    guidance: Literal["outer_ring", "inner_ring", "roller"] = "outer_ring"
    mass: quantity("kg", "cage mass", 1e-6, 1e3, "g")
    polar_inertia: quantity("kg*m^2", "cage inertia about the shaft axis", 1e-12, 1e3) | None = None
    transverse_inertia: quantity("kg*m^2", "cage inertia about a diameter; None: half of the polar one", 1e-12, 1e3) | None = None
    inner_radius: quantity("m", "radius of the cage's bore", 1e-3, 2.0, "mm") | None = None
    outer_radius: quantity("m", "radius of the cage's outer surface", 1e-3, 2.0, "mm") | None = None
    width: quantity("m", "axial width of the cage", 1e-4, 1.0, "mm")
    guide_radius: quantity("m", "radius of the guiding ring's lands, R_g", 1e-3, 2.0, "mm") | None = None
    guide_clearance: quantity("m", "radial clearance between cage and guide lands, c", 1e-6, 5e-3, "mm") | None = None
    guide_land_width: quantity("m", "width of one of the two guide lands", 1e-6, 0.5, "mm") | None = None
    guide_land_distance: quantity("m", "between the middles of both guide lands; None: at the cage's edges", 0.0, 1.0, "mm") | None = None
    land_film: quantity("m", "film in the guide land below which surfaces touch", 0.0, 1e-4, "um") = 3e-6
    land_friction: quantity("", "boundary friction coefficient of the guide land", 0.0, 1.0) = 0.08
    land_squeeze: bool = True  # the film knows how the cage's centre moves; false is Deng's form, of a centre that rests
    pocket_friction: quantity("", "friction coefficient between roller and pocket, mu_c", 0.0, 1.0) = 0.05
    # Level slip has no pockets to act back from and no whirl: it is told what the cage feels of them.
    pocket_reaction: bool = False  # whether at level slip pocket friction brakes the cage as it brakes the rollers
    assumed_eccentricity: quantity("", "eccentricity of the cage at level slip, a fraction of the guide clearance", 0.0, 0.999) = 0.0
    pocket_clearance: quantity("m", "clearance between roller and pocket along the orbit, C_p", 1e-6, 5e-3, "mm") = 1e-4
    pocket_radial_clearance: (
        quantity("m", "the same outwards and inwards, of pockets that guide; None: as along the orbit", 1e-6, 5e-3, "mm") | None
    ) = None
    pocket_film_force: quantity("N", "force of the pocket's oil film when the clearance is used up", 0.0, 1e4) = 67.0
    pocket_film_damping: quantity("", "damping of the pocket's oil film [N s/m]", 0.0, 1e4) = 5.0

    @property
    def has_lands(self) -> bool:
        """Whether lands guide the cage."""
        return self.guidance != "roller"

    @property
    def land_radius(self) -> float:
        """R_g [m]; NaN where there are no lands."""
        if not self.has_lands:
            return float("nan")
        if self.guide_radius is not None:
            return self.guide_radius
        return self.outer_radius + self.guide_clearance if self.guidance == "outer_ring" else self.inner_radius - self.guide_clearance

    @property
    def outside(self) -> float:
        """Radius of the outer surface [m]."""
        return self.land_radius - self.guide_clearance if self.guidance == "outer_ring" else self.outer_radius

    @property
    def bore(self) -> float:
        """Radius of the bore [m]."""
        return self.land_radius + self.guide_clearance if self.guidance == "inner_ring" else self.inner_radius

    @property
    def play(self) -> float:
        """How far the cage's centre may go in what guides it [m]: the clearance of the lands, or that of the pockets outwards."""
        if self.has_lands:
            return self.guide_clearance
        return self.pocket_radial_clearance if self.pocket_radial_clearance is not None else self.pocket_clearance

    @model_validator(mode="after")
    def _guidance_is_complete(self):
        faults = [f"{name}: missing; a cage with guidance {self.guidance} needs it" for name in _NEEDS[self.guidance] if getattr(self, name) is None]
        faults += self._land_faults() if self.has_lands else self._landless_faults()
        if faults:
            raise ValueError("; ".join(faults))
        return self

    def _land_faults(self) -> list[str]:
        running, sign = ("outer_radius", 1) if self.guidance == "outer_ring" else ("inner_radius", -1)
        surface, land, clearance = getattr(self, running), self.guide_radius, self.guide_clearance
        faults = []
        if surface is None and land is None:
            faults.append(f"guide_radius: missing; a cage with guidance {self.guidance} needs the radius of its lands, or {running}")
        elif None not in (surface, land, clearance) and abs(surface - (land - sign * clearance)) > _CLOSE:
            faults.append(
                f"{running}: {1e3 * surface:.6g} mm, but lands at guide_radius {1e3 * land:.6g} mm with guide_clearance {1e3 * clearance:.6g} mm "
                f"leave it at {1e3 * (land - sign * clearance):.6g} mm; give one of {running} and guide_radius, and leave the other out (null)"
            )
        if self.pocket_radial_clearance is not None:
            faults.append(f"pocket_radial_clearance: lands guide this cage ({self.guidance}); leave it out, or set guidance: roller")
        return faults

    def _landless_faults(self) -> list[str]:
        faults = [f"{name}: a cage with guidance roller has no lands; leave it out (null)" for name in LAND_FIELDS if getattr(self, name) is not None]
        if self.assumed_eccentricity:
            faults.append("assumed_eccentricity: a cage with guidance roller has no lands to be eccentric in; leave it out")
        return faults


def drop_other_lands(preset: dict, given: dict) -> None:
    """Take out of a preset's cage what belongs to its lands where the file asks for another guidance.

    What a cage on the other ring keeps is its body and how its lands are made: clearance and width.

    Parameters
    ----------
    preset : the preset's block ``cage``; changed in place.
    given : the file's.
    """
    guidance = given.get("guidance", preset.get("guidance", "outer_ring"))
    if guidance == preset.get("guidance", "outer_ring"):
        return
    for name in LAND_FIELDS if guidance == "roller" else ("guide_radius",):
        preset.pop(name, None)


def cage_faults(bearing) -> list[str]:
    """Return where a bearing's cage does not fit between its rings, in words."""
    cage, inner, low = bearing.cage, bearing.inner_raceway.radius, bearing.outer_raceway.low_radius
    faults = []
    bore_name = "cage.guide_radius" if cage.guidance == "inner_ring" and cage.guide_radius is not None else "cage.inner_radius"
    outside_name = "cage.guide_radius" if cage.guidance == "outer_ring" and cage.guide_radius is not None else "cage.outer_radius"
    if cage.bore >= cage.outside:
        faults.append(
            f"{bore_name}: the cage's bore, at {1e3 * cage.bore:.6g} mm, lies outside its outer surface, at {1e3 * cage.outside:.6g} mm; "
            f"expected a bore between the inner raceway ({1e3 * inner:.6g} mm) and there"
        )
    if cage.bore <= inner:
        faults.append(
            f"{bore_name}: the cage's bore, at {1e3 * cage.bore:.6g} mm, cuts into the inner raceway ({1e3 * inner:.6g} mm); make it larger"
        )
    if cage.outside >= low:
        faults.append(
            f"{outside_name}: the cage's outer surface, at {1e3 * cage.outside:.6g} mm, cuts into the outer raceway ({1e3 * low:.6g} mm at its low "
            "points); make it smaller"
        )
    faults += _land_places(bearing) if cage.has_lands else _pocket_play(bearing)
    if not faults and cage.guidance != "outer_ring" and cage.play >= min(cage.bore - inner, low - cage.outside):
        name, room = "guide_clearance" if cage.has_lands else "pocket_radial_clearance", min(cage.bore - inner, low - cage.outside)
        faults.append(
            f"cage.{name}: {1e3 * cage.play:.6g} mm let the cage reach a raceway, {1e3 * room:.6g} mm away, before its guidance holds it; "
            "expected less, or a slimmer cage"
        )
    return faults


def _land_places(bearing) -> list[str]:
    cage, pitch = bearing.cage, bearing.pitch_radius
    faults = []
    outside = cage.land_radius > pitch
    if outside != (cage.guidance == "outer_ring"):
        side, other = ("outside", "inner_ring") if cage.guidance == "outer_ring" else ("inside", "outer_ring")
        faults.append(
            f"cage.guide_radius: lands of the {cage.guidance.replace('_', ' ')} lie {side} the pitch circle ({1e3 * pitch:.6g} mm), found "
            f"{1e3 * cage.land_radius:.6g} mm; give a radius there, or set guidance: {other}"
        )
    if 2 * cage.guide_land_width > cage.width:
        faults.append("cage.guide_land_width: the two lands together are wider than the cage")
    return faults


def _pocket_play(bearing) -> list[str]:
    """Return a fault where the lobes alone carry the rollers through the radial play of their pockets."""
    cage, lift = bearing.cage, bearing.outer_raceway.d_value / 2
    if cage.play > lift:
        return []
    return [
        f"cage.pocket_radial_clearance: the lobes move the rollers outwards and inwards by {1e6 * lift:.6g} um (half the D value), the pockets "
        f"that guide the cage leave them {1e6 * cage.play:.6g} um; expected more clearance than that"
    ]
