# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about static transforms: a load keeps its direction in space whatever frame it is given in."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bearing_sim.inputs.static_transforms import StaticTransforms, Transform, quaternion, rotation_matrix

QUARTER = math.sqrt(0.5)


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.3, -1.2, 2.9), (math.pi / 2, 0.0, 0.0), (-3.0, 0.4, -0.01)])
def test_roll_pitch_and_yaw_turn_about_the_fixed_axes_in_this_order(angles):
    """Held against SciPy, which calls rotations about fixed axes by lower-case letters."""
    expected = Rotation.from_euler("xyz", angles)
    np.testing.assert_allclose(rotation_matrix(angles), expected.as_matrix(), atol=1e-15)
    found = np.array(quaternion(angles))
    np.testing.assert_allclose(found * np.sign(found @ expected.as_quat()), expected.as_quat(), atol=1e-15)
    np.testing.assert_allclose(rotation_matrix(quaternion(angles)), expected.as_matrix(), atol=1e-15)


def test_a_load_of_a_machine_turned_by_a_quarter_points_where_it_did():
    """The housing's z is the bearing's -y where the bearing is rolled by +90 degrees: y' = z, z' = -y."""
    transforms = StaticTransforms()
    assert transforms.receive([Transform("housing", "bearing", (0.1, 0.0, 0.0), quaternion((math.pi / 2, 0.0, 0.0)))]) == []
    np.testing.assert_allclose(transforms.rotation("housing", "bearing") @ (5.0, 0.0, -800.0), (5.0, -800.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(transforms.rotation("bearing", "housing") @ (5.0, -800.0, 0.0), (5.0, 0.0, -800.0), atol=1e-12)


def test_chains_are_followed_up_and_down_and_the_newest_transform_of_a_frame_counts():
    rng = np.random.default_rng(3)
    turns = {child: Rotation.random(random_state=rng) for child in ("gearbox", "rear", "dyno", "cell")}
    parents = {"gearbox": "base", "rear": "gearbox", "dyno": "base", "cell": "dyno"}
    transforms = StaticTransforms()
    transforms.receive(Transform(f"/{parents[child]}", child, orientation=tuple(turn.as_quat())) for child, turn in turns.items())
    force = np.array([10.0, -700.0, 300.0])
    in_base = turns["dyno"].apply(turns["cell"].apply(force))
    np.testing.assert_allclose(transforms.rotation("cell", "rear") @ force, (turns["gearbox"] * turns["rear"]).inv().apply(in_base), atol=1e-11)
    transforms.receive([Transform("gearbox", "rear")])
    np.testing.assert_allclose(transforms.rotation("cell", "rear") @ force, turns["gearbox"].inv().apply(in_base), atol=1e-11)


def test_frames_that_nothing_joins_are_named_and_loops_end():
    transforms = StaticTransforms()
    with pytest.raises(LookupError, match="no static transforms join 'dyno' and 'bearing'; /tf_static has none"):
        transforms.rotation("dyno", "bearing")
    transforms.receive([Transform("a", "b"), Transform("b", "a"), Transform("base", "bearing")])
    with pytest.raises(LookupError, match="join 'a' and 'bearing'; /tf_static has 'a', 'b', 'base', 'bearing'"):
        transforms.rotation("a", "bearing")
    with pytest.raises(LookupError, match="tf2_msgs"):
        StaticTransforms("need tf2_msgs").rotation("dyno", "bearing")
    np.testing.assert_array_equal(transforms.rotation("/bearing", "bearing"), np.eye(3))


@pytest.mark.parametrize(
    "transform, reason",
    [
        (Transform("base", "bearing", orientation=(0.0, 0.0, 0.0, 0.0)), "length 0, expected 1"),
        (Transform("base", "bearing", orientation=(0.0, 0.0, 0.0, math.nan)), "expected roll, pitch, yaw"),
        (Transform("bearing", "bearing"), "names of two frames"),
        (Transform("", "bearing"), "names of two frames"),
    ],
)
def test_a_transform_that_is_none_is_left_out_and_named(transform, reason):
    transforms = StaticTransforms()
    (text,) = transforms.receive([transform])
    assert reason in text and "'bearing'" in text
    with pytest.raises(LookupError):
        transforms.rotation("base", "bearing")


def test_a_quaternion_that_is_nearly_of_length_1_is_a_rotation():
    matrix = rotation_matrix((0.0, 0.0, QUARTER * 1.004, QUARTER * 1.004))
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-15)
    with pytest.raises(ValueError, match="length 1.1"):
        quaternion((0.0, 0.0, 0.0, 1.1))
