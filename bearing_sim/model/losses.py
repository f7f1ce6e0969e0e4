# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The frictional moment and the losses by cause, for reports."""

import math
from collections.abc import Mapping

import numpy as np

from bearing_sim.scene.display import number

CAUSES = {
    "rolling": ("inner_rolling_power", "outer_rolling_power"),
    "sliding": ("inner_sliding_power", "outer_sliding_power"),
    "drag": ("churning_power",),
    "cage": ("windage_power", "land_power", "pocket_power"),
    "flanges": ("flange_power",),
    "damping": ("damping_power",),
    "seals": ("seal_power",),
    "supports": ("support_power",),
}
"""Losses of `bearing_sim.model.sample` by what people call their cause; drag is that of rollers, and in an oil bath of the cage too."""


def power_loss(samples: np.ndarray) -> float:
    """Return the sum of all losses [W], the mean over samples of shape (n,)."""
    return float(sum(samples[name].mean() for names in CAUSES.values() for name in names))


def loss_report(samples: np.ndarray) -> dict:
    """Return the frictional moment [N m], the power loss and its parts by cause [W], means over samples of shape (n,).

    Where nothing is accelerated the shaft puts in what is lost, and ``shaft_power`` is that.
    """
    losses = {f"{cause}_loss": float(sum(samples[name].mean() for name in names)) for cause, names in CAUSES.items()}
    power, speed = power_loss(samples), float(samples["shaft_speed"].mean())
    return {"friction_moment": power / speed if speed else math.nan, "shaft_power": power, **losses}


def loss_text(report: Mapping) -> str:
    """Return the friction in words, from `loss_report`; its parts have the decimals of the sum, so that they add up as far as they can."""
    if math.isnan(report["friction_moment"]):
        return "none, the shaft is at rest"
    total = report["shaft_power"]
    decimals = max(3 - math.floor(math.log10(abs(total))), 0) if total else 0
    shown = ", ".join(f"{cause} {report[f'{cause}_loss']:,.{decimals}f}" for cause in CAUSES if round(report[f"{cause}_loss"], decimals))
    return f"{number(report['friction_moment'])} N m, {total:,.{decimals}f} W: {shown}"
