# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What tests of the view share: files for rerun written and read back, and the views of a blueprint."""

import numpy as np
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from bearing_sim.view.worker import RerunFile


def views_in(part):
    """Yield the views of a part of a blueprint."""
    if isinstance(part, rrb.View):
        yield part
        return
    for inner in getattr(part, "contents", None) or []:
        yield from views_in(inner)


def written(path, scene, block):
    with RerunFile(scene, path) as sink:
        for part in np.array_split(block, 7):
            sink.write(part)
    assert sink.failure is None
    return list(RrdReader(str(path)).stream())


def last_value(chunks, entity, component):
    found = {}
    for chunk in chunks:
        table = chunk.to_record_batch()
        if chunk.entity_path == entity and not chunk.is_static and component in table.schema.names:
            times = [time.total_seconds() for time in table.column("sim_time").to_pylist()]
            found |= dict(zip(times, table.column(component).to_pylist()))
    return found[max(found)]


def column(path, entity, component="Scalars:scalars"):
    """Return times [s] and values of one component, in the order of time."""
    rows = []
    for chunk in RrdReader(str(path)).stream():
        table = chunk.to_record_batch()
        if chunk.entity_path == entity and not chunk.is_static and component in table.schema.names:
            rows += zip(table.column("sim_time").cast("int64").to_pylist(), table.column(component).to_pylist())
    rows.sort(key=lambda row: row[0])
    return 1e-9 * np.array([time for time, _ in rows]), np.array([value for _, (value,) in rows])
