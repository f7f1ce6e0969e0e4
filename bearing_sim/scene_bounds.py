# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bounds that no single field has: plays of the cage, moments too large for the bearing, and steps too long for the speed."""

import math

LONGEST_SHARE = 0.5  # of a roller pitch of cage rotation that a fixed step may take


def play_faults(bearing) -> list[str]:
    """Return which plays of a bearing's cage are too small or too large for anything to be left, in words: what, where, the bound, what to do."""
    cage, roller, faults = bearing.cage, bearing.roller, []
    if cage.has_lands and cage.guide_clearance <= cage.land_film:
        faults.append(
            f"cage.guide_clearance: {1e6 * cage.guide_clearance:.6g} um is no more than cage.land_film, the film at which surfaces touch, so that "
            f"the cage would touch its land all round; expected more than {1e6 * cage.land_film:.6g} um, or a smaller land_film"
        )
    if cage.guidance == "outer_ring" and cage.land_radius >= bearing.outer_raceway.low_radius:
        faults.append(
            f"cage.guide_radius: {1e3 * cage.land_radius:.6g} mm puts the guide lands outside the raceway; expected less than "
            f"outer_raceway.low_radius, {1e3 * bearing.outer_raceway.low_radius:.6g} mm"
        )
    bar = 2 * math.pi * bearing.pitch_radius / roller.count - roller.diameter - 2 * cage.pocket_clearance
    if bar <= 0.0:
        bound = cage.pocket_clearance + bar / 2
        use = f"expected less than {1e3 * bound:.6g} mm" if bound > 0.0 else "use fewer or thinner rollers"
        faults.append(
            f"cage.pocket_clearance: {1e3 * cage.pocket_clearance:.6g} mm leaves no bar between the pockets of {roller.count} rollers of "
            f"{1e3 * roller.diameter:.6g} mm; {use}"
        )
    return faults


def moment_faults(scene) -> list[str]:
    """Return why a scene's moment is beyond any bearing of its size, in words."""
    bearing, moment = scene.bearing, scene.operating.moment
    # C_0r = 44 (1 - gamma) Z L D_w in N and mm (ISO 76), at a lever as long as a roller
    static_rating = 44e6 * (1 - bearing.diameter_ratio) * bearing.roller.count * bearing.roller.length * bearing.roller.diameter
    bound = static_rating * bearing.roller.length
    if moment is None or moment <= bound:
        return []
    return [
        f"operating.moment: {moment:.6g} N m would turn the ring over; expected at most {bound:.6g} N m, the static load rating at a lever of "
        f"roller.length"
    ]


def step_faults(scene) -> list[str]:
    """Return why a scene's fixed step is too long, in words; a step without error control must not jump over a lobe or a roller."""
    step, bearing, speed = scene.integration.fixed_step, scene.bearing, abs(scene.operating.shaft_speed)
    if step is None or speed == 0.0:
        return []
    pitch = 2 * math.pi / (bearing.roller.count * 0.5 * speed * (1 - bearing.diameter_ratio))
    if step <= LONGEST_SHARE * pitch:
        return []
    bound = f"at most half a pitch, {1e6 * LONGEST_SHARE * pitch:.6g} us, or adaptive steps (leave fixed_step out)"
    taken = f"{step / pitch:.3g} roller pitches of the cage at {speed * 30 / math.pi:.6g} rpm"
    return [f"integration.fixed_step: {1e6 * step:.6g} us is {taken}; expected {bound}"]
