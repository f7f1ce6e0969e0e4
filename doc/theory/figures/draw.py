# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Draw the figures of the theory manual: ``python doc/theory/figures/draw.py`` writes the SVG files beside this script.

The figures are sketches: displacements, clearances and tilts are exaggerated, signs and directions are those of the code.
"""

import argparse
import math
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc, Circle, Polygon, Rectangle

STEEL, LINE = "#d8dee6", "#30363d"
FORCE, MOTION, FRAME, CAGE = "#b42318", "#1f6f3f", "#1d4e89", "#8a5a00"


def arrow(axes, start, end, colour, text="", at=1.0, shift=(0.0, 0.0), size=11, width=1.6):
    """Draw an arrow from ``start`` to ``end`` and write ``text`` at a fraction ``at`` of its length, shifted."""
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": 0, "shrinkB": 0})
    if text:
        x, y = (start[i] + at * (end[i] - start[i]) + shift[i] for i in range(2))
        axes.text(x, y, text, color=colour, fontsize=size, ha="center", va="center")


def measure(axes, start, end, style="<->"):
    """Draw a thin dimension arrow."""
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": style, "color": LINE, "lw": 1, "shrinkA": 0, "shrinkB": 0})


def turn(axes, centre, radius, start, end, colour, text="", text_at=None, size=11):
    """Draw a circular arrow from angle ``start`` to ``end`` [deg]; its head is at ``end``."""
    low, high = min(start, end), max(start, end)
    axes.add_patch(Arc(centre, 2 * radius, 2 * radius, theta1=low, theta2=high, color=colour, lw=1.6))
    sense = 1.0 if end > start else -1.0
    a, b = math.radians(end - 4.0 * sense), math.radians(end)
    tail, head = ((centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)) for angle in (a, b))
    axes.annotate("", xy=head, xytext=tail, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0})
    if text:
        angle = math.radians(0.5 * (start + end) if text_at is None else text_at)
        axes.text(
            centre[0] + 1.18 * radius * math.cos(angle),
            centre[1] + 1.18 * radius * math.sin(angle),
            text,
            color=colour,
            fontsize=size,
            ha="center",
            va="center",
        )


def plain(axes, title, x_range, y_range):
    """Prepare axes for a sketch."""
    axes.set_title(title, fontsize=12, loc="left", color=LINE)
    axes.set_xlim(*x_range)
    axes.set_ylim(*y_range)
    axes.set_aspect("equal")
    axes.axis("off")


def polar(radius, degrees, centre=(0.0, 0.0)):
    """Return a point at a radius and an angle about a centre."""
    angle = math.radians(degrees)
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def bearing(axes):
    """(a) The plane of the bearing: axes, azimuths, centres, speeds."""
    plain(axes, "(a) bearing; X points at the reader", (-1.55, 1.75), (-1.45, 1.65))
    ring, cage = (0.14, 0.06), (-0.05, 0.09)
    angles = np.radians(np.linspace(0, 360, 361))
    raceway = 1.12 - 0.05 * np.cos(3 * angles)
    outside = Polygon(np.stack([1.3 * np.cos(angles), 1.3 * np.sin(angles)], 1), closed=True, fc=STEEL, ec=LINE, lw=1)
    axes.add_patch(outside)
    axes.add_patch(Polygon(np.stack([raceway * np.cos(angles), raceway * np.sin(angles)], 1), closed=True, fc="white", ec=LINE, lw=1.2))
    axes.add_patch(Circle(ring, 0.66, fc=STEEL, ec=LINE, lw=1.2))
    axes.add_patch(Circle(ring, 0.42, fc="white", ec=LINE, lw=0.8))
    axes.add_patch(Circle(cage, 0.9, fc="none", ec=CAGE, lw=1, ls="--"))
    for k in range(9):
        axes.add_patch(Circle(polar(0.885, 50 + 40 * k), 0.17, fc="white", ec=LINE, lw=1))
    roller = polar(0.885, 50)
    arrow(axes, (0, 0), (1.6, 0), FRAME, "Y", shift=(0.08, 0.0))
    arrow(axes, (0, 0), (0, 1.5), FRAME, "Z", shift=(0.0, 0.09))
    axes.plot([0, roller[0]], [0, roller[1]], color=LINE, lw=0.9)
    axes.text(0.33, 0.52, "$r_j$", fontsize=11)
    axes.add_patch(Arc((0, 0), 0.6, 0.6, theta1=0, theta2=50, color=LINE, lw=0.9))
    axes.text(0.3, 0.11, r"$\varphi_j$", fontsize=11)
    arrow(axes, roller, polar(1.42, 50), FRAME, "$e_r$", shift=(0.08, 0.04))
    arrow(axes, roller, polar(0.38, 140, roller), FRAME, "$e_t$", shift=(-0.03, 0.1))
    points = (((0, 0), "O", (-0.1, -0.09)), (ring, "$(y_i, z_i)$", (0.2, -0.12)), (cage, "$(y_c, z_c)$", (-0.26, 0.05)))
    for point, text, shift in points:
        axes.plot(*point, "o", ms=3.5, color=LINE)
        axes.text(point[0] + shift[0], point[1] + shift[1], text, fontsize=9, ha="center", va="center")
    turn(axes, ring, 0.54, 200, 250, MOTION, r"$\omega_i$", 225)
    turn(axes, cage, 0.98, 148, 176, CAGE, r"$\omega_c$", 162)
    turn(axes, roller, 0.115, 300, 60, MOTION)
    axes.text(roller[0] + 0.02, roller[1] - 0.025, "$w$", fontsize=9, color=MOTION, ha="center", va="center")
    arrow(axes, (ring[0] - 0.02, -0.42), (ring[0] - 0.02, -1.05), FORCE, "$F_y, F_z$ act on the inner ring", at=1.0, shift=(0.0, -0.33), size=9)
    arrow(axes, polar(1.48, -28), polar(1.09, -28), LINE, r"contour $R_e(\varphi)$", at=0.0, shift=(0.2, -0.09), size=9, width=0.8)


def roller_forces(axes):
    """(b) One roller: forces of both raceways, speeds."""
    plain(axes, "(b) forces on a roller", (-1.75, 1.75), (-1.85, 1.75))
    axes.add_patch(Rectangle((-1.6, 0.82), 3.2, 0.18, fc=STEEL, ec=LINE, angle=-4, rotation_point="center"))
    axes.add_patch(Rectangle((-1.6, -0.98), 3.2, 0.18, fc=STEEL, ec=LINE, angle=9, rotation_point="center"))
    axes.text(-1.55, 1.1, "outer ring, rests", fontsize=9)
    axes.text(-1.62, -1.42, "inner ring, displaced", fontsize=9)
    axes.add_patch(Circle((0, 0), 0.78, fc="white", ec=LINE, lw=1.3))
    arrow(axes, (0, 0), (0, 0.5), FRAME, "$e_r$", shift=(0.12, 0.0))
    arrow(axes, (0, 0), (-0.5, 0), FRAME, "$e_t$", shift=(0.0, 0.13))
    n = np.array([-math.sin(math.radians(9)), math.cos(math.radians(9))])
    p = np.array([-n[1], n[0]])
    foot = -0.78 * n
    arrow(axes, foot - 0.62 * n, foot, FORCE, "$Q_i$", at=0.0, shift=(0.17, -0.02))
    arrow(axes, foot, foot + 0.75 * p, FORCE, "$T_i$", shift=(-0.02, -0.13))
    arrow(axes, (0.05, 1.5), (0.02, 0.8), FORCE, "$Q_e$", at=0.0, shift=(0.2, 0.02))
    arrow(axes, (0.0, 0.78), (-0.62, 0.8), FORCE, "$T_e$", shift=(0.05, -0.14))
    corner = 0.35 * p + np.array([0.42, -0.28])
    arrow(axes, corner, corner + 0.42 * n, FRAME, "$n$", shift=(0.1, 0.02), size=10, width=1.1)
    arrow(axes, corner, corner + 0.42 * p, FRAME, "$p$", shift=(0.0, 0.12), size=10, width=1.1)
    turn(axes, (0, 0), 0.64, 130, 60, MOTION, "$w$", 48)
    arrow(axes, (0.82, 0.32), (1.5, 0.32), FORCE, "drag $F_{ch}$", shift=(-0.1, 0.15), size=9)
    arrow(axes, (-0.85, 0.3), (-1.45, 0.3), MOTION, r"$v_t = r\dot\varphi$", shift=(0.1, 0.17), size=10)
    axes.text(
        0.0,
        -1.78,
        r"$\Delta u_i = \omega_i R_i - v_p - w R_w$,    $\Delta u_e = w R_w - r\dot\varphi$;    T has the sign of $\Delta u$",
        fontsize=9,
        ha="center",
    )


def pocket(axes):
    """(c) A roller in its pocket."""
    plain(axes, "(c) pocket", (-1.7, 1.7), (-1.75, 1.75))
    for side in (-1, 1):
        axes.add_patch(Rectangle((side * 1.12 - 0.12, -0.7), 0.24, 1.4, fc="#f3e3c3", ec=CAGE, lw=1.2))
    axes.plot([0, 0], [-1.6, 1.25], color=CAGE, lw=0.9, ls="--")
    axes.text(0.05, -1.6, r"pocket's middle, at $\theta_c + 2\pi j/Z$", fontsize=9, color=CAGE)
    centre = (-0.2, 0.06)
    axes.add_patch(Circle(centre, 0.76, fc="white", ec=LINE, lw=1.3))
    axes.plot(*centre, "o", ms=3.5, color=LINE)
    arrow(axes, (0, 0.95), (0, 1.45), CAGE, r"$e_\rho$", shift=(0.15, 0.0))
    arrow(axes, (0, 0.95), (-0.5, 0.95), CAGE, r"$e_\tau$", shift=(0.0, 0.14))
    measure(axes, (0.0, -0.28), (centre[0], -0.28), "-|>")
    axes.text(-0.1, -0.42, "$s$", fontsize=11, ha="center")
    measure(axes, (0.76, -0.95), (1.0, -0.95))
    axes.text(0.88, -1.15, "$C_p$ ($s = 0$)", fontsize=9, ha="center")
    contact = (-0.98, 0.06)
    arrow(axes, contact, (contact[0] + 0.6, contact[1]), FORCE, "$F$", shift=(-0.1, 0.14))
    arrow(axes, (contact[0] + 0.02, contact[1]), (contact[0] + 0.02, contact[1] - 0.55), FORCE, r"$\mu F$", shift=(0.2, 0.05))
    turn(axes, centre, 0.55, 75, 15, MOTION, "$w$", 45)
    axes.text(
        0.0,
        -1.85,
        r"on the roller: $-F(e_\tau + \mu e_\rho)$, on the cage the opposite",
        fontsize=9,
        ha="center",
        color=FORCE,
    )


def land(axes):
    """(d) The guide land."""
    plain(axes, "(d) guide land (outer ring)", (-1.6, 1.7), (-1.7, 1.6))
    axes.add_patch(Circle((0, 0), 1.36, fc=STEEL, ec=LINE))
    axes.add_patch(Circle((0, 0), 1.12, fc="#fdf6e3", ec=LINE, lw=1.2))
    centre = polar(0.17, 35)
    axes.add_patch(Circle(centre, 0.9, fc="#f3e3c3", ec=CAGE, lw=1.2))
    arrow(axes, (0, 0), polar(1.0, 35), FRAME, r"$n$", shift=(0.05, 0.1), width=1.1)
    axes.plot(0, 0, "o", ms=3.5, color=LINE)
    axes.plot(*centre, "o", ms=3.5, color=CAGE)
    axes.text(0.0, -0.14, "O", fontsize=9, ha="center")
    axes.text(0.03, 0.15, "$e$", fontsize=11)
    axes.add_patch(Arc((0, 0), 0.8, 0.8, theta1=0, theta2=35, color=LINE, lw=0.9))
    axes.text(0.46, 0.13, r"$\psi$", fontsize=11)
    axes.plot([0, 0.75], [0, 0], color=LINE, lw=0.7)
    start = polar(0.72, 35, (0.0, 0.0))
    arrow(axes, start, polar(0.72 - 0.4, 35), FORCE, "", width=2.6)
    axes.text(0.58, 0.2, "$f_{in}$", color=FORCE, fontsize=11)
    tangent = (start[0] - 0.42 * math.sin(math.radians(35)), start[1] + 0.42 * math.cos(math.radians(35)))
    arrow(axes, start, tangent, FORCE, "$f_{ac}$", shift=(-0.12, 0.05))
    turn(axes, centre, 0.74, 200, 262, CAGE, r"$\omega_c$", 231)
    measure(axes, polar(0.9, 215, centre), polar(1.12, 215))
    axes.text(-1.02, -0.44, r"$c + e$", fontsize=9, rotation=35, ha="center")
    film = r"film on the cage: $-f_{in}\,n + f_{ac}\,\hat{n}$, $\hat n$ is $n$ turned by $+90^\circ$"
    axes.text(0.0, -1.62, film, fontsize=9, ha="center", color=FORCE)


def tilts(axes):
    """(e) Tilt, skew and slices."""
    plain(axes, "(e) tilt and skew of a roller, slices", (-1.75, 1.75), (-1.75, 1.5))
    for base, tilt, up, name in ((0.55, 8, "$e_r$", "tilt"), (-0.85, 6, "$e_t$", "skew")):
        arrow(axes, (-1.5, base), (1.5, base), FRAME, "X", shift=(0.12, 0.0))
        arrow(axes, (-1.5, base), (-1.5, base + 0.62), FRAME, up, shift=(0.0, 0.12))
        body = Rectangle((-0.95, base - 0.27), 1.9, 0.54, fc="white", ec=LINE, lw=1.2, angle=tilt, rotation_point="center")
        axes.add_patch(body)
        slope = math.tan(math.radians(tilt))
        axes.plot([-1.15, 1.25], [base - 1.15 * slope, base + 1.25 * slope], color=LINE, lw=0.9, ls="-.")
        axes.text(1.38, base + 0.5 * 1.25 * slope, r"$\beta_r$" if name == "tilt" else r"$\beta_t$", fontsize=11)
        if name == "tilt":
            for k in range(1, 8):
                x = -0.95 + 1.9 * k / 8
                axes.plot(
                    [x - 0.27 * math.sin(math.radians(tilt)), x + 0.27 * math.sin(math.radians(tilt))],
                    [base + x * slope + 0.27, base + x * slope - 0.27],
                    color=LINE,
                    lw=0.5,
                )
            axes.text(0.62, base - 0.42, "slice at $x_k$", fontsize=9, ha="center")
    axes.text(0.0, -1.7, r"a slice at $x$ stands at (r, t) = ($x\,\beta_r$, $x\,\beta_t$) from the roller's centre", fontsize=9, ha="center")


def contours(path):
    """Draw the lobed contour and its lean."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2))
    degrees = np.linspace(0, 360, 721)
    angle = np.radians(degrees)
    d_value = 98.0
    left.plot(degrees, 0.5 * d_value * (1 - np.cos(3 * angle)), color=FRAME, label="$R_e - R_{low}$")
    left.set_xlabel("azimuth from a low point [deg]")
    left.set_ylabel("$R_e - R_{low}$ [um]")
    left.set_xticks(range(0, 361, 60))
    left.grid(alpha=0.3)
    left.set_title("(a) contour of three lobes, D = 98 um", loc="left", fontsize=11)
    right.set_title("(b) the outer normal leans by atan($R_e'/R_e$)", loc="left", fontsize=11)
    right.set_aspect("equal")
    right.axis("off")
    right.set_xlim(-1.8, 1.8)
    right.set_ylim(-1.1, 1.3)
    t = np.linspace(-1.6, 1.6, 50)
    right.plot(t, 0.75 - 0.25 * t, color=LINE)
    right.fill_between(t, 0.75 - 0.25 * t, 1.3, color=STEEL)
    normal = np.array([0.25, 1.0]) / math.hypot(0.25, 1.0)
    foot = np.array([0.0, 0.0]) + 0.72 * normal
    right.add_patch(Circle((0, 0), 0.72, fc="white", ec=LINE))
    arrow(right, foot, foot - 0.62 * normal, FORCE, "$Q_e$", shift=(0.18, 0.05))
    arrow(right, (0, 0), (-0.75, 0), FRAME, "$e_t$", shift=(-0.02, 0.12))
    arrow(right, (0, 0), (0, -0.75), FRAME, "$-e_r$", shift=(0.2, 0.02))
    right.text(-1.7, -1.0, "towards a high point the outer load pushes the roller along the orbit: $+Q_e R_e'/r$", fontsize=9, color=FORCE)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def frames(path):
    """Draw all sketches of frames and signs on one sheet."""
    figure, axes = plt.subplots(2, 3, figsize=(15.5, 10.5))
    for draw, panel in zip((bearing, roller_forces, pocket, land, tilts), axes.flat):
        draw(panel)
    legend = axes.flat[5]
    plain(legend, "colours", (0, 1), (0, 1))
    meanings = (
        (FRAME, "frames and directions"),
        (FORCE, "forces, as they act on the body drawn"),
        (MOTION, "speeds, drawn positive"),
        (CAGE, "cage and its frame"),
    )
    for k, (colour, text) in enumerate(meanings):
        legend.plot([0.05, 0.17], [0.85 - 0.1 * k] * 2, color=colour, lw=3)
        legend.text(0.22, 0.85 - 0.1 * k, text, fontsize=11, va="center")
    legend.text(
        0.05,
        0.1,
        "X points at the reader in (a) to (d).\nAzimuths run from +Y towards +Z.\nPlays, displacements and tilts are exaggerated.",
        fontsize=10,
    )
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def main():
    """Write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path(__file__).parent, help="where to write the files")
    parser.add_argument("--format", default="svg", help="svg, or png to look at")
    chosen = parser.parse_args()
    plt.rcParams.update({"svg.hashsalt": "bearing_sim", "svg.fonttype": "path", "font.size": 10, "mathtext.fontset": "dejavusans"})
    frames(chosen.folder / f"frames.{chosen.format}")
    contours(chosen.folder / f"contour.{chosen.format}")


if __name__ == "__main__":
    main()
