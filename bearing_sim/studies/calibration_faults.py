# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a measurement cannot tell: checks before, at and after a calibration, each with what is missing."""

import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.scene import Scene
from bearing_sim.scene_uncertainty import Range, nearest, quantities
from bearing_sim.studies.calibration_blocks import Blocks, Points

_LEAST_BLOCKS, _BLOCKS_PER_FIELD = 10, 5
_NO_EFFECT = 1e-5  # of slip, over the whole range: the solver's own error
_CONDITION = 100.0  # of the slopes at the end, each scaled to length 1: two fields with a correlation of 0.9998
_CONDITION_BEFORE = 1e4  # where the search begins, slopes are not yet those that count
_ALIKE = 0.99  # cosine of the slopes of two fields from which on they are named
_BOUND = 2e-3  # of the range
_NARROWED = 0.5  # an interval wider than this share of the range says too little
_LEAST_INDEPENDENT = 5


class CalibrationError(ValueError):
    """A measurement that cannot tell what was asked for, or a question that cannot be asked; the message says what is missing."""


def check_fields(scene: Scene, fields: Sequence[str], blocks: Blocks) -> list[Range]:
    """Return the ranges of fields; a field may be named by its last word where that is the only one.

    Raises
    ------
    CalibrationError
        A field has no range, is none of those that can be fitted, or there is too little to fit it to.
    """
    known, by_field = quantities(type(scene)), {one.field: one for one in scene.uncertainty}
    ranges = []
    for name in fields:
        matches = [path for path in by_field if path == name or path.rpartition(".")[2] == name]
        if name not in known and len(matches) != 1:
            hint = nearest(name, by_field) or nearest(name, known)
            raise CalibrationError(f"--fit {name}: unknown field{hint}; the scene has ranges for {', '.join(by_field) or 'nothing'}")
        path = name if name in known else matches[0]
        if path.startswith("operating.") or (path == "lubricant.temperature" and not np.isnan(blocks.conditions[:, 3]).any() and len(blocks.slip)):
            raise CalibrationError(f"--fit {path}: the recording itself says it; fit what it does not say")
        if path not in by_field:
            raise CalibrationError(f'--fit {path}: the scene gives it no range to search; add --set "uncertainty.{path}=[LOW, HIGH]"')
        ranges.append(by_field[path])
    repeated = {one.field for one in ranges if ranges.count(one) > 1}
    if repeated or not ranges:
        raise CalibrationError(f"--fit: {', '.join(sorted(repeated))} given twice" if repeated else "--fit: expected at least one field")
    _check_amount(len(ranges), blocks)
    return ranges


def _check_amount(fields: int, blocks: Blocks) -> None:
    wanted = max(_LEAST_BLOCKS, _BLOCKS_PER_FIELD * fields)
    if len(blocks.slip) < wanted:
        reasons = ", ".join(f"{count} {why}" for why, count in blocks.left_out.items()) or "none was left out"
        raise CalibrationError(
            f"too little data: {len(blocks.slip)} settled blocks of {blocks.length:.3g} s for {fields} field{'s' * (fields > 1)}, "
            f"expected {wanted} or more ({reasons}); record longer at even speed and load, or give a shorter --batch"
        )


def check_before(scene: Scene, ranges: Sequence[Range], slopes: np.ndarray, blocks: Blocks, points: Points) -> None:
    """Refuse fields that slip does not depend on here, and fields that nothing here tells apart; ``slopes`` as of a start, shape (n, p)."""
    effects = np.abs(slopes).max(axis=0)
    for one, effect in zip(ranges, effects):
        if not effect >= _NO_EFFECT:
            raise CalibrationError(
                f"{one.field} cannot be identified: over its whole range it changes slip by no more than {100 * effect:.2g} points at "
                f"{_where(points)}; record where it matters, or fit something else"
            )
    _check_told_apart(ranges, slopes, points, _CONDITION_BEFORE)


def _check_told_apart(ranges: Sequence[Range], slopes: np.ndarray, points: Points, worst: float) -> None:
    scaled = slopes / np.linalg.norm(slopes, axis=0)
    strengths = np.linalg.svd(scaled, compute_uv=False)
    if len(ranges) <= len(points.conditions) and strengths[-1] * worst >= strengths[0]:
        return
    likeness = np.abs(scaled.T @ scaled) - np.eye(len(ranges))
    alike = sorted({k for pair in np.argwhere(likeness > _ALIKE) for k in pair}) or range(len(ranges))
    condition = strengths[0] / strengths[-1] if strengths[-1] > 0.0 else math.inf
    raise CalibrationError(
        f"{' and '.join(ranges[k].field for k in alike)} cannot be told apart: at {_where(points)} they change slip alike (condition of the scaled "
        f"Jacobian {condition:.3g}, expected below {worst:g}); record at other speeds and loads, or fit one of them alone"
    )


def _where(points: Points) -> str:
    """Return the operating points in words."""
    speed, load = np.abs(points.conditions[:, 0]) * 30 / math.pi, np.hypot(points.conditions[:, 1], points.conditions[:, 2])
    if len(speed) == 1:
        return f"the one operating point of this run ({speed[0]:.0f} rpm, {load[0]:.0f} N)"
    return f"the {len(speed)} operating points of this run ({speed.min():.0f} to {speed.max():.0f} rpm, {load.min():.0f} to {load.max():.0f} N)"


def check_fit(scene: Scene, ranges: Sequence[Range], found, slopes: np.ndarray, blocks: Blocks, after: np.ndarray, points: Points) -> None:
    """Refuse a search that did not end, one that ended at a bound, and fields that nothing tells apart where it ended."""
    _check_told_apart(ranges, slopes, points, _CONDITION)
    if not found.success:
        raise CalibrationError(f"the search did not end: {found.message}; narrow the ranges, or fit fewer fields")
    known = quantities(type(scene))
    for one, place in zip(ranges, found.x):
        if _BOUND < place < 1.0 - _BOUND:
            continue
        bound, declared = (one.low, known[one.field]) if place <= _BOUND else (one.high, known[one.field])
        raise CalibrationError(
            f"the best {one.field} lies at the bound of its range, {declared.show(bound)}, where the model slips by "
            f"{100 * after.mean():.3g} % in the mean and the measured cage by {100 * blocks.slip.mean():.3g} %: something else must differ "
            f"(another field, the scene, the sensor), or the range is too narrow "
            f'(--set "uncertainty.{one.field}=[LOW, HIGH]")'
        )


def check_interval(scene: Scene, ranges: Sequence[Range], ends: np.ndarray, confidence: float, blocks: Blocks, tau: float) -> None:
    """Refuse an answer that is hardly narrower than the question; ``ends`` as places in the ranges, shape (2, p)."""
    independent = len(blocks.slip) / tau
    if independent < _LEAST_INDEPENDENT + len(ranges):
        raise CalibrationError(
            f"too little data: residuals resemble each other over {tau * blocks.length:.3g} s, so that {len(blocks.slip)} blocks of "
            f"{blocks.length:.3g} s are worth {independent:.1f} independent ones, expected {_LEAST_INDEPENDENT + len(ranges)} or more; "
            "record longer"
        )
    for one, low, high in zip(ranges, *ends):
        if not high - low <= _NARROWED:
            raise CalibrationError(
                f"{one.field} cannot be identified: its {100 * confidence:g} % interval covers {100 * (high - low):.0f} % of the range that "
                f"the scene gives it anyway, expected {100 * _NARROWED:g} % or less; record longer, with a better sensor, or where slip "
                "depends on it more"
            )
