# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compiled code called directly: the same numbers as through numba's choice among versions, and that choice where there is doubt."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import njit

from bearing_sim.numerics.compilation import compiled_for
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Simulation


class Pair(NamedTuple):
    """Parameters as kernels see them."""

    factor: float
    numbers: np.ndarray


@njit
def total(pair, start):
    return start + pair.factor * pair.numbers.sum()


PAIR = Pair(2.0, np.arange(3.0))


def test_the_version_for_the_arguments_types_is_found_among_several():
    whole = Pair(2.0, np.arange(3))
    assert total(PAIR, 1.0) == total(whole, 1.0) == 7.0
    direct = compiled_for(total, (PAIR, 1.0))
    assert direct is not total and direct(PAIR, 1.0) == direct(PAIR._replace(numbers=np.array([1.5, 1.5, 0.0])), 1.0) == 7.0
    assert compiled_for(total, (whole, 1.0))(whole, 2.0) == 8.0


def test_a_function_that_is_not_compiled_for_the_arguments_is_returned_as_it_is():
    assert compiled_for(total, (PAIR, np.zeros(2))) is total
    assert compiled_for(max, (1.0, 2.0)) is max


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_a_simulation_gives_the_same_samples_to_the_last_digit_whichever_way_its_code_is_called(level):
    scene = load_scene("deng2017_table1", [f"level={level}"])
    direct, chosen = Simulation(scene), Simulation(scene)
    for tick in range(12):
        inputs = direct.inputs._replace(shaft_speed=direct.inputs.shaft_speed * (1.0 + 1e-3 * tick), oil_temperature=390.0 + tick // 6)
        chosen._compiled = chosen._level.advance
        assert direct.advance(0.005, inputs, 1 + tick % 3).tobytes() == chosen.advance(0.005, inputs, 1 + tick % 3).tobytes()
    assert direct._compiled not in (None, direct._level.advance), "called directly from the second tick on"
