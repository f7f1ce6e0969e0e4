# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of a study of uncertainty: how slip and life are spread, and which field that comes from."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.uncertainty import Study

_SLIP, _LIFE, _FIRST, _TOTAL = "#0072b2", "#009e73", "#56b4e9", "#0072b2"  # Okabe and Ito: told apart by the colour-blind
_FEWEST_BINS, _MOST_BINS = 8, 40


def draw(path: Path, title: str, found: Study, times: np.ndarray | None = None) -> None:
    """Write the picture; the ending of ``path`` says its format.

    Parameters
    ----------
    path : of the picture.
    title : over it.
    found : the study.
    times : of the stretches of its course [s], shape (m,); None where it has none.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    layout = [["slip", "life"], ["slip shares", "life shares"]] + ([["course", "course"]] if times is not None else [])
    figure = Figure(figsize=(12, 4 * len(layout)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic(layout)
    slip, life = ("cage slip [%]", "rating life [h]") if times is None else ("mean cage slip [%]", "life under the course [h]")
    _spread(axes["slip"], 100 * found.answers["cage_slip"], found, "cage_slip", 100.0, slip, _SLIP)
    _spread(axes["life"], found.answers["life_hours"], found, "life_hours", 1.0, life, _LIFE)
    _shares(axes["slip shares"], found, "cage_slip", "of the variance of slip")
    _shares(axes["life shares"], found, "life_hours", "of the variance of life")
    if times is not None:
        _over_time(axes["course"], found, times)
    figure.suptitle(title)
    figure.savefig(path, dpi=130)


def _spread(axes, values, found, name, scale, label, colour) -> None:
    values = values[: 2 * found.design.base]
    values, band, own = values[np.isfinite(values)], found.bands[name], scale * found.own[name]
    axes.hist(values, bins=int(np.clip(1.5 * np.sqrt(len(values)), _FEWEST_BINS, _MOST_BINS)), density=True, color=colour, alpha=0.6)
    axes.axvspan(scale * band.low, scale * band.high, color=colour, alpha=0.12, lw=0)
    for end, text in ((band.low, "5 %"), (band.middle, "50 %"), (band.high, "95 %")):
        axes.axvline(scale * end, color=colour, lw=1.5, ls="-" if text == "50 %" else "--", label=f"{text} below {scale * end:.4g}")
    axes.axvline(own, color="black", lw=1, ls=":", label=f"the scene's own values: {own:.4g}")
    axes.set(xlabel=label, ylabel="probability density")
    axes.legend(fontsize=9)


def _shares(axes, found, name, label) -> None:
    shares = found.indices[name]
    if shares is None or np.isnan(shares.total).all():
        axes.text(0.5, 0.5, "does not vary" if shares is not None else "not finite everywhere", ha="center", transform=axes.transAxes)
        axes.axis("off")
        return
    order = np.argsort(shares.total)
    places = np.arange(len(order))
    for offset, value, error, colour, text in (
        (0.2, shares.first, shares.first_error, _FIRST, "by itself (first order)"),
        (-0.2, shares.total, shares.total_error, _TOTAL, "with all it interacts with (total)"),
    ):
        length = np.clip(np.abs(error[order].T - value[order]), 0.0, None)
        axes.barh(places + offset, value[order], height=0.36, color=colour, xerr=length, ecolor="0.3", capsize=2, label=text)
    axes.set_yticks(places, [found.ranges[k].field.rpartition(".")[2].replace("_", " ") for k in order])
    axes.set(xlabel=f"share {label}, with 95 % intervals", xlim=(min(0.0, float(shares.first.min())) - 0.02, None))
    axes.axvline(0.0, color="0.3", lw=0.8)
    axes.legend(frameon=False, fontsize=9, loc="lower right")


def _over_time(axes, found, times) -> None:
    bands = found.slip_bands()
    axes.fill_between(times, [100 * one.low for one in bands], [100 * one.high for one in bands], color=_SLIP, alpha=0.25, label="5 to 95 %")
    axes.plot(times, [100 * one.middle for one in bands], color=_SLIP, label="50 %")
    axes.set(xlabel="time [s]", ylabel="cage slip [%]", ylim=(0, None))
    axes.legend(frameon=False, fontsize=9)
