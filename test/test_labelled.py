# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables for pandas and xarray hold the numbers of the block under the names and units of its observables."""

import numpy as np
import pytest
from synthetic_run import synthetic_block

from bearing_sim import load_scene, to_pandas, to_xarray
from bearing_sim.sweep.table import Table

pytest.importorskip("pandas", reason="pip install 'bearing_sim[tables]'")
pytest.importorskip("xarray", reason="pip install 'bearing_sim[tables]'")


@pytest.fixture(scope="module")
def block():
    return synthetic_block(load_scene("deng2017_table1"), np.linspace(0.0, 1.0, 11))


def test_a_dataset_has_the_numbers_by_time_and_roller_with_units_and_meanings(block):
    found = to_xarray(block)
    assert dict(found.sizes) == {"time": 11, "roller": block["inner_load"].shape[1]}
    assert float(found["shaft_speed"].sel(time=0.5)) == pytest.approx(0.5 * (520.0 + 4700.0))
    loaded = int(block["inner_load"][10].argmax())
    assert float(found["inner_load"].isel(time=10, roller=loaded)) == block["inner_load"][10].max() > 0.0
    units = {"time": "s", "shaft_speed": "rad/s", "inner_load": "N", "rating_life": "h", "cage_slip": "1", "inner_pressure": "Pa"}
    assert {name: found[name].attrs["units"] for name in units} == units
    assert "Deng 2017" in found["cage_slip"].attrs["long_name"]


def test_a_frame_is_indexed_by_time_and_has_a_column_and_a_unit_for_each_roller(block):
    frame = to_pandas(block, ["cage_slip", "inner_load"])
    rollers = block["inner_load"].shape[1]
    assert list(frame.columns) == ["cage_slip", *(f"inner_load_{roller:02}" for roller in range(rollers))]
    assert frame.index.name == "time" and frame.loc[1.0, "inner_load_03"] == block["inner_load"][10, 3]
    assert frame.attrs["units"] == {"time": "s", "cage_slip": "1", **{f"inner_load_{roller:02}": "N" for roller in range(rollers)}}
    assert len(to_pandas(block).columns) > 200 and "time" not in to_pandas(block)


def test_an_unknown_column_is_refused(block):
    with pytest.raises(KeyError, match=r"no observable 'cage_slipp' \(did you mean 'cage_slip'\?\); expected one of time"):
        to_pandas(block, ["cage_slipp"])


@pytest.mark.parametrize(("given", "found"), [(3, "int"), (np.zeros(3), "dtype float64"), (np.zeros(()), "shape")])
def test_what_is_no_block_is_refused(given, found):
    for convert in (to_pandas, to_xarray):
        with pytest.raises(TypeError, match=f"expected a block of samples.*got .*{found}"):
            convert(given)


def test_a_name_alone_is_no_list_of_columns(block):
    with pytest.raises(TypeError, match=r"columns = 'cage_slip': expected a list of names of observables, such as \['cage_slip'\]"):
        to_pandas(block, "cage_slip")


def test_a_table_without_axes_is_no_dataset_and_says_so():
    with pytest.raises(ValueError, match="a table of design has no axes; use to_pandas"):
        Table((), [], {"kind": "design"}).to_xarray()
