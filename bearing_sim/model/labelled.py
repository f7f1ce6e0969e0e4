# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Blocks of samples as pandas and xarray tables, with a name, a unit and a meaning for every column.

Both libraries are optional (``pip install 'bearing_sim[tables]'``) and are imported at the first call.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.scene.errors import did_you_mean

if TYPE_CHECKING:
    import pandas
    import xarray

    from bearing_sim.model.names import ObservableName


def to_xarray(block: np.ndarray) -> "xarray.Dataset":
    """Return a block of samples as an `xarray.Dataset`.

    The dimensions are ``time`` [s] and, for observables of single rollers, ``roller`` (0 to Z - 1).  Every variable carries the attributes
    ``units`` (``"1"`` for a pure number) and ``long_name``, which xarray writes on the axes of its plots.

    Parameters
    ----------
    block : samples, shape (samples,), see `bearing_sim.model.sample.sample_dtype`.

    Raises
    ------
    TypeError
        This is no block of samples.
    """
    import xarray

    _require_block(block)
    variables = {
        each.name: (("time", "roller") if each.per_roller else ("time",), block[each.name], {"units": each.unit or "1", "long_name": each.meaning})
        for each in OBSERVABLES
    }
    coordinates = {"time": variables.pop("time"), "roller": np.arange(block["inner_load"].shape[1])}
    return xarray.Dataset(variables, coords=coordinates)


def to_pandas(block: np.ndarray, columns: "Iterable[ObservableName] | None" = None) -> "pandas.DataFrame":
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
    TypeError
        This is no block of samples, or ``columns`` no list of names.
    """
    import pandas

    _require_block(block)
    if isinstance(columns, str) or not (columns is None or isinstance(columns, Iterable)):
        raise TypeError(f"columns = {columns!r}: expected a list of names of observables, such as ['cage_slip']")
    known = {each.name: each for each in OBSERVABLES}
    data, units = {}, {"time": "s"}
    for name in known if columns is None else columns:
        if name not in known:
            raise KeyError(f"no observable {name!r}{did_you_mean(str(name), known)}; expected one of {', '.join(known)}")
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


def _require_block(block: object) -> None:
    if not isinstance(block, np.ndarray) or block.ndim != 1 or not block.dtype.names or "inner_load" not in block.dtype.names:
        found = f"shape {block.shape}, dtype {str(block.dtype)[:40]}" if isinstance(block, np.ndarray) else type(block).__name__
        raise TypeError(f"expected a block of samples, as Simulation.advance and Settled.window are, got {found}; of one sample: np.array([sample])")
