# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The block `estimation` of a scene: off unless asked for, kept by recordings, and refused where it could mean nothing."""

import pytest

from bearing_sim import load_scene
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

_FIELD = "lubricant.mixture_fraction"


def _refusal(*overrides, scene="deng2017_table1"):
    with pytest.raises(SceneError) as refused:
        load_scene(scene, overrides)
    return str(refused.value)


def test_a_scene_that_does_not_ask_has_neither_bands_nor_a_calibration():
    assert not load_scene("deng2017_table1").estimation.is_asked


def test_what_a_scene_asks_for_survives_the_way_through_a_recording():
    scene = load_scene("deng2017_table1", ["estimation.bands=true", f"estimation.calibrated=[{_FIELD}]", "estimation.noise.cage_speed=0.1 %"])
    assert scene.estimation.calibrated == (_FIELD,) and scene.estimation.noise.cage_speed == pytest.approx(1e-3)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


def test_one_calibrated_field_needs_no_list():
    assert load_scene("deng2017_table1", [f"estimation.calibrated={_FIELD}"]).estimation.calibrated == (_FIELD,)


def test_estimated_internals_of_a_catalogue_bearing_are_ranges_enough():
    bearing = ["bearing=NU 210/C3", "uncertainty=null", "estimation.bands=true"]
    assert load_scene("deng2017_table1", bearing).estimation.bands


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["uncertainty=null", "estimation.bands=true"], "no field of this scene has a range"),
        (["estimation.calibrated=[lubricant.mixture_fractoin]"], "did you mean 'lubricant.mixture_fraction'?"),
        (["estimation.calibrated=[bearing.roller.count]"], "bearing.roller.count has no range in this scene"),
        ([f"estimation.calibrated=[{_FIELD}, {_FIELD}]"], f"{_FIELD} is named twice"),
        (["estimation.calibrated=[5]"], "expected a valid string"),
        (["estimation.bands=perhaps"], "expected a valid boolean"),
        (["estimation.noise.outliers=70 %"], "0 % to 50 %"),
        (["estimation.band=true"], "did you mean 'bands'?"),
    ],
)
def test_an_estimation_that_means_nothing_is_refused(overrides, said):
    assert said in _refusal(*overrides)
