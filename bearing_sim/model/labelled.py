# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Blocks of samples as pandas and xarray tables, with a name, a unit and a meaning for every column.

Both libraries are optional (``pip install 'bearing_sim[tables]'``) and are imported at the first call.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from bearing_sim.model.sample import OBSERVABLES

if TYPE_CHECKING:
    import pandas
    import xarray


def to_xarray(block: np.ndarray) -> "xarray.Dataset":
    """Return a block of samples as an `xarray.Dataset`.

    The dimensions are ``time`` [s] and, for observables of single rollers, ``roller`` (0 to Z - 1).  Every variable carries the attributes
    ``units`` (``"1"`` for a pure number) and ``long_name``, which xarray writes on the axes of its plots.

    Parameters
    ----------
    block : samples, shape (samples,), see `bearing_sim.model.sample.sample_dtype`.
    """
    import xarray

    variables = {
        each.name: (("time", "roller") if each.per_roller else ("time",), block[each.name], {"units": each.unit or "1", "long_name": each.meaning})
        for each in OBSERVABLES
    }
    coordinates = {"time": variables.pop("time"), "roller": np.arange(block["inner_load"].shape[1])}
    return xarray.Dataset(variables, coords=coordinates)


def to_pandas(block: np.ndarray, columns: Iterable[str] | None = None) -> "pandas.DataFrame":
    """Return a block of samples as a `pandas.DataFrame`, indexed by the simulated time [s].

    An observable of single rollers becomes one column for each roller, with the roller's number after its name (``inner_load_07``),
    as in the tables of ``bearing-sim to-csv``.  The units stand in ``frame.attrs["units"]``, by column (``"1"`` for a pure number).

    Parameters
    ----------
    block : samples, shape (samples,), see `bearing_sim.model.sample.sample_dtype`.
    columns : names of observables; all of them where absent.

    Raises
    ------
    KeyError
        There is no such observable.
    """
    import pandas

    known = {each.name: each for each in OBSERVABLES}
    data, units = {}, {"time": "s"}
    for name in known if columns is None else columns:
        if name not in known:
            raise KeyError(f"no observable {name!r}; expected one of {', '.join(known)}")
        if name == "time":
            continue
        numbers, unit = block[name], known[name].unit or "1"
        digits = len(str(numbers.shape[1] - 1)) if known[name].per_roller else 0
        named = {f"{name}_{roller:0{digits}}": column for roller, column in enumerate(numbers.T)} if digits else {name: numbers}
        data |= named
        units |= dict.fromkeys(named, unit)
    frame = pandas.DataFrame(data, index=pandas.Index(block["time"], name="time"))
    frame.attrs["units"] = units
    return frame
